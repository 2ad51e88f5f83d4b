//! Cable lengths that contradict one another, and by how much.

use core::f64::consts::PI;

use crate::common::{paper_backbone, paper_disks, solve_with};
use whipcord::cosserat::Options;
use whipcord::cosserat_disks::Options as DisksOptions;
use whipcord::{
    Backbone, Cable, CableCommand, Case, LengthMiss, Model, Robot, Routing, Shortening, SolveError,
    Statics, Stiffness, Vec3,
};

/// Straight cables at these angles in degrees and radii in mm, on the paper's rod; `a`, `b`, …
fn with_cables(backbone: Backbone, places: &[(f64, f64)]) -> Robot {
    let cable = |(&(angle, radius), name): (&(f64, f64), char)| {
        let routing = Routing::Straight { angle: angle.to_radians(), radius: radius * 1e-3 };
        Cable::new(name.to_string(), routing)
    };
    let cables = places.iter().zip('a'..).map(cable).collect();
    Robot::new(backbone, paper_disks(), cables).unwrap()
}

fn inextensible() -> Backbone {
    Backbone { extensible: false, ..paper_backbone() }
}

fn shortened_by(metres: &[f64]) -> Case {
    let command =
        |&m: &f64| CableCommand { tension: None, shortening: Some(Shortening::Length(m)) };
    Case { commands: metres.iter().map(command).collect(), ..Case::default() }
}

fn misses(error: SolveError) -> Vec<LengthMiss> {
    match error {
        SolveError::ContradictoryLengths { misses } => misses,
        other => panic!("{other}"),
    }
}

fn contradiction(robot: &Robot, case: &Case) -> Vec<LengthMiss> {
    misses(solve_with(Options::default(), robot, case).unwrap_err())
}

