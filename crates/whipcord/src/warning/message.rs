//! What warnings say, and what they advise.

use core::fmt;

use super::kinds::{BareUnits, LARGE_STRAIN, Place, SLENDER, SPACING, USUAL_LENGTHS, Warning};
use crate::format::{Round, millimetres, newtons, significant};
use crate::robot::{Drive, in_words};

/// `180 mm`, `18 m`
fn length(metres: f64) -> String {
    if metres.abs() < 1.0 {
        millimetres(metres, Round::Nearest)
    } else {
        format!("{} m", short(metres))
    }
}

fn short(value: f64) -> String {
    significant(value, 3, Round::Nearest)
}

/// With three digits.
fn rounded(value: f64) -> f64 {
    short(value).parse().unwrap_or(value)
}

fn percent(ratio: f64) -> String {
    format!("{} %", short(100.0 * ratio))
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Backbone(s) => write!(f, "the backbone at {}", length(*s)),
            Self::Disk(number) => write!(f, "disk {number}"),
        }
    }
}

impl BareUnits {
    /// The unit that the number is read in, and the one that it looks like.
    #[must_use]
    pub const fn names(self) -> [&'static str; 2] {
        match self {
            Self::Millimetres => ["m", "mm"],
            Self::Megapascals => ["Pa", "MPa"],
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { length: given } => {
                let [least, greatest] = USUAL_LENGTHS.map(length);
                write!(
                    f,
                    "the backbone is {} long; most robots have {least} to {greatest}",
                    length(*given)
                )
            }
            Self::BareNumber { path, value, units } => {
                let [read, like] = units.names();
                let value = crate::robot::limits::number(*value);
                let what = in_words(path);
                write!(
                    f,
                    "{what} is {value} without a unit, which is read as {value} {read}; it looks like {like}"
                )
            }
            Self::ThickBackbone { thickness, length: of, .. } => write!(
                f,
                "the backbone is {} thick, {} of its length of {}: models of slender rods are inaccurate above {}",
                length(*thickness),
                percent(thickness / of),
                length(*of),
                percent(SLENDER)
            ),
            Self::OutsideDisk { cable, disk, distance, radius, .. } => write!(
                f,
                "cable `{cable}` passes disk {disk} {} from the axis, outside the disk's outer radius of {}",
                length(*distance),
                length(*radius)
            ),
            Self::InsideBackbone { cable, disk, distance, reach, .. } => write!(
                f,
                "cable `{cable}` passes disk {disk} {} from the axis, inside the backbone, whose material reaches to {}",
                length(*distance),
                length(*reach)
            ),
            Self::ShortHoleList { cable, holes, disks, ends_at, .. } => write!(
                f,
                "cable `{cable}` has {holes} holes for {disks} disks: it ends at disk {holes}, {} from the base",
                length(*ends_at)
            ),
            Self::UnusedKey { path, reason, .. } => {
                write!(f, "{} has no effect: {reason}", in_words(path))
            }
            Self::BeyondBuckling { path, force, critical, axial } => {
                let along = if *axial { " along the backbone" } else { "" };
                write!(
                    f,
                    "{} is {}{along}, {} times the load of {} at which the backbone buckles",
                    in_words(path),
                    newtons(*force),
                    short(force / critical),
                    newtons(rounded(*critical))
                )
            }
            Self::DiskSpacing { change, length: of, disks } => write!(
                f,
                "the number of disks changes the answer of cosserat-disks: with half the spacing of {disks} disks the shape moves by {}, {} of the length (more than {})",
                length(*change),
                percent(change / of),
                percent(SPACING)
            ),
            Self::Unstable { stability, lost_at } => {
                write!(
                    f,
                    "the equilibrium is unstable (stability {}): the robot leaves this shape",
                    short(*stability)
                )?;
                lost_at.map_or(Ok(()), |load| {
                    write!(f, "; stability is lost at {} of the load", percent(load))
                })
            }
            Self::NearCritical { stability } => write!(
                f,
                "the equilibrium is almost unstable: stability {}, where the unloaded backbone has 1",
                short(*stability)
            ),
            Self::DisksOverlap { disk, overlap } => write!(
                f,
                "in this shape disks {disk} and {} overlap by {}",
                disk + 1,
                length(*overlap)
            ),
            Self::SelfIntersection { first, second } => {
                write!(f, "the shape passes through itself: {first} and {second} intersect")
            }
            Self::MotorRate { motor, row, rate, limit, others, drive, .. } => {
                let [rate, limit] = match drive {
                    Drive::Spool { .. } => {
                        [*rate, *limit].map(|rate| format!("{} °/s", rounded(rate.to_degrees())))
                    }
                    Drive::Linear => [*rate, *limit].map(|rate| format!("{}/s", length(rate))),
                };
                write!(
                    f,
                    "motor `{motor}` must go at {rate} to `{row}`, but goes at {limit} at most"
                )?;
                match others {
                    0 => Ok(()),
                    1 => f.write_str("; it must go too fast to 1 other row"),
                    others => write!(f, "; it must go too fast to {others} other rows"),
                }
            }
            Self::MotorOverload { motor, effort, limit, drive, .. } => {
                let (effort, limit) = (rounded(*effort), rounded(*limit));
                match drive {
                    Drive::Spool { .. } => write!(
                        f,
                        "motor `{motor}` must hold {effort} N·m, but gives {limit} N·m at most"
                    ),
                    Drive::Linear => write!(
                        f,
                        "the linear drive `{motor}` must hold {}, but gives {} at most",
                        newtons(effort),
                        newtons(limit)
                    ),
                }
            }
            Self::CableInObstacle { cable, obstacle, span, arc_length, depth, force, others } => {
                write!(
                    f,
                    "cable `{cable}` passes through the obstacle `{obstacle}` between disks {} and {}, {} deep at {}",
                    span + 1,
                    span + 2,
                    length(*depth),
                    length(*arc_length)
                )?;
                if let Some(force) = force {
                    write!(
                        f,
                        "; its force on the obstacle, about {}, is left out",
                        newtons(rounded(*force))
                    )?;
                }
                match others {
                    0 => Ok(()),
                    1 => f.write_str("; there is one such place more"),
                    n => write!(f, "; there are {n} such places more"),
                }
            }
            Self::Strain { strain, limit, is_given, arc_length } => write!(
                f,
                "the strain on the backbone's surface reaches {} at {}, above {}{}",
                percent(*strain),
                length(*arc_length),
                if *is_given { "the yield strain of " } else { "" },
                percent(*limit)
            ),
        }
    }
}

