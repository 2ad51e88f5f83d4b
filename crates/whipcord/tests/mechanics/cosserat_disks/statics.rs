//! The model with cables straight from hole to hole: limits, equilibrium, symmetries.

use crate::common::{ACCURATE, accurate};
use crate::common::{helix, paper_backbone, paper_disks, paper_robot, stability_of_path, straight};
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::Options;
use whipcord::{
    Along, Backbone, Cable, Case, Disks, Loads, Material, Model, ModelKind, PointLoad, Robot,
    Routing, Section, Shortening, Solution, SolveError, StabilityAnalysis, Statics, Vec3,
};

fn solve(robot: &Robot, case: &Case) -> Solution {
    Model::CosseratDisks(accurate())
        .solve(robot, case)
        .unwrap_or_else(|error| panic!("{error}\n{case:?}"))
}

fn heavy() -> Backbone {
    let mut backbone = paper_backbone();
    backbone.material = Material { density: Some(1040.0), ..backbone.material };
    backbone
}

fn with_sections(sections: usize, routings: &[Routing]) -> Robot {
    let disks = Disks::equally_spaced(0.18, sections + 1, 0.008);
    let cable = |(i, routing): (usize, &Routing)| Cable::new(format!("c{i}"), routing.clone());
    Robot::new(heavy(), disks, routings.iter().enumerate().map(cable).collect()).unwrap()
}

fn several_loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(1.0, 2.0, -9.0)),
        tip_force: Vec3::new(0.05, -0.08, 0.02),
        tip_moment: Vec3::new(1e-3, 2e-3, 1e-3),
        points: vec![
            PointLoad { at: 0.05, force: Vec3::new(0.0, 0.05, 0.0), ..PointLoad::default() },
            PointLoad { at: 0.13, moment: Vec3::new(2e-3, 0.0, 1e-3), ..PointLoad::default() },
        ],
        ..Loads::default()
    }
}

#[test]
fn tends_to_the_continuous_model_with_order_two() {
    let routings = [helix(20.0, 0.6), straight(200.0)];
    for loads in [Loads::default(), several_loads()] {
        let case = Case { loads, ..Case::with_tensions(&[3.0, 1.5]) };
        let continuous = Model::new(ModelKind::Cosserat, Default::default(), Default::default())
            .with_tolerance(ACCURATE)
            .solve(&with_sections(9, &routings), &case)
            .unwrap();
        let error = |sections: usize| {
            let solution = solve(&with_sections(sections, &routings), &case);
            (solution.disks.tip().position - continuous.disks.tip().position).norm()
        };
        let errors = [9, 18, 36, 72].map(error);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.9..2.1).contains(&order), "{errors:?}");
        }
    }
}

#[test]
fn at_the_papers_spacing_the_tip_is_some_millimetres_from_the_continuous_one() {
    // The paper's cases I and III: 1.7 % of the length, and 1.1 %.
    let cases = [(vec![4; 10], 0.003_12), (vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1], 0.001_96)];
    for (holes, expected) in cases {
        let robot = paper_robot(vec![Routing::holes(holes)]);
        let case = Case::with_tensions(&[0.4 * 9.80665]);
        let tip = |kind| {
            let model =
                Model::new(kind, Default::default(), Default::default()).with_tolerance(ACCURATE);
            model.solve(&robot, &case).unwrap().disks.tip().position
        };
        let apart = (tip(ModelKind::CosseratDisks) - tip(ModelKind::Cosserat)).norm();
        assert!((apart - expected).abs() < 1e-5, "{apart}");
    }
}

/// Forces on the whole robot: what the base bears is all that is applied, and its moment.
#[test]
fn the_base_bears_what_is_applied() {
    let robot = with_sections(7, &[helix(20.0, 0.6), straight(200.0)]);
    let loads = Loads { gravity: None, ..several_loads() };
    let case = Case { loads, ..Case::with_tensions(&[3.0, 1.5]) };
    let stations = whipcord::Stations::Equal(19);
    let model =
        Model::new(ModelKind::CosseratDisks, stations, Default::default()).with_tolerance(ACCURATE);
    let solution = model.solve(&robot, &case).unwrap();
    let at = |s: f64| {
        let i = solution.shape.arc_length.iter().position(|&x| (x - s).abs() < 1e-9).unwrap();
        solution.shape.poses[i].position
    };
    let tip = solution.disks.tip().position;
    let force = Vec3::new(0.05, -0.08 + 0.05, 0.02);
    let moment = Vec3::new(1e-3 + 2e-3, 2e-3, 1e-3 + 1e-3)
        + tip.cross(case.loads.tip_force)
        + at(0.05).cross(case.loads.points[0].force);
    let base = solution.base_wrench.unwrap();
    assert!((base.force - force).norm() < 1e-13);
    assert!((base.moment - moment).norm() < 1e-9, "{:?} {moment:?}", base.moment);
}

