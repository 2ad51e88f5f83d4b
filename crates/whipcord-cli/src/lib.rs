//! The `whipcord` command: one verb for each question about a robot.
//!
//! A library of one function, so that the Python package carries the same command, and of what the package says in
//! the words of the command.

mod deadline;
pub mod examples;
mod film;
mod goal;
mod inputs;
mod inverse;
mod model_arguments;
mod motion;
mod path_argument;
mod paths;
mod photographs;
mod progress;
mod rubbing;
mod smooth;
mod superposition;
mod target_argument;
mod template;
mod tips;
mod verbs;
mod warnings;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process;
use std::time::Duration;

use clap::{Parser, Subcommand};

use crate::deadline::{Deadline, Limit, Over};
use crate::verbs::{
    bench, camera, check, compare, completions, design, examples as examples_verb, export, fit,
    man, measure, measure_stereo, modes, new, overlay, reach, schema, score, simulate, solve,
    stiffness, sweep, view, workspace,
};
use whipcord_study::failure::Failure;
use whipcord_study::style::Style;

/// Mechanics of cable-driven continuum robots with any cable routing
#[derive(Debug, Parser)]
#[command(name = "whipcord", version, propagate_version = true, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Stop after this time, such as 30 s, 500 ms or 2 min (a bare number is in seconds), with exit status 1; 0 or none for
    /// no limit. By default 60 s for solve, reach, design, stiffness, export and check, and no limit for the others. The search
    /// of design ends then with the best so far, which is the answer
    #[arg(long, global = true, value_name = "TIME", value_parser = deadline::limit, allow_negative_numbers = true)]
    timeout: Option<Limit>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Solve(solve::SolveArgs),
    Reach(Box<reach::ReachArgs>),
    Workspace(workspace::WorkspaceArgs),
    Design(Box<design::DesignArgs>),
    Stiffness(stiffness::StiffnessArgs),
    Simulate(simulate::SimulateArgs),
    Modes(modes::ModesArgs),
    Sweep(sweep::SweepArgs),
    Export(export::ExportArgs),
    Compare(compare::CompareArgs),
    Score(score::ScoreArgs),
    Fit(fit::FitArgs),
    Measure(Box<measure::MeasureArgs>),
    Camera(camera::CameraArgs),
    Overlay(overlay::OverlayArgs),
    Bench(bench::BenchArgs),
    Check(check::CheckArgs),
    View(view::ViewArgs),
    Schema(schema::SchemaArgs),
    New(new::NewArgs),
    Examples(examples_verb::ExamplesArgs),
    Completions(completions::CompletionsArgs),
    Man(man::ManArgs),
}

/// What a verb may take whose answer somebody waits for.
const INTERACTIVE: Limit = Limit::After(Duration::from_secs(60));

impl Verb {
    /// Its name, and the time that it may take by default.
    const fn name_and_limit(&self) -> (&'static str, Limit) {
        match self {
            Self::Solve(_) => ("solve", INTERACTIVE),
            Self::Reach(_) => ("reach", INTERACTIVE),
            Self::Workspace(_) => ("workspace", Limit::None),
            Self::Design(_) => ("design", INTERACTIVE),
            Self::Stiffness(_) => ("stiffness", INTERACTIVE),
            Self::Check(_) => ("check", INTERACTIVE),
            Self::Simulate(_) => ("simulate", Limit::None),
            Self::Modes(_) => ("modes", INTERACTIVE),
            Self::Sweep(_) => ("sweep", Limit::None),
            Self::Export(_) => ("export", INTERACTIVE),
            Self::Compare(_) => ("compare", Limit::None),
            Self::Score(_) => ("score", Limit::None),
            Self::Fit(_) => ("fit", Limit::None),
            Self::Measure(_) => ("measure", Limit::None),
            Self::Camera(_) => ("camera", Limit::None),
            Self::Overlay(_) => ("overlay", Limit::None),
            Self::Bench(_) => ("bench", Limit::None),
            Self::View(_) => ("view", Limit::None),
            Self::Schema(_) => ("schema", Limit::None),
            Self::New(_) => ("new", Limit::None),
            Self::Examples(_) => ("examples", Limit::None),
            Self::Completions(_) => ("completions", Limit::None),
            Self::Man(_) => ("man", Limit::None),
        }
    }
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
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let Cli { verb, timeout } = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // When standard error is gone too, the exit status still tells.
            let _ = match tips::for_unknown(&error, &arguments) {
                Some(tip) => writeln!(io::stderr(), "{tip}"),
                None => error.print(),
            };
            return u8::try_from(error.exit_code()).unwrap_or(USAGE);
        }
    };
    let style = Style::for_stdout();
    let (name, limit) = verb.name_and_limit();
    let over = match verb {
        Verb::Design(_) => Over::BestSoFar,
        _ => Over::NoAnswer,
    };
    let deadline = Deadline::start(name, timeout.unwrap_or(limit), over);
    let outcome = match verb {
        Verb::Solve(args) => solve::run(&args, style),
        Verb::Reach(args) => reach::run(&args, style),
        Verb::Workspace(args) => workspace::run(&args, style),
        Verb::Design(args) => design::run(&args, style),
        Verb::Stiffness(args) => stiffness::run(&args, style),
        Verb::Simulate(args) => simulate::run(&args, style),
        Verb::Modes(args) => modes::run(&args, style),
        Verb::Sweep(args) => sweep::run(&args),
        Verb::Export(args) => export::run(&args, style),
        Verb::Compare(args) => compare::run(&args, style),
        Verb::Score(args) => score::run(&args, style),
        Verb::Fit(args) => fit::run(&args, style),
        Verb::Measure(args) => match args.stereo.clone() {
            Some(second) => measure_stereo::run(&args, &second, style),
            None => measure::run(&args, style),
        },
        Verb::Camera(args) => camera::run(&args, style),
        Verb::Overlay(args) => overlay::run(&args, style),
        Verb::Bench(args) => bench::run(&args, style),
        Verb::Check(args) => check::run(&args, style),
        Verb::View(args) => view::run(&args),
        Verb::Schema(args) => schema::run(&args),
        Verb::New(args) => new::run(&args),
        Verb::Examples(args) => examples_verb::run(&args, style),
        Verb::Completions(args) => completions::run(&args),
        Verb::Man(args) => man::run(&args),
    };
    match deadline.end(outcome) {
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
