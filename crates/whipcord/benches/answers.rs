//! What a program waits for, by the interface that all models share and with their default options:
//! `cargo bench -p whipcord --bench answers`. The parts of these times are in the benchmarks of the models.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

mod case_3;

use case_3::TENSION;
use divan::Bencher;
use whipcord::obstacle::Pipe;
use whipcord::{
    Backbone, Cable, Case, Differentiable as _, Disks, Form, Loads, Material, Model, ModelKind,
    Obstacle, Pose, Robot, Routing, Section, Shortening, Stations, UnitQuaternion, Vec3,
};

fn main() {
    divan::main();
}

const RODS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Default::default())
}

fn cold(bencher: Bencher, kind: ModelKind, robot: &Robot, case: &Case) {
    let mut model = model(kind).prepare(robot, &case.loads).unwrap();
    bencher.bench_local(|| model.solve(case, None).unwrap());
}

/// From a neighbour.
fn warm(bencher: Bencher, kind: ModelKind, robot: &Robot, [before, case]: [&Case; 2]) {
    let mut model = model(kind).prepare(robot, &case.loads).unwrap();
    let start = model.solve(before, None).unwrap();
    bencher.bench_local(|| model.solve(case, Some(&start)).unwrap());
}

fn pulled(share: f64) -> Case {
    Case::with_tensions(&[share * TENSION])
}

fn shortened(share: f64) -> Case {
    Case::with_shortenings(&[Shortening::Fraction(share * 0.057)])
}

fn loaded(case: Case) -> Case {
    Case { loads: case_3::loads(), ..case }
}

#[divan::bench(args = RODS)]
fn build(bencher: Bencher, kind: ModelKind) {
    let (robot, loads) = (case_3::robot(), case_3::loads());
    bencher.bench_local(|| model(kind).prepare(&robot, &loads).unwrap());
}

#[divan::bench(args = RODS)]
fn unloaded_cold(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &case_3::robot(), &pulled(1.0));
}

#[divan::bench(args = RODS)]
fn loaded_cold(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &case_3::robot(), &loaded(pulled(1.0)));
}

/// From a neighbour whose tension is 1 % lower.
#[divan::bench(args = RODS)]
fn loaded_warm(bencher: Bencher, kind: ModelKind) {
    let cases = [&loaded(pulled(0.99)), &loaded(pulled(1.0))];
    warm(bencher, kind, &case_3::robot(), cases);
}

#[divan::bench(args = RODS)]
fn loaded_by_length_cold(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &case_3::robot(), &loaded(shortened(1.0)));
}

/// From a neighbour that is shortened by 1 % less.
#[divan::bench(args = RODS)]
fn loaded_by_length_warm(bencher: Bencher, kind: ModelKind) {
    let cases = [&loaded(shortened(0.99)), &loaded(shortened(1.0))];
    warm(bencher, kind, &case_3::robot(), cases);
}

/// A cold solve with the Jacobian and the compliance of the tip; the model is built, too.
#[divan::bench(args = RODS)]
fn loaded_with_jacobian_and_compliance(bencher: Bencher, kind: ModelKind) {
    let (robot, case) = (case_3::robot(), loaded(pulled(1.0)));
    bencher.bench_local(|| model(kind).solve_at(&robot, &case, 0.18).unwrap());
}

#[divan::bench(args = RODS)]
fn unloaded_with_jacobian_and_compliance(bencher: Bencher, kind: ModelKind) {
    let (robot, case) = (case_3::robot(), pulled(1.0));
    bencher.bench_local(|| model(kind).solve_at(&robot, &case, 0.18).unwrap());
}

/// The paper's rod with straight cables and disks that are wider than their hole circle.
fn finger(cables: u32) -> Robot {
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone { material, section, ..Backbone::new(0.18) };
    let disks = Disks { outer_radius: Some(0.01), ..Disks::equally_spaced(0.18, 10, 0.008) };
    let cable = |k: u32| {
        let angle = f64::from(k) * core::f64::consts::TAU / f64::from(cables);
        Cable::new(format!("{k}"), Routing::Straight { angle, radius: 0.008 })
    };
    Robot::new(backbone, disks, (0..cables).map(cable).collect()).unwrap()
}

fn obstacle(form: Form, position: Vec3) -> Vec<Obstacle> {
    let pose = Pose { position, rotation: UnitQuaternion::IDENTITY };
    vec![Obstacle { name: "obstacle".to_owned(), form, pose, friction: 0.0, movable: None }]
}

/// A ball beside the finger, on the side to which it bends.
fn at_ball(case: Case) -> Case {
    let ball = Form::Sphere { radius: 0.03 };
    Case { obstacles: obstacle(ball, Vec3::new(0.05, 0.005, 0.12)), ..case }
}

