//! A part of the robot near an obstacle, and the push between them.

use whipcord_numerics::{Pose, Vec3};

use super::body::{Nearest, wrench_of};
use super::friction::Grip;
use super::member::Member;
use super::model::Compliant;
use super::scene::Scene;
use super::sliding::Slide;
use crate::obstacle::Obstacle;

/// Overlap that is not mended, as a part of the length.
pub(super) const OVERLAP: f64 = 1e-8;

/// A part near an obstacle, and the push between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub obstacle: usize,
    pub member: Member,
    pub nearest: Nearest,
    /// Whether it keeps its place on the body: where a rim is about as near to the obstacle all around, as in a narrow bore,
    /// the nearest place is not defined well enough to be followed.
    pub keeps_place: bool,
    /// Force along the normal in N, not negative.
    pub force: f64,
    /// Force and moment on the cross-section that the model was last given.
    pub given: [f64; 6],
    /// How it holds on to the obstacle; `None` without friction.
    pub grip: Option<Grip>,
    /// How it moves along the backbone; `None` where it keeps its place.
    pub slide: Option<Slide>,
    /// How far it has moved along the backbone in the last step of a search for an equilibrium, in m; infinite before.
    pub moved: f64,
    /// Whether it keeps its place along the backbone from now on.
    pub is_placed: bool,
}

impl Pair {
    pub fn new(obstacle: usize, member: Member, nearest: Nearest) -> Self {
        Self {
            obstacle,
            member,
            nearest,
            keeps_place: false,
            force: 0.0,
            given: [0.0; 6],
            grip: None,
            slide: None,
            moved: f64::INFINITY,
            is_placed: false,
        }
    }

    /// Where it is nearest to its obstacle at a pose of the cross-section.
    pub fn look(&self, obstacle: &Obstacle, pose: &Pose) -> Nearest {
        let (body, local) = (&self.member.body, self.nearest.local);
        if self.keeps_place {
            body.at_place(obstacle, pose, local)
        } else {
            body.track(obstacle, pose, local)
        }
    }

    /// Angle on the rim.
    pub fn angle(&self) -> f64 {
        self.nearest.local[1].atan2(self.nearest.local[0])
    }

    /// The force along the surface on the robot, in N.
    pub fn traction(&self) -> Vec3 {
        self.grip.map_or(Vec3::ZERO, |grip| grip.traction)
    }

    /// Force and moment on the cross-section, where it is now.
    pub fn push(&self) -> [f64; 6] {
        let drag = wrench_of(self.traction(), self.nearest.lever(self.member.body.rounding));
        let push = self.nearest.push();
        core::array::from_fn(|a| self.force * push[a] + drag[a])
    }

    /// Takes over what a step found, or a part of it.
    pub fn hold(&mut self, sticks: bool, traction: Vec3, part: f64) {
        let touches = self.force > 0.0;
        if let Some(grip) = &mut self.grip {
            grip.take(touches, sticks, traction, part);
        }
    }
}

/// The grip of a part that comes near, where the obstacle has friction.
pub(super) fn grip(
    model: &impl Compliant,
    scene: &Scene,
    obstacle: usize,
    arc_length: f64,
) -> Option<Grip> {
    let coefficient = scene.get(obstacle).friction;
    let from = || scene.carried(model.pose_before(arc_length));
    (coefficient > 0.0).then(|| Grip::new(coefficient, from()))
}
