//! Newton's method for the chain and the tensions of all its pieces of cable together.
//!
//! The unknowns are those of eqs. (3) and (4) and one tension for each passage; the equations beside (3) and (4) are those of
//! [`super::friction`], one for each hole. They are piecewise smooth: an iteration takes each hole to stick or to slide as
//! eq. (6) has it where the chain stands, and linearises what follows with the lengths beyond the hole and with the angle
//! by which the cable turns in it.

use whipcord_numerics::{DenseLu, Vec3};

use super::chain::{ANGLE_ROWS, Chain, NodeStep, ROWS, Task};
use super::friction::Holes;
use super::linear_step::Column;
use super::loaded_span::{Push, Slope};
use crate::section::BodyWrench;
use crate::shape::SlipState;
use crate::statics::command::Command;
use crate::statics::elimination::{Change, Size};
use crate::statics::outcome::Open;

const MAX_ITERATIONS: usize = 30;
/// A step that gains nothing is shortened to no less than this.
const LEAST_FRACTION: f64 = 1.0 / 16.0;
/// No step may leave more than so many times the least that the last iterations left.
const MOST_GROWTH: f64 = 3.0;
/// What rounding may leave where nothing improves any more.
const ROUNDING: f64 = 1e-9;
/// Of the length: what the equations of the holes may leave, so that a hole that is about to slide is known as one.
const TOLERANCE: f64 = 1e-12;
/// What the gaps of the chain may leave for that.
const CLOSED: f64 = 1e-11;
/// An angle so small, in rad, has no direction.
const STRAIGHT: f64 = 1e-9;

/// The equations of the holes in one step of actuation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law<'a> {
    pub holes: &'a Holes,
    /// By cable.
    pub commands: &'a [Command],
    /// `Dᵢ` before the step, by passage.
    pub before: &'a [f64],
    /// `κ` of eq. (6) in m/N.
    pub kappa: f64,
    /// Of the backbone, in m.
    pub length: f64,
}

/// The state of the holes, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct FrictionScratch {
    /// `Dᵢ` by passage.
    pub beyond: Vec<f64>,
    /// `φ` in the near hole of every passage, in rad.
    pub turns: Vec<f64>,
    pub slip_states: Vec<SlipState>,
    residuals: Vec<f64>,
    /// What the tensions, and last the closing of the gaps, do to the lengths and to the angles, by rows.
    lengths: Vec<f64>,
    angles: Vec<f64>,
    columns: Vec<Change>,
    matrix: Vec<f64>,
    theta: Vec<f64>,
    lu: DenseLu,
}

/// How the equation of a hole stands.
#[derive(Clone, Copy, Debug)]
enum Row {
    /// The cable is slack at the base, which would have to push.
    Slack,
    /// `D` is given.
    Held,
    /// `T − f T₋₁ = 0` with `∂f/∂φ`.
    Slides { factor: f64, by_turn: f64, incoming: f64 },
}

impl Law<'_> {
    /// The equation of a hole where the chain stands, and what it leaves, in m.
    fn row(
        &self,
        (cable, place): (usize, usize),
        tensions: &[f64],
        scratch: &FrictionScratch,
    ) -> (Row, f64, SlipState) {
        let passages = &self.holes.of_cable[cable];
        let p = passages[place];
        let incoming = match (place.checked_sub(1), self.commands[cable]) {
            (Some(before), _) => tensions[passages[before]],
            (None, Command::Tension(given)) => given,
            (None, Command::Length { target, .. }) => {
                let lack = scratch.beyond[p] - target;
                let slip_state = match self.before[p] - scratch.beyond[p] {
                    slip if slip > 0.0 => SlipState::Pulled,
                    slip if slip < 0.0 => SlipState::Released,
                    _ => SlipState::Sticks,
                };
                let pull = self.kappa * tensions[p];
                return match lack + pull <= 0.0 {
                    true => (Row::Slack, pull, slip_state),
                    false => (Row::Held, lack, slip_state),
                };
            }
        };
        let coefficient = self.holes.coefficients[cable];
        let wrap = coefficient * scratch.turns[p];
        let (least, most) = ((-wrap).exp(), wrap.exp());
        let slip = self.before[p] - scratch.beyond[p];
        let tension = tensions[p];
        let (above, below) = (tension - least * incoming, most * incoming - tension);
        let slides = |factor: f64, sign: f64| {
            let row = Row::Slides { factor, by_turn: sign * coefficient * factor, incoming };
            (row, self.kappa * (tension - factor * incoming))
        };
        let no_grip = coefficient == 0.0 || (incoming <= 0.0 && tension <= 0.0);
        if slip - self.kappa * above > 0.0 || no_grip {
            let (row, left) = slides(least, -1.0);
            (row, left, SlipState::Pulled)
        } else if slip + self.kappa * below < 0.0 {
            let (row, left) = slides(most, 1.0);
            (row, left, SlipState::Released)
        } else {
            (Row::Held, -slip, SlipState::Sticks)
        }
    }
}

