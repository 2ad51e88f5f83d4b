//! How large a change of a parameter matters.

use super::quantity::Parameter;
use crate::case::Case;
use crate::robot::Robot;

/// Standard gravity in m/s².
const GRAVITY: f64 = 9.806_65;

impl Parameter {
    /// A change of the parameter that matters to a robot whose bending stiffness over its length is `moment` in N·m: of the
    /// size of its value, or of what bends the robot where that is less.
    pub(crate) fn scale(&self, robot: &Robot, case: &Case, moment: f64) -> f64 {
        let length = robot.backbone().length;
        let value = self.value(robot, case).map_or(0.0, f64::abs);
        let force = moment / length;
        let natural = match *self {
            Self::YoungModulus
            | Self::ShearModulus
            | Self::Density
            | Self::LinearDensity
            | Self::ShearCorrection
            | Self::Diameter
            | Self::DiameterAt { .. }
            | Self::InnerDiameter
            | Self::Width
            | Self::Height
            | Self::MotorStiffness { .. }
            | Self::GearRatio { .. }
            | Self::AxialStiffness { .. } => 0.0,
            Self::PoissonRatio | Self::Friction { .. } => 0.1,
            Self::YieldMoment { .. } => 0.1 * moment,
            Self::Stiffness { .. } | Self::YieldStiffness { .. } => 0.1 * moment * length,
            Self::StiffnessScale(_)
            | Self::SegmentFactor { .. }
            | Self::Angle { .. }
            | Self::HoleAngle { .. } => 1.0,
            Self::Turns { .. } => 0.1,
            Self::RestCurvature { .. } | Self::RestCurvatureAt { .. } => 0.1 / length,
            Self::HoleRadius
            | Self::HoleRadiusAt { .. }
            | Self::Radius { .. }
            | Self::SpoolRadius { .. }
            | Self::FreeLength { .. }
            | Self::Start { .. }
            | Self::End { .. } => 0.01 * length,
            Self::Coefficient { power, .. } => 0.01 * length / length.powi(power.min(64) as i32),
            Self::Gravity { .. } => GRAVITY,
            Self::TipForce { .. } | Self::PointForce { .. } | Self::Pretension { .. } => force,
            Self::Backlash { motor }
            | Self::MotorOffset { motor }
            | Self::MotorCommand { motor } => {
                robot.motors().get(motor).map_or(0.0, |motor| motor.command_scale(length))
            }
            Self::TipMoment { .. } | Self::PointMoment { .. } => moment,
            Self::DiskMass | Self::PointMass { .. } => force / GRAVITY,
            Self::LineForce { .. } | Self::LineForceAt { .. } => force / length,
            Self::LineMoment { .. } | Self::LineMomentAt { .. } => force,
        };
        value.max(natural)
    }
}
