//! Orders of the methods in time and space, and what a tolerance reaches.

use whipcord::{Case, Loads, Motor, Vec3};
use whipcord_motion::{CableDrive, Commands, Course, Damping, Method, MotionOptions, Simulation};

use super::robots::{helix, paper};

/// A pull of 3 N within 0.1 s, which begins smoothly.
fn commands() -> Commands {
    let times: Vec<f64> = (0..=10_000).map(|k| 1e-5 * f64::from(k)).collect();
    let smooth = |t: &f64| 3.0 * (core::f64::consts::PI * t / 0.2).sin().powi(6);
    let values = times.iter().map(smooth).collect();
    Commands::new(vec![CableDrive::Tension(Course::table(times, values).unwrap())])
}

/// The tip after 0.1 s, when the robot moves fastest.
fn tip(options: &MotionOptions, dt: f64) -> Vec3 {
    let robot = paper(vec![helix()]);
    let gravity = Some(Vec3::new(9.81, 0.0, 0.0));
    let case = Case { loads: Loads { gravity, ..Loads::default() }, ..Case::with_tensions(&[0.0]) };
    let options = MotionOptions { damping: Damping::Time(3.5e-3), ..options.clone() };
    let mut simulation = Simulation::with_commands(&robot, &case, &commands(), options).unwrap();
    for _ in 0..(0.1_f64 / dt).round() as usize {
        simulation.step(&commands(), dt).unwrap();
    }
    simulation.state().tip().position
}

#[test]
fn each_method_has_its_order_in_time() {
    let with =
        |method| MotionOptions { method, iteration_tolerance: 1e-12, ..MotionOptions::default() };
    let exact = tip(&with(Method::Accurate), 2.5e-4);
    for (method, order, dt, limit) in [
        (Method::Accurate, 4.0, 1e-2, 1e-5),
        (Method::Energy, 2.0, 4e-3, 1e-3),
        (Method::Robust, 2.0, 4e-3, 1e-3),
    ] {
        let error = |dt: f64| (tip(&with(method), dt) - exact).norm();
        let (coarse, fine) = (error(dt), error(0.5 * dt));
        let got = (coarse / fine).log2();
        println!("{method:?} {dt}: {coarse:.1e} {fine:.1e}, order {got:.2}");
        assert!(
            got > order - 0.5 && coarse < limit,
            "{method:?}: {coarse:e} {fine:e}, order {got}"
        );
    }
}

/// Tip and tension after 0.1 s of a cable that is wound up by 6 mm through a drive of this stiffness in N/m, within 0.2 s.
fn wound_up(stiffness: f64, dt: f64) -> (Vec3, f64) {
    let motor = Motor { stiffness: Some(stiffness), ..Motor::linear("drive", [(0, 1.0)]) };
    let robot = paper(vec![helix()]).with_motors(vec![motor]).unwrap();
    let times: Vec<f64> = (0..=10_000).map(|k| 2e-5 * f64::from(k)).collect();
    let smooth = |t: &f64| 6e-3 * (core::f64::consts::PI * t / 0.4).sin().powi(4);
    let course = Course::table(times.clone(), times.iter().map(smooth).collect()).unwrap();
    let commands = Commands { motors: vec![Some(course)], ..Commands::tensions(&[0.0]) };
    let options = MotionOptions {
        damping: Damping::Time(3.5e-3),
        iteration_tolerance: 1e-12,
        ..MotionOptions::default()
    };
    let case = Case::with_tensions(&[0.0]);
    let mut simulation = Simulation::with_commands(&robot, &case, &commands, options).unwrap();
    for _ in 0..(0.1_f64 / dt).round() as usize {
        simulation.step(&commands, dt).unwrap();
    }
    let state = simulation.state();
    (state.tip().position, state.cables[0].tension)
}

/// Cables by length, of soft and of stiff drives, tip and tension: order 2.
#[test]
fn cables_by_length_have_order_two() {
    for stiffness in [300.0, 1e4] {
        let (exact, tension) = wound_up(stiffness, 5e-5);
        let error = |dt: f64| {
            let (tip, of) = wound_up(stiffness, dt);
            ((tip - exact).norm(), (of - tension).abs() / tension)
        };
        let (coarse, fine) = (error(2e-3), error(1e-3));
        let orders = [(coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2()];
        println!("{stiffness} N/m: {:.1e} {:.1e}, orders {orders:.2?}", fine.0, fine.1);
        assert!(orders.iter().all(|order| *order > 1.6), "{coarse:?} {fine:?} {orders:?}");
        assert!(fine.0 < 1e-4 && fine.1 < 1e-2, "{fine:?}");
    }
}

/// In space the error falls as the fourth power of the length of an element.
#[test]
fn the_order_in_space() {
    let with = |elements| MotionOptions { elements, ..MotionOptions::default() };
    let exact = tip(&with(40), 2e-3);
    let error = |elements: usize| (tip(&with(elements), 2e-3) - exact).norm();
    let (coarse, fine) = (error(5), error(10));
    let got = (coarse / fine).log2();
    println!("5 elements {coarse:.1e}, 10 elements {fine:.1e}, order {got:.2}");
    assert!(got > 3.0 && coarse < 2e-5, "{coarse:e} {fine:e}, order {got}");
}

/// The tolerance bounds what the steps add, also where each is divided.
#[test]
fn a_tolerance_is_met() {
    let exact = tip(&MotionOptions::default(), 2.5e-4);
    for method in [Method::Accurate, Method::Energy, Method::Robust] {
        let mut errors = Vec::new();
        for tolerance in [1e-4, 1e-6] {
            let options =
                MotionOptions { method, tolerance: Some(tolerance), ..MotionOptions::default() };
            let error = (tip(&options, 2e-2) - exact).norm();
            // Five steps, each with its tolerance.
            assert!(error < 5.0 * tolerance, "{method:?} {tolerance:e}: {error:e}");
            errors.push(error);
        }
        assert!(errors[1] < 0.3 * errors[0]);
    }
}
