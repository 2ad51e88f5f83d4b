//! Parameters by their paths in the terms of the robot file.

use core::fmt;
use core::str::FromStr;

use super::quantity::{Parameter, StiffnessPart};

/// The path of the quantity in the terms of the robot file.
impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plane = |axis: &usize| if *axis == 0 { "x" } else { "y" };
        match self {
            Self::YoungModulus => f.write_str("backbone.young_modulus"),
            Self::ShearModulus => f.write_str("backbone.shear_modulus"),
            Self::PoissonRatio => f.write_str("backbone.poisson_ratio"),
            Self::Density => f.write_str("backbone.density"),
            Self::StiffnessScale(part) => f.write_str(match part {
                StiffnessPart::Shear => "factor on GA",
                StiffnessPart::Extension => "factor on EA",
                StiffnessPart::Bending => "factor on EI",
                StiffnessPart::Torsion => "factor on GJ",
            }),
            Self::SegmentFactor { segment, part } => {
                let part = match part {
                    StiffnessPart::Shear => "shear",
                    StiffnessPart::Extension => "extension",
                    StiffnessPart::Bending => "bending",
                    StiffnessPart::Torsion => "torsion",
                };
                write!(f, "backbone.segments[{segment}].{part}_factor")
            }
            Self::Diameter => f.write_str("backbone.diameter"),
            Self::DiameterAt { entry } => write!(f, "backbone.diameters[{entry}]"),
            Self::ShearCorrection => f.write_str("backbone.shear_correction"),
            Self::Stiffness { row, column } => {
                write!(f, "backbone.stiffness.matrix[{row}][{column}]")
            }
            Self::YieldMoment { axis: None } => f.write_str("backbone.yield_moment"),
            Self::YieldMoment { axis: Some(axis) } => {
                write!(f, "backbone.yield_moment[{axis}]")
            }
            Self::YieldStiffness { axis: None } => f.write_str("backbone.yield_stiffness"),
            Self::YieldStiffness { axis: Some(axis) } => {
                write!(f, "backbone.yield_stiffness[{axis}]")
            }
            Self::LinearDensity => f.write_str("backbone.linear_density"),
            Self::InnerDiameter => f.write_str("backbone.inner_diameter"),
            Self::Width => f.write_str("backbone.section.width"),
            Self::Height => f.write_str("backbone.section.height"),
            Self::RestCurvature { axis } => write!(f, "backbone.rest_curvature[{axis}]"),
            Self::RestCurvatureAt { entry, axis } => {
                write!(f, "backbone.rest_curvature[{entry}][{axis}]")
            }
            Self::DiskMass => f.write_str("disks.mass"),
            Self::HoleRadius => f.write_str("disks.hole_circle_radius"),
            Self::HoleRadiusAt { disk } => write!(f, "disks.hole_circle_radius[{disk}]"),
            Self::HoleAngle { cable, disk } => {
                write!(f, "angle of cables[{cable}].holes[{disk}]")
            }
            Self::Angle { cable } => write!(f, "cables[{cable}].routing.angle"),
            Self::Radius { cable } => write!(f, "cables[{cable}].routing.radius"),
            Self::Turns { cable } => write!(f, "cables[{cable}].routing.turns"),
            Self::Start { cable, axis } => write!(f, "cables[{cable}].routing.start[{axis}]"),
            Self::End { cable, axis } => write!(f, "cables[{cable}].routing.end[{axis}]"),
            Self::Coefficient { cable, axis, power } => {
                write!(f, "cables[{cable}].routing.{}[{power}]", plane(axis))
            }
            Self::Friction { cable: None } => f.write_str("cables.friction"),
            Self::Friction { cable: Some(cable) } => write!(f, "cables[{cable}].friction"),
            Self::AxialStiffness { cable } => write!(f, "cables[{cable}].axial_stiffness"),
            Self::MotorStiffness { motor } => write!(f, "motors[{motor}].stiffness"),
            Self::FreeLength { motor } => write!(f, "motors[{motor}].free_length"),
            Self::Pretension { motor } => write!(f, "motors[{motor}].pretension"),
            Self::Backlash { motor } => write!(f, "motors[{motor}].backlash"),
            Self::MotorOffset { motor } => write!(f, "motors[{motor}].angle_offset"),
            Self::MotorCommand { motor } => write!(f, "motors[{motor}].angle"),
            Self::GearRatio { motor } => write!(f, "motors[{motor}].gear_ratio"),
            Self::SpoolRadius { motor, entry: None } => {
                write!(f, "motors[{motor}].spool_radius")
            }
            Self::SpoolRadius { motor, entry: Some(entry) } => {
                write!(f, "motors[{motor}].spool_radius[{entry}]")
            }
            Self::Gravity { axis } => write!(f, "loads.gravity[{axis}]"),
            Self::TipForce { axis } => write!(f, "loads.tip_force[{axis}]"),
            Self::TipMoment { axis } => write!(f, "loads.tip_moment[{axis}]"),
            Self::PointForce { load, axis } => write!(f, "loads.point[{load}].force[{axis}]"),
            Self::PointMoment { load, axis } => write!(f, "loads.point[{load}].moment[{axis}]"),
            Self::PointMass { mass } => write!(f, "loads.mass[{mass}].mass"),
            Self::LineForce { load, axis } => {
                write!(f, "loads.distributed[{load}].force[{axis}]")
            }
            Self::LineMoment { load, axis } => {
                write!(f, "loads.distributed[{load}].moment[{axis}]")
            }
            Self::LineForceAt { load, entry, axis } => {
                write!(f, "loads.distributed[{load}].force[{entry}][{axis}]")
            }
            Self::LineMomentAt { load, entry, axis } => {
                write!(f, "loads.distributed[{load}].moment[{entry}][{axis}]")
            }
        }
    }
}

