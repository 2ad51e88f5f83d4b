//! `whipcord simulate`: how the robot moves over time.

use std::path::PathBuf;

use clap::Args;
use whipcord::Vec3;
use whipcord_io::{
    CaseFile, CsvTable, motion_contacts_table, motion_json, motion_table, poses_table,
    warnings_json,
};
use whipcord_motion::{Simulation, State, Trajectory};

use super::simulate_picture::{charts, film_frames};
use crate::film;
use crate::inputs::{Settings, read_one};
use crate::motion::{MotionModel, failure};
use crate::path_argument::path_ending_in;
use crate::warnings::Warnings;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::motors::{command_words, effort_words};
use whipcord_study::quantity::{fixed_millimetres, millimetres, newtons, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// How the robot moves over time: poses, tensions, slack cables and the energy balance
///
/// Computes the motion of the Cosserat rod with its masses from [motion]: duration, steps, method, commands and loads
/// over time, drag, a moving base, and the damping of [backbone.damping]. The folder gets motion.json (all states),
/// motion.csv (a row for each state: tip, cables, energies) and poses.csv (a row for each node of each state).
/// The summary is in mm, all else in SI units. Cables run along their routing, or straight from disk to disk with --model cosserat-disks, with friction where they have some. Friction of the backbone and movable objects are refused.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    model: MotionModel,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object with all states
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the table of motion.csv
    #[arg(long)]
    csv: bool,
    /// Write motion.parquet and poses.parquet to the folder as well
    #[arg(long, requires = "out")]
    parquet: bool,
    /// Draw the tip, the tensions and the energies over time, to the folder as SVG and PNG
    #[arg(long, requires = "out")]
    plot: bool,
    /// Write the motion to the folder as a film, by default film.png: an animated PNG, which browsers play. A name that ends in
    /// .webm is encoded by the program ffmpeg, which must be installed
    #[arg(long, requires = "out", value_name = "NAME", num_args = 0..=1, default_missing_value = "film.png", value_parser = path_ending_in(&film::ENDINGS))]
    film: Option<PathBuf>,
    /// Write the pictures of the film to the folder frames as well, as PNG
    #[arg(long, requires = "film")]
    frames: bool,
    #[command(flatten)]
    warnings: Warnings,
}

/// Simulates, writes the folder and returns what standard output shows.
pub fn run(args: &SimulateArgs, style: Style) -> Result<String, Failure> {
    let mut file = read_one(&args.file, &args.settings)?;
    args.model.choose(&mut file);
    if let Some(name) = &args.film {
        film::check(name)?;
    }
    let warnings = file.warnings_in_motion();
    args.warnings.tell(&file, &warnings)?;
    let Some((every, steps, rows)) = file.motion.rows() else {
        return Err(Failure::Input(format!(
            "error: {}: there is no [motion]\nhelp: add it to the file, or set its key: --set motion.duration=\"2 s\"",
            file.path.display()
        )));
    };
    let refused = |error| failure(&file, &error);
    let commands = file.motion.commands(&file.robot, &file.case);
    let options = file.motion.options();
    let simulation = Simulation::with_commands(&file.robot, &file.case, &commands, options);
    let trajectory = simulation
        .and_then(|mut simulation| simulation.run(&commands, every, steps, rows))
        .map_err(refused)?;
    let no_result = |error| files::no_result(&error);
    let mut json = motion_json(&file.title, &file.robot, &file.case.obstacles, &trajectory)
        .map_err(no_result)?;
    json["warnings"] = warnings_json(&file, &warnings);
    let table = motion_table(&file.robot, &trajectory);
    if let Some(out) = &args.out {
        let poses = poses_table(&trajectory);
        let parquet = |table: &CsvTable| table.to_parquet().map_err(no_result);
        let obstacles = &file.case.obstacles;
        let contacts =
            (!obstacles.is_empty()).then(|| motion_contacts_table(obstacles, &trajectory));
        let mut binary = Vec::new();
        if args.parquet {
            binary.push(("motion.parquet", parquet(&table)?));
            binary.push(("poses.parquet", parquet(&poses)?));
            if let Some(contacts) = &contacts {
                binary.push(("contacts.parquet", parquet(contacts)?));
            }
        }
        let pictures = if args.plot { charts(&file, &trajectory)? } else { Vec::new() };
        let path = args.film.as_ref().map(|name| out.join(name));
        let frames = path.as_ref().map(|path| film_frames(path, &file, &trajectory)).transpose()?;
        let frames = frames.unwrap_or_default();
        let film = path.map(|path| Ok((film::encoded(&path, &frames)?, path))).transpose()?;
        let folder = Folder::create(out)?;
        folder.write("motion.json", &format!("{json:#}\n"))?;
        folder.write_table("motion.csv", &table)?;
        folder.write_table("poses.csv", &poses)?;
        if let Some(contacts) = &contacts {
            folder.write_table("contacts.csv", contacts)?;
        }
        for (name, bytes) in &binary {
            files::write(&folder.path().join(name), bytes)?;
        }
        for (name, svg) in &pictures {
            folder.write_figure(name, svg)?;
        }
        if let Some((bytes, path)) = &film {
            files::write(path, bytes)?;
        }
        if args.frames {
            let folder = Folder::create(&out.join("frames"))?;
            for (k, frame) in frames.iter().enumerate() {
                let path = folder.path().join(format!("{k:04}.png"));
                files::write(&path, &files::picture(&frame.svg, &path)?)?;
            }
        }
    }
    if args.json {
        return Ok(format!("{json:#}\n"));
    }
    if args.csv {
        return table.to_csv().map_err(no_result);
    }
    Ok(summary(args, &file, &trajectory, style))
}

