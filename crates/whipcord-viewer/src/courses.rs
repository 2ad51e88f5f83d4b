//! The courses that a file has: its steps, and its motion.

use whipcord_io::CaseFile;

use crate::protocol::{Course, CourseChoice};

/// Shapes of a motion at most: more are too many for the memory of a page.
const MOST: usize = 2000;

/// The courses that a file has.
pub fn choices(file: &CaseFile) -> Vec<CourseChoice> {
    let steps = file.case.before.len();
    let steps = (steps > 0).then_some(CourseChoice {
        course: Course::Steps,
        count: steps + 1,
        duration: None,
    });
    let motion = intervals(file).map(|(every, _, rows)| CourseChoice {
        course: Course::Motion,
        count: rows + 1,
        duration: Some(every * rows as f64),
    });
    steps.into_iter().chain(motion).collect()
}

/// Time between two shapes of the motion, steps from one to the next, and how many there are after the first.
pub fn intervals(file: &CaseFile) -> Option<(f64, usize, usize)> {
    let (every, steps, rows) = file.motion.rows()?;
    let merged = rows.div_ceil(MOST).max(1);
    Some((every * merged as f64, steps * merged, rows / merged))
}
