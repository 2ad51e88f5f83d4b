//! The list of holes whose shapes are nearest to the goals, of all lists: a beam search for a good one, then depth-first branch and bound.
//!
//! The sum over the disks so far is a lower bound of the cost of all lists that go on from there, because the rest adds squares, eq. (2).

use whipcord::{Pose, Vec3};

use crate::choices::Choices;
use crate::goal::ShapeGoal;
use crate::span_table::SpanTable;

/// A list of combinations, one for each disk.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub list: Vec<usize>,
    pub cost: f64,
    /// Whether no other list costs less.
    pub is_proven: bool,
    /// Spans that were looked at.
    pub nodes: usize,
}

/// What is searched.
pub(crate) struct ShapeSearch<'a> {
    choices: &'a Choices,
    table: &'a SpanTable,
    goals: &'a [ShapeGoal],
    /// What each goal wants of each disk, one disk after the other.
    wanted: Vec<Vec<(usize, Vec3)>>,
    disks: usize,
}

/// Partial lists that the beam keeps: few at first, and more where these do not lead to a proof soon.
const BEAMS: [(usize, usize); 2] = [(100, 3_000_000), (2_000, usize::MAX)];

impl<'a> ShapeSearch<'a> {
    pub fn new(
        choices: &'a Choices,
        table: &'a SpanTable,
        goals: &'a [ShapeGoal],
        disks: usize,
    ) -> Self {
        let of_disk = |disk: usize| {
            let points = goals.iter().enumerate().flat_map(move |(number, goal)| {
                goal.points
                    .iter()
                    .filter(move |(of, _)| *of == disk)
                    .map(move |(_, p)| (number, *p))
            });
            points.collect()
        };
        Self { choices, table, goals, wanted: (0..disks).map(of_disk).collect(), disks }
    }

    /// Searches within so many spans.
    pub fn run(&self, most_nodes: usize) -> Option<Found> {
        let mut best: Option<Found> = None;
        let mut spent = 0;
        for (width, nodes) in BEAMS {
            let found = self.beam(width)?;
            // A list that the search before came to may be the better one.
            let start = match best.take() {
                Some(known) if known.cost <= found.cost => known,
                _ => found,
            };
            let left = most_nodes.saturating_sub(spent);
            let found = self.depth_first(start, nodes.min(left));
            spent += found.nodes;
            let is_done = found.is_proven || spent >= most_nodes;
            best = Some(Found { nodes: spent, ..found });
            if is_done {
                break;
            }
        }
        best
    }

    fn depth_first(&self, best: Found, most_nodes: usize) -> Found {
        let mut depth_first = DepthFirst {
            search: self,
            best,
            list: Vec::with_capacity(self.disks),
            poses: vec![Pose::IDENTITY; self.disks * self.goals.len()],
            wanted: vec![Vec::new(); self.disks],
            children: vec![Vec::new(); self.disks],
            nodes: 0,
            most_nodes,
        };
        for &first in self.choices.at(0) {
            depth_first.list.push(first);
            depth_first.poses[..self.goals.len()].copy_from_slice(&self.table.bases);
            let cost = self.first_cost();
            depth_first.go(1, cost);
            depth_first.list.pop();
        }
        let nodes = depth_first.nodes;
        Found { nodes, is_proven: nodes < most_nodes, ..depth_first.best }
    }

    /// What is wanted of a disk, in the frames of the disk before under each goal.
    fn want(&self, disk: usize, before: &[Pose], into: &mut Vec<(usize, Vec3)>) {
        into.clear();
        let seen =
            |(goal, point): &(usize, Vec3)| (*goal, before[*goal].inverse().transform(*point));
        into.extend(self.wanted[disk].iter().map(seen));
    }

    /// What a disk adds behind a pair; `None` where the model has no answer under one of the goals.
    fn added(&self, disk: usize, pair: usize, wanted: &[(usize, Vec3)]) -> Option<f64> {
        let span = |goal: usize| self.table.span(goal, disk - 1, pair);
        if (0..self.goals.len()).any(|goal| span(goal).is_none()) {
            return None;
        }
        let mut sum = 0.0;
        for (goal, point) in wanted {
            let off = span(*goal)?.position - *point;
            sum += self.goals[*goal].weight * off.dot(off);
        }
        Some(sum)
    }

    /// What the first disks add, which no hole moves.
    fn first_cost(&self) -> f64 {
        let square = |(goal, point): &(usize, Vec3)| {
            let off = self.table.bases[*goal].position - *point;
            self.goals[*goal].weight * off.dot(off)
        };
        self.wanted[0].iter().map(square).sum()
    }

