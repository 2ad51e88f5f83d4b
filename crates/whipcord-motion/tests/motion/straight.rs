//! Cables straight between disks.

use whipcord::robot::Motor;
use whipcord::{
    Cable, Case, Disks, Loads, Model, ModelKind, Robot, Shortening, Statics, Stations, Vec3,
};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, Initial, Method, MotionOptions, Simulation,
};

use super::robots::{helix, paper, straight};

fn options() -> MotionOptions {
    MotionOptions {
        model: ModelKind::CosseratDisks,
        damping: Damping::Time(2e-2),
        ..MotionOptions::default()
    }
}

/// A robot with few disks, whose chords are far from its arcs; one cable ends between two disks.
fn few(disks: usize) -> Robot {
    let anchored = Cable { ends_at: Some(0.13), ..straight("anchored", 2.5, 0.008) };
    let with = paper(vec![helix(), straight("straight", 1.0, 0.008), anchored]);
    let disks = Disks {
        mass: 1e-3,
        outer_radius: Some(0.01),
        thickness: Some(1e-3),
        ..Disks::equally_spaced(0.18, disks, 0.008)
    };
    Robot::new(with.backbone().clone(), disks, with.cables().to_vec()).unwrap()
}

fn loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(3.0, -9.0, 1.0)),
        tip_force: Vec3::new(0.05, 0.02, -0.1),
        ..Loads::default()
    }
}

fn statics(robot: &Robot, case: &Case) -> whipcord::Solution {
    let model = Model::new(ModelKind::CosseratDisks, Stations::Disks, Default::default());
    model.with_tolerance(1e-10).solve(robot, case).unwrap()
}

/// The equilibrium to start from, and that in which a damped motion ends, are those of the statics with the same cables.
#[test]
fn motions_start_and_end_in_the_equilibrium_of_the_statics() {
    for disks in [4, 11] {
        let robot = few(disks);
        let from = Case { loads: loads(), ..Case::with_tensions(&[1.0, 0.5, 1.5]) };
        let to = Case { loads: loads(), ..Case::with_tensions(&[3.0, 2.0, 0.5]) };
        for (elements, limit) in [(48, 1e-6), (96, 1e-7)] {
            let of = MotionOptions { elements, ..options() };
            let mut simulation = Simulation::new(&robot, &from, of).unwrap();
            let error = |simulation: &Simulation, case: &Case| {
                let tip = statics(&robot, case).shape.tip().position;
                (simulation.state().tip().position - tip).norm() / 0.18
            };
            let start = error(&simulation, &from);
            let commands = Commands::of_case(&robot, &to);
            for _ in 0..150 {
                simulation.step(&commands, 0.02).unwrap();
            }
            let end = error(&simulation, &to);
            println!("{disks} disks, {elements} elements: {start:.1e} {end:.1e}");
            assert!(start < limit && end < limit, "{disks} {elements}: {start:e} {end:e}");
            for (moved, still) in simulation.state().cables.iter().zip(&statics(&robot, &to).cables)
            {
                assert!((moved.length - still.length).abs() < limit * 0.18, "{moved:?} {still:?}");
            }
        }
    }
}