/// A ball on the other side: nothing touches.
fn beside_ball(case: Case) -> Case {
    let ball = Form::Sphere { radius: 0.03 };
    Case { obstacles: obstacle(ball, Vec3::new(-0.05, 0.005, 0.12)), ..case }
}

fn one(share: f64) -> Case {
    Case::with_shortenings(&[Shortening::Length(share * 0.004)])
}

/// Three cables and a force at the tip.
fn three(share: f64) -> Case {
    let loads = Loads { tip_force: Vec3::new(0.05, 0.02, 0.0), ..Loads::default() };
    Case { loads, ..Case::with_tensions(&[share * 3.0, 0.5, 0.2]) }
}

#[divan::bench(args = RODS)]
fn nothing_touches(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &finger(1), &beside_ball(one(1.0)));
}

#[divan::bench(args = RODS)]
fn without_obstacles(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &finger(1), &one(1.0));
}

#[divan::bench(args = RODS)]
fn ball_cold(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &finger(1), &at_ball(one(1.0)));
}

/// From a neighbour that is shortened by 1 % less.
#[divan::bench(args = RODS)]
fn ball_warm(bencher: Bencher, kind: ModelKind) {
    warm(bencher, kind, &finger(1), [&at_ball(one(0.99)), &at_ball(one(1.0))]);
}

#[divan::bench(args = RODS)]
fn ball_three_cables_cold(bencher: Bencher, kind: ModelKind) {
    cold(bencher, kind, &finger(3), &at_ball(three(1.0)));
}

/// From a neighbour whose first tension is 1 % lower.
#[divan::bench(args = RODS)]
fn ball_three_cables_warm(bencher: Bencher, kind: ModelKind) {
    warm(bencher, kind, &finger(3), [&at_ball(three(0.99)), &at_ball(three(1.0))]);
}

/// The robot of `examples/contact/catheter-in-pipe.toml`.
fn catheter() -> Robot {
    let material =
        Material { young_modulus: Some(60e9), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(0.0015));
    let backbone = Backbone { material, section, ..Backbone::new(0.15) };
    let disks = Disks {
        outer_radius: Some(0.0015),
        thickness: Some(0.001),
        ..Disks::equally_spaced(0.15, 21, 0.001)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.001 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

/// Its pipe: straight, then a right angle on a radius of 80 mm.
fn in_pipe(case: Case) -> Case {
    let millimetres = [
        [0.0, -20.0],
        [0.0, 0.0],
        [0.0, 20.0],
        [0.0, 30.0],
        [1.22, 43.89],
        [4.82, 57.36],
        [10.72, 70.0],
        [18.72, 81.42],
        [28.58, 91.28],
        [40.0, 99.28],
        [52.64, 105.18],
        [66.11, 108.78],
        [80.0, 110.0],
        [100.0, 110.0],
        [130.0, 110.0],
    ];
    let points = millimetres.map(|[x, z]| Vec3::new(1e-3 * x, 0.0, 1e-3 * z));
    let pipe = Pipe::new(0.003, &points, Default::default()).unwrap();
    Case { obstacles: obstacle(Form::Pipe(pipe), Vec3::ZERO), ..case }
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn catheter_cold(bencher: Bencher) {
    let case = in_pipe(Case::with_tensions(&[20.0]));
    cold(bencher, ModelKind::Cosserat, &catheter(), &case);
}

/// From a neighbour whose tension is 1 % lower.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn catheter_warm(bencher: Bencher) {
    let at = |tension: f64| in_pipe(Case::with_tensions(&[tension]));
    warm(bencher, ModelKind::Cosserat, &catheter(), [&at(19.8), &at(20.0)]);
}

/// Nine cables of three segments that rub in their holes, with a force at the tip: one step from rest.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn friction_of_nine_cables(bencher: Bencher) {
    let segments = finger(9);
    let cables = segments.cables().iter().enumerate().map(|(i, cable)| {
        let ends_at = [0.06, 0.12, 0.18][i % 3];
        Cable { friction: Some(0.2), ends_at: Some(ends_at), ..cable.clone() }
    });
    let (backbone, disks) = (segments.backbone().clone(), segments.disks().clone());
    let robot = Robot::new(backbone, disks, cables.collect()).unwrap();
    let loads = Loads { tip_force: Vec3::new(0.05, 0.02, 0.0), ..Loads::default() };
    let tensions: Vec<f64> = (0..9).map(|i| 0.5 + 0.25 * f64::from(i % 4)).collect();
    let case = Case { loads, ..Case::with_tensions(&tensions) };
    cold(bencher, ModelKind::CosseratDisks, &robot, &case);
}
