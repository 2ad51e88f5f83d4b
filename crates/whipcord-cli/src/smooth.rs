//! Shapes that pictures are smooth with.

use whipcord::{Model, Solution, Stations};
use whipcord_io::CaseFile;
use whipcord_plot::FINE_STATIONS;

/// The same answer at stations that a picture is smooth with; at the disks, where that finds none.
pub fn smooth(model: &Model, file: &CaseFile, solution: &Solution) -> Solution {
    model
        .at(Stations::Equal(FINE_STATIONS))
        .prepare(&file.robot, &file.case.loads)
        .and_then(|mut prepared| prepared.solve(&file.case, Some(solution)))
        .unwrap_or_else(|_| Solution { shape: solution.disks.clone(), ..solution.clone() })
}
