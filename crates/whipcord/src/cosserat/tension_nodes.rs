//! Where the tension of a cable with friction is given, and the tension in between.
//!
//! The tension of such a cable is given in the middle of each step that the cable reaches through. To these places friction
//! is what it is to holes: from one to the next the tension changes by the capstan law with the angle by
//! which the cable turns on the way. Within a step the tension is that of its middle, times a profile: the parabola through
//! three neighbouring tensions where the cable slides one way past all of them, and 1 else. An iteration keeps the
//! profile that the iteration before leaves. These are eqs. (14) and (15) of `docs/theory/cosserat.md`.

use whipcord_numerics::Vec3;

use super::loaded::Trajectory;
use crate::derivatives::{PLACES, Share};
use crate::section::Strain;
use crate::solution::SlipState;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::runge_kutta::{NODE_OF_STAGE, STAGES};
use whipcord_numerics::BUTCHER_5;

/// An angle so small, in rad, has no direction.
const STRAIGHT: f64 = 1e-9;
/// The profile stays within these bounds.
const PROFILE: [f64; 2] = [0.5, 2.0];

/// The nodes of all cables, numbered from cable to cable, in the order of the grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TensionNodes {
    cables: Vec<CableNodes>,
    count: usize,
}

/// The nodes of one cable.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CableNodes {
    first: usize,
    /// Steps that it reaches through.
    steps: usize,
    /// Whether friction makes its tension vary; else it has one node.
    varies: bool,
}

impl CableNodes {
    const fn count(&self) -> usize {
        if self.varies { self.steps } else { 1 }
    }

    const fn at(&self, step: usize) -> usize {
        if self.varies { self.first + step } else { self.first }
    }
}

impl CableNodes {
    /// The parabola through the tensions of three neighbouring nodes in a step, where the cable slides one way past all of them.
    fn parabola(
        &self,
        grid: &Grid,
        k: usize,
        tensions: &[f64],
        states: &[SlipState],
    ) -> Option<Share> {
        if !self.varies || k >= self.steps {
            return None;
        }
        let middle = |k: usize| grid.steps[k].start + 0.5 * grid.steps[k].length;
        let slides = |k: usize| states[self.first + k];
        // Three steps, or as many as there are, with this one in the middle where that can be.
        let first = k.saturating_sub(1).min(self.steps.saturating_sub(3));
        let near = first..self.steps.min(first + 3);
        let way = slides(near.end - 1);
        let one_way = near.clone().all(|j| slides(j) == way);
        if !one_way || way == SlipState::Sticks || tensions[self.first + k] <= 0.0 {
            return None;
        }
        let mut share = Share::own(usize::MAX, [0.0; PLACES]);
        for (slot, j) in near.clone().enumerate() {
            share.strands[slot] = self.first + j;
            for (weight, at) in share.weights[slot].iter_mut().zip(SHOOTING_NODES) {
                let s = grid.steps[k].start + at * grid.steps[k].length;
                let of = |i: usize| (s - middle(i)) / (middle(j) - middle(i));
                *weight = near.clone().filter(|&i| i != j).map(of).product();
            }
        }
        Some(share)
    }
}

/// How the turn on the way to a node changes with the directions of the cable in the middle of the step before, and at start
/// and middle of its own step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TurnSlope {
    pub before: Vec3,
    pub start: Vec3,
    pub middle: Vec3,
}

impl TensionNodes {
    /// Of cables with these coefficients of friction, in the order of the grid.
    pub fn new(grid: &Grid, friction: &[f64]) -> Self {
        let mut count = 0;
        let cables = friction.iter().enumerate().map(|(cable, &coefficient)| {
            let steps = grid.steps.iter().take_while(|step| step.active > cable).count();
            let nodes = CableNodes { first: count, steps, varies: coefficient > 0.0 };
            count += nodes.count();
            nodes
        });
        let cables = cables.collect();
        Self { cables, count }
    }

    /// Number of all nodes.
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Number of cables.
    pub const fn cables(&self) -> usize {
        self.cables.len()
    }

    /// Nodes of a cable, from the base on.
    pub fn of_cable(&self, cable: usize) -> core::ops::Range<usize> {
        let nodes = &self.cables[cable];
        nodes.first..nodes.first + nodes.count()
    }

