//! The equilibrium at one place of the way: Newton's method, in which contacts come and go.

use whipcord_numerics::Vec3;

use super::friction::Grip;
use super::model::Compliant;
use super::object::Object;
use super::object_pair::ObjectPair;
use super::pair::{OVERLAP, Pair};
use super::pairs::BackboneContacts;
use super::path::{MET, PathTracker, Stop};
use super::step::{NoStep, Reach, Stepped, turned};
use super::step_length::{STRIDE, StepLength};
use crate::case::Case;
use crate::error::{Obstruction, SolveError};
use crate::shape::Wrench;
use crate::solution::Part;

/// On the way to the answer, where disks without friction are all that touches, or on the way into pipes anything without friction, of a robot
/// whose cables do not rub: nothing remembers such a place.
const MET_ON_WAY: f64 = 1e-5;
/// Met as nearly as rounding allows where the robot is about to buckle under the forces alone.
const NEARLY_MET: f64 = 1e-7;
/// Contacts of the backbone that are nearer than this to their places along it, as a part of the length, are there.
const NEARLY_THERE: f64 = 1e-7;
/// Steps that bring no progress before the iteration ends.
const PATIENCE: usize = 8;
/// Steps of Newton's method at one place of the way; each may find another contact.
const STEPS: usize = 40;
/// The columns of so many cross-sections, or the slips of so many places near obstacles with friction, double the cost of an iteration.
const COSTLY: f64 = 10.0;
/// The dense equations of so many cross-sections cost as much as an iteration without contacts.
const DENSE: f64 = 22.0;
/// The same of so many contacts, of which each has one unknown.
const DENSE_CONTACTS: f64 = 90.0;

