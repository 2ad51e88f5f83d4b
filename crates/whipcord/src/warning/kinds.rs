//! The kinds of warnings and their limits.

use crate::robot::Drive;
use crate::solution::Diagnostics;

/// Shortest and longest backbone in m without a warning.
pub const USUAL_LENGTHS: [f64; 2] = [1e-3, 10.0];
/// Largest ratio of thickness to length of a slender rod.
pub const SLENDER: f64 = 0.1;
/// Largest Young's modulus in Pa of a soft body, in which cables run in channels.
pub const SOFT: f64 = 10e6;
/// Largest change of the shape with half the spacing of the disks, relative to the length, without a warning.
pub const SPACING: f64 = 0.01;
/// Stability below which an answer is nearly critical; that of the unloaded backbone is 1.
pub const NEAR_CRITICAL: f64 = Diagnostics::NEAR_CRITICAL;
/// Largest surface strain without a warning if the file gives no `yield_strain`.
pub const LARGE_STRAIN: f64 = 0.1;

/// A warning. `Display` gives the cause with numbers, [`Warning::help`] the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// A backbone shorter or longer than [`USUAL_LENGTHS`].
    Length {
        /// The length in m.
        length: f64,
    },
    /// A number without a unit that looks like one of another unit.
    BareNumber {
        /// Path in the robot file.
        path: String,
        /// The number.
        value: f64,
        /// The unit that it is read in, and the one that it looks like.
        units: BareUnits,
    },
    /// A backbone that is thick for its length.
    ThickBackbone {
        /// Path of the cross-section.
        path: &'static str,
        /// Greatest extent of its cross-sections in m.
        thickness: f64,
        /// Its length in m.
        length: f64,
    },
    /// A cable that passes a disk outside its outer radius.
    OutsideDisk {
        /// Path of the key that gives its distance from the axis.
        path: String,
        /// Name of the cable.
        cable: String,
        /// The disk, from 1.
        disk: usize,
        /// Distance of the cable from the axis in m.
        distance: f64,
        /// Outer radius of the disk in m.
        radius: f64,
    },
    /// A cable that runs inside the material of the backbone.
    InsideBackbone {
        /// Path of the key that gives its distance from the axis.
        path: String,
        /// Name of the cable.
        cable: String,
        /// The disk, from 1.
        disk: usize,
        /// Distance of the cable from the axis in m.
        distance: f64,
        /// How far the backbone's material reaches there, in m from the axis.
        reach: f64,
    },
    /// A list of holes that is shorter than the disks, without `ends_at` beside it.
    ShortHoleList {
        /// Number of the cable, from 0.
        index: usize,
        /// Name of the cable.
        cable: String,
        /// Entries of the list.
        holes: usize,
        /// Number of disks.
        disks: usize,
        /// Arc length in m at which the cable ends.
        ends_at: f64,
    },
    /// A key without effect on the answers.
    UnusedKey {
        /// Its path.
        path: String,
        /// Why it has no effect.
        reason: &'static str,
        /// What to do.
        help: &'static str,
    },
    /// A load far beyond the critical load of the backbone.
    BeyondBuckling {
        /// Path of the load.
        path: String,
        /// The force in N: the part along the backbone where `axial`, else the whole.
        force: f64,
        /// Critical load in N of the unloaded backbone, clamped at its base.
        critical: f64,
        /// Whether the force presses along the backbone.
        axial: bool,
    },
    /// Disks of a soft body whose spacing changes the answer.
    DiskSpacing {
        /// Greatest distance in m of a disk from where it is with half the spacing.
        change: f64,
        /// Length of the backbone in m.
        length: f64,
        /// Number of disks.
        disks: usize,
    },
    /// An unstable equilibrium.
    Unstable {
        /// Stability, which is negative.
        stability: f64,
        /// Fraction of the load at which stability was lost.
        lost_at: Option<f64>,
    },
    /// An equilibrium close to a critical load.
    NearCritical {
        /// Stability, relative to 1 of the unloaded backbone.
        stability: f64,
    },
    /// Neighbouring disks that overlap in the bent shape.
    DisksOverlap {
        /// The disk nearer to the base, from 1; the other is the next.
        disk: usize,
        /// How far they overlap in m, along the axis of the disk.
        overlap: f64,
    },
    /// A shape that passes through itself.
    SelfIntersection {
        /// What of the robot, nearer to the base.
        first: Place,
        /// What of it is in the same place.
        second: Place,
    },
    /// A motor that must go faster than it can between two rows of a table of commands.
    MotorRate {
        /// Its number.
        index: usize,
        /// Its name.
        motor: String,
        /// How the table names the row to which it must go the fastest.
        row: String,
        /// How fast, in rad/s or m/s.
        rate: f64,
        /// How fast it can go.
        limit: f64,
        /// To how many other rows it must go too fast.
        others: usize,
        /// How it moves its cables.
        drive: Drive,
    },
    /// A motor that cannot hold the answer.
    MotorOverload {
        /// Its number.
        index: usize,
        /// Its name.
        motor: String,
        /// What it must give, in N·m, or N of a linear drive.
        effort: f64,
        /// What it can give.
        limit: f64,
        /// How it moves its cables.
        drive: Drive,
    },
    /// A taut cable that passes through an obstacle.
    CableInObstacle {
        /// Name of the cable.
        cable: String,
        /// Name of the obstacle.
        obstacle: String,
        /// The span between two disks where it is deepest, from 0 at the base.
        span: usize,
        /// Arc length in m of the deepest place.
        arc_length: f64,
        /// How deep it is inside the obstacle, in m.
        depth: f64,
        /// The force in N that the cable would press the obstacle with if its holes stayed where they are.
        force: Option<f64>,
        /// In how many other spans, or obstacles, cables pass through obstacles.
        others: usize,
    },
    /// A surface strain beyond what materials bear.
    Strain {
        /// Greatest strain on the surface.
        strain: f64,
        /// What it is compared with.
        limit: f64,
        /// Whether the file gives the limit as `yield_strain`.
        is_given: bool,
        /// Arc length in m of the place.
        arc_length: f64,
    },
}

