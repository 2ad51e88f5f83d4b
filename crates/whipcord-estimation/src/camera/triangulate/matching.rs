//! Markers of two photographs that are the same, by their order along the robot: eq. (s5).

use thiserror::Error;

use super::error::TriangulateError;
use super::point::{refuse_one_place, triangulate};
use crate::camera::view::Camera;

/// Markers of two photographs that are the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Matched {
    /// Numbers of the same marker in the first and in the second photograph, from 0, in order.
    pub pairs: Vec<[usize; 2]>,
    /// Markers of each photograph that the other does not show.
    pub single: [Vec<usize>; 2],
}

/// Why markers cannot be matched.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MatchError {
    /// No two lines of sight meet.
    #[error(
        "no marker of the first photograph is one of the second: of {} and {} markers none are within {limit} pixels of one another's epipolar line; check that the cameras are those of the photographs, in this order, and that both were taken at one time",
        given[0], given[1]
    )]
    NoCommon {
        /// Markers of each photograph.
        given: [usize; 2],
        /// Largest epipolar distance in pixels.
        limit: f64,
    },
    /// Another way to match them is as good.
    #[error(
        "marker {} of the first photograph may be marker {} of the second, or not: the markers are moved along the robot and fit as well; give their number in all and the numbers of those that are hidden",
        pair[0] + 1, pair[1] + 1
    )]
    Ambiguous {
        /// Numbers of two markers, from 0, that are the same or are not.
        pair: [usize; 2],
    },
    /// The cameras determine no points.
    #[error(transparent)]
    Cameras(#[from] TriangulateError),
}

/// Which markers of two photographs, both in order along the robot, are the same, where some are seen in one alone. Of
/// all ways that keep the order it takes the one with the most markers within `limit` pixels of the epipolar constraint,
/// and of these the one whose squares of the distances are least.
///
/// # Errors
/// [`MatchError`] where no marker is common, or where another way is as good.
pub fn match_in_order(
    cameras: [&Camera; 2],
    markers: [&[[f64; 2]]; 2],
    limit: f64,
) -> Result<Matched, MatchError> {
    refuse_one_place(cameras)?;
    let given = markers.map(<[_]>::len);
    // What does not meet in front of both cameras is no marker.
    let distance = |i: usize, j: usize| {
        let found = triangulate(cameras, [markers[0][i], markers[1][j]], 1.0);
        found.ok().map(|found| found.epipolar / limit).filter(|share| *share <= 1.0)
    };
    let table = Table {
        given,
        cost: (0..given[0])
            .flat_map(|i| (0..given[1]).map(move |j| (i, j)))
            .map(|(i, j)| distance(i, j).map(|share| share * share))
            .collect(),
    };
    let (cost, pairs) = table.best(None);
    if pairs.is_empty() {
        return Err(MatchError::NoCommon { given, limit });
    }
    // As many markers in another way, whose distances are hardly larger.
    let alike = |&pair: &[usize; 2]| {
        let (other, others) = table.best(Some(pair));
        let margin = LIKELY / (limit * limit) + 0.5 * cost;
        others.len() == pairs.len() && other - cost <= margin
    };
    let all = given == [pairs.len(); 2];
    if let Some(&pair) = pairs.iter().find(|pair| !all && alike(pair)) {
        return Err(MatchError::Ambiguous { pair });
    }
    let single = [0, 1].map(|photo| {
        (0..given[photo]).filter(|&k| !pairs.iter().any(|pair| pair[photo] == k)).collect()
    });
    Ok(Matched { pairs, single })
}

/// Another way is as good if its sum of squares is larger by less than this, in pixels².
const LIKELY: f64 = 1.0;

/// Squares of the epipolar distances of each marker with each, in units of the limit; none beyond it.
struct Table {
    given: [usize; 2],
    cost: Vec<Option<f64>>,
}

impl Table {
    /// The longest common order, of these that with the least cost: the cost and the pairs. One pair may be forbidden.
    fn best(&self, forbidden: Option<[usize; 2]>) -> (f64, Vec<[usize; 2]>) {
        let [rows, columns] = self.given;
        let at = |i: usize, j: usize| i * (columns + 1) + j;
        let better = |a: (usize, f64), b: (usize, f64)| a.0 > b.0 || (a.0 == b.0 && a.1 < b.1);
        let joined = |best: &[(usize, f64)], i: usize, j: usize| {
            let cost = self.cost[i * columns + j].filter(|_| forbidden != Some([i, j]))?;
            let (count, sum) = best[at(i + 1, j + 1)];
            Some((count + 1, sum + cost))
        };
        let mut best = vec![(0, 0.0); (rows + 1) * (columns + 1)];
        for i in (0..rows).rev() {
            for j in (0..columns).rev() {
                let mut value = best[at(i + 1, j)];
                if better(best[at(i, j + 1)], value) {
                    value = best[at(i, j + 1)];
                }
                if let Some(pair) = joined(&best, i, j).filter(|pair| better(*pair, value)) {
                    value = pair;
                }
                best[at(i, j)] = value;
            }
        }
        let (mut i, mut j, mut pairs) = (0, 0, Vec::new());
        while i < rows && j < columns {
            let value = best[at(i, j)];
            if value == best[at(i + 1, j)] {
                i += 1;
            } else if value == best[at(i, j + 1)] {
                j += 1;
            } else {
                pairs.push([i, j]);
                (i, j) = (i + 1, j + 1);
            }
        }
        (best[0].1, pairs)
    }
}
