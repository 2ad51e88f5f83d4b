//! Motors that pull cables: spools and linear drives outside the robot.

use super::cable::Cable;
use super::error::{Problem, RobotError};
use super::limits;
use super::motor_dynamics::MotorDynamics;
use super::range::Range;

/// A motor that pulls one or several cables outside the robot.
///
/// Its command is the angle of a motor with a spool in rad, or the travel of a linear drive in m. A cable `i` of the motor is
/// shortened by `rᵢ φ`, with the motion `φ` of the spool or the drive behind gear and backlash ([`Motor::output`]) and the
/// pull `rᵢ`; its part inside the robot is longer than that by `cᵢ (τᵢ − T₀)`, with the pretension `T₀` and the compliance `cᵢ` of
/// cable and drive ([`crate::Robot::cable_compliance`]): eq. (1) of the page on motors.
#[derive(Clone, Debug, PartialEq)]
pub struct Motor {
    /// Name, unique in the robot.
    pub name: String,
    /// Group of motors that it belongs to. Motors of a group can share parameters in a fit.
    pub group: Option<String>,
    /// How the motor moves its cables.
    pub drive: Drive,
    /// The cables that it pulls; a cable belongs to one motor at most.
    pub cables: Vec<MotorCable>,
    /// Stiffness in N/m of drive and cable outside the robot, of each cable by itself; `None` is rigid.
    pub stiffness: Option<f64>,
    /// Length in m of each cable between the motor and the base, which stretches as the cable inside does.
    pub free_length: f64,
    /// Tension in N of each cable where the motor is at [`Self::offset`] and the robot has its shape at rest.
    pub pretension: f64,
    /// Play of the drive: by how much the motion of the spool (rad) or of the drive (m) falls behind when the motor turns back.
    pub backlash: f64,
    /// The command at which the motor shortens no cable, in rad or m.
    pub offset: f64,
    /// What the motor cannot exceed.
    pub limits: MotorLimits,
    /// Its inertia and position loop in a motion; `None` is a motor that is always where its command says.
    pub dynamics: Option<MotorDynamics>,
}

/// How a motor moves its cables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// A spool, behind a gear: turns of the motor for one of the spool.
    Spool {
        /// The ratio, not 0; negative where the spool turns the other way.
        gear_ratio: f64,
    },
    /// A linear drive.
    Linear,
}

/// What the quantities of a motor are called in files, tables and messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveKeys {
    /// The command.
    pub command: &'static str,
    /// The command at which the motor shortens no cable.
    pub offset: &'static str,
    /// Least and greatest command.
    pub limits: &'static str,
    /// What the motor holds.
    pub effort: &'static str,
    /// The greatest of it.
    pub effort_limit: &'static str,
}

impl Drive {
    /// What the quantities of a motor with this drive are called.
    #[must_use]
    pub const fn keys(self) -> DriveKeys {
        match self {
            Self::Spool { .. } => DriveKeys {
                command: "angle",
                offset: "angle_offset",
                limits: "angle_limits",
                effort: "torque",
                effort_limit: "torque_limit",
            },
            Self::Linear => DriveKeys {
                command: "travel",
                offset: "travel_offset",
                limits: "travel_limits",
                effort: "force",
                effort_limit: "force_limit",
            },
        }
    }

    /// What a command may be.
    const fn commands(self) -> Range {
        match self {
            Self::Spool { .. } => limits::ANGLE,
            Self::Linear => limits::COORDINATE,
        }
    }
}

/// A cable of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorCable {
    /// Its number in the robot.
    pub cable: usize,
    /// Radius of its spool in m; 1 for a linear drive.
    pub radius: f64,
    /// Whether the motor pays the cable out when it goes forward.
    pub is_reversed: bool,
}

impl MotorCable {
    /// By how much the motor shortens the cable for a motion of 1 of its spool or drive: `rᵢ`, in m/rad or m/m.
    #[must_use]
    pub const fn pull(&self) -> f64 {
        if self.is_reversed { -self.radius } else { self.radius }
    }

    /// The name of the cable with its sign, as a motor of a robot file has it.
    #[must_use]
    pub fn signed(&self, name: &str) -> String {
        if self.is_reversed { format!("-{name}") } else { name.to_owned() }
    }
}

