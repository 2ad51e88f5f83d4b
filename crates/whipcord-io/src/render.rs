//! Messages for people.

use core::fmt::Write as _;

use crate::case_file::CaseFile;
use crate::error::FileError;
use crate::source::{Source, Sources, Span, printable};
use crate::warnings::FileWarning;

/// Problems that are printed in full.
const MOST_SHOWN: usize = 10;
/// Characters of a source line that are shown, and how many of them before the marked place.
const WIDEST: usize = 96;
const BEFORE: usize = 40;

/// Everything that is wrong with a file: for each problem its place as `file:line:column`, the
/// cause, the source line with a mark, and the remedy. Plain text, or with the colours of a
/// terminal.
#[must_use]
pub fn render(error: &FileError, colour: bool) -> String {
    let style = if colour { &COLOUR } else { &PLAIN };
    let mut out = String::new();
    for (i, diagnostic) in error.problems.iter().take(MOST_SHOWN).enumerate() {
        if i > 0 {
            out.push('\n');
        }
        let message = Message {
            kind: Kind::Error,
            text: diagnostic.problem.to_string(),
            help: diagnostic.problem.help(),
            span: diagnostic.span,
            related: diagnostic.related,
        };
        message.write(&mut out, &error.sources, style);
    }
    let rest = error.more + error.problems.len().saturating_sub(MOST_SHOWN);
    if rest > 0 {
        let word = if rest == 1 { "problem" } else { "problems" };
        let _ = writeln!(out, "\n... and {rest} more {word}");
    }
    out
}

/// Escape sequences before each part of a message; `end` after it.
struct Style {
    place: &'static str,
    error: &'static str,
    warning: &'static str,
    note: &'static str,
    help: &'static str,
    end: &'static str,
}

const PLAIN: Style = Style { place: "", error: "", warning: "", note: "", help: "", end: "" };
const COLOUR: Style = Style {
    place: "\x1b[1m",
    error: "\x1b[1;31m",
    warning: "\x1b[1;33m",
    note: "\x1b[1;34m",
    help: "\x1b[1;32m",
    end: "\x1b[0m",
};

/// How much a message matters.
#[derive(Clone, Copy)]
enum Kind {
    Error,
    Warning,
}

impl Kind {
    const fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// A message about a place in a file.
struct Message {
    kind: Kind,
    text: String,
    help: String,
    span: Span,
    related: Option<(Span, &'static str)>,
}

impl Style {
    const fn of(&self, kind: Kind) -> &'static str {
        match kind {
            Kind::Error => self.error,
            Kind::Warning => self.warning,
        }
    }
}

impl Message {
    fn write(&self, out: &mut String, sources: &Sources, style: &Style) {
        let Style { note, help, end, .. } = style;
        let excerpt = |out: &mut String, span: Span, label: &str, mark: char, colour: &str| {
            let Some(source) = sources.get(span.file) else { return };
            let position = source.position(span.start);
            let place: String = source.name().chars().map(printable).collect();
            let _ = writeln!(
                out,
                "{}{place}:{}:{}:{end} {label}",
                style.place, position.line, position.column
            );
            marked_line(out, source, span, position.line, mark, colour, end);
        };
        let colour = style.of(self.kind);
        let label = format!("{colour}{}:{end} {}", self.kind.word(), self.text);
        excerpt(out, self.span, &label, '^', colour);
        if let Some((span, what)) = self.related {
            excerpt(out, span, &format!("{note}note:{end} {what}"), '-', note);
        }
        let _ = writeln!(out, "  {help}help:{end} {}", self.help);
    }
}

/// Warnings about a file as people read them, at most ten in full: as [`render`] shows errors, and without
/// a place those that no key is at fault for.
#[must_use]
pub fn render_warnings(file: &CaseFile, warnings: &[FileWarning], colour: bool) -> String {
    let style = if colour { &COLOUR } else { &PLAIN };
    let mut out = String::new();
    for (i, warning) in warnings.iter().take(MOST_SHOWN).enumerate() {
        if i > 0 {
            out.push('\n');
        }
        let (text, help) = (warning.message(), warning.warning.help());
        if let Some(span) = warning.span {
            let message = Message { kind: Kind::Warning, text, help, span, related: None };
            message.write(&mut out, file.sources(), style);
        } else {
            let Style { warning: colour, help: help_colour, place, end, .. } = style;
            let path: String = file.path.display().to_string().chars().map(printable).collect();
            let _ = writeln!(out, "{colour}warning:{end} {place}{path}:{end} {text}");
            let _ = writeln!(out, "  {help_colour}help:{end} {help}");
        }
    }
    let rest = warnings.len().saturating_sub(MOST_SHOWN);
    if rest > 0 {
        let word = if rest == 1 { "warning" } else { "warnings" };
        let _ = writeln!(out, "\n... and {rest} more {word}");
    }
    out
}

/// The source line, cut to a width that fits a terminal, and the mark beneath.
fn marked_line(
    out: &mut String,
    source: &Source,
    span: Span,
    number: usize,
    mark: char,
    colour: &str,
    end: &str,
) {
    // A file that has no text shows its name, so that the mark has something to point at.
    let name = source.path.file_name().unwrap_or_default().to_string_lossy();
    let (gutter, line, column, width) = match &source.text {
        None => (String::new(), name.as_ref(), 0, name.chars().count()),
        Some(text) => {
            let line = source.line_at(span.start);
            let column = source.position(span.start).column - 1;
            let marked = text.get(span.start..span.end.min(text.len())).unwrap_or_default();
            let first = marked.split(['\r', '\n']).next().unwrap_or_default();
            (number.to_string(), line, column, first.chars().count())
        }
    };
    let length = line.chars().count();
    let skipped = if length <= WIDEST { 0 } else { column.saturating_sub(BEFORE) };
    let shown: String = line.chars().skip(skipped).take(WIDEST).map(printable).collect();
    let lead = if skipped > 0 { "..." } else { "" };
    let trail = if length > skipped + WIDEST { "..." } else { "" };
    let room = (WIDEST + skipped).saturating_sub(column).max(1);
    let marks = mark.to_string().repeat(width.clamp(1, room));
    let indent = " ".repeat(lead.len() + column - skipped);
    let margin = gutter.len().max(3);
    let numbered = format!("{gutter:>margin$} | {lead}{shown}{trail}");
    let _ = writeln!(out, "{}", numbered.trim_end());
    let _ = writeln!(out, "{:>margin$} | {indent}{colour}{marks}{end}", "");
}
