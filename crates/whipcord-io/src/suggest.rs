//! The nearest valid name.

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
    let lower = name.to_lowercase().replace('-', "_");
    candidates
        .into_iter()
        .filter_map(|candidate| {
            let distance = strsim::damerau_levenshtein(&lower, candidate);
            // `radius` for `hole_circle_radius`: a part of the name, left out.
            let part = lower.len() >= 4 && candidate.contains(&lower);
            let close = distance <= (candidate.len().max(lower.len()) / 3).max(1);
            (close || part).then_some((distance, candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// What to write instead of a key that `table` does not have, of whose keys it is `near` to one.
pub(crate) fn for_key(key: &str, near: Option<&str>, table: &Table) -> String {
    if let Some(near) = near {
        return format!("did you mean `{near}`?");
    }
    let mut owners = Vec::new();
    find_owners(key, &ROOT, &mut owners);
    owners.retain(|owner| *owner != table.title);
    let names = listed(table.keys.iter().map(|key| key.name), "and");
    if owners.is_empty() {
        format!("its keys are {names}")
    } else {
        format!("`{key}` belongs in {}", listed(owners, "or"))
    }
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
