//! What can be wrong with a robot file.

use core::fmt;
use std::borrow::Cow;

use thiserror::Error;
use whipcord::robot::in_words;
use whipcord::robot::limits::number;
use whipcord::{ModelKind, Problem};
use whipcord_estimation::identification::UnknownGroup;

use crate::source::{Sources, Span, quoted};
use crate::units::{Dimension, QuantityError, listed};

/// Problems beyond this many are counted, not kept: a file of garbage has one per line.
const MOST_KEPT: usize = 100;

/// A robot file that cannot be used, with everything that is wrong with it.
///
/// Its `Display` is the full message with places, source lines and remedies;
/// [`render`](crate::render()) gives the same in colour.
#[derive(Clone, Debug, PartialEq)]
pub struct FileError {
    /// What is wrong, in the order of the file; at least one.
    pub problems: Vec<Diagnostic>,
    /// How many more problems there are that were not kept.
    pub more: usize,
    /// The files that were read, and those that they name and that could not be.
    pub sources: Sources,
}

/// One problem and where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// What is wrong.
    pub problem: FileProblem,
    /// Where.
    pub span: Span,
    /// Another place that has to do with it, and how.
    pub related: Option<(Span, &'static str)>,
}

/// A motor and what it is told.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandedMotor {
    /// Its name, in quotes.
    pub name: String,
    /// Its command in rad or m.
    pub command: f64,
    /// Whether that is an angle.
    pub is_angle: bool,
}

