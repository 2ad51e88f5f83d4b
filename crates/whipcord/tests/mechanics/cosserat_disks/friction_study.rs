//! Random robots whose cables rub in their holes, bent up to 180° under tip loads up to twice the buckling load of the
//! bare rod, with gravity, and led there in two steps of actuation: how many are answered, in what time, and whether the
//! reasons of those that are not are true.
//!
//! The whole study, which prints its table:
//! `cargo test --release -p whipcord --test mechanics -- --ignored --nocapture cosserat_disks::friction_study::`.

use std::time::Instant;

use proptest::collection::vec;
use proptest::prelude::*;
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::Options;
use whipcord::{
    Actuation, Cable, Case, Model, ModelKind, Robot, Solution, SolveError, Statics as _, Stations,
};

use super::study::{bent_by, robots};
use crate::common::{bending, model_with_forces, samples};

/// Friction coefficients of the cables, of which some do not rub, and the tensions of the step before, as parts of those
/// of the last.
fn friction() -> impl Strategy<Value = (Vec<Option<f64>>, Vec<f64>)> {
    let coefficient = prop_oneof![3 => (0.02..0.5).prop_map(Some), 1 => Just(None)];
    (vec(coefficient, 6), vec(0.0..1.6_f64, 6))
}

/// The robots of the study without friction, with friction and a step of actuation before the last.
pub fn rubbing_robots(count: usize) -> impl Iterator<Item = (Robot, Case)> {
    let robots = samples(robots(), count).enumerate();
    robots.zip(samples(friction(), count)).filter_map(|((n, (robot, case)), (mu, parts))| {
        let (mut case, _) = bent_by(&robot, &case, bending::target(n))?;
        let mut before = case.commands.clone();
        for (command, part) in before.iter_mut().zip(&parts) {
            command.tension = command.tension.map(|tension| tension * part);
        }
        case.before = vec![before];
        let cable = |(i, cable): (usize, &Cable)| Cable {
            friction: if i == 0 { Some(mu[0].unwrap_or(0.2)) } else { mu[i] },
            ..cable.clone()
        };
        let cables = robot.cables().iter().enumerate().map(cable).collect();
        let robot = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
        Some((robot, case))
    })
}

/// The case with every step of actuation divided into so many.
pub fn divided(case: &Case, parts: usize) -> Case {
    let mut before = Vec::new();
    let mut last: Option<Vec<whipcord::CableCommand>> = None;
    for step in case.before.iter().chain([&case.commands]) {
        for part in 1..=parts {
            let fraction = part as f64 / parts as f64;
            let mut commands = step.clone();
            for (i, command) in commands.iter_mut().enumerate() {
                let start = last.as_ref().and_then(|last| last[i].tension).unwrap_or(0.0);
                command.tension =
                    command.tension.map(|tension| start + fraction * (tension - start));
            }
            before.push(commands);
        }
        last = Some(step.clone());
    }
    let commands = before.pop().unwrap();
    Case { commands, before, ..case.clone() }
}

fn model(kind: ModelKind) -> Model {
    model_with_forces(kind, Stations::default(), Actuation::Natural)
}

/// Whether no way in small steps of actuation, of the rod on fine meshes, leads to an answer either.
fn none_is_found(kind: ModelKind, robot: &Robot, case: &Case) -> bool {
    let accuracy = Accuracy::Steps(6 * robot.disks().count());
    let finer = match kind {
        ModelKind::CosseratDisks => {
            Model::CosseratDisks(Options { accuracy, ..Options::default() })
        }
        kind => model(kind),
    };
    finer.solve(robot, &divided(case, 24)).is_err()
}

fn study(kind: ModelKind, count: usize) {
    let (mut solved, mut asked, mut unconfirmed) = (0, 0, 0);
    let mut times = Vec::new();
    for (n, (robot, case)) in rubbing_robots(count).enumerate() {
        asked += 1;
        let start = Instant::now();
        let outcome: Result<Solution, SolveError> = model(kind).solve(&robot, &case);
        times.push((start.elapsed().as_secs_f64() * 1e3, n));
        match outcome {
            Ok(solution) => {
                assert!(solution.disks.tip().position.is_finite());
                solved += 1;
            }
            Err(reason) => {
                let confirmed = none_is_found(kind, &robot, &case);
                println!(
                    "{kind} {n}: {reason} — {}",
                    if confirmed { "confirmed" } else { "NOT CONFIRMED" }
                );
                unconfirmed += usize::from(!confirmed);
            }
        }
    }
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "{kind}: {solved} of {asked} solved, {unconfirmed} refusals not confirmed; two steps in {:.1} ms (median), {:.0} ms (99 %), {:.0} ms (worst, robot {})",
        at(0.5).0,
        at(0.99).0,
        at(1.0).0,
        at(1.0).1
    );
    assert!(solved * 100 >= 99 * asked, "{kind}: {solved} of {asked}");
}

const MODELS: [ModelKind; 4] = [
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
    ModelKind::FourBar,
];

#[test]
fn random_robots_that_rub_are_solved_or_say_why_not() {
    for kind in MODELS {
        study(kind, 12);
    }
}

#[test]
#[ignore = "takes minutes: the whole study"]
fn a_thousand_random_robots_that_rub() {
    for kind in MODELS {
        study(kind, 1000);
    }
}
