//! Motors with inertia under their position loops, against closed forms and integrations of the equations of masses and springs in this file.

use core::f64::consts::{PI, TAU};

use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Loads, Model, ModelKind, Motor, MotorDynamics,
    MotorLimits, PointMass, Robot, Routing, Statics as _, Stations, Stiffness,
};
use whipcord_motion::{
    Commands, Course, Damping, Initial, Method, MotionError, MotionOptions, Simulation,
};

use super::robots::{rod, straight};

/// Length of the rod that stretches in m, its stiffness as a spring in N/m, the mass at its tip in kg.
const LENGTH: f64 = 0.2;
const SPRING: f64 = 500.0;
const LOAD: f64 = 0.4;
/// Of the drive: stiffness in N/m, pretension in N.
const DRIVE: f64 = 300.0;
const PRETENSION: f64 = 20.0;

/// A light rod that only stretches, with a mass at its tip and a cable along its axis that a motor pulls.
fn spring_and_mass(motor: Motor) -> (Robot, Case) {
    let bending = 1e3;
    let backbone = Backbone {
        stiffness: Some(Stiffness::diagonal([1e8; 2], SPRING * LENGTH, [bending; 2], bending)),
        linear_density: Some(1e-6.into()),
        ..Backbone::new(LENGTH)
    };
    let cable = Cable::new("axis", Routing::Straight { angle: 0.0, radius: 0.0 });
    let motor = Motor { stiffness: Some(DRIVE), pretension: PRETENSION, ..motor };
    let robot = Robot::new(backbone, Disks::none(LENGTH), vec![cable])
        .and_then(|robot| robot.with_motors(vec![motor]))
        .unwrap();
    let masses = vec![PointMass { at: LENGTH, mass: LOAD }];
    let case = Case { loads: Loads { masses, ..Loads::default() }, ..Case::with_tensions(&[0.0]) };
    (robot, case)
}

fn told(course: Course) -> Commands {
    Commands { motors: vec![Some(course)], ..Commands::tensions(&[0.0]) }
}

fn step_to(value: f64) -> Course {
    Course::table(vec![0.0, 0.0], vec![0.0, value]).unwrap()
}

fn options() -> MotionOptions {
    MotionOptions { elements: 1, method: Method::Robust, ..MotionOptions::default() }
}

/// Accelerations of motor and load for their positions and velocities: `m ẍ = F − d ẋ − τ`, `M z̈ = −K z − τ`, `τ = T₀ + k (x + z)`. The loop gives
/// `F = P (s − x) − D ẋ + I ∫(s − x)`.
#[derive(Clone, Copy)]
struct Masses {
    inertia: f64,
    dynamics: MotorDynamics,
    set_point: f64,
}

impl Masses {
    /// Rates of `[x, ẋ, ∫, z, ż]`.
    fn rates(&self, [x, u, integral, z, w]: [f64; 5]) -> [f64; 5] {
        let MotorDynamics { damping, proportional, derivative, integral: gain, .. } = self.dynamics;
        let tension = PRETENSION + DRIVE * (x + z);
        let error = self.set_point - x;
        let force = proportional * error - (derivative + damping) * u + gain * integral;
        [u, (force - tension) / self.inertia, error, w, (-SPRING * z - tension) / LOAD]
    }

    /// At rest for a set-point of zero.
    fn at_rest(&self) -> [f64; 5] {
        let MotorDynamics { proportional: p, integral: gain, .. } = self.dynamics;
        if gain > 0.0 {
            let z = -PRETENSION / (DRIVE + SPRING);
            return [0.0, 0.0, (PRETENSION + DRIVE * z) / gain, z, 0.0];
        }
        // x = −τ/P, z = −τ/K, τ = T₀ + k (x + z).
        let tension = PRETENSION / (1.0 + DRIVE / p + DRIVE / SPRING);
        [-tension / p, 0.0, 0.0, -tension / SPRING, 0.0]
    }

