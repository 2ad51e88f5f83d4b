//! The Cosserat model against closed forms and against the numbers the project started from.

use whipcord::cosserat::Options;
use whipcord::{
    Backbone, Cable, Case, Disks, Material, Model, Robot, Routing, Section, Solution, Statics, Vec3,
};

fn backbone(length: f64, diameter: f64, young: f64, poisson: f64) -> Backbone {
    Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(poisson),
            ..Material::default()
        },
        ..Backbone::new(length)
    }
}

fn paper_robot(holes: &[usize]) -> Robot {
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let cable = Cable::new("pull", Routing::holes(holes.to_vec()));
    Robot::new(backbone(0.18, 0.003, 1.1e9, 0.3), disks, vec![cable]).unwrap()
}

fn solve(robot: &Robot, case: &Case) -> Solution {
    Model::Cosserat(Options::default()).solve(robot, case).unwrap()
}

/// Tips of the paper's four cases, in mm, for 0.4 kg on the cable at 9.81 m/s² and a backbone of
/// 3 mm: computed by shooting on the paper's eq. (3), printed to 0.01 mm.
#[test]
fn tips_of_the_four_cases_of_the_paper() {
    let cases: [(&[usize], [f64; 3]); 4] = [
        (&[4; 10], [0.0, 100.92, 133.88]),
        (&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10], [12.73, 58.45, 162.99]),
        (&[1, 2, 3, 4, 4, 4, 4, 3, 2, 1], [46.83, 76.70, 143.35]),
        (&[10, 10, 10, 10, 10, 10, 11, 12, 1, 2], [11.39, -96.64, 138.89]),
    ];
    for (holes, tip) in cases {
        let solution = solve(&paper_robot(holes), &Case::with_tensions(&[0.4 * 9.81]));
        let error = solution.disks.tip().position * 1e3 - Vec3::from(tip);
        assert!(error.max_abs() < 0.00501, "{holes:?}: {error:?}");
    }
}
