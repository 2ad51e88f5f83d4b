//! Dampers between the robot and where it was, eq. (12) of `docs/theory/contact.md`: with them it moves to a stable equilibrium where it has lost one.

use whipcord_numerics::{Pose, Vec3};

use super::model::{Compliant, Push};
use crate::shape::Wrench;

/// So many cross-sections are held by dampers.
const COUNT: usize = 6;
/// Stiffness against rotation, relative to that against displacement times the square of the length.
const ROTATIONAL: f64 = 0.05;

/// A cross-section that is drawn to where it was.
#[derive(Clone, Copy, Debug)]
pub(super) struct Damper {
    pub arc_length: f64,
    anchor: Pose,
    /// In N/m and N·m.
    stiffness: [f64; 2],
    /// Force and moment that the model was last given.
    pub given: [f64; 6],
}

impl Damper {
    /// Force and moment on the cross-section at a pose.
    pub fn push(&self, pose: &Pose) -> [f64; 6] {
        let [linear, angular] = self.stiffness;
        let force = (self.anchor.position - pose.position) * linear;
        let moment = (self.anchor.rotation * pose.rotation.conjugate()).log() * angular;
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }

    /// How force and moment fall with displacement and rotation.
    pub fn stiffness(&self, component: usize) -> f64 {
        self.stiffness[component / 3]
    }
}

/// Dampers along the robot; none where it is held by nothing but its contacts.
#[derive(Clone, Debug, Default)]
pub(super) struct Dampers {
    pub all: Vec<Damper>,
}

impl Dampers {
    /// Dampers at the place where the robot is, of a stiffness in units of EI/L³ for them all.
    pub fn anchor(&mut self, model: &impl Compliant, length: f64, stiffness: f64) {
        let linear = stiffness * model.force_scale() / (length * COUNT as f64);
        let angular = ROTATIONAL * linear * length * length;
        let watched = model.watched();
        self.all.clear();
        for k in 1..=COUNT {
            let target = length * k as f64 / COUNT as f64;
            let next = watched.partition_point(|&s| s < target).min(watched.len() - 1);
            let arc_length = watched[next];
            let anchor = model.pose(arc_length);
            self.all.push(Damper {
                arc_length,
                anchor,
                stiffness: [linear, angular],
                given: [0.0; 6],
            });
        }
    }

    /// What the model is given.
    pub fn pushes(&self, into: &mut Vec<Push>) {
        into.extend(self.all.iter().map(|damper| {
            let [fx, fy, fz, mx, my, mz] = damper.given;
            let wrench = Wrench { force: Vec3::new(fx, fy, fz), moment: Vec3::new(mx, my, mz) };
            Push { arc_length: damper.arc_length, wrench }
        }));
    }

    /// How far what the model was given is from what they push, relative to a force and a length.
    pub fn residual(&self, model: &impl Compliant, force: f64, length: f64) -> f64 {
        let of = |damper: &Damper| {
            let push = damper.push(&model.pose(damper.arc_length));
            let lack: [f64; 6] = core::array::from_fn(|a| push[a] - damper.given[a]);
            let [linear, angular] =
                [0, 3].map(|i| Vec3::new(lack[i], lack[i + 1], lack[i + 2]).norm());
            (linear + angular / length) / force
        };
        self.all.iter().map(of).fold(0.0, f64::max)
    }
}
