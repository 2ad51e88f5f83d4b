//! Least squares with bounds and linearised constraints, by a Levenberg–Marquardt step from a quadratic programme.

use whipcord::SolveError;
use whipcord_numerics::{NoMinimum, Programme, QuadraticProgramme, dot};

use crate::linear::Linear;
use crate::secant::SecondOrder;

/// What is minimised.
pub(crate) trait Problem {
    /// What an evaluation leaves for the next one to start from.
    type State: Clone;

    /// The evaluation at a point, from another point and its state.
    fn evaluate(
        &mut self,
        unknowns: &[f64],
        from: Option<(&[f64], &Self::State)>,
    ) -> Result<Self::State, SolveError>;

    /// The evaluation at a point near another one, with the derivatives of that one.
    fn evaluate_without_rates(
        &mut self,
        unknowns: &[f64],
        from: (&[f64], &Self::State),
    ) -> Result<Self::State, SolveError>;

    /// Whether an evaluation without derivatives takes about as long as one with them.
    fn has_cheap_rates(&self) -> bool;

    /// Residuals and constraints of an evaluation.
    fn linearize(&self, state: &Self::State) -> Linear;

    /// The norm of the residuals that is tolerated.
    fn tolerance(&self) -> f64;
}

/// Where an iteration starts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Start<'a, S> {
    /// At unknowns.
    At(&'a [f64]),
    /// At unknowns, evaluated from other ones and their state.
    From(&'a [f64], (&'a [f64], &'a S)),
    /// At unknowns within the bounds whose state is known.
    Known(&'a [f64], &'a S),
}

/// Where the iteration ended.
#[derive(Clone, Debug)]
pub(crate) struct Descent<S> {
    pub unknowns: Vec<f64>,
    /// That of the unknowns, or of the point before them where they are foretold.
    pub state: S,
    /// The point before, where the last step was not evaluated because derivatives and curvature foretell that it ends within the tolerance.
    pub foretold_from: Option<Vec<f64>>,
    /// Whether the derivatives of the state are those of its point.
    pub has_own_rates: bool,
    /// The curvature behind the last step that was evaluated, as in [`Control::curvature`].
    pub curvature: Option<f64>,
    /// Whether no feasible direction lowers the cost.
    pub is_stationary: bool,
}

/// How an iteration is controlled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control<'a> {
    /// Bounds of each unknown.
    pub bounds: &'a [[f64; 2]],
    /// A change of each unknown that matters.
    pub scales: &'a [f64],
    /// Evaluations that may be spent.
    pub evaluations: usize,
    /// When it ends.
    pub ending: Ending,
    /// What the residuals of a step have beyond those of the linear problem, over the square of its size in scales, where that is known from before.
    pub curvature: Option<f64>,
}

/// When an iteration ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ending {
    /// It is solved at this part of what is tolerated.
    pub part_of_tolerance: f64,
    /// A promised reduction of the cost by less than this part of it is none.
    pub least_reduction: f64,
    /// A step that is foretold to end at this part of what is tolerated is not evaluated; at 0 all are.
    pub foretold: f64,
}

impl Ending {
    /// Of an answer: far within the tolerance, because it is solved again from rest.
    pub const ANSWER: Self = Self { part_of_tolerance: 0.02, least_reduction: 1e-9, foretold: 1.0 };
    /// Of one of many steps to an answer.
    pub const RESTORED: Self =
        Self { part_of_tolerance: 0.5, least_reduction: 1e-9, foretold: 0.0 };
    /// Of an answer to a tolerance far above the error of the model.
    pub const COARSE: Self = Self { part_of_tolerance: 0.5, least_reduction: 1e-2, foretold: 0.0 };
}

/// Largest step at first and at all, in scales of the unknowns, and damping at first.
pub(crate) const FIRST_RADIUS: f64 = 0.25;
pub(crate) const FIRST_DAMPING: f64 = 1e-8;
pub(crate) const LARGEST_RADIUS: f64 = 4.0;
/// A step of this size, in scales, moves nothing.
const LEAST_STEP: f64 = 1e-11;
/// An unknown so near to a bound, in scales, is at it.
const AT_BOUND: f64 = 1e-12;

