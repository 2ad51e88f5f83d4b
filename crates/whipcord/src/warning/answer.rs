//! Warnings about an answer.

use core::f64::consts::PI;

use super::geometry::Extent;
use super::kinds::{LARGE_STRAIN, NEAR_CRITICAL, Warning};
use super::{intersection, span};
use crate::cable_overlap::CableOverlap;
use crate::case::Case;
use crate::motor_state::MotorState;
use crate::robot::{Motor, Robot};
use crate::shape::Shape;
use crate::solution::{Diagnostics, Solution};
use whipcord_numerics::{Pose, Twist, Vec3};

/// Warnings about an answer of this robot to this case.
#[must_use]
pub fn of_answer(robot: &Robot, case: &Case, solution: &Solution) -> Vec<Warning> {
    let mut found = Vec::new();
    found.extend(stability(&solution.diagnostics));
    found.extend(intersection::warnings(robot, solution));
    found.extend(cables(robot, case, solution));
    found.extend(motors(robot, solution));
    found.extend(strain(robot, solution));
    found
}

/// The deepest place of a cable in an obstacle.
fn cables(robot: &Robot, case: &Case, solution: &Solution) -> Option<Warning> {
    let overlaps = CableOverlap::all(robot, solution, &case.obstacles);
    let deepest = overlaps.iter().max_by(|a, b| a.depth.total_cmp(&b.depth))?;
    Some(Warning::CableInObstacle {
        cable: robot.cables()[deepest.cable].name.clone(),
        obstacle: case.obstacles[deepest.obstacle].name.clone(),
        span: deepest.span,
        arc_length: deepest.arc_length,
        depth: deepest.depth,
        force: deepest.force,
        others: overlaps.len() - 1,
    })
}

/// Motors that must give more than they can.
fn motors(robot: &Robot, solution: &Solution) -> Vec<Warning> {
    let states = MotorState::all(robot, &[], solution);
    let of_motor = |(index, (motor, state)): (usize, (&Motor, MotorState))| {
        let limit = motor.limits.effort.filter(|_| state.is_overloaded())?;
        Some(Warning::MotorOverload {
            index,
            motor: motor.name.clone(),
            effort: state.effort?.abs(),
            limit,
            drive: motor.drive,
        })
    };
    robot.motors().iter().zip(states).enumerate().filter_map(of_motor).collect()
}

fn stability(diagnostics: &Diagnostics) -> Option<Warning> {
    let stability = diagnostics.stability?;
    if diagnostics.is_unstable() {
        return Some(Warning::Unstable { stability, lost_at: diagnostics.stability_lost_at });
    }
    // A buckled round rod turns freely about its axis: that direction is neutral, not critical.
    (stability > Diagnostics::NEUTRAL && stability < NEAR_CRITICAL)
        .then_some(Warning::NearCritical { stability })
}

fn strain(robot: &Robot, solution: &Solution) -> Option<Warning> {
    let given = robot.backbone().material.yield_strain;
    let limit = given.unwrap_or(LARGE_STRAIN);
    let most = [&solution.shape, &solution.disks]
        .into_iter()
        .filter_map(|shape| largest_strain(robot, shape))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let (strain, arc_length) = most;
    (strain > limit).then_some(Warning::Strain {
        strain,
        limit,
        is_given: given.is_some(),
        arc_length,
    })
}

