use proptest::prelude::*;
use whipcord::four_bar::{Chord, FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, DistributedLoad, Material, PointLoad,
    PointMass, RestCurvature, Robot, Routing, Shortening, SolveError, Vec3,
};

fn straight() -> Cable {
    Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 })
}

fn robot(backbone: Backbone, cables: Vec<Cable>) -> Robot {
    Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), cables).unwrap()
}

fn plain() -> Robot {
    robot(Backbone::new(0.18), vec![straight()])
}

fn refused(robot: &Robot, options: &Options) -> String {
    FourBar::new(robot, options).unwrap_err().to_string()
}

fn answer(robot: &Robot, options: &Options, shortening: f64) -> SolveError {
    let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
    let model = FourBar::new(robot, options).unwrap();
    model.solve(&case, None, &mut Workspace::default()).unwrap_err()
}

#[test]
fn what_a_geometric_model_cannot_take_is_named() {
    let options = Options::default();
    let curved = Backbone {
        rest_curvature: RestCurvature::Uniform(Vec3::new(0.0, 4.0, 0.0)),
        ..Backbone::new(0.18)
    };
    let printed = Options { objective: Objective::AsPrinted, ..options.clone() };
    assert_eq!(
        refused(&robot(curved, vec![straight()]), &printed),
        "the four-bar model cannot take `backbone.rest_curvature` (a pre-bent backbone with the objective \
         as-printed): the printed equations are those of a straight one: take coupler-angle"
    );
    let elastic = Cable { axial_stiffness: Some(2e3), ..straight() };
    let text = refused(&robot(Backbone::new(0.18), vec![straight_named("a"), elastic]), &options);
    assert!(
        text.contains("`axial_stiffness` of cable 2 (a cable or drive that stretches)"),
        "{text}"
    );
    let between = Cable { ends_at: Some(0.09), ..straight() };
    let text = refused(&robot(Backbone::new(0.18), vec![between]), &printed);
    assert!(
        text.contains("`ends_at` of cable 1 (a cable that ends between two disks with"),
        "{text}"
    );
    let text = refused(&plain(), &Options { actuation: Actuation::Tension, ..options.clone() });
    assert!(text.contains("give each cable's shortening, or take the objective"), "{text}");
    let strain = Options { objective: Objective::StrainEnergy, ..options.clone() };
    let text = refused(&plain(), &strain);
    assert!(text.contains("needs `backbone.poisson_ratio`"), "{text}");
    let rubbing = Cable { friction: Some(0.1), ..straight() };
    let rubbing = robot(Backbone::new(0.18), vec![rubbing]);
    assert!(FourBar::new(&rubbing, &options).is_ok());
    let text = refused(&rubbing, &Options { lengths: LengthRule::Free, ..options });
    assert!(text.contains("`friction` of cable 1"), "{text}");
}

fn straight_named(name: &str) -> Cable {
    Cable { name: name.to_owned(), ..straight() }
}

#[test]
fn the_printed_equations_take_one_cable_and_no_variants() {
    let printed = Options { objective: Objective::AsPrinted, ..Options::default() };
    let two = robot(Backbone::new(0.18), vec![straight_named("a"), straight_named("b")]);
    assert!(refused(&two, &printed).contains("cable 2 (a second"));
    assert!(refused(&plain(), &Options { chord: Chord::Arc, ..printed.clone() }).contains("arc"));
    assert!(refused(&plain(), &Options { lengths: LengthRule::Free, ..printed }).contains("free"));
}

#[test]
fn loads_and_missing_commands_are_named() {
    let model = FourBar::new(&plain(), &Options::default()).unwrap();
    let solve =
        |case: &Case| model.solve(case, None, &mut Workspace::default()).unwrap_err().to_string();
    let case = Case::with_shortenings(&[Shortening::Fraction(0.05)]);
    let with = |change: fn(&mut Case)| {
        let mut case = case.clone();
        change(&mut case);
        solve(&case)
    };
    let text = with(|c| c.loads.gravity = Some(Vec3::new(0.0, 0.0, -9.81)));
    assert!(text.contains("`loads.gravity` (weight)") && text.contains("use cosserat"), "{text}");
    assert!(with(|c| c.loads.tip_force = Vec3::X).contains("loads.tip_force"));
    assert!(with(|c| c.loads.tip_moment = Vec3::X).contains("loads.tip_moment"));
    let text = with(|c| c.loads.distributed.push(DistributedLoad::uniform(0.09, Vec3::X)));
    assert!(text.contains("distributed load 1 (a distributed force or moment)"), "{text}");
    // A mass is no load by itself, but it must be one that can be.
    let text = with(|c| c.loads.masses.push(PointMass { at: 0.1, mass: -1.0 }));
    assert!(text.contains("`mass` of mass 1: must not be negative"), "{text}");
    let point = |c: &mut Case| {
        c.loads.points.push(PointLoad { at: 0.09, force: Vec3::X, ..PointLoad::default() });
    };
    assert!(with(point).contains("point load 1 (a force or moment)"));
    let tension = Case::with_tensions(&[3.0]);
    assert_eq!(
        solve(&tension),
        "the four-bar model needs `shortening` of cable 1: \
         it is driven by lengths without a strain energy: give each cable's shortening, \
         or take the objective strain-energy with the length rule free, or use cosserat"
    );
    // A tension beside the shortening does no harm.
    assert!(
        model
            .solve(
                &Case {
                    commands: vec![CableCommand {
                        tension: Some(3.9),
                        shortening: Some(Shortening::Fraction(0.05))
                    }],
                    ..Case::default()
                },
                None,
                &mut Workspace::default()
            )
            .is_ok()
    );
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for value in bad {
        for shortening in [Shortening::Fraction(value), Shortening::Length(value)] {
            let error = model
                .solve(&Case::with_shortenings(&[shortening]), None, &mut Workspace::default())
                .unwrap_err();
            assert!(matches!(error, SolveError::Invalid(_)), "{error}");
        }
    }
    assert!(matches!(
        model.solve(&Case::default(), None, &mut Workspace::default()),
        Err(SolveError::Invalid(_))
    ));
}

