//! What a program shows beside what the page asks for: shapes of one robot or of several, as they come.

use serde::{Deserialize, Serialize};

use crate::protocol::answer::Answer;

/// What is shown at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shown {
    /// Time in s.
    pub time: f64,
    /// A shape of each robot that has one, in the order of the robots.
    pub shapes: Vec<Option<Answer>>,
    /// What was measured at this time: positions in m in the world.
    pub measured: Vec<[f64; 3]>,
}
