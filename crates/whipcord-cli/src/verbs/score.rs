//! `whipcord score`: how far the models are from a table of measurements.

use std::num::NonZero;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use clap::Args;
use whipcord::ModelKind;
use whipcord_io::CaseFile;

use crate::deadline;
use crate::inputs::{Inputs, Settings};
use crate::model_arguments::model_parser;
use crate::progress;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder, plot_failure, unique_names};
use whipcord_study::score::{Answers, Job, Score, Subject, figures, output, report, tables};
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
    let score = of_files(cases.iter().collect(), kinds(&args.models), args.threads)?;
    let folder = Folder::create(&args.out)?;
    let drawn = match args.no_figures {
        true => Vec::new(),
        false => figures::figures(&score).map_err(|error| plot_failure(folder.path(), &error))?,
    };
    for figure in &drawn {
        folder.write(&format!("{}.svg", figure.name), &figure.svg)?;
    }
    let rows = output::rows_csv(&score);
    folder.write_table("score.csv", &output::summary_csv(&score))?;
    folder.write_table("rows.csv", &rows)?;
    folder.write("report.html", &report::html(&score, &drawn, &notes))?;
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
        return rows.to_csv().map_err(|error| files::no_result(&error));
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
pub fn of_files(
    cases: Vec<&CaseFile>,
    models: Vec<ModelKind>,
    threads: Option<NonZero<usize>>,
) -> Result<Score<'_>, Failure> {
    let names = unique_names(cases.iter().map(|case| case.path.as_path()));
    let subjects: Vec<Subject<'_>> = cases.into_iter().map(Subject::new).collect();
    let unmeasured = subjects.iter().filter(|subject| subject.rows.is_empty());
    let unmeasured: Vec<String> = unmeasured
        .map(|subject| {
            format!(
                "error: {}: nothing was measured in space: add [measured] with `table`, a CSV file with the columns x, y and z",
                subject.file.path.display()
            )
        })
        .collect();
    if !unmeasured.is_empty() {
        return Err(Failure::Input(unmeasured.join("\n")));
    }
    let jobs = Job::all(&subjects, &models);
    let answers = solve(&jobs, &subjects, threads);
    if deadline::cancel().is_cancelled() {
        return Err(Failure::Solve("error: not all rows were solved".to_owned()));
    }
    Ok(Score::new(subjects, names, models, &jobs, answers))
}

/// The answers of all jobs in their order, whatever the number of threads.
fn solve(jobs: &[Job], subjects: &[Subject<'_>], threads: Option<NonZero<usize>>) -> Vec<Answers> {
    let (next, cancel) = (AtomicUsize::new(0), deadline::cancel());
    let progress = progress::bar(jobs.len());
    let found: Vec<Mutex<Answers>> = jobs.iter().map(|_| Mutex::default()).collect();
    let work = || {
        while let Some((number, job)) = {
            let number = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(number).map(|job| (number, job))
        } {
            let answers = job.solve(&subjects[job.file], &cancel);
            *found[number].lock().unwrap_or_else(std::sync::PoisonError::into_inner) = answers;
            progress.inc(1);
        }
    };
    let threads = threads.or_else(|| thread::available_parallelism().ok());
    let workers = threads.map_or(1, NonZero::get).min(jobs.len());
    thread::scope(|scope| {
        let handles: Vec<_> = (1..workers).map(|_| scope.spawn(work)).collect();
        work();
        for handle in handles {
            if let Err(panic) = handle.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
    progress.finish_and_clear();
    let answers = found.into_iter();
    answers.map(|of| of.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)).collect()
}
