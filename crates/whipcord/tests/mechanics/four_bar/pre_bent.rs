//! Backbones that are bent and twisted before actuation.

use proptest::prelude::*;
use whipcord::four_bar::{Chord, Objective, Options};
use whipcord::{
    Actuation, Backbone, Case, Model, ModelKind, RestCurvature, Robot, Routing, Shortening,
    Statics, Stations, Vec3,
};

use super::oracle::{self, Section};
use super::{equal_disks, robot, solve, try_solve};

/// The robot with this curvature at rest.
pub fn bent(robot: &Robot, rest_curvature: RestCurvature) -> Robot {
    let backbone = Backbone { rest_curvature, ..robot.backbone().clone() };
    Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_section_is_the_least_that_a_search_finds(
        rest in [-0.6_f64..0.6, -0.6_f64..0.6, -0.4_f64..0.4],
        radius in [0.2_f64..0.6, 0.2_f64..0.6],
        start in -3.0_f64..3.0,
        turn in -0.6_f64..0.6,
        part in 0.05_f64..1.0,
        strain: bool,
        arc: bool,
    ) {
        let length = 0.02;
        let hole = |radius: f64, angle: f64| {
            Vec3::new(angle.cos(), angle.sin(), 0.0) * (radius * length)
        };
        let (from, to) = (hole(radius[0], start), hole(radius[1], start + turn));
        let routing = Routing::Linear { start: [from.x, from.y], end: [to.x, to.y] };
        let objective = if strain { Objective::StrainEnergy } else { Objective::CouplerAngle };
        let chord = if arc { Chord::Arc } else { Chord::Bisector };
        let rest = Vec3::from(rest);
        let section = Section { length, from, to, chord, objective, rest };
        let robot = bent(&robot(&[0.0, length], vec![routing]), (rest / length).into());
        let options = Options { objective, chord, ..Options::default() };
        let shortening = 0.1 * part * section.cable(rest);
        let solution = solve(&robot, &options, &[shortening]);
        let initial = solution.cables[0].initial_length;
        prop_assert!((initial - section.cable(rest)).abs() < 1e-14);
        let tip = solution.disks.tip();
        let w = tip.rotation.log();
        prop_assert!((oracle::pose(length, chord, w).position - tip.position).max_abs() < 1e-15);
        let target = initial - shortening;
        prop_assert!((section.cable(w) - target).abs() < 1e-12 * length);
        let least = section.least(target).unwrap();
        let found = section.measure(w);
        prop_assert!(found < least + 1e-8 * (1.0 + least), "{found} {least}");
    }
}

/// `sin(φ/2) = sin(φ*/2) + s/2a` in a section that a cable on the inner side bends further.
#[test]
fn a_cable_in_the_plane_bends_as_the_closed_form_says() {
    let (length, n, radius) = (0.18, 6, 0.008);
    let straight = robot(&equal_disks(length, n), vec![Routing::Straight { angle: 0.0, radius }]);
    let robot = bent(&straight, Vec3::new(0.0, 5.0, 0.0).into());
    let rest = 5.0 * length / n as f64;
    for (shortening, side) in [(0.004, 1.0), (0.0, 1.0)] {
        let solution = solve(&robot, &Options::default(), &[shortening]);
        let sine = (0.5 * rest).sin() + side * shortening / (2.0 * n as f64 * radius);
        let bend = solution.disks.tip().rotation.log();
        let expected = 2.0 * n as f64 * sine.asin();
        assert!((bend - Vec3::new(0.0, expected, 0.0)).norm() < 1e-10, "{bend:?} {expected}");
    }
}

/// At rest the disks are turned as the rod's cross-sections are, whatever its curvature; where that is uniform and
/// in one plane an arc is the rod itself.
#[test]
fn at_rest_it_is_the_rod() {
    let straight = robot(
        &equal_disks(0.18, 6),
        vec![Routing::Helix { start_angle: 0.3, turns: 0.4, radius: 0.008 }],
    );
    let varying = RestCurvature::At {
        arc_lengths: vec![0.02, 0.1, 0.1, 0.15],
        values: vec![
            Vec3::new(2.0, 5.0, 1.0),
            Vec3::new(-3.0, 4.0, 0.0),
            Vec3::new(6.0, 0.0, -4.0),
            Vec3::new(0.0, 1.0, 2.0),
        ],
    };
    let plane = RestCurvature::from(Vec3::new(3.0, 6.0, 0.0));
    for (curvature, same_places) in [(varying, false), (plane, true)] {
        let robot = bent(&straight, curvature);
        let rod = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Tension)
            .solve(&robot, &Case::with_tensions(&[0.0]))
            .unwrap();
        for objective in [Objective::CouplerAngle, Objective::StrainEnergy] {
            let options = Options { chord: Chord::Arc, objective, ..Options::default() };
            let solution = solve(&robot, &options, &[0.0]);
            for (a, b) in solution.disks.poses.iter().zip(&rod.disks.poses) {
                let apart = (a.rotation.conjugate() * b.rotation).log().norm();
                assert!(apart < 1e-9, "{apart}");
                if same_places {
                    assert!((a.position - b.position).norm() < 1e-10);
                }
            }
        }
    }
}

/// With many sections the strain-energy form tends to the rod that is driven by the same length, and to its
/// tension, with order 2: to one that neither stretches nor shears.
#[test]
fn with_many_sections_it_is_the_rod() {
    let routing = Routing::Helix { start_angle: 0.3, turns: 0.3, radius: 0.008 };
    let curvature = RestCurvature::from(Vec3::new(4.0, 3.0, 2.0));
    let options = Options {
        chord: Chord::Arc,
        objective: Objective::StrainEnergy,
        lengths: whipcord::four_bar::LengthRule::Free,
        ..Options::default()
    };
    let apart = |sections: usize| {
        let straight = robot(&equal_disks(0.18, sections), vec![routing.clone()]);
        let rigid = Backbone { extensible: false, shearable: false, ..straight.backbone().clone() };
        let rigid =
            Robot::new(rigid, straight.disks().clone(), straight.cables().to_vec()).unwrap();
        let robot = bent(&rigid, curvature.clone());
        let solution = solve(&robot, &options, &[0.006]);
        let case = Case::with_shortenings(&[Shortening::Length(0.006)]);
        let of_rod =
            whipcord::cosserat::Options { actuation: Actuation::Shortening, ..Default::default() };
        let rod = Model::Cosserat(of_rod).solve(&robot, &case).unwrap();
        let tip = (solution.disks.tip().position - rod.disks.tip().position).norm() / 0.18;
        let tension = solution.cables[0].tension.unwrap() / rod.cables[0].tension.unwrap() - 1.0;
        (tip, tension.abs())
    };
    let (coarse, fine) = (apart(20), apart(40));
    assert!(fine.0 < 5e-4 && fine.1 < 1e-3, "{fine:?}");
    for order in [(coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2()] {
        assert!((1.8..2.2).contains(&order), "{order}");
    }
}

#[test]
fn half_a_turn_in_a_section_is_refused() {
    let straight =
        robot(&equal_disks(0.18, 3), vec![Routing::Straight { angle: 0.0, radius: 0.008 }]);
    let half = core::f64::consts::PI / 0.06;
    for turns in [1.0, 2.05] {
        let robot = bent(&straight, Vec3::new(0.0, turns * half, 0.0).into());
        let error = try_solve(&robot, &Options::default(), &[0.0]).unwrap_err().to_string();
        assert!(error.contains("half a turn") && error.contains("more disks"), "{error}");
    }
}
