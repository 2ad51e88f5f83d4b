//! What a camera file says, as a camera.

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Camera, CameraError, Distortion, LENS_PARAMETERS, Lens, Orthographic, Pinhole,
};

use super::CalibratedCamera;
use super::tree::{Node, Value};
use crate::error::{FileProblem, Problems};
use crate::source::{Span, quoted};

/// What the camera matrix is called: by OpenCV and ROS, by OpenCV's samples, and by many scripts.
const MATRIX: [&str; 6] =
    ["camera_matrix", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "mtx", "K"];
const DISTORTION: [&str; 7] = [
    "distortion_coefficients",
    "distCoeffs",
    "Distortion_Coefficients",
    "dist_coeffs",
    "distortion",
    "dist",
    "D",
];
const WIDTH: [&str; 2] = ["image_width", "image_Width"];
const HEIGHT: [&str; 2] = ["image_height", "image_Height"];
/// Not of OpenCV, which passes it over.
pub(super) const COVARIANCE: [&str; 1] = ["lens_covariance"];
const ROTATION: [&str; 1] = ["rvec"];
const TRANSLATION: [&str; 1] = ["tvec"];
pub(super) const PROJECTION: [&str; 1] = ["projection"];
pub(super) const SCALE: [&str; 1] = ["pixels_per_metre"];
pub(super) const CENTRE: [&str; 1] = ["principal_point"];
/// ROS's name of the distortion model; those that are OpenCV's of here.
const MODEL: [&str; 1] = ["distortion_model"];
const MODELS: [&str; 2] = ["plumb_bob", "rational_polynomial"];

/// A key that is there: what it is called, and its value.
#[derive(Clone, Copy)]
struct Found<'a> {
    name: &'a str,
    node: &'a Node,
}

pub(super) struct Reader<'a> {
    pub(super) root: &'a Node,
    pub(super) problems: &'a mut Problems,
}

impl<'a> Reader<'a> {
    pub(super) fn camera(&mut self) -> Option<CalibratedCamera> {
        if !matches!(self.root.value, Value::Table(_)) {
            self.refuse(self.root.span, "a camera file has keys and values", MATRIX_HELP);
            return None;
        }
        let lens = self.lens();
        let covariance = self.lens_covariance(lens.as_ref());
        let rotation = self.vector(&ROTATION);
        let translation = self.vector(&TRANSLATION);
        let size = self.size();
        let (lens, rotation, translation, size) = (lens?, rotation?, translation?, size?);
        let world_to_camera = Pose {
            position: translation.map_or(Vec3::ZERO, |(vector, _)| vector),
            rotation: UnitQuaternion::exp(rotation.map_or(Vec3::ZERO, |(vector, _)| vector)),
        };
        let place = translation.or(rotation).map_or(self.root.span, |(_, span)| span);
        let camera = Camera::new(lens, world_to_camera.inverse(), size);
        let camera = camera.map_err(|error| self.cannot_be(place, &error)).ok()?;
        Some(CalibratedCamera { camera, lens_covariance: covariance? })
    }

    /// A symmetric matrix for focal lengths, principal point and as many distortion coefficients as it says.
    fn lens_covariance(&mut self, lens: Option<&Lens>) -> Option<Option<Vec<Vec<f64>>>> {
        let Some(found) = self.find(&COVARIANCE)? else { return Some(None) };
        let numbers = self.numbers(found)?;
        let most = match lens {
            Some(Lens::Orthographic(_)) => {
                let message = format!("`{}` is of a lens, but the camera has none", found.name);
                self.refuse(found.node.span, &message, "remove it");
                return None;
            }
            Some(Lens::Pinhole(lens)) => {
                LENS_PARAMETERS.min(4 + lens.distortion().coefficients().len())
            }
            None => LENS_PARAMETERS,
        };
        let size = numbers.len().isqrt();
        if size * size != numbers.len() || !(4..=most).contains(&size) {
            let message = format!(
                "`{}` must have as many rows as columns, from 4 to {most}, but has {} numbers",
                found.name,
                numbers.len()
            );
            self.refuse(found.node.span, &message, COVARIANCE_HELP);
            return None;
        }
        let rows: Vec<Vec<f64>> = numbers.chunks_exact(size).map(<[f64]>::to_vec).collect();
        let is_covariance = |i: usize, j: usize| {
            let most = (rows[i][i] * rows[j][j]).sqrt() * (1.0 + 1e-6);
            let near = (rows[i][j] - rows[j][i]).abs() <= 1e-6 * most;
            rows[i][i] >= 0.0 && rows[j][j] >= 0.0 && near && rows[i][j].abs() <= most
        };
        if !(0..size * size).all(|at| is_covariance(at / size, at % size)) {
            let message = format!(
                "`{}` is no covariance: it must be symmetric, with squares of standard deviations on its diagonal",
                found.name
            );
            self.refuse(found.node.span, &message, COVARIANCE_HELP);
            return None;
        }
        Some(Some(rows))
    }

