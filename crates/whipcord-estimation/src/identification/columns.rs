//! How what would be seen changes with the unknowns.

use whipcord_numerics::{Twist, Vec3};

use super::build::{AXES, turning_axis};
use super::error::NoAnswerReason;
use super::forward::{Forward, Marker};
use super::method::DerivativeMethod;
use super::quantity::Quantity;
use whipcord::Linearization;
use whipcord::case::Shortening;
use whipcord::derivatives::{Change, Hold, Place};
use whipcord::error::SolveError;
use whipcord::parameter::Parameter;
use whipcord::shape::Solution;

/// Step of the differences, as a part of what matters.
const STEP: f64 = 1e-3;

impl Forward<'_> {
    /// What would be seen in an experiment, and how it changes with the unknowns as far as the model says so
    /// itself: rows × unknowns, the others zero.
    pub(super) fn predict_with_columns(
        &mut self,
        experiment: usize,
        x: &[f64],
        into: &mut [f64],
        columns: &mut [f64],
    ) -> Result<(), NoAnswerReason> {
        columns.fill(0.0);
        let means: Vec<Vec<DerivativeMethod>> = (self.methods[experiment].iter().zip(x))
            .map(|(methods, value)| DerivativeMethod::at(methods, *value))
            .collect();
        let parameters: Vec<Parameter> = means
            .iter()
            .flatten()
            .filter_map(|means| match means {
                DerivativeMethod::Parameter(parameter) => Some(*parameter),
                _ => None,
            })
            .collect();
        let asks = means.iter().flatten().any(|means| {
            matches!(
                means,
                DerivativeMethod::Parameter(_)
                    | DerivativeMethod::Offset { .. }
                    | DerivativeMethod::Gain { .. }
            )
        });
        let observed: Vec<usize> =
            self.experiments[experiment].observations.iter().map(|seen| seen.step).collect();
        let (prepared, case) = self.prepare(experiment, x)?;
        let mut answers: Vec<(Solution, Option<Linearization>)> = Vec::new();
        match prepared {
            prepared if asks => {
                let answered = prepared.solve_steps_with_derivatives(
                    &case,
                    &parameters,
                    |step| observed.contains(&step),
                    |solution, derivatives| answers.push((solution, derivatives)),
                );
                match answered {
                    Ok(()) => {}
                    // There is an answer; only how it came about in a step is not known well enough.
                    Err((_, SolveError::NoDerivatives | SolveError::NoDerivativesOfRest)) => {
                        self.differ(experiment);
                        return self.predict_with_columns(experiment, x, into, columns);
                    }
                    Err((_, error)) => return Err(error.into()),
                }
            }
            prepared => prepared
                .solve_steps(&case, |solution| answers.push((solution, None)))
                .map_err(|(_, error)| error)?,
        }
        let turn = self.turn(experiment, x);
        let measured_turn = self.measured_turn(experiment, x);
        let frame = *self.frame();
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
                                (Some(Shortening::Fraction(_)), _) if !self.rest().is_empty() => {
                                    solution.cables[cable].initial_length / self.rest()[cable]
                                }
                                _ => 1.0,
                            };
                            Motion::Change(derivatives.offset(cable), by)
                        }
                        (DerivativeMethod::Gain { cable, by_tension }, Some(derivatives)) => {
                            let length = solution.cables[cable].initial_length;
                            let rest = self.rest().get(cable).copied().unwrap_or(1.0);
                            let offset = self.offset(experiment, x, cable);
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
            let mut station = 0;
            let stations: Vec<usize> = self.observed_stations(experiment, step);
            self.see(experiment, step, solution, |row, seen, marker| {
                let count = seen.numbers();
                into[row..row + count].copy_from_slice(&marker.numbers[..count]);
                for (j, motion) in motions.iter().enumerate() {
                    if motion.is_empty() {
                        continue;
                    }
                    let in_image = seen.seen.is_in_image();
                    let of = |motion: &Motion| {
                        motion.of(marker, stations[station], in_image, |v| base.rotate(v))
                    };
                    let velocity = motion.iter().fold(Vec3::ZERO, |sum, motion| sum + of(motion));
                    for (i, by_point) in marker.by_point[..count].iter().enumerate() {
                        columns[(row + i) * unknowns + j] = by_point.dot(velocity);
                    }
                }
                station += 1;
            })?;
        }
        Ok(())
    }

    /// From here on, what the model would differentiate in an experiment comes by differences.
    fn differ(&mut self, experiment: usize) {
        for methods in &mut self.methods[experiment] {
            let is_of_model = |method: &DerivativeMethod| {
                matches!(
                    method,
                    DerivativeMethod::Parameter(_)
                        | DerivativeMethod::Offset { .. }
                        | DerivativeMethod::Gain { .. }
                )
            };
            if methods.iter().any(is_of_model) {
                *methods = vec![DerivativeMethod::Differences];
            }
        }
    }

    /// Adds the columns of an experiment that come by differences, extrapolated (Richardson); one-sided where an
    /// unknown is at the end of what it can be.
    pub(super) fn add_differences(
        &mut self,
        experiment: usize,
        x: &[f64],
        scales: &[f64],
        columns: &mut [f64],
    ) -> Result<(), NoAnswerReason> {
        let n = self.unknowns.len();
        let rows = self.first_rows[experiment + 1] - self.first_rows[experiment];
        for j in 0..n {
            if DerivativeMethod::at(&self.methods[experiment][j], x[j])
                != [DerivativeMethod::Differences]
            {
                continue;
            }
            let h = STEP * scales[j];
            let mut at = |steps: f64| -> Result<Vec<f64>, NoAnswerReason> {
                let mut moved = x.to_vec();
                moved[j] += steps * h;
                let mut seen = vec![0.0; rows];
                self.predict(experiment, &moved, &mut seen).map(|()| seen)
            };
            let sides = (at(-1.0), at(1.0));
            let weighed: [(f64, Vec<f64>); 4] = match sides {
                (Ok(before), Ok(after)) => [
                    (1.0 / 6.0, before),
                    (-4.0 / 3.0, at(-0.5)?),
                    (4.0 / 3.0, at(0.5)?),
                    (-1.0 / 6.0, after),
                ],
                (Err(_), Ok(after)) => {
                    [(-11.0 / 6.0, at(0.0)?), (3.0, after), (-1.5, at(2.0)?), (1.0 / 3.0, at(3.0)?)]
                }
                (Ok(before), Err(_)) => [
                    (11.0 / 6.0, at(0.0)?),
                    (-3.0, before),
                    (1.5, at(-2.0)?),
                    (-1.0 / 3.0, at(-3.0)?),
                ],
                (Err(error), Err(_)) => return Err(error),
            };
            for row in 0..rows {
                let sum: f64 = weighed.iter().map(|(weight, seen)| weight * seen[row]).sum();
                columns[row * n + j] = sum / h;
            }
        }
        Ok(())
    }

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
    /// All of it along this.
    Move(Vec3),
    /// All of it about this axis through this point.
    Turn(Vec3, Vec3),
}

impl Motion {
    /// Velocity of a marker in the world, eq. (i3).
    fn of(
        &self,
        marker: &Marker,
        station: usize,
        in_image: bool,
        to_world: impl Fn(Vec3) -> Vec3,
    ) -> Vec3 {
        match self {
            // Cameras have their places in the world.
            Self::MeasuredMove(_) | Self::MeasuredTurn(_) if in_image => Vec3::ZERO,
            Self::MeasuredMove(along) => *along,
            Self::MeasuredTurn(axis) => axis.cross(marker.point),
            Self::Change(change, by) => {
                let Twist { linear, angular } = change.twist(Place::Station(station));
                let arm = marker.point - marker.pose.position;
                (to_world(linear) + to_world(angular).cross(arm)) * *by
            }
            Self::Marker(along) => marker.pose.rotation.rotate(*along),
            Self::Move(along) => *along,
            Self::Turn(axis, centre) => axis.cross(marker.point - *centre),
        }
    }
}