    /// The state at a time, by the Runge–Kutta method of order 4 in steps of 10 µs.
    fn at(&self, time: f64) -> [f64; 5] {
        let steps = (time / 1e-5).round() as usize;
        let h = 1e-5;
        let mut y = self.at_rest();
        let ahead = |y: &[f64; 5], k: &[f64; 5], f: f64| core::array::from_fn(|i| y[i] + f * k[i]);
        for _ in 0..steps {
            let a = self.rates(y);
            let b = self.rates(ahead(&y, &a, 0.5 * h));
            let c = self.rates(ahead(&y, &b, 0.5 * h));
            let d = self.rates(ahead(&y, &c, h));
            y = core::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        y
    }
}

/// Motor and load as two masses on springs, without damping: both natural vibrations, in closed form.
#[test]
fn two_masses_on_springs() {
    let (mass, proportional, set) = (0.1, 200.0, 5e-3);
    let dynamics = MotorDynamics::new(mass, proportional);
    let motor = Motor { dynamics: Some(dynamics), ..Motor::linear("drive", [(0, 1.0)]) };
    let (robot, case) = spring_and_mass(motor);
    let commands = told(step_to(set));
    let masses = Masses { inertia: mass, dynamics, set_point: 0.0 };
    let [x0, _, _, z0, _] = masses.at_rest();
    let [x1, _, _, z1, _] = {
        let tension = (PRETENSION + DRIVE * set) / (1.0 + DRIVE / proportional + DRIVE / SPRING);
        [set - tension / proportional, 0.0, 0.0, -tension / SPRING, 0.0]
    };
    // The eigenvectors of [a b; c d], about the new state of rest.
    let (a, b) = ((proportional + DRIVE) / mass, DRIVE / mass);
    let (c, d) = (DRIVE / LOAD, (SPRING + DRIVE) / LOAD);
    let root = (0.25 * (a - d).powi(2) + b * c).sqrt();
    let squares = [0.5 * (a + d) - root, 0.5 * (a + d) + root];
    let shapes = squares.map(|square| [1.0, (square - a) / b]);
    let (dx, dz) = (x0 - x1, z0 - z1);
    let determinant = shapes[1][1] - shapes[0][1];
    let parts = [(dx * shapes[1][1] - dz) / determinant, (dz - dx * shapes[0][1]) / determinant];
    let exact = |t: f64| {
        let mut at = [x1, z1];
        for k in 0..2 {
            for (at, shape) in at.iter_mut().zip(shapes[k]) {
                *at += parts[k] * shape * (squares[k].sqrt() * t).cos();
            }
        }
        at
    };
    let mut errors = Vec::new();
    for steps in [1000, 2000] {
        let dt = 0.5 / f64::from(steps);
        let mut simulation =
            Simulation::with_commands(&robot, &case, &commands, options()).unwrap();
        let motor = simulation.state().motors[0];
        assert!((motor.position - x0).abs() < 1e-9 && motor.velocity == 0.0);
        assert!((motor.effort - simulation.state().cables[0].tension).abs() < 1e-9);
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            let state = simulation.step(&commands, dt).unwrap();
            let [x, z] = exact(state.time);
            worst = worst.max((state.motors[0].position - x).abs());
            worst = worst.max((state.tip().position.z - LENGTH - z).abs());
            assert_eq!(state.diagnostics.method, Method::Robust);
            let energy = &state.energy;
            let balance = energy.kinetic + energy.elastic + energy.motors + energy.stretch
                - energy.initial
                - energy.control;
            assert!((balance - energy.defect()).abs() < 1e-15);
            assert!(energy.cables == 0.0 && energy.defect().abs() < 0.02 * energy.total());
        }
        errors.push(worst);
    }
    assert!(errors[1] < 2e-3 * dx.abs(), "{errors:?}");
    let order = (errors[0] / errors[1]).log2();
    assert!((1.8..2.3).contains(&order), "{order}");
}

