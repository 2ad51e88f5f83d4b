//! Spans that one cable beside the backbone bends by more than a right angle, against an integration in the plane.

use whipcord::{
    Backbone, Cable, Case, Disks, Model, ModelKind, Robot, Routing, Statics as _, Stations,
    Stiffness,
};

use crate::common::model_with_forces;

/// Distance of the cable from the backbone, whose length and bending stiffness are 1.
const RADIUS: f64 = 0.055;

fn robot() -> Robot {
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: [1.0, 1.0].into(),
        torsion: 0.8.into(),
    };
    let backbone = Backbone {
        stiffness: Some(stiffness),
        extensible: false,
        shearable: false,
        ..Backbone::new(1.0)
    };
    let cable = Cable::new("cable", Routing::Straight { angle: 0.0, radius: RADIUS });
    Robot::new(backbone, Disks::equally_spaced(1.0, 2, 0.06), vec![cable]).unwrap()
}

/// Where the backbone ends, across and along, and its angle there, under a cable of this tension whose chord has this angle.
fn shot(tension: f64, chord: f64) -> [f64; 3] {
    const STEPS: usize = 400;
    let pull = [-tension * chord.sin(), -tension * chord.cos()];
    // The force in the backbone acts along the cable.
    let rate = |[x, z, angle]: [f64; 3]| {
        let (sin, cos) = angle.sin_cos();
        [sin, cos, -z * pull[0] - (RADIUS - x) * pull[1]]
    };
    let h = 1.0 / STEPS as f64;
    let mut here = [0.0; 3];
    for _ in 0..STEPS {
        let ahead = |by: f64, k: [f64; 3]| core::array::from_fn(|i| here[i] + by * k[i]);
        let first = rate(here);
        let second = rate(ahead(0.5 * h, first));
        let third = rate(ahead(0.5 * h, second));
        let fourth = rate(ahead(h, third));
        here = core::array::from_fn(|i| {
            here[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i])
        });
    }
    here
}

/// The end of the backbone under a tension that is raised from nothing in small steps.
fn raised(tension: f64) -> [f64; 3] {
    const STEPS: usize = 400;
    // How far the hole at the end is beside the chord.
    let beside = |tension: f64, chord: f64| {
        let [x, z, angle] = shot(tension, chord);
        let hole = [x + RADIUS * angle.cos(), z - RADIUS * angle.sin()];
        (hole[0] - RADIUS) * chord.cos() - hole[1] * chord.sin()
    };
    let mut chord = 0.0;
    for step in 1..=STEPS {
        let tension = tension * step as f64 / STEPS as f64;
        for _ in 0..8 {
            let slope = (beside(tension, chord + 1e-6) - beside(tension, chord - 1e-6)) / 2e-6;
            chord -= beside(tension, chord) / slope;
        }
    }
    assert!(beside(tension, chord).abs() < 1e-9);
    shot(tension, chord)
}

/// Beyond `π² EI/ℓ²` a span that is bent to the other side is in equilibrium, too.
#[test]
fn a_span_that_is_pulled_at_once_is_bent_as_one_that_is_pulled_slowly() {
    let robot = robot();
    for tension in [5.0, 9.0, 12.0] {
        let [x, z, _] = raised(tension);
        for stations in [2, 5, 13] {
            let kind = ModelKind::CosseratDisks;
            let model: Model =
                model_with_forces(kind, Stations::Equal(stations), whipcord::Actuation::Tension);
            let solution = model.solve(&robot, &Case::with_tensions(&[tension])).unwrap();
            let diagnostics = &solution.diagnostics;
            assert_eq!(diagnostics.stable, Some(true), "{tension} {stations}");
            assert_eq!(diagnostics.stability_lost_at, None);
            let end = solution.disks.tip();
            let off = (end.position.x - x).abs() + (end.position.z - z).abs();
            assert!(off < 1e-5 && end.position.y.abs() < 1e-9, "{tension} {stations}: {off}");
        }
    }
}
