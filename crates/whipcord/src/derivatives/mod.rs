//! Exact derivatives of an answer (see `docs/theory/derivatives.md`).
//!
//! The answer solves discrete equations; the implicit function theorem gives its derivative from
//! their linearisation. From the inside out: under loads `replay` goes over the steps once more and
//! linearises every stage, and `forward` combines the stages of a step for several columns at a time
//! (`lanes`); without load the sections of the `quadrature` do, through the steps of `magnus`; `linear`
//! is the choice between them. `elimination` solves the linear problem between base and tip; `partials`
//! says where a parameter enters, with `mass_change` and `spread_change`; `touching` adds what the contacts of an answer push; `adjoint` is the way back through a step and `backward` all of it. `columns` puts together
//! what one source changes, `change` is what comes out, `at_place` what is said of one place. Where cables run straight
//! from disk to disk, `spans` makes one map of the steps between two disks and of the cables. `coordinates` has the same of
//! models that have generalised coordinates for a rod, from their `linear_system`.
//!
//! What is differentiated is the discrete solution, so that derivatives agree with differences of
//! [`crate::cosserat::Cosserat::solve`] on the same steps to rounding, and with those of the rod to its
//! discretisation error. Only what a load does to a rod that has none is compared to solutions of
//! another integrator, that of the loaded rod.

mod adjoint;
mod at_place;
mod backward;
mod change;
mod columns;
mod coordinates;
mod elimination;
mod forward;
mod linear;
mod linear_system;
mod magnus;
mod mass_change;
mod open;
mod partials;
mod quadrature;
mod replay;
mod spans;
mod spread_change;
mod touching;

pub use self::backward::{Cotangent, Gradient};
pub use self::change::Change;
use self::change::Places;
pub(crate) use self::columns::unit_wrench;
use self::columns::{Raw, Source};
pub use self::coordinates::CoordinateDerivatives;
pub(crate) use self::coordinates::{CoordinateCable, SolvedCoordinates};
use self::elimination::Elimination;
pub(crate) use self::elimination::NodeChange;
use self::forward::Maps;
use self::linear::Linear;
pub(crate) use self::linear_system::{Equations, KnownPlaces, LinearSystem, ParameterChange};
pub(crate) use self::open::{Motion, StepGap};
use self::partials::{AtRest, Partial, Setting};
use self::replay::Answer;
pub(crate) use self::spans::StraightSpan;
use self::touching::Touching;
use whipcord_numerics::{Pose, UnitQuaternion, Vec3, magnus_6};

use crate::case::{Case, Loads};
use crate::parameter::Parameter;
use crate::robot::{Robot, RobotError};
use crate::section::Fault;
use crate::section::Strain;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::grid::{Grid, Layout, Step};
pub use crate::statics::hold::Hold;
use crate::statics::hold::{Critical, HeldCables};
use crate::statics::loads::AppliedLoads;

/// A place of the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A station of [`crate::Solution::shape`], from 0.
    Station(usize),
    /// A disk, from 0 at the base.
    Disk(usize),
    /// The tip.
    Tip,
}

/// The derivatives of one answer of a Cosserat rod, with continuous cables or with cables straight from hole to hole.
///
/// Motions and wrenches are in the base frame: a change of pose is the velocity of the station's
/// point and the angular velocity of its frame, `δR = φ̂ R`; a wrench acts at that point and does not
/// turn. So the two are work-conjugate, and under dead forces a compliance is symmetric. (A dead
/// *moment* has no potential for turns about more than one axis; follower loads have none at all.)
///
/// Cables that are slack stay slack: at the very load at which one goes slack the answer has a kink,
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
    places: Places,
    steps: Vec<Step>,
    linear: Linear,
    maps: Maps,
    elimination: Elimination,
    partials: Vec<Partial>,
    /// Grid place of each cable of the robot.
    place_of: Vec<usize>,
    commands: Vec<Command>,
    /// What a change of each tension does at constant other tensions; by grid places.
    by_tension: Vec<Raw>,
    held: HeldCables,
    /// What each tension of 1 N adds to the length of its cable in m, and whether it is taut; by grid places.
    cables: Vec<CableEnd>,
    touching: Touching,
    /// Length of the backbone in m.
    length: f64,
}

/// A cable as what holds it has it.
#[derive(Clone, Copy, Debug)]
struct CableEnd {
    compliance: f64,
    is_taut: bool,
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

/// The answer that is differentiated, as the solver left it.
pub(crate) struct Solved<'a> {
    pub robot: &'a Robot,
    pub case: &'a Case,
    pub cables: Cables<'a>,
    pub grid: &'a Grid,
    pub loads: &'a AppliedLoads,
    pub commands: &'a [Command],
    pub tensions: &'a [f64],
    /// Which cables are taut.
    pub taut: &'a [bool],
    pub poses: &'a [Pose],
    pub base_wrench: Wrench,
    /// Moment, and force beyond that of the dead loads, in the base frame at the starts of steps where they are known.
    pub starts: &'a [Option<Wrench>],
    pub strains: &'a [Strain],
    /// Nodes of the grid that are asked for beside the disks, where cables run straight between these.
    pub nodes: &'a [usize],
}

/// The cables of the robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cables<'a> {
    /// In the order of the grid.
    pub order: &'a [usize],
    /// In m, in the same order.
    pub rest_lengths: &'a [f64],
    /// Where they run straight from hole to hole; their order is then that of the robot.
    pub straight: Option<StraightCables<'a>>,
}

