//! Camera files: OpenCV's FileStorage, as YAML and as JSON.

mod read;
mod tree;
mod write;

use std::path::Path;

use whipcord_estimation::camera::Camera;

use crate::error::{FileError, FileProblem, Problems};
use crate::files;
use crate::source::{Sources, Span};
pub use write::{CameraFormat, camera_text};

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
    let path = path.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match files::read_first(path, &mut sources, &mut problems) {
        Some(text) => parse_camera(path, &text),
        None => Err(problems.into_error(sources)),
    }
}

/// As [`load_camera`], from the text of a file; `path` is its name in messages.
///
/// # Errors
/// [`FileError`] with the place of each mistake.
pub fn parse_camera(path: impl AsRef<Path>, text: &str) -> Result<Camera, FileError> {
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
    checked(file, &text, problems)
}

/// The camera in the text of file number `file`; every mistake goes to `problems`.
fn checked(file: usize, text: &str, problems: &mut Problems) -> Option<Camera> {
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
