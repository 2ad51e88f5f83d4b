//! Finer steps of a rod in contact, until its answer is as accurate as was asked for.

use whipcord_numerics::{Pose, Vec3};

use crate::error::SolveError;
use crate::shape::positions_at;
use crate::statics::grid::Grid;
use crate::statics::refinement::{Coarse, ERROR_RATIO};

/// How often the steps are halved to meet a tolerance.
const MAX_HALVINGS: usize = 5;

/// How fine the steps are, and what the last ones gave.
#[derive(Clone, Debug, Default)]
pub(crate) struct Refinement {
    /// How many there are at least.
    pub steps: usize,
    /// How often they are halved.
    pub halvings: usize,
    /// The answer on steps twice as long, and the places of its contacts.
    coarse: Option<(Coarse, Vec<f64>)>,
    /// Estimated error in m, once it is below the tolerance.
    pub error: Option<f64>,
}

impl Refinement {
    /// Takes the answer if this is its estimated error in m and meets a tolerance.
    pub fn accept(&mut self, error: Option<f64>, tolerance: f64) -> bool {
        let is_met = error.is_some_and(|error| error <= tolerance);
        if is_met {
            self.error = error;
        }
        is_met
    }

    /// Halves the steps if the answer, with frames at the ends of the steps of this grid, lengths of the cables and places of contact
    /// in m, is not yet known to a tolerance in m; `false` if it is.
    pub fn refine(
        &mut self,
        tolerance: f64,
        (grid, poses, lengths): (&Grid, &[Pose], &[f64]),
        contacts: &[f64],
    ) -> Result<bool, SolveError> {
        if let Some((coarse, _)) = self.coarse.as_ref().filter(|(_, there)| there == contacts) {
            let error = coarse.change(grid, poses, lengths) / ERROR_RATIO;
            if error <= tolerance {
                self.error = Some(error);
                return Ok(false);
            }
            if self.halvings == MAX_HALVINGS {
                return Err(SolveError::StepsTooCoarse { error, tolerance, steps: grid.len() });
            }
        }
        let mut coarse = Coarse::default();
        coarse.keep(grid, poses, lengths);
        self.coarse = Some((coarse, contacts.to_vec()));
        self.halvings += 1;
        Ok(true)
    }
}

/// The centres of cross-sections at these increasing arc lengths in m, from the frames at the ends of the steps of a grid.
pub(crate) fn centres(grid: &Grid, poses: &[Pose], arc_lengths: &[f64], into: &mut Vec<Vec3>) {
    positions_at(&grid.ends(), poses, arc_lengths, into);
}
