//! A part of many rows: for the first steps of a search, which need not be exact and cost as much as the last ones, and for a first look.

use std::collections::BTreeSet;

use super::experiment::Experiment;
use super::rows::{Row, only, rows};

/// So many rows are many.
const MANY: usize = 300;
/// One of so many is in the part.
const PART: usize = 16;

/// The same experiments with what was seen in a part of their rows; none where they have few. Of rows that are independent every 16th is taken,
/// of rows in order the first, since each is solved from those before it.
pub(super) fn fewer_rows(experiments: &[Experiment]) -> Option<Vec<Experiment>> {
    (rows(experiments).len() >= MANY).then(|| part_of_rows(experiments, PART))
}

/// The same experiments with what was seen in one of so many of their rows.
pub(super) fn part_of_rows(experiments: &[Experiment], part: usize) -> Vec<Experiment> {
    let all = rows(experiments);
    let of_experiment = all.chunk_by(|a, b| a.experiment == b.experiment);
    let kept: BTreeSet<Row> = of_experiment
        .flat_map(|rows| {
            let count = rows.len().div_ceil(part);
            let every = if experiments[rows[0].experiment].case.independent { part } else { 1 };
            rows.iter().step_by(every).take(count)
        })
        .copied()
        .collect();
    only(experiments, &kept, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::{Observation, Place, Seen};
    use whipcord::Vec3;
    use whipcord::case::Case;

    fn table(rows: usize, independent: bool) -> Experiment {
        let seen = |step| Observation {
            step,
            place: Place::Disk(1),
            offset: Vec3::ZERO,
            seen: Seen::Position(Vec3::ZERO),
            deviation: None,
        };
        let before = vec![Vec::new(); rows - 1];
        let case = Case { before, independent, ..Case::default() };
        Experiment { case, observations: (0..rows).map(seen).collect(), ..Experiment::default() }
    }

    #[test]
    fn a_part_of_all_tables_is_kept() {
        assert!(fewer_rows(&[table(299, true)]).is_none());
        let kept = fewer_rows(&[table(320, true), table(1, true), table(40, false)]).unwrap();
        let steps: Vec<Vec<usize>> =
            kept.iter().map(|of| of.observations.iter().map(|seen| seen.step).collect()).collect();
        assert_eq!(steps[0], (0..20).map(|k| 16 * k).collect::<Vec<_>>());
        assert_eq!(steps[1..], [vec![0], vec![0, 1, 2]]);
    }
}