impl<M: Compliant> PathTracker<'_, M> {
    /// The equilibrium under a case with the obstacles. `Some(part)` where the robot would move too far at
    /// once: a shorter step, by this part, is in order.
    pub(super) fn touch(&mut self, case: &Case, before: &[Vec3]) -> Result<Option<f64>, Stop> {
        let (mut least, mut since) = (f64::INFINITY, 0);
        let mut looked = false;
        let mut has_stepped = false;
        self.pairs.begin_search();
        for _ in 0..STEPS {
            self.pairs.pushes(&mut self.pushes);
            self.dampers.pushes(&mut self.pushes);
            self.pushes.extend(self.nudge);
            self.model.consider(case, &self.pushes).map_err(Stop::Model)?;
            self.charge()?;
            let step = StepLength { scene: &self.scene, before, length: self.length };
            if let Some(part) = step.too_far(|k| self.model.centre(k)) {
                return Ok(Some(part));
            }
            self.pairs.refresh(self.model, &self.scene);
            if self.objects.count() > 0 {
                self.objects.refresh(&self.scene, self.length);
                self.objects.discover(&self.scene, self.length);
                if let Some(object) = self.objects.lost(self.length) {
                    return Err(Stop::Lost(self.not_held(object)));
                }
            }
            if self.pairs.discover(self.model, &self.scene, false) && !looked {
                // The model has not been asked there yet.
                looked = true;
                (least, since) = (f64::INFINITY, 0);
                continue;
            }
            self.objects.balance(&self.pairs, self.model);
            self.residual = self.error();
            if self.residual <= MET
                && self.pairs.backbone == BackboneContacts::Anywhere
                && self.pairs.discover(self.model, &self.scene, true)
                && !looked
            {
                looked = true;
                (least, since) = (f64::INFINITY, 0);
                continue;
            }
            looked = false;
            // A known answer that is met at once still has to be judged.
            let met = if self.is_on_way && self.forgets_way() { MET_ON_WAY } else { MET };
            let is_judged = match self.is_without_friction() {
                true => has_stepped && self.scratch.is_of(&self.pairs),
                false => self.odd.is_some(),
            };
            if self.residual <= met && (is_judged || !self.is_touching()) {
                return self.arrived();
            }
            if self.residual < 0.5 * least {
                // What the change of the case leaves to do, little where that is short, is no mark for what the steps leave.
                least = if has_stepped { self.residual } else { f64::INFINITY };
                since = 0;
            } else {
                since += 1;
            }
            if since > PATIENCE {
                if self.residual < NEARLY_MET && self.is_clear() {
                    return self.arrived();
                }
                if self.searches && self.is_alone() {
                    self.searches = self.model.search_alone(case);
                    if self.searches {
                        (least, since) = (f64::INFINITY, 0);
                        continue;
                    }
                }
                break;
            }
            has_stepped = true;
            match self.step(Vec3::ZERO) {
                Ok(stepped) => {
                    self.odd = Some(stepped.odd);
                    // An object that is on its way has no progress to show.
                    if stepped.part < 1.0 && self.objects.count() > 0 {
                        since = 0;
                    }
                }
                Err(NoStep::Contacts) => return Err(Stop::NotConverged(self.residual)),
                Err(NoStep::Model(error)) => return Err(Stop::Model(error)),
            }
        }
        Err(Stop::NotConverged(self.residual))
    }

    /// One step of Newton's method on the conditions of contact, as they are where the robot is moved by so much.
    fn step(&mut self, ahead: Vec3) -> Result<Stepped, NoStep> {
        let Self { pairs, dampers, objects, model, scene, scratch, pushes, length, .. } = self;
        pairs.pushes(pushes);
        dampers.pushes(pushes);
        scratch.ask(pushes, *model).map_err(NoStep::Model)?;
        let reach = Reach { length: *length, cap: STRIDE * *length, ahead };
        scratch.step((pairs, dampers, objects), *model, scene, reach)
    }

    /// Bends the robot, in equilibrium, so that its contacts without friction hold where its base is moved forward by so much: where it is moved as
    /// it is, a bent robot overlaps a narrow pipe by more than its clearance, and its rims are nearest to another side.
    /// With `here` a robot that went back looks again where it stands, under the case there.
    pub(super) fn anticipate(&mut self, forward: f64, here: Option<&Case>) -> Result<(), Stop> {
        if self.is_touching() && self.is_without_friction() {
            self.charge()?;
            if let Some(here) = here {
                self.pairs.pushes(&mut self.pushes);
                if self.model.consider(here, &self.pushes).is_err() {
                    return Ok(());
                }
            }
            // Newton's method begins where it is if nothing comes of it.
            let _ = self.step(Vec3::Z * forward);
        }
        Ok(())
    }

    /// Counts an iteration with the contacts that there are, and ends the solve where it has spent its budget or its
    /// contacts are too many.
    fn charge(&mut self) -> Result<(), Stop> {
        if self.model.meter().is_cancelled() {
            return Err(Stop::Cancelled);
        }
        let (contacts, most) = (self.pairs.near.len(), self.pairs.most());
        if contacts > most {
            return Err(Stop::Spent(Obstruction::TooManyContacts { contacts, most }));
        }
        // Dampers have columns as contacts have. What the model does depends on the cross-sections, however many contacts each has.
        let pushes = (contacts + self.dampers.all.len()) as f64;
        let sections = self.sections() as f64;
        let rubbing = self.pairs.near.iter().filter(|pair| pair.grip.is_some()).count() as f64;
        let columns = 1.0 + (sections + rubbing) / COSTLY;
        let dense = (sections / DENSE).powi(3) + (pushes / DENSE_CONTACTS).powi(3);
        let effort = self.model.effort() * columns + dense;
        if self.spent + effort > self.budget || self.model.meter().is_spent() {
            let Self { iterations, residual, .. } = *self;
            return Err(Stop::Spent(Obstruction::BudgetSpent { iterations, contacts, residual }));
        }
        self.iterations += 1;
        self.model.meter().iterate();
        self.spend(effort);
        Ok(())
    }

    /// The cross-sections that have contacts or dampers.
    fn sections(&self) -> usize {
        let of_pairs = self.pairs.near.iter().map(|pair| pair.member.arc_length);
        let mut places: Vec<f64> =
            of_pairs.chain(self.dampers.all.iter().map(|damper| damper.arc_length)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        places.len()
    }

    /// Whether the equilibrium is stable: by eq. (20) where that is defined, else by eq. (6).
    fn arrived(&mut self) -> Result<Option<f64>, Stop> {
        self.unstable = None;
        if self.is_going_in && self.is_on_way {
            return Ok(None);
        }
        if self.rubs && self.objects.are_held_in_part() && self.do_all_stick() {
            // Steps that their memory keeps short lead through poses in which a part of a force that is taken away holds an object: none
            // of these need be stable, the last one is judged.
            return Ok(None);
        }
        let is_held = self.is_touching() || !self.dampers.all.is_empty();
        if is_held {
            // It is linearised once more.
            self.spend(self.model.effort());
            self.unstable = self.unstable_directions();
            let slips = match self.unstable {
                Some(count) => count > 0,
                None => self.odd == Some(self.model.stands_alone()),
            };
            if slips {
                return Err(Stop::Slips);
            }
        } else if self.model.unstable_alone().is_some_and(|count| count > 0) {
            // A step beyond its critical load leads to an equilibrium that it would leave.
            return Err(Stop::Slips);
        }
        Ok(None)
    }

    /// The number of unstable directions that the contacts admit.
    fn unstable_directions(&mut self) -> Option<usize> {
        if !self.is_without_friction() || !self.is_touching() {
            return None;
        }
        let alone = self.model.unstable_alone()?;
        self.scratch.unstable_directions(alone, &self.pairs, self.length)
    }

    /// Whether nothing holds the robot but contacts without friction with obstacles that stay where they are.
    pub(super) fn is_without_friction(&self) -> bool {
        self.objects.count() == 0
            && self.dampers.all.is_empty()
            && self.nudge.is_none()
            && self.pairs.near.iter().all(|pair| pair.grip.is_none())
    }

    /// Whether no known contact is open or overlaps by more than is claimed of an answer.
    fn is_clear(&self) -> bool {
        let clear = |pair: &Pair| {
            let gap = pair.nearest.gap / self.length;
            gap >= -OVERLAP && (pair.force <= 0.0 || gap <= OVERLAP)
        };
        self.pairs.near.iter().all(clear)
    }

    /// Whether no contact that pushes slides.
    fn do_all_stick(&self) -> bool {
        let of_robot = self.pairs.near.iter().map(|pair| (pair.force, pair.grip));
        let of_objects = self.objects.near.iter().map(|pair| (pair.force, pair.grip));
        let mut pushing = of_robot.chain(of_objects).filter(|(force, _)| *force > 0.0);
        pushing.all(|(_, grip)| grip.is_some_and(|grip| grip.sticks))
    }

    /// Whether nothing remembers a place of the way as exactly as the answer is asked for.
    fn forgets_way(&self) -> bool {
        let is_forgotten = self.are_only_disks() || self.is_going_in && self.is_without_friction();
        (!self.rubs || self.is_lenient) && is_forgotten
    }

    /// Whether nothing is near obstacles but disks without friction.
    fn are_only_disks(&self) -> bool {
        let is_plain = |pair: &Pair| {
            pair.grip.is_none() && !pair.keeps_place && pair.member.part != Part::Backbone
        };
        self.objects.count() == 0
            && self.dampers.all.is_empty()
            && self.pairs.near.iter().all(is_plain)
    }

    pub(super) fn is_touching(&self) -> bool {
        self.pairs.near.iter().any(|pair| pair.force > 0.0)
            || self.objects.count() > 0 && self.objects.near.iter().any(|pair| pair.force > 0.0)
    }

    /// Whether nothing acts on the robot but its cables and loads.
    fn is_alone(&self) -> bool {
        !self.is_touching()
            && self.objects.count() == 0
            && self.dampers.all.is_empty()
            && self.nudge.is_none()
    }

    /// What is left of the balance of an object that nothing holds.
    fn not_held(&self, object: &Object) -> Obstruction {
        let Wrench { force, moment } = object.imbalance;
        let object = self.scene.get(object.number).name.clone();
        Obstruction::NotHeld { object, force: force.norm(), moment: moment.norm() }
    }

    /// The equilibrium without pushes.
    pub(super) fn rest(&mut self, case: &Case) -> Result<(), SolveError> {
        for _ in 0..STEPS {
            self.model.consider(case, &[])?;
            if self.model.residual() <= MET || self.model.meter().is_cancelled() {
                break;
            }
            self.model.advance(&[], 1.0)?;
        }
        Ok(())
    }

    /// What is left of the conditions of contact, relative to length and force scale.
    fn error(&self) -> f64 {
        let scale = self.model.force_scale();
        let dampers = self.dampers.residual(self.model, scale, self.length);
        let converged = self.model.residual().max(dampers);
        let contact = |gap: f64, force: f64, grip: Option<Grip>| {
            let gap = gap / self.length;
            let overlaps = if gap < -OVERLAP { -gap } else { 0.0 };
            let open = if force > 0.0 { gap.abs() } else { overlaps };
            let lack =
                grip.map_or(0.0, |grip| grip.complementarity_residual(force, scale / self.length));
            (open, lack)
        };
        let of = |pair: &Pair| {
            let (open, lack) = contact(pair.nearest.gap, pair.force, pair.grip);
            let left = pair.slide.map_or(0.0, |slide| slide.left().abs() / self.length);
            let open = if left > NEARLY_THERE && pair.force > 0.0 { open.max(left) } else { open };
            let turned = turned(pair);
            let [force, moment] =
                [0, 3].map(|i| Vec3::new(turned[i], turned[i + 1], turned[i + 2]).norm());
            open.max((force + moment / self.length + lack) / (scale + pair.force))
        };
        let of_object = |pair: &ObjectPair| {
            let (open, lack) = contact(pair.nearest.gap, pair.force, pair.grip);
            open.max(lack / (scale + pair.force))
        };
        let of_robot = self.pairs.near.iter().map(of).fold(converged, f64::max);
        if self.objects.count() == 0 {
            return of_robot;
        }
        let lack = self.objects.least_balanced().map_or(0.0, |(_, lack)| lack);
        self.objects.near.iter().map(of_object).fold(of_robot.max(lack), f64::max)
    }
}
