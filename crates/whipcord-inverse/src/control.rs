//! Commands for a robot in motion: one quadratic programme a cycle, with an estimate of what the model does not know.

use whipcord::derivatives::Place;
use whipcord::{CableState, Case, Model, Robot, Solution, SolveError, Stations, Twist, Vec3};

use crate::actuator::{Actuator, Actuators, CommandedBy, knows_tensions};
use crate::descent::{Control, Ending, Region, Workspace};
use crate::error::InverseError;
use crate::estimator::{Estimator, EstimatorOptions};
use crate::evaluation::Evaluation;
use crate::forward::Forward;
use crate::limit::{Constraints, Limit};
use crate::limits::Limits;
use crate::linear::Linear;
use crate::target::{Miss, Target, Tolerance};

/// How a controller works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlOptions {
    /// Time of a cycle in s.
    pub period: f64,
    /// The part of an error that is left after a second is `exp(−gain)`.
    pub gain: f64,
    /// Weight `ρ` of the change of the commands, relative to how they move the target: more is calmer near singular shapes.
    pub damping: f64,
    /// How a rotation counts beside a motion: the tolerances are alike.
    pub tolerance: Tolerance,
    /// What is estimated from measurements; `None` uses none.
    pub estimator: Option<EstimatorOptions>,
}

impl ControlOptions {
    /// For cycles of so many seconds and a robot of this length in m.
    #[must_use]
    pub fn new(period: f64, length: f64) -> Self {
        Self {
            period,
            gain: 5.0,
            damping: 1e-6,
            tolerance: Tolerance::of_length(length),
            estimator: Some(EstimatorOptions {
                position: 1e-3 * length,
                angle: 3e-3,
                bias: 0.05,
                force: 0.1,
                memory: 5.0,
            }),
        }
    }
}

/// A number that is estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Its most probable value.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// What a cycle gives.
#[derive(Clone, Debug)]
pub struct Cycle {
    /// The commands to send, by [`Controller::actuators`]: N, m or rad.
    pub commands: Vec<f64>,
    /// How far the estimated robot is from the target before these commands.
    pub miss: Miss,
    /// The shape of the estimated robot before these commands.
    pub solution: Solution,
    /// Motion of the tip in the world by each actuator: by N, by m, or by what a spool turns.
    pub jacobian: Vec<Twist>,
    /// Motion of the tip with a force on it along x, y and z of the base, in m/N and rad/N, the commands held.
    pub compliance: [Twist; 3],
    /// Rates of the tensions of the cables in N, by actuators.
    pub tension_rates: Vec<Vec<f64>>,
    /// Rates of the lengths of the cables inside the robot in m, by actuators.
    pub length_rates: Vec<Vec<f64>>,
    /// Estimated bias of each actuator.
    pub bias: Vec<Estimate>,
    /// Estimated force on the tip in N along x, y, z of the base, beside the loads of the case.
    pub force: [Estimate; 3],
    /// The limits that hold the commands back.
    pub limits: Vec<Limit>,
}

/// Follows a target that moves, within the limits of commands, rates and tensions.
///
/// Each cycle solves the model at the commands in force and the estimate, warm, and one quadratic programme
///
/// ```text
/// min ‖r + J δ − e^(−gT) r₀‖² + ρ t‖δ‖²     within the limits                               (13)
/// ```
///
/// with the residuals `r` of the target now and `r₀` of the target of the cycle before, both at the estimated robot: the motion of the target is fed forward and
/// the error decays with the gain.
pub struct Controller {
    forward: Forward,
    options: ControlOptions,
    limits: Limits,
    constraints: Constraints,
    bounds: Vec<[f64; 2]>,
    /// The commands in force, as unknowns.
    unknowns: Vec<f64>,
    last: Option<Solution>,
    last_target: Option<Target>,
    base_force: Vec3,
    estimator: Option<Estimator>,
    workspace: Workspace,
}

