//! Gradients over a motion, section "Gradients" of the page on motion: the stages of its steps backwards, each by its transposed linearisation.

use whipcord::Wrench;
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::accurate;
use crate::adjoint::{Factors, StageAdjoint};
use crate::coefficients::OneStage;
use crate::commands::Commands;
use crate::error::{MotionError, count};
use crate::iteration::Mechanics;
use crate::options::{Initial, Method};
use crate::parts::RHO;
use crate::pose;
use crate::scheme::Scheme;
use crate::simulation::Simulation;
use crate::state::State;

/// A motion in steps, with what its gradients need.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The state at the start, then one behind each step.
    pub states: Vec<State>,
    /// The commands of each step.
    commands: Vec<Commands>,
    /// The parts that each step was taken in.
    parts: Vec<Vec<Part>>,
    /// Whether the motion starts in the equilibrium of its simulation.
    from_equilibrium: bool,
}

/// A part of a step.
#[derive(Clone, Debug)]
struct Part {
    before: State,
    length: f64,
    warm: bool,
}

/// Derivatives of a number by a state of a motion. An empty list stands for zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seed {
    /// By the position of each node in the world.
    pub positions: Vec<Vec3>,
    /// By the orientation of each node: by turns in rad about the axes of the world.
    pub turns: Vec<Vec3>,
    /// By the velocity of each node in its frame.
    pub velocities: Vec<Twist>,
    /// By the strains.
    pub strains: Vec<Twist>,
}

/// Derivatives of the same number by what made the motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gradient {
    /// By the command of each cable in each step, a tension in N or a shortening in m: by what is added to it throughout the step. Zero where a motor
    /// drives the cable.
    pub cables: Vec<Vec<f64>>,
    /// The same of each motor, by rad or m.
    pub motors: Vec<Vec<f64>>,
    /// By the velocities at the start, of each node in its frame.
    pub velocities: Vec<Twist>,
    /// By the strains at the start; zero where the motion starts in equilibrium, which follows from all else.
    pub strains: Vec<Twist>,
    /// By factors on stiffness, damping and mass of the robot, the equilibrium to start from included.
    pub factors: Factors,
}

/// Derivatives by a state and its rates, on their way back.
struct Costate {
    velocities: Vec<Twist>,
    strains: Vec<Twist>,
    velocity_rates: Vec<Twist>,
    strain_rates: Vec<Twist>,
    /// By what each motor's drive has moved.
    outputs: Vec<f64>,
    /// By the tension of each cable.
    tensions: Vec<f64>,
}

impl Simulation {
    /// Takes a step of `dt` seconds under each of these commands, and keeps what [`Self::gradient`] needs.
    ///
    /// # Errors
    /// [`MotionError`] of the first step that fails; [`MotionError::Unsupported`] for what has no gradients: the method `energy`, and a tolerance
    /// of steps that are not taken by `accurate`.
    pub fn record(&mut self, commands: &[Commands], dt: f64) -> Result<Record, MotionError> {
        if self.options.method == Method::Energy {
            return Err(MotionError::Unsupported {
                path: "motion.method".to_owned(),
                what: "gradients over a motion by the method `energy`",
                advice: "use the method `accurate` or `robust`",
            });
        }
        if self.solver.friction.is_some() {
            return Err(MotionError::Unsupported {
                path: "cables.friction".to_owned(),
                what: "gradients over a motion with friction of cables",
                advice: "leave the friction out, or use differences",
            });
        }
        if self.options.has_free_base {
            return Err(MotionError::Unsupported {
                path: "motion.base".to_owned(),
                what: "gradients over a motion with a free base",
                advice: "hold the base, or use differences",
            });
        }
        let touches = |state: &State| !state.contacts.is_empty() || state.impacts > 0;
        if touches(&self.state) {
            return Err(MotionError::NotSmooth { time: self.state.time });
        }
        let is_equilibrium = self.options.initial == Initial::Equilibrium;
        let mut record = Record {
            states: vec![self.state.clone()],
            commands: commands.to_vec(),
            parts: Vec::with_capacity(commands.len()),
            from_equilibrium: is_equilibrium && self.state.time == 0.0,
        };
        for commands in commands {
            let moves = |i: usize| self.moving_motor(commands, i).is_some();
            if (0..self.rod.cables.len()).any(moves) {
                return Err(MotionError::Unsupported {
                    path: "motors.inertia".to_owned(),
                    what: "gradients over a motion with a motor that has inertia",
                    advice: "leave out the inertia and the gains of the motor, or use differences",
                });
            }
            let by_length = (0..self.rod.cables.len()).any(|i| self.is_by_length(commands, i));
            let is_halved = by_length || self.options.method != Method::Accurate;
            if is_halved && self.options.tolerance.is_some() {
                return Err(MotionError::Unsupported {
                    path: "motion.tolerance".to_owned(),
                    what: "gradients over steps that are divided to meet a tolerance",
                    advice: "leave out the tolerance and take shorter steps",
                });
            }
            let mut parts = Vec::new();
            self.step_in_parts(commands, dt, &mut |before, length, warm| {
                parts.push(Part { before: before.clone(), length, warm });
            })?;
            if touches(&self.state) || parts.iter().any(|part| touches(&part.before)) {
                return Err(MotionError::NotSmooth { time: self.state.time });
            }
            record.parts.push(parts);
            record.states.push(self.state.clone());
        }
        Ok(record)
    }

