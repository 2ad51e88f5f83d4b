//! The derivatives of the rod where it stands under contact forces, and at the equilibria on the way there.

use std::sync::Arc;

use super::contact_grid::ContactGrid;
use super::contact_response::{ContactResponse, Kept};
use super::friction::compliance;

use super::prepared::Workspace;
use super::state::{Node, State};
use crate::case::Case;
use crate::contact::{ContactRod as _, NotedEnd};
use crate::derivatives::{
    Cables, ContactGain, Derivatives, NoDerivatives, OpenStrands, SlidingAnswer, Solved, Strands,
    Varying, plastic_left,
};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::section::Fault;
use crate::shape::Wrench;
use crate::statics::friction::{Carried, Holes};
use crate::statics::outcome::Failure;
use crate::statics::plastic_curvature::PlasticCurvature;

impl ContactResponse {
    /// The derivatives where it stands.
    pub(super) fn derivatives(
        &self,
        contact_grid: &ContactGrid,
        of: (&Robot, &Case, &[PlasticCurvature]),
        taut: &[bool],
        parameters: &[Parameter],
        end: Option<(&NotedEnd<'_, Kept>, Option<&[Carried]>)>,
    ) -> Result<Derivatives, SolveError> {
        let found = self
            .with_answer(contact_grid, of, taut, end, |solved| Derivatives::of(solved, parameters));
        found.map_err(|error| match error {
            NoDerivatives::Fault(fault) => self.fault(contact_grid, fault),
            NoDerivatives::Parameter(error) => error.into(),
            NoDerivatives::Critical => SolveError::NoDerivatives,
        })
    }

    /// The plastic curvature that it leaves where it stands.
    pub(super) fn plastic_left_there(
        &self,
        robot: &Robot,
        case: &Case,
    ) -> Result<PlasticCurvature, SolveError> {
        let contact_grid = self.contact_grid.as_ref().ok_or(SolveError::NoDerivatives)?;
        let taut = self.taut(contact_grid);
        let of = (robot, case, &[][..]);
        let left = self.with_answer(contact_grid, of, &taut, None, plastic_left);
        left.map_err(|fault| self.fault(contact_grid, fault))
    }

    /// A section without equilibrium where it stands.
    fn fault(&self, ContactGrid { model, .. }: &ContactGrid, fault: Fault) -> SolveError {
        let failure = Failure::of_section(fault, &self.chain.state.tensions, 1.0);
        model.explain(failure, &self.workspace.commands)
    }

    /// Where it stands, as it is gone over once more; `history` is how the plastic curvature before changes with each parameter.
    fn with_answer<T>(
        &self,
        contact_grid: &ContactGrid,
        (robot, case, history): (&Robot, &Case, &[PlasticCurvature]),
        taut: &[bool],
        end: Option<(&NotedEnd<'_, Kept>, Option<&[Carried]>)>,
        act: impl FnOnce(&Solved<'_>) -> T,
    ) -> T {
        let ContactGrid { model, grid, .. } = contact_grid;
        let Workspace { scratch, commands, .. } = &self.workspace;
        let State { nodes, tensions, .. } = &self.chain.state;
        let start =
            |node: &Node| Wrench { force: node.force, moment: node.rotation.rotate(node.moment) };
        let starts: Vec<Wrench> = nodes.iter().map(start).collect();
        let strands = contact_grid.friction.as_ref().map(|friction| {
            let nodes = &friction.nodes;
            let strand = |k: usize, cable: usize| nodes.strand(k, cable);
            let links = Strands::of_links(nodes.cables(), nodes.count(), grid.len(), strand);
            let strands = links.with_shares(nodes.shares_of_profile(grid, &contact_grid.profile));
            (strands, nodes.slopes(grid, self.response.slopes()))
        });
        let gain = |compliance: &[f64]| match end {
            Some((end, _)) => end.noted.holding.gain(compliance),
            None => Ok(ContactGain::default()),
        };
        // On a way where nothing but obstacles rub every cable is one passage.
        let whole = end.filter(|_| strands.is_none()).map(|_| {
            let Cables { order, rest_lengths, .. } = Cables::of(&model.layout);
            let cables = order.iter().copied().zip(rest_lengths.iter().copied());
            let holes = Holes::of_whole_cables(robot, cables, compliance(robot, grid));
            (holes, Strands::of_cables(order.len()))
        });
        let holes = match (&strands, &contact_grid.friction, &whole) {
            (Some((strands, slopes)), Some(friction), _) => {
                let varying = Varying { tensions: &self.chain.varying, strands, slopes };
                Some((&friction.holes, strands, Some(varying)))
            }
            (.., Some((holes, strands))) => Some((holes, strands, None)),
            _ => None,
        };
        let (sliding, open) = match (holes, end) {
            (Some((holes, strands, varying)), Some((end, carried))) => {
                let on_way = Some(end.on_way(|s| contact_grid.node(s), &gain));
                let standing = end.standing;
                let of = SlidingAnswer { holes, standing, carried, strands, varying, on_way };
                (Some(of), None)
            }
            (Some((_, strands, varying)), None) => (None, Some(OpenStrands { strands, varying })),
            (None, _) => (None, None),
        };
        let known: Vec<Option<Wrench>> = starts.iter().copied().map(Some).collect();
        let base_force = scratch.applied.base_force() + starts[0].force;
        let solved = Solved {
            robot,
            case,
            cables: Cables::of(&model.layout),
            grid,
            loads: &scratch.applied,
            commands,
            tensions,
            taut,
            poses: &self.shape.poses,
            base_wrench: Wrench { force: base_force, ..starts[0] },
            starts: &known,
            strains: self.trajectory.strains(),
            are_strains_met: strands.is_none(),
            history,
            nodes: &grid.stations,
            sliding,
            open,
        };
        act(&solved)
    }

    /// The derivatives at an equilibrium that was noted.
    pub(super) fn differentiate_there(
        &mut self,
        robot: &Robot,
        end: &NotedEnd<'_, Kept>,
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError> {
        self.go_back(&end.noted.state);
        let contact_grid = self.contact_grid.clone().ok_or(SolveError::NoDerivatives)?;
        if contact_grid.friction.is_some() {
            self.holes.put(end.standing);
        }
        let ContactGrid { model, grid, stations, pushes, halvings, .. } = &*contact_grid;
        // On the grid that it was noted on, which those after it may be finer than.
        self.refinement.halvings = *halvings;
        self.look(robot, &model.options, end.case, (stations, pushes), None)?;
        let regridded = end.before.and_then(|before| {
            let before = before.contact_grid.as_ref()?;
            let (old, new) = (before.friction.as_ref()?, contact_grid.friction.as_ref()?);
            if Arc::ptr_eq(before, &contact_grid) {
                return None;
            }
            let on_grid = |carried: &Carried| {
                let from = (&old.nodes, &before.grid);
                let beyond = match carried.beyond.is_empty() {
                    true => Vec::new(),
                    false => new.nodes.carried_starts(grid, from, &carried.beyond),
                };
                Carried { beyond, ..carried.clone() }
            };
            Some(end.carried?.iter().map(on_grid).collect::<Vec<_>>())
        });
        let taut = match contact_grid.friction {
            Some(_) => vec![true; end.standing.base.len()],
            None => self.taut(&contact_grid),
        };
        let of_end = Some((end, regridded.as_deref().or(end.carried)));
        let of = (robot, end.case, end.history);
        self.derivatives(&contact_grid, of, &taut, parameters, of_end)
    }
}
