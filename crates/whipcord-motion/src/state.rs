//! The state of a robot in motion.

use whipcord::HoleMemory;
use whipcord_numerics::{Pose, Twist};

use crate::options::{Method, Start, StartRates};

/// Energies in J of a robot in motion, and the work since the start of the motion.
///
/// Without error of the integration `kinetic + elastic + gravity + motors + stretch` changes by `cables + control + loads + base + contacts − dissipated`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// Kinetic energy of backbone, disks and masses.
    pub kinetic: f64,
    /// Energy of the strains of the backbone.
    pub elastic: f64,
    /// Potential of gravity, zero where all masses are at the base.
    pub gravity: f64,
    /// Kinetic energy of the motors with inertia.
    pub motors: f64,
    /// Energy that the stretch of the cables of these motors and of their drives holds.
    pub stretch: f64,
    /// What the cables have given to the rod and to the friction in their holes, but for those of motors with inertia.
    pub cables: f64,
    /// What the position loops of motors with inertia have given.
    pub control: f64,
    /// What external loads other than gravity have given to the robot.
    pub loads: f64,
    /// What the base has given where it moves.
    pub base: f64,
    /// What obstacles have given in contact: negative, since impacts and friction take energy and obstacles do not move.
    pub contacts: f64,
    /// What damping, drag and the friction of cables and motors have taken.
    pub dissipated: f64,
    /// The sum of energies at the start of the motion.
    pub initial: f64,
}

impl EnergyBalance {
    /// Kinetic, elastic and potential energy, with those of motors that have inertia.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gravity + self.motors + self.stretch
    }

    /// What cables, loops, loads, base and obstacles have given, less what was dissipated.
    #[must_use]
    pub fn given(&self) -> f64 {
        self.cables + self.control + self.loads + self.base + self.contacts - self.dissipated
    }

    /// What the integration has added to the energy, and taken from it where negative: the change of the total less what was given.
    #[must_use]
    pub fn defect(&self) -> f64 {
        self.total() - self.initial - self.given()
    }
}

/// How a step was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepDiagnostics {
    /// The method that was used: steps with cables that are driven by their lengths are taken by [`Method::Robust`].
    pub method: Method,
    /// Parts into which the step was divided.
    pub parts: usize,
    /// Parts of these, of a few millionths of a second, in which contacts slid without friction since the part had no answer with it: several contacts can jam.
    pub frictionless_parts: usize,
    /// Iterations of all stages.
    pub iterations: usize,
    /// Factorisations of the linear system.
    pub factorisations: usize,
    /// Estimated error in m of the step; zero where no tolerance is given.
    pub error: f64,
}

/// A cable at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableMotion {
    /// Tension in N.
    pub tension: f64,
    /// Length in m inside the robot.
    pub length: f64,
    /// Length in m by which the commanded cable is longer than its path: positive where it is slack, zero where it is taut or driven by its
    /// tension.
    pub slack: f64,
}

/// A motor at a time: its own angle in rad before the gear, or the travel of a linear drive in m.
///
/// A motor with inertia moves by its equation of motion. Of one without it the position is the command, and the torque that which holds the cables; both are zero where it
/// has no command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorMotion {
    /// Angle or travel.
    pub position: f64,
    /// Its rate.
    pub velocity: f64,
    /// Torque in N·m or force in N: of the position loop, or of a motor without inertia.
    pub effort: f64,
    /// Integral of the error of the position over time in rad·s or m·s.
    pub integral: f64,
    /// StartRates of position, velocity and integral that the next step goes on from.
    pub(crate) rates: [f64; 3],
}

impl MotorMotion {
    /// A motor with this position, velocity and integral of the error.
    #[must_use]
    pub const fn new([position, velocity, integral]: [f64; 3]) -> Self {
        Self { position, velocity, effort: 0.0, integral, rates: [0.0; 3] }
    }

    /// Position, velocity and integral of the error.
    #[must_use]
    pub const fn values(&self) -> [f64; 3] {
        [self.position, self.velocity, self.integral]
    }
}

