//! The response of the chain to the tensions of all its passages, for [`crate::statics::friction`].

use whipcord_numerics::Vec3;

use super::chain::{ANGLE_ROWS, Chain, ROWS};
use super::column::Column;
use super::loaded_span::{Push, Slope};
use super::node::{Node, NodeStep};
use super::problem::Problem;
use super::raise::Raise;
use super::scratch::{Scratch, copy_out};
use super::task::Task;
use super::tensions::Rod;
use crate::budget::Meter;
use crate::section::{BodyWrench, Fault};
use crate::statics::elimination::{Change, Size};
use crate::statics::friction::{self, Holes, PassageResponse, Passages, Response, SubstepEnd};
use crate::statics::outcome::{Failure, Found};

/// An angle so small, in rad, has no direction.
const STRAIGHT: f64 = 1e-9;

/// One step of actuation on from what the holes remember, by the course of `scratch` where a coarser mesh has left one. The answer is
/// left in `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    holes: &Holes,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    scratch.groups.clear();
    scratch.groups.extend(0..problem.frame.passages);
    scratch.chain.slopes.resize(problem.frame.passages, Slope::default());
    // No group has a tension that its length decides on.
    scratch.chain.shared.cables.clear();
    let mut history = core::mem::take(&mut scratch.history);
    let mut memory = core::mem::take(&mut scratch.friction);
    let mut course = core::mem::take(&mut scratch.course);
    let mut model = Rubbing { problem, scratch };
    let found =
        friction::step(&mut model, holes, problem.commands, &mut history, &mut course, &mut memory);
    scratch.chain.slopes.clear();
    if found.is_ok() {
        let Scratch { chain, unloaded, .. } = &mut *scratch;
        unloaded.adopt(chain, problem.frame);
        scratch.tensions.clone_from(&history.base);
        scratch.pulled.clone_from(&history.tensions);
        holes.cable_lengths(&memory.at.lengths, &mut scratch.lengths);
        copy_out(problem, scratch);
    }
    (scratch.history, scratch.friction, scratch.course) = (history, memory, course);
    found
}

/// Puts the chain to the end of a substep, which is then the answer.
pub(super) fn put(
    problem: &Problem<'_>,
    end: &SubstepEnd<Vec<Node>>,
    scratch: &mut Scratch,
) -> Result<(), Fault> {
    scratch.groups.clear();
    scratch.groups.extend(0..problem.frame.passages);
    scratch.chain.slopes.resize(problem.frame.passages, Slope::default());
    let mut model = Rubbing { problem, scratch };
    model.set_shape(&end.shape);
    let mut at = Passages::default();
    let measured = model.measure(&end.standing.tensions, &mut at);
    scratch.chain.slopes.clear();
    measured?;
    let Scratch { chain, unloaded, .. } = &mut *scratch;
    unloaded.adopt(chain, problem.frame);
    scratch.pulled.clone_from(&end.standing.tensions);
    copy_out(problem, scratch);
    Ok(())
}

/// The chain with the tensions of all passages.
struct Rubbing<'a> {
    problem: &'a Problem<'a>,
    scratch: &'a mut Scratch,
}

impl Rubbing<'_> {
    /// Asks the chain under all of the load.
    fn ask<T>(&mut self, ask: impl FnOnce(&mut Chain, &mut Task<'_>) -> T) -> T {
        let Scratch { chain, groups, applied, .. } = &mut *self.scratch;
        let raise = Raise::at_tensions(self.problem);
        ask(chain, &mut raise.task(groups, applied, 1.0))
    }
}

