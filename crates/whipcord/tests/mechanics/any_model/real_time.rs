//! Solves into memory that is at hand, and within a budget.

use whipcord::{
    Actuation, Budget, Cable, Case, Loads, Model, ModelKind, Prepared, Robot, Routing, Shortening,
    Solution, SolveError, Statics as _, Stations, Status, Vec3, WarmStart,
};

use crate::common::{helix, model_with_forces, paper_backbone, paper_disks, straight};
use crate::contact::{among, finger, wall};

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Equal(25), Actuation::Natural)
}

/// The robot of the paper, of nylon with its weight.
fn weighty(routings: Vec<Routing>) -> Robot {
    let mut backbone = paper_backbone();
    backbone.material.density = Some(1040.0);
    let cable = |(i, routing)| Cable::new(format!("{i}"), routing);
    Robot::new(backbone, paper_disks(), routings.into_iter().enumerate().map(cable).collect())
        .unwrap()
}

fn takes_loads(kind: ModelKind) -> bool {
    !matches!(kind, ModelKind::FourBar | ModelKind::ConstantCurvature)
}

fn loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(0.0, 0.0, -9.80665)),
        tip_force: Vec3::new(0.05, 0.02, 0.0),
        ..Loads::default()
    }
}

/// Neighbouring cases of a robot, each a cycle of a controller.
fn cycles(make: impl Fn(f64) -> Case) -> Vec<Case> {
    (0..60).map(|n| make((0.1 * f64::from(n)).sin())).collect()
}

/// The cases that a model is driven through: by tensions and by lengths, without loads and with them.
fn families(kind: ModelKind) -> Vec<(&'static str, Robot, Vec<Case>)> {
    let one = || weighty(vec![straight(0.0)]);
    let helical = || weighty(vec![helix(0.0, 0.2)]);
    let by_tension = |x: f64| Case::with_tensions(&[2.0 + x]);
    let by_length = |x: f64| Case::with_shortenings(&[Shortening::Length(0.004 + 0.001 * x)]);
    let three = || weighty(vec![straight(0.0), straight(120.0), straight(240.0)]);
    let three_by_tension = |x: f64| Case::with_tensions(&[2.0 + x, 0.5, 1.0 - x]);
    let loaded = |case: Case| Case { loads: loads(), ..case };
    let mut families = vec![("length of one cable", one(), cycles(by_length))];
    if kind != ModelKind::FourBar {
        families.push(("tension of one cable", one(), cycles(by_tension)));
        families.push(("tensions of three cables", three(), cycles(three_by_tension)));
    }
    if takes_loads(kind) {
        let cases = cycles(|x| loaded(by_tension(x)));
        families.push(("tension of a helical cable", helical(), cycles(by_tension)));
        families.push(("tension of one cable under loads", one(), cases));
        let cases = cycles(|x| loaded(three_by_tension(x)));
        families.push(("tensions of three cables under loads", three(), cases));
        let cases = cycles(|x| loaded(by_length(x)));
        families.push(("length of one cable under loads", one(), cases));
    }
    families
}

fn prepared(kind: ModelKind, robot: &Robot, cases: &[Case]) -> Prepared {
    model(kind).prepare(robot, &cases[0].loads).unwrap()
}

#[test]
fn nothing_is_allocated_after_the_first_cycles() {
    let mut allocating = Vec::new();
    for kind in ModelKind::ALL {
        for (name, robot, cases) in families(kind) {
            let mut model = prepared(kind, &robot, &cases);
            let mut solution = Solution::empty(kind);
            // The first round finds how much memory the cases take.
            let status = model.solve_into(&cases[0], WarmStart::None, &mut solution).unwrap();
            assert_eq!(status, Status::Converged);
            let mut count = 0;
            for round in 0..2 {
                for case in &cases {
                    let info = allocation_counter::measure(|| {
                        let solved = model.solve_into(case, WarmStart::Output, &mut solution);
                        assert_eq!(solved, Ok(Status::Converged));
                    });
                    count += if round > 0 { info.count_total } else { 0 };
                }
            }
            if count > 0 {
                allocating.push((kind, name, count));
            }
        }
    }
    assert_eq!(allocating, []);
}

