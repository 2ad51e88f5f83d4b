//! Every kind of routing, with few and many sections, slightly and strongly bent, without and with a load.

use core::f64::consts::PI;

use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, Robot, RobotError, Routing, Section, Vec3,
};

use super::SuiteCase;
use crate::model_benchmark::{LoadKind, Tags};

/// The paper's prototype: length, diameter and hole circle in m, Young's modulus in Pa, Poisson's ratio.
pub(super) const LENGTH: f64 = 0.18;
const DIAMETER: f64 = 0.003;
pub(super) const RADIUS: f64 = 0.008;
const YOUNG_MODULUS: f64 = 1.1e9;
const POISSON_RATIO: f64 = 0.3;

/// Numbers of sections: few, the paper's, as many as robots commonly have, more, and nearly continuous.
const SECTIONS: [usize; 5] = [5, 9, 20, 40, 100];
/// Of those, the ones that are loaded too: a load does nothing new with others.
const LOADED: [usize; 2] = [9, 40];
/// Bending in degrees: τrL/EI, by which a straight cable at the radius r bends a rod that it pulls with τ. What
/// other routings make of the same tension is their own.
const BENDING: [f64; 4] = [30.0, 90.0, 180.0, 270.0];
/// The load, relative to EI/L²: a force at the tip across the plane in which a straight cable bends the robot.
const LOAD: f64 = 0.3;

