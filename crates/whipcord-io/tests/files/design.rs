//! `[design]`, read and written.

use whipcord_design::{CurveKind, Vary};
use whipcord_io::{CaseFile, DesignShape, NoDesignProblem, describe, describe_goal, parse, toml};

const ROBOT: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n[disks]\ncount = 4\nhole_circle_radius = \"8 mm\"\nholes = 12\n[[cables]]\nname = \"pull\"\nholes = [1, 1, 1, 1]\ntension = 3\n[[cables]]\nname = \"back\"\nholes = [7, 7, 7, 7]\ntension = 0\n";
const DESIGN: &str = "[design]\nvary = [\"cables[pull].holes\", \"cables[0].tension\"]\nmax_jump = 2\ndistinct = true\ncrossing = false\ndiameter = [\"1 mm\", \"5 mm\"]\nplaces = 11\n[[design.fixed]]\ncable = \"pull\"\ndisk = 1\nhole = 4\n[[design.targets]]\ncurve = \"arc, angle = 90 deg, direction = 1 rad\"\ntension = [\"4 N\", 0]\nweight = 2\n[[design.targets]]\ntip = [\"40 mm\", 0, 0.12]\n[design.tolerances]\nhole_radius = \"0.1 mm\"\nstiffness = \"3 %\"\nsamples = 40\n";

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

#[test]
fn what_is_wrong_with_a_design_is_told_with_its_place() {
    for (tail, words) in [
        (
            "[design]\nvary = [\"cables[9].holes\"]\n",
            "nothing that can be varied (there is no cable `9`",
        ),
        ("[design]\nvary = [\"colour\"]\n", ":19:9: error: `colour` is nothing that can be varied"),
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
