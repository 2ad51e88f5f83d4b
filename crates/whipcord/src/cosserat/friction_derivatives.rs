//! Exact derivatives of an answer whose cables rub along their curves: every node of [`super::tension_nodes`] is a strand, and the equations of
//! the holes ([`crate::statics::friction`]) say how their tensions change.

use core::mem::take;

use super::friction::{Answer, Friction, FrictionRod, FrictionWorkspace, base_wrench};
use super::prepared::{Cosserat, Workspace};
use super::scratch::Scratch;
use super::state::{Node, State};
use crate::case::Case;
use crate::contact::RodSolves as _;
use crate::derivatives::{
    Cables, Derivatives, NoDerivatives, SlidingAnswer, Solved, Strands, Varying,
};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::friction::{Carried, PassageResponse as _, Passages, Place, SubstepEnd};
use crate::statics::grid::Grid;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::Remembering;

impl Cosserat {
    /// The answer to the last step of a case, from the robot at rest on, with its derivatives.
    pub(super) fn solve_sliding_with_derivatives(
        &self,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        let mut last = None;
        let number = case.leading_steps().count() - 1;
        let is_last = |step: usize| step == number;
        self.slide_with_derivatives(case, parameters, is_last, workspace, |answer| {
            last = Some(answer);
        })
        .map_err(|(_, error)| error)?;
        match last {
            Some((solution, Some(derivatives))) => Ok((solution, derivatives)),
            _ => Err(SolveError::NoDerivatives),
        }
    }

