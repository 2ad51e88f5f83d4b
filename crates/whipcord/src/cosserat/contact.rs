//! How the rod yields to what pushes it: the side of contact that this model is asked for.

use whipcord_numerics::{Pose, UnitQuaternion};

use super::derivatives::{Derivatives, Hold, Place};
use super::model::{Cosserat, Workspace};
use super::options::{Accuracy, Options};
use crate::case::{Case, LoadFrame, PointLoad};
use crate::contact::{self, Push, Yielding};
use crate::error::SolveError;
use crate::model::Stations;
use crate::robot::Robot;
use crate::shape::{NoStability, Solution};

/// The backbone is watched at this many places from base to tip, besides the disks.
const WATCHED: usize = 80;

/// Tolerance on the way to the answer, as a part of the length.
const TRAVELLING: f64 = 1e-6;

/// The rod among obstacles.
struct Pushed<'a> {
    robot: &'a Robot,
    options: Options,
    /// As the user wants the answer.
    asked: &'a Options,
    watched: Vec<f64>,
    initial_lengths: Vec<f64>,
    force_scale: f64,
    /// The arc lengths of the pushes that `model` is built for, and the model.
    pushed: Vec<f64>,
    model: Option<Cosserat>,
    workspace: Workspace,
    last: Option<Solution>,
    derivatives: Option<Derivatives>,
    kept: Option<Solution>,
}

impl Cosserat {
    /// The shape among the obstacles of a case.
    pub(super) fn solve_in_contact(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
    ) -> Result<Solution, SolveError> {
        case.check(&self.robot)?;
        let length = self.robot.backbone().length;
        let mut watched = self.robot.disks().arc_lengths.clone();
        watched.extend((0..=WATCHED).map(|k| length * k as f64 / WATCHED as f64));
        sorted(&mut watched, 1e-3 * length / WATCHED as f64);
        let at_base = self.grids[0].shooting.at(0, 0, 0).0.section.bending_stiffness();
        let mut initial_lengths = vec![0.0; self.layout.order.len()];
        for (&cable, &initial) in self.layout.order.iter().zip(&self.layout.rest_lengths) {
            initial_lengths[cable] = initial;
        }
        let mut pushed = Pushed {
            robot: &self.robot,
            options: Options {
                stability: false,
                accuracy: on_the_way(self.options.accuracy),
                ..self.options.clone()
            },
            asked: &self.options,
            watched,
            initial_lengths,
            force_scale: at_base.column(0).x / (length * length),
            pushed: Vec::new(),
            model: None,
            workspace: Workspace::default(),
            last: None,
            derivatives: None,
            kept: None,
        };
        contact::solve(&mut pushed, &self.robot, case, warm_start)
    }
}

/// How finely the rod is integrated on the way to the answer.
fn on_the_way(asked: Accuracy) -> Accuracy {
    match asked {
        Accuracy::Tolerance(tolerance) => Accuracy::Tolerance(tolerance.max(TRAVELLING)),
        steps @ Accuracy::Steps(_) => steps,
    }
}

/// In order, without those that are nearer to the one before than `apart`; the first and the last stay.
fn sorted(places: &mut Vec<f64>, apart: f64) {
    places.sort_by(f64::total_cmp);
    let last = places.last().copied();
    places.dedup_by(|next, before| *next - *before <= apart);
    if let (Some(end), Some(last)) = (places.last_mut(), last) {
        *end = last;
    }
}

impl Pushed<'_> {
    /// The case with the pushes as point loads.
    fn with_pushes(&self, case: &Case, pushes: &[Push]) -> Case {
        let mut case = case.clone();
        let turn = match case.loads.frame {
            LoadFrame::Base => UnitQuaternion::IDENTITY,
            LoadFrame::World => case.base.rotation,
        };
        case.loads.points.extend(pushes.iter().map(|push| PointLoad {
            at: push.arc_length,
            force: turn.rotate(push.wrench.force),
            moment: turn.rotate(push.wrench.moment),
            follower: false,
        }));
        case
    }

    fn stations(&self, pushes: &[Push]) -> Vec<f64> {
        let mut stations = self.watched.clone();
        stations.extend(pushes.iter().map(|push| push.arc_length));
        stations.sort_by(f64::total_cmp);
        stations.dedup();
        stations
    }
}

