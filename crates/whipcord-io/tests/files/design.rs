//! `[design]`, read and written.

use whipcord_design::{Criterion, CurveKind, Quantity, TargetShape, Vary};
use whipcord_io::{CaseFile, DesignShape, NoDesignProblem, describe, describe_goal, parse, toml};

const ROBOT: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n[disks]\ncount = 4\nhole_circle_radius = \"8 mm\"\nholes = 12\n[[cables]]\nname = \"pull\"\nholes = [1, 1, 1, 1]\ntension = 3\n[[cables]]\nname = \"back\"\nholes = [7, 7, 7, 7]\ntension = 0\n";
const DESIGN: &str = "[design]\nvary = [\"cables[pull].holes\", \"cables[0].tension\"]\nmax_jump = 2\ncriteria = [\"tension, weight = 0.01, at_most = 6 N\", \"stiffness, disk = 4, direction = x, at_least = 0.2 N/mm\"]\ndistinct = true\ncrossing = false\ndiameter = [\"1 mm\", \"5 mm\"]\nplaces = 11\n[[design.fixed]]\ncable = \"pull\"\ndisk = 1\nhole = 4\n[[design.targets]]\ncurve = \"arc, angle = 90 deg, direction = 1 rad\"\ntension = [\"4 N\", 0]\nweight = 2\n[[design.targets]]\ntip = [\"40 mm\", 0, 0.12]\n[design.tolerances]\nhole_radius = \"0.1 mm\"\nstiffness = \"3 %\"\nsamples = 40\n";

fn read(tail: &str) -> CaseFile {
    parse(&format!("{ROBOT}{tail}"), "robot.toml").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_design_is_read_in_si_and_written_as_it_is_read() {
    let file = read(DESIGN);
    let problem = file.goal.design.problem(&file.robot, &file.case, &file.goal, None).unwrap();
    assert_eq!(problem.vary, [Vary::Holes { cable: 0 }, Vary::Tension { cable: 0 }]);
    assert_eq!(problem.options.rules.largest_jump, Some(2));
    assert!(problem.options.rules.are_distinct && problem.options.rules.do_not_cross);
    assert_eq!(problem.options.rules.fixed[0].disk, 0);
    let [tension, stiffness] = problem.options.criteria[..] else { panic!() };
    assert_eq!((tension.weight, tension.limit), (Some(0.01), Some(6.0)));
    let quantity = Quantity::Stiffness { disk: 3, direction: Some(whipcord::Vec3::X) };
    assert_eq!(stiffness, Criterion { quantity, weight: None, limit: Some(200.0) });
    assert_eq!(problem.options.diameters, Some([0.001, 0.005]));
    assert_eq!(problem.goals[0].case.commands[0].tension, Some(4.0));
    assert_eq!(problem.goals[1].case.commands[0].tension, Some(3.0));
    assert_eq!(problem.goals[0].weight, 2.0);
    assert_eq!((problem.tolerances.samples, problem.tolerances.stiffness), (40, 0.03));
    let DesignShape::Curve(curve) = file.goal.design.targets[0].shape else { panic!() };
    assert!(
        matches!(curve.kind, CurveKind::Arc { angle } if (angle - core::f64::consts::FRAC_PI_2).abs() < 1e-6)
    );
    let mut table = describe(None, &file.robot, &file.case).unwrap();
    describe_goal(&file.goal, &mut table);
    let again = parse(&toml(&table), "again.toml").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.goal, file.goal);
    let none = read("");
    let problem = none.goal.design.problem(&none.robot, &none.case, &none.goal, None);
    assert_eq!(problem, Err(NoDesignProblem::NoTarget));
}

