//! Friction at the holes, in every model that has it.

use whipcord::batch::{BatchOptions, Rows, solve_batch};
use whipcord::{
    Actuation, Cable, CableCommand, Case, Disks, Loads, Model, ModelKind, Robot, Routing,
    Shortening, SlipState, Solution, SolveError, Statics as _, Stations, Status, Vec3, WarmStart,
};

use crate::common::{self, WITH_FORCES, helix, model_with_forces, paper_backbone, straight};
use crate::cosserat_disks::friction_study::divided;

const MODELS: [ModelKind; 4] = [
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
    ModelKind::FourBar,
];

fn model(kind: ModelKind) -> Model {
    model_with_forces(kind, Stations::default(), Actuation::Natural)
}

fn robot(sections: usize, cables: Vec<Cable>) -> Robot {
    Robot::new(paper_backbone(), Disks::equally_spaced(0.18, sections + 1, 0.008), cables).unwrap()
}

pub fn rubbing(routing: Routing, mu: f64) -> Cable {
    Cable { friction: Some(mu), ..Cable::new(format!("{routing:?}"), routing) }
}

fn one_rubbing(sections: usize, mu: f64) -> Robot {
    robot(sections, vec![rubbing(straight(0.0), mu)])
}

fn pulls(tensions: &[&[f64]]) -> Vec<Vec<CableCommand>> {
    tensions.iter().map(|t| Case::with_tensions(t).commands).collect()
}

fn in_steps(steps: &[Vec<CableCommand>], loads: &Loads) -> Case {
    let (commands, before) = steps.split_last().unwrap();
    let (commands, before, loads) = (commands.clone(), before.to_vec(), loads.clone());
    Case { commands, before, loads, ..Case::default() }
}

/// The answers to all steps.
fn path(
    kind: ModelKind,
    robot: &Robot,
    steps: &[Vec<CableCommand>],
    loads: &Loads,
) -> Vec<Solution> {
    let mut solutions = Vec::new();
    let case = in_steps(steps, loads);
    let walked =
        model(kind).prepare(robot, loads).unwrap().solve_steps(&case, |s| solutions.push(s));
    walked.unwrap_or_else(|(step, error)| panic!("{kind} {step}: {error}"));
    solutions
}

fn along(kind: ModelKind, robot: &Robot, tensions: &[f64]) -> Vec<Solution> {
    let steps: Vec<_> = tensions.iter().map(|&t| Case::with_tensions(&[t]).commands).collect();
    path(kind, robot, &steps, &Loads::default())
}