    /// The poses of a disk behind a pair under all goals.
    fn moved(&self, disk: usize, pair: usize, before: &[Pose], into: &mut [Pose]) {
        for (goal, (pose, before)) in into.iter_mut().zip(before).enumerate() {
            if let Some(span) = self.table.span(goal, disk - 1, pair) {
                *pose = *before * *span;
            }
        }
    }

    fn beam(&self, width: usize) -> Option<Found> {
        struct Partial {
            cost: f64,
            choice: usize,
            pair: usize,
            before: usize,
        }
        let goals = self.goals.len();
        let mut layers: Vec<Vec<Partial>> = Vec::with_capacity(self.disks);
        let first = self.first_cost();
        let start = self.choices.at(0).iter();
        let start = start.map(|&choice| Partial { cost: first, choice, pair: 0, before: 0 });
        layers.push(start.collect());
        let mut poses: Vec<Pose> =
            layers[0].iter().flat_map(|_| self.table.bases.clone()).collect();
        let mut wanted = Vec::new();
        for disk in 1..self.disks {
            let mut next: Vec<Partial> = Vec::new();
            for (before, partial) in layers[disk - 1].iter().enumerate() {
                self.want(disk, &poses[before * goals..(before + 1) * goals], &mut wanted);
                for (pair, choice) in self.choices.pairs_after(partial.choice, disk) {
                    if let Some(more) = self.added(disk, pair, &wanted) {
                        next.push(Partial { cost: partial.cost + more, choice, pair, before });
                    }
                }
            }
            // Of equal ones the first, so that the answer is always the same.
            let order = |a: &Partial, b: &Partial| {
                a.cost.total_cmp(&b.cost).then((a.before, a.choice).cmp(&(b.before, b.choice)))
            };
            if next.len() > width {
                next.select_nth_unstable_by(width, order);
                next.truncate(width);
            }
            next.sort_unstable_by(order);
            let mut kept = vec![Pose::IDENTITY; next.len() * goals];
            for (partial, kept) in next.iter().zip(kept.chunks_exact_mut(goals)) {
                let before = &poses[partial.before * goals..(partial.before + 1) * goals];
                self.moved(disk, partial.pair, before, kept);
            }
            poses = kept;
            layers.push(next);
        }
        let mut at = 0;
        let cost = layers.last()?.first()?.cost;
        let mut list = Vec::with_capacity(self.disks);
        for layer in layers.iter().rev() {
            list.push(layer[at].choice);
            at = layer[at].before;
        }
        list.reverse();
        Some(Found { list, cost, is_proven: false, nodes: 0 })
    }
}

struct DepthFirst<'a> {
    search: &'a ShapeSearch<'a>,
    best: Found,
    list: Vec<usize>,
    /// Of each disk, all goals.
    poses: Vec<Pose>,
    /// What is wanted of each disk, in the frames of the disk before.
    wanted: Vec<Vec<(usize, Vec3)>>,
    /// What may follow at each disk, the nearest first: what it adds, the pair and the choice.
    children: Vec<Vec<(f64, usize, usize)>>,
    nodes: usize,
    most_nodes: usize,
}

impl DepthFirst<'_> {
    fn go(&mut self, disk: usize, cost: f64) {
        if cost >= self.best.cost || self.nodes >= self.most_nodes {
            return;
        }
        if disk == self.search.disks {
            self.best.cost = cost;
            self.best.list.clone_from(&self.list);
            return;
        }
        let goals = self.search.goals.len();
        let Some(&from) = self.list.last() else { return };
        let mut children = core::mem::take(&mut self.children[disk]);
        children.clear();
        let search = self.search;
        let before = &self.poses[(disk - 1) * goals..disk * goals];
        search.want(disk, before, &mut self.wanted[disk]);
        for (pair, choice) in search.choices.pairs_after(from, disk) {
            self.nodes += 1;
            if let Some(more) = search.added(disk, pair, &self.wanted[disk])
                && cost + more < self.best.cost
            {
                children.push((more, pair, choice));
            }
        }
        children.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(more, pair, choice) in &children {
            if cost + more >= self.best.cost {
                break;
            }
            let (before, rest) = self.poses.split_at_mut(disk * goals);
            search.moved(disk, pair, &before[(disk - 1) * goals..], &mut rest[..goals]);
            self.list.push(choice);
            self.go(disk + 1, cost + more);
            self.list.pop();
        }
        self.children[disk] = children;
    }
}
