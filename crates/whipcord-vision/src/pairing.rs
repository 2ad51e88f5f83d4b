//! Disks and markers that two photographs show, in space.

use thiserror::Error;
use whipcord_estimation::camera::{
    Camera, MatchError, TriangulateError, Triangulated, match_in_order, triangulate,
};

use crate::detect::Mark;

/// A disk or marker that both photographs show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointInSpace {
    /// Its number in the first photograph.
    pub disk: usize,
    /// Where each photograph shows it.
    pub marks: [Mark; 2],
    /// Where it is.
    pub found: Triangulated,
}

/// A pair of marks that is not used.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Its numbers in the photographs.
    pub disks: [usize; 2],
    /// Its epipolar distance in pixels, where the pair has one.
    pub epipolar: Option<f64>,
    /// Why.
    pub why: String,
}

/// What two photographs show.
#[derive(Clone, Debug, PartialEq)]
pub struct PointsInSpace {
    /// What both show.
    pub used: Vec<PointInSpace>,
    /// What does not belong together.
    pub left_out: Vec<LeftOut>,
    /// Numbers of what one photograph alone shows.
    pub single: [Vec<usize>; 2],
}

/// Why two photographs give no points.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoPoints {
    /// The marks are not matched, or the cameras have no base line.
    #[error(transparent)]
    Match(#[from] MatchError),
    /// No number is in both.
    #[error("no disk or marker is seen in both photographs")]
    NoCommon,
    /// Most pairs do not meet.
    #[error(
        "{} of {count} disks or markers are not where both cameras can see them, with at most {limit} pixels from the epipolar constraint:{}",
        left_out.len(),
        left_out.iter().map(|out| format!("\n  {}: {}", out.disks[0], out.why)).collect::<String>()
    )]
    MostLeftOut {
        /// Which.
        left_out: Vec<LeftOut>,
        /// Of how many.
        count: usize,
        /// Largest epipolar distance in pixels.
        limit: f64,
    },
}

impl PointsInSpace {
    /// What is the same in both photographs, in space: marks with the same number where they have numbers, else those that are found in
    /// the same order along the robot. Pairs that are farther than `limit` pixels from the epipolar constraint are left out;
    /// `deviation` is the standard deviation of a column or row in pixels.
    ///
    /// # Errors
    /// [`NoPoints`] where nothing belongs together.
    pub fn of(
        cameras: [&Camera; 2],
        marks: [&[(usize, Mark)]; 2],
        has_numbers: bool,
        limit: f64,
        deviation: f64,
    ) -> Result<Self, NoPoints> {
        let (pairs, single) = if has_numbers {
            by_number(marks)
        } else {
            let pixels = marks
                .map(|of| -> Vec<[f64; 2]> { of.iter().map(|(_, mark)| mark.pixel).collect() });
            let found = match_in_order(cameras, [&pixels[0], &pixels[1]], limit)?;
            (found.pairs, found.single)
        };
        if pairs.is_empty() {
            return Err(NoPoints::NoCommon);
        }
        let (mut used, mut left_out) = (Vec::new(), Vec::new());
        let count = pairs.len();
        for [i, j] in pairs {
            let ((disk, first), (other, second)) = (marks[0][i], marks[1][j]);
            let out = |epipolar, why| LeftOut { disks: [disk, other], epipolar, why };
            match triangulate(cameras, [first.pixel, second.pixel], deviation) {
                Ok(found) if found.epipolar > limit => {
                    let why = format!("{:.1} pixels from the epipolar constraint", found.epipolar);
                    left_out.push(out(Some(found.epipolar), why));
                }
                Ok(found) => used.push(PointInSpace { disk, marks: [first, second], found }),
                Err(error @ TriangulateError::NoBaseline { .. }) => {
                    return Err(MatchError::Cameras(error).into());
                }
                Err(error) => left_out.push(out(None, error.to_string())),
            }
        }
        if 2 * left_out.len() > count {
            return Err(NoPoints::MostLeftOut { left_out, count, limit });
        }
        let single = [0, 1].map(|photo| single[photo].iter().map(|&k| marks[photo][k].0).collect());
        Ok(Self { used, left_out, single })
    }

    /// Root mean square epipolar distance in pixels; none without points.
    #[must_use]
    pub fn epipolar(&self) -> Option<f64> {
        let squares: f64 = self.used.iter().map(|point| point.found.epipolar.powi(2)).sum();
        let count = self.used.len();
        (count > 0).then(|| (squares / count as f64).sqrt())
    }
}

/// Which entries of the two lists have the same number, and which of each list are in it alone.
fn by_number(marks: [&[(usize, Mark)]; 2]) -> (Vec<[usize; 2]>, [Vec<usize>; 2]) {
    let place =
        |photo: usize, number: usize| marks[photo].iter().position(|(other, _)| *other == number);
    let pairs = marks[0].iter().enumerate();
    let pairs = pairs.filter_map(|(i, (number, _))| Some([i, place(1, *number)?])).collect();
    let single = [0, 1].map(|photo| {
        let own = marks[photo].iter().enumerate();
        own.filter(|(_, (number, _))| place(1 - photo, *number).is_none()).map(|(k, _)| k).collect()
    });
    (pairs, single)
}
