//! Solve times among obstacles: `cargo bench -p whipcord --bench contact`. A finger of nine sections bends
//! against a ball beside it.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use divan::Bencher;
use whipcord::cosserat::{self, Cosserat};
use whipcord::four_bar::{self, FourBar, LengthRule, Objective};
use whipcord::linkage::{Linkage, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, Loads, Material, Obstacle, Pose, Robot, Routing,
    Section, Shortening, UnitQuaternion, Vec3, piecewise_constant_curvature, pseudo_rigid_body,
};

fn main() {
    divan::main();
}

fn finger() -> Robot {
    let length = 0.18;
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone { material, section, ..Backbone::new(length) };
    let disks = Disks { outer_radius: Some(0.01), ..Disks::equally_spaced(length, 10, 0.008) };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

fn case(shortening: f64) -> Case {
    let position = Vec3::new(0.05, 0.005, 0.12);
    let ball = Obstacle {
        name: "ball".to_owned(),
        form: Form::Sphere { radius: 0.03 },
        pose: Pose { position, rotation: UnitQuaternion::IDENTITY },
        friction: 0.0,
        movable: None,
    };
    Case { obstacles: vec![ball], ..Case::with_shortenings(&[Shortening::Length(shortening)]) }
}

fn chain(robot: &Robot) -> FourBar {
    let options = four_bar::Options {
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        ..Default::default()
    };
    FourBar::new(robot, &options).unwrap()
}

fn rod(robot: &Robot) -> Cosserat {
    let options = cosserat::Options { actuation: Actuation::Shortening, ..Default::default() };
    Cosserat::new(robot, &Loads::default(), &options).unwrap()
}

#[divan::bench]
fn four_bar_cold(bencher: Bencher) {
    let (model, case) = (chain(&finger()), case(0.004));
    let mut workspace = four_bar::Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

/// From a neighbour that is shortened by 1 % less.
#[divan::bench]
fn four_bar_warm(bencher: Bencher) {
    let (model, before, case) = (chain(&finger()), case(0.00396), case(0.004));
    let mut workspace = four_bar::Workspace::default();
    let start = model.solve(&before, None, &mut workspace).unwrap();
    bencher.bench_local(|| model.solve(&case, Some(&start), &mut workspace).unwrap());
}

/// The ball on the other side: nothing touches. Compare with `cosserat_without_obstacles`.
#[divan::bench]
fn cosserat_clear(bencher: Bencher) {
    let (model, mut case) = (rod(&finger()), case(0.004));
    case.obstacles[0].pose.position = Vec3::new(-0.05, 0.005, 0.12);
    let mut workspace = cosserat::Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

#[divan::bench]
fn cosserat_without_obstacles(bencher: Bencher) {
    let (model, case) = (rod(&finger()), Case { obstacles: vec![], ..case(0.004) });
    let mut workspace = cosserat::Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

#[divan::bench]
fn cosserat_cold(bencher: Bencher) {
    let (model, case) = (rod(&finger()), case(0.004));
    let mut workspace = cosserat::Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

#[divan::bench]
fn cosserat_warm(bencher: Bencher) {
    let (model, before, case) = (rod(&finger()), case(0.00396), case(0.004));
    let mut workspace = cosserat::Workspace::default();
    let start = model.solve(&before, None, &mut workspace).unwrap();
    bencher.bench_local(|| model.solve(&case, Some(&start), &mut workspace).unwrap());
}

/// Three cables by tension and a force on the tip, which press the finger against the ball.
fn three_cables(robot: &Robot, pull: f64) -> (Robot, Case) {
    let cable = |k: i32| {
        let angle = f64::from(k) * core::f64::consts::TAU / 3.0;
        Cable::new(format!("{k}"), Routing::Straight { angle, radius: 0.008 })
    };
    let cables = (0..3).map(cable).collect();
    let robot = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
    let loads = Loads { tip_force: Vec3::new(0.02, 0.01, -0.02), ..Loads::default() };
    let tensions = Case::with_tensions(&[pull, 0.5, 0.4]);
    (robot, Case { loads, obstacles: case(0.004).obstacles, ..tensions })
}

fn three_cable_rod(robot: &Robot, case: &Case) -> Cosserat {
    Cosserat::new(robot, &case.loads, &cosserat::Options::default()).unwrap()
}

#[divan::bench]
fn cosserat_three_cables_cold(bencher: Bencher) {
    let (robot, case) = three_cables(&finger(), 3.0);
    let model = three_cable_rod(&robot, &case);
    let mut workspace = cosserat::Workspace::default();
    assert!(!model.solve(&case, None, &mut workspace).unwrap().contacts.is_empty());
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

/// From a neighbour that is pulled by 1 % less.
#[divan::bench]
fn cosserat_three_cables_warm(bencher: Bencher) {
    let (robot, case) = three_cables(&finger(), 3.0);
    let (_, before) = three_cables(&finger(), 2.97);
    let model = three_cable_rod(&robot, &case);
    let mut workspace = cosserat::Workspace::default();
    let start = model.solve(&before, None, &mut workspace).unwrap();
    bencher.bench_local(|| model.solve(&case, Some(&start), &mut workspace).unwrap());
}

/// Arcs, then rigid bodies.
fn sections(robot: &Robot) -> [Linkage; 2] {
    let actuation = Actuation::Shortening;
    let arcs = piecewise_constant_curvature::Options { actuation, ..Default::default() };
    let bodies = pseudo_rigid_body::Options { actuation, ..Default::default() };
    [
        piecewise_constant_curvature::build(robot, &arcs).unwrap(),
        pseudo_rigid_body::build(robot, &bodies).unwrap(),
    ]
}

#[divan::bench(args = [0, 1])]
fn sections_cold(bencher: Bencher, model: usize) {
    let (model, case) = (&sections(&finger())[model], case(0.004));
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}

#[divan::bench(args = [0, 1])]
fn sections_warm(bencher: Bencher, model: usize) {
    let (model, before, case) = (&sections(&finger())[model], case(0.00396), case(0.004));
    let mut workspace = Workspace::default();
    let start = model.solve(&before, None, &mut workspace).unwrap();
    bencher.bench_local(|| model.solve(&case, Some(&start), &mut workspace).unwrap());
}

/// The ball on the other side: nothing touches.
#[divan::bench(args = [0, 1])]
fn sections_clear(bencher: Bencher, model: usize) {
    let (model, mut case) = (&sections(&finger())[model], case(0.004));
    case.obstacles[0].pose.position = Vec3::new(-0.05, 0.005, 0.12);
    let mut workspace = Workspace::default();
    bencher.bench_local(|| model.solve(&case, None, &mut workspace).unwrap());
}
