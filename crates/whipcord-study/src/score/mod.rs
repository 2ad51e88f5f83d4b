//! How far the models are from a table of measurements: the report of `score`.

pub mod figures;
mod measures;
pub mod output;
pub mod report;
mod solve;
pub mod tables;

use whipcord::{ModelKind, Pose, SolveError, Vec3};
use whipcord_io::CaseFile;

pub use measures::{Measures, Summary, Worst};
pub use solve::{Answers, Job, SolvedRow, Subject, Unsolved};

/// The models on all rows of all files.
#[derive(Clone, Debug)]
pub struct Score<'a> {
    /// The files, and where their robots were measured.
    pub subjects: Vec<Subject<'a>>,
    /// What the names of the files are in tables, each another one.
    pub names: Vec<String>,
    /// The models, in the order of the tables.
    pub models: Vec<ModelKind>,
    /// By files, then by models.
    pub files: Vec<Vec<FileScore>>,
}

/// A model on the rows of one file.
#[derive(Clone, Debug)]
pub struct FileScore {
    /// The model.
    pub model: ModelKind,
    /// What it says of the rows in which something was measured, in their order.
    pub rows: Vec<RowScore>,
    /// The markers of all rows that are compared.
    pub markers: Vec<MarkerScore>,
    /// How the measurement was moved onto the answers, where that was asked for.
    pub motion: Option<Pose>,
    /// Why no row can be compared, though rows have answers.
    pub incomparable: Option<String>,
    /// Why the model does not take the robot.
    pub refused: Option<SolveError>,
    /// Whether the rotation of the tracked body on the robot was estimated from the rows.
    pub body_is_estimated: bool,
}

/// A model on one row.
#[derive(Clone, Debug)]
pub struct RowScore {
    /// The row, from 0.
    pub row: usize,
    /// Why it has no answer.
    pub failure: Option<Unsolved>,
    /// Whether the answer is an unstable equilibrium.
    pub unstable: bool,
    /// Root mean square distance in m over the markers of the row that are not on the base; `None` where nothing is compared.
    pub error: Option<f64>,
    /// Angle in rad between the measured and the computed orientation of the tracked body.
    pub angle: Option<f64>,
}

/// A marker in one row.
#[derive(Clone, Copy, Debug)]
pub struct MarkerScore {
    /// The row, from 0.
    pub row: usize,
    /// Where on the backbone it is, in m.
    pub arc_length: f64,
    /// Where it was measured, in m, after the measurement was moved.
    pub measured: Vec3,
    /// Where the model has it.
    pub model: Vec3,
    /// Whether the base holds it.
    pub at_base: bool,
}

impl MarkerScore {
    /// Distance in m of the model's place from the measured one.
    #[must_use]
    pub fn distance(&self) -> f64 {
        (self.model - self.measured).norm()
    }
}

impl<'a> Score<'a> {
    /// The score of these answers, one for each of these jobs.
    #[must_use]
    pub fn new(
        subjects: Vec<Subject<'a>>,
        names: Vec<String>,
        models: Vec<ModelKind>,
        jobs: &[Job],
        answers: Vec<Answers>,
    ) -> Self {
        let mut of_files: Vec<Vec<Answers>> = vec![vec![Vec::new(); models.len()]; subjects.len()];
        for (job, answers) in jobs.iter().zip(answers) {
            if let Some(model) = models.iter().position(|model| *model == job.model) {
                of_files[job.file][model].extend(answers);
            }
        }
        let files = subjects.iter().zip(of_files).map(|(subject, of_models)| {
            let of_models = models.iter().zip(of_models);
            of_models.map(|(model, answers)| FileScore::new(subject, *model, answers)).collect()
        });
        Self { files: files.collect(), subjects, names, models }
    }

    /// The file of this number.
    #[must_use]
    pub fn file(&self, number: usize) -> &'a CaseFile {
        self.subjects[number].file
    }

    /// A model, by its number, over all files.
    #[must_use]
    pub fn summary(&self, model: usize) -> Summary {
        let of_files = self.files.iter().enumerate().map(|(file, models)| (file, &models[model]));
        Summary::of(self, of_files)
    }

    /// A model, by its number, on one file.
    #[must_use]
    pub fn of_file(&self, file: usize, model: usize) -> Summary {
        Summary::of(self, [(file, &self.files[file][model])].into_iter())
    }

    /// The number of the model with the least root mean square error.
    #[must_use]
    pub fn best(&self) -> Option<usize> {
        let errors = (0..self.models.len())
            .filter_map(|model| Some((model, self.summary(model).distances?.rms)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(model, _)| model)
    }

    /// How a row is called in tables for people.
    #[must_use]
    pub fn label(&self, file: usize, row: usize) -> String {
        let of_file = self.file(file);
        let label = match &of_file.commands {
            Some(table) => table.label(row),
            None if of_file.case.before.is_empty() => String::new(),
            None => format!("step {}", row + 1),
        };
        match (self.subjects.len(), label.is_empty()) {
            (1, false) => label,
            (_, true) => self.names[file].clone(),
            (_, false) => format!("{}, {label}", self.names[file]),
        }
    }
}
