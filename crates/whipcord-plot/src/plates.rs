//! The disks of a robot as pictures have them.

use core::f64::consts::TAU;

use whipcord::{Robot, Routing, Vec3};

use crate::body::profile;

/// A disk as pictures have it, in its own frame. Lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Radius of its rim: what the robot gives, or enough for its holes, cables and backbone.
    pub radius: f64,
    /// Its thickness: what the robot gives, or a tenth of the radius, as the contact of disks takes it.
    pub thickness: f64,
    /// Centres of its holes, (x, y); none where they would be a blur.
    pub holes: Vec<[f64; 2]>,
    /// Radius of its holes, which the robot does not give.
    pub hole_radius: f64,
}

/// With more holes than this on all disks none is drawn: they would be a blur.
const MOST_HOLES: usize = 600;
/// Rim outside the holes, relative to the radius of their circle.
const RIM: f64 = 1.2;
/// Radius of a hole, relative to its distance from the centre.
const HOLE: f64 = 0.1;
/// That relative to the distance from the next hole or the rim: a wall stays between.
const APART: f64 = 0.45;
/// Thickness of a disk relative to its radius, where the robot does not give it.
const THICKNESS: f64 = 0.1;
/// A disk is drawn no thicker than this part of the shorter section beside it.
const THICKEST: f64 = 0.5;
/// A cable that ends this near to a disk, relative to the length, ends at it.
const ONE_PLACE: f64 = 1e-9;

/// The disks of a robot as pictures have them, from the base on; none for a robot without disks.
#[must_use]
pub fn plates_of(robot: &Robot) -> Vec<Plate> {
    if !robot.has_disks() {
        return Vec::new();
    }
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
            let thickness = disks.thickness.unwrap_or(THICKNESS * radius);
            let thickness = thickness.min(THICKEST * shorter_section(&disks.arc_lengths, i));
            let mut plate = Plate { radius, thickness, holes: centres.collect(), hole_radius: 0.0 };
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

/// Length of the shorter of the sections beside a disk.
fn shorter_section(arc_lengths: &[f64], disk: usize) -> f64 {
    let section = |i: usize| Some(arc_lengths.get(i + 1)? - arc_lengths.get(i)?);
    let sections = disk.checked_sub(1).into_iter().chain([disk]).filter_map(section);
    sections.fold(f64::INFINITY, f64::min)
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

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{Backbone, Cable, Disks};

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
