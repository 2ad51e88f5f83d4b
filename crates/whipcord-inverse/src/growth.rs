//! The growth of a workspace from voxel to voxel.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use whipcord::derivatives::Place;
use whipcord::jobs::share;
use whipcord::kinematics::{dexterity, principal_axes};
use whipcord::{Linearization, SolveError, Twist, Vec3};

use crate::cell::{BoundaryPoint, Cell};
use crate::descent::{Control, Ending, FIRST_DAMPING, Region, Start};
use crate::error::InverseError;
use crate::evaluation::Evaluation;
use crate::limit::Constraints;
use crate::linear::Linear;
use crate::options::ReachOptions;
use crate::solver::InverseSolver;
use crate::target::{Target, Tolerance};

/// The directions of a voxel's neighbours.
const NEIGHBOURS: [[i32; 3]; 6] =
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
/// A centre is reached where the tip is this near to it, in voxels.
const AT_CENTRE: f64 = 0.05;
/// A step to the next voxel changes no command by more than this, in scales.
const LARGEST_STEP: f64 = 0.25;
/// Voxels whose neighbours are looked for in one round, from what was found in the rounds before: so many that threads are busy, and so few that
/// neighbours are seldom looked for twice.
const ROUND: usize = 256;

/// A voxel that is missing beside so many marked ones is asked for from all of them.
const AROUND: usize = 4;

type Index = [i32; 3];

/// What is known of a voxel.
struct Known {
    cell: Cell,
    unknowns: Vec<f64>,
    /// Motions of the tip with the unknowns, in m for the unit of each.
    motions: Vec<Vec3>,
}

/// An answer of the model, with all its derivatives where it has exact ones that are not computed later, for what is kept.
struct Answer {
    evaluation: Evaluation,
    rates: Option<Linearization>,
}

impl Answer {
    fn tip(&self) -> Vec3 {
        self.evaluation.solution.disks.poses.last().copied().unwrap_or_default().position
    }
}

/// What is looked for, and by what.
struct Question<'a> {
    solver: &'a InverseSolver,
    voxel: f64,
    reach: ReachOptions,
    constraints: Constraints,
    has_stiffness: bool,
}

/// A way to a voxel: the unknowns that may lead there, and those to search from where the model has no answer to them.
struct Way<'a> {
    index: Index,
    next: &'a [f64],
    back: &'a [f64],
}

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

/// What a job has found.
#[derive(Default)]
struct Findings {
    found: Vec<(Index, Known)>,
    boundary: Vec<(Index, BoundaryPoint)>,
    /// Whether the voxel that it began at is full.
    is_full: bool,
    solves: usize,
}

