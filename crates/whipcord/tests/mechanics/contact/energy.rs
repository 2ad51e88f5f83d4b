//! Sections among obstacles against the least energy: of few sections it is minimised here, with gaps in closed form and
//! the method of multipliers, whose multipliers are the forces of the contacts.

use whipcord::{
    Actuation, Cable, Case, Disks, Form, Model, ModelKind, Obstacle, Part, Pose, Robot, Routing,
    Stations, Vec3,
};
use whipcord_numerics::DenseLu;

use super::{LENGTH, STIFFNESS, among, finger, sphere, wall};
use crate::common::sections::{ARC, BODIES, Parts};

/// The gap of a rounded plate and an obstacle: a ball, or a wall at x.
fn gap(obstacle: &Obstacle, disk: &Pose, flat: f64, rounding: f64) -> f64 {
    let axis = disk.rotation.rotate(Vec3::Z);
    match obstacle.form {
        Form::HalfSpace => {
            let room = obstacle.pose.position.x - disk.position.x;
            room - flat * (1.0 - axis.x * axis.x).max(0.0).sqrt() - rounding
        }
        Form::Sphere { radius } => {
            let away = obstacle.pose.position - disk.position;
            let above = away.dot(axis);
            let aside = (away - axis * above).norm();
            above.hypot((aside - flat).max(0.0)) - radius - rounding
        }
        ref other => panic!("{other:?}"),
    }
}

/// Where the least energy is, and with which forces the gaps are kept open.
struct Least {
    q: Vec<f64>,
    forces: Vec<f64>,
}

/// By the method of multipliers, with Newton's method on differences of the energy alone.
fn minimise(
    unknowns: usize,
    energy: impl Fn(&[f64]) -> f64,
    gaps: impl Fn(&[f64]) -> Vec<f64>,
) -> Least {
    // So soft that no difference below reaches from a contact to where it opens.
    let penalty = 2000.0 * STIFFNESS / LENGTH.powi(3);
    let mut q = vec![0.0; unknowns];
    let mut forces = vec![0.0; gaps(&q).len()];
    for _ in 0..60 {
        let value = |q: &[f64]| {
            let held = gaps(q).into_iter().zip(&forces).map(|(gap, force)| {
                let after = (force - penalty * gap).max(0.0);
                (after * after - force * force) / (2.0 * penalty)
            });
            energy(q) + held.sum::<f64>()
        };
        descend(&mut q, value);
        let before = forces.clone();
        for (force, gap) in forces.iter_mut().zip(gaps(&q)) {
            *force = (*force - penalty * gap).max(0.0);
        }
        if forces.iter().zip(before).all(|(now, before)| (now - before).abs() < 1e-8) {
            break;
        }
    }
    Least { q, forces }
}

fn descend(q: &mut Vec<f64>, value: impl Fn(&[f64]) -> f64) {
    let n = q.len();
    let slope = |q: &[f64], k: usize| {
        let at = |step: f64| {
            let mut q = q.to_vec();
            q[k] += step;
            value(&q)
        };
        let h = 2e-5;
        (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    };
    let gradient = |q: &[f64]| -> Vec<f64> { (0..n).map(|k| slope(q, k)).collect() };
    let size = |list: &[f64]| list.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut lu = DenseLu::default();
    for _ in 0..60 {
        let here = gradient(q);
        if size(&here) < 1e-9 * STIFFNESS / LENGTH {
            return;
        }
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|k| {
                let at = |step: f64| {
                    let mut q = q.clone();
                    q[k] += step;
                    gradient(&q)
                };
                let [after, before] = [2e-5, -2e-5].map(at);
                after.iter().zip(before).map(|(a, b)| (a - b) / 4e-5).collect()
            })
            .collect();
        let start = value(q);
        // Damped until the energy falls: it is a minimum that is looked for.
        let mut damping = 0.0;
        loop {
            let entry = |i: usize, j: usize| {
                let own = if i == j { damping } else { 0.0 };
                0.5 * (columns[i][j] + columns[j][i]) + own
            };
            let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
            let mut step: Vec<f64> = here.iter().map(|x| -x).collect();
            lu.factor(n, &matrix).unwrap();
            lu.solve(&mut step);
            let next: Vec<f64> = q.iter().zip(&step).map(|(q, step)| q + step).collect();
            let falls = here.iter().zip(&step).map(|(g, s)| g * s).sum::<f64>() < 0.0;
            if falls && size(&step) < 0.5 && value(&next) <= start + 1e-15 * start.abs() {
                *q = next;
                break;
            }
            damping = (4.0 * damping).max(1e-4 * STIFFNESS / LENGTH);
            if damping > 1e6 * STIFFNESS / LENGTH {
                return;
            }
        }
    }
}

/// Coordinates of every section.
fn sections(parts: &Parts, q: &[f64]) -> Vec<Vec<f64>> {
    q.chunks(1 + 2 * parts.stiffness.len()).map(<[f64]>::to_vec).collect()
}

