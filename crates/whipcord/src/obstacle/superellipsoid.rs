//! Superellipsoids and their distance.

use std::sync::Arc;

use whipcord_numerics::Vec3;

use super::surface::Surface;
use crate::robot::{RobotError, limits};

/// The body ((|x/a|^(2/ε₂) + |y/b|^(2/ε₂))^(ε₂/ε₁) + |z/c|^(2/ε₁)) ≤ 1 (A. H. Barr, Superquadrics
/// and angle-preserving transformations, 1981): an ellipsoid where both exponents are 1, a box with
/// rounded edges where they are small, and convex for all that are allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Superellipsoid {
    semi_axes: Vec3,
    exponents: [f64; 2],
    starts: Arc<[Start]>,
}

/// A point of the surface that a search may start from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Start {
    st: [f64; 2],
    point: Vec3,
}

/// Starts along each parameter, in units of its reach.
const GRID: [f64; 7] = [-3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0];
/// Beyond it, a coordinate is nothing.
const REACH: f64 = 600.0;
/// How far a coordinate of the point is kept from a plane of symmetry, in semi-axes: there the
/// parameters are infinite. The distance changes by no more than this.
const FLOOR: f64 = 1e-14;
/// Newton's steps; five are common.
const STEPS: usize = 80;

/// A point of the surface in the first octant, and how it changes with its parameters s and t.
struct Patch {
    point: Vec3,
    first: [Vec3; 2],
    second: [Vec3; 3],
}

impl Superellipsoid {
    /// The body with these semi-axes in m and these exponents ε₁, of its sections along z, and ε₂,
    /// of its sections across z.
    ///
    /// # Errors
    /// [`RobotError`] with the path `semi_axes` or `exponents`.
    pub fn new(semi_axes: Vec3, exponents: [f64; 2]) -> Result<Self, RobotError> {
        limits::LENGTH.check_vector("semi_axes", semi_axes)?;
        for (k, exponent) in exponents.into_iter().enumerate() {
            limits::SUPERELLIPSOID_EXPONENT.check(&format!("exponents[{k}]"), exponent)?;
        }
        let mut body = Self { semi_axes, exponents, starts: Arc::new([]) };
        let [s, t] = [body.reach(1), body.reach(0)];
        let start =
            |i: f64, j: f64| Start { st: [i * s, j * t], point: body.patch([i * s, j * t]).point };
        body.starts = GRID.iter().flat_map(|&i| GRID.map(|j| start(i, j))).collect();
        Ok(body)
    }

    /// In m.
    #[must_use]
    pub fn semi_axes(&self) -> Vec3 {
        self.semi_axes
    }

    /// ε₁ and ε₂.
    #[must_use]
    pub fn exponents(&self) -> [f64; 2] {
        self.exponents
    }

    /// Whether its normal turns on edges.
    fn is_sharp(&self) -> bool {
        self.exponents.iter().any(|&exponent| exponent > 1.0)
    }

    /// The parameter at which one of two coordinates, or of two components of the normal, is some
    /// e times the other.
    fn reach(&self, k: usize) -> f64 {
        let power = 2.0 / self.exponents[k];
        power.max(power / (power - 1.0))
    }

    /// The surface is found by Newton's method on half the squared distance as a function of two
    /// parameters in which every shape is smooth: with σ the logistic function, α = 2/ε₂ and
    /// β = 2/ε₁, the surface in the first octant is
    ///
    /// x/a = σ(−t)^(1/β) σ(−s)^(1/α),  y/b = σ(−t)^(1/β) σ(s)^(1/α),  z/c = σ(t)^(1/β).
    pub(super) fn surface(&self, point: Vec3) -> Surface {
        let octant = [0, 1, 2].map(|i| point[i].abs().max(FLOOR * self.semi_axes[i]));
        let p = Vec3::from(octant);
        let inside = self.level(p) < 0.0;
        let mut best = self.descend(self.nearest_start(p), p);
        if inside {
            // There may be several ways out, and the nearest start need not lead to the shortest.
            for st in self.other_starts(p).into_iter().flatten() {
                let other = self.descend(st, p);
                if other.0 < best.0 {
                    best = other;
                }
            }
        }
        let away = p - self.patch(best.1).point;
        let normal = self.normal(best.1);
        let length = away.norm();
        // Where edges are sharp, much the same point has very different normals, and the way to it
        // is known better than they are, unless there is hardly any.
        let (distance, normal) = if self.is_sharp() && length > 1e-9 * self.semi_axes.max_abs() {
            let sign = if inside { -1.0 } else { 1.0 };
            (sign * length, away * (sign / length))
        } else {
            (away.dot(normal), normal)
        };
        let signed = [0, 1, 2].map(|i| if point[i] < 0.0 { -normal[i] } else { normal[i] });
        Surface { distance, normal: signed.into() }
    }