#[test]
fn lengths_give_back_the_tensions() {
    let robot = with_sections(9, &[helix(20.0, 0.6), straight(200.0), straight(80.0)]);
    for loads in [Loads::default(), several_loads()] {
        let tensions = [3.0, 1.5, 0.7];
        let case = Case { loads: loads.clone(), ..Case::with_tensions(&tensions) };
        let solution = solve(&robot, &case);
        let shorter: Vec<Shortening> = solution
            .cables
            .iter()
            .map(|cable| Shortening::Length(cable.initial_length - cable.length))
            .collect();
        let back = solve(&robot, &Case { loads, ..Case::with_shortenings(&shorter) });
        for (cable, given) in back.cables.iter().zip(tensions) {
            assert!((cable.tension.unwrap() - given).abs() < 1e-7, "{:?}", back.cables);
        }
    }
}

#[test]
fn followers_turn_with_the_robot() {
    let robot = with_sections(6, &[straight(0.0)]);
    let loads = Loads {
        tip_force: Vec3::new(0.1, 0.05, 0.02),
        tip_follower: true,
        points: vec![PointLoad {
            at: 0.08,
            force: Vec3::new(0.0, 0.1, 0.0),
            follower: true,
            ..PointLoad::default()
        }],
        ..Loads::default()
    };
    let case = Case { loads, ..Case::with_tensions(&[2.0]) };
    let stations = whipcord::Stations::Equal(10);
    let model =
        Model::new(ModelKind::CosseratDisks, stations, Default::default()).with_tolerance(ACCURATE);
    let solution = model.solve(&robot, &case).unwrap();
    let at_load = solution.shape.poses[4];
    let tip = solution.disks.tip();
    let (far, near) = (
        tip.rotation.rotate(case.loads.tip_force),
        at_load.rotation.rotate(case.loads.points[0].force),
    );
    let base = solution.base_wrench.unwrap();
    let moment = tip.position.cross(far) + at_load.position.cross(near);
    assert!((base.force - far - near).norm() < 1e-9);
    assert!((base.moment - moment).norm() < 1e-9);
}

#[test]
fn fewer_steps_than_the_default_err_by_little() {
    let robot = paper_robot(vec![straight(0.0)]);
    let case = Case::with_tensions(&[0.4 * 9.80665]);
    let exact = solve(&robot, &case);
    let options = Options { accuracy: Accuracy::Steps(9), ..accurate() };
    let coarse = Model::CosseratDisks(options).solve(&robot, &case).unwrap();
    let error = (coarse.disks.tip().position - exact.disks.tip().position).norm() / 0.18;
    assert!(error < 2e-5, "{error}");
    assert_eq!(paper_disks().count(), 10);
}

/// With many disks it is the stability of the continuous model, and of a bare rod always.
#[test]
fn stability_is_that_of_the_continuous_model_in_the_limit() {
    let pushed = |force: f64| Loads { tip_force: Vec3::new(0.0, 0.0, -force), ..Loads::default() };
    let bare = [];
    let cables = [straight(0.0), straight(180.0), helix(20.0, 0.6)];
    let tensions = [2.0, 2.0, 1.0];
    for (routings, tensions, loads, sections, tolerance) in [
        (&bare[..], &[][..], pushed(0.2), 5, 1e-5),
        (&bare[..], &[][..], pushed(0.6), 5, 1e-5),
        (&cables[..2], &tensions[..2], pushed(0.2), 40, 2e-3),
        (&cables[..], &tensions[..], Loads::default(), 40, 2e-2),
        (&cables[..], &tensions[..], several_loads(), 40, 2e-2),
    ] {
        let robot = with_sections(sections, routings);
        let case = Case { loads, ..Case::with_tensions(tensions) };
        let least = |kind| {
            let model = Model::new(kind, Default::default(), Default::default())
                .with_tolerance(ACCURATE)
                .with_stability(StabilityAnalysis::Eigenvalue);
            stability_of_path(&model.solve(&robot, &case).unwrap())
        };
        let (disks, continuous) = (least(ModelKind::CosseratDisks), least(ModelKind::Cosserat));
        assert!((disks - continuous).abs() < tolerance, "{disks} {continuous}");
    }
}