/// Disks that press against a wall and beside the middle of a ball, with two cables out of one plane.
#[test]
fn disks_rest_where_the_energy_is_least() {
    let bare = finger(3);
    let helix = Routing::Helix { start_angle: 1.0, turns: 0.3, radius: 0.008 };
    let cables = vec![bare.cables()[0].clone(), Cable::new("helix", helix)];
    let robot = Robot::new(bare.backbone().clone(), bare.disks().clone(), cables).unwrap();
    let (flat, rounding) = (0.009, 0.001);
    let mut contacts = 0;
    for parts in [&ARC, &BODIES] {
        for obstacles in [
            vec![wall(0.04)],
            vec![sphere(Vec3::new(0.05, 0.012, 0.12), 0.03)],
            vec![wall(0.06), sphere(Vec3::new(0.035, 0.05, 0.15), 0.025)],
        ] {
            let mut case = among(Case::with_tensions(&[2.0, 0.7]), obstacles);
            case.loads.tip_force = Vec3::new(0.03, 0.05, -0.02);
            let gaps = |q: &[f64]| -> Vec<f64> {
                let disks = parts.poses(&robot, &sections(parts, q));
                let of = |disk| case.obstacles.iter().map(move |o| gap(o, disk, flat, rounding));
                disks[1..].iter().flat_map(of).collect()
            };
            let energy = |q: &[f64]| parts.energy(&robot, &case, &sections(parts, q));
            let least = minimise(3 * (1 + 2 * parts.stiffness.len()), energy, gaps);
            let model = Model::new(parts.kind, Stations::Disks, Actuation::Tension);
            let found = model.prepare(&robot, &case.loads).unwrap().solve(&case, None).unwrap();
            let disks = parts.poses(&robot, &sections(parts, &least.q));
            for (a, b) in found.disks.poses.iter().zip(&disks) {
                let apart = (a.position - b.position).norm();
                assert!(
                    apart < 1e-7 * LENGTH,
                    "{} {apart:e} {:?} {:?}",
                    parts.kind,
                    found.contacts,
                    least.forces
                );
            }
            let mut forces = vec![0.0; least.forces.len()];
            for touch in &found.contacts {
                let Part::Disk(k) = touch.part else { panic!("{touch:?}") };
                forces[(k - 1) * case.obstacles.len() + touch.obstacle] += touch.force.unwrap();
            }
            let most = forces.iter().fold(0.0_f64, |most, force| most.max(*force));
            assert!(most > 0.01, "{forces:?}");
            for (a, b) in forces.iter().zip(&least.forces) {
                assert!(
                    (a - b).abs() < 1e-5 * most,
                    "{} {forces:?} {:?}",
                    parts.kind,
                    least.forces
                );
            }
            contacts += found.contacts.len();
        }
    }
    assert!(contacts >= 8, "the scenes test nothing: {contacts} contacts");
}

/// A bare backbone of rigid bodies bends away from a wall at its tip and presses its belly against it: what is nearest to a
/// wall is an end of a body, so that it touches with its joints and its disks.
#[test]
fn joints_rest_where_the_energy_is_least() {
    let bare = finger(3);
    let (radius, rounding, x) = (0.0015, 0.0001, 0.0024);
    let disks = Disks {
        outer_radius: Some(radius),
        thickness: Some(2.0 * rounding),
        ..bare.disks().clone()
    };
    let angle = core::f64::consts::PI;
    let cable = Cable::new("pull", Routing::Straight { angle, radius: 0.008 });
    let robot = Robot::new(bare.backbone().clone(), disks, vec![cable]).unwrap();
    let section = LENGTH / 3.0;
    // The disks, then the joints of each section.
    let gaps = |q: &[f64]| -> Vec<f64> {
        let q = sections(&BODIES, q);
        let disks = BODIES.poses(&robot, &q);
        let of_disk = |disk| gap(&wall(x), disk, radius - rounding, rounding);
        let joints = disks.iter().zip(&q).flat_map(|(disk, q)| {
            (0..3).map(move |k| x - (*disk * BODIES.joint(section, q, k)).position.x - radius)
        });
        disks[1..].iter().map(of_disk).chain(joints).collect()
    };
    let mut at_joints = 0;
    for (tension, force) in [(2.0, 0.12), (2.2, 0.12), (2.0, 0.15)] {
        let mut case = among(Case::with_tensions(&[tension]), vec![wall(x)]);
        case.loads.tip_force = Vec3::new(force, 0.002, 0.0);
        let energy = |q: &[f64]| BODIES.energy(&robot, &case, &sections(&BODIES, q));
        let least = minimise(21, energy, gaps);
        let model = Model::new(ModelKind::PseudoRigidBody, Stations::Disks, Actuation::Tension);
        let found = model.prepare(&robot, &case.loads).unwrap().solve(&case, None).unwrap();
        let disks = BODIES.poses(&robot, &sections(&BODIES, &least.q));
        for (a, b) in found.disks.poses.iter().zip(&disks) {
            let apart = (a.position - b.position).norm();
            assert!(apart < 1e-7 * LENGTH, "{apart:e} {:?} {:?}", found.contacts, least.forces);
        }
        let mut forces = vec![0.0; least.forces.len()];
        for touch in &found.contacts {
            let at = match touch.part {
                Part::Disk(k) => k - 1,
                Part::Backbone => {
                    let start = (touch.arc_length / section).floor();
                    let reach = [0.1, 0.45, 0.85].map(|t| (start + t) * section);
                    let joint = reach.iter().position(|at| (touch.arc_length - at).abs() < 1e-12);
                    3 + 3 * start as usize + joint.unwrap_or_else(|| panic!("{touch:?}"))
                }
            };
            forces[at] += touch.force.unwrap();
        }
        at_joints += forces[3..].iter().filter(|&&force| force > 0.01).count();
        for (a, b) in forces.iter().zip(&least.forces) {
            assert!((a - b).abs() < 1e-6, "{forces:?} {:?}", least.forces);
        }
    }
    assert!(at_joints > 1, "the scenes test nothing");
}
