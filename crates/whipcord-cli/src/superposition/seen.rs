//! What a camera saw of the robot in one photograph.

use std::path::Path;

use whipcord::camera::Camera;
use whipcord::{Observation, Place, Seen, Vec3};
use whipcord_io::{CaseFile, MeasuringCamera, load_camera};

use crate::failure::Failure;
use crate::inputs;
use crate::quantity::{millimetres, number};

/// A marker in the photograph.
#[derive(Clone, Copy, Debug)]
pub struct Marker {
    /// All that is known of it.
    pub seen: Observation,
    /// Where on the backbone it sits, in m.
    pub arc_length: f64,
    /// Where it was seen: column and row.
    pub pixel: [f64; 2],
}

impl Marker {
    /// Number of its disk, from 1; none where it is between disks.
    pub const fn disk(&self) -> Option<usize> {
        match self.seen.place {
            Place::Disk(disk) => Some(disk + 1),
            Place::ArcLength(_) => None,
        }
    }

    /// Whether it does not move with the robot.
    pub fn is_at_base(&self) -> bool {
        self.arc_length == 0.0
    }

    /// What tables call it.
    pub fn name(&self) -> String {
        let place = match self.disk() {
            Some(disk) => disk.to_string(),
            None => millimetres(self.arc_length),
        };
        if self.seen.offset == Vec3::ZERO {
            return place;
        }
        let offset = self.seen.offset.to_array().map(|x| number(1e3 * x, 4));
        format!("{place} ({} mm)", offset.join(", "))
    }
}

/// The camera that took the photograph: the one that is named or lies in a file, or the only one there
/// is. With its number among those of `[measured]`.
///
/// # Errors
/// [`Failure::Input`] when there is none, or none of this name, or one cannot be read.
pub fn camera(file: &CaseFile, named: Option<&str>) -> Result<(Camera, Option<usize>), Failure> {
    let known: &[MeasuringCamera] = file.measured.as_ref().map_or(&[], |m| &m.cameras);
    let names = || known.iter().map(|c| format!("`{}`", c.name)).collect::<Vec<_>>().join(", ");
    let Some(name) = named else {
        return match known {
            [only] => Ok((only.camera, Some(0))),
            [] => Err(Failure::Input(String::from(
                "error: which camera took the photograph? Give its file with --camera, or name it in \
                 [[measured.cameras]]",
            ))),
            _ => Err(Failure::Input(format!(
                "error: which camera took the photograph? Give --camera with one of {}",
                names()
            ))),
        };
    };
    if let Some(number) = known.iter().position(|camera| camera.name == name) {
        return Ok((known[number].camera, Some(number)));
    }
    let path = Path::new(name);
    if !path.exists() && !known.is_empty() {
        return Err(Failure::Input(format!(
            "error: there is no camera or file `{name}`: {} has {}",
            file.path.display(),
            names()
        )));
    }
    let camera = load_camera(path).map_err(|error| Failure::Input(inputs::message(&error)))?;
    // What the file with the measurement calls by a name may be given by its path as well.
    let same = |known: &MeasuringCamera| matches!((known.path.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
    Ok((camera, known.iter().position(same)))
}

/// What camera number `camera` saw in a step, from 0.
pub fn markers(file: &CaseFile, camera: usize, step: usize) -> Vec<Marker> {
    let seen = file.measured.iter().flat_map(|measured| &measured.observations);
    let seen = seen.filter(|observation| observation.step == step);
    seen.filter_map(|observation| match observation.seen {
        Seen::Pixel { camera: by, pixel } if by == camera => {
            let arc_length = observation.place.arc_length(file.robot.disks());
            Some(Marker { seen: *observation, arc_length, pixel })
        }
        _ => None,
    })
    .collect()
}
