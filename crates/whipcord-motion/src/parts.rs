//! The parts of a step: each is solved by a method, and divided where it must be.

use whipcord_numerics::Pose;

use crate::coefficients::OneStage;
use crate::commands::{CableDrive, Commands};
use crate::drives::MotorWork;
use crate::energy::{Power, energies};
use crate::error::MotionError;
use crate::friction::Friction;
use crate::impact::PARTS;
use crate::iteration::{Control, Mechanics, Solver, Stalled};
use crate::lengths::Lengths;
use crate::options::Method;
use crate::part::{Impact, Taken};
use crate::pose;
use crate::scheme::Scheme;
use crate::simulation::Simulation;
use crate::state::{CableMotion, MotorMotion};

/// ρ of [`Method::Robust`].
pub(crate) const RHO: f64 = 0.5;
/// Energy that a part of a step by [`Method::Accurate`] may gain by the integration, as a part of that of motion and strains. The method is stable for
/// linear equations; a violent motion without damping can grow by steps that are too long for it.
const GREATEST_GAIN: f64 = 5e-3;
/// Halvings for the sake of the energy.
const HALVINGS_FOR_ENERGY: i32 = 3;
/// Steps without rates behind a jump, where cables are driven by their lengths.
const AFTER_IMPACT: usize = 2;
/// So often a step is repeated with contacts that were not looked for before.
const MOST_ROUNDS: usize = 6;
/// Halvings from which on a part without an answer is taken without friction at its contacts.
const HALVINGS_WITH_FRICTION: i32 = 8;
/// A hole or a contact that is so near to another case of its equations, in relative terms, may be in either.
const ABOUT_TO_CHANGE: f64 = 1e-9;
/// Halvings of a step at most.
const MOST_HALVINGS: i32 = 14;

/// A part of a step that has been solved.
#[derive(Clone, Debug)]
pub(crate) struct Attempt {
    /// Its length in s.
    taken: f64,
    /// Its estimated error in m.
    error: f64,
    /// Whether the integration has added more energy than it should.
    gains: bool,
    /// The impact that it ends in.
    impact: Option<Impact>,
}