fn summary(args: &SimulateArgs, file: &CaseFile, trajectory: &Trajectory, style: Style) -> String {
    let mut text = style.heading(&file.title);
    text.push('\n');
    let (Some(first), Some(last)) = (trajectory.states.first(), trajectory.states.last()) else {
        return text;
    };
    let method = last.diagnostics.method.name();
    text += &format!("motion of {}, {method}\n\n", trajectory.model);
    let mut line = |name: &str, value: String| {
        text += &format!("{}  {value}\n", style.faint(format!("{name:<9}")));
    };
    let (divided, steps) = (trajectory.parts > trajectory.steps, trajectory.steps);
    let parts = if divided { format!(" in {} parts", trajectory.parts) } else { String::new() };
    line("time", format!("{} s, {steps} steps{parts}", number(last.time, 4)));
    if trajectory.frictionless_parts > 0 {
        let number = trajectory.frictionless_parts;
        line("contact", format!("{number} parts without friction, which had no answer with it"));
    }
    let tip = |position: Vec3| {
        let [x, y, z] = position.to_array().map(|metres| fixed_millimetres(metres, 2));
        format!("tip at ({x}, {y}, {z}) mm")
    };
    line("start", tip(first.tip().position));
    line("end", tip(last.tip().position));
    let farthest = trajectory
        .states
        .iter()
        .map(|state| (state.tip().position - first.tip().position).norm())
        .fold(0.0, f64::max);
    line("farthest", format!("{} mm from the start", fixed_millimetres(farthest, 2)));
    if file.motion.tolerance.is_some() {
        line(
            "error",
            format!("{} in a step at most, as estimated", millimetres(trajectory.greatest_error)),
        );
    }
    let mut table = Table::new([
        ("cable", Align::Left),
        ("tension at the end", Align::Right),
        ("greatest", Align::Right),
        ("greatest slack", Align::Right),
    ]);
    for (i, cable) in file.robot.cables().iter().enumerate() {
        let of = |value: fn(&whipcord_motion::CableMotion) -> f64| {
            trajectory.states.iter().map(|state| value(&state.cables[i])).fold(0.0, f64::max)
        };
        table.row(vec![
            cable.name.clone(),
            newtons(last.cables[i].tension),
            newtons(of(|cable| cable.tension)),
            millimetres(of(|cable| cable.slack)),
        ]);
    }
    if !file.robot.cables().is_empty() {
        text += &format!("\n{}", table.text(style));
    }
    if !file.case.obstacles.is_empty() {
        text += &contacts(file, trajectory, style);
    }
    let moving = file.robot.motors().iter().enumerate().filter(|(_, of)| of.dynamics.is_some());
    let mut table = Table::new([
        ("motor", Align::Left),
        ("at the end", Align::Right),
        ("greatest torque or force", Align::Right),
    ]);
    let mut has_moving = false;
    for (i, motor) in moving {
        has_moving = true;
        let efforts = trajectory.states.iter().map(|state| state.motors[i].effort.abs());
        table.row(vec![
            motor.name.clone(),
            command_words(motor.drive, last.motors[i].position),
            effort_words(motor.drive, efforts.fold(0.0, f64::max)),
        ]);
    }
    if has_moving {
        text += &format!("\n{}", table.text(style));
    }
    let energy = &last.energy;
    let millijoules = |joules: f64| format!("{} mJ", number(1e3 * joules, 4));
    text += &format!(
        "\nenergy  {} at the start, {} at the end\n        {} from the cables{}, {} from loads,{} {} dissipated, {} by the integration\n",
        millijoules(first.energy.total()),
        millijoules(energy.total()),
        millijoules(energy.cables),
        if has_moving {
            format!(", {} from the motors", millijoules(energy.control))
        } else {
            String::new()
        },
        millijoules(energy.loads),
        match file.case.obstacles.is_empty() {
            true => String::new(),
            false => format!(" {} from obstacles,", millijoules(energy.contacts)),
        },
        millijoules(energy.dissipated),
        millijoules(energy.defect()),
    );
    if let Some(out) = &args.out {
        text += &format!("results: {}\n", out.display());
    }
    text
}

/// The obstacles that the robot touches on its way: when first, and how hard.
fn contacts(file: &CaseFile, trajectory: &Trajectory, style: Style) -> String {
    let mut table = Table::new([
        ("obstacle", Align::Left),
        ("touched first", Align::Right),
        ("greatest force", Align::Right),
        ("at the end", Align::Right),
    ]);
    for (k, obstacle) in file.case.obstacles.iter().enumerate() {
        let force = |state: &State| {
            let of = state.contacts.iter().filter(|contact| contact.obstacle == k);
            of.filter_map(|contact| contact.force).sum::<f64>()
        };
        let first = trajectory.states.iter().find(|state| force(state) > 0.0);
        let greatest = trajectory.states.iter().map(force).fold(0.0, f64::max);
        table.row(vec![
            obstacle.name.clone(),
            first.map_or("never".to_owned(), |state| format!("{} s", number(state.time, 4))),
            newtons(greatest),
            newtons(trajectory.states.last().map_or(0.0, force)),
        ]);
    }
    format!("\n{}", table.text(style))
}
