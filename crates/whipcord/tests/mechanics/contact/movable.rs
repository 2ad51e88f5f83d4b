//! Movable objects that rest on the robot and on obstacles, or that the robot holds.

use std::sync::Arc;

use super::{STIFFNESS, among, cube, sphere, wall};
use crate::common::{WITH_FORCES, model_with_forces};
use whipcord::derivatives::{Hold, Place};
use whipcord::obstacle::Superellipsoid;
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, Grasp, LoadFrame, Loads, Material, Model,
    ModelKind, MovableBody, Obstacle, Obstruction, Parameter, Pose, Robot, Routing, Section,
    Solution, SolveError, Statics as _, Stations, Twist, UnitQuaternion, Vec3,
};

const LENGTH: f64 = 0.18;
const GRAVITY: f64 = 9.81;

/// The finger of the other tests, whose own weight does not matter.
fn finger(sections: usize) -> Robot {
    let material = Material {
        young_modulus: Some(1.1e9),
        poisson_ratio: Some(0.3),
        density: Some(0.0),
        ..Material::default()
    };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone { material, section, ..Backbone::new(LENGTH) };
    let disks = Disks {
        outer_radius: Some(0.01),
        thickness: Some(0.002),
        ..Disks::equally_spaced(LENGTH, sections + 1, 0.008)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

fn model(kind: ModelKind) -> Model {
    model_with_forces(kind, Stations::Disks, Actuation::Tension)
}

fn movable(obstacle: Obstacle, mass: f64) -> Obstacle {
    let movable = MovableBody::with_mass(&obstacle.form, mass);
    Obstacle { movable, ..obstacle }
}

fn block(name: &str, size: Vec3, position: Vec3, friction: f64) -> Obstacle {
    Obstacle { form: Form::Box { size }, name: name.to_owned(), friction, ..sphere(position, 1.0) }
}

/// A half-space through a point, below it by its normal.
fn plane(point: Vec3, normal: Vec3, friction: f64) -> Obstacle {
    let axis = Vec3::Z.cross(normal);
    let sine = axis.norm();
    let turn = if sine > 0.0 {
        axis * (sine.atan2(normal.z) / sine)
    } else if normal.z < 0.0 {
        Vec3::X * core::f64::consts::PI
    } else {
        Vec3::ZERO
    };
    let pose = Pose { position: point, rotation: UnitQuaternion::exp(turn) };
    Obstacle { name: "plane".to_owned(), pose, friction, ..wall(0.0) }
}

fn under_gravity(tension: f64, gravity: Vec3, obstacles: Vec<Obstacle>) -> Case {
    let loads = Loads { gravity: Some(gravity * GRAVITY), ..Loads::default() };
    among(Case { loads, ..Case::with_tensions(&[tension]) }, obstacles)
}

/// The forces and moments on each object balance.
fn assert_balanced(case: &Case, solution: &Solution) {
    for state in &solution.objects {
        let mut total = state.load;
        let mut size = state.load.force.norm();
        let mut add = |point: Vec3, force: Vec3| {
            total.force += force;
            total.moment += (point - state.center_of_mass).cross(force);
            size += force.norm();
        };
        for contact in &state.contacts {
            add(contact.point, contact.normal * contact.force + contact.friction);
        }
        for contact in solution.contacts.iter().filter(|c| c.obstacle == state.obstacle) {
            let force = contact.normal * contact.force.unwrap() + contact.friction.unwrap();
            add(contact.point, -force);
        }
        let body = case.obstacles[state.obstacle].movable.unwrap();
        let gravity = case.loads.gravity.unwrap_or(Vec3::ZERO);
        assert!((state.load.force - gravity * body.mass - body.force).norm() < 1e-12);
        assert!(total.force.norm() < 1e-6 * size, "{total:?} of {size}");
        assert!(total.moment.norm() < 1e-6 * size * 0.01, "{total:?} of {size}");
    }
}

#[track_caller]
fn solved(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    let solution = model(kind).solve(robot, case).unwrap_or_else(|error| panic!("{kind}: {error}"));
    assert_balanced(case, &solution);
    solution
}

/// The name of the object that nothing holds.
#[track_caller]
fn lost(kind: ModelKind, case: &Case) -> String {
    match model(kind).solve(&finger(9), case) {
        Err(SolveError::Obstructed { why: Obstruction::NotHeld { object, force, .. }, .. }) => {
            assert!(force > 0.0, "{kind}");
            object
        }
        Err(other) => panic!("{kind}: {other}"),
        Ok(solution) => panic!("{kind}: {:?}", solution.objects),
    }
}

/// A body that does not move, but for the way to what it rests on.
#[track_caller]
fn assert_at(solution: &Solution, case: &Case, number: usize, shift: Vec3) {
    let state = solution.objects.iter().find(|state| state.obstacle == number).unwrap();
    let began = &case.obstacles[number].pose;
    let moved = state.pose.position - began.position - shift;
    let turned = (began.rotation.conjugate() * state.pose.rotation).log();
    assert!(moved.norm() < 1e-8 && turned.norm() < 1e-6, "{moved:?} {turned:?}");
}

/// What an object is pressed with by all obstacles that it touches.
fn pressed(solution: &Solution, object: usize) -> f64 {
    solution.objects[object].contacts.iter().map(|touch| touch.force).sum()
}

const DOWN: Vec3 = Vec3::new(-1.0, 0.0, 0.0);

/// Bodies far from the robot rest on a floor, which bears their weight; a step over it they fall onto it first.
#[test]
fn bodies_rest_on_a_floor() {
    let mass = 0.01;
    let axes = Vec3::new(0.02, 0.03, 0.04);
    let ellipsoid = Form::Superellipsoid(Superellipsoid::new(axes, [1.0, 1.0]).unwrap());
    let forms = [
        (Form::Sphere { radius: 0.02 }, 0.02),
        (Form::Box { size: Vec3::new(0.02, 0.03, 0.04) }, 0.01),
        (Form::Capsule { radius: 0.01, length: 0.03 }, 0.01),
        (Form::Cylinder { radius: 0.01, length: 0.04 }, 0.01),
        (ellipsoid, 0.02),
        (Form::Mesh(Arc::new(cube(0.02))), 0.01),
    ];
    for friction in [0.0, 0.5] {
        for (form, height) in &forms {
            for above in [0.0, 2e-3] {
                let position = Vec3::new(-0.05 + height + above, 0.0, 0.25);
                let body = Obstacle { form: form.clone(), friction, ..sphere(position, 1.0) };
                let floor = plane(Vec3::new(-0.05, 0.0, 0.0), Vec3::X, friction);
                let case = under_gravity(0.0, DOWN, vec![movable(body, mass), floor]);
                let solution = solved(ModelKind::PiecewiseConstantCurvature, &finger(3), &case);
                assert_at(&solution, &case, 0, DOWN * above);
                assert!((pressed(&solution, 0) / (mass * GRAVITY) - 1.0).abs() < 1e-6, "{form:?}");
                assert!(solution.objects[0].slip_margin.unwrap_or(1.0) > 0.99, "{form:?}");
            }
        }
    }
}

/// A cylinder stands on its end, and a ball on a box that rests on a floor.
#[test]
fn bodies_stand_on_one_another() {
    for friction in [0.0, 0.5] {
        let floor = plane(Vec3::new(-0.05, 0.0, 0.0), Vec3::X, friction);
        let upright = UnitQuaternion::exp(Vec3::Y * core::f64::consts::FRAC_PI_2);
        let pose = Pose { position: Vec3::new(-0.03, 0.0, 0.25), rotation: upright };
        let form = Form::Cylinder { radius: 0.01, length: 0.04 };
        let post = Obstacle { form, pose, friction, ..sphere(Vec3::ZERO, 1.0) };
        let case = under_gravity(0.0, DOWN, vec![movable(post, 0.01), floor.clone()]);
        let kind = ModelKind::PiecewiseConstantCurvature;
        let solution = solved(kind, &finger(3), &case);
        assert_at(&solution, &case, 0, Vec3::ZERO);
        assert!((pressed(&solution, 0) / (0.01 * GRAVITY) - 1.0).abs() < 1e-6);

        let size = Vec3::new(0.02, 0.03, 0.04);
        let below = block("box", size, Vec3::new(-0.04, 0.0, 0.25), friction);
        let ball = sphere(Vec3::new(-0.02, 0.0, 0.25), 0.01);
        let ball = movable(Obstacle { friction, ..ball }, 0.01);
        let case = under_gravity(0.0, DOWN, vec![movable(below, 0.02), floor, ball]);
        let solution = solved(kind, &finger(3), &case);
        let of = |object: usize, other: usize| -> f64 {
            let touching = solution.objects[object].contacts.iter();
            touching.filter(|touch| touch.obstacle == other).map(|touch| touch.force).sum()
        };
        assert!((of(0, 1) / (0.03 * GRAVITY) - 1.0).abs() < 1e-6);
        assert!((of(1, 0) / (0.01 * GRAVITY) - 1.0).abs() < 1e-6);
        assert_eq!(of(0, 2), of(1, 0));
    }
}

/// A box stays on a slope up to the angle of friction; a ball rolls down any, and what nothing carries falls.
#[test]
fn what_nothing_holds_is_refused() {
    let kind = ModelKind::PiecewiseConstantCurvature;
    let (sin, cos) = 0.2_f64.sin_cos();
    let normal = Vec3::new(cos, 0.0, sin);
    let foot = Vec3::new(-0.2, 0.0, 0.0);
    let pose =
        Pose { position: foot + normal * 0.01, rotation: UnitQuaternion::exp(Vec3::Y * -0.2) };
    let on_slope = |body: Obstacle, friction: f64| {
        let body = movable(Obstacle { pose, friction, ..body }, 0.01);
        under_gravity(0.0, DOWN, vec![body, plane(foot, normal, friction)])
    };
    let slab = block("box", Vec3::new(0.02, 0.03, 0.04), Vec3::ZERO, 0.0);
    let case = on_slope(slab.clone(), 0.25);
    let solution = solved(kind, &finger(3), &case);
    assert_at(&solution, &case, 0, Vec3::ZERO);
    // tan 0.2 = 0.2027
    assert_eq!(lost(kind, &on_slope(slab.clone(), 0.19)), "box");
    assert_eq!(lost(kind, &on_slope(slab, 0.0)), "box");
    assert_eq!(lost(kind, &on_slope(sphere(Vec3::ZERO, 0.01), 0.5)), "ball");
    let falling = movable(sphere(Vec3::new(0.1, 0.0, 0.3), 0.02), 0.01);
    assert_eq!(lost(kind, &under_gravity(0.0, DOWN, vec![falling])), "ball");
}

/// An object that overlaps what it stands on before anything moves is refused.
#[test]
fn an_object_that_overlaps_at_rest_is_refused() {
    let floor = plane(Vec3::new(-0.05, 0.0, 0.0), Vec3::X, 0.0);
    let ball = movable(sphere(Vec3::new(-0.031, 0.0, 0.25), 0.02), 0.01);
    let case = under_gravity(0.0, DOWN, vec![ball, floor]);
    let error = model(ModelKind::PseudoRigidBody).solve(&finger(3), &case).unwrap_err();
    let SolveError::ObjectOverlaps { object, obstacle, depth } = error else { panic!("{error}") };
    assert_eq!((object.as_str(), obstacle.as_str()), ("ball", "plane"));
    assert!((depth - 1e-3).abs() < 1e-9);
}

/// A box that stands on a table beside the finger.
fn box_on_a_table(friction: f64, mass: f64) -> Case {
    let table = Vec3::new(0.125, 0.0, 0.11);
    let table = block("table", Vec3::new(0.2, 0.2, 0.02), table, friction);
    let size = Vec3::new(0.03, 0.03, 0.08);
    let pushed = movable(block("box", size, Vec3::new(0.045, 0.0, 0.16), friction), mass);
    under_gravity(1.0, -Vec3::Z, vec![pushed, table])
}

/// A finger pulled against a box on a table pushes it along: all contacts with the table slide.
#[test]
fn a_finger_pushes_a_box_along_a_table() {
    let mass = 0.02;
    for kind in WITH_FORCES {
        for friction in [0.0, 0.1] {
            let case = box_on_a_table(friction, mass);
            let solution = solved(kind, &finger(9), &case);
            let state = &solution.objects[0];
            let moved = state.pose.position - Vec3::new(0.045, 0.0, 0.16);
            assert!(moved.x > 1e-4 && moved.z.abs() < 1e-8, "{kind} {friction}: {moved:?}");
            let force: Vec3 = solution.contacts.iter().fold(Vec3::ZERO, |sum, touch| {
                sum + touch.normal * touch.force.unwrap() + touch.friction.unwrap()
            });
            // On the robot, that is.
            let carried = pressed(&solution, 0);
            assert!((carried - mass * GRAVITY - force.z).abs() < 1e-6 * carried, "{kind}");
            assert!((-force.x - friction * carried).abs() < 1e-5 * carried, "{kind} {friction}");
            assert!(friction == 0.0 || state.slip_margin.unwrap() < 1e-5, "{kind}");
        }
    }
}

/// A ball between the finger and a wall, whose weight friction carries.
fn squeezed(friction: f64, mass: f64, tension: f64) -> Case {
    let ball = sphere(Vec3::new(0.045, 0.0, 0.17), 0.02);
    let ball = movable(Obstacle { friction, ..ball }, mass);
    let wall = Obstacle { friction, ..wall(0.065) };
    under_gravity(tension, -Vec3::Z, vec![ball, wall])
}

/// Two contacts carry it, one on each side, as far as their friction goes.
#[test]
fn a_ball_is_squeezed_against_a_wall() {
    for kind in WITH_FORCES {
        let case = squeezed(0.5, 0.005, 3.0);
        let solution = solved(kind, &finger(9), &case);
        let state = &solution.objects[0];
        let margin = state.slip_margin.unwrap();
        assert!((0.01..0.99).contains(&margin), "{kind}: {margin}");
        let [by_wall] = state.contacts.as_slice() else { panic!("{kind}: {:?}", state.contacts) };
        assert!(by_wall.sticks && by_wall.friction.z > 0.0, "{kind}: {by_wall:?}");
        let [grasp] = Grasp::all(&solution, &case.obstacles)[..] else { panic!("{kind}") };
        let wrench = grasp.wrench.unwrap();
        let rest = state.load.force + by_wall.normal * by_wall.force + by_wall.friction;
        assert!((wrench.force + rest).norm() < 1e-6 * by_wall.force, "{kind}");
        if kind != ModelKind::PseudoRigidBody && kind != ModelKind::Cosserat {
            continue;
        }
        // Friction cannot hold a tenfold weight, nor this one with little of it.
        assert_eq!(lost(kind, &squeezed(0.5, 0.05, 3.0)), "ball");
        assert_eq!(lost(kind, &squeezed(0.05, 0.005, 3.0)), "ball");
    }
}

/// A cable that hardly rubs leads to what one leads to that does not, and one that rubs leaves the robot straighter.
#[test]
fn cables_that_rub_in_their_holes_move_and_hold_objects() {
    let mut failures = String::new();
    for kind in WITH_FORCES {
        let cases =
            [squeezed(0.5, 0.005, 3.0), box_on_a_table(0.0, 0.02), box_on_a_table(0.1, 0.02)];
        for (number, case) in cases.iter().enumerate() {
            let smooth = solved(kind, &finger(9), case);
            for friction in [1e-7, 0.2] {
                let solution = match model(kind).solve(&rubbing_finger(friction), case) {
                    Ok(solution) => solution,
                    Err(error) => {
                        failures += &format!("{kind}, case {number}, {friction}: {error}\n");
                        continue;
                    }
                };
                assert_balanced(case, &solution);
                let apart = solution.disks.distances(&smooth.disks).fold(0.0, f64::max) / LENGTH;
                let tip = |solution: &Solution| solution.disks.poses[9].position.x;
                if friction == 1e-7 && apart > 1e-6 {
                    failures += &format!("{kind}, case {number}: {apart:.1e}\n");
                } else if friction > 1e-7 && tip(&solution) > tip(&smooth) - 1e-6 {
                    failures += &format!("{kind}, case {number}, {friction}: bent more\n");
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Once held, it is held as the tension changes from step to step, and let go where that is too low.
#[test]
fn a_ball_that_is_held_stays_held() {
    for kind in WITH_FORCES {
        let mut case = squeezed(0.5, 0.005, 3.5);
        case.before = vec![Case::with_tensions(&[3.0]).commands];
        let mut prepared = model(kind).prepare(&finger(9), &case.loads).unwrap();
        let mut answers = Vec::new();
        prepared.solve_steps(&case, |solution| answers.push(solution)).unwrap();
        let [first, second] = answers.as_slice() else { panic!("{kind}") };
        for solution in [first, second] {
            assert_balanced(&case, solution);
        }
        let force = |solution: &Solution| pressed(solution, 0);
        assert!(force(second) > 1.05 * force(first), "{kind}");
        let direct = model(kind).solve(&finger(9), &case).unwrap();
        let apart = direct.disks.distances(&second.disks).fold(0.0, f64::max);
        assert!(apart < 1e-6 * LENGTH, "{kind}: {apart}");
        // Its own answer is where a solve from it stays.
        let again = prepared.solve(&squeezed(0.5, 0.005, 3.5), Some(second)).unwrap();
        let apart = again.disks.distances(&second.disks).fold(0.0, f64::max);
        assert!(apart < 1e-7 * LENGTH, "{kind}: {apart}");
    }
}

/// Moved together, robot, objects and gravity have the same shape and forces.
#[test]
fn a_rigid_motion_changes_nothing() {
    let by = Pose {
        position: Vec3::new(0.3, -0.2, 0.1),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -0.7, 1.1)),
    };
    for kind in WITH_FORCES {
        let case = squeezed(0.5, 0.005, 3.0);
        let solution = solved(kind, &finger(9), &case);
        let moved = Case {
            base: by,
            obstacles: case.obstacles.iter().map(|it| super::moved(it, &by)).collect(),
            ..case.clone()
        };
        let there = model(kind).solve(&finger(9), &moved).unwrap();
        let [a, b] = [&solution, &there].map(|solution| &solution.objects[0]);
        let apart = (by * a.pose).position - b.pose.position;
        assert!(apart.norm() < 1e-6 * LENGTH, "{kind}: {apart:?}");
        let [f, g] = [a, b].map(|state| state.contacts[0].force);
        assert!((f / g - 1.0).abs() < 1e-5, "{kind}: {f} {g}");
    }
}

/// The slope of the support, and the radius of the ball that lies on it and leans on the finger.
const SLOPE: f64 = 0.3;
const RADIUS: f64 = 0.02;

/// A ball on a slope that leans on the last disk of an upright finger. A wall keeps it in the plane of the finger: a little of
/// gravity presses it there.
fn leaning(mass: f64, sections: usize) -> (Robot, Case) {
    let robot = finger(sections);
    let (sin, cos) = SLOPE.sin_cos();
    let normal = Vec3::new(-sin, 0.0, cos);
    let centre = Vec3::new(0.01 + RADIUS, 0.0, 0.175);
    let rotation = UnitQuaternion::exp(Vec3::Y * -SLOPE);
    let middle = centre - normal * (RADIUS + 0.005) + rotation.rotate(Vec3::X) * 0.022;
    let support = block("support", Vec3::new(0.08, 0.05, 0.01), middle, 0.0);
    let support = Obstacle { pose: Pose { rotation, ..support.pose }, ..support };
    let side = plane(Vec3::new(0.0, -RADIUS, 0.0), Vec3::Y, 0.0);
    // The robot lies on this side of it.
    let ball = movable(sphere(centre, RADIUS), mass);
    let gravity = Vec3::new(0.0, -0.05, -1.0);
    (robot, under_gravity(0.0, gravity, vec![ball, support, side]))
}

/// With little weight, the finger is bent as by a force at its tip that balances the ball on its slope.
#[test]
fn a_ball_that_leans_on_a_finger_bends_it() {
    let mass = 0.001;
    for kind in WITH_FORCES {
        let (robot, case) = leaning(mass, 9);
        let solution = solved(kind, &robot, &case);
        let [touch] = solution.contacts.as_slice() else { panic!("{:?}", solution.contacts) };
        let force = touch.force.unwrap();
        // Three forces through the centre of the ball.
        let normal = touch.normal;
        let across = Vec3::new(SLOPE.cos(), 0.0, SLOPE.sin());
        let weight = Vec3::new(0.0, 0.0, -mass * GRAVITY);
        let balanced = weight.dot(across) / normal.dot(across);
        assert!((force / balanced - 1.0).abs() < 1e-6, "{kind}: {force} {balanced}");
        let sideways = normal.x * force;
        let bent = sideways * LENGTH.powi(3) / (3.0 * STIFFNESS);
        let tip = solution.disks.tip().position.x;
        let tolerance = if kind == ModelKind::FourBar { 0.05 } else { 0.03 };
        assert!((tip / bent - 1.0).abs() < tolerance, "{kind}: {tip} {bent}");
    }
}

/// The total potential of planar arcs and the ball, and the gap between ball and last disk, without the code of the model.
struct Potential {
    mass: f64,
    sections: usize,
}

impl Potential {
    /// Of the bend of each section in rad, and how far the ball has moved up its slope.
    fn energy(&self, q: &[f64]) -> f64 {
        let section = LENGTH / self.sections as f64;
        let strain: f64 =
            q[..self.sections].iter().map(|b| 0.5 * STIFFNESS * b * b / section).sum();
        strain + self.mass * GRAVITY * q[self.sections] * SLOPE.sin()
    }

    /// In the plane of the finger, with the disk as a segment with rounded ends.
    fn gap(&self, q: &[f64]) -> f64 {
        let section = LENGTH / self.sections as f64;
        let (mut x, mut z, mut turn) = (0.0, 0.0, 0.0_f64);
        for bend in &q[..self.sections] {
            // The chord of an arc.
            let chord =
                section * if *bend == 0.0 { 1.0 } else { (0.5 * bend).sin() / (0.5 * bend) };
            x += chord * (turn + 0.5 * bend).sin();
            z += chord * (turn + 0.5 * bend).cos();
            turn += bend;
        }
        let up = q[self.sections];
        let ball = [0.01 + RADIUS + up * SLOPE.cos() - x, 0.175 + up * SLOPE.sin() - z];
        let along = ball[0] * turn.cos() - ball[1] * turn.sin();
        let across = ball[0] * turn.sin() + ball[1] * turn.cos();
        let beyond = along - along.clamp(-0.009, 0.009);
        beyond.hypot(across) - 0.001 - RADIUS
    }

    /// The stationary point of the energy with a gap of zero, and the contact force there.
    fn least(&self) -> (Vec<f64>, f64) {
        let n = self.sections + 1;
        let h = 1e-4;
        let gradient = |f: &dyn Fn(&[f64]) -> f64, q: &[f64]| -> Vec<f64> {
            (0..n)
                .map(|i| {
                    let at = |x: f64| {
                        let mut q = q.to_vec();
                        q[i] += x;
                        f(&q)
                    };
                    (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
                })
                .collect()
        };
        let residual = |v: &[f64]| -> Vec<f64> {
            let q = &v[..n];
            let [energy, gap] =
                [gradient(&|q: &[f64]| self.energy(q), q), gradient(&|q: &[f64]| self.gap(q), q)];
            let mut rest: Vec<f64> =
                energy.iter().zip(&gap).map(|(e, g)| (e - v[n] * g) / 1e-2).collect();
            rest.push(self.gap(q) / RADIUS);
            rest
        };
        let mut v = vec![0.0; n + 1];
        v[n] = self.mass * GRAVITY * SLOPE.tan();
        for _ in 0..30 {
            let here = residual(&v);
            let mut matrix = vec![0.0; (n + 1) * (n + 1)];
            for j in 0..=n {
                let at = |x: f64| {
                    let mut v = v.clone();
                    v[j] += x;
                    residual(&v)
                };
                let (after, before) = (at(1e-4), at(-1e-4));
                for i in 0..=n {
                    matrix[i * (n + 1) + j] = (after[i] - before[i]) / 2e-4;
                }
            }
            let mut lu = whipcord_numerics::DenseLu::default();
            lu.factor(n + 1, &matrix).unwrap();
            let mut step = here;
            lu.solve(&mut step);
            v.iter_mut().zip(&step).for_each(|(v, step)| *v -= step);
        }
        assert!(residual(&v).iter().all(|x| x.abs() < 1e-9), "{:?}", residual(&v));
        let force = v[n];
        v.truncate(n);
        (v, force)
    }
}

/// Arcs and ball are where their total potential is least: a neighbouring place that the gap allows has more.
#[test]
fn arcs_and_a_ball_have_the_least_potential() {
    for mass in [0.002, 0.006] {
        let sections = 3;
        let potential = Potential { mass, sections };
        let (least, force) = potential.least();
        // A minimum, among all that keep the gap closed: by small changes of the bends.
        let closed = |bends: &[f64]| {
            let mut q = bends.to_vec();
            q.push(least[sections]);
            for _ in 0..50 {
                let h = 1e-6;
                let slope = |x: f64| {
                    let mut q = q.clone();
                    q[sections] += x;
                    potential.gap(&q)
                };
                q[sections] -= slope(0.0) * 2.0 * h / (slope(h) - slope(-h));
            }
            potential.energy(&q)
        };
        let lowest = closed(&least[..sections]);
        for k in 0..sections {
            for change in [-1e-2, 1e-2] {
                let mut bends = least[..sections].to_vec();
                bends[k] += change;
                assert!(closed(&bends) > lowest, "{k} {change}");
            }
        }
        let (robot, case) = leaning(mass, sections);
        let solution = solved(ModelKind::PiecewiseConstantCurvature, &robot, &case);
        let moved = solution.objects[0].pose.position - case.obstacles[0].pose.position;
        let up = moved.x * SLOPE.cos() + moved.z * SLOPE.sin();
        assert!((up - least[sections]).abs() < 1e-7 * LENGTH, "{up} {}", least[sections]);
        let [touch] = solution.contacts.as_slice() else { panic!("{:?}", solution.contacts) };
        assert!((touch.force.unwrap() / force - 1.0).abs() < 1e-5, "{touch:?} {force}");
        let turn: f64 = least[..sections].iter().sum();
        let (bend, _) = solution.disks.bend();
        assert!((bend - turn.abs()).abs() < 1e-6, "{bend} {turn}");
    }
}

/// How tip moves with the command and with a force on it, while the ball moves along, against differences.
#[test]
fn an_object_moves_along_with_the_robot() {
    for kind in WITH_FORCES {
        let leans = leaning(0.004, 9);
        for (name, (robot, case)) in
            [("leans", leans), ("squeezed", (finger(9), squeezed(0.5, 0.005, 3.0)))]
        {
            let model = model(kind).with_tolerance(1e-8);
            let mut prepared = model.prepare(&robot, &case.loads).unwrap();
            let solution = prepared.solve(&case, None).unwrap();
            let derivatives = prepared.linearize(&case, &solution, &[]).unwrap();
            let mut compare = |found: Twist, make: &dyn Fn(f64) -> Case, h: f64| {
                let mut at = |x: f64| {
                    let answer = prepared.solve(&make(x), Some(&solution)).unwrap();
                    assert_eq!(answer.contacts.len(), solution.contacts.len());
                    answer.disks.tip().position
                };
                let expected = (at(h) - at(-h)) / (2.0 * h);
                let error = (found.linear - expected).norm();
                assert!(error < 2e-3 * expected.norm(), "{kind} {name}: {found:?} {expected:?}");
            };
            let by_tension = derivatives.command(0).twist(Place::Tip);
            let tension = case.commands[0].tension.unwrap();
            let pulled = |x: f64| Case {
                commands: Case::with_tensions(&[tension + x]).commands,
                ..case.clone()
            };
            if tension > 0.0 {
                compare(by_tension, &pulled, 2e-2);
            }
            let by_force = derivatives.wrench(Place::Tip, 0, Hold::Commands).twist(Place::Tip);
            let pushed = |x: f64| {
                let loads = Loads { tip_force: Vec3::X * x, ..case.loads.clone() };
                Case { loads, ..case.clone() }
            };
            compare(by_force, &pushed, 2e-4);
        }
    }
}

fn rubbing_finger(friction: f64) -> Robot {
    let bare = finger(9);
    let cable = Cable { friction: Some(friction), ..bare.cables()[0].clone() };
    Robot::new(bare.backbone().clone(), bare.disks().clone(), vec![cable]).unwrap()
}

/// The robot weighs nothing: gravity moves it by the weight of what it holds, which leans on it across its plane and in it.
#[test]
fn gravity_moves_a_robot_by_the_weight_of_objects() {
    let base = Pose {
        position: Vec3::new(0.1, 0.0, -0.2),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.5, 0.8)),
    };
    let tilted = |case: &Case| Case {
        base,
        obstacles: case.obstacles.iter().map(|it| super::moved(it, &base)).collect(),
        loads: Loads {
            frame: LoadFrame::World,
            gravity: case.loads.gravity.map(|gravity| base.rotation.rotate(gravity)),
            ..case.loads.clone()
        },
        ..case.clone()
    };
    let (smooth, leans) = leaning(0.004, 9);
    let pulled = Case { commands: Case::with_tensions(&[0.3]).commands, ..leans.clone() };
    let cases = [
        ("leans", smooth.clone(), leans.clone()),
        ("leans, tilted", smooth.clone(), tilted(&leans)),
        ("squeezed", finger(9), squeezed(0.5, 0.005, 3.0)),
        ("rubs", rubbing_finger(0.2), pulled.clone()),
        ("rubs, tilted", rubbing_finger(0.2), tilted(&pulled)),
    ];
    let parameters = [0, 1, 2].map(|axis| Parameter::Gravity { axis });
    let mut failures = String::new();
    for kind in WITH_FORCES {
        for (name, robot, case) in &cases {
            let rubs = robot.cables()[0].friction.is_some();
            let model = model(kind).with_tolerance(1e-8);
            let mut prepared = model.prepare(robot, &case.loads).unwrap();
            let (solution, derivatives) =
                prepared.solve_with_derivatives(case, None, &parameters).unwrap();
            assert!(!derivatives.is_contact_about_to_change(), "{kind} {name}");
            let mut largest = 0.0_f64;
            let mut all = Vec::new();
            for (p, parameter) in parameters.iter().enumerate() {
                let mut at = |x: f64| {
                    let (_, case) = parameter.moved(robot, case, x).unwrap();
                    let from = (!rubs).then_some(&solution);
                    let answer = prepared.solve(&case, from).unwrap();
                    assert_eq!(answer.contacts.len(), solution.contacts.len(), "{kind} {name}");
                    answer.disks.tip().position
                };
                let h = 0.02;
                let expected = (at(h) - at(-h)) / (2.0 * h);
                let found = derivatives.parameter(p, Hold::Commands).twist(Place::Tip).linear;
                let found = case.base.rotation.rotate(found);
                largest = largest.max(expected.norm());
                all.push(((found - expected).norm(), found, expected));
            }
            assert!(largest > 1e-6, "{kind} {name}: {largest}");
            for (off, found, expected) in all {
                if off > 2e-3 * largest {
                    failures += &format!("{kind} {name}: {found:?} {expected:?}\n");
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}
