//! What a fit says: tables, figures, report.

pub mod figures;
pub mod report;
pub mod tables;

use whipcord::identification::{Compared, Experiment, Identified, Validated};
use whipcord_io::CaseFile;

/// A fit, and what it is of.
pub struct Fit<'a> {
    /// The files.
    pub cases: &'a [CaseFile],
    /// A name for each.
    pub names: &'a [String],
    /// What was measured in each.
    pub experiments: &'a [Experiment],
    /// What was found.
    pub found: Identified,
    /// How far off it is where it was held out, where that was asked for.
    pub validated: Option<Validated>,
    /// The fits of all models, where that was asked for.
    pub compared: Vec<Compared>,
}
