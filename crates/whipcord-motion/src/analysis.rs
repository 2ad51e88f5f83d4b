//! What is asked of a state: momentum, the force of the base, vibrations, linearisation.

use whipcord::Wrench;
use whipcord_numerics::Vec3;

use crate::commands::Commands;
use crate::contacts::add_push;
use crate::error::MotionError;
use crate::linear::{Linearized, Rates};
use crate::modes::{self, Mode};
use crate::simulation::Simulation;

impl Simulation {
    /// Linear momentum in kg·m/s in the world.
    #[must_use]
    pub fn momentum(&self) -> Vec3 {
        let nodes = self.rod.nodes.iter().zip(&self.state.velocities).zip(&self.state.poses);
        nodes.fold(Vec3::ZERO, |sum, ((node, velocity), pose)| {
            sum + pose.rotation.rotate(velocity.linear) * node.mass
        })
    }

    /// Angular momentum in kg·m²/s about the origin of the world.
    #[must_use]
    pub fn angular_momentum(&self) -> Vec3 {
        let nodes = self.rod.nodes.iter().zip(&self.state.velocities).zip(&self.state.poses);
        nodes.fold(Vec3::ZERO, |sum, ((node, velocity), pose)| {
            let momentum = pose.rotation.rotate(velocity.linear) * node.mass;
            let spin = node.inertia.scale(velocity.angular);
            sum + pose.position.cross(momentum) + pose.rotation.rotate(spin)
        })
    }

    /// The lowest natural vibrations about the shape of the state, which should be an equilibrium, from the lowest squared frequency on.
    /// Cables that commands drive by their lengths and that are taut are held at these; the others keep their tensions.
    ///
    /// # Errors
    /// [`MotionError::Count`] for commands of other cables, [`MotionError::NoModes`] where the stiffness of the state is singular,
    /// [`MotionError::Unsupported`] where the robot touches an obstacle.
    pub fn modes(&mut self, commands: &Commands, count: usize) -> Result<Vec<Mode>, MotionError> {
        commands.check(&self.robot)?;
        self.refuse_free_base("natural vibrations of a robot whose base is free")?;
        self.refuse_friction("natural vibrations of a robot whose cables have friction")?;
        self.refuse_contact("natural vibrations of a robot that touches an obstacle")?;
        self.take_stage();
        let is_held =
            |&i: &usize| self.is_by_length(commands, i) && self.state.cables[i].tension > 0.0;
        let held: Vec<usize> = (0..self.rod.cables.len()).filter(is_held).collect();
        modes::find(&self.rod, &self.loads, &self.solver, &held, count).ok_or(MotionError::NoModes)
    }

    /// Which parts of the kinetic energy of a vibration are those of displacements along x, y and z of the world, and of rotations.
    #[must_use]
    pub fn energy_shares(&self, mode: &Mode) -> [f64; 4] {
        let mut shares = [0.0; 4];
        for (node, (twist, world)) in
            self.rod.nodes.iter().zip(mode.shape.iter().zip(mode.in_world(&self.state)))
        {
            for (share, x) in shares.iter_mut().zip(world.linear.to_array()) {
                *share += node.mass * x * x;
            }
            shares[3] += node.inertia.scale(twist.angular).dot(twist.angular);
        }
        let sum: f64 = shares.iter().sum();
        shares.map(|share| share / sum.max(f64::MIN_POSITIVE))
    }

    /// The motion linearised about the state, with the tensions of all cables as inputs.
    ///
    /// # Errors
    /// [`MotionError::Unsupported`] where the robot touches an obstacle: its motion is not smooth there.
    pub fn linearize(&mut self) -> Result<Linearized, MotionError> {
        self.refuse_free_base("the linearisation of a motion with a free base")?;
        self.refuse_friction("the linearisation of a motion with friction of cables")?;
        self.refuse_contact("the linearisation of a motion in contact")?;
        self.take_stage();
        let Self { rod, loads, solver, state, .. } = self;
        let tensions: Vec<f64> = state.cables.iter().map(|cable| cable.tension).collect();
        let mut rates = Rates::new(rod, loads, solver, state.time);
        Ok(rates.linearized(&state.velocities, &state.strains, &tensions))
    }

    fn refuse_free_base(&self, what: &'static str) -> Result<(), MotionError> {
        if !self.options.has_free_base {
            return Ok(());
        }
        let advice = "hold the base: leave out `free` in [motion.base]";
        Err(MotionError::Unsupported { path: "motion.base.free".to_owned(), what, advice })
    }

    fn refuse_friction(&self, what: &'static str) -> Result<(), MotionError> {
        if self.solver.friction.is_none() {
            return Ok(());
        }
        let advice = "leave the friction out: whether cables stick or slide decides";
        Err(MotionError::Unsupported { path: "cables.friction".to_owned(), what, advice })
    }

    fn refuse_contact(&self, what: &'static str) -> Result<(), MotionError> {
        if self.state.contacts.is_empty() {
            return Ok(());
        }
        Err(MotionError::Unsupported {
            path: "obstacles".to_owned(),
            what,
            advice: "ask at a state in which it touches none, or remove the obstacle",
        })
    }

    /// Puts the state into the stage of the solver.
    fn take_stage(&mut self) {
        let Self { rod, loads, solver, state, base, .. } = self;
        let stage = &mut solver.stage;
        stage.strains.copy_from_slice(&state.strains);
        stage.velocities.copy_from_slice(&state.velocities);
        stage.base = state.base;
        for (tension, cable) in stage.tensions.iter_mut().zip(&state.cables) {
            *tension = cable.tension;
        }
        stage.passages.clone_from(&state.holes.tensions);
        loads.at(state.time, &mut stage.loads);
        // What obstacles push with is a load of the state.
        for contact in &state.contacts {
            add_push(rod, *base, &state.poses, contact, &mut stage.loads);
        }
    }

    /// Force in N and moment about the base in N·m that the base exerts on robot and cables, in the world: the cables leave the robot through the base.
    /// What is fixed to the base itself has its weight here, but no inertia. A base that is free exerts nothing.
    #[must_use]
    pub fn base_wrench(&mut self) -> Wrench {
        if self.options.has_free_base {
            return Wrench::default();
        }
        self.take_stage();
        let Self { rod, loads, solver, state, base, .. } = self;
        let tensions: Vec<f64> = state.cables.iter().map(|cable| cable.tension).collect();
        let wrench = Rates::new(rod, loads, solver, state.time).base_wrench(
            &state.velocities,
            &state.strains,
            &tensions,
        );
        let weight = loads.gravity * rod.nodes[0].mass;
        let turned = base.rotation * state.base.rotation;
        Wrench {
            force: turned.rotate(wrench.linear) - base.rotation.rotate(weight),
            moment: turned.rotate(wrench.angular),
        }
    }
}
