//! The equation of each hole.
//!
//! A cable enters the base disk along the base's z axis and turns by `φᵢ` in the hole of disk i, from
//! one chord to the next. By Eytelwein's law its tension on the two sides obeys
//!
//! ```text
//! e^(−μφᵢ) Tᵢ₋₁ ≤ Tᵢ ≤ e^(μφᵢ) Tᵢ₋₁                                                             (1)
//! ```
//!
//! and lies at the lower bound where the cable slides towards the base, at the upper one where it
//! slides towards the tip. With `Dᵢ = Σ_{k≥i} (ℓₖ − Tₖ ℓₖ⁰/EA)`, what there is of the cable beyond the
//! hole when nothing stretches it, it has slid by `gᵢ = Dᵢ(before) − Dᵢ` in a substep, and
//!
//! ```text
//! gᵢ − max(0, gᵢ − κ(Tᵢ − e^(−μφᵢ)Tᵢ₋₁)) − min(0, gᵢ + κ(e^(μφᵢ)Tᵢ₋₁ − Tᵢ)) = 0,   κ > 0        (2)
//! ```
//!
//! says all of this in one equation for each hole; where a length is given, `D₀` takes the place of
//! the one at the base.

use super::holes::Holes;
use super::modes::{Condition, Mode};
use crate::statics::command::Command;

/// The equations of the holes in one substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law<'a> {
    pub holes: &'a Holes,
    /// By cable.
    pub commands: &'a [Command],
    /// `Dᵢ` before the substep, by passage.
    pub before: &'a [f64],
    /// The case of each hole, where it is given.
    pub modes: Option<&'a [Mode]>,
}

/// The equation of a hole.
#[derive(Clone, Copy, Debug)]
pub(super) enum Row {
    /// `T = 0`.
    Slack,
    /// `D` is given.
    Held,
    /// `T − f T₋₁ = 0` with `∂f/∂φ`.
    Slides { factor: f64, by_turn: f64, incoming: f64 },
}

/// What is known at the holes at an iterate: tensions, `Dᵢ` and `φᵢ` of all passages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Iterate<'a> {
    pub tensions: &'a [f64],
    pub beyond: &'a [f64],
    pub turns: &'a [f64],
}

