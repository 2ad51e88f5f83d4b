//! What the commands of a robot must not exceed.

use crate::error::InverseError;

/// What one cable must not exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableLimits {
    /// Least and greatest tension in N. The least is the pretension that keeps the cable taut.
    pub tension: [f64; 2],
    /// Least and greatest shortening in m, of the command: what cable and drive stretch outside of the robot included.
    pub shortening: [f64; 2],
    /// Greatest rate of the command in N/s or m/s.
    pub rate: Option<f64>,
}

impl Default for CableLimits {
    fn default() -> Self {
        Self {
            tension: [0.0, f64::INFINITY],
            shortening: [f64::NEG_INFINITY, f64::INFINITY],
            rate: None,
        }
    }
}

/// What the cables of a robot must not exceed; motors have their own limits ([`whipcord::MotorLimits`]), which hold as well.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Of each cable of the robot.
    pub cables: Vec<CableLimits>,
}

impl Limits {
    /// The same for so many cables.
    #[must_use]
    pub fn uniform(cables: usize, limits: CableLimits) -> Self {
        Self { cables: vec![limits; cables] }
    }

    /// # Errors
    /// [`InverseError`] where there is not one for each cable, or where nothing is between two limits.
    pub(crate) fn check(&self, cables: usize) -> Result<(), InverseError> {
        if self.cables.len() != cables {
            return Err(InverseError::LimitCount { given: self.cables.len(), cables });
        }
        for (cable, of) in self.cables.iter().enumerate() {
            let pairs = [("tension", of.tension), ("shortening", of.shortening)];
            for (what, [least, greatest]) in pairs {
                let is_empty = least.is_nan() || greatest.is_nan() || least > greatest;
                if is_empty || (what == "tension" && least < 0.0) {
                    return Err(InverseError::EmptyLimits { cable, what, least, greatest });
                }
            }
            if of.rate.is_some_and(|rate| rate.is_nan() || rate <= 0.0) {
                return Err(InverseError::Rate { cable });
            }
        }
        Ok(())
    }
}
