//! Cosserat rods among obstacles: what [`Compliant`] asks, of a rod that takes one step of Newton's method at a time.

use whipcord_numerics::{Pose, Vec3};

use super::alone::AloneAnswers;
use super::contact_rod::ContactRod;
use super::holding::Holding;
use super::model::{Compliant, Push, is_same_shape, with_pushes};
use super::noted::{Found, Noted, NotedEnd, NotedWay, Noting, OnWay, where_it_counts};
use super::steps::{RubbedAnswer, solve_rubbing};
use crate::budget::Meter;
use crate::case::Case;
use crate::derivatives::{Derivatives, gravity_change};
use crate::error::{Obstruction, SolveError};
use crate::parameter::Parameter;
use crate::robot::{Cable, Robot};
use crate::shape::Wrench;
use crate::solution::{NoStability, Solution};
use crate::statics::grid::Grid;
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::Remembering;

/// Steps from base to tip at least, where the accuracy that is asked for does not say: few are quick, and where the way to the
/// answer is lost on them more find it.
const CONTACT_STEPS: [usize; 2] = [10, 96];

/// What a tension of a passage adds to the effort of an iteration, and the cube of their number.
const RUBBING_EFFORT: [f64; 2] = [0.003, 3e-7];
/// What the way may spend on few steps, and on more.
const WAY_BUDGET: [f64; 2] = [700.0, 3500.0];
/// What may be spent at its end, and on another one. Refusals take two seconds at most in all, in the study of outcomes.
const RENEWED_BUDGET: [f64; 2] = [350.0, 750.0];
/// What the way into pipes may spend on few steps, and on more: it is long where they are narrow and bent.
const INSERTION_BUDGET: [f64; 2] = [2000.0, 4000.0];
/// What a solve may spend where cables rub.
const RUBBING_BUDGET: f64 = 2000.0;

/// What `solve` finds on few steps, no fewer than the loads need, or on more where that is no answer; it is given how many there
/// are.
pub(super) fn on_few_steps_or_more<T>(
    accuracy: Accuracy,
    needed: usize,
    mut solve: impl FnMut(usize) -> Result<T, SolveError>,
) -> Result<T, SolveError> {
    let [few, more] = CONTACT_STEPS;
    let few = needed.clamp(few, more);
    match (solve(few), accuracy) {
        // What nothing holds falls on any steps.
        (Err(error @ SolveError::Obstructed { why: Obstruction::NotHeld { .. }, .. }), _) => {
            Err(error)
        }
        (
            Err(
                SolveError::Obstructed { .. }
                | SolveError::NotInserted { .. }
                | SolveError::NotConverged { .. }
                | SolveError::StepsTooCoarse { .. }
                | SolveError::NoDerivatives
                | SolveError::SectionFolds { .. },
            ),
            Accuracy::Tolerance(_),
        ) if few < more => solve(more),
        (found, _) => found,
    }
}

/// So many stations cost little as ends of steps; more are interpolated where nothing is differentiated.
const FEW_STATIONS: usize = 24;

/// A rod among obstacles.
pub(crate) struct RodAdapter<'a, R: ContactRod> {
    robot: &'a Robot,
    /// As the user wants the answer.
    options: &'a Options,
    meter: &'a Meter,
    watched: &'a [f64],
    /// Where steps end.
    stations: Vec<f64>,
    initial_lengths: Vec<f64>,
    force_scale: f64,
    /// The case that it last looked at, with the pushes among its loads.
    case: Case,
    warm: Option<Solution>,
    found: R,
    /// Of the watched places.
    centres: Vec<Vec3>,
    kept: R::Kept,
    steps: usize,
    /// Whether a cable rubs in its holes.
    rubs: bool,
    /// Whether anything has touched on the way.
    has_touched: bool,
    is_touched: bool,
    /// Whether dead moments are among the loads of the case that it last looked at.
    has_moments: bool,
    /// Answers without obstacles that another attempt has found.
    alone: Option<&'a AloneAnswers>,
    /// The equilibria on the way, where their derivatives are asked for.
    notes: Option<NotedWay<R::Kept>>,
    /// What friction against bending holds from the steps of actuation before.
    plastic: Option<PlasticCurvature>,
    /// The same where the step of actuation before began.
    plastic_before: Option<PlasticCurvature>,
}

