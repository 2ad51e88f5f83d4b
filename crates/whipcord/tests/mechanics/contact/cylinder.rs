//! A thin rod pulled round a cylinder, against what holds for every elastica that obstacles push along their normals.
//!
//! In a rod that neither stretches nor shears, with tension T and moment M, T′ = κV and M′ = −V between contacts: `T + M²/2EI` is
//! the same along all of it, since a push along the normal changes neither T nor M. Where it lies on the cylinder its curvature,
//! and with it M and T, are constant, so that it is pushed by Tκ per length.

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
fn pulled() -> Case {
    let across = UnitQuaternion::exp(Vec3::X * core::f64::consts::FRAC_PI_2);
    let cylinder = Obstacle {
        name: "cylinder".to_owned(),
        form: Form::Cylinder { radius: RADIUS - 0.5 * DIAMETER, length: 0.2 },
        pose: Pose { position: Vec3::new(RADIUS + 1e-4, 0.0, 0.5 * LENGTH), rotation: across },
        friction: 0.0,
        movable: None,
    };
    let loads = Loads { tip_force: Vec3::new(FORCE, 0.0, 0.0), ..Loads::default() };
    among(Case { loads, ..Case::default() }, vec![cylinder])
}

fn solve(kind: ModelKind) -> Solution {
    let case = pulled();
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.prepare(&rod(), &case.loads).unwrap().solve(&case, None).unwrap()
}

/// `T + M²/2EI` at the base and at the tip.
fn invariants(solution: &Solution) -> [f64; 2] {
    let stiffness = MODULUS * core::f64::consts::PI * DIAMETER.powi(4) / 64.0;
    let base = solution.base_wrench.unwrap();
    let tangent = solution.disks.tip().rotation.rotate(Vec3::Z);
    [base.force.z + base.moment.dot(base.moment) / (2.0 * stiffness), FORCE * tangent.x]
}

#[test]
fn pushes_leave_the_invariant_of_the_rod() {
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let solution = solve(kind);
        let [base, tip] = invariants(&solution);
        // It stretches by T/EA and shears, which is left out.
        let strain = FORCE / (MODULUS * core::f64::consts::PI * DIAMETER * DIAMETER / 4.0);
        assert!((base / tip - 1.0).abs() < 2.0 * strain + 1e-5, "{kind}: {base} {tip} {strain}");
        assert!(solution.contacts.len() > 2, "{kind}: {:?}", solution.contacts);
        // Where it lies on the cylinder, inside of the ends of the contact.
        let stiffness = MODULUS * core::f64::consts::PI * DIAMETER.powi(4) / 64.0;
        let tension = tip - stiffness / (2.0 * RADIUS * RADIUS);
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
