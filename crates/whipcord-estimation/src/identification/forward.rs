//! What a model says would be seen.

use whipcord_numerics::{Pose, Vec3};

use super::build;
use super::error::{IdentifyError, NoAnswer, NoAnswerReason};
use super::experiment::{Experiment, Unknown};
use super::method::DerivativeMethod;
use super::outcome::Unstable;
use super::quantity::Quantity;
use super::settings::Settings;
use crate::camera::Camera;
use crate::observation::{Observation, Seen};
use whipcord::case::Case;
use whipcord::cosserat::Accuracy;
use whipcord::kind::ModelKind;
use whipcord::model::{Model, Prepared};
use whipcord::parameter::Parameter;
use whipcord::robot::{Robot, RobotError};
use whipcord::shape::Solution;
use whipcord::stations::Stations;

/// The experiments, and the model for the robot of the last numbers.
pub(super) struct Forward<'a> {
    pub(super) robot: &'a Robot,
    pub(super) experiments: &'a [Experiment],
    pub(super) unknowns: &'a [Unknown],
    model: Model,
    /// Row of the first number of each experiment, and after them the count of all.
    pub(super) first_rows: Vec<usize>,
    /// Station of each observation, by experiments.
    stations: Vec<Vec<usize>>,
    /// Lengths of the cables at rest in m, before anything is estimated; empty where nobody asks.
    rest: Vec<f64>,
    /// Of each unknown that is a change, the values that it is counted from.
    changed: Vec<Vec<f64>>,
    /// How the derivative by each quantity of each unknown comes about, by experiments; empty where it plays no part.
    pub(super) methods: Vec<Vec<Vec<DerivativeMethod>>>,
    built: Option<Built>,
    /// What is added to the offset of every marker, in m.
    marker_offset: Vec3,
    /// Where the world is in the frame of the positions of the experiment that was prepared last.
    frame: Pose,
}

/// The robot with the last numbers, and its model.
struct Built {
    /// The unknowns of the robot and their bits.
    numbers: Vec<(Quantity, u64)>,
    robot: Robot,
    prepared: Prepared,
}

/// A marker in one answer: where it is, in the world, and what is seen of it.
pub(super) struct Marker {
    /// The frame that it sits in.
    pub(super) pose: Pose,
    pub(super) point: Vec3,
    pub(super) numbers: [f64; 3],
    /// How each number changes with the point.
    pub(super) by_point: [Vec3; 3],
}

/// No looser tolerance of a rod: the number of its steps changes with the unknowns, and what that changes of the answer must not
/// count in differences of answers and in the sum of squares.
const TOLERANCE: f64 = 1e-9;

impl<'a> Forward<'a> {
    pub(super) fn new(
        robot: &'a Robot,
        experiments: &'a [Experiment],
        unknowns: &'a [Unknown],
        settings: &Settings,
    ) -> Result<Self, IdentifyError> {
        let arc_length = |seen: &Observation| seen.place.arc_length(robot.disks());
        let observations = || experiments.iter().flat_map(|experiment| &experiment.observations);
        let mut places: Vec<f64> = observations().map(arc_length).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let station = |seen: &Observation| {
            let s = arc_length(seen);
            places.partition_point(|place| *place < s)
        };
        let mut first_rows = vec![0];
        for experiment in experiments {
            let rows: usize = experiment.observations.iter().map(Observation::numbers).sum();
            first_rows.push(first_rows[first_rows.len() - 1] + rows);
        }
        let mut model = settings.model.at(Stations::At(places.clone()));
        if let Model::Cosserat(options) | Model::CosseratDisks(options) = &mut model
            && let Accuracy::Tolerance(tolerance) = &mut options.accuracy
        {
            *tolerance = tolerance.min(TOLERANCE);
        }
        let means = |(e, experiment): (usize, &Experiment)| {
            unknowns
                .iter()
                .map(|unknown| {
                    if !unknown.is_of(e) {
                        return Vec::new();
                    }
                    DerivativeMethod::of(unknown, unknowns, experiment, (&model, robot))
                })
                .collect()
        };
        let present = |unknown: &Unknown| {
            let case = &experiments[unknown.experiment.unwrap_or(0)].case;
            let quantities = unknown.quantities().filter(|_| unknown.is_change());
            quantities.map(|quantity| build::present(&quantity, robot, case)).collect()
        };
        let changed = unknowns.iter().map(present).collect::<Result<_, RobotError>>();
        let mut forward = Self {
            robot,
            experiments,
            unknowns,
            first_rows,
            stations: experiments
                .iter()
                .map(|experiment| experiment.observations.iter().map(station).collect())
                .collect(),
            rest: Vec::new(),
            changed: changed.map_err(IdentifyError::Absent)?,
            methods: experiments.iter().enumerate().map(means).collect(),
            model,
            built: None,
            marker_offset: Vec3::ZERO,
            frame: Pose::IDENTITY,
        };
        if unknowns.iter().any(|u| matches!(u.quantity, Quantity::ShorteningOffset { .. })) {
            forward.rest = forward.rest_lengths()?;
        }
        Ok(forward)
    }

