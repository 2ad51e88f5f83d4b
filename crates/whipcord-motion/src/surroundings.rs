//! The obstacles around a robot in motion, and what of the robot is near them.

use whipcord::contact::body::{Nearest, Rim};
use whipcord::contact::member::Member;
use whipcord::solution::Part;
use whipcord::{Case, Obstacle, Robot};
use whipcord_numerics::{Pose, Twist, Vec3, golden_section};

use crate::by_shape::ByShape;
use crate::cross_section::{Posed, Station, by_displacements, displaced};
use crate::element::POINTS;
use crate::error::MotionError;
use crate::rod::Rod;

/// A part of the robot near an obstacle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    pub obstacle: usize,
    pub member: Member,
    pub station: Station,
    pub nearest: Nearest,
    /// Whether it stays where it is on the rim: where that is about as near all around.
    pub keeps_place: bool,
    /// Of a place of the backbone that was looked for: how far beside it in m the gap is as large on both sides.
    pub beside: Option<f64>,
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
/// Parts of a way that differ by less are the same.
const AT_ONCE: f64 = 1e-9;
/// Looks at a part on its way from one pose to another.
const LOOKS: f64 = 64.0;

impl Surroundings {
    /// Of a case; `None` without obstacles.
    pub fn new(
        robot: &Robot,
        rod: &Rod,
        case: &Case,
        has_free_base: bool,
    ) -> Result<Option<Self>, MotionError> {
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
        let base = Station { element: 0, fraction: 0.0 };
        let disk = |member: Member| match rod.node_at(member.arc_length) {
            0 if has_free_base => (base, member),
            node => (Station::of_node(node.max(1)), member),
        };
        let mut watched = Vec::with_capacity(WATCHED.len() * rod.elements() + 1);
        if has_free_base {
            watched.push((base, Member::backbone(robot, 0.0)));
        }
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
                    beside: None,
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
                let (station, beside) = match (before.is_finite(), after.is_finite()) {
                    (true, true) => self.lowest(shape, k, i),
                    _ => (station, None),
                };
                let near = self.on_backbone(shape, k, station, member);
                found.push(Near { beside, ..near });
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

    /// Where the gap is least between the neighbours of a watched place, and how far beside that place it is the same on both sides.
    fn lowest(&self, shape: &Posed<'_>, k: usize, i: usize) -> (Station, Option<f64>) {
        /// How far beside the place, as a part of the interval.
        const BESIDE: f64 = 5e-3;
        /// How well the search knows the place, as a part of the interval.
        const KNOWN: f64 = 1e-3;
        let s = |i: usize| self.watched[i].1.arc_length;
        let (from, to) = (s(i - 1), s(i + 1));
        let at = |x: f64| Station::at(shape.rod, from + x * (to - from));
        let distance = |x: f64| self.obstacles[k].surface(shape.at(at(x)).position).distance;
        let (x, _) = golden_section(SECTIONS, distance);
        // To rounding, which the least gap, flat there, does not give.
        let slope = |x: f64| distance(x - BESIDE) - distance(x + BESIDE);
        let ends = [x - KNOWN, x + KNOWN];
        let is_within = ends[0] > BESIDE && ends[1] < 1.0 - BESIDE;
        if !(is_within && slope(ends[0]) > 0.0 && slope(ends[1]) < 0.0) {
            return (at(x), None);
        }
        (at(false_position(slope, ends)), Some(BESIDE * (to - from)))
    }

    /// The derivative of the arc length of a place that was looked for by changes of the shape.
    pub fn place_changes(
        &self,
        shape: &Posed<'_>,
        (obstacle, station, beside): (usize, Station, f64),
    ) -> ByShape {
        let rod = shape.rod;
        let s = station.arc_length(rod);
        let surface = |s: f64| {
            let station = Station::at(rod, s);
            (station, self.obstacles[obstacle].surface(shape.at(station).position))
        };
        // Where the gap is as large on both sides.
        let apart = |s: f64| surface(s + beside).1.distance - surface(s - beside).1.distance;
        let h = 1e-2 * beside;
        let slope = (apart(s + h) - apart(s - h)) * (0.5 / h);
        let mut out = ByShape::none(rod);
        for (side, sign) in [(beside, -1.0), (-beside, 1.0)] {
            let (station, surface) = surface(s + side);
            let along = Twist { linear: surface.normal, angular: Vec3::ZERO };
            out.add(&ByShape::of_section(shape, station, along), sign / slope);
        }
        out
    }

    fn on_backbone(&self, shape: &Posed<'_>, k: usize, station: Station, of: Member) -> Near {
        let arc_length = station.arc_length(shape.rod);
        let member = Member { part: Part::Backbone, arc_length, ..of };
        let nearest = member.body.at_place(&self.obstacles[k], &shape.at(station), [0.0, 0.0]);
        Near { obstacle: k, member, station, nearest, keeps_place: false, beside: None }
    }

    /// Where the robot first overlaps an obstacle by `overlap` on its way between two shapes, if each of its cross-sections moves straight.
    pub fn first_hit(&self, from: &Posed<'_>, to: &Posed<'_>, overlap: f64) -> Option<Hit> {
        // What hits between two watched places is deepest at neither of them.
        let mut behind = Vec::new();
        self.near(to, 0.0, f64::INFINITY, &mut behind);
        let between = behind.iter().map(|near| (near.station, near.member));
        let all = self.disks.iter().chain(&self.watched).copied().chain(between);
        let mut hits = Vec::new();
        for (station, member) in all {
            for (obstacle, of) in self.obstacles.iter().enumerate() {
                let way = Way::new(of, member, [from, to].map(|shape| shape.at(station)));
                let [low, high] = match way.first_hit(overlap) {
                    Some(interval) => interval,
                    None => continue,
                };
                let hit = Hit { part: low, obstacle, member, station, overlap, is_alone: true };
                hits.push((high, hit));
            }
        }
        // Where it is the first of all it is looked at to rounding.
        let sooner = hits.iter().map(|(high, _)| *high).min_by(f64::total_cmp)?;
        hits.retain(|(_, hit)| hit.part <= sooner);
        for (high, hit) in &mut hits {
            hit.part = self.way(hit, from, to).at_overlap(overlap, [hit.part, *high]);
        }
        let first = hits.iter().map(|(_, hit)| *hit).min_by(|a, b| a.part.total_cmp(&b.part))?;
        let is_other = |hit: &Hit| {
            (hit.obstacle, hit.member.part) != (first.obstacle, first.member.part)
                && hit.part - first.part < AT_ONCE
        };
        let is_alone = !hits.iter().any(|(_, hit)| is_other(hit));
        Some(self.soonest_along(from, to, Hit { is_alone, ..first }))
    }

    fn way(&self, hit: &Hit, from: &Posed<'_>, to: &Posed<'_>) -> Way<'_> {
        let poses = [from, to].map(|shape| shape.at(hit.station));
        Way::new(&self.obstacles[hit.obstacle], hit.member, poses)
    }

