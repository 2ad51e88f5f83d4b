//! The obstacles around a robot in motion, and what of the robot is near them.

use whipcord::contact::body::{Nearest, Rim};
use whipcord::contact::member::Member;
use whipcord::shape::Part;
use whipcord::{Case, Obstacle, Robot};
use whipcord_numerics::{Pose, Twist, Vec3, golden_section};

use crate::element::{NODES, PLACES, POINTS, pose_at, shapes};
use crate::error::MotionError;
use crate::rod::Rod;

/// A cross-section by its place in the elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Station {
    pub element: usize,
    /// From 0 at the start of the element to 1 at its end.
    pub fraction: f64,
}

impl Station {
    /// At an arc length in m.
    pub fn at(rod: &Rod, arc_length: f64) -> Self {
        let starts = rod.nodes.iter().step_by(POINTS).take(rod.elements());
        let element = starts.filter(|node| node.arc_length < arc_length).count().max(1) - 1;
        let fraction = (arc_length - rod.nodes[POINTS * element].arc_length) / rod.lengths[element];
        Self { element, fraction: fraction.clamp(0.0, 1.0) }
    }

    /// Of a node beyond the base.
    pub fn of_node(node: usize) -> Self {
        let element = (node - 1) / POINTS;
        Self { element, fraction: PLACES[node - POINTS * element] }
    }

    /// The velocity there is the sum of those of the three nodes of the element with these weights.
    pub fn shapes(self) -> [f64; NODES] {
        shapes(self.fraction)
    }
}

/// A rod in a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Posed<'a> {
    pub rod: &'a Rod,
    pub strains: &'a [Twist],
    /// Poses of the nodes, in the frame of the base at the start of the motion.
    pub poses: &'a [Pose],
}

impl Posed<'_> {
    pub fn at(&self, station: Station) -> Pose {
        let (q, h) = (POINTS * station.element, self.rod.lengths[station.element]);
        pose_at(&self.poses[q..], &self.strains[q..], h, station.fraction)
    }
}

/// A part of the robot near an obstacle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    pub obstacle: usize,
    pub member: Member,
    pub station: Station,
    pub nearest: Nearest,
    /// Whether it stays where it is on the rim: where that is about as near all around.
    pub keeps_place: bool,
}

/// The obstacles, and the parts of the robot that are watched.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    /// In the frame of the base at the start of the motion.
    pub obstacles: Vec<Obstacle>,
    disks: Vec<(Station, Member)>,
    /// Places of the backbone in the order of their arc lengths.
    watched: Vec<(Station, Member)>,
}

/// Fractions of an element at which the backbone is watched.
const WATCHED: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// A rim whose distances differ by less than this part of its radius is about as near all around.
const ALL_AROUND: f64 = 0.05;
/// Places of such a rim that are looked at.
const AROUND: usize = 4;
/// Steps of the search for the least gap between three watched places.
const SECTIONS: usize = 20;
/// Looks at a part on its way from one pose to another.
const LOOKS: f64 = 64.0;

impl Surroundings {
    /// Of a case; `None` without obstacles.
    pub fn new(robot: &Robot, rod: &Rod, case: &Case) -> Result<Option<Self>, MotionError> {
        if let Some(k) = case.obstacles.iter().position(|obstacle| obstacle.movable.is_some()) {
            return Err(MotionError::Unsupported {
                path: format!("obstacles[{k}].mass"),
                what: "a movable object",
                advice: "leave its mass out, so that the obstacle stays where it is, or solve the statics with steps of actuation",
            });
        }
        if case.obstacles.is_empty() {
            return Ok(None);
        }
        let to_base = case.base.inverse();
        let seen =
            |obstacle: &Obstacle| Obstacle { pose: to_base * obstacle.pose, ..obstacle.clone() };
        let disk =
            |member: Member| (Station::of_node(rod.node_at(member.arc_length).max(1)), member);
        let mut watched = Vec::with_capacity(WATCHED.len() * rod.elements());
        for (element, &h) in rod.lengths.iter().enumerate() {
            let start = rod.nodes[POINTS * element].arc_length;
            for fraction in WATCHED {
                let member = Member::backbone(robot, start + fraction * h);
                watched.push((Station { element, fraction }, member));
            }
        }
        Ok(Some(Self {
            obstacles: case.obstacles.iter().map(seen).collect(),
            disks: Member::disks(robot).into_iter().map(disk).collect(),
            watched,
        }))
    }

