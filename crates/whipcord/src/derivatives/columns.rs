//! What one source changes: a tension, a parameter, a wrench.

use super::change::{Change, Place};
use super::column::{Raw, Source, unit_wrench};
use super::effect::{Effect, Forcing};
use super::node_change::NodeChange;
use super::rod::Derivatives;
use super::spans::Spans;
use crate::section::Strain;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::hold::Hold;

impl Derivatives {
    /// The change that a source makes at constant tensions.
    pub(super) fn raw(&self, source: Source) -> Raw {
        let mut raw = self.raw_alone(source);
        self.touching.respond(&mut raw);
        raw
    }

    /// The same of the robot without its contacts, under what they push.
    fn raw_alone(&self, source: Source) -> Raw {
        let cables = self.place_of.len();
        match source {
            Source::Tension(place) => self.respond(Some(place), None),
            Source::Wrench { node, component } => {
                self.respond(None, Some((node, unit_wrench(component))))
            }
            Source::Parameter(p) => {
                let partial = &self.partials[p];
                let mut raw = self.respond(partial.acts().then_some(cables + p), partial.added);
                for (length, by) in raw.lengths.iter_mut().zip(&partial.lengths) {
                    *length += by;
                }
                raw
            }
        }
    }

    /// The change at constant tensions that goes with one of the inputs of the maps, and with a dead wrench that is added
    /// at a node of the grid.
    pub(super) fn respond(&self, input: Option<usize>, wrench: Option<(usize, Wrench)>) -> Raw {
        let cables = self.place_of.len();
        let spans = self.linear.spans();
        // The number that the node has in the chain; `None` between disks.
        let link = |node: usize| spans.map_or(Some(node), |spans| spans.disk(node));
        let pushed = match (spans, wrench) {
            (Some(spans), Some((node, wrench))) if link(node).is_none() => {
                Some(spans.push(node, wrench, cables))
            }
            _ => None,
        };
        let added = wrench.and_then(|(node, wrench)| Some((link(node)?, wrench)));
        let effect = |k: usize| {
            let own = input.map_or_else(Effect::default, |i| self.maps.effects_of(k)[i]);
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
        for (place, length) in raw.lengths.iter_mut().enumerate() {
            if let Some(input) = input {
                let at = |k: usize| (k * self.maps.inputs + input) * cables + place;
                *length += (0..self.links()).map(|k| self.maps.length_by_input[at(k)]).sum::<f64>();
            }
            if let Some(pushed) = &pushed {
                *length += pushed.lengths[place];
            }
        }
        if let Some(spans) = spans {
            raw.disks = core::mem::take(&mut raw.nodes);
            spans.expand(
                &raw.disks,
                |k, node| {
                    let own = input.map_or_else(Effect::default, |i| spans.input(i)(k, node));
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
        let cables = self.place_of.len();
        let mut raw = Raw { lengths: vec![0.0; cables], ..Raw::default() };
        self.elimination.solve(first, effect, added, &mut raw.nodes);
        for (k, node) in raw.nodes.iter().take(self.links()).enumerate() {
            for (place, length) in raw.lengths.iter_mut().enumerate() {
                let [turn, moment, force] = &self.maps.length_by_state[k * cables + place];
                *length += turn.dot(node.turn) + moment.dot(node.moment) + force.dot(node.force);
            }
        }
        raw.base = Wrench { force: raw.nodes[0].force, moment: raw.nodes[0].moment };
        raw
    }

    /// A change at constant tensions completed by the tensions that keep what is held; `targets` is
    /// the change of the lengths that are to be kept.
    fn completed(&self, source: Source, hold: Hold, targets: &[f64]) -> Change {
        let (mut changed, mut tensions) = self.completing(source, hold, targets);
        let strains = self.strains(&changed, source, &tensions);
        if let Source::Parameter(p) = source {
            // What acts on the rod between base and tip adds to what the nodes carry.
            changed.base.force += self.partials[p].at_node(0).force;
        }
        if let Source::Tension(place) = source {
            tensions[place] += 1.0;
        }
        self.change(changed, strains, &tensions)
    }

    /// The same in the terms of the grid, and the tensions that complete it.
    pub(super) fn completing(
        &self,
        source: Source,
        hold: Hold,
        targets: &[f64],
    ) -> (Raw, Vec<f64>) {
        let raw = self.raw(source);
        let cables = self.place_of.len();
        let right: Vec<f64> = (0..cables)
            .map(|place| targets.get(place).copied().unwrap_or(0.0) - raw.lengths[place])
            .collect();
        let tensions = self.held.tensions(hold, &right);
        let mut changed = raw;
        for (column, &tension) in self.by_tension.iter().zip(&tensions) {
            changed.add(tension, column);
        }
        (changed, tensions)
    }

    fn change(&self, changed: Raw, strains: Vec<Strain>, tensions: &[f64]) -> Change {
        let of_robot = |values: &[f64]| self.place_of.iter().map(|&place| values[place]).collect();
        Change {
            places: self.places.clone(),
            strains,
            base: changed.base,
            lengths: of_robot(&changed.lengths),
            twists: changed.nodes.iter().map(NodeChange::twist).collect(),
            tensions: of_robot(tensions),
        }
    }

    /// How the strain behind each node changes, and of the tip in front of it: eq. (d1) at the nodes.
    pub(super) fn strains(&self, changed: &Raw, source: Source, tensions: &[f64]) -> Vec<Strain> {
        let cables = tensions.len();
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
                for (place, ((pull, _), tension)) in pulls.iter().zip(tensions).enumerate() {
                    let own = matches!(source, Source::Tension(p) if p == place);
                    let tension = tension + if own { 1.0 } else { 0.0 };
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
        match self.commands[place] {
            Command::Tension(_) => self.completed(Source::Tension(place), Hold::Commands, &[]),
            Command::Length { .. } => {
                let cables = self.place_of.len();
                let right: Vec<f64> =
                    (0..cables).map(|i| if i == place { -1.0 } else { 0.0 }).collect();
                let tensions = self.held.tensions(Hold::Commands, &right);
                self.with_tensions(&tensions)
            }
        }
    }

    /// How the answer changes with the tension of a cable in N, all other tensions held.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn tension(&self, cable: usize) -> Change {
        self.completed(Source::Tension(self.place_of[cable]), Hold::Tensions, &[])
    }

    /// The change that goes with changes of the tensions, by grid places, and with nothing else.
    fn with_tensions(&self, tensions: &[f64]) -> Change {
        let cables = tensions.len();
        let mut changed = Raw {
            nodes: vec![NodeChange::default(); self.steps.len() + 1],
            lengths: vec![0.0; cables],
            ..Raw::default()
        };
        for (column, &tension) in self.by_tension.iter().zip(tensions) {
            changed.add(tension, column);
        }
        // No wrench at all is added: the component does not matter.
        let nothing = Source::Wrench { node: usize::MAX, component: 0 };
        let strains = self.strains(&changed, nothing, tensions);
        self.change(changed, strains, tensions)
    }

    /// How the answer changes with a parameter, by its number in the list that was asked for.
    ///
    /// # Panics
    /// When no parameter has this number.
    #[must_use]
    pub fn parameter(&self, index: usize, hold: Hold) -> Change {
        let targets = &self.partials[index].targets;
        self.completed(Source::Parameter(index), hold, targets)
    }

    /// How the answer changes with a component of a dead wrench at a place, base frame: force in N
    /// along x, y, z, then moment in N·m about x, y, z.
    ///
    /// # Panics
    /// When there is no such station or disk, or the component is none of 0 to 5.
    #[must_use]
    pub fn wrench(&self, at: Place, component: usize, hold: Hold) -> Change {
        assert!(component < 6, "a wrench has six components, none of which is {component}");
        let node = self.places.number(at);
        self.completed(Source::Wrench { node, component }, hold, &[])
    }
}
