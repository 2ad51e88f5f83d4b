//! The holes of a chain whose cables rub, among obstacles.

use super::chain::Chain;
use super::friction::{Rubbing, Turned};
use super::task::Task;
use crate::statics::command::Command;
use crate::statics::friction::{CondensedHoles, History, Standing};

/// The holes in the Newton's method of contact.
pub(super) struct HolesInContact<'a> {
    pub rubbing: &'a Rubbing,
    holes: CondensedHoles,
    turned: Turned,
    /// Whether an equilibrium was kept.
    pub has_started: bool,
    /// Whether anything has touched on the way.
    pub has_touched: bool,
}

impl<'a> HolesInContact<'a> {
    pub fn new(rubbing: &'a Rubbing) -> Self {
        let (holes, turned) = (CondensedHoles::default(), Turned::default());
        Self { rubbing, holes, turned, has_started: false, has_touched: false }
    }

    /// The robot at rest.
    pub fn reset(&mut self) {
        self.holes.reset(&self.rubbing.holes);
        self.has_started = false;
    }

    pub fn tensions(&self) -> &[f64] {
        self.holes.tensions()
    }

    pub fn history(&self) -> &History<()> {
        self.holes.history()
    }

    /// The lengths of the cables in m.
    pub fn cable_lengths(&self, into: &mut Vec<f64>) {
        self.rubbing.holes.cable_lengths(self.holes.lengths(), into);
    }

    /// What the equations of the holes leave where the chain was evaluated last, as a fraction of the length.
    pub fn measure(&mut self, chain: &Chain, task: &Task<'_>, commands: &[Command]) -> f64 {
        let Rubbing { holes, .. } = self.rubbing;
        let at = self.holes.at_mut();
        at.lengths.clone_from(&chain.lengths);
        self.turned.measure(chain, task, holes, &mut at.turns);
        self.holes.assess(holes, commands)
    }

    /// Eliminates the tensions from what was eliminated last with so many components of wrenches; see [`CondensedHoles::linearise`].
    pub fn linearise(
        &mut self,
        task: &Task<'_>,
        chain: &Chain,
        commands: &[Command],
        wrenches: usize,
    ) -> Option<()> {
        let Self { rubbing, holes, turned, .. } = self;
        holes.linearise(&rubbing.holes, commands, |response, by_wrench| {
            turned.responses(chain, task, response);
            let n = task.tensions.len();
            by_wrench.resize_with(wrenches, Default::default);
            for (k, by) in by_wrench.iter_mut().enumerate() {
                by.lengths.clear();
                by.lengths.resize(n, 0.0);
                by.turns.resize(n, 0.0);
                let side = 1 + n + k;
                chain.add_lengths(task, side, |p, change| by.lengths[p] += change);
                turned.by_response(chain, task, side, |p, change| by.turns[p] = change);
            }
        })
    }

    /// See [`CondensedHoles::standing`].
    pub fn standing(&self, commands: &[Command]) -> Option<Standing> {
        self.holes.standing(&self.rubbing.holes, commands)
    }

    /// See [`CondensedHoles::is_odd`].
    pub fn is_odd(&self) -> bool {
        self.holes.is_odd()
    }

    pub fn columns(&self) -> &[Vec<f64>] {
        self.holes.columns()
    }

    /// See [`CondensedHoles::follow`].
    pub fn follow(&mut self, commands: &[Command], changes: &[f64]) -> Vec<f64> {
        self.holes.follow(&self.rubbing.holes, commands, changes)
    }

    pub fn advance(&mut self, changes: &[f64], part: f64) {
        self.holes.advance(changes, part);
    }

    pub fn keep(&mut self, commands: &[Command]) {
        self.has_started = true;
        self.holes.keep(&self.rubbing.holes, commands);
    }

    pub fn go_back(&mut self) {
        self.holes.go_back();
    }
}
