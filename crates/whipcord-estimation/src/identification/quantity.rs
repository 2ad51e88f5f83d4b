//! What can be estimated.

use core::fmt;
use core::str::FromStr;

use whipcord::parameter::{Parameter, StiffnessPart, numbered};
use whipcord::robot::{Cable, Drive, Robot, Routing, limits};

/// A number of a robot or a case that can be estimated. Indices count from 0; `axis` is 0, 1 or 2 for x, y
/// or z.
///
/// ```
/// use whipcord_estimation::identification::Quantity;
/// let offset: Quantity = "cables[1].tension_offset".parse()?;
/// assert_eq!(offset, Quantity::TensionOffset { cable: 1 });
/// assert_eq!(offset.to_string(), "cables[1].tension_offset");
/// assert!("backbone.young_modulus".parse::<Quantity>().is_ok());
/// # Ok::<(), whipcord_estimation::identification::UnknownQuantity>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A parameter of a robot or a case. A factor on a stiffness counts from what section and material say.
    Parameter(Parameter),
    /// The friction coefficient of one cable, or of all.
    Friction {
        /// Cable.
        cable: Option<usize>,
    },
    /// What the tension of a cable is more than was commanded, in N, in every step.
    TensionOffset {
        /// Cable.
        cable: usize,
    },
    /// What a cable is shortened by more than was commanded, in m, in every step; slack is negative.
    ShorteningOffset {
        /// Cable.
        cable: usize,
    },
    /// A factor on the command of a cable, tension or shortening, in every step.
    Gain {
        /// Cable.
        cable: usize,
    },
    /// A coordinate of the markers in the frames of their places, added to what the measurement says, in m.
    MarkerOffset {
        /// Component.
        axis: usize,
    },
    /// A coordinate of where the world is in the frame of the measurement, in m.
    MeasuredPosition {
        /// Component.
        axis: usize,
    },
    /// A turn of the world in the frame of the measurement from where the fit found it at the start, about an axis of that frame, in
    /// rad: about x first, then y, then z.
    MeasuredTurn {
        /// Axis.
        axis: usize,
    },
    /// A turn of tracked bodies in the frames at their places from how they are mounted, or from how the fit found them at the start, about an axis
    /// of these frames, in rad: about x first, then y, then z.
    BodyTurn {
        /// Axis.
        axis: usize,
    },
    /// A coordinate of the base in the world, in m.
    BasePosition {
        /// Component.
        axis: usize,
    },
    /// A turn of the base from where the case has it about an axis of the world, in rad: about x first,
    /// then y, then z.
    BaseTurn {
        /// Axis.
        axis: usize,
    },
}

/// The paths of the factors on a stiffness, as this module writes them.
const FACTORS: [(&str, StiffnessPart); 4] = [
    ("backbone.shear_factor", StiffnessPart::Shear),
    ("backbone.extension_factor", StiffnessPart::Extension),
    ("backbone.bending_factor", StiffnessPart::Bending),
    ("backbone.torsion_factor", StiffnessPart::Torsion),
];

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(Parameter::StiffnessScale(part)) => {
                let factor = FACTORS.iter().find(|(_, of)| of == part);
                f.write_str(factor.map_or("", |(path, _)| path))
            }
            Self::Parameter(parameter) => parameter.fmt(f),
            Self::Friction { cable: None } => f.write_str("cables.friction"),
            Self::Friction { cable: Some(cable) } => write!(f, "cables[{cable}].friction"),
            Self::TensionOffset { cable } => write!(f, "cables[{cable}].tension_offset"),
            Self::ShorteningOffset { cable } => write!(f, "cables[{cable}].shortening_offset"),
            Self::Gain { cable } => write!(f, "cables[{cable}].gain"),
            Self::MarkerOffset { axis } => write!(f, "measured.offset[{axis}]"),
            Self::MeasuredPosition { axis } => write!(f, "measured.position[{axis}]"),
            Self::MeasuredTurn { axis } => write!(f, "measured.turn[{axis}]"),
            Self::BodyTurn { axis } => write!(f, "measured.body_turn[{axis}]"),
            Self::BasePosition { axis } => write!(f, "base.position[{axis}]"),
            Self::BaseTurn { axis } => write!(f, "base.turn[{axis}]"),
        }
    }
}

