//! The numbers of a robot and a case that a parameter stands for.

use whipcord_numerics::Vec3;

use super::quantity::{Parameter, StiffnessPart};
use crate::case::{Case, Profile};
use crate::robot::{
    Along, Backbone, Cable, Disks, Drive, Motor, Problem, Robot, RobotError, Routing, Section,
    Stiffness,
};

/// The numbers that a robot and a case are made of.
struct Parts {
    backbone: Backbone,
    disks: Disks,
    cables: Vec<Cable>,
    motors: Vec<Motor>,
    case: Case,
}

impl Parameter {
    /// Robot and case with this parameter changed by `by`, in its unit.
    ///
    /// # Errors
    /// [`RobotError`] when robot and case have no such quantity, when no robot file can express its
    /// change (a factor on a stiffness, an angle of one hole), or when it leaves its range.
    pub fn moved(&self, robot: &Robot, case: &Case, by: f64) -> Result<(Robot, Case), RobotError> {
        self.rewritten(robot, case, |values| {
            for value in values {
                **value += by;
            }
        })
    }

    /// Robot and case with this parameter at `value`, in its unit, exactly. Of a parameter that stands
    /// for several numbers the first gets this value, and the others change by as much.
    ///
    /// # Errors
    /// As [`Self::moved`].
    pub fn changed_to(
        &self,
        robot: &Robot,
        case: &Case,
        value: f64,
    ) -> Result<(Robot, Case), RobotError> {
        self.rewritten(robot, case, |values| {
            let before = values.first().map_or(value, |first| **first);
            for each in values {
                // Numbers that agree before agree afterwards; `before + (value - before)` would round.
                **each = if **each == before { value } else { **each + (value - before) };
            }
        })
    }

    /// Robot and case with the numbers that the parameter stands for, at least one, written anew.
    fn rewritten(
        &self,
        robot: &Robot,
        case: &Case,
        write: impl FnOnce(&mut [&mut f64]),
    ) -> Result<(Robot, Case), RobotError> {
        let mut parts = Parts {
            backbone: robot.backbone().clone(),
            disks: robot.disks().clone(),
            cables: robot.cables().to_vec(),
            motors: robot.motors().to_vec(),
            case: case.clone(),
        };
        let mut slots = self.slots(&mut parts);
        if slots.is_empty() {
            return Err(self.absent());
        }
        write(&mut slots);
        let Parts { backbone, disks, cables, motors, mut case } = parts;
        let robot = Robot::new(backbone, disks, cables)?.with_motors(motors)?;
        if self.motor().is_some() {
            case.drive(&robot)?;
        }
        case.check(&robot)?;
        Ok((robot, case))
    }

    /// Present value: of a parameter that stands for several numbers, the first of them.
    ///
    /// # Errors
    /// [`RobotError`] when robot and case have no such quantity.
    pub fn value(&self, robot: &Robot, case: &Case) -> Result<f64, RobotError> {
        match self {
            Self::StiffnessScale(_) => return Ok(1.0),
            Self::HoleAngle { .. } => return Ok(0.0),
            _ => {}
        }
        let mut parts = Parts {
            backbone: robot.backbone().clone(),
            disks: robot.disks().clone(),
            cables: robot.cables().to_vec(),
            motors: robot.motors().to_vec(),
            case: case.clone(),
        };
        self.slots(&mut parts).first().map(|value| **value).ok_or_else(|| self.absent())
    }

    /// Whether robot and case have such a quantity, and answers depend on it.
    pub(crate) fn check(&self, robot: &Robot, case: &Case) -> Result<(), RobotError> {
        let there = match *self {
            Self::HoleAngle { cable, disk } => robot.cables().get(cable).is_some_and(
                |c| matches!(&c.routing, Routing::Holes { holes, .. } if disk < holes.len()),
            ),
            // The weight of a rod whose density is not given is not known.
            Self::Gravity { .. } => {
                robot.backbone().linear_density_at(robot.disks(), 0.0).is_some()
            }
            _ => true,
        };
        if there && self.value(robot, case).is_ok() { Ok(()) } else { Err(self.absent()) }
    }

    /// The motor whose number it is.
    #[must_use]
    pub const fn motor(&self) -> Option<usize> {
        match *self {
            Self::MotorStiffness { motor }
            | Self::FreeLength { motor }
            | Self::Pretension { motor }
            | Self::Backlash { motor }
            | Self::MotorOffset { motor }
            | Self::MotorCommand { motor }
            | Self::GearRatio { motor }
            | Self::SpoolRadius { motor, .. } => Some(motor),
            _ => None,
        }
    }

