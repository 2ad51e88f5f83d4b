//! What is asked of a robot: how its cables are pulled and what loads it carries.

use whipcord_numerics::Vec3;

use crate::robot::{Problem, Robot, RobotError, check_on_backbone, limits};

/// What is asked of a robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Case {
    /// One for each cable of the robot.
    pub commands: Vec<CableCommand>,
    /// External loads.
    pub loads: Loads,
}

/// What one cable is told to do; a model uses what it is driven by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableCommand {
    /// Tension in N, not negative.
    pub tension: Option<f64>,
    /// Shortening of the part of the cable inside the robot; negative is paid out.
    pub shortening: Option<Shortening>,
}

/// Initial minus present length of a cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shortening {
    /// In m.
    Length(f64),
    /// As a fraction of the cable's own initial length.
    Fraction(f64),
}

/// Which of the two commands of a cable drives the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drive {
    /// What the model is driven by by nature where it is given, else the other; each cable by
    /// itself.
    #[default]
    Natural,
    /// All cables by their tension.
    Tension,
    /// All cables by their shortening.
    Shortening,
}

/// External loads, in the base frame unless they follow the body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// Acceleration of gravity in m/s², as a vector in the base frame.
    pub gravity: Option<Vec3>,
    /// Force at the backbone's tip in N.
    pub tip_force: Vec3,
    /// Moment at the backbone's tip in N·m.
    pub tip_moment: Vec3,
    /// Whether tip force and tip moment turn with the tip.
    pub tip_follower: bool,
    /// Forces and moments along the backbone.
    pub points: Vec<PointLoad>,
}

/// A force and a moment at one place of the backbone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointLoad {
    /// Arc length in m.
    pub at: f64,
    /// Force in N.
    pub force: Vec3,
    /// Moment in N·m.
    pub moment: Vec3,
    /// Whether they turn with the cross-section.
    pub follower: bool,
}

impl CableCommand {
    fn check(&self) -> Result<(), RobotError> {
        if let Some(tension) = self.tension {
            limits::TENSION.check("tension", tension)?;
        }
        match self.shortening {
            Some(Shortening::Length(length)) => limits::COORDINATE.check("shortening", length),
            Some(Shortening::Fraction(f)) => limits::FRACTION.check("shortening", f),
            None => Ok(()),
        }
    }
}

impl PointLoad {
    fn check(&self, length: f64) -> Result<(), RobotError> {
        check_on_backbone("at", self.at, length)?;
        limits::FORCE.check_vector("force", self.force)?;
        limits::MOMENT.check_vector("moment", self.moment)
    }
}

impl Loads {
    /// Whether there is no load at all.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.gravity.is_none_or(|g| g == Vec3::ZERO)
            && self.tip_force == Vec3::ZERO
            && self.tip_moment == Vec3::ZERO
            && self.points.iter().all(|p| p.force == Vec3::ZERO && p.moment == Vec3::ZERO)
    }

    /// Whether a load turns with the backbone. Such loads have no energy.
    #[must_use]
    pub fn has_follower(&self) -> bool {
        let acts = |force: Vec3, moment: Vec3| force != Vec3::ZERO || moment != Vec3::ZERO;
        (self.tip_follower && acts(self.tip_force, self.tip_moment))
            || self.points.iter().any(|p| p.follower && acts(p.force, p.moment))
    }
}

impl Shortening {
    /// In m, for a cable of this initial length.
    #[must_use]
    pub fn in_metres(self, initial_length: f64) -> f64 {
        match self {
            Self::Length(length) => length,
            Self::Fraction(fraction) => fraction * initial_length,
        }
    }
}

impl Case {
    /// The case with these tensions in N and no load.
    #[must_use]
    pub fn with_tensions(tensions: &[f64]) -> Self {
        let command = |&tension| CableCommand { tension: Some(tension), shortening: None };
        Self { commands: tensions.iter().map(command).collect(), loads: Loads::default() }
    }

    /// The case with these shortenings and no load.
    #[must_use]
    pub fn with_shortenings(shortenings: &[Shortening]) -> Self {
        let command = |&shortening| CableCommand { tension: None, shortening: Some(shortening) };
        Self { commands: shortenings.iter().map(command).collect(), loads: Loads::default() }
    }

    /// Checks that the case fits the robot and that every number in it can be.
    ///
    /// # Errors
    /// [`RobotError`] with the path of the offending quantity.
    pub fn check(&self, robot: &Robot) -> Result<(), RobotError> {
        let (given, cables) = (self.commands.len(), robot.cables().len());
        if given != cables {
            return Err(RobotError::new("cables", Problem::CableCount { given, cables }));
        }
        for (i, command) in self.commands.iter().enumerate() {
            command.check().map_err(|error| error.under(&format!("cables[{i}]")))?;
        }
        let loads = &self.loads;
        if let Some(gravity) = loads.gravity {
            limits::ACCELERATION.check_vector("loads.gravity", gravity)?;
        }
        limits::FORCE.check_vector("loads.tip_force", loads.tip_force)?;
        limits::MOMENT.check_vector("loads.tip_moment", loads.tip_moment)?;
        for (i, point) in loads.points.iter().enumerate() {
            point
                .check(robot.backbone().length)
                .map_err(|error| error.under(&format!("loads.point[{i}]")))?;
        }
        Ok(())
    }
}
