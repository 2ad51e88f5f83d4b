use thiserror::Error;
use whipcord_estimation::camera::{
    CalibrateError, Calibrated, CalibrationWarning, FreeParameters, Sighting, calibrate,
};

use super::{SeenBoard, Unseen};

/// A lens that was calibrated by photographs of a board.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Columns and rows of the photographs.
    pub size: [u32; 2],
    /// The lens. Its lists are of the photographs that were used.
    pub calibrated: Calibrated,
    /// The photographs that were used, by number from 0.
    pub used: Vec<usize>,
    /// Those that were not, and why.
    pub refused: Vec<(usize, Unseen)>,
    /// What speaks against relying on it; photographs are numbered among all.
    pub warnings: Vec<CalibrationWarning>,
}

/// Why photographs of a board give no lens.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{error}")]
pub struct NoCalibration {
    /// Why; photographs are numbered among all.
    pub error: CalibrateError,
    /// The photographs that were used, by number from 0.
    pub used: Vec<usize>,
    /// Those that were not, and why.
    pub refused: Vec<(usize, Unseen)>,
}

/// The lens by what photographs of a board have shown. Those in which nothing of it was found, or that are of another
/// size than most in which it was, are passed over.
///
/// # Errors
/// [`NoCalibration`] where the others do not fix the lens.
pub fn calibration(
    seen: &[Result<SeenBoard, Unseen>],
    free_parameters: FreeParameters,
) -> Result<Calibration, NoCalibration> {
    let (mut used, mut refused, mut views) = (Vec::new(), Vec::new(), Vec::new());
    let others = usual_size(seen);
    for (number, seen) in seen.iter().enumerate() {
        match seen {
            Ok(SeenBoard { size, .. }) if *size != others => {
                refused.push((number, Unseen::Size { size: *size, others }));
            }
            Ok(board) => {
                used.push(number);
                views.push(board.sightings());
            }
            Err(unseen) => refused.push((number, *unseen)),
        }
    }
    match by_views(others, &views, free_parameters, &used) {
        Ok((calibrated, warnings)) => {
            Ok(Calibration { size: others, calibrated, used, refused, warnings })
        }
        Err(error) => Err(NoCalibration { error, used, refused }),
    }
}

/// The size that most boards were seen in, of equally many the first one's.
fn usual_size(seen: &[Result<SeenBoard, Unseen>]) -> [u32; 2] {
    let sizes = || seen.iter().flatten().map(|board| board.size);
    let count = |size: [u32; 2]| sizes().filter(|other| *other == size).count();
    sizes().rev().max_by_key(|size| count(*size)).unwrap_or_default()
}

fn by_views(
    size: [u32; 2],
    views: &[Vec<Sighting>],
    free_parameters: FreeParameters,
    numbers: &[usize],
) -> Result<(Calibrated, Vec<CalibrationWarning>), CalibrateError> {
    let calibrated = calibrate(size, views, free_parameters)
        .map_err(|error| error.renumbered(|view| numbers[view]))?;
    let warnings = calibrated.warnings(size, views);
    let warnings = warnings.into_iter().map(|warning| warning.renumbered(|view| numbers[view]));
    Ok((calibrated, warnings.collect()))
}
