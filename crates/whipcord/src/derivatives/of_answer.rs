//! From an answer, as the solver left it, to its derivatives.

use std::sync::Arc;

use whipcord_numerics::{Pose, UnitQuaternion, Vec3, magnus_6};

use super::along_step::Caused;
use super::cables::Cables;
use super::change::Places;
use super::column::{Raw, Source};
use super::elimination::Elimination;
use super::linear::Linear;
use super::partials::Partial;
use super::replay::{Answer, Varying};
use super::rod::{CableEnd, Derivatives, NoDerivatives};
use super::setting::{AtRest, Setting};
use super::sliding_holes::{AnswerHoles, Cause, SlidingHoles};
use super::spans::StraightSpan;
use super::step_ends::StepEnds;
use super::strands::Strands;
use super::tension_rates::DrivenCables;
use super::tip_rates::Driven;
use super::touching::{ContactGain, Remembered, Touching, gravity_change, motion};
use crate::case::{Case, Loads};
use crate::kinematics::OneSided;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::section::Strain;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::friction::{Carried, Holes, Standing};
use crate::statics::grid::Grid;
use crate::statics::hold::{Critical, HeldCables, Hold};
use crate::statics::loads::AppliedLoads;
use crate::statics::plastic_curvature::PlasticCurvature;

/// The answer that is differentiated, as the solver left it.
pub(crate) struct Solved<'a> {
    pub robot: &'a Robot,
    pub case: &'a Case,
    pub cables: Cables<'a>,
    pub grid: &'a Grid,
    pub loads: &'a AppliedLoads,
    pub commands: &'a [Command],
    pub tensions: &'a [f64],
    /// Which cables are taut.
    pub taut: &'a [bool],
    pub poses: &'a [Pose],
    pub base_wrench: Wrench,
    /// Moment, and force beyond that of the dead loads, in the base frame at the starts of steps where they are known.
    pub starts: &'a [Option<Wrench>],
    pub strains: &'a [Strain],
    /// Whether a shot from these starts has left these strains.
    pub are_strains_met: bool,
    /// How the plastic curvature that earlier steps of actuation left changes with each parameter; empty where it does not.
    pub history: &'a [PlasticCurvature],
    /// Nodes of the grid that are asked for beside the disks, where cables run straight between these.
    pub nodes: &'a [usize],
    /// Where cables rub, or the way to the answer counts.
    pub sliding: Option<SlidingAnswer<'a>>,
    /// Where cables rub, but the tensions of their strands are not those of an answer: nothing is held but these.
    pub open: Option<OpenStrands<'a>>,
}

/// Strands whose tensions are changed from outside.
#[derive(Clone, Copy)]
pub(crate) struct OpenStrands<'a> {
    pub strands: &'a Strands,
    /// Where cables rub all along their curves.
    pub varying: Option<Varying<'a>>,
}

/// The holes of an answer whose cables rub, and its strands, which are their passages.
pub(crate) struct SlidingAnswer<'a> {
    pub holes: &'a Holes,
    pub standing: &'a Standing,
    /// As [`AnswerHoles::carried`].
    pub carried: Option<&'a [Carried]>,
    pub strands: &'a Strands,
    /// Where cables rub all along their curves.
    pub varying: Option<Varying<'a>>,
    /// Of an equilibrium on the way to an answer among obstacles.
    pub on_way: Option<AnswerOnWay<'a>>,
}

/// An equilibrium on the way to an answer among obstacles.
pub(crate) struct AnswerOnWay<'a> {
    /// The cases before and at the end of its step.
    pub cases: &'a [Case; 2],
    /// How far it is from the commands of the former to those of the latter, and how much of the loads acts.
    pub commands: f64,
    pub loads: f64,
    /// As [`AnswerHoles::commanded`] and [`AnswerHoles::is_relative`].
    pub commanded: [f64; 2],
    pub is_relative: bool,
    pub contacts: AnswerContacts<'a>,
}

/// What the contacts of an answer push more when the robot moves.
pub(crate) struct AnswerContacts<'a> {
    /// The node of each.
    pub nodes: Vec<usize>,
    /// Of the compliance of the nodes under pushes, by rows with a force and a moment to a node.
    pub gain: &'a dyn Fn(&[f64]) -> Result<ContactGain, Critical>,
    pub are_about_to_change: bool,
}

impl Solved<'_> {
    /// As its commands are taken.
    pub(crate) fn driven(&self) -> Driven<'_> {
        let Cables { order, rest_lengths, .. } = self.cables;
        let Self { robot, commands, taut, .. } = *self;
        let cables = DrivenCables { robot, order, rest_lengths, commands, taut };
        Driven { cables, answer: self.answer() }
    }

    /// As it is gone over.
    pub(super) fn answer(&self) -> Answer<'_> {
        Answer {
            grid: self.grid,
            loads: self.loads,
            tensions: self.tensions,
            poses: self.poses,
            base_moment: self.base_wrench.moment,
            follower_force: self.loads.follower_share(self.base_wrench.force),
            starts: self.starts,
            strains: self.strains,
            are_strains_met: self.are_strains_met,
            varying: match (&self.sliding, &self.open) {
                (Some(sliding), _) => sliding.varying,
                (None, Some(open)) => open.varying,
                (None, None) => None,
            },
        }
    }
}

