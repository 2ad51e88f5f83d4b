//! The motion of a robot, step by step.

use whipcord::{CableCommand, Case, Robot, Shortening};
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::accurate::Accurate;
use crate::commands::{CableDrive, Commands};
use crate::energy::{Power, energies};
use crate::equilibrium;
use crate::error::MotionError;
use crate::iteration::{Ending, Solver, Stalled};
use crate::loads::NodeLoads;
use crate::one_stage::OneStage;
use crate::options::{Initial, Method, MotionOptions};
use crate::pose;
use crate::rod::Rod;
use crate::state::{CableMotion, State};

/// ρ of [`Method::Robust`].
const RHO: f64 = 0.5;
/// Halvings of a step at most.
const MOST_HALVINGS: i32 = 14;

/// The motion of a robot.
///
/// ```
/// use whipcord::{Backbone, Cable, Case, Disks, Material, Robot, Routing, Section};
/// use whipcord_motion::{Commands, Damping, MotionOptions, Simulation};
///
/// let backbone = Backbone {
///     section: Some(Section::circle(0.003)),
///     material: Material {
///         young_modulus: Some(1.1e9),
///         poisson_ratio: Some(0.3),
///         density: Some(1040.0),
///         ..Default::default()
///     },
///     ..Backbone::new(0.18)
/// };
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
/// let options = MotionOptions { damping: Damping::Time(3.5e-3), ..Default::default() };
/// let mut simulation = Simulation::new(&robot, &Case::with_tensions(&[0.0]), options)?;
///
/// // The cable is pulled at once by 4 N.
/// let commands = Commands::tensions(&[4.0]);
/// for _ in 0..100 {
///     simulation.step(&commands, 0.01)?;
/// }
/// let state = simulation.state();
/// assert!(state.tip().position.x > 0.05);
/// assert!(state.energy.defect().abs() < 0.02 * state.energy.cables);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Simulation {
    robot: Robot,
    rod: Rod,
    loads: NodeLoads,
    base: Pose,
    options: MotionOptions,
    solver: Solver,
    accurate: Accurate,
    state: State,
    /// The state before a step, to return to.
    before: State,
    /// The state behind a part of a step.
    next: State,
    /// The state behind a whole step that is repeated in halves, to estimate its error.
    whole: State,
    /// The state before these.
    start_of_part: State,
}

impl Simulation {
    /// Prepares the motion of a robot from the commands, loads and base of a case: constant commands, until [`Self::step`] is given others.
    ///
    /// # Errors
    /// [`MotionError`] where the case does not fit the robot, the robot has no mass or no stiffness, a part of robot or case has no dynamics
    /// here (friction, obstacles), or there is no equilibrium to start from.
    pub fn new(robot: &Robot, case: &Case, options: MotionOptions) -> Result<Self, MotionError> {
        let commands = Commands::of_case(robot, case);
        Self::with_commands(robot, case, &commands, options)
    }

