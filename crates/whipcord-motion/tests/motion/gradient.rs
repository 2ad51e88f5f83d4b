//! Gradients over motions against central differences.

use whipcord::robot::Motor;
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, ModelKind, Robot, Section, Shortening, Twist,
    Vec3,
};
use whipcord_motion::{
    BaseMotion, CableDrive, Commands, Course, Damping, Drag, Factors, Gradient, Initial,
    LoadCourse, Method, MotionError, MotionOptions, Record, Seed, Simulation, State,
};

use super::robots::{helix, straight};

pub(super) const DT: f64 = 8e-3;
pub(super) const STEPS: usize = 6;

/// A robot with factors on stiffness and mass.
pub(super) fn robot(stiffness: f64, mass: f64, cables: Vec<Cable>) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9 * stiffness),
            poisson_ratio: Some(0.3),
            density: Some(1040.0 * mass),
            ..Material::default()
        },
        ..Backbone::new(0.18)
    };
    let disks = Disks {
        mass: 1e-3 * mass,
        outer_radius: Some(0.01),
        thickness: Some(1e-3),
        ..Disks::equally_spaced(0.18, 5, 0.008)
    };
    Robot::new(backbone, disks, cables).unwrap()
}

/// A motion and a number of it.
pub(super) struct Problem {
    pub robot: Robot,
    pub case: Case,
    pub options: MotionOptions,
    pub commands: Vec<Commands>,
}

pub(super) fn weight(k: usize) -> f64 {
    (0.7 * k as f64 + 0.3).sin()
}

pub(super) fn vector(k: usize) -> Vec3 {
    Vec3::new(weight(k), weight(k + 5), weight(k + 11))
}

/// What the number depends on: positions, velocities and strains of all states with some weights.
fn seed(state: &State, k: usize) -> Seed {
    let twist =
        |i: usize, by: f64| Twist { linear: vector(i) * by, angular: vector(i + 3) * (0.01 * by) };
    Seed {
        positions: (0..state.poses.len()).map(|a| vector(a + 17 * k)).collect(),
        turns: Vec::new(),
        velocities: (0..state.velocities.len()).map(|a| twist(a + 7 * k, 0.1)).collect(),
        strains: (0..state.strains.len()).map(|q| twist(q + 3 * k, 0.2)).collect(),
    }
}

fn number(states: &[State], has_free_base: bool) -> f64 {
    let mut sum = 0.0;
    let dot = |a: &Twist, b: &Twist| a.linear.dot(b.linear) + a.angular.dot(b.angular);
    for (k, state) in states.iter().enumerate() {
        let seed = seed(state, k);
        sum +=
            state.poses.iter().zip(&seed.positions).map(|(p, w)| p.position.dot(*w)).sum::<f64>();
        // That of a base that is not free is given.
        let held = usize::from(!has_free_base);
        let velocities = state.velocities.iter().zip(&seed.velocities).skip(held);
        sum += velocities.map(|(v, w)| dot(v, w)).sum::<f64>();
        sum += state.strains.iter().zip(&seed.strains).map(|(x, w)| dot(x, w)).sum::<f64>();
    }
    sum
}

impl Problem {
    pub fn simulation(&self) -> Simulation {
        Simulation::new(&self.robot, &self.case, self.options.clone()).unwrap()
    }

    pub fn number(&self) -> f64 {
        self.number_from(self.simulation(), &self.commands)
    }

    /// The number of the motion from the start of this simulation by other commands.
    fn number_from(&self, mut simulation: Simulation, commands: &[Commands]) -> f64 {
        let states = simulation.record(commands, DT).unwrap().states;
        number(&states, self.options.has_free_base)
    }

