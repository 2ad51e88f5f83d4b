//! Robots with motors, read and written.

use std::path::Path;

use serde_json::json;
use whipcord::warning::of_answer;
use whipcord::{
    Actuation, Drive, Model, ModelKind, Motor, MotorDynamics, MotorLimits, Shortening,
    Statics as _, Stations, Vec3,
};
use whipcord_io::{Beside, CaseFile, answer_json, describe, load, parse, toml};

const ROBOT: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\n[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 12\n[[cables]]\nname = \"left\"\nholes = [1, 1, 1]\n[[cables]]\nname = \"right\"\nholes = [7, 7, 7]\n[[cables]]\nname = \"-odd\"\nholes = [4, 4, 4]\n";
const MOTORS: &str = r#"
[[motors]]
name = "bend"
cables = ["left", "- right"]
spool_radius = ["10 mm", "12 mm"]
gear_ratio = -50
stiffness = "5 N/mm"
free_length = "300 mm"
pretension = "4 N"
backlash = "1 deg"
angle_offset = "10 deg"
angle_limits = ["-9 turn", "9 turn"]
rate_limit = "60 rpm"
torque_limit = "0.5 N*m"
inertia = "20 g*cm^2"
damping = "0.01 mN*m*s/rad"
proportional_gain = "10 mN*m/deg"
derivative_gain = "2 mN*m*s/rad"
integral_gain = 3

[[motors]]
cables = ["-odd"]
travel_limits = ["-1 mm", "40 mm"]
inertia = "200 g"
proportional_gain = "5 N/mm"
damping = "2 N*s/m"
"#;

fn read(tail: &str) -> CaseFile {
    parse(&format!("{ROBOT}{MOTORS}{tail}"), "robot.toml").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_motor_is_read_with_all_its_numbers() {
    let file = read("");
    let [bend, linear] = file.robot.motors() else { panic!("two motors") };
    assert_eq!(bend.name, "bend");
    assert_eq!(bend.drive, Drive::Spool { gear_ratio: -50.0 });
    let cables: Vec<_> = bend.cables.iter().map(|of| (of.cable, of.pull())).collect();
    assert_eq!(cables, [(0, 0.010), (1, -0.012)]);
    assert_eq!(bend.stiffness, Some(5e3));
    assert_eq!((bend.free_length, bend.pretension), (0.3, 4.0));
    let degree = core::f64::consts::PI / 180.0;
    assert!((bend.backlash - degree).abs() < 1e-15 && (bend.offset - 10.0 * degree).abs() < 1e-15);
    let rate = bend.limits.rate.unwrap();
    assert!((rate - core::f64::consts::TAU).abs() < 1e-12, "{rate}");
    assert_eq!(bend.limits.effort, Some(0.5));
    let dynamics = bend.dynamics.unwrap();
    assert!((dynamics.proportional * degree - 0.01).abs() < 1e-15);
    let rest = MotorDynamics { damping: 1e-5, derivative: 2e-3, integral: 3.0, ..dynamics };
    assert!(dynamics == rest && (dynamics.inertia - 2e-6).abs() < 1e-20);
    // A cable whose own name begins with a minus sign is that cable.
    assert_eq!(linear.name, "motor-2");
    assert_eq!(
        linear.cables.iter().map(|of| (of.cable, of.pull())).collect::<Vec<_>>(),
        [(2, 1.0)]
    );
    assert_eq!(linear.limits, MotorLimits { range: Some([-0.001, 0.04]), ..Default::default() });
    assert_eq!(
        linear.dynamics,
        Some(MotorDynamics { damping: 2.0, ..MotorDynamics::new(0.2, 5e3) })
    );
    assert!(file.case.commands.iter().all(|command| command.shortening.is_none()));
}

#[test]
fn steps_wind_up_the_cables_one_after_another() {
    let file = read(
        "[[steps]]\nmotors = [\"-2 turn\", \"3 mm\"]\n[[steps]]\nmotors = [\"-1.99 turn\", 0.004]\n",
    );
    let turn = core::f64::consts::TAU;
    // Within its play of a degree of the spool, which is 50 of the motor, the drive does not move.
    let output = (-2.0 * turn - 10.0 * turn / 360.0) / -50.0 - 0.5 * turn / 360.0;
    for (step, odd) in [(&file.case.before[0], 0.003), (&file.case.commands, 0.004)] {
        let metres = |cable: usize| step[cable].shortening.map(|s| s.in_metres(1.0)).unwrap();
        assert!((metres(0) - 0.010 * output).abs() < 1e-15, "{step:?}");
        assert!((metres(1) + 0.012 * output).abs() < 1e-15);
        assert_eq!(step[2].shortening, Some(Shortening::Length(odd)));
    }
}

#[test]
fn a_robot_with_motors_that_is_written_is_read_again_as_it_was() {
    for tail in
        ["", "[[steps]]\nmotors = [\"-2 turn\", \"3 mm\"]\n[[steps]]\nmotors = [1.0, 0.004]\n"]
    {
        let file = read(tail);
        let text = toml(&describe(None, &file.robot, &file.case).unwrap());
        let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(again.robot.motors(), file.robot.motors(), "{text}");
        assert_eq!(again.case, file.case, "{text}");
    }
}

#[test]
fn an_extending_file_changes_one_motor_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.toml"), format!("{ROBOT}{MOTORS}")).unwrap();
    let path = folder.path().join("case.toml");
    let text = "extends = \"arm.toml\"\n[[motors]]\nname = \"bend\"\nangle = \"90 deg\"\n[[motors]]\nname = \"motor-2\"\nremove = true\n";
    std::fs::write(&path, text).unwrap();
    let file = load(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.robot.motors().len(), 1);
    assert_eq!(file.case.motor_command(0), Some(core::f64::consts::FRAC_PI_2));
    assert!(file.case.commands[0].shortening.is_some());
}

#[test]
fn what_a_motor_must_hold_is_in_the_answer_and_told_of_beyond_its_limit() {
    let text = |limit: &str| {
        format!(
            "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n[[cables]]\nname = \"pull\"\nrouting = {{ kind = \"straight\", angle = 0, radius = \"8 mm\" }}\n[[motors]]\nname = \"m\"\ncables = [\"pull\"]\nspool_radius = \"10 mm\"\ngear_ratio = 2\nangle = 1.5\ntorque_limit = {limit}\n"
        )
    };
    for (limit, overloaded) in [(0.1, false), (0.01, true)] {
        let file = parse(&text(&limit.to_string()), "robot.toml").unwrap();
        let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
        let solution = model.solve(&file.robot, &file.case).unwrap();
        let tension = solution.cables[0].tension.unwrap();
        let beside =
            Beside { robot: Some(&file.robot), case: Some(&file.case), ..Beside::default() };
        let json = answer_json("", &solution, 0.0, &beside).unwrap();
        let motor = &json["motors"][0];
        assert_eq!((&motor["name"], &motor["angle"]), (&json!("m"), &json!(1.5)));
        let torque = motor["torque"].as_f64().unwrap();
        assert!((torque - 0.010 * tension / 2.0).abs() < 1e-15, "{torque}");
        assert!((motor["utilization"].as_f64().unwrap() - torque / limit).abs() < 1e-12);
        let told = of_answer(&file.robot, &file.case, &solution);
        let codes: Vec<_> = told.iter().map(whipcord::Warning::code).collect();
        assert_eq!(codes.contains(&"motor-overload"), overloaded, "{torque} {codes:?}");
    }
}

#[test]
fn a_cable_that_is_not_where_its_motor_pulls_it_cannot_be_written() {
    let file = read(
        "[[steps]]\nmotors = [\"90 deg\", \"5 mm\"]\n[[steps]]\nmotors = [\"80 deg\", \"5 mm\"]\n",
    );
    assert!(describe(None, &file.robot, &file.case).is_ok());
    let mut case = file.case.clone();
    let Some(Shortening::Length(length)) = &mut case.commands[0].shortening else { panic!() };
    *length += 1e-3;
    let error = describe(None, &file.robot, &case).unwrap_err().to_string();
    assert!(error.contains("angle_offset"), "{error}");
}

/// A number that the file says to be zero, which is as if it said nothing, is changed where it stands.
#[test]
fn a_fitted_number_takes_the_place_of_a_zero() {
    let zero = "angle_offset = \"0 deg\"   # as mounted";
    let text = format!("{ROBOT}{MOTORS}").replace("angle_offset = \"10 deg\"", zero);
    let file = parse(&text, "robot.toml").unwrap();
    let mut motors = file.robot.motors().to_vec();
    motors[0] = Motor { offset: 0.05, ..motors[0].clone() };
    let fitted = file.robot.clone().with_motors(motors).unwrap();
    let written = file.with_numbers_of(&fitted, &file.case, Vec3::ZERO, Path::new(".")).unwrap();
    assert!(
        written.keeps_text && written.text.contains("deg\"   # as mounted"),
        "{}",
        written.text
    );
    let again = parse(&written.text, "again.toml").unwrap();
    assert!((again.robot.motors()[0].offset - 0.05).abs() < 1e-12, "{}", written.text);
}
