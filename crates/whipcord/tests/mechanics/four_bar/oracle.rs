//! The section problem by its definitions, with the rotation vector ω as unknown, and a search
//! that uses neither derivatives nor anything of the library but its vectors and rotations.

use std::f64::consts::PI;

use whipcord::four_bar::{Chord, Objective};
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_numerics::DenseLu;

#[derive(Clone, Copy, Debug)]
pub struct Section {
    pub length: f64,
    pub from: Vec3,
    pub to: Vec3,
    pub chord: Chord,
    pub objective: Objective,
    /// Rotation vector before actuation.
    pub rest: Vec3,
}

pub fn angle(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// Pose of the upper disk.
pub fn pose(length: f64, chord: Chord, w: Vec3) -> Pose {
    let rotation = UnitQuaternion::exp(w);
    let normal = rotation.rotate(Vec3::Z);
    let bisector = Vec3::Z + normal;
    let half = 0.5 * angle(Vec3::Z, normal);
    let reach = match chord {
        Chord::Arc if half > 1e-8 => half.sin() / half,
        _ => 1.0,
    };
    Pose { position: bisector * (length * reach / bisector.norm()), rotation }
}

impl Section {
    pub fn cable(&self, w: Vec3) -> f64 {
        (pose(self.length, self.chord, w).transform(self.to) - self.from).norm()
    }

    pub fn measure(&self, w: Vec3) -> f64 {
        match self.objective {
            Objective::StrainEnergy => {
                let w = w - self.rest;
                w.x * w.x + w.y * w.y + w.z * w.z / 1.3
            }
            _ => {
                let e = self.to / self.to.norm();
                let f = Vec3::new(e.y, -e.x, 0.0);
                let turned = |w: Vec3, of: Vec3| UnitQuaternion::exp(w).rotate(of);
                let square = |of| angle(turned(self.rest, of), turned(w, of)).powi(2);
                square(e) + square(f)
            }
        }
    }

    /// The first rotation vector from rest in direction `u` at which the cable has the length `target`.
    fn on_ray(&self, u: Vec3, target: f64) -> Option<Vec3> {
        let n = 60;
        let at = |i: usize| 0.999 * PI * i as f64 / f64::from(n);
        let away = |turn: f64| self.rest + u * turn;
        let first = (1..=n as usize).find(|&i| self.cable(away(at(i))) <= target)?;
        let (mut low, mut high) = (at(first - 1), at(first));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.cable(away(middle)) <= target { high = middle } else { low = middle }
        }
        Some(away(high))
    }

    /// The least measure at which the cable has the length `target`: directions on a grid over the
    /// sphere, each followed to the first rotation that gives the length, then ever finer round
    /// the best.
    pub fn least(&self, target: f64) -> Option<f64> {
        let direction = |polar: f64, azimuth: f64| {
            Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
        };
        let value = |polar: f64, azimuth: f64| {
            self.on_ray(direction(polar, azimuth), target)
                .map_or(f64::INFINITY, |w| self.measure(w))
        };
        let mut best = (f64::INFINITY, 0.0, 0.0);
        for i in 1..24 {
            for j in 0..48 {
                let (polar, azimuth) = (PI * f64::from(i) / 24.0, PI * f64::from(j) / 24.0);
                let found = value(polar, azimuth);
                if found < best.0 {
                    best = (found, polar, azimuth);
                }
            }
        }
        let mut size = PI / 24.0;
        while size > 1e-6 {
            let (_, polar, azimuth) = best;
            let mut better = false;
            for (i, j) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let at = (polar + size * f64::from(i), azimuth + size * f64::from(j));
                let found = value(at.0, at.1);
                if found < best.0 {
                    best = (found, at.0, at.1);
                    better = true;
                }
            }
            if !better {
                size *= 0.5;
            }
        }
        best.0.is_finite().then_some(best.0)
    }
}

/// Gradient by fourth-order central differences.
pub fn gradient(f: impl Fn(Vec3) -> f64, w: Vec3) -> Vec3 {
    let h = 1e-3;
    let mut g = Vec3::ZERO;
    for i in 0..3 {
        let at = |t: f64| {
            let mut x = w;
            x[i] += t * h;
            f(x)
        };
        g[i] = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
    }
    g
}

/// The least `‖b + Σ x_i a_i‖` with non-negative `x`, over all choices of the `x_i` that are not
/// zero.
pub fn non_negative_least_squares(a: &[Vec<f64>], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
    let mut best = dot(b, b).sqrt();
    for chosen in 1..1_usize << a.len() {
        let of: Vec<&Vec<f64>> =
            (0..a.len()).filter(|i| chosen >> i & 1 == 1).map(|i| &a[i]).collect();
        let n = of.len();
        let normal: Vec<f64> = (0..n * n).map(|k| dot(of[k / n], of[k % n])).collect();
        let mut x: Vec<f64> = of.iter().map(|a| -dot(a, b)).collect();
        let mut lu = DenseLu::default();
        if lu.factor(n, &normal).is_err() {
            continue;
        }
        lu.solve(&mut x);
        if x.iter().all(|&x| x >= 0.0) {
            let mut rest = b.to_vec();
            for (x, a) in x.iter().zip(of) {
                for (r, a) in rest.iter_mut().zip(a) {
                    *r += x * a;
                }
            }
            best = best.min(dot(&rest, &rest).sqrt());
        }
    }
    best
}
