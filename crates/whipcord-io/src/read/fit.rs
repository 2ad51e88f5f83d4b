use whipcord_estimation::identification::{Prior, Quantity, Unknown};

use crate::check::Fields;
use crate::error::{FileProblem, Problems};
use crate::node::Node;
use crate::suggest;

/// `[fit]`: what is not known of the robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fit {
    /// What is estimated, once for all files that are fitted together.
    pub shared: Vec<Unknown>,
    /// What is estimated for each file by itself.
    pub each: Vec<Unknown>,
}

impl Fit {
    /// What several files that are fitted together estimate, each of them once: what is shared by any of them,
    /// and what each has for itself.
    #[must_use]
    pub fn together(files: &[Option<&Self>]) -> Vec<Unknown> {
        let mut unknowns = Vec::new();
        for fit in files.iter().flatten() {
            fit.shared.iter().cloned().for_each(|unknown| add(&mut unknowns, unknown));
        }
        for (e, fit) in files.iter().enumerate().filter_map(|(e, fit)| Some((e, (*fit)?))) {
            for unknown in &fit.each {
                add(&mut unknowns, Unknown { experiment: Some(e), ..unknown.clone() });
            }
        }
        unknowns
    }

    /// What so many files estimate that all have this table.
    #[must_use]
    pub fn of_all(&self, files: usize) -> Vec<Unknown> {
        Self::together(&vec![Some(self); files])
    }

    /// A quantity, with what the first of the files that knows of it says.
    #[must_use]
    pub fn known(files: &[Option<&Self>], quantity: Quantity) -> Unknown {
        let mut all = files.iter().flatten().flat_map(|fit| fit.shared.iter().chain(&fit.each));
        let own = all.find(|unknown| unknown.quantity == quantity);
        own.cloned().unwrap_or_else(|| Unknown::new(quantity))
    }
}

fn add(unknowns: &mut Vec<Unknown>, unknown: Unknown) {
    let same = |other: &Unknown| {
        (other.quantity, other.experiment) == (unknown.quantity, unknown.experiment)
    };
    if !unknowns.iter().any(same) {
        unknowns.push(unknown);
    }
}

/// The quantity of a path, or the path that is most like it.
///
/// # Errors
/// The nearest path, if one is near.
pub fn quantity(path: &str) -> Result<Quantity, Option<&'static str>> {
    path.parse().map_err(|_| suggest::nearest(path, Quantity::PATHS))
}

/// Reads the table; what it names that cannot be estimated goes to `problems`.
pub(crate) fn fit(fields: &Fields, document: &Node, problems: &mut Problems) -> Fit {
    let mut unknowns = |key: &str| -> Vec<Unknown> {
        let Some(list) = fields.list(key) else { return Vec::new() };
        let found = list.iter().enumerate().filter_map(|(i, item)| {
            let path = item.as_text()?;
            let place = format!("fit.{key}[{i}]");
            named(path, &place, document, problems).map(Unknown::new)
        });
        found.collect()
    };
    let mut fit = Fit { shared: unknowns("parameters"), each: unknowns("each") };
    for (i, known) in fields.tables("known").iter().enumerate() {
        let Some(path) = known.text("parameter") else { continue };
        let place = format!("fit.known[{i}].parameter");
        let Some(quantity) = named(path, &place, document, problems) else { continue };
        let all = fit.shared.iter_mut().chain(&mut fit.each);
        let mut of = all.filter(|unknown| unknown.quantity == quantity).peekable();
        if of.peek().is_none() {
            let span = document.locate(&place).span;
            problems.push(span, || FileProblem::NotEstimated { path: path.to_owned() });
        }
        for unknown in of {
            unknown.start = known.number("start");
            unknown.bounds = [
                known.number("least").unwrap_or(f64::NEG_INFINITY),
                known.number("greatest").unwrap_or(f64::INFINITY),
            ];
            unknown.prior = known
                .number("value")
                .zip(known.number("deviation"))
                .map(|(mean, deviation)| Prior { mean, deviation });
        }
    }
    fit
}

fn named(path: &str, place: &str, document: &Node, problems: &mut Problems) -> Option<Quantity> {
    match quantity(path) {
        Ok(quantity) => Some(quantity),
        Err(near) => {
            let span = document.locate(place).span;
            let path = path.to_owned();
            problems.push(span, || FileProblem::UnknownQuantity { path, near });
            None
        }
    }
}
