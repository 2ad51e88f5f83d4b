//! The routing of one cable that bends a straight rod to a curve, in closed form.

use whipcord::section::section_stiffness;
use whipcord::{
    Actuation, CableCommand, Case, Model, ModelKind, Robot, Routing, Solution, Statics as _,
    Stations, Vec3,
};

use crate::chebyshev;
use crate::curve::Curve;
use crate::error::DesignError;

/// A cable that bends its robot to a curve.
#[derive(Clone, Debug)]
pub struct CurveRoute {
    /// The robot with the cable on its new routing.
    pub robot: Robot,
    /// The case in which this cable alone is pulled.
    pub case: Case,
    /// Least and greatest distance of the cable from the axis in m; negative where it is on the other side of it.
    pub radii: [f64; 2],
    /// Greatest distance in m between the backbone and the curve, from a solve by the Cosserat rod.
    pub error: f64,
    /// That solve.
    pub solution: Solution,
}

/// Intervals on which the routing is computed, and those of the comparison.
const INTERVALS: usize = 180;
const COMPARED: usize = 36;
/// Steps of the fixed-point iteration, and the relative change at which it ends.
const ITERATIONS: usize = 5_000;
const CONVERGED: f64 = 1e-11;
/// Greatest slope that differences of equally spaced values give to a change by 1, times their distance.
const SLOPE_OF_DIFFERENCES: f64 = 2.0;
/// Highest degree of the polynomials, and how well they follow the routing: as well as this if they can, and no worse than that.
const DEGREE: usize = 18;
const FOLLOWED: f64 = 1e-5;
const LEAST_FOLLOWED: f64 = 1e-3;
/// Coefficients that a robot may have.
const LARGEST_COEFFICIENT: f64 = 1e14;

/// A cable that must be farther out than this many times the distance that it may have is refused without the iteration.
const FAR: f64 = 1.5;

/// What a section resists with; infinite where it does not give way.
#[derive(Clone, Copy, Debug)]
struct Resistance {
    axial: f64,
    shear: f64,
    bending: f64,
    twist: f64,
}

/// The routing of a cable under a tension in N that bends the backbone to a curve, eqs. (4) to (7): exact but for the shear of the sections
/// against the curve. All other cables are slack, and nothing else acts on the robot.
///
/// # Errors
/// [`DesignError::Backbone`] for a backbone that is bent at rest, has friction or bends more easily in one direction than in another,
/// [`DesignError::NotAttainable`] where the cable would have to be outside of the disks, and [`DesignError::NotConverged`] for a curve that winds faster than polynomials follow.
pub fn route_for_curve(
    robot: &Robot,
    cable: usize,
    curve: &Curve,
    tension: f64,
) -> Result<CurveRoute, DesignError> {
    curve.check()?;
    if cable >= robot.cables().len() {
        return Err(DesignError::NoSuchCable { cable, cables: robot.cables().len() });
    }
    if !(tension > 0.0 && tension.is_finite()) {
        let what = format!("a tension of {tension} N bends nothing: give a positive one");
        return Err(DesignError::Curve { what });
    }
    let length = robot.backbone().length;
    if curve.length() < length {
        let what = format!(
            "the curve is {:.4} m long and the backbone {length:.4} m: give a curve at least as long",
            curve.length()
        );
        return Err(DesignError::Curve { what });
    }
    let sections = resistances(robot)?;
    let largest = largest_radius(robot);
    let least = least_radius(curve, length, tension, &sections);
    if least.1 > FAR * largest {
        return Err(not_attainable(curve, length, tension, &sections, least, largest));
    }
    let course = Course::of(curve, length, tension, &sections)?;
    let outermost = course.outermost(length);
    if outermost.1 > largest {
        return Err(not_attainable(curve, length, tension, &sections, outermost, largest));
    }
    let offsets: Vec<[f64; 2]> = course
        .radius
        .iter()
        .zip(&course.angle)
        .map(|(radius, angle)| [radius * angle.cos(), radius * angle.sin()])
        .collect();
    let [x, y] = polynomials(&offsets, length)?;
    let mut cables = robot.cables().to_vec();
    cables[cable].routing = Routing::Polynomial { x, y };
    cables[cable].ends_at = None;
    let routed = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables)?;
    let mut case = Case::with_tensions(&vec![0.0; robot.cables().len()]);
    case.commands[cable] = CableCommand { tension: Some(tension), shortening: None };
    let stations: Vec<f64> = whipcord::equally_spaced(0.0, length, COMPARED + 1).collect();
    let model = Model::new(ModelKind::Cosserat, Stations::At(stations.clone()), Actuation::Tension);
    let solution = model.solve(&routed, &case)?;
    let along: Vec<f64> =
        (0..=COMPARED).map(|k| course.along[k * (INTERVALS / COMPARED)]).collect();
    let error = distance(&solution.shape.poses, &curve.points(&along));
    let bounds = |pick: fn(f64, f64) -> f64| course.radius.iter().copied().reduce(pick);
    let radii = [bounds(f64::min), bounds(f64::max)].map(|of| of.unwrap_or(0.0));
    Ok(CurveRoute { robot: routed, case, radii, error, solution })
}

