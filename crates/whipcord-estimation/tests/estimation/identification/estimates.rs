//! What estimates are worth, and what is said of them.

use crate::common::{helix, paper_robot};
use crate::identification::synthetic::{
    Normal, cases, disturb, experiments, model, quantity, robot, settings, unknowns,
};
use whipcord::{Case, ModelKind, Parameter, Robot, Shortening, Vec3};
use whipcord_estimation::Seen;
use whipcord_estimation::identification::{
    Experiment, Prior, Robustness, Settings, Unknown, compare_models, cross_validate, identify,
};

fn noisy(noise: f64) -> Vec<Experiment> {
    let mut seen = experiments(&settings().model, &robot(), &cases(&[0.8, 1.6, 2.4]));
    disturb(&mut seen, &mut Normal::new(7), [noise, 0.0]);
    seen
}

#[test]
fn diameter_and_modulus_cannot_be_told_apart() {
    let seen = noisy(5e-4);
    let pair = unknowns(&["backbone.diameter", "backbone.young_modulus"]);
    let found = identify(&robot(), &seen, &pair, &settings()).unwrap();
    assert!(
        found.status.is_converged(),
        "{:?} {:?} {:?} {} {}",
        found.status,
        found.estimates,
        found.unresolved,
        found.iterations,
        found.evaluations
    );
    let [unresolved] = &found.unresolved[..] else { panic!("{:?}", found.unresolved) };
    // EI alone bends the rod: E d⁴.
    let words = unresolved.to_string();
    let product = "hardly more than the product backbone.young_modulus · backbone.diameter^4 is seen, not the two by themselves";
    assert!(words.starts_with(product), "{words}");
    assert!(found.correlations[0][1].unwrap() < -0.999);
    let [diameter, modulus] = &found.estimates[..] else { panic!() };
    let sure = |value: f64, deviation: Option<f64>| deviation.unwrap() / value;
    assert!(sure(modulus.value, modulus.deviation) > 0.1);
    // One of them alone is sure, and so is the product.
    let alone = identify(&robot(), &seen, &pair[..1], &settings()).unwrap();
    assert!(alone.unresolved.is_empty());
    assert!(sure(0.003, alone.estimates[0].deviation) < 1e-3);
    let product = modulus.value * diameter.value.powi(4);
    assert!((product / (1.1e9 * 0.003_f64.powi(4)) - 1.0).abs() < 0.01, "{product}");
}

/// A rod that neither stretches nor shears: nothing else than the product is seen at all.
#[test]
fn what_is_not_seen_at_all() {
    let robot = robot();
    let backbone =
        whipcord::Backbone { extensible: false, shearable: false, ..robot.backbone().clone() };
    let robot = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
    let mut seen = experiments(&settings().model, &robot, &cases(&[1.0, 2.0]));
    disturb(&mut seen, &mut Normal::new(3), [5e-4, 0.0]);
    let three = unknowns(&["backbone.diameter", "backbone.young_modulus", "base.position[0]"]);
    let found = identify(&robot, &seen, &three, &settings()).unwrap();
    let [unresolved] = &found.unresolved[..] else { panic!("{:?}", found.unresolved) };
    assert_eq!(
        unresolved.to_string(),
        "only the product backbone.young_modulus · backbone.diameter^4 is seen, not the two by themselves"
    );
    assert!(found.estimates[..2].iter().all(|e| e.deviation.is_none() && e.interval.is_none()));
    assert!(found.correlations[0].iter().all(Option::is_none));
    assert!(found.estimates[2].deviation.is_some_and(|deviation| deviation < 2e-4));
    // The pitch of the base and a rest curvature, and where a base is and where its loads are, do go apart.
    let apart = unknowns(&["base.turn[1]", "backbone.rest_curvature[1]"]);
    let found = identify(&robot, &seen, &apart, &settings()).unwrap();
    assert!(found.unresolved.is_empty(), "{}", found.unresolved[0]);
}

