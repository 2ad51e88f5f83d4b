//! The list of holes whose shapes are nearest to the goals, of all lists: a beam search for a good one, then depth-first branch and bound, then, where that does not end,
//! the partial lists with the least bound first.
//!
//! The sum over the disks so far is a lower bound of the cost of all lists that go on from there, because the rest adds squares, eq. (2). Where targets are out of reach, the rest
//! adds much, and [`TailBound`] says how much at least.

use core::cmp::Ordering;
use std::collections::BinaryHeap;

use whipcord::{Pose, Vec3};

use crate::budget::Budget;
use crate::choices::Choices;
use crate::goal::ShapeGoal;
use crate::span_table::SpanTable;
use crate::tail_bound::TailBound;

/// A list of combinations, one for each disk.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub list: Vec<usize>,
    pub cost: f64,
    /// Whether no other list costs less.
    pub is_proven: bool,
    /// What every list costs at least, as far as that is known.
    pub least: f64,
    /// Spans that were looked at.
    pub nodes: usize,
}

/// What is searched.
pub(crate) struct ShapeSearch<'a> {
    choices: &'a Choices,
    table: &'a SpanTable,
    goals: &'a [ShapeGoal],
    budget: &'a Budget,
    /// What each goal wants of each disk, one disk after the other.
    wanted: Vec<Vec<(usize, Vec3)>>,
    disks: usize,
}

/// Partial lists that the beam keeps: few at first, and more where these do not lead to a proof soon.
const BEAMS: [(usize, usize); 2] = [(100, 3_000_000), (2_000, usize::MAX)];
/// Where the bound at the base is worth this part of the cost, targets are out of reach, and the list with the least bound goes first in the end.
const WORTH: f64 = 0.02;
/// Poses that the search by the least bound keeps, and the part of the spans that may be looked at that it gets.
const MOST_KEPT: usize = 1_000_000;
const LEAST_FIRST: usize = 4;

/// Spans after which the budget is looked at.
const LOOK: usize = 10_000;

impl<'a> ShapeSearch<'a> {
    pub fn new(
        choices: &'a Choices,
        table: &'a SpanTable,
        (goals, budget): (&'a [ShapeGoal], &'a Budget),
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
        let wanted = (0..disks).map(of_disk).collect();
        Self { choices, table, goals, budget, wanted, disks }
    }

    /// Searches within so many spans; without any the best of the beam.
    pub fn run(&self, most_nodes: usize) -> Option<Found> {
        let tail = TailBound::new(self.choices, self.table, self.goals, self.disks);
        // Where few disks have a target, sums alone do not lead anywhere.
        let wanted = self.wanted.iter().filter(|wanted| !wanted.is_empty()).count();
        let is_sparse = 2 * wanted < self.disks;
        let mut best = self.beam(BEAMS[0].0, tail.as_ref().filter(|_| is_sparse))?;
        best.least = self.first_cost();
        if let Some(tail) = &tail {
            let firsts = self.choices.at(0).iter();
            let least = firsts.map(|&first| tail.least(0, first, &self.table.bases));
            best.least += least.fold(f64::INFINITY, f64::min);
        }
        let is_far = best.least >= WORTH * best.cost;
        let guide = tail.as_ref().filter(|_| is_far || is_sparse);
        if is_far
            && !is_sparse
            && let Some(guided) = self.beam(BEAMS[0].0, guide)
            && guided.cost < best.cost
        {
            best = Found { least: best.least, ..guided };
        }
        if most_nodes == 0 {
            return Some(best);
        }
        let of_least_first = if is_far { most_nodes / LEAST_FIRST } else { 0 };
        let mut spent = 0;
        for (width, nodes) in BEAMS {
            if width > BEAMS[0].0
                && let Some(wider) = self.beam(width, guide)
                && wider.cost < best.cost
            {
                best = Found { least: best.least, ..wider };
            }
            let left = most_nodes.saturating_sub(of_least_first + spent);
            let found = self.depth_first(best, tail.as_ref(), nodes.min(left));
            spent += found.nodes;
            best = Found { nodes: spent, ..found };
            if best.is_proven {
                return Some(best);
            }
        }
        match &tail {
            Some(tail) if is_far => Some(self.least_first(best, tail, of_least_first)),
            _ => Some(best),
        }
    }

