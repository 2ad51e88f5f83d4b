//! The way to the answer: actuation and loads grow in steps, and contacts come and go.

use whipcord_numerics::Vec3;

use super::dampers::Dampers;
use super::division::FROM_REST;
use super::drawn_out::DrawnOut;
use super::holding::Holding;
use super::model::{Compliant, Push};
use super::noted::{Noting, OnWay};
use super::object::Objects;
use super::pairs::{BackboneContacts, Pairs};
use super::scene::Scene;
use super::step::Scratch;
use super::step_length::rounded;

use crate::case::Case;
use crate::error::{Obstruction, SolveError};
use crate::robot::{Cable, Robot};
use crate::shape::Wrench;
use crate::solution::Solution;

/// Conditions of contact that are met to this, relative to length and force scale, are met.
pub(super) const MET: f64 = 1e-9;
/// A nudge, relative to the force scale.
pub(super) const NUDGE: f64 = 2e-2;
/// The longest step on the way of a robot that touches, where eq. (20) counts all directions that turn unstable in one.
const COUNTED_STEP: f64 = 0.5;
/// The same where eq. (6) misses two of them.
const LONGEST_STEP: f64 = 0.2;
/// The least step on the way.
const LEAST_STEP: f64 = 1e-3;
/// How far ahead on the way a robot comes to rest that has lost its equilibrium, in least steps.
const AHEAD: f64 = 2.0;
/// So often it may do so, and so often at a place where nothing comes of it.
pub(super) const JUMPS: usize = 20;
const JUMPS_IN_VAIN: usize = 3;
/// A cross-section that moves farther than this part of the length while it does so has jumped.
const JUMP: f64 = 0.02;

/// Integration steps of an iteration of a rod of 100 steps without contacts.
const INTEGRATION_STEPS: f64 = 100.0;

/// Why the robot does not get on.
pub(super) enum Stop {
    /// A step that was too long.
    Model(SolveError),
    NotConverged(f64),
    Slips,
    /// The solve may spend no more, in iterations or in contacts: no shorter step helps.
    Spent(Obstruction),
    /// Nothing holds a movable object: no shorter step helps.
    Lost(Obstruction),
    /// The solve was ended from outside.
    Cancelled,
}

/// What acts at a place of the way besides the case.
#[derive(Clone, Copy, Debug)]
pub(super) struct Acting {
    /// How far the base is drawn back, in m.
    pub drawn_back: f64,
    /// The part that is left of the way of obstacles that are drawn out.
    pub left: f64,
    /// The part of the loads of the objects.
    pub loads: f64,
    /// The part that is left of what held the objects.
    pub held: f64,
    /// How far the commands went to those of the step, and the part of the loads of the robot.
    pub of_case: [f64; 2],
}

impl Acting {
    pub const ALL: Self =
        Self { drawn_back: 0.0, left: 0.0, loads: 1.0, held: 0.0, of_case: [1.0; 2] };
}

pub(super) struct PathTracker<'a, M> {
    pub(super) model: &'a mut M,
    pub(super) scene: Scene,
    pub(super) length: f64,
    pub(super) pairs: Pairs,
    pub(super) dampers: Dampers,
    pub(super) objects: Objects,
    /// The obstacles that come from elsewhere.
    pub(super) drawn_out: Option<DrawnOut>,
    pub(super) pushes: Vec<Push>,
    pub(super) scratch: Scratch,
    pub(super) iterations: usize,
    pub(super) spent: f64,
    /// Of which [`Compliant::budget`] says how much there is at first.
    pub(super) budget: f64,
    pub(super) residual: f64,
    /// Whether the contacts change an odd number of directions from stable to unstable or back; `None` until a
    /// step has told.
    pub(super) odd: Option<bool>,
    /// How many directions the contacts leave unstable, eq. (20), where it came to rest last; `None` where that is not known, or
    /// nothing touches.
    pub(super) unstable: Option<usize>,
    /// A small force that decides which way a robot slips off.
    pub(super) nudge: Option<Push>,
    /// Whether the equilibrium that is looked for is none but a place on the way to the answer.
    pub(super) is_on_way: bool,
    /// Whether it is on the way into pipes: of these equilibria only the last one is judged.
    pub(super) is_going_in: bool,
    /// Whether the model searches from rest for an equilibrium without contacts that its steps do not lead to: until it has searched in vain.
    pub(super) searches: bool,
    /// How far on the way there is an equilibrium.
    pub(super) reached: f64,
    /// Where on the way there was first no equilibrium near.
    pub(super) lost_at: Option<f64>,
    /// Where on the way the robot slipped off.
    pub(super) slipped_at: Option<f64>,
    /// Whether the way begins at a known answer that the model, under other loads, does not quite stand at: what its contacts
    /// have slid counts from there.
    pub(super) is_off_answer: bool,
    /// Whether its cables rub in their holes, which remember every place of the way.
    pub(super) rubs: bool,
    /// Whether nothing remembers the way into pipes: no cable rubs, no pipe, and no backbone that is bent.
    pub(super) forgets_way_in: bool,
    /// The longest step of a way that they remember.
    pub(super) longest_step: f64,
    /// Whether a place of the way is taken less nearly than they remember: cables that stick may hold the robot so that nothing tells the force of a
    /// contact.
    pub(super) is_lenient: bool,
    /// Where it is on the way, for what the model notes.
    pub(super) on_way: OnWay,
}

