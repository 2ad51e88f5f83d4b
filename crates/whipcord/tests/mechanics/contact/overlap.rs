//! Random robots that are pulled against random obstacles: how far the returned shape enters them, measured at dense
//! stations by the distance to the obstacle alone; and whether the base bears what pushes.

#![allow(clippy::print_stdout, reason = "a study tells what it found")]

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::LazyLock;
use std::time::Instant;

use proptest::prelude::*;
use whipcord::four_bar::{FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, Loads, Material, Model, ModelKind, Obstacle,
    Obstruction, Part, Pose, Robot, Routing, Section, Shortening, Solution, SolveError, Statics,
    Stations, UnitQuaternion, Vec3,
};

use crate::common::{ball, bending_stiffness, samples};
use crate::contact::among;

/// The robot, its shortenings, and an obstacle with where along the robot and how deep in the free shape it stands.
#[derive(Clone, Debug)]
struct Scenario {
    robot: Robot,
    case: Case,
    form: Form,
    turn: Vec3,
    at: f64,
    depth: f64,
    aside: f64,
}

fn form() -> impl Strategy<Value = Form> {
    // Sizes by the robot's length.
    let size = || (-2.3..-0.6_f64).prop_map(|power| 10.0_f64.powf(power));
    prop_oneof![
        2 => size().prop_map(|radius| Form::Sphere { radius }),
        1 => (size(), 0.05..0.6).prop_map(|(radius, length)| Form::Capsule { radius, length }),
        1 => (size(), 0.05..0.6).prop_map(|(radius, length)| Form::Cylinder { radius, length }),
        1 => (size(), size(), size()).prop_map(|(x, y, z)| Form::Box { size: Vec3::new(x, y, z) }),
        1 => Just(Form::HalfSpace),
    ]
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let cables = proptest::collection::vec((0.0..360.0_f64, -0.4..0.4_f64, -0.01..0.1_f64), 1..4);
    let robot = (0.05..0.4_f64, 3..14_usize, 40.0..120.0_f64, proptest::bool::ANY);
    (robot, cables, form(), ball(), (0.3..1.0_f64, 0.0..0.15_f64, -1.0..1.0_f64)).prop_map(
        |((length, disks, slender, plates), cables, form, turn, (at, depth, aside))| {
            let diameter = length / slender;
            let radius = 1.5 * diameter;
            let material = Material {
                young_modulus: Some(1.1e9),
                poisson_ratio: Some(0.3),
                ..Material::default()
            };
            let section = Some(Section::circle(diameter));
            let backbone = Backbone { material, section, ..Backbone::new(length) };
            // Without plates the backbone touches first, but where a cable passes.
            let outer = if plates { 2.0 * diameter } else { 0.51 * diameter };
            let radius = if plates { radius } else { 0.5 * diameter };
            let disks = Disks {
                outer_radius: Some(outer),
                thickness: Some(0.2 * outer),
                ..Disks::equally_spaced(length, disks, radius)
            };
            let routing = |&(degrees, turns, _): &(f64, f64, f64)| Routing::Helix {
                start_angle: degrees.to_radians(),
                turns: if plates { turns } else { 0.0 },
                radius,
            };
            let named = |(i, routing)| Cable::new(format!("cable {i}"), routing);
            let list = cables.iter().map(routing).enumerate().map(named).collect();
            let shortenings: Vec<Shortening> =
                cables.iter().map(|cable| Shortening::Fraction(cable.2)).collect();
            let sized = |form| match form {
                Form::Sphere { radius } => Form::Sphere { radius: radius * length },
                Form::Capsule { radius, length: l } => {
                    Form::Capsule { radius: radius * length, length: l * length }
                }
                Form::Cylinder { radius, length: l } => {
                    Form::Cylinder { radius: radius * length, length: l * length }
                }
                Form::Box { size } => Form::Box { size: size * length },
                other => other,
            };
            Scenario {
                robot: Robot::new(backbone, disks, list).unwrap(),
                case: Case::with_shortenings(&shortenings),
                form: sized(form),
                turn: turn * 3.0,
                at,
                depth,
                aside,
            }
        },
    )
}

/// A model with the shape at many stations.
type Solve = fn(&Robot, &Case) -> Result<Solution, SolveError>;

