//! A slender rod on sharp edges and on corners, against a clamped beam on a point support.

use std::sync::Arc;

use super::{among, cube};
use whipcord::{
    Actuation, Backbone, Case, Disks, Form, Loads, Material, Model, ModelKind, Obstacle, Pose,
    Robot, Section, Solution, SolveError, Stations, UnitQuaternion, Vec3,
};

const LENGTH: f64 = 0.3;
/// Its radius is larger than the distance of the watched places.
const DIAMETER: f64 = 0.01;
/// Between the watched places such a rod could pass over an edge.
const THIN: f64 = 0.001;
const MODULUS: f64 = 2e9;
/// On the tip, along x: it would deflect by 0.3 mm.
fn force(diameter: f64) -> f64 {
    3.3e-2 * (diameter / 0.01).powi(4)
}

/// Between the rod at rest and its support.
const CLEARANCE: f64 = 1e-5;
const EDGE: f64 = 0.04;
const KINDS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

fn rod(diameter: f64) -> Robot {
    let material =
        Material { young_modulus: Some(MODULUS), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(diameter));
    let backbone = Backbone {
        material,
        section,
        shearable: false,
        extensible: false,
        ..Backbone::new(LENGTH)
    };
    // Disks that are no wider than the rod.
    let disks = Disks {
        outer_radius: Some(0.4 * diameter),
        thickness: Some(0.2 * diameter),
        ..Disks::equally_spaced(LENGTH, 4, 0.4 * diameter)
    };
    Robot::new(backbone, disks, vec![]).unwrap()
}

fn solve(kind: ModelKind, diameter: f64, obstacles: Vec<Obstacle>) -> Result<Solution, SolveError> {
    let loads = Loads { tip_force: Vec3::new(force(diameter), 0.0, 0.0), ..Loads::default() };
    let case = among(Case { loads, ..Case::default() }, obstacles);
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let mut prepared = model.prepare(&rod(diameter), &case.loads).unwrap();
    prepared.solve(&case, None)
}

/// The force of a support at `s` on a clamped beam under the force on its tip, once the clearance is used up.
fn reaction(diameter: f64, s: f64) -> f64 {
    let free = force(diameter) * s * s * (3.0 * LENGTH - s) / 6.0;
    let own = s * s * s / 3.0;
    let stiffness = MODULUS * core::f64::consts::PI * diameter.powi(4) / 64.0;
    (free - CLEARANCE * stiffness) / own
}

fn obstacle(form: Form, position: Vec3, rotation: UnitQuaternion) -> Obstacle {
    let pose = Pose { position, rotation };
    Obstacle { name: "support".to_owned(), form, pose, friction: 0.0, movable: None }
}

/// The one contact is where the support is, and bears what a point support does.
#[track_caller]
fn assert_on_support(kind: ModelKind, solution: &Solution, diameter: f64, s: f64) {
    let [contact] = solution.contacts[..] else { panic!("{kind}: {:?}", solution.contacts) };
    let (found, expected) = (contact.force.unwrap(), reaction(diameter, s));
    assert!(
        (found / expected - 1.0).abs() < 2e-3,
        "{kind}, {diameter} m, at {s}: {found} N, {expected} N"
    );
    assert!((contact.arc_length - s).abs() < 5e-5, "{kind}: {}", contact.arc_length);
    assert!((contact.normal + Vec3::X).norm() < 2e-3, "{kind}: {:?}", contact.normal);
}

/// The force is that between both faces that meet at the edge, normal to the rod; the form may be a box or its mesh.
#[test]
fn the_edge_of_a_box_is_a_point_support() {
    let across = UnitQuaternion::exp(Vec3::Y * core::f64::consts::FRAC_PI_4);
    let forms = [Form::Box { size: Vec3::new(EDGE, EDGE, EDGE) }, Form::Mesh(Arc::new(cube(EDGE)))];
    for kind in KINDS {
        for form in &forms {
            for s in [0.13, 0.151, 0.27] {
                let at = |diameter: f64| {
                    let x = 0.5 * diameter + CLEARANCE + EDGE * core::f64::consts::FRAC_1_SQRT_2;
                    vec![obstacle(form.clone(), Vec3::new(x, 0.0, s), across)]
                };
                assert_on_support(kind, &solve(kind, DIAMETER, at(DIAMETER)).unwrap(), DIAMETER, s);
                // A thin one is refused where it is not found on the edge, but does not pass through it.
                if let Ok(solution) = solve(kind, THIN, at(THIN)) {
                    assert_on_support(kind, &solution, THIN, s);
                }
            }
        }
    }
}

/// On the corner of a cube that points at the rod.
#[test]
fn a_corner_is_a_point_support() {
    let diagonal = Vec3::new(1.0, 1.0, 1.0) / 3.0_f64.sqrt();
    let axis = diagonal.cross(-Vec3::X);
    let turn = axis / axis.norm() * axis.norm().atan2(-diagonal.x);
    let forms = [Form::Box { size: Vec3::new(EDGE, EDGE, EDGE) }, Form::Mesh(Arc::new(cube(EDGE)))];
    for kind in KINDS {
        for form in &forms {
            let s = 0.151;
            let at = |diameter: f64| {
                let x = 0.5 * diameter + CLEARANCE + 0.5 * EDGE * 3.0_f64.sqrt();
                let turned = UnitQuaternion::exp(turn);
                vec![obstacle(form.clone(), Vec3::new(x, 0.0, s), turned)]
            };
            assert_on_support(kind, &solve(kind, DIAMETER, at(DIAMETER)).unwrap(), DIAMETER, s);
            if let Ok(solution) = solve(kind, THIN, at(THIN)) {
                assert_on_support(kind, &solution, THIN, s);
            }
        }
    }
}