/// The same by lengths, also slack and with stretch, and by motors with drives that give way.
#[test]
fn lengths_and_motors_lead_to_the_equilibrium_of_the_statics() {
    let three = || -> Vec<Cable> {
        (0..3).map(|i| straight(&format!("{i}"), 2.0 * f64::from(i), 0.008)).collect()
    };
    let elastic = |cable: Cable| Cable { axial_stiffness: Some(2e4), ..cable };
    let motors = vec![
        Motor { stiffness: Some(5e3), ..Motor::spool("bend", [(0, 0.01)]) },
        Motor { stiffness: Some(5e3), ..Motor::spool("other", [(1, 0.01), (2, 0.01)]) },
    ];
    let by_motors = paper(three()).with_motors(motors).unwrap();
    let of_motors = Case::with_motors(&by_motors, &[0.5, -0.2]).unwrap();
    let lengths = |to: [f64; 3]| Case::with_shortenings(&to.map(Shortening::Length));
    let soft = paper(three().into_iter().map(elastic).collect());
    for (name, robot, case) in [
        ("rigid", paper(three()), lengths([6e-3, -2e-3, -2e-3])),
        ("elastic", soft, lengths([5e-3, 1e-3, -6e-3])),
        ("motors", by_motors, of_motors),
    ] {
        let case = Case { loads: loads(), ..case };
        let options = MotionOptions { elements: 80, initial: Initial::Rest, ..options() };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let to = Commands::of_case(&robot, &case);
        let ramp =
            |course: &Course| Course::table(vec![0.0, 0.5], vec![0.0, course.before(0.0)]).unwrap();
        let mut ramps = to.clone();
        for drive in &mut ramps.cables {
            *drive = CableDrive::Shortening(ramp(drive.course()));
        }
        for course in ramps.motors.iter_mut().flatten() {
            *course = ramp(course);
        }
        for _ in 0..200 {
            let state = simulation.step(&ramps, 0.02).unwrap();
            assert_eq!(state.diagnostics.method, Method::Robust);
        }
        let solution = statics(&robot, &case);
        let error = (simulation.state().tip().position - solution.shape.tip().position).norm();
        println!("{name}: {error:.1e}");
        assert!(error < 1e-6 * 0.18, "{name}: {error:e}");
        for (moved, still) in simulation.state().cables.iter().zip(&solution.cables) {
            let tension = still.tension.unwrap();
            assert!((moved.tension - tension).abs() < 1e-4, "{name}: {moved:?} {still:?}");
            assert!((moved.length - still.length).abs() < 1e-7);
        }
        let mut again = Simulation::new(
            &robot,
            &case,
            MotionOptions { initial: Initial::Equilibrium, ..simulation.options().clone() },
        )
        .unwrap();
        let tip = again.state().tip().position;
        assert!((tip - solution.shape.tip().position).norm() < 1e-6 * 0.18, "{name}");
        let after = again.step(&to, 0.01).unwrap().tip().position;
        assert!((after - tip).norm() < 1e-9, "{name}: {:e}", (after - tip).norm());
    }
}

/// The energy of rod and cables, and of gravity, is conserved to rounding at every step size.
#[test]
fn the_energy_method_conserves_energy() {
    for dt in [1e-4, 1e-3, 5e-3, 1e-2, 2e-2] {
        let robot = few(6);
        let case = Case { loads: loads(), ..Case::with_tensions(&[4.0, 2.0, 1.0]) };
        let options = MotionOptions { method: Method::Energy, damping: Damping::None, ..options() };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let commands = Commands::tensions(&[1.0, 0.5, 3.0]);
        let (mut worst, mut parts, mut iterations) = (0.0_f64, 0, 0);
        let steps = (1.0_f64 / dt).round() as usize;
        for _ in 0..steps {
            let state = simulation.step(&commands, dt).unwrap();
            worst = worst.max(state.energy.defect().abs());
            parts += state.diagnostics.parts;
            iterations += state.diagnostics.iterations;
        }
        let scale = 4.0 * 0.0107;
        println!("{dt}: {:.1e}, {:.2} iterations", worst / scale, iterations as f64 / steps as f64);
        assert!(worst / scale < 1e-12, "{dt}: {:e}", worst / scale);
        // Violent motions without damping need shorter steps at times.
        assert!(dt > 0.01 || parts == steps, "{dt}: {parts}");
    }
}

/// Order in time of each method, and the energy balance at the end.
#[test]
fn methods_keep_their_orders() {
    let robot = few(6);
    let case = Case { loads: loads(), ..Case::with_tensions(&[0.0, 0.5, 0.0]) };
    let ramp = |to: f64| {
        let times: Vec<f64> = (0..=40).map(|k| 0.0025 * f64::from(k)).collect();
        let values = times.iter().map(|t| to * (1.0 - (31.4159265 * t).cos()) / 2.0).collect();
        CableDrive::Tension(Course::table(times, values).unwrap())
    };
    for (method, dt, order, gain) in [
        (Method::Accurate, 5e-3, 3.3, 1e-3),
        (Method::Energy, 2.5e-3, 1.8, 1e-9),
        (Method::Robust, 2.5e-3, 1.8, 2e-2),
    ] {
        let tip = |dt: f64| {
            let options = MotionOptions {
                method,
                damping: Damping::Time(5e-3),
                iteration_tolerance: 1e-12,
                ..options()
            };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let commands = Commands::new(vec![
                ramp(3.0),
                CableDrive::Tension(Course::constant(0.5)),
                ramp(1.0),
            ]);
            for _ in 0..(0.1 / dt).round() as usize {
                simulation.step(&commands, dt).unwrap();
            }
            let energy = simulation.state().energy;
            (simulation.state().tip().position, energy.defect().abs() / energy.cables.abs())
        };
        let fine = tip(dt / 16.0).0;
        let errors = [dt, dt / 2.0].map(|dt| (tip(dt).0 - fine).norm());
        let defect = tip(dt).1;
        let found = (errors[0] / errors[1]).log2();
        println!("{method:?}: {errors:?}, order {found:.2}, defect {defect:.1e}");
        assert!(found > order && defect < gain, "{method:?}: {errors:?} {defect:e}");
    }
}