    fn lens(&mut self) -> Option<Lens> {
        if let Some(found) = self.find(&PROJECTION)? {
            return match found.node.text() {
                Some("orthographic") => self.orthographic(),
                Some("pinhole") => self.pinhole(),
                _ => {
                    let message = "`projection` is neither `pinhole` nor `orthographic`";
                    self.refuse(found.node.span, message, "write one of the two");
                    None
                }
            };
        }
        self.pinhole()
    }

    fn pinhole(&mut self) -> Option<Lens> {
        let Some(found) = self.find(&MATRIX)? else {
            self.refuse(self.root.span, "there is no `camera_matrix`", MATRIX_HELP);
            return None;
        };
        let matrix = self.numbers(found)?;
        let &[fx, skew, cx, below, fy, cy, zero, nought, one] = matrix.as_slice() else {
            let message = format!("`{}` must have 9 numbers, but has {}", found.name, matrix.len());
            self.refuse(found.node.span, &message, MATRIX_HELP);
            return None;
        };
        if [skew, below, zero, nought, one - 1.0].iter().any(|&entry| entry != 0.0) {
            let message = format!(
                "`{}` is not of the form [fx 0 cx; 0 fy cy; 0 0 1]: OpenCV's lenses have no skew",
                found.name
            );
            self.refuse(found.node.span, &message, "calibrate the camera by OpenCV's model");
            return None;
        }
        let distortion = self.distortion()?;
        Pinhole::new([fx, fy], [cx, cy], distortion)
            .map(Lens::Pinhole)
            .map_err(|error| self.cannot_be(found.node.span, &error))
            .ok()
    }

    fn distortion(&mut self) -> Option<Distortion> {
        if let Some(found) = self.find(&MODEL)? {
            let model = found.node.text().unwrap_or_default();
            if !MODELS.contains(&model) {
                let message = format!("the distortion model `{}` is not read", quoted(model));
                self.refuse(found.node.span, &message, MODEL_HELP);
                return None;
            }
        }
        let Some(found) = self.find(&DISTORTION)? else { return Some(Distortion::NONE) };
        let coefficients = self.numbers(found)?;
        Distortion::new(&coefficients).map_err(|error| self.cannot_be(found.node.span, &error)).ok()
    }

    fn orthographic(&mut self) -> Option<Lens> {
        let Some(scale) = self.find(&SCALE)? else {
            self.refuse(
                self.root.span,
                "an orthographic camera has no `pixels_per_metre`",
                SCALE_HELP,
            );
            return None;
        };
        let (scale_value, centre) = (self.number(scale)?, self.find(&CENTRE)?);
        let centre = match centre {
            None => [0.0; 2],
            Some(found) => match self.numbers(found)?.as_slice() {
                &[column, row] => [column, row],
                other => {
                    let message =
                        format!("`{}` must have 2 numbers, but has {}", found.name, other.len());
                    self.refuse(found.node.span, &message, "write for example [ 319.5, 239.5 ]");
                    return None;
                }
            },
        };
        Orthographic::new(scale_value, centre)
            .map(Lens::Orthographic)
            .map_err(|error| self.cannot_be(scale.node.span, &error))
            .ok()
    }

    fn size(&mut self) -> Option<Option<[u32; 2]>> {
        let (width, height) = (self.find(&WIDTH)?, self.find(&HEIGHT)?);
        match (width, height) {
            (None, None) => Some(None),
            (Some(width), Some(height)) => Some(Some([self.pixels(width)?, self.pixels(height)?])),
            (Some(found), None) | (None, Some(found)) => {
                let message = format!("`{}` stands alone", found.name);
                let help = "give `image_width` and `image_height`, or neither";
                self.refuse(found.node.span, &message, help);
                None
            }
        }
    }

    fn pixels(&mut self, found: Found<'_>) -> Option<u32> {
        let value = self.number(found)?;
        if value.fract() != 0.0 || !(1.0..=1e6).contains(&value) {
            let message = format!("`{}` must be a number of pixels, but is {value}", found.name);
            self.refuse(found.node.span, &message, "write a whole number from 1 to 1000000");
            return None;
        }
        Some(value as u32)
    }

