//! Solves the parts of a sweep and writes them.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use parquet::file::reader::FileReader as _;
use parquet::file::serialized_reader::SerializedFileReader;
use whipcord::batch::BatchError;
use whipcord::jobs::share;
use whipcord_io::{Column, Values, columns_to_parquet, remove_stale, write_one_of_many};

use crate::error::SweepError;
use crate::manifest::claim;
use crate::outputs::Output;
use crate::plan::Plan;
use crate::solve::{Answers, Part};

/// Which parts are made, and how.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Of so many shards the one with this number: (number, count).
    pub shard: (u64, u64),
    /// Go on with a data set that was begun.
    pub resume: bool,
    /// Called with the number of rows of this shard that are written, and of all of them, by one thread at a time.
    pub progress: Option<&'a (dyn Fn(u64, u64) + Sync)>,
}

impl Default for RunOptions<'_> {
    fn default() -> Self {
        Self { shard: (0, 1), resume: false, progress: None }
    }
}

/// What became of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Rows of this shard.
    pub rows: u64,
    /// Parts of this shard.
    pub parts: u64,
    /// Parts that were there already.
    pub kept: u64,
    /// Rows of the new parts without an answer.
    pub failed: u64,
    /// Rows of the new parts whose equilibrium is unstable.
    pub unstable: u64,
    /// The first row of the new parts without an answer, and why.
    pub first_failure: Option<(u64, String)>,
}

/// The file of a part.
#[must_use]
pub fn part_name(part: u64) -> String {
    format!("part-{part:06}.parquet")
}

