//! Against closed forms: a rod with one straight cable that neither stretches nor shears is an arc of a circle.

use std::f64::consts::PI;

use whipcord::{Backbone, Cable, Cancel, Disks, Material, ModelKind, Routing, Section};

use super::candidate::Preset;
use super::*;

const LENGTH: f64 = 0.18;
const RADIUS: f64 = 0.008;
const SECTIONS: usize = 9;
const TENSION: f64 = 3.0;

/// One straight cable at x = r.
fn arc() -> (Robot, Case) {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Default::default()
        },
        extensible: false,
        shearable: false,
        ..Backbone::new(LENGTH)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: RADIUS });
    let disks = Disks::equally_spaced(LENGTH, SECTIONS + 1, RADIUS);
    let robot = Robot::new(backbone, disks, vec![cable]).unwrap();
    (robot, Case::with_tensions(&[TENSION]))
}

/// θ = τrL/EI.
fn angle() -> f64 {
    TENSION * RADIUS * LENGTH / (1.1e9 * PI * 0.003_f64.powi(4) / 64.0)
}

/// Where disk k of an arc of this angle is.
fn disk(angle: f64, k: usize) -> [f64; 2] {
    let (radius, part) = (LENGTH / angle, angle * k as f64 / SECTIONS as f64);
    [radius * (1.0 - part.cos()), radius * part.sin()]
}

/// RMS over the disks without the base, greatest, and of the tip.
fn residual(distance: impl Fn(usize) -> f64) -> [f64; 3] {
    let distances: Vec<f64> = (1..=SECTIONS).map(distance).collect();
    let squares: f64 = distances.iter().map(|d| d * d).sum();
    let greatest = distances.iter().copied().fold(0.0, f64::max);
    [(squares / SECTIONS as f64).sqrt(), greatest, distances[SECTIONS - 1]]
}

