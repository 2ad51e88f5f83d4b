//! Robots and made-up shapes for tests and for the gallery.
#![allow(dead_code, reason = "each user takes a part")]

use whipcord::{
    Along, Backbone, Cable, Disks, Pose, Robot, RobotError, Routing, Section, Shape, Vec3,
};
use whipcord_numerics::Twist;
use whipcord_plot::{CableCourse, RobotView, ViewStyle};

/// A shape of this curvature (1/m, body frame) at each arc length, at `count` stations.
pub fn bent(length: f64, count: usize, curvature: impl Fn(f64) -> Vec3) -> Shape {
    let step = length / (count - 1) as f64;
    let mut pose = Pose::IDENTITY;
    let mut shape = Shape::default();
    for i in 0..count {
        let s = step * i as f64;
        shape.arc_length.push(s);
        shape.poses.push(pose);
        let angular = curvature(s + 0.5 * step) * step;
        pose = pose * Pose::exp(Twist { linear: Vec3::Z * step, angular });
    }
    shape
}

/// The stations of a dense shape that lie nearest to the disks.
pub fn at_disks(robot: &Robot, shape: &Shape) -> Shape {
    let mut disks = Shape::default();
    for &s in &robot.disks().arc_lengths {
        let distance = |i: &usize| (shape.arc_length[*i] - s).abs();
        let nearest = (0..shape.poses.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        disks.arc_length.push(s);
        disks.poses.push(shape.poses[nearest.unwrap_or(0)]);
    }
    disks
}

/// A view of a robot with this curvature.
pub fn view(
    robot: &Robot,
    label: &str,
    style: ViewStyle,
    curvature: impl Fn(f64) -> Vec3,
) -> RobotView {
    let shape = bent(robot.backbone().length, 361, curvature);
    RobotView {
        label: label.into(),
        disks: at_disks(robot, &shape),
        shape,
        cables: CableCourse::Smooth,
        style,
    }
}

/// The straight robot.
pub fn before(robot: &Robot) -> RobotView {
    view(robot, "before actuation", ViewStyle::Before, |_| Vec3::ZERO)
}

/// The paper's prototype with one cable.
pub fn prototype(holes: &[usize]) -> Result<Robot, RobotError> {
    let backbone = Backbone { section: Some(Section::circle(0.003)), ..Backbone::new(0.18) };
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    Robot::new(backbone, disks, vec![Cable::new("pull", Routing::holes(holes.to_vec()))])
}

/// Two segments with three cables each, the first three of which end midway.
pub fn arm() -> Result<Robot, RobotError> {
    let backbone = Backbone {
        section: Some(Section::Round {
            outer: Along::PerDisk((0..17).map(|i| 0.03 - 0.001 * f64::from(i)).collect()),
            inner: 0.008.into(),
        }),
        ..Backbone::new(2.0)
    };
    let mut disks = Disks::equally_spaced(2.0, 17, 0.08).with_holes(6);
    for (i, radius) in disks.hole_circle_radii.iter_mut().enumerate() {
        *radius = 0.08 - 0.002 * i as f64;
    }
    let cables = (0..6)
        .map(|k| {
            let count = if k % 2 == 0 { 9 } else { 17 };
            Cable::new(format!("{}", k + 1), Routing::holes(vec![k + 1; count]))
        })
        .collect();
    Robot::new(backbone, disks, cables)
}

/// A thin catheter with a disk at each end and no holes.
pub fn catheter() -> Result<Robot, RobotError> {
    let backbone = Backbone { section: Some(Section::tube(0.0012, 0.0008)), ..Backbone::new(0.12) };
    let disks = Disks { hole_circle_radii: vec![], ..Disks::equally_spaced(0.12, 2, 1.0) };
    let cable = Cable::new("steer", Routing::Straight { angle: 0.0, radius: 0.0009 });
    Robot::new(backbone, disks, vec![cable])
}

/// A flat strip with a helical and a converging cable, which curls up.
pub fn finger() -> Result<Robot, RobotError> {
    let backbone =
        Backbone { section: Some(Section::rectangle(0.006, 0.001)), ..Backbone::new(0.06) };
    let helix = Routing::Helix { start_angle: 0.0, turns: 1.25, radius: 0.006 };
    let line = Routing::Linear { start: [-0.006, 0.0], end: [0.0, -0.002] };
    let cables = vec![Cable::new("wind", helix), Cable::new("curl", line)];
    Robot::new(backbone, Disks::equally_spaced(0.06, 7, 0.006).with_holes(4), cables)
}

/// The curvature of a robot whose cable pulls at this angle with this bend per metre.
pub fn towards(angle: f64, bend: f64) -> Vec3 {
    Vec3::new(-angle.sin(), angle.cos(), 0.0) * bend
}
