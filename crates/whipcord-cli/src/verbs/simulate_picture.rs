//! Pictures of `whipcord simulate`: charts over time, and a film.

use std::path::Path;

use whipcord::{ModelKind, Shape, Stations, Vec3};
use whipcord_io::CaseFile;
use whipcord_motion::{State, Trajectory};
use whipcord_plot::{
    Acting, CableCourse, FINE_STATIONS, FigureOptions, FilmFrame, OverTime, PlotError, RobotView,
    TimeSeries, ViewStyle, robot_figure, time_chart,
};

use crate::film::{AZIMUTH, FILM_WIDTH, durations, spread};
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::number;

/// Pictures of a film at most, and of a second of it.
const MOST_PICTURES: f64 = 120.0;
const PER_SECOND: f64 = 25.0;
/// Shorter motions are shown slowed down to this time in s.
const SHORTEST_FILM: f64 = 2.0;

/// The charts by their names.
pub fn charts(
    file: &CaseFile,
    trajectory: &Trajectory,
) -> Result<Vec<(&'static str, String)>, Failure> {
    let line = |label: &str, value: &dyn Fn(&State) -> f64| TimeSeries {
        label: label.to_owned(),
        rows: trajectory.states.iter().map(|state| [state.time, value(state)]).collect(),
    };
    let tip = [
        line("x", &|state| state.tip().position.x),
        line("y", &|state| state.tip().position.y),
        line("z", &|state| state.tip().position.z),
    ];
    let cables = file.robot.cables().iter().enumerate();
    let tensions: Vec<TimeSeries> =
        cables.map(|(i, cable)| line(&cable.name, &|state| state.cables[i].tension)).collect();
    let mut energies = vec![
        line("kinetic", &|state| state.energy.kinetic),
        line("elastic", &|state| state.energy.elastic),
        line("gravity", &|state| state.energy.gravity),
        line("from the cables", &|state| state.energy.cables),
        line("from loads", &|state| state.energy.loads),
        line("dissipated", &|state| state.energy.dissipated),
    ];
    if !file.case.obstacles.is_empty() {
        energies.push(line("from obstacles", &|state| state.energy.contacts));
    }
    if file.robot.motors().iter().any(|motor| motor.dynamics.is_some()) {
        energies
            .push(line("motors and stretch", &|state| state.energy.motors + state.energy.stretch));
        energies.push(line("from the loops", &|state| state.energy.control));
    }
    if file.motion.base.is_some() {
        energies.push(line("from the base", &|state| state.energy.base));
    }
    let touched = file.case.obstacles.iter().enumerate().filter(|(k, _)| {
        trajectory.states.iter().any(|state| state.contacts.iter().any(|of| of.obstacle == *k))
    });
    let forces: Vec<TimeSeries> = touched
        .map(|(k, obstacle)| {
            line(&obstacle.name, &|state| {
                let of_obstacle = state.contacts.iter().filter(|of| of.obstacle == k);
                of_obstacle.filter_map(|of| of.force).sum()
            })
        })
        .collect();
    let charts = [
        ("tip", OverTime::Position, &tip[..]),
        ("tensions", OverTime::Tension, &tensions[..]),
        ("energy", OverTime::Energy, &energies[..]),
        ("contacts", OverTime::ContactForce, &forces[..]),
    ];
    let drawn = charts.into_iter().filter(|(_, _, series)| !series.is_empty());
    let failed =
        |error: PlotError| Failure::Solve(format!("error: the motion cannot be drawn: {error}"));
    drawn
        .map(|(name, what, series)| {
            Ok((name, time_chart(&file.title, what, series).map_err(failed)?))
        })
        .collect()
}

/// The pictures of a film of the motion: in its own time, or slowed down where that would be too fast to be seen.
pub fn film_frames(
    path: &Path,
    file: &CaseFile,
    trajectory: &Trajectory,
) -> Result<Vec<FilmFrame>, Failure> {
    let (Some(first), Some(last)) = (trajectory.states.first(), trajectory.states.last()) else {
        return Ok(Vec::new());
    };
    let duration = last.time - first.time;
    let slower = (SHORTEST_FILM / duration.max(f64::MIN_POSITIVE)).max(1.0);
    #[expect(clippy::cast_sign_loss, clippy::cast_possible_truncation, reason = "within 1 and 120")]
    let most = (PER_SECOND * duration * slower).ceil().clamp(1.0, MOST_PICTURES) as usize;
    let shown: Vec<&State> =
        spread(trajectory.states.len(), most + 1).map(|k| &trajectory.states[k]).collect();
    let times: Vec<f64> = shown.iter().map(|state| slower * (state.time - first.time)).collect();
    let room: Vec<Vec3> =
        shown.iter().flat_map(|state| state.poses.iter().map(|pose| pose.position)).collect();
    let speed = match slower > 1.0 {
        true => format!(", {} times slower", number(slower, 3)),
        false => String::new(),
    };
    let frame = |(state, milliseconds): (&&State, u16)| {
        let options = FigureOptions {
            title: format!("{}{speed}", file.title),
            room: room.clone(),
            azimuth: Some(AZIMUTH),
            width: FILM_WIDTH,
            ..FigureOptions::default()
        };
        let svg = picture(path, (file, &trajectory.arc_lengths), state, options)?;
        Ok(FilmFrame { svg, milliseconds })
    };
    shown.iter().zip(durations(&times)).map(frame).collect()
}

/// The robot at a time.
fn picture(
    path: &Path,
    (file, arc_lengths): (&CaseFile, &[f64]),
    state: &State,
    options: FigureOptions,
) -> Result<String, Failure> {
    let nodes = Shape { arc_length: arc_lengths.to_vec(), poses: state.poses.clone() };
    let at = |arc_length: Vec<f64>| {
        let poses = arc_length.iter().map(|s| nodes.at(*s)).collect();
        Shape { arc_length, poses }
    };
    let view = RobotView {
        label: format!("{} s", number(state.time, 4)),
        shape: at(Stations::Equal(FINE_STATIONS).arc_lengths(&file.robot)),
        disks: at(Stations::Disks.arc_lengths(&file.robot)),
        cables: match file.motion.model() {
            ModelKind::CosseratDisks => CableCourse::HoleToHole,
            _ => CableCourse::Smooth,
        },
        style: ViewStyle::Model(file.motion.model()),
    };
    let options = FigureOptions {
        loads: Acting::on(&file.case, &view.shape),
        obstacles: file.case.obstacles.clone(),
        contacts: state.contacts.clone(),
        ..options
    };
    robot_figure(&file.robot, &[view], &options).map_err(|error| files::plot_failure(path, &error))
}
