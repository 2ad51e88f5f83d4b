//! The holes of a robot among obstacles: the tensions of all passages while the forces of contacts change.
//!
//! The steps on the way to an equilibrium in contact are the substeps here: each of them satisfies eq. (2) from where the last one
//! ended. The tensions are further unknowns of the same Newton's method, which an iteration eliminates: what remains is the response
//! of the robot and its cables to the wrenches.

use whipcord_numerics::DenseLu;

use super::holes::{History, Holes};
use super::law::{Iterate, Law, Row};
use super::linear_problem::right_side;
use super::modes::Mode;
use super::newton::FrictionScratch;
use super::response::{Passages, Response};
use super::trail::Standing;
use super::way::SLIDES;
use crate::solution::SlipState;
use crate::statics::command::Command;

/// What the holes leave counts so many times as much as what contacts do: tensions are to be known more nearly.
const EXACT: f64 = 30.0;

/// The state of the holes, and of the last equilibrium.
#[derive(Clone, Debug, Default)]
pub(crate) struct CondensedHoles {
    scratch: FrictionScratch,
    history: History<()>,
    /// Whether the state was assessed since the last equilibrium.
    is_assessed: bool,
    /// How lengths and angles change with each component of the wrenches.
    by_wrench: Vec<Passages>,
    /// How the tensions change with these, after the step that is left.
    columns: Vec<Vec<f64>>,
    lu: DenseLu,
}

impl CondensedHoles {
    /// The robot at rest.
    pub fn reset(&mut self, holes: &Holes) {
        self.history = History::at_rest(holes);
        self.scratch.tensions.clone_from(&self.history.tensions);
        self.is_assessed = false;
    }

    /// The same state with other passages: their tensions, the lengths beyond their near holes at the last equilibrium and how they
    /// slid to it.
    pub fn carry(&mut self, tensions: Vec<f64>, beyond: Vec<f64>, slip_states: Vec<SlipState>) {
        self.scratch.tensions.clone_from(&tensions);
        (self.history.tensions, self.history.beyond) = (tensions, beyond);
        self.history.slip_states = slip_states;
    }

    /// The same for the tension of every cable below the base.
    pub fn set_base(&mut self, base: Vec<f64>) {
        self.history.base = base;
    }

    /// Tension of every passage in N.
    pub fn tensions(&self) -> &[f64] {
        &self.scratch.tensions
    }

    /// Tension of every cable below the base at the last equilibrium.
    pub fn at_base(&self) -> &[f64] {
        &self.history.base
    }

    /// Lengths and angles of all passages at the state of the robot, to be filled.
    pub const fn at_mut(&mut self) -> &mut Passages {
        &mut self.scratch.at
    }

    /// The last equilibrium, where its slip is that of the last step.
    pub const fn history(&self) -> &History<()> {
        &self.history
    }

    pub fn lengths(&self) -> &[f64] {
        &self.scratch.at.lengths
    }

    /// What the equations of the holes leave, as a fraction of the length, times [`EXACT`].
    pub fn assess(&mut self, holes: &Holes, commands: &[Command]) -> f64 {
        self.is_assessed = true;
        let before = &self.history.beyond;
        EXACT * self.scratch.assess(&Law { holes, commands, before, modes: None })
    }

    /// Eliminates the tensions: from the response of lengths and angles to them and to closing the equilibrium, and to each component of the wrenches.
    /// `None` where the equations of the holes are singular.
    pub fn linearise(
        &mut self,
        holes: &Holes,
        commands: &[Command],
        fill: impl FnOnce(&mut Response, &mut Vec<Passages>),
    ) -> Option<()> {
        self.linearise_about(holes, commands, &[], fill)
    }

    /// The same about changes of the wrenches, in cases that agree with them: the step that is left is then that with these changes.
    pub fn linearise_about(
        &mut self,
        holes: &Holes,
        commands: &[Command],
        wrenches: &[f64],
        fill: impl FnOnce(&mut Response, &mut Vec<Passages>),
    ) -> Option<()> {
        fill(&mut self.scratch.response, &mut self.by_wrench);
        self.add_wrenches(wrenches);
        let Self { scratch, history, by_wrench, columns, lu, .. } = self;
        let law = Law { holes, commands, before: &history.beyond, modes: None };
        scratch.solve(&law, None)?;
        let FrictionScratch { tensions, at, beyond, modes, problem, changes, .. } = &*scratch;
        lu.factor(tensions.len(), problem.matrix()).ok()?;
        columns.resize_with(1 + by_wrench.len(), Vec::new);
        columns[0].clone_from(changes);
        let here = Iterate { tensions, beyond, turns: &at.turns };
        for (column, by) in columns[1..].iter_mut().zip(&*by_wrench) {
            column.resize(tensions.len(), 0.0);
            right_side(&law, here, modes, (&by.lengths, &by.turns), column);
            lu.solve(column);
        }
        columns.iter().flatten().all(|x| x.is_finite()).then_some(())
    }

