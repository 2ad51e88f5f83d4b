use whipcord_numerics::Vec3;

use super::disks::Disks;
use super::error::{Problem, RobotError, check_on_backbone};

/// A quantity along the backbone. Between the places where it is given it varies linearly.
///
/// ```
/// use whipcord::{Along, Disks};
///
/// let disks = Disks::equally_spaced(0.2, 3, 0.008);
/// let taper = Along::PerDisk(vec![3e-3, 2e-3, 1e-3]);
/// assert_eq!(taper.at(&disks, 0.05), 2.5e-3);
/// // Half of the backbone stiffer than the other: a place named twice is a step.
/// let step = Along::At { arc_lengths: vec![0.1, 0.1], values: vec![8.0, 2.0] };
/// assert_eq!([0.05, 0.15].map(|s| step.at(&disks, s)), [8.0, 2.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Along<T> {
    /// The same everywhere.
    Uniform(T),
    /// Given at each disk.
    PerDisk(Vec<T>),
    /// Given at arc lengths in m, in ascending order; constant before the first and beyond the
    /// last. At a place named twice it steps from the first value to the second.
    At {
        /// The places.
        arc_lengths: Vec<f64>,
        /// The value at each of them.
        values: Vec<T>,
    },
}

/// What varies linearly.
pub trait Linear: Clone {
    /// The value this fraction of the way from `self` to `other`.
    #[must_use]
    fn toward(&self, other: &Self, fraction: f64) -> Self;
}

impl Linear for f64 {
    fn toward(&self, other: &Self, fraction: f64) -> Self {
        self * (1.0 - fraction) + other * fraction
    }
}

impl Linear for Vec3 {
    fn toward(&self, other: &Self, fraction: f64) -> Self {
        *self * (1.0 - fraction) + *other * fraction
    }
}

impl<T: Linear, const N: usize> Linear for [T; N] {
    fn toward(&self, other: &Self, fraction: f64) -> Self {
        core::array::from_fn(|i| self[i].toward(&other[i], fraction))
    }
}

/// How the parts of a quantity are called in errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paths {
    /// The only value, or the list with one for each disk.
    pub value: &'static str,
    /// The values at arc lengths.
    pub values: &'static str,
    /// The arc lengths.
    pub places: &'static str,
}

/// Places nearer to one another than this, relative to the length, are one to a model.
const LEAST_DISTANCE: f64 = 1e-9;

impl<T: Default> Default for Along<T> {
    fn default() -> Self {
        Self::Uniform(T::default())
    }
}

impl<T> From<T> for Along<T> {
    fn from(value: T) -> Self {
        Self::Uniform(value)
    }
}

impl<T> Along<T> {
    /// Whether it is given once for the whole length.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        matches!(self, Self::Uniform(_))
    }

    /// Arc lengths besides those of the disks at which its slope, or it itself, jumps.
    #[must_use]
    pub fn places(&self) -> &[f64] {
        match self {
            Self::At { arc_lengths, .. } => arc_lengths,
            _ => &[],
        }
    }

    /// The first and the last value given, those at base and tip.
    #[must_use]
    pub fn ends(&self) -> (&T, &T) {
        let values = self.values();
        (&values[0], &values[values.len() - 1])
    }

    /// All values given.
    #[must_use]
    pub fn values(&self) -> &[T] {
        match self {
            Self::Uniform(value) => core::slice::from_ref(value),
            Self::PerDisk(values) | Self::At { values, .. } => values,
        }
    }

    /// All values given, to be changed.
    pub(crate) fn values_mut(&mut self) -> &mut [T] {
        match self {
            Self::Uniform(value) => core::slice::from_mut(value),
            Self::PerDisk(values) | Self::At { values, .. } => values,
        }
    }

    /// The same with every value changed.
    #[must_use]
    pub fn map<U>(&self, change: impl Fn(&T) -> U) -> Along<U> {
        match self {
            Self::Uniform(value) => Along::Uniform(change(value)),
            Self::PerDisk(values) => Along::PerDisk(values.iter().map(change).collect()),
            Self::At { arc_lengths, values } => Along::At {
                arc_lengths: arc_lengths.clone(),
                values: values.iter().map(change).collect(),
            },
        }
    }
}

impl<T: Linear> Along<T> {
    /// The value at an arc length in m; behind a step at that place. `disks` are those of the robot.
    #[must_use]
    pub fn at(&self, disks: &Disks, arc_length: f64) -> T {
        self.at_end(disks, arc_length, arc_length)
    }

