//! How what would be seen changes with the unknowns.

use whipcord_numerics::{Twist, Vec3};

use super::build::{AXES, turning_axis};
use super::error::NoAnswerReason;
use super::forward::{Forward, Marker};
use super::method::DerivativeMethod;
use super::pieces::Piece;
use super::quantity::Quantity;
use super::solver::{Predicted, Solver};
use whipcord::Linearization;
use whipcord::case::Shortening;
use whipcord::derivatives::{Change, Hold, Place};
use whipcord::parameter::Parameter;
use whipcord::solution::Solution;

/// Step of the differences, as a part of what matters.
const STEP: f64 = 1e-3;

impl Solver<'_, '_> {
    /// What would be seen in a piece, and how it changes with the unknowns as far as the model says so
    /// itself, the other columns zero.
    pub(super) fn predict_with_columns(
        &mut self,
        piece: &Piece,
        x: &[f64],
    ) -> Result<Predicted, NoAnswerReason> {
        let (forward, experiment) = (self.forward, piece.experiment);
        let means: Vec<Vec<DerivativeMethod>> = (forward.methods(experiment).iter().zip(x))
            .enumerate()
            .map(|(j, (methods, value))| match forward.is_by_differences(piece, j, *value) {
                true => Vec::new(),
                false => methods.clone(),
            })
            .collect();
        let parameters: Vec<Parameter> = means
            .iter()
            .flatten()
            .filter_map(|means| match means {
                DerivativeMethod::Parameter(parameter) => Some(*parameter),
                _ => None,
            })
            .collect();
        let asks = means.iter().flatten().any(DerivativeMethod::is_of_model);
        let (prepared, case) = self.prepare(piece, x)?;
        let mut answers: Vec<(Solution, Option<Linearization>)> = Vec::new();
        match prepared {
            prepared if asks => prepared
                .solve_steps_with_derivatives(
                    &case,
                    &parameters,
                    |step| forward.is_seen(experiment, piece.steps[step]),
                    |solution, derivatives| answers.push((solution, derivatives)),
                )
                .map_err(|(_, error)| error)?,
            prepared => prepared
                .solve_steps(&case, |solution| answers.push((solution, None)))
                .map_err(|(_, error)| error)?,
        }
        let mut found = Predicted { rows: Vec::new(), numbers: Vec::new(), columns: Vec::new() };
        let view = forward.view(experiment, x);
        let turn = forward.turn(experiment, x);
        let measured_turn = forward.measured_turn(experiment, x);
        let body_turn = forward.body_turn(experiment, x);
        let frame = view.frame;
        for (step, (solution, derivatives)) in answers.iter().enumerate() {
            let commands = case.before.get(step).unwrap_or(&case.commands);
            let mut parameter = 0;
            let mut motions: Vec<Vec<Motion>> = Vec::with_capacity(means.len());
            for (means, value) in means.iter().zip(x) {
                let mut of_unknown = Vec::with_capacity(means.len());
                for means in means {
                    let motion = match (*means, derivatives) {
                        (DerivativeMethod::Parameter(what), Some(derivatives)) => {
                            let change = derivatives.parameter(parameter, Hold::Commands);
                            parameter += 1;
                            // The model's factor counts from what the stiffness is now.
                            let by = match what {
                                Parameter::StiffnessScale(_) => 1.0 / value,
                                _ => 1.0,
                            };
                            Motion::Change(change, by)
                        }
                        (DerivativeMethod::Offset { cable }, Some(derivatives)) => {
                            let by = match (commands[cable].shortening, commands[cable].tension) {
                                // An offset in m is a part of the length that the cable had before.
                                (Some(Shortening::Fraction(_)), _)
                                    if !forward.rest().is_empty() =>
                                {
                                    solution.cables[cable].initial_length / forward.rest()[cable]
                                }
                                _ => 1.0,
                            };
                            Motion::Change(derivatives.offset(cable), by)
                        }
                        (DerivativeMethod::Gain { cable, by_tension }, Some(derivatives)) => {
                            let length = solution.cables[cable].initial_length;
                            let rest = forward.rest().get(cable).copied().unwrap_or(1.0);
                            let offset = forward.offset(experiment, x, cable);
                            let command = match (by_tension, commands[cable].shortening) {
                                (false, Some(Shortening::Length(given))) => given - offset,
                                (false, Some(Shortening::Fraction(part))) => {
                                    length * (part - offset / rest)
                                }
                                _ => commands[cable].tension.unwrap_or(0.0) - offset,
                            };
                            Motion::Change(derivatives.command(cable), command / value)
                        }
                        (DerivativeMethod::Marker { axis }, _) => Motion::Marker(AXES[axis]),
                        (DerivativeMethod::MeasuredMove { axis }, _) => {
                            Motion::MeasuredMove(frame.rotation.conjugate().rotate(AXES[axis]))
                        }
                        (DerivativeMethod::MeasuredTurn { axis }, _) => {
                            let axis = turning_axis(axis, measured_turn);
                            Motion::MeasuredTurn(frame.rotation.conjugate().rotate(axis))
                        }
                        (DerivativeMethod::BodyTurn { axis }, _) => {
                            Motion::BodyTurn(turning_axis(axis, body_turn))
                        }
                        (DerivativeMethod::Move { axis }, _) => Motion::Move(AXES[axis]),
                        (DerivativeMethod::Turn { axis }, _) => {
                            Motion::Turn(turning_axis(axis, turn), case.base.position)
                        }
                        _ => continue,
                    };
                    of_unknown.push(motion);
                }
                motions.push(of_unknown);
            }
            let (unknowns, base) = (means.len(), case.base.rotation);
            let number = piece.steps[step];
            forward.see(experiment, number, solution, &view, |row, seen, marker| {
                let count = seen.numbers();
                found.rows.extend(row..row + count);
                found.numbers.extend(&marker.numbers[..count]);
                let first = found.columns.len();
                found.columns.resize(first + count * unknowns, 0.0);
                let columns = &mut found.columns[first..];
                let (in_image, turns) = (seen.seen.is_in_image(), seen.seen.is_rotation());
                for (j, motion) in motions.iter().enumerate() {
                    if motion.is_empty() {
                        continue;
                    }
                    let of = |motion: &Motion| match turns {
                        true => motion.turn(marker, |v| base.rotate(v)),
                        false => motion.of(marker, in_image, |v| base.rotate(v)),
                    };
                    let velocity = motion.iter().fold(Vec3::ZERO, |sum, motion| sum + of(motion));
                    for (i, by_point) in marker.by_point[..count].iter().enumerate() {
                        columns[i * unknowns + j] = by_point.dot(velocity);
                    }
                }
            })?;
        }
        Ok(found)
    }