/// The state of a robot in motion. It can be kept, and a simulation can go on from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time in s.
    pub time: f64,
    /// Velocity of each node in its frame: m/s and rad/s.
    pub velocities: Vec<Twist>,
    /// Strains `(v, u)` at the points of the elements.
    pub strains: Vec<Twist>,
    /// StartRates of the velocities, where [`Self::has_rates`].
    pub velocity_rates: Vec<Twist>,
    /// StartRates of the strains, where [`Self::has_rates`].
    pub strain_rates: Vec<Twist>,
    /// Whether the rates are known: not at the start, and not behind a jump of a command or a load.
    pub has_rates: bool,
    /// Pose of the base in its frame at the start of the motion.
    pub base: Pose,
    /// Pose of each node in the world.
    pub poses: Vec<Pose>,
    /// The cables.
    pub cables: Vec<CableMotion>,
    /// Where the robot touches the obstacles of its case, from the base on.
    pub contacts: Vec<whipcord::solution::Contact>,
    /// The passages of cables with friction; empty where no cable has any.
    pub holes: HoleMemory,
    /// Motion of the spool or drive of each motor, behind gear and backlash, in rad or m.
    pub motor_outputs: Vec<f64>,
    /// The motors.
    pub motors: Vec<MotorMotion>,
    /// The energy balance.
    pub energy: EnergyBalance,
    /// How the last step was computed.
    pub diagnostics: StepDiagnostics,
    /// Length in s of the step that the rates are of.
    pub(crate) rates_of: f64,
    /// Parts of steps that were taken since the rates were lost.
    pub(crate) without_rates: usize,
    /// Short parts that still follow an impact.
    pub(crate) impact_parts: usize,
    /// Impacts since the start of the step.
    pub(crate) impacts: usize,
    /// Parts since the start of the step at whose end something is about to change its case.
    pub(crate) changes: usize,
    /// Where the passages of each cable begin among those of all, and where the last one ends; empty without friction.
    pub(crate) first_passages: Vec<usize>,
    /// What each cable was told last: a tension in N, or a shortening in m.
    pub(crate) commanded: Vec<f64>,
    /// Sums of what acted on the nodes in the last step, and gravity.
    pub(crate) acting: [f64; 15],
}

impl State {
    /// Pose of the tip in the world.
    #[must_use]
    pub fn tip(&self) -> Pose {
        self.poses.last().copied().unwrap_or_default()
    }

    /// Tension in N of each passage of a cable from the base on, as it acted in the last step; empty where no cable has friction.
    #[must_use]
    pub fn passage_tensions(&self, cable: usize) -> &[f64] {
        self.of_passages(cable, &self.holes.tensions)
    }

    /// Unstretched length in m of a cable beyond the near hole of each of its passages, from the base on; empty where no cable has friction. In a hole in which the cable sticks it is that
    /// of the step before.
    #[must_use]
    pub fn lengths_beyond(&self, cable: usize) -> &[f64] {
        self.of_passages(cable, &self.holes.beyond)
    }

    fn of_passages<'a>(&self, cable: usize, values: &'a [f64]) -> &'a [f64] {
        match (self.first_passages.get(cable), self.first_passages.get(cable + 1)) {
            (Some(&first), Some(&end)) => values.get(first..end).unwrap_or_default(),
            _ => &[],
        }
    }

    /// What another motion needs to start where this state is.
    #[must_use]
    pub fn start(&self) -> Start {
        Start {
            velocities: self.velocities.clone(),
            strains: self.strains.clone(),
            tensions: self.cables.iter().map(|cable| cable.tension).collect(),
            motor_outputs: self.motor_outputs.clone(),
            motors: self.motors.iter().map(MotorMotion::values).collect(),
            passage_tensions: self.by_cable(Self::passage_tensions),
            lengths_beyond: self.by_cable(Self::lengths_beyond),
            rates: self.rates(),
        }
    }

    /// The rates that the next step goes on from; `None` where they are not known.
    #[must_use]
    pub fn rates(&self) -> Option<StartRates> {
        self.has_rates.then(|| StartRates {
            velocities: self.velocity_rates.clone(),
            strains: self.strain_rates.clone(),
            motors: self.motors.iter().map(|motor| motor.rates).collect(),
            step: self.rates_of,
            commands: self.commanded.clone(),
            loads: self.acting,
        })
    }

    /// Of all cables; empty where no cable has friction.
    fn by_cable(&self, of: fn(&Self, usize) -> &[f64]) -> Vec<Vec<f64>> {
        let cables = self.first_passages.len().saturating_sub(1);
        (0..cables).map(|cable| of(self, cable).to_vec()).collect()
    }

    /// Copies another state of the same robot without allocation.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let Self {
            time,
            base,
            velocities,
            strains,
            velocity_rates,
            strain_rates,
            has_rates,
            poses,
            cables,
            holes,
            motor_outputs,
            motors,
            energy,
            diagnostics,
            rates_of,
            without_rates,
            contacts,
            impact_parts,
            impacts,
            changes,
            first_passages,
            commanded,
            acting,
        } = self;
        *acting = other.acting;
        first_passages.clone_from(&other.first_passages);
        (*rates_of, *without_rates) = (other.rates_of, other.without_rates);
        (*impact_parts, *impacts) = (other.impact_parts, other.impacts);
        *changes = other.changes;
        contacts.clone_from(&other.contacts);
        holes.clone_from(&other.holes);
        (*time, *base, *has_rates) = (other.time, other.base, other.has_rates);
        (*energy, *diagnostics) = (other.energy, other.diagnostics);
        velocities.clone_from(&other.velocities);
        strains.clone_from(&other.strains);
        velocity_rates.clone_from(&other.velocity_rates);
        strain_rates.clone_from(&other.strain_rates);
        poses.clone_from(&other.poses);
        cables.clone_from(&other.cables);
        motor_outputs.clone_from(&other.motor_outputs);
        motors.clone_from(&other.motors);
        commanded.clone_from(&other.commanded);
    }
}
