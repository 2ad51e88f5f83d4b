//! How far the models are from a table of measurements: the report of `score`.

mod data;
pub mod figures;
mod measures;
pub mod output;
pub mod report;
mod run;
mod single_cable;
mod solve;
pub mod tables;

use whipcord::ModelKind;

pub use data::{FileScore, MarkerScore, RowScore, Score};
pub use measures::{Measures, Missed, Summary, Worst};
pub use run::{KnownRows, Solved};
pub use solve::{Answers, Job, SolvedRow, Subject, Unsolved};

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
        Self { files: files.collect(), subjects, names, models, single_cable: None }
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
