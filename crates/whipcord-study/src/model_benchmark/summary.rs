//! What the models do with routing, number of sections, bending and load, in a suite whose cases say so.

use super::candidate::Candidate;
use super::standing::Standing;
use super::tables::percent;
use super::{CaseBenchmark, LoadKind, Tags};
use crate::quantity::degrees;
use crate::table::{Align, Table};
use crate::timing::duration;

/// Heading and table for each: median errors, and times over the number of sections. None where no case has tags.
pub fn tables(trials: &[CaseBenchmark], candidates: &[Candidate]) -> Vec<(String, Table)> {
    let tagged: Vec<(&CaseBenchmark, Tags)> =
        trials.iter().filter_map(|trial| Some((trial, trial.tags?))).collect();
    if tagged.is_empty() {
        return Vec::new();
    }
    let by = |of: &dyn Fn(&CaseBenchmark, Tags) -> String| {
        let mut groups: Vec<(String, Vec<&CaseBenchmark>)> = Vec::new();
        for &(trial, tags) in &tagged {
            let name = of(trial, tags);
            match groups.iter_mut().find(|(known, _)| *known == name) {
                Some((_, members)) => members.push(trial),
                None => groups.push((name, vec![trial])),
            }
        }
        groups
    };
    let sections = by(&|trial, _| trial.sections.to_string());
    // Not every number of sections is loaded, and loads take their own time.
    let unloaded: Vec<(String, Vec<&CaseBenchmark>)> = sections
        .iter()
        .map(|(name, trials)| {
            let free = |trial: &&&CaseBenchmark| {
                trial.tags.is_some_and(|tags| tags.load_kind == LoadKind::None)
            };
            (name.clone(), trials.iter().filter(free).copied().collect())
        })
        .collect();
    let error = |standing: &Standing| match standing.median_error {
        Some(error) if standing.judged < standing.of => {
            format!("{} ({}/{})", percent(error), standing.judged, standing.of)
        }
        Some(error) => percent(error),
        None => "–".to_owned(),
    };
    let time = |standing: &Standing| standing.time.map_or_else(|| "–".to_owned(), duration);
    vec![
        (
            "Median error, % of the length, by routing".to_owned(),
            table(&by(&|_, tags| tags.routing.to_owned()), candidates, &error),
        ),
        ("Median error, %, by number of sections".to_owned(), table(&sections, candidates, &error)),
        (
            "Median error, %, by bending".to_owned(),
            table(&by(&|_, tags| degrees(tags.bending)), candidates, &error),
        ),
        (
            "Median error, %, by load and obstacle".to_owned(),
            table(&by(&|_, tags| tags.load_kind.name().to_owned()), candidates, &error),
        ),
        (
            "Median time without load, by number of sections".to_owned(),
            table(&unloaded, candidates, &time),
        ),
    ]
}

fn table(
    groups: &[(String, Vec<&CaseBenchmark>)],
    candidates: &[Candidate],
    cell: &dyn Fn(&Standing) -> String,
) -> Table {
    let head = [("model".to_owned(), Align::Left)];
    let names = groups.iter().map(|(name, _)| (name.clone(), Align::Right));
    let mut table = Table::new(head.into_iter().chain(names));
    table.group();
    for &candidate in candidates {
        let mut row = vec![candidate.to_string()];
        row.extend(groups.iter().map(|(_, trials)| cell(&Standing::of(candidate, trials))));
        table.row(row);
    }
    table
}
