//! The motion of a robot, step by step.

use whipcord::{CableCommand, Case, Loads, Robot, Shortening};
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::accurate::Accurate;
use crate::commands::Commands;
use crate::drives::Drives;
use crate::energy::Power;
use crate::equilibrium;
use crate::error::{MotionError, count};
use crate::friction::Friction;
use crate::iteration::{Mechanics, Solver};
use crate::loads::NodeLoads;
use crate::options::{Initial, MotionOptions, Start, StartRates};
use crate::pose;
use crate::rod::Rod;
use crate::state::{CableMotion, MotorMotion, State};
use crate::surroundings::Surroundings;

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
/// assert!(state.energy.dissipated > 0.0 && state.energy.dissipated < state.energy.cables);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Simulation {
    pub(crate) robot: Robot,
    pub(crate) rod: Rod,
    pub(crate) loads: NodeLoads,
    pub(crate) base: Pose,
    pub(crate) options: MotionOptions,
    pub(crate) solver: Solver,
    pub(crate) accurate: Accurate,
    pub(crate) state: State,
    /// The state before a step, to return to.
    pub(crate) before: State,
    /// The state behind a part of a step.
    pub(crate) next: State,
    /// The state behind a whole step that is repeated in halves, to estimate its error.
    pub(crate) whole: State,
    /// The state before these.
    pub(crate) start_of_part: State,
    /// The cables that are driven by their lengths in the equilibrium to start from.
    pub(crate) start_lengths: Vec<usize>,
    /// The motors with inertia in that equilibrium.
    pub(crate) start_drives: Drives,
}

impl Simulation {
    /// Prepares the motion of a robot from the commands, loads and base of a case: constant commands, until [`Self::step`] is given others.
    ///
    /// # Errors
    /// [`MotionError`] where the case does not fit the robot, the robot has no mass or no stiffness, a part of robot or case has no dynamics
    /// here (friction of the backbone, movable objects), or there is no equilibrium to start from.
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
        for of in &options.loads {
            let with_loads = Case { loads: of.loads.clone(), ..case.clone() };
            with_loads.check(robot)?;
        }
        let all: Vec<_> =
            core::iter::once(&case.loads).chain(options.loads.iter().map(|of| &of.loads)).collect();
        let rod = Rod::new(robot, &all, &options)?;
        let loads = NodeLoads::new(&rod, case, &options);
        let drag = Vec3::new(options.drag.across, options.drag.across, options.drag.along);
        let surroundings = Surroundings::new(robot, &rod, case)?;
        if options.has_free_base && surroundings.is_some() {
            return Err(MotionError::Unsupported {
                path: "motion.base.free".to_owned(),
                what: "a free base among obstacles",
                advice: "remove the obstacles, or hold the base",
            });
        }
        let friction = Friction::new(robot, &rod);
        let holes = friction.as_ref().map(|friction| friction.holes.memory()).unwrap_or_default();
        let mut first_passages = Vec::new();
        if friction.is_some() {
            first_passages.clone_from(&rod.first_passages);
            first_passages.push(rod.cables_of_passages().len());
        }
        let solver = Solver::new(&rod, Drives::new(robot), drag, surroundings, friction);
        let mut solver = solver;
        solver.stage.matrix.hold_base(!options.has_free_base);
        let state = State {
            velocities: vec![Twist::default(); rod.nodes.len()],
            strains: rod.points.iter().map(|point| point.rest).collect(),
            velocity_rates: vec![Twist::default(); rod.nodes.len()],
            strain_rates: vec![Twist::default(); rod.points.len()],
            poses: vec![Pose::IDENTITY; rod.nodes.len()],
            cables: vec![CableMotion::default(); rod.cables.len()],
            holes,
            first_passages,
            motor_outputs: vec![0.0; robot.motors().len()],
            motors: vec![MotorMotion::default(); robot.motors().len()],
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
            start_lengths: Vec::new(),
            start_drives: Drives::default(),
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
        count("velocities of nodes", state.velocities.len(), self.rod.nodes.len())?;
        count("strains of points", state.strains.len(), self.rod.points.len())?;
        count("cables", state.cables.len(), self.rod.cables.len())?;
        count("motors", state.motor_outputs.len(), self.state.motor_outputs.len())?;
        count("motors", state.motors.len(), self.state.motors.len())?;
        let passages = |of: &State| of.holes.tensions.len();
        count("passages of cables", passages(state), passages(&self.state))?;
        self.state.copy_from(state);
        Ok(())
    }

    /// Has other forces and moments act from now on, in place of those of the case; gravity and masses stay, and so do the loads over time of the
    /// options. Point loads act on the nearest node; there are nodes at the tip, the disks and the places of the loads that the simulation was made with.
    ///
    /// # Errors
    /// [`MotionError`] for loads that cannot be, and for gravity and masses.
    pub fn set_loads(&mut self, loads: &Loads) -> Result<(), MotionError> {
        if loads.gravity.is_some() || !loads.masses.is_empty() {
            return Err(MotionError::Unsupported {
                path: "loads".to_owned(),
                what: "gravity or masses that change during the motion",
                advice: "give gravity and masses in the loads of the case",
            });
        }
        let still = Case::with_tensions(&vec![0.0; self.robot.cables().len()]);
        let case = Case { base: self.base, loads: loads.clone(), ..still };
        case.check(&self.robot)?;
        self.loads.set_constant(&self.rod, loads, self.base.rotation);
        self.state.has_rates = false;
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

    /// Takes a step of `dt` seconds under commands. Steps are divided where commands or loads jump, where the equations cannot be solved
    /// otherwise, and to meet the tolerance.
    ///
    /// # Errors
    /// [`MotionError`]; the state is then that before the step.
    pub fn step(&mut self, commands: &Commands, dt: f64) -> Result<&State, MotionError> {
        self.step_in_parts(commands, dt, &mut |_, _, _| ())
    }

    /// The same; `taken` gets the state before each part of the step, its length and whether its iteration began with a prediction.
    pub(crate) fn step_in_parts(
        &mut self,
        commands: &Commands,
        dt: f64,
        taken: &mut dyn FnMut(&State, f64, bool),
    ) -> Result<&State, MotionError> {
        if !(dt > 0.0 && dt.is_finite()) {
            let need = "it must be a positive time in s";
            return Err(MotionError::Option { what: "step", value: dt, need });
        }
        commands.check(&self.robot)?;
        self.before.copy_from(&self.state);
        self.state.diagnostics = Default::default();
        (self.state.impacts, self.state.changes) = (0, 0);
        let end = self.state.time + dt;
        loop {
            let time = self.state.time;
            let of_commands = commands.next_jump(time, end);
            let jump = match (of_commands, self.loads.next_jump(time, end)) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
            let goal = jump.unwrap_or(end);
            if let Err(error) = self.advance(commands, goal, taken) {
                self.state.copy_from(&self.before);
                return Err(error);
            }
            if jump.is_none() {
                return Ok(&self.state);
            }
        }
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
    fn start(&mut self, case: &Case, commands: &Commands) -> Result<(), MotionError> {
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