    /// The logarithm of the sum that is 1 on the surface, at a point of the first octant.
    fn level(&self, p: Vec3) -> f64 {
        let [beta, alpha] = self.exponents.map(|exponent| 2.0 / exponent);
        let [x, y, z] = [0, 1, 2].map(|i| (p[i] / self.semi_axes[i]).ln());
        log_sum(beta / alpha * log_sum(alpha * x, alpha * y), beta * z)
    }

    /// The parameters of the point in the direction of p or of a precomputed one, whichever is the
    /// nearer; then of the point whose normal leads from there to p, where that is no farther off.
    fn nearest_start(&self, p: Vec3) -> [f64; 2] {
        let [beta, alpha] = self.exponents.map(|exponent| 2.0 / exponent);
        let [x, y, z] = [0, 1, 2].map(|i| (p[i] / self.semi_axes[i]).ln());
        let radial = [alpha * (y - x), beta * z - beta / alpha * log_sum(alpha * x, alpha * y)];
        let mut st = radial.map(|x| x.clamp(-REACH, REACH));
        let mut foot = self.patch(st).point;
        let mut best = (foot - p).norm_squared();
        for start in self.starts.iter() {
            let squared = (start.point - p).norm_squared();
            if squared < best {
                (best, st, foot) = (squared, start.st, start.point);
            }
        }
        // At sharp edges points with very different normals are all but the same, and which of
        // them is the nearest cannot be told from how far off they are.
        for _ in 0..3 {
            let n = p - foot;
            if !self.is_sharp() || n.to_array().iter().any(|&x| x <= 0.0) {
                break;
            }
            let next = self.with_normal(n).map(|x| x.clamp(-REACH, REACH));
            let there = self.patch(next).point;
            let squared = (there - p).norm_squared();
            if squared > 1.001 * best {
                break;
            }
            (best, st, foot) = (squared, next, there);
        }
        st
    }

    /// The parameters of the point whose normal is in a direction of the first octant: those of the
    /// direction on the body whose level is this one's support function, with the powers p/(p − 1).
    fn with_normal(&self, n: Vec3) -> [f64; 2] {
        let [beta, alpha] = self.exponents.map(|exponent| 2.0 / (2.0 - exponent));
        let [x, y, z] = [0, 1, 2].map(|i| (n[i] * self.semi_axes[i]).ln());
        [alpha * (y - x), beta * z - beta / alpha * log_sum(alpha * x, alpha * y)]
    }

    /// The point of the surface that is farthest in a direction, in m.
    pub(crate) fn support(&self, direction: Vec3) -> Vec3 {
        // In a plane of symmetry the parameters are infinite.
        let octant = [0, 1, 2].map(|i| direction[i].abs().max(FLOOR));
        let st = self.with_normal(octant.into()).map(|x| x.clamp(-REACH, REACH));
        let point = self.patch(st).point;
        [0, 1, 2].map(|i| if direction[i] < 0.0 { -point[i] } else { point[i] }).into()
    }

    /// The precomputed points that are nearer than those around them: at most five.
    fn other_starts(&self, p: Vec3) -> [Option<[f64; 2]>; 5] {
        let n = GRID.len();
        let squared = |i: usize, j: usize| (self.starts[i * n + j].point - p).norm_squared();
        let mut found = [None; 5];
        let mut count = 0;
        for i in 0..n {
            for j in 0..n {
                let here = squared(i, j);
                let around = (i.saturating_sub(1)..=(i + 1).min(n - 1))
                    .flat_map(|k| (j.saturating_sub(1)..=(j + 1).min(n - 1)).map(move |l| (k, l)));
                let mut others = around.filter(|&(k, l)| (k, l) != (i, j));
                if count < found.len() && others.all(|(k, l)| here <= squared(k, l)) {
                    found[count] = Some(self.starts[i * n + j].st);
                    count += 1;
                }
            }
        }
        found
    }