impl Chain {
    /// Newton's method at the load of the task from where the chain stands, with one group to each passage; returns the
    /// iterations and the greatest residual left. The state of the holes ends in `scratch`.
    pub fn newton_with_friction(
        &mut self,
        task: &Task<'_>,
        law: &Law<'_>,
        scratch: &mut FrictionScratch,
    ) -> Result<(usize, f64), Open> {
        self.slopes.resize(task.frame.passages, Slope::default());
        // No group has a tension that its length decides on.
        self.shared.cables.clear();
        let closed = self.iterate_with_friction(task, law, scratch);
        self.slopes.clear();
        closed
    }

    fn iterate_with_friction(
        &mut self,
        task: &Task<'_>,
        law: &Law<'_>,
        scratch: &mut FrictionScratch,
    ) -> Result<(usize, f64), Open> {
        let failed = |iterations, gap, fault| Open { iterations, gap, fault };
        let mut task = Task { ..*task };
        let (mut gap, mut left) = self
            .measure_with_friction(&task, law, scratch)
            .map_err(|fault| failed(0, f64::INFINITY, Some(fault)))?;
        let mut recent = [f64::INFINITY; 3];
        for iteration in 1..=MAX_ITERATIONS {
            if task.meter.has_ended() {
                break;
            }
            if gap <= task.tolerance.min(CLOSED) && left <= TOLERANCE {
                return Ok((iteration - 1, gap.max(left)));
            }
            if !(self.linearise(&task) && self.direct_with_friction(&task, law, scratch)) {
                return Err(failed(iteration, gap, None));
            }
            task.meter.iterate();
            self.kept.clone_from(&self.nodes);
            self.kept_tensions.clone_from(&self.tensions);
            self.kept_load = task.load;
            recent.rotate_right(1);
            recent[0] = gap.max(left);
            let bound = MOST_GROWTH * recent.iter().copied().fold(f64::INFINITY, f64::min);
            let before = gap.max(left);
            let mut fraction = 1.0;
            loop {
                self.go_with_friction(&mut task, fraction);
                let measured = self.measure_with_friction(&task, law, scratch);
                if let Ok((now_gap, now_left)) = measured {
                    let now = now_gap.max(now_left);
                    if fraction == 1.0 && now.max(before) <= ROUNDING && now >= 0.5 * before {
                        return Ok((iteration, now));
                    }
                    if now <= bound.min(1e3) || (fraction <= LEAST_FRACTION && now.is_finite()) {
                        (gap, left) = (now_gap, now_left);
                        self.trace.iteration(iteration, task.load, now, fraction, &self.tensions);
                        break;
                    }
                }
                fraction *= 0.5;
                if fraction < LEAST_FRACTION {
                    return Err(failed(iteration, before, measured.err()));
                }
            }
        }
        Err(failed(MAX_ITERATIONS, gap.max(left), None))
    }

    /// Goes a fraction of the step from where the nodes were kept.
    fn go_with_friction(&mut self, task: &mut Task<'_>, fraction: f64) {
        self.go(task, fraction);
        let kept = self.kept_tensions.iter().zip(&self.step.tensions);
        for (tension, (kept, change)) in self.tensions.iter_mut().zip(kept) {
            *tension = (kept + fraction * change).max(0.0);
        }
        self.pulled.clone_from(&self.tensions);
    }

