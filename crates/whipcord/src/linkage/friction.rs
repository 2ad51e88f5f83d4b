//! The chain with a tension for every passage, for [`crate::statics::friction`].
//!
//! The passages are numbered as if each were a cable of its own: [`super::chain`] then gives lengths and responses of each.

use whipcord_numerics::Vec3;

use super::chain::Chain;
use super::division::Division;
use super::layout::{Section, rest_lengths};
use super::motion::{Coordinates, MOST, Motion};
use super::statics::{Effort, Scratch};
use super::task::{Asked, Elimination, Task};
use crate::budget::Meter;
use crate::robot::{Cable, Robot};
use crate::section::{Fault, SectionFault};
use crate::statics::friction::{
    Course, FrictionScratch, History, Holes, PassageResponse, Passages, Response,
};
use crate::statics::outcome::Failure;

/// An angle so small, in rad, has no direction.
const STRAIGHT: f64 = 1e-9;
/// A coordinate changes by no more than this in one step, in rad.
const LONGEST_STEP: f64 = 0.8;

/// The holes of a robot with friction.
#[derive(Clone, Debug)]
pub(super) struct Rubbing {
    pub holes: Holes,
    /// With every passage as a cable of its own.
    pub sections: Vec<Section>,
    /// The same, but the passages of a cable without friction as one, under the number of the first.
    pub strands: Vec<Section>,
    /// Lengths of all passages on the robot at rest in m.
    pub rest: Vec<f64>,
}

/// Memory of a solve.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    pub history: History<Vec<Coordinates>>,
    pub scratch: FrictionScratch,
    pub course: Course<Vec<Coordinates>>,
    /// How many steps of the case were taken.
    pub taken: usize,
    pub before: Vec<Coordinates>,
    pub step: Vec<Coordinates>,
    pub turned: Turned,
}

/// How the angles in the near holes of all passages change with the coordinates of the section of each, and with those of
/// the one before.
#[derive(Clone, Debug, Default)]
pub(super) struct Turned {
    own: Vec<Coordinates>,
    before: Vec<Coordinates>,
}

impl Rubbing {
    /// Of these sections of a robot; `None` where no cable rubs.
    pub fn new(robot: &Robot, division: &Division, sections: &[Section]) -> Option<Self> {
        let rubs = robot.cables().iter().any(Cable::has_friction);
        rubs.then(|| Self::of(robot, division, sections))
    }

    /// Of these sections of a robot; where no cable rubs each is one passage.
    pub fn of(robot: &Robot, division: &Division, sections: &[Section]) -> Self {
        let cables = robot.cables();
        let length = robot.backbone().length;
        let passages = || sections.iter().flat_map(|section| &section.passages);
        let lever = passages().map(|p| p.near.norm()).fold(1e-3 * length, f64::max);
        let bending = |a: usize| sections.iter().map(move |s| s.stiffness[a] * s.length);
        let softest = bending(1).chain(bending(2)).fold(f64::INFINITY, f64::min);
        let compliance = lever * lever * length / softest;
        if !cables.iter().any(Cable::has_friction) {
            let rest = rest_lengths(division, sections, cables.len());
            let whole = rest.iter().copied().enumerate();
            let holes = Holes::of_whole_cables(robot, whole, compliance);
            let (sections, strands) = (sections.to_vec(), sections.to_vec());
            return Self { holes, sections, strands, rest };
        }
        let of_cable: Vec<usize> = passages().map(|passage| passage.cable).collect();
        let numbered = |number: &dyn Fn(usize) -> usize| {
            let mut sections = sections.to_vec();
            let passages = sections.iter_mut().flat_map(|section| &mut section.passages);
            for (p, passage) in passages.enumerate() {
                passage.cable = number(p);
            }
            sections
        };
        let first = |p: usize| {
            let is_same = |&cable: &usize| cable == of_cable[p] && !cables[cable].has_friction();
            of_cable.iter().position(is_same).unwrap_or(p)
        };
        let (strands, sections) = (numbered(&first), numbered(&|p| p));
        let lengths = rest_lengths(division, &sections, of_cable.len());
        let pieces = of_cable.iter().copied().zip(lengths.iter().copied());
        let holes = Holes::new(robot, pieces, length, compliance);
        Self { holes, sections, strands, rest: lengths }
    }