    /// The derivatives of the number by each constant command, by step and cable, by differences of these sizes. The start, which
    /// commands do not change, is solved once.
    pub fn by_commands(&self, unit: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let start = self.simulation();
        let derivative = |k: usize, i: usize| {
            difference(unit(i), |by| {
                let mut commands = self.commands.clone();
                let drive = &mut commands[k].cables[i];
                assert_eq!(drive.course().rows(), None);
                let changed = Course::constant(drive.course().before(0.0) + by);
                *drive = match drive {
                    CableDrive::Tension(_) => CableDrive::Tension(changed),
                    CableDrive::Shortening(_) => CableDrive::Shortening(changed),
                };
                self.number_from(start.clone(), &commands)
            })
        };
        let cables = self.robot.cables().len();
        (0..STEPS).map(|k| (0..cables).map(|i| derivative(k, i)).collect()).collect()
    }

    pub fn gradient(&self) -> Gradient {
        let mut simulation = self.simulation();
        let record = simulation.record(&self.commands, DT).unwrap();
        let seeds: Vec<Seed> =
            record.states.iter().enumerate().map(|(k, state)| seed(state, k)).collect();
        let before = simulation.state().clone();
        let gradient = simulation.gradient(&record, &seeds).unwrap();
        assert_eq!(*simulation.state(), before);
        self.check_tangent(&mut simulation, &record, &seeds);
        assert_eq!(*simulation.state(), before);
        gradient
    }

    /// The derivatives by a state in the middle of the motion are those of differences of this size.
    pub fn check_by_start(&self, unit: f64, name: &str) {
        let (before, after) = self.commands.split_at(3);
        let mut simulation = self.simulation();
        simulation.record(before, DT).unwrap();
        let start = simulation.state().clone();
        let tip = |change: &dyn Fn(&mut State)| {
            let (mut simulation, mut state) = (simulation.clone(), start.clone());
            change(&mut state);
            simulation.set_state(&state).unwrap();
            let record = simulation.record(after, DT).unwrap();
            (record.states.last().unwrap().tip().position.dot(vector(1)), record)
        };
        let (_, record) = tip(&|_| ());
        let mut seeds = vec![Seed::default(); record.states.len()];
        let nodes = start.velocities.len();
        let mut positions = vec![Vec3::ZERO; nodes];
        positions[nodes - 1] = vector(1);
        seeds.last_mut().unwrap().positions = positions;
        let gradient = self.simulation().gradient(&record, &seeds).unwrap();
        let by = |axis: usize, size: f64| {
            let mut change = Vec3::ZERO;
            change[axis] = size;
            change
        };
        for axis in 0..3 {
            let name = format!("{name} {axis}");
            let velocity = difference(unit, |size| {
                tip(&|state| state.velocities[5].linear += by(axis, size)).0
            });
            close(gradient.velocities[5].linear[axis], velocity, 1e-3, &name);
            let strain =
                difference(unit, |size| tip(&|state| state.strains[3].angular += by(axis, size)).0);
            close(gradient.strains[3].angular[axis], strain, 1e-3, &name);
        }
    }
}

