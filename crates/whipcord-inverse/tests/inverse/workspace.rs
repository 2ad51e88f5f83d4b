//! Workspaces against closed forms, dense samples and finer voxels.

use std::collections::BTreeSet;
use std::time::Instant;

use whipcord::{
    Actuation, Backbone, Case, Form, Loads, Model, ModelKind, Obstacle, Pose, Robot,
    UnitQuaternion, Vec3,
};
use whipcord_inverse::{
    BoundaryPoint, CableLimits, CommandedBy, InverseError, InverseSolver, Limits, Workspace,
    WorkspaceOptions,
};

use crate::planted::Random;
use crate::robots;

pub fn survey(robot: &Robot, case: &Case, greatest: f64, options: &WorkspaceOptions) -> Workspace {
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let limits = CableLimits { tension: [0.0, greatest], ..CableLimits::default() };
    let limits = Limits::uniform(robot.cables().len(), limits);
    let mut solver =
        InverseSolver::new(&model, robot, case, &limits, CommandedBy::Tensions).unwrap();
    solver.workspace(options).unwrap()
}

/// Three straight cables of a rod that neither stretches nor shears bend it to arcs: the moments are a hexagon, and its image under
/// the arc's closed form is the surface.
#[test]
fn the_area_of_three_cables_is_that_of_their_arcs() {
    let (length, radius, greatest) = (robots::LENGTH, 0.008, 2.0);
    let backbone = Backbone { extensible: false, shearable: false, ..robots::backbone(0.003) };
    let cables =
        (0..3).map(|k| robots::straight(&format!("s{k}"), 120.0 * f64::from(k), None)).collect();
    let robot = Robot::new(backbone, robots::disks(), cables).unwrap();
    let bending = 1.1e9 * core::f64::consts::PI * 0.003_f64.powi(4) / 64.0;
    let tip = |x: f64, y: f64| {
        let curvature = x.hypot(y).max(1e-9);
        let angle = curvature * length;
        let out = (1.0 - angle.cos()) / curvature;
        Vec3::new(out * x / curvature, out * y / curvature, angle.sin() / curvature)
    };
    // The hexagon of all Σ τᵢ rᵢ with 0 ≤ τᵢ ≤ T: points whose distance along each cable's normal is within its range.
    let reach = greatest * radius / bending;
    let is_inside = |x: f64, y: f64| {
        (0..3).all(|k| {
            let (sin, cos) = (2.0 * core::f64::consts::PI * f64::from(k) / 3.0).sin_cos();
            (y * cos - x * sin).abs() <= reach * (0.75_f64).sqrt()
        })
    };
    let count = 400;
    let step = 2.2 * reach / f64::from(count);
    let mut area = 0.0;
    for i in 0..count {
        for j in 0..count {
            let at = |i: i32| -1.1 * reach + step * (f64::from(i) + 0.5);
            let (x, y) = (at(i), at(j));
            if is_inside(x, y) {
                let h = 0.1 * step;
                let dx = (tip(x + h, y) - tip(x - h, y)) * (0.5 / h);
                let dy = (tip(x, y + h) - tip(x, y - h)) * (0.5 / h);
                area += dx.cross(dy).norm() * step * step;
            }
        }
    }
    let options = WorkspaceOptions { voxel: Some(0.002), ..WorkspaceOptions::default() };
    let found = survey(&robot, &Case::default(), greatest, &options);
    assert!(found.is_complete);
    assert_eq!(found.dimension, 2);
    assert!((found.measure / area - 1.0).abs() < 0.05, "{} {area}", found.measure);
}