fn bend(solution: &Solution) -> f64 {
    solution.disks.tip().rotation.log().norm()
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

/// The greatest difference of a tension in a passage, as a part of the greatest one of its cable.
pub fn tensions_apart(a: &Solution, b: &Solution) -> f64 {
    let of_cable = |(a, b): (&whipcord::CableState, &whipcord::CableState)| {
        let most = b.span_tensions.iter().copied().fold(b.tension.unwrap(), f64::max);
        let pairs = a.span_tensions.iter().zip(&b.span_tensions);
        pairs.map(|(a, b)| (a - b).abs() / most.max(1e-9)).fold(0.0, f64::max)
    };
    a.cables.iter().zip(&b.cables).map(of_cable).fold(0.0, f64::max)
}

fn several_loads() -> Loads {
    Loads {
        tip_force: Vec3::new(0.05, -0.08, 0.02),
        tip_moment: Vec3::new(1e-3, 2e-3, 1e-3),
        ..Loads::default()
    }
}

/// Angles by which a cable turns in the holes, as the poses of the disks have it.
fn turns(robot: &Robot, cable: usize, solution: &Solution) -> Vec<f64> {
    let route = &robot.routes()[cable];
    let disks = &solution.disks;
    let holes: Vec<Vec3> = (disks.arc_length.iter().zip(&disks.poses))
        .map(|(&s, pose)| pose.transform(route.at(s).offset))
        .collect();
    let mut coming = Vec3::Z;
    let turn = |pair: &[Vec3]| {
        let going = pair[1] - pair[0];
        let angle = coming.cross(going).norm().atan2(coming.dot(going));
        coming = going;
        angle
    };
    holes.windows(2).map(turn).collect()
}

/// Eytelwein's law in every hole.
pub fn obeys(robot: &Robot, solution: &Solution) {
    for (c, (cable, state)) in robot.cables().iter().zip(&solution.cables).enumerate() {
        let Some(mu) = cable.friction else { continue };
        let mut incoming = state.tension.unwrap();
        for (i, turn) in turns(robot, c, solution).into_iter().enumerate() {
            let (tension, slip_state) = (state.span_tensions[i], state.slip_states[i]);
            let (least, most) = ((-mu * turn).exp() * incoming, (mu * turn).exp() * incoming);
            let slack = 1e-8 * (1.0 + incoming);
            let told = match slip_state {
                SlipState::Sticks => (least - slack..=most + slack).contains(&tension),
                SlipState::Pulled => (tension - least).abs() < slack,
                SlipState::Released => (tension - most).abs() < slack,
            };
            assert!(told, "{}: {state:?} {i}", solution.model);
            incoming = tension;
        }
    }
}

/// Planar, constant curvature: `dT/ds = −μ κ T` with `κ = rT/EI` gives the bend
/// `(1/μ) ln(1 + μ r τ L/EI)`, approached as holes are added.
#[test]
fn a_pull_from_rest_tends_to_its_closed_form() {
    let (mu, tension) = (0.3, 3.0);
    let stiffness = common::bending_stiffness(&robot(3, Vec::new()));
    for kind in MODELS {
        // Three springs bend a little more than the rod whose section they stand for.
        let springs = [3.51, 2.99, 2.58].into_iter().map(f64::recip).sum::<f64>();
        let softer = if kind == ModelKind::PseudoRigidBody { springs } else { 1.0 };
        let exact = (1.0 + mu * 0.008 * tension * 0.18 * softer / stiffness).ln() / mu;
        let errors = [10, 20, 40].map(|sections| {
            let robot = one_rubbing(sections, mu);
            let solution = model(kind).solve(&robot, &Case::with_tensions(&[tension])).unwrap();
            obeys(&robot, &solution);
            (bend(&solution) - exact).abs()
        });
        for pair in errors.windows(2) {
            assert!(pair[0] / pair[1] > 1.8, "{kind}: {errors:?}");
        }
        assert!(errors[2] < 0.02 * exact, "{kind}: {errors:?}");
    }
}

#[test]
fn pulling_and_releasing_differ_and_loops_close() {
    let robot = one_rubbing(9, 0.3);
    for kind in MODELS {
        let answers = along(kind, &robot, &[1.0, 2.0, 3.0, 2.0, 1.0, 3.0]);
        answers.iter().for_each(|answer| obeys(&robot, answer));
        let bends: Vec<f64> = answers.iter().map(bend).collect();
        assert!(bends[3] > 1.02 * bends[1] && bends[4] > 1.05 * bends[0], "{kind}: {bends:?}");
        assert!(apart(&answers[5], &answers[2]) < 1e-8, "{kind}");
        // Within the grip of the base hole nothing moves.
        let turn = turns(&robot, 0, &answers[2])[0];
        let let_go = |share: f64| 3.0 * (-2.0 * share * 0.3 * turn).exp();
        let [stuck, slid] = [0.99, 1.01].map(|share| along(kind, &robot, &[3.0, let_go(share)]));
        assert!(apart(&stuck[1], &stuck[0]) < 1e-11, "{kind}");
        assert!(stuck[1].cables[0].slip_states.iter().all(|&s| s == SlipState::Sticks));
        let slip_states = &slid[1].cables[0].slip_states;
        assert_eq!((slip_states[0], slip_states[1]), (SlipState::Released, SlipState::Sticks));
    }
}

/// With many disks the sections are as short as those of the rod between them.
#[test]
fn sections_tend_to_the_rod() {
    let cables = || vec![rubbing(helix(20.0, 0.6), 0.3), rubbing(straight(200.0), 0.2)];
    let robot = robot(16, cables());
    let steps = pulls(&[&[2.0, 0.5], &[1.2, 1.4]]);
    for loads in [Loads::default(), several_loads()] {
        let rod = path(ModelKind::CosseratDisks, &robot, &steps, &loads);
        for kind in &MODELS[1..] {
            let sections = path(*kind, &robot, &steps, &loads);
            for (rod, sections) in rod.iter().zip(&sections) {
                assert!(apart(rod, sections) < 0.02 * 0.18, "{kind}: {}", apart(rod, sections));
                let tensions = tensions_apart(rod, sections);
                assert!(tensions < 0.03, "{kind}: {tensions}");
            }
        }
    }
}

/// An answer does not depend on how its step is divided: shapes to 0.03 % of the length, the tension of each passage to
/// 0.3 % of the greatest one of its cable.
#[test]
fn the_division_of_a_step_does_not_matter() {
    let two = vec![rubbing(straight(0.0), 0.3), rubbing(straight(180.0), 0.3)];
    let helical = vec![
        rubbing(helix(20.0, 0.6), 0.3),
        Cable { axial_stiffness: Some(800.0), ..rubbing(straight(200.0), 0.15) },
        Cable::new("free", straight(80.0)),
    ];
    let ways: [(Robot, Vec<Vec<CableCommand>>); 2] = [
        (robot(9, two), pulls(&[&[3.0, 0.3], &[0.5, 3.3]])),
        (robot(6, helical), pulls(&[&[3.0, 1.0, 0.7], &[0.5, 2.0, 0.1], &[2.5, 0.3, 0.4]])),
    ];
    for kind in MODELS {
        for (robot, steps) in &ways {
            for loads in [Loads::default(), several_loads()] {
                let case = in_steps(steps, &loads);
                let [whole, parts] = [case.clone(), divided(&case, 16)].map(|case| {
                    let solved = model(kind).solve(robot, &case);
                    solved.unwrap_or_else(|error| panic!("{kind}: {error}"))
                });
                obeys(robot, &whole);
                let (shape, tension) = (apart(&whole, &parts), tensions_apart(&whole, &parts));
                assert!(shape < 3e-4 * 0.18 && tension < 0.003, "{kind}: {shape} {tension}");
            }
        }
    }
}

/// The lengths that tensions give, given back, give the tensions; elastic cables too.
#[test]
fn lengths_give_back_a_history() {
    for (stiffness, loads) in [(None, Loads::default()), (Some(500.0), several_loads())] {
        let cables = [rubbing(helix(20.0, 0.6), 0.3), rubbing(straight(200.0), 0.2)];
        let cables = cables.map(|cable| Cable { axial_stiffness: stiffness, ..cable });
        let robot = robot(6, cables.to_vec());
        let steps = pulls(&[&[3.0, 1.0], &[4.0, 1.5], &[4.5, 2.5]]);
        for kind in MODELS {
            let rest = model(kind).solve(&robot, &Case::with_tensions(&[0.0, 0.0])).unwrap();
            let pulled = path(kind, &robot, &steps, &loads);
            let by_length: Vec<Vec<CableCommand>> = (pulled.iter())
                .map(|answer| {
                    let cut = answer.cables.iter().enumerate().map(|(c, cable)| {
                        let route = &robot.routes()[c];
                        let at = |i: usize| {
                            let s = rest.disks.arc_length[i];
                            rest.disks.poses[i].transform(route.at(s).offset)
                        };
                        let stretch: f64 = (cable.span_tensions.iter().enumerate())
                            .map(|(i, tension)| tension * (at(i + 1) - at(i)).norm())
                            .sum();
                        let stretch = stretched(stretch, stiffness);
                        Shortening::Length(cable.initial_length - (cable.length - stretch))
                    });
                    Case::with_shortenings(&cut.collect::<Vec<_>>()).commands
                })
                .collect();
            let wound = path(kind, &robot, &by_length, &loads);
            for (a, b) in pulled.iter().zip(&wound) {
                assert!(apart(a, b) < 1e-6, "{kind}: {}", apart(a, b));
                assert!(tensions_apart(a, b) < 1e-4, "{kind}: {}", tensions_apart(a, b));
            }
        }
    }
}

fn stretched(stretch: f64, stiffness: Option<f64>) -> f64 {
    stiffness.map_or(0.0, |stiffness| stretch / stiffness)
}

#[test]
fn hardly_any_friction_is_none() {
    let with = |friction: Option<f64>| {
        let cable = |name: &str, routing| Cable { friction, ..Cable::new(name, routing) };
        robot(6, vec![cable("a", helix(20.0, 0.6)), cable("b", straight(200.0))])
    };
    let cut = [Shortening::Length(0.004), Shortening::Length(0.002)];
    for kind in WITH_FORCES {
        for loads in [Loads::default(), several_loads()] {
            for mut case in [Case::with_tensions(&[3.0, 1.5]), Case::with_shortenings(&cut)] {
                case.loads = loads.clone();
                let [free, hardly] = [None, Some(1e-12)].map(|friction| {
                    let solved = model(kind).solve(&with(friction), &case);
                    solved.unwrap_or_else(|error| panic!("{kind}: {error}"))
                });
                assert!(apart(&free, &hardly) < 1e-6, "{kind}: {}", apart(&free, &hardly));
                for (a, b) in free.cables.iter().zip(&hardly.cables) {
                    let apart = (a.tension.unwrap() - b.tension.unwrap()).abs();
                    assert!(apart < 1e-4, "{kind}: {a:?} {b:?}");
                }
                assert_eq!(hardly.cables[0].span_tensions.len(), 6);
            }
        }
    }
}

/// A batch, a solve into memory at hand and a solve give the same, and steps in one go are those one by one.
#[test]
fn every_way_to_ask_gives_the_same() {
    let robot = robot(6, vec![rubbing(helix(20.0, 0.6), 0.3), rubbing(straight(200.0), 0.2)]);
    let steps = pulls(&[&[3.0, 1.0], &[0.4, 1.5], &[2.5, 0.8]]);
    for kind in MODELS {
        let case = in_steps(&steps, &several_loads());
        let walked = path(kind, &robot, &steps, &case.loads);
        let mut prepared = model(kind).prepare(&robot, &case.loads).unwrap();
        let mut into = Solution::empty(kind);
        for (step, walked) in case.steps().zip(&walked) {
            let alone = prepared.solve(&step, None).unwrap();
            assert!(apart(&alone, walked) < 1e-10 && tensions_apart(&alone, walked) < 1e-8);
            let status = prepared.solve_into(&step, WarmStart::None, &mut into).unwrap();
            assert_eq!(status, Status::Converged);
            assert_eq!(into.cables, alone.cables);
        }
        let cases = [case.clone(), case.clone()];
        let options = BatchOptions::default();
        let batch = solve_batch(&model(kind), &robot, Rows::Cases(&cases), &options).unwrap();
        assert!(batch.outcomes().iter().all(Result::is_ok), "{kind}");
        let (one, other) = batch.positions().split_at(batch.positions().len() / 2);
        assert_eq!(one, other, "{kind}");
        let [.., x, y, z] = one[..] else { panic!() };
        let tip = Vec3::new(x, y, z) - walked[2].disks.tip().position;
        assert!(tip.norm() < 1e-12, "{kind}: {tip:?}");
    }
}

#[test]
fn branches_are_refused() {
    let robot = one_rubbing(6, 0.3);
    let case = Case::with_tensions(&[2.0]);
    for kind in WITH_FORCES {
        let mut prepared = model(kind).prepare(&robot, &case.loads).unwrap();
        let refused = |error: SolveError| match error {
            SolveError::Unsupported { path, .. } => assert_eq!(path, "cables[0].friction"),
            other => panic!("{kind}: {other}"),
        };
        refused(prepared.branches(&case, &Default::default()).unwrap_err());
    }
}
