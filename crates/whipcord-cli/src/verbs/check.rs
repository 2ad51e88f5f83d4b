//! `whipcord check`: validates robot files and says what was understood.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};
use whipcord::{
    Actuation, Model, ModelKind, Solution, SolveError, StabilityAnalysis, Statics, Stations,
};
use whipcord_io::{
    CaseFile, FileWarning, describe as tables_of, describe_goal, describe_motion, problems_json,
    warnings_json,
};

use crate::deadline;
use crate::goal;
use crate::inputs::{self, Settings};
use crate::warnings::{Warnings, text as warnings_text};
use whipcord_study::describe::{describe, driven_by, instability, markers};
use whipcord_study::failure::{Failure, refuses};
use whipcord_study::quantity::millimetres;
use whipcord_study::style::Style;
use whipcord_study::warnings::{Answered, about_file_and_answers};

/// Check robot files and print a description of each robot
///
/// Describes each robot and lists the models that accept it. All files are checked, even if one of
/// them has an error; valid files are still described, and the exit status is then 2.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Robot files, or folders of them, or - for standard input
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    warnings: Warnings,
}

/// A file that can be used, and what came of it.
struct Checked {
    file: CaseFile,
    answers: Answers,
    warnings: Vec<FileWarning>,
}

/// What each model says of the case.
type Answers = Vec<(ModelKind, Result<Solution, SolveError>)>;

/// Checks the files and returns what standard output shows.
pub fn run(args: &CheckArgs, style: Style) -> Result<String, Failure> {
    inputs::check_standard_input(&args.files)?;
    let mut checked = Vec::new();
    let mut messages = Vec::new();
    let mut objects = Vec::new();
    for path in &args.files {
        let files = inputs::robot_files(path)?;
        if files.is_empty() {
            messages.push(format!("error: there is no robot file in {}", path.display()));
        }
        for path in files {
            match args.settings.load(&path) {
                Ok(file) => {
                    let one = Checked::new(file);
                    objects.push(one.json());
                    checked.push(one);
                }
                Err(error) => {
                    objects.push(invalid(&path, problems_json(&error), error.more));
                    messages.push(whipcord_study::failure::message(&error));
                }
            }
        }
    }
    let text = if args.json {
        format!("{:#}\n", json!({ "files": objects }))
    } else {
        checked.iter().map(|one| one.words(style)).collect::<Vec<_>>().join("\n")
    };
    let warned: Vec<_> = checked.iter().map(|one| (&one.file, one.warnings.clone())).collect();
    if messages.is_empty() {
        return match args.warnings.tell_all(&warned) {
            Ok(()) => Ok(text),
            // What a file asks for is what is checked: its answers count as the file.
            Err(failure) => Err(Failure::Partial { text, message: failure.to_string() }),
        };
    }
    messages.extend(warnings_text(&warned));
    Err(Failure::Partial { text, message: messages.join("\n") })
}

/// The tables of a file as they were understood, in SI, with the targets and limits; null where only the file can say it, as of loads that
/// differ from step to step.
fn tables(file: &CaseFile) -> Value {
    let Ok(mut tables) = tables_of(None, &file.robot, &file.case) else { return Value::Null };
    describe_goal(&file.goal, &mut tables);
    if describe_motion(&file.motion, &file.robot, &mut tables).is_err() {
        return Value::Null;
    }
    tables.to_json()
}

/// A file that cannot be used, as JSON.
fn invalid(path: &Path, problems: Value, more: usize) -> Value {
    json!({
        "path": path.display().to_string(),
        "valid": false,
        "problems": problems,
        "more_problems": more,
    })
}

impl Checked {
    /// Solves the case with every model.
    fn new(file: CaseFile) -> Self {
        let model = |kind| {
            Model::new(kind, Stations::Disks, Actuation::Natural)
                .with_stability(StabilityAnalysis::Eigenvalue)
                .cancelled_by(&deadline::cancel())
        };
        let answer = |kind| (kind, model(kind).solve(&file.robot, &file.case));
        let answers: Answers = ModelKind::ALL.into_iter().map(answer).collect();
        let solved: Vec<Answered<'_>> = answers
            .iter()
            .filter_map(|(kind, answer)| Some((model(*kind), vec![answer.as_ref().ok()?])))
            .collect();
        let warnings = about_file_and_answers(&file, &solved);
        Self { file, answers, warnings }
    }

    /// What is known of the file as JSON: of each model whether it takes the case, and its stability, or the reason.
    fn json(&self) -> Value {
        let model = |(kind, answer): &(ModelKind, Result<Solution, SolveError>)| {
            let (status, stable, reason) = match answer {
                Ok(solution) => ("converged", solution.diagnostics.stable, None),
                Err(error) if refuses(error) => ("refused", None, Some(error.to_string())),
                Err(error) => ("failed", None, Some(error.to_string())),
            };
            json!({ "model": kind.name(), "status": status, "stable": stable, "reason": reason })
        };
        json!({
            "path": self.file.path.display().to_string(),
            "valid": true,
            "title": self.file.title,
            "tables": tables(&self.file),
            "models": self.answers.iter().map(model).collect::<Vec<_>>(),
            "warnings": warnings_json(&self.file, &self.warnings),
        })
    }

    /// What was understood of the file.
    fn words(&self, style: Style) -> String {
        let Self { file, answers, .. } = self;
        let mut lines = vec![(String::from("title"), file.title.clone())];
        lines.extend(describe(&file.robot, &file.case));
        lines.extend(goal::describe(file));
        if let Some(solution) = answers.iter().find_map(|(_, answer)| answer.as_ref().ok()) {
            let lengths: Vec<String> = solution
                .cables
                .iter()
                .map(|cable| format!("{} {}", cable.name, millimetres(cable.initial_length)))
                .collect();
            if !lengths.is_empty() {
                lines.push((
                    String::from("cable lengths"),
                    format!("{} before actuation", lengths.join(", ")),
                ));
            }
        }
        if let Some(measured) = &file.measured {
            let seen = &measured.observations;
            let in_images =
                seen.iter().filter(|observation| observation.seen.is_in_image()).count();
            let places = [(seen.len() - in_images, "in space"), (in_images, "in images")];
            let places = places.into_iter().filter(|(count, _)| *count > 0);
            let places: Vec<String> =
                places.map(|(count, place)| format!("{} {place}", markers(count))).collect();
            let what = format!("{}, from {}", places.join(" and "), measured.path.display());
            lines.push((String::from("measured"), what));
        }
        if let Some(reference) = &file.reference {
            lines.push((String::from("reference"), reference.source.clone()));
        }
        for (kind, answer) in answers {
            let recommendation = match answer {
                Ok(solution) => {
                    let driver = driven_by(*kind, Actuation::Natural, &file.case);
                    let unstable = instability(solution).map(|words| format!("; {words}"));
                    format!("takes it, driven by {driver}{}", unstable.unwrap_or_default())
                }
                Err(error) if refuses(error) => format!("cannot take it: {error}"),
                Err(error) => format!("takes it, but finds no answer: {error}"),
            };
            lines.push((kind.to_string(), recommendation));
        }
        let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        let mut text = format!("{}\n", style.heading(format!("{}: valid", file.path.display())));
        for (name, value) in lines {
            let padding = " ".repeat(width - name.chars().count());
            text += &format!("  {}{padding}  {value}\n", style.faint(name));
        }
        text
    }
}
