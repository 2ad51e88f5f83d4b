//! The changes with commands alone against the exact derivatives of the same answers.

use super::{ROBOTS, Tested, bending_stiffness, by_length, options, taut};
use crate::common::Wildness;
use whipcord::cosserat::{Accuracy, Options};
use whipcord::derivatives::{Change, Place};
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, Model, Robot, Routing, Section, Solution, Twist,
    Vec3,
};

/// The greatest difference of two changes with a command, as a part of the greatest motion.
fn difference(a: &Change, b: &Change, length: f64) -> f64 {
    let places = (0..4).map(Place::Station).chain([Place::Disk(1), Place::Tip]);
    let size = |twist: Twist| twist.linear.norm() + length * twist.angular.norm();
    let greatest =
        |of: &Change| (0..4).map(|k| size(of.twist(Place::Station(k)))).fold(0.0, f64::max);
    let scale = greatest(b).max(1e-30);
    let motions = places.map(|place| {
        let (a, b) = (a.twist(place), b.twist(place));
        size(Twist { linear: a.linear - b.linear, angular: a.angular - b.angular })
    });
    let lengths = a.lengths().iter().zip(b.lengths()).map(|(a, b)| (a - b).abs());
    let tensions = b.tensions().iter().map(|t| t.abs()).fold(0.0, f64::max).max(1e-30);
    let pulls = a.tensions().iter().zip(b.tensions()).map(|(a, b)| (a - b).abs() / tensions);
    motions.chain(lengths).map(|x| x / scale).chain(pulls).fold(0.0, f64::max)
}

/// The greatest difference on so many steps, over the commands of random robots, a third of which are driven by all lengths and a third by some.
fn greatest_difference(tested: Tested, wild: Wildness, steps: Option<usize>) -> f64 {
    let mut worst: f64 = 0.0;
    for (i, (robot, case)) in taut(tested, wild, ROBOTS).enumerate() {
        let (robot, case) = match i % 3 {
            0 => (robot, case),
            kind => by_length(tested, &robot, &case, kind == 1),
        };
        let mut options = options(tested, &case);
        if let Some(steps) = steps {
            options = Options { accuracy: Accuracy::Steps(steps), ..options };
        }
        let mut prepared = tested.prepare(&robot, &case, &options).unwrap();
        let (solution, exact) = prepared.solve_with_derivatives(&case, None, &[]).unwrap();
        let (again, changes) =
            prepared.solve_with_command_changes(&case, Some(&solution), 0.0).unwrap();
        let off = again.disks.tip().position - solution.disks.tip().position;
        assert!(off.norm() <= 1e-9 * robot.backbone().length);
        for (cable, change) in changes.iter().enumerate() {
            let length = robot.backbone().length;
            worst = worst.max(difference(change, &exact.command(cable), length));
        }
    }
    worst
}

/// From a wrench at the base and tensions that are off by a part, the residual that is left is taken away but for about its square.
fn what_is_left_is_corrected(tested: Tested) {
    for (i, (robot, case)) in taut(tested, Wildness::LOADED, ROBOTS).enumerate() {
        let (robot, case) = match i % 3 {
            0 => (robot, case),
            kind => by_length(tested, &robot, &case, kind == 1),
        };
        let options = Options { accuracy: Accuracy::Steps(40), ..options(tested, &case) };
        let mut prepared = tested.prepare(&robot, &case, &options).unwrap();
        let solution = prepared.solve(&case, None).unwrap();
        let length = robot.backbone().length;
        let unit = bending_stiffness(&robot) / length;
        let off = |part: f64| {
            let mut near = solution.clone();
            let wrench = near.base_wrench.as_mut().unwrap();
            wrench.moment += Vec3::new(0.6, -0.8, 0.3) * (part * unit);
            for cable in &mut near.cables {
                cable.tension = cable.tension.map(|tension| tension * (1.0 + part));
            }
            let (found, _) = prepared.solve_with_command_changes(&case, Some(&near), 0.1).unwrap();
            let of = |a: &Solution| a.disks.tip().position;
            let lengths = found.cables.iter().zip(&solution.cables);
            let lengths = lengths.map(|(a, b)| (a.length - b.length).abs()).fold(0.0, f64::max);
            (of(&found) - of(&solution)).norm().max(lengths) / length
        };
        let [large, small] = [1e-3, 1e-4].map(off);
        assert!(large <= 1e-4 && small <= 0.1 * large.max(1e-8), "{i}: {large:.1e} {small:.1e}");
    }
}

fn changes_without_load_are_exact(tested: Tested) {
    let worst = greatest_difference(tested, Wildness::UNLOADED, None);
    assert!(worst <= 1e-8, "{worst:.1e}");
}

fn changes_under_load_are_near_the_exact_ones(tested: Tested) {
    let [coarse, fine] =
        [40, 80].map(|steps| greatest_difference(tested, Wildness::LOADED, Some(steps)));
    match tested {
        // Of order 4.
        Tested::Continuous => {
            assert!(fine <= 1e-3 && fine < 0.2 * coarse, "{coarse:.1e} {fine:.1e}");
        }
        _ => assert!(fine <= 1e-8, "{fine:.1e}"),
    }
}

