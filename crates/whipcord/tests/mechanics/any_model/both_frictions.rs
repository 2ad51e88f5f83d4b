//! Friction against bending of the backbone together with friction of cables, without and among obstacles.

use whipcord::robot::BendingFriction;
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Loads, Model, ModelKind, Motor,
    Obstacle, Robot, Shortening, SlipState, Solution, SolveError, Statics as _, Stations,
    Stiffness, Vec3,
};

use super::bending_friction::{
    ADDED, ARM, BENDING, LENGTH, MODELS, YIELD, antagonists, friction, moments, solve_all,
};
use crate::common::{model_with_forces, straight};
use crate::contact::{among, wall};

const MU: f64 = 0.3;
/// Axial stiffness in N of a cable that stretches.
const AXIAL: f64 = 2e3;

/// The robot of [`antagonists`] with friction of both cables.
fn robot(held: Option<BendingFriction>, disks: usize, mu: f64) -> Robot {
    let plain = antagonists(held, disks);
    let rubs = |cable: &Cable| Cable { friction: Some(mu), ..cable.clone() };
    let cables = plain.cables().iter().map(rubs).collect();
    Robot::new(plain.backbone().clone(), plain.disks().clone(), cables).unwrap()
}

/// The same with one cable that stretches: one that does not, and sticks, holds every section as it is, and the force of a contact is then not
/// determined.
fn finger(held: Option<BendingFriction>, disks: usize, mu: f64) -> Robot {
    let both = robot(held, disks, mu);
    let one = Cable { axial_stiffness: Some(AXIAL), ..both.cables()[0].clone() };
    Robot::new(both.backbone().clone(), both.disks().clone(), vec![one]).unwrap()
}

/// The case in which the one cable brings these moments one after another.
fn pulls(all: &[f64]) -> Case {
    let pull = |&moment: &f64| Case::with_tensions(&[moment / ARM]).commands;
    let mut before: Vec<_> = all.iter().map(pull).collect();
    let commands = before.pop().unwrap();
    Case { commands, before, ..Case::default() }
}