/// A loop with all gains and a motor with friction, behind a gear, against the integration in this file.
#[test]
fn the_step_response_of_a_loop() {
    let (radius, ratio, inertia) = (0.02, 5.0, 2e-6);
    // The same in the motion of the cable: torque times n/r, angle times r/n.
    let arm = radius / ratio;
    let numbers = MotorDynamics {
        damping: 8e-6,
        derivative: 4e-5,
        integral: 0.03,
        ..MotorDynamics::new(inertia, 5e-3)
    };
    let linear = MotorDynamics {
        inertia: inertia / (arm * arm),
        damping: numbers.damping / (arm * arm),
        proportional: numbers.proportional / (arm * arm),
        derivative: numbers.derivative / (arm * arm),
        integral: numbers.integral / (arm * arm),
    };
    let angle = 0.8;
    for integral in [0.0, 1.0] {
        let scaled = |of: MotorDynamics| MotorDynamics { integral: of.integral * integral, ..of };
        let spool = Motor::spool("spool", [(0, radius)]);
        let motor = Motor {
            drive: whipcord::Drive::Spool { gear_ratio: ratio },
            dynamics: Some(scaled(numbers)),
            offset: 0.3,
            ..spool
        };
        let (robot, case) = spring_and_mass(motor);
        let commands = told(Course::table(vec![0.0, 0.0], vec![0.3, 0.3 + angle]).unwrap());
        let masses =
            Masses { inertia: linear.inertia, dynamics: scaled(linear), set_point: angle * arm };
        let mut simulation =
            Simulation::with_commands(&robot, &case, &commands, options()).unwrap();
        for k in 1..=10 {
            let exact = masses.at(0.05 * f64::from(k));
            for _ in 0..500 {
                simulation.step(&commands, 1e-4).unwrap();
            }
            let state = simulation.state();
            let motor = state.motors[0];
            let travel = (motor.position - 0.3) * arm;
            assert!((travel - exact[0]).abs() < 3e-3 * angle * arm, "{travel} {exact:?}");
            assert!((motor.velocity * arm - exact[1]).abs() < 3e-3, "{exact:?}");
            assert!((state.tip().position.z - LENGTH - exact[3]).abs() < 1e-5, "{exact:?}");
            let tension = PRETENSION + DRIVE * (exact[0] + exact[3]);
            assert!((state.cables[0].tension - tension).abs() < 3e-3 * tension);
            assert!((state.motor_outputs[0] * radius - travel).abs() < 1e-12);
        }
        // With an integral the motor ends where it is told, else short of it by what holds the cable.
        for _ in 0..3000 {
            simulation.step(&commands, 0.01).unwrap();
        }
        let motor = simulation.state().motors[0];
        let sag = 0.3 + angle - motor.position;
        let expected = if integral == 0.0 { motor.effort / numbers.proportional } else { 0.0 };
        assert!((sag - expected).abs() < 1e-4 * sag.abs().max(1.0), "{sag} {expected}");
        let held = simulation.state().cables[0].tension * arm;
        assert!((motor.effort / held - 1.0).abs() < 1e-3);
    }
}

/// While its torque is at the limit a motor accelerates by it, and the integral of the error stands still.
#[test]
fn a_motor_at_its_limit() {
    let dynamics =
        MotorDynamics { integral: 5.0, derivative: 0.15, ..MotorDynamics::new(1e-3, 2.0) };
    let limit = 0.1;
    let motor = Motor {
        dynamics: Some(dynamics),
        limits: MotorLimits { effort: Some(limit), ..MotorLimits::default() },
        ..Motor::spool("spool", [(0, 1e-6)])
    };
    let (robot, case) = spring_and_mass(motor);
    let commands = told(step_to(2.0));
    let mut simulation = Simulation::with_commands(&robot, &case, &commands, options()).unwrap();
    for _ in 0..100 {
        let state = simulation.step(&commands, 1e-3).unwrap();
        let motor = state.motors[0];
        let exact = 0.5 * limit / 1e-3 * state.time.powi(2);
        // The two steps of order 1 behind the jump, of which the first still integrates, are off by ½ a h² each.
        assert!((motor.position - exact).abs() < 1.5e-4, "{motor:?} {exact}");
        assert!((motor.effort - limit).abs() < 1e-12 && motor.integral.abs() < 2.5e-3);
    }
    let mut greatest = 0.0_f64;
    for _ in 0..2000 {
        let state = simulation.step(&commands, 1e-3).unwrap();
        greatest = greatest.max(state.motors[0].position);
        assert!(state.motors[0].effort.abs() <= limit);
    }
    let end = simulation.state().motors[0].position;
    assert!((end - 2.0).abs() < 1e-2 && greatest < 2.5, "{end} {greatest}");

    // What it cannot hold is no equilibrium to start from.
    let weak = Motor {
        dynamics: Some(dynamics),
        limits: MotorLimits { effort: Some(limit), ..MotorLimits::default() },
        ..Motor::spool("spool", [(0, 0.05)])
    };
    let (robot, case) = spring_and_mass(weak);
    let refused = Simulation::with_commands(&robot, &case, &told(0.0.into()), options());
    let Err(MotionError::MotorOverload { name, needed, .. }) = refused else {
        panic!("a motor that is too weak must be refused");
    };
    assert!(name == "spool" && needed > limit);
    let rest = MotionOptions { initial: Initial::Rest, ..options() };
    assert!(Simulation::with_commands(&robot, &case, &told(0.0.into()), rest).is_ok());
}

