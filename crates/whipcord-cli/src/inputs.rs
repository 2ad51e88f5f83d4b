//! Robot files, and folders of them.

use std::collections::BTreeSet;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::Args;
use whipcord_io::{CaseFile, FileError, load_stream, load_with};

use whipcord_study::failure::{Failure, message};
use whipcord_study::files::STANDARD_INPUT;

/// Keys of robot files that the command line gives instead of the files.
#[derive(Debug, Default, Args)]
pub struct Settings {
    /// Set a key of the robot file, such as cables.pull.tension="5 N", cables[0].shortening="3 %" or
    /// backbone.diameter="2 mm"; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<String>,
}

impl Settings {
    /// Reads a robot file, or standard input for `-`, with these keys.
    ///
    /// # Errors
    /// What is wrong with the file or with a key.
    pub fn load(&self, path: &Path) -> Result<CaseFile, FileError> {
        if !is_standard_input(path) {
            return load_with(path, &self.set);
        }
        let stdin = io::stdin();
        if stdin.is_terminal() {
            // A closed standard error is no reason not to read.
            let _ = writeln!(
                io::stderr(),
                "reading a robot file from the terminal; {END_OF_INPUT} ends it"
            );
        }
        load_stream(stdin.lock(), STANDARD_INPUT, &self.set)
    }
}

/// The keys that end the input of a terminal.
pub const END_OF_INPUT: &str = if cfg!(windows) { "Ctrl-Z and Enter" } else { "Ctrl-D" };

fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// Checks that standard input is given at most once.
///
/// # Errors
/// [`Failure::Input`] where it is.
pub fn check_standard_input(paths: &[PathBuf]) -> Result<(), Failure> {
    if paths.iter().filter(|path| is_standard_input(path)).count() < 2 {
        return Ok(());
    }
    Err(Failure::Input("error: standard input (-) can be read only once: give - once".to_owned()))
}

/// The cases of several files and folders.
#[derive(Debug, Default)]
pub struct Inputs {
    /// What was read.
    pub cases: Vec<CaseFile>,
    /// Which files were passed over, and why.
    pub notes: Vec<String>,
}

impl Inputs {
    /// Reads files, and all `.toml` files of folders in the order of their names: a folder is the list of its
    /// files. A file without cables that another of these files extends is passed over.
    ///
    /// # Errors
    /// What is wrong with each file that cannot be used; or that there is nothing to solve.
    pub fn read(paths: &[PathBuf], settings: &Settings) -> Result<Self, Failure> {
        check_standard_input(paths)?;
        let mut inputs = Self::default();
        let mut messages = Vec::new();
        for path in paths {
            for file in robot_files(path)? {
                match settings.load(&file) {
                    Ok(case) => inputs.cases.push(case),
                    Err(error) => messages.push(message(&error)),
                }
            }
        }
        if !messages.is_empty() {
            return Err(Failure::Input(messages.join("\n")));
        }
        inputs.pass_over_extended();
        if inputs.cases.is_empty() {
            let places: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
            let places = places.join(", ");
            return Err(Failure::Input(format!(
                "error: there is no robot file (.toml) in {places}"
            )));
        }
        Ok(inputs)
    }

    /// Passes over what is there to be extended by the others.
    fn pass_over_extended(&mut self) {
        let same = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let extended: BTreeSet<PathBuf> =
            self.cases.iter().flat_map(|case| case.files().skip(1).map(same)).collect();
        let notes = &mut self.notes;
        self.cases.retain(|case| {
            let is_extended =
                case.robot.cables().is_empty() && extended.contains(&same(&case.path));
            if is_extended {
                notes.push(format!(
                    "{} is not compared: it has no cables, and others of the files extend it",
                    case.path.display()
                ));
            }
            !is_extended
        });
    }
}

/// One robot file.
///
/// # Errors
/// What is wrong with it.
pub fn read_one(path: &Path, settings: &Settings) -> Result<CaseFile, Failure> {
    settings.load(path).map_err(|error| Failure::Input(message(&error)))
}

/// The file, or all `.toml` files of the folder in the order of their names.
///
/// # Errors
/// [`Failure::Input`] when the folder cannot be read.
pub fn robot_files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if path.is_dir() && !is_standard_input(path) {
        toml_files(path).map_err(|error| Failure::path("read", path, &error))
    } else {
        Ok(vec![path.to_owned()])
    }
}

fn toml_files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_file() && path.extension().is_some_and(|extension| extension == "toml") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
