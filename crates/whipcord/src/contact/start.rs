//! Where the way begins: at a known answer with its contacts, or at rest, drawn back where pipes stand around the robot.

use whipcord_numerics::{Pose, Vec3};

use super::noted::{Noting, OnWay};
use super::object::Objects;
use super::pair::OVERLAP;
use super::path::{Acting, JUMPS, PathTracker, Steps, Stop};
use super::scene::Present;
use crate::case::Case;
use crate::error::{Obstruction, SolveError};
use crate::insertion_stop::InsertionStop;
use crate::solution::{Part, Solution};

/// A known answer is where the model stands if no disk is farther from it than this part of the length.
const FOUND_AGAIN: f64 = 1e-9;
/// How far the base is drawn back to insert the robot, as a part of its length.
const INSERTED: f64 = 1.02;
/// The longest steps of a robot that touches, tried in turn: those that are long come to other equilibria, of which some lead nowhere.
const LONGEST_INSIDE: [f64; 3] = [1.0, 0.02, 0.005];
/// In a narrow pipe all steps are short: after one that had to be shortened the next is little longer.
const GROWTH_INSIDE: f64 = 1.2;
/// The least step: less than the clearance of a narrow pipe, by which the robot may move aside in one.
const LEAST_INSIDE: f64 = 1e-4;

/// Whether an obstruction may be that of an object, and not of the budget.
const fn error_of_object(why: &Obstruction) -> bool {
    !matches!(why, Obstruction::BudgetSpent { .. } | Obstruction::TooManyContacts { .. })
}

/// The same on the way into pipes, on which the robot has no loads and objects are held.
fn insertion_stop(why: Obstruction) -> InsertionStop {
    match why {
        Obstruction::Model(error) => InsertionStop::Model { reason: error.on_way(0.0).to_string() },
        Obstruction::NotConverged { residual } => InsertionStop::NotConverged { residual },
        Obstruction::BudgetSpent { iterations, residual, contacts } => {
            InsertionStop::BudgetSpent { iterations, residual, contacts }
        }
        Obstruction::TooManyContacts { contacts, most } => {
            InsertionStop::TooManyContacts { contacts, most }
        }
        Obstruction::NoClearance { disk, clearance, enough, .. } => {
            InsertionStop::NoClearance { disk, clearance, enough }
        }
        Obstruction::Slips
        | Obstruction::Leaps
        | Obstruction::NotHeld { .. }
        | Obstruction::NoneAlone { .. } => InsertionStop::Leaps,
    }
}

