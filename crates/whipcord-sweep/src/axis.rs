//! What varies in a sweep: a key of the robot file and its values.

use core::fmt;
use core::str::FromStr;

use whipcord_io::split_quantity;

/// A key of the robot file that varies, such as `cables.a.tension=0 N:20 N:41`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The path of the key, as `--set` has it.
    pub path: String,
    /// The unit of its values as it is written; empty where they have none.
    pub unit: String,
    /// Its values, in that unit.
    pub values: AxisValues,
}

/// The values of an [`Axis`].
#[derive(Clone, Debug, PartialEq)]
pub enum AxisValues {
    /// From the first to the last of equally spaced values; `count` is needed by a grid alone.
    Range {
        /// First value.
        first: f64,
        /// Last value.
        last: f64,
        /// How many a grid has of them.
        count: Option<usize>,
    },
    /// These values.
    List(Vec<f64>),
    /// Those of the rows of a table.
    OfTable,
}

/// Why a text is no axis.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AxisError {
    /// There is no `=`, or nothing before it.
    #[error(
        "`{0}` has no path and values: write PATH=FIRST:LAST:COUNT, such as cables.a.tension=\"0 N:20 N:41\", or PATH=VALUE,VALUE,…"
    )]
    NoValues(String),
    /// A value is no number with a unit.
    #[error("`{value}` of `{path}` is no number with a unit: write, for example, 20 N")]
    NoNumber {
        /// Path of the axis.
        path: String,
        /// The text.
        value: String,
    },
    /// Values have different units.
    #[error("the values of `{path}` are in {first} and in {second}: give all of them in one unit")]
    Units {
        /// Path of the axis.
        path: String,
        /// One unit.
        first: String,
        /// Another one.
        second: String,
    },
    /// The number of values of a range is none.
    #[error(
        "`{count}` is no number of values of `{path}`: give a whole number from 2, or from 1 where first and last value are the same"
    )]
    Count {
        /// Path of the axis.
        path: String,
        /// The text.
        count: String,
    },
}

impl Axis {
    /// A grid's number of values; `None` of a range that does not give one.
    #[must_use]
    pub fn count(&self) -> Option<usize> {
        match &self.values {
            AxisValues::Range { count, .. } => *count,
            AxisValues::List(values) => Some(values.len()),
            AxisValues::OfTable => None,
        }
    }

    /// Whether it has values of its own.
    pub(crate) fn has_values(&self) -> bool {
        match &self.values {
            AxisValues::Range { .. } => true,
            AxisValues::List(values) => !values.is_empty(),
            AxisValues::OfTable => false,
        }
    }

    /// The value at a place of a grid.
    pub(crate) fn at(&self, place: usize) -> f64 {
        match &self.values {
            AxisValues::Range { first, last, count } => {
                let steps = count.unwrap_or(1).saturating_sub(1);
                match place {
                    0 => *first,
                    // The last value exactly, not what rounding makes of it.
                    _ if place >= steps => *last,
                    #[expect(clippy::cast_precision_loss, reason = "far below 2⁵³ values")]
                    _ => first + (last - first) * (place as f64 / steps as f64),
                }
            }
            AxisValues::List(values) => values[place],
            AxisValues::OfTable => f64::NAN,
        }
    }

    /// The value of a part of the range in 0 … 1; of a list, each value has a part of the same size.
    pub(crate) fn part(&self, part: f64) -> f64 {
        match &self.values {
            AxisValues::Range { first, last, .. } => first + (last - first) * part,
            AxisValues::List(values) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    clippy::cast_precision_loss,
                    reason = "a part in 0 … 1 of a list that fits into memory"
                )]
                let place = (part * values.len() as f64) as usize;
                values[place.min(values.len() - 1)]
            }
            AxisValues::OfTable => f64::NAN,
        }
    }

    /// What `--set` gets for a value.
    pub(crate) fn setting(&self, value: f64) -> String {
        /// Up to this all whole numbers are exact.
        const EXACT: f64 = 9e15;
        match self.unit.as_str() {
            // Keys that take whole numbers take them without a decimal point, and others take them so, too.
            "" if value.fract() == 0.0 && value.abs() < EXACT => {
                format!("{}={value:.0}", self.path)
            }
            "" => format!("{}={value:?}", self.path),
            unit => format!("{}={value:?} {unit}", self.path),
        }
    }

    /// The name of its column.
    #[must_use]
    pub fn column(&self) -> String {
        match self.unit.as_str() {
            "" => self.path.clone(),
            unit => format!("{} [{unit}]", self.path),
        }
    }
}

impl FromStr for Axis {
    type Err = AxisError;

