//! What a fit says: tables, figures, report. Public for the Python package, which says the same.

mod figures;
mod order;
pub(crate) mod remarks;
mod report;
pub mod tables;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use whipcord::{Case, Model, Robot, Vec3, Warning};
use whipcord_estimation::Seen;
use whipcord_estimation::identification::{
    Analyses, Experiment, Identified, Quantity, Row, Unknown, Unstable,
};
use whipcord_estimation::registration::Alignment;
use whipcord_io::{
    AnswerOf, CaseFile, FileWarning, NonFinite, fit_json, status_words, warnings_json,
};

use crate::describe::REVERSED_HELP;
use crate::failure::Failure;
use crate::files::{Folder, no_result, picture, plot_failure, unique_names, write};
use crate::mirrored::{self, mirrored};
use crate::quantity::{millimetres, number};
use crate::remark::Remark;

/// A fit, and what it is of.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model, as it was fitted.
    pub model: Model,
    /// The files.
    pub cases: Vec<CaseFile>,
    /// A name for each.
    pub names: Vec<String>,
    /// What was measured in each.
    pub experiments: Vec<Experiment>,
    /// What was found.
    pub found: Identified,
    /// What is said of it besides.
    pub analyses: Analyses,
    /// Names of the files whose measurements were not fitted.
    pub test_names: Vec<String>,
    /// Of each case whose markers fit far better in opposite order, a warning.
    pub reversed: Vec<Remark>,
    /// Of each file, the warnings about it and about the answers with the estimates.
    pub notices: Vec<Vec<FileWarning>>,
}

impl Fit {
    /// A fit of these files, which give it their names, with what is said of it. `test` are the files of the measurements that
    /// were not fitted, where these are not other steps of the same files.
    #[must_use]
    pub fn new(
        model: &Model,
        cases: Vec<CaseFile>,
        experiments: Vec<Experiment>,
        found: Identified,
        analyses: Analyses,
        test: &[PathBuf],
    ) -> Self {
        let names = unique_names(cases.iter().map(|case| case.path.as_path()));
        let unknowns: Vec<Unknown> = found.estimates.iter().map(|of| of.unknown.clone()).collect();
        let reversed = order::reversed_cases(found.model, &cases, &unknowns)
            .into_iter()
            .map(|message| Remark { code: "reversed-markers", message, help: REVERSED_HELP })
            .collect();
        let warnings = cases
            .iter()
            .zip(&found.cases)
            .map(|(file, case)| warnings(model, file, &found.robot, case));
        let mut notices: Vec<Vec<FileWarning>> = warnings.collect();
        // [`Self::instability`] names all unstable answers of all files in one warning.
        for of in &mut notices {
            of.retain(|notice| !matches!(notice.warning, Warning::Unstable { .. }));
        }
        let model = model.clone();
        let test_names = match test {
            [] => names.clone(),
            paths => unique_names(paths.iter().map(PathBuf::as_path)),
        };
        Self { model, cases, names, experiments, found, analyses, test_names, reversed, notices }
    }

    /// All of it as the JSON object that `whipcord fit --json` prints.
    ///
    /// # Errors
    /// [`NonFinite`] with the place of a number that is not finite.
    pub fn json(&self) -> Result<Value, NonFinite> {
        let Self { found, names, analyses, test_names, .. } = self;
        let mut warnings: Vec<Value> = (self.cases.iter().zip(&self.notices))
            .flat_map(|(file, list)| match warnings_json(file, list) {
                Value::Array(objects) => objects,
                _ => Vec::new(),
            })
            .collect();
        warnings.extend(self.remarks().iter().map(|Remark { code, message, help }| {
            json!({ "code": code, "message": message, "help": help, "place": null })
        }));
        fit_json(found, names, analyses, test_names, warnings)
    }

    /// What a reader should know besides the estimates.
    #[must_use]
    pub fn remarks(&self) -> Vec<Remark> {
        self.reversed.iter().cloned().chain(self.remarks_of_all()).collect()
    }