/// What is wrong with a file. [`FileProblem::help`] says what to do about it.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FileProblem {
    /// The file cannot be read.
    #[error("cannot read this file: {reason}")]
    Unreadable {
        /// What the operating system says.
        reason: String,
        /// Whether there is no such file.
        missing: bool,
    },
    /// A file that another one names cannot be read.
    #[error("cannot read `{path}`: {reason}")]
    NamedUnreadable {
        /// The file.
        path: String,
        /// What the operating system says.
        reason: String,
        /// Whether there is no such file.
        missing: bool,
    },
    /// The file is larger than any robot file.
    #[error("the file has more than {limit} bytes")]
    TooLarge {
        /// Most bytes that are read.
        limit: usize,
    },
    /// The file is not text.
    #[error("the file is not UTF-8 text: byte {offset} is 0x{byte:02X}")]
    NotUtf8 {
        /// First byte that is not text, from 0.
        offset: usize,
        /// The byte.
        byte: u8,
    },
    /// The file is not TOML.
    #[error("{message}")]
    Syntax {
        /// What the parser says.
        message: String,
        /// What to do.
        help: String,
    },
    /// Lists or tables nested beyond reason.
    #[error("lists, tables or dotted keys are nested too deeply here")]
    TooDeep,
    /// Files that extend one another in a ring.
    #[error("`extends` goes round in a circle: {}", chain.join(" -> "))]
    CyclicExtends {
        /// The files, the first and the last being the same.
        chain: Vec<String>,
    },
    /// Too many files that extend one another.
    #[error("more than {limit} files extend one another")]
    TooManyExtends {
        /// Most files that are followed.
        limit: usize,
    },
    /// A key that the table does not have.
    #[error("there is no key `{key}` in {table}")]
    UnknownKey {
        /// The key.
        key: String,
        /// Title of the table.
        table: &'static str,
        /// What to do.
        help: String,
    },
    /// A path of nothing that can be estimated.
    #[error("`{path}` is nothing that can be estimated")]
    UnknownQuantity {
        /// The path.
        path: String,
        /// The path that is most like it.
        near: Option<&'static str>,
    },
    /// A path with a name that no cables or motors have.
    #[error("no {} are called `{}`, and none belong to a group of this name", .0.list, quoted(&.0.name))]
    UnknownGroup(UnknownGroup),
    /// Something is said of an unknown that is none.
    #[error("`{path}` is not estimated")]
    NotEstimated {
        /// The path.
        path: String,
    },
    /// An entry without a name in a file that extends one with entries.
    #[error("{table} needs a `name` here: the file that this one extends has {what}s")]
    NoNameToMerge {
        /// What an entry is.
        what: &'static str,
        /// Title of the table.
        table: &'static str,
        /// Names of the entries of the other file.
        names: Vec<String>,
    },
    /// Two entries of one file for the same entry of a file that it extends.
    #[error("{what} `{name}` has two entries in this file")]
    GivenTwice {
        /// What an entry is.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// An entry is to be removed that is not there.
    #[error("there is no {what} `{name}` to remove")]
    NothingToRemove {
        /// What an entry is.
        what: &'static str,
        /// Its name.
        name: String,
        /// Names of those that there are.
        names: Vec<String>,
    },
    /// A table is to be removed that is not there.
    #[error("there is no {table} to remove")]
    NoTableToRemove {
        /// Header of the table.
        table: &'static str,
    },
    /// A key that must be there.
    #[error("{table} has no {key}")]
    Missing {
        /// The key, in quotes, or the header of the table.
        key: String,
        /// Title of the table.
        table: &'static str,
        /// A line that would do.
        example: String,
    },
    /// None of several keys of which one must be there.
    #[error("{table} has neither {}", listed(keys.iter().map(|k| k.as_str()), "nor"))]
    MissingOneOf {
        /// The keys, in quotes.
        keys: Vec<String>,
        /// Title of the table.
        table: &'static str,
        /// Whether only one of them may be given.
        exclusive: bool,
        /// A line that would do.
        example: String,
    },
    /// Two keys that exclude one another.
    #[error("`{second}` cannot stand beside `{first}` in {table}")]
    Exclusive {
        /// The key that comes first.
        first: &'static str,
        /// The other one.
        second: &'static str,
        /// Title of the table.
        table: &'static str,
    },
    /// A key that makes sense only with another one.
    #[error("`{key}` in {table} needs {} beside it", listed(needs.iter().map(|k| k.as_str()), "or"))]
    Needs {
        /// The key.
        key: &'static str,
        /// What it needs, in quotes.
        needs: Vec<String>,
        /// Title of the table.
        table: &'static str,
        /// A line that would do.
        example: String,
    },
    /// A value of the wrong type.
    #[error("`{key}` must be {expected}, but is {found}")]
    WrongType {
        /// The key.
        key: &'static str,
        /// What it must be.
        expected: String,
        /// What it is.
        found: &'static str,
        /// What to do.
        help: String,
    },
    /// A text that is not a quantity of the right kind.
    #[error("{error}, but `{key}` must be {}", dimensions(expected))]
    Quantity {
        /// The key.
        key: &'static str,
        /// What is wrong with the text.
        error: QuantityError,
        /// What it must be.
        expected: &'static [Dimension],
    },
    /// Not a number, or infinite.
    #[error("`{key}` must be a finite number, but is {value}")]
    NotFinite {
        /// The key.
        key: &'static str,
        /// The value.
        value: f64,
    },
    /// A whole number out of its range.
    #[error("{}", out_of_range(key, *value, *least, *greatest, *numbers))]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// The value.
        value: i64,
        /// Least value.
        least: usize,
        /// Greatest value.
        greatest: usize,
        /// Whether it is the number of a thing, such as a hole, and one of a list.
        numbers: bool,
    },
    /// A list of the wrong length.
    #[error("`{key}` must have {expected} values, but has {given}")]
    WrongCount {
        /// The key.
        key: &'static str,
        /// Values needed.
        expected: usize,
        /// Values given.
        given: usize,
    },
    /// A list or text without content.
    #[error("`{key}` is empty")]
    Empty {
        /// The key.
        key: &'static str,
        /// A value as it may be.
        example: String,
    },
    /// None of the words that are understood.
    #[error("`{value}` is no `{key}`")]
    UnknownChoice {
        /// The key.
        key: &'static str,
        /// The word.
        value: String,
        /// The words that are understood.
        choices: Vec<&'static str>,
        /// The nearest of them.
        near: Option<&'static str>,
    },
    /// A quantity that cannot be, or that does not fit the others.
    #[error("{}", physical(path, problem))]
    Physical {
        /// Which quantity, as the library names it; cables count from 0.
        path: String,
        /// What is wrong with it.
        problem: Problem,
    },
    /// A cable that is shortened by more than its whole length.
    #[error(
        "{} is {} m, but the cable is only {:.4} m long", in_words(path), number(*value), length
    )]
    ShorterThanNothing {
        /// Which shortening, as the library names it; cables count from 0.
        path: String,
        /// By how much it is shortened, in m.
        value: f64,
        /// Length of its part inside the robot before actuation, in m.
        length: f64,
        /// The number, where the file gives it without a unit.
        without_unit: Option<String>,
        /// The motor that the shortening comes from.
        motor: Option<Box<CommandedMotor>>,
    },
    /// A motor that names a cable that there is not.
    #[error("there is no cable `{name}`")]
    UnknownCable {
        /// The name, in quotes.
        name: String,
        /// Names of the cables, in quotes.
        names: Vec<String>,
    },
    /// An angle where a length is needed, or the other way round.
    #[error("`{key}` of {what} must be {expected}")]
    OtherDrive {
        /// The key.
        key: &'static str,
        /// Which motor.
        what: String,
        /// What it must be.
        expected: &'static str,
    },
    /// A quantity that is not given, and that the model needs.
    #[error("the {model} model needs {}", in_words(path))]
    Needed {
        /// The model.
        model: ModelKind,
        /// Which quantity, as the library names it; cables count from 0.
        path: String,
        /// What to do.
        help: &'static str,
    },
    /// A part of the robot or of the case that the model cannot take.
    #[error("the {model} model cannot take {} ({what})", in_words(path))]
    NotTaken {
        /// The model.
        model: ModelKind,
        /// Which part, as the library names it; cables count from 0.
        path: String,
        /// What it is.
        what: &'static str,
        /// What to do.
        help: &'static str,
    },
    /// A camera that its file does not describe.
    #[error("{message}")]
    Camera {
        /// What is wrong.
        message: String,
        /// What to do.
        help: String,
    },
    /// A file that is no triangle mesh.
    #[error("cannot read `{path}` as a triangle mesh: {reason}")]
    Mesh {
        /// The file.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A line of a table of measured positions.
    #[error("{message}")]
    Measured {
        /// What is wrong.
        message: String,
        /// What to do.
        help: Cow<'static, str>,
    },
}

