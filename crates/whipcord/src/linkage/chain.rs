//! The chain of sections: its equilibrium and the linear system of a Newton step, from tip to base.

use whipcord_numerics::{DenseLu, Mat3, Vec3};

use super::layout::Section;
use super::loads::InnerLoad;
use super::motion::{Coordinates, MOST, MOST_BENT, Motion, bend};
use super::pivots::negative_pivots;
use super::place_wrench::PlaceWrench;
use super::task::{Asked, Elimination, Right, Task};
use crate::shape::Wrench;

/// A matrix row of each coordinate.
type Rows<T> = [T; MOST];

/// One section in the chain, in the frame of the disk at its start.
#[derive(Clone, Debug, Default)]
struct Link {
    motion: Motion,
    /// What all loads beyond exert on its end, about that end.
    wrench: Wrench,
    /// Left of eq. (3).
    residual: Coordinates,
    /// `∂residual/∂q`, eq. (5).
    tangent: Rows<[f64; MOST]>,
    /// `∂q/∂θ` by a turn θ of the disk at its start.
    by_turn: Rows<Vec3>,
}

/// A cross-section between two disks that a load acts on, in the frame of the disk at the section's start.
#[derive(Clone, Debug, Default)]
struct Inner {
    motion: Motion,
    /// What is applied to it.
    load: Wrench,
    /// The part of the force that turns with the cross-section.
    follower: Vec3,
    /// What a turn of the cross-section does to the moment.
    moment_by: Mat3,
}

/// Memory of the iteration, and the point it is at.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    /// Coordinates of all sections.
    pub q: Vec<Coordinates>,
    /// Length of each cable in m.
    pub lengths: Vec<f64>,
    /// What the loads exert on the base.
    pub base: Wrench,
    /// Step of the coordinates, section by section; behind it, where asked for, the response to each
    /// cable's tension.
    pub steps: Vec<Coordinates>,
    links: Vec<Link>,
    /// Of all inner loads, from the base on.
    inner: Vec<Inner>,
    /// `∂ℓ/∂q` of every passage.
    pulls: Vec<Coordinates>,
    /// The cross-sections that cables are anchored to between two disks, from the base on.
    anchors: Vec<Motion>,
    matrix: Vec<f64>,
    lu: DenseLu,
    column: Vec<f64>,
    /// Of each right-hand side what the part beyond does to force and moment.
    beyond: Vec<[Vec3; 2]>,
    turns: Vec<Vec3>,
}

/// A step among obstacles changes no coordinate by more than this in rad.
const LONGEST: f64 = 0.3;

/// Cables shorter than this fraction of their section have folded it.
const FOLDED: f64 = 1e-6;

impl Chain {
    /// The chain at rest.
    pub fn rest(&mut self, sections: &[Section]) {
        self.q.clear();
        self.q.extend(sections.iter().map(|section| section.rest));
    }