    /// Derivatives of a number by commands, start and properties of the robot, from those by the states of a recorded motion: one seed for each state.
    /// The state of the simulation stays what it is.
    ///
    /// # Errors
    /// [`MotionError::Count`] where seeds do not fit the record, [`MotionError::NoGradient`] where the linearisation of a step is singular.
    pub fn gradient(&mut self, record: &Record, seeds: &[Seed]) -> Result<Gradient, MotionError> {
        count("seeds of states", seeds.len(), record.states.len())?;
        for seed in seeds {
            self.check_seed(seed)?;
        }
        let kept = self.state.clone();
        let found = self.backwards(record, seeds);
        self.state.copy_from(&kept);
        found
    }

    fn check_seed(&self, seed: &Seed) -> Result<(), MotionError> {
        let (nodes, points) = (self.rod.nodes.len(), self.rod.points.len());
        for (what, given, expected) in [
            ("positions of a seed", seed.positions.len(), nodes),
            ("turns of a seed", seed.turns.len(), nodes),
            ("velocities of a seed", seed.velocities.len(), nodes),
            ("strains of a seed", seed.strains.len(), points),
        ] {
            if given != 0 {
                count(what, given, expected)?;
            }
        }
        Ok(())
    }

    fn backwards(&mut self, record: &Record, seeds: &[Seed]) -> Result<Gradient, MotionError> {
        let (nodes, points) = (self.rod.nodes.len(), self.rod.points.len());
        let (cables, motors) = (self.rod.cables.len(), self.robot.motors().len());
        let list = |n: usize| vec![Twist::default(); n];
        let mut costate = Costate {
            velocities: list(nodes),
            strains: list(points),
            velocity_rates: list(nodes),
            strain_rates: list(points),
            outputs: vec![0.0; motors],
            tensions: vec![0.0; cables],
        };
        let mut adjoint = StageAdjoint::new(&self.rod);
        let mut gradient = Gradient::default();
        for (k, parts) in record.parts.iter().enumerate().rev() {
            self.seed(&mut costate, &seeds[k + 1], &record.states[k + 1]);
            let mut step = vec![0.0; cables];
            let mut of_motors = vec![0.0; motors];
            for part in parts.iter().rev() {
                let commands = &record.commands[k];
                self.part_backwards(
                    (commands, part),
                    &mut adjoint,
                    &mut costate,
                    &mut gradient.factors,
                    (&mut step, &mut of_motors),
                )?;
            }
            gradient.cables.push(step);
            gradient.motors.push(of_motors);
        }
        gradient.cables.reverse();
        gradient.motors.reverse();
        if let (Some(seed), Some(start)) = (seeds.first(), record.states.first()) {
            self.seed(&mut costate, seed, start);
        }
        if record.from_equilibrium
            && let Some(start) = record.states.first()
        {
            self.equilibrium_backwards(start, &mut adjoint, &mut costate, &mut gradient.factors)?;
        }
        costate.velocities[0] = Twist::default();
        gradient.velocities = costate.velocities;
        gradient.strains = costate.strains;
        Ok(gradient)
    }

    /// Adds the derivatives by a state.
    fn seed(&mut self, costate: &mut Costate, seed: &Seed, state: &State) {
        for (of, by) in costate.velocities.iter_mut().zip(&seed.velocities) {
            *of = *of + *by;
        }
        for (of, by) in costate.strains.iter_mut().zip(&seed.strains) {
            *of = *of + *by;
        }
        if seed.positions.is_empty() && seed.turns.is_empty() {
            return;
        }
        let Self { rod, solver, base, .. } = self;
        let stage = &mut solver.stage;
        pose::nodes(rod, state.base, &state.strains, &mut stage.poses);
        let back = base.rotation.conjugate();
        let of = |list: &[Vec3], a: usize| list.get(a).map_or(Vec3::ZERO, |of| back.rotate(*of));
        let wrench =
            |a: usize| Wrench { force: of(&seed.positions, a), moment: of(&seed.turns, a) };
        pose::work_gradient(rod, &state.strains, &stage.poses, wrench, &mut stage.potential);
        for (of, by) in costate.strains.iter_mut().zip(&stage.potential) {
            *of = *of + *by;
        }
    }