/// How far a step may lead.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    /// λ.
    pub damping: f64,
    /// Δ, in scales of the unknowns.
    pub radius: f64,
}

/// A step that lowers the merit by less than this part of it shows that Gauss and Newton's matrix leaves out what decides.
const SLOW: f64 = 0.2;
/// What a step teaches of the second-order part is kept where it lowers the merit by less than this part.
const LEARNED: f64 = 0.5;

/// Minimises `½‖r(x)‖²` within bounds and constraints.
///
/// The step is the minimum of `½‖r + J d‖² + ½λ t‖d‖² + ρ σ` with the mean `t` of the diagonal of `JᵀJ`, over
/// `l ≤ x + d ≤ u`, `|d| ≤ Δ` and `rows · d ≤ slack + σ`, `σ ≥ 0`, in scaled unknowns: the relaxation σ keeps it feasible, and ρ is
/// so large that it is zero wherever the constraints can be kept. λ and Δ follow the ratio of the reduction of
/// `½‖r‖² + ρ max(violation)` to what was promised. Once steps gain little, `½ dᵀS d` with the [`SecondOrder`] part is added.
///
/// # Errors
/// Why there is no answer at the start.
pub(crate) fn descend<P: Problem>(
    problem: &mut P,
    start: Start<'_, P::State>,
    control: &Control<'_>,
    workspace: &mut Workspace,
) -> Result<Descent<P::State>, SolveError> {
    let (mut x, mut state) = match start {
        Start::Known(x, state) => (x.to_vec(), state.clone()),
        Start::At(start) => {
            let x = within(start, control.bounds);
            let state = problem.evaluate(&x, None)?;
            (x, state)
        }
        Start::From(start, from) => {
            let x = within(start, control.bounds);
            let state = problem.evaluate(&x, Some(from))?;
            (x, state)
        }
    };
    let n = x.len();
    let is_done = |linear: &Linear, tolerance: f64| {
        linear.violation() == 0.0 && linear.distance() <= tolerance
    };
    let tolerance = problem.tolerance();
    let mut linear = problem.linearize(&state);
    let mut curvature = control.curvature;
    // How far the point is from that of its derivatives.
    let mut stale = 0.0;
    let mut second = SecondOrder::default();
    let mut is_slow = false;
    let mut damping = FIRST_DAMPING;
    let mut radius = FIRST_RADIUS;
    let mut is_stationary = false;
    let mut evaluations = 1;
    let mut trial = x.clone();
    while evaluations < control.evaluations
        && !is_done(&linear, control.ending.part_of_tolerance * tolerance)
    {
        let cost = linear.cost();
        let penalty = linear.penalty();
        let region = Region { damping, radius };
        let by = |second: &[f64], workspace: &mut Workspace| {
            workspace.step(&linear, second, &x, control, region, penalty)
        };
        // Where the sum of both parts is not positive the first goes by itself.
        let promised = match is_slow {
            true => by(second.matrix(), workspace).or_else(|_| by(&[], workspace)),
            false => by(&[], workspace),
        };
        let Ok(promised) = promised else {
            damping = (damping * 10.0).max(1e-10);
            if damping > 1e6 {
                break;
            }
            continue;
        };
        let step = &workspace.step;
        let size = step[..n].iter().fold(0.0, |a: f64, d| a.max(d.abs()));
        let merit = cost + penalty * linear.violation();
        for (k, trial) in trial.iter_mut().enumerate() {
            let [least, greatest] = control.bounds[k];
            let near = AT_BOUND * control.scales[k];
            *trial = match x[k] + step[k] * control.scales[k] {
                moved if moved - least < near => least,
                moved if greatest - moved < near => greatest,
                moved => moved,
            };
        }
        let mut is_chord = false;
        if let Some(known) = curvature
            && workspace.violation == 0.0
            && control.ending.foretold > 0.0
        {
            let part = control.ending.foretold * tolerance;
            let left = workspace.distance + known * size * (size + 2.0 * stale);
            if left <= part {
                return Ok(Descent {
                    unknowns: trial,
                    state,
                    foretold_from: Some(x),
                    has_own_rates: false,
                    curvature,
                    is_stationary: false,
                });
            }
            // Whether a step behind this one ends within the tolerance with the derivatives from before this one.
            let next = size * left / linear.distance().max(f64::MIN_POSITIVE);
            is_chord = stale == 0.0
                && !problem.has_cheap_rates()
                && known * next * (next + 2.0 * size) <= 0.5 * part;
        }
        if stale > 0.0 {
            evaluations += 1;
            stale = 0.0;
            match problem.evaluate(&x, Some((&x, &state))) {
                Ok(own) => {
                    linear = problem.linearize(&own);
                    state = own;
                    continue;
                }
                Err(error @ SolveError::Cancelled { .. }) => return Err(error),
                // It has an answer, from where it was found.
                Err(_) => {}
            }
        }
        // At full radius and without damping the promise is that of the linear problem.
        if size < LEAST_STEP || promised <= control.ending.least_reduction * merit {
            is_stationary = linear.violation() == 0.0;
            break;
        }
        evaluations += 1;
        let evaluated = match is_chord {
            true => problem.evaluate_without_rates(&trial, (&x, &state)),
            false => problem.evaluate(&trial, Some((&x, &state))),
        };
        match evaluated {
            Ok(next_state) => {
                let next = problem.linearize(&next_state);
                curvature = Some((next.distance() + workspace.distance) / (size * size));
                let next_merit = next.cost() + penalty * next.violation();
                let ratio = (merit - next_merit) / promised;
                if !is_chord && merit - next_merit < LEARNED * merit {
                    second.learn(&workspace.step, control.scales, &linear, &next);
                    is_slow |= merit - next_merit < SLOW * merit;
                }
                if next_merit < merit {
                    x.copy_from_slice(&trial);
                    (linear, state) = (next, next_state);
                    stale = if is_chord { size } else { 0.0 };
                    if ratio > 0.6 {
                        damping = (damping * 0.1).max(1e-14);
                        radius = (2.0 * radius).min(LARGEST_RADIUS);
                    } else if ratio < 0.2 {
                        damping = (damping * 4.0).max(1e-8);
                        radius *= 0.6;
                    }
                } else {
                    damping = (damping * 8.0).max(1e-8);
                    radius = 0.4 * size;
                    if radius < LEAST_STEP {
                        // The promise is within rounding of the model.
                        is_stationary = promised <= 1e-4 * merit && linear.violation() == 0.0;
                        break;
                    }
                }
            }
            // A shorter step leads to where there is an answer, or the start is at the end of what the model can answer.
            Err(error @ SolveError::Cancelled { .. }) => return Err(error),
            Err(_) => {
                damping = (damping * 10.0).max(1e-8);
                radius = 0.3 * size;
                if radius < LEAST_STEP {
                    break;
                }
            }
        }
    }
    let has_own_rates = stale == 0.0;
    Ok(Descent { unknowns: x, state, foretold_from: None, has_own_rates, curvature, is_stationary })
}