/// Antagonists on one shaft: the motion starts, and ends, in the equilibrium of the statics at the angle that the loop leaves.
#[test]
fn antagonists_on_one_shaft() {
    let cables = vec![straight("a", 0.0, 0.01), straight("b", PI, 0.01)];
    let dynamics = MotorDynamics { derivative: 4e-3, ..MotorDynamics::new(2e-5, 0.05) };
    let motor = Motor {
        stiffness: Some(2e3),
        pretension: 3.0,
        dynamics: Some(dynamics),
        ..Motor::spool("bend", [(0, 0.01), (1, -0.01)])
    };
    let robot = rod(0.2, 4e-3, 1e9, 0.3, 1200.0, cables).with_motors(vec![motor.clone()]).unwrap();
    let case = Case::with_tensions(&[0.0, 0.0]);
    let course = Course::table(vec![0.1, 0.3], vec![0.4, 1.2]).unwrap();
    let commands = Commands { motors: vec![Some(course)], ..Commands::tensions(&[0.0, 0.0]) };
    let options =
        MotionOptions { damping: Damping::Time(5e-3), elements: 10, ..MotionOptions::default() };
    let mut simulation = Simulation::with_commands(&robot, &case, &commands, options).unwrap();
    for set_point in [0.4, 1.2] {
        let state = simulation.state().clone();
        let motor = state.motors[0];
        let torque = 0.01 * (state.cables[0].tension - state.cables[1].tension);
        assert!((motor.effort - torque).abs() < 1e-7, "{motor:?} {torque}");
        assert!((set_point - motor.position - torque / 0.05).abs() < 1e-5);
        assert!(motor.position < set_point - 0.02);
        // The same angle as the command of the statics.
        let held = Case::with_motors(&robot, &[motor.position]).unwrap();
        let statics = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::default())
            .with_tolerance(1e-10)
            .solve(&robot, &held)
            .unwrap();
        for (of, cable) in state.cables.iter().zip(&statics.cables) {
            let tension = cable.tension.unwrap();
            assert!((of.tension - tension).abs() < 1e-4 * tension, "{} {tension}", of.tension);
        }
        let apart = (state.tip().position - statics.shape.tip().position).norm();
        assert!(apart < 1e-5, "{apart:e}");
        for _ in 0..300 {
            simulation.step(&commands, 0.01).unwrap();
        }
    }
}

