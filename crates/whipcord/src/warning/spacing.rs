//! What the spacing of the disks changes.

use super::geometry::is_soft;
use super::kinds::{SPACING, Warning};
use crate::case::{Case, PointMass};
use crate::kind::ModelKind;
use crate::model::Model;
use crate::robot::{Cable, Disks, Robot, Routing};
use crate::solution::Solution;
use crate::stations::Stations;

/// Robots with more disks are not looked at: a solve would take long, and the spacing is fine.
const MOST_DISKS: usize = 200;

/// Whether half the spacing of the disks of a soft body changes its shape by more than [`SPACING`] of its
/// length; `coarse` is the answer of `model` to the case. Only [`ModelKind::CosseratDisks`] has a spacing to halve. It costs a
/// solve with twice as many sections, and nothing for a robot that is no soft body ([`super::SOFT`]): its disks are real.
#[must_use]
pub fn of_spacing(model: &Model, robot: &Robot, case: &Case, coarse: &Solution) -> Option<Warning> {
    if !is_soft(robot)
        || robot.cables().is_empty()
        || robot.disks().count() > MOST_DISKS
        || model.kind() != ModelKind::CosseratDisks
        || !case.obstacles.is_empty()
    {
        return None;
    }
    let (finer, case) = with_half_the_spacing(robot, case)?;
    let mut prepared = model.at(Stations::Disks).prepare(&finer, &case.loads).ok()?;
    let fine = prepared.solve_to_the_end(&case).ok()?;
    let matching = fine.disks.positions().step_by(2);
    let change =
        coarse.disks.positions().zip(matching).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let length = robot.backbone().length;
    (change > SPACING * length).then_some(Warning::DiskSpacing {
        change,
        length,
        disks: robot.disks().count(),
    })
}

/// The robot with a disk more between each two, at which cables pass midway between their holes. The masses of
/// the disks stay where they are.
fn with_half_the_spacing(robot: &Robot, case: &Case) -> Option<(Robot, Case)> {
    let disks = robot.disks();
    let finer = Disks {
        arc_lengths: with_means(&disks.arc_lengths),
        are_present: disks.are_present,
        hole_circle_radii: with_means(&disks.hole_circle_radii),
        holes: disks.holes.map(|holes| 2 * holes),
        mass: 0.0,
        outer_radius: disks.outer_radius,
        thickness: None,
    };
    let cables = robot.cables().iter().map(|cable| {
        let routing = match (&cable.routing, disks.holes) {
            (Routing::Holes { holes, interpolation }, Some(count)) => Routing::Holes {
                holes: with_holes_between(holes, count),
                interpolation: *interpolation,
            },
            (other, _) => other.clone(),
        };
        Cable { routing, ..cable.clone() }
    });
    let backbone = robot.backbone().apart_from(disks);
    let finer = robot.with_parts(backbone, finer, cables.collect()).ok()?;
    let mut case = case.clone();
    if disks.mass > 0.0 {
        let mass = |&at: &f64| PointMass { at, mass: disks.mass };
        case.loads.masses.extend(disks.arc_lengths.iter().map(mass));
    }
    Some((finer, case))
}

fn with_means(values: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> =
        values.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]).collect();
    all.extend(values.last());
    all
}

/// Holes of disks with twice as many: hole k is hole 2k − 1 of them, and midway between two holes, the shorter
/// way round, there is one.
fn with_holes_between(holes: &[usize], count: usize) -> Vec<usize> {
    let doubled = |hole: usize| 2 * (hole - 1);
    let mut all = Vec::with_capacity(2 * holes.len());
    for pair in holes.windows(2) {
        let forward = (pair[1] + count - pair[0]) % count;
        let between = if 2 * forward <= count {
            doubled(pair[0]) + forward
        } else {
            doubled(pair[0]) + 2 * count - (count - forward)
        };
        all.extend([doubled(pair[0]), between % (2 * count)]);
    }
    all.extend(holes.last().map(|&hole| doubled(hole)));
    all.iter().map(|hole| hole + 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_between_lie_midway_the_shorter_way_round() {
        assert_eq!(with_holes_between(&[1, 2, 4], 12), [1, 2, 3, 5, 7]);
        assert_eq!(with_holes_between(&[12, 1], 12), [23, 24, 1]);
        assert_eq!(with_holes_between(&[1, 12], 12), [1, 24, 23]);
        assert_eq!(with_holes_between(&[5, 5], 6), [9, 9, 9]);
    }
}
