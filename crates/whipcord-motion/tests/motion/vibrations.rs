//! Natural vibrations and linearisation.

use core::f64::consts::PI;

use whipcord::{Case, Loads, PointMass, Vec3};
use whipcord_motion::{Commands, Damping, MotionOptions, Simulation};

use super::robots::{helix, paper, rod, straight};

/// Of a slender cantilever: ω = (βL)² √(EI/ρA)/L² with βL = 1.8751, 4.6941, 7.8548, twice each, and ω = π/2 √(G/ρ)/L of twist.
#[test]
fn frequencies_of_a_cantilever() {
    let (length, radius, young, density) = (0.5, 1e-3, 200e9, 8000.0);
    let robot = rod(length, 2.0 * radius, young, 0.25, density, vec![]);
    let time = 1e-5;
    let options =
        MotionOptions { elements: 12, damping: Damping::Time(time), ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &Case::default(), options).unwrap();
    let modes = simulation.modes(&Commands::default(), 6).unwrap();
    let bar = (young * PI * radius.powi(4) / 4.0 / (density * PI * radius * radius)).sqrt();
    for (k, beta) in
        [1.875_104_07, 1.875_104_07, 4.694_091_13, 4.694_091_13, 7.854_757_44, 7.854_757_44]
            .into_iter()
            .enumerate()
    {
        let exact = beta * beta * bar / (length * length);
        let got = modes[k].angular_frequency().unwrap();
        assert!((got / exact - 1.0).abs() < 2e-4, "{k}: {got} {exact}");
        // Damping proportional to the stiffness: ζ = ω time/2.
        assert!((modes[k].damping_ratio / (0.5 * got * time) - 1.0).abs() < 1e-6);
    }
}

/// A heavy mass on a light rod vibrates at √(k/m), and held cables stiffen a rod.
#[test]
fn a_mass_at_the_tip_and_held_cables() {
    let robot = rod(0.3, 6e-3, 200e9, 0.3, 1.0, vec![]);
    let loads = Loads { masses: vec![PointMass { at: 0.3, mass: 5.0 }], ..Loads::default() };
    let mut simulation =
        Simulation::new(&robot, &Case { loads, ..Case::default() }, MotionOptions::default())
            .unwrap();
    let modes = simulation.modes(&Commands::default(), 2).unwrap();
    let k = 3.0 * 200e9 * PI * 3e-3_f64.powi(4) / 4.0 / 0.3_f64.powi(3);
    assert!((modes[0].squared_frequency / (k / 5.0) - 1.0).abs() < 1e-3);

    // Cables that do not stretch keep the mean curvature in their plane zero: the tip does not turn, βL = 2.36502 instead of 1.87510.
    let cables = vec![straight("a", 0.0, 0.01), straight("b", PI, 0.01)];
    let robot = rod(0.5, 2e-3, 200e9, 0.25, 8000.0, cables);
    let tensions = [1e-3, 1e-3];
    let options = MotionOptions { elements: 12, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &Case::with_tensions(&tensions), options).unwrap();
    let free = simulation.modes(&Commands::tensions(&tensions), 2).unwrap();
    let held = simulation.modes(&Commands::shortenings(&[0.0, 0.0]), 2).unwrap();
    let [a, b] = [&free, &held].map(|modes| modes[0].squared_frequency);
    assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    let ratio = held[1].squared_frequency / free[1].squared_frequency;
    assert!((ratio / (2.365_020_37_f64 / 1.875_104_07).powi(4) - 1.0).abs() < 1e-3, "{ratio}");
}

