//! What must hold for the loads of any robot, whatever they are.

use crate::common::load_kind::burdened;
use crate::common::{Wildness, ball, bending_stiffness, config, distance, solve, solve_finely};
use proptest::prelude::*;
use whipcord::{
    Case, DistributedLoad, LoadFrame, Loads, PointLoad, Pose, Profile, Robot, Solution,
    UnitQuaternion, Vec3,
};

const CASES: u32 = if cfg!(debug_assertions) { 12 } else { 64 };

const FORCES: Wildness = Wildness { moment: 0.0, ..Wildness::LOADED };

fn loaded() -> impl Strategy<Value = (Robot, Case)> {
    burdened(Wildness::LOADED)
}

fn length(robot: &Robot) -> f64 {
    robot.backbone().length
}

/// Each vector of the loads, forces and moments alike, through this map.
fn mapped(loads: &Loads, map: impl Fn(Vec3) -> Vec3) -> Loads {
    let list = |vectors: &[Vec3]| vectors.iter().map(|&v| map(v)).collect();
    let spread = |load: &DistributedLoad| DistributedLoad {
        profile: match &load.profile {
            &Profile::Constant { from, to, force, moment } => {
                Profile::Constant { from, to, force: map(force), moment: map(moment) }
            }
            Profile::Linear { at, force, moment } => {
                Profile::Linear { at: at.clone(), force: list(force), moment: list(moment) }
            }
        },
        ..*load
    };
    let point = |p: &PointLoad| PointLoad { force: map(p.force), moment: map(p.moment), ..*p };
    Loads {
        gravity: loads.gravity.map(&map),
        tip_force: map(loads.tip_force),
        tip_moment: map(loads.tip_moment),
        points: loads.points.iter().map(point).collect(),
        distributed: loads.distributed.iter().map(spread).collect(),
        ..loads.clone()
    }
}

/// Mass of the backbone in kg: Gauss's rule between the places where its section kinks or steps, between
/// which the area is a polynomial of the second degree.
fn mass(robot: &Robot) -> f64 {
    let mut places = [robot.backbone().places(), robot.disks().arc_lengths.clone()].concat();
    places.extend([0.0, length(robot)]);
    places.sort_by(f64::total_cmp);
    let density = |s: f64| robot.backbone().linear_density_at(robot.disks(), s).unwrap();
    let piece = |ends: &[f64]| {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        let reach = half / 3.0_f64.sqrt();
        half * (density(middle - reach) + density(middle + reach))
    };
    places.windows(2).map(piece).sum()
}

/// A force at the tip, beside the other loads.
fn with_force(case: &Case, force: Vec3) -> Case {
    let loads = Loads { tip_force: case.loads.tip_force + force, ..case.loads.clone() };
    Case { loads, ..case.clone() }
}

/// Half the difference of what a case and its opposite change, over the size of the change.
fn slope(
    robot: &Robot,
    size: f64,
    changed: impl Fn(f64) -> Case,
    of: impl Fn(&Solution) -> f64,
) -> f64 {
    let at = |h: f64| of(&solve_finely(robot, &changed(h)));
    // Without the term of the third order.
    let half = |h: f64| (at(h) - at(-h)) / (2.0 * h);
    (4.0 * half(size) - half(2.0 * size)) / 3.0
}

