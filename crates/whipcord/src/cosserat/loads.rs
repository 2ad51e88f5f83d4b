//! The loads of a case, gathered by where they act on the grid.

use whipcord_numerics::Vec3;

use super::grid::{Grid, Node};
use crate::case::Loads;
use crate::error::SolveError;
use crate::model::ModelKind;
use crate::robot::Robot;
use crate::shape::Wrench;

/// What is applied to the rod. `F′ = −f` and `M′ = −p′ × F − l` are loads alone, so the force that
/// dead loads exert at a cut is known before the shape is; that of followers turns with it.
#[derive(Clone, Debug, Default)]
pub(super) struct AppliedLoads {
    gravity: Vec3,
    /// Dead tip force and point forces at or beyond the end of each step, in N.
    forces: Vec<Vec3>,
    /// Dead moment applied at the end of so many steps, in N·m; the last is that at the tip.
    moments: Vec<Vec3>,
    /// Force and moment that turn with the section at the end of so many steps, in its frame.
    followers: Vec<Wrench>,
    any: bool,
    any_follower_force: bool,
    any_follower: bool,
}

impl AppliedLoads {
    /// Gathers the loads of a case whose point loads are those of the grid.
    pub fn gather(&mut self, grid: &Grid, loads: &Loads) {
        let n = grid.len();
        self.any = !loads.is_none();
        self.gravity = loads.gravity.unwrap_or_default();
        self.forces.clear();
        self.forces.resize(n, Vec3::ZERO);
        self.moments.clear();
        self.moments.resize(n + 1, Vec3::ZERO);
        self.followers.clear();
        self.followers.resize(n + 1, Wrench::default());
        self.apply(n, loads.tip_force, loads.tip_moment, loads.tip_follower);
        for (point, &place) in loads.points.iter().zip(&grid.loads) {
            self.apply(place, point.force, point.moment, point.follower);
        }
        self.any_follower_force = self.followers.iter().any(|w| w.force != Vec3::ZERO);
        self.any_follower =
            self.any_follower_force || self.followers.iter().any(|w| w.moment != Vec3::ZERO);
    }

    fn apply(&mut self, place: usize, force: Vec3, moment: Vec3, follower: bool) {
        // What is applied to the clamped base bends nothing.
        if place == 0 {
            return;
        }
        if follower {
            self.followers[place].force += force;
            self.followers[place].moment += moment;
        } else {
            for beyond in &mut self.forces[..place] {
                *beyond += force;
            }
            self.moments[place] += moment;
        }
    }

    /// Whether there is any load.
    pub fn any(&self) -> bool {
        self.any
    }

    /// Whether a force turns with the body: then the force at the base is unknown as well.
    pub fn any_follower_force(&self) -> bool {
        self.any_follower_force
    }

    /// Whether a force or moment turns with the body: then there is no energy.
    pub fn any_follower(&self) -> bool {
        self.any_follower
    }

    /// `F` of the dead loads at the base, without what is applied to the base itself.
    pub fn base_force(&self, grid: &Grid) -> Vec3 {
        self.force(0, grid.shooting.at(0, 0, 0).0)
    }

    /// What followers contribute to this force at the base.
    pub fn follower_share(&self, grid: &Grid, base_force: Vec3) -> Vec3 {
        if self.any_follower_force { base_force - self.base_force(grid) } else { Vec3::ZERO }
    }

    /// `F` of the dead loads at a node of step `k`, in the base frame.
    #[inline]
    pub fn force(&self, k: usize, node: &Node) -> Vec3 {
        self.forces[k] + self.gravity * node.distal_mass
    }

    /// The dead moment applied at the end of `k` steps, in the base frame.
    #[inline]
    pub fn moment(&self, k: usize) -> Vec3 {
        self.moments[k]
    }

    /// The force and moment that turn with the section at the end of `k` steps, in its frame.
    #[inline]
    pub fn follower(&self, k: usize) -> &Wrench {
        &self.followers[k]
    }
}

/// Refuses gravity on a rod of unknown density.
pub(super) fn check(robot: &Robot, loads: &Loads) -> Result<(), SolveError> {
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
