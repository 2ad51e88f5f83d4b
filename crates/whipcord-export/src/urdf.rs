//! URDF: links and revolute joints, and the joint angles of the shape beside it.

use serde_json::{Map, Value, json};
use whipcord::{Pose, Robot, Section, UnitQuaternion, Vec3};

use crate::chain::{Chain, Node};
use crate::error::ExportError;
use crate::files::{Exported, ExportedFile};
use crate::job::Job;
use crate::xml::{Element, check_name, numbers};

const FORMAT: &str = "URDF";
/// Programs that read URDF recurse from link to link.
const MOST_BODIES: usize = 2000;
/// Range of a joint in rad to either side; the angles of a shape stay within.
const RANGE: f64 = 1.5;
/// Effort in N·m and velocity in rad/s, which a revolute joint must limit.
const LIMITS: [f64; 2] = [1e3, 1e3];
/// Mass in kg and moment of inertia in kg·m² of links between the hinges of a joint; simulators take 1 kg for links without.
const VIRTUAL: [f64; 2] = [1e-9, 1e-12];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The robot as a serial chain, and a second file with the joint angles of each step of the case.
///
/// # Errors
/// [`ExportError`] for too many bodies and for a shape that the chain cannot take.
pub fn urdf(job: &Job<'_>, stem: &str) -> Result<Exported, ExportError> {
    let places = job.body_places(FORMAT, MOST_BODIES)?;
    let chain = Chain::new(job.robot, job.case, &places, None)?;
    let answers = job.solve(&places)?;
    let title = if check_name(job.title).is_ok() { job.title } else { "robot" };
    let mut root = Element::new("robot").with("name", title);
    root.push(Element::new("link").with("name", "world"));
    root.push(fixed("world", "node-0", job.case.base));
    // The frame of a link is that of its joint: where the body of the link before is in it.
    let mut last = Pose::IDENTITY;
    for (k, node) in chain.nodes.iter().enumerate() {
        let in_link = match k.checked_sub(1).and_then(|before| chain.joints.get(before)) {
            None => Pose::IDENTITY,
            Some(joint) => {
                let mut parent = format!("node-{}", k - 1);
                for (i, hinge) in joint.hinges().iter().enumerate() {
                    let name = joint_name(k, hinge.number);
                    let child = if i == 2 { format!("node-{k}") } else { format!("{name}-link") };
                    let at = if i == 0 { last * joint.before } else { Pose::IDENTITY };
                    root.push(revolute(&name, [&parent, &child], at, hinge.axis));
                    if i < 2 {
                        let [mass, inertia] = VIRTUAL;
                        let inertial = inertial(Vec3::ZERO, mass, Vec3::from([inertia; 3]));
                        root.push(Element::new("link").with("name", &child).and(inertial));
                    }
                    parent = child;
                }
                joint.after
            }
        };
        root.push(link(job.robot, &chain, k, node, in_link));
        if let Some(disk) = node.disk {
            let name = format!("disk-{}", disk + 1);
            root.push(Element::new("link").with("name", &name));
            root.push(fixed(&format!("node-{k}"), &name, in_link));
        }
        last = in_link;
    }
    let mut steps = Vec::new();
    let mut farthest = 0.0_f64;
    for solution in &answers.steps {
        let angles = chain.angles(&solution.shape)?;
        let poses = chain.poses(job.case.base, &angles);
        let apart = poses.iter().zip(solution.shape.positions());
        let distance = apart.map(|(pose, p)| (pose.position - p).norm()).fold(0.0, f64::max);
        farthest = farthest.max(distance);
        let mut joints = Map::new();
        for (k, (joint, angles)) in chain.joints.iter().zip(&angles).enumerate() {
            for (hinge, angle) in joint.hinges().iter().zip(angles) {
                joints.insert(joint_name(k + 1, hinge.number), json!(angle));
            }
        }
        steps.push(json!({ "joints": joints, "greatest_distance": distance }));
    }
    let angles: Value =
        json!({ "title": job.title, "model": job.model.kind().name(), "steps": steps });
    let lost = vec![
        "stiffness, cables, tensions, loads and obstacles: URDF has no words for them".to_owned(),
        format!(
            "stretch and shear, and bending within a body: at the joint angles the bodies lie within {:.3} mm of the shape",
            1e3 * farthest
        ),
    ];
    let files = vec![
        ExportedFile { name: format!("{stem}.urdf"), bytes: root.document()? },
        ExportedFile {
            name: format!("{stem}.joints.json"),
            bytes: format!("{angles:#}\n").into_bytes(),
        },
    ];
    Ok(Exported { files, lost })
}

fn joint_name(node: usize, axis: usize) -> String {
    format!("joint-{node}-{}", AXES[axis])
}

