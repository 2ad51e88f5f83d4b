//! Obstacles on paper: outlines of bodies, bores of pipes, and hatched planes.

use core::f64::consts::FRAC_PI_2;

use whipcord::{Form, Obstacle, Pose, Vec3};

use crate::colour::Colour;
use crate::hull::{convex, plane_in_box};
use crate::legend::{Entry, Swatch};
use crate::obstacle_surface::{bore, box_rings, cylinder_rings, globe_rings};
use crate::projection::Projection;
use crate::robot_figure::range;
use crate::svg::{Fill, Point, Stroke, Svg};

/// Colour of obstacles.
pub const OBSTACLE: Colour = Colour::new(0x7d, 0x70, 0x5c);
/// How much of its colour the area of an obstacle has, a bore, and a plane seen from the front.
const AREA: f64 = 0.32;
const BORE: f64 = 0.13;
const PLANE: f64 = 0.16;
/// Opacity of what stands before the robot.
const BEFORE: f64 = 0.45;
/// A plane whose normal has less of the direction to the viewer than this is seen edge-on.
const EDGE_ON: f64 = 0.12;
/// Distance and length of the strokes that hatch the body behind a plane, in px.
const HATCH: f64 = 7.0;
/// More triangles than this are drawn by their outline alone.
const MOST_TRIANGLES: usize = 6000;
/// Obstacles beyond this number share one entry of the legend.
const NAMED: usize = 3;
/// Room around the robot in which obstacles are drawn, relative to its extent.
const ROOM: f64 = 0.4;

/// What of an obstacle is drawn, in space.
enum Drawing {
    /// A convex body by points that span it, and its flat sides with the normals out of them.
    Hull { points: Vec<Vec3>, sides: Vec<(Vec3, Vec<Vec3>)> },
    /// Rings of a bore from one end to the other; those of a piece follow each other.
    Bore { pieces: Vec<Vec<Vec<Vec3>>> },
    /// The part of a plane that is in reach, and the normal out of the body.
    Plane { polygon: Vec<Vec3>, foot: Vec3, normal: Vec3 },
    /// Triangles, counter-clockwise as seen from outside.
    Triangles(Vec<[Vec3; 3]>),
}

/// Obstacles around a robot.
pub(crate) struct Obstacles {
    drawings: Vec<(Drawing, Vec3)>,
    /// Movable objects where they were before.
    initial: Vec<(Drawing, Vec3)>,
    /// The middle of the robot.
    middle: Vec3,
    /// All that is drawn lies in this box.
    room: [Vec3; 2],
}

impl Obstacles {
    /// Around a robot that these points span.
    pub fn new(obstacles: &[Obstacle], initial: &[Obstacle], points: &[Vec3]) -> Self {
        let ranges = [0, 1, 2].map(|i| range(points, i));
        let extent = ranges.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let corner = |k: usize, out: f64| Vec3::from(ranges.map(|ends| ends[k] + out * extent));
        let room = [corner(0, -ROOM), corner(1, ROOM)];
        let drawn = |obstacle: &Obstacle| {
            let pose = &obstacle.pose;
            (drawing(&obstacle.form, pose, room), pose.position)
        };
        let [drawings, initial] = [obstacles, initial].map(|all| all.iter().map(drawn).collect());
        Self { drawings, initial, middle: 0.5 * (corner(0, 0.0) + corner(1, 0.0)), room }
    }

