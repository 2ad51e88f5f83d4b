//! The score of files, solved by several threads.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};

use whipcord::jobs::share;
use whipcord::{Cancel, ModelKind, Solution};
use whipcord_io::CaseFile;

use super::single_cable::single_cable;
use super::solve::{Answers, Job, Subject};
use super::{Score, report};
use crate::failure::Failure;
use crate::files::{Folder, plot_failure, unique_names};
use crate::remark::Remark;
use crate::score::{figures, output};

/// The answers to all measured rows, of which [`Solved::score`] makes a score.
#[derive(Clone, Debug)]
pub struct Solved {
    models: Vec<ModelKind>,
    jobs: Vec<Job>,
    answers: Vec<Answers>,
    single_cable: Option<Remark>,
}

/// The answers at the disks of a model to all rows of the file of a number, where they are known.
pub type KnownRows<'a> = dyn Fn(usize, ModelKind) -> Option<&'a [Solution]> + Sync + 'a;

/// Where files and models stand in the answers.
fn subjects<'a>(cases: &[&'a CaseFile]) -> Vec<Subject<'a>> {
    cases.iter().copied().map(Subject::new).collect()
}

impl Solved {
    /// Solves every measured row of every file by these models, in as many threads, by default one for each processor. The
    /// answers are the same for any number. `tell` is told how many pieces of work there are, then of each that is done.
    ///
    /// # Errors
    /// [`Failure`] for files without measurements in space, where the work was cancelled, and where so many threads cannot be started.
    pub fn of(
        cases: &[&CaseFile],
        models: Vec<ModelKind>,
        threads: Option<NonZero<usize>>,
        cancel: &Cancel,
        tell: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Self, Failure> {
        Self::with_known(cases, models, threads, cancel, (tell, &|_, _| None))
    }

    /// As [`Self::of`], where answers at the disks to all rows are known of some files, by their numbers, and models: those are not computed again if nothing was
    /// measured between disks and the rows are independent of each other.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn with_known<'a>(
        cases: &[&CaseFile],
        models: Vec<ModelKind>,
        threads: Option<NonZero<usize>>,
        cancel: &Cancel,
        (tell, known): (&(dyn Fn(usize, usize) + Sync), &KnownRows<'a>),
    ) -> Result<Self, Failure> {
        let subjects = subjects(cases);
        let unmeasured = subjects.iter().filter(|subject| subject.rows.is_empty());
        let unmeasured: Vec<String> = unmeasured
            .map(|subject| {
                format!(
                    "error: {}: nothing was measured in space: add [measured] with `table`, a CSV file with the columns x, y and z",
                    subject.file.path.display()
                )
            })
            .collect();
        if !unmeasured.is_empty() {
            return Err(Failure::Input(unmeasured.join("\n")));
        }
        let jobs = Job::all(&subjects, &models);
        let answers = solve(&jobs, &subjects, threads, cancel, (tell, known))?;
        if cancel.is_cancelled() {
            return Err(Failure::Solve("error: not all rows were solved".to_owned()));
        }
        let mut solved = Self { models, jobs, answers, single_cable: None };
        let best = solved.clone().score(cases).best();
        if let Some(best) = best {
            solved.single_cable = single_cable(cases, solved.models[best], threads, cancel);
        }
        if cancel.is_cancelled() {
            return Err(Failure::Solve("error: not all rows were solved".to_owned()));
        }
        Ok(solved)
    }

    /// The score of these files, which are those that were solved.
    #[must_use]
    pub fn score<'a>(self, cases: &[&'a CaseFile]) -> Score<'a> {
        let names = unique_names(cases.iter().map(|case| case.path.as_path()));
        let single_cable = self.single_cable;
        let score = Score::new(subjects(cases), names, self.models, &self.jobs, self.answers);
        Score { single_cable, ..score }
    }
}

impl Score<'_> {
    /// Writes the report, the pictures unless they are not wanted, and the tables to a folder. The report ends with these notes.
    ///
    /// # Errors
    /// [`Failure`] for what cannot be drawn or written.
    pub fn write(&self, folder: &Folder, draws: bool, notes: &[String]) -> Result<(), Failure> {
        let drawn = match draws {
            false => Vec::new(),
            true => figures::figures(self).map_err(|error| plot_failure(folder.path(), &error))?,
        };
        for figure in &drawn {
            folder.write(&format!("{}.svg", figure.name), &figure.svg)?;
        }
        folder.write_table("score.csv", &output::summary_csv(self))?;
        folder.write_table("rows.csv", &output::rows_csv(self))?;
        folder.write("report.html", &report::html(self, &drawn, notes))
    }
}

/// The answers of all jobs in their order, whatever the number of threads.
fn solve(
    jobs: &[Job],
    subjects: &[Subject<'_>],
    threads: Option<NonZero<usize>>,
    cancel: &Cancel,
    (tell, known): (&(dyn Fn(usize, usize) + Sync), &KnownRows<'_>),
) -> Result<Vec<Answers>, Failure> {
    let done = AtomicUsize::new(0);
    tell(0, jobs.len());
    let mut found: Vec<Answers> = jobs.iter().map(|_| Answers::new()).collect();
    let all = jobs.iter().zip(&mut found);
    let shared = share(
        all,
        threads,
        || (),
        |(job, answers), ()| {
            *answers = job.solve(&subjects[job.file], known(job.file, job.model), cancel);
            tell(done.fetch_add(1, Ordering::Relaxed) + 1, jobs.len());
            true
        },
    );
    shared.map_err(|error| Failure::Input(format!("error: {error}")))?;
    Ok(found)
}
