//! The Newton step of a chain of steps whose gaps the moment at the base closes: eq. (10) of [`crate::statics::elimination`] under weak dead
//! loads, with cables that have their tensions.
//!
//! Four columns go from base to tip: what the components of a moment at the base do to each node, and what the gaps do. The tangent in the middle of a
//! step stands for all of it: eq. (5) of [`super::sensitivity`] is `(η, μ)′ = B (η, μ) / h` there, with
//!
//! ```text
//! B = h [ X̂ᵀ[N] − [u]                      C        ]      [a] b = a × b
//!       [ [M] X̂ᵀ[N] + [N] S [N] − [v][N]   [M] C + [N] X̂ − [u] ]
//! ```
//!
//! where `S = ∂v/∂N`, `X̂ = ∂v/∂M` and `C = ∂u/∂M`. The midpoint rule carries the columns over a step.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::lanes::{LaneVec3, Lanes};
use whipcord_numerics::{Mat3, Vec3};

use super::gap::Gap;
use super::state::Direction;
use super::step_lanes::{StepLanes, gather_tensions, store};
use super::target::Target;
use crate::section::lanes::{Lane, LaneVec, cross};
use crate::statics::elimination::Change;
use crate::statics::grid::Grid;
use crate::statics::lanes::columns::of_columns;
use crate::statics::lanes::section::linearize;
use crate::statics::lanes::slots::LoadedSlots;
use crate::statics::loads::AppliedLoads;
use crate::statics::runge_kutta::{SAMPLED_NODES, SAMPLED_STAGES};
use crate::statics::section_table::{Row, WIDTH};
use crate::statics::step_table::StepTable;

/// Memory.
#[derive(Clone, Debug, Default)]
pub(super) struct BaseSweep {
    /// `B` of the steps in neighbouring slots, by rows; then of the next.
    rates: Vec<[Row; 36]>,
    /// How each node behind the base turns and its moment changes, in the body frame.
    at_nodes: Vec<[LaneVec; 2]>,
    tensions: Vec<Row>,
}

/// Which of the columns is that with the gaps, behind those by the moment.
const BY_GAPS: usize = 3;
/// Which of the sampled places of a step is its middle.
const MIDDLE: usize = 1;

impl BaseSweep {
    /// Takes the tangents in the middle of the steps that lanes have shot at this; `false` where a section is not stable.
    pub fn linearise(&mut self, grid: &Grid, target: &Target<'_>, shot: &StepLanes) -> bool {
        let Some(table) = grid.step_table() else { return false };
        let Self { rates, tensions, .. } = self;
        Arch::new().dispatch(Linearise { table, grid, target, shot, rates, tensions })
    }

    /// Solves for the step that closes the gaps; `false` where the system is singular.
    pub fn solve(
        &mut self,
        (grid, loads, load): (&Grid, &AppliedLoads, f64),
        gaps: &[Gap],
        step: &mut Direction,
    ) -> bool {
        let Self { rates, at_nodes, .. } = self;
        Arch::new().dispatch(Carry { rates, at_nodes, grid, loads, load, gaps });
        let Some([_, at_tip]) = at_nodes.last() else { return false };
        let [x, y, z, by_gaps] = [0, 1, 2, BY_GAPS].map(|column| at_tip.get(column));
        let Some(inverse) = Mat3::from_columns(x, y, z).inverse() else { return false };
        let moment = -(inverse * by_gaps);
        let shares = Lane([moment.x, moment.y, moment.z, 1.0]);
        let change = |of: &LaneVec| {
            Vec3::new((of.x * shares).sum(), (of.y * shares).sum(), (of.z * shares).sum())
        };
        step.nodes.clear();
        step.nodes.push(Change { moment, ..Change::default() });
        for [turn, moment] in &*at_nodes {
            let (turn, moment) = (change(turn), change(moment));
            step.nodes.push(Change { turn, moment, force: Vec3::ZERO });
        }
        // Nothing is left to act at the tip.
        step.nodes[gaps.len()].moment = Vec3::ZERO;
        step.load = 0.0;
        step.nodes.iter().all(Change::is_finite)
    }
}

/// [`BaseSweep::linearise`] with the instructions that the processor has.
struct Linearise<'a> {
    table: &'a StepTable,
    grid: &'a Grid,
    target: &'a Target<'a>,
    shot: &'a StepLanes,
    rates: &'a mut Vec<[Row; 36]>,
    tensions: &'a mut Vec<Row>,
}

