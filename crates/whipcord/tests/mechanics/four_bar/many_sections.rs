//! With many sections the strain-energy form is the rod that neither stretches nor shears: shapes and
//! tensions of antagonists and of three cables, straight and helical.

use core::f64::consts::TAU;

use whipcord::four_bar::{Chord, LengthRule, Objective, Options};
use whipcord::{
    Backbone, Cable, Case, Model, ModelKind, Robot, Routing, Shortening, Solution, Statics, Vec3,
};

use super::{equal_disks, robot, solve};

const LENGTH: f64 = 0.18;
const RADIUS: f64 = 0.008;
/// EI of [`robot`].
const STIFFNESS: f64 = 1.1e9 * core::f64::consts::PI * 0.003 * 0.003 * 0.003 * 0.003 / 64.0;

/// Cables at equal angles.
fn around(count: usize, turns: f64) -> Vec<Routing> {
    let routing = |k: usize| {
        let angle = 0.2 + TAU * k as f64 / count as f64;
        if turns == 0.0 {
            Routing::Straight { angle, radius: RADIUS }
        } else {
            Routing::Helix { start_angle: angle, turns, radius: RADIUS }
        }
    };
    (0..count).map(routing).collect()
}

fn rigid(sections: usize, routings: &[Routing]) -> Robot {
    let soft = robot(&equal_disks(LENGTH, sections), routings.to_vec());
    let backbone = Backbone { extensible: false, shearable: false, ..soft.backbone().clone() };
    Robot::new(backbone, soft.disks().clone(), soft.cables().to_vec()).unwrap()
}

fn options() -> Options {
    Options {
        chord: Chord::Arc,
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        ..Options::default()
    }
}

/// The rod under these tensions, and the sections with the lengths that it gives the cables; those without
/// tension are paid out by 2 mm more. The greatest distance of a disk, relative to the length, and of a tension, relative to
/// the greatest.
fn apart(sections: usize, routings: &[Routing], tensions: &[f64]) -> (f64, f64) {
    let robot = rigid(sections, routings);
    let rod = Model::new(ModelKind::Cosserat, Default::default(), whipcord::Actuation::Tension)
        .solve(&robot, &Case::with_tensions(tensions))
        .unwrap();
    let shortenings: Vec<f64> = rod
        .cables
        .iter()
        .zip(tensions)
        .map(|(cable, &tension)| {
            let play = if tension > 0.0 { 0.0 } else { 0.002 };
            cable.initial_length - cable.length - play
        })
        .collect();
    let found = solve(&robot, &options(), &shortenings);
    let shape = found.disks.distances(&rod.disks).fold(0.0, f64::max) / LENGTH;
    let most = tensions.iter().copied().fold(0.0, f64::max);
    let misses = found.cables.iter().zip(tensions);
    let tension = misses.map(|(cable, tension)| (cable.tension.unwrap() - tension).abs() / most);
    (shape, tension.fold(0.0, f64::max))
}

/// Tensions within 2 % and shapes within 0.2 % of the length at 40 sections, both with order 2.
#[test]
fn antagonists_and_three_cables_are_the_rod_with_its_tensions() {
    for turns in [0.0, 0.4, -0.75] {
        for (count, tensions) in
            [(2, &[6.0, 0.0][..]), (2, &[0.0, 3.0]), (3, &[4.0, 2.0, 0.0]), (3, &[0.0, 0.0, 5.0])]
        {
            let routings = around(count, turns);
            let (coarse, fine) = (apart(20, &routings, tensions), apart(40, &routings, tensions));
            assert!(fine.0 < 2e-3 && fine.1 < 0.02, "{turns} {tensions:?}: {fine:?}");
            let orders = [(coarse.0, fine.0), (coarse.1, fine.1)].map(|(c, f)| (c / f).log2());
            assert!(
                orders.iter().all(|order| (1.7..2.3).contains(order)),
                "{turns} {tensions:?}: orders {orders:?}, {coarse:?}, {fine:?}"
            );
        }
    }
}

