//! One span of the loaded chain: how it ends short of the next disk, and what it passes on to it.

use whipcord_numerics::{Mat3, UnitQuaternion, Vec3};

use super::anchors::ChordChange;
use super::chord::Chord;
use super::node::Node;
use super::rod::{self, By, InSpan};
use super::span::{self, Answer, Factors, Taut};
use super::task::Task;
use super::unloaded_span;
use super::variation::{End, Variation};
use crate::section::BodyWrench;
use crate::statics::elimination::Change;
use crate::statics::scales::Scales;

/// What is left of the equations of a span.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gap {
    /// Of eq. (3).
    pub residual: BodyWrench,
    /// Of eqs. (4).
    pub change: Change,
    /// Total force `N` at the start.
    total_force: Vec3,
    /// Sum of the followers inside the span, disk frame.
    followers: Vec3,
    /// Moment applied to the far disk, in its frame, and follower force there.
    applied: Vec3,
    follower: Vec3,
}

/// How the angles that a piece of cable encloses with its neighbours hang on its direction, in rad.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slope {
    /// The angle in the near hole, by the direction in the frame of the near disk.
    pub near: Vec3,
    /// The angle in the far hole, by the direction in the frame of the far disk.
    pub far: Vec3,
}

/// What becomes of those angles.
#[derive(Debug, Default)]
pub(super) struct Angles<'a> {
    /// Of each passage; empty where the angles do not count.
    pub slopes: &'a [Slope],
    /// Takes their changes: in the near holes by each of nine variations, then in the far ones.
    pub rows: &'a mut [f64],
    /// The same by the tensions of the anchors' cables: in the near holes by each of them, then in the far ones.
    pub by_tension: &'a mut [f64],
}

/// The changes of the angles in the near holes and in the far ones by a variation of the rod.
fn turn_angles(
    slopes: &[Slope],
    taut: &Taut<'_>,
    variation: &Variation,
    of_anchors: &[ChordChange],
    (near, far): (&mut [f64], &mut [f64]),
) {
    let to_far = taut.pose.rotation.conjugate();
    for (i, (slope, passage)) in slopes.iter().zip(&taut.span.passages).enumerate() {
        let Chord { along, length } = taut.chords[i];
        let t = to_far.rotate(along);
        let way = variation.shift + variation.turn.cross(passage.far);
        let tilt = (way - t * t.dot(way)) * (1.0 / length);
        near[i] = slope.near.dot(taut.pose.rotation.rotate(tilt));
        far[i] = slope.far.dot(tilt - variation.turn.cross(t));
    }
    for (anchor, change) in taut.anchors.iter().zip(of_anchors) {
        if let Some(slope) = slopes.get(anchor.passage) {
            // Nothing follows an anchor.
            (near[anchor.passage], far[anchor.passage]) = (slope.near.dot(change.tilt), 0.0);
        }
    }
}

/// A linearised span.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Link {
    /// By the six components of `w`, and by the direction of the dead loads.
    by: [Answer; 9],
    factors: Factors,
    /// Of the disk it starts from, and of the far disk relative to that one.
    rotation: UnitQuaternion,
    turn: UnitQuaternion,
    /// From the near disk to the far one.
    to_far: Mat3,
    /// Whether forces follow the backbone: else the force at a cut does not change.
    has_followers: bool,
    total_force: Vec3,
    followers: Vec3,
    applied: Vec3,
    follower: Vec3,
    /// What the factor on all loads does, where it is free: to eq. (3) and to eqs. (4), at the same wrench `w`.
    pub by_load: Option<(BodyWrench, Change)>,
}

/// What a span is asked: changes at its start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    pub turn: Vec3,
    pub moment: Vec3,
    pub force: Vec3,
    /// What is left of eq. (3) and is closed.
    pub residual: BodyWrench,
    /// What answers beside the rod: of the cables' share in eq. (3), and at the far disk.
    pub own: Answer,
}

