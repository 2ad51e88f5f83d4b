//! What of a robot is drawn, in space: backbone, disks and cables of one shape.

use core::f64::consts::TAU;

use whipcord::{Pose, Robot, Section, Shape, Vec3};

use crate::error::{PlotError, finite};
use crate::plates::plates_of;
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
    /// Cross-sections of the backbone at the frames.
    pub profiles: Vec<Profile>,
    /// Whether it is the first or the last of the backbone.
    pub end: bool,
    /// How much of its start and of its end lies inside a disk, in m.
    pub hidden: [f64; 2],
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
    /// Half of its thickness.
    pub half: f64,
    /// Centres of the holes in space.
    pub holes: Vec<Vec3>,
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
impl Piece {
    fn cable(part: Part, section: usize, points: Vec<Vec3>, hidden: [f64; 2]) -> Self {
        Self { part, section, points, frames: vec![], profiles: vec![], end: false, hidden }
    }

    /// What is not inside disks.
    pub fn visible(&self) -> Self {
        let lengths: Vec<f64> = self
            .points
            .iter()
            .zip(self.points.iter().skip(1))
            .scan(0.0, |along, (a, b)| {
                *along += (*b - *a).norm();
                Some(*along)
            })
            .collect();
        let [start, end] = [self.hidden[0], lengths.last().unwrap_or(&0.0) - self.hidden[1]];
        let mut seen =
            Self { points: vec![], frames: vec![], profiles: vec![], hidden: [0.0; 2], ..*self };
        for (i, &to) in lengths.iter().enumerate() {
            let from = if i == 0 { 0.0 } else { lengths[i - 1] };
            let [first, last] = [start, end].map(|s| ((s - from) / (to - from)).clamp(0.0, 1.0));
            if from >= end || to <= start || first >= last {
                continue;
            }
            if seen.points.is_empty() {
                seen.push_between(self, i, first);
            }
            seen.push_between(self, i, last);
        }
        seen
    }

    /// Adds what lies between the points i and i + 1 of another piece.
    fn push_between(&mut self, of: &Self, i: usize, t: f64) {
        let position = of.points[i] * (1.0 - t) + of.points[i + 1] * t;
        self.points.push(position);
        let nearest = i + usize::from(t > 0.5);
        if let (Some(frame), Some(profile)) = (of.frames.get(nearest), of.profiles.get(nearest)) {
            self.frames.push(Pose { position, ..*frame });
            self.profiles.push(*profile);
        }
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
        let disks = plates(robot, disks);
        let mut pieces = pieces(robot, view, &disks);
        pieces.extend(anchors(robot, shape, &disks));
        Ok(Self { pieces, disks })
    }

    /// Points that between them span everything that is drawn.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> + '_ {
        let rims = self.disks.iter().flat_map(|disk| {
            (0..32).map(|k| {
                let (sin, cos) = (TAU * f64::from(k / 2) / 16.0).sin_cos();
                let face = if k % 2 == 0 { disk.half } else { -disk.half };
                disk.pose.transform(disk.radius * Vec3::new(cos, sin, 0.0) + Vec3::Z * face)
            })
        });
        let sides = self.pieces.iter().flat_map(|piece| {
            piece.frames.iter().zip(&piece.profiles).flat_map(|(frame, profile)| {
                let [w, h] = profile.half_extents();
                [[w, h], [-w, h], [-w, -h], [w, -h]]
                    .map(|[x, y]| frame.transform(Vec3::new(x, y, 0.0)))
            })
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

fn pieces(robot: &Robot, view: &RobotView, disks: &[Disk]) -> Vec<Piece> {
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
                        let frame = shape.at(s);
                        Pose { position: frame.transform(offset(s)), ..frame }
                    })
                    .collect()
            };
            let hidden = [
                if k == 0 { half(disks, section) } else { 0.0 },
                if k + 1 == per_section { half(disks, section + 1) } else { 0.0 },
            ];
            let frames = sample(start, end, &|_| Vec3::ZERO);
            let along = |j: usize| {
                let t = j as f64 / per_piece as f64;
                start * (1.0 - t) + end * t
            };
            pieces.push(Piece {
                part: Part::Backbone,
                section,
                points: frames.iter().map(|frame| frame.position).collect(),
                profiles: (0..frames.len()).map(|j| profile(robot, along(j))).collect(),
                frames,
                hidden,
                end: (section == 0 && k == 0) || (section + 1 == sections && k + 1 == per_section),
            });
            for (i, route) in robot.routes().iter().enumerate() {
                let hidden = [hidden[0], if end <= route.end() { hidden[1] } else { 0.0 }];
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
                            .map(|s| shape.at(s).transform(route.at(s).offset));
                        let on_chord = |s: f64| {
                            let t = (s - knots[section]) / (far - knots[section]);
                            from * (1.0 - t) + to * t
                        };
                        vec![on_chord(start), on_chord(end)]
                    }
                };
                pieces.push(Piece::cable(Part::Cable(i), section, points, hidden));
            }
        }
    }
    pieces
}

