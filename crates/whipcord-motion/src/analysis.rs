//! What is asked of a state: momentum, the force of the base, vibrations, linearisation.

use whipcord::Wrench;
use whipcord_numerics::Vec3;

use crate::commands::Commands;
use crate::contacts::{Contacts, add_push};
use crate::error::MotionError;
use crate::linear::{Linearized, Rates};
use crate::modes::{self, Mode};
use crate::simulation::Simulation;

/// Gap of what touches, as a part of the length.
const TOUCHING: f64 = 1e-4;

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
    /// Cables that commands drive by their lengths and that are taut are held at these; the others keep their tensions. What touches an obstacle goes
    /// on to touch it: it moves along its surface, or stays where it is if there is friction. A robot whose base is free has six vibrations of frequency 0, its
    /// motions as a whole, and the others about a state in which it falls freely.
    ///
    /// # Errors
    /// [`MotionError::Count`] for commands of other cables, [`MotionError::NoModes`] where the stiffness of the state is singular,
    /// [`MotionError::Unsupported`] where cables have friction.
    pub fn modes(&mut self, commands: &Commands, count: usize) -> Result<Vec<Mode>, MotionError> {
        commands.check(&self.robot)?;
        self.refuse_friction("natural vibrations of a robot whose cables have friction")?;
        self.take_stage();
        let is_held =
            |&i: &usize| self.is_by_length(commands, i) && self.state.cables[i].tension > 0.0;
        let held: Vec<usize> = (0..self.rod.cables.len()).filter(is_held).collect();
        let contacts = self.touching();
        modes::find(&self.rod, &self.loads, &self.solver, &held, contacts, count)
            .ok_or(MotionError::NoModes)
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

    /// The motion linearised about the state, with the tensions of all cables as inputs. What touches an obstacle goes on to touch it, where it sticks at the
    /// same place: its gap has no acceleration. Where it slides its friction is against its velocity.
    ///
    /// # Errors
    /// [`MotionError::Unsupported`] where cables have friction.
    pub fn linearize(&mut self) -> Result<Linearized, MotionError> {
        self.refuse_friction("the linearisation of a motion with friction of cables")?;
        self.take_stage();
        let contacts = self.touching();
        let Self { rod, loads, solver, state, .. } = self;
        let tensions: Vec<f64> = state.cables.iter().map(|cable| cable.tension).collect();
        let mut rates = Rates::new(rod, loads, solver, contacts);
        Ok(rates.linearized(&state.velocities, &state.strains, &tensions))
    }

    fn refuse_friction(&self, what: &'static str) -> Result<(), MotionError> {
        if self.solver.friction.is_none() {
            return Ok(());
        }
        let advice = "leave the friction out: whether cables stick or slide decides";
        Err(MotionError::Unsupported { path: "cables.friction".to_owned(), what, advice })
    }

    /// The contacts of the state, with their forces.
    fn touching(&self) -> Contacts {
        let Self { rod, solver, state, base, .. } = self;
        let mut contacts = solver.contacts.clone();
        contacts.base = state.base;
        let known = (state.contacts.as_slice(), *base);
        contacts.begin(rod, state.base, &state.strains, TOUCHING * rod.length, known);
        contacts.list.retain(|contact| contact.force > 0.0);
        contacts
    }

    /// Puts the state into the stage of the solver.
    fn take_stage(&mut self) {
        let Self { loads, solver, state, .. } = self;
        let stage = &mut solver.stage;
        stage.strains.copy_from_slice(&state.strains);
        stage.velocities.copy_from_slice(&state.velocities);
        stage.base = state.base;
        for (tension, cable) in stage.tensions.iter_mut().zip(&state.cables) {
            *tension = cable.tension;
        }
        stage.passages.clone_from(&state.holes.tensions);
        loads.at(state.time, &mut stage.loads);
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
        // What obstacles push with is a load of the state.
        for contact in &state.contacts {
            add_push(rod, *base, &state.poses, contact, &mut solver.stage.loads);
        }
        let tensions: Vec<f64> = state.cables.iter().map(|cable| cable.tension).collect();
        let wrench = Rates::new(rod, loads, solver, Contacts::default()).base_wrench(
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
