//! Cables that pass through obstacles.

use super::{among, finger, sphere};
use whipcord::{
    Actuation, CableOverlap, Case, Form, Model, ModelKind, Obstacle, Pose, Robot, Shortening,
    Solution, Stations, UnitQuaternion, Vec3,
};

const KINDS: [ModelKind; 4] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
];

fn solve(kind: ModelKind, stations: Stations, robot: &Robot, case: &Case) -> Solution {
    let model = Model::new(kind, stations, Actuation::Natural);
    model.prepare(robot, &case.loads).unwrap().solve(case, None).unwrap()
}

/// The holes of the finger's cable at both ends of a span.
fn chord(solution: &Solution, span: usize) -> [Vec3; 2] {
    [span, span + 1].map(|k| solution.disks.poses[k].transform(Vec3::X * 0.008))
}

/// A ball across the cable in a span of a finger that has been pulled: it is put where the answer without it has the cable, and does
/// not reach disks and backbone.
fn ball_across(free: &Solution, span: usize, depth: f64) -> Obstacle {
    let [a, b] = chord(free, span);
    let middle = 0.5 * (a + b);
    let out = free.disks.poses[span].rotation.rotate(Vec3::X);
    let along = (b - a) / (b - a).norm();
    let out = out - along * out.dot(along);
    let radius = 0.002;
    sphere(middle + along * 0.001 + out * ((radius - depth) / out.norm()), radius)
}

#[test]
fn the_deepest_place_is_that_of_the_chord() {
    let robot = finger(6);
    let case = Case::with_tensions(&[1.0]);
    for kind in &KINDS[1..] {
        let free = solve(*kind, Stations::Disks, &robot, &case);
        let (span, depth) = (3, 4e-4);
        let case = among(case.clone(), vec![ball_across(&free, span, depth)]);
        let solution = solve(*kind, Stations::Disks, &robot, &case);
        assert!(solution.contacts.is_empty(), "{kind}: {:?}", solution.contacts);
        let [overlap] = CableOverlap::all(&robot, &solution, &case.obstacles)[..] else {
            panic!("{kind}")
        };
        assert_eq!((overlap.cable, overlap.span, overlap.obstacle), (0, span, 0));
        let [a, b] = chord(&solution, span);
        let centre = case.obstacles[0].pose.position;
        let t = (centre - a).dot(b - a) / (b - a).norm_squared();
        let foot = a + (b - a) * t;
        let expected = 0.002 - (centre - foot).norm();
        assert!((overlap.depth - expected).abs() < 1e-12, "{kind}: {} {expected}", overlap.depth);
        assert!((overlap.depth - depth).abs() < 1e-6);
        assert!((overlap.point - foot).norm() < 1e-7, "{kind}");
        let places = &robot.disks().arc_lengths;
        let arc_length = places[span] + t * (places[span + 1] - places[span]);
        assert!((overlap.arc_length - arc_length).abs() < 1e-7, "{kind}");
        let [before, behind] = [(foot - a).norm(), (b - foot).norm()];
        let tension = solution.cables[0].tension.unwrap();
        let force = tension * expected * (1.0 / before + 1.0 / behind);
        assert!((overlap.force.unwrap() / force - 1.0).abs() < 1e-4, "{kind}");
    }
}

/// Shapes whose distance along a chord has several minima, or edges.
#[test]
fn no_deeper_place_is_left_out() {
    let robot = finger(4);
    let mut case = Case::with_tensions(&[1.5]);
    let free = solve(ModelKind::CosseratDisks, Stations::Disks, &robot, &case);
    let middle = |span: usize| {
        let [a, b] = chord(&free, span);
        0.5 * (a + b)
    };
    let thing = |form: Form, position: Vec3, turn: Vec3| Obstacle {
        name: "thing".to_owned(),
        form,
        pose: Pose { position, rotation: UnitQuaternion::exp(turn) },
        friction: 0.0,
        movable: None,
    };
    case.obstacles = vec![
        thing(
            Form::Box { size: Vec3::new(0.004, 0.003, 0.002) },
            middle(1),
            Vec3::new(0.4, 0.7, 0.2),
        ),
        thing(Form::Capsule { radius: 0.001, length: 0.006 }, middle(2), Vec3::new(1.1, 0.2, 0.0)),
        thing(Form::Cylinder { radius: 0.002, length: 0.003 }, middle(3), Vec3::new(0.3, 1.3, 0.0)),
    ];
    // As if the robot were there: what the answer says is not asked here.
    let overlaps = CableOverlap::all(&robot, &free, &case.obstacles);
    assert_eq!(overlaps.len(), 3, "{overlaps:?}");
    for overlap in overlaps {
        let [a, b] = chord(&free, overlap.span);
        let obstacle = &case.obstacles[overlap.obstacle];
        let samples = (0..=200_000).map(|k| a + (b - a) * (f64::from(k) / 200_000.0));
        let deepest = samples.map(|p| -obstacle.surface(p).distance).fold(0.0, f64::max);
        assert!((overlap.depth - deepest).abs() < 1e-8, "{overlap:?}: {deepest}");
    }
}

/// A continuous cable is where the routing has it, wherever the base is.
#[test]
fn a_continuous_cable_is_checked_along_its_curve() {
    let robot = finger(6);
    let base = Pose {
        position: Vec3::new(0.1, -0.2, 0.3),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.5, 0.9)),
    };
    let mut case = Case { base, ..Case::with_tensions(&[1.0]) };
    let free = solve(ModelKind::Cosserat, Stations::Equal(601), &robot, &case);
    let s = 0.108;
    let pose = free.shape.at(s);
    let out = pose.rotation.rotate(Vec3::X);
    case.obstacles = vec![sphere(pose.position + out * (0.008 + 0.0015), 0.002)];
    for stations in [Stations::Disks, Stations::Equal(61)] {
        let solution = solve(ModelKind::Cosserat, stations, &robot, &case);
        if !solution.contacts.is_empty() {
            panic!("{:?}", solution.contacts);
        }
        let [overlap] = CableOverlap::all(&robot, &solution, &case.obstacles)[..] else { panic!() };
        assert!((overlap.depth - 5e-4).abs() < 5e-6, "{overlap:?}");
        assert!((overlap.arc_length - s).abs() < 1e-3 && overlap.force.is_none(), "{overlap:?}");
    }
}

/// Where a slack cable is, nobody knows.
#[test]
fn slack_cables_are_left_out() {
    let robot = finger(6);
    let case = Case::with_shortenings(&[Shortening::Length(-0.001)]);
    let model = Model::new(ModelKind::CosseratDisks, Stations::Disks, Actuation::Shortening);
    let ball = sphere(Vec3::new(0.0095, 0.0, 0.105), 0.002);
    let case = among(case, vec![ball]);
    let solution = model.prepare(&robot, &case.loads).unwrap().solve(&case, None).unwrap();
    assert!(solution.cables[0].slack);
    assert_eq!(CableOverlap::all(&robot, &solution, &case.obstacles), []);
}
