//! Progress on a terminal, and none in a pipe.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `steps` steps on standard error; invisible where that is no terminal.
pub fn bar(steps: usize) -> ProgressBar {
    let bar = ProgressBar::new(steps as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar
}