    /// Lengths of the cables at rest, which any answer says.
    fn rest_lengths(&self) -> Result<Vec<f64>, IdentifyError> {
        let failed = |error| {
            IdentifyError::NoAnswerAtStart(NoAnswer {
                experiment: 0,
                reason: NoAnswerReason::Solve(error),
            })
        };
        let case = &self.experiments[0].case;
        let mut prepared = self.model.prepare(self.robot, &case.loads).map_err(failed)?;
        let solution = prepared.solve(case, None).map_err(failed)?;
        Ok(solution.cables.iter().map(|cable| cable.initial_length).collect())
    }

    pub(super) fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// Stations of what was seen in a step, in the order of [`Self::see`].
    pub(super) fn observed_stations(&self, experiment: usize, step: usize) -> Vec<usize> {
        let seen = self.experiments[experiment].observations.iter();
        let all = seen.zip(&self.stations[experiment]);
        all.filter(|(seen, _)| seen.step == step).map(|(_, station)| *station).collect()
    }

    pub(super) fn kind(&self) -> ModelKind {
        self.model.kind()
    }

    /// Count of the numbers that were seen.
    pub(super) fn count(&self) -> usize {
        self.first_rows[self.experiments.len()]
    }

    /// Where the search starts.
    pub(super) fn start(&self) -> Result<Vec<f64>, IdentifyError> {
        let of = |unknown: &Unknown| {
            let case = &self.experiments[unknown.experiment.unwrap_or(0)].case;
            let start = match unknown.start {
                Some(start) => start,
                None if unknown.is_change() => 0.0,
                None if let Quantity::MeasuredPosition { axis } = unknown.quantity => {
                    self.experiments[unknown.experiment.unwrap_or(0)].frame.position[axis]
                }
                None => build::present(&unknown.quantity, self.robot, case)?,
            };
            Ok(start.max(unknown.least()).min(unknown.greatest()))
        };
        self.unknowns.iter().map(|unknown| of(unknown).map_err(IdentifyError::Absent)).collect()
    }

    /// A change of each unknown that matters, in its unit: its own size where it cannot be negative, else
    /// what is large for a robot of this size.
    pub(super) fn scales(&self, start: &[f64]) -> Vec<f64> {
        let length = self.robot.backbone().length;
        let commands = self.experiments.iter().flat_map(|experiment| {
            experiment.case.before.iter().chain([&experiment.case.commands]).flatten()
        });
        let tension = commands.filter_map(|command| command.tension).fold(0.0, f64::max);
        let tension = if tension > 0.0 { tension } else { 1.0 };
        let of = |(unknown, start): (&Unknown, &f64)| {
            use Parameter as P;
            let size = match unknown.quantity {
                Quantity::Parameter(parameter) => match parameter {
                    P::Gravity { .. } => 9.806_65,
                    P::TipForce { .. } | P::PointForce { .. } => 0.1 * tension,
                    P::TipMoment { .. } | P::PointMoment { .. } => 0.1 * tension * length,
                    P::LineForce { .. } | P::LineForceAt { .. } => 0.1 * tension / length,
                    P::LineMoment { .. } | P::LineMomentAt { .. } => 0.1 * tension,
                    P::RestCurvature { .. } | P::RestCurvatureAt { .. } => 1.0 / length,
                    P::Start { .. } | P::End { .. } => 0.1 * length,
                    P::Coefficient { power, .. } => 0.1 * length / length.powf(power as f64),
                    P::PointMass { .. } | P::DiskMass => 0.01 * tension,
                    P::Pretension { .. } => 0.1 * tension,
                    P::FreeLength { .. } => length,
                    P::Backlash { motor } | P::MotorOffset { motor } => {
                        let motor = self.robot.motors().get(motor);
                        motor.map_or(1.0, |motor| motor.command_scale(length))
                    }
                    P::PoissonRatio => 0.3,
                    _ => 1.0,
                },
                Quantity::Friction { .. } => 0.1,
                Quantity::Gain { .. } => 1.0,
                Quantity::TensionOffset { .. } => tension,
                Quantity::ShorteningOffset { .. }
                | Quantity::MarkerOffset { .. }
                | Quantity::MeasuredPosition { .. }
                | Quantity::BasePosition { .. } => 0.1 * length,
                Quantity::BaseTurn { .. } | Quantity::MeasuredTurn { .. } => 1.0,
            };
            if unknown.is_positive() && *start > 0.0 { *start } else { size.max(start.abs()) }
        };
        self.unknowns.iter().zip(start).map(of).collect()
    }

