//! One entry of `[[motion.commands]]`, and rows over time.

use whipcord::robot::limits::{ANGLE, COORDINATE, FRACTION, Range, TENSION};
use whipcord::{Cable, Drive, Motor};
use whipcord_motion::{Course, MotionError};

use super::{CableCourse, Motion, Reader, table};
use crate::check::{Data, Fields};
use crate::node::Value;
use crate::schema::DURATION;
use crate::source::{Sources, quoted};
use crate::units::{Dimension, listed};

/// The cables and motors that have commands.
pub(crate) struct Driven<'a> {
    pub cables: &'a [Cable],
    pub motors: &'a [Motor],
}

/// What a column or an entry commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Told {
    Cable(usize),
    Motor(usize),
}

impl Driven<'_> {
    /// The cable or motor of this name.
    pub(super) fn find(&self, name: &str) -> Option<Told> {
        let cable = self.cables.iter().position(|cable| cable.name == name);
        let motor = || self.motors.iter().position(|motor| motor.name == name);
        cable.map(Told::Cable).or_else(|| motor().map(Told::Motor))
    }

    /// What the commands of a cable or motor may measure.
    pub(super) fn dimensions(&self, told: Told) -> &'static [Dimension] {
        match told {
            Told::Cable(_) => &[Dimension::Force, Dimension::Length, Dimension::Ratio],
            Told::Motor(i) => match self.motors[i].drive {
                Drive::Spool { .. } => &[Dimension::Angle],
                Drive::Linear => &[Dimension::Length],
            },
        }
    }

    /// All names, for a remedy.
    pub(super) fn names(&self) -> String {
        let cables = self.cables.iter().map(|cable| &cable.name);
        let motors = self.motors.iter().map(|motor| &motor.name);
        let names: Vec<String> =
            cables.chain(motors).map(|name| format!("`{}`", quoted(name))).collect();
        listed(names.iter().map(String::as_str), "and")
    }
}

/// The range of a command.
pub(super) const fn range(dimension: Dimension) -> Range {
    match dimension {
        Dimension::Force => TENSION,
        Dimension::Ratio => FRACTION,
        Dimension::Angle => ANGLE,
        _ => COORDINATE,
    }
}

/// Adds what a cable or motor is told; whether it has not been told anything before.
pub(super) fn add(motion: &mut Motion, told: Told, course: Course, dimension: Dimension) -> bool {
    match told {
        Told::Cable(cable) => {
            if motion.cables.iter().any(|(of, _)| *of == cable) {
                return false;
            }
            let course = match dimension {
                Dimension::Force => CableCourse::Tension(course),
                Dimension::Ratio => CableCourse::Fraction(course),
                _ => CableCourse::Shortening(course),
            };
            motion.cables.push((cable, course));
        }
        Told::Motor(motor) => {
            if motion.motors.iter().any(|(of, _)| *of == motor) {
                return false;
            }
            motion.motors.push((motor, course));
        }
    }
    true
}

