//! The chain of sections among obstacles, as [`crate::contact`] asks it.

use std::borrow::Cow;

use whipcord_numerics::{Pose, Vec3, equally_spaced};

use super::contact_response::{ContactResponse, DrivenCables};
use super::holes_in_contact::HolesInContact;
use super::motion::Coordinates;
use super::statics::{Effort, FEW_ITERATIONS};
use super::task::{DeadMoments, Task};
use super::{Linkage, Workspace};
use crate::budget::Meter;
use crate::case::Case;
use crate::contact::model::{Compliant, Push};
use crate::contact::{self, Holding, Noted, NotedWay, Noting, OnWay};
use crate::error::SolveError;
use crate::shape::Wrench;
use crate::solution::{Diagnostics, NoStability, Solution};
use crate::statics::command::Command;
use crate::statics::friction::{History, Standing};
use crate::statics::options::StabilityAnalysis;

/// The backbone is watched at this many places or more from base to tip.
const WATCHED: usize = 80;
/// A known answer counts as found again where no disk is farther from it than this part of the length.
const FOUND_AGAIN: f64 = 1e-6;

/// Where the backbone is watched for obstacles.
#[derive(Clone, Debug)]
pub(super) struct Watched {
    /// Arc lengths in m from base to tip.
    pub(super) places: Vec<f64>,
    /// Which of them are joints between rigid bodies.
    joints: Vec<bool>,
}

impl Watched {
    /// The disks, the joints, and equal parts between these.
    pub(super) fn new(model: &Linkage) -> Self {
        let disks = &model.robot.disks().arc_lengths;
        let spacing = model.robot.backbone().length / WATCHED as f64;
        let mut watched = Self { places: vec![0.0], joints: vec![false] };
        let mut ends = Vec::new();
        for pair in disks.windows(2) {
            let length = pair[1] - pair[0];
            ends.clear();
            ends.extend(model.division.corners().map(|corner| pair[0] + corner * length));
            let joints = ends.len();
            ends.push(pair[1]);
            let mut start = pair[0];
            for (k, &end) in ends.iter().enumerate() {
                // A ratio of lengths of a valid robot is finite and not negative.
                let parts = ((end - start) / spacing).ceil().max(1.0) as usize;
                watched.places.extend(equally_spaced(start, end, parts + 1).skip(1));
                watched.joints.resize(watched.places.len(), false);
                if let (Some(last), true) = (watched.joints.last_mut(), k < joints) {
                    *last = true;
                }
                start = end;
            }
        }
        watched
    }
}

/// Where a chain stands.
#[derive(Clone, Debug, Default)]
struct State {
    q: Vec<Coordinates>,
    tensions: Vec<f64>,
    /// In the frame of the base.
    disks: Vec<Pose>,
}

/// The chain among obstacles.
pub(super) struct ContactAdapter<'a> {
    /// One of its own where its joints keep what steps of actuation left.
    pub(super) model: Cow<'a, Linkage>,
    /// Its chain and tensions are where the robot stands.
    pub(super) workspace: &'a mut Workspace,
    watched: Watched,
    force_scale: f64,
    /// The case that it last looked at, with the pushes among its loads.
    pub(super) case: Case,
    disks: Vec<Pose>,
    /// At the watched places.
    poses: Vec<Pose>,
    /// What is left of the equations where the model last looked.
    residual: f64,
    /// The disks of a known answer, which the coordinates were read off.
    known: Option<Vec<Pose>>,
    found: ContactResponse,
    /// Whether that is of where it stands.
    is_linear: bool,
    /// Whether anything pushes it where it last looked.
    is_touched: bool,
    /// Whether dead moments are among the loads of the case that it last looked at.
    has_moments: bool,
    kept: State,
    /// Where cables rub in their holes.
    holes: Option<HolesInContact<'a>>,
    /// The equilibria on the way, where their derivatives are asked for.
    pub(super) notes: Option<NotedWay<Vec<Coordinates>>>,
}

impl<'a> ContactAdapter<'a> {
    pub(super) fn new(model: &'a Linkage, watched: Watched, workspace: &'a mut Workspace) -> Self {
        let section = &model.sections[0];
        // What one moment bends by in all joints of the section.
        let bends = section.stiffness[1..].iter().step_by(2);
        let compliance: f64 = bends.filter(|&&k| k > 0.0).map(|k| 1.0 / k).sum();
        let length = model.robot.backbone().length;
        let mut adapter = Self {
            model: Cow::Borrowed(model),
            workspace,
            watched,
            case: Case::default(),
            force_scale: section.length / compliance / (length * length),
            disks: Vec::new(),
            poses: Vec::new(),
            residual: f64::INFINITY,
            known: None,
            found: ContactResponse::default(),
            is_linear: false,
            is_touched: false,
            has_moments: false,
            kept: State::default(),
            holes: model.friction.as_ref().map(HolesInContact::new),
            notes: None,
        };
        adapter.reset();
        adapter
    }

