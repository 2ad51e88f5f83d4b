//! `whipcord view`: a robot in the browser.

use std::io::{self, Write as _};
use std::path::PathBuf;

use clap::Args;
use whipcord_viewer::{View, ViewError};

use crate::failure::Failure;
use crate::inputs;

/// Move the cables of a robot in the browser
///
/// Serves a page on this machine alone, with a slider for each cable, and opens it in the browser. The
/// page follows the file when it changes. Ctrl-C ends it.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Robot file
    file: PathBuf,
    /// Port of this machine; by default one that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Print the address and leave the browser alone
    #[arg(long)]
    no_open: bool,
}

/// Serves the page until the process is ended.
pub fn run(args: &ViewArgs) -> Result<String, Failure> {
    let view = View::open(&args.file, args.port).map_err(|error| failure(&error))?;
    // Who waits for the address may read it from a pipe.
    let mut out = io::stdout().lock();
    let _ = writeln!(out, "{}", view.url()).and_then(|()| out.flush());
    drop(out);
    if !args.no_open {
        view.show();
    }
    view.serve().map_err(|error| failure(&error))?;
    Ok(String::new())
}

fn failure(error: &ViewError) -> Failure {
    match error {
        ViewError::File(error) => Failure::Input(inputs::message(error)),
        error => Failure::Input(format!("error: {error}")),
    }
}