/// Reads an entry into a motion.
pub(super) fn read(
    entry: &Fields,
    k: usize,
    driven: &Driven<'_>,
    motion: &mut Motion,
    sources: &mut Sources,
    reader: &mut Reader<'_>,
) {
    let path = format!("motion.commands[{k}]");
    if let Some(named) = entry.text("csv") {
        let span = reader.document.locate(&format!("{path}.csv")).span;
        let file = sources.resolve(span.file, named);
        table::read(&file, span, driven, motion, sources, reader.problems);
        return;
    }
    let (what, name, keys) = match (entry.text("cable"), entry.text("motor")) {
        (Some(name), _) => ("cable", name, ["tension", "shortening"]),
        (None, Some(name)) => ("motor", name, ["angle", "travel"]),
        (None, None) => return,
    };
    let told = driven.find(name).filter(|told| matches!(told, Told::Cable(_)) == (what == "cable"));
    let Some(told) = told else {
        let message = format!(
            "there is no {what} `{}`; cables and motors are {}",
            quoted(name),
            driven.names()
        );
        return reader.tell(&format!("{path}.{what}"), message, "give the name of one of them");
    };
    let Some(key) = keys.into_iter().find(|key| entry.data(key).is_some()) else { return };
    if let Told::Motor(i) = told {
        let needed = driven.motors[i].drive.keys().command;
        if key != needed {
            let message = format!("motor `{}` has no `{key}`", quoted(name));
            let help = match needed {
                "angle" => "it turns a spool: give its `angle`",
                _ => "it is linear: give its `travel`",
            };
            return reader.tell(&format!("{path}.{key}"), message, help);
        }
    }
    let key_path = format!("{path}.{key}");
    // What a number without a unit is in SI.
    let plain = match key {
        "tension" => Dimension::Force,
        "angle" => Dimension::Angle,
        _ => Dimension::Length,
    };
    let read = match entry.data(key) {
        Some(Data::List(rows)) => course(rows, &key_path, plain, &range, reader),
        Some(Data::Number(value, dimension)) => reader
            .within(*value, range(*dimension), &key_path)
            .then(|| (Course::constant(*value), *dimension)),
        _ => None,
    };
    let Some((course, dimension)) = read else { return };
    if !add(motion, told, course, dimension) {
        let message = format!("{what} `{}` has two commands over time", quoted(name));
        reader.tell(&path, message, "keep one of the two");
    }
}

/// Rows of time and value, and what the values measure: `plain` where all are numbers without a unit.
pub(super) fn course(
    rows: &[Data],
    path: &str,
    plain: Dimension,
    range: &dyn Fn(Dimension) -> Range,
    reader: &mut Reader<'_>,
) -> Option<(Course, Dimension)> {
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let mut kind = None;
    for (i, row) in rows.iter().enumerate() {
        let [time, value] = row.as_list()? else { return None };
        let ((time, of_time), (value, of_value)) = (time.as_quantity()?, value.as_quantity()?);
        let [time_path, value_path] = [0, 1].map(|k| format!("{path}[{i}][{k}]"));
        let has_unit = |path: &str| matches!(reader.document.locate(path).value, Value::Text(_));
        let (time_has_unit, value_has_unit) = (has_unit(&time_path), has_unit(&value_path));
        // A zero may be a text without a unit.
        if time_has_unit && of_time != Dimension::Time && time != 0.0 {
            let message = "the first number of a row over time must be a time".to_owned();
            reader.tell(&time_path, message, "write the time first, as in [\"0.5 s\", …]");
            return None;
        }
        if value_has_unit && of_value == Dimension::Time && value != 0.0 {
            let message = "the second number of a row over time is a time".to_owned();
            reader.tell(&value_path, message, "write the time first, then the value");
            return None;
        }
        if value_has_unit && of_value != Dimension::Time {
            match kind {
                Some(before) if before != of_value && value != 0.0 => {
                    let message = format!("{before} and {of_value} in one list");
                    let help = "give all values of the list in one way";
                    reader.tell(&value_path, message, help);
                    return None;
                }
                Some(_) => {}
                None => kind = Some(of_value),
            }
        }
        if !reader.within(time, DURATION, &time_path)
            || !reader.within(value, range(kind.unwrap_or(plain)), &value_path)
        {
            return None;
        }
        times.push(time);
        values.push(value);
    }
    // Rows that cannot be read are missing in the list, and reported.
    let is_list =
        matches!(&reader.document.locate(path).value, Value::List(all) if !all.is_empty());
    if rows.is_empty() && is_list {
        return None;
    }
    match Course::table(times, values) {
        Ok(course) => Some((course, kind.unwrap_or(plain))),
        Err(MotionError::Course { row, problem }) => {
            let message = format!("this row {problem}");
            reader.tell(
                &format!("{path}[{row}]"),
                message,
                "put the rows in the order of their times; two rows with the same time are a jump",
            );
            None
        }
        Err(_) => None,
    }
}