impl Push {
    /// Adds an answer.
    pub fn add(&mut self, f: f64, answer: &Answer) {
        self.own.turn += f * answer.turn;
        self.own.moment += f * answer.moment;
        self.own.force += f * answer.force;
        self.own.pull = self.own.pull + answer.pull * f;
    }
}

impl Gap {
    /// Of span `k` between its two nodes.
    pub fn new(
        task: &Task<'_>,
        k: usize,
        (node, next): (&Node, &Node),
        end: &End,
        chords: &[Chord],
        tensions: &[f64],
    ) -> Self {
        let Task { loads, load, .. } = *task;
        let span = &task.frame.spans[k];
        let steps = &task.mesh.spans[k];
        let at_start = load * loads.force(steps.start, 0) + node.force;
        let total_force = node.rotation.conjugate().rotate(at_start);
        let total = BodyWrench { linear: total_force, angular: node.moment };
        let rotation = (node.rotation * end.pose.rotation).renormalized();
        let follower = loads.follower(steps.end);
        let dead = load * rotation.conjugate().rotate(loads.moment(steps.end));
        let applied = dead + load * follower.moment;
        let moment = span::far_moment(span, end, chords, tensions) - applied;
        let follower = load * rotation.rotate(follower.force);
        let force = node.force - node.rotation.rotate(end.followers) - follower;
        Self {
            residual: node.wrench + span::pull(span, chords, tensions) - total,
            change: Change {
                turn: (next.rotation.conjugate() * rotation).log(),
                moment: moment - next.moment,
                force: force - next.force,
            },
            total_force,
            followers: end.followers,
            applied: dead,
            follower,
        }
    }

    /// The greatest part of it, without dimension; never NaN.
    pub fn size(&self, scales: &Scales, node: &Node, next: &Node) -> f64 {
        let Self { residual, change, .. } = self;
        let finite = change.is_finite() && residual.linear.is_finite();
        if !(finite && residual.angular.is_finite()) {
            return f64::INFINITY;
        }
        (change.turn.norm())
            .max(change.moment.norm() / (scales.moment + next.moment.norm()))
            .max(change.force.norm() / (scales.force + next.force.norm()))
            .max(residual.linear.norm() / (scales.force + node.wrench.linear.norm()))
            .max(residual.angular.norm() / (scales.moment + node.wrench.angular.norm()))
    }
}

