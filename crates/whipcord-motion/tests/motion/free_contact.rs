//! A robot whose base nothing holds, among obstacles: against the laws of mechanics.

use whipcord::{Case, Form, LoadFrame, Loads, Obstacle, Pose, Twist, UnitQuaternion, Vec3};
use whipcord_motion::{Commands, Damping, Initial, Method, MotionOptions, Simulation, State};

use super::robots::{paper, rod, straight};

/// A rotation that turns the axis z, the normal of a half-space, to this direction.
pub(super) fn facing(normal: Vec3) -> UnitQuaternion {
    let axis = Vec3::Z.cross(normal);
    let angle = axis.norm().atan2(normal.z);
    UnitQuaternion::exp(axis * (angle / axis.norm()))
}

/// A half-space whose surface goes through a point.
fn half_space(position: Vec3, normal: Vec3, friction: f64) -> Obstacle {
    let pose = Pose { position, rotation: facing(normal) };
    Obstacle { name: "surface".to_owned(), form: Form::HalfSpace, pose, friction, movable: None }
}

/// Momentum in kg·m/s, in the world.
fn momentum(simulation: &Simulation) -> Vec3 {
    let state = simulation.state();
    let nodes = simulation.masses().zip(&state.velocities).zip(&state.poses);
    nodes.fold(Vec3::ZERO, |sum, ((mass, velocity), pose)| {
        sum + pose.rotation.rotate(velocity.linear) * mass
    })
}

fn pushes(state: &State) -> Vec3 {
    state.contacts.iter().fold(Vec3::ZERO, |sum, contact| {
        sum + contact.normal * contact.force.unwrap() + contact.friction.unwrap()
    })
}

fn options(method: Method) -> MotionOptions {
    MotionOptions {
        initial: Initial::Rest,
        damping: Damping::Time(0.01),
        has_free_base: true,
        method,
        ..MotionOptions::default()
    }
}

/// A rod that falls on a floor bounces and lies there, and nothing has gained energy.
#[test]
fn a_free_rod_falls_on_a_floor_and_lies_there() {
    let robot = rod(0.4, 6e-3, 5e8, 0.3, 2000.0, vec![]);
    let gravity = Vec3::new(-9.81, 0.0, 0.0);
    for dt in [5e-3_f64, 1e-2] {
        for method in [Method::Accurate, Method::Robust] {
            for friction in [0.0, 0.4] {
                // The rod is tilted, so that one end comes first.
                let rotation = UnitQuaternion::exp(Vec3::Y * 0.15);
                let base = Pose { position: Vec3::ZERO, rotation };
                let floor = half_space(Vec3::X * -0.03, Vec3::X, friction);
                let loads =
                    Loads { frame: LoadFrame::World, gravity: Some(gravity), ..Loads::default() };
                let case = Case { base, obstacles: vec![floor], loads, ..Case::default() };
                let name = format!("{dt} {method:?} {friction}");
                let mut simulation = Simulation::new(&robot, &case, options(method)).unwrap();
                let mut greatest = 0.0_f64;
                for _ in 0..(1.5 / dt).round() as usize {
                    let state = simulation.step(&Commands::default(), dt).unwrap();
                    let lowest = state.poses.iter().map(|of| of.position.x).fold(1.0, f64::min);
                    assert!(lowest > -0.027 - 2e-5, "{name}: {lowest}");
                    greatest = greatest.max(state.energy.defect());
                }
                let state = simulation.state();
                // It lies flat, but for the depth that is admitted and mended.
                let fallen = -state.energy.gravity;
                let fastest =
                    state.velocities.iter().map(|of| of.linear.norm()).fold(0.0, f64::max);
                let highest = state.poses.iter().map(|of| of.position.x).fold(-1.0, f64::max);
                assert!(state.energy.kinetic < 3e-3 * fallen && fastest < 0.2, "{name}");
                assert!(highest < -0.0269, "{name}: {highest}");
                assert!(
                    greatest < 2e-3 * fallen && state.energy.contacts < 0.0,
                    "{name}: {greatest}"
                );
            }
        }
    }
}

/// The momentum changes by the impulses of obstacles and weight, in the steps of the motion.
#[test]
fn the_momentum_changes_by_the_impulse_of_the_obstacles() {
    let robot = rod(0.4, 6e-3, 5e8, 0.3, 2000.0, vec![]);
    let mut options = options(Method::Robust);
    let wall = half_space(Vec3::Y * 0.05, Vec3::new(0.0, -1.0, 0.0), 0.0);
    // Tilted, so that one end comes first.
    let base = Pose { position: Vec3::ZERO, rotation: UnitQuaternion::exp(Vec3::X * 0.1) };
    let case = Case { base, obstacles: vec![wall], ..Case::default() };
    let start = Simulation::new(&robot, &case, options.clone()).unwrap().state().start();
    let mut thrown = start.clone();
    for velocity in &mut thrown.velocities {
        let linear = base.rotation.conjugate().rotate(Vec3::new(0.3, 1.0, 0.0));
        *velocity = Twist { linear, angular: Vec3::ZERO };
    }
    options.initial = Initial::State(Box::new(thrown));
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let before = momentum(&simulation);
    let energy = simulation.state().energy.kinetic;
    let mut touched = 0;
    for _ in 0..40 {
        let state = simulation.step(&Commands::default(), 5e-3).unwrap();
        touched += usize::from(!state.contacts.is_empty());
        assert!(state.energy.defect() < 1e-3 * energy, "{:?}", state.energy);
    }
    let after = momentum(&simulation);
    assert!(touched > 0);
    // Along a wall without friction nothing changes it; it turns back from it, no faster than it came.
    let mass: f64 = simulation.masses().sum();
    assert!((after.x - before.x).abs() < 2e-3 * mass && after.z.abs() < 2e-3 * mass, "{after:?}");
    assert!(after.y < 1e-3 * mass && after.y > -before.y, "{after:?} {before:?}");
    let state = simulation.state();
    assert!(state.energy.kinetic + state.energy.elastic <= energy * (1.0 + 1e-6));
}

/// A robot with cables that is pulled while it lies on a floor comes to rest there: the floor carries its weight.
#[test]
fn a_free_robot_with_disks_moves_on_a_floor() {
    let robot = paper(vec![straight("a", 0.0, 0.008)]);
    let loads = Loads { gravity: Some(Vec3::new(-9.81, 0.0, 0.0)), ..Loads::default() };
    let floor = half_space(Vec3::X * -0.012, Vec3::X, 0.3);
    let case = Case { obstacles: vec![floor], loads, ..Case::with_tensions(&[0.0]) };
    for dt in [2e-3_f64, 1e-2] {
        let mut simulation = Simulation::new(&robot, &case, options(Method::Accurate)).unwrap();
        let weight = simulation.masses().sum::<f64>() * 9.81;
        let steps = (1.5 / dt).round() as usize;
        for k in 0..steps {
            let tension = if (steps / 4..steps / 2).contains(&k) { 2.0 } else { 0.0 };
            simulation.step(&Commands::tensions(&[tension]), dt).unwrap();
        }
        let force = pushes(simulation.state());
        assert!((force - Vec3::X * weight).norm() < 1e-5 * weight, "{force:?} {weight}");
        let energy = simulation.state().energy;
        assert!(energy.kinetic < 1e-15 && energy.defect() < 0.0, "{energy:?}");
    }
}