/// A straight cable that is fastened between two disks bends its section, of length l, by φ to the circle whose
/// part `t` it spans: its length there is `2(l/φ − a) sin(tφ/2)`.
#[test]
fn a_cable_that_ends_between_two_disks_spans_a_part_of_the_arc() {
    let length = 0.02;
    for part in [0.25, 0.6, 0.9] {
        let soft = robot(&[0.0, length], vec![Routing::Straight { angle: 0.0, radius: RADIUS }]);
        let cable = Cable { ends_at: Some(part * length), ..soft.cables()[0].clone() };
        let robot = Robot::new(soft.backbone().clone(), soft.disks().clone(), vec![cable]).unwrap();
        let bend = 0.6;
        let spanned = 2.0 * (length / bend - RADIUS) * (0.5 * part * bend).sin();
        for objective in [Objective::CouplerAngle, Objective::StrainEnergy] {
            for lengths in [LengthRule::Proportional, LengthRule::Free] {
                let options = Options { objective, lengths, ..options() };
                let found = solve(&robot, &options, &[part * length - spanned]);
                let (angle, direction) = found.disks.bend();
                assert!((angle - bend).abs() < 1e-9 && direction.abs() < 1e-9, "{angle}");
                assert!((found.cables[0].initial_length - part * length).abs() < 1e-15);
            }
        }
    }
}

/// With many sections such a cable bends the robot as it does the rod, wherever it is fastened.
#[test]
fn a_cable_that_ends_anywhere_bends_as_the_rod() {
    for turns in [0.0, 0.4] {
        let routing = around(1, turns).remove(0);
        let ended = |sections: usize| {
            let whole = rigid(sections, core::slice::from_ref(&routing));
            let cable = Cable { ends_at: Some(0.1217), ..whole.cables()[0].clone() };
            Robot::new(whole.backbone().clone(), whole.disks().clone(), vec![cable]).unwrap()
        };
        let apart = |sections: usize| {
            let robot = ended(sections);
            let rod =
                Model::new(ModelKind::Cosserat, Default::default(), whipcord::Actuation::Tension)
                    .solve(&robot, &Case::with_tensions(&[5.0]))
                    .unwrap();
            let shortening = rod.cables[0].initial_length - rod.cables[0].length;
            let found = solve(&robot, &options(), &[shortening]);
            assert!((found.cables[0].tension.unwrap() / 5.0 - 1.0).abs() < 0.02);
            found.disks.distances(&rod.disks).fold(0.0, f64::max) / LENGTH
        };
        assert!(apart(40) < 3e-3 && apart(80) < 1e-3, "{} {}", apart(40), apart(80));
    }
}

/// Straight cables bend a rod to a circle of curvature `Σ τᵢ (eᵢ × z) r/EI`: the sections lie on it.
#[test]
fn straight_cables_bend_to_constant_curvature() {
    let tensions = [4.0, 2.0, 0.0];
    let routings = around(3, 0.0);
    let curvature = tensions.iter().enumerate().fold(Vec3::ZERO, |sum, (k, tension)| {
        let (sin, cos) = (0.2 + TAU * k as f64 / 3.0).sin_cos();
        // A cable at +x bends towards +x, about +y.
        sum + Vec3::new(-sin, cos, 0.0) * (tension * RADIUS / STIFFNESS)
    });
    let circle = |s: f64| {
        let (bend, axis) = (curvature.norm(), curvature / curvature.norm());
        let towards = axis.cross(Vec3::Z);
        let (sin, cos) = (bend * s).sin_cos();
        (towards * (1.0 - cos) + Vec3::Z * sin) / bend
    };
    let apart = |sections: usize| {
        let robot = rigid(sections, &routings);
        // On a circle each cable gets shorter by what it is nearer to the centre.
        let shortenings: Vec<f64> = (0..3)
            .map(|k| {
                let (sin, cos) = (0.2 + TAU * f64::from(k) / 3.0).sin_cos();
                let nearer = Vec3::new(-sin, cos, 0.0).dot(curvature) * RADIUS * LENGTH;
                if k == 2 { nearer - 0.002 } else { nearer }
            })
            .collect();
        let found: Solution = solve(&robot, &options(), &shortenings);
        let s = &found.disks.arc_length;
        let off = s.iter().zip(&found.disks.poses).map(|(&s, p)| (p.position - circle(s)).norm());
        off.fold(0.0, f64::max) / LENGTH
    };
    let (coarse, fine) = (apart(20), apart(40));
    assert!(fine < 1e-3, "{fine}");
    let order = (coarse / fine).log2();
    assert!((1.8..2.2).contains(&order), "{order}");
    // And the length rule that shares alike gives the same circle, for all sections are alike.
    let alike = Options { lengths: LengthRule::Proportional, ..options() };
    let case = [Shortening::Length(0.004); 1].map(|s| s.in_metres(LENGTH));
    let robot = rigid(9, &around(1, 0.0));
    let [a, b] = [alike, options()].map(|options| solve(&robot, &options, &case));
    assert!(a.disks.rms_distance(&b.disks) < 1e-9 * LENGTH);
}
