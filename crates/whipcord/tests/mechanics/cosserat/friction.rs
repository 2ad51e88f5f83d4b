//! Cables with friction along their curve: closed forms, an integration of the same law that is written here, and what must
//! hold for any robot.

use std::time::Instant;

use crate::common::{accurate, bending_stiffness, helix, paper_backbone, straight};
use crate::cosserat_disks::friction_study::{divided, rubbing_robots};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Actuation, BranchOptions, Budget, Cable, CableCommand, Case, Disks, Loads, Model, ModelKind,
    NoStability, Robot, Routing, Shortening, SlipState, Solution, SolveError, Statics, Stations,
    UnitQuaternion, Vec3,
};

const LENGTH: f64 = 0.18;

fn model() -> Model {
    Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural)
}

fn with_steps(steps: usize) -> Model {
    Model::Cosserat(Options { accuracy: Accuracy::Steps(steps), ..accurate() })
}

fn robot(sections: usize, cables: Vec<Cable>) -> Robot {
    let disks = Disks::equally_spaced(LENGTH, sections + 1, 0.008);
    Robot::new(paper_backbone(), disks, cables).unwrap()
}

fn cable(routing: Routing, friction: f64) -> Cable {
    Cable { friction: Some(friction), ..Cable::new(format!("{routing:?}"), routing) }
}

/// Several steps of actuation by tensions.
fn steps(tensions: &[&[f64]], loads: &Loads) -> Case {
    let (last, before) = tensions.split_last().unwrap();
    let commands = |tensions: &&[f64]| Case::with_tensions(tensions).commands;
    let before = before.iter().map(commands).collect();
    Case { before, loads: loads.clone(), ..Case::with_tensions(last) }
}

fn solve(model: &Model, robot: &Robot, case: &Case) -> Solution {
    model.solve(robot, case).unwrap_or_else(|error| panic!("{error}\n{case:?}"))
}