    /// Evaluates eq. (3) at the coordinates. The size of what is left, relative to the moments in play;
    /// infinite where a cable has folded its section.
    pub fn evaluate(&mut self, task: &Task<'_>) -> f64 {
        let Self { q, lengths, base, links, pulls, anchors, inner, .. } = self;
        inner.clear();
        anchors.clear();
        let (division, count) = (task.division, task.division.coordinates());
        links.resize(task.sections.len(), Link::default());
        lengths.clear();
        lengths.resize(task.tensions.len(), 0.0);
        pulls.clear();
        let (mut scale, mut softest) = (0.0_f64, f64::INFINITY);
        let mut folded = false;
        let mut whole = 0.0;
        for ((section, link), q) in task.sections.iter().zip(&mut *links).zip(&*q) {
            whole += section.length;
            let motion = Motion::new(division, section.length, q);
            folded |= bend(q) > MOST_BENT || q[0].abs() > division.most_twist();
            link.residual = section.elastic_moments(division, q);
            for stiffness in &section.stiffness[..count] {
                softest = softest.min(stiffness * section.length);
            }
            let mut pulled = 0.0;
            for passage in &section.passages {
                let end = if passage.is_anchored_inside() {
                    anchors.push(Motion::up_to(division, section.length, q, passage.reach));
                    anchors.last().unwrap_or(&motion)
                } else {
                    &motion
                };
                let way = end.way(passage);
                let length = way.norm();
                folded |= length <= FOLDED * section.length * passage.reach || !length.is_finite();
                let along = way / length;
                lengths[passage.cable] += length;
                let tension = task.pull * task.tensions[passage.cable];
                let arm = end.rotation * passage.far;
                let mut pull = [0.0; MOST];
                for a in 0..count {
                    pull[a] = along.dot(end.shift[a] + end.turn[a].cross(arm));
                    link.residual[a] += tension * pull[a];
                }
                pulled += tension * passage.far.norm();
                pulls.push(pull);
            }
            scale = scale.max(pulled);
            link.motion = motion;
        }
        // The loads, from the tip to the base.
        let mut rotations = Mat3::diagonal(Vec3::new(1.0, 1.0, 1.0));
        self.turns.clear();
        for (k, (link, (section, q))) in
            links.iter_mut().zip(task.sections.iter().zip(&*q)).enumerate()
        {
            let axes: [Vec3; 3] = core::array::from_fn(|j| rotations.column(j));
            for load in task.loads.inside(k) {
                let motion = Motion::up_to(division, section.length, q, load.at);
                inner.push(Inner::new(motion, load, &axes, task));
            }
            // The frame of the disk at its end, by rows of its transpose.
            rotations = rotations * link.motion.rotation;
            self.turns.extend((0..3).map(|j| rotations.column(j)));
        }
        let mut wrench = Wrench::default();
        let mut left = inner.len();
        for (k, link) in links.iter_mut().enumerate().rev() {
            let own = applied(task, k + 1, &self.turns[3 * k..3 * k + 3]);
            let turn = &link.motion.rotation;
            wrench = Wrench {
                force: *turn * (wrench.force + own.force),
                moment: *turn * (wrench.moment + own.moment),
            };
            link.wrench = wrench;
            for a in 0..count {
                link.residual[a] -=
                    wrench.moment.dot(link.motion.turn[a]) + wrench.force.dot(link.motion.shift[a]);
            }
            wrench.moment += link.motion.end.cross(wrench.force);
            let first = left - task.loads.inside(k).len();
            for Inner { motion, load, .. } in &inner[first..left] {
                for a in 0..count {
                    link.residual[a] -=
                        load.moment.dot(motion.turn[a]) + load.force.dot(motion.shift[a]);
                }
                wrench.force += load.force;
                wrench.moment += load.moment + motion.end.cross(load.force);
            }
            left = first;
            scale = scale.max(wrench.moment.norm());
        }
        *base = wrench;
        let left = links.iter().flat_map(|link| &link.residual[..count]);
        let worst =
            left.fold(0.0_f64, |worst, x| if x.is_nan() { f64::NAN } else { worst.max(x.abs()) });
        let relative = worst / (softest / whole + scale);
        if folded || !relative.is_finite() { f64::INFINITY } else { relative }
    }

