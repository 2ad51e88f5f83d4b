//! Gradients over motions in contact with obstacles against central differences of the same steps.

use whipcord::{Cable, Case, Form, ModelKind, Obstacle, Pose, Robot, Shortening, Vec3};
use whipcord_motion::{CableDrive, Commands, Course, Initial, Method};

use super::gradient::{DT, Problem, STEPS, by_tensions, close, weight};
use super::gradient_friction::count_slips;

const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

/// A robot that leans on a ball, and is pulled so that it goes on to touch it.
fn problem(model: ModelKind, friction: f64, overlap: f64) -> Problem {
    let mut problem = by_tensions((model, Method::Robust), 1.0, 1.0, 1.0);
    problem.options.loads.clear();
    problem.commands = (0..STEPS)
        .map(|k| {
            let pull = |i: usize| [1.0, 0.5][i] + 0.05 * weight(3 * k + i);
            Commands::tensions(&[pull(0), pull(1)])
        })
        .collect();
    lean(&mut problem, friction, overlap);
    problem
}

/// Puts the ball where the robot leans on it.
fn lean(problem: &mut Problem, friction: f64, overlap: f64) {
    let tip = problem.simulation().state().tip().position;
    let side = Vec3::new(tip.x, tip.y, 0.0);
    let side = side * (1.0 / side.norm());
    // The last disk has a radius of 10 mm.
    let pose = Pose { position: tip + side * (0.06 - overlap), ..Pose::IDENTITY };
    let form = Form::Sphere { radius: 0.05 };
    let ball = Obstacle { name: "ball".to_owned(), form, pose, friction, movable: None };
    problem.case.obstacles = vec![ball];
}

/// Without friction, sliding, and sticking.
#[test]
fn gradients_in_contact_are_those_of_differences() {
    for model in MODELS {
        for friction in [0.0, 0.05, 3.0] {
            let name = format!("{model:?}, {friction}");
            let base = problem(model, friction, 6e-3);
            let record = base.simulation().record(&base.commands, DT).unwrap();
            let contacts = record.states.iter().map(|state| state.contacts.len()).min().unwrap();
            let sticks = record.states.iter().flat_map(|of| &of.contacts).filter(|of| of.sticks);
            let sticking = sticks.count();
            assert!(contacts > 0, "{name}");
            assert!(if friction == 3.0 { sticking > 0 } else { sticking < 3 }, "{name} {sticking}");
            assert!(record.one_sided().is_empty(), "{name}: {:?}", record.one_sided());
            assert!(record.holds_start());
            base.check_by_commands(3e-5, &name);
        }
    }
}

/// The same robot whose cables rub: an elastic one and a rigid one, by tensions or by lengths. They are pulled and let go, so that holes slide and stick.
fn rubbing((model, by_length): (ModelKind, bool), friction: f64, grip: f64) -> Problem {
    let mut problem = problem(model, friction, 6e-3);
    let rub = |(i, cable): (usize, &Cable)| Cable {
        friction: Some([0.7, 0.9][i] * grip),
        axial_stiffness: [Some(9000.0), None][i],
        ..cable.clone()
    };
    let (backbone, disks) = (problem.robot.backbone().clone(), problem.robot.disks().clone());
    let cables = problem.robot.cables().iter().enumerate().map(rub).collect();
    problem.robot = Robot::new(backbone, disks, cables).unwrap();
    problem.case.obstacles.clear();
    lean(&mut problem, friction, 6e-3);
    let (lengths, rests) = if by_length {
        let lengths = |problem: &Problem| {
            let simulation = problem.simulation();
            [0, 1].map(|i| simulation.state().cables[i].length)
        };
        let now = lengths(&problem);
        let (initial, obstacles) = (
            core::mem::replace(&mut problem.options.initial, Initial::Rest),
            core::mem::take(&mut problem.case.obstacles),
        );
        let rest = lengths(&problem);
        (problem.options.initial, problem.case.obstacles) = (initial, obstacles);
        (now, rest)
    } else {
        ([0.0; 2], [0.0; 2])
    };
    let told = |k: usize| {
        let drive = |i: usize| {
            let change = [0.2, 0.35, 0.3, 0.28, 0.1, 0.05][k] + 0.02 * weight(3 * k + i);
            if by_length {
                let start = rests[i] - lengths[i] + [0.0, 3e-5][i];
                CableDrive::Shortening(Course::constant(start + 3.4e-4 * change))
            } else {
                CableDrive::Tension(Course::constant([1.0, 0.5][i] * (1.0 + change)))
            }
        };
        Commands::new(vec![drive(0), drive(1)])
    };
    problem.commands = (0..STEPS).map(told).collect();
    problem
}

