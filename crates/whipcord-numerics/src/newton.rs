//! Newton's method with a line search on the size of the residual.

/// Equations that are solved by Newton's method, with the unknowns where they stand.
pub trait Equations {
    /// Why they cannot be evaluated somewhere.
    type Fault;

    /// Evaluates the equations at the unknowns: the size of the residual.
    ///
    /// # Errors
    /// The fault where they cannot be evaluated.
    fn residual(&mut self) -> Result<f64, Self::Fault>;

    /// Finds the step from the unknowns, where the equations were evaluated last, with a fresh linearisation or with the one at
    /// hand, and keeps the unknowns as its start. Returns the fraction of the step to begin with, 1 for the whole; `None`
    /// where the linear system is singular.
    fn step(&mut self, fresh: bool) -> Option<f64>;

    /// Goes a fraction of the step from its start.
    fn go(&mut self, fraction: f64);

    /// Whether the iteration is ended from outside.
    fn has_ended(&self) -> bool {
        false
    }

    /// Is told of each iteration: its number from 1, what it left, and the fraction of the step that was taken.
    fn note(&mut self, _iteration: usize, _residual: f64, _fraction: f64) {}
}

/// How Newton's method goes on, and when it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// The residual of a solution.
    pub tolerance: f64,
    /// Steps at most.
    pub iterations: usize,
    /// Steps are halved down to this fraction.
    pub least_fraction: f64,
    /// A step takes away at least this part of the residual, times its fraction.
    pub decrease: f64,
    /// A residual that rounding may leave: of a solution too, where a whole step does not halve it.
    pub rounding: f64,
    /// When a linearisation serves the next step as well; `None` where each step has its own.
    pub reuse: Option<Reuse>,
    /// So many steps in a row are taken whole though they gain nothing, where fractions of them do not either.
    pub trusted: usize,
}

/// When a linearisation serves the next step as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reuse {
    /// Whether there is one at the beginning that is near enough.
    pub at_start: bool,
    /// After a whole step that leaves less than this, and less than this part of the residual.
    pub near: f64,
    /// It has to leave less than this part of the residual, or a fresh one takes its place.
    pub ratio: f64,
}

/// The end of an iteration at a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Steps.
    pub iterations: usize,
    /// What is left.
    pub residual: f64,
}

/// The end of an iteration without a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unsolved<F> {
    /// Steps.
    pub iterations: usize,
    /// What was left at the last point that was taken; infinite where there is none.
    pub residual: f64,
    /// Why the equations could not be evaluated where the iteration ended.
    pub fault: Option<F>,
}

/// Whole steps that are taken though they gain nothing.
struct Trust {
    /// What they have to fall below.
    residual: f64,
    steps: usize,
}

