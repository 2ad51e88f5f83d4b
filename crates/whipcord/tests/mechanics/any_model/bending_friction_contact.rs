//! Friction against bending of the backbone among obstacles: a closed form, the models against each other, and what must hold for any robot.

use whipcord::cosserat::Accuracy;
use whipcord::robot::BendingFriction;
use whipcord::{
    Backbone, CableCommand, Case, Loads, Model, ModelKind, Obstacle, Parameter, PointLoad, Robot,
    Solution, Statics as _, Stiffness, Vec3,
    derivatives::{Hold, Place},
};

use super::bending_friction::{
    ARM, LENGTH, MODELS, antagonists, friction, model, moments, solve_all,
};
use crate::contact::{among, pushes_of, wall};

/// The pushes of an answer, with pushes of nothing at the places of the others.
fn with_places(own: &Loads, all: &[Loads]) -> Loads {
    let mut points = own.points.clone();
    for at in all.iter().flat_map(|loads| &loads.points).map(|point| point.at) {
        if points.iter().all(|point| point.at != at) {
            points.push(PointLoad { at, ..PointLoad::default() });
        }
    }
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    Loads { points, ..own.clone() }
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

/// Pulled against a wall and let go: the robot without the wall under the contact forces of both steps has the same shape and holds as much.
#[test]
fn against_a_wall_and_under_its_forces() {
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 9);
        let free = moments(&[0.024, 0.016]);
        for friction in [0.0, 0.3] {
            let obstacle = Obstacle { friction, ..wall(0.06) };
            let solved = solve_all(kind, &robot, &among(free.clone(), vec![obstacle]));
            let slid = &solved[0].plastic_curvature;
            assert!(slid.iter().any(|k| k[1].abs() > 0.1), "{kind}");
            let [pulled, let_go] = &solved[..] else { panic!("{kind}") };
            assert!(!pulled.contacts.is_empty() && !let_go.contacts.is_empty(), "{kind}");
            let pushes = [pulled, let_go].map(|solution| pushes_of(solution).0);
            let [first, last] = pushes.each_ref().map(|own| with_places(own, &pushes));
            let pushed = Case { loads: last, loads_before: vec![first], ..free.clone() };
            let again = solve_all(kind, &robot, &pushed);
            let is_rod = matches!(kind, ModelKind::Cosserat | ModelKind::CosseratDisks);
            // Of rods both answers are known to their tolerances.
            let (shape, held) = if is_rod { (2e-5, 2e-2) } else { (1e-6, 1e-5) };
            for (again, solution) in again.iter().zip(&solved) {
                let moved = apart(again, solution);
                assert!(moved < shape * LENGTH, "{kind} {friction}: {moved}");
                let pairs = again.plastic_curvature.iter().zip(&solution.plastic_curvature);
                let off = pairs.flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]);
                let off = off.map(f64::abs).fold(0.0, f64::max);
                assert!(off < held, "{kind} {friction}: {off}");
            }
            // Without friction against bending it would come back to where the command leads alone.
            let alone = solve_all(kind, &robot, &among(moments(&[0.016]), vec![wall(0.06)]));
            assert!(apart(&alone[0], let_go) > 1e-3 * LENGTH, "{kind}");
        }
    }
}

/// Stiffness, yield moment and added stiffness of a backbone that bends little.
const STIFF: [f64; 3] = [0.4, 6e-3, 3.0];

fn stiff_antagonists(disks: usize) -> Robot {
    let [bending, limit, added] = STIFF;
    let held = BendingFriction { yield_moment: [limit; 2], yield_stiffness: Some([added; 2]) };
    let robot = antagonists(Some(held), disks);
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: [bending; 2].into(),
        torsion: (0.8 * bending).into(),
    };
    let backbone = Backbone { stiffness: Some(stiffness), ..robot.backbone().clone() };
    Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap()
}

/// Curvature of a section under a moment from the plastic curvature that it held, and that which it holds then.
fn bent(moment: f64, plastic: f64) -> (f64, f64) {
    let [bending, limit, added] = STIFF;
    let stuck = (moment + added * plastic) / (bending + added);
    let spring = added * (stuck - plastic);
    if spring.abs() <= limit {
        return (stuck, plastic);
    }
    let u = (moment - limit * spring.signum()) / bending;
    (u, u - spring.signum() * limit / added)
}

/// Small bends by quadrature: the deflection of the tip under a moment of the cables and a force at the tip against it, from what the
/// sections held, and what they hold then.
fn deflected(moment: f64, force: f64, held: &[f64]) -> (f64, Vec<f64>) {
    let n = held.len() as f64;
    let mut tip = 0.0;
    let left = held.iter().enumerate().map(|(k, &plastic)| {
        let arm = LENGTH * (1.0 - (k as f64 + 0.5) / n);
        let (u, left) = bent(moment - force * arm, plastic);
        tip += u * arm * LENGTH / n;
        left
    });
    let left = left.collect();
    (tip, left)
}

