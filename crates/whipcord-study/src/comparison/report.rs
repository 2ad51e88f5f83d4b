//! The report: one HTML file that needs no other and no network.

use whipcord::{CableState, ModelKind};
use whipcord_estimation::observation::Distances;
use whipcord_plot::Colour;

use super::study::{Commands, FAR, Study};
use super::tables::{self, OUTLIER, each_once, not_compared, with_mark};
use crate::contacts;
use crate::describe::{describe, instability};
use crate::html::{Figure, Place, contents, escape, footer, list, page};
use crate::quantity::{fixed_millimetres, newtons, number, percent};
use crate::table::{Align, Table};

/// The report of these cases with the figures of each and a small picture of each that has a shape; `recommendation` says which model
/// to use for what, `accuracy` is the section about all cases. The verdict comes first, then one page for each case.
pub fn html(
    studies: &[Study],
    figures: &[Vec<Figure>],
    multiples: &[Option<String>],
    recommendation: &str,
    accuracy: &str,
    passed_over: &[String],
) -> String {
    let mut body = String::from("<h1>Models side by side</h1>\n");
    body += &format!(
        "<section id=\"verdict\"><h2>Verdict</h2>\n<p>{}</p>\n{recommendation}</section>\n",
        escape(&verdict(studies))
    );
    body += &contents(&places(studies, accuracy));
    body += "<section id=\"answers\"><h2>Answers</h2>\n";
    body += &overview(studies, multiples);
    body += &tables::summary(studies, true).html();
    let outliers = studies.iter().any(Study::has_outliers).then(outlier_note);
    body += &list(outliers.iter().chain(&tables::notes(studies)).chain(passed_over));
    body += "</section>\n";
    for (i, (study, figures)) in studies.iter().zip(figures).enumerate().take(MOST_SECTIONS) {
        body += &section(i + 1, study, figures);
    }
    if studies.len() > MOST_SECTIONS {
        body += &format!(
            "<p class=\"notes\">The first {MOST_SECTIONS} of {} cases have a section of their own; cases.csv and &lt;case&gt;-*.csv have all.</p>\n",
            studies.len()
        );
    }
    body += accuracy;
    body += &footer();
    page("Whipcord: models side by side", &body)
}

/// More cases than this have no sections of their own: a report of hundreds would be of tens of megabytes.
const MOST_SECTIONS: usize = 100;

/// What is in the report.
fn places(studies: &[Study], accuracy: &str) -> Vec<Place> {
    let named = |id: &str, title: &str, detail: String| Place {
        id: id.to_owned(),
        title: title.to_owned(),
        detail,
    };
    let mut places = vec![
        named("verdict", "Verdict", String::new()),
        named("answers", "Answers", String::new()),
    ];
    let case = |(i, study): (usize, &Study)| {
        named(&format!("case-{}", i + 1), &study.file.title, study.file.path.display().to_string())
    };
    places.extend(studies.iter().enumerate().take(MOST_SECTIONS).map(case));
    let more = [("accuracy", "Accuracy and time"), ("measurements", "Against the measurements")];
    for (id, title) in more {
        if accuracy.contains(&format!("id=\"{id}\"")) {
            places.push(named(id, title, String::new()));
        }
    }
    places
}

