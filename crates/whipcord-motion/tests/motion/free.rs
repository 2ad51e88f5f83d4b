//! A base that nothing holds.

use core::f64::consts::FRAC_PI_2;

use whipcord::{
    Backbone, Case, Disks, LoadFrame, Loads, ModelKind, PointLoad, Pose, Robot, Section, Stiffness,
    Twist, UnitQuaternion, Vec3,
};
use whipcord_motion::{
    BaseMotion, CableDrive, Commands, Course, Damping, Initial, LoadCourse, Method, MotionOptions,
    Simulation,
};

use super::robots::{helix, paper};

const LENGTH: f64 = 10.0;
/// Time in s at which the force and the moment end.
const END: f64 = 2.5;
const FORCE: f64 = 8.0;
const MOMENT: f64 = -80.0;

/// The flying rod of Simo and Vu-Quoc (*On the dynamics of flexible beams under large overall motions*, J. Appl. Mech. 53, 1986), in the plane: EA = GA = 10⁴,
/// EI = 500, a mass of 1 and a moment of inertia of 10 per length.
fn flying(elements: usize, method: Method) -> Simulation {
    let backbone = Backbone {
        // Its second moment over its area is 10.
        section: Some(Section::circle(160.0_f64.sqrt())),
        stiffness: Some(Stiffness::diagonal([1e4, 1e4], 1e4, [500.0, 500.0], 500.0)),
        linear_density: Some(1.0.into()),
        ..Backbone::new(LENGTH)
    };
    let robot = Robot::new(backbone, Disks::none(LENGTH), vec![]).unwrap();
    let turn = UnitQuaternion::exp(Vec3::Z * 0.8_f64.atan2(-0.6))
        * UnitQuaternion::exp(Vec3::Y * FRAC_PI_2);
    let frame = LoadFrame::World;
    let base = Pose { position: Vec3::X * 6.0, rotation: turn };
    let case = Case { base, loads: Loads { frame, ..Loads::default() }, ..Case::default() };
    let pushed =
        PointLoad { at: 0.0, force: Vec3::X * FORCE, moment: Vec3::Z * MOMENT, follower: false };
    let options = MotionOptions {
        has_free_base: true,
        elements,
        method,
        initial: Initial::Rest,
        iteration_tolerance: 1e-12,
        loads: vec![LoadCourse {
            loads: Loads { frame, points: vec![pushed], ..Loads::default() },
            factor: Course::table(vec![0.0, END, END, 20.0], vec![1.0, 1.0, 0.0, 0.0]).unwrap(),
        }],
        ..MotionOptions::default()
    };
    Simulation::new(&robot, &case, options).unwrap()
}

