//! `whipcord compare`: every case with every model that can take it, side by side, and which to use for what.

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde_json::Value;
use whipcord::ModelKind;
use whipcord::jobs::share;
use whipcord_io::{CaseFile, contacts_csv, warnings_json};

use crate::deadline;
use crate::inputs::{Inputs, Settings};
use crate::model_arguments::model_parser;
use crate::progress;
use crate::verbs::score;
use crate::warnings::Warnings;
use whipcord_study::comparison::figures::{figures, multiples};
use whipcord_study::comparison::study::Study;
use whipcord_study::comparison::{csv, report, tables};
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder, picture, plot_failure, unique_names, write};
use whipcord_study::html::{Figure, page};
use whipcord_study::model_benchmark::reference::Choice;
use whipcord_study::model_benchmark::results::Results;
use whipcord_study::model_benchmark::{self, Known, Subject};
use whipcord_study::score::figures::figures as score_figures;
use whipcord_study::score::{Score, Subject as Scored, output};
use whipcord_study::style::Style;
use whipcord_study::suite::{self, Suite, SuiteCase};
use whipcord_study::timing::threads;

/// Compare all models on every case, and recommend a model for each purpose
///
/// Prints the results of the models, the error of each against a reference, the solve times and a
/// recommendation. Writes a self-contained HTML report, figures as SVG and PNG, and all numbers as
/// CSV.
///
/// Solves and times each case several times. Of many measured files `score` tells how far the models
/// are off, in less time.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Robot files, or folders of them
    #[arg(required_unless_present = "suite", conflicts_with = "suite")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    /// Models; all of them by default
    #[arg(long = "model", value_name = "NAME", value_parser = model_parser())]
    models: Vec<ModelKind>,
    /// Reference for the errors: a model, as NAME or as NAME:fine for fine resolution; `measured`,
    /// the positions in [measured] of the file; or `trusted`, which is `measured` if the file has
    /// it, else cosserat-disks:fine if the file gives the holes of the cables, else cosserat:fine
    #[arg(long, value_name = "MODEL[:fine]", default_value = "trusted")]
    reference: Choice,
    /// Built-in set of cases, instead of files
    #[arg(long, value_parser = suite_parser())]
    suite: Option<Suite>,
    /// Use only those cases of the suite whose names contain one of these texts
    #[arg(long, value_name = "TEXT", requires = "suite")]
    only: Vec<String>,
    /// List the cases of the suite without solving them
    #[arg(long)]
    list: bool,
    /// Write the cases of the suite as robot files without solving them
    #[arg(long, value_name = "DIR", conflicts_with = "list")]
    write: Option<PathBuf>,
    /// Also print the result of every model on every case
    #[arg(long)]
    rows: bool,
    /// Plot error against solve time; the name ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Leave out the figures; the one that --plot names is drawn nevertheless
    #[arg(long)]
    no_figures: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Folder for the report, the figures and the CSV files
    #[arg(long, value_name = "DIR", default_value = "whipcord-report")]
    out: PathBuf,
    #[command(flatten)]
    warnings: Warnings,
}

/// Solves, writes the files, and returns what standard output shows.
pub fn run(args: &CompareArgs, style: Style) -> Result<String, Failure> {
    match args.suite {
        Some(suite) => run_suite(args, suite, style),
        None if args.list || args.write.is_some() => Err(Failure::Input(String::from(
            "error: --list and --write are for the cases of a --suite",
        ))),
        None => run_files(args, style),
    }
}

fn suite_parser() -> impl TypedValueParser<Value = Suite> {
    let of = |suite: Suite| PossibleValue::new(suite.name()).help(suite.description());
    PossibleValuesParser::new(Suite::ALL.map(of))
        .try_map(|name| Suite::named(&name).ok_or("no such suite"))
}

fn run_suite(args: &CompareArgs, suite: Suite, style: Style) -> Result<String, Failure> {
    let cases = suite.cases().map_err(|error| Failure::Input(format!("error: {error}")))?;
    let Some(cases) = suite::only(cases, &args.only) else {
        return Err(Failure::Input(format!(
            "error: no case of the suite has {} in its name: --list says what they are called",
            args.only.join(" or ")
        )));
    };
    if args.list {
        return Ok(suite::list(&cases).text(style));
    }
    if let Some(path) = &args.write {
        return write_suite(path, &cases);
    }
    let subjects: Vec<Subject> = cases.iter().map(SuiteCase::subject).collect();
    let progress = progress::bar(subjects.len());
    let results =
        Results::of(&subjects, &kinds(args), args.reference, &deadline::cancel(), |title| {
            progress.set_message(title.to_owned());
            progress.inc(1);
        });
    progress.finish_and_clear();
    not_ended()?;
    let folder = Folder::create(&args.out)?;
    let (accuracy, text) = accuracy(args, &folder, &results, style)?;
    let recommendation = model_benchmark::report::recommendation(&results);
    let body = format!(
        "<h1>Benchmark of the models</h1>\n<section id=\"verdict\"><h2>Verdict</h2>\n{recommendation}</section>\n{accuracy}{}",
        whipcord_study::html::footer()
    );
    folder.write("report.html", &page("Whipcord: benchmark of the models", &body))?;
    finish(args, &results, Vec::new(), None, text, &folder)
}