impl Derivatives {
    pub(crate) fn of(solved: &Solved<'_>, parameters: &[Parameter]) -> Result<Self, NoDerivatives> {
        let Solved { robot, case, cables: of_robot, grid, loads, tensions, .. } = *solved;
        let answer = solved.answer();
        let mut linear =
            Linear::of(&answer, of_robot.straight.map(|straight| (straight.spans, solved.nodes)))?;
        let rest = of_robot.straight.and_then(|straight| straight.rest);
        let rest = rest.map(|(grid, spans)| at_rest(grid, spans, tensions)).transpose()?;
        let poses = solved.poses;
        let strands = match (&solved.sliding, &solved.open) {
            (Some(sliding), _) => sliding.strands.clone(),
            (None, Some(open)) => open.strands.clone(),
            (None, None) => Strands::of_cables(of_robot.order.len()),
        };
        let on_way = solved.sliding.as_ref().and_then(|sliding| sliding.on_way.as_ref());
        let setting = Setting {
            of_loads: on_way.map_or(1.0, |on_way| on_way.loads),
            strands: &strands,
            commands: solved.commands,
            robot,
            case,
            cables: of_robot,
            grid,
            tensions,
            varying: answer.varying.map_or(&[], |varying| varying.tensions),
            poses,
            at_rest: rest.as_ref(),
        };
        let ends = robot
            .has_bending_friction()
            .then(|| StepEnds::new(&linear, &answer, grid))
            .transpose()?;
        let strains = ends.as_ref().map_or_else(Vec::new, |ends| ends.strains(&linear));
        let is_bending_about_to_change = grid.is_friction_at_limit(&strains);
        let partials = parameters
            .iter()
            .enumerate()
            .map(|(p, parameter)| {
                let history = (solved.history.get(p), ends.as_ref());
                Partial::new(&setting, &linear, parameter, history)
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(NoDerivatives::Parameter)?;
        let cables = of_robot.order.len();
        let per_step = linear.per_step();
        let forcing = |k: usize, i: usize, p: usize| partials[p].forcing(per_step * k + i);
        let holes =
            |p: usize, cable: usize, span: usize| partials[p].moved_holes(robot, cable, span);
        let mut maps = linear.maps(grid, (&strands, partials.len()), &forcing, &holes)?;
        let mut elimination = Elimination::default();
        elimination.eliminate(&mut maps, |step| {
            let node = linear.spans().map_or(step + 1, |spans| spans.far_disk(step));
            loads.follower_in_base(node, &poses[node])
        })?;
        let mut place_of = vec![0; cables];
        for (place, &cable) in of_robot.order.iter().enumerate() {
            place_of[cable] = place;
        }
        let mut derivatives = Self {
            places: Arc::new(Places {
                stations: grid.stations.clone(),
                disks: grid.disks.clone(),
                tip: grid.len(),
            }),
            steps: grid.steps.clone(),
            linear,
            maps,
            elimination,
            partials,
            place_of,
            commands: solved.commands.to_vec(),
            strands: strands.clone(),
            by_tension: Vec::new(),
            held: HeldCables::default(),
            sliding: None,
            cables: Vec::new(),
            touching: Touching::default(),
            moving_on: None,
            ends,
            length: robot.backbone().length,
            are_cables_about_to_change: false,
            is_bending_about_to_change,
        };
        let mut contact_gain = ContactGain::default();
        if let Some(AnswerOnWay { contacts, .. }) = on_way {
            let AnswerContacts { nodes, gain, are_about_to_change } = contacts;
            contact_gain = derivatives.touch(nodes.clone(), gain)?;
            derivatives.touching.is_about_to_change = *are_about_to_change;
        }
        derivatives.by_tension =
            (0..strands.count()).map(|strand| derivatives.raw(Source::Tension(strand))).collect();
        let end = |(place, &is_taut): (usize, &bool)| {
            let rest = of_robot.rest_lengths[place];
            let compliance = robot.cable_compliance(of_robot.order[place], rest);
            CableEnd { compliance, is_taut }
        };
        derivatives.cables = solved.taut.iter().enumerate().map(end).collect();
        match &solved.sliding {
            None if solved.open.is_some() => {}
            None => derivatives.hold()?,
            Some(sliding) => {
                let holes = sliding.holes;
                let source = |partial: &Partial| match on_way {
                    None => partial.hole_source(&setting, holes),
                    Some(AnswerOnWay { cases: [before, now], commands, .. }) => {
                        let of = |case| partial.hole_source(&Setting { case, ..setting }, holes);
                        of(now).between(&of(before), *commands)
                    }
                };
                let answer = AnswerHoles {
                    holes: sliding.holes,
                    standing: sliding.standing,
                    parameters: derivatives.partials.iter().map(source).collect(),
                    carried: sliding.carried,
                    is_relative: on_way.is_some_and(|on_way| on_way.is_relative),
                    commanded: on_way.map_or([1.0; 2], |on_way| on_way.commanded),
                    is_last: true,
                };
                let gravity = |parameter| gravity_change(parameter, case) * setting.of_loads;
                let gravity: Vec<Vec3> = parameters.iter().map(gravity).collect();
                derivatives.touching.remembered =
                    Remembered::new(&contact_gain, Some(&answer)).weighing(&contact_gain, &gravity);
                let by_tension = |strand: usize| &derivatives.by_tension[strand].lengths[..];
                derivatives.sliding = Some(Box::new(SlidingHoles::new(&answer, by_tension)?));
                if !strands.rub() {
                    derivatives.hold()?;
                    derivatives.held.settle(0.0);
                }
            }
        }
        let tip = derivatives.raw(Source::Wrench { node: grid.len(), component: 0 });
        let finite = derivatives.by_tension.iter().chain([&tip]).all(Raw::is_finite);
        if finite { Ok(derivatives) } else { Err(NoDerivatives::Critical) }
    }

    fn hold(&mut self) -> Result<(), NoDerivatives> {
        let cables = self.cables.len();
        let compliance = |place: usize| self.cables[place].compliance;
        let taut = |place: usize| self.cables[place].is_taut;
        let driven = |place: usize| matches!(self.commands[place], Command::Length { .. });
        let matrix = |i: usize, j: usize| self.by_tension[j].lengths[i];
        self.held = HeldCables::new(cables, matrix, compliance, taut, driven)?;
        Ok(())
    }
}

/// The rod at rest, bearing nothing.
fn at_rest<'a>(
    grid: &'a Grid,
    spans: &[StraightSpan<'_>],
    tensions: &[f64],
) -> Result<AtRest<'a>, NoDerivatives> {
    let mut pose = Pose::IDENTITY;
    let mut poses = vec![pose];
    for (k, step) in grid.steps.iter().enumerate() {
        let strain = |j: usize| grid.gauss.at(k, j, 0).0.section.rest_strain() * step.length;
        pose = pose * magnus_6(&[strain(0), strain(1), strain(2)]);
        poses.push(pose);
    }
    let mut loads = AppliedLoads::default();
    loads.gather(grid, &Loads::default(), UnitQuaternion::IDENTITY);
    let answer = Answer {
        grid,
        loads: &loads,
        tensions,
        poses: &poses,
        base_moment: Vec3::ZERO,
        follower_force: Vec3::ZERO,
        starts: &[],
        strains: &[],
        are_strains_met: false,
        varying: None,
    };
    Ok(AtRest { grid, linear: Linear::of(&answer, Some((spans, &[])))? })
}

impl Derivatives {
    /// The derivatives of an answer that touches obstacles at these nodes, from those of the robot alone under what pushes there.
    /// `gain` makes `K` of the compliance of the nodes, both by rows with a force and a moment to a node; gravity changes so with each
    /// parameter.
    pub(crate) fn touching(
        mut self,
        nodes: Vec<usize>,
        gain: impl FnOnce(&[f64]) -> Result<ContactGain, Critical>,
        gravity: &[Vec3],
        is_about_to_change: bool,
    ) -> Result<Self, NoDerivatives> {
        self.touching.is_about_to_change = is_about_to_change;
        if nodes.is_empty() {
            return Ok(self.settled());
        }
        let alone = (self.by_tension.iter().enumerate())
            .map(|(place, column)| column.lengths[place].abs())
            .fold(0.0, f64::max);
        let gain = self.touch(nodes, gain)?;
        self.touching.remembered = Remembered::default().weighing(&gain, gravity);
        let cables = self.place_of.len();
        self.by_tension = (0..cables).map(|place| self.raw(Source::Tension(place))).collect();
        self.hold()?;
        self.held.settle(alone);
        if self.by_tension.iter().all(Raw::is_finite) {
            Ok(self)
        } else {
            Err(NoDerivatives::Critical)
        }
    }