fn bend(solution: &Solution) -> f64 {
    solution.disks.tip().rotation.log().norm()
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

fn tip_force() -> Loads {
    Loads { tip_force: Vec3::new(0.03, 0.05, -0.02), ..Loads::default() }
}

#[test]
fn a_straight_cable_pulled_from_rest_bends_by_the_closed_form() {
    for (friction, tension) in [(0.05, 1.0), (0.2, 4.0), (0.6, 6.0), (1.5, 3.0)] {
        let robot = robot(6, vec![cable(straight(30.0), friction)]);
        let stiffness = bending_stiffness(&robot);
        let solution = solve(&model(), &robot, &Case::with_tensions(&[tension]));
        let angle = (1.0 + friction * 0.008 * tension * LENGTH / stiffness).ln() / friction;
        let found = bend(&solution);
        assert!((found / angle - 1.0).abs() < 2e-6, "{found} and {angle}");
        // Of the tension the same law leaves e^(−μφ) at the end.
        let states = &solution.cables[0].slip_states;
        assert!(states.len() == 6 && states.iter().all(|state| *state == SlipState::Pulled));
        assert_eq!(solution.diagnostics.stability_absent, Some(NoStability::Sliding));
        assert_eq!(solution.cables[0].tension, Some(tension));
    }
}

/// The strains of a section of the paper's rod, by fixed-point iteration of eqs. (1) to (3), and the direction of its cable.
fn section(robot: &Robot, s: f64, tension: f64, force: Vec3, moment: Vec3) -> (Vec3, Vec3, Vec3) {
    let (young, shear) = (1.1e9, 1.1e9 / 2.6);
    let area = core::f64::consts::PI * 0.003_f64.powi(2) / 4.0;
    let second = core::f64::consts::PI * 0.003_f64.powi(4) / 64.0;
    let (stretch, bending) = (
        Vec3::new(1.0 / (shear * area), 1.0 / (shear * area), 1.0 / (young * area)),
        Vec3::new(1.0 / (young * second), 1.0 / (young * second), 0.5 / (shear * second)),
    );
    let point = robot.routes()[0].at(s);
    let (mut v, mut u, mut t) = (Vec3::Z, Vec3::ZERO, Vec3::Z);
    for _ in 0..40 {
        let tangent = v + u.cross(point.offset) + point.slope;
        t = tangent * (1.0 / tangent.norm());
        v = Vec3::Z + stretch.scale(force - tension * t);
        u = bending.scale(moment - tension * point.offset.cross(t));
    }
    (v, u, t)
}

/// The rod with one cable that is pulled from rest, integrated from its base by the midpoint rule: place and rotation of the tip,
/// the moment that is left there, and the tension at the end of the cable.
fn integrate(
    robot: &Robot,
    (tension, friction): (f64, f64),
    (force, base_moment): (Vec3, Vec3),
    count: usize,
) -> (Vec3, UnitQuaternion, Vec3, f64) {
    let h = LENGTH / count as f64;
    let (mut position, mut rotation, mut moment) =
        (Vec3::ZERO, UnitQuaternion::IDENTITY, base_moment);
    // Past the mouth of the channel, where the cable turns from the base's axis into its own direction.
    let (mut here, mut before) = (tension, Vec3::Z);
    for _ in 0..4 {
        before = section(robot, 0.0, here, force, base_moment).2;
        here = tension * (-friction * before.z.acos()).exp();
    }
    for k in 0..count {
        let s = (k as f64 + 0.5) * h;
        // From the middle of the step before to that of this one.
        let (mut next, mut half) = (here, rotation);
        let (mut middle_moment, mut strains) = (moment, (Vec3::Z, Vec3::ZERO));
        let mut direction = before;
        for _ in 0..4 {
            let to_body = half.conjugate();
            let (v, u, t) =
                section(robot, s, next, to_body.rotate(force), to_body.rotate(middle_moment));
            half = rotation * UnitQuaternion::exp(0.5 * h * u);
            middle_moment = moment - 0.5 * h * half.rotate(v).cross(force);
            direction = half.rotate(t);
            let turn = before.cross(direction).norm().atan2(before.dot(direction));
            next = here * (-friction * turn).exp();
            strains = (v, u);
        }
        let (v, u) = strains;
        let velocity = half.rotate(v);
        position += h * velocity;
        moment -= h * velocity.cross(force);
        rotation = (rotation * UnitQuaternion::exp(h * u)).renormalized();
        (here, before) = (next, direction);
    }
    (position, rotation, moment, here)
}

/// [`integrate`] without what halving the steps removes of its error.
fn integrate_finely(robot: &Robot, cable: (f64, f64), loads: (Vec3, Vec3)) -> (Vec3, Vec3, f64) {
    let [coarse, fine] = [1000, 2000].map(|count| integrate(robot, cable, loads, count));
    let finer = |a: Vec3, b: Vec3| b + (b - a) * (1.0 / 3.0);
    (finer(coarse.0, fine.0), finer(coarse.2, fine.2), fine.3 + (fine.3 - coarse.3) / 3.0)
}

#[test]
fn a_helical_cable_obeys_the_capstan_equation_along_its_curve() {
    for (turns, friction, tension) in [(0.6, 0.3, 4.0), (-1.2, 0.1, 5.0), (0.25, 0.8, 3.0)] {
        let robot = robot(5, vec![cable(helix(20.0, turns), friction)]);
        let solution = solve(&model(), &robot, &Case::with_tensions(&[tension]));
        let (tip, _, end) = integrate_finely(&robot, (tension, friction), (Vec3::ZERO, Vec3::ZERO));
        let error = (solution.disks.tip().position - tip).norm();
        assert!(error < 2e-6 * LENGTH, "{turns}: {error:e}");
        // The last span's tension is its mean, which is greater than that at its end.
        let last = solution.cables[0].span_tensions.last().unwrap();
        assert!(end < *last && *last < end * 1.2, "{end} {last}");
    }
}

#[test]
fn the_moment_at_the_base_balances_the_force_at_the_tip_with_friction() {
    for (routing, friction) in [(straight(0.0), 0.3), (helix(20.0, 0.6), 0.2)] {
        let robot = robot(5, vec![cable(routing, friction)]);
        let case = Case { loads: tip_force(), ..Case::with_tensions(&[3.5]) };
        let solution = solve(&model(), &robot, &case);
        let base = solution.base_wrench.unwrap();
        let (tip, left, _) =
            integrate_finely(&robot, (3.5, friction), (case.loads.tip_force, base.moment));
        let error = (solution.disks.tip().position - tip).norm();
        assert!(error < 4e-6 * LENGTH, "{error:e}");
        assert!(left.norm() < 1e-5 * base.moment.norm(), "{left:?} of {base:?}");
    }
}

#[test]
fn many_disks_come_near_the_rod_with_friction() {
    let paths: [&[&[f64]]; 3] = [&[&[3.5]], &[&[3.5], &[2.2]], &[&[3.5], &[3.2]]];
    for (routing, loads) in [
        (straight(0.0), Loads::default()),
        (helix(10.0, 0.5), Loads::default()),
        (helix(10.0, 0.5), tip_force()),
    ] {
        for path in paths {
            let case = steps(path, &loads);
            let at = |sections: usize, model: &Model| {
                solve(model, &robot(sections, vec![cable(routing.clone(), 0.25)]), &case)
            };
            let rod = at(8, &model());
            let disks = |sections: usize| {
                let model = Model::CosseratDisks(Options::default());
                let solution = at(sections, &model);
                (solution.disks.tip().position - rod.disks.tip().position).norm() / LENGTH
            };
            let [few, many] = [disks(8), disks(32)];
            assert!(many < 0.2 * few + 3e-4 && many < 1.5e-3, "{path:?}: {few:e} {many:e}");
        }
    }
}

#[test]
fn pulling_and_releasing_differ() {
    let robot = robot(6, vec![cable(helix(0.0, 0.3), 0.3)]);
    for loads in [Loads::default(), tip_force()] {
        let at = |path: &[&[f64]]| solve(&model(), &robot, &steps(path, &loads));
        let pulled = at(&[&[2.5]]);
        let released = at(&[&[4.0], &[2.5]]);
        let hardly = at(&[&[4.0], &[3.6]]);
        let least = at(&[&[4.0], &[0.0]]);
        // What is pulled more, the other way round.
        assert!(bend(&released) > bend(&pulled) + 0.05, "{} {}", bend(&released), bend(&pulled));
        assert_eq!(hardly.cables[0].slip_states[0], SlipState::Released);
        assert_ne!(hardly.cables[0].slip_states[5], SlipState::Released);
        if loads.is_none() {
            let spans = &released.cables[0].span_tensions;
            assert!(spans[..5].is_sorted(), "{spans:?}");
        }

        assert!(pulled.cables[0].span_tensions.windows(2).all(|pair| pair[0] > pair[1]));
        assert!(least.cables[0].span_tensions.iter().all(|&tension| tension < 1e-9));
    }
}

#[test]
fn finer_grids_change_the_answer_less_and_less() {
    let cables = vec![cable(helix(0.0, 0.4), 0.3), cable(straight(150.0), 0.2)];
    let robot = robot(6, cables);
    let case = steps(&[&[3.5, 1.0]], &tip_force());
    let [a, b, c] = [6, 12, 24].map(|count| solve(&with_steps(count), &robot, &case));
    let [first, second] = [apart(&a, &b), apart(&b, &c)];
    assert!(second < first / 5.0 && second < 2e-5 * LENGTH, "{first:e} {second:e}");
    // Where a cable sticks, the place where it does moves with the grid.
    let case = steps(&[&[3.5, 1.0], &[3.2, 1.2]], &tip_force());
    let [b, c] = [24, 48].map(|count| solve(&with_steps(count), &robot, &case));
    assert!(apart(&b, &c) < 1e-4 * LENGTH, "{:e}", apart(&b, &c));
}

#[test]
fn the_division_of_a_step_does_not_matter() {
    let robot = robot(6, vec![cable(helix(0.0, 0.4), 0.3), cable(straight(150.0), 0.2)]);
    for loads in [Loads::default(), tip_force()] {
        for [from, to] in [[[0.0, 0.0], [3.0, 1.5]], [[3.0, 0.5], [1.0, 2.5]]] {
            let between = |part: f64| {
                let at = |i: usize| from[i] + part * (to[i] - from[i]);
                [at(0), at(1)]
            };
            let in_parts = |count: usize| {
                let parts = (0..=count).map(|k| between(k as f64 / count as f64));
                let all: Vec<[f64; 2]> = parts.collect();
                let all: Vec<&[f64]> = all.iter().map(|tensions| &tensions[..]).collect();
                solve(&model(), &robot, &steps(&all, &loads))
            };
            let [whole, parts] = [1, 7].map(in_parts);
            let unit = whole.disks.tip().position.x.hypot(whole.disks.tip().position.y);
            assert!(apart(&whole, &parts) < 3e-3 * unit, "{:e}", apart(&whole, &parts) / unit);
        }
    }
}

#[test]
fn lengths_give_back_the_tensions_with_friction() {
    for stiffness in [None, Some(2000.0)] {
        let elastic = |cable: Cable| Cable { axial_stiffness: stiffness, ..cable };
        let cables = vec![cable(helix(0.0, 0.4), 0.3), cable(straight(150.0), 0.2)];
        let robot = robot(6, cables.into_iter().map(elastic).collect());
        for loads in [Loads::default(), tip_force()] {
            let case = steps(&[&[3.0, 1.5]], &loads);
            let pulled = solve(&model(), &robot, &case);
            let command = |cable: &whipcord::CableState| {
                let mean = cable.span_tensions.iter().sum::<f64>() / 6.0;
                let stretch = stiffness.map_or(0.0, |k| mean * cable.initial_length / k);
                let shortening = cable.initial_length - cable.length + stretch;
                CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) }
            };
            let commands = pulled.cables.iter().map(command).collect();
            let by_length = Case { commands, ..case };
            let found = solve(&model(), &robot, &by_length);
            assert!(apart(&pulled, &found) < 1e-4 * LENGTH, "{:e}", apart(&pulled, &found));
            for (a, b) in pulled.cables.iter().zip(&found.cables) {
                let [a, b] = [a, b].map(|cable| cable.tension.unwrap());
                assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
            }
        }
    }
}