    /// Steps that a cable with friction reaches through; none of one without.
    pub fn steps(&self, cable: usize) -> usize {
        let nodes = &self.cables[cable];
        if nodes.varies { nodes.steps } else { 0 }
    }

    /// The node of a cable in a step.
    pub fn at(&self, cable: usize, step: usize) -> usize {
        self.cables[cable].at(step)
    }

    /// Tensions and sliding of all nodes of this grid, from those on the grid whose steps were halved to it, whose tensions at
    /// all shooting nodes are given too.
    pub fn halved(&self, coarse: &[SlipState], all: &[f64]) -> (Vec<f64>, Vec<SlipState>) {
        let (mut tensions, mut states) = (vec![0.0; self.count], Vec::with_capacity(self.count));
        let (per_node, mut first) = (self.cables.len(), 0);
        for (cable, nodes) in self.cables.iter().enumerate() {
            // The middles of the halves lie at a quarter and at three quarters of the step.
            let tension = |k: usize| {
                let place = if k.is_multiple_of(2) { 1 } else { 3 };
                all[per_node * (k / 2 * PLACES + place) + cable]
            };
            let count = nodes.count();
            for k in 0..count {
                tensions[nodes.first + k] = tension(k);
                states.push(coarse[first + k / 2]);
            }
            first += count.div_ceil(2);
        }
        (tensions, states)
    }

    /// What is known at the starts of the steps of cables on another grid, and 0 where they end, at those of this one: by the cubic through
    /// four neighbours.
    pub fn carried_starts(
        &self,
        grid: &Grid,
        (other, from): (&Self, &Grid),
        known: &[f64],
    ) -> Vec<f64> {
        self.carried_from(grid, other, |old, nodes, k| {
            let start = |grid: &Grid, k: usize| match grid.steps.get(k) {
                Some(step) => step.start,
                None => grid.steps[k - 1].start + grid.steps[k - 1].length,
            };
            if !nodes.varies {
                return known[old.first];
            }
            let (s, count) = (start(grid, k), old.steps + 1);
            let value = |j: usize| if j < old.steps { known[old.first + j] } else { 0.0 };
            let after = (0..count).find(|&j| start(from, j) >= s).unwrap_or(count - 1);
            let first = after.saturating_sub(2).min(count.saturating_sub(4));
            let near = first..count.min(first + 4);
            let part = |i: usize| {
                let others = near.clone().filter(|&j| j != i);
                let of = |j: usize| (s - start(from, j)) / (start(from, i) - start(from, j));
                value(i) * others.map(of).product::<f64>()
            };
            near.clone().map(part).sum()
        })
    }

    /// What is known in the steps of cables on another grid, in those of this one that begin in them.
    pub fn carried_steps<T: Copy>(
        &self,
        grid: &Grid,
        (other, from): (&Self, &Grid),
        known: &[T],
    ) -> Vec<T> {
        self.carried_from(grid, other, |old, nodes, k| {
            if !nodes.varies {
                return known[old.first];
            }
            let middle = grid.steps[k].start + 0.5 * grid.steps[k].length;
            let behind = from.steps[..old.steps].partition_point(|step| step.start <= middle);
            known[old.first + behind.saturating_sub(1)]
        })
    }

    fn carried_from<T>(
        &self,
        grid: &Grid,
        other: &Self,
        value: impl Fn(&CableNodes, &CableNodes, usize) -> T,
    ) -> Vec<T> {
        debug_assert!(self.cables.iter().all(|nodes| nodes.steps <= grid.len()));
        let value = &value;
        let pairs = self.cables.iter().zip(&other.cables);
        pairs
            .flat_map(|(nodes, old)| (0..nodes.count()).map(move |k| value(old, nodes, k)))
            .collect()
    }