fn bend(solution: &Solution) -> f64 {
    solution.disks.tip().rotation.log().y
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

/// Where the friction slides everywhere in the pulled robot, `φ' = (r τ e^(−μφ) − M_y)/EI`: with `a = r τ/EI` and `b = M_y/EI`
/// `φ(s) = ln(a/b − (a/b − 1) e^(−μ b s))/μ`.
fn pulled(moment: f64, s: f64) -> f64 {
    let (a, b) = (moment / BENDING, YIELD / BENDING);
    (a / b - (a / b - 1.0) * (-MU * b * s).exp()).ln() / MU
}

/// Curvature and plastic curvature at a place of the pulled robot.
fn bent(moment: f64, s: f64) -> [f64; 2] {
    let u = (moment * (-MU * pulled(moment, s)).exp() - YIELD) / BENDING;
    [u, u - YIELD / ADDED]
}

/// By quadrature, the bend that is left without tension where the friction sticks on the way back.
fn left(moment: f64) -> f64 {
    let n = 2000;
    let at = |k: usize| {
        let [_, plastic] = bent(moment, LENGTH * (k as f64 + 0.5) / f64::from(n));
        let u = ADDED * plastic / (BENDING + ADDED);
        assert!(ADDED * (plastic - u) < YIELD);
        u * LENGTH / f64::from(n)
    };
    (0..n as usize).map(at).sum()
}

#[test]
fn an_arc_that_is_pulled_and_released_has_the_closed_form() {
    let moment = 0.0128;
    // The bend of the tip differs by more between the models than friction of either kind alone would tell.
    let alone =
        [(moment - YIELD) / BENDING * LENGTH, (1.0 + MU * moment / BENDING * LENGTH).ln() / MU];
    let exact = pulled(moment, LENGTH);
    assert!(alone.iter().all(|alone| (alone / exact - 1.0).abs() > 0.08), "{alone:?} {exact}");
    for kind in MODELS {
        // The error is halved when the number of sections is doubled.
        let (disks, tolerance) = match kind {
            ModelKind::Cosserat => (11, 2e-5),
            ModelKind::PseudoRigidBody => (81, 1.2e-2),
            _ => (81, 5e-3),
        };
        let robot = robot(Some(friction()), disks, MU);
        let solved = solve_all(kind, &robot, &moments(&[moment, 0.0]));
        let off = bend(&solved[0]) / exact - 1.0;
        assert!(off.abs() < tolerance, "{kind} pulled: {off}");
        let off = bend(&solved[1]) / left(moment) - 1.0;
        assert!(off.abs() < tolerance, "{kind} released: {off}");
        let pairs = solved[0].shape.arc_length.iter().zip(&solved[0].plastic_curvature);
        for (&s, held) in pairs.take(disks - 1) {
            // That of a section is the mean of its joints.
            let middle = match kind {
                ModelKind::Cosserat | ModelKind::CosseratDisks => s,
                _ => (s - 0.5 * LENGTH / (disks - 1) as f64).max(0.0),
            };
            let exact = bent(moment, middle)[1];
            assert!(
                (held[1] - exact).abs() < 3.0 * tolerance * exact + 1e-4,
                "{kind} {s}: {held:?} {exact}"
            );
        }
        assert_eq!(solved[1].plastic_curvature.len(), solved[1].shape.poses.len());
        assert!(solved[0].cables[0].slip_states.contains(&SlipState::Pulled), "{kind}");
    }
}

#[test]
fn without_one_friction_the_answers_are_those_of_the_other() {
    for kind in MODELS {
        let case = Case {
            loads: Loads { tip_force: Vec3::new(0.0, 0.04, -0.02), ..Loads::default() },
            ..moments(&[0.02, 0.012])
        };
        let last = |robot: &Robot| solve_all(kind, robot, &case).pop().unwrap();
        let none = BendingFriction { yield_moment: [0.0; 2], ..friction() };
        let huge = BendingFriction { yield_moment: [1e3; 2], ..friction() };
        let rubbing = last(&robot(None, 9, MU));
        let with_none = last(&robot(Some(none), 9, MU));
        assert!(
            apart(&with_none, &rubbing) < 1e-5 * LENGTH,
            "{kind}: {}",
            apart(&with_none, &rubbing)
        );
        let plain = robot(None, 9, MU);
        let stiffness = Stiffness::Diagonal {
            shear: None,
            axial: None,
            bending: [BENDING + ADDED; 2].into(),
            torsion: (0.8 * BENDING).into(),
        };
        let stiff = Backbone { stiffness: Some(stiffness), ..plain.backbone().clone() };
        let stiff = Robot::new(stiff, plain.disks().clone(), plain.cables().to_vec()).unwrap();
        let (a, b) = (last(&robot(Some(huge), 9, MU)), last(&stiff));
        assert!(apart(&a, &b) < 1e-5 * LENGTH, "{kind}: {}", apart(&a, &b));
        // Cables that rub a little differ little from those that do not.
        let (a, b) =
            (last(&robot(Some(friction()), 9, 1e-7)), last(&antagonists(Some(friction()), 9)));
        assert!(apart(&a, &b) < 1e-3 * LENGTH, "{kind}: {}", apart(&a, &b));
    }
}

#[test]
fn each_step_is_the_answer_to_the_steps_up_to_it() {
    for kind in MODELS {
        for obstacles in [vec![], vec![wall(0.05)]] {
            let robot = robot(Some(friction()), 6, MU);
            let mut case = among(moments(&[0.024, 0.006, 0.018]), obstacles);
            case.loads.tip_force = Vec3::new(0.01, 0.03, -0.02);
            let all = solve_all(kind, &robot, &case);
            for (step, solution) in case.steps().zip(&all) {
                let model = model_with_forces(kind, Stations::default(), Actuation::Tension);
                let alone = model.solve(&robot, &step).unwrap();
                assert_eq!(alone.shape, solution.shape, "{kind:?}");
                assert_eq!(alone.plastic_curvature, solution.plastic_curvature, "{kind:?}");
                assert!(!alone.plastic_curvature.is_empty());
            }
        }
    }
}

/// From rest in the plane the moments only grow: a step may be divided.
#[test]
fn a_step_may_be_divided() {
    for kind in MODELS {
        let robot = robot(Some(friction()), 11, MU);
        let at = |way: &[f64]| solve_all(kind, &robot, &moments(way)).pop().unwrap();
        let (whole, parts) = (at(&[0.02]), at(&[0.004, 0.008, 0.012, 0.016, 0.02]));
        assert!(apart(&whole, &parts) < 3e-4 * LENGTH, "{kind}: {}", apart(&whole, &parts));
        let pairs = whole.plastic_curvature.iter().zip(&parts.plastic_curvature);
        let off = pairs.map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f64::max);
        assert!(off < 0.02, "{kind}: {off}");
    }
}

