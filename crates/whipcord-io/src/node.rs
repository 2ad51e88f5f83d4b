//! A TOML document with the place of every value.

use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml_parser::Source;
use toml_parser::lexer::TokenKind;

use crate::error::{FileProblem, Problems};
use crate::source::Span;
use crate::syntax;

/// Parts of a dotted key; the contract's longest has three.
const DEEPEST_KEY: usize = 16;

/// Bytes of a text beyond which only its first error is asked for: garbage has one in every token.
const LONG: usize = 1 << 16;

/// A value and where it stands. A table that has a header stands there.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub span: Span,
    pub value: Value,
}

#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    /// A number with a decimal point or exponent, or an integer beyond 64 bits.
    Number(f64),
    Flag(bool),
    Date,
    List(Vec<Node>),
    Table(Entries),
}

pub(crate) type Entries = BTreeMap<String, Entry>;

/// A key of a table with its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub key_span: Span,
    pub node: Node,
}

impl Value {
    /// What messages call a value of this type.
    pub(crate) const fn type_name(&self) -> &'static str {
        match self {
            Self::Text(_) => "a text",
            Self::Integer(_) | Self::Number(_) => "a number",
            Self::Flag(_) => "a truth value",
            Self::Date => "a date",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
        }
    }
}

impl Node {
    /// Whether it is a table with this key.
    pub(crate) fn has(&self, key: &str) -> bool {
        matches!(&self.value, Value::Table(entries) if entries.contains_key(key))
    }

    /// The value on a path such as `cables[1].holes[3]`, if it is there.
    pub(crate) fn find(&self, path: &str) -> Option<&Self> {
        path.split(['.', '[']).try_fold(self, |node, part| node.part(part))
    }

    /// The deepest value on a path such as `cables[1].holes[3]` that is there.
    pub(crate) fn locate(&self, path: &str) -> &Self {
        let mut node = self;
        for part in path.split(['.', '[']) {
            match node.part(part) {
                Some(next) => node = next,
                None => break,
            }
        }
        node
    }

    /// The value of a key, or the entry of a list of a number that a bracket may follow.
    fn part(&self, part: &str) -> Option<&Self> {
        let part = part.trim_end_matches(']');
        match &self.value {
            Value::Table(entries) => entries.get(part).map(|entry| &entry.node),
            Value::List(items) => part.parse().ok().and_then(|i: usize| items.get(i)),
            _ => None,
        }
    }
}

/// Reads the text of file number `file` as TOML. Every error goes to `problems`; there is a tree
/// only when there was none.
pub(crate) fn parse(file: usize, text: &str, problems: &mut Problems) -> Option<Node> {
    if let Some(span) = deep_key(file, text) {
        problems.push(span, || FileProblem::TooDeep);
        return None;
    }
    let (table, mut errors) = if text.len() > LONG {
        match DeTable::parse(text) {
            Ok(table) => (table, Vec::new()),
            Err(error) => (Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    } else {
        DeTable::parse_recoverable(text)
    };
    if errors.is_empty() {
        return Some(table_node(file, table));
    }
    // One slip makes the parser stumble several times; the first place on each line tells most.
    errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
    let mut last_line_end = None;
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        if last_line_end.is_some_and(|end| span.start <= end) {
            continue;
        }
        let at = span.start.min(text.len());
        last_line_end = Some(
            text.as_bytes()[at..].iter().position(|&b| b == b'\n').map_or(text.len(), |i| at + i),
        );
        let at_fault = text.get(span.clone()).unwrap_or_default();
        problems.push(Span::new(file, span.start, span.end), || {
            syntax::problem(error.message(), at_fault)
        });
    }
    None
}

/// Reads a text of file number `file` that begins at byte `at` of it as one value of TOML, if it is one.
pub(crate) fn parse_value(file: usize, at: usize, text: &str) -> Option<Node> {
    const KEY: &str = "v=";
    let source = format!("{KEY}{text}");
    if deep_key(file, &source).is_some() {
        return None;
    }
    let mut entries = entries(file, DeTable::parse(&source).ok()?.into_inner());
    let mut node = entries.remove("v").filter(|_| entries.is_empty())?.node;
    shift(&mut node, at, KEY.len());
    Some(node)
}

/// Moves a value from behind `from` bytes to behind `to` bytes.
fn shift(node: &mut Node, to: usize, from: usize) {
    let moved = |offset: usize| (offset + to).saturating_sub(from);
    node.span = Span::new(node.span.file, moved(node.span.start), moved(node.span.end));
    match &mut node.value {
        Value::List(items) => items.iter_mut().for_each(|item| shift(item, to, from)),
        Value::Table(entries) => {
            for entry in entries.values_mut() {
                let span = entry.key_span;
                entry.key_span = Span::new(span.file, moved(span.start), moved(span.end));
                shift(&mut entry.node, to, from);
            }
        }
        _ => {}
    }
}

/// A key of too many parts, whose tables would lie too deep in one another to be walked.
fn deep_key(file: usize, text: &str) -> Option<Span> {
    let mut dots = 0;
    for token in Source::new(text).lex() {
        match token.kind() {
            TokenKind::Dot => dots += 1,
            TokenKind::Newline
            | TokenKind::Comma
            | TokenKind::Equals
            | TokenKind::LeftSquareBracket
            | TokenKind::LeftCurlyBracket => dots = 0,
            _ => {}
        }
        if dots >= DEEPEST_KEY {
            let span = token.span();
            return Some(Span::new(file, span.start(), span.end()));
        }
    }
    None
}

fn table_node(file: usize, table: Spanned<DeTable<'_>>) -> Node {
    let span = table.span();
    let entries = entries(file, table.into_inner());
    Node { span: Span::new(file, span.start, span.end), value: Value::Table(entries) }
}

fn entries(file: usize, table: DeTable<'_>) -> Entries {
    table
        .into_iter()
        .map(|(key, value)| {
            let span = key.span();
            let key_span = Span::new(file, span.start, span.end);
            (key.into_inner().into_owned(), Entry { key_span, node: node(file, value) })
        })
        .collect()
}

fn node(file: usize, value: Spanned<DeValue<'_>>) -> Node {
    let span = value.span();
    let span = Span::new(file, span.start, span.end);
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .map_or_else(|_| Value::Number(huge(integer.as_str())), Value::Integer),
        DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => {
            Value::List(items.into_iter().map(|item| node(file, item)).collect())
        }
        DeValue::Table(table) => Value::Table(entries(file, table)),
    };
    Node { span, value }
}

/// An integer beyond 64 bits, to the nearest number; without bound when it is not decimal.
fn huge(digits: &str) -> f64 {
    digits.parse().unwrap_or(f64::INFINITY)
}
