//! What the models say, in tables for people.

use whipcord::{ModelKind, Pose};
use whipcord_estimation::observation::Distances;
use whipcord_io::Measured;

use super::study::{Commands, Run, Solved, Study};
use crate::describe::{REVERSED_HELP, reversed};
use crate::quantity::{degrees, fixed, fixed_millimetres, millimetres};
use crate::table::{Align, Table};
use crate::timing::duration;

/// Marks an answer that the robot leaves.
const UNSTABLE: &str = "†";
/// Marks a distance that is an outlier.
pub const OUTLIER: &str = "▲";

/// The one table: a group for each case, a row for each model. Columns for measurements and published
/// values are there when any case has them. `marked` marks outliers.
pub fn summary(studies: &[Study], marked: bool) -> Table {
    let solved = || studies.iter().flat_map(Study::solved);
    let measured = solved().any(|(_, solved)| solved.measured.is_some());
    let published = studies.iter().any(|s| s.file.reference.is_some());
    let mut columns = vec![
        ("case", Align::Left, ""),
        ("model", Align::Left, ""),
        ("driven by", Align::Left, ""),
        ("tip x", Align::Right, "mm"),
        ("y", Align::Right, "mm"),
        ("z", Align::Right, "mm"),
        ("bend", Align::Right, "degrees"),
        ("RMS", Align::Right, "mm"),
    ];
    if measured {
        columns.push(("to measured", Align::Right, "mm"));
        columns.push(("steps", Align::Right, "count"));
        columns.push(("points", Align::Right, "count"));
    }
    columns.push(("time", Align::Right, "with its unit"));
    if published {
        columns.push(("paper: RMS", Align::Right, "mm"));
        columns.push(("paper: time", Align::Right, "with its unit"));
    }
    let units = columns.iter().map(|(_, _, unit)| *unit).collect::<Vec<_>>();
    let columns = columns.into_iter().map(|(name, align, _)| (name, align));
    let mut table = Table::new(columns).with_units(units);
    for study in studies {
        table.group();
        for (i, run) in study.runs.iter().enumerate() {
            let title = if i == 0 { study.file.title.clone() } else { String::new() };
            let mark = if run.is_unstable() { format!(" {UNSTABLE}") } else { String::new() };
            let mut row = vec![title, format!("{}{mark}", run.model), drive_words(run)];
            row.extend(answer_cells(study, run, measured, marked));
            if published {
                row.extend(published_cells(study, run));
            }
            table.row(row);
        }
    }
    table
}

fn drive_words(run: &Run) -> String {
    match run.commands {
        _ if run.outcome.is_err() => String::from("–"),
        Commands::File => run.driven_by.clone(),
        Commands::CosseratShape => format!("{} (Cosserat's)", run.driven_by),
    }
}

fn answer_cells(study: &Study, run: &Run, measured: bool, marked: bool) -> Vec<String> {
    let Ok(solved) = &run.outcome else {
        let count = if measured { 9 } else { 6 };
        return vec![String::from("–"); count];
    };
    let in_mm = |distance: f64| match marked {
        true => with_mark(study, distance),
        false => fixed_millimetres(distance, 2),
    };
    let tip = solved.solution.disks.tip();
    let mut cells: Vec<String> =
        tip.position.to_array().map(|x| fixed_millimetres(x, 2)).into_iter().collect();
    cells.push(format!("{}°", fixed(solved.solution.disks.bend().0.to_degrees(), 1)));
    let distance = study.distance_to_reference(run, solved);
    cells.push(distance.map_or_else(|| String::from("–"), in_mm));
    if measured {
        match solved.compared().and_then(|compared| Some((compared, compared.rms()?))) {
            Some((compared, rms)) => cells.extend([
                in_mm(rms),
                compared.steps().to_string(),
                compared.moving().count().to_string(),
            ]),
            None => cells.resize(cells.len() + 3, String::from("–")),
        }
    }
    cells.push(duration(solved.solve.median));
    cells
}

/// A distance in mm, marked where it is an outlier.
pub fn with_mark(study: &Study, distance: f64) -> String {
    let text = fixed_millimetres(distance, 2);
    if study.is_far(distance) { format!("{OUTLIER} {text}") } else { text }
}

/// Values that others published, beside the run that they belong to: the one driven by the file.
fn published_cells(study: &Study, run: &Run) -> [String; 2] {
    let Some(reference) = study.file.reference.as_ref().filter(|_| run.commands == Commands::File)
    else {
        return Default::default();
    };
    let (rms, time) = match run.model {
        ModelKind::Cosserat => (reference.rms_cosserat, reference.time_cosserat),
        ModelKind::FourBar => (reference.rms_four_bar, reference.time_four_bar),
        // The paper compares two models.
        _ => (None, None),
    };
    [
        rms.map_or_else(String::new, |d| fixed_millimetres(d, 2)),
        time.map_or_else(String::new, duration),
    ]
}