/// What the library says of a quantity, as a sentence.
fn physical(path: &str, problem: &Problem) -> String {
    let said = problem.to_string();
    let predicate = ["must ", "has ", "names ", "lies ", "is ", "make ", "makes "]
        .iter()
        .any(|verb| said.starts_with(verb));
    format!("{}{} {said}", in_words(path), if predicate { "" } else { ":" })
}

fn out_of_range(key: &str, value: i64, least: usize, greatest: usize, numbers: bool) -> String {
    if numbers && value < 1 {
        format!("there is no hole {value}: `{key}` count from 1")
    } else {
        format!("`{key}` must be {}, but is {value}", bound(value, least, greatest))
    }
}

fn bound(value: i64, least: usize, greatest: usize) -> String {
    if i64::try_from(least).is_ok_and(|least| value < least) {
        format!("at least {least}")
    } else {
        format!("at most {greatest}")
    }
}

fn dimensions(expected: &[Dimension]) -> String {
    let names: Vec<String> =
        expected.iter().map(|d| crate::schema::article(&d.to_string())).collect();
    names.join(" or ")
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&crate::render(self, false))
    }
}

impl std::error::Error for FileError {}

/// The problems found so far.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    list: Vec<Diagnostic>,
    more: usize,
}

impl Problems {
    /// Adds one; its message is made only if it is kept.
    pub(crate) fn push(&mut self, span: Span, problem: impl FnOnce() -> FileProblem) {
        self.push_related(span, None, problem);
    }

    pub(crate) fn push_related(
        &mut self,
        span: Span,
        related: Option<(Span, &'static str)>,
        problem: impl FnOnce() -> FileProblem,
    ) {
        if self.is_full() {
            self.more += 1;
        } else {
            self.list.push(Diagnostic { problem: problem(), span, related });
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether further problems are only counted.
    pub(crate) fn is_full(&self) -> bool {
        self.list.len() >= MOST_KEPT
    }

    /// The error of these problems.
    pub(crate) fn into_error(mut self, sources: Sources) -> FileError {
        self.list.sort_by_key(|diagnostic| diagnostic.span);
        FileError { problems: self.list, more: self.more, sources }
    }
}
