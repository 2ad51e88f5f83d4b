//! The sections in equilibrium with tensions and loads: a chain with coordinates for the bends of each section, where the strain
//! energy decides on the shape, cables slide freely from section to section, and the stiffness is given.

use super::options::{Chord, Options};
use super::section;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::linkage::division::{Bend, Division, Energy, Joint};
use crate::linkage::{self, Linkage};
use crate::robot::{Robot, Stiffness};

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
    Ok(robot.with_parts(backbone, robot.disks().clone(), robot.cables().to_vec())?)
}
