//! Quantities over time.

use crate::error::MotionError;

/// A quantity over time: constant, or given at times and linear between them.
///
/// At a time named twice it jumps from the first value to the second; it is constant before the first time and beyond the last.
///
/// ```
/// use whipcord_motion::Course;
///
/// let step = Course::table(vec![0.5, 0.5], vec![0.0, 4.0])?;
/// assert_eq!([step.before(0.5), step.after(0.5)], [0.0, 4.0]);
/// let ramp = Course::table(vec![0.0, 2.0], vec![0.0, 4.0])?;
/// assert_eq!(ramp.after(0.5), 1.0);
/// # Ok::<(), whipcord_motion::MotionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Course(Kind);

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Constant(f64),
    Table { times: Vec<f64>, values: Vec<f64> },
}

impl Course {
    /// The same at all times.
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self(Kind::Constant(value))
    }

    /// Given at times in s that do not decrease; no time more than twice.
    ///
    /// # Errors
    /// [`MotionError::Course`] where the table is empty, its columns differ in length, a number is not finite or the times are not in order.
    pub fn table(times: Vec<f64>, values: Vec<f64>) -> Result<Self, MotionError> {
        let refuse = |row: usize, problem: &'static str| Err(MotionError::Course { row, problem });
        if times.is_empty() || times.len() != values.len() {
            return refuse(
                times.len().min(values.len()),
                "needs one value for each time, and at least one",
            );
        }
        for row in 0..times.len() {
            if !(times[row].is_finite() && values[row].is_finite()) {
                return refuse(row, "holds a number that is not finite");
            }
            if row > 0 && times[row] < times[row - 1] {
                return refuse(
                    row,
                    "has a time before that of the row above: sort the rows by time",
                );
            }
            if row > 1 && times[row] == times[row - 2] {
                return refuse(
                    row,
                    "has the same time as the two rows above: two rows make a jump, a third has no effect",
                );
            }
        }
        Ok(Self(Kind::Table { times, values }))
    }

    /// The times in s and the values of a table; `None` where it is constant.
    #[must_use]
    pub fn rows(&self) -> Option<(&[f64], &[f64])> {
        match &self.0 {
            Kind::Constant(_) => None,
            Kind::Table { times, values } => Some((times, values)),
        }
    }

    /// The value at a time in s; before the jump where there is one at that time.
    #[must_use]
    pub fn before(&self, time: f64) -> f64 {
        match &self.0 {
            Kind::Constant(value) => *value,
            Kind::Table { times, values } => {
                let next = times.partition_point(|&t| t < time);
                between(times, values, next, time)
            }
        }
    }

    /// The value at a time in s; behind the jump where there is one at that time.
    #[must_use]
    pub fn after(&self, time: f64) -> f64 {
        match &self.0 {
            Kind::Constant(value) => *value,
            Kind::Table { times, values } => {
                let next = times.partition_point(|&t| t <= time);
                between(times, values, next, time)
            }
        }
    }

    /// Its rate of change at a time in s, before any corner or jump at that time.
    pub(crate) fn slope_before(&self, time: f64) -> f64 {
        let Kind::Table { times, values } = &self.0 else { return 0.0 };
        let next = times.partition_point(|&t| t < time);
        if next == 0 || next == times.len() {
            return 0.0;
        }
        (values[next] - values[next - 1]) / (times[next] - times[next - 1])
    }

    /// The first time after `from` and before `to` at which it jumps.
    pub(crate) fn next_jump(&self, from: f64, to: f64) -> Option<f64> {
        let Kind::Table { times, values } = &self.0 else { return None };
        let first = times.partition_point(|&t| t <= from);
        let jumps =
            |row: &usize| times[*row] == times[*row - 1] && values[*row] != values[*row - 1];
        let rows = first + 1..times.partition_point(|&t| t < to);
        rows.into_iter().find(jumps).map(|row| times[row])
    }
}

impl From<f64> for Course {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

/// The value between the row before `next` and that row.
fn between(times: &[f64], values: &[f64], next: usize, time: f64) -> f64 {
    if next == 0 {
        return values[0];
    }
    if next == times.len() {
        return values[next - 1];
    }
    let t = (time - times[next - 1]) / (times[next] - times[next - 1]);
    values[next - 1] + t * (values[next] - values[next - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_linear_and_jumps_at_times_named_twice() {
        let course = Course::table(vec![1.0, 2.0, 2.0, 4.0], vec![0.0, 1.0, 5.0, 3.0]).unwrap();
        assert_eq!([0.0, 1.5, 2.0, 3.0, 9.0].map(|t| course.before(t)), [0.0, 0.5, 1.0, 4.0, 3.0]);
        assert_eq!(course.after(2.0), 5.0);
        assert_eq!(
            [0.5, 1.5, 2.0, 3.0, 9.0].map(|t| course.slope_before(t)),
            [0.0, 1.0, 1.0, -1.0, 0.0]
        );
        assert_eq!(course.rows().map(|(times, _)| times.len()), Some(4));
        assert_eq!(Course::constant(1.0).rows(), None);
        assert_eq!([0.0, 1.0, 1.9].map(|from| course.next_jump(from, 3.0)), [Some(2.0); 3]);
        assert_eq!([course.next_jump(2.0, 3.0), course.next_jump(0.0, 2.0)], [None; 2]);
    }

    #[test]
    fn tables_out_of_order_are_refused() {
        for (times, values) in [
            (vec![], vec![]),
            (vec![0.0], vec![1.0, 2.0]),
            (vec![1.0, 0.0], vec![1.0, 2.0]),
            (vec![0.0, 0.0, 0.0], vec![1.0, 2.0, 3.0]),
            (vec![0.0], vec![f64::NAN]),
        ] {
            assert!(Course::table(times, values).is_err());
        }
    }
}
