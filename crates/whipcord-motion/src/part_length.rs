//! How the lengths of the parts that a step is divided into depend on the motion, section "Gradients" of the page on motion.

use whipcord_numerics::{Pose, Twist};

use crate::adjoint::{Factors, StageAdjoint};
use crate::block::{add, sum};
use crate::by_shape::ByShape;
use crate::commands::Commands;
use crate::contact::{Contact, in_section};
use crate::cross_section::{Posed, by_displacements, displaced};
use crate::element::POINTS;
use crate::error::MotionError;
use crate::gradient::{Costate, Part};
use crate::part::{Impact, ImpactEnd};
use crate::pose;
use crate::simulation::Simulation;
use crate::state::State;
use crate::surroundings::Hit;
use crate::tangent::StageTangent;

/// Derivatives of a number by the shape and the velocities of a state.
struct ByState {
    shape: ByShape,
    velocities: Vec<Twist>,
}

impl ByState {
    fn of_shape(shape: ByShape, state: &State) -> Self {
        Self { shape, velocities: vec![Twist::default(); state.velocities.len()] }
    }

    fn times(&self, change: &Costate) -> f64 {
        self.shape.times(&change.strains, &change.base) + sum(&self.velocities, &change.velocities)
    }

    fn add_to(&self, costate: &mut Costate, factor: f64) {
        add(&mut costate.strains, &self.shape.strains, factor);
        add(&mut costate.velocities, &self.velocities, factor);
        costate.base = costate.base + self.shape.base * factor;
    }
}

impl Simulation {
    /// What is found by the shape of a state.
    pub(crate) fn by_shape<T>(&self, state: &State, find: impl FnOnce(&Posed<'_>) -> T) -> T {
        let mut poses = state.poses.clone();
        pose::nodes(&self.rod, state.base, &state.strains, &mut poses);
        find(&Posed { rod: &self.rod, strains: &state.strains, poses: &poses })
    }

    /// The place of a contact that was looked for, by the shape of the state in which that was done.
    fn place_changes(&self, state: &State, contact: &Contact) -> Option<ByState> {
        let beside = contact.search?.beside;
        let surroundings = self.solver.contacts.surroundings.as_ref()?;
        let place = (contact.obstacle, contact.station, beside);
        let shape = self.by_shape(state, |shape| surroundings.place_changes(shape, place));
        Some(ByState::of_shape(shape, state))
    }

    /// What the places of the contacts of a part change by, whose last round the solver is left in.
    pub(crate) fn places_forwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        length: f64,
        told: (&[f64], &[f64]),
        tangent: &mut StageTangent,
        change: &Costate,
        factors: &Factors,
    ) -> Result<(), MotionError> {
        self.repeat(commands, part, None)?;
        tangent.places.clear();
        let contacts = self.solver.contacts.list.clone();
        tangent.places.resize(contacts.len(), 0.0);
        for (k, contact) in contacts.iter().enumerate() {
            if contact.search.is_some_and(|of| of.round.is_none())
                && let Some(of) = self.place_changes(&part.before, contact)
            {
                tangent.places[k] = of.times(change);
            }
        }
        let Some(rounds) = rounds_before(&contacts) else { return Ok(()) };
        for round in 0..rounds {
            self.repeat(commands, part, Some(round))?;
            let mut to = change.clone();
            self.solved_forwards((commands, part), length, told, tangent, &mut to, factors)?;
            for (k, contact) in contacts.iter().enumerate() {
                if contact.search.is_some_and(|of| of.round == Some(round))
                    && let Some(of) = self.place_changes(&self.next, contact)
                {
                    tangent.places[k] = of.times(&to);
                }
            }
        }
        self.repeat(commands, part, None)
    }

