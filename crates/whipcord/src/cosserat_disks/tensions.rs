//! The robot as what answers tensions with a shape.

use super::problem::Problem;
use super::raise::Raise;
use super::scratch::{Scratch, copy_out};
use super::unloaded;
use crate::section::{Fault, SectionFault};
use crate::statics::continuation::PATH_ENDS;
use crate::statics::lengths::{self, Effort, Given, Note, TensionResponse};
use crate::statics::outcome::{Failure, Found};
use crate::statics::trace::Stage;

/// The robot as what answers tensions with a shape.
pub(super) struct Rod<'a> {
    problem: &'a Problem<'a>,
    pub scratch: &'a mut Scratch,
    /// What a sweep without load starts from.
    pub from: unloaded::From,
    /// Whether the loads count.
    loaded: bool,
    /// Whether the chain holds an equilibrium under all of the load.
    closed: bool,
    last_load: f64,
    iterations: usize,
    residual: f64,
}

impl<'a> Rod<'a> {
    pub fn new(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        let (last_load, residual) = (0.0, 0.0);
        let from = unloaded::From::Nothing;
        let loaded = scratch.applied.any();
        let (closed, iterations) = (false, 0);
        Self { problem, scratch, from, loaded, closed, last_load, iterations, residual }
    }

    /// The robot as it would be without the loads.
    pub fn without_load(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        Self { loaded: false, ..Self::new(problem, scratch) }
    }

    /// Finds the chain at these tensions from the robot without load.
    pub fn find_equilibrium(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        self.respond_with(tensions, false, false).map_err(|fault| self.failure(fault, tensions))?;
        let Problem { frame, mesh, .. } = *self.problem;
        let Scratch { chain, groups, unloaded, .. } = &mut *self.scratch;
        if !self.loaded {
            chain.pull(groups, tensions);
            chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
        }
        Ok(())
    }

    fn expand(&mut self, tensions: &[f64]) {
        let Scratch { pulled, groups, .. } = &mut *self.scratch;
        pulled.clear();
        pulled.extend(groups.iter().map(|&cable| tensions[cable]));
    }

    /// Finds the robot under its commands: at these tensions, or at those that its lengths need.
    pub fn converge(&mut self, tensions: &mut [f64]) -> Result<Effort, Failure> {
        if !self.problem.by_length() {
            return match self.respond_with(tensions, true, false) {
                Ok(()) => Ok(Effort { iterations: self.iterations, residual: self.residual }),
                Err(fault) => Err(self.failure(fault, tensions)),
            };
        }
        let commands = self.problem.commands;
        let meter = self.problem.meter;
        let length = self.problem.frame.rod.backbone().length;
        let given = Given { length, commands, bracket: true, meter };
        let mut start = core::mem::take(&mut self.scratch.first_tensions);
        start.clear();
        start.extend_from_slice(tensions);
        let mut memory = core::mem::take(&mut self.scratch.length_scratch);
        let mut solved = lengths::attempt(&given, tensions, self, &mut memory);
        if solved.is_err() {
            if let Some(effort) = self.together(&start, tensions) {
                (self.scratch.length_scratch, self.scratch.first_tensions) = (memory, start);
                return Ok(effort);
            }
            tensions.copy_from_slice(&start);
            solved = lengths::solve(&given, tensions, self, &mut memory);
        }
        (self.scratch.length_scratch, self.scratch.first_tensions) = (memory, start);
        solved.map_err(|fault| fault.failure(|fault| self.failure(fault, tensions)))
    }

    /// Lengths without load, for tensions and shape together. Where a span bears more than it buckles
    /// under, its straight path goes on, but the lengths are no longer those of a least energy, which is what
    /// [`lengths::solve`] takes them for. From `start`, and else with all lengths brought there from
    /// rest.
    fn together(&mut self, start: &[f64], tensions: &mut [f64]) -> Option<Effort> {
        if self.loaded || self.scratch.applied.any() {
            return None;
        }
        let Problem { frame, mesh, commands, .. } = *self.problem;
        let raise = Raise { commands, ..Raise::at_tensions(self.problem) };
        let mut closed = None;
        if self.respond_with(start, true, false).is_ok() {
            let Scratch { chain, groups, unloaded, .. } = &mut *self.scratch;
            chain.pull(groups, start);
            chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
            closed = raise.newton(self.scratch, 1.0, false).ok();
        }
        let effort = closed.or_else(|| raise.all(self.scratch, false).ok())?;
        let Scratch { chain, unloaded, .. } = &mut *self.scratch;
        tensions.copy_from_slice(&chain.tensions);
        unloaded.adopt(chain, frame);
        self.from = unloaded::From::Neighbour;
        self.respond_with(tensions, true, false).ok()?;
        Some(effort)
    }