/// The commands that wind the one cable up as these answers have it, with what it is stretched by.
fn by_lengths(solved: &[Solution], case: &Case) -> Case {
    let step = |solution: &Solution| -> Vec<CableCommand> {
        let of = |cable: &whipcord::CableState| {
            let tensions = &cable.span_tensions;
            let mean = tensions.iter().sum::<f64>() / tensions.len() as f64;
            let stretch = cable.initial_length * mean / AXIAL;
            let shortening = Shortening::Length(cable.initial_length - cable.length + stretch);
            CableCommand { tension: None, shortening: Some(shortening) }
        };
        solution.cables.iter().map(of).collect()
    };
    let mut before: Vec<_> = solved.iter().map(step).collect();
    let commands = before.pop().unwrap();
    Case { commands, before, ..case.clone() }
}

#[test]
fn lengths_and_motors_lead_to_the_answers_of_their_tensions() {
    for kind in MODELS {
        for obstacles in [vec![], vec![wall(0.05)]] {
            let touches = !obstacles.is_empty();
            let robot = finger(Some(friction()), 9, MU);
            let case = among(pulls(&[0.024, 0.012]), obstacles);
            let solved = solve_all(kind, &robot, &case);
            let lengths = by_lengths(&solved, &case);
            let model = model_with_forces(kind, Stations::default(), Actuation::Shortening);
            let again = model.prepare(&robot, &Loads::default()).unwrap().solve_all(&lengths);
            let again = again.unwrap();
            // A step that the lengths grow along in proportion is not that along which the tensions do.
            for (again, solved) in again.iter().zip(&solved) {
                let apart = apart(again, solved);
                assert!(apart < 3e-3 * LENGTH, "{kind} {touches}: {apart}");
            }
            let radius = 0.01;
            let spool = |name: &str, cable: usize| Motor::spool(name, [(cable, radius)]);
            let driven = robot.with_motors(vec![spool("a", 0)]).unwrap();
            let angle = |command: &CableCommand| match command.shortening {
                Some(Shortening::Length(length)) => Some(length / radius),
                _ => None,
            };
            let all = lengths.before.iter().chain([&lengths.commands]);
            let mut turned = Case {
                motors: all.map(|step| step.iter().map(angle).collect()).collect(),
                commands: vec![Default::default(); 1],
                before: vec![vec![Default::default(); 1]; lengths.before.len()],
                ..lengths.clone()
            };
            turned.drive(&driven).unwrap();
            let model = model_with_forces(kind, Stations::default(), Actuation::Natural);
            let found = model.prepare(&driven, &Loads::default()).unwrap().solve_all(&turned);
            for (found, again) in found.unwrap().iter().zip(&again) {
                assert!(apart(found, again) < 1e-7 * LENGTH, "{kind} {touches}");
            }
        }
    }
}

