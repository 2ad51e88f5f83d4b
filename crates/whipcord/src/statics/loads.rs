//! The loads of a case, gathered by where they act on the grid, in the frame of the base.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::grid::{Grid, SHOOTING_NODES};
use crate::case::{Loads, Piece};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;
use crate::shape::Wrench;

/// What is applied to the rod. `F′ = −f` and `M′ = −p′ × F − l` are loads alone, so the force that
/// dead loads exert at a cut is known before the shape is; that of followers turns with it.
#[derive(Clone, Debug, Default)]
pub(crate) struct AppliedLoads {
    /// `F` of the dead loads at the shooting nodes of each step, in N.
    forces: Vec<Vec3>,
    /// Dead force applied at the end of so many steps, in N.
    points: Vec<Vec3>,
    /// Dead moment applied at the end of so many steps, in N·m; the last is that at the tip.
    moments: Vec<Vec3>,
    /// Force and moment that turn with the section at the end of so many steps, in its frame.
    followers: Vec<Wrench>,
    /// What is spread along each step; empty where nothing is.
    lines: Vec<Line>,
    any: bool,
    any_line: bool,
    any_follower_force: bool,
    any_follower: bool,
}

/// What is spread along one step, per metre of the undeformed backbone: linear from start to end.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Line {
    /// Of the dead loads, in the base frame.
    dead: [Wrench; 2],
    /// Of the followers, in the frame of the cross-section.
    follower: [Wrench; 2],
}

/// The value at a fraction of the way from one to the other.
#[inline]
fn between(ends: [Vec3; 2], t: f64) -> Vec3 {
    ends[0] + t * (ends[1] - ends[0])
}

impl Line {
    /// `l` of the dead loads at a fraction of the step.
    #[inline]
    pub fn moment(&self, t: f64) -> Vec3 {
        between(self.dead.map(|w| w.moment), t)
    }

    /// `f` of the followers.
    #[inline]
    pub fn follower_force(&self, t: f64) -> Vec3 {
        between(self.follower.map(|w| w.force), t)
    }

    /// `l` of the followers.
    #[inline]
    pub fn follower_moment(&self, t: f64) -> Vec3 {
        between(self.follower.map(|w| w.moment), t)
    }

    /// Whether any of it turns with the section.
    pub fn follows(&self) -> bool {
        self.follower.iter().any(|wrench| *wrench != Wrench::default())
    }

    /// The dead force from a fraction of a step of length `h` to its end: the integral of `f`.
    fn force_beyond(&self, t: f64, h: f64) -> Vec3 {
        let [start, end] = self.dead.map(|w| w.force);
        let rest = 1.0 - t;
        h * rest * (start + 0.5 * (1.0 + t) * (end - start))
    }

    /// Adds the part of a piece of a profile that lies between two arc lengths.
    fn add(ends: &mut [Wrench; 2], piece: &Piece, [from, to]: [f64; 2]) {
        let [start, end] = piece.at;
        for (wrench, s) in ends.iter_mut().zip([from, to]) {
            let t = ((s - start) / (end - start)).clamp(0.0, 1.0);
            wrench.force += between(piece.force, t);
            wrench.moment += between(piece.moment, t);
        }
    }
}

impl AppliedLoads {
    /// Gathers the loads of a case whose places are those of the grid; `base` is how the base is
    /// turned in the frame of the loads.
    pub fn gather(&mut self, grid: &Grid, loads: &Loads, base: UnitQuaternion) {
        self.any = !loads.is_none();
        let n = grid.len();
        let turn = loads.to_base(base);
        let gravity = turn.rotate(loads.gravity.unwrap_or_default());
        for list in [&mut self.points, &mut self.moments] {
            list.clear();
            list.resize(n + 1, Vec3::ZERO);
        }
        self.followers.clear();
        self.followers.resize(n + 1, Wrench::default());
        self.lines.clear();
        self.forces.clear();
        self.forces.resize(SHOOTING_NODES.len() * n, Vec3::ZERO);
        (self.any_line, self.any_follower_force, self.any_follower) = (false, false, false);
        if !self.any {
            return;
        }
        let mut places = grid.loads.iter().copied();
        let mut apply = |place: usize, force: Vec3, moment: Vec3, follower: bool| {
            if follower {
                self.followers[place].force += force;
                self.followers[place].moment += moment;
            } else {
                self.points[place] += turn.rotate(force);
                self.moments[place] += turn.rotate(moment);
            }
        };
        apply(n, loads.tip_force, loads.tip_moment, loads.tip_follower);
        for (point, place) in loads.points.iter().zip(&mut places) {
            apply(place, point.force, point.moment, point.follower);
        }
        for (mass, place) in loads.masses.iter().zip(&mut places) {
            self.points[place] += gravity * mass.mass;
        }
        // What is applied to the clamped base bends nothing.
        (self.points[0], self.moments[0]) = (Vec3::ZERO, Vec3::ZERO);
        self.followers[0] = Wrench::default();
        self.spread(grid, loads, turn, &mut places);
        self.accumulate(grid, gravity);
        let acts = |of: fn(&Wrench) -> Vec3| {
            let spread = self.lines.iter().flat_map(|line| &line.follower);
            self.followers.iter().chain(spread).any(|wrench| of(wrench) != Vec3::ZERO)
        };
        self.any_follower_force = acts(|wrench| wrench.force);
        self.any_follower = self.any_follower_force || acts(|wrench| wrench.moment);
    }

