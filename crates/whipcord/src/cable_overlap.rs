//! Cables that pass through obstacles: models have no contact of cables, so that each answer is to be checked for it.

use whipcord_numerics::Vec3;

use crate::kind::ModelKind;
use crate::obstacle::{Obstacle, Surface};
use crate::robot::Robot;
use crate::shape::Shape;
use crate::solution::{CableState, Solution};

/// Overlap in m that is told of, as a part of the length of the backbone: a cable between two disks that touch a wall may lie in
/// it but for what the contacts overlap.
const LEAST_DEPTH: f64 = 1e-6;
/// How near to the deepest place bounds lead, as a part of the length of the backbone; the slope leads on from there.
const FOUND_TO: f64 = 1e-5;
/// The way on, as a part of the piece.
const LEFT: f64 = 0.03;
/// Straight pieces that a curved cable between two stations is cut into.
const PIECES: usize = 8;
/// The most distances that are measured along one piece of a cable: far more than any needs but one that runs along the
/// surface of an obstacle.
const MOST_DISTANCES: usize = 2000;

/// A taut cable that an answer leads through an obstacle: the deepest place in one span between two disks.
///
/// ```
/// # use whipcord::{Backbone, Cable, Case, Disks, Form, Material, Obstacle, Pose, Robot, Routing, Section, Vec3};
/// use whipcord::{Actuation, CableOverlap, Model, ModelKind, Statics, Stations};
///
/// # let material = Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
/// # let backbone = Backbone { section: Some(Section::circle(0.003)), material, ..Backbone::new(0.18) };
/// # let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// # let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 4, 0.008), vec![cable])?;
/// // A ball that reaches 1 mm across the cable, in the middle between two disks.
/// let ball = Obstacle {
///     name: "ball".to_owned(),
///     form: Form::Sphere { radius: 0.003 },
///     pose: Pose { position: Vec3::new(0.010, 0.0, 0.09), ..Pose::IDENTITY },
///     friction: 0.0,
///     movable: None,
/// };
/// let case = Case { obstacles: vec![ball], ..Case::with_tensions(&[0.01]) };
/// let model = Model::new(ModelKind::CosseratDisks, Stations::default(), Actuation::Tension);
/// let solution = model.solve(&robot, &case)?;
/// let overlap = &CableOverlap::all(&robot, &solution, &case.obstacles)[0];
/// assert_eq!((overlap.cable, overlap.span, overlap.obstacle), (0, 1, 0));
/// assert!((overlap.depth - 0.001).abs() < 1e-4 && (overlap.arc_length - 0.09).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableOverlap {
    /// The cable, by its number in the robot.
    pub cable: usize,
    /// The span between two disks, from 0 at the base.
    pub span: usize,
    /// The obstacle, by its number in [`crate::Case::obstacles`].
    pub obstacle: usize,
    /// Arc length in m of the deepest place.
    pub arc_length: f64,
    /// The deepest place, in the frame that the pose of the base is given in.
    pub point: Vec3,
    /// Unit normal out of the obstacle, in the same frame.
    pub normal: Vec3,
    /// How deep it is inside the obstacle, in m.
    pub depth: f64,
    /// The force in N that the cable would press the obstacle with if its holes stayed where they are: τ h (1/a + 1/b), with its
    /// tension τ, the depth h, and the distances a and b of the holes from the place. `None` from a model that knows no forces,
    /// and of a cable that does not run straight between disks.
    pub force: Option<f64>,
}

impl CableOverlap {
    /// The deepest place of each taut cable in each span and each of these obstacles, by cable, span and obstacle. Cables of
    /// the model `cosserat` run on the curves of their routings, which are known as well as the stations of the answer tell;
    /// those of all other models run straight from disk to disk, and the deepest place is exact.
    #[must_use]
    pub fn all(robot: &Robot, solution: &Solution, obstacles: &[Obstacle]) -> Vec<Self> {
        let mut found = Vec::new();
        let placed = solution.placed(obstacles);
        for (cable, (route, state)) in robot.routes().iter().zip(&solution.cables).enumerate() {
            if state.slack || obstacles.is_empty() {
                continue;
            }
            let path = Path::new(robot, solution, cable);
            for span in 0..robot.disks().arc_lengths.len().saturating_sub(1) {
                let pieces = path.of_span(span, route.end());
                for (number, obstacle) in placed.iter().enumerate() {
                    let each = pieces.iter().filter_map(|piece| path.deepest(piece, obstacle));
                    let deepest = each.max_by(|a, b| (-a.1.distance).total_cmp(&-b.1.distance));
                    let Some((at, surface)) = deepest else { continue };
                    found.push(Self {
                        cable,
                        span,
                        obstacle: number,
                        arc_length: at.0,
                        point: at.1,
                        normal: surface.normal,
                        depth: -surface.distance,
                        force: path.force(&pieces, state, span, at.1, -surface.distance),
                    });
                }
            }
        }
        found
    }
}

