//! The values of each row of a sweep, each row by itself.

use sobol::Sobol;
use sobol::params::JoeKuoD6;
use whipcord_numerics::random::{mixed, part};

use crate::axis::{Axis, AxisValues};
use crate::error::SweepError;
use crate::permutation::Permutation;

/// How the values of the axes are combined.
#[derive(Clone, Debug, PartialEq)]
pub enum Sampling {
    /// All combinations; the last axis varies fastest.
    Grid,
    /// Each axis at random, by itself.
    Random {
        /// Number of rows.
        rows: u64,
        /// What the numbers follow from.
        seed: u64,
    },
    /// Each axis is divided into as many parts as there are rows, and each part is met once, at random.
    LatinHypercube {
        /// Number of rows.
        rows: u64,
        /// What the numbers follow from.
        seed: u64,
    },
    /// The sequence of Sobol with the direction numbers of Joe and Kuo (2008), shifted at random in its digits.
    Sobol {
        /// Number of rows: powers of two fill the ranges most evenly.
        rows: u64,
        /// What the shift follows from.
        seed: u64,
    },
    /// Row by row.
    Table {
        /// Rows × axes.
        values: Vec<f64>,
    },
}

impl Sampling {
    /// Its name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Random { .. } => "random",
            Self::LatinHypercube { .. } => "latin-hypercube",
            Self::Sobol { .. } => "sobol",
            Self::Table { .. } => "table",
        }
    }

    /// What random samples follow from.
    #[must_use]
    pub const fn seed(&self) -> Option<u64> {
        match self {
            Self::Random { seed, .. }
            | Self::LatinHypercube { seed, .. }
            | Self::Sobol { seed, .. } => Some(*seed),
            Self::Grid | Self::Table { .. } => None,
        }
    }

    /// The method of this name for so many samples; `None` of another name, and of methods that take no samples.
    #[must_use]
    pub fn named(name: &str, rows: u64, seed: u64) -> Option<Self> {
        let all = [
            Self::Random { rows, seed },
            Self::LatinHypercube { rows, seed },
            Self::Sobol { rows, seed },
        ];
        all.into_iter().find(|of| of.name() == name)
    }
}

/// Rows of a data set that can be told apart in a column of numbers.
pub const MOST_ROWS: u64 = 1 << 53;
/// Axes of the sequence of Sobol.
const MOST_SOBOL: usize = 100;
/// Bits of its points.
const SOBOL_BITS: usize = 53;

/// The rows of a sweep.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    axes: Vec<Axis>,
    sampling: Sampling,
    rows: u64,
    /// Direction numbers of each axis.
    directions: Vec<Vec<u64>>,
}

impl Samples {
    pub fn new(axes: Vec<Axis>, sampling: Sampling) -> Result<Self, SweepError> {
        if axes.is_empty() {
            return Err(SweepError::NoAxes);
        }
        let is_table = matches!(sampling, Sampling::Table { .. });
        if let Some(axis) = axes.iter().find(|axis| !is_table && !axis.has_values()) {
            return Err(SweepError::NoValues { path: axis.path.clone() });
        }
        let is_grid = sampling == Sampling::Grid;
        for axis in axes.iter().filter(|_| !is_grid) {
            if let AxisValues::Range { count: Some(count), .. } = axis.values {
                return Err(SweepError::Count { path: axis.path.clone(), count });
            }
        }
        let rows = match &sampling {
            Sampling::Grid => grid(&axes)?,
            Sampling::Random { rows, .. }
            | Sampling::LatinHypercube { rows, .. }
            | Sampling::Sobol { rows, .. } => *rows,
            Sampling::Table { values } => (values.len() / axes.len()) as u64,
        };
        if rows == 0 {
            return Err(SweepError::NoRows);
        }
        if rows > MOST_ROWS {
            return Err(SweepError::TooManyRows { most: MOST_ROWS });
        }
        let directions = match sampling {
            Sampling::Sobol { .. } if axes.len() > MOST_SOBOL => {
                return Err(SweepError::TooManySobolAxes { given: axes.len(), most: MOST_SOBOL });
            }
            Sampling::Sobol { .. } => {
                Sobol::<f64>::init_direction_vals(axes.len(), SOBOL_BITS, &JoeKuoD6::minimal())
            }
            _ => Vec::new(),
        };
        Ok(Self { axes, sampling, rows, directions })
    }