/// A motor goes on from a state that was kept as it would have without a break, and rates behind a break are found again.
#[test]
fn a_motion_goes_on_from_a_state_with_motors() {
    let dynamics =
        MotorDynamics { integral: 50.0, derivative: 4.0, ..MotorDynamics::new(0.1, 200.0) };
    let motor = Motor { dynamics: Some(dynamics), ..Motor::linear("drive", [(0, 1.0)]) };
    let (robot, case) = spring_and_mass(motor);
    let commands = told(step_to(5e-3));
    let mut simulation = Simulation::with_commands(&robot, &case, &commands, options()).unwrap();
    for _ in 0..1000 {
        simulation.step(&commands, 1e-4).unwrap();
    }
    let start = simulation.state().start();
    let held = told(5e-3.into());
    let options = MotionOptions { initial: Initial::State(Box::new(start)), ..options() };
    let mut other = Simulation::with_commands(&robot, &case, &held, options).unwrap();
    for _ in 0..1000 {
        simulation.step(&commands, 1e-4).unwrap();
        other.step(&held, 1e-4).unwrap();
    }
    let [a, b] = [&simulation, &other].map(|of| of.state().motors[0]);
    assert!((a.position - b.position).abs() < 1e-6, "{a:?} {b:?}");
    assert!((a.integral - b.integral).abs() < 1e-6 && (a.velocity - b.velocity).abs() < 1e-3);
}

/// With a stiff loop on a light motor the motion is that of a motor without inertia, whatever the step.
#[test]
fn a_stiff_loop_is_a_motor_without_inertia() {
    let cables: Vec<Cable> =
        (0..3).map(|i| straight(&format!("{i}"), TAU * f64::from(i) / 3.0, 0.01)).collect();
    let motors = |dynamics: Option<MotorDynamics>| {
        let of = |i: usize| Motor {
            stiffness: Some(3e3),
            dynamics,
            ..Motor::spool(format!("{i}"), [(i, 0.01)])
        };
        (0..3).map(of).collect::<Vec<_>>()
    };
    let robot = rod(0.2, 4e-3, 1e9, 0.3, 1200.0, cables);
    let course = |end: f64| Some(Course::table(vec![0.0, 0.2], vec![0.0, end]).unwrap());
    let commands = Commands {
        motors: vec![course(0.9), course(-0.3), course(-0.2)],
        ..Commands::tensions(&[0.0; 3])
    };
    let case = Case::with_tensions(&[0.0; 3]);
    for dt in [1e-3, 5e-3, 2e-2] {
        let tip = |dynamics: Option<MotorDynamics>| {
            let robot = robot.clone().with_motors(motors(dynamics)).unwrap();
            let options =
                MotionOptions { damping: Damping::Time(2e-3), ..MotionOptions::default() };
            let mut simulation =
                Simulation::with_commands(&robot, &case, &commands, options).unwrap();
            for _ in 0..(0.4 / dt) as usize {
                let state = simulation.step(&commands, dt).unwrap();
                assert!(state.cables.iter().all(|of| of.tension >= 0.0 && of.slack >= 0.0));
            }
            simulation.state().tip().position
        };
        let stiff = MotorDynamics { derivative: 1.0, ..MotorDynamics::new(1e-7, 1e3) };
        let apart = (tip(None) - tip(Some(stiff))).norm();
        assert!(apart < 2e-4, "{dt}: {apart:e}");
    }
}

/// What motors with inertia cannot take is refused by name.
#[test]
fn what_motors_with_inertia_cannot_take() {
    let dynamics = Some(MotorDynamics::new(0.1, 200.0));
    let linear = || Motor::linear("drive", [(0, 1.0)]);
    let (robot, case) = spring_and_mass(Motor { backlash: 1e-3, dynamics, ..linear() });
    let commands = told(0.0.into());
    let refused = Simulation::with_commands(&robot, &case, &commands, options()).unwrap_err();
    assert!(refused.to_string().contains("motors[0].backlash"), "{refused}");
    for wrong in [
        MotorDynamics::new(0.0, 1.0),
        MotorDynamics::new(1.0, 0.0),
        MotorDynamics { damping: -1.0, ..MotorDynamics::new(1.0, 1.0) },
        MotorDynamics { integral: f64::NAN, ..MotorDynamics::new(1.0, 1.0) },
    ] {
        let motor = Motor { dynamics: Some(wrong), ..linear() };
        let cable = Cable::new("axis", Routing::Straight { angle: 0.0, radius: 0.0 });
        let robot = Robot::new(Backbone::new(0.2), Disks::none(0.2), vec![cable]).unwrap();
        assert!(robot.with_motors(vec![motor]).is_err(), "{wrong:?}");
    }
}