    /// The unknowns that play a part in an experiment, with their values.
    fn numbers(&self, experiment: usize, x: &[f64]) -> Vec<(Quantity, f64)> {
        let of = self.unknowns.iter().zip(x).zip(&self.changed);
        let of = of.filter(|((unknown, _), _)| unknown.is_of(experiment));
        of.flat_map(|((unknown, value), from)| {
            let present = from.iter().copied().chain(core::iter::repeat(0.0));
            unknown
                .quantities()
                .zip(present)
                .map(|(quantity, present)| (quantity, present + *value))
        })
        .collect()
    }

    /// Robot and case of an experiment with these values.
    pub(super) fn built(
        &self,
        experiment: usize,
        x: &[f64],
    ) -> Result<(Robot, Case), NoAnswerReason> {
        let numbers = self.numbers(experiment, x);
        let case = &self.experiments[experiment].case;
        let robot = build::robot(self.robot, case, &numbers)?;
        let case =
            build::case(&robot, case, &numbers, &self.rest).map_err(whipcord::SolveError::from)?;
        Ok((robot, case))
    }

    /// The model of an experiment's robot, and its case up to the last step in which something was seen.
    pub(super) fn prepare(
        &mut self,
        experiment: usize,
        x: &[f64],
    ) -> Result<(&mut Prepared, Case), NoAnswerReason> {
        let numbers = self.numbers(experiment, x);
        self.marker_offset = Vec3::ZERO;
        self.frame = self.experiments[experiment].frame;
        let mut turn = [0.0; 3];
        for &(quantity, value) in &numbers {
            match quantity {
                Quantity::MarkerOffset { axis } => self.marker_offset[axis] = value,
                Quantity::MeasuredPosition { axis } => self.frame.position[axis] = value,
                Quantity::MeasuredTurn { axis } => turn[axis] = value,
                _ => {}
            }
        }
        self.frame.rotation = build::turned(self.frame.rotation, turn);
        let Experiment { case, observations, .. } = &self.experiments[experiment];
        let last = observations.iter().map(|seen| seen.step).max().unwrap_or(0);
        let of_robot: Vec<(Quantity, u64)> = numbers
            .iter()
            .filter(|(quantity, _)| !quantity.is_of_case())
            .map(|(quantity, value)| (*quantity, value.to_bits()))
            .collect();
        let kept = self.built.take().filter(|built| built.numbers == of_robot);
        let (robot, prepared) = match kept {
            Some(built) => (built.robot, Some(built.prepared)),
            None => (build::robot(self.robot, case, &numbers)?, None),
        };
        let case =
            build::case(&robot, case, &numbers, &self.rest).map_err(whipcord::SolveError::from)?;
        let case = case.step(last).unwrap_or(case);
        let prepared = match prepared.filter(|prepared| prepared.takes_places_of(&case.loads)) {
            Some(prepared) => prepared,
            None => self.model.prepare(&robot, &case.loads)?,
        };
        let built = Built { numbers: of_robot, robot, prepared };
        Ok((&mut self.built.insert(built).prepared, case))
    }

