//! The rod without load on one grid: the answer where there is none, the start where there is.

use super::problem::Problem;
use super::scratch::Scratch;
use super::unloaded::{SweepOptions, Unloaded};
use crate::section::Fault;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::lengths::{self, Effort, Given, Note, TensionResponse};
use crate::statics::outcome::{Failure, Found};
use crate::statics::trace::Trace;

/// Puts the given tensions in their place.
pub(super) fn set_tensions(commands: &[Command], tensions: &mut [f64]) {
    for (tension, command) in tensions.iter_mut().zip(commands) {
        if let Command::Tension(given) = command {
            *tension = *given;
        }
    }
}

/// The whole answer where there is no load.
pub(super) fn without_load(problem: &Problem<'_>, scratch: &mut Scratch) -> Result<Found, Failure> {
    let effort = sections(problem, scratch)?;
    scratch.unloaded.integrate(problem.grid, &mut scratch.poses);
    scratch.lengths.clone_from(&scratch.unloaded.lengths);
    scratch.base_wrench = Wrench::default();
    Ok(Found::with(effort))
}

/// Strains and tensions of the rod without load.
pub(super) fn sections(problem: &Problem<'_>, scratch: &mut Scratch) -> Result<Effort, Failure> {
    let commands = problem.commands;
    if commands.iter().all(|c| matches!(c, Command::Tension(_))) {
        set_tensions(commands, &mut scratch.tensions);
        let Scratch { unloaded, tensions, .. } = scratch;
        let Err(fault) = unloaded.sweep(problem.grid, tensions, problem.sweep_options()) else {
            return Ok(Effort::default());
        };
        let borne = borne_fraction(problem.grid, tensions, unloaded);
        return Err(Failure::of_section(fault, &scratch.tensions, borne));
    }
    let Scratch { unloaded, tensions, length_scratch, trace, .. } = &mut *scratch;
    let given =
        Given { length: problem.length, commands, bracket: problem.bracket, meter: problem.meter };
    let options = problem.sweep_options();
    let mut rod = Sections { grid: problem.grid, options, unloaded, trace };
    lengths::solve(&given, tensions, &mut rod, length_scratch)
        .map_err(|fault| fault.failure(|fault| Failure::of_section(fault, &scratch.tensions, 0.0)))
}

/// All cross-sections of the rod without load.
struct Sections<'a> {
    grid: &'a Grid,
    options: SweepOptions,
    unloaded: &'a mut Unloaded,
    trace: &'a mut Trace,
}

impl TensionResponse for Sections<'_> {
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault> {
        let options = SweepOptions { warm, derivatives: true, ..self.options };
        self.unloaded.sweep(self.grid, tensions, options)
    }

    fn lengths(&self) -> &[f64] {
        &self.unloaded.lengths
    }

    fn length_by_tension(&self) -> &[f64] {
        &self.unloaded.length_by_tension
    }

    fn note(&mut self, note: &Note, tensions: &[f64]) {
        self.trace.of_lengths(0.0, note, tensions);
    }
}

/// The fraction of the tensions up to which no section folds, by bisection.
fn borne_fraction(grid: &Grid, tensions: &[f64], unloaded: &mut Unloaded) -> f64 {
    const BISECTIONS: usize = 16;
    let (mut borne, mut folded) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (borne + folded);
        let scaled: Vec<f64> = tensions.iter().map(|t| t * middle).collect();
        match unloaded.sweep(grid, &scaled, SweepOptions::EXACT) {
            Ok(()) => borne = middle,
            Err(_) => folded = middle,
        }
    }
    borne
}

/// The rod without load: tensions, strains and frames.
pub(super) fn start_without_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<(), Failure> {
    scratch.tensions.iter_mut().for_each(|tension| *tension = 0.0);
    sections(problem, scratch)?;
    scratch.unloaded.integrate(problem.grid, &mut scratch.poses);
    Ok(())
}