impl<'a, R: ContactRod> RodAdapter<'a, R> {
    /// A rod whose solve is counted by a meter, that is watched at these arc lengths in m, and whose cables have these lengths in m before actuation; `stiffness` is that of
    /// bending at the base, and it has at least so many steps where the accuracy that is asked for does not say how many.
    pub fn new(
        robot: &'a Robot,
        (options, meter): (&'a Options, &'a Meter),
        watched: &'a [f64],
        initial_lengths: Vec<f64>,
        stiffness: f64,
        steps: usize,
    ) -> Self {
        let length = robot.backbone().length;
        let count = watched.len();
        let mut adapter = Self {
            robot,
            options,
            meter,
            watched,
            stations: robot.disks().arc_lengths.clone(),
            initial_lengths,
            force_scale: stiffness / (length * length),
            case: Case::default(),
            warm: None,
            found: R::default(),
            centres: vec![Vec3::ZERO; count],
            kept: R::Kept::default(),
            steps,
            rubs: robot.cables().iter().any(Cable::has_friction),
            has_touched: false,
            is_touched: false,
            has_moments: false,
            alone: None,
            notes: None,
            plastic: None,
            plastic_before: None,
        };
        adapter.found.refinement().steps = steps;
        if options.stations.arc_lengths(robot).len() <= FEW_STATIONS {
            adapter.with_stations()
        } else {
            adapter
        }
    }
}

impl<'a, R: ContactRod> RodAdapter<'a, R> {
    /// The same that shares answers without obstacles with other attempts.
    pub const fn sharing(mut self, alone: &'a AloneAnswers) -> Self {
        self.alone = Some(alone);
        self
    }

    /// The same with steps that end at the stations too, so that these can be differentiated.
    pub fn with_stations(mut self) -> Self {
        self.stations.extend(self.options.stations.arc_lengths(self.robot));
        self.stations.sort_by(f64::total_cmp);
        self.stations.dedup();
        self
    }

    /// The same that takes note of the equilibria on the way.
    pub fn taking_notes(mut self) -> Self {
        self.notes = Some(NotedWay::default());
        self
    }

    /// The same whose backbone holds what earlier steps of actuation left.
    pub fn with_plastic(mut self, plastic: Option<&PlasticCurvature>) -> Self {
        if let Some(plastic) = plastic {
            self.set_plastic(plastic.clone());
        }
        self
    }

    fn set_plastic(&mut self, left: PlasticCurvature) {
        self.found.set_plastic(&left);
        self.plastic_before = self.plastic.replace(left);
    }

    /// What it may spend of this on few steps, or on more.
    const fn on_steps(&self, [few, more]: [f64; 2]) -> f64 {
        if self.steps < CONTACT_STEPS[1] { few } else { more }
    }

    /// The plastic curvature that the answer at which it stands leaves.
    pub fn plastic_left(&self) -> Result<PlasticCurvature, SolveError> {
        self.found.plastic_left(self.robot, &self.case)
    }

