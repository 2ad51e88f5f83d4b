//! At the ends of what quantities may be, an answer is finite or a reason.

use whipcord::robot::limits::{LENGTH, MODULUS, TENSION};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Material, Model, ModelKind, Robot,
    Routing, Section, Shortening, Solution, Statics as _, Stations,
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
