//! What cannot be estimated, and why.

use crate::identification::synthetic::{
    cases, experiments, model, quantity, robot, settings, unknowns,
};
use whipcord::{Actuation, Cancel, Model, ModelKind, Pose, Stations, Vec3};
use whipcord_estimation::camera::{Camera, Lens, Orthographic};
use whipcord_estimation::identification::{
    Experiment, IdentifyError, Misfit, NoAnswerReason, Prior, Settings, Unknown, cross_validate,
    identify,
};
use whipcord_estimation::{Place, Seen};

fn seen() -> Vec<Experiment> {
    experiments(&settings().model, &robot(), &cases(&[1.0])[..1])
}

fn refusal(seen: &[Experiment], unknowns: &[Unknown]) -> IdentifyError {
    identify(&robot(), seen, unknowns, &settings()).unwrap_err()
}

#[test]
fn measurements_that_are_not_enough_or_do_not_fit() {
    let one = unknowns(&["backbone.young_modulus"]);
    assert_eq!(refusal(&[], &one), IdentifyError::NoMeasurements);
    assert_eq!(refusal(&seen(), &[]), IdentifyError::NoUnknowns);
    let mut few = seen();
    few[0].observations.truncate(1);
    let four =
        unknowns(&["backbone.young_modulus", "base.turn[0]", "base.turn[1]", "base.position[0]"]);
    let (numbers, unknowns) = (3, 4);
    assert_eq!(refusal(&few, &four), IdentifyError::TooFewNumbers { numbers, unknowns });
    assert_eq!(refusal(&few, &four[..3]), IdentifyError::TooFewNumbers { numbers, unknowns: 3 });
    // A known deviation, or a prior, is as good as a number.
    few[0].observations[0].deviation = Some(1e-3);
    assert!(identify(&robot(), &few, &four[..3], &settings()).is_ok());

    type Change = fn(&mut Experiment);
    let changes: [(Change, Misfit); 7] = [
        (|of| of.observations[1].step = 3, Misfit::Step { step: 3, steps: 1 }),
        (|of| of.observations[1].place = Place::Disk(10), Misfit::Disk { disk: 10, disks: 10 }),
        (
            |of| of.observations[1].place = Place::ArcLength(0.2),
            Misfit::ArcLength { value: 0.2, length: 0.18 },
        ),
        (
            |of| of.observations[1].seen = Seen::Pixel { camera: 0, pixel: [1.0, 2.0] },
            Misfit::Camera { camera: 0, cameras: 0 },
        ),
        (
            |of| of.observations[1].offset = Vec3::new(f64::INFINITY, 0.0, 0.0),
            Misfit::Number {
                what: "a coordinate of the marker's offset",
                must: "a finite number",
                value: f64::INFINITY,
            },
        ),
        (
            |of| of.observations[1].seen = Seen::Position(Vec3::new(0.0, 0.0, f64::INFINITY)),
            Misfit::Number { what: "a coordinate", must: "a finite number", value: f64::INFINITY },
        ),
        (
            |of| of.observations[1].deviation = Some(0.0),
            Misfit::Number { what: "the deviation", must: "greater than zero", value: 0.0 },
        ),
    ];
    for (change, problem) in changes {
        let mut seen = seen();
        change(&mut seen[0]);
        let expected = IdentifyError::Observation { experiment: 0, observation: 1, problem };
        assert_eq!(refusal(&seen, &one), expected);
    }
    let mut some = seen();
    some[0].observations[2].deviation = Some(1e-3);
    assert_eq!(refusal(&some, &one), IdentifyError::SomeDeviations);
    let mut mixed = seen();
    let lens = Lens::Orthographic(Orthographic::new(1000.0, [0.0, 0.0]).unwrap());
    mixed[0].cameras = vec![Camera::new(lens, Pose::IDENTITY, None).unwrap()];
    mixed[0].observations[2].seen = Seen::Pixel { camera: 0, pixel: [1.0, 2.0] };
    assert_eq!(refusal(&mixed, &one), IdentifyError::MixedUnits);
}

