//! Motors that a table of commands in order drives faster than they go.

use whipcord::{Motor, Warning};

use crate::case_file::CaseFile;

/// Rounding of times and commands, as a part of a rate.
const ROUNDING: f64 = 1e-9;

/// Of each motor that must go faster than its limit from one row to the next, the fastest of these rows.
pub(super) fn motor_rates(file: &CaseFile) -> Vec<Warning> {
    let Some(table) = file.commands.as_ref().filter(|_| !file.case.independent) else {
        return Vec::new();
    };
    let of_motor = |(index, motor): (usize, &Motor)| {
        let limit = motor.limits.rate?;
        let told =
            |row: usize| Some((table.rows[row].time?, *file.case.motors.get(row)?.get(index)?));
        let rate = |row: usize| {
            let (before, from) = told(row - 1)?;
            let (time, to) = told(row)?;
            let rate = (to? - from?).abs() / (time - before);
            // Times that stand still or go back are of another motion.
            (time > before && rate > limit * (1.0 + ROUNDING)).then_some((row, rate))
        };
        let too_fast: Vec<(usize, f64)> = (1..table.rows.len()).filter_map(rate).collect();
        let &(row, rate) = too_fast.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Warning::MotorRate {
            index,
            motor: motor.name.clone(),
            row: table.label(row),
            rate,
            limit,
            others: too_fast.len() - 1,
            drive: motor.drive,
        })
    };
    file.robot.motors().iter().enumerate().filter_map(of_motor).collect()
}
