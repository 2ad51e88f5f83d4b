//! Every number of a comparison, in SI.

use whipcord::{Shape, Vec3};
use whipcord_estimation::observation::Distances;
use whipcord_io::{Cell, CsvTable};

use super::study::{Commands, Solved, Study};
use super::tables::not_compared;
use crate::steps;

/// One row for each run: what drove it, its tip, its distances and its time.
pub fn summary(studies: &[Study]) -> CsvTable {
    let mut csv = CsvTable::new([
        "case",
        "file",
        "stem",
        "model",
        "commands",
        "driven_by",
        "tip_x",
        "tip_y",
        "tip_z",
        "tip_qw",
        "tip_qx",
        "tip_qy",
        "tip_qz",
        "bend",
        "rms_to_first_model",
        "rms_to_measured",
        "solve_time",
        "solve_time_repeats",
        "build_time",
        "iterations",
        "residual",
        "stability",
        "steps",
        "failure",
        "stable",
        "stability_absent",
        "unstable_steps",
        "measured_steps",
        "measured_points",
        "not_measured",
    ]);
    for study in studies {
        for run in &study.runs {
            let mut row = identity(study).to_vec();
            row.extend([
                Cell::from(run.model.name()),
                Cell::from(commands(run.commands)),
                Cell::from(run.driven_by.as_str()),
            ]);
            match &run.outcome {
                Ok(solved) => {
                    let tip = solved.solution.disks.tip();
                    row.extend(tip.position.to_array().map(Cell::from));
                    row.extend(tip.rotation.wxyz().map(Cell::from));
                    row.push(Cell::from(solved.solution.disks.bend().0));
                    row.push(Cell::from(study.distance_to_reference(run, solved)));
                    row.push(Cell::from(solved.compared().and_then(Distances::rms)));
                    row.push(Cell::from(solved.solve.median));
                    row.push(Cell::from(solved.solve.repeats));
                    row.push(Cell::from(solved.build.median));
                    let diagnostics = &solved.solution.diagnostics;
                    row.push(Cell::from(diagnostics.iterations));
                    row.push(Cell::from(diagnostics.residual));
                    row.push(Cell::from(diagnostics.stability));
                    row.push(Cell::from(diagnostics.steps));
                    row.push(Cell::Empty);
                    row.extend(recommendation(solved));
                    row.extend(measured(study, solved));
                }
                Err(error) => {
                    row.resize(23, Cell::Empty);
                    row.push(Cell::from(error.to_string()));
                    row.resize(30, Cell::Empty);
                }
            }
            csv.push(row);
        }
    }
    csv
}

/// Whether the answers to all steps are stable, why that is not known, and how many are unstable.
fn recommendation(solved: &Solved) -> [Cell; 3] {
    let stable = steps::all_stable(&solved.answers);
    let absent = steps::stability_absent(&solved.answers).filter(|_| stable.is_none());
    let unstable = solved.answers.iter().filter(|answer| answer.diagnostics.is_unstable()).count();
    [
        stable.map_or(Cell::Empty, |stable| Cell::from(if stable { "true" } else { "false" })),
        absent.map_or(Cell::Empty, |why| Cell::from(why.name())),
        Cell::from(unstable),
    ]
}

/// Over how many steps and markers the distance to the measurement is, or why there is none.
fn measured(study: &Study, solved: &Solved) -> [Cell; 3] {
    match solved.compared().filter(|compared| compared.rms().is_some()) {
        Some(compared) => {
            [Cell::from(compared.steps()), Cell::from(compared.moving().count()), Cell::Empty]
        }
        None => {
            let nothing = || match study.file.measured {
                Some(_) => String::from("nothing was measured in space"),
                None => String::from("nothing was measured"),
            };
            let why = not_compared(solved).unwrap_or_else(nothing);
            [Cell::Empty, Cell::Empty, Cell::from(why)]
        }
    }
}

/// Every marker that was measured in space, in every step, beside its place in each model; `None` where no answer is
/// compared with one.
pub fn markers(study: &Study) -> Option<CsvTable> {
    let mut csv = CsvTable::new([
        "model",
        "commands",
        "step",
        "disk",
        "arc_length",
        "at_base",
        "x_measured",
        "y_measured",
        "z_measured",
        "x",
        "y",
        "z",
        "distance",
    ]);
    let mut any = false;
    for (run, solved) in study.solved() {
        for marker in solved.compared().into_iter().flat_map(|compared| &compared.markers) {
            any = true;
            let mut row = vec![
                Cell::from(run.model.name()),
                Cell::from(commands(run.commands)),
                Cell::from(marker.step + 1),
                Cell::from(marker.disk.map(|disk| disk as f64)),
                Cell::from(marker.arc_length),
                Cell::from(if marker.at_base { "true" } else { "false" }),
            ];
            row.extend(marker.measured.to_array().map(Cell::from));
            row.extend(marker.model.to_array().map(Cell::from));
            row.push(Cell::from(marker.distance()));
            csv.push(row);
        }
    }
    any.then_some(csv)
}

