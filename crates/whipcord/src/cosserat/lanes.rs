//! Rods without load and with one cable, as many at once as the processor's vectors have lanes.
//!
//! The same operations in the same order as [`super::one_cable`] and [`super::unloaded`], so that the
//! answers are the same to the last bit. Rows that take another branch of the scalar code are left
//! to it: a section that folds, a step that turns by half a radian, an error of discretisation that
//! takes grids finer than those at hand.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::GAUSS_3;
use whipcord_numerics::lanes::{LanePose, LaneTwist, LaneVec3, Lanes, magnus_6_exponent};

use super::grid::Grid;
use super::one_cable::{MAX_ITERATIONS, MET, Reduced};
use super::section::{BodyWrench, FOLDED};

/// A position and a quaternion.
const NUMBERS: usize = 7;

/// One grid, made ready for lanes.
#[derive(Clone, Debug)]
struct LaneGrid {
    /// Sections at the nodes and the weights of the quadrature in m, three to each step.
    nodes: Vec<(Reduced, f64)>,
    /// Length of each step in m.
    steps: Vec<f64>,
    rest_excess: f64,
    /// Before how many steps a frame is kept, ascending.
    kept: Vec<usize>,
}

/// A robot with one cable.
#[derive(Clone, Debug)]
pub(crate) struct OneCableLanes {
    /// The only grid, or the first of those with halved steps.
    grids: Vec<LaneGrid>,
    /// Largest change of the answer in m from grid to grid at which the finer one is taken, and by how
    /// much the error is smaller than the change; `None` where the steps are prescribed.
    tolerance: Option<(f64, f64)>,
    /// Which of the kept frames is that of each station.
    stations: Vec<usize>,
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
    /// Length of the cable in m.
    pub length: f64,
    /// Steps from base to tip.
    pub steps: usize,
    /// Estimated, in m.
    pub discretization_error: Option<f64>,
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
}

impl OneCableLanes {
    /// `None` where a step has not exactly one cable, or a section is not equally stiff about x and y.
    pub fn new(grids: &[Grid], tolerance: Option<(f64, f64)>) -> Option<Self> {
        let first = grids.first()?;
        // On each grid the kept places come in the same order.
        let places = |grid: &Grid| {
            let mut kept = grid.stations.clone();
            if tolerance.is_some() {
                kept.extend_from_slice(&grid.disks);
            }
            kept.sort_unstable();
            kept.dedup();
            kept
        };
        let kept = places(first);
        let stations = first.stations.iter().map(|k| kept.partition_point(|other| other < k));
        let grids: Option<Vec<LaneGrid>> =
            grids.iter().map(|grid| LaneGrid::new(grid, places(grid))).collect();
        Some(Self { grids: grids?, tolerance, stations: stations.collect() })
    }

    /// Solves for one tension in N after the other; `take` gets those that were solved, in order.
    pub fn solve(&self, tensions: &[f64], mut take: impl FnMut(LaneAnswer<'_>)) {
        Arch::new().dispatch(Solve { robot: self, tensions, take: &mut take });
    }
}

impl LaneGrid {
    fn new(grid: &Grid, kept: Vec<usize>) -> Option<Self> {
        let mut nodes = Vec::with_capacity(3 * grid.len());
        for (k, step) in grid.steps.iter().enumerate() {
            for j in 0..3 {
                let (node, crossings) = grid.gauss.at(k, j, step.active);
                let ([crossing], true) = (crossings, node.section.isotropic) else {
                    return None;
                };
                let reduced = Reduced::of(&node.section, crossing, BodyWrench::default());
                nodes.push((reduced, GAUSS_3.weights[j] * step.length));
            }
        }
        let steps = grid.steps.iter().map(|step| step.length).collect();
        Some(Self { nodes, steps, rest_excess: *grid.gauss.rest_excess.first()?, kept })
    }
}

/// Answers of all lanes on one grid.
struct Answers<S: Simd> {
    length: Lanes<S>,
    /// Not positive where the lane's answer is one.
    bad: Lanes<S>,
}

struct Solve<'a, F> {
    robot: &'a OneCableLanes,
    tensions: &'a [f64],
    take: &'a mut F,
}

impl<F: FnMut(LaneAnswer<'_>)> WithSimd for Solve<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { robot, tensions, take } = self;
        let lanes = Lanes::<S>::COUNT;
        let places = robot.grids[0].kept.len();
        let mut frames = vec![0.0; places * NUMBERS * lanes];
        let mut coarse_frames = frames.clone();
        for (group, tensions) in tensions.chunks(lanes).enumerate() {
            let tension = Lanes::load(simd, tensions);
            // A lane that has its answer, or none at all, is out.
            let mut out = Lanes::splat(simd, 0.0);
            let mut coarse: Option<Lanes<S>> = None;
            for grid in &robot.grids {
                core::mem::swap(&mut frames, &mut coarse_frames);
                let answers = sweep(grid, simd, tension, &mut frames);
                let change = match (robot.tolerance, coarse) {
                    (None, _) => Some(Lanes::splat(simd, 0.0)),
                    (Some(_), None) => None,
                    (Some((_, ratio)), Some(length)) => {
                        let change = change::<S>(simd, &frames, &coarse_frames, places);
                        let longer = answers.length - length;
                        let change = change.max(longer).max(-longer);
                        Some(change / Lanes::splat(simd, ratio))
                    }
                };
                coarse = Some(answers.length);
                out = out.max(answers.bad);
                let Some(error) = change else { continue };
                let tolerance = robot.tolerance.map_or(0.0, |(tolerance, _)| tolerance);
                for lane in 0..tensions.len() {
                    let error = error.as_slice()[lane];
                    if out.as_slice()[lane] <= 0.0 && error <= tolerance {
                        take(LaneAnswer {
                            row: group * lanes + lane,
                            lanes,
                            lane,
                            frames: &frames,
                            stations: &robot.stations,
                            length: answers.length.as_slice()[lane],
                            steps: grid.steps.len(),
                            discretization_error: robot.tolerance.map(|_| error),
                        });
                    }
                }
                let one = Lanes::splat(simd, 1.0);
                out = out.max(error.where_at_most(tolerance, one, out));
                if out.as_slice()[..tensions.len()].iter().all(|&out| out > 0.0) {
                    break;
                }
            }
        }
    }
}

