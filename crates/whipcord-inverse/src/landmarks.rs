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
    pub solves: usize,
}

/// The shapes that are known, for the places of the kind of target that was asked for last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Landmarks {
    places: Vec<Place>,
    /// Where the case is: alone, and as one of many shapes.
    commanded: [Option<Landmark>; 2],
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
    /// At unknowns; one of many shapes with its second derivatives within bounds at the places of the target, and with an answer where that is of another model than the trials. `None` where there is
    /// none.
    ///
    /// # Errors
    /// [`SolveError::Cancelled`].
    fn at(
        forward: &mut Forward,
        unknowns: Vec<f64>,
        places: &[Place],
        of_many: Option<(&[[f64; 2]], &[Place])>,
    ) -> Result<Option<Self>, SolveError> {
        // What it takes is counted where it is used.
        let first = forward.solves;
        let found = Self::solved(forward, unknowns, places, of_many);
        forward.solves = first;
        match found {
            Ok(landmark) => Ok(Some(landmark)),
            Err(error @ SolveError::Cancelled { .. }) => Err(error),
            Err(_) => Ok(None),
        }
    }

    fn solved(
        forward: &mut Forward,
        unknowns: Vec<f64>,
        places: &[Place],
        of_many: Option<(&[[f64; 2]], &[Place])>,
    ) -> Result<Self, SolveError> {
        let first = forward.solves;
        let evaluation = forward.evaluate(&unknowns, places, None)?;
        let rate_changes = match of_many {
            Some((bounds, places)) => {
                RateChanges::at(&evaluation, &unknowns, bounds, places, forward)?
            }
            None => None,
        };
        let answer = match of_many.is_some() && forward.is_on_few_steps() {
            true => {
                let Evaluation { shortenings, solution, .. } = &evaluation;
                let solution = forward.verify(&unknowns, shortenings, solution)?;
                Some(forward.with_rates_of(solution, &evaluation))
            }
            false => None,
        };
        let solves = forward.solves - first;
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
        // Motions of the target alone: constraints go by their first derivatives.
        let of_target = &self.places[..search.target.places().len()];
        let spread_within = wanted.map(|_| (control.bounds, of_target));
        let slot = &mut self.commanded[usize::from(wanted.is_some())];
        if slot.as_ref().is_none_or(|known| known.unknowns != unknowns) {
            *slot = Landmark::at(search.forward, unknowns, &self.places, spread_within)?;
        }
        let commanded_by = &self.commanded[usize::from(wanted.is_some())];
        let Some(wanted) = wanted else {
            return Ok(commanded_by.as_ref().map(|landmark| {
                search.forward.solves += landmark.solves;
                Led { landmark, to: None }
            }));
        };
        if !self.has_spread {
            let mut spread = Vec::with_capacity(wanted.len());
            for unknowns in wanted {
                let unknowns = within(unknowns, control.bounds);
                let found = Landmark::at(search.forward, unknowns, &self.places, spread_within)?;
                spread.extend(found);
            }
            (self.spread, self.has_spread) = (spread, true);
        }
        let all = || commanded_by.iter().chain(&self.spread);
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
            let (to, curvature) = led(from, of_target, search, control, workspace)?;
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
        let penalty = linear.penalty();
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