/// No quantity that can be estimated has this path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is nothing that can be estimated: give a path such as backbone.young_modulus, cables[0].tension_offset or base.position[2], counting from 0"
)]
pub struct UnknownQuantity(pub String);

impl FromStr for Quantity {
    type Err = UnknownQuantity;

    fn from_str(path: &str) -> Result<Self, UnknownQuantity> {
        let unknown = || UnknownQuantity(path.to_owned());
        if let Some((_, part)) = FACTORS.iter().find(|(name, _)| *name == path) {
            return Ok(Self::Parameter(Parameter::StiffnessScale(*part)));
        }
        let (name, numbers) = numbered(path).ok_or_else(unknown)?;
        Ok(match (name.as_str(), numbers.as_slice()) {
            ("cables.friction", []) => Self::Friction { cable: None },
            ("cables[].friction", &[cable]) => Self::Friction { cable: Some(cable) },
            ("cables[].tension_offset", &[cable]) => Self::TensionOffset { cable },
            ("cables[].shortening_offset", &[cable]) => Self::ShorteningOffset { cable },
            ("cables[].gain", &[cable]) => Self::Gain { cable },
            ("measured.offset[]", &[axis @ 0..3]) => Self::MarkerOffset { axis },
            ("measured.position[]", &[axis @ 0..3]) => Self::MeasuredPosition { axis },
            ("measured.turn[]", &[axis @ 0..3]) => Self::MeasuredTurn { axis },
            ("measured.body_turn[]", &[axis @ 0..3]) => Self::BodyTurn { axis },
            ("base.position[]", &[axis @ 0..3]) => Self::BasePosition { axis },
            ("base.turn[]", &[axis @ 0..3]) => Self::BaseTurn { axis },
            _ => match path.parse() {
                // No robot file can say that one hole is off its place, and what is commanded is known.
                Ok(Parameter::HoleAngle { .. } | Parameter::MotorCommand { .. }) | Err(_) => {
                    return Err(unknown());
                }
                Ok(parameter) => Self::Parameter(parameter),
            },
        })
    }
}

impl Quantity {
    /// The paths of what can be estimated, with 0 for every number: those of the first cable, load, axis.
    pub const PATHS: [&str; 60] = [
        "backbone.young_modulus",
        "backbone.shear_modulus",
        "backbone.poisson_ratio",
        "backbone.density",
        "backbone.shear_factor",
        "backbone.extension_factor",
        "backbone.bending_factor",
        "backbone.torsion_factor",
        "backbone.segments[0].bending_factor",
        "backbone.segments[0].torsion_factor",
        "backbone.segments[0].extension_factor",
        "backbone.segments[0].shear_factor",
        "backbone.diameter",
        "backbone.diameters[0]",
        "backbone.inner_diameter",
        "backbone.section.width",
        "backbone.section.height",
        "backbone.shear_correction",
        "backbone.stiffness.matrix[0][0]",
        "backbone.linear_density",
        "backbone.rest_curvature[0]",
        "backbone.rest_curvature[0][0]",
        "disks.mass",
        "disks.hole_circle_radius",
        "disks.hole_circle_radius[0]",
        "cables.friction",
        "cables[0].friction",
        "cables[0].tension_offset",
        "cables[0].shortening_offset",
        "cables[0].gain",
        "cables[0].axial_stiffness",
        "cables[0].routing.angle",
        "cables[0].routing.radius",
        "cables[0].routing.turns",
        "cables[0].routing.start[0]",
        "cables[0].routing.end[0]",
        "cables[0].routing.x[0]",
        "cables[0].routing.y[0]",
        "motors[0].stiffness",
        "motors[0].free_length",
        "motors[0].pretension",
        "motors[0].backlash",
        "motors[0].angle_offset",
        "motors[0].gear_ratio",
        "motors[0].spool_radius",
        "motors[0].spool_radius[0]",
        "loads.gravity[0]",
        "loads.tip_force[0]",
        "loads.tip_moment[0]",
        "loads.point[0].force[0]",
        "loads.point[0].moment[0]",
        "loads.mass[0].mass",
        "loads.distributed[0].force[0]",
        "loads.distributed[0].moment[0]",
        "loads.distributed[0].force[0][0]",
        "measured.offset[0]",
        "measured.position[0]",
        "measured.turn[0]",
        "base.position[0]",
        "base.turn[0]",
    ];

