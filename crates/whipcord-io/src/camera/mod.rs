//! Camera files: OpenCV's FileStorage, as YAML and as JSON.

mod read;
mod tree;
mod write;

use std::path::Path;

use whipcord_estimation::camera::Camera;

use crate::error::{FileError, FileProblem, Problems};
use crate::files;
use crate::source::{Sources, Span};
pub use write::{CameraFormat, calibrated_camera_text, camera_text};

/// A camera, and what its file says of the errors of its lens.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedCamera {
    /// The camera.
    pub camera: Camera,
    /// Covariance of the focal lengths, the principal point and the first distortion coefficients of its lens, in this order and by rows
    /// ([`LensDeviations::covariance`](whipcord_estimation::camera::LensDeviations::covariance)); `None` where the lens is taken as it is.
    pub lens_covariance: Option<Vec<Vec<f64>>>,
}

/// Reads a camera from a file of OpenCV, in YAML or JSON: `camera_matrix`, `distortion_coefficients`,
/// `image_width` and `image_height`, and `rvec` and `tvec`, which lead from the world to the camera.
/// Other keys are passed over.
///
/// An orthographic camera has `projection: orthographic`, `pixels_per_metre` and `principal_point` in
/// place of the matrix and the coefficients.
///
/// # Errors
/// [`FileError`] with the place of each mistake.
pub fn load_camera(path: impl AsRef<Path>) -> Result<Camera, FileError> {
    Ok(load_calibrated_camera(path)?.camera)
}

/// As [`load_camera`], with `lens_covariance`, the covariance of its lens.
///
/// # Errors
/// [`FileError`] with the place of each mistake.
pub fn load_calibrated_camera(path: impl AsRef<Path>) -> Result<CalibratedCamera, FileError> {
    let path = path.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match files::read_first(path, &mut sources, &mut problems) {
        Some(text) => parse_calibrated_camera(path, &text),
        None => Err(problems.into_error(sources)),
    }
}

/// As [`load_camera`], from the text of a file; `path` is its name in messages.
///
/// # Errors
/// [`FileError`] with the place of each mistake.
pub fn parse_camera(path: impl AsRef<Path>, text: &str) -> Result<Camera, FileError> {
    Ok(parse_calibrated_camera(path, text)?.camera)
}

/// As [`load_calibrated_camera`], from the text of a file; `path` is its name in messages.
///
/// # Errors
/// [`FileError`] with the place of each mistake.
pub fn parse_calibrated_camera(
    path: impl AsRef<Path>,
    text: &str,
) -> Result<CalibratedCamera, FileError> {
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    let file = sources.add(path.as_ref(), Some(text.to_owned()));
    let camera = checked(file, text, &mut problems);
    camera.filter(|_| problems.is_empty()).ok_or_else(|| problems.into_error(sources))
}

/// Reads the camera that a robot file names at `named`.
pub(crate) fn read_named(
    path: &Path,
    named: Span,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Camera> {
    let (file, text) = files::read_named(path, files::LARGEST, named, sources, problems)?;
    Some(checked(file, &text, problems)?.camera)
}

/// The camera in the text of file number `file`; every mistake goes to `problems`.
fn checked(file: usize, text: &str, problems: &mut Problems) -> Option<CalibratedCamera> {
    if text.trim_start().starts_with('<') {
        problems.push(Span::new(file, 0, 1), || FileProblem::Camera {
            message: "camera files in XML are not read".to_owned(),
            help: "let OpenCV write the camera as YAML or JSON: cv2.FileStorage(\"camera.yml\", cv2.FILE_STORAGE_WRITE)"
                .to_owned(),
        });
        None
    } else {
        tree::parse(file, text, problems)
            .and_then(|root| read::Reader { root: &root, problems }.camera())
    }
}