/// What a motor cannot exceed; `None` is no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorLimits {
    /// Least and greatest command in rad or m.
    pub range: Option<[f64; 2]>,
    /// Greatest rate of the command in rad/s or m/s.
    pub rate: Option<f64>,
    /// Greatest torque of the motor in N·m, or force of a linear drive in N.
    pub effort: Option<f64>,
}

impl Motor {
    /// A motor with a spool of this radius in m for each of these cables, negative where it pays the cable out; without a gear.
    #[must_use]
    pub fn spool(name: impl Into<String>, cables: impl IntoIterator<Item = (usize, f64)>) -> Self {
        Self::new(name.into(), Drive::Spool { gear_ratio: 1.0 }, cables)
    }

    /// A linear drive that pulls each of these cables, or pays it out where the second number is −1.
    #[must_use]
    pub fn linear(name: impl Into<String>, cables: impl IntoIterator<Item = (usize, f64)>) -> Self {
        Self::new(name.into(), Drive::Linear, cables)
    }

    fn new(name: String, drive: Drive, cables: impl IntoIterator<Item = (usize, f64)>) -> Self {
        let of_cable = |(cable, pull): (usize, f64)| MotorCable {
            cable,
            radius: pull.abs(),
            is_reversed: pull < 0.0,
        };
        Self {
            name,
            group: None,
            drive,
            cables: cables.into_iter().map(of_cable).collect(),
            stiffness: None,
            free_length: 0.0,
            pretension: 0.0,
            backlash: 0.0,
            offset: 0.0,
            limits: MotorLimits::default(),
            dynamics: None,
        }
    }

    /// Motion of the motor for one of the spool; 1 of a linear drive.
    #[must_use]
    pub const fn gear_ratio(&self) -> f64 {
        match self.drive {
            Drive::Spool { gear_ratio } => gear_ratio,
            Drive::Linear => 1.0,
        }
    }

    /// Where a command leads the spool or the drive without play: `x` of eq. (2).
    pub(crate) fn asked(&self, command: f64) -> f64 {
        (command - self.offset) / self.gear_ratio()
    }

    /// Where the spool or the drive is after the motor has gone to a command, from where it was before: the play operator
    ///
    /// ```text
    /// φ = max(x − b/2, min(x + b/2, φ₀)),    x = (θ − θ₀)/n                               (2)
    /// ```
    ///
    /// with the command θ, the offset θ₀, the gear ratio n and the backlash b. At first the drive is in the middle of its play.
    #[must_use]
    pub fn output(&self, before: f64, command: f64) -> f64 {
        let (asked, half) = (self.asked(command), 0.5 * self.backlash);
        before.min(asked + half).max(asked - half)
    }

    /// A change of the command that matters to a robot of this length in m.
    #[must_use]
    pub fn command_scale(&self, length: f64) -> f64 {
        match self.drive {
            Drive::Spool { gear_ratio } => 0.1 * gear_ratio.abs(),
            Drive::Linear => 0.01 * length,
        }
    }

    /// Torque of the motor in N·m, or force of the linear drive in N, at these tensions of all cables of the robot:
    /// `Σ rᵢ τᵢ/n`. The gear has no losses. `None` where a tension is not known.
    #[must_use]
    pub fn effort(&self, tension: impl Fn(usize) -> Option<f64>) -> Option<f64> {
        let pulls = self.cables.iter().map(|of| Some(of.pull() * tension(of.cable)?));
        Some(pulls.sum::<Option<f64>>()? / self.gear_ratio())
    }

    /// What is outside the robot of a cable of this kind.
    fn outside(&self, cable: &Cable) -> Outside {
        let drive = self.stiffness.map_or(0.0, f64::recip);
        let free = cable.axial_stiffness.map_or(0.0, |stiffness| self.free_length / stiffness);
        Outside { compliance: drive + free, pretension: self.pretension }
    }

    /// Checks that the motor can take a command.
    ///
    /// # Errors
    /// [`Problem`] where it is no number for such a drive or beyond the limits of the motor.
    pub fn check_command(&self, command: f64) -> Result<(), Problem> {
        let possible = self.drive.commands();
        if let Some(problem) = possible.problem(command) {
            return Err(problem);
        }
        match self.limits.range {
            Some([least, greatest]) if !(least..=greatest).contains(&command) => {
                let unit = possible.unit;
                Err(Problem::BeyondMotorLimit { value: command, least, greatest, unit })
            }
            _ => Ok(()),
        }
    }

