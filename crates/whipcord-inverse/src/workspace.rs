//! Where the tip of a robot can go.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use whipcord::derivatives::Place;
use whipcord::kinematics::{Dexterity, dexterity, principal_axes};
use whipcord::{SolveError, Twist, Vec3};

use crate::error::InverseError;
use crate::limit::{Constraints, Limit};
use crate::options::ReachOptions;
use crate::search::Candidate;
use crate::solver::InverseSolver;
use crate::target::{Target, Tolerance};

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

/// A voxel that the tip can be brought into.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Its number along each axis of the world; the voxel of the number 0 begins at 0.
    pub index: [i32; 3],
    /// Where the tip is in it, in m.
    pub tip: Vec3,
    /// The direction of the backbone there.
    pub axis: Vec3,
    /// The commands that bring it there, by [`InverseSolver::actuators`].
    pub commands: Vec<f64>,
    /// Whether the tip can be brought to the centre of the voxel.
    pub is_full: bool,
    /// How well the commands move the tip there.
    pub dexterity: Dexterity,
    /// Least and greatest stiffness of the tip in N/m against a force, the commands held; `None` where the model knows no loads.
    pub stiffness: Option<[f64; 2]>,
}

/// A point of the boundary of a workspace, and what holds the tip back there.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryPoint {
    /// In m.
    pub tip: Vec3,
    /// Outward, of unit length.
    pub normal: Vec3,
    /// The limits that are met; none where the directions of all commands lie in the boundary.
    pub limits: Vec<Limit>,
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

/// The directions of a voxel's neighbours.
const NEIGHBOURS: [[i32; 3]; 6] =
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
/// A centre is reached where the tip is this near to it, in voxels.
const AT_CENTRE: f64 = 0.05;

/// What the survey knows of a voxel.
struct Found {
    unknowns: Vec<f64>,
    is_full: bool,
}

impl InverseSolver {
    /// Surveys where the tip can go within the limits.
    ///
    /// Shapes all over the commands mark the voxels that they lead the tip into; then each neighbour of a marked voxel that is not marked
    /// is a target, from the commands next to it, until no more are found. A voxel in the middle of marked ones is full. Of the
    /// others it is known whether the tip gets to their centre: their number times the volume of one is the volume.
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
        let mut survey = Survey {
            voxel,
            constraints: self.constraints(self.ranges(), &reach),
            reach,
            found: BTreeMap::new(),
            boundary: Vec::new(),
            first_solve: self.forward().solves,
            solves: options.solves,
            has_stiffness: options.has_stiffness,
        };
        survey.mark_shapes(self, options.shapes)?;
        let is_complete = survey.grow(self)?;
        survey.finish(self, is_complete)
    }
}

struct Survey {
    voxel: f64,
    reach: ReachOptions,
    constraints: Constraints,
    found: BTreeMap<[i32; 3], Found>,
    boundary: Vec<BoundaryPoint>,
    first_solve: usize,
    solves: usize,
    has_stiffness: bool,
}

impl Survey {
    fn index(&self, point: Vec3) -> [i32; 3] {
        // Points are within the length of the robot from its base, in a thousand voxels at most.
        #[allow(clippy::cast_possible_truncation, reason = "far below 2³¹")]
        point.to_array().map(|x| (x / self.voxel).floor() as i32)
    }

    fn centre(&self, index: [i32; 3]) -> Vec3 {
        let [x, y, z] = index.map(|i| (f64::from(i) + 0.5) * self.voxel);
        Vec3::new(x, y, z)
    }

