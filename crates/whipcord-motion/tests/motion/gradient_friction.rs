//! Gradients over motions with friction of cables against central differences of the same steps.

use whipcord::solution::SlipState;
use whipcord::{Cable, Case, ModelKind, Motor, MotorDynamics};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, Initial, Method, MotionOptions, Record,
};

use super::gradient::{DT, Problem, STEPS, close, difference, gravity, options, robot, weight};
use super::robots::{helix, straight};

const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

/// Factors on properties of the robot.
#[derive(Clone, Copy)]
struct Changed {
    stiffness: f64,
    mass: f64,
    damping: f64,
    /// A factor on the friction.
    grip: f64,
}

const UNCHANGED: Changed = Changed { stiffness: 1.0, mass: 1.0, damping: 1.0, grip: 1.0 };

/// Up, on, and down again: holes slide both ways and stick in between.
const COURSE: [f64; STEPS] = [0.6, 1.0, 1.2, 1.15, 1.1, 0.6];

/// An elastic helical cable and a rigid straight one with friction, beside one without.
fn problem(
    model: ModelKind,
    by_length: bool,
    initial: Initial,
    start: f64,
    of: Changed,
) -> Problem {
    let with_friction = |cable: Cable, friction: f64, axial_stiffness: Option<f64>| Cable {
        friction: Some(friction * of.grip),
        axial_stiffness,
        ..cable
    };
    let cables = vec![
        with_friction(helix(), 0.7, Some(9000.0)),
        with_friction(straight("rigid", 2.0, 0.008), 0.9, None),
        straight("free", 4.0, 0.008),
    ];
    let told = |k: usize| {
        let drive = |i: usize| {
            let size = [1.0, -0.4, 0.7][i] * COURSE[k] + 0.005 * weight(k + i);
            if by_length && i < 2 {
                CableDrive::Shortening(Course::constant(2e-3 * size))
            } else {
                CableDrive::Tension(Course::constant(2.5 * size.abs()))
            }
        };
        Commands::new((0..3).map(drive).collect())
    };
    Problem {
        robot: robot(of.stiffness, of.mass, cables),
        case: Case { loads: gravity(), ..Case::with_tensions(&[start, 0.5 * start, 0.0]) },
        options: MotionOptions {
            model,
            initial,
            method: Method::Robust,
            damping: Damping::Time(2e-2 * of.damping / of.stiffness),
            ..options()
        },
        commands: (0..STEPS).map(told).collect(),
    }
}

/// Adds how often holes stick, are pulled and are released.
pub(super) fn count_slips(record: &Record, seen: &mut [usize; 3]) {
    for state in &record.states[1..] {
        for slip in &state.holes.slip_states {
            seen[match slip {
                SlipState::Sticks => 0,
                SlipState::Pulled => 1,
                SlipState::Released => 2,
            }] += 1;
        }
    }
}

/// How often a hole sticks.
fn check(model: ModelKind, by_length: bool, initial: &Initial, start: f64, grip: f64) -> usize {
    let at =
        |of: Changed| problem(model, by_length, initial.clone(), start, Changed { grip, ..of });
    let name = format!("{model:?}, by length {by_length}, {initial:?} {start}, grip {grip}");
    let base = at(UNCHANGED);
    let record = base.simulation().record(&base.commands, DT).unwrap();
    let mut seen = [0; 3];
    count_slips(&record, &mut seen);
    assert!(seen[1] > 0 && seen[2] > 0, "{name}: {seen:?}");
    assert!(record.one_sided().is_empty(), "{name}: {:?}", record.one_sided());
    assert_eq!(record.holds_start(), start > 0.0, "{name}");
    let gradient = base.gradient();
    let scale = gradient.cables.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
    let expected = base.by_commands(|i| if by_length && i < 2 { 2e-8 } else { 2e-5 });
    for k in 0..STEPS {
        for i in 0..3 {
            close(gradient.cables[k][i], expected[k][i], scale, &format!("{name}: {k} {i}"));
        }
    }
    let of = |change: &dyn Fn(f64) -> Changed| difference(1e-5, |by| at(change(1.0 + by)).number());
    if record.holds_start() {
        return seen[0];
    }
    let factors = gradient.factors;
    let size = factors.stiffness.abs().max(factors.mass.abs());
    let stiffness = of(&|stiffness| Changed { stiffness, ..UNCHANGED });
    close(factors.stiffness, stiffness, size, &format!("{name}: stiffness"));
    let mass = of(&|mass| Changed { mass, ..UNCHANGED });
    close(factors.mass, mass, size, &format!("{name}: mass"));
    let damping = of(&|damping| Changed { damping, ..UNCHANGED });
    close(factors.damping, damping, size, &format!("{name}: damping"));
    seen[0]
}

/// From an equilibrium without tension, from rest, and from one in which the cables are taut.
#[test]
fn gradients_with_friction_are_those_of_differences() {
    let starts = [
        (Initial::Equilibrium, 0.0, 1.0),
        (Initial::Equilibrium, 0.0, 8.0),
        (Initial::Rest, 0.0, 1.0),
        (Initial::Equilibrium, 1.2, 1.0),
        (Initial::Equilibrium, 1.2, 8.0),
    ];
    for model in MODELS {
        let mut sticking = 0;
        for by_length in [false, true] {
            for (initial, start, grip) in &starts {
                sticking += check(model, by_length, initial, *start, *grip);
            }
        }
        assert!(sticking > 20, "{model:?}: {sticking}");
    }
}