impl Problem {
    /// What the motion changes by along a direction, times the seeds, is the gradient times the direction.
    fn check_tangent(&self, simulation: &mut Simulation, record: &Record, seeds: &[Seed]) {
        let with_turns = |(k, seed): (usize, &Seed)| Seed {
            turns: (0..seed.positions.len()).map(|a| vector(a + 3 * k) * 0.1).collect(),
            ..seed.clone()
        };
        let seeds: Vec<Seed> = seeds.iter().enumerate().map(with_turns).collect();
        let gradient = simulation.gradient(record, &seeds).unwrap();
        let numbers = |list: &[Vec<f64>], by: f64| {
            let row = |(k, row): (usize, &Vec<f64>)| {
                (0..row.len()).map(|i| by * weight(5 * k + i + 2)).collect()
            };
            list.iter().enumerate().map(row).collect::<Vec<Vec<f64>>>()
        };
        let twists = |list: &[Twist], by: f64| {
            let of = |k: usize| Twist { linear: vector(k) * by, angular: vector(k + 1) * by };
            (0..list.len()).map(of).collect::<Vec<Twist>>()
        };
        let unit = if gradient.motors.iter().flatten().any(|x| *x != 0.0) { 0.1 } else { 1e-2 };
        let direction = Gradient {
            cables: numbers(&gradient.cables, 1e-2),
            motors: numbers(&gradient.motors, unit),
            velocities: twists(&gradient.velocities, 0.1),
            strains: twists(&gradient.strains, 0.05),
            factors: Factors { stiffness: 0.3, damping: -0.2, mass: 0.4 },
        };
        let dot = |a: &[Twist], b: &[Twist]| -> f64 {
            let pairs = a.iter().zip(b);
            pairs.map(|(a, b)| a.linear.dot(b.linear) + a.angular.dot(b.angular)).sum()
        };
        let flat = |a: &[Vec<f64>], b: &[Vec<f64>]| -> f64 {
            a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
        };
        let by_direction = [
            flat(&gradient.cables, &direction.cables),
            flat(&gradient.motors, &direction.motors),
            dot(&gradient.velocities, &direction.velocities),
            dot(&gradient.strains, &direction.strains),
            gradient.factors.stiffness * direction.factors.stiffness,
            gradient.factors.damping * direction.factors.damping,
            gradient.factors.mass * direction.factors.mass,
        ];
        let changes = simulation.tangent(record, &direction).unwrap();
        assert_eq!(changes.len(), seeds.len());
        let mut terms = Vec::new();
        for (seed, change) in seeds.iter().zip(&changes) {
            let positions = seed.positions.iter().zip(&change.positions);
            let turns = seed.turns.iter().zip(&change.turns);
            terms.extend(positions.chain(turns).map(|(a, b)| a.dot(*b)));
            let velocities = seed.velocities.iter().zip(&change.velocities);
            let twists = velocities.chain(seed.strains.iter().zip(&change.strains));
            terms.extend(
                twists.flat_map(|(a, b)| [a.linear.dot(b.linear), a.angular.dot(b.angular)]),
            );
        }
        let by_change: f64 = terms.iter().sum();
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        let apart = (by_direction.iter().sum::<f64>() - by_change).abs() / size;
        // The second derivatives of straight cables and of the discrete gradient are differences.
        let is_exact =
            self.options.model == ModelKind::Cosserat && self.options.method != Method::Energy;
        // Short parts behind an impact round more.
        let most =
            if record.states.iter().any(|of| of.diagnostics.parts > 3) { 4e-12 } else { 1e-12 };
        let bound = if is_exact { most } else { 1e-8 };
        let name = (self.options.model, self.options.method, self.options.has_free_base);
        assert!(apart < bound, "{name:?}: {apart:e}, {by_direction:?} {by_change}");
    }
}

pub(super) fn close(found: f64, expected: f64, scale: f64, what: &str) {
    let apart = (found - expected).abs() / scale.max(expected.abs());
    assert!(apart < 1e-6, "{what}: {found:e} against {expected:e} by differences ({apart:.1e})");
}

/// By Richardson's extrapolation of central differences.
pub(super) fn difference(h: f64, at: impl Fn(f64) -> f64) -> f64 {
    let central = |h: f64| (at(h) - at(-h)) / (2.0 * h);
    (4.0 * central(0.5 * h) - central(h)) / 3.0
}

pub(super) fn options() -> MotionOptions {
    let factor = Course::table(vec![0.0, 0.03], vec![0.2, 1.0]).unwrap();
    let loads = Loads {
        tip_force: Vec3::new(0.0, 0.03, -0.02),
        tip_moment: Vec3::new(1e-3, 0.0, 5e-4),
        ..Loads::default()
    };
    MotionOptions {
        damping: Damping::Time(2e-3),
        drag: Drag { across: 0.05, along: 0.02 },
        elements: 4,
        loads: vec![LoadCourse { loads, factor }],
        iteration_tolerance: 1e-13,
        ..MotionOptions::default()
    }
}

pub(super) fn gravity() -> Loads {
    Loads { gravity: Some(Vec3::new(4.0, -7.0, 3.0)), ..Loads::default() }
}

/// Cables along their routing, and straight from disk to disk.
const WAYS: [(ModelKind, Method); 4] = [
    (ModelKind::Cosserat, Method::Accurate),
    (ModelKind::Cosserat, Method::Robust),
    (ModelKind::CosseratDisks, Method::Accurate),
    (ModelKind::CosseratDisks, Method::Robust),
];