    /// Those that are about the fit as a whole.
    #[must_use]
    pub fn remarks_of_all(&self) -> Vec<Remark> {
        let suspect = self.analyses.suspects.first();
        let all = [
            self.instability(),
            self.left_out(),
            self.contradicted(),
            self.mirrored(),
            suspect.and_then(|first| remarks::stands_out(first, &self.found.robot)),
            remarks::drifts(&self.analyses),
        ];
        all.into_iter().flatten().collect()
    }

    /// The warning where what was measured in one file fits the answers much better after a reversal of one axis.
    fn mirrored(&self) -> Option<Remark> {
        let of_file = |e: usize| {
            let of = &self.experiments[e];
            let residuals = self.found.residuals.iter().filter(move |of| of.experiment == e);
            let pairs = residuals.filter_map(move |residual| {
                let Seen::Position(seen) = of.observations.get(residual.observation)?.seen else {
                    return None;
                };
                Some([seen, seen + Vec3::from(residual.difference)])
            });
            mirrored(pairs).map(mirrored::remark)
        };
        let aligned = (0..self.experiments.len())
            .filter(|&e| self.experiments[e].alignment == Alignment::Rigid);
        let (file, remark) = aligned.filter_map(|e| Some((e, of_file(e)?))).next()?;
        Some(Remark { message: format!("{}: {}", self.names[file], remark.message), ..remark })
    }

    /// The warning where rows were left out: which, and why.
    fn left_out(&self) -> Option<Remark> {
        const NAMED: usize = 3;
        let skipped = &self.found.skipped;
        let (first, message) = (skipped.first()?, |of: &Row| self.row(*of));
        let named: Vec<String> = skipped
            .iter()
            .take(NAMED)
            .map(|of| format!("{}: {}", message(&of.row), of.reason))
            .collect();
        let more = match skipped.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!("; and {more} more"),
        };
        let rows = match skipped.len() {
            1 => format!(
                "{} is left out: the model has no answer to it: {}",
                self.row(first.row),
                first.reason
            ),
            count => format!(
                "{count} rows are left out, because the model has no answer to them: {}",
                named.join("; ")
            ),
        };
        Some(Remark { code: "skipped-rows", message: rows + &more, help: SKIPPED_HELP })
    }

    /// The warning where the lengths of rows contradict each other: how many rows, and which cable misses its length most.
    fn contradicted(&self) -> Option<Remark> {
        let rows = &self.found.over_determined;
        let all = rows.iter().flat_map(|of| of.misses.iter().map(move |miss| (of.row, miss)));
        let (row, most) = all.max_by(|a, b| a.1.excess.total_cmp(&b.1.excess))?;
        let count = match rows.len() {
            1 => String::from("the cable lengths of 1 row contradict each other and are"),
            count => format!("the cable lengths of {count} rows contradict each other and are"),
        };
        let message = format!(
            "{count} met in the least-squares sense: at most cable `{}` is {} longer than commanded, in {}",
            most.cable,
            millimetres(most.excess),
            self.row(row)
        );
        Some(Remark { code: "over-determined-rows", message, help: CONTRADICTED_HELP })
    }

    /// What a row that was not fitted is called.
    fn test_row(&self, row: Row) -> String {
        let name = self.test_names.get(row.experiment).map_or("", String::as_str);
        format!("{name} step {}", row.step + 1)
    }

    /// What a row is called.
    fn row(&self, row: Row) -> String {
        row_name(&self.names, &self.cases, row)
    }

    /// The warning where measurements are compared with unstable equilibria: how many, and in which cases and steps.
    #[must_use]
    pub fn instability(&self) -> Option<Remark> {
        const NAMED: usize = 5;
        let Identified { answers, unstable, .. } = &self.found;
        let place = |of: &Unstable| {
            let (name, least) = (&self.names[of.experiment], number(of.stability, 3));
            match self.cases[of.experiment].case.before.len() {
                0 => format!("{name} (stability {least})"),
                _ => format!("{name} step {} (stability {least})", of.step + 1),
            }
        };
        let named: Vec<String> = unstable.iter().take(NAMED).map(place).collect();
        let more = match unstable.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let count = match (unstable.len(), *answers) {
            (0, _) => return None,
            (1, 1) => "the answer".to_owned(),
            (all, answers) if all == answers => format!("all {answers} answers"),
            (some, answers) => format!("{some} of the {answers} answers"),
        };
        let what = match unstable.len() {
            1 => "is an unstable equilibrium",
            _ => "are unstable equilibria",
        };
        let message = format!(
            "{count} that the measurements are compared with {what} at the estimates: {}{more}; the real robot leaves such a \
             shape, so the estimates may be wrong",
            named.join(", "),
        );
        Some(Remark { code: "unstable", message, help: UNSTABLE_HELP })
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
    pub fn files(&self) -> Result<Vec<(String, Vec<u8>)>, Failure> {
        let mut files = Vec::new();
        let (estimates, residuals) = (tables::estimates_csv(self), tables::residuals_csv(self));
        for (name, table) in [("estimates.csv", estimates), ("residuals.csv", residuals)] {
            let text = table.to_csv().map_err(|error| no_result(&error))?;
            files.push((name.to_owned(), text.into_bytes()));
        }
        let failed = |e| plot_failure(Path::new("figures"), &e);
        let robots = figures::robots(self).map_err(failed)?;
        let figures = figures::figures(self).map_err(failed)?;
        for figure in robots.iter().chain(&figures) {
            for kind in ["svg", "png"] {
                let name = format!("{}.{kind}", figure.name);
                let bytes = picture(&figure.svg, Path::new(&name))?;
                files.push((name, bytes));
            }
        }
        files.push((REPORT.to_owned(), report::html(self, &robots, &figures).into_bytes()));
        Ok(files)
    }
}

