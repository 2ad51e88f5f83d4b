//! A stable equilibrium on a branch off the load path: the load is raised together with small dead moments, which are then
//! taken away.

use whipcord_numerics::{ContinuationSteps, Missed, Vec3, continuation};

use crate::statics::lengths::Effort;

/// The moments, in all in units of EI/L.
const SIZES: [f64; 2] = [0.05, 0.4];

/// The part of them that is taken away at once in the end: where a robot is neutral about its axis they alone hold it on the way.
const LAST: f64 = 1e-4;

/// Fractions of the logarithm of that part.
const STEPS: ContinuationSteps =
    ContinuationSteps { first: 0.13, least: 1e-3, growth: 2.0, after_miss: f64::INFINITY };

/// Their directions: none that a robot is built along. From one the robot may snap elsewhere as they are taken away.
const DIRECTIONS: [Vec3; 2] = [Vec3::new(0.48, 0.64, 0.6), Vec3::new(-0.42, -0.68, 0.6)];

/// Multiples of it are spread evenly over the unit interval.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A robot under load with dead moments beside the loads.
pub(crate) trait Perturbed {
    /// Lets the [moments](Perturbation::moment) of a perturbation act, beside the loads.
    fn perturb(&mut self, by: Perturbation);

    /// Raises the load from rest to all of it through stable equilibria.
    fn raise(&mut self) -> Option<Effort>;

    /// Newton's method from where the robot is.
    fn converge(&mut self) -> Option<Effort>;

    /// Keeps where the robot is.
    fn keep(&mut self);

    /// Goes back to where the robot was kept.
    fn restore(&mut self);

    /// Whether the solve was ended from outside.
    fn has_ended(&self) -> bool;

    /// Whether the equilibrium is stable or neutral, as a round robot that has buckled is about its axis.
    fn is_stable(&mut self) -> bool;
}

/// All moments together, in units of EI/L.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Perturbation(Vec3);

impl Perturbation {
    const NONE: Self = Self(Vec3::ZERO);

    /// The moment on part `k` of so many, in the unit given. They differ from part to part, so that they work on every mode.
    pub fn moment(self, k: usize, parts: usize, unit: f64) -> Vec3 {
        self.0 * (unit * (0.5 + (k as f64 * GOLDEN).fract()) / parts as f64)
    }
}

/// The stable equilibrium, and all iterations; the robot is left in it, without the moments.
pub(crate) fn stable_equilibrium<R: Perturbed>(robot: &mut R) -> Option<Effort> {
    let all = DIRECTIONS.into_iter().flat_map(|way| SIZES.map(|size| way * size));
    for moments in all {
        if robot.has_ended() {
            break;
        }
        robot.perturb(Perturbation(moments));
        let Some(raised) = robot.raise() else { continue };
        let mut iterations = raised.iterations;
        robot.keep();
        let released = |robot: &mut R, iterations: usize| {
            robot.perturb(Perturbation::NONE);
            let Effort { iterations: last, residual } = robot.converge()?;
            robot.is_stable().then_some(Effort { iterations: iterations + last, residual })
        };
        if let Some(effort) = released(robot, iterations) {
            return Some(effort);
        }
        robot.restore();
        let taken_away = continuation(&STEPS, |fraction| {
            robot.perturb(Perturbation(moments * LAST.powf(fraction)));
            match robot.converge() {
                Some(effort) => {
                    iterations += effort.iterations;
                    robot.keep();
                    Ok(true)
                }
                None => {
                    robot.restore();
                    Err(Missed { reason: (), is_last: robot.has_ended() })
                }
            }
        });
        if taken_away.is_ok()
            && let Some(effort) = released(robot, iterations)
        {
            return Some(effort);
        }
    }
    robot.perturb(Perturbation::NONE);
    None
}
