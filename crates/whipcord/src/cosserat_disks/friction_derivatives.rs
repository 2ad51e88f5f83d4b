//! Exact derivatives of an answer whose cables rub in their holes: every passage is a strand with a tension of its own, and the equations of
//! the holes ([`crate::statics::friction`]) say how these change.

use super::friction::put;
use super::layout::Mesh;
use super::node::Node;
use super::{CosseratDisks, Workspace};
use crate::case::Case;
use crate::contact::RodSolves as _;
use crate::derivatives::{
    Cables, Derivatives, NoDerivatives, SlidingAnswer, Solved, StraightCables,
};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::solution::Solution;
use crate::statics::friction::{Carried, Holes, Place, SubstepEnd};
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::Remembering;
use crate::warm_start::WarmStart;

impl CosseratDisks {
    /// Whether a cable rubs in its holes.
    pub(crate) const fn has_friction(&self) -> bool {
        self.holes.is_some()
    }

    /// The answers to all steps of a case of cables that rub, in order; those that are asked for, by their number from 0, with their
    /// derivatives.
    pub(crate) fn solve_steps_with_derivatives(
        &self,
        case: &Case,
        parameters: &[Parameter],
        asks: impl Fn(usize) -> bool,
        workspace: &mut Workspace,
        each: impl FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        if !case.obstacles.is_empty() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            return self.rub_with_derivatives((case, parameters), &asks, workspace, each);
        }
        let Some(holes) = &self.holes else { return Ok(()) };
        self.slide_with_derivatives(holes, case, parameters, asks, workspace, each)
    }

    /// The answer to the last step of a case, from the robot at rest on, with its derivatives.
    pub(super) fn solve_sliding_with_derivatives(
        &self,
        holes: &Holes,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        let mut last = None;
        let number = case.leading_steps().count() - 1;
        let is_last = |step: usize| step == number;
        self.slide_with_derivatives(holes, case, parameters, is_last, workspace, |answer| {
            last = Some(answer);
        })
        .map_err(|(_, error)| error)?;
        match last {
            Some((solution, Some(derivatives))) => Ok((solution, derivatives)),
            _ => Err(SolveError::NoDerivatives),
        }
    }

    /// The answers to all steps of a case in order, those that are asked for with their derivatives.
    fn slide_with_derivatives(
        &self,
        holes: &Holes,
        case: &Case,
        parameters: &[Parameter],
        asks: impl Fn(usize) -> bool,
        workspace: &mut Workspace,
        mut each: impl FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        let steps: Vec<Case> = case.leading_steps().collect();
        workspace.histories.clear();
        workspace.courses.clear();
        // What holes remember depends on the mesh, and so do its changes.
        let mut carrying: Vec<Remembering> = Vec::new();
        for n in 0..steps.len() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            workspace.keeps_trail = true;
            let mut solution = Solution::empty(ModelKind::CosseratDisks);
            let solved = self
                .solve_from(&steps[..=n], WarmStart::None, workspace, &mut solution)
                .and_then(|level| {
                    carrying.resize(carrying.len().max(level + 1), Remembering::default());
                    let mut differentiate = || {
                        let of_level = (level, &mut carrying[level]);
                        self.differentiate_sliding(holes, of_level, &steps, parameters, workspace)
                    };
                    asks(n).then(&mut differentiate).transpose()
                });
            workspace.keeps_trail = false;
            let derivatives = workspace.meter.checked(solved).map_err(|error| (n, error))?;
            each((solution, derivatives));
        }
        Ok(())
    }

    /// The derivatives of the answer that the workspace holds.
    fn differentiate_sliding(
        &self,
        holes: &Holes,
        (level, remembering): (usize, &mut Remembering),
        steps: &[Case],
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<Derivatives, SolveError> {
        let mut mesh = self.mesh(level)?;
        let trail =
            workspace.histories.get_mut(level).and_then(|walked| walked.history.trail.take());
        let Some(trail) = trail else { return Err(SolveError::NoDerivatives) };
        let plastic = workspace.histories[level].plastic.clone();
        let kept = parameters.len() + holes.of_cable.len();
        let mut bent_by = None;
        let found = remembering.go(&trail, kept, |bends, end, carried, place| {
            let case = steps.get(place.step).ok_or(SolveError::NoDerivatives)?;
            let before = place.step.checked_sub(1);
            if let Some(left) = before.filter(|_| bent_by != before).and_then(|n| plastic.get(n)) {
                self.frame.set_plastic(mesh.to_mut(), left);
                bent_by = before;
            }
            let asked = (case, parameters, bends.before(&self.robot, place.step)?);
            let at = (&*mesh, end, carried);
            let (derivatives, carried) =
                self.differentiate_end(holes, at, asked, place, workspace)?;
            if place.is_end_of_step && self.robot.has_bending_friction() {
                bends.note(place.step, derivatives.plastic_left(&self.robot, &mesh.grid).1);
            }
            Ok((derivatives, Some(carried)))
        });
        workspace.histories[level].history.trail = Some(trail);
        found
    }

    /// The derivatives at the end of a substep, and what goes on to the next.
    fn differentiate_end(
        &self,
        holes: &Holes,
        (mesh, end, carried): (&Mesh, &SubstepEnd<Vec<Node>>, Option<&[Carried]>),
        (case, parameters, history): (&Case, &[Parameter], &[PlasticCurvature]),
        place: Place,
        workspace: &mut Workspace,
    ) -> Result<(Derivatives, Vec<Carried>), SolveError> {
        let Workspace { scratch, commands, meter, .. } = workspace;
        let meter = &*meter;
        self.commands(case, commands)?;
        let problem = self.problem(mesh, (commands, meter), case)?;
        put(&problem, end, scratch).map_err(|_| SolveError::NoDerivatives)?;
        // Lengths before actuation hang on parameters alone.
        let is_known = self.rest_changes.know(parameters);
        let rest = (!is_known).then(|| self.frame().rest_mesh()).transpose()?;
        let of_rest = |mesh| self.frame().straight_spans(mesh).collect::<Vec<_>>();
        let rest = rest.as_ref().map(|mesh| (&mesh.grid, of_rest(mesh)));
        let mut spans: Vec<_> = self.frame().straight_spans(mesh).collect();
        let standing = &end.standing;
        for (straight, span) in spans.iter_mut().zip(&self.frame().spans) {
            straight.tensions = Some(&standing.tensions[span.first..][..span.passages.len()]);
        }
        let straight = StraightCables {
            spans: &spans,
            rest: rest.as_ref().map(|(grid, spans)| (*grid, &spans[..])),
        };
        let cables = standing.base.len();
        let order: Vec<usize> = (0..cables).collect();
        let strands = self.frame().strands(holes);
        let all: Vec<usize> = (0..=mesh.grid.len()).collect();
        let mut starts = Vec::new();
        scratch.chain.starts_into(self.frame(), mesh, &scratch.applied, &mut starts);
        let solved = Solved {
            robot: &self.robot,
            case,
            cables: Cables {
                order: &order,
                rest_lengths: &self.frame().rest_lengths,
                straight: Some(straight),
                rest_changes: Some(&*self.rest_changes),
            },
            grid: &mesh.grid,
            loads: &scratch.applied,
            commands: &standing.commands,
            tensions: &standing.base,
            taut: &vec![true; cables],
            poses: &scratch.poses,
            base_wrench: scratch.base_wrench,
            starts: &starts,
            strains: &[],
            are_strains_met: false,
            history,
            nodes: match place {
                // What friction against bending keeps changes at all of them.
                Place { is_end_of_step: true, .. } if self.robot.has_bending_friction() => &all,
                Place { is_last: true, .. } => &mesh.grid.stations,
                _ => &[],
            },
            open: None,
            sliding: Some(SlidingAnswer {
                holes,
                standing,
                carried,
                strands: &strands,
                varying: None,
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
