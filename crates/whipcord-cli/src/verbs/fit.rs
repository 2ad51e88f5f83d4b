//! `whipcord fit`: what the robot is, from what was measured.

use std::num::NonZero;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use whipcord::{Model, ModelKind, Stations};
use whipcord_estimation::identification::{
    Asked, Experiment, Identified, IdentifyError, ParameterPath, Prior, Progress, Robustness,
    Settings, Unknown, analyse, identify, registered, rows, split,
};
use whipcord_io::{CaseFile, Fit as Unknowns, FittedFile, Inexpressible, Mounting, parameter_path};

use crate::deadline;
use crate::inputs::{self, Inputs};
use crate::model_arguments::{ActuationArgument, FourBarArguments, actuation, model_parser};
use crate::progress;
use crate::warnings::Warnings;
use whipcord_study::failure::{Failure, refuses};
use whipcord_study::files::{self, Folder};
use whipcord_study::fitting::{Fit, not_converged, tables};
use whipcord_study::style::Style;

/// Estimate parameters of the robot from what was measured
///
/// The files describe the same robot in different cases, each with [measured]. The parameters are
/// listed in [fit], or given by --parameter and --each. Prints the estimates with confidence
/// intervals and correlations, and lists parameters that the measurements cannot distinguish.
#[derive(Debug, Args)]
pub struct FitArgs {
    /// Robot files, or folders of them
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    settings: inputs::Settings,
    /// Model
    #[arg(long, value_name = "NAME", default_value = "cosserat", value_parser = model_parser())]
    model: ModelKind,
    /// Quantity that is prescribed for all cables; by default the one that the model prefers, if
    /// the file gives it
    #[arg(long, value_name = "WHAT")]
    actuation: Option<ActuationArgument>,
    #[command(flatten)]
    four_bar: FourBarArguments,
    /// Parameter to estimate with one value for all files: a path such as backbone.diameter or
    /// cables[0].friction (lists count from 0); one number for several cables or motors:
    /// cables[*].axial_stiffness for all, motors[segment 1].stiffness for a group; replaces [fit]
    #[arg(long = "parameter", value_name = "PATH", value_parser = path)]
    parameters: Vec<ParameterPath>,
    /// Parameter to estimate for each file separately, such as base.position[0]; replaces [fit]
    #[arg(long, value_name = "PATH", value_parser = path)]
    each: Vec<ParameterPath>,
    /// Loss function, which sets the influence of outliers
    #[arg(long, value_name = "LOSS", default_value = "squares")]
    loss: Loss,
    /// Least and greatest value of a parameter in SI: PATH=LEAST,GREATEST, either of which may be left empty
    #[arg(long, value_name = "PATH=LEAST,GREATEST", value_parser = with_numbers)]
    bounds: Vec<(ParameterPath, [Option<f64>; 2])>,
    /// What is known of a parameter beside the measurements, in SI: PATH=MEAN,DEVIATION
    #[arg(long, value_name = "PATH=MEAN,DEVIATION", value_parser = with_numbers)]
    prior: Vec<(ParameterPath, [Option<f64>; 2])>,
    /// Value of a parameter where the search starts, in SI; by default what the file says
    #[arg(long, value_name = "PATH=VALUE", value_parser = with_numbers)]
    start: Vec<(ParameterPath, [Option<f64>; 2])>,
    /// Places from which the search starts: the values of the file and, between the bounds or around these values, others; the best end
    /// counts. For fits that end in different minima, as where cables get slack or taut
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Threads that share the rows; as many as there are processors by default. The results are the same for any number
    #[arg(long, value_name = "N")]
    threads: Option<NonZero<usize>>,
    /// Robot files with measurements that are not fitted, on which the fit is scored
    #[arg(long, value_name = "FILES", num_args = 1.., conflicts_with = "split")]
    test: Vec<PathBuf>,
    /// All files were measured in one frame, as by a tracker that was never moved: `registration = "rigid"` is then one motion for
    /// all of them, and for those of --test; else each file has its own
    #[arg(long)]
    one_frame: bool,
    /// Part of the rows that is not fitted, on which the fit is scored: chosen at random, groups of rows together
    #[arg(long, value_name = "FRACTION", value_parser = fraction)]
    split: Option<f64>,
    /// Seed of the random choice of --split
    #[arg(long, value_name = "N", default_value_t = 1, requires = "split")]
    seed: u64,
    /// Leave out each group of rows, each file, or each step, in turn, and report the prediction error for it
    #[arg(long)]
    cross_validate: bool,
    /// Fit the first parameter alone, then the first two, and so on, with the prediction error of each
    #[arg(long)]
    ladder: bool,
    /// Intervals by profile likelihood, for parameters that the measurements hardly determine
    #[arg(long)]
    profile: bool,
    /// Also fit the other models
    #[arg(long)]
    compare_models: bool,
    /// Robot file to write with the estimates; with several input files use --out
    #[arg(short, long, value_name = "FITTED")]
    output: Option<PathBuf>,
    /// Folder for the report, the figures, the CSV files and the robot files with the estimates
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    warnings: Warnings,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Loss {
    /// Least squares
    Squares,
    /// Huber: linear beyond the noise
    Huber,
    /// Smooth approximation of Huber
    SoftL1,
    /// Cauchy: logarithmic, outliers have almost no influence
    Cauchy,
}

fn path(text: &str) -> Result<ParameterPath, String> {
    parameter_path(text).map_err(|near| match near {
        Some(near) => format!("nothing of this path can be estimated; did you mean {near}?"),
        None => String::from(
            "nothing of this path can be estimated; give one such as backbone.young_modulus or cables[0].tension_offset, counting from 0",
        ),
    })
}

/// A path with one or two numbers.
fn with_numbers(text: &str) -> Result<(ParameterPath, [Option<f64>; 2]), String> {
    let (parameter, numbers) = text.rsplit_once('=').ok_or("give it as PATH=NUMBERS")?;
    let number = |text: &str| match text.trim() {
        "" => Ok(None),
        text => match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(format!("`{text}` is not a number in SI")),
        },
    };
    let (first, second) = numbers.split_once(',').unwrap_or((numbers, ""));
    Ok((path(parameter.trim())?, [number(first)?, number(second)?]))
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(fraction) if fraction > 0.0 && fraction < 1.0 => Ok(fraction),
        _ => Err("give a part between 0 and 1, such as 0.2".to_owned()),
    }
}

