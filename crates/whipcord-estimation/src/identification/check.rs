//! Whether measurements, robot, cases and unknowns fit together.

use super::build::{is_driven_by_tension, present};
use super::error::{IdentifyError, Misfit};
use super::experiment::{Experiment, Unknown};
use super::quantity::Quantity;
use super::settings::Settings;
use crate::observation::{Observation, Place, Seen};
use whipcord::case::Actuation;
use whipcord::model::Model;
use whipcord::robot::Robot;
use whipcord::{constant_curvature, four_bar};

pub(super) fn check(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<(), IdentifyError> {
    let value = settings.confidence;
    if !(value > 0.0 && value < 1.0) {
        return Err(IdentifyError::Confidence { value });
    }
    check_observations(robot, experiments)?;
    if unknowns.is_empty() {
        return Err(IdentifyError::NoUnknowns);
    }
    for (i, unknown) in unknowns.iter().enumerate() {
        check_unknown(robot, experiments, unknown, settings)?;
        let both = |other: &Unknown| match (unknown.experiment, other.experiment) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        };
        let twin = unknowns[..i].iter().find(|other| {
            let any = |of: Quantity| other.quantities().any(|twin| of.overlaps(&twin));
            both(other) && unknown.quantities().any(any)
        });
        if let Some(twin) = twin {
            let (first, second) = (twin.path(), unknown.path());
            return Err(IdentifyError::Overlap { first, second });
        }
    }
    let observations = || experiments.iter().flat_map(|experiment| &experiment.observations);
    let priors = unknowns.iter().filter(|unknown| unknown.prior.is_some()).count();
    let numbers = observations().map(Observation::numbers).sum::<usize>() + priors;
    // Where the noise is not known it is estimated, which takes one more.
    let known = observations().all(|seen| seen.deviation.is_some());
    if numbers < unknowns.len() + usize::from(!known) {
        return Err(IdentifyError::TooFewNumbers { numbers, unknowns: unknowns.len() });
    }
    Ok(())
}

pub(super) fn check_observations(
    robot: &Robot,
    experiments: &[Experiment],
) -> Result<(), IdentifyError> {
    let (mut deviations, mut positions, mut count) = (0, 0, 0);
    for (experiment, of) in experiments.iter().enumerate() {
        for (observation, seen) in of.observations.iter().enumerate() {
            misfit(robot, of, seen).map_err(|problem| IdentifyError::Observation {
                experiment,
                observation,
                problem,
            })?;
            count += 1;
            deviations += usize::from(seen.deviation.is_some());
            positions += usize::from(!seen.seen.is_in_image());
        }
    }
    if count == 0 {
        Err(IdentifyError::NoMeasurements)
    } else if deviations != 0 && deviations != count {
        Err(IdentifyError::SomeDeviations)
    } else if deviations == 0 && positions != 0 && positions != count {
        Err(IdentifyError::MixedUnits)
    } else {
        Ok(())
    }
}

fn misfit(robot: &Robot, experiment: &Experiment, seen: &Observation) -> Result<(), Misfit> {
    let steps = experiment.case.before.len() + 1;
    if seen.step >= steps {
        return Err(Misfit::Step { step: seen.step, steps });
    }
    let (disks, length) = (robot.disks().count(), robot.backbone().length);
    match seen.place {
        Place::Disk(disk) if disk >= disks => return Err(Misfit::Disk { disk, disks }),
        Place::ArcLength(value) if !(0.0..=length).contains(&value) => {
            return Err(Misfit::ArcLength { value, length });
        }
        _ => {}
    }
    let number = |what, value: f64| {
        let must = "a finite number";
        if value.is_finite() { Ok(()) } else { Err(Misfit::Number { what, must, value }) }
    };
    for i in 0..3 {
        number("a coordinate of the marker's offset", seen.offset[i])?;
    }
    match seen.seen {
        Seen::Position(position) => {
            for i in 0..3 {
                number("a coordinate", position[i])?;
            }
        }
        Seen::Pixel { camera, pixel } => {
            let cameras = experiment.cameras.len();
            if camera >= cameras {
                return Err(Misfit::Camera { camera, cameras });
            }
            for coordinate in pixel {
                number("a pixel", coordinate)?;
            }
        }
        Seen::Rotation { rotation, arm } => {
            for part in rotation.wxyz() {
                number("a part of the orientation", part)?;
            }
            if !(arm.is_finite() && arm > 0.0) {
                let (what, must) = ("the arm of the orientation", "greater than zero");
                return Err(Misfit::Number { what, must, value: arm });
            }
        }
    }
    match seen.deviation {
        Some(value) if !(value.is_finite() && value > 0.0) => {
            Err(Misfit::Number { what: "the deviation", must: "greater than zero", value })
        }
        _ => Ok(()),
    }
}