    /// Whether it is one of a motor, of the friction of cables or of their stiffness: what decides on tensions and lengths alone.
    pub(crate) const fn is_of_drives(&self) -> bool {
        let of_cable = matches!(self, Self::Friction { .. } | Self::AxialStiffness { .. });
        of_cable || self.motor().is_some()
    }

    /// Whether what it changes is less where all loads are: the weight of a mass is less already where gravity is.
    pub(crate) const fn grows_with_loads(&self) -> bool {
        self.is_load() && !matches!(self, Self::PointMass { .. })
    }

    /// Whether it is one of the loads of a case.
    #[must_use]
    pub const fn is_load(&self) -> bool {
        matches!(
            self,
            Self::Gravity { .. }
                | Self::TipForce { .. }
                | Self::TipMoment { .. }
                | Self::PointForce { .. }
                | Self::PointMoment { .. }
                | Self::PointMass { .. }
                | Self::LineForce { .. }
                | Self::LineMoment { .. }
                | Self::LineForceAt { .. }
                | Self::LineMomentAt { .. }
        )
    }

    /// The error of a robot or case that has no such quantity.
    #[must_use]
    pub fn absent(&self) -> RobotError {
        RobotError::new(self.to_string(), Problem::NoSuchQuantity)
    }

    /// The numbers that the parameter stands for; none when there is no such quantity.
    fn slots<'a>(&self, parts: &'a mut Parts) -> Vec<&'a mut f64> {
        let Parts { backbone, disks, cables, motors, case } = parts;
        let material = &mut backbone.material;
        match *self {
            Self::YoungModulus => material.young_modulus.iter_mut().collect(),
            Self::ShearModulus => material.shear_modulus.iter_mut().collect(),
            Self::PoissonRatio if material.shear_modulus.is_none() => {
                material.poisson_ratio.iter_mut().collect()
            }
            Self::Density => material.density.iter_mut().collect(),
            Self::PoissonRatio | Self::StiffnessScale(_) | Self::HoleAngle { .. } => Vec::new(),
            // Factors on a matrix are refused, so that none of them can be changed.
            Self::SegmentFactor { .. }
                if matches!(backbone.stiffness, Some(Stiffness::Matrix(_))) =>
            {
                Vec::new()
            }
            Self::SegmentFactor { segment, part } => {
                let segment = backbone.segments.get_mut(segment);
                let factor = segment.map(|segment| match part {
                    StiffnessPart::Shear => &mut segment.shear_factor,
                    StiffnessPart::Extension => &mut segment.extension_factor,
                    StiffnessPart::Bending => &mut segment.bending_factor,
                    StiffnessPart::Torsion => &mut segment.torsion_factor,
                });
                factor.into_iter().collect()
            }
            Self::Diameter => match &mut backbone.section {
                Some(Section::Round { outer, .. }) => outer.values_mut().iter_mut().collect(),
                _ => Vec::new(),
            },
            Self::DiameterAt { entry } => match &mut backbone.section {
                Some(Section::Round { outer, .. }) if !outer.is_uniform() => {
                    outer.values_mut().get_mut(entry).into_iter().collect()
                }
                _ => Vec::new(),
            },
            Self::InnerDiameter => match &mut backbone.section {
                // A solid rod has no bore that could change.
                Some(Section::Round { inner, .. }) if *inner != Along::Uniform(0.0) => {
                    inner.values_mut().iter_mut().collect()
                }
                _ => Vec::new(),
            },
            Self::Width => match &mut backbone.section {
                Some(Section::Rectangle { width, .. }) => width.values_mut().iter_mut().collect(),
                _ => Vec::new(),
            },
            Self::Height => match &mut backbone.section {
                Some(Section::Rectangle { height, .. }) => height.values_mut().iter_mut().collect(),
                _ => Vec::new(),
            },
            Self::ShearCorrection if backbone.stiffness.is_none() => {
                vec![&mut backbone.shear_correction]
            }
            Self::Stiffness { row, column } if row < 6 && column < 6 => {
                backbone.stiffness.as_mut().map_or_else(Vec::new, |k| entries(k, row, column))
            }
            Self::YieldMoment { axis } => {
                let given = backbone.bending_friction.as_mut();
                given.map_or_else(Vec::new, |given| about(&mut given.yield_moment, axis))
            }
            Self::YieldStiffness { axis } => {
                let given = backbone.bending_friction.as_mut();
                let given = given.and_then(|given| given.yield_stiffness.as_mut());
                given.map_or_else(Vec::new, |given| about(given, axis))
            }
            Self::LinearDensity => backbone
                .linear_density
                .as_mut()
                .map_or_else(Vec::new, |along| along.values_mut().iter_mut().collect()),
            Self::RestCurvature { axis } if axis < 3 => {
                backbone.rest_curvature.values_mut().iter_mut().map(|u| &mut u[axis]).collect()
            }
            Self::RestCurvatureAt { entry, axis }
                if axis < 3 && !backbone.rest_curvature.is_uniform() =>
            {
                let values = backbone.rest_curvature.values_mut();
                values.get_mut(entry).map(|u| &mut u[axis]).into_iter().collect()
            }
            Self::DiskMass => vec![&mut disks.mass],
            Self::HoleRadius => disks.hole_circle_radii.iter_mut().collect(),
            Self::HoleRadiusAt { disk } => {
                disks.hole_circle_radii.get_mut(disk).into_iter().collect()
            }
            Self::Friction { cable } => cables
                .iter_mut()
                .enumerate()
                .filter(|(i, _)| cable.is_none_or(|only| only == *i))
                .filter_map(|(_, of)| of.friction.as_mut())
                .collect(),
            Self::AxialStiffness { cable } => {
                cables.get_mut(cable).and_then(|c| c.axial_stiffness.as_mut()).into_iter().collect()
            }
            Self::MotorStiffness { motor }
            | Self::FreeLength { motor }
            | Self::Pretension { motor }
            | Self::Backlash { motor }
            | Self::MotorOffset { motor }
            | Self::GearRatio { motor }
            | Self::SpoolRadius { motor, .. } => {
                motors.get_mut(motor).map_or_else(Vec::new, |motor| self.of_motor(motor))
            }
            Self::MotorCommand { motor } => {
                let command = case.motors.last_mut().and_then(|step| step.get_mut(motor));
                command.and_then(Option::as_mut).into_iter().collect()
            }
            Self::Angle { cable }
            | Self::Radius { cable }
            | Self::Turns { cable }
            | Self::Start { cable, .. }
            | Self::End { cable, .. }
            | Self::Coefficient { cable, .. } => {
                cables.get_mut(cable).and_then(|c| self.of_course(c)).into_iter().collect()
            }
            Self::Gravity { axis } if axis < 3 => {
                vec![&mut case.loads.gravity.get_or_insert_default()[axis]]
            }
            Self::TipForce { axis } if axis < 3 => vec![&mut case.loads.tip_force[axis]],
            Self::TipMoment { axis } if axis < 3 => vec![&mut case.loads.tip_moment[axis]],
            Self::PointForce { load, axis } if axis < 3 => {
                case.loads.points.get_mut(load).map(|p| &mut p.force[axis]).into_iter().collect()
            }
            Self::PointMoment { load, axis } if axis < 3 => {
                case.loads.points.get_mut(load).map(|p| &mut p.moment[axis]).into_iter().collect()
            }
            Self::PointMass { mass } => {
                case.loads.masses.get_mut(mass).map(|m| &mut m.mass).into_iter().collect()
            }
            Self::LineForce { load, axis }
            | Self::LineMoment { load, axis }
            | Self::LineForceAt { load, axis, .. }
            | Self::LineMomentAt { load, axis, .. }
                if axis < 3 =>
            {
                let profile = case.loads.distributed.get_mut(load).map(|load| &mut load.profile);
                let values = profile.map_or_else(Vec::new, |profile| self.of_profile(profile));
                values.into_iter().map(|value| &mut value[axis]).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The forces or moments of a profile that the parameter changes.
    fn of_profile<'a>(&self, profile: &'a mut Profile) -> Vec<&'a mut Vec3> {
        match (*self, profile) {
            (Self::LineForce { .. }, Profile::Constant { force, .. }) => vec![force],
            (Self::LineMoment { .. }, Profile::Constant { moment, .. }) => vec![moment],
            (Self::LineForce { .. }, Profile::Linear { force, .. }) => force.iter_mut().collect(),
            (Self::LineMoment { .. }, Profile::Linear { moment, .. }) => {
                moment.iter_mut().collect()
            }
            (Self::LineForceAt { entry, .. }, Profile::Linear { force, .. }) => {
                force.get_mut(entry).into_iter().collect()
            }
            (Self::LineMomentAt { entry, .. }, Profile::Linear { moment, .. }) => {
                moment.get_mut(entry).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }

    fn of_motor<'a>(&self, motor: &'a mut Motor) -> Vec<&'a mut f64> {
        match (*self, &mut motor.drive) {
            (Self::MotorStiffness { .. }, _) => motor.stiffness.iter_mut().collect(),
            (Self::FreeLength { .. }, _) => vec![&mut motor.free_length],
            (Self::Pretension { .. }, _) => vec![&mut motor.pretension],
            (Self::Backlash { .. }, _) => vec![&mut motor.backlash],
            (Self::MotorOffset { .. }, _) => vec![&mut motor.offset],
            (Self::GearRatio { .. }, Drive::Spool { gear_ratio }) => vec![gear_ratio],
            (Self::SpoolRadius { entry, .. }, Drive::Spool { .. }) => {
                let cables = motor.cables.iter_mut().enumerate();
                let chosen = cables.filter(|(i, _)| entry.is_none_or(|entry| entry == *i));
                chosen.map(|(_, of)| &mut of.radius).collect()
            }
            _ => Vec::new(),
        }
    }

    fn of_course<'a>(&self, cable: &'a mut Cable) -> Option<&'a mut f64> {
        match (*self, &mut cable.routing) {
            (Self::Angle { .. }, Routing::Holes { .. }) => Some(&mut cable.hole_offset.angle),
            (Self::Radius { .. }, Routing::Holes { .. }) => Some(&mut cable.hole_offset.radius),
            (Self::Angle { .. }, Routing::Straight { angle, .. }) => Some(angle),
            (Self::Angle { .. }, Routing::Helix { start_angle, .. }) => Some(start_angle),
            (
                Self::Radius { .. },
                Routing::Straight { radius, .. } | Routing::Helix { radius, .. },
            ) => Some(radius),
            (Self::Turns { .. }, Routing::Helix { turns, .. }) => Some(turns),
            (Self::Start { axis, .. }, Routing::Linear { start, .. }) => start.get_mut(axis),
            (Self::End { axis, .. }, Routing::Linear { end, .. }) => end.get_mut(axis),
            (Self::Coefficient { axis: 0, power, .. }, Routing::Polynomial { x, .. }) => {
                x.get_mut(power)
            }
            (Self::Coefficient { axis: 1, power, .. }, Routing::Polynomial { y, .. }) => {
                y.get_mut(power)
            }
            _ => None,
        }
    }
}

