//! How cost and accuracy grow with sections and steps: the paper's Fig. 4.

pub mod accuracy;
pub mod cost;
pub mod paper;
pub mod tables;

use std::time::{Duration, Instant};

use crate::statistics::{deviation, mean, median};

/// Several measurements of one solve time.
#[derive(Clone, Debug)]
pub struct Samples {
    /// Seconds per solve.
    pub times: Vec<f64>,
}

impl Samples {
    /// Measurements of one solve time; enough for a mean and its scatter.
    pub const COUNT: usize = 10;

    /// A measurement is the median of this many batches: where the system has stopped the process
    /// amid a batch, it measured something else.
    const BATCHES: usize = 5;

    /// A batch lasts at least this long, so that the clock's own resolution and cost vanish in it.
    const BATCH: Duration = Duration::from_micros(200);

    /// Measures `solve`, which has been run once before.
    pub fn take(mut solve: impl FnMut()) -> Self {
        let mut batch = 1_usize;
        // Doubling until a batch is long enough also warms caches and branch predictors.
        while batch < 1 << 20 && time(batch, &mut solve) < Self::BATCH.as_secs_f64() {
            batch *= 2;
        }
        let mut measurement = || {
            let mut times = [0.0; Self::BATCHES];
            for time_of_one in &mut times {
                *time_of_one = time(batch, &mut solve) / batch as f64;
            }
            median(&mut times)
        };
        Self { times: (0..Self::COUNT).map(|_| measurement()).collect() }
    }

    /// Mean in s.
    pub fn mean(&self) -> f64 {
        mean(&self.times)
    }

    /// Standard deviation in s.
    pub fn deviation(&self) -> f64 {
        deviation(&self.times)
    }
}

fn time(batch: usize, solve: &mut impl FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..batch {
        solve();
    }
    start.elapsed().as_secs_f64()
}