/// With more and more disks the motion becomes that with continuous cables, with the square of their distance.
#[test]
fn many_disks_lead_to_continuous_cables() {
    let tip = |model: ModelKind, disks: usize| {
        let with = paper(vec![helix()]);
        let robot = Robot::new(
            with.backbone().clone(),
            Disks::equally_spaced(0.18, disks, 0.008),
            with.cables().to_vec(),
        )
        .unwrap();
        let options =
            MotionOptions { model, elements: 24, damping: Damping::Time(3.5e-3), ..options() };
        let mut simulation =
            Simulation::new(&robot, &Case::with_tensions(&[0.0]), options).unwrap();
        for _ in 0..15 {
            simulation.step(&Commands::tensions(&[4.0]), 0.01).unwrap();
        }
        simulation.state().tip().position
    };
    let smooth = tip(ModelKind::Cosserat, 7);
    let errors = [7, 13, 25].map(|disks| (tip(ModelKind::CosseratDisks, disks) - smooth).norm());
    println!("{errors:?}");
    assert!(errors[0] > 1e-4);
    for pair in errors.windows(2) {
        assert!((3.8..5.2).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// Small vibrations about a loaded shape have the period that the steps show, and the linearisation goes with both.
#[test]
fn vibrations_are_those_of_small_motions() {
    let robot = few(6);
    let case = Case { loads: loads(), ..Case::with_tensions(&[2.0, 1.0, 0.5]) };
    let of = MotionOptions {
        elements: 12,
        damping: Damping::None,
        iteration_tolerance: 1e-13,
        ..options()
    };
    let mut simulation = Simulation::new(&robot, &case, of.clone()).unwrap();
    let commands = Commands::of_case(&robot, &case);
    let mode = simulation.modes(&commands, 2).unwrap().remove(0);
    let period = 1.0 / mode.frequency().unwrap();
    let mut start = simulation.state().start();
    for (velocity, shape) in start.velocities.iter_mut().zip(&mode.shape) {
        *velocity = *shape * 1e-4;
    }
    let rest = simulation.state().tip().position;
    let options = MotionOptions { initial: Initial::State(Box::new(start)), ..of };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let mut greatest = 0.0_f64;
    for _ in 0..100 {
        simulation.step(&commands, period / 100.0).unwrap();
        greatest = greatest.max((simulation.state().tip().position - rest).norm());
    }
    let left = (simulation.state().tip().position - rest).norm();
    println!("{:.3} Hz, {:.1e} of {:.1e}", 1.0 / period, left, greatest);
    assert!(left < 2e-3 * greatest, "{left:e} {greatest:e}");
}

/// Robots without disks, and models without dynamics, are refused.
#[test]
fn other_models_are_refused() {
    let robot = super::robots::rod(0.2, 3e-3, 2e9, 0.3, 1200.0, vec![straight("a", 0.0, 5e-3)]);
    let case = Case::with_tensions(&[1.0]);
    let error = Simulation::new(&robot, &case, options()).unwrap_err();
    assert!(error.to_string().contains("`disks`"), "{error}");
    let other = MotionOptions { model: ModelKind::FourBar, ..options() };
    let error = Simulation::new(&few(5), &Case::with_tensions(&[1.0; 3]), other).unwrap_err();
    assert!(error.to_string().contains("motion.model"), "{error}");
}
