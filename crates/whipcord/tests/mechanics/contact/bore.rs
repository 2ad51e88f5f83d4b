//! Disks that fit a bore closely: they touch it along much of their rims.

use super::among;
use whipcord::obstacle::{Bends, Pipe};
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, Material, Model, ModelKind, Obstacle,
    Obstruction, Pose, Robot, Routing, Section, Solution, SolveError, Stations, Vec3,
};

const LENGTH: f64 = 0.18;
const RADIUS: f64 = 0.01;
const STIFFNESS: f64 = 1.1e9 * core::f64::consts::PI * 0.003 * 0.003 * 0.003 * 0.003 / 64.0;

const RODS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];

/// A rod that neither shears nor stretches, as the beam of the closed forms.
fn robot(sections: usize) -> Robot {
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone {
        material,
        section,
        shearable: false,
        extensible: false,
        ..Backbone::new(LENGTH)
    };
    let disks = Disks {
        outer_radius: Some(RADIUS),
        thickness: Some(0.002),
        ..Disks::equally_spaced(LENGTH, sections + 1, 0.008)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

/// A straight bore with this clearance around the disks, as far as this.
fn bore(clearance: f64, end: f64) -> Obstacle {
    let points = [Vec3::new(0.0, 0.0, -0.05), Vec3::new(0.0, 0.0, end)];
    let form = Form::Pipe(Pipe::new(RADIUS + clearance, &points, Bends::Corners).unwrap());
    Obstacle { name: "bore".to_owned(), form, pose: Pose::IDENTITY, friction: 0.0, movable: None }
}

fn solve(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    from: Option<&Solution>,
) -> Result<Solution, SolveError> {
    let model = Model::new(kind, Stations::Disks, Actuation::Tension);
    model.prepare(robot, &case.loads)?.solve(case, from)
}

/// Deflection at `s` of a clamped beam under a unit force at `at`.
fn influence(s: f64, at: f64) -> f64 {
    let (a, b) = if s < at { (s, at) } else { (at, s) };
    a * a * (3.0 * b - a) / (6.0 * STIFFNESS)
}

/// The forces of supports with this clearance on a clamped beam under a force at a place, at supports at these places: each
/// pushes back where the beam has used up the clearance. By trying supports in turn until all conditions hold.
fn beam(places: &[f64], clearance: f64, (force, at): (f64, f64)) -> Vec<f64> {
    let free: Vec<f64> = places.iter().map(|&s| force * influence(s, at)).collect();
    supports(places, clearance, &free)
}

/// The same of a beam that has these deflections at the supports without them.
fn supports(places: &[f64], clearance: f64, free: &[f64]) -> Vec<f64> {
    let n = places.len();
    let mut forces = vec![0.0; n];
    // Projected Gauss-Seidel.
    for _ in 0..200_000 {
        let mut change: f64 = 0.0;
        for i in 0..n {
            let deflection: f64 =
                free[i] + (0..n).map(|j| influence(places[i], places[j]) * forces[j]).sum::<f64>();
            let own = influence(places[i], places[i]);
            let up = (forces[i] - (deflection - clearance) / own).min(0.0);
            let down = (forces[i] - (deflection + clearance) / own).max(0.0);
            let next = up + down;
            change = change.max((next - forces[i]).abs());
            forces[i] = next;
        }
        if change < 1e-13 {
            return forces;
        }
    }
    panic!("the beam of the test does not converge");
}

/// The sum of the forces on each disk.
fn on_disks(solution: &Solution) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; solution.disks.poses.len()];
    for touch in &solution.contacts {
        sums[touch.part.disk().unwrap()] += touch.normal * touch.force.unwrap();
    }
    sums
}

fn assert_in_bore(solution: &Solution, bore: &Obstacle) {
    for pose in &solution.disks.poses[1..] {
        for k in 0..720 {
            let (sin, cos) = (f64::from(k) * 0.5).to_radians().sin_cos();
            let point = pose.transform(Vec3::new(cos, sin, 0.0) * (RADIUS - 0.001));
            let gap = bore.surface(point).distance - 0.001;
            assert!(gap > -1.1e-8 * LENGTH, "{gap}");
        }
    }
}