/// The same rod in the plane as a chain of `n` elements with an angle each, on a staggered grid, by the classical method of Runge and Kutta: both ends at a
/// time, with an error of second order in 1/n.
fn chain(n: usize, time: f64) -> [[f64; 2]; 2] {
    let h = LENGTH / n as f64;
    let mass = |k: usize| if k == 0 || k == n { 0.5 * h } else { h };
    // Places of the nodes and angles of the elements, then their rates.
    let size = 2 * (n + 1) + n;
    let mut y = vec![0.0; 2 * size];
    for k in 0..=n {
        let s = h * k as f64;
        (y[2 * k], y[2 * k + 1]) = (6.0 - 0.6 * s, 0.8 * s);
    }
    y[2 * (n + 1)..size].fill(0.8_f64.atan2(-0.6));
    let rates = |load: f64, y: &[f64]| {
        let mut f = vec![0.0; 2 * size];
        f[..size].copy_from_slice(&y[size..]);
        let (nodes, angles) = (&y[..2 * (n + 1)], &y[2 * (n + 1)..size]);
        let out = &mut f[size..];
        out[0] += FORCE * load;
        out[2 * (n + 1)] += MOMENT * load;
        for e in 0..n {
            let way = [nodes[2 * e + 2] - nodes[2 * e], nodes[2 * e + 3] - nodes[2 * e + 1]];
            let (sin, cos) = angles[e].sin_cos();
            let strain =
                [(cos * way[0] + sin * way[1]) / h - 1.0, (cos * way[1] - sin * way[0]) / h];
            let [a, b] = strain.map(|strain| 1e4 * strain);
            let force = [cos * a - sin * b, sin * a + cos * b];
            for i in 0..2 {
                out[2 * e + i] += force[i];
                out[2 * e + 2 + i] -= force[i];
            }
            out[2 * (n + 1) + e] += way[0] * force[1] - way[1] * force[0];
            if e + 1 < n {
                let moment = 500.0 * (angles[e + 1] - angles[e]) / h;
                out[2 * (n + 1) + e] += moment;
                out[2 * (n + 1) + e + 1] -= moment;
            }
        }
        for k in 0..=n {
            out[2 * k] /= mass(k);
            out[2 * k + 1] /= mass(k);
        }
        for angle in &mut out[2 * (n + 1)..] {
            *angle /= 10.0 * h;
        }
        f
    };
    let steps = 200 * n;
    // The load ends at the end of a step.
    for (load, duration) in [(1.0, END.min(time)), (0.0, (time - END).max(0.0))] {
        let dt = duration / steps as f64;
        let along = |y: &[f64], f: &[f64], t: f64| -> Vec<f64> {
            y.iter().zip(f).map(|(y, f)| y + t * f).collect()
        };
        for _ in 0..steps {
            let a = rates(load, &y);
            let b = rates(load, &along(&y, &a, 0.5 * dt));
            let c = rates(load, &along(&y, &b, 0.5 * dt));
            let d = rates(load, &along(&y, &c, dt));
            for (i, y) in y.iter_mut().enumerate() {
                *y += dt / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
    }
    [[y[0], y[1]], [y[2 * n], y[2 * n + 1]]]
}

fn ends(simulation: &Simulation) -> [Vec3; 2] {
    let poses = &simulation.state().poses;
    [poses[0].position, simulation.state().tip().position]
}

#[test]
fn a_flying_rod_against_a_chain() {
    for time in [2.0, 5.0] {
        let [coarse, fine] = [20, 40].map(|n| chain(n, time));
        let expected = [0, 1].map(|e| {
            let [x, y] = [0, 1].map(|i| fine[e][i] + (fine[e][i] - coarse[e][i]) / 3.0);
            Vec3::new(x, y, 0.0)
        });
        for (method, dt, limit) in [(Method::Accurate, 0.05, 1e-3), (Method::Robust, 0.005, 3e-3)] {
            let mut simulation = flying(10, method);
            for _ in 0..(time / dt).round() as usize {
                simulation.step(&Commands::default(), dt).unwrap();
            }
            let errors = [0, 1].map(|e| (ends(&simulation)[e] - expected[e]).norm() / LENGTH);
            println!("{time} s, {method:?}: {errors:?} {expected:?}");
            assert!(errors.iter().all(|error| *error < limit), "{time} {method:?}: {errors:?}");
        }
    }
}

/// Force and moment leave their impulses, which stay; and no energy comes from anywhere else.
#[test]
fn momentum_of_a_flying_rod() {
    let mut defects = Vec::new();
    for (elements, dt) in [(10, 0.05), (20, 0.025), (40, 0.0125)] {
        let mut simulation = flying(elements, Method::Accurate);
        let mut angular = Vec3::ZERO;
        let mut worst = [0.0_f64; 2];
        for k in 1..=(8.0 / dt) as usize {
            simulation.step(&Commands::default(), dt).unwrap();
            let time = simulation.state().time;
            let linear = simulation.momentum() - Vec3::X * (FORCE * time.min(END));
            worst[0] = worst[0].max(linear.norm() / (FORCE * END));
            if k == (END / dt).round() as usize {
                angular = simulation.angular_momentum();
            }
            if time > END {
                let change = (simulation.angular_momentum() - angular).norm();
                worst[1] = worst[1].max(change / angular.norm());
            }
        }
        let energy = simulation.state().energy;
        println!("{elements}: {worst:?}, {:.1e} of {}", energy.defect(), energy.loads);
        defects.push(worst);
    }
    for i in 0..2 {
        // Behind the jump of the load the order is 2.
        let [coarse, _, fine] = [0, 1, 2].map(|k: usize| defects[k][i]);
        assert!(fine < 1e-5 && fine < coarse / 8.0, "{defects:?}");
    }
}

/// In free fall nothing bends, and the base falls like a stone.
#[test]
fn free_fall() {
    let robot = paper(vec![helix()]);
    let gravity = Vec3::new(3.0, -9.0, 1.0);
    let loads = Loads { gravity: Some(gravity), ..Loads::default() };
    let case = Case { loads, ..Case::with_tensions(&[0.0]) };
    for method in [Method::Accurate, Method::Robust] {
        let options = MotionOptions {
            has_free_base: true,
            method,
            initial: Initial::Rest,
            damping: Damping::Time(1e-3),
            ..MotionOptions::default()
        };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let rest = simulation.state().poses.clone();
        for _ in 0..50 {
            simulation.step(&Commands::tensions(&[0.0]), 0.01).unwrap();
        }
        let state = simulation.state();
        // The first step of `robust` is one of Euler's rule.
        let limit = if method == Method::Robust { 1e-2 } else { 1e-9 };
        for (pose, rest) in state.poses.iter().zip(&rest) {
            let fallen = pose.position - rest.position - gravity * (0.5 * 0.25);
            assert!(fallen.norm() < limit, "{method:?}: {fallen:?}");
        }
        let shape = (state.poses[0].inverse() * state.tip()).position;
        assert!((shape - Vec3::Z * 0.18).norm() < 1e-9, "{shape:?}");
    }
}

/// A robot in space that winds up its own cable turns and moves as its momentum, which is none, lets it.
#[test]
fn a_robot_that_bends_itself_has_no_momentum() {
    let robot = paper(vec![helix()]);
    for by_length in [false, true] {
        let mut worst = Vec::new();
        for (elements, dt) in [(10, 4e-3), (20, 2e-3)] {
            let options = MotionOptions {
                has_free_base: true,
                elements,
                damping: Damping::Time(3.5e-3),
                initial: Initial::Rest,
                iteration_tolerance: 1e-12,
                ..MotionOptions::default()
            };
            let times: Vec<f64> = (0..=50).map(|k| 0.004 * f64::from(k)).collect();
            let most = if by_length { 5e-3 } else { 3.0 };
            let values = times.iter().map(|t| most * (1.0 - (t * 15.707963).cos()) / 2.0).collect();
            let course = Course::table(times, values).unwrap();
            let drive = if by_length {
                CableDrive::Shortening(course)
            } else {
                CableDrive::Tension(course)
            };
            let commands = Commands::new(vec![drive]);
            let mut simulation =
                Simulation::new(&robot, &Case::with_tensions(&[0.0]), options).unwrap();
            let mass: f64 = simulation.masses().sum();
            let mut greatest = [0.0_f64; 2];
            for _ in 0..(0.2 / dt) as usize {
                simulation.step(&commands, dt).unwrap();
                greatest[0] = greatest[0].max(simulation.momentum().norm() / mass);
                greatest[1] = greatest[1].max(simulation.angular_momentum().norm() / (mass * 0.18));
            }
            let turned = simulation.state().poses[0].rotation.log().norm();
            println!("{by_length} {elements}: {greatest:?} m/s, {turned:.3} rad");
            assert!(turned > 0.1);
            worst.push(greatest);
        }
        for i in 0..2 {
            assert!(worst[0][i] < 5e-7 && worst[1][i] < 5e-7, "{worst:?}");
        }
    }
}

#[test]
fn what_a_free_base_cannot_take_is_refused() {
    let robot = paper(vec![helix()]);
    let case = Case::with_tensions(&[1.0]);
    let options = MotionOptions { has_free_base: true, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &case, options.clone()).unwrap();
    let commands = Commands::tensions(&[1.0]);
    let other = MotionOptions { base: Some(Default::default()), ..options };
    let error = Simulation::new(&robot, &case, other).unwrap_err();
    assert!(error.to_string().contains("motion.base"), "{error}");
    // Let go from an equilibrium without loads it stays.
    let tip = simulation.state().tip().position;
    for _ in 0..10 {
        simulation.step(&commands, 0.01).unwrap();
    }
    assert!((simulation.state().tip().position - tip).norm() < 1e-9);
}

/// A robot that nothing holds and nothing damps turns and vibrates by `energy` without gain or loss, cables included, at every step; its momentum stays with the square of the step.
#[test]
fn a_free_robot_keeps_its_energy() {
    for (model, tension) in
        [(ModelKind::Cosserat, 2.0), (ModelKind::CosseratDisks, 2.0), (ModelKind::Cosserat, 0.0)]
    {
        let robot = paper(vec![helix()]);
        let case = Case::with_tensions(&[tension]);
        let rest = MotionOptions {
            model,
            method: Method::Energy,
            has_free_base: true,
            initial: Initial::Rest,
            ..MotionOptions::default()
        };
        let mut start = Simulation::new(&robot, &case, rest.clone()).unwrap().state().start();
        for velocity in &mut start.velocities {
            *velocity =
                Twist { linear: Vec3::new(0.3, -0.2, 0.1), angular: Vec3::new(2.0, 1.0, 3.0) };
        }
        for dt in [1e-3, 5e-3, 1e-2, 2e-2_f64] {
            let initial = Initial::State(Box::new(start.clone()));
            let options = MotionOptions { initial, ..rest.clone() };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let momentum = |simulation: &Simulation| {
                let nodes = simulation.masses().zip(&simulation.state().velocities);
                let nodes = nodes.zip(&simulation.state().poses);
                nodes.fold(Vec3::ZERO, |sum, ((mass, velocity), pose)| {
                    sum + pose.rotation.rotate(velocity.linear) * mass
                })
            };
            let before = momentum(&simulation);
            let (mut worst, mut moved) = (0.0_f64, 0.0_f64);
            let mut scale = simulation.state().energy.total();
            for _ in 0..(1.0 / dt).round() as usize {
                let energy = simulation.step(&Commands::tensions(&[tension]), dt).unwrap().energy;
                scale = scale.max(energy.cables.abs());
                worst = worst.max(energy.defect().abs());
                moved = moved.max((momentum(&simulation) - before).norm() / before.norm());
            }
            // Vibrations that the steps do not follow turn the sections by other angles than their velocities say.
            assert!(tension > 0.0 || moved < 2e3 * dt * dt, "{model:?} {dt}: {moved:e}");
            let bound = if model == ModelKind::Cosserat { 1e-12 } else { 3e-12 };
            assert!(worst < bound * scale, "{model:?} {dt}: {:e}", worst / scale);
            assert!(simulation.state().energy.elastic > 1e-6 * scale);
        }
    }
}

/// A base that is led gives what the robot gains, up to the error of the elements; the motion is that of fine steps with the square of the step.
#[test]
fn energy_balances_with_the_work_of_a_base_that_is_led() {
    let robot = paper(vec![helix()]);
    let gravity = Loads { gravity: Some(Vec3::new(0.0, -9.81, 0.0)), ..Loads::default() };
    for is_free in [false, true] {
        let case = Case { loads: gravity.clone(), ..Case::with_tensions(&[1.0]) };
        let run = |method: Method, dt: f64| {
            let course = |a: f64, b: f64| Course::table(vec![0.0, 0.4], vec![a, b]).unwrap();
            let mut base = BaseMotion::default();
            base.velocity[0] = course(0.0, 0.5);
            base.angular_velocity[1] = course(0.0, -3.0);
            let options = MotionOptions {
                method,
                has_free_base: is_free,
                damping: Damping::Time(5e-3),
                base: (!is_free).then_some(base),
                ..MotionOptions::default()
            };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let mut worst = 0.0_f64;
            for _ in 0..(0.4 / dt).round() as usize {
                let state = simulation.step(&Commands::tensions(&[1.0]), dt).unwrap();
                worst = worst.max(state.energy.defect().abs());
            }
            (simulation.state().tip().position, worst, simulation.state().energy)
        };
        let (fine, ..) = run(Method::Accurate, 5e-4);
        let runs = [4e-3, 2e-3, 1e-3].map(|dt| run(Method::Energy, dt));
        let apart = runs.map(|(tip, ..)| (tip - fine).norm());
        let defects = runs.map(|(_, worst, _)| worst);
        assert!(apart[1] < 0.4 * apart[0] && apart[2] < 0.4 * apart[1], "{apart:?}");
        // What is left is that of the elements.
        let energy = runs[2].2;
        let given = energy.base.abs().max(energy.gravity.abs());
        assert!(defects.iter().all(|defect| *defect < 1e-4 * given), "{defects:?} {given}");
    }
}
