//! How what the holes remember changes from end to end of the substeps.

use super::carried::Carried;
use super::trail::{SubstepEnd, Trail};
use crate::error::SolveError;

/// How the state that the holes remember changes with parameters and commands, from substep to substep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carrying {
    /// With each parameter, then with the command of each cable in all steps, then with that in the present step; `None` before the
    /// first substep.
    changes: Option<Vec<Carried>>,
    /// Ends of substeps that were gone over, and the tensions at the last of them.
    done: usize,
    tensions: Vec<f64>,
}

/// An end of a substep among all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Number of the step.
    pub step: usize,
    /// Whether it is the end of that.
    pub is_end_of_step: bool,
    /// Whether it is the last of all.
    pub is_last: bool,
}

impl Carrying {
    /// Goes over the ends of the substeps that are new on a trail. So many changes are those of more than a step. `differentiate` is asked
    /// for the derivatives at an end, and for the changes of what the holes remember there from those before; `None` at the last where
    /// these are not known before the next end is, so that it is gone over once more then. The derivatives at the last.
    ///
    /// # Errors
    /// Those of `differentiate`, and [`SolveError::NoDerivativesOfRest`] where the trail does not tell how it went.
    pub fn go<S, D>(
        &mut self,
        trail: &Trail<S>,
        kept: usize,
        mut differentiate: impl FnMut(
            &SubstepEnd<S>,
            Option<&[Carried]>,
            Place,
        ) -> Result<(D, Option<Vec<Carried>>), SolveError>,
    ) -> Result<D, SolveError> {
        let known = self.done.checked_sub(1).and_then(|last| trail.ends.get(last));
        if known.is_none_or(|end| end.standing.tensions != self.tensions) {
            // The way was gone anew.
            *self = Self::default();
        }
        if trail.is_broken {
            return Err(SolveError::NoDerivativesOfRest);
        }
        let mut last = None;
        // Within a substep some holes have come to rest since its start.
        let mut within: Option<Vec<Carried>> = None;
        for (number, end) in trail.ends.iter().enumerate().skip(self.done) {
            if let Some(changes) = &mut self.changes
                && trail.starts_step(number)
            {
                // The commands of the step before are none of this one.
                changes.truncate(kept);
            }
            let is_last = number + 1 == trail.ends.len();
            let place = Place {
                step: trail.steps.partition_point(|&first| first <= number).saturating_sub(1),
                is_end_of_step: is_last || trail.starts_step(number + 1),
                is_last,
            };
            let before = within.as_deref().or(self.changes.as_deref());
            let (derivatives, there) = differentiate(end, before, place)?;
            match (&end.stops, there) {
                (_, None) if is_last => {}
                (_, None) => return Err(SolveError::NoDerivativesOfRest),
                (Some(stops), Some(there)) => {
                    let mut changes =
                        before.map(<[_]>::to_vec).ok_or(SolveError::NoDerivativesOfRest)?;
                    // The commands of a step begin to change in it.
                    changes.resize(there.len(), Carried::default());
                    for (change, there) in changes.iter_mut().zip(&there) {
                        change.beyond.resize(there.beyond.len(), 0.0);
                        stops.iter().for_each(|&p| change.beyond[p] = there.beyond[p]);
                    }
                    within = Some(changes);
                }
                (None, Some(there)) => {
                    (self.changes, within) = (Some(there), None);
                    self.tensions.clone_from(&end.standing.tensions);
                    self.done = number + 1;
                }
            }
            last = Some(derivatives);
        }
        last.ok_or(SolveError::NoDerivativesOfRest)
    }
}
