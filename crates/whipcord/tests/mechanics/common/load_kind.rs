//! Random robots that carry loads along their backbone and masses, beside what [`super::robot`] loads.

use proptest::collection::vec;
use proptest::prelude::*;
use whipcord::{Case, DistributedLoad, PointMass, Profile, Robot, Vec3};

use super::{Wildness, ball, bending_stiffness, robot};

/// A load along the backbone without dimension: where its stations are, force and moment at them, and
/// whether it is constant.
type RawSpread = (Vec<f64>, Vec<Vec3>, Vec<Vec3>, bool);

fn spread() -> impl Strategy<Value = RawSpread> {
    // Between the stations at least a twentieth of the length.
    (vec(0.05..0.3_f64, 2..5), proptest::bool::ANY).prop_flat_map(|(gaps, constant)| {
        let mut at = 0.0;
        let places: Vec<f64> = gaps
            .iter()
            .map(|gap| {
                at += gap;
                f64::min(at, 1.0)
            })
            .collect();
        let count = places.len();
        (Just(places), vec(ball(), count), vec(ball(), count), Just(constant))
    })
}

/// A robot with up to two loads along its backbone, of up to the size that `wild` gives single forces and
/// moments, and up to two masses, each up to that of the backbone.
pub fn burdened(wild: Wildness) -> impl Strategy<Value = (Robot, Case)> {
    let masses = vec((0.0..=1.0_f64, 0.0..1.0_f64), 0..3);
    (robot(wild), vec(spread(), 1..3), masses).prop_map(move |((robot, case), spread, masses)| {
        load_kind(wild, robot, case, &spread, &masses)
    })
}

fn load_kind(
    wild: Wildness,
    robot: Robot,
    mut case: Case,
    spread: &[RawSpread],
    masses: &[(f64, f64)],
) -> (Robot, Case) {
    let length = robot.backbone().length;
    let stiffness = bending_stiffness(&robot);
    let force = wild.force * stiffness / length.powi(3);
    let moment = 0.5 * wild.moment * stiffness / length.powi(2);
    let load = |(places, forces, moments, constant): &RawSpread| {
        let profile = if *constant {
            Profile::Constant {
                from: places[0] * length,
                to: places[1] * length,
                force: forces[0] * force,
                moment: moments[0] * moment,
            }
        } else {
            Profile::Linear {
                at: places.iter().map(|s| s * length).collect(),
                force: forces.iter().map(|&f| f * force).collect(),
                moment: moments.iter().map(|&m| m * moment).collect(),
            }
        };
        DistributedLoad { profile, follower: false }
    };
    case.loads.distributed = spread.iter().map(load).collect();
    let area = robot.backbone().section_at(robot.disks(), 0.0).unwrap().area;
    let own = robot.backbone().material.density.unwrap() * area * length;
    case.loads.masses =
        masses.iter().map(|&(s, m)| PointMass { at: s * length, mass: m * own }).collect();
    (robot, case)
}
