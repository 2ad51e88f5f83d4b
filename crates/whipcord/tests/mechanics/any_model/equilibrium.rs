//! The whole robot is in equilibrium: what the base bears is the sum of all loads on the robot in its deformed shape.
//!
//! The sum is made here, from the frames that an answer gives at the points of a Gauss rule, and from the loads as the
//! case has them; it shares nothing with the models.

use proptest::prelude::*;
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, DistributedLoad, Form, LoadFrame, Loads, Material,
    ModelKind, Obstacle, PointLoad, PointMass, Pose, Profile, Robot, Shortening, Solution, Statics,
    Stations, UnitQuaternion, Vec3, Wrench,
};

use crate::common::load_kind::burdened;
use crate::common::{
    WITH_FORCES, Wildness, ball, bending_stiffness, model_with_forces, paper_backbone, samples,
    straight,
};

/// Of the points of a Gauss rule between two arc lengths, where they are and their weights.
fn gauss(from: f64, to: f64) -> [(f64, f64); 3] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let off = 0.6_f64.sqrt() * half;
    [(middle - off, half * 5.0 / 9.0), (middle, half * 8.0 / 9.0), (middle + off, half * 5.0 / 9.0)]
}

/// Arc lengths and weights of a rule along the whole backbone. Between two places at which anything is not smooth,
/// `pieces` panels.
fn rule(robot: &Robot, loads: &Loads, pieces: usize) -> Vec<(f64, f64)> {
    let mut places = robot.backbone().places();
    for load in &loads.distributed {
        places.extend(load.profile.knots());
    }
    for pair in robot.disks().arc_lengths.windows(2) {
        // The joints of the pseudo-rigid bodies.
        let h = pair[1] - pair[0];
        places.extend([0.0, 0.1, 0.45, 0.85, 1.0].map(|part| pair[0] + part * h));
    }
    places.sort_by(f64::total_cmp);
    let mut rule = Vec::new();
    for pair in places.windows(2) {
        let h = (pair[1] - pair[0]) / pieces as f64;
        if h > 1e-9 * robot.backbone().length {
            let piece = |k: usize| gauss(pair[0] + k as f64 * h, pair[0] + (k + 1) as f64 * h);
            rule.extend((0..pieces).flat_map(piece));
        }
    }
    rule
}

/// Force and moment for each metre at an arc length, of a profile.
fn spread_at(profile: &Profile, s: f64) -> [Vec3; 2] {
    match profile {
        Profile::Constant { from, to, force, moment } if (*from..=*to).contains(&s) => {
            [*force, *moment]
        }
        Profile::Constant { .. } => [Vec3::ZERO; 2],
        Profile::Linear { at, force, moment } => {
            let k = at.partition_point(|&there| there < s);
            if k == 0 || k == at.len() {
                return [Vec3::ZERO; 2];
            }
            let t = (s - at[k - 1]) / (at[k] - at[k - 1]);
            [force, moment].map(|list| match list.is_empty() {
                true => Vec3::ZERO,
                false => list[k - 1] * (1.0 - t) + list[k] * t,
            })
        }
    }
}

/// The sum of all loads on the robot, and of the sizes of their forces and moments, in the frame of the base.
struct Sum {
    total: Wrench,
    force: f64,
    moment: f64,
}

fn sum(robot: &Robot, case: &Case, solution: &Solution, rule: &[(f64, f64)]) -> Sum {
    let base = case.base;
    let mut sum = Sum { total: Wrench::default(), force: 0.0, moment: 0.0 };
    let turn = match case.loads.frame {
        LoadFrame::Base => base.rotation,
        LoadFrame::World => UnitQuaternion::IDENTITY,
    };
    let mut add = |pose: &Pose, force: Vec3, moment: Vec3, follower: bool| {
        let turn = if follower { pose.rotation } else { turn };
        let back = base.rotation.conjugate();
        let [force, moment] = [force, moment].map(|v| back.rotate(turn.rotate(v)));
        let arm = back.rotate(pose.position - base.position);
        sum.total.force += force;
        sum.total.moment += moment + arm.cross(force);
        sum.force += force.norm();
        sum.moment += moment.norm() + arm.norm() * force.norm();
    };
    let loads = &case.loads;
    let at = |s: f64| {
        let disk = robot.disks().arc_lengths.iter().position(|d| (d - s).abs() < 1e-9);
        solution.disks.poses[disk.unwrap()]
    };
    let tip = solution.disks.poses[solution.disks.poses.len() - 1];
    add(&tip, loads.tip_force, loads.tip_moment, loads.tip_follower);
    for point in loads.points.iter().filter(|point| point.at > 0.0) {
        add(&at(point.at), point.force, point.moment, point.follower);
    }
    let gravity = loads.gravity.unwrap_or_default();
    for mass in loads.masses.iter().filter(|mass| mass.at > 0.0) {
        add(&at(mass.at), gravity * mass.mass, Vec3::ZERO, false);
    }
    for pose in &solution.disks.poses[1..] {
        add(pose, gravity * robot.disks().mass, Vec3::ZERO, false);
    }
    assert_eq!(rule.len(), solution.shape.poses.len());
    for ((s, weight), pose) in rule.iter().zip(&solution.shape.poses) {
        let density = robot.backbone().linear_density_at(robot.disks(), *s).unwrap();
        add(pose, gravity * (density * weight), Vec3::ZERO, false);
        for load in &loads.distributed {
            let [force, moment] = spread_at(&load.profile, *s);
            add(pose, force * *weight, moment * *weight, load.follower);
        }
    }
    for touch in &solution.contacts {
        let to_base = base.inverse();
        let force = touch.normal * touch.force.unwrap() + touch.friction.unwrap();
        let force = to_base.rotation.rotate(force);
        let point = to_base.transform(touch.point);
        sum.total.force += force;
        sum.total.moment += point.cross(force);
        sum.force += force.norm();
        sum.moment += point.norm() * force.norm();
    }
    sum
}

