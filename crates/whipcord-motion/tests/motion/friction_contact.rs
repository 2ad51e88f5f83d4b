//! Cables with friction of a robot that touches obstacles.

use core::f64::consts::{FRAC_PI_2, PI};

use whipcord::{
    Cable, CableCommand, Case, Form, Loads, Model, ModelKind, Motor, Obstacle, Pose, Robot,
    Shortening, Statics, Stations, UnitQuaternion, Vec3,
};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, Initial, Method, MotionOptions, Simulation, State,
};

use super::robots::{helix, paper, ramps, straight};

const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];
const RUBBING: f64 = 0.3;

fn rubbing(friction: f64, cables: Vec<Cable>) -> Robot {
    let rubs = |cable: Cable| Cable { friction: Some(friction), ..cable };
    paper(cables.into_iter().map(rubs).collect())
}

fn ball(friction: f64) -> Obstacle {
    let pose = Pose { position: Vec3::new(0.075, 0.0, 0.11), ..Pose::IDENTITY };
    let form = Form::Sphere { radius: 0.03 };
    Obstacle { name: "ball".to_owned(), form, pose, friction, movable: None }
}

fn options(model: ModelKind) -> MotionOptions {
    MotionOptions {
        model,
        elements: 10,
        damping: Damping::Time(8e-2),
        initial: Initial::Rest,
        method: Method::Robust,
        ..MotionOptions::default()
    }
}

/// A wall that stops the robot at this distance from its axis.
fn wall(distance: f64, friction: f64) -> Obstacle {
    let rotation = UnitQuaternion::exp(Vec3::Y * -FRAC_PI_2);
    let pose = Pose { position: Vec3::X * distance, rotation };
    Obstacle { name: "wall".to_owned(), form: Form::HalfSpace, pose, friction, movable: None }
}

fn contact_force(contacts: &[whipcord::Contact]) -> Vec3 {
    let force = |c: &whipcord::Contact| c.normal * c.force.unwrap() + c.friction.unwrap();
    contacts.iter().map(force).fold(Vec3::ZERO, |a, b| a + b)
}

/// A pull against a wall and a release, both slow, end where the statics has them after the same steps.
#[test]
fn slow_motions_are_the_steps_of_the_statics() {
    let robot = rubbing(RUBBING, vec![straight("a", 0.0, 0.008), straight("b", 2.0, 0.008)]);
    let ramp = 4.0;
    for (model, by_length, of_wall) in
        [(0, false, 0.0), (1, false, 0.0), (0, true, 0.0), (1, true, 0.0), (1, false, 0.3)]
    {
        let model = MODELS[model];
        let steps =
            if by_length { [[4.8e-3, -4e-3], [4.5e-3, -3.5e-3]] } else { [[6.0, 1.0], [3.5, 0.8]] };
        let command = |value: f64| match by_length {
            true => CableCommand { shortening: Some(Shortening::Length(value)), tension: None },
            false => CableCommand { tension: Some(value), shortening: None },
        };
        let case = |values: [f64; 2]| Case {
            commands: values.map(command).to_vec(),
            obstacles: vec![wall(0.05, of_wall)],
            loads: Loads { tip_force: Vec3::new(0.0, 0.01, 0.0), ..Loads::default() },
            ..Case::default()
        };
        let drive = |i: usize| {
            let course = ramps(ramp, 0.5 * ramp, &steps.map(|step| step[i]));
            if by_length { CableDrive::Shortening(course) } else { CableDrive::Tension(course) }
        };
        let commands = Commands::new(vec![drive(0), drive(1)]);
        let mut simulation = Simulation::new(&robot, &case([0.0; 2]), options(model)).unwrap();
        let mut before = Vec::new();
        for (k, step) in steps.into_iter().enumerate() {
            for _ in 0..(1.5 * ramp / 0.02_f64).round() as usize {
                simulation.step(&commands, 0.02).unwrap();
            }
            let case = Case { before: core::mem::take(&mut before), ..case(step) };
            let solution = Model::new(model, Stations::Disks, Default::default())
                .solve(&robot, &case)
                .unwrap();
            before = case.before;
            before.push(case.commands);
            let state = simulation.state();
            let tip = solution.shape.tip().position;
            let error = (state.tip().position - tip).norm() / 0.18;
            let [moved, still] =
                [contact_force(&state.contacts), contact_force(&solution.contacts)];
            println!(
                "{model} by_length {by_length}, wall {of_wall}, step {k}: {error:.1e}, {moved:?} {still:?}"
            );
            assert!(error < 6e-4, "{model} {by_length} {k}: {error:e}");
            assert!(still.norm() > 0.03, "it touches");
            assert!((moved - still).norm() < 0.02 * still.norm(), "{moved:?} {still:?}");
        }
    }
}

