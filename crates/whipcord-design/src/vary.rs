//! What a design varies.

use core::fmt;

use whipcord::{ModelKind, Parameter, Robot, Routing};

/// What a design varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vary {
    /// The holes that a cable goes through.
    Holes {
        /// Cable, from 0.
        cable: usize,
    },
    /// The continuous routing of a cable, as polynomials in the arc length.
    Routing {
        /// Cable, from 0.
        cable: usize,
    },
    /// The tension of a cable, for each target by itself.
    Tension {
        /// Cable, from 0.
        cable: usize,
    },
    /// The rest curvature along the backbone.
    RestCurvature,
    /// The diameter along the backbone.
    Diameters,
    /// The arc lengths of the disks between the first and the last.
    DiskPositions,
    /// How many cables there are, with their routings and tensions.
    Cables,
    /// One number of the robot.
    Parameter(Parameter),
}

impl fmt::Display for Vary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Holes { cable } => write!(f, "cables[{cable}].holes"),
            Self::Routing { cable } => write!(f, "cables[{cable}].routing"),
            Self::Tension { cable } => write!(f, "cables[{cable}].tension"),
            Self::RestCurvature => f.write_str("backbone.rest_curvature"),
            Self::Diameters => f.write_str("backbone.diameters"),
            Self::DiskPositions => f.write_str("disks.positions"),
            Self::Cables => f.write_str("cables"),
            Self::Parameter(parameter) => parameter.fmt(f),
        }
    }
}

/// A text that names nothing that a design can vary.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is nothing that can be varied{reason}: give {known}")]
pub struct UnknownVary {
    /// The text.
    pub text: String,
    /// Why not, where that is known.
    pub reason: String,
    /// What can be given.
    pub known: &'static str,
}

const KNOWN: &str = "cables[0].holes, cables[0].routing, cables[0].tension (a number from 0, a name or * for all in the brackets), backbone.rest_curvature, backbone.diameters, disks.positions, cables, or a number of the robot such as backbone.young_modulus";

impl Vary {
    /// What a path of the robot file names: `cables[0].holes`, `cables[pull].routing`, `cables[*].tension`, `backbone.rest_curvature`,
    /// `backbone.diameters`, `disks.positions`, `cables` for their number, or a number of the robot. `holes`, `routing` and `tension` alone are those of all cables.
    ///
    /// # Errors
    /// [`UnknownVary`] for a path of something else, or of a cable that the robot does not have.
    pub fn parse(path: &str, robot: &Robot) -> Result<Vec<Self>, UnknownVary> {
        let unknown = |reason: String| UnknownVary { text: path.to_owned(), reason, known: KNOWN };
        match path {
            "cables" => return Ok(vec![Self::Cables]),
            "backbone.rest_curvature" | "rest_curvature" => return Ok(vec![Self::RestCurvature]),
            "backbone.diameters" | "diameters" => return Ok(vec![Self::Diameters]),
            "disks.positions" => return Ok(vec![Self::DiskPositions]),
            _ => {}
        }
        let (name, quantity) = match path {
            "holes" | "routing" | "tension" => (Some("*"), path),
            _ => match path.strip_prefix("cables").and_then(|rest| rest.rsplit_once('.')) {
                Some((name, quantity)) => {
                    let bracketed = name.strip_prefix('[').and_then(|name| name.strip_suffix(']'));
                    (bracketed.or_else(|| name.strip_prefix('.')), quantity)
                }
                None => (None, ""),
            },
        };
        if let (Some(name), "holes" | "routing" | "tension") = (name, quantity) {
            let cables = cables(name, robot);
            if cables.is_empty() {
                let names: Vec<&str> = robot.cables().iter().map(|of| of.name.as_str()).collect();
                let reason = match names.is_empty() {
                    true => " (the robot has no cables)".to_owned(),
                    false => format!(
                        " (there is no cable `{name}`: the cables are {})",
                        names.join(", ")
                    ),
                };
                return Err(unknown(reason));
            }
            let has_holes =
                |cable: &usize| matches!(robot.cables()[*cable].routing, Routing::Holes { .. });
            return Ok(match quantity {
                // Of all cables those that go through holes, where some do.
                "holes" if name == "*" && cables.iter().any(has_holes) => cables
                    .into_iter()
                    .filter(has_holes)
                    .map(|cable| Self::Holes { cable })
                    .collect(),
                "holes" => cables.into_iter().map(|cable| Self::Holes { cable }).collect(),
                "routing" => cables.into_iter().map(|cable| Self::Routing { cable }).collect(),
                _ => cables.into_iter().map(|cable| Self::Tension { cable }).collect(),
            });
        }
        let parameter: Parameter = path.parse().map_err(|_| unknown(String::new()))?;
        let is_of_case = parameter.is_load() || parameter.motor().is_some();
        let is_written =
            !matches!(parameter, Parameter::HoleAngle { .. } | Parameter::StiffnessScale(_));
        match is_of_case || !is_written {
            true => Err(unknown(" (it is no quantity of the robot itself)".to_owned())),
            false => Ok(vec![Self::Parameter(parameter)]),
        }
    }