    /// The failure of a chain with passages for cables, as one of the cables.
    pub fn of_cables(&self, failure: Failure) -> Failure {
        of_cables(&self.holes, failure)
    }
}

fn of_cables(holes: &Holes, failure: Failure) -> Failure {
    match failure {
        Failure::Folds { cable: passage, arc_length, tension, last_load } => {
            let is_of = |passages: &Vec<usize>| passages.contains(&passage);
            let cable = holes.of_cable.iter().position(is_of).unwrap_or_default();
            Failure::Folds { cable, arc_length, tension, last_load }
        }
        other => other,
    }
}

/// The chain as what answers the tensions of all passages.
pub(super) struct RubbingChain<'a> {
    pub task: Task<'a>,
    pub holes: &'a Holes,
    pub scratch: &'a mut Scratch,
    pub tolerance: f64,
    /// Where a step begins, and the step.
    pub before: &'a mut Vec<Coordinates>,
    pub step: &'a mut Vec<Coordinates>,
    pub turned: &'a mut Turned,
}

impl PassageResponse for RubbingChain<'_> {
    type Shape = Vec<Coordinates>;

    fn shape(&self) -> Vec<Coordinates> {
        self.scratch.chain.q.clone()
    }

    fn set_shape(&mut self, shape: &Vec<Coordinates>) {
        self.scratch.chain.q.clone_from(shape);
    }

    fn converge(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        let task = Task { tensions, ..self.task };
        let converged = self.scratch.converge(&task, self.tolerance);
        converged.map(|_| ()).map_err(|failure| of_cables(self.holes, failure))
    }

    fn measure(&mut self, tensions: &[f64], at: &mut Passages) -> Result<f64, Fault> {
        let task = Task { tensions, ..self.task };
        let chain = &mut self.scratch.chain;
        let residual = chain.evaluate(&task);
        task.meter.integrate(task.sections.len());
        if !residual.is_finite() {
            return Err(Fault { kind: SectionFault::Diverged, arc_length: 0.0 });
        }
        at.lengths.clone_from(&chain.lengths);
        self.turned.measure(chain, &task, self.holes, &mut at.turns);
        Ok(residual)
    }

    fn respond(&mut self, tensions: &[f64], response: &mut Response) -> bool {
        let task = Task { tensions, ..self.task };
        let chain = &mut self.scratch.chain;
        chain.linearise(&task);
        let how = Elimination { shift: 0.0, asked: Asked::Responses };
        if chain.eliminate(&task, how).is_none() {
            return false;
        }
        self.turned.responses(chain, &task, response);
        true
    }

    fn prepare(&mut self, changes: &[f64]) -> Option<f64> {
        let chain = &self.scratch.chain;
        let n = chain.q.len();
        self.before.clone_from(&chain.q);
        let (closing, responses) = chain.steps.split_at(n);
        self.step.clear();
        self.step.extend_from_slice(closing);
        for (change, response) in changes.iter().zip(responses.chunks(n)) {
            for (x, by) in self.step.iter_mut().flatten().zip(response.iter().flatten()) {
                *x += change * by;
            }
        }
        let longest = self.step.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let is_finite = self.step.iter().flatten().all(|x| x.is_finite());
        is_finite.then(|| (LONGEST_STEP / longest).min(1.0))
    }

    fn go(&mut self, fraction: f64) {
        let steps = self.before.iter().flatten().zip(self.step.iter().flatten());
        for (q, (start, step)) in self.scratch.chain.q.iter_mut().flatten().zip(steps) {
            *q = start + fraction * step;
        }
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn meter(&self) -> &Meter {
        self.task.meter
    }

    fn failure(&self, _: Fault, tensions: &[f64]) -> Failure {
        let task = Task { tensions, ..self.task };
        of_cables(self.holes, self.scratch.failure(&task, 0.0, Effort::default()))
    }
}

