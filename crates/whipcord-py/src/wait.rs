//! Waiting for long work with an eye on signals such as Ctrl-C, which Python delivers to the thread that
//! called.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use whipcord::batch::{BatchError, Progress};

use crate::errors;

/// How often signals are looked for, and progress is reported.
pub const PERIOD: Duration = Duration::from_millis(50);

/// Has a thread of its own do the work and waits for it. A signal ends the waiting at once; the work,
/// which cannot be broken off, goes on to its end, and nobody asks for its result.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (give, result) = sync_channel(1);
    let worker = thread::Builder::new().spawn(move || {
        // Nobody takes it who was interrupted.
        let _ = give.send(work());
    })?;
    py.detach(move || {
        loop {
            match result.recv_timeout(PERIOD) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
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
            py.detach(|| thread::park_timeout(PERIOD));
            let told = match report {
                Some(report) => report.call1((done.load(Ordering::Relaxed),)).map(drop),
                None => Ok(()),
            };
            if let Err(error) = told.and_then(|()| py.check_signals()) {
                stopped.store(true, Ordering::Relaxed);
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