#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn compare_with_samples(name: &str, robot: &Robot, greatest: f64, voxel: f64) -> Workspace {
    let clock = Instant::now();
    let options = WorkspaceOptions { voxel: Some(voxel), ..WorkspaceOptions::default() };
    let found = survey(robot, &Case::default(), greatest, &options);
    println!(
        "{name}: {:.2} s, {} voxels, dimension {}, measure {:.4e}, {} boundary points, {} solves",
        clock.elapsed().as_secs_f64(),
        found.cells.len(),
        found.dimension,
        found.measure,
        found.boundary.len(),
        found.solves,
    );
    assert!(found.is_complete);
    let cells: BTreeSet<[i32; 3]> = found.cells.iter().map(|cell| cell.index).collect();
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let mut prepared = model.prepare(robot, &Case::default().loads).unwrap();
    let mut random = Random(77);
    let mut missed = 0;
    for _ in 0..5000 {
        let tensions = random.tensions(robot.cables().len(), greatest);
        let shape = prepared.solve(&Case::with_tensions(&tensions), None).unwrap();
        let tip = shape.disks.poses.last().unwrap().position;
        let index = tip.to_array().map(|x| (x / voxel).floor() as i32);
        missed += usize::from(!cells.contains(&index));
    }
    // A voxel of which the workspace has a corner may be missed.
    assert!(missed <= 25, "{name}: {missed}");
    for cell in found.cells.iter().step_by(37) {
        let shape = prepared.solve(&Case::with_tensions(&cell.commands), None).unwrap();
        let off = shape.disks.poses.last().unwrap().position - cell.tip;
        assert!(off.norm() < 1e-4 * robots::LENGTH);
        assert!(cell.commands.iter().all(|tension| (0.0..=greatest).contains(tension)));
    }
    found
}

#[test]
fn sampled_tips_are_in_the_workspace() {
    compare_with_samples("two segments", &robots::two_segments(), 2.0, 0.012);
    compare_with_samples("three straight", &robots::three_straight(), 2.0, 0.008);
}

#[test]
#[ignore = "minutes"]
#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn study_of_workspaces() {
    let only = std::env::var("ROBOT").ok();
    let robots = robots::all().into_iter().filter(|(_, robot, _)| robot.motors().is_empty());
    for (name, robot, greatest) in
        robots.filter(|(name, ..)| only.as_deref().is_none_or(|o| o == *name))
    {
        let coarse = compare_with_samples(name, &robot, greatest, 0.008);
        let fine = compare_with_samples(name, &robot, greatest, 0.004);
        println!("{name}: halved, the measure is {:.3} of it", fine.measure / coarse.measure);
    }
}

/// Under a force on the tip.
#[test]
#[ignore = "a minute"]
#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn study_of_loaded_workspaces() {
    let only = std::env::var("ROBOT").ok();
    let shapes = std::env::var("SHAPES").ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    let robots = robots::all().into_iter().filter(|(_, robot, _)| robot.motors().is_empty());
    for (name, robot, greatest) in
        robots.filter(|(name, ..)| only.as_deref().is_none_or(|o| o == *name))
    {
        let case = Case { loads: robots::load(), ..Case::default() };
        let clock = Instant::now();
        let options =
            WorkspaceOptions { voxel: Some(0.008), shapes, ..WorkspaceOptions::default() };
        let found = survey(&robot, &case, greatest, &options);
        println!(
            "{name}: {:.2} s, {} voxels, dimension {}, measure {:.4e}, {} boundary points, {} solves",
            clock.elapsed().as_secs_f64(),
            found.cells.len(),
            found.dimension,
            found.measure,
            found.boundary.len(),
            found.solves,
        );
    }
}

#[test]
fn obstacles_take_their_part_of_the_workspace() {
    let robot = robots::two_segments();
    let wall = Obstacle {
        name: "wall".to_owned(),
        form: Form::HalfSpace,
        // What has x < 0.03 is free.
        pose: Pose {
            position: Vec3::new(0.03, 0.0, 0.0),
            rotation: UnitQuaternion::exp(Vec3::new(0.0, -core::f64::consts::FRAC_PI_2, 0.0)),
        },
        friction: 0.0,
        movable: None,
    };
    let case = Case { obstacles: vec![wall], ..Case::default() };
    let options =
        WorkspaceOptions { voxel: Some(0.018), shapes: 20_000, ..WorkspaceOptions::default() };
    let free = survey(&robot, &Case::default(), 2.0, &options);
    let walled = survey(&robot, &case, 2.0, &options);
    assert!(walled.cells.len() < free.cells.len() && walled.cells.len() > free.cells.len() / 4);
    assert!(walled.extent[1].x < 0.03 && free.extent[1].x > 0.05);
}

