//! Shapes whose evaluations are known before a target is: an iteration that starts from one of them takes its first step without a solve, and where second
//! derivatives are known starts from where these lead.

use whipcord::SolveError;
use whipcord::derivatives::Place;

use crate::descent::{Control, FIRST_DAMPING, LARGEST_RADIUS, Problem, Region, Workspace, within};
use crate::evaluation::Evaluation;
use crate::forward::Forward;
use crate::rate_changes::RateChanges;
use crate::search::Search;
use crate::second_order_start::led;
use crate::target::Target;

/// A shape to start from.
#[derive(Clone, Debug)]
pub(crate) struct Landmark {
    pub unknowns: Vec<f64>,
    /// By the model of the trials.
    pub evaluation: Evaluation,
    /// By the model of the answers, where that is another one.
    answer: Option<Evaluation>,
    /// Of one of many shapes.
    rate_changes: Option<RateChanges>,
    /// Solves that it takes.
    solves: usize,
}

/// The shapes that are known, for the places of the kind of target that was asked for last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Landmarks {
    places: Vec<Place>,
    /// Where the case is.
    commanded: Option<Landmark>,
    /// All over the commands.
    spread: Vec<Landmark>,
    has_spread: bool,
}

/// Where an iteration starts.
#[derive(Debug)]
pub(crate) struct Led<'a> {
    pub landmark: &'a Landmark,
    /// Where its first and second derivatives lead, where both are known.
    pub to: Option<Vec<f64>>,
}

/// So many of the shapes nearest to a point are compared by where they lead, for so many unknowns at most: of more a step takes longer than it spares.
const COMPARED: usize = 4;
const MOST_UNKNOWNS: usize = 6;

impl Landmark {
    /// At unknowns; one of many shapes, within bounds, with its second derivatives, and with an answer where that is of another model than the trials. `None` where there is
    /// none.
    ///
    /// # Errors
    /// [`SolveError::Cancelled`].
    fn at(
        forward: &mut Forward,
        unknowns: Vec<f64>,
        places: &[Place],
        bounds: Option<&[[f64; 2]]>,
    ) -> Result<Option<Self>, SolveError> {
        match Self::solved(forward, unknowns, places, bounds) {
            Ok(landmark) => Ok(Some(landmark)),
            Err(error @ SolveError::Cancelled { .. }) => Err(error),
            Err(_) => Ok(None),
        }
    }

    fn solved(
        forward: &mut Forward,
        unknowns: Vec<f64>,
        places: &[Place],
        bounds: Option<&[[f64; 2]]>,
    ) -> Result<Self, SolveError> {
        let first = forward.solves;
        let evaluation = forward.evaluate(&unknowns, places, None)?;
        let rate_changes = match bounds {
            Some(bounds) => RateChanges::at(&evaluation, &unknowns, bounds, places, forward)?,
            None => None,
        };
        let answer = match bounds.is_some() && forward.is_on_few_steps() {
            true => {
                let Evaluation { shortenings, solution, .. } = &evaluation;
                let solution = forward.verify(&unknowns, shortenings, solution)?;
                Some(forward.with_rates_of(solution, &evaluation))
            }
            false => None,
        };
        let solves = forward.solves - first;
        forward.solves = first;
        Ok(Self { unknowns, evaluation, answer, rate_changes, solves })
    }
}

impl Landmarks {
    /// Where the search for a target starts: at the commands, or where shapes all over the commands are wanted from the one of the nearest whose first step leads nearest. What a landmark has taken counts as
    /// solves of each target that starts from it, whichever was the first. `None` where the start has no answer, or answers depend on more than the commands.
    ///
    /// # Errors
    /// [`SolveError::Cancelled`].
    pub fn start(
        &mut self,
        commanded: &[f64],
        wanted: Option<&[Vec<f64>]>,
        search: &mut Search<'_>,
        (control, workspace): (&Control<'_>, &mut Workspace),
    ) -> Result<Option<Led<'_>>, SolveError> {
        if !search.forward.has_no_memory() {
            return Ok(None);
        }
        if self.places != search.places() {
            *self = Self { places: search.places().to_vec(), ..Self::default() };
        }
        let unknowns = within(commanded, control.bounds);
        if self.commanded.as_ref().is_none_or(|known| known.unknowns != unknowns) {
            let bounds = wanted.map(|_| control.bounds);
            self.commanded = Landmark::at(search.forward, unknowns, &self.places, bounds)?;
        }
        let Some(wanted) = wanted else {
            let known = self.commanded.as_ref();
            return Ok(known.map(|landmark| {
                search.forward.solves += landmark.solves;
                Led { landmark, to: None }
            }));
        };
        if !self.has_spread {
            self.has_spread = true;
            for unknowns in wanted {
                let unknowns = within(unknowns, control.bounds);
                let bounds = Some(control.bounds);
                self.spread.extend(Landmark::at(search.forward, unknowns, &self.places, bounds)?);
            }
        }
        let all = || self.commanded.iter().chain(&self.spread);
        let mut near = [(f64::INFINITY, None); COMPARED];
        for landmark in all() {
            let most = near[COMPARED - 1].0;
            let squares = search.squares(&landmark.evaluation.solution, most);
            let place = near.partition_point(|(of, _)| *of <= squares);
            if squares < most {
                near[place..].rotate_right(1);
                near[place] = (squares, Some(landmark));
            }
        }
        // Of a point alone, shapes near it may have commands far from those that are looked for.
        let is_point = matches!(search.target, Target::Tip(_));
        let nearest = match is_point && commanded.len() <= MOST_UNKNOWNS {
            false => near[0].1,
            true => {
                let (mut least, mut best) = (f64::INFINITY, near[0].1);
                for landmark in near.iter().filter_map(|(_, landmark)| *landmark) {
                    let left = Self::left(landmark, search, control, workspace);
                    if left < least {
                        (least, best) = (left, Some(landmark));
                    }
                }
                best
            }
        };
        let Some(landmark) = nearest else { return Ok(None) };
        search.forward.solves += landmark.solves;
        if let Some(answer) = &landmark.answer {
            search.correct(answer, &landmark.evaluation);
        }
        let to = landmark.rate_changes.as_ref().and_then(|rate_changes| {
            let Landmark { unknowns, evaluation, .. } = landmark;
            let from = (unknowns.as_slice(), evaluation, rate_changes);
            let (to, curvature) = led(from, &self.places, search, control, workspace)?;
            search.expect_curvature(curvature);
            Some(to)
        });
        Ok(Some(Led { landmark, to }))
    }

    /// How far from the target the first step from a landmark leads, about, in m: what the linear problem leaves, and what the step bends the robot by more than that knows of.
    fn left(
        landmark: &Landmark,
        search: &Search<'_>,
        control: &Control<'_>,
        workspace: &mut Workspace,
    ) -> f64 {
        let linear = search.linearize(&landmark.evaluation);
        let penalty = 1e2 * linear.cost().max(1e-30);
        let region = Region { damping: FIRST_DAMPING, radius: LARGEST_RADIUS };
        let step = workspace.step(&linear, &[], &landmark.unknowns, control, region, penalty);
        if step.is_err() {
            return f64::INFINITY;
        }
        let steps = workspace.last_step().iter().take(landmark.unknowns.len());
        let size = steps.fold(0.0, |most: f64, d| most.max(d.abs()));
        workspace.left().0 + search.forward.robot().backbone().length * size * size
    }
}