impl Warning {
    /// What to do about it.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::Length { .. } => {
                "check the unit of `length`; a robot of this size is solved all the same".to_owned()
            }
            Self::BareNumber { value, units, .. } => {
                let [read, like] = units.names();
                let value = crate::robot::limits::number(*value);
                format!("write \"{value} {like}\", or \"{value} {read}\" if that is meant")
            }
            Self::ThickBackbone { .. } => {
                "check `length` and the cross-section; for a body this thick compare with a measurement".to_owned()
            }
            Self::OutsideDisk { .. } => {
                "check the radius of the cable and `outer_radius` in [disks]".to_owned()
            }
            Self::InsideBackbone { .. } => {
                "check the radius of the cable and the backbone's cross-section; give `inner_diameter` if the cable runs in the bore of a tube; ignore this warning if it runs in a lumen in the wall, and give `stiffness` in [backbone] if the lumens weaken the wall".to_owned()
            }
            Self::ShortHoleList { disks, ends_at, .. } => {
                // Digits that give the file's number again.
                format!(
                    "list {disks} holes, or add `ends_at = \"{}\"` to say that the cable ends there",
                    format_args!("{} mm", significant(ends_at * 1e3, 9, Round::Nearest))
                )
            }
            Self::UnusedKey { help, .. } => (*help).to_owned(),
            Self::BeyondBuckling { .. } => {
                "check the force, its unit and its direction: z points from the base to the tip".to_owned()
            }
            Self::DiskSpacing { disks, .. } => format!(
                "if the cables run in channels of the body, use the model cosserat, or give {} disks or more",
                2 * disks - 1
            ),
            Self::Unstable { .. } => {
                "lower the load or the tension, or list all equilibria with `whipcord solve --branches`".to_owned()
            }
            Self::NearCritical { .. } => {
                "small changes of load or tension move the robot far: check the loads, or keep a distance from the critical load".to_owned()
            }
            Self::DisksOverlap { .. } => {
                "lower the tensions or the loads, or give the disks more space or a smaller radius: the models have no contact between disks".to_owned()
            }
            Self::SelfIntersection { .. } => {
                "lower the tensions or the loads, or check their units and the stiffness: the models have no contact of the robot with itself".to_owned()
            }
            Self::MotorRate { .. } => {
                "check the units of the column `time` and of the commands: the log may not be what the motor did; or correct the limit".to_owned()
            }
            Self::MotorOverload { .. } => {
                "command less, lower the loads or the pretension, or take a stronger motor or gear".to_owned()
            }
            Self::CableInObstacle { .. } => {
                "give more disks, lead the cable elsewhere, or ignore this warning if the force is small beside those of the contacts: cables between disks have no contact".to_owned()
            }
            Self::Strain { is_given: false, .. } => format!(
                "check the tension, the loads and the section; if the material bears more than {}, give `yield_strain` in [backbone]",
                percent(LARGE_STRAIN)
            ),
            Self::Strain { is_given: true, .. } => {
                "check the tension, the loads and the section: beyond it the material does not spring back as the models assume".to_owned()
            }
        }
    }
}