    /// How what would be seen in a piece changes with an unknown, by differences, extrapolated (Richardson); one-sided where the
    /// unknown is at the end of what it can be.
    pub(super) fn difference(
        &mut self,
        piece: &Piece,
        (x, scales): (&[f64], &[f64]),
        j: usize,
    ) -> Result<Predicted, NoAnswerReason> {
        let h = STEP * scales[j];
        let mut rows = Vec::new();
        let mut at = |steps: f64| -> Result<Vec<f64>, NoAnswerReason> {
            let mut moved = x.to_vec();
            moved[j] += steps * h;
            let found = self.predict(piece, &moved)?;
            rows = found.rows;
            Ok(found.numbers)
        };
        let weighed: [(f64, Vec<f64>); 4] = match (at(-1.0), at(1.0)) {
            (Ok(before), Ok(after)) => [
                (1.0 / 6.0, before),
                (-4.0 / 3.0, at(-0.5)?),
                (4.0 / 3.0, at(0.5)?),
                (-1.0 / 6.0, after),
            ],
            (Err(_), Ok(after)) => {
                [(-11.0 / 6.0, at(0.0)?), (3.0, after), (-1.5, at(2.0)?), (1.0 / 3.0, at(3.0)?)]
            }
            (Ok(before), Err(_)) => {
                [(11.0 / 6.0, at(0.0)?), (-3.0, before), (1.5, at(-2.0)?), (-1.0 / 3.0, at(-3.0)?)]
            }
            (Err(error), Err(_)) => return Err(error),
        };
        let slope = |i: usize| {
            let sum: f64 = weighed.iter().map(|(weight, numbers)| weight * numbers[i]).sum();
            sum / h
        };
        let numbers = (0..weighed[0].1.len()).map(slope).collect();
        Ok(Predicted { rows, numbers, columns: Vec::new() })
    }
}

