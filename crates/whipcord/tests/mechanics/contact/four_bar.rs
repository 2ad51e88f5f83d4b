//! The strain-energy four-bar model among obstacles.

use super::{among, assert_clear, finger, moved, sphere, wall};
use whipcord::cosserat::{Cosserat, Options as RodOptions, Workspace as RodWorkspace};
use whipcord::four_bar::{FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{
    Actuation, Case, Loads, Obstacle, Pose, Robot, Shortening, Solution, SolveError,
    UnitQuaternion, Vec3,
};

const LENGTH: f64 = 0.18;
const STIFFNESS: f64 = 1.1e9 * core::f64::consts::PI * 0.003 * 0.003 * 0.003 * 0.003 / 64.0;

fn free_lengths() -> Options {
    Options { objective: Objective::StrainEnergy, lengths: LengthRule::Free, ..Options::default() }
}

fn solve(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    FourBar::new(robot, &free_lengths())?.solve(case, None, &mut Workspace::default())
}

fn shortened(millimetres: f64, obstacles: Vec<Obstacle>) -> Case {
    among(Case::with_shortenings(&[Shortening::Length(1e-3 * millimetres)]), obstacles)
}

/// With 40 sections the shape is the rod's within 0.5 % of the length, and so, about, are the forces.
#[test]
fn many_sections_lie_where_the_rod_does() {
    let robot = finger(40);
    let options = RodOptions { actuation: Actuation::Shortening, ..RodOptions::default() };
    let rod = Cosserat::new(&robot, &Loads::default(), &options).unwrap();
    for (millimetres, obstacle) in [
        (4.0, wall(0.05)),
        (8.0, wall(0.05)),
        (4.0, sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)),
        (12.0, sphere(Vec3::new(0.05, 0.005, 0.12), 0.03)),
    ] {
        let case = shortened(millimetres, vec![obstacle.clone()]);
        let solution = solve(&robot, &case).unwrap();
        let exact = rod.solve(&case, None, &mut RodWorkspace::default()).unwrap();
        let apart = solution.disks.distances(&exact.disks).fold(0.0, f64::max);
        assert!(apart < 0.01 * LENGTH, "{apart}");
        let total = |solution: &Solution| {
            let forces = solution.contacts.iter().map(|t| t.normal * t.force.unwrap());
            forces.fold(Vec3::ZERO, |sum, force| sum + force)
        };
        let (found, expected) = (total(&solution), total(&exact));
        let force_scale = STIFFNESS / (LENGTH * LENGTH);
        assert!((found - expected).norm() < 0.05 * (expected.norm() + force_scale));
        assert_clear(&robot, &solution, &obstacle);
    }
}

/// In the plane every section is in equilibrium by itself: its elastic moment, the cable's tension on its
/// lever and the wall's push, by a kinematics of its own, cancel.
#[test]
fn every_section_is_in_equilibrium() {
    let robot = finger(9);
    let solution = solve(&robot, &shortened(8.0, vec![wall(0.05)])).unwrap();
    let [touch] = solution.contacts[..] else { panic!("{:?}", solution.contacts) };
    let (tension, push) = (solution.cables[0].tension.unwrap(), touch.force.unwrap());
    let length = LENGTH / 9.0;
    let bends: Vec<f64> = solution
        .disks
        .poses
        .windows(2)
        .map(|pair| (pair[0].rotation.conjugate() * pair[1].rotation).log().y)
        .collect();
    // The rim of the last disk: a plate of radius 9 mm, rounded by 1 mm.
    let reach = |bends: &[f64]| {
        let (mut x, mut angle) = (0.0, 0.0_f64);
        for bend in bends {
            x += length * (angle + 0.5 * bend).sin();
            angle += bend;
        }
        x + 0.009 * angle.cos() + 0.001
    };
    for (k, &bend) in bends.iter().enumerate() {
        let h = 1e-5;
        let at = |h: f64| {
            let mut bends = bends.clone();
            bends[k] += h;
            reach(&bends)
        };
        let rise = (at(h) - at(-h)) / (2.0 * h);
        let elastic = STIFFNESS / length * bend;
        let pull = tension * 0.008 * (0.5 * bend).cos();
        let left = elastic - pull + push * rise;
        assert!(left.abs() < 1e-6 * pull, "section {k}: {left} N m of {pull}");
    }
    let base = solution.base_wrench.unwrap();
    assert!((base.force.x + push).abs() < 1e-9 && base.force.y.abs() < 1e-9);
}

