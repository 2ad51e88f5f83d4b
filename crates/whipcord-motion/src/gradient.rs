//! Gradients over a motion, section "Gradients" of the page on motion: what is recorded of it, and the way back over its steps.

use whipcord::Wrench;
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::accurate;
use crate::adjoint::{Factors, NotSolved, StageAdjoint};
use crate::block::add;
use crate::coefficients::OneStage;
use crate::commands::{CableDrive, Commands};
use crate::drives::MotorValues;
use crate::error::{MotionError, count};
use crate::free_base::{BaseTangent, FreeBase};
use crate::impact::touches;
use crate::options::{Initial, Method};
use crate::part::{Impact, Taken};
use crate::parts::RHO;
use crate::pose;
use crate::rod::Rod;
use crate::simulation::Simulation;
use crate::state::State;

/// A motion in steps, with what its gradients need.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The state at the start, then one behind each step.
    pub states: Vec<State>,
    /// The commands of each step.
    pub(crate) commands: Vec<Commands>,
    /// The parts that each step was taken in.
    pub(crate) parts: Vec<Vec<Part>>,
    /// Whether the motion starts in the equilibrium of its simulation.
    pub(crate) from_equilibrium: bool,
    /// Steps at whose end something is about to change its case.
    pub(crate) one_sided: Vec<usize>,
}

impl Record {
    /// The steps, from zero on, whose derivatives are those of one side: a hole of a cable with friction is between sticking and sliding there, or a contact between open and closed or
    /// between sticking and sliding, or two parts of the robot hit an obstacle at once.
    #[must_use]
    pub fn one_sided(&self) -> &[usize] {
        &self.one_sided
    }

    /// Whether the state at the start is held for the derivatives by factors. That is so for an equilibrium that depends on the way to it: with taut cables that have friction, or in
    /// contact with an obstacle.
    #[must_use]
    pub fn holds_start(&self) -> bool {
        let depends = |start: &State| {
            let is_taut = start.holes.tensions.iter().any(|tension| *tension > 0.0);
            is_taut || !start.contacts.is_empty()
        };
        self.from_equilibrium && self.states.first().is_some_and(depends)
    }

    /// Whether what the motion starts from follows from the factors.
    pub(crate) fn start_follows(&self) -> bool {
        self.from_equilibrium && !self.holds_start()
    }
}

/// A part of a step.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub before: State,
    pub length: f64,
    pub warm: bool,
    /// Whether it is, or its impact was looked for in, all that was left of the step.
    pub is_rest: bool,
    pub is_frictionless: bool,
    /// The impact that it ends in.
    pub impact: Option<Impact>,
}

/// How much later a part of a step begins and how much longer it is, or derivatives by both.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shift {
    pub start: f64,
    pub length: f64,
}

impl Shift {
    /// How much later a place of the part is, from 0 at its start to 1 at its end.
    pub fn at(&self, place: f64) -> f64 {
        self.start + place * self.length
    }

    /// Adds a derivative by the time of a place.
    pub fn add(&mut self, place: f64, by: f64) {
        self.start += by;
        self.length += place * by;
    }
}

impl Part {
    fn new(of: &Taken<'_>) -> Self {
        Self {
            before: of.before.clone(),
            length: of.length,
            warm: of.is_warm,
            is_rest: of.is_rest,
            is_frictionless: of.is_frictionless,
            impact: of.impact.clone(),
        }
    }

    /// The coefficients of a method with one stage.
    pub fn method(&self, method: Method) -> OneStage {
        match method {
            Method::Energy => OneStage::MIDPOINT,
            _ => OneStage::damping(RHO, &self.before, self.length),
        }
    }
}

/// Rate in N/s of the tension that a cable is driven by; zero where it is told none or none that pulls.
pub(crate) fn tension_slope(commands: &Commands, cable: usize, time: f64) -> f64 {
    match &commands.cables[cable] {
        CableDrive::Tension(course) if course.before(time) > 0.0 => course.slope_before(time),
        _ => 0.0,
    }
}

