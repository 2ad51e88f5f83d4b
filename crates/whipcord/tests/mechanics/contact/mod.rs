//! Robots among obstacles.

mod bore;
mod cables;
mod cosserat;
mod cosserat_disks;
mod cylinder;
mod edges;
mod energy;
mod four_bar;
mod free_path;
mod friction;
mod grasp;
mod hole_friction;
mod limits;
mod movable;
mod overlap;
mod pipe;
mod sections;
mod stability;

use whipcord::obstacle::Mesh;
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Form, Loads, Material, Model, ModelKind, Obstacle,
    PointLoad, Pose, Robot, Routing, Section, Shape, Solution, Stations, UnitQuaternion, Vec3,
    Wrench,
};

/// Of the finger, in m.
const LENGTH: f64 = 0.18;
/// EI of the finger.
const STIFFNESS: f64 = 1.1e9 * core::f64::consts::PI * 0.003 * 0.003 * 0.003 * 0.003 / 64.0;

/// A finger of the paper's material with one straight cable at +x.
pub fn finger(sections: usize) -> Robot {
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone { material, section, ..Backbone::new(LENGTH) };
    let disks = Disks {
        outer_radius: Some(0.01),
        thickness: Some(0.002),
        ..Disks::equally_spaced(LENGTH, sections + 1, 0.008)
    };
    let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

pub fn sphere(position: Vec3, radius: f64) -> Obstacle {
    Obstacle {
        name: "ball".to_owned(),
        form: Form::Sphere { radius },
        pose: Pose { position, rotation: UnitQuaternion::IDENTITY },
        friction: 0.0,
        movable: None,
    }
}

/// A closed cube around the origin.
pub fn cube(edge: f64) -> Mesh {
    let h = 0.5 * edge;
    let corner = |k: u32| Vec3::from([0, 1, 2].map(|i| if k >> i & 1 == 1 { h } else { -h }));
    let vertices: Vec<Vec3> = (0..8).map(corner).collect();
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> =
        sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(&vertices, &triangles).unwrap()
}

/// A wall at x whose free side is that of smaller x.
pub fn wall(x: f64) -> Obstacle {
    let quarter = Vec3::new(0.0, -core::f64::consts::FRAC_PI_2, 0.0);
    Obstacle {
        name: "wall".to_owned(),
        form: Form::HalfSpace,
        pose: Pose { position: Vec3::new(x, 0.0, 0.0), rotation: UnitQuaternion::exp(quarter) },
        friction: 0.0,
        movable: None,
    }
}

pub fn among(case: Case, obstacles: Vec<Obstacle>) -> Case {
    Case { obstacles, ..case }
}

/// The obstacle with the world moved under it.
fn moved(obstacle: &Obstacle, by: &Pose) -> Obstacle {
    Obstacle { pose: *by * obstacle.pose, ..obstacle.clone() }
}

/// The contacts of an answer whose base is at the origin, as point loads, and their resultant there.
pub fn pushes_of(solution: &Solution) -> (Loads, Wrench) {
    let mut loads = Loads::default();
    let mut total = Wrench::default();
    for touch in &solution.contacts {
        let force = touch.normal * touch.force.unwrap() + touch.friction.unwrap();
        let Shape { arc_length, poses } = &solution.disks;
        let disk = arc_length.iter().position(|&s| s == touch.arc_length).unwrap();
        let centre = poses[disk].position;
        let moment = (touch.point - centre).cross(force);
        loads.points.push(PointLoad { at: touch.arc_length, force, moment, follower: false });
        total.force += force;
        total.moment += touch.point.cross(force);
    }
    (loads, total)
}

/// The base of the finger bears what pushes and rubs it, and the rod under these forces as point loads has the shape
/// that was found.
fn assert_forces_hold(kind: ModelKind, robot: &Robot, case: &Case, solution: &Solution) {
    let (loads, total) = pushes_of(solution);
    let base = solution.base_wrench.unwrap();
    assert!((base.force - total.force).norm() < 1e-6 * STIFFNESS / (LENGTH * LENGTH));
    assert!((base.moment - total.moment).norm() < 1e-6 * STIFFNESS / LENGTH);
    let free = Case { obstacles: vec![], loads, ..case.clone() };
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let again = model.prepare(robot, &free.loads).unwrap().solve(&free, Some(solution)).unwrap();
    let apart = again.disks.distances(&solution.disks).fold(0.0, f64::max);
    assert!(apart < 1e-6 * LENGTH, "{apart}");
}

/// No disk overlaps the obstacle: every point of its flat inside is farther away than its rounding.
fn assert_clear(robot: &Robot, solution: &Solution, obstacle: &Obstacle) {
    let rounding = 0.5 * robot.disks().thickness.unwrap();
    let flat = robot.disks().outer_radius.unwrap() - rounding;
    for pose in &solution.disks.poses[1..] {
        for k in 0..360 {
            for part in [0.5, 1.0] {
                let (sin, cos) = f64::from(k).to_radians().sin_cos();
                let point = pose.transform(Vec3::new(cos, sin, 0.0) * (part * flat));
                let gap = obstacle.surface(point).distance - rounding;
                assert!(gap > -1e-6 * robot.backbone().length, "{gap} at {point:?}");
            }
        }
    }
}
