//! What must be the same: the statics, momentum, time backwards, a robot that is turned.

use whipcord::{
    Case, DistributedLoad, LoadFrame, Loads, Model, ModelKind, PointLoad, Pose, Statics, Stations,
    Twist, Vec3,
};
use whipcord_motion::{
    BaseMotion, Commands, Course, Damping, Drag, Initial, Method, MotionError, MotionOptions,
    Simulation, Start,
};

use super::robots::{helix, paper, rod, straight};

fn loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(0.0, 9.81, 0.0)),
        tip_force: Vec3::new(0.05, 0.0, 0.1),
        tip_moment: Vec3::new(0.0, 0.0, 2e-3),
        tip_follower: true,
        points: vec![PointLoad {
            at: 0.07,
            force: Vec3::new(0.1, 0.05, 0.0),
            moment: Vec3::new(0.0, 1e-3, 0.0),
            follower: false,
        }],
        distributed: vec![DistributedLoad::uniform(0.18, Vec3::new(0.3, 0.0, 0.0))],
        ..Loads::default()
    }
}

/// The equilibrium to start from, and the one in which a damped motion ends, are those of the statics.
#[test]
fn the_statics_is_the_limit() {
    let robot = paper(vec![helix(), straight("b", 2.0, 0.008)]);
    let case = Case { loads: loads(), ..Case::with_tensions(&[2.0, 0.5]) };
    let solution = Model::new(ModelKind::Cosserat, Stations::Disks, Default::default())
        .with_tolerance(1e-10)
        .solve(&robot, &case)
        .unwrap();
    let tip = solution.shape.poses.last().unwrap().position;
    for (elements, limit) in
        [(5, 1e-5 * 0.18), (10, 1e-6 * 0.18), (20, 1e-7 * 0.18), (40, 5e-9 * 0.18)]
    {
        let options = MotionOptions { elements, ..MotionOptions::default() };
        let simulation = Simulation::new(&robot, &case, options).unwrap();
        let error = (simulation.state().tip().position - tip).norm();
        assert!(error < limit, "{elements}: {error:e}");
    }
    let options = MotionOptions {
        initial: Initial::Rest,
        damping: Damping::Time(0.02),
        drag: Drag { across: 0.5, along: 0.2 },
        elements: 10,
        ..MotionOptions::default()
    };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    for _ in 0..300 {
        simulation.step(&Commands::of_case(&robot, &case), 0.02).unwrap();
    }
    let error = (simulation.state().tip().position - tip).norm();
    assert!(error < 1e-6 * 0.18, "{error:e}");
}

/// The momentum changes by the impulse of gravity and of the base.
#[test]
fn the_base_gives_what_the_momentum_gains() {
    let robot = paper(vec![helix()]);
    let gravity = Vec3::new(1.0, 9.81, 0.0);
    let loads = Loads { gravity: Some(gravity), ..Loads::default() };
    let case = Case { loads, ..Case::with_tensions(&[2.0]) };
    let options = MotionOptions {
        initial: Initial::Rest,
        damping: Damping::Time(2e-3),
        ..MotionOptions::default()
    };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let mass: f64 = simulation.masses().sum();
    let commands = Commands::of_case(&robot, &case);
    // Where the first vibrations have faded, so that the trapezoidal rule follows the force.
    for _ in 0..200 {
        simulation.step(&commands, 1e-3).unwrap();
    }
    let start = simulation.momentum();
    let mut impulse = Vec3::ZERO;
    let mut before = simulation.base_wrench().force;
    let dt = 2e-4;
    for _ in 0..500 {
        simulation.step(&commands, dt).unwrap();
        let after = simulation.base_wrench().force;
        impulse += (before + after) * (0.5 * dt) + gravity * (mass * dt);
        before = after;
    }
    let gained = simulation.momentum() - start;
    assert!((gained - impulse).norm() < 1e-4 * gained.norm().max(1e-3), "{gained:?} {impulse:?}");
    assert!(gained.norm() > 1e-3);
}

