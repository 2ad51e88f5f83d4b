//! At the ends of what quantities may be, an answer is finite or a reason.

use whipcord::robot::limits::{LENGTH, MODULUS, MOST_STATIONS, MOST_STEPS, TENSION};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Material, Model, ModelKind, Problem,
    Robot, Routing, Section, Shortening, Solution, SolveError, Statics as _, Stations,
};

fn is_finite(solution: &Solution) -> bool {
    let poses = solution.shape.poses.iter().chain(&solution.disks.poses);
    poses
        .map(|p| (p.position, p.rotation.wxyz()))
        .all(|(position, rotation)| position.is_finite() && rotation.iter().all(|x| x.is_finite()))
        && solution.cables.iter().all(|cable| {
            cable.length.is_finite()
                && cable.initial_length.is_finite()
                && cable.tension.is_none_or(f64::is_finite)
        })
        && solution.diagnostics.residual.is_finite()
}

/// Both ends and a usual value of each quantity, all combinations.
#[test]
fn nothing_overflows() {
    let lengths = [LENGTH.least, 0.18, LENGTH.greatest];
    let mut answers = 0;
    for length in lengths {
        for radius in lengths {
            for diameter in lengths {
                for young in [MODULUS.least, 1e9, MODULUS.greatest] {
                    for tension in [1e-300, 1.0, TENSION.greatest] {
                        answers += solve(length, radius, diameter, young, tension);
                    }
                }
            }
        }
    }
    assert!(answers > 100, "{answers}");
}

fn solve(length: f64, radius: f64, diameter: f64, young: f64, tension: f64) -> usize {
    let backbone = Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(length)
    };
    let disks = Disks::equally_spaced(length, 4, radius).with_holes(12);
    let routings = [Routing::holes(vec![1, 2, 3, 4]), Routing::Straight { angle: 1.0, radius }];
    let mut answers = 0;
    for routing in routings {
        let robot =
            Robot::new(backbone.clone(), disks.clone(), vec![Cable::new("a", routing)]).unwrap();
        let command =
            CableCommand { tension: Some(tension), shortening: Some(Shortening::Fraction(0.05)) };
        let case = Case { commands: vec![command], ..Case::default() };
        for kind in ModelKind::ALL {
            let said = Model::new(kind, Stations::Disks, Actuation::Natural).solve(&robot, &case);
            let given = format!(
                "{kind}: length {length:e}, radius {radius:e}, diameter {diameter:e}, E {young:e}, tension {tension:e}"
            );
            match said {
                Ok(solution) => {
                    assert!(is_finite(&solution), "{given}: {solution:?}");
                    answers += 1;
                }
                Err(error) => assert!(!error.to_string().contains("NaN"), "{given}: {error}"),
            }
        }
    }
    answers
}

/// Numbers of stations and steps that no computer holds are refused, and the greatest that are taken are answered.
#[test]
fn as_many_stations_and_steps_as_a_computer_holds() {
    let robot = strip();
    let refused = |outcome: Result<Solution, SolveError>, path: &str| {
        let Err(SolveError::Invalid(error)) = outcome else { panic!("{path}: {outcome:?}") };
        assert!(error.to_string().starts_with(&format!("`{path}`")), "{error}");
        assert!(matches!(error.problem, Problem::TooGreat { .. }), "{error}");
    };
    for kind in ModelKind::ALL {
        let case = match kind.natural_actuation() {
            Actuation::Shortening => Case::with_shortenings(&[Shortening::Length(0.003)]),
            _ => Case::with_tensions(&[1.0]),
        };
        let at = |count| Model::new(kind, Stations::Equal(count), Actuation::Natural);
        for count in [MOST_STATIONS + 1, usize::MAX] {
            refused(at(count).solve(&robot, &case), "stations");
        }
        let many = at(20_000).solve(&robot, &case).unwrap();
        assert_eq!(many.shape.poses.len(), 20_000, "{kind}");
        if matches!(kind, ModelKind::Cosserat | ModelKind::CosseratDisks) {
            for steps in [MOST_STEPS + 1, usize::MAX] {
                refused(at(2).with_steps(steps).solve(&robot, &case), "steps");
            }
            let fine = at(2).with_steps(20_000).solve(&robot, &case).unwrap();
            let apart = fine.shape.tip().position - many.shape.tip().position;
            assert!(apart.norm() < 1e-6 * robot.backbone().length, "{kind}: {apart:?}");
        }
    }
}

fn strip() -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.001)),
        material: Material {
            young_modulus: Some(6e10),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(0.2)
    };
    let cable = Cable::new("a", Routing::Straight { angle: 1.0, radius: 0.005 });
    Robot::new(backbone, Disks::equally_spaced(0.2, 6, 0.006), vec![cable]).unwrap()
}