impl WithSimd for Linearise<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { table, grid, target, shot, rates, tensions } = self;
        let (node, cables) = (SAMPLED_NODES[MIDDLE], table.cables());
        let lanes = Lanes::<S>::COUNT.min(WIDTH);
        rates.resize(grid.len().div_ceil(WIDTH), [[0.0; WIDTH]; 36]);
        for (group, rates) in rates.iter_mut().enumerate() {
            let (step, wrenches) = (WIDTH * group, shot.sampled(group, MIDDLE));
            gather_tensions((grid, target), step, cables, tensions);
            let mut length = [0.0; WIDTH];
            for (length, step) in length.iter_mut().zip(&grid.steps[step..]) {
                *length = step.length;
            }
            for first in (0..WIDTH.min(grid.len() - step)).step_by(lanes) {
                let Some(slots) = table.slots(step + first, node) else { return false };
                let load = |row: &Row| Lanes::load(simd, row, first);
                let vector = |i: usize| {
                    let [x, y, z] = [&wrenches[i], &wrenches[i + 1], &wrenches[i + 2]];
                    LaneVec3::new(load(x), load(y), load(z))
                };
                let (n, m) = (vector(0), vector(3));
                let strain = of_columns(simd, shot.strains(group, SAMPLED_STAGES[MIDDLE]), first);
                let tensions = &tensions[cables * node..cables * (node + 1)];
                let of = LoadedSlots { slots, tensions, wrench: [n, m] };
                let tangent = linearize(&of, simd, &strain, |_, _| {});
                if !tangent.is_definite().all() {
                    return false;
                }
                let [stretch, mixed, turn] = tangent.compliance(simd);
                let (v, u) = (strain.linear, strain.angular);
                let (zero, h) = (Lanes::splat(simd, 0.0), load(&length));
                let about = |a: LaneVec3<S>| {
                    [
                        LaneVec3::new(zero, a.z, -a.y),
                        LaneVec3::new(-a.z, zero, a.x),
                        LaneVec3::new(a.y, -a.x, zero),
                    ]
                };
                let (pushes, turns) = (about(n), about(u));
                for axis in 0..3 {
                    let p = pushes[axis];
                    let dv = stretch[0] * p.x + stretch[1] * p.y + stretch[2] * p.z;
                    let du = LaneVec3::new(mixed[0].dot(p), mixed[1].dot(p), mixed[2].dot(p));
                    let by_turn = [du - turns[axis], m.cross(du) + n.cross(dv) - v.cross(p)];
                    put(first, rates, axis, by_turn, h);
                    let (dv, du) = (mixed[axis], turn[axis]);
                    let by_moment = [du, m.cross(du) + n.cross(dv) - turns[axis]];
                    put(first, rates, 3 + axis, by_moment, h);
                }
            }
        }
        true
    }
}

/// Writes a column of `B` into the slots of the lanes: rates of turn and moment by the length of the step.
#[inline(always)]
fn put<S: Simd>(
    first: usize,
    rates: &mut [Row; 36],
    column: usize,
    [turn, moment]: [LaneVec3<S>; 2],
    length: Lanes<S>,
) {
    let (t, m) = (turn * length, moment * length);
    let numbers = [t.x, t.y, t.z, m.x, m.y, m.z];
    for i in 0..6 {
        store(first, &mut rates[6 * i + column..=6 * i + column], &numbers[i..=i]);
    }
}

/// The columns from base to tip likewise.
struct Carry<'a> {
    rates: &'a [[Row; 36]],
    at_nodes: &'a mut Vec<[LaneVec; 2]>,
    grid: &'a Grid,
    loads: &'a AppliedLoads,
    load: f64,
    gaps: &'a [Gap],
}

impl WithSimd for Carry<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { rates, at_nodes, grid, loads, load, gaps } = self;
        let mut at = [LaneVec::default(); 2];
        for (column, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            at[1].set(column, axis);
        }
        at_nodes.clear();
        for (k, gap) in gaps.iter().enumerate().take(grid.len()) {
            let rates = &rates[k / WIDTH];
            let middle = plus(&at, 0.5, &rate(rates, k % WIDTH, &at));
            at = plus(&at, 1.0, &rate(rates, k % WIDTH, &middle));
            let Gap { change, end } = gap;
            let dead = loads.moment(k + 1);
            if dead != Vec3::ZERO {
                let dead = load * end.rotation.conjugate().rotate(dead);
                at[1] = at[1] - cross(dead, &at[0]);
            }
            at[0].set(BY_GAPS, at[0].get(BY_GAPS) + change.turn);
            at[1].set(BY_GAPS, at[1].get(BY_GAPS) + change.moment);
            at_nodes.push(at);
        }
    }
}

/// `B` of the step in a slot by the columns.
#[inline(always)]
fn rate(rates: &[Row; 36], slot: usize, at: &[LaneVec; 2]) -> [LaneVec; 2] {
    let turn = LaneVec {
        x: row(rates, 0, slot, at),
        y: row(rates, 1, slot, at),
        z: row(rates, 2, slot, at),
    };
    let moment = LaneVec {
        x: row(rates, 3, slot, at),
        y: row(rates, 4, slot, at),
        z: row(rates, 5, slot, at),
    };
    [turn, moment]
}

/// Row `i` of `B` by the columns.
#[inline(always)]
fn row(rates: &[Row; 36], i: usize, slot: usize, [turn, moment]: &[LaneVec; 2]) -> Lane {
    let of = &rates[6 * i..6 * i + 6];
    let by_turn = of[0][slot] * turn.x + of[1][slot] * turn.y + of[2][slot] * turn.z;
    by_turn + (of[3][slot] * moment.x + of[4][slot] * moment.y + of[5][slot] * moment.z)
}

#[inline(always)]
fn plus(at: &[LaneVec; 2], f: f64, slope: &[LaneVec; 2]) -> [LaneVec; 2] {
    [at[0] + f * slope[0], at[1] + f * slope[1]]
}
