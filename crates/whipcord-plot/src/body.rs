//! What of a robot is drawn, in space: backbone, disks and cables of one shape.

use core::f64::consts::TAU;

use whipcord::{Pose, Robot, Routing, Section, Shape, UnitQuaternion, Vec3};

use crate::error::{PlotError, finite};
use crate::robot_figure::{CableCourse, RobotView};

/// A stretch of backbone or cable between two disks.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub part: Part,
    /// Section it lies in, from 0; that after the last disk is where nothing but knots are.
    pub section: usize,
    pub points: Vec<Vec3>,
    /// Frames of the backbone at the points; none for a cable.
    pub frames: Vec<Pose>,
    /// Cross-section of the backbone.
    pub profile: Profile,
    /// Whether it is the first or the last of the backbone.
    pub end: bool,
}

/// What of a cross-section can be seen. Extents in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Profile {
    /// None, or not known.
    None,
    Round {
        diameter: f64,
    },
    Bar {
        width: f64,
        height: f64,
    },
}

impl Profile {
    /// Half extents along x and y.
    pub fn half_extents(self) -> [f64; 2] {
        match self {
            Self::None => [0.0; 2],
            Self::Round { diameter } => [0.5 * diameter; 2],
            Self::Bar { width, height } => [0.5 * width, 0.5 * height],
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Backbone,
    /// A cable, by its index.
    Cable(usize),
    /// Where a cable is anchored: one point.
    Anchor(usize),
}

#[derive(Clone, Debug)]
pub(crate) struct Disk {
    pub pose: Pose,
    pub radius: f64,
    /// Centres of the holes in space.
    pub holes: Vec<Vec3>,
    pub hole_radius: f64,
}

/// A disk as pictures have it, in its own frame. Lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Radius of its rim: what the robot gives, or enough for its holes, cables and backbone.
    pub radius: f64,
    /// Centres of its holes, (x, y); none where they would be a blur.
    pub holes: Vec<[f64; 2]>,
    /// Radius of its holes, which the robot does not give.
    pub hole_radius: f64,
}

/// All that is drawn of one shape.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub pieces: Vec<Piece>,
    pub disks: Vec<Disk>,
}

/// About as many points as a backbone needs to look smooth at any bend.
const POINTS: usize = 192;
/// About as many pieces as are put in order of depth along a backbone.
const PIECES: usize = 32;
/// With more holes than this on all disks none is drawn: they would be a blur.
const MOST_HOLES: usize = 600;
/// Rim outside the holes, relative to the radius of their circle.
const RIM: f64 = 1.2;
/// Radius of a hole, relative to its distance from the centre.
const HOLE: f64 = 0.1;
/// That relative to the distance from the next hole or the rim: a wall stays between.
const APART: f64 = 0.45;
/// A cable that ends this near to a disk, relative to the length, ends at it.
const ONE_PLACE: f64 = 1e-9;

impl Piece {
    fn cable(part: Part, section: usize, points: Vec<Vec3>) -> Self {
        Self { part, section, points, frames: vec![], profile: Profile::None, end: false }
    }
}

impl Body {
    /// The parts of a robot in this shape.
    pub fn new(robot: &Robot, view: &RobotView) -> Result<Self, PlotError> {
        let RobotView { label, shape, disks, .. } = view;
        check_shape(shape, &format!("the shape of `{label}`"), 2)?;
        check_shape(disks, &format!("the disks of `{label}`"), 1)?;
        let knots = &robot.disks().arc_lengths;
        if disks.poses.len() != knots.len() {
            return Err(PlotError::Count {
                what: format!("the list of disks of `{label}`"),
                given: disks.poses.len(),
                expected: knots.len(),
            });
        }
        let mut pieces = pieces(robot, view);
        pieces.extend(anchors(robot, shape));
        Ok(Self { pieces, disks: plates(robot, disks) })
    }

    /// Points that between them span everything that is drawn.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> + '_ {
        let rims = self.disks.iter().flat_map(|disk| {
            (0..16).map(|k| {
                let (sin, cos) = (TAU * f64::from(k) / 16.0).sin_cos();
                disk.pose.transform(disk.radius * Vec3::new(cos, sin, 0.0))
            })
        });
        let sides = self.pieces.iter().flat_map(|piece| {
            let [w, h] = piece.profile.half_extents();
            let corners = [[w, h], [-w, h], [-w, -h], [w, -h]].map(|[x, y]| Vec3::new(x, y, 0.0));
            let frames = piece.frames.iter().copied();
            frames.flat_map(move |frame| corners.into_iter().map(move |c| frame.transform(c)))
        });
        self.pieces.iter().flat_map(|piece| piece.points.iter().copied()).chain(rims).chain(sides)
    }
}