    /// By how much `Dᵢ` changed at all nodes of this grid, from the changes on the grid whose steps were halved to it: at the nodes between
    /// two of these by the cubic through four, where the cable sticks at all of them.
    pub fn halved_rest(&self, grid: &Grid, coarse: &[f64], states: &[SlipState]) -> Vec<f64> {
        let mut rest = Vec::with_capacity(self.count);
        let mut first = 0;
        for nodes in &self.cables {
            let count = nodes.count();
            let of = count.div_ceil(2);
            // Nothing is beyond the end of the cable.
            let value = |j: usize| if j < of { coarse[first + j] } else { 0.0 };
            let sticks = |j: usize| j >= of || states[first + j] == SlipState::Sticks;
            let place = |j: usize| match grid.steps.get(2 * j) {
                Some(step) if 2 * j < count => step.start,
                _ => grid.steps[count - 1].start + grid.steps[count - 1].length,
            };
            for k in 0..count {
                let j = k / 2;
                if k.is_multiple_of(2) {
                    rest.push(value(j));
                    continue;
                }
                let cubic = j > 0 && j + 2 <= of && (j - 1..=j + 2).all(sticks);
                let near = if cubic { j - 1..j + 3 } else { j..j + 2 };
                let s = grid.steps[k].start;
                let part = |i: usize| {
                    let others = near.clone().filter(|&l| l != i);
                    let of = |l: usize| (s - place(l)) / (place(i) - place(l));
                    value(i) * others.map(of).product::<f64>()
                };
                rest.push(near.clone().map(part).sum());
            }
            first += of;
        }
        rest
    }

    /// Tensions of all cables at all shooting nodes in turn, from those at the nodes of each and from the profile.
    pub fn expand(&self, grid: &Grid, tensions: &[f64], profile: &[f64], all: &mut Vec<f64>) {
        let per_node = self.cables.len();
        all.clear();
        all.extend_from_slice(profile);
        for (k, at_step) in all.chunks_exact_mut(per_node * PLACES).enumerate() {
            for at_node in at_step.chunks_exact_mut(per_node) {
                for (slot, nodes) in at_node[..grid.steps[k].active].iter_mut().zip(&self.cables) {
                    *slot *= tensions[nodes.at(k)];
                }
            }
        }
    }

    /// The profile that is 1 everywhere.
    pub fn flat_profile(&self, grid: &Grid) -> Vec<f64> {
        vec![1.0; self.cables.len() * PLACES * grid.len()]
    }

    /// How the tensions in each step, by cables, come about of those at the nodes.
    pub fn shares(&self, grid: &Grid, tensions: &[f64], states: &[SlipState]) -> Vec<Share> {
        let mut shares = Vec::with_capacity(grid.len() * self.cables.len());
        for k in 0..grid.len() {
            for nodes in &self.cables {
                shares.push(match nodes.parabola(grid, k, tensions, states) {
                    Some(share) => share,
                    None if k < nodes.steps => Share::own(nodes.at(k), [1.0; PLACES]),
                    None => Share::own(usize::MAX, [0.0; PLACES]),
                });
            }
        }
        shares
    }

    /// The same with this profile, whatever makes it.
    pub fn shares_of_profile(&self, grid: &Grid, profile: &[f64]) -> Vec<Share> {
        let cables = self.cables.len();
        let of = |k: usize, cable: usize| {
            let nodes = &self.cables[cable];
            let at = |place: usize| profile[cables * (k * PLACES + place) + cable];
            let node = if k < nodes.steps { nodes.at(k) } else { usize::MAX };
            Share::own(node, core::array::from_fn(at))
        };
        (0..grid.len()).flat_map(|k| (0..cables).map(move |cable| of(k, cable))).collect()
    }

    /// The strand of a cable in a step, which is its node.
    pub fn strand(&self, step: usize, cable: usize) -> Option<usize> {
        let nodes = &self.cables[cable];
        (step < nodes.steps).then(|| nodes.at(step))
    }

    /// The slopes of the turns by steps, then cables.
    pub fn slopes(&self, grid: &Grid, of_nodes: &[TurnSlope]) -> Vec<Option<[Vec3; 3]>> {
        let of = |k: usize, nodes: &CableNodes| {
            let TurnSlope { before, start, middle } = of_nodes[nodes.at(k)];
            [before, start, middle]
        };
        let of_step = |k: usize| {
            let cables = self.cables.iter();
            cables.map(move |nodes| (nodes.varies && k < nodes.steps).then(|| of(k, nodes)))
        };
        (0..grid.len()).flat_map(of_step).collect()
    }