/// A cantilever that its cables press against a wall, with more and less, and let go: statically indeterminate, with sections that slide
/// and sections that stick, against beam theory with the force that leaves the tip at the wall.
#[test]
fn a_cantilever_is_pressed_against_a_wall() {
    let gap = 4.5e-4;
    let way = [0.024, 0.03, 0.022, 0.0];
    let mut held = vec![0.0; 4000];
    let mut exact = Vec::new();
    for moment in way {
        let (mut low, mut high) = (0.0, 2.0 * 0.03 / LENGTH);
        let mut force = 0.0;
        if deflected(moment, 0.0, &held).0 > gap {
            while high - low > 1e-12 {
                force = 0.5 * (low + high);
                if deflected(moment, force, &held).0 > gap { low = force } else { high = force }
            }
        }
        let (tip, left) = deflected(moment, force, &held);
        held = left;
        exact.push((tip, force, held[0], held[held.len() - 1]));
    }
    assert!(exact[2].1 > 0.01 && exact[3].1 == 0.0 && exact[3].0 > 0.1 * gap, "{exact:?}");
    for kind in MODELS {
        let robot = stiff_antagonists(41);
        let case = among(moments(&way), vec![wall(gap + ARM)]);
        let solved = solve_all(kind, &robot, &case);
        for (solution, (tip, force, ..)) in solved.iter().zip(&exact) {
            let found = solution.disks.tip().position.x;
            assert!((found - tip).abs() < 0.01 * gap, "{kind}: {found} and {tip}");
            let pressed = pushes_of(solution).1.force.x.abs();
            assert!((pressed - force).abs() < 0.02 * exact[0].1, "{kind}: {pressed} and {force}");
        }
        // It keeps its bend, and what it holds beside the tip is that of the beam.
        let last = solved.last().unwrap();
        let near_tip = last.plastic_curvature[39][1];
        let scale = exact[3].3;
        assert!((near_tip - scale).abs() < 0.03 * scale.abs(), "{kind}: {near_tip} and {scale}");
    }
}

/// Of many thin disks all models are one.
#[test]
fn the_models_agree_among_obstacles() {
    let ball = Obstacle { friction: 0.0, ..wall(0.05) };
    let mut case = moments(&[0.024, 0.008, 0.014]);
    case.loads.tip_force = Vec3::new(0.0, 0.05, -0.02);
    let case = among(case, vec![ball]);
    let robot = antagonists(Some(friction()), 41);
    let all: Vec<_> = MODELS.iter().map(|&kind| solve_all(kind, &robot, &case)).collect();
    for (kind, of) in MODELS.iter().zip(&all).skip(1) {
        for (n, (a, b)) in of.iter().zip(&all[0]).enumerate() {
            let apart = apart(a, b);
            assert!(apart < 1e-2 * LENGTH, "{kind} step {n}: {apart}");
        }
    }
}

#[test]
fn what_touches_nothing_has_the_answer_without_obstacles() {
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 9);
        let mut case = moments(&[0.02, -0.004, 0.012]);
        case.loads.tip_force = Vec3::new(0.03, 0.06, -0.05);
        let free = solve_all(kind, &robot, &case);
        let among = solve_all(kind, &robot, &among(case, vec![wall(0.5)]));
        for (a, b) in among.iter().zip(&free) {
            assert_eq!(a.shape, b.shape, "{kind}");
            assert_eq!(a.plastic_curvature, b.plastic_curvature, "{kind}");
        }
    }
}

#[test]
fn each_step_among_obstacles_is_the_answer_to_the_steps_up_to_it() {
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 6);
        let case = among(moments(&[0.024, 0.01, 0.02]), vec![wall(0.05)]);
        let all = solve_all(kind, &robot, &case);
        for (step, solution) in case.steps().zip(&all) {
            let alone = model(kind).solve(&robot, &step).unwrap();
            assert_eq!(alone.shape, solution.shape, "{kind:?}");
            assert_eq!(alone.plastic_curvature, solution.plastic_curvature);
        }
    }
}

/// From a state that touches to another the moments only grow or only fall: the step may be divided.
#[test]
fn a_step_may_be_divided_where_the_moments_do_not_turn_round() {
    for kind in MODELS {
        let robot = stiff_antagonists(11);
        let at = |way: &[f64]| {
            let case = among(moments(way), vec![wall(3e-4 + ARM)]);
            solve_all(kind, &robot, &case).pop().unwrap()
        };
        let (whole, parts) = (at(&[0.018, 0.03]), at(&[0.018, 0.021, 0.024, 0.027, 0.03]));
        let apart = apart(&whole, &parts);
        assert!(apart < 1e-5 * LENGTH, "{kind}: {apart}");
        let pairs = whole.plastic_curvature.iter().zip(&parts.plastic_curvature);
        let off = pairs.map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f64::max);
        assert!(off < 2e-3 * parts.plastic_curvature[9][1].abs(), "{kind}: {off}");
    }
}

