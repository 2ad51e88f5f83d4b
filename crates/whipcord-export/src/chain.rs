//! The robot as a chain of rigid bodies with three hinges between neighbours.
//!
//! A body stands for the stretch of backbone around a node. Halfway between two nodes, where the bodies meet, three hinges turn
//! about the principal axes of the section's compliance, each with the stiffness of the whole stretch between the nodes. Three
//! hinges are no rotation vector: bending about two axes also twists by half of the product of both angles. Their order
//! is reversed from joint to joint, so that this cancels and the error is of second order in the distance of the nodes.

use whipcord::section::{section_compliance, section_stiffness};
use whipcord::{Case, Disks, Mat3, Pose, Robot, Shape, Twist, UnitQuaternion, Vec3};
use whipcord_motion::Damping;
use whipcord_numerics::{GAUSS_3, magnus_6};
use whipcord_plot::{Plate, plates_of};

use crate::error::ExportError;
use crate::places::nearest;

/// Density in kg/m³ where the file gives none.
pub const DENSITY: f64 = 1000.0;
/// Mass per length in kg/m where there is no section either.
pub const LINEAR_DENSITY: f64 = 0.01;
/// Damping time in s where the file gives no damping.
pub const DAMPING_TIME: f64 = 0.02;
/// Steps by which a half of an element at rest is integrated; the rule is of order 6.
const STEPS: usize = 2;

/// A robot as a chain.
#[derive(Clone, Debug)]
pub struct Chain {
    /// From the base, which is fixed, to the tip.
    pub nodes: Vec<Node>,
    /// One between each two nodes.
    pub joints: Vec<Joint>,
    /// Disks as they are drawn; none for a robot without.
    pub plates: Vec<Plate>,
}

/// A rigid body of the chain. Its frame is that of the cross-section at the node.
#[derive(Clone, Debug)]
pub struct Node {
    /// In m.
    pub arc_length: f64,
    /// Pose at rest, in the frame of the base.
    pub rest: Pose,
    /// The disk at this place, from 0.
    pub disk: Option<usize>,
    /// In kg.
    pub mass: f64,
    /// Centre of mass, in its frame.
    pub center: Vec3,
    /// Moments of inertia in kg·m² about axes through the centre of mass that are parallel to those of its frame.
    pub inertia: Vec3,
    /// Ends of its stretch of the backbone, in its frame.
    pub ends: [Vec3; 2],
    /// Radius in m of the circle around the section; 0 where none is given.
    pub radius: f64,
}

/// Three hinges between two bodies.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Frame of the hinges in that of the body nearer to the base.
    pub before: Pose,
    /// Frame of the other body in that of the hinges, at rest.
    pub after: Pose,
    /// Principal axes in the frame of the hinges, right-handed.
    axes: [Vec3; 3],
    /// Whether the hinges stand in the reverse order of the axes.
    is_reversed: bool,
    /// In N·m/rad, for each axis.
    stiffness: [f64; 3],
    /// In N·m·s/rad, for each axis.
    damping: [f64; 3],
}

/// One hinge.
#[derive(Clone, Copy, Debug)]
pub struct Hinge {
    /// Axis in the frame of the joint.
    pub axis: Vec3,
    /// Number of the principal axis: 0 and 1 bend, 2 twists, where the stiffness is not coupled.
    pub number: usize,
    /// In N·m/rad; 0 in a chain without springs.
    pub stiffness: f64,
    /// In N·m·s/rad; 0 in a chain without springs.
    pub damping: f64,
}

impl Joint {
    /// The hinges in the order in which they turn, from the base on.
    pub fn hinges(&self) -> [Hinge; 3] {
        self.order().map(|k| Hinge {
            axis: self.axes[k],
            number: k,
            stiffness: self.stiffness[k],
            damping: self.damping[k],
        })
    }