/// What is known of the contacts, besides where the model is kept.
pub(super) struct Kept {
    pairs: Pairs,
    objects: Objects,
    odd: Option<bool>,
}

/// Jumps on the way to another equilibrium.
#[derive(Clone, Copy, Debug)]
struct Jumps {
    left: usize,
    /// How far ahead on the way the first one is.
    first: f64,
    /// How far ahead on the way the last one was, and where it ended.
    ahead: f64,
    at: f64,
}

impl Jumps {
    /// How far ahead on the way the robot is to come to rest that is lost here; `None` after too many.
    fn next(&mut self, way: f64) -> Option<f64> {
        self.left = self.left.checked_sub(1)?;
        let again = self.ahead > 0.0 && way < self.at + 2.0 * self.ahead;
        self.ahead = if again { 3.0 * self.ahead } else { self.first };
        self.at = way + self.ahead;
        Some(self.ahead)
    }
}

/// How long the steps on a way are, as parts of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub first: f64,
    pub longest: f64,
    /// The same while the robot touches.
    pub longest_touching: f64,
    /// What a step grows by after one that had to be shortened; after another it is doubled.
    pub growth_after_short: f64,
    /// One that would have to be shorter leads nowhere.
    pub least: f64,
    /// So often the robot may jump.
    pub jumps: usize,
}

impl Steps {
    /// No longer than this.
    pub const fn up_to(longest: f64) -> Self {
        Self {
            first: longest,
            longest,
            longest_touching: longest,
            growth_after_short: 2.0,
            least: LEAST_STEP,
            jumps: JUMPS,
        }
    }
}

/// Whether any cable rubs in its holes.
pub(super) fn has_friction(robot: &Robot) -> bool {
    robot.cables().iter().any(Cable::has_friction)
}

impl<'a, M: Compliant> PathTracker<'a, M> {
    /// Before a step of actuation: nothing is known of its contacts.
    pub(super) fn new(
        model: &'a mut M,
        robot: &Robot,
        (step, case): (usize, &Case),
        warm_start: Option<&Solution>,
    ) -> Self {
        let pairs = Pairs::new(robot, model.watched());
        let (force_scale, length) = (model.force_scale(), robot.backbone().length);
        let (budget, rubs) = (model.budget(), has_friction(robot));
        Self {
            model,
            scene: Scene::new(case),
            length,
            pairs,
            dampers: Dampers::default(),
            objects: Objects::new(case, warm_start, force_scale, length),
            drawn_out: None,
            pushes: Vec::new(),
            scratch: Scratch::default(),
            iterations: 0,
            spent: 0.0,
            budget,
            residual: 0.0,
            odd: None,
            unstable: None,
            nudge: None,
            is_on_way: false,
            is_going_in: false,
            searches: true,
            reached: 0.0,
            lost_at: None,
            slipped_at: None,
            is_off_answer: false,
            rubs,
            forgets_way_in: !rubs && !robot.has_bending_friction() && !case.has_rubbing_obstacles(),
            longest_step: if rubs { FROM_REST } else { 1.0 },
            is_lenient: false,
            on_way: OnWay { step, ..OnWay::default() },
        }
    }
}

