//! Solve times of the baseline models on the paper's case III, and on a straight cable for one arc:
//! `cargo bench -p whipcord --bench baselines`.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

mod case_3;

use case_3::TENSION;
use divan::Bencher;
use whipcord::{
    Actuation, Case, Model, Robot, Shortening, StabilityAnalysis, piecewise_constant_curvature,
    pseudo_rigid_body,
};
use whipcord::{ModelKind, Routing, Stations};

fn main() {
    divan::main();
}

fn measure(bencher: Bencher<'_, '_>, model: &Model, robot: &Robot, case: &Case) {
    let mut prepared = model.prepare(robot, &case.loads).unwrap();
    bencher.bench_local(|| prepared.solve(case, None).unwrap());
}

#[divan::bench]
fn one_arc_by_length(bencher: Bencher<'_, '_>) {
    let mut cables = case_3::robot().cables().to_vec();
    cables[0].routing = Routing::Straight { angle: 0.0, radius: 0.008 };
    let (backbone, disks) = (case_3::robot().backbone().clone(), case_3::robot().disks().clone());
    let robot = Robot::new(backbone, disks, cables).unwrap();
    let model = Model::new(ModelKind::ConstantCurvature, Stations::Disks, Actuation::Natural);
    measure(bencher, &model, &robot, &Case::with_shortenings(&[Shortening::Fraction(0.057)]));
}

fn arcs(actuation: Actuation) -> Model {
    let options = piecewise_constant_curvature::Options {
        actuation,
        stability: StabilityAnalysis::Off,
        ..Default::default()
    };
    Model::PiecewiseConstantCurvature(options)
}

fn bodies(actuation: Actuation) -> Model {
    let options = pseudo_rigid_body::Options {
        actuation,
        stability: StabilityAnalysis::Off,
        ..Default::default()
    };
    Model::PseudoRigidBody(options)
}

fn loaded() -> Case {
    Case { loads: case_3::loads(), ..Case::with_tensions(&[TENSION]) }
}

fn by_length() -> Case {
    Case::with_shortenings(&[Shortening::Fraction(0.057)])
}

#[divan::bench]
fn arcs_unloaded(bencher: Bencher<'_, '_>) {
    let case = Case::with_tensions(&[TENSION]);
    measure(bencher, &arcs(Actuation::Tension), &case_3::robot(), &case);
}

#[divan::bench]
fn arcs_loaded(bencher: Bencher<'_, '_>) {
    measure(bencher, &arcs(Actuation::Tension), &case_3::robot(), &loaded());
}

#[divan::bench]
fn arcs_by_length(bencher: Bencher<'_, '_>) {
    measure(bencher, &arcs(Actuation::Shortening), &case_3::robot(), &by_length());
}

#[divan::bench]
fn arcs_with_stability(bencher: Bencher<'_, '_>) {
    let case = Case::with_tensions(&[TENSION]);
    let model =
        Model::new(ModelKind::PiecewiseConstantCurvature, Stations::Disks, Actuation::Tension);
    measure(bencher, &model, &case_3::robot(), &case);
}

#[divan::bench]
fn bodies_unloaded(bencher: Bencher<'_, '_>) {
    let case = Case::with_tensions(&[TENSION]);
    measure(bencher, &bodies(Actuation::Tension), &case_3::robot(), &case);
}

#[divan::bench]
fn bodies_loaded(bencher: Bencher<'_, '_>) {
    measure(bencher, &bodies(Actuation::Tension), &case_3::robot(), &loaded());
}

#[divan::bench]
fn bodies_by_length(bencher: Bencher<'_, '_>) {
    measure(bencher, &bodies(Actuation::Shortening), &case_3::robot(), &by_length());
}

/// A length that another cable's keeps out of reach.
fn out_of_reach(bencher: Bencher<'_, '_>, model: &Model) {
    let straight = |degrees: f64| Routing::Straight { angle: degrees.to_radians(), radius: 0.008 };
    let mut cables = Vec::new();
    for degrees in [0.0, 120.0, 240.0] {
        let mut cable = case_3::robot().cables()[0].clone();
        (cable.name, cable.routing) = (format!("at {degrees}"), straight(degrees));
        cables.push(cable);
    }
    let (backbone, disks) = (case_3::robot().backbone().clone(), case_3::robot().disks().clone());
    let robot = Robot::new(backbone, disks, cables).unwrap();
    let case = Case::with_shortenings(&[0.6, 0.05, -0.05].map(Shortening::Fraction));
    let mut prepared = model.prepare(&robot, &case.loads).unwrap();
    bencher.bench_local(|| prepared.solve(&case, None).unwrap_err());
}

#[divan::bench]
fn arcs_out_of_reach(bencher: Bencher<'_, '_>) {
    out_of_reach(bencher, &arcs(Actuation::Shortening));
}

#[divan::bench]
fn bodies_out_of_reach(bencher: Bencher<'_, '_>) {
    out_of_reach(bencher, &bodies(Actuation::Shortening));
}
