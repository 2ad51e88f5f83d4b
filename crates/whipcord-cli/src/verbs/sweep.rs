//! `whipcord sweep`: a data set of many shapes.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::json;
use whipcord_io::load_numbers;
use whipcord_sweep::{
    Axis, AxisValues, MANIFEST, Output, Plan, Question, RunOptions, Sampling, Summary, SweepError,
    part_name, run as run_plan,
};

use crate::inputs::{Settings, read_one};
use crate::model_arguments::ModelArguments;
use crate::progress;
use crate::warnings::Warnings;
use whipcord_study::failure::{Failure, message};

/// A data set of many shapes: commands, loads or any other keys of the file vary
///
/// --vary "cables.a.tension=0 N:20 N:41" varies a key from a first to a last value, --vary "backbone.diameter=1 mm,1.2 mm" over a list;
/// paths are those of --set. A grid has all combinations; with --samples the ranges are sampled. The folder gets manifest.json and
/// one Parquet file for each part: a row for each shape with the values that vary, the outputs and, where there is no answer, the reason.
/// A part is written whole or not at all, and what it holds depends neither on shards nor on threads. What no longer runs
/// is gone on with by --resume.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    model: ModelArguments,
    /// A key that varies: PATH=FIRST:LAST:COUNT, PATH=FIRST:LAST with --samples, or PATH=VALUE,VALUE,…; may be given several times
    #[arg(long, value_name = "PATH=VALUES")]
    vary: Vec<Axis>,
    /// Rows of values from a CSV or Parquet file whose columns are named by path and unit, such as cables.a.tension [N]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["vary", "samples"])]
    table: Option<PathBuf>,
    /// Sample so many rows in place of a grid
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    /// How rows are sampled
    #[arg(long, value_name = "METHOD", default_value = "latin-hypercube", requires = "samples")]
    sampling: SamplingArgument,
    /// What random samples follow from
    #[arg(long, value_name = "S", default_value_t = 0, requires = "samples")]
    seed: u64,
    /// What the data set holds: tip, disks, tensions, lengths, stability, jacobian
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "tip")]
    outputs: Vec<Output>,
    /// Folder for the data set
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Make only the parts of shard I of N, such as 0/4: the union of all shards is the data set
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "0/1")]
    shard: (u64, u64),
    /// Go on with a data set that was begun
    #[arg(long)]
    resume: bool,
    /// Rows of each part; by default 65,536, or 4,096 where there are loads or obstacles, cables rub, or the robot is read
    /// again for each row, and fewer where rows are long
    #[arg(long, value_name = "N")]
    rows_per_part: Option<u64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    warnings: Warnings,
}

/// How rows are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SamplingArgument {
    /// Each key by itself
    Random,
    /// Each key meets each of N parts of its range once
    LatinHypercube,
    /// The sequence of Sobol, shifted at random
    Sobol,
}

fn shard(text: &str) -> Result<(u64, u64), String> {
    let parts = text.split_once('/').and_then(|(number, count)| {
        Some((number.trim().parse().ok()?, count.trim().parse().ok()?))
    });
    parts.ok_or_else(|| {
        "give the number of the shard and that of all shards, such as 0/4".to_owned()
    })
}

/// Makes the data set and returns what standard output shows.
pub fn run(args: &SweepArgs) -> Result<String, Failure> {
    let file = read_one(&args.file, &args.settings)?;
    let warnings = file.warnings();
    args.warnings.tell(&file, &warnings)?;
    let (axes, sampling) = match &args.table {
        Some(path) => table(path)?,
        None => (args.vary.clone(), sampling(args)),
    };
    let question = Question {
        axes,
        sampling,
        outputs: args.outputs.clone(),
        rows_per_part: args.rows_per_part,
    };
    let fail = |error| failure(&args.file, error);
    let plan = Plan::new(&file, &args.model.model()?, &question);
    let plan = plan.map_err(fail)?;
    let bar = progress::bar(0);
    let show = |done, rows| {
        bar.set_length(rows);
        bar.set_position(done);
        bar.set_message("rows");
    };
    let options = RunOptions { shard: args.shard, resume: args.resume, progress: Some(&show) };
    let outcome = run_plan(&plan, &args.out, &options);
    bar.finish_and_clear();
    let summary = outcome.map_err(fail)?;
    Ok(match args.json {
        true => format!("{:#}\n", describe_json(args, &plan, &summary)),
        false => describe(args, &plan, &summary),
    })
}

fn sampling(args: &SweepArgs) -> Sampling {
    let Some(rows) = args.samples else { return Sampling::Grid };
    let seed = args.seed;
    match args.sampling {
        SamplingArgument::Random => Sampling::Random { rows, seed },
        SamplingArgument::LatinHypercube => Sampling::LatinHypercube { rows, seed },
        SamplingArgument::Sobol => Sampling::Sobol { rows, seed },
    }
}

/// The columns of a table, and its rows.
fn table(path: &Path) -> Result<(Vec<Axis>, Sampling), Failure> {
    let found = load_numbers(path).map_err(|error| Failure::Input(message(&error)))?;
    let axis = |(path, unit): (String, Option<String>)| Axis {
        path,
        unit: unit.unwrap_or_default(),
        values: AxisValues::OfTable,
    };
    let axes = found.columns.into_iter().map(axis).collect();
    Ok((axes, Sampling::Table { values: found.values }))
}

fn failure(file: &Path, error: SweepError) -> Failure {
    match error {
        SweepError::File(error) => Failure::Input(message(&error)),
        SweepError::Stopped { .. } | SweepError::Write { .. } => {
            Failure::Solve(format!("error: {error}"))
        }
        error => Failure::Input(format!("error: {}: {error}", file.display())),
    }
}

fn describe(args: &SweepArgs, plan: &Plan, summary: &Summary) -> String {
    let out = args.out.display();
    let (number, count) = args.shard;
    let of = match count {
        1 => String::new(),
        _ => format!(
            " (shard {number} of {count}, of {} rows in {} parts)",
            plan.rows(),
            plan.parts()
        ),
    };
    let first = part_name(number);
    let mut text = format!(
        "{} rows in {} parts{of}: {out}/{first} …, {out}/{MANIFEST}\n",
        summary.rows, summary.parts
    );
    if summary.kept > 0 {
        text += &format!("{} parts were there already\n", summary.kept);
    }
    if summary.unstable > 0 {
        text += &format!("{} new rows are unstable\n", summary.unstable);
    }
    if let Some((row, why)) = &summary.first_failure {
        text +=
            &format!("{} new rows have no answer; the first is row {row}: {why}\n", summary.failed);
    }
    text
}

fn describe_json(args: &SweepArgs, plan: &Plan, summary: &Summary) -> serde_json::Value {
    json!({
        "folder": args.out.display().to_string(),
        "shard": [args.shard.0, args.shard.1],
        "rows": summary.rows,
        "parts": summary.parts,
        "kept_parts": summary.kept,
        "failed": summary.failed,
        "unstable": summary.unstable,
        "first_failure": summary.first_failure.as_ref().map(|(row, why)| json!({ "row": row, "error": why })),
        "all_rows": plan.rows(),
        "all_parts": plan.parts(),
        "columns": plan.column_names(),
    })
}
