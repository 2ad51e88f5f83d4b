//! Friction against bending: what a step of actuation starts from, and what it leaves ([`crate::statics::plastic_steps`]).

use std::sync::{Arc, OnceLock};

use super::friction::{Answer, Friction};
use super::prepared::{Cosserat, Workspace};
use super::state::Node;
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::Case;
use crate::contact::RodSolves as _;
use crate::derivatives::{
    Cables, Derivatives, OpenStrands, Solved, Strands, Varying, plastic_left,
};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::grid::Grid;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::{Differentiated, PlasticRod};

impl Cosserat {
    /// Whether steps of actuation are taken one by one, each from the plastic curvature that the one before left. Beside friction of
    /// cables, whose memory belongs to a grid, all of them are taken on each grid instead.
    pub(crate) fn bends_in_steps(&self) -> bool {
        self.robot.has_bending_friction() && !self.has_friction()
    }

    /// The plastic curvature that a step of actuation left beside friction of cables, whose answer the workspace holds.
    pub(super) fn plastic_left(
        &self,
        grid: &Grid,
        Friction { nodes, .. }: &Friction,
        (case, answer): (&Case, &Answer),
        workspace: &Workspace,
    ) -> Result<PlasticCurvature, SolveError> {
        let Workspace { scratch, commands, friction: memory, .. } = workspace;
        let cables = nodes.cables();
        let strand = |k: usize, cable: usize| nodes.strand(k, cable);
        let strands = Strands::of_links(cables, nodes.count(), grid.len(), strand)
            .with_shares(nodes.shares_of_profile(grid, &answer.profile));
        let slopes = nodes.slopes(grid, memory.response.slopes());
        let varying = Varying { tensions: &answer.varying, strands: &strands, slopes: &slopes };
        let start =
            |node: &Node| Wrench { force: node.force, moment: node.rotation.rotate(node.moment) };
        let starts: Vec<Option<Wrench>> =
            answer.shape.nodes.iter().map(|node| Some(start(node))).collect();
        let left = plastic_left(&Solved {
            robot: &self.robot,
            case,
            cables: Cables::of(&self.layout),
            grid,
            loads: &scratch.applied,
            commands,
            tensions: &scratch.tensions,
            taut: &vec![true; cables],
            poses: &scratch.poses,
            base_wrench: scratch.base_wrench,
            starts: &starts,
            strains: scratch.trajectory.strains(),
            are_strains_met: false,
            history: &[],
            nodes: &grid.stations,
            sliding: None,
            open: Some(OpenStrands { strands: &strands, varying: Some(varying) }),
        });
        left.map_err(|fault| self.fault(fault, workspace))
    }

    /// The answer to a step without obstacles as a solve of its own, from the plastic curvature that was set where there is one.
    pub(super) fn solve_step(
        &self,
        step: &Case,
        near: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        if !self.bends_in_steps() {
            return self.solve(step, near, workspace);
        }
        self.start_meter(workspace);
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let taken = self.take_step(step, near, workspace, &mut solution);
        workspace.meter.checked(taken)?;
        Ok(solution)
    }
}

impl PlasticRod for Cosserat {
    const KIND: ModelKind = ModelKind::Cosserat;
    type Workspace = Workspace;
    type Derivatives = Derivatives;

    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn limits(&self) -> (&Cancel, Budget) {
        (&self.options.cancel, self.options.budget)
    }

    fn meter(workspace: &mut Workspace) -> &mut Meter {
        &mut workspace.meter
    }

    fn take_step(
        &self,
        step: &Case,
        from: Option<&Solution>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<PlasticCurvature, SolveError> {
        if !step.obstacles.is_empty() {
            let (answer, left) = self.take_step_among_obstacles(step, from, workspace)?;
            *solution = answer;
            solution.plastic_curvature = left.at_stations(self.layout.stations());
            return Ok(left);
        }
        let grid = self.solve_keeping_grid(step, from.into(), workspace, solution)?;
        let left = self.with_answer(step, &grid, &[], workspace, plastic_left);
        let left = left.map_err(|fault| self.fault(fault, workspace))?;
        solution.plastic_curvature = left.at_stations(self.layout.stations());
        Ok(left)
    }

    fn differentiate_step(
        &self,
        step: &Case,
        (from, history): (Option<&Solution>, &[PlasticCurvature]),
        parameters: &[Parameter],
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Differentiated<Derivatives>, SolveError> {
        if !step.obstacles.is_empty() {
            let asked = (history, parameters);
            let (answer, found) =
                self.differentiate_step_among_obstacles((step, from), asked, workspace)?;
            *solution = answer;
            solution.plastic_curvature = found.1.at_stations(self.layout.stations());
            return Ok(found);
        }
        let grid = self.solve_keeping_grid(step, from.into(), workspace, solution)?;
        let derivatives = self.derivatives(step, &grid, history, parameters, workspace)?;
        let (left, changes) = derivatives.plastic_left(&self.robot, &grid);
        solution.plastic_curvature = left.at_stations(self.layout.stations());
        Ok((derivatives, left, changes))
    }

    fn set_plastic(&mut self, left: PlasticCurvature) {
        self.grid.set_plastic(&left);
        for grid in Arc::make_mut(&mut self.finer).iter_mut().filter_map(OnceLock::get_mut) {
            grid.set_plastic(&left);
        }
        self.plastic = Some(left);
    }
}
