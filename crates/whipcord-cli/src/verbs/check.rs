//! `whipcord check`: validates robot files and says what was understood.

use std::path::PathBuf;

use clap::Args;
use whipcord::{Drive, Model, ModelKind, Solution, SolveError, Statics, Stations};
use whipcord_io::{CaseFile, load};

use crate::failure::{Failure, refuses};
use crate::inputs;
use crate::quantity::millimetres;
use crate::style::Style;
use crate::words::{describe, driven_by, instability, markers};

/// Validate robot files and print what was understood
///
/// Prints each robot in words, and which models can take it. Every file is checked, also after one
/// with a mistake: those without are printed, and the exit status is 2.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Robot files, or folders of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

/// What was understood of each file.
pub fn run(args: &CheckArgs, style: Style) -> Result<String, Failure> {
    let mut texts = Vec::new();
    let mut messages = Vec::new();
    for path in &args.files {
        let files = inputs::robot_files(path)?;
        if files.is_empty() {
            messages.push(format!("error: there is no robot file in {}", path.display()));
        }
        for file in files {
            match load(&file) {
                Ok(file) => texts.push(words(&file, style)),
                Err(error) => messages.push(inputs::message(&error)),
            }
        }
    }
    let text = texts.join("\n");
    if messages.is_empty() {
        Ok(text)
    } else {
        Err(Failure::Partial { text, message: messages.join("\n") })
    }
}

fn words(file: &CaseFile, style: Style) -> String {
    let answers: Vec<(ModelKind, Result<Solution, SolveError>)> = ModelKind::ALL
        .into_iter()
        .map(|kind| {
            let model = Model::new(kind, Stations::Disks, Drive::Natural);
            (kind, model.solve(&file.robot, &file.case))
        })
        .collect();
    let mut lines = vec![(String::from("title"), file.title.clone())];
    lines.extend(describe(&file.robot, &file.case));
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
        let in_images = seen.iter().filter(|observation| observation.seen.is_in_image()).count();
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
        let verdict = match answer {
            Ok(solution) => {
                let driver = driven_by(kind, Drive::Natural, &file.case);
                let unstable = instability(&solution).map(|words| format!("; {words}"));
                format!("takes it, driven by {driver}{}", unstable.unwrap_or_default())
            }
            Err(error) if refuses(&error) => format!("cannot take it: {error}"),
            Err(error) => format!("takes it, but finds no answer: {error}"),
        };
        lines.push((kind.to_string(), verdict));
    }
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let mut text = format!("{}\n", style.heading(format!("{}: valid", file.path.display())));
    for (name, value) in lines {
        let padding = " ".repeat(width - name.chars().count());
        text += &format!("  {}{padding}  {value}\n", style.faint(name));
    }
    text
}
