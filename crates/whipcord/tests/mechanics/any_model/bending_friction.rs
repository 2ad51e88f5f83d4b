//! Friction against bending of the backbone: the closed-form loop of a planar arc, and what must hold for any robot.

use whipcord::robot::BendingFriction;
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Loads, Model, ModelKind, Problem, Robot,
    Solution, SolveError, Statics as _, Stations, Stiffness, Vec3,
};

use crate::common::{model_with_forces, paper_backbone, straight};

/// The models that take it.
pub(super) const MODELS: [ModelKind; 5] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
    ModelKind::FourBar,
];
pub(super) const LENGTH: f64 = 0.2;
pub(super) const ARM: f64 = 0.008;
pub(super) const BENDING: f64 = 4e-3;
pub(super) const YIELD: f64 = 6e-3;
pub(super) const ADDED: f64 = 0.03;

/// A rod that does not stretch with a cable on either side, so that the moment is the difference of the tensions times their arm.
pub(super) fn antagonists(friction: Option<BendingFriction>, disks: usize) -> Robot {
    let backbone = Backbone {
        stiffness: Some(Stiffness::Diagonal {
            shear: None,
            axial: None,
            bending: [BENDING, BENDING].into(),
            torsion: (0.8 * BENDING).into(),
        }),
        extensible: false,
        shearable: false,
        bending_friction: friction,
        ..Backbone::new(LENGTH)
    };
    let cables = vec![Cable::new("left", straight(0.0)), Cable::new("right", straight(180.0))];
    Robot::new(backbone, Disks::equally_spaced(LENGTH, disks, ARM), cables).unwrap()
}

pub(super) fn friction() -> BendingFriction {
    BendingFriction { yield_moment: [YIELD, YIELD], yield_stiffness: Some([ADDED, ADDED]) }
}

/// The case in which the cables bring these moments one after another.
pub(super) fn moments(all: &[f64]) -> Case {
    let command = |&moment: &f64| {
        let tensions = [moment.max(0.0) / ARM, (-moment).max(0.0) / ARM];
        tensions.map(|t| CableCommand { tension: Some(t), shortening: None }).to_vec()
    };
    let mut steps: Vec<_> = all.iter().map(command).collect();
    let commands = steps.pop().unwrap();
    Case { commands, before: steps, ..Case::default() }
}

pub(super) fn model(kind: ModelKind) -> Model {
    model_with_forces(kind, Stations::default(), Actuation::Tension)
}

pub(super) fn solve_all(kind: ModelKind, robot: &Robot, case: &Case) -> Vec<Solution> {
    let solved = model(kind).prepare(robot, &case.loads).unwrap().solve_all(case);
    solved.unwrap_or_else(|(step, error)| panic!("{kind} {step}: {error}"))
}

/// Mean curvature of an answer in the plane of the cables.
pub(super) fn curvature(solution: &Solution) -> f64 {
    solution.disks.tip().rotation.log().y / LENGTH
}

/// The moments from one to another in so many equal steps, without the first.
fn ramp(from: f64, to: f64, steps: usize) -> impl Iterator<Item = f64> {
    (1..=steps).map(move |k| from + (to - from) * k as f64 / steps as f64)
}

/// The curvature of a section by its own closed form: from a reversal at `(moment, curvature)`, where the spring of the friction
/// stands at `at`, straight lines of slope `EI + k_y` and then `EI`.
fn closed_form(moments: &[f64]) -> Vec<f64> {
    let (mut m, mut u, mut h) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut out = Vec::new();
    for &next in moments {
        let sign = (next - m).signum();
        // What the friction can still take on this way.
        let room = (YIELD - sign * h) / ADDED;
        let stuck = (next - m).abs() / (BENDING + ADDED);
        let way = if stuck <= room {
            h += sign * ADDED * stuck;
            stuck
        } else {
            h = sign * YIELD;
            room + ((next - m).abs() - (BENDING + ADDED) * room) / BENDING
        };
        (m, u) = (next, u + sign * way);
        out.push(u);
    }
    out
}