    fn part_backwards(
        &mut self,
        (commands, part): (&Commands, &Part),
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        (cables, motors): (&mut [f64], &mut [f64]),
    ) -> Result<(), MotionError> {
        let fails = |_| MotionError::NoGradient { time: part.before.time };
        self.state.copy_from(&part.before);
        // The part once more, for what its stages have found.
        self.attempt(commands, part.length, part.warm)
            .map_err(|_| MotionError::NoGradient { time: part.before.time })?;
        // A cable that is driven by its tension ends the step with its command.
        let mut by_cable = vec![0.0; cables.len()];
        for i in 0..cables.len() {
            if !self.is_by_length(commands, i) {
                by_cable[i] = core::mem::take(&mut costate.tensions[i]);
            }
        }
        match self.next.diagnostics.method {
            Method::Accurate => {
                self.stages_backwards(commands, part, adjoint, costate, factors, &mut by_cable)
            }
            _ => self.one_stage_backwards(part, adjoint, costate, factors, &mut by_cable),
        }
        .map_err(fails)?;
        for (i, value) in by_cable.into_iter().enumerate() {
            // A length is what the cable has at rest less its shortening.
            let value = if self.is_by_length(commands, i) { -value } else { value };
            match commands.motor_of(&self.robot, i) {
                None => cables[i] += value,
                Some((motor, _)) => costate.outputs[motor] += self.pull(motor, i) * value,
            }
        }
        for (motor, output) in costate.outputs.iter_mut().enumerate() {
            let Some(Some(course)) = commands.motors.get(motor) else { continue };
            let of = &self.robot.motors()[motor];
            let before = part.before.motor_outputs[motor];
            let command = course.before(part.before.time + part.length);
            // Within its play the drive stays where it was.
            if of.backlash == 0.0 || of.output(before, command) != before {
                motors[motor] += *output / of.gear_ratio();
                *output = 0.0;
            }
        }
        Ok(())
    }

    /// The stages of `accurate`.
    fn stages_backwards(
        &mut self,
        commands: &Commands,
        part: &Part,
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        cables: &mut [f64],
    ) -> Result<(), crate::adjoint::NotSolved> {
        let Self { rod, loads, solver, accurate, .. } = self;
        let (from, h) = (&part.before, part.length);
        let scheme = Scheme::at_end(accurate::GAMMA * h);
        let inverse = 1.0 / scheme.g;
        let mut velocity_rates: [Vec<Twist>; accurate::STAGES] = Default::default();
        let mut strain_rates = velocity_rates.clone();
        for i in 0..accurate::STAGES {
            velocity_rates[i] = vec![Twist::default(); rod.nodes.len()];
            strain_rates[i] = vec![Twist::default(); rod.points.len()];
        }
        // The rates at the end are those of the last stage.
        velocity_rates[accurate::STAGES - 1] = core::mem::take(&mut costate.velocity_rates);
        strain_rates[accurate::STAGES - 1] = core::mem::take(&mut costate.strain_rates);
        let (mut velocities, mut strains) =
            (core::mem::take(&mut costate.velocities), core::mem::take(&mut costate.strains));
        let mut start_velocities = vec![Twist::default(); rod.nodes.len()];
        let mut start_strains = vec![Twist::default(); rod.points.len()];
        for i in (0..accurate::STAGES).rev() {
            let time = from.time + accurate::C[i] * h;
            let stage = &mut solver.stage;
            accurate.stage(i, from, h, stage);
            commands.tensions_at(time, &mut stage.tensions);
            loads.at(time, &mut stage.loads);
            stage.move_base(loads, from.base, from.time, accurate::C[i] * h);
            add(&mut velocities, &velocity_rates[i], inverse);
            add(&mut strains, &strain_rates[i], inverse);
            adjoint.velocities = velocities;
            adjoint.strains = strains;
            adjoint.pull_back(Mechanics { rod, loads }, solver, &scheme, factors)?;
            add(&mut adjoint.velocities, &velocity_rates[i], -inverse);
            add(&mut adjoint.strains, &strain_rates[i], -inverse);
            add(&mut start_velocities, &adjoint.velocities, 1.0);
            add(&mut start_strains, &adjoint.strains, 1.0);
            for j in 0..i {
                add(&mut velocity_rates[j], &adjoint.velocities, h * accurate::A[i][j]);
                add(&mut strain_rates[j], &adjoint.strains, h * accurate::A[i][j]);
            }
            for (of, by) in cables.iter_mut().zip(&adjoint.cables) {
                *of += by;
            }
            velocities = vec![Twist::default(); rod.nodes.len()];
            strains = vec![Twist::default(); rod.points.len()];
        }
        *costate = Costate {
            velocities: start_velocities,
            strains: start_strains,
            velocity_rates: velocities,
            strain_rates: strains,
            outputs: core::mem::take(&mut costate.outputs),
            tensions: core::mem::take(&mut costate.tensions),
        };
        Ok(())
    }

