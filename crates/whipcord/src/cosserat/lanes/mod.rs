//! Rods under given tensions, as many at once as the processor's vectors have lanes.
//!
//! Without load the operations are those of [`crate::section::one_cable`], [`crate::section`] and
//! [`super::unloaded`] in the same order, so that the answers are the same to the last bit; under loads they are those of `loaded`, and the answers are
//! the same to the residual. Rows that take another branch
//! of the scalar code are left to it: a section that folds or takes a damped step, a step that turns by
//! half a radian, an error of discretisation that takes grids finer than those at hand, loads under which more than one equilibrium is not ruled out.

mod grid;
mod loaded;
mod section;
mod stability;

use std::sync::OnceLock;

use pulp::{Simd, WithSimd};
use whipcord_numerics::lanes::{LanePose, LaneTwist, LaneVec3, Lanes, Width, magnus_6_exponent};
use whipcord_numerics::{Pose, UnitQuaternion};

use super::prepared::{COARSER_RESIDUAL, Cosserat};
use crate::cancel::Cancel;
use crate::case::Loads;
use crate::section::step_tolerance;
use crate::solution::{NoStability, Verdict};
use crate::statics::grid::Grid;
use crate::statics::lanes::one_cable::LaneReduced;
use crate::statics::loads::AppliedLoads;
use crate::statics::options::StabilityAnalysis;
use crate::statics::refinement::ERROR_RATIO;
use crate::statics::turned_sections::{Turn, TurnedSection};
use grid::{LaneGrid, LaneSection};
use loaded::{LoadedGrid, Shots};
use stability::{several, stability};

/// A position and a quaternion.
const NUMBERS: usize = 7;

/// The steps are halved so often in lanes; few rows need more.
const LEVELS: usize = 6;

/// A robot whose cables are driven by their tensions.
#[derive(Clone, Debug)]
pub(crate) struct RodLanes<'a> {
    model: &'a Cosserat,
    /// The only grid, or the first of those with halved steps; each made when a row needs it.
    grids: Vec<OnceLock<Option<ReadyGrid>>>,
    setting: Setting,
    /// Which of the kept frames is that of each station, and how many are kept.
    stations: Vec<usize>,
    places: usize,
}

/// How a robot is solved in lanes.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    /// Largest estimated error of the answer in m; `None` where the steps are prescribed.
    pub tolerance: Option<f64>,
    /// What is computed of the stability of the answer.
    pub stability: StabilityAnalysis,
    /// The cable at each place in the order of the grid.
    pub order: Vec<usize>,
    /// The loads that all rows carry, and how the base is turned in their frame; `None` where there is none.
    pub loads: Option<(Loads, UnitQuaternion)>,
    /// Of an answer.
    pub residual: f64,
    /// Where it is set, no further rows are solved.
    pub cancel: Cancel,
}

impl Setting {
    /// On the grid whose steps are halved so often: on the first one no more is asked than its steps are worth.
    fn residual_at(&self, level: usize) -> f64 {
        let is_coarse = level == 0 && self.tolerance.is_some();
        if is_coarse { COARSER_RESIDUAL * self.residual } else { self.residual }
    }
}

/// A grid, made ready for lanes.
#[derive(Clone, Debug)]
enum ReadyGrid {
    Unloaded(LaneGrid),
    /// With the places of the kept frames.
    Loaded(Box<LoadedGrid>, Vec<usize>),
}

impl ReadyGrid {
    /// Steps from base to tip.
    fn steps(&self) -> usize {
        match self {
            Self::Unloaded(grid) => grid.steps.len(),
            Self::Loaded(grid, _) => grid.steps(),
        }
    }
}

/// A row that was solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneAnswer<'a> {
    /// Its number among those given.
    pub row: usize,
    lanes: usize,
    lane: usize,
    frames: &'a [f64],
    stations: &'a [usize],
    order: &'a [usize],
    lengths: &'a [f64],
    /// Steps from base to tip.
    pub steps: usize,
    pub iterations: usize,
    pub residual: f64,
    /// Estimated, in m.
    pub discretization_error: Option<f64>,
    pub stability: Result<Verdict, NoStability>,
}

