//! The way back: from the sensitivity of a scalar to the answer to its gradient.

use std::sync::Arc;

use whipcord_numerics::{Twist, Vec3};

use super::change::{Place, Places};
use super::column::unit_wrench;
use super::effect::Effect;
use super::elimination::StepPull;
use super::node_change::NodeChange;
use super::rod::Derivatives;
use super::sliding_holes::Cause;
use super::spans::Spans;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::hold::Hold;

/// A scalar's sensitivity to the answer: what [`Derivatives::pull_back`] takes. What is not set is
/// zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cotangent {
    /// To translation and rotation of places, base frame, as [`super::Change::twist`] has them.
    pub places: Vec<(Place, Twist)>,
    /// To the length of each cable of the robot; shorter lists leave the others at zero.
    pub lengths: Vec<f64>,
    /// To the tension of each cable of the robot.
    pub tensions: Vec<f64>,
    /// To the wrench at the base.
    pub base_wrench: Wrench,
}

/// The sensitivity of a scalar to everything that can change.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// To the command of each cable: its tension in N, or its shortening in m.
    pub commands: Vec<f64>,
    /// To each parameter that was asked for.
    pub parameters: Vec<f64>,
    /// To a dead force and moment at each place, base frame, by [`Gradient::wrench`].
    pub(super) wrenches: Vec<Wrench>,
    pub(super) places: Arc<Places>,
}

impl Derivatives {
    /// The gradient of a scalar by every command, parameter and dead wrench, from its sensitivity to
    /// the answer: one sweep, whatever the number of parameters. `hold` is what is held when a
    /// parameter or a wrench changes.
    ///
    /// # Panics
    /// When the cotangent names a station or disk that there is not.
    #[must_use]
    pub fn pull_back(&self, cotangent: &Cotangent, hold: Hold) -> Gradient {
        let cables = self.place_of.len();
        let at_place = |values: &[f64]| -> Vec<f64> {
            let mut out = vec![0.0; cables];
            for (&place, value) in self.place_of.iter().zip(values) {
                out[place] = *value;
            }
            out
        };
        let tensions = at_place(&cotangent.tensions);
        let lengths = at_place(&cotangent.lengths);
        let mut nodes = vec![NodeChange::default(); self.steps.len() + 1];
        for (at, twist) in &cotangent.places {
            let node = &mut nodes[self.places.number(*at)];
            node.position += twist.linear;
            node.turn += twist.angular;
        }
        let at_base = &cotangent.base_wrench;
        let lengths = match &self.sliding {
            Some(sliding) => sliding.worth_of_lengths(&lengths),
            None => lengths,
        };
        // What a change of each tension is worth, by all that it moves.
        let mut worth: Vec<f64> =
            self.by_tension.iter().map(|column| column.worth(&nodes, &lengths, at_base)).collect();
        let (by_place, by_length, more) = match &self.sliding {
            Some(sliding) => {
                worth.extend(&tensions);
                sliding.pull_back(hold, &worth)
            }
            None => {
                worth.iter_mut().zip(&tensions).for_each(|(worth, own)| *worth += own);
                let by_length = self.held.pull_back(hold, &worth);
                let by_commands = self.held.pull_back(Hold::Commands, &worth);
                let command = |place: usize| match self.commands[place] {
                    Command::Length { .. } => -by_commands[place],
                    Command::Tension(_) => {
                        let lengths = &self.by_tension[place].lengths;
                        let held: f64 = by_commands.iter().zip(lengths).map(|(a, b)| a * b).sum();
                        worth[place] - held
                    }
                };
                let more: Vec<f64> = by_length.iter().map(|by| -by).collect();
                ((0..cables).map(command).collect(), by_length, more)
            }
        };
        let lengths: Vec<f64> = lengths.iter().zip(&more).map(|(a, b)| a + b).collect();
        let pushes = self.touching.pull_back(&mut nodes, &lengths, at_base);
        let remembered = &self.touching.remembered;
        let commands = match hold {
            // By commands nothing else is held.
            Hold::Tensions | Hold::Lengths if !remembered.is_empty() => {
                self.pull_back(cotangent, Hold::Commands).commands
            }
            _ => {
                let worth = |&place: &usize| {
                    by_place[place] + remembered.worth(Cause::Command(place), &pushes)
                };
                self.place_of.iter().map(worth).collect()
            }
        };
        let extra = |k: usize| {
            let mut sum = [Vec3::ZERO; 3];
            for row in 0..self.maps.rows {
                let Some(output) = self.strands.output(k, row) else { continue };
                let rates = &self.maps.length_by_state[k * self.maps.rows + row];
                for (s, rate) in sum.iter_mut().zip(rates) {
                    *s += lengths[output] * *rate;
                }
            }
            sum
        };
        let spans = self.linear.spans();
        let (mut links, starts) = match spans {
            Some(spans) => spans.gather(&nodes),
            None => (nodes.clone(), Vec::new()),
        };
        links[0].moment += at_base.moment;
        links[0].force += at_base.force;
        let extra = |k: usize| {
            let mut sum = extra(k);
            for (s, start) in sum.iter_mut().zip(starts.get(k).into_iter().flatten()) {
                *s += *start;
            }
            sum
        };
        let mut steps = Vec::new();
        self.elimination.pull_back(&links, extra, &mut steps);
        let mut stages = Vec::new();
        let rows = |k: usize, row: usize| {
            self.strands.output(k, row).map_or(0.0, |output| lengths[output])
        };
        self.linear.pull_back(&self.steps, &steps, (cables, &rows), &mut stages);
        let mut wrenches = vec![Wrench::default()];
        match spans {
            None => wrenches.extend(steps.iter().map(|step| step.added)),
            Some(spans) => {
                // Nobody asks for those at other nodes between disks.
                let places = self.places.stations.iter().copied();
                let loaded = self.partials.iter().filter_map(|partial| Some(partial.added?.0));
                wrenches.resize(nodes.len(), Wrench::default());
                for node in places.chain(loaded).chain(self.places.disks.iter().copied()) {
                    wrenches[node] = self.worth_of_wrench(spans, node, &nodes, &steps, &lengths);
                }
            }
        }
        let parameters = (self.partials.iter())
            .enumerate()
            .map(|(p, partial)| {
                let within = spans.map_or(0.0, |spans| {
                    let input = self.strands.inputs() + p;
                    self.worth_of_input(spans, input, &nodes, &steps, &lengths)
                });
                let acting: f64 =
                    stages.iter().enumerate().map(|(i, pull)| pull.dot(&partial.forcing(i))).sum();
                let longer: f64 = partial.lengths.iter().zip(&lengths).map(|(a, b)| a * b).sum();
                let asked: f64 = match &self.sliding {
                    Some(sliding) => sliding.worth_of(hold, &by_length, p),
                    None => partial.targets.iter().zip(&by_length).map(|(a, b)| a * b).sum(),
                };
                let added = partial.added.map_or(0.0, |(node, wrench)| wrenches[node].dot(&wrench));
                let at_base = at_base.force.dot(partial.at_node(0).force);
                let before = remembered.worth(Cause::Parameter(p), &pushes);
                within + acting + longer + asked + added + at_base + before
            })
            .collect();
        if let Some(on) = &self.moving_on {
            return Gradient { commands, parameters, ..on.pull_back(cotangent, hold) };
        }
        Gradient { commands, parameters, wrenches, places: self.places.clone() }
    }
}