/// From a state in the middle of a motion, whose holes remember what was before.
#[test]
fn gradients_with_friction_by_the_start_are_those_of_differences() {
    for model in MODELS {
        let problem = problem(model, false, Initial::Equilibrium, 0.0, UNCHANGED);
        problem.check_by_start(1e-4, &format!("{model:?}"));
    }
}

/// Where a motion comes to rest a hole is between sliding on and sticking: the record says in which steps derivatives are those of one side.
#[test]
fn steps_between_two_cases_are_named() {
    let mut problem =
        problem(ModelKind::CosseratDisks, false, Initial::Equilibrium, 0.0, UNCHANGED);
    problem.case.loads = Default::default();
    problem.options.loads.clear();
    // The cables run straight through the holes of a straight robot: the angle has no derivative at zero.
    problem.robot = robot(1.0, 1.0, vec![Cable { friction: Some(0.3), ..straight("a", 0.0, 0.0) }]);
    problem.case.commands.truncate(1);
    problem.commands = vec![Commands::tensions(&[1.0]), Commands::tensions(&[2.0])];
    let record = problem.simulation().record(&problem.commands, DT).unwrap();
    assert_eq!(record.one_sided(), [0, 1]);
}

/// Motors with inertia, antagonists on one shaft among them, one at the limit of its torque, pull cables that rub.
#[test]
fn gradients_by_motors_with_inertia_and_friction_are_those_of_differences() {
    let problem = |model: ModelKind,
                   limit: Option<f64>,
                   (k, by): (usize, f64),
                   [kp, km]: [f64; 2]| {
        let rubs =
            |cable: Cable| Cable { friction: Some(0.7), axial_stiffness: Some(9000.0), ..cable };
        let rigid = Cable { friction: Some(0.5), ..straight("c", 1.5, 0.008) };
        let cables = vec![rubs(helix()), rubs(straight("b", 3.0, 0.008)), rigid];
        let dynamics = MotorDynamics {
            damping: 2e-3,
            derivative: 6e-3,
            integral: 2.0,
            ..MotorDynamics::new(2e-5, 0.7)
        };
        let mut bend = Motor {
            stiffness: Some(5e3),
            dynamics: Some(dynamics),
            ..Motor::spool("bend", [(0, 0.01), (1, -0.01)])
        };
        bend.limits.effort = limit;
        let dynamics = MotorDynamics { integral: 0.0, ..dynamics };
        let side = Motor { dynamics: Some(dynamics), ..Motor::spool("side", [(2, 0.01)]) };
        let robot = robot(kp, km, cables).with_motors(vec![bend, side]).unwrap();
        let case = Case { loads: gravity(), ..Case::with_motors(&robot, &[0.0, 0.0]).unwrap() };
        let commands = (0..STEPS).map(|step| {
            let more = if step == k { by } else { 0.0 };
            let angles = [0.4 * COURSE[step] + more, 0.3 * COURSE[step] + 0.5 * more];
            Commands::of_case(&robot, &Case::with_motors(&robot, &angles).unwrap())
        });
        let commands = commands.collect();
        let damping = Damping::Time(2e-2 / kp);
        let options = MotionOptions { model, damping, initial: Initial::Rest, ..options() };
        Problem { robot, case, options, commands }
    };
    for (model, limit) in [
        (ModelKind::Cosserat, None),
        (ModelKind::Cosserat, Some(0.03)),
        (ModelKind::CosseratDisks, None),
    ] {
        let name = format!("{model:?} {limit:?}");
        let of = problem(model, limit, (STEPS, 0.0), [1.0; 2]);
        let record = of.simulation().record(&of.commands, DT).unwrap();
        assert!(record.one_sided().is_empty(), "{name}: {:?}", record.one_sided());
        let efforts = record.states.iter().map(|of| of.motors[0].effort.abs());
        let limited = efforts.filter(|effort| Some(*effort) == limit).count();
        assert_eq!(limited > 0, limit.is_some(), "{limited}");
        let gradient = of.gradient();
        let scale = gradient.motors.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
        for k in 0..STEPS {
            let by = difference(1e-5, |by| problem(model, limit, (k, by), [1.0; 2]).number());
            let found = gradient.motors[k][0] + 0.5 * gradient.motors[k][1];
            close(found, by, scale, &format!("{name} {k}"));
        }
        let at = |factors: [f64; 2]| problem(model, limit, (STEPS, 0.0), factors).number();
        let stiffness = difference(1e-5, |by| at([1.0 + by, 1.0]));
        close(gradient.factors.stiffness, stiffness, 0.1, &format!("{name} stiffness"));
        let mass = difference(1e-5, |by| at([1.0, 1.0 + by]));
        close(gradient.factors.mass, mass, 0.1, &format!("{name} mass"));
    }
}