/// The point of the bounds that is nearest.
pub(crate) fn within(x: &[f64], bounds: &[[f64; 2]]) -> Vec<f64> {
    x.iter().zip(bounds).map(|(x, [least, greatest])| x.max(*least).min(*greatest)).collect()
}

/// Scratch memory of [`descend`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    solver: QuadraticProgramme,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    rows: Vec<f64>,
    limits: Vec<f64>,
    /// Of the Jacobian in scales of the unknowns, and `r + J d`.
    columns: Vec<f64>,
    left: Vec<f64>,
    /// In scales of the unknowns; the relaxation behind them where there are constraints.
    step: Vec<f64>,
    /// As [`Self::left`] says.
    distance: f64,
    violation: f64,
}

impl Workspace {
    /// The last step, in scales of the unknowns.
    pub fn last_step(&self) -> &[f64] {
        &self.step
    }

    /// `‖r + J d‖` behind the last step, and the violation that is left there in the linear problem.
    pub const fn left(&self) -> (f64, f64) {
        (self.distance, self.violation)
    }

    /// Writes the step and returns by how much it promises to lower the merit. `second` is the second-order part in scales by rows, or nothing.
    pub fn step(
        &mut self,
        linear: &Linear,
        second: &[f64],
        x: &[f64],
        control: &Control<'_>,
        Region { damping, radius }: Region,
        penalty: f64,
    ) -> Result<f64, NoMinimum> {
        let n = x.len();
        let m = linear.residual.len();
        let constraints = linear.slack.len();
        let relaxed = usize::from(constraints > 0);
        let size = n + relaxed;
        self.columns.clear();
        self.columns.resize(n * m, 0.0);
        for (i, row) in linear.jacobian.chunks_exact(n).enumerate() {
            for (k, (j, scale)) in row.iter().zip(control.scales).enumerate() {
                self.columns[k * m + i] = j * scale;
            }
        }
        self.matrix.clear();
        self.matrix.resize(size * size, 0.0);
        self.gradient.clear();
        self.gradient.resize(size, 0.0);
        for a in 0..n {
            let column = &self.columns[a * m..(a + 1) * m];
            self.gradient[a] = dot(column, &linear.residual);
            for b in 0..=a {
                let product = dot(column, &self.columns[b * m..(b + 1) * m]);
                self.matrix[a * size + b] = product;
                self.matrix[b * size + a] = product;
            }
        }
        #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ unknowns")]
        let mean = ((0..n).map(|a| self.matrix[a * size + a]).sum::<f64>() / n as f64).max(1e-300);
        for a in 0..n {
            self.matrix[a * size + a] += (damping + 1e-12) * mean;
        }
        for (a, row) in second.chunks_exact(n).enumerate() {
            for (b, part) in row.iter().enumerate() {
                self.matrix[a * size + b] += part;
            }
        }
        self.lower.clear();
        self.upper.clear();
        for ((x, [least, greatest]), scale) in x.iter().zip(control.bounds).zip(control.scales) {
            self.lower.push(((least - x) / scale).max(-radius));
            self.upper.push(((greatest - x) / scale).min(radius));
        }
        self.rows.clear();
        self.limits.clear();
        if relaxed == 1 {
            self.matrix[n * size + n] = mean;
            self.gradient[n] = penalty;
            self.lower.push(0.0);
            self.upper.push(f64::INFINITY);
            for (row, slack) in linear.rows.chunks_exact(n).zip(&linear.slack) {
                self.rows.extend(row.iter().zip(control.scales).map(|(a, scale)| a * scale));
                self.rows.push(-1.0);
                self.limits.push(*slack);
            }
        }
        let programme = Programme {
            matrix: &self.matrix,
            gradient: &self.gradient,
            lower: &self.lower,
            upper: &self.upper,
            rows: &self.rows,
            limits: &self.limits,
        };
        self.solver.minimise(&programme, &mut self.step)?;
        self.left.clone_from(&linear.residual);
        for (k, d) in self.step[..n].iter().enumerate() {
            let column = &self.columns[k * m..(k + 1) * m];
            self.left.iter_mut().zip(column).for_each(|(left, j)| *left += j * d);
        }
        let predicted = dot(&self.left, &self.left);
        let violation = self.rows.chunks_exact(size).zip(&linear.slack).map(|(row, slack)| {
            row[..n].iter().zip(&self.step).map(|(a, d)| a * d).sum::<f64>() - slack
        });
        let violation = violation.fold(0.0, f64::max);
        let bent: f64 = (second.chunks_exact(n).zip(&self.step))
            .map(|(row, d)| d * row.iter().zip(&self.step).map(|(s, d)| s * d).sum::<f64>())
            .sum();
        (self.distance, self.violation) = (predicted.sqrt(), violation);
        let cost = 0.5 * (predicted + bent);
        Ok(linear.cost() - cost + penalty * (linear.violation() - violation))
    }
}