impl Yielding for Pushed<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.initial_lengths
    }

    fn knows_forces(&self) -> bool {
        true
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }

    fn reset(&mut self) {
        self.last = None;
    }

    fn refine(&mut self) -> bool {
        let coarse = self.options.accuracy != self.asked.accuracy;
        self.options.accuracy = self.asked.accuracy;
        self.model = None;
        coarse
    }

    fn start_from(&mut self, answer: &Solution) {
        self.last = Some(answer.clone());
    }

    fn consider(&mut self, case: &Case, pushes: &[Push]) -> Result<(), SolveError> {
        let case = self.with_pushes(case, pushes);
        let places = pushes.iter().map(|push| push.arc_length);
        if self.model.is_none() || !places.clone().eq(self.pushed.iter().copied()) {
            let stations = Stations::At(self.stations(pushes));
            let options = Options { stations, ..self.options.clone() };
            self.model = Some(Cosserat::new(self.robot, &case.loads, &options)?);
            self.pushed = places.collect();
        }
        let Some(model) = &self.model else { return Ok(()) };
        let (last, workspace) = (self.last.as_ref(), &mut self.workspace);
        let (solution, derivatives) = model.solve_with_derivatives(&case, last, &[], workspace)?;
        self.derivatives = Some(derivatives);
        self.last = Some(solution);
        Ok(())
    }

    fn pose(&self, arc_length: f64) -> Pose {
        let Some(solution) = &self.last else { return Pose::IDENTITY };
        let shape = &solution.shape;
        let k = shape.arc_length.partition_point(|&s| s < arc_length);
        let pose = shape.poses[k.min(shape.poses.len() - 1)];
        shape.poses[0].inverse() * pose
    }

    fn unsettled(&self) -> f64 {
        0.0
    }

    fn advance(&mut self, _: &[[f64; 6]], _: f64) {}

    fn compliance(
        &mut self,
        pushes: &[Push],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) -> Result<(), SolveError> {
        let (Some(derivatives), Some(solution)) = (&self.derivatives, &self.last) else {
            return Err(SolveError::NoDerivatives);
        };
        let stations = &solution.shape.arc_length;
        let places: Vec<Place> = pushes
            .iter()
            .map(|push| Place::Station(stations.partition_point(|&s| s < push.arc_length)))
            .collect();
        let n = 6 * pushes.len();
        drift.clear();
        drift.resize(n, 0.0);
        compliance.clear();
        compliance.resize(n * n, 0.0);
        for (j, &at) in places.iter().enumerate() {
            for component in 0..6 {
                let change = derivatives.wrench(at, component, Hold::Commands);
                for (i, &place) in places.iter().enumerate() {
                    let twist = change.twist(place);
                    let rates = [twist.linear, twist.angular].map(<[f64; 3]>::from);
                    for (a, rate) in rates.into_iter().flatten().enumerate() {
                        if !rate.is_finite() {
                            return Err(SolveError::NoDerivatives);
                        }
                        compliance[(6 * i + a) * n + 6 * j + component] = rate;
                    }
                }
            }
        }
        Ok(())
    }

    fn stands_alone(&mut self, case: &Case, pushes: &[Push]) -> bool {
        let case = self.with_pushes(case, pushes);
        let options = Options { stability: true, ..self.options.clone() };
        let Ok(model) = Cosserat::new(self.robot, &case.loads, &options) else { return true };
        let found = model.solve(&case, self.last.as_ref(), &mut self.workspace);
        found.is_ok_and(|solution| !solution.diagnostics.is_unstable())
    }

    fn keep(&mut self) {
        self.kept = self.last.clone();
    }

    fn go_back(&mut self) {
        self.last = self.kept.clone();
    }

    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError> {
        let touching = pushes.iter().any(|push| push.wrench != Default::default());
        let case = self.with_pushes(case, pushes);
        let stability = self.asked.stability && !touching;
        let options = Options { stability, ..self.asked.clone() };
        let model = Cosserat::new(self.robot, &case.loads, &options)?;
        let mut solution = model.solve(&case, self.last.as_ref(), &mut self.workspace)?;
        if touching && self.asked.stability {
            solution.diagnostics.stability_absent = Some(NoStability::Touching);
        }
        Ok(solution)
    }
}
