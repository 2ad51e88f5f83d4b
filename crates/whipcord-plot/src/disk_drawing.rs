//! Drawings of the disks of a robot, with their holes and the cables through them.

use core::f64::consts::TAU;

use whipcord::{Robot, Routing};

use crate::drafting::{DraftForm, DraftLayer, Drafting, LETTER};

/// What drawings of disks show beside what the robot says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiskDrawingOptions {
    /// Diameter of the holes in m; a third of their distance, and 1 mm at most, where none is given.
    pub hole_diameter: Option<f64>,
}

/// From m to mm.
const MM: f64 = 1e3;
/// Height of the letters in mm, of the title and of notes.
const TITLE: f64 = 3.0;
const NOTE: f64 = 1.8;
/// Width of a sheet in mm: A4 without margins.
const SHEET: f64 = 190.0;
/// Between disks on a sheet, in mm.
const GAP: f64 = 8.0;

/// One disk of a robot in mm, seen from the tip towards the base as the angles of holes are counted, with the x axis to the right.
///
/// The rim, the hole for the backbone and all holes are to be cut; a hole with a cable has a second circle and the name of the cable, and dashed lines
/// lead to where the cable goes through the next disk.
#[must_use]
pub fn disk_drawing(robot: &Robot, disk: usize, options: &DiskDrawingOptions) -> Drafting {
    let disks = robot.disks();
    let mut drawing = Drafting::default();
    let s = disks.arc_lengths[disk];
    let hole_radius = 0.5 * MM * hole_diameter(robot, options);
    let backbone = MM * robot.backbone().outer_radius_at(disks, s);
    let passed = passed(robot, disk);
    let farthest = passed.iter().map(|of| of.at[0].hypot(of.at[1])).fold(0.0, f64::max);
    let circle = disks.hole_circle_radii.get(disk).map_or(0.0, |radius| MM * radius);
    // Where no outer radius is given there is material round the holes.
    let rim = match disks.outer_radius {
        Some(radius) => MM * radius,
        None => circle.max(farthest).max(backbone) + 3.0 * hole_radius,
    };
    let mut cut = |centre: [f64; 2], radius: f64| {
        drawing.add(DraftLayer::Cut, DraftForm::Circle { centre, radius });
    };
    cut([0.0, 0.0], rim);
    if backbone > 0.0 {
        cut([0.0, 0.0], backbone);
    }
    // Of a robot whose cables all have places of their own the numbered holes would only be in the way.
    let is_numbered = |cable: &whipcord::Cable| matches!(cable.routing, Routing::Holes { .. });
    let has_numbers = robot.cables().is_empty() || robot.cables().iter().any(is_numbered);
    let holes = disks.holes.filter(|_| circle > 0.0 && has_numbers).unwrap_or(0);
    for hole in 0..holes {
        cut(place(hole, holes, circle), hole_radius);
    }
    for of in &passed {
        if of.hole.is_none() {
            cut(of.at, hole_radius);
        }
    }
    for hole in (0..holes).filter(|hole| holes <= 24 || hole % (holes / 12).max(1) == 0) {
        let is_free = passed.iter().all(|of| of.hole != Some(hole + 1));
        if is_free {
            let inner = (circle - 2.2 * hole_radius - 0.5 * NOTE).max(0.3 * circle);
            note(&mut drawing, place(hole, holes, inner), 0.8 * NOTE, (hole + 1).to_string());
        }
    }
    // Where the names of cables are, by the places of these.
    let mut named: Vec<([f64; 2], f64)> = Vec::new();
    for of in &passed {
        let centre = of.at;
        let form = DraftForm::Circle { centre, radius: 1.5 * hole_radius };
        drawing.add(DraftLayer::Cables, form);
        let size = 0.8 * hole_radius;
        for by in [[size, 0.0], [0.0, size]] {
            let from = [centre[0] - by[0], centre[1] - by[1]];
            let to = [centre[0] + by[0], centre[1] + by[1]];
            drawing.add(DraftLayer::Cables, DraftForm::Line { from, to });
        }
        let distance = centre[0].hypot(centre[1]).max(1e-9);
        let words = match of.hole {
            Some(hole) => format!("{}: {hole}", of.name),
            None => of.name.clone(),
        };
        // Beside the rim, however long the words are.
        let half = [0.5 * LETTER * NOTE * words.chars().count() as f64, 0.5 * NOTE];
        let towards = centre.map(|along| along / distance);
        let out = rim + 0.4 * NOTE + half[0] * towards[0].abs() + half[1] * towards[1].abs();
        // Behind the name of another cable at the same place.
        let [x, mut y] = towards.map(|along| out * along);
        let near = |(at, _): &&([f64; 2], f64)| (at[0] - centre[0]).hypot(at[1] - centre[1]) < NOTE;
        if let Some((_, before)) = named.iter().rev().find(near) {
            let line = 1.2 * NOTE;
            y = if towards[1] < 0.0 { y.min(before - line) } else { y.max(before + line) };
        }
        named.push((centre, y));
        note(&mut drawing, [x, y], NOTE, words);
        if let Some(next) = of.next {
            drawing.add(DraftLayer::Courses, DraftForm::Line { from: centre, to: next });
        }
    }
    // The x axis, from which the holes are counted.
    let mark = DraftForm::Line { from: [rim - 2.0 * hole_radius, 0.0], to: [rim, 0.0] };
    drawing.add(DraftLayer::Notes, mark);
    let role = match disk {
        0 => ", base",
        disk if disk + 1 == disks.count() => ", tip",
        _ => "",
    };
    let title = format!("disk {}{role}, at {} mm", disk + 1, trimmed(MM * s));
    let form = DraftForm::Text {
        at: [0.0, -rim - 2.5 * NOTE - TITLE],
        height: TITLE,
        is_centred: true,
        text: title,
    };
    drawing.add(DraftLayer::Notes, form);
    drawing
}

