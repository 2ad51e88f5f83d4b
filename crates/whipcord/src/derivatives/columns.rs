//! What one source changes: a tension, a parameter, a wrench.

use super::change::{Change, Place};
use super::column::{Raw, Source, unit_wrench};
use super::effect::{Effect, Forcing};
use super::node_change::NodeChange;
use super::rod::Derivatives;
use super::sliding_holes::Cause;
use super::spans::Spans;
use super::strands::PLACES;
use crate::section::Strain;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::hold::Hold;

/// An input of the maps.
#[derive(Clone, Copy, Debug)]
pub(super) enum Input {
    /// Of a strand.
    Tension(usize),
    Parameter(usize),
}

impl Derivatives {
    /// The change that a source makes at constant tensions.
    pub(super) fn raw(&self, source: Source) -> Raw {
        let mut raw = self.raw_alone(source);
        self.touching.respond(&mut raw);
        raw
    }

    /// The same of the robot without its contacts, under what they push.
    fn raw_alone(&self, source: Source) -> Raw {
        match source {
            Source::Tension(strand) => self.respond(Some(Input::Tension(strand)), None),
            Source::Wrench { node, component } => {
                self.respond(None, Some((node, unit_wrench(component))))
            }
            Source::Parameter(p) => {
                let partial = &self.partials[p];
                let mut raw =
                    self.respond(partial.acts().then_some(Input::Parameter(p)), partial.added);
                for (length, by) in raw.lengths.iter_mut().zip(&partial.lengths) {
                    *length += by;
                }
                raw
            }
        }
    }

    /// The change at constant tensions that goes with one of the inputs of the maps, and with a dead wrench that is added
    /// at a node of the grid.
    pub(super) fn respond(&self, input: Option<Input>, wrench: Option<(usize, Wrench)>) -> Raw {
        // The number of the input among those of a step or span.
        let number = |k: usize| match input? {
            Input::Tension(strand) => self.strands.input(k, strand),
            Input::Parameter(p) => Some(self.strands.inputs() + p),
        };
        let spans = self.linear.spans();
        // The number that the node has in the chain; `None` between disks.
        let link = |node: usize| spans.map_or(Some(node), |spans| spans.disk(node));
        let pushed = match (spans, wrench) {
            (Some(spans), Some((node, wrench))) if link(node).is_none() => {
                Some(spans.push(node, wrench, self.maps.rows))
            }
            _ => None,
        };
        let added = wrench.and_then(|(node, wrench)| Some((link(node)?, wrench)));
        let effect = |k: usize| {
            let own = number(k).map_or_else(Effect::default, |i| self.maps.effects_of(k)[i]);
            match &pushed {
                Some(pushed) if pushed.span == k => own.plus(&pushed.effect),
                _ => own,
            }
        };
        let first = match (input, &added, &pushed) {
            (Some(_), ..) => 0,
            (None, Some((node, _)), _) => node.saturating_sub(1),
            (None, None, Some(pushed)) => pushed.span,
            (None, None, None) => self.links(),
        };
        let mut raw = self.answer_to(first.min(self.links()), effect, |node| match added {
            Some((at, wrench)) if at == node => wrench,
            _ => Wrench::default(),
        });
        let mut own = vec![0.0; raw.lengths.len()];
        for k in 0..self.links() {
            if let Some(input) = number(k) {
                self.add_outputs(k, self.maps.outputs_of(k, input), &mut own);
            }
        }
        raw.lengths.iter_mut().zip(&own).for_each(|(length, own)| *length += own);
        if let Some(pushed) = &pushed {
            self.add_outputs(pushed.span, &pushed.lengths, &mut raw.lengths);
        }
        if let Some(spans) = spans {
            raw.disks = core::mem::take(&mut raw.nodes);
            spans.expand(
                &raw.disks,
                |k, node| {
                    let own = number(k).map_or_else(Effect::default, |i| spans.input(i)(k, node));
                    match &pushed {
                        Some(pushed) if pushed.span == k => own.plus(&pushed.inside[node]),
                        _ => own,
                    }
                },
                &mut raw.nodes,
            );
        }
        raw
    }

    /// Adds what a step or a span changes of its outputs to all outputs.
    fn add_outputs(&self, k: usize, own: &[f64], outputs: &mut [f64]) {
        for (row, by) in own.iter().enumerate() {
            if let Some(output) = self.strands.output(k, row) {
                outputs[output] += by;
            }
        }
    }

    /// How many steps, or spans, are eliminated.
    pub(super) fn links(&self) -> usize {
        self.linear.spans().map_or(self.steps.len(), Spans::len)
    }

