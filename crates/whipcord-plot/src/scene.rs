//! Putting bodies on paper, what is behind first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use whipcord::{Pose, Vec3};

use crate::body::{Body, Disk, Part, Piece, Profile};
use crate::colour::Colour;
use crate::marker::{self, Marker};
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
    /// How much of it is drawn.
    pub form: Form,
}

/// How much of a body is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// All of it, in its true size.
    Whole,
    /// Its backbone as a line, over all else, with a sign at the tip: one of many models.
    Line {
        stroke: Stroke,
        marker: Marker,
        /// Whether disks and cables are drawn below the lines.
        dressed: bool,
    },
}

/// Radius of the sign at the tip of a line in px.
const TIP: f64 = 3.4;
/// Signs whose centres are closer than this, relative to their radius, are moved apart, to the distance that follows.
const CROWDED: f64 = 3.0;
const APART: f64 = 2.7;
/// Largest angle of the arc on which they lie beyond the tip, to either side.
const FAN: f64 = 1.9;
/// Thinnest disk, from face to face in px, whose side is drawn.
const THINNEST_DISK: f64 = 0.8;
/// Thinnest backbone in px.
const THINNEST: f64 = 1.8;
/// Width of a cable in px.
const CABLE: f64 = 1.3;
/// How much of its colour a backbone has that is drawn pale, and how much a cable.
const PALE_BACKBONE: f64 = 0.45;
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
            if !matches!(look.form, Form::Line { dressed: false, .. }) {
                add(&mut nodes, body, look, view);
            }
        }
        for item in in_order(nodes) {
            match item {
                Item::Disk(disk, look) => draw_disk(svg, disk, look, view),
                Item::Piece(piece, look) => draw_piece(svg, piece, look, view),
            }
        }
    }
    draw_lines(svg, bodies, view);
}

/// The backbones that are lines, and on top of them the signs at their tips. Signs that would cover each other are moved
/// apart and joined to their tips by thin lines.
fn draw_lines(svg: &mut Svg, bodies: &[(Body, Look)], view: &Projection) {
    let mut tips = Vec::new();
    for (body, look) in bodies {
        let Form::Line { stroke, marker, .. } = look.form else { continue };
        let points = body.pieces.iter().filter(|piece| piece.part == Part::Backbone);
        let points: Vec<Point> =
            points.flat_map(|piece| &piece.points).map(|&p| view.place(p)).collect();
        svg.polyline(&simplified(&points, TOLERANCE), stroke, "backbone");
        if let [.., before, tip] = points[..] {
            tips.push(Tip {
                at: tip,
                along: [tip[0] - before[0], tip[1] - before[1]],
                marker,
                colour: stroke.colour,
            });
        }
    }
    let places = sign_places(&tips);
    for (tip, place) in tips.iter().zip(&places).filter(|(tip, place)| tip.at != **place) {
        svg.line(tip.at, *place, Stroke::new(tip.colour, 0.7));
    }
    for (tip, place) in tips.iter().zip(places) {
        let rim = Some(Stroke::new(Colour::WHITE, 0.7));
        marker::draw(svg, tip.marker, place, TIP, Fill::new(tip.colour), rim);
    }
}

/// The tip of a line on paper.
struct Tip {
    at: Point,
    /// From the last point before the tip.
    along: Point,
    marker: Marker,
    colour: Colour,
}

