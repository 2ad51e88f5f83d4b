//! What to do about each problem.

use whipcord::Problem;
use whipcord::robot::limits::number;
use whipcord_estimation::identification::UnknownGroup;

use crate::error::{CommandedMotor, FileProblem};
use crate::schema::FEW_CHOICES;
use crate::source::quoted;
use crate::units::{Dimension, QuantityError, listed, parse_quantity};

impl FileProblem {
    /// What to do about it.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::Unreadable { missing: true, .. } => {
                "check the path; it is relative to the folder you are in".to_owned()
            }
            Self::NamedUnreadable { missing: true, .. } => {
                "check the path; it is relative to the folder of the file that names it".to_owned()
            }
            Self::Unreadable { .. } | Self::NamedUnreadable { .. } => {
                "check that it is a file and that you may read it".to_owned()
            }
            Self::TooLarge { .. } => {
                "a robot file takes a few kilobytes, a table of what was measured or a mesh a few megabytes: is this the file you meant?".to_owned()
            }
            Self::NotUtf8 { .. } => {
                "is this the file you meant? If so, save it as UTF-8 text".to_owned()
            }
            Self::Syntax { help, .. }
            | Self::Camera { help, .. }
            | Self::UnknownKey { help, .. }
            | Self::WrongType { help, .. } => help.clone(),
            Self::UnknownQuantity { near: Some(near), .. } => format!("did you mean `{near}`?"),
            Self::UnknownQuantity { near: None, .. } => "give a path of the robot file such as backbone.young_modulus, cables[0].tension_offset or base.position[2], counting from 0".to_owned(),
            Self::UnknownGroup(UnknownGroup { list, known, .. }) => format!(
                "{known}; give * for all of them, a number from 0, a name, or a `group` of [[{list}]]"
            ),
            Self::NotEstimated { .. } => "name it in `parameters` or `each` as well, or take this table out".to_owned(),
            Self::TooDeep => "no robot file needs more than three levels: is this the file you meant?".to_owned(),
            Self::CyclicExtends { .. } => {
                "remove one `extends` of the circle: the file that describes the bare robot extends nothing".to_owned()
            }
            Self::TooManyExtends { .. } => "merge some of the files".to_owned(),
            Self::Missing { example, .. } => format!("add {}", line(example)),
            Self::MissingOneOf { exclusive, example, .. } => {
                let how_many = if *exclusive { "exactly one" } else { "at least one" };
                format!("give {how_many} of them, for example {}", line(example))
            }
            Self::Exclusive { .. } => "remove one of the two".to_owned(),
            Self::GivenTwice { .. } => "merge the two entries".to_owned(),
            Self::NoNameToMerge { what, names, .. } => {
                let names = names.iter().map(|name| format!("`{}`", quoted(name))).collect::<Vec<_>>();
                let names = listed(names.iter().map(String::as_str), "or");
                format!("give it the `name` {names} to change that {what}, or a new name to add a {what}")
            }
            Self::NothingToRemove { what, names, .. } if names.is_empty() => {
                format!("remove this entry: there is no {what} of this name in a file that this one extends")
            }
            Self::NoTableToRemove { .. } => {
                "remove this entry: no file that this one extends has the table".to_owned()
            }
            Self::NothingToRemove { what, names, .. } => {
                let names = names.iter().map(|name| format!("`{}`", quoted(name))).collect::<Vec<_>>();
                let names = listed(names.iter().map(String::as_str), "and");
                format!("the {what}s of the file that this one extends are {names}")
            }
            Self::UnknownCable { names, .. } if names.is_empty() => {
                "add [[cables]] that the motor can pull".to_owned()
            }
            Self::UnknownCable { names, .. } => {
                format!("the cables are {}", listed(names.iter().map(String::as_str), "and"))
            }
            Self::OtherDrive { .. } => {
                "a motor with a `spool_radius` turns, one without is a linear drive".to_owned()
            }
            Self::Needs { key, example, .. } => format!("add {}, or remove `{key}`", line(example)),
            Self::Quantity { key, error, expected } => quantity_help(key, error, expected),
            Self::NotFinite { .. } => "write a finite number".to_owned(),
            Self::OutOfRange { value: ..=0, numbers: true, .. } => {
                "hole 1 lies on the x axis and the others follow counter-clockwise; add 1 to each number if yours count from 0".to_owned()
            }
            Self::OutOfRange { value, least, .. } => {
                if i64::try_from(*least).is_ok_and(|least| *value < least) {
                    format!("write {least} or more")
                } else {
                    "write a smaller number".to_owned()
                }
            }
            Self::WrongCount { expected, given, .. } => {
                if given > expected {
                    format!("leave out {}", values(given - expected))
                } else {
                    format!("add {}", values(expected - given))
                }
            }
            Self::Empty { example, .. } => format!("write for example `{example}`"),
            Self::UnknownChoice { choices, near, .. } => match near {
                // Of many the nearest may well not be the one.
                Some(near) if choices.len() > FEW_CHOICES => {
                    let all = listed(choices.iter().copied(), "and");
                    format!("did you mean `{near}`? The choices are {all}")
                }
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("choose {}", listed(choices.iter().copied(), "or")),
            },
            Self::Mesh { .. } => {
                "is this the file you meant? If so, export the part anew as binary STL".to_owned()
            }
            Self::Physical { problem, .. } => physical_help(problem),
            Self::ShorterThanNothing { motor: Some(motor), .. } => {
                let CommandedMotor { name, command, is_angle } = &**motor;
                let (si, unit) = if *is_angle { ("rad", "deg") } else { ("m", "mm") };
                format!(
                    "the motor `{name}` is told {} {si}: give the unit of its command, in a table in the name of the column, as `{name} [{unit}]`",
                    number(*command)
                )
            }
            Self::ShorterThanNothing { without_unit: Some(number), .. } => format!(
                "a number without a unit is in metres: write \"{number} %\" of the cable's length, or \"{number} mm\""
            ),
            Self::ShorterThanNothing { length, .. } => {
                format!("give less than {length:.4} m, or a part of the cable's length such as \"5.7 %\"")
            }
            Self::Measured { help, .. } => help.to_string(),
            Self::Needed { help, .. } | Self::NotTaken { help, .. } => (*help).to_owned(),
        }
    }
}