/// The largest equivalent strain √(ε² + γ²/3) on the surface, and its arc length in m: ε from stretch and bending, γ from twist.
/// Bending and twist are taken as linear inside each span between two stations, with the mean of the span in its middle and the
/// lesser of the slopes to its neighbours, so that the jump where a cable ends is not carried on; a span alone has its mean
/// everywhere. `None` where the section is not given.
fn largest_strain(robot: &Robot, shape: &Shape) -> Option<(f64, f64)> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let section = backbone.section.as_ref()?;
    let ends = shape.arc_length.windows(2).zip(shape.poses.windows(2));
    let spans: Vec<Option<Span>> = ends
        .map(|(s, frames)| {
            let (length, middle) = (s[1] - s[0], 0.5 * (s[0] + s[1]));
            let strain = span::strain(frames[0], frames[1], length)?;
            let bent = strain.angular - backbone.rest_curvature_at(disks, middle);
            let chord = (frames[1].position - frames[0].position).norm();
            Some(Span { middle, length, chord, bent, turning: strain.angular })
        })
        .collect();
    let slope = |i: usize, j: usize| -> Option<Vec3> {
        let (a, b) = (spans.get(i)?.as_ref()?, spans.get(j)?.as_ref()?);
        Some((b.bent - a.bent) * (1.0 / (b.middle - a.middle)))
    };
    let of_span = |i: usize| -> Option<(f64, f64)> {
        let span = spans[i].as_ref()?;
        let Span { middle, length, bent, .. } = *span;
        let before = i.checked_sub(1).and_then(|j| slope(j, i));
        let after = slope(i, i + 1);
        // At an end of the backbone the slope between the next two spans stands for the one that is missing.
        let further = match (before, after) {
            (None, _) => slope(i + 1, i + 2),
            (_, None) => i.checked_sub(2).and_then(|j| slope(j, i - 1)),
            _ => None,
        };
        let slopes = [before, after, further].into_iter().flatten();
        let slope = slopes.min_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or(Vec3::ZERO);
        let stretch = span.stretch(slope);
        let at = |offset: f64| {
            let s = middle + offset;
            (on_surface(Extent::at(section, disks, s), bent + slope * offset, stretch), s)
        };
        let places = [-0.5, 0.0, 0.5].map(|share| at(share * length));
        // Of equal strains the one in the middle.
        let most = |a: (f64, f64), b: (f64, f64)| if b.0 > a.0 * (1.0 + 1e-9) { b } else { a };
        Some(most(most(places[1], places[0]), places[2]))
    };
    (0..spans.len()).filter_map(of_span).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The backbone between two stations.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// Arc length of its middle and its length in m.
    middle: f64,
    length: f64,
    /// Distance of the two stations in m.
    chord: f64,
    /// Mean of bending and twist in 1/m, and how much of it is beyond that at rest.
    turning: Vec3,
    bent: Vec3,
}

impl Span {
    /// The mean of its stretch or compression, where bending and twist have this slope in 1/m²: its chord is compared with that of
    /// two halves that are not stretched.
    fn stretch(&self, slope: Vec3) -> f64 {
        let half = |share: f64| {
            let angular = self.turning + slope * (share * self.length);
            Pose::exp(Twist { linear: Vec3::Z, angular } * (0.5 * self.length))
        };
        let chord = (half(-0.25) * half(0.25)).position.norm();
        // The ends of a whole turn meet, however long it is.
        if chord < 0.1 * self.length { 0.0 } else { (self.chord / chord - 1.0).abs() }
    }
}

/// The equivalent strain on the surface of a section that is bent and twisted by so much, in 1/m, and stretched.
fn on_surface(extent: Extent, bent: Vec3, stretch: f64) -> f64 {
    let (normal, shear) = match extent {
        Extent::Round(outer, _) => (outer * bent.x.hypot(bent.y), outer * bent.z.abs()),
        Extent::Rectangle(a, b) => {
            (b * bent.x.abs() + a * bent.y.abs(), bent.z.abs() * twisted_rectangle(a, b))
        }
    };
    let normal = normal + stretch;
    (normal * normal + shear * shear / 3.0).sqrt()
}

