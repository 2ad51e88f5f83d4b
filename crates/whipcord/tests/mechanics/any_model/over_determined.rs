//! Cable lengths that contradict each other, met in the least-squares sense, by every model that knows tensions.

use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Model, ModelKind, Robot, Shortening, Solution,
    SolveError, Statics as _, Stations, over_determined,
};

use crate::common::{paper_backbone, straight};

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::default(), Actuation::Shortening)
}

/// Models in whose answers the backbone does not buckle between the disks.
const KINDS: [ModelKind; 3] =
    [ModelKind::Cosserat, ModelKind::ConstantCurvature, ModelKind::PiecewiseConstantCurvature];

/// A backbone that does not get shorter, so that the lengths of straight cables have one sum.
fn robot(angles: &[f64]) -> Robot {
    let cables = angles.iter().map(|angle| Cable::new(format!("at {angle}"), straight(*angle)));
    let backbone = Backbone { extensible: false, ..paper_backbone() };
    Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), cables.collect()).unwrap()
}

fn shortened(by: &[f64]) -> Case {
    Case::with_shortenings(&by.iter().map(|by| Shortening::Length(*by)).collect::<Vec<_>>())
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

/// The common part of the shortenings is all that cannot be had: `Σ (m + δᵢ)²` is least for `δ = 0` where the `δᵢ` of a bend have the sum 0.
#[test]
fn what_three_cables_have_in_common_is_missed() {
    let three = robot(&[0.0, 120.0, 240.0]);
    // Of a bend, which an arc has; the sum is 0.
    let (bend, common) = ([4e-3, -1e-3, -3e-3], 6e-4);
    for kind in KINDS {
        let model = model(kind);
        let case = shortened(&bend.map(|by| by + common));
        let error = model.solve(&three, &case).unwrap_err();
        assert!(over_determined::may_be(&error), "{kind}: {error}");
        let found = over_determined::or(Err(error), &model, &three, &case).unwrap();
        let misses = &found.diagnostics.length_misses;
        assert_eq!(misses.len(), 3, "{kind}");
        // Cables that are straight between disks turn a little of a bend into a common part.
        let exact = kind != ModelKind::PiecewiseConstantCurvature;
        for miss in misses {
            let near = if exact { 1e-6 } else { 5e-5 };
            assert!((miss.excess - common).abs() < near, "{kind}: {} {}", miss.cable, miss.excess);
        }
        let knows_stability = kind != ModelKind::ConstantCurvature;
        assert_eq!(found.diagnostics.stable, knows_stability.then_some(true), "{kind}");
        assert!(found.cables.iter().all(|cable| cable.tension.is_none()));
        if !exact {
            continue;
        }
        // The same shape as by the lengths of the answer, of which one cable is free to be slack.
        let mut met = shortened(&bend);
        for (command, cable) in met.commands.iter_mut().zip(&found.cables) {
            let by = cable.initial_length - cable.length;
            command.shortening = Some(Shortening::Length(by));
        }
        met.commands[2].shortening = Some(Shortening::Length(-0.02));
        let met = model.solve(&three, &met).unwrap();
        assert!(apart(&found, &met) < 3e-5, "{kind}: {}", apart(&found, &met));
    }
}

/// Antagonists whose shortenings add up to something share it.
#[test]
fn antagonists_share_what_cannot_be_had() {
    let two = robot(&[0.0, 180.0]);
    let case = shortened(&[3e-3, -2e-3]);
    for kind in [ModelKind::Cosserat, ModelKind::PiecewiseConstantCurvature] {
        let found = over_determined::solve(&model(kind), &two, &case).unwrap();
        for miss in &found.diagnostics.length_misses {
            assert!((miss.excess - 5e-4).abs() < 3e-5, "{kind}: {}", miss.excess);
        }
        let bend = found.cables[0].initial_length - found.cables[0].length;
        assert!((bend - 2.5e-3).abs() < 3e-5, "{kind}: {bend}");
    }
}

#[test]
fn lengths_that_can_be_had_and_large_misses_are_no_compromise() {
    let three = robot(&[0.0, 120.0, 240.0]);
    let model = model(ModelKind::Cosserat);
    assert!(over_determined::solve(&model, &three, &shortened(&[4e-3, -2.5e-3, -3e-3])).is_none());
    let far = shortened(&[0.012; 3]);
    let error = model.solve(&three, &far).unwrap_err();
    assert!(matches!(error, SolveError::ContradictoryLengths { .. }), "{error}");
    assert_eq!(over_determined::or(Err(error.clone()), &model, &three, &far).unwrap_err(), error);
}

/// Where cables are straight between disks, a backbone under great tensions buckles there. Sections that are arcs, which cannot, say what is to be missed.
#[test]
fn bends_of_backbones_that_buckle_between_disks() {
    let three = robot(&[0.0, 120.0, 240.0]);
    for bend in [4e-3, 8e-3, 12e-3] {
        let case = shortened(&[bend, -0.25 * bend, -0.75 * bend].map(|by| by + 1e-3));
        let of = |kind| {
            let model = model(kind);
            over_determined::or(model.solve(&three, &case), &model, &three, &case).unwrap()
        };
        let arcs = of(ModelKind::PiecewiseConstantCurvature);
        for kind in [ModelKind::CosseratDisks, ModelKind::PseudoRigidBody] {
            let found = of(kind);
            let misses = &found.diagnostics.length_misses;
            assert_eq!(misses.len(), 3, "{kind} {bend}");
            assert_eq!(found.diagnostics.stable, Some(true));
            for (miss, other) in misses.iter().zip(&arcs.diagnostics.length_misses) {
                let off = (miss.excess - other.excess).abs();
                assert!(off < 0.12e-3, "{kind} {bend}: {} {}", miss.excess, other.excess);
            }
            let off = apart(&found, &arcs);
            assert!(off < 0.012 * 0.18, "{kind} {bend}: {off}");
        }
    }
}
