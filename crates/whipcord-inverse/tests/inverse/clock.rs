//! Times that what else the machine does hardly changes.

use std::time::Instant;

/// Counts from when it is made.
pub struct Clock {
    start: Instant,
    of: fn() -> Option<f64>,
    before: Option<f64>,
}

impl Clock {
    /// Of the processor that this thread has, as Linux counts it to some milliseconds; elsewhere the time that passes.
    pub fn of_thread() -> Self {
        Self::new(|| {
            let counted = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
            let nanoseconds: f64 = counted.split_whitespace().next()?.parse().ok()?;
            Some(1e-9 * nanoseconds)
        })
    }

    /// Of the processor that all threads of the process have, likewise.
    pub fn of_process() -> Self {
        /// Counted a second.
        const TICKS: f64 = 100.0;
        Self::new(|| {
            let counted = std::fs::read_to_string("/proc/self/stat").ok()?;
            // Behind the name, which may have blanks.
            let fields = counted.rsplit(')').next()?.split_whitespace().skip(11).take(2);
            let ticks: Option<f64> = fields.map(|of| of.parse::<f64>().ok()).sum();
            Some(ticks? / TICKS)
        })
    }

    fn new(of: fn() -> Option<f64>) -> Self {
        Self { start: Instant::now(), of, before: of() }
    }

    /// In s.
    pub fn seconds(&self) -> f64 {
        match (self.before, (self.of)()) {
            (Some(before), Some(now)) => now - before,
            _ => self.start.elapsed().as_secs_f64(),
        }
    }
}
