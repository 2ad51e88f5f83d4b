//! The `whipcord` command: one verb for each question about a robot.
//!
//! A library of one function, so that the Python package carries the same command, and of what the package says in
//! the words of the command.

mod benchmark;
mod chosen;
mod comparison;
mod failure;
mod files;
pub mod fitting;
mod html;
mod inputs;
pub mod judging;
mod paths;
mod photographs;
mod progress;
mod quantity;
mod rubbing;
mod statistics;
mod steps;
mod style;
mod suite;
mod superposition;
mod table;
mod timing;
mod touches;
mod trial;
mod verbs;
mod words;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process;

use clap::{Parser, Subcommand};

use crate::failure::Failure;
use crate::style::Style;
use crate::verbs::{
    bench, camera, check, compare, fit, measure, overlay, schema, solve, stiffness, view,
};

/// Mechanics of cable-driven continuum robots with any cable routing
#[derive(Debug, Parser)]
#[command(name = "whipcord", version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Solve(solve::SolveArgs),
    Stiffness(stiffness::StiffnessArgs),
    Compare(compare::CompareArgs),
    Fit(fit::FitArgs),
    Measure(measure::MeasureArgs),
    Camera(camera::CameraArgs),
    Overlay(overlay::OverlayArgs),
    Bench(bench::BenchArgs),
    Check(check::CheckArgs),
    View(view::ViewArgs),
    Schema(schema::SchemaArgs),
}

/// Exit status of a process that Ctrl-C has ended, as shells have it.
const INTERRUPTED: i32 = 130;
/// Exit status after bad input or usage.
const USAGE: u8 = 2;

/// Runs the command with these arguments, the first being its own name, and returns its exit status.
/// Ctrl-C ends the process.
pub fn run<I, T>(arguments: I) -> u8
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    // Without the handler the process ends all the same, but may leave a temporary file behind.
    let _ = ctrlc::set_handler(|| {
        whipcord_io::remove_unfinished();
        process::exit(INTERRUPTED);
    });
    let verb = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli.verb,
        Err(error) => {
            // When standard error is gone too, the exit status still tells.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(USAGE);
        }
    };
    let style = Style::for_stdout();
    let outcome = match verb {
        Verb::Solve(args) => solve::run(&args, style),
        Verb::Stiffness(args) => stiffness::run(&args, style),
        Verb::Compare(args) => compare::run(&args, style),
        Verb::Fit(args) => fit::run(&args, style),
        Verb::Measure(args) => measure::run(&args, style),
        Verb::Camera(args) => camera::run(&args, style),
        Verb::Overlay(args) => overlay::run(&args, style),
        Verb::Bench(args) => bench::run(&args, style),
        Verb::Check(args) => check::run(&args, style),
        Verb::View(args) => view::run(&args),
        Verb::Schema(args) => schema::run(&args),
    };
    match outcome {
        Ok(text) => print(&text),
        Err(failure) => {
            if let Failure::Partial { text, .. } = &failure {
                print(text);
            }
            // When standard error is gone too, the exit status still tells.
            let _ = writeln!(io::stderr(), "{failure}");
            failure.exit_status()
        }
    }
}

/// Writes to standard output. A reader that has seen enough (`| head`) is no failure.
fn print(text: &str) -> u8 {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            let _ = writeln!(io::stderr(), "error: cannot write to standard output: {error}");
            USAGE
        }
        _ => 0,
    }
}