/// No parameter has this path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no parameter `{0}`: give a path of the robot file such as backbone.young_modulus, cables[0].routing.radius or loads.tip_force[2], counting from 0"
)]
pub struct UnknownParameter(pub String);

impl FromStr for Parameter {
    type Err = UnknownParameter;

    fn from_str(path: &str) -> Result<Self, UnknownParameter> {
        let unknown = || UnknownParameter(path.to_owned());
        let (name, numbers) = numbered(path).ok_or_else(unknown)?;
        Ok(match (name.as_str(), numbers.as_slice()) {
            ("backbone.young_modulus", []) => Self::YoungModulus,
            ("backbone.shear_modulus", []) => Self::ShearModulus,
            ("backbone.poisson_ratio", []) => Self::PoissonRatio,
            ("backbone.density", []) => Self::Density,
            ("factor on GA", []) => Self::StiffnessScale(StiffnessPart::Shear),
            ("factor on EA", []) => Self::StiffnessScale(StiffnessPart::Extension),
            ("factor on EI", []) => Self::StiffnessScale(StiffnessPart::Bending),
            ("factor on GJ", []) => Self::StiffnessScale(StiffnessPart::Torsion),
            ("backbone.segments[].shear_factor", &[segment]) => {
                Self::SegmentFactor { segment, part: StiffnessPart::Shear }
            }
            ("backbone.segments[].extension_factor", &[segment]) => {
                Self::SegmentFactor { segment, part: StiffnessPart::Extension }
            }
            ("backbone.segments[].bending_factor", &[segment]) => {
                Self::SegmentFactor { segment, part: StiffnessPart::Bending }
            }
            ("backbone.segments[].torsion_factor", &[segment]) => {
                Self::SegmentFactor { segment, part: StiffnessPart::Torsion }
            }
            ("backbone.diameter", []) => Self::Diameter,
            ("backbone.diameters[]", &[entry]) => Self::DiameterAt { entry },
            ("backbone.shear_correction", []) => Self::ShearCorrection,
            ("backbone.stiffness.matrix[][]", &[row, column]) => Self::Stiffness { row, column },
            ("backbone.yield_moment", []) => Self::YieldMoment { axis: None },
            ("backbone.yield_moment[]", &[axis]) => Self::YieldMoment { axis: Some(axis) },
            ("backbone.yield_stiffness", []) => Self::YieldStiffness { axis: None },
            ("backbone.yield_stiffness[]", &[axis]) => Self::YieldStiffness { axis: Some(axis) },
            ("backbone.linear_density", []) => Self::LinearDensity,
            ("backbone.inner_diameter", []) => Self::InnerDiameter,
            ("backbone.section.width", []) => Self::Width,
            ("backbone.section.height", []) => Self::Height,
            ("backbone.rest_curvature[]", &[axis]) => Self::RestCurvature { axis },
            ("backbone.rest_curvature[][]", &[entry, axis]) => {
                Self::RestCurvatureAt { entry, axis }
            }
            ("disks.mass", []) => Self::DiskMass,
            ("disks.hole_circle_radius", []) => Self::HoleRadius,
            ("disks.hole_circle_radius[]", &[disk]) => Self::HoleRadiusAt { disk },
            ("angle of cables[].holes[]", &[cable, disk]) => Self::HoleAngle { cable, disk },
            // Robot files call that of a helix by where it is.
            ("cables[].routing.angle" | "cables[].routing.start_angle", &[cable]) => {
                Self::Angle { cable }
            }
            ("cables[].routing.radius", &[cable]) => Self::Radius { cable },
            ("cables[].routing.turns", &[cable]) => Self::Turns { cable },
            ("cables[].routing.start[]", &[cable, axis]) => Self::Start { cable, axis },
            ("cables[].routing.end[]", &[cable, axis]) => Self::End { cable, axis },
            ("cables[].routing.x[]", &[cable, power]) => {
                Self::Coefficient { cable, axis: 0, power }
            }
            ("cables[].routing.y[]", &[cable, power]) => {
                Self::Coefficient { cable, axis: 1, power }
            }
            ("cables.friction", []) => Self::Friction { cable: None },
            ("cables[].friction", &[cable]) => Self::Friction { cable: Some(cable) },
            ("cables[].axial_stiffness", &[cable]) => Self::AxialStiffness { cable },
            ("motors[].stiffness", &[motor]) => Self::MotorStiffness { motor },
            ("motors[].free_length", &[motor]) => Self::FreeLength { motor },
            ("motors[].pretension", &[motor]) => Self::Pretension { motor },
            ("motors[].backlash", &[motor]) => Self::Backlash { motor },
            // Robot files call that of a linear drive by what it is.
            ("motors[].angle_offset" | "motors[].travel_offset", &[motor]) => {
                Self::MotorOffset { motor }
            }
            ("motors[].angle" | "motors[].travel", &[motor]) => Self::MotorCommand { motor },
            ("motors[].gear_ratio", &[motor]) => Self::GearRatio { motor },
            ("motors[].spool_radius", &[motor]) => Self::SpoolRadius { motor, entry: None },
            ("motors[].spool_radius[]", &[motor, entry]) => {
                Self::SpoolRadius { motor, entry: Some(entry) }
            }
            ("loads.gravity[]", &[axis]) => Self::Gravity { axis },
            ("loads.tip_force[]", &[axis]) => Self::TipForce { axis },
            ("loads.tip_moment[]", &[axis]) => Self::TipMoment { axis },
            ("loads.point[].force[]", &[load, axis]) => Self::PointForce { load, axis },
            ("loads.point[].moment[]", &[load, axis]) => Self::PointMoment { load, axis },
            ("loads.mass[].mass", &[mass]) => Self::PointMass { mass },
            ("loads.distributed[].force[]", &[load, axis]) => Self::LineForce { load, axis },
            ("loads.distributed[].moment[]", &[load, axis]) => Self::LineMoment { load, axis },
            ("loads.distributed[].force[][]", &[load, entry, axis]) => {
                Self::LineForceAt { load, entry, axis }
            }
            ("loads.distributed[].moment[][]", &[load, entry, axis]) => {
                Self::LineMomentAt { load, entry, axis }
            }
            _ => return Err(unknown()),
        })
    }
}

