//! What a fit says: tables, figures, report. Public for the Python package, which says the same.

mod figures;
mod order;
mod report;
pub(crate) mod tables;

use std::path::{Path, PathBuf};

use serde_json::Value;
use whipcord::identification::{Compared, Experiment, Identified, Quantity, Unknown, Validated};
use whipcord::registration::Alignment;
use whipcord_io::{CaseFile, NonFinite, fit_json, status_words};

use crate::failure::Failure;
use crate::files::{Folder, no_result, picture, plot_failure, unique_names, write};

/// A fit, and what it is of.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The files.
    pub cases: Vec<CaseFile>,
    /// A name for each.
    pub names: Vec<String>,
    /// What was measured in each.
    pub experiments: Vec<Experiment>,
    /// What was found.
    pub found: Identified,
    /// How far off it is where it was held out, where that was asked for.
    pub validated: Option<Validated>,
    /// What is said of cases whose markers fit far better in opposite order.
    pub reversed: Vec<String>,
    /// The fits of all models, where that was asked for.
    pub compared: Vec<Compared>,
}

impl Fit {
    /// A fit of these files, which give it their names.
    #[must_use]
    pub fn new(
        cases: Vec<CaseFile>,
        experiments: Vec<Experiment>,
        found: Identified,
        validated: Option<Validated>,
        compared: Vec<Compared>,
    ) -> Self {
        let names = unique_names(cases.iter().map(|case| case.path.as_path()));
        let unknowns: Vec<Unknown> = found.estimates.iter().map(|of| of.unknown.clone()).collect();
        let reversed = order::reversed_cases(found.model, &cases, &unknowns);
        Self { cases, names, experiments, found, validated, reversed, compared }
    }

    /// All of it as the JSON object that `whipcord fit --json` prints.
    ///
    /// # Errors
    /// [`NonFinite`] with the place of a number that is not finite.
    pub fn json(&self) -> Result<Value, NonFinite> {
        let Self { found, names, validated, compared, reversed, .. } = self;
        fit_json(found, names, validated.as_ref(), compared, reversed)
    }

    /// Writes report, figures and CSV to a folder, and returns the path of the report.
    ///
    /// # Errors
    /// Why one of them cannot be drawn or written.
    pub fn write_report(&self, folder: &Path) -> Result<PathBuf, String> {
        let written = || {
            let files = self.files()?;
            Folder::create(folder)?;
            files.into_iter().try_for_each(|(name, bytes)| write(&folder.join(name), &bytes))
        };
        written().map_err(|failure: Failure| failure.to_string())?;
        Ok(folder.join(REPORT))
    }

    /// Report, figures and CSV: their names and what is in them.
    pub(crate) fn files(&self) -> Result<Vec<(String, Vec<u8>)>, Failure> {
        let mut files = Vec::new();
        let (estimates, residuals) = (tables::estimates_csv(self), tables::residuals_csv(self));
        for (name, table) in [("estimates.csv", estimates), ("residuals.csv", residuals)] {
            let text = table.to_csv().map_err(|error| no_result(&error))?;
            files.push((name.to_owned(), text.into_bytes()));
        }
        let figures = figures::figures(self).map_err(|e| plot_failure(Path::new("figures"), &e))?;
        for figure in &figures {
            for kind in ["svg", "png"] {
                let name = format!("{}.{kind}", figure.name);
                let bytes = picture(&figure.svg, Path::new(&name))?;
                files.push((name, bytes));
            }
        }
        files.push((REPORT.to_owned(), report::html(self, &figures).into_bytes()));
        Ok(files)
    }
}

const REPORT: &str = "report.html";

/// Whether a measurement of this case is in a frame of its own, from which it asks to be moved, and the place of the
/// base is not estimated: that is what a fit has in place of the motion.
#[must_use]
pub fn moves_unasked(alignment: Alignment, experiment: usize, unknowns: &[Unknown]) -> bool {
    alignment != Alignment::None && !moves_base(experiment, unknowns)
}

/// Whether the place of this case's base is estimated.
fn moves_base(experiment: usize, unknowns: &[Unknown]) -> bool {
    unknowns.iter().any(|unknown| {
        matches!(unknown.quantity, Quantity::BasePosition { .. } | Quantity::BaseTurn { .. })
            && unknown.experiment.is_none_or(|only| only == experiment)
    })
}

/// Why a fit that has not converged is none; `names` are those of the cases.
#[must_use]
pub fn not_converged(names: &[String], found: &Identified) -> String {
    let why = match &found.refusal {
        Some(answer) => format!(
            "; the last step was shortened because {} has no answer: {}",
            names[answer.experiment], answer.reason
        ),
        None => String::new(),
    };
    let unresolved: String =
        found.unresolved.iter().map(|unresolved| format!("\n  {unresolved}")).collect();
    format!(
        "the fit has not converged ({} after {} steps){why}; start nearer, give bounds, or estimate less{unresolved}",
        status_words(found.status),
        found.iterations
    )
}