/// Also in memory that is kept from the answer before.
fn rates_of_the_tip_are_those_of_all_derivatives(tested: Tested) {
    for wild in [Wildness::LOADED, Wildness::UNLOADED] {
        for (i, (robot, case)) in taut(tested, wild, 8).enumerate() {
            let (robot, case) = match i % 3 {
                0 => (robot, case),
                kind => by_length(tested, &robot, &case, kind == 1),
            };
            let options = options(tested, &case);
            let mut prepared = tested.prepare(&robot, &case, &options).unwrap();
            let solution = prepared.solve(&case, None).unwrap();
            let mut rates = vec![Twist::default(); 99];
            let length = robot.backbone().length;
            let size = |twist: Twist| twist.linear.norm() + length * twist.angular.norm();
            for _ in 0..2 {
                let exact = prepared.linearize(&case, &solution, &[]).unwrap();
                let exact = exact.actuation_jacobian(Place::Tip);
                prepared.tip_by_commands(&case, &solution, &mut rates).unwrap();
                assert_eq!(rates.len(), exact.len());
                let scale = exact.iter().map(|&twist| size(twist)).fold(0.0, f64::max);
                for (rate, exact) in rates.iter().zip(&exact) {
                    let off = Twist {
                        linear: rate.linear - exact.linear,
                        angular: rate.angular - exact.angular,
                    };
                    // Along the rod the same operations are done in the same order.
                    let bound = if let Tested::Continuous = tested { 0.0 } else { 1e-9 * scale };
                    assert!(size(off) <= bound, "{i}: {:.1e} of {scale:.1e}", size(off));
                }
            }
        }
    }
}

/// More cables than the processor's vectors have lanes, or none; some end early and some are slack.
#[test]
fn rods_of_any_number_of_cables_move_as_differences_say() {
    const LENGTH: f64 = 0.2;
    for cables in [0, 1, 5, 9, 17] {
        let material =
            Material { young_modulus: Some(2e9), poisson_ratio: Some(0.3), ..Default::default() };
        let section = Some(Section::circle(0.003));
        let backbone = Backbone { section, material, ..Backbone::new(LENGTH) };
        let cable = |k: u32| {
            let (start_angle, turns) = (f64::from(k), 0.7 - 0.3 * f64::from(k % 5));
            let routing = Routing::Helix { start_angle, turns, radius: 0.007 };
            let ends_at = (k % 3 == 1).then_some(0.1);
            Cable { ends_at, ..Cable::new(format!("{k}"), routing) }
        };
        let disks = Disks::equally_spaced(LENGTH, 11, 0.007);
        let robot = Robot::new(backbone, disks, (0..cables).map(cable).collect()).unwrap();
        let tensions: Vec<f64> = (0..cables)
            .map(|k| if k % 4 == 3 { 0.0 } else { 0.3 + 0.1 * f64::from(k % 7) })
            .collect();
        let model =
            Model::Cosserat(Options { accuracy: Accuracy::Steps(20), ..Options::default() });
        let mut prepared = model.prepare(&robot, &Loads::default()).unwrap();
        let case = Case::with_tensions(&tensions);
        let (_, changes) = prepared.solve_with_command_changes(&case, None, 0.0).unwrap();
        assert_eq!(changes.len(), tensions.len());
        for (cable, change) in changes.iter().enumerate() {
            // No tension is negative.
            let mut at = |steps: f64| {
                let mut moved = tensions.clone();
                moved[cable] += 1e-3 * steps;
                let solution = prepared.solve(&Case::with_tensions(&moved), None).unwrap();
                let lengths: Vec<f64> = solution.cables.iter().map(|cable| cable.length).collect();
                (solution.disks.tip().position, lengths)
            };
            let [a, b, c] = [0.0, 1.0, 2.0].map(&mut at);
            let rate = |a: f64, b: f64, c: f64| (4.0 * b - 3.0 * a - c) / 2e-3;
            let tip = Vec3::new(
                rate(a.0.x, b.0.x, c.0.x),
                rate(a.0.y, b.0.y, c.0.y),
                rate(a.0.z, b.0.z, c.0.z),
            );
            let scale = tip.norm().max(1e-3);
            assert!((change.twist(Place::Tip).linear - tip).norm() < 1e-5 * scale, "{cable}");
            for (k, found) in change.lengths().iter().enumerate() {
                let length = rate(a.1[k], b.1[k], c.1[k]);
                assert!((found - length).abs() < 1e-5 * scale, "{cable} {k}: {found} {length}");
            }
        }
    }
}

for_every_model!(
    changes_without_load_are_exact,
    changes_under_load_are_near_the_exact_ones,
    rates_of_the_tip_are_those_of_all_derivatives,
    what_is_left_is_corrected
);
