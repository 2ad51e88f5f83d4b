//! Pictures of robots among obstacles.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod common;

use std::sync::Arc;

use common::{before, prototype, towards, view};
use resvg::usvg::roxmltree::{Document, Node};
use whipcord::obstacle::{Bends, Mesh, Pipe, Superellipsoid};
use whipcord::{Contact, Form, ModelKind, Obstacle, Part, Pose, Robot, UnitQuaternion, Vec3};
use whipcord_plot::{FigureOptions, PlotError, RobotView, ViewStyle, png, robot_figure};

/// One of every form, in a row before and behind the robot.
fn forms() -> Vec<Form> {
    let bend = [Vec3::ZERO, Vec3::new(0.0, 0.0, 0.05), Vec3::new(0.02, 0.0, 0.09)];
    let pipe = |bends| Form::Pipe(Pipe::new(0.012, &bend, bends).unwrap());
    let pebble = Superellipsoid::new(Vec3::new(0.02, 0.015, 0.01), [0.3, 1.0]).unwrap();
    let corners = [Vec3::ZERO, Vec3::X * 0.03, Vec3::Y * 0.03, Vec3::Z * 0.03];
    let sides = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    vec![
        Form::HalfSpace,
        Form::Sphere { radius: 0.02 },
        Form::Capsule { radius: 0.01, length: 0.03 },
        Form::Box { size: Vec3::new(0.04, 0.03, 0.02) },
        Form::Cylinder { radius: 0.01, length: 0.04 },
        pipe(Bends::Smooth),
        pipe(Bends::Corners),
        Form::Superellipsoid(pebble),
        Form::Mesh(Arc::new(Mesh::new(&corners, &sides).unwrap())),
    ]
}

fn at(form: Form, position: Vec3) -> Obstacle {
    let rotation = UnitQuaternion::exp(Vec3::new(0.3, 0.2, 0.1));
    Obstacle {
        name: form.name().to_owned(),
        form,
        pose: Pose { position, rotation },
        friction: 0.0,
        movable: None,
    }
}

fn touch(obstacle: usize, force: Option<f64>) -> Contact {
    Contact {
        obstacle,
        part: Part::Disk(3),
        arc_length: 0.06,
        point: Vec3::new(0.01, 0.0, 0.06),
        normal: -Vec3::X,
        force,
        friction: None,
        sticks: false,
        gap: 0.0,
    }
}

fn robot() -> (Robot, Vec<RobotView>) {
    let robot = prototype(&[4; 10]).unwrap();
    let bent =
        view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |_| towards(0.4, 6.0));
    let views = vec![before(&robot), bent];
    (robot, views)
}

fn figure(obstacles: Vec<Obstacle>, contacts: Vec<Contact>) -> String {
    let (robot, views) = robot();
    let options = FigureOptions { obstacles, contacts, ..FigureOptions::default() };
    robot_figure(&robot, &views, &options).unwrap()
}

fn class<'a, 'b: 'a>(document: &'a Document<'b>, class: &str) -> Vec<Node<'a, 'b>> {
    document.descendants().filter(|n| n.attribute("class") == Some(class)).collect()
}

/// Every form is drawn in all four views, with finite coordinates, the same each time.
#[test]
fn every_form_is_drawn_in_every_view() {
    for form in forms() {
        let name = form.name();
        let draw = || figure(vec![at(form.clone(), Vec3::new(0.03, 0.02, 0.05))], vec![]);
        let svg = draw();
        assert_eq!(svg, draw(), "{name}");
        let document = Document::parse(&svg).unwrap();
        for value in document.descendants().flat_map(|n| n.attributes()).map(|a| a.value()) {
            assert!(!value.contains("NaN") && !value.contains("inf"), "{name}: {value}");
        }
        for view in ["space", "xz", "yz", "xy"] {
            let drawn: Vec<_> = ["behind", "before"]
                .iter()
                .flat_map(|depth| class(&document, &format!("{depth}-{view}")))
                .collect();
            assert_eq!(drawn.len(), 1, "{name}, {view}");
            assert!(drawn[0].children().filter(Node::is_element).count() > 0, "{name}, {view}");
        }
        assert!(svg.contains(&format!("obstacle {name}")), "{name}");
        assert!(png(&svg, 1.0).unwrap().len() > 1000, "{name}");
    }
}

/// Obstacles are drawn but do not crowd the robot out: one that is huge is drawn in part.
#[test]
fn a_huge_obstacle_leaves_the_robot_its_size() {
    let small = figure(vec![at(Form::Sphere { radius: 0.02 }, Vec3::X * 0.05)], vec![]);
    let huge = figure(vec![at(Form::Sphere { radius: 1e4 }, Vec3::X * (1e4 + 0.04))], vec![]);
    let backbone = |svg: &str| {
        let document = Document::parse(svg).unwrap();
        let lines = class(&document, "backbone");
        let widths = lines.iter().filter_map(|n| n.attribute("stroke-width")?.parse().ok());
        widths.fold(0.0, f64::max)
    };
    assert!(backbone(&huge) > 0.4 * backbone(&small), "{} {}", backbone(&huge), backbone(&small));
}

#[test]
fn contacts_have_their_forces() {
    let ball = || vec![at(Form::Sphere { radius: 0.02 }, Vec3::new(0.03, 0.0, 0.06))];
    let svg = figure(ball(), vec![touch(0, Some(1.25)), touch(0, Some(0.5))]);
    let document = Document::parse(&svg).unwrap();
    let groups = class(&document, "contacts");
    assert_eq!(groups.len(), 4);
    assert!(svg.contains("contacts") && svg.contains("contact forces up to 1.25 N"), "{svg}");
    let geometric = figure(ball(), vec![touch(0, None)]);
    assert!(geometric.contains(">contact<") && !geometric.contains("contact force"));
    assert!(
        figure(vec![], vec![]) == figure(vec![], vec![])
            && !figure(vec![], vec![]).contains("class=\"contacts\"")
    );
}

#[test]
fn many_obstacles_share_an_entry() {
    let row = |k: u32| at(Form::Sphere { radius: 0.01 }, Vec3::new(0.05, 0.0, 0.03 * f64::from(k)));
    assert!(figure((0..5).map(row).collect(), vec![]).contains("5 obstacles"));
}

#[test]
fn a_force_that_is_none_is_refused() {
    let (robot, views) = robot();
    let contacts = vec![touch(0, Some(f64::NAN))];
    let options = FigureOptions { contacts, ..FigureOptions::default() };
    let refused = robot_figure(&robot, &views, &options);
    assert!(matches!(refused, Err(PlotError::NotFinite { .. })), "{refused:?}");
}