/// The misses in mm are these, to a millionth.
fn are(found: &[LengthMiss], expected: &[(&str, f64)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (miss, &(cable, excess)) in found.iter().zip(expected) {
        assert_eq!(miss.cable, cable);
        assert!((miss.excess * 1e3 / excess - 1.0).abs() < 1e-6, "{found:?}, {expected:?}");
    }
}

/// On a rod that does not get shorter straight cables at ±r have the lengths L(1 ∓ κ r), of which the sum
/// is 2L: shortened by a and b with a + b > 0 the least squares miss each by (a + b)/2.
#[test]
fn antagonists_miss_half_of_what_they_are_shortened_by_in_all() {
    let pair = with_cables(inextensible(), &[(0.0, 8.0), (180.0, 8.0)]);
    for (a, b) in [(3.0, 1.0), (3.0, -1.0), (0.5, 0.5), (120.0, 100.0)] {
        let found = contradiction(&pair, &shortened_by(&[a * 1e-3, b * 1e-3]));
        are(&found, &[("a", 0.5 * (a + b)), ("b", 0.5 * (a + b))]);
    }
    assert!(solve_with(Options::default(), &pair, &shortened_by(&[0.003, -0.003])).is_ok());
}

/// With the offsets rᵢ of straight cables any weights with Σ wᵢ rᵢ = 0 bind their lengths,
/// Σ wᵢ ℓᵢ = L Σ wᵢ. The least squares that meet shortenings aᵢ miss by eᵢ = wᵢ (w·a)/(w·w).
#[test]
fn three_cables_share_a_contradiction_by_their_levers() {
    let places = [(0.0, 8.0), (120.0, 8.0), (240.0, 4.0)];
    let robot = with_cables(inextensible(), &places);
    let (weights, shortened) = ([1.0, 1.0, 2.0], [1.0, 2.0, 0.5]);
    let lacks: f64 = weights.iter().zip(shortened).map(|(w, a)| w * a).sum();
    let squares: f64 = weights.iter().map(|w| w * w).sum();
    let of = |i: usize| weights[i] * lacks / squares;
    let found = contradiction(&robot, &shortened_by(&shortened.map(|a| a * 1e-3)));
    are(&found, &[("a", of(0)), ("b", of(1)), ("c", of(2))]);
}

/// Two cables beside the pair can have their lengths, and are not named.
#[test]
fn cables_that_take_no_part_are_not_named() {
    let places = [(0.0, 8.0), (90.0, 8.0), (180.0, 8.0), (270.0, 8.0)];
    let robot = with_cables(inextensible(), &places);
    let found = contradiction(&robot, &shortened_by(&[0.003, 0.002, 0.001, -0.002]));
    are(&found, &[("a", 2.0), ("c", 2.0)]);
}

/// A cable that is pulled with a given tension gives way.
#[test]
fn an_antagonist_driven_by_its_tension_contradicts_nothing() {
    let pair = with_cables(inextensible(), &[(0.0, 8.0), (180.0, 8.0)]);
    let mut case = shortened_by(&[0.003, 0.001]);
    case.commands[1] = CableCommand { tension: Some(2.0), shortening: None };
    assert!(solve_with(Options::default(), &pair, &case).is_ok());
}

/// A rod that gives has an answer, at tensions that press it together; the stiffer it is, the greater
/// they are.
#[test]
fn a_backbone_that_gives_takes_them_by_getting_shorter() {
    let places = [(0.0, 8.0), (180.0, 8.0)];
    let bending = 4.4e-3;
    for axial in [1e4, 1e6, 1e8] {
        let stiffness = Stiffness::Diagonal {
            shear: Some([axial / 3.0; 2].into()),
            axial: Some(axial.into()),
            bending: [bending; 2].into(),
            torsion: bending.into(),
        };
        let backbone = Backbone {
            stiffness: Some(stiffness),
            material: Default::default(),
            ..paper_backbone()
        };
        let robot = with_cables(backbone, &places);
        let solution =
            solve_with(Options::default(), &robot, &shortened_by(&[0.003, 0.001])).unwrap();
        let pressed: f64 = solution.cables.iter().map(|c| c.tension.unwrap()).sum();
        assert!((pressed / (axial * 0.002 / 0.18) - 1.0).abs() < 1e-4, "{axial}: {pressed}");
    }
}

/// Under load they contradict one another just the same, and with chords between the disks nearly so.
#[test]
fn loads_and_chords_change_nothing_of_it() {
    let pair = with_cables(inextensible(), &[(0.0, 8.0), (180.0, 8.0)]);
    let mut case = shortened_by(&[0.003, 0.001]);
    let disks = Model::CosseratDisks(DisksOptions::default());
    let by_chords = misses(disks.solve(&pair, &case).unwrap_err());
    assert_eq!(by_chords.len(), 2);
    for miss in &by_chords {
        assert!((miss.excess / 0.002 - 1.0).abs() < 0.01, "{by_chords:?}");
    }
    case.loads.tip_force = Vec3::new(0.1, 0.0, -0.05);
    are(&contradiction(&pair, &case), &[("a", 2.0), ("b", 2.0)]);
}

/// Whatever the course of a cable and its antagonist: with what the error says each is too long by given
/// back, the lengths can be had; with a twentieth less, they cannot.
#[test]
fn what_each_cable_would_have_to_give_is_enough_and_no_more() {
    let helix = |start: f64, turns, radius| Routing::Helix { start_angle: start, turns, radius };
    let polynomial =
        |f: f64| Routing::Polynomial { x: vec![0.008 * f, 0.0, -0.2 * f], y: vec![0.0, 0.03 * f] };
    let linear = |f: f64| Routing::Linear { start: [0.008 * f, 0.0], end: [0.002 * f, 0.003 * f] };
    let beside = Routing::Straight { angle: 1.2, radius: 0.007 };
    let pairs = [
        [helix(0.3, 0.5, 0.008), helix(0.3 + PI, 0.5, 0.005)],
        [helix(1.0, -1.5, 0.006), helix(1.0 + PI, -1.5, 0.008)],
        [polynomial(1.0), polynomial(-0.7)],
        [linear(1.0), linear(-1.0)],
    ];
    for (i, [pull, against]) in pairs.into_iter().enumerate() {
        let cable = |(routing, name): (Routing, char)| Cable::new(name.to_string(), routing);
        let cables = [pull, against, beside.clone()].into_iter().zip('a'..).map(cable).collect();
        let robot = Robot::new(inextensible(), paper_disks(), cables).unwrap();
        let solve = |metres: &[f64]| solve_with(Options::default(), &robot, &shortened_by(metres));
        // The twist of a backbone unwinds helices at no cost in bending: more than that brings.
        let rest = solve_with(Options::default(), &robot, &Case::with_tensions(&[0.0; 3])).unwrap();
        let wound = |cable: usize| rest.cables[cable].initial_length - 0.18;
        let asked = [wound(0) + 0.004, wound(1) + 0.001 * i as f64, 0.002];
        let misses = misses(solve(&asked).unwrap_err());
        let named: Vec<&str> = misses.iter().map(|miss| miss.cable.as_str()).collect();
        assert_eq!(named, ["a", "b"], "{misses:?}");
        let given_back = |share: f64| {
            let [a, b] = [share * misses[0].excess, share * misses[1].excess];
            [asked[0] - a, asked[1] - b, asked[2]]
        };
        let less = solve(&given_back(0.95));
        assert!(matches!(less, Err(SolveError::ContradictoryLengths { .. })), "{i}: {less:?}");
        let enough = solve(&given_back(1.001));
        assert!(enough.is_ok(), "{i}: {enough:?}, {misses:?}");
    }
}
