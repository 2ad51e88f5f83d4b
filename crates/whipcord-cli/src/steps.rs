//! The steps of actuation of a case in words.

use whipcord::{Case, Drive, Solution};

use crate::quantity::{degrees, fixed_millimetres};
use crate::table::{Align, Table};
use crate::words::driven_by;

/// Where each step takes the tip, in mm.
pub fn table(case: &Case, drive: Drive, steps: &[(Solution, f64)]) -> Table {
    let mut table = Table::new([
        ("step", Align::Right),
        ("driven by", Align::Left),
        ("tip x", Align::Right),
        ("y", Align::Right),
        ("z", Align::Right),
        ("bend", Align::Right),
        ("", Align::Left),
    ]);
    table.group();
    for (i, ((solution, _), step)) in steps.iter().zip(case.steps()).enumerate() {
        let [x, y, z] = solution.disks.tip().position.to_array().map(|c| fixed_millimetres(c, 3));
        let (bend, _) = solution.disks.bend();
        let remark =
            match (solution.diagnostics.is_unstable(), solution.diagnostics.stability_lost_at) {
                (true, _) => "unstable",
                (false, Some(_)) => "snapped through",
                (false, None) => "",
            };
        table.row(vec![
            (i + 1).to_string(),
            driven_by(solution.model, drive, &step),
            x,
            y,
            z,
            degrees(bend),
            remark.to_owned(),
        ]);
    }
    table
}
