//! What a model says would be seen.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use core::num::NonZero;

use super::build;
use super::error::{IdentifyError, NoAnswer, NoAnswerReason};
use super::experiment::{Experiment, Unknown};
use super::method::DerivativeMethod;
use super::pieces::Piece;
use super::quantity::Quantity;
use super::settings::Settings;
use crate::camera::Camera;
use crate::observation::{Observation, Seen};
use whipcord::case::Case;
use whipcord::cosserat::Accuracy;
use whipcord::kind::ModelKind;
use whipcord::model::Model;
use whipcord::parameter::Parameter;
use whipcord::robot::{Robot, RobotError};
use whipcord::solution::Solution;
use whipcord::stations::Stations;

/// The experiments, and how a model says what would be seen in them.
pub(super) struct Forward<'a> {
    pub(super) robot: &'a Robot,
    pub(super) experiments: &'a [Experiment],
    pub(super) unknowns: &'a [Unknown],
    pub(super) model: Model,
    /// How many threads share the rows.
    pub(super) threads: Option<NonZero<usize>>,
    /// Row of the first number of each experiment, and after them the count of all.
    pub(super) first_rows: Vec<usize>,
    /// What is computed by itself.
    pub(super) pieces: Vec<Piece>,
    /// What was seen, by experiments, in the order of the steps.
    sights: Vec<Vec<Sight>>,
    /// Lengths of the cables at rest in m, before anything is estimated; empty where nobody asks.
    rest: Vec<f64>,
    /// Of each unknown that is a change, the values that it is counted from.
    changed: Vec<Vec<f64>>,
    /// How the derivative by each quantity of each unknown comes about, by experiments; empty where it plays no part.
    methods: Vec<Vec<Vec<DerivativeMethod>>>,
}

/// An observation in the order of the steps.
struct Sight {
    step: usize,
    /// Its number in the experiment.
    observation: usize,
    /// The station of its place.
    station: usize,
    /// The first of its rows within the experiment.
    row: usize,
}

/// How an experiment is looked at, with certain values of the unknowns.
pub(super) struct View {
    /// What is added to the offset of every marker, in m.
    marker_offset: Vec3,
    /// Where the world is in the frame of the positions that were measured.
    pub(super) frame: Pose,
    /// How tracked bodies are turned in the frames at their places.
    pub(super) body: UnitQuaternion,
}