    pub const fn rows(&self) -> u64 {
        self.rows
    }

    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    pub const fn sampling(&self) -> &Sampling {
        &self.sampling
    }

    /// Adds the values of so many rows from a first one, as [`Self::push`] does for each.
    pub fn extend(&self, first: u64, count: u64, out: &mut Vec<f64>) {
        let Sampling::Sobol { seed, .. } = self.sampling else {
            return (first..first + count).for_each(|row| self.push(row, out));
        };
        // From row to row one direction number comes or goes.
        let mut points: Vec<u64> =
            (0..self.axes.len()).map(|k| self.sobol_point(seed, k, first)).collect();
        for row in first..first + count {
            out.extend(self.axes.iter().zip(&points).map(|(axis, point)| axis.part(part(*point))));
            let changed = (row + 1).trailing_zeros() as usize;
            for (point, directions) in points.iter_mut().zip(&self.directions) {
                *point ^= directions.get(changed).copied().unwrap_or_default();
            }
        }
    }

    /// The digits of a point of the sequence of Sobol on an axis.
    fn sobol_point(&self, seed: u64, axis: usize, row: u64) -> u64 {
        let gray = row ^ (row >> 1);
        let set = self.directions[axis].iter().enumerate();
        let of_row = set.filter(|(bit, _)| gray >> bit & 1 == 1);
        of_row.fold(stream(seed, axis), |sum, (_, direction)| sum ^ direction)
    }

    /// Adds the values of a row, in the units of the axes.
    pub fn push(&self, row: u64, out: &mut Vec<f64>) {
        match &self.sampling {
            Sampling::Grid => {
                let first = out.len();
                let mut rest = row;
                for axis in self.axes.iter().rev() {
                    let count = axis.count().unwrap_or(1).max(1) as u64;
                    #[expect(clippy::cast_possible_truncation, reason = "below the axis' count")]
                    out.push(axis.at((rest % count) as usize));
                    rest /= count;
                }
                out[first..].reverse();
            }
            Sampling::Random { seed, .. } => {
                let at = |k: usize| part(mixed(stream(*seed, k) ^ mixed(row)));
                out.extend(self.axes.iter().enumerate().map(|(k, axis)| axis.part(at(k))));
            }
            Sampling::LatinHypercube { rows, seed } => {
                let at = |k: usize| {
                    let key = stream(*seed, k);
                    let place = Permutation::new(*rows, key).at(row);
                    #[expect(clippy::cast_precision_loss, reason = "below 2⁵³")]
                    let of = |x: u64| x as f64;
                    (of(place) + part(mixed(!key ^ mixed(row)))) / of(*rows)
                };
                out.extend(self.axes.iter().enumerate().map(|(k, axis)| axis.part(at(k))));
            }
            Sampling::Sobol { seed, .. } => {
                let at = |k: usize| part(self.sobol_point(*seed, k, row));
                out.extend(self.axes.iter().enumerate().map(|(k, axis)| axis.part(at(k))));
            }
            Sampling::Table { values } => {
                let width = self.axes.len();
                #[expect(clippy::cast_possible_truncation, reason = "a row of a table in memory")]
                let row = row as usize;
                out.extend_from_slice(&values[row * width..(row + 1) * width]);
            }
        }
    }
}

/// A number for each axis.
fn stream(seed: u64, axis: usize) -> u64 {
    mixed(mixed(seed).wrapping_add(axis as u64))
}