    /// Lets the joints keep what their friction holds where it stands, at this answer.
    pub(super) fn keep_plastic(&mut self, solution: &mut Solution) {
        if !self.model.keeps_history() {
            return;
        }
        let model = self.model.to_mut();
        model.keep_plastic(&self.workspace.scratch.chain.q);
        solution.plastic_curvature = model.plastic_curvature(&solution.shape.arc_length);
        self.is_linear = false;
    }

    /// Units of tensions and lengths in the conditions of cables.
    fn units(&self) -> [f64; 2] {
        [self.force_scale, self.model.robot.backbone().length]
    }

    /// Poses where it stands.
    fn place(&mut self) {
        let q = &self.workspace.scratch.chain.q;
        self.disks.clear();
        self.disks.extend(self.model.disks(q));
        self.poses.clear();
        let pose = |&s: &f64| self.model.pose_at(q, &self.disks, s);
        self.poses.extend(self.watched.places.iter().map(pose));
    }

    /// What is left of the equations where it stands, and the poses there.
    fn measure(&mut self) -> Result<(), SolveError> {
        let Workspace { scratch, loads, commands, tensions, meter, .. } = &mut *self.workspace;
        let pulled = self.holes.as_ref().map(|holes| holes.tensions().to_vec());
        let task = self.model.task(loads, pulled.as_deref().unwrap_or(tensions), meter);
        let task = match &self.model.friction {
            Some(rubbing) => Task { sections: &rubbing.sections, ..task },
            None => task,
        };
        let residual = scratch.chain.evaluate(&task);
        if !residual.is_finite() {
            let failure = scratch.failure(&task, 1.0, Effort { residual, ..Effort::default() });
            let failure = match &self.holes {
                Some(holes) => holes.rubbing.of_cables(failure),
                None => failure,
            };
            return Err(self.model.explain(failure, commands));
        }
        if let Some(holes) = &mut self.holes {
            self.residual = residual.max(holes.measure(&scratch.chain, &task, commands));
            self.place();
            return Ok(());
        }
        let units = self.units();
        let Workspace { scratch, commands, tensions, .. } = &*self.workspace;
        let lengths = &scratch.chain.lengths;
        let of_cable = |(i, command): (usize, &Command)| {
            command.complementarity_residual(i, tensions, lengths, units)
        };
        self.residual = commands.iter().enumerate().map(of_cable).fold(residual, f64::max);
        self.place();
        Ok(())
    }

    /// Coordinates that were read off the disks of an answer fall short of it where a section has more of them than its
    /// disks tell: those in equilibrium under the forces of its contacts have the same disks.
    fn find_again(&mut self, known: &[Pose]) {
        let Workspace { scratch, loads, tensions, meter, .. } = &mut *self.workspace;
        let read_off = scratch.chain.q.clone();
        let task = self.model.task(loads, tensions, meter);
        let tolerance = self.model.options.residual;
        let effort = &mut Effort::default();
        let converged = scratch.close_within(FEW_ITERATIONS, &task, tolerance, false, effort);
        let near = FOUND_AGAIN * self.model.robot.backbone().length;
        let mut pairs = self.model.disks(&scratch.chain.q).zip(known);
        let is_found = converged
            && scratch.chain.q.len() + 1 == known.len()
            && pairs.all(|(a, b)| (a.position - b.position).norm() <= near);
        drop(pairs);
        if !is_found {
            scratch.chain.q = read_off;
        }
    }

    fn linearise(&mut self, pushes: &[f64]) -> Result<(), SolveError> {
        let units = self.units();
        let Workspace { scratch, loads, commands, tensions, meter, .. } = &mut *self.workspace;
        if let Some(holes) = &mut self.holes {
            let pulled = holes.tensions().to_vec();
            let task = self.model.task(loads, &pulled, meter);
            let sections = self.model.friction.as_ref().map_or(task.sections, |of| &of.sections);
            let task = Task { sections, ..task };
            let at = (&task, &mut scratch.chain);
            self.found.linearise_rubbing(
                &self.model,
                at,
                (holes, commands),
                &self.disks,
                pushes,
            )?;
            self.is_linear = true;
            return Ok(());
        }
        let lengths = &scratch.chain.lengths;
        let of_cable =
            |(i, command): (usize, &Command)| command.is_active(i, tensions, lengths, units);
        let is_active: Vec<bool> = commands.iter().enumerate().map(of_cable).collect();
        let task = self.model.task(loads, tensions, meter);
        let cables = DrivenCables { commands, is_active: &is_active };
        let at = (&task, &mut scratch.chain);
        self.found.linearise(&self.model, at, cables, &self.disks, pushes)?;
        self.is_linear = true;
        Ok(())
    }
}

