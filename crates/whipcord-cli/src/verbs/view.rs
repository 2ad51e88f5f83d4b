//! `whipcord view`: a robot in the browser.

use std::io::{self, Write as _};
use std::path::PathBuf;

use clap::Args;
use whipcord::ModelVariant;
use whipcord_viewer::{View, ViewError, export};

use crate::chosen::variant_parser;
use crate::failure::Failure;
use crate::files;
use crate::inputs;
use crate::progress;

/// Move the cables of a robot in the browser
///
/// Serves a page on this machine alone, with a slider for each cable, and opens it in the browser. The
/// page follows the file when it changes. Ctrl-C ends it. With --export, writes a page to be sent instead.
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
    /// Write one page that needs no server, with frames over the ranges of the cables' sliders
    #[arg(long, value_name = "OUT.html", conflicts_with_all = ["port", "no_open"])]
    export: Option<PathBuf>,
    /// Model that the page begins with, or that an exported page has; may be given again. By default the first that
    /// takes the robot
    #[arg(long, value_name = "NAME", value_parser = variant_parser())]
    model: Vec<ModelVariant>,
}

/// Serves the page until the process is ended.
pub fn run(args: &ViewArgs) -> Result<String, Failure> {
    if let Some(out) = &args.export {
        files::keep(out, [args.file.as_path()])?;
        let bar = progress::bar(0);
        let page = export(&args.file, &args.model, |progress| {
            bar.set_length(progress.all as u64);
            bar.set_position(progress.done as u64);
            bar.set_message(format!("solves for {}", progress.model));
        });
        bar.finish_and_clear();
        let page = page.map_err(|error| failure(&error))?;
        files::write(out, page.as_bytes())?;
        return Ok(format!("{}\n", out.display()));
    }
    let view = View::open(&args.file, &args.model, args.port).map_err(|error| failure(&error))?;
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
