//! What a quantity may be. The limits lie far beyond every robot, and so near that no power or
//! quotient of quantities within them leaves the range of floating-point numbers.

use whipcord_numerics::{Pose, Vec3};

use super::error::{Problem, RobotError};
pub use super::range::{Range, number};

/// A length that must not vanish, such as the backbone's or a diameter: 1 nm to 1000 km.
pub const LENGTH: Range = Range::from(1e-9, 1e6, "m");
/// A length that may vanish, such as a cable's distance from the axis: to 1000 km.
pub const DISTANCE: Range = Range::from(0.0, 1e6, "m");
/// A coordinate, or the length by which a cable is shortened: to 1000 km either way.
pub const COORDINATE: Range = Range::either_way(1e6, "m");
/// By how much a cable is shortened, as a part of its length: not to less than nothing.
pub const FRACTION: Range = Range::from(-1e6, 1.0, "");
/// Young's and the shear modulus: from 1 Pa to far above that of diamond, 1.2 TPa, so that a rod
/// that does not stretch can be made up of a large modulus and a small diameter.
pub const MODULUS: Range = Range::from(1.0, 1e24, "Pa");
/// Poisson's ratio of a stable material; at −1 the shear modulus would be infinite.
pub const POISSON_RATIO: Range = Range { above: true, ..Range::from(-1.0, 0.5, "") };
/// A density: to far above that of osmium, 22 590 kg/m³, for the weight of a rod that stands for
/// something thicker; 0 for one whose own weight does not matter.
pub const DENSITY: Range = Range::from(0.0, 1e15, "kg/m³");
/// Mass per length of the backbone.
pub const LINEAR_DENSITY: Range = Range::from(0.0, 1e15, "kg/m");
/// The factor on the shear stiffness of a section.
pub const SHEAR_CORRECTION: Range = Range::from(1e-3, 10.0, "");
/// A section's stiffness against shear and extension, GA and EA: from that of a fibre as thin as a
/// nanometre to far above that of any robot, for a rod that hardly stretches.
pub const SECTION_STIFFNESS: Range = Range::from(1e-18, 1e36, "N");
/// A section's stiffness against bending and twist, EI and GJ.
pub const BENDING_STIFFNESS: Range = Range::from(1e-30, 1e36, "N·m²");
/// A factor on the stiffness of a segment of the backbone.
pub const STIFFNESS_FACTOR: Range = Range::from(1e-9, 1e9, "");
/// Greatest moment of the friction against bending of a section.
pub const YIELD_MOMENT: Range = Range::from(0.0, 1e12, "N·m");
/// An entry of the stiffness matrix beside its diagonal.
pub const COUPLING: Range = Range::either_way(1e36, "");
/// The strain up to which a material is elastic: from that of a brittle one to far above that of rubber.
pub const YIELD_STRAIN: Range = Range::from(1e-6, 100.0, "");
/// The mass of a disk, or of what the robot carries.
pub const MASS: Range = Range::from(0.0, 1e9, "kg");
/// A component of a curvature: to that of a circle as small as 1 nm.
pub const CURVATURE: Range = Range::either_way(1e9, "1/m");
/// An angle.
pub const ANGLE: Range = Range::either_way(1e9, "rad");
/// Turns of a helix.
pub const TURNS: Range = Range::either_way(1e6, "");
/// A coefficient of friction.
pub const FRICTION: Range = Range::from(0.0, 100.0, "");
/// A cable's axial stiffness.
pub const AXIAL_STIFFNESS: Range = Range::from(1e-9, 1e15, "N");
/// The stiffness of a drive with the cable outside the robot.
pub const DRIVE_STIFFNESS: Range = Range::from(1e-9, 1e15, "N/m");
/// Turns of a motor for one of its spool, either way.
pub const GEAR_RATIO: Range = Range::from(1e-6, 1e6, "");
/// Rate of a motor's angle.
pub const ANGULAR_RATE: Range = Range { above: true, ..Range::from(0.0, 1e9, "rad/s") };
/// Speed of a linear drive.
pub const SPEED: Range = Range { above: true, ..Range::from(0.0, 1e9, "m/s") };
/// Greatest torque of a motor.
pub const TORQUE: Range = Range::from(0.0, 1e12, "N·m");
/// Moment of inertia of a motor.
pub const MOTOR_INERTIA: Range = Range { above: true, ..Range::from(0.0, 1e9, "kg·m²") };
/// Mass that a linear drive moves.
pub const MOTOR_MASS: Range = Range { above: true, ..Range::from(0.0, 1e9, "kg") };
/// Proportional gain of the position loop of a motor, in N·m/rad or N/m: without it the motor would stay nowhere.
pub const PROPORTIONAL_GAIN: Range = Range { above: true, ..Range::from(0.0, 1e15, "") };
/// Another gain of the position loop of a motor, or its viscous friction.
pub const GAIN: Range = Range::from(0.0, 1e15, "");
/// A tension.
pub const TENSION: Range = Range::from(0.0, 1e12, "N");
/// A component of a force.
pub const FORCE: Range = Range::either_way(1e12, "N");
/// A component of a moment.
pub const MOMENT: Range = Range::either_way(1e12, "N·m");
/// A component of a force for each metre of the backbone.
pub const LINE_FORCE: Range = Range::either_way(1e12, "N/m");
/// A component of a moment for each metre of the backbone.
pub const LINE_MOMENT: Range = Range::either_way(1e12, "N·m/m");
/// A component of the acceleration of gravity.
pub const ACCELERATION: Range = Range::either_way(1e12, "m/s²");
/// A focal length, in pixels.
pub const FOCAL_LENGTH: Range = Range::from(1e-3, 1e9, "pixels");
/// The scale of an orthographic image: from a pixel for 1000 km to one for 1 pm.
pub const IMAGE_SCALE: Range = Range::from(1e-6, 1e12, "pixels/m");
/// A coordinate in an image.
pub const PIXEL: Range = Range::either_way(1e9, "pixels");
/// Columns or rows of an image.
pub const IMAGE_SIZE: Range = Range::from(1.0, 1e6, "pixels");
/// A coefficient of a lens's distortion, but for its tilt.
pub const DISTORTION_COEFFICIENT: Range = Range::either_way(1e6, "");
/// A tilt of a camera's sensor: at a right angle it would be seen edge-on.
pub const LENS_TILT: Range = Range::either_way(1.5, "rad");
/// An exponent of a superellipsoid: from all but a box to all but an octahedron; within it is convex.
pub const SUPERELLIPSOID_EXPONENT: Range = Range::from(0.1, 1.9, "");
/// A factor on the lengths of a triangle mesh.
pub const MESH_SCALE: Range = Range::from(1e-12, 1e12, "");
/// Most cables of a robot. Memory for the derivatives of their lengths grows with the square of their number.
pub const MOST_CABLES: usize = 100;
/// Most disks of a robot.
pub const MOST_DISKS: usize = 2_000;
/// Most integration steps that can be prescribed from base to tip: of a hundredth of them the error is that of rounding.
pub const MOST_STEPS: usize = 100_000;
/// Most stations.
pub const MOST_STATIONS: usize = 100_000;
/// Greatest coefficient of a polynomial, whatever its power.
const LARGEST_COEFFICIENT: f64 = 1e100;
/// Least distance in m between neighbouring disks.
pub(crate) const LEAST_PITCH: f64 = 1e-15;

