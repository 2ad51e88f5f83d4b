//! Proofs that no tensions within their limits bring a point of the backbone to a target.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use whipcord::jobs::share;
use whipcord::{Cancel, Pose, Robot, SolveError, Vec3};

use crate::antagonists::Piece;
use crate::derivative_bounds::{DerivativeBounds, Memory, TensionBox};
use crate::error::InverseError;
use crate::rod_cells::State;
use crate::taylor::{Bound, Taylor};

/// Why there is no proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoProof {
    /// Only for the Cosserat rod the second derivatives have a bound.
    Model,
    /// Under loads the second derivatives have no bound.
    Loads,
    /// With hole friction or friction against bending the answer depends on the steps before.
    History,
    /// The robot may touch obstacles.
    Obstacles,
    /// A greatest tension of a cable is not given.
    TensionLimits,
    /// The target has no point.
    NoPoint,
    /// The boxes that may be looked at did not suffice.
    Boxes,
    /// The point can be reached within the limits of the tensions, or nearly; what cannot is another part of the target or another limit.
    Near,
}

impl NoProof {
    /// In words, with what to do.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Model => "only answers of the model cosserat can be proven to be nearest",
            Self::Loads => "under loads the shape has no rigorous bound; prove it without loads",
            Self::History => {
                "with friction the shape depends on the steps before; prove it without friction"
            }
            Self::Obstacles => "a robot that may touch obstacles has no bound; ask for a clearance",
            Self::TensionLimits => "give the greatest tension of every cable: [limits] tension",
            Self::NoPoint => "a target without a point has no bound",
            Self::Boxes => "the bound was not tight enough within the boxes that may be looked at",
            Self::Near => {
                "its point is within reach of the tensions: what holds it back is another part of the target or another limit"
            }
        }
    }
}

/// A box of a piece of the tensions that is not yet divided.
#[derive(Clone)]
struct Node {
    /// A lower bound of the distance within it.
    bound: f64,
    /// Number of the piece; center and half widths are in its coordinates.
    piece: usize,
    center: Vec<f64>,
    half: Vec<f64>,
}

