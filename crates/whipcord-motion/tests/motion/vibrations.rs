//! Natural vibrations and linearisation.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use whipcord::{Cable, Case, Form, Loads, Obstacle, PointMass, Pose, UnitQuaternion, Vec3};
use whipcord_motion::{Commands, Damping, Initial, MotionError, MotionOptions, Simulation};

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

fn ball(position: Vec3, radius: f64, friction: f64) -> Obstacle {
    let pose = Pose { position, ..Pose::IDENTITY };
    let form = Form::Sphere { radius };
    Obstacle { name: "ball".to_owned(), form, pose, friction, movable: None }
}

/// A half-space beyond y = 0.03.
fn wall(friction: f64) -> Obstacle {
    let rotation = UnitQuaternion::exp(Vec3::X * FRAC_PI_2);
    let pose = Pose { position: Vec3::Y * 0.03, rotation };
    Obstacle { name: "wall".to_owned(), form: Form::HalfSpace, pose, friction, movable: None }
}

/// `βL` of a beam that is clamped at one end, and held at the other where a spring of κ EI/L turns it back.
fn clamped_and_held(kappa: f64, mut low: f64, mut high: f64) -> f64 {
    let lacks = |b: f64| {
        let (c, s) = (b.cosh(), b.sinh());
        let sigma = (c - b.cos()) / (s - b.sin());
        b * ((c + b.cos()) - sigma * (s + b.sin()))
            + kappa * ((s + b.sin()) - sigma * (c - b.cos()))
    };
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if lacks(low) * lacks(middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// A cantilever whose tip rests on a ball is propped: βL = 3.92660 and 7.06858 across it. Along it the tip is free; where it sticks it is held as well, and at a
/// radius from the axis, whose stiffness against stretch then is a spring of EA r²/L = 4 EI/L against its turning.
#[test]
fn frequencies_of_a_propped_cantilever() {
    let (length, radius, young, density) = (0.5_f64, 1e-3_f64, 200e9, 8000.0);
    let robot = rod(length, 2.0 * radius, young, 0.25, density, vec![]);
    let bar = (young * PI * radius.powi(4) / 4.0 / (density * PI * radius * radius)).sqrt();
    for friction in [0.0, 0.5] {
        let case = Case {
            obstacles: vec![ball(Vec3::new(-0.021, 0.0, length), 0.02, friction)],
            // Little weight, so that the tip touches and nothing bends.
            loads: Loads { gravity: Some(Vec3::new(-1e-3, 0.0, 0.0)), ..Loads::default() },
            ..Case::default()
        };
        let options = MotionOptions { elements: 16, ..MotionOptions::default() };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        assert_eq!(simulation.state().contacts.len(), 1);
        let modes = simulation.modes(&Commands::default(), 4).unwrap();
        let expected = match friction {
            0.0 => [1.875_104_07, 3.926_602_31, 4.694_091_13, 7.068_582_75],
            _ => [
                3.926_602_31,
                clamped_and_held(4.0, 3.95, 4.7),
                7.068_582_75,
                clamped_and_held(4.0, 7.1, 7.84),
            ],
        };
        for (mode, beta) in modes.iter().zip(expected) {
            let exact = beta * beta * bar / (length * length);
            let got = mode.angular_frequency().unwrap();
            assert!((got / exact - 1.0).abs() < 2e-3, "{friction}: {got} {exact}");
        }
    }
}

/// A rod that nothing holds: six motions as a whole, then βL = 4.73004 and 7.85320, twice each.
#[test]
fn frequencies_of_a_free_rod() {
    let (length, radius, young, density) = (0.5, 1e-3, 200e9, 8000.0);
    let robot = rod(length, 2.0 * radius, young, 0.25, density, vec![]);
    let options = MotionOptions { elements: 16, has_free_base: true, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &Case::default(), options).unwrap();
    let modes = simulation.modes(&Commands::default(), 10).unwrap();
    let bar = (young * PI * radius.powi(4) / 4.0 / (density * PI * radius * radius)).sqrt();
    for (k, mode) in modes.iter().enumerate() {
        if k < 6 {
            assert_eq!(mode.squared_frequency, 0.0, "{k}");
            continue;
        }
        let beta: f64 = if k < 8 { 4.730_040_74 } else { 7.853_204_62 };
        let exact = beta * beta * bar / (length * length);
        let got = mode.angular_frequency().unwrap();
        assert!((got / exact - 1.0).abs() < 3e-4, "{k}: {got} {exact}");
    }
}

/// Small vibrations of a robot that leans on a wall go on as the mode says.
#[test]
fn vibrations_in_contact_are_those_of_the_motion() {
    let robot = paper(vec![straight("a", FRAC_PI_2, 0.008)]);
    for friction in [0.0, 0.8] {
        let case = Case { obstacles: vec![wall(friction)], ..Case::with_tensions(&[6.0]) };
        let options =
            MotionOptions { elements: 20, iteration_tolerance: 1e-12, ..MotionOptions::default() };
        let damped = MotionOptions { damping: Damping::Time(3.5e-3), ..options.clone() };
        let mut settling = Simulation::new(&robot, &case, damped).unwrap();
        // It comes to rest in its own elements, and lets go a little: where it has slid its friction is at its limit.
        let commands = Commands::tensions(&[5.8]);
        for _ in 0..50 {
            settling.step(&commands, 0.02).unwrap();
        }
        let mut state = settling.state().clone();
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        simulation.set_state(&state).unwrap();
        assert!(!state.contacts.is_empty());
        let mode = simulation.modes(&commands, 1).unwrap().remove(0);
        let omega = mode.angular_frequency().unwrap();
        for (velocity, shape) in state.velocities.iter_mut().zip(&mode.shape) {
            *velocity = *shape * 1e-5;
        }
        simulation.set_state(&state).unwrap();
        let period = 2.0 * PI / omega;
        for _ in 0..400 {
            simulation.step(&commands, period / 400.0).unwrap();
            assert!(!simulation.state().contacts.is_empty());
        }
        let (start, end) =
            (state.velocities.last().unwrap(), simulation.state().velocities.last().unwrap());
        let change = (end.linear - start.linear).norm() / start.linear.norm();
        // The stiffness of what sticks under a traction is not symmetric, of which the modes take the symmetric part.
        let tolerance = if friction > 0.0 { 3e-2 } else { 1e-2 };
        assert!(change < tolerance, "{friction}: {change:e}");
    }
}

/// `A` and `B` predict how small changes of the state and of a tension go on, here in a motion with velocities.
#[test]
fn the_linearisation_predicts_small_changes() {
    let gravity = Some(Vec3::new(9.81, 0.0, 0.0));
    let held = Case { loads: Loads { gravity, ..Loads::default() }, ..Case::with_tensions(&[0.0]) };
    let options = MotionOptions {
        elements: 2,
        damping: Damping::Time(2e-3),
        iteration_tolerance: 1e-12,
        ..MotionOptions::default()
    };
    predicts(&held, options.clone(), 2.0);
    // Falling and turning.
    let free = MotionOptions { has_free_base: true, initial: Initial::Rest, ..options.clone() };
    predicts(&held, free, 2.0);
    // On a wall: sliding without friction and with it, and sticking, where it lets go.
    for (friction, told) in [(0.0, 7.0), (0.2, 7.0), (0.5, 5.8)] {
        let touching = Case { obstacles: vec![wall(friction)], ..Case::with_tensions(&[6.0]) };
        predicts(&touching, options.clone(), told);
    }
}

fn predicts(case: &Case, options: MotionOptions, told: f64) {
    let is_free = options.has_free_base;
    let robot = paper(vec![helix()]);
    let mut simulation = Simulation::new(&robot, case, options).unwrap();
    let commands = |tension| Commands::tensions(&[tension]);
    for _ in 0..10 {
        simulation.step(&commands(told), 5e-3).unwrap();
    }
    let state = simulation.state().clone();
    assert_eq!(state.contacts.is_empty(), case.obstacles.is_empty());
    let linear = simulation.linearize().unwrap();
    let nodes = simulation.arc_lengths().len();
    let (first, base) = if is_free { (0, 6) } else { (1, 0) };
    assert_eq!(linear.states, base + 6 * (nodes - first) + 6 * (nodes - 1));
    // The step from the state by the linear model is that of the simulation: x(h) by the implicit midpoint rule in small parts.
    let flat = |state: &whipcord_motion::State| -> Vec<f64> {
        let twists = state.velocities[first..].iter().chain(&state.strains);
        let rest = twists.flat_map(|t| [t.linear.to_array(), t.angular.to_array()].concat());
        core::iter::repeat_n(0.0, base).chain(rest).collect()
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
    let (with, without) = (go(&mut simulation, told + more), go(&mut simulation, told));
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
    let tip = base + 6 * (nodes - 1 - first);
    for k in 0..2 {
        let got = with[tip + k] - without[tip + k];
        assert!(
            (got - d[tip + k]).abs() < 0.02 * got.abs().max(1e-6),
            "{:?} {k}: {got:e} {:e}",
            case.obstacles.first().map(|of| of.friction),
            d[tip + k]
        );
    }
}

/// Cables that stick in their holes hold their pieces: the vibrations are those that the steps of the motion have, and the linearisation is that of the equations.
#[test]
fn vibrations_with_cables_that_stick_are_those_of_the_motion() {
    let rubs = |cable: Cable| Cable { friction: Some(0.4), axial_stiffness: Some(300.0), ..cable };
    let robot = paper(vec![rubs(helix()), rubs(straight("side", 2.0, 0.008))]);
    let gravity = Some(Vec3::new(9.81, 0.0, 0.0));
    for model in MotionOptions::MODELS {
        let case = Case {
            loads: Loads { gravity, ..Loads::default() },
            ..Case::with_tensions(&[0.0, 0.0])
        };
        let options =
            MotionOptions { model, damping: Damping::Time(4e-3), ..MotionOptions::default() };
        let mut damped = Simulation::new(&robot, &case, options.clone()).unwrap();
        // While they are pulled the cables slide.
        let commands = Commands::tensions(&[3.0, 2.0]);
        damped.step(&commands, 1e-2).unwrap();
        assert!(matches!(damped.modes(&commands, 1), Err(MotionError::Sliding { .. })));
        assert!(matches!(damped.linearize(), Err(MotionError::Sliding { .. })));
        for _ in 0..400 {
            damped.step(&commands, 1e-2).unwrap();
        }
        let options = MotionOptions { damping: Damping::None, ..options };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        simulation.set_state(damped.state()).unwrap();
        let mode = simulation.modes(&commands, 1).unwrap().remove(0);
        let omega = mode.angular_frequency().unwrap();
        let free = {
            let slides = paper(vec![helix(), straight("side", 2.0, 0.008)]);
            let case = Case { loads: case.loads.clone(), ..Case::with_tensions(&[3.0, 2.0]) };
            let options = MotionOptions { model, ..MotionOptions::default() };
            let mut free = Simulation::new(&slides, &case, options).unwrap();
            free.modes(&commands, 1).unwrap().remove(0).angular_frequency().unwrap()
        };
        println!("{model}: {omega} rad/s, sliding without friction {free}");
        assert!(omega > 1.02 * free, "{omega} {free}");
        let linear = simulation.linearize().unwrap();
        assert!(linear.b.iter().all(|entry| entry.abs() < 1e-6), "what sticks has no drive");
        let mut state = simulation.state().clone();
        for (velocity, shape) in state.velocities.iter_mut().zip(&mode.shape) {
            *velocity = *shape * 1e-5;
        }
        simulation.set_state(&state).unwrap();
        let period = TAU / omega;
        for _ in 0..1600 {
            simulation.step(&commands, period / 1600.0).unwrap();
        }
        let (start, end) =
            (state.velocities.last().unwrap(), simulation.state().velocities.last().unwrap());
        let change = (end.linear - start.linear).norm() / start.linear.norm();
        println!("{model}: {change:e}");
        assert!(change < 2e-3, "{model}: {change:e}");
    }
}