impl Range {
    /// The range of the coefficient of `s^power` of a cable's coordinate on a backbone of this
    /// length: the term stays a [`COORDINATE`] all along it.
    pub(crate) fn of_coefficient(power: usize, length: f64) -> Self {
        let reach = length.powf(power as f64);
        // A power of ten, which is short in a message.
        let digits = (COORDINATE.greatest / reach).log10() + 1e-9;
        Self::either_way(10.0_f64.powi(digits.floor() as i32).min(LARGEST_COEFFICIENT), "")
    }

    /// What is wrong with a value, if anything.
    #[must_use]
    pub fn problem(self, value: f64) -> Option<Problem> {
        let Self { least, above, greatest, .. } = self;
        if !value.is_finite() {
            Some(Problem::NotFinite { value })
        } else if least > 0.0 && value <= 0.0 {
            Some(Problem::NotPositive { value })
        } else if least == 0.0 && value < 0.0 {
            Some(Problem::Negative { value })
        } else if value < least || value > greatest || (above && value <= least) {
            Some(Problem::OutOfRange { value, range: self })
        } else {
            None
        }
    }

    pub(crate) fn check(self, path: &str, value: f64) -> Result<(), RobotError> {
        match self.problem(value) {
            None => Ok(()),
            Some(problem) => Err(RobotError::new(path, problem)),
        }
    }

