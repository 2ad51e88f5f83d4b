//! What the models do with routing, number of sections, bending and load, in a suite whose cases say so.

use super::candidate::Candidate;
use super::standing::Standing;
use super::tables::percent;
use super::{CaseBenchmark, LoadKind, Tags};
use crate::quantity::degrees;
use crate::table::{Align, Table};
use crate::timing::duration;

/// Heading and table for each: median errors, and times over the number of sections. None where no case has tags.
pub fn tables(benchmarks: &[CaseBenchmark], candidates: &[Candidate]) -> Vec<(String, Table)> {
    let tagged: Vec<(&CaseBenchmark, Tags)> =
        benchmarks.iter().filter_map(|benchmark| Some((benchmark, benchmark.tags?))).collect();
    if tagged.is_empty() {
        return Vec::new();
    }
    let by = |of: &dyn Fn(&CaseBenchmark, Tags) -> String| {
        let mut groups: Vec<(String, Vec<&CaseBenchmark>)> = Vec::new();
        for &(benchmark, tags) in &tagged {
            let name = of(benchmark, tags);
            match groups.iter_mut().find(|(known, _)| *known == name) {
                Some((_, members)) => members.push(benchmark),
                None => groups.push((name, vec![benchmark])),
            }
        }
        groups
    };
    let sections = by(&|benchmark, _| benchmark.sections.to_string());
    // Not every number of sections is loaded, and loads take their own time.
    let unloaded: Vec<(String, Vec<&CaseBenchmark>)> = sections
        .iter()
        .map(|(name, benchmarks)| {
            let free = |benchmark: &&&CaseBenchmark| {
                benchmark.tags.is_some_and(|tags| tags.load_kind == LoadKind::None)
            };
            (name.clone(), benchmarks.iter().filter(free).copied().collect())
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
        row.extend(groups.iter().map(|(_, benchmarks)| cell(&Standing::of(candidate, benchmarks))));
        table.row(row);
    }
    table
}