/// The greatest distance of a model from the reference model, and which model that is.
fn farthest(study: &Study) -> Option<(String, f64)> {
    let far = study
        .solved()
        .filter_map(|(run, solved)| Some((run.label(), study.distance_to_reference(run, solved)?)));
    far.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// In one sentence for each: how near the models are, and what has no answer.
fn verdict(studies: &[Study]) -> String {
    let runs = || studies.iter().flat_map(|study| study.runs.iter().map(move |run| (study, run)));
    let compared = studies.iter().filter(|study| farthest(study).is_some()).count();
    let agree = studies
        .iter()
        .filter(|study| farthest(study).is_some_and(|(_, distance)| !study.is_far(distance)))
        .count();
    let mut words = match (studies.len(), compared) {
        (1, 0) => {
            String::from("One model has an answer, so that there is nothing to compare it with.")
        }
        (_, 0) => String::from("No case has answers of two models to compare."),
        (1, _) if agree == 1 => {
            format!("The models agree: they differ by less than {} of the length.", percent(FAR))
        }
        (1, _) => format!("The models differ: one by more than {} of the length.", percent(FAR)),
        _ => format!(
            "In {agree} of {compared} cases with answers of several models, all of these agree within {} of the length.",
            percent(FAR)
        ),
    };
    let worst = studies
        .iter()
        .filter_map(|study| Some((study, farthest(study)?)))
        .map(|(study, (label, far))| (study, label, far, far / study.file.robot.backbone().length))
        .max_by(|a, b| a.3.total_cmp(&b.3));
    if let Some((study, label, distance, share)) = worst {
        let place =
            if studies.len() > 1 { format!(" in {}", study.file.title) } else { String::new() };
        words +=
            &format!(" Farthest from the reference is {label}{place}: {}.", apart(distance, share));
    }
    let failed = runs().filter(|(_, run)| run.outcome.is_err()).count();
    if failed > 0 {
        words += &format!(" {failed} of {} solves have no answer.", runs().count());
    }
    let unstable = runs().filter(|(_, run)| run.is_unstable()).count();
    if unstable > 0 {
        words += &format!(" {unstable} answers are unstable.");
    }
    words
}

/// A small picture of each case, which leads to its page, with what there is to say in a line.
fn overview(studies: &[Study], multiples: &[Option<String>]) -> String {
    if multiples.iter().all(Option::is_none) {
        return String::new();
    }
    let mut models: Vec<ModelKind> = Vec::new();
    for (run, _) in studies.iter().flat_map(Study::solved) {
        if !models.contains(&run.model) {
            models.push(run.model);
        }
    }
    let mut html = String::from("<ul class=\"key\">");
    for model in models {
        let colour = Colour::of_model(model);
        html += &format!("<li><span style=\"background: {colour}\"></span>{model}</li>");
    }
    html += "</ul>\n<ul class=\"multiples\">\n";
    for (i, (study, picture)) in studies.iter().zip(multiples).enumerate() {
        let title = escape(&study.file.title);
        let title = match i < MOST_SECTIONS {
            true => format!("<a href=\"#case-{}\">{title}</a>", i + 1),
            false => title,
        };
        html += &format!(
            "<li>{title}{}<p>{}</p></li>\n",
            picture.as_deref().unwrap_or_default(),
            escape(&line(study))
        );
    }
    html += "</ul>\n<p class=\"notes\">All pictures have one scale. Left: the backbones, seen from the side to which they bend, \
             grey before actuation. Right: the distances at the disks.</p>\n";
    html
}

/// A case in a line.
fn line(study: &Study) -> String {
    let Some((label, distance)) = farthest(study) else {
        return match study.reference() {
            Some((run, _)) => format!("{} alone has an answer.", run.label()),
            None => String::from("No model has an answer."),
        };
    };
    let words = apart(distance, distance / study.file.robot.backbone().length);
    if study.is_far(distance) {
        format!("{OUTLIER} {label} is off by {words}.")
    } else {
        format!("All agree within {words}.")
    }
}

/// A distance over all disks in m, which is this share of the length.
fn apart(distance: f64, share: f64) -> String {
    format!("{} mm RMS, {} % of the length", fixed_millimetres(distance, 2), number(share * 1e2, 2))
}

/// What the mark of outliers means.
fn outlier_note() -> String {
    format!("{OUTLIER} outlier: farther off than {} of the backbone's length.", percent(FAR))
}

fn section(number: usize, study: &Study, figures: &[Figure]) -> String {
    let file = &study.file;
    let mut html = format!(
        "<section class=\"case\" id=\"case-{number}\"><h2>{}</h2>\n<p class=\"path\">{}</p>\n<dl>\n",
        escape(&file.title),
        escape(&source(study))
    );
    for (name, value) in describe(&file.robot, &file.case) {
        html += &format!("<dt>{}</dt><dd>{}</dd>\n", escape(&name), escape(&value));
    }
    html += "</dl>\n";
    let warnings: Vec<String> =
        study.warnings.iter().map(|of| format!("Warning: {}", of.message())).collect();
    html += &list(warnings.iter());
    if !figures.is_empty() {
        html += "<div class=\"figures\">\n";
        for (k, figure) in figures.iter().enumerate() {
            html += &figure.html_within(&format!("case-{number}-figure-{}", k + 1));
        }
        html += "</div>\n";
    }
    let disks = disk_table(study);
    if !disks.is_empty() {
        html += "<h3>Distances at the disks</h3>\n";
        html += &disks.html();
        html += &list(&disk_notes(study));
    }
    let cables = cable_table(study);
    if !cables.is_empty() {
        html += "<h3>Cables</h3>\n";
        html += &cables.html();
        let no_tension = |cable: &CableState| cable.tension.is_none();
        let lacking = study.solved().filter(|(_, of)| of.solution.cables.iter().any(no_tension));
        let lacking: Vec<String> = lacking.map(|(run, _)| run.label()).collect();
        if !lacking.is_empty() {
            html += &list([&format!("–: {} computes no tensions.", lacking.join("; "))]);
        }
    }
    for (run, solved) in study.solved() {
        let obstacles = &file.case.obstacles;
        if let Some(overlaps) = contacts::cable_overlaps(&file.robot, &solved.solution, obstacles) {
            html += &format!("<h3>Cables through obstacles: {}</h3>\n", escape(&run.label()));
            html += &overlaps.html();
        }
        if let Some(touches) = contacts::table(&solved.solution, &file.case.obstacles) {
            html += &format!("<h3>Contact: {}</h3>\n", escape(&run.label()));
            html += &touches.html();
            if let Some(grasps) = contacts::grasps(&solved.solution, &file.case.obstacles) {
                html += &grasps.html();
            }
        }
    }
    html += &list(&case_notes(study));
    html + "</section>\n"
}

/// Where the case comes from, and where its numbers are.
fn source(study: &Study) -> String {
    let path = study.file.path.display();
    match study.reference() {
        Some(_) => format!("{path}; numbers in {}-*.csv", study.stem),
        None => path.to_string(),
    }
}

/// Distance in mm of each run to the reference and to the measurement, disk by disk; the root mean square over all
/// steps.
fn disk_table(study: &Study) -> Table {
    let count = study.file.robot.disks().count();
    let mut columns: Vec<(String, Vec<Option<f64>>)> = Vec::new();
    let Some((first, reference)) = study.reference() else {
        return Table::new([("disk", Align::Left)]);
    };
    for (run, solved) in study.solved() {
        if run.model != first.model || run.commands != first.commands {
            let distances = solved.distances(reference).into_iter().map(Some).collect();
            columns.push((format!("{} to {}", run.label(), first.label()), distances));
        }
        if let Some(compared) = solved.compared() {
            let distances = (1..=count).map(|disk| compared.rms_of_disk(disk)).collect();
            columns.push((format!("{} to measured", run.label()), distances));
        }
    }
    let names = columns.iter().map(|(name, _)| (name.clone(), Align::Right));
    let mut table = Table::new([(String::from("disk"), Align::Left)].into_iter().chain(names))
        .with_units([""].into_iter().chain(columns.iter().map(|_| "mm")));
    if columns.is_empty() {
        return table;
    }
    table.group();
    for disk in 0..count {
        let distance = |of: &[Option<f64>]| match of.get(disk).copied().flatten() {
            Some(distance) => with_mark(study, distance),
            None => String::from("–"),
        };
        let cells = columns.iter().map(|(_, of)| distance(of));
        table.row([(disk + 1).to_string()].into_iter().chain(cells).collect());
    }
    table
}

/// What the table of the disks is over, and why cells of it are empty.
fn disk_notes(study: &Study) -> Vec<String> {
    let mut notes = Vec::new();
    let steps = study.file.case.before.len() + 1;
    if steps > 1 {
        notes.push(format!(
            "Root mean square over all {steps} steps; to measured, over those in which the disk was measured."
        ));
    }
    let of_disks = |compared: &Distances| {
        (1..=study.file.robot.disks().count()).any(|disk| compared.rms_of_disk(disk).is_none())
    };
    if study.solved().filter_map(|(_, solved)| solved.compared()).any(of_disks) {
        notes.push(String::from("–: the centre of the disk was not measured."));
    }
    let reasons =
        study.solved().filter_map(|(run, solved)| Some((run.label(), not_compared(solved)?)));
    let reasons = each_once(reasons);
    notes.extend(reasons.map(|(of, why)| format!("{of}: no distance to the measurement: {why}.")));
    notes
}

fn cable_table(study: &Study) -> Table {
    let mut table = Table::new([
        ("model", Align::Left),
        ("cable", Align::Left),
        ("tension", Align::Right),
        ("length", Align::Right),
        ("shortening", Align::Right),
        ("shortening", Align::Right),
        ("", Align::Left),
    ])
    .with_units(["", "", "with its unit", "mm", "mm", "%"]);
    table.group();
    for (run, solved) in study.solved() {
        for cable in &solved.solution.cables {
            let shortening = cable.initial_length - cable.length;
            table.row(vec![
                run.label(),
                cable.name.clone(),
                cable.tension.map_or_else(|| String::from("–"), newtons),
                fixed_millimetres(cable.length, 3),
                fixed_millimetres(shortening, 3),
                percent(shortening / cable.initial_length),
                if cable.slack { String::from("slack") } else { String::new() },
            ]);
        }
    }
    table
}

/// What a reader must know of this case to read its numbers rightly.
fn case_notes(study: &Study) -> Vec<String> {
    let mut notes: Vec<String> = study
        .runs
        .iter()
        .map(|run| match (&run.outcome, run.commands) {
            (Err(error), _) => format!("{}: {error}.", run.label()),
            (Ok(_), Commands::File) => format!("{}: driven by {}, from the file.", run.label(), run.driven_by),
            (Ok(_), Commands::CosseratShape) => format!(
                "{}: driven by {}, which is what the cables lose from hole to hole in the Cosserat shape.",
                run.label(),
                run.driven_by
            ),
        })
        .collect();
    notes.extend(study.solved().filter_map(|(run, solved)| {
        Some(format!("{}: {}.", run.label(), instability(&solved.solution)?))
    }));
    if let Some(reference) = &study.file.reference {
        let models = [
            (
                "optimisation-based (four-bar) model",
                reference.rms_four_bar,
                reference.time_four_bar,
            ),
            ("Cosserat model", reference.rms_cosserat, reference.time_cosserat),
        ];
        let mut values = Vec::new();
        for (name, rms, time) in models {
            values.extend(rms.map(|rms| format!("{name}: RMS error {} mm", number(rms * 1e3, 4))));
            values.extend(time.map(|time| format!("{name}: solve time {} s", number(time, 4))));
        }
        notes.push(format!(
            "Published, not computed here ({}): {}. These errors are against photographs that are not public.",
            reference.source,
            values.join("; ")
        ));
    }
    notes
}
