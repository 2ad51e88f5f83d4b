//! The model of one robot, and the memory of its solves.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use super::friction::FrictionWorkspace;
use super::scratch::{Scratch, Start};
use super::sensitivity::Sensitivity;
use crate::budget::Meter;
use crate::contact::WatchedPlaces;
use crate::derivatives::{RestChanges, TensionChanges, TipRatesMemory};
use crate::robot::Robot;
use crate::statics::command::Command;
use crate::statics::grid::{Grid, Layout};
use crate::statics::options::Options;
use crate::statics::outcome::Found;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::refinement::Coarse;

/// Residual on the first grid, relative to that of the answer: what it leaves is far below the error of its steps.
pub(super) const COARSER_RESIDUAL: f64 = 100.0;
/// Steps from base to tip on the grid that [`Accuracy::Tolerance`] starts with.
pub(super) const COARSE_STEPS: usize = 8;
/// Finer grids that are kept once they were needed: to make them takes longer than to solve on them.
pub(super) const FINER_GRIDS: usize = 5;
/// A failure to converge is believed only with steps halved this often.
pub(super) const GIVE_UP_LEVEL: usize = 3;
/// Where the load path loses its stability or ends, it is followed on with steps halved this often:
/// coarser ones may lose it too early.
pub(super) const FOLLOW_LEVEL: usize = 2;
/// How far a cable can be shortened is said with steps halved this often.
pub(super) const FOLD_LEVEL: usize = 5;
/// How often the steps may be halved.
pub(super) const MAX_REFINEMENTS: usize = 9;
/// The Cosserat model of one robot: all that does not change from case to case.
///
/// ```
/// use whipcord::cosserat::{Cosserat, Options, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Loads, Material, Robot, Routing, Section};
///
/// let backbone = Backbone {
///     section: Some(Section::circle(0.003)),
///     material: Material {
///         young_modulus: Some(1.1e9),
///         poisson_ratio: Some(0.3),
///         ..Default::default()
///     },
///     ..Backbone::new(0.18)
/// };
/// let disks = Disks::equally_spaced(0.18, 10, 0.008);
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, disks, vec![cable])?;
///
/// let model = Cosserat::new(&robot, &Loads::default(), &Options::default())?;
/// let mut workspace = Workspace::default();
/// let solution = model.solve(&Case::with_tensions(&[3.0]), None, &mut workspace)?;
/// // A straight cable bends the rod to a circle of curvature τ r/EI.
/// let bend = 0.18 * 3.0 * 0.008 / (1.1e9 * core::f64::consts::PI * 0.003_f64.powi(4) / 64.0);
/// assert!((solution.disks.tip().rotation.log().norm() - bend).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Cosserat {
    pub(super) robot: Robot,
    pub(super) layout: Layout,
    pub(super) options: Options,
    /// Whether some of its cables pull against one another to no effect.
    pub(super) redundant_cables: bool,
    /// How often the steps of the first grid are halved to follow the twist of the unloaded rod.
    pub(super) twist_level: usize,
    /// The only grid, or the first of a sequence in which the steps are halved.
    pub(super) grid: Grid,
    /// The next of them, made when the first case needs them and shared by all copies of the model.
    pub(super) finer: Arc<[OnceLock<Grid>; FINER_GRIDS]>,
    /// Where it is watched for obstacles, kept when the first case with some needs it and shared by all copies of the model.
    pub(super) watched: Arc<OnceLock<WatchedPlaces>>,
    /// How the lengths of the cables before actuation change with parameters, as far as they were asked for.
    pub(super) rest_changes: Arc<RestChanges>,
    /// What earlier steps of actuation left in a backbone with friction against bending.
    pub(super) plastic: Option<PlasticCurvature>,
}

/// Scratch memory of a solve. Nothing is carried over in it from one solve to the next but the
/// memory itself.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    pub(super) commands: Vec<Command>,
    pub(super) meter: Meter,
    /// Where the solve starts, and the answer on the coarser grid as the start on a finer one.
    pub(super) start: Start,
    pub(super) from_coarser: Start,
    /// How far the solve came: the best shape where its budget is spent.
    pub(super) progress: Progress,
    /// What the answer on the coarser grid was.
    pub(super) coarse: Coarse,
    /// The coarser grid at the tensions that the finer one found.
    pub(super) at_tensions: Scratch,
    pub(super) tensions: Vec<Command>,
    pub(super) friction: FrictionWorkspace,
    pub(super) tension_changes: TensionChanges,
    pub(super) tip_rates: TipRatesMemory,
    /// With the motions of all nodes.
    pub(super) motions: Sensitivity,
}

/// What a solve has found so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress {
    /// How often the steps of the grid are halved that it is on.
    pub level: usize,
    /// Whether there is an answer on coarser steps, in [`Workspace::coarse`] and [`Workspace::from_coarser`].
    pub coarser: Option<Found>,
}

/// An answer that the workspace holds, its grid, and its estimated error in m where it was refined.
pub(super) struct Refined<'a> {
    pub found: Found,
    pub grid: Cow<'a, Grid>,
    pub error: Option<f64>,
}