/// Name and cables of each kind of routing.
fn routings() -> [(&'static str, Vec<Routing>); 5] {
    let helix = |start_angle: f64, turns| Routing::Helix { start_angle, turns, radius: RADIUS };
    let (l2, l3) = (LENGTH * LENGTH, LENGTH * LENGTH * LENGTH);
    [
        ("straight", vec![Routing::Straight { angle: 0.0, radius: RADIUS }]),
        ("helical", vec![helix(0.0, 0.75)]),
        // From one side to the other, x = r(1 − 6t² + 4t³), and past the axis on the way, y = 2rt(1 − t).
        (
            "S-shaped",
            vec![Routing::Polynomial {
                x: vec![RADIUS, 0.0, -6.0 * RADIUS / l2, 4.0 * RADIUS / l3],
                y: vec![0.0, 2.0 * RADIUS / LENGTH, -2.0 * RADIUS / l2],
            }],
        ),
        ("converging", vec![Routing::Linear { start: [RADIUS, 0.0], end: [0.3 * RADIUS, 0.0] }]),
        // Two that wind against each other and cross halfway; each pulls with half the tension.
        (
            "crossing",
            vec![helix(-60_f64.to_radians(), 1.0 / 3.0), helix(60_f64.to_radians(), -1.0 / 3.0)],
        ),
    ]
}

pub(super) fn cases() -> Result<Vec<SuiteCase>, RobotError> {
    let mut cases = Vec::new();
    for (routing, cables) in routings() {
        for sections in SECTIONS {
            let robot = robot(sections, &cables)?;
            for bending in BENDING {
                for loaded in [false, true] {
                    if !loaded || LOADED.contains(&sections) {
                        cases.push(case(routing, &robot, bending, loaded));
                    }
                }
            }
        }
    }
    Ok(cases)
}

pub(super) fn robot(sections: usize, routings: &[Routing]) -> Result<Robot, RobotError> {
    let backbone = Backbone {
        section: Some(Section::circle(DIAMETER)),
        material: Material {
            young_modulus: Some(YOUNG_MODULUS),
            poisson_ratio: Some(POISSON_RATIO),
            ..Default::default()
        },
        ..Backbone::new(LENGTH)
    };
    let disks = Disks::equally_spaced(LENGTH, sections + 1, RADIUS);
    let cables = routings
        .iter()
        .enumerate()
        .map(|(i, routing)| Cable::new(format!("cable {}", i + 1), routing.clone()))
        .collect();
    Robot::new(backbone, disks, cables)
}

/// EI in N·m² of a round rod.
fn bending_stiffness() -> f64 {
    YOUNG_MODULUS * PI * DIAMETER.powi(4) / 64.0
}

/// With the tensions that bend a robot of straight cables so.
pub(super) fn pulled(robot: &Robot, bending: f64) -> Case {
    let cables = robot.cables().len();
    let tension = bending * bending_stiffness() / (RADIUS * LENGTH * cables as f64);
    Case::with_tensions(&vec![tension; cables])
}

fn case(routing: &'static str, robot: &Robot, degrees: f64, loaded: bool) -> SuiteCase {
    let bending = degrees.to_radians();
    let sections = robot.disks().count() - 1;
    let mut case = pulled(robot, bending);
    if loaded {
        let force = LOAD * bending_stiffness() / (LENGTH * LENGTH);
        case.loads = Loads { tip_force: Vec3::new(0.0, force, 0.0), ..Loads::default() };
    }
    let (name, load) = (routing.to_lowercase(), if loaded { "-loaded" } else { "" });
    SuiteCase {
        stem: format!("{name}-{sections}-{degrees:.0}{load}"),
        title: format!(
            "{routing}, {sections} sections, {degrees:.0}°{}",
            if loaded { ", loaded" } else { "" }
        ),
        robot: robot.clone(),
        case,
        tags: Tags {
            routing,
            bending,
            load_kind: if loaded { LoadKind::TipForce } else { LoadKind::None },
        },
    }
}

#[cfg(test)]
mod tests {
    use whipcord::{Actuation, Cancel, Model, ModelKind, Statics as _, Stations};

    use super::*;
    use crate::model_benchmark::candidate::{Candidate, Preset};
    use crate::model_benchmark::reference::Choice;
    use crate::model_benchmark::results::Results;
    use crate::model_benchmark::summary;

    #[test]
    fn cases_are_valid_and_written_as_files_that_say_the_same() {
        let mut cases = cases().unwrap();
        assert_eq!(cases.len(), 5 * (5 + 2) * 4);
        cases.extend(super::super::contact::cases().unwrap());
        for case in &cases {
            case.case.check(&case.robot).unwrap();
            let file = whipcord_io::parse(&case.file().unwrap(), &case.stem).unwrap();
            assert_eq!((&file.title, &file.case), (&case.title, &case.case));
            assert_eq!(file.robot.routes(), case.robot.routes());
        }
        let mut stems: Vec<&str> = cases.iter().map(|case| case.stem.as_str()).collect();
        stems.sort_unstable();
        stems.dedup();
        assert_eq!(stems.len(), cases.len());
    }

    /// θ = τrL/EI holds for a rod that does not stretch; here the tension takes up to 0.2 % of the length.
    #[test]
    fn straight_cables_bend_the_robot_as_the_suite_says() {
        let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
        let straight = |case: &SuiteCase| {
            case.tags.routing == "straight" && case.tags.load_kind == LoadKind::None
        };
        for case in cases().unwrap().iter().filter(|case| straight(case)) {
            let answer = model.solve(&case.robot, &case.case).unwrap();
            let tip = answer.disks.tip().rotation.log().norm();
            // Beyond half a turn the shorter way round.
            let expected = case.tags.bending.min(2.0 * PI - case.tags.bending);
            assert!((tip - expected).abs() < 0.002 * case.tags.bending, "{}: {tip}", case.stem);
        }
    }

    /// A robot of every routing: who refuses what, and what the tables say of it.
    #[test]
    fn refusals_are_rows_and_routings_are_columns() {
        let cases = cases().unwrap();
        let nine = |case: &&SuiteCase| {
            case.robot.disks().count() == 10 && case.tags.bending == 90_f64.to_radians()
        };
        let subjects: Vec<_> = cases.iter().filter(nine).map(SuiteCase::subject).collect();
        assert_eq!(subjects.len(), 10);
        let kinds = [ModelKind::Cosserat, ModelKind::FourBar];
        let reference = Choice::Model { kind: ModelKind::CosseratDisks, fine: false };
        let results = Results::of(&subjects, &kinds, reference, &Cancel::default(), |_| ());
        for benchmark in &results.benchmarks {
            let loaded = benchmark.tags.unwrap().load_kind != LoadKind::None;
            for entry in &benchmark.entries {
                let Candidate { kind, preset } = entry.candidate;
                let geometric = kind == ModelKind::FourBar && preset != Preset::StrainEnergy;
                assert_eq!(entry.outcome.is_err(), loaded && geometric, "{}", benchmark.title);
            }
        }
        let usual = Candidate { kind: ModelKind::Cosserat, preset: Preset::Usual };
        // 1.7 % at the paper's tension, which bends a robot by 73°.
        let error = results.benchmarks[0].error(usual).unwrap();
        assert!((0.005..0.03).contains(&error), "{error}");
        let tables = summary::tables(&results.benchmarks, &results.candidates);
        let text = tables[0].1.text(Default::default());
        let head: Vec<&str> = text.lines().next().unwrap().split_whitespace().collect();
        assert_eq!(head, ["model", "straight", "helical", "S-shaped", "converging", "crossing"]);
        assert!(text.contains("(1/2)"), "{text}");
        let recommendation = results.recommendation();
        assert_eq!(recommendation.len(), 4 + 3, "{recommendation:?}");
        // Nothing in the suite has many sections here, so that the robots were cut.
        assert_eq!((results.cut.len(), results.cut[0].sections), (4, 100));
    }
}
