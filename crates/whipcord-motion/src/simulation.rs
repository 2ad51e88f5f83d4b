//! The motion of a robot, step by step.

use whipcord::{Case, Loads, Robot};
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::accurate::Accurate;
use crate::commands::Commands;
use crate::drives::Drives;
use crate::error::{MotionError, count};
use crate::friction::Friction;
use crate::iteration::Solver;
use crate::loads::NodeLoads;
use crate::options::MotionOptions;
use crate::part::Taken;
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
        let surroundings = Surroundings::new(robot, &rod, case, options.has_free_base)?;
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
        solver.contacts.has_free_base = options.has_free_base;
        solver.stage.moves_base = options.has_free_base || options.base.is_some();
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
        self.step_in_parts(commands, dt, &mut |_| ())
    }

    /// The same; `taken` gets each part of the step.
    pub(crate) fn step_in_parts(
        &mut self,
        commands: &Commands,
        dt: f64,
        taken: &mut dyn FnMut(&Taken<'_>),
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
}