/// The same by discrete gradients.
const CONSERVING: [(ModelKind, Method); 2] =
    [(ModelKind::Cosserat, Method::Energy), (ModelKind::CosseratDisks, Method::Energy)];

pub(super) fn by_tensions(
    way: (ModelKind, Method),
    stiffness: f64,
    mass: f64,
    damping: f64,
) -> Problem {
    let (model, method) = way;
    let commands = (0..STEPS).map(|k| Commands::tensions(&[2.0 + weight(k), 1.5 - weight(k)]));
    Problem {
        robot: robot(stiffness, mass, vec![helix(), straight("b", 2.0, 0.008)]),
        case: Case { loads: gravity(), ..Case::with_tensions(&[1.0, 0.5]) },
        // The damping is a time, of the stiffness.
        options: MotionOptions {
            model,
            method,
            damping: Damping::Time(2e-3 * damping / stiffness),
            ..options()
        },
        commands: commands.collect(),
    }
}

#[test]
fn gradients_by_tensions_and_properties_are_those_of_differences() {
    for method in WAYS.into_iter().chain(CONSERVING) {
        let gradient = by_tensions(method, 1.0, 1.0, 1.0).gradient();
        let scale = gradient.cables.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
        assert!(scale > 1e-3);
        for k in 0..STEPS {
            for i in 0..2 {
                let expected = difference(1e-2, |by| {
                    let mut problem = by_tensions(method, 1.0, 1.0, 1.0);
                    let tension = problem.commands[k].cables[i].course().before(0.0) + by;
                    problem.commands[k].set_tension(i, tension);
                    problem.number()
                });
                close(gradient.cables[k][i], expected, scale, &format!("{method:?}: {k} {i}"));
            }
        }
        let factors = gradient.factors;
        let of = |at: &dyn Fn(f64) -> Problem| difference(1e-3, |by| at(1.0 + by).number());
        let stiffness = of(&|x| by_tensions(method, x, 1.0, 1.0));
        close(factors.stiffness, stiffness, 0.1, "stiffness");
        close(factors.mass, of(&|x| by_tensions(method, 1.0, x, 1.0)), 0.1, "mass");
        close(factors.damping, of(&|x| by_tensions(method, 1.0, 1.0, x)), 0.1, "damping");
    }
}

/// A state to start from, on a base that moves.
#[test]
fn gradients_by_the_start_are_those_of_differences() {
    for method in WAYS.into_iter().chain(CONSERVING) {
        let mut problem = by_tensions(method, 1.0, 1.0, 1.0);
        let mut start = problem.simulation().state().start();
        for (a, velocity) in start.velocities.iter_mut().enumerate().skip(1) {
            *velocity = Twist { linear: vector(a) * 0.05, angular: vector(a + 1) };
        }
        let of = |problem: &Problem, start: &whipcord_motion::Start| {
            let mut base = BaseMotion::default();
            base.velocity[1] = Course::table(vec![0.0, 0.02, 0.02], vec![0.1, 0.3, 0.0]).unwrap();
            base.angular_velocity[0] = Course::constant(2.0);
            MotionOptions {
                initial: Initial::State(Box::new(start.clone())),
                base: Some(base),
                ..problem.options.clone()
            }
        };
        problem.options = of(&problem, &start);
        let gradient = problem.gradient();
        for component in 0..6 {
            let part = |twist: &mut Twist, by: f64| {
                let of = if component < 3 { &mut twist.linear } else { &mut twist.angular };
                of[component % 3] += by;
            };
            let value = |twist: &Twist| {
                let of = if component < 3 { twist.linear } else { twist.angular };
                of[component % 3]
            };
            let unit = if component < 3 { 1e-4 } else { 1e-2 };
            let differ = |change: &dyn Fn(&mut whipcord_motion::Start, f64)| {
                difference(unit, |by| {
                    let mut moved = start.clone();
                    change(&mut moved, by);
                    let options = of(&problem, &moved);
                    Problem { options, ..by_tensions(method, 1.0, 1.0, 1.0) }.number()
                })
            };
            let velocity = differ(&|start, by| part(&mut start.velocities[3], by));
            close(value(&gradient.velocities[3]), velocity, 1e-2, &format!("velocity {component}"));
            let strain = differ(&|start, by| part(&mut start.strains[5], by));
            close(value(&gradient.strains[5]), strain, 1e-2, &format!("strain {component}"));
        }
    }
}