#[test]
fn a_planar_arc_follows_the_closed_form_loop() {
    let greatest = 0.024;
    let way: Vec<f64> = ramp(0.0, greatest, 5)
        .chain(ramp(greatest, -greatest, 12))
        .chain(ramp(-greatest, greatest, 12))
        .chain(ramp(greatest, 0.0, 5))
        .chain(ramp(0.0, 0.3 * greatest, 2))
        .collect();
    let exact = closed_form(&way);
    // An arc of a circle whose cables run straight between 80 disks bends almost as it does under continuous ones.
    for kind in MODELS {
        let (disks, tolerance) = match kind {
            ModelKind::Cosserat => (11, 1e-9),
            // Its joints together are 0.7 % softer than the rod.
            ModelKind::PseudoRigidBody => (81, 8e-3),
            _ => (81, 2e-3),
        };
        let robot = antagonists(Some(friction()), disks);
        let solved = solve_all(kind, &robot, &moments(&way));
        let scale = exact.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        for ((solution, &u), m) in solved.iter().zip(&exact).zip(&way) {
            let off = (curvature(solution) - u).abs();
            assert!(off < tolerance * scale, "{kind:?} at {m}: {} and {u}", curvature(solution));
        }
    }
}

#[test]
fn a_cycle_loses_the_area_of_the_parallelogram() {
    let greatest = 0.024;
    let robot = antagonists(Some(friction()), 11);
    // The corners of the loop lie on the way: friction slides after 2 M_y (EI + k_y)/k_y.
    let corner = 2.0 * YIELD * (BENDING + ADDED) / ADDED;
    let way = [greatest, greatest - corner, -greatest, -greatest + corner, greatest];
    let solved = solve_all(ModelKind::Cosserat, &robot, &moments(&way));
    let at: Vec<(f64, f64)> = way.iter().copied().zip(solved.iter().map(curvature)).collect();
    let area: f64 =
        at.windows(2).map(|pair| 0.5 * (pair[0].0 + pair[1].0) * (pair[1].1 - pair[0].1)).sum();
    let amplitude = (greatest - YIELD) / BENDING;
    let exact = 4.0 * YIELD * (amplitude - YIELD / ADDED);
    assert!((area - exact).abs() < 1e-9 * exact, "{area} and {exact}");
    assert!((at[0].1 - at[4].1).abs() < 1e-9, "the loop is closed");
}

#[test]
fn a_robot_that_is_let_go_keeps_a_bend() {
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 11);
        let solved = solve_all(kind, &robot, &moments(&[0.024, 0.0]));
        let exact = closed_form(&[0.024, 0.0]);
        let left = curvature(&solved[1]);
        assert!((left / exact[1] - 1.0).abs() < 0.05, "{left} and {}", exact[1]);
        // It slid back a little, and now pushes the other way with all of its limit.
        let plastic = solved[1].plastic_curvature[3][1];
        assert!((plastic - (exact[1] + YIELD / ADDED)).abs() < 0.05 * plastic);
        assert_eq!(solved[1].plastic_curvature.len(), solved[1].shape.poses.len());
    }
}

#[test]
fn each_step_is_the_answer_to_the_steps_up_to_it() {
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 6);
        let mut case = moments(&[0.02, -0.004, 0.012, 0.012]);
        case.loads.tip_force = Vec3::new(0.03, 0.06, -0.05);
        let all = solve_all(kind, &robot, &case);
        for (step, solution) in case.steps().zip(&all) {
            let alone = model(kind).solve(&robot, &step).unwrap();
            assert_eq!(alone.shape, solution.shape, "{kind:?}");
            assert_eq!(alone.plastic_curvature, solution.plastic_curvature);
        }
        // A step that repeats the one before changes nothing.
        let apart = all[2].disks.distances(&all[3].disks).fold(0.0, f64::max);
        assert!(apart < 2e-5 * LENGTH, "{kind:?}: {apart}");
    }
}