    /// Adds the derivatives by the state before a part, and by the commands, of a number with those by the places of its contacts that were found last; returns that by its length.
    pub(crate) fn places_backwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        (cables, motors): (&mut [f64], &mut [f64]),
    ) -> Result<f64, MotionError> {
        let contacts = self.solver.contacts.list.clone();
        let mut places = core::mem::take(&mut adjoint.places);
        places.resize(contacts.len(), 0.0);
        let mut by_length = 0.0;
        for round in (0..rounds_before(&contacts).unwrap_or_default()).rev() {
            self.repeat(commands, part, Some(round))?;
            let mut of_round = self.costate();
            for (contact, by) in contacts.iter().zip(&places) {
                if contact.search.is_some_and(|of| of.round == Some(round))
                    && let Some(of) = self.place_changes(&self.next, contact)
                {
                    of.add_to(&mut of_round, *by);
                }
            }
            let told = (&mut *cables, &mut *motors);
            let of = (commands, part);
            by_length += self.solved_backwards(of, adjoint, &mut of_round, factors, told)?;
            costate.add(&of_round);
            for (place, by) in places.iter_mut().zip(&adjoint.places) {
                *place += by;
            }
        }
        for (contact, by) in contacts.iter().zip(&places) {
            if contact.search.is_some_and(|of| of.round.is_none())
                && let Some(of) = self.place_changes(&part.before, contact)
            {
                of.add_to(costate, *by);
            }
        }
        Ok(by_length)
    }

    /// What the length of a part changes by, for changes before it.
    pub(crate) fn length_forwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        told: (&[f64], &[f64]),
        tangent: &mut StageTangent,
        change: &Costate,
        factors: &Factors,
    ) -> Result<f64, MotionError> {
        // What is left of a step ends when the step does.
        let tried = if part.is_rest { -change.time } else { 0.0 };
        let Some(Impact { tried: length, end }) = &part.impact else { return Ok(tried) };
        match end {
            ImpactEnd::Fraction(fraction) => Ok(fraction * tried),
            ImpactEnd::Closing(contact) => Ok(self.closing(part, contact)?.times(change)),
            ImpactEnd::Hit(hit) => {
                let whole = self.try_whole(commands, part, *length)?;
                let [start, end] = self.hit_changes(part, hit)?;
                let mut to = change.clone();
                self.solved_forwards((commands, &whole), tried, told, tangent, &mut to, factors)?;
                Ok(tried * hit.part + length * (start.times(change) + end.times(&to)))
            }
        }
    }

    /// Adds the derivatives by what comes before a part, and by the commands, of a number with this derivative by the length of the part.
    pub(crate) fn length_backwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        by_length: f64,
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        told: (&mut [f64], &mut [f64]),
    ) -> Result<(), MotionError> {
        let mut by_tried = by_length;
        if let Some(Impact { tried, end }) = &part.impact {
            match end {
                ImpactEnd::Fraction(fraction) => by_tried *= fraction,
                ImpactEnd::Closing(contact) => {
                    self.closing(part, contact)?.add_to(costate, by_length);
                    by_tried = 0.0;
                }
                ImpactEnd::Hit(hit) => {
                    let whole = self.try_whole(commands, part, *tried)?;
                    let [start, end] = self.hit_changes(part, hit)?;
                    let mut of_whole = self.costate();
                    end.add_to(&mut of_whole, by_length * tried);
                    start.add_to(costate, by_length * tried);
                    by_tried *= hit.part;
                    let of = (commands, &whole);
                    by_tried += self.solved_backwards(of, adjoint, &mut of_whole, factors, told)?;
                    costate.add(&of_whole);
                }
            }
        }
        if part.is_rest {
            costate.time -= by_tried;
        }
        Ok(())
    }

    /// Takes the part in which an obstacle was found to be hit once more, freely and as long as it was tried.
    fn try_whole(
        &mut self,
        commands: &Commands,
        part: &Part,
        tried: f64,
    ) -> Result<Part, MotionError> {
        let whole = Part { length: tried, impact: None, ..part.clone() };
        self.repeat(commands, &whole, None)?;
        Ok(whole)
    }

    /// The part of the way up to a hit by the states before and behind the part that was tried last.
    fn hit_changes(&self, part: &Part, hit: &Hit) -> Result<[ByState; 2], MotionError> {
        let grazes = MotionError::NotSmooth { time: part.before.time + part.length };
        let Some(surroundings) = &self.solver.contacts.surroundings else { return Err(grazes) };
        let states = [&part.before, &self.next];
        let poses = states.map(|state| self.by_shape(state, |shape| shape.at(hit.station)));
        let changes = surroundings.hit_changes(hit, poses, self.rod.length).ok_or(grazes)?;
        Ok([0, 1].map(|i| {
            let of = |shape: &Posed<'_>| ByShape::of_section(shape, hit.station, changes[i]);
            ByState::of_shape(self.by_shape(states[i], of), states[i])
        }))
    }

    /// The time in which a contact closes by the state before a part.
    fn closing(&self, part: &Part, contact: &Contact) -> Result<ByState, MotionError> {
        let (state, station) = (&part.before, contact.station);
        let grazes = MotionError::NotSmooth { time: state.time + part.length };
        let time = |start: Pose| self.closes_in(state, contact, station, start);
        if time(contact.start).is_none() {
            return Err(grazes);
        }
        let by = by_displacements(self.rod.length, |axis, by| {
            time(displaced(&contact.start, axis, by)).unwrap_or(f64::NAN)
        });
        if !(by.linear.max_abs() + by.angular.max_abs()).is_finite() {
            return Err(grazes);
        }
        let shape = self.by_shape(state, |shape| ByShape::of_section(shape, station, by));
        let mut of = ByState::of_shape(shape, state);
        // The gap through its rate, which is linear in the velocities.
        let mut at_start = *contact;
        if let Some(surroundings) = &self.solver.contacts.surroundings {
            at_start.look(&surroundings.obstacles[contact.obstacle], &contact.start);
        }
        let nearest = at_start.nearest;
        let rate = -at_start.start_rate(&state.velocities);
        let push = in_section(contact.start.rotation, nearest.normal, nearest.arm);
        let nodes = &mut of.velocities[POINTS * station.element..];
        for (velocity, shape) in nodes.iter_mut().zip(contact.shapes) {
            *velocity = push * (shape * nearest.gap / (rate * rate));
        }
        Ok(of)
    }
}

/// How many rounds of a part were repeated with places that were looked for behind them.
fn rounds_before(contacts: &[Contact]) -> Option<usize> {
    contacts.iter().filter_map(|contact| contact.search?.round).max().map(|last| last + 1)
}
