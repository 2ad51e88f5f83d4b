//! Cables that rub in their holes, and cables that stretch.

use crate::common;
use crate::common::accurate;
use crate::common::{helix, paper_backbone, straight};
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::Options;
use whipcord::{
    Cable, CableCommand, CableState, Case, Disks, Loads, Model, Robot, Routing, Shortening,
    SlipState, Solution, SolveError, Statics, Vec3,
};

fn solve(robot: &Robot, case: &Case) -> Solution {
    Model::CosseratDisks(accurate())
        .solve(robot, case)
        .unwrap_or_else(|error| panic!("{error}\n{case:?}"))
}

fn robot(sections: usize, cables: Vec<Cable>) -> Robot {
    Robot::new(paper_backbone(), Disks::equally_spaced(0.18, sections + 1, 0.008), cables).unwrap()
}

fn rubbing(routing: Routing, mu: f64) -> Cable {
    Cable { friction: Some(mu), ..Cable::new(format!("{routing:?}"), routing) }
}

fn one_rubbing(sections: usize, mu: f64) -> Robot {
    robot(sections, vec![rubbing(straight(0.0), mu)])
}

/// The answers to all steps, each with those before it.
fn path(robot: &Robot, steps: &[Vec<CableCommand>], loads: &Loads) -> Vec<Solution> {
    let (commands, before) = steps.split_last().unwrap();
    let case = Case {
        commands: commands.clone(),
        before: before.to_vec(),
        loads: loads.clone(),
        ..Case::default()
    };
    let mut solutions = Vec::new();
    let model = Model::CosseratDisks(accurate());
    let walked = model.prepare(robot, loads).unwrap().solve_steps(&case, |s| solutions.push(s));
    walked.unwrap_or_else(|(step, error)| panic!("{step}: {error}\n{case:?}"));
    solutions
}

/// Going on from a step gives what going all the way again does.
#[test]
fn steps_in_one_go_are_those_one_by_one() {
    let mut cables = vec![rubbing(helix(20.0, 0.6), 0.3), rubbing(straight(200.0), 0.2)];
    for rubs in [true, false] {
        if !rubs {
            cables.iter_mut().for_each(|cable| cable.friction = None);
        }
        let robot = robot(6, cables.clone());
        let steps = pulls(&[&[3.0, 1.0], &[0.4, 1.5], &[2.5, 0.8], &[2.6, 0.7]]);
        for loads in [Loads::default(), several_loads()] {
            let (last, before) = steps.split_last().unwrap();
            let case = Case {
                commands: last.clone(),
                before: before.to_vec(),
                loads: loads.clone(),
                ..Case::default()
            };
            let walked = path(&robot, &steps, &loads);
            assert_eq!(walked.len(), 4);
            for (walked, step) in walked.iter().zip(case.steps()) {
                let alone = solve(&robot, &step);
                assert!(apart(walked, &alone) < 1e-10, "{}", apart(walked, &alone));
                for (a, b) in walked.cables.iter().zip(&alone.cables) {
                    assert_eq!(a.slip_states, b.slip_states);
                    assert!((a.tension.unwrap() - b.tension.unwrap()).abs() < 1e-9);
                }
            }
        }
    }
}

fn pulls(tensions: &[&[f64]]) -> Vec<Vec<CableCommand>> {
    tensions.iter().map(|t| Case::with_tensions(t).commands).collect()
}

fn along(robot: &Robot, tensions: &[f64]) -> Vec<Solution> {
    let steps: Vec<_> = tensions.iter().map(|&t| Case::with_tensions(&[t]).commands).collect();
    path(robot, &steps, &Loads::default())
}

