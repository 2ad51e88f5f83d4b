//! Dampers between the robot and where it was, eq. (12) of `docs/theory/contact.md`: with them it moves to a stable equilibrium where it has lost one.

use whipcord_numerics::{Pose, Vec3};

use super::model::{Compliant, Push};
use crate::shape::Wrench;

/// So many cross-sections are held by dampers.
const COUNT: usize = 6;
/// So many are guided to a line.
const GUIDED: usize = 20;
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
        let places = places(model, length, COUNT);
        let anchors = places.iter().map(|&s| model.pose(s)).collect();
        self.all.clear();
        self.hold(&places, anchors, stiffnesses(model, length, stiffness / COUNT as f64));
    }

    /// Dampers that draw the robot to poses, by the arc lengths in m of their cross-sections; they push as they did until the model looks again.
    pub fn guide(
        &mut self,
        model: &impl Compliant,
        length: f64,
        stiffness: f64,
        poses: impl Fn(&[f64]) -> Vec<Pose>,
    ) {
        let places = places(model, length, GUIDED);
        let anchors = poses(&places);
        self.hold(&places, anchors, stiffnesses(model, length, stiffness / GUIDED as f64));
    }

    fn hold(&mut self, places: &[f64], anchors: Vec<Pose>, stiffness: [f64; 2]) {
        let given: Vec<[f64; 6]> = self.all.iter().map(|damper| damper.given).collect();
        self.all.clear();
        self.all.extend(places.iter().zip(anchors).enumerate().map(
            |(k, (&arc_length, anchor))| {
                let given = given.get(k).copied().unwrap_or_default();
                Damper { arc_length, anchor, stiffness, given }
            },
        ));
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

/// Arc lengths in m of so many watched cross-sections, about as far from one another.
fn places(model: &impl Compliant, length: f64, count: usize) -> Vec<f64> {
    let watched = model.watched();
    let place = |k: usize| {
        let target = length * k as f64 / count as f64;
        watched[watched.partition_point(|&s| s < target).min(watched.len() - 1)]
    };
    let mut places: Vec<f64> = (1..=count).map(place).collect();
    places.dedup();
    places
}

/// Stiffnesses against displacement in N/m and rotation in N·m, of the first in units of EI/L³.
fn stiffnesses(model: &impl Compliant, length: f64, stiffness: f64) -> [f64; 2] {
    let linear = stiffness * model.force_scale() / length;
    [linear, ROTATIONAL * linear * length * length]
}