impl Compliant for ContactAdapter<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched.places
    }

    fn corner(&self, place: usize) -> Option<[Vec3; 2]> {
        if !self.watched.joints[place] {
            return None;
        }
        let q = &self.workspace.scratch.chain.q;
        let behind = 0.5 * (self.watched.places[place] + self.watched.places[place + 1]);
        let behind = self.model.pose_at(q, &self.disks, behind);
        Some([self.poses[place], behind].map(|pose| pose.rotation.rotate(Vec3::Z)))
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.model.rest_lengths
    }

    fn knows_forces(&self) -> bool {
        self.model.knows_forces
    }

    fn meter(&self) -> &Meter {
        &self.workspace.meter
    }

    fn effort(&self) -> f64 {
        // A coordinate costs a third of a step of a rod, and to look at a watched place a tenth.
        let coordinates = self.model.division.coordinates() * self.model.sections.len();
        // A tension about as much as a coordinate.
        let tensions = self.holes.as_ref().map_or(0, |holes| holes.tensions().len());
        ((coordinates + tensions) as f64 / 3.0 + 0.1 * self.watched.places.len() as f64) / 100.0
    }

    fn refine(&mut self) -> Result<bool, SolveError> {
        Ok(false)
    }

    fn reset(&mut self) {
        let Workspace { scratch, tensions, .. } = &mut *self.workspace;
        scratch.chain.rest(&self.model.sections);
        tensions.clear();
        tensions.resize(self.model.rest_lengths.len(), 0.0);
        self.holes.iter_mut().for_each(HolesInContact::reset);
        self.place();
    }

    fn start_from(&mut self, answer: &Solution) {
        if self.holes.as_ref().is_some_and(|holes| holes.has_started) {
            // It stands there, with what the holes remember.
            return;
        }
        self.reset();
        let Workspace { scratch, tensions, .. } = &mut *self.workspace;
        self.model.start_from(answer, scratch);
        for (tension, cable) in tensions.iter_mut().zip(&answer.cables) {
            *tension = cable.tension.unwrap_or(0.0).max(0.0);
        }
        let to_base = answer.disks.poses.first().map_or(Pose::IDENTITY, Pose::inverse);
        self.known = Some(answer.disks.poses.iter().map(|pose| to_base * *pose).collect());
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }

    fn consider(&mut self, case: &Case, pushes: &[Push]) -> Result<(), SolveError> {
        self.is_linear = false;
        self.is_touched = pushes.iter().any(|push| push.wrench != Wrench::default());
        self.has_moments = case.loads.has_dead_moment();
        self.case = contact::with_pushes(case, pushes);
        self.model.accept(&self.case, self.workspace)?;
        let Workspace { commands, tensions, .. } = &mut *self.workspace;
        for (tension, command) in tensions.iter_mut().zip(commands) {
            if let Command::Tension(given) = command {
                *tension = *given;
            }
        }
        if let Some(known) = self.known.take() {
            self.find_again(&known);
        }
        self.measure()
    }

    fn search_alone(&mut self, case: &Case) -> bool {
        if self.holes.is_some() {
            // What the holes remember of the way would be lost.
            return false;
        }
        self.is_linear = false;
        let Workspace { scratch, tensions, .. } = &*self.workspace;
        let stood = (scratch.chain.q.clone(), tensions.clone());
        let is_found = self.model.find(case, None, self.workspace).is_ok();
        if !is_found {
            (self.workspace.scratch.chain.q, self.workspace.tensions) = stood;
        }
        is_found
    }

    fn residual(&self) -> f64 {
        self.residual
    }

    fn pose(&self, arc_length: f64) -> Pose {
        let k = self.watched.places.partition_point(|&s| s < arc_length);
        if self.watched.places.get(k) == Some(&arc_length) {
            return self.poses[k];
        }
        self.model.pose_at(&self.workspace.scratch.chain.q, &self.disks, arc_length)
    }

    fn compliance(
        &mut self,
        pushes: &[Push],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) -> Result<(), SolveError> {
        let places: Vec<f64> = pushes.iter().map(|push| push.arc_length).collect();
        self.linearise(&places)?;
        self.found.compliance(compliance, drift);
        let finite = compliance.iter().chain(&*drift).all(|value| value.is_finite());
        if finite { Ok(()) } else { Err(SolveError::NoDerivatives) }
    }

    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> Result<f64, SolveError> {
        if !self.is_linear {
            self.linearise(&[])?;
        }
        let Workspace { scratch, tensions, commands, .. } = &mut *self.workspace;
        let chain = &mut scratch.chain;
        let taken = match &mut self.holes {
            None => self.found.advance(chain, tensions, changes, part),
            Some(holes) => self.found.advance_rubbing(chain, (holes, commands), changes, part),
        };
        self.is_linear = false;
        Ok(taken)
    }

    fn stands_alone(&mut self) -> bool {
        // A tangent that cannot be taken apart is about to change its sign: it has not yet.
        (!self.is_linear && self.linearise(&[]).is_err()) || self.found.stands
    }

    fn unstable_alone(&mut self) -> Option<usize> {
        let has_potential = !self.case.loads.has_follower() && !self.has_moments;
        if !self.knows_forces()
            || !has_potential
            || self.holes.is_some()
            || self.model.robot.has_bending_friction()
        {
            return None;
        }
        let Workspace { scratch, loads, commands, tensions, held, hold, meter, .. } =
            &mut *self.workspace;
        let moments = DeadMoments::Symmetric { more: 0.0 };
        let task = Task { moments, ..self.model.task(loads, tensions, meter) };
        // The tangent of the chain is another then.
        self.is_linear = false;
        self.model.hold(scratch, &task, commands, (hold, held))?;
        scratch.eigenvalues_below(&task, held, -Diagnostics::NEUTRAL)
    }

    fn has_touched(&self) -> bool {
        self.is_touched || self.holes.as_ref().is_some_and(|holes| holes.has_touched)
    }

    fn keep(&mut self) {
        let Workspace { scratch, tensions, commands, .. } = &*self.workspace;
        if let Some(holes) = &mut self.holes {
            holes.keep(commands);
            holes.has_touched |= self.is_touched;
        }
        self.kept.q.clone_from(&scratch.chain.q);
        self.kept.tensions.clone_from(tensions);
        self.kept.disks.clone_from(&self.disks);
    }

    fn pose_before(&self, arc_length: f64) -> Pose {
        self.model.pose_at(&self.kept.q, &self.kept.disks, arc_length)
    }

    fn go_back(&mut self) {
        let Workspace { scratch, tensions, .. } = &mut *self.workspace;
        scratch.chain.q.clone_from(&self.kept.q);
        tensions.clone_from(&self.kept.tensions);
        self.holes.iter_mut().for_each(HolesInContact::go_back);
        self.is_linear = false;
        self.place();
    }

    fn solve_free(&mut self, case: &Case) -> Result<Solution, SolveError> {
        if self.holes.is_some() {
            // What the holes remember of the way would be lost.
            return Err(SolveError::NoDerivatives);
        }
        self.is_linear = false;
        self.model.solve_alone(case, None, self.workspace)
    }

    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError> {
        let touching = pushes.iter().any(|push| push.wrench != Default::default());
        let absent = match (self.model.options.stability, touching) {
            (StabilityAnalysis::Off, _) => NoStability::NotAsked,
            (_, true) => NoStability::Touching,
            (_, false) => NoStability::Undetermined,
        };
        let effort = Effort { residual: self.residual, ..Effort::default() };
        if let Some(holes) = &mut self.holes {
            let Workspace { scratch, commands, tensions, friction, .. } = &mut *self.workspace;
            holes.keep(commands);
            holes.cable_lengths(&mut scratch.chain.lengths);
            let History { tensions: pulled, slip_states, base, .. } = holes.history();
            tensions.clone_from(base);
            friction.history.tensions.clone_from(pulled);
            friction.history.slip_states.clone_from(slip_states);
        }
        let solution = self.model.solution(case, effort, Err(absent), self.workspace);
        if touching || self.holes.is_some() {
            return Ok(solution);
        }
        let free = self.model.solve_alone(case, Some(&solution), self.workspace);
        let free = free.ok().filter(|free| contact::is_same_shape(free, &solution));
        Ok(free.unwrap_or(solution))
    }
}

impl Noting for ContactAdapter<'_> {
    fn takes_notes(&self) -> bool {
        self.notes.is_some()
    }

    fn note(&mut self, holding: Holding, at: OnWay) {
        let Workspace { scratch, commands, tensions, .. } = &*self.workspace;
        let standing = match &self.holes {
            Some(holes) => holes.standing(commands),
            None => Some(Standing::of_whole_cables(commands, tensions)),
        };
        if let (Some(way), Some(standing)) = (&mut self.notes, standing) {
            let (state, case) = (scratch.chain.q.clone(), self.case.clone());
            way.note(standing, Noted { state, case, holding, at, next: Vec::new() });
        }
    }

    fn forget_notes(&mut self) {
        self.notes.iter_mut().for_each(|way| *way = NotedWay::default());
    }

    fn lose_notes(&mut self) {
        self.notes.iter_mut().for_each(|way| way.is_broken = true);
    }
}