#[test]
fn a_section_that_cannot_be_so_short_says_which_and_how_short_it_gets() {
    // At 180° of bend ℓ = l₀ − 2a = 4 mm.
    for shortening in [9.0 * 0.0161, 0.17, 0.18, 0.2] {
        match answer(&plain(), &Options::default(), shortening) {
            SolveError::SectionOutOfReach { cable, disk, requested, shortest, longest } => {
                assert_eq!((cable.as_str(), disk), ("pull", 1));
                assert!((requested - (0.02 - shortening / 9.0)).abs() < 1e-15);
                assert!((shortest - 0.004).abs() < 1e-6 && (longest - 0.02).abs() < 1e-15);
            }
            other => panic!("{other}"),
        }
    }
    let holes = Cable::new("turning", Routing::holes(vec![1, 1, 1, 1, 1, 2, 3, 4, 5, 6]));
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let turning = Robot::new(Backbone::new(0.18), disks, vec![holes]).unwrap();
    let error = answer(&turning, &Options::default(), 0.17);
    assert!(matches!(error, SolveError::SectionOutOfReach { .. }), "{error}");
    let free = Options { lengths: LengthRule::Free, ..Options::default() };
    match answer(&plain(), &free, 0.15) {
        SolveError::UnreachableLength { cable, requested, reachable } => {
            assert_eq!(cable, "pull");
            assert!((requested - 0.15).abs() < 1e-15 && (reachable - 0.144).abs() < 2e-4);
        }
        other => panic!("{other}"),
    }
    let printed = Options { objective: Objective::AsPrinted, ..Options::default() };
    let error = answer(&plain(), &printed, 9.0 * 0.0161);
    assert!(matches!(error, SolveError::SectionOutOfReach { .. }), "{error}");
}

#[test]
fn a_cable_without_lever_arm_says_so() {
    let centre = Cable::new("core", Routing::Straight { angle: 0.0, radius: 0.0 });
    let across = Cable::new("core", Routing::Linear { start: [0.008, 0.0], end: [-0.008, 0.0] });
    let disks = || Disks::equally_spaced(0.18, 2, 0.008);
    for cable in [centre, across] {
        let robot = Robot::new(Backbone::new(0.18), disks(), vec![cable]).unwrap();
        for chord in [Chord::Bisector, Chord::Arc] {
            let error = answer(&robot, &Options { chord, ..Options::default() }, 1e-3);
            assert_eq!(error, SolveError::NoLever { cable: "core".into(), disk: 1 });
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Whatever is asked of whatever robot: finite numbers, or an error in finite numbers.
    #[test]
    fn nothing_leads_to_a_panic_or_to_a_number_that_is_none(
        ends in prop::collection::vec(
            prop::collection::vec(prop_oneof![Just(0.0), -0.03_f64..0.03], 4), 1..5),
        pulls in prop::collection::vec(prop_oneof![Just(0.0), -1.0_f64..1.0, -0.1_f64..0.2], 4),
        objective in 0_usize..3,
        rule in 0_usize..3,
        arc: bool,
    ) {
        let cables: Vec<Cable> = ends
            .iter()
            .enumerate()
            .map(|(i, e)| {
                let routing = Routing::Linear { start: [e[0], e[1]], end: [e[2], e[3]] };
                Cable::new(format!("{i}"), routing)
            })
            .collect();
        let backbone = Backbone {
            material: Material { poisson_ratio: Some(0.3), ..Material::default() },
            ..Backbone::new(0.06)
        };
        let count = cables.len();
        let disks = Disks::equally_spaced(0.06, 4, 0.008);
        let robot = Robot::new(backbone, disks, cables).unwrap();
        let options = Options {
            objective: Objective::ALL[objective],
            lengths: LengthRule::ALL[rule],
            chord: if arc { Chord::Arc } else { Chord::Bisector },
            ..Options::default()
        };
        let Ok(model) = FourBar::new(&robot, &options) else { return Ok(()) };
        let shortenings: Vec<_> =
            pulls[..count].iter().map(|&f| Shortening::Fraction(f)).collect();
        match model.solve(&Case::with_shortenings(&shortenings), None, &mut Workspace::default()) {
            Ok(solution) => {
                for pose in &solution.disks.poses {
                    let finite = pose.rotation.wxyz().iter().all(|x| x.is_finite());
                    prop_assert!(pose.position.is_finite() && finite);
                }
                prop_assert!(solution.cables.iter().all(|c| c.length.is_finite()));
                prop_assert!(solution.diagnostics.residual.is_finite());
            }
            Err(error) => {
                let text = error.to_string();
                prop_assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            }
        }
    }
}
