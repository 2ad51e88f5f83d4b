//! Which equations a stage has.

use whipcord_numerics::Twist;

/// Which equations a stage has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scheme {
    /// `g`: velocities and strains are those of the history plus this time in s times their rates.
    pub g: f64,
    /// What the change of a velocity times the mass is multiplied by: `1/g`, or 0 in statics.
    pub inertia: f64,
    /// What the change of a strain times the damping is multiplied by: `1/g`, or 0 in statics.
    pub damping: f64,
    /// Where the stage lies between the start (0) and the end (1) of the step; the end is extrapolated.
    pub place: f64,
    /// Whether tensions and dead forces act by the discrete gradients of lengths and heights from the start to the end of the step.
    pub conserves: bool,
}

impl Scheme {
    /// A stage that lies at the end of its step.
    pub const fn at_end(g: f64) -> Self {
        Self { g, inertia: 1.0 / g, damping: 1.0 / g, place: 1.0, conserves: false }
    }

    /// The strain at the end of the step, from those at its start and at the stage.
    #[inline]
    pub fn end(&self, start: Twist, strain: Twist) -> Twist {
        start + (strain - start) * (1.0 / self.place)
    }

    /// Equilibrium: velocities are displacements.
    pub const STATICS: Self =
        Self { g: 1.0, inertia: 0.0, damping: 0.0, place: 1.0, conserves: false };
}
