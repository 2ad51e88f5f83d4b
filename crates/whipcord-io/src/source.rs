//! The texts that were read, and places in them.

use std::path::{Path, PathBuf};

/// What a key that is given beside a file is called in place of a file.
pub(crate) const SETTING: &str = "--set";

/// A place in one of the files that were read: bytes `start..end` of its text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// Number of the file in its [`Sources`].
    pub file: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// A line and a column, both from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

/// A file that was read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Where it was read from, as it was named.
    pub path: PathBuf,
    /// Its text; `None` when it could not be read, or is none.
    pub text: Option<String>,
}

/// All files that one load read, the file that was asked for first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    files: Vec<Source>,
}

impl Source {
    /// What it is called in messages.
    #[must_use]
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Line and column of a byte.
    #[must_use]
    pub fn position(&self, offset: usize) -> Position {
        let text = self.text.as_deref().unwrap_or_default();
        let before = &text.as_bytes()[..offset.min(text.len())];
        let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
        let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        // A byte that continues a character of UTF-8 is no column of its own.
        let column = 1 + before[line_start..].iter().filter(|&&b| b & 0xC0 != 0x80).count();
        Position { line, column }
    }

    /// The text of the line that holds a byte, without its end.
    #[must_use]
    pub fn line_at(&self, offset: usize) -> &str {
        let text = self.text.as_deref().unwrap_or_default();
        let mut offset = offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let start = text[..offset].rfind('\n').map_or(0, |i| i + 1);
        let end = text[offset..].find('\n').map_or(text.len(), |i| offset + i);
        text[start..end].trim_end_matches('\r')
    }
}

impl Sources {
    /// Adds a file and returns its number.
    pub(crate) fn add(&mut self, path: &Path, text: Option<String>) -> usize {
        self.files.push(Source { path: path.to_owned(), text });
        self.files.len() - 1
    }

    /// The file a span lies in.
    #[must_use]
    pub fn get(&self, file: usize) -> Option<&Source> {
        self.files.get(file)
    }

    /// All files, the one that was asked for first.
    #[must_use]
    pub fn files(&self) -> &[Source] {
        &self.files
    }

    /// Whether this is no file, but a key that is given beside one.
    pub(crate) fn is_setting(&self, file: usize) -> bool {
        self.get(file).is_some_and(|source| source.path == Path::new(SETTING))
    }

    /// A path that a file names, relative to the folder of that file.
    pub(crate) fn resolve(&self, file: usize, path: &str) -> PathBuf {
        let folder = self.get(file).and_then(|source| source.path.parent());
        folder.map_or_else(|| PathBuf::from(path), |folder| folder.join(path))
    }
}

impl Span {
    pub(crate) const fn new(file: usize, start: usize, end: usize) -> Self {
        Self { file, start, end }
    }
}

/// A text of the user's as it is quoted in a message: short, on one line, printable.
pub(crate) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut short: String = text.chars().take(LONGEST).map(printable).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push_str("...");
    }
    short
}

/// The character itself, or a stand-in for one that would disturb a terminal.
pub(crate) fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        // Marks that reverse or hide the text around them.
        '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' => '?',
        '\u{feff}' | '\u{fffd}' => '?',
        c if c.is_control() => '?',
        c => c,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters() {
        let source = Source { path: "a".into(), text: Some("µ = 1\r\nab\n".into()) };
        assert_eq!(source.position(0), Position { line: 1, column: 1 });
        assert_eq!(source.position(5), Position { line: 1, column: 5 });
        assert_eq!(source.position(9), Position { line: 2, column: 2 });
        assert_eq!(source.position(99), Position { line: 3, column: 1 });
        assert_eq!(source.line_at(1), "µ = 1");
        assert_eq!(source.line_at(9), "ab");
        assert_eq!(source.line_at(99), "");
    }
}