fn origin(pose: Pose) -> Element {
    let element = Element::new("origin").with_vector("xyz", pose.position);
    element.with_numbers("rpy", &roll_pitch_yaw(pose.rotation))
}

/// Angles about the fixed axes x, y and z, in this order.
fn roll_pitch_yaw(rotation: UnitQuaternion) -> [f64; 3] {
    let r = rotation.to_matrix().rows;
    let pitch = (-r[2].x).clamp(-1.0, 1.0).asin();
    if r[2].x.abs() > 1.0 - 1e-12 {
        // Roll and yaw turn about one axis.
        return [0.0, pitch, (-r[0].y).atan2(r[1].y)];
    }
    [r[2].y.atan2(r[2].z), pitch, r[1].x.atan2(r[0].x)]
}

fn joint(kind: &str, name: &str, [parent, child]: [&str; 2], at: Pose) -> Element {
    Element::new("joint")
        .with("name", name)
        .with("type", kind)
        .and(origin(at))
        .and(Element::new("parent").with("link", parent))
        .and(Element::new("child").with("link", child))
}

fn fixed(parent: &str, child: &str, at: Pose) -> Element {
    joint("fixed", &format!("{child}-fixed"), [parent, child], at)
}

fn revolute(name: &str, ends: [&str; 2], at: Pose, axis: Vec3) -> Element {
    let [effort, velocity] = LIMITS;
    let limit = Element::new("limit")
        .with("lower", -RANGE)
        .with("upper", RANGE)
        .with("effort", effort)
        .with("velocity", velocity);
    joint("revolute", name, ends, at).and(Element::new("axis").with_vector("xyz", axis)).and(limit)
}

fn inertial(center: Vec3, mass: f64, inertia: Vec3) -> Element {
    let least = |moment: f64| numbers(&[moment.max(VIRTUAL[1])]);
    let inertia = Element::new("inertia")
        .with("ixx", least(inertia.x))
        .with("ixy", 0)
        .with("ixz", 0)
        .with("iyy", least(inertia.y))
        .with("iyz", 0)
        .with("izz", least(inertia.z));
    Element::new("inertial")
        .and(origin(Pose { position: center, ..Pose::IDENTITY }))
        .and(Element::new("mass").with_numbers("value", &[mass.max(VIRTUAL[0])]))
        .and(inertia)
}

/// A body, whose frame in the link is `in_link`.
fn link(robot: &Robot, chain: &Chain, k: usize, node: &Node, in_link: Pose) -> Element {
    // The axes of the section are turned against those of the link by the small bend at rest alone.
    let mass = inertial(in_link.transform(node.center), node.mass, node.inertia);
    let mut link = Element::new("link").with("name", format!("node-{k}")).and(mass);
    let [from, to] = node.ends;
    let middle = Pose { position: (from + to) * 0.5, ..Pose::IDENTITY };
    let length = (to - from).norm();
    let stretch = match &robot.backbone().section {
        Some(Section::Rectangle { width, height }) => {
            let at = |along: &whipcord::Along<f64>| along.at(robot.disks(), node.arc_length);
            Some(Element::new("box").with_numbers("size", &[at(width), at(height), length]))
        }
        Some(Section::Round { .. }) => Some(cylinder(node.radius, length)),
        None => None,
    };
    let disk = node.disk.and_then(|disk| chain.plates.get(disk));
    let disk = disk.map(|plate| (in_link, cylinder(plate.radius, plate.thickness)));
    for (at, form) in stretch.map(|form| (in_link * middle, form)).into_iter().chain(disk) {
        for use_of in ["visual", "collision"] {
            let geometry = Element::new("geometry").and(form.clone());
            link.push(Element::new(use_of).and(origin(at)).and(geometry));
        }
    }
    link
}

fn cylinder(radius: f64, length: f64) -> Element {
    Element::new("cylinder").with_numbers("radius", &[radius]).with_numbers("length", &[length])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roll_pitch_yaw_give_the_rotation_back() {
        let about = |axis: Vec3, angle: f64| UnitQuaternion::exp(axis * angle);
        let right = core::f64::consts::FRAC_PI_2;
        for phi in [Vec3::new(0.3, -1.2, 2.0), Vec3::new(0.0, right, 0.0), Vec3::ZERO] {
            for turn in [UnitQuaternion::exp(phi), about(Vec3::Z, 0.7) * UnitQuaternion::exp(phi)] {
                let [roll, pitch, yaw] = roll_pitch_yaw(turn);
                let again = about(Vec3::Z, yaw) * about(Vec3::Y, pitch) * about(Vec3::X, roll);
                assert!((again.conjugate() * turn).log().norm() < 1e-7, "{phi:?}");
            }
        }
    }
}