/// Without loads the shape under prescribed lengths is the same whatever the stiffness: what is left of its derivative by it is rounding.
#[test]
fn lengths_do_not_tell_the_stiffness() {
    let robot = robot();
    // All three are taut, and the backbone is pressed.
    let lengths = [[0.004, -0.0015, -0.0015], [0.008, -0.0035, -0.0035]]
        .map(|of| Case::with_shortenings(&of.map(Shortening::Length)));
    let settings = settings();
    let mut seen = experiments(&settings.model, &robot, &lengths);
    disturb(&mut seen, &mut Normal::new(5), [5e-4, 0.0]);
    let two = unknowns(&["backbone.young_modulus", "base.position[0]"]);
    let found = identify(&robot, &seen, &two, &settings).unwrap();
    let [unresolved] = &found.unresolved[..] else { panic!("{:?}", found.estimates) };
    let words = "nothing that was measured depends on backbone.young_modulus";
    assert_eq!(unresolved.to_string(), words);
    assert!(found.estimates[0].deviation.is_none() && found.estimates[0].interval.is_none());
    assert!(found.estimates[1].deviation.is_some_and(|deviation| deviation < 1e-3));
    // Tensions do.
    let mut seen = experiments(&settings.model, &robot, &cases(&[1.0, 2.0]));
    disturb(&mut seen, &mut Normal::new(5), [5e-4, 0.0]);
    let found = identify(&robot, &seen, &two, &settings).unwrap();
    assert!(found.unresolved.is_empty() && found.estimates[0].deviation.is_some());
}

/// What is known besides resolves what measurements do not: the modulus within 5 % leaves the diameter within
/// 5 %/4.
#[test]
fn priors_resolve() {
    let seen = noisy(5e-4);
    let mut pair = unknowns(&["backbone.diameter", "backbone.young_modulus"]);
    pair[1].prior = Some(Prior { mean: 1.1e9, deviation: 0.055e9 });
    let found = identify(&robot(), &seen, &pair, &settings()).unwrap();
    let diameter = &found.estimates[0];
    let sure = diameter.deviation.unwrap() / diameter.value;
    assert!(sure > 0.005 && sure < 0.013, "{sure}");
    assert!((found.noise.level / 5e-4 - 1.0).abs() < 0.1);
    let modulus = &found.estimates[1];
    assert!((modulus.value - 1.1e9).abs() < 0.11e9 && modulus.deviation.unwrap() < 0.0551e9);
}

/// Markers that were mixed up do not decide.
#[test]
fn wrong_markers_hardly_matter() {
    let mut seen = noisy(2e-4);
    for (i, each) in seen[0].observations.iter_mut().enumerate() {
        if let Seen::Position(position) = &mut each.seen
            && i % 9 == 4
        {
            *position += Vec3::new(0.02, -0.01, 0.03);
        }
    }
    let one = unknowns(&["backbone.young_modulus"]);
    let with = |robustness| {
        let settings = Settings { robustness, ..settings() };
        identify(&robot(), &seen, &one, &settings).unwrap()
    };
    let plain = with(Robustness::Squares);
    assert!((plain.estimates[0].value / 1.1e9 - 1.0).abs() > 5e-3);
    for robustness in [Robustness::Huber, Robustness::SoftL1, Robustness::Cauchy] {
        let found = with(robustness);
        assert!(found.status.is_converged());
        let [low, high] = found.estimates[0].interval.unwrap();
        assert!((found.estimates[0].value / 1.1e9 - 1.0).abs() < 2e-3, "{robustness:?}");
        assert!(high - low < 0.006 * 1.1e9, "{robustness:?} {low} {high}");
        assert!((found.noise.level / 2e-4 - 1.0).abs() < 0.2, "{robustness:?} {:?}", found.noise);
        let weight = found.residuals[4].weight;
        assert!(weight < 0.05 && found.residuals[5].weight > 0.5, "{robustness:?} {weight}");
        assert!(found.residuals[4].distance() > 0.03);
    }
}

#[test]
fn bounds_hold() {
    let seen = noisy(2e-4);
    let mut one = unknowns(&["backbone.young_modulus"]);
    one[0].bounds = [0.5e9, 1.0e9];
    let found = identify(&robot(), &seen, &one, &settings()).unwrap();
    assert!(found.estimates[0].value == 1.0e9 && found.estimates[0].is_at_bound);
    assert!(found.estimates[0].deviation.is_none() && found.status.is_converged());
}