/// The number about one bending axis, or both.
fn about(numbers: &mut [f64; 2], axis: Option<usize>) -> Vec<&mut f64> {
    let chosen = numbers.iter_mut().enumerate();
    chosen.filter(|(i, _)| axis.is_none_or(|axis| axis == *i)).map(|(_, number)| number).collect()
}

/// The entries of a given stiffness that change together; none where it has no such one.
fn entries(stiffness: &mut Stiffness, row: usize, column: usize) -> Vec<&mut f64> {
    match stiffness {
        Stiffness::Matrix(along) => along
            .values_mut()
            .iter_mut()
            .flat_map(|matrix| matrix.iter_mut().enumerate())
            .flat_map(|(i, line)| line.iter_mut().enumerate().map(move |(j, entry)| (i, j, entry)))
            .filter(|(i, j, _)| (*i, *j) == (row, column) || (*i, *j) == (column, row))
            .map(|(.., entry)| entry)
            .collect(),
        Stiffness::Diagonal { .. } if row != column => Vec::new(),
        Stiffness::Diagonal { shear, axial, bending, torsion } => match row {
            0 | 1 => shear.as_mut().map_or_else(Vec::new, |along| {
                along.values_mut().iter_mut().map(|pair| &mut pair[row]).collect()
            }),
            2 => axial.as_mut().map_or_else(Vec::new, |a| a.values_mut().iter_mut().collect()),
            3 | 4 => bending.values_mut().iter_mut().map(|pair| &mut pair[row - 3]).collect(),
            _ => torsion.values_mut().iter_mut().collect(),
        },
    }
}
