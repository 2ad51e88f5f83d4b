//! The linear step of the chain: the changes of all spans eliminated from base to tip, and what they share.

use whipcord_numerics::Vec3;

use super::chain::{Chain, ROWS};
use super::chord;
use super::column::Column;
use super::loaded_span::Push;
use super::node::{Direction, NodeStep};
use super::task::Task;
use crate::statics::elimination::{Change, Size};
use crate::statics::path::state::PartChange;
use crate::statics::path::{self, pattern};
use crate::statics::shared_unknowns::Cables;

impl Chain {
    /// What a column changes at a span, beside its start.
    pub(super) fn push(&self, task: &Task<'_>, k: usize, column: Column) -> Push {
        let link = &self.links[k];
        let mut push = Push::default();
        match column {
            Column::Load => push.residual = link.by_load.unwrap_or_default().0,
            Column::Tension(group) => {
                self.perturb(&mut push, task, k, |of| f64::from(u8::from(of == group)));
            }
            Column::Closing if task.step.closes() => push.residual = self.gaps[k].residual,
            Column::Closing => {}
        }
        push
    }

    /// Adds what changes of the tensions of the groups do to a span.
    pub(super) fn perturb(
        &self,
        push: &mut Push,
        task: &Task<'_>,
        k: usize,
        change: impl Fn(usize) -> f64,
    ) {
        let span = &task.frame.spans[k];
        let to_far = self.links[k].far_frame();
        for (i, passage) in span.passages.iter().enumerate() {
            let change = change(task.groups[span.first + i]);
            if change == 0.0 {
                continue;
            }
            let chord = &self.chords[span.first + i];
            push.own.pull = push.own.pull + chord::unit_pull(passage.near, chord) * change;
            if !passage.is_anchored_inside() {
                push.own.moment += change * passage.far.cross(to_far.rotate(chord.along));
            }
        }
        for (anchor, answer) in
            task.mesh.anchors_of(span).iter().zip(&self.by_anchor[span.anchors.clone()])
        {
            push.add(change(task.groups[span.first + anchor.passage]), answer);
        }
    }

    /// What a column changes at passage `i` of a span at the same wrench in its rod, of rows such as [`Chain::anchor_rows`] where
    /// those of the span begin.
    pub(super) fn own(task: &Task<'_>, k: usize, i: usize, column: Column, rows: &[f64]) -> f64 {
        let Column::Tension(group) = column else { return 0.0 };
        let span = &task.frame.spans[k];
        let anchors = task.mesh.anchors_of(span).iter().enumerate();
        let of_group =
            anchors.filter(|(_, anchor)| task.groups[span.first + anchor.passage] == group);
        of_group.map(|(a, _)| rows[a * span.passages.len() + i]).sum()
    }

    /// How a span ends short of the next disk by a column, at the same start.
    pub(super) fn end(&self, task: &Task<'_>, k: usize, column: Column) -> Change {
        let link = &self.links[k];
        let passed = link.pass(&self.push(task, k, column)).1;
        match (column, task.step) {
            (Column::Tension(_), _) | (Column::Closing, path::Step::Along(_)) => passed,
            (Column::Load, _) => link.by_load.unwrap_or_default().1.plus(1.0, passed),
            (Column::Closing, path::Step::Probe) => {
                let moment = task.frame.scales(task.mesh).moment * pattern(k);
                Change { moment, ..passed }
            }
            (Column::Closing, _) => self.gaps[k].change.plus(1.0, passed),
        }
    }

    /// Eliminates the chain with these shared columns.
    fn eliminate(&mut self, task: &Task<'_>, shared: &[Column]) -> bool {
        let cut = if task.loads.any_follower_force() { 6 } else { 3 };
        let scales = task.frame.scales(task.mesh);
        let size = Size { cut, shared: shared.len() };
        self.elimination.start(size, scales.moment, scales.force);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        let mut columns = core::mem::take(&mut self.columns);
        let pushed = (0..task.frame.spans.len()).all(|k| {
            let link = &self.links[k];
            columns.clear();
            let mut pass = |push: &Push| columns.push(link.pass(push).1);
            for turn in axes {
                pass(&Push { turn, ..Push::default() });
            }
            for moment in axes {
                pass(&Push { moment, ..Push::default() });
            }
            if cut == 6 {
                for force in axes {
                    pass(&Push { force, ..Push::default() });
                }
            }
            columns.extend(shared.iter().map(|&column| self.end(task, k, column)));
            let gap = self.end(task, k, Column::Closing);
            self.elimination.push(&columns, &gap)
        });
        self.columns = columns;
        if !pushed {
            return false;
        }
        self.elimination.answer();
        (0..=task.frame.spans.len()).all(|k| self.elimination.change(k, shared.len()).is_finite())
    }

    /// Whether the determinant of the linearised problem at this load is negative: of what is eliminated span by span, of the
    /// chain, and of the lengths of the cables that are held; `None` where it cannot be told.
    pub fn is_determinant_negative(&mut self, task: &Task<'_>) -> Option<bool> {
        self.measure(task).ok()?;
        if !(self.linearise(task) && self.direct(task)) {
            return None;
        }
        let of_spans = self.links.iter().filter(|link| link.is_negative()).count();
        let negative = self.elimination.is_negative() ^ self.shared.is_negative();
        Some(negative ^ (of_spans % 2 == 1))
    }