/// Largest distance in m between the kept positions on two grids.
#[inline(always)]
fn change<S: Simd>(simd: S, fine: &[f64], coarse: &[f64], places: usize) -> Lanes<S> {
    let lanes = Lanes::<S>::COUNT;
    let mut change = Lanes::splat(simd, 0.0);
    for place in 0..places {
        let part = |i: usize| {
            let at = (place * NUMBERS + i) * lanes;
            Lanes::load(simd, &fine[at..]) - Lanes::load(simd, &coarse[at..])
        };
        let moved = LaneVec3::new(part(0), part(1), part(2));
        change = change.max(moved.dot(moved).sqrt());
    }
    change
}

/// Sections and frames on one grid; frames are kept as numbers × lanes for each place.
#[inline(always)]
fn sweep<S: Simd>(grid: &LaneGrid, simd: S, tension: Lanes<S>, frames: &mut [f64]) -> Answers<S> {
    let mut length = Lanes::splat(simd, -grid.rest_excess);
    let mut bad = Lanes::splat(simd, 0.0);
    let mut pose = LanePose::identity(simd);
    let mut kept = grid.kept.iter().peekable();
    let mut slots = frames.chunks_exact_mut(NUMBERS * Lanes::<S>::COUNT);
    let mut keep = |k: usize, pose: &LanePose<S>| {
        if kept.next_if(|&&place| place == k).is_some()
            && let Some(slot) = slots.next()
        {
            let LanePose { position: p, w, v } = pose;
            let numbers = [p.x, p.y, p.z, *w, v.x, v.y, v.z];
            for (to, from) in slot.chunks_exact_mut(Lanes::<S>::COUNT).zip(&numbers) {
                to.copy_from_slice(from.as_slice());
            }
        }
    };
    keep(0, &pose);
    let (nodes, _) = grid.nodes.as_chunks::<3>();
    for (k, (&h, nodes)) in grid.steps.iter().zip(nodes).enumerate() {
        let twists = [
            node(simd, &nodes[0], tension, &mut length, &mut bad) * h,
            node(simd, &nodes[1], tension, &mut length, &mut bad) * h,
            node(simd, &nodes[2], tension, &mut length, &mut bad) * h,
        ];
        let exponent = magnus_6_exponent(&twists);
        let turn = exponent.angular.dot(exponent.angular);
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        bad = bad.max(turn.where_at_most(LanePose::<S>::SERIES_LIMIT, zero, one));
        pose = pose.then(LanePose::exp(exponent));
        keep(k + 1, &pose);
    }
    Answers { length, bad }
}

/// The strain at one node; adds to the cable's length.
#[inline(always)]
fn node<S: Simd>(
    simd: S,
    (at, weight): &(Reduced, f64),
    tension: Lanes<S>,
    length: &mut Lanes<S>,
    bad: &mut Lanes<S>,
) -> LaneTwist<S> {
    let (w, c) = (LaneVec3::splat(simd, at.w), LaneVec3::splat(simd, at.c));
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let size = Lanes::splat(simd, at.size);
    let second = tension * 1.5 * tension * at.spread / size;
    let mut stretch = (size - tension * at.mean + second).at_least(FOLDED);
    let mut iteration = 0;
    let (t, inverse, change) = loop {
        let inverse = LaneVec3::new(
            one / (stretch + tension * c.x),
            one / (stretch + tension * c.y),
            one / (stretch + tension * c.z),
        );
        let t = w.scale(inverse);
        let squared = t.dot(t);
        let error = squared.sqrt() - 1.0;
        let change = squared / t.scale(t).dot(inverse) * error;
        let size = error.max(-error);
        iteration += 1;
        if size.none_above(MET) || iteration == MAX_ITERATIONS {
            // What folds has no tension left to pull the cable straight; a NaN is no answer.
            let folded = stretch.where_at_most(FOLDED, error.where_at_most(0.0, one, zero), zero);
            *bad = bad.max(size.where_at_most(MET, folded, one));
            break (t, inverse, change);
        }
        // Lanes that are there stay where they are.
        stretch = size.where_at_most(MET, stretch, (stretch + change).at_least(FOLDED));
    };
    let t = t - t.scale(inverse) * change;
    *length = *length + (stretch + change) * *weight;
    let (radial, r) = (at.radial, at.offset);
    let pull = LaneVec3::new(t.x * radial.x - t.y * radial.y, t.x * radial.y + t.y * radial.x, t.z)
        * tension;
    let moment = LaneVec3::splat(simd, r).cross(pull);
    LaneTwist {
        linear: LaneVec3::splat(simd, at.linear) - pull.scale(LaneVec3::splat(simd, at.soft.shear)),
        angular: LaneVec3::splat(simd, at.angular)
            - moment.scale(LaneVec3::splat(simd, at.soft.bending)),
    }
}
