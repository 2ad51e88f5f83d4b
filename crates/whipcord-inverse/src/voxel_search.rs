//! What is asked of the model for a voxel: the way there from a known one, and the search for its centre.

use std::collections::BTreeMap;

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
/// Of a voxel along each axis.
pub(crate) type Index = [i32; 3];

/// What is known of a voxel.
pub(crate) struct Known {
    pub cell: Cell,
    pub unknowns: Vec<f64>,
    /// Motions of the tip with the unknowns, in m for the unit of each.
    pub motions: Vec<Vec3>,
}

/// An answer of the model, with all its derivatives where it has exact ones that are not computed later, for what is kept.
pub(crate) struct Answer {
    evaluation: Evaluation,
    rates: Option<Linearization>,
}

impl Answer {
    fn tip(&self) -> Vec3 {
        self.evaluation.solution.disks.poses.last().copied().unwrap_or_default().position
    }
}

/// What is looked for, and by what.
pub(crate) struct Question<'a> {
    pub solver: &'a InverseSolver,
    pub voxel: f64,
    pub reach: ReachOptions,
    pub constraints: Constraints,
    pub has_stiffness: bool,
}

/// A way to a voxel: the unknowns that may lead there, and those to search from where the model has no answer to them.
pub(crate) struct Way<'a> {
    pub index: Index,
    pub next: &'a [f64],
    pub back: &'a [f64],
}

/// What a job has found.
#[derive(Default)]
pub(crate) struct Findings {
    pub found: Vec<(Index, Known)>,
    pub boundary: Vec<(Index, BoundaryPoint)>,
    /// Whether the voxel that it began at is full.
    pub is_full: bool,
    pub solves: usize,
}

pub(crate) fn beside([x, y, z]: Index) -> [Index; 6] {
    NEIGHBOURS.map(|[a, b, c]| [x + a, y + b, z + c])
}

impl Question<'_> {
    /// What each job finds, in their order; by threads, each of which has a solver of its own.
    pub fn shared<J: Sync>(
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

    pub fn index(&self, point: Vec3) -> Index {
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
    pub fn expand(
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
    pub fn look_for(
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
    pub fn go(
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
        let answer = match self.differentiates_kept(solver) {
            true => Answer { evaluation: candidate.evaluation, rates: None },
            false => match self.answer(solver, unknowns)? {
                Some(of) if self.is_allowed(solver, unknowns, &of.evaluation)? => of,
                _ => return Ok(()),
            },
        };
        let (at, mut known) = self.known(solver, unknowns, answer)?;
        known.cell.is_full |= is_full && at == index;
        findings.found.push((at, known));
        Ok(())
    }

    /// Whether only what a voxel is kept with has all derivatives, or those that are exact.
    fn differentiates_kept(&self, solver: &InverseSolver) -> bool {
        let forward = solver.forward();
        forward.is_on_few_steps() && (self.has_stiffness || forward.has_approximate_rates())
    }

    /// The voxel of an answer, and what is known of it there.
    pub fn known(
        &self,
        solver: &mut InverseSolver,
        unknowns: &[f64],
        Answer { mut evaluation, mut rates }: Answer,
    ) -> Result<(Index, Known), SolveError> {
        let is_open = rates.is_none() && self.differentiates_kept(solver);
        let forward = solver.forward_mut();
        if is_open {
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
