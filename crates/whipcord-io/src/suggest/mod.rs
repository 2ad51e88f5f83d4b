//! What to write instead of a name that there is not.

mod aliases;
mod choices;
mod remedy;

use whipcord::Parameter;
use whipcord_estimation::identification::Quantity;

use crate::node::{Entries, Entry};
use crate::schema::{Kind, ROOT, Table};
use crate::units::listed;

/// Names longer than this resemble nothing.
const LONGEST: usize = 40;

/// The candidate that is a slip of the pen away from `name`.
pub(crate) fn nearest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    if name.len() > LONGEST {
        return None;
    }
    let normal = |name: &str| name.to_lowercase().replace(['-', ' '], "_");
    let lower = normal(name);
    candidates
        .into_iter()
        .filter_map(|candidate| {
            let known = normal(candidate);
            let distance = strsim::damerau_levenshtein(&lower, &known);
            // `radius` for `hole_circle_radius`: a part of the name, left out.
            let part = lower.len() >= 4 && known.contains(&lower);
            let close = distance <= (candidate.len().max(lower.len()) / 3).max(1);
            (close || part).then_some((distance, candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The path of a parameter that is a slip of the pen away from `path`, with the numbers of that: what answers can be
/// differentiated by.
#[must_use]
pub fn nearest_parameter(path: &str) -> Option<String> {
    let (name, numbers) = without_numbers(path);
    let known = Quantity::PATHS.iter().filter(|path| path.parse::<Parameter>().is_ok());
    let known: Vec<String> = known.map(|path| without_numbers(path).0).collect();
    let near = nearest(&name, known.iter().map(String::as_str))?;
    let mut numbers = numbers.into_iter();
    let mut parts = near.split("[]");
    let first = parts.next()?.to_owned();
    Some(parts.fold(first, |path, part| {
        format!("{path}[{}]{part}", numbers.next().unwrap_or_else(|| "0".to_owned()))
    }))
}

/// A path without the numbers in its brackets, and these.
fn without_numbers(path: &str) -> (String, Vec<String>) {
    let mut parts = path.split('[');
    let mut name = parts.next().unwrap_or_default().to_owned();
    let mut numbers = Vec::new();
    for part in parts {
        let (number, rest) = part.split_once(']').unwrap_or((part, ""));
        numbers.push(number.chars().filter(char::is_ascii_digit).collect::<String>());
        name += "[]";
        name += rest;
    }
    numbers.iter_mut().filter(|number| number.is_empty()).for_each(|number| number.push('0'));
    (name, numbers)
}

/// Which of the words that a key takes is meant by another one.
pub(crate) fn for_choice(
    key: &str,
    given: &str,
    choices: &'static [&'static str],
) -> Option<&'static str> {
    choices::word(key, given, choices).or_else(|| nearest(given, choices.iter().copied()))
}

/// The key of `table` that is meant by another name, and what to write instead of that.
pub(crate) fn for_key(
    name: &str,
    entry: &Entry,
    beside: &Entries,
    table: &Table,
) -> (Option<&'static str>, String) {
    if let Some(remedy) = aliases::find(name, table.title)
        && remedy.key().is_none_or(|key| table.key(key).is_some())
    {
        return match remedy.key() {
            // A key of another file is laid over by this one, and so is what is set on the command line.
            Some(key)
                if beside.get(key).is_some_and(|of| of.key_span.file == entry.key_span.file) =>
            {
                (None, format!("remove it: `{key}` is given as well"))
            }
            key => (key, remedy.sentence(entry)),
        };
    }
    if let Some(near) = nearest(name, table.keys.iter().map(|key| key.name)) {
        return (Some(near), format!("did you mean `{near}`?"));
    }
    let mut owners = Vec::new();
    find_owners(name, &ROOT, &mut owners);
    owners.retain(|owner| *owner != table.title);
    let names = listed(table.keys.iter().map(|key| key.name), "and");
    let help = if owners.is_empty() {
        format!("its keys are {names}")
    } else {
        format!("`{name}` belongs in {}", listed(owners, "or"))
    };
    (None, help)
}

/// The key `kind` by another name, where a table has one of those.
pub(crate) fn other_tag(entries: &Entries) -> Option<(&String, &Entry)> {
    ["type", "shape", "form", "geometry"].iter().find_map(|name| entries.get_key_value(*name))
}

/// Titles of the tables that have this key.
fn find_owners(key: &str, table: &Table, owners: &mut Vec<&'static str>) {
    if table.key(key).is_some() {
        owners.push(table.title);
    }
    for key_of_table in table.keys {
        match &key_of_table.kind {
            Kind::Table(inner) | Kind::Tables(inner) => find_owners(key, inner, owners),
            Kind::Variants { variants, .. } | Kind::TablesOfKinds { variants, .. } => {
                variants.iter().for_each(|(_, inner)| find_owners(key, inner, owners));
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_recognised_with_their_numbers() {
        for (given, meant) in [
            ("backbone.diamter", "backbone.diameter"),
            ("young_modulus", "backbone.young_modulus"),
            ("cables[2].routing.raduis", "cables[2].routing.radius"),
            ("loads.tip_force", "loads.tip_force[0]"),
            ("loads.tip_forces[2]", "loads.tip_force[2]"),
            ("tip_moment[x]", "loads.tip_moment[0]"),
        ] {
            assert_eq!(nearest_parameter(given).as_deref(), Some(meant), "{given}");
            assert!(meant.parse::<Parameter>().is_ok());
        }
        assert_eq!(nearest_parameter("colour"), None);
        // What only a fit knows is no parameter.
        assert_eq!(nearest_parameter("cables[0].tension_offset"), None);
    }

    #[test]
    fn slips_of_the_pen_are_recognised() {
        let keys = ["length", "hole_circle_radius", "holes", "count"];
        assert_eq!(nearest("lenght", keys), Some("length"));
        assert_eq!(nearest("Length", keys), Some("length"));
        assert_eq!(nearest("hole-circle-radius", keys), Some("hole_circle_radius"));
        assert_eq!(nearest("radius", keys), Some("hole_circle_radius"));
        assert_eq!(nearest("hole", keys), Some("holes"));
        assert_eq!(nearest("zzz", keys), None);
        assert_eq!(nearest(&"l".repeat(1000), keys), None);
    }
}
