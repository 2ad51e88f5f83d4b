//! The sections in equilibrium with tensions and loads: a chain with coordinates for the bends of each section, where the strain
//! energy decides on the shape, cables slide freely from section to section, and the stiffness is given.

use super::options::{Chord, Options};
use super::section;
use super::{FourBar, Workspace};
use crate::case::{Actuation, Case};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::linkage::division::{Bend, Division, Energy, Joint};
use crate::linkage::{self, Linkage};
use crate::refusal;
use crate::robot::{Robot, Stiffness};
use crate::shape::{Solution, Wrench};
use crate::statics::path::branches::{BranchOptions, Branches};

/// One arc from disk to disk, whose energy is that of eqs. (5) and (13).
const fn division(chord: Chord) -> Division {
    Division {
        first: 0.0,
        joints: &[Joint { stiffness: 1.0, link: 1.0 }],
        bend: match chord {
            Chord::Bisector => Bend::Chord,
            Chord::Arc => Bend::Arc,
        },
        energy: Energy::RotationVector,
    }
}

/// Whether the stiffness of a robot is given, and not only its ratios.
pub(super) fn knows_stiffness(robot: &Robot) -> Result<bool, SolveError> {
    Ok(section::modulus(robot).is_some() && section::reference_stiffness(robot)?.is_some())
}

/// The chain of a robot that the model takes with these options, where the strain energy decides on the shape. A stiffness that
/// is not given is assumed: lengths and obstacles make the same shape with any.
pub(super) fn chain(robot: &Robot, options: &Options) -> Result<Option<Linkage>, SolveError> {
    if !options.has_energy() {
        return Ok(None);
    }
    let linkage_options = linkage::Options {
        stations: options.stations.clone(),
        actuation: options.actuation,
        stability: options.stability,
        budget: options.budget,
        cancel: options.cancel.clone(),
        residual: options.residual,
    };
    let division = division(options.chord);
    if knows_stiffness(robot)? {
        return Linkage::new(robot, ModelKind::FourBar, division, linkage_options).map(Some);
    }
    let assumed = with_assumed_stiffness(robot)?;
    let chain = Linkage::new(&assumed, ModelKind::FourBar, division, linkage_options)?;
    Ok(Some(chain.without_forces()))
}

/// The robot with a modulus of 1 GPa, or without a section with a bending stiffness of 1 N·m².
fn with_assumed_stiffness(robot: &Robot) -> Result<Robot, SolveError> {
    let mut backbone = robot.backbone().clone();
    let poisson_ratio = section::poisson_ratio(robot)?;
    backbone.material.poisson_ratio = Some(poisson_ratio);
    backbone.material.shear_modulus = None;
    match backbone.section {
        Some(_) => backbone.material.young_modulus = Some(1e9),
        None => {
            let torsion = 1.0 / (1.0 + poisson_ratio);
            let unused = 1.0;
            backbone.stiffness = Some(Stiffness::diagonal([unused; 2], unused, [1.0; 2], torsion));
        }
    }
    Ok(Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec())?)
}

impl FourBar {
    /// Whether the answer to a case is an equilibrium of given forces, and not only of given lengths.
    pub(super) fn is_under_forces(&self, case: &Case) -> bool {
        let is_pulled = || match self.options.actuation {
            Actuation::Tension => true,
            Actuation::Shortening => false,
            Actuation::Natural => case.commands.iter().any(|c| c.shortening.is_none()),
        };
        let is_elastic = || self.robot.cables().iter().any(|c| c.axial_stiffness.is_some());
        !case.loads.is_none() || is_pulled() || is_elastic()
    }

    /// The chain in equilibrium, where the model knows the forces, and its memory.
    pub(crate) fn chain<'a>(
        &'a self,
        workspace: &'a mut Workspace,
    ) -> Option<(&'a Linkage, &'a mut linkage::Workspace)> {
        let chain = self.chain.as_ref().filter(|chain| chain.knows_forces());
        chain.map(|chain| (chain, &mut workspace.chain))
    }

    /// All equilibria under the load of a case, as [`Linkage::branches`] finds them.
    ///
    /// # Errors
    /// As [`Linkage::branches`]; [`SolveError::Unsupported`] where the model knows no forces.
    pub fn branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        match self.chain(workspace) {
            Some((chain, memory)) => chain.branches(case, options, memory),
            None => Err(refusal::branches(ModelKind::FourBar)),
        }
    }

    /// Completes an answer of given lengths by what the strain energy says of it: nothing but the cables loads the base, and
    /// whether it is stable.
    pub(super) fn judge(&self, case: &Case, workspace: &mut Workspace, solution: &mut Solution) {
        if let Some((chain, memory)) = self.chain(workspace) {
            let verdict = chain.judge(case, solution, memory);
            let diagnostics = core::mem::take(&mut solution.diagnostics);
            solution.diagnostics = diagnostics.with_stability(verdict);
            solution.base_wrench = Some(Wrench::default());
        }
    }
}