    /// The stage of `robust`, which the solver has solved.
    fn one_stage_backwards(
        &mut self,
        part: &Part,
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
        cables: &mut [f64],
    ) -> Result<(), crate::adjoint::NotSolved> {
        let Self { rod, loads, solver, .. } = self;
        let method = OneStage::damping(RHO, &part.before, part.length);
        let scheme = method.scheme(part.length);
        let back = method.backwards(&scheme, part.length);
        let stage_of = |end: &[Twist], rates: &[Twist]| {
            let mut out = vec![Twist::default(); end.len()];
            add(&mut out, end, back.stage_by_end);
            add(&mut out, rates, back.stage_by_rate);
            out
        };
        let start_of = |end: &[Twist], rates: &[Twist], history: &[Twist]| {
            let mut out = history.to_vec();
            add(&mut out, rates, -back.stage_by_rate);
            let mut of_rates = vec![Twist::default(); end.len()];
            add(&mut of_rates, &out, back.carried);
            add(&mut of_rates, rates, back.rate_by_rate);
            add(&mut out, end, 1.0 - back.stage_by_end);
            (out, of_rates)
        };
        adjoint.velocities = stage_of(&costate.velocities, &costate.velocity_rates);
        adjoint.strains = stage_of(&costate.strains, &costate.strain_rates);
        adjoint.tensions = core::mem::take(&mut costate.tensions);
        adjoint.pull_back(Mechanics { rod, loads }, solver, &scheme, factors)?;
        let (velocities, velocity_rates) =
            start_of(&costate.velocities, &costate.velocity_rates, &adjoint.velocities);
        let (mut strains, strain_rates) =
            start_of(&costate.strains, &costate.strain_rates, &adjoint.strains);
        add(&mut strains, &adjoint.start, 1.0);
        for (of, by) in cables.iter_mut().zip(&adjoint.cables) {
            *of += by;
        }
        let outputs = core::mem::take(&mut costate.outputs);
        let tensions = adjoint.tensions.clone();
        *costate = Costate { velocities, strains, velocity_rates, strain_rates, outputs, tensions };
        Ok(())
    }

    /// The equilibrium that the motion starts from, by the factors.
    fn equilibrium_backwards(
        &mut self,
        start: &State,
        adjoint: &mut StageAdjoint,
        costate: &mut Costate,
        factors: &mut Factors,
    ) -> Result<(), MotionError> {
        let Self { rod, loads, solver, .. } = self;
        let stage = &mut solver.stage;
        stage.strains.copy_from_slice(&start.strains);
        stage.start.copy_from_slice(&start.strains);
        stage.strain_history.copy_from_slice(&start.strains);
        stage.velocities.fill(Twist::default());
        stage.velocity_history.fill(Twist::default());
        stage.base = Pose::IDENTITY;
        for (tension, cable) in stage.tensions.iter_mut().zip(&start.cables) {
            *tension = cable.tension;
        }
        solver.lengths.cables.clear();
        solver.lengths.cables.extend_from_slice(&self.start_lengths);
        loads.at(0.0, &mut solver.stage.loads);
        adjoint.velocities.fill(Twist::default());
        adjoint.strains = core::mem::take(&mut costate.strains);
        adjoint.tensions = core::mem::take(&mut costate.tensions);
        adjoint
            .pull_back(Mechanics { rod, loads }, solver, &Scheme::STATICS, factors)
            .map_err(|_| MotionError::NoGradient { time: start.time })?;
        costate.strains = vec![Twist::default(); rod.points.len()];
        Ok(())
    }
}

/// `out += factor by`.
fn add(out: &mut [Twist], by: &[Twist], factor: f64) {
    for (out, by) in out.iter_mut().zip(by) {
        *out = *out + *by * factor;
    }
}