    /// Where the world is in the frame of the positions that were measured, in an experiment with these values.
    pub(super) fn frame_of(
        &mut self,
        experiment: usize,
        x: &[f64],
    ) -> Result<Pose, NoAnswerReason> {
        self.prepare(experiment, x)?;
        Ok(self.frame)
    }

    /// That of the experiment that was prepared last.
    pub(super) const fn frame(&self) -> &Pose {
        &self.frame
    }

    /// What would be seen in an experiment, without derivatives.
    pub(super) fn predict(
        &mut self,
        experiment: usize,
        x: &[f64],
        into: &mut [f64],
    ) -> Result<(), NoAnswerReason> {
        let (prepared, case) = self.prepare(experiment, x)?;
        let mut solutions = Vec::new();
        prepared
            .solve_steps(&case, |solution| solutions.push(solution))
            .map_err(|(_, error)| error)?;
        for (step, solution) in solutions.iter().enumerate() {
            self.see(experiment, step, solution, |row, seen, marker| {
                into[row..row + seen.numbers()].copy_from_slice(&marker.numbers[..seen.numbers()]);
            })?;
        }
        Ok(())
    }

    /// How many answers there are, one for each step in which something was seen, and which of them are
    /// unstable.
    pub(super) fn stability(&mut self, x: &[f64]) -> (usize, Vec<Unstable>) {
        let (mut answers, mut unstable) = (0, Vec::new());
        for experiment in 0..self.experiments.len() {
            let seen = &self.experiments[experiment].observations;
            let mut observed: Vec<usize> = seen.iter().map(|seen| seen.step).collect();
            observed.sort_unstable();
            observed.dedup();
            // These numbers had an answer when they were fitted.
            let Ok((prepared, case)) = self.prepare(experiment, x) else { continue };
            let mut step = 0;
            let _ = prepared.solve_steps(&case, |solution| {
                if observed.binary_search(&step).is_ok() {
                    answers += 1;
                    let diagnostics = &solution.diagnostics;
                    if let Some(stability) =
                        diagnostics.stability.filter(|_| diagnostics.is_unstable())
                    {
                        unstable.push(Unstable { experiment, step, stability });
                    }
                }
                step += 1;
            });
        }
        (answers, unstable)
    }

    /// Goes over what was seen in a step: the first row of each observation within the experiment.
    pub(super) fn see(
        &self,
        experiment: usize,
        step: usize,
        solution: &Solution,
        mut each: impl FnMut(usize, &Observation, &Marker),
    ) -> Result<(), NoAnswerReason> {
        let Experiment { cameras, observations, .. } = &self.experiments[experiment];
        let mut row = 0;
        for (i, seen) in observations.iter().enumerate() {
            if seen.step == step {
                let pose = solution.shape.poses[self.stations[experiment][i]];
                let offset = seen.offset + self.marker_offset;
                let marker = marker(pose, offset, seen, (cameras, &self.frame))
                    .map_err(|error| NoAnswerReason::View { observation: i, error })?;
                each(row, seen, &marker);
            }
            row += seen.numbers();
        }
        Ok(())
    }
}

/// Equations (i1) and (i2).
fn marker(
    pose: Pose,
    offset: Vec3,
    seen: &Observation,
    (cameras, frame): (&[Camera], &Pose),
) -> Result<Marker, crate::camera::ViewError> {
    let point = pose.position + pose.rotation.rotate(offset);
    Ok(match seen.seen {
        Seen::Position(_) => {
            let to_world = frame.rotation.conjugate();
            let by_point = build::AXES.map(|axis| to_world.rotate(axis));
            Marker { pose, point, numbers: frame.transform(point).to_array(), by_point }
        }
        Seen::Pixel { camera, .. } => {
            let seen = cameras[camera].project_with_gradient(point)?;
            let [column, row] = seen.pixel;
            let [by_column, by_row] = seen.by_point;
            let (numbers, by_point) = ([column, row, 0.0], [by_column, by_row, Vec3::ZERO]);
            Marker { pose, point, numbers, by_point }
        }
    })
}

/// The numbers that were seen.
pub(super) fn measured(seen: &Observation) -> [f64; 3] {
    match seen.seen {
        Seen::Position(position) => position.to_array(),
        Seen::Pixel { pixel: [column, row], .. } => [column, row, 0.0],
    }
}
