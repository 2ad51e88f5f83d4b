use super::step::{Linear, Room, Step, is_held};
use super::{CURVED, Loss, Negligible, NoResiduals, Options, Outcome, Residuals, Status};
use crate::orthogonal::{norm, triangularise};

/// The first radius, as a multiple of the size of the unknowns and of the residuals.
const FIRST_RADIUS: f64 = 100.0;
/// Least share of the promised decrease with which a step is taken.
const TAKEN: f64 = 1e-4;
/// Below this share of the promised decrease the radius shrinks; above one less it, it grows.
const POOR: f64 = 0.25;
/// What a refused step is shortened to.
const SHORTENED: f64 = 0.25;
/// Steps shorter than this fraction of the unknowns are lost in rounding.
const SHORTEST: f64 = 1e-15;
/// A step that is so much shorter than the first that was tried changes the cost by what rounding makes of it.
const SHORT: f64 = 1e-2;
/// If one that is so much shorter changes nothing at all, the first is lost in the rounding of the unknowns.
const IDLE: f64 = 1e-4;
/// A promised decrease that is no greater than so many times that is lost in rounding.
const LOST: f64 = 10.0;

/// Memory of a minimisation, and the problem at its end.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    residuals: Vec<f64>,
    jacobian: Vec<f64>,
    weights: Vec<f64>,
    trial: Vec<f64>,
    trial_residuals: Vec<f64>,
    trial_jacobian: Vec<f64>,
    reduced: Vec<f64>,
    reduced_residuals: Vec<f64>,
    gradient: Vec<f64>,
    norms: Vec<f64>,
    largest_norms: Vec<f64>,
    scale: Vec<f64>,
    down: Vec<f64>,
    up: Vec<f64>,
    scratch: Vec<f64>,
    step: Step,
}

impl Workspace {
    /// The residuals.
    #[must_use]
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// Their derivatives by the unknowns, by rows.
    #[must_use]
    pub fn jacobian(&self) -> &[f64] {
        &self.jacobian
    }

    /// The weight `ρ′` that the loss gives each residual.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Weighs the residuals and their derivatives and reduces them to a triangle, with gradient and scale.
    fn linearise<P: Residuals>(&mut self, problem: &P, options: &Options) {
        let n = self.trial.len();
        weigh(problem, options, &self.residuals, &mut self.weights);
        self.reduced.clear();
        self.reduced_residuals.clear();
        self.gradient.clear();
        self.gradient.resize(n, 0.0);
        let rows = self.jacobian.chunks_exact(n).zip(&self.residuals);
        for ((row, residual), weight) in rows.zip(&self.weights) {
            let root = weight.sqrt();
            self.reduced.extend(row.iter().map(|entry| root * entry));
            self.reduced_residuals.push(root * residual);
            for (sum, entry) in self.gradient.iter_mut().zip(row) {
                *sum += weight * entry * residual;
            }
        }
        self.norms.clear();
        self.scale.clear();
        for (j, largest) in self.largest_norms.iter_mut().enumerate() {
            let size = norm(self.reduced.iter().skip(j).step_by(n).copied());
            self.norms.push(size);
            *largest = largest.max(size);
            // An unknown that nothing depends on stays where it is, whatever its scale.
            self.scale.push(if *largest > 0.0 { *largest } else { 1.0 });
        }
        triangularise(n, &mut self.reduced, &mut self.reduced_residuals, &mut self.scratch);
        self.reduced_residuals.truncate(n);
        self.reduced.truncate(n * self.reduced_residuals.len());
    }

    /// How far each unknown may go.
    fn measure_room(&mut self, unknowns: &[f64], options: &Options) {
        self.down.clear();
        self.up.clear();
        for (j, x) in unknowns.iter().enumerate() {
            self.down.push(options.lower.get(j).map_or(f64::NEG_INFINITY, |low| low - x));
            self.up.push(options.upper.get(j).map_or(f64::INFINITY, |high| high - x));
        }
    }

    /// The largest cosine of the residuals, of this norm, with a column of an unknown that is not held at a
    /// bound.
    fn steepness(&self, size: f64) -> f64 {
        let room = Room { down: &self.down, up: &self.up };
        let slopes = self.gradient.iter().zip(&self.norms).enumerate();
        slopes
            .filter(|&(j, (&slope, &norm))| norm > 0.0 && !is_held(slope, &room, j))
            .map(|(_, (slope, norm))| slope.abs() / norm / size)
            .fold(0.0, f64::max)
    }
}