#[test]
fn it_is_the_answer_of_a_solve_from_the_same_start() {
    for kind in ModelKind::ALL {
        for (name, robot, cases) in families(kind) {
            let mut model = prepared(kind, &robot, &cases);
            let mut solution = Solution::empty(kind);
            let mut before: Option<Solution> = None;
            for case in &cases {
                let expected = model.solve(case, before.as_ref()).unwrap();
                let from = if before.is_some() { WarmStart::Output } else { WarmStart::None };
                assert_eq!(model.solve_into(case, from, &mut solution), Ok(Status::Converged));
                assert_eq!(solution, expected, "{kind}: {name}");
                let mut other = Solution::empty(kind);
                let from = before.as_ref().into();
                assert_eq!(model.solve_into(case, from, &mut other), Ok(Status::Converged));
                assert_eq!(other, expected, "{kind}: {name}");
                before = Some(expected);
            }
        }
    }
}

#[test]
fn a_budget_of_one_iteration_a_cycle_comes_to_the_answer() {
    for kind in ModelKind::ALL.into_iter().filter(|&kind| takes_loads(kind)) {
        let robot = weighty(vec![straight(0.0)]);
        let case = Case { loads: loads(), ..Case::with_tensions(&[3.0]) };
        let expected = model(kind).solve(&robot, &case).unwrap();
        let mut model = prepared(kind, &robot, std::slice::from_ref(&case));
        let mut solution = Solution::empty(kind);
        let start = Case { loads: loads(), ..Case::with_tensions(&[1.0]) };
        assert_eq!(model.solve_into(&start, WarmStart::None, &mut solution), Ok(Status::Converged));
        model.set_budget(Budget { iterations: 1, ..Budget::UNLIMITED });
        let mut away = Vec::new();
        for _ in 0..12 {
            let status = model.solve_into(&case, WarmStart::Output, &mut solution).unwrap();
            let far = solution.disks.distances(&expected.disks).fold(0.0, f64::max);
            assert!(far.is_finite() && solution.diagnostics.residual.is_finite());
            away.push((status, far, solution.diagnostics.residual));
        }
        // The first cycles leave a residual that tells so, and the next go on from there.
        let (first, last) = (&away[0], &away[away.len() - 1]);
        assert!(first.0 == Status::BudgetSpent && first.2 > 1e-6, "{kind}: {away:?}");
        assert!(last.1 < 1e-5 * robot.backbone().length, "{kind}: {away:?}");
    }
}

/// On prescribed steps there is no coarser answer: what is left is the last iterate.
#[test]
fn a_cold_solve_whose_budget_is_spent_leaves_its_last_iterate() {
    let robot = weighty(vec![straight(0.0), straight(2.0)]);
    let options = whipcord::cosserat::Options {
        accuracy: whipcord::cosserat::Accuracy::Steps(12),
        ..whipcord::cosserat::Options::default()
    };
    let model = Model::Cosserat(options);
    for strength in [0.1, 1.0, 10.0] {
        let mut loads = loads();
        loads.tip_force *= strength;
        loads.tip_moment *= strength;
        let case = Case { loads, ..Case::with_tensions(&[1.0, 0.5]) };
        let expected = model.solve(&robot, &case).unwrap();
        let bare = Case { loads: Loads::default(), ..case.clone() };
        let unloaded = model.solve(&robot, &bare).unwrap();
        let mut prepared = model.prepare(&robot, &case.loads).unwrap();
        prepared.set_budget(Budget { iterations: 1, ..Budget::UNLIMITED });
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let status = prepared.solve_into(&case, WarmStart::None, &mut solution);
        assert_eq!(status, Ok(Status::BudgetSpent));
        let apart = |a: &Solution, b: &Solution| a.disks.distances(&b.disks).fold(0.0, f64::max);
        let bent = apart(&unloaded, &expected);
        assert!(apart(&solution, &unloaded) > 0.3 * bent, "{strength}");
        // One iteration is enough for weak loads.
        assert!(strength > 1.0 || apart(&solution, &expected) < 0.3 * bent, "{strength}");
        assert!(solution.diagnostics.residual > 0.0 && solution.diagnostics.residual.is_finite());
    }
}

