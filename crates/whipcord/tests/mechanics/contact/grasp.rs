//! A finger that closes round a ball.

use super::{among, assert_clear, finger, pushes_of, sphere, wall};
use crate::common::model_with_forces;
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::four_bar::{FourBar, LengthRule, Objective};
use whipcord::{
    Actuation, Backbone, Cable, Case, Contact, Disks, Grasp, Material, Model, ModelKind, Obstacle,
    Part, Robot, Routing, Section, Shortening, Solution, SolveError, Statics as _, Stations, Vec3,
    Wrench,
};

const LENGTH: f64 = 0.12;
const YOUNG: f64 = 2e11;
/// Of the strip towards the ball.
const STIFFNESS: f64 = YOUNG * 0.008 * 0.0003 * 0.0003 * 0.0003 / 12.0;

/// A strip of steel that hardly bends sideways, so that it does not slip off.
fn strip(sections: usize) -> Robot {
    let material =
        Material { young_modulus: Some(YOUNG), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::rectangle(0.0003, 0.008));
    let backbone = Backbone { material, section, ..Backbone::new(LENGTH) };
    let disks = Disks {
        outer_radius: Some(0.008),
        thickness: Some(0.002),
        ..Disks::equally_spaced(LENGTH, sections + 1, 0.006)
    };
    let cable = Cable::new("flexor", Routing::Straight { angle: 0.0, radius: 0.006 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

fn by_rod(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let options = Options { actuation: Actuation::Shortening, ..Options::default() };
    Cosserat::new(robot, &case.loads, &options)?.solve(case, None, &mut Workspace::default())
}

fn by_sections(kind: ModelKind, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let model = Model::new(kind, Stations::Disks, Actuation::Shortening);
    model.prepare(robot, &case.loads)?.solve(case, None)
}

fn by_chain(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let options = whipcord::four_bar::Options {
        objective: Objective::StrainEnergy,
        lengths: LengthRule::Free,
        ..Default::default()
    };
    FourBar::new(robot, &options)?.solve(case, None, &mut Default::default())
}

/// It touches the ball from both sides, and what the ball pushes is what the base bears.
#[test]
fn a_finger_closes_round_a_ball() {
    let ball = sphere(Vec3::new(0.031, 0.0, 0.030), 0.022);
    let case = Case::with_shortenings(&[Shortening::Length(0.01837)]);
    let case = among(case, vec![ball.clone()]);
    let robot = strip(24);
    let [rod, chain] = [by_rod(&robot, &case), by_chain(&robot, &case)].map(Result::unwrap);
    let kinds = [ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody];
    let [arcs, bodies] = kinds.map(|kind| by_sections(kind, &robot, &case).unwrap());
    for solution in [&rod, &chain, &arcs, &bodies] {
        let contacts = &solution.contacts;
        assert!(contacts.len() >= 3, "{contacts:?}");
        assert!(contacts[0].normal.x < -0.7, "{contacts:?}");
        let last = contacts.last().unwrap();
        assert!(last.normal.x > 0.7 && last.part == Part::Disk(24), "{contacts:?}");
        assert!(solution.disks.bend().0 > 2.9);
        assert_clear(&robot, solution, &ball);
    }
    for other in [&chain, &arcs, &bodies] {
        let apart = rod.disks.distances(&other.disks).fold(0.0, f64::max);
        assert!(apart < 0.01 * LENGTH, "{}: {apart}", other.model);
        let [t, u] = [&rod, other].map(|solution| solution.cables[0].tension.unwrap());
        assert!((u / t - 1.0).abs() < 0.05, "{}: {t} N, {u} N", other.model);
    }
    let (_, total) = pushes_of(&rod);
    let base = rod.base_wrench.unwrap();
    assert!((base.force - total.force).norm() < 1e-6 * STIFFNESS / (LENGTH * LENGTH));
    assert!((base.moment - total.moment).norm() < 1e-6 * STIFFNESS / LENGTH);
}

/// An obstacle that is not touched has no grasp, a ball without friction is not turned about its centre, and one with friction
/// bears no more along its surface than Coulomb's law allows.
#[test]
fn the_grasp_of_a_ball_balances_the_base() {
    for friction in [0.0, 0.3] {
        let ball = Obstacle { friction, ..sphere(Vec3::new(0.031, 0.0, 0.030), 0.022) };
        let away = sphere(Vec3::new(1.0, 0.0, 0.0), 0.01);
        let case = Case::with_shortenings(&[Shortening::Length(0.01837)]);
        let case = among(case, vec![away, ball.clone()]);
        let robot = strip(24);
        let kinds = [ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody];
        let mut answers = kinds.map(|kind| by_sections(kind, &robot, &case).unwrap()).to_vec();
        answers.push(by_rod(&robot, &case).unwrap());
        for solution in answers {
            let grasps = Grasp::all(&solution, &case.obstacles);
            let [grasp] = grasps.as_slice() else { panic!("{grasps:?}") };
            assert_eq!((grasp.obstacle, grasp.contacts), (1, solution.contacts.len()));
            let Wrench { force, moment } = grasp.wrench.unwrap();
            let pressed = grasp.normal_force.unwrap();
            let base = solution.base_wrench.unwrap();
            let scale = STIFFNESS / (LENGTH * LENGTH);
            let about_base = moment + ball.pose.position.cross(force);
            assert!((base.force + force).norm() < 1e-6 * scale);
            assert!((base.moment + about_base).norm() < 1e-6 * scale * LENGTH);
            if friction > 0.0 {
                let margin = grasp.slip_margin.unwrap();
                assert!((0.0..=1.0).contains(&margin));
                assert_eq!(grasp.sliding > 0, margin < 1e-6, "{grasp:?}");
                // Normal forces of a ball have no moment about its centre, so all of it is friction at the radius.
                assert!(moment.norm() > 1e-6 * pressed * LENGTH, "{grasp:?}");
                assert!(moment.norm() <= friction * 0.022 * pressed * (1.0 + 1e-6), "{grasp:?}");
            } else {
                assert_eq!(grasp.slip_margin, None);
                assert!(moment.norm() < 1e-6 * pressed * LENGTH, "{grasp:?}");
            }
        }
    }
}

/// Pulled harder, the disks roll off sideways: their rims push towards the strip, it twists and comes to rest beside the ball.
#[test]
fn a_grasp_that_nothing_holds_rolls_off() {
    let ball = sphere(Vec3::new(0.031, 0.0, 0.030), 0.022);
    let case = among(Case::with_tensions(&[35.0]), vec![ball.clone()]);
    let robot = strip(12);
    let model = Cosserat::new(&robot, &case.loads, &Options::default()).unwrap();
    let solution = model.solve(&case, None, &mut Workspace::default()).unwrap();
    let lost = solution.diagnostics.stability_lost_at.unwrap();
    assert!((0.5..0.9).contains(&lost), "{lost}");
    assert!(solution.disks.tip().position.y.abs() > 0.1 * LENGTH);
    assert_clear(&robot, &solution, &ball);
}

/// What the robot exerts on each obstacle is what the contacts exert on it, turned round: together with the base they leave
/// nothing of a robot without loads.
#[test]
fn grasps_balance_what_the_base_bears() {
    let rubbing = Obstacle { friction: 0.3, ..wall(0.03) };
    let ball = sphere(Vec3::new(0.03, 0.02, 0.17), 0.012);
    for kind in [
        ModelKind::Cosserat,
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
        ModelKind::FourBar,
    ] {
        let model = model_with_forces(kind, Stations::Disks, Actuation::Shortening);
        let obstacles = vec![rubbing.clone(), ball.clone()];
        let case = Case { obstacles, ..Case::with_shortenings(&[Shortening::Length(0.006)]) };
        let solution = model.solve(&finger(9), &case).unwrap_or_else(|e| panic!("{kind}: {e}"));
        let grasps = Grasp::all(&solution, &case.obstacles);
        assert_eq!(grasps[0].obstacle, 0, "{kind}");
        let (mut force, mut moment) = (Vec3::ZERO, Vec3::ZERO);
        let mut pressed = 0.0;
        for grasp in &grasps {
            let Wrench { force: f, moment: m } = grasp.wrench.unwrap();
            force += f;
            moment += m + case.obstacles[grasp.obstacle].pose.position.cross(f);
            pressed += grasp.normal_force.unwrap();
        }
        // Dead forces on the robot end in the base.
        let base = solution.base_wrench.unwrap();
        assert!((base.force + force).norm() < 1e-6 * pressed, "{kind}: {base:?} {force:?}");
        assert!((base.moment + moment).norm() < 1e-6 * pressed * 0.18, "{kind}");
        let of_wall: Vec<_> =
            solution.contacts.iter().filter(|touch| touch.obstacle == 0).collect();
        assert_eq!(grasps[0].contacts, of_wall.len());
        let margin =
            |touch: &&Contact| 1.0 - touch.friction.unwrap().norm() / (0.3 * touch.force.unwrap());
        let least = of_wall.iter().map(margin).fold(1.0, f64::min).max(0.0);
        assert!((grasps[0].slip_margin.unwrap() - least).abs() < 1e-9, "{kind}");
        assert_eq!(grasps[0].sliding > 0, least < 1e-6, "{kind}: {:?}", grasps[0]);
        assert!(grasps.iter().skip(1).all(|grasp| grasp.slip_margin.is_none()));
    }
}
