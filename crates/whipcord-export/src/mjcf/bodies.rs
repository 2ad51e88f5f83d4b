//! The bodies of the robot.

use whipcord::{Case, Pose, Robot, Section, Vec3};
use whipcord_plot::Colour;

use super::contact::Contact;
use super::names::{cable_site, node_site};
use crate::chain::{Chain, Joint, Node};
use crate::guides::Guide;
use crate::xml::{Element, numbers};

/// Radius of a backbone whose section is not given, as a part of its length; it touches nothing.
const DRAWN_RADIUS: f64 = 0.004;

/// Colours, and what touches what: the robot touches obstacles and objects, but not itself.
pub fn defaults(contact: Option<Contact>) -> Element {
    let class = |name: &str, geom: Element| Element::new("default").with("class", name).and(geom);
    let of_robot = |colour: Colour| {
        Element::new("geom")
            .with("contype", 1)
            .with("conaffinity", 0)
            .with("condim", 1)
            .with("friction", "0 0 0")
            .with("rgba", rgba(colour))
    };
    let all = contact.map(|contact| {
        Element::new("geom")
            .with_numbers("solref", &contact.reference())
            .with_numbers("solimp", &contact.impedance())
    });
    Element::new("default")
        .and_all(all)
        .and(class("backbone", of_robot(Colour::GREY)))
        .and(class("disk", of_robot(Colour::GRID)))
        .and(class(
            "obstacle",
            Element::new("geom")
                .with("contype", 0)
                .with("conaffinity", 3)
                .with("rgba", "0.7 0.75 0.8 0.6"),
        ))
        .and(class(
            "object",
            Element::new("geom")
                .with("contype", 2)
                .with("conaffinity", 3)
                .with("rgba", "0.8 0.7 0.5 1"),
        ))
}

/// A colour as MuJoCo has it.
pub fn rgba(colour: Colour) -> String {
    let [r, g, b] = [colour.red, colour.green, colour.blue].map(|part| f64::from(part) / 255.0);
    format!("{r:.3} {g:.3} {b:.3} 1")
}

/// Position and orientation of an element.
pub fn placed(element: Element, pose: Pose) -> Element {
    let element = element.with_vector("pos", pose.position);
    element.with_numbers("quat", &pose.rotation.wxyz())
}

/// The base with all bodies on it.
pub fn base(
    robot: &Robot,
    case: &Case,
    chain: &Chain,
    held: &[Vec<Guide>],
    contact: Option<Contact>,
) -> Element {
    let mut outer: Option<Element> = None;
    for (k, node) in chain.nodes.iter().enumerate().rev() {
        let name = if k == 0 { "base".to_owned() } else { format!("node:{k}") };
        let mut body = Element::new("body").with("name", name);
        match k.checked_sub(1).and_then(|before| chain.joints.get(before)) {
            None => body = placed(body, case.base),
            Some(joint) => {
                body = placed(body, joint.before * joint.after);
                body = body.and_all(hinges(k, joint, contact));
                body.push(inertial(node));
            }
        }
        body = body.and_all(geoms(robot, chain, node)).and_all(sites(robot, k, node, held));
        outer = Some(match outer.take() {
            Some(child) => body.and(child),
            None => body,
        });
    }
    outer.unwrap_or_default()
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn hinges(k: usize, joint: &Joint, contact: Option<Contact>) -> impl Iterator<Item = Element> {
    let in_body = joint.after.inverse();
    joint.hinges().into_iter().map(move |hinge| {
        let element = Element::new("joint")
            .with("name", format!("joint:{k}:{}", AXES[hinge.number]))
            .with("type", "hinge")
            .with_vector("pos", in_body.position)
            .with_vector("axis", in_body.rotation.rotate(hinge.axis))
            .with_numbers("stiffness", &[hinge.stiffness])
            .with_numbers("damping", &[hinge.damping]);
        match contact {
            Some(contact) => element.with_numbers("armature", &[contact.armature(hinge.stiffness)]),
            None => element,
        }
    })
}

fn inertial(node: &Node) -> Element {
    Element::new("inertial")
        .with_vector("pos", node.center)
        .with_numbers("mass", &[node.mass])
        .with_vector("diaginertia", node.inertia)
}

fn geoms(robot: &Robot, chain: &Chain, node: &Node) -> Vec<Element> {
    let [from, to] = node.ends;
    let stretch = Element::new("geom").with("class", "backbone");
    let capsule = |radius: f64| {
        let ends: Vec<f64> = from.to_array().into_iter().chain(to.to_array()).collect();
        stretch
            .clone()
            .with("type", "capsule")
            .with_numbers("fromto", &ends)
            .with_numbers("size", &[radius])
    };
    let mut geoms = Vec::new();
    match &robot.backbone().section {
        Some(Section::Rectangle { width, height }) => {
            let half =
                |along: &whipcord::Along<f64>| 0.5 * along.at(robot.disks(), node.arc_length);
            let size = [half(width), half(height), 0.5 * (to - from).norm()];
            let geom = stretch.clone().with("type", "box").with_vector("pos", (from + to) * 0.5);
            geoms.push(geom.with_numbers("size", &size));
        }
        Some(Section::Round { .. }) => geoms.push(capsule(node.radius)),
        None => {
            let drawn = capsule(DRAWN_RADIUS * robot.backbone().length);
            geoms.push(drawn.with("contype", 0));
        }
    }
    if let Some(plate) = node.disk.and_then(|disk| chain.plates.get(disk)) {
        let size = numbers(&[plate.radius, 0.5 * plate.thickness]);
        let disk = Element::new("geom").with("class", "disk").with("type", "cylinder");
        geoms.push(disk.with("size", size));
    }
    geoms
}

/// Sites of the disk, of the node, and of the cables.
fn sites(robot: &Robot, k: usize, node: &Node, held: &[Vec<Guide>]) -> Vec<Element> {
    let site = |name: String, at: Vec3| {
        let element = Element::new("site").with("name", name).with_vector("pos", at);
        element.with_numbers("size", &[0.002 * robot.backbone().length])
    };
    let mut sites = vec![site(node_site(k), Vec3::ZERO)];
    sites.extend(node.disk.map(|disk| site(format!("disk:{}", disk + 1), Vec3::ZERO)));
    for (cable, guides) in robot.cables().iter().zip(held) {
        let here = guides.iter().find(|guide| guide.place == k);
        sites.extend(here.map(|guide| site(cable_site(&cable.name, k), guide.offset)));
    }
    sites
}