/// All disks of a robot on one sheet as wide as A4, with a line of 50 mm to check the scale by.
#[must_use]
pub fn disk_sheet(robot: &Robot, title: &str, options: &DiskDrawingOptions) -> Drafting {
    let drawings: Vec<Drafting> =
        (0..robot.disks().count()).map(|disk| disk_drawing(robot, disk, options)).collect();
    let size = |drawing: &Drafting| {
        let [low, high] = drawing.extent();
        [high[0] - low[0], high[1] - low[1]]
    };
    let cell = drawings
        .iter()
        .map(size)
        .fold([1.0_f64; 2], |most, size| [most[0].max(size[0] + GAP), most[1].max(size[1] + GAP)]);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few columns")]
    let columns = ((SHEET / cell[0]) as usize).max(1);
    let mut sheet = Drafting::default();
    for (number, drawing) in drawings.iter().enumerate() {
        let [low, high] = drawing.extent();
        let (column, row) = (number % columns, number / columns);
        let x = (column as f64 + 0.5) * cell[0] - 0.5 * (low[0] + high[0]);
        let y = -(row as f64 + 0.5) * cell[1] - 0.5 * (low[1] + high[1]);
        sheet.place(drawing, [x, y]);
    }
    let rows = drawings.len().div_ceil(columns) as f64;
    let y = -rows * cell[1] - TITLE;
    let line = |from: [f64; 2], to: [f64; 2]| DraftForm::Line { from, to };
    sheet.add(DraftLayer::Notes, line([GAP, y], [GAP + 50.0, y]));
    for x in [GAP, GAP + 50.0] {
        sheet.add(DraftLayer::Notes, line([x, y - 1.0], [x, y + 1.0]));
    }
    let words = [
        ([GAP, 2.0 * TITLE], 1.3 * TITLE, title.to_owned()),
        ([GAP + 53.0, y], TITLE, "50 mm: print without scaling".to_owned()),
        (
            [GAP, y - 2.0 * TITLE],
            NOTE,
            "seen from the tip towards the base; the short line at the rim is the x axis; dashed: where the cable goes through the next disk".to_owned(),
        ),
    ];
    for (at, height, text) in words {
        let form = DraftForm::Text { at, height, is_centred: false, text };
        sheet.add(DraftLayer::Notes, form);
    }
    sheet
}

/// A cable where it passes a disk, in mm.
struct Passed {
    name: String,
    hole: Option<usize>,
    at: [f64; 2],
    next: Option<[f64; 2]>,
}

fn passed(robot: &Robot, disk: usize) -> Vec<Passed> {
    let disks = robot.disks();
    let at = |route: &whipcord::robot::Route, disk: usize| {
        let s = *disks.arc_lengths.get(disk)?;
        let is_there = s <= route.end() + 1e-9 * robot.backbone().length;
        is_there.then(|| {
            let offset = route.at(s.min(route.end())).offset;
            [MM * offset.x, MM * offset.y]
        })
    };
    let mut all: Vec<Passed> = Vec::new();
    for (cable, route) in robot.cables().iter().zip(robot.routes()) {
        let Some(here) = at(route, disk) else { continue };
        let hole = match &cable.routing {
            Routing::Holes { holes, .. } => holes.get(disk).copied(),
            _ => None,
        };
        let next =
            at(route, disk + 1).filter(|next| (next[0] - here[0]).hypot(next[1] - here[1]) > 1e-6);
        all.push(Passed { name: cable.name.clone(), hole, at: here, next });
    }
    all
}

