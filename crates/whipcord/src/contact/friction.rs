//! Coulomb friction of a contact, eqs. (8) and (9) of `docs/theory/contact.md`.

use whipcord_numerics::{Pose, Vec3};

use super::body::{Nearest, along, tangents};

/// How a contact holds on to its obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grip {
    /// Coefficient of friction.
    pub coefficient: f64,
    /// Frame of the cross-section where the step on the way began, carried along with the obstacle.
    pub from: Pose,
    /// What touches has slid since then, in m.
    pub slip: Vec3,
    /// Force along the surface on the robot, in N.
    pub traction: Vec3,
    /// Whether that is less than friction could bear.
    pub sticks: bool,
}

impl Grip {
    pub fn new(coefficient: f64, from: Pose) -> Self {
        Self { coefficient, from, slip: Vec3::ZERO, traction: Vec3::ZERO, sticks: false }
    }

    /// What touches at a pose of the cross-section has slid since the step began.
    pub fn slip_at(&self, pose: &Pose, nearest: &Nearest, rounding: f64) -> Vec3 {
        nearest.slip(&self.from, pose, rounding)
    }

    /// Whether the traction is all, but for this part, that friction bears under a force in N: it slides on where it was, or sticks.
    pub fn is_at_bound(&self, force: f64, part: f64) -> bool {
        self.traction.norm() >= (1.0 - part) * self.coefficient * force
    }

    /// The directions along the surface in which a contact does not slide on from where it is: all of one that sticks; of one that slides
    /// the one across its traction, unless it `slides_across`: where it remembers where its step began, from where its slip turns the traction,
    /// and where something else keeps it from that.
    pub fn held_axes(&self, normal: Vec3, slides_across: bool) -> impl Iterator<Item = Vec3> {
        let across = normal.cross(self.traction);
        let across = across / across.norm();
        let (axes, count) = match (self.sticks, slides_across) {
            (true, _) => (tangents(normal), 2),
            (false, false) if across.is_finite() => ([across; 2], 1),
            (false, _) => ([Vec3::ZERO; 2], 0),
        };
        axes.into_iter().take(count)
    }

    /// How the traction of a contact that slides turns with its slip; with the normal it turns besides.
    pub fn turned(&self, slip: Vec3, normal: Vec3) -> Vec3 {
        let direction = self.slip / self.slip.norm();
        let size = self.traction.norm() / self.slip.norm();
        let across = slip - direction * direction.dot(slip) - normal * normal.dot(slip);
        across * -size
    }

    /// Takes over what a step found, or a part of it.
    pub fn take(&mut self, touches: bool, sticks: bool, traction: Vec3, part: f64) {
        let next = self.traction + (traction - self.traction) * part;
        self.traction = if touches { next } else { Vec3::ZERO };
        self.sticks = sticks && touches;
    }

    /// Looks again where the robot is now, and where the step began as carried along with the obstacle.
    pub fn refresh(&mut self, pose: &Pose, nearest: &Nearest, rounding: f64, from: Pose) {
        self.slip = Self { from, ..*self }.slip_at(pose, nearest, rounding);
        self.traction = along(self.traction, nearest.normal);
    }

    /// How far slip and traction are from eq. (9), as a force in N; the slip counts by a stiffness in N/m.
    pub fn complementarity_residual(&self, force: f64, stiffness: f64) -> f64 {
        let most = self.coefficient * force;
        let trial = self.traction - self.slip * stiffness;
        let size = trial.norm();
        let lawful = if size > most { trial * (most / size) } else { trial };
        (self.traction - lawful).norm()
    }
}
