//! A thin rod pulled round a cylinder, against what holds for every elastica that obstacles push along their normals.
//!
//! In a rod that neither stretches nor shears, with tension T and moment M, T′ = κV and M′ = −V between contacts: `T + M²/2EI` is
//! the same along all of it, since a push along the normal changes neither T nor M. Where it lies on the cylinder its curvature,
//! and with it M and T, are constant, so that it is pushed by Tκ per length.
//!
//! With friction μ that slides all along, a push of f by its line is resisted by μ f at the surface of the rod, r from its axis: on a
//! cylinder whose rod's axis has the radius R this changes `T + M²/2EI` by `μ (1 − r/R) f`. The rod leaves the cylinder at both ends with
//! the curvature 1/R and a shear force V, which a push at the point takes up: there T jumps by μ V, and between these T grows as in a
//! rope.

use super::among;
use whipcord::{
    Actuation, Backbone, Case, Disks, Form, Loads, Material, Model, ModelKind, Obstacle, Pose,
    Robot, Section, Solution, Stations, UnitQuaternion, Vec3,
};

const LENGTH: f64 = 0.3;
const DIAMETER: f64 = 0.001;
const MODULUS: f64 = 2e9;
/// Of the cylinder and the rod that lies on it.
const RADIUS: f64 = 0.03;
const FORCE: f64 = 0.4;

fn rod() -> Robot {
    let material =
        Material { young_modulus: Some(MODULUS), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(DIAMETER));
    let backbone = Backbone { material, section, ..Backbone::new(LENGTH) };
    // Disks that are no wider than the rod.
    let disks = Disks {
        outer_radius: Some(0.4 * DIAMETER),
        thickness: Some(0.2 * DIAMETER),
        ..Disks::equally_spaced(LENGTH, 4, 0.4 * DIAMETER)
    };
    Robot::new(backbone, disks, vec![]).unwrap()
}

/// Pulled across by its tip, over a cylinder that it passes half-way.
fn pulled(friction: f64) -> Case {
    let across = UnitQuaternion::exp(Vec3::X * core::f64::consts::FRAC_PI_2);
    let cylinder = Obstacle {
        name: "cylinder".to_owned(),
        form: Form::Cylinder { radius: RADIUS - 0.5 * DIAMETER, length: 0.2 },
        pose: Pose { position: Vec3::new(RADIUS + 1e-4, 0.0, 0.5 * LENGTH), rotation: across },
        friction,
        movable: None,
    };
    let loads = Loads { tip_force: Vec3::new(FORCE, 0.0, 0.0), ..Loads::default() };
    among(Case { loads, ..Case::default() }, vec![cylinder])
}

fn solve(kind: ModelKind, friction: f64) -> Solution {
    let case = pulled(friction);
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.prepare(&rod(), &case.loads).unwrap().solve(&case, None).unwrap()
}

/// `T + M²/2EI` at the base and at the tip.
fn invariants(solution: &Solution) -> [f64; 2] {
    let base = solution.base_wrench.unwrap();
    let tangent = solution.disks.tip().rotation.rotate(Vec3::Z);
    [base.force.z + base.moment.dot(base.moment) / (2.0 * STIFFNESS), FORCE * tangent.x]
}

#[test]
fn pushes_leave_the_invariant_of_the_rod() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let solution = solve(kind, 0.0);
        let [base, tip] = invariants(&solution);
        // It stretches by T/EA and shears, which is left out.
        let strain = FORCE / (MODULUS * core::f64::consts::PI * DIAMETER * DIAMETER / 4.0);
        assert!((base / tip - 1.0).abs() < 2.0 * strain + 1e-5, "{kind}: {base} {tip} {strain}");
        assert!(solution.contacts.len() > 2, "{kind}: {:?}", solution.contacts);
        // Where it lies on the cylinder, inside of the ends of the contact.
        let tension = tip - STIFFNESS / (2.0 * RADIUS * RADIUS);
        let contacts = &solution.contacts;
        let place = |k: usize| contacts[k].arc_length;
        let ends = [place(0), place(contacts.len() - 1)];
        let is_inner = |s: f64| (s - 0.5 * (ends[0] + ends[1])).abs() < 0.25 * (ends[1] - ends[0]);
        let inner: Vec<usize> = (0..contacts.len()).filter(|&k| is_inner(place(k))).collect();
        // Each bears what lies nearer to it than to others.
        let share = |k: usize| 0.5 * (place(k + 1) - place(k - 1));
        let span: f64 = inner.iter().map(|&k| share(k)).sum();
        let pushed: f64 = inner.iter().map(|&k| contacts[k].force.unwrap()).sum();
        let density = tension / RADIUS;
        assert!(
            (pushed / (density * span) - 1.0).abs() < 0.2,
            "{kind}: {pushed} {}",
            density * span
        );
    }
}

/// EI.
const STIFFNESS: f64 =
    MODULUS * core::f64::consts::PI * DIAMETER * DIAMETER * DIAMETER * DIAMETER / 64.0;

/// Where a zero of a growing function lies between two places.
fn zero(mut from: f64, mut to: f64, value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..100 {
        let middle = 0.5 * (from + to);
        if value(middle) < 0.0 { from = middle } else { to = middle }
    }
    0.5 * (from + to)
}

/// `T + M²/2EI` behind a cylinder over which a rod is pulled with this force and so turned by this angle, with friction.
fn held_back(force: f64, angle: f64, friction: f64) -> f64 {
    let friction = friction * (1.0 - 0.5 * DIAMETER / RADIUS);
    let bending = STIFFNESS / (2.0 * RADIUS * RADIUS);
    // Where a free end that pulls with a force leaves the cylinder: tension, shear force, and its angle to the force.
    let leaves = |force: f64| {
        let tension = force - bending;
        (tension, (force * force - tension * tension).sqrt(), (tension / force).acos())
    };
    let (pulled, shear, turned) = leaves(force);
    // The other end for an angle of contact.
    let other = |wrapped: f64| {
        let within = (pulled - friction * shear) * (-friction * wrapped).exp();
        zero(bending, force, |held| {
            let (tension, shear, _) = leaves(held);
            tension + friction * shear - within
        })
    };
    other(zero(0.0, angle, |wrapped| turned + wrapped + leaves(other(wrapped)).2 - angle))
}

/// The capstan of a rod: friction takes up what the closed form says, within the coarseness of contacts at checked stations.
#[test]
fn friction_holds_back_what_a_capstan_does() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        for friction in [0.1, 0.3] {
            let solution = solve(kind, friction);
            assert_eq!(solution.diagnostics.stability_lost_at, None);
            let [base, tip] = invariants(&solution);
            let pull = solution.base_wrench.unwrap().force;
            let expected =
                held_back(tip, pull.x.atan2(pull.z) + core::f64::consts::FRAC_PI_2, friction);
            assert!((base - expected).abs() < 0.1 * (tip - expected), "{kind}: {base} {expected}");
            for contact in &solution.contacts {
                let (push, drag) = (contact.force.unwrap(), contact.friction.unwrap().norm());
                assert!(!contact.sticks && (drag / push - friction).abs() < 1e-6, "{contact:?}");
            }
        }
    }
}