/// A line of TOML in a sentence; a header is a table.
fn line(example: &str) -> String {
    if example.starts_with('[') { format!("a table {example}") } else { format!("`{example}`") }
}

fn values(count: usize) -> String {
    if count == 1 { "1 value".to_owned() } else { format!("{count} values") }
}

fn quantity_help(key: &str, error: &QuantityError, expected: &[Dimension]) -> String {
    let example = expected.first().map_or("", |dimension| dimension.example());
    let names: Vec<&str> = expected.iter().flat_map(|d| d.units()).map(|unit| unit.name).collect();
    let units = listed(names, "or");
    let is_ratio = expected == [Dimension::Ratio];
    match error {
        QuantityError::NoNumber(_) => {
            format!("write a number and a unit, for example \"{example}\"; units: {units}")
        }
        QuantityError::DecimalComma(_) => "write a decimal point instead of the comma".to_owned(),
        QuantityError::TooLarge(_) => format!("write for example \"{example}\""),
        // Without quotes it would be in m, and more than most cables are long.
        QuantityError::NoUnit(number)
            if [Dimension::Length, Dimension::Ratio].iter().all(|of| expected.contains(of)) =>
        {
            format!("write \"{number} %\" of the cable's length, or \"{number} mm\"")
        }
        QuantityError::NoUnit(number) => {
            match expected.first().map(|dimension| dimension.si_unit()) {
                Some("") | None => format!("write {number} without quotes, or with %"),
                Some(si) => format!("add one of {units}; without quotes, {number} is in {si}"),
            }
        }
        QuantityError::UnknownUnit { near, .. } if !near.is_empty() => {
            let near: Vec<String> = near.iter().map(|unit| unit.described()).collect();
            format!("did you mean {}?", listed(near.iter().map(String::as_str), "or"))
        }
        QuantityError::WrongUnit { measures, text, .. } => {
            wrong_unit(key, *measures, text, expected).unwrap_or_else(|| match is_ratio {
                true => "write a plain number, or one with %".to_owned(),
                false => format!("use {units}"),
            })
        }
        QuantityError::UnknownUnit { .. } if is_ratio => {
            "write a plain number, or one with %".to_owned()
        }
        QuantityError::UnknownUnit { .. } => format!("use {units}"),
    }
}