    /// Adds what changes of the wrenches do to the response.
    fn add_wrenches(&mut self, changes: &[f64]) {
        let Self { scratch, by_wrench, .. } = self;
        let n = scratch.tensions.len();
        let response = &mut scratch.response;
        for (by, change) in by_wrench.iter().zip(changes) {
            let rows = response.lengths.chunks_exact_mut(n + 1).zip(&by.lengths);
            let rows = rows.chain(response.turns.chunks_exact_mut(n + 1).zip(&by.turns));
            rows.for_each(|(row, by)| row[n] += by * change);
        }
    }

    /// The equation of a hole in the case that holds at the state that was assessed last, and whether what it keeps is the commanded length.
    pub(super) fn row(
        &self,
        holes: &Holes,
        commands: &[Command],
        hole: (usize, usize),
    ) -> (Row, bool) {
        let FrictionScratch { tensions, at, beyond, modes, .. } = &self.scratch;
        let mode = modes[holes.of_cable[hole.0][hole.1]];
        let law = Law { holes, commands, before: &self.history.beyond, modes: None };
        let here = Iterate { tensions, beyond, turns: &at.turns };
        (law.row(hole, mode, here).0, mode == Mode::Held)
    }

    /// How far the holes are from another case of eq. (2) at the state that was assessed last: the least of all, each in relative terms.
    pub fn margin(&self, holes: &Holes, commands: &[Command]) -> f64 {
        let FrictionScratch { tensions, at, beyond, modes, .. } = &self.scratch;
        let law = Law { holes, commands, before: &self.history.beyond, modes: None };
        let here = Iterate { tensions, beyond, turns: &at.turns };
        let margins = holes.all().map(|(hole, p)| law.margin(hole, modes[p], here));
        margins.fold(f64::INFINITY, f64::min)
    }

    /// Whether the equations of the holes, as they were linearised last, change an odd number of directions from stable to unstable.
    pub fn is_odd(&self) -> bool {
        // Where the length beyond a hole is given, it falls with the tension.
        let is_held = |mode: &&Mode| matches!(mode, Mode::Held | Mode::Sticks);
        let held = self.scratch.modes.iter().filter(is_held).count();
        self.lu.is_determinant_negative() != (held % 2 == 1)
    }

    /// How the tensions change with the step that is left, then with each component of the wrenches.
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// How the tensions change with the step that is left and these changes of the wrenches together, in cases of the holes that agree with it.
    pub fn follow(&mut self, holes: &Holes, commands: &[Command], changes: &[f64]) -> Vec<f64> {
        self.add_wrenches(changes);
        let Self { scratch, history, columns, .. } = self;
        let law = Law { holes, commands, before: &history.beyond, modes: None };
        if scratch.solve(&law, None).is_some() {
            return scratch.changes.clone();
        }
        let mut sum = columns[0].clone();
        for (column, change) in columns[1..].iter().zip(changes) {
            sum.iter_mut().zip(column).for_each(|(sum, by)| *sum += change * by);
        }
        sum
    }

    /// Takes a part of a change of the tensions.
    pub fn advance(&mut self, changes: &[f64], part: f64) {
        for (tension, change) in self.scratch.tensions.iter_mut().zip(changes) {
            *tension = (*tension + part * change).max(0.0);
        }
    }

    /// Takes the state, which is in equilibrium, for the one that the next step starts from.
    pub fn keep(&mut self, holes: &Holes, commands: &[Command]) {
        if core::mem::take(&mut self.is_assessed) {
            let FrictionScratch { tensions, beyond, at, .. } = &self.scratch;
            let state = (&tensions[..], &beyond[..], &at.turns[..]);
            self.history.advance(holes, commands, state, SLIDES * holes.length, ());
        }
    }

    /// How the cables stand in their holes at the state, which is in equilibrium and was assessed last.
    pub fn standing(&self, holes: &Holes, commands: &[Command]) -> Option<Standing> {
        let FrictionScratch { tensions, beyond, at, .. } = &self.scratch;
        let state = (&tensions[..], &beyond[..], &at.turns[..]);
        let mut there = self.history.clone();
        there.advance(holes, commands, state, SLIDES * holes.length, ());
        let end = there.end(holes, (commands, 1.0), &self.scratch, &self.history.beyond, None)?;
        Some(end.standing)
    }

    /// Takes tensions of all passages, and of the cables below the base, for those at the state of the robot.
    pub fn put(&mut self, standing: &Standing) {
        self.scratch.tensions.clone_from(&standing.tensions);
        self.history.base.clone_from(&standing.base);
    }

    /// Goes back to the last equilibrium.
    pub fn go_back(&mut self) {
        self.is_assessed = false;
        self.scratch.tensions.clone_from(&self.history.tensions);
    }
}