impl Turned {
    /// The rows of the derivatives by all coordinates of the chain.
    pub(super) fn rows(&self, task: &Task<'_>, rows: &mut Vec<f64>) {
        let count = task.division.coordinates();
        let n = count * task.sections.len();
        let mut p = 0;
        for (k, section) in task.sections.iter().enumerate() {
            for _ in &section.passages {
                let first = rows.len();
                rows.resize(first + n, 0.0);
                let row = &mut rows[first..];
                row[k * count..(k + 1) * count].copy_from_slice(&self.own[p][..count]);
                if let Some(before) = k.checked_sub(1) {
                    row[before * count..k * count].copy_from_slice(&self.before[p][..count]);
                }
                p += 1;
            }
        }
    }

    /// The responses of the last elimination to the tensions, and to closing the residual.
    pub(super) fn responses(&self, chain: &Chain, task: &Task<'_>, response: &mut Response) {
        let n = task.tensions.len();
        let wide = n + 1;
        for rows in [&mut response.lengths, &mut response.turns] {
            rows.clear();
            rows.resize(n * wide, 0.0);
        }
        // The first side closes the residual, which is the last column.
        for side in 0..wide {
            let column = side.checked_sub(1).unwrap_or(n);
            chain.add_lengths(task, side, |p, by| response.lengths[p * wide + column] += by);
            self.by_response(chain, task, side, |p, by| {
                response.turns[p * wide + column] = by;
            });
        }
    }

    /// How the angle in the near hole of every passage changes with a response of the last elimination.
    pub(super) fn by_response(
        &self,
        chain: &Chain,
        task: &Task<'_>,
        side: usize,
        mut tell: impl FnMut(usize, f64),
    ) {
        let product = |by: &Coordinates, response: &[f64]| -> f64 {
            by.iter().zip(response).map(|(by, change)| by * change).sum()
        };
        let mut p = 0;
        for (k, section) in task.sections.iter().enumerate() {
            let own = chain.response(task, side, k);
            let before = k.checked_sub(1).map(|k| chain.response(task, side, k));
            for _ in &section.passages {
                let turned = before.map_or(0.0, |q| product(&self.before[p], q));
                tell(p, product(&self.own[p], own) + turned);
                p += 1;
            }
        }
    }

    /// The angles where the chain was evaluated last, and their derivatives.
    pub(super) fn measure(
        &mut self,
        chain: &Chain,
        task: &Task<'_>,
        holes: &Holes,
        turns: &mut Vec<f64>,
    ) {
        let n = holes.count();
        turns.resize(n, 0.0);
        for rows in [&mut self.own, &mut self.before] {
            rows.clear();
            rows.resize(n, [0.0; MOST]);
        }
        let count = task.division.coordinates();
        for passages in &holes.of_cable {
            // The direction of the piece before at the disk, and how it changes with the coordinates of its section.
            let (mut coming, mut coming_by) = (Vec3::Z, [Vec3::ZERO; MOST]);
            for (k, &p) in passages.iter().enumerate() {
                let section = &task.sections[k];
                let Some(passage) = section.passages.iter().find(|passage| passage.cable == p)
                else {
                    continue;
                };
                let inside;
                let motion = if passage.is_anchored_inside() {
                    inside =
                        Motion::up_to(task.division, section.length, &chain.q[k], passage.reach);
                    &inside
                } else {
                    chain.motion(k)
                };
                let way = motion.way(passage);
                let length = way.norm();
                let going = way / length;
                let arm = motion.rotation * passage.far;
                let (sine, cosine) = (coming.cross(going).norm(), coming.dot(going));
                turns[p] = sine.atan2(cosine);
                let slope = if sine > STRAIGHT { -1.0 / sine } else { 0.0 };
                let back = motion.rotation.transpose();
                let mut next_by = [Vec3::ZERO; MOST];
                for a in 0..count {
                    let moved = motion.shift[a] + motion.turn[a].cross(arm);
                    let going_by = (moved - going * going.dot(moved)) / length;
                    self.own[p][a] = slope * coming.dot(going_by);
                    self.before[p][a] = slope * going.dot(coming_by[a]);
                    next_by[a] = back * (going_by - motion.turn[a].cross(going));
                }
                (coming, coming_by) = (back * going, next_by);
            }
        }
    }
}