/// What to write instead of a quantity that measures something else, where that can be told.
fn wrong_unit(
    key: &str,
    measures: Dimension,
    text: &str,
    expected: &[Dimension],
) -> Option<String> {
    let unit = text.trim_start_matches(|c: char| !c.is_alphabetic() && c != '°').trim();
    let number = text.strip_suffix(unit)?.trim();
    let instead = |unit: &str| format!("write \"{number} {unit}\"");
    match measures {
        Dimension::Mass if expected.contains(&Dimension::Force) => {
            let weight = match unit {
                "kg" => "kgf",
                "g" => "gf",
                "lb" => "lbf",
                "oz" => "ozf",
                _ => return Some("the weight of a mass is in gf or kgf: \"400 gf\"".to_owned()),
            };
            Some(format!("{}, the weight of that mass", instead(weight)))
        }
        Dimension::Mass if expected.contains(&Dimension::Acceleration) && unit == "g" => {
            Some(format!("{}: `g0` is the standard acceleration of gravity", instead("g0")))
        }
        Dimension::Angle if key == "turns" => {
            let (angle, _) = parse_quantity(text, &[Dimension::Angle]).ok()?;
            let turns = (angle / core::f64::consts::TAU * 1e9).round() / 1e9;
            Some(format!("write {turns}, the number of full turns"))
        }
        Dimension::LineForce if key == "axial_stiffness" => Some(
            "`axial_stiffness` is Young's modulus times cross-section, in N: a stiffness in N/m times the length of the cable".to_owned(),
        ),
        _ => None,
    }
}

