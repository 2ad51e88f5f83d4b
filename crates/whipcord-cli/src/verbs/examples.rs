//! `whipcord examples`: the embedded robot files.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::examples::EXAMPLES;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::style::Style;

/// List the example robot files, or copy them to a folder
///
/// The examples are part of the program. --copy needs neither the network nor the sources.
#[derive(Debug, Args)]
pub struct ExamplesArgs {
    /// Folder to write all examples to; it is created if it does not exist
    #[arg(long, value_name = "DIR")]
    copy: Option<PathBuf>,
    /// Overwrite existing files
    #[arg(long, requires = "copy")]
    force: bool,
}

/// The list, or the paths of the written files.
pub fn run(args: &ExamplesArgs, style: Style) -> Result<String, Failure> {
    match &args.copy {
        None => Ok(list(style)),
        Some(folder) => copy(folder, args.force),
    }
}

fn list(style: Style) -> String {
    let width = EXAMPLES.iter().map(|example| example.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for example in EXAMPLES {
        let title = example.title().unwrap_or("triangle mesh");
        text += &format!("{:<width$}  {}\n", example.name, style.faint(title));
    }
    text + "\nWrite them to a folder with: whipcord examples --copy DIR\n"
}

fn copy(folder: &Path, force: bool) -> Result<String, Failure> {
    let paths: Vec<PathBuf> = EXAMPLES.iter().map(|example| folder.join(example.name)).collect();
    let existing: Vec<&PathBuf> =
        paths.iter().filter(|path| fs::symlink_metadata(path).is_ok()).collect();
    if !force && let Some(first) = existing.first() {
        let others = match existing.len() {
            1 => String::new(),
            2 => " and 1 other file".to_owned(),
            count => format!(" and {} other files", count - 1),
        };
        return Err(Failure::Input(format!(
            "error: {}{others} would be overwritten; nothing was written\n  help: give another folder, or --force to overwrite",
            first.display()
        )));
    }
    let mut text = String::new();
    for (path, example) in paths.iter().zip(EXAMPLES) {
        Folder::create(path.parent().unwrap_or(folder))?;
        files::write(path, example.content)?;
        text += &format!("{}\n", path.display());
    }
    Ok(text)
}
