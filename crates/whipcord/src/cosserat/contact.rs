//! Contact of the rod with obstacles: its response to contact forces.

use whipcord_numerics::{Pose, Vec3, equally_spaced};

use super::contact_response::{ContactResponse, Kept};
use super::model::{Cosserat, Workspace};
use crate::cancel::Cancel;
use crate::case::{Case, PointLoad};
use crate::contact::{self, Compliant, Push, Unobstructed};
use crate::error::SolveError;
use crate::robot::Robot;
use crate::shape::{NoStability, Shape, Solution};
use crate::statics::grid::Grid;
use crate::statics::options::{Options, StabilityAnalysis};

/// The backbone is watched at this many places from base to tip, besides the disks.
const WATCHED: usize = 80;

/// The rod among obstacles.
struct ContactAdapter<'a> {
    robot: &'a Robot,
    /// As the user wants the answer.
    options: &'a Options,
    watched: Vec<f64>,
    /// Those, and where the user wants the shape.
    stations: Vec<f64>,
    initial_lengths: Vec<f64>,
    force_scale: f64,
    /// The case that it last looked at, with the pushes among its loads.
    case: Case,
    warm: Option<Solution>,
    found: ContactResponse,
    kept: Kept,
}

impl Cosserat {
    /// The shape among the obstacles of a case: without them where the robot keeps clear of them.
    pub(super) fn solve_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        case.check(&self.robot)?;
        let watched = self.watched();
        let initial_lengths = self.initial_lengths();
        let mut free = FreeRod { model: self, workspace, watched, initial_lengths };
        match contact::solve_free(&mut free, &self.robot, case, warm_start)? {
            Some(solution) => Ok(solution),
            None => self.solve_in_contact(case, warm_start),
        }
    }

    /// The arc lengths at which the backbone is watched: those of the disks and some between.
    fn watched(&self) -> Vec<f64> {
        let length = self.robot.backbone().length;
        let mut watched = self.robot.disks().arc_lengths.clone();
        watched.extend(equally_spaced(0.0, length, WATCHED + 1));
        sorted(&mut watched, 1e-3 * length / WATCHED as f64);
        watched
    }

    /// Lengths of the cables before actuation in m.
    fn initial_lengths(&self) -> Vec<f64> {
        let mut initial_lengths = vec![0.0; self.layout.order.len()];
        for (&cable, &initial) in self.layout.order.iter().zip(&self.layout.rest_lengths) {
            initial_lengths[cable] = initial;
        }
        initial_lengths
    }

    fn solve_in_contact(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
    ) -> Result<Solution, SolveError> {
        let length = self.robot.backbone().length;
        let watched = self.watched();
        let mut stations = watched.clone();
        stations.extend_from_slice(self.stations());
        stations.sort_by(f64::total_cmp);
        stations.dedup();
        let at_base = self.grid.shooting.at(0, 0, 0).0.section.bending_stiffness();
        let mut adapter = ContactAdapter {
            robot: &self.robot,
            options: &self.options,
            watched,
            stations,
            initial_lengths: self.initial_lengths(),
            force_scale: at_base.column(0).x / (length * length),
            case: Case::default(),
            warm: None,
            found: ContactResponse::default(),
            kept: Kept::default(),
        };
        contact::solve(&mut adapter, &self.robot, case, warm_start)
    }
}

/// The rod without obstacles.
struct FreeRod<'a> {
    model: &'a Cosserat,
    workspace: &'a mut Workspace,
    watched: Vec<f64>,
    initial_lengths: Vec<f64>,
}

impl FreeRod<'_> {
    /// The centres of the watched cross-sections of the rod whose steps the workspace holds.
    fn centres(&self, grid: &Grid, centres: &mut Vec<Vec3>) {
        let end = self.model.robot.backbone().length;
        let arc_length = grid.steps.iter().map(|step| step.start).chain([end]).collect();
        let nodes = Shape { arc_length, poses: self.workspace.scratch.poses.clone() };
        centres.clear();
        centres.extend(self.watched.iter().map(|&s| nodes.at(s).position));
    }
}

