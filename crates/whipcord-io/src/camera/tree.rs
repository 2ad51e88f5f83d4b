//! YAML and JSON with the place of every value: the part of it that OpenCV writes.

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError};

use crate::error::{FileProblem, Problems};
use crate::source::Span;

/// Lists and tables within one another; OpenCV's matrices take two.
const DEEPEST: usize = 16;

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) span: Span,
    pub(super) value: Value,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    /// A number or word; whether it stood in quotes.
    Scalar(String, bool),
    List(Vec<Node>),
    /// Keys with where they stand, in the order of the file.
    Table(Vec<(String, Span, Node)>),
}

impl Node {
    /// The number that it is.
    pub(super) fn number(&self) -> Option<f64> {
        match &self.value {
            Value::Scalar(text, false) => match text.to_ascii_lowercase().as_str() {
                ".nan" => Some(f64::NAN),
                ".inf" | "+.inf" => Some(f64::INFINITY),
                "-.inf" => Some(f64::NEG_INFINITY),
                text if text.starts_with(|c: char| "+-.0123456789".contains(c)) => {
                    text.parse().ok()
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// The text that it is.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Scalar(text, _) => Some(text),
            _ => None,
        }
    }

    /// The entry of a table.
    pub(super) fn get(&self, name: &str) -> Option<&Self> {
        match &self.value {
            Value::Table(entries) => {
                entries.iter().find(|(key, ..)| key == name).map(|(.., node)| node)
            }
            _ => None,
        }
    }
}

/// A list or a table that has begun, and the key that waits for its value.
struct Open {
    node: Node,
    key: Option<(String, Span)>,
}

/// Reads a text; OpenCV's own first line, `%YAML:1.0`, is no YAML and is passed over.
pub(super) fn parse(file: usize, text: &str, problems: &mut Problems) -> Option<Node> {
    let passed_over = text.strip_prefix("%YAML:").map(|rest| format!("#YAML:{rest}"));
    // The parser counts characters.
    let bytes: Vec<usize> = text.char_indices().map(|(byte, _)| byte).collect();
    let byte = |index: usize| bytes.get(index).copied().unwrap_or(text.len());
    let mut open: Vec<Open> = Vec::new();
    let mut root = None;
    for event in Parser::new_from_str(passed_over.as_deref().unwrap_or(text)) {
        let (event, at) = match event {
            Ok(found) => found,
            Err(error) => {
                let at = byte(error.marker().index());
                problems.push(Span::new(file, at, at + 1), || syntax(&error));
                return None;
            }
        };
        let span = Span::new(file, byte(at.start.index()), byte(at.end.index()));
        let done = match event {
            Event::Scalar(word, style, ..) => {
                let quoted = style != ScalarStyle::Plain;
                Node { span, value: Value::Scalar(word.into_owned(), quoted) }
            }
            Event::SequenceStart(..) | Event::MappingStart(..) if open.len() >= DEEPEST => {
                problems.push(span, || FileProblem::TooDeep);
                return None;
            }
            Event::SequenceStart(..) => {
                open.push(Open { node: Node { span, value: Value::List(Vec::new()) }, key: None });
                continue;
            }
            Event::MappingStart(..) => {
                open.push(Open { node: Node { span, value: Value::Table(Vec::new()) }, key: None });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open { mut node, .. }) => {
                    node.span.end = span.end;
                    node
                }
                None => continue,
            },
            Event::Alias(_) => {
                problems.push(span, || FileProblem::Syntax {
                    message: "aliases are not read in camera files".to_owned(),
                    help: "write the value itself in place of the alias".to_owned(),
                });
                return None;
            }
            _ => continue,
        };
        match open.last_mut() {
            None => {
                root.get_or_insert(done);
            }
            Some(Open { node, key }) => match &mut node.value {
                Value::Table(entries) => match key.take() {
                    Some((name, place)) => entries.push((name, place, done)),
                    None => {
                        let name = done.text().unwrap_or_default().to_owned();
                        *key = Some((name, done.span));
                    }
                },
                Value::List(items) => items.push(done),
                Value::Scalar(..) => {}
            },
        }
    }
    if root.is_none() {
        problems.push(Span::new(file, 0, 1), || FileProblem::Syntax {
            message: "the file is empty".to_owned(),
            help: "a camera file has a `camera_matrix`, as OpenCV writes it".to_owned(),
        });
    }
    root
}

fn syntax(error: &ScanError) -> FileProblem {
    FileProblem::Syntax {
        message: format!("this is neither YAML nor JSON: {}", error.info()),
        help: "check the brackets, colons and indents of this line and the one before it"
            .to_owned(),
    }
}
