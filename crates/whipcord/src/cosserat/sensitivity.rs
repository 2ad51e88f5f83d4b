//! What arrives at the tip of the loaded rod, differentiated by base moment, force of the followers
//! and tensions.
//!
//! In the body frame, with `η` the rotation, `μ` the change of `Mᵦ` and `δG` that of the followers'
//! force in the base frame, a change of shape obeys
//!
//! ```text
//! H (δv, δu) = (δN, μ) − Σ qⱼ δτⱼ,   δN = N × η + Rᵀ δG
//! η′ = δu − u × η,   μ′ = −δu × Mᵦ − u × μ − δv × N − v × δN            (5)
//! ```
//!
//! where `qⱼ = (tⱼ, rⱼ × tⱼ)`. A dead moment `l` that is spread along the rod adds `−(Rᵀl) × η` to `μ′`;
//! followers `f` that are spread give `δG′ = −R (η × f)`. The classical Runge–Kutta method takes it from
//! start, middle and end of each step: to order 4, as fine as Newton's method needs it.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::{Mat3, Pose, Twist, UnitQuaternion, Vec3};

use crate::section::lanes::{LANES, Lane, LaneVec, along, cross, times, transpose_times};
use crate::section::{BodyWrench, Strain};
use crate::shape::Wrench;
use crate::statics::elimination::Change;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::loads::AppliedLoads;
use crate::statics::quadratic_form::Sample;
use crate::statics::runge_kutta::SAMPLED_NODES;

/// Derivatives of a shot.
#[derive(Clone, Debug, Default)]
pub(super) struct Sensitivity {
    /// Of what is left over at the tip, base frame, by each unknown: base moment (3), base force of
    /// the followers (3, where there are any), then the tensions.
    pub excess: Vec<Wrench>,
    /// `∂ℓᵢ` by each unknown, by rows of cables; empty unless tensions are among the unknowns.
    pub lengths: Vec<f64>,
    pub columns: Vec<Column>,
    /// Of a step with [`Tensions::Varying`]: what each unknown does to the direction of each cable at start and middle, in the
    /// base frame; of every place in turn for every cable, by unknowns.
    pub directions: Vec<Vec3>,
    /// Whether [`Self::compute`] follows the motions of the nodes.
    pub follows_motions: bool,
    /// Motions of all nodes in turn with each unknown, base frame, where they are followed.
    pub motions: Vec<Twist>,
}

/// Change of rotation and moment with one unknown, in the body frame, and of the followers' force in
/// the base frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Column {
    turn: Vec3,
    moment: Vec3,
    follower_force: Vec3,
    /// Displacement in the base frame, where motions are followed.
    position: Vec3,
    /// Change of the load factor: 1 in the column of that unknown.
    load: f64,
}

/// Several columns.
#[derive(Clone, Copy, Debug, Default)]
struct Columns {
    turn: LaneVec,
    moment: LaneVec,
    follower_force: LaneVec,
    position: LaneVec,
    load: Lane,
}

impl Columns {
    fn of(columns: &[Column]) -> Self {
        let mut out = Self::default();
        for (i, column) in columns.iter().enumerate() {
            out.turn.set(i, column.turn);
            out.moment.set(i, column.moment);
            out.follower_force.set(i, column.follower_force);
            out.position.set(i, column.position);
            out.load.0[i] = column.load;
        }
        out
    }

    fn put(&self, columns: &mut [Column]) {
        for (i, column) in columns.iter_mut().enumerate() {
            column.turn = self.turn.get(i);
            column.moment = self.moment.get(i);
            column.follower_force = self.follower_force.get(i);
            column.position = self.position.get(i);
        }
    }

    /// `LINE`: whether the followers' force changes within a step.
    #[inline(always)]
    fn plus<const LINE: bool>(self, f: f64, slope: &Self) -> Self {
        let (turn, moment) = (self.turn + f * slope.turn, self.moment + f * slope.moment);
        let mut follower_force = self.follower_force;
        if LINE {
            follower_force += f * slope.follower_force;
        }
        Self { turn, moment, follower_force, ..self }
    }
}

/// What is spread along the rod at a sample, per metre, at a load of 1.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    /// In the body frame.
    dead_moment: Vec3,
    follower: Wrench,
    load: f64,
}