    /// Points that span what is to be seen of them: as much as is near the robot.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> + '_ {
        let [low, high] = self.room;
        let near = move |p: Vec3| Vec3::from([0, 1, 2].map(|i| p[i].clamp(low[i], high[i])));
        let is_near = move |p: &Vec3| near(*p) == *p;
        self.drawings.iter().chain(&self.initial).flat_map(move |(drawing, _)| match drawing {
            Drawing::Hull { points, .. } => points.iter().copied().map(near).collect::<Vec<_>>(),
            Drawing::Bore { pieces } => {
                pieces.iter().flatten().flatten().map(|&p| near(p)).collect()
            }
            Drawing::Plane { foot, .. } => [*foot].into_iter().filter(is_near).collect(),
            Drawing::Triangles(all) => all.iter().flatten().map(|&p| near(p)).collect(),
        })
    }

    /// What the areas mean.
    pub fn legend(obstacles: &[Obstacle]) -> Vec<Entry> {
        let (fill, stroke) = (Fill::new(OBSTACLE.tint(AREA)), Stroke::new(OBSTACLE, 0.9));
        let entry = |label| Entry { label, swatches: vec![Swatch::Area(fill, Some(stroke))] };
        if obstacles.len() > NAMED {
            return vec![entry(format!("{} obstacles", obstacles.len()))];
        }
        obstacles.iter().map(|obstacle| entry(format!("obstacle {}", obstacle.name))).collect()
    }

    /// Draws those behind the robot, or those before it, in a box of this name.
    pub fn draw(
        &self,
        svg: &mut Svg,
        view: &Projection,
        (name, at, size): (&str, Point, Point),
        before: bool,
    ) {
        let mut drawn: Vec<_> = self
            .drawings
            .iter()
            .filter(|(drawing, centre)| {
                let solid = matches!(drawing, Drawing::Hull { .. } | Drawing::Triangles(_));
                before == (solid && view.depth(*centre) > view.depth(self.middle))
            })
            .collect();
        if drawn.is_empty() && (before || self.initial.is_empty()) {
            return;
        }
        drawn.sort_by(|a, b| view.depth(a.1).total_cmp(&view.depth(b.1)));
        svg.open_within(name, at, size);
        // Planes are backgrounds.
        let is_plane = |drawing: &Drawing| matches!(drawing, Drawing::Plane { .. });
        for plane in [true, false] {
            for (drawing, _) in drawn.iter().filter(|(drawing, _)| is_plane(drawing) == plane) {
                drawing.draw(svg, view, if before { BEFORE } else { 1.0 });
            }
        }
        for (drawing, _) in self.initial.iter().filter(|_| !before) {
            drawing.draw_outline(svg, view);
        }
        svg.close();
    }
}

fn drawing(form: &Form, pose: &Pose, room: [Vec3; 2]) -> Drawing {
    let place =
        |points: Vec<Vec3>| points.into_iter().map(|p| pose.transform(p)).collect::<Vec<_>>();
    let round = |points| Drawing::Hull { points: place(points), sides: Vec::new() };
    match form {
        Form::HalfSpace => {
            let normal = pose.rotation.rotate(Vec3::Z);
            let middle = 0.5 * (room[0] + room[1]);
            let foot = middle - (middle - pose.position).dot(normal) * normal;
            Drawing::Plane { polygon: plane_in_box(pose.position, normal, room), foot, normal }
        }
        Form::Sphere { .. } | Form::Capsule { .. } | Form::Superellipsoid(_) => {
            round(globe_rings(form).concat())
        }
        Form::Cylinder { radius, length } => {
            let [low, high] = cylinder_rings(*radius, *length).map(place);
            let up = pose.rotation.rotate(Vec3::Z);
            let points = [high.clone(), low.clone()].concat();
            Drawing::Hull { points, sides: vec![(up, high), (-up, low)] }
        }
        Form::Box { size } => {
            let [low, high] = box_rings(*size).map(place);
            let side = |k: usize| vec![low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]];
            let axes =
                [-Vec3::Y, Vec3::X, Vec3::Y, -Vec3::X].map(|axis| pose.rotation.rotate(axis));
            let up = pose.rotation.rotate(Vec3::Z);
            let mut sides: Vec<_> = axes.into_iter().zip((0..4).map(side)).collect();
            sides.extend([(-up, low.clone()), (up, high.clone())]);
            Drawing::Hull { points: [low, high].concat(), sides }
        }
        Form::Pipe(pipe) => Drawing::Bore { pieces: bore(pipe, pose) },
        Form::Mesh(mesh) => {
            let corner = |k: u32| pose.transform(mesh.vertices()[k as usize]);
            if mesh.triangles().len() > MOST_TRIANGLES {
                return round(mesh.vertices().to_vec());
            }
            Drawing::Triangles(mesh.triangles().iter().map(|t| t.map(corner)).collect())
        }
    }
}

impl Drawing {
    /// Where a movable object was: its outline, faintly.
    fn draw_outline(&self, svg: &mut Svg, view: &Projection) {
        let outline = |points: &mut dyn Iterator<Item = &Vec3>| -> Vec<Point> {
            convex(&points.map(|&p| view.place(p)).collect::<Vec<_>>())
        };
        let polygon = match self {
            Self::Hull { points, .. } => outline(&mut points.iter()),
            Self::Triangles(all) => outline(&mut all.iter().flatten()),
            Self::Bore { .. } | Self::Plane { .. } => return,
        };
        svg.polygon(&polygon, None, Some(Stroke::new(OBSTACLE.tint(0.45), 0.9).dash("4 3")));
    }

