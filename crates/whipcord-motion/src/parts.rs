//! The parts of a step: each is solved by a method, and divided where it must be.

use crate::commands::{CableDrive, Commands};
use crate::drives::MotorWork;
use crate::energy::{Power, energies};
use crate::error::MotionError;
use crate::iteration::{Control, Mechanics, Stalled};
use crate::lengths::Lengths;
use crate::one_stage::OneStage;
use crate::options::Method;
use crate::pose;
use crate::simulation::Simulation;
use crate::state::{CableMotion, MotorMotion, State};

/// ρ of [`Method::Robust`].
pub(crate) const RHO: f64 = 0.5;
/// Energy that a part of a step by [`Method::Accurate`] may gain by the integration, as a part of that of motion and strains. The method is stable for
/// linear equations; a violent motion without damping can grow by steps that are too long for it.
const GREATEST_GAIN: f64 = 5e-3;
/// Halvings for the sake of the energy.
const HALVINGS_FOR_ENERGY: i32 = 3;
/// Steps without rates behind a jump, where cables are driven by their lengths.
const AFTER_IMPACT: usize = 2;
/// Halvings of a step at most.
const MOST_HALVINGS: i32 = 14;

/// A part of a step that has been solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    /// Its estimated error in m.
    error: f64,
    /// Whether the integration has added more energy than it should.
    gains: bool,
}

impl Simulation {
    /// Goes on to a time, up to which nothing jumps. `taken` gets the state before each part, its length and whether its iteration began with a prediction.
    pub(crate) fn advance(
        &mut self,
        commands: &Commands,
        goal: f64,
        taken: &mut dyn FnMut(&State, f64, bool),
    ) -> Result<(), MotionError> {
        let total = goal - self.state.time;
        if self.has_jumped(commands) {
            self.state.has_rates = false;
            self.state.without_rates = 0;
        }
        let mut halvings = 0;
        let mut cold = false;
        while self.state.time < goal {
            let left = goal - self.state.time;
            let part = total * 0.5_f64.powi(halvings);
            // What rounding leaves is no part of its own.
            let h = if part > 0.999_999 * left { left } else { part };
            let attempt = self.attempt(commands, h, !cold);
            let limit = self.options.tolerance.map(|tolerance| tolerance * h / total);
            match attempt {
                Ok(Attempt { error, gains })
                    if limit.is_none_or(|limit| error <= limit)
                        && !(gains && halvings < HALVINGS_FOR_ENERGY) =>
                {
                    if h == left {
                        self.next.time = goal;
                    }
                    taken(&self.state, h, !cold);
                    self.next.diagnostics.error += error;
                    self.next.diagnostics.parts += 1;
                    core::mem::swap(&mut self.state, &mut self.next);
                    cold = false;
                    // A longer part next, where this one was much better than needed.
                    if limit.is_some_and(|limit| error < 0.03 * limit) && halvings > 0 {
                        halvings -= 1;
                    }
                    continue;
                }
                Err(_) if !cold => {
                    cold = true;
                    continue;
                }
                Ok(Attempt { error, .. }) if halvings >= MOST_HALVINGS => {
                    let tolerance = self.options.tolerance.unwrap_or_default();
                    return Err(MotionError::Tolerance {
                        time: self.state.time,
                        part: h,
                        error,
                        tolerance,
                    });
                }
                Err(Stalled(change)) if halvings >= MOST_HALVINGS => {
                    return Err(MotionError::NotConverged {
                        time: self.state.time,
                        part: h,
                        change,
                    });
                }
                _ => {}
            }
            cold = false;
            halvings += 1;
        }
        Ok(())
    }

    /// Whether a command or a load is another than at the end of the step before.
    fn has_jumped(&self, commands: &Commands) -> bool {
        let time = self.state.time;
        self.loads.jumps_at(time)
            || (0..self.rod.cables.len()).any(|i| {
                let (value, before) =
                    (self.command(commands, i, time, true), self.state.commanded[i]);
                let scale = value.abs().max(before.abs());
                // A NaN, of a cable that was not told anything, is a jump.
                before.is_nan() || (value - before).abs() > 1e-9 * scale
            })
    }

