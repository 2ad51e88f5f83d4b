//! The derivatives of an answer of a rod: what they consist of.

use std::sync::Arc;

use super::change::Places;
use super::column::Raw;
use super::elimination::Elimination;
use super::forward::Maps;
use super::linear::Linear;
use super::partials::Partial;
use super::sliding_holes::SlidingHoles;
use super::step_ends::StepEnds;
use super::strands::Strands;
use super::touching::Touching;
use crate::robot::RobotError;
use crate::section::Fault;
use crate::statics::command::Command;
use crate::statics::grid::Step;
use crate::statics::hold::{Critical, HeldCables};

/// The derivatives of one answer of a Cosserat rod, with continuous cables or with cables straight from hole to hole.
///
/// Motions and wrenches are in the base frame: a change of pose is the velocity of the station's
/// point and the angular velocity of its frame, `δR = φ̂ R`; a wrench acts at that point and does not
/// turn. So the two are work-conjugate, and under dead forces a compliance is symmetric. (A dead
/// *moment* has no potential for turns about more than one axis; follower loads have none at all.)
///
/// Cables that are slack stay slack: at the very load at which one goes slack the answer has one-sided derivatives,
/// and the derivatives are those of the side that the answer says.
///
/// ```
/// use whipcord::cosserat::{Cosserat, Options, Workspace};
/// use whipcord::derivatives::{Hold, Place};
/// use whipcord::{Backbone, Cable, Case, Disks, Loads, Material, Parameter, Robot, Routing, Section};
///
/// let material =
///     Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
/// let section = Some(Section::circle(0.003));
/// let backbone = Backbone { section, material, ..Backbone::new(0.18) };
/// let disks = Disks::equally_spaced(0.18, 10, 0.008);
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, disks, vec![cable])?;
///
/// let model = Cosserat::new(&robot, &Loads::default(), &Options::default())?;
/// let (solution, derivatives) = model.solve_with_derivatives(
///     &Case::with_tensions(&[3.0]),
///     None,
///     &[Parameter::YoungModulus],
///     &mut Workspace::default(),
/// )?;
/// // The bend is τ r L/EI: it grows with the tension as it is.
/// let jacobian = derivatives.actuation_jacobian(Place::Tip);
/// let bend = solution.disks.tip().rotation.log().norm();
/// assert!((jacobian[0].angular.norm() - bend / 3.0).abs() < 1e-9);
/// // A locked cable stiffens the robot.
/// let free = derivatives.compliance(Place::Tip, Hold::Tensions)?;
/// let locked = derivatives.compliance(Place::Tip, Hold::Lengths)?;
/// assert!(locked.at(0, 0) < free.at(0, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Derivatives {
    pub(super) places: Arc<Places>,
    pub(super) steps: Vec<Step>,
    pub(super) linear: Linear,
    pub(super) maps: Maps,
    pub(super) elimination: Elimination,
    pub(super) partials: Vec<Partial>,
    /// Grid place of each cable of the robot.
    pub(super) place_of: Vec<usize>,
    pub(super) commands: Vec<Command>,
    pub(super) strands: Strands,
    /// What a change of the tension of each strand does at constant other tensions; by grid places where no cable rubs.
    pub(super) by_tension: Vec<Raw>,
    pub(super) held: HeldCables,
    /// Where cables rub.
    pub(super) sliding: Option<Box<SlidingHoles>>,
    /// What each tension of 1 N adds to the length of its cable in m, and whether it is taut; by grid places.
    pub(super) cables: Vec<CableEnd>,
    pub(super) touching: Touching,
    /// Of an answer whose way was differentiated though no cable rubs: the derivatives of its motion from there on, for what is added to the
    /// robot as it stands.
    pub(super) moving_on: Option<Box<Self>>,
    /// With friction against bending.
    pub(super) ends: Option<StepEnds>,
    /// Length of the backbone in m.
    pub(super) length: f64,
    pub(super) are_cables_about_to_change: bool,
    pub(super) is_bending_about_to_change: bool,
}

/// A cable as what holds it has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct CableEnd {
    pub compliance: f64,
    pub is_taut: bool,
}

/// Why an answer has no derivatives.
#[derive(Clone, Debug)]
pub(crate) enum NoDerivatives {
    Fault(Fault),
    Parameter(RobotError),
    Critical,
}

impl From<Critical> for NoDerivatives {
    fn from(_: Critical) -> Self {
        Self::Critical
    }
}

impl From<Fault> for NoDerivatives {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}