impl PassageResponse for Rubbing<'_> {
    type Shape = Vec<Node>;

    fn shape(&self) -> Vec<Node> {
        self.scratch.chain.nodes.clone()
    }

    fn set_shape(&mut self, shape: &Vec<Node>) {
        self.scratch.chain.nodes.clone_from(shape);
    }

    fn converge(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        let slopes = core::mem::take(&mut self.scratch.chain.slopes);
        let converged = Rod::new(self.problem, self.scratch).find_equilibrium(tensions);
        self.scratch.chain.slopes = slopes;
        converged
    }

    fn measure(&mut self, tensions: &[f64], at: &mut Passages) -> Result<f64, Fault> {
        let holes = self.problem.holes;
        self.ask(|chain, task| {
            chain.pull(task.groups, tensions);
            let gap = chain.measure(task)?;
            at.lengths.clone_from(&chain.lengths);
            at.turns.resize(tensions.len(), 0.0);
            for passages in holes.iter().flat_map(|holes| &holes.of_cable) {
                chain.turn(task, passages, &mut at.turns);
            }
            Ok(gap)
        })
    }

    fn respond(&mut self, _: &[f64], response: &mut Response) -> bool {
        self.ask(|chain, task| chain.linearise(task) && chain.respond_to_tensions(task, response))
    }

    fn prepare(&mut self, changes: &[f64]) -> Option<f64> {
        self.ask(|chain, task| {
            chain.kept.clone_from(&chain.nodes);
            chain.kept_load = task.load;
            chain.follow(task, changes).then_some(1.0)
        })
    }

    fn go(&mut self, fraction: f64) {
        self.ask(|chain, task| chain.go(task, fraction));
    }

    fn tolerance(&self) -> f64 {
        self.problem.tolerance
    }

    fn meter(&self) -> &Meter {
        self.problem.meter
    }

    fn note(&mut self, iteration: usize, residual: f64, fraction: f64, tensions: &[f64]) {
        let trace = &mut self.scratch.chain.trace;
        trace.steps = self.problem.mesh.grid.len();
        trace.iteration(iteration, 1.0, residual, fraction, tensions);
    }

    fn failure(&self, fault: Fault, tensions: &[f64]) -> Failure {
        let passages = self.problem.frame.spans.iter().flat_map(|span| &span.passages);
        let mut greatest = vec![0.0_f64; self.problem.commands.len()];
        for (passage, &tension) in passages.zip(tensions) {
            greatest[passage.cable] = greatest[passage.cable].max(tension);
        }
        Failure::of_section(fault, &greatest, 0.0)
    }
}

impl Chain {
    /// The angles in the holes of a cable where the chain was measured last, and how they change with the directions of its
    /// passages.
    pub(super) fn turn(&mut self, task: &Task<'_>, passages: &[usize], turns: &mut [f64]) {
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
            turns[p] = sine.atan2(cosine);
            let slope = if sine > STRAIGHT { -1.0 / sine } else { 0.0 };
            self.slopes[p].near = coming * slope;
            if let Some(before) = place.checked_sub(1) {
                self.slopes[passages[before]].far = going * slope;
            }
        }
    }

    /// What the tension of every passage, and last the closing of the gaps, does to all lengths and angles.
    pub fn respond_to_tensions(&mut self, task: &Task<'_>, response: &mut Response) -> bool {
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
        let mut columns = core::mem::take(&mut self.columns);
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
        self.columns = columns;
        if !pushed {
            return false;
        }
        self.elimination.answer();
        response.lengths.clear();
        response.lengths.resize(n * wide, 0.0);
        response.turns.clear();
        response.turns.resize(n * wide, 0.0);
        let mut inside: Vec<(Column, BodyWrench)> = Vec::new();
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
            let tensions = (span.first..span.first + cables).map(Column::Tension);
            inside.clear();
            inside.extend(
                tensions
                    .chain([Column::Closing])
                    .map(|column| (column, link.pass(&self.push(task, k, column)).0)),
            );
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
                let own = p * wide..(p + 1) * wide;
                self.elimination.add_worth(k, &length, &mut response.lengths[own.clone()]);
                self.elimination.add_worth(k, &near, &mut response.turns[own]);
                if let Some(next) = next {
                    let next = next * wide..(next + 1) * wide;
                    self.elimination.add_worth(k, &far, &mut response.turns[next]);
                }
                for &(column, wrench) in &inside {
                    let j = if let Column::Tension(j) = column { j } else { n };
                    let direct = |rows: &[f64]| Self::own(task, k, i, column, rows);
                    response.lengths[p * wide + j] +=
                        of_wrench(rows, &wrench) + direct(own_lengths);
                    response.turns[p * wide + j] +=
                        of_wrench(near_rows, &wrench) + direct(own_near);
                    if let Some(next) = next {
                        response.turns[next * wide + j] +=
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

    /// The changes of all nodes by these changes of the tensions and by the closing of the gaps.
    pub fn follow(&mut self, task: &Task<'_>, theta: &[f64]) -> bool {
        let mut finite = true;
        self.step.load = 0.0;
        self.step.nodes.clear();
        for k in 0..self.nodes.len() {
            let change = self.elimination.follow(k, theta);
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
