//! Energies of a rod in motion, and the power of what acts on it.

use whipcord_numerics::{Pose, Twist, Vec3};

use crate::block::dot;
use crate::element::POINTS;
use crate::iteration::Mechanics;
use crate::loads::NodeLoads;
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// Kinetic energy, energy of the strains and potential of gravity in J.
pub(crate) fn energies(
    rod: &Rod,
    loads: &NodeLoads,
    velocities: &[Twist],
    strains: &[Twist],
    poses: &[Pose],
) -> [f64; 3] {
    let mut energies = [0.0; 3];
    for ((node, velocity), pose) in
        rod.nodes.iter().zip(velocities).zip(poses).skip(loads.first_free())
    {
        let turning = node.inertia.scale(velocity.angular).dot(velocity.angular);
        energies[0] += 0.5 * (node.mass * velocity.linear.norm_squared() + turning);
        energies[2] -= node.mass * loads.gravity.dot(pose.position);
    }
    for (point, strain) in rod.points.iter().zip(strains) {
        let change = *strain - point.rest;
        energies[1] += 0.5 * point.weight * dot(&point.stiffness.apply(&change), &change);
    }
    energies
}

/// Powers in W.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Power {
    /// Of the cables on the rod, but for those of motors with inertia and for straight ones that act by the gradients of their lengths.
    pub cables: f64,
    /// Of loads other than gravity; without dead forces that act by the gradients of their heights.
    pub loads: f64,
    /// Of the base where it moves.
    pub base: f64,
    /// Of obstacles on the robot.
    pub contacts: f64,
    /// What damping and drag take.
    pub dissipated: f64,
}

impl Power {
    /// Powers at a stage that is solved.
    pub fn at(
        Mechanics { rod, loads }: Mechanics<'_>,
        stage: &mut Stage,
        scheme: &Scheme,
        drag: Vec3,
    ) -> Self {
        let is_gradient = rod.has_chords() && !scheme.conserves;
        if is_gradient {
            pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
            stage.find_cable_forces(rod, true);
        }
        let mut power = Self::default();
        if !loads.has_free_base {
            power.base = dot(&stage.base_force, &stage.velocities[0]);
        }
        let count = rod.cables.len();
        for (q, point) in rod.points.iter().enumerate() {
            let strain = stage.strains[q];
            let rate = (strain - stage.strain_history[q]) * (1.0 / scheme.g);
            if rod.is_damped {
                power.dissipated += point.weight * dot(&point.damping.apply(&rate), &rate);
            }
            if rod.has_chords() {
                // What acts by the gradient of lengths over a step is counted by the lengths.
                if is_gradient {
                    power.cables -= dot(&stage.potential[q], &rate);
                }
                continue;
            }
            for (i, cable) in rod.cables.iter().enumerate() {
                if q >= POINTS * cable.elements || stage.is_internal[i] {
                    continue;
                }
                let tension = stage.tension_at(rod, i, q);
                if tension == 0.0 {
                    continue;
                }
                let crossing = &rod.crossings[q * count + i];
                let pull = Pull::new(crossing, &strain, &stage.start[q], scheme).wrench(crossing);
                power.cables -= point.weight * tension * dot(&pull, &rate);
            }
        }
        for a in loads.first_free()..rod.nodes.len() {
            let (load, velocity, node) = (&stage.loads[a], &stage.velocities[a], &rod.nodes[a]);
            let turn = stage.poses[a].rotation.conjugate();
            let resistance = drag * node.share;
            power.dissipated += resistance.scale(velocity.linear).dot(velocity.linear);
            // What acts by the gradient of its height is counted by the height.
            let dead = if scheme.conserves { Vec3::ZERO } else { load.force };
            let force = turn.rotate(dead) + load.follower_force;
            let moment = turn.rotate(load.moment) + load.follower_moment;
            power.loads += force.dot(velocity.linear) + moment.dot(velocity.angular);
        }
        power
    }

    /// `self += f other`.
    pub fn add(&mut self, f: f64, other: &Self) {
        self.cables += f * other.cables;
        self.loads += f * other.loads;
        self.base += f * other.base;
        self.contacts += f * other.contacts;
        self.dissipated += f * other.dissipated;
    }
}
