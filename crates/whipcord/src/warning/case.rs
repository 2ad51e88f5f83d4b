//! Warnings about what is asked of a robot.

use core::f64::consts::PI;

use super::geometry::bending_stiffness;
use super::kinds::Warning;
use super::robot;
use crate::case::Case;
use crate::robot::Robot;
use whipcord_numerics::Vec3;

/// Largest dead force along the backbone without a warning, as a multiple of the critical load.
const FAR_ALONG: f64 = 2.0;
/// The same for a force across the backbone, for a follower force, and if cable lengths are prescribed.
const FAR: f64 = 10.0;

/// Warnings about this robot and this case.
#[must_use]
pub fn of_case(robot: &Robot, case: &Case) -> Vec<Warning> {
    let mut found = robot::warnings(robot);
    found.extend(unused(robot, case));
    found.extend(buckling(robot, case));
    found
}

fn unused(robot: &Robot, case: &Case) -> Vec<Warning> {
    const NO_GRAVITY: &str = "[loads] has no `gravity`";
    const GRAVITY: &str =
        "add `gravity` to [loads], or write `gravity = [0, 0, 0]` there to say that there is none";
    let (backbone, loads) = (robot.backbone(), &case.loads);
    let mut found = Vec::new();
    let mut unused = |path: &str, reason, help| {
        found.push(Warning::UnusedKey { path: path.to_owned(), reason, help });
    };
    if loads.gravity.is_none() {
        // A material that is known by its name has a density, whether that is needed or not.
        let density = backbone.material.density.filter(|_| backbone.material.name.is_none());
        if density.is_some_and(|density| density > 0.0) {
            unused("backbone.density", NO_GRAVITY, GRAVITY);
        }
        if backbone.linear_density.as_ref().is_some_and(|of| of.values().iter().any(|v| *v > 0.0)) {
            unused("backbone.linear_density", NO_GRAVITY, GRAVITY);
        }
        if robot.disks().mass > 0.0 {
            unused("disks.mass", NO_GRAVITY, GRAVITY);
        }
        if let Some(i) = loads.masses.iter().position(|mass| mass.mass > 0.0) {
            unused(&format!("loads.mass[{i}]"), NO_GRAVITY, GRAVITY);
        }
    }
    if loads.tip_follower && loads.tip_force == Vec3::ZERO && loads.tip_moment == Vec3::ZERO {
        let reason = "there is neither a tip force nor a tip moment";
        let help = "add `tip_force` or `tip_moment`, or leave it out; a point load has a `follower` of its own";
        unused("loads.follower", reason, help);
    }
    found
}

/// Forces far beyond π²EI/(4s²), the critical load of a column of length s that is clamped at its base.
fn buckling(robot: &Robot, case: &Case) -> Vec<Warning> {
    let Some(stiffness) = bending_stiffness(robot) else { return Vec::new() };
    let loads = &case.loads;
    let to_base = loads.to_base(case.base.rotation);
    let tip = (
        "loads.tip_force".to_owned(),
        robot.backbone().length,
        loads.tip_force,
        loads.tip_follower,
    );
    let points = loads.points.iter().enumerate().map(|(i, point)| {
        (format!("loads.point[{i}].force"), point.at, point.force, point.follower)
    });
    let held = case.commands.iter().any(|of| of.shortening.is_some() && of.tension.is_none());
    let far_along = if held { FAR } else { FAR_ALONG };
    core::iter::once(tip)
        .chain(points)
        .filter(|(_, at, ..)| *at > 0.0)
        .filter_map(|(path, at, force, follower)| {
            let critical = PI * PI * stiffness / (4.0 * at * at);
            let force = if follower { force } else { to_base.rotate(force) };
            // What pulls on the tip straightens the robot.
            let along = (-force.z).max(0.0);
            let bending = force.x.hypot(force.y).hypot(along);
            if !follower && along > far_along * critical {
                return Some(Warning::BeyondBuckling { path, force: along, critical, axial: true });
            }
            (bending > FAR * critical).then_some(Warning::BeyondBuckling {
                path,
                force: bending,
                critical,
                axial: false,
            })
        })
        .collect()
}