#[test]
fn without_a_limit_the_rod_is_elastic_and_under_it_it_is_stiffer() {
    for kind in MODELS {
        let case = moments(&[0.02, 0.01]);
        let case = Case {
            loads: Loads { tip_force: Vec3::new(0.0, 0.04, -0.02), ..Loads::default() },
            ..case
        };
        let none = BendingFriction { yield_moment: [0.0; 2], ..friction() };
        let huge = BendingFriction { yield_moment: [1e3; 2], ..friction() };
        let last = |friction: Option<BendingFriction>| {
            solve_all(kind, &antagonists(friction, 9), &case).pop().unwrap()
        };
        let elastic = last(None);
        let apart = |a: &Solution, b: &Solution| a.disks.distances(&b.disks).fold(0.0, f64::max);
        assert!(apart(&last(Some(none)), &elastic) < 1e-7 * LENGTH, "{kind:?}");
        let mut stiff = antagonists(None, 9).backbone().clone();
        stiff.stiffness = Some(Stiffness::Diagonal {
            shear: None,
            axial: None,
            bending: [BENDING + ADDED; 2].into(),
            torsion: (0.8 * BENDING).into(),
        });
        let robot = antagonists(None, 9);
        let stiff = Robot::new(stiff, robot.disks().clone(), robot.cables().to_vec()).unwrap();
        let stiff = solve_all(kind, &stiff, &case).pop().unwrap();
        assert!(apart(&last(Some(huge)), &stiff) < 1e-7 * LENGTH, "{kind:?}");
        assert!(last(Some(huge)).plastic_curvature.iter().all(|k| *k == [0.0; 2]));
    }
}

#[test]
fn equal_commands_from_both_sides_differ() {
    // Millimetres of 200, as on real robots.
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 11);
        let tip = |way: &[f64]| solve_all(kind, &robot, &moments(way)).pop().unwrap();
        let (up, down) = (tip(&[0.01]), tip(&[0.02, 0.01]));
        let apart = (up.disks.tip().position - down.disks.tip().position).norm();
        assert!(apart > 3e-3, "{apart}");
    }
}

#[test]
fn lengths_and_loads_have_friction_too() {
    // Under a tip load the curvature varies, and friction slides near the base only.
    let loads = Loads { tip_force: Vec3::new(0.06, 0.0, 0.0), ..Loads::default() };
    let mut found = Vec::new();
    for (kind, disks) in [(ModelKind::Cosserat, 41), (ModelKind::CosseratDisks, 41)] {
        let robot = antagonists(Some(friction()), disks);
        let case = Case { loads: loads.clone(), ..moments(&[0.004, -0.01, 0.006]) };
        let solved = solve_all(kind, &robot, &case);
        // The same lengths give the same tensions.
        let step = |solution: &Solution| -> Vec<CableCommand> {
            let of = |cable: &whipcord::CableState| CableCommand {
                tension: None,
                shortening: Some(whipcord::Shortening::Length(cable.initial_length - cable.length)),
            };
            solution.cables.iter().map(of).collect()
        };
        let mut steps: Vec<_> = solved.iter().map(step).collect();
        let commands = steps.pop().unwrap();
        let by_length = Case { commands, before: steps, loads: loads.clone(), ..Case::default() };
        let model = Model::new(kind, Stations::default(), Actuation::Shortening);
        let again =
            model.prepare(&robot, &loads).unwrap().solve_all(&by_length).unwrap().pop().unwrap();
        let last = solved.last().unwrap();
        let apart = again.disks.distances(&last.disks).fold(0.0, f64::max);
        assert!(apart < 1e-5 * LENGTH, "{kind:?}: {apart}");
        found.push(last.clone());
    }
    let apart = found[0].disks.distances(&found[1].disks).fold(0.0, f64::max);
    assert!(apart < 1e-3 * LENGTH, "{apart}");
}

#[test]
fn what_the_models_do_not_take_is_refused() {
    let robot = antagonists(Some(friction()), 6);
    // That of four-bar sections is one without forces.
    for kind in [ModelKind::FourBar, ModelKind::ConstantCurvature] {
        let solved = Model::new(kind, Stations::default(), Actuation::Natural)
            .prepare(&robot, &Loads::default())
            .map(|_| ());
        let Err(SolveError::Unsupported { path, .. }) = solved else {
            panic!("{kind:?}: {solved:?}")
        };
        assert_eq!(path, "backbone.yield_moment");
    }
    let wrong = BendingFriction { yield_moment: [0.1, -1.0], ..friction() };
    let backbone = Backbone { bending_friction: Some(wrong), ..paper_backbone() };
    let refused = Robot::new(backbone, Disks::equally_spaced(0.18, 3, ARM), vec![]).unwrap_err();
    assert_eq!(refused.path, "backbone.yield_moment[1]");
    assert_eq!(refused.problem, Problem::Negative { value: -1.0 });
}