/// Cables that are driven by their lengths, some of which go slack.
#[test]
fn gradients_by_lengths_are_those_of_differences() {
    for (model, method) in WAYS {
        by_lengths(model, method);
    }
}

fn by_lengths(model: ModelKind, method: Method) {
    let problem = |k: usize, i: usize, by: f64| {
        let cables = (0..3).map(|i| Cable {
            axial_stiffness: (i == 0).then_some(9000.0),
            ..straight(&format!("{i}"), 2.1 * f64::from(i), 0.008)
        });
        let told = |step: usize| {
            let mut drives: Vec<f64> = vec![1e-3 * (1.0 + step as f64), -4e-3, 4e-4];
            if step == k {
                drives[i] += by;
            }
            let shortening = |by: f64| CableDrive::Shortening(Course::constant(by));
            let mut drives: Vec<CableDrive> = drives.into_iter().map(shortening).collect();
            // One by its tension beside them.
            let tension = if step == k && i == 2 { 0.8 + 100.0 * by } else { 0.8 };
            drives[2] = CableDrive::Tension(Course::constant(tension));
            Commands::new(drives)
        };
        let shortenings =
            [Shortening::Length(1e-3), Shortening::Length(0.0), Shortening::Length(0.0)];
        Problem {
            robot: robot(1.0, 1.0, cables.collect()),
            case: Case { loads: gravity(), ..Case::with_shortenings(&shortenings) },
            options: MotionOptions { model, method, ..options() },
            commands: (0..STEPS).map(told).collect(),
        }
    };
    let of = problem(STEPS, 0, 0.0);
    let record = of.simulation().record(&of.commands, DT).unwrap();
    assert!(record.states.iter().skip(1).any(|state| state.cables[0].tension > 0.0));
    assert!(record.states.iter().skip(1).any(|state| state.cables[1].tension == 0.0));
    let gradient = of.gradient();
    let scale = gradient.cables.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
    for k in 0..STEPS {
        for i in 0..3 {
            let unit = if i == 2 { 100.0 } else { 1.0 };
            let expected = difference(2e-6, |by| problem(k, i, by).number());
            let found = gradient.cables[k][i] * unit;
            assert!(
                (found - expected).abs() < 1e-5 * scale,
                "{model:?} {method:?} {k} {i}: {found:e} against {expected:e}"
            );
        }
    }
}

/// Motors with play: a command within the play moves nothing.
#[test]
fn gradients_by_motors_are_those_of_differences() {
    for (model, method) in WAYS {
        by_motors(model, method);
    }
}

fn by_motors(model: ModelKind, method: Method) {
    let angles = [0.3, 0.5, 0.48, 0.49, 0.2, 0.6];
    let problem = |k: usize, by: f64| {
        let cables = vec![straight("a", 0.0, 0.008), straight("b", 3.0, 0.008)];
        let motor = Motor {
            stiffness: Some(5e3),
            backlash: 0.1,
            ..Motor::spool("bend", [(0, 0.01), (1, -0.01)])
        };
        let robot = robot(1.0, 1.0, cables).with_motors(vec![motor]).unwrap();
        let case = Case::with_motors(&robot, &[0.1]).unwrap();
        let commands = (0..STEPS).map(|step| {
            let angle = angles[step] + if step == k { by } else { 0.0 };
            Commands::of_case(&robot, &Case::with_motors(&robot, &[angle]).unwrap())
        });
        let commands = commands.collect();
        Problem { robot, case, options: MotionOptions { model, method, ..options() }, commands }
    };
    let gradient = problem(STEPS, 0.0).gradient();
    let scale = gradient.motors.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
    // From 0.5 back to 0.48 and on to 0.49 the drive keeps its place.
    assert_eq!(gradient.motors[2][0], 0.0);
    for k in 0..STEPS {
        let expected = difference(1e-4, |by| problem(k, by).number());
        let found = gradient.motors[k][0];
        assert!(
            (found - expected).abs() < 1e-5 * scale,
            "{model:?} {method:?} {k}: {found:e} against {expected:e}"
        );
    }
}

