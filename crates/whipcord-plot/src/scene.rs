//! Putting bodies on paper, what is behind first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use whipcord::Vec3;

use crate::body::{Body, Disk, Part, Piece};
use crate::colour::Colour;
use crate::projection::Projection;
use crate::svg::{Ellipse, Fill, Point, Stroke, Svg};

/// How a body is drawn.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    /// Backbone and disks.
    pub colour: Colour,
    /// One for each cable.
    pub cables: Vec<Colour>,
    /// Drawn as what was there before.
    pub pale: bool,
}

/// Thinnest backbone in px.
const THINNEST: f64 = 1.8;
/// Width of a cable in px.
const CABLE: f64 = 1.3;
/// How much of its colour a cable had before actuation.
const PALE_CABLE: f64 = 0.4;
/// Smallest hole, as its longer half axis in px, that is worth drawing.
const SMALLEST_HOLE: f64 = 0.6;
/// Largest distance in px of a simplified line from its points.
const TOLERANCE: f64 = 0.04;

enum Item<'a> {
    Disk(&'a Disk, &'a Look),
    Piece(&'a Piece, &'a Look),
}

struct Node<'a> {
    item: Item<'a>,
    depth: f64,
    /// Nodes that must be drawn later.
    before: Vec<usize>,
    /// How many nodes must be drawn first and are not yet.
    waits_for: usize,
}

/// Draws the bodies: pale ones as a background, then the others together. What is farther away
/// comes first, except that between neighbours along a robot the disk decides: what lies behind its
/// plane is drawn before it.
pub(crate) fn draw(svg: &mut Svg, bodies: &[(Body, Look)], view: &Projection) {
    for pale in [true, false] {
        let mut nodes = Vec::new();
        for (body, look) in bodies.iter().filter(|(_, look)| look.pale == pale) {
            add(&mut nodes, body, look, view);
        }
        for item in in_order(nodes) {
            match item {
                Item::Disk(disk, look) => draw_disk(svg, disk, look, view),
                Item::Piece(piece, look) => draw_piece(svg, piece, look, view),
            }
        }
    }
}

fn add<'a>(nodes: &mut Vec<Node<'a>>, body: &'a Body, look: &'a Look, view: &Projection) {
    let first = nodes.len();
    let node = |item, at: Vec3| Node { item, depth: view.depth(at), before: vec![], waits_for: 0 };
    for disk in &body.disks {
        nodes.push(node(Item::Disk(disk, look), disk.pose.position));
    }
    for piece in &body.pieces {
        let middle = piece.points[piece.points.len() / 2];
        let index = nodes.len();
        nodes.push(node(Item::Piece(piece, look), middle));
        let mut order = |back: usize, front: usize| {
            nodes[back].before.push(front);
            nodes[front].waits_for += 1;
        };
        let faces = |disk: usize| {
            let normal = body.disks[disk].pose.rotation.rotate(Vec3::Z);
            normal.dot(view.towards()) >= 0.0
        };
        let (below, above) = (piece.section, piece.section + 1);
        // A disk that shows its upper face hides what is below it.
        if faces(below) {
            order(first + below, index)
        } else {
            order(index, first + below)
        }
        if above < body.disks.len() {
            if faces(above) { order(index, first + above) } else { order(first + above, index) }
        }
    }
}

#[derive(PartialEq)]
struct Ready {
    depth: f64,
    index: usize,
}

impl Eq for Ready {}

impl Ord for Ready {
    // The farthest first; where there is no difference, in the order of the bodies.
    fn cmp(&self, other: &Self) -> Ordering {
        other.depth.total_cmp(&self.depth).then(other.index.cmp(&self.index))
    }
}