/// Largest shear strain in a rectangle of these half extents for a twist of 1 rad/m: Saint-Venant's series
/// `2a (1 − 8/π² Σ 1/(n² cosh(nπb/2a)))` over odd n, a ≤ b (Timoshenko and Goodier, Theory of Elasticity,
/// art. 109).
fn twisted_rectangle(a: f64, b: f64) -> f64 {
    let (a, b) = if a <= b { (a, b) } else { (b, a) };
    let term = |n: f64| 1.0 / (n * n * (n * PI * b / (2.0 * a)).cosh());
    let sum: f64 = [1.0, 3.0, 5.0, 7.0].into_iter().map(term).sum();
    2.0 * a * (1.0 - 8.0 / (PI * PI) * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Along, Backbone, Disks, Section};

    fn robot(disks: usize) -> Robot {
        let backbone = Backbone { section: Some(Section::circle(0.002)), ..Backbone::new(0.3) };
        Robot::new(backbone, Disks::equally_spaced(0.3, disks, 0.008), vec![]).unwrap()
    }

    /// The shape at the disks of a backbone with this curvature about x in 1/m, by so many constant pieces in each span.
    fn bent(robot: &Robot, curvature: impl Fn(f64) -> f64) -> Shape {
        const PIECES: usize = 200;
        let arc_length = robot.disks().arc_lengths.clone();
        let mut poses = vec![Pose::IDENTITY];
        for ends in arc_length.windows(2) {
            let ds = (ends[1] - ends[0]) / PIECES as f64;
            let mut pose = *poses.last().unwrap();
            for k in 0..PIECES {
                let angular = Vec3::X * curvature(ends[0] + (k as f64 + 0.5) * ds);
                pose = pose * Pose::exp(Twist { linear: Vec3::Z, angular } * ds);
            }
            poses.push(pose);
        }
        Shape { arc_length, poses }
    }

    /// Spans that turn by more than half a circle have frames that are also those of a lesser turn the other way, which would
    /// have to stretch the backbone.
    #[test]
    fn the_strain_of_one_span_is_that_of_its_curvature_however_far_it_turns() {
        let robot = robot(2);
        for degrees in [90.0, 170.0, 220.0, 330.0_f64] {
            let curvature = degrees.to_radians() / 0.3;
            let (strain, at) = largest_strain(&robot, &bent(&robot, |_| curvature)).unwrap();
            assert!((strain - 0.001 * curvature).abs() < 1e-9, "{degrees}: {strain}");
            assert!((at - 0.15).abs() < 1e-12, "{degrees}: {at}");
        }
    }

    /// A cantilever under a force has its greatest strain at the base, where a span is bent by more than its mean.
    #[test]
    fn the_greatest_strain_lies_at_the_end_of_a_span() {
        for disks in [3, 4, 11] {
            let robot = robot(disks);
            let shape = bent(&robot, |s| 10.0 * (1.0 - s / 0.3));
            let (strain, at) = largest_strain(&robot, &shape).unwrap();
            assert!((strain / 0.01 - 1.0).abs() < 0.01, "{disks}: {strain}");
            assert!(at.abs() < 1e-12, "{disks}: {at}");
        }
    }

    /// A cable that ends half way bends one half alone: what it does there is not carried on beyond.
    #[test]
    fn a_jump_of_the_curvature_is_not_carried_on() {
        let robot = robot(11);
        let shape = bent(&robot, |s| if s < 0.15 { 10.0 } else { 0.0 });
        let (strain, _) = largest_strain(&robot, &shape).unwrap();
        assert!((strain / 0.01 - 1.0).abs() < 1e-6, "{strain}");
    }

    /// A tapered backbone under equal curvature is strained most where it is thick.
    #[test]
    fn the_strain_of_a_tapered_backbone_is_that_of_its_thickest_end() {
        let diameter = Along::At { arc_lengths: vec![0.0, 0.3], values: vec![0.004, 0.001] };
        let section = Section::Round { outer: diameter, inner: Along::Uniform(0.0) };
        let backbone = Backbone { section: Some(section), ..Backbone::new(0.3) };
        let robot = Robot::new(backbone, Disks::equally_spaced(0.3, 4, 0.008), vec![]).unwrap();
        let (strain, at) = largest_strain(&robot, &bent(&robot, |_| 5.0)).unwrap();
        assert!((strain - 0.01).abs() < 1e-9, "{strain}");
        assert!(at.abs() < 1e-12, "{at}");
    }

    /// Timoshenko and Goodier, table of art. 109: the greatest shear stress is k·Gθ·2a.
    #[test]
    fn shear_strain_of_rectangles_matches_the_published_table() {
        for (ratio, k) in [(1.0, 0.675), (1.5, 0.848), (2.0, 0.930), (3.0, 0.985), (10.0, 1.0)] {
            let strain = twisted_rectangle(0.001, 0.001 * ratio);
            assert!((strain / 0.002 - k).abs() < 1e-3, "{ratio}: {strain}");
        }
    }
}
