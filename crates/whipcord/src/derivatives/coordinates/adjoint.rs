//! The transpose of the derivatives by (d8) and (d9): gradients of any function of an answer.

use whipcord_numerics::{Twist, Vec3, dot};

use super::super::backward::{Cotangent, Gradient};
use super::super::linear_system::{ParameterChange, add};
use super::super::sliding_holes::Cause;
use super::{CoordinateDerivatives, Response};
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::hold::Hold;

impl CoordinateDerivatives {
    /// As [`crate::derivatives::Derivatives::pull_back`].
    ///
    /// # Panics
    /// When the cotangent names a station or disk that there is not.
    #[must_use]
    pub fn pull_back(&self, cotangent: &Cotangent, hold: Hold) -> Gradient {
        let (system, cables) = (&self.system, self.cables.len());
        let of_cables = |values: &[f64]| -> Vec<f64> {
            (0..cables).map(|i| values.get(i).copied().unwrap_or(0.0)).collect()
        };
        let (tensions, lengths) = (of_cables(&cotangent.tensions), of_cables(&cotangent.lengths));
        let mut twists = vec![Twist::default(); system.positions.len()];
        for (at, twist) in &cotangent.places {
            let sum = &mut twists[self.places.number(*at)];
            *sum = *sum + *twist;
        }
        let at_base = &cotangent.base_wrench;
        let lengths = match &self.sliding {
            Some(sliding) => sliding.worth_of_lengths(&lengths),
            None => lengths,
        };
        let mut worth: Vec<f64> =
            self.by_tension.iter().map(|column| column.worth(&twists, &lengths, at_base)).collect();
        let (mut commands, by_length, more) = match &self.sliding {
            Some(sliding) => {
                worth.extend(&tensions);
                sliding.pull_back(hold, &worth)
            }
            None => {
                add(&mut worth, 1.0, &tensions);
                let by_length = self.held.pull_back(hold, &worth);
                let by_commands = self.held.pull_back(Hold::Commands, &worth);
                let command = |i: usize| match self.cables[i].command {
                    Command::Length { .. } => -by_commands[i],
                    Command::Tension(_) => {
                        worth[i] - dot(&by_commands, &self.by_tension[i].lengths)
                    }
                };
                let more: Vec<f64> = by_length.iter().map(|by| -by).collect();
                ((0..cables).map(command).collect(), by_length, more)
            }
        };
        let lengths: Vec<f64> = lengths.iter().zip(&more).map(|(a, b)| a + b).collect();
        let asked = |(p, parameter): (usize, &ParameterChange)| match &self.sliding {
            Some(sliding) => sliding.worth_of(hold, &by_length, p),
            None => dot(&by_length, &parameter.targets),
        };
        // What a unit of each generalised force is worth.
        let mut by_motion = vec![0.0; system.coordinates];
        for (place, Twist { linear, angular }) in twists.iter().enumerate() {
            let parts = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z];
            for (component, part) in parts.into_iter().enumerate().filter(|(_, part)| *part != 0.0)
            {
                add(&mut by_motion, part, system.row(place, component));
            }
        }
        let rows = system.lengths.chunks_exact(system.coordinates.max(1));
        for (row, length) in rows.zip(&lengths) {
            add(&mut by_motion, *length, row);
        }
        let mut by_force = system.solve_transposed(&by_motion);
        let parts = [at_base.force, at_base.moment].map(<[f64; 3]>::from);
        let of_base = system.base.chunks_exact(system.coordinates.max(1));
        for (row, part) in of_base.zip(parts.into_iter().flatten()) {
            add(&mut by_force, part, row);
        }
        let mut pushes = Vec::new();
        if !self.contacts.places.is_empty() {
            pushes = (self.contacts.rows())
                .map(|(place, component)| {
                    let own = system.at_base(place, component);
                    dot(system.row(place, component), &by_force) + own.dot(at_base)
                })
                .collect::<Vec<f64>>();
            let mut by_contact = vec![0.0; system.coordinates];
            let gain = self.contacts.gain.chunks_exact(pushes.len());
            let mut motion = vec![0.0; pushes.len()];
            for (row, push) in gain.zip(&pushes) {
                add(&mut motion, *push, row);
            }
            for ((place, component), part) in self.contacts.rows().zip(motion) {
                add(&mut by_contact, part, system.row(place, component));
            }
            add(&mut by_force, 1.0, &system.solve_transposed(&by_contact));
        }
        let of_parameter = |(p, parameter): (usize, &ParameterChange)| {
            dot(&by_force, &parameter.force)
                + dot(&lengths, &parameter.lengths)
                + asked((p, parameter))
                + parameter.base.dot(at_base)
                + self.contacts.remembered.worth(Cause::Parameter(p), &pushes)
        };
        let wrench = |place: usize| {
            let [x, y, z, u, v, w] = core::array::from_fn(|component| {
                let own = system.at_base(place, component);
                dot(system.row(place, component), &by_force) + own.dot(at_base)
            });
            Wrench { force: Vec3::new(x, y, z), moment: Vec3::new(u, v, w) }
        };
        if !self.contacts.remembered.is_empty() {
            match hold {
                Hold::Commands => {
                    for (cable, command) in commands.iter_mut().enumerate() {
                        let cause = Cause::Command(cable);
                        *command += self.contacts.remembered.worth(cause, &pushes);
                    }
                }
                // By commands nothing else is held.
                _ => commands = self.pull_back(cotangent, Hold::Commands).commands,
            }
        }
        let parameters = self.parameters.iter().enumerate().map(of_parameter).collect();
        if let Some(on) = &self.moving_on {
            return Gradient { commands, parameters, ..on.pull_back(cotangent, hold) };
        }
        Gradient {
            commands,
            parameters,
            wrenches: (0..system.positions.len()).map(wrench).collect(),
            places: self.places.clone(),
        }
    }
}

impl Response {
    /// What it is worth at these sensitivities to places, outputs and base.
    fn worth(&self, twists: &[Twist], lengths: &[f64], base: &Wrench) -> f64 {
        let moved = |(a, b): (&Twist, &Twist)| a.linear.dot(b.linear) + a.angular.dot(b.angular);
        let moved: f64 = self.twists.iter().zip(twists).map(moved).sum();
        moved + dot(&self.lengths, lengths) + self.base.dot(base)
    }
}
