use core::f64::consts::{PI, TAU};

use whipcord_numerics::{PiecewiseCubic, Vec3};

use super::backbone::Backbone;
use super::cable::{Cable, HoleOffset, Interpolation, Routing};
use super::disks::Disks;
use super::error::{Problem, RobotError, check_on_backbone};
use super::fourier::Fourier;
use super::limits::{ANGLE, AXIAL_STIFFNESS, COORDINATE, DISTANCE, FRICTION, LENGTH, Range, TURNS};

/// Where a cable runs: its offset `r(s)` from the backbone in the frame of the cross-section.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    pub(crate) curve: Curve,
    end: f64,
    breakpoints: Vec<f64>,
}

/// The course of a cable at one arc length, in the frame of the cross-section; the z components are
/// zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoutePoint {
    /// Offset `r` from the backbone in m.
    pub offset: Vec3,
    /// `r′`, its derivative by arc length.
    pub slope: Vec3,
    /// `r″`, its second derivative in 1/m.
    pub bend: Vec3,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Curve {
    Polar { angle: PiecewiseCubic, radius: PiecewiseCubic },
    Fourier { x: Fourier, y: Fourier },
    Helix { start_angle: f64, rate: f64, radius: f64 },
    Polynomial { x: Vec<f64>, y: Vec<f64> },
}

/// How far from a disk a cable that ends there may be said to end, relative to the length of the backbone.
const AT_DISK: f64 = 1e-6;

impl Route {
    pub(crate) fn new(
        cable: &Cable,
        backbone: &Backbone,
        disks: &Disks,
    ) -> Result<Self, RobotError> {
        let length = backbone.length;
        let mut longest = length;
        let mut breakpoints = Vec::new();
        let curve = match &cable.routing {
            Routing::Holes { holes, interpolation } => {
                let knots = hole_disks(holes, disks)?;
                longest = knots[knots.len() - 1];
                breakpoints.extend_from_slice(&knots[1..knots.len() - 1]);
                ANGLE.check("hole_angle_offset", cable.hole_offset.angle)?;
                COORDINATE.check("hole_radius_offset", cable.hole_offset.radius)?;
                let least = disks.hole_circle_radii[..holes.len()].iter().copied();
                let least = least.fold(f64::INFINITY, f64::min);
                if least + cable.hole_offset.radius < 0.0 {
                    let problem = Problem::BeyondAxis { value: cable.hole_offset.radius, least };
                    return Err(RobotError::new("hole_radius_offset", problem));
                }
                let places = hole_places(cable, holes, disks);
                holes_curve(&places, *interpolation, knots)
            }
            Routing::Straight { angle, radius } => {
                ANGLE.check("routing.angle", *angle)?;
                DISTANCE.check("routing.radius", *radius)?;
                Curve::Polynomial { x: vec![radius * angle.cos()], y: vec![radius * angle.sin()] }
            }
            Routing::Helix { start_angle, turns, radius } => {
                ANGLE.check("routing.start_angle", *start_angle)?;
                TURNS.check("routing.turns", *turns)?;
                DISTANCE.check("routing.radius", *radius)?;
                let rate = TAU * turns / length;
                Curve::Helix { start_angle: *start_angle, rate, radius: *radius }
            }
            Routing::Linear { start, end } => {
                for i in 0..2 {
                    COORDINATE.check(&format!("routing.start[{i}]"), start[i])?;
                    COORDINATE.check(&format!("routing.end[{i}]"), end[i])?;
                }
                let line = |i: usize| vec![start[i], (end[i] - start[i]) / length];
                Curve::Polynomial { x: line(0), y: line(1) }
            }
            Routing::Polynomial { x, y } => {
                for (name, list) in [("x", x), ("y", y)] {
                    for (i, &c) in list.iter().enumerate() {
                        Range::of_coefficient(i, length)
                            .check(&format!("routing.{name}[{i}]"), c)?;
                    }
                }
                Curve::Polynomial { x: x.clone(), y: y.clone() }
            }
        };
        if let Some(value) = cable.friction {
            FRICTION.check("friction", value)?;
        }
        if let Some(value) = cable.axial_stiffness {
            AXIAL_STIFFNESS.check("axial_stiffness", value)?;
        }
        let end = match cable.ends_at {
            None => longest,
            Some(end) => {
                LENGTH.check("ends_at", end)?;
                check_on_backbone("ends_at", end, length)?;
                // Where a written length is that of a disk but for rounding, the cable ends at the disk.
                let disk = disks.arc_lengths.iter().find(|s| (end - **s).abs() < AT_DISK * length);
                let end = disk.copied().unwrap_or(end);
                if end > longest {
                    let problem = Problem::BeyondLastHole { value: end, last: longest };
                    return Err(RobotError::new("ends_at", problem));
                }
                end
            }
        };
        breakpoints.retain(|&s| s < end);
        Ok(Self { curve, end, breakpoints })
    }

