//! Robot files, and folders of them.

use std::path::{Path, PathBuf};
use std::{fs, io};

use whipcord_io::{CaseFile, FileError, load, render};

use crate::failure::Failure;
use crate::style::Style;

/// The cases of several files and folders.
#[derive(Debug, Default)]
pub struct Inputs {
    /// What was read.
    pub cases: Vec<CaseFile>,
    /// Which files were passed over, and why.
    pub notes: Vec<String>,
}

impl Inputs {
    /// Reads files, and all `.toml` files of folders in the order of their names. A file of a folder
    /// that has no cables is there to be extended by the others, and is passed over.
    ///
    /// # Errors
    /// What is wrong with each file that cannot be used; or that there is nothing to solve.
    pub fn read(paths: &[PathBuf]) -> Result<Self, Failure> {
        let mut inputs = Self::default();
        let mut messages = Vec::new();
        for path in paths {
            if path.is_dir() {
                for file in robot_files(path)? {
                    match load(&file) {
                        Ok(case) if case.robot.cables().is_empty() => inputs.notes.push(format!(
                            "{} has no cables: it is there to be extended",
                            file.display()
                        )),
                        Ok(case) => inputs.cases.push(case),
                        Err(error) => messages.push(message(&error)),
                    }
                }
            } else {
                match load(path) {
                    Ok(case) => inputs.cases.push(case),
                    Err(error) => messages.push(message(&error)),
                }
            }
        }
        if !messages.is_empty() {
            return Err(Failure::Input(messages.join("\n")));
        }
        if inputs.cases.is_empty() {
            let places: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
            let places = places.join(", ");
            return Err(Failure::Input(format!(
                "error: there is no robot file with cables in {places}"
            )));
        }
        Ok(inputs)
    }
}

/// One robot file.
///
/// # Errors
/// What is wrong with it.
pub fn read_one(path: &Path) -> Result<CaseFile, Failure> {
    load(path).map_err(|error| Failure::Input(message(&error)))
}

/// A file's error as standard error shows it.
pub fn message(error: &FileError) -> String {
    render(error, Style::for_stderr().is_enabled()).trim_end().to_owned()
}

/// The file, or all `.toml` files of the folder in the order of their names.
///
/// # Errors
/// [`Failure::Input`] when the folder cannot be read.
pub fn robot_files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if path.is_dir() {
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