/// Solves equations from where their unknowns stand, which end at the solution, or at the point that the residual of [`Unsolved`] is of.
///
/// # Errors
/// [`Unsolved`] when the iteration ends before it has a solution.
pub fn newton<E: Equations>(
    equations: &mut E,
    options: &NewtonOptions,
) -> Result<Solved, Unsolved<E::Fault>> {
    let ended = |iterations, residual, fault| Err(Unsolved { iterations, residual, fault });
    let mut residual = match equations.residual() {
        Ok(residual) => residual,
        Err(fault) => return ended(0, f64::INFINITY, Some(fault)),
    };
    let mut fresh = !options.reuse.is_some_and(|reuse| reuse.at_start);
    let mut trust: Option<Trust> = None;
    let mut iteration = 0;
    loop {
        if residual <= options.tolerance {
            return Ok(Solved { iterations: iteration, residual });
        }
        if iteration >= options.iterations || equations.has_ended() {
            return ended(iteration, residual, None);
        }
        if trust.as_ref().is_some_and(|trust| residual < trust.residual) {
            trust = None;
        }
        let first = match equations.step(fresh) {
            Some(first) => first,
            None if fresh => return ended(iteration, residual, None),
            None => {
                fresh = true;
                continue;
            }
        };
        iteration += 1;
        let mut fraction = first;
        residual = loop {
            equations.go(fraction);
            let outcome = equations.residual();
            if let Ok(now) = outcome {
                let is_rounding = now.max(residual) <= options.rounding && now >= 0.5 * residual;
                if fraction == first && is_rounding {
                    equations.note(iteration, now, fraction);
                    return Ok(Solved { iterations: iteration, residual: now });
                }
                let ratio = match options.reuse {
                    Some(Reuse { ratio, .. }) if !fresh => ratio,
                    _ => 1.0 - options.decrease * fraction,
                };
                if now < ratio * residual {
                    let near = |Reuse { near, .. }| now < near * residual && now < near;
                    fresh = !(fraction == 1.0 && options.reuse.is_some_and(near));
                    equations.note(iteration, now, fraction);
                    break now;
                }
            }
            if !fresh {
                fresh = true;
                equations.go(0.0);
                match equations.residual() {
                    Ok(before) => break before,
                    Err(fault) => return ended(iteration, residual, Some(fault)),
                }
            }
            let trusts = match &mut trust {
                None if options.trusted > 0 && 0.5 * fraction < options.least_fraction => {
                    trust = Some(Trust { residual, steps: 1 });
                    true
                }
                Some(trust) if fraction == first => {
                    trust.steps += 1;
                    trust.steps <= options.trusted
                }
                _ => false,
            };
            if trusts {
                equations.go(first);
                if let Ok(now) = equations.residual()
                    && now.is_finite()
                {
                    equations.note(iteration, now, first);
                    break now;
                }
            }
            fraction *= 0.5;
            if fraction < options.least_fraction || trust.is_some() {
                equations.go(0.0);
                return ended(iteration, residual, outcome.err());
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: NewtonOptions = NewtonOptions {
        tolerance: 1e-13,
        iterations: 40,
        least_fraction: 1.0 / 1024.0,
        decrease: 1e-4,
        rounding: 1e-9,
        reuse: None,
        trusted: 0,
    };

    /// One equation `f(x) = 0`, which has no value beyond `reach`.
    struct One {
        f: fn(f64) -> [f64; 2],
        reach: f64,
        x: f64,
        start: f64,
        step: f64,
        slope: f64,
        linearisations: usize,
        notes: Vec<f64>,
    }

    impl One {
        fn new(f: fn(f64) -> [f64; 2], x: f64) -> Self {
            let (reach, notes) = (f64::INFINITY, Vec::new());
            Self { f, reach, x, start: x, step: 0.0, slope: 0.0, linearisations: 0, notes }
        }
    }

    impl Equations for One {
        type Fault = f64;

        fn residual(&mut self) -> Result<f64, f64> {
            if self.x.abs() > self.reach { Err(self.x) } else { Ok((self.f)(self.x)[0].abs()) }
        }

        fn step(&mut self, fresh: bool) -> Option<f64> {
            let [value, slope] = (self.f)(self.x);
            if fresh {
                self.slope = slope;
                self.linearisations += 1;
            }
            self.start = self.x;
            self.step = -value / self.slope;
            (self.slope != 0.0).then_some(1.0)
        }

        fn go(&mut self, fraction: f64) {
            self.x = self.start + fraction * self.step;
        }

        fn note(&mut self, _: usize, residual: f64, _: f64) {
            self.notes.push(residual);
        }
    }

    #[test]
    fn shortens_the_steps_that_overshoot() {
        // Whole steps diverge from |x| > 1.39.
        let mut arctangent = One::new(|x| [x.atan(), 1.0 / (1.0 + x * x)], 20.0);
        let solved = newton(&mut arctangent, &OPTIONS);
        assert!(solved.is_ok_and(|solved| solved.residual <= 1e-13 && solved.iterations < 20));
        assert!(arctangent.x.abs() <= 1e-13);
        assert!(arctangent.notes.windows(2).all(|pair| pair[1] < pair[0]));
    }

    #[test]
    fn a_point_that_cannot_be_evaluated_shortens_the_step_or_ends_it() {
        let mut root = One { reach: 3.0, ..One::new(|x| [x * x - 4.0, 2.0 * x], 0.1) };
        assert!(newton(&mut root, &OPTIONS).is_ok());
        assert!((root.x.abs() - 2.0).abs() < 1e-12);
        let mut beyond = One { reach: 1.0, ..One::new(|x| [x - 4.0, 1.0], 1.0) };
        let unsolved = newton(&mut beyond, &OPTIONS);
        assert!(unsolved.is_err_and(|u| u.iterations == 1 && u.fault.is_some_and(|x| x > 1.0)));
        let mut outside = One { reach: 1.0, ..One::new(|x| [x, 1.0], 2.0) };
        assert_eq!(
            newton(&mut outside, &OPTIONS),
            Err(Unsolved { iterations: 0, residual: f64::INFINITY, fault: Some(2.0) })
        );
    }

    #[test]
    fn ends_where_nothing_gains() {
        let mut none = One::new(|x| [1.0 + x * x, 2.0 * x], 1.0);
        let unsolved = newton(&mut none, &OPTIONS);
        assert!(unsolved.is_err_and(|u| u.residual >= 1.0 && u.fault.is_none()));
        let mut singular = One::new(|_| [1.0, 0.0], 1.0);
        assert_eq!(
            newton(&mut singular, &OPTIONS),
            Err(Unsolved { iterations: 0, residual: 1.0, fault: None })
        );
        let few = NewtonOptions { iterations: 2, ..OPTIONS };
        let unsolved = newton(&mut One::new(|x| [x * x * x, 3.0 * x * x], 1.0), &few);
        assert!(unsolved.is_err_and(|unsolved| unsolved.iterations == 2));
    }

    #[test]
    fn what_rounding_leaves_is_a_solution() {
        // Beside the root it is never less than 1e-10.
        let mut rough = One::new(|x| [x + 1e-10, 1.0], 1.0);
        rough.f = |x| [if x.abs() < 1e-3 { 1e-10 } else { x }, 1.0];
        let solved = newton(&mut rough, &OPTIONS);
        assert_eq!(solved.map(|solved| solved.residual), Ok(1e-10));
    }

    #[test]
    fn a_linearisation_near_the_solution_serves_again() {
        let reuse = Some(Reuse { at_start: false, near: 0.05, ratio: 0.5 });
        let cubic: fn(f64) -> [f64; 2] = |x| [x * x * x - 8.0, 3.0 * x * x];
        let (mut own, mut shared) = (One::new(cubic, 2.2), One::new(cubic, 2.2));
        assert!(newton(&mut own, &OPTIONS).is_ok());
        assert!(newton(&mut shared, &NewtonOptions { reuse, ..OPTIONS }).is_ok());
        assert!(shared.linearisations < own.linearisations);
        assert!((shared.x - 2.0).abs() < 1e-12);
    }

    #[test]
    fn trusted_steps_may_climb_for_a_while() {
        // Steps that the slope exaggerates: only the third whole one comes down.
        let f: fn(f64) -> [f64; 2] = |x| match x {
            0.0..1.0 => [1.0, -1.0],
            1.0..2.0 => [2.0, -2.0],
            2.0..3.0 => [1.5, -1.5],
            _ => [0.0, 1.0],
        };
        assert!(newton(&mut One::new(f, 0.0), &OPTIONS).is_err());
        let solved = newton(&mut One::new(f, 0.0), &NewtonOptions { trusted: 6, ..OPTIONS });
        assert_eq!(solved, Ok(Solved { iterations: 3, residual: 0.0 }));
    }
}
