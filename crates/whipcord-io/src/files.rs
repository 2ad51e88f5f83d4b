//! Reads files, and the files they extend.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::check::{self, Data};
use crate::error::{FileError, FileProblem, Problems};
use crate::node::{self, Node, Value};
use crate::overlay::{overlay, refuse_removals};
use crate::schema::ROOT;
use crate::source::{Sources, Span};

/// A robot file takes a few kilobytes; one with a thousand disks and a hundred cables half of this.
pub(crate) const LARGEST: usize = 1 << 20;
/// A table of what was measured: a million lines.
pub(crate) const LARGEST_TABLE: usize = 1 << 26;
/// A mesh: two million triangles in binary STL.
pub(crate) const LARGEST_MESH: usize = 1 << 27;
/// The name of standard input on the command line.
const STANDARD_INPUT_ARGUMENT: &str = "-";
/// Files that may extend one another.
const LONGEST_CHAIN: usize = 16;

/// Why a file was not read, with as much of its text as can be shown.
struct Refusal {
    problem: FileProblem,
    text: Option<String>,
    at: usize,
}

/// A photograph of many megapixels has tens of megabytes.
const LARGEST_PHOTOGRAPH: usize = 1 << 28;

/// The bytes of a photograph, of a file that is one with content of its own and not too large.
///
/// # Errors
/// [`FileError`] when it cannot be read.
pub fn read_photograph(path: &Path) -> Result<Vec<u8>, FileError> {
    read_bytes(path, LARGEST_PHOTOGRAPH).map_err(|refusal| {
        let (mut sources, mut problems) = (Sources::default(), Problems::default());
        refuse(path, refusal, None, &mut sources, &mut problems);
        problems.into_error(sources)
    })
}

/// An atlas: twenty thousand shapes of a hundred disks take fifty megabytes.
const LARGEST_ATLAS: usize = 1 << 28;

/// The bytes of an atlas; `None` where there is no file, or why it is not read.
pub(crate) fn read_atlas(path: &Path) -> Result<Option<Vec<u8>>, String> {
    match read_bytes(path, LARGEST_ATLAS) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(Refusal { problem: FileProblem::Unreadable { missing: true, .. }, .. }) => Ok(None),
        Err(Refusal { problem: FileProblem::Unreadable { reason, .. }, .. }) => Err(reason),
        Err(Refusal { problem, .. }) => Err(problem.to_string()),
    }
}

fn read(path: &Path, limit: usize) -> Result<String, Refusal> {
    text_of(read_bytes(path, limit)?)
}

fn unreadable(path: &Path, error: &io::Error) -> Refusal {
    let missing = error.kind() == io::ErrorKind::NotFound;
    let reason = if missing && path.file_name() == Some(OsStr::new(STANDARD_INPUT_ARGUMENT)) {
        "there is no file of this name, and standard input is not read here".to_owned()
    } else {
        reason(error)
    };
    Refusal { problem: FileProblem::Unreadable { reason, missing }, text: None, at: 0 }
}

fn read_bytes(path: &Path, limit: usize) -> Result<Vec<u8>, Refusal> {
    // A pipe without a writer would be waited for, and a device may have no end.
    let kind = fs::metadata(path).map_err(|error| unreadable(path, &error))?.file_type();
    if !kind.is_file() && !kind.is_dir() {
        let reason = "it is not a file with content of its own, but a pipe or a device".to_owned();
        let problem = FileProblem::Unreadable { reason, missing: false };
        return Err(Refusal { problem, text: None, at: 0 });
    }
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    read_limited(file, path, limit)
}

fn read_limited(reader: impl Read, path: &Path, limit: usize) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Vec::new();
    reader
        .take(limit as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| unreadable(path, &error))?;
    if bytes.len() > limit {
        return Err(Refusal { problem: FileProblem::TooLarge { limit }, text: None, at: 0 });
    }
    Ok(bytes)
}

fn text_of(bytes: Vec<u8>) -> Result<String, Refusal> {
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let problem = FileProblem::NotUtf8 { offset: at, byte: bytes[at] };
        // A text in another encoding is worth showing, an image or a program is not.
        let binary = bytes.iter().any(|byte| matches!(byte, 0..=8 | 14..=31));
        let text = (!binary).then(|| String::from_utf8_lossy(bytes).into_owned());
        Refusal { problem, text, at }
    })
}

/// The system's reason in words that are the same on every system.
pub(crate) fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "you may not read it".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    }
}