    /// The profile at all shooting nodes, of these tensions and of how the cables slid past the nodes.
    pub fn set_profile(
        &self,
        grid: &Grid,
        tensions: &[f64],
        states: &[SlipState],
        profile: &mut [f64],
    ) {
        let per_node = self.cables.len();
        profile.fill(1.0);
        for (cable, nodes) in self.cables.iter().enumerate().filter(|(_, nodes)| nodes.varies) {
            for k in 0..nodes.steps {
                let Some(share) = nodes.parabola(grid, k, tensions, states) else { continue };
                for place in 0..PLACES {
                    let near = share.strands.iter().zip(&share.weights);
                    let part = |(&node, weights): (&usize, &[f64; PLACES])| {
                        Some(tensions.get(node)? * weights[place])
                    };
                    let value = near.filter_map(part).sum::<f64>() / tensions[nodes.first + k];
                    profile[per_node * (k * PLACES + place) + cable] =
                        value.clamp(PROFILE[0], PROFILE[1]);
                }
            }
        }
    }

    /// Adds the length of each cable in each step to that of its node, by strains at all stages of a shot.
    pub fn add_lengths(&self, grid: &Grid, strains: &[Strain], lengths: &mut [f64]) {
        self.integrate(grid, |k, stage| strains[STAGES * k + stage], lengths);
    }

    /// The same of the rod at rest.
    pub fn add_lengths_at_rest(&self, grid: &Grid, lengths: &mut [f64]) {
        let strain = |k, stage: usize| {
            let node = NODE_OF_STAGE[stage];
            grid.shooting.at(k, node, grid.steps[k].active).0.section.rest_strain()
        };
        self.integrate(grid, strain, lengths);
    }

    fn integrate(&self, grid: &Grid, strain: impl Fn(usize, usize) -> Strain, lengths: &mut [f64]) {
        for (k, step) in grid.steps.iter().enumerate() {
            for stage in 0..STAGES {
                let weight = BUTCHER_5.b[stage] * step.length;
                if weight == 0.0 {
                    continue;
                }
                let (_, crossings) = grid.shooting.at(k, NODE_OF_STAGE[stage], step.active);
                let strain = strain(k, stage);
                for (crossing, nodes) in crossings.iter().zip(&self.cables) {
                    lengths[nodes.at(k)] += weight * crossing.tangent(&strain).norm();
                }
            }
        }
    }

    /// Angle by which each cable turns on the way to each node from the one before, and to the first from the base's axis;
    /// and how it changes. From the samples of a shot of all steps.
    pub fn turns(
        &self,
        grid: &Grid,
        trajectory: &Trajectory,
        turns: &mut [f64],
        slopes: &mut [TurnSlope],
    ) {
        let direction = |cable: usize, k: usize, q: usize| {
            let (_, crossings) = grid.shooting.at(k, 2 * q, grid.steps[k].active);
            let sample = &trajectory.samples[3 * k + q];
            let tangent = crossings[cable].tangent(&sample.strain);
            sample.rotation.rotate(tangent * (1.0 / tangent.norm()))
        };
        for (cable, nodes) in self.cables.iter().enumerate().filter(|(_, nodes)| nodes.varies) {
            let mut before = Vec3::Z;
            for k in 0..nodes.steps {
                let (start, middle) = (direction(cable, k, 0), direction(cable, k, 1));
                let (first, second) =
                    (Angle::between(before, start), Angle::between(start, middle));
                let mut slope = TurnSlope {
                    before: first.by_first,
                    start: first.by_second + second.by_first,
                    middle: second.by_second,
                };
                let mut turn = first.size + second.size;
                if k > 0 {
                    // What two chords of the turn leave of it is a quarter of what one leaves.
                    let both = Angle::between(before, middle);
                    turn += (turn - both.size) / 3.0;
                    slope.before = (4.0 * slope.before - both.by_first) * (1.0 / 3.0);
                    slope.start *= 4.0 / 3.0;
                    slope.middle = (4.0 * slope.middle - both.by_second) * (1.0 / 3.0);
                }
                (turns[nodes.at(k)], slopes[nodes.at(k)]) = (turn, slope);
                before = middle;
            }
        }
    }
}

/// The angle between two unit vectors, and its derivatives by them.
#[derive(Clone, Copy, Debug)]
struct Angle {
    size: f64,
    by_first: Vec3,
    by_second: Vec3,
}

impl Angle {
    fn between(first: Vec3, second: Vec3) -> Self {
        let (sine, cosine) = (first.cross(second).norm(), first.dot(second));
        let slope = if sine > STRAIGHT { -1.0 / sine } else { 0.0 };
        Self { size: sine.atan2(cosine), by_first: second * slope, by_second: first * slope }
    }
}