    fn respond_with(
        &mut self,
        tensions: &[f64],
        warm: bool,
        derivatives: bool,
    ) -> Result<(), Fault> {
        self.expand(tensions);
        if !self.loaded {
            let Problem { frame, mesh, meter, .. } = *self.problem;
            let Scratch { unloaded, pulled, .. } = &mut *self.scratch;
            use unloaded::From;
            let from = if warm || self.from == From::Coarser { self.from } else { From::Nothing };
            let swept = unloaded.sweep(frame, mesh, pulled, from, derivatives);
            // Each iteration of a span goes over its steps.
            meter
                .integrate(unloaded.iterations.max(1) * mesh.grid.len() / frame.spans.len().max(1));
            if swept.is_err() {
                self.last_load = unloaded.reached;
            }
            if swept.is_err() || self.from == From::Nothing {
                self.from = From::Neighbour;
            }
            swept?;
            self.iterations = 0;
        } else {
            self.under_load(tensions, warm, derivatives)?;
        }
        self.gather(tensions.len(), derivatives);
        Ok(())
    }

    /// Under loads: from the chain as it stands, from the robot without load, or raising the load.
    fn under_load(&mut self, tensions: &[f64], warm: bool, derivatives: bool) -> Result<(), Fault> {
        let Scratch { chain, groups, .. } = &mut *self.scratch;
        chain.pull(groups, tensions);
        let raise = Raise { derivatives, ..Raise::at_tensions(self.problem) };
        if self.closed && warm {
            self.scratch.chain.trace.stage = Stage::Warm;
            match raise.newton(self.scratch, 1.0, false) {
                Ok(effort) => {
                    self.iterations += effort.iterations;
                    self.residual = effort.residual;
                    return Ok(());
                }
                Err(_) => self.closed = false,
            }
        }
        if !self.closed {
            let Problem { frame, mesh, .. } = *self.problem;
            let Scratch { unloaded, pulled, chain, .. } = &mut *self.scratch;
            unloaded.sweep(frame, mesh, pulled, unloaded::From::Nothing, false)?;
            chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
            let raised = raise.load(self.scratch);
            self.closed = raised.is_ok();
            let effort = raised.map_err(|ended| {
                (self.last_load, self.residual) = (ended.load, ended.residual);
                ended.fault
            })?;
            self.iterations += effort.iterations;
            self.residual = effort.residual;
        }
        Ok(())
    }

    /// Lengths and derivatives of the cables from those of the passages.
    fn gather(&mut self, cables: usize, derivatives: bool) {
        let loaded = self.loaded;
        let Scratch { unloaded, chain, groups, lengths, length_by_tension, .. } =
            &mut *self.scratch;
        let chords = if loaded { &chain.chords } else { &unloaded.chords };
        lengths.clear();
        lengths.resize(cables, 0.0);
        for (chord, &cable) in chords.iter().zip(&*groups) {
            lengths[cable] += chord.length;
        }
        if !derivatives {
            return;
        }
        if loaded {
            length_by_tension.clone_from(&chain.length_by_tension);
            return;
        }
        length_by_tension.clear();
        length_by_tension.resize(cables * cables, 0.0);
        let mut rest = &unloaded.length_by_tension[..];
        for span in &self.problem.frame.spans {
            let of = &groups[span.first..span.first + span.passages.len()];
            for &i in of {
                for &j in of {
                    length_by_tension[i * cables + j] += rest[0];
                    rest = &rest[1..];
                }
            }
        }
    }

    /// Copies the answer out.
    pub fn finish(self, tensions: Vec<f64>, found: Found) -> Found {
        copy_out(self.problem, self.scratch);
        self.scratch.tensions = tensions;
        found
    }

    pub fn failure(&self, fault: Fault, tensions: &[f64]) -> Failure {
        let of_cable = |cable: usize| {
            let spans = self.problem.frame.spans.iter().flat_map(|span| &span.passages);
            let own = spans.zip(&self.scratch.groups).filter(|(p, _)| p.cable == cable);
            own.map(|(_, &group)| tensions[group]).fold(0.0, f64::max)
        };
        match fault.kind {
            SectionFault::Folded { cable } => Failure::Folds {
                cable,
                arc_length: fault.arc_length,
                tension: of_cable(cable),
                last_load: self.last_load,
            },
            SectionFault::Diverged => Failure::NotConverged {
                iterations: self.iterations,
                residual: self.residual,
                last_load: self.last_load,
                advice: PATH_ENDS,
            },
        }
    }
}

impl TensionResponse for Rod<'_> {
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault> {
        self.respond_with(tensions, warm, true)
    }

    fn lengths(&self) -> &[f64] {
        &self.scratch.lengths
    }

    fn length_by_tension(&self) -> &[f64] {
        &self.scratch.length_by_tension
    }

    fn note(&mut self, note: &Note, tensions: &[f64]) {
        let load = if self.loaded { 1.0 } else { 0.0 };
        let trace = &mut self.scratch.chain.trace;
        trace.steps = self.problem.mesh.grid.len();
        trace.of_lengths(load, note, tensions);
    }
}
