//! Proofs that no tensions within their limits bring a point of the backbone to a target.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

use whipcord::derivatives::Place;
use whipcord::{Cancel, SolveError, Vec3};

use crate::antagonists::Piece;
use crate::derivative_bounds::{DerivativeBounds, Memory, OfPoint, TensionBox};
use crate::few_steps::ERROR_OF_PROOF;
use crate::forward::Forward;
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
            Self::Boxes => "the bound was not tight enough within the solves that may be spent",
            Self::Near => {
                "its point is within reach of the tensions: what holds it back is another part of the target or another limit"
            }
        }
    }
}

/// A box of a piece of the tensions with a lower bound of the distance.
struct Node {
    bound: f64,
    /// Number of the piece; center and half widths are in its coordinates.
    piece: usize,
    center: Vec<f64>,
    half: Vec<f64>,
    /// Whether the bound is that of a solve in its middle, or that of the box that it is a part of.
    is_solved: bool,
    /// The point about the middle of a box that contains this one.
    taylor: Option<Rc<Taylor>>,
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
    pub place: Place,
    pub arc_length: f64,
    pub point: Vec3,
    /// The distance at which the proof ends, in m.
    pub distance: f64,
    /// Ends the proof, many boxes of which take no solve that would see it.
    pub cancel: Cancel,
}

/// How well shapes are known, as a part of the length: what solves are solved to, twice.
const UNCERTAINTY: f64 = 2.0 * ERROR_OF_PROOF;

/// Error of the second derivatives, as a part of their bound: their integrals are of the fourth order of pieces along which nothing turns much.
const ERROR_OF_SECOND: f64 = 1e-3;

/// Error of the points from these integrals as a part of the length: far more than it is, because they only say where a bound is worth its time.
const ERROR_OF_MIDDLE: f64 = 1e-3;

/// A lower bound of the distance of a point from its target over a box of tensions by branch and bound.
///
/// Over a box of half widths `h` about `τ₀` with the miss `r`, the Jacobian `J` and the second derivatives `H`, for every unit vector `n`
///
/// ```text
/// ‖p(τ) − x‖ ≥ min n·(r + J δ) − ½ max ‖∂_δ² p‖                                          (12)
/// ‖p(τ) − x‖ ≥ min n·(r + J δ + ½ H(δ, δ)) − ⅙ max ‖∂_δ³ p‖
/// ```
///
/// over the coordinates of a [`Piece`] of the tensions, with the bounds of [`DerivativeBounds`]; `n` points along the least miss of the polynomial. No box is nearer than the whole robot is long. The halves of a box have the bound (12) of its
/// polynomial over their part at first, and only where that is the least of all bounds one of their own; the box with
/// the least bound is halved until all bounds are beyond the distance, or the boxes are spent. What is returned is a bound in any case.
///
/// # Errors
/// [`SolveError::Cancelled`].
pub(crate) fn least_distance(
    forward: &mut Forward,
    goal: &Goal,
    tensions: &[[f64; 2]],
    boxes: usize,
) -> Result<Result<(f64, usize), NoProof>, SolveError> {
    let Some(bounds) = DerivativeBounds::of(forward.robot(), goal.arc_length) else {
        return Ok(Err(NoProof::Model));
    };
    let uncertainty = UNCERTAINTY * forward.robot().backbone().length;
    let greatest: Vec<f64> = tensions.iter().map(|[_, b]| *b).collect();
    let way = (goal.point - forward.case.base.position).norm();
    let bound = (way - bounds.farthest(&greatest) - uncertainty).max(0.0);
    let pieces = Piece::all(forward.robot(), tensions);
    let of = |piece: &Piece| piece.edges.iter().map(|edge| bounds.weight(edge)).collect();
    let weights: Vec<Vec<f64>> = pieces.iter().map(of).collect();
    let mut heap: BinaryHeap<Node> = pieces
        .iter()
        .enumerate()
        .map(|(number, piece)| Node {
            bound,
            piece: number,
            center: piece.ranges.iter().map(|[a, b]| 0.5 * (a + b)).collect(),
            half: piece.ranges.iter().map(|[a, b]| 0.5 * (b - a)).collect(),
            is_solved: false,
            taylor: None,
        })
        .collect();
    let mut middles = Middles { bounds, uncertainty, work: Work::default() };
    let mut bound = Bound::default();
    let mut spent = 0;
    loop {
        let Some(mut node) = heap.pop() else { return Ok(Ok((goal.distance, spent))) };
        if goal.cancel.is_cancelled() {
            return Err(SolveError::Cancelled { last_load: None });
        }
        if node.bound >= goal.distance || spent >= boxes {
            return Ok(Ok((node.bound.min(goal.distance), spent)));
        }
        let piece = &pieces[node.piece];
        if !node.is_solved {
            spent += 1;
            node.is_solved = true;
            node.taylor = None;
            if let Some(taylor) = middles.taylor(forward, goal, piece, &node)? {
                let range = [node.bound, goal.distance];
                node.bound = bound.of(&taylor, piece, &node.center, &node.half, range);
                node.taylor = Some(Rc::new(taylor));
            }
            heap.push(node);
            continue;
        }
        // The coordinate along which the robot changes most.
        let change = |i: usize| node.half[i] * weights[node.piece][i];
        let split =
            (0..tensions.len()).max_by(|&a, &b| change(a).total_cmp(&change(b))).unwrap_or(0);
        for side in [-0.5, 0.5] {
            let mut center = node.center.clone();
            let mut half = node.half.clone();
            center[split] += side * half[split];
            half[split] *= 0.5;
            if !piece.has_part_of(&center, &half) {
                continue;
            }
            let range = [node.bound, goal.distance];
            let of_whole =
                node.taylor.as_ref().map(|of| bound.of(of, piece, &center, &half, range));
            let bound = of_whole.unwrap_or(node.bound);
            let taylor = node.taylor.clone();
            // What is beyond the distance needs no box of its own.
            if bound >= goal.distance {
                continue;
            }
            heap.push(Node { bound, center, half, is_solved: false, taylor, piece: node.piece });
        }
    }
}