    fn depth_first(&self, best: Found, tail: Option<&TailBound>, most_nodes: usize) -> Found {
        let mut depth_first = DepthFirst {
            search: self,
            tail,
            best,
            list: Vec::with_capacity(self.disks),
            poses: vec![Pose::IDENTITY; self.disks * self.goals.len()],
            wanted: Vec::new(),
            sums: Vec::new(),
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
        let is_proven = nodes < depth_first.most_nodes;
        let best = depth_first.best;
        let least = if is_proven { best.cost } else { best.least };
        Found { nodes, is_proven, least, ..best }
    }

    /// What is wanted of a disk, in the frames of the disk before under each goal, with the weights.
    fn want(&self, disk: usize, before: &[Pose], into: &mut Vec<(usize, Vec3, f64)>) {
        into.clear();
        let seen = |(goal, point): &(usize, Vec3)| {
            (*goal, before[*goal].inverse().transform(*point), self.goals[*goal].weight)
        };
        into.extend(self.wanted[disk].iter().map(seen));
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

    /// The best of the lists that go on from so many partial ones at each disk: those with the least sum, or bound of the whole.
    fn beam(&self, width: usize, guide: Option<&TailBound>) -> Option<Found> {
        struct Partial {
            bound: f64,
            cost: f64,
            choice: usize,
            pair: usize,
            before: usize,
        }
        let goals = self.goals.len();
        let mut layers: Vec<Vec<Partial>> = Vec::with_capacity(self.disks);
        let first = self.first_cost();
        let start = self.choices.at(0).iter();
        let start = start.map(|&choice| {
            let (pair, before) = (0, 0);
            Partial { bound: first, cost: first, choice, pair, before }
        });
        layers.push(start.collect());
        let mut poses: Vec<Pose> =
            layers[0].iter().flat_map(|_| self.table.bases.clone()).collect();
        let (mut wanted, mut sums) = (Vec::new(), Vec::new());
        let mut moved = vec![Pose::IDENTITY; goals];
        for disk in 1..self.disks {
            let mut next: Vec<Partial> = Vec::new();
            for (before, partial) in layers[disk - 1].iter().enumerate() {
                let here = &poses[before * goals..(before + 1) * goals];
                self.want(disk, here, &mut wanted);
                let (first, followers) = self.choices.followers(partial.choice);
                let pairs = first..first + followers.len();
                self.table.distances(disk - 1, pairs.clone(), &wanted, &mut sums);
                for ((more, pair), &choice) in sums.iter().zip(pairs).zip(followers) {
                    let cost = partial.cost + more;
                    let mut bound = cost;
                    if let Some(guide) = guide.filter(|_| cost.is_finite()) {
                        self.moved(disk, pair, here, &mut moved);
                        bound += guide.least(disk, choice, &moved);
                    }
                    if bound.is_finite() {
                        next.push(Partial { bound, cost, choice, pair, before });
                    }
                }
            }
            // Of equal ones the first, so that the answer is always the same.
            let order = |a: &Partial, b: &Partial| {
                a.bound.total_cmp(&b.bound).then((a.before, a.choice).cmp(&(b.before, b.choice)))
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
        Some(Found { list, cost, is_proven: false, least: 0.0, nodes: 0 })
    }

    /// Goes on from the partial list with the least bound, until that is no less than the best list or the spans are spent. The least bound of all is then
    /// what every list costs at least.
    fn least_first(&self, best: Found, tail: &TailBound, most_nodes: usize) -> Found {
        let goals = self.goals.len();
        let mut open = BinaryHeap::new();
        // Of each partial list its last choice, and the partial list before.
        let mut known: Vec<(usize, Option<usize>)> = Vec::new();
        let mut poses: Vec<Pose> = Vec::new();
        for &first in self.choices.at(0) {
            let cost = self.first_cost();
            let bound = cost + tail.least(0, first, &self.table.bases);
            open.push(Open { bound, cost, disk: 0, number: known.len() });
            known.push((first, None));
            poses.extend_from_slice(&self.table.bases);
        }
        let (mut wanted, mut sums) = (Vec::new(), Vec::new());
        let mut found = best;
        let mut nodes = 0;
        let mut moved = vec![Pose::IDENTITY; goals];
        while let Some(partial) = open.pop() {
            found.least = found.least.max(partial.bound.min(found.cost));
            if partial.bound >= found.cost {
                found.is_proven = true;
                break;
            }
            if nodes >= most_nodes || poses.len() >= MOST_KEPT {
                break;
            }
            let (choice, _) = known[partial.number];
            let disk = partial.disk + 1;
            let at = partial.number * goals;
            self.want(disk, &poses[at..at + goals], &mut wanted);
            let (first, followers) = self.choices.followers(choice);
            let pairs = first..first + followers.len();
            self.table.distances(disk - 1, pairs.clone(), &wanted, &mut sums);
            let before = nodes;
            nodes += followers.len();
            if before / LOOK != nodes / LOOK && self.budget.is_over() {
                open.push(partial);
                break;
            }
            for ((more, pair), &choice) in sums.iter().zip(pairs).zip(followers) {
                let cost = partial.cost + more;
                if cost >= found.cost {
                    continue;
                }
                self.moved(disk, pair, &poses[at..at + goals], &mut moved);
                nodes += tail.effort(disk);
                let bound = cost + tail.least(disk, choice, &moved);
                if bound >= found.cost {
                    continue;
                }
                if disk + 1 == self.disks {
                    found.cost = cost;
                    found.list = vec![choice];
                    let mut before = Some(partial.number);
                    while let Some(number) = before {
                        found.list.push(known[number].0);
                        before = known[number].1;
                    }
                    found.list.reverse();
                    continue;
                }
                open.push(Open { bound, cost, disk, number: known.len() });
                known.push((choice, Some(partial.number)));
                poses.extend_from_slice(&moved);
            }
        }
        if open.is_empty() {
            found.is_proven = true;
        }
        if found.is_proven {
            found.least = found.cost;
        }
        Found { nodes: found.nodes + nodes, ..found }
    }
}

/// A partial list that others may follow.
struct Open {
    bound: f64,
    cost: f64,
    disk: usize,
    number: usize,
}

impl Ord for Open {
    /// The greatest is the one with the least bound; of equal ones the longest, then the first.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_bound = other.bound.total_cmp(&self.bound);
        by_bound.then(self.disk.cmp(&other.disk)).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

struct DepthFirst<'a> {
    search: &'a ShapeSearch<'a>,
    tail: Option<&'a TailBound>,
    best: Found,
    list: Vec<usize>,
    /// Of each disk, all goals.
    poses: Vec<Pose>,
    /// What is wanted of the disk that is looked at, in the frames of the disk before.
    wanted: Vec<(usize, Vec3, f64)>,
    /// What each follower of the disk that is looked at adds.
    sums: Vec<f64>,
    /// What may follow at each disk, the least bound first: that bound, what it adds, the pair and the choice.
    children: Vec<Vec<(f64, f64, usize, usize)>>,
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
        let (before, rest) = self.poses.split_at_mut(disk * goals);
        let before = &before[(disk - 1) * goals..];
        search.want(disk, before, &mut self.wanted);
        let (first, followers) = search.choices.followers(from);
        let pairs = first..first + followers.len();
        search.table.distances(disk - 1, pairs.clone(), &self.wanted, &mut self.sums);
        let nodes = self.nodes;
        self.nodes += followers.len();
        if nodes / LOOK != self.nodes / LOOK && self.search.budget.is_over() {
            self.most_nodes = 0;
        }
        let room = self.best.cost - cost;
        for ((&more, pair), &choice) in self.sums.iter().zip(pairs).zip(followers) {
            if more >= room {
                continue;
            }
            let mut bound = more;
            if let Some(tail) = self.tail {
                search.moved(disk, pair, before, &mut rest[..goals]);
                self.nodes += tail.effort(disk);
                bound += tail.least(disk, choice, &rest[..goals]);
                if bound >= room {
                    continue;
                }
            }
            children.push((bound, more, pair, choice));
        }
        children.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(bound, more, pair, choice) in &children {
            if cost + bound >= self.best.cost {
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
