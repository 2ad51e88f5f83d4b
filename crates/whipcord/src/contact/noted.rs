//! The equilibria on the way to an answer among obstacles, where these or the cables rub: what derivatives take of them.

use whipcord_numerics::{Twist, Vec3};

use super::dense_output::DenseOutput;
use super::holding::Holding;
use super::model::Compliant;
use crate::case::{CableCommand, Case, Shortening};
use crate::derivatives::{AnswerContacts, AnswerOnWay, Caused, ContactGain, Derivatives};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::solution::Solution;
use crate::statics::friction::{Carried, Standing, SubstepEnd, Trail};
use crate::statics::hold::Critical;
use crate::statics::plastic_curvature::PlasticCurvature;

/// A place of the way to the answers to the steps of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OnWay {
    /// Number of the step, from 0.
    pub step: usize,
    /// How far the commands went from those of the step before to those of the step.
    pub commands: f64,
    /// The part of the loads that acts.
    pub loads: f64,
    /// The part of the way on which a robot is inserted, and of that to the answer.
    pub way: [f64; 2],
    /// Whether objects that were held on the way have been released.
    pub is_released: bool,
}

/// A model that can take note of the equilibria on the way.
pub(crate) trait Noting: Compliant {
    /// Whether it takes note of the equilibria on the way, so that their derivatives are carried along.
    fn takes_notes(&self) -> bool {
        false
    }

    /// Takes note of an equilibrium that was found and is not kept yet, with its contacts; in place of the last note where that is of the
    /// same place of the way.
    fn note(&mut self, _holding: Holding, _at: OnWay) {}

    /// The way begins anew, at rest.
    fn forget_notes(&mut self) {}

    /// What was noted does not lead to where it is: it has jumped, or was found in another way.
    fn lose_notes(&mut self) {}
}

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

/// An answer, where it was asked for with its derivatives, and whether anything had touched on the way to it.
pub(crate) type Found<D> = ((Solution, Option<D>), bool);

/// Derivatives where they were asked for. Where nothing has touched, the answer without obstacles counts, and these need not exist.
pub(crate) fn where_it_counts<D>(
    derivatives: Option<Result<D, SolveError>>,
    has_touched: bool,
) -> Result<Option<D>, SolveError> {
    match derivatives {
        Some(Err(_)) if !has_touched => Ok(None),
        derivatives => derivatives.transpose(),
    }
}

/// The last answer of a solve of several steps, with its derivatives.
pub(crate) fn last_with_derivatives<D>(
    case: &Case,
    solve: impl FnOnce(
        &dyn Fn(usize) -> bool,
        &mut dyn FnMut((Solution, Option<D>)),
    ) -> Result<(), (usize, SolveError)>,
) -> Result<(Solution, D), SolveError> {
    let last = case.leading_steps().count() - 1;
    let mut found = None;
    solve(&|step| step == last, &mut |answer| found = Some(answer)).map_err(|(_, error)| error)?;
    match found {
        Some((solution, Some(derivatives))) => Ok((solution, derivatives)),
        _ => Err(SolveError::NoDerivativesOfRest),
    }
}

/// One of them, as it is differentiated.
#[derive(Debug)]
pub(crate) struct NotedEnd<'a, S> {
    pub noted: &'a Noted<S>,
    pub standing: &'a Standing,
    /// Where the model stood before, where that is noted.
    pub before: Option<&'a S>,
    /// As the holes of an answer have it.
    pub carried: Option<&'a [Carried]>,
    /// How the plastic curvature that the steps before left changes with each parameter; empty where it does not.
    pub history: &'a [PlasticCurvature],
    /// Those before and at the end of its step, and its own.
    pub cases: &'a [Case; 2],
    pub case: &'a Case,
    /// Arc lengths in m.
    pub stations: &'a [f64],
    pub is_last: bool,
}

impl<S> NotedEnd<'_, S> {
    /// As the derivatives of a rod take it, whose nodes are these by their arc lengths; `gain` is that of the contacts.
    pub fn on_way<'a>(
        &'a self,
        node: impl Fn(f64) -> usize,
        gain: &'a dyn Fn(&[f64]) -> Result<ContactGain, Critical>,
    ) -> AnswerOnWay<'a> {
        let Noted { holding, at, .. } = self.noted;
        AnswerOnWay {
            cases: self.cases,
            commands: at.commands,
            loads: at.loads,
            commanded: self.noted.commanded(),
            is_relative: true,
            contacts: AnswerContacts {
                nodes: holding.places.iter().map(|&s| node(s)).collect(),
                gain,
                are_about_to_change: holding.is_about_to_change,
            },
        }
    }

    /// Of the derivatives there, of a rod of this shape: those at its stations, whose nodes `node` tells, where it is the last; else what goes
    /// on to the next, which is not known before that is.
    pub fn found(
        &self,
        derivatives: Derivatives,
        shape: &DenseOutput,
        node: impl Fn(f64) -> usize,
    ) -> Result<(Derivatives, Option<Vec<Carried>>), SolveError> {
        if self.is_last {
            let nodes = self.stations.iter().map(|&s| node(s)).collect();
            return Ok((derivatives.at_stations(nodes), None));
        }
        let places = |caused: &Caused<'_>| {
            let mut motions = Vec::with_capacity(6 * self.stations.len());
            for &s in self.stations {
                let Twist { linear, angular } = shape.motion(s, caused)?;
                motions.extend([linear, angular].map(Vec3::to_array).concat());
            }
            Some(motions)
        };
        let carried = derivatives.carried_with_places(places).ok_or(SolveError::NoDerivatives)?;
        Ok((derivatives, Some(carried)))
    }
}

/// The equilibria on the way, from the last that hangs on none before it.
pub(crate) type NotedWay<S> = Trail<Noted<S>>;

impl<S> NotedWay<S> {
    /// Whether a contact was between two cases at any of them: what is remembered of it has one-sided derivatives.
    pub fn was_between(&self) -> bool {
        self.ends.iter().any(|end| end.shape.holding.is_between)
    }

    /// Takes note of an equilibrium whose cables stand so in their holes, in place of the last note where that is of the same place of the way.
    pub fn note(&mut self, standing: Standing, noted: Noted<S>) {
        if self.ends.last().is_some_and(|last| last.shape.at == noted.at) {
            self.ends.pop();
        }
        self.steps.retain(|&first| first < self.ends.len());
        let remembered: Vec<f64> = noted.holding.remembered().collect();
        if !noted.holding.depends_on_before() && !standing.sticks() {
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
        if parameter.grows_with_loads() { self.at.loads } else { 1.0 }
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
}