proptest! {
    #![proptest_config(config(CASES))]

    /// Loads that are fixed in the world do not turn with the base; seen from a base that is turned and
    /// moved they are those of the base the other way round.
    #[test]
    fn a_moved_base_moves_the_answer((robot, case) in loaded(), turn in ball(), place in ball()) {
        let base = Pose { position: place, rotation: UnitQuaternion::exp(turn * 3.0) };
        let at_rest = solve(&robot, &case);
        let world = Loads {
            frame: LoadFrame::World,
            ..mapped(&case.loads, |v| base.rotation.rotate(v))
        };
        for loads in [case.loads.clone(), world] {
            let moved = solve(&robot, &Case { base, loads, ..case.clone() });
            let back = Solution {
                shape: moved.shape.clone().moved(base.inverse()),
                disks: moved.disks.clone().moved(base.inverse()),
                ..moved.clone()
            };
            let error = distance(&at_rest, &back);
            prop_assert!(error < 1e-9 * length(&robot) + 1e-14, "{error:.1e}");
            let (a, b) = (at_rest.base_wrench.unwrap(), moved.base_wrench.unwrap());
            prop_assert!((a.force - b.force).norm() <= 1e-7 * a.force.norm());
        }
    }

    /// What is given in parts is what is given at once.
    #[test]
    fn loads_add_up((robot, case) in loaded(), share in 0.1..0.9_f64) {
        let part = |factor: f64| mapped(&case.loads, |v| v * factor);
        let (a, b) = (part(share), part(1.0 - share));
        let split = Loads {
            // Gravity and tip loads there is one each of.
            gravity: case.loads.gravity,
            tip_force: case.loads.tip_force,
            tip_moment: case.loads.tip_moment,
            points: [a.points, b.points].concat(),
            distributed: [a.distributed, b.distributed].concat(),
            ..case.loads.clone()
        };
        let whole = solve_finely(&robot, &case);
        let parts = solve_finely(&robot, &Case { loads: split, ..case.clone() });
        let error = distance(&whole, &parts);
        prop_assert!(error < 1e-9 * length(&robot), "{error:.1e}");
    }

    /// The base bears all that acts: nothing is lost on the way, and the moment is that about the base.
    #[test]
    fn the_base_bears_all_loads((robot, case) in loaded()) {
        let solution = solve_finely(&robot, &case);
        let Loads { points, distributed, masses, .. } = &case.loads;
        let mut force = case.loads.tip_force;
        for p in points {
            force += p.force;
        }
        for piece in distributed.iter().flat_map(|load| load.profile.pieces()) {
            force += (piece.force[0] + piece.force[1]) * (0.5 * (piece.at[1] - piece.at[0]));
        }
        if let Some(gravity) = case.loads.gravity {
            // A disk or a mass at the base loads the base, not the robot.
            let carried: f64 = masses.iter().filter(|m| m.at > 0.0).map(|m| m.mass).sum();
            let disks = robot.disks().mass * (robot.disks().count() - 1) as f64;
            let own = mass(&robot);
            force += gravity * (carried + disks + own);
        }
        let borne = solution.base_wrench.unwrap().force;
        let error = (borne - force).norm();
        prop_assert!(error < 1e-9 * force.norm(), "{borne:?} {force:?}");
    }

    /// A load that turns with the body is, in the shape that it leads to, the dead load that points where
    /// it has turned to.
    #[test]
    fn a_follower_is_the_dead_load_that_it_has_become((robot, case) in loaded()) {
        let mut following = case.clone();
        following.loads.tip_follower = true;
        for point in &mut following.loads.points {
            point.follower = true;
        }
        let stations = |s: f64| (s / length(&robot) * 10.0).round() / 10.0 * length(&robot);
        for point in &mut following.loads.points {
            // At a station, where the frame is known.
            point.at = stations(point.at);
        }
        let bent = solve_finely(&robot, &following);
        let frame = |s: f64| {
            let near = |i: &usize| (bent.shape.arc_length[*i] - s).abs();
            let count = bent.shape.poses.len();
            let i = (0..count).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
            bent.shape.poses[i].rotation
        };
        let mut dead = following.clone();
        let tip = bent.shape.tip().rotation;
        dead.loads.tip_follower = false;
        dead.loads.tip_force = tip.rotate(dead.loads.tip_force);
        dead.loads.tip_moment = tip.rotate(dead.loads.tip_moment);
        for point in &mut dead.loads.points {
            let turn = frame(point.at);
            *point = PointLoad {
                force: turn.rotate(point.force),
                moment: turn.rotate(point.moment),
                follower: false,
                ..*point
            };
        }
        let same = solve_finely(&robot, &dead);
        let error = distance(&bent, &same);
        prop_assert!(error < 1e-8 * length(&robot), "{error:.1e}");
    }
}

proptest! {
    // Each takes two dozen solves.
    #![proptest_config(ProptestConfig { max_shrink_iters: 0, ..config(CASES / 3) })]

    /// Betti: under loads that have a potential a force at the tip moves it as much along another as that
    /// other one moves it along the first, however far the robot is bent; and it lengthens a cable by as
    /// much as the cable's tension draws the tip against it. Dead moments have no potential.
    #[test]
    fn yields_are_reciprocal((robot, case) in burdened(FORCES), a in ball(), b in ball()) {
        let unit = bending_stiffness(&robot) / length(&robot).powi(2);
        let size = 3e-3 * unit;
        let yields = |along: Vec3, of: Vec3| {
            let at_tip = |s: &Solution| s.shape.tip().position.dot(of);
            slope(&robot, size, |h| with_force(&case, along * h), at_tip)
        };
        let scale = length(&robot).powi(3) / bending_stiffness(&robot);
        let (there, back) = (yields(a, b), yields(b, a));
        prop_assert!((there - back).abs() < 1e-6 * scale, "{there} {back}");

        let pulls = |h: f64| {
            let mut pulled = case.clone();
            pulled.commands[0].tension = case.commands[0].tension.map(|t| t + h);
            pulled
        };
        // Tension cannot be less than none.
        prop_assume!(case.commands[0].tension.unwrap() > 2.0 * size);
        let drawn = slope(&robot, size, pulls, |s| s.shape.tip().position.dot(a));
        let lengthened =
            slope(&robot, size, |h| with_force(&case, a * h), |s| s.cables[0].length);
        prop_assert!((drawn + lengthened).abs() < 1e-6 * scale, "{drawn} {lengthened}");
    }
}