impl Derivatives {
    /// What an input that acts within spans is worth.
    fn worth_of_input(
        &self,
        spans: &Spans,
        input: usize,
        nodes: &[NodeChange],
        pulls: &[StepPull],
        lengths: &[f64],
    ) -> f64 {
        let of_span = |(k, pull): (usize, &StepPull)| {
            let longer = self.worth_of_outputs(k, self.maps.outputs_of(k, input), lengths);
            pull.effect.dot(&self.maps.effects_of(k)[input]) + longer
        };
        spans.worth(nodes, spans.input(input)) + pulls.iter().enumerate().map(of_span).sum::<f64>()
    }

    /// What outputs of a span are worth, where all outputs are worth this.
    fn worth_of_outputs(&self, k: usize, own: &[f64], outputs: &[f64]) -> f64 {
        let of = |(row, by): (usize, &f64)| self.strands.output(k, row).map(|at| by * outputs[at]);
        own.iter().enumerate().filter_map(of).sum()
    }

    /// What a dead force and moment on a node of the grid are worth, of a robot that is cut into spans.
    fn worth_of_wrench(
        &self,
        spans: &Spans,
        node: usize,
        nodes: &[NodeChange],
        pulls: &[StepPull],
        lengths: &[f64],
    ) -> Wrench {
        if let Some(disk) = spans.disk(node) {
            return disk.checked_sub(1).map_or_else(Wrench::default, |span| pulls[span].added);
        }
        let of = |component: usize| {
            let pushed = spans.push(node, unit_wrench(component), self.maps.rows);
            let longer = self.worth_of_outputs(pushed.span, &pushed.lengths, lengths);
            let acting = |k: usize, node: usize| {
                if k == pushed.span { pushed.inside[node] } else { Effect::default() }
            };
            pulls[pushed.span].effect.dot(&pushed.effect) + spans.worth(nodes, acting) + longer
        };
        let [fx, fy, fz, mx, my, mz] = core::array::from_fn(of);
        Wrench { force: Vec3::new(fx, fy, fz), moment: Vec3::new(mx, my, mz) }
    }
}

impl Gradient {
    /// To a dead force and moment at a place, base frame.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn wrench(&self, at: Place) -> Wrench {
        self.wrenches[self.places.number(at)]
    }
}