#[test]
fn steps_in_one_go_with_friction_are_those_one_by_one() {
    let robot = robot(5, vec![cable(helix(0.0, 0.4), 0.3), Cable::new("b", straight(150.0))]);
    let case = steps(&[&[3.0, 1.0], &[1.0, 1.2], &[2.5, 0.8]], &tip_force());
    let mut prepared = model().prepare(&robot, &case.loads).unwrap();
    let all = prepared.solve_all(&case).unwrap();
    for (walked, step) in all.iter().zip(case.steps()) {
        let alone = solve(&model(), &robot, &step);
        assert!(apart(walked, &alone) < 2e-4 * LENGTH, "{:e}", apart(walked, &alone));
        assert_eq!(walked.cables[0].slip_states.len(), 5);
        assert!(walked.cables[1].slip_states.is_empty());
        assert_eq!(walked.cables[1].tension, step.commands[1].tension);
    }
}

#[test]
fn a_cable_with_friction_may_end_between_disks_and_followers_may_act() {
    let cables = vec![
        Cable { ends_at: Some(0.101), ..cable(helix(0.0, 0.4), 0.3) },
        cable(straight(150.0), 0.2),
    ];
    let robot = robot(5, cables);
    let tip_force = Vec3::new(0.0, 0.04, -0.02);
    let loads = Loads { tip_force, tip_follower: true, ..Loads::default() };
    let case = steps(&[&[3.0, 1.5], &[2.5, 1.5]], &loads);
    let solution = solve(&model(), &robot, &case);
    assert_eq!(solution.cables[0].span_tensions.len(), 3);
    assert_eq!(solution.cables[1].span_tensions.len(), 5);
    let force = solution.base_wrench.unwrap().force;
    let turned = solution.disks.tip().rotation.rotate(tip_force);
    assert!((force - turned).norm() < 1e-8, "{force:?} {turned:?}");
}

