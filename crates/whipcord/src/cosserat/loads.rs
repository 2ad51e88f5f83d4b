//! Dead loads, gathered from the tip inwards.

use whipcord_numerics::Vec3;

use super::grid::{Grid, Node};
use crate::case::Loads;
use crate::error::SolveError;
use crate::model::ModelKind;
use crate::robot::Robot;

/// What dead loads exert beyond each step. `F′ = −f` and `M′ = −p′ × F − l` are loads alone, so
/// the force at a cut is known before the shape is.
#[derive(Clone, Debug, Default)]
pub(super) struct DeadLoads {
    gravity: Vec3,
    /// Tip force and point forces at or beyond the end of each step, in N.
    forces: Vec<Vec3>,
    /// Moment applied at the end of so many steps, in N·m; the last is that at the tip.
    moments: Vec<Vec3>,
    any: bool,
}

impl DeadLoads {
    /// Gathers the loads of a case whose point loads are those of the grid.
    pub fn gather(&mut self, grid: &Grid, loads: &Loads) {
        let n = grid.len();
        self.any = !loads.is_none();
        self.gravity = loads.gravity.unwrap_or_default();
        self.forces.clear();
        self.forces.resize(n, loads.tip_force);
        self.moments.clear();
        self.moments.resize(n + 1, Vec3::ZERO);
        self.moments[n] = loads.tip_moment;
        for (point, &place) in loads.points.iter().zip(&grid.loads) {
            for force in &mut self.forces[..place] {
                *force += point.force;
            }
            self.moments[place] += point.moment;
        }
        // What is applied to the clamped base bends nothing.
        if n > 0 {
            self.moments[0] = Vec3::ZERO;
        }
    }

    /// Whether there is any load.
    pub fn any(&self) -> bool {
        self.any
    }

    /// `F` at the base, without what is applied to the base itself.
    pub fn base_force(&self, grid: &Grid) -> Vec3 {
        self.force(0, grid.shooting.at(0, 0, 0).0)
    }

    /// `F` at a node of step `k`, in the base frame.
    #[inline]
    pub fn force(&self, k: usize, node: &Node) -> Vec3 {
        self.forces[k] + self.gravity * node.distal_mass
    }

    /// The moment applied at the end of `k` steps.
    #[inline]
    pub fn moment(&self, k: usize) -> Vec3 {
        self.moments[k]
    }
}

/// Refuses what is not a dead load, and gravity on a rod of unknown density.
pub(super) fn check(robot: &Robot, loads: &Loads) -> Result<(), SolveError> {
    let follower = |path: &str| {
        Err(SolveError::Unsupported {
            model: ModelKind::Cosserat,
            path: path.to_owned(),
            what: "a load that turns with the body",
            advice: "it solves dead loads: give the load in the base frame without `follower`",
        })
    };
    if loads.tip_follower && (loads.tip_force != Vec3::ZERO || loads.tip_moment != Vec3::ZERO) {
        return follower("loads.follower");
    }
    if let Some(i) = loads.points.iter().position(|p| p.follower) {
        return follower(&format!("loads.point[{i}].follower"));
    }
    let heavy = loads.gravity.is_some_and(|g| g != Vec3::ZERO);
    if heavy && robot.backbone().material.density.is_none() {
        return Err(SolveError::Missing {
            model: ModelKind::Cosserat,
            path: "backbone.density".to_owned(),
            advice: "gravity acts on the backbone's mass: give its density, or remove the gravity",
        });
    }
    Ok(())
}
