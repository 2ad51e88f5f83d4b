//! What is to be estimated as the table `[fit]`.

use whipcord_estimation::identification::Unknown;

use super::{Item, Table};
use crate::read::Fit;

/// The table `[fit]`: read again, it says the same.
#[must_use]
pub fn describe_fit(fit: &Fit) -> Table {
    let mut table = Table::default();
    for (key, unknowns) in [("parameters", &fit.shared), ("each", &fit.each)] {
        let paths: Vec<Item> = unknowns.iter().map(|unknown| Item::Text(unknown.path())).collect();
        if !paths.is_empty() {
            table.insert(key, Item::List(paths));
        }
    }
    let mut known: Vec<Table> = Vec::new();
    for unknown in fit.shared.iter().chain(&fit.each) {
        let Some(entry) = known_of(unknown) else { continue };
        // What is known of a path holds for both lists.
        if !known.contains(&entry) {
            known.push(entry);
        }
    }
    if !known.is_empty() {
        table.insert("known", known);
    }
    table
}

/// What is known of it besides its path; `None` where that is nothing.
fn known_of(unknown: &Unknown) -> Option<Table> {
    let mut entry = Table::default();
    let path = unknown.path();
    entry.insert("parameter", path.as_str());
    let [least, greatest] = unknown.bounds;
    entry.insert_some("start", unknown.start);
    entry.insert_some("least", least.is_finite().then_some(least));
    entry.insert_some("greatest", greatest.is_finite().then_some(greatest));
    entry.insert_some("value", unknown.prior.map(|prior| prior.mean));
    entry.insert_some("deviation", unknown.prior.map(|prior| prior.deviation));
    (entry.entries.len() > 1).then_some(entry)
}

#[cfg(test)]
mod tests {
    use super::super::toml;
    use super::*;
    use crate::parse;

    #[test]
    fn what_is_written_is_read_as_the_same() {
        let robot = "[backbone]\nlength = 0.2\n[disks]\ncount = 3\n";
        let given = "[fit]\nparameters = [\"backbone.diameter\", \"cables.friction\"]\n\
                     each = [\"base.position[0]\", \"backbone.diameter\"]\n\
                     [[fit.known]]\nparameter = \"backbone.diameter\"\nstart = 0.003\nleast = 0.001\n\
                     [[fit.known]]\nparameter = \"base.position[0]\"\nvalue = 0.0\ndeviation = 0.002\n";
        let fit = parse(format!("{robot}{given}").as_str(), "a.toml").unwrap().fit.unwrap();
        let mut file = Table::default();
        file.insert("fit", describe_fit(&fit));
        let again = parse(format!("{robot}{}", toml(&file)).as_str(), "b.toml").unwrap();
        assert_eq!(again.fit.unwrap(), fit);
    }
}