fn check_shape(shape: &Shape, what: &str, least: usize) -> Result<(), PlotError> {
    let (given, expected) = (shape.poses.len(), shape.arc_length.len());
    if given == 0 {
        return Err(PlotError::Empty { what: what.to_owned() });
    }
    if given != expected || given < least {
        let expected = expected.max(least);
        return Err(PlotError::Count { what: what.to_owned(), given, expected });
    }
    for (s, pose) in shape.arc_length.iter().zip(&shape.poses) {
        let p = pose.position;
        let numbers = [*s, p.x, p.y, p.z].into_iter().chain(pose.rotation.wxyz());
        for value in numbers {
            finite(|| format!("a number of {what}"), value)?;
        }
    }
    if shape.arc_length.windows(2).any(|w| w[1] <= w[0]) {
        return Err(PlotError::NotIncreasing { what: format!("the arc length of {what}") });
    }
    Ok(())
}

fn pieces(robot: &Robot, view: &RobotView) -> Vec<Piece> {
    let shape = &view.shape;
    let knots = &robot.disks().arc_lengths;
    let sections = knots.len() - 1;
    let per_section = PIECES.div_ceil(sections).min(8);
    let per_piece = POINTS.div_ceil(sections * per_section).clamp(2, 24);
    let mut pieces = Vec::new();
    for section in 0..sections {
        for k in 0..per_section {
            let at = |k: usize| {
                let t = k as f64 / per_section as f64;
                knots[section] * (1.0 - t) + knots[section + 1] * t
            };
            let (start, end) = (at(k), at(k + 1));
            let sample = |start: f64, end: f64, offset: &dyn Fn(f64) -> Vec3| -> Vec<Pose> {
                (0..=per_piece)
                    .map(|j| {
                        let t = j as f64 / per_piece as f64;
                        let s = start * (1.0 - t) + end * t;
                        let frame = pose_at(shape, s);
                        Pose { position: frame.transform(offset(s)), ..frame }
                    })
                    .collect()
            };
            let frames = sample(start, end, &|_| Vec3::ZERO);
            pieces.push(Piece {
                part: Part::Backbone,
                section,
                points: frames.iter().map(|frame| frame.position).collect(),
                frames,
                profile: profile(robot, 0.5 * (start + end)),
                end: (section == 0 && k == 0) || (section + 1 == sections && k + 1 == per_section),
            });
            for (i, route) in robot.routes().iter().enumerate() {
                let end = end.min(route.end());
                if end <= start {
                    continue;
                }
                let points = match view.cables {
                    CableCourse::Smooth => {
                        let frames = sample(start, end, &|s| route.at(s).offset);
                        frames.iter().map(|frame| frame.position).collect()
                    }
                    CableCourse::HoleToHole => {
                        let far = knots[section + 1].min(route.end());
                        let [from, to] = [knots[section], far]
                            .map(|s| pose_at(shape, s).transform(route.at(s).offset));
                        let on_chord = |s: f64| {
                            let t = (s - knots[section]) / (far - knots[section]);
                            from * (1.0 - t) + to * t
                        };
                        vec![on_chord(start), on_chord(end)]
                    }
                };
                pieces.push(Piece::cable(Part::Cable(i), section, points));
            }
        }
    }
    pieces
}

/// Each cable ends in a knot on the upper face of a disk, or where it is anchored between disks.
fn anchors(robot: &Robot, shape: &Shape) -> impl Iterator<Item = Piece> {
    let knots = &robot.disks().arc_lengths;
    robot.routes().iter().enumerate().map(|(i, route)| {
        let s = route.end();
        let at = pose_at(shape, s).transform(route.at(s).offset);
        let above = knots.iter().filter(|&&knot| knot <= s).count();
        Piece::cable(Part::Anchor(i), above.saturating_sub(1), vec![at])
    })
}

fn plates(robot: &Robot, shape: &Shape) -> Vec<Disk> {
    let placed = plates_of(robot).into_iter().zip(&shape.poses);
    placed
        .map(|(plate, &pose)| {
            let place = |&[x, y]: &[f64; 2]| pose.transform(Vec3::new(x, y, 0.0));
            let holes = plate.holes.iter().map(place).collect();
            Disk { pose, radius: plate.radius, holes, hole_radius: plate.hole_radius }
        })
        .collect()
}

