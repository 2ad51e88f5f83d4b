//! The start of a motion: an equilibrium, rest, or a state that was kept.

use whipcord::{CableCommand, Case, Shortening};
use whipcord_numerics::{Pose, Vec3};

use crate::commands::Commands;
use crate::energy::Power;
use crate::equilibrium;
use crate::error::{MotionError, count};
use crate::iteration::{Mechanics, Solver};
use crate::options::{Initial, Start, StartRates};
use crate::pose;
use crate::simulation::Simulation;
use crate::state::{CableMotion, MotorMotion};

impl Simulation {
    /// The case of the equilibrium to start from: with the commands and loads before the start.
    fn statics(&self, case: &Case, commands: &Commands) -> Result<Case, MotionError> {
        let mut statics = case.clone();
        statics.motors.clear();
        let told = |i: usize| {
            let value = self.command(commands, i, 0.0, false);
            match self.is_by_length(commands, i) {
                true => CableCommand { shortening: Some(Shortening::Length(value)), tension: None },
                false => CableCommand { tension: Some(value.max(0.0)), shortening: None },
            }
        };
        statics.commands = (0..self.rod.cables.len()).map(told).collect();
        for course in &self.options.loads {
            course.add_to(&mut statics.loads, course.factor.before(0.0), self.rod.length)?;
        }
        Ok(statics)
    }

    /// Puts velocities, strains, tensions and motors of a state that was kept in their places.
    fn start_from(&mut self, start: &Start, commands: &Commands) -> Result<(), MotionError> {
        let Start { velocities, strains, tensions, motor_outputs, motors, .. } = start;
        count("velocities of the state to start from", velocities.len(), self.rod.nodes.len())?;
        count("strains of the state to start from", strains.len(), self.rod.points.len())?;
        if !tensions.is_empty() {
            count("tensions of the state to start from", tensions.len(), self.rod.cables.len())?;
        }
        if !motor_outputs.is_empty() {
            count(
                "motors of the state to start from",
                motor_outputs.len(),
                self.state.motor_outputs.len(),
            )?;
            self.state.motor_outputs.copy_from_slice(motor_outputs);
            self.next.motor_outputs.copy_from_slice(motor_outputs);
        }
        if !motors.is_empty() {
            count("motors of the state to start from", motors.len(), self.state.motors.len())?;
        }
        self.put_passages(start)?;
        let none = StartRates::default();
        let rates = start.rates.as_ref().unwrap_or(&none);
        let twists =
            velocities.iter().chain(strains).chain(&rates.velocities).chain(&rates.strains);
        let numbers = twists.flat_map(|of| [of.linear, of.angular]).flat_map(Vec3::to_array);
        let passages = start.passage_tensions.iter().chain(&start.lengths_beyond).flatten();
        let of_motors = motors.as_flattened().iter().chain(rates.motors.as_flattened());
        let scalars = tensions.iter().chain(motor_outputs).chain(of_motors).chain(passages);
        let scalars = scalars.chain([&rates.step]).chain(&rates.commands).chain(&rates.loads);
        let scalars = scalars.copied();
        for value in numbers.chain(scalars) {
            if !value.is_finite() {
                let need = "all of its numbers must be finite";
                return Err(MotionError::Option {
                    what: "a number of the state to start from",
                    value,
                    need,
                });
            }
        }
        for (cable, tension) in self.state.cables.iter_mut().zip(tensions) {
            cable.tension = *tension;
        }
        self.next.velocities.copy_from_slice(velocities);
        self.solver.stage.strains.copy_from_slice(strains);
        self.put_motors_at_rest();
        for (motor, values) in self.next.motors.iter_mut().zip(motors) {
            *motor = MotorMotion::new(*values);
        }
        self.set_lengths(commands, 0.0);
        self.set_tensions(commands, 0.0);
        Ok(())
    }

    /// Has the holes remember what a state that was kept has of them.
    fn put_passages(&mut self, start: &Start) -> Result<(), MotionError> {
        let Start { tensions: of_cables, passage_tensions, lengths_beyond, .. } = start;
        let Some(friction) = &self.solver.friction else { return Ok(()) };
        if passage_tensions.is_empty() || lengths_beyond.is_empty() {
            return Err(MotionError::Missing {
                path: "motion.initial.passage_tensions".to_owned(),
                advice: "give the tensions of the passages and the lengths beyond them (`passage_tensions`, `lengths_beyond`) of a robot whose cables have friction, as a motion of it has them",
            });
        }
        let cables = self.rod.cables.len();
        count("passage_tensions of the state to start from", passage_tensions.len(), cables)?;
        count("lengths_beyond of the state to start from", lengths_beyond.len(), cables)?;
        let ends =
            self.state.first_passages.windows(2).zip(passage_tensions.iter().zip(lengths_beyond));
        for (end, (tensions, lengths)) in ends {
            let passages = end[1] - end[0];
            count("tensions of passages of the state to start from", tensions.len(), passages)?;
            count("lengths beyond passages of the state to start from", lengths.len(), passages)?;
        }
        let holes = &mut self.next.holes;
        holes.tensions = passage_tensions.concat();
        holes.beyond = lengths_beyond.concat();
        let outside: Vec<usize> = friction.outside().map(|(cable, _)| cable).collect();
        for cable in outside {
            holes.tensions.push(of_cables.get(cable).copied().unwrap_or_default());
            holes.beyond.push(holes.beyond[self.rod.first_passages[cable]]);
        }
        for (cable, base) in holes.base.iter_mut().enumerate() {
            *base = of_cables.get(cable).copied().unwrap_or_default();
        }
        self.solver.stage.passages.clone_from(&holes.tensions);
        Ok(())
    }