    /// The linear step of the task from where the chain was last measured, with the links as they are; `false`
    /// where there is none.
    pub(super) fn direct(&mut self, task: &Task<'_>) -> bool {
        let mut shared = core::mem::take(&mut self.shared);
        shared.find(task.commands);
        let load = task.step.frees_load().then_some(Column::Load);
        let mut columns = core::mem::take(&mut self.shared_columns);
        columns.clear();
        columns.extend(load);
        columns.extend(shared.cables.iter().map(|&group| Column::Tension(group)));
        let mut solved = self.eliminate(task, &columns);
        if solved && !columns.is_empty() {
            self.lengthen(task, &shared.cables, &columns, true, &mut shared.lengths);
            self.along(task, &columns, &mut shared.along);
            let Self { tensions, lengths, .. } = &*self;
            let cables = Cables { commands: task.commands, tensions, lengths };
            solved = shared.solve(task.step, &cables, &task.frame.scales(task.mesh));
        }
        if solved {
            self.step.load = if load.is_some() { shared.theta[0] } else { 0.0 };
            self.step.tensions.clear();
            let changes = (0..self.tensions.len()).map(|group| shared.change_of(group));
            self.step.tensions.extend(changes);
            self.step.nodes.clear();
            for k in 0..self.nodes.len() {
                let mut change = self.elimination.change(k, columns.len());
                for (j, &theta) in shared.theta.iter().enumerate() {
                    change = change.plus(theta, self.elimination.change(k, j));
                }
                let mut node = NodeStep { change, ..NodeStep::default() };
                if k < self.links.len() {
                    let Change { turn, moment, force } = change;
                    let mut push = self.push(task, k, Column::Closing);
                    (push.turn, push.moment, push.force) = (turn, moment, force);
                    let link = &self.links[k];
                    self.perturb(&mut push, task, k, |group| shared.change_of(group));
                    let (by_load, _) = link.by_load.unwrap_or_default();
                    push.residual = push.residual + by_load * self.step.load;
                    node.wrench = link.pass(&push).0;
                }
                solved &= change.is_finite() && node.wrench.linear.is_finite();
                self.step.nodes.push(node);
            }
        }
        (self.shared, self.shared_columns) = (shared, columns);
        solved
    }

    /// The product of each column with the direction of the step.
    fn along(&self, task: &Task<'_>, columns: &[Column], products: &mut Vec<f64>) {
        let (path::Step::Across(direction) | path::Step::Along(direction)) = task.step else {
            return;
        };
        let scales = task.frame.scales(task.mesh);
        let own = |column: Column| match column {
            Column::Load => direction.load,
            Column::Tension(group) => direction.tensions[group] / (scales.force * scales.force),
            Column::Closing => 0.0,
        };
        let nodes = |j: usize| -> f64 {
            let nodes = direction.nodes.iter().enumerate();
            let product = |(k, node): (usize, &NodeStep)| {
                task.frame.weight(k) * node.change.product(&self.elimination.change(k, j), &scales)
            };
            nodes.map(product).sum()
        };
        let columns = columns.iter().copied().chain([Column::Closing]);
        products.clear();
        products.extend(columns.enumerate().map(|(j, column)| nodes(j) + own(column)));
    }

    /// The linear step that the task is for, at an equilibrium; `None` where the system is singular.
    pub fn direction(&mut self, task: &Task<'_>) -> Option<Direction> {
        self.measure(task).ok()?;
        (self.linearise(task) && self.direct(task)).then(|| self.step.clone())
    }

    /// What each column does to the lengths of these groups, by rows; where asked, what closing the gaps does behind them.
    fn lengthen(
        &self,
        task: &Task<'_>,
        groups: &[usize],
        columns: &[Column],
        closing: bool,
        out: &mut Vec<f64>,
    ) {
        let wide = columns.len() + usize::from(closing);
        out.clear();
        out.resize(groups.len() * wide, 0.0);
        let row_of = |group: usize| groups.iter().position(|&of| of == group);
        for (k, span) in task.frame.spans.iter().enumerate() {
            let cables = span.passages.len();
            let rows = &self.rows[ROWS * span.first..ROWS * (span.first + cables)];
            for j in 0..wide {
                let column = columns.get(j).copied().unwrap_or(Column::Closing);
                let Change { turn, moment, force } = self.elimination.change(k, j);
                let push = Push { turn, moment, force, ..self.push(task, k, column) };
                let change = self.links[k].pass(&push).0;
                for i in 0..cables {
                    let Some(row) = row_of(task.groups[span.first + i]) else { continue };
                    let by = |c: usize| rows[c * cables + i];
                    let along: f64 = (0..3)
                        .map(|c| {
                            by(c) * change.linear[c]
                                + by(3 + c) * change.angular[c]
                                + by(6 + c) * turn[c]
                        })
                        .sum();
                    let own = match column {
                        Column::Load => by(9),
                        _ => Self::own(task, k, i, column, &self.anchor_rows[span.anchor_rows..]),
                    };
                    out[row * wide + j] += along + own;
                }
            }
        }
    }

    /// `∂ℓ/∂τ` of all groups, from a closed chain that is linearised where it stands.
    pub(super) fn differentiate(&mut self, task: &Task<'_>) -> bool {
        let mut all = core::mem::take(&mut self.all);
        all.clear();
        all.extend(0..self.tensions.len());
        let mut columns = core::mem::take(&mut self.shared_columns);
        columns.clear();
        columns.extend(all.iter().map(|&group| Column::Tension(group)));
        let eliminated = self.eliminate(task, &columns);
        if eliminated {
            let mut out = core::mem::take(&mut self.length_by_tension);
            self.lengthen(task, &all, &columns, false, &mut out);
            self.length_by_tension = out;
        }
        (self.all, self.shared_columns) = (all, columns);
        eliminated
    }
}