    /// What a cable is told at a time: a tension in N or a shortening in m.
    pub(crate) fn command(&self, commands: &Commands, cable: usize, time: f64, after: bool) -> f64 {
        let at =
            |course: &crate::Course| if after { course.after(time) } else { course.before(time) };
        let Some((motor, course)) = commands.motor_of(&self.robot, cable) else {
            return at(commands.cables[cable].course());
        };
        let of = &self.robot.motors()[motor];
        let output = of.output(self.state.motor_outputs[motor], at(course));
        self.pull(motor, cable) * output
    }

    /// By how much in m a motor shortens a cable for each rad or m of its drive.
    pub(crate) fn pull(&self, motor: usize, cable: usize) -> f64 {
        let cables = &self.robot.motors()[motor].cables;
        cables.iter().find(|of| of.cable == cable).map_or(0.0, |of| of.pull())
    }

    /// Whether a cable is driven by its length.
    pub(crate) fn is_by_length(&self, commands: &Commands, cable: usize) -> bool {
        commands.motor_of(&self.robot, cable).is_some()
            || matches!(commands.cables[cable], CableDrive::Shortening(_))
    }

    /// Takes a part of a step, into [`Self::next`].
    pub(crate) fn attempt(
        &mut self,
        commands: &Commands,
        h: f64,
        warm: bool,
    ) -> Result<Attempt, Stalled> {
        self.set_lengths(commands, self.state.time + h);
        self.solver.lengths.motor_work = MotorWork::default();
        let by_length = !self.solver.lengths.cables.is_empty();
        let method = if by_length { Method::Robust } else { self.options.method };
        self.next.copy_from(&self.state);
        (self.solver.iterations, self.solver.factorisations) = (0, 0);
        self.next.diagnostics.method = method;
        let error = match method {
            Method::Accurate => self.attempt_accurate(commands, h, warm)?,
            Method::Energy | Method::Robust => {
                let estimates = self.options.tolerance.is_some();
                self.attempt_one_stage(commands, method, h, warm, estimates)?
            }
        };
        self.next.diagnostics.iterations += self.solver.iterations;
        self.next.diagnostics.factorisations += self.solver.factorisations;
        let energy = &self.next.energy;
        let gained = energy.defect() - self.state.energy.defect();
        let gains = method == Method::Accurate
            && gained > GREATEST_GAIN * (energy.kinetic + energy.elastic);
        Ok(Attempt { error, gains })
    }

    /// How the stages of a step of length `h` are iterated. A change of the strains in a short step is a large one of the velocities, and many short
    /// steps add up: the tolerance falls with the step.
    fn control(&self, h: f64, method: Method, predicts: bool) -> Control {
        const USUAL: f64 = 0.01;
        const LEAST: f64 = 1e-13;
        let ratio = (h / USUAL).min(1.0);
        Control {
            predicts,
            tolerance: (self.options.iteration_tolerance * ratio * ratio).max(LEAST),
            to_rounding: method == Method::Energy,
            reuses: method == Method::Accurate,
        }
    }

    fn attempt_accurate(
        &mut self,
        commands: &Commands,
        h: f64,
        warm: bool,
    ) -> Result<f64, Stalled> {
        let control = self.control(h, Method::Accurate, warm);
        let Self { rod, loads, solver, accurate, state, next, .. } = self;
        let tensions = |time: f64, out: &mut [f64]| commands.tensions_at(time, out);
        let work = accurate.step(Mechanics { rod, loads }, solver, state, h, &control, tensions)?;
        next.velocities.copy_from_slice(&solver.stage.velocities);
        next.strains.copy_from_slice(&solver.stage.strains);
        let (velocity_rates, strain_rates) = accurate.rates();
        next.velocity_rates.copy_from_slice(velocity_rates);
        next.strain_rates.copy_from_slice(strain_rates);
        let error = if self.options.tolerance.is_some() {
            pose::nodes(rod, solver.stage.base, &next.strains, &mut solver.stage.poses);
            pose::displacement(rod, &solver.stage.poses, &accurate.error)
        } else {
            0.0
        };
        let end = self.state.time + h;
        self.finish(commands, end, &work, 1.0);
        Ok(error)
    }

