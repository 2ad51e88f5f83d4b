//! How the lengths of cables before actuation change with parameters. They do not hang on the answer, so that a model keeps them.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use crate::parameter::Parameter;

/// Changes of the lengths of all strands before actuation, by parameters, and by the number of steps where these decide on the last bits.
#[derive(Debug, Default)]
pub(crate) struct RestChanges(Mutex<HashMap<(Parameter, usize), Vec<f64>>>);

impl RestChanges {
    /// Those by a parameter that are known.
    pub fn get(&self, parameter: Parameter, steps: usize) -> Option<Vec<f64>> {
        // What is inserted is whole.
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.get(&(parameter, steps)).cloned()
    }

    pub fn insert(&self, parameter: Parameter, steps: usize, changes: &[f64]) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.insert((parameter, steps), changes.to_vec());
    }

    /// Whether those by all parameters are known, where they do not depend on the steps.
    pub fn know(&self, parameters: &[Parameter]) -> bool {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parameters.iter().all(|parameter| known.contains_key(&(*parameter, 0)))
    }
}