    /// The same, whose cables are taken as those of an answer ([`HeldCables::settle`]).
    pub(crate) fn settled(mut self) -> Self {
        self.held.settle(0.0);
        self
    }

    /// Notes which cables are about to go slack or to become taut in the answer.
    pub(crate) fn note_cables(&mut self, solution: &Solution) {
        let commands = self.place_of.iter().map(|&place| &self.commands[place]);
        self.are_cables_about_to_change = !self.strands.rub()
            && Command::are_about_to_change(commands, &solution.cables, self.length);
    }

    /// Whether a cable of given length is about to go slack or to become taut: the answer has one-sided derivatives there, and these are the
    /// derivatives of the side that the answer is on.
    #[must_use]
    pub const fn is_cable_about_to_change(&self) -> bool {
        self.are_cables_about_to_change
    }

    /// Whether friction against bending of a section is about to slide or to stick, as where a command is repeated: the answer has one-sided
    /// derivatives there, and these are the derivatives of the side that the answer is on.
    #[must_use]
    pub const fn is_bending_about_to_change(&self) -> bool {
        self.is_bending_about_to_change
    }

    /// What is about to change at the answer.
    #[must_use]
    pub fn one_sided(&self) -> OneSided {
        OneSided {
            contact: self.is_contact_about_to_change(),
            hole: self.is_hole_about_to_change(),
            cable: self.is_cable_about_to_change(),
            bending: self.is_bending_about_to_change(),
        }
    }