    /// The derivatives of the answer that it stands at, the last equilibrium that it noted in these steps of actuation.
    pub fn differentiate_notes(
        &mut self,
        (step, steps, parameters): (usize, &[Case], &[Parameter]),
        remembering: &mut Remembering,
    ) -> Result<Derivatives, SolveError>
    where
        R: Clone,
    {
        let Some(way) = self.notes.take() else { return Err(SolveError::NoDerivatives) };
        let stands = self.found.clone();
        let kept = parameters.len() + self.robot.cables().len();
        let asked = self.options.stations.arc_lengths(self.robot);
        let bends = self.robot.has_bending_friction();
        let (none, mut held_of) = (PlasticCurvature::default(), step);
        let found = remembering.go(&way, kept, |of_bends, end, carried, place| {
            let noted = &end.shape;
            if bends && noted.at.step != held_of {
                // Where that stood the backbone held what was left before.
                match (noted.at.step + 1 == step, &self.plastic_before) {
                    (false, _) if noted.at.step != step => {
                        return Err(SolveError::NoDerivativesOfRest);
                    }
                    (false, _) => self.found.set_plastic(self.plastic.as_ref().unwrap_or(&none)),
                    (true, left) => self.found.set_plastic(left.as_ref().unwrap_or(&none)),
                }
                held_of = noted.at.step;
            }
            let cases = noted.cases(steps).ok_or(SolveError::NoDerivatives)?;
            let number = way.ends.iter().position(|of| core::ptr::eq(of, end));
            let before = number.and_then(|number| way.ends.get(number.checked_sub(1)?));
            let end = NotedEnd {
                noted,
                before: before.map(|before| &before.shape.state),
                standing: &end.standing,
                carried,
                history: of_bends.before(self.robot, noted.at.step)?,
                case: &noted.case_by_fractions(&cases),
                cases: &cases,
                stations: if place.is_last { &asked } else { &noted.next },
                is_last: place.is_last,
            };
            let derivatives = self.found.differentiate_noted(self.robot, &end, parameters)?;
            let found = end.found(derivatives, self.found.shape(), |s| self.found.node(s))?;
            if place.is_last && bends {
                let grid = self.found.grid().ok_or(SolveError::NoDerivatives)?;
                of_bends.note(step, found.0.plastic_left(self.robot, grid).1);
            }
            Ok(found)
        });
        let found = found.map(|mut derivatives| {
            derivatives.remember_change(way.was_between());
            derivatives
        });
        (self.notes, self.found) = (Some(way), stands);
        found
    }

    /// Notes where the watched places are.
    fn see(&mut self) {
        self.found.shape().centres(self.watched, &mut self.centres);
    }

    /// The derivatives of the answer that it stands at, with the contacts that hold it.
    pub fn differentiate(
        &self,
        holding: &Holding,
        history: &[PlasticCurvature],
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError> {
        let alone = self.found.differentiate(self.robot, &self.case, history, parameters)?;
        let node = |&s: &f64| self.found.node(s);
        let stations = self.options.stations.arc_lengths(self.robot).iter().map(node).collect();
        let places = holding.places.iter().map(node).collect();
        let gravity = parameters.iter().map(|parameter| gravity_change(parameter, &self.case));
        let gravity: Vec<Vec3> = gravity.collect();
        let (gain, change) =
            (|compliance: &[f64]| holding.gain(compliance), holding.is_about_to_change);
        alone
            .at_stations(stations)
            .touching(places, gain, &gravity, change)
            .map_err(|_| SolveError::NoDerivatives)
    }

    /// The grid on which it stands.
    pub fn grid(&self) -> Option<&Grid> {
        self.found.grid()
    }
}

/// What is pushed at each disk, contact or not, and at the other places of contacts, in order: the loads of a grid that stays
/// the same while disks come into contact or leave it.
fn by_place(disks: &[f64], pushes: &[Push]) -> Vec<Push> {
    let idle = |&arc_length: &f64| Push { arc_length, wrench: Wrench::default() };
    let mut all: Vec<Push> = disks.iter().map(idle).chain(pushes.iter().copied()).collect();
    all.sort_by(|a, b| a.arc_length.total_cmp(&b.arc_length));
    all.dedup_by(|next, sum| {
        let is_same = next.arc_length == sum.arc_length;
        if is_same {
            sum.wrench.force += next.wrench.force;
            sum.wrench.moment += next.wrench.moment;
        }
        is_same
    });
    all
}

/// The answers to all steps of a case of a rod whose cables rub, from rest on, and whether anything had touched on the way to each.
pub(crate) fn rub<R: ContactRod>(
    adapter: &mut RodAdapter<'_, R>,
    case: &Case,
    mut each: impl FnMut((Solution, bool)),
) -> Result<(), (usize, SolveError)> {
    let robot = adapter.robot;
    solve_rubbing(adapter, robot, (case, 1.0), |adapter, answer| {
        let RubbedAnswer { mut solution, has_touched, .. } = answer;
        if robot.has_bending_friction() {
            keep_plastic(adapter, &mut solution)?;
        }
        each((solution, has_touched));
        Ok(())
    })
}

/// Lets the backbone keep what its friction holds where it stands, at this answer.
fn keep_plastic<R: ContactRod>(
    adapter: &mut RodAdapter<'_, R>,
    solution: &mut Solution,
) -> Result<(), SolveError> {
    let left = adapter.plastic_left()?;
    solution.plastic_curvature = left.at_stations(&solution.shape.arc_length);
    adapter.set_plastic(left);
    Ok(())
}

/// The answers to all steps of a case of a rod whose cables or obstacles rub, from rest on, with the first step on the way to the first: those that
/// are asked for by their number from 0 with their derivatives by commands, loads and these parameters.
pub(super) fn differentiate_rubbing<R: ContactRod + Clone>(
    adapter: &mut RodAdapter<'_, R>,
    (case, first_step, parameters): (&Case, f64, &[Parameter]),
    asks: impl Fn(usize) -> bool,
    found: &mut Vec<Found<Derivatives>>,
) -> Result<(), (usize, SolveError)> {
    found.clear();
    let (robot, steps) = (adapter.robot, case.leading_steps().collect::<Vec<Case>>());
    let bends = robot.has_bending_friction();
    let mut remembering = Remembering::default();
    solve_rubbing(adapter, robot, (case, first_step), |adapter, answer| {
        let RubbedAnswer { mut solution, has_touched, holding } = answer;
        let step = found.len();
        let asked = (step, &steps[..], parameters);
        let mut differentiate = || {
            let of_way = adapter.differentiate_notes(asked, &mut remembering);
            if adapter.rubs {
                return of_way;
            }
            let on = adapter.differentiate(&holding, &[], parameters)?;
            match of_way {
                Ok(of_way) => Ok(of_way.moving_on(on)),
                // What has jumped moves on as if its way had begun there.
                Err(SolveError::NoDerivativesOfRest) => Ok(on),
                Err(error) => Err(error),
            }
        };
        let derivatives = (asks(step) || bends).then(&mut differentiate);
        let derivatives = where_it_counts(derivatives, has_touched)?;
        if bends {
            keep_plastic(adapter, &mut solution)?;
        }
        found.push(((solution, derivatives.filter(|_| asks(step))), has_touched));
        Ok(())
    })
}

impl<R: ContactRod> Compliant for RodAdapter<'_, R> {
    fn watched(&self) -> &[f64] {
        self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.initial_lengths
    }