#[test]
fn unknowns_that_do_not_fit() {
    let wrong = |unknown: Unknown| refusal(&seen(), &[unknown]).to_string();
    let young = || Unknown::new(quantity("backbone.young_modulus"));
    let arc = Model::new(ModelKind::ConstantCurvature, Stations::default(), Actuation::Natural);
    let arc = Settings { model: arc, ..settings() };
    let friction = Unknown::new(quantity("cables.friction"));
    let refused = identify(&robot(), &seen(), &[friction], &arc).unwrap_err();
    assert!(matches!(refused, IdentifyError::NoFriction { .. }), "{refused}");
    for (unknown, message) in [
        (
            Unknown::new(quantity("backbone.inner_diameter")),
            "`backbone.inner_diameter`: is not a number of this robot",
        ),
        (Unknown::new(quantity("cables[7].tension_offset")), "`tension_offset` of cable 8: "),
        (
            Unknown::new(quantity("cables[0].shortening_offset")),
            "case 1: cables[0].shortening_offset: the cable is not driven by that in every step",
        ),
        (
            Unknown::of(quantity("base.position[0]"), 4),
            "base.position[0] is to be estimated for case 5, but there are 1",
        ),
        (
            Unknown { bounds: [2.0, 1.0], ..young() },
            "backbone.young_modulus: the least value must be below the greatest",
        ),
        (
            Unknown { bounds: [2e9, 3e9], start: Some(1e9), ..young() },
            "backbone.young_modulus: the start lies outside the bounds",
        ),
        (
            Unknown { prior: Some(Prior { mean: 1e9, deviation: 0.0 }), ..young() },
            "backbone.young_modulus: a prior needs a finite mean",
        ),
    ] {
        let said = wrong(unknown);
        assert!(said.starts_with(message.split(": is not").next().unwrap()), "{said}");
    }
    let twice = unknowns(&["backbone.young_modulus", "backbone.young_modulus"]);
    let path = || "backbone.young_modulus".to_owned();
    let overlap = IdentifyError::Overlap { first: path(), second: path() };
    assert_eq!(refusal(&seen(), &twice), overlap);
}

#[test]
fn no_answer_at_the_start() {
    let limp = Unknown { start: Some(2e3), ..Unknown::new(quantity("backbone.young_modulus")) };
    let IdentifyError::NoAnswerAtStart(answer) = refusal(&seen(), &[limp]) else { panic!() };
    assert_eq!(answer.experiment, 0);
    assert!(matches!(answer.reason, NoAnswerReason::Solve(_)));
    let message = IdentifyError::NoAnswerAtStart(answer).to_string();
    assert!(
        message.starts_with("with the values to start from, case 1 has no answer: "),
        "{message}"
    );
    // The four-bar model goes by lengths, which the case does not give.
    let settings = Settings::new(model(ModelKind::FourBar));
    let one = unknowns(&["cables[0].routing.radius"]);
    let refused = identify(&robot(), &seen(), &one, &settings).unwrap_err();
    assert!(matches!(refused, IdentifyError::NoAnswerAtStart(_)), "{refused}");
}

#[test]
fn nothing_to_hold_out() {
    let one = unknowns(&["backbone.young_modulus"]);
    let refused = cross_validate(&robot(), &seen(), &one, &settings()).unwrap_err();
    assert_eq!(refused, IdentifyError::NothingToHoldOut);
    // Nothing is known of what belongs to a case without what was seen in it.
    let two = &experiments(&settings().model, &robot(), &cases(&[1.0]))[..2];
    let own = [0, 1].map(|case| Unknown::of(quantity("base.position[0]"), case));
    let refused = cross_validate(&robot(), two, &own, &settings()).unwrap_err();
    assert_eq!(refused, IdentifyError::NothingToHoldOut);
    let folds = cross_validate(&robot(), two, &one, &settings()).unwrap().folds;
    assert!(folds.iter().map(|fold| (fold.experiment, fold.step)).eq([(0, None), (1, None)]));
}

#[test]
fn a_cancelled_estimate_says_so() {
    let mut settings = settings();
    let cancel = Cancel::new();
    cancel.cancel();
    settings.model = settings.model.cancelled_by(&cancel);
    let unknowns = unknowns(&["backbone.young_modulus"]);
    let found = identify(&robot(), &seen(), &unknowns, &settings);
    assert_eq!(found.err(), Some(IdentifyError::Cancelled));
}