    /// Integrates all spans: the greatest gap, and what the equations of the holes leave, of the length.
    fn measure_with_friction(
        &mut self,
        task: &Task<'_>,
        law: &Law<'_>,
        scratch: &mut FrictionScratch,
    ) -> Result<(f64, f64), crate::section::Fault> {
        let gap = self.measure(task)?;
        scratch.turns.resize(task.frame.passages, 0.0);
        scratch.beyond.resize(task.frame.passages, 0.0);
        scratch.residuals.resize(task.frame.passages, 0.0);
        scratch.slip_states.resize(task.frame.passages, SlipState::Sticks);
        for passages in &law.holes.of_cable {
            for (place, &p) in passages.iter().enumerate() {
                let coming = match place.checked_sub(1) {
                    None => Vec3::Z,
                    Some(before) => {
                        let end = task.mesh.spans[before].end - 1;
                        let to_far = self.poses[end].rotation.conjugate();
                        to_far.rotate(self.chords[passages[before]].along)
                    }
                };
                let going = self.chords[p].along;
                let (sine, cosine) = (coming.cross(going).norm(), coming.dot(going));
                scratch.turns[p] = sine.atan2(cosine);
                let slope = if sine > STRAIGHT { -1.0 / sine } else { 0.0 };
                self.slopes[p].near = coming * slope;
                if let Some(before) = place.checked_sub(1) {
                    self.slopes[passages[before]].far = going * slope;
                }
            }
        }
        law.holes.beyond(&self.lengths, &self.tensions, &mut scratch.beyond);
        let mut greatest: f64 = 0.0;
        for (cable, passages) in law.holes.of_cable.iter().enumerate() {
            for (place, &p) in passages.iter().enumerate() {
                let (_, left, slip_state) = law.row((cable, place), &self.tensions, scratch);
                scratch.residuals[p] = left;
                scratch.slip_states[p] = slip_state;
                let left = left.abs() / law.length;
                // A NaN must not pass for an equation that is met.
                greatest = if left.is_finite() { greatest.max(left) } else { f64::INFINITY };
            }
        }
        Ok((gap, greatest))
    }

    /// What the tension of every passage, and last the closing of the gaps, does to all lengths and angles.
    fn respond_to_tensions(&mut self, task: &Task<'_>, scratch: &mut FrictionScratch) -> bool {
        let n = task.frame.passages;
        let wide = n + 1;
        let cut = if task.loads.any_follower_force() { 6 } else { 3 };
        let scales = task.frame.scales(task.mesh);
        self.elimination.start(Size { cut, shared: n }, scales.moment, scales.force);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        let mut units = [Push::default(); 9];
        for c in 0..3 {
            units[c].turn = axes[c];
            units[3 + c].moment = axes[c];
            units[6 + c].force = axes[c];
        }
        let units = &units[..3 + cut];
        let mut columns = core::mem::take(&mut scratch.columns);
        let mut pushed = true;
        for (k, span) in task.frame.spans.iter().enumerate() {
            let link = &self.links[k];
            columns.clear();
            columns.extend(units.iter().map(|push| link.pass(push).1));
            columns.resize(3 + cut + n, Change::default());
            for p in span.first..span.first + span.passages.len() {
                columns[3 + cut + p] = self.end(task, k, Column::Tension(p));
            }
            let gap = self.end(task, k, Column::Closing);
            pushed &= self.elimination.push(&columns, &gap);
            if !pushed {
                break;
            }
        }
        scratch.columns = columns;
        if !pushed {
            return false;
        }
        self.elimination.answer();
        scratch.lengths.clear();
        scratch.lengths.resize(n * wide, 0.0);
        scratch.angles.clear();
        scratch.angles.resize(n * wide, 0.0);
        for (k, span) in task.frame.spans.iter().enumerate() {
            let cables = span.passages.len();
            let link = &self.links[k];
            let rows = &self.rows[ROWS * span.first..ROWS * (span.first + cables)];
            let angle_rows = &self.angle_rows[ANGLE_ROWS * span.first..][..ANGLE_ROWS * cables];
            let (near_rows, far_rows) = angle_rows.split_at(9 * cables);
            let anchored = span.anchors.len() * cables;
            let own_lengths = &self.anchor_rows[span.anchor_rows..];
            let own_near = &self.anchor_angles[2 * span.anchor_rows..];
            let own_far = &own_near[anchored..];
            let mut by_unit = [BodyWrench::default(); 9];
            for (wrench, push) in by_unit.iter_mut().zip(units) {
                *wrench = link.pass(push).0;
            }
            let own = |column: Column| link.pass(&self.push(task, k, column)).0;
            for i in 0..cables {
                let of_wrench = |rows: &[f64], wrench: &BodyWrench| -> f64 {
                    (0..3)
                        .map(|c| {
                            rows[c * cables + i] * wrench.linear[c]
                                + rows[(3 + c) * cables + i] * wrench.angular[c]
                        })
                        .sum()
                };
                let by_start = |rows: &[f64]| {
                    let mut by = [0.0; 9];
                    for (c, entry) in by.iter_mut().enumerate().take(units.len()) {
                        let turn = if c < 3 { rows[(6 + c) * cables + i] } else { 0.0 };
                        *entry = of_wrench(rows, &by_unit[c]) + turn;
                    }
                    by
                };
                let p = span.first + i;
                let next = self.next_of(task, k, i);
                let [length, near, far] = [rows, near_rows, far_rows].map(by_start);
                for j in 0..wide {
                    let Change { turn, moment, force } = self.elimination.change(k, j);
                    let along = |by: &[f64; 9]| -> f64 {
                        (0..3)
                            .map(|c| by[c] * turn[c] + by[3 + c] * moment[c] + by[6 + c] * force[c])
                            .sum()
                    };
                    scratch.lengths[p * wide + j] += along(&length);
                    scratch.angles[p * wide + j] += along(&near);
                    if let Some(next) = next {
                        scratch.angles[next * wide + j] += along(&far);
                    }
                }
                let inside = (span.first..span.first + cables).map(Column::Tension);
                for column in inside.chain([Column::Closing]) {
                    let j = if let Column::Tension(j) = column { j } else { n };
                    let wrench = own(column);
                    let direct = |rows: &[f64]| Self::own(task, k, i, column, rows);
                    scratch.lengths[p * wide + j] += of_wrench(rows, &wrench) + direct(own_lengths);
                    scratch.angles[p * wide + j] +=
                        of_wrench(near_rows, &wrench) + direct(own_near);
                    if let Some(next) = next {
                        scratch.angles[next * wide + j] +=
                            of_wrench(far_rows, &wrench) + direct(own_far);
                    }
                }
            }
        }
        true
    }