    fn knows_forces(&self) -> bool {
        true
    }

    fn force_scale(&self) -> f64 {
        self.force_scale
    }

    fn meter(&self) -> &Meter {
        self.meter
    }

    fn effort(&self) -> f64 {
        // To look at a watched place costs a tenth of a step.
        let steps = R::WORK_OF_STEP * self.found.steps() as f64;
        let steps = (steps + 0.1 * self.watched.len() as f64) / 100.0;
        let tensions = self.found.rubbing_tensions() as f64;
        steps + RUBBING_EFFORT[0] * tensions + RUBBING_EFFORT[1] * tensions.powi(3)
    }

    fn budget(&self) -> f64 {
        if self.rubs {
            return RUBBING_BUDGET;
        }
        self.on_steps(WAY_BUDGET)
    }

    fn renewed_budget(&self) -> f64 {
        if self.rubs { 0.5 * RUBBING_BUDGET } else { self.on_steps(RENEWED_BUDGET) }
    }

    fn insertion_budget(&self) -> f64 {
        if self.rubs { RUBBING_BUDGET } else { self.on_steps(INSERTION_BUDGET) }
    }

    fn refine(&mut self) -> Result<bool, SolveError> {
        self.found.refine(&self.case, self.options.accuracy)
    }

    fn reset(&mut self) {
        self.found.reset();
    }

    fn start_from(&mut self, answer: &Solution) {
        if self.found.has_history() {
            return;
        }
        self.found = R::default();
        self.found.refinement().steps = self.steps;
        if let Some(plastic) = &self.plastic {
            self.found.set_plastic(plastic);
        }
        self.warm = Some(answer.clone());
    }

