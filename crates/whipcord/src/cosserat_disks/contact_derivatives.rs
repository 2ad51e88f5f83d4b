//! The derivatives of the rod where it stands under contact forces, and at the equilibria on the way there.

use whipcord_numerics::Vec3;

use super::chain::Chain;
use super::contact_mesh::ContactMesh;
use super::contact_response::{ContactResponse, Kept};
use super::loaded_span::Gap;
use super::node::Node;
use crate::case::Case;
use crate::contact::{ContactRod as _, NotedEnd, RodResponse};
use crate::derivatives::{
    Cables, ContactGain, Derivatives, Motion, NoDerivatives, OpenStrands, SlidingAnswer, Solved,
    StepGap, StraightCables, Strands, plastic_left,
};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::section::BodyWrench;
use crate::shape::Wrench;
use crate::statics::friction::Holes;
use crate::statics::plastic_curvature::PlasticCurvature;

impl ContactResponse {
    /// The derivatives where it stands, at these nodes and at the disks.
    pub(super) fn derivatives(
        &self,
        contact_mesh: &ContactMesh,
        of: (&Robot, &Case, &[PlasticCurvature]),
        at: (&[bool], &[usize]),
        parameters: &[Parameter],
        end: Option<&NotedEnd<'_, Kept>>,
    ) -> Result<Derivatives, SolveError> {
        let found = self.with_answer(contact_mesh, of, at, parameters, end, |solved| {
            Derivatives::of(solved, parameters)
        })?;
        found.map_err(|error| match error {
            NoDerivatives::Parameter(error) => error.into(),
            // The sections of a rod without cables have no equilibrium to miss.
            NoDerivatives::Critical | NoDerivatives::Fault(_) => SolveError::NoDerivatives,
        })
    }

    /// The plastic curvature that it leaves where it stands.
    pub(super) fn plastic_left_there(
        &self,
        robot: &Robot,
        case: &Case,
    ) -> Result<PlasticCurvature, SolveError> {
        let contact_mesh = self.contact_mesh.as_ref().ok_or(SolveError::NoDerivatives)?;
        let (taut, nodes) = (self.taut(contact_mesh), contact_mesh.asked_nodes());
        let (of, at) = ((robot, case, &[][..]), (&taut[..], &nodes[..]));
        let left = self.with_answer(contact_mesh, of, at, &[], None, plastic_left)?;
        // The sections of a rod without cables have no equilibrium to miss.
        left.map_err(|_| SolveError::NoDerivatives)
    }