/// What is left of equilibrium, relative to the loads: force and moment.
fn left(robot: &Robot, case: &Case, solution: &Solution, rule: &[(f64, f64)]) -> [f64; 2] {
    let Sum { total, force, moment } = sum(robot, case, solution, rule);
    let base = solution.base_wrench.unwrap();
    let tiny = f64::MIN_POSITIVE;
    [
        (base.force - total.force).norm() / (force + tiny),
        (base.moment - total.moment).norm() / (moment + tiny),
    ]
}

/// Random robots with every kind of load, moved to disks where a load sits at one place.
fn load_kinds() -> impl Strategy<Value = (Robot, Case)> {
    let wild = Wildness { cables: 3, tension: 0.5, force: 0.8, moment: 0.5, weight: 1.0 };
    let flags = (proptest::bool::ANY, proptest::bool::ANY, proptest::bool::ANY, ball(), ball());
    (burdened(wild), flags).prop_map(|((robot, mut case), (tip, spread, world, at, turn))| {
        let disks = &robot.disks().arc_lengths;
        let to_disk = |s: f64| {
            let near = |a: &&f64, b: &&f64| (**a - s).abs().total_cmp(&(**b - s).abs());
            *disks[1..].iter().min_by(near).unwrap()
        };
        case.loads.points.iter_mut().for_each(|point| point.at = to_disk(point.at));
        case.loads.masses.iter_mut().for_each(|mass| mass.at = to_disk(mass.at));
        let force = bending_stiffness(&robot) / robot.backbone().length.powi(2);
        case.loads.points.push(PointLoad {
            at: to_disk(0.4 * robot.backbone().length),
            force: at * (0.3 * force),
            moment: turn * (0.1 * force * robot.backbone().length),
            follower: true,
        });
        case.loads.tip_follower = tip;
        if let Some(load) = case.loads.distributed.first_mut().filter(|_| spread) {
            load.follower = true;
        }
        case.loads.frame = if world { LoadFrame::World } else { LoadFrame::Base };
        case.base = Pose { position: at, rotation: UnitQuaternion::exp(turn * 2.0) };
        (robot, case)
    })
}

fn assert_in_equilibrium(kinds: &[ModelKind], cases: usize, actuation: Actuation) {
    let mut worst = [[0.0_f64; 2]; 5];
    let mut solved = [0; 5];
    for (robot, mut case) in samples(load_kinds(), cases) {
        if actuation == Actuation::Shortening {
            for command in &mut case.commands {
                command.shortening = Some(Shortening::Fraction(0.01));
                command.tension = None;
            }
        }
        let rule = rule(&robot, &case.loads, 4);
        let stations = Stations::At(rule.iter().map(|(s, _)| *s).collect());
        for (k, &kind) in kinds.iter().enumerate() {
            let model = model_with_forces(kind, stations.clone(), actuation);
            let solution = match model.solve(&robot, &case) {
                Ok(solution) => solution,
                Err(_) => continue,
            };
            solved[k] += 1;
            let off = left(&robot, &case, &solution, &rule);
            worst[k] = [0, 1].map(|i| worst[k][i].max(off[i]));
        }
    }
    assert!(solved[..kinds.len()].iter().all(|&n| 10 * n > 6 * cases), "{solved:?}");
    assert!(worst.iter().flatten().all(|&off| off < 1e-6), "{worst:?}");
}

#[test]
fn the_base_bears_all_loads_in_every_model() {
    assert_in_equilibrium(&WITH_FORCES, 40, Actuation::Tension);
}

#[test]
fn the_base_bears_all_loads_with_cables_held_at_lengths() {
    assert_in_equilibrium(&WITH_FORCES, 20, Actuation::Shortening);
}

