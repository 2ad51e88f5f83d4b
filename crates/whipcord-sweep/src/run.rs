//! Solves the parts of a sweep and writes them.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;
use std::thread;

use parquet::file::reader::FileReader as _;
use parquet::file::serialized_reader::SerializedFileReader;
use whipcord_io::{Column, Values, columns_to_parquet, write_atomically};

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
    /// Called with the number of rows of this shard that are written, and of all of them.
    pub progress: Option<&'a dyn Fn(u64, u64)>,
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
    let mut done = kept.iter().map(|part| plan.rows_of(*part).1).sum();
    let mut summary = Summary { rows, parts, kept: kept.len() as u64, ..Summary::default() };
    let tell = |done| options.progress.iter().for_each(|progress| progress(done, rows));
    tell(done);
    // One part is written while the next is solved.
    let (solved, written) = thread::scope(|scope| {
        let (send, receive) = sync_channel::<(PathBuf, Part)>(0);
        let writer = scope.spawn(move || {
            for (path, part) in receive {
                let content = plan.content(part);
                let outcome = write_atomically(&path, &content);
                outcome.map_err(|source| SweepError::Write { path, source })?;
            }
            Ok(())
        });
        let mut solved = Ok(());
        let step = usize::try_from(count).unwrap_or(usize::MAX);
        let mine = (number..plan.parts()).step_by(step);
        for part in mine.filter(|part| !kept.contains(part)) {
            let of_part = match plan.solve(plan.rows_of(part)) {
                Ok(of_part) => of_part,
                Err(error) => {
                    solved = Err(error);
                    break;
                }
            };
            // What was cancelled has rows that others would take for failed ones.
            if plan.model.cancel().is_cancelled() {
                solved = Err(SweepError::Stopped { done, rows });
                break;
            }
            summary.add(&of_part);
            let count = of_part.answers.outcomes.len() as u64;
            if send.send((folder.join(part_name(part)), of_part)).is_err() {
                // The writer has ended, and says why.
                break;
            }
            done += count;
            tell(done);
        }
        drop(send);
        // A writer that panicked has had no part to write.
        let written: Result<(), SweepError> = writer.join().unwrap_or(Ok(()));
        (solved, written)
    });
    written?;
    solved?;
    Ok(summary)
}

impl Summary {
    fn add(&mut self, part: &Part) {
        for (row, outcome) in (part.first..).zip(&part.answers.outcomes) {
            match outcome {
                Ok(stable) => self.unstable += u64::from(*stable == Some(false)),
                Err(error) => {
                    self.failed += 1;
                    self.first_failure.get_or_insert_with(|| (row, error.clone()));
                }
            }
        }
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
        let Part { first, inputs, answers: Answers { numbers, outcomes, .. } } = part;
        let axes = self.samples.axes().len();
        let width = self.columns.names().len();
        let column = |values: &[f64], width: usize, k: usize| {
            Values::Numbers(values.iter().skip(k).step_by(width).copied().collect())
        };
        #[expect(clippy::cast_possible_wrap, reason = "below 2⁵³")]
        let rows = (0..outcomes.len()).map(|row| Some((first + row as u64) as i64)).collect();
        let mut values = vec![Values::Integers(rows)];
        values.extend((0..axes).map(|k| column(&inputs, axes, k)));
        values.extend((0..width).map(|k| column(&numbers, width, k)));
        if self.columns.has(Output::Stability) {
            values.push(Values::Flags(
                outcomes.iter().map(|of| of.as_ref().ok().copied().flatten()).collect(),
            ));
        }
        values.push(Values::Texts(outcomes.into_iter().map(Result::err).collect()));
        let names = self.column_names();
        let columns = names.into_iter().zip(values);
        let columns: Vec<Column> = columns.map(|(name, values)| Column { name, values }).collect();
        columns_to_parquet(&columns)
    }
}
