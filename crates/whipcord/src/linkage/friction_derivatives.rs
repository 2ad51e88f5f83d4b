//! Exact derivatives of an answer whose cables rub in their holes: [`super::derivatives`] with a tension for every passage, and with the
//! equations of the holes ([`crate::statics::friction`]).

use super::friction::{Rubbing, Turned};
use super::layout::Section;
use super::motion::Coordinates;
use super::plastic_derivatives::Asked;
use super::task::Task;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::contact::{self, Holding, Noted, NotedWay};
use crate::derivatives::{
    AnswerHoles, CoordinateCable, CoordinateDerivatives, Equations, KnownPlaces, ParameterChange,
    SolvedCoordinates, hole_source,
};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::solution::Solution;
use crate::statics::friction::{Carried, Carrying, History, HoleSource, Standing};
use crate::statics::loads::check as check_loads;
use crate::warm_start::WarmStart;

impl Linkage {
    /// The answer to the last step of a case, from the robot at rest on, with its derivatives.
    pub(super) fn solve_sliding_with_derivatives(
        &self,
        rubbing: &Rubbing,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        let asked = Asked::new(parameters, &self.stations);
        self.slide_with_derivatives(rubbing, (case, asked), workspace)
    }

    /// The same, with what is asked.
    pub(super) fn slide_with_derivatives(
        &self,
        rubbing: &Rubbing,
        (case, asked): (&Case, Asked<'_>),
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        case.check(&self.robot)?;
        workspace.forget();
        workspace.friction.history = History::with_trail();
        let mut carrying = Carrying::default();
        let solution = self.go_on(case, workspace)?;
        let steps: Vec<Case> = case.leading_steps().collect();
        let asked = (&steps[..], asked);
        let derivatives = self.differentiate_trail(rubbing, asked, &mut carrying, workspace)?;
        Ok((solution, derivatives))
    }

    /// The answers to all steps of a case in order, where cables or obstacles rub or the backbone has friction against bending; those that are asked for,
    /// by their number from 0, with their derivatives.
    pub(crate) fn solve_steps_with_derivatives(
        &self,
        case: &Case,
        parameters: &[Parameter],
        asks: impl Fn(usize) -> bool,
        workspace: &mut Workspace,
        mut each: impl FnMut((Solution, Option<CoordinateDerivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        if self.keeps_history() {
            let of = (case, parameters);
            return self.differentiate_in_steps(of, &self.stations, &asks, workspace, each);
        }
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        if !case.obstacles.is_empty() {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            check_loads(&self.robot, &case.loads).map_err(|error| (0, error.of(self.kind)))?;
            let of = (case, parameters);
            return self.rub_with_derivatives_among_obstacles(of, &asks, workspace, each);
        }
        let Some(rubbing) = &self.friction else {
            return contact::steps_alone(case, &asks, each, |step, asked| {
                self.alone((step, None), asked.then_some(parameters), workspace)
            });
        };
        workspace.forget();
        workspace.friction.history = History::with_trail();
        let mut carrying = Carrying::default();
        let steps: Vec<Case> = case.leading_steps().collect();
        for (n, step) in steps.iter().enumerate() {
            // The workspace remembers the steps before.
            workspace.friction.taken = 0;
            let solution = self.go_on(step, workspace).map_err(|error| (n, error))?;
            let asked = (&steps[..], Asked::new(parameters, &self.stations));
            let mut differentiate =
                || self.differentiate_trail(rubbing, asked, &mut carrying, workspace);
            let derivatives = asks(n).then(&mut differentiate).transpose();
            each((solution, derivatives.map_err(|error| (n, error))?));
        }
        Ok(())
    }

    /// The answer to a case whose first steps the workspace has taken.
    pub(super) fn go_on(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(self.kind);
        let status = self.solve_from_here(case, WarmStart::None, workspace, &mut solution)?;
        workspace.answered(status, solution)
    }

    /// The derivatives of the answer that the workspace is at, after some steps of a case.
    pub(super) fn differentiate_trail(
        &self,
        rubbing: &Rubbing,
        (steps, asked): (&[Case], Asked<'_>),
        carrying: &mut Carrying,
        workspace: &mut Workspace,
    ) -> Result<CoordinateDerivatives, SolveError> {
        let Some(trail) = workspace.friction.history.trail.take() else {
            return Err(SolveError::NoDerivatives);
        };
        let kept = asked.parameters.len() + rubbing.holes.of_cable.len();
        let found = carrying.go(&trail, kept, |end, carried, place| {
            let case = steps.get(place.step).ok_or(SolveError::NoDerivatives)?;
            if self.keeps_history() && place.step != asked.step {
                return Err(SolveError::NoDerivativesOfRest);
            }
            let at = End {
                shape: &end.shape,
                standing: &end.standing,
                carried,
                stations: if place.is_last { asked.stations } else { &[] },
                is_last: place.is_last,
                noted: None,
            };
            let (derivatives, carried) =
                self.differentiate_sliding((rubbing, &at), (case, asked), workspace)?;
            Ok((derivatives, Some(carried)))
        });
        workspace.friction.history.trail = Some(trail);
        found
    }

    /// The derivatives of the last equilibrium that was noted on the way to an answer among obstacles. Where joints keep something, `before` is
    /// the chain with what they held in the step of actuation before, and how that changes with each parameter.
    pub(super) fn differentiate_noted(
        &self,
        way: &NotedWay<Vec<Coordinates>>,
        (steps, asked): (&[Case], Asked<'_>),
        before: Option<&(Self, Vec<Vec<f64>>)>,
        carrying: &mut Carrying,
        workspace: &mut Workspace,
    ) -> Result<CoordinateDerivatives, SolveError> {
        let kept = asked.parameters.len() + self.robot.cables().len();
        let stands = workspace.scratch.chain.q.clone();
        let found = carrying.go(way, kept, |end, carried, place| {
            let noted = &end.shape;
            let (chain, asked) = match before {
                _ if !self.keeps_history() || noted.at.step == asked.step => (self, asked),
                Some((chain, history)) if noted.at.step + 1 == asked.step => {
                    (chain, Asked { step: noted.at.step, history, ..asked })
                }
                _ => return Err(SolveError::NoDerivativesOfRest),
            };
            let whole;
            let rubbing = match &chain.friction {
                Some(rubbing) => rubbing,
                None => {
                    whole = Rubbing::of(&chain.robot, &chain.division, &chain.sections);
                    &whole
                }
            };
            let cases = noted.cases(steps).ok_or(SolveError::NoDerivatives)?;
            let case = noted.case_by_fractions(&cases);
            chain.accept(&case, workspace)?;
            let at = End {
                shape: &noted.state,
                standing: &end.standing,
                carried,
                stations: if place.is_last { asked.stations } else { &noted.next },
                is_last: place.is_last,
                noted: Some((noted, &cases)),
            };
            let (derivatives, carried) =
                chain.differentiate_sliding((rubbing, &at), (&case, asked), workspace)?;
            // What the next equilibrium remembers is not known before that is.
            Ok((derivatives, (!place.is_last).then_some(carried)))
        });
        workspace.scratch.chain.q = stands;
        found.map(|mut derivatives| {
            derivatives.remember_change(way.was_between());
            derivatives
        })
    }

    /// The derivatives at an end, and what goes on to the next.
    fn differentiate_sliding(
        &self,
        (rubbing, end): (&Rubbing, &End<'_>),
        (case, asked): (&Case, Asked<'_>),
        workspace: &mut Workspace,
    ) -> Result<(CoordinateDerivatives, Vec<Carried>), SolveError> {
        let parameters = asked.parameters;
        let Rubbing { holes, sections, .. } = rubbing;
        let &End { shape, standing, carried, stations, is_last, noted } = end;
        let coordinates = self.division.coordinates() * sections.len();
        let disks = if is_last { &self.robot.disks().arc_lengths[..] } else { &[] };
        let touching = noted.map_or(&[][..], |(noted, _)| &noted.holding.places);
        let places = KnownPlaces::new(self.kind, coordinates, [stations, disks, touching])?;
        let Workspace { scratch, loads, meter, friction, .. } = workspace;
        let tensions = &standing.tensions;
        let task = Task { sections, ..self.task(loads, tensions, meter) };
        let chain = &mut scratch.chain;
        chain.q.clone_from(shape);
        let mut system = self.linear_system(&places.arc_lengths, &task, chain)?;
        if holes.rub() {
            friction.turned.measure(chain, &task, holes, &mut Vec::new());
            friction.turned.rows(&task, &mut system.lengths);
        }
        let mut changes = Vec::with_capacity(parameters.len());
        let mut sources = Vec::with_capacity(parameters.len());
        let is_length = |cable: usize| standing.commands[cable].is_length();
        let none = vec![0.0; holes.count()];
        for (p, parameter) in parameters.iter().enumerate() {
            if parameter.is_of_drives() {
                parameter.check(&self.robot, case)?;
                let source = |case: &Case| {
                    let cables = self.rest_lengths.iter().copied().enumerate();
                    let of = (&self.robot, case);
                    hole_source(parameter, of, holes, (cables, &none), is_length)
                };
                sources.push(match noted {
                    Some((noted, [before, now])) => {
                        source(now).between(&source(before), noted.at.commands)
                    }
                    None => source(case),
                });
                let mut change = ParameterChange::none(coordinates, 2 * holes.count());
                self.add_history(shape, asked.before(p), &mut change);
                changes.push(change);
                continue;
            }
            let mut change =
                self.by_parameter(parameter, case, shape, |sections, robot, case| {
                    self.sliding_equations((sections, robot, case), shape, tensions)
                })?;
            if let Some((noted, _)) = noted {
                change.scale(noted.part_of(parameter));
            }
            sources.push(source(&mut change, holes.count(), holes.of_cable.len(), is_length));
            self.add_history(shape, asked.before(p), &mut change);
            changes.push(change);
        }
        let cable = |(i, command): (usize, &_)| CoordinateCable {
            command: *command,
            is_taut: holes.rub() || standing.tensions[i] > 0.0,
            compliance: if holes.rub() {
                0.0
            } else {
                self.robot.cable_compliance(i, self.rest_lengths[i])
            },
        };
        let cables = standing.commands.iter().enumerate().map(cable);
        let solved = SolvedCoordinates {
            system,
            places,
            cables: cables.collect(),
            parameters: changes,
            length: self.robot.backbone().length,
            is_bending_about_to_change: self.is_joint_about_to_change(shape),
        };
        let holes = AnswerHoles {
            holes,
            standing,
            parameters: sources,
            carried,
            is_relative: false,
            commanded: noted.map_or([1.0; 2], |(noted, _)| noted.commanded()),
            is_last,
        };
        let no_contacts = Holding::default();
        let holding = noted.map_or(&no_contacts, |(noted, _)| &noted.holding);
        let change = holding.is_about_to_change;
        let gain = |compliance: &[f64]| holding.gain(compliance);
        let found = CoordinateDerivatives::of_sliding(solved, &holes, change, gain);
        if noted.is_none() {
            holes.holes.cable_lengths(&friction.scratch.at.lengths, &mut scratch.chain.lengths);
        }
        found
    }

    /// The equations of a robot with these sections. Their targets are `ℓ⁰/EA` and the lengths at rest of all passages, and of each
    /// cable the friction coefficient, the length that it is commanded where nothing pulls it, and the compliance outside the robot.
    fn sliding_equations(
        &self,
        (sections, robot, case): (&[Section], &Robot, &Case),
        q: &[Coordinates],
        tensions: &[f64],
    ) -> Equations {
        let kept = self.kept_angles(sections, q);
        let rubbing = Rubbing::of(robot, &self.division, sections);
        let Rubbing { holes, sections, rest, .. } = &rubbing;
        let (residuals, chain) = self.residuals(sections, robot, case, q, tensions);
        let meter = Default::default();
        let loads = Default::default();
        let task = Task { sections, ..self.task(&loads, tensions, &meter) };
        let mut turns = Vec::new();
        if holes.rub() {
            Turned::default().measure(&chain, &task, holes, &mut turns);
        }
        let mut whole = Vec::new();
        holes.cable_lengths(rest, &mut whole);
        let commanded = |(i, &rest): (usize, &f64)| {
            let shortening = case.commands[i].shortening.map_or(0.0, |s| s.in_metres(rest));
            rest - shortening - robot.cable_compliance(i, rest) * robot.pretension(i)
        };
        let commanded: Vec<f64> = whole.iter().enumerate().map(commanded).collect();
        let targets = [&holes.yielding, rest, &holes.coefficients, &commanded, &holes.outside];
        Equations {
            residuals,
            lengths: [&chain.lengths[..], &turns].concat(),
            targets: targets.map(|v| &v[..]).concat(),
            base: chain.base,
            kept,
        }
    }
}

/// An equilibrium whose derivatives are asked for.
struct End<'a> {
    shape: &'a Vec<Coordinates>,
    standing: &'a Standing,
    carried: Option<&'a [Carried]>,
    /// Arc lengths in m.
    stations: &'a [f64],
    is_last: bool,
    /// Among obstacles: with the cases before and at the end of its step.
    noted: Option<(&'a Noted<Vec<Coordinates>>, &'a [Case; 2])>,
}

/// What a parameter changes in the equations of the holes, of the targets of [`Linkage::sliding_equations`].
fn source(
    change: &mut ParameterChange,
    passages: usize,
    cables: usize,
    is_length: impl Fn(usize) -> bool,
) -> HoleSource {
    let mut yielding = core::mem::take(&mut change.targets);
    let mut rest = yielding.split_off(passages);
    let mut friction = rest.split_off(passages);
    let mut commands = friction.split_off(cables);
    let outside = commands.split_off(cables);
    let targets = commands.clone();
    for (cable, by) in commands.iter_mut().enumerate() {
        if !is_length(cable) {
            *by = 0.0;
        }
    }
    HoleSource { commands, targets, friction, yielding, rest, outside }
}
