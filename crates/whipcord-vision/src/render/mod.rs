//! Synthetic photographs of a robot's shape, and of the boards that cameras are calibrated with.
//!
//! What is seen is made of convex pieces (disks and stretches of backbone and cables, each the convex hull of two
//! projected circles) that are painted from far to near with exact coverage. Light falls unevenly on that, the lens
//! blurs it, and the sensor adds noise from a fixed seed, so that a scene gives the same photograph every time.
//! Distances in the world are in m.

mod board;
mod body;
mod sensor;

use thiserror::Error;
use whipcord::{Robot, Solution, Vec3};
use whipcord_estimation::Place;
use whipcord_estimation::camera::{Camera, ViewError};

use crate::coverage::Coverage;
use crate::photo::Photo;
pub use board::{BoardScene, RenderedBoard};
pub use sensor::{Blur, Light, Noise};

/// How a robot looks, and what comes between it and its photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Radius of the disks in m.
    pub disk_radius: f64,
    /// Thickness of the disks in m.
    pub disk_thickness: f64,
    /// Diameter of the backbone in m.
    pub backbone_diameter: f64,
    /// Diameter of the cables in m.
    pub cable_diameter: f64,
    /// Colours, in linear light.
    pub paint: Paint,
    /// Round markers on the robot.
    pub markers: Vec<Marker>,
    /// What lies before the robot, drawn in this order.
    pub occluders: Vec<Occluder>,
    /// How evenly it is lit.
    pub light: Light,
    /// How sharp the photograph is.
    pub blur: Blur,
    /// What the sensor adds.
    pub noise: Noise,
}

/// Colours of linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// What lies behind the robot.
    pub background: [f32; 3],
    /// The backbone.
    pub backbone: [f32; 3],
    /// The disks' rims; their faces are a little lighter.
    pub disks: [f32; 3],
    /// The cables.
    pub cables: [f32; 3],
}

/// A round marker: a small ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Where on the backbone it sits.
    pub place: Place,
    /// Its centre in the frame there, in m.
    pub offset: Vec3,
    /// Its radius in m.
    pub radius: f64,
    /// Its colour.
    pub colour: [f32; 3],
}

/// Something that hides part of the photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Occluder {
    /// Corners of a polygon in pixels.
    pub corners: Vec<[f64; 2]>,
    /// Its colour.
    pub colour: [f32; 3],
}

/// A synthetic photograph, and what is true of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The photograph.
    pub photo: Photo,
    /// Where the centre of each disk is, in pixels, seen or hidden.
    pub disks: Vec<[f64; 2]>,
    /// Where the centre of each marker is, in pixels, seen or hidden.
    pub markers: Vec<[f64; 2]>,
}

/// Why there is no photograph.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum RenderError {
    /// The camera does not say how many pixels it has.
    #[error("the camera has no image size")]
    NoSize,
    /// The camera does not see a part of the robot.
    #[error("the camera does not see the robot: {0}")]
    Unseen(#[from] ViewError),
    /// A disk that the robot does not have.
    #[error("there is no disk {disk}: the robot has disks 1 to {count}")]
    NoDisk {
        /// Number of the disk, from 1.
        disk: usize,
        /// Disks of the robot.
        count: usize,
    },
}

impl Scene {
    /// A dark printed robot before a light wall, as in the paper's photographs, sharp, evenly lit and without noise.
    /// The disks reach a quarter beyond their holes; the backbone is as thick as the paper's.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let radii = &robot.disks().hole_circle_radii;
        let holes = radii.iter().copied().fold(0.0, f64::max);
        let length = robot.backbone().length;
        let disk_radius = if holes > 0.0 { 1.25 * holes } else { length / 18.0 };
        Self {
            disk_radius,
            disk_thickness: 0.2 * disk_radius,
            backbone_diameter: 0.3 * disk_radius,
            cable_diameter: 0.04 * disk_radius,
            paint: Paint {
                background: [0.62, 0.60, 0.55],
                backbone: [0.045, 0.05, 0.06],
                disks: [0.03, 0.035, 0.045],
                cables: [0.30, 0.30, 0.28],
            },
            markers: Vec::new(),
            occluders: Vec::new(),
            light: Light::default(),
            blur: Blur::default(),
            noise: Noise::default(),
        }
    }

    /// The photograph that a camera takes of a robot in this shape.
    ///
    /// # Errors
    /// [`RenderError`] when the camera cannot take it.
    pub fn photograph(
        &self,
        robot: &Robot,
        solution: &Solution,
        camera: &Camera,
    ) -> Result<Rendered, RenderError> {
        let [width, height] = camera.size().ok_or(RenderError::NoSize)?.map(|n| n as usize);
        let mut photo = Photo::uniform(width, height, self.paint.background);
        let mut coverage = Coverage::default();
        for piece in body::pieces(self, robot, solution, camera)? {
            for (corners, colour) in &piece.layers {
                coverage.paint(&mut photo, corners, *colour);
            }
        }
        for occluder in &self.occluders {
            coverage.paint(&mut photo, &occluder.corners, occluder.colour);
        }
        sensor::expose(&mut photo, self.light, self.blur, self.noise);
        let see = |point: Vec3| camera.project(point);
        let disks = solution.disks.positions().map(see).collect::<Result<_, _>>()?;
        let markers = self
            .markers
            .iter()
            .map(|marker| Ok(see(body::centre(marker, solution)?)?))
            .collect::<Result<_, RenderError>>()?;
        Ok(Rendered { photo, disks, markers })
    }
}