/// Where the signs of the tips are drawn: at the tips, or on an arc beyond each group of crowded tips.
fn sign_places(tips: &[Tip]) -> Vec<Point> {
    let mut places: Vec<Point> = tips.iter().map(|tip| tip.at).collect();
    let mut open: Vec<usize> = (0..tips.len()).collect();
    while let Some(first) = open.first().copied() {
        let mut group = vec![first];
        open.remove(0);
        let mut next = 0;
        while next < group.len() {
            let [x, y] = tips[group[next]].at;
            let crowded = |&k: &usize| (tips[k].at[0] - x).hypot(tips[k].at[1] - y) < CROWDED * TIP;
            group.extend(open.iter().copied().filter(crowded));
            open.retain(|k| !crowded(k));
            next += 1;
        }
        if group.len() == 1 {
            continue;
        }
        let count = group.len() as f64;
        let mean = |value: &dyn Fn(&Tip) -> f64| {
            group.iter().map(|&k| value(&tips[k])).sum::<f64>() / count
        };
        let middle = [0, 1].map(|i| mean(&|tip| tip.at[i]));
        let along =
            [0, 1].map(|i| mean(&|tip| tip.along[i] / tip.along[0].hypot(tip.along[1]).max(1e-9)));
        let ahead = along[1].atan2(along[0]);
        // In the order in which the tips lie across the direction ahead, so that few lines cross.
        let across = |k: usize| {
            let [x, y] = [0, 1].map(|i| tips[k].at[i] - middle[i]);
            y * ahead.cos() - x * ahead.sin()
        };
        group.sort_by(|&a, &b| across(a).total_cmp(&across(b)));
        let spread = (2.0 * FAN * (count - 1.0) / count).min(2.0 * FAN);
        let step = spread / (count - 1.0);
        let radius = (0.5 * APART * TIP / (0.5 * step).sin()).max(APART * TIP);
        for (j, &k) in group.iter().enumerate() {
            let angle = ahead - 0.5 * spread + step * j as f64;
            places[k] = [middle[0] + radius * angle.cos(), middle[1] + radius * angle.sin()];
        }
    }
    places
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
        if body.disks.is_empty() && piece.part != Part::Backbone {
            // Cables in channels run inside the body, which would hide them.
            nodes[index].depth = f64::INFINITY;
        }
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
        if below < body.disks.len() {
            if faces(below) { order(first + below, index) } else { order(index, first + below) }
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
    let [u, v, n] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| disk.pose.rotation.rotate(axis));
    // From the middle to the face that is seen.
    let out = n * if n.dot(view.towards()) >= 0.0 { disk.half } else { -disk.half };
    let face = |offset: Vec3| view.circle(disk.pose.position + offset, disk.radius, u, v);
    let (rim, far) = (face(out), face(-out));
    let holes: Vec<Ellipse> = disk
        .holes
        .iter()
        .map(|&centre| view.circle(centre + out, disk.hole_radius, u, v))
        .filter(|hole| hole.radii[0] >= SMALLEST_HOLE && hole.radii[1] >= 0.1)
        .collect();
    let (fill, side, stroke) = match look.form {
        _ if look.pale => {
            let fill = |tint| Fill::new(look.colour.tint(tint)).opacity(0.35);
            (fill(0.2), fill(0.4), Stroke::new(look.colour.tint(0.55), 0.6))
        }
        Form::Whole => {
            let fill = |tint| Fill::new(look.colour.tint(tint)).opacity(0.72);
            (fill(0.22), fill(0.45), Stroke::new(look.colour.tint(0.85), 0.8))
        }
        // Lines of other colours run over it.
        Form::Line { .. } => {
            let fill = |tint| Fill::new(Colour::GREY.tint(tint)).opacity(0.72);
            (fill(0.18), fill(0.4), Stroke::new(Colour::GREY.tint(0.7), 0.6))
        }
    };
    let apart = [0, 1].map(|i| far.centre[i] - rim.centre[i]);
    if apart[0].hypot(apart[1]) >= THINNEST_DISK {
        svg.wall(rim.visible(), far.visible(), side, stroke);
    }
    svg.plate(rim.visible(), &holes, fill, stroke);
}

fn draw_piece(svg: &mut Svg, piece: &Piece, look: &Look, view: &Projection) {
    let strength = |pale: f64| if look.pale { pale } else { 1.0 };
    let line = |points: &[Vec3]| -> Vec<Point> {
        let points: Vec<Point> = points.iter().map(|&p| view.place(p)).collect();
        simplified(&points, TOLERANCE)
    };
    match piece.part {
        // Its line comes last.
        Part::Backbone if look.form != Form::Whole => {}
        Part::Backbone => {
            let colour = look.colour.tint(strength(PALE_BACKBONE));
            // Stretches that follow one another share a cross-section.
            let open = piece.hidden[0] == 0.0 && !piece.end;
            let piece = piece.visible();
            let widest = piece.profiles.iter().map(|profile| match profile {
                // Its sides come on top of a line, without which a thin strip could vanish.
                Profile::Bar { .. } => 0.0,
                profile => 2.0 * profile.half_extents()[0] * view.scale(),
            });
            if widest.fold(0.0, f64::max) > THINNEST {
                draw_tube(svg, (&piece, open), colour, view);
                return;
            }
            // Round ends close the gaps at bends; at base and tip there is nothing to close.
            let stroke = Stroke { flat: piece.end, ..Stroke::new(colour, THINNEST) };
            svg.polyline(&line(&piece.points), stroke, "backbone");
            if let Some(Profile::Bar { .. }) = piece.profiles.first() {
                draw_sides(svg, &piece, colour, view);
            }
        }
        Part::Cable(i) => {
            let colour = look.cables[i].tint(strength(PALE_CABLE));
            svg.polyline(&line(&piece.visible().points), Stroke::new(colour, CABLE), "cable");
        }
        Part::Anchor(i) => {
            let colour = look.cables[i].tint(strength(PALE_CABLE));
            svg.circle(view.place(piece.points[0]), 1.5 * CABLE, Some(Fill::new(colour)), None);
        }
    }
}