    /// The value at one end of a piece of the backbone inside which no place lies: `inside` is any
    /// arc length between its ends. It tells the two sides of a step apart.
    #[must_use]
    pub fn at_end(&self, disks: &Disks, arc_length: f64, inside: f64) -> T {
        match self {
            Self::Uniform(value) => value.clone(),
            Self::PerDisk(list) => {
                let (i, _) = disks.locate(inside);
                let s = &disks.arc_lengths;
                list[i].toward(&list[i + 1], (arc_length - s[i]) / (s[i + 1] - s[i]))
            }
            Self::At { arc_lengths: s, values } => {
                let after = s.partition_point(|&x| x <= inside);
                if after == 0 {
                    values[0].clone()
                } else if after == s.len() {
                    values[after - 1].clone()
                } else {
                    let (i, j) = (after - 1, after);
                    values[i].toward(&values[j], (arc_length - s[i]) / (s[j] - s[i]))
                }
            }
        }
    }

    /// The same quantity for a robot with other disks.
    #[must_use]
    pub fn apart_from(&self, disks: &Disks) -> Self {
        match self {
            Self::PerDisk(values) => {
                Self::At { arc_lengths: disks.arc_lengths.clone(), values: values.clone() }
            }
            _ => self.clone(),
        }
    }

    pub(super) fn check(
        &self,
        disks: &Disks,
        length: f64,
        paths: Paths,
        each: impl Fn(&str, &T) -> Result<(), RobotError>,
    ) -> Result<(), RobotError> {
        let all = |path: &str, values: &[T]| {
            let mut numbered = values.iter().enumerate();
            numbered.try_for_each(|(i, value)| each(&format!("{path}[{i}]"), value))
        };
        match self {
            Self::Uniform(value) => each(paths.value, value),
            Self::PerDisk(values) => {
                if !disks.are_present {
                    return Err(RobotError::new(paths.value, Problem::ListWithoutDisks));
                }
                if values.len() != disks.count() {
                    let problem = Problem::Count { given: values.len(), expected: disks.count() };
                    return Err(RobotError::new(paths.value, problem));
                }
                all(paths.value, values)
            }
            Self::At { arc_lengths, values } => {
                check_places(arc_lengths, length, paths.places)?;
                let (given, expected) = (values.len(), arc_lengths.len());
                if given != expected {
                    let problem = Problem::CountOfPlaces { given, expected };
                    return Err(RobotError::new(paths.values, problem));
                }
                all(paths.values, values)
            }
        }
    }
}

fn check_places(places: &[f64], length: f64, path: &str) -> Result<(), RobotError> {
    if places.is_empty() {
        return Err(RobotError::new(path, Problem::TooFew { given: 0, least: 1 }));
    }
    for (i, &value) in places.iter().enumerate() {
        let path = format!("{path}[{i}]");
        check_on_backbone(&path, value, length)?;
        let Some(&previous) = i.checked_sub(1).and_then(|k| places.get(k)) else { continue };
        let third = i >= 2 && places[i - 2] == value;
        if value < previous || third {
            return Err(RobotError::new(path, Problem::NotIncreasing { value, previous }));
        }
        let least = LEAST_DISTANCE * length;
        if value != previous && value - previous < least {
            let problem = Problem::TooClose { pitch: value - previous, least };
            return Err(RobotError::new(path, problem));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disks() -> Disks {
        Disks::equally_spaced(1.0, 3, 0.1)
    }

    #[test]
    fn it_is_linear_between_its_places_and_constant_beyond() {
        let along = Along::At { arc_lengths: vec![0.25, 0.5, 0.5], values: vec![1.0, 3.0, 7.0] };
        let at = |s| along.at(&disks(), s);
        assert_eq!([0.0, 0.25, 0.375, 0.5, 0.9, 1.0].map(at), [1.0, 1.0, 2.0, 7.0, 7.0, 7.0]);
        assert_eq!(along.at_end(&disks(), 0.5, 0.3), 3.0);
        assert_eq!(along.at_end(&disks(), 0.5, 0.6), 7.0);
        assert_eq!(along.at_end(&disks(), 0.25, 0.1), 1.0);
    }

    #[test]
    fn what_is_given_at_the_disks_stays_when_they_change() {
        let along = Along::PerDisk(vec![[1.0, 2.0], [3.0, 6.0], [5.0, 0.0]]);
        let apart = along.apart_from(&disks());
        for s in [0.0, 0.2, 0.5, 0.6, 1.0] {
            let (a, b) = (along.at(&disks(), s), apart.at(&disks(), s));
            assert!((a[0] - b[0]).abs() < 1e-15 && (a[1] - b[1]).abs() < 1e-15);
        }
        assert_eq!(along.at(&disks(), 0.25), [2.0, 4.0]);
    }
}