/// A robot that flies: nothing holds its base, and its drives ride on it.
#[test]
fn gradients_with_a_free_base_are_those_of_differences() {
    for way in WAYS.into_iter().chain(CONSERVING) {
        let flying = |by_tension: f64, stiffness: f64, mass: f64| {
            let mut problem = by_tensions(way, stiffness, mass, 1.0);
            problem.options.has_free_base = true;
            let tension = problem.commands[2].cables[0].course().before(0.0) + by_tension;
            problem.commands[2].set_tension(0, tension);
            problem
        };
        let problem = flying(0.0, 1.0, 1.0);
        let gradient = problem.gradient();
        let moved = problem.simulation().record(&problem.commands, DT).unwrap();
        let base = moved.states[STEPS].base;
        assert!(base.position.norm() > 5e-3 && base.rotation.log().norm() > 0.05, "{base:?}");
        let of = |h: f64, at: &dyn Fn(f64) -> Problem| difference(h, |by| at(by).number());
        let tension = of(1e-2, &|by| flying(by, 1.0, 1.0));
        close(gradient.cables[2][0], tension, 1e-3, &format!("{way:?} tension"));
        let stiffness = of(1e-3, &|by| flying(0.0, 1.0 + by, 1.0));
        close(gradient.factors.stiffness, stiffness, 0.1, &format!("{way:?} stiffness"));
        let mass = of(1e-3, &|by| flying(0.0, 1.0, 1.0 + by));
        close(gradient.factors.mass, mass, 0.1, &format!("{way:?} mass"));
        // A state to start from, whose base moves.
        let mut start = problem.simulation().state().start();
        for (a, velocity) in start.velocities.iter_mut().enumerate() {
            *velocity = Twist { linear: vector(a) * 0.05, angular: vector(a + 1) };
        }
        let from = |node: usize, by: Twist| {
            let mut problem = flying(0.0, 1.0, 1.0);
            let mut start = start.clone();
            start.velocities[node] = start.velocities[node] + by;
            problem.options.initial = Initial::State(Box::new(start));
            problem
        };
        let gradient = from(0, Twist::default()).gradient();
        for node in [0, 3] {
            let along = Twist { linear: vector(2) * 0.1, angular: vector(7) };
            let by = of(1e-2, &|by| from(node, along * by));
            let found = gradient.velocities[node];
            let found = found.linear.dot(along.linear) + found.angular.dot(along.angular);
            close(found, by, 1e-2, &format!("{way:?} velocity {node}"));
        }
    }
}

