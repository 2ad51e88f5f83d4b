//! Cables that are driven by their lengths or by motors.

use core::f64::consts::TAU;

use whipcord::robot::Motor;
use whipcord::{Cable, Case, Loads, Shortening, Vec3};
use whipcord_motion::{CableDrive, Commands, Course, Damping, Method, MotionOptions, Simulation};

use super::robots::{paper, straight};

fn three() -> Vec<Cable> {
    (0..3).map(|i| straight(&format!("{i}"), TAU * f64::from(i) / 3.0, 0.008)).collect()
}

fn elastic(cable: Cable) -> Cable {
    // A compliance of 1.3e-5 m/N.
    Cable { axial_stiffness: Some(0.18 / 1.3e-5), ..cable }
}

/// One cable is wound up by 8 mm and let go beyond its length at rest, while the others are paid out.
fn commands(ramp: f64) -> Commands {
    let pulled =
        Course::table(vec![0.0, ramp, 0.3, 0.3 + ramp, 1.0], vec![0.0, 8e-3, 8e-3, -6e-3, -6e-3]);
    let paid = || Course::table(vec![0.0, ramp, 1.0], vec![0.0, -4.5e-3, -4.5e-3]).unwrap();
    let drives = [pulled.unwrap(), paid(), paid()];
    Commands::new(drives.into_iter().map(CableDrive::Shortening).collect())
}

/// At every step size from 0.1 to 20 ms: no step fails or is divided, no cable is longer than its command, tension and slack exclude one
/// another, and cables both go slack and get taut again.
#[test]
fn lengths_are_kept_and_cables_go_slack() {
    for (cables, ramp) in [
        (three(), 0.05),
        (three().into_iter().map(elastic).collect::<Vec<_>>(), 0.05),
        (three().into_iter().map(elastic).collect(), 1e-9),
    ] {
        let robot = paper(cables);
        let loads = Loads { gravity: Some(Vec3::new(-9.81, 0.0, 0.0)), ..Loads::default() };
        let shortenings = [Shortening::Length(0.0); 3];
        let case = Case { loads, ..Case::with_shortenings(&shortenings) };
        let commands = commands(ramp);
        let mut ends = Vec::new();
        for dt in [1e-4, 1e-3, 5e-3, 1e-2, 2e-2] {
            let options = MotionOptions {
                damping: Damping::Time(3.5e-3),
                elements: 5,
                ..MotionOptions::default()
            };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let (mut slack, mut parts) = (0, 0);
            let steps = (0.6_f64 / dt).round() as usize;
            for k in 0..steps {
                let state = simulation.step(&commands, dt).unwrap();
                parts += state.diagnostics.parts;
                assert_eq!(state.diagnostics.method, Method::Robust);
                for (i, (cable, drive)) in state.cables.iter().zip(&commands.cables).enumerate() {
                    let shortening = drive.course().before(state.time);
                    let compliance = robot.cable_compliance(i, 0.18);
                    let gap = 0.18 - shortening + compliance * cable.tension - cable.length;
                    assert!(gap > -1e-9, "dt {dt}, step {k}, cable {i}: {gap:e}");
                    assert!(
                        cable.tension >= 0.0 && cable.tension * gap.abs() < 1e-8,
                        "{cable:?} {gap:e}"
                    );
                    assert!(
                        (cable.slack - if cable.tension > 0.0 { 0.0 } else { gap }).abs() < 1e-9
                    );
                    slack += usize::from(cable.tension == 0.0);
                }
            }
            assert!(slack > 0 && slack < 3 * steps, "{slack}");
            assert_eq!(parts, steps);
            ends.push(simulation.state().tip().position);
        }
        // A jump of the lengths is an impact, whose energy depends on the step.
        if ramp < 1e-3 {
            continue;
        }
        for (end, limit) in ends[1..].iter().zip([1e-4, 2e-3, 4e-3, 6e-3]) {
            assert!((*end - ends[0]).norm() < limit, "ramp {ramp}: {:e}", (*end - ends[0]).norm());
        }
    }
}

/// Long after a command by lengths or motors the robot stands in the equilibrium of the statics.
#[test]
fn lengths_and_motors_lead_to_the_equilibrium_of_the_statics() {
    use whipcord::{Model, ModelKind, Statics, Stations};
    let motors = vec![
        Motor { stiffness: Some(5e3), ..Motor::spool("bend", [(0, 0.01)]) },
        Motor { stiffness: Some(5e3), ..Motor::spool("other", [(1, 0.01), (2, 0.01)]) },
    ];
    let robot = paper(three()).with_motors(motors).unwrap();
    let start = Case::with_motors(&robot, &[0.0, 0.0]).unwrap();
    let options =
        MotionOptions { damping: Damping::Time(2e-2), elements: 10, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &start, options).unwrap();
    let case = Case::with_motors(&robot, &[0.5, -0.2]).unwrap();
    let commands = Commands::of_case(&robot, &case);
    for _ in 0..300 {
        simulation.step(&commands, 0.01).unwrap();
    }
    let solution = Model::new(ModelKind::Cosserat, Stations::Disks, Default::default())
        .with_tolerance(1e-10)
        .solve(&robot, &case)
        .unwrap();
    let tip = solution.shape.poses.last().unwrap().position;
    let error = (simulation.state().tip().position - tip).norm();
    assert!(error < 1e-6 * 0.18, "{error:e}");
    for (moved, still) in simulation.state().cables.iter().zip(&solution.cables) {
        let tension = still.tension.unwrap();
        assert!((moved.tension - tension).abs() < 1e-4, "{moved:?} {still:?}");
        assert!((moved.length - still.length).abs() < 1e-7);
    }
}