    /// A step by a method with one stage. To estimate its error it is repeated in halves, whose result is taken.
    fn attempt_one_stage(
        &mut self,
        commands: &Commands,
        method: Method,
        h: f64,
        warm: bool,
        estimates: bool,
    ) -> Result<f64, Stalled> {
        let one_step = |this: &mut Self, h: f64| {
            let control = this.control(h, method, warm);
            let scheme = match method {
                Method::Energy => OneStage::MIDPOINT,
                _ => OneStage::damping(RHO, this.state.has_rates),
            };
            let end = this.state.time + h;
            this.set_lengths(commands, end);
            let time = scheme.time(this.state.time, h);
            this.set_tensions(commands, time);
            let Self { rod, loads, solver, state, next, .. } = this;
            solver.lengths.drives.set(commands, time);
            solver.lengths.drives.begin(&state.motors, &scheme, h);
            let work = scheme.step(Mechanics { rod, loads }, solver, state, next, h, &control)?;
            let Lengths { drives, motor_work, .. } = &mut solver.lengths;
            *motor_work = drives.finish(&mut next.motors, &scheme, h, &solver.stage.tensions);
            drives.write_efforts(commands, end, &mut next.motors);
            this.finish(commands, end, &work, scheme.scheme(h).place);
            Ok(())
        };
        if !estimates {
            one_step(self, h)?;
            return Ok(0.0);
        }
        self.start_of_part.copy_from(&self.state);
        let outcome = self.in_halves(h, one_step);
        self.state.copy_from(&self.start_of_part);
        outcome?;
        let Self { rod, solver, accurate, next, whole, .. } = self;
        for ((error, halves), whole) in
            accurate.error.iter_mut().zip(&next.strains).zip(&whole.strains)
        {
            *error = (*halves - *whole) * (1.0 / 3.0);
        }
        pose::nodes(rod, solver.stage.base, &next.strains, &mut solver.stage.poses);
        Ok(pose::displacement(rod, &solver.stage.poses, &accurate.error))
    }

    /// Takes a step whole, into [`Self::whole`], and in halves, into [`Self::next`]; leaves the state in the middle.
    fn in_halves(
        &mut self,
        h: f64,
        mut step: impl FnMut(&mut Self, f64) -> Result<(), Stalled>,
    ) -> Result<(), Stalled> {
        step(self, h)?;
        core::mem::swap(&mut self.whole, &mut self.next);
        self.next.copy_from(&self.state);
        step(self, 0.5 * h)?;
        self.state.copy_from(&self.next);
        step(self, 0.5 * h)
    }

    /// The motor of a cable, where that motor has inertia and a command.
    pub(crate) fn moving_motor(&self, commands: &Commands, cable: usize) -> Option<usize> {
        let (motor, _) = commands.motor_of(&self.robot, cable)?;
        self.robot.motors()[motor].dynamics.map(|_| motor)
    }

    /// Sets which cables are driven by their lengths, and these at a time, but for what motors with inertia shorten.
    pub(crate) fn set_lengths(&mut self, commands: &Commands, time: f64) {
        self.solver.lengths.cables.clear();
        self.solver.lengths.targets.clear();
        self.solver.lengths.previous.clear();
        self.solver.lengths.drives.set(commands, time);
        for i in 0..self.rod.cables.len() {
            let is_internal = self.moving_motor(commands, i).is_some();
            self.solver.stage.is_internal[i] = is_internal;
            if self.is_by_length(commands, i) {
                let shortening =
                    if is_internal { 0.0 } else { self.command(commands, i, time, false) };
                self.solver.lengths.cables.push(i);
                self.solver.lengths.targets.push(self.rod.cables[i].rest_length - shortening);
                self.solver.lengths.previous.push(self.state.cables[i].tension);
            }
        }
    }

    /// Sets the tensions of the cables at a time; those of cables that are driven by their lengths start from the last ones.
    pub(crate) fn set_tensions(&mut self, commands: &Commands, time: f64) {
        for i in 0..self.rod.cables.len() {
            self.solver.stage.tensions[i] = if self.is_by_length(commands, i) {
                self.state.cables[i].tension
            } else {
                commands.cables[i].course().before(time).max(0.0)
            };
        }
    }

