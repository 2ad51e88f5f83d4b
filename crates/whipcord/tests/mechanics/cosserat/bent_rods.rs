//! Rods that are bent, wound or tapered at rest, under loads so small that Castigliano's theorem gives
//! their yield in closed form.
//!
//! Half the difference of the answers to a load and to its opposite leaves an error of the third order,
//! which a second, larger load takes away.

use core::f64::consts::{PI, TAU};

use crate::common::{round, solve_finely};
use whipcord::{
    Along, Backbone, Case, Disks, Loads, Pose, RestCurvature, Robot, Section, Stiffness, Vec3,
};

/// EI = 1 about x and this about y, GJ = 0.7, with neither stretch nor shear.
fn wound(length: f64, bending_y: f64, rest_curvature: Vec3) -> Robot {
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: Along::Uniform([1.0, bending_y]),
        torsion: TORSION.into(),
    };
    without_cables(Backbone {
        stiffness: Some(stiffness),
        extensible: false,
        shearable: false,
        rest_curvature: RestCurvature::Uniform(rest_curvature),
        ..Backbone::new(length)
    })
}

const TORSION: f64 = 0.7;

fn without_cables(backbone: Backbone) -> Robot {
    let disks = Disks::equally_spaced(backbone.length, 2, 0.01);
    Robot::new(backbone, disks, vec![]).unwrap()
}

/// Derivative at zero of what of the tip is measured, by the size of a load.
fn slope(robot: &Robot, load: impl Fn(f64) -> Loads, measured: impl Fn(Pose) -> Vec3) -> Vec3 {
    let at = |size: f64| {
        let case = Case { loads: load(size), ..Case::default() };
        measured(solve_finely(robot, &case).shape.tip())
    };
    let half = |size: f64| (at(size) - at(-size)) / (2.0 * size);
    (half(SMALL) * 4.0 - half(2.0 * SMALL)) / 3.0
}

const SMALL: f64 = 1e-3;

fn tip_force(direction: Vec3) -> impl Fn(f64) -> Loads {
    move |size| Loads { tip_force: direction * size, ..Loads::default() }
}

fn assert_near(value: f64, expected: f64, what: &str) {
    let error = (value / expected - 1.0).abs();
    assert!(error < 1e-7, "{what}: {value} is not {expected}, off by {error:.1e}");
}

/// A ring that is cut open, of radius R: ends pulled apart along the ring yield by 3πR³/EI, across it
/// by πR³/EI, and out of its plane by (1/EI + 3/GJ) πR³ (Timoshenko, Strength of Materials II, art. 13
/// and 30).
#[test]
fn a_cut_ring_yields_as_castigliano_has_it() {
    let radius = TAU.recip();
    let ring = wound(1.0, 1.0, Vec3::new(0.0, TAU, 0.0));
    let closed = solve_finely(&ring, &Case::default()).shape.tip().position;
    assert!(closed.norm() < 1e-12, "{closed:?}");
    let position = |pose: Pose| pose.position;
    let unit = PI * radius.powi(3);
    let along = slope(&ring, tip_force(Vec3::Z), position);
    assert_near(along.z, 3.0 * unit, "along");
    let across = slope(&ring, tip_force(Vec3::X), position);
    assert_near(across.x, unit, "across");
    let out = slope(&ring, tip_force(Vec3::Y), position);
    assert_near(out.y, unit * (1.0 + 3.0 / TORSION), "out of plane");
    // Maxwell and Betti: what one does along the other, the other does along it.
    assert!((along.x - across.z).abs() < 1e-9);
}