    /// Three numbers and where they stand, where the key is there.
    fn vector(&mut self, names: &[&'static str]) -> Option<Option<(Vec3, Span)>> {
        let Some(found) = self.find(names)? else { return Some(None) };
        match self.numbers(found)?.as_slice() {
            &[x, y, z] => Some(Some((Vec3::new(x, y, z), found.node.span))),
            other => {
                let message =
                    format!("`{}` must have 3 numbers, but has {}", found.name, other.len());
                self.refuse(found.node.span, &message, POSE_HELP);
                None
            }
        }
    }

    /// The one of these keys that is there.
    fn find(&mut self, names: &[&'static str]) -> Option<Option<Found<'a>>> {
        let Value::Table(entries) = &self.root.value else { return Some(None) };
        let mut found = entries.iter().filter(|(key, ..)| names.contains(&key.as_str()));
        let Some((name, first, node)) = found.next() else { return Some(None) };
        if let Some((second, place, _)) = found.next() {
            let message = format!("`{second}` says what `{name}` says as well");
            let related = Some((*first, "it is given here"));
            self.problems.push_related(*place, related, || FileProblem::Camera {
                message,
                help: "remove one of the two".to_owned(),
            });
            return None;
        }
        Some(Some(Found { name, node }))
    }

    fn number(&mut self, found: Found<'_>) -> Option<f64> {
        self.finite(found.name, found.node)
    }

    /// The numbers of a matrix of OpenCV, or of a list or a list of lists, by rows.
    fn numbers(&mut self, found: Found<'_>) -> Option<Vec<f64>> {
        let Found { name, node } = found;
        let data = node.get("data").unwrap_or(node);
        let Value::List(items) = &data.value else {
            let message = format!("`{name}` must be a matrix or a list of numbers");
            self.refuse(node.span, &message, MATRIX_HELP);
            return None;
        };
        let mut numbers = Vec::with_capacity(items.len());
        for item in items {
            match &item.value {
                Value::List(row) => {
                    for entry in row {
                        numbers.push(self.finite(name, entry)?);
                    }
                }
                _ => numbers.push(self.finite(name, item)?),
            }
        }
        let counts = ["rows", "cols"].map(|key| node.get(key).and_then(Node::number));
        if let [Some(rows), Some(columns)] = counts
            && rows * columns != numbers.len() as f64
        {
            let message = format!(
                "`{name}` has {rows} rows and {columns} columns, but {} numbers",
                numbers.len()
            );
            self.refuse(node.span, &message, "write rows × cols numbers");
            return None;
        }
        Some(numbers)
    }

    fn finite(&mut self, name: &str, node: &Node) -> Option<f64> {
        match node.number() {
            Some(value) if value.is_finite() => Some(value),
            Some(value) => {
                let message = format!("`{name}` must hold finite numbers, but holds {value}");
                self.refuse(node.span, &message, "calibrate the camera again: this one failed");
                None
            }
            None => {
                let message = match node.text() {
                    Some(text) => format!("`{name}`: `{}` is no number", quoted(text)),
                    None => format!("`{name}` must hold numbers"),
                };
                self.refuse(node.span, &message, "write a plain number, in SI units");
                None
            }
        }
    }

    fn refuse(&mut self, span: Span, message: &str, help: &str) {
        self.problems.push(span, || FileProblem::Camera {
            message: message.to_owned(),
            help: help.to_owned(),
        });
    }

    fn cannot_be(&mut self, span: Span, error: &CameraError) {
        self.refuse(span, &error.to_string(), "is this the camera you meant?");
    }
}

const MATRIX_HELP: &str =
    "write the camera as OpenCV's FileStorage does, with `camera_matrix: !!opencv-matrix`";
const COVARIANCE_HELP: &str = "let `whipcord camera calibrate` write the camera: rows and columns are fx, fy, cx, cy and then distortion coefficients; or remove the key, and the lens is taken as it is";
const POSE_HELP: &str =
    "`rvec` and `tvec` lead from the world to the camera, as cv2.solvePnP gives them, in rad and m";
const SCALE_HELP: &str = "give the scale in pixels per metre, such as `pixels_per_metre: 2500`";
const MODEL_HELP: &str = "OpenCV's pinhole model is read, with up to 14 coefficients, which ROS calls `plumb_bob` and `rational_polynomial`";