impl LaneAnswer<'_> {
    /// Position in m and quaternion (w, x, y, z) of each station.
    #[inline]
    pub fn frames(&self) -> impl Iterator<Item = [f64; NUMBERS]> + '_ {
        self.stations.iter().map(|place| {
            let at = place * NUMBERS * self.lanes + self.lane;
            core::array::from_fn(|i| self.frames[at + i * self.lanes])
        })
    }

    /// Each cable and its length in m.
    #[inline]
    pub fn lengths(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let of_place = |place: usize| self.lengths[place * self.lanes + self.lane];
        self.order.iter().enumerate().map(move |(place, &cable)| (cable, of_place(place)))
    }
}

impl<'a> RodLanes<'a> {
    /// `None` where a section's stiffness is not diagonal, and for loads that lanes do not take.
    pub fn new(model: &'a Cosserat, setting: Setting) -> Option<Self> {
        let first = model.grid(0).ok()?;
        let kept = kept(&first, &setting);
        let stations = first.stations.iter().map(|k| kept.partition_point(|other| other < k));
        let levels = if setting.tolerance.is_some() { LEVELS } else { 1 };
        let lanes = Self {
            model,
            grids: vec![OnceLock::new(); levels],
            stations: stations.collect(),
            places: kept.len(),
            setting,
        };
        lanes.grid(0).is_some().then_some(lanes)
    }

    fn grid(&self, level: usize) -> Option<&ReadyGrid> {
        let make = || {
            let grid = self.model.grid(level).ok()?;
            let kept = kept(&grid, &self.setting);
            let Some((loads, base)) = &self.setting.loads else {
                return LaneGrid::new(&grid, kept).map(ReadyGrid::Unloaded);
            };
            let mut applied = AppliedLoads::default();
            applied.gather(&grid, loads, *base);
            let length = self.model.robot().backbone().length;
            let ready = LoadedGrid::new(&grid, applied, length)?;
            Some(ReadyGrid::Loaded(Box::new(ready), kept))
        };
        self.grids.get(level)?.get_or_init(make).as_ref()
    }