impl Controller {
    /// For a model of a robot that starts with the commands of the case.
    ///
    /// # Errors
    /// [`InverseError`] where there is nothing to command, limits do not fit the robot, or options are not positive; [`InverseError::NoDerivatives`] for
    /// a model without exact derivatives.
    pub fn new(
        model: &Model,
        robot: &Robot,
        case: &Case,
        limits: &Limits,
        by: CommandedBy,
        options: ControlOptions,
    ) -> Result<Self, InverseError> {
        limits.check(robot.cables().len())?;
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        let tolerance = options.tolerance;
        let all = [options.period, options.gain, tolerance.position, tolerance.angle];
        let of_estimator = options
            .estimator
            .map_or([1.0; 5], |of| [of.position, of.angle, of.bias, of.force, of.memory]);
        if !all.into_iter().chain(of_estimator).all(is_positive)
            || options.damping.is_nan()
            || options.damping < 0.0
        {
            return Err(InverseError::ControlOptions);
        }
        if !model.has_derivatives(robot) {
            return Err(InverseError::NoDerivatives);
        }
        let list = Actuator::of(robot, case, model.kind(), by)?;
        let actuators = Actuators::direct(robot, case, list);
        let mut forward = Forward::new(&model.at(Stations::Disks), robot, case, actuators)?;
        let bounds = forward.actuators.bounds(&forward.actuators.list, robot, limits);
        let knows_tensions = knows_tensions(model.kind());
        let constraints =
            Constraints::new(robot, &forward.actuators, &bounds, limits, knows_tensions, None);
        let unknowns = forward.commanded(case);
        let estimator = options.estimator.map(|of| Estimator::new(unknowns.len(), &of));
        Ok(Self {
            base_force: case.loads.tip_force,
            forward,
            options,
            limits: limits.clone(),
            constraints,
            bounds,
            unknowns,
            last: None,
            last_target: None,
            estimator,
            workspace: Workspace::default(),
        })
    }

    /// What is commanded, in the order of [`Cycle::commands`].
    #[must_use]
    pub fn actuators(&self) -> &[Actuator] {
        &self.forward.actuators.asked
    }

    /// One cycle: the commands that lead towards a target, after what was measured of the robot under the commands in force. A measurement is
    /// a target that the robot was seen at: its tip, its pose, or points of its disks.
    ///
    /// # Errors
    /// [`InverseError::Target`] for a target or a measurement that is none, [`InverseError::Solve`] where the model has no answer. The commands in force stay as they are then.
    pub fn cycle(
        &mut self,
        target: &Target,
        measured: Option<&Target>,
    ) -> Result<Cycle, InverseError> {
        let disks = self.forward.robot().disks().count();
        target.check(disks)?;
        measured.map_or(Ok(()), |measured| measured.check(disks))?;
        let lever = self.options.tolerance.position / self.options.tolerance.angle;
        let seen = measured.map(Target::places).unwrap_or_default();
        let own = target.places();
        let places: Vec<Place> =
            own.iter().chain(&seen).copied().chain(core::iter::once(Place::Tip)).collect();
        let scales = self.forward.scales.clone();
        let n = self.unknowns.len();
        let (evaluation, forces) = self.solve(&places)?;

        let mut change = vec![0.0; n + 3];
        if let (Some(measured), Some(estimator), Some(options)) =
            (measured, &mut self.estimator, self.options.estimator)
        {
            let mut linear = Linear::default();
            let of: Vec<Vec<Twist>> = evaluation
                .rates
                .motions
                .iter()
                .chain(&forces)
                .map(|motions| motions[own.len()..].to_vec())
                .collect();
            measured.linearize(&evaluation.solution.disks.poses, &of, lever, &mut linear);
            for row in linear.jacobian.chunks_exact_mut(n + 3) {
                row.iter_mut().zip(&scales).for_each(|(h, scale)| *h *= scale);
            }
            let variances = measured.variances(options.position, options.angle * lever);
            let period = self.options.period;
            change = estimator.correct(&linear.residual, &linear.jacobian, &variances, period);
        }

        let mut linear = Linear::default();
        let poses = &evaluation.solution.disks.poses;
        target.linearize(poses, &evaluation.rates.motions, lever, &mut linear);
        let mut before = Vec::new();
        let earlier = self.last_target.as_ref().filter(|earlier| earlier.is_like(target));
        earlier.unwrap_or(target).residual(&evaluation.solution, lever, &mut before);
        // What the estimate has moved since the solve.
        let mut by_force = Linear::default();
        target.linearize(poses, &forces, lever, &mut by_force);
        let left = (-self.options.gain * self.options.period).exp();
        for (i, (r, r0)) in linear.residual.iter_mut().zip(&before).enumerate() {
            let row = &linear.jacobian[i * n..(i + 1) * n];
            let biased: f64 =
                row.iter().zip(&scales).zip(&change).map(|((j, s), z)| j * s * z).sum();
            let forced: f64 = by_force.jacobian[3 * i..3 * i + 3]
                .iter()
                .zip(&change[n..])
                .map(|(j, z)| j * z)
                .sum();
            let moved = biased + forced;
            *r += moved - left * (r0 + moved);
        }
        self.constraints.linearize(self.forward.robot(), &evaluation, places.len(), &mut linear);
        let ranges = self.ranges();
        let control = Control {
            bounds: &ranges,
            scales: &scales,
            evaluations: 1,
            ending: Ending::ANSWER,
            curvature: None,
        };
        let penalty = 1e2 * linear.cost().max(1e-12);
        let unknowns = self.unknowns.clone();
        let region = Region { damping: self.options.damping, radius: f64::INFINITY };
        let step = self.workspace.step(&linear, &[], &unknowns, &control, region, penalty);
        // Without a minimum, which only rounding can take away, the commands stay.
        if step.is_ok() {
            for (k, (x, d)) in self.unknowns.iter_mut().zip(self.workspace.last_step()).enumerate()
            {
                let [least, greatest] = ranges[k];
                *x = (*x + d * scales[k]).max(least).min(greatest);
            }
        }
        let limits = self.constraints.met(&self.forward, &evaluation, &self.unknowns, &ranges);
        let miss = target.miss(&evaluation.solution);
        let tip = places.len() - 1;
        let commands = self.forward.actuators.commands(self.forward.robot(), &self.unknowns);
        self.forward.command_actuators(&self.unknowns);
        self.last = Some(evaluation.solution.clone());
        self.last_target = Some(target.clone());
        let (bias, force) = self.estimates();
        Ok(Cycle {
            commands,
            miss,
            jacobian: evaluation.rates.motions.iter().map(|motions| motions[tip]).collect(),
            compliance: forces.map(|motions| motions[tip]),
            length_rates: self.length_rates(&evaluation),
            tension_rates: evaluation.rates.tension_rates.clone(),
            solution: evaluation.solution,
            bias,
            force,
            limits,
        })
    }