fn physical_help(problem: &Problem) -> String {
    match *problem {
        Problem::NotFinite { .. } => "write a finite number".to_owned(),
        Problem::NotPositive { .. } => "give a value greater than zero".to_owned(),
        Problem::Negative { .. } => "give zero or a value greater than zero".to_owned(),
        Problem::OutOfRange { range, .. } => format!("give a value {range}"),
        Problem::ThickerThanSpacing { .. } => {
            "make the disks thinner, or place them farther apart".to_owned()
        }
        Problem::ThickerThanWide { .. } => {
            "make the disks thinner, or their `outer_radius` larger".to_owned()
        }
        Problem::TooClose { least, .. } => {
            format!("put them at least {} m apart", number(least))
        }
        Problem::CountOfPlaces { given, expected } => {
            if given > expected {
                format!("leave out {}, or add places to `at`", values(given - expected))
            } else {
                format!("add {}, or remove places from `at`", values(expected - given))
            }
        }
        Problem::GivenTwice { .. } => "remove one of the two".to_owned(),
        Problem::StiffnessMissing { hold } => {
            format!("give it, or write `{hold} = false` under [backbone]")
        }
        Problem::NotSymmetric { .. } => "make the two entries equal".to_owned(),
        Problem::NotPositiveDefinite { .. } => {
            "check the units of the entries, and that the coupling K_ij stays below the root of K_ii K_jj".to_owned()
        }
        Problem::Count { given, expected } => {
            if given > expected {
                format!("leave out {}, or add disks", values(given - expected))
            } else {
                format!("add {}, or remove disks", values(expected - given))
            }
        }
        Problem::TooFew { least, .. } => format!("give {least} or more"),
        Problem::MoreHolesThanDisks { given, disks } => {
            format!("leave out {}, or add disks under [disks]", values(given - disks.min(given)))
        }
        Problem::NoSuchHole { holes, .. } => {
            format!(
                "holes count from 1: name one from 1 to {holes}, or raise `holes` under [disks]"
            )
        }
        Problem::DisksWithoutHoles => {
            "for example `holes = 12` and `hole_circle_radius = \"8 mm\"` under [disks]".to_owned()
        }
        Problem::HolesWithoutDisks => {
            "give the cable a `routing` instead of `holes`, such as `routing = { kind = \"straight\", angle = \"90 deg\", radius = \"8 mm\" }`, or add [disks] with `count`, `holes` and `hole_circle_radius`".to_owned()
        }
        Problem::ListWithoutDisks => {
            "give arc lengths as well, in a table `{ at = [...], values = [...] }` or in `at` beside it, or add [disks]".to_owned()
        }
        Problem::NotIncreasing { .. } => {
            "put the positions in ascending order, each once".to_owned()
        }
        Problem::NotAtEnd { expected, .. } => {
            format!("write {}, in m, or the same with a unit", number(expected))
        }
        Problem::BeyondTip { length, .. } => {
            format!("give a place from 0 to {} m, or lengthen the backbone", number(length))
        }
        Problem::BeyondLastHole { last, .. } => format!("give at most {} m", number(last)),
        Problem::BoreTooWide { .. } => "make the bore smaller or the tube thicker".to_owned(),
        Problem::NoSuchCable { cables, .. } => {
            format!("cables count from 1: name one from 1 to {cables}")
        }
        Problem::FactorOnMatrix => "leave the factor out".to_owned(),
        Problem::TwoMotors { .. } => "leave the cable to one of the two motors".to_owned(),
        Problem::NotAscending { .. } => "exchange the two values".to_owned(),
        Problem::RigidUnderPretension => {
            "for example `stiffness = \"5 N/mm\"`, or leave the pretension out".to_owned()
        }
        Problem::BeyondMotorLimit { .. } => {
            "change the command, or the limits under [[motors]]".to_owned()
        }
        Problem::MotorCount { motors, .. } => format!("give {motors}, one for each motor"),
        Problem::DuplicateName { .. } => "rename one of the two".to_owned(),
        Problem::TooMany { most, .. } => format!("give {most} or fewer"),
        Problem::TooNear { .. } => "leave out one of the two".to_owned(),
        Problem::TurnsBack => "leave it out, or give more points around it".to_owned(),
        Problem::BendsTooSharply { .. } => {
            "give a gentler bend or a thinner bore, or write `bends = \"corners\"`".to_owned()
        }
        Problem::NoTriangles => {
            "is this the file you meant? Export the surface of the body as triangles".to_owned()
        }
        Problem::FlatTriangles { .. } => {
            "remove degenerate triangles in a program for meshes, such as MeshLab".to_owned()
        }
        Problem::OpenEdges { .. } => {
            "close the holes in a program for meshes, such as MeshLab".to_owned()
        }
        Problem::CrowdedEdges { .. } => {
            "give bodies that touch along an edge as an obstacle each".to_owned()
        }
        Problem::OpposedTriangles { .. } => {
            "let a program for meshes, such as MeshLab, orient all triangles alike".to_owned()
        }
        Problem::InsideOut { .. } => {
            "flip the triangles in a program for meshes, such as MeshLab".to_owned()
        }
        Problem::NoDirection => "give a vector that is not zero".to_owned(),
        Problem::StationCount { expected, given } => {
            if given > expected {
                format!("leave out {}, or add places to `at`", values(given - expected))
            } else {
                format!("add {}, or remove places from `at`", values(expected - given))
            }
        }
        Problem::CableCount { cables, .. } => format!("give {cables}, one for each cable"),
        // What no file can cause, such as a model built for other loads than it is asked about.
        _ => "change this quantity".to_owned(),
    }
}
