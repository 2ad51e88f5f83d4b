//! What has no dynamics here is refused by name, and a step that fails changes nothing.

use whipcord::obstacle::{Form, MovableBody, Obstacle};
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, PointMass, Pose, Robot, Section, Stiffness, Vec3,
};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, Initial, LoadCourse, MotionError, MotionOptions,
    Simulation, Start,
};

use super::robots::{paper, straight};

fn refusal(robot: &Robot, case: &Case, options: MotionOptions) -> MotionError {
    Simulation::new(robot, case, options).unwrap_err()
}

#[test]
fn what_is_missing_or_has_no_dynamics_is_named() {
    let case = Case::with_tensions(&[0.0]);
    let options = MotionOptions::default;
    let rubs = || Cable { friction: Some(0.2), ..straight("a", 0.0, 0.008) };
    let simulation = Simulation::new(&paper(vec![rubs()]), &case, options()).unwrap();
    let start = Start { lengths_beyond: Vec::new(), ..simulation.state().start() };
    let start = Initial::State(Box::new(start));
    let error = refusal(&paper(vec![rubs()]), &case, MotionOptions { initial: start, ..options() });
    assert!(error.to_string().contains("motion.initial.passage_tensions"), "{error}");

    let cables = || vec![straight("a", 0.0, 0.008)];
    let backbone = Backbone { section: Some(Section::circle(0.003)), ..Backbone::new(0.18) };
    let light = Robot::new(backbone, Disks::none(0.18), cables()).unwrap();
    let error = refusal(&light, &case, options());
    assert!(error.to_string().contains("backbone.young_modulus"), "{error}");

    let stiffness = Some(Stiffness::diagonal([1e4, 1e4], 2e4, [0.01, 0.01], 0.008));
    let backbone = Backbone { stiffness, ..Backbone::new(0.18) };
    let massless = Robot::new(backbone, Disks::none(0.18), cables()).unwrap();
    let error = refusal(&massless, &case, options());
    assert!(error.to_string().contains("backbone.linear_density"), "{error}");

    let robot = paper(cables());
    let ball = Obstacle {
        name: "ball".to_owned(),
        form: Form::Sphere { radius: 0.05 },
        pose: Pose { position: Vec3::new(0.1, 0.0, 0.1), ..Pose::IDENTITY },
        friction: 0.0,
        movable: None,
    };
    let inside =
        Obstacle { pose: Pose { position: Vec3::Z * 0.1, ..Pose::IDENTITY }, ..ball.clone() };
    let among = Case { obstacles: vec![inside], ..case.clone() };
    let error = refusal(&robot, &among, MotionOptions { initial: Initial::Rest, ..options() });
    assert!(matches!(error, MotionError::Overlap { obstacle: 0, .. }), "{error}");
    let movable = Obstacle { movable: MovableBody::with_mass(&ball.form, 0.1), ..ball.clone() };
    let among = Case { obstacles: vec![movable], ..case.clone() };
    let error = refusal(&robot, &among, options());
    assert!(error.to_string().contains("obstacles[0].mass"), "{error}");

    let error = refusal(&robot, &case, MotionOptions { damping: Damping::Time(-1.0), ..options() });
    assert!(matches!(error, MotionError::Option { .. }), "{error}");
    let heavier = Loads { masses: vec![PointMass { at: 0.1, mass: 0.01 }], ..Loads::default() };
    let over_time = LoadCourse { loads: heavier, factor: Course::constant(1.0) };
    let error = refusal(&robot, &case, MotionOptions { loads: vec![over_time], ..options() });
    assert!(error.to_string().contains("motion.loads"), "{error}");
    let error = refusal(&robot, &Case::with_tensions(&[1.0, 2.0]), options());
    assert!(matches!(error, MotionError::Invalid(_)), "{error}");
}

#[test]
fn a_step_that_fails_leaves_the_state() {
    let robot = paper(vec![straight("a", 0.0, 0.008)]);
    let options = MotionOptions::default();
    let mut simulation = Simulation::new(&robot, &Case::with_tensions(&[0.0]), options).unwrap();
    let before = simulation.state().clone();
    // The section folds, and the cable has no direction left.
    let error = simulation.step(&Commands::tensions(&[1e6]), 0.01).unwrap_err();
    assert!(matches!(error, MotionError::NotConverged { .. }), "{error}");
    assert_eq!(simulation.state(), &before);
    for (commands, dt) in
        [(Commands::tensions(&[1.0, 2.0]), 0.01), (Commands::tensions(&[1.0]), -1.0)]
    {
        assert!(simulation.step(&commands, dt).is_err());
        assert_eq!(simulation.state(), &before);
    }
    let ramp = Course::table(vec![0.0, 0.05], vec![0.0, 5e-3]).unwrap();
    let ramp = Commands::new(vec![CableDrive::Shortening(ramp)]);
    for _ in 0..10 {
        simulation.step(&ramp, 0.01).unwrap();
    }
    // Where it swings over, the cable is slack and shorter.
    let cable = simulation.state().cables[0];
    assert!((cable.length + cable.slack - 0.175).abs() < 1e-9, "{cable:?}");
}

/// A backbone that neither stretches nor shears, known by its stiffness alone, moves like one that hardly does.
#[test]
fn held_strains_are_the_limit_of_stiff_ones() {
    let tip = |rigid: bool| {
        let stiffness = if rigid {
            Stiffness::Diagonal {
                shear: None,
                axial: None,
                bending: [0.01, 0.01].into(),
                torsion: 0.008.into(),
            }
        } else {
            Stiffness::diagonal([3e7, 3e7], 3e7, [0.01, 0.01], 0.008)
        };
        let backbone = Backbone {
            stiffness: Some(stiffness),
            linear_density: Some(0.02.into()),
            extensible: !rigid,
            shearable: !rigid,
            ..Backbone::new(0.18)
        };
        let robot =
            Robot::new(backbone, Disks::none(0.18), vec![straight("a", 0.0, 0.008)]).unwrap();
        let loads = Loads { gravity: Some(Vec3::new(0.0, 9.81, 0.0)), ..Loads::default() };
        let case = Case { loads, ..Case::with_tensions(&[0.0]) };
        let options = MotionOptions { damping: Damping::Time(3e-3), ..MotionOptions::default() };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        for _ in 0..20 {
            simulation.step(&Commands::tensions(&[2.0]), 5e-3).unwrap();
        }
        simulation.state().tip().position
    };
    let change = (tip(true) - tip(false)).norm();
    assert!(change < 1e-5, "{change:e}");
}
