//! Stability of robots that obstacles hold.

use super::{among, finger, sphere};
use whipcord::four_bar::{self, LengthRule, Objective};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Loads, Model, ModelKind, NoStability, Robot, Routing,
    Shortening, Solution, SolveError, Stations, Stiffness, Vec3,
};

/// Of the column, in m.
const RADIUS: f64 = 0.01;

/// A column of length 1 m and EI 1 N·m² across one direction, whose disks are small balls, and that hardly bends across the other.
fn column(sections: usize) -> Robot {
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: [100.0, 1.0].into(),
        torsion: 100.0.into(),
    };
    let backbone = Backbone {
        stiffness: Some(stiffness),
        extensible: false,
        shearable: false,
        ..Backbone::new(1.0)
    };
    let disks = Disks {
        outer_radius: Some(RADIUS),
        thickness: Some(2.0 * RADIUS),
        ..Disks::equally_spaced(1.0, sections + 1, 0.5 * RADIUS)
    };
    let cable = Cable::new("idle", Routing::Straight { angle: 0.0, radius: 0.5 * RADIUS });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

/// The column under an axial load in N, whose tip leans against a ball beside it.
fn leaning(kind: ModelKind, load: f64) -> Result<Solution, SolveError> {
    let robot = column(24);
    let loads = Loads { tip_force: Vec3::new(0.1, 0.0, -load), ..Loads::default() };
    let ball = sphere(Vec3::new(RADIUS + 0.05 + 1e-6, 0.0, 1.0), 0.05);
    let case = Case { loads, ..among(Case::with_tensions(&[0.0]), vec![ball]) };
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.prepare(&robot, &case.loads)?.solve(&case, None)
}

/// A column that is clamped at one end and held aside at the other buckles at 20.19 EI/L², eight times the load of one whose end is
/// free: the smallest root of tan k = k, squared.
#[test]
fn a_column_that_leans_on_a_ball_is_stable_up_to_the_load_of_a_hinged_end() {
    let root: f64 = 4.493_409_457_909_064;
    assert!((root.tan() - root).abs() < 1e-9);
    for (kind, part) in [
        (ModelKind::Cosserat, 0.99),
        (ModelKind::CosseratDisks, 0.99),
        (ModelKind::PiecewiseConstantCurvature, 0.97),
        (ModelKind::PseudoRigidBody, 0.97),
    ] {
        let critical = root * root;
        for load in [1.0, 4.0, 12.0, part * critical] {
            let answer = leaning(kind, load).unwrap();
            assert_eq!(answer.contacts.len(), 1, "{kind} at {load}");
            assert_eq!(answer.diagnostics.stable, Some(true), "{kind} at {load}");
            assert_eq!(answer.diagnostics.stability_absent, None, "{kind} at {load}");
            assert_eq!(answer.diagnostics.stability_lost_at, None, "{kind} at {load}");
            let tip = answer.disks.poses.last().unwrap().position;
            assert!(Vec3::new(tip.x, tip.y, 0.0).norm() < 1e-4, "{kind} at {load}: {tip:?}");
        }
        // Beyond it, it stands nowhere near that shape.
        let load = critical * (2.0 - part);
        if let Ok(answer) = leaning(kind, load) {
            let lost_at = answer.diagnostics.stability_lost_at.unwrap();
            assert!((lost_at * load / critical - 1.0).abs() < 1.0 - part, "{kind}: {lost_at}");
            let sideways = |pose: &whipcord::Pose| pose.position.x.abs();
            assert!(answer.disks.poses.iter().map(sideways).fold(0.0, f64::max) > 0.01);
        }
    }
}

/// Where friction holds it, or the load follows the tip, nothing is said.
#[test]
fn with_friction_and_under_followers_there_is_no_verdict() {
    let robot = column(8);
    let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
    let ball = sphere(Vec3::new(RADIUS + 0.05 + 1e-3, 0.0, 1.0), 0.05);
    let plain = Loads { tip_force: Vec3::new(0.1, 0.0, -1.0), ..Loads::default() };
    let follower = Loads { tip_follower: true, ..plain.clone() };
    let moment = Loads { tip_moment: Vec3::new(0.0, 0.02, 0.0), ..plain.clone() };
    for (loads, friction, why) in [
        (plain, 0.3, NoStability::Touching),
        (follower, 0.0, NoStability::Followers),
        (moment, 0.0, NoStability::DeadMoments),
    ] {
        let ball = whipcord::Obstacle { friction, ..ball.clone() };
        let case = Case { loads, ..among(Case::with_tensions(&[0.0]), vec![ball]) };
        let answer = model.prepare(&robot, &case.loads).unwrap().solve(&case, None).unwrap();
        assert_eq!(answer.contacts.len(), 1);
        assert_eq!(answer.diagnostics.stable, None);
        assert_eq!(answer.diagnostics.stability_absent, Some(why));
    }
}

/// A finger that is bent against the flank of a ball is stable by every model, and from its own answer too.
#[test]
fn a_finger_that_leans_on_a_ball_is_stable_by_every_model() {
    let robot = finger(9);
    let ball = sphere(Vec3::new(0.05, 0.005, 0.12), 0.03);
    let case = among(Case::with_shortenings(&[Shortening::Length(0.004)]), vec![ball]);
    for kind in ModelKind::ALL.into_iter().filter(|&kind| kind != ModelKind::ConstantCurvature) {
        let model = match kind {
            ModelKind::FourBar => Model::FourBar(four_bar::Options {
                objective: Objective::StrainEnergy,
                lengths: LengthRule::Free,
                ..four_bar::Options::default()
            }),
            kind => Model::new(kind, Stations::Disks, Actuation::Natural),
        };
        let mut prepared = model.prepare(&robot, &case.loads).unwrap();
        let cold = prepared.solve(&case, None).unwrap();
        let warm = prepared.solve(&case, Some(&cold)).unwrap();
        for answer in [&cold, &warm] {
            assert!(!answer.contacts.is_empty(), "{kind}");
            assert_eq!(answer.diagnostics.stable, Some(true), "{kind}");
            assert_eq!(answer.diagnostics.stability_lost_at, None, "{kind}");
        }
    }
}