#[test]
fn a_known_stiffness_gives_forces_and_none_gives_the_same_shape() {
    let robot = finger(9);
    let bare = {
        let mut backbone = robot.backbone().clone();
        backbone.material.young_modulus = None;
        Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap()
    };
    let case = shortened(4.0, vec![wall(0.05)]);
    let [with, without] = [&robot, &bare].map(|robot| solve(robot, &case).unwrap());
    assert!(with.contacts[0].force.is_some() && without.contacts[0].force.is_none());
    assert!(without.base_wrench.is_none());
    assert!(with.disks.rms_distance(&without.disks) < 1e-9 * LENGTH);
}

#[test]
fn the_geometric_variants_refuse_obstacles() {
    let robot = finger(9);
    let model = FourBar::new(&robot, &Options::default()).unwrap();
    let case = shortened(4.0, vec![wall(0.05)]);
    let error = model.solve(&case, None, &mut Workspace::default()).unwrap_err();
    assert!(error.to_string().contains("strain-energy"), "{error}");
}

/// An answer that the contacts alone keep from buckling is one to start from: nothing is left to do.
#[test]
fn the_answer_to_the_same_case_starts_where_it_ends() {
    let robot = finger(9);
    let model = FourBar::new(&robot, &free_lengths()).unwrap();
    for (millimetres, x) in [(6.0, 0.02), (7.0, 0.03), (8.0, 0.045)] {
        let case = shortened(millimetres, vec![wall(x)]);
        let answer = solve(&robot, &case).unwrap();
        assert!(!answer.contacts.is_empty());
        let again = model.solve(&case, Some(&answer), &mut Workspace::default()).unwrap();
        let apart = again.disks.distances(&answer.disks).fold(0.0, f64::max);
        assert!(apart < 1e-7 * LENGTH, "{millimetres} mm: {apart}");
    }
}

/// What touches nothing has the answer without obstacles, from a known answer too and wherever the base is. The lengths are met by
/// another method then, to what it leaves of the equations.
#[test]
fn what_touches_nothing_is_solved_alone() {
    let robot = finger(9);
    let model = FourBar::new(&robot, &free_lengths()).unwrap();
    let base = Pose {
        position: Vec3::new(0.3, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -1.1, 0.7)),
    };
    for millimetres in [3.0, 8.0] {
        let free = Case { base, ..shortened(millimetres, vec![]) };
        let far = moved(&sphere(Vec3::new(-0.1, 0.0, 0.1), 0.03), &base);
        let alone = solve(&robot, &free).unwrap();
        let case = among(free, vec![far]);
        let same = |answer: &Solution| {
            let apart = answer.disks.distances(&alone.disks).fold(0.0, f64::max);
            let diagnostics = &answer.diagnostics;
            assert!(apart < 1e-9 * LENGTH && answer.contacts.is_empty(), "{apart:e}");
            assert_eq!(answer.base_wrench, alone.base_wrench);
            assert_eq!(diagnostics.stable, alone.diagnostics.stable);
        };
        same(&solve(&robot, &case).unwrap());
        let before = solve(&robot, &shortened(0.9 * millimetres, vec![])).unwrap();
        let warm = model.solve(&case, Some(&before), &mut Workspace::default()).unwrap();
        same(&warm);
    }
}