/// Reads a file that another one names at `named`, of no more than so many bytes. Returns its number
/// and text.
pub(crate) fn read_named(
    path: &Path,
    limit: usize,
    named: Span,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<(usize, String)> {
    let bytes = read_content(path, limit, Some(named), sources, problems)?;
    as_text(path, bytes, Some(named), sources, problems)
}

/// The bytes of a file, which another one may name at `named`.
pub(crate) fn read_content(
    path: &Path,
    limit: usize,
    named: Option<Span>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Vec<u8>> {
    match (read_bytes(path, limit), named) {
        (Ok(bytes), _) => Some(bytes),
        (
            Err(Refusal { problem: FileProblem::Unreadable { reason, missing }, .. }),
            Some(named),
        ) => {
            sources.add(path, None);
            let path = path.display().to_string();
            problems.push(named, || FileProblem::NamedUnreadable { path, reason, missing });
            None
        }
        (Err(refusal), _) => {
            refuse(path, refusal, named, sources, problems);
            None
        }
    }
}

/// The number and the text of a file with these bytes.
pub(crate) fn as_text(
    path: &Path,
    bytes: Vec<u8>,
    named: Option<Span>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<(usize, String)> {
    match text_of(bytes) {
        Ok(text) => Some((sources.add(path, Some(text.clone())), text)),
        Err(refusal) => {
            refuse(path, refusal, named, sources, problems);
            None
        }
    }
}

/// Reads the file that was asked for.
pub(crate) fn read_first(
    path: &Path,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<String> {
    first(read(path, LARGEST), path, sources, problems)
}

/// Reads a stream instead of a file; messages show this name.
pub(crate) fn read_stream(
    stream: impl Read,
    name: &Path,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<String> {
    first(read_limited(stream, name, LARGEST).and_then(text_of), name, sources, problems)
}

fn first(
    read: Result<String, Refusal>,
    path: &Path,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<String> {
    match read {
        Ok(text) => Some(text),
        Err(refusal) => {
            refuse(path, refusal, None, sources, problems);
            None
        }
    }
}

fn refuse(
    path: &Path,
    refusal: Refusal,
    named: Option<Span>,
    sources: &mut Sources,
    problems: &mut Problems,
) {
    let Refusal { problem, text, at } = refusal;
    let file = sources.add(path, text);
    let related = named.map(|span| (span, "it is named here"));
    problems.push_related(Span::new(file, at, at + 1), related, || problem);
}

/// Reads the text as TOML, and lays it over the files it extends.
pub(crate) fn document(
    path: &Path,
    text: &str,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Node> {
    let first = sources.add(path, Some(text.to_owned()));
    let root = node::parse(first, text, problems)?;
    let mut chain = vec![Link::new(path)];
    let mut extends = extended(&root, problems)?;
    let mut layers = vec![root];
    while let Some((named, target)) = extends {
        let path = sources.resolve(named.file, &target);
        let link = Link::new(&path);
        if let Some(start) = chain.iter().position(|earlier| earlier.real == link.real) {
            let names = chain[start..].iter().chain([&link]).map(|link| link.name.clone());
            let chain = names.collect();
            problems.push(named, || FileProblem::CyclicExtends { chain });
            return None;
        }
        if chain.len() >= LONGEST_CHAIN {
            problems.push(named, || FileProblem::TooManyExtends { limit: LONGEST_CHAIN });
            return None;
        }
        chain.push(link);
        let (file, text) = read_named(&path, LARGEST, named, sources, problems)?;
        let lower = node::parse(file, &text, problems)?;
        extends = extended(&lower, problems)?;
        layers.push(lower);
    }
    // From the bottom up, so that each file changes what all those below it say together.
    let mut below = layers.pop()?;
    refuse_removals(below.entries_mut()?, &ROOT, problems);
    while let Some(mut layer) = layers.pop() {
        overlay(layer.entries_mut()?, core::mem::take(below.entries_mut()?), Some(&ROOT), problems);
        refuse_removals(layer.entries_mut()?, &ROOT, problems);
        below = layer;
    }
    Some(below)
}

/// The file that a document extends, if any, and where it says so; `None` when that cannot be told.
fn extended(root: &Node, problems: &mut Problems) -> Option<Option<(Span, String)>> {
    let Value::Table(entries) = &root.value else { return None };
    let Some((entry, key)) = entries.get("extends").zip(ROOT.key("extends")) else {
        return Some(None);
    };
    match check::value(&entry.node, &key.kind, key, problems)? {
        Data::Text(path) => Some(Some((entry.node.span, path))),
        _ => None,
    }
}

/// A file of a chain: as it was named, and what it is however it is named.
struct Link {
    name: String,
    real: PathBuf,
}

impl Link {
    fn new(path: &Path) -> Self {
        let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        Self { name: path.display().to_string(), real }
    }
}
