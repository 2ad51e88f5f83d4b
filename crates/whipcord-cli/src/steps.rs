//! The steps of actuation of a case, solved in order.

use std::time::Instant;

use whipcord::{Drive, Model, Solution};
use whipcord_io::CaseFile;

use crate::failure::Failure;
use crate::quantity::{degrees, fixed_millimetres};
use crate::table::{Align, Table};
use crate::words::driven_by;

/// One step of several.
#[derive(Clone, Debug)]
pub struct Step {
    /// What drives the cables, in words.
    pub driver: String,
    /// The answer.
    pub solution: Solution,
    /// Time of this one solve in s.
    pub time: f64,
}

/// Solves all steps of the case, each from where the one before left the robot; none where the case
/// is a single step.
///
/// # Errors
/// [`Failure`] with the number of the step that has no answer.
pub fn solve(model: &Model, file: &CaseFile, drive: Drive) -> Result<Vec<Step>, Failure> {
    if file.case.before.is_empty() {
        return Ok(Vec::new());
    }
    let mut prepared = model
        .prepare(&file.robot, &file.case.loads)
        .map_err(|error| Failure::from_solve(file, &error))?;
    let count = file.case.before.len() + 1;
    let drivers: Vec<String> =
        file.case.steps().map(|case| driven_by(model.kind(), drive, &case)).collect();
    let mut steps: Vec<Step> = Vec::with_capacity(count);
    let mut begun = Instant::now();
    let solved = prepared.solve_steps(&file.case, |solution| {
        let time = begun.elapsed().as_secs_f64();
        let driver = drivers[steps.len()].clone();
        steps.push(Step { driver, solution, time });
        begun = Instant::now();
    });
    solved.map_err(|(step, error)| Failure::from_step(file, &error, step + 1, count))?;
    Ok(steps)
}

/// Where each step takes the tip, in mm.
pub fn table(steps: &[Step]) -> Table {
    let mut table = Table::new([
        ("step", Align::Right),
        ("driven by", Align::Left),
        ("tip x", Align::Right),
        ("y", Align::Right),
        ("z", Align::Right),
        ("bend", Align::Right),
    ]);
    table.group();
    for (i, step) in steps.iter().enumerate() {
        let tip = step.solution.disks.tip();
        let [x, y, z] = tip.position.to_array().map(|c| fixed_millimetres(c, 3));
        let (bend, _) = step.solution.disks.bend();
        table.row(vec![(i + 1).to_string(), step.driver.clone(), x, y, z, degrees(bend)]);
    }
    table
}
