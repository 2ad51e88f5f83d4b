//! Derivatives of any model by finite differences: for models without derivatives of their own, and
//! to check those that have them.

use whipcord_numerics::{Twist, UnitQuaternion, Vec3};

use crate::case::Case;
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::shape::{Shape, Wrench};
use crate::solution::Solution;
use crate::statics::Statics;

/// How a solution changes with one number.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Velocity and angular velocity of each station, in the world, as the poses of a [`Solution`] are:
    /// where the base is turned ([`Case::base`]) that is not the frame of the base.
    pub stations: Vec<Twist>,
    /// The same of each disk.
    pub disks: Vec<Twist>,
    /// Rates of the cables' lengths in m.
    pub lengths: Vec<f64>,
    /// Rates of their tensions in N; zero from a model that knows no forces.
    pub tensions: Vec<f64>,
    /// Rate of the wrench at the base, in the frame of the base; zero from a model that knows no forces.
    pub base_wrench: Wrench,
}

/// Differentiates the solution at 0 of a family of cases, with central differences of `step` and half
/// of it, extrapolated (Richardson): the error is of order `step⁴`, beside what rounding and the
/// solver leave divided by `step`.
///
/// # Errors
/// [`SolveError`] when one of the four cases has no solution.
pub fn differentiate(
    mut solve: impl FnMut(f64) -> Result<Solution, SolveError>,
    step: f64,
) -> Result<Difference, SolveError> {
    let mut central = |h: f64| -> Result<Difference, SolveError> {
        let (before, after) = (solve(-h)?, solve(h)?);
        Ok(between(&before, &after, 0.5 / h))
    };
    let (coarse, mut fine) = (central(step)?, central(0.5 * step)?);
    fine.weighted_sum(&coarse, |fine, coarse| (4.0 * fine - coarse) / 3.0);
    Ok(fine)
}

/// [`differentiate`] where there are cases on one side only, as where a tension is raised from
/// nothing: the error is of order `step³`.
///
/// # Errors
/// [`SolveError`] when one of the four cases has no solution.
pub fn ahead(
    mut solve: impl FnMut(f64) -> Result<Solution, SolveError>,
    step: f64,
) -> Result<Difference, SolveError> {
    let here = solve(0.0)?;
    let mut slope = |steps: f64| -> Result<Difference, SolveError> {
        Ok(between(&here, &solve(steps * step)?, 1.0 / (6.0 * step)))
    };
    let (mut sum, two, three) = (slope(1.0)?, slope(2.0)?, slope(3.0)?);
    sum.weighted_sum(&two, |one, two| 18.0 * one - 9.0 * two);
    sum.weighted_sum(&three, |sum, three| sum + 2.0 * three);
    Ok(sum)
}

/// Differentiates a model's solution by a parameter, with differences of `step` in its unit.
///
/// # Errors
/// [`SolveError`] when robot and case have no such quantity, or a case near it has no solution.
pub fn by_parameter(
    model: &impl Statics,
    robot: &Robot,
    case: &Case,
    parameter: &Parameter,
    step: f64,
) -> Result<Difference, SolveError> {
    differentiate(
        |by| {
            let (robot, case) = parameter.moved(robot, case, by)?;
            model.solve(&robot, &case)
        },
        step,
    )
}

fn between(a: &Solution, b: &Solution, f: f64) -> Difference {
    let poses = |a: &Shape, b: &Shape| -> Vec<Twist> {
        let turn = |a: UnitQuaternion, b: UnitQuaternion| (b * a.conjugate()).log();
        a.poses
            .iter()
            .zip(&b.poses)
            .map(|(a, b)| Twist {
                linear: (b.position - a.position) * f,
                angular: turn(a.rotation, b.rotation) * f,
            })
            .collect()
    };
    let cables = || a.cables.iter().zip(&b.cables);
    let known = |x: Option<f64>| x.unwrap_or(0.0);
    let (wa, wb) = (a.base_wrench.unwrap_or_default(), b.base_wrench.unwrap_or_default());
    Difference {
        stations: poses(&a.shape, &b.shape),
        disks: poses(&a.disks, &b.disks),
        lengths: cables().map(|(a, b)| (b.length - a.length) * f).collect(),
        tensions: cables().map(|(a, b)| (known(b.tension) - known(a.tension)) * f).collect(),
        base_wrench: Wrench {
            force: (wb.force - wa.force) * f,
            moment: (wb.moment - wa.moment) * f,
        },
    }
}

impl Difference {
    fn weighted_sum(&mut self, other: &Self, f: impl Fn(f64, f64) -> f64) {
        let vector = |a: &mut Vec3, b: &Vec3| {
            for i in 0..3 {
                a[i] = f(a[i], b[i]);
            }
        };
        let twists = |a: &mut [Twist], b: &[Twist]| {
            for (a, b) in a.iter_mut().zip(b) {
                vector(&mut a.linear, &b.linear);
                vector(&mut a.angular, &b.angular);
            }
        };
        let numbers = |a: &mut [f64], b: &[f64]| {
            for (a, b) in a.iter_mut().zip(b) {
                *a = f(*a, *b);
            }
        };
        twists(&mut self.stations, &other.stations);
        twists(&mut self.disks, &other.disks);
        numbers(&mut self.lengths, &other.lengths);
        numbers(&mut self.tensions, &other.tensions);
        vector(&mut self.base_wrench.force, &other.base_wrench.force);
        vector(&mut self.base_wrench.moment, &other.base_wrench.moment);
    }
}
