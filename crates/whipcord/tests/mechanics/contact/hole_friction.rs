//! Robots whose cables rub in their holes, among obstacles.

use super::{LENGTH, STIFFNESS, among, finger, pushes_of, sphere, wall};
use crate::any_model::hole_friction::{obeys, rubbing, tensions_apart};
use crate::common::{WITH_FORCES, helix, model_with_forces, straight};
use crate::cosserat_disks::friction_study::divided;
use whipcord::{
    Actuation, Cable, Case, Loads, ModelKind, Obstacle, Robot, SlipState, Solution, SolveError,
    Stations, Vec3,
};

fn with_cables(cables: Vec<Cable>) -> Robot {
    let bare = finger(9);
    Robot::new(bare.backbone().clone(), bare.disks().clone(), cables).unwrap()
}

fn one_cable(mu: f64) -> Robot {
    with_cables(vec![rubbing(straight(0.0), mu)])
}

fn solve_in(
    kind: ModelKind,
    actuation: Actuation,
    robot: &Robot,
    case: &Case,
) -> Result<Solution, SolveError> {
    let model = model_with_forces(kind, Stations::Disks, actuation);
    model.prepare(robot, &case.loads)?.solve_to_the_end(case).map_err(|(_, error)| error)
}

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    solve_in(kind, Actuation::Tension, robot, case)
        .unwrap_or_else(|error| panic!("{kind}: {error}"))
}

fn steps(tensions: &[&[f64]], obstacles: Vec<Obstacle>) -> Case {
    let mut before: Vec<_> = tensions.iter().map(|t| Case::with_tensions(t).commands).collect();
    let commands = before.pop().unwrap();
    Case { commands, before, obstacles, ..Case::default() }
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max) / LENGTH
}

/// A robot pulled from rest slides in every hole, whatever led there: with its contact forces as point loads it has the same shape
/// and the same tensions without obstacles, and Eytelwein's law holds in every hole.
#[test]
fn a_robot_pulled_against_an_obstacle() {
    let ball = |friction: f64| Obstacle { friction, ..sphere(Vec3::new(0.05, 0.0, 0.12), 0.03) };
    let held = |friction: f64| Obstacle { friction, ..wall(0.05) };
    let several = vec![
        rubbing(helix(20.0, 0.3), 0.2),
        rubbing(straight(350.0), 0.1),
        Cable::new("free", straight(30.0)),
    ];
    for kind in WITH_FORCES {
        for (robot, tensions, obstacle) in [
            (one_cable(0.3), &[3.0][..], held(0.0)),
            (one_cable(0.3), &[3.0], ball(0.0)),
            (one_cable(0.1), &[3.0], ball(0.5)),
            (with_cables(several.clone()), &[1.0, 1.2, 0.5], held(0.0)),
        ] {
            let case = steps(&[tensions], vec![obstacle]);
            let solution = solve(kind, &robot, &case);
            assert!(!solution.contacts.is_empty(), "{kind}");
            if kind != ModelKind::Cosserat {
                obeys(&robot, &solution);
            }
            let (loads, total) = pushes_of(&solution);
            let base = solution.base_wrench.unwrap();
            assert!((base.force - total.force).norm() < 1e-6 * STIFFNESS / (LENGTH * LENGTH));
            assert!((base.moment - total.moment).norm() < 1e-6 * STIFFNESS / LENGTH);
            let all_slide = (solution.cables.iter().flat_map(|cable| &cable.slip_states))
                .all(|&state| state == SlipState::Pulled);
            let free = Case { obstacles: vec![], loads, ..case };
            let again = solve(kind, &robot, &free);
            assert!(all_slide, "{kind}");
            let most = if kind == ModelKind::Cosserat { [1e-4, 1e-3] } else { [1e-6, 1e-5] };
            assert!(apart(&again, &solution) < most[0], "{kind}: {}", apart(&again, &solution));
            assert!(tensions_apart(&again, &solution) < most[1], "{kind}");
        }
    }
}

/// Pulled and let go against a wall: the holes keep what they held, and how the steps are divided hardly matters.
#[test]
fn hysteresis_against_a_wall() {
    let robot = with_cables(vec![rubbing(straight(0.0), 0.3), rubbing(straight(180.0), 0.2)]);
    for kind in WITH_FORCES {
        let case = steps(&[&[3.0, 0.2], &[1.5, 0.2]], vec![wall(0.05)]);
        let released = solve(kind, &robot, &case);
        let pulled = solve(kind, &robot, &steps(&[&[1.5, 0.2]], vec![wall(0.05)]));
        if kind != ModelKind::Cosserat {
            obeys(&robot, &released);
        }
        assert!(apart(&released, &pulled) > 5e-3, "{kind}: {}", apart(&released, &pulled));
        let disks = solve(ModelKind::CosseratDisks, &robot, &case);
        assert!(apart(&released, &disks) < 0.03, "{kind}: {}", apart(&released, &disks));
        if kind != ModelKind::Cosserat {
            let finer = solve(kind, &robot, &divided(&case, 4));
            assert!(apart(&released, &finer) < 1e-6, "{kind}: {}", apart(&released, &finer));
        }
    }
}

/// A step of actuation is divided by what it changes: many small steps lead where few great ones do, and take a few times as many iterations, not as many times as
/// there are more of them.
#[test]
fn many_small_steps() {
    const PARTS: usize = 64;
    // One cable: two that stick on both sides hold every section, and nothing tells the force of a contact.
    let robot = one_cable(0.3);
    let case = steps(&[&[3.0], &[1.0], &[2.5]], vec![wall(0.05)]);
    for kind in WITH_FORCES {
        let model = model_with_forces(kind, Stations::Disks, Actuation::Tension);
        let all =
            |case: &Case| model.prepare(&robot, &case.loads).unwrap().solve_all(case).unwrap();
        let (few, many) = (all(&case), all(&divided(&case, PARTS)));
        for (step, answer) in few.iter().enumerate() {
            let apart = apart(answer, &many[PARTS * (step + 1) - 1]);
            assert!(apart < 1e-8, "{kind}, step {step}: {apart}");
        }
        let iterations = |answers: &[Solution]| -> usize {
            answers.iter().map(|answer| answer.diagnostics.iterations).sum()
        };
        let [few, many] = [iterations(&few), iterations(&many)];
        assert!(many < 4 * few, "{kind}: {few}, {many}");
    }
}

/// An obstacle that nothing touches changes nothing.
#[test]
fn an_obstacle_out_of_reach() {
    let robot = one_cable(0.3);
    let loads = Loads { tip_force: Vec3::new(0.0, 0.05, 0.02), ..Loads::default() };
    for kind in WITH_FORCES {
        for tensions in [&[&[3.0][..]][..], &[&[3.0], &[1.5]]] {
            let case = Case { loads: loads.clone(), ..steps(tensions, vec![wall(0.3)]) };
            let found = solve(kind, &robot, &case);
            let free = solve(kind, &robot, &among(case, vec![]));
            assert_eq!(apart(&found, &free), 0.0, "{kind}");
            assert_eq!(found.cables[0].span_tensions, free.cables[0].span_tensions);
        }
    }
}
