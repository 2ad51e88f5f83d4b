//! The strain that a warning names is that of beam theory.

use crate::common::ACCURATE;
use whipcord::warning::of_answer;
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Loads, Material, Model, ModelKind, Robot, Routing,
    Section, Statics, Stations, Vec3, Warning,
};

const L: f64 = 0.2;
const RADIUS: f64 = 0.001;
const MODULUS: f64 = 50e9;

/// A robot with a material that bears next to nothing, so that every strain is told of.
fn robot(disks: usize) -> Robot {
    let material = Material {
        young_modulus: Some(MODULUS),
        poisson_ratio: Some(0.3),
        yield_strain: Some(1e-5),
        ..Default::default()
    };
    let section = Some(Section::circle(2.0 * RADIUS));
    let backbone = Backbone { section, material, ..Backbone::new(L) };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.01 });
    Robot::new(backbone, Disks::equally_spaced(L, disks, 0.01), vec![cable]).unwrap()
}

fn bending_stiffness() -> f64 {
    MODULUS * core::f64::consts::PI * RADIUS.powi(4) / 4.0
}

/// The greatest strain on the surface and its arc length in m.
fn strain(kind: ModelKind, robot: &Robot, case: &Case) -> (f64, f64) {
    let model = Model::new(kind, Stations::Disks, Actuation::Tension).with_tolerance(ACCURATE);
    let solution = model.solve(robot, case).unwrap();
    let found = of_answer(robot, case, &solution).into_iter().find_map(|warning| match warning {
        Warning::Strain { strain, arc_length, .. } => Some((strain, arc_length)),
        _ => None,
    });
    found.unwrap()
}

const MODELS: [ModelKind; 4] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
];

/// Under a small force across the tip the strain is greatest at the base, `F L r / EI`.
#[test]
fn a_force_across_the_tip_strains_the_base_most() {
    let force = 0.05;
    let loads = Loads { tip_force: Vec3::X * force, ..Default::default() };
    let expected = force * L * RADIUS / bending_stiffness();
    for disks in [3, 6, 11] {
        let robot = robot(disks);
        let case = Case { loads: loads.clone(), ..Case::with_tensions(&[0.0]) };
        for kind in MODELS {
            let (found, at) = strain(kind, &robot, &case);
            let off = found / expected - 1.0;
            assert!(off.abs() < 0.03, "{kind}, {disks} disks: off by {off:.3}");
            assert!(at < 1e-9, "{kind}, {disks} disks: at {at}");
        }
    }
}

/// A moment rolls the backbone up to an arc: `M r / EI`, also where it turns by more than half a circle from disk to disk.
#[test]
fn a_moment_strains_it_all_alike_however_far_it_turns() {
    for turns in [0.2, 0.6, 0.9] {
        let moment = bending_stiffness() * turns * core::f64::consts::TAU / L;
        let loads = Loads { tip_moment: Vec3::Y * moment, ..Default::default() };
        let case = Case { loads, ..Case::with_tensions(&[0.0]) };
        let (found, _) = strain(ModelKind::Cosserat, &robot(2), &case);
        let expected = moment * RADIUS / bending_stiffness();
        assert!((found / expected - 1.0).abs() < 1e-6, "{turns} turns: {found} for {expected}");
    }
}