impl Law<'_> {
    /// The tension at the near side of a hole; `None` where the length of the cable is given there.
    fn incoming(&self, (cable, place): (usize, usize), tensions: &[f64]) -> Option<f64> {
        match (place.checked_sub(1), self.commands[cable]) {
            (Some(before), _) => Some(tensions[self.holes.of_cable[cable][before]]),
            (None, Command::Tension(given)) => Some(given),
            (None, Command::Length { .. }) => None,
        }
    }

    /// The length that is given for what lies beyond the hole in the base.
    fn target(&self, cable: usize) -> f64 {
        match self.commands[cable] {
            Command::Length { target, .. } => target,
            Command::Tension(_) => f64::INFINITY,
        }
    }

    /// By how much what lies beyond the hole in the base, and the drive that gives, are longer than commanded.
    pub fn lack(&self, cable: usize, at: Iterate<'_>) -> f64 {
        self.holes.at_drive(cable, at.beyond, at.tensions) - self.target(cable)
    }

    /// The case of eq. (2) at an iterate.
    pub fn mode(&self, (cable, place): (usize, usize), at: Iterate<'_>) -> Mode {
        let kappa = self.holes.compliance;
        let p = self.holes.of_cable[cable][place];
        if let Some(modes) = self.modes {
            return modes[p];
        }
        let tension = at.tensions[p];
        let Some(incoming) = self.incoming((cable, place), at.tensions) else {
            let lack = self.lack(cable, at);
            return if lack + kappa * tension <= 0.0 { Mode::Slack } else { Mode::Held };
        };
        let is_outside = place == 0 && self.holes.starts_outside(cable);
        let coefficient = self.holes.coefficients[cable];
        if is_outside || coefficient == 0.0 || (incoming <= 0.0 && tension <= 0.0) {
            return Mode::Free;
        }
        let slip = self.before[p] - at.beyond[p];
        let factor = (coefficient * at.turns[p]).exp();
        if slip - kappa * (tension - incoming / factor) > 0.0 {
            Mode::Pulled
        } else if slip + kappa * (factor * incoming - tension) < 0.0 {
            Mode::Released
        } else {
            Mode::Sticks
        }
    }

    /// The equation of a hole in this case, and what it leaves, in m.
    pub fn row(&self, (cable, place): (usize, usize), mode: Mode, at: Iterate<'_>) -> (Row, f64) {
        let kappa = self.holes.compliance;
        let p = self.holes.of_cable[cable][place];
        let tension = at.tensions[p];
        let slides = |sign: f64| {
            let incoming = self.incoming((cable, place), at.tensions).unwrap_or_default();
            let coefficient = self.holes.coefficients[cable];
            let factor = (sign * coefficient * at.turns[p]).exp();
            let row = Row::Slides { factor, by_turn: sign * coefficient * factor, incoming };
            (row, kappa * (tension - factor * incoming))
        };
        match mode {
            Mode::Slack => (Row::Slack, kappa * tension),
            Mode::Held => (Row::Held, self.lack(cable, at)),
            Mode::Sticks => (Row::Held, at.beyond[p] - self.before[p]),
            Mode::Free | Mode::Pulled => slides(-1.0),
            Mode::Released => slides(1.0),
        }
    }

    /// How far a hole is from another case at an iterate that satisfies its equation: a slip or a slack as a part of the length of the robot, a tension as a part of its
    /// bounds. An angle of zero is at a change too: the tension has the same slope on both of its sides, with another sign.
    pub fn margin(&self, (cable, place): (usize, usize), mode: Mode, at: Iterate<'_>) -> f64 {
        let p = self.holes.of_cable[cable][place];
        let tension = at.tensions[p];
        let part = |length: f64| length.abs() / self.holes.length;
        match mode {
            Mode::Slack => part(self.lack(cable, at)),
            Mode::Held => tension * self.holes.compliance / self.holes.length,
            Mode::Free => f64::INFINITY,
            Mode::Pulled | Mode::Released => part(self.before[p] - at.beyond[p]).min(at.turns[p]),
            Mode::Sticks => {
                let incoming = self.incoming((cable, place), at.tensions).unwrap_or_default();
                let factor = (self.holes.coefficients[cable] * at.turns[p]).exp();
                let (above, below) = (tension - incoming / factor, factor * incoming - tension);
                above.min(below) / incoming.max(tension).max(f64::MIN_POSITIVE)
            }
        }
    }

    /// What must hold in the case of a hole after a linear step to these values, as long as that goes. `now` is where the step begins.
    pub fn conditions(
        &self,
        (cable, place): (usize, usize),
        mode: Mode,
        now: Iterate<'_>,
        after: Iterate<'_>,
        rounding: f64,
    ) -> [Option<Condition>; 2] {
        let kappa = self.holes.compliance;
        let p = self.holes.of_cable[cable][place];
        let slip = self.before[p] - after.beyond[p];
        let tension = after.tensions[p];
        let holds = |value: f64, next: Mode| Some(Condition { value, rounding, next });
        match mode {
            _ if self.modes.is_some() => [None; 2],
            Mode::Free => [None; 2],
            Mode::Slack => [holds(-self.lack(cable, after), Mode::Held), None],
            Mode::Held => [holds(kappa * tension, Mode::Slack), None],
            Mode::Pulled => [holds(slip, Mode::Sticks), None],
            Mode::Released => [holds(-slip, Mode::Sticks), None],
            Mode::Sticks => {
                let [before, incoming] = [now, after]
                    .map(|at| self.incoming((cable, place), at.tensions).unwrap_or_default());
                let turned = after.turns[p] - now.turns[p];
                // The bounds of eq. (1), linear as the step is.
                let bound = |sign: f64| {
                    let coefficient = sign * self.holes.coefficients[cable];
                    let factor = (coefficient * now.turns[p]).exp();
                    factor * (incoming + coefficient * before * turned)
                };
                [
                    holds(kappa * (tension - bound(-1.0)), Mode::Pulled),
                    holds(kappa * (bound(1.0) - tension), Mode::Released),
                ]
            }
        }
    }
}
