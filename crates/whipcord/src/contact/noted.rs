//! The equilibria on the way to an answer among obstacles whose cables rub: what derivatives take of them.

use super::holding::Holding;
use super::model::OnWay;
use crate::case::{CableCommand, Case, Shortening};
use crate::parameter::Parameter;
use crate::statics::friction::{HoleSource, Standing, SubstepEnd, Trail};

/// An equilibrium on the way.
#[derive(Clone, Debug)]
pub(crate) struct Noted<S> {
    /// Where the model stands.
    pub state: S,
    /// With what its contacts push among the loads.
    pub case: Case,
    pub holding: Holding,
    pub at: OnWay,
    /// Arc lengths in m of the cross-sections whose places the next equilibrium remembers.
    pub next: Vec<f64>,
}

/// The equilibria on the way, from the last that hangs on none before it.
pub(crate) type NotedWay<S> = Trail<Noted<S>>;

impl<S> NotedWay<S> {
    /// Takes note of an equilibrium whose cables stand so in their holes, in place of the last note where that is of the same place of the way.
    pub fn note(&mut self, standing: Standing, noted: Noted<S>) {
        if self.ends.last().is_some_and(|last| last.shape.at == noted.at) {
            self.ends.pop();
        }
        self.steps.retain(|&first| first < self.ends.len());
        let remembered: Vec<f64> = noted.holding.remembered().collect();
        if remembered.is_empty() && !standing.sticks() {
            *self = Self::default();
        }
        match self.ends.last_mut() {
            Some(last) => {
                last.shape.next = remembered;
                if last.shape.at.step != noted.at.step {
                    self.steps.push(self.ends.len());
                }
            }
            None => self.steps.push(0),
        }
        self.ends.push(SubstepEnd { shape: noted, standing, stops: None });
    }
}

impl<S> Noted<S> {
    /// How far a command that is changed by as much in all steps is changed here, and one of this step alone.
    pub fn commanded(&self) -> [f64; 2] {
        let part = self.at.commands;
        [if self.at.step == 0 { part } else { 1.0 }, part]
    }

    /// How much of a change with a parameter of the whole case there is here.
    pub const fn part_of(&self, parameter: &Parameter) -> f64 {
        // The weight of a mass is less where gravity is.
        let is_scaled = parameter.is_load() && !matches!(parameter, Parameter::PointMass { .. });
        if is_scaled { self.at.loads } else { 1.0 }
    }

    /// The case before the step, whose cables are as they are at rest before the first, and that of the step.
    pub fn cases(&self, steps: &[Case]) -> Option<[Case; 2]> {
        let now = steps.get(self.at.step)?.clone();
        let before = match self.at.step.checked_sub(1) {
            Some(before) => steps.get(before)?.clone(),
            None => {
                let rest = |command: &CableCommand| CableCommand {
                    tension: command.tension.map(|_| 0.0),
                    shortening: command.shortening.map(|_| Shortening::Fraction(0.0)),
                };
                let commands = now.commands.iter().map(rest).collect();
                Case { commands, motors: Vec::new(), ..now.clone() }
            }
        };
        Some([before, now])
    }

    /// Its case, with the commands that are fractions of the lengths of cables as such.
    pub fn case_by_fractions(&self, [before, now]: &[Case; 2]) -> Case {
        let mut case = self.case.clone();
        let pairs = before.commands.iter().zip(&now.commands);
        for (command, (before, now)) in case.commands.iter_mut().zip(pairs) {
            if let (Some(Shortening::Fraction(from)), Some(Shortening::Fraction(to))) =
                (before.shortening, now.shortening)
            {
                let part = from + self.at.commands * (to - from);
                command.shortening = Some(Shortening::Fraction(part));
            }
        }
        case
    }

    /// What a parameter changes of the holes here, of what it changes before the step and at its end.
    pub fn between(&self, before: &HoleSource, now: HoleSource) -> HoleSource {
        let mut source = now;
        for (command, before) in source.commands.iter_mut().zip(&before.commands) {
            *command = before + self.at.commands * (*command - before);
        }
        source
    }
}