/// All three: pulled against a wall and let go, the models with many thin disks agree, and what is far away changes nothing.
#[test]
fn among_obstacles_with_both_frictions() {
    for rough in [0.0, 0.2] {
        let obstacle = Obstacle { friction: rough, ..wall(0.05) };
        let case = among(pulls(&[0.024, 0.008, 0.016]), vec![obstacle]);
        let mut first: Option<Vec<Solution>> = None;
        for kind in MODELS {
            let [robot, elastic, smooth] = [
                finger(Some(friction()), 21, MU),
                finger(None, 21, MU),
                finger(Some(friction()), 21, 0.0),
            ];
            let solved = solve_all(kind, &robot, &case);
            assert!(!solved[0].contacts.is_empty(), "{kind}");
            assert!(solved[0].plastic_curvature.iter().any(|held| held[1] > 0.1), "{kind}");
            let free = solve_all(kind, &robot, &Case { obstacles: vec![], ..case.clone() });
            assert!(apart(&free[0], &solved[0]) > 1e-2 * LENGTH, "{kind}");
            let far = among(case.clone(), vec![wall(0.5)]);
            for (far, free) in solve_all(kind, &robot, &far).iter().zip(&free) {
                assert!(apart(far, free) < 1e-9 * LENGTH, "{kind}");
                assert_eq!(far.plastic_curvature, free.plastic_curvature, "{kind}");
            }
            // The wall left it less bent than it is without, or with either friction alone.
            for other in [elastic, smooth] {
                let other = solve_all(kind, &other, &case);
                assert!(apart(&other[1], &solved[1]) > 3e-3 * LENGTH, "{kind}");
            }
            if let Some(first) = &first {
                for (n, (a, b)) in first.iter().zip(&solved).enumerate() {
                    let apart = apart(a, b);
                    assert!(apart < 2e-2 * LENGTH, "{kind} step {n}: {apart}");
                }
            }
            first.get_or_insert(solved);
        }
    }
}

/// Random numbers between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Robots with any of the frictions, among obstacles or not: each has an answer, or a reason why it has none.
#[test]
fn random_robots_are_solved_or_refused_with_a_reason() {
    let mut random = Random(7);
    let (mut solved, mut all) = (0, 0);
    for _ in 0..12 {
        let held = BendingFriction {
            yield_moment: [random.between(0.0, 8e-3), random.between(0.0, 8e-3)],
            yield_stiffness: (random.next() < 0.5).then(|| [random.between(5e-3, 0.1); 2]),
        };
        let disks = 4 + (6.0 * random.next()) as usize;
        let backbone = antagonists(Some(held), disks).backbone().clone();
        let cables: Vec<Cable> = (0..3)
            .map(|k| Cable {
                friction: (random.next() < 0.6).then(|| random.between(0.05, 0.4)),
                axial_stiffness: (random.next() < 0.3).then_some(3e3),
                ..Cable::new(format!("{k}"), straight(120.0 * f64::from(k) + 10.0 * random.next()))
            })
            .collect();
        let robot =
            Robot::new(backbone, Disks::equally_spaced(LENGTH, disks, ARM), cables).unwrap();
        let mut step = || {
            Case::with_tensions(&core::array::from_fn::<f64, 3, _>(|_| 2.5 * random.next()))
                .commands
        };
        let before = vec![step(), step()];
        let commands = step();
        let tip_force = Vec3::new(random.between(-0.05, 0.05), random.between(-0.05, 0.05), -0.03);
        let obstacles = match random.next() < 0.7 {
            true => vec![Obstacle {
                friction: 0.3 * random.next().round(),
                ..wall(random.between(0.02, 0.06))
            }],
            false => vec![],
        };
        let case = Case {
            commands,
            before,
            loads: Loads { tip_force, ..Loads::default() },
            obstacles,
            ..Case::default()
        };
        for kind in MODELS {
            let model = model_with_forces(kind, Stations::default(), Actuation::Tension);
            all += 1;
            match model.prepare(&robot, &case.loads).unwrap().solve_all(&case) {
                Ok(answers) => {
                    solved += 1;
                    for answer in &answers {
                        let held = answer.plastic_curvature.iter().flatten();
                        assert!(held.chain(&[bend(answer)]).all(|value| value.is_finite()));
                        assert_eq!(answer.plastic_curvature.len(), answer.shape.poses.len());
                    }
                }
                Err((step, error)) => {
                    assert!(
                        !matches!(error, SolveError::Unsupported { .. }),
                        "{kind} {step}: {error}"
                    );
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
    assert!(solved * 10 >= all * 9, "{solved} of {all}");
}

#[test]
fn the_model_without_forces_refuses_it() {
    let robot = robot(Some(friction()), 6, MU);
    for kind in [ModelKind::FourBar, ModelKind::ConstantCurvature] {
        let refused = Model::new(kind, Stations::default(), Actuation::Natural)
            .prepare(&robot, &Loads::default())
            .map(|_| ());
        assert!(matches!(refused, Err(SolveError::Unsupported { .. })), "{kind}: {refused:?}");
    }
}
