//! The folder of a report on a design.

use std::path::Path;

use serde_json::Value;
use whipcord::{Model, Vec3};
use whipcord_design::{Design, TolerancesResult};
use whipcord_io::{
    CaseFile, CsvTable, design_errors_table, distributions, holes_table, quantile, samples_table,
};
use whipcord_plot::{
    Acting, DiskDrawingOptions, DistanceSeries, Drafting, FigureOptions, RobotView, disk_drawing,
    disk_sheet, distance_chart, histogram_chart, label, robot_figure,
};

use crate::smooth::smooth;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::quantity::number;

/// All files of a report, ready to be written.
pub struct Report {
    figures: Vec<(String, String)>,
    tables: Vec<(&'static str, CsvTable)>,
    drawings: Vec<(String, String)>,
}

impl Report {
    /// Of a robot with its target shapes.
    pub fn new(
        file: &CaseFile,
        model: &Model,
        design: &Design,
        tolerances: &TolerancesResult,
    ) -> Result<Self, Failure> {
        let drawn = |error| Failure::Input(format!("error: the design cannot be drawn: {error}"));
        let mut figures = Vec::new();
        let count = design.goals.len();
        for (k, goal) in design.goals.iter().enumerate() {
            let mut file = file.clone();
            file.case = goal.case.clone();
            let fine = smooth(model, &file, &goal.solution);
            let targets: Vec<Vec3> = goal.points.iter().map(|(_, point)| *point).collect();
            let loads = Acting::on(&file.case, &fine.shape);
            let title = file.title.clone();
            let options = FigureOptions { title, targets, loads, ..FigureOptions::default() };
            let options = options.among(&file.case.obstacles, Some(&goal.solution));
            let views = [
                RobotView::at_rest(&file.robot, file.case.base),
                RobotView::model(label(design.model.to_string(), &goal.solution), &fine),
            ];
            let name = if count == 1 { "shape".to_owned() } else { format!("shape-{}", k + 1) };
            figures.push((name, robot_figure(&file.robot, &views, &options).map_err(drawn)?));
        }
        let series = design.goals.iter().enumerate().map(|(k, goal)| {
            let disks = goal.points.iter().map(|(disk, _)| disk + 1);
            let disks = disks.zip(goal.distances.iter().copied()).collect();
            let label = if count == 1 { "error".to_owned() } else { format!("target {}", k + 1) };
            DistanceSeries { label, disks, look: None, hollow: false }
        });
        let series: Vec<DistanceSeries> =
            series.filter(|series: &DistanceSeries| !series.disks.is_empty()).collect();
        if !series.is_empty() {
            let title = format!("{}: distance from the target", file.title);
            let chart = distance_chart(&title, &series);
            figures.push(("errors".to_owned(), chart.map_err(drawn)?));
        }
        if let Some(of) = histograms(tolerances) {
            let title = format!("{}: what tolerances of manufacture do", file.title);
            let chart = histogram_chart(&title, "distance", &of).map_err(drawn)?;
            figures.push(("tolerances".to_owned(), chart));
        }
        let mut drawings = Vec::new();
        if design.robot.has_disks() {
            let options = DiskDrawingOptions::default();
            let mut add = |name: String, drawing: &Drafting| -> Result<(), Failure> {
                drawings.push((format!("{name}.svg"), drawing.svg().map_err(drawn)?));
                drawings.push((format!("{name}.dxf"), drawing.dxf().map_err(drawn)?));
                Ok(())
            };
            add("disks".to_owned(), &disk_sheet(&design.robot, &file.title, &options))?;
            for disk in 0..design.robot.disks().count() {
                let drawing = disk_drawing(&design.robot, disk, &options);
                add(format!("disk-{:02}", disk + 1), &drawing)?;
            }
        }
        let tables = vec![
            ("errors.csv", design_errors_table(design)),
            ("holes.csv", holes_table(&design.robot)),
            ("tolerances.csv", samples_table(tolerances)),
        ];
        Ok(Self { figures, tables, drawings })
    }

    /// Writes them to a folder, with the design as JSON.
    pub fn write(&self, folder: &Path, json: &Value) -> Result<(), Failure> {
        let folder = Folder::create(folder)?;
        folder.write("design.json", &format!("{json:#}\n"))?;
        for (name, svg) in &self.figures {
            folder.write_figure(name, svg)?;
        }
        for (name, table) in &self.tables {
            folder.write_table(name, table)?;
        }
        for (name, text) in &self.drawings {
            files::write(&folder.path().join(name), text.as_bytes())?;
        }
        Ok(())
    }
}

/// The distributions of a report: of the shift of the tip, and of the worst disk where there is a target; none without samples.
fn histograms(of: &TolerancesResult) -> Option<Vec<(String, Vec<f64>)>> {
    let count = of.goals.len();
    let mut all = Vec::new();
    // More lines cannot be told apart.
    for (k, samples) in of.goals.iter().enumerate().take(3) {
        let target = if count == 1 { String::new() } else { format!(", target {}", k + 1) };
        for (name, values) in distributions(samples) {
            let words = match name {
                "tip_shift" => "tip from where it is without deviations",
                "worst_disk" if values.iter().any(|value| *value > 0.0) => {
                    "worst disk from its target"
                }
                _ => continue,
            };
            if !values.is_empty() {
                all.push((format!("{words}{target}"), values));
            }
        }
    }
    (!all.is_empty()).then_some(all)
}

/// What the tolerances do, in words.
pub fn tolerance_words(of: &TolerancesResult) -> String {
    let mut text = String::new();
    for samples in &of.goals {
        for (name, values) in distributions(samples) {
            let words = match name {
                "tip_shift" => "tip from where it is without deviations",
                "worst_disk" => "worst disk from its target",
                _ => continue,
            };
            if let [Some(half), Some(most)] = [0.5, 0.95].map(|part| quantile(&values, part)) {
                text += &format!(
                    "tolerances: {words}: {} mm in half of {} robots, {} mm in 95 %\n",
                    number(1e3 * half, 3),
                    values.len(),
                    number(1e3 * most, 3)
                );
            }
        }
    }
    text
}