/// Half the thickness of a disk; 0 where there is none.
fn half(disks: &[Disk], disk: usize) -> f64 {
    disks.get(disk).map_or(0.0, |disk| disk.half)
}

/// Each cable ends in a knot on the upper face of a disk, or where it is anchored between disks.
fn anchors(robot: &Robot, shape: &Shape, disks: &[Disk]) -> impl Iterator<Item = Piece> {
    let knots = &robot.disks().arc_lengths;
    robot.routes().iter().enumerate().map(|(i, route)| {
        let s = route.end();
        let above = knots.iter().filter(|&&knot| knot <= s).count();
        let disk = above.checked_sub(1).filter(|&disk| knots[disk] == s);
        let face = disk.map_or(0.0, |disk| half(disks, disk));
        let at = shape.at(s).transform(route.at(s).offset + Vec3::Z * face);
        Piece::cable(Part::Anchor(i), above.saturating_sub(1), vec![at], [0.0; 2])
    })
}

fn plates(robot: &Robot, shape: &Shape) -> Vec<Disk> {
    let placed = plates_of(robot).into_iter().zip(&shape.poses);
    placed
        .map(|(plate, &pose)| {
            let place = |&[x, y]: &[f64; 2]| pose.transform(Vec3::new(x, y, 0.0));
            let holes = plate.holes.iter().map(place).collect();
            let half = 0.5 * plate.thickness;
            Disk { pose, radius: plate.radius, half, holes, hole_radius: plate.hole_radius }
        })
        .collect()
}

/// What the backbone's cross-section looks like at an arc length.
pub(crate) fn profile(robot: &Robot, s: f64) -> Profile {
    let disks = robot.disks();
    match &robot.backbone().section {
        None => Profile::None,
        Some(Section::Round { outer, .. }) => Profile::Round { diameter: outer.at(disks, s) },
        Some(Section::Rectangle { width, height }) => {
            Profile::Bar { width: width.at(disks, s), height: height.at(disks, s) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot_figure::ViewStyle;
    use whipcord::{Backbone, Cable, Disks, Routing};

    #[test]
    fn cables_from_hole_to_hole_are_as_long_as_their_chords() {
        let disks = Disks::equally_spaced(0.1, 3, 0.01).with_holes(4);
        let cable = Cable::new("turning", Routing::holes(vec![1, 2, 3]));
        let robot = Robot::new(Backbone::new(0.1), disks, vec![cable]).unwrap();
        let shape = Shape::straight(&robot.disks().arc_lengths);
        let length = |cables| {
            let (shape, disks) = (shape.clone(), shape.clone());
            let view = RobotView {
                label: String::new(),
                shape,
                disks,
                cables,
                style: ViewStyle::Model(whipcord::ModelKind::Cosserat),
            };
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
}