    /// Solves for rows of tensions in N, one for each cable, with the base at `base`; `take` gets those
    /// that were solved, in no order.
    pub fn solve(
        &self,
        width: Width,
        base: Pose,
        tensions: &[f64],
        mut take: impl FnMut(LaneAnswer<'_>),
    ) {
        width.dispatch(Solve { robot: self, base, tensions, take: &mut take });
    }
}

/// Before how many steps of a grid a frame is kept. On each grid the places come in the same order.
fn kept(grid: &Grid, setting: &Setting) -> Vec<usize> {
    let mut kept = grid.stations.clone();
    if setting.tolerance.is_some() {
        kept.extend_from_slice(&grid.disks);
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

struct Solve<'a, F> {
    robot: &'a RodLanes<'a>,
    base: Pose,
    tensions: &'a [f64],
    take: &'a mut F,
}

impl<F: FnMut(LaneAnswer<'_>)> WithSimd for Solve<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { robot, base, tensions, take } = self;
        let RodLanes { setting, stations, places, .. } = robot;
        let places = *places;
        let lanes = Lanes::<S>::COUNT;
        let cables = setting.order.len();
        let mut sweep = Sweep::new(simd);
        let mut frames = vec![0.0; places * NUMBERS * lanes];
        let mut coarse_frames = frames.clone();
        let mut moved = frames.clone();
        let mut lengths = vec![0.0; cables * lanes];
        let mut coarse_lengths: Vec<Lanes<S>> = Vec::with_capacity(cables);
        let mut column = vec![0.0; lanes];
        let mut of_row = Vec::with_capacity(cables);
        for (group, values) in tensions.chunks(lanes * cables).enumerate() {
            if setting.cancel.is_cancelled() {
                return;
            }
            let rows = values.len() / cables;
            sweep.tensions.clear();
            for &cable in &setting.order {
                for (lane, value) in column.iter_mut().enumerate() {
                    // Lanes without a row are slack.
                    *value = values.get(lane * cables + cable).copied().unwrap_or(0.0);
                }
                sweep.tensions.push(Lanes::load(simd, &column, 0));
            }
            // A lane that has its answer, or none at all, is out.
            column.fill(0.0);
            if let Some(ReadyGrid::Loaded(grid, _)) = robot.grid(0) {
                for (lane, out) in column.iter_mut().enumerate().take(rows) {
                    of_row.clear();
                    of_row.extend(sweep.tensions.iter().map(|tension| tension.as_slice()[lane]));
                    *out = if grid.takes(&of_row) { 0.0 } else { 1.0 };
                }
            }
            let mut out = Lanes::load(simd, &column, 0);
            if out.as_slice()[..rows].iter().all(|&out| out > 0.0) {
                continue;
            }
            for (level, grid) in (0..).map_while(|level| robot.grid(level)).enumerate() {
                core::mem::swap(&mut frames, &mut coarse_frames);
                match grid {
                    ReadyGrid::Unloaded(grid) => {
                        sweep.run(grid, step_tolerance(setting.residual_at(level)), &mut frames);
                    }
                    ReadyGrid::Loaded(grid, kept) => {
                        sweep.run_loaded(grid, kept, setting.residual_at(level), &mut frames);
                    }
                }
                out = out.max(sweep.bad);
                let error = match setting.tolerance {
                    None => Some(Lanes::splat(simd, 0.0)),
                    Some(_) if level == 0 => None,
                    Some(_) => {
                        let mut change = moved_by(simd, &frames, &coarse_frames, places);
                        for (&fine, &coarse) in sweep.lengths.iter().zip(&coarse_lengths) {
                            change = change.max((fine - coarse).abs());
                        }
                        Some(change / Lanes::splat(simd, ERROR_RATIO))
                    }
                };
                coarse_lengths.clone_from(&sweep.lengths);
                let Some(error) = error else { continue };
                let tolerance = setting.tolerance.unwrap_or(0.0);
                let met = |lane: usize| {
                    out.as_slice()[lane] <= 0.0 && error.as_slice()[lane] <= tolerance
                };
                if (0..rows).any(met) {
                    // A NaN where there is none.
                    let none = Lanes::splat(simd, f64::NAN);
                    let eigenvalues = match (grid, setting.stability) {
                        (ReadyGrid::Loaded(..), _) | (_, StabilityAnalysis::Off) => none,
                        (ReadyGrid::Unloaded(grid), StabilityAnalysis::Verdict) => {
                            let several = several(simd, grid, &sweep.tensions);
                            several.select(none, Lanes::splat(simd, 1.0))
                        }
                        (ReadyGrid::Unloaded(grid), StabilityAnalysis::Eigenvalue) => {
                            stability(simd, grid, &sweep.tensions, &sweep.strains)
                        }
                    };
                    for (to, from) in lengths.chunks_exact_mut(lanes).zip(&sweep.lengths) {
                        to.copy_from_slice(from.as_slice());
                    }
                    let mut answer_frames = &frames;
                    if base != Pose::IDENTITY {
                        move_frames(simd, base, &frames, &mut moved);
                        answer_frames = &moved;
                    }
                    for lane in (0..rows).filter(|&lane| met(lane)) {
                        let least = eigenvalues.as_slice()[lane];
                        let stability = match setting.stability {
                            StabilityAnalysis::Off => Err(NoStability::NotAsked),
                            _ if !least.is_nan() => Ok(Verdict::of_eigenvalue(least)),
                            StabilityAnalysis::Verdict => Ok(Verdict::STABLE),
                            StabilityAnalysis::Eigenvalue => continue,
                        };
                        take(LaneAnswer {
                            row: group * lanes + lane,
                            lanes,
                            lane,
                            frames: answer_frames,
                            stations,
                            order: &setting.order,
                            lengths: &lengths,
                            steps: grid.steps(),
                            iterations: sweep.iterations.as_slice()[lane] as usize,
                            residual: sweep.residual.as_slice()[lane],
                            discretization_error: setting.tolerance.map(|_| error.as_slice()[lane]),
                            stability,
                        });
                    }
                }
                let one = Lanes::splat(simd, 1.0);
                out = out.max(error.where_at_most(tolerance, one, out));
                if out.as_slice()[..rows].iter().all(|&out| out > 0.0) {
                    break;
                }
            }
        }
    }
}

/// Largest distance in m between the kept positions on two grids.
#[inline(always)]
fn moved_by<S: Simd>(simd: S, fine: &[f64], coarse: &[f64], places: usize) -> Lanes<S> {
    let lanes = Lanes::<S>::COUNT;
    let mut change = Lanes::splat(simd, 0.0);
    for place in 0..places {
        let part = |i: usize| {
            let at = (place * NUMBERS + i) * lanes;
            Lanes::load(simd, fine, at) - Lanes::load(simd, coarse, at)
        };
        change = change.max(LaneVec3::new(part(0), part(1), part(2)).norm());
    }
    change
}

/// All frames in the world, as [`crate::Shape::moved`] has them.
#[inline(always)]
fn move_frames<S: Simd>(simd: S, base: Pose, frames: &[f64], moved: &mut [f64]) {
    let size = NUMBERS * Lanes::<S>::COUNT;
    let base = LanePose::splat(simd, base);
    for (to, from) in moved.chunks_exact_mut(size).zip(frames.chunks_exact(size)) {
        let part = |i: usize| Lanes::load(simd, from, i * Lanes::<S>::COUNT);
        let pose = LanePose {
            position: LaneVec3::new(part(0), part(1), part(2)),
            w: part(3),
            v: LaneVec3::new(part(4), part(5), part(6)),
        };
        store(&base.then(pose), to);
    }
}

/// A frame as numbers × lanes.
#[inline(always)]
fn store<S: Simd>(pose: &LanePose<S>, to: &mut [f64]) {
    let LanePose { position: p, w, v } = pose;
    let numbers = [p.x, p.y, p.z, *w, v.x, v.y, v.z];
    for (to, from) in to.chunks_exact_mut(Lanes::<S>::COUNT).zip(&numbers) {
        to.copy_from_slice(from.as_slice());
    }
}

/// [`Turn::strain`] in each lane.
#[inline(always)]
fn turned<S: Simd>(LaneTwist { linear: v, angular: u }: &LaneTwist<S>, turn: Turn) -> LaneTwist<S> {
    let Turn { cos, sin, way } = turn;
    let (vx, vy) = (v.x * cos - v.y * sin, v.x * sin + v.y * cos);
    let (ux, uy) = (u.x * cos - u.y * sin, u.x * sin + u.y * cos);
    LaneTwist {
        linear: LaneVec3::new(vx * way, vy * way, v.z),
        angular: LaneVec3::new(ux, uy, u.z * way),
    }
}

/// Answers of all lanes on one grid.
struct Sweep<S: Simd> {
    simd: S,
    /// In N and m, in the order of the grid.
    tensions: Vec<Lanes<S>>,
    lengths: Vec<Lanes<S>>,
    /// Of the cables that cross the last section, the first of these.
    stretches: Vec<Lanes<S>>,
    /// By nodes, then cables, of the sections in runs.
    stretches_of_nodes: Vec<Lanes<S>>,
    /// Three to each step.
    strains: Vec<LaneTwist<S>>,
    /// From their responses to the tensions, of the sections in runs.
    departures: Vec<LaneTwist<S>>,
    /// Not positive where the lane's answer is one.
    bad: Lanes<S>,
    /// Of rods under loads.
    shots: Shots<S>,
    iterations: Lanes<S>,
    residual: Lanes<S>,
}

impl<S: Simd> Sweep<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
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
    fn run_loaded(&mut self, grid: &LoadedGrid, kept: &[usize], residual: f64, frames: &mut [f64]) {
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
    fn run(&mut self, grid: &LaneGrid, tolerance: f64, frames: &mut [f64]) {
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
        let (cables, in_runs) = (tensions.len(), grid.first.len() + grid.turned.len());
        departures.resize(if in_runs == 0 { 0 } else { grid.nodes.len() }, last);
        stretches_of_nodes.resize(departures.len() * cables, zero);
        for &at in &grid.first {
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
