//! Models that are ready to solve, for all pages of a file. A model holds memory of its own that it solves with, many times what an answer
//! takes: pages that only show something hold none.

use std::sync::{Mutex, PoisonError};

use whipcord::{Model, ModelPreset, Prepared};

/// Kept of each model: as many pages move their sliders at once without another being made ready.
const MOST_OF_EACH: usize = 4;

/// A model that is ready for a robot.
#[derive(Debug)]
pub struct Ready {
    /// Which.
    pub preset: ModelPreset,
    /// As it was chosen.
    pub model: Model,
    /// As it solves.
    pub prepared: Prepared,
}

/// The models that are ready and solve nothing now.
#[derive(Debug, Default)]
pub struct Stock(Mutex<Vec<Ready>>);

impl Stock {
    /// Takes a model out, if there is one.
    pub fn take(&self, preset: ModelPreset) -> Option<Ready> {
        // What is in it is whole at all times.
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let place = all.iter().position(|ready| ready.preset == preset)?;
        Some(all.swap_remove(place))
    }

    /// Puts it back for the next solve; one too many is given up.
    pub fn put(&self, ready: Ready) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if all.iter().filter(|other| other.preset == ready.preset).count() < MOST_OF_EACH {
            all.push(ready);
        }
    }
}
