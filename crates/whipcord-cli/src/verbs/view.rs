//! `whipcord view`: a robot in the browser.

use std::fmt::Display;
use std::io::{self, BufReader, Write as _};
use std::path::PathBuf;

use clap::Args;
use whipcord::ModelPreset;
use whipcord_viewer::{View, ViewError, export};

use crate::model_arguments::preset_parser;
use crate::progress;
use whipcord_study::failure::Failure;
use whipcord_study::files;

/// Lines of a stream that are complained of: a program that writes nothing but wrong ones is known by then.
const MOST_COMPLAINTS: usize = 20;

/// Move the cables of a robot in the browser
///
/// Serves a page to this machine only, with a slider for each cable, and opens it in the browser.
/// The page is updated when the file changes. Ctrl-C stops the server. --export writes a
/// stand-alone page instead.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Robot file
    file: PathBuf,
    /// Local port; by default a free one
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Print the address without opening the browser
    #[arg(long)]
    no_open: bool,
    /// Another robot file, shown beside the first; may be given several times
    #[arg(long, value_name = "FILE", conflicts_with = "export")]
    beside: Vec<PathBuf>,
    /// Show shapes from standard input as they come, one JSON object per line, with `shapes`, a list
    /// of one object for each robot with `arc_length`, `positions`, `orientations` and optionally
    /// `tensions`; and optionally `time` and `measured`, the positions of markers
    #[arg(long, conflicts_with = "export")]
    stream: bool,
    /// Write a page that needs no server, with precomputed shapes over the ranges of the cable
    /// sliders
    #[arg(long, value_name = "OUT.html", conflicts_with_all = ["port", "no_open"])]
    export: Option<PathBuf>,
    /// Model shown first, or the models of an exported page; may be given several times; by default
    /// the first model that accepts the robot
    #[arg(long, value_name = "NAME", value_parser = preset_parser())]
    model: Vec<ModelPreset>,
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
    let mut view =
        view.beside(args.beside.iter().map(PathBuf::as_path)).map_err(|error| failure(&error))?;
    if args.stream {
        let mut said = 0;
        let complain = move |why: &dyn Display| {
            said += 1;
            if said <= MOST_COMPLAINTS {
                let _ = writeln!(io::stderr(), "warning: {why}");
            }
        };
        let lines = BufReader::new(io::stdin());
        view.stream(lines, complain).map_err(|error| failure(&error))?;
    }
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
        ViewError::File(error) => Failure::Input(whipcord_study::failure::message(error)),
        error => Failure::Input(format!("error: {error}")),
    }
}
