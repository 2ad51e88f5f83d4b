//! The Cosserat model against references made by code that shares nothing with this project.
//!
//! `data/cosserat_reference.json` says how they were made. They cover every routing, one to six
//! cables, cables that end midway, all sections, rest curvature, tip and point loads, gravity, disk
//! masses, and bending up to 178°.
use serde_json::Value;
use whipcord::cosserat::Options;
use whipcord::{
    Actuation, CableCommand, Case, Model, Robot, Shortening, Solution, Statics, Stations,
    UnitQuaternion, Vec3,
};
use whipcord_io::CaseFile;

/// Of the backbone's length, and in rad.
const TOLERANCE: f64 = 1e-8;

/// Four straight cables round the backbone: their lengths are those of any three, and do not
/// determine four tensions.
const UNDETERMINED: [&str; 1] = ["straight_four"];

struct Reference {
    name: String,
    file: CaseFile,
    expected: Value,
}

fn references() -> Vec<Reference> {
    let data: Value =
        serde_json::from_str(include_str!("../data/cosserat_reference.json")).unwrap();
    let cases = data["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 54);
    let reference = |case: &Value| {
        let name = case["id"].as_str().unwrap().to_owned();
        let file = whipcord_io::parse(case["robot"].as_str().unwrap(), format!("{name}.toml"))
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        Reference { name, file, expected: case.clone() }
    };
    cases.iter().map(reference).collect()
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    core::array::from_fn(|i| value[i].as_f64().unwrap())
}

fn vector(value: &Value) -> Vec3 {
    numbers(value).into()
}

fn solve(robot: &Robot, case: &Case, actuation: Actuation, name: &str) -> Solution {
    let options = Options { stations: Stations::Equal(11), actuation, ..Options::default() };
    Model::Cosserat(options)
        .with_tolerance(1e-9)
        .solve(robot, case)
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Largest distance between the positions of a solution and those of the reference, at disks and
/// stations, in m.
fn position_error(solution: &Solution, expected: &Value) -> f64 {
    let lists = [
        (&solution.disks, &expected["disks"]["position"]),
        (&solution.shape, &expected["stations"]),
    ];
    let mut worst: f64 = 0.0;
    for (shape, positions) in lists {
        let positions = positions.as_array().unwrap();
        assert_eq!(shape.poses.len(), positions.len());
        for (position, expected) in shape.positions().zip(positions) {
            worst = worst.max((position - vector(expected)).norm());
        }
    }
    worst
}

/// Largest angle between the frames at the disks and those of the reference, in rad.
fn orientation_error(solution: &Solution, expected: &Value) -> f64 {
    let orientations = expected["disks"]["orientation"].as_array().unwrap();
    assert_eq!(solution.disks.poses.len(), orientations.len());
    let angle = |(pose, expected): (&whipcord::Pose, &Value)| {
        let expected = UnitQuaternion::from_wxyz(numbers(expected)).unwrap();
        (expected.conjugate() * pose.rotation).log().norm()
    };
    solution.disks.poses.iter().zip(orientations).map(angle).fold(0.0, f64::max)
}

fn length_error(solution: &Solution, expected: &Value) -> f64 {
    let cables = expected["cables"].as_array().unwrap();
    assert_eq!(solution.cables.len(), cables.len());
    let error = |(cable, expected): (&whipcord::CableState, &Value)| {
        let now = cable.length - expected["length"].as_f64().unwrap();
        let initial = cable.initial_length - expected["initial_length"].as_f64().unwrap();
        now.abs().max(initial.abs())
    };
    solution.cables.iter().zip(cables).map(error).fold(0.0, f64::max)
}

/// Stiffness of the base section in bending, N·m².
fn bending_stiffness(robot: &Robot) -> f64 {
    let section = robot.backbone().section_at(robot.disks(), 0.0).unwrap();
    robot.backbone().material.young_modulus.unwrap()
        * section.second_moment_x.min(section.second_moment_y)
}

#[test]
fn shapes_lengths_and_base_wrench_are_those_of_the_references() {
    for Reference { name, file, expected } in references() {
        let robot = &file.robot;
        let length = robot.backbone().length;
        let solution = solve(robot, &file.case, Actuation::Tension, &name);

        let position = position_error(&solution, &expected) / length;
        assert!(position < TOLERANCE, "{name}: positions differ by {position:.1e} L");
        let angle = orientation_error(&solution, &expected);
        assert!(angle < TOLERANCE, "{name}: frames differ by {angle:.1e} rad");
        let lengths = length_error(&solution, &expected) / length;
        assert!(lengths < TOLERANCE, "{name}: lengths differ by {lengths:.1e} L");

        let base = solution.base_wrench.unwrap();
        let (force, moment) =
            (vector(&expected["base"]["force"]), vector(&expected["base"]["moment"]));
        let scale = bending_stiffness(robot) / length;
        let moment = (base.moment - moment).norm() / (scale + moment.norm());
        assert!(moment < TOLERANCE, "{name}: the moment at the base differs by {moment:.1e}");
        let force = (base.force - force).norm() / (scale / length + force.norm());
        assert!(force < TOLERANCE, "{name}: the force at the base differs by {force:.1e}");
    }
}

#[test]
fn prescribing_the_lengths_of_an_answer_returns_its_tensions_and_shape() {
    for Reference { name, file, expected } in references() {
        if file.case.commands.is_empty() {
            continue;
        }
        let robot = &file.robot;
        let length = robot.backbone().length;
        let pulled = solve(robot, &file.case, Actuation::Tension, &name);
        let shorten = |cable: &whipcord::CableState| CableCommand {
            tension: None,
            shortening: Some(Shortening::Length(cable.initial_length - cable.length)),
        };
        let case = Case {
            commands: pulled.cables.iter().map(shorten).collect(),
            loads: file.case.loads.clone(),
            ..Case::default()
        };
        let shortened = solve(robot, &case, Actuation::Shortening, &name);

        let position = position_error(&shortened, &expected) / length;
        assert!(position < TOLERANCE, "{name}: positions differ by {position:.1e} L");
        let lengths = length_error(&shortened, &expected) / length;
        assert!(lengths < TOLERANCE, "{name}: lengths differ by {lengths:.1e} L");
        if UNDETERMINED.contains(&name.as_str()) {
            continue;
        }
        let largest = pulled.cables.iter().map(|c| c.tension.unwrap()).fold(0.0, f64::max);
        for (a, b) in pulled.cables.iter().zip(&shortened.cables) {
            let (a, b) = (a.tension.unwrap(), b.tension.unwrap());
            // What is exactly zero has no relative error; it stays small beside the others.
            let scale = if a > 0.0 { a } else { largest.max(1.0) };
            let error = (a - b).abs() / scale;
            assert!(error < 1e-8, "{name}: {b} N instead of {a} N, off by {error:.1e}");
        }
    }
}