    /// Fills the tangent of each section for what was evaluated last, eq. (5).
    pub fn linearise(&mut self, task: &Task<'_>) {
        let (division, count) = (task.division, task.division.coordinates());
        let mut pulls = self.pulls.iter();
        let mut anchors = self.anchors.iter();
        let mut inner = self.inner.iter();
        let sections = task.sections.iter().zip(&self.q);
        for (k, ((section, q), link)) in sections.zip(&mut self.links).enumerate() {
            let Link { motion, wrench, tangent, .. } = link;
            let (mut force, mut moment) = (wrench.force, wrench.moment);
            *tangent = Default::default();
            for (passage, pull) in section.passages.iter().zip(&mut pulls) {
                let inside = passage.is_anchored_inside().then(|| anchors.next()).flatten();
                let tension = task.pull * task.tensions[passage.cable];
                if tension == 0.0 {
                    continue;
                }
                let end = inside.unwrap_or(motion);
                let way = end.way(passage);
                let length = way.norm();
                let along = way / length;
                let arm = end.rotation * passage.far;
                let pulled =
                    Wrench { force: along * -tension, moment: arm.cross(along) * -tension };
                let own = inside
                    .map(|end| end.second(division, section.length, pulled.moment, pulled.force));
                if own.is_none() {
                    force += pulled.force;
                    moment += pulled.moment;
                }
                let moves: Rows<Vec3> =
                    core::array::from_fn(|a| end.shift[a] + end.turn[a].cross(arm));
                for a in 0..count {
                    for b in 0..count {
                        let swings = moves[a].dot(moves[b]) - pull[a] * pull[b];
                        let turned = end.turn[a].cross(end.turn[b].cross(arm));
                        tangent[a][b] += tension * (swings / length + along.dot(turned));
                        tangent[a][b] -= own.map_or(0.0, |own| own[a][b]);
                    }
                }
            }
            let second = motion.second(division, section.length, moment, force);
            section.add_elastic_stiffness(division, q, tangent);
            for a in 0..count {
                for b in 0..count {
                    tangent[a][b] -= second[a][b];
                }
            }
            let inside = (&mut inner).take(task.loads.inside(k).len());
            for Inner { motion, load, follower, moment_by } in inside {
                let second = motion.second(division, section.length, load.moment, load.force);
                for a in 0..count {
                    let (turn, shift) = (motion.turn[a], motion.shift[a]);
                    let by = follower.cross(shift) + moment_by.transpose_mul(turn);
                    for b in 0..count {
                        tangent[a][b] -= second[a][b] + by.dot(motion.turn[b]);
                    }
                }
            }
        }
    }

    /// Takes apart what was linearised last, and solves for the Newton step where that is asked, eqs. (6) and (7).
    /// The number of negative pivots, which is that of negative eigenvalues where the tangent is symmetric; `None`
    /// where it is singular.
    pub fn eliminate(&mut self, task: &Task<'_>, how: Elimination) -> Option<usize> {
        let sides = match how.asked {
            Asked::Signs => 0,
            Asked::Step => 1,
            Asked::Responses => 1 + task.tensions.len(),
        };
        self.eliminate_with(task, how.shift, sides, |side| {
            side.checked_sub(1).map_or(Right::Closing, Right::Tension)
        })
    }

    /// The same with the responses to the tensions, and to these wrenches behind them, eq. (11).
    pub fn eliminate_with_wrenches(
        &mut self,
        task: &Task<'_>,
        pushes: &[PlaceWrench],
    ) -> Option<usize> {
        let cables = task.tensions.len();
        self.eliminate_with(task, 0.0, 1 + cables + pushes.len(), |side| match side {
            0 => Right::Closing,
            side if side <= cables => Right::Tension(side - 1),
            side => Right::Push(&pushes[side - 1 - cables]),
        })
    }