    /// The same with commands over time, whose values before the start are those of the equilibrium to start from.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_commands(
        robot: &Robot,
        case: &Case,
        commands: &Commands,
        options: MotionOptions,
    ) -> Result<Self, MotionError> {
        options.check()?;
        case.check(robot)?;
        commands.check(robot)?;
        if !case.obstacles.is_empty() {
            return Err(MotionError::Unsupported {
                path: "obstacles".to_owned(),
                what: "contact with obstacles",
                advice: "remove the obstacles, or solve the statics with steps of actuation",
            });
        }
        for of in &options.loads {
            let with_loads = Case { loads: of.loads.clone(), ..case.clone() };
            with_loads.check(robot)?;
        }
        let all: Vec<_> =
            core::iter::once(&case.loads).chain(options.loads.iter().map(|of| &of.loads)).collect();
        let rod = Rod::new(robot, &all, &options)?;
        let loads = NodeLoads::new(&rod, case, &options.loads);
        let drag = Vec3::new(options.drag.across, options.drag.across, options.drag.along);
        let solver = Solver::new(&rod, drag);
        let state = State {
            velocities: vec![Twist::default(); rod.nodes.len()],
            strains: rod.points.iter().map(|point| point.rest).collect(),
            velocity_rates: vec![Twist::default(); rod.nodes.len()],
            strain_rates: vec![Twist::default(); rod.points.len()],
            poses: vec![Pose::IDENTITY; rod.nodes.len()],
            cables: vec![CableMotion::default(); rod.cables.len()],
            motor_outputs: vec![0.0; robot.motors().len()],
            commanded: vec![f64::NAN; rod.cables.len()],
            ..State::default()
        };
        let mut simulation = Self {
            robot: robot.clone(),
            accurate: Accurate::new(&rod),
            rod,
            loads,
            base: case.base,
            options,
            solver,
            before: state.clone(),
            next: state.clone(),
            whole: state.clone(),
            start_of_part: state.clone(),
            state,
        };
        simulation.start(case, commands)?;
        Ok(simulation)
    }

    /// The state.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// The options.
    #[must_use]
    pub const fn options(&self) -> &MotionOptions {
        &self.options
    }

    /// Goes on from a state of the same robot, kept before.
    ///
    /// # Errors
    /// [`MotionError::Count`] where the state is of a robot with other elements or cables.
    pub fn set_state(&mut self, state: &State) -> Result<(), MotionError> {
        let count = |what, given, expected| {
            if given == expected { Ok(()) } else { Err(MotionError::Count { what, given, expected }) }
        };
        count("velocities of nodes", state.velocities.len(), self.rod.nodes.len())?;
        count("strains of points", state.strains.len(), self.rod.points.len())?;
        count("cables", state.cables.len(), self.rod.cables.len())?;
        count("motors", state.motor_outputs.len(), self.state.motor_outputs.len())?;
        self.state.copy_from(state);
        Ok(())
    }

    /// Arc length of each node in m.
    pub fn arc_lengths(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.rod.nodes.iter().map(|node| node.arc_length)
    }

    /// Mass in kg of each node: of backbone, disks and carried masses.
    pub fn masses(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.rod.nodes.iter().map(|node| node.mass)
    }

    /// Linear momentum in kg·m/s in the world.
    #[must_use]
    pub fn momentum(&self) -> Vec3 {
        let nodes = self.rod.nodes.iter().zip(&self.state.velocities).zip(&self.state.poses);
        nodes.fold(Vec3::ZERO, |sum, ((node, velocity), pose)| {
            sum + pose.rotation.rotate(velocity.linear) * node.mass
        })
    }

    /// Takes a step of `dt` seconds under commands. Steps are divided where commands or loads jump, where the equations cannot be solved
    /// otherwise, and to meet the tolerance.
    ///
    /// # Errors
    /// [`MotionError`]; the state is then that before the step.
    pub fn step(&mut self, commands: &Commands, dt: f64) -> Result<&State, MotionError> {
        if !(dt > 0.0 && dt.is_finite()) {
            let need = "it must be a positive time in s";
            return Err(MotionError::Option { what: "step", value: dt, need });
        }
        commands.check(&self.robot)?;
        self.before.copy_from(&self.state);
        self.state.diagnostics = Default::default();
        let end = self.state.time + dt;
        loop {
            let time = self.state.time;
            let of_commands = commands.next_jump(time, end);
            let jump = match (of_commands, self.loads.next_jump(time, end)) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
            let goal = jump.unwrap_or(end);
            if let Err(error) = self.advance(commands, goal) {
                self.state.copy_from(&self.before);
                return Err(error);
            }
            if jump.is_none() {
                return Ok(&self.state);
            }
        }
    }

    /// Goes on to a time, up to which nothing jumps.
    fn advance(&mut self, commands: &Commands, goal: f64) -> Result<(), MotionError> {
        let total = goal - self.state.time;
        if self.has_jumped(commands) {
            self.state.has_rates = false;
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
                Ok(error) if limit.is_none_or(|limit| error <= limit) => {
                    if h == left {
                        self.next.time = goal;
                    }
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
                Ok(error) if halvings >= MOST_HALVINGS => {
                    let tolerance = self.options.tolerance.unwrap_or_default();
                    return Err(MotionError::Tolerance { time: self.state.time, part: h, error, tolerance });
                }
                Err(Stalled(change)) if halvings >= MOST_HALVINGS => {
                    return Err(MotionError::NotConverged { time: self.state.time, part: h, change });
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
                let (value, before) = (self.command(commands, i, time, true), self.state.commanded[i]);
                let scale = value.abs().max(before.abs());
                // A NaN, of a cable that was not told anything, is a jump.
                !((value - before).abs() <= 1e-9 * scale)
            })
    }

    /// What a cable is told at a time: a tension in N or a shortening in m.
    fn command(&self, commands: &Commands, cable: usize, time: f64, after: bool) -> f64 {
        let at = |course: &crate::Course| if after { course.after(time) } else { course.before(time) };
        let Some((motor, course)) = commands.motor_of(&self.robot, cable) else {
            return at(commands.cables[cable].course());
        };
        let of = &self.robot.motors()[motor];
        let output = of.output(self.state.motor_outputs[motor], at(course));
        let pull = of.cables.iter().find(|of| of.cable == cable).map_or(0.0, |of| of.pull());
        pull * output
    }

    /// Whether a cable is driven by its length.
    fn is_by_length(&self, commands: &Commands, cable: usize) -> bool {
        commands.motor_of(&self.robot, cable).is_some()
            || matches!(commands.cables[cable], CableDrive::Shortening(_))
    }

    /// Takes a part of a step, into [`Self::next`]; returns its estimated error in m.
    fn attempt(&mut self, commands: &Commands, h: f64, warm: bool) -> Result<f64, Stalled> {
        self.set_lengths(commands, self.state.time + h);
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
        Ok(error)
    }

    /// Change of the strains at which the iteration of a step ends. A change of the strains in a short step is a large one of the velocities,
    /// and many short steps add up.
    fn iteration_tolerance(&self, h: f64) -> f64 {
        const USUAL: f64 = 0.01;
        const LEAST: f64 = 1e-13;
        let ratio = (h / USUAL).min(1.0);
        (self.options.iteration_tolerance * ratio * ratio).max(LEAST)
    }

    fn attempt_accurate(&mut self, commands: &Commands, h: f64, warm: bool) -> Result<f64, Stalled> {
        let ending =
            Ending { tolerance: self.iteration_tolerance(h), to_rounding: false, reuses: true };
        self.state.has_rates &= warm;
        let Self { rod, loads, solver, accurate, state, next, .. } = self;
        let tensions = |time: f64, tensions: &mut [f64]| {
            for (tension, drive) in tensions.iter_mut().zip(&commands.cables) {
                *tension = drive.course().before(time).max(0.0);
            }
        };
        let work = accurate.step(rod, loads, solver, state, h, &ending, tensions)?;
        next.velocities.copy_from_slice(&solver.stage.velocities);
        next.strains.copy_from_slice(&solver.stage.strains);
        let (velocity_rates, strain_rates) = accurate.rates();
        next.velocity_rates.copy_from_slice(velocity_rates);
        next.strain_rates.copy_from_slice(strain_rates);
        let error = if self.options.tolerance.is_some() {
            pose::nodes(rod, &next.strains, &mut solver.stage.poses);
            pose::displacement(rod, &solver.stage.poses, &accurate.error)
        } else {
            0.0
        };
        let end = self.state.time + h;
        self.finish(commands, end, &work);
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
        let to_rounding = method == Method::Energy;
        let ending = Ending { tolerance: self.iteration_tolerance(h), to_rounding, reuses: false };
        let one_step = |this: &mut Self, h: f64, warm: bool| {
            let scheme = match method {
                Method::Energy => OneStage::MIDPOINT,
                _ => OneStage::damping(RHO, this.state.has_rates),
            };
            let end = this.state.time + h;
            this.set_lengths(commands, end);
            this.set_tensions(commands, scheme.time(this.state.time, h));
            let Self { rod, loads, solver, state, next, .. } = this;
            let work = scheme.step(rod, loads, solver, state, next, h, &ending, warm)?;
            this.finish(commands, end, &work);
            Ok(())
        };
        if !estimates {
            one_step(self, h, warm)?;
            return Ok(0.0);
        }
        self.start_of_part.copy_from(&self.state);
        let outcome = self.in_halves(h, |this, h| one_step(this, h, warm));
        self.state.copy_from(&self.start_of_part);
        outcome?;
        let Self { rod, solver, accurate, next, whole, .. } = self;
        for ((error, halves), whole) in accurate.error.iter_mut().zip(&next.strains).zip(&whole.strains) {
            *error = (*halves - *whole) * (1.0 / 3.0);
        }
        pose::nodes(rod, &next.strains, &mut solver.stage.poses);
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

    /// Sets which cables are driven by their lengths, and these at a time.
    fn set_lengths(&mut self, commands: &Commands, time: f64) {
        self.solver.lengths.cables.clear();
        self.solver.lengths.targets.clear();
        for i in 0..self.rod.cables.len() {
            if self.is_by_length(commands, i) {
                let shortening = self.command(commands, i, time, false);
                self.solver.lengths.cables.push(i);
                self.solver.lengths.targets.push(self.rod.cables[i].rest_length - shortening);
            }
        }
    }

    /// Sets the tensions of the cables at a time; those of cables that are driven by their lengths start from the last ones.
    fn set_tensions(&mut self, commands: &Commands, time: f64) {
        for i in 0..self.rod.cables.len() {
            self.solver.stage.tensions[i] = if self.is_by_length(commands, i) {
                self.state.cables[i].tension
            } else {
                commands.cables[i].course().before(time).max(0.0)
            };
        }
    }

    /// Completes the state behind a step, whose velocities and strains are in [`Self::next`] and whose stage is in the solver.
    fn finish(&mut self, commands: &Commands, time: f64, work: &Power) {
        for i in 0..self.rod.cables.len() {
            let by_length = self.is_by_length(commands, i);
            let commanded = self.command(commands, i, time, false);
            let line = self.rod.cables[i];
            let length = self.rod.cable_length(i, &self.next.strains);
            let tension =
                if by_length { self.solver.stage.tensions[i] } else { commanded.max(0.0) };
            let longest = line.rest_length - commanded + line.compliance * (tension - line.pretension);
            let slack = if by_length && tension == 0.0 { (longest - length).max(0.0) } else { 0.0 };
            self.next.commanded[i] = commanded;
            self.next.cables[i] = CableMotion { tension, length, slack };
        }
        for (i, output) in self.next.motor_outputs.iter_mut().enumerate() {
            if let Some(Some(course)) = commands.motors.get(i) {
                *output = self.robot.motors()[i].output(self.state.motor_outputs[i], course.before(time));
            }
        }
        let Self { rod, loads, solver, state, next, base, .. } = self;
        let poses = &mut solver.stage.poses;
        pose::nodes(rod, &next.strains, poses);
        let parts = energies(rod, loads, &next.velocities, &next.strains, poses);
        for (out, pose) in next.poses.iter_mut().zip(&*poses) {
            *out = *base * *pose;
        }
        let energy = &mut next.energy;
        [energy.kinetic, energy.elastic, energy.gravity] = parts;
        energy.cables = state.energy.cables + work.cables;
        energy.loads = state.energy.loads + work.loads;
        energy.dissipated = state.energy.dissipated + work.dissipated;
        if next.diagnostics.method == Method::Energy {
            let back = base.rotation.conjugate();
            let ends = next.poses.iter().zip(&state.poses).zip(&solver.stage.loads);
            energy.loads += ends
                .map(|((to, from), load)| load.force.dot(back.rotate(to.position - from.position)))
                .sum::<f64>();
        }
        next.time = time;
        next.has_rates = true;
    }

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
        equilibrium::add_loads(&mut statics.loads, &self.options.loads, self.rod.length)?;
        Ok(statics)
    }

    /// Sets the state at the start.
    fn start(&mut self, case: &Case, commands: &Commands) -> Result<(), MotionError> {
        if self.options.initial == Initial::Equilibrium {
            self.set_lengths(commands, 0.0);
            self.set_tensions(commands, 0.0);
            let statics = self.statics(case, commands)?;
            let Self { robot, rod, loads, solver, .. } = self;
            equilibrium::find(robot, &statics, rod, loads, solver)?;
        } else {
            self.solver.stage.tensions.fill(0.0);
        }
        self.next.strains.copy_from_slice(&self.solver.stage.strains);
        let is_rest = self.options.initial == Initial::Rest;
        self.finish(commands, 0.0, &Power::default());
        self.next.has_rates = false;
        let energy = &mut self.next.energy;
        energy.initial = energy.total();
        (energy.loads, energy.cables) = (0.0, 0.0);
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