    /// As [`crate::Linearization::are_lengths_dependent`].
    #[must_use]
    pub fn are_lengths_dependent(&self, hold: Hold) -> bool {
        self.held.are_dependent(hold)
    }

    /// Adds contacts at these nodes to a robot that has none.
    fn touch(
        &mut self,
        nodes: Vec<usize>,
        gain: impl FnOnce(&[f64]) -> Result<ContactGain, Critical>,
    ) -> Result<ContactGain, Critical> {
        let sources = nodes.iter().flat_map(|&node| (0..6).map(move |i| (node, i)));
        let column = |(node, component)| self.raw(Source::Wrench { node, component });
        let columns: Vec<Raw> = sources.map(column).collect();
        let n = columns.len();
        let mut compliance = vec![0.0; n * n];
        for (j, column) in columns.iter().enumerate() {
            for (k, &node) in nodes.iter().enumerate() {
                for (a, moved) in motion(column, node).into_iter().enumerate() {
                    compliance[(6 * k + a) * n + j] = moved;
                }
            }
        }
        let found = gain(&compliance)?;
        let gain = found.by_motion.clone();
        self.touching = Touching { nodes, columns, gain, ..core::mem::take(&mut self.touching) };
        Ok(found)
    }

    /// The same with other stations, by their nodes.
    pub(crate) fn at_stations(mut self, nodes: Vec<usize>) -> Self {
        Arc::make_mut(&mut self.places).stations = nodes;
        self
    }

    /// The same, where loads at a place and tensions below the base are added to the robot as it stands, which moves on with these.
    pub(crate) fn moving_on(self, on: Self) -> Self {
        Self { moving_on: Some(Box::new(on)), ..self }
    }

    /// Notes whether a contact was between two cases on the way, of which something is remembered.
    pub(crate) const fn remember_change(&mut self, was_between: bool) {
        self.touching.is_about_to_change |= was_between;
    }

    /// How the state that the holes remember changes, as [`AnswerHoles::carried`] has it.
    pub(crate) fn carried(&self) -> Vec<Carried> {
        let Some(sliding) = &self.sliding else { return Vec::new() };
        sliding.carried(|cause| match cause {
            Cause::Parameter(p) => {
                let mut raw = self.raw(Source::Parameter(p));
                self.touching.remember(&mut raw, cause);
                raw.lengths
            }
            _ => self.remembered(cause).lengths,
        })
    }

    /// The same, with how the places that touch next move, as `places` tells it of what each cause changes, and the objects; `None`
    /// where it does not tell.
    pub(crate) fn carried_with_places(
        &self,
        places: impl Fn(&Caused<'_>) -> Option<Vec<f64>>,
    ) -> Option<Vec<Carried>> {
        let Some(sliding) = &self.sliding else { return Some(Vec::new()) };
        let mut carried = self.carried();
        for (cause, carried) in sliding.causes().zip(&mut carried) {
            let caused = self.caused(cause);
            carried.places = places(&caused)?;
            carried.places.extend(self.touching.of_objects(&caused.changed));
        }
        Some(carried)
    }

    /// Whether a cable with friction is about to slide in a hole where it sticks, or has only begun to slide: the answer has one-sided derivatives
    /// there, and these are the derivatives of the case that the answer is in.
    #[must_use]
    pub fn is_hole_about_to_change(&self) -> bool {
        self.sliding.as_ref().is_some_and(|sliding| sliding.held.is_about_to_change())
    }

    /// Whether a contact of the answer is about to open or to close, to stick or to slide: it has one-sided derivatives there, and these are the
    /// derivatives of the side that the answer is on.
    #[must_use]
    pub const fn is_contact_about_to_change(&self) -> bool {
        self.touching.is_about_to_change
    }
}
