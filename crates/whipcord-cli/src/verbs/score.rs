//! `whipcord score`: how far the models are from a table of measurements.

use std::num::NonZero;
use std::path::PathBuf;

use clap::Args;
use whipcord::ModelKind;
use whipcord_io::CaseFile;

use crate::deadline;
use crate::inputs::{Inputs, Settings};
use crate::model_arguments::model_parser;
use crate::progress;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::score::{KnownRows, Score, Solved, output, tables};
use whipcord_study::style::Style;

/// Score models against measurements, without a fit
///
/// Solves every measured row of every file by every model, and prints the root mean square, median, 95th percentile
/// and worst error, with the row of the worst, and why rows have no answer. Writes a self-contained HTML report with
/// pictures, and all numbers as CSV.
#[derive(Debug, Args)]
pub struct ScoreArgs {
    /// Robot files with [measured], or folders of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    /// Models; all of them by default
    #[arg(long = "model", value_name = "NAME", value_parser = model_parser())]
    models: Vec<ModelKind>,
    /// Leave out the pictures
    #[arg(long)]
    no_figures: bool,
    /// Print one JSON object
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// With --json: every row of every file too
    #[arg(long, requires = "json")]
    rows: bool,
    /// Print every row of every file as CSV
    #[arg(long)]
    csv: bool,
    /// Threads that solve; as many as there are processors by default. The results are the same for any number
    #[arg(long, value_name = "N")]
    threads: Option<NonZero<usize>>,
    /// Folder for the report, the figures and the CSV files
    #[arg(long, value_name = "DIR", default_value = "whipcord-score")]
    out: PathBuf,
}

/// Solves, writes the files, and returns what standard output shows.
pub fn run(args: &ScoreArgs, style: Style) -> Result<String, Failure> {
    let Inputs { cases, notes } = Inputs::read(&args.files, &args.settings)?;
    let score = of_files(cases.iter().collect(), kinds(&args.models), args.threads, &|_, _| None)?;
    let folder = Folder::create(&args.out)?;
    score.write(&folder, !args.no_figures, &notes)?;
    if score.best().is_none() {
        let mut message = String::from("error: no row has an answer that can be compared\n");
        for note in tables::notes(&score).iter().skip(1) {
            message += &format!("  {note}\n");
        }
        return Err(Failure::Solve(message.trim_end().to_owned()));
    }
    if args.json {
        return Ok(format!("{:#}\n", output::json(&score, args.rows)));
    }
    if args.csv {
        return output::rows_csv(&score).to_csv().map_err(|error| files::no_result(&error));
    }
    Ok(format!(
        "{}Report: {}\n",
        text(&score, &notes, style),
        folder.path().join("report.html").display()
    ))
}

/// The tables and notes of a score.
pub fn text(score: &Score<'_>, passed_over: &[String], style: Style) -> String {
    let mut text = tables::summary(score).text(style) + "\n";
    if let Some(files) = tables::files(score) {
        text += &(files.text(style) + "\n");
    }
    for note in tables::notes(score).iter().chain(passed_over) {
        text += &format!("{note}\n");
    }
    text
}

/// The models that are asked for, or all.
pub fn kinds(models: &[ModelKind]) -> Vec<ModelKind> {
    let wanted = |kind: &ModelKind| models.is_empty() || models.contains(kind);
    ModelKind::ALL.into_iter().filter(wanted).collect()
}

/// The score of these files.
///
/// # Errors
/// [`Failure`] for files without measurements in space, or where the time is over.
pub fn of_files<'a>(
    cases: Vec<&'a CaseFile>,
    models: Vec<ModelKind>,
    threads: Option<NonZero<usize>>,
    known: &KnownRows<'_>,
) -> Result<Score<'a>, Failure> {
    let bar = progress::bar(0);
    let tell = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let cancel = deadline::cancel();
    let solved = Solved::with_known(&cases, models, threads, &cancel, (&tell, known));
    bar.finish_and_clear();
    Ok(solved?.score(&cases))
}