impl Spread {
    /// What it adds to the rates of moment and followers' force.
    #[inline(always)]
    fn change(&self, rotation: &Mat3, at: &Columns, slope: &mut Columns) {
        let Self { dead_moment, follower, load } = *self;
        let turned = cross(load * dead_moment, &at.turn);
        slope.moment = slope.moment - turned - along(dead_moment + follower.moment, at.load);
        let contact_response =
            along(follower.force, at.load) - cross(load * follower.force, &at.turn);
        slope.follower_force = -1.0 * times(rotation, &contact_response);
    }
}

impl From<Column> for Change {
    fn from(column: Column) -> Self {
        Self { turn: column.turn, moment: column.moment, force: column.follower_force }
    }
}

/// Stages of the classical Runge–Kutta method: the sample each uses, how far along the slope before
/// it lies, and its weight.
const STAGES: [(usize, f64, f64); 4] =
    [(0, 0.0, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 0.5, 1.0 / 3.0), (2, 1.0, 1.0 / 6.0)];

/// Which unknowns a step of its own is differentiated by: rotation and moment at its start, then
/// the followers' force there, the load factor, and the tensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unknowns<'a> {
    pub follower_force: bool,
    pub load: bool,
    pub tensions: Tensions<'a>,
}

/// Which tensions a step is differentiated by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tensions<'a> {
    /// Of the first so many cables.
    Even(usize),
    /// Of the first so many cables in the middle of the step, with their profile at all shooting nodes of the step in turn.
    Varying(usize, &'a [f64]),
}

impl Tensions<'_> {
    /// Their number.
    pub const fn count(self) -> usize {
        match self {
            Self::Even(cables) | Self::Varying(cables, _) => cables,
        }
    }
}

impl Unknowns<'_> {
    /// Their number.
    pub fn count(&self) -> usize {
        6 + if self.follower_force { 3 } else { 0 } + usize::from(self.load) + self.tensions.count()
    }
}

/// [`Sensitivity::compute`] with the instructions that the processor has.
struct Compute<'a> {
    sensitivity: &'a mut Sensitivity,
    grid: &'a Grid,
    loads: &'a AppliedLoads,
    load: f64,
    samples: &'a [Sample],
    poses: &'a [Pose],
    tensions: usize,
}

impl WithSimd for Compute<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sensitivity, grid, loads, load, samples, poses, tensions } = self;
        sensitivity.sweep(grid, loads, load, samples, poses, tensions);
    }
}

/// [`Sensitivity::transition`] over a step likewise.
struct Transition<'a> {
    sensitivity: &'a mut Sensitivity,
    grid: &'a Grid,
    loads: &'a AppliedLoads,
    load: f64,
    k: usize,
    samples: &'a [Sample],
    tensions: Tensions<'a>,
}

impl WithSimd for Transition<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sensitivity, grid, loads, load, k, samples, tensions } = self;
        sensitivity.step(grid, loads, load, k, samples, tensions);
    }
}

