//! Friction against bending of the backbone in words.

use whipcord::{Case, Robot, Solution};

use crate::quantity::{degrees, number};

/// The friction of a robot; `None` without any.
pub(crate) fn of_robot(robot: &Robot) -> Option<String> {
    let friction = robot.backbone().bending_friction?;
    let about = |[x, y]: [f64; 2], scale: f64, unit: &str| {
        let (a, b) = (number(scale * x, 4), number(scale * y, 4));
        if a == b { format!("{a} {unit}") } else { format!("{a} and {b} {unit}") }
    };
    let moment = format!("yield moment {}", about(friction.yield_moment, 1e3, "mN·m"));
    Some(match friction.yield_stiffness {
        None => moment,
        Some(stiffness) => format!("{moment} after {}", about(stiffness, 1.0, "N·m²")),
    })
}

/// What friction against bending holds in an answer; `None` without such friction.
#[must_use]
pub fn words(case: &Case, solution: &Solution) -> Option<String> {
    if solution.plastic_curvature.is_empty() {
        return None;
    }
    let all = solution.plastic_curvature.iter();
    let most = all.map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    if most == 0.0 {
        return Some("friction against bending has not slid".to_owned());
    }
    let held =
        format!("friction against bending holds a curvature of up to {} 1/m", number(most, 4));
    let pulls = solution.cables.iter().any(|cable| cable.tension != Some(0.0));
    let (bend, _) = solution.disks.bend();
    Some(if pulls || !case.loads.is_none() {
        format!("{held}: the robot does not come back to its shape at rest by itself")
    } else {
        format!("{held}: without tension and load the robot stays bent by {}", degrees(bend))
    })
}
