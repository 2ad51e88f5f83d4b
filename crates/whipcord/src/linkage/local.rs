//! How a place moves with the commands and yields to a wrench, from the linear system of the equilibrium.
//!
//! The coordinates solve `r(q) = 0`, eq. (3), and with its tangent `H = ∂r/∂q`, eq. (5), the implicit function theorem gives
//!
//! ```text
//! δq = −H⁻¹ (Cᵢ δτᵢ − Jᵀ W)                                                           (11)
//! ```
//!
//! for the tension of a cable, `Cᵢ = ∂ℓᵢ/∂q`, and a dead wrench W on a place that moves by `J δq`.

use whipcord_numerics::{Pose, Twist, Vec3};

use super::chain::{Asked, Elimination, Pushed};
use super::motion::{self, Motion};
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::kinematics::Local;
use crate::shape::{Solution, Wrench};
use crate::statics::local::{Column, local_of};

impl Linkage {
    /// The answer, and how the place at an arc length in m moves and yields; from a neighbouring solution when given.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_at(
        &self,
        case: &Case,
        arc_length: f64,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Local), SolveError> {
        let solution = self.solve(case, warm_start, workspace)?;
        let local = self.local(arc_length, workspace)?;
        Ok((solution, local))
    }

    fn local(&self, arc_length: f64, workspace: &mut Workspace) -> Result<Local, SolveError> {
        let Workspace { scratch, loads, commands, tensions, meter, .. } = workspace;
        let (place, t) = match self.robot.disks().locate(arc_length) {
            // A disk is the end of the section before it.
            (k, 0.0) if k > 0 => (k - 1, 1.0),
            at => at,
        };
        let mut disks = vec![Pose::IDENTITY];
        for (section, q) in self.sections.iter().zip(&scratch.chain.q) {
            let end = motion::pose_at(&self.division, section.length, q, 1.0);
            disks.push(disks[disks.len() - 1] * end);
        }
        let (section, q) = (&self.sections[place], &scratch.chain.q[place]);
        let motion = Motion::up_to(&self.division, section.length, q, t);
        let to_section = disks[place].rotation.conjugate();
        let pushes: [Pushed; 6] = core::array::from_fn(|component| {
            let axis = to_section.rotate([Vec3::X, Vec3::Y, Vec3::Z][component % 3]);
            let wrench = match component {
                0..3 => Wrench { force: axis, moment: Vec3::ZERO },
                _ => Wrench { force: Vec3::ZERO, moment: axis },
            };
            Pushed { section: place, motion, wrench }
        });
        let task = self.task(loads, tensions, meter);
        let chain = &mut scratch.chain;
        chain.evaluate(&task);
        chain.linearise(&task);
        let how = Elimination { shift: 0.0, asked: Asked::Responses };
        chain.eliminate_with(&task, how, &pushes).ok_or(SolveError::NoDerivatives)?;
        let at = disks[place] * Pose { position: motion.end, ..Pose::IDENTITY };
        let cables = tensions.len();
        let column = |side: usize| {
            let mut twist = Twist::default();
            for (k, disk) in disks.iter().enumerate().take(place + 1) {
                let own = if k == place { &motion } else { chain.motion(k) };
                let (mut turn, mut shift) = (Vec3::ZERO, Vec3::ZERO);
                for (a, change) in chain.response(&task, side, k).iter().enumerate() {
                    turn += own.turn[a] * *change;
                    shift += own.shift[a] * *change;
                }
                let turn = disk.rotation.rotate(turn);
                let end = if k == place { at.position } else { disks[k + 1].position };
                twist.angular += turn;
                twist.linear += disk.rotation.rotate(shift) + turn.cross(at.position - end);
            }
            Column { twist, lengths: chain.lengths_by(&task, side) }
        };
        let by_tension: Vec<Column> = (0..cables).map(|cable| column(1 + cable)).collect();
        let by_wrench: Vec<Column> = (0..6).map(|i| column(1 + cables + i)).collect();
        let compliance = |i: usize| {
            let stiffness = self.robot.cables()[i].axial_stiffness;
            stiffness.map_or(0.0, |k| self.rest_lengths[i] / k)
        };
        let is_taut = |i: usize| tensions[i] > 0.0;
        let length = self.robot.backbone().length;
        local_of(commands, (is_taut, compliance), &by_tension, Ok(&by_wrench), length)
    }
}