/// Fits, writes the files, and returns what standard output shows.
pub fn run(args: &FitArgs, style: Style) -> Result<String, Failure> {
    let Inputs { cases, .. } = Inputs::read(&args.files, &args.settings)?;
    if args.output.is_some() && cases.len() > 1 {
        return Err(Failure::Input(String::from(
            "error: --output is for one file; with several give --out, the folder for all of them",
        )));
    }
    if let Some(path) = &args.output {
        files::keep(path, read(&cases))?;
    }
    same_robot(&cases)?;
    let experiments = cases.iter().map(experiment).collect::<Result<Vec<_>, _>>()?;
    let unknowns = unknowns(args, &cases)?;
    let model = |kind| {
        Model::new(kind, Stations::Disks, actuation(args.actuation))
            .cancelled_by(&deadline::cancel())
    };
    let settings = Settings {
        robustness: match args.loss {
            Loss::Squares => Robustness::Squares,
            Loss::Huber => Robustness::Huber,
            Loss::SoftL1 => Robustness::SoftL1,
            Loss::Cauchy => Robustness::Cauchy,
        },
        skips: true,
        starts: args.starts.into(),
        threads: args.threads,
        ..Settings::new(args.four_bar.applied_to(model(args.model))?)
    };
    let robot = &cases[0].robot;
    let fail = |error: IdentifyError| failure(&cases, &error);
    let registered = registered(robot, &experiments, &unknowns, args.one_frame, &settings);
    let (mut experiments, unknowns) = registered.map_err(fail)?;
    let mut test = None;
    if let Some(fraction) = args.split {
        let [kept, held] = split(&experiments, fraction, args.seed).map_err(fail)?;
        experiments = kept;
        test = Some((held, true));
    } else if !args.test.is_empty() {
        test = Some((measurements_of(&args.test, &cases, &args.settings)?, false));
    }
    let bar = progress::bar(0);
    let shown = bar.clone();
    let count = rows(&experiments).len();
    let told = Progress::new(move |evaluation| {
        shown.set_message(format!(
            "evaluation {} of {count} rows, RMS {:.3e}",
            evaluation.number, evaluation.rms
        ));
        shown.tick();
    });
    let settings = Settings { progress: told, ..settings };
    let found = identify(robot, &experiments, &unknowns, &settings).map_err(fail)?;
    if !found.status.is_converged() {
        let paths: Vec<_> = cases.iter().map(|case| case.path.display().to_string()).collect();
        return Err(Failure::Solve(format!("error: {}", not_converged(&paths, &found))));
    }
    let models = match args.compare_models {
        // The one that is fitted with the options that it has.
        true => ModelKind::ALL
            .into_iter()
            .map(|kind| if kind == args.model { settings.model.clone() } else { model(kind) })
            .collect(),
        false => Vec::new(),
    };
    let asked = Asked {
        cross_validates: args.cross_validate,
        models,
        climbs: args.ladder,
        profiles: args.profile,
        test,
    };
    let analyses =
        analyse(robot, &experiments, &unknowns, &settings, &found, &asked).map_err(fail)?;
    bar.finish_and_clear();
    let fit = Fit::new(&settings.model, cases, experiments, found, analyses, &args.test);
    let warned: Vec<_> = fit.cases.iter().zip(fit.notices.clone()).collect();
    args.warnings.tell_all(&warned)?;
    for remark in fit.remarks_of_all() {
        args.warnings.tell_of_all(&remark.message, remark.help)?;
    }
    write(args, &fit, &unknowns, style)
}