/// The polynomials about the middles of boxes.
struct Middles {
    bounds: DerivativeBounds,
    /// In m.
    uncertainty: f64,
    work: Work,
}

/// Memory of [`Middles`].
#[derive(Default)]
struct Work {
    state: State,
    memory: Memory,
    middle: Vec<f64>,
    edges: Vec<f64>,
}

impl Middles {
    /// The polynomial of a box; `None` where it has no bound, which its parts may have.
    fn taylor(
        &mut self,
        forward: &mut Forward,
        goal: &Goal,
        piece: &Piece,
        node: &Node,
    ) -> Result<Option<Taylor>, SolveError> {
        let Work { state, memory, middle, edges } = &mut self.work;
        let rod = &self.bounds.rod;
        piece.tensions(&node.center, middle);
        edges.clear();
        piece.edges.iter().for_each(|edge| edges.extend(edge));
        if rod.bend(forward.case.base.rotation, middle, edges, state).is_none() {
            return Ok(None);
        }
        let of = TensionBox { center: middle, edges, half: &node.half };
        let Some(OfPoint { second, third }) = self.bounds.of_point(of, state, memory) else {
            return Ok(None);
        };
        let [first, second] = [0.5 * second, third / 6.0 + 0.5 * ERROR_OF_SECOND * second];
        let remainder = first.min(second) + self.uncertainty;
        // No bound is beyond the distance in the middle.
        let length = forward.robot().backbone().length;
        let distance = (forward.case.base.position + state.end() - goal.point).norm();
        if distance + ERROR_OF_MIDDLE * length - remainder <= node.bound {
            return Ok(None);
        }
        let evaluation = match forward.evaluate_answer(middle, &[goal.place]) {
            Ok(evaluation) => evaluation,
            Err(error @ SolveError::Cancelled { .. }) => return Err(error),
            Err(_) => return Ok(None),
        };
        let motions = &evaluation.rates.motions;
        let along = |edge: &Vec<f64>| {
            let by = edge.iter().zip(motions).filter(|(by, _)| **by != 0.0);
            by.fold(Vec3::ZERO, |sum, (by, motion)| sum + motion[0].linear * *by)
        };
        let mut taylor = Taylor {
            center: node.center.clone(),
            miss: place_of(&evaluation.solution, goal.place) - goal.point,
            first: piece.edges.iter().map(along).collect(),
            second: Vec::new(),
            remainder,
        };
        if second < first {
            rod.second_derivatives(middle, edges, state, &mut taylor.second);
        }
        Ok(Some(taylor))
    }
}

fn place_of(solution: &whipcord::Solution, place: Place) -> Vec3 {
    let poses = &solution.disks.poses;
    let number = match place {
        Place::Disk(disk) => disk,
        Place::Tip | Place::Station(_) => poses.len() - 1,
    };
    poses[number].position
}