/// Where a cable is farthest from the axis, and how far at least, in m: by eq. (5) with t_z ≤ 1 the distance is at least EI κ/τ, but for the extension.
fn least_radius(curve: &Curve, length: f64, tension: f64, sections: &[Resistance]) -> (f64, f64) {
    let at = |(k, of): (usize, &Resistance)| {
        #[allow(clippy::cast_precision_loss, reason = "few intervals")]
        let arc_length = length * k as f64 / INTERVALS as f64;
        (arc_length, of.bending * curve.curvature(arc_length).abs() / tension)
    };
    sections.iter().enumerate().map(at).fold((0.0, 0.0), farther)
}

/// The one with the greater distance.
fn farther(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 > a.1 { b } else { a }
}

/// The refusal of a curve that takes a cable outside of the disks, with a tension that does not.
fn not_attainable(
    curve: &Curve,
    length: f64,
    tension: f64,
    sections: &[Resistance],
    (arc_length, radius): (f64, f64),
    largest: f64,
) -> DesignError {
    const TRIES: usize = 30;
    const MARGIN: f64 = 1.002;
    let mut enough = tension * radius / largest * MARGIN;
    for _ in 0..TRIES {
        let needed = match Course::of(curve, length, enough, sections) {
            Ok(course) => course.outermost(length).1 / largest,
            Err(_) => 1.5,
        };
        if needed <= 1.0 {
            return DesignError::NotAttainable { arc_length, radius, largest, tension: enough };
        }
        enough *= needed * MARGIN;
    }
    let what = format!(
        "at {arc_length:.4} m the cable would have to be {radius:.5} m from the axis, and may be {largest:.5} m; no tension up to {enough:.3e} N brings it in: give a curve that winds less"
    );
    DesignError::Curve { what }
}

/// Greatest distance of poses from points in m.
pub(crate) fn distance(poses: &[whipcord::Pose], points: &[Vec3]) -> f64 {
    let off = |(pose, point): (&whipcord::Pose, &Vec3)| (pose.position - *point).norm();
    poses.iter().zip(points).map(off).fold(0.0, f64::max)
}

/// How far from the axis a cable may be: the rims of the disks.
pub(crate) fn largest_radius(robot: &Robot) -> f64 {
    if !robot.has_disks() {
        return f64::INFINITY;
    }
    let disks = robot.disks();
    (0..disks.count()).map(|disk| disks.rim_radius(disk)).fold(f64::INFINITY, f64::min)
}

/// Whether the backbone is straight at rest and bends as easily in all directions.
pub(crate) fn is_axisymmetric(robot: &Robot) -> bool {
    resistances(robot).is_ok()
}

fn resistances(robot: &Robot) -> Result<Vec<Resistance>, DesignError> {
    let refused = |what: &str| DesignError::Backbone { what: what.to_owned() };
    let backbone = robot.backbone();
    if backbone.bending_friction.is_some() {
        return Err(refused(
            "a backbone with friction against bending has no closed form: take out yield_moment",
        ));
    }
    let length = backbone.length;
    whipcord::equally_spaced(0.0, length, INTERVALS + 1)
        .map(|s| {
            if backbone.rest_curvature_at(robot.disks(), s).norm() * length > 1e-12 {
                return Err(refused(
                    "the closed form is for a backbone that is straight at rest: take out rest_curvature",
                ));
            }
            let k = section_stiffness(robot, s, s)?;
            let bending = k[3][3];
            let is_round = (k[4][4] - bending).abs() <= 1e-9 * bending;
            let is_diagonal = (0..6).all(|i| (0..i).all(|j| k[i][j] == 0.0));
            if !is_round || !is_diagonal {
                return Err(refused(
                    "the closed form is for sections that bend as easily in all directions: give a round section",
                ));
            }
            Ok(Resistance { axial: k[2][2], shear: k[0][0], bending, twist: k[5][5] })
        })
        .collect()
}

/// The routing at equally spaced sections.
struct Course {
    /// ρ in m and ψ in rad.
    radius: Vec<f64>,
    angle: Vec<f64>,
    /// Arc length of the curve at each section in m.
    along: Vec<f64>,
}