/// The disks of a robot as pictures have them, from the base on.
#[must_use]
pub fn plates_of(robot: &Robot) -> Vec<Plate> {
    let disks = robot.disks();
    let rings = &disks.hole_circle_radii;
    let is_clear = |holes: usize| holes.saturating_mul(disks.count()) <= MOST_HOLES;
    let given = disks.holes.filter(|&holes| !rings.is_empty() && is_clear(holes)).unwrap_or(0);
    (0..disks.count())
        .map(|i| {
            let s = disks.arc_lengths[i];
            // A disk reaches beyond its holes, the cables that pass it, and the backbone.
            let passing = passing(robot, s);
            let widest = passing.iter().map(|(_, at)| at.norm()).fold(0.0, f64::max);
            let ring = rings.get(i).copied().unwrap_or(0.0);
            let [w, h] = profile(robot, s).half_extents();
            let mut radius = (RIM * ring.max(widest)).max(1.5 * w.max(h));
            if radius == 0.0 {
                radius = 0.02 * robot.backbone().length;
            }
            let radius = disks.outer_radius.unwrap_or(radius);
            let centres = (0..given).map(|k| {
                let (sin, cos) = (TAU * k as f64 / given as f64).sin_cos();
                [ring * cos, ring * sin]
            });
            let mut plate = Plate { radius, holes: centres.collect(), hole_radius: 0.0 };
            if given > 0 {
                // Holes fill a third of their circle at most.
                plate.hole_radius = (0.33 * 0.5 * TAU * ring / given as f64).min(HOLE * ring);
            }
            if is_clear(passing.len()) {
                // Cables that are told to run through holes run through those that are given.
                let curves = passing.iter().filter(|(by, _)| !matches!(by, Routing::Holes { .. }));
                plate.pierce(curves.map(|&(_, at)| [at.x, at.y]).collect());
            }
            plate
        })
        .collect()
}

/// The cables that pass an arc length, and where.
fn passing(robot: &Robot, s: f64) -> Vec<(&Routing, Vec3)> {
    let reach = ONE_PLACE * robot.backbone().length;
    let all = robot.cables().iter().zip(robot.routes());
    let there = all.filter(|(_, route)| s <= route.end() + reach);
    there.map(|(cable, route)| (&cable.routing, route.at(s.min(route.end())).offset)).collect()
}

impl Plate {
    /// Makes holes at these places, where there is none yet. Holes keep within the rim and apart from one another, so that
    /// a place beyond the rim gets none.
    fn pierce(&mut self, mut places: Vec<[f64; 2]>) {
        let from_centre = |[x, y]: [f64; 2]| x.hypot(y);
        places.retain(|&place| from_centre(place) < self.radius);
        if self.hole_radius == 0.0 {
            self.hole_radius = HOLE * places.iter().map(|&p| from_centre(p)).fold(0.0, f64::max);
        }
        if self.hole_radius == 0.0 {
            return;
        }
        // A new hole may make all smaller, and a cable that ran in one of them need its own.
        let mut before = usize::MAX;
        while before != self.holes.len() {
            before = self.holes.len();
            self.pierce_once(&places);
        }
    }

    fn pierce_once(&mut self, places: &[[f64; 2]]) {
        for &place in places {
            let apart = |hole: &[f64; 2]| (hole[0] - place[0]).hypot(hole[1] - place[1]);
            let nearest = self.holes.iter().map(apart).fold(f64::INFINITY, f64::min);
            // A cable that runs in a hole needs no other.
            if nearest > self.hole_radius {
                self.holes.push(place);
                let beside = APART * nearest.min(self.radius - place[0].hypot(place[1]));
                self.hole_radius = self.hole_radius.min(beside);
            }
        }
    }
}

/// What the backbone's cross-section looks like at an arc length.
fn profile(robot: &Robot, s: f64) -> Profile {
    let disks = robot.disks();
    match &robot.backbone().section {
        None => Profile::None,
        Some(Section::Round { outer, .. }) => Profile::Round { diameter: outer.at(disks, s) },
        Some(Section::Rectangle { width, height }) => {
            Profile::Bar { width: width.at(disks, s), height: height.at(disks, s) }
        }
    }
}

