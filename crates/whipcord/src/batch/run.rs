//! Pieces of a batch, one after another or shared by threads.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::BatchOptions;
use super::error::BatchError;

/// Does all jobs. Each is done with scratch memory of one thread, and returns how many rows it did.
pub(super) fn run<J: Send, W>(
    jobs: Vec<J>,
    rows: usize,
    options: &BatchOptions<'_>,
    scratch: impl Fn() -> W + Sync + Send,
    work: impl Fn(J, &mut W) -> usize + Sync + Send,
) -> Result<(), BatchError> {
    let done = AtomicUsize::new(0);
    let stopped = AtomicBool::new(false);
    let step = |memory: &mut W, job: J| {
        if stopped.load(Ordering::Relaxed) {
            return;
        }
        let count = work(job, memory);
        let done = done.fetch_add(count, Ordering::Relaxed) + count;
        if options.progress.is_some_and(|goes_on| !goes_on(done, rows)) {
            stopped.store(true, Ordering::Relaxed);
        }
    };
    share(jobs, options, scratch, step)?;
    let done = done.into_inner();
    // Who stops the batch after its last row has all of it.
    if done < rows { Err(BatchError::Stopped { done, rows }) } else { Ok(()) }
}

#[cfg(feature = "parallel")]
fn share<J: Send, W>(
    jobs: Vec<J>,
    options: &BatchOptions<'_>,
    scratch: impl Fn() -> W + Sync + Send,
    step: impl Fn(&mut W, J) + Sync + Send,
) -> Result<(), BatchError> {
    use rayon::prelude::*;

    let Some(threads) = options.threads else {
        jobs.into_par_iter().for_each_init(scratch, step);
        return Ok(());
    };
    if threads.get() == 1 {
        one_by_one(jobs, scratch, step);
        return Ok(());
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build()
        .map_err(|e| BatchError::Threads { threads: threads.get(), reason: e.to_string() })?;
    pool.install(|| jobs.into_par_iter().for_each_init(scratch, step));
    Ok(())
}

#[cfg(not(feature = "parallel"))]
fn share<J: Send, W>(
    jobs: Vec<J>,
    _: &BatchOptions<'_>,
    scratch: impl Fn() -> W + Sync + Send,
    step: impl Fn(&mut W, J) + Sync + Send,
) -> Result<(), BatchError> {
    one_by_one(jobs, scratch, step);
    Ok(())
}

fn one_by_one<J, W>(jobs: Vec<J>, scratch: impl Fn() -> W, step: impl Fn(&mut W, J)) {
    let mut memory = scratch();
    for job in jobs {
        step(&mut memory, job);
    }
}
