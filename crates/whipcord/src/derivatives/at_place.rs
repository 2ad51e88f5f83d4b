//! What is to be said of one place: Jacobians, compliance, stiffness.

use whipcord_numerics::Twist;

use super::change::Place;
use super::column::Source;
use super::local::local;
use super::node_change::NodeChange;
use super::rod::Derivatives;
use super::sliding_holes::Cause;
use crate::kinematics::{Local, Matrix6};
use crate::statics::hold::Hold;

impl Derivatives {
    /// The actuation Jacobian of a place: for the command of each cable ([`Self::command`]) the
    /// velocity of the place's point and its angular velocity, base frame.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn actuation_jacobian(&self, at: Place) -> Vec<Twist> {
        if !self.touching.remembered.is_empty() {
            return self.commands().iter().map(|change| change.twist(at)).collect();
        }
        let node = self.places.number(at);
        self.jacobian(|place| self.twist_of(node, &self.pulled(place, Hold::Commands)[0]))
    }

    /// How the length of each cable changes with the command of each, in m by N of tension or m of
    /// shortening: by rows of lengths.
    #[must_use]
    pub fn length_by_command(&self) -> Vec<Vec<f64>> {
        self.lengths_by(Hold::Commands)
    }

    /// How the length of each cable changes with the command of each, or with the tension.
    fn lengths_by(&self, hold: Hold) -> Vec<Vec<f64>> {
        let by = |&place: &usize| {
            let mut outputs = match hold {
                Hold::Commands => self.remembered(Cause::Command(place)).lengths,
                Hold::Tensions | Hold::Lengths => vec![0.0; self.strands.outputs()],
            };
            for (column, &tension) in self.by_tension.iter().zip(&self.pulled(place, hold)[0]) {
                outputs.iter_mut().zip(&column.lengths).for_each(|(out, by)| *out += tension * by);
            }
            self.cable_lengths(outputs)
        };
        let columns: Vec<Vec<f64>> = self.place_of.iter().map(by).collect();
        let row = |&i: &usize| columns.iter().map(|lengths| lengths[i]).collect();
        self.place_of.iter().map(row).collect()
    }

    /// The Jacobian of a place by the tensions of all cables in N, whatever drives them.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn tension_jacobian(&self, at: Place) -> Vec<Twist> {
        if let Some(on) = &self.moving_on {
            return on.tension_jacobian(at);
        }
        let node = self.places.number(at);
        self.jacobian(|place| self.twist_of(node, &self.pulled(place, Hold::Tensions)[0]))
    }

    fn jacobian(&self, column: impl Fn(usize) -> Twist) -> Vec<Twist> {
        self.place_of.iter().map(|&place| column(place)).collect()
    }

    fn twist_of(&self, node: usize, tensions: &[f64]) -> Twist {
        let mut change = NodeChange::default();
        for (column, &tension) in self.by_tension.iter().zip(tensions) {
            change.add(tension, &column.nodes[node]);
        }
        change.twist()
    }

    /// The compliance of a place: its motion under a dead wrench that is applied to it.
    ///
    /// # Errors
    /// [`crate::SolveError::NoDerivatives`] where the robot is so near to buckling that it is not
    /// finite.
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn compliance(&self, at: Place, hold: Hold) -> Result<Matrix6, crate::SolveError> {
        if let Some(on) = &self.moving_on {
            return on.compliance(at, hold);
        }
        let node = self.places.number(at);
        let mut columns = [Twist::default(); 6];
        for (component, column) in columns.iter_mut().enumerate() {
            let raw = self.raw(Source::Wrench { node, component });
            let [tensions, _] = self.tensions(hold, &raw.lengths, Cause::Nothing);
            let (free, pulled) = (raw.nodes[node].twist(), self.twist_of(node, &tensions));
            *column = free + pulled;
            if !(column.linear.is_finite() && column.angular.is_finite()) {
                return Err(crate::SolveError::NoDerivatives);
            }
        }
        Ok(Matrix6::from_columns(&columns))
    }

    /// The stiffness of a place, the inverse of its compliance; `None` where it cannot move in every
    /// direction, as at the base.
    ///
    /// # Errors
    /// As [`Self::compliance`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn stiffness(&self, at: Place, hold: Hold) -> Result<Option<Matrix6>, crate::SolveError> {
        Ok(self.compliance(at, hold)?.inverse(self.length))
    }

    /// All that is to be said of one place.
    ///
    /// # Errors
    /// As [`Self::compliance`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn at(&self, place: Place) -> Result<Local, crate::SolveError> {
        let commands = self.place_of.iter().map(|&grid| &self.commands[grid]);
        let jacobians = (self.actuation_jacobian(place), self.length_by_command());
        let caveats = (self.one_sided(), self.are_lengths_dependent(Hold::Commands));
        local(self.length, commands, jacobians, |hold| self.compliance(place, hold), caveats)
    }

    /// How the lengths of the cables change with their tensions in m/N, all others held: by rows of
    /// lengths. Symmetric and not positive under dead forces.
    #[must_use]
    pub fn length_by_tension(&self) -> Vec<Vec<f64>> {
        if let Some(on) = &self.moving_on {
            return on.length_by_tension();
        }
        self.lengths_by(Hold::Tensions)
    }
}