#[test]
fn without_tension_friction_does_not_matter() {
    let with = |friction| {
        let cables = vec![
            Cable { friction, ..Cable::new("a", straight(0.0)) },
            Cable::new("b", straight(120.0)),
        ];
        let case = Case { loads: tip_force(), ..Case::with_tensions(&[0.0, 2.0]) };
        solve(&model(), &robot(5, cables), &case)
    };
    let [smooth, rough] = [with(None), with(Some(0.4))];
    assert!(apart(&smooth, &rough) < 2e-6 * LENGTH);
    assert_eq!(smooth.diagnostics.stable, Some(true));
    assert_eq!(rough.diagnostics.stable, Some(true));
}

#[test]
fn what_friction_has_no_answer_to_is_refused() {
    let robot = robot(5, vec![cable(straight(0.0), 0.3)]);
    let case = Case::with_tensions(&[2.0]);
    let mut prepared = model().prepare(&robot, &case.loads).unwrap();
    let refused = |error: SolveError| match error {
        SolveError::Unsupported { path, .. } => assert_eq!(path, "cables[0].friction"),
        other => panic!("{other}"),
    };
    refused(prepared.branches(&case, &BranchOptions::default()).unwrap_err());
}

#[test]
fn substeps_that_a_finer_grid_cannot_follow_are_divided_there() {
    // One of the study: the second step of actuation begins with a substep in which the response tells on the coarse grid alone where the
    // cables come to rest.
    let (robot, case) = rubbing_robots(120).nth(112).unwrap();
    let solution = solve(&model(), &robot, &case);
    let fine = solve(&with_steps(32).with_budget(Budget::UNLIMITED), &robot, &divided(&case, 4));
    let difference = apart(&solution, &fine) / robot.backbone().length;
    assert!(difference < 6e-4, "{difference:e}");
}

