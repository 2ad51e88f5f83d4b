//! What drives a cable, and what becomes of it.

use crate::case::{Actuation, Case};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;
use crate::solution::CableState;

/// Of a cable's own compliance: keeps a Newton step defined where more cables are taut than lengths are independent.
pub(crate) const LENGTH_REGULARISATION: f64 = 1e-8;

/// A cable whose tension is this part of the greatest, or that is slack by this part of the length of the backbone, is about to change.
const ABOUT_TO_CHANGE: f64 = 1e-6;

/// What drives one cable; in the order of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Command {
    /// Tension in N.
    Tension(f64),
    /// Unstretched length `ℓ*` inside the robot in m, and what a tension of 1 N adds to it.
    Length { target: f64, compliance: f64 },
}

impl Command {
    /// Whether the cable is driven by its length.
    pub const fn is_length(&self) -> bool {
        matches!(self, Self::Length { .. })
    }

    /// The tension in N, or the unstretched length in m.
    pub const fn number(&self) -> f64 {
        match *self {
            Self::Tension(number) | Self::Length { target: number, .. } => number,
        }
    }

    /// Slackness `g` of a cable whose path has this length.
    pub fn slackness(&self, tension: f64, length: f64) -> f64 {
        match *self {
            Self::Tension(_) => 0.0,
            Self::Length { target, compliance } => target + compliance * tension - length,
        }
    }

    /// How far cable `i` is from `min(τ, g) = 0`, not negative, with the tension and the slackness in these
    /// units (N and m); 0 where it is driven by its tension, and its length need not be known.
    pub fn complementarity_residual(
        &self,
        i: usize,
        tensions: &[f64],
        lengths: &[f64],
        units: [f64; 2],
    ) -> f64 {
        match self {
            Self::Tension(_) => 0.0,
            Self::Length { .. } => {
                let slack = self.slackness(tensions[i], lengths[i]) / units[1];
                (tensions[i] / units[0]).min(slack).abs()
            }
        }
    }

    /// Whether Newton's method for `min(τ, g) = 0` leads cable `i` to its length, and not to no tension: the
    /// tension is the greater of the two in these units.
    pub fn is_active(&self, i: usize, tensions: &[f64], lengths: &[f64], units: [f64; 2]) -> bool {
        matches!(self, Self::Length { .. })
            && tensions[i] / units[0] > self.slackness(tensions[i], lengths[i]) / units[1]
    }

    /// Whether a cable of given length is about to go slack or to become taut in an answer, on a backbone of this length in m.
    pub fn are_about_to_change<'a>(
        commands: impl Iterator<Item = &'a Self>,
        cables: &[CableState],
        backbone: f64,
    ) -> bool {
        let most = cables.iter().filter_map(|cable| cable.tension).fold(0.0, f64::max);
        let mut driven = commands.zip(cables).filter(|(command, _)| command.is_length());
        driven.any(|(command, cable)| match cable.tension {
            Some(tension) if tension > 0.0 => tension <= ABOUT_TO_CHANGE * most,
            _ => command.slackness(0.0, cable.length).abs() <= ABOUT_TO_CHANGE * backbone,
        })
    }

    /// What a tension in cable `j` adds to how much cable `i` is too long, by stretching the cable: in m/N,
    /// minus the compliance where they are the same.
    pub fn stretch(commands: &[Self], i: usize, j: usize) -> f64 {
        match commands[i] {
            Self::Length { compliance, .. } if i == j => -compliance,
            _ => 0.0,
        }
    }

    /// Of a cable of the robot that has this length in m at rest.
    ///
    /// # Errors
    /// [`SolveError::Missing`] where the case gives the cable nothing of the kind that counts.
    pub fn of(
        model: ModelKind,
        robot: &Robot,
        cable: usize,
        case: &Case,
        actuation: Actuation,
        initial: f64,
    ) -> Result<Self, SolveError> {
        let command = &case.commands[cable];
        let (tension, shortening) = match (actuation, model.natural_actuation()) {
            (Actuation::Tension, _) => (command.tension, None),
            (Actuation::Shortening, _) => (None, command.shortening),
            (Actuation::Natural, Actuation::Shortening) => {
                (command.tension.filter(|_| command.shortening.is_none()), command.shortening)
            }
            (Actuation::Natural, _) => (command.tension, command.shortening),
        };
        match (tension, shortening) {
            (Some(tension), _) => Ok(Self::Tension(tension)),
            (None, Some(shortening)) => {
                let compliance = robot.cable_compliance(cable, initial);
                // The cable has no other length than at rest where it has its pretension.
                let wound_up = compliance * robot.pretension(cable);
                let target = initial - shortening.in_metres(initial) - wound_up;
                Ok(Self::Length { target, compliance })
            }
            (None, None) => {
                let (key, advice) = match actuation {
                    Actuation::Natural => ("tension", "give this cable a tension, or a shortening"),
                    Actuation::Tension => {
                        ("tension", "give it, or drive the cables by their shortening")
                    }
                    Actuation::Shortening => {
                        ("shortening", "give it, or drive the cables by their tension")
                    }
                };
                Err(SolveError::Missing { model, path: format!("cables[{cable}].{key}"), advice })
            }
        }
    }

    /// Writes what became of the cable, of this name, tension, and length in the answer and before, on a backbone of this length
    /// in m.
    pub fn answer(
        &self,
        name: &str,
        tension: f64,
        [length, initial_length]: [f64; 2],
        backbone: f64,
        state: &mut CableState,
    ) {
        let loose = self.slackness(tension, length);
        state.rename(name);
        state.tension = Some(tension);
        (state.length, state.initial_length) = (length, initial_length);
        state.slack = self.is_length() && tension == 0.0 && loose > 1e-12 * backbone;
        state.span_tensions.clear();
        state.slip_states.clear();
    }
}
