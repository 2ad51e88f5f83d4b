//! The steps of actuation of a case in words.

use whipcord::{Actuation, Case, NoStability, Solution};

use crate::describe::driven_by;
use crate::quantity::{degrees, fixed_millimetres};
use crate::table::{Align, Table};

/// Root mean square distance in m over the disks of two models, without the base disk, and over all steps of a case.
pub fn rms_distance(a: &[Solution], b: &[Solution]) -> f64 {
    match (a, b) {
        ([a], [b]) => a.disks.rms_distance(&b.disks),
        _ => {
            let squares = a.iter().zip(b).map(|(a, b)| a.disks.rms_distance(&b.disks).powi(2));
            let (sum, count) =
                squares.fold((0.0, 0_usize), |(sum, n), square| (sum + square, n + 1));
            if count == 0 { 0.0 } else { (sum / count as f64).sqrt() }
        }
    }
}

/// Whether the answers to all steps are stable: not where one of them is unstable, and `None` where that is not known
/// of one of them.
pub fn all_stable(answers: &[Solution]) -> Option<bool> {
    let verdicts = || answers.iter().map(|answer| answer.diagnostics.stable);
    match verdicts().any(|stable| stable == Some(false)) {
        true => Some(false),
        false => verdicts().all(|stable| stable.is_some()).then_some(true),
    }
}

/// Why the stability of a step is not known, of the first for which it is not.
pub fn stability_absent(answers: &[Solution]) -> Option<NoStability> {
    answers.iter().find_map(|answer| answer.diagnostics.stability_absent)
}

/// Where each step takes the tip, in mm.
pub fn table(case: &Case, actuation: Actuation, steps: &[(Solution, f64)]) -> Table {
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
    for (i, ((solution, _), step)) in steps.iter().zip(case.single_steps()).enumerate() {
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
            driven_by(solution.model, actuation, &step),
            x,
            y,
            z,
            degrees(bend),
            remark.to_owned(),
        ]);
    }
    table
}
