//! Photographs that verbs read, and the cameras that took them.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use whipcord_estimation::camera::Camera;
use whipcord_io::read_photograph;
use whipcord_vision::{Photo, PhotoError};

use whipcord_study::failure::Failure;
use whipcord_study::failure::message;

/// A photograph and the file it was read from.
#[derive(Debug)]
pub struct Photograph {
    pub path: PathBuf,
    /// Of a file that stores it upright.
    pub bytes: Vec<u8>,
    pub photo: Photo,
}

impl Photograph {
    /// Reads the photograph in a file, which is one and not too large.
    ///
    /// # Errors
    /// [`Failure::Input`] when it cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = read_photograph(path).map_err(|error| Failure::Input(message(&error)))?;
        let refused = |why: PhotoError| Failure::Input(format!("error: {}: {why}", path.display()));
        let (photo, bytes) = Photo::decode_upright(bytes).map_err(refused)?;
        Ok(Self { path: path.to_owned(), bytes, photo })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        // A picture that has been decoded has no more than 2³² of them.
        [self.photo.width(), self.photo.height()].map(|n| u32::try_from(n).unwrap_or(u32::MAX))
    }

    /// Pixels of a camera mean nothing in a photograph of another size.
    ///
    /// # Errors
    /// [`Failure::Input`] for a camera, of this name, whose images are of another size.
    pub fn check_camera(&self, name: &dyn Display, camera: &Camera) -> Result<(), Failure> {
        let taken = self.size();
        match camera.size() {
            Some(size) if size != taken => Err(Failure::Input(format!(
                "error: {name} is of pictures of {}×{} pixels, but {} has {}×{}",
                size[0],
                size[1],
                self.path.display(),
                taken[0],
                taken[1]
            ))),
            _ => Ok(()),
        }
    }
}
