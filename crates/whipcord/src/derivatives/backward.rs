//! The way back: from the sensitivity of a scalar to the answer to its gradient.

use whipcord_numerics::{Twist, Vec3};

use super::change::Places;
use super::elimination::NodeChange;
use super::{Derivatives, Place};
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
    nodes: Vec<Wrench>,
    places: Places,
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
            let node = &mut nodes[self.places.node(*at)];
            node.position += twist.linear;
            node.turn += twist.angular;
        }
        nodes[0].moment += cotangent.base_wrench.moment;
        nodes[0].force += cotangent.base_wrench.force;
        // What a change of each tension is worth, by all that it moves.
        let worth: Vec<f64> = (self.by_tension.iter().zip(&tensions))
            .map(|(column, own)| {
                let moved: f64 = column.nodes.iter().zip(&nodes).map(|(a, b)| a.dot(b)).sum();
                let longer: f64 = column.lengths.iter().zip(&lengths).map(|(a, b)| a * b).sum();
                own + moved + longer
            })
            .collect();
        let by_length = self.held.pull_back(hold, &worth);
        let by_commands = self.held.pull_back(Hold::Commands, &worth);
        let commands = (0..cables)
            .map(|cable| {
                let place = self.place_of[cable];
                match self.commands[place] {
                    Command::Length { .. } => -by_commands[place],
                    Command::Tension(_) => {
                        let lengths = &self.by_tension[place].lengths;
                        let held: f64 = by_commands.iter().zip(lengths).map(|(a, b)| a * b).sum();
                        worth[place] - held
                    }
                }
            })
            .collect();
        let lengths: Vec<f64> = lengths.iter().zip(&by_length).map(|(a, b)| a - b).collect();
        let extra = |k: usize| {
            let mut sum = [Vec3::ZERO; 3];
            for (place, length) in lengths.iter().enumerate() {
                let rates = &self.maps.length_by_state[k * cables + place];
                for (s, rate) in sum.iter_mut().zip(rates) {
                    *s += *length * *rate;
                }
            }
            sum
        };
        let mut steps = Vec::new();
        self.elimination.pull_back(&nodes, extra, &mut steps);
        let mut stages = Vec::new();
        self.linear.pull_back(&self.steps, &steps, &lengths, &mut stages);
        let mut wrenches = vec![Wrench::default()];
        wrenches.extend(steps.iter().map(|step| step.added));
        let parameters = (self.partials.iter())
            .map(|partial| {
                let acting: f64 =
                    stages.iter().enumerate().map(|(i, pull)| pull.dot(&partial.forcing(i))).sum();
                let longer: f64 = partial.lengths.iter().zip(&lengths).map(|(a, b)| a * b).sum();
                let asked: f64 = partial.targets.iter().zip(&by_length).map(|(a, b)| a * b).sum();
                let added = partial.added.map_or(0.0, |(node, wrench)| {
                    wrenches[node].force.dot(wrench.force)
                        + wrenches[node].moment.dot(wrench.moment)
                });
                let at_base = cotangent.base_wrench.force.dot(partial.at_node(0).force);
                acting + longer + asked + added + at_base
            })
            .collect();
        Gradient { commands, parameters, nodes: wrenches, places: self.places.clone() }
    }
}

impl Gradient {
    /// To a dead force and moment at a place, base frame.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn wrench(&self, at: Place) -> Wrench {
        self.nodes[self.places.node(at)]
    }
}