/// The model that made the measurements fits them best, and says best what it has not seen.
#[test]
fn models_compared_and_cases_held_out() {
    let settings = settings();
    // On straight cables the two models differ by a factor on the modulus alone.
    let robot = paper_robot([0.0, 120.0, 240.0].map(|angle| helix(angle, 0.6)).to_vec());
    let disks = model(ModelKind::CosseratDisks);
    let mut seen = experiments(&disks, &robot, &cases(&[2.0]));
    disturb(&mut seen, &mut Normal::new(5), [2e-5, 0.0]);
    let one = unknowns(&["backbone.young_modulus"]);
    let models = [settings.model.clone(), disks.clone(), model(ModelKind::FourBar)];
    let compared = compare_models(&robot, &seen, &one, &models, &settings, false);
    let fit = |i: usize| compared[i].fit.as_ref().unwrap();
    assert_eq!(compared[1].aic_above_best, Some(0.0));
    assert!(
        compared[0].aic_above_best.unwrap() > 10.0 && compared[0].bic_above_best.unwrap() > 10.0
    );
    assert!(fit(1).rms_distance.unwrap() < 4e-5 && fit(0).rms_distance > fit(1).rms_distance);
    // The four-bar model is driven by lengths, which are not given.
    assert!(compared[2].fit.is_err() && compared[2].aic_above_best.is_none());

    let by = |model| {
        cross_validate(&robot, &seen, &one, &Settings { model, ..settings.clone() }).unwrap()
    };
    let (same, other) = (by(disks), by(settings.model.clone()));
    assert_eq!(same.folds.len(), 3);
    assert!(same.folds.iter().all(|fold| fold.step.is_none()));
    assert!(same.rms_distance.unwrap() < 4e-5 && other.rms_distance > same.rms_distance);
    // Held out is not worse than noise, 0.02 mm in each of three coordinates, allows.
    for fold in &same.folds {
        assert!((fold.values[0] / 1.1e9 - 1.0).abs() < 0.01);
        assert!((fold.rms_distance.unwrap() / (2e-5 * 3f64.sqrt()) - 1.0).abs() < 0.4);
    }
}

/// Of a case with an unknown of its own, steps are held out.
#[test]
fn steps_held_out() {
    let seen = noisy(2e-4);
    let mut two = unknowns(&["backbone.young_modulus"]);
    two.push(Unknown::of(quantity("base.position[0]"), 1));
    let validated = cross_validate(&robot(), &seen, &two, &settings()).unwrap();
    let parts: Vec<_> = validated.folds.iter().map(|fold| (fold.experiment, fold.step)).collect();
    assert_eq!(parts, [(0, None), (1, Some(0)), (1, Some(1)), (1, Some(2)), (2, None)]);
    assert!(validated.rms_distance.unwrap() < 4e-4);
}

/// The fitted robot is the one with the estimates: its shapes are those that the residuals are of.
#[test]
fn the_fitted_robot_gives_the_residuals() {
    let seen = noisy(5e-4);
    let mut all = unknowns(&["backbone.torsion_factor", "cables[2].routing.radius"]);
    all.push(Unknown::of(quantity("cables[0].tension_offset"), 2));
    let found = identify(&robot(), &seen, &all, &settings()).unwrap();
    let radius = Parameter::Radius { cable: 2 }.value(&found.robot, &found.cases[0]).unwrap();
    assert_eq!(radius, found.estimates[1].value);
    let cases: Vec<Case> = found.cases.clone();
    let shown = experiments(&settings().model, &found.robot, &cases);
    let mut k = 0;
    for (of, measured) in shown.iter().zip(&seen) {
        for (model, seen) in of.observations.iter().zip(&measured.observations) {
            let (Seen::Position(model), Seen::Position(seen)) = (model.seen, seen.seen) else {
                panic!()
            };
            let [x, y, z] = found.residuals[k].difference;
            let difference = Vec3::new(x, y, z);
            assert!((model - seen - difference).norm() < 1e-12);
            k += 1;
        }
    }
}
