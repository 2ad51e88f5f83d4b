//! Shapes whose evaluations are known before a target is: an iteration that starts from one of them takes its first step without a solve, and where second
//! derivatives are known starts from where these lead.

use whipcord::SolveError;
use whipcord::derivatives::Place;

use crate::descent::{Control, FIRST_DAMPING, LARGEST_RADIUS, Problem, Region, Workspace, within};
use crate::evaluation::Evaluation;
use crate::forward::Forward;
use crate::rate_changes::{Foretold, RateChanges};
use crate::search::Search;
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

/// Steps to where derivatives lead, and the last one, in changes that bend the robot by half a turn.
const STEPS: usize = 5;
const LAST_STEP: f64 = 1e-3;
/// How far second derivatives hold, likewise.
const FAR: f64 = 0.5;

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
        let led = Self::led(landmark, &self.places, search, control, workspace);
        let to = led.map(|(to, curvature)| {
            search.expect_curvature(curvature);
            to
        });
        Ok(Some(Led { landmark, to }))
    }

    /// Where the first and second derivatives at a landmark lead, and what the second ones add to the residuals there over the square of the way, as in
    /// [`Control::curvature`]. `None` where they are not known or lead nowhere.
    fn led(
        landmark: &Landmark,
        places: &[Place],
        search: &Search<'_>,
        control: &Control<'_>,
        workspace: &mut Workspace,
    ) -> Option<(Vec<f64>, f64)> {
        let rate_changes = landmark.rate_changes.as_ref()?;
        let Landmark { unknowns, evaluation, .. } = landmark;
        let first = search.linearize(evaluation);
        let near = |((x, scale), [least, greatest]): ((&f64, &f64), &[f64; 2])| {
            [least.max(x - FAR * scale), greatest.min(x + FAR * scale)]
        };
        let ways = unknowns.iter().zip(control.scales).zip(control.bounds);
        let bounds: Vec<[f64; 2]> = ways.map(near).collect();
        let control = &Control { bounds: &bounds, ..*control };
        let region = Region { damping: FIRST_DAMPING, radius: LARGEST_RADIUS };
        let (mut to, mut linear) = (unknowns.clone(), first.clone());
        let mut changes = vec![0.0; to.len()];
        let mut foretold = Foretold::default();
        for _ in 0..STEPS {
            let penalty = 1e2 * linear.cost().max(1e-30);
            workspace.step(&linear, &[], &to, control, region, penalty).ok()?;
            let mut size = 0.0_f64;
            for (k, (x, d)) in to.iter_mut().zip(workspace.last_step()).enumerate() {
                let [least, greatest] = bounds[k];
                *x = (*x + d * control.scales[k]).clamp(least, greatest);
                changes[k] = *x - unknowns[k];
                size = size.max(d.abs());
            }
            rate_changes.foretell(evaluation, places, &changes, &mut foretold);
            search.foretell(&foretold, &mut linear);
            for (slack, (at_first, row)) in linear
                .slack
                .iter_mut()
                .zip(first.slack.iter().zip(first.rows.chunks_exact(changes.len())))
            {
                *slack = at_first - row.iter().zip(&changes).map(|(a, d)| a * d).sum::<f64>();
            }
            if size < LAST_STEP {
                break;
            }
        }
        let far = changes.iter().zip(control.scales);
        let far = far.fold(0.0_f64, |most, (change, scale)| most.max((change / scale).abs()));
        if far == 0.0 || linear.cost() >= first.cost() {
            return None;
        }
        let rows = first.jacobian.chunks_exact(changes.len());
        let beyond =
            rows.zip(first.residual.iter().zip(&linear.residual)).map(|(row, (r, next))| {
                next - r - row.iter().zip(&changes).map(|(j, d)| j * d).sum::<f64>()
            });
        let beyond = beyond.map(|part| part * part).sum::<f64>().sqrt();
        Some((to, beyond / (far * far)))
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
