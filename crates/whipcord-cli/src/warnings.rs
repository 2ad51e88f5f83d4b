//! Warnings: about answers, on standard error, and `--deny-warnings`.

use std::collections::HashSet;
use std::io::{self, Write as _};

use clap::Args;
use whipcord_io::{CaseFile, FileWarning, render_warnings};

use whipcord_study::failure::Failure;
use whipcord_study::style::Style;

/// What becomes of warnings.
#[derive(Clone, Copy, Debug, Args)]
pub struct Warnings {
    /// Treat warnings as errors: nothing is printed, and the exit status is 2 for a warning about a file, 1 for
    /// one about an answer
    #[arg(long)]
    deny_warnings: bool,
}

impl Warnings {
    /// Prints warnings about one file to standard error.
    ///
    /// # Errors
    /// The same text, where warnings are denied.
    pub fn tell(self, file: &CaseFile, warnings: &[FileWarning]) -> Result<(), Failure> {
        self.tell_all(&[(file, warnings.to_vec())])
    }

    /// Prints the warnings about several files to standard error.
    ///
    /// # Errors
    /// The same text, where warnings are denied.
    pub fn tell_all(self, of: &[(&CaseFile, Vec<FileWarning>)]) -> Result<(), Failure> {
        let of = &distinct(of);
        let Some(text) = rendered(of) else { return Ok(()) };
        if !self.deny_warnings {
            // A closed standard error is no reason to fail.
            let _ = writeln!(io::stderr().lock(), "{text}");
            return Ok(());
        }
        let count: usize = of.iter().map(|(_, warnings)| warnings.len()).sum();
        let counted = if count == 1 { "1 warning".to_owned() } else { format!("{count} warnings") };
        let text = format!("{text}\n\nerror: {counted}, and --deny-warnings");
        let about_answer = |warning: &FileWarning| warning.warning.is_about_answer();
        if of.iter().all(|(_, warnings)| warnings.iter().all(about_answer)) {
            Err(Failure::Solve(text))
        } else {
            Err(Failure::Input(text))
        }
    }

    /// Prints a warning about answers of several files to standard error: its message, and what to do.
    ///
    /// # Errors
    /// The same text, where warnings are denied.
    pub fn tell_of_all(self, message: &str, help: &str) -> Result<(), Failure> {
        let text = format!("warning: {message}\n  help: {help}");
        if self.deny_warnings {
            return Err(Failure::Solve(format!("{text}\n\nerror: 1 warning, and --deny-warnings")));
        }
        // A closed standard error is no reason to fail.
        let _ = writeln!(io::stderr().lock(), "{text}");
        Ok(())
    }
}

/// The warnings as standard error shows them, what several files say alike once; `None` where there are none.
pub fn text(of: &[(&CaseFile, Vec<FileWarning>)]) -> Option<String> {
    rendered(&distinct(of))
}

fn rendered(of: &[(&CaseFile, Vec<FileWarning>)]) -> Option<String> {
    let colour = Style::for_stderr().is_enabled();
    let texts: Vec<String> = of
        .iter()
        .filter(|(_, warnings)| !warnings.is_empty())
        .map(|(file, warnings)| render_warnings(file, warnings, colour).trim_end().to_owned())
        .collect();
    (!texts.is_empty()).then(|| texts.join("\n\n"))
}

/// What several files say alike, such as one that all of them extend, is said once.
fn distinct<'a>(of: &[(&'a CaseFile, Vec<FileWarning>)]) -> Vec<(&'a CaseFile, Vec<FileWarning>)> {
    let mut known = HashSet::new();
    of.iter()
        .map(|(file, warnings)| {
            let is_new = |warning: &&FileWarning| {
                let place = warning.place(file).map(|(path, at)| (path, at.line, at.column));
                // Without a place it is about an answer of this very file.
                place.is_none() || known.insert((place, warning.message()))
            };
            (*file, warnings.iter().filter(is_new).cloned().collect())
        })
        .collect()
}