/// A straight piece of a cable: arc length and place of both ends.
type Piece = [(f64, Vec3); 2];

/// Where a cable runs.
struct Path<'a> {
    robot: &'a Robot,
    cable: usize,
    /// The stations that tell most of it.
    shape: &'a Shape,
    disks: &'a Shape,
    is_straight: bool,
}

impl<'a> Path<'a> {
    fn new(robot: &'a Robot, solution: &'a Solution, cable: usize) -> Self {
        let is_finer = solution.shape.poses.len() > solution.disks.poses.len();
        Self {
            robot,
            cable,
            shape: if is_finer { &solution.shape } else { &solution.disks },
            disks: &solution.disks,
            is_straight: solution.model != ModelKind::Cosserat,
        }
    }

    fn at(&self, shape: &Shape, arc_length: f64) -> (f64, Vec3) {
        let offset = self.robot.routes()[self.cable].at(arc_length).offset;
        (arc_length, shape.at(arc_length).transform(offset))
    }

    /// The pieces in a span of a cable that ends at this arc length.
    fn of_span(&self, span: usize, end: f64) -> Vec<Piece> {
        let places = &self.robot.disks().arc_lengths;
        let (from, to) = (places[span], places[span + 1].min(end));
        if to <= from {
            return Vec::new();
        }
        if self.is_straight {
            // An anchor between two disks is where the finer of the shapes has it.
            let shape = if to == places[span + 1] { self.disks } else { self.shape };
            return vec![[self.at(self.disks, from), self.at(shape, to)]];
        }
        let inside = self.shape.arc_length.iter().copied().filter(|s| (from..to).contains(s));
        let mut ends = vec![from];
        ends.extend(inside.filter(|s| *s > from));
        ends.push(to);
        let cut = |pair: &[f64]| {
            let (a, b) = (pair[0], pair[1]);
            (0..PIECES).map(move |k| [k, k + 1].map(|k| a + (b - a) * k as f64 / PIECES as f64))
        };
        let cuts: Vec<[f64; 2]> = ends.windows(2).flat_map(cut).collect();
        cuts.into_iter().map(|ends| ends.map(|s| self.at(self.shape, s))).collect()
    }

    /// The deepest place of a piece in an obstacle; `None` where it stays clear of it. The distance changes by no more than the
    /// way, which bounds it between two places where it is known: intervals whose bound is not deeper than what is found are left
    /// out, the others are halved.
    fn deepest(&self, piece: &Piece, obstacle: &Obstacle) -> Option<((f64, Vec3), Surface)> {
        let length = self.robot.backbone().length;
        let [(from, a), (to, b)] = *piece;
        let chord = (b - a).norm();
        let at = |t: f64| (from + (to - from) * t, a + (b - a) * t);
        let measure = |t: f64| obstacle.surface(at(t).1);
        let ends = [measure(0.0), measure(1.0)];
        let mut best =
            if ends[0].distance <= ends[1].distance { (0.0, ends[0]) } else { (1.0, ends[1]) };
        let mut waiting = vec![(0.0, ends[0].distance, 1.0, ends[1].distance)];
        let mut measured = 0;
        while let Some((t0, d0, t1, d1)) = waiting.pop() {
            let bound = 0.5 * (d0 + d1 - chord * (t1 - t0));
            // Nothing less deep counts.
            let counts = (best.1.distance - FOUND_TO * length).min(-LEAST_DEPTH * length);
            if bound >= counts || measured >= MOST_DISTANCES {
                continue;
            }
            let middle = 0.5 * (t0 + t1);
            let surface = measure(middle);
            measured += 1;
            if surface.distance < best.1.distance {
                best = (middle, surface);
            }
            // The half that may be deeper is looked at first.
            let halves = [(t0, d0, middle, surface.distance), (middle, surface.distance, t1, d1)];
            let [first, second] = if d0 < d1 { halves } else { [halves[1], halves[0]] };
            waiting.extend([second, first]);
        }
        if best.1.distance >= -LEAST_DEPTH * length {
            return None;
        }
        let (mut low, mut high) = ((best.0 - LEFT).max(0.0), (best.0 + LEFT).min(1.0));
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let surface = measure(middle);
            if surface.distance < best.1.distance {
                best = (middle, surface);
            }
            if surface.normal.dot(b - a) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some((at(best.0), best.1))
    }

    fn force(
        &self,
        pieces: &[Piece],
        state: &CableState,
        span: usize,
        point: Vec3,
        depth: f64,
    ) -> Option<f64> {
        let tension = state.span_tensions.get(span).copied().or(state.tension)?;
        let [from, to] = pieces.first().filter(|_| self.is_straight)?;
        let [a, b] = [from, to].map(|end| (end.1 - point).norm());
        let force = tension * depth * (1.0 / a + 1.0 / b);
        force.is_finite().then_some(force)
    }
}