/// What tells a case from others: its title, its file, and what the names of its own result files
/// begin with.
fn identity(study: &Study) -> [Cell; 3] {
    [
        Cell::from(study.file.title.as_str()),
        Cell::from(study.file.path.display().to_string()),
        Cell::from(study.stem.as_str()),
    ]
}

/// Published values, one row for each case that has them.
pub fn reference(studies: &[Study]) -> Option<CsvTable> {
    let mut csv = CsvTable::new([
        "case",
        "file",
        "stem",
        "source",
        "rms_cosserat",
        "rms_four_bar",
        "time_cosserat",
        "time_four_bar",
    ]);
    let mut any = false;
    for study in studies {
        if let Some(reference) = &study.file.reference {
            any = true;
            let [case, file, stem] = identity(study);
            csv.push([
                case,
                file,
                stem,
                Cell::from(reference.source.as_str()),
                Cell::from(reference.rms_cosserat),
                Cell::from(reference.rms_four_bar),
                Cell::from(reference.time_cosserat),
                Cell::from(reference.time_four_bar),
            ]);
        }
    }
    any.then_some(csv)
}

/// RMS distance over the disks and all steps between each two runs of each case; `None` where no case has two.
pub fn distances(studies: &[Study]) -> Option<CsvTable> {
    let columns = ["case", "file", "stem", "a", "a_commands", "b", "b_commands", "rms_distance"];
    let mut csv = CsvTable::new(columns);
    let mut any = false;
    for study in studies {
        let solved: Vec<_> = study.solved().collect();
        for (i, (a, a_solved)) in solved.iter().enumerate() {
            for (b, b_solved) in &solved[i + 1..] {
                any = true;
                let [case, file, stem] = identity(study);
                csv.push([
                    case,
                    file,
                    stem,
                    Cell::from(a.model.name()),
                    Cell::from(commands(a.commands)),
                    Cell::from(b.model.name()),
                    Cell::from(commands(b.commands)),
                    Cell::from(steps::rms_distance(&a_solved.answers, &b_solved.answers)),
                ]);
            }
        }
    }
    any.then_some(csv)
}

/// Poses and distances at the disks of one case, after the last step.
pub fn disks(study: &Study) -> CsvTable {
    poses(study, "disk", true, |solved| &solved.solution.disks)
}

/// Poses at the stations of the smooth shapes of one case.
pub fn stations(study: &Study) -> CsvTable {
    poses(study, "station", false, |solved| &solved.fine)
}

fn poses(
    study: &Study,
    number: &'static str,
    distances: bool,
    shape: impl Fn(&Solved) -> &Shape,
) -> CsvTable {
    let mut columns =
        vec!["model", "commands", number, "arc_length", "x", "y", "z", "qw", "qx", "qy", "qz"];
    if distances {
        columns.extend(["distance_to_first_model", "distance_to_measured"]);
    }
    let mut csv = CsvTable::new(columns);
    let reference = study.reference().map(|(_, solved)| shape(solved));
    for (run, solved) in study.solved() {
        let shape = shape(solved);
        for (i, (arc_length, pose)) in shape.arc_length.iter().zip(&shape.poses).enumerate() {
            let mut row = vec![
                Cell::from(run.model.name()),
                Cell::from(commands(run.commands)),
                Cell::from(i + 1),
                Cell::from(*arc_length),
            ];
            row.extend(pose.position.to_array().map(Cell::from));
            row.extend(pose.rotation.wxyz().map(Cell::from));
            if distances {
                let to = |other: Vec3| (pose.position - other).norm();
                let first = reference.and_then(|shape| shape.poses.get(i));
                row.push(Cell::from(first.map(|first| to(first.position))));
                row.push(Cell::from(solved.measured_at(i + 1).map(to)));
            }
            csv.push(row);
        }
    }
    csv
}

/// The cables of one case; `None` where it has none.
pub fn cables(study: &Study) -> Option<CsvTable> {
    let mut csv = CsvTable::new([
        "model",
        "commands",
        "cable",
        "tension",
        "length",
        "initial_length",
        "shortening",
        "slack",
    ]);
    for (run, solved) in study.solved() {
        for cable in &solved.solution.cables {
            csv.push([
                Cell::from(run.model.name()),
                Cell::from(commands(run.commands)),
                Cell::from(cable.name.as_str()),
                Cell::from(cable.tension),
                Cell::from(cable.length),
                Cell::from(cable.initial_length),
                Cell::from(cable.initial_length - cable.length),
                Cell::from(if cable.slack { "true" } else { "false" }),
            ]);
        }
    }
    (!study.file.robot.cables().is_empty()).then_some(csv)
}

const fn commands(commands: Commands) -> &'static str {
    match commands {
        Commands::File => "file",
        Commands::CosseratShape => "cosserat-shape",
    }
}