/// A helical spring of three turns, pulled along its axis (Love, Treatise (1927), art. 271): the wire
/// twists by `P R cos α` and bends by `P R sin α`, so that it gives way by
/// `P R² ℓ (cos² α/GJ + sin² α/EI)`.
#[test]
fn a_helical_spring_yields_as_love_has_it() {
    let (radius, pitch_angle, turns) = (0.1, 0.2_f64, 3.0);
    let (sin, cos) = pitch_angle.sin_cos();
    let length = TAU * turns * radius / cos;
    let curvature = Vec3::new(cos * cos / radius, 0.0, sin * cos / radius);
    let spring = wound(length, 1.0, curvature);
    // About x the rod bends towards −y: there the axis passes at the radius, along the curvature.
    let (axis, foot) = (curvature / curvature.norm(), -radius * Vec3::Y);
    let rest = solve_finely(&spring, &Case::default()).shape.tip();
    let height = axis.dot(rest.position);
    assert!((height - turns * TAU * radius * pitch_angle.tan()).abs() < 1e-12);
    // A rigid arm from the wire's end to the axis carries the force.
    let arm = foot + axis * height - rest.position;
    let pull = |size: f64| {
        let force = axis * size;
        Loads { tip_force: force, tip_moment: arm.cross(force), ..Loads::default() }
    };
    let end = |pose: Pose| {
        let turn = pose.rotation * rest.rotation.conjugate();
        pose.position + turn.rotate(arm)
    };
    let expected = radius * radius * length * (cos * cos / TORSION + sin * sin);
    assert_near(slope(&spring, pull, end).dot(axis), expected, "spring");
}

/// A strip that is twisted at rest by 5 rad and bends four times as stiffly about y as about x: the
/// yields of its tip are `∫ (1 − s)² (cos²/4 + sin²) ds` along x, `−¾ ∫ (1 − s)² sin cos ds` from x to y.
#[test]
fn a_twisted_strip_bends_askew() {
    let strip = wound(1.0, 4.0, Vec3::new(0.0, 0.0, 5.0));
    let tip = slope(&strip, tip_force(Vec3::X), |pose| pose.position);
    // With ∫ (1 − s)² cos 10s ds = 2/100 − 2 sin 10/1000 and ∫ (1 − s)² sin 10s ds =
    // 1/10 − 2 (1 − cos 10)/1000.
    let (sin, cos) = 10.0_f64.sin_cos();
    let (even, odd) = (0.02 - 0.002 * sin, 0.1 - 0.002 * (1.0 - cos));
    assert_near(tip.x, 5.0 / 8.0 / 3.0 - 3.0 / 8.0 * even, "along the force");
    assert_near(tip.y, -3.0 / 8.0 * odd, "beside it");
}

/// A truncated cone under a force across its tip, along it, and a moment about it: `64 P/(3π E d₀³ d₁)`,
/// `4 P/(π E d₀ d₁)` and `32 M (d₀² + d₀d₁ + d₁²)/(3π G d₀³d₁³)`; the first with `4 P/(π G d₀ d₁)` of shear.
#[test]
fn a_cone_yields_as_its_integrals_say() {
    let (base, tip, young, shear) = (0.2, 0.05, 3e6, 1.1e6);
    let section = Section::Round { outer: Along::PerDisk(vec![base, tip]), inner: 0.0.into() };
    let cone = without_cables(Backbone { section: Some(section), ..round(1.0, tip, young, shear) });
    let position = |pose: Pose| pose.position;
    let bent = 64.0 / (3.0 * PI * young * base.powi(3) * tip);
    let area = PI * base * tip / 4.0;
    let across = slope(&cone, tip_force(Vec3::X), position).x;
    assert_near(across, bent + 1.0 / (shear * area), "across");
    let along = slope(&cone, tip_force(Vec3::Z), position).z;
    assert_near(along, 1.0 / (young * area), "along");
    let twist = |size: f64| Loads { tip_moment: Vec3::Z * size, ..Loads::default() };
    let turned = slope(&cone, twist, |pose| pose.rotation.log()).z;
    let sum = base * base + base * tip + tip * tip;
    let expected = 32.0 * sum / (3.0 * PI * shear * (base * tip).powi(3));
    // Steps are as fine as positions ask for, which do not change here.
    assert!((turned / expected - 1.0).abs() < 5e-7, "twist: {turned} {expected}");
}