/// One load of every kind alone, so that none hides behind another.
#[test]
fn the_base_bears_each_kind_of_load() {
    let (robot, case) = samples(load_kinds(), 1).next().unwrap();
    let length = robot.backbone().length;
    let force = bending_stiffness(&robot) / (length * length);
    let (f, m) = (Vec3::new(0.4, -0.3, 0.2) * force, Vec3::new(0.1, 0.2, -0.1) * (force * length));
    let disk = robot.disks().arc_lengths[1];
    let point = PointLoad { at: disk, force: f, moment: m, follower: false };
    let constant = |from: f64, to: f64| DistributedLoad {
        profile: Profile::Constant { from, to, force: f / length, moment: m / length },
        follower: false,
    };
    let along = DistributedLoad {
        profile: Profile::Linear {
            at: vec![0.1 * length, 0.55 * length, 0.9 * length],
            force: vec![f / length, -f / length, f / length],
            moment: vec![m / length, m / length, -m / length],
        },
        follower: false,
    };
    let mass = robot.backbone().linear_density_at(robot.disks(), 0.0).unwrap() * length;
    let heavy = Some(f / mass);
    let none = Loads::default();
    let spread = |load: DistributedLoad| Loads { distributed: vec![load], ..none.clone() };
    let lists = [
        Loads { tip_force: f, ..none.clone() },
        Loads { tip_moment: m, tip_follower: true, ..none.clone() },
        Loads { tip_force: f, tip_follower: true, ..none.clone() },
        Loads { points: vec![point], ..none.clone() },
        Loads { points: vec![PointLoad { follower: true, ..point }], ..none.clone() },
        spread(constant(0.0, length)),
        spread(constant(0.0, length).following()),
        spread(constant(0.33 * length, 0.34 * length)),
        spread(along.clone()),
        spread(along.following()),
        Loads { gravity: heavy, ..none.clone() },
        Loads { gravity: heavy, masses: vec![PointMass { at: disk, mass }], ..none.clone() },
        Loads { gravity: heavy, frame: LoadFrame::World, ..none.clone() },
    ];
    for loads in lists {
        let case = Case { loads, ..case.clone() };
        let rule = rule(&robot, &case.loads, 4);
        let stations = Stations::At(rule.iter().map(|(s, _)| *s).collect());
        for kind in WITH_FORCES {
            let model = model_with_forces(kind, stations.clone(), Actuation::Tension);
            let solution = model.solve(&robot, &case).unwrap();
            let off = left(&robot, &case, &solution, &rule);
            assert!(off.iter().all(|&off| off < 1e-6), "{kind}: {off:?} {:?}", case.loads);
        }
    }
}

/// Obstacles push and rub, and the base bears that as well, wherever it is.
#[test]
fn the_base_bears_the_contacts_too() {
    let backbone = Backbone {
        material: Material { density: Some(1040.0), ..paper_backbone().material },
        ..paper_backbone()
    };
    let disks = Disks {
        outer_radius: Some(0.01),
        thickness: Some(0.002),
        mass: 1e-4,
        ..Disks::equally_spaced(0.18, 10, 0.008)
    };
    let robot = Robot::new(backbone, disks, vec![Cable::new("pull", straight(0.0))]).unwrap();
    let base = Pose {
        position: Vec3::new(0.3, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7)),
    };
    let force = bending_stiffness(&robot) / (0.18 * 0.18);
    let along = DistributedLoad::uniform(0.18, Vec3::new(0.2, 0.1, 0.0) * (force / 0.18));
    for (friction, distributed) in
        [(0.0, vec![]), (0.3, vec![]), (0.3, vec![along.clone()]), (0.0, vec![along.following()])]
    {
        let there = Pose { position: Vec3::new(0.05, 0.005, 0.12), ..Pose::IDENTITY };
        let ball = Obstacle {
            name: "ball".to_owned(),
            form: Form::Sphere { radius: 0.03 },
            pose: base * there,
            friction,
            movable: None,
        };
        let loads = Loads {
            gravity: Some(Vec3::new(0.0, 0.0, -9.81)),
            frame: LoadFrame::World,
            distributed,
            ..Loads::default()
        };
        let case = Case { loads, base, obstacles: vec![ball], ..Case::with_tensions(&[3.0]) };
        let rule = rule(&robot, &case.loads, 1);
        let stations = Stations::At(rule.iter().map(|(s, _)| *s).collect());
        for kind in WITH_FORCES {
            let model = model_with_forces(kind, stations.clone(), Actuation::Tension);
            let solution = model.solve(&robot, &case).unwrap();
            assert!(!solution.contacts.is_empty());
            let off = left(&robot, &case, &solution, &rule);
            assert!(off.iter().all(|&off| off < 1e-6), "{kind}: {off:?}");
        }
    }
}
