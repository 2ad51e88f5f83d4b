//! What a robot among obstacles may take: lengths, disks, time and memory.

use super::{among, sphere};
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::{
    Backbone, Cable, Case, Disks, Material, Obstruction, Problem, Robot, Routing, Section,
    SolveError, Vec3,
};

const YOUNG: f64 = 2e11;

/// The gripping finger of the examples, of another length and with other disks.
fn strip(length: f64, sections: usize, thickness: f64) -> Result<Robot, whipcord::RobotError> {
    let material =
        Material { young_modulus: Some(YOUNG), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::rectangle(0.0003, 0.008));
    let backbone = Backbone { material, section, ..Backbone::new(length) };
    let disks = Disks {
        outer_radius: Some(0.008),
        thickness: Some(thickness),
        ..Disks::equally_spaced(length, sections + 1, 0.006)
    };
    let cable = Cable::new("flexor", Routing::Straight { angle: 0.0, radius: 0.006 });
    Robot::new(backbone, disks, vec![cable])
}

fn solve(robot: &Robot, case: &Case) -> Result<whipcord::Solution, SolveError> {
    Cosserat::new(robot, &case.loads, &Options::default())?.solve(
        case,
        None,
        &mut Workspace::default(),
    )
}

/// For 69 of these lengths `length * 80 / 80` lies beyond the tip by rounding.
#[test]
fn every_length_in_whole_millimetres_has_an_answer() {
    let far = sphere(Vec3::new(3.0, 0.0, 0.0), 0.01);
    let case = among(Case::with_tensions(&[0.01]), vec![far]);
    for millimetres in 20..=500 {
        let length = 1e-3 * f64::from(millimetres);
        for length in [length, f64::from(millimetres) / 1000.0] {
            let robot = strip(length, 2, 0.002).unwrap();
            let solution = solve(&robot, &case).unwrap_or_else(|error| panic!("{length}: {error}"));
            assert_eq!(solution.shape.arc_length.last(), Some(&length));
        }
    }
}

/// Positions in millimetres may lie beyond the tip by rounding.
#[test]
fn the_last_disk_sits_at_the_tip() {
    let beyond = 0.11 * (1.0 + 2e-16);
    assert!(beyond > 0.11);
    let disks = Disks {
        arc_lengths: vec![0.0, 0.05, beyond],
        outer_radius: Some(0.008),
        ..Disks::equally_spaced(0.11, 3, 0.006)
    };
    let robot = strip(0.11, 2, 0.002).unwrap();
    let robot = Robot::new(robot.backbone().clone(), disks, robot.cables().to_vec()).unwrap();
    assert_eq!(robot.disks().arc_lengths, [0.0, 0.05, 0.11]);
    let far = sphere(Vec3::new(3.0, 0.0, 0.0), 0.01);
    solve(&robot, &among(Case::with_tensions(&[0.01]), vec![far])).unwrap();
}

#[test]
fn disks_thicker_than_their_spacing_or_than_wide_are_refused() {
    let refused = |sections, thickness| strip(0.12, sections, thickness).unwrap_err();
    for thickness in [0.0101, 0.18, 1e5] {
        let error = refused(12, thickness);
        assert_eq!(error.path, "disks.thickness");
        let Problem::ThickerThanSpacing { thickness: given, spacing, first: 0 } = error.problem
        else {
            panic!("{error}")
        };
        assert!(given == thickness && (spacing - 0.01).abs() < 1e-15);
    }
    let error = refused(3, 0.0161);
    let Problem::ThickerThanWide { radius: 0.008, disk: 0, .. } = error.problem else {
        panic!("{error}")
    };
    // Disks that touch one another or are balls are possible.
    assert!(strip(0.12, 12, 0.01).is_ok());
    assert!(strip(0.12, 3, 0.016).is_ok());
}

/// A disk as thick as wide is a ball: it touches an obstacle in one place. It used to be found anew in each
/// iteration, until memory was full.
#[test]
fn a_disk_that_is_a_ball_touches_once() {
    let robot = strip(0.12, 4, 0.016).unwrap();
    // Beside the tip, which the cable bends towards +x.
    let ball = sphere(Vec3::new(0.03, 0.0, 0.115), 0.015);
    let solution = solve(&robot, &among(Case::with_tensions(&[2.0]), vec![ball])).unwrap();
    let contacts = solution.contacts;
    assert_eq!(contacts.len(), 1, "{contacts:?}");
    let centre = solution.disks.poses.last().unwrap().position;
    let apart = (centre - Vec3::new(0.03, 0.0, 0.115)).norm();
    assert!((apart - 0.023).abs() < 1e-7, "{apart}");
}

/// Two metres of the strip curl up 13 times and press ever more disks against the ball: it ends with the reason.
#[test]
fn a_robot_that_curls_up_ends_within_its_budget() {
    let ball = sphere(Vec3::new(0.031, 0.0, 0.030), 0.022);
    let case = among(Case::with_tensions(&[24.0]), vec![ball]);
    match solve(&strip(2.0, 12, 0.002).unwrap(), &case) {
        Ok(solution) => assert!(!solution.contacts.is_empty()),
        Err(SolveError::Obstructed { reached, why, .. }) => {
            assert!((0.0..1.0).contains(&reached));
            match why {
                // An iteration of a rod in 80 steps or more costs 0.8 at least, of the 4000 that a solve may spend.
                Obstruction::BudgetSpent { iterations, contacts, residual } => {
                    assert!((100..=5001).contains(&iterations), "{iterations}");
                    assert!(contacts > 12 && residual.is_finite(), "{contacts} {residual}");
                }
                Obstruction::NotConverged { residual } => assert!(residual.is_finite()),
                _ => panic!("{why}"),
            }
        }
        Err(other) => panic!("{other}"),
    }
}
