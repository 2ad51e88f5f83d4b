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
mod sweep;

use std::sync::OnceLock;

use pulp::{Simd, WithSimd};
use whipcord_numerics::lanes::{LanePose, LaneVec3, Lanes, Width};
use whipcord_numerics::{Pose, UnitQuaternion};

use super::prepared::{COARSER_RESIDUAL, Cosserat};
use crate::cancel::Cancel;
use crate::case::Loads;
use crate::section::step_tolerance;
use crate::solution::{NoStability, Verdict};
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::options::StabilityAnalysis;
use crate::statics::refinement::ERROR_RATIO;
use grid::LaneGrid;
use loaded::LoadedGrid;
use stability::{several, stability};
use sweep::{NUMBERS, Sweep, store};

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
