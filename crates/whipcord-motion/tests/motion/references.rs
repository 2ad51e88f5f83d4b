//! Motions with published or closed-form results.

use core::f64::consts::FRAC_PI_2;

use whipcord::{Backbone, Case, Disks, Loads, PointMass, Robot, Stiffness, Vec3};
use whipcord_motion::{
    BaseMotion, Commands, Course, Damping, Initial, LoadCourse, Method, MotionOptions, Simulation,
};

use super::robots::{rod, straight};

/// A steel rod from which 0.02 kg hang, let go: tip x at 0.1 … 0.5 s by a converged solution of another program.
#[test]
fn a_cantilever_that_is_let_go() {
    let robot = rod(0.5, 2e-3, 200e9, 0.25, 8000.0, vec![]);
    let down = Vec3::new(-9.81, 0.0, 0.0);
    let case = Case { loads: Loads { gravity: Some(down), ..Loads::default() }, ..Case::default() };
    let weight = Loads { tip_force: down * 0.02, ..Loads::default() };
    let release = Course::table(vec![0.0, 0.0], vec![1.0, 0.0]).unwrap();
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

/// A flexible beam whose base is turned up to 6 rad/s within 15 s (Simo and Vu-Quoc, *On the dynamics of flexible beams under large overall motions*, J. Appl. Mech. 53,
/// 1986): greatest deflection 0.5738 at 6.76 s, and an extension of ρAω²L³/3EA when it turns steadily.
#[test]
fn spin_up_of_a_flexible_beam() {
    use core::f64::consts::TAU;
    let backbone = Backbone {
        stiffness: Some(Stiffness::diagonal([1e7, 1e7], 2.8e7, [1.4e4, 1.4e4], 1e4)),
        linear_density: Some(1.2.into()),
        ..Backbone::new(10.0)
    };
    let robot = Robot::new(backbone, Disks::none(10.0), vec![]).unwrap();
    let times: Vec<f64> = (0..=3000).map(|k| 0.005 * f64::from(k)).collect();
    let rate = |t: &f64| 6.0 / 15.0 * (t - 15.0 / TAU * (TAU * t / 15.0).sin());
    let rates = times.iter().map(rate).collect();
    let mut base = BaseMotion::default();
    base.angular_velocity[1] = Course::table(times, rates).unwrap();
    let options = MotionOptions { base: Some(base), elements: 8, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &Case::default(), options).unwrap();
    let (mut greatest, mut at) = (0.0, 0.0);
    let (mut extension, mut count) = (0.0, 0);
    for _ in 0..600 {
        let state = simulation.step(&Commands::default(), 0.04).unwrap();
        let tip = (state.poses[0].inverse() * state.tip()).position;
        if tip.x.abs() > greatest {
            (greatest, at) = (tip.x.abs(), state.time);
        }
        if state.time > 16.0 {
            extension += tip.z - 10.0;
            count += 1;
        }
        assert!(state.energy.defect().abs() < 1e-3 * state.energy.base.abs().max(1.0));
    }
    // The base has turned by 45 rad in 15 s, and by 6 rad/s since.
    let turned = simulation.state().poses[0].rotation.log().y;
    let expected = 45.0 + 6.0 * (simulation.state().time - 15.0);
    let difference = (turned - expected) / TAU;
    assert!((difference - difference.round()).abs() < 1e-5, "{turned} {expected}");
    assert!((greatest - 0.5738).abs() < 1e-3 && (at - 6.76).abs() < 0.05, "{greatest} at {at}");
    assert!(
        (extension / f64::from(count) - 5.143e-4).abs() < 5e-6,
        "{:e}",
        extension / f64::from(count)
    );
}

/// In a base that falls freely a robot moves as without gravity.
#[test]
fn a_falling_base_takes_the_weight_away() {
    let robot = rod(0.3, 4e-3, 1e9, 0.3, 1200.0, vec![straight("a", 0.5, 0.01)]);
    let tip = |falls: bool| {
        let gravity = falls.then_some(Vec3::new(-9.81, 0.0, 0.0));
        let mut base = BaseMotion::default();
        if falls {
            base.velocity[0] = Course::table(vec![0.0, 10.0], vec![0.0, -98.1]).unwrap();
        }
        let options = MotionOptions {
            base: Some(base),
            initial: Initial::Rest,
            damping: Damping::Time(1e-3),
            ..MotionOptions::default()
        };
        let case =
            Case { loads: Loads { gravity, ..Loads::default() }, ..Case::with_tensions(&[0.5]) };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        for _ in 0..40 {
            simulation.step(&Commands::tensions(&[1.0]), 5e-3).unwrap();
        }
        let state = simulation.state();
        let defect = state.energy.defect().abs();
        assert!(defect < 0.05 * state.energy.dissipated, "{defect:e} {:?}", state.energy);
        (state.poses[0].inverse() * state.tip()).position
    };
    let (falling, still) = (tip(true), tip(false));
    assert!((falling - still).norm() < 1e-6, "{falling:?} {still:?}");
    assert!(still.norm() > 0.1);
}
