//! What is asked of a state: momentum, the force of the base, vibrations, linearisation.

use whipcord::Wrench;
use whipcord_numerics::{Twist, Vec3};

use crate::commands::Commands;
use crate::contacts::{Contacts, add_push};
use crate::error::MotionError;
use crate::friction::Locked;
use crate::lengths::Lengths;
use crate::linear::{Linearized, Rates};
use crate::modes::{self, Mode};
use crate::pose;
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
    /// on to touch it: it moves along its surface, or stays where it is if there is friction. Cables that stick in all of their holes stay in them: each piece from hole to hole is
    /// held, and stretches where it is elastic. A robot whose base is free has six vibrations of frequency 0, its
    /// motions as a whole, and the others about a state in which it falls freely.
    ///
    /// # Errors
    /// [`MotionError::Count`] for commands of other cables, [`MotionError::NoModes`] where the stiffness of the state is singular,
    /// [`MotionError::Sliding`] where a cable with friction slides in a hole or is about to.
    pub fn modes(&mut self, commands: &Commands, count: usize) -> Result<Vec<Mode>, MotionError> {
        commands.check(&self.robot)?;
        self.take_stage();
        let locked = self.locked(Some(commands), "natural vibrations")?;
        let Self { rod, solver, robot, .. } = &*self;
        let is_held = |&i: &usize| {
            let slides_freely = solver.friction.is_none() || !robot.cables()[i].has_friction();
            slides_freely && self.is_by_length(commands, i) && self.state.cables[i].tension > 0.0
        };
        let held = (0..rod.cables.len()).filter(is_held);
        let mut held: Vec<(Vec<Twist>, f64)> = held
            .map(|i| (Lengths::pull(rod, &solver.stage, i), rod.cables[i].compliance))
            .collect();
        let contacts = self.touching();
        let Self { rod, solver, .. } = &mut *self;
        if let Some(friction) = &mut solver.friction {
            let pull = |of: &Locked| friction.pull(rod, &solver.stage, of.passage);
            let pulls: Vec<_> = locked.iter().map(pull).collect();
            held.extend(pulls.into_iter().zip(locked.iter().map(|of| of.yielding)));
        }
        modes::find(&self.rod, &self.loads, &self.solver, held, contacts, count)
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
    /// same place: its gap has no acceleration. Where it slides its friction is against its velocity. Cables that stick in all of their holes stay in them: the tension of each
    /// piece changes with its length, and not with what the drive does below the base.
    ///
    /// # Errors
    /// [`MotionError::Sliding`] where a cable with friction slides in a hole or is about to, [`MotionError::Unsupported`] where one that sticks does not stretch.
    pub fn linearize(&mut self) -> Result<Linearized, MotionError> {
        self.take_stage();
        let locked = self.locked(None, "the linearisation of a motion")?;
        if locked.iter().any(|of| of.yielding == 0.0) {
            return Err(MotionError::Unsupported {
                path: "cables.axial_stiffness".to_owned(),
                what: "the linearisation of a motion with rigid cables that stick in their holes: the tension of a piece has no rate",
                advice: "give the cables their axial stiffness",
            });
        }
        let contacts = self.touching();
        let Self { rod, loads, solver, state, .. } = self;
        let tensions: Vec<f64> = state.cables.iter().map(|cable| cable.tension).collect();
        let mut rates = Rates::new(rod, loads, solver, contacts).with_locked(locked);
        Ok(rates.linearized(&state.velocities, &state.strains, &tensions))
    }

    /// The passages that keep their pieces of cable about the state, in the stage; none where no cable has friction. Without commands what holds each cable below the base is its
    /// tension there.
    fn locked(
        &mut self,
        commands: Option<&Commands>,
        what: &str,
    ) -> Result<Vec<Locked>, MotionError> {
        let Some(mut friction) = self.solver.friction.take() else { return Ok(Vec::new()) };
        let time = self.state.time;
        match commands {
            Some(commands) => self.command_holes(commands, &mut friction, (time, time)),
            None => {
                friction.holes.go_back_to(&self.state.holes);
                for (i, tension) in self.state.holes.base.iter().enumerate() {
                    friction.holes.command_tension(i, *tension);
                }
            }
        }
        let locked = friction.locked(&self.rod, &self.solver.stage);
        self.solver.friction = Some(friction);
        locked.ok_or_else(|| MotionError::Sliding { what: what.to_owned() })
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
        let Self { rod, loads, solver, state, .. } = self;
        let stage = &mut solver.stage;
        stage.strains.copy_from_slice(&state.strains);
        stage.velocities.copy_from_slice(&state.velocities);
        stage.base = state.base;
        for (tension, cable) in stage.tensions.iter_mut().zip(&state.cables) {
            *tension = cable.tension;
        }
        stage.passages.clone_from(&state.holes.tensions);
        pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
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
        let weight = loads.gravity_at(state.time) * rod.nodes[0].mass;
        let turned = base.rotation * state.base.rotation;
        Wrench {
            force: turned.rotate(wrench.linear) - base.rotation.rotate(weight),
            moment: turned.rotate(wrench.angular),
        }
    }
}
