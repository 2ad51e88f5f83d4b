//! Coefficients of the methods with one stage a step: the midpoint rule with discrete gradients, and the generalised-α method for equations of first order
//! (Jansen, Whiting and Hulbert, Comput. Methods Appl. Mech. Engrg. 190, 2000).

use crate::scheme::Scheme;
use crate::state::State;

/// Rates of a step say nothing of one that is longer by more than this: they are those of faster vibrations.
const FASTEST_GROWTH: f64 = 5.0;

/// Coefficients of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneStage {
    /// Where the rates of the stage lie.
    pub rate_place: f64,
    /// Where the unknowns of the stage lie.
    pub place: f64,
    gamma: f64,
    pub conserves: bool,
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
        if Self::knows_rates(from, h) { Self::generalised_alpha(rho) } else { Self::EULER }
    }

    /// Whether the rates of a state say something of a step of length `h`.
    pub fn knows_rates(from: &State, h: f64) -> bool {
        from.has_rates && h <= FASTEST_GROWTH * from.rates_of
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

    /// The weight of the velocity at the end in the motion of a free base: half of it, by the trapezoidal rule, but as much as that of rates at the end where the robot may touch something, since a
    /// base that is stopped at once would go on to swing otherwise.
    pub fn base_weight(&self, touches: bool) -> f64 {
        if touches { self.gamma } else { 0.5 }
    }

    /// How the state behind a step of length `h` and its rates depend on the stage and on those before.
    pub fn backwards(&self, scheme: &Scheme, h: f64) -> Backwards {
        // Rates at the end are those of the stage where they are not carried on.
        let rate_place = if self.conserves { 1.0 } else { self.rate_place };
        Backwards {
            stage_by_end: 1.0 / self.place,
            stage_by_rate: 1.0 / (rate_place * scheme.g),
            carried: self.carried(h),
            rate_by_rate: 1.0 - 1.0 / rate_place,
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
}
