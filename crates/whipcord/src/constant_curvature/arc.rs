//! The arc, and how it answers the tensions of its cables.

use whipcord_numerics::{Pose, Twist, Vec3};

use crate::section::Fault;
use crate::section::{FOLDED, SectionFault};
use crate::statics::lengths::{Note, TensionResponse};

/// A backbone bent to an arc of a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Length of the undeformed backbone in m.
    pub length: f64,
    /// Curvature `u` about x and y in 1/m of undeformed length; `κ = ‖u‖`.
    pub curvature: [f64; 2],
    /// Stretch `v`: length by undeformed length.
    pub stretch: f64,
}

/// Compliance of the backbone's cross-sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Elasticity {
    /// `1/EI` about x and y in 1/(N·m²).
    pub bending: [f64; 2],
    /// `1/EA` in 1/N; 0 where the backbone does not stretch.
    pub axial: f64,
}

impl Elasticity {
    /// Of a backbone of which nothing but its length is known: any that bends alike in all directions and
    /// does not stretch gives the same shapes for the same cable lengths. Its scale makes tensions
    /// of about 1 N.
    pub fn geometric(length: f64) -> Self {
        let per_newton = 1.0 / (length * length);
        Self { bending: [per_newton; 2], axial: 0.0 }
    }
}

impl Arc {
    /// The frame at an arc length, eq. (1): the exponential of a constant strain.
    pub fn pose(&self, arc_length: f64) -> Pose {
        let [x, y] = self.curvature;
        Pose::exp(Twist {
            linear: Vec3::Z * (self.stretch * arc_length),
            angular: Vec3::new(x, y, 0.0) * arc_length,
        })
    }

    /// Length of a cable parallel to the backbone at this offset, eq. (2).
    pub fn cable_length(&self, offset: [f64; 2]) -> f64 {
        let [x, y] = self.curvature;
        self.length * (self.stretch + x * offset[1] - y * offset[0])
    }
}

/// The elastic arc under the tensions of its cables.
#[derive(Debug)]
pub(super) struct Rod<'a> {
    pub rest: Arc,
    pub elasticity: Elasticity,
    pub offsets: &'a [[f64; 2]],
    /// Under the last tensions.
    pub arc: Arc,
    /// By cable in m.
    pub lengths: &'a mut Vec<f64>,
    /// By rows in m/N.
    pub length_by_tension: &'a mut Vec<f64>,
}

impl Rod<'_> {
    /// The arc under these tensions, eq. (3).
    fn under(&self, tensions: &[f64]) -> Arc {
        let Elasticity { bending, axial } = self.elasticity;
        let mut arc = self.rest;
        for (&[x, y], tension) in self.offsets.iter().zip(tensions) {
            arc.curvature[0] -= bending[0] * y * tension;
            arc.curvature[1] += bending[1] * x * tension;
            arc.stretch -= axial * tension;
        }
        arc
    }

    /// The cable that has no length left on an arc, where there is one. On an arc that is pressed to
    /// nothing it is the one that pulls most.
    fn folded(&self, arc: &Arc, tensions: &[f64]) -> Option<usize> {
        let least = FOLDED * arc.length;
        let short = |offset: &[f64; 2]| {
            let length = arc.cable_length(*offset);
            // A NaN must not pass for a length.
            length <= least || !length.is_finite()
        };
        let most = |a: &usize, b: &usize| tensions[*a].total_cmp(&tensions[*b]);
        let pressed = arc.stretch <= FOLDED;
        self.offsets
            .iter()
            .position(short)
            .or_else(|| (0..tensions.len()).max_by(most).filter(|_| pressed))
    }

    /// The fraction of the tensions up to which no cable folds: everything is linear in them.
    pub fn borne(&self, tensions: &[f64]) -> f64 {
        let full = self.under(tensions);
        let least = |rest: f64, now: f64| {
            if now < rest { (rest - FOLDED) / (rest - now) } else { f64::INFINITY }
        };
        let per_length = |arc: &Arc, offset: [f64; 2]| arc.cable_length(offset) / arc.length;
        let of_cable =
            |&offset: &[f64; 2]| least(per_length(&self.rest, offset), per_length(&full, offset));
        let pressed = least(self.rest.stretch, full.stretch);
        self.offsets.iter().map(of_cable).fold(pressed, f64::min).clamp(0.0, 1.0)
    }
}

impl TensionResponse for Rod<'_> {
    fn respond(&mut self, tensions: &[f64], _warm: bool) -> Result<(), Fault> {
        let arc = self.under(tensions);
        if let Some(cable) = self.folded(&arc, tensions) {
            return Err(Fault { kind: SectionFault::Folded { cable }, arc_length: 0.0 });
        }
        self.arc = arc;
        self.lengths.clear();
        self.lengths.extend(self.offsets.iter().map(|offset| arc.cable_length(*offset)));
        // Eq. (4).
        let Elasticity { bending: [about_x, about_y], axial } = self.elasticity;
        self.length_by_tension.clear();
        for a in self.offsets {
            let by = |b: &[f64; 2]| {
                -arc.length * (about_x * a[1] * b[1] + about_y * a[0] * b[0] + axial)
            };
            self.length_by_tension.extend(self.offsets.iter().map(by));
        }
        Ok(())
    }

    fn lengths(&self) -> &[f64] {
        self.lengths
    }

    fn length_by_tension(&self) -> &[f64] {
        self.length_by_tension
    }

    fn note(&mut self, _note: &Note, _tensions: &[f64]) {}
}