/// A place of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// The backbone at an arc length in m.
    Backbone(f64),
    /// A disk, from 1.
    Disk(usize),
}

/// What a number without unit is read as, and what it looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BareUnits {
    /// Read as metres, looks like millimetres.
    Millimetres,
    /// Read as pascals, looks like megapascals.
    Megapascals,
}

impl Warning {
    /// All codes.
    pub const CODES: [&'static str; 16] = [
        "length",
        "bare-number",
        "thick-backbone",
        "outside-disk",
        "inside-backbone",
        "short-hole-list",
        "unused-key",
        "beyond-buckling",
        "disk-spacing",
        "unstable",
        "near-critical",
        "disks-overlap",
        "self-intersection",
        "cable-in-obstacle",
        "strain",
        "yield-strain",
    ];

    /// A name that stays the same from version to version.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Length { .. } => "length",
            Self::BareNumber { .. } => "bare-number",
            Self::ThickBackbone { .. } => "thick-backbone",
            Self::OutsideDisk { .. } => "outside-disk",
            Self::InsideBackbone { .. } => "inside-backbone",
            Self::ShortHoleList { .. } => "short-hole-list",
            Self::UnusedKey { .. } => "unused-key",
            Self::BeyondBuckling { .. } => "beyond-buckling",
            Self::DiskSpacing { .. } => "disk-spacing",
            Self::Unstable { .. } => "unstable",
            Self::NearCritical { .. } => "near-critical",
            Self::DisksOverlap { .. } => "disks-overlap",
            Self::SelfIntersection { .. } => "self-intersection",
            Self::MotorRate { .. } => "motor-rate",
            Self::MotorOverload { .. } => "motor-overload",
            Self::CableInObstacle { .. } => "cable-in-obstacle",
            Self::Strain { is_given: false, .. } => "strain",
            Self::Strain { is_given: true, .. } => "yield-strain",
        }
    }

    /// Path in the robot file of what it is about; `None` where no key is at fault.
    #[must_use]
    pub fn path(&self) -> Option<String> {
        Some(match self {
            Self::Length { .. } => "backbone.length".to_owned(),
            Self::BareNumber { path, .. }
            | Self::OutsideDisk { path, .. }
            | Self::InsideBackbone { path, .. }
            | Self::UnusedKey { path, .. }
            | Self::BeyondBuckling { path, .. } => path.clone(),
            Self::ThickBackbone { path, .. } => (*path).to_owned(),
            Self::ShortHoleList { index, .. } => format!("cables[{index}].holes"),
            Self::DiskSpacing { .. } => "disks".to_owned(),
            Self::MotorRate { index, .. } => format!("motors[{index}].rate_limit"),
            Self::MotorOverload { index, drive, .. } => {
                format!("motors[{index}].{}", drive.keys().effort_limit)
            }
            Self::Strain { is_given: true, .. } => "backbone.yield_strain".to_owned(),
            Self::Unstable { .. }
            | Self::NearCritical { .. }
            | Self::DisksOverlap { .. }
            | Self::SelfIntersection { .. }
            | Self::CableInObstacle { .. }
            | Self::Strain { .. } => return None,
        })
    }

    /// Whether it is about an answer, not about what was asked.
    #[must_use]
    pub const fn is_about_answer(&self) -> bool {
        matches!(
            self,
            Self::DiskSpacing { .. }
                | Self::Unstable { .. }
                | Self::NearCritical { .. }
                | Self::DisksOverlap { .. }
                | Self::SelfIntersection { .. }
                | Self::MotorOverload { .. }
                | Self::CableInObstacle { .. }
                | Self::Strain { .. }
        )
    }
}