/// A round backbone of any taper: its outline, and the cross-sections that close it.
fn draw_tube(svg: &mut Svg, (piece, open): (&Piece, bool), colour: Colour, view: &Projection) {
    let rims: Vec<Ellipse> = piece
        .frames
        .iter()
        .zip(&piece.profiles)
        .map(|(frame, profile)| {
            let [u, v] = [Vec3::X, Vec3::Y].map(|axis| frame.rotation.rotate(axis));
            let least = 0.5 * THINNEST / view.scale();
            view.circle(frame.position, profile.half_extents()[0].max(least), u, v)
        })
        .collect();
    let (Some(first), Some(last)) = (rims.first(), rims.last()) else { return };
    let mut sides = [Vec::with_capacity(rims.len()), Vec::with_capacity(rims.len())];
    for (rim, frame) in rims.iter().zip(&piece.frames) {
        // The outline touches each cross-section at the ends of its long axis, left and right of
        // the tangent.
        let (dx, dy) = (rim.radii[0] * rim.angle.cos(), rim.radii[0] * rim.angle.sin());
        let tangent = view.place(frame.transform(Vec3::Z));
        let at = view.place(frame.position);
        let left = (tangent[0] - at[0]) * dy - (tangent[1] - at[1]) * dx >= 0.0;
        let [a, b] = [[at[0] + dx, at[1] + dy], [at[0] - dx, at[1] - dy]];
        sides[usize::from(left)].push(a);
        sides[usize::from(!left)].push(b);
    }
    let mut outline = simplified(&sides[0], TOLERANCE);
    outline.extend(simplified(&sides[1], TOLERANCE).into_iter().rev());
    let ends = [first.visible(), last.visible()];
    svg.tube(&outline, if open { &ends[1..] } else { &ends }, colour);
}

/// The sides of a bar that the viewer sees, each in its shade.
fn draw_sides(svg: &mut Svg, piece: &Piece, colour: Colour, view: &Projection) {
    let Some(middle) = piece.frames.get(piece.frames.len() / 2) else { return };
    let middle = middle.rotation;
    // Outward normal, and the two edges of each side, as signs of the half extents.
    let sides = [
        (Vec3::X, [1.0, -1.0], [1.0, 1.0]),
        (Vec3::Y, [1.0, 1.0], [-1.0, 1.0]),
        (-Vec3::X, [-1.0, 1.0], [-1.0, -1.0]),
        (-Vec3::Y, [-1.0, -1.0], [1.0, -1.0]),
    ];
    let corner = |frame: &Pose, profile: &Profile, [x, y]: [f64; 2]| {
        let [w, h] = profile.half_extents();
        view.place(frame.transform(Vec3::new(x * w, y * h, 0.0)))
    };
    let sections = || piece.frames.iter().zip(&piece.profiles);
    if piece.end {
        // Base and tip are closed; what faces away disappears under the sides.
        for (frame, profile) in [sections().next(), sections().next_back()].into_iter().flatten() {
            let face = sides.map(|(_, a, _)| corner(frame, profile, a));
            svg.polygon(&face, Some(Fill::new(colour)), None);
        }
    }
    for (normal, a, b) in sides {
        let facing = middle.rotate(normal).dot(view.towards());
        if facing <= 0.0 {
            continue;
        }
        let edge = |signs: [f64; 2]| -> Vec<Point> {
            let points: Vec<Point> =
                sections().map(|(frame, profile)| corner(frame, profile, signs)).collect();
            simplified(&points, TOLERANCE)
        };
        let mut outline = edge(a);
        outline.extend(edge(b).into_iter().rev());
        let shade = colour.tint(0.75 + 0.25 * facing);
        // The rim closes the seams between pieces.
        svg.polygon(&outline, Some(Fill::new(shade)), Some(Stroke::new(shade, 0.5)));
    }
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
    let length_squared = dx * dx + dy * dy;
    // To the stretch between the ends: the rim of a disk that is seen from its side goes there and
    // back on one line.
    let distance = |&[x, y]: &Point| {
        let along = (x - ax) * dx + (y - ay) * dy;
        let t = if along > 0.0 { (along / length_squared).min(1.0) } else { 0.0 };
        (x - ax - t * dx).hypot(y - ay - t * dy)
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
    fn signs_that_would_cover_each_other_are_moved_apart() {
        let tip = |x, y| Tip {
            at: [x, y],
            along: [0.0, -1.0],
            marker: Marker::Circle,
            colour: Colour::INK,
        };
        let tips = [tip(0.0, 0.0), tip(1.0, 0.5), tip(40.0, 0.0), tip(-1.0, 0.0), tip(4.0, 2.0)];
        let places = sign_places(&tips);
        assert_eq!(places[2], tips[2].at);
        for (i, a) in places.iter().enumerate() {
            for b in &places[..i] {
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) > 2.5 * TIP, "{places:?}");
            }
        }
        // From left to right as the tips.
        assert!(places[3][0] < places[0][0] && places[1][0] < places[4][0]);
    }

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
        let there_and_back: Vec<Point> =
            (0..=48).map(|k| [0.0, (f64::from(k) * core::f64::consts::TAU / 48.0).sin()]).collect();
        let ends = simplified(&there_and_back, 0.01);
        assert!(ends.contains(&[0.0, 1.0]) && ends.contains(&[0.0, -1.0]), "{ends:?}");
    }

    #[test]
    fn the_far_is_drawn_first_unless_a_neighbour_says_otherwise() {
        let disk =
            Disk { pose: Pose::IDENTITY, radius: 1.0, half: 0.0, holes: vec![], hole_radius: 0.0 };
        let look = Look { colour: Colour::INK, cables: vec![], pale: false, form: Form::Whole };
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