/// For the rod they lie at sixths of the intervals between the watched places.
const STATIONS: usize = 97;

fn rod(
    kind: ModelKind,
    actuation: Actuation,
    robot: &Robot,
    case: &Case,
) -> Result<Solution, SolveError> {
    let model = Model::new(kind, Stations::Equal(STATIONS), actuation);
    model.prepare(robot, &Loads::default())?.solve(case, None)
}

fn by_length(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::Cosserat, Actuation::Shortening, robot, case)
}

fn disks_by_length(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::CosseratDisks, Actuation::Shortening, robot, case)
}

/// Pulled with tensions in proportion to the shortenings, and not at all where a cable is let out.
fn by_tension(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::Cosserat, Actuation::Tension, robot, &pulled(robot, case))
}

fn disks_by_tension(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::CosseratDisks, Actuation::Tension, robot, &pulled(robot, case))
}

fn arcs_by_length(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::PiecewiseConstantCurvature, Actuation::Shortening, robot, case)
}

fn arcs_by_tension(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::PiecewiseConstantCurvature, Actuation::Tension, robot, &pulled(robot, case))
}

fn bodies_by_length(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::PseudoRigidBody, Actuation::Shortening, robot, case)
}

fn bodies_by_tension(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    rod(ModelKind::PseudoRigidBody, Actuation::Tension, robot, &pulled(robot, case))
}

/// The case with tensions instead.
fn pulled(robot: &Robot, case: &Case) -> Case {
    let stiffness = bending_stiffness(robot);
    let mut case = case.clone();
    for (cable, command) in robot.cables().iter().zip(&mut case.commands) {
        if let (&Routing::Helix { radius, .. }, Some(Shortening::Fraction(part))) =
            (&cable.routing, command.shortening.take())
        {
            // A straight cable bends the rod by part L/r under this tension.
            command.tension = Some(part.max(0.0) * stiffness / (radius * radius));
        }
    }
    case
}

fn four_bar(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let options = Options {
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        stations: Stations::Equal(STATIONS),
        ..Options::default()
    };
    FourBar::new(robot, &options)?.solve(case, None, &mut Workspace::default())
}

/// The scenario's case with its obstacle where the free robot would be.
fn placed(solve: Solve, scenario: &Scenario) -> Option<Case> {
    let Scenario { robot, case, form, turn, at, depth, aside } = scenario;
    let free = solve(robot, case).ok()?;
    let k = (at * (STATIONS - 1) as f64) as usize;
    let (there, s) = (free.shape.poses[k].position, free.shape.arc_length[k]);
    let away = there - Vec3::Z * s;
    let length = robot.backbone().length;
    if away.norm() < 0.1 * length {
        return None;
    }
    let out = away / away.norm();
    let across = out.cross(free.shape.poses[k].rotation.rotate(Vec3::Z));
    let mut obstacle = Obstacle {
        name: "thing".to_owned(),
        form: form.clone(),
        pose: Pose { position: Vec3::ZERO, rotation: UnitQuaternion::exp(*turn) },
        friction: 0.0,
        movable: None,
    };
    if matches!(form, Form::HalfSpace) {
        // Its free side is that of the base.
        let axis = Vec3::Z.cross(-out);
        let angle = Vec3::Z.dot(-out).acos();
        let rotation = UnitQuaternion::exp(axis * (angle / axis.norm().max(1e-12)));
        obstacle.pose.rotation = rotation;
    }
    // Out along the way until the point is as deep in it as wanted.
    let (mut near, mut far) = (0.0, 2.0 * length);
    for _ in 0..60 {
        let middle = 0.5 * (near + far);
        obstacle.pose.position = there + out * middle + across * (0.02 * aside * length);
        let deep = obstacle.surface(there).distance < -depth * away.norm();
        if deep { near = middle } else { far = middle }
    }
    Some(among(case.clone(), vec![obstacle]))
}

/// The deepest overlaps by the length with where they are.
#[derive(Clone, Copy, Debug)]
struct Deepest {
    /// Of disks, and of the backbone at disks: places that are watched.
    watched: (f64, Part, f64),
    /// Of the backbone anywhere.
    along: (f64, Part, f64),
}