    /// The same hit of the backbone at the place that gets there first, between the neighbours of the place that was watched.
    fn soonest_along(&self, from: &Posed<'_>, to: &Posed<'_>, hit: Hit) -> Hit {
        /// The time is least there, so that the place need not be known as well as the time.
        const SECTIONS: usize = 26;
        if hit.member.part != Part::Backbone || hit.part == 0.0 {
            return hit;
        }
        let rod = from.rod;
        let spacing = rod.lengths[hit.station.element] / WATCHED.len() as f64;
        let ends = [0, self.watched.len() - 1].map(|i| self.watched[i].1.arc_length);
        let [low, high] = [-spacing, spacing]
            .map(|by| (hit.station.arc_length(rod) + by).clamp(ends[0], ends[1]));
        let at = |x: f64| {
            let station = Station::at(rod, low + x * (high - low));
            let member = Member { arc_length: station.arc_length(rod), ..hit.member };
            Hit { station, member, ..hit }
        };
        let part = |x: f64| {
            let way = self.way(&at(x), from, to);
            let beyond = way.gap(1.0) + hit.overlap;
            match beyond < 0.0 {
                true => way.at_overlap(hit.overlap, [0.0, 1.0]),
                // Later, the farther it stays away.
                false => 1.0 + beyond / rod.length,
            }
        };
        let (x, soonest) = golden_section(SECTIONS, part);
        if soonest < hit.part { Hit { part: soonest, ..at(x) } } else { hit }
    }