    /// The passage of the same cable in the next span.
    fn next_of(&self, task: &Task<'_>, k: usize, i: usize) -> Option<usize> {
        let cable = task.frame.spans[k].passages[i].cable;
        let next = task.frame.spans.get(k + 1)?;
        let place = next.passages.iter().position(|passage| passage.cable == cable)?;
        Some(next.first + place)
    }

    /// The linear step of chain and tensions from where they were last measured; `false` where there is none.
    fn direct_with_friction(
        &mut self,
        task: &Task<'_>,
        law: &Law<'_>,
        scratch: &mut FrictionScratch,
    ) -> bool {
        if !self.respond_to_tensions(task, scratch) {
            return false;
        }
        let n = task.frame.passages;
        let wide = n + 1;
        let mut matrix = core::mem::take(&mut scratch.matrix);
        let mut theta = core::mem::take(&mut scratch.theta);
        matrix.clear();
        matrix.resize(n * n, 0.0);
        theta.clear();
        theta.resize(n, 0.0);
        for (cable, passages) in law.holes.of_cable.iter().enumerate() {
            for (place, &p) in passages.iter().enumerate() {
                let row = &mut matrix[p * n..(p + 1) * n];
                let (equation, left, _) = law.row((cable, place), &self.tensions, scratch);
                theta[p] = -left;
                match equation {
                    Row::Slack => row[p] = law.kappa,
                    Row::Held => {
                        for &q in &passages[place..] {
                            let by = &scratch.lengths[q * wide..(q + 1) * wide];
                            for (entry, by) in row.iter_mut().zip(by) {
                                *entry += by;
                            }
                            row[q] -= law.holes.yielding[q];
                            theta[p] -= by[n];
                        }
                    }
                    Row::Slides { factor, by_turn, incoming } => {
                        let by = &scratch.angles[p * wide..(p + 1) * wide];
                        let weight = -law.kappa * by_turn * incoming;
                        for (entry, by) in row.iter_mut().zip(by) {
                            *entry = weight * by;
                        }
                        theta[p] -= weight * by[n];
                        row[p] += law.kappa;
                        if let Some(before) = place.checked_sub(1) {
                            row[passages[before]] -= law.kappa * factor;
                        }
                    }
                }
            }
        }
        let solved = scratch.lu.factor(n, &matrix).is_ok();
        if solved {
            scratch.lu.solve(&mut theta);
        }
        let finite = solved && theta.iter().all(|x| x.is_finite()) && self.follow(task, &theta);
        self.step.tensions.clone_from(&theta);
        (scratch.matrix, scratch.theta) = (matrix, theta);
        finite
    }

    /// The changes of all nodes by these changes of the tensions and by the closing of the gaps.
    fn follow(&mut self, task: &Task<'_>, theta: &[f64]) -> bool {
        let mut finite = true;
        self.step.load = 0.0;
        self.step.nodes.clear();
        for k in 0..self.nodes.len() {
            let mut change = self.elimination.change(k, theta.len());
            for (j, &theta) in theta.iter().enumerate() {
                change = change.plus(theta, self.elimination.change(k, j));
            }
            let mut node = NodeStep { change, ..NodeStep::default() };
            if let Some(link) = self.links.get(k) {
                let mut push = self.push(task, k, Column::Closing);
                (push.turn, push.moment, push.force) = (change.turn, change.moment, change.force);
                self.perturb(&mut push, task, k, |passage| theta[passage]);
                node.wrench = link.pass(&push).0;
            }
            finite &= change.is_finite() && node.wrench.linear.is_finite();
            self.step.nodes.push(node);
        }
        finite
    }
}
