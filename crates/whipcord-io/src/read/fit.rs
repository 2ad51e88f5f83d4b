use whipcord_estimation::identification::{ParameterPath, Parts, Prior, Quantity, Unknown};

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

    /// An unknown, with what the first of the files that knows of it says.
    #[must_use]
    pub fn known(files: &[Option<&Self>], unknown: Unknown) -> Unknown {
        let mut all = files.iter().flatten().flat_map(|fit| fit.shared.iter().chain(&fit.each));
        let own = all.find(|known| known.is_same(&unknown));
        own.cloned().unwrap_or(unknown)
    }
}

fn add(unknowns: &mut Vec<Unknown>, unknown: Unknown) {
    if !unknowns.iter().any(|other| other.is_same(&unknown)) {
        unknowns.push(unknown);
    }
}

/// What a path names, or the path that is most like it.
///
/// # Errors
/// The nearest path, if one is near.
pub fn parameter_path(path: &str) -> Result<ParameterPath, Option<&'static str>> {
    path.parse().map_err(|_| suggest::nearest(path, Quantity::PATHS))
}

/// Reads the table, of a robot with these parts; what it names that cannot be estimated goes to `problems`.
pub(crate) fn fit(
    fields: &Fields,
    robot: Parts<'_>,
    document: &Node,
    problems: &mut Problems,
) -> Fit {
    let mut unknowns = |key: &str| -> Vec<Unknown> {
        let Some(list) = fields.list(key) else { return Vec::new() };
        let found = list.iter().enumerate().filter_map(|(i, item)| {
            let path = item.as_text()?;
            named(path, &format!("fit.{key}[{i}]"), robot, document, problems)
        });
        found.collect()
    };
    let mut fit = Fit { shared: unknowns("parameters"), each: unknowns("each") };
    for (i, known) in fields.tables("known").iter().enumerate() {
        let Some(path) = known.text("parameter") else { continue };
        let place = format!("fit.known[{i}].parameter");
        let Some(meant) = named(path, &place, robot, document, problems) else { continue };
        let all = fit.shared.iter_mut().chain(&mut fit.each);
        let mut of = all.filter(|unknown| unknown.is_same(&meant)).peekable();
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

fn named(
    path: &str,
    place: &str,
    robot: Parts<'_>,
    document: &Node,
    problems: &mut Problems,
) -> Option<Unknown> {
    let span = || document.locate(place).span;
    match parameter_path(path) {
        Ok(named) => match named.unknown(robot) {
            Ok(unknown) => Some(unknown),
            Err(error) => {
                problems.push(span(), || FileProblem::UnknownGroup(error));
                None
            }
        },
        Err(near) => {
            let path = path.to_owned();
            problems.push(span(), || FileProblem::UnknownQuantity { path, near });
            None
        }
    }
}
