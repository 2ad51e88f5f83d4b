//! Paths of unknowns, also of those that several cables, motors or segments of the backbone share.

use core::fmt;
use core::str::FromStr;

use super::experiment::Unknown;
use super::quantity::{Quantity, UnknownQuantity};
use super::shared::Shared;
use whipcord::robot::{BackboneSegment, Cable, Motor, Robot};

/// A path of what can be estimated. It becomes an [`Unknown`] when it is known which cables, motors and segments of the
/// backbone a robot has.
///
/// `cables[*].axial_stiffness` is one number for all cables, `cables[segment 1].axial_stiffness` one for the cables of a group,
/// `motors[left].stiffness` that of the motor with this name, and `backbone.segments[near].bending_factor` that of the segment with this
/// name. Of `routing`, the number is a change that all of them share, and of a cable through holes a change too: of how far it is beside their centres.
///
/// ```
/// use whipcord::{Cable, Routing};
/// use whipcord_estimation::identification::{Parts, ParameterPath};
/// let cable = |name: &str, group: &str| Cable {
///     group: Some(group.into()),
///     ..Cable::new(name, Routing::Straight { angle: 0.0, radius: 0.01 })
/// };
/// let cables = [cable("a", "near"), cable("b", "far"), cable("c", "far")];
/// let path: ParameterPath = "cables[far].axial_stiffness".parse()?;
/// let unknown = path.unknown(Parts { cables: &cables, ..Parts::default() })?;
/// let paths: Vec<String> = unknown.quantities().map(|quantity| quantity.to_string()).collect();
/// assert_eq!(paths, ["cables[1].axial_stiffness", "cables[2].axial_stiffness"]);
/// assert_eq!(unknown.path(), "cables[far].axial_stiffness");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParameterPath {
    /// Of a single quantity.
    One(Quantity),
    /// Of cables, motors or segments of the backbone that are named.
    Named {
        /// Which list of the robot.
        list: List,
        /// A name of an entry or of a group, or `*` for all of them.
        name: String,
        /// The path behind the name.
        rest: String,
    },
}

/// A list of a robot whose entries have names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// The cables.
    Cables,
    /// The motors.
    Motors,
    /// The segments of the backbone.
    Segments,
}

impl List {
    const fn name(self) -> &'static str {
        match self {
            Self::Cables => "cables",
            Self::Motors => "motors",
            Self::Segments => "backbone.segments",
        }
    }
}

impl List {
    const fn plural(self) -> &'static str {
        match self {
            Self::Cables => "cables",
            Self::Motors => "motors",
            Self::Segments => "segments of the backbone",
        }
    }
}

impl fmt::Display for List {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The parts of a robot that paths can name.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts<'a> {
    /// The cables.
    pub cables: &'a [Cable],
    /// The motors.
    pub motors: &'a [Motor],
    /// The segments of the backbone.
    pub segments: &'a [BackboneSegment],
}

impl<'a> From<&'a Robot> for Parts<'a> {
    fn from(robot: &'a Robot) -> Self {
        let segments = &robot.backbone().segments;
        Self { cables: robot.cables(), motors: robot.motors(), segments }
    }
}

/// A robot has no such cables, motors or segments.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no {} are called `{name}`, and none belong to a group of this name: {known}; give * for all of them, a number from 0, a \
     name, or a `group` of [[{list}]]", list.plural()
)]
pub struct UnknownGroup {
    /// Which list.
    pub list: List,
    /// The name that it does not have.
    pub name: String,
    /// The names that it has, in words.
    pub known: String,
}

impl FromStr for ParameterPath {
    type Err = UnknownQuantity;

    fn from_str(path: &str) -> Result<Self, UnknownQuantity> {
        if let Ok(quantity) = path.parse() {
            return Ok(Self::One(quantity));
        }
        let unknown = || UnknownQuantity(path.to_owned());
        for list in [List::Cables, List::Motors, List::Segments] {
            let inner = path.strip_prefix(list.name()).and_then(|rest| rest.strip_prefix('['));
            let Some((name, rest)) = inner.and_then(|inner| inner.split_once(']')) else {
                continue;
            };
            let is_number = name.chars().all(|c| c.is_ascii_digit());
            if is_number || format!("{list}[0]{rest}").parse::<Quantity>().is_err() {
                break;
            }
            return Ok(Self::Named { list, name: name.to_owned(), rest: rest.to_owned() });
        }
        Err(unknown())
    }
}

impl fmt::Display for ParameterPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(quantity) => quantity.fmt(f),
            Self::Named { list, name, rest } => write!(f, "{list}[{name}]{rest}"),
        }
    }
}