    /// The least stiffness of the hinges in N·m/rad.
    pub fn least_stiffness(&self) -> f64 {
        self.stiffness.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The least stiffness of the two hinges that bend, in N·m/rad; of all where bending and twist are coupled.
    pub fn least_bending(&self) -> f64 {
        let is_axial = self.axes[2].z.abs() > 1.0 - 1e-12;
        let count = if is_axial { 2 } else { 3 };
        self.stiffness[..count].iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn order(&self) -> [usize; 3] {
        if self.is_reversed { [2, 1, 0] } else { [0, 1, 2] }
    }

    /// The angles in rad of [`Self::hinges`] at which the second body is turned like this against the first; `None` beyond a
    /// right angle, where they are not unique.
    fn angles(&self, turn: UnitQuaternion) -> Option<[f64; 3]> {
        let turn = self.before.rotation.conjugate() * turn * self.after.rotation.conjugate();
        let columns = self.axes.map(|axis| turn.rotate(axis));
        let r = |i: usize, j: usize| self.axes[i].dot(columns[j]);
        let angles = if self.is_reversed {
            [r(1, 0).atan2(r(0, 0)), (-r(2, 0)).clamp(-1.0, 1.0).asin(), r(2, 1).atan2(r(2, 2))]
        } else {
            [(-r(1, 2)).atan2(r(2, 2)), r(0, 2).clamp(-1.0, 1.0).asin(), (-r(0, 1)).atan2(r(0, 0))]
        };
        angles.iter().all(|angle| angle.abs() < 1.5).then_some(angles)
    }

    /// The rotation of the hinges at these angles.
    fn rotation(&self, angles: [f64; 3]) -> UnitQuaternion {
        let turns = self.hinges().map(|hinge| hinge.axis);
        let turn = |k: usize| UnitQuaternion::exp(turns[k] * angles[k]);
        turn(0) * turn(1) * turn(2)
    }
}

impl Chain {
    /// The chain with bodies at these arc lengths in m. Hinges have springs and dampers where a damping is given, else they are free.
    ///
    /// # Errors
    /// [`ExportError::Solve`] where springs are asked for and the stiffness is not known.
    pub fn new(
        robot: &Robot,
        case: &Case,
        places: &[f64],
        damping: Option<&Damping>,
    ) -> Result<Self, ExportError> {
        let (disks, plates) = (robot.disks(), plates_of(robot));
        let mut joints = Vec::with_capacity(places.len().saturating_sub(1));
        let mut rests = vec![Pose::IDENTITY];
        for (k, ends) in places.windows(2).enumerate() {
            let middle = 0.5 * (ends[0] + ends[1]);
            let (before, after) =
                (at_rest(robot, ends[0], middle), at_rest(robot, middle, ends[1]));
            let free = ([Vec3::X, Vec3::Y, Vec3::Z], [0.0; 3], [0.0; 3]);
            let (axes, stiffness, damping) = damping
                .map_or(Ok(free), |damping| elasticity(robot, [ends[0], ends[1]], damping))?;
            let is_reversed = k % 2 == 1;
            joints.push(Joint { before, after, axes, is_reversed, stiffness, damping });
            let last = rests[k];
            rests.push(last * before * after);
        }
        let mut nodes = Vec::with_capacity(places.len());
        for (k, &arc_length) in places.iter().enumerate() {
            let back = k.checked_sub(1).map(|k| joints[k].after.inverse().position);
            let ahead = joints.get(k).map(|joint| joint.before.position);
            let halves = [
                (back, k.checked_sub(1).map(|k| 0.5 * (places[k] + arc_length))),
                (ahead, places.get(k + 1).map(|next| 0.5 * (arc_length + next))),
            ];
            let mut bulk = Bulk::default();
            for (end, at) in halves {
                let (Some(end), Some(at)) = (end, at) else { continue };
                bulk.add_stretch(robot, arc_length, at, end);
            }
            let disk = if robot.has_disks() {
                disks.arc_lengths.iter().position(|&s| nearest(places, s) == k)
            } else {
                None
            };
            if let Some(plate) = disk.and_then(|disk| plates.get(disk)) {
                bulk.add_plate(disks.mass, plate);
            }
            let carried = case.loads.masses.iter().filter(|mass| nearest(places, mass.at) == k);
            bulk.add(carried.map(|mass| mass.mass).sum(), Vec3::ZERO, Vec3::ZERO);
            let (mass, center, inertia) = bulk.total();
            let ends = [back.unwrap_or(Vec3::ZERO), ahead.unwrap_or(Vec3::ZERO)];
            let radius = robot.backbone().outer_radius_at(disks, arc_length);
            nodes.push(Node {
                arc_length,
                rest: rests[k],
                disk,
                mass,
                center,
                inertia,
                ends,
                radius,
            });
        }
        Ok(Self { nodes, joints, plates })
    }

    /// The angles of all hinges in rad at which the bodies are turned as the cross-sections of a shape with these stations.
    ///
    /// # Errors
    /// [`ExportError::BentTooFar`] where a joint would have to bend by more than a right angle.
    pub fn angles(&self, shape: &Shape) -> Result<Vec<[f64; 3]>, ExportError> {
        let pairs = shape.poses.windows(2).zip(&self.joints).zip(&self.nodes);
        pairs
            .map(|((poses, joint), node)| {
                let turn = poses[0].rotation.conjugate() * poses[1].rotation;
                joint.angles(turn).ok_or_else(|| ExportError::BentTooFar {
                    arc_length: node.arc_length,
                    angle: turn.log().norm(),
                })
            })
            .collect()
    }

    /// The poses of the bodies at these angles, on a base of this pose.
    pub fn poses(&self, base: Pose, angles: &[[f64; 3]]) -> Vec<Pose> {
        let mut poses = vec![base];
        let mut pose = base;
        for (joint, angles) in self.joints.iter().zip(angles) {
            let turn = Pose { rotation: joint.rotation(*angles), ..Pose::IDENTITY };
            pose = pose * joint.before * turn * joint.after;
            poses.push(pose);
        }
        poses
    }
}

/// The pose of the cross-section at `to` in that at `from`, at rest.
fn at_rest(robot: &Robot, from: f64, to: f64) -> Pose {
    let h = (to - from) / STEPS as f64;
    (0..STEPS).fold(Pose::IDENTITY, |pose, k| {
        let twists = GAUSS_3.nodes.map(|node| {
            let s = from + (k as f64 + node) * h;
            let angular = robot.backbone().rest_curvature_at(robot.disks(), s);
            Twist { linear: Vec3::Z, angular } * h
        });
        pose * magnus_6(&twists)
    })
}

/// Principal axes, stiffness and damping of the hinges for a stretch of the backbone.
type Elasticity = ([Vec3; 3], [f64; 3], [f64; 3]);

fn elasticity(
    robot: &Robot,
    [from, to]: [f64; 2],
    damping: &Damping,
) -> Result<Elasticity, ExportError> {
    let h = to - from;
    let mut compliance = Mat3::ZERO;
    for (node, weight) in GAUSS_3.nodes.into_iter().zip(GAUSS_3.weights) {
        let s = from + node * h;
        let Some([_, _, bending]) = section_compliance(robot, s) else {
            let unknown = section_stiffness(robot, s, s).err();
            let error = unknown.unwrap_or(whipcord::SolveError::NoDerivatives);
            return Err(ExportError::Solve { step: 0, error });
        };
        for (sum, row) in compliance.rows.iter_mut().zip(bending.rows) {
            *sum += row * (weight * h);
        }
    }
    let rows = compliance.rows;
    let is_coupled = rows[0].y != 0.0 || rows[0].z != 0.0 || rows[1].z != 0.0;
    let (values, axes) = if is_coupled {
        let (values, [a, b, c]) = compliance.symmetric_eigen();
        let c = if a.cross(b).dot(c) < 0.0 { -c } else { c };
        (values, [a, b, c])
    } else {
        ([rows[0].x, rows[1].y, rows[2].z], [Vec3::X, Vec3::Y, Vec3::Z])
    };
    let stiffness = values.map(|compliance| 1.0 / compliance);
    let damping = match damping {
        Damping::Time(time) if *time > 0.0 => stiffness.map(|stiffness| time * stiffness),
        Damping::Matrix(matrix) => {
            let row = |i: usize| Vec3::new(matrix[i][3], matrix[i][4], matrix[i][5]);
            let of = Mat3::from_rows(row(3), row(4), row(5));
            let along = |k: usize| axes[k].dot(of * axes[k]) / h;
            [0, 1, 2].map(along)
        }
        Damping::None | Damping::Time(_) => stiffness.map(|stiffness| DAMPING_TIME * stiffness),
    };
    Ok((axes, stiffness, damping))
}

/// Mass that is put together, about a point.
#[derive(Clone, Copy, Debug, Default)]
struct Bulk {
    mass: f64,
    /// Mass times place.
    first: Vec3,
    /// Diagonal of the inertia about the point.
    second: Vec3,
}

impl Bulk {
    /// Adds a body with this centre of mass and the moments of inertia about it.
    fn add(&mut self, mass: f64, center: Vec3, inertia: Vec3) {
        self.mass += mass;
        self.first += center * mass;
        self.second += inertia + squares(center) * mass;
    }

    /// Adds the stretch of backbone from a node to `end`, which is at arc length `to`.
    fn add_stretch(&mut self, robot: &Robot, from: f64, to: f64, end: Vec3) {
        let (backbone, disks) = (robot.backbone(), robot.disks());
        let middle = 0.5 * (from + to);
        let section = backbone.section_at(disks, middle);
        let assumed = section.map_or(LINEAR_DENSITY, |section| section.area * DENSITY);
        let per_length = backbone.linear_density_at(disks, middle).unwrap_or(assumed);
        let mass = per_length * (to - from).abs();
        let slender = mass * end.dot(end) / 12.0;
        let mut inertia = Vec3::new(slender, slender, 0.0);
        if let Some(section) = section {
            let [x, y] = [section.second_moment_x, section.second_moment_y];
            inertia += Vec3::new(x, y, x + y) * (mass / section.area);
        }
        self.add(mass, end * 0.5, inertia);
    }

    /// Adds a disk at the node.
    fn add_plate(&mut self, mass: f64, plate: &Plate) {
        let inertia = Disks::moments_of_inertia(mass, plate.radius, plate.thickness);
        self.add(mass, Vec3::ZERO, inertia);
    }

    /// Mass, centre of mass and moments of inertia about it.
    fn total(&self) -> (f64, Vec3, Vec3) {
        if self.mass <= 0.0 {
            return (0.0, Vec3::ZERO, Vec3::ZERO);
        }
        let center = self.first / self.mass;
        let inertia = (self.second - squares(center) * self.mass).to_array();
        (self.mass, center, Vec3::from(inertia.map(|moment| moment.max(0.0))))
    }
}

/// What a unit mass at a point adds to the moments of inertia.
fn squares(p: Vec3) -> Vec3 {
    let [x, y, z] = p.to_array().map(|c| c * c);
    Vec3::new(y + z, z + x, x + y)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use whipcord::{Backbone, Disks, Material, RestCurvature, Section};

    use super::*;

    fn curved() -> Robot {
        let backbone = Backbone {
            section: Some(Section::rectangle(0.004, 0.002)),
            material: Material {
                young_modulus: Some(1e9),
                poisson_ratio: Some(0.3),
                density: Some(1200.0),
                ..Material::default()
            },
            rest_curvature: RestCurvature::Uniform(Vec3::new(3.0, -8.0, 5.0)),
            ..Backbone::new(0.12)
        };
        let disks = Disks { mass: 2e-3, ..Disks::equally_spaced(0.12, 4, 0.008) };
        Robot::new(backbone, disks, Vec::new()).unwrap()
    }

    #[test]
    fn at_rest_the_bodies_stand_on_the_curve() {
        let (robot, case) = (curved(), Case::default());
        let places: Vec<f64> = (0..=12).map(|k| 0.01 * f64::from(k)).collect();
        let chain = Chain::new(&robot, &case, &places, Some(&Damping::None)).unwrap();
        let twist = Twist { linear: Vec3::Z, angular: Vec3::new(3.0, -8.0, 5.0) };
        for node in &chain.nodes {
            let exact = Pose::exp(twist * node.arc_length);
            assert!((node.rest.position - exact.position).norm() < 1e-10);
        }
        let mass: f64 = chain.nodes.iter().map(|node| node.mass).sum();
        assert!((mass - (1200.0 * 8e-6 * 0.12 + 4.0 * 2e-3)).abs() < 1e-12, "{mass}");
        // EI about x is E w h³/12; about y E h w³/12.
        let [x, y, _] = chain.joints[0].hinges();
        let expected = [4e-3 * 2e-3_f64.powi(3), 2e-3 * 4e-3_f64.powi(3)].map(|i| 1e9 * i / 12.0);
        for (hinge, ei) in [x, y].into_iter().zip(expected) {
            assert!((hinge.stiffness / (ei / 0.01) - 1.0).abs() < 1e-12);
            assert!((hinge.damping / (hinge.stiffness * DAMPING_TIME) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn angles_turn_the_bodies_as_the_shape_is_turned() {
        let (robot, case) = (curved(), Case::default());
        let places: Vec<f64> = (0..=6).map(|k| 0.02 * f64::from(k)).collect();
        let chain = Chain::new(&robot, &case, &places, None).unwrap();
        let base = Pose::exp(Twist { linear: Vec3::X, angular: Vec3::new(0.3, 0.4, -1.0) });
        let twist = Twist { linear: Vec3::Z, angular: Vec3::new(-9.0, 6.0, 12.0) };
        let poses = places.iter().map(|&s| base * Pose::exp(twist * s)).collect();
        let shape = Shape { arc_length: places.clone(), poses };
        let angles = chain.angles(&shape).unwrap();
        for (found, exact) in chain.poses(base, &angles).iter().zip(&shape.poses) {
            assert!((found.rotation.conjugate() * exact.rotation).log().norm() < 1e-9);
            assert!((found.position - exact.position).norm() < 2e-3);
        }
        // A quarter of a turn and more between two bodies.
        let sharp = Twist { linear: Vec3::Z, angular: Vec3::new(100.0, 0.0, 0.0) };
        let poses = places.iter().map(|&s| Pose::exp(sharp * s)).collect();
        let refused = chain.angles(&Shape { arc_length: places, poses });
        assert!(matches!(refused, Err(ExportError::BentTooFar { .. })));
    }
}