/// `½ Σ ρ`.
fn cost<P: Residuals>(problem: &P, options: &Options, residuals: &[f64]) -> f64 {
    let mut sum = 0.0;
    for_blocks(problem, options, residuals, |block, loss| sum += loss.of(square(block)).0);
    0.5 * sum
}

/// The weight `ρ′` of each residual.
fn weigh<P: Residuals>(problem: &P, options: &Options, residuals: &[f64], weights: &mut Vec<f64>) {
    weights.clear();
    for_blocks(problem, options, residuals, |block, loss| {
        weights.resize(weights.len() + block.len(), loss.of(square(block)).1);
    });
}

fn square(block: &[f64]) -> f64 {
    block.iter().map(|x| x * x).sum()
}

fn for_blocks<P: Residuals>(
    problem: &P,
    options: &Options,
    residuals: &[f64],
    mut each: impl FnMut(&[f64], Loss),
) {
    let mut first = 0;
    while first < residuals.len() {
        let end = (first + problem.block(first).max(1)).min(residuals.len());
        let loss = if problem.takes_loss(first) { options.loss } else { Loss::Squares };
        each(&residuals[first..end], loss);
        first = end;
    }
}

/// The cost at the trial, and the derivatives too if it is not above `acceptable`.
fn evaluate<P: Residuals>(
    problem: &mut P,
    options: &Options,
    ws: &mut Workspace,
    acceptable: f64,
) -> Result<f64, NoResiduals<P::Refusal>> {
    problem.residuals(&ws.trial, &mut ws.trial_residuals).map_err(NoResiduals::Refused)?;
    let cost = cost(problem, options, &ws.trial_residuals);
    if !cost.is_finite() {
        return Err(NoResiduals::NotFinite);
    }
    if cost <= acceptable {
        problem.jacobian(&ws.trial, &mut ws.trial_jacobian).map_err(NoResiduals::Refused)?;
        if ws.trial_jacobian.iter().any(|entry| !entry.is_finite()) {
            return Err(NoResiduals::NotFinite);
        }
        core::mem::swap(&mut ws.residuals, &mut ws.trial_residuals);
        core::mem::swap(&mut ws.jacobian, &mut ws.trial_jacobian);
    }
    Ok(cost)
}

/// Starts at the nearest point within the bounds.
pub(super) fn minimise<P: Residuals>(
    problem: &mut P,
    unknowns: &mut [f64],
    options: &Options,
    ws: &mut Workspace,
) -> Result<Outcome<P::Refusal>, NoResiduals<P::Refusal>> {
    let (n, count) = (unknowns.len(), problem.count());
    for (x, low) in unknowns.iter_mut().zip(&options.lower) {
        *x = x.max(*low);
    }
    for (x, high) in unknowns.iter_mut().zip(&options.upper) {
        *x = x.min(*high);
    }
    for (memory, length) in [
        (&mut ws.residuals, count),
        (&mut ws.trial_residuals, count),
        (&mut ws.jacobian, count * n),
        (&mut ws.trial_jacobian, count * n),
        (&mut ws.largest_norms, n),
    ] {
        memory.clear();
        memory.resize(length, 0.0);
    }
    ws.trial.clear();
    ws.trial.extend_from_slice(unknowns);
    let cost = evaluate(problem, options, ws, f64::INFINITY)?;
    let mut outcome = Outcome {
        status: Status::IterationLimit,
        cost,
        iterations: 0,
        evaluations: 1,
        refusal: None,
    };
    let mut radius: Option<Radius> = None;
    while outcome.iterations < options.iterations {
        ws.linearise(problem, options);
        ws.measure_room(unknowns, options);
        let size = norm(ws.weights.iter().zip(&ws.residuals).map(|(w, r)| w.sqrt() * r));
        if size == 0.0 || n == 0 || ws.steepness(size) <= options.gradient {
            outcome.status = Status::Gradient;
            break;
        }
        let extent = norm(unknowns.iter().zip(&ws.scale).map(|(x, d)| x * d));
        let first = Radius { size: FIRST_RADIUS * (extent + size), is_of_refusal: false };
        let radius = radius.get_or_insert(first);
        if let Some(status) = descend(problem, unknowns, options, ws, &mut outcome, radius, extent)
        {
            outcome.status = status;
            break;
        }
    }
    Ok(outcome)
}

/// How long a step may be, in scaled unknowns.
struct Radius {
    size: f64,
    /// Whether it is as small as it is because longer steps were refused: short steps say nothing then of
    /// how far the minimum is.
    is_of_refusal: bool,
}