fn beside([x, y, z]: Index) -> [Index; 6] {
    NEIGHBOURS.map(|[a, b, c]| [x + a, y + b, z + c])
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

impl Question<'_> {
    /// What each job finds, in their order; by threads, each of which has a solver of its own.
    fn shared<J: Sync>(
        &self,
        jobs: &[J],
        work: impl Fn(&J, &mut InverseSolver) -> Result<Findings, SolveError> + Sync,
    ) -> Result<Vec<Findings>, InverseError> {
        let mut all: Vec<Option<Result<Findings, SolveError>>> = Vec::new();
        all.resize_with(jobs.len(), || None);
        let solver = || self.solver.for_survey();
        let pairs = jobs.iter().zip(&mut all);
        share(pairs, None, solver, |(job, findings), solver| {
            let found = match solver {
                Ok(solver) => {
                    let before = solver.forward().solves;
                    work(job, solver).map(|mut found| {
                        found.solves = solver.forward().solves - before;
                        found
                    })
                }
                Err(error) => Err(error.clone()),
            };
            let goes_on = found.is_ok();
            *findings = Some(found);
            goes_on
        })
        .map_err(|error| InverseError::Atlas(error.to_string()))?;
        // The first error in the order of the jobs ends all; what lies behind it was perhaps not begun.
        let done: Result<Vec<Findings>, SolveError> = all.into_iter().flatten().collect();
        Ok(done?)
    }

    fn index(&self, point: Vec3) -> Index {
        // Points are within the length of the robot from its base, in a thousand voxels at most.
        #[allow(clippy::cast_possible_truncation, reason = "far below 2³¹")]
        point.to_array().map(|x| (x / self.voxel).floor() as i32)
    }

    fn centre(&self, index: Index) -> Vec3 {
        let [x, y, z] = index.map(|i| (f64::from(i) + 0.5) * self.voxel);
        Vec3::new(x, y, z)
    }

    fn is_at_centre(&self, index: Index, tip: Vec3) -> bool {
        (self.centre(index) - tip).norm() <= AT_CENTRE * self.voxel
    }

    /// The voxels beside a known one that are missing, and whether it is full itself if one stays missing.
    fn expand(
        &self,
        solver: &mut InverseSolver,
        from: Index,
        missing: &[Index],
        found: &BTreeMap<Index, Known>,
    ) -> Result<Findings, SolveError> {
        let mut findings = Findings::default();
        let Some(known) = found.get(&from) else { return Ok(findings) };
        for &index in missing {
            self.look_for(solver, index, known, found, &mut findings)?;
        }
        let is_known = |index: &Index| {
            found.contains_key(index) || findings.found.iter().any(|(at, _)| at == index)
        };
        if beside(from).iter().all(is_known) {
            return Ok(findings);
        }
        let next = self.step_to(solver, from, known);
        let way = Way { index: from, next: &next, back: &known.unknowns };
        let is_at_centre = |tip: Vec3| self.is_at_centre(from, tip);
        findings.is_full |= self.go(solver, way, found, &mut findings, is_at_centre)?.is_some();
        Ok(findings)
    }

    /// Looks for a voxel that is missing: where the first step leads, and by the search for its centre from there.
    fn look_for(
        &self,
        solver: &mut InverseSolver,
        index: Index,
        known: &Known,
        found: &BTreeMap<Index, Known>,
        findings: &mut Findings,
    ) -> Result<(), SolveError> {
        let next = self.step_to(solver, index, known);
        let way = Way { index, next: &next, back: &known.unknowns };
        let is_in_voxel = |tip: Vec3| self.index(tip) == index;
        if let Some(answer) = self.go(solver, way, found, findings, is_in_voxel)? {
            findings.found.push(self.known(solver, &next, answer)?);
        }
        Ok(())
    }

    /// What is at the next unknowns of a way, if that is wanted; or else what the search for the centre of the voxel finds from there, which is noted.
    fn go(
        &self,
        solver: &mut InverseSolver,
        Way { index, next, back }: Way<'_>,
        found: &BTreeMap<Index, Known>,
        findings: &mut Findings,
        is_wanted: impl Fn(Vec3) -> bool,
    ) -> Result<Option<Answer>, SolveError> {
        let answer = self.answer(solver, next)?;
        let is_there = match &answer {
            Some(answer) => {
                is_wanted(answer.tip()) && self.is_allowed(solver, next, &answer.evaluation)?
            }
            None => false,
        };
        if is_there {
            return Ok(answer);
        }
        let start = match &answer {
            Some(answer) => Start::Known(next, &answer.evaluation),
            None => Start::At(back),
        };
        self.ask(solver, index, start, found, findings)?;
        Ok(None)
    }

    /// The unknowns that lead the tip from a known place to the centre of a voxel, to first order and within the bounds.
    fn step_to(&self, solver: &mut InverseSolver, to: Index, known: &Known) -> Vec<f64> {
        let residual = (known.cell.tip - self.centre(to)).to_array();
        let row = |i: usize| known.motions.iter().map(move |motion| motion.to_array()[i]);
        let linear = Linear {
            residual: residual.to_vec(),
            jacobian: (0..3).flat_map(row).collect(),
            ..Linear::default()
        };
        let scales = solver.forward().scales.clone();
        let bounds = solver.ranges().unknowns.clone();
        let control = Control {
            bounds: &bounds,
            scales: &scales,
            evaluations: 1,
            ending: Ending::COARSE,
            curvature: None,
        };
        let mut unknowns = known.unknowns.clone();
        let workspace = &mut solver.workspace;
        let region = Region { damping: FIRST_DAMPING, radius: LARGEST_STEP };
        if workspace.step(&linear, &[], &known.unknowns, &control, region, 0.0).is_ok() {
            let steps = workspace.last_step().iter().zip(&scales).zip(&bounds);
            for (x, ((step, scale), [least, greatest])) in unknowns.iter_mut().zip(steps) {
                *x = (*x + step * scale).max(*least).min(*greatest);
            }
        }
        unknowns
    }

    /// The answer of the model at these unknowns; `None` where it has none.
    fn answer(
        &self,
        solver: &mut InverseSolver,
        unknowns: &[f64],
    ) -> Result<Option<Answer>, SolveError> {
        let forward = solver.forward_mut();
        let found = match forward.is_on_few_steps() {
            true => forward.evaluate_answer(unknowns, &self.places()).map(|of| (of, None)),
            false => forward.answer_with_rates(unknowns, &self.places(), None),
        };
        match found {
            Ok((evaluation, rates)) => Ok(Some(Answer { evaluation, rates })),
            Err(error @ SolveError::Cancelled { .. }) => Err(error),
            Err(_) => Ok(None),
        }
    }

    fn places(&self) -> Vec<Place> {
        [Place::Tip].into_iter().chain(self.constraints.places()).collect()
    }

    /// Whether an answer keeps the limits and is stable.
    fn is_allowed(
        &self,
        solver: &mut InverseSolver,
        unknowns: &[f64],
        evaluation: &Evaluation,
    ) -> Result<bool, SolveError> {
        let forward = solver.forward_mut();
        let (_, is_exceeded) = self.constraints.active(forward.robot(), evaluation);
        let solution = &evaluation.solution;
        let touches = self.reach.clearance.is_some() && !solution.contacts.is_empty();
        if is_exceeded || touches {
            return Ok(false);
        }
        if solution.diagnostics.is_unstable() {
            // At the lengths that are commanded it may be stable where at the tensions that are searched it is not.
            let is_stable = !forward.actuators.are_direct()
                && match forward.verify(unknowns, &evaluation.shortenings, solution) {
                    Ok(answer) => !answer.diagnostics.is_unstable(),
                    Err(error @ SolveError::Cancelled { .. }) => return Err(error),
                    Err(_) => false,
                };
            return Ok(is_stable);
        }
        Ok(true)
    }

    /// Looks for commands that bring the tip to the centre of a voxel, from a place near it.
    fn ask(
        &self,
        solver: &mut InverseSolver,
        index: Index,
        start: Start<'_, Evaluation>,
        found: &BTreeMap<Index, Known>,
        findings: &mut Findings,
    ) -> Result<(), SolveError> {
        let centre = self.centre(index);
        let tolerance = Tolerance { position: AT_CENTRE * self.voxel, angle: 1.0 };
        let aim = (&Target::Tip(centre), tolerance);
        let candidate = match solver.attempt(start, aim, &self.constraints, &self.reach) {
            Ok(candidate) => candidate,
            Err(error @ SolveError::Cancelled { .. }) => return Err(error),
            Err(_) => return Ok(()),
        };
        let Some(tip) = candidate.evaluation.solution.disks.poses.last() else { return Ok(()) };
        let out = centre - tip.position;
        let distance = out.norm();
        // A minimum of the distance from a centre out of reach is a point of the boundary.
        if !candidate.is_reached && candidate.is_minimum && distance >= AT_CENTRE * self.voxel {
            let bounds = &solver.ranges().unknowns;
            let (unknowns, evaluation) = (&candidate.unknowns, &candidate.evaluation);
            let limits = self.constraints.met(solver.forward(), evaluation, unknowns, bounds);
            let normal = out * (1.0 / distance);
            findings.boundary.push((index, BoundaryPoint { tip: tip.position, normal, limits }));
        }
        if !candidate.is_allowed {
            return Ok(());
        }
        let at = self.index(tip.position);
        let is_full = candidate.is_reached && at == index;
        if found.contains_key(&at) || findings.found.iter().any(|(known, _)| *known == at) {
            findings.is_full |= is_full;
            return Ok(());
        }
        let unknowns = &candidate.unknowns;
        let Some(answer) = self.answer(solver, unknowns)? else { return Ok(()) };
        if self.is_allowed(solver, unknowns, &answer.evaluation)? {
            let (at, mut known) = self.known(solver, unknowns, answer)?;
            known.cell.is_full |= is_full && at == index;
            findings.found.push((at, known));
        }
        Ok(())
    }

    /// The voxel of an answer, and what is known of it there.
    fn known(
        &self,
        solver: &mut InverseSolver,
        unknowns: &[f64],
        Answer { mut evaluation, mut rates }: Answer,
    ) -> Result<(Index, Known), SolveError> {
        let forward = solver.forward_mut();
        let is_open = self.has_stiffness || forward.has_approximate_rates();
        if rates.is_none() && forward.is_on_few_steps() && is_open {
            let near = Some(&evaluation.solution);
            match forward.answer_with_rates(unknowns, &self.places(), near) {
                Ok(exact) => (evaluation, rates) = exact,
                Err(error @ SolveError::Cancelled { .. }) => return Err(error),
                Err(_) => {}
            }
        }
        let rates = rates.as_ref().filter(|_| self.has_stiffness);
        let compliance = rates.and_then(|rates| forward.tip_compliance(rates));
        let of_tip = |motions: &Vec<Twist>| motions.first().copied().unwrap_or_default();
        let motions: Vec<Twist> = evaluation.rates.motions.iter().map(of_tip).collect();
        let columns = motions.iter().zip(&forward.scales).map(|(motion, scale)| Twist {
            linear: motion.linear * *scale,
            angular: motion.angular * *scale,
        });
        let stiffness = compliance.map(|compliance| {
            let of = principal_axes(&compliance).values;
            [1.0 / of[2].max(of[0]), 1.0 / of[0].min(of[2])]
        });
        let pose = evaluation.solution.disks.poses.last().copied().unwrap_or_default();
        let index = self.index(pose.position);
        let values = forward.values(unknowns, &evaluation.solution);
        let cell = Cell {
            index,
            tip: pose.position,
            axis: pose.rotation.rotate(Vec3::Z),
            commands: forward.actuators.commands(forward.robot(), &values),
            is_full: false,
            dexterity: dexterity(&columns.collect::<Vec<_>>()),
            stiffness: stiffness.filter(|of| of.iter().all(|k| k.is_finite() && *k > 0.0)),
        };
        let motions = motions.iter().map(|motion| motion.linear).collect();
        Ok((index, Known { cell, unknowns: unknowns.to_vec(), motions }))
    }
}

/// A number without an order for each voxel.
fn scrambled([x, y, z]: Index) -> u64 {
    let mix = |state: u64, i: i32| {
        (state ^ u64::from(i.cast_unsigned())).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29)
    };
    mix(mix(mix(0, x), y), z)
}
