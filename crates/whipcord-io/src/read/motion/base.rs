//! `[motion.base]`: how the base moves.

use whipcord::{Pose, UnitQuaternion};
use whipcord_inverse::Target;
use whipcord_motion::{BaseMotion, Course};

use super::{Reader, command};
use crate::check::{Data, Fields};
use crate::read::goal;
use crate::schema::EITHER_WAY;
use crate::source::Sources;
use crate::units::Dimension;

/// Reads the table, for a base that is turned like this at the start; `None` for a base that is not led, and where something is refused.
pub(super) fn base(
    table: &Fields,
    rotation: UnitQuaternion,
    sources: &mut Sources,
    reader: &mut Reader<'_>,
) -> Option<BaseMotion> {
    if table.flag("free") {
        return None;
    }
    let Some(named) = table.text("csv") else {
        let velocity = courses(table, "velocity", Dimension::Speed, reader)?;
        let angular_velocity = courses(table, "angular_velocity", Dimension::AngularRate, reader)?;
        return Some(BaseMotion { velocity, angular_velocity });
    };
    let span = reader.document.locate("motion.base.csv").span;
    let file = sources.resolve(span.file, named);
    let points = goal::path(&file, Some(span), sources, reader.problems)?;
    let pose = |target: &Target| match target {
        Target::Pose(pose) => *pose,
        Target::Tip(position) => Pose { position: *position, rotation },
        // A table of points has no other targets.
        _ => Pose::IDENTITY,
    };
    let rows: Vec<(f64, Pose)> =
        points.iter().map(|point| (point.time, pose(&point.target))).collect();
    match BaseMotion::through(&rows) {
        Ok(base) => Some(base),
        Err(error) => {
            reader.tell("motion.base.csv", error.to_string(), "mend that row of the table");
            None
        }
    }
}

/// The three components of a velocity, zero where it is not given.
fn courses(
    table: &Fields,
    key: &str,
    plain: Dimension,
    reader: &mut Reader<'_>,
) -> Option<[Course; 3]> {
    let Some(given) = table.list(key) else { return Some([0.0; 3].map(Course::constant)) };
    let course = |(i, data): (usize, &Data)| {
        let path = format!("motion.base.{key}[{i}]");
        match data {
            Data::List(rows) => command::course(rows, &path, plain, &|_| EITHER_WAY, reader)
                .map(|(course, _)| course),
            _ => {
                let value = data.as_number()?;
                reader.within(value, EITHER_WAY, &path).then(|| Course::constant(value))
            }
        }
    };
    let courses: Vec<Option<Course>> = given.iter().enumerate().map(course).collect();
    courses.into_iter().collect::<Option<Vec<Course>>>()?.try_into().ok()
}