/// Solves the parts of a shard that are not there yet and writes each whole or not at all: a process that is killed loses no more
/// than the parts in progress. What a part holds depends on neither shard nor threads.
///
/// # Errors
/// [`SweepError`]; after [`SweepError::Stopped`] and [`SweepError::Write`] it can be resumed.
pub fn run(plan: &Plan, folder: &Path, options: &RunOptions<'_>) -> Result<Summary, SweepError> {
    let (number, count) = options.shard;
    if number >= count {
        return Err(SweepError::Shard { number, count });
    }
    let create = |source| SweepError::Write { path: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(create)?;
    let is_known = claim(folder, &plan.manifest())?;
    // What killed processes left behind.
    remove_stale(folder);
    let is_mine = |part: &u64| *part < plan.parts() && part % count == number;
    let kept: BTreeSet<u64> = match is_known {
        true => whole_parts(plan, folder)?.into_iter().filter(is_mine).collect(),
        false => BTreeSet::new(),
    };
    if !kept.is_empty() && !options.resume {
        return Err(SweepError::Begun { folder: folder.to_owned() });
    }
    let parts = plan.parts().saturating_sub(number).div_ceil(count);
    let last = plan.parts() - 1;
    let short = if is_mine(&last) { plan.rows_per_part() - plan.rows_of(last).1 } else { 0 };
    let rows = parts * plan.rows_per_part() - short;
    let done = kept.iter().map(|part| plan.rows_of(*part).1).sum();
    let summary = Summary { rows, parts, kept: kept.len() as u64, ..Summary::default() };
    let tally = Mutex::new(Tally { summary, done, failure: None });
    let tell = |done| options.progress.iter().for_each(|progress| progress(done, rows));
    tell(done);
    let step = usize::try_from(count).unwrap_or(usize::MAX);
    let mine = (number..plan.parts()).step_by(step).filter(|part| !kept.contains(part));
    // Each thread makes whole parts, so that none waits for another to write; where fewer parts are left than threads, these share
    // the rows of a part.
    let shared = share(
        mine,
        None,
        || (),
        |part, ()| {
            let made = plan.make(part, folder);
            // What panics elsewhere ends all.
            let mut tally = tally.lock().unwrap_or_else(PoisonError::into_inner);
            let outcome = made.map(|made| {
                tally.done += plan.rows_of(part).1;
                tally.summary.add(made);
                tell(tally.done);
            });
            let error = outcome.err();
            let goes_on = error.is_none();
            if tally.failure.is_none() {
                tally.failure = error;
            }
            goes_on
        },
    );
    shared.map_err(BatchError::from)?;
    let Tally { summary, done, failure } =
        tally.into_inner().unwrap_or_else(PoisonError::into_inner);
    match failure {
        None => Ok(summary),
        Some(NotMade::Stopped) => Err(SweepError::Stopped { done, rows }),
        Some(NotMade::Failed(error)) => Err(error),
    }
}

/// How far a run is.
struct Tally {
    summary: Summary,
    done: u64,
    failure: Option<NotMade>,
}

/// Why a part was not made.
enum NotMade {
    Stopped,
    Failed(SweepError),
}

impl From<SweepError> for NotMade {
    fn from(error: SweepError) -> Self {
        Self::Failed(error)
    }
}

/// What became of the rows of a part.
#[derive(Default)]
struct Made {
    failed: u64,
    unstable: u64,
    first_failure: Option<(u64, String)>,
}

impl Summary {
    fn add(&mut self, part: Made) {
        self.failed += part.failed;
        self.unstable += part.unstable;
        let all = self.first_failure.take().into_iter().chain(part.first_failure);
        self.first_failure = all.min_by_key(|(row, _)| *row);
    }
}

impl Plan {
    /// Solves a part and writes it.
    fn make(&self, part: u64, folder: &Path) -> Result<Made, NotMade> {
        let solved = self.solve(self.rows_of(part))?;
        // What was cancelled has rows that others would take for failed ones.
        if self.model.cancel().is_cancelled() {
            return Err(NotMade::Stopped);
        }
        let Answers { stable, failures, .. } = &solved.answers;
        let made = Made {
            failed: failures.len() as u64,
            unstable: stable.iter().filter(|stable| **stable == Some(false)).count() as u64,
            first_failure: failures
                .first()
                .map(|(row, why)| (solved.first + *row as u64, why.clone())),
        };
        let path = folder.join(part_name(part));
        let written = write_one_of_many(&path, &self.content(solved));
        written.map_err(|source| SweepError::Write { path, source })?;
        Ok(made)
    }
}

/// The parts in a folder that have all their rows.
fn whole_parts(plan: &Plan, folder: &Path) -> Result<Vec<u64>, SweepError> {
    let entries = fs::read_dir(folder);
    let entries =
        entries.map_err(|source| SweepError::Write { path: folder.to_owned(), source })?;
    let number = |name: &str| name.strip_prefix("part-")?.strip_suffix(".parquet")?.parse().ok();
    let named = entries.flatten().filter_map(|entry| number(entry.file_name().to_str()?));
    let is_whole = |part: &u64| {
        let path = folder.join(part_name(*part));
        *part < plan.parts() && is_whole(&path, plan.rows_of(*part).1)
    };
    Ok(named.filter(is_whole).collect())
}

/// Whether a part is there with all its rows.
fn is_whole(path: &Path, rows: u64) -> bool {
    let reader = File::open(path).ok().and_then(|file| SerializedFileReader::new(file).ok());
    reader.is_some_and(|reader| {
        u64::try_from(reader.metadata().file_metadata().num_rows()) == Ok(rows)
    })
}

impl Plan {
    /// A part as the bytes of a Parquet file.
    fn content(&self, part: Part) -> Vec<u8> {
        let Part { first, rows, inputs, answers: Answers { columns, stable, failures } } = part;
        let axes = self.samples.axes().len();
        let input =
            |k: usize| Values::Numbers(inputs.iter().skip(k).step_by(axes).copied().collect());
        #[expect(clippy::cast_possible_wrap, reason = "below 2⁵³")]
        let numbers = (0..rows).map(|row| Some((first + row as u64) as i64)).collect();
        let mut values = vec![Values::Integers(numbers)];
        values.extend((0..axes).map(input));
        values.extend(columns.into_iter().map(Values::Numbers));
        if self.columns.has(Output::Stability) {
            values.push(Values::Flags(stable));
        }
        let mut errors = vec![None; rows];
        failures.into_iter().for_each(|(row, why)| errors[row] = Some(why));
        values.push(Values::Texts(errors));
        let names = self.column_names();
        let columns = names.into_iter().zip(values);
        let columns: Vec<Column> = columns.map(|(name, values)| Column { name, values }).collect();
        columns_to_parquet(&columns)
    }
}