fn bend(solution: &Solution) -> f64 {
    solution.disks.tip().rotation.log().norm()
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

/// Way of a cable from hole to hole, as the poses of the disks have it.
fn pieces(robot: &Robot, cable: usize, solution: &Solution) -> Vec<Vec3> {
    let route = &robot.routes()[cable];
    let passed = solution.disks.arc_length.iter().filter(|&&s| s <= route.end() + 1e-12).count();
    let hole = |i: usize| {
        let s = solution.disks.arc_length[i];
        solution.disks.poses[i].transform(route.at(s).offset)
    };
    (1..passed).map(|i| hole(i) - hole(i - 1)).collect()
}

/// Angles by which a cable turns in the holes.
fn turns(robot: &Robot, cable: usize, solution: &Solution) -> Vec<f64> {
    let mut coming = Vec3::Z;
    let turn = |going: Vec3| {
        let angle = coming.cross(going).norm().atan2(coming.dot(going));
        coming = going;
        angle
    };
    pieces(robot, cable, solution).into_iter().map(turn).collect()
}

/// What is beyond each hole, unstretched.
fn beyond(robot: &Robot, cable: usize, solution: &Solution) -> Vec<f64> {
    let rest = robot_at_rest(robot);
    let compliance = robot.cables()[cable].axial_stiffness.map_or(0.0, f64::recip);
    let lengths = |solution| pieces(robot, cable, solution).into_iter().map(Vec3::norm);
    let mut sums: Vec<f64> = lengths(solution)
        .zip(lengths(&rest))
        .zip(&solution.cables[cable].span_tensions)
        .map(|((now, then), tension)| now - tension * then * compliance)
        .collect();
    for i in (1..sums.len()).rev() {
        sums[i - 1] += sums[i];
    }
    sums
}

fn robot_at_rest(robot: &Robot) -> Solution {
    solve(robot, &Case::with_tensions(&vec![0.0; robot.cables().len()]))
}

/// Eytelwein's law in every hole; of a single cable, which changes no direction within a step, with what the shapes before
/// and after say of the way it slid.
fn obeys(robot: &Robot, before: &Solution, after: &Solution) {
    for (c, (cable, state)) in robot.cables().iter().zip(&after.cables).enumerate() {
        let mu = cable.friction.unwrap_or(0.0);
        let mut incoming = state.tension.unwrap();
        let (was, is) = if before.cables[c].span_tensions.is_empty() {
            (vec![0.0; state.span_tensions.len()], vec![0.0; state.span_tensions.len()])
        } else {
            (beyond(robot, c, before), beyond(robot, c, after))
        };
        for (i, turn) in turns(robot, c, after).into_iter().enumerate() {
            let (Some(&tension), Some(&contact)) =
                (state.span_tensions.get(i), state.slip_states.get(i))
            else {
                assert_eq!(mu, 0.0);
                continue;
            };
            let (least, most) = ((-mu * turn).exp() * incoming, (mu * turn).exp() * incoming);
            let slack = 1e-8 * (1.0 + incoming);
            assert!((least - slack..=most + slack).contains(&tension), "{state:?} {i}");
            let slip = was[i] - is[i];
            let told = match contact {
                SlipState::Sticks => slip.abs() < 1e-10,
                SlipState::Pulled => slip > 1e-12,
                SlipState::Released => slip < -1e-12,
            };
            assert!(told || robot.cables().len() > 1, "{state:?} {i} {slip}");
            match contact {
                SlipState::Sticks => {}
                SlipState::Pulled => assert!((tension - least).abs() < slack, "{state:?} {i}"),
                SlipState::Released => assert!((tension - most).abs() < slack, "{state:?} {i}"),
            }
            incoming = tension;
        }
    }
}

fn several_loads() -> Loads {
    Loads {
        tip_force: Vec3::new(0.05, -0.08, 0.02),
        tip_moment: Vec3::new(1e-3, 2e-3, 1e-3),
        gravity: None,
        ..Loads::default()
    }
}

/// Planar, constant curvature: `dT/ds = −μ κ T` with `κ = rT/EI` gives the bend
/// `(1/μ) ln(1 + μ r τ L/EI)`, approached as holes are added.
#[test]
fn a_pull_from_rest_tends_to_its_closed_form() {
    let mu = 0.3;
    let stiffness = common::bending_stiffness(&robot(3, Vec::new()));
    let tension = 3.0;
    let exact = (1.0 + mu * 0.008 * tension * 0.18 / stiffness).ln() / mu;
    let error = |sections: usize| {
        let solution = solve(&one_rubbing(sections, mu), &Case::with_tensions(&[tension]));
        // The tension falls as `τ/(1 + μ r τ s/EI)`.
        let last = *solution.cables[0].span_tensions.last().unwrap();
        let end = tension / (1.0 + mu * 0.008 * tension * 0.18 / stiffness);
        assert!((last - end).abs() < 0.5 / sections as f64);
        (bend(&solution) - exact).abs()
    };
    let errors = [10, 20, 40].map(error);
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 1.8, "{errors:?}");
    }
    assert!(errors[2] < 0.02 * exact);
}

#[test]
fn pulling_and_releasing_differ() {
    let robot = one_rubbing(9, 0.3);
    let answers = along(&robot, &[1.0, 2.0, 3.0, 2.0, 1.0, 3.0]);
    let bends: Vec<f64> = answers.iter().map(bend).collect();
    // On the way back the cable still holds at the tip what it held.
    assert!(bends[3] > 1.02 * bends[1] && bends[4] > 1.05 * bends[0], "{bends:?}");
    // Pulled again as far, the robot is where it was.
    assert!(apart(&answers[5], &answers[2]) < 1e-9);
    for pair in answers.windows(2) {
        obeys(&robot, &pair[0], &pair[1]);
    }
}