    /// The same at a shift of the tangent, with so many right-hand sides.
    pub fn eliminate_with<'r>(
        &mut self,
        task: &Task<'_>,
        shift: f64,
        sides: usize,
        right: impl Fn(usize) -> Right<'r>,
    ) -> Option<usize> {
        let (count, n) = (task.division.coordinates(), task.sections.len());
        self.steps.clear();
        self.steps.resize(sides * n, [0.0; MOST]);
        self.beyond.clear();
        self.beyond.resize(sides, [Vec3::ZERO; 2]);
        // What a turn of the disk does to force and moment beyond it.
        let (mut force_by, mut moment_by) = (Mat3::default(), Mat3::default());
        let mut negative = 0;
        let mut first = self.pulls.len();
        let mut left = self.inner.len();
        for k in (0..n).rev() {
            let section = &task.sections[k];
            first -= section.passages.len();
            let own = task.loads.followers[k + 1];
            let dead = seen_from(&self.turns[3 * k..3 * k + 3], task.loads.dead[k + 1].moment);
            let own_by = task.moments.by_turn(own.moment * task.load, dead * task.load);
            let inside = left - task.loads.inside(k).len()..left;
            left = inside.start;
            let inside = &self.inner[inside];
            let link = &mut self.links[k];
            let turn = link.motion.rotation;
            let back = turn.transpose();
            force_by = turn * (force_by - Mat3::skew(own.force * task.load)) * back;
            moment_by = turn * (moment_by + own_by) * back;
            let Link { motion, wrench, residual, tangent, by_turn } = link;
            self.matrix.clear();
            for a in 0..count {
                let (by_moment, by_force) = (
                    moment_by.transpose_mul(motion.turn[a]),
                    force_by.transpose_mul(motion.shift[a]),
                );
                for b in 0..count {
                    let own = if a == b { shift * section.stiffness[a] } else { 0.0 };
                    let beyond = (by_moment + by_force).dot(motion.turn[b]);
                    self.matrix.push(tangent[a][b] - own - beyond);
                }
                by_turn[a] = by_moment
                    + by_force
                    + motion.turn[a].cross(wrench.moment)
                    + motion.shift[a].cross(wrench.force);
                for Inner { motion, load, follower, moment_by } in inside {
                    by_turn[a] += motion.turn[a].cross(load.moment)
                        + moment_by.transpose_mul(motion.turn[a])
                        + motion.shift[a].cross(load.force - *follower);
                }
            }
            negative += negative_pivots(count, &self.matrix, &mut self.column)?;
            self.lu.factor(count, &self.matrix).ok()?;
            // So small a matrix is multiplied with faster than solved for.
            let mut inverse: Rows<Coordinates> = [[0.0; MOST]; MOST];
            for b in 0..count {
                self.column.clear();
                self.column.resize(count, 0.0);
                self.column[b] = 1.0;
                self.lu.solve(&mut self.column);
                for (row, x) in inverse.iter_mut().zip(&self.column) {
                    row[b] = *x;
                }
            }
            for j in 0..3 {
                self.column.clear();
                self.column.extend(by_turn[..count].iter().map(|row| row[j]));
                self.lu.solve(&mut self.column);
                for a in 0..count {
                    by_turn[a][j] = self.column[a];
                }
            }
            let (mut turned, mut moved) = (Mat3::default(), Mat3::default());
            for a in 0..count {
                turned += Mat3::outer(motion.turn[a], by_turn[a]);
                moved += Mat3::outer(motion.shift[a], by_turn[a]);
            }
            let arm = Mat3::skew(motion.end);
            let (old_force_by, old_moment_by) = (force_by, moment_by);
            force_by = old_force_by * turned.plus_identity();
            moment_by = old_moment_by * turned.plus_identity()
                - Mat3::skew(wrench.force) * (moved - arm)
                + arm * force_by;
            for Inner { motion, load, follower, moment_by: own_by } in inside {
                let (mut turned, mut moved) = (Mat3::default(), -Mat3::skew(motion.end));
                for a in 0..count {
                    turned += Mat3::outer(motion.turn[a], by_turn[a]);
                    moved += Mat3::outer(motion.shift[a], by_turn[a]);
                }
                let turned = turned.plus_identity();
                let by_force = -Mat3::skew(*follower) * turned;
                force_by += by_force;
                moment_by += *own_by * turned - Mat3::skew(load.force) * moved
                    + Mat3::skew(motion.end) * by_force;
            }
            for side in 0..sides {
                let right = right(side);
                let push = match right {
                    // What acts nearer to the base bends nothing here by itself.
                    Right::Push(push) if push.section < k => continue,
                    Right::Unit { section, .. } if section < k => continue,
                    // Nor does a cable beyond its end.
                    Right::Tension(cable)
                        if self.beyond[side] == [Vec3::ZERO; 2]
                            && section.passages.iter().all(|passage| passage.cable != cable) =>
                    {
                        continue;
                    }
                    Right::Push(push) if push.section == k => Some(push),
                    _ => None,
                };
                let beyond = self.beyond[side].map(|v| turn * v);
                self.column.clear();
                for a in 0..count {
                    let through = motion.shift[a].dot(beyond[0]) + motion.turn[a].dot(beyond[1]);
                    let own = match right {
                        Right::Closing => -residual[a],
                        Right::Given(given) => given[k][a],
                        Right::Unit { section, coordinate } if section == k && coordinate == a => {
                            1.0
                        }
                        Right::Tension(_) | Right::Push(_) | Right::Unit { .. } => 0.0,
                    };
                    self.column.push(own + through);
                }
                if let Right::Tension(cable) = right {
                    let passing = section.passages.iter().zip(&self.pulls[first..]);
                    for (_, pull) in passing.filter(|(passage, _)| passage.cable == cable) {
                        for (x, pull) in self.column.iter_mut().zip(pull) {
                            *x -= pull;
                        }
                    }
                }
                if let Some(PlaceWrench { work, .. }) = push {
                    self.column.iter_mut().zip(work).for_each(|(x, work)| *x += work);
                }
                let step = &mut self.steps[side * n + k];
                for (x, row) in step[..count].iter_mut().zip(&inverse) {
                    *x = row.iter().zip(&self.column).map(|(by, right)| by * right).sum();
                }
                let (mut turned, mut moved) = (Vec3::ZERO, Vec3::ZERO);
                for a in 0..count {
                    turned += motion.turn[a] * step[a];
                    moved += motion.shift[a] * step[a];
                }
                let mut force = beyond[0] + old_force_by * turned;
                let mut moment = beyond[1]
                    + old_moment_by * turned
                    + moved.cross(wrench.force)
                    + motion.end.cross(force);
                for Inner { motion, load, follower, moment_by } in inside {
                    let (mut turned, mut moved) = (Vec3::ZERO, Vec3::ZERO);
                    for a in 0..count {
                        turned += motion.turn[a] * step[a];
                        moved += motion.shift[a] * step[a];
                    }
                    let change = turned.cross(*follower);
                    force += change;
                    moment +=
                        *moment_by * turned + moved.cross(load.force) + motion.end.cross(change);
                }
                if let Some(PlaceWrench { about_start, .. }) = push {
                    force += about_start.force;
                    moment += about_start.moment;
                }
                self.beyond[side] = [force, moment];
            }
        }
        self.substitute(count, n, sides);
        let finite = self.steps.iter().flatten().all(|x| x.is_finite());
        finite.then_some(negative)
    }

    /// From the base, which does not turn, to the tip.
    fn substitute(&mut self, count: usize, n: usize, sides: usize) {
        for side in 0..sides {
            let mut theta = Vec3::ZERO;
            for (link, step) in self.links.iter().zip(&mut self.steps[side * n..(side + 1) * n]) {
                let mut ahead = theta;
                for a in 0..count {
                    step[a] += link.by_turn[a].dot(theta);
                    ahead += link.motion.turn[a] * step[a];
                }
                theta = link.motion.rotation.transpose_mul(ahead);
            }
        }
    }

    /// What was left of eq. (3) where it was evaluated last.
    pub fn residuals(&self) -> Vec<Coordinates> {
        self.links.iter().map(|link| link.residual).collect()
    }

    /// How a section moves where it was evaluated last.
    pub fn motion(&self, section: usize) -> &Motion {
        &self.links[section].motion
    }

    /// Takes a part of a step: of the responses of the last elimination, each times its weight. A coordinate changes by no
    /// more than [`LONGEST`].
    pub fn advance(&mut self, weights: &[f64], part: f64) -> f64 {
        let n = self.q.len();
        let (step, responses) = self.steps.split_at_mut(n);
        step.iter_mut().flatten().for_each(|x| *x *= weights[0]);
        for (weight, response) in weights[1..].iter().zip(responses.chunks(n)) {
            for (x, response) in step.iter_mut().flatten().zip(response.iter().flatten()) {
                *x += weight * response;
            }
        }
        let longest = step.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let part = if part * longest > LONGEST { LONGEST / longest } else { part };
        for (q, step) in self.q.iter_mut().flatten().zip(step.iter().flatten()) {
            *q += part * step;
        }
        part
    }

    /// `∂ℓ/∂q` where it was evaluated last: a row for each cable, section by section.
    pub fn length_rates(&self, task: &Task<'_>) -> Vec<f64> {
        let count = task.division.coordinates();
        let n = count * task.sections.len();
        let mut rates = vec![0.0; task.tensions.len() * n];
        let mut pulls = self.pulls.iter();
        for (k, section) in task.sections.iter().enumerate() {
            for (passage, pull) in section.passages.iter().zip(&mut pulls) {
                let at = passage.cable * n + k * count;
                rates[at..at + count].copy_from_slice(&pull[..count]);
            }
        }
        rates
    }

    /// What the loads exert on the base more, in the last elimination.
    pub fn base_response(&self, side: usize) -> Wrench {
        let [force, moment] = self.beyond[side];
        Wrench { force, moment }
    }

    /// How the coordinates of a section change, of the last elimination.
    pub fn response(&self, task: &Task<'_>, side: usize, section: usize) -> &[f64] {
        let step = &self.steps[side * task.sections.len() + section];
        &step[..task.division.coordinates()]
    }

    /// How the lengths of the cables change with that, in m.
    pub fn lengths_by(&self, task: &Task<'_>, side: usize) -> Vec<f64> {
        let mut lengths = vec![0.0; task.tensions.len()];
        self.add_lengths(task, side, |cable, change| lengths[cable] += change);
        lengths
    }

    /// Adds to the lengths of the cables how they change with a response of the last elimination, in m.
    pub fn add_lengths(&self, task: &Task<'_>, side: usize, mut add: impl FnMut(usize, f64)) {
        let mut pulls = self.pulls.iter();
        for (k, section) in task.sections.iter().enumerate() {
            let response = self.response(task, side, k);
            for (passage, pull) in section.passages.iter().zip(&mut pulls) {
                add(passage.cable, pull.iter().zip(response).map(|(p, r)| p * r).sum());
            }
        }
    }

    /// `∂ℓᵢ/∂τⱼ` by rows in m/N, from the responses of the last elimination.
    pub fn length_by_tension(&self, task: &Task<'_>, into: &mut Vec<f64>) {
        let cables = task.tensions.len();
        into.clear();
        into.resize(cables * cables, 0.0);
        for j in 0..cables {
            self.add_lengths(task, 1 + j, |i, change| into[i * cables + j] += change);
        }
    }
}