impl Simulation {
    /// Goes on to a time, up to which nothing jumps. `taken` gets each part.
    pub(crate) fn advance(
        &mut self,
        commands: &Commands,
        goal: f64,
        taken: &mut dyn FnMut(&Taken<'_>),
    ) -> Result<(), MotionError> {
        let total = goal - self.state.time;
        self.solver.contacts.is_frictionless = false;
        if self.has_jumped(commands) {
            self.state.has_rates = false;
            self.state.without_rates = 0;
        }
        let mut halvings = 0;
        let mut cold = false;
        while self.state.time < goal {
            let left = goal - self.state.time;
            let behind_impact = PARTS.len() - self.state.impact_parts;
            let impact = PARTS.get(behind_impact).copied().unwrap_or(1.0);
            let part = total * impact * 0.5_f64.powi(halvings);
            // What rounding leaves is no part of its own; nor, among obstacles, what is much shorter than the others.
            let whole = if self.solver.contacts.surroundings.is_some() { 0.6 } else { 0.999_999 };
            let is_rest = part > whole * left;
            let h = if is_rest { left } else { part };
            let attempt = self.attempt(commands, h, !cold);
            let limit = self.options.tolerance.map(|tolerance| tolerance * h / total);
            match attempt {
                Ok(Attempt { taken: h, error, gains, impact })
                    if limit.is_none_or(|limit| error <= limit)
                        && !(gains && halvings < HALVINGS_FOR_ENERGY) =>
                {
                    if h == left {
                        self.next.time = goal;
                    }
                    taken(&Taken {
                        before: &self.state,
                        length: h,
                        is_warm: !cold,
                        is_rest,
                        is_frictionless: self.solver.contacts.is_frictionless,
                        impact,
                    });
                    self.next.diagnostics.error += error;
                    self.next.diagnostics.parts += 1;
                    let slid = core::mem::take(&mut self.solver.contacts.is_frictionless);
                    self.next.diagnostics.frictionless_parts += usize::from(slid);
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
                Err(_)
                    if halvings >= HALVINGS_WITH_FRICTION
                        && !self.solver.contacts.is_frictionless
                        && self.solver.contacts.have_friction() =>
                {
                    self.solver.contacts.is_frictionless = true;
                    cold = false;
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
            self.solver.contacts.is_frictionless = false;
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
        let method = self.begin_part(commands, h);
        (self.solver.iterations, self.solver.factorisations) = (0, 0);
        let (error, taken, impact) = match self.solver.contacts.surroundings {
            None => (self.attempt_by(commands, method, h, warm, false)?, h, None),
            Some(_) => self.attempt_among_obstacles(commands, method, h, warm)?,
        };
        self.next.diagnostics.iterations += self.solver.iterations;
        self.next.diagnostics.factorisations += self.solver.factorisations;
        let energy = &self.next.energy;
        let gained = energy.defect() - self.state.energy.defect();
        let watches = self.next.diagnostics.method == Method::Accurate
            || !self.solver.contacts.list.is_empty();
        let gains = watches && gained > GREATEST_GAIN * (energy.kinetic + energy.elastic);
        Ok(Attempt { taken, error, gains, impact })
    }

    /// Begins a part of a step of length `h`; the method that it is taken by where nothing touches.
    pub(crate) fn begin_part(&mut self, commands: &Commands, h: f64) -> Method {
        self.set_lengths(commands, self.state.time + h);
        self.solver.lengths.motor_work = MotorWork::default();
        self.next.copy_from(&self.state);
        let by_length = !self.solver.lengths.cables.is_empty();
        match by_length || self.solver.friction.is_some() {
            true => Method::Robust,
            false => self.options.method,
        }
    }

    /// Takes a part of a step by a method, into [`Self::next`]; its estimated error in m. Obstacles count where the robot `touches` some.
    pub(crate) fn attempt_by(
        &mut self,
        commands: &Commands,
        method: Method,
        h: f64,
        warm: bool,
        touches: bool,
    ) -> Result<f64, Stalled> {
        self.next.diagnostics.method = method;
        match method {
            Method::Accurate => self.attempt_accurate(commands, h, warm),
            Method::Energy | Method::Robust => {
                let estimates = self.options.tolerance.is_some();
                self.attempt_one_stage(commands, method, h, warm, estimates, touches)
            }
        }
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
        next.base = solver.stage.base;
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
        self.next.rates_of = h.max(self.state.rates_of);
        Ok(error)
    }

    /// A step by a method with one stage. To estimate its error it is repeated in halves, whose result is taken.
    pub(crate) fn attempt_one_stage(
        &mut self,
        commands: &Commands,
        method: Method,
        h: f64,
        warm: bool,
        estimates: bool,
        touches: bool,
    ) -> Result<f64, Stalled> {
        let one_step = |this: &mut Self, h: f64| {
            let control = this.control(h, method, warm);
            let scheme = match method {
                Method::Energy => OneStage::MIDPOINT,
                _ => OneStage::damping(RHO, &this.state, h),
            };
            let end = this.state.time + h;
            this.set_lengths(commands, end);
            let time = scheme.time(this.state.time, h);
            this.set_tensions(commands, time);
            this.begin_friction(commands, time, end);
            this.solver.contacts.touches = touches;
            if touches {
                this.look_for_contacts(h);
            }
            let mut rounds = 0;
            let work = loop {
                this.solver.contacts.admit_overlap(&this.rod, h);
                let Self { rod, loads, solver, state, next, .. } = this;
                solver.lengths.drives.set(commands, time);
                solver.lengths.drives.begin(&state.motors, &scheme, h);
                let work =
                    scheme.step(Mechanics { rod, loads }, solver, state, next, h, &control)?;
                let is_last = this.solver.contacts.last_round == Some(rounds);
                let is_last = is_last || !touches || rounds >= MOST_ROUNDS;
                if is_last || !this.finds_overlap(&scheme.scheme(h), rounds) {
                    break work;
                }
                rounds += 1;
                this.set_tensions(commands, time);
                this.begin_friction(commands, time, end);
            };
            let Self { solver, next, .. } = &mut *this;
            let Lengths { drives, motor_work, .. } = &mut solver.lengths;
            *motor_work = drives.finish(&mut next.motors, &scheme, h, &solver.stage.tensions);
            drives.write_efforts(commands, end, &mut next.motors);
            let work = this.end_friction(work, &scheme.scheme(h));
            let Self { rod, solver, next, .. } = &mut *this;
            if touches && solver.contacts.margin(rod) < ABOUT_TO_CHANGE {
                next.changes += 1;
            }
            this.finish(commands, end, &work, scheme.scheme(h).place);
            let keeps_rates = scheme.uses_rates() && this.next.contacts.is_empty();
            this.next.rates_of = if keeps_rates { h.max(this.state.rates_of) } else { h };
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

    /// Puts the holes where the state before a step has them, and gives them their commands.
    fn begin_friction(&mut self, commands: &Commands, time: f64, end: f64) {
        let Some(mut friction) = self.solver.friction.take() else { return };
        self.command_holes(commands, &mut friction, (time, end));
        self.solver.stage.passages.clear();
        self.solver.stage.passages.extend_from_slice(friction.holes.tensions());
        self.solver.friction = Some(friction);
    }

    /// Puts holes where the state has them, with tensions as they are at one time and lengths as they are at another.
    pub(crate) fn command_holes(
        &self,
        commands: &Commands,
        friction: &mut Friction,
        (time, end): (f64, f64),
    ) {
        friction.holes.go_back_to(&self.state.holes);
        for i in 0..self.rod.cables.len() {
            if self.is_by_length(commands, i) {
                let line = &self.rod.cables[i];
                let is_moving = self.moving_motor(commands, i).is_some();
                let shortening =
                    if is_moving { 0.0 } else { self.command(commands, i, end, false) };
                let wound_up = line.compliance * line.pretension;
                friction.command_length(i, line.rest_length - shortening - wound_up);
            } else {
                let tension = commands.cables[i].course().before(time).max(0.0);
                friction.holes.command_tension(i, tension);
            }
        }
    }

    /// Writes what the holes remember of a step that is solved, and counts what friction took: the drives have given it beside what the rod got.
    fn end_friction(&mut self, work: Power, scheme: &Scheme) -> Power {
        let Self { rod, solver, next, .. } = self;
        let Solver { stage, friction: Some(friction), .. } = solver else { return work };
        friction.measure(rod, scheme, stage);
        let (memory, lost) = friction.holes.end_step();
        next.holes = memory;
        next.changes += usize::from(friction.holes.margin() < ABOUT_TO_CHANGE);
        // What motors with inertia give is in the work of their loops.
        let of_cables = lost.iter().zip(&stage.is_internal).filter(|(_, internal)| !**internal);
        let given: f64 = of_cables.map(|(lost, _)| lost).sum();
        let lost: f64 = lost.iter().sum();
        Power { cables: work.cables + given, dissipated: work.dissipated + lost, ..work }
    }

    /// Looks for obstacles that the robot may touch in a step of length `h` from its state: as far as it may come in that time.
    fn look_for_contacts(&mut self, h: f64) {
        /// Acceleration in m/s² and distance, as a part of the length, that count beside the velocity.
        const MARGIN: [f64; 2] = [20.0, 2e-3];
        let fastest = self.state.velocities.iter().map(|v| v.linear.norm()).fold(0.0_f64, f64::max);
        let within = 2.0 * h * fastest + MARGIN[0] * h * h + MARGIN[1] * self.rod.length;
        let Self { rod, loads, solver, state, base, .. } = self;
        solver.contacts.base = match loads.has_free_base {
            true => state.base * Pose::exp(state.velocities[0] * h),
            false => loads.base_pose(state.base, state.time, h),
        };
        let known = (state.contacts.as_slice(), *base);
        solver.contacts.begin(rod, state.base, &state.strains, within, known);
    }

    /// Whether the robot overlaps an obstacle behind a round of a step where no contact was looked for; there is one then.
    fn finds_overlap(&mut self, scheme: &Scheme, round: usize) -> bool {
        let Self { rod, solver, state, .. } = self;
        let Solver { stage, contacts, .. } = solver;
        contacts.refresh(rod, scheme, stage);
        contacts.add_overlapping(rod, &state.strains, state.base, round)
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
            // Cables with friction have their lengths in the equations of the holes.
            if self.is_by_length(commands, i) && self.solver.friction.is_none() {
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
        let drives_lengths = (0..self.rod.cables.len()).any(|i| self.is_by_length(commands, i));
        let Self { rod, loads, solver, state, next, .. } = &mut *self;
        if !loads.has_free_base {
            next.base = loads.base_pose(state.base, state.time, time - state.time);
            next.velocities[0] = loads.base_velocity(time);
        }
        pose::nodes(rod, next.base, &next.strains, &mut solver.stage.poses);
        for i in 0..self.rod.cables.len() {
            let by_length = self.is_by_length(commands, i);
            let commanded = self.command(commands, i, time, false);
            let line = self.rod.cables[i];
            let length = self.rod.cable_length(i, &self.next.strains, &self.solver.stage.poses);
            let tension = if by_length && self.solver.friction.is_some() {
                self.next.holes.base[i]
            } else if by_length {
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
                stretch += match &self.solver.friction {
                    Some(friction) => friction.stretch(&self.robot, i, &self.next.holes.tensions),
                    None => 0.5 * line.compliance * tension * tension,
                };
            }
            let longest =
                line.rest_length - shortening + line.compliance * (tension - line.pretension);
            let slack = if by_length && tension == 0.0 { (longest - length).max(0.0) } else { 0.0 };
            self.next.commanded[i] = commanded;
            self.next.cables[i] = CableMotion { tension, length, slack };
        }
        self.finish_motors(commands, time);
        let Self { rod, loads, solver, state, next, base, .. } = self;
        let poses = &solver.stage.poses;
        let parts = energies(rod, loads, &next.velocities, &next.strains, poses);
        for (out, pose) in next.poses.iter_mut().zip(poses) {
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
        energy.contacts = state.energy.contacts + work.contacts;
        energy.dissipated = state.energy.dissipated + work.dissipated + motor_work.dissipated;
        if next.diagnostics.method == Method::Energy {
            let back = base.rotation.conjugate();
            let ends = next.poses.iter().zip(&state.poses).zip(&solver.stage.loads);
            energy.loads += ends
                .map(|((to, from), load)| load.force.dot(back.rotate(to.position - from.position)))
                .sum::<f64>();
            if rod.has_chords() {
                let lengths = next.cables.iter().zip(&state.cables).zip(&solver.stage.tensions);
                energy.cables -= lengths
                    .map(|((to, from), tension)| tension * (to.length - from.length))
                    .sum::<f64>();
            }
        }
        next.time = time;
        next.acting = loads.sums(&solver.stage.loads);
        // Behind a jump of a length the rates of the first step are those of an impact, which do not last.
        next.without_rates = if state.has_rates { 0 } else { state.without_rates + 1 };
        next.impact_parts = state.impact_parts.saturating_sub(1);
        next.has_rates = next.impact_parts == 0
            && (!drives_lengths || state.has_rates || next.without_rates >= AFTER_IMPACT);
        solver.contacts.report(*base, rod, &mut next.contacts);
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
