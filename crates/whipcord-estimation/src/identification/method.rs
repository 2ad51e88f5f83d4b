//! How the derivative by an unknown comes about.

use super::experiment::{Experiment, Unknown};
use super::quantity::Quantity;
use whipcord::case::LoadFrame;
use whipcord::model::Model;
use whipcord::parameter::Parameter;
use whipcord::robot::Robot;

/// How the derivative by an unknown comes about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum DerivativeMethod {
    /// Exactly: the model differentiates its answer by a parameter.
    Parameter(Parameter),
    /// Exactly: by the command of a cable.
    Command { cable: usize },
    /// Exactly: the robot is moved along an axis of the world.
    Move { axis: usize },
    /// Exactly: the robot is turned, with its loads, about an axis of the world.
    Turn { axis: usize },
    /// By differences of the model's answers.
    Differences,
}

impl DerivativeMethod {
    pub(super) fn of(
        unknown: &Unknown,
        unknowns: &[Unknown],
        experiment: &Experiment,
        (model, robot): (&Model, &Robot),
    ) -> Self {
        let loads = &experiment.case.loads;
        let rubs = unknowns.iter().any(|u| matches!(u.quantity, Quantity::Friction { .. }));
        let is_exact = !rubs && model.has_derivatives(robot);
        let by_factor = unknowns.iter().any(|other| {
            matches!(other.quantity, Quantity::Parameter(Parameter::StiffnessScale(_)))
        });
        match unknown.quantity {
            // Its stiffness then is given as such, and section and material no longer decide on it.
            quantity if quantity.is_of_material() && by_factor => Self::Differences,
            Quantity::Parameter(parameter) if is_exact => Self::Parameter(parameter),
            Quantity::TensionOffset { cable } | Quantity::ShorteningOffset { cable }
                if is_exact =>
            {
                Self::Command { cable }
            }
            Quantity::BasePosition { axis } => Self::Move { axis },
            Quantity::BaseTurn { axis } if loads.frame == LoadFrame::Base || loads.is_none() => {
                Self::Turn { axis }
            }
            _ => Self::Differences,
        }
    }
}
