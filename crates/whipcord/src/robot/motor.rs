//! Motors that pull cables: spools and linear drives outside the robot.

use super::cable::Cable;
use super::error::{Problem, RobotError};
use super::limits;

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
            drive,
            cables: cables.into_iter().map(of_cable).collect(),
            stiffness: None,
            free_length: 0.0,
            pretension: 0.0,
            backlash: 0.0,
            offset: 0.0,
            limits: MotorLimits::default(),
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

    /// Where the spool or the drive is after the motor has gone to a command, from where it was before: the play operator
    ///
    /// ```text
    /// φ = max(x − b/2, min(x + b/2, φ₀)),    x = (θ − θ₀)/n                               (2)
    /// ```
    ///
    /// with the command θ, the offset θ₀, the gear ratio n and the backlash b. At first the drive is in the middle of its play.
    #[must_use]
    pub fn output(&self, before: f64, command: f64) -> f64 {
        let asked = (command - self.offset) / self.gear_ratio();
        let half = 0.5 * self.backlash;
        before.clamp(asked - half, asked + half)
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

    /// The same motor with a command that a check found to be possible, else what is wrong.
    pub(crate) fn check_command(&self, command: f64) -> Result<(), Problem> {
        let (possible, unit) = match self.drive {
            Drive::Spool { .. } => (limits::ANGLE, "rad"),
            Drive::Linear => (limits::COORDINATE, "m"),
        };
        if let Some(problem) = possible.problem(command) {
            return Err(problem);
        }
        match self.limits.range {
            Some([least, greatest]) if !(least..=greatest).contains(&command) => {
                Err(Problem::BeyondMotorLimit { value: command, least, greatest, unit })
            }
            _ => Ok(()),
        }
    }

    /// Checks the numbers of a motor of a robot that has these cables.
    fn check(&self, cables: &[Cable]) -> Result<(), RobotError> {
        let (command, rate, effort, pull) = match self.drive {
            Drive::Spool { gear_ratio } => {
                limits::GEAR_RATIO.check("gear_ratio", gear_ratio.abs())?;
                ("angle", limits::ANGULAR_RATE, limits::TORQUE, "spool_radius")
            }
            Drive::Linear => ("travel", limits::SPEED, limits::TENSION, "cables"),
        };
        let [offset, range, most_rate, most_effort] = match self.drive {
            Drive::Spool { .. } => ["angle_offset", "angle_limits", "rate_limit", "torque_limit"],
            Drive::Linear => ["travel_offset", "travel_limits", "rate_limit", "force_limit"],
        };
        let possible = if command == "angle" { limits::ANGLE } else { limits::COORDINATE };
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
        possible.check(offset, self.offset)?;
        if let Some([least, greatest]) = self.limits.range {
            possible.check(&format!("{range}[0]"), least)?;
            possible.check(&format!("{range}[1]"), greatest)?;
            if least >= greatest {
                return Err(RobotError::new(range, Problem::NotAscending { least, greatest }));
            }
        }
        if let Some(limit) = self.limits.rate {
            rate.check(most_rate, limit)?;
        }
        if let Some(limit) = self.limits.effort {
            effort.check(most_effort, limit)?;
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
                Problem::DuplicateMotor { name: motor.name.clone(), first },
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