/// The distance to the obstacles of many points of every disk and of the backbone at dense stations.
fn overlap(robot: &Robot, case: &Case, solution: &Solution) -> Deepest {
    const PARTS: [f64; 6] = [0.0, 0.3, 0.6, 0.8, 0.95, 1.0];
    let length = robot.backbone().length;
    let none = (0.0, Part::Backbone, 0.0);
    let mut deepest = Deepest { watched: none, along: none };
    let note = |into: &mut (f64, Part, f64), gap: f64, part: Part, s: f64| {
        if -gap / length > into.0 {
            *into = (-gap / length, part, s / length);
        }
    };
    let rounding = 0.5 * robot.disks().thickness.unwrap();
    let flat = robot.disks().outer_radius.unwrap() - rounding;
    let first = robot.disks().arc_lengths[1];
    for obstacle in &case.obstacles {
        let backbone = |pose: &Pose, s: f64| {
            let radius = robot.backbone().outer_radius_at(robot.disks(), s);
            obstacle.surface(pose.position).distance - radius
        };
        let shape = &solution.shape;
        for (&s, pose) in shape.arc_length.iter().zip(&shape.poses) {
            // The base is clamped: what is beside it does not yield.
            if s > (length / 40.0).min(first) {
                note(&mut deepest.along, backbone(pose, s), Part::Backbone, s);
            }
        }
        for (k, pose) in solution.disks.poses.iter().enumerate().skip(1) {
            let s = robot.disks().arc_lengths[k];
            note(&mut deepest.watched, backbone(pose, s), Part::Backbone, s);
            for step in 0..180 {
                let (sin, cos) = (f64::from(step) * 2.0).to_radians().sin_cos();
                for part in PARTS {
                    let point = pose.transform(Vec3::new(cos, sin, 0.0) * (part * flat));
                    let gap = obstacle.surface(point).distance - rounding;
                    note(&mut deepest.watched, gap, Part::Disk(k), s);
                }
            }
        }
    }
    deepest
}

/// What is left of the equilibrium of the whole robot, on which nothing acts but the contacts, relative to the sums of the
/// sizes of their forces and moments.
fn unbalanced(solution: &Solution) -> f64 {
    let base = solution.base_wrench.unwrap();
    let (mut force, mut moment) = (base.force, base.moment);
    let (mut forces, mut moments) = (f64::MIN_POSITIVE, f64::MIN_POSITIVE);
    for touch in &solution.contacts {
        let push = touch.normal * touch.force.unwrap();
        force -= push;
        moment -= touch.point.cross(push);
        forces += push.norm();
        moments += touch.point.norm() * push.norm();
    }
    if solution.contacts.is_empty() {
        return 0.0;
    }
    (force.norm() / forces).max(moment.norm() / moments)
}

/// What a sweep found: answers, those that touch (and with the backbone), the largest gap of a contact, the deepest
/// overlaps, and what is left of equilibrium.
#[derive(Debug, Default)]
struct Sweep {
    answers: usize,
    touching: usize,
    backbone: usize,
    gap: f64,
    watched: f64,
    along: f64,
    unbalanced: f64,
}

fn sweep(solve: Solve, take: &dyn Fn(usize) -> bool, count: usize, tell: bool) -> Sweep {
    let mut sweep = Sweep::default();
    let numbered = samples(scenario(), count).enumerate();
    for (number, scenario) in numbered.filter(|(number, _)| take(*number)) {
        let Some(case) = placed(solve, &scenario) else { continue };
        let solution = match solve(&scenario.robot, &case) {
            Ok(solution) => solution,
            Err(error) => {
                if tell {
                    println!("{number} {}: {error}", scenario.form.name());
                }
                continue;
            }
        };
        let length = scenario.robot.backbone().length;
        let contacts = &solution.contacts;
        let gap = contacts.iter().map(|t| t.gap.abs() / length).fold(0.0, f64::max);
        let deepest = overlap(&scenario.robot, &case, &solution);
        let left = unbalanced(&solution);
        if tell {
            let name = scenario.form.name();
            let at: Vec<_> = contacts.iter().map(|t| (t.part, t.arc_length / length)).collect();
            println!("{number} {name}: gap {gap:.1e}, {deepest:?}, unbalanced {left:.1e}, {at:?}");
        }
        sweep.answers += 1;
        sweep.touching += usize::from(!contacts.is_empty());
        sweep.backbone += usize::from(contacts.iter().any(|t| t.part == Part::Backbone));
        sweep.unbalanced = sweep.unbalanced.max(left);
        sweep.gap = sweep.gap.max(gap);
        sweep.watched = sweep.watched.max(deepest.watched.0);
        sweep.along = sweep.along.max(deepest.along.0);
    }
    sweep
}