    /// Completes the state behind a step, whose velocities, strains and motors with inertia are in [`Self::next`] and whose stage, at this place in the step, is in the
    /// solver.
    pub(crate) fn finish(&mut self, commands: &Commands, time: f64, work: &Power, place: f64) {
        let mut stretch = 0.0;
        for i in 0..self.rod.cables.len() {
            let by_length = self.is_by_length(commands, i);
            let commanded = self.command(commands, i, time, false);
            let line = self.rod.cables[i];
            let length = self.rod.cable_length(i, &self.next.strains);
            let tension = if by_length {
                let stage = self.solver.stage.tensions[i];
                Lengths::end_tension(self.state.cables[i].tension, stage, place)
            } else {
                commanded.max(0.0)
            };
            let mut shortening = commanded;
            if let Some(motor) = self.moving_motor(commands, i) {
                let (of, position) =
                    (&self.robot.motors()[motor], self.next.motors[motor].position);
                shortening = self.pull(motor, i) * (position - of.offset) / of.gear_ratio();
                stretch += 0.5 * line.compliance * tension * tension;
            }
            let longest =
                line.rest_length - shortening + line.compliance * (tension - line.pretension);
            let slack = if by_length && tension == 0.0 { (longest - length).max(0.0) } else { 0.0 };
            self.next.commanded[i] = commanded;
            self.next.cables[i] = CableMotion { tension, length, slack };
        }
        self.finish_motors(commands, time);
        let Self { rod, loads, solver, state, next, base, .. } = self;
        let poses = &mut solver.stage.poses;
        next.base = loads.base_pose(state.base, state.time, time - state.time);
        next.velocities[0] = loads.base_velocity(time);
        pose::nodes(rod, next.base, &next.strains, poses);
        let parts = energies(rod, loads, &next.velocities, &next.strains, poses);
        for (out, pose) in next.poses.iter_mut().zip(&*poses) {
            *out = *base * *pose;
        }
        let energy = &mut next.energy;
        [energy.kinetic, energy.elastic, energy.gravity] = parts;
        energy.stretch = stretch;
        energy.motors = solver.lengths.drives.kinetic(&next.motors);
        let motor_work = solver.lengths.motor_work;
        energy.cables = state.energy.cables + work.cables;
        energy.control = state.energy.control + motor_work.control;
        energy.loads = state.energy.loads + work.loads;
        energy.base = state.energy.base + work.base;
        energy.dissipated = state.energy.dissipated + work.dissipated + motor_work.dissipated;
        if next.diagnostics.method == Method::Energy {
            let back = base.rotation.conjugate();
            let ends = next.poses.iter().zip(&state.poses).zip(&solver.stage.loads);
            energy.loads += ends
                .map(|((to, from), load)| load.force.dot(back.rotate(to.position - from.position)))
                .sum::<f64>();
        }
        next.time = time;
        // Behind a jump of a length the rates of the first step are those of an impact, which do not last.
        next.without_rates = if state.has_rates { 0 } else { state.without_rates + 1 };
        next.has_rates = solver.lengths.cables.is_empty()
            || state.has_rates
            || next.without_rates >= AFTER_IMPACT;
    }

    /// Writes what the drives of the motors have moved, and the motors without inertia.
    fn finish_motors(&mut self, commands: &Commands, time: f64) {
        for (i, motor) in self.robot.motors().iter().enumerate() {
            let course = commands.motors.get(i).and_then(Option::as_ref);
            let (state, next) = (&self.state, &mut self.next);
            match course {
                Some(_) if motor.dynamics.is_some() => {
                    next.motor_outputs[i] =
                        (next.motors[i].position - motor.offset) / motor.gear_ratio();
                }
                Some(course) => {
                    let command = course.before(time);
                    next.motor_outputs[i] = motor.output(state.motor_outputs[i], command);
                    let effort = motor.effort(|cable| Some(next.cables[cable].tension));
                    next.motors[i] = MotorMotion {
                        effort: effort.unwrap_or_default(),
                        ..MotorMotion::new([command, course.slope_before(time), 0.0])
                    };
                }
                // A motor that is told nothing is held where it stands; its cables have commands of their own.
                None => {
                    let [position, ..] = next.motors[i].values();
                    next.motors[i] = MotorMotion::new([position, 0.0, 0.0]);
                }
            }
        }
    }
}
