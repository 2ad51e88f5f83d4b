//! `whipcord bench`: how cost and accuracy grow with sections and steps.

use std::path::PathBuf;

use clap::Args;
use whipcord::ModelKind;
use whipcord_plot::{
    AccuracySeries, Colour, Marker, Scale, TimingSeries, accuracy_chart, timing_chart,
};

use crate::inputs::{Inputs, Settings};
use crate::progress;
use crate::warnings::Warnings;
use whipcord_study::benchmark::Samples;
use whipcord_study::benchmark::accuracy::{StepError, step_errors};
use whipcord_study::benchmark::cost::{Cost, SECTIONS, cost, refusal};
use whipcord_study::benchmark::paper::{self, Example};
use whipcord_study::benchmark::tables;
use whipcord_study::failure::Failure;
use whipcord_study::files::Folder;
use whipcord_study::style::Style;

/// Measure solve time against number of sections (Fig. 4 of the paper), and the error of the
/// Cosserat model against its integration steps
///
/// Times every model on every robot, divided into 5, 10, 20, 50, 125 and 320 sections of the same
/// total length. Times are for solves without a warm start, and exclude the construction of the
/// model. The Cosserat model takes one integration step for each section.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// Robot files, or folders of them; by default the four robots of Table 1 of the paper
    files: Vec<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    /// Folder for the CSV files and the figures
    #[arg(long, value_name = "DIR", default_value = "whipcord-bench")]
    out: PathBuf,
    #[command(flatten)]
    warnings: Warnings,
}

/// The models whose cost the paper's question is about; those that it does not know `compare` times.
const TIMED: [ModelKind; 3] = [ModelKind::Cosserat, ModelKind::CosseratDisks, ModelKind::FourBar];

/// Measures, writes the files, and returns the tables.
pub fn run(args: &BenchArgs, style: Style) -> Result<String, Failure> {
    let (examples, mut notes) = examples(&args.files, &args.settings, args.warnings)?;
    let folder = Folder::create(&args.out)?;

    let cost_jobs: Vec<(ModelKind, usize, usize)> = TIMED
        .into_iter()
        .flat_map(|kind| (0..examples.len()).map(move |example| (kind, example)))
        .flat_map(|(kind, example)| SECTIONS.map(|sections| (kind, example, sections)))
        .collect();
    let progress = progress::bar(cost_jobs.len() + examples.len());
    let mut costs: Vec<Cost> = Vec::with_capacity(cost_jobs.len());
    for (kind, example, sections) in cost_jobs {
        progress.set_message(format!("{kind}, {sections} sections"));
        costs.push(cost(kind, example, &examples, sections));
        progress.inc(1);
    }
    let mut errors: Vec<StepError> = Vec::new();
    for (index, example) in examples.iter().enumerate() {
        progress.set_message("error against steps");
        // Why the model does not solve the robot at all, the costs say.
        if refusal(ModelKind::Cosserat, example).is_none() {
            match step_errors(index, &examples) {
                Ok(list) => errors.extend(list),
                Err(error) => {
                    notes.push(format!("{}: error against steps: {error}", example.title));
                }
            }
        }
        progress.inc(1);
    }
    progress.finish_and_clear();

    notes.extend(tables::failures(&examples, &costs));
    if costs.iter().all(|cost| cost.samples.is_err()) {
        return Err(Failure::Solve(format!(
            "error: there is nothing to time\n{}",
            notes.join("\n")
        )));
    }

    folder.write_table("cost.csv", &tables::cost_csv(&examples, &costs))?;
    folder.write_table("lines.csv", &tables::line_csv(&examples, &costs))?;
    if !errors.is_empty() {
        folder.write_table("accuracy.csv", &tables::accuracy_csv(&examples, &errors))?;
    }
    for (name, svg) in figures(&examples, &costs, &errors)? {
        folder.write_figure(&name, &svg)?;
    }

    let mut text = style.heading("Solve time against number of sections") + "\n\n";
    text += &tables::cost_table(&examples, &costs).text(style);
    text += "\nLeast-squares lines through the means:\n";
    for line in tables::line_words(&costs) {
        text += &format!("  {line}\n");
    }
    if !errors.is_empty() {
        text += &format!(
            "\n{}\n\n",
            style.heading("Error of the Cosserat model against integration steps")
        );
        text += &tables::accuracy_table(&examples, &errors).text(style);
    }
    text += &format!(
        "\nMean and standard deviation of {} measurements for each robot; a solve is cold, by a model that is built.\nFigures and CSV: {}\n",
        Samples::COUNT,
        folder.path().display()
    );
    for note in notes {
        text += &format!("note: {note}\n");
    }
    Ok(text)
}

fn examples(
    files: &[PathBuf],
    settings: &Settings,
    warnings: Warnings,
) -> Result<(Vec<Example>, Vec<String>), Failure> {
    if files.is_empty() {
        let examples =
            paper::table_1().map_err(|error| Failure::Input(format!("error: {error}")))?;
        return Ok((examples, Vec::new()));
    }
    let Inputs { cases, notes } = Inputs::read(files, settings)?;
    let warned: Vec<_> = cases.iter().map(|file| (file, file.warnings())).collect();
    warnings.tell_all(&warned)?;
    let examples = cases
        .into_iter()
        .map(|file| Example { title: file.title, robot: file.robot, case: file.case })
        .collect();
    Ok((examples, notes))
}

/// Names and SVG of the figures.
fn figures(
    examples: &[Example],
    costs: &[Cost],
    errors: &[StepError],
) -> Result<Vec<(String, String)>, Failure> {
    // A colour for each model, a sign for each robot.
    let timings: Vec<TimingSeries> = ModelKind::ALL
        .into_iter()
        .flat_map(|model| {
            let looks = examples.iter().enumerate();
            looks.map(move |(index, example)| TimingSeries {
                label: format!("{model}, {}", example.title),
                runs: costs
                    .iter()
                    .filter(|cost| cost.model == model && cost.example == index)
                    .filter_map(|cost| Some((cost.sections, cost.samples.as_ref().ok()?)))
                    .flat_map(|(sections, s)| s.times.iter().map(move |&time| (sections, time)))
                    .collect(),
                look: Some((Colour::of_model(model), Marker::nth(index))),
            })
        })
        .filter(|series| !series.runs.is_empty())
        .collect();
    let accuracies: Vec<AccuracySeries> = examples
        .iter()
        .enumerate()
        .map(|(index, example)| AccuracySeries {
            label: example.title.clone(),
            errors: errors
                .iter()
                .filter(|error| error.example == index)
                .map(|error| (error.steps, error.error))
                .collect(),
            look: None,
        })
        .filter(|series| !series.errors.is_empty())
        .collect();
    let title = "Solve time against number of sections";
    let mut figures = vec![
        ("time".to_owned(), timing_chart(title, &timings, Scale::Linear)),
        ("time-logarithmic".to_owned(), timing_chart(title, &timings, Scale::Log)),
    ];
    if !accuracies.is_empty() {
        let title = "Error of the Cosserat model against integration steps";
        figures.push(("accuracy".to_owned(), accuracy_chart(title, &accuracies, &[6])));
    }
    figures
        .into_iter()
        .map(|(name, svg)| {
            let svg = svg.map_err(|error| Failure::Input(format!("error: {name}: {error}")))?;
            Ok((name, svg))
        })
        .collect()
}