/// A beam under its weight: the frequency of small vibrations that are computed step by step.
#[test]
fn vibrations_about_a_loaded_shape_are_those_of_the_motion() {
    let robot = paper(vec![helix()]);
    let gravity = Some(Vec3::new(9.81, 0.0, 0.0));
    let case = Case { loads: Loads { gravity, ..Loads::default() }, ..Case::with_tensions(&[3.0]) };
    let mut simulation = Simulation::new(&robot, &case, MotionOptions::default()).unwrap();
    let commands = Commands::tensions(&[3.0]);
    let mode = simulation.modes(&commands, 1).unwrap().remove(0);
    let omega = mode.angular_frequency().unwrap();
    let mut state = simulation.state().clone();
    for (velocity, shape) in state.velocities.iter_mut().zip(&mode.shape) {
        *velocity = *shape * 1e-4;
    }
    simulation.set_state(&state).unwrap();
    // The velocities are back after a period.
    let period = 2.0 * PI / omega;
    for _ in 0..400 {
        simulation.step(&commands, period / 400.0).unwrap();
    }
    let (start, end) =
        (state.velocities.last().unwrap(), simulation.state().velocities.last().unwrap());
    let change = (end.linear - start.linear).norm() / start.linear.norm();
    assert!(change < 2e-3, "{change:e}");
}

/// `A` and `B` predict how small changes of the state and of a tension go on, here in a motion with velocities.
#[test]
fn the_linearisation_predicts_small_changes() {
    let robot = paper(vec![helix()]);
    let gravity = Some(Vec3::new(9.81, 0.0, 0.0));
    let case = Case { loads: Loads { gravity, ..Loads::default() }, ..Case::with_tensions(&[0.0]) };
    let options = MotionOptions {
        elements: 2,
        damping: Damping::Time(2e-3),
        iteration_tolerance: 1e-12,
        ..MotionOptions::default()
    };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let commands = |tension| Commands::tensions(&[tension]);
    for _ in 0..10 {
        simulation.step(&commands(2.0), 5e-3).unwrap();
    }
    let state = simulation.state().clone();
    let linear = simulation.linearize().unwrap();
    assert_eq!(linear.states, 12 * (simulation.arc_lengths().len() - 1));
    // The step from the state by the linear model is that of the simulation: x(h) by the implicit midpoint rule in small parts.
    let flat = |state: &whipcord_motion::State| -> Vec<f64> {
        let twists = state.velocities[1..].iter().chain(&state.strains);
        twists.flat_map(|t| [t.linear.to_array(), t.angular.to_array()].concat()).collect()
    };
    let n = linear.states;
    let (h, parts, more) = (1e-3, 200, 1e-3);
    let go = |simulation: &mut Simulation, tension: f64| {
        simulation.set_state(&state).unwrap();
        for _ in 0..parts {
            simulation.step(&commands(tension), h / f64::from(parts)).unwrap();
        }
        flat(simulation.state())
    };
    let (with, without) = (go(&mut simulation, 2.0 + more), go(&mut simulation, 2.0));
    // d' = A d + B more, by the trapezoidal rule.
    let part = h / f64::from(parts);
    let mut left: Vec<f64> = linear.a.iter().map(|a| -0.5 * part * a).collect();
    for i in 0..n {
        left[i * n + i] += 1.0;
    }
    let mut lu = whipcord_numerics::DenseLu::default();
    lu.factor(n, &left).unwrap();
    let mut d = vec![0.0; n];
    for _ in 0..parts {
        let mut right: Vec<f64> = (0..n)
            .map(|i| {
                let along: f64 = (0..n).map(|j| linear.a[i * n + j] * d[j]).sum();
                d[i] + 0.5 * part * along + part * linear.b[i] * more
            })
            .collect();
        lu.solve(&mut right);
        d = right;
    }
    // Of the velocity of the tip across, which the tension changes most.
    let tip = 6 * (simulation.arc_lengths().len() - 2);
    for k in 0..2 {
        let got = with[tip + k] - without[tip + k];
        assert!(
            (got - d[tip + k]).abs() < 0.02 * got.abs().max(1e-6),
            "{k}: {got:e} {:e}",
            d[tip + k]
        );
    }
}