/// The pose at an arc length, between the stations on a cubic that leaves them along their
/// tangents.
pub(crate) fn pose_at(shape: &Shape, s: f64) -> Pose {
    let (arcs, poses) = (&shape.arc_length, &shape.poses);
    let last = arcs.len() - 1;
    let i = arcs[1..last].partition_point(|&a| a <= s);
    let t = ((s - arcs[i]) / (arcs[i + 1] - arcs[i])).clamp(0.0, 1.0);
    let (a, b) = (poses[i], poses[i + 1]);
    let turn = a.rotation.conjugate() * b.rotation;
    let rotation = (a.rotation * UnitQuaternion::exp(turn.log() * t)).renormalized();
    let chord = (b.position - a.position).norm();
    let (from, to) = (a.rotation.rotate(Vec3::Z) * chord, b.rotation.rotate(Vec3::Z) * chord);
    let (t2, t3) = (t * t, t * t * t);
    let position = a.position * (2.0 * t3 - 3.0 * t2 + 1.0)
        + from * (t3 - 2.0 * t2 + t)
        + b.position * (3.0 * t2 - 2.0 * t3)
        + to * (t3 - t2);
    Pose { position, rotation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot_figure::ViewStyle;
    use whipcord::{Backbone, Cable, Disks};

    #[test]
    fn cables_from_hole_to_hole_are_as_long_as_their_chords() {
        let disks = Disks::equally_spaced(0.1, 3, 0.01).with_holes(4);
        let cable = Cable::new("turning", Routing::holes(vec![1, 2, 3]));
        let robot = Robot::new(Backbone::new(0.1), disks, vec![cable]).unwrap();
        let shape = Shape::straight(&robot.disks().arc_lengths);
        let length = |cables| {
            let (shape, disks) = (shape.clone(), shape.clone());
            let view =
                RobotView { label: String::new(), shape, disks, cables, style: ViewStyle::Model };
            let body = Body::new(&robot, &view).unwrap();
            let cable = body.pieces.iter().filter(|piece| matches!(piece.part, Part::Cable(_)));
            let along = cable.flat_map(|piece| piece.points.windows(2));
            along.map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>()
        };
        // A quarter of a turn has a chord of √2 · 10 mm.
        let chords = 2.0 * (0.05_f64.powi(2) + 2.0 * 0.01_f64.powi(2)).sqrt();
        assert!((length(CableCourse::HoleToHole) - chords).abs() < 1e-15);
        assert!(length(CableCourse::Smooth) > 1.001 * chords);
    }

    fn plates(disks: Disks, routings: Vec<(Routing, Option<f64>)>) -> Vec<Plate> {
        let cables = routings.into_iter().enumerate().map(|(k, (routing, ends_at))| Cable {
            ends_at,
            ..Cable::new(format!("{k}"), routing)
        });
        plates_of(&Robot::new(Backbone::new(0.1), disks, cables.collect()).unwrap())
    }

    #[test]
    fn disks_have_holes_where_cables_pass_them() {
        let straight = |angle, radius| Routing::Straight { angle, radius };
        let helix = Routing::Helix { start_angle: 0.0, turns: 0.5, radius: 0.008 };
        let found = plates(
            Disks::equally_spaced(0.1, 3, 0.01),
            vec![(helix, None), (straight(-1.0, 0.009), Some(0.05))],
        );
        let [sin, cos] = [-0.009 * 1_f64.sin(), 0.009 * 1_f64.cos()];
        let expected = [
            vec![[0.008, 0.0], [cos, sin]],
            vec![[0.0, 0.008], [cos, sin]],
            // The second cable ends below.
            vec![[-0.008, 0.0]],
        ];
        for (plate, expected) in found.iter().zip(expected) {
            assert_eq!(plate.holes.len(), expected.len(), "{plate:?}");
            for (hole, [x, y]) in plate.holes.iter().zip(expected) {
                assert!((hole[0] - x).hypot(hole[1] - y) < 1e-12, "{hole:?} {x} {y}");
            }
            assert!((5e-4..=9e-4).contains(&plate.hole_radius));
        }
    }

    #[test]
    fn holes_keep_apart_and_within_the_rim() {
        let straight = |angle, radius| (Routing::Straight { angle, radius }, None);
        let mut disks = Disks::equally_spaced(0.1, 2, 0.01).with_holes(4);
        disks.outer_radius = Some(0.0105);
        let cables = vec![
            straight(0.0, 0.01),  // in the first hole
            straight(0.13, 0.01), // beside it
            straight(0.4, 0.02),  // beyond the rim
            (Routing::holes(vec![2, 3]), None),
        ];
        for plate in plates(disks, cables) {
            assert_eq!(plate.holes.len(), 5);
            let (holes, r) = (&plate.holes, plate.hole_radius);
            assert!(r > 1e-4);
            for (i, [x, y]) in holes.iter().enumerate() {
                assert!(x.hypot(*y) + r < plate.radius);
                assert!(holes[..i].iter().all(|[a, b]| (a - x).hypot(b - y) > 2.0 * r));
            }
        }
    }
}
