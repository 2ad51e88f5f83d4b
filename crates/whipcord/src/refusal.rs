//! Refusals that several models share.

use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::{Cable, Robot};

/// Refuses a robot without disks, for a model whose robots consist of them.
pub(crate) fn without_disks(model: ModelKind, robot: &Robot) -> Result<(), SolveError> {
    if robot.has_disks() {
        return Ok(());
    }
    Err(SolveError::Missing {
        model,
        path: "disks".to_owned(),
        advice: "add [disks], for example with `count = 10`, or use cosserat or constant-curvature, which model cables in channels",
    })
}

/// Refuses hole friction; `what` and `advice` are those of [`SolveError::Unsupported`].
pub(crate) fn hole_friction(
    model: ModelKind,
    robot: &Robot,
    what: &'static str,
    advice: &'static str,
) -> Result<(), SolveError> {
    match robot.cables().iter().position(Cable::has_friction) {
        None => Ok(()),
        Some(cable) => Err(SolveError::Unsupported {
            model,
            path: format!("cables[{cable}].friction"),
            what,
            advice,
        }),
    }
}

/// Refuses friction against bending; `what` and `advice` are those of [`SolveError::Unsupported`].
pub(crate) fn bending_friction(
    model: ModelKind,
    robot: &Robot,
    what: &'static str,
    advice: &'static str,
) -> Result<(), SolveError> {
    if !robot.has_bending_friction() {
        return Ok(());
    }
    let path = "backbone.yield_moment".to_owned();
    Err(SolveError::Unsupported { model, path, what, advice })
}

/// Refuses friction against bending in a model whose sections have none.
pub(crate) fn bending_friction_of_sections(
    model: ModelKind,
    robot: &Robot,
) -> Result<(), SolveError> {
    let what = "friction against bending of the backbone";
    let advice = "use cosserat, cosserat-disks, piecewise-constant-curvature, pseudo-rigid-body or four-bar with its strain energy, or remove `yield_moment`";
    bending_friction(model, robot, what, advice)
}

/// Refuses branches of a robot with friction against bending.
pub(crate) fn bending_friction_with_branches(
    model: ModelKind,
    robot: &Robot,
) -> Result<(), SolveError> {
    let what = "friction against bending of the backbone, for branches";
    let advice = "with friction the equilibria depend on all earlier commands and form no branches: remove `yield_moment`";
    bending_friction(model, robot, what, advice)
}

/// Refuses branches of a robot with hole friction.
pub(crate) fn friction_with_branches(model: ModelKind, robot: &Robot) -> Result<(), SolveError> {
    let what = "friction at the holes, for branches";
    let advice = "with friction the equilibria depend on all earlier commands and form no branches: set the friction to 0";
    hole_friction(model, robot, what, advice)
}

/// Refuses to follow equilibria under a growing load, on behalf of a model that takes no loads.
pub(crate) fn branches(model: ModelKind) -> SolveError {
    SolveError::Unsupported {
        model,
        path: "a request for branches".to_owned(),
        what: "it takes no loads, and its shapes are no equilibria under forces",
        advice: "use cosserat, cosserat-disks, piecewise-constant-curvature or pseudo-rigid-body, or four-bar with the objective strain-energy and the length rule free",
    }
}

/// Refuses movable objects, on behalf of a model that does not know how stiff the robot is.
pub(crate) fn movable_objects(model: ModelKind, case: &Case) -> Result<(), SolveError> {
    if case.obstacles.iter().all(|obstacle| obstacle.movable.is_none()) {
        return Ok(());
    }
    Err(SolveError::Missing {
        model,
        path: "backbone.young_modulus".to_owned(),
        advice: "a movable object is held by forces: give the stiffness of the backbone, or remove the mass of the object",
    })
}

/// Refuses derivatives of a case with obstacles.
pub(crate) fn derivatives_among_obstacles(model: ModelKind, case: &Case) -> Result<(), SolveError> {
    let advice = "remove the obstacles, or take finite differences of neighbouring solutions";
    among_obstacles(("derivatives", advice), model, case)
}

/// Refuses branches of a case with obstacles.
pub(crate) fn branches_among_obstacles(model: ModelKind, case: &Case) -> Result<(), SolveError> {
    let advice = "a path of equilibria is followed while its equations stay the same, and contacts come and go on it: remove the obstacles, or raise the load in several `[[steps]]`, each from the equilibrium before";
    among_obstacles(("branches", advice), model, case)
}

fn among_obstacles(
    (what, advice): (&str, &'static str),
    model: ModelKind,
    case: &Case,
) -> Result<(), SolveError> {
    if case.obstacles.is_empty() {
        return Ok(());
    }
    let path = format!("a request for {what}");
    Err(SolveError::Unsupported { model, path, what: "the case has obstacles", advice })
}