fn grid(axes: &[Axis]) -> Result<u64, SweepError> {
    let mut rows: u64 = 1;
    for axis in axes {
        let count = axis.count().ok_or_else(|| SweepError::NoCount { path: axis.path.clone() })?;
        rows = rows
            .checked_mul(count as u64)
            .filter(|rows| *rows <= MOST_ROWS)
            .ok_or(SweepError::TooManyRows { most: MOST_ROWS })?;
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(axes: &[&str], sampling: Sampling) -> Samples {
        Samples::new(axes.iter().map(|axis| axis.parse().unwrap()).collect(), sampling).unwrap()
    }

    fn rows(of: &Samples) -> Vec<Vec<f64>> {
        let row = |row| {
            let mut out = Vec::new();
            of.push(row, &mut out);
            out
        };
        (0..of.rows()).map(row).collect()
    }

    #[test]
    fn a_grid_has_all_combinations() {
        let of = samples(&["a=0 N:2 N:3", "b=5,7"], Sampling::Grid);
        let all = [[0.0, 5.0], [0.0, 7.0], [1.0, 5.0], [1.0, 7.0], [2.0, 5.0], [2.0, 7.0]];
        assert_eq!(rows(&of), all);
    }

    #[test]
    fn each_part_of_a_latin_hypercube_is_met_once() {
        let of = samples(&["a=0:1", "b=0:1"], Sampling::LatinHypercube { rows: 37, seed: 3 });
        let all = rows(&of);
        for k in 0..2 {
            let mut parts: Vec<u64> = all.iter().map(|row| (row[k] * 37.0) as u64).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..37).collect::<Vec<_>>());
        }
        // The axes are not the same permutation.
        assert!(all.iter().any(|row| (row[0] - row[1]).abs() > 0.3));
    }

    #[test]
    fn sobol_points_are_in_each_box_once() {
        // 2⁸ points are a (0, 8, 2)-net: one in each of 16 × 16 boxes, also when they are shifted in their digits.
        let of = samples(&["a=0:1", "b=0:1"], Sampling::Sobol { rows: 256, seed: 9 });
        let mut boxes: Vec<(u64, u64)> =
            rows(&of).iter().map(|row| ((row[0] * 16.0) as u64, (row[1] * 16.0) as u64)).collect();
        boxes.sort_unstable();
        boxes.dedup();
        assert_eq!(boxes.len(), 256);
    }

    #[test]
    fn many_rows_are_those_one_by_one() {
        for sampling in [
            Sampling::Sobol { rows: 100, seed: 9 },
            Sampling::LatinHypercube { rows: 100, seed: 9 },
        ] {
            let of = samples(&["a=0:1", "b=3,5,8", "c=-1:1"], sampling);
            let all: Vec<f64> = rows(&of).concat();
            for (first, count) in [(0, 100), (7, 1), (31, 33), (99, 1)] {
                let mut out = Vec::new();
                of.extend(first, count, &mut out);
                let first = 3 * usize::try_from(first).unwrap();
                assert_eq!(out, all[first..first + 3 * usize::try_from(count).unwrap()]);
            }
        }
    }

    #[test]
    fn random_rows_fill_the_range_and_follow_from_the_seed() {
        let of = |seed| rows(&samples(&["a=-1:3", "b=0:1"], Sampling::Random { rows: 4000, seed }));
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
        let mean = of(1).iter().map(|row| row[0]).sum::<f64>() / 4000.0;
        // Four standard deviations of the mean of 4,000 numbers spread over 4.
        assert!((mean - 1.0).abs() < 4.0 * 4.0 / (12.0_f64 * 4000.0).sqrt(), "{mean}");
        let product = of(1).iter().map(|row| (row[0] - 1.0) * (row[1] - 0.5)).sum::<f64>() / 4000.0;
        assert!(product.abs() < 4.0 * (4.0 / 12.0) / 4000.0_f64.sqrt(), "{product}");
    }

    #[test]
    fn what_cannot_be_sampled_says_why() {
        let new = |axes: &[&str], sampling| {
            Samples::new(axes.iter().map(|axis| axis.parse().unwrap()).collect(), sampling)
        };
        assert!(matches!(new(&[], Sampling::Grid), Err(SweepError::NoAxes)));
        assert!(matches!(new(&["a=0:1"], Sampling::Grid), Err(SweepError::NoCount { .. })));
        let random = Sampling::Random { rows: 0, seed: 0 };
        assert!(matches!(new(&["a=0:1"], random), Err(SweepError::NoRows)));
        let many = ["a=0:1:4000000", "b=0:1:4000000", "c=0:1:4000000"];
        assert!(matches!(new(&many, Sampling::Grid), Err(SweepError::TooManyRows { .. })));
    }
}
