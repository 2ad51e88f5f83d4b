//! Friction of cables.

use whipcord::{Cable, Case, Loads, Model, ModelKind, Robot, Shortening, Statics, Stations, Vec3};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, Initial, Method, MotionOptions, Simulation,
};

use super::robots::{helix, paper, ramps, straight};

const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

fn rubbing(cables: Vec<Cable>) -> Robot {
    let rubs = |cable: Cable| Cable { friction: Some(0.3), ..cable };
    paper(cables.into_iter().map(rubs).collect())
}

fn options(model: ModelKind) -> MotionOptions {
    MotionOptions {
        model,
        elements: 20,
        // Overdamped: a robot that swings beyond its equilibrium is held there by friction.
        damping: Damping::Time(8e-2),
        initial: Initial::Rest,
        ..MotionOptions::default()
    }
}

/// After a slow pull, and after a slow release, the robot stands where the statics has it after the same steps: the nearer, the slower.
#[test]
fn slow_motions_are_the_steps_of_the_statics() {
    let robot = rubbing(vec![helix(), straight("straight", 1.0, 0.008)]);
    let loads = Loads { tip_force: Vec3::new(0.02, 0.01, -0.02), ..Loads::default() };
    let ramp = 8.0;
    for (model, by_length) in MODELS.into_iter().flat_map(|model| [(model, false), (model, true)]) {
        let steps =
            if by_length { [[4e-3, -1e-3], [2.5e-3, 0.0]] } else { [[3.0, 1.0], [1.2, 1.5]] };
        let case = |values: [f64; 2]| match by_length {
            true => Case::with_shortenings(&values.map(Shortening::Length)),
            false => Case::with_tensions(&values),
        };
        let drive = |i: usize| {
            let course = ramps(ramp, 1.0, &steps.map(|step| step[i]));
            if by_length { CableDrive::Shortening(course) } else { CableDrive::Tension(course) }
        };
        let commands = Commands::new(vec![drive(0), drive(1)]);
        let at_rest = Case { loads: loads.clone(), ..case([0.0, 0.0]) };
        let mut simulation = Simulation::new(&robot, &at_rest, options(model)).unwrap();
        let mut before = Vec::new();
        for (k, step) in steps.into_iter().enumerate() {
            for _ in 0..((ramp + 1.0) / 0.02_f64).round() as usize {
                let state = simulation.step(&commands, 0.02).unwrap();
                assert_eq!(state.diagnostics.method, Method::Robust);
            }
            let case =
                Case { loads: loads.clone(), before: core::mem::take(&mut before), ..case(step) };
            let solution = Model::new(model, Stations::Disks, Default::default())
                .solve(&robot, &case)
                .unwrap();
            before = case.before;
            before.push(case.commands);
            let tip = solution.shape.tip().position;
            let error = (simulation.state().tip().position - tip).norm() / 0.18;
            let cables = simulation.state().cables.iter().zip(&solution.cables);
            let tensions: Vec<[f64; 2]> =
                cables.map(|(moved, still)| [moved.tension, still.tension.unwrap()]).collect();
            println!("{model} by_length {by_length}, step {k}: {error:.1e}, {tensions:?}");
            // Twenty elements leave 6e-4 where cables are continuous helices.
            assert!(error < 7e-4, "{model} {by_length} {k}: {error:e}");
            for [a, b] in tensions {
                assert!((a - b).abs() < 0.03 * b.max(1.0), "{model} {by_length} {k}: {a} {b}");
            }
        }
    }
}