/// The same robot elsewhere, under loads given in its base's frame.
#[test]
fn moving_the_base_moves_the_robot() {
    use whipcord::{Pose, UnitQuaternion};
    let robot = with_sections(9, &[helix(20.0, 0.6), straight(200.0)]);
    let case = Case { loads: several_loads(), ..Case::with_tensions(&[3.0, 1.5]) };
    let base = Pose {
        position: Vec3::new(0.1, -0.2, 0.3),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -0.9, 0.2)),
    };
    let (here, there) = (solve(&robot, &case), solve(&robot, &Case { base, ..case.clone() }));
    for (a, b) in here.disks.poses.iter().zip(&there.disks.poses) {
        assert!((base.transform(a.position) - b.position).norm() < 1e-12);
    }
    // From a neighbour that stands there.
    let mut model = Model::CosseratDisks(accurate()).prepare(&robot, &case.loads).unwrap();
    let warm = model.solve(&case, Some(&there)).unwrap();
    assert!((warm.disks.tip().position - here.disks.tip().position).norm() < 1e-11);
}

#[test]
fn a_robot_at_rest_stays_and_mirrored_cables_mirror_the_shape() {
    let robot = with_sections(5, &[helix(20.0, 0.6), straight(80.0)]);
    let rest = solve(&robot, &Case::with_tensions(&[0.0, 0.0]));
    assert!((rest.disks.tip().position - Vec3::new(0.0, 0.0, 0.18)).norm() < 1e-15);
    let mirrored = with_sections(5, &[helix(-20.0, -0.6), straight(-80.0)]);
    let case = Case::with_tensions(&[3.0, 1.0]);
    let (a, b) = (solve(&robot, &case), solve(&mirrored, &case));
    for (a, b) in a.disks.positions().zip(b.disks.positions()) {
        assert!((Vec3::new(a.x, -a.y, a.z) - b).norm() < 1e-12);
    }
    let relabelled = with_sections(5, &[straight(80.0), helix(20.0, 0.6)]);
    let other = solve(&relabelled, &Case::with_tensions(&[1.0, 3.0]));
    assert!((other.disks.tip().position - a.disks.tip().position).norm() < 1e-12);
}

/// `W(τ) = min (U + Σ τ ℓ)` has the gradient `ℓ`, so that `∂ℓᵢ/∂τⱼ` is symmetric, as long as the loads
/// have an energy: dead moments have none.
#[test]
fn lengths_answer_tensions_symmetrically() {
    let robot = with_sections(6, &[helix(20.0, 0.6), straight(200.0)]);
    let forces = Loads { tip_moment: Vec3::ZERO, points: Vec::new(), ..several_loads() };
    for loads in [Loads::default(), forces] {
        let length = |tensions: [f64; 2], cable: usize| {
            let case = Case { loads: loads.clone(), ..Case::with_tensions(&tensions) };
            solve(&robot, &case).cables[cable].length
        };
        let h = 1e-3;
        let by_second = (length([3.0, 1.5 + h], 0) - length([3.0, 1.5 - h], 0)) / (2.0 * h);
        let by_first = (length([3.0 + h, 1.5], 1) - length([3.0 - h, 1.5], 1)) / (2.0 * h);
        assert!((by_first - by_second).abs() < 1e-4 * by_first.abs(), "{by_first} {by_second}");
    }
}

/// One cable that is to be shorter while the one opposite keeps its length: no cable is at its own limit,
/// and none is said to be.
#[test]
fn lengths_that_contradict_are_named_with_what_each_misses() {
    let routings = [straight(0.0), straight(90.0), straight(180.0)];
    let mut backbone = paper_backbone();
    backbone.extensible = false;
    let cable = |(i, routing): (usize, &Routing)| Cable::new(format!("c{i}"), routing.clone());
    let cables = routings.iter().enumerate().map(cable).collect();
    let robot = Robot::new(backbone, paper_disks(), cables).unwrap();
    let shorter = [0.005, 0.0, 0.0].map(Shortening::Length);
    let refused = Model::CosseratDisks(accurate())
        .solve(&robot, &Case::with_shortenings(&shorter))
        .unwrap_err();
    let SolveError::ContradictoryLengths { misses } = refused else { panic!("{refused}") };
    let named: Vec<&str> = misses.iter().map(|miss| miss.cable.as_str()).collect();
    assert_eq!(named, ["c0", "c2"]);
    // Straight cables opposite each other miss half the difference each, however the rod bends.
    assert!(misses.iter().all(|miss| (miss.excess - 0.0025).abs() < 1e-4), "{misses:?}");
}