impl Inner {
    /// Of a load on the cross-section that moves like this, behind a disk whose axes, in the base frame, are these.
    fn new(motion: Motion, load: &InnerLoad, axes: &[Vec3; 3], task: &Task<'_>) -> Self {
        let seen = |v: Vec3| seen_from(axes, v) * task.load;
        let turned = |v: Vec3| motion.rotation * v * task.load;
        let (follower, dead) = (turned(load.follower.moment), seen(load.dead.moment));
        let moment_by = task.moments.by_turn(follower, dead);
        let moment = dead + follower;
        let follower = turned(load.follower.force);
        let load = Wrench { force: seen(load.dead.force) + follower, moment };
        Self { motion, load, follower, moment_by }
    }
}

/// What is applied to a disk whose axes, in the base frame, are these, in its own frame.
fn applied(task: &Task<'_>, disk: usize, axes: &[Vec3]) -> Wrench {
    let (dead, own) = (&task.loads.dead[disk], &task.loads.followers[disk]);
    Wrench {
        force: (seen_from(axes, dead.force) + own.force) * task.load,
        moment: (seen_from(axes, dead.moment) + own.moment) * task.load,
    }
}

/// A vector of the base frame in a frame whose axes, in the base frame, are these.
fn seen_from(axes: &[Vec3], v: Vec3) -> Vec3 {
    Vec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v))
}