/// No hole lets the cable go before the tension has fallen by `exp(−2μφ)` from what pulled it
/// through; that of the base is the first to.
#[test]
fn a_reversal_sticks_and_then_slides_back() {
    let mu = 0.3;
    for sections in [4, 9] {
        let robot = one_rubbing(sections, mu);
        let pulled = along(&robot, &[3.0]).remove(0);
        let turn = turns(&robot, 0, &pulled)[0];
        let let_go = |share: f64| 3.0 * (-2.0 * share * mu * turn).exp();
        let stuck = &along(&robot, &[3.0, let_go(0.99)])[1];
        assert!(apart(stuck, &pulled) < 1e-12);
        assert!(stuck.cables[0].slip_states.iter().all(|&c| c == SlipState::Sticks), "{stuck:?}");
        assert_eq!(stuck.cables[0].tension, Some(let_go(0.99)));
        let slid = &along(&robot, &[3.0, let_go(1.01)])[1];
        let slip_states = &slid.cables[0].slip_states;
        assert_eq!((slip_states[0], slip_states[1]), (SlipState::Released, SlipState::Sticks));
        assert!(apart(slid, &pulled) > 1e-7);

        // Farther in, one hole after the other lets go, from the base on, none again sticking.
        let shares: Vec<f64> = (0..12).map(|k| 3.0 * 0.95_f64.powi(k)).collect();
        let mut free = 0;
        for k in 1..shares.len() {
            let now = &along(&robot, &[3.0, shares[k]])[1];
            obeys(&robot, &pulled, now);
            let slip_states = &now.cables[0].slip_states;
            let released = slip_states.iter().take_while(|&&c| c == SlipState::Released).count();
            assert!(
                slip_states[released..].iter().all(|&c| c == SlipState::Sticks),
                "{slip_states:?}"
            );
            assert!(released >= free, "{slip_states:?}");
            free = released;
        }
        assert_eq!(free, sections);
    }
}

/// Within the base hole's grip nothing moves at all; a larger loop closes.
#[test]
fn a_small_closed_loop_sticks() {
    let robot = one_rubbing(9, 0.3);
    let small = along(&robot, &[3.0, 2.97, 2.99, 2.96, 3.0]);
    for answer in &small[1..] {
        assert!(apart(answer, &small[0]) < 1e-12);
    }
    let large = along(&robot, &[3.0, 2.5, 3.0]);
    assert!(apart(&large[1], &large[0]) > 1e-4 && apart(&large[2], &large[0]) < 1e-9);
}

#[test]
fn no_friction_is_none() {
    let routings = [helix(20.0, 0.6), straight(200.0)];
    let with = |friction: [Option<f64>; 2], stiffness: Option<f64>| {
        let cable = |(routing, friction): (&Routing, Option<f64>)| Cable {
            friction,
            axial_stiffness: stiffness,
            ..Cable::new("c", routing.clone())
        };
        let mut cables: Vec<Cable> = routings.iter().zip(friction).map(cable).collect();
        cables[1].name = "d".to_owned();
        robot(6, cables)
    };
    let cut = [Shortening::Length(0.004), Shortening::Length(0.002)];
    for stiffness in [None, Some(2000.0)] {
        for loads in [Loads::default(), several_loads()] {
            for mut case in [Case::with_tensions(&[3.0, 1.5]), Case::with_shortenings(&cut)] {
                case.loads = loads.clone();
                let free = solve(&with([None, None], stiffness), &case);
                let zero = solve(&with([Some(0.0), None], stiffness), &case);
                assert_eq!(free, zero);
                // Through the equations of friction.
                let hardly = solve(&with([Some(1e-12), None], stiffness), &case);
                assert!(apart(&free, &hardly) < 1e-9, "{case:?}");
                for (a, b) in free.cables.iter().zip(&hardly.cables) {
                    assert!((a.tension.unwrap() - b.tension.unwrap()).abs() < 1e-7, "{a:?} {b:?}");
                }
                assert_eq!(hardly.cables[0].span_tensions.len(), 6);
                assert!(hardly.cables[1].span_tensions.is_empty());
            }
        }
    }
}

#[test]
fn tensions_of_all_spans_obey_eytelwein() {
    let cables = || {
        vec![
            rubbing(helix(20.0, 0.6), 0.3),
            Cable { axial_stiffness: Some(800.0), ..rubbing(straight(200.0), 0.15) },
            Cable { friction: Some(0.0), ..Cable::new("free", straight(80.0)) },
        ]
    };
    let robot = robot(6, cables());
    let steps = pulls(&[
        &[1.0, 0.5, 0.2],
        &[3.0, 1.5, 0.7],
        &[3.0, 0.2, 0.7],
        &[0.5, 2.0, 0.7],
        &[0.5, 1.97, 0.71],
        &[2.5, 0.1, 0.0],
    ]);
    for loads in [Loads::default(), several_loads()] {
        let answers = path(&robot, &steps, &loads);
        obeys(&robot, &robot_at_rest(&robot), &answers[0]);
        for pair in answers.windows(2) {
            obeys(&robot, &pair[0], &pair[1]);
        }
        assert!(answers[3].cables.iter().any(|c| c.slip_states.contains(&SlipState::Released)));
    }
}