/// A force on the tip beyond the end of the bore bends the rod against the wall at the mouth and, deeper, on the other side.
#[test]
fn a_rod_in_a_bore_is_a_beam_on_supports_with_clearance() {
    let sections = 6;
    let robot = robot(sections);
    let places: Vec<f64> = (1..sections).map(|k| LENGTH * k as f64 / sections as f64).collect();
    for clearance in [0.0, 1e-6, 1e-5, 1e-4] {
        for degrees in [0.0, 33.0_f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let along = Vec3::new(cos, sin, 0.0);
            let force = 0.02;
            let expected = beam(&places, clearance, (force, LENGTH));
            for kind in RODS {
                let mut case = among(Case::with_tensions(&[0.0]), vec![bore(clearance, 0.16)]);
                case.loads.tip_force = along * force;
                let solution = solve(kind, &robot, &case, None)
                    .unwrap_or_else(|error| panic!("{kind} {clearance} {degrees}: {error}"));
                assert_in_bore(&solution, &case.obstacles[0]);
                let found = on_disks(&solution);
                for (k, &expected) in expected.iter().enumerate() {
                    let apart = (found[k + 1] - along * expected).norm();
                    assert!(
                        apart < 0.01 * force,
                        "{kind} {clearance} {degrees}: disk {}: {:?}, {expected}",
                        k + 1,
                        found[k + 1]
                    );
                }
            }
        }
    }
}

/// A robot of ten disks that fits its bore within this, pulled by one cable.
fn pulled(kind: ModelKind, clearance: f64) -> Result<(Robot, Obstacle, Solution), SolveError> {
    let (robot, bore) = (robot(9), bore(clearance, 0.25));
    let case = among(Case::with_tensions(&[PULL]), vec![bore.clone()]);
    let solution = solve(kind, &robot, &case, None)?;
    Ok((robot, bore, solution))
}

const PULL: f64 = 4.0;

/// The cable is a moment on the tip of a clamped beam, which the bore keeps straight but for its clearance.
#[test]
fn a_robot_that_fits_its_bore_closely_is_kept_straight() {
    let places: Vec<f64> = (1..=9).map(|k| LENGTH * f64::from(k) / 9.0).collect();
    let moment = 0.008 * PULL;
    let free: Vec<f64> = places.iter().map(|s| moment * s * s / (2.0 * STIFFNESS)).collect();
    for clearance in [1e-7, 1e-6, 5e-6, 1e-5] {
        let expected = supports(&places, clearance, &free);
        let largest = expected.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        for kind in RODS {
            let (_, bore, solution) = pulled(kind, clearance)
                .unwrap_or_else(|error| panic!("{kind} {clearance}: {error}"));
            assert_in_bore(&solution, &bore);
            let found = on_disks(&solution);
            for (k, &expected) in expected.iter().enumerate() {
                let apart = (found[k + 1] - Vec3::X * expected).norm();
                assert!(
                    apart < 0.03 * largest,
                    "{kind} {clearance}: disk {}: {:?}, {expected} of {largest}",
                    k + 1,
                    found[k + 1]
                );
            }
        }
        for kind in [ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody] {
            let (_, bore, solution) = pulled(kind, clearance)
                .unwrap_or_else(|error| panic!("{kind} {clearance}: {error}"));
            assert_in_bore(&solution, &bore);
            // What tilts a disk lets it move by as much more as its rim gets shorter across the bore.
            for pose in &solution.disks.poses {
                let aside = pose.position.x.hypot(pose.position.y);
                assert!(aside < clearance + 2e-5, "{kind} {clearance}: {aside}");
            }
        }
    }
}

/// Arcs whose ends stay on a line are straight: the mean of the moments of cable and disks over each of them vanishes.
#[test]
fn arcs_without_clearance_are_straight() {
    let (_, _, solution) = pulled(ModelKind::PiecewiseConstantCurvature, 0.0).unwrap();
    let unit = 2.0 * 0.008 * PULL / (LENGTH / 9.0);
    for (k, force) in on_disks(&solution).iter().enumerate().skip(1) {
        let sign = if k % 2 == 1 { -1.0 } else { 1.0 };
        let expected = sign * unit * if k == 9 { 1.0 } else { 2.0 };
        assert!((*force - Vec3::X * expected).norm() < 1e-4 * unit, "{k}: {force:?} {expected}");
    }
}

/// Disks that tilt wedge in a bore that they fill: the error says so, and how much clearance is enough.
#[test]
fn an_error_says_how_much_clearance_disks_that_wedge_need() {
    for kind in [RODS[0], RODS[1], ModelKind::PseudoRigidBody] {
        let Err(error) = pulled(kind, 0.0) else { panic!("{kind} has an answer") };
        let SolveError::Obstructed { why, .. } = &error else { panic!("{kind}: {error}") };
        let Obstruction::NoClearance { obstacle, clearance, enough, .. } = why else {
            panic!("{kind}: {error}")
        };
        assert_eq!((obstacle.as_str(), *clearance), ("bore", 0.0));
        assert!(error.to_string().contains("wedges"), "{error}");
        pulled(kind, *enough).unwrap_or_else(|error| panic!("{kind} {enough}: {error}"));
    }
}