    /// All places that are nearer to an obstacle than their neighbours and no farther than `within`, and those that overlap by more than
    /// `overlap`, into `found`.
    pub fn near(&self, shape: &Posed<'_>, within: f64, overlap: f64, found: &mut Vec<Near>) {
        found.clear();
        let mut places = Vec::new();
        for (k, obstacle) in self.obstacles.iter().enumerate() {
            for &(station, member) in &self.disks {
                let pose = shape.at(station);
                let near = |nearest: Nearest, keeps_place: bool| Near {
                    obstacle: k,
                    member,
                    station,
                    nearest,
                    keeps_place,
                };
                match member.body.nearest(obstacle, &pose, within, &mut places) {
                    Rim::Spread(spread) if spread < ALL_AROUND => {
                        let first = places.first().map_or(0.0, |p| p.local[1].atan2(p.local[0]));
                        let quarter = core::f64::consts::TAU / AROUND as f64;
                        found.extend((0..AROUND).map(|i| {
                            let local = member.body.on_rim(first + i as f64 * quarter);
                            near(member.body.at_place(obstacle, &pose, local), true)
                        }));
                    }
                    _ => found.extend(places.iter().map(|nearest| near(*nearest, false))),
                }
            }
            self.near_along(shape, k, [within, overlap], found);
        }
    }

    /// The same of the backbone and one obstacle.
    fn near_along(
        &self,
        shape: &Posed<'_>,
        k: usize,
        [within, overlap]: [f64; 2],
        found: &mut Vec<Near>,
    ) {
        let obstacle = &self.obstacles[k];
        let first = found.len();
        // The distance changes by no more than the place moves.
        let (mut from, mut known) = (Vec3::ZERO, f64::NEG_INFINITY);
        let gap = |(station, member): &(Station, Member)| {
            let centre = shape.at(*station).position;
            if known - (centre - from).norm() - member.body.rounding > within {
                return f64::INFINITY;
            }
            (from, known) = (centre, obstacle.surface(centre).distance);
            known - member.body.rounding
        };
        let gaps: Vec<f64> = self.watched.iter().map(gap).collect();
        for (i, &(station, member)) in self.watched.iter().enumerate() {
            let before = if i == 0 { f64::INFINITY } else { gaps[i - 1] };
            let (here, after) = (gaps[i], gaps.get(i + 1).copied().unwrap_or(f64::INFINITY));
            if here <= within && here < before && here <= after {
                let station = match (before.is_finite(), after.is_finite()) {
                    (true, true) => self.lowest(shape, k, i),
                    _ => station,
                };
                found.push(self.on_backbone(shape, k, station, member));
            }
        }
        for (i, &(station, member)) in self.watched.iter().enumerate() {
            let spacing = self.spacing(i, shape.rod);
            let is_known =
                |other: &Near| (other.member.arc_length - member.arc_length).abs() < 0.6 * spacing;
            if gaps[i] < -overlap && !found[first..].iter().any(is_known) {
                found.push(self.on_backbone(shape, k, station, member));
            }
        }
    }

    /// Distance in m of a watched place to the one before.
    fn spacing(&self, i: usize, rod: &Rod) -> f64 {
        rod.lengths[self.watched[i].0.element] / WATCHED.len() as f64
    }

    /// Where the gap is least between the neighbours of a watched place.
    fn lowest(&self, shape: &Posed<'_>, k: usize, i: usize) -> Station {
        let s = |i: usize| self.watched[i].1.arc_length;
        let (from, to) = (s(i - 1), s(i + 1));
        let at = |x: f64| Station::at(shape.rod, from + x * (to - from));
        let rounding = self.watched[i].1.body.rounding;
        let (x, _) = golden_section(SECTIONS, |x| {
            self.obstacles[k].surface(shape.at(at(x)).position).distance - rounding
        });
        at(x)
    }