/// A motion without damping returns on its way when all velocities are turned round.
#[test]
fn the_motion_can_be_reversed() {
    let robot = paper(vec![helix()]);
    let loads = Loads { gravity: Some(Vec3::new(1.0, 9.81, 0.0)), ..Loads::default() };
    let case = Case { loads, ..Case::with_tensions(&[2.0]) };
    let options = MotionOptions {
        initial: Initial::Rest,
        method: Method::Energy,
        ..MotionOptions::default()
    };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let commands = Commands::of_case(&robot, &case);
    let start = simulation.state().tip().position;
    for _ in 0..100 {
        simulation.step(&commands, 2e-3).unwrap();
    }
    let mut state = simulation.state().clone();
    assert!((state.tip().position - start).norm() > 1e-3);
    for velocity in &mut state.velocities {
        *velocity = *velocity * -1.0;
    }
    state.has_rates = false;
    simulation.set_state(&state).unwrap();
    for _ in 0..100 {
        simulation.step(&commands, 2e-3).unwrap();
    }
    let back = (simulation.state().tip().position - start).norm();
    assert!(back < 1e-9, "{back:e}");
}

/// A robot whose base is turned and moved, with loads that are given in the frame of the base, moves in the same way.
#[test]
fn a_turned_base_turns_the_motion() {
    let robot = rod(0.3, 4e-3, 1e9, 0.3, 1200.0, vec![straight("a", 0.5, 0.01)]);
    let twist = Twist { linear: Vec3::new(0.1, -0.2, 0.5), angular: Vec3::new(1.0, 0.5, -2.0) };
    let base = Pose::exp(twist);
    let of_base = Loads { gravity: Some(Vec3::new(9.81, 0.0, 1.0)), ..Loads::default() };
    let of_world = Loads {
        frame: LoadFrame::World,
        gravity: Some(base.rotation.rotate(Vec3::new(9.81, 0.0, 1.0))),
        ..Loads::default()
    };
    let tip = |loads: Loads, base: Pose| {
        let case = Case { loads, base, ..Case::with_tensions(&[0.5]) };
        let mut simulation = Simulation::new(&robot, &case, MotionOptions::default()).unwrap();
        for _ in 0..20 {
            simulation.step(&Commands::tensions(&[1.5]), 5e-3).unwrap();
        }
        simulation.state().tip().position
    };
    let still = tip(of_base.clone(), Pose::IDENTITY);
    for loads in [of_base, of_world] {
        assert!((tip(loads, base) - base.transform(still)).norm() < 1e-8);
    }
}

/// A motion that is cut in two, the second part begun from the end of the first, is one motion.
#[test]
fn a_motion_goes_on_from_a_state_that_was_kept() {
    let robot = paper(vec![helix(), straight("b", 2.0, 0.008)]);
    let case = Case { loads: loads(), ..Case::with_tensions(&[2.0, 0.5]) };
    for (commands, method) in [
        (Commands::tensions(&[0.5, 1.0]), Method::Accurate),
        (Commands::shortenings(&[5e-3, 1e-3]), Method::Robust),
    ] {
        let options = MotionOptions { method, ..MotionOptions::default() };
        let mut whole = Simulation::new(&robot, &case, options.clone()).unwrap();
        for _ in 0..20 {
            whole.step(&commands, 2e-3).unwrap();
        }
        let kept = whole.state().start();
        for _ in 0..20 {
            whole.step(&commands, 2e-3).unwrap();
        }
        let initial = Initial::State(Box::new(kept.clone()));
        let options = MotionOptions { initial, ..options };
        let mut rest =
            Simulation::with_commands(&robot, &case, &commands, options.clone()).unwrap();
        assert_eq!(rest.state().time, 0.0);
        let (energy, initial) = (rest.state().energy.total(), rest.state().energy.initial);
        assert_eq!((energy, rest.state().energy.defect()), (initial, 0.0));
        for _ in 0..20 {
            rest.step(&commands, 2e-3).unwrap();
        }
        // The second begins without the rates of the first.
        let apart = (rest.state().tip().position - whole.state().tip().position).norm();
        let moved = (whole.state().tip().position - case.base.position).norm();
        assert!(moved > 0.1 && apart < 2e-4, "{method:?}: {apart:e}");
        let other = Start { strains: Vec::new(), ..kept.clone() };
        let wrong = MotionOptions { initial: Initial::State(Box::new(other)), ..options.clone() };
        let refused = Simulation::with_commands(&robot, &case, &commands, wrong);
        assert!(matches!(refused, Err(MotionError::Count { given: 0, .. })));
        let mut infinite = kept;
        infinite.velocities[1].linear.x = f64::INFINITY;
        let wrong = MotionOptions { initial: Initial::State(Box::new(infinite)), ..options };
        let refused = Simulation::with_commands(&robot, &case, &commands, wrong);
        assert!(matches!(refused, Err(MotionError::Option { .. })));
    }
}

