//! Friction against bending beside the elastic stiffness of a section (see `docs/theory/bending-friction.md`).
//!
//! About each bending axis a spring of stiffness `k_y` in series with a friction limit `M_y` acts in parallel with `EI`:
//! with the plastic curvature `κ` that earlier steps left, and `e = u − u* − κ`,
//!
//! ```text
//! h(e) = k_y e   where |k_y e| ≤ M_y,   M_y sign(e)   beyond;      ψ(e) = ∫ h de               (1)
//! κ⁺ = e + κ − h/k_y                                                                            (2)
//! ```
//!
//! `ψ` is Huber's function: convex, with a continuous slope. For a given `κ` the section is that of a nonlinear elastic rod.

use whipcord_numerics::{Mat3, Vec3};

/// The bending axes: x and y.
pub(crate) const BENDING_AXES: usize = 2;

/// A spring that is so near to its limit, as a part of that, is at it.
const NEAR: f64 = 1e-6;

/// Friction against bending of a section, by bending axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BendingFriction {
    /// `M_y` in N·m; 0 on an axis without friction.
    pub limit: [f64; BENDING_AXES],
    /// `k_y` in N·m², positive.
    pub stiffness: [f64; BENDING_AXES],
    /// `κ` in 1/m.
    pub plastic: [f64; BENDING_AXES],
}

impl BendingFriction {
    /// Stretch `e` of the spring on one axis, from `u − u*`, and whether it slides.
    fn at(&self, axis: usize, bend: Vec3) -> (f64, bool) {
        let stretch = bend[axis] - self.plastic[axis];
        (stretch, !self.holds(axis, stretch))
    }

    /// Whether friction holds a stretch of the spring on one axis: never where there is none.
    fn holds(&self, axis: usize, stretch: f64) -> bool {
        let limit = self.limit[axis];
        limit > 0.0 && self.stiffness[axis] * stretch.abs() <= limit
    }

    /// Direction in which it slides about an axis at `u − u*`: 1 or −1; `None` where it sticks.
    pub fn sliding(&self, axis: usize, bend: Vec3) -> Option<f64> {
        let (stretch, slides) = self.at(axis, bend);
        slides.then(|| stretch.signum())
    }

    /// `h` of eq. (1) at `u − u*`.
    pub fn moment(&self, bend: Vec3) -> Vec3 {
        let mut moment = Vec3::ZERO;
        for axis in 0..BENDING_AXES {
            let (stretch, slides) = self.at(axis, bend);
            moment[axis] = if slides {
                self.limit[axis] * stretch.signum()
            } else {
                self.stiffness[axis] * stretch
            };
        }
        moment
    }

    /// `∂h/∂e` at `u − u*`.
    pub fn tangent(&self, bend: Vec3) -> Vec3 {
        let mut tangent = Vec3::ZERO;
        for axis in 0..BENDING_AXES {
            if !self.at(axis, bend).1 {
                tangent[axis] = self.stiffness[axis];
            }
        }
        tangent
    }

    /// The same as a matrix.
    pub fn tangent_matrix(&self, bend: Vec3) -> Mat3 {
        Mat3::diagonal(self.tangent(bend))
    }

    /// `ψ` of eq. (1) at `u − u*`, of both axes.
    pub fn energy(&self, bend: Vec3) -> f64 {
        let of_axis = |axis: usize| {
            let (stretch, slides) = self.at(axis, bend);
            let (limit, stiffness) = (self.limit[axis], self.stiffness[axis]);
            if slides {
                limit * (stretch.abs() - 0.5 * limit / stiffness)
            } else {
                0.5 * stiffness * stretch * stretch
            }
        };
        (0..BENDING_AXES).map(of_axis).sum()
    }

    /// `u − u*` about an axis under a moment that friction and an elastic stiffness bear together.
    pub fn bend(&self, axis: usize, elastic: f64, moment: f64) -> f64 {
        let (stiffness, plastic) = (self.stiffness[axis], self.plastic[axis]);
        let stuck = (moment + stiffness * plastic) / (elastic + stiffness);
        let stretch = stuck - plastic;
        if self.holds(axis, stretch) {
            stuck
        } else {
            (moment - self.limit[axis] * stretch.signum()) / elastic
        }
    }

    /// Takes the branch of eq. (1) that this friction is on at `u − u*` for the whole of the law: for differences beside an answer.
    pub fn stay_on_branch_of(&mut self, answer: &Self, bend: Vec3) {
        for axis in 0..BENDING_AXES {
            match answer.sliding(axis, bend) {
                None => self.limit[axis] = f64::INFINITY,
                Some(sign) => self.plastic[axis] = -sign * f64::INFINITY,
            }
        }
    }

    /// Whether a spring is at its limit about some axis at `u − u*`: there friction begins to slide on one side and sticks on the other.
    pub fn is_at_limit(&self, bend: Vec3) -> bool {
        (0..BENDING_AXES).any(|axis| {
            let (limit, stretch) = (self.limit[axis], bend[axis] - self.plastic[axis]);
            limit > 0.0 && (self.stiffness[axis] * stretch.abs() - limit).abs() <= NEAR * limit
        })
    }

    /// `κ⁺` of eq. (2) at `u − u*`.
    pub fn left(&self, bend: Vec3) -> [f64; BENDING_AXES] {
        core::array::from_fn(|axis| match self.sliding(axis, bend) {
            None => self.plastic[axis],
            Some(sign) => bend[axis] - sign * self.limit[axis] / self.stiffness[axis],
        })
    }
}