    /// The answers to all steps of a case of cables that rub, in order; those that are asked for, by their number from 0, with their
    /// derivatives.
    pub(crate) fn slide_with_derivatives(
        &self,
        case: &Case,
        parameters: &[Parameter],
        asks: impl Fn(usize) -> bool,
        workspace: &mut Workspace,
        mut each: impl FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        if !case.obstacles.is_empty() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            return self.rub_with_derivatives((case, parameters), &asks, workspace, each);
        }
        let steps: Vec<Case> = case.leading_steps().collect();
        // What is remembered depends on the grid, and so do its changes.
        let mut carrying: Vec<Remembering> = Vec::new();
        for n in 0..steps.len() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            workspace.friction.keeps_trail = true;
            let mut solution = Solution::empty(ModelKind::Cosserat);
            let solved = self
                .solve_with_friction(&steps[..=n], n == 0, workspace, &mut solution)
                .and_then(|()| {
                    let level = workspace.progress.level;
                    carrying.resize(carrying.len().max(level + 1), Remembering::default());
                    let of_level = (level, &mut carrying[level]);
                    match asks(n) {
                        true => self
                            .differentiate_trail(of_level, &steps, parameters, workspace)
                            .map(Some),
                        false => Ok(None),
                    }
                });
            workspace.friction.keeps_trail = false;
            let derivatives = workspace.meter.checked(solved).map_err(|error| (n, error))?;
            each((solution, derivatives));
        }
        Ok(())
    }

    /// The derivatives of the answer that the workspace holds.
    fn differentiate_trail(
        &self,
        (level, remembering): (usize, &mut Remembering),
        steps: &[Case],
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<Derivatives, SolveError> {
        let mut grid = match self.options.accuracy {
            crate::statics::options::Accuracy::Steps(_) => std::borrow::Cow::Borrowed(&self.grid),
            crate::statics::options::Accuracy::Tolerance(_) => self.grid(level)?,
        };
        let friction = self.friction_on(&grid);
        let walked = workspace.friction.levels.get_mut(level);
        let Some((trail, answers)) = walked
            .and_then(|walked| Some((walked.history.trail.take()?, take(&mut walked.answers))))
        else {
            return Err(SolveError::NoDerivatives);
        };
        let plastic = workspace.friction.levels[level].plastic.clone();
        let kept = parameters.len() + friction.holes.of_cable.len();
        let mut bent_by = None;
        let found = remembering.go(&trail, kept, |bends, end, carried, place| {
            let (Some(case), Some(answer)) = (steps.get(place.step), answers.get(place.step))
            else {
                return Err(SolveError::NoDerivatives);
            };
            let before = place.step.checked_sub(1);
            if let Some(left) = before.filter(|_| bent_by != before).and_then(|n| plastic.get(n)) {
                grid.to_mut().set_plastic(left);
                bent_by = before;
            }
            let asked = (case, parameters, bends.before(&self.robot, place.step)?);
            let at = (&*grid, &friction, answer);
            let (derivatives, carried) =
                self.differentiate_end(at, (end, carried), asked, place, workspace)?;
            if place.is_end_of_step && self.robot.has_bending_friction() {
                bends.note(place.step, derivatives.plastic_left(&self.robot, &grid).1);
            }
            Ok((derivatives, Some(carried)))
        });
        if let Some(walked) = workspace.friction.levels.get_mut(level) {
            (walked.history.trail, walked.answers) = (Some(trail), answers);
        }
        found
    }

    /// The derivatives at the end of a substep, and what goes on to the next.
    fn differentiate_end(
        &self,
        (grid, friction, answer): (&Grid, &Friction, &Answer),
        (end, carried): (&SubstepEnd<State>, Option<&[Carried]>),
        (case, parameters, history): (&Case, &[Parameter], &[PlasticCurvature]),
        place: Place,
        workspace: &mut Workspace,
    ) -> Result<(Derivatives, Vec<Carried>), SolveError> {
        self.accept(case, workspace)?;
        let Workspace { scratch, commands, meter, friction: memory, .. } = &mut *workspace;
        let FrictionWorkspace { response, .. } = memory;
        scratch.applied.gather(grid, &case.loads, case.base.rotation);
        let problem = self.problem(grid, case, (commands, &*meter));
        let standing = &end.standing;
        let mut at = Passages::default();
        let mut rod = FrictionRod::new(&problem, (friction, &answer.profile), scratch, response);
        rod.set_shape(&end.shape);
        let measured = rod.measure(&standing.tensions, &mut at);
        let varying = take(&mut scratch.chain.varying);
        measured.map_err(|_| SolveError::NoDerivatives)?;
        let Scratch { chain, poses, .. } = &mut *scratch;
        chain.poses(poses);
        scratch.base_wrench = base_wrench(scratch);
        let nodes = &friction.nodes;
        // Within a step the profile is that of its end.
        let shares = match place.is_end_of_step {
            true => nodes.shares(grid, &standing.tensions, &answer.slip_states),
            false => nodes.shares_of_profile(grid, &answer.profile),
        };
        let cables = nodes.cables();
        let strands =
            Strands::of_links(cables, nodes.count(), grid.len(), |k, cable| nodes.strand(k, cable));
        let strands = strands.with_shares(shares);
        let slopes = nodes.slopes(grid, response.slopes());
        let start =
            |node: &Node| Wrench { force: node.force, moment: node.rotation.rotate(node.moment) };
        let starts: Vec<Option<Wrench>> =
            end.shape.nodes.iter().map(|node| Some(start(node))).collect();
        let varying = Varying { tensions: &varying, strands: &strands, slopes: &slopes };
        let solved = Solved {
            robot: &self.robot,
            case,
            cables: Cables::of(&self.layout),
            grid,
            loads: &scratch.applied,
            commands: &standing.commands,
            tensions: &standing.base,
            taut: &vec![true; cables],
            poses: &scratch.poses,
            base_wrench: scratch.base_wrench,
            starts: &starts,
            strains: scratch.trajectory.strains(),
            are_strains_met: false,
            history,
            nodes: &grid.stations,
            open: None,
            sliding: Some(SlidingAnswer {
                holes: &friction.holes,
                standing,
                carried,
                strands: &strands,
                varying: Some(varying),
                on_way: None,
            }),
        };
        match Derivatives::of(&solved, parameters) {
            Ok(derivatives) => {
                let carried = derivatives.carried();
                Ok((derivatives, carried))
            }
            Err(NoDerivatives::Parameter(error)) => Err(error.into()),
            Err(NoDerivatives::Critical | NoDerivatives::Fault(_)) => {
                Err(SolveError::NoDerivatives)
            }
        }
    }
}
