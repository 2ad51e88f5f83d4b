//! Files and folders that are written.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use whipcord_io::{CsvTable, NonFinite, write_atomically};
use whipcord_plot::{PlotError, png};

use crate::failure::Failure;

/// Name of standard input in messages.
pub const STANDARD_INPUT: &str = "<stdin>";

/// Pixels of a PNG for each px of its SVG: sharp on dense displays and in print.
const PNG_SCALE: f64 = 2.0;

/// A folder that results go to.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Creates the folder where there is none.
    ///
    /// # Errors
    /// [`Failure::Input`] when it cannot be created.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        if let (false, Ok(target)) = (path.exists(), fs::read_link(path)) {
            return Err(Failure::Input(format!(
                "error: cannot create {}: it is a symbolic link to {}, which does not exist: create that folder, or remove \
                 the link",
                path.display(),
                target.display()
            )));
        }
        fs::create_dir_all(path).map_err(|error| Failure::path("create", path, &error))?;
        Ok(Self { path: path.to_owned() })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a text file, whole or not at all.
    ///
    /// # Errors
    /// [`Failure::Input`] when it cannot be written.
    pub fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        write(&self.path.join(name), text.as_bytes())
    }

    /// Writes a table as CSV.
    ///
    /// # Errors
    /// [`Failure`] when it holds what is no number, or cannot be written.
    pub fn write_table(&self, name: &str, table: &CsvTable) -> Result<(), Failure> {
        self.write(name, &table.to_csv().map_err(|error| no_result(&error))?)
    }

    /// Writes a figure as SVG and as PNG.
    ///
    /// # Errors
    /// [`Failure::Input`] when it cannot be drawn or written.
    pub fn write_figure(&self, name: &str, svg: &str) -> Result<(), Failure> {
        self.write(&format!("{name}.svg"), svg)?;
        let path = self.path.join(format!("{name}.png"));
        write(&path, &picture(svg, &path)?)
    }
}

/// An SVG in the format that the name of a file asks for.
///
/// # Errors
/// [`Failure::Input`] when it cannot be drawn.
pub fn picture(svg: &str, path: &Path) -> Result<Vec<u8>, Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        png(svg, PNG_SCALE).map_err(|error| plot_failure(path, &error))
    } else {
        Ok(svg.as_bytes().to_owned())
    }
}

/// A picture that cannot be drawn.
pub fn plot_failure(path: &Path, error: &PlotError) -> Failure {
    Failure::Input(format!("error: cannot draw {}: {error}", path.display()))
}

/// An answer that holds what is no number.
pub fn no_result(error: &NonFinite) -> Failure {
    Failure::Solve(format!("error: {error}"))
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// [`Failure::Input`] when it cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomically(path, bytes).map_err(|error| Failure::path("write", path, &error))
}

/// Refuses to write over a file that is read.
///
/// # Errors
/// [`Failure::Input`] with its name.
pub fn keep<'a>(out: &Path, read: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    let real = out.canonicalize().ok();
    let same = |file: &Path| file == out || (real.is_some() && file.canonicalize().ok() == real);
    match read.into_iter().any(same) {
        true => {
            Err(Failure::Input(format!("error: {} is read: write to another file", out.display())))
        }
        false => Ok(()),
    }
}

/// A name for the results of each robot file: its own; where several have the same, the first keeps
/// it and the others get a number that makes it the name of no other file. Names that differ in
/// capitals alone are the same, as they are to some file systems.
pub fn unique_names<'a>(files: impl Iterator<Item = &'a Path>) -> Vec<String> {
    let stem = |file: &Path| match file == Path::new(STANDARD_INPUT) {
        // Some systems do not allow angle brackets in file names.
        true => "stdin".to_owned(),
        false => file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let stems: Vec<String> = files.map(stem).collect();
    let mut taken: HashSet<String> = stems.iter().map(|stem| stem.to_lowercase()).collect();
    let mut kept = HashSet::new();
    stems
        .into_iter()
        .map(|stem| {
            if kept.insert(stem.to_lowercase()) {
                return stem;
            }
            let mut name = stem.clone();
            for n in 2_usize.. {
                name = format!("{stem}-{n}");
                if taken.insert(name.to_lowercase()) {
                    break;
                }
            }
            name
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_one_name_are_told_apart() {
        let names = |files: &[&str]| unique_names(files.iter().map(Path::new));
        let files = ["a/case.toml", "b/case.toml", "b/case-2.toml", "c/case.toml"];
        assert_eq!(names(&files), ["case", "case-3", "case-2", "case-4"]);
        assert_eq!(names(&["a/Arm.toml", "b/arm.toml", "c/arm-2.toml"]), ["Arm", "arm-3", "arm-2"]);
        assert_eq!(
            names(&["a.toml", "a.toml", "a-2.toml", "a-2.toml"]),
            ["a", "a-3", "a-2", "a-2-2"]
        );
    }
}
