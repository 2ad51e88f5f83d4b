//! The pose of a second camera relative to the first, from photographs of a board that both took at one time: eq. (s6) to
//! (s8) of `docs/theory/cameras.md`.

mod error;
mod rig;
mod start;

use whipcord_numerics::{Pose, Vec3};

use super::calibrate::LensDeviations;
use super::lens::{Lens, Pinhole};
use super::locate::{Sighting, pose_deviations};
use super::pose_uncertainty::{PoseByLens, PoseCovariance, add_lens};
use super::triangulate::triangulate;
use super::view::Camera;
pub use error::{RefusedPair, StereoError};
use rig::{Refined, refine};
use start::{Hypotheses, Pair};

/// What both photographs of a pair show of a board, with the points in the frame of the board, in m.
pub type SeenByBoth = [Vec<Sighting>; 2];

/// Two cameras whose relative pose was calibrated. The first is at the origin of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct StereoCalibration {
    /// The cameras; the pose of the second is that in the frame of the first.
    pub cameras: [Camera; 2],
    /// Covariance of position (m) and rotation (rad) of the second camera along and about the axes of the first, eq. (s8), by
    /// the errors of the corners alone: the lenses are taken as they are, unless [`Self::with_lenses`] was asked.
    pub covariance: PoseCovariance,
    /// How position and rotation follow the focal lengths, the principal point and the first twelve distortion coefficients of each lens, eq. (s9).
    pub by_lenses: [PoseByLens; 2],
    /// Distance of the cameras in m, and its standard deviation.
    pub baseline: [f64; 2],
    /// Standard deviation of a column or row at which a corner was seen, in pixels, as what is left of them tells.
    pub pixel: f64,
    /// Root mean square distance between seen and projected corners in pixels.
    pub rms: f64,
    /// Root mean square distance of common corners from the epipolar constraint in pixels, eq. (s4); none without common
    /// corners.
    pub epipolar: Option<f64>,
    /// The pairs that were used.
    pub pairs: Vec<StereoPair>,
    /// Numbers of those that were not, from 0, and why.
    pub refused: Vec<(usize, RefusedPair)>,
}

/// A pair of photographs that was used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StereoPair {
    /// Its number, from 0.
    pub number: usize,
    /// Corners that are seen in both photographs.
    pub common: usize,
    /// Root mean square distance between seen and projected corners in pixels, for each camera.
    pub rms: [f64; 2],
    /// Root mean square epipolar distance of the common corners in pixels; none without them.
    pub epipolar: Option<f64>,
    /// Whether the second photograph numbers the corners of a symmetric board from another one than the first.
    pub renumbered: bool,
}

impl StereoCalibration {
    /// Standard deviations of the position of the second camera in m, along the axes of the first.
    #[must_use]
    pub fn position_deviation(&self) -> Vec3 {
        pose_deviations(&self.covariance)[0]
    }

    /// The same with the errors of lenses that were calibrated, eq. (s10); of one that is not given nothing is known but what it is.
    #[must_use]
    pub fn with_lenses(self, lenses: [Option<&LensDeviations>; 2]) -> Self {
        self.with_lens_covariances(lenses.map(|of| of.map(|of| &of.covariance[..])))
    }

    /// [`Self::with_lenses`], by [`LensDeviations::covariance`] of each.
    #[must_use]
    pub fn with_lens_covariances(mut self, lenses: [Option<&[Vec<f64>]>; 2]) -> Self {
        for (by_lens, lens) in self.by_lenses.iter().zip(lenses) {
            if let Some(lens) = lens {
                add_lens(&mut self.covariance, by_lens, lens);
            }
        }
        let position = self.cameras[1].pose().position;
        self.baseline[1] = distance_deviation(position, &self.covariance);
        self
    }

    /// Standard deviations of the rotation of the second camera in rad, about the axes of the first.
    #[must_use]
    pub fn rotation_deviation(&self) -> Vec3 {
        pose_deviations(&self.covariance)[1]
    }
}

