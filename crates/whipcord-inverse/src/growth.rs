//! The growth of a workspace from voxel to voxel.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use whipcord::Vec3;

use crate::cell::{BoundaryPoint, Cell};
use crate::error::InverseError;
use crate::options::ReachOptions;
use crate::solver::InverseSolver;
use crate::voxel_search::{Findings, Index, Known, Question, Way, beside};

/// Voxels whose neighbours are looked for in one round, from what was found in the rounds before: so many that threads are busy, and so few that
/// neighbours are seldom looked for twice.
const ROUND: usize = 256;

/// A voxel that is missing beside so many marked ones is asked for from all of them.
const AROUND: usize = 4;

/// The growth so far.
pub(crate) struct Growth<'a> {
    question: Question<'a>,
    found: BTreeMap<Index, Known>,
    /// Points of the boundary, each with the voxel whose centre is beyond it.
    boundary: Vec<(Index, BoundaryPoint)>,
    /// Solves of the model.
    pub solves: usize,
    asked: BTreeSet<Index>,
    queue: VecDeque<Index>,
}

impl<'a> Growth<'a> {
    pub fn new(
        solver: &'a InverseSolver,
        voxel: f64,
        reach: ReachOptions,
        has_stiffness: bool,
    ) -> Self {
        let constraints = solver.constraints(solver.ranges(), &reach);
        Self {
            question: Question { solver, voxel, reach, constraints, has_stiffness },
            found: BTreeMap::new(),
            boundary: Vec::new(),
            solves: 0,
            asked: BTreeSet::new(),
            queue: VecDeque::new(),
        }
    }

    /// Marks the voxels of shapes, given by tips and unknowns. Where one keeps no limit its voxel is a target from there.
    pub fn mark(&mut self, shapes: Vec<(Vec3, Vec<f64>)>) -> Result<(), InverseError> {
        let mut marked: BTreeMap<Index, Vec<f64>> = BTreeMap::new();
        for (tip, unknowns) in shapes {
            marked.entry(self.question.index(tip)).or_insert(unknowns);
        }
        let work = |(index, unknowns): &(Index, Vec<f64>), solver: &mut InverseSolver| {
            let mut findings = Findings::default();
            let way = Way { index: *index, next: unknowns, back: unknowns };
            let found = self.question.go(solver, way, &self.found, &mut findings, |_| true)?;
            if let Some(answer) = found {
                findings.found.push(self.question.known(solver, unknowns, answer)?);
            }
            Ok(findings)
        };
        let marked: Vec<(Index, Vec<f64>)> = marked.into_iter().collect();
        for findings in self.question.shared(&marked, work)? {
            self.take(findings);
        }
        // Spread over the workspace, so that what is left when the solves are spent is not one side of it.
        self.queue.make_contiguous().sort_by_key(|index| scrambled(*index));
        Ok(())
    }

    fn take(&mut self, findings: Findings) {
        self.solves += findings.solves;
        self.boundary.extend(findings.boundary);
        for (index, known) in findings.found {
            match self.found.get_mut(&index) {
                Some(before) => before.cell.is_full |= known.cell.is_full,
                None => {
                    self.found.insert(index, known);
                    self.queue.push_back(index);
                }
            }
        }
    }

    /// Looks for all voxels beside the marked ones, until there are none that were not asked for, or the solves are spent.
    /// Whether it came to that.
    pub fn grow(&mut self, solves: usize) -> Result<bool, InverseError> {
        let mut closed = BTreeSet::new();
        loop {
            self.go_outward(solves)?;
            let gaps = self.gaps(&mut closed);
            if gaps.is_empty() || self.solves >= solves {
                break;
            }
            let work = |(from, index): &(Index, Index), solver: &mut InverseSolver| {
                let mut findings = Findings::default();
                if let Some(known) = self.found.get(from) {
                    self.question.look_for(solver, *index, known, &self.found, &mut findings)?;
                }
                Ok(findings)
            };
            // What holds the tip back on one of several ways is no boundary.
            for Findings { found, solves, .. } in self.question.shared(&gaps, work)? {
                self.take(Findings { found, solves, ..Findings::default() });
            }
        }
        let indices: BTreeSet<Index> = self.found.keys().copied().collect();
        for (index, known) in &mut self.found {
            known.cell.is_full |= beside(*index).iter().all(|index| indices.contains(index));
        }
        Ok(self.queue.is_empty())
    }

    /// The cells in ascending order and the points of the boundary: not those where another way leads to the centre that was beyond them.
    pub fn into_parts(self) -> (Vec<Cell>, Vec<BoundaryPoint>) {
        let Self { found, boundary, .. } = self;
        let is_full = |index: &Index| found.get(index).is_some_and(|known| known.cell.is_full);
        let kept = boundary.into_iter().filter(|(index, _)| !is_full(index));
        let boundary = kept.map(|(_, point)| point).collect();
        (found.into_values().map(|known| known.cell).collect(), boundary)
    }

    /// Each voxel is asked for once, from the first one beside it that is found.
    fn go_outward(&mut self, solves: usize) -> Result<(), InverseError> {
        while !self.queue.is_empty() && self.solves < solves {
            let mut round: Vec<(Index, Vec<Index>)> = Vec::with_capacity(ROUND);
            while round.len() < ROUND
                && let Some(from) = self.queue.pop_front()
            {
                let mut missing: Vec<Index> = beside(from).into();
                missing.retain(|index| !self.found.contains_key(index));
                if !missing.is_empty() {
                    missing.retain(|index| self.asked.insert(*index));
                    round.push((from, missing));
                }
            }
            let work = |(from, missing): &(Index, Vec<Index>), solver: &mut InverseSolver| {
                self.question.expand(solver, *from, missing, &self.found)
            };
            let all = self.question.shared(&round, work)?;
            for ((from, _), findings) in round.iter().zip(all) {
                if findings.is_full
                    && let Some(known) = self.found.get_mut(from)
                {
                    known.cell.is_full = true;
                }
                self.take(findings);
            }
        }
        Ok(())
    }

    /// The voxels that are missing among marked ones, each with all of these: from one of them the way may end at a fold that another one goes round.
    fn gaps(&self, closed: &mut BTreeSet<Index>) -> Vec<(Index, Index)> {
        let is_known = |index: &Index| self.found.contains_key(index);
        let mut gaps = Vec::new();
        for &index in &self.asked {
            let around = beside(index).into_iter().filter(is_known);
            if !is_known(&index) && around.clone().count() >= AROUND && closed.insert(index) {
                gaps.extend(around.map(|from| (from, index)));
            }
        }
        gaps
    }
}

/// A number without an order for each voxel.
fn scrambled([x, y, z]: Index) -> u64 {
    let mix = |state: u64, i: i32| {
        (state ^ u64::from(i.cast_unsigned())).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29)
    };
    mix(mix(mix(0, x), y), z)
}