fn assert_clear(found: &Sweep) {
    assert!(found.touching > 0, "{found:?}");
    assert!(found.gap <= 1e-8 && found.watched <= 1e-8, "{found:?}");
    assert!(found.along <= ALONG, "{found:?}");
    assert!(found.unbalanced < 1e-6, "{found:?}");
}

/// What the backbone may overlap anywhere, by the length: between the watched places nothing is guaranteed.
const ALONG: f64 = 1e-7;

/// Those of the first robots of the study that are solved quickly.
#[test]
fn rods_held_at_lengths_do_not_enter_obstacles() {
    assert_clear(&sweep(by_length, &|number| [3, 4, 6, 7].contains(&number), 8, false));
}

#[test]
fn rods_under_tensions_do_not_enter_obstacles() {
    assert_clear(&sweep(by_tension, &|number| [3, 4, 6, 7].contains(&number), 8, false));
}

#[test]
fn rods_with_cables_from_hole_to_hole_do_not_enter_obstacles() {
    assert_clear(&sweep(disks_by_length, &|number| [3, 4, 6, 7].contains(&number), 8, false));
    assert_clear(&sweep(disks_by_tension, &|number| [3, 4, 6, 7].contains(&number), 8, false));
}

#[test]
fn sections_of_arcs_and_of_bodies_do_not_enter_obstacles() {
    for solve in [arcs_by_length, arcs_by_tension, bodies_by_length, bodies_by_tension] {
        assert_clear(&sweep(solve, &|number| [3, 4, 6, 7].contains(&number), 8, false));
    }
}

#[test]
fn four_bar_sections_do_not_enter_obstacles() {
    assert_clear(&sweep(four_bar, &|number| [3, 6, 7, 11].contains(&number), 15, false));
}

/// `cargo test --release -p whipcord --test mechanics contact::overlap:: -- --ignored --nocapture`
fn study(solve: Solve) {
    let found = sweep(solve, &|_| true, 60, true);
    println!("{found:?}");
    assert_clear(&found);
}

#[test]
#[ignore = "a study, which takes minutes"]
fn study_of_lengths() {
    study(by_length);
}

#[test]
#[ignore = "a study, which takes minutes"]
fn study_of_tensions() {
    study(by_tension);
}

#[test]
#[ignore = "a study, which takes minutes"]
fn study_of_cables_from_hole_to_hole() {
    study(disks_by_tension);
    study(disks_by_length);
}

#[test]
#[ignore = "a study, which takes minutes"]
fn study_of_four_bar() {
    study(four_bar);
}

#[test]
#[ignore = "a study, which takes minutes"]
fn study_of_arcs() {
    study(arcs_by_tension);
    study(arcs_by_length);
}

#[test]
#[ignore = "a study, which takes minutes"]
fn study_of_bodies() {
    study(bodies_by_tension);
    study(bodies_by_length);
}

/// Other ways to an answer of a model that was refused: finer meshes, and steps of actuation one after the other, each from the answer before.
const FINER: [(&str, Finer); 3] =
    [("finer", Finer::Mesh), ("in 24 steps", Finer::Steps(24)), ("in 96 steps", Finer::Steps(96))];

#[derive(Clone, Copy, Debug)]
enum Finer {
    /// Of a model whose mesh can be finer.
    Mesh,
    /// Each a part of the whole way.
    Steps(usize),
}