impl ParameterPath {
    /// The unknown of a robot with these parts.
    ///
    /// # Errors
    /// [`UnknownGroup`] where none of them has the name.
    pub fn unknown<'a>(&self, parts: impl Into<Parts<'a>>) -> Result<Unknown, UnknownGroup> {
        let Parts { cables, motors, segments } = parts.into();
        let (list, name, rest) = match self {
            Self::One(quantity) => {
                let unknown = Unknown::new(*quantity);
                if !quantity.is_of_holes(cables) {
                    return Ok(unknown);
                }
                // It may be negative, which a radius may not.
                let shared = Shared { path: self.to_string(), others: Vec::new(), is_change: true };
                return Ok(Unknown { shared: Some(shared), ..unknown });
            }
            Self::Named { list, name, rest } => (*list, name, rest),
        };
        let entries: Vec<(&str, Option<&str>)> = match list {
            List::Cables => {
                cables.iter().map(|of| (of.name.as_str(), of.group.as_deref())).collect()
            }
            List::Motors => {
                motors.iter().map(|of| (of.name.as_str(), of.group.as_deref())).collect()
            }
            List::Segments => {
                segments.iter().map(|of| (of.name.as_str(), of.group.as_deref())).collect()
            }
        };
        let numbers = 0..entries.len();
        let is_in_group = |i: &usize| name == "*" || entries[*i].1 == Some(name.as_str());
        let group: Vec<usize> = numbers.clone().filter(is_in_group).collect();
        let is_group = !group.is_empty();
        let own = numbers.filter(|i| entries[*i].0 == name.as_str());
        let chosen = if is_group { group } else { own.collect() };
        let quantities = chosen.iter().filter_map(|i| format!("{list}[{i}]{rest}").parse().ok());
        let quantities: Vec<Quantity> = quantities.collect();
        let Some((first, others)) = quantities.split_first() else {
            return Err(UnknownGroup { list, name: name.clone(), known: known(list, &entries) });
        };
        let is_change = (is_group && first.differs_between_cables()) || first.is_of_holes(cables);
        let shared = Shared { path: self.to_string(), others: others.to_vec(), is_change };
        Ok(Unknown { shared: Some(shared), ..Unknown::new(*first) })
    }
}

/// The names and groups that there are.
fn known(list: List, entries: &[(&str, Option<&str>)]) -> String {
    if entries.is_empty() {
        let what = list.plural();
        return format!("the robot has no {what}");
    }
    let what = list.plural();
    let quoted = |names: Vec<&str>| {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        names.join(", ")
    };
    let mut groups: Vec<&str> = entries.iter().filter_map(|(_, group)| *group).collect();
    groups.dedup();
    let names = quoted(entries.iter().map(|(name, _)| *name).collect());
    match groups.is_empty() {
        true => format!("the {what} are {names}, without groups"),
        false => format!("the {what} are {names}, the groups {}", quoted(groups)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::robot::Routing;

    #[test]
    fn paths_name_all_a_group_or_one() {
        let cable = |name: &str, group: Option<&str>| Cable {
            group: group.map(str::to_owned),
            ..Cable::new(name, Routing::Straight { angle: 0.0, radius: 0.01 })
        };
        let cables = [cable("a", Some("b")), cable("b", None), cable("c", Some("b"))];
        let motors = [Motor::linear("b", [(0, 1.0)])];
        let segments = [
            BackboneSegment {
                group: Some("soft".into()),
                ..BackboneSegment::new("near", [0.0, 0.1])
            },
            BackboneSegment::new("far", [0.1, 0.2]),
        ];
        let parts = Parts { cables: &cables, motors: &motors, segments: &segments };
        let numbers = |path: &str| -> Vec<String> {
            let path: ParameterPath = path.parse().unwrap();
            let unknown = path.unknown(parts).unwrap();
            unknown.quantities().map(|quantity| quantity.to_string()).collect()
        };
        assert_eq!(numbers("cables[*].friction").len(), 3);
        // A group comes before a name.
        assert_eq!(numbers("cables[b].friction"), ["cables[0].friction", "cables[2].friction"]);
        assert_eq!(numbers("cables[c].friction"), ["cables[2].friction"]);
        assert_eq!(numbers("motors[b].stiffness"), ["motors[0].stiffness"]);
        let unknown = |path: &str| path.parse::<ParameterPath>().unwrap().unknown(parts);
        let factor = "backbone.segments[1].bending_factor";
        assert_eq!(numbers("backbone.segments[far].bending_factor"), [factor]);
        assert_eq!(numbers("backbone.segments[*].bending_factor").len(), 2);
        assert_eq!(numbers("backbone.segments[soft].torsion_factor").len(), 1);
        let message = unknown("backbone.segments[x].bending_factor").unwrap_err().to_string();
        assert!(message.contains("no segments of the backbone are called `x`"), "{message}");
        let message = unknown("cables[d].friction").unwrap_err().to_string();
        assert!(message.contains("the groups `b`"), "{message}");
        assert!(unknown("motors[d].stiffness").unwrap_err().to_string().contains("without groups"));
        assert!(unknown("cables[*].routing.angle").unwrap().is_change());
        assert!(!unknown("cables[c].routing.angle").unwrap().is_change());
        for wrong in ["cables[*].colour", "cables[*]", "disks[*].mass", "cables[", "cables[9]x"] {
            assert!(wrong.parse::<ParameterPath>().is_err(), "{wrong}");
        }
    }
}