    /// Marks the voxels of the shapes of an atlas. Among obstacles each is solved once more, to see whether it keeps clear.
    fn mark_shapes(
        &mut self,
        solver: &mut InverseSolver,
        shapes: usize,
    ) -> Result<(), InverseError> {
        let mut marked: BTreeMap<[i32; 3], Vec<f64>> = BTreeMap::new();
        for (tip, unknowns) in solver.shapes(shapes)? {
            marked.entry(self.index(tip)).or_insert_with(|| unknowns.to_vec());
        }
        let has_obstacles = !solver.case().obstacles.is_empty();
        for (index, unknowns) in marked {
            if has_obstacles {
                if let Some(candidate) = self.ask(solver, index, &unknowns)? {
                    self.take(index, candidate);
                }
            } else {
                self.found.insert(index, Found { unknowns, is_full: false });
            }
        }
        Ok(())
    }

    /// Asks for the centre of a voxel from these unknowns; `None` where the model has no answer there.
    fn ask(
        &self,
        solver: &mut InverseSolver,
        index: [i32; 3],
        unknowns: &[f64],
    ) -> Result<Option<Candidate>, InverseError> {
        let target = Target::Tip(self.centre(index));
        let tolerance = Tolerance { position: AT_CENTRE * self.voxel, angle: 1.0 };
        match solver.attempt(unknowns, (&target, tolerance), &self.constraints, &self.reach) {
            Ok(candidate) => Ok(Some(candidate)),
            Err(error @ SolveError::Cancelled { .. }) => Err(error.into()),
            Err(_) => Ok(None),
        }
    }

    /// Marks the voxel that the tip has come into.
    fn take(&mut self, asked: [i32; 3], candidate: Candidate) {
        if !candidate.is_allowed {
            return;
        }
        let Some(tip) = candidate.evaluation.solution.disks.poses.last() else { return };
        let at = self.index(tip.position);
        let is_full = candidate.is_reached && at == asked;
        let known = self.found.entry(at);
        let known = known.or_insert_with(|| Found { unknowns: candidate.unknowns, is_full });
        known.is_full |= is_full;
    }

    /// Asks for the centres of all voxels at the border of the marked ones, until there are none that were not asked for.
    /// Whether it came to that.
    fn grow(&mut self, solver: &mut InverseSolver) -> Result<bool, InverseError> {
        let mut asked: BTreeSet<[i32; 3]> = BTreeSet::new();
        // Spread over the workspace, so that what is left when the solves are spent is not one side of it.
        let mut keys: Vec<[i32; 3]> = self.found.keys().copied().collect();
        keys.sort_by_key(|index| scrambled(*index));
        let mut queue = VecDeque::from(keys);
        let beside = |[x, y, z]: [i32; 3]| NEIGHBOURS.map(|[a, b, c]| [x + a, y + b, z + c]);
        while let Some(from) = queue.pop_front() {
            let neighbours = beside(from);
            if neighbours.iter().all(|index| self.found.contains_key(index)) {
                continue;
            }
            for index in core::iter::once(from).chain(neighbours) {
                let is_new = index != from && self.found.contains_key(&index);
                if is_new || !asked.insert(index) {
                    continue;
                }
                if solver.forward().solves - self.first_solve >= self.solves {
                    return Ok(false);
                }
                let Some(known) = self.found.get(&from) else { continue };
                let Some(candidate) = self.ask(solver, index, &known.unknowns)? else { continue };
                self.note_boundary(solver, index, &candidate);
                let before = self.found.len();
                let at = candidate
                    .evaluation
                    .solution
                    .disks
                    .poses
                    .last()
                    .map(|tip| self.index(tip.position));
                self.take(index, candidate);
                if self.found.len() > before {
                    queue.extend(at);
                }
            }
        }
        Ok(true)
    }

    /// A minimum of the distance from a centre out of reach is a point of the boundary.
    fn note_boundary(&mut self, solver: &InverseSolver, index: [i32; 3], candidate: &Candidate) {
        let Some(tip) = candidate.evaluation.solution.disks.poses.last() else { return };
        let out = self.centre(index) - tip.position;
        let distance = out.norm();
        if candidate.is_reached || !candidate.is_minimum || distance < AT_CENTRE * self.voxel {
            return;
        }
        let Candidate { unknowns, evaluation, .. } = candidate;
        let bounds = &solver.ranges().unknowns;
        let limits = self.constraints.met(solver.forward(), evaluation, unknowns, bounds);
        self.boundary.push(BoundaryPoint {
            tip: tip.position,
            normal: out * (1.0 / distance),
            limits,
        });
    }