/// Another way to the answer to a case whose commands are those that the model is driven by; `None` where the model has none.
fn solved_otherwise(
    kind: ModelKind,
    way: Finer,
    robot: &Robot,
    case: &Case,
) -> Option<Result<Solution, SolveError>> {
    let stations = Stations::Equal(STATIONS);
    let rods = |accuracy| whipcord::cosserat::Options {
        accuracy,
        stations: stations.clone(),
        ..Default::default()
    };
    let fine = whipcord::cosserat::Accuracy::Steps(240);
    match (way, kind) {
        (Finer::Mesh, ModelKind::Cosserat) => Some(Model::Cosserat(rods(fine)).solve(robot, case)),
        (Finer::Mesh, ModelKind::CosseratDisks) => {
            Some(Model::CosseratDisks(rods(fine)).solve(robot, case))
        }
        (Finer::Mesh, _) => None,
        (Finer::Steps(parts), _) => {
            let model = crate::common::model_with_forces(kind, stations, Actuation::Natural);
            let mut prepared = match model.prepare(robot, &Loads::default()) {
                Ok(prepared) => prepared,
                Err(error) => return Some(Err(error)),
            };
            if robot.cables().iter().any(Cable::has_friction) {
                // What the holes remember goes with the case.
                let divided = crate::cosserat_disks::friction_study::divided(case, parts);
                return Some(prepared.solve(&divided, None));
            }
            let mut last = None;
            for part in 1..=parts {
                let mut step = case.clone();
                let share = part as f64 / parts as f64;
                for command in &mut step.commands {
                    command.tension = command.tension.map(|tension| share * tension);
                    command.shortening = command.shortening.map(|shortening| match shortening {
                        Shortening::Fraction(fraction) => Shortening::Fraction(share * fraction),
                        Shortening::Length(length) => Shortening::Length(share * length),
                    });
                }
                match prepared.solve(&step, last.as_ref()) {
                    Ok(solution) => last = Some(solution),
                    Err(error) => return Some(Err(error)),
                }
            }
            last.map(Ok)
        }
    }
}

/// Which other way finds an answer that does not overlap, and that touches or is known to be stable; `None` where none does: the refusal
/// is confirmed.
fn way_to_answer(kind: ModelKind, robot: &Robot, case: &Case) -> Option<&'static str> {
    let finds = |way: Finer| {
        let found = solved_otherwise(kind, way, robot, case);
        found.and_then(Result::ok).is_some_and(|solution| {
            let depth = overlap(robot, case, &solution).watched.0;
            let stable = solution.diagnostics.stable;
            let stands = stable.map_or(!solution.contacts.is_empty(), |stable| stable);
            depth <= 1e-8 && stands
        })
    };
    FINER.iter().find(|(_, way)| finds(*way)).map(|(name, _)| *name)
}

/// A model of a study, and what it is given.
struct Studied {
    name: &'static str,
    solve: Solve,
    kind: ModelKind,
    /// Whether by tensions, not by lengths.
    is_pulled: bool,
    rubs: bool,
}

impl Studied {
    const fn new(name: &'static str, solve: Solve, kind: ModelKind, is_pulled: bool) -> Self {
        Self { name, solve, kind, is_pulled, rubs: false }
    }

    const fn rubbing(name: &'static str, solve: Solve, kind: ModelKind, is_pulled: bool) -> Self {
        Self { name, solve, kind, is_pulled, rubs: true }
    }

    /// Robot and case as the model is given them.
    fn given(&self, robot: &Robot, case: &Case) -> (Robot, Case) {
        let case = if self.is_pulled { pulled(robot, case) } else { case.clone() };
        (if self.rubs { rubbing(robot) } else { robot.clone() }, case)
    }
}

/// What became of the robots of a study by one model.
#[derive(Debug, Default)]
struct Outcomes {
    /// By what they came to.
    counts: BTreeMap<&'static str, usize>,
    /// In ms, sorted.
    times: Vec<f64>,
    /// The deepest overlap of disks and watched places, and of the backbone anywhere, by the length.
    overlap: [f64; 2],
    /// Refusals that another way does not confirm.
    unconfirmed: usize,
    /// Of those that were given up, those that another way leads to an answer: that they are out of reach is not claimed.
    reached_otherwise: usize,
}