impl<M: Noting> PathTracker<'_, M> {
    /// Goes the way from 0 to 1 to a case, with what acts at each place of it.
    pub(super) fn go(
        &mut self,
        asked: &Case,
        at: impl Fn(f64) -> Case,
        acting: impl Fn(f64) -> Acting,
    ) -> Result<(), SolveError> {
        self.go_in_steps(asked, at, acting, Steps::up_to(self.longest_step))
    }

    /// The same in such steps.
    pub(super) fn go_in_steps(
        &mut self,
        asked: &Case,
        at: impl Fn(f64) -> Case,
        acting: impl Fn(f64) -> Acting,
        steps: Steps,
    ) -> Result<(), SolveError> {
        let (mut way, mut step, mut was_short) = (0.0, steps.first, false);
        self.reached = 0.0;
        let first = AHEAD * steps.least;
        let mut jumps = Jumps { left: steps.jumps, first, ahead: 0.0, at: 0.0 };
        let watched = self.model.watched().len();
        let mut before: Vec<Vec3> = Vec::new();
        loop {
            let kept = self.kept();
            let next = if way + step > 1.0 - 0.5 * steps.least { 1.0 } else { way + step };
            // Where they were, as the base sees it from where it will be.
            before.clear();
            before.extend((0..watched).map(|k| self.model.centre(k)));
            self.scene.begin_step();
            let acts = acting(next);
            let forward = self.scene.drawn_back() - acts.drawn_back;
            if forward != 0.0
                && let Err(stop) = self.anticipate(forward, was_short.then(|| at(way)).as_ref())
            {
                return Err(self.obstructed(way, Some(stop)));
            }
            self.arrange(acts);
            let case = at(next);
            self.objects.load(&case, asked, acts.loads, acts.held);
            self.is_on_way = next < 1.0;
            self.pairs.backbone = match self.is_going_in && self.is_on_way {
                true => BackboneContacts::AtWatchedPlaces,
                false => BackboneContacts::Anywhere,
            };
            if way > 0.0 || !self.is_off_answer {
                self.pairs.begin_step(self.model, &self.scene);
                self.objects.begin_step(&self.scene);
            }
            before.iter_mut().for_each(|centre| *centre = self.scene.carried_point(*centre));
            let touched = self.touch(&case, &before);
            self.is_on_way = false;
            let stop = match touched {
                Ok(None) => {
                    self.is_lenient = false;
                    way = next;
                    self.reached = way;
                    let [commands, loads] = acts.of_case;
                    let passed = [acts.drawn_back, way];
                    self.on_way = OnWay { commands, loads, way: passed, ..self.on_way };
                    self.note();
                    if way == 1.0 {
                        return Ok(());
                    }
                    let growth = if was_short { steps.growth_after_short } else { 2.0 };
                    was_short = false;
                    step = (growth * step).min(steps.longest);
                    if self.is_touching() {
                        let is_counted = self.unstable.is_some();
                        let longest = if is_counted { COUNTED_STEP } else { LONGEST_STEP };
                        step = step.min(longest).min(steps.longest_touching);
                    }
                    // What would be left for a short last step is taken along.
                    if way + 1.5 * step >= 1.0 {
                        step = 1.0 - way;
                    }
                    continue;
                }
                Ok(Some(part)) => {
                    step = (next - way) * part;
                    if asked.has_rubbing_obstacles() && !self.rubs {
                        let rounded = rounded(way, step);
                        step = if rounded >= steps.least { rounded } else { step };
                    }
                    None
                }
                Err(stop @ (Stop::Spent(_) | Stop::Lost(_) | Stop::Cancelled)) => {
                    return Err(self.obstructed(way, Some(stop)));
                }
                Err(stop) => {
                    let is_open = matches!(stop, Stop::NotConverged(_));
                    self.is_lenient = is_open && self.rubs && next < 1.0 && !self.is_lenient;
                    step = if self.is_lenient { next - way } else { 0.4 * (next - way) };
                    Some(stop)
                }
            };
            was_short = true;
            self.restore(kept);
            self.arrange(acting(way));
            if step >= steps.least {
                continue;
            }
            if self.objects.count() > 0 {
                return Err(self.obstructed(way, stop));
            }
            // Beyond here it has no equilibrium near: it jumps to another, which may stand farther on only.
            self.lost_at.get_or_insert(way);
            let from = self.centres();
            let mut in_vain = 0;
            way = loop {
                let Some(ahead) = jumps.next(way) else { return Err(self.obstructed(way, stop)) };
                let next = (way + ahead).min(1.0);
                self.scene.begin_step();
                self.arrange(acting(next));
                // Where it comes to rest is judged as an answer is.
                self.pairs.backbone = BackboneContacts::Anywhere;
                match self.relax(&at(next)) {
                    Ok(()) => break next,
                    Err(why @ (Stop::Spent(_) | Stop::Lost(_) | Stop::Cancelled)) => {
                        return Err(self.obstructed(way, Some(why)));
                    }
                    Err(_) if next == 1.0 || in_vain == JUMPS_IN_VAIN => {
                        return Err(self.obstructed(way, stop));
                    }
                    Err(_) => in_vain += 1,
                }
            };
            self.lose_notes();
            if self.farthest_from(&from) > JUMP * self.length {
                self.slipped_at.get_or_insert(self.reached);
            }
            self.reached = way;
            if way == 1.0 {
                return Ok(());
            }
            step = 10.0 * steps.least;
        }
    }

    /// The contacts where it is, linearised.
    pub(super) fn holding(&self, remembers: bool) -> Holding {
        let at = (&*self.model, &self.scene);
        Holding::new(&self.pairs, &self.objects, at, self.length, remembers)
    }

    /// It is where the way that was noted does not lead to.
    pub(super) fn lose_notes(&mut self) {
        self.model.lose_notes();
        self.note();
    }

    /// Has the model take note of where it is.
    pub(super) fn note(&mut self) {
        if self.model.takes_notes() {
            let holding = self.holding(true);
            self.model.note(holding, self.on_way);
        }
    }

    /// Puts base and obstacles to where they are at a place of the way.
    pub(super) fn arrange(&mut self, Acting { drawn_back, left, .. }: Acting) {
        self.scene.draw_back(drawn_back);
        if let Some(drawn_out) = &self.drawn_out {
            drawn_out.place(left, &mut self.scene);
        }
    }
}

