//! Derivatives against central differences, and closed forms against the definitions they stand
//! for.

use whipcord_numerics::{Jet, Pose, UnitQuaternion, Vec3};

use super::bend::Bend;
use super::length::Passage;
use super::measure::Measure;
use super::options::Chord;
use super::plane::Vec2;

const CHORDS: [Chord; 2] = [Chord::Bisector, Chord::Arc];

/// Bends from none to almost half a turn, on both sides of every switch between series and closed
/// form.
fn bends() -> impl Iterator<Item = Bend> {
    let sizes = [0.0, 1e-7, 0.03, 0.19, 0.21, 0.6, 0.97];
    let twists = [0.0, 1e-6, -0.2, 0.41, 1.3, -2.5];
    sizes.into_iter().flat_map(move |r| {
        twists.into_iter().enumerate().map(move |(k, twist)| {
            let angle = 0.7 + 1.9 * k as f64;
            Bend { p: Vec2::new(r * angle.cos(), r * angle.sin()), twist }
        })
    })
}

fn check(name: &str, bend: Bend, f: impl Fn(Bend) -> Jet) {
    let h = 1e-5;
    let jet = f(bend);
    for i in 0..3 {
        let mut step = Vec3::ZERO;
        step[i] = h;
        let (up, down) = (f(bend.moved(step)), f(bend.moved(-step)));
        let slope = (up.value - down.value) / (2.0 * h);
        let scale = 1.0 + jet.gradient.max_abs();
        assert!((slope - jet.gradient[i]).abs() < 1e-7 * scale, "{name} {bend:?} ∂{i}");
        let row = (up.gradient - down.gradient) / (2.0 * h);
        let hessian = jet.hessian.to_mat3();
        let scale = 1.0 + hessian.rows.iter().map(|r| r.max_abs()).fold(0.0, f64::max);
        let error = (row - hessian.rows[i]).max_abs();
        assert!(error < 1e-6 * scale, "{name} {bend:?} ∂²{i}: {row:?} {:?}", hessian.rows[i]);
    }
}

#[test]
fn gradients_and_hessians_match_differences() {
    let measures = [
        Measure::CouplerAngle(vec![Vec2::new(0.6, 0.8)]),
        Measure::CouplerAngle(vec![Vec2::X, Vec2::new(-0.28, 0.96), Vec2::new(0.8, -0.6)]),
        Measure::StrainEnergy([1.0, 1.7, 0.8]),
    ];
    let passages = [
        Passage::new(0, 1.0, Vec2::new(0.4, 0.0), Vec2::new(0.4, 0.0), 1.0),
        Passage::new(0, 1.0, Vec2::new(0.3, -0.2), Vec2::new(-0.1, 0.5), 1.0),
    ];
    for bend in bends() {
        for measure in &measures {
            check("measure", bend, |b| measure.at(&b.turn()));
        }
        for passage in &passages {
            for chord in CHORDS {
                check("half square", bend, |b| passage.half_square(&b.turn(), 1.0, chord));
                check("length", bend, |b| passage.length(&b.turn(), 1.0, chord));
                let only = passage.length_only(&bend.turn(), 1.0, chord);
                let full = passage.length(&bend.turn(), 1.0, chord).value;
                assert!((only - full).abs() < 1e-15);
            }
        }
    }
}

fn angle(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

#[test]
fn closed_forms_are_what_the_definitions_say() {
    let passage = Passage::new(0, 1.0, Vec2::new(0.3, -0.2), Vec2::new(-0.1, 0.5), 1.0);
    let (from, to) = (passage.from.with(0.0), passage.to.with(0.0));
    let e = Vec3::new(0.6, 0.8, 0.0);
    for bend in bends() {
        for chord in CHORDS {
            let Pose { position, rotation } = bend.pose(1.0, chord);
            let normal = rotation.rotate(Vec3::Z);
            let phi = angle(Vec3::Z, normal);
            let reach = match chord {
                Chord::Bisector => 1.0,
                Chord::Arc if phi < 1e-6 => 1.0,
                Chord::Arc => f64::sin(0.5 * phi) / (0.5 * phi),
            };
            let bisector = Vec3::Z + normal;
            let expected = bisector * (reach / bisector.norm());
            assert!((position - expected).max_abs() < 1e-13, "{bend:?}");
            let cable = position + rotation.rotate(to) - from;
            assert!((cable.norm() - passage.length(&bend.turn(), 1.0, chord).value).abs() < 1e-14);
        }
        let rotation = bend.pose(1.0, Chord::Bisector).rotation;
        let coupler = |a: Vec3| angle(a, rotation.rotate(a)).powi(2);
        let sum = coupler(e) + coupler(Vec3::new(e.y, -e.x, 0.0));
        let measure = Measure::CouplerAngle(vec![Vec2::new(e.x, e.y)]);
        assert!((measure.at(&bend.turn()).value - sum).abs() < 1e-12, "{bend:?}");
        let w = rotation.log();
        let energy = w.x * w.x + 1.7 * w.y * w.y + 0.8 * w.z * w.z;
        let measure = Measure::StrainEnergy([1.0, 1.7, 0.8]);
        assert!((measure.at(&bend.turn()).value - energy).abs() < 1e-12, "{bend:?}");
    }
}

#[test]
fn stations_in_a_section_lie_on_a_circular_arc_between_the_disks() {
    for bend in bends() {
        let end = bend.pose_at(1.0, 0.7, Chord::Arc);
        let disk = bend.pose(0.7, Chord::Arc);
        assert!((end.position - disk.position).max_abs() < 1e-14, "{bend:?}");
        let apart: UnitQuaternion = end.rotation.conjugate() * disk.rotation;
        assert!(apart.log().max_abs() < 1e-14, "{bend:?}");
        let start = bend.pose_at(0.0, 0.7, Chord::Arc);
        assert!(start.position.max_abs() == 0.0 && start.rotation.log().max_abs() < 1e-16);
        // Unit speed along the tangent, and equal turns in equal parts.
        let h = 1e-5;
        let turns: Vec<f64> = [0.2, 0.5, 0.9]
            .into_iter()
            .map(|t| {
                let (a, b) =
                    (bend.pose_at(t - h, 0.7, Chord::Arc), bend.pose_at(t + h, 0.7, Chord::Arc));
                let velocity = (b.position - a.position) / (2.0 * h * 0.7);
                let tangent = bend.pose_at(t, 0.7, Chord::Arc).rotation.rotate(Vec3::Z);
                assert!((velocity - tangent).max_abs() < 1e-9, "{bend:?} {t}");
                angle(a.rotation.rotate(Vec3::Z), b.rotation.rotate(Vec3::Z))
            })
            .collect();
        assert!((turns[0] - turns[1]).abs() < 1e-12 && (turns[1] - turns[2]).abs() < 1e-12);
    }
}