/// The files that the cases come from.
fn read(cases: &[CaseFile]) -> impl Iterator<Item = &Path> {
    cases.iter().flat_map(CaseFile::files)
}

/// Makes all there is to write, then writes it, or nothing.
fn write(args: &FitArgs, fit: &Fit, unknowns: &[Unknown], style: Style) -> Result<String, Failure> {
    let mut notes = Vec::new();
    let mut fitted = |i: usize, folder: &Path, target: &Path| -> Result<FittedFile, Failure> {
        let file = with_estimates(&fit.cases[i], &fit.found, i, folder)?;
        let how = if file.keeps_text {
            ""
        } else {
            " (written anew: without comments, units, [measured], [fit] and [reference])"
        };
        notes.push(format!("fitted: {}{how}", target.display()));
        Ok(file)
    };
    let mut written: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    if let Some(path) = &args.output {
        let folder = path.parent().unwrap_or(Path::new(""));
        written.push((path.clone(), fitted(0, folder, path)?.text.into_bytes()));
    }
    if let Some(out) = &args.out {
        let files = fit.files()?;
        let own = fit.names.iter().map(|name| format!("{name}-fitted.toml"));
        for name in own.chain(files.iter().map(|(name, _)| name.clone())) {
            files::keep(&out.join(name), read(&fit.cases))?;
        }
        Folder::create(out)?;
        for (i, name) in fit.names.iter().enumerate() {
            let path = out.join(format!("{name}-fitted.toml"));
            let file = fitted(i, out, &path)?;
            written.push((path, file.text.into_bytes()));
        }
        written.extend(files.into_iter().map(|(name, bytes)| (out.join(name), bytes)));
        notes.push(format!("report: {}", out.join("report.html").display()));
    }
    let text = if args.json {
        let json = fit.json();
        format!("{:#}\n", json.map_err(|error| files::no_result(&error))?)
    } else {
        let mut text = tables::summary(fit, unknowns, style);
        for note in notes {
            text += &format!("{note}\n");
        }
        text
    };
    for (path, bytes) in written {
        files::write(&path, &bytes)?;
    }
    Ok(text)
}

/// The file with the estimates that belong to it.
fn with_estimates(
    file: &CaseFile,
    found: &Identified,
    experiment: usize,
    folder: &Path,
) -> Result<FittedFile, Failure> {
    let failed =
        |error: Inexpressible| Failure::Input(format!("error: {}: {error}", file.path.display()));
    let case = &found.cases[experiment];
    let mounting =
        Mounting { offset: found.marker_offset(experiment), body: found.bodies[experiment] };
    file.with_numbers_of(&found.robot, case, mounting, folder).map_err(failed)
}

/// What was measured in a case.
fn experiment(file: &CaseFile) -> Result<Experiment, Failure> {
    file.experiment().ok_or_else(|| {
        Failure::Input(format!(
            "error: {} has no measurements: name the file with them in [measured]",
            file.path.display()
        ))
    })
}

/// What was measured in files that are not fitted.
fn measurements_of(
    paths: &[PathBuf],
    fitted: &[CaseFile],
    settings: &inputs::Settings,
) -> Result<Vec<Experiment>, Failure> {
    let Inputs { cases, .. } = Inputs::read(paths, settings)?;
    let all: Vec<CaseFile> = fitted.iter().take(1).chain(&cases).cloned().collect();
    same_robot(&all)?;
    cases.iter().map(experiment).collect()
}