impl Outcomes {
    fn of(studied: &Studied, robots: &[Range<usize>], tell: bool) -> Self {
        let solve = studied.solve;
        let mut outcomes = Self::default();
        let end = robots.iter().map(|range| range.end).max().unwrap_or(0);
        let numbered = samples(scenario(), end).enumerate();
        let is_chosen = |number: usize| robots.iter().any(|range| range.contains(&number));
        for (number, scenario) in numbered.filter(|(number, _)| is_chosen(*number)) {
            let Some(case) = placed(solve, &scenario) else { continue };
            let start = processor_time();
            let outcome = solve(&scenario.robot, &case);
            let time = processor_time() - start;
            outcomes.times.push(time);
            let came_to = match &outcome {
                Ok(solution) => {
                    let deepest = overlap(&scenario.robot, &case, solution);
                    let [watched, along] = &mut outcomes.overlap;
                    *watched = watched.max(deepest.watched.0);
                    *along = along.max(deepest.along.0);
                    let jumped = solution.diagnostics.stability_lost_at.is_some();
                    if jumped { "solved after a jump" } else { "solved" }
                }
                Err(SolveError::ObstacleInTheWay { .. }) => "overlap at rest",
                Err(SolveError::Obstructed { why, .. }) => match why {
                    Obstruction::Slips => "slip off",
                    Obstruction::Leaps => "jump away",
                    Obstruction::NoneAlone { .. } => "no stable shape without obstacles",
                    Obstruction::NotConverged { .. } => "touch on without an equilibrium",
                    Obstruction::BudgetSpent { .. } => "given up",
                    Obstruction::TooManyContacts { .. } => "too many contacts",
                    Obstruction::Model(_) => "no shape under the contacts",
                    Obstruction::NotHeld { .. } => "an object is not held",
                },
                Err(_) => "no shape",
            };
            if tell {
                let name = scenario.form.name();
                match &outcome {
                    Err(SolveError::ObstacleInTheWay { .. }) => {}
                    Err(error) => {
                        let (robot, case) = studied.given(&scenario.robot, &case);
                        let confirmed = match way_to_answer(studied.kind, &robot, &case) {
                            None => "confirmed".to_owned(),
                            Some(way) if came_to == "given up" => {
                                outcomes.reached_otherwise += 1;
                                format!("reached {way}")
                            }
                            Some(way) => {
                                outcomes.unconfirmed += 1;
                                format!("NOT CONFIRMED: {way}")
                            }
                        };
                        println!("{number} {name} {time:.0} ms: {error} — {confirmed}");
                    }
                    Ok(_) if time > SLOW => println!("{number} {name} {time:.0} ms: {came_to}"),
                    Ok(_) => {}
                }
            }
            *outcomes.counts.entry(came_to).or_insert(0) += 1;
        }
        outcomes.times.sort_by(f64::total_cmp);
        outcomes
    }

    fn count(&self, came_to: &str) -> usize {
        self.counts.get(came_to).copied().unwrap_or(0)
    }

    /// Those with an answer, and all that could have one: not those that overlap at rest.
    fn solved(&self) -> (usize, usize) {
        let solved = self.count("solved") + self.count("solved after a jump");
        (solved, self.times.len() - self.count("overlap at rest"))
    }

    fn tell(&self, name: &str) {
        let part = |p: usize| self.times[(self.times.len() - 1) * p / 100];
        let (solved, possible) = self.solved();
        let [watched, along] = self.overlap;
        println!(
            "{name}: {solved} of {possible} solved ({:.1} %), p50 {:.1} ms, p99 {:.0} ms, worst {:.0} ms, overlap {watched:.0e} and {along:.0e}, {} refusals not confirmed, {} given up and reached otherwise, {:?}",
            100.0 * solved as f64 / possible as f64,
            part(50),
            part(99),
            part(100),
            self.unconfirmed,
            self.reached_otherwise,
            self.counts
        );
    }
}

/// What this thread has used of a processor, in ms, where the system tells; else what has passed.
fn processor_time() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| 1e3 * START.elapsed().as_secs_f64(), |time| 1e-6 * time)
}

const MODELS: [Studied; 9] = {
    use ModelKind::{
        Cosserat, CosseratDisks, FourBar, PiecewiseConstantCurvature, PseudoRigidBody,
    };
    [
        Studied::new("cosserat by tension", by_tension, Cosserat, true),
        Studied::new("cosserat by length", by_length, Cosserat, false),
        Studied::new("cosserat-disks by tension", disks_by_tension, CosseratDisks, true),
        Studied::new("cosserat-disks by length", disks_by_length, CosseratDisks, false),
        Studied::new("arcs by tension", arcs_by_tension, PiecewiseConstantCurvature, true),
        Studied::new("arcs by length", arcs_by_length, PiecewiseConstantCurvature, false),
        Studied::new("rigid bodies by tension", bodies_by_tension, PseudoRigidBody, true),
        Studied::new("rigid bodies by length", bodies_by_length, PseudoRigidBody, false),
        Studied::new("four-bar by length", four_bar, FourBar, false),
    ]
};

