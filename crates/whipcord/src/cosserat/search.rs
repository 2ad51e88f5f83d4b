//! Equilibria that no path leads to: Newton's method from many base moments.
//!
//! Where the load path cannot be followed to its end, a robot under dead loads still comes to rest
//! somewhere. The starts are the same for every robot, spread evenly over a ball of base moments.

use whipcord_numerics::Vec3;

use super::guess::guess;
use super::problem::{Problem, StabilityCheck};
use super::scratch::Scratch;
use super::shooting::{finish, shoot};
use super::verdict::is_stable;
use super::without_load::start_without_load;
use crate::statics::outcome::Found;
use crate::statics::scales::Scales;

const STARTS: u32 = 40;
/// Radius of the ball, in units of K_bt/L: 8 rad of bending.
const REACH: f64 = 8.0;
/// Powers of 1/g, g the positive root of g⁴ = g + 1: multiples of them fill a cube evenly (Roberts).
const SPREAD: [f64; 3] =
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];

/// A stable equilibrium under all of the load; the answer is left in `scratch`.
pub(super) fn stable_equilibrium(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<Found> {
    if problem.stability == StabilityCheck::Off || scratch.applied.any_follower() {
        return None;
    }
    start_without_load(problem, scratch).ok()?;
    let tensions = scratch.tensions.clone();
    let unit = REACH * Scales::of(problem.grid, problem.length).moment;
    guess(problem, scratch, 1.0);
    // Of stronger loads no start is in reach.
    if scratch.newton.point.base_moment.norm() > unit {
        return None;
    }
    for n in 1..=STARTS {
        if problem.meter.has_ended() {
            return None;
        }
        let along = |i: usize| 2.0 * (f64::from(n) * SPREAD[i]).fract() - 1.0;
        let moment = Vec3::new(along(0), along(1), along(2));
        scratch.newton.point.base_moment = unit / moment.norm().max(1.0) * moment;
        scratch.newton.point.follower_force = Vec3::ZERO;
        scratch.newton.point.tensions.clone_from(&tensions);
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        if let Ok(effort) = shoot(problem, scratch, 1.0) {
            let found = finish(problem, scratch, effort);
            if is_stable(problem, scratch) {
                return Some(found);
            }
        }
    }
    None
}
