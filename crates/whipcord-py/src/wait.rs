//! Waiting for long work with an eye on signals such as Ctrl-C, which Python delivers to the thread that
//! called.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use whipcord::Cancel;
use whipcord::batch::{BatchError, Progress};

use crate::errors;

/// How often signals are looked for, and progress is reported.
pub const PERIOD: Duration = Duration::from_millis(50);

/// What a search that is over leaves for the rest beside as long again.
const REST: Duration = Duration::from_secs(10);

/// What ends work before it is done: a signal, or a time that is over.
#[derive(Clone, Debug, Default)]
pub struct Limit {
    /// Ends the solves of the work, where these look at it.
    pub cancel: Cancel,
    /// When the time is over.
    until: Option<Instant>,
    /// Before that: when a search takes the best so far, and the flag that tells it so.
    search: Option<(Instant, Cancel)>,
}

impl Limit {
    /// The time begins now.
    pub fn starting_now(timeout: Option<Duration>) -> Self {
        let until = timeout.and_then(|timeout| Instant::now().checked_add(timeout));
        Self { cancel: Cancel::new(), until, search: None }
    }

    /// The time of a search that takes the best so far when it is over; as long again and some seconds are left for what is done with that.
    pub fn of_search(timeout: Option<Duration>) -> (Self, Cancel) {
        let stop = Cancel::new();
        let rest = |time: Duration| time.saturating_mul(2).saturating_add(REST);
        let mut limit = Self::starting_now(timeout.map(rest));
        let end = timeout.and_then(|timeout| Instant::now().checked_add(timeout));
        limit.search = end.map(|end| (end, stop.clone()));
        (limit, stop)
    }

    /// Whether there is a time limit.
    pub const fn is_timed(&self) -> bool {
        self.until.is_some()
    }

    /// Whether the time is over.
    fn is_over(&self) -> bool {
        self.until.is_some_and(|until| until <= Instant::now())
    }

    /// How long to wait until signals and time are looked at again.
    fn period(&self) -> Duration {
        let left = self.until.map(|until| until.saturating_duration_since(Instant::now()));
        // Where the time is over the work has been told so, and ends soon.
        left.filter(|left| !left.is_zero()).map_or(PERIOD, |left| left.min(PERIOD))
    }

    /// Ends the work where the time is over.
    fn look_at_time(&self) {
        if let Some((end, stop)) = &self.search
            && *end <= Instant::now()
        {
            stop.cancel();
        }
        if self.is_over() {
            self.cancel.cancel();
        }
    }
}

/// [`within`], for work without a limit that looks at no flag.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    within(py, &Limit::default(), work)
}

/// [`within`], for work that looks at no flag: where the time is over nobody waits for it any more, and it comes to its end
/// in the background.
pub fn abandoned_after<T: Send + 'static>(
    py: Python<'_>,
    timeout: Option<Duration>,
    what: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let limit = Limit::starting_now(timeout);
    let (give, result) = sync_channel(1);
    thread::Builder::new().spawn(move || {
        let _ = give.send(work());
    })?;
    let wait = {
        let limit = limit.clone();
        move || loop {
            match result.recv_timeout(limit.period()) {
                Err(RecvTimeoutError::Timeout) if !limit.is_over() => {}
                ended => return ended,
            }
        }
    };
    within(py, &limit, wait)?.map_err(|ended| match ended {
        RecvTimeoutError::Timeout => errors::timed_out(py, format!("{what} was not done"), None),
        RecvTimeoutError::Disconnected => {
            PyRuntimeError::new_err("a thread ended without a result")
        }
    })
}

/// Has a thread of its own do the work and waits for it. A signal ends the waiting at once and sets the flag of the limit;
/// solves that look at it end promptly, and nobody asks for their result. Where the time is over the flag is set, and the
/// work says so.
pub fn within<T: Send + 'static>(
    py: Python<'_>,
    limit: &Limit,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (give, result) = sync_channel(1);
    let worker = thread::Builder::new().spawn(move || {
        // Nobody takes it who was interrupted.
        let _ = give.send(work());
    })?;
    py.detach(move || {
        loop {
            match result.recv_timeout(limit.period()) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => {
                    Python::attach(|py| py.check_signals())
                        .inspect_err(|_| limit.cancel.cancel())?;
                    limit.look_at_time();
                }
                // PyO3 makes an exception of a panic.
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        match worker.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => Err(PyRuntimeError::new_err("a thread ended without a result")),
        }
    })
}

/// Has a thread of its own do the work while this one, which Python delivers signals to, waits for them
/// and reports progress.
pub fn supervise<T: Send>(
    py: Python<'_>,
    limit: &Limit,
    report: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(Progress<'_>) -> Result<T, BatchError> + Send,
) -> PyResult<T> {
    let (done, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let progress = |rows: usize, _: usize| {
        // Threads report in any order.
        done.fetch_max(rows, Ordering::Relaxed);
        !stopped.load(Ordering::Relaxed)
    };
    let finished = AtomicBool::new(false);
    let here = thread::current();
    let (result, interrupted) = thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let result = work(&progress);
            finished.store(true, Ordering::Release);
            here.unpark();
            result
        });
        let mut interrupted = None;
        while !finished.load(Ordering::Acquire) && !worker.is_finished() {
            py.detach(|| thread::park_timeout(limit.period()));
            limit.look_at_time();
            let told = match report {
                Some(report) => report.call1((done.load(Ordering::Relaxed),)).map(drop),
                None => Ok(()),
            };
            if let Err(error) = told.and_then(|()| py.check_signals()) {
                stopped.store(true, Ordering::Relaxed);
                // The row that is being solved ends, too.
                limit.cancel.cancel();
                interrupted = Some(error);
                break;
            }
        }
        (py.detach(|| worker.join()), interrupted)
    });
    match (interrupted, result) {
        (Some(error), _) => Err(error),
        (None, Ok(result)) => result.map_err(|error| errors::batch(py, &error)),
        // PyO3 turns it into an exception, as any panic.
        (None, Err(panic)) => std::panic::resume_unwind(panic),
    }
}