    fn draw(&self, svg: &mut Svg, view: &Projection, opacity: f64) {
        let paper =
            |points: &[Vec3]| -> Vec<Point> { points.iter().map(|&p| view.place(p)).collect() };
        let line = Stroke::new(OBSTACLE, 0.9);
        let area = Fill::new(OBSTACLE.tint(AREA)).opacity(opacity);
        match self {
            Self::Hull { points, sides } => {
                svg.polygon(&convex(&paper(points)), Some(area), Some(line));
                for (normal, side) in sides {
                    if normal.dot(view.towards()) > 1e-9 {
                        let thin = Stroke::new(OBSTACLE.tint(0.7), 0.7);
                        svg.polygon(&paper(side), None, Some(thin));
                    }
                }
            }
            Self::Bore { pieces } => {
                let mut parts = Vec::new();
                for piece in pieces {
                    for pair in piece.windows(2) {
                        parts.push(convex(&paper(&pair.concat())));
                    }
                }
                // Lines around every part, then the areas over what of them lies inside.
                for part in &parts {
                    svg.polygon(part, None, Some(Stroke::new(OBSTACLE, 3.2)));
                }
                let bore = OBSTACLE.tint(BORE);
                for part in &parts {
                    // The rim closes the seams between parts.
                    svg.polygon(part, Some(Fill::new(bore)), Some(Stroke::new(bore, 0.6)));
                }
                let ends =
                    [pieces.first().and_then(|p| p.first()), pieces.last().and_then(|p| p.last())];
                for end in ends.into_iter().flatten() {
                    svg.polygon(&paper(end), None, Some(Stroke::new(OBSTACLE.tint(0.7), 0.8)));
                }
            }
            Self::Plane { polygon, normal, .. } => draw_plane(svg, view, &paper(polygon), *normal),
            Self::Triangles(all) => {
                let normal = |[a, b, c]: &[Vec3; 3]| (*b - *a).cross(*c - *a);
                let mut seen: Vec<_> = all
                    .iter()
                    .map(|corners| (corners, normal(corners)))
                    .filter(|(_, normal)| normal.dot(view.towards()) > 0.0)
                    .collect();
                let depth = |[a, b, c]: &[Vec3; 3]| view.depth(*a + *b + *c);
                seen.sort_by(|a, b| depth(a.0).total_cmp(&depth(b.0)));
                for (corners, normal) in seen {
                    let facing = normal.dot(view.towards()) / normal.norm();
                    let shade = OBSTACLE.tint(AREA * (1.7 - 0.7 * facing));
                    // Half-transparent lines over their own areas would be seen.
                    let rim = (opacity >= 1.0).then(|| Stroke::new(shade, 0.5));
                    let fill = Fill::new(shade).opacity(opacity);
                    svg.polygon(&paper(corners), Some(fill), rim);
                }
                let corners: Vec<Vec3> = all.iter().flatten().copied().collect();
                if all.len() <= 64 {
                    for corners in all.iter().filter(|c| normal(c).dot(view.towards()) > 0.0) {
                        svg.polygon(
                            &paper(corners),
                            None,
                            Some(Stroke::new(OBSTACLE.tint(0.7), 0.6)),
                        );
                    }
                } else {
                    svg.polygon(
                        &convex(&paper(&corners)),
                        None,
                        Some(Stroke::new(OBSTACLE.tint(0.5), 0.5)),
                    );
                }
            }
        }
    }
}

/// A plane: an area, or where it is seen edge-on a line, hatched on the side of the body.
fn draw_plane(svg: &mut Svg, view: &Projection, corners: &[Point], normal: Vec3) {
    if corners.len() < 3 {
        return;
    }
    if normal.dot(view.towards()).abs() > EDGE_ON {
        let rim = Stroke::new(OBSTACLE.tint(0.5), 0.7);
        svg.polygon(corners, Some(Fill::new(OBSTACLE.tint(PLANE)).opacity(0.5)), Some(rim));
        return;
    }
    let distance = |a: Point, b: Point| (a[0] - b[0]).hypot(a[1] - b[1]);
    let farthest = |from: Point| {
        let far = corners
            .iter()
            .copied()
            .max_by(|&a, &b| distance(from, a).total_cmp(&distance(from, b)));
        far.unwrap_or(from)
    };
    let a = farthest(corners[0]);
    let b = farthest(a);
    let length = distance(a, b);
    let ([ux, uy], [right, up]) =
        ([(b[0] - a[0]) / length, (b[1] - a[1]) / length], view.plane(normal));
    // Into the body, and along the line at half a right angle.
    let into = [-right, up];
    let (sin, cos) = (0.5 * FRAC_PI_2).sin_cos();
    let step = [cos * into[0] + sin * ux, cos * into[1] + sin * uy];
    let thin = Stroke::new(OBSTACLE.tint(0.75), 0.8);
    let count = (length / HATCH).floor().min(2000.0) as usize;
    for k in 0..=count {
        let along = HATCH * k as f64;
        let p = [a[0] + along * ux, a[1] + along * uy];
        svg.line(p, [p[0] + HATCH * step[0], p[1] + HATCH * step[1]], thin);
    }
    svg.line(a, b, Stroke::new(OBSTACLE, 1.6));
}
