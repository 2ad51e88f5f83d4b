//! Loads so strong that a shot from the base misses the tip by many orders of magnitude.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use whipcord::cosserat::Options;
use whipcord::{
    Backbone, Case, Disks, Loads, Material, Model, Robot, Section, Solution, Statics, Vec3,
};

fn cantilever(length: f64, diameter: f64) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            density: Some(1040.0),
            ..Material::default()
        },
        ..Backbone::new(length)
    };
    Robot::new(backbone, Disks::equally_spaced(length, 10, 0.008), vec![]).unwrap()
}

fn solve(robot: &Robot, loads: Loads) -> Solution {
    let case = Case { loads, ..Case::default() };
    Model::Cosserat(Options::default()).solve(robot, &case).unwrap()
}

/// `x/L` of the tip of the paper's backbone under a transverse tip force in N, by collocation
/// (SciPy's `solve_bvp`) on the stretched and sheared rod, continued in the load.
const TRANSVERSE: [(f64, f64); 3] = [(10.0, 0.933), (30.0, 0.965), (100.0, 0.992)];

#[test]
fn a_strong_transverse_force_pulls_the_rod_straight() {
    let robot = cantilever(0.18, 0.003);
    for (force, x) in TRANSVERSE {
        let loads = Loads { tip_force: Vec3::X * force, ..Loads::default() };
        let solution = solve(&robot, loads);
        let tip = solution.disks.tip().position / 0.18;
        assert!((tip.x - x).abs() < 1e-3, "{force} N: {}", tip.x);
        assert!(solution.diagnostics.stability.unwrap() > 0.0);
    }
}

/// The first integral of the rod under a dead force: without shear and stretch,
/// `½ u²·EI + F·t` is constant, and the curvature at the tip vanishes.
#[test]
fn the_base_moment_meets_the_first_integral_of_the_elastica() {
    // So slender that stretch and shear do not count.
    let robot = cantilever(0.18, 0.0003);
    let stiffness = 1.1e9 * core::f64::consts::PI * 0.0003_f64.powi(4) / 64.0;
    let euler = 2.467 * stiffness / (0.18 * 0.18);
    for force in [5.0, 50.0, 300.0] {
        let loads = Loads { tip_force: Vec3::X * force * euler, ..Loads::default() };
        let solution = solve(&robot, loads);
        let along_tip = solution.disks.tip().rotation.rotate(Vec3::Z).x;
        let moment = solution.base_wrench.unwrap().moment.norm();
        let exact = (2.0 * stiffness * force * euler * along_tip).sqrt();
        assert!((moment / exact - 1.0).abs() < 1e-4, "{force}: {moment} {exact}");
    }
}

#[test]
fn a_long_thread_hangs_down() {
    // 3 m of a rod of 0.5 mm under its own weight: 5000 times the weight that bends it by a radian.
    let robot = cantilever(3.0, 0.0005);
    let loads = Loads { gravity: Some(Vec3::X * 9.81), ..Loads::default() };
    let solution = solve(&robot, loads);
    let tip = solution.disks.tip().position;
    assert!(tip.x > 2.97 && tip.x < 3.0 && tip.z > 0.0 && tip.z < 0.1, "{tip:?}");
    assert!(solution.diagnostics.stability.unwrap() > 0.0);
    let weight = 1040.0 * 9.81 * 3.0 * core::f64::consts::PI * 0.0005_f64.powi(2) / 4.0;
    assert!((solution.base_wrench.unwrap().force.x / weight - 1.0).abs() < 1e-12);
}
