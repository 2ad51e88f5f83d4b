//! Cameras as OpenCV's FileStorage has them.

use std::fmt::Write as _;
use std::path::Path;

use whipcord::Pose;
use whipcord_estimation::camera::{Camera, Lens};

use super::CalibratedCamera;
use super::read::{CENTRE, COVARIANCE, PROJECTION, SCALE};

/// How a camera file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraFormat {
    /// OpenCV's YAML.
    Yaml,
    /// OpenCV's JSON.
    Json,
}

impl CameraFormat {
    /// The one that the end of a file's name asks for: `.yml`, `.yaml` or `.json`.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "yml" | "yaml" => Some(Self::Yaml),
            "json" => Some(Self::Json),
            _ => None,
        }
    }
}

enum Item {
    Word(&'static str),
    Number(f64),
    Pair([f64; 2]),
    Matrix { columns: usize, data: Vec<f64> },
}

/// A camera as the text of a file that [`load_camera`](crate::load_camera) and OpenCV's FileStorage read.
#[must_use]
pub fn camera_text(camera: &Camera, format: CameraFormat) -> String {
    text(items(camera), format)
}

/// As [`camera_text`], with `lens_covariance` where the errors of the lens are known.
#[must_use]
pub fn calibrated_camera_text(of: &CalibratedCamera, format: CameraFormat) -> String {
    let mut items = items(&of.camera);
    if let Some(rows) = &of.lens_covariance {
        items.push((COVARIANCE[0], Item::Matrix { columns: rows.len(), data: rows.concat() }));
    }
    text(items, format)
}

fn text(items: Vec<(&'static str, Item)>, format: CameraFormat) -> String {
    let lines = items.iter().map(|(key, item)| match format {
        CameraFormat::Yaml => yaml(key, item),
        CameraFormat::Json => json(key, item),
    });
    match format {
        CameraFormat::Yaml => format!("%YAML:1.0\n---\n{}", lines.collect::<String>()),
        CameraFormat::Json => {
            format!("{{\n{}\n}}\n", lines.collect::<Vec<_>>().join(",\n"))
        }
    }
}

fn items(camera: &Camera) -> Vec<(&'static str, Item)> {
    let mut items = Vec::new();
    if let Some([width, height]) = camera.size() {
        items.push(("image_width", Item::Number(f64::from(width))));
        items.push(("image_height", Item::Number(f64::from(height))));
    }
    match camera.lens() {
        Lens::Pinhole(lens) => {
            let ([fx, fy], [cx, cy]) = (lens.focal(), lens.centre());
            let data = vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0];
            items.push(("camera_matrix", Item::Matrix { columns: 3, data }));
            let coefficients = lens.distortion().coefficients().to_vec();
            if !coefficients.is_empty() {
                let columns = coefficients.len();
                let row = Item::Matrix { columns, data: coefficients };
                items.push(("distortion_coefficients", row));
            }
        }
        Lens::Orthographic(lens) => {
            items.push((PROJECTION[0], Item::Word("orthographic")));
            items.push((SCALE[0], Item::Number(lens.scale())));
            items.push((CENTRE[0], Item::Pair(lens.centre())));
        }
    }
    if camera.pose() != Pose::IDENTITY {
        let world_to_camera = camera.pose().inverse();
        for (key, vector) in
            [("rvec", world_to_camera.rotation.log()), ("tvec", world_to_camera.position)]
        {
            let data = vector.to_array().to_vec();
            items.push((key, Item::Matrix { columns: 1, data }));
        }
    }
    items
}

/// With as many digits as bring the number back, and a point or an exponent where it is no count.
fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        format!("{value:.1}")
    } else {
        format!("{value:?}")
    }
}

fn list(data: &[f64]) -> String {
    data.iter().map(|&value| number(value)).collect::<Vec<_>>().join(", ")
}

fn count(value: f64) -> String {
    if value.fract() == 0.0 { format!("{value}") } else { number(value) }
}

fn yaml(key: &str, item: &Item) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = match item {
        Item::Word(word) => writeln!(text, "{key}: {word}"),
        Item::Number(value) => writeln!(text, "{key}: {}", count(*value)),
        Item::Pair(pair) => writeln!(text, "{key}: [ {} ]", list(pair)),
        Item::Matrix { columns, data } => writeln!(
            text,
            "{key}: !!opencv-matrix\n   rows: {}\n   cols: {columns}\n   dt: d\n   data: [ {} ]",
            data.len() / columns,
            list(data)
        ),
    };
    text
}

fn json(key: &str, item: &Item) -> String {
    match item {
        Item::Word(word) => format!("    \"{key}\": \"{word}\""),
        Item::Number(value) => format!("    \"{key}\": {}", count(*value)),
        Item::Pair(pair) => format!("    \"{key}\": [ {} ]", list(pair)),
        Item::Matrix { columns, data } => format!(
            "    \"{key}\": {{\n        \"type_id\": \"opencv-matrix\",\n        \"rows\": {},\n        \"cols\": {columns},\n        \"dt\": \"d\",\n        \"data\": [ {} ]\n    }}",
            data.len() / columns,
            list(data)
        ),
    }
}