/// Cables that run straight from hole to hole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StraightCables<'a> {
    /// Between each two disks.
    pub spans: &'a [StraightSpan<'a>],
    /// The same on the grid on which their lengths before actuation are known; derivatives by parameters need it.
    pub rest: Option<(&'a Grid, &'a [StraightSpan<'a>])>,
}

impl<'a> Cables<'a> {
    /// Through every section of a grid.
    pub fn of(layout: &'a Layout) -> Self {
        Self { order: &layout.order, rest_lengths: &layout.rest_lengths, straight: None }
    }
}

impl Derivatives {
    pub(crate) fn of(solved: &Solved<'_>, parameters: &[Parameter]) -> Result<Self, NoDerivatives> {
        let Solved { robot, case, cables: of_robot, grid, loads, tensions, .. } = *solved;
        let answer = Answer {
            grid,
            loads,
            tensions,
            poses: solved.poses,
            base_moment: solved.base_wrench.moment,
            follower_force: loads.follower_share(solved.base_wrench.force),
            starts: solved.starts,
            strains: solved.strains,
        };
        let mut linear =
            Linear::of(&answer, of_robot.straight.map(|straight| (straight.spans, solved.nodes)))?;
        let rest = of_robot.straight.and_then(|straight| straight.rest);
        let rest = rest.map(|(grid, spans)| at_rest(grid, spans, tensions)).transpose()?;
        let poses = solved.poses;
        let setting = Setting {
            robot,
            case,
            cables: of_robot,
            grid,
            tensions,
            poses,
            at_rest: rest.as_ref(),
        };
        let partials = parameters
            .iter()
            .map(|parameter| Partial::new(&setting, &linear, parameter))
            .collect::<Result<Vec<_>, _>>()
            .map_err(NoDerivatives::Parameter)?;
        let cables = tensions.len();
        let per_step = linear.per_step();
        let forcing = |k: usize, i: usize, p: usize| partials[p].forcing(per_step * k + i);
        let holes =
            |p: usize, cable: usize, span: usize| partials[p].moved_holes(robot, cable, span);
        let mut maps = linear.maps(grid, cables, partials.len(), &forcing, &holes)?;
        let mut elimination = Elimination::default();
        elimination.eliminate(&mut maps, |step| {
            let node = linear.spans().map_or(step + 1, |spans| spans.far_disk(step));
            let Wrench { force, moment } = *loads.follower(node);
            let rotation = poses[node].rotation;
            Wrench { force: rotation.rotate(force), moment: rotation.rotate(moment) }
        })?;
        let mut place_of = vec![0; cables];
        for (place, &cable) in of_robot.order.iter().enumerate() {
            place_of[cable] = place;
        }
        let mut derivatives = Self {
            places: Places {
                stations: grid.stations.clone(),
                disks: grid.disks.clone(),
                tip: grid.len(),
            },
            steps: grid.steps.clone(),
            linear,
            maps,
            elimination,
            partials,
            place_of,
            commands: solved.commands.to_vec(),
            by_tension: Vec::new(),
            held: HeldCables::default(),
            cables: Vec::new(),
            touching: Touching::default(),
            length: robot.backbone().length,
        };
        derivatives.by_tension =
            (0..cables).map(|place| derivatives.raw(Source::Tension(place))).collect();
        let end = |(place, &is_taut): (usize, &bool)| {
            let stiffness = robot.cables()[of_robot.order[place]].axial_stiffness;
            let compliance = stiffness.map_or(0.0, |k| of_robot.rest_lengths[place] / k);
            CableEnd { compliance, is_taut }
        };
        derivatives.cables = solved.taut.iter().enumerate().map(end).collect();
        derivatives.hold()?;
        let tip = derivatives.raw(Source::Wrench { node: grid.len(), component: 0 });
        let finite = derivatives.by_tension.iter().chain([&tip]).all(Raw::is_finite);
        if finite { Ok(derivatives) } else { Err(NoDerivatives::Critical) }
    }

    fn hold(&mut self) -> Result<(), NoDerivatives> {
        let cables = self.cables.len();
        let compliance = |place: usize| self.cables[place].compliance;
        let taut = |place: usize| self.cables[place].is_taut;
        let driven = |place: usize| matches!(self.commands[place], Command::Length { .. });
        let matrix = |i: usize, j: usize| self.by_tension[j].lengths[i];
        self.held = HeldCables::new(cables, matrix, compliance, taut, driven)?;
        Ok(())
    }
}

/// The rod at rest, bearing nothing.
fn at_rest<'a>(
    grid: &'a Grid,
    spans: &[StraightSpan<'_>],
    tensions: &[f64],
) -> Result<AtRest<'a>, NoDerivatives> {
    let mut pose = Pose::IDENTITY;
    let mut poses = vec![pose];
    for (k, step) in grid.steps.iter().enumerate() {
        let strain = |j: usize| grid.gauss.at(k, j, 0).0.section.rest_strain() * step.length;
        pose = pose * magnus_6(&[strain(0), strain(1), strain(2)]);
        poses.push(pose);
    }
    let mut loads = AppliedLoads::default();
    loads.gather(grid, &Loads::default(), UnitQuaternion::IDENTITY);
    let answer = Answer {
        grid,
        loads: &loads,
        tensions,
        poses: &poses,
        base_moment: Vec3::ZERO,
        follower_force: Vec3::ZERO,
        starts: &[],
        strains: &[],
    };
    Ok(AtRest { grid, linear: Linear::of(&answer, Some((spans, &[])))? })
}