fn check_unknown(
    robot: &Robot,
    experiments: &[Experiment],
    unknown: &Unknown,
    settings: &Settings,
) -> Result<(), IdentifyError> {
    let path = || unknown.path();
    let wrong = |problem| Err(IdentifyError::Setting { path: path(), problem });
    if let Some(experiment) = unknown.experiment
        && experiment >= experiments.len()
    {
        let experiments = experiments.len();
        return Err(IdentifyError::NoExperiment { path: path(), experiment, experiments });
    }
    let [least, greatest] = unknown.bounds;
    if least.is_nan() || greatest.is_nan() || least >= greatest {
        return wrong("the least value must be below the greatest");
    }
    match unknown.start {
        Some(start) if !start.is_finite() => return wrong("the start must be a finite number"),
        Some(start) if start < least || start > greatest => {
            return wrong("the start lies outside the bounds");
        }
        _ => {}
    }
    if let Some(prior) = unknown.prior
        && !(prior.mean.is_finite() && prior.deviation.is_finite() && prior.deviation > 0.0)
    {
        return wrong("a prior needs a finite mean and a deviation greater than zero");
    }
    let model = &settings.model;
    if matches!(unknown.quantity, Quantity::Friction { .. }) && !model.has_hole_friction() {
        return Err(IdentifyError::NoFriction { path: path(), model: model.kind() });
    }
    for (experiment, of) in experiments.iter().enumerate() {
        if !unknown.is_of(experiment) {
            continue;
        }
        for quantity in unknown.quantities() {
            if !of.case.loads_before.is_empty() && quantity.is_load() {
                return wrong(
                    "the loads differ from row to row, so that none of them is one number: estimate another parameter",
                );
            }
            present(&quantity, robot, &of.case).map_err(IdentifyError::Absent)?;
            let (cable, by_tension) = match quantity {
                Quantity::TensionOffset { cable } => (cable, Some(true)),
                Quantity::ShorteningOffset { cable } => (cable, Some(false)),
                Quantity::Gain { cable } => (cable, None),
                _ => continue,
            };
            let driven = driven_by_tension(of, cable, &settings.model);
            if driven.is_none() || by_tension.is_some_and(|by| driven != Some(by)) {
                return Err(IdentifyError::NotDriven { path: quantity.to_string(), experiment });
            }
        }
    }
    Ok(())
}

/// Whether a model drives the cable by its tension in all steps, or by its shortening in all.
pub(super) fn driven_by_tension(
    experiment: &Experiment,
    cable: usize,
    model: &Model,
) -> Option<bool> {
    match model {
        Model::Cosserat(options) | Model::CosseratDisks(options) => {
            is_driven_by_tension(&experiment.case, cable, options.actuation)
        }
        Model::FourBar(four_bar::Options { actuation, .. })
        | Model::ConstantCurvature(constant_curvature::Options { actuation, .. }) => {
            let by_nature = *actuation == Actuation::Natural;
            let given = experiment.case.commands[cable].shortening.is_some();
            let actuation = if by_nature && given { Actuation::Shortening } else { *actuation };
            is_driven_by_tension(&experiment.case, cable, actuation)
        }
        Model::PiecewiseConstantCurvature(options) => {
            is_driven_by_tension(&experiment.case, cable, options.actuation)
        }
        Model::PseudoRigidBody(options) => {
            is_driven_by_tension(&experiment.case, cable, options.actuation)
        }
    }
}

impl Observation {
    /// How many numbers it is.
    pub(super) const fn numbers(&self) -> usize {
        match self.seen {
            Seen::Position(_) | Seen::Rotation { .. } => 3,
            Seen::Pixel { .. } => 2,
        }
    }
}