impl Node {
    /// The half to one side.
    fn half(&self, coordinate: usize, side: f64) -> Self {
        let mut half = self.clone();
        half.center[coordinate] += side * half.half[coordinate];
        half.half[coordinate] *= 0.5;
        half
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// The least bound comes first; of equal ones the box whose center is least, so that the order is always the same.
    fn cmp(&self, other: &Self) -> Ordering {
        let centers = || {
            let pairs = self.center.iter().zip(&other.center);
            pairs.map(|(a, b)| b.total_cmp(a)).find(|order| order.is_ne())
        };
        let bounds = other.bound.total_cmp(&self.bound);
        let pieces = || other.piece.cmp(&self.piece);
        bounds.then_with(pieces).then_with(|| centers().unwrap_or(Ordering::Equal))
    }
}

/// A point of the backbone and where it is wanted.
pub(crate) struct Goal {
    pub arc_length: f64,
    pub point: Vec3,
    /// The distance at which the proof ends, in m.
    pub distance: f64,
    /// Where the point was found to be, under which tensions.
    pub found: Vec3,
    pub tensions: Vec<f64>,
    /// Ends the proof.
    pub cancel: Cancel,
}

/// Error of the second derivatives, as a part of their bound: their integrals are of the fourth order of pieces along which nothing turns much.
const ERROR_OF_SECOND: f64 = 1e-3;

/// What the integrals may leave of the point, as a part of the distance: else the backbone is divided into more pieces, up to so many times as many.
const ERROR_OF_DISTANCE: f64 = 0.005;
const MOST_TIMES: usize = 16;

/// Boxes that are divided at the same time, by threads: so many that these are busy, and so few that a proof ends where it can.
const ROUND: usize = 64;

/// So often a box is halved, or fewer times, before the polynomial of a part is computed.
const HALVINGS: usize = 3;

/// A lower bound of the distance of a point from its target over a box of tensions by branch and bound.
///
/// Over a box of half widths `h` about `τ₀` with the miss `r`, the Jacobian `J` and the second derivatives `H`, for every unit vector `n`
///
/// ```text
/// ‖p(τ) − x‖ ≥ min n·(r + J δ) − R₁,                R₁ = ∫ (1 − t) max ‖∂_δ² p(τ₀ + t δ)‖ dt         (12)
/// ‖p(τ) − x‖ ≥ min n·(r + J δ + ½ H(δ, δ)) − R₂,    R₂ = ½ ∫ (1 − t)² max ‖∂_δ³ p(τ₀ + t δ)‖ dt
/// ```
///
/// over the coordinates of a [`Piece`] of the tensions, with the remainders of [`DerivativeBounds`]; `n` points along the least miss of the polynomial. No box is nearer than the whole robot is long. A box
/// that its polynomial does not show to be beyond the distance is halved until those of its parts can be expected to: these are computed in the order of the bounds, until all are beyond the distance, or the boxes are spent.
/// What is returned is a bound in any case.
///
/// # Errors
/// [`SolveError::Cancelled`].
pub(crate) fn least_distance(
    robot: &Robot,
    base: Pose,
    goal: &Goal,
    tensions: &[[f64; 2]],
    boxes: usize,
) -> Result<Result<f64, NoProof>, InverseError> {
    let (bounds, uncertainty) = match bounds_of(robot, base, goal) {
        Ok(known) => known,
        Err(reason) => return Ok(Err(reason)),
    };
    let greatest: Vec<f64> = tensions.iter().map(|[_, b]| *b).collect();
    let way = (goal.point - base.position).norm();
    let bound = (way - bounds.farthest(&greatest) - uncertainty).max(0.0);
    let pieces: Vec<Weighted> = Piece::all(robot, tensions)
        .into_iter()
        .map(|piece| Weighted {
            edges: piece.edges.concat(),
            weights: piece.edges.iter().map(|edge| bounds.weight(edge)).collect(),
            piece,
        })
        .collect();
    let whole = |(number, Weighted { piece, .. }): (usize, &Weighted)| Node {
        bound,
        piece: number,
        center: piece.ranges.iter().map(|[a, b]| 0.5 * (a + b)).collect(),
        half: piece.ranges.iter().map(|[a, b]| 0.5 * (b - a)).collect(),
    };
    let mut heap: BinaryHeap<Node> = pieces.iter().enumerate().map(whole).collect();
    let proof = Proof { goal, base, bounds: &bounds, uncertainty, pieces: &pieces };
    let mut made = 0;
    loop {
        let bound = heap.peek().map_or(goal.distance, |node| node.bound.min(goal.distance));
        if bound >= goal.distance || made >= boxes {
            return Ok(Ok(bound));
        }
        let mut round: Vec<(Node, Vec<Node>)> = Vec::with_capacity(ROUND);
        while round.len() < ROUND
            && heap.peek().is_some_and(|node| node.bound < goal.distance)
            && let Some(node) = heap.pop()
        {
            round.push((node, Vec::new()));
        }
        share(round.iter_mut(), None, Work::default, |(node, parts), work| {
            proof.divide(node, work, parts);
            !goal.cancel.is_cancelled()
        })
        .map_err(|error| InverseError::Atlas(error.to_string()))?;
        if goal.cancel.is_cancelled() {
            return Err(SolveError::Cancelled { last_load: None }.into());
        }
        for (_, parts) in round {
            made += parts.len();
            heap.extend(parts);
        }
    }
}

/// What bounds the derivatives of the point, with as many pieces of the backbone as the distance needs, and how far the point is there from where it was found.
fn bounds_of(robot: &Robot, base: Pose, goal: &Goal) -> Result<(DerivativeBounds, f64), NoProof> {
    let mut state = State::default();
    let mut times = 1;
    loop {
        let bounds = DerivativeBounds::of(robot, goal.arc_length, times).ok_or(NoProof::Model)?;
        let bent = bounds.rod.bend(base.rotation, &goal.tensions, &[], &mut state);
        bent.ok_or(NoProof::Model)?;
        if state.error > ERROR_OF_DISTANCE * goal.distance && times < MOST_TIMES {
            times *= 2;
            continue;
        }
        let apart = (base.position + state.end() - goal.found).norm();
        return match apart < 0.5 * goal.distance {
            true => Ok((bounds, apart)),
            // No farther than the model tells the point.
            false => Err(NoProof::Near),
        };
    }
}

/// A piece of the tensions with what is known of its coordinates.
struct Weighted {
    piece: Piece,
    /// The tensions of its edges, one after the other.
    edges: Vec<f64>,
    /// How finely each is to be divided.
    weights: Vec<f64>,
}

/// What all boxes have in common.
struct Proof<'a> {
    goal: &'a Goal,
    base: Pose,
    bounds: &'a DerivativeBounds,
    /// In m.
    uncertainty: f64,
    pieces: &'a [Weighted],
}