impl Link {
    /// Linearises span `k`; `rows` takes the changes of the chords, the last of them by the load where that is free, and
    /// `angles` those of the angles in the holes. `None` where eq. (3) is singular.
    #[inline(always)]
    pub fn new(
        task: &Task<'_>,
        k: usize,
        rotation: UnitQuaternion,
        gap: &Gap,
        taut: &Taut<'_>,
        (rows, angles): (&mut [f64], Angles<'_>),
        of_anchors: OfAnchors<'_>,
    ) -> Option<Self> {
        let start = task.mesh.spans[k].start;
        let inside = InSpan::at(task.loads, task.load, rotation, start);
        let OfAnchors { answers: of_tensions, rows: tension_rows, changes } = of_anchors;
        let rows_of = Rows { rows: &mut *rows, tension_rows, angles };
        let by = answers(task, k, taut, &inside, rows_of, (of_tensions, &mut *changes));
        let Gap { total_force, followers, applied, follower, .. } = *gap;
        let (factors, turn) = (Factors::new(&by)?, taut.pose.rotation);
        let by_load = None;
        let mut link = Self {
            by,
            factors,
            rotation,
            turn,
            to_far: turn.conjugate().to_matrix(),
            has_followers: task.loads.any_follower_force(),
            total_force,
            followers,
            applied,
            follower,
            by_load,
        };
        if task.step.frees_load() {
            let rows = &mut rows[9 * taut.chords.len()..];
            let changes = &mut changes[..taut.anchors.len()];
            link.by_load = Some(link.loaded(task, k, taut, &inside, (rows, changes)));
        }
        Some(link)
    }

    /// What the factor on all loads does.
    fn loaded(
        &self,
        task: &Task<'_>,
        k: usize,
        taut: &Taut<'_>,
        inside: &InSpan<'_>,
        (row, changes): (&mut [f64], &mut [ChordChange]),
    ) -> (BodyWrench, Change) {
        let (grid, steps) = (&task.mesh.grid, task.mesh.spans[k].clone());
        let place = steps.end;
        let variation = rod::linearise(grid, steps, taut, inside, By::Load, changes);
        let answer = span::answer(taut, &variation, changes, row);
        let to_start = self.rotation.conjugate();
        let mut residual = answer.pull;
        residual.linear -= to_start.rotate(inside.at_start);
        let end = self.rotation * self.turn;
        let follower = task.loads.follower(place);
        let dead = end.conjugate().rotate(task.loads.moment(place));
        let turn = answer.turn;
        let moment = answer.moment - dead - follower.moment - self.applied.cross(turn);
        let force = self.rotation.rotate(answer.force)
            - end.rotate(follower.force)
            - end.rotate(turn.cross(end.conjugate().rotate(self.follower)));
        (residual, Change { turn, moment, force })
    }

    /// From the near disk to the far one.
    pub fn far_frame(&self) -> UnitQuaternion {
        self.turn.conjugate()
    }

    /// Whether the determinant of what is eliminated is negative.
    pub const fn is_negative(&self) -> bool {
        self.factors.is_negative
    }

    /// The change of `w` and what arrives at the next disk when the start changes.
    pub fn pass(&self, push: &Push) -> (BodyWrench, Change) {
        let Push { turn, moment, force, residual, ref own } = *push;
        let by_turn = |of: fn(&Answer) -> Vec3| -> Vec3 {
            (0..3).fold(Vec3::ZERO, |sum, c| sum + of(&self.by[6 + c]) * turn[c])
        };
        let mut total = self.total_force.cross(turn);
        if self.has_followers {
            total += self.rotation.conjugate().rotate(force);
        }
        let right = BodyWrench {
            linear: total - own.pull.linear - by_turn(|a| a.pull.linear) - residual.linear,
            angular: moment - own.pull.angular - by_turn(|a| a.pull.angular) - residual.angular,
        };
        let change = self.factors.solve(right);
        let all = |of: fn(&Answer) -> Vec3| -> Vec3 {
            (0..3).fold(by_turn(of), |sum, c| {
                sum + of(&self.by[c]) * change.linear[c] + of(&self.by[3 + c]) * change.angular[c]
            })
        };
        let turned = self.to_far * turn + all(|a| a.turn) + own.turn;
        let moment = all(|a| a.moment) + own.moment - self.applied.cross(turned);
        let force = match self.has_followers {
            true => self.force_behind(turn, force, turned, all(|a| a.force) + own.force),
            false => Vec3::ZERO,
        };
        (change, Change { turn: turned, moment, force })
    }

    /// The change of the followers' force at the next disk.
    fn force_behind(&self, turn: Vec3, force: Vec3, turned: Vec3, answer: Vec3) -> Vec3 {
        let rotation = self.rotation;
        let end = rotation * self.turn;
        force - rotation.rotate(turn.cross(self.followers)) + rotation.rotate(answer)
            - end.rotate(turned.cross(end.conjugate().rotate(self.follower)))
    }
}

/// Where a span puts what its tensions do at the same wrench in its rod.
pub(super) struct OfAnchors<'a> {
    /// By anchor.
    pub answers: &'a mut [Answer],
    /// Of the chords, see [`Span::anchor_rows`].
    pub rows: &'a mut [f64],
    /// Memory.
    pub changes: &'a mut [ChordChange],
}

/// Where the changes of the chords and of the angles in the holes go.
struct Rows<'a> {
    rows: &'a mut [f64],
    tension_rows: &'a mut [f64],
    angles: Angles<'a>,
}