/// With one iteration a cycle the shape follows the commands, under strong loads, too, and comes to the answer when they rest.
#[test]
fn one_iteration_a_cycle_goes_on_from_the_shape_so_far() {
    let robot = weighty(vec![straight(0.0), straight(2.0)]);
    let options = whipcord::cosserat::Options {
        accuracy: whipcord::cosserat::Accuracy::Steps(12),
        ..whipcord::cosserat::Options::default()
    };
    let model = Model::Cosserat(options);
    let apart = |a: &Solution, b: &Solution| a.disks.distances(&b.disks).fold(0.0, f64::max);
    for strength in [0.3, 1.0, 10.0, 60.0] {
        let mut loads = loads();
        loads.tip_force *= strength;
        let at = |share: f64| Case {
            loads: loads.clone(),
            ..Case::with_tensions(&[share * 1.0, share * 0.5])
        };
        let mut prepared = model.prepare(&robot, &loads).unwrap();
        let before = prepared.solve(&at(0.8), None).unwrap();
        let expected = prepared.solve(&at(1.0), None).unwrap();
        prepared.set_budget(Budget { iterations: 1, ..Budget::UNLIMITED });
        let mut solution = before.clone();
        let status = prepared.solve_into(&at(1.0), WarmStart::Output, &mut solution);
        assert_eq!(status, Ok(Status::BudgetSpent), "{strength}");
        let [moved, left] = [&before, &solution].map(|from| apart(from, &expected));
        assert!(left < 0.5 * moved, "{strength}: {left:.1e} of {moved:.1e}");
        let mut cycles = 1;
        while prepared.solve_into(&at(1.0), WarmStart::Output, &mut solution)
            != Ok(Status::Converged)
        {
            cycles += 1;
            assert!(cycles < 10, "{strength}");
        }
        assert!(apart(&solution, &expected) < 1e-8, "{strength}");
    }
}

#[test]
fn a_solve_whose_budget_is_spent_says_so() {
    let robot = weighty(vec![straight(0.0)]);
    let case = Case { loads: loads(), ..Case::with_tensions(&[3.0]) };
    for kind in ModelKind::ALL.into_iter().filter(|&kind| takes_loads(kind)) {
        let budget = Budget { iterations: 1, ..Budget::UNLIMITED };
        let error = model(kind).with_budget(budget).solve(&robot, &case).unwrap_err();
        let SolveError::BudgetSpent { iterations, .. } = error else { panic!("{kind}: {error}") };
        assert_eq!(iterations, 1, "{kind}");
        let budget = Budget { integration_steps: 3, ..Budget::UNLIMITED };
        let error = model(kind).with_budget(budget).solve(&robot, &case).unwrap_err();
        assert!(matches!(error, SolveError::BudgetSpent { .. }), "{kind}: {error}");
        // What suffices changes nothing.
        let expected = model(kind).solve(&robot, &case);
        let ample = Budget { iterations: 1_000, integration_steps: 100_000 };
        assert_eq!(model(kind).with_budget(ample).solve(&robot, &case), expected, "{kind}");
    }
}

#[test]
fn a_budget_ends_a_solve_among_obstacles() {
    let case = among(Case::with_tensions(&[3.0]), vec![wall(0.05)]);
    for friction in [None, Some(0.2)] {
        let smooth = finger(9);
        let cables = smooth.cables().iter().map(|cable| Cable { friction, ..cable.clone() });
        let (backbone, disks) = (smooth.backbone().clone(), smooth.disks().clone());
        let robot = Robot::new(backbone, disks, cables.collect()).unwrap();
        for kind in ModelKind::ALL.into_iter().filter(|&kind| kind != ModelKind::ConstantCurvature)
        {
            let model = model_with_forces(kind, Stations::Disks, Actuation::Natural);
            let expected = model.solve(&robot, &case).unwrap();
            assert!(!expected.contacts.is_empty());
            for iterations in [1, 3] {
                let budget = Budget { iterations, ..Budget::UNLIMITED };
                let error = model.clone().with_budget(budget).solve(&robot, &case).unwrap_err();
                let SolveError::BudgetSpent { iterations: spent, .. } = error else {
                    panic!("{kind}: {error}")
                };
                assert!((iterations..=iterations + 1).contains(&spent), "{kind}: {spent}");
            }
            let budget = Budget { integration_steps: 10, ..Budget::UNLIMITED };
            let error = model.clone().with_budget(budget).solve(&robot, &case).unwrap_err();
            assert!(matches!(error, SolveError::BudgetSpent { .. }), "{kind}: {error}");
            let ample = Budget { iterations: 10_000, integration_steps: 1_000_000 };
            assert_eq!(model.with_budget(ample).solve(&robot, &case).unwrap(), expected, "{kind}");
        }
    }
}
