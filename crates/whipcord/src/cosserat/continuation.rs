//! Raising the load from nothing, in steps that adapt.

use super::chain::{Chain, Node, Open, Task};
use super::lengths::{Command, Effort};
use super::loaded::Aim;
use super::newton::Point;
use super::section::SectionFault;
use super::statics::{Failed, Failure, Found, Problem, Scratch, finish, finish_chain, seed, shoot};
use super::unloaded::Fault;
use super::without_load::{section_failure, start_without_load};

/// The load is raised by at least this fraction, or the path is given up.
const LEAST_LOAD_STEP: f64 = 1.0 / 4096.0;
const FIRST_LOAD_STEP: f64 = 0.25;
/// An iteration longer than this means that the path bends: the step is not lengthened.
const SHORT_ITERATION: usize = 5;
const PATH_ENDS: &str = "no equilibrium near it was found at more load, as at a snap-through: apply less load, or lead the robot there by other tensions first";

/// Whether [`raise_load_on_chain`] can take the problem.
pub(super) fn chain_applies(problem: &Problem<'_>, scratch: &Scratch) -> bool {
    !scratch.applied.any_follower()
        && problem.commands.iter().all(|c| matches!(c, Command::Tension(_)))
}

/// The path of a load factor from 0 to 1, and how far to go next.
struct Path {
    load: f64,
    step: f64,
    iterations: usize,
    /// Whether the path is still held to stable equilibria.
    stable: bool,
}

impl Path {
    fn new(spent: usize, stable: bool) -> Self {
        Self { load: 0.0, step: FIRST_LOAD_STEP, iterations: spent, stable }
    }

    fn next(&self) -> f64 {
        (self.load + self.step).min(1.0)
    }

    /// Whether an equilibrium at the next load is on the path. A long step can miss where the
    /// stable path turns off; where the shortest one stays on an unstable path, the path itself has
    /// lost its stability.
    fn accepts(&mut self, stable: impl FnOnce() -> bool) -> bool {
        if self.stable && !stable() {
            if self.step >= 2.0 * LEAST_LOAD_STEP {
                self.step *= 0.5;
                return false;
            }
            self.stable = false;
        }
        true
    }

    fn advance(&mut self, load: f64, iterations: usize) {
        self.load = load;
        if iterations <= SHORT_ITERATION {
            self.step *= 2.0;
        }
    }

    /// Halves the step; `Err` where it gets too short.
    fn retreat(
        &mut self,
        residual: f64,
        fault: Option<Fault>,
        tensions: &[f64],
    ) -> Result<(), Failure> {
        self.step *= 0.5;
        if self.step >= LEAST_LOAD_STEP {
            return Ok(());
        }
        Err(match fault {
            Some(fault @ Fault { kind: SectionFault::Folded { .. }, .. }) => {
                section_failure(fault, tensions, self.load)
            }
            _ => Failure::NotConverged {
                iterations: self.iterations,
                residual,
                last_load: self.load,
                advice: PATH_ENDS,
            },
        })
    }
}

/// By single shooting: for any loads and commands.
pub(super) fn raise_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    spent: usize,
) -> Result<Found, Failure> {
    start_without_load(problem, scratch)?;
    seed(problem, scratch, 0.0);
    let mut here = scratch.newton.point.clone();
    let mut before: Option<(f64, Point)> = None;
    let mut path = Path::new(spent, problem.stability);
    loop {
        let load = path.next();
        scratch.newton.point = extrapolate((path.load, &here), before.as_ref(), load);
        scratch.shot.forget();
        match shoot(problem, scratch, load) {
            Ok(effort) => {
                path.iterations += effort.iterations;
                if !path.accepts(|| stays(problem, scratch, load)) {
                    continue;
                }
                if load >= 1.0 {
                    let effort = Effort { iterations: path.iterations, ..effort };
                    return Ok(finish(problem, scratch, effort));
                }
                let left = core::mem::replace(&mut here, scratch.newton.point.clone());
                before = Some((path.load, left));
                path.advance(load, effort.iterations);
            }
            Err(Failed { effort, fault }) => {
                path.iterations += effort.iterations;
                path.retreat(effort.residual, fault, &scratch.newton.point.tensions)?;
            }
        }
    }
}

/// By multiple shooting: for given tensions and dead loads of any strength.
pub(super) fn raise_load_on_chain(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    spent: usize,
) -> Result<Found, Failure> {
    start_without_load(problem, scratch)?;
    scratch.chain.start(&scratch.poses);
    let mut here: Vec<Node> = scratch.chain.nodes.clone();
    let mut path = Path::new(spent, problem.stability);
    loop {
        let load = path.next();
        scratch.chain.nodes.clone_from(&here);
        scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
        match close(problem, scratch, load) {
            Ok((iterations, residual)) => {
                path.iterations += iterations;
                let Scratch { shot, stability, .. } = scratch;
                if !path.accepts(|| stability.is_stable(problem.grid, &shot.samples)) {
                    continue;
                }
                if load >= 1.0 {
                    let effort = Effort { iterations: path.iterations, residual };
                    return Ok(finish_chain(problem, scratch, effort));
                }
                here.clone_from(&scratch.chain.nodes);
                path.advance(load, iterations);
            }
            Err(Open { iterations, gap, fault }) => {
                path.iterations += iterations;
                path.retreat(gap, fault, &scratch.tensions)?;
            }
        }
    }
}

/// All of the load at once, from a chain with half as many steps.
pub(super) fn refine_chain(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    coarse: &[Node],
) -> Option<Found> {
    if problem.grid.len() != 2 * (coarse.len() - 1) {
        return None;
    }
    start_without_load(problem, scratch).ok()?;
    scratch.chain.start_halved(coarse);
    scratch.shot.seed(problem.grid, &scratch.unloaded.strains);
    let (iterations, residual) = close(problem, scratch, 1.0).ok()?;
    Some(finish_chain(problem, scratch, Effort { iterations, residual }))
}

fn close(problem: &Problem<'_>, scratch: &mut Scratch, load: f64) -> Result<(usize, f64), Open> {
    let Scratch { chain, shot, applied, tensions, .. } = scratch;
    let task = Task {
        grid: problem.grid,
        loads: applied,
        tensions,
        load,
        length: problem.length,
        tolerance: problem.tolerance,
    };
    Chain::close(chain, &task, shot)
}

/// Whether the equilibrium at `scratch.newton.point` is stable; followers leave that open.
fn stays(problem: &Problem<'_>, scratch: &mut Scratch, load: f64) -> bool {
    let Scratch { shot, applied, newton, stability, .. } = scratch;
    let Point { base_moment, follower_force, ref tensions } = newton.point;
    let aim = Aim { tensions, base_moment, follower_force, load, sample: true };
    applied.any_follower()
        || shot.fire(problem.grid, applied, &aim).is_ok()
            && stability.is_stable(problem.grid, &shot.samples)
}

fn extrapolate(here: (f64, &Point), before: Option<&(f64, Point)>, load: f64) -> Point {
    let Some(before) = before else { return here.1.clone() };
    let t = (load - here.0) / (here.0 - before.0);
    let tension = |(b, a): (&f64, &f64)| (b + t * (b - a)).max(0.0);
    Point {
        base_moment: here.1.base_moment + t * (here.1.base_moment - before.1.base_moment),
        follower_force: here.1.follower_force
            + t * (here.1.follower_force - before.1.follower_force),
        tensions: here.1.tensions.iter().zip(&before.1.tensions).map(tension).collect(),
    }
}