impl Rows<'_> {
    /// Of variation `c` of nine.
    #[inline(always)]
    fn answer(
        &mut self,
        c: usize,
        taut: &Taut<'_>,
        variation: &Variation,
        changes: &[ChordChange],
    ) -> Answer {
        let cables = taut.chords.len();
        if !self.angles.slopes.is_empty() {
            let (near, far) = self.angles.rows.split_at_mut(9 * cables);
            let rows = (&mut near[c * cables..][..cables], &mut far[c * cables..][..cables]);
            turn_angles(self.angles.slopes, taut, variation, changes, rows);
        }
        span::answer(taut, variation, changes, &mut self.rows[c * cables..(c + 1) * cables])
    }

    /// By the tension of an anchor's cable.
    fn answer_to_tension(
        &mut self,
        a: usize,
        taut: &Taut<'_>,
        variation: &Variation,
        changes: &[ChordChange],
    ) -> Answer {
        let cables = taut.chords.len();
        if !self.angles.slopes.is_empty() {
            let (near, far) = self.angles.by_tension.split_at_mut(taut.anchors.len() * cables);
            let rows = (&mut near[a * cables..][..cables], &mut far[a * cables..][..cables]);
            turn_angles(self.angles.slopes, taut, variation, changes, rows);
        }
        let row = &mut self.tension_rows[a * cables..(a + 1) * cables];
        span::answer(taut, variation, changes, row)
    }
}

/// The answers to the six components of `w` and to the direction of the dead loads, and to the tensions of the anchors' cables.
#[inline(always)]
fn answers(
    task: &Task<'_>,
    k: usize,
    taut: &Taut<'_>,
    inside: &InSpan<'_>,
    mut rows: Rows<'_>,
    (of_tensions, changes): (&mut [Answer], &mut [ChordChange]),
) -> [Answer; 9] {
    let (cables, anchors) = (taut.chords.len(), taut.anchors.len());
    let (grid, steps) = (&task.mesh.grid, &task.mesh.spans[k]);
    let units = unloaded_span::units();
    let mut out = [Answer::default(); 9];
    if inside.acts(steps.clone()) {
        let changes = &mut changes[..anchors];
        for (c, out) in out.iter_mut().enumerate() {
            let by = match units.get(c) {
                Some(unit) => By::Wrench(*unit),
                None => By::Turn([Vec3::X, Vec3::Y, Vec3::Z][c - 6]),
            };
            let mut variation = rod::linearise(grid, steps.clone(), taut, inside, by, changes);
            // What a change of the force adds beside itself are the followers.
            variation.force -= units.get(c).map_or(Vec3::ZERO, |unit| unit.linear);
            *out = rows.answer(c, taut, &variation, changes);
        }
        for (a, out) in of_tensions.iter_mut().enumerate() {
            let by = By::Tension(a);
            let variation = rod::linearise(grid, steps.clone(), taut, inside, by, changes);
            *out = rows.answer_to_tension(a, taut, &variation, changes);
        }
    } else {
        let bare = |variation: &Variation| Variation { force: Vec3::ZERO, ..*variation };
        for (a, out) in of_tensions.iter_mut().enumerate() {
            let changes = &mut changes[..anchors];
            let none = [BodyWrench::default()];
            let [variation] =
                unloaded_span::linearise(grid, steps.clone(), taut, &none, Some(a), changes);
            *out = rows.answer_to_tension(a, taut, &bare(&variation), changes);
        }
        let variations = unloaded_span::linearise(grid, steps.clone(), taut, &units, None, changes);
        for (c, (out, variation)) in out.iter_mut().zip(&variations).enumerate() {
            let changes = &changes[c * anchors..(c + 1) * anchors];
            *out = rows.answer(c, taut, &bare(variation), changes);
        }
        rows.rows[6 * cables..].fill(0.0);
        for half in rows.angles.rows.chunks_exact_mut(9 * cables.max(1)) {
            half[6 * cables..].fill(0.0);
        }
    }
    out
}