/// What the columns mean, and what must not be read into them.
pub fn notes(studies: &[Study]) -> Vec<String> {
    let mut notes = vec![String::from(
        "Lengths in mm. RMS: distance over the disks, without the base, to the first model of the case that has an answer; \"–\" in its own row. Time: median of repeated cold solves by a model that is built, of a case in steps the last step from the one before; cases.csv has the time of building it.",
    )];
    if studies.iter().any(|study| !study.file.case.before.is_empty()) {
        notes.push(String::from(
            "A case in steps: tip and bend after the last step, RMS over all steps.",
        ));
    }
    if studies.iter().flat_map(Study::solved).any(|(_, solved)| solved.compared().is_some()) {
        notes.push(String::from(
            "To measured: RMS distance to the markers that were measured in space, without those on the base, over all steps with measurements; \"steps\" and \"points\" say how many count. <case>-measured.csv has each of them.",
        ));
    }
    let like_for_like = |run: &Run| run.commands == Commands::CosseratShape;
    if studies.iter().any(|s| s.runs.iter().any(like_for_like)) {
        notes.push(String::from(
            "\"(Cosserat's)\": a geometric model with the cable lengths, from hole to hole, of the Cosserat shape, so that the models are compared like for like.",
        ));
    }
    if studies.iter().flat_map(|study| &study.runs).any(Run::is_unstable) {
        notes.push(format!("{UNSTABLE} unstable: the robot leaves this shape."));
        for study in studies.iter().filter(|study| !study.file.case.before.is_empty()) {
            for (run, solved) in study.solved().filter(|(run, _)| run.is_unstable()) {
                let of = solved.answers.len();
                let unstable =
                    solved.answers.iter().filter(|answer| answer.diagnostics.is_unstable()).count();
                notes.push(format!(
                    "{}, {}: {unstable} of {of} steps unstable.",
                    study.file.title,
                    run.label()
                ));
            }
        }
    }
    let mut sources: Vec<&str> = studies
        .iter()
        .filter_map(|s| s.file.reference.as_ref())
        .map(|reference| reference.source.as_str())
        .collect();
    sources.sort_unstable();
    sources.dedup();
    if !sources.is_empty() {
        notes.push(format!(
            "\"paper\": published values, not ours ({}). The RMS errors are against photographs that are not public; they are shown, not reproduced.",
            sources.join("; ")
        ));
        notes.push(String::from(
            "Empty under \"paper\": nothing was published for this model or case, or the row is not driven by the file.",
        ));
    }
    let any_measured =
        studies.iter().flat_map(Study::solved).any(|(_, solved)| solved.measured.is_some());
    for study in studies {
        let in_images = |m: &Measured| {
            !m.observations.is_empty()
                && m.observations.iter().all(|observation| observation.seen.is_in_image())
        };
        if study.file.measured.as_ref().is_some_and(in_images) {
            notes.push(format!(
                "{}: measured in images, which `whipcord overlay` compares with.",
                study.file.title
            ));
        }
        let measured = study.solved().filter_map(|(_, s)| s.measured.as_ref()?.as_ref().ok());
        if measured.into_iter().any(Distances::is_reversed) {
            notes.push(format!("! {}; {REVERSED_HELP}", reversed(&study.file)));
        }
        if let Some(why) = unmeasured(study).filter(|_| any_measured) {
            notes.push(format!("{}: {why}", study.file.title));
        }
        let of_runs = study
            .runs
            .iter()
            .flat_map(|run| notes_of(run).into_iter().map(move |what| (run.label(), what)));
        let of_runs = each_once(of_runs);
        notes.extend(of_runs.map(|(of, what)| format!("{}, {of}: {what}", study.file.title)));
    }
    notes
}

/// What is said of several models in the same words, once: their labels, and what is said.
pub fn each_once(
    notes: impl Iterator<Item = (String, String)>,
) -> impl Iterator<Item = (String, String)> {
    let mut known: Vec<(String, String)> = Vec::new();
    for (of, what) in notes {
        match known.iter_mut().find(|(_, said)| *said == what) {
            Some((names, _)) => *names += &format!("; {of}"),
            None => known.push((of, what)),
        }
    }
    known.into_iter()
}

/// How a measurement was moved onto an answer.
fn moved(compared: &Distances) -> Option<String> {
    let Pose { position, rotation } = compared.motion.as_ref()?;
    let (shift, turn) = (millimetres(position.norm()), degrees(rotation.log().norm()));
    let less = match compared.lowered.len() {
        0 => String::new(),
        lowered => format!(
            "; {lowered} of {} markers count less in that, because they are far off like jumps of a tracker",
            compared.markers.len()
        ),
    };
    Some(format!("measurement moved by {shift} and turned by {turn} onto it{less}"))
}

fn notes_of(run: &Run) -> Vec<String> {
    let solved = match &run.outcome {
        Err(error) => return vec![error.to_string()],
        Ok(solved) => solved,
    };
    let mut notes = Vec::new();
    if !solved.is_smooth {
        notes.push(String::from(
            "drawn through its disks alone, as no answer was found near it with more stations.",
        ));
    }
    notes.extend(solved.compared().and_then(moved));
    notes.extend(not_compared(solved).map(|why| format!("no distance to the measurement: {why}")));
    notes
}

/// Why an answer has no distance to what was measured in space; `None` where it has one, and where nothing was
/// measured in space.
pub fn not_compared(solved: &Solved) -> Option<String> {
    match solved.measured.as_ref()? {
        Ok(distances) => distances
            .rms()
            .is_none()
            .then(|| String::from("only markers on the base were measured")),
        Err(why) => Some(why.to_string()),
    }
}

/// Why no answer to a case has a distance to a measurement, where there is none in space; images have a note of their
/// own.
fn unmeasured(study: &Study) -> Option<&'static str> {
    match &study.file.measured {
        None => Some("no distance to a measurement: nothing was measured."),
        Some(measured) if measured.observations.is_empty() => {
            Some("no distance to a measurement: [measured] has no markers.")
        }
        Some(_) => None,
    }
}