impl<M: Noting> PathTracker<'_, M> {
    /// Where the way begins: at a known answer with its contacts, or at rest, where nothing may overlap.
    pub(super) fn start(
        &mut self,
        (case, of_case): (&Case, [f64; 2]),
        answer: Option<&Solution>,
        to_base: &Pose,
    ) -> Result<(), SolveError> {
        self.objects.place(&mut self.scene);
        self.scene.begin_step();
        let Some(answer) = answer else {
            self.rest(case)?;
            [self.on_way.commands, self.on_way.loads] = of_case;
            self.note();
            self.scene.keep(Present::Pipes);
            if self.pairs.deepest(self.model, &self.scene).is_some() {
                let are_held = core::mem::replace(&mut self.objects.are_held, true);
                let inserted = self.insert((case, of_case));
                self.objects.are_held = are_held;
                inserted?;
            }
            self.scene.keep(Present::All);
            if let Some((owner, other, depth)) = self.objects.deepest(&self.scene, self.length) {
                let [object, obstacle] =
                    [owner, other].map(|number| self.scene.get(number).name.clone());
                return Err(SolveError::ObjectOverlaps { object, obstacle, depth });
            }
            return self.refuse_overlap();
        };
        self.model.start_from(answer);
        self.objects.resume(answer, to_base, &self.scene, self.length);
        let count = self.scene.count();
        for contact in answer.contacts.iter().filter(|t| t.obstacle < count) {
            self.pairs.resume(contact, answer, to_base, &self.scene);
        }
        self.pairs.pushes(&mut self.pushes);
        self.model.consider(case, &self.pushes)?;
        let disks = answer.disks.arc_length.iter().zip(&answer.disks.poses);
        let moved = |(&s, pose): (&f64, &Pose)| {
            (self.model.pose(s).position - to_base.transform(pose.position)).norm()
        };
        self.is_off_answer = disks.map(moved).fold(0.0, f64::max) > FOUND_AGAIN * self.length;
        Ok(())
    }

    /// Inserts the robot at rest into the pipes: from where its base is drawn back by its length, forward.
    fn insert(&mut self, (case, of_case): (&Case, [f64; 2])) -> Result<(), SolveError> {
        // The base touches nothing, but where it is the robot has to come out of the bore.
        let walled = self.scene.iter().find_map(|(_, pipe)| {
            let depth = -pipe.surface(Vec3::ZERO).distance;
            (depth > OVERLAP * self.length).then(|| SolveError::ObstacleInTheWay {
                obstacle: pipe.name.clone(),
                part: Part::Backbone,
                arc_length: 0.0,
                depth,
                axis: None,
            })
        });
        if let Some(error) = walled {
            return Err(error);
        }
        let line = self.only_bore();
        let start = INSERTED * self.length;
        self.scene.draw_back(start);
        self.refuse_overlap()?;
        let back = |way: f64| Acting { drawn_back: start * (1.0 - way), of_case, ..Acting::ALL };
        // Half of it for each of two ways, where there are two.
        let ways = if line.is_some() { 2.0 } else { 1.0 };
        let budget = self.model.insertion_budget() / ways;
        self.budget = self.spent + budget;
        self.is_going_in = true;
        let mut gone = self.go_in((case, of_case), back, start);
        self.is_going_in = false;
        if let (Err(error), Some(line)) = (&gone, line)
            && !matches!(error, SolveError::Cancelled { .. } | SolveError::BudgetSpent { .. })
        {
            self.draw_back_at_rest((case, of_case), 0.0)?;
            self.budget = self.spent + budget;
            match self.lay_along(case, &line) {
                Ok(()) => {
                    self.lose_notes();
                    gone = Ok(());
                }
                Err(Stop::Cancelled) => return Err(SolveError::Cancelled { last_load: None }),
                Err(_) => {}
            }
        }
        // Where it jumped without its loads is no loss of the shape under them.
        (self.lost_at, self.slipped_at) = (None, None);
        self.budget = self.spent + self.model.budget();
        gone
    }

    /// Goes in from where the base is drawn back by so much, in ever shorter steps; the error of the attempt that came farthest.
    fn go_in(
        &mut self,
        (case, of_case): (&Case, [f64; 2]),
        back: impl Fn(f64) -> Acting,
        start: f64,
    ) -> Result<(), SolveError> {
        let mut farthest: Option<(f64, SolveError)> = None;
        for (attempt, longest_touching) in LONGEST_INSIDE.into_iter().enumerate() {
            if attempt > 0 {
                self.draw_back_at_rest((case, of_case), start)?;
            }
            let is_last = attempt + 1 == LONGEST_INSIDE.len();
            let steps = Steps {
                growth_after_short: GROWTH_INSIDE,
                longest_touching,
                // What the holes of a cable remember is lost in a jump.
                jumps: if self.rubs && !is_last { 0 } else { JUMPS },
                least: LEAST_INSIDE,
                ..Steps::up_to(self.longest_step)
            };
            let Err(error) = self.go_in_steps(case, |_| case.clone(), &back, steps) else {
                return Ok(());
            };
            let is_ended = !error.is_obstruction();
            let error = self.not_inserted(error, start);
            if matches!(error, SolveError::Cancelled { .. } | SolveError::BudgetSpent { .. }) {
                return Err(error);
            }
            let reached = self.reached;
            if farthest.as_ref().is_none_or(|(before, _)| reached > *before) {
                farthest = Some((reached, error));
            }
            if is_ended {
                break;
            }
        }
        farthest.map_or(Ok(()), |(_, error)| Err(error))
    }

    /// Goes back to where the way in begins.
    fn draw_back_at_rest(
        &mut self,
        (case, [commands, loads]): (&Case, [f64; 2]),
        start: f64,
    ) -> Result<(), SolveError> {
        (self.odd, self.lost_at, self.slipped_at) = (None, None, None);
        self.pairs.near.clear();
        self.model.reset();
        self.model.forget_notes();
        self.rest(case)?;
        self.on_way = OnWay { step: self.on_way.step, commands, loads, ..OnWay::default() };
        self.note();
        self.scene.draw_back(start);
        Ok(())
    }

    /// What ended the way in from where the base was drawn back by so much.
    fn not_inserted(&self, error: SolveError, start: f64) -> SolveError {
        let SolveError::Obstructed { reached, touching, why } = error else {
            // Nothing of the case acts yet.
            return error.on_way(0.0);
        };
        let pushing = self.pairs.near.iter().filter(|pair| pair.force > 0.0);
        let hardest = pushing.max_by(|a, b| a.force.total_cmp(&b.force)).map(|pair| pair.obstacle);
        let Some(number) = hardest.or_else(|| self.scene.iter().next().map(|(k, _)| k)) else {
            return SolveError::Obstructed { reached, touching, why };
        };
        let pipe = self.scene.get(number).name.clone();
        let length = self.length;
        let inserted = (length - start * (1.0 - reached)).max(0.0);
        SolveError::NotInserted { pipe, inserted, length, why: insertion_stop(why) }
    }

    /// Goes the way once more with all objects held where they are, then takes away what holds them: a grasp may be the first thing
    /// that carries an object.
    pub(super) fn hold_and_release(
        &mut self,
        case: &Case,
        at: &impl Fn(f64) -> Case,
        to_base: &Pose,
    ) -> Result<(), SolveError> {
        match self.release_after_steps(case, at, to_base, self.longest_step) {
            // Short steps let the robot slide farther along an object that is held, until friction pushes that with all it can.
            Err(error) if self.rubs && error.is_obstruction() => {
                self.release_after_steps(case, at, to_base, 1.0)
            }
            gone => gone,
        }
    }

    /// The same, with objects that are held in steps that are no longer than a part of the way.
    fn release_after_steps(
        &mut self,
        case: &Case,
        at: &impl Fn(f64) -> Case,
        to_base: &Pose,
        longest_step: f64,
    ) -> Result<(), SolveError> {
        self.odd = None;
        self.pairs.near.clear();
        self.model.reset();
        self.model.forget_notes();
        self.on_way.is_released = false;
        self.objects = Objects::new(case, None, self.model.force_scale(), self.length);
        self.objects.are_held = true;
        self.start((&at(0.0), [0.0; 2]), None, to_base)?;
        self.go_in_steps(case, at, |_| Acting::ALL, Steps::up_to(longest_step))?;
        self.objects.load(case, case, 1.0, 0.0);
        self.objects.balance(&self.pairs, self.model);
        self.objects.release();
        self.on_way.is_released = true;
        self.odd = None;
        // The commands stay: nothing that the holes remember is lost in a long step.
        let release = |way: f64| Acting { held: 1.0 - way, ..Acting::ALL };
        let gone = self.go_in_steps(case, |_| at(1.0), release, Steps::up_to(1.0));
        gone.map_err(|error| match error {
            SolveError::Obstructed { reached, touching, why } if error_of_object(&why) => {
                // As much as still held it.
                let why = self.objects.most_held().map_or(why, |(object, holding)| {
                    let [force, moment] =
                        [holding.force, holding.moment].map(|x| x.norm() * (1.0 - reached));
                    let object = self.scene.get(object.number).name.clone();
                    Obstruction::NotHeld { object, force, moment }
                });
                SolveError::Obstructed { reached, touching, why }
            }
            error => error,
        })
    }

    fn refuse_overlap(&self) -> Result<(), SolveError> {
        match self.pairs.deepest(self.model, &self.scene) {
            None => Ok(()),
            Some((obstacle, part, arc_length, depth)) => Err(SolveError::ObstacleInTheWay {
                obstacle: self.scene.get(obstacle).name.clone(),
                part,
                arc_length,
                depth,
                axis: self.scene.axis(obstacle),
            }),
        }
    }
}