impl PartialOrd for Ready {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

fn in_order(mut nodes: Vec<Node<'_>>) -> Vec<Item<'_>> {
    let ready = |index: usize, nodes: &[Node<'_>]| Ready { depth: nodes[index].depth, index };
    let mut heap: BinaryHeap<Ready> =
        (0..nodes.len()).filter(|&i| nodes[i].waits_for == 0).map(|i| ready(i, &nodes)).collect();
    let mut order = Vec::with_capacity(nodes.len());
    while let Some(Ready { index, .. }) = heap.pop() {
        order.push(index);
        for next in std::mem::take(&mut nodes[index].before) {
            nodes[next].waits_for -= 1;
            if nodes[next].waits_for == 0 {
                heap.push(ready(next, &nodes));
            }
        }
    }
    let mut items: Vec<Option<Item<'_>>> = nodes.into_iter().map(|n| Some(n.item)).collect();
    order.into_iter().filter_map(|i| items[i].take()).collect()
}

fn draw_disk(svg: &mut Svg, disk: &Disk, look: &Look, view: &Projection) {
    let [u, v] = [Vec3::X, Vec3::Y].map(|axis| disk.pose.rotation.rotate(axis));
    let rim = view.circle(disk.pose.position, disk.radius, u, v);
    let holes: Vec<Ellipse> = disk
        .holes
        .iter()
        .map(|&centre| view.circle(centre, disk.hole_radius, u, v))
        .filter(|hole| hole.radii[0] >= SMALLEST_HOLE && hole.radii[1] >= 0.1)
        .collect();
    let (fill, stroke) = if look.pale {
        let fill = Fill::new(look.colour.tint(0.2)).opacity(0.35);
        (fill, Stroke::new(look.colour.tint(0.55), 0.6))
    } else {
        let fill = Fill::new(look.colour.tint(0.22)).opacity(0.72);
        (fill, Stroke::new(look.colour.tint(0.85), 0.8))
    };
    svg.plate(rim.visible(), &holes, fill, stroke);
}

fn draw_piece(svg: &mut Svg, piece: &Piece, look: &Look, view: &Projection) {
    let points: Vec<Point> = piece.points.iter().map(|&p| view.place(p)).collect();
    let points = simplified(&points, TOLERANCE);
    let (class, colour, width) = match piece.part {
        Part::Backbone => ("backbone", look.colour, seen_width(piece, view).max(THINNEST)),
        Part::Cable(i) => ("cable", look.cables[i], CABLE),
        Part::Anchor(i) => {
            let colour = if look.pale { look.cables[i].tint(PALE_CABLE) } else { look.cables[i] };
            svg.circle(points[0], 1.5 * CABLE, Some(Fill::new(colour)), None);
            return;
        }
    };
    let stroke = if look.pale {
        // Paler, but opaque: pieces overlap at their ends.
        let strength = if piece.part == Part::Backbone { 0.45 } else { PALE_CABLE };
        Stroke::new(colour.tint(strength), width)
    } else {
        Stroke::new(colour, width)
    };
    svg.polyline(&points, stroke, class);
}

/// Width in px of the backbone as it is seen: for a bar it depends on the side it shows.
fn seen_width(piece: &Piece, view: &Projection) -> f64 {
    let Some([width, height]) = piece.extent else {
        return 0.0;
    };
    let [x, y, tangent] = [Vec3::X, Vec3::Y, Vec3::Z].map(|a| piece.frame.rotation.rotate(a));
    let across = tangent.cross(view.towards());
    let norm = across.norm();
    let seen = if norm < 1e-9 || width == height {
        width.max(height)
    } else {
        // The silhouette of a rectangle that is turned about the tangent.
        (width * x.dot(across).abs() + height * y.dot(across).abs()) / norm
    };
    view.scale() * seen
}

/// The line without the points it does not need (Douglas and Peucker).
pub(crate) fn simplified(points: &[Point], tolerance: f64) -> Vec<Point> {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let mut kept = vec![first];
    keep(points, tolerance, &mut kept);
    kept.push(last);
    kept
}

fn keep(points: &[Point], tolerance: f64, kept: &mut Vec<Point>) {
    let (Some(&[ax, ay]), Some(&[bx, by])) = (points.first(), points.last()) else {
        return;
    };
    let (dx, dy) = (bx - ax, by - ay);
    let length = dx.hypot(dy);
    let distance = |&[x, y]: &Point| {
        if length < 1e-9 {
            (x - ax).hypot(y - ay)
        } else {
            ((x - ax) * dy - (y - ay) * dx).abs() / length
        }
    };
    let farthest =
        points.iter().enumerate().map(|(i, p)| (i, distance(p))).max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((i, d)) = farthest
        && d > tolerance
        && i > 0
        && i + 1 < points.len()
    {
        keep(&points[..=i], tolerance, kept);
        kept.push(points[i]);
        keep(&points[i..], tolerance, kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_keep_their_ends_only() {
        let line: Vec<Point> = (0..20).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        assert_eq!(simplified(&line, 0.01), [[0.0, 0.0], [19.0, 38.0]]);
        let arc: Vec<Point> = (0..=90)
            .map(|i| {
                let (sin, cos) = f64::from(i).to_radians().sin_cos();
                [100.0 * cos, 100.0 * sin]
            })
            .collect();
        let kept = simplified(&arc, 0.1);
        assert!((5..40).contains(&kept.len()), "{}", kept.len());
    }

    #[test]
    fn the_far_is_drawn_first_unless_a_neighbour_says_otherwise() {
        let disk =
            Disk { pose: whipcord::Pose::IDENTITY, radius: 1.0, holes: vec![], hole_radius: 0.0 };
        let look = Look { colour: Colour::INK, cables: vec![], pale: false };
        let node = |depth, before, waits_for| Node {
            item: Item::Disk(&disk, &look),
            depth,
            before,
            waits_for,
        };
        let nodes = vec![node(0.0, vec![], 1), node(2.0, vec![0], 0), node(1.0, vec![], 0)];
        assert_eq!(in_order(nodes).len(), 3);
        let mut heap = BinaryHeap::from([
            Ready { depth: 2.0, index: 0 },
            Ready { depth: -1.0, index: 1 },
            Ready { depth: -1.0, index: 2 },
        ]);
        let order: Vec<usize> = std::iter::from_fn(|| heap.pop().map(|r| r.index)).collect();
        assert_eq!(order, [1, 2, 0]);
    }
}
