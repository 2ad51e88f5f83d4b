//! How the tip and the lengths of the cables change with each tension at constant other tensions, and from this with each command, in memory that is
//! kept from one answer to the next.

use whipcord_numerics::Twist;

use crate::robot::Robot;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::hold::{Critical, HeldCables, Hold, HoldScratch};

/// The cables of an answer and what drives them.
#[derive(Clone, Copy)]
pub(crate) struct DrivenCables<'a> {
    pub robot: &'a Robot,
    /// The cables in an order that what follows has.
    pub order: &'a [usize],
    /// In m.
    pub rest_lengths: &'a [f64],
    pub commands: &'a [Command],
    pub taut: &'a [bool],
}

/// The rates of an answer, in the order of its cables.
#[derive(Clone, Debug, Default)]
pub(crate) struct TensionRates {
    tips: Vec<Twist>,
    /// Of the length of cable j with the tension of cable i at `[i * cables + j]`.
    lengths: Vec<f64>,
    held: HeldCables,
    scratch: HoldScratch,
    tensions: Vec<f64>,
}

/// What a model keeps for the rates of an answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct TensionRatesMemory {
    /// The answer, found again.
    pub answer: Option<Solution>,
    pub rates: TensionRates,
    /// The cables in their order, and which of them are taut.
    pub order: Vec<usize>,
    pub taut: Vec<bool>,
}

impl TensionRates {
    /// Forgets the answer before.
    pub fn clear(&mut self) {
        self.tips.clear();
        self.lengths.clear();
    }

    /// Takes the rate of the tip with the next tension, base frame; the rates of the lengths of so many cables are to be filled in.
    pub fn push(&mut self, tip: Twist, cables: usize) -> &mut [f64] {
        self.tips.push(tip);
        let first = self.lengths.len();
        self.lengths.resize(first + cables, 0.0);
        &mut self.lengths[first..]
    }

    /// Velocity of the point of the tip and its angular velocity, base frame, for the command of each cable of the robot.
    pub fn by_commands(
        &mut self,
        of: DrivenCables<'_>,
        out: &mut Vec<Twist>,
    ) -> Result<(), Critical> {
        let DrivenCables { robot, order, rest_lengths, commands, taut } = of;
        let Self { tips, lengths, held, scratch, tensions } = self;
        let cables = order.len();
        held.renew(
            cables,
            |i, j| lengths[j * cables + i],
            |place| robot.cable_compliance(order[place], rest_lengths[place]),
            |place| taut[place],
            |place| commands[place].is_length(),
        )?;
        held.settle_driven();
        out.clear();
        out.resize(cables, Twist::default());
        for (place, &cable) in order.iter().enumerate() {
            let by_tension = &lengths[place * cables..(place + 1) * cables];
            let of_command = (place, !commands[place].is_length(), by_tension);
            held.commanded_into(Hold::Commands, of_command, scratch, tensions);
            let change = &mut out[cable];
            for (tip, &tension) in tips.iter().zip(&*tensions) {
                change.linear += tension * tip.linear;
                change.angular += tension * tip.angular;
            }
        }
        let is_finite = |twist: &Twist| twist.linear.is_finite() && twist.angular.is_finite();
        if out.iter().all(is_finite) { Ok(()) } else { Err(Critical) }
    }
}
