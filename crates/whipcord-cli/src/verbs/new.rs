//! `whipcord new`: templates of robot files.

use std::fs;
use std::io::{self, IsTerminal as _};
use std::path::{Path, PathBuf};

use clap::Args;

use crate::path_argument::path_ending_in;
use crate::template::questions::{self, Unanswered};
use crate::template::{Kind, Plan};
use whipcord_study::failure::Failure;
use whipcord_study::files;

/// Write a template of a robot file
///
/// Comments in the file explain each key. Without --kind, the command asks for the kind, the length,
/// the diameter, the material, and the numbers of disks and cables on the terminal; an empty answer
/// selects the default in brackets.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Robot file to write; the name ends in .toml
    #[arg(value_parser = path_ending_in(&["toml"]))]
    file: PathBuf,
    /// Write the template of this kind, without questions
    #[arg(long, value_enum)]
    kind: Option<Kind>,
    /// Overwrite an existing file
    #[arg(long)]
    force: bool,
}

/// Writes the file and lists the next commands.
pub fn run(args: &NewArgs) -> Result<String, Failure> {
    let path = &args.file;
    // A link without a target exists as well.
    if !args.force && fs::symlink_metadata(path).is_ok() {
        return Err(Failure::Input(format!(
            "error: {} exists\n  help: give another name, or --force to overwrite it",
            path.display()
        )));
    }
    let plan = match args.kind {
        Some(kind) => kind.plan(),
        None => ask()?,
    };
    let shown = path.display();
    let name =
        if shown.to_string().contains(' ') { format!("\"{shown}\"") } else { shown.to_string() };
    let text = plan.robot_file(&name);
    check(&text, path)?;
    files::write(path, text.as_bytes())?;
    Ok(format!(
        "{shown}\n\nNext: whipcord check {name}, whipcord solve {name}, or whipcord view {name}\n"
    ))
}

/// Asks on the terminal.
fn ask() -> Result<Plan, Failure> {
    let stdin = io::stdin();
    if !stdin.is_terminal() {
        let kinds = Kind::ALL.map(Kind::name).join("|");
        return Err(Failure::Input(format!(
            "error: standard input is not a terminal, so that no questions can be asked\n  help: give --kind {kinds}"
        )));
    }
    // Standard output is for results, and may be redirected.
    questions::ask(&mut stdin.lock(), &mut io::stderr()).map_err(|unanswered| {
        let why = match unanswered {
            Unanswered::Ended => "the input ended before the last question".to_owned(),
            Unanswered::Broken(error) => format!("cannot ask: {error}"),
        };
        Failure::Input(format!("error: {why}; nothing was written"))
    })
}

/// Checks that the robot file is valid.
fn check(text: &str, path: &Path) -> Result<(), Failure> {
    match whipcord_io::parse(text, path) {
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::Input(format!(
            "error: these answers give no valid robot; nothing was written\n{}",
            whipcord_study::failure::message(&error)
        ))),
    }
}