    /// Shares the distributed loads out to the steps.
    fn spread(
        &mut self,
        grid: &Grid,
        loads: &Loads,
        turn: UnitQuaternion,
        places: &mut impl Iterator<Item = usize>,
    ) {
        if !loads.distributed.is_empty() {
            self.lines.resize(grid.len(), Line::default());
        }
        for load in &loads.distributed {
            let mut first = places.next().unwrap_or(0);
            for (mut piece, last) in load.profile.pieces().zip(&mut *places) {
                if !load.follower {
                    piece.force = piece.force.map(|f| turn.rotate(f));
                    piece.moment = piece.moment.map(|l| turn.rotate(l));
                }
                for (line, step) in self.lines[first..last].iter_mut().zip(&grid.steps[first..]) {
                    let ends = if load.follower { &mut line.follower } else { &mut line.dead };
                    Line::add(ends, &piece, [step.start, step.start + step.length]);
                }
                first = last;
            }
        }
        let turns =
            |line: &Line| line.dead.iter().any(|w| w.moment != Vec3::ZERO) || line.follows();
        self.any_line = self.lines.iter().any(turns);
    }

    /// `F` of the dead loads, summed up from the tip.
    fn accumulate(&mut self, grid: &Grid, gravity: Vec3) {
        const NODES: usize = SHOOTING_NODES.len();
        let mut beyond = Vec3::ZERO;
        for k in (0..grid.len()).rev() {
            beyond += self.points[k + 1];
            for (j, force) in self.forces[NODES * k..NODES * (k + 1)].iter_mut().enumerate() {
                *force = beyond + gravity * grid.shooting.at(k, j, 0).0.distal_mass;
            }
            if let Some(line) = self.lines.get(k) {
                let h = grid.steps[k].length;
                for (j, t) in SHOOTING_NODES.into_iter().enumerate() {
                    self.forces[NODES * k + j] += line.force_beyond(t, h);
                }
                beyond += line.force_beyond(0.0, h);
            }
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

    /// Adds a dead moment, in the base frame, at the end of `k` steps.
    pub fn add_moment(&mut self, k: usize, moment: Vec3) {
        self.moments[k] += moment;
    }

    /// Whether a dead moment acts: it has no energy where the section that bears it can turn.
    pub fn any_dead_moment(&self) -> bool {
        let is_moment = |wrench: &Wrench| wrench.moment != Vec3::ZERO;
        self.moments.iter().any(|&moment| moment != Vec3::ZERO)
            || self.lines.iter().any(|line| line.dead.iter().any(is_moment))
    }

    /// Whether something beside a dead force is spread along a step.
    pub fn any_line(&self) -> bool {
        self.any_line
    }

    /// Whether nothing but dead moments acts.
    pub fn only_dead_moments(&self) -> bool {
        !self.any_follower && self.forces.iter().all(|&force| force == Vec3::ZERO)
    }

    /// Whether a force or moment turns with the body: then there is no energy.
    pub fn any_follower(&self) -> bool {
        self.any_follower
    }

    /// `F` of the dead loads at the base, without what is applied to the base itself.
    pub fn base_force(&self) -> Vec3 {
        self.force(0, 0)
    }

    /// The greatest force anywhere in the rod in N, and the sum of the moments that are applied in N·m:
    /// not less than what acts in equilibrium, but for the arms of the forces.
    pub fn greatest(&self, grid: &Grid) -> [f64; 2] {
        let dead = self.forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        let [mut force, mut moment] = [dead, 0.0];
        for (at, follower) in self.moments.iter().zip(&self.followers) {
            force += follower.force.norm();
            moment += at.norm() + follower.moment.norm();
        }
        for (line, step) in self.lines.iter().zip(&grid.steps) {
            force += step.length * line.follower_force(0.5).norm();
            moment += step.length * (line.moment(0.5).norm() + line.follower_moment(0.5).norm());
        }
        [force, moment]
    }

    /// What followers contribute to this force at the base.
    pub fn follower_share(&self, base_force: Vec3) -> Vec3 {
        if self.any_follower_force { base_force - self.base_force() } else { Vec3::ZERO }
    }

    /// `F` of the dead loads at the node number `j` of step `k`, in the base frame.
    #[inline]
    pub fn force(&self, k: usize, j: usize) -> Vec3 {
        self.forces[SHOOTING_NODES.len() * k + j]
    }

    /// The same at all nodes of step `k` in turn.
    #[inline]
    pub fn forces(&self, k: usize) -> &[Vec3] {
        let nodes = SHOOTING_NODES.len();
        &self.forces[nodes * k..nodes * (k + 1)]
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

    /// The same in the base frame, for this pose of that section.
    pub fn follower_in_base(&self, k: usize, pose: &Pose) -> Wrench {
        let Wrench { force, moment } = *self.follower(k);
        Wrench { force: pose.rotation.rotate(force), moment: pose.rotation.rotate(moment) }
    }

    /// What is spread along step `k` that the forces do not know: moments and followers.
    #[inline]
    pub fn line(&self, k: usize) -> Option<&Line> {
        if self.any_line { self.lines.get(k) } else { None }
    }
}

/// Refuses gravity on a rod of unknown mass.
pub(crate) fn check(robot: &Robot, loads: &Loads) -> Result<(), SolveError> {
    let backbone = robot.backbone();
    let heavy = loads.gravity.is_some_and(|g| g != Vec3::ZERO);
    if heavy && backbone.linear_density_at(robot.disks(), 0.0).is_none() {
        let (key, advice) = if backbone.section.is_some() {
            (
                "density",
                "gravity acts on the backbone's mass: give its density (0 where its own weight does not matter), or remove the gravity",
            )
        } else {
            (
                "linear_density",
                "gravity acts on the backbone's mass: give its mass per length (0 where its own weight does not matter), or remove the gravity",
            )
        };
        return Err(SolveError::Missing {
            model: ModelKind::Cosserat,
            path: format!("backbone.{key}"),
            advice,
        });
    }
    Ok(())
}
