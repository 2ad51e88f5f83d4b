//! A robot file, read.

use std::path::{Path, PathBuf};

use whipcord::robot::limits;
use whipcord::{Case, Robot, SolveError};

use crate::check::{self, Fields};
use crate::error::{FileError, FileProblem, Problems};
use crate::files;
use crate::node::{Node, Value};
use crate::read::{self, Measured, Reference};
use crate::schema::{DURATION, ROOT};
use crate::source::Sources;
use crate::validate::{Parts, assemble, refusal};

/// A robot and what is asked of it, as a file describes them.
#[derive(Clone, Debug)]
pub struct CaseFile {
    /// What the file describes; the file's name where it does not say.
    pub title: String,
    /// The robot.
    pub robot: Robot,
    /// What is asked of it.
    pub case: Case,
    /// What the real robot did, where it was measured.
    pub measured: Option<Measured>,
    /// What others have published for this case.
    pub reference: Option<Reference>,
    /// The file it was read from.
    pub path: PathBuf,
    document: Node,
    sources: Sources,
}

impl CaseFile {
    /// What a model that refuses the robot or the case says, with its place in the file. `None`
    /// where nothing in the file is at fault: when a solve failed, or an option is refused.
    #[must_use]
    pub fn locate(&self, error: &SolveError) -> Option<FileError> {
        let diagnostic = refusal(error, &self.document)?;
        Some(FileError { problems: vec![diagnostic], more: 0, sources: self.sources.clone() })
    }
}

/// Reads a robot file, and the files it names.
///
/// ```no_run
/// let file = whipcord_io::load("examples/table1/case-3.toml")?;
/// println!("{}: {} cables", file.title, file.robot.cables().len());
/// # Ok::<(), whipcord_io::FileError>(())
/// ```
///
/// # Errors
/// [`FileError`] with all that is wrong, where, and what to do about it.
pub fn load(path: impl AsRef<Path>) -> Result<CaseFile, FileError> {
    let path = path.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match files::read_first(path, &mut sources, &mut problems) {
        Some(text) => parse(&text, path),
        None => Err(problems.into_error(sources)),
    }
}

/// Reads the text of a robot file. `name` stands for it in messages, and the files it names are
/// looked for in its folder.
///
/// # Errors
/// [`FileError`] with all that is wrong, where, and what to do about it.
pub fn parse(text: &str, name: impl AsRef<Path>) -> Result<CaseFile, FileError> {
    let path = name.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    let file = files::document(path, text, &mut sources, &mut problems)
        .and_then(|document| read(document, path, &mut sources, &mut problems));
    match file {
        Some(file) if problems.is_empty() => Ok(CaseFile { sources, ..file }),
        _ => Err(problems.into_error(sources)),
    }
}

fn read(
    document: Node,
    path: &Path,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<CaseFile> {
    let Value::Table(entries) = &document.value else { return None };
    let fields = check::table(entries, document.span, &ROOT, problems);
    let parts = parts(&fields);
    let disks = parts.as_ref().map(|parts| parts.disks.count());
    let measured = fields.table("measured").and_then(|table| table.text("disks")).and_then(|csv| {
        let named = document.locate("measured.disks").span;
        read::measured(csv, named, disks, sources, problems)
    });
    let reference = fields.table("reference").and_then(read::reference);
    if let Some(reference) = &reference {
        published(reference, &document, problems);
    }
    // What the checks refused would only be refused again.
    if !problems.is_empty() {
        return None;
    }
    let (robot, case) = assemble(parts?, &document, problems)?;
    let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Some(CaseFile {
        title: fields.text("title").map_or_else(stem, str::to_owned),
        robot,
        case,
        measured,
        reference,
        path: path.to_owned(),
        document,
        // Those that were read are put in when all is well.
        sources: Sources::default(),
    })
}

/// The parts that the tables describe; `None` when one is missing or was refused.
fn parts(fields: &Fields) -> Option<Parts> {
    let backbone = read::backbone(fields.table("backbone")?)?;
    let disks = read::disks(fields.table("disks")?, backbone.length)?;
    let tables = fields.tables("cables");
    let cables = tables.iter().enumerate().map(|(i, table)| read::cable(table, i));
    Some(Parts {
        backbone,
        disks,
        cables: cables.collect::<Option<_>>()?,
        commands: tables.iter().map(read::command).collect(),
        loads: fields.table("loads").map(read::loads).unwrap_or_default(),
    })
}

/// Refuses published values that cannot be.
fn published(reference: &Reference, document: &Node, problems: &mut Problems) {
    let values = [
        ("rms_four_bar", reference.rms_four_bar, limits::DISTANCE),
        ("rms_cosserat", reference.rms_cosserat, limits::DISTANCE),
        ("time_four_bar", reference.time_four_bar, DURATION),
        ("time_cosserat", reference.time_cosserat, DURATION),
    ];
    for (key, value, range) in values {
        if let Some(problem) = value.and_then(|value| range.problem(value)) {
            let path = format!("reference.{key}");
            let span = document.locate(&path).span;
            problems.push(span, || FileProblem::Physical { path, problem });
        }
    }
}