/// A marker in one answer: where it is, in the world, and what is seen of it.
pub(super) struct Marker {
    /// The frame that it sits in, and its station.
    pub(super) pose: Pose,
    pub(super) station: usize,
    pub(super) point: Vec3,
    pub(super) numbers: [f64; 3],
    /// How each number changes with the point, or for a rotation with a turn about the axes of the world.
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
        let sights = |experiment: &Experiment| {
            let mut row = 0;
            let all = experiment.observations.iter().enumerate().map(|(observation, seen)| {
                let (first, s) = (row, arc_length(seen));
                row += seen.numbers();
                let station = places.partition_point(|place| *place < s);
                Sight { step: seen.step, observation, station, row: first }
            });
            let mut all: Vec<Sight> = all.collect();
            all.sort_by_key(|sight| sight.step);
            all
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
            pieces: Piece::all(experiments),
            sights: experiments.iter().map(sights).collect(),
            threads: settings.threads,
            rest: Vec::new(),
            changed: changed.map_err(IdentifyError::Absent)?,
            methods: experiments.iter().enumerate().map(means).collect(),
            model,
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

    /// What was seen in a step.
    fn sights(&self, experiment: usize, step: usize) -> &[Sight] {
        let all = &self.sights[experiment];
        let first = all.partition_point(|sight| sight.step < step);
        let count = all[first..].partition_point(|sight| sight.step == step);
        &all[first..first + count]
    }

    /// Whether something was seen in a step.
    pub(super) fn is_seen(&self, experiment: usize, step: usize) -> bool {
        !self.sights(experiment, step).is_empty()
    }

    /// How the derivative by each quantity of each unknown comes about, in an experiment.
    pub(super) fn methods(&self, experiment: usize) -> &[Vec<DerivativeMethod>] {
        &self.methods[experiment]
    }

    /// Whether the derivatives by an unknown, where it has this value, are differences of answers.
    pub(super) fn is_by_differences(&self, piece: &Piece, j: usize, value: f64) -> bool {
        let methods = DerivativeMethod::at(&self.methods[piece.experiment][j], value);
        let by_gain = |of: &DerivativeMethod| matches!(of, DerivativeMethod::Gain { .. });
        methods == [DerivativeMethod::Differences]
            || (piece.differs && methods.iter().any(DerivativeMethod::is_of_model))
            // The least-squares lengths are not the commands that a gain multiplies.
            || (piece.over_determined && methods.iter().any(by_gain))
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
                Quantity::BaseTurn { .. }
                | Quantity::MeasuredTurn { .. }
                | Quantity::BodyTurn { .. } => 1.0,
            };
            if unknown.is_positive() && *start > 0.0 { *start } else { size.max(start.abs()) }
        };
        self.unknowns.iter().zip(start).map(of).collect()
    }

    /// The unknowns that play a part in an experiment, with their values.
    pub(super) fn numbers(&self, experiment: usize, x: &[f64]) -> Vec<(Quantity, f64)> {
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

    /// How an experiment is looked at with these values.
    pub(super) fn view(&self, experiment: usize, x: &[f64]) -> View {
        let Experiment { frame, body, .. } = &self.experiments[experiment];
        let body = body.unwrap_or(UnitQuaternion::IDENTITY);
        let mut view = View { marker_offset: Vec3::ZERO, frame: *frame, body };
        let (mut turn, mut body_turn) = ([0.0; 3], [0.0; 3]);
        for (quantity, value) in self.numbers(experiment, x) {
            match quantity {
                Quantity::MarkerOffset { axis } => view.marker_offset[axis] = value,
                Quantity::MeasuredPosition { axis } => view.frame.position[axis] = value,
                Quantity::MeasuredTurn { axis } => turn[axis] = value,
                Quantity::BodyTurn { axis } => body_turn[axis] = value,
                _ => {}
            }
        }
        view.frame.rotation = build::turned(view.frame.rotation, turn);
        view.body = build::turned(view.body, body_turn);
        view
    }

    /// Goes over what was seen in a step: the first row of each observation, of those of all experiments.
    pub(super) fn see(
        &self,
        experiment: usize,
        step: usize,
        solution: &Solution,
        view: &View,
        mut each: impl FnMut(usize, &Observation, &Marker),
    ) -> Result<(), NoAnswerReason> {
        let Experiment { cameras, observations, .. } = &self.experiments[experiment];
        for &Sight { observation, station, row, .. } in self.sights(experiment, step) {
            let (pose, seen) = (solution.shape.poses[station], &observations[observation]);
            let offset = seen.offset + view.marker_offset;
            let marker = marker((pose, station), offset, seen, (cameras, view))
                .map_err(|error| NoAnswerReason::View { observation, error })?;
            each(self.first_rows[experiment] + row, seen, &marker);
        }
        Ok(())
    }
}

/// Equations (i1), (i2) and (i2b).
fn marker(
    (pose, station): (Pose, usize),
    offset: Vec3,
    seen: &Observation,
    (cameras, view): (&[Camera], &View),
) -> Result<Marker, crate::camera::ViewError> {
    let frame = &view.frame;
    let point = pose.position + pose.rotation.rotate(offset);
    Ok(match seen.seen {
        Seen::Position(_) => {
            let to_world = frame.rotation.conjugate();
            let by_point = build::AXES.map(|axis| to_world.rotate(axis));
            Marker { pose, station, point, numbers: frame.transform(point).to_array(), by_point }
        }
        Seen::Pixel { camera, .. } => {
            let seen = cameras[camera].project_with_gradient(point)?;
            let [column, row] = seen.pixel;
            let [by_column, by_row] = seen.by_point;
            let (numbers, by_point) = ([column, row, 0.0], [by_column, by_row, Vec3::ZERO]);
            Marker { pose, station, point, numbers, by_point }
        }
        Seen::Rotation { rotation, arm } => {
            let apart = (frame.rotation * pose.rotation * view.body * rotation.conjugate()).log();
            // The transpose of J_l⁻¹(φ) is J_l⁻¹(−φ), which takes the translation of a motion to that of its twist.
            let back = UnitQuaternion::exp(-apart);
            let to_world = frame.rotation.conjugate();
            let by_point = build::AXES.map(|axis| {
                let twist = Pose { position: axis, rotation: back }.log();
                to_world.rotate(twist.linear) * arm
            });
            Marker { pose, station, point, numbers: (apart * arm).to_array(), by_point }
        }
    })
}

/// The numbers that were seen.
pub(super) fn measured(seen: &Observation) -> [f64; 3] {
    match seen.seen {
        Seen::Position(position) => position.to_array(),
        Seen::Pixel { pixel: [column, row], .. } => [column, row, 0.0],
        // The numbers of a model are what its body is turned from this.
        Seen::Rotation { .. } => [0.0; 3],
    }
}