    /// Its unit in SI; empty for a plain number, and for a coefficient of a polynomial, whose unit depends on
    /// its power.
    #[must_use]
    pub fn unit(&self, robot: &Robot) -> &'static str {
        use Parameter as P;
        match self {
            Self::Parameter(parameter) => match parameter {
                P::YoungModulus | P::ShearModulus => "Pa",
                P::Density => "kg/m³",
                P::Diameter
                | P::DiameterAt { .. }
                | P::InnerDiameter
                | P::Width
                | P::Height
                | P::HoleRadius
                | P::HoleRadiusAt { .. }
                | P::Radius { .. }
                | P::Start { .. }
                | P::End { .. } => "m",
                P::Stiffness { row, column } => match (*row < 3, *column < 3) {
                    (true, true) => "N",
                    (false, false) => "N·m²",
                    _ => "N·m",
                },
                P::YieldMoment { .. } => "N·m",
                P::YieldStiffness { .. } => "N·m²",
                P::LinearDensity => "kg/m",
                P::RestCurvature { .. } | P::RestCurvatureAt { .. } => "1/m",
                P::DiskMass | P::PointMass { .. } => "kg",
                P::HoleAngle { .. } | P::Angle { .. } => "rad",
                P::AxialStiffness { .. }
                | P::Pretension { .. }
                | P::TipForce { .. }
                | P::PointForce { .. } => "N",
                P::MotorStiffness { .. } => "N/m",
                P::FreeLength { .. } | P::SpoolRadius { .. } => "m",
                P::Backlash { motor } | P::MotorOffset { motor } | P::MotorCommand { motor } => {
                    match robot.motors().get(*motor).map(|motor| motor.drive) {
                        Some(Drive::Linear) => "m",
                        _ => "rad",
                    }
                }
                P::Gravity { .. } => "m/s²",
                P::TipMoment { .. } | P::PointMoment { .. } => "N·m",
                P::LineForce { .. } | P::LineForceAt { .. } => "N/m",
                P::LineMoment { .. } | P::LineMomentAt { .. } => "N·m/m",
                P::PoissonRatio
                | P::Friction { .. }
                | P::StiffnessScale(_)
                | P::SegmentFactor { .. }
                | P::ShearCorrection
                | P::Turns { .. }
                | P::GearRatio { .. }
                | P::Coefficient { .. } => "",
            },
            Self::Friction { .. } | Self::Gain { .. } => "",
            Self::TensionOffset { .. } => "N",
            Self::ShorteningOffset { .. }
            | Self::MarkerOffset { .. }
            | Self::MeasuredPosition { .. }
            | Self::BasePosition { .. } => "m",
            Self::BaseTurn { .. } | Self::MeasuredTurn { .. } | Self::BodyTurn { .. } => "rad",
        }
    }

    /// Whether it says where the frame of a measurement is.
    #[must_use]
    pub const fn is_of_frame(&self) -> bool {
        matches!(self, Self::MeasuredPosition { .. } | Self::MeasuredTurn { .. })
    }

    /// Whether it is a load.
    pub(super) const fn is_load(&self) -> bool {
        matches!(self, Self::Parameter(_)) && self.is_of_case()
    }

    /// Whether it is a number of a case, else one of the robot.
    pub(super) const fn is_of_case(&self) -> bool {
        use Parameter as P;
        match self {
            Self::Parameter(parameter) => matches!(
                parameter,
                P::Gravity { .. }
                    | P::TipForce { .. }
                    | P::TipMoment { .. }
                    | P::PointForce { .. }
                    | P::PointMoment { .. }
                    | P::PointMass { .. }
                    | P::LineForce { .. }
                    | P::LineMoment { .. }
                    | P::LineForceAt { .. }
                    | P::LineMomentAt { .. }
            ),
            Self::Friction { .. } => false,
            Self::TensionOffset { .. }
            | Self::ShorteningOffset { .. }
            | Self::Gain { .. }
            | Self::MarkerOffset { .. }
            | Self::MeasuredPosition { .. }
            | Self::MeasuredTurn { .. }
            | Self::BodyTurn { .. }
            | Self::BasePosition { .. }
            | Self::BaseTurn { .. } => true,
        }
    }

    /// Whether cables that share it each keep their own value and only change by as much: it says where a cable runs.
    pub(super) const fn differs_between_cables(&self) -> bool {
        use Parameter as P;
        matches!(
            self,
            Self::Parameter(
                P::Angle { .. }
                    | P::Radius { .. }
                    | P::Turns { .. }
                    | P::Start { .. }
                    | P::End { .. }
                    | P::Coefficient { .. }
            )
        )
    }

    /// Whether it says how far a cable runs beside the centres of its holes.
    pub(super) fn is_of_holes(&self, cables: &[Cable]) -> bool {
        let Self::Parameter(Parameter::Angle { cable } | Parameter::Radius { cable }) = self else {
            return false;
        };
        cables.get(*cable).is_some_and(|of| matches!(of.routing, Routing::Holes { .. }))
    }

    /// Whether it cannot be negative, so that changes are seen as fractions of it.
    pub(super) const fn is_positive(&self) -> bool {
        use Parameter as P;
        let Self::Parameter(parameter) = self else { return matches!(self, Self::Gain { .. }) };
        match parameter {
            P::Stiffness { row, column } => *row == *column,
            _ => matches!(
                parameter,
                P::YoungModulus
                    | P::ShearModulus
                    | P::Density
                    | P::StiffnessScale(_)
                    | P::SegmentFactor { .. }
                    | P::Diameter
                    | P::DiameterAt { .. }
                    | P::InnerDiameter
                    | P::Width
                    | P::Height
                    | P::ShearCorrection
                    | P::YieldMoment { .. }
                    | P::YieldStiffness { .. }
                    | P::LinearDensity
                    | P::DiskMass
                    | P::HoleRadius
                    | P::HoleRadiusAt { .. }
                    | P::Radius { .. }
                    | P::AxialStiffness { .. }
                    | P::MotorStiffness { .. }
                    | P::FreeLength { .. }
                    | P::Pretension { .. }
                    | P::Backlash { .. }
                    | P::SpoolRadius { .. }
                    | P::PointMass { .. }
            ),
        }
    }

    /// Whether it must be greater than zero.
    pub(super) const fn is_above_zero(&self) -> bool {
        match self {
            Self::Parameter(Parameter::StiffnessScale(_)) | Self::Gain { .. } => true,
            Self::Parameter(Parameter::Stiffness { .. } | Parameter::ShearCorrection) => {
                self.is_positive()
            }
            _ => self.range()[0] > 0.0,
        }
    }

    /// Whether it decides on the stiffness that section and material give.
    pub(super) const fn is_of_material(&self) -> bool {
        use Parameter as P;
        matches!(
            self,
            Self::Parameter(
                P::YoungModulus
                    | P::ShearModulus
                    | P::PoissonRatio
                    | P::ShearCorrection
                    | P::Diameter
                    | P::DiameterAt { .. }
                    | P::InnerDiameter
                    | P::Width
                    | P::Height
            )
        )
    }

    /// Values that are possible at all.
    pub(super) const fn range(&self) -> [f64; 2] {
        use Parameter as P;
        let range = match self {
            Self::Friction { .. } => limits::FRICTION,
            Self::Parameter(parameter) => match parameter {
                P::YoungModulus | P::ShearModulus => limits::MODULUS,
                P::Density => limits::DENSITY,
                P::SegmentFactor { .. } => limits::STIFFNESS_FACTOR,
                P::YieldMoment { .. } => limits::YIELD_MOMENT,
                P::YieldStiffness { .. } => limits::BENDING_STIFFNESS,
                P::LinearDensity => limits::LINEAR_DENSITY,
                P::PointMass { .. } | P::DiskMass => limits::MASS,
                P::Radius { .. } => limits::DISTANCE,
                P::AxialStiffness { .. } => limits::AXIAL_STIFFNESS,
                P::MotorStiffness { .. } => limits::DRIVE_STIFFNESS,
                P::FreeLength { .. } | P::Backlash { .. } => limits::DISTANCE,
                P::Pretension { .. } => limits::TENSION,
                P::SpoolRadius { .. } => limits::LENGTH,
                P::Diameter
                | P::DiameterAt { .. }
                | P::Width
                | P::Height
                | P::HoleRadius
                | P::HoleRadiusAt { .. } => limits::LENGTH,
                _ => return [f64::NEG_INFINITY, f64::INFINITY],
            },
            _ => return [f64::NEG_INFINITY, f64::INFINITY],
        };
        [range.least, range.greatest]
    }

    /// Whether a change of this and of the other is a change of the same numbers.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        use Parameter as P;
        let one_way = |a: &Self, b: &Self| match (a, b) {
            (Self::Friction { cable: None }, Self::Friction { .. }) => true,
            (Self::Parameter(a), Self::Parameter(b)) => match (a, b) {
                (P::Diameter, P::DiameterAt { .. }) | (P::HoleRadius, P::HoleRadiusAt { .. }) => {
                    true
                }
                (
                    P::SpoolRadius { motor: a, entry: None },
                    P::SpoolRadius { motor: b, entry: Some(_) },
                ) => a == b,
                (P::YieldMoment { axis: None }, P::YieldMoment { axis: Some(_) })
                | (P::YieldStiffness { axis: None }, P::YieldStiffness { axis: Some(_) }) => true,
                (P::RestCurvature { axis: a }, P::RestCurvatureAt { axis: b, .. }) => a == b,
                (P::LineForce { load: i, axis: a }, P::LineForceAt { load: j, axis: b, .. })
                | (P::LineMoment { load: i, axis: a }, P::LineMomentAt { load: j, axis: b, .. }) => {
                    (i, a) == (j, b)
                }
                (P::Stiffness { row: i, column: j }, P::Stiffness { row: k, column: l }) => {
                    (i, j) == (l, k)
                }
                _ => false,
            },
            _ => false,
        };
        self == other || one_way(self, other) || one_way(other, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_read_as_the_quantity_that_writes_it() {
        for path in Quantity::PATHS {
            assert_eq!(path.parse::<Quantity>().unwrap().to_string(), path);
        }
        for wrong in ["base.turn[3]", "cables.friction[0]", "angle of cables[0].holes[1]", ""] {
            assert_eq!(wrong.parse::<Quantity>(), Err(UnknownQuantity(wrong.to_owned())));
        }
    }

    #[test]
    fn overlaps_are_seen_from_both_sides() {
        let quantity = |path: &str| path.parse::<Quantity>().unwrap();
        for (a, b, overlap) in [
            ("backbone.diameter", "backbone.diameters[3]", true),
            ("backbone.diameter", "backbone.young_modulus", false),
            ("cables.friction", "cables[2].friction", true),
            ("cables[1].friction", "cables[2].friction", false),
            ("backbone.rest_curvature[0]", "backbone.rest_curvature[1][0]", true),
            ("backbone.rest_curvature[0]", "backbone.rest_curvature[1][1]", false),
            ("backbone.stiffness.matrix[0][1]", "backbone.stiffness.matrix[1][0]", true),
        ] {
            assert_eq!(quantity(a).overlaps(&quantity(b)), overlap, "{a} {b}");
            assert_eq!(quantity(b).overlaps(&quantity(a)), overlap, "{b} {a}");
        }
    }
}
