//! The friction of the cables of a robot whose motion is computed elsewhere, step by step in time.
//!
//! A time step is the substep of eq. (2) of `docs/theory/hole-friction.md`: each hole satisfies it from where the step before ended.

use super::condensed_holes::CondensedHoles;
use super::holes::Holes;
use super::law::Row;
use super::response::{Passages, Response};
use crate::robot::Robot;
use crate::solution::SlipState;
use crate::statics::command::Command;

/// The cables of a robot in its holes: the tensions of all passages, each the piece of a cable from one hole to the next, for a motion in time steps.
#[derive(Clone, Debug)]
pub struct HoleFriction {
    holes: Holes,
    commands: Vec<Command>,
    state: CondensedHoles,
    /// How far the holes were from a change of their cases at the end of the last step, in relative terms.
    margin: f64,
}

/// The linearised equation of the near hole of a passage in the case that holds there: the changes of tensions `T`, of the length beyond the hole or of the angle
/// `φ` in it, less those of the length before the step and of the command, with these factors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HoleEquation {
    /// Passages with what their tensions are multiplied by.
    pub tensions: Vec<(usize, f64)>,
    /// Whether it contains the length of the passage and of those behind it on the cable: where the cable does not slide.
    pub keeps_length: bool,
    /// What the angle in the hole is multiplied by, in N/rad.
    pub by_turn: f64,
    /// What the change of the length beyond the hole before the step is multiplied by.
    pub by_before: f64,
    /// What the change of the command of the cable is multiplied by: of its tension in N, or of the unstretched length in m that the drive leaves.
    pub by_command: f64,
}

/// How lengths in m and angles in rad of all passages respond.
#[derive(Clone, Copy, Debug, Default)]
pub struct HoleResponse<'a> {
    /// For each passage a row with one column for the tension of each passage and a last one for what changes while the tensions stay.
    pub lengths: &'a [f64],
    /// The same of the angle in its near hole.
    pub turns: &'a [f64],
    /// For each of other forces the changes of all lengths by 1 N.
    pub lengths_by_force: &'a [f64],
    /// The same of all angles.
    pub turns_by_force: &'a [f64],
}

/// What the holes remember from step to step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HoleMemory {
    /// Tension of each passage in N.
    pub tensions: Vec<f64>,
    /// Length in m of the unstretched cable beyond the near hole of each passage.
    pub beyond: Vec<f64>,
    /// How the cable stands in the near hole of each passage.
    pub slip_states: Vec<SlipState>,
    /// Tension of each cable in N below the base.
    pub base: Vec<f64>,
}

impl HoleFriction {
    /// Of the passages of a robot, those of each cable from the base on: the cable of each and its length in m on the robot at rest. `compliance` is by how much in m a
    /// tension of 1 N shortens a cable, as an order of magnitude.
    #[must_use]
    pub fn new(robot: &Robot, passages: &[(usize, f64)], compliance: f64) -> Self {
        let holes =
            Holes::new(robot, passages.iter().copied(), robot.backbone().length, compliance);
        let commands = vec![Command::Tension(0.0); robot.cables().len()];
        let mut state = CondensedHoles::default();
        state.reset(&holes);
        Self { holes, commands, state, margin: f64::INFINITY }
    }

    /// The same where these cables have a further passage each, behind all others in number: from a drive whose motion is computed elsewhere to the hole in the base. It has no length and
    /// does not stretch, and its tension is that at the drive.
    #[must_use]
    pub fn with_drives(mut self, cables: &[usize]) -> Self {
        for (&cable, p) in cables.iter().zip(self.holes.count()..) {
            let passages = &mut self.holes.of_cable[cable];
            self.holes.yielding.push(0.0);
            self.holes.at_rest.push(passages.first().map_or(0.0, |&of| self.holes.at_rest[of]));
            passages.insert(0, p);
        }
        self.holes.drives.outside = cables.to_vec();
        self.state.reset(&self.holes);
        self
    }

