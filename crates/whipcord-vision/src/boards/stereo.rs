use std::f64::consts::{FRAC_PI_2, PI};

use thiserror::Error;
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Pinhole, RefusedPair, SeenByBoth, StereoCalibration, StereoError, calibrate_stereo,
};

use super::{Board, SeenBoard, Unseen};

/// Two cameras whose relative pose was calibrated by photographs of a board.
#[derive(Clone, Debug, PartialEq)]
pub struct Stereo {
    /// The cameras and how sure their pose is; pairs are numbered among all, from 0.
    pub calibrated: StereoCalibration,
    /// The pairs that were not used, by number from 0, and why.
    pub refused: Vec<(usize, UnusedPair)>,
}

/// Why the pose of the second camera is not found.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{error}")]
pub struct NoStereo {
    /// Why.
    pub error: StereoError,
    /// The pairs that were not used, by number from 0, and why.
    pub refused: Vec<(usize, UnusedPair)>,
}

/// Why a pair of photographs is not used.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum UnusedPair {
    /// A photograph shows nothing of the board that could be used.
    #[error("photograph of camera {}: {why}", camera + 1)]
    Unseen {
        /// Number of the camera, from 0.
        camera: usize,
        /// Why.
        why: Unseen,
    },
    /// What it shows cannot be used.
    #[error(transparent)]
    Refused(#[from] RefusedPair),
}

/// The pose of the second of two cameras relative to the first, from what both photographs of each pair show of a board. The
/// lenses and the sizes of their images are given. Without a board, the points of both photographs are numbered alike.
///
/// # Errors
/// [`NoStereo`] where the pairs do not fix it.
pub fn stereo(
    board: Option<&Board>,
    seen: [&[Result<SeenBoard, Unseen>]; 2],
    lenses: [&Pinhole; 2],
    sizes: [[u32; 2]; 2],
) -> Result<Stereo, NoStereo> {
    let (mut pairs, mut numbers, mut refused) = (Vec::new(), Vec::new(), Vec::new());
    for (number, (first, second)) in seen[0].iter().zip(seen[1]).enumerate() {
        let usable = |camera: usize, seen: &Result<SeenBoard, Unseen>| match seen {
            Ok(board) if board.size != sizes[camera] => Err(UnusedPair::Unseen {
                camera,
                why: Unseen::Size { size: board.size, others: sizes[camera] },
            }),
            Ok(board) => Ok(board.sightings()),
            Err(why) => Err(UnusedPair::Unseen { camera, why: *why }),
        };
        match (usable(0, first), usable(1, second)) {
            (Ok(first), Ok(second)) => {
                pairs.push([first, second]);
                numbers.push(number);
            }
            (Err(why), _) | (_, Err(why)) => refused.push((number, why)),
        }
    }
    let found = by_pairs(board, &pairs, lenses, sizes);
    match found {
        Ok(mut calibrated) => {
            for pair in &mut calibrated.pairs {
                pair.number = numbers[pair.number];
            }
            for (number, why) in &mut calibrated.refused {
                *number = numbers[*number];
                refused.push((*number, UnusedPair::Refused(*why)));
            }
            refused.sort_by_key(|(number, _)| *number);
            Ok(Stereo { calibrated, refused })
        }
        Err(StereoError::NoPair { first, .. }) => {
            let first = first.map(|(number, why)| (numbers[number], why));
            let error = StereoError::NoPair { given: seen[0].len(), first };
            Err(NoStereo { error, refused })
        }
        Err(error) => Err(NoStereo { error, refused }),
    }
}

fn by_pairs(
    board: Option<&Board>,
    pairs: &[SeenByBoth],
    lenses: [&Pinhole; 2],
    sizes: [[u32; 2]; 2],
) -> Result<StereoCalibration, StereoError> {
    let symmetries = board.map(Board::symmetries).unwrap_or_default();
    calibrate_stereo(lenses, sizes.map(Some), pairs, &symmetries)
}

impl Board {
    /// Motions in the frame of the board after which its corners look the same: half a turn of a chessboard, and a quarter of one
    /// with as many corners along as across. The markers of a ChArUco board tell it from all others.
    #[must_use]
    pub fn symmetries(&self) -> Vec<Pose> {
        if self.markers.is_some() {
            return Vec::new();
        }
        let middle = 0.5 * (self.point(0) + self.point(self.count() - 1));
        let turns: &[f64] = match self.corners {
            [along, across] if along == across => &[PI, FRAC_PI_2, -FRAC_PI_2],
            _ => &[PI],
        };
        let motion = |&turn: &f64| {
            let rotation = UnitQuaternion::exp(Vec3::new(0.0, 0.0, turn));
            Pose { position: middle - rotation.rotate(middle), rotation }
        };
        turns.iter().map(motion).collect()
    }
}