    /// The model at the commands in force and the estimate, from the cycle before, or from cold where it is lost.
    fn solve(&mut self, places: &[Place]) -> Result<(Evaluation, [Vec<Twist>; 3]), SolveError> {
        let n = self.unknowns.len();
        let mut at = self.unknowns.clone();
        let mut force = self.base_force;
        if let Some(estimator) = &self.estimator {
            for (k, (x, scale)) in at.iter_mut().zip(&self.forward.scales).enumerate() {
                *x += estimator.state[k] * scale;
                if matches!(self.forward.actuators.list[k], Actuator::Tension(_)) {
                    *x = x.max(0.0);
                }
            }
            force += Vec3::new(estimator.state[n], estimator.state[n + 1], estimator.state[n + 2]);
        }
        self.forward.case.loads.tip_force = force;
        let last = self.last.take();
        let (evaluation, rates) = match self.forward.linearize(&at, places, last.as_ref()) {
            Err(error) if last.is_none() || matches!(error, SolveError::Cancelled { .. }) => {
                return Err(error);
            }
            Err(_) => self.forward.linearize(&at, places, None)?,
            Ok(found) => found,
        };
        let forces = self.forward.motions_with_forces(&rates, places);
        Ok((evaluation, forces))
    }

    /// Of each cable by each actuator: its stretch less the shortening that is commanded.
    fn length_rates(&self, evaluation: &Evaluation) -> Vec<Vec<f64>> {
        let robot = self.forward.robot();
        let rates = &evaluation.rates;
        let all = rates.tension_rates.iter().zip(&rates.shortening_rates);
        all.map(|(tensions, shortenings)| {
            let states = evaluation.solution.cables.iter().zip(tensions).zip(shortenings);
            let of =
                |(cable, ((state, tension), shortening)): (usize, ((&CableState, &f64), &f64))| {
                    robot.cable_compliance(cable, state.initial_length) * tension - shortening
                };
            states.enumerate().map(of).collect()
        })
        .collect()
    }

    /// What the unknowns may be after a cycle.
    fn ranges(&self) -> Vec<[f64; 2]> {
        let robot = self.forward.robot();
        let of = |((actuator, [least, greatest]), x): ((&Actuator, &[f64; 2]), &f64)| {
            let rate = actuator.rate_limit(robot, &self.limits);
            let most = rate.map_or(f64::INFINITY, |rate| rate * self.options.period);
            // Commands that begin beyond their limits may come back to them.
            [least.max(x - most).min(*x), greatest.min(x + most).max(*x)]
        };
        self.actuators().iter().zip(&self.bounds).zip(&self.unknowns).map(of).collect()
    }

    fn estimates(&self) -> (Vec<Estimate>, [Estimate; 3]) {
        let n = self.unknowns.len();
        let Some(estimator) = &self.estimator else {
            return (vec![Estimate::default(); n], [Estimate::default(); 3]);
        };
        let of: Vec<Estimate> = estimator
            .state
            .iter()
            .zip(estimator.deviations())
            .map(|(&value, deviation)| Estimate { value, deviation })
            .collect();
        let scaled = |(of, scale): (&Estimate, &f64)| Estimate {
            value: of.value * scale,
            deviation: of.deviation * scale,
        };
        let bias = of[..n].iter().zip(&self.forward.scales).map(scaled).collect();
        (bias, [of[n], of[n + 1], of[n + 2]])
    }
}