fn shortened(cable: &CableState, stretch: f64) -> Shortening {
    Shortening::Length(cable.initial_length - (cable.length - stretch))
}

/// The lengths that tensions give, given back, give the tensions: below the base too, as it slides
/// there.
#[test]
fn lengths_give_back_a_history() {
    let robot = robot(6, vec![rubbing(helix(20.0, 0.6), 0.3), rubbing(straight(200.0), 0.2)]);
    let steps = pulls(&[&[3.0, 1.0], &[4.0, 1.5], &[2.5, 0.8], &[4.0, 2.0]]);
    for loads in [Loads::default(), several_loads()] {
        let pulled = path(&robot, &steps, &loads);
        let by_length: Vec<Vec<CableCommand>> = pulled
            .iter()
            .map(|answer| {
                let cut: Vec<_> = answer.cables.iter().map(|c| shortened(c, 0.0)).collect();
                Case::with_shortenings(&cut).commands
            })
            .collect();
        let wound = path(&robot, &by_length, &loads);
        for (a, b) in pulled.iter().zip(&wound) {
            assert!(apart(a, b) < 1e-8, "{}", apart(a, b));
            for (a, b) in a.cables.iter().zip(&b.cables) {
                assert!((a.tension.unwrap() - b.tension.unwrap()).abs() < 1e-6, "{a:?}\n{b:?}");
                assert_eq!(a.slip_states, b.slip_states);
            }
        }
    }
}

/// What is given is the length without stretch: `ℓ = ℓ* + τ ℓ⁰/EA`, piece by piece where it rubs.
#[test]
fn elastic_cables_are_longer_by_their_stretch() {
    let stiffness = 500.0;
    for friction in [None, Some(0.25)] {
        let cable = |name: &str, routing| Cable {
            friction,
            axial_stiffness: Some(stiffness),
            ..Cable::new(name, routing)
        };
        let robot = robot(6, vec![cable("a", helix(20.0, 0.6)), cable("b", straight(200.0))]);
        let cut = [0.005, 0.002];
        let case = Case::with_shortenings(&cut.map(Shortening::Length));
        for loads in [Loads::default(), several_loads()] {
            let case = Case { loads: loads.clone(), ..case.clone() };
            let solution = solve(&robot, &case);
            let rest = robot_at_rest(&robot);
            for (i, state) in solution.cables.iter().enumerate() {
                let tension = state.tension.unwrap();
                assert!(tension > 0.1);
                let at_rest = pieces(&robot, i, &rest);
                let stretch: f64 = (at_rest.iter().enumerate())
                    .map(|(k, piece)| state.span_tensions.get(k).unwrap_or(&tension) * piece.norm())
                    .sum::<f64>()
                    / stiffness;
                let expected = state.initial_length - cut[i] + stretch;
                assert!((state.length - expected).abs() < 1e-11, "{state:?} {expected}");
            }
            if friction.is_none() {
                let tensions: Vec<f64> =
                    solution.cables.iter().map(|c| c.tension.unwrap()).collect();
                let pulled = solve(&robot, &Case { loads, ..Case::with_tensions(&tensions) });
                assert!(apart(&pulled, &solution) < 1e-9);
            }
        }
    }
}

/// Tensions on the way to the answer that the robot would not bear are passed by; where there is no
/// answer the error says how far the step went.
#[test]
fn a_strong_pull_is_answered_or_said_how_far_it_goes() {
    let robot = one_rubbing(9, 0.3);
    let pull = |shortening: f64, steps: usize| {
        let options = Options { accuracy: Accuracy::Steps(steps), ..accurate() };
        let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
        Model::CosseratDisks(options).solve(&robot, &case)
    };
    obeys(&robot, &robot_at_rest(&robot), &pull(0.07, 72).unwrap());
    let SolveError::SectionFolds { last_load, .. } = pull(0.12, 9).unwrap_err() else {
        panic!("a cable that is two thirds as short")
    };
    // A little less is answered, and a little more is not.
    assert!(pull(0.97 * last_load * 0.12, 9).is_ok(), "{last_load}");
    assert!(pull(1.05 * last_load * 0.12, 9).is_err(), "{last_load}");
}
