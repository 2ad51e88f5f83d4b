//! Newton's method with a line search, for models that have none of their own.

use whipcord_numerics::{Equations, NewtonOptions, Solved, newton};

use super::{DirectionOf, EquilibriumPath, StateOf, Step};

const OPTIONS: NewtonOptions = NewtonOptions {
    tolerance: 0.0,
    iterations: 40,
    least_fraction: 1.0 / 1024.0,
    decrease: 1e-4,
    rounding: 1e-9,
    reuse: None,
    trusted: 0,
};

/// A path whose equations are solved.
struct OnPath<'a, P: EquilibriumPath, R> {
    path: &'a mut P,
    across: Option<&'a DirectionOf<P>>,
    residual: R,
    step: Option<(StateOf<P>, DirectionOf<P>)>,
}

/// From the state of a path, at its load or across a direction, to a residual of at most `tolerance`; the iterations and
/// what is left. `residual` evaluates the state; `None` where it cannot.
pub(crate) fn converge<P: EquilibriumPath>(
    path: &mut P,
    across: Option<&DirectionOf<P>>,
    tolerance: f64,
    residual: impl Fn(&mut P) -> Option<f64>,
) -> Option<Solved> {
    let options = NewtonOptions { tolerance, ..OPTIONS };
    newton(&mut OnPath { path, across, residual, step: None }, &options).ok()
}

impl<P: EquilibriumPath, R: Fn(&mut P) -> Option<f64>> Equations for OnPath<'_, P, R> {
    type Fault = ();

    fn residual(&mut self) -> Result<f64, ()> {
        (self.residual)(self.path).ok_or(())
    }

    fn step(&mut self, _fresh: bool) -> Option<f64> {
        let from = self.path.state();
        let direction = self.path.direction(self.across.map_or(Step::Close, Step::Across))?;
        self.step = Some((from, direction));
        Some(1.0)
    }

    fn go(&mut self, fraction: f64) {
        if let Some((from, direction)) = &self.step {
            self.path.step_from(from, fraction, direction);
        }
    }

    fn has_ended(&self) -> bool {
        self.path.has_ended()
    }
}
