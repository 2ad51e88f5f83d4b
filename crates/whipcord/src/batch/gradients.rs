//! Gradients of scalars by the commands of every row, and by parameters of the robot.

use super::error::BatchError;
use super::options::BatchOptions;
use super::rows::Rows;
use super::run::run;
use crate::derivatives::Cotangent;
use crate::derivatives::{Hold, Place};
use crate::error::SolveError;
use crate::model::Model;
use crate::parameter::Parameter;
use crate::robot::Robot;
use whipcord_numerics::{Twist, Vec3};

/// Rows that one thread takes at a time.
const ROWS: usize = 16;

/// The sensitivity of one scalar for each row to that row's answer: finite numbers. An empty list is
/// one of zeros.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sensitivities<'a> {
    /// Rows × stations × 3: to the positions, in the frame that shapes are in.
    pub positions: &'a [f64],
    /// Rows × stations × 3: to a turn `δR = φ̂ R` of the frames of the stations, in the frame that
    /// shapes are in.
    pub rotations: &'a [f64],
    /// Rows × cables: to the tensions.
    pub tensions: &'a [f64],
    /// Rows × cables: to the lengths of the cables.
    pub lengths: &'a [f64],
}

/// Where the gradients go, row after row. A row without an answer gets zeros: NaN would spread to every parameter that
/// rows share when gradients are summed, where a mask on the rows of a loss is to leave that row out.
#[derive(Debug)]
pub struct Gradients<'a> {
    /// Rows × commands of a row, those of the cables or of the motors: by the commands.
    pub commands: &'a mut [f64],
    /// Rows × parameters.
    pub parameters: &'a mut [f64],
}

/// Solves the rows by a model with exact derivatives ([`Model::has_derivatives`]) and pulls the sensitivities of a scalar to each answer back
/// to the commands of the row and to these parameters, exactly, in one sweep for all of them. When a
/// parameter changes the commands are held.
///
/// # Errors
/// As [`super::solve_batch_into`]. A row without an answer, or whose answer has no derivatives, is no
/// error of the batch.
pub fn pull_back_batch(
    model: &Model,
    robot: &Robot,
    rows: Rows<'_>,
    parameters: &[Parameter],
    batch: &BatchOptions<'_>,
    sensitivities: Sensitivities<'_>,
    gradients: Gradients<'_>,
) -> Result<Vec<Result<(), SolveError>>, BatchError> {
    let prepared = model.prepare(robot, &rows.first_loads())?;
    let (stations, cables) = (prepared.stations().len(), robot.cables().len());
    let (count, width) = (rows.count(robot)?, rows.width(robot));
    // What a motor does to its cables is a change of what they are told, as other numbers of the motor are.
    let by_motors = matches!(rows, Rows::Motors { .. });
    let mut sources = Vec::new();
    if by_motors {
        sources.extend((0..width).map(|motor| Parameter::MotorCommand { motor }));
    }
    sources.extend_from_slice(parameters);
    sensitivities.check(count, stations, cables)?;
    size("commands", gradients.commands.len(), count * width)?;
    size("parameters", gradients.parameters.len(), count * parameters.len())?;
    let mut outcomes = vec![Ok(()); count];
    let mut jobs = Vec::with_capacity(count.div_ceil(ROWS));
    let (mut by_commands, mut by_parameters) = (gradients.commands, gradients.parameters);
    for (i, outcomes) in outcomes.chunks_mut(ROWS).enumerate() {
        let (here, rest) = by_commands.split_at_mut(outcomes.len() * width);
        let (of_parameters, others) = by_parameters.split_at_mut(outcomes.len() * parameters.len());
        (by_commands, by_parameters) = (rest, others);
        jobs.push((i * ROWS, here, of_parameters, outcomes));
    }
    run(
        jobs,
        count,
        batch,
        model.cancel(),
        || (prepared.clone(), rows.blank()),
        |(first, by_commands, by_parameters, outcomes), (prepared, blank), tally| {
            for (i, outcome) in outcomes.iter_mut().enumerate() {
                if !tally.goes_on() {
                    return;
                }
                let row = first + i;
                let commands = &mut by_commands[i * width..(i + 1) * width];
                let count = parameters.len();
                let of_parameters = &mut by_parameters[i * count..(i + 1) * count];
                let case = rows.case(row, robot, blank);
                let to_base = case.base.rotation.conjugate();
                let built = match prepared.takes_places_of(&case.loads) {
                    true => Ok(()),
                    false => model.prepare(robot, &case.loads).map(|built| *prepared = built),
                };
                let answer = match tally.cancelled() {
                    Some(error) => Err(error),
                    None => {
                        built.and_then(|()| prepared.solve_with_derivatives(case, None, &sources))
                    }
                };
                *outcome = answer.map(|(_, derivatives)| {
                    let cotangent =
                        sensitivities.of_row(row, (stations, cables), |v| to_base.rotate(v));
                    let gradient = derivatives.pull_back(&cotangent, Hold::Commands);
                    let (motors, others) =
                        gradient.parameters.split_at(if by_motors { width } else { 0 });
                    commands.copy_from_slice(if by_motors { motors } else { &gradient.commands });
                    of_parameters.copy_from_slice(others);
                });
                if outcome.is_err() {
                    commands.fill(0.0);
                    of_parameters.fill(0.0);
                }
                tally.add(1);
            }
        },
    )?;
    Ok(outcomes)
}

fn size(name: &'static str, given: usize, needed: usize) -> Result<(), BatchError> {
    if given == needed { Ok(()) } else { Err(BatchError::Size { name, given, needed }) }
}

impl Sensitivities<'_> {
    fn check(&self, rows: usize, stations: usize, cables: usize) -> Result<(), BatchError> {
        for (name, given, width) in [
            ("positions", self.positions, stations * 3),
            ("rotations", self.rotations, stations * 3),
            ("tensions", self.tensions, cables),
            ("lengths", self.lengths, cables),
        ] {
            if !given.is_empty() {
                size(name, given.len(), rows * width)?;
            }
            if let Some(at) = given.iter().position(|value| !value.is_finite()) {
                return Err(BatchError::NotFinite { name, row: at / width, value: given[at] });
            }
        }
        Ok(())
    }

    /// Those of one row, turned to the frame of the base.
    fn of_row(
        &self,
        row: usize,
        (stations, cables): (usize, usize),
        to_base: impl Fn(Vec3) -> Vec3,
    ) -> Cotangent {
        let vector = |values: &[f64], station: usize| {
            let at = 3 * (row * stations + station);
            values.get(at..at + 3).map_or(Vec3::ZERO, |v| to_base(Vec3::new(v[0], v[1], v[2])))
        };
        let places = (0..stations).map(|station| {
            let (linear, angular) =
                (vector(self.positions, station), vector(self.rotations, station));
            (Place::Station(station), Twist { linear, angular })
        });
        let of_cables = |values: &[f64]| {
            values.get(row * cables..(row + 1) * cables).unwrap_or_default().to_vec()
        };
        Cotangent {
            places: places.collect(),
            lengths: of_cables(self.lengths),
            tensions: of_cables(self.tensions),
            ..Cotangent::default()
        }
    }
}
