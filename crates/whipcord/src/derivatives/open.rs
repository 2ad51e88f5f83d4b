//! Answers that are not there yet: a chain whose steps do not meet, linearised where it stands.
//!
//! Newton's step closes the gaps of eq. (d3) and brings the cables to their lengths by eq. (d4); so do the
//! motions with the wrenches that change at the same time.

use whipcord_numerics::{UnitQuaternion, Vec3};

use super::column::Raw;
use super::effect::Effect;
use super::node_change::NodeChange;
use super::rod::Derivatives;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::elimination::Change;
use crate::statics::hold::Hold;

/// How a step ends beyond the node that it should meet, base frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepGap {
    pub turn: Vec3,
    pub moment: Vec3,
    pub force: Vec3,
}

impl StepGap {
    /// Of a step that ends so beyond a node, both turned and moved in the frame of the node, of this rotation and with this
    /// moment in it.
    pub fn new(gap: Change, rotation: UnitQuaternion, at_node: Vec3) -> Self {
        let Change { turn, moment, force } = gap;
        let end = rotation * UnitQuaternion::exp(turn);
        Self {
            turn: rotation.rotate(turn),
            moment: end.rotate(moment + at_node) - rotation.rotate(at_node),
            force,
        }
    }
}

/// How all nodes and the tensions move, the latter by grid places.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motion {
    pub nodes: Vec<NodeChange>,
    /// Of the disks, with what acts in rod and cables together, where cables run straight from disk to disk; else empty.
    pub disks: Vec<NodeChange>,
    pub tensions: Vec<f64>,
}

impl Motion {
    /// `self += f · other`.
    pub fn add(&mut self, f: f64, other: &Self) {
        for (nodes, others) in [(&mut self.nodes, &other.nodes), (&mut self.disks, &other.disks)] {
            for (node, by) in nodes.iter_mut().zip(others) {
                node.add(f, by);
            }
        }
        for (tension, by) in self.tensions.iter_mut().zip(&other.tensions) {
            *tension += f * by;
        }
    }
}

/// How all nodes move while the tensions of all strands stay, and what the strands' lengths and angles change by.
#[derive(Clone, Debug, Default)]
pub(crate) struct OpenChange {
    pub motion: Motion,
    pub outputs: Vec<f64>,
}

impl From<Raw> for OpenChange {
    fn from(Raw { nodes, disks, lengths, .. }: Raw) -> Self {
        Self { motion: Motion { nodes, disks, tensions: Vec::new() }, outputs: lengths }
    }
}

impl Derivatives {
    /// How everything moves with a wrench at a node, the tensions of all strands held.
    pub(crate) fn open_response(&self, node: usize, wrench: Wrench) -> OpenChange {
        self.respond(None, Some((node, wrench))).into()
    }

    /// How everything moves with the tension of each strand, by its number.
    pub(crate) fn strand_responses(&self) -> impl Iterator<Item = OpenChange> + '_ {
        self.by_tension.iter().map(|raw| raw.clone().into())
    }

    /// The step that closes the gaps while the tensions of all strands stay; as [`Self::closing`] has it.
    pub(crate) fn open_closing(&self, gaps: &[StepGap], unbalanced: &[Wrench]) -> OpenChange {
        self.closing_at_tensions(gaps, unbalanced).into()
    }

    /// The step that closes the gaps, takes the tension off cables that are not taut, and takes those that
    /// are by these slacknesses in m to their lengths. `unbalanced` is what (d7) lacks at the near disk of each span, of
    /// cables that run straight between disks: rod and cables less what acts there.
    pub(crate) fn closing(
        &self,
        gaps: &[StepGap],
        unbalanced: &[Wrench],
        tensions: &[f64],
        taut: &[bool],
        slackness: &[f64],
    ) -> Motion {
        let raw = self.closing_at_tensions(gaps, unbalanced);
        let release = |place: usize| match self.commands[place] {
            Command::Length { .. } if !taut[place] => -tensions[place],
            _ => 0.0,
        };
        self.complete(raw, (0..tensions.len()).map(release).collect(), slackness)
    }

    fn closing_at_tensions(&self, gaps: &[StepGap], unbalanced: &[Wrench]) -> Raw {
        let start = |k: usize| {
            unbalanced
                .get(k)
                .map_or([Vec3::ZERO; 3], |lack| [Vec3::ZERO, -lack.moment, -lack.force])
        };
        let effect = |k: usize| {
            let StepGap { turn, moment, force } = gaps[k];
            let gap = Effect { turn, moment, force, shift: Vec3::ZERO };
            let by_lack = self.elimination.step(k).apply(start(k));
            // What is lacking is no force of followers.
            let force = by_lack.force - start(k)[2];
            gap.plus(&Effect { force, ..by_lack })
        };
        let mut raw = self.answer_to(0, effect, |_| Wrench::default());
        if let Some(spans) = self.linear.spans() {
            for k in 0..self.links() {
                let [_, by_moment, by_force] = start(k);
                for row in 0..self.maps.rows {
                    let Some(output) = self.strands.output(k, row) else { continue };
                    let [_, moment, force] = &self.maps.length_by_state[k * self.maps.rows + row];
                    raw.lengths[output] += moment.dot(by_moment) + force.dot(by_force);
                }
            }
            raw.disks = core::mem::take(&mut raw.nodes);
            let acting = |k: usize, node: usize| spans.inside(k, node).apply(start(k));
            spans.expand(&raw.disks, acting, &mut raw.nodes);
        }
        raw
    }

    /// How everything moves with a wrench at a node, all commands held.
    pub(crate) fn contact_response(&self, node: usize, wrench: Wrench) -> Motion {
        let cables = self.place_of.len();
        let raw = self.respond(None, Some((node, wrench)));
        self.complete(raw, vec![0.0; cables], &vec![0.0; cables])
    }

    /// A change at constant tensions, these changes of tensions, and those of the taut cables that bring
    /// them to their lengths.
    fn complete(&self, raw: Raw, mut tensions: Vec<f64>, slackness: &[f64]) -> Motion {
        let mut changed = raw;
        for (column, &tension) in self.by_tension.iter().zip(&tensions) {
            for (length, by) in changed.lengths.iter_mut().zip(&column.lengths) {
                *length += tension * by;
            }
        }
        let lengths = changed.lengths.clone();
        let right: Vec<f64> =
            slackness.iter().zip(&lengths).map(|(slack, length)| slack - length).collect();
        for (tension, change) in tensions.iter_mut().zip(self.held.tensions(Hold::Commands, &right))
        {
            *tension += change;
        }
        for (column, &tension) in self.by_tension.iter().zip(&tensions) {
            changed.add(tension, column);
        }
        Motion { nodes: changed.nodes, disks: changed.disks, tensions }
    }
}
