//! Lengths and frames of all lanes on one grid, from base to tip.

use pulp::Simd;
use whipcord_numerics::lanes::{LanePose, LaneTwist, LaneVec3, Lanes, magnus_6_exponent};

use super::grid::{LaneGrid, LaneSection};
use super::loaded::{LoadedGrid, Shots};
use crate::statics::lanes::one_cable::LaneReduced;
use crate::statics::turned_sections::{Turn, TurnedSection};

/// Of a frame: a position and a quaternion.
pub(super) const NUMBERS: usize = 7;

/// A frame as numbers × lanes.
#[inline(always)]
pub(super) fn store<S: Simd>(pose: &LanePose<S>, to: &mut [f64]) {
    let LanePose { position: p, w, v } = pose;
    let numbers = [p.x, p.y, p.z, *w, v.x, v.y, v.z];
    for (to, from) in to.chunks_exact_mut(Lanes::<S>::COUNT).zip(&numbers) {
        to.copy_from_slice(from.as_slice());
    }
}

/// [`Turn::strain`] in each lane.
#[inline(always)]
fn turned<S: Simd>(LaneTwist { linear: v, angular: u }: &LaneTwist<S>, turn: Turn) -> LaneTwist<S> {
    let Turn { cos, sin, slope_sign } = turn;
    let (vx, vy) = (v.x * cos - v.y * sin, v.x * sin + v.y * cos);
    let (ux, uy) = (u.x * cos - u.y * sin, u.x * sin + u.y * cos);
    LaneTwist {
        linear: LaneVec3::new(vx * slope_sign, vy * slope_sign, v.z),
        angular: LaneVec3::new(ux, uy, u.z * slope_sign),
    }
}

/// All lanes on one grid, and the memory for it.
pub(super) struct Sweep<S: Simd> {
    simd: S,
    /// In N and m, in the order of the grid.
    pub tensions: Vec<Lanes<S>>,
    pub lengths: Vec<Lanes<S>>,
    /// Of the cables that cross the last section, the first of these.
    stretches: Vec<Lanes<S>>,
    /// By nodes, then cables, of the sections in runs.
    stretches_of_nodes: Vec<Lanes<S>>,
    /// Three to each step.
    pub strains: Vec<LaneTwist<S>>,
    /// From their responses to the tensions, of the sections in runs.
    departures: Vec<LaneTwist<S>>,
    /// Not positive where the lane's answer is one.
    pub bad: Lanes<S>,
    /// Of rods under loads.
    shots: Shots<S>,
    pub iterations: Lanes<S>,
    pub residual: Lanes<S>,
}