impl Forward<'_> {
    /// What is added to the command of a cable in an experiment, in m or N.
    fn offset(&self, experiment: usize, x: &[f64], cable: usize) -> f64 {
        let of = self.unknowns.iter().zip(x).filter(|(unknown, _)| unknown.is_of(experiment));
        let offset = |quantity: Quantity| match quantity {
            Quantity::TensionOffset { cable: of } | Quantity::ShorteningOffset { cable: of } => {
                of == cable
            }
            _ => false,
        };
        of.filter(|(unknown, _)| unknown.quantities().any(offset)).map(|(_, value)| value).sum()
    }

    /// The angles by which the base of an experiment is turned.
    fn turn(&self, experiment: usize, x: &[f64]) -> [f64; 3] {
        self.three(experiment, x, |quantity| match quantity {
            Quantity::BaseTurn { axis } => Some(axis),
            _ => None,
        })
    }

    /// The angles by which the world is turned in the frame of the measurement.
    fn measured_turn(&self, experiment: usize, x: &[f64]) -> [f64; 3] {
        self.three(experiment, x, |quantity| match quantity {
            Quantity::MeasuredTurn { axis } => Some(axis),
            _ => None,
        })
    }

    /// The angles by which tracked bodies are turned in the frames at their places.
    fn body_turn(&self, experiment: usize, x: &[f64]) -> [f64; 3] {
        self.three(experiment, x, |quantity| match quantity {
            Quantity::BodyTurn { axis } => Some(axis),
            _ => None,
        })
    }

    /// The values of three unknowns of an experiment, zero of those that are known.
    fn three(
        &self,
        experiment: usize,
        x: &[f64],
        axis: impl Fn(Quantity) -> Option<usize>,
    ) -> [f64; 3] {
        let mut three = [0.0; 3];
        for (unknown, value) in self.unknowns.iter().zip(x) {
            if let Some(axis) = axis(unknown.quantity).filter(|_| unknown.is_of(experiment)) {
                three[axis] = *value;
            }
        }
        three
    }
}

/// How the robot moves with an unknown.
enum Motion {
    /// As the model says, so many times.
    Change(Change, f64),
    /// Its markers along this, in their frames.
    Marker(Vec3),
    /// The frame of the positions that were measured, against the world, along this.
    MeasuredMove(Vec3),
    /// The same about this axis through the origin of the world.
    MeasuredTurn(Vec3),
    /// Tracked bodies about this, in the frames at their places.
    BodyTurn(Vec3),
    /// All of it along this.
    Move(Vec3),
    /// All of it about this axis through this point.
    Turn(Vec3, Vec3),
}

impl Motion {
    /// Velocity of a marker in the world, eq. (i3).
    fn of(&self, marker: &Marker, in_image: bool, to_world: impl Fn(Vec3) -> Vec3) -> Vec3 {
        match self {
            // Cameras have their places in the world.
            Self::MeasuredMove(_) | Self::MeasuredTurn(_) if in_image => Vec3::ZERO,
            Self::MeasuredMove(along) => *along,
            Self::MeasuredTurn(axis) => axis.cross(marker.point),
            Self::Change(change, by) => {
                let Twist { linear, angular } = change.twist(Place::Station(marker.station));
                let arm = marker.point - marker.pose.position;
                (to_world(linear) + to_world(angular).cross(arm)) * *by
            }
            Self::Marker(along) => marker.pose.rotation.rotate(*along),
            Self::BodyTurn(_) => Vec3::ZERO,
            Self::Move(along) => *along,
            Self::Turn(axis, centre) => axis.cross(marker.point - *centre),
        }
    }

    /// Angular velocity of a tracked body in the world, as it is seen in the frame of the measurement.
    fn turn(&self, marker: &Marker, to_world: impl Fn(Vec3) -> Vec3) -> Vec3 {
        match self {
            Self::Change(change, by) => {
                to_world(change.twist(Place::Station(marker.station)).angular) * *by
            }
            Self::MeasuredTurn(axis) | Self::Turn(axis, _) => *axis,
            Self::BodyTurn(axis) => marker.pose.rotation.rotate(*axis),
            Self::Marker(_) | Self::MeasuredMove(_) | Self::Move(_) => Vec3::ZERO,
        }
    }
}