/// Each point of a path is a target with tensions of its own; criteria need none.
#[test]
fn a_path_needs_tensions_that_vary_and_criteria_need_no_target() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        file
    };
    write("path.csv", "t,x [mm],y [mm],z [mm]\n0,10,0,170\n1,20,0,165\n2,30,0,160\n");
    let problem = |vary: &str, targets: &str| {
        let text = format!("{ROBOT}[design]\nvary = [{vary}]\n{targets}");
        let file = write("robot.toml", &text);
        let file = whipcord_io::load(&file).unwrap_or_else(|error| panic!("{error}"));
        (file.goal.design.problem(&file.robot, &file.case, &file.goal, None), file)
    };
    let path = "[[design.targets]]\npath = \"path.csv\"\nweight = 3\n";
    let (found, file) = problem("\"cables[0].routing\", \"tension\"", path);
    let found = found.unwrap();
    assert_eq!(found.goals.len(), 3);
    let third = &found.goals[2];
    let place = whipcord::Vec3::new(0.03, 0.0, 0.16);
    assert_eq!((&third.target, third.weight), (&TargetShape::Points(vec![(3, place)]), 3.0));
    let mut table = describe(None, &file.robot, &file.case).unwrap();
    describe_goal(&file.goal, &mut table);
    assert!(toml(&table).contains("path.csv"), "{}", toml(&table));
    let refused = problem("\"cables[0].routing\"", path).0;
    assert_eq!(refused, Err(NoDesignProblem::PathTensions));
    let [target] = ["[target]\npath = \"path.csv\"\n"];
    assert_eq!(problem("\"tension\"", target).0.unwrap().goals.len(), 3);
    let (found, _) = problem("\"backbone.diameter\"", "criteria = [\"workspace, weight = 1\"]\n");
    assert_eq!(found.unwrap().goals[0].target, TargetShape::Points(Vec::new()));
    // Orientations, and nothing at all.
    write("turned.csv", "t,x,y,z,qw,qx,qy,qz\n0,0,0,0.1,1,0,0,0\n");
    write("empty.csv", "t,x,y,z\n");
    for (name, words) in [("turned.csv", "has orientations"), ("empty.csv", "")] {
        let text = format!("{ROBOT}[[design.targets]]\npath = \"{name}\"\n");
        let error = whipcord_io::load(write("robot.toml", &text)).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn what_is_wrong_with_a_design_is_told_with_its_place() {
    for (tail, words) in [
        (
            "[design]\nvary = [\"cables[9].holes\"]\n",
            "nothing that can be varied (there is no cable `9`",
        ),
        ("[design]\nvary = [\"colour\"]\n", ":19:9: error: `colour` is nothing that can be varied"),
        ("[design]\ncriteria = [\"clearance\"]\n", "neither an objective nor a constraint"),
        ("[design]\ncriteria = [\"stiffnes, disk = 2\"]\n", "did you mean `stiffness`?"),
        ("[design]\ncriteria = [\"stiffness, disk = 9, weight = 1\"]\n", "there is no disk 9"),
        ("[[design.targets]]\npath = \"no.csv\"\n", "no.csv"),
        ("[[design.targets]]\ncurve = \"arc\"\n", "has no `angle`"),
        ("[[design.targets]]\ncurve = \"ark, angle = 1\"\n", "`ark` is no curve"),
        ("[[design.targets]]\ntip = [0, 0, 0.1]\ntension = [1]\n", "tension"),
        ("[[design.targets]]\nmeasured = true\n", "no disks were measured"),
        ("[[design.targets]]\nweight = 1\n", "curve"),
        ("[design]\ndiameter = [\"5 mm\", \"1 mm\"]\n", "design.diameter"),
        (
            "[design]\nmax_jump = 1\nvary = [\"holes\"]\n[[design.fixed]]\ncable = \"x\"\ndisk = 9\nhole = 1\n",
            "there is no cable `x`",
        ),
    ] {
        let error = parse(&format!("{ROBOT}{tail}"), "robot.toml").unwrap_err().to_string();
        assert!(error.contains(words), "{tail}{error}");
    }
}