/// Where cables rub in their holes at the same time, whose tensions go with the forces of the contacts.
#[test]
fn gradients_in_contact_with_friction_of_cables_are_those_of_differences() {
    let mut seen = [0; 3];
    for (model, by_length) in MODELS.into_iter().flat_map(|of| [(of, false), (of, true)]) {
        let all = [(0.05, 1.0), (0.05, 4.0), (0.0, 1.0), (3.0, 1.0)];
        let is_short = by_length || model == ModelKind::CosseratDisks;
        for (friction, grip) in all.into_iter().take(if is_short { 2 } else { 4 }) {
            let name = format!("{model:?}, by length {by_length}, {friction}, grip {grip}");
            let base = rubbing((model, by_length), friction, grip);
            let record = base.simulation().record(&base.commands, DT).unwrap();
            count_slips(&record, &mut seen);
            let touching = record.states.iter().filter(|state| !state.contacts.is_empty()).count();
            assert!(touching > 3, "{name}: {touching}");
            assert!(record.one_sided().is_empty(), "{name}: {:?}", record.one_sided());
            base.check_by_commands(if by_length { 1e-8 } else { 1e-4 }, &name);
        }
    }
    assert!(seen.iter().all(|count| *count > 20), "sticks, pulled, released: {seen:?}");
}

/// Beside cables that are driven by their lengths.
#[test]
fn gradients_in_contact_by_lengths_are_those_of_differences() {
    for friction in [0.0, 0.05, 3.0] {
        let mut base = problem(ModelKind::Cosserat, friction, 6e-3);
        // As wound up as under the tensions.
        let lengths = |problem: &Problem| {
            let simulation = problem.simulation();
            [0, 1].map(|i| simulation.state().cables[i].length)
        };
        let now = lengths(&base);
        let initial = core::mem::replace(&mut base.options.initial, Initial::Rest);
        let obstacles = core::mem::take(&mut base.case.obstacles);
        let rest = lengths(&base);
        (base.options.initial, base.case.obstacles) = (initial, obstacles);
        let start = [0, 1].map(|i| rest[i] - now[i]);
        let case = Case::with_shortenings(&start.map(Shortening::Length));
        base.case = Case { commands: case.commands, ..base.case };
        let told = |k: usize| {
            let drive = |i: usize| {
                let shortening = start[i] + 5e-5 * weight(3 * k + i);
                CableDrive::Shortening(Course::constant(shortening))
            };
            Commands::new(vec![drive(0), drive(1)])
        };
        base.commands = (0..STEPS).map(told).collect();
        let record = base.simulation().record(&base.commands, DT).unwrap();
        assert!(record.states.iter().any(|state| !state.contacts.is_empty()), "{friction}");
        assert!(record.states.iter().any(|state| state.cables[0].tension > 0.0), "{friction}");
        base.check_by_commands(1e-8, &friction.to_string());
    }
}

/// A robot that leaves the obstacle.
#[test]
fn gradients_through_a_release_are_those_of_differences() {
    let base = problem(ModelKind::Cosserat, 0.0, 3e-3);
    let record = base.simulation().record(&base.commands, DT).unwrap();
    assert!(record.states.last().unwrap().contacts.is_empty());
    assert!(!record.states[1].contacts.is_empty());
    base.check_by_commands(1e-5, "released");
}

/// From a state in the middle of a motion.
#[test]
fn gradients_in_contact_by_the_start_are_those_of_differences() {
    for friction in [0.0, 0.05, 3.0] {
        let problem = problem(ModelKind::Cosserat, friction, 6e-3);
        problem.check_by_start(1e-4, &friction.to_string());
    }
    for model in MODELS {
        let rubbing = rubbing((model, false), 0.05, 1.0);
        rubbing.check_by_start(1e-4, &format!("{model:?}, cables rub"));
    }
}

impl Problem {
    /// The gradient by each command is that of differences of this size.
    pub(super) fn check_by_commands(&self, unit: f64, name: &str) {
        let gradient = self.gradient();
        let scale = gradient.cables.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
        let expected = self.by_commands(|_| unit);
        for k in 0..STEPS {
            for i in 0..2 {
                close(gradient.cables[k][i], expected[k][i], scale, &format!("{name}: {k} {i}"));
            }
        }
    }
}
