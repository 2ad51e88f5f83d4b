//! Proofs that no tensions within their limits bring a point of the backbone to a target.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

use whipcord::derivatives::Place;
use whipcord::{SolveError, Vec3};
use whipcord_numerics::{Programme, QuadraticProgramme};

use crate::antagonists::Piece;
use crate::curvature::{CurvatureBound, Memory, TensionBox};
use crate::few_steps::ERROR_OF_PROOF;
use crate::forward::Forward;

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
    /// The point and its rates in the middle of a box that contains this one.
    tangent: Option<Rc<Tangent>>,
}

/// A point as a linear function of the tensions, and what it differs by in a box.
struct Tangent {
    /// The tensions in the middle.
    center: Vec<f64>,
    /// From the target to the point in the middle.
    miss: Vec3,
    motions: Vec<Vec3>,
    /// In m.
    remainder: f64,
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
}

/// How well shapes are known, as a part of the length: what solves are solved to, twice.
const UNCERTAINTY: f64 = 2.0 * ERROR_OF_PROOF;

/// A lower bound of the distance of a point from its target over a box of tensions by branch and bound.
///
/// Over a box of half widths `h` about `τ₀` with the miss `r` and the Jacobian `J`, for every unit vector `n`
///
/// ```text
/// ‖p(τ) − x‖ ≥ n·r − Σ|n·Jᵢ|hᵢ − ½ max ‖∂_δ² p‖                  (12)
/// ```
///
/// over the coordinates of a [`Piece`] of the tensions, with the bound of [`CurvatureBound`]; `n` points along the least miss of the linear problem. No box is nearer than the whole robot is long. The halves of a box have the bound (12) of its
/// tangent over their part at first, and only where that is the least of all bounds one of their own; the box with
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
    let n = tensions.len();
    let Some(curvature) = CurvatureBound::of(forward.robot(), goal.arc_length) else {
        return Ok(Err(NoProof::Model));
    };
    let reach = 2.0 * forward.robot().backbone().length;
    let uncertainty = UNCERTAINTY * forward.robot().backbone().length;
    let mut solver = Bound::default();
    let greatest: Vec<f64> = tensions.iter().map(|[_, b]| *b).collect();
    let way = (goal.point - forward.case.base.position).norm();
    let bound = (way - curvature.farthest(&greatest) - uncertainty).max(0.0);
    let pieces = Piece::all(forward.robot(), tensions);
    let mut memory = Memory::default();
    let mut heap = BinaryHeap::new();
    let bend = |piece: &Piece| -> Vec<f64> {
        piece.edges.iter().map(|edge| curvature.bending(edge)).collect()
    };
    let weights: Vec<Vec<f64>> = pieces.iter().map(bend).collect();
    for (number, piece) in pieces.iter().enumerate() {
        let ranges = || piece.ranges.iter();
        heap.push(Node {
            bound,
            piece: number,
            center: ranges().map(|[a, b]| 0.5 * (a + b)).collect(),
            half: ranges().map(|[a, b]| 0.5 * (b - a)).collect(),
            is_solved: false,
            tangent: None,
        });
    }
    let (mut middle, mut most, mut edges) = (Vec::new(), vec![0.0; n], Vec::new());
    let mut spent = 0;
    loop {
        let Some(mut node) = heap.pop() else { return Ok(Ok((goal.distance, spent))) };
        if node.bound >= goal.distance || spent >= boxes {
            return Ok(Ok((node.bound.min(goal.distance), spent)));
        }
        let piece = &pieces[node.piece];
        if !node.is_solved {
            spent += 1;
            node.is_solved = true;
            piece.tensions(&node.center, &mut middle);
            edges.clear();
            most.fill(0.0);
            for (edge, half) in piece.edges.iter().zip(&node.half) {
                edges.extend(edge.iter().map(|of| of * half));
                most.iter_mut().zip(edge).for_each(|(most, of)| *most += (of * half).abs());
            }
            let of = TensionBox { center: &middle, half: &most, edges: &edges };
            // Where a box is too large for a bound its parts may have one.
            let second = curvature.second_derivative(of, &mut memory);
            let remainder = second.map_or(f64::INFINITY, |second| 0.5 * second) + uncertainty;
            if remainder < reach {
                match forward.evaluate_answer(&middle, &[goal.place]) {
                    Ok(evaluation) => {
                        let tangent = Tangent {
                            center: middle.clone(),
                            miss: place_of(&evaluation.solution, goal.place) - goal.point,
                            motions: evaluation
                                .rates
                                .motions
                                .iter()
                                .map(|of| of[0].linear)
                                .collect(),
                            remainder,
                        };
                        let own = solver.bound(&tangent, piece, &node.center, &node.half);
                        node.bound = node.bound.max(own);
                        node.tangent = Some(Rc::new(tangent));
                    }
                    Err(error @ SolveError::Cancelled { .. }) => return Err(error),
                    // Without an answer in the middle of the box there is no bound of it; its parts may have one.
                    Err(_) => {}
                }
            }
            heap.push(node);
            continue;
        }
        // The coordinate along which the robot bends most.
        let bend = |i: usize| node.half[i] * weights[node.piece][i];
        let split = (0..n).max_by(|&a, &b| bend(a).total_cmp(&bend(b))).unwrap_or(0);
        for side in [-0.5, 0.5] {
            let mut center = node.center.clone();
            let mut half = node.half.clone();
            center[split] += side * half[split];
            half[split] *= 0.5;
            let of_whole = node.tangent.as_ref().map(|of| solver.bound(of, piece, &center, &half));
            let bound = of_whole.map_or(node.bound, |bound| bound.max(node.bound));
            let tangent = node.tangent.clone();
            // What is beyond the distance needs no box of its own.
            if bound >= goal.distance {
                continue;
            }
            heap.push(Node { bound, center, half, is_solved: false, tangent, piece: node.piece });
        }
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

/// The linear bound over a box.
#[derive(Default)]
struct Bound {
    solver: QuadraticProgramme,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    lower: Vec<f64>,
    rows: Vec<f64>,
    limits: Vec<f64>,
    step: Vec<f64>,
    tensions: Vec<f64>,
    /// Of the point with each coordinate.
    motions: Vec<Vec3>,
}

impl Bound {
    /// The least `n·(r + J d)` without the remainder, with the direction `n` of the least `‖r + J d‖` over what is within the limits of a box within that of the tangent; infinite
    /// where nothing is.
    fn bound(&mut self, tangent: &Tangent, piece: &Piece, center: &[f64], half: &[f64]) -> f64 {
        let Tangent { motions, remainder, .. } = tangent;
        let n = half.len();
        piece.tensions(center, &mut self.tensions);
        let moved = motions.iter().zip(self.tensions.iter().zip(&tangent.center));
        let miss =
            moved.fold(tangent.miss, |miss, (motion, (to, from))| miss + *motion * (to - from));
        self.motions.clear();
        self.motions.extend(piece.edges.iter().map(|edge| {
            let by = edge.iter().zip(motions).filter(|(by, _)| **by != 0.0);
            by.fold(Vec3::ZERO, |sum, (by, motion)| sum + *motion * *by)
        }));
        self.matrix.clear();
        self.gradient.clear();
        for a in &self.motions {
            self.matrix.extend(self.motions.iter().map(|b| a.dot(*b)));
            self.gradient.push(a.dot(miss));
        }
        let trace: f64 = (0..n).map(|i| self.matrix[i * n + i]).sum();
        for i in 0..n {
            self.matrix[i * n + i] += 1e-9 * trace;
        }
        self.lower.clear();
        self.lower.extend(half.iter().map(|h| -h));
        piece.rows(center, half, &mut self.rows, &mut self.limits);
        let programme = Programme {
            matrix: &self.matrix,
            gradient: &self.gradient,
            lower: &self.lower,
            upper: half,
            rows: &self.rows,
            limits: &self.limits,
        };
        let mut nearest = miss;
        if self.solver.minimise(&programme, &mut self.step).is_ok() {
            for (motion, d) in self.motions.iter().zip(&self.step) {
                nearest += *motion * *d;
            }
        }
        let mut best = f64::NEG_INFINITY;
        for direction in [nearest, miss] {
            let size = direction.norm();
            let along = direction * (1.0 / size.max(f64::MIN_POSITIVE));
            self.gradient.clear();
            self.gradient.extend(self.motions.iter().map(|motion| along.dot(*motion)));
            let Some(least) = piece.least(&self.gradient, center, half) else {
                return f64::INFINITY;
            };
            best = best.max(along.dot(miss) + least);
        }
        best - remainder
    }
}
