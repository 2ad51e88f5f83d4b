//! How the derivative by an unknown comes about.

use super::check::driven_by_tension;
use super::experiment::{Experiment, Unknown};
use super::quantity::Quantity;
use whipcord::case::LoadFrame;
use whipcord::model::Model;
use whipcord::parameter::Parameter;
use whipcord::robot::{Cable, Robot};

/// How the derivative by an unknown comes about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum DerivativeMethod {
    /// Exactly: the model differentiates its answer by a parameter.
    Parameter(Parameter),
    /// Exactly: by the command of a cable in all steps.
    Offset { cable: usize },
    /// Exactly: by the command of a cable, which is multiplied.
    Gain { cable: usize, by_tension: bool },
    /// Exactly: all markers are moved along an axis of their frames.
    Marker { axis: usize },
    /// Exactly: the world is moved along an axis of the frame of the measurement.
    MeasuredMove { axis: usize },
    /// Exactly: the world is turned in the frame of the measurement.
    MeasuredTurn { axis: usize },
    /// Exactly: tracked bodies are turned about an axis of the frames at their places.
    BodyTurn { axis: usize },
    /// Exactly: the robot is moved along an axis of the world.
    Move { axis: usize },
    /// Exactly: the robot is turned, with its loads, about an axis of the world.
    Turn { axis: usize },
    /// By differences of the model's answers.
    Differences,
}

impl DerivativeMethod {
    /// The derivatives at a value of the unknown. Without friction nothing tells which way the cables slide when there is some.
    pub(super) fn at(methods: &[Self], value: f64) -> Vec<Self> {
        let of_friction =
            |method: &Self| matches!(method, Self::Parameter(Parameter::Friction { .. }));
        match value <= 0.0 && methods.iter().any(of_friction) {
            true => vec![Self::Differences],
            false => methods.to_vec(),
        }
    }

    /// Whether the model differentiates its answer.
    pub(super) const fn is_of_model(&self) -> bool {
        matches!(self, Self::Parameter(_) | Self::Offset { .. } | Self::Gain { .. })
    }

    /// The derivatives by all quantities of an unknown, which add up.
    pub(super) fn of(
        unknown: &Unknown,
        unknowns: &[Unknown],
        experiment: &Experiment,
        model: (&Model, &Robot),
    ) -> Vec<Self> {
        let of = |quantity| Self::of_quantity(quantity, unknowns, experiment, model);
        let all: Vec<Self> = unknown.quantities().map(of).collect();
        match all.contains(&Self::Differences) {
            true => vec![Self::Differences],
            false => all,
        }
    }

    fn of_quantity(
        quantity: Quantity,
        unknowns: &[Unknown],
        experiment: &Experiment,
        (model, robot): (&Model, &Robot),
    ) -> Self {
        let loads = &experiment.case.loads;
        let is_exact = model.has_derivatives(robot);
        let by_factor = unknowns.iter().any(|other| {
            matches!(other.quantity, Quantity::Parameter(Parameter::StiffnessScale(_)))
        });
        // The commands before change with it too, and with them what friction keeps of them.
        let case = &experiment.case;
        let keeps_commands =
            robot.has_bending_friction() && !case.before.is_empty() && !case.independent;
        let rubs = robot.cables().iter().any(Cable::has_friction)
            || unknowns.iter().any(|u| matches!(u.quantity, Quantity::Friction { .. }));
        let by_gain = unknowns.iter().any(|u| matches!(u.quantity, Quantity::Gain { .. }));
        match quantity {
            // Its stiffness then is given as such, and section and material no longer decide on it.
            quantity if quantity.is_of_material() && by_factor => Self::Differences,
            // What a motor changes of a command is multiplied by the gain of the cable too.
            Quantity::Parameter(parameter) if by_gain && parameter.motor().is_some() => {
                Self::Differences
            }
            // With friction all commands before change with it too.
            Quantity::Gain { cable } if is_exact && !keeps_commands && !rubs => {
                match driven_by_tension(experiment, cable, model) {
                    Some(by_tension) => Self::Gain { cable, by_tension },
                    None => Self::Differences,
                }
            }
            Quantity::MarkerOffset { axis } => Self::Marker { axis },
            Quantity::MeasuredPosition { axis } => Self::MeasuredMove { axis },
            Quantity::MeasuredTurn { axis } => Self::MeasuredTurn { axis },
            Quantity::BodyTurn { axis } => Self::BodyTurn { axis },
            Quantity::Parameter(parameter) if is_exact => Self::Parameter(parameter),
            Quantity::Friction { cable } if is_exact => {
                Self::Parameter(Parameter::Friction { cable })
            }
            Quantity::TensionOffset { cable } | Quantity::ShorteningOffset { cable }
                if is_exact && !keeps_commands =>
            {
                Self::Offset { cable }
            }
            Quantity::BasePosition { axis } => Self::Move { axis },
            Quantity::BaseTurn { axis } if loads.frame == LoadFrame::Base || loads.is_none() => {
                Self::Turn { axis }
            }
            _ => Self::Differences,
        }
    }
}