/// The motions of a robot against a ball, by tensions, by lengths and by motors, with jumps and impacts.
fn driven(robot: &Robot, kind: &str) -> (Case, Commands) {
    let times = vec![0.0, 0.05, 0.2, 0.25];
    let drive = |values: [f64; 2]| {
        let [a, b] = values;
        Course::table(times.clone(), vec![0.0, a, a, b]).unwrap()
    };
    let obstacles = vec![ball(0.3), wall(0.05, 0.0)];
    match kind {
        "tensions" => {
            let case = Case { obstacles, ..Case::with_tensions(&[0.0, 0.0]) };
            let jump = Course::table(vec![0.02, 0.02, 0.2], vec![0.0, 5.0, 1.0]).unwrap();
            let drives = vec![CableDrive::Tension(jump), CableDrive::Tension(drive([1.0, 3.0]))];
            (case, Commands::new(drives))
        }
        "lengths" => {
            let still = [Shortening::Length(0.0); 2];
            let case = Case { obstacles, ..Case::with_shortenings(&still) };
            let drives = [[5e-3, 1e-3], [-4e-3, -2e-3]].map(drive).map(CableDrive::Shortening);
            (case, Commands::new(drives.to_vec()))
        }
        _ => {
            let still = Case::with_motors(robot, &[0.0]).unwrap();
            let mut commands = Commands::of_case(robot, &still);
            commands.motors = vec![Some(drive([0.9, -0.3]))];
            (Case { obstacles, ..still }, commands)
        }
    }
}

fn antagonists(friction: f64, kind: &str) -> Robot {
    let mut cables = vec![straight("a", 0.0, 0.008), straight("b", PI, 0.008)];
    if kind == "motors" {
        cables.iter_mut().for_each(|cable| cable.axial_stiffness = Some(2e3));
    }
    let robot = match friction {
        0.0 => paper(cables),
        _ => rubbing(friction, cables),
    };
    if kind != "motors" {
        return robot;
    }
    let motor = Motor { stiffness: Some(4e3), ..Motor::spool("m", [(0, 5e-3), (1, -5e-3)]) };
    robot.with_motors(vec![motor]).unwrap()
}

fn run(robot: &Robot, kind: &str, options: MotionOptions, dt: f64, duration: f64) -> Vec<State> {
    let (case, commands) = driven(robot, kind);
    let mut simulation = Simulation::with_commands(robot, &case, &commands, options).unwrap();
    let steps = (duration / dt).round() as usize;
    (0..steps).map(|_| simulation.step(&commands, dt).unwrap().clone()).collect()
}

/// Friction that is hardly there changes nothing.
#[test]
fn hardly_any_friction_is_none() {
    for (model, kind) in MODELS.into_iter().flat_map(|of| [(of, "tensions"), (of, "lengths")]) {
        let options = MotionOptions {
            damping: Damping::Time(5e-3),
            iteration_tolerance: 1e-12,
            ..options(model)
        };
        let of =
            |friction: f64| run(&antagonists(friction, kind), kind, options.clone(), 5e-3, 0.3);
        let (mut worst, mut touching) = (0.0_f64, 0);
        for (k, (a, b)) in of(0.0).iter().zip(&of(1e-14)).enumerate() {
            let apart = (a.tip().position - b.tip().position).norm() / 0.18;
            let force = (contact_force(&a.contacts) - contact_force(&b.contacts)).norm();
            println!("{model} {kind} {k}: {apart:.1e} {force:.1e} {}", a.contacts.len());
            worst = worst.max(apart);
            touching += usize::from(!a.contacts.is_empty());
        }
        assert!(worst < 1e-9 && touching > 10, "{model} {kind}: {worst:e} {touching}");
    }
}