/// What the commands of each voxel lead to from rest is stable, within all limits and in the voxel; threads change nothing.
#[test]
fn the_commands_of_each_voxel_keep_the_limits_under_load() {
    let robot = robots::two_segments();
    let loads = Loads { tip_force: Vec3::new(0.05, -0.05, -0.1), ..Loads::default() };
    let case = Case { loads: loads.clone(), ..Case::default() };
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let greatest = 0.05 * robots::LENGTH;
    let limits = CableLimits {
        tension: [0.1, 20.0],
        shortening: [-1.0, greatest],
        ..CableLimits::default()
    };
    let limits = Limits::uniform(robot.cables().len(), limits);
    let options =
        WorkspaceOptions { voxel: Some(0.015), shapes: 2000, ..WorkspaceOptions::default() };
    let survey = || {
        let by = CommandedBy::Tensions;
        let mut solver = InverseSolver::new(&model, &robot, &case, &limits, by).unwrap();
        solver.workspace(&options).unwrap()
    };
    let found = survey();
    assert!(found.is_complete && found.cells.len() > 200, "{}", found.cells.len());
    let full = found.cells.iter().filter(|cell| cell.is_full);
    let full: BTreeSet<[i32; 3]> = full.map(|cell| cell.index).collect();
    assert!(!full.is_empty());
    // Where the tip gets to a centre nothing holds it back on the way.
    for BoundaryPoint { tip, normal, .. } in &found.boundary {
        let beyond = |part: f64| {
            let at = *tip + *normal * (part * 0.015);
            at.to_array().map(|x| (x / 0.015).floor() as i32)
        };
        let centre = |index: [i32; 3]| index.map(|i| (f64::from(i) + 0.5) * 0.015);
        for index in (1..=20).map(|k| beyond(0.05 * f64::from(k))) {
            let out = Vec3::from(centre(index)) - *tip;
            let is_its_own = out.norm() > 1e-9 && out.cross(*normal).norm() < 1e-6 * out.norm();
            assert!(!(is_its_own && full.contains(&index)), "{tip:?}");
        }
    }
    let mut prepared = model.prepare(&robot, &loads).unwrap();
    for cell in &found.cells {
        let case = Case { loads: loads.clone(), ..Case::with_tensions(&cell.commands) };
        let shape = prepared.solve(&case, None).unwrap();
        assert!(!shape.diagnostics.is_unstable());
        let tip = shape.disks.poses.last().unwrap().position;
        assert!((tip - cell.tip).norm() < 1e-4 * robots::LENGTH);
        assert!(cell.commands.iter().all(|tension| (0.1..=20.0).contains(tension)));
        for cable in &shape.cables {
            let shortening = cable.initial_length - cable.length;
            assert!(shortening <= greatest + 1e-5 * robots::LENGTH, "{shortening}");
        }
    }
    let again = survey();
    assert_eq!(found.cells, again.cells);
    assert_eq!(found.boundary, again.boundary);
    assert_eq!(found.solves, again.solves);
}

#[test]
fn voxels_that_are_none_are_refused() {
    let robot = robots::three_straight();
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let limits = Limits::uniform(3, CableLimits::default());
    let case = Case::default();
    let mut solver =
        InverseSolver::new(&model, &robot, &case, &limits, CommandedBy::Tensions).unwrap();
    for voxel in [0.0, -1.0, f64::NAN, 1e-9] {
        let options = WorkspaceOptions { voxel: Some(voxel), ..WorkspaceOptions::default() };
        assert!(matches!(solver.workspace(&options), Err(InverseError::Voxel { .. })));
    }
}
