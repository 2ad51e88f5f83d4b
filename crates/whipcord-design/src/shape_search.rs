//! The list of holes whose shapes are nearest to the goals, of all lists: a beam search for a good one, then depth-first branch and bound.
//!
//! The sum over the disks so far is a lower bound of the cost of all lists that go on from there, because the rest adds squares, eq. (2).

use whipcord::Pose;

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
    wanted: Vec<Vec<(usize, whipcord::Vec3)>>,
    disks: usize,
}

/// Partial lists that the beam keeps.
const BEAM: usize = 2_000;

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
        let best = self.beam()?;
        let mut depth_first = DepthFirst {
            search: self,
            best,
            list: Vec::with_capacity(self.disks),
            poses: vec![Pose::IDENTITY; self.disks * self.goals.len()],
            children: vec![Vec::new(); self.disks],
            nodes: 0,
            most_nodes,
        };
        for &first in self.choices.at(0) {
            depth_first.list.push(first);
            depth_first.poses[..self.goals.len()].copy_from_slice(&self.table.bases);
            let cost = self.cost(0, &self.table.bases);
            depth_first.go(1, cost);
            depth_first.list.pop();
        }
        let nodes = depth_first.nodes;
        Some(Found { nodes, is_proven: nodes < most_nodes, ..depth_first.best })
    }

    /// What a disk adds at these poses of all goals.
    fn cost(&self, disk: usize, poses: &[Pose]) -> f64 {
        let square = |(goal, point): &(usize, whipcord::Vec3)| {
            let off = poses[*goal].position - *point;
            self.goals[*goal].weight * off.dot(off)
        };
        self.wanted[disk].iter().map(square).sum()
    }

    /// The poses of the next disk; `None` where the model has no answer.
    fn next(
        &self,
        disk: usize,
        before: &[Pose],
        pair: [usize; 2],
        poses: &mut [Pose],
    ) -> Option<()> {
        for (goal, (pose, before)) in poses.iter_mut().zip(before).enumerate() {
            *pose = *before * self.table.span(goal, disk - 1, pair[0], pair[1])?;
        }
        Some(())
    }

    fn beam(&self) -> Option<Found> {
        struct Partial {
            cost: f64,
            choice: usize,
            before: usize,
        }
        let goals = self.goals.len();
        let mut layers: Vec<Vec<Partial>> = Vec::with_capacity(self.disks);
        let first = self.cost(0, &self.table.bases);
        let start = self.choices.at(0).iter();
        layers.push(start.map(|&choice| Partial { cost: first, choice, before: 0 }).collect());
        let mut poses: Vec<Pose> =
            layers[0].iter().flat_map(|_| self.table.bases.clone()).collect();
        let mut moved = vec![Pose::IDENTITY; goals];
        for disk in 1..self.disks {
            let mut next: Vec<Partial> = Vec::new();
            for (before, partial) in layers[disk - 1].iter().enumerate() {
                let at = &poses[before * goals..(before + 1) * goals];
                for choice in self.choices.after(partial.choice, disk) {
                    if self.next(disk, at, [partial.choice, choice], &mut moved).is_some() {
                        let cost = partial.cost + self.cost(disk, &moved);
                        next.push(Partial { cost, choice, before });
                    }
                }
            }
            // Of equal ones the first, so that the answer is always the same.
            next.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            next.truncate(BEAM);
            let mut kept = Vec::with_capacity(next.len() * goals);
            for partial in &next {
                let before = &poses[partial.before * goals..(partial.before + 1) * goals];
                let from = layers[disk - 1][partial.before].choice;
                self.next(disk, before, [from, partial.choice], &mut moved)?;
                kept.extend_from_slice(&moved);
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
    /// What may follow at each disk, the nearest first.
    children: Vec<Vec<(f64, usize)>>,
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
        let (before, rest) = self.poses.split_at_mut(disk * goals);
        let before = &before[(disk - 1) * goals..];
        for choice in self.search.choices.after(from, disk) {
            self.nodes += 1;
            if self.search.next(disk, before, [from, choice], &mut rest[..goals]).is_some() {
                children.push((self.search.cost(disk, &rest[..goals]), choice));
            }
        }
        children.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(more, choice) in &children {
            if cost + more >= self.best.cost {
                break;
            }
            let (before, rest) = self.poses.split_at_mut(disk * goals);
            let before = &before[(disk - 1) * goals..];
            if self.search.next(disk, before, [from, choice], &mut rest[..goals]).is_some() {
                self.list.push(choice);
                self.go(disk + 1, cost + more);
                self.list.pop();
            }
        }
        self.children[disk] = children;
    }
}
