//! Where the tip of a robot can go.

use whipcord::Vec3;

use crate::cell::{BoundaryPoint, Cell};
use crate::error::InverseError;
use crate::growth::Growth;
use crate::options::ReachOptions;
use crate::solver::InverseSolver;

/// How a workspace is surveyed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkspaceOptions {
    /// Edge of a voxel in m; `None` is a twenty-fifth of the length.
    pub voxel: Option<f64>,
    /// Shapes that are solved before the survey grows from them.
    pub shapes: usize,
    /// Solves that the growth may spend.
    pub solves: usize,
    /// Whether the stiffness of the tip is computed for each voxel.
    pub has_stiffness: bool,
    /// Least distance from obstacles in m; `None` lets the robot touch them.
    pub clearance: Option<f64>,
}

impl Default for WorkspaceOptions {
    fn default() -> Self {
        Self {
            voxel: None,
            shapes: 100_000,
            solves: 400_000,
            has_stiffness: true,
            clearance: Some(0.0),
        }
    }
}

/// Where the tip of a robot can go.
#[derive(Clone, Debug)]
pub struct Workspace {
    /// Edge of a voxel in m.
    pub voxel: f64,
    /// The voxels that the tip can be brought into, in ascending order.
    pub cells: Vec<Cell>,
    /// Points of its boundary.
    pub boundary: Vec<BoundaryPoint>,
    /// 3 of a body, 2 of a surface, 1 of a curve: as far as it is thicker than a voxel.
    pub dimension: usize,
    /// Its volume in m³, its area in m² or its length in m, by the dimension.
    pub measure: f64,
    /// Least and greatest coordinates of the tip in m.
    pub extent: [Vec3; 2],
    /// Whether the growth has come to its end within the solves.
    pub is_complete: bool,
    /// Solves of the model.
    pub solves: usize,
}

impl InverseSolver {
    /// Surveys where the tip can go within the limits.
    ///
    /// Shapes all over the commands mark the voxels that they lead the tip into; then each neighbour of a marked voxel that is not marked
    /// is a target, from the commands next to it, until no more are found. A voxel in the middle of marked ones is full. Of the
    /// others it is known whether the tip gets to their centre: their number times the volume of one is the volume. The work is shared by
    /// the threads of the pool that the caller is in; what is found does not depend on their number.
    ///
    /// # Errors
    /// [`InverseError::Atlas`] where no shapes are found, [`InverseError::Solve`] where a solve was cancelled, and [`InverseError::Voxel`] for one that is not
    /// positive or so small that the workspace has too many.
    pub fn workspace(&mut self, options: &WorkspaceOptions) -> Result<Workspace, InverseError> {
        let length = self.forward().robot().backbone().length;
        let voxel = options.voxel.unwrap_or(length / 25.0);
        // Beyond this, indices and memory are exhausted.
        if !voxel.is_finite() || voxel <= 0.0 || length / voxel > 1e3 {
            return Err(InverseError::Voxel { voxel, least: 1e-3 * length });
        }
        let reach = ReachOptions { clearance: options.clearance, ..ReachOptions::default() };
        let mut growth = Growth::new(self, voxel, reach, options.has_stiffness);
        growth.mark(self.shapes(options.shapes)?)?;
        let is_complete = growth.grow(options.solves)?;
        let solves = growth.solves;
        let (cells, boundary) = growth.into_parts();
        if cells.is_empty() {
            return Err(InverseError::Atlas(
                "no command leads to a shape within the limits".into(),
            ));
        }
        let (dimension, measure) = measure(&cells, voxel);
        let bound = |pick: fn(f64, f64) -> f64| {
            let tips = cells.iter().map(|cell| cell.tip);
            tips.reduce(|a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
        };
        let extent = [bound(f64::min), bound(f64::max)].map(Option::unwrap_or_default);
        Ok(Workspace { voxel, boundary, dimension, measure, extent, is_complete, solves, cells })
    }
}

/// Dimension and measure: directions in which the commands of a half turn move the tip by less than a voxel do not count.
///
/// A voxel that a surface of the normal `n` passes has the area `h²/(|nₓ| + |n_y| + |n_z|)` of it in the mean, and the number of voxels that a curve of the
/// tangent `t` passes is `(|tₓ| + |t_y| + |t_z|)/h` for each metre (Cauchy and Crofton).
fn measure(cells: &[Cell], voxel: f64) -> (usize, f64) {
    let moves = |cell: &Cell| cell.dexterity.singular.iter().filter(|(s, _)| *s > voxel).count();
    let mut counts = [0_usize; 4];
    for cell in cells {
        counts[moves(cell).min(3)] += 1;
    }
    let dimension = (1..=3).max_by_key(|&k| counts[k]).unwrap_or(3);
    let spread = |v: Vec3| v.x.abs() + v.y.abs() + v.z.abs();
    let measure = match dimension {
        3 => {
            #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ voxels")]
            let full = cells.iter().filter(|cell| cell.is_full).count() as f64;
            full * voxel.powi(3)
        }
        2 => {
            let area = |cell: &Cell| voxel.powi(2) / spread(cell.dexterity.singular[2].1);
            cells.iter().map(area).sum()
        }
        _ => {
            let length = |cell: &Cell| voxel / spread(cell.dexterity.singular[0].1);
            cells.iter().map(length).sum()
        }
    };
    (dimension, measure)
}
