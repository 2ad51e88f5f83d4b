//! The robot cut at its disks, as sections that bend at few places.

use whipcord_numerics::{GAUSS_3, Vec3};

use super::division::{Division, Energy};
use super::motion::{Coordinates, MOST, MOST_BENT, Motion, bend, coordinates_of};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::robot::{self, Robot};
use crate::section::of_robot::section_at;
use crate::section::{BENDING_AXES, BendingFriction};
use crate::statics::passages::{Passage, passages};

/// What lies between two neighbouring disks.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// Length of the backbone in m.
    pub length: f64,
    /// Stiffness by coordinate in N·m.
    pub stiffness: Coordinates,
    /// Coordinates at rest.
    pub rest: Coordinates,
    /// Rotation vector at rest in rad.
    pub rest_rotation: Vec3,
    /// Friction against bending of each joint, in N·m and rad; none without friction.
    pub friction: Vec<BendingFriction>,
    pub passages: Vec<Passage>,
}

/// The sections from base to tip, and the lengths of the cables on the robot at rest in m.
pub(super) fn sections(
    robot: &Robot,
    model: ModelKind,
    division: &Division,
) -> Result<(Vec<Section>, Vec<f64>), SolveError> {
    refusal::without_disks(model, robot)?;
    let at = &robot.disks().arc_lengths;
    let mut sections = Vec::with_capacity(at.len() - 1);
    for (pair, passages) in at.windows(2).zip(passages(robot)) {
        let length = pair[1] - pair[0];
        let (stiffness, rest) = means(robot, model, pair[0], pair[1])?;
        let (rotation, way) = robot.backbone().rest_rotation(robot.disks(), pair[0], pair[1]);
        let mut section = Section {
            length,
            stiffness: [0.0; MOST],
            rest: [0.0; MOST],
            rest_rotation: rotation.log(),
            friction: Vec::new(),
            passages,
        };
        (section.stiffness[0], section.rest[0]) = (stiffness.z / length, rest.z * length);
        for (k, (joint, share)) in division.joints.iter().zip(division.shares()).enumerate() {
            let (x, y) = (1 + 2 * k, 2 + 2 * k);
            section.stiffness[x] = joint.stiffness * stiffness.x / length;
            section.stiffness[y] = joint.stiffness * stiffness.y / length;
            section.rest[x] = share * rest.x * length;
            section.rest[y] = share * rest.y * length;
            if let Some(given) = &robot.backbone().bending_friction {
                let ratio = robot::BendingFriction::STIFFNESS_RATIO;
                let own =
                    given.yield_stiffness.unwrap_or([ratio * stiffness.x, ratio * stiffness.y]);
                section.friction.push(BendingFriction {
                    limit: given.yield_moment,
                    stiffness: own.map(|own| joint.stiffness * own / length),
                    plastic: [0.0; BENDING_AXES],
                });
            }
        }
        let has_turned_over = match division.energy {
            Energy::Coordinates => bend(&section.rest) >= MOST_BENT,
            Energy::RotationVector => {
                section.rest = coordinates_of(division, rotation);
                way >= MOST_BENT
            }
        };
        if has_turned_over {
            return Err(SolveError::Unsupported {
                model,
                path: "backbone.rest_curvature".to_owned(),
                what: "a section that turns by half a turn or more at rest",
                advice: "put more disks on it, or use cosserat",
            });
        }
        sections.push(section);
    }
    let lengths = rest_lengths(division, &sections, robot.cables().len());
    Ok((sections, lengths))
}

/// The lengths of so many cables on sections at rest in m.
pub(super) fn rest_lengths(division: &Division, sections: &[Section], cables: usize) -> Vec<f64> {
    let mut lengths = vec![0.0; cables];
    for section in sections {
        let motion = Motion::new(division, section.length, &section.rest);
        for passage in &section.passages {
            let way = if passage.is_anchored_inside() {
                Motion::up_to(division, section.length, &section.rest, passage.reach).way(passage)
            } else {
                motion.way(passage)
            };
            lengths[passage.cable] += way.norm();
        }
    }
    lengths
}

impl Motion {
    /// A cable's way through the section, where this is the cross-section at its end.
    pub fn way(&self, passage: &Passage) -> Vec3 {
        self.end + self.rotation * passage.far - passage.near
    }
}

/// Of the backbone between two arc lengths: stiffness `EI_x, EI_y, GJ` in N·m² that one moment would find, and mean
/// rest curvature in 1/m.
fn means(robot: &Robot, model: ModelKind, from: f64, to: f64) -> Result<(Vec3, Vec3), SolveError> {
    let backbone = robot.backbone();
    let mut places = backbone.places();
    places.retain(|s| from < *s && *s < to);
    places.extend([from, to]);
    places.sort_by(f64::total_cmp);
    let (mut compliance, mut rest) = (Vec3::ZERO, Vec3::ZERO);
    for piece in places.windows(2) {
        let (h, middle) = (piece[1] - piece[0], 0.5 * (piece[0] + piece[1]));
        for (t, weight) in GAUSS_3.nodes.iter().zip(GAUSS_3.weights) {
            let s = piece[0] + t * h;
            let section = section_at(robot, s, middle).map_err(|error| error.of(model))?;
            if section.coupling().is_some() {
                return Err(SolveError::Unsupported {
                    model,
                    path: "backbone.stiffness.matrix".to_owned(),
                    what: "strains that are coupled",
                    advice: "its joints bend and twist each by itself: use cosserat-disks",
                });
            }
            let part = weight * h / (to - from);
            compliance += section.compliance.bending * part;
            rest += section.rest_curvature * part;
        }
    }
    let stiffness = Vec3::new(1.0 / compliance.x, 1.0 / compliance.y, 1.0 / compliance.z);
    Ok((stiffness, rest))
}