/// What is estimated: as the arguments say, else as the files do.
fn unknowns(args: &FitArgs, cases: &[CaseFile]) -> Result<Vec<Unknown>, Failure> {
    let files: Vec<Option<&Unknowns>> = cases.iter().map(|case| case.fit.as_ref()).collect();
    let robot = &cases[0].robot;
    let known = |paths: &[ParameterPath]| -> Result<Vec<Unknown>, Failure> {
        let unknown = |path: &ParameterPath| {
            let unknown = path.unknown(robot);
            unknown.map(|unknown| Unknowns::known(&files, unknown)).map_err(|error| {
                Failure::Input(format!("error: {}: {error}", cases[0].path.display()))
            })
        };
        paths.iter().map(unknown).collect()
    };
    let unknowns = if args.parameters.is_empty() && args.each.is_empty() {
        Unknowns::together(&files)
    } else {
        let fit = Unknowns { shared: known(&args.parameters)?, each: known(&args.each)? };
        fit.of_all(cases.len())
    };
    let mut unknowns = unknowns;
    for (path, set) in (args.bounds.iter().map(|(path, of)| (path, Known::Bounds(*of))))
        .chain(args.prior.iter().map(|(path, of)| (path, Known::Prior(*of))))
        .chain(args.start.iter().map(|(path, of)| (path, Known::Start(of[0]))))
    {
        let of: Vec<&mut Unknown> =
            unknowns.iter_mut().filter(|of| of.path() == path.to_string()).collect();
        if of.is_empty() {
            return Err(Failure::Input(format!(
                "error: {path} is not estimated: name it with --parameter or in [fit], or leave out what is known of it"
            )));
        }
        for unknown in of {
            set.of(unknown, path)?;
        }
    }
    if unknowns.is_empty() {
        return Err(Failure::Input(String::from(
            "error: nothing is to be estimated: give --parameter, such as --parameter backbone.diameter, or [fit] in the file",
        )));
    }
    Ok(unknowns)
}

/// What the arguments say of a parameter.
enum Known {
    Bounds([Option<f64>; 2]),
    Prior([Option<f64>; 2]),
    Start(Option<f64>),
}

impl Known {
    fn of(&self, unknown: &mut Unknown, path: &ParameterPath) -> Result<(), Failure> {
        match *self {
            Self::Bounds([least, greatest]) => {
                let infinite = [f64::NEG_INFINITY, f64::INFINITY];
                unknown.bounds = [least.unwrap_or(infinite[0]), greatest.unwrap_or(infinite[1])];
            }
            Self::Prior([Some(mean), Some(deviation)]) => {
                unknown.prior = Some(Prior { mean, deviation });
            }
            Self::Prior(_) => {
                return Err(Failure::Input(format!(
                    "error: a prior needs a mean and a deviation: --prior {path}=MEAN,DEVIATION"
                )));
            }
            Self::Start(value) => unknown.start = value,
        }
        Ok(())
    }
}

/// Refuses files that describe different robots.
fn same_robot(cases: &[CaseFile]) -> Result<(), Failure> {
    let Some((first, others)) = cases.split_first() else { return Ok(()) };
    for other in others {
        let Some(what) = first.robot.differs_in(&other.robot) else { continue };
        let remedy = match what {
            "cables" => "give one robot all of them, and those that do not pull the tension 0",
            _ => "let both extend one file with the robot",
        };
        return Err(Failure::Input(format!(
            "error: {} and {} describe different robots: the {what} differ{}; {remedy}",
            first.path.display(),
            other.path.display(),
            if what == "backbone" { "s" } else { "" }
        )));
    }
    Ok(())
}

/// With the file in place of the number of the case.
fn failure(cases: &[CaseFile], error: &IdentifyError) -> Failure {
    use whipcord_estimation::identification::NoAnswerReason as Reason;
    let paths: Vec<String> = cases.iter().map(|case| case.path.display().to_string()).collect();
    let message = format!("error: {}", error.named(&paths));
    match error {
        IdentifyError::NoAnswerAtStart(answer) => match &answer.reason {
            Reason::Solve(error) if refuses(error) => Failure::Input(message),
            _ => Failure::Solve(message),
        },
        IdentifyError::NotConverged { .. } => {
            Failure::Solve(format!("{message}, or leave out --cross-validate"))
        }
        IdentifyError::Cancelled => Failure::Solve(message),
        _ => Failure::Input(message),
    }
}