fn write_suite(path: &Path, cases: &[SuiteCase]) -> Result<String, Failure> {
    let folder = Folder::create(path)?;
    for case in cases {
        let text = case.file().map_err(|error| Failure::Input(format!("error: {error}")))?;
        folder.write(&format!("{}.toml", case.stem), &text)?;
    }
    Ok(format!("{} robot files: {}\n", cases.len(), path.display()))
}

fn run_files(args: &CompareArgs, style: Style) -> Result<String, Failure> {
    let Inputs { cases, notes: passed_over } = Inputs::read(&args.files, &args.settings)?;
    if let Some(path) = &args.plot {
        files::keep(path, cases.iter().flat_map(|case| case.files()))?;
    }
    let stems = unique_names(cases.iter().map(|case| case.path.as_path()));
    let progress = progress::bar(2 * cases.len());
    let kinds = kinds(args);
    let count = cases.len();
    let cancel = deadline::cancel();
    let mut studies: Vec<Option<Study>> = cases.iter().map(|_| None).collect();
    let jobs = cases.into_iter().zip(stems).zip(&mut studies);
    // One thread, or those that there are: none has to be started.
    let _ = share(
        jobs,
        threads(count),
        || (),
        |((case, stem), found), ()| {
            progress.set_message(case.title.clone());
            *found = Some(Study::new(case, stem, &kinds, count, &cancel));
            progress.inc(1);
            true
        },
    );
    let studies: Vec<Study> = studies.into_iter().flatten().collect();
    not_ended().inspect_err(|_| progress.finish_and_clear())?;
    let warned: Vec<_> =
        studies.iter().map(|study| (&study.file, study.warnings.clone())).collect();
    progress
        .suspend(|| args.warnings.tell_all(&warned))
        .inspect_err(|_| progress.finish_and_clear())?;
    let unsolved = unsolved(&studies);
    if studies.iter().all(|study| study.reference().is_none()) {
        progress.finish_and_clear();
        return Err(Failure::Solve(unsolved.trim_end().to_owned()));
    }
    let known: Vec<Vec<Known>> = studies.iter().map(Study::known).collect();
    let subjects: Vec<Subject> =
        studies.iter().zip(&known).map(|(study, known)| subject(study, known)).collect();
    let results = Results::of(&subjects, &kinds, args.reference, &deadline::cancel(), |title| {
        progress.set_message(title.to_owned());
        progress.inc(1);
    });
    progress.finish_and_clear();
    not_ended()?;
    let folder = Folder::create(&args.out)?;
    let figures = match args.no_figures {
        true => studies.iter().map(|_| Vec::new()).collect(),
        false => write_figures(&folder, &studies)?,
    };
    write_numbers(&folder, &studies)?;
    let (accuracy, benchmarks) = accuracy(args, &folder, &results, style)?;
    let of_measured: Vec<&Study> =
        studies.iter().filter(|study| has_positions(&study.file)).collect();
    let measured: Vec<_> = of_measured.iter().map(|study| &study.file).collect();
    // Of a single row the first table has all there is to say.
    let rows: usize = measured.iter().map(|file| Scored::new(file).rows.len()).sum();
    let score = match rows {
        0 | 1 => None,
        _ => {
            let known = |file: usize, model| of_measured[file].answers_of(model);
            Some(score::of_files(measured, kinds.clone(), None, &known)?)
        }
    };
    let mut accuracy = accuracy;
    if let Some(score) = &score {
        let drawn = match args.no_figures {
            true => Vec::new(),
            false => score_figures(score).map_err(|error| plot_failure(folder.path(), &error))?,
        };
        for figure in &drawn {
            folder.write(&format!("measured-{}.svg", figure.name), &figure.svg)?;
        }
        accuracy += "<section id=\"measurements\"><h2>Against the measurements</h2>\n";
        accuracy += &whipcord_study::score::report::section(score, &drawn);
        accuracy += "</section>\n";
        folder.write_table("score.csv", &output::summary_csv(score))?;
        folder.write_table("rows.csv", &output::rows_csv(score))?;
    }
    let recommendation = model_benchmark::report::recommendation(&results);
    let multiples = match args.no_figures {
        true => vec![None; studies.len()],
        false => multiples(&studies)?,
    };
    let report =
        report::html(&studies, &figures, &multiples, &recommendation, &accuracy, &passed_over);
    folder.write("report.html", &report)?;

    if !unsolved.is_empty() {
        return Err(Failure::Solve(format!(
            "{unsolved}What the other cases gave is in {}",
            folder.path().join("report.html").display()
        )));
    }
    let mut text = tables::summary(&studies, false).text(style) + "\n";
    for note in tables::notes(&studies).iter().chain(&passed_over) {
        text += &format!("{note}\n");
    }
    if let Some(score) = &score {
        text += &format!("\n{}\n\n", style.heading("Against the measurements"));
        text += &(whipcord_study::score::tables::summary(score).text(style) + "\n");
        for note in whipcord_study::score::tables::measures_notes(score) {
            text += &format!("{note}\n");
        }
    }
    text += &format!("\n{benchmarks}");
    let warnings = warned.iter().flat_map(|(file, list)| {
        let mut objects = warnings_json(file, list);
        let objects = objects.as_array_mut().map(std::mem::take).unwrap_or_default();
        objects.into_iter().map(|mut object| {
            object["case"] = file.title.as_str().into();
            object
        })
    });
    finish(args, &results, warnings.collect(), score.as_ref(), text, &folder)
}