impl Unobstructed for FreeRod<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.initial_lengths
    }

    fn solve(
        &mut self,
        case: &Case,
        from: Option<&Solution>,
        centres: &mut Vec<Vec3>,
    ) -> Result<Solution, SolveError> {
        let solved = self.model.solve_keeping_grid(case, from, self.workspace);
        let (solution, grid) = self.model.options.cancel.checked(solved)?;
        self.centres(&grid, centres);
        Ok(solution)
    }

    fn look(&mut self, case: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        self.model.solve_coarsely(case, self.workspace)?;
        self.centres(&self.model.grid, centres);
        Ok(())
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

/// The case with the pushes as point loads.
fn with_pushes(case: &Case, pushes: &[Push]) -> Case {
    let mut case = case.clone();
    let turn = case.loads.to_base(case.base.rotation).conjugate();
    case.loads.points.extend(pushes.iter().map(|push| PointLoad {
        at: push.arc_length,
        force: turn.rotate(push.wrench.force),
        moment: turn.rotate(push.wrench.moment),
        follower: false,
    }));
    case
}

impl Compliant for ContactAdapter<'_> {
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

    fn cancel(&self) -> &Cancel {
        &self.options.cancel
    }

    fn effort(&self) -> f64 {
        self.found.steps().max(self.watched.len()) as f64 / 100.0
    }

    fn refine(&mut self) -> Result<bool, SolveError> {
        self.found.refine(self.options.accuracy)
    }

    fn reset(&mut self) {
        self.found.reset();
    }

    fn start_from(&mut self, answer: &Solution) {
        self.found = ContactResponse::default();
        self.warm = Some(answer.clone());
    }

    fn consider(&mut self, case: &Case, pushes: &[Push]) -> Result<(), SolveError> {
        self.case = with_pushes(case, pushes);
        let places: Vec<f64> = pushes.iter().map(|push| push.arc_length).collect();
        let warm = self.warm.take();
        let at = (&self.stations[..], &places[..]);
        self.found.look(self.robot, self.options, &self.case, at, warm.as_ref())
    }

    fn pose(&self, arc_length: f64) -> Pose {
        self.found.pose(arc_length)
    }

    fn unsettled(&self) -> f64 {
        self.found.gap
    }

    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> Result<(), SolveError> {
        self.found.linearise(self.robot, &self.case)?;
        self.found.advance(changes, part);
        Ok(())
    }

    fn compliance(
        &mut self,
        pushes: &[Push],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) -> Result<(), SolveError> {
        self.found.linearise(self.robot, &self.case)?;
        self.found.compliance(pushes.iter().map(|push| push.arc_length), compliance, drift);
        let finite = compliance.iter().chain(&*drift).all(|value| value.is_finite());
        if finite { Ok(()) } else { Err(SolveError::NoDerivatives) }
    }

    fn stands_alone(&mut self) -> bool {
        self.found.stands()
    }

    fn keep(&mut self) {
        self.found.keep(&mut self.kept);
    }

    fn pose_before(&self, arc_length: f64) -> Pose {
        self.kept.pose(arc_length)
    }

    fn go_back(&mut self) {
        self.found.go_back(&self.kept);
    }

    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError> {
        let mut solution = self.found.solution(&self.case)?.ok_or(SolveError::NoDerivatives)?;
        let touching = pushes.iter().any(|push| push.wrench != Default::default());
        if !touching {
            let model = Cosserat::new(self.robot, &case.loads, self.options)?;
            return model.solve(case, Some(&solution), &mut Workspace::default());
        }
        let asked = self.options.stations.arc_lengths(self.robot);
        let shape = &mut solution.shape;
        let at = |&s: &f64| shape.poses[shape.arc_length.partition_point(|&there| there < s)];
        (shape.poses, shape.arc_length) = (asked.iter().map(at).collect(), asked);
        if self.options.stability != StabilityAnalysis::Off {
            solution.diagnostics.stability_absent = Some(NoStability::Touching);
        }
        Ok(solution)
    }
}