    /// Arc length in m at which the cable is anchored.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Arc lengths between base and end at which a derivative of the course jumps: a step that
    /// spans one loses its order.
    #[must_use]
    pub fn breakpoints(&self) -> &[f64] {
        &self.breakpoints
    }

    /// The course at an arc length from 0 to [`Self::end`].
    #[must_use]
    pub fn at(&self, arc_length: f64) -> RoutePoint {
        match &self.curve {
            Curve::Polar { angle, radius } => {
                polar(angle.evaluate(arc_length), radius.evaluate(arc_length))
            }
            Curve::Helix { start_angle, rate, radius } => {
                polar([start_angle + rate * arc_length, *rate, 0.0], [*radius, 0.0, 0.0])
            }
            Curve::Fourier { x, y } => plane(x.evaluate(arc_length), y.evaluate(arc_length)),
            Curve::Polynomial { x, y } => {
                plane(polynomial(x, arc_length), polynomial(y, arc_length))
            }
        }
    }
}

/// Arc lengths of the disks whose holes the cable passes.
fn hole_disks<'a>(holes: &[usize], disks: &'a Disks) -> Result<&'a [f64], RobotError> {
    if !disks.are_present {
        return Err(RobotError::new("holes", Problem::HolesWithoutDisks));
    }
    let Some(count) = disks.holes.filter(|_| !disks.hole_circle_radii.is_empty()) else {
        return Err(RobotError::new("holes", Problem::DisksWithoutHoles));
    };
    let (given, all) = (holes.len(), disks.count());
    if given < 2 {
        return Err(RobotError::new("holes", Problem::TooFew { given, least: 2 }));
    }
    if given > all {
        return Err(RobotError::new("holes", Problem::MoreHolesThanDisks { given, disks: all }));
    }
    for (i, &hole) in holes.iter().enumerate() {
        if hole < 1 || hole > count {
            let problem = Problem::NoSuchHole { hole, holes: count };
            return Err(RobotError::new(format!("holes[{i}]"), problem));
        }
    }
    Ok(&disks.arc_lengths[..given])
}

/// Hole angles in rad, unwrapped: from disk to disk the cable takes the shorter way round, and
/// counter-clockwise when both are as long.
pub(crate) fn unwrapped_angles(holes: &[usize], count: usize) -> Vec<f64> {
    let pitch = TAU / count as f64;
    let mut turns = 0.0;
    let mut angles = Vec::with_capacity(holes.len());
    for (i, &hole) in holes.iter().enumerate() {
        let angle = pitch * (hole as f64 - 1.0);
        if i > 0 {
            let step = angle + turns - angles[i - 1];
            // Half a hole of slack keeps a step of exactly half a turn counter-clockwise.
            if step > PI + 0.25 * pitch {
                turns -= TAU;
            } else if step < -PI + 0.25 * pitch {
                turns += TAU;
            }
        }
        angles.push(angle + turns);
    }
    angles
}

/// Where a cable passes the disks.
pub(crate) struct HolePlaces {
    /// Unwrapped, in rad.
    pub angles: Vec<f64>,
    /// Distances from the axis in m.
    pub radii: Vec<f64>,
}

/// Where a cable with these holes passes the disks; a robot's disks have the number of holes and their circles.
pub(crate) fn hole_places(cable: &Cable, holes: &[usize], disks: &Disks) -> HolePlaces {
    let HoleOffset { angle, radius } = cable.hole_offset;
    let mut angles = unwrapped_angles(holes, disks.holes.unwrap_or(1));
    angles.iter_mut().for_each(|at| *at += angle);
    let radii = disks.hole_circle_radii[..holes.len()].iter().map(|at| at + radius).collect();
    HolePlaces { angles, radii }
}

fn holes_curve(places: &HolePlaces, interpolation: Interpolation, knots: &[f64]) -> Curve {
    let HolePlaces { angles, radii } = places;
    let cubic = |values: &[f64]| {
        let fit = match interpolation {
            Interpolation::Pchip => PiecewiseCubic::pchip(knots, values),
            Interpolation::Spline | Interpolation::Fourier => PiecewiseCubic::spline(knots, values),
        };
        // Two or more increasing knots with a value each are all that an interpolant needs; the
        // disks' positions have been checked to increase before any route is made.
        #[expect(clippy::expect_used, reason = "the knots were checked to increase")]
        fit.expect("disk positions increase")
    };
    match interpolation {
        Interpolation::Fourier => {
            let cartesian = |f: fn(f64) -> f64| -> Vec<f64> {
                angles.iter().zip(radii).map(|(&a, r)| r * f(a)).collect()
            };
            Curve::Fourier {
                x: Fourier::through(knots, &cartesian(f64::cos)),
                y: Fourier::through(knots, &cartesian(f64::sin)),
            }
        }
        Interpolation::Spline | Interpolation::Pchip => {
            Curve::Polar { angle: cubic(angles), radius: cubic(radii) }
        }
    }
}

