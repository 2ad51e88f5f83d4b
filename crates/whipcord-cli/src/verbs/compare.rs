//! `whipcord compare`: every case with every model that can take it, side by side.

use std::num::NonZero;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use clap::Args;

use crate::comparison::figures::figures;
use crate::comparison::study::Study;
use crate::comparison::{csv, report, tables};
use crate::failure::Failure;
use crate::files::{Folder, unique_names};
use crate::html::Figure;
use crate::inputs::Inputs;
use crate::progress;
use crate::style::Style;

/// Solve every case with every model that can take it and put the answers side by side
///
/// Prints one table, and writes a self-contained HTML report, the figures as SVG and PNG, and every
/// number as CSV.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Robot files, or folders of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Folder for report, figures and CSV
    #[arg(long, value_name = "DIR", default_value = "whipcord-report")]
    out: PathBuf,
}

/// Solves, writes the files, and returns the table.
pub fn run(args: &CompareArgs, style: Style) -> Result<String, Failure> {
    let Inputs { cases, notes: passed_over } = Inputs::read(&args.files)?;
    let stems = unique_names(cases.iter().map(|case| case.path.as_path()));
    let progress = progress::bar(cases.len());
    let studies: Vec<Study> = cases
        .into_iter()
        .zip(stems)
        .map(|(case, stem)| {
            progress.set_message(case.title.clone());
            let study = Study::new(case, stem);
            progress.inc(1);
            study
        })
        .collect();
    progress.finish_and_clear();

    let unsolved = unsolved(&studies);
    if studies.iter().all(|study| study.reference().is_none()) {
        return Err(Failure::Solve(unsolved.trim_end().to_owned()));
    }

    let folder = Folder::create(&args.out)?;
    let figures = write_figures(&folder, &studies)?;
    for study in studies.iter().filter(|study| study.reference().is_some()) {
        let stem = &study.stem;
        folder.write_table(&format!("{stem}-disks.csv"), &csv::disks(study))?;
        folder.write_table(&format!("{stem}-stations.csv"), &csv::stations(study))?;
        if let Some(cables) = csv::cables(study) {
            folder.write_table(&format!("{stem}-cables.csv"), &cables)?;
        }
    }
    folder.write_table("cases.csv", &csv::summary(&studies))?;
    if let Some(distances) = csv::distances(&studies) {
        folder.write_table("distances.csv", &distances)?;
    }
    if let Some(reference) = csv::reference(&studies) {
        folder.write_table("reference.csv", &reference)?;
    }
    folder.write("report.html", &report::html(&studies, &figures, &passed_over))?;

    if !unsolved.is_empty() {
        return Err(Failure::Solve(format!(
            "{unsolved}What the other cases gave is in {}",
            folder.path().join("report.html").display()
        )));
    }
    let mut text = tables::summary(&studies).text(style) + "\n";
    for note in tables::notes(&studies).iter().chain(&passed_over) {
        text += &format!("{note}\n");
    }
    text += &format!("Report: {}\n", folder.path().join("report.html").display());
    Ok(text)
}

/// What the models say of the cases that none of them can solve.
fn unsolved(studies: &[Study]) -> String {
    let mut message = String::new();
    for study in studies.iter().filter(|study| study.reference().is_none()) {
        message += &format!("error: {}: no model has an answer\n", study.file.path.display());
        for run in &study.runs {
            if let Err(error) = &run.outcome {
                message += &format!("  {}: {error}\n", run.label());
            }
        }
    }
    message
}

/// Draws and writes the figures of all cases, as many at a time as there are processors.
fn write_figures(folder: &Folder, studies: &[Study]) -> Result<Vec<Vec<Figure>>, Failure> {
    let mut all = Vec::with_capacity(studies.len());
    for study in studies {
        all.push(figures(study)?);
    }
    let jobs: Vec<(String, &Figure)> = all
        .iter()
        .zip(studies)
        .flat_map(|(figures, study)| {
            figures.iter().map(|figure| (format!("{}-{}", study.stem, figure.name), figure))
        })
        .collect();
    let next = AtomicUsize::new(0);
    let work = || -> Result<(), Failure> {
        while let Some((name, figure)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            folder.write_figure(name, &figure.svg)?;
        }
        Ok(())
    };
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(jobs.len());
    thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        for handle in handles {
            match handle.join() {
                Ok(result) => result?,
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok(())
    })?;
    Ok(all)
}