/// The pose of the second of two cameras relative to the first, whose lenses and image sizes are given, from pairs of
/// photographs of a flat board that both took at one time, such that the squares of the distances in all images are least. The
/// poses of the boards are unknowns as well.
///
/// A board that looks the same after some motions, such as a chessboard after half a turn, may be numbered differently in the
/// two photographs; `symmetries` has these motions in the frame of the board.
///
/// # Errors
/// [`StereoError`] where the pairs do not fix the pose.
pub fn calibrate_stereo(
    lenses: [&Pinhole; 2],
    sizes: [Option<[u32; 2]>; 2],
    pairs: &[SeenByBoth],
    symmetries: &[Pose],
) -> Result<StereoCalibration, StereoError> {
    let camera = |i: usize| Camera::new(Lens::Pinhole(*lenses[i]), Pose::IDENTITY, sizes[i]);
    let cameras = [camera(0)?, camera(1)?];
    let (mut located, mut refused) = (Vec::new(), Vec::new());
    for (number, seen) in pairs.iter().enumerate() {
        match Pair::located(number, lenses, sizes, seen) {
            Ok(pair) => located.push(pair),
            Err(why) => refused.push((number, why)),
        }
    }
    if located.is_empty() {
        return Err(StereoError::NoPair { given: pairs.len(), first: refused.first().copied() });
    }
    let hypotheses = Hypotheses { cameras: &cameras, pairs: &located, symmetries };
    let candidates = hypotheses.ranked();
    let start = *candidates.first().ok_or(StereoError::Undetermined)?;
    let mut found = refine(&cameras, hypotheses.views(start), start)?;
    while let Some((number, why)) = found.contradicting() {
        refused.push((number, why));
        let views = found.views.into_iter().filter(|view| view.number != number).collect();
        found = refine(&cameras, views, found.relative)?;
    }
    refuse_ambiguous(&hypotheses, &candidates, &found, &refused)?;
    refused.sort_by_key(|(number, _)| *number);
    measured(found, refused)
}

/// Another pose that explains the same pairs as well.
fn refuse_ambiguous(
    hypotheses: &Hypotheses<'_>,
    candidates: &[Pose],
    found: &Refined,
    refused: &[(usize, RefusedPair)],
) -> Result<(), StereoError> {
    /// Poses that differ by less in rad are found from one another.
    const SAME: f64 = 0.1;
    const TRIED: usize = 3;
    let turn = |other: &Pose| (other.rotation * found.relative.rotation.conjugate()).log().norm();
    for other in candidates.iter().filter(|other| turn(other) > SAME).take(TRIED) {
        let mut views = hypotheses.views(*other);
        views.retain(|view| !refused.iter().any(|(number, _)| *number == view.number));
        let Ok(other) = refine(hypotheses.cameras, views, *other) else { continue };
        if turn(&other.relative) > SAME && other.rms <= 1.5 * found.rms + 1e-9 {
            let rms = [found.rms, other.rms];
            return Err(StereoError::Ambiguous { turn: turn(&other.relative), rms });
        }
    }
    Ok(())
}

/// Standard deviation of the distance of the cameras.
fn distance_deviation(position: Vec3, covariance: &PoseCovariance) -> f64 {
    let variance: f64 = (0..3)
        .flat_map(|i| (0..3).map(move |j| (i, j)))
        .map(|(i, j)| position[i] * covariance[i][j] * position[j])
        .sum();
    let baseline = position.norm();
    // Of cameras in one place the distance has no direction.
    match baseline > 0.0 {
        true => variance.max(0.0).sqrt() / baseline,
        false => greatest_deviation(covariance),
    }
}

fn greatest_deviation(covariance: &PoseCovariance) -> f64 {
    (0..3).map(|i| covariance[i][i].max(0.0)).fold(0.0, f64::max).sqrt()
}

fn measured(
    found: Refined,
    refused: Vec<(usize, RefusedPair)>,
) -> Result<StereoCalibration, StereoError> {
    let covariance = found.covariance.ok_or(StereoError::Undetermined)?;
    let second = found.cameras[1].at(found.relative)?;
    let cameras = [found.cameras[0], second];
    let position = found.relative.position;
    let baseline = position.norm();
    let deviation = distance_deviation(position, &covariance);
    let largest = greatest_deviation(&covariance);
    if baseline <= 3.0 * largest {
        return Err(StereoError::NoBaseline { baseline, deviation: largest });
    }
    let (mut squares, mut corners) = (0.0, 0);
    let mut pairs = Vec::with_capacity(found.views.len());
    for (view, &rms) in found.views.iter().zip(&found.view_rms) {
        let distances = view.common().into_iter().filter_map(|pixels| {
            triangulate([&cameras[0], &cameras[1]], pixels, 1.0).ok().map(|at| at.epipolar)
        });
        let own: Vec<f64> = distances.map(|distance| distance * distance).collect();
        let sum: f64 = own.iter().sum();
        squares += sum;
        corners += own.len();
        pairs.push(StereoPair {
            number: view.number,
            common: own.len(),
            rms,
            epipolar: (!own.is_empty()).then(|| (sum / own.len() as f64).sqrt()),
            renumbered: view.renumbered,
        });
    }
    Ok(StereoCalibration {
        cameras,
        covariance,
        by_lenses: found.by_lenses,
        baseline: [baseline, deviation],
        pixel: found.pixel,
        rms: found.rms,
        epipolar: (corners > 0).then(|| (squares / corners as f64).sqrt()),
        pairs,
        refused,
    })
}
