//! Curves that a backbone is to follow.

use core::f64::consts::TAU;

use whipcord::{Pose, Twist, Vec3};
use whipcord_numerics::GAUSS_3;

use crate::error::DesignError;

/// A curve by its curvature and torsion along its arc length. It begins at the origin along z and first bends towards `direction`.
///
/// A negative curvature bends the other way: a curve with an inflection has a torsion throughout.
pub struct Curve {
    length: f64,
    direction: f64,
    curvature: Box<dyn Fn(f64) -> f64>,
    torsion: Box<dyn Fn(f64) -> f64>,
}

impl core::fmt::Debug for Curve {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Curve").field("length", &self.length).finish_non_exhaustive()
    }
}

/// Steps of the integration of a curve.
const STEPS: usize = 400;
/// A curve that winds more often over its length is none that its steps follow, and no backbone does.
const MOST_TURNS: f64 = 100.0;

impl Curve {
    /// Of this length in m, with the curvature and the torsion in 1/m at each arc length in m; `direction` in rad from x.
    pub fn new(
        length: f64,
        direction: f64,
        curvature: impl Fn(f64) -> f64 + 'static,
        torsion: impl Fn(f64) -> f64 + 'static,
    ) -> Self {
        let (curvature, torsion) = (Box::new(curvature), Box::new(torsion));
        Self { length, direction, curvature, torsion }
    }

    /// An arc of a circle.
    #[must_use]
    pub fn circle(length: f64, radius: f64) -> Self {
        Self::new(length, 0.0, move |_| 1.0 / radius, |_| 0.0)
    }

    /// A helix of this radius that climbs by `pitch` in a turn; both in m.
    #[must_use]
    pub fn helix(length: f64, radius: f64, pitch: f64) -> Self {
        let climb = pitch / TAU;
        let square = radius * radius + climb * climb;
        Self::new(length, 0.0, move |_| radius / square, move |_| climb / square)
    }

    /// An S in a plane: one way by this angle in rad over the first half, back over the second, with a curvature that changes as a sine.
    #[must_use]
    pub fn s_curve(length: f64, angle: f64) -> Self {
        let greatest = core::f64::consts::PI * angle / length;
        let turns = TAU / length;
        Self::new(length, 0.0, move |s| greatest * (turns * s).sin(), |_| 0.0)
    }

    /// A clothoid, whose curvature in 1/m goes linearly from one value to another.
    #[must_use]
    pub fn clothoid(length: f64, [start, end]: [f64; 2]) -> Self {
        Self::new(length, 0.0, move |s| start + (end - start) * s / length, |_| 0.0)
    }

    /// The same curve, first bent towards this direction in rad from x.
    #[must_use]
    pub fn towards(self, direction: f64) -> Self {
        Self { direction, ..self }
    }

    /// Length in m.
    #[must_use]
    pub const fn length(&self) -> f64 {
        self.length
    }

    /// Direction in rad from x in which it first bends.
    #[must_use]
    pub const fn direction(&self) -> f64 {
        self.direction
    }

    /// Curvature in 1/m at an arc length in m.
    #[must_use]
    pub fn curvature(&self, arc_length: f64) -> f64 {
        (self.curvature)(arc_length)
    }

    /// Torsion in 1/m at an arc length in m.
    #[must_use]
    pub fn torsion(&self, arc_length: f64) -> f64 {
        (self.torsion)(arc_length)
    }

    pub(crate) fn check(&self) -> Result<(), DesignError> {
        #[allow(clippy::cast_precision_loss, reason = "few steps")]
        let at = |k: usize| self.length * k as f64 / STEPS as f64;
        let is_finite = self.length > 0.0
            && self.length.is_finite()
            && self.direction.is_finite()
            && (0..=STEPS)
                .map(at)
                .all(|s| self.curvature(s).is_finite() && self.torsion(s).is_finite());
        let refuse = |what: String| Err(DesignError::Curve { what });
        if !is_finite {
            return refuse(
                "a curve needs a positive length and finite curvature and torsion".to_owned(),
            );
        }
        let winds = |s: f64| self.curvature(s).hypot(self.torsion(s)) * self.length / TAU;
        if (0..=STEPS).map(at).any(|s| winds(s) > MOST_TURNS) {
            return refuse(format!(
                "the curve winds more than {MOST_TURNS} times over the length of {} mm: check its numbers and their units",
                1e3 * self.length
            ));
        }
        Ok(())
    }

    /// Frames at these ascending arc lengths in m: z along the curve, without twist about it (the frame of Bishop).
    #[must_use]
    pub fn frames(&self, arc_lengths: &[f64]) -> Vec<Pose> {
        #[allow(clippy::cast_precision_loss, reason = "few steps")]
        let longest = self.length / STEPS as f64;
        let mut pose = Pose::IDENTITY;
        let mut angle = self.direction;
        let mut s = 0.0;
        let mut frames = Vec::with_capacity(arc_lengths.len());
        for &end in arc_lengths {
            while end - s > 1e-15 * self.length {
                // A last step that is hardly shorter than a whole one.
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "few steps"
                )]
                let rest = ((end - s) / longest).ceil().max(1.0);
                let h = (end - s) / rest;
                pose = self.step(pose, &mut angle, s, h);
                s += h;
            }
            frames.push(pose);
        }
        frames
    }

    /// A step of order 6, with the angle of the bend by quadrature of the torsion.
    fn step(&self, pose: Pose, angle: &mut f64, s: f64, h: f64) -> Pose {
        let within = |to: f64| -> f64 {
            let nodes = GAUSS_3.nodes.iter().zip(&GAUSS_3.weights);
            nodes.map(|(x, w)| w * to * self.torsion(s + x * to)).sum()
        };
        let twists = GAUSS_3.nodes.map(|x| {
            let (sin, cos) = (*angle + within(x * h)).sin_cos();
            let bend = self.curvature(s + x * h);
            Twist { linear: Vec3::Z, angular: Vec3::new(-bend * sin, bend * cos, 0.0) } * h
        });
        *angle += within(h);
        pose * whipcord_numerics::magnus_6(&twists)
    }

    /// Points at these ascending arc lengths in m.
    #[must_use]
    pub fn points(&self, arc_lengths: &[f64]) -> Vec<Vec3> {
        self.frames(arc_lengths).iter().map(|pose| pose.position).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_and_a_helix_are_those_of_the_textbook() {
        let end = Curve::circle(0.2, 0.1).points(&[0.1, 0.2])[1];
        let exact = Vec3::new(0.1 * (1.0 - 2.0_f64.cos()), 0.0, 0.1 * 2.0_f64.sin());
        assert!((end - exact).norm() < 1e-14);
        // Of a helix the distance of points a turn apart is the pitch.
        let (radius, pitch) = (0.02, 0.03);
        let turn = (radius * TAU).hypot(pitch);
        let points = Curve::helix(2.0 * turn, radius, pitch).points(&[0.3 * turn, 1.3 * turn]);
        assert!(((points[1] - points[0]).norm() - pitch).abs() < 1e-12);
    }
}
