//! Emphasis on a terminal, plain text everywhere else.

use std::env;
use std::fmt::Display;
use std::io::{IsTerminal, stderr, stdout};

/// Whether text is emphasised.
#[derive(Clone, Copy, Debug, Default)]
pub struct Style {
    enabled: bool,
}

impl Style {
    /// For standard output.
    pub fn for_stdout() -> Self {
        Self { enabled: stdout().is_terminal() && is_wanted() }
    }

    /// For standard error.
    pub fn for_stderr() -> Self {
        Self { enabled: stderr().is_terminal() && is_wanted() }
    }

    /// Whether text is emphasised.
    pub const fn is_enabled(self) -> bool {
        self.enabled
    }

    /// A heading.
    pub fn heading(self, text: impl Display) -> String {
        self.wrap("1", text)
    }

    /// What is less important.
    pub fn faint(self, text: impl Display) -> String {
        self.wrap("2", text)
    }

    fn wrap(self, code: &str, text: impl Display) -> String {
        if self.enabled { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_string() }
    }
}

/// Whether the user has not asked for plain text.
fn is_wanted() -> bool {
    let unwanted = env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
        || env::var_os("TERM").is_some_and(|value| value == "dumb");
    !unwanted
}