/// At every step size motions with jumps, impacts and slack cables go through. Tensions stay in the bounds of Eytelwein's law in every hole, obstacles and friction only take energy.
#[test]
fn fast_motions_obey_the_laws_of_holes_and_contacts() {
    for (model, kind) in
        MODELS.into_iter().flat_map(|of| [(of, "tensions"), (of, "lengths"), (of, "motors")])
    {
        let robot = antagonists(RUBBING, kind);
        let mut touching = 0;
        for dt in [1e-3, 5e-3, 1e-2, 2e-2] {
            let options =
                MotionOptions { damping: Damping::Time(3e-3), elements: 6, ..options(model) };
            let states = run(&robot, kind, options, dt, 0.4);
            let (mut lost, mut regained, mut gained) = (0.0_f64, 0.0_f64, 0.0_f64);
            for state in &states {
                let energy = state.energy;
                gained = gained.max(energy.defect());
                regained = regained.max(lost - energy.dissipated);
                lost = energy.dissipated;
                touching += usize::from(!state.contacts.is_empty());
                for contact in &state.contacts {
                    assert!(contact.force.unwrap() > 0.0 && contact.gap > -2e-5, "{contact:?}");
                }
                if model == ModelKind::CosseratDisks {
                    for (cable, angle) in [(0, 0.0), (1, PI)] {
                        obey_eytelwein(state, cable, angle);
                    }
                }
            }
            let energy = states.last().unwrap().energy;
            let [gained, regained] = [gained, regained].map(|of| of / energy.cables);
            println!("{model} {kind} {dt}: gained {gained:.1e}, of friction {regained:.1e}");
            assert!(gained < 2e-3 && regained < 1e-12, "{energy:?}");
        }
        assert!(touching > 50);
    }
}

/// The bounds of the tensions on both sides of the disks, by the angles of the chords between places in the test's own geometry.
fn obey_eytelwein(state: &State, cable: usize, angle: f64) {
    let tensions = state.passage_tensions(cable);
    let last = state.poses.len() - 1;
    let hole = Vec3::new(0.008 * angle.cos(), 0.008 * angle.sin(), 0.0);
    let place = |disk: usize| state.poses[disk * last / tensions.len()].transform(hole);
    let way = |disk: usize| place(disk + 1) - place(disk);
    for k in 1..tensions.len() {
        let (a, b) = (way(k - 1), way(k));
        let turn = a.cross(b).norm().atan2(a.dot(b));
        let (before, behind) = (tensions[k - 1], tensions[k]);
        let most = (RUBBING * turn).exp() * (1.0 + 1e-6);
        let is_within = behind <= before * most + 1e-7 && before <= behind * most + 1e-7;
        assert!(is_within, "{cable} {k}: {before} {behind} {turn}");
    }
}

/// At rest the base holds what obstacle and loads exert, whatever friction leaves in the cables.
#[test]
fn forces_balance_at_rest() {
    for model in MODELS {
        let robot = rubbing(RUBBING, vec![helix(), straight("b", 0.2, 0.008)]);
        let loads = Loads { tip_force: Vec3::new(0.05, 0.02, -0.03), ..Loads::default() };
        let case =
            Case { obstacles: vec![wall(0.05, 0.2)], loads, ..Case::with_tensions(&[1.0, 6.0]) };
        for initial in [Initial::Rest, Initial::Equilibrium] {
            let options = MotionOptions { initial, ..options(model) };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let commands = Commands::of_case(&robot, &case);
            for _ in 0..400 {
                simulation.step(&commands, 0.01).unwrap();
            }
            let push = contact_force(&simulation.state().contacts);
            let rest = simulation.base_wrench().force + push + case.loads.tip_force;
            let fastest = simulation.state().velocities.iter().map(|v| v.linear.norm());
            println!("{model}: {push:?} {rest:?} {}", fastest.fold(0.0, f64::max));
            assert!(push.norm() > 0.05 && rest.norm() < 1e-3 * push.norm(), "{rest:?}");
        }
    }
}