/// A planar robot that is pulled bends by (1/μ) ln(1 + μ r τ L/EI); what friction takes is in the balance. Let go, it comes back to where it was.
#[test]
fn a_planar_robot_against_the_closed_form() {
    let robot = rubbing(vec![straight("a", 0.0, 0.008)]);
    let stiffness = 1.1e9 * core::f64::consts::PI * 0.0015_f64.powi(4) / 4.0;
    let (mu, tension): (f64, f64) = (0.3, 3.0);
    let expected = (mu * 0.008 * tension * 0.18 / stiffness).ln_1p() / mu;
    for model in MODELS {
        let mut simulation =
            Simulation::new(&robot, &Case::with_tensions(&[0.0]), options(model)).unwrap();
        let commands = Commands::new(vec![CableDrive::Tension(ramps(1.0, 1.0, &[tension, 0.0]))]);
        let angle = |simulation: &Simulation| simulation.state().tip().rotation.log().norm();
        for _ in 0..200 {
            simulation.step(&commands, 0.01).unwrap();
        }
        // With ten spans the closed form of the continuous cable is near.
        let limit = if model == ModelKind::Cosserat { 2e-5 } else { 2e-2 };
        let bent = angle(&simulation);
        assert!((bent / expected - 1.0).abs() < limit, "{model}: {bent} {expected}");
        let energy = simulation.state().energy;
        println!("{model}: {bent} {expected}, {:.1e} of {}", energy.defect(), energy.cables);
        assert!(energy.defect().abs() < 1e-4 * energy.cables, "{model}: {energy:?}");
        for _ in 0..200 {
            simulation.step(&commands, 0.01).unwrap();
        }
        let energy = simulation.state().energy;
        assert!(angle(&simulation) < 1e-4, "{model}: {}", angle(&simulation));
        assert!((energy.dissipated / energy.cables - 1.0).abs() < 1e-3, "{model}: {energy:?}");
    }
}

/// From the equilibrium that the statics has with friction a motion starts at rest, and it is still there later.
#[test]
fn motions_start_in_equilibria_with_friction() {
    let robot = rubbing(vec![helix(), straight("straight", 1.0, 0.008)]);
    for model in MODELS {
        let case = Case::with_tensions(&[2.0, 1.0]);
        let options = MotionOptions { initial: Initial::Equilibrium, ..options(model) };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let tip = simulation.state().tip().position;
        let statics = Model::new(model, Stations::Disks, Default::default());
        let expected = statics.solve(&robot, &case).unwrap().shape.tip().position;
        let error = (tip - expected).norm() / 0.18;
        let commands = Commands::of_case(&robot, &case);
        for _ in 0..50 {
            simulation.step(&commands, 0.01).unwrap();
        }
        let moved = (simulation.state().tip().position - tip).norm() / 0.18;
        println!("{model}: {error:.1e}, moved {moved:.1e}");
        assert!(error < 2e-3 && moved < 2e-3, "{model}: {error:e} {moved:e}");
    }
}

/// A fast motion with friction goes through at every step size, also by lengths that go slack, and the balance closes better with shorter steps.
#[test]
fn fast_motions_go_through() {
    let robot = rubbing(vec![helix(), straight("straight", 1.0, 0.008)]);
    for (model, by_length) in MODELS.into_iter().flat_map(|model| [(model, false), (model, true)]) {
        let mut defects = Vec::new();
        for dt in [2e-2, 5e-3, 1e-3] {
            let options =
                MotionOptions { elements: 6, damping: Damping::Time(2e-3), ..options(model) };
            let at_rest = Case::with_tensions(&[0.0, 0.0]);
            let mut simulation = Simulation::new(&robot, &at_rest, options).unwrap();
            let size = if by_length { 2e-3 } else { 1.0 };
            let course = |values: [f64; 3]| {
                let [a, b, c] = values.map(|value| value * size);
                let course =
                    Course::table(vec![0.0, 0.1, 0.3, 0.4, 0.6], vec![0.0, a, a, b, c]).unwrap();
                match by_length {
                    true => CableDrive::Shortening(course),
                    false => CableDrive::Tension(course),
                }
            };
            let commands = Commands::new(vec![course([3.0, 0.5, 2.0]), course([-1.0, 1.0, -0.5])]);
            let (mut slack, mut parts) = (false, 0);
            for _ in 0..(0.6_f64 / dt).round() as usize {
                let state = simulation.step(&commands, dt).unwrap();
                assert!(state.holes.tensions.iter().all(|tension| *tension >= 0.0));
                slack |= state.cables[1].slack > 0.0;
                parts += state.diagnostics.parts;
            }
            let energy = simulation.state().energy;
            defects.push((energy.defect().abs() / energy.dissipated, parts));
            assert!(energy.dissipated > 0.0 && slack == by_length);
        }
        println!("{model} by_length {by_length}: {defects:?}");
        assert!(defects[2].0 < 0.05 && defects[2].0 < defects[0].0, "{model}: {defects:?}");
    }
}
