//! One arc between each two disks, in equilibrium with its cables and loads: the piecewise
//! constant-curvature model.
//!
//! `docs/theory/piecewise-constant-curvature.md` derives the equations.

use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::linkage::division::{Bend, Division, Energy, Joint};
use crate::robot::Robot;

pub use crate::linkage::{Linkage, Options, Workspace};

/// The whole section is one arc, as stiff as the backbone.
pub(crate) const ARC: Division = Division {
    first: 0.0,
    joints: &[Joint { stiffness: 1.0, link: 1.0 }],
    bend: Bend::Arc,
    energy: Energy::Coordinates,
};

/// The model of a robot: each section bends about two axes and twists, and does not stretch or shear.
///
/// ```
/// use whipcord::piecewise_constant_curvature::{Options, Workspace, build};
/// use whipcord::{Backbone, Cable, Case, Disks, Material, Robot, Routing, Section};
///
/// let material =
///     Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
/// let section = Some(Section::circle(0.003));
/// let backbone = Backbone { section, material, ..Backbone::new(0.18) };
/// let cable = Cable::new("pull", Routing::Helix { start_angle: 0.0, turns: 0.5, radius: 0.008 });
/// let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
/// let model = build(&robot, &Options::default())?;
/// let solution = model.solve(&Case::with_tensions(&[3.0]), None, &mut Workspace::default())?;
/// assert!(solution.diagnostics.residual < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::Missing`] when the robot's stiffness is not given, and [`SolveError::Unsupported`] for cables with friction or
/// are anchored between two disks, and for strains that are coupled.
pub fn build(robot: &Robot, options: &Options) -> Result<Linkage, SolveError> {
    Linkage::new(robot, ModelKind::PiecewiseConstantCurvature, ARC, options.clone())
}
