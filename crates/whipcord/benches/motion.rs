//! Costs of a step: `cargo bench -p whipcord --bench motion`.
//!
//! Before the times it prints how many iterations and linearisations a step of 10 ms takes, and its error against steps of 0.25 ms.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark fails by panicking")]

use core::f64::consts::TAU;

use divan::Bencher;
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, Robot, Routing, Section, Shortening, Vec3,
};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, LoadCourse, Method, MotionOptions, Simulation,
};

fn main() {
    print_efforts();
    divan::main();
}

fn robot(
    section: f64,
    length: f64,
    young: f64,
    poisson: f64,
    density: f64,
    disks: Disks,
    cables: Vec<Cable>,
) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(section)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(poisson),
            density: Some(density),
            ..Material::default()
        },
        ..Backbone::new(length)
    };
    Robot::new(backbone, disks, cables).unwrap()
}

/// The paper's robot with disks of 1 g.
fn paper(cables: Vec<Cable>) -> Robot {
    let disks =
        Disks { mass: 1e-3, outer_radius: Some(0.01), ..Disks::equally_spaced(0.18, 11, 0.008) };
    robot(0.003, 0.18, 1.1e9, 0.3, 1040.0, disks, cables)
}

fn options(method: Method, elements: usize) -> MotionOptions {
    MotionOptions { method, elements, damping: Damping::Time(3.5e-3), ..MotionOptions::default() }
}

/// One cable on a helix, pulled at once by 4 N.
fn pulled(options: MotionOptions) -> (Simulation, Commands) {
    let helix = Routing::Helix { start_angle: 0.0, turns: 0.5, radius: 0.008 };
    let robot = paper(vec![Cable::new("helix", helix)]);
    let simulation = Simulation::new(&robot, &Case::with_tensions(&[0.0]), options).unwrap();
    (simulation, Commands::tensions(&[4.0]))
}

/// Three cables by length, of which one goes slack and gets taut.
fn by_length(options: MotionOptions) -> (Simulation, Commands) {
    let straight = |i: i32| {
        let angle = TAU * f64::from(i) / 3.0;
        let cable = Cable::new(format!("{i}"), Routing::Straight { angle, radius: 0.008 });
        Cable { axial_stiffness: Some(0.18 / 1.3e-5), ..cable }
    };
    let robot = paper((0..3).map(straight).collect());
    let loads = Loads { gravity: Some(Vec3::new(-9.81, 0.0, 0.0)), ..Loads::default() };
    let case = Case { loads, ..Case::with_shortenings(&[Shortening::Length(0.0); 3]) };
    let course = |values: [f64; 5]| {
        let times = vec![0.0, 0.05, 0.3, 0.35, 1.0];
        CableDrive::Shortening(Course::table(times, values.to_vec()).unwrap())
    };
    let paid = course([0.0, -4.5e-3, -4.5e-3, -4.5e-3, -4.5e-3]);
    let drives = vec![course([0.0, 8e-3, 8e-3, -6e-3, -6e-3]), paid.clone(), paid];
    (Simulation::new(&robot, &case, options).unwrap(), Commands::new(drives))
}

/// A steel rod of 0.6 m from whose tip a weight is cut.
fn released(options: MotionOptions) -> (Simulation, Commands) {
    let robot = robot(1.6e-3, 0.6, 200e9, 0.33, 7870.0, Disks::none(0.6), vec![]);
    let gravity = Some(Vec3::new(-9.81, 0.0, 0.0));
    let case = Case { loads: Loads { gravity, ..Loads::default() }, ..Case::default() };
    let weight = LoadCourse {
        loads: Loads { tip_force: Vec3::new(-0.2, 0.1, 0.0), ..Loads::default() },
        factor: Course::table(vec![0.0, 0.0], vec![1.0, 0.0]).unwrap(),
    };
    let options = MotionOptions { loads: vec![weight], damping: Damping::Time(1e-3), ..options };
    (Simulation::new(&robot, &case, options).unwrap(), Commands::default())
}

type Scene = fn(MotionOptions) -> (Simulation, Commands);

const SCENES: [(&str, Scene, Method); 5] = [
    ("pulled, accurate", pulled, Method::Accurate),
    ("pulled, energy", pulled, Method::Energy),
    ("pulled, robust", pulled, Method::Robust),
    ("three cables by length", by_length, Method::Robust),
    ("released rod, accurate", released, Method::Accurate),
];

/// Seconds of the motions.
const DURATION: f64 = 0.6;

/// Tip every 20 ms.
fn tips(scene: Scene, method: Method, dt: f64) -> (Vec<Vec3>, usize, usize) {
    let (mut simulation, commands) = scene(options(method, 5));
    let (mut tips, mut iterations, mut factorisations) = (Vec::new(), 0, 0);
    for _ in 0..(DURATION / 0.02).round() as usize {
        for _ in 0..(0.02 / dt).round() as usize {
            let state = simulation.step(&commands, dt).unwrap();
            iterations += state.diagnostics.iterations;
            factorisations += state.diagnostics.factorisations;
        }
        tips.push(simulation.state().tip().position);
    }
    (tips, iterations, factorisations)
}

fn print_efforts() {
    println!("steps of 10 ms, 5 elements      iterations  linearisations  RMS error");
    for (name, scene, method) in SCENES {
        let (exact, ..) =
            tips(scene, if method == Method::Robust { method } else { Method::Accurate }, 2.5e-4);
        let (got, iterations, factorisations) = tips(scene, method, 0.01);
        let square = got.iter().zip(&exact).map(|(a, b)| (*a - *b).norm_squared()).sum::<f64>();
        let steps = DURATION / 0.01;
        println!(
            "{name:30} {:10.2} {:15.2}  {:.2e} m",
            iterations as f64 / steps,
            factorisations as f64 / steps,
            (square / got.len() as f64).sqrt()
        );
    }
}

/// A step of 10 ms, averaged over the motion: the real-time factor is 10 ms over this time.
#[divan::bench(args = [0, 1, 2, 3, 4])]
fn step_of_10_ms(bencher: Bencher<'_, '_>, scene: usize) {
    let (_, scene, method) = SCENES[scene];
    let (simulation, commands) = scene(options(method, 5));
    let mut moving = simulation.clone();
    let start = simulation.state().clone();
    let mut step = 0;
    bencher.bench_local(move || {
        if step == 60 {
            moving.set_state(&start).unwrap();
            step = 0;
        }
        step += 1;
        moving.step(&commands, 0.01).unwrap().time
    });
}

/// One iteration with its linearisation: a step of the midpoint rule's iteration, with 5 elements (10 nodes) and 10 (20 nodes), in µs per
/// iteration when divided by the iterations of the step.
#[divan::bench(args = [5, 10])]
fn robust_step_of_1_ms(bencher: Bencher<'_, '_>, elements: usize) {
    let (mut simulation, commands) = pulled(options(Method::Robust, elements));
    bencher.bench_local(move || simulation.step(&commands, 1e-3).unwrap().diagnostics.iterations);
}