impl<M: Compliant> PathTracker<'_, M> {
    /// Where it is, to go back to.
    pub(super) fn kept(&mut self) -> Kept {
        self.model.keep();
        Kept { pairs: self.pairs.clone(), objects: self.objects.clone(), odd: self.odd }
    }

    /// Counts what takes as long as so many iterations of a rod of 100 steps without contacts.
    pub(super) fn spend(&mut self, effort: f64) {
        self.spent += effort;
        self.model.meter().integrate((INTEGRATION_STEPS * effort).ceil() as usize);
    }

    /// From here on it may spend what it may at the end of the way, and on another one, whatever is spent.
    pub(super) fn renew_budget(&mut self) {
        self.budget = self.spent + self.model.renewed_budget();
    }

    pub(super) fn restore(&mut self, kept: Kept) {
        self.model.go_back();
        (self.pairs, self.odd) = (kept.pairs, kept.odd);
        self.objects = kept.objects;
        self.objects.place(&mut self.scene);
    }

    /// A force on the tip in no direction that a robot is built along.
    pub(super) fn sideways(&self) -> Push {
        let force = Vec3::new(0.36, 0.80, 0.48) * (NUDGE * self.model.force_scale());
        Push { arc_length: self.length, wrench: Wrench { force, moment: Vec3::ZERO } }
    }

    pub(super) fn obstructed(&self, way: f64, stop: Option<Stop>) -> SolveError {
        let touching = self.pairs.near.iter().filter(|pair| pair.force > 0.0);
        let mut names: Vec<String> =
            touching.map(|pair| self.scene.get(pair.obstacle).name.clone()).collect();
        names.dedup();
        let why = match stop {
            Some(Stop::Model(error)) if names.is_empty() => return error.on_way(way),
            Some(Stop::Model(error)) => Obstruction::Model(Box::new(error.on_way(way))),
            Some(Stop::NotConverged(residual)) => Obstruction::NotConverged { residual },
            Some(Stop::Slips) => Obstruction::Slips,
            Some(Stop::Spent(Obstruction::BudgetSpent { .. })) if self.model.meter().is_spent() => {
                return self.model.meter().spent(Some(way));
            }
            Some(Stop::Spent(why) | Stop::Lost(why)) => why,
            Some(Stop::Cancelled) => return SolveError::Cancelled { last_load: Some(way) },
            None => Obstruction::Leaps,
        };
        let is_lost = matches!(
            why,
            Obstruction::NotConverged { .. } | Obstruction::Slips | Obstruction::Leaps
        );
        let why = if is_lost { self.without_clearance().unwrap_or(why) } else { why };
        SolveError::Obstructed { reached: way, touching: names, why }
    }
}
