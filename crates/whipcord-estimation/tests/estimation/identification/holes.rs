//! Fits of how far cables run beside the centres of their holes.

use core::f64::consts::TAU;

use crate::common::{paper_backbone, paper_disks};
use crate::identification::synthetic::{Normal, cases, disturb, experiments, model};
use whipcord::{Cable, Disks, HoleOffset, ModelKind, Robot, Routing};
use whipcord_estimation::identification::{ParameterPath, Settings, Unknown, identify, suspects};

/// Three cables through holes of disks with so many of them on circles of this radius.
fn robot(holes: usize, first: usize, radius: f64) -> Robot {
    let cables = [0, 1, 2].map(|i| {
        let hole = (first + i * holes / 3) % holes + 1;
        Cable::new(format!("c{i}"), Routing::holes(vec![hole; 10]))
    });
    let disks = Disks { hole_circle_radii: vec![radius; 10], holes: Some(holes), ..paper_disks() };
    Robot::new(paper_backbone(), disks, cables.to_vec()).unwrap()
}

fn unknowns(robot: &Robot, paths: &[&str]) -> Vec<Unknown> {
    let of = |path: &&str| path.parse::<ParameterPath>().unwrap().unknown(robot).unwrap();
    paths.iter().map(of).collect()
}

/// The real robot has its holes 3 ° farther round, on circles that are 0.3 mm smaller: finer disks, whose lists name these holes.
#[test]
fn a_turned_pattern_of_holes_is_found() {
    let (file, real) = (robot(12, 0, 0.008), robot(120, 1, 0.0077));
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks, ModelKind::PseudoRigidBody] {
        let mut seen = experiments(&model(kind), &real, &cases(&[1.0, 2.0, 3.0]));
        disturb(&mut seen, &mut Normal::new(3), [1e-5, 0.0]);
        let unknowns = unknowns(&file, &["cables[*].routing.angle", "cables[*].routing.radius"]);
        let found = identify(&file, &seen, &unknowns, &Settings::new(model(kind))).unwrap();
        assert!(found.status.is_converged());
        for (estimate, truth) in found.estimates.iter().zip([TAU / 120.0, -3e-4]) {
            assert!(!estimate.by_differences, "{kind}");
            let [low, high] = estimate.interval.unwrap();
            let off = (estimate.value - truth).abs();
            assert!(off < 2.0 * (high - low), "{kind}: {} {truth}", estimate.value);
            assert!(high - low < 0.05 * truth.abs(), "{kind}: {low} {high}");
        }
        // The robot with the estimates has them as offsets of its cables.
        let HoleOffset { angle, radius } = found.robot.cables()[1].hole_offset;
        assert_eq!([angle, radius], [found.estimates[0].value, found.estimates[1].value]);
    }
}

/// A single cable, towards the axis: what a radius could not be.
#[test]
fn the_offset_of_one_cable_may_be_negative() {
    let file = robot(12, 0, 0.008);
    let mut cables = file.cables().to_vec();
    cables[1].hole_offset = HoleOffset { angle: 0.05, radius: -4e-4 };
    let real = Robot::new(file.backbone().clone(), file.disks().clone(), cables).unwrap();
    let settings = Settings::new(model(ModelKind::Cosserat));
    let mut seen = experiments(&settings.model, &real, &cases(&[1.0, 2.0, 3.0]));
    disturb(&mut seen, &mut Normal::new(4), [1e-5, 0.0]);
    let unknowns = unknowns(&file, &["cables[1].routing.angle", "cables[1].routing.radius"]);
    let found = identify(&file, &seen, &unknowns, &settings).unwrap();
    assert!((found.estimates[0].value - 0.05).abs() < 1e-3, "{}", found.estimates[0].value);
    assert!((found.estimates[1].value + 4e-4).abs() < 1e-5, "{}", found.estimates[1].value);
    assert_eq!(unknowns[1].path(), "cables[1].routing.radius");
}

/// The cable whose holes are off stands out, though its angle is not asked for.
#[test]
fn a_cable_beside_its_holes_stands_out() {
    let file = robot(12, 0, 0.008);
    let mut cables = file.cables().to_vec();
    cables[2].hole_offset.angle = 0.08;
    let real = Robot::new(file.backbone().clone(), file.disks().clone(), cables).unwrap();
    let settings = Settings::new(model(ModelKind::Cosserat));
    let mut seen = experiments(&settings.model, &real, &cases(&[1.0, 2.0, 3.0]));
    disturb(&mut seen, &mut Normal::new(5), [2e-5, 0.0]);
    let unknowns = unknowns(&file, &["backbone.young_modulus"]);
    let found = identify(&file, &seen, &unknowns, &settings).unwrap();
    let all = suspects(&file, &seen, &unknowns, &settings, &found).unwrap();
    assert_eq!(all[0].quantity.to_string(), "cables[2].routing.angle");
    assert!((all[0].change - 0.08).abs() < 0.02, "{}", all[0].change);
    assert!(all[0].confirmed.is_some());
}
