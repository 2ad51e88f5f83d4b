//! Four-bar sections under tensions and loads: against the lengths that these make, closed forms, and the rod.

use core::f64::consts::PI;

use proptest::prelude::*;
use whipcord::four_bar::{Chord, FourBar, LengthRule, Objective, Options, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Disks, Loads, Material, Model, ModelKind,
    RestCurvature, Robot, Routing, Section, Shortening, Solution, SolveError, Statics, Stations,
    Stiffness, Vec3,
};

use crate::common::samples;

const LENGTH: f64 = 0.18;

fn free(chord: Chord) -> Options {
    Options {
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        chord,
        ..Options::default()
    }
}

fn solve(robot: &Robot, options: &Options, case: &Case) -> Result<Solution, SolveError> {
    FourBar::new(robot, options)?.solve(case, None, &mut Workspace::default())
}

fn backbone() -> Backbone {
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    Backbone { material, section: Some(Section::circle(0.003)), ..Backbone::new(LENGTH) }
}

/// `EI` of it in N·m².
fn bending_stiffness() -> f64 {
    1.1e9 * PI * 0.003_f64.powi(4) / 64.0
}

/// Robots with one or two cables, some of which end between two disks, pre-bent or not, and shortenings that are a few per cent.
fn robots() -> impl Strategy<Value = (Robot, Vec<f64>)> {
    let cable = (0.0..2.0 * PI, -0.6..0.6_f64, 0.004..0.009_f64, 0.5..1.4_f64, 0.01..0.04_f64);
    let rest = (proptest::bool::ANY, -4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64);
    (2..12_usize, proptest::collection::vec(cable, 1..3), rest).prop_map(
        |(sections, cables, (is_bent, x, y, z))| {
            let mut backbone = backbone();
            if is_bent {
                backbone.rest_curvature = RestCurvature::Uniform(Vec3::new(x, y, z));
            }
            let (mut list, mut shortenings) = (Vec::new(), Vec::new());
            for (i, (start_angle, turns, radius, end, part)) in cables.into_iter().enumerate() {
                let routing = Routing::Helix { start_angle, turns, radius };
                let mut cable = Cable::new(format!("cable {i}"), routing);
                cable.ends_at = (end < 1.0).then_some(end * LENGTH);
                list.push(cable);
                shortenings.push(part * LENGTH * end.min(1.0));
            }
            let disks = Disks::equally_spaced(LENGTH, sections + 1, 0.009);
            (Robot::new(backbone, disks, list).unwrap(), shortenings)
        },
    )
}

/// The lengths are met by the method of multipliers in the coordinates of the chord, or by Newton's method in bends and twist.
#[test]
fn two_methods_meet_lengths_with_the_same_shape_and_tensions() {
    for chord in [Chord::Bisector, Chord::Arc] {
        let mut compared = 0;
        for (robot, shortenings) in samples(robots(), 200) {
            let given: Vec<_> = shortenings.iter().map(|&s| Shortening::Length(s)).collect();
            let case = Case::with_shortenings(&given);
            let model = FourBar::new(&robot, &free(chord)).unwrap();
            let mut workspace = Workspace::default();
            // Lengths that contradict each other have no shape.
            let Ok(by_multipliers) = model.solve(&case, None, &mut workspace) else { continue };
            // From a part of the way: arcs may have several shapes of the same lengths.
            let near: Vec<_> = shortenings.iter().map(|s| Shortening::Length(0.98 * s)).collect();
            let near = Case::with_shortenings(&near);
            let Ok(near) = model.solve(&near, None, &mut workspace) else { continue };
            let by_newton = model.solve_and_linearize(&case, Some(&near), &[], &mut workspace);
            let Ok((by_newton, _)) = by_newton else { continue };
            compared += 1;
            let apart = by_newton.disks.distances(&by_multipliers.disks).fold(0.0, f64::max);
            assert!(apart < 1e-6 * LENGTH, "{chord}: {apart:e}\n{robot:?}\n{shortenings:?}");
            for (a, b) in by_newton.cables.iter().zip(&by_multipliers.cables) {
                assert!((a.length - b.length).abs() < 1e-7 * LENGTH, "{a:?} {b:?}");
                assert!((a.initial_length - b.initial_length).abs() < 1e-13);
                let (a, b) = (a.tension.unwrap(), b.tension.unwrap());
                assert!((a - b).abs() < 1e-4 * (1.0 + b), "{a} {b}");
            }
            assert_eq!(by_newton.diagnostics.stable, by_multipliers.diagnostics.stable);
        }
        assert!(compared > 150, "{chord}: {compared}");
    }
}

/// `F (L³/3EI)(1 − 1/4n²)`: each of n sections turns about its middle.
#[test]
fn a_small_force_bends_it_like_a_cantilever() {
    for sections in [1, 2, 5, 10] {
        let disks = Disks::equally_spaced(LENGTH, sections + 1, 0.008);
        let robot = Robot::new(backbone(), disks, vec![]).unwrap();
        let unit = bending_stiffness() / LENGTH.powi(2);
        let loads = Loads { tip_force: Vec3::X * (1e-4 * unit), ..Loads::default() };
        let case = Case { loads, ..Case::default() };
        for chord in [Chord::Bisector, Chord::Arc] {
            let answer = solve(&robot, &free(chord), &case).unwrap();
            let exact = 1e-4 * LENGTH / 3.0 * (1.0 - 0.25 / (sections * sections) as f64);
            let tip = answer.disks.tip().position.x;
            assert!((tip / exact - 1.0).abs() < 1e-6, "{sections} {chord}: {tip} {exact}");
            let base = answer.base_wrench.unwrap();
            assert!((base.force - case.loads.tip_force).norm() < 1e-12 * unit);
        }
    }
}

