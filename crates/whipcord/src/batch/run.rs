//! Pieces of a batch, one after another or shared by threads.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::error::BatchError;
use super::options::{BatchOptions, Progress};
use crate::cancel::Cancel;
use crate::error::SolveError;
use crate::jobs::share;

/// How far a batch is, and whether it goes on.
pub(super) struct Tally<'a> {
    done: AtomicUsize,
    stopped: AtomicBool,
    rows: usize,
    progress: Option<Progress<'a>>,
    /// Ends the batch from outside.
    cancel: &'a Cancel,
}

impl Tally<'_> {
    /// Whether the batch goes on. A row may take seconds: a job asks before each that it begins.
    pub(super) fn goes_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    /// Whether the flag of the model is set: then the rows that are left have this error and are not solved.
    pub(super) fn cancelled(&self) -> Option<SolveError> {
        self.cancel.is_cancelled().then_some(SolveError::Cancelled { last_load: None })
    }

    /// So many more rows are done.
    pub(super) fn add(&self, count: usize) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        if self.progress.is_some_and(|goes_on| !goes_on(done, self.rows)) {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// Does all jobs. Each thread makes its scratch memory once and takes the next job when it has done
/// one; a job adds the rows it has done to the tally.
pub(super) fn run<J: Send, W>(
    jobs: Vec<J>,
    rows: usize,
    options: &BatchOptions<'_>,
    cancel: &Cancel,
    scratch: impl Fn() -> W + Sync + Send,
    work: impl Fn(J, &mut W, &Tally<'_>) + Sync + Send,
) -> Result<(), BatchError> {
    let tally = Tally {
        done: AtomicUsize::new(0),
        stopped: AtomicBool::new(false),
        rows,
        progress: options.progress,
        cancel,
    };
    share(jobs, options.threads, scratch, |job, memory| {
        work(job, memory, &tally);
        tally.goes_on()
    })?;
    let done = tally.done.into_inner();
    // Who stops the batch by its progress after its last row has all of it.
    if done < rows { Err(BatchError::Stopped { done, rows }) } else { Ok(()) }
}
