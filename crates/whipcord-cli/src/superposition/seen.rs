//! What a camera saw of the robot in one photograph.

use std::path::Path;

use whipcord::Vec3;
use whipcord_estimation::camera::Camera;
use whipcord_estimation::observation::InImage;
use whipcord_io::{CaseFile, MeasuringCamera, load_camera};

use whipcord_study::failure::Failure;
use whipcord_study::quantity::{millimetres, number};

/// What tables call a marker.
pub fn name(marker: &InImage) -> String {
    let place = match marker.disk() {
        Some(disk) => disk.to_string(),
        None => millimetres(marker.arc_length),
    };
    if marker.seen.offset == Vec3::ZERO {
        return place;
    }
    let offset = marker.seen.offset.to_array().map(|x| number(1e3 * x, 4));
    format!("{place} ({} mm)", offset.join(", "))
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
    let camera = load_camera(path)
        .map_err(|error| Failure::Input(whipcord_study::failure::message(&error)))?;
    // What the file with the measurement calls by a name may be given by its path as well.
    let same = |known: &MeasuringCamera| matches!((known.path.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
    Ok((camera, known.iter().position(same)))
}
