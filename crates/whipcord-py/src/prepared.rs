//! Models that were built for a robot and are kept for the next calls.

use std::sync::{Mutex, MutexGuard, PoisonError};

use whipcord::{Loads, Model, Prepared, Robot, SolveError};

/// Models built for one robot, the last used one last.
#[derive(Default)]
pub struct PreparedModels(Mutex<Vec<Kept>>);

/// A model that was built.
struct Kept {
    model: Model,
    prepared: Prepared,
    /// Whether its last answer came so soon that it needs no thread of its own.
    quick: bool,
}

/// Models that are kept.
const MOST: usize = 8;

impl PreparedModels {
    /// Has a model work that was built before, or is built now. Several threads may do this at once.
    ///
    /// # Errors
    /// [`SolveError`] of the model, or of `work`.
    pub fn with<T>(
        &self,
        model: &Model,
        robot: &Robot,
        loads: &Loads,
        work: impl FnOnce(&mut Prepared) -> Result<T, SolveError>,
    ) -> Result<T, SolveError> {
        let known = {
            let mut kept = self.kept();
            kept.iter().rposition(|kept| kept.model == *model).map(|i| kept.remove(i))
        };
        let mut used = match known {
            Some(known) => known,
            None => {
                let prepared = model.prepare(robot, loads)?;
                Kept { model: model.clone(), prepared, quick: false }
            }
        };
        let result = work(&mut used.prepared);
        let mut kept = self.kept();
        if kept.len() >= MOST {
            kept.remove(0);
        }
        kept.push(used);
        result
    }

    /// Whether the last answer of this model came soon.
    pub fn was_quick(&self, model: &Model) -> bool {
        self.kept().iter().any(|kept| kept.quick && kept.model == *model)
    }

    /// Keeps in mind whether the answer of this model came soon.
    pub fn note_quick(&self, model: &Model, quick: bool) {
        let mut kept = self.kept();
        kept.iter_mut().filter(|kept| kept.model == *model).for_each(|kept| kept.quick = quick);
    }

    fn kept(&self) -> MutexGuard<'_, Vec<Kept>> {
        // What panics elsewhere leaves the list whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