/// A base that is led through poses is at each of them at its time, in whichever frame they are given, and moves as one with these velocities.
#[test]
fn a_base_is_led_through_poses() {
    let robot = rod(0.3, 4e-3, 1e9, 0.3, 1200.0, vec![straight("a", 0.5, 0.01)]);
    let twist = Twist { linear: Vec3::new(0.02, 0.0, 0.01), angular: Vec3::new(0.2, -0.1, 0.3) };
    let start =
        Pose::exp(Twist { linear: Vec3::new(1.0, 2.0, 3.0), angular: Vec3::new(0.5, 0.0, 1.0) });
    let frame =
        Pose::exp(Twist { linear: Vec3::new(-1.0, 0.0, 0.3), angular: Vec3::new(0.0, 2.0, 0.1) });
    let poses: Vec<Pose> =
        (0..4_i32).map(|k| start * Pose::exp(twist * f64::from(k * k))).collect();
    let rows: Vec<(f64, Pose)> =
        poses.iter().enumerate().map(|(k, pose)| (0.05 + 0.05 * k as f64, frame * *pose)).collect();
    let led = BaseMotion::through(&rows).unwrap();
    let case = Case { base: start, ..Case::with_tensions(&[0.5]) };
    let run = |base: BaseMotion| {
        let options = MotionOptions {
            base: Some(base),
            damping: Damping::Time(5e-3),
            ..MotionOptions::default()
        };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let commands = Commands::tensions(&[0.5]);
        let trajectory = simulation.run(&commands, 0.05, 5, 5).unwrap();
        trajectory.states
    };
    let states = run(led);
    for (k, state) in states.iter().enumerate() {
        let expected = poses[k.saturating_sub(1).min(3)];
        let base = state.poses[0];
        assert!((base.position - expected.position).norm() < 1e-12, "{k}");
        assert!((base.rotation.conjugate() * expected.rotation).log().norm() < 1e-12, "{k}");
    }
    // The same by velocities that were found by hand: that of the first interval is the twist of 50 ms.
    let step = |value: f64| Course::table(vec![0.05, 0.05], vec![0.0, 20.0 * value]).unwrap();
    let by_hand = BaseMotion {
        velocity: twist.linear.to_array().map(step),
        angular_velocity: twist.angular.to_array().map(step),
    };
    let others = run(by_hand);
    assert!((others[2].tip().position - states[2].tip().position).norm() < 1e-12);
    assert!((states[2].tip().position - states[1].tip().position).norm() > 1e-3);
    let rows = [(0.0, start), (0.0, start)];
    assert!(matches!(BaseMotion::through(&rows), Err(MotionError::Course { row: 1, .. })));
    assert_eq!(BaseMotion::through(&rows[..1]).unwrap(), BaseMotion::default());
}