    /// Has the drives of [`Self::with_drives`] yield to the tensions there: pairs of cables with by how much in m a tension of 1 N at the drive of the second lengthens the first.
    pub fn set_yields(&mut self, yields: impl Iterator<Item = (usize, usize, f64)>) {
        self.holes.drives.yields.clear();
        self.holes.drives.yields.extend(yields);
    }

    /// Commands a cable by its tension in N.
    pub fn command_tension(&mut self, cable: usize, tension: f64) {
        self.commands[cable] = Command::Tension(tension);
    }

    /// Commands a cable by the unstretched length in m that its drive leaves for the robot.
    pub fn command_length(&mut self, cable: usize, target: f64) {
        let compliance = self.holes.outside[cable];
        self.commands[cable] = Command::Length { target, compliance };
    }

    /// Tension of each passage in N.
    #[must_use]
    pub fn tensions(&self) -> &[f64] {
        self.state.tensions()
    }

    /// What the holes remember.
    #[must_use]
    pub fn memory(&self) -> HoleMemory {
        let history = self.state.history();
        HoleMemory {
            tensions: history.tensions.clone(),
            beyond: history.beyond.clone(),
            slip_states: history.slip_states.clone(),
            base: history.base.clone(),
        }
    }

    /// What the holes remember of a robot at these lengths in m and tensions in N of the passages, with these tensions below the base.
    #[must_use]
    pub fn memory_at(&self, lengths: &[f64], tensions: Vec<f64>, base: Vec<f64>) -> HoleMemory {
        let beyond = self.holes.beyond(lengths, &tensions);
        let slip_states = vec![SlipState::Sticks; tensions.len()];
        HoleMemory { tensions, beyond, slip_states, base }
    }

    /// Goes back to what the holes remembered at the start of a step.
    pub fn go_back_to(&mut self, memory: &HoleMemory) {
        let HoleMemory { tensions, beyond, slip_states, base } = memory.clone();
        self.state.carry(tensions, beyond, slip_states);
        self.state.set_base(base);
    }

    /// The passages whose pieces of cable stay in them however the robot moves a little, each with how far it gives in m/N, at these angles in rad in the near holes of all passages
    /// and the tensions that are remembered. `None` where a cable slides in a hole or is about to: its tensions then change with the angles, on one side alone.
    #[must_use]
    pub fn locked(&self, turns: &[f64]) -> Option<Vec<(usize, f64)>> {
        let mut locked = Vec::new();
        let lock = |passage: usize, yielding: f64| locked.push((passage, yielding));
        self.holes.lock(&self.commands, turns, self.state.history(), lock).ok()?;
        Some(locked)
    }

    /// Takes over lengths in m and angles in rad of the passages, where the cables turn in the near holes of these: what the equations of the holes leave, as a part of the
    /// length of the robot.
    pub fn assess(&mut self, lengths: &[f64], turns: &[f64]) -> f64 {
        let at = self.state.at_mut();
        at.lengths.clear();
        at.lengths.extend_from_slice(lengths);
        at.turns.clear();
        at.turns.extend_from_slice(turns);
        self.state.assess(&self.holes, &self.commands)
    }

    /// How the tensions change in a step of Newton's method, by the response of lengths and angles: for each passage a row with one column for the tension of each passage
    /// and a last one for what changes while the tensions stay. `None` where the equations of the holes are singular.
    pub fn changes(&mut self, lengths: &[f64], turns: &[f64]) -> Option<&[f64]> {
        let response = HoleResponse { lengths, turns, ..HoleResponse::default() };
        self.changes_with_forces(response, &[])?.first().map(Vec::as_slice)
    }

