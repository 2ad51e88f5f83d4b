//! Obstacles and movable objects.

use whipcord::obstacle::Mesh;
use whipcord::{Case, Form, MovableBody, Obstacle, Pose, Solution, Vec3};

use super::actuators::Applied;
use super::bodies::placed;
use super::names::FORMAT;
use crate::error::ExportError;
use crate::xml::{Element, check_name, numbers};

/// How far a centre of mass may lie from that of the volume, as a part of the body's size.
const AT_CENTROID: f64 = 1e-6;
/// Distance in m of the lines that MuJoCo draws on a plane.
const GRID: f64 = 0.05;

/// An obstacle with its number.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    number: usize,
    obstacle: &'a Obstacle,
}

/// The obstacles of a case.
///
/// # Errors
/// [`ExportError::Unsupported`] for one that MuJoCo has no form for.
pub fn of(case: &Case) -> Result<Vec<Body<'_>>, ExportError> {
    let bodies: Vec<Body<'_>> = case
        .obstacles
        .iter()
        .enumerate()
        .map(|(number, obstacle)| Body { number, obstacle })
        .collect();
    bodies.iter().try_for_each(Body::check)?;
    Ok(bodies)
}

impl Body<'_> {
    fn check(&self) -> Result<(), ExportError> {
        check_name(&self.obstacle.name)?;
        let refuse = |what, advice| {
            let path = format!("obstacles[{}]", self.number);
            Err(ExportError::Unsupported { format: FORMAT, what, path, advice })
        };
        match &self.obstacle.form {
            Form::Pipe(_) => {
                refuse("a pipe", "MuJoCo's bodies are convex: build its wall of boxes or capsules")
            }
            Form::Superellipsoid(body) if body.exponents() != [1.0; 2] => refuse(
                "a superellipsoid that is no ellipsoid",
                "give it the exponents [1, 1], or a mesh",
            ),
            form => match (&self.obstacle.movable, form.centroid(), form.volume()) {
                (Some(body), Some(centroid), Some(volume))
                    if (body.center_of_mass - centroid).norm() > AT_CENTROID * volume.cbrt() =>
                {
                    refuse(
                        "a movable object whose centre of mass is not that of its volume",
                        "leave out center_of_mass, or set it in the exported file",
                    )
                }
                _ => Ok(()),
            },
        }
    }

    fn name(&self) -> String {
        format!("obstacle:{}", self.obstacle.name)
    }

    /// Its body in the world.
    pub fn element(&self) -> Element {
        let mut body = placed(Element::new("body").with("name", self.name()), self.obstacle.pose);
        let class = if self.obstacle.movable.is_some() { "object" } else { "obstacle" };
        let mut geom = self.form(Element::new("geom").with("class", class));
        let friction = self.obstacle.friction;
        // Of two bodies MuJoCo takes the greater coefficient and the greater dimension, and the robot has the least ones.
        geom = geom.with("condim", if friction > 0.0 { 3 } else { 1 });
        geom = geom.with("friction", format!("{} 0 0", numbers(&[friction])));
        if let Some(movable) = &self.obstacle.movable {
            geom = geom.with_numbers("mass", &[movable.mass]);
            body.push(Element::new("freejoint").with("name", self.name()));
            body.push(
                Element::new("site")
                    .with("name", self.name())
                    .with_vector("pos", movable.center_of_mass),
            );
        }
        body.and(geom)
    }

    fn form(&self, geom: Element) -> Element {
        let tube = |kind: &str, radius: f64, length: f64| {
            geom.clone().with("type", kind).with_numbers("size", &[radius, 0.5 * length])
        };
        match &self.obstacle.form {
            Form::HalfSpace => geom.with("type", "plane").with_numbers("size", &[0.0, 0.0, GRID]),
            Form::Sphere { radius } => geom.with("type", "sphere").with_numbers("size", &[*radius]),
            Form::Capsule { radius, length } => tube("capsule", *radius, *length),
            Form::Cylinder { radius, length } => tube("cylinder", *radius, *length),
            Form::Box { size } => geom.with("type", "box").with_vector("size", *size * 0.5),
            Form::Superellipsoid(body) => {
                geom.with("type", "ellipsoid").with_vector("size", body.semi_axes())
            }
            // MuJoCo moves a mesh to its centre of mass and the geom with it, so that it stays in place.
            Form::Mesh(_) => geom.with("type", "mesh").with("mesh", self.name()),
            // Refused before.
            Form::Pipe(_) => geom,
        }
    }

    /// Its mesh, where it has one.
    pub fn mesh(&self) -> Option<Element> {
        let Form::Mesh(mesh) = &self.obstacle.form else { return None };
        let mesh: &Mesh = mesh;
        let vertices: Vec<f64> = mesh.vertices().iter().flat_map(|v| v.to_array()).collect();
        let faces: Vec<String> = mesh.triangles().iter().flatten().map(u32::to_string).collect();
        let element = Element::new("mesh").with("name", self.name());
        Some(element.with_numbers("vertex", &vertices).with("face", faces.join(" ")))
    }

    /// What acts on a movable object besides its weight.
    pub fn load(&self, case: &Case) -> Option<Applied> {
        let MovableBody { force, moment, .. } = self.obstacle.movable?;
        if force == Vec3::ZERO && moment == Vec3::ZERO {
            return None;
        }
        let to_world = case.loads.to_world(case.base.rotation);
        Some(Applied {
            name: format!("load:{}", self.name()),
            site: self.name(),
            force: to_world.rotate(force),
            moment: to_world.rotate(moment),
            follower: false,
        })
    }

    /// The coordinates of a movable object while the robot is at rest; none of a fixed obstacle.
    pub fn position_at_rest(&self) -> Vec<f64> {
        self.coordinates(self.obstacle.pose)
    }

    /// The coordinates of a movable object in an answer; none of a fixed obstacle.
    pub fn position_in(&self, solution: &Solution) -> Vec<f64> {
        let state = solution.objects.iter().find(|object| object.obstacle == self.number);
        self.coordinates(state.map_or(self.obstacle.pose, |object| object.pose))
    }

    fn coordinates(&self, pose: Pose) -> Vec<f64> {
        if self.obstacle.movable.is_none() {
            return Vec::new();
        }
        pose.position.to_array().into_iter().chain(pose.rotation.wxyz()).collect()
    }
}