    /// The change of the nodes that are eliminated that goes with something that acts within the steps or spans, and wrenches
    /// added between them, at constant tensions; nothing acts in those before `first`.
    pub(super) fn answer_to(
        &self,
        first: usize,
        effect: impl Fn(usize) -> Effect,
        added: impl Fn(usize) -> Wrench,
    ) -> Raw {
        let mut raw = Raw { lengths: vec![0.0; self.strands.outputs()], ..Raw::default() };
        self.elimination.solve(first, effect, added, &mut raw.nodes);
        let rows = self.maps.rows;
        for (k, node) in raw.nodes.iter().take(self.links()).enumerate() {
            for row in 0..rows {
                let Some(output) = self.strands.output(k, row) else { continue };
                let [turn, moment, force] = &self.maps.length_by_state[k * rows + row];
                raw.lengths[output] +=
                    turn.dot(node.turn) + moment.dot(node.moment) + force.dot(node.force);
            }
        }
        raw.base = Wrench { force: raw.nodes[0].force, moment: raw.nodes[0].moment };
        raw
    }

    /// The changes of the tensions of all strands that keep what is held with a cause that changes the outputs so at constant tensions;
    /// and where cables rub, of the tensions below the base. By grid places.
    pub(super) fn tensions(&self, hold: Hold, outputs: &[f64], cause: Cause) -> [Vec<f64>; 2] {
        if let Some(sliding) = &self.sliding {
            return sliding.tensions(hold, outputs, cause);
        }
        let target = |place: usize| match cause {
            Cause::Parameter(p) => self.partials[p].targets[place],
            Cause::Command(cable) if cable == place => -1.0,
            _ => 0.0,
        };
        let cables = 0..self.place_of.len();
        let right: Vec<f64> = cables
            .map(|place| target(place) - outputs.get(place).copied().unwrap_or(0.0))
            .collect();
        [self.held.tensions(hold, &right), Vec::new()]
    }

    /// What the command of a cable, by its grid place, or where `hold` is that of tensions its tension, changes of every tension.
    pub(super) fn pulled(&self, place: usize, hold: Hold) -> [Vec<f64>; 2] {
        let is_of_tension = hold == Hold::Tensions;
        if let Some(sliding) = &self.sliding {
            let cause = if is_of_tension { Cause::Tension(place) } else { Cause::Command(place) };
            return sliding.tensions(hold, &self.remembered(cause).lengths, cause);
        }
        let is_tension = is_of_tension || matches!(self.commands[place], Command::Tension(_));
        let lengths = &self.by_tension[place].lengths;
        [self.held.commanded(hold, place, is_tension, lengths), Vec::new()]
    }

    /// The lengths of the cables by grid places, of those of all strands.
    pub(super) fn cable_lengths(&self, outputs: Vec<f64>) -> Vec<f64> {
        match &self.sliding {
            Some(sliding) => sliding.cable_lengths(&outputs),
            None => outputs,
        }
    }

    /// A change at constant tensions completed by the tensions that keep what is held.
    fn completed(&self, source: Source, hold: Hold, cause: Cause) -> Change {
        let (mut changed, [tensions, base]) = self.completing(source, hold, cause);
        let strains = self.strains(&changed, source, &tensions);
        if let Source::Parameter(p) = source {
            // What acts on the rod between base and tip adds to what the nodes carry.
            changed.base.force += self.partials[p].at_node(0).force;
        }
        self.change(changed, strains, [tensions, base])
    }

    /// The same in the terms of the grid, and the tensions that complete it.
    pub(super) fn completing(
        &self,
        source: Source,
        hold: Hold,
        cause: Cause,
    ) -> (Raw, [Vec<f64>; 2]) {
        let mut changed = self.raw(source);
        self.touching.remember(&mut changed, cause);
        let tensions = self.tensions(hold, &changed.lengths, cause);
        for (column, &tension) in self.by_tension.iter().zip(&tensions[0]) {
            changed.add(tension, column);
        }
        (changed, tensions)
    }

    fn change(&self, changed: Raw, strains: Vec<Strain>, [pulls, base]: [Vec<f64>; 2]) -> Change {
        let of_robot = |values: &[f64]| self.place_of.iter().map(|&place| values[place]).collect();
        Change {
            places: self.places.clone(),
            strains,
            base: changed.base,
            twists: changed.nodes.iter().map(NodeChange::twist).collect(),
            lengths: of_robot(&self.cable_lengths(changed.lengths)),
            tensions: of_robot(if self.sliding.is_some() { &base } else { &pulls }),
        }
    }

