//! What one source changes: a tension, a parameter, a wrench.

use whipcord_numerics::Vec3;

use super::change::Change;
use super::elimination::NodeChange;
use super::forward::{Effect, Forcing};
use super::replay::AXES;
use super::{Derivatives, Place};
use crate::section::Strain;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::hold::Hold;

/// A change at constant tensions, in the terms of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Raw {
    pub nodes: Vec<NodeChange>,
    pub lengths: Vec<f64>,
}

/// What acts: a column's source.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    Tension(usize),
    Parameter(usize),
    /// Component of a dead wrench at a node, the force first.
    Wrench {
        node: usize,
        component: usize,
    },
}

impl Derivatives {
    /// The change that a source makes at constant tensions.
    pub(super) fn raw(&self, source: Source) -> Raw {
        let cables = self.place_of.len();
        let input = match source {
            Source::Tension(place) => Some(place),
            Source::Parameter(p) if self.partials[p].acts() => Some(cables + p),
            _ => None,
        };
        let added = match source {
            Source::Tension(_) => None,
            Source::Parameter(p) => self.partials[p].added,
            Source::Wrench { node, component } => Some((node, unit_wrench(component))),
        };
        let effect = |k: usize| input.map_or_else(Effect::default, |i| self.maps.effects_of(k)[i]);
        let wrench = |node: usize| match added {
            Some((at, wrench)) if at == node => wrench,
            _ => Wrench::default(),
        };
        let mut raw = self.answer_to(0, effect, wrench);
        for (place, length) in raw.lengths.iter_mut().enumerate() {
            if let Source::Parameter(p) = source {
                *length += self.partials[p].lengths[place];
            }
            if let Some(input) = input {
                let at = |k: usize| (k * self.maps.inputs + input) * cables + place;
                *length +=
                    (0..self.steps.len()).map(|k| self.maps.length_by_input[at(k)]).sum::<f64>();
            }
        }
        raw
    }

    /// The change that goes with something that acts within the steps, and wrenches added at the nodes, at
    /// constant tensions; nothing acts in the steps before `first`.
    pub(super) fn answer_to(
        &self,
        first: usize,
        effect: impl Fn(usize) -> Effect,
        added: impl Fn(usize) -> Wrench,
    ) -> Raw {
        let cables = self.place_of.len();
        let mut raw = Raw { nodes: Vec::new(), lengths: vec![0.0; cables] };
        self.elimination.solve(first, effect, added, &mut raw.nodes);
        for (k, node) in raw.nodes.iter().take(self.steps.len()).enumerate() {
            for (place, length) in raw.lengths.iter_mut().enumerate() {
                let [turn, moment, force] = &self.maps.length_by_state[k * cables + place];
                *length += turn.dot(node.turn) + moment.dot(node.moment) + force.dot(node.force);
            }
        }
        raw
    }

    /// A change at constant tensions completed by the tensions that keep what is held; `targets` is
    /// the change of the lengths that are to be kept.
    fn completed(&self, source: Source, hold: Hold, targets: &[f64]) -> Change {
        let raw = self.raw(source);
        let cables = self.place_of.len();
        let right: Vec<f64> = (0..cables)
            .map(|place| targets.get(place).copied().unwrap_or(0.0) - raw.lengths[place])
            .collect();
        let mut tensions = self.held.tensions(hold, &right);
        let Raw { mut nodes, mut lengths } = raw;
        for (column, &tension) in self.by_tension.iter().zip(&tensions) {
            if tension != 0.0 {
                for (node, by) in nodes.iter_mut().zip(&column.nodes) {
                    node.add(tension, by);
                }
                for (length, by) in lengths.iter_mut().zip(&column.lengths) {
                    *length += tension * by;
                }
            }
        }
        let strains = self.strains(&nodes, source, &tensions);
        if let Source::Parameter(p) = source {
            // What acts on the rod between base and tip adds to what the nodes carry.
            nodes[0].force += self.partials[p].at_node(0).force;
        }
        if let Source::Tension(place) = source {
            tensions[place] += 1.0;
        }
        self.change(nodes, strains, &lengths, &tensions)
    }

    fn change(
        &self,
        nodes: Vec<NodeChange>,
        strains: Vec<Strain>,
        lengths: &[f64],
        tensions: &[f64],
    ) -> Change {
        let of_robot = |values: &[f64]| self.place_of.iter().map(|&place| values[place]).collect();
        Change {
            places: self.places.clone(),
            nodes,
            strains,
            lengths: of_robot(lengths),
            tensions: of_robot(tensions),
        }
    }

    /// How the strain behind each node changes, and of the tip in front of it: eq. (d1) at the nodes.
    fn strains(&self, nodes: &[NodeChange], source: Source, tensions: &[f64]) -> Vec<Strain> {
        let cables = tensions.len();
        (0..nodes.len())
            .map(|node| {
                let stage = self.linear.at_node(node);
                let mut change = nodes[node];
                if node == self.steps.len() {
                    self.elimination.arriving(&mut change, node);
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
        let mut nodes = vec![NodeChange::default(); self.steps.len() + 1];
        let mut lengths = vec![0.0; cables];
        for (column, &tension) in self.by_tension.iter().zip(tensions) {
            for (node, by) in nodes.iter_mut().zip(&column.nodes) {
                node.add(tension, by);
            }
            for (length, by) in lengths.iter_mut().zip(&column.lengths) {
                *length += tension * by;
            }
        }
        // No wrench at all is added: the component does not matter.
        let nothing = Source::Wrench { node: usize::MAX, component: 0 };
        let strains = self.strains(&nodes, nothing, tensions);
        self.change(nodes, strains, &lengths, tensions)
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
        let node = self.places.node(at);
        self.completed(Source::Wrench { node, component }, hold, &[])
    }
}

impl Raw {
    pub fn is_finite(&self) -> bool {
        self.nodes.iter().all(|n| n.turn.is_finite() && n.position.is_finite())
            && self.lengths.iter().all(|l| l.is_finite())
    }
}

/// A wrench of which one component is 1, the force first.
pub(crate) fn unit_wrench(component: usize) -> Wrench {
    match component {
        0..3 => Wrench { force: AXES[component], moment: Vec3::ZERO },
        _ => Wrench { force: Vec3::ZERO, moment: AXES[component % 3] },
    }
}