    /// The same of every component.
    pub(crate) fn check_vector(self, path: &str, value: Vec3) -> Result<(), RobotError> {
        match (0..3).find(|&i| self.problem(value[i]).is_some()) {
            Some(i) => self.check(&format!("{path}[{i}]"), value[i]),
            None => Ok(()),
        }
    }
}

/// Refuses a list of more than `most` entries.
pub(crate) fn check_count(path: &str, given: usize, most: usize) -> Result<(), RobotError> {
    if given > most {
        return Err(RobotError::new(path, Problem::TooMany { given, most }));
    }
    Ok(())
}

/// Refuses a number that asks for more memory and time than an answer is worth.
pub(crate) fn check_number(path: &str, given: usize, most: usize) -> Result<(), RobotError> {
    if given > most {
        return Err(RobotError::new(path, Problem::TooGreat { given, most }));
    }
    Ok(())
}

/// How far the norm of a unit quaternion may be from 1 by rounding.
const UNIT_TOLERANCE: f64 = 1e-12;

/// Refuses a pose that is too far off, or whose quaternion is no rotation.
pub(crate) fn check_pose(pose: &Pose) -> Result<(), RobotError> {
    COORDINATE.check_vector("position", pose.position)?;
    let [w, x, y, z] = pose.rotation.wxyz();
    let norm = (w * w + x * x + y * y + z * z).sqrt();
    if norm.is_nan() || (norm - 1.0).abs() > UNIT_TOLERANCE {
        return Err(RobotError::new("orientation", Problem::NotUnit { norm }));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_is_told_apart() {
        let told = |range: Range, value| range.problem(value).map(|problem| problem.to_string());
        assert_eq!(told(LENGTH, 1e-9), None);
        assert_eq!(told(LENGTH, 0.0).as_deref(), Some("must be greater than zero, but is 0"));
        assert_eq!(
            told(LENGTH, 1e-300).as_deref(),
            Some("must be at least 1e-9 m, but is 1e-300 m")
        );
        assert_eq!(told(LENGTH, 1e300).as_deref(), Some("must be at most 1e6 m, but is 1e300 m"));
        assert_eq!(told(DISTANCE, -0.0), None);
        assert_eq!(told(DISTANCE, -1.0).as_deref(), Some("must not be negative, but is -1"));
        assert_eq!(
            told(POISSON_RATIO, -1.0).as_deref(),
            Some("must be greater than -1, but is -1")
        );
        assert_eq!(told(POISSON_RATIO, 0.5), None);
        assert_eq!(
            told(COORDINATE, -2e6).as_deref(),
            Some("must be at least -1e6 m, but is -2e6 m")
        );
        assert_eq!(told(FORCE, f64::NAN).as_deref(), Some("must be a finite number, but is NaN"));
    }

    #[test]
    fn coefficients_are_bounded_by_what_they_reach() {
        assert_eq!(Range::of_coefficient(2, 1e-9).greatest, 1e24);
        assert_eq!(Range::of_coefficient(40, 1e-9).greatest, LARGEST_COEFFICIENT);
        assert_eq!(Range::of_coefficient(80, 1e6).greatest, 0.0);
    }
}