    /// The model that answers best what is varied: holes are those of cables that run straight from disk to disk, all else is that of the rod.
    #[must_use]
    pub fn usual_model(vary: &[Self]) -> ModelKind {
        let is_of_disks = |of: &Self| matches!(of, Self::Holes { .. } | Self::DiskPositions);
        match vary.iter().any(is_of_disks) {
            true => ModelKind::CosseratDisks,
            false => ModelKind::Cosserat,
        }
    }
}

/// Numbers of the cables of this number, name or group, or of all.
fn cables(name: &str, robot: &Robot) -> Vec<usize> {
    let all = 0..robot.cables().len();
    if name == "*" {
        return all.collect();
    }
    let of_group: Vec<usize> =
        all.clone().filter(|&k| robot.cables()[k].group.as_deref() == Some(name)).collect();
    if !of_group.is_empty() {
        return of_group;
    }
    let named = all.clone().find(|&k| robot.cables()[k].name == name);
    let numbered = || name.parse().ok().filter(|number| all.contains(number));
    named.or_else(numbered).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{Backbone, Cable, Disks};

    #[test]
    fn paths_name_cables_by_number_name_and_all() {
        let disks = Disks::equally_spaced(0.1, 3, 0.008).with_holes(12);
        let cables = vec![
            Cable::new("pull", Routing::holes(vec![1, 1, 1])),
            Cable::new("back", Routing::Straight { angle: 0.0, radius: 0.01 }),
        ];
        let robot = Robot::new(Backbone::new(0.1), disks, cables).unwrap();
        let of = |path: &str| Vary::parse(path, &robot);
        assert_eq!(of("cables[0].holes"), Ok(vec![Vary::Holes { cable: 0 }]));
        assert_eq!(of("cables.pull.holes"), Ok(vec![Vary::Holes { cable: 0 }]));
        assert_eq!(of("cables[back].routing"), Ok(vec![Vary::Routing { cable: 1 }]));
        assert_eq!(of("holes"), Ok(vec![Vary::Holes { cable: 0 }]));
        assert_eq!(of("tension").map(|of| of.len()), Ok(2));
        assert_eq!(of("cables"), Ok(vec![Vary::Cables]));
        assert_eq!(of("backbone.diameter"), Ok(vec![Vary::Parameter(Parameter::Diameter)]));
        for wrong in ["cables[2].holes", "cables[x].holes", "loads.gravity[0]", "colour", ""] {
            assert!(of(wrong).is_err(), "{wrong}");
        }
        for vary in ["cables[0].holes", "backbone.diameters", "disks.positions", "cables"] {
            assert_eq!(of(vary).unwrap()[0].to_string(), vary);
        }
    }
}
