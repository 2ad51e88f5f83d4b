//! Random robots that are pulled against random obstacles: how far the returned shape enters them, measured at dense
//! stations by the distance to the obstacle alone; and whether the base bears what pushes.

#![allow(clippy::print_stdout, reason = "a study tells what it found")]

mod outcomes;

use proptest::prelude::*;
use whipcord::four_bar::{FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, Loads, Material, Model, ModelKind, Obstacle,
    Part, Pose, Robot, Routing, Section, Shortening, Solution, SolveError, Stations,
    UnitQuaternion, Vec3,
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