    /// Takes over the rates of a state that was kept, if it has any, and what the loops of its motors give.
    fn put_rates(&mut self, start: &Start, commands: &Commands) -> Result<(), MotionError> {
        /// Loads that differ by less than this part are the same.
        const SAME: f64 = 1e-9;
        self.solver.lengths.drives.write_efforts(commands, 0.0, &mut self.next.motors);
        let Some(rates) = &start.rates else { return Ok(()) };
        let StartRates { velocities, strains, motors, step, commands: told, loads: acted } = rates;
        let Self { rod, loads, solver, next, .. } = self;
        for (what, given, expected) in [
            ("velocities of the rates to start from", velocities.len(), rod.nodes.len()),
            ("strains of the rates to start from", strains.len(), rod.points.len()),
            ("motors of the rates to start from", motors.len(), next.motors.len()),
            ("commands of the rates to start from", told.len(), rod.cables.len()),
        ] {
            count(what, given, expected)?;
        }
        loads.at(0.0, &mut solver.stage.loads);
        let now = loads.sums(&solver.stage.loads);
        let size = now.iter().chain(acted).fold(0.0_f64, |most, of| most.max(of.abs()));
        if now.iter().zip(acted).any(|(now, before)| (now - before).abs() > SAME * size) {
            return Ok(());
        }
        next.velocity_rates.clone_from(velocities);
        next.strain_rates.clone_from(strains);
        for (motor, rates) in next.motors.iter_mut().zip(motors) {
            motor.rates = *rates;
        }
        // Another command is a jump.
        next.commanded.clone_from(told);
        (next.has_rates, next.rates_of) = (true, *step);
        Ok(())
    }

    /// A motion that starts inside of an obstacle would begin with an explosion.
    fn refuse_overlap(&mut self) -> Result<(), MotionError> {
        /// Depth that is admitted, as a part of the length: shapes of other meshes overlap a little.
        const ADMITTED: f64 = 1e-3;
        let Self { rod, solver, .. } = self;
        let Solver { contacts, stage, .. } = solver;
        match contacts.deepest(rod, Pose::IDENTITY, &stage.strains) {
            Some((obstacle, depth)) if depth > ADMITTED * rod.length => {
                Err(MotionError::Overlap { obstacle, depth })
            }
            _ => Ok(()),
        }
    }

    /// Puts the motors where their drives are.
    fn put_motors_at_rest(&mut self) {
        let motors = self.robot.motors().iter().zip(&self.state.motor_outputs);
        for (of, (motor, output)) in self.next.motors.iter_mut().zip(motors) {
            *of = MotorMotion::new([motor.offset + motor.gear_ratio() * output, 0.0, 0.0]);
        }
    }

    /// Puts the motors with inertia in equilibrium with the tensions of the stage.
    fn put_motors_in_equilibrium(&mut self) -> Result<(), MotionError> {
        let Self { robot, solver, next, .. } = self;
        let (drives, tensions) = (&solver.lengths.drives, &solver.stage.tensions);
        drives.find_equilibrium(&mut next.motors, tensions).map_err(|(motor, needed)| {
            let of = &robot.motors()[motor];
            let name = of.name.clone();
            MotionError::MotorOverload { name, needed, limit: of.limits.effort.unwrap_or_default() }
        })
    }