/// Whether anything was measured in space.
fn has_positions(file: &CaseFile) -> bool {
    let measured = file.measured.iter().flat_map(|measured| &measured.observations);
    measured.into_iter().any(|seen| !seen.seen.is_in_image())
}

/// Refuses to go on once the time is over: solves that were ended have no answers to compare.
fn not_ended() -> Result<(), Failure> {
    match deadline::cancel().is_cancelled() {
        true => Err(Failure::Solve("error: not all cases were solved".to_owned())),
        false => Ok(()),
    }
}

fn subject<'a>(study: &'a Study, known: &'a [Known<'a>]) -> Subject<'a> {
    Subject {
        title: &study.file.title,
        stem: &study.stem,
        robot: &study.file.robot,
        case: &study.file.case,
        measured: study.file.measured.as_ref(),
        tags: None,
        known,
    }
}

fn kinds(args: &CompareArgs) -> Vec<ModelKind> {
    let wanted = |kind: &ModelKind| args.models.is_empty() || args.models.contains(kind);
    ModelKind::ALL.into_iter().filter(wanted).collect()
}

/// Draws and writes what the benchmarks gave; its part of the report, and its part of what is printed.
fn accuracy(
    args: &CompareArgs,
    folder: &Folder,
    results: &Results,
    style: Style,
) -> Result<(String, String), Failure> {
    let is_drawn = !args.no_figures || args.plot.is_some();
    let pareto = is_drawn.then(|| model_benchmark::picture::pareto("Error against time", results));
    let pareto = pareto.transpose().map_err(|error| plot_failure(folder.path(), &error))?;
    let mut pareto = pareto.flatten();
    if let Some((svg, path)) = pareto.as_ref().zip(args.plot.as_ref()) {
        write(path, &picture(svg, path)?)?;
    }
    if args.no_figures {
        pareto = None;
    }
    if let Some(svg) = &pareto {
        folder.write_figure("pareto", svg)?;
    }
    folder.write_table("accuracy.csv", &model_benchmark::output::csv(results))?;
    let figure = pareto.map(|svg| Figure {
        name: "pareto".into(),
        caption: "Error, relative to the length of the backbone, against the time of a solve: each case as a dot, the medians of each model as its sign, hollow for a preset. Models in pale colours are slower and less accurate than another model.".into(),
        svg,
    });
    let html = model_benchmark::report::section(results, figure.as_ref());
    let mut text = style.heading("Accuracy and time") + "\n\n";
    text += &model_benchmark::tables::text(results, args.rows, style);
    Ok((html, text))
}

/// What standard output shows.
fn finish(
    args: &CompareArgs,
    results: &Results,
    warnings: Vec<Value>,
    score: Option<&Score<'_>>,
    text: String,
    folder: &Folder,
) -> Result<String, Failure> {
    if args.json {
        let mut json =
            model_benchmark::output::json(results).map_err(|error| files::no_result(&error))?;
        json["warnings"] = warnings.into();
        if let Some(score) = score {
            json["score"] = output::json(score, false);
        }
        return Ok(format!("{json:#}\n"));
    }
    Ok(format!("{text}Report: {}\n", folder.path().join("report.html").display()))
}

/// The numbers of all cases, and of each that has an answer.
fn write_numbers(folder: &Folder, studies: &[Study]) -> Result<(), Failure> {
    for study in studies.iter().filter(|study| study.reference().is_some()) {
        let stem = &study.stem;
        folder.write_table(&format!("{stem}-disks.csv"), &csv::disks(study))?;
        folder.write_table(&format!("{stem}-stations.csv"), &csv::stations(study))?;
        if let Some(cables) = csv::cables(study) {
            folder.write_table(&format!("{stem}-cables.csv"), &cables)?;
        }
        if let Some(markers) = csv::markers(study) {
            folder.write_table(&format!("{stem}-measured.csv"), &markers)?;
        }
        for (run, solved) in study.solved().filter(|(_, s)| !s.solution.contacts.is_empty()) {
            let contacts = contacts_csv(&solved.solution, &study.file.case.obstacles);
            folder.write_table(&format!("{stem}-{}-contacts.csv", run.model.name()), &contacts)?;
        }
    }
    folder.write_table("cases.csv", &csv::summary(studies))?;
    if let Some(distances) = csv::distances(studies) {
        folder.write_table("distances.csv", &distances)?;
    }
    if let Some(reference) = csv::reference(studies) {
        folder.write_table("reference.csv", &reference)?;
    }
    Ok(())
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
