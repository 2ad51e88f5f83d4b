//! How a place moves with the commands and yields to a wrench, from the linear system of the equilibrium.
//!
//! The coordinates solve `r(q) = 0`, eq. (3), and with its tangent `H = ∂r/∂q`, eq. (5), the implicit function theorem gives
//!
//! ```text
//! δq = −H⁻¹ (Cᵢ δτᵢ − Jᵀ W)                                                           (11)
//! ```
//!
//! for the tension of a cable, `Cᵢ = ∂ℓᵢ/∂q`, and a dead wrench W on a place that moves by `J δq`.

use whipcord_numerics::Pose;

use super::places::Places;
use super::plastic_derivatives::Asked;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::derivatives::Place;
use crate::error::SolveError;
use crate::kinematics::Local;
use crate::refusal;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::local::{Column, local_of};

impl Linkage {
    /// The answer, and how the place at an arc length in m moves and yields; from a neighbouring solution when given.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Unsupported`] among obstacles, and
    /// [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_at(
        &self,
        case: &Case,
        arc_length: f64,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Local), SolveError> {
        refusal::derivatives_among_obstacles(self.kind, case)?;
        let at = [arc_length];
        if self.keeps_history() {
            let (solution, derivatives) =
                self.differentiate_last_step((case, &[]), &at, workspace)?;
            return Ok((solution, derivatives.at(Place::Station(0))?));
        }
        if let Some(rubbing) = &self.friction {
            let asked = Asked::new(&[], &at);
            let (solution, derivatives) =
                self.slide_with_derivatives(rubbing, (case, asked), workspace)?;
            return Ok((solution, derivatives.at(Place::Station(0))?));
        }
        let solution = self.solve(case, warm_start, workspace)?;
        let mut local = self.local(arc_length, workspace)?;
        let (commands, length) = (workspace.commands.iter(), self.robot.backbone().length);
        local.one_sided.cable = Command::are_about_to_change(commands, &solution.cables, length);
        Ok((solution, local))
    }

    fn local(&self, arc_length: f64, workspace: &mut Workspace) -> Result<Local, SolveError> {
        let Workspace { scratch, loads, commands, tensions, meter, .. } = workspace;
        let disks: Vec<Pose> = self.disks(&scratch.chain.q).collect();
        let places = Places::new(self, &scratch.chain.q, &disks, &[arc_length]);
        let task = self.task(loads, tensions, meter);
        let chain = &mut scratch.chain;
        chain.evaluate(&task);
        chain.linearise(&task);
        chain
            .eliminate_with_wrenches(&task, &places.unit_wrenches())
            .ok_or(SolveError::NoDerivatives)?;
        let cables = tensions.len();
        let mut twists = Vec::with_capacity(1);
        let mut column = |side: usize| {
            twists.clear();
            places.twists(chain, &task, side, &mut twists);
            Column { twist: twists[0], lengths: chain.lengths_by(&task, side) }
        };
        let by_tension: Vec<Column> = (0..cables).map(|cable| column(1 + cable)).collect();
        let by_wrench: Vec<Column> = (0..6).map(|i| column(1 + cables + i)).collect();
        let compliance = |i: usize| self.robot.cable_compliance(i, self.rest_lengths[i]);
        let is_taut = |i: usize| tensions[i] > 0.0;
        let length = self.robot.backbone().length;
        local_of(commands, (is_taut, compliance), &by_tension, Ok(&by_wrench), length)
    }
}