    /// The same where other forces change as well, by these amounts: how the tensions change with them, then how that changes with each of the forces, in the cases of the holes that
    /// hold then.
    pub fn changes_with_forces(
        &mut self,
        response: HoleResponse<'_>,
        forces: &[f64],
    ) -> Option<&[Vec<f64>]> {
        let count = self.holes.count();
        let fill = |into: &mut Response, by_force: &mut Vec<Passages>| {
            into.lengths.clear();
            into.lengths.extend_from_slice(response.lengths);
            into.turns.clear();
            into.turns.extend_from_slice(response.turns);
            by_force.resize_with(forces.len(), Passages::default);
            let lists = response.lengths_by_force.chunks_exact(count);
            let lists = lists.zip(response.turns_by_force.chunks_exact(count));
            for (out, (lengths, turns)) in by_force.iter_mut().zip(lists) {
                out.lengths.clear();
                out.lengths.extend_from_slice(lengths);
                out.turns.clear();
                out.turns.extend_from_slice(turns);
            }
        };
        self.state.linearise_about(&self.holes, &self.commands, forces, fill)?;
        Some(self.state.columns())
    }

    /// Changes the tensions.
    pub fn advance(&mut self, changes: &[f64]) {
        self.state.advance(changes, 1.0);
    }

    /// How far the holes were from another case of their equations at the end of the last step: the least slip where a cable slides and slack where it is slack, as parts of the
    /// length of the robot, and the least distance of a tension from its bounds as a part of it. Derivatives where this is about zero are those of one side.
    #[must_use]
    pub const fn margin(&self) -> f64 {
        self.margin
    }

    /// How far in m a tension of 1 N stretches the piece of cable in each passage.
    #[must_use]
    pub fn yielding(&self) -> &[f64] {
        &self.holes.yielding
    }

    /// The linearised equations of all holes, by passage, in the cases that hold at the state that was assessed last.
    #[must_use]
    pub fn equations(&self) -> Vec<HoleEquation> {
        let kappa = self.holes.compliance;
        let mut equations = vec![HoleEquation::default(); self.holes.count()];
        for ((cable, place), p) in self.holes.all() {
            let passages = &self.holes.of_cable[cable];
            let out = &mut equations[p];
            match self.state.row(&self.holes, &self.commands, (cable, place)) {
                (Row::Slack, _) => out.tensions.push((p, kappa)),
                (Row::Held, is_commanded) => {
                    out.keeps_length = true;
                    let stretch = |&k: &usize| (k, -self.holes.yielding[k]);
                    out.tensions.extend(passages[place..].iter().map(stretch));
                    if is_commanded {
                        out.tensions[0].1 -= self.holes.outside[cable];
                        out.tensions.extend(self.holes.yielded(cable).map(|(k, by)| (k, -by)));
                        out.by_command = 1.0;
                    } else {
                        out.by_before = 1.0;
                    }
                }
                (Row::Slides { factor, by_turn, incoming }, _) => {
                    out.tensions.push((p, kappa));
                    match place.checked_sub(1) {
                        Some(before) => out.tensions.push((passages[before], -kappa * factor)),
                        None => out.by_command = kappa * factor,
                    }
                    out.by_turn = -kappa * by_turn * incoming;
                }
            }
        }
        equations
    }

    /// Ends a step at the state that was assessed last: what the holes remember then, and the work in J that friction has taken of each cable.
    pub fn end_step(&mut self) -> (HoleMemory, Vec<f64>) {
        let before = self.state.history().beyond.clone();
        self.margin = self.state.margin(&self.holes, &self.commands);
        self.state.keep(&self.holes, &self.commands);
        let memory = self.memory();
        let mut lost = vec![0.0; self.commands.len()];
        for ((cable, place), p) in self.holes.all() {
            let near = match place {
                0 => memory.base[cable],
                _ => memory.tensions[self.holes.of_cable[cable][place - 1]],
            };
            lost[cable] += (near - memory.tensions[p]) * (before[p] - memory.beyond[p]);
        }
        (memory, lost)
    }
}