    /// Where it stands, as it is gone over once more, for derivatives by these parameters; `history` is how the plastic curvature
    /// before changes with each.
    fn with_answer<T>(
        &self,
        contact_mesh: &ContactMesh,
        (robot, case, history): (&Robot, &Case, &[PlasticCurvature]),
        (taut, nodes): (&[bool], &[usize]),
        parameters: &[Parameter],
        end: Option<&NotedEnd<'_, Kept>>,
        act: impl FnOnce(&Solved<'_>) -> T,
    ) -> Result<T, SolveError> {
        let ContactMesh { model, mesh, .. } = contact_mesh;
        let (frame, chain) = (model.frame(), &self.chain);
        let (commands, loads) = (self.workspace.commands(), self.workspace.loads());
        let order: Vec<usize> = (0..taut.len()).collect();
        // Lengths before actuation hang on parameters alone.
        let rest = (!parameters.is_empty()).then(|| frame.rest_mesh()).transpose()?;
        let rest =
            rest.as_ref().map(|mesh| (&mesh.grid, frame.straight_spans(mesh).collect::<Vec<_>>()));
        let mut spans: Vec<_> = frame.straight_spans(mesh).collect();
        let rubbing = model.holes.as_ref().map(|holes| frame.strands(holes));
        if rubbing.is_some() {
            for (straight, span) in spans.iter_mut().zip(&frame.spans) {
                let range = span.first..span.first + span.passages.len();
                straight.tensions = Some(&chain.pulled[range]);
            }
        }
        let straight = StraightCables {
            spans: &spans,
            rest: rest.as_ref().map(|(grid, spans)| (*grid, &spans[..])),
        };
        let gain = |compliance: &[f64]| match end {
            Some(end) => end.noted.holding.gain(compliance),
            None => Ok(ContactGain::default()),
        };
        // On a way where nothing but obstacles rub every cable is one passage.
        let whole = end.filter(|_| rubbing.is_none()).map(|_| {
            let cables = frame.rest_lengths.iter().copied().enumerate();
            let holes = Holes::of_whole_cables(robot, cables, frame.compliance(mesh));
            (holes, Strands::of_cables(order.len()))
        });
        let holes = match &whole {
            Some((holes, strands)) => Some((holes, strands)),
            None => model.holes.as_ref().zip(rubbing.as_ref()),
        };
        let sliding = holes.zip(end).map(|((holes, strands), end)| SlidingAnswer {
            holes,
            standing: end.standing,
            carried: end.carried,
            strands,
            varying: None,
            on_way: Some(end.on_way(|s| contact_mesh.node(s), &gain)),
        });
        let open = rubbing.as_ref().filter(|_| end.is_none());
        let base = chain.nodes[0];
        let mut starts = Vec::new();
        chain.starts_into(frame, mesh, loads, &mut starts);
        let solved = Solved {
            robot,
            case,
            cables: Cables {
                order: &order,
                rest_lengths: &frame.rest_lengths,
                straight: Some(straight),
                rest_changes: None,
            },
            grid: &mesh.grid,
            loads,
            commands,
            tensions: if rubbing.is_some() { self.holes.at_base() } else { &chain.tensions },
            taut,
            poses: &self.shape.poses,
            base_wrench: Wrench { force: loads.base_force() + base.force, moment: base.moment },
            starts: &starts,
            strains: &[],
            are_strains_met: false,
            history,
            nodes,
            sliding,
            open: open.map(|strands| OpenStrands { strands, varying: None }),
        };
        Ok(act(&solved))
    }

    pub(super) fn linearised(
        &self,
        contact_mesh: &ContactMesh,
        taut: Vec<bool>,
        robot: &Robot,
        case: &Case,
    ) -> Result<RodResponse, SolveError> {
        let mut nodes: Vec<usize> =
            contact_mesh.pushes.iter().map(|&at| contact_mesh.node(at)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let derivatives =
            self.derivatives(contact_mesh, (robot, case, &[]), (&taut, &nodes), &[], None)?;
        if contact_mesh.model.has_friction() {
            let (gaps, unbalanced) = self.gaps();
            let closing = derivatives.open_closing(&gaps, &unbalanced);
            return Ok(RodResponse::rubbing(derivatives, closing));
        }
        let closing = self.closing(&derivatives, &taut);
        Ok(RodResponse::new(derivatives, taut, closing))
    }

    /// How the spans end beyond the disks that they should meet, and what is left to act on these.
    fn gaps(&self) -> (Vec<StepGap>, Vec<Wrench>) {
        let chain = &self.chain;
        let ends = chain.gaps.iter().zip(chain.nodes.windows(2));
        let gap = |(gap, nodes): (&Gap, &[Node])| {
            StepGap::new(gap.change, nodes[1].rotation, nodes[1].moment)
        };
        let lacks = chain.gaps.iter().zip(&chain.nodes).map(|(gap, node)| {
            let BodyWrench { linear, angular } = gap.residual;
            let to_base = |x: Vec3| node.rotation.rotate(x);
            Wrench { force: to_base(linear), moment: to_base(angular) }
        });
        (ends.map(gap).collect(), lacks.collect())
    }

    /// Newton's step where it stands while the wrenches stay as they are.
    pub(super) fn closing(&self, derivatives: &Derivatives, taut: &[bool]) -> Motion {
        let Chain { tensions, lengths, .. } = &self.chain;
        let commands = self.workspace.commands().iter().enumerate();
        let slackness: Vec<f64> =
            commands.map(|(i, command)| command.slackness(tensions[i], lengths[i])).collect();
        let (gaps, unbalanced) = self.gaps();
        derivatives.closing(&gaps, &unbalanced, tensions, taut, &slackness)
    }

    /// The derivatives at an equilibrium that was noted.
    pub(super) fn differentiate_there(
        &mut self,
        robot: &Robot,
        end: &NotedEnd<'_, Kept>,
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError> {
        self.go_back(&end.noted.state);
        let contact_mesh = self.contact_mesh.clone().ok_or(SolveError::NoDerivatives)?;
        if contact_mesh.model.has_friction() {
            self.holes.put(end.standing);
        }
        contact_mesh.model.accept(end.case, &contact_mesh.mesh, &mut self.workspace)?;
        self.looked(&contact_mesh, false, None)?;
        let taut = self.taut(&contact_mesh);
        let mut asked = contact_mesh.asked_nodes();
        asked.extend(end.stations.iter().flat_map(|&s| self.shape.ends_beside(s)));
        asked.sort_unstable();
        asked.dedup();
        let (at, of) = ((&taut[..], &asked[..]), (robot, end.case, end.history));
        self.derivatives(&contact_mesh, of, at, parameters, Some(end))
    }
}