/// Of every model: how many of 1,000 robots have an answer, why the others have none, and how long they take.
/// `cargo test --release -p whipcord --test mechanics contact::overlap::study_of_outcomes -- --ignored --nocapture`
///
/// Each refusal is confirmed where a finer mesh and smaller steps of actuation find no answer either; where the solve was given up, that they find none is
/// not claimed.
///
/// The environment variables `ROBOTS=0..250,301` and `MODEL=arcs` choose a part of them.
#[test]
#[ignore = "a study, which takes an hour"]
fn study_of_outcomes() {
    outcomes_of(&MODELS, "0..1000");
}

/// The same of robots whose cables rub in their holes.
#[test]
#[ignore = "a study: minutes"]
fn study_of_outcomes_with_friction_at_holes() {
    outcomes_of(&RUBBING, "0..60");
}

fn rubbing(robot: &Robot) -> Robot {
    let rub = |cable: &Cable| Cable { friction: Some(0.2), ..cable.clone() };
    let cables = robot.cables().iter().map(rub).collect();
    Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap()
}

const RUBBING: [Studied; 6] = {
    use ModelKind::{
        Cosserat, CosseratDisks, FourBar, PiecewiseConstantCurvature, PseudoRigidBody,
    };
    let arcs = PiecewiseConstantCurvature;
    [
        Studied::rubbing("cosserat, rubbing", |r, c| by_tension(&rubbing(r), c), Cosserat, true),
        Studied::rubbing(
            "cosserat-disks, rubbing",
            |r, c| disks_by_tension(&rubbing(r), c),
            CosseratDisks,
            true,
        ),
        Studied::rubbing(
            "arcs, rubbing, by tension",
            |r, c| arcs_by_tension(&rubbing(r), c),
            arcs,
            true,
        ),
        Studied::rubbing(
            "arcs, rubbing, by length",
            |r, c| arcs_by_length(&rubbing(r), c),
            arcs,
            false,
        ),
        Studied::rubbing(
            "rigid bodies, rubbing",
            |r, c| bodies_by_tension(&rubbing(r), c),
            PseudoRigidBody,
            true,
        ),
        Studied::rubbing("four-bar, rubbing", |r, c| four_bar(&rubbing(r), c), FourBar, false),
    ]
};

fn outcomes_of(models: &[Studied], robots: &str) {
    let range = |text: &str| match text.split_once("..") {
        Some((first, end)) => first.parse().unwrap()..end.parse().unwrap(),
        None => text.parse().map(|number: usize| number..number + 1).unwrap(),
    };
    let chosen = std::env::var("ROBOTS").unwrap_or_else(|_| robots.to_owned());
    let robots: Vec<Range<usize>> = chosen.split(',').map(range).collect();
    let chosen = std::env::var("MODEL").unwrap_or_default();
    for studied in models.iter().filter(|studied| studied.name.starts_with(&chosen)) {
        Outcomes::of(studied, &robots, true).tell(studied.name);
    }
}

/// Answers that take longer than this are told, in ms.
const SLOW: f64 = 1000.0;

/// Robots of the study that come to an answer in small steps of actuation come to one at once: those that lose their equilibrium where none is near, those that
/// come to rest in contact only from the shape without obstacles, those whose cables contradict each other where they leave the shape at rest, and those whose backbone
/// slides on the edge of a box.
#[test]
fn what_small_steps_lead_to_is_found_at_once() {
    let named = |name: &str| MODELS.iter().find(|model| model.name == name).unwrap();
    for (name, robots) in [
        ("arcs by tension", &[169, 178, 690, 730][..]),
        ("rigid bodies by tension", &[217, 310]),
        ("rigid bodies by length", &[128, 490, 594, 771, 938]),
        ("four-bar by length", &[256, 279]),
        ("cosserat-disks by length", &[357]),
    ] {
        let robots: Vec<Range<usize>> = robots.iter().map(|&n| n..n + 1).collect();
        let outcomes = Outcomes::of(named(name), &robots, false);
        assert_eq!(outcomes.solved(), (robots.len(), robots.len()), "{name}: {outcomes:?}");
        assert!(outcomes.overlap[0] <= 1e-8, "{name}: {outcomes:?}");
        if name.starts_with("four-bar") {
            // Their equilibrium is never lost.
            assert_eq!(outcomes.count("solved"), robots.len(), "{name}: {outcomes:?}");
        }
    }
}

