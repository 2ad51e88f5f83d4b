//! The quantities that are parameters.

/// One number of a robot or a case that an answer depends on. Indices count from 0; `axis` is 0, 1
/// or 2 for x, y or z.
///
/// A parameter that the robot or case does not have, such as the inner diameter of a solid rod, is
/// refused by name ([`Problem::NoSuchQuantity`](crate::robot::Problem::NoSuchQuantity)).
///
/// ```
/// use whipcord::Parameter;
/// assert_eq!(Parameter::Radius { cable: 1 }.to_string(), "cables[1].routing.radius");
/// assert_eq!("cables[1].routing.radius".parse(), Ok(Parameter::Radius { cable: 1 }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Young's modulus in Pa. The shear modulus changes with it where Poisson's ratio is given, and
    /// stays where it is given itself.
    YoungModulus,
    /// Shear modulus in Pa, where it is given.
    ShearModulus,
    /// Poisson's ratio, where it is given and the shear modulus follows from it.
    PoissonRatio,
    /// Density in kg/m³.
    Density,
    /// A factor, 1 at the answer, on a part of the section's stiffness, all along the backbone.
    StiffnessScale(StiffnessPart),
    /// A factor on a part of the stiffness of a segment of the backbone.
    SegmentFactor {
        /// Segment.
        segment: usize,
        /// The part of the stiffness.
        part: StiffnessPart,
    },
    /// Outer diameter in m; where it varies, by as much everywhere.
    Diameter,
    /// One entry of an outer diameter that varies, in m.
    DiameterAt {
        /// Disk, or number of the arc length at which it is given.
        entry: usize,
    },
    /// Inner diameter in m; where it varies, by as much everywhere.
    InnerDiameter,
    /// Width of a rectangular bar in m; where it varies, by as much everywhere.
    Width,
    /// Height of a rectangular bar in m; where it varies, by as much everywhere.
    Height,
    /// Factor on the shear stiffness that follows from section and material.
    ShearCorrection,
    /// An entry of the stiffness that is given itself, in the order of
    /// [`crate::robot::StiffnessMatrix`], with its mirror image; by as much all along the backbone.
    Stiffness {
        /// Row.
        row: usize,
        /// Column; the row, where the stiffness is diagonal.
        column: usize,
    },
    /// Greatest moment of the friction against bending in N·m, where it is given.
    YieldMoment {
        /// 0 or 1: about x or y of the sections; `None` changes both by as much.
        axis: Option<usize>,
    },
    /// Bending stiffness in N·m² that this friction adds until it slides, where it is given.
    YieldStiffness {
        /// As that of [`Self::YieldMoment`].
        axis: Option<usize>,
    },
    /// Mass per length in kg/m, where it is given; by as much all along the backbone.
    LinearDensity,
    /// A component of the rest curvature in 1/m; by as much all along the backbone.
    RestCurvature {
        /// Component.
        axis: usize,
    },
    /// A component of one entry of a rest curvature that varies, in 1/m.
    RestCurvatureAt {
        /// Disk, or number of the arc length at which it is given.
        entry: usize,
        /// Component.
        axis: usize,
    },
    /// Mass of each disk in kg.
    DiskMass,
    /// Radius of the hole circles in m; by as much at every disk.
    HoleRadius,
    /// Radius of the hole circle of one disk in m.
    HoleRadiusAt {
        /// Disk.
        disk: usize,
    },
    /// Angle in rad by which the hole of one cable at one disk is off its place.
    HoleAngle {
        /// Cable.
        cable: usize,
        /// Disk.
        disk: usize,
    },
    /// Angle of a straight cable, the angle at the base of a helical one, or the angle by which one through holes is off all of them, in rad.
    Angle {
        /// Cable.
        cable: usize,
    },
    /// Distance of a straight or helical cable from the axis, or what that of one through holes is more than that of its holes, in m.
    Radius {
        /// Cable.
        cable: usize,
    },
    /// Turns of a helical cable.
    Turns {
        /// Cable.
        cable: usize,
    },
    /// Where a linear cable starts, in m; axis 0 or 1.
    Start {
        /// Cable.
        cable: usize,
        /// Component.
        axis: usize,
    },
    /// Where a linear cable reaches the tip, in m; axis 0 or 1.
    End {
        /// Cable.
        cable: usize,
        /// Component.
        axis: usize,
    },
    /// A coefficient of a polynomial cable, in m over a power of m; axis 0 or 1.
    Coefficient {
        /// Cable.
        cable: usize,
        /// Component.
        axis: usize,
        /// Power of the arc length.
        power: usize,
    },
    /// Friction coefficient of one cable, or, by as much, of all, where it is given.
    Friction {
        /// Cable.
        cable: Option<usize>,
    },
    /// Axial stiffness of a cable in N, where it is given.
    AxialStiffness {
        /// Cable.
        cable: usize,
    },
    /// Stiffness of drive and cable outside the robot of a motor in N/m, where it is given.
    MotorStiffness {
        /// Motor.
        motor: usize,
    },
    /// Length in m of each cable between a motor and the base.
    FreeLength {
        /// Motor.
        motor: usize,
    },
    /// Pretension of the cables of a motor in N.
    Pretension {
        /// Motor.
        motor: usize,
    },
    /// Backlash of a motor's drive in rad or m.
    Backlash {
        /// Motor.
        motor: usize,
    },
    /// The command at which a motor shortens no cable, in rad or m.
    MotorOffset {
        /// Motor.
        motor: usize,
    },
    /// The command of a motor in the last step, where it has one: its angle in rad, or its travel in m.
    MotorCommand {
        /// Motor.
        motor: usize,
    },
    /// Turns of a motor for one of its spool.
    GearRatio {
        /// Motor.
        motor: usize,
    },
    /// Radius of the spools of a motor in m.
    SpoolRadius {
        /// Motor.
        motor: usize,
        /// One of its cables, by its number among them; `None` changes all by as much.
        entry: Option<usize>,
    },
    /// A component of gravity in m/s².
    Gravity {
        /// Component.
        axis: usize,
    },
    /// A component of the tip force in N.
    TipForce {
        /// Component.
        axis: usize,
    },
    /// A component of the tip moment in N·m.
    TipMoment {
        /// Component.
        axis: usize,
    },
    /// A component of the force of a point load in N.
    PointForce {
        /// Point load.
        load: usize,
        /// Component.
        axis: usize,
    },
    /// A component of the moment of a point load in N·m.
    PointMoment {
        /// Point load.
        load: usize,
        /// Component.
        axis: usize,
    },
    /// A mass that the robot carries, in kg.
    PointMass {
        /// Number of the mass.
        mass: usize,
    },
    /// A component of the force of a distributed load in N/m; by as much everywhere it acts.
    LineForce {
        /// Distributed load.
        load: usize,
        /// Component.
        axis: usize,
    },
    /// A component of the moment of a distributed load in N·m/m; by as much everywhere it acts.
    LineMoment {
        /// Distributed load.
        load: usize,
        /// Component.
        axis: usize,
    },
    /// A component of the force at one station of a distributed load in N/m.
    LineForceAt {
        /// Distributed load.
        load: usize,
        /// Station.
        entry: usize,
        /// Component.
        axis: usize,
    },
    /// A component of the moment at one station of a distributed load in N·m/m.
    LineMomentAt {
        /// Distributed load.
        load: usize,
        /// Station.
        entry: usize,
        /// Component.
        axis: usize,
    },
}

/// Parts of a section's stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StiffnessPart {
    /// GA, against shear in both directions.
    Shear,
    /// EA, against extension.
    Extension,
    /// EI, against bending in both directions.
    Bending,
    /// GJ, against twist.
    Torsion,
}