    /// Half the squared distance of p from the nearest point of the surface around a start, and
    /// that point's parameters: Newton's method, damped as Levenberg and Marquardt do.
    fn descend(&self, start: [f64; 2], p: Vec3) -> (f64, [f64; 2]) {
        let size = self.semi_axes.max_abs();
        let reach = [self.reach(1), self.reach(0)];
        let mut st = start;
        let mut patch = self.patch(st);
        let mut value = 0.5 * (patch.point - p).norm_squared();
        let (mut damping, mut final_steps) = (0.0, 20);
        for _ in 0..STEPS {
            let Some((step, decrease)) = patch.step(p, damping) else {
                damping = f64::max(4.0 * damping, 0.1);
                continue;
            };
            // Rounding hides what so small a step gains; it is as good as its predecessors were.
            let is_final = decrease <= 1e-13 * value + 1e-30 * size * size;
            let next = [0, 1].map(|i| {
                let far = 2.0 * reach[i];
                (st[i] + step[i].clamp(-far, far)).clamp(-REACH, REACH)
            });
            let there = self.patch(next);
            let lower = 0.5 * (there.point - p).norm_squared();
            let gain = (value - lower) / decrease;
            if is_final || gain > 0.1 {
                (st, patch, value) = (next, there, lower);
            }
            if is_final {
                damping = 0.0;
                // A coordinate close to zero may still have far to go.
                let short = (0..2).all(|i| step[i].abs() < 1e-7 * reach[i]);
                final_steps -= 1;
                if short || final_steps == 0 {
                    break;
                }
            } else if gain > 0.5 {
                damping = if damping < 0.02 { 0.0 } else { 0.2 * damping };
            } else if gain.is_nan() || gain < 0.1 {
                damping = f64::max(4.0 * damping, 0.1);
            }
        }
        (value, st)
    }

    fn patch(&self, [s, t]: [f64; 2]) -> Patch {
        let [along, across] = self.exponents.map(|exponent| 0.5 * exponent);
        let ([s0, s1], [t0, t1]) = (logistic(s), logistic(t));
        let ring = t0.powf(along);
        let a = self.semi_axes;
        let (x, y) = (a.x * ring * s0.powf(across), a.y * ring * s1.powf(across));
        let z = a.z * t1.powf(along);
        // Logarithmic derivatives of x, y and z.
        let (xs, ys, rt, zt) = (-s1 * across, s0 * across, -t1 * along, t0 * along);
        let (ss, tt) = (-s0 * s1 * across, -t0 * t1 * along);
        Patch {
            point: Vec3::new(x, y, z),
            first: [Vec3::new(x * xs, y * ys, 0.0), Vec3::new(x * rt, y * rt, z * zt)],
            second: [
                Vec3::new(x * (xs * xs + ss), y * (ys * ys + ss), 0.0),
                Vec3::new(x * xs * rt, y * ys * rt, 0.0),
                Vec3::new(x * (rt * rt + tt), y * (rt * rt + tt), z * (zt * zt + tt)),
            ],
        }
    }

    /// The unit normal at a point of the first octant.
    fn normal(&self, [s, t]: [f64; 2]) -> Vec3 {
        let [along, across] = self.exponents.map(|exponent| 1.0 - 0.5 * exponent);
        let ([s0, s1], [t0, t1]) = (logistic(s), logistic(t));
        let ring = t0.powf(along);
        let a = self.semi_axes;
        let n = Vec3::new(
            ring * s0.powf(across) / a.x,
            ring * s1.powf(across) / a.y,
            t1.powf(along) / a.z,
        );
        n / n.norm()
    }
}

impl Patch {
    /// The step towards p, with each diagonal entry of the Hessian raised by so much of the square of
    /// its tangent, and by how much it is to lower half the squared distance; `None` where it would
    /// not lead downhill.
    fn step(&self, p: Vec3, damping: f64) -> Option<([f64; 2], f64)> {
        let away = self.point - p;
        let [ps, pt] = self.first;
        let g = [away.dot(ps), away.dot(pt)];
        let [ss, st, tt] = self.second.map(|second| away.dot(second));
        let a = (1.0 + damping) * ps.norm_squared() + ss;
        let b = ps.dot(pt) + st;
        let c = (1.0 + damping) * pt.norm_squared() + tt;
        let determinant = a * c - b * b;
        if !(a > 0.0 && c > 0.0 && determinant > 1e-12 * a * c) {
            return None;
        }
        let step = [(b * g[1] - c * g[0]) / determinant, (b * g[0] - a * g[1]) / determinant];
        let decrease = -0.5 * (g[0] * step[0] + g[1] * step[1]);
        step.iter().all(|x| x.is_finite()).then_some((step, decrease))
    }
}

/// σ(−x) and σ(x), neither rounded to 1 less the other.
fn logistic(x: f64) -> [f64; 2] {
    let e = (-x.abs()).exp();
    let (small, large) = (e / (1.0 + e), 1.0 / (1.0 + e));
    if x < 0.0 { [large, small] } else { [small, large] }
}

/// ln(eᵃ + eᵇ).
fn log_sum(a: f64, b: f64) -> f64 {
    a.max(b) + (-(a - b).abs()).exp().ln_1p()
}
