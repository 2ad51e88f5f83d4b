//! Backward derivatives are the transpose of the forward ones.

use super::kinds_of_load::under_spread_followers;
use super::{ROBOTS, Tested, bending_stiffness, by_length, differentiated, parameters, taut};
use crate::common::Wildness;
use whipcord::derivatives::{Change, Cotangent};
use whipcord::derivatives::{Hold, Place};
use whipcord::{Case, Parameter, Robot, Twist, Vec3};

/// Some numbers between −1 and 1, the same in every run.
fn noise(seed: usize) -> impl Iterator<Item = f64> {
    (1..).map(move |k: usize| {
        let x = ((seed * 7919 + k) as f64 * 12.9898).sin() * 43758.5453;
        2.0 * (x - x.floor()) - 1.0
    })
}

/// What a cotangent says a change is worth.
fn worth(change: &Change, cotangent: &Cotangent) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let base = change.base_wrench();
    let places = cotangent.places.iter().map(|(place, twist)| {
        let moved = change.twist(*place);
        moved.linear.dot(twist.linear) + moved.angular.dot(twist.angular)
    });
    places.sum::<f64>()
        + dot(change.lengths(), &cotangent.lengths)
        + dot(change.tensions(), &cotangent.tensions)
        + base.force.dot(cotangent.base_wrench.force)
        + base.moment.dot(cotangent.base_wrench.moment)
}

/// Size of the terms of [`worth`].
fn off_scale(change: &Change, cotangent: &Cotangent, robot: &Robot) -> f64 {
    let (length, stiffness) = (robot.backbone().length, bending_stiffness(robot));
    let force = length * length / stiffness;
    let places = cotangent.places.iter().map(|(place, _)| {
        let moved = change.twist(*place);
        moved.linear.norm() / length + moved.angular.norm()
    });
    let base = change.base_wrench();
    let list = |values: &[f64], f: f64| values.iter().map(|x| x.abs() * f).sum::<f64>();
    places.sum::<f64>()
        + list(change.lengths(), 1.0 / length)
        + list(change.tensions(), force)
        + base.force.norm() * force
        + base.moment.norm() * force / length
}

fn backward_equals_forward(tested: Tested) {
    let follower = |(robot, mut case): (Robot, Case)| {
        case.loads.tip_follower = true;
        for (i, point) in case.loads.points.iter_mut().enumerate() {
            point.follower = i % 2 == 0;
        }
        case.loads.tip_force *= 0.5;
        (robot, case)
    };
    let spread = |(i, (robot, case)): (usize, (Robot, Case))| {
        let case = under_spread_followers(&robot, &case, i % 2 == 0);
        (robot, case)
    };
    let robots = taut(tested, Wildness::LOADED, ROBOTS)
        .chain(taut(tested, Wildness::UNLOADED, ROBOTS))
        .chain(taut(tested, Wildness::LOADED, ROBOTS).map(follower))
        .chain(taut(tested, Wildness::LOADED, ROBOTS).enumerate().map(spread));
    for (i, (robot, case)) in robots.enumerate() {
        let (robot, case) = match i % 3 {
            0 => (robot, case),
            kind => by_length(tested, &robot, &case, kind == 1),
        };
        let list: Vec<Parameter> =
            parameters(tested, &robot, &case).into_iter().map(|(p, _)| p).collect();
        let (_, derivatives) = differentiated(tested, &robot, &case, &list);
        let cables = case.commands.len();
        let (length, stiffness) = (robot.backbone().length, bending_stiffness(&robot));
        let mut next = noise(i);
        let mut number = || next.next().unwrap();
        let mut vector = |f: f64| Vec3::new(number(), number(), number()) * f;
        let places =
            [Place::Tip, Place::Station(1), Place::Disk(0), Place::Disk(robot.disks().count() - 1)];
        let cotangent = Cotangent {
            places: places
                .into_iter()
                .map(|p| (p, Twist { linear: vector(1.0 / length), angular: vector(1.0) }))
                .collect(),
            base_wrench: whipcord::Wrench {
                force: vector(length * length / stiffness),
                moment: vector(length / stiffness),
            },
            lengths: noise(i + 1000).take(cables).map(|x| x / length).collect(),
            tensions: noise(i + 2000)
                .take(cables)
                .map(|x| x * length * length / stiffness)
                .collect(),
        };
        for hold in [Hold::Commands, Hold::Tensions, Hold::Lengths] {
            let gradient = derivatives.pull_back(&cotangent, hold);
            let compare = |what: &str, backward: f64, change: &Change| {
                let forward = worth(change, &cotangent);
                // Of the terms that the sums are made of.
                let size = off_scale(change, &cotangent, &robot);
                assert!(
                    (backward - forward).abs() <= 1e-10 * size,
                    "robot {i}, {hold:?}, {what}: {backward} and {forward}, of {size}"
                );
            };
            for (p, parameter) in list.iter().enumerate() {
                let change = derivatives.parameter(p, hold);
                compare(&parameter.to_string(), gradient.parameters[p], &change);
            }
            for place in [Place::Tip, Place::Station(2)] {
                let wrench = gradient.wrench(place);
                for component in 0..6 {
                    let backward = match component {
                        0..3 => wrench.force[component],
                        _ => wrench.moment[component - 3],
                    };
                    let change = derivatives.wrench(place, component, hold);
                    compare("wrench", backward, &change);
                }
            }
            if hold == Hold::Commands {
                for cable in 0..cables {
                    compare("command", gradient.commands[cable], &derivatives.command(cable));
                }
            }
        }
    }
}

for_every_model!(backward_equals_forward);