/// Rate of the command of a motor.
pub(crate) fn motor_slope(commands: &Commands, motor: usize, time: f64) -> f64 {
    let course = commands.motors.get(motor).and_then(Option::as_ref);
    course.map_or(0.0, |course| course.slope_before(time))
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

/// Derivatives by a state and its rates on their way back, or changes of these on their way forward.
#[derive(Clone, Debug)]
pub(crate) struct Costate {
    pub velocities: Vec<Twist>,
    pub strains: Vec<Twist>,
    pub velocity_rates: Vec<Twist>,
    pub strain_rates: Vec<Twist>,
    /// Of what each motor's drive has moved.
    pub outputs: Vec<f64>,
    /// Of the tension of each cable.
    pub tensions: Vec<f64>,
    /// Of each motor with inertia.
    pub motors: Vec<MotorValues>,
    /// Of displacements of a free base along and about its own axes.
    pub base: Twist,
    /// Of the unstretched length beyond the near hole of each passage of cables with friction.
    pub beyond: Vec<f64>,
    /// Of the time.
    pub time: f64,
}

impl Costate {
    /// Nothing.
    pub fn new(rod: &Rod, motors: usize, passages: usize) -> Self {
        let list = |n: usize| vec![Twist::default(); n];
        let (nodes, points) = (rod.nodes.len(), rod.points.len());
        Self {
            velocities: list(nodes),
            strains: list(points),
            velocity_rates: list(nodes),
            strain_rates: list(points),
            outputs: vec![0.0; motors],
            tensions: vec![0.0; rod.cables.len()],
            motors: vec![MotorValues::default(); motors],
            base: Twist::default(),
            beyond: vec![0.0; passages],
            time: 0.0,
        }
    }

    /// Adds another one.
    pub fn add(&mut self, other: &Self) {
        add(&mut self.velocities, &other.velocities, 1.0);
        add(&mut self.strains, &other.strains, 1.0);
        add(&mut self.velocity_rates, &other.velocity_rates, 1.0);
        add(&mut self.strain_rates, &other.strain_rates, 1.0);
        let scalars = [
            (&mut self.outputs, &other.outputs),
            (&mut self.tensions, &other.tensions),
            (&mut self.beyond, &other.beyond),
        ];
        for (of, by) in scalars {
            of.iter_mut().zip(by).for_each(|(of, by)| *of += by);
        }
        let motors = self.motors.as_flattened_mut().iter_mut().zip(other.motors.as_flattened());
        motors.for_each(|(of, by)| *of += by);
        self.base = self.base + other.base;
        self.time += other.time;
    }
}

impl Simulation {
    /// Takes a step of `dt` seconds under each of these commands, and keeps what [`Self::gradient`] needs.
    ///
    /// # Errors
    /// [`MotionError`] of the first step that fails; [`MotionError::Unsupported`] for what has no gradients: a tolerance
    /// of steps that are not taken by `accurate`.
    pub fn record(&mut self, commands: &[Commands], dt: f64) -> Result<Record, MotionError> {
        let is_equilibrium = self.options.initial == Initial::Equilibrium;
        let mut record = Record {
            states: vec![self.state.clone()],
            commands: commands.to_vec(),
            parts: Vec::with_capacity(commands.len()),
            from_equilibrium: is_equilibrium && self.state.time == 0.0,
            one_sided: Vec::new(),
        };
        for (k, commands) in commands.iter().enumerate() {
            let by_length = (0..self.rod.cables.len()).any(|i| self.is_by_length(commands, i));
            let is_halved = by_length
                || self.solver.friction.is_some()
                || self.options.method != Method::Accurate;
            if is_halved && self.options.tolerance.is_some() {
                return Err(MotionError::Unsupported {
                    path: "motion.tolerance".to_owned(),
                    what: "gradients over steps that are divided to meet a tolerance",
                    advice: "leave out the tolerance and take shorter steps",
                });
            }
            let mut parts = Vec::new();
            self.step_in_parts(commands, dt, &mut |taken| parts.push(Part::new(taken)))?;
            if self.state.changes > 0 {
                record.one_sided.push(k);
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
    /// [`MotionError::Count`] where seeds do not fit the record, [`MotionError::NoGradient`] where the linearisation of a step is singular,
    /// [`MotionError::NotSmooth`] where the robot grazes an obstacle.
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
        let (cables, motors) = (self.rod.cables.len(), self.robot.motors().len());
        let mut costate = self.costate();
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
        if record.start_follows()
            && let Some(start) = record.states.first()
        {
            self.equilibrium_backwards(start, &mut adjoint, &mut costate, &mut gradient.factors)?;
        } else if record.from_equilibrium {
            costate.strains.fill(Twist::default());
        }
        if !self.loads.has_free_base {
            costate.velocities[0] = Twist::default();
        }
        gradient.velocities = costate.velocities;
        gradient.strains = costate.strains;
        Ok(gradient)
    }

    /// Nothing.
    pub(crate) fn costate(&self) -> Costate {
        Costate::new(&self.rod, self.robot.motors().len(), self.state.holes.tensions.len())
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
        let Self { rod, solver, base, loads, .. } = &mut *self;
        let stage = &mut solver.stage;
        pose::nodes(rod, state.base, &state.strains, &mut stage.poses);
        let back = base.rotation.conjugate();
        let of = |list: &[Vec3], a: usize| list.get(a).map_or(Vec3::ZERO, |of| back.rotate(*of));
        let wrench =
            |a: usize| Wrench { force: of(&seed.positions, a), moment: of(&seed.turns, a) };
        pose::work_gradient(rod, &state.strains, &stage.poses, wrench, &mut stage.potential);
        if loads.has_free_base {
            let (mut force, mut moment) = (Vec3::ZERO, Vec3::ZERO);
            for (a, pose) in stage.poses.iter().enumerate() {
                let of_node = wrench(a);
                force += of_node.force;
                let arm = pose.position - state.base.position;
                moment += of_node.moment + arm.cross(of_node.force);
            }
            let turn = state.base.rotation.conjugate();
            let of_base = Twist { linear: turn.rotate(force), angular: turn.rotate(moment) };
            costate.base = costate.base + of_base;
        }
        for (of, by) in costate.strains.iter_mut().zip(&stage.potential) {
            *of = *of + *by;
        }
    }

    /// Takes a part once more, for what its stages have found; up to a round of its contacts.
    pub(crate) fn repeat(
        &mut self,
        commands: &Commands,
        part: &Part,
        last_round: Option<usize>,
    ) -> Result<(), MotionError> {
        self.state.copy_from(&part.before);
        self.solver.contacts.last_round = last_round;
        self.solver.contacts.is_frictionless = part.is_frictionless;
        let method = self.begin_part(commands, part.length);
        let (h, warm) = (part.length, part.warm);
        self.solver.contacts.clear();
        let outcome = match &part.impact {
            Some(impact) => self.take_to_impact(commands, impact, h, warm),
            None if touches(&part.before) && self.solver.contacts.surroundings.is_some() => {
                self.attempt_by(commands, Method::Robust, h, warm, true)
            }
            None => self.attempt_by(commands, method, h, warm, false),
        };
        self.solver.contacts.is_frictionless = false;
        self.solver.contacts.last_round = None;
        outcome.map(|_| ()).map_err(|_| MotionError::NoGradient { time: part.before.time })
    }

    /// Whether the drive of a motor without inertia goes with its command in a part: within its play it stays where it was.
    pub(crate) fn drive_moves(&self, commands: &Commands, part: &Part, motor: usize) -> bool {
        let Some(Some(course)) = commands.motors.get(motor) else { return false };
        let of = &self.robot.motors()[motor];
        let before = part.before.motor_outputs[motor];
        let command = course.before(part.before.time + part.length);
        of.dynamics.is_none() && (of.backlash == 0.0 || of.output(before, command) != before)
    }

    /// Puts a stage of the part by `accurate` that was taken last into the solver; how a free base changes there.
    pub(crate) fn put_stage(
        &mut self,
        commands: &Commands,
        part: &Part,
        i: usize,
    ) -> Result<Option<BaseTangent>, NotSolved> {
        let Self { loads, solver, accurate, .. } = self;
        let (from, h, stage) = (&part.before, part.length, &mut solver.stage);
        let time = from.time + accurate::C[i] * h;
        accurate.stage(i, from, h, stage);
        commands.tensions_at(time, &mut stage.tensions);
        loads.at(time, &mut stage.loads);
        if loads.has_free_base {
            return accurate.base_tangent(i, from, h, stage).map(Some).ok_or(NotSolved);
        }
        stage.move_base(loads, from.base, from.time, accurate::C[i] * h);
        Ok(None)
    }

    /// Puts the equilibrium to start from into the solver, its base held.
    pub(crate) fn put_equilibrium(&mut self, start: &State) {
        let Self { loads, solver, .. } = self;
        let stage = &mut solver.stage;
        stage.strains.copy_from_slice(&start.strains);
        stage.start.copy_from_slice(&start.strains);
        stage.strain_history.copy_from_slice(&start.strains);
        stage.velocities.fill(Twist::default());
        stage.velocity_history.fill(Twist::default());
        stage.base = Pose::IDENTITY;
        stage.free_base = None;
        for (tension, cable) in stage.tensions.iter_mut().zip(&start.cables) {
            *tension = cable.tension;
        }
        stage.passages.clone_from(&start.holes.tensions);
        loads.at(0.0, &mut stage.loads);
        stage.matrix.hold_base(true);
        solver.contacts.clear();
        solver.lengths.cables.clear();
        solver.lengths.cables.extend_from_slice(&self.start_lengths);
        solver.lengths.drives.clone_from(&self.start_drives);
    }

    /// How a free base moves from the start of a part by a method with one stage to its end and to its stage, each with what its velocity at the start is multiplied by
    /// in the history. `None` where the base is not free.
    pub(crate) fn half_bases(
        &self,
        part: &Part,
        method: &OneStage,
    ) -> Result<Option<[(BaseTangent, f64); 2]>, NotSolved> {
        if !self.loads.has_free_base {
            return Ok(None);
        }
        let of = |place: f64, velocity: Twist| {
            let h = place * part.length;
            let weight = method.base_weight(self.solver.contacts.touches);
            let free = FreeBase::weighted(&part.before, h, weight);
            BaseTangent::new(&free, velocity).map(|of| (of, h - free.g)).ok_or(NotSolved)
        };
        let end = of(1.0, self.next.velocities[0])?;
        Ok(Some([end, of(method.place, self.solver.stage.velocities[0])?]))
    }
}