    /// Finds the equilibrium of a case under the commands before the start, into the stage. Without friction of cables the lengths that motors with inertia leave are found with it; with
    /// friction the tensions are those of the statics at given lengths, and the motors are found by Broyden's method.
    fn find_equilibrium(&mut self, case: &Case, commands: &Commands) -> Result<(), MotionError> {
        /// Solutions of the statics at most.
        const MOST: usize = 60;
        /// What the loops may lack, in rad or m, as a part of what the motors turn.
        const TOLERANCE: f64 = 1e-10;
        /// Part of what they lack that the first change is: soft loops yield much.
        const CAREFUL: f64 = 0.1;
        let mut statics = self.statics(case, commands)?;
        let solve = |this: &mut Self, statics: &Case| {
            let Self { robot, rod, loads, solver, .. } = this;
            equilibrium::find(robot, statics, Mechanics { rod, loads }, solver)
        };
        let driven = self.solver.lengths.drives.driven();
        if self.solver.friction.is_none() || driven.is_empty() {
            return solve(self, &statics);
        }
        let n = driven.len();
        let mut positions: Vec<f64> = driven.iter().map(|of| of.1).collect();
        let mut inverse = vec![0.0; n * n];
        (0..n).for_each(|i| inverse[i * n + i] = CAREFUL);
        let mut last: Option<(Vec<f64>, Vec<f64>)> = None;
        let mut greatest = f64::INFINITY;
        for _ in 0..MOST {
            for (&(motor, _), position) in driven.iter().zip(&positions) {
                let of = &self.robot.motors()[motor];
                for drive in &of.cables {
                    let value = drive.pull() * (position - of.offset) / of.gear_ratio();
                    statics.commands[drive.cable].shortening = Some(Shortening::Length(value));
                }
            }
            solve(self, &statics)?;
            let Solver { lengths, stage, .. } = &self.solver;
            let at_rest = lengths.drives.at_rest(&stage.tensions);
            let lack: Vec<f64> = positions.iter().zip(&at_rest).map(|(x, at)| x - at).collect();
            let size = positions.iter().fold(1e-3_f64, |most, x| most.max(x.abs()));
            greatest = lack.iter().fold(0.0_f64, |most, x| most.max(x.abs())) / size;
            if greatest < TOLERANCE {
                return Ok(());
            }
            if let Some((before, lacked)) = &last {
                let of = |a: &[f64], b: &[f64]| -> Vec<f64> {
                    a.iter().zip(b).map(|(a, b)| a - b).collect()
                };
                update_inverse(&mut inverse, &of(&positions, before), &of(&lack, lacked));
            }
            let step = times(&inverse, &lack);
            last = Some((positions.clone(), lack));
            positions.iter_mut().zip(step).for_each(|(x, by)| *x -= by);
        }
        Err(MotionError::Unbalanced { iterations: MOST, change: greatest })
    }

    /// Sets the state at the start.
    pub(crate) fn start(&mut self, case: &Case, commands: &Commands) -> Result<(), MotionError> {
        let initial = self.options.initial.clone();
        self.put_motors_at_rest();
        match &initial {
            Initial::Equilibrium => {
                self.set_lengths(commands, 0.0);
                self.set_tensions(commands, 0.0);
                self.start_lengths.clone_from(&self.solver.lengths.cables);
                self.start_drives.clone_from(&self.solver.lengths.drives);
                self.find_equilibrium(case, commands)?;
                let Self { rod, solver, .. } = self;
                if let Some(friction) = &solver.friction {
                    let stage = &mut solver.stage;
                    pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
                    let lengths = friction.lengths(rod, &stage.strains, &stage.poses);
                    let (mut passages, base) = (stage.passages.clone(), stage.tensions.clone());
                    passages.extend(friction.outside().map(|(cable, _)| base[cable]));
                    self.next.holes = friction.holes.memory_at(&lengths, passages, base);
                }
                self.put_motors_in_equilibrium()?;
            }
            Initial::Rest => {
                self.solver.stage.tensions.fill(0.0);
                self.solver.stage.passages.clone_from(&self.next.holes.tensions);
            }
            Initial::State(start) => self.start_from(start, commands)?,
        }
        self.next.strains.copy_from_slice(&self.solver.stage.strains);
        self.refuse_overlap()?;
        let is_rest = initial == Initial::Rest;
        self.finish(commands, 0.0, &Power::default(), 1.0);
        self.next.has_rates = false;
        if let Initial::State(start) = &initial {
            self.put_rates(start, commands)?;
        }
        let energy = &mut self.next.energy;
        energy.initial = energy.total();
        (energy.loads, energy.cables, energy.contacts) = (0.0, 0.0, 0.0);
        if is_rest {
            // Nothing has been told to the cables yet.
            self.next.commanded.fill(f64::NAN);
            for i in 0..self.rod.cables.len() {
                let length = self.next.cables[i].length;
                self.next.cables[i] = CableMotion { tension: 0.0, length, slack: 0.0 };
            }
        }
        core::mem::swap(&mut self.state, &mut self.next);
        Ok(())
    }
}

/// A matrix given by rows times numbers.
fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    let row = |row: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum();
    matrix.chunks_exact(x.len()).map(row).collect()
}

/// Broyden's change of the inverse of a derivative, for what has changed and what that changed.
fn update_inverse(inverse: &mut [f64], moved: &[f64], changed: &[f64]) {
    let n = moved.len();
    let found = times(inverse, changed);
    let row: Vec<f64> =
        (0..n).map(|j| (0..n).map(|i| moved[i] * inverse[i * n + j]).sum()).collect();
    let size: f64 = moved.iter().zip(&found).map(|(a, b)| a * b).sum();
    if size == 0.0 {
        return;
    }
    for i in 0..n {
        for j in 0..n {
            inverse[i * n + j] += (moved[i] - found[i]) * row[j] / size;
        }
    }
}