/// Motors with inertia, friction of their own and all gains, antagonists on one shaft among them; one reaches the limit of its torque.
#[test]
fn gradients_by_motors_with_inertia_are_those_of_differences() {
    let problem = |model: ModelKind, limit: Option<f64>, k: usize, by: f64, [kp, km]: [f64; 2]| {
        let cables = vec![
            Cable { axial_stiffness: Some(9000.0), ..straight("a", 0.0, 0.008) },
            Cable { axial_stiffness: Some(9000.0), ..straight("b", 3.0, 0.008) },
            Cable { axial_stiffness: Some(9000.0), ..straight("c", 1.5, 0.008) },
        ];
        let dynamics = whipcord::MotorDynamics {
            damping: 2e-3,
            derivative: 6e-3,
            integral: 2.0,
            ..whipcord::MotorDynamics::new(2e-5, 0.7)
        };
        let mut bend = Motor {
            stiffness: Some(5e3),
            dynamics: Some(dynamics),
            ..Motor::spool("bend", [(0, 0.01), (1, -0.01)])
        };
        bend.limits.effort = limit;
        let dynamics = whipcord::MotorDynamics { integral: 0.0, ..dynamics };
        let side = Motor { dynamics: Some(dynamics), ..Motor::spool("side", [(2, 0.01)]) };
        let robot = robot(kp, km, cables).with_motors(vec![bend, side]).unwrap();
        let case = Case { loads: gravity(), ..Case::with_motors(&robot, &[0.1, 0.05]).unwrap() };
        let commands = (0..STEPS).map(|step| {
            let more = if step == k { by } else { 0.0 };
            let angles = [0.3 + 0.1 * weight(step) + more, 0.2 + 0.5 * more];
            Commands::of_case(&robot, &Case::with_motors(&robot, &angles).unwrap())
        });
        let commands = commands.collect();
        let damping = Damping::Time(2e-3 / kp);
        Problem { robot, case, options: MotionOptions { model, damping, ..options() }, commands }
    };
    for (model, limit) in [
        (ModelKind::Cosserat, None),
        (ModelKind::Cosserat, Some(0.04)),
        (ModelKind::CosseratDisks, None),
    ] {
        let of = problem(model, limit, STEPS, 0.0, [1.0, 1.0]);
        let states = of.simulation().record(&of.commands, DT).unwrap().states;
        let limited = states.iter().filter(|of| Some(of.motors[0].effort.abs()) == limit).count();
        assert_eq!(limited > 0, limit.is_some(), "{limited}");
        assert!(states.iter().skip(1).any(|of| of.cables[1].tension == 0.0));
        let gradient = of.gradient();
        let scale = gradient.motors.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
        for k in 0..STEPS {
            let by = difference(1e-4, |by| problem(model, limit, k, by, [1.0; 2]).number());
            let found = gradient.motors[k][0] + 0.5 * gradient.motors[k][1];
            close(found, by, scale, &format!("{model:?} {limit:?} {k}"));
        }
        let at = |factors: [f64; 2]| problem(model, limit, STEPS, 0.0, factors).number();
        let stiffness = difference(1e-4, |by| at([1.0 + by, 1.0]));
        close(
            gradient.factors.stiffness,
            stiffness,
            0.1,
            &format!("{model:?} {limit:?} stiffness"),
        );
        let mass = difference(1e-4, |by| at([1.0, 1.0 + by]));
        close(gradient.factors.mass, mass, 0.1, &format!("{model:?} {limit:?} mass"));
    }
}

/// An obstacle that is not touched changes nothing.
#[test]
fn gradients_beside_obstacles_are_those_without_them() {
    let mut problem = by_tensions((ModelKind::Cosserat, Method::Accurate), 1.0, 1.0, 1.0);
    let without = problem.gradient();
    let pose =
        whipcord::Pose { position: Vec3::new(-0.079, 0.173, 0.13), ..whipcord::Pose::IDENTITY };
    let form = whipcord::Form::Sphere { radius: 0.1 };
    let ball =
        whipcord::Obstacle { name: "ball".to_owned(), form, pose, friction: 0.3, movable: None };
    problem.case.obstacles = vec![ball];
    let beside = problem.gradient();
    for (a, b) in beside.cables.iter().flatten().zip(without.cables.iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn what_has_no_gradient_is_refused() {
    let mut problem = by_tensions((ModelKind::Cosserat, Method::Robust), 1.0, 1.0, 1.0);
    problem.options.tolerance = Some(1e-4);
    let refused = problem.simulation().record(&problem.commands, DT);
    assert!(matches!(refused, Err(MotionError::Unsupported { .. })));
    let problem = by_tensions((ModelKind::Cosserat, Method::Accurate), 1.0, 1.0, 1.0);
    let mut simulation = problem.simulation();
    let record = simulation.record(&problem.commands, DT).unwrap();
    let none = vec![Seed::default(); STEPS + 1];
    let zero = simulation.gradient(&record, &none).unwrap();
    assert!(zero.cables.iter().flatten().all(|x| *x == 0.0));
    assert!(matches!(simulation.gradient(&record, &none[1..]), Err(MotionError::Count { .. })));
    let mut short = none;
    short[0].positions = vec![Vec3::ZERO];
    assert!(matches!(simulation.gradient(&record, &short), Err(MotionError::Count { .. })));
}
