//! `whipcord modes`: how the robot vibrates.

use std::path::PathBuf;

use clap::Args;
use whipcord_io::{
    CaseFile, Dimension, mode_shapes_table, modes_json, modes_table, parse_quantity, warnings_json,
};
use whipcord_motion::{Mode, Simulation};
use whipcord_plot::{ModeLine, ModesFigure, modes_figure};

use crate::inputs::{Settings, read_one};
use crate::motion::{MotionModel, failure};
use crate::warnings::Warnings;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::quantity::{fixed, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// Natural frequencies, damping ratios and shapes of the vibrations about an equilibrium
///
/// Linearises the Cosserat rod with its masses about the equilibrium that the commands and loads of the file have, or those of [motion] at
/// a time. Cables that are driven by their lengths and are taut are held; the others keep their tensions. Damping is that of
/// [backbone.damping]. The columns x, y, z and rotation are parts of the kinetic energy, along the axes of the world. The folder
/// gets modes.json, modes.csv, shapes.csv (a row for each node of each vibration) and a picture of the first shapes. Friction and
/// robots that touch obstacles are refused.
#[derive(Debug, Args)]
pub struct ModesArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    model: MotionModel,
    /// How many vibrations, from the lowest frequency on
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=200))]
    count: u16,
    /// About the equilibrium under the commands and loads of [motion] at this time, such as "0.5 s"
    #[arg(long, value_name = "TIME", value_parser = time, allow_negative_numbers = true)]
    time: Option<f64>,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object with frequencies and shapes
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the table of modes.csv
    #[arg(long)]
    csv: bool,
    #[command(flatten)]
    warnings: Warnings,
}

/// As many vibrations are drawn at most: more lines cannot be told apart.
const DRAWN: usize = 6;
const WIDTH: f64 = 640.0;

/// A time in s.
fn time(text: &str) -> Result<f64, String> {
    parse_quantity(text, &[Dimension::Time])
        .map(|(value, _)| value)
        .map_err(|error| format!("{error}: give a time such as 0.5 s or 20 ms"))
}

/// Computes the vibrations, writes the folder and returns what standard output shows.
pub fn run(args: &ModesArgs, style: Style) -> Result<String, Failure> {
    let mut file = read_one(&args.file, &args.settings)?;
    args.model.choose(&mut file);
    let warnings = file.warnings_in_motion();
    args.warnings.tell(&file, &warnings)?;
    if let (Some(time), Some(duration)) = (args.time, file.motion.duration)
        && !(0.0..=duration).contains(&time)
    {
        return Err(Failure::Input(format!(
            "error: {}: --time is {} s, but the motion takes {} s\nhelp: give a time from 0 s to {} s, or a longer `duration` in [motion]",
            file.path.display(),
            number(time, 4),
            number(duration, 4),
            number(duration, 4)
        )));
    }
    let (case, commands, options) = file.motion.held_at(&file.robot, &file.case, args.time);
    let found = Simulation::with_commands(&file.robot, &case, &commands, options).and_then(
        |mut simulation| {
            let modes = simulation.modes(&commands, usize::from(args.count))?;
            Ok((simulation, modes))
        },
    );
    let (simulation, modes) = found.map_err(|error| failure(&file, &error))?;
    let no_result = |error| files::no_result(&error);
    let mut json = modes_json(&file.title, &simulation, &modes).map_err(no_result)?;
    json["warnings"] = warnings_json(&file, &warnings);
    let table = modes_table(&simulation, &modes);
    if let Some(out) = &args.out {
        let picture = picture(&file, &simulation, &modes)?;
        let folder = Folder::create(out)?;
        folder.write("modes.json", &format!("{json:#}\n"))?;
        folder.write_table("modes.csv", &table)?;
        folder.write_table("shapes.csv", &mode_shapes_table(&simulation, &modes))?;
        folder.write_figure("modes", &picture)?;
    }
    if args.json {
        return Ok(format!("{json:#}\n"));
    }
    if args.csv {
        return table.to_csv().map_err(no_result);
    }
    Ok(summary(args, &file, &simulation, &modes, style))
}

fn picture(file: &CaseFile, simulation: &Simulation, modes: &[Mode]) -> Result<String, Failure> {
    let state = simulation.state();
    let lines = modes.iter().take(DRAWN).enumerate().map(|(k, mode)| ModeLine {
        label: match mode.frequency() {
            Some(frequency) => format!("{}: {} Hz", k + 1, number(frequency, 4)),
            None => format!("{}: unstable", k + 1),
        },
        shape: mode.in_world(state).iter().map(|twist| (twist.linear, twist.angular)).collect(),
    });
    let figure = ModesFigure {
        title: format!("{}: natural vibrations", file.title),
        poses: state.poses.clone(),
        modes: lines.collect(),
        width: WIDTH,
    };
    modes_figure(&figure)
        .map_err(|error| Failure::Solve(format!("error: the shapes cannot be drawn: {error}")))
}

fn summary(
    args: &ModesArgs,
    file: &CaseFile,
    simulation: &Simulation,
    modes: &[Mode],
    style: Style,
) -> String {
    let mut text =
        format!("{}\nnatural vibrations of {}", style.heading(&file.title), file.motion.model());
    if let Some(time) = args.time {
        text += &format!(" at {} s", number(time, 4));
    }
    text += "\n\n";
    let mut table = Table::new([
        ("mode", Align::Right),
        ("frequency", Align::Right),
        ("damped", Align::Right),
        ("damping ratio", Align::Right),
        ("x", Align::Right),
        ("y", Align::Right),
        ("z", Align::Right),
        ("rotation", Align::Right),
    ]);
    let hertz = |value: Option<f64>| match value {
        Some(value) => format!("{} Hz", number(value, 4)),
        None => "-".to_owned(),
    };
    for (k, mode) in modes.iter().enumerate() {
        let frequency = match mode.frequency() {
            Some(_) => hertz(mode.frequency()),
            None => "unstable".to_owned(),
        };
        let mut row = vec![(k + 1).to_string(), frequency, hertz(mode.damped_frequency())];
        row.push(number(mode.damping_ratio, 3));
        row.extend(
            simulation.energy_shares(mode).map(|share| format!("{} %", fixed(100.0 * share, 1))),
        );
        table.row(row);
    }
    text += &table.text(style);
    if let Some(out) = &args.out {
        text += &format!("\nresults: {}\n", out.display());
    }
    text
}