impl Sensitivity {
    /// The transition over step `k` and across the loads at its end, into [`Self::columns`] and
    /// [`Self::lengths`]; `end` is the rotation there.
    #[expect(clippy::too_many_arguments, reason = "a step, its samples, and what it is asked for")]
    pub fn transition(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        k: usize,
        samples: &[Sample],
        end: UnitQuaternion,
        by: Unknowns<'_>,
    ) {
        let unknowns = by.count();
        self.columns.clear();
        self.columns.resize(unknowns, Column::default());
        for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            self.columns[j].turn = axis;
            self.columns[3 + j].moment = axis;
            if by.follower_force {
                self.columns[6 + j].follower_force = axis;
            }
        }
        let tensions = by.tensions.count();
        if by.load {
            self.columns[unknowns - tensions - 1].load = 1.0;
        }
        self.lengths.clear();
        self.lengths.resize(tensions * unknowns, 0.0);
        self.directions.clear();
        if matches!(by.tensions, Tensions::Varying(..)) {
            self.directions.resize(2 * tensions * unknowns, Vec3::ZERO);
        }
        let (sensitivity, tensions) = (&mut *self, by.tensions);
        Arch::new().dispatch(Transition { sensitivity, grid, loads, load, k, samples, tensions });
        self.jump(loads, load, k + 1, end);
    }

    /// Differentiates a sampled shot by the unknowns at the base and the first `tensions` tensions.
    pub fn compute(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        samples: &[Sample],
        poses: &[Pose],
        tensions: usize,
    ) {
        let sensitivity = self;
        Arch::new().dispatch(Compute { sensitivity, grid, loads, load, samples, poses, tensions });
    }

    #[inline(always)]
    fn sweep(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        samples: &[Sample],
        poses: &[Pose],
        tensions: usize,
    ) {
        let at_base = if loads.any_follower_force() { 6 } else { 3 };
        let unknowns = at_base + tensions;
        self.columns.clear();
        self.columns.resize(unknowns, Column::default());
        for (j, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            self.columns[j].moment = axis;
            if at_base == 6 {
                self.columns[3 + j].follower_force = axis;
            }
        }
        self.lengths.clear();
        self.lengths.resize(tensions * unknowns, 0.0);
        self.motions.clear();
        if self.follows_motions {
            self.motions.resize(unknowns, Twist::default());
        }
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            self.step(grid, loads, load, k, triple, Tensions::Even(tensions));
            if self.follows_motions {
                let rotation = poses[k + 1].rotation;
                self.motions.extend(self.columns.iter().map(|column| Twist {
                    linear: column.position,
                    angular: rotation.rotate(column.turn),
                }));
            }
            if k + 1 < grid.len() {
                self.jump(loads, load, k + 1, poses[k + 1].rotation);
            }
        }
        let tip = poses[grid.len()].rotation;
        let last = samples[samples.len() - 1].wrench.angular;
        let follower = loads.follower(grid.len());
        self.excess.clear();
        self.excess.extend(self.columns.iter().map(|c| Wrench {
            force: c.follower_force - load * tip.rotate(c.turn.cross(follower.force)),
            moment: tip.rotate(c.moment + c.turn.cross(last - load * follower.moment)),
        }));
    }

    /// Across the loads between two steps: a dead moment turns in the body frame, a follower force
    /// in the base frame.
    fn jump(&mut self, loads: &AppliedLoads, load: f64, k: usize, rotation: UnitQuaternion) {
        let dead = loads.moment(k);
        if dead != Vec3::ZERO {
            let body = rotation.conjugate().rotate(dead);
            for column in &mut self.columns {
                column.moment -= load * body.cross(column.turn) + column.load * body;
            }
        }
        let follower = loads.follower(k);
        if *follower != Wrench::default() {
            for column in &mut self.columns {
                let force = load * column.turn.cross(follower.force) + column.load * follower.force;
                column.follower_force -= rotation.rotate(force);
                column.moment -= column.load * follower.moment;
            }
        }
    }

    #[inline(always)]
    fn step(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        load: f64,
        k: usize,
        samples: &[Sample],
        tensions: Tensions<'_>,
    ) {
        let none = [Spread::default(); 3];
        let varying = matches!(tensions, Tensions::Varying(..));
        if let Some(line) = loads.line(k) {
            let spread = [0, 1, 2].map(|q: usize| {
                let t = 0.5 * q as f64;
                Spread {
                    dead_moment: samples[q].rotation.conjugate().rotate(line.moment(t)),
                    follower: Wrench {
                        force: line.follower_force(t),
                        moment: line.follower_moment(t),
                    },
                    load,
                }
            });
            if varying {
                self.step_of::<true, true>(grid, loads, k, samples, &spread, tensions);
            } else {
                self.step_of::<true, false>(grid, loads, k, samples, &spread, tensions);
            }
        } else if varying {
            self.step_of::<false, true>(grid, loads, k, samples, &none, tensions);
        } else {
            self.step_of::<false, false>(grid, loads, k, samples, &none, tensions);
        }
    }

    /// `LINE`: whether something is spread along the step. `VARYING`: whether the tensions are those of [`Tensions::Varying`].
    #[inline(always)]
    fn step_of<const LINE: bool, const VARYING: bool>(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        k: usize,
        samples: &[Sample],
        spread: &[Spread; 3],
        tensions: Tensions<'_>,
    ) {
        let step = grid.steps[k];
        let unknowns = self.columns.len();
        let h = step.length;
        let (tensions, profile) = match tensions {
            Tensions::Even(cables) => (cables, &[][..]),
            Tensions::Varying(cables, profile) => (cables, profile),
        };
        let per_node = profile.len() / SHOOTING_NODES.len();
        for first in (0..unknowns).step_by(LANES) {
            let group = first..unknowns.min(first + LANES);
            let start = Columns::of(&self.columns[group.clone()]);
            let forces = LINE || start.follower_force != LaneVec::default();
            let loads_too = start.load != Lane::default();
            let mut end = start;
            let mut slope = Columns::default();
            for (q, reach, weight) in STAGES {
                let sample = &samples[q];
                let stage = start.plus::<LINE>(reach * h, &slope);
                // `δN`.
                let mut push = cross(sample.wrench.linear, &stage.turn);
                if forces || loads_too {
                    let rotation = sample.rotation.to_matrix();
                    let dead = along(loads.force(k, SAMPLED_NODES[q]), start.load);
                    push += transpose_times(&rotation, &(stage.follower_force + dead));
                }
                let (mut linear, mut angular) = (push, stage.moment);
                if tensions > 0 {
                    let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                    for (lane, c) in group.clone().enumerate() {
                        let Some(i) = c.checked_sub(unknowns - tensions) else { continue };
                        if let Some(crossing) = crossings.get(i) {
                            let mut pull = crossing.pull(&sample.strain).0;
                            if VARYING {
                                pull = pull * profile[per_node * SAMPLED_NODES[q] + i];
                            }
                            linear.set(lane, linear.get(lane) - pull.linear);
                            angular.set(lane, angular.get(lane) - pull.angular);
                        }
                    }
                }
                let (dv, du) = sample.tangent.solve_lanes(&linear, &angular);
                slope = rate(sample, &stage, &push, &dv, &du);
                if self.follows_motions {
                    // `δp′ = R (η × v + δv)`.
                    let moved = dv - cross(sample.strain.linear, &stage.turn);
                    let moved = times(&sample.rotation.to_matrix(), &moved);
                    end.position += weight * h * moved;
                }
                if tensions > 0 {
                    let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                    for (i, crossing) in crossings.iter().enumerate() {
                        let pull = crossing.pull(&sample.strain).0;
                        let work = dv.dot(pull.linear) + du.dot(pull.angular);
                        let row = i * unknowns;
                        let sums = &mut self.lengths[row + group.start..row + group.end];
                        for (sum, work) in sums.iter_mut().zip(work.0) {
                            *sum += weight * h * work;
                        }
                    }
                }
                if VARYING && q < 2 {
                    let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                    for (i, crossing) in crossings.iter().enumerate() {
                        let (pull, stretch) = crossing.pull(&sample.strain);
                        let row = (q * crossings.len() + i) * unknowns;
                        let changes = &mut self.directions[row + group.start..row + group.end];
                        for (lane, change) in changes.iter_mut().enumerate() {
                            let of = dv.get(lane) + du.get(lane).cross(crossing.offset);
                            let across = of - pull.linear * pull.linear.dot(of);
                            let turned = stage.turn.get(lane).cross(pull.linear);
                            *change = sample.rotation.rotate(across * (1.0 / stretch) + turned);
                        }
                    }
                }
                if LINE {
                    spread[q].change(&sample.rotation.to_matrix(), &stage, &mut slope);
                }
                end = end.plus::<LINE>(weight * h, &slope);
            }
            end.put(&mut self.columns[group]);
        }
    }
}

/// Eq. (5), with `push` = `δN`.
#[inline(always)]
fn rate(sample: &Sample, at: &Columns, push: &LaneVec, dv: &LaneVec, du: &LaneVec) -> Columns {
    let Sample { strain, wrench, .. } = sample;
    let (n, m) = (wrench.linear, wrench.angular);
    let (v, u) = (strain.linear, strain.angular);
    Columns {
        turn: *du - cross(u, &at.turn),
        moment: cross(m, du) - cross(u, &at.moment) + cross(n, dv) - cross(v, push),
        ..Columns::default()
    }
}

/// Rate of a cable's length: what a unit tension does on a change of strain.
#[inline]
pub(super) fn work(pull: &BodyWrench, change: &Strain) -> f64 {
    pull.linear.dot(change.linear) + pull.angular.dot(change.angular)
}
