//! How the lengths of the parts that a step is divided into depend on the motion, section "Gradients" of the page on motion.

use whipcord_numerics::{Pose, Twist};

use crate::adjoint::{Factors, StageAdjoint};
use crate::block::{add, dot, sum};
use crate::commands::Commands;
use crate::contact::{Contact, in_section};
use crate::contact_rows::gradient;
use crate::element::POINTS;
use crate::error::MotionError;
use crate::gradient::{Costate, Part};
use crate::impact::{Impact, ImpactEnd};
use crate::pose;
use crate::simulation::Simulation;
use crate::state::State;
use crate::surroundings::{Hit, Posed, Station, by_displacements, displaced};
use crate::tangent::StageTangent;

/// Derivatives of a number by the shape and the velocities of a state.
struct ByState {
    strains: Vec<Twist>,
    /// By displacements of the base along and about its own axes.
    base: Twist,
    velocities: Vec<Twist>,
}

impl ByState {
    /// By displacements of a section along and about the axes that the poses are given in.
    fn of_section(simulation: &Simulation, state: &State, station: Station, by: Twist) -> Self {
        let poses = simulation.poses_at(state);
        let shape = Posed { rod: &simulation.rod, strains: &state.strains, poses: &poses };
        let turn = state.base.rotation.conjugate();
        let arm = shape.at(station).position - state.base.position;
        let base = Twist {
            linear: turn.rotate(by.linear),
            angular: turn.rotate(by.angular + arm.cross(by.linear)),
        };
        let velocities = vec![Twist::default(); state.velocities.len()];
        Self { strains: gradient(&shape, station, by), base, velocities }
    }

    fn times(&self, change: &Costate) -> f64 {
        sum(&self.strains, &change.strains)
            + dot(&self.base, &change.base)
            + sum(&self.velocities, &change.velocities)
    }

    fn add_to(&self, costate: &mut Costate, factor: f64) {
        add(&mut costate.strains, &self.strains, factor);
        add(&mut costate.velocities, &self.velocities, factor);
        costate.base = costate.base + self.base * factor;
    }
}

impl Simulation {
    fn poses_at(&self, state: &State) -> Vec<Pose> {
        let mut poses = state.poses.clone();
        pose::nodes(&self.rod, state.base, &state.strains, &mut poses);
        poses
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
            ImpactEnd::Closing(contact) => Ok(self.closing(part, contact).times(change)),
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
                    self.closing(part, contact).add_to(costate, by_length);
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
        self.repeat(commands, &whole)?;
        Ok(whole)
    }

    /// The part of the way up to a hit by the states before and behind the part that was tried last.
    fn hit_changes(&self, part: &Part, hit: &Hit) -> Result<[ByState; 2], MotionError> {
        let grazes = MotionError::NotSmooth { time: part.before.time + part.length };
        let Some(surroundings) = &self.solver.contacts.surroundings else { return Err(grazes) };
        let states = [&part.before, &self.next];
        let poses = states.map(|state| {
            let poses = self.poses_at(state);
            Posed { rod: &self.rod, strains: &state.strains, poses: &poses }.at(hit.station)
        });
        let changes = surroundings.hit_changes(hit, poses, self.rod.length).ok_or(grazes)?;
        Ok([0, 1].map(|i| ByState::of_section(self, states[i], hit.station, changes[i])))
    }

    /// The time in which a contact closes by the state before a part.
    fn closing(&self, part: &Part, contact: &Contact) -> ByState {
        let state = &part.before;
        let at = |start: Pose| {
            let mut contact = *contact;
            contact.start = start;
            if let Some(surroundings) = &self.solver.contacts.surroundings {
                contact.look(&surroundings.obstacles[contact.obstacle], &start);
            }
            (contact.nearest.gap, -contact.start_rate(&state.velocities))
        };
        let (gap, rate) = at(contact.start);
        // The quotient by the pose, and by the velocities that its rate is linear in.
        let by = by_displacements(self.rod.length, |axis, by| {
            let (gap, rate) = at(displaced(&contact.start, axis, by));
            gap / rate
        });
        let mut of = ByState::of_section(self, state, contact.station, by);
        let push = in_section(contact.start.rotation, contact.nearest.normal, contact.nearest.arm);
        let nodes = &mut of.velocities[POINTS * contact.station.element..];
        for (velocity, shape) in nodes.iter_mut().zip(contact.shapes) {
            *velocity = push * (shape * gap / (rate * rate));
        }
        of
    }
}
