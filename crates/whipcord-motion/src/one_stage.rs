//! Methods with one stage a step: the midpoint rule with discrete gradients, and the generalised-α method for equations of first order (Jansen,
//! Whiting and Hulbert, Comput. Methods Appl. Mech. Engrg. 190, 2000).

use whipcord_numerics::Twist;

use crate::energy::Power;
use crate::iteration::{Control, Mechanics, Solver, Stalled};
use crate::stage::Scheme;
use crate::state::State;

/// Rates of a step say nothing of one that is longer by more than this: they are those of faster vibrations.
const FASTEST_GROWTH: f64 = 5.0;

/// Coefficients of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneStage {
    /// Where the rates of the stage lie.
    rate_place: f64,
    /// Where the unknowns of the stage lie.
    place: f64,
    gamma: f64,
    conserves: bool,
}

/// What derivatives behind a step are multiplied by on their way back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Backwards {
    /// From the end to the stage.
    pub stage_by_end: f64,
    /// From the rates at the end to the stage.
    pub stage_by_rate: f64,
    /// From the history of the stage to the rates at the start.
    pub carried: f64,
    /// From the rates at the end to those at the start.
    pub rate_by_rate: f64,
}

impl OneStage {
    /// The midpoint rule, with the discrete gradients of what has an energy.
    pub const MIDPOINT: Self = Self { rate_place: 0.5, place: 0.5, gamma: 0.5, conserves: true };
    /// Euler's implicit rule, for steps from unknown rates.
    const EULER: Self = Self { rate_place: 1.0, place: 1.0, gamma: 1.0, conserves: false };

    /// The generalised-α method whose vibrations that are too fast for the step shrink by ρ a step; from unknown rates, and from those of much shorter
    /// steps, Euler's implicit rule.
    pub fn damping(rho: f64, from: &State, h: f64) -> Self {
        if !from.has_rates || h > FASTEST_GROWTH * from.rates_of {
            return Self::EULER;
        }
        Self::generalised_alpha(rho)
    }

    /// The generalised-α method from known rates.
    pub fn generalised_alpha(rho: f64) -> Self {
        let (rate_place, place) = (0.5 * (3.0 - rho) / (1.0 + rho), 1.0 / (1.0 + rho));
        Self { rate_place, place, gamma: 0.5 + rate_place - place, conserves: false }
    }

    /// Whether the rates before a step count in it.
    pub fn uses_rates(&self) -> bool {
        self.gamma != self.rate_place
    }

    /// Where in a step of length `h` loads and tensions are taken.
    pub fn time(&self, from: f64, h: f64) -> f64 {
        from + self.place * h
    }

    /// How the state behind a step of length `h` and its rates depend on the stage and on those before.
    pub fn backwards(&self, scheme: &Scheme, h: f64) -> Backwards {
        Backwards {
            stage_by_end: 1.0 / self.place,
            stage_by_rate: 1.0 / (self.rate_place * scheme.g),
            carried: self.carried(h),
            rate_by_rate: 1.0 - 1.0 / self.rate_place,
        }
    }

    /// Value and rate at the end of a step of a number, from those at its start and the value at the stage, whose history was `history`.
    pub fn end(&self, scheme: &Scheme, [from, rate]: [f64; 2], history: f64, at: f64) -> [f64; 2] {
        let of_stage = (at - history) / scheme.g;
        let after = rate + (of_stage - rate) / self.rate_place;
        [from + (at - from) / self.place, if self.rate_place == 1.0 { of_stage } else { after }]
    }

    /// How much of the rates before is in the history of a stage.
    pub fn carried(&self, h: f64) -> f64 {
        self.place * h * (1.0 - self.gamma / self.rate_place)
    }

    /// The scheme of a step of length `h`.
    pub fn scheme(&self, h: f64) -> Scheme {
        let g = self.place * self.gamma / self.rate_place * h;
        Scheme { place: self.place, conserves: self.conserves, ..Scheme::at_end(g) }
    }

    /// Takes a step from a state into another one: velocities, strains and their rates. Tensions and lengths must be set in the solver.
    pub fn step(
        &self,
        mechanics: Mechanics<'_>,
        solver: &mut Solver,
        from: &State,
        to: &mut State,
        h: f64,
        control: &Control,
    ) -> Result<Power, Stalled> {
        let Mechanics { rod, loads } = mechanics;
        let scheme = self.scheme(h);
        solver.is_linearised = false;
        let carried = self.carried(h);
        let ahead = if control.predicts && from.has_rates && h <= FASTEST_GROWTH * from.rates_of {
            self.place * h
        } else {
            0.0
        };
        let stage = &mut solver.stage;
        loads.at(self.time(from.time, h), &mut stage.loads);
        stage.start.copy_from_slice(&from.strains);
        let along = |out: &mut [Twist], at: &[Twist], rates: &[Twist], by: f64| {
            for ((out, at), rate) in out.iter_mut().zip(at).zip(rates) {
                *out = if by == 0.0 { *at } else { *at + *rate * by };
            }
        };
        along(&mut stage.velocity_history, &from.velocities, &from.velocity_rates, carried);
        along(&mut stage.strain_history, &from.strains, &from.strain_rates, carried);
        along(&mut stage.velocities, &from.velocities, &from.velocity_rates, ahead);
        along(&mut stage.strains, &from.strains, &from.strain_rates, ahead);
        stage.move_base(loads, from.base, from.time, self.place * h);
        solver.solve(mechanics, &scheme, control)?;
        let stage = &solver.stage;
        let mut work = Power::default();
        let power = Power::at(rod, stage, &scheme, solver.drag);
        work.add(h, &Power { contacts: solver.contacts.power(stage), ..power });
        let end = |to: &mut [Twist],
                   to_rates: &mut [Twist],
                   from: &[Twist],
                   from_rates: &[Twist],
                   at: &[Twist],
                   history: &[Twist]| {
            for j in 0..to.len() {
                let rate = (at[j] - history[j]) * (1.0 / scheme.g);
                to[j] = from[j] + (at[j] - from[j]) * (1.0 / self.place);
                to_rates[j] = if self.conserves || self.rate_place == 1.0 {
                    rate
                } else {
                    from_rates[j] + (rate - from_rates[j]) * (1.0 / self.rate_place)
                };
            }
        };
        let State { velocities, velocity_rates, strains, strain_rates, .. } = to;
        end(
            velocities,
            velocity_rates,
            &from.velocities,
            &from.velocity_rates,
            &stage.velocities,
            &stage.velocity_history,
        );
        end(
            strains,
            strain_rates,
            &from.strains,
            &from.strain_rates,
            &stage.strains,
            &stage.strain_history,
        );
        Ok(work)
    }
}