impl Course {
    /// Where the cable is farthest from the axis, and how far, in m.
    fn outermost(&self, length: f64) -> (f64, f64) {
        let at = |(k, radius): (usize, &f64)| {
            #[allow(clippy::cast_precision_loss, reason = "few intervals")]
            let arc_length = length * k as f64 / INTERVALS as f64;
            (arc_length, radius.abs())
        };
        self.radius.iter().enumerate().map(at).fold((0.0, 0.0), farther)
    }

    /// Fixed-point iteration on eqs. (4) to (7): the radius decides the direction of the cable, which decides the radius.
    fn of(
        curve: &Curve,
        length: f64,
        tension: f64,
        sections: &[Resistance],
    ) -> Result<Self, DesignError> {
        #[allow(clippy::cast_precision_loss, reason = "few intervals")]
        let h = length / INTERVALS as f64;
        #[allow(clippy::cast_precision_loss, reason = "few intervals")]
        let mut along: Vec<f64> = (0..=INTERVALS).map(|k| k as f64 * h).collect();
        let mut radius: Vec<f64> = along
            .iter()
            .zip(sections)
            .map(|(s, of)| of.bending * curve.curvature(*s) / tension)
            .collect();
        let mut stretch = vec![1.0; INTERVALS + 1];
        let mut change = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let slope = derivative(&radius, h);
            let mut turn = Vec::with_capacity(INTERVALS + 1);
            let mut axial = Vec::with_capacity(INTERVALS + 1);
            let mut next = Vec::with_capacity(INTERVALS + 1);
            let mut feedback: f64 = 0.0;
            for (k, of) in sections.iter().enumerate() {
                let rho = radius[k];
                let bent = tension * rho * rho / of.bending;
                let forward = |lambda: f64| 1.0 / (lambda + tension / of.axial + bent);
                let extension = 1.0 - tension * forward(stretch[k]) / of.axial;
                let bend = curve.curvature(along[k]) * extension;
                let torsion = curve.torsion(along[k]) * extension;
                let across = slope[k].hypot(rho * torsion);
                let sideways = |lambda: f64| across / (lambda + tension / of.shear);
                // Of unit length: Newton's method on a convex, falling function.
                let mut lambda = stretch[k];
                for _ in 0..50 {
                    let (z, xy) = (forward(lambda), sideways(lambda));
                    let value = z * z + xy * xy - 1.0;
                    let rate = -2.0 * (z * z * z + xy * xy / (lambda + tension / of.shear));
                    let step = value / rate;
                    lambda -= step;
                    if step.abs() < 1e-15 * lambda.abs() {
                        break;
                    }
                }
                stretch[k] = lambda;
                let around = rho * torsion / (lambda + tension / of.shear);
                turn.push(torsion + tension * rho * around / of.twist);
                axial.push(extension);
                let to = of.bending * bend / (tension * forward(lambda));
                feedback = feedback.max((to * slope[k]).abs() / (lambda * forward(lambda)).powi(2));
                next.push(to);
            }
            let size = next.iter().map(|rho: &f64| rho.abs()).fold(0.0, f64::max);
            change = next.iter().zip(&radius).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                / size.max(1e-12 * length);
            if !change.is_finite() || next.iter().any(|rho| !rho.is_finite()) {
                break;
            }
            // The slope of what varies from section to section is large: a whole step would amplify it.
            let share = 1.0 / (1.0 + (SLOPE_OF_DIFFERENCES * feedback / h).powi(2));
            radius.iter_mut().zip(&next).for_each(|(rho, to)| *rho += share * (to - *rho));
            along = cumulated(&axial, h);
            if change <= CONVERGED {
                let angle = cumulated(&turn, h);
                let start = curve.direction();
                let angle = angle.iter().map(|turned| start + turned).collect();
                return Ok(Self { radius, angle, along });
            }
        }
        Err(DesignError::NotConverged {
            what: "routing",
            iterations: ITERATIONS,
            change,
            advice: "give more tension, so that the cable runs nearer to the axis",
        })
    }
}

/// Derivative of equally spaced values, of order 4.
fn derivative(values: &[f64], h: f64) -> Vec<f64> {
    let last = values.len() - 1;
    (0..=last)
        .map(|k| {
            let first = k.saturating_sub(2).min(last - 4);
            let v = &values[first..first + 5];
            let weights: [f64; 5] = match k - first {
                0 => [-25.0, 48.0, -36.0, 16.0, -3.0],
                1 => [-3.0, -10.0, 18.0, -6.0, 1.0],
                2 => [1.0, -8.0, 0.0, 8.0, -1.0],
                3 => [-1.0, 6.0, -18.0, 10.0, 3.0],
                _ => [3.0, -16.0, 36.0, -48.0, 25.0],
            };
            weights.iter().zip(v).map(|(w, v)| w * v).sum::<f64>() / (12.0 * h)
        })
        .collect()
}