impl<S: Simd> Sweep<S> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self {
            simd,
            tensions: Vec::new(),
            lengths: Vec::new(),
            stretches: Vec::new(),
            stretches_of_nodes: Vec::new(),
            strains: Vec::new(),
            departures: Vec::new(),
            bad: Lanes::splat(simd, 0.0),
            shots: Shots::new(),
            iterations: Lanes::splat(simd, 0.0),
            residual: Lanes::splat(simd, 0.0),
        }
    }

    /// Shapes under loads, likewise.
    #[inline(always)]
    pub fn run_loaded(
        &mut self,
        grid: &LoadedGrid,
        kept: &[usize],
        residual: f64,
        frames: &mut [f64],
    ) {
        let Self { simd, tensions, lengths, shots, .. } = self;
        let simd = *simd;
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        lengths.clear();
        lengths.resize(tensions.len(), zero);
        let found = shots.solve(simd, grid, tensions, lengths, residual);
        let slots = frames.chunks_exact_mut(NUMBERS * Lanes::<S>::COUNT);
        for (slot, &place) in slots.zip(kept) {
            store(&shots.poses()[place], slot);
        }
        let mut bad = found.is_solved.select(zero, one);
        for length in lengths.iter() {
            // A NaN is no answer.
            bad = bad.max(length.where_at_most(f64::MAX, zero, one));
        }
        (self.bad, self.residual, self.iterations) = (bad, found.residual, found.iterations);
    }

    /// Sections and frames; the frames at the kept places are left as numbers × lanes for each place.
    #[inline(always)]
    pub fn run(&mut self, grid: &LaneGrid, tolerance: f64, frames: &mut [f64]) {
        let Self { simd, tensions, lengths, stretches, stretches_of_nodes, strains, .. } = self;
        let departures = &mut self.departures;
        let simd = *simd;
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        lengths.clear();
        lengths.extend(grid.rest_excess.iter().map(|excess| Lanes::splat(simd, -excess)));
        let mut bad = zero;
        stretches.resize(lengths.len(), zero);
        let mut crossing = 0;
        let null = LaneVec3::new(zero, zero, zero);
        let mut before = [LaneTwist { linear: null, angular: null }; 3];
        let mut last = before[0];
        // Each is set before it is looked at.
        strains.resize(grid.nodes.len(), last);
        let (cables, in_runs) = (tensions.len(), grid.solved_ahead.len() + grid.turned.len());
        departures.resize(if in_runs == 0 { 0 } else { grid.nodes.len() }, last);
        stretches_of_nodes.resize(departures.len() * cables, zero);
        for &at in &grid.solved_ahead {
            if let LaneSection::Several(section) = &grid.nodes[at].section {
                let solved = section.solve(simd, &before, departures, tensions, tolerance);
                bad = bad.max(solved.is_solved.select(zero, one));
                (strains[at], departures[at]) = (solved.strain, solved.departure);
                let of_node = &mut stretches_of_nodes[at * cables..];
                section.stretches(simd, &solved.strain, of_node);
            }
        }
        for TurnedSection { node, of, turn } in &grid.turned {
            strains[*node] = turned(&strains[*of], *turn);
            let from = of * cables;
            stretches_of_nodes.copy_within(from..from + cables, node * cables);
        }
        let mut pose = LanePose::identity(simd);
        let mut kept = grid.kept.iter().peekable();
        let mut slots = frames.chunks_exact_mut(NUMBERS * Lanes::<S>::COUNT);
        let mut keep = |k: usize, pose: &LanePose<S>| {
            if kept.next_if(|&&place| place == k).is_some()
                && let Some(slot) = slots.next()
            {
                store(pose, slot);
            }
        };
        keep(0, &pose);
        let (nodes, _) = grid.nodes.as_chunks::<3>();
        for (k, (&h, nodes)) in grid.steps.iter().zip(nodes).enumerate() {
            let mut twists = before;
            for (j, (node, twist)) in nodes.iter().zip(&mut twists).enumerate() {
                // A section that is the same as the one before has the same answer.
                if !node.repeats {
                    match &node.section {
                        LaneSection::One(at) => {
                            let solved = LaneReduced::splat(simd, at).solve(simd, tensions[0]);
                            (last, stretches[0], crossing) = (solved.strain, solved.stretch, 1);
                            bad = bad.max(solved.is_solved.select(zero, one));
                        }
                        LaneSection::Several(at) => {
                            crossing = at.cables();
                            if node.is_in_run {
                                let number = 3 * k + j;
                                last = strains[number];
                                let of_node = &stretches_of_nodes[number * cables..];
                                stretches[..crossing].copy_from_slice(&of_node[..crossing]);
                            } else {
                                let solved = at.solve(simd, &before, &[], tensions, tolerance);
                                last = solved.strain;
                                bad = bad.max(solved.is_solved.select(zero, one));
                                at.stretches(simd, &last, stretches);
                            }
                        }
                    }
                }
                if let LaneSection::Several(_) = node.section {
                    before = [before[1], before[2], last];
                }
                for (length, &stretch) in lengths.iter_mut().zip(&stretches[..crossing]) {
                    *length = *length + stretch * node.weight;
                }
                strains[3 * k + j] = last;
                *twist = last * h;
            }
            let exponent = magnus_6_exponent(&twists);
            let turn = exponent.angular.dot(exponent.angular);
            bad = bad.max(turn.where_at_most(LanePose::<S>::SERIES_LIMIT, zero, one));
            pose = pose.then(LanePose::exp(exponent));
            keep(k + 1, &pose);
        }
        for length in lengths.iter() {
            // A NaN is no answer.
            bad = bad.max(length.where_at_most(f64::MAX, zero, one));
        }
        self.bad = bad;
    }
}