    fn from_str(text: &str) -> Result<Self, AxisError> {
        let none = || AxisError::NoValues(text.to_owned());
        let (path, values) = text.split_once('=').ok_or_else(none)?;
        let (path, values) = (path.trim(), values.trim().trim_matches('"'));
        if path.is_empty() || values.is_empty() {
            return Err(none());
        }
        let mut unit = String::new();
        let mut number = |text: &str| {
            let found = split_quantity(text).filter(|(number, _)| number.is_finite());
            let (number, own) = found.ok_or_else(|| AxisError::NoNumber {
                path: path.to_owned(),
                value: text.trim().to_owned(),
            })?;
            // Zero needs no unit.
            match (unit.as_str(), own) {
                ("", own) => own.clone_into(&mut unit),
                (known, own) if own == known || (own.is_empty() && number == 0.0) => {}
                (known, own) => {
                    let second = if own.is_empty() { "no unit" } else { own };
                    return Err(AxisError::Units {
                        path: path.to_owned(),
                        first: known.to_owned(),
                        second: second.to_owned(),
                    });
                }
            }
            Ok(number)
        };
        let values = if values.contains(':') {
            let parts: Vec<&str> = values.split(':').collect();
            let (first, last, count) = match parts[..] {
                [first, last] => (first, last, None),
                [first, last, count] => (first, last, Some(count)),
                _ => return Err(none()),
            };
            let (first, last) = (number(first)?, number(last)?);
            let count = match count {
                None => None,
                Some(count) => {
                    let wrong =
                        || AxisError::Count { path: path.to_owned(), count: count.to_owned() };
                    let found: usize = count.trim().parse().map_err(|_| wrong())?;
                    let least = if first == last { 1 } else { 2 };
                    Some(found).filter(|found| *found >= least).ok_or_else(wrong).map(Some)?
                }
            };
            AxisValues::Range { first, last, count }
        } else {
            AxisValues::List(values.split(',').map(&mut number).collect::<Result<_, _>>()?)
        };
        Ok(Self { path: path.to_owned(), unit, values })
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, unit, values } = self;
        let gap = if unit.is_empty() { "" } else { " " };
        match values {
            AxisValues::OfTable => write!(f, "{}", self.column()),
            AxisValues::Range { first, last, count } => {
                write!(f, "{path}={first:?}{gap}{unit}:{last:?}{gap}{unit}")?;
                count.map_or(Ok(()), |count| write!(f, ":{count}"))
            }
            AxisValues::List(values) => {
                write!(f, "{path}=")?;
                for (place, value) in values.iter().enumerate() {
                    let comma = if place > 0 { "," } else { "" };
                    write!(f, "{comma}{value:?}{gap}{unit}")?;
                }
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(text: &str) -> Axis {
        text.parse().unwrap()
    }

    #[test]
    fn a_range_has_its_ends_exactly() {
        let axis = axis("cables.a.tension=0 N:0.3 N:4");
        assert_eq!((axis.path.as_str(), axis.unit.as_str()), ("cables.a.tension", "N"));
        assert_eq!([axis.at(0), axis.at(3)], [0.0, 0.3]);
        assert!((axis.at(1) - 0.1).abs() < 1e-15);
        assert_eq!(axis.setting(0.1), "cables.a.tension=0.1 N");
        assert_eq!(axis.column(), "cables.a.tension [N]");
        assert_eq!(axis.to_string().parse(), Ok(axis));
    }

    #[test]
    fn a_list_has_its_values_in_parts_of_one_size() {
        let axis = axis("backbone.length=\"100 mm, 120 mm,150 mm\"");
        assert_eq!(axis.count(), Some(3));
        assert_eq!(
            [0.0, 0.34, 0.67, 1.0].map(|part| axis.part(part)),
            [100.0, 120.0, 150.0, 150.0]
        );
        assert_eq!(axis.to_string().parse(), Ok(axis));
    }

    #[test]
    fn zero_needs_no_unit_and_numbers_without_units_stay_so() {
        assert_eq!(axis("a=0:20 N").unit, "N");
        assert_eq!(axis("a=20 N:0").unit, "N");
        assert_eq!(
            axis("backbone.poisson_ratio=0.2:0.4:3").setting(0.2),
            "backbone.poisson_ratio=0.2"
        );
        assert_eq!(axis("disks.count=5,10,20").setting(5.0), "disks.count=5");
    }

    #[test]
    fn what_is_no_axis_says_why() {
        let error = |text: &str| text.parse::<Axis>().unwrap_err();
        assert!(matches!(error("cables.a.tension"), AxisError::NoValues(_)));
        assert!(matches!(error("=1:2"), AxisError::NoValues(_)));
        assert!(matches!(error("a=1 N:2 N:3:4"), AxisError::NoValues(_)));
        assert!(matches!(error("a=1 N:x"), AxisError::NoNumber { .. }));
        assert!(matches!(error("a=1e999 N"), AxisError::NoNumber { .. }));
        assert!(matches!(error("a=1 N:5 mm"), AxisError::Units { .. }));
        for count in ["1", "0", "-3", "2.5", ""] {
            assert!(matches!(error(&format!("a=0 N:1 N:{count}")), AxisError::Count { .. }));
        }
        assert_eq!(axis("a=1 N:1 N:1").count(), Some(1));
    }
}