/// Whether the reason of a refusal holds. Of a budget that is spent: ten times as much leads to an answer. Of a tolerance that is not met: finer grids differ by more
/// than that. Of all others: no way on a fine grid, in small steps of actuation, leads to an answer either.
fn is_confirmed(error: &SolveError, robot: &Robot, case: &Case) -> bool {
    match error {
        SolveError::BudgetSpent { .. } => {
            let Budget { iterations, integration_steps } = Budget::default();
            let more =
                Budget { iterations: 10 * iterations, integration_steps: 10 * integration_steps };
            model().with_budget(more).solve(robot, case).is_ok()
        }
        SolveError::StepsTooCoarse { tolerance, .. } => {
            let [coarse, fine] = [128, 256].map(|steps| with_steps(steps).solve(robot, case));
            !matches!((coarse, fine), (Ok(a), Ok(b)) if apart(&a, &b) <= *tolerance)
        }
        _ => with_steps(32).solve(robot, &divided(case, 12)).is_err(),
    }
}

/// The robots of the study of holes, with their cables on curves.
fn study(count: usize, confirm: bool) {
    let (mut asked, mut solved, mut unconfirmed) = (0, 0, 0);
    let mut times = Vec::new();
    for (n, (robot, case)) in rubbing_robots(count).enumerate() {
        asked += 1;
        let begun = Instant::now();
        let answer = model().solve(&robot, &case);
        let time = begun.elapsed().as_secs_f64();
        times.push(time);
        match answer {
            Ok(solution) => {
                solved += 1;
                assert!(solution.disks.tip().position.is_finite());
            }
            Err(error) => {
                let confirmed = !confirm || is_confirmed(&error, &robot, &case);
                unconfirmed += usize::from(!confirmed);
                println!("{n}: {error} (confirmed: {confirmed}, {time:.3} s)");
            }
        }
    }
    times.sort_by(f64::total_cmp);
    let at = |part: f64| times[((asked as f64 * part) as usize).min(asked - 1)] * 1e3;
    println!(
        "{asked} robots: {solved} solved, {unconfirmed} refused without confirmation; {:.1} ms in the median, {:.1} ms for 95 %, {:.1} ms for 99 %, {:.1} ms at most",
        at(0.5),
        at(0.95),
        at(0.99),
        at(1.0)
    );
    assert!(solved as f64 >= 0.97 * asked as f64, "{solved} of {asked}");
}

#[test]
fn some_random_robots_with_friction_are_solved() {
    study(16, false);
}

/// `cargo test --release -p whipcord --test mechanics -- --ignored --nocapture cosserat::friction::`
#[test]
#[ignore = "minutes"]
fn random_robots_with_friction_are_solved() {
    study(1000, true);
}