/// The error of arcs falls with the square of the disk spacing to that of an inextensible, unshearable rod, whose cables are
/// continuous.
#[test]
fn loads_bend_it_like_the_rod() {
    let stiff = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: [2.0e-3, 1.5e-3].into(),
        torsion: 1.2e-3.into(),
    };
    let backbone = Backbone {
        stiffness: Some(stiff),
        extensible: false,
        shearable: false,
        ..Backbone::new(LENGTH)
    };
    let robot = |sections: usize| {
        let disks = Disks::equally_spaced(LENGTH, sections + 1, 0.008);
        let helix = Routing::Helix { start_angle: 0.4, turns: 0.4, radius: 0.008 };
        let mut cables = vec![Cable::new("a", helix)];
        let straight = Routing::Straight { angle: 2.0, radius: 0.006 };
        cables.push(Cable { ends_at: Some(0.1), ..Cable::new("b", straight) });
        Robot::new(backbone.clone(), disks, cables).unwrap()
    };
    let loads = Loads {
        tip_force: Vec3::new(0.02, 0.05, -0.03),
        tip_moment: Vec3::new(0.0, 2e-3, 1e-3),
        tip_follower: true,
        ..Loads::default()
    };
    let case = Case { loads, ..Case::with_tensions(&[0.4, 0.3]) };
    let rod = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
    let rod = rod.with_tolerance(1e-9).solve(&robot(60), &case).unwrap().disks.tip().position;
    let error = |sections: usize| {
        let answer = solve(&robot(sections), &free(Chord::Arc), &case).unwrap();
        (answer.disks.tip().position - rod).norm() / LENGTH
    };
    let errors = [12, 24, 48].map(error);
    assert!(errors[0] < 5e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((2.8..6.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// A drive of this stiffness gives way by its tension.
#[test]
fn elastic_cables_stretch() {
    let routing = Routing::Straight { angle: 0.3, radius: 0.008 };
    let elastic = Cable { axial_stiffness: Some(400.0), ..Cable::new("pull", routing.clone()) };
    let disks = Disks::equally_spaced(LENGTH, 10, 0.008);
    let robot = Robot::new(backbone(), disks.clone(), vec![elastic]).unwrap();
    let stiff = Robot::new(backbone(), disks, vec![Cable::new("pull", routing)]).unwrap();
    let case = Case::with_shortenings(&[Shortening::Length(0.006)]);
    let options = free(Chord::Bisector);
    let answer = solve(&robot, &options, &case).unwrap();
    let cable = &answer.cables[0];
    let stretch = cable.tension.unwrap() * LENGTH / 400.0;
    assert!((LENGTH - cable.length - (0.006 - stretch)).abs() < 1e-9 && stretch > 1e-4);
    // The cable of the same length that does not stretch has the same shape.
    let shorter = Case::with_shortenings(&[Shortening::Length(LENGTH - cable.length)]);
    let rigid = solve(&stiff, &options, &shorter).unwrap();
    let apart = rigid.disks.distances(&answer.disks).fold(0.0, f64::max);
    assert!(apart < 1e-8 * LENGTH, "{apart:e}");
    assert!((rigid.cables[0].tension.unwrap() / cable.tension.unwrap() - 1.0).abs() < 1e-6);
}

/// By nature the shortening counts, the tension of a cable that has none, and either where it is asked for.
#[test]
fn each_cable_has_its_command() {
    let cables = [0.0, PI]
        .map(|angle| Cable::new(format!("{angle}"), Routing::Straight { angle, radius: 0.008 }));
    let disks = Disks::equally_spaced(LENGTH, 10, 0.008);
    let robot = Robot::new(backbone(), disks, cables.to_vec()).unwrap();
    let shortening = Some(Shortening::Length(0.005));
    let commands = vec![
        CableCommand { tension: Some(9.0), shortening },
        CableCommand { tension: Some(1.0), shortening: None },
    ];
    let case = Case { commands, ..Case::default() };
    let of = |actuation: Actuation| {
        solve(&robot, &Options { actuation, ..free(Chord::Bisector) }, &case)
    };
    let natural = of(Actuation::Natural).unwrap();
    assert!((LENGTH - natural.cables[0].length - 0.005).abs() < 1e-9);
    assert_eq!(natural.cables[1].tension, Some(1.0));
    // Both pull the backbone together and only their difference bends it.
    let held = natural.cables[0].tension.unwrap();
    let tensions = Case::with_tensions(&[held, 1.0]);
    let pulled = solve(&robot, &free(Chord::Bisector), &tensions).unwrap();
    assert!((pulled.disks.tip().position - natural.disks.tip().position).norm() < 1e-8);
    assert_eq!(of(Actuation::Tension).unwrap().cables[0].tension, Some(9.0));
    let missing = of(Actuation::Shortening).unwrap_err().to_string();
    assert!(missing.contains("`shortening` of cable 2"), "{missing}");
}