fn apart([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}

fn tried(kinds: &[ModelKind], choice: Choice) -> CaseBenchmark {
    let (robot, case) = arc();
    let subject = Subject {
        title: "arc",
        stem: "arc",
        robot: &robot,
        case: &case,
        measured: None,
        tags: None,
        known: &[],
    };
    CaseBenchmark::new(
        &subject,
        &Candidate::of(kinds),
        choice,
        timing::budget(1),
        &Cancel::default(),
    )
}

fn is(benchmark: &CaseBenchmark, candidate: Candidate, expected: [f64; 3], bound: f64) {
    let found = benchmark.answer(candidate).unwrap().residual.as_ref().unwrap();
    let found = [found.rms, found.greatest, found.tip.unwrap()];
    for (a, b) in found.into_iter().zip(expected) {
        assert!((a - b).abs() < bound, "{candidate}: {found:?}, not {expected:?}");
    }
}

/// The cable of the arc cut short from hole to hole, 2n(L/θ − r) sin(θ/2n), as the arc that lets it be so long along
/// its whole way: κL = (L − ℓ)/r.
#[test]
fn one_arc_for_another_is_as_far_off_as_the_two_arcs_are_apart() {
    let fine = Choice::Model { kind: ModelKind::Cosserat, fine: true };
    let benchmark = tried(&[ModelKind::ConstantCurvature], fine);
    let (n, theta) = (SECTIONS as f64, angle());
    let length = 2.0 * n * (LENGTH / theta - RADIUS) * (0.5 * theta / n).sin();
    let other = (LENGTH - length) / RADIUS;
    let expected = residual(|k| apart(disk(theta, k), disk(other, k)));
    assert!(expected[2] > 1e-4);
    let arc = Candidate { kind: ModelKind::ConstantCurvature, preset: Preset::Usual };
    is(&benchmark, arc, expected, 1e-10);
    assert!((benchmark.error(arc).unwrap() - expected[0] / LENGTH).abs() < 1e-9);
    let entry = &benchmark.entries[0];
    assert_eq!(entry.commands, Commands::Reference);
    assert!(entry.without_material);
    // The reference is the arc to rounding, and says so.
    let sure = benchmark.reference.as_ref().unwrap().uncertainty.unwrap();
    assert!(sure < 1e-11, "{sure}");
}

/// Its rigid links have equal angles with both disks: each section is bent by φ, where the cable is
/// ℓ/n = l₀ − 2r sin(φ/2) long, and link k points along (k − ½)φ.
#[test]
fn four_bars_for_an_arc_are_as_far_off_as_their_polygon() {
    let fine = Choice::Model { kind: ModelKind::Cosserat, fine: true };
    let benchmark = tried(&[ModelKind::FourBar], fine);
    let (n, theta) = (SECTIONS as f64, angle());
    let link = LENGTH / n;
    let cable = 2.0 * (LENGTH / theta - RADIUS) * (0.5 * theta / n).sin();
    let bend = 2.0 * ((link - cable) / (2.0 * RADIUS)).asin();
    let corner = |k: usize| {
        (1..=k).fold([0.0, 0.0], |[x, z], i| {
            let along = (i as f64 - 0.5) * bend;
            [x + link * along.sin(), z + link * along.cos()]
        })
    };
    let expected = residual(|k| apart(disk(theta, k), corner(k)));
    assert!(expected[2] > 1e-4);
    // A straight cable loses as much in every section, however it is shared out.
    for candidate in Candidate::of(&[ModelKind::FourBar]) {
        is(&benchmark, candidate, expected, 1e-9);
    }
}

#[test]
fn the_reference_is_trusted_with_its_own_model_and_not_with_what_has_no_answer() {
    let benchmark = tried(&[ModelKind::Cosserat], Choice::Trusted);
    // The cable is not given by holes.
    let reference = benchmark.reference.as_ref().unwrap();
    assert_eq!(
        (reference.kind, reference.name.as_str()),
        (Some(ModelKind::Cosserat), "cosserat at fine resolution")
    );
    let usual = Candidate { kind: ModelKind::Cosserat, preset: Preset::Usual };
    is(&benchmark, usual, [0.0; 3], 1e-9);
    assert!(!benchmark.entries[0].without_material);
    // The four-bar model has no shortening to go by, and so nothing is measured against it.
    let choice = Choice::Model { kind: ModelKind::FourBar, fine: false };
    let benchmark = tried(&[ModelKind::Cosserat, ModelKind::FourBar], choice);
    assert!(benchmark.reference.unwrap_err().to_string().contains("shortening"));
    let residual = benchmark.entries[0].outcome.as_ref().unwrap().residual.as_ref();
    assert_eq!(residual.unwrap_err(), "there is no reference");
    // Nor was anything measured.
    let benchmark = tried(&[ModelKind::Cosserat], Choice::Measured);
    assert!(benchmark.reference.unwrap_err().to_string().contains("there is nothing in space"));
}

#[test]
fn holes_ask_for_cables_that_run_straight_between_them() {
    let example = crate::benchmark::paper::table_1().unwrap().remove(2);
    let (robot, case) = (&example.robot, &example.case);
    let subject =
        Subject { title: "III", stem: "iii", robot, case, measured: None, tags: None, known: &[] };
    let reference = ReferenceAnswers::new(&subject, Choice::Trusted, &Cancel::default()).unwrap();
    assert_eq!(reference.kind, Some(ModelKind::CosseratDisks));
    // Cut finely, the difference is none, and the continuous rod is as good.
    let fine = crate::resample::resample(robot, 101).unwrap();
    let subject = Subject { robot: &fine, ..subject };
    let reference = ReferenceAnswers::new(&subject, Choice::Trusted, &Cancel::default()).unwrap();
    assert_eq!(reference.kind, Some(ModelKind::Cosserat));
}

#[test]
fn references_are_read() {
    let choice = |text: &str| text.parse::<Choice>();
    assert_eq!(choice("trusted"), Ok(Choice::Trusted));
    assert_eq!(choice("measured"), Ok(Choice::Measured));
    let disks = Choice::Model { kind: ModelKind::CosseratDisks, fine: true };
    assert_eq!(choice("cosserat-disks:fine"), Ok(disks));
    for (wrong, words) in [
        ("four-bar:fine", "four-bar has no resolution"),
        ("cosserat:coarse", "`:coarse` says nothing"),
        ("cosserrat", "there is no model `cosserrat`"),
    ] {
        let message = choice(wrong).unwrap_err();
        assert!(message.contains(words), "{message}");
    }
}