    /// Checks the numbers of a motor of a robot that has these cables.
    fn check(&self, cables: &[Cable]) -> Result<(), RobotError> {
        let (rate, effort, pull) = match self.drive {
            Drive::Spool { gear_ratio } => {
                limits::GEAR_RATIO.check("gear_ratio", gear_ratio.abs())?;
                (limits::ANGULAR_RATE, limits::TORQUE, "spool_radius")
            }
            Drive::Linear => (limits::SPEED, limits::TENSION, "cables"),
        };
        let (keys, possible) = (self.drive.keys(), self.drive.commands());
        if self.cables.is_empty() {
            return Err(RobotError::new("cables", Problem::TooFew { given: 0, least: 1 }));
        }
        for (k, of) in self.cables.iter().enumerate() {
            if of.cable >= cables.len() {
                let problem = Problem::NoSuchCable { given: of.cable + 1, cables: cables.len() };
                return Err(RobotError::new(format!("cables[{k}]"), problem));
            }
            limits::LENGTH.check(&format!("{pull}[{k}]"), of.radius)?;
        }
        if let Some(stiffness) = self.stiffness {
            limits::DRIVE_STIFFNESS.check("stiffness", stiffness)?;
        }
        limits::DISTANCE.check("free_length", self.free_length)?;
        limits::TENSION.check("pretension", self.pretension)?;
        limits::DISTANCE.check("backlash", self.backlash)?;
        possible.check(keys.offset, self.offset)?;
        if let Some([least, greatest]) = self.limits.range {
            possible.check(&format!("{}[0]", keys.limits), least)?;
            possible.check(&format!("{}[1]", keys.limits), greatest)?;
            if least >= greatest {
                return Err(RobotError::new(
                    keys.limits,
                    Problem::NotAscending { least, greatest },
                ));
            }
        }
        if let Some(limit) = self.limits.rate {
            rate.check("rate_limit", limit)?;
        }
        if let Some(limit) = self.limits.effort {
            effort.check(keys.effort_limit, limit)?;
        }
        if let Some(dynamics) = &self.dynamics {
            dynamics.check(match self.drive {
                Drive::Spool { .. } => limits::MOTOR_INERTIA,
                Drive::Linear => limits::MOTOR_MASS,
            })?;
        }
        let elastic = |of: &MotorCable| {
            self.stiffness.is_some() || cables[of.cable].axial_stiffness.is_some()
        };
        if self.pretension > 0.0 && !self.cables.iter().all(elastic) {
            return Err(RobotError::new("pretension", Problem::RigidUnderPretension));
        }
        Ok(())
    }
}

/// What a cable has outside the robot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outside {
    /// Of drive and cable, in m/N.
    pub compliance: f64,
    /// Tension in N at which cable and drive have the lengths that commands count from.
    pub pretension: f64,
}

/// What each of these cables has outside the robot.
pub(super) fn outside(motors: &[Motor], cables: &[Cable]) -> Vec<Outside> {
    let mut outside = vec![Outside::default(); cables.len()];
    for motor in motors {
        for of in &motor.cables {
            outside[of.cable] = motor.outside(&cables[of.cable]);
        }
    }
    outside
}

/// Checks the motors of a robot with these cables.
pub(super) fn check(motors: &[Motor], cables: &[Cable]) -> Result<(), RobotError> {
    limits::check_count("motors", motors.len(), limits::MOST_CABLES)?;
    let mut motor_of = vec![None; cables.len()];
    for (index, motor) in motors.iter().enumerate() {
        let path = format!("motors[{index}]");
        if let Some(first) = motors[..index].iter().position(|m| m.name == motor.name) {
            return Err(RobotError::new(
                format!("{path}.name"),
                Problem::DuplicateName { what: "motor", name: motor.name.clone(), first },
            ));
        }
        motor.check(cables).map_err(|error| error.under(&path))?;
        for (k, of) in motor.cables.iter().enumerate() {
            if let Some(first) = motor_of[of.cable].replace(index) {
                return Err(RobotError::new(
                    format!("{path}.cables[{k}]"),
                    Problem::TwoMotors {
                        cable: cables[of.cable].name.clone(),
                        motor: motors[first].name.clone(),
                    },
                ));
            }
        }
    }
    Ok(())
}