/// Takes one step that lowers the cost; or says why the iteration ends, after a last step or without.
fn descend<P: Residuals>(
    problem: &mut P,
    unknowns: &mut [f64],
    options: &Options,
    ws: &mut Workspace,
    outcome: &mut Outcome<P::Refusal>,
    radius: &mut Radius,
    extent: f64,
) -> Option<Status> {
    // Of the first step the length and what it promises, and what rounding makes of the cost.
    let (mut first, mut rounding) = (None, 0.0_f64);
    let negligible = match options.negligible {
        Negligible::Nothing => 0.0,
        Negligible::PartOfCost(part) => part * outcome.cost,
        Negligible::Cost(cost) => cost,
    };
    let mut is_last = false;
    if negligible > 0.0 {
        let linear =
            Linear { jacobian: &ws.reduced, residuals: &ws.reduced_residuals, scale: &ws.scale };
        let room = Room { down: &ws.down, up: &ws.up };
        ws.step.find(linear, &ws.gradient, &room, f64::INFINITY);
        let Step { length, promised, .. } = ws.step;
        let is_held_back = length > radius.size;
        if (0.0..=negligible * CURVED).contains(&promised) && is_held_back {
            return Some(Status::Cost);
        }
        is_last = (0.0..=negligible).contains(&promised);
    }
    loop {
        let linear =
            Linear { jacobian: &ws.reduced, residuals: &ws.reduced_residuals, scale: &ws.scale };
        let room = Room { down: &ws.down, up: &ws.up };
        ws.step.find(linear, &ws.gradient, &room, radius.size);
        radius.is_of_refusal &= !ws.step.is_full;
        let (length, promised) = (ws.step.length, ws.step.promised);
        // Numbers that are finite may have squares that are not.
        if !length.is_finite() || !promised.is_finite() {
            return Some(Status::Stalled);
        }
        // A long step that bounds cut short may not even lower the linear problem; a shorter one does.
        if promised < 0.0 {
            radius.size = SHORTENED * length.min(radius.size);
            if radius.size <= SHORTEST * extent || radius.size == 0.0 {
                return Some(Status::Stalled);
            }
            continue;
        }
        for ((trial, x), change) in ws.trial.iter_mut().zip(&*unknowns).zip(&ws.step.change) {
            *trial = x + change;
        }
        // Rounding may leave a step to a bound a little short of it or beyond.
        for (j, trial) in ws.trial.iter_mut().enumerate() {
            let (low, high) = (options.lower.get(j), options.upper.get(j));
            *trial = trial.max(*low.unwrap_or(&f64::NEG_INFINITY));
            *trial = trial.min(*high.unwrap_or(&f64::INFINITY));
        }
        let before = outcome.cost;
        outcome.evaluations += 1;
        let cost = match evaluate(problem, options, ws, before - TAKEN * promised) {
            Ok(cost) => cost,
            Err(refusal) => {
                outcome.refusal = Some(refusal);
                *radius = Radius { size: SHORTENED * length, is_of_refusal: true };
                if radius.size <= SHORTEST * extent || radius.size == 0.0 {
                    return Some(Status::Refused);
                }
                continue;
            }
        };
        let gained = before - cost;
        let (first_length, first_promise) = *first.get_or_insert((length, promised));
        if length <= SHORT * first_length {
            rounding = rounding.max(gained.abs() - promised);
        }
        if gained == 0.0 && length >= IDLE * first_length {
            rounding = f64::INFINITY;
        }
        let taken = gained >= TAKEN * promised;
        if gained < POOR * promised {
            // Where the parabola through the cost, its slope and the new cost has its minimum.
            let slope = -promised.max(f64::MIN_POSITIVE);
            let shortened = 0.5 * slope / (slope + 0.5 * gained);
            radius.size = length * if gained < 0.0 { shortened.clamp(0.1, 0.5) } else { 0.5 };
        } else if gained > (1.0 - POOR) * promised || ws.step.is_full {
            radius.size = 2.0 * length;
        }
        if taken {
            unknowns.copy_from_slice(&ws.trial);
            outcome.cost = cost;
            outcome.iterations += 1;
        }
        let small = options.cost * before;
        if promised <= small && gained.abs() <= small && !radius.is_of_refusal {
            return Some(Status::Cost);
        }
        if ws.step.is_full && length <= options.step * extent {
            return Some(Status::Step);
        }
        if is_last && gained.abs() <= negligible {
            return Some(Status::Cost);
        }
        if taken {
            return None;
        }
        if radius.size <= SHORTEST * extent || length == 0.0 {
            let is_lost = first_promise <= LOST * rounding;
            return Some(if is_lost { Status::Cost } else { Status::Stalled });
        }
    }
}