/// What a row of these files is called.
pub(super) fn row_name(names: &[String], cases: &[CaseFile], row: Row) -> String {
    let name = names.get(row.experiment).map_or("", String::as_str);
    match cases.get(row.experiment).map_or(1, |of| of.case.before.len() + 1) {
        1 => name.to_owned(),
        _ => format!("{name} step {}", row.step + 1),
    }
}

const SKIPPED_HELP: &str = "check their commands; cables that cannot all have the lengths of their commands need an `axial_stiffness`, or motors a `stiffness`";
const CONTRADICTED_HELP: &str = "a real robot stretches its cables and drives there: give or estimate an `axial_stiffness`, or the `stiffness` of motors, or check the commands";
const UNSTABLE_HELP: &str = "check the loads, the commands and the start values";

/// Warnings about a file, and about the answers of the robot with the estimates to its case.
fn warnings(model: &Model, file: &CaseFile, robot: &Robot, case: &Case) -> Vec<FileWarning> {
    let mut all = file.warnings();
    let mut answers = Vec::new();
    if let Ok(mut prepared) = model.prepare(robot, &case.loads) {
        // Where a step has no answer, those before it are looked at.
        let _ = prepared.solve_steps(case, |solution| answers.push(solution));
    }
    let step = |n: usize| (!case.before.is_empty()).then_some(n + 1);
    let answers = answers.iter().enumerate();
    all.extend(file.answer_warnings_for(
        robot,
        answers.map(|(n, solution)| (Some(AnswerOf { model: None, step: step(n) }), solution)),
    ));
    all
}

const REPORT: &str = "report.html";

/// Whether the place of this case's base is estimated, or that of its measurement.
fn moves_base(experiment: usize, unknowns: &[Unknown]) -> bool {
    unknowns.iter().any(|unknown| {
        let of_base =
            matches!(unknown.quantity, Quantity::BasePosition { .. } | Quantity::BaseTurn { .. });
        (of_base || unknown.quantity.is_of_frame())
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