/// Around a cycle at the wall the cables do the work that friction loses.
#[test]
fn a_cycle_at_a_wall_loses_energy() {
    let cycle = [0.012, 0.018, 0.024, 0.03, 0.024, 0.018, 0.012];
    let way: Vec<f64> = cycle.iter().chain(&cycle[1..]).copied().collect();
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 9);
        let solved = solve_all(kind, &robot, &among(moments(&way), vec![wall(0.05)]));
        assert!(solved[3..].iter().any(|solution| !solution.contacts.is_empty()), "{kind}");
        let tension = |n: usize, i: usize| solved[n].cables[i].tension.unwrap();
        let length = |n: usize, i: usize| solved[n].cables[i].length;
        let work = |n: usize| -> f64 {
            let of = |i: usize| {
                0.5 * (tension(n, i) + tension(n + 1, i)) * (length(n, i) - length(n + 1, i))
            };
            (0..2).map(of).sum()
        };
        let last = solved.len() - 1;
        let lost: f64 = (last - 6..last).map(work).sum();
        let apart = apart(&solved[last], &solved[last - 6]);
        assert!(apart < 2e-4 * LENGTH, "{kind}: the loop is closed to {apart}");
        assert!(lost > 1e-5, "{kind}: {lost}");
    }
}

/// A case whose cables have the lengths of these answers, those that are slack a little more.
fn by_lengths(solved: &[Solution], case: &Case) -> Case {
    let step = |solution: &Solution| -> Vec<CableCommand> {
        let of = |cable: &whipcord::CableState| {
            let slack = if cable.tension.unwrap() > 0.0 { 0.0 } else { 5e-4 };
            let shortening = cable.initial_length - cable.length - slack;
            let shortening = Some(whipcord::Shortening::Length(shortening));
            CableCommand { tension: None, shortening }
        };
        solution.cables.iter().map(of).collect()
    };
    let mut before: Vec<_> = solved.iter().map(step).collect();
    let commands = before.pop().unwrap();
    Case { commands, before, ..case.clone() }
}

/// The same lengths as under tensions lead to the same shapes.
#[test]
fn lengths_lead_to_the_answers_of_their_tensions() {
    for kind in MODELS {
        let robot = antagonists(Some(friction()), 9);
        let case = among(moments(&[0.024, 0.012]), vec![wall(0.05)]);
        let solved = solve_all(kind, &robot, &case);
        let by_length = by_lengths(&solved, &case);
        let of_lengths = crate::common::model_with_forces(
            kind,
            whipcord::Stations::default(),
            whipcord::Actuation::Shortening,
        );
        let again =
            of_lengths.prepare(&robot, &Loads::default()).unwrap().solve_all(&by_length).unwrap();
        let apart = apart(&again[1], &solved[1]);
        assert!(apart < 2e-4 * LENGTH, "{kind}: {apart}");
    }
}

/// Of rods: derivatives through the steps at a wall, against differences of answers.
#[test]
fn derivatives_among_obstacles_agree_with_differences() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let robot = antagonists(Some(friction()), 7);
        let mut case = moments(&[0.024, 0.014]);
        case.loads.tip_force = Vec3::new(0.01, 0.04, -0.02);
        let case = among(case, vec![wall(0.05)]);
        let mut model = model(kind);
        if let Model::Cosserat(o) | Model::CosseratDisks(o) = &mut model {
            o.accuracy = Accuracy::Steps(24);
        }
        let solve = |robot: &Robot, case: &Case| {
            model.prepare(robot, &case.loads).unwrap().solve(case, None).unwrap()
        };
        let parameters = [
            Parameter::YieldMoment { axis: None },
            Parameter::YieldStiffness { axis: None },
            Parameter::RestCurvature { axis: 0 },
            Parameter::TipForce { axis: 1 },
            Parameter::Radius { cable: 0 },
        ];
        let (solution, of) = model
            .prepare(&robot, &case.loads)
            .unwrap()
            .solve_with_derivatives(&case, None, &parameters)
            .unwrap();
        assert!(!solution.contacts.is_empty());
        assert!(!of.is_contact_about_to_change());
        for (p, parameter) in parameters.iter().enumerate() {
            let value = parameter.value(&robot, &case).unwrap();
            let scale = if value == 0.0 { 1.0 } else { value.abs() };
            let h = 1e-5 * scale;
            let at = |by: f64| {
                let (robot, case) = parameter.moved(&robot, &case, by).unwrap();
                solve(&robot, &case).disks.tip().position
            };
            let difference = (at(h) - at(-h)) * (0.5 / h);
            let exact = of.parameter(p, Hold::Commands).twist(Place::Disk(6)).linear;
            let off = (difference - exact).norm() * scale / LENGTH;
            let size = exact.norm() * scale / LENGTH;
            assert!(off < 1e-6 + 1e-4 * size, "{kind} {parameter}: {difference:?} {exact:?}");
        }
    }
}
