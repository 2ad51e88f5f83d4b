//! Where the robot touches obstacles, and how strongly they push it.

use whipcord::{Contact, Vec3};

use crate::colour::Colour;
use crate::legend::{Entry, Swatch};
use crate::load_marks::{ArrowLook, draw_arrow};
use crate::marker::Marker;
use crate::projection::Projection;
use crate::svg::{Fill, Stroke, Svg};
use crate::unit;

/// Length of the longest arrow relative to the extent of the robot.
const LONGEST: f64 = 0.16;
/// No arrow is shorter than this part of it.
const SHORTEST: f64 = 0.25;
/// Radius of a point in px.
const POINT: f64 = 2.6;
const CONTACT: Colour = Colour::new(0xc4, 0x1a, 0x1a);
const ARROW: ArrowLook = ArrowLook { colour: CONTACT, width: 1.4, heads: 1, hollow: false };

/// Touches in the size in which they are drawn.
#[derive(Clone, Debug)]
pub(crate) struct TouchMarks {
    /// Where each is, and where its arrow begins, if it has one.
    marks: Vec<(Vec3, Option<Vec3>)>,
}

impl TouchMarks {
    /// On a robot of this extent in m.
    pub fn new(contacts: &[Contact], extent: f64) -> Self {
        let largest = largest(contacts);
        let marks = contacts.iter().map(|touch| {
            // An arrow pushes from within the obstacle. A place that is merely touched has none.
            let tail = push(touch).map(|(size, way)| {
                touch.point - way * (LONGEST * extent * (size / largest).max(SHORTEST))
            });
            (touch.point, tail)
        });
        Self { marks: marks.collect() }
    }

    /// Points that span what is drawn of them.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.marks.iter().flat_map(|&(point, tail)| [Some(point), tail]).flatten()
    }

    /// What the marks mean, and how large the largest force is.
    pub fn legend(contacts: &[Contact]) -> Vec<Entry> {
        if contacts.is_empty() {
            return Vec::new();
        }
        let point = Swatch::Marker(Marker::Circle, Fill::new(CONTACT), None);
        let label = if contacts.len() == 1 { "contact" } else { "contacts" };
        let mut entries = vec![Entry { label: label.to_owned(), swatches: vec![point] }];
        let forces: Vec<f64> = contacts.iter().filter_map(push).map(|(size, _)| size).collect();
        let largest = largest(contacts);
        if largest > 0.0 {
            let up_to = if forces.len() > 1 { "forces up to" } else { "force" };
            let label = format!("contact {up_to} {}", unit::written(largest, unit::force(largest)));
            entries.push(Entry { label, swatches: vec![Swatch::Arrow(ARROW)] });
        }
        entries
    }

    pub fn draw(&self, svg: &mut Svg, view: &Projection) {
        if self.marks.is_empty() {
            return;
        }
        svg.open("contacts");
        for &(point, tail) in &self.marks {
            let at = view.place(point);
            if let Some(tail) = tail {
                let towards = view.depth(point) - view.depth(tail);
                draw_arrow(svg, view.place(tail), at, towards, ARROW);
            }
            let rim = Stroke::new(Colour::WHITE, 0.7);
            svg.circle(at, POINT, Some(Fill::new(CONTACT)), Some(rim));
        }
        svg.close();
    }
}

/// With how much in N, and along which unit vector, a touch pushes and rubs the robot.
fn push(touch: &Contact) -> Option<(f64, Vec3)> {
    let force = touch.force.filter(|&force| force > 0.0)?;
    let total = touch.normal * force + touch.friction.unwrap_or_default();
    let size = total.norm();
    Some((size, total / size))
}

fn largest(contacts: &[Contact]) -> f64 {
    contacts.iter().filter_map(push).map(|(size, _)| size).fold(0.0, f64::max)
}