/// Two cables that both get shorter press the rod together, here beyond the load at which its spans buckle,
/// `π² EI/ℓ² = 108 N` between disks that the cables hold upright: the straight spans are then an equilibrium that
/// is not stable. Half the sum of the shortenings is axial strain: `(τ₁ + τ₂) L/EA`.
#[test]
fn antagonists_press_the_rod_beyond_its_buckling() {
    let robot = paper_robot(vec![straight(0.0), straight(180.0)]);
    for (shorter, stable) in [([0.001, 0.0016], true), ([0.005, 0.008], false)] {
        let case = Case::with_shortenings(&shorter.map(Shortening::Length));
        let options = Options { accuracy: Accuracy::Steps(144), ..accurate() };
        let solution = Model::CosseratDisks(options).solve(&robot, &case).unwrap();
        assert_eq!(solution.diagnostics.stable == Some(true), stable, "{shorter:?}");
        let pressed: f64 = solution.cables.iter().map(|cable| cable.tension.unwrap()).sum();
        let area = core::f64::consts::PI * 0.003 * 0.003 / 4.0;
        let strain = 0.5 * (shorter[0] + shorter[1]) / 0.18;
        assert!((pressed / (1.1e9 * area * strain) - 1.0).abs() < 5e-3, "{pressed}");
        for (cable, shorter) in solution.cables.iter().zip(shorter) {
            assert!((cable.initial_length - cable.length - shorter).abs() < 1e-9);
        }
    }
}

/// Three cables that are locked hold the tip upright while the load moves it sideways, 90 mm here. Chords
/// across spans that bend are shorter than the arcs, so that with few disks the cables are less taut, by the
/// square of the distance of the disks: with ten of them one gets slack.
#[test]
fn locked_cables_under_load_tend_to_the_continuous_ones_with_order_two() {
    let robot = |sections: usize| {
        let cable = |k: u32| Cable::new(format!("c{k}"), straight(120.0 * f64::from(k)));
        let disks = Disks::equally_spaced(0.18, sections + 1, 0.008);
        Robot::new(paper_backbone(), disks, [0, 1, 2].map(cable).to_vec()).unwrap()
    };
    let loads = Loads { tip_force: Vec3::new(0.3, 0.2, -1.0), ..Loads::default() };
    let locked = Case::with_shortenings(&[Shortening::Length(5e-4); 3]);
    let case = Case { loads, ..locked };
    let tensions = |solution: &Solution| -> Vec<f64> {
        solution.cables.iter().map(|cable| cable.tension.unwrap()).collect()
    };
    let continuous = Model::new(ModelKind::Cosserat, Default::default(), Default::default())
        .with_tolerance(ACCURATE)
        .solve(&robot(9), &case)
        .unwrap();
    let continuous = tensions(&continuous);
    let error = |sections: usize| {
        let now = tensions(&solve(&robot(sections), &case));
        now.iter().zip(&continuous).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let errors = [18, 36, 72].map(error);
    for pair in errors.windows(2) {
        assert!((1.9..2.2).contains(&(pair[0] / pair[1]).log2()), "{errors:?}");
    }
    let few = tensions(&solve(&robot(9), &case));
    assert!(few[0] == 0.0 && few[1] > 0.0 && few[2] > 0.0, "{few:?}");
}

/// Spans that are like another one are solved with it; a rod that tapers by a billionth has none.
#[test]
fn spans_that_are_alike_are_answered_as_any_are() {
    let uniform = paper_robot(vec![
        Routing::holes(vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1]),
        Routing::holes(vec![6, 7, 8, 9, 9, 9, 9, 8, 7, 6]),
    ]);
    let diameters = (0..10).map(|disk| 0.003 * (1.0 - 1e-10 * f64::from(disk))).collect();
    let (outer, inner) = (Along::PerDisk(diameters), Along::Uniform(0.0));
    let section = Some(Section::Round { outer, inner });
    let backbone = Backbone { section, ..uniform.backbone().clone() };
    let tapered = Robot::new(backbone, uniform.disks().clone(), uniform.cables().to_vec()).unwrap();
    let by_length = [0.04, 0.02].map(Shortening::Fraction);
    for case in [Case::with_tensions(&[4.0, 1.5]), Case::with_shortenings(&by_length)] {
        let [one, other] = [&uniform, &tapered].map(|robot| solve(robot, &case));
        for (a, b) in one.shape.poses.iter().zip(&other.shape.poses) {
            assert!((a.position - b.position).norm() < 1e-9, "{a:?} {b:?}");
        }
        for (a, b) in one.cables.iter().zip(&other.cables) {
            assert!((a.length - b.length).abs() < 1e-9);
            assert!((a.tension.unwrap() - b.tension.unwrap()).abs() < 1e-6);
        }
    }
}