/// Integral from the first of equally spaced values up to each, of order 4.
fn cumulated(values: &[f64], h: f64) -> Vec<f64> {
    let last = values.len() - 1;
    let mut sum = 0.0;
    let mut sums = vec![0.0];
    for k in 0..last {
        let first = k.saturating_sub(1).min(last - 3);
        let v = &values[first..first + 4];
        let weights: [f64; 4] = match k - first {
            0 => [9.0, 19.0, -5.0, 1.0],
            1 => [-1.0, 13.0, 13.0, -1.0],
            _ => [1.0, -5.0, 19.0, 9.0],
        };
        sum += h / 24.0 * weights.iter().zip(v).map(|(w, v)| w * v).sum::<f64>();
        sums.push(sum);
    }
    sums
}

/// Polynomials in the arc length through the offsets, of the least degree that follows them: least squares in Chebyshev polynomials on a
/// grid that is dense at the ends.
fn polynomials(offsets: &[[f64; 2]], length: f64) -> Result<[Vec<f64>; 2], DesignError> {
    let size = offsets.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max).max(1e-12 * length);
    let mut best: Option<(f64, [Vec<f64>; 2])> = None;
    for degree in 1..=DEGREE {
        let of = [0, 1].map(|axis| fitted(offsets, axis, degree, length));
        if of.iter().flatten().any(|c| c.abs() > LARGEST_COEFFICIENT) {
            break;
        }
        let error = offsets
            .iter()
            .enumerate()
            .map(|(k, offset)| {
                #[allow(clippy::cast_precision_loss, reason = "few intervals")]
                let s = length * k as f64 / (offsets.len() - 1) as f64;
                let at = |of: &[f64]| chebyshev::value(of, s);
                (at(&of[0]) - offset[0]).hypot(at(&of[1]) - offset[1])
            })
            .fold(0.0, f64::max)
            / size;
        if best.as_ref().is_none_or(|(known, _)| error < *known) {
            best = Some((error, of));
        }
        if error <= FOLLOWED {
            break;
        }
    }
    match best {
        Some((error, of)) if error <= LEAST_FOLLOWED => Ok(of),
        best => Err(DesignError::NotConverged {
            what: "polynomials of the routing",
            iterations: DEGREE,
            change: best.map_or(f64::INFINITY, |(error, _)| error),
            advice: "give a curve that winds less",
        }),
    }
}

/// The interpolant at the zeros of a Chebyshev polynomial of the next degree, in ascending powers of the arc length.
fn fitted(offsets: &[[f64; 2]], axis: usize, degree: usize, length: f64) -> Vec<f64> {
    let value = |part: f64| {
        let at = part * (offsets.len() - 1) as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to the number of intervals"
        )]
        let first = (at.floor() as usize).saturating_sub(2).min(offsets.len() - 6);
        // Lagrange's interpolation through six neighbours.
        (0..6)
            .map(|i| {
                let others = (0..6).filter(|j| *j != i);
                let x = at - first as f64;
                let weight: f64 =
                    others.map(|j| (x - f64::from(j)) / (f64::from(i) - f64::from(j))).product();
                weight * offsets[first + usize::try_from(i).unwrap_or(0)][axis]
            })
            .sum::<f64>()
    };
    let values: Vec<f64> = chebyshev::places(degree + 1).map(value).collect();
    chebyshev::powers(&values, length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_and_integrals_are_of_order_four() {
        let at = |n: usize| {
            let h = 1.0 / n as f64;
            let values: Vec<f64> = (0..=n).map(|k| (3.0 * k as f64 * h).sin()).collect();
            let slope = derivative(&values, h);
            let sum = cumulated(&values, h);
            let error = |k: usize| {
                let s = k as f64 * h;
                let exact = (1.0 - (3.0 * s).cos()) / 3.0;
                (slope[k] - 3.0 * (3.0 * s).cos()).abs() + (sum[k] - exact).abs()
            };
            (0..=n).map(error).fold(0.0, f64::max)
        };
        let (coarse, fine) = (at(20), at(40));
        assert!(fine < 0.09 * coarse && fine < 1e-4, "{coarse:e} {fine:e}");
    }

    #[test]
    fn polynomials_are_found_again() {
        let length = 0.3;
        let exact = [0.004, -0.02, 0.3, -0.5];
        let offsets: Vec<[f64; 2]> = (0..=INTERVALS)
            .map(|k| {
                let s = length * k as f64 / INTERVALS as f64;
                [exact.iter().rev().fold(0.0, |sum, c| sum * s + c), 0.001]
            })
            .collect();
        let [x, y] = polynomials(&offsets, length).unwrap();
        assert!(x.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9) && x.len() == 4);
        assert!((y[0] - 0.001).abs() < 1e-12);
    }
}
