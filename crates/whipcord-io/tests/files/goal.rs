//! Targets and limits, read and written.

use whipcord::{Shortening, UnitQuaternion, Vec3};
use whipcord_inverse::{Actuator, CableLimits, PathPoint, Preference, Target};
use whipcord_io::{
    CaseFile, Clearance, Dimension, Goal, RateMismatch, describe, describe_goal, load, load_path,
    load_shape, parse, toml,
};

const ROBOT: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\n[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 12\n[[cables]]\nname = \"left\"\nholes = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\ntension_limits = [1, \"9 N\"]\nshortening_limits = [\"-10 %\", \"10 %\"]\nrate_limit = \"2 N/s\"\n[[cables]]\nname = \"right\"\nholes = [7, 7, 7, 7, 7, 7, 7, 7, 7, 7]\n";
const LIMITS: &str = "[limits]\ntension = [\"0.2 N\", \"20 N\"]\nshortening = [\"-10 mm\", \"25 mm\"]\nrate = \"5 mm/s\"\n[prefer]\nleast = \"clearance\"\nclearance = \"2 mm\"\n";

fn read(tail: &str) -> CaseFile {
    parse(&format!("{ROBOT}{tail}"), "robot.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn of(tail: &str) -> Goal {
    read(tail).goal
}

#[test]
fn targets_are_read_in_si() {
    let tip = Vec3::new(0.04, 0.0, 0.12);
    let point = "tip = [\"40 mm\", 0, \"12 cm\"]";
    assert_eq!(of(&format!("[target]\n{point}\n")).target, Some(Target::Tip(tip)));
    assert_eq!(
        of(&format!("[target]\n{point}\naxis = [0, 0, 2]\n")).target,
        Some(Target::Axis { point: Some(tip), direction: Vec3::new(0.0, 0.0, 2.0) })
    );
    let turned = "[target.pose]\nposition = [0.04, 0, 0.12]\nrotation = { axis = [0, 1, 0], angle = \"90 deg\" }\n";
    let Some(Target::Pose(pose)) = of(turned).target else { panic!("a pose") };
    assert_eq!(pose.position, tip);
    assert!((pose.rotation.rotate(Vec3::Z) - Vec3::X).norm() < 1e-15);
    let goal = of(&format!("[target]\n{point}\ntolerance = \"0.06 mm\"\n"));
    let tolerance = goal.tolerance(0.18).unwrap();
    // The angle that moves the tip so far at a third of the length.
    assert!((tolerance.position - 6e-5).abs() < 1e-18 && (tolerance.angle - 1e-3).abs() < 1e-15);
    assert_eq!(of("").tolerance(0.18), None);
}

#[test]
fn a_cable_has_the_limits_of_all_or_its_own() {
    let file = read(LIMITS);
    let (robot, goal) = (&file.robot, &file.goal);
    let by_tension = [Actuator::Tension(0), Actuator::Shortening(1)];
    let limits = goal.limits(robot, &by_tension).unwrap();
    let length = robot.cable_length(0);
    let own = [-0.1 * length, 0.1 * length];
    assert_eq!(
        limits.cables,
        [
            CableLimits { tension: [1.0, 9.0], shortening: own, rate: Some(2.0) },
            CableLimits { tension: [0.2, 20.0], shortening: [-0.01, 0.025], rate: Some(0.005) },
        ]
    );
    // A rate in N/s is none of a shortening.
    let by_length = [Actuator::Shortening(0), Actuator::Shortening(1)];
    assert_eq!(goal.limits(robot, &by_length), Err(RateMismatch { cable: 0, by_tension: false }));
    // Of cables that a motor pulls, the motor is limited.
    assert!(goal.limits(robot, &[Actuator::Motor(0)]).unwrap().cables[0].rate.is_none());
    assert_eq!(goal.preference, Some(Preference::MostClearance));
    assert_eq!(goal.clearance, Some(Clearance::Least(0.002)));
    assert_eq!(of("[prefer]\nclearance = \"touch\"\n").clearance, Some(Clearance::Touch));
    assert_eq!(goal.all.rate, Some((0.005, Dimension::Speed)));
    assert_eq!(goal.own[0].shortening, Some([-0.1, 0.1].map(Shortening::Fraction)));
}

#[test]
fn what_is_written_is_read_as_the_same() {
    let targets = [
        "[target]\ntip = [0.04, 0, 0.12]\ntolerance = 1e-4\n",
        "[target]\naxis = [0, 0.6, 0.8]\ntolerance_angle = 0.01\n",
        "[target]\ntip = [0.04, 0, 0.12]\naxis = [0, 0.6, 0.8]\n",
        "[target.pose]\nposition = [0.04, 0, 0.12]\norientation = [1, 0, 0, 0]\n",
        "[target.pose]\nposition = [0.04, 0, 0.12]\norientation = [0.6, 0, 0.8, 0]\n",
        "",
    ];
    for target in targets {
        for limits in
            ["", LIMITS, "[prefer]\nclearance = \"touch\"\n", "[limits]\nrate = \"3 N/s\"\n"]
        {
            let file = read(&format!("{target}{limits}"));
            let mut table = describe(None, &file.robot, &file.case).unwrap();
            describe_goal(&file.goal, &mut table);
            let text = toml(&table);
            let again = parse(&text, "again.toml").unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(again.goal, file.goal, "{text}");
        }
    }
}

#[test]
fn a_shape_is_read_from_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("shape.csv", "disk,x [mm],y [mm],z [mm]\n10,40,0,120\n5.0,10,0,70\n");
    write("robot.toml", &format!("{ROBOT}[target]\nshape = \"shape.csv\"\n"));
    let file = load(folder.path().join("robot.toml")).unwrap();
    let points = vec![(9, Vec3::new(0.04, 0.0, 0.12)), (4, Vec3::new(0.01, 0.0, 0.07))];
    assert_eq!(file.goal.target, Some(Target::Shape(points.clone())));
    assert_eq!(load_shape(&folder.path().join("shape.csv"), 10), Ok(points));
    // Written for another folder, it names the same file.
    let below = folder.path().join("below");
    std::fs::create_dir(&below).unwrap();
    let text = file.with_numbers_of(&file.robot, &file.case, Vec3::ZERO, &below).unwrap();
    assert!(text.keeps_text && text.text.contains("shape = \"../shape.csv\""), "{}", text.text);
}

#[test]
fn a_path_is_read_from_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        folder.path().join(name)
    };
    file("path.csv", "t [ms],x [mm],y [mm],z [mm]\n0,40,0,120\n500,0,0,180\n");
    let robot = file("robot.toml", &format!("{ROBOT}[target]\npath = \"path.csv\"\n"));
    let goal = load(robot).unwrap().goal;
    let at =
        |time, [x, y, z]: [f64; 3]| PathPoint { time, target: Target::Tip(Vec3::new(x, y, z)) };
    assert_eq!(goal.path, [at(0.0, [0.04, 0.0, 0.12]), at(0.5, [0.0, 0.0, 0.18])]);
    assert_eq!(goal.target, None);
    let posed = file("posed.csv", "time,x,y,z,qw,qx,qy,qz\n1,0,0,0.1,2,0,0,0\n");
    let points = load_path(&posed).unwrap();
    assert!(
        matches!(&points[0].target, Target::Pose(pose) if pose.rotation == UnitQuaternion::IDENTITY)
    );
    for (text, words) in [
        ("", "the file has no rows"),
        ("t,x,y\n0,0,0\n", "there is no column z"),
        ("t,x,y,z,qw\n0,0,0,0,1\n", "there is no column `qx` beside the others"),
        ("t,x,y,z,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n", "the orientation has no direction"),
        ("t,x,y,z\n1,0,0,0\n0.5,0,0,0\n", "path.csv:3:1: error: the times do not ascend"),
        ("t,x,y,z\n1,0,0,nan\n", "path.csv:2:7: error: this line has no `z`"),
        ("t [mm],x,y,z\n1,0,0,0\n", "`mm` is no unit of a time"),
    ] {
        let error = load_path(&file("path.csv", text)).unwrap_err().to_string();
        assert!(error.contains(words), "{text}{error}");
    }
}

#[test]
fn a_file_that_extends_another_has_a_target_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("arm.toml", &format!("{ROBOT}[target]\ntip = [0, 0, 0.1]\naxis = [0, 0, 1]\n{LIMITS}"));
    write(
        "posed.toml",
        "extends = \"arm.toml\"\n[target.pose]\nposition = [0.04, 0, 0.12]\norientation = [1, 0, 0, 0]\n[limits]\nrate = \"1 mm/s\"\n",
    );
    let goal = load(folder.path().join("posed.toml")).unwrap().goal;
    assert!(matches!(goal.target, Some(Target::Pose(_))));
    assert_eq!(
        (goal.all.tension, goal.all.rate),
        (Some([0.2, 20.0]), Some((0.001, Dimension::Speed)))
    );
}