    fn consider(&mut self, case: &Case, pushes: &[Push]) -> Result<(), SolveError> {
        self.is_touched = pushes.iter().any(|push| push.wrench != Wrench::default());
        self.has_moments = case.loads.has_dead_moment();
        let pushes = by_place(&self.robot.disks().arc_lengths, pushes);
        self.case = with_pushes(case, &pushes);
        let places: Vec<f64> = pushes.iter().map(|push| push.arc_length).collect();
        let warm = self.warm.take();
        let at = (&self.stations[..], &places[..]);
        self.found.look(self.robot, self.options, &self.case, at, warm.as_ref())?;
        self.see();
        Ok(())
    }

    fn pose(&self, arc_length: f64) -> Pose {
        self.found.shape().pose(arc_length)
    }

    fn centre(&self, place: usize) -> Vec3 {
        self.centres[place]
    }

    fn residual(&self) -> f64 {
        self.found.gap()
    }

    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> Result<f64, SolveError> {
        self.found.linearise(self.robot, &self.case)?;
        Ok(self.found.advance(changes, part))
    }

    fn compliance(
        &mut self,
        pushes: &[Push],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) -> Result<(), SolveError> {
        self.found.linearise(self.robot, &self.case)?;
        self.found.compliance(pushes.iter().map(|push| push.arc_length), compliance, drift);
        let finite = compliance.iter().chain(&*drift).all(|value| value.is_finite());
        if finite { Ok(()) } else { Err(SolveError::NoDerivatives) }
    }

    fn stands_alone(&mut self) -> bool {
        // A tangent that cannot be taken apart is about to change its sign: it has not yet.
        if self.rubs && self.found.linearise(self.robot, &self.case).is_err() {
            return true;
        }
        self.found.stands()
    }

    fn unstable_alone(&mut self) -> Option<usize> {
        let has_potential = !self.has_moments && !self.robot.has_bending_friction();
        has_potential.then(|| self.found.unstable_directions()).flatten()
    }

    fn has_touched(&self) -> bool {
        self.has_touched || self.is_touched
    }

    fn keep(&mut self) {
        self.has_touched |= self.is_touched;
        self.found.keep(&mut self.kept);
    }

    fn pose_before(&self, arc_length: f64) -> Pose {
        R::pose_before(&self.kept, arc_length)
    }

    fn go_back(&mut self) {
        self.found.go_back(&self.kept);
        self.see();
    }

    fn solve_free(&mut self, case: &Case) -> Result<Solution, SolveError> {
        if self.rubs {
            // What the holes remember of the way would be lost.
            return Err(SolveError::NoDerivatives);
        }
        let solve = || self.found.solve_free(self.robot, self.options, (case, None), self.meter);
        match self.alone {
            Some(alone) => alone.answer(case, solve),
            None => solve(),
        }
    }

    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError> {
        let mut solution = self.found.solution(&self.case)?.ok_or(SolveError::NoDerivatives)?;
        let touching = pushes.iter().any(|push| push.wrench != Default::default());
        if !touching
            && !self.rubs
            && let Ok(free) =
                self.found.solve_free(self.robot, self.options, (case, Some(&solution)), self.meter)
            && is_same_shape(&free, &solution)
        {
            return Ok(free);
        }
        let asked = self.options.stations.arc_lengths(self.robot);
        let shape = self.found.shape();
        solution.shape.set(&asked, asked.iter().map(|&s| shape.pose(s)), case.base);
        if self.options.stability != StabilityAnalysis::Off {
            let absent = if touching { NoStability::Touching } else { NoStability::Undetermined };
            solution.diagnostics.stability_absent = Some(absent);
        }
        Ok(solution)
    }
}

impl<R: ContactRod> Noting for RodAdapter<'_, R> {
    fn takes_notes(&self) -> bool {
        self.notes.is_some()
    }

    fn note(&mut self, holding: Holding, at: OnWay) {
        if let (Some(way), Some(standing)) = (&mut self.notes, self.found.standing()) {
            let (state, case) = (self.found.here(), self.case.clone());
            way.note(standing, Noted { state, case, holding, at, next: Vec::new() });
        }
    }

    fn forget_notes(&mut self) {
        self.notes.iter_mut().for_each(|way| *way = NotedWay::default());
    }

    fn lose_notes(&mut self) {
        self.notes.iter_mut().for_each(|way| way.is_broken = true);
    }
}