/// Cartesian course from angle and radius with their first two derivatives.
fn polar([a, da, dda]: [f64; 3], [r, dr, ddr]: [f64; 3]) -> RoutePoint {
    let (sin, cos) = a.sin_cos();
    let radial = Vec3::new(cos, sin, 0.0);
    let around = Vec3::new(-sin, cos, 0.0);
    RoutePoint {
        offset: r * radial,
        slope: dr * radial + r * da * around,
        bend: (ddr - r * da * da) * radial + (2.0 * dr * da + r * dda) * around,
    }
}

pub(crate) fn plane([x, dx, ddx]: [f64; 3], [y, dy, ddy]: [f64; 3]) -> RoutePoint {
    RoutePoint {
        offset: Vec3::new(x, y, 0.0),
        slope: Vec3::new(dx, dy, 0.0),
        bend: Vec3::new(ddx, ddy, 0.0),
    }
}

/// Value and first two derivatives by Horner's scheme.
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> [f64; 3] {
    let mut p = [0.0; 3];
    for &c in coefficients.iter().rev() {
        p[2] = p[2] * x + 2.0 * p[1];
        p[1] = p[1] * x + p[0];
        p[0] = p[0] * x + c;
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    fn robot(routing: Routing) -> Robot {
        let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
        Robot::new(Backbone::new(0.18), disks, vec![Cable::new("a", routing)]).unwrap()
    }

    fn hole(k: usize) -> Vec3 {
        let angle = TAU * (k as f64 - 1.0) / 12.0;
        0.008 * Vec3::new(angle.cos(), angle.sin(), 0.0)
    }

    #[test]
    fn holes_are_met_at_the_disks_by_every_interpolation() {
        let holes = vec![10, 10, 11, 12, 1, 2, 1, 12, 12, 1];
        for interpolation in [Interpolation::Spline, Interpolation::Pchip, Interpolation::Fourier] {
            let robot = robot(Routing::Holes { holes: holes.clone(), interpolation });
            let route = &robot.routes()[0];
            for (i, &k) in holes.iter().enumerate() {
                let at = route.at(robot.disks().arc_lengths[i]).offset;
                assert!((at - hole(k)).max_abs() < 1e-12, "{interpolation:?} disk {i}");
            }
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let holes = vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1];
        let routings = [
            Routing::holes(holes.clone()),
            Routing::Holes { holes: holes.clone(), interpolation: Interpolation::Pchip },
            Routing::Holes { holes, interpolation: Interpolation::Fourier },
            Routing::Helix { start_angle: 0.3, turns: -1.5, radius: 0.01 },
            Routing::Linear { start: [0.008, 0.0], end: [0.001, 0.004] },
            Routing::Polynomial { x: vec![0.01, 0.02, -0.3], y: vec![0.0, 0.1, 0.0, 2.0] },
        ];
        for routing in routings {
            let robot = robot(routing);
            let route = &robot.routes()[0];
            let h = 1e-6;
            for s in [0.013, 0.07, 0.131] {
                let (a, b, c) = (route.at(s - h), route.at(s), route.at(s + h));
                let slope = (c.offset - a.offset) / (2.0 * h);
                let bend = (c.slope - a.slope) / (2.0 * h);
                assert!((slope - b.slope).max_abs() < 1e-8, "{:?}", route);
                assert!((bend - b.bend).max_abs() < 1e-5 * (1.0 + b.bend.max_abs()), "{:?}", route);
            }
        }
    }

    #[test]
    fn unwrapping_takes_the_shorter_way() {
        let turn = |a: usize, b: usize| {
            let angles = unwrapped_angles(&[a, b], 12);
            (angles[1] - angles[0]) / (TAU / 12.0)
        };
        assert!((turn(12, 1) - 1.0).abs() < 1e-12);
        assert!((turn(1, 12) + 1.0).abs() < 1e-12);
        assert!((turn(1, 7) - 6.0).abs() < 1e-12);
        assert!((turn(7, 1) - 6.0).abs() < 1e-12);
        let round = unwrapped_angles(&[1, 5, 9, 1, 5], 12);
        assert!((round[4] - 4.0 * TAU / 3.0).abs() < 1e-12);
    }
}
