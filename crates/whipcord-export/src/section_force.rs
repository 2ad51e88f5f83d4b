//! The force that the rod itself bears in its sections.

use whipcord::{Case, Robot, Solution, Vec3};
use whipcord_numerics::GAUSS_2;

use crate::answers::weight;
use crate::drawing::Drawing;
use crate::nodal::nodal_loads;

/// For each piece between two stations the force in N that the rod beyond its middle exerts on what is before it, in the world: what
/// acts beyond, less what the cables bear. `None` from a model that knows no forces.
pub fn section_forces(
    robot: &Robot,
    case: &Case,
    drawing: &Drawing<'_>,
    solution: &Solution,
) -> Option<Vec<Vec3>> {
    let shape = &solution.shape;
    let s = &shape.arc_length;
    let loads = nodal_loads(&case.loads, case.base.rotation, s);
    let gravity = weight(case);
    let masses = masses_beyond_middles(robot, case, s);
    let mut forces: Vec<Vec3> = masses.iter().map(|mass| gravity * *mass).collect();
    for load in &loads {
        let force = match load.follower {
            true => shape.poses[load.node].rotation.rotate(load.force),
            false => load.force,
        };
        forces.iter_mut().take(load.node).for_each(|sum| *sum += force);
    }
    for contact in &solution.contacts {
        let force = contact.normal * contact.force? + contact.friction.unwrap_or(Vec3::ZERO);
        let pieces = s.windows(2).zip(&mut forces);
        let before = pieces.filter(|(ends, _)| 0.5 * (ends[0] + ends[1]) < contact.arc_length);
        before.for_each(|(_, sum)| *sum += force);
    }
    for (i, state) in solution.cables.iter().enumerate() {
        let common = state.tension?;
        for pair in drawing.cable(solution, i).windows(2) {
            let [(from, start), (to, end)] = [pair[0], pair[1]];
            let way = end - start;
            for k in from..to {
                let (span, _) = robot.disks().locate(0.5 * (s[k] + s[k + 1]));
                let tension = state.span_tensions.get(span).copied().unwrap_or(common);
                forces[k] -= way * (tension / way.norm());
            }
        }
    }
    Some(forces)
}

/// Mass in kg of backbone, disks and what they carry beyond the middle of each piece.
fn masses_beyond_middles(robot: &Robot, case: &Case, s: &[f64]) -> Vec<f64> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let density = |s: f64| backbone.linear_density_at(disks, s).unwrap_or(0.0);
    let between = |from: f64, to: f64| {
        let nodes = GAUSS_2.nodes.into_iter().zip(GAUSS_2.weights);
        (to - from) * nodes.map(|(c, w)| w * density(from + c * (to - from))).sum::<f64>()
    };
    let plates = if robot.has_disks() { &disks.arc_lengths[..] } else { &[] };
    let points: Vec<(f64, f64)> = plates
        .iter()
        .map(|at| (*at, disks.mass))
        .chain(case.loads.masses.iter().map(|mass| (mass.at, mass.mass)))
        .collect();
    let mut beyond = 0.0;
    let mut masses: Vec<f64> = s
        .windows(2)
        .rev()
        .map(|ends| {
            let middle = 0.5 * (ends[0] + ends[1]);
            let whole = beyond + between(middle, ends[1]);
            beyond = whole + between(ends[0], middle);
            let lumps = points.iter().filter(|(at, _)| *at > middle);
            whole + lumps.map(|(_, mass)| mass).sum::<f64>()
        })
        .collect();
    masses.reverse();
    masses
}
