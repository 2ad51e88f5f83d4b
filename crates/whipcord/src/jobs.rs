//! Jobs, one after another or shared by threads.

use core::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Threads that could not be started.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{threads} threads could not be started ({reason}): ask for fewer")]
pub struct NoThreads {
    /// How many were asked for.
    pub threads: usize,
    /// What the operating system says.
    pub reason: String,
}

/// Does all jobs, shared by so many threads: by default those of the pool of rayon that the caller is in. Each thread makes its
/// scratch memory once, and takes the next job in their order when it has done one: jobs may be made as they are taken. After a job that
/// returns `false` no other is begun.
///
/// Without the cargo feature `parallel` the caller does them all.
///
/// ```
/// let mut squares = vec![0; 100];
/// let jobs = squares.iter_mut().enumerate();
/// whipcord::jobs::share(jobs, None, || (), |(i, square), ()| {
///     *square = i * i;
///     true
/// })?;
/// assert_eq!(squares[99], 9801);
/// # Ok::<(), whipcord::jobs::NoThreads>(())
/// ```
///
/// # Errors
/// [`NoThreads`] where so many threads cannot be started; then no job is done.
pub fn share<J: Send, W>(
    jobs: impl IntoIterator<Item = J, IntoIter: Send>,
    threads: Option<NonZero<usize>>,
    scratch: impl Fn() -> W + Sync + Send,
    work: impl Fn(J, &mut W) -> bool + Sync + Send,
) -> Result<(), NoThreads> {
    let jobs = jobs.into_iter();
    let count = jobs.size_hint().1.unwrap_or(usize::MAX);
    let ended = AtomicBool::new(false);
    let queue = Mutex::new(jobs);
    // What panics in a job ends all: the queue itself is whole.
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let worker = || {
        let mut memory = scratch();
        while !ended.load(Ordering::Relaxed)
            && let Some(job) = next()
        {
            if !work(job, &mut memory) {
                ended.store(true, Ordering::Relaxed);
            }
        }
    };
    on_threads(count, threads, worker)
}

/// Has so many threads do the work as are asked for, but no more than there are jobs.
#[cfg(feature = "parallel")]
fn on_threads(
    jobs: usize,
    asked: Option<NonZero<usize>>,
    worker: impl Fn() + Sync + Send,
) -> Result<(), NoThreads> {
    let threads = asked.map_or_else(rayon::current_num_threads, NonZero::get).min(jobs);
    if threads <= 1 {
        worker();
        return Ok(());
    }
    let all = || {
        rayon::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(|_| worker());
            }
            worker();
        });
    };
    if asked.is_none() {
        all();
        return Ok(());
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| NoThreads { threads, reason: e.to_string() })?;
    pool.install(all);
    Ok(())
}

#[cfg(not(feature = "parallel"))]
fn on_threads(
    _: usize,
    _: Option<NonZero<usize>>,
    worker: impl Fn() + Sync + Send,
) -> Result<(), NoThreads> {
    worker();
    Ok(())
}