    /// What the part of the way of a hit changes by for displacements of its cross-section at the start and at the end of the way, along and about the axes that the poses
    /// are given in. `None` where the obstacle is grazed.
    pub fn hit_changes(&self, hit: &Hit, poses: [Pose; 2], length: f64) -> Option<[Twist; 2]> {
        /// A speed at which the gap closes, as a part of what it closes by at the most.
        const GRAZING: f64 = 1e-6;
        let gap = |poses: [Pose; 2], part: f64| {
            Way::new(&self.obstacles[hit.obstacle], hit.member, poses).gap(part)
        };
        let h = 1e-6;
        let rate = (gap(poses, hit.part + h) - gap(poses, hit.part - h)) * (0.5 / h);
        let way = Way::new(&self.obstacles[hit.obstacle], hit.member, poses);
        if -rate <= GRAZING * way.moved() {
            return None;
        }
        Some([0, 1].map(|which| {
            by_displacements(length, |axis, by| {
                let mut of = poses;
                of[which] = displaced(&of[which], axis, by);
                gap(of, hit.part)
            }) * (-1.0 / rate)
        }))
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

/// Where a part of the robot first overlaps an obstacle on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// The part of the way up to there: zero where it overlaps from the start on.
    pub part: f64,
    pub obstacle: usize,
    pub member: Member,
    pub station: Station,
    /// Whether nothing else hits an obstacle at the same time.
    pub is_alone: bool,
    /// The overlap in m that it has there.
    overlap: f64,
}

/// A part of the robot that moves straight from one pose to another, past an obstacle.
struct Way<'a> {
    obstacle: &'a Obstacle,
    member: Member,
    start: Pose,
    twist: Twist,
}

impl<'a> Way<'a> {
    fn new(obstacle: &'a Obstacle, member: Member, [start, end]: [Pose; 2]) -> Self {
        Self { obstacle, member, start, twist: (start.inverse() * end).log() }
    }

    /// The gap in m at a part of the way.
    fn gap(&self, part: f64) -> f64 {
        let pose = self.start * Pose::exp(self.twist * part);
        let body = &self.member.body;
        if body.is_ball() {
            return self.obstacle.surface(pose.position).distance - body.rounding;
        }
        let mut places = Vec::new();
        body.nearest(self.obstacle, &pose, f64::INFINITY, &mut places);
        places.iter().map(|near| near.gap).fold(f64::INFINITY, f64::min)
    }

    /// How far in m it moves at the most.
    fn moved(&self) -> f64 {
        let end = Pose::exp(self.twist);
        end.position.norm() + self.twist.angular.norm() * self.member.body.flat
    }

    /// An interval of the way in which it first overlaps by `overlap`: of length zero at the start where it did so before and overlaps more behind it.
    fn first_hit(&self, overlap: f64) -> Option<[f64; 2]> {
        let (at_start, at_end, moved) = (self.gap(0.0), self.gap(1.0), self.moved());
        if at_start < -overlap {
            // What counts is that it gets worse.
            return (at_end < at_start - overlap).then_some([0.0; 2]);
        }
        if at_end >= -overlap && moved <= at_start + at_end {
            return None;
        }
        let least = 0.5 * self.member.body.reach();
        first_below(&|part| self.gap(part), at_start, -overlap, [least, moved])
    }

    /// Where it overlaps by `overlap` in an interval in which it begins to, to rounding.
    fn at_overlap(&self, overlap: f64, interval: [f64; 2]) -> f64 {
        false_position(|part| self.gap(part) + overlap, interval)
    }
}

/// Where a function that is positive at one end of an interval and negative at the other has its zero, to rounding: by the method of false position with halved values
/// (Illinois).
fn false_position(f: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    const MOST: usize = 80;
    let (mut at_low, mut at_high) = (f(low), f(high));
    let mut last = 0;
    for _ in 0..MOST {
        if !(at_low > 0.0 && at_high < 0.0) || high - low <= f64::EPSILON {
            break;
        }
        let x = high - at_high * (high - low) / (at_high - at_low);
        let x = if x > low && x < high { x } else { 0.5 * (low + high) };
        let here = f(x);
        let side = if here < 0.0 { -1 } else { 1 };
        if side < 0 {
            (high, at_high) = (x, here);
            at_low *= if last == side { 0.5 } else { 1.0 };
        } else {
            (low, at_low) = (x, here);
            at_high *= if last == side { 0.5 } else { 1.0 };
        }
        last = side;
    }
    if -at_high < at_low { high } else { low }
}

/// The interval in which a gap that begins with `start` and changes by no more than `moved` over its way first falls below a limit: looked at in steps of the gap, no
/// shorter than `least` and a fraction of the way.
fn first_below(
    gap: &impl Fn(f64) -> f64,
    start: f64,
    limit: f64,
    [least, moved]: [f64; 2],
) -> Option<[f64; 2]> {
    const HALVINGS: usize = 6;
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
            return Some([low, high]);
        }
        t = next;
    }
    None
}
