//! Motions with published or closed-form results.

use core::f64::consts::FRAC_PI_2;

use whipcord::{Case, Loads, PointMass, Vec3};
use whipcord_motion::{Commands, Damping, Initial, LoadCourse, Method, MotionOptions, Simulation};

use super::robots::{rod, straight};

/// A steel rod from which 0.02 kg hang, let go: tip x at 0.1 … 0.5 s by a converged solution of another program.
#[test]
fn a_cantilever_that_is_let_go() {
    let robot = rod(0.5, 2e-3, 200e9, 0.25, 8000.0, vec![]);
    let down = Vec3::new(-9.81, 0.0, 0.0);
    let case = Case { loads: Loads { gravity: Some(down), ..Loads::default() }, ..Case::default() };
    let weight = Loads { tip_force: down * 0.02, ..Loads::default() };
    let release = whipcord_motion::Course::table(vec![0.0, 0.0], vec![1.0, 0.0]).unwrap();
    let expected = [0.03527, -0.04954, 0.01052, -0.01680, -0.02637];
    for (dt, elements, limit) in
        [(1e-4, 20, 1e-5), (1e-3, 10, 5e-5), (5e-3, 6, 3e-4), (1e-2, 6, 1.2e-3)]
    {
        let options = MotionOptions {
            loads: vec![LoadCourse { loads: weight.clone(), factor: release.clone() }],
            elements,
            ..MotionOptions::default()
        };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let commands = Commands::default();
        for (k, expected) in expected.iter().enumerate() {
            let steps = (0.1_f64 / dt).round() as usize;
            for _ in 0..steps {
                simulation.step(&commands, dt).unwrap();
            }
            let x = simulation.state().tip().position.x;
            assert!(
                (x - expected).abs() < limit,
                "dt {dt}, {} s: {x} {expected}",
                0.1 * (k + 1) as f64
            );
        }
    }
}

/// Two tendons of 1 N on an upright rubber rod, from rest straight up: tip z at 1, 2 and 3 s by a converged solution of another program.
#[test]
fn a_robot_with_two_tendons() {
    let cables = vec![straight("a", core::f64::consts::PI, 0.02), straight("b", FRAC_PI_2, 0.02)];
    let robot = rod(0.6, 0.06, 1e6, 0.5, 1000.0, cables);
    let gravity = Some(Vec3::new(0.0, 0.0, -9.81));
    let case =
        Case { loads: Loads { gravity, ..Loads::default() }, ..Case::with_tensions(&[1.0, 1.0]) };
    let options = MotionOptions {
        damping: Damping::Time(0.03),
        initial: Initial::Rest,
        ..MotionOptions::default()
    };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let commands = Commands::of_case(&robot, &case);
    for expected in [0.5898, 0.3028, 0.3809] {
        for _ in 0..100 {
            simulation.step(&commands, 0.01).unwrap();
        }
        let z = simulation.state().tip().position.z;
        assert!((z - expected).abs() < 1e-3, "{z} {expected}");
    }
}

/// What the whole robot gains in momentum is what gravity and the base have given: the reaction of the base follows from the strain there.
#[test]
fn a_payload_moves_as_a_pendulum_on_a_stiff_rod() {
    let robot = rod(0.3, 6e-3, 200e9, 0.3, 7800.0, vec![]);
    let masses = vec![PointMass { at: 0.3, mass: 5.0 }];
    let loads = Loads { masses, tip_force: Vec3::new(1.0, 0.0, 0.0), ..Loads::default() };
    let case = Case { loads, ..Case::default() };
    let options = MotionOptions {
        initial: Initial::Rest,
        method: Method::Accurate,
        ..MotionOptions::default()
    };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let commands = Commands::default();
    // A mass on a spring k = 3EI/L³ under a constant force: x = F/k (1 − cos ωt).
    let inertia = core::f64::consts::PI * 3e-3_f64.powi(4) / 4.0;
    let k = 3.0 * 200e9 * inertia / 0.3_f64.powi(3);
    let backbone = 7800.0 * core::f64::consts::PI * 9e-6 * 0.3;
    let omega = (k / (5.0 + 33.0 / 140.0 * backbone)).sqrt();
    for _ in 0..200 {
        simulation.step(&commands, 1e-3).unwrap();
        let (t, x) = (simulation.state().time, simulation.state().tip().position.x);
        let expected = 1.0 / k * (1.0 - (omega * t).cos());
        assert!((x - expected).abs() < 0.01 / k, "{t}: {x:e} {expected:e}");
    }
}
