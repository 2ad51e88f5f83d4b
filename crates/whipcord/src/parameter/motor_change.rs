//! How what a motor makes of a cable changes with a parameter.

use super::quantity::Parameter;
use crate::case::Case;
use crate::robot::{Cable, Motor, MotorCable, Robot};

/// Changes of what the length of a cable inside the robot is, eq. (1) of the page on motors, with a parameter.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MotorChange {
    /// Of the commanded shortening in m.
    pub shortening: f64,
    /// Of the compliance in m/N, the lengths at rest held.
    pub compliance: f64,
    /// Of the pretension in N.
    pub pretension: f64,
}

impl MotorChange {
    /// Of a cable that is this long at rest in m.
    pub fn new(
        parameter: &Parameter,
        robot: &Robot,
        case: &Case,
        cable: usize,
        rest_length: f64,
    ) -> Self {
        let none = Self::default();
        let this = &robot.cables()[cable];
        let driven = robot.motor_of(cable).map(|number| (number, &robot.motors()[number]));
        if let Parameter::AxialStiffness { cable: of } = *parameter {
            let free = driven.map_or(0.0, |(_, motor)| motor.free_length);
            let compliance = this.axial_stiffness.map_or(0.0, |k| -(rest_length + free) / (k * k));
            return if of == cable { Self { compliance, ..none } } else { none };
        }
        let Some((number, motor)) = driven.filter(|(number, _)| parameter.motor() == Some(*number))
        else {
            return none;
        };
        let Some(place) = motor.cables.iter().position(|of| of.cable == cable) else { return none };
        Self::of_motor(parameter, (number, motor), place, this, case)
    }

    fn of_motor(
        parameter: &Parameter,
        (number, motor): (usize, &Motor),
        place: usize,
        cable: &Cable,
        case: &Case,
    ) -> Self {
        let none = Self::default();
        let of: &MotorCable = &motor.cables[place];
        match *parameter {
            Parameter::MotorStiffness { .. } => {
                let compliance = motor.stiffness.map_or(0.0, |k| -1.0 / (k * k));
                Self { compliance, ..none }
            }
            Parameter::FreeLength { .. } => {
                Self { compliance: cable.axial_stiffness.map_or(0.0, f64::recip), ..none }
            }
            Parameter::Pretension { .. } => Self { pretension: 1.0, ..none },
            Parameter::SpoolRadius { entry, .. } if entry.is_none_or(|entry| entry == place) => {
                let [output, _] = output(motor, number, case, parameter);
                Self { shortening: output * of.pull().signum(), ..none }
            }
            Parameter::GearRatio { .. }
            | Parameter::Backlash { .. }
            | Parameter::MotorOffset { .. }
            | Parameter::MotorCommand { .. } => {
                let [_, rate] = output(motor, number, case, parameter);
                Self { shortening: of.pull() * rate, ..none }
            }
            _ => none,
        }
    }
}

/// Where the spool or the drive of a motor is in the last step of a case, eq. (2), and how that changes with a parameter.
fn output(motor: &Motor, number: usize, case: &Case, parameter: &Parameter) -> [f64; 2] {
    let ratio = motor.gear_ratio();
    let mut state = [0.0; 2];
    let last = case.motors.len();
    let commands = (1..).zip(&case.motors);
    for (step, command) in commands.filter_map(|(k, step)| Some((k, (*step.get(number)?)?))) {
        let output = motor.output(state[0], command);
        let asked = motor.asked(command);
        // Within its play a drive does not move.
        if output == state[0] && (output - asked).abs() < 0.5 * motor.backlash {
            continue;
        }
        let rate = match parameter {
            Parameter::MotorCommand { .. } if step == last => 1.0 / ratio,
            Parameter::GearRatio { .. } => -asked / ratio,
            Parameter::MotorOffset { .. } => -1.0 / ratio,
            Parameter::Backlash { .. } if output != asked => 0.5 * (output - asked).signum(),
            // Without play the side is that to which the drive goes.
            Parameter::Backlash { .. } if output != state[0] => 0.5 * (state[0] - output).signum(),
            _ => 0.0,
        };
        state = [output, rate];
    }
    state
}
