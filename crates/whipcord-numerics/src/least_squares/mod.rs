//! Non-linear least squares with few unknowns, robust where asked.
//!
//! Minimised is `½ Σ ρ(‖rₖ(x)‖²)` over `x`, within bounds: the residuals `r` come in blocks, such as the
//! three coordinates of a point, and `ρ` is a [`Loss`]. The method is Levenberg's and Marquardt's with
//! Moré's control of the step (The Levenberg–Marquardt algorithm: implementation and theory, in: Numerical
//! Analysis, Lecture Notes in Mathematics 630 (1978) 105): scaled by the norms of the Jacobian's columns,
//! solved by orthogonal factors. A loss enters by weights of the blocks
//! (Holland and Welsch, Communications in Statistics A 6 (1977) 813).

mod loss;
mod solver;
mod step;

pub use loss::Loss;
pub use solver::Workspace;

/// What is made small.
pub trait Residuals {
    /// Why there is no answer for some unknowns.
    type Refusal;

    /// How many residuals there are.
    fn count(&self) -> usize;

    /// Writes the residuals.
    ///
    /// # Errors
    /// Where there are none for these unknowns: a shorter step is tried then.
    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), Self::Refusal>;

    /// Writes the derivatives of the residuals by the unknowns, by rows. It is always asked for the
    /// unknowns that [`Self::residuals`] answered last.
    ///
    /// # Errors
    /// Where there are none for these unknowns: a shorter step is tried then.
    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), Self::Refusal>;

    /// How many residuals, from this one on, a robust loss takes together.
    fn block(&self, _first: usize) -> usize {
        1
    }

    /// Whether the loss counts the block that begins at this residual; else it is counted by its square.
    fn takes_loss(&self, _first: usize) -> bool {
        true
    }
}

/// How, and how far, to minimise.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// How much large residuals count.
    pub loss: Loss,
    /// Least values of the unknowns; empty where they have none.
    pub lower: Vec<f64>,
    /// Largest values of the unknowns; empty where they have none.
    pub upper: Vec<f64>,
    /// Done when the residuals' cosine with every column of the Jacobian is below this.
    pub gradient: f64,
    /// Done when a step changes the unknowns, each in proportion to how much the residuals depend on it,
    /// by less than this fraction.
    pub step: f64,
    /// Done when a step changes the cost by less than this fraction, and could not be expected to change it
    /// by more.
    pub cost: f64,
    /// Done when the linearised problem promises no decrease of the cost that matters, however long a step is. The step of which this
    /// is true is still taken. Where the curvature of a valley holds steps back, the search ends once [`CURVED`] times as much is promised.
    pub negligible: Negligible,
    /// Steps that may be taken.
    pub iterations: usize,
}

/// See [`Options::negligible`].
pub const CURVED: f64 = 400.0;

/// What decrease of the cost does not matter. For residuals with noise of the deviation σ, a decrease of `½ ε σ²` that is promised is a step that moves no unknown by
/// more than `√ε` of its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Negligible {
    /// Each matters.
    #[default]
    Nothing,
    /// One that is no greater than this part of the cost: `ε/(m − n)` of `m` residuals and `n` unknowns where nothing but the residuals says how large the
    /// noise is.
    PartOfCost(f64),
    /// One that is no greater than this.
    Cost(f64),
}

impl Default for Options {
    fn default() -> Self {
        Self {
            loss: Loss::Squares,
            lower: Vec::new(),
            upper: Vec::new(),
            gradient: 1e-12,
            step: 1e-10,
            cost: 1e-12,
            negligible: Negligible::Nothing,
            iterations: 100,
        }
    }
}

/// Why the iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The residuals are orthogonal to what the unknowns can change.
    Gradient,
    /// The unknowns no longer change.
    Step,
    /// The cost no longer changes, or not by what matters ([`Options::negligible`]).
    Cost,
    /// No step, however short, lowers the cost, though the derivatives promise it.
    Stalled,
    /// No step, however short, leads to where there are residuals.
    Refused,
    /// The steps that may be taken were.
    IterationLimit,
}

impl Status {
    /// Whether a minimum was reached.
    #[must_use]
    pub const fn is_converged(self) -> bool {
        matches!(self, Self::Gradient | Self::Step | Self::Cost)
    }
}

/// How a minimisation ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome<R> {
    /// Why it ended.
    pub status: Status,
    /// `½ Σ ρ`.
    pub cost: f64,
    /// Steps taken.
    pub iterations: usize,
    /// How often residuals were asked for.
    pub evaluations: usize,
    /// Why the last step that was refused was.
    pub refusal: Option<NoResiduals<R>>,
}

/// Why unknowns were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoResiduals<R> {
    /// By the problem.
    Refused(R),
    /// A residual or a derivative is not finite.
    NotFinite,
}

/// Minimises from `unknowns` and leaves the best in them. The workspace then holds the residuals, their
/// derivatives and their weights.
///
/// ```
/// use whipcord_numerics::least_squares::{Options, Residuals, Workspace, minimise};
/// /// Rosenbrock's valley.
/// struct Valley;
/// impl Residuals for Valley {
///     type Refusal = ();
///     fn count(&self) -> usize {
///         2
///     }
///     fn residuals(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), ()> {
///         into.copy_from_slice(&[10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
///         Ok(())
///     }
///     fn jacobian(&mut self, x: &[f64], into: &mut [f64]) -> Result<(), ()> {
///         into.copy_from_slice(&[-20.0 * x[0], 10.0, -1.0, 0.0]);
///         Ok(())
///     }
/// }
/// let mut x = [-1.2, 1.0];
/// let outcome = minimise(&mut Valley, &mut x, &Options::default(), &mut Workspace::default());
/// assert!(outcome.is_ok_and(|outcome| outcome.status.is_converged()));
/// assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12);
/// ```
///
/// # Errors
/// [`NoResiduals`] where there are none at the start.
pub fn minimise<P: Residuals>(
    problem: &mut P,
    unknowns: &mut [f64],
    options: &Options,
    workspace: &mut Workspace,
) -> Result<Outcome<P::Refusal>, NoResiduals<P::Refusal>> {
    solver::minimise(problem, unknowns, options, workspace)
}