/// Memory of a thread.
#[derive(Default)]
struct Work {
    state: State,
    memory: Memory,
    middle: Vec<f64>,
    bound: Bound,
    undivided: Vec<(usize, Node)>,
}

impl Proof<'_> {
    /// The parts of a box that have to be divided in their turn: those that the polynomial of the whole does not show to be beyond the distance.
    fn divide(&self, node: &Node, work: &mut Work, parts: &mut Vec<Node>) {
        let Weighted { piece, weights, .. } = &self.pieces[node.piece];
        let polynomial = self.polynomial(node, work);
        let Work { bound, undivided, .. } = work;
        undivided.clear();
        undivided.push((0, node.clone()));
        while let Some((halvings, mut part)) = undivided.pop() {
            let mut is_ready = true;
            if let Some(taylor) = &polynomial {
                // By how much its parts bend the robot, the remainder of a box gets smaller by a power of it.
                let width =
                    |half: &[f64]| -> f64 { half.iter().zip(weights).map(|(h, w)| h * w).sum() };
                let whole = width(&node.half).max(f64::MIN_POSITIVE);
                let of_part = taylor.remainder * (width(&part.half) / whole).powi(taylor.order());
                let is_last = halvings == HALVINGS;
                // Its own polynomial can be expected to show it.
                let expected = self.goal.distance + of_part;
                let counts = if is_last { part.bound + taylor.remainder } else { expected };
                let enough = self.goal.distance + taylor.remainder;
                let least = bound.of(taylor, piece, &part.center, &part.half, [counts, enough]);
                part.bound = part.bound.max(least - taylor.remainder);
                if part.bound >= self.goal.distance {
                    continue;
                }
                is_ready = is_last || least >= expected;
            }
            // Along the coordinate along which the robot changes most.
            let change = |i: usize| part.half[i] * weights[i];
            let widest = (0..weights.len()).max_by(|&a, &b| change(a).total_cmp(&change(b)));
            match widest {
                Some(widest) if halvings == 0 || !is_ready => {
                    let halves = [-0.5, 0.5].map(|side| part.half(widest, side));
                    let within = |half: &Node| piece.has_part_of(&half.center, &half.half);
                    undivided
                        .extend(halves.into_iter().filter(within).map(|of| (halvings + 1, of)));
                }
                _ => parts.push(part),
            }
        }
    }

    /// The polynomial about the middle of a box; `None` where it has no bound, which its parts may have.
    fn polynomial(&self, node: &Node, work: &mut Work) -> Option<Taylor> {
        let Work { state, memory, middle, .. } = work;
        let Weighted { piece, edges, .. } = &self.pieces[node.piece];
        let rod = &self.bounds.rod;
        piece.tensions(&node.center, middle);
        rod.bend(self.base.rotation, middle, edges, state)?;
        let of = TensionBox { center: middle, edges, half: &node.half };
        let [of_first, third] = self.bounds.remainders(of, state, memory)?;
        let of_second = third + ERROR_OF_SECOND * of_first;
        let miss = self.base.position + state.end() - self.goal.point;
        let mut taylor = Taylor {
            center: node.center.clone(),
            miss,
            first: state.motions.clone(),
            second: Vec::new(),
            // The derivatives are not known better than the point.
            remainder: of_first.min(of_second) + 2.0 * state.error + self.uncertainty,
        };
        if of_second < of_first {
            rod.second_derivatives(state, &mut taylor.second);
        }
        Some(taylor)
    }
}
