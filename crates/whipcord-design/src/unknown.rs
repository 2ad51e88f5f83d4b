//! Numbers of a robot and its cases that least squares change.

use whipcord::derivatives::{Hold, Place};
use whipcord::{Case, Disks, Linearization, Parameter, Robot, RobotError, Routing, Vec3};

use crate::chebyshev;

/// A number that is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Unknown {
    /// A parameter of the robot.
    Parameter(Parameter),
    /// The tension of a cable under one goal.
    Tension { goal: usize, cable: usize },
    /// The place of a polynomial cable, x or y, where the Chebyshev polynomial of so many zeros has one of them.
    Course { cable: usize, axis: usize, node: usize, nodes: usize },
    /// The arc length of a disk.
    DiskPosition { disk: usize },
}

/// What the robot of some unknowns is, and by what it is differentiated.
#[derive(Clone, Copy)]
pub(crate) struct Varied<'a> {
    pub robot: &'a Robot,
    pub cases: &'a [Case],
    pub unknowns: &'a [Unknown],
    /// Those of the core that the unknowns need.
    pub parameters: &'a [Parameter],
}

/// Robot and cases with these values of the unknowns.
pub(crate) fn applied(
    robot: &Robot,
    cases: &[Case],
    unknowns: &[Unknown],
    values: &[f64],
) -> Result<(Robot, Vec<Case>), RobotError> {
    let mut cases = cases.to_vec();
    let length = robot.backbone().length;
    let mut cables = robot.cables().to_vec();
    let mut disks = robot.disks().clone();
    let mut courses: Vec<(usize, [Vec<f64>; 2])> = Vec::new();
    for (unknown, &value) in unknowns.iter().zip(values) {
        match *unknown {
            Unknown::Parameter(_) => {}
            Unknown::Tension { goal, cable } => cases[goal].commands[cable].tension = Some(value),
            Unknown::DiskPosition { disk } => disks.arc_lengths[disk] = value,
            Unknown::Course { cable, axis, node, nodes } => {
                let known = courses.iter().position(|(of, _)| *of == cable);
                let at = known.unwrap_or_else(|| {
                    courses.push((cable, [vec![0.0; nodes], vec![0.0; nodes]]));
                    courses.len() - 1
                });
                courses[at].1[axis][node] = value;
            }
        }
    }
    for (cable, values) in &courses {
        let [x, y] = [0, 1].map(|axis: usize| chebyshev::powers(&values[axis], length));
        cables[*cable].routing = Routing::Polynomial { x, y };
    }
    let mut changed = Robot::new(robot.backbone().clone(), disks, cables)?
        .with_motors(robot.motors().to_vec())?;
    for (unknown, &value) in unknowns.iter().zip(values) {
        if let Unknown::Parameter(parameter) = unknown {
            (changed, _) = parameter.changed_to(&changed, &cases[0], value)?;
        }
    }
    Ok((changed, cases))
}

/// The parameters of the core that unknowns need, each once.
pub(crate) fn parameters(unknowns: &[Unknown]) -> Vec<Parameter> {
    let mut needed: Vec<Parameter> = Vec::new();
    let mut add = |parameter: Parameter| {
        if !needed.contains(&parameter) {
            needed.push(parameter);
        }
    };
    for unknown in unknowns {
        match *unknown {
            Unknown::Parameter(parameter) => add(parameter),
            Unknown::Course { cable, axis, nodes, .. } => {
                for power in 0..nodes {
                    add(Parameter::Coefficient { cable, axis, power });
                }
            }
            Unknown::Tension { .. } | Unknown::DiskPosition { .. } => {}
        }
    }
    needed
}

impl Unknown {
    /// Whether the core differentiates by it; else differences are taken.
    pub const fn has_derivative(&self) -> bool {
        !matches!(self, Self::DiskPosition { .. })
    }

    /// How fast each of these places moves with it under a goal, in the world.
    pub fn velocities(
        &self,
        goal: usize,
        case: &Case,
        length: f64,
        (derivatives, parameters): (&Linearization, &[Parameter]),
        places: &[Place],
    ) -> Vec<Vec3> {
        let mut sum = vec![Vec3::ZERO; places.len()];
        let mut add = |factor: f64, change: &whipcord::derivatives::Change| {
            for (sum, &place) in sum.iter_mut().zip(places) {
                *sum += change.twist(place).linear * factor;
            }
        };
        let of = |parameter: Parameter| parameters.iter().position(|known| *known == parameter);
        match *self {
            Self::Tension { goal: own, cable } if own == goal => {
                add(1.0, &derivatives.command(cable));
            }
            Self::Tension { .. } | Self::DiskPosition { .. } => {}
            Self::Parameter(parameter) => {
                if let Some(index) = of(parameter) {
                    add(1.0, &derivatives.parameter(index, Hold::Commands));
                }
            }
            Self::Course { cable, axis, node, nodes } => {
                let powers = chebyshev::of_node(node, nodes, length);
                for (power, factor) in powers.into_iter().enumerate() {
                    if let Some(index) = of(Parameter::Coefficient { cable, axis, power }) {
                        add(factor, &derivatives.parameter(index, Hold::Commands));
                    }
                }
            }
        }
        // Motions of the core are in the frame of the base.
        sum.into_iter().map(|velocity| case.base.rotation.rotate(velocity)).collect()
    }
}

/// The least distance of neighbouring disks in m that a design may have: a tenth of the mean.
pub(crate) fn least_distance(disks: &Disks, length: f64) -> f64 {
    #[allow(clippy::cast_precision_loss, reason = "few disks")]
    let spans = (disks.count() - 1) as f64;
    0.1 * length / spans
}