/// The path without its numbers, and these.
#[must_use]
pub fn numbered(path: &str) -> Option<(String, Vec<usize>)> {
    let mut parts = path.split('[');
    let mut name = parts.next()?.to_owned();
    let mut numbers = Vec::new();
    for part in parts {
        let (number, rest) = part.split_once(']')?;
        numbers.push(number.parse().ok()?);
        name += "[]";
        name += rest;
    }
    Some((name, numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_read_as_the_parameter_that_writes_it() {
        let parts = [
            StiffnessPart::Shear,
            StiffnessPart::Extension,
            StiffnessPart::Bending,
            StiffnessPart::Torsion,
        ];
        let (cable, load, entry, axis) = (3, 2, 5, 1);
        let mut all = parts.map(Parameter::StiffnessScale).to_vec();
        all.extend(parts.map(|part| Parameter::SegmentFactor { segment: 2, part }));
        all.extend([
            Parameter::YoungModulus,
            Parameter::ShearModulus,
            Parameter::PoissonRatio,
            Parameter::Density,
            Parameter::Diameter,
            Parameter::DiameterAt { entry },
            Parameter::InnerDiameter,
            Parameter::Width,
            Parameter::Height,
            Parameter::ShearCorrection,
            Parameter::Stiffness { row: 4, column: 3 },
            Parameter::YieldMoment { axis: None },
            Parameter::YieldMoment { axis: Some(axis) },
            Parameter::YieldStiffness { axis: None },
            Parameter::YieldStiffness { axis: Some(axis) },
            Parameter::LinearDensity,
            Parameter::RestCurvature { axis },
            Parameter::RestCurvatureAt { entry, axis },
            Parameter::DiskMass,
            Parameter::HoleRadius,
            Parameter::HoleRadiusAt { disk: 7 },
            Parameter::HoleAngle { cable, disk: 7 },
            Parameter::Angle { cable },
            Parameter::Radius { cable },
            Parameter::Turns { cable },
            Parameter::Start { cable, axis },
            Parameter::End { cable, axis },
            Parameter::Coefficient { cable, axis, power: 2 },
            Parameter::Coefficient { cable, axis: 0, power: 2 },
            Parameter::Friction { cable: None },
            Parameter::Friction { cable: Some(cable) },
            Parameter::AxialStiffness { cable },
            Parameter::MotorStiffness { motor: 1 },
            Parameter::FreeLength { motor: 1 },
            Parameter::Pretension { motor: 1 },
            Parameter::Backlash { motor: 1 },
            Parameter::MotorOffset { motor: 1 },
            Parameter::MotorCommand { motor: 1 },
            Parameter::GearRatio { motor: 1 },
            Parameter::SpoolRadius { motor: 1, entry: None },
            Parameter::SpoolRadius { motor: 1, entry: Some(2) },
            Parameter::Gravity { axis },
            Parameter::TipForce { axis },
            Parameter::TipMoment { axis },
            Parameter::PointForce { load, axis },
            Parameter::PointMoment { load, axis },
            Parameter::PointMass { mass: 4 },
            Parameter::LineForce { load, axis },
            Parameter::LineMoment { load, axis },
            Parameter::LineForceAt { load, entry, axis },
            Parameter::LineMomentAt { load, entry, axis },
        ]);
        for parameter in all {
            assert_eq!(parameter.to_string().parse(), Ok(parameter), "{parameter}");
        }
        assert_eq!("cables[1].routing.start_angle".parse(), Ok(Parameter::Angle { cable: 1 }));
        for wrong in ["", "backbone", "cables[].routing.radius", "cables[x].routing.radius", "[1]"]
        {
            assert_eq!(wrong.parse::<Parameter>(), Err(UnknownParameter(wrong.to_owned())));
        }
    }
}