    fn on_backbone(&self, shape: &Posed<'_>, k: usize, station: Station, of: Member) -> Near {
        let rod = shape.rod;
        let arc_length = rod.nodes[POINTS * station.element].arc_length
            + station.fraction * rod.lengths[station.element];
        let member = Member { part: Part::Backbone, arc_length, ..of };
        let nearest = member.body.at_place(&self.obstacles[k], &shape.at(station), [0.0, 0.0]);
        Near { obstacle: k, member, station, nearest, keeps_place: false }
    }

    /// The part of the way between two shapes at which the robot first overlaps an obstacle by more than `overlap`, if each of its cross-sections moves
    /// straight.
    pub fn first_hit(&self, from: &Posed<'_>, to: &Posed<'_>, overlap: f64) -> Option<f64> {
        // What hits between two watched places is deepest at neither of them.
        let mut behind = Vec::new();
        self.near(to, 0.0, f64::INFINITY, &mut behind);
        let between = behind.iter().map(|near| (near.station, near.member));
        let all = self.disks.iter().chain(&self.watched).copied().chain(between);
        let hits = all.filter_map(|(station, member)| {
            self.first_hit_of(&member, from.at(station), to.at(station), overlap)
        });
        hits.min_by(f64::total_cmp)
    }

    /// The same for one part of the robot.
    fn first_hit_of(&self, member: &Member, start: Pose, end: Pose, overlap: f64) -> Option<f64> {
        let way = (start.inverse() * end).log();
        let moved = (end.position - start.position).norm() + way.angular.norm() * member.body.flat;
        let mut places = Vec::new();
        let hits = self.obstacles.iter().filter_map(|obstacle| {
            let mut gap = |pose: &Pose| {
                if member.body.is_ball() {
                    return obstacle.surface(pose.position).distance - member.body.rounding;
                }
                member.body.nearest(obstacle, pose, f64::INFINITY, &mut places);
                places.iter().map(|near| near.gap).fold(f64::INFINITY, f64::min)
            };
            let (at_start, at_end) = (gap(&start), gap(&end));
            if at_start < -overlap {
                // It overlapped before: what counts is that it gets worse.
                return (at_end < at_start - overlap).then_some(0.0);
            }
            if at_end >= -overlap && moved <= at_start + at_end {
                return None;
            }
            let least = 0.5 * member.body.reach();
            let mut at = |t: f64| gap(&(start * Pose::exp(way * t)));
            first_below(&mut at, at_start, -overlap, [least, moved])
        });
        hits.min_by(f64::total_cmp)
    }

    /// How deep in m the robot is in an obstacle, and in which.
    pub fn deepest(&self, shape: &Posed<'_>) -> Option<(usize, f64)> {
        let mut places = Vec::new();
        self.near(shape, 0.0, 0.0, &mut places);
        places
            .iter()
            .map(|near| (near.obstacle, -near.nearest.gap))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Where a gap that begins with `start` and changes by no more than `moved` over its way first falls below a limit: looked at in steps of the gap, no
/// shorter than `least` and a fraction of the way.
fn first_below(
    gap: &mut impl FnMut(f64) -> f64,
    start: f64,
    limit: f64,
    [least, moved]: [f64; 2],
) -> Option<f64> {
    const HALVINGS: usize = 12;
    let (mut t, mut here) = (0.0, start);
    while t < 1.0 {
        let step = here.max(least).max(moved / LOOKS) / moved.max(f64::MIN_POSITIVE);
        let next = (t + step).min(1.0);
        here = gap(next);
        if here < limit {
            let (mut low, mut high) = (t, next);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if gap(middle) < limit { high = middle } else { low = middle }
            }
            return Some(low);
        }
        t = next;
    }
    None
}