/// A robot of the study that is pulled into a coil, and that has no stable shape on finer steps without obstacles either.
#[test]
fn what_has_no_stable_shape_without_obstacles_is_told() {
    let scenario = samples(scenario(), 70).last().unwrap();
    let case = pulled(&scenario.robot, &placed(disks_by_tension, &scenario).unwrap());
    let kind = ModelKind::CosseratDisks;
    let among = rod(kind, Actuation::Tension, &scenario.robot, &case);
    let Err(SolveError::Obstructed { why: Obstruction::NoneAlone { lost_at }, .. }) = among else {
        panic!("{among:?}");
    };
    let fine = whipcord::cosserat::Options {
        accuracy: whipcord::cosserat::Accuracy::Tolerance(1e-8),
        ..Default::default()
    };
    let case = Case { obstacles: Vec::new(), ..case };
    let alone = Model::CosseratDisks(fine).solve(&scenario.robot, &case).unwrap();
    assert!(alone.diagnostics.is_unstable());
    let lost = alone.diagnostics.stability_lost_at.unwrap();
    assert!((lost - lost_at.unwrap()).abs() < 0.02, "{lost}");
}

/// Robots of the study that are pulled by 13.8 to 15.7 EI/ℓ² in each span of length ℓ, and by 51 and 58. A chain of 40 rigid links in the place of a
/// span, moved against dampers under tensions that rise slowly, comes to rest under all of them, or its holes meet at this part of them.
#[test]
fn free_robots_lose_their_shape_where_the_holes_of_a_cable_meet() {
    let robots: Vec<Scenario> = samples(scenario(), 250).collect();
    for (number, lost_at) in
        [(1, None), (112, None), (249, None), (9, Some(0.338)), (12, Some(0.391))]
    {
        let Scenario { robot, case, .. } = &robots[number];
        let solution = disks_by_tension(robot, case).unwrap();
        let diagnostics = &solution.diagnostics;
        assert_eq!(diagnostics.stable, Some(lost_at.is_none()), "{number}");
        let told: Option<f64> = diagnostics.stability_lost_at;
        assert_eq!(told.is_some(), lost_at.is_some(), "{number}");
        let off = told.zip(lost_at).map_or(0.0, |(told, lost_at)| (told - lost_at).abs());
        assert!(off < 0.03, "{number}: {told:?}");
    }
}

/// Robots of the study whose spans bear so much that their verdict takes finer steps, with cables that stick in all of their holes.
#[test]
fn cables_that_stick_in_their_holes_count_as_held_in_the_verdict() {
    let robots: Vec<Scenario> = samples(scenario(), 33).collect();
    for number in [29, 30, 32] {
        let Scenario { robot, case, .. } = &robots[number];
        let solution = disks_by_tension(&rubbing(robot), case).unwrap();
        let diagnostics = &solution.diagnostics;
        println!("{number}: {:?} {:?}", diagnostics.stable, diagnostics.stability_absent);
        assert_eq!(diagnostics.stable.is_some(), diagnostics.stability_absent.is_none());
    }
}

/// The first robots of the study: nearly all have an answer, wherever they jump to on the way.
#[test]
fn nearly_all_robots_among_obstacles_are_solved() {
    for studied in MODELS {
        let name = studied.name;
        let outcomes = Outcomes::of(&studied, core::slice::from_ref(&(0..8)), false);
        outcomes.tell(name);
        let (solved, possible) = outcomes.solved();
        assert!(solved + 1 >= possible && possible > 2, "{name}: {outcomes:?}");
        let [watched, along] = outcomes.overlap;
        assert!(watched <= 1e-8 && along <= ALONG, "{name}: {outcomes:?}");
    }
}