fn hole_diameter(robot: &Robot, options: &DiskDrawingOptions) -> f64 {
    let disks = robot.disks();
    let least = disks.hole_circle_radii.iter().copied().fold(f64::INFINITY, f64::min);
    let apart = match disks.holes {
        Some(holes) if least.is_finite() => TAU * least / holes as f64,
        _ => 0.1 * robot.backbone().length,
    };
    options.hole_diameter.unwrap_or((apart / 3.0).min(1e-3))
}

fn place(hole: usize, holes: usize, radius: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * hole as f64 / holes as f64).sin_cos();
    [radius * cos, radius * sin]
}

fn note(drawing: &mut Drafting, at: [f64; 2], height: f64, text: String) {
    drawing.add(DraftLayer::Notes, DraftForm::Text { at, height, is_centred: true, text });
}

fn trimmed(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{Backbone, Cable, Disks};

    #[test]
    fn a_disk_has_its_holes_where_the_robot_has_them() {
        let disks = Disks::equally_spaced(0.1, 3, 0.008).with_holes(12);
        let cables = vec![
            Cable::new("pull", Routing::holes(vec![1, 4, 4])),
            Cable::new("wire", Routing::Straight { angle: 0.0, radius: 0.005 }),
        ];
        let robot = Robot::new(Backbone::new(0.1), disks, cables).unwrap();
        let drawing = disk_drawing(&robot, 1, &DiskDrawingOptions { hole_diameter: Some(1e-3) });
        let circles = |layer: DraftLayer| {
            let of = drawing.items.iter().filter(move |item| item.layer == layer);
            of.filter_map(|item| match item.form {
                DraftForm::Circle { centre, radius } => Some((centre, radius)),
                _ => None,
            })
            .collect::<Vec<_>>()
        };
        // Rim, twelve holes and that of the cable without one.
        assert_eq!(circles(DraftLayer::Cut).len(), 14);
        let cables = circles(DraftLayer::Cables);
        assert!((cables[0].0[0]).abs() < 1e-12 && (cables[0].0[1] - 8.0).abs() < 1e-12);
        assert!((cables[1].0[0] - 5.0).abs() < 1e-12);
        // From hole 1 to hole 4, none to the same place.
        let first = disk_drawing(&robot, 0, &DiskDrawingOptions::default());
        let courses = |of: &Drafting| {
            of.items.iter().filter(|item| item.layer == DraftLayer::Courses).count()
        };
        assert_eq!((courses(&first), courses(&drawing)), (1, 0));
        let sheet = disk_sheet(&robot, "finger", &DiskDrawingOptions::default());
        let [low, high] = sheet.extent();
        assert!(high[0] - low[0] < 200.0);
        assert!(sheet.svg().unwrap().contains("disk 2, at 50 mm"));
    }

    #[test]
    fn names_are_beside_the_disk_wherever_their_holes_are() {
        let count = 36;
        let disks = Disks::equally_spaced(0.1, 3, 0.008).with_holes(count);
        let of_hole = |hole: usize| {
            // Two cables through the same hole have their names one behind the other.
            let cable = |name: &str| Cable::new(name, Routing::holes(vec![hole; 3]));
            let cables = vec![cable("a long name"), cable("x")];
            Robot::new(Backbone::new(0.1), disks.clone(), cables).unwrap()
        };
        for hole in 1..=count {
            let drawing = disk_drawing(&of_hole(hole), 1, &DiskDrawingOptions::default());
            let rim = drawing.items.iter().find_map(|item| match item.form {
                DraftForm::Circle { radius, .. } => Some(radius),
                _ => None,
            });
            let rim = rim.unwrap();
            let boxes = drawing.items.iter().filter_map(|item| match &item.form {
                DraftForm::Text { at, height, text, .. } if text.contains(':') => {
                    Some((*at, [0.5 * LETTER * height * text.chars().count() as f64, 0.5 * height]))
                }
                _ => None,
            });
            let boxes: Vec<([f64; 2], [f64; 2])> = boxes.collect();
            assert_eq!(boxes.len(), 2);
            for (at, half) in &boxes {
                let nearest = [0, 1].map(|k| (at[k].abs() - half[k]).max(0.0));
                assert!(nearest[0].hypot(nearest[1]) > rim, "hole {hole}");
            }
            assert!((boxes[0].0[1] - boxes[1].0[1]).abs() > 2.0 * boxes[0].1[1], "hole {hole}");
        }
    }
}