    fn finish(
        self,
        solver: &mut InverseSolver,
        is_complete: bool,
    ) -> Result<Workspace, InverseError> {
        let mut cells = Vec::with_capacity(self.found.len());
        let surrounded: Vec<bool> = self
            .found
            .keys()
            .map(|[x, y, z]| {
                let beside = |[a, b, c]: &[i32; 3]| [x + a, y + b, z + c];
                NEIGHBOURS.iter().all(|by| self.found.contains_key(&beside(by)))
            })
            .collect();
        for ((index, found), surrounded) in self.found.iter().zip(surrounded) {
            match solver.cell(*index, found, surrounded, self.has_stiffness) {
                Ok(cell) => cells.push(cell),
                Err(error @ SolveError::Cancelled { .. }) => return Err(error.into()),
                Err(_) => {}
            }
        }
        if cells.is_empty() {
            return Err(InverseError::Atlas(
                "no command leads to a shape within the limits".into(),
            ));
        }
        let (dimension, measure) = measure(&cells, self.voxel);
        let bound = |pick: fn(f64, f64) -> f64| {
            let tips = cells.iter().map(|cell| cell.tip);
            tips.reduce(|a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
        };
        let extent = [bound(f64::min), bound(f64::max)].map(Option::unwrap_or_default);
        Ok(Workspace {
            voxel: self.voxel,
            boundary: self.boundary,
            dimension,
            measure,
            extent,
            is_complete,
            solves: solver.forward().solves - self.first_solve,
            cells,
        })
    }
}

impl InverseSolver {
    /// What is known of a voxel at these unknowns.
    fn cell(
        &mut self,
        index: [i32; 3],
        found: &Found,
        is_surrounded: bool,
        has_stiffness: bool,
    ) -> Result<Cell, SolveError> {
        let unknowns = &found.unknowns;
        let scales = self.forward().scales.clone();
        let forward = self.forward_mut();
        let (evaluation, rates) = forward.evaluate_with_rates(unknowns, &[Place::Tip], None)?;
        let rates = rates.filter(|_| has_stiffness);
        let compliance = rates.and_then(|rates| forward.tip_compliance(&rates));
        let columns: Vec<Twist> = evaluation
            .motions
            .iter()
            .zip(&scales)
            .map(|(motions, scale)| Twist {
                linear: motions[0].linear * *scale,
                angular: motions[0].angular * *scale,
            })
            .collect();
        let stiffness = compliance.map(|compliance| {
            let of = principal_axes(&compliance).values;
            [1.0 / of[2].max(of[0]), 1.0 / of[0].min(of[2])]
        });
        let pose = evaluation.solution.disks.poses.last().copied().unwrap_or_default();
        let forward = self.forward();
        let values = forward.values(unknowns, &evaluation.solution);
        let commands = forward.actuators.commands(forward.robot(), &values);
        Ok(Cell {
            index,
            tip: pose.position,
            axis: pose.rotation.rotate(Vec3::Z),
            commands,
            is_full: found.is_full || is_surrounded,
            dexterity: dexterity(&columns),
            stiffness: stiffness.filter(|of| of.iter().all(|k| k.is_finite() && *k > 0.0)),
        })
    }
}

/// A number without an order for each voxel.
fn scrambled([x, y, z]: [i32; 3]) -> u64 {
    let mix = |state: u64, i: i32| {
        (state ^ u64::from(i.cast_unsigned())).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29)
    };
    mix(mix(mix(0, x), y), z)
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