    /// How the strain behind each node changes, and of the tip in front of it: eq. (d1) at the nodes.
    pub(super) fn strains(&self, changed: &Raw, source: Source, tensions: &[f64]) -> Vec<Strain> {
        let cables = self.place_of.len();
        let nodes = &changed.nodes;
        (0..nodes.len())
            .map(|node| {
                let stage = self.linear.at_node(node);
                let mut change = nodes[node];
                // Of spans what acts in the rod at the tip is known in front of it.
                if node == self.steps.len() && self.linear.spans().is_none() {
                    self.elimination.arriving(&mut change, node);
                    let pushed = self.touching.push(&changed.pushes, node);
                    change.moment += pushed.moment;
                    change.force += pushed.force;
                    if let Source::Wrench { node: place, component } = source
                        && place == node
                    {
                        change.moment += unit_wrench(component).moment;
                        change.force += unit_wrench(component).force;
                    }
                    if let Source::Parameter(p) = source
                        && let Some((place, wrench)) = self.partials[p].added
                        && place == node
                    {
                        change.moment += wrench.moment;
                        change.force += wrench.force;
                    }
                }
                let active = self.steps[node.min(self.steps.len() - 1)].active;
                let mut forcing = match source {
                    Source::Parameter(p) => self.partials[p].at_node(node),
                    _ => Forcing::default(),
                };
                let pulls = self.linear.pulls_at_node(node, cables, active);
                let link = node.min(self.links() - 1);
                let at = if node == link { 0 } else { PLACES - 1 };
                for (place, (pull, _)) in pulls.iter().enumerate() {
                    let tension = self.strands.tension((link, place), at, tensions);
                    forcing.force_balance += tension * pull.linear;
                    forcing.moment_balance += tension * pull.angular;
                }
                stage.strain_change(&change, &forcing)
            })
            .collect()
    }

    /// How the answer changes with the command of a cable: its tension in N where that drives it,
    /// else its shortening in m. All other commands are held. A cable that is slack moves nothing.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn command(&self, cable: usize) -> Change {
        let place = self.place_of[cable];
        self.with_tensions(self.pulled(place, Hold::Commands), Cause::Command(place))
    }

    /// [`Self::command`] of every cable.
    #[must_use]
    pub fn commands(&self) -> Vec<Change> {
        (0..self.place_of.len()).map(|cable| self.command(cable)).collect()
    }

    /// How the answer changes where the command of a cable is changed by as much in all steps of the case ([`Self::command`] changes it
    /// in the last). They differ where cables or obstacles rub, which remember the steps before. What friction against bending keeps of these
    /// is taken as it is.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn offset(&self, cable: usize) -> Change {
        match &self.sliding {
            Some(sliding) => {
                let cause = Cause::Offset(self.place_of[cable]);
                let outputs = self.remembered(cause).lengths;
                self.with_tensions(sliding.tensions(Hold::Commands, &outputs, cause), cause)
            }
            None => self.command(cable),
        }
    }

    /// How the answer changes with the tension of a cable in N, all other tensions held.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn tension(&self, cable: usize) -> Change {
        if let Some(on) = &self.moving_on {
            return on.tension(cable);
        }
        let place = self.place_of[cable];
        self.with_tensions(self.pulled(place, Hold::Tensions), Cause::Tension(place))
    }

    /// What contacts remember of a cause changes at constant tensions.
    pub(super) fn remembered(&self, cause: Cause) -> Raw {
        let mut changed = Raw {
            nodes: vec![NodeChange::default(); self.steps.len() + 1],
            lengths: vec![0.0; self.strands.outputs()],
            ..Raw::default()
        };
        self.touching.remember(&mut changed, cause);
        changed
    }

    /// The change that goes with changes of the tensions of all strands, and with nothing else but what contacts remember of a cause; and with
    /// the tensions below the base, where these are others.
    fn with_tensions(&self, tensions: [Vec<f64>; 2], cause: Cause) -> Change {
        let mut changed = self.remembered(cause);
        for (column, &tension) in self.by_tension.iter().zip(&tensions[0]) {
            changed.add(tension, column);
        }
        // No wrench at all is added: the component does not matter.
        let nothing = Source::Wrench { node: usize::MAX, component: 0 };
        let strains = self.strains(&changed, nothing, &tensions[0]);
        self.change(changed, strains, tensions)
    }

    /// How the answer changes with a parameter, by its number in the list that was asked for.
    ///
    /// # Panics
    /// When no parameter has this number.
    #[must_use]
    pub fn parameter(&self, index: usize, hold: Hold) -> Change {
        self.completed(Source::Parameter(index), hold, Cause::Parameter(index))
    }

    /// How the answer changes with a component of a dead wrench at a place, base frame: force in N
    /// along x, y, z, then moment in N·m about x, y, z.
    ///
    /// # Panics
    /// When there is no such station or disk, or the component is none of 0 to 5.
    #[must_use]
    pub fn wrench(&self, at: Place, component: usize, hold: Hold) -> Change {
        assert!(component < 6, "a wrench has six components, none of which is {component}");
        if let Some(on) = &self.moving_on {
            return on.wrench(at, component, hold);
        }
        let node = self.places.number(at);
        self.completed(Source::Wrench { node, component }, hold, Cause::Nothing)
    }
}
