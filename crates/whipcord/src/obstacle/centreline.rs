//! The middle of a pipe: a line through points, straight or smooth, and its nearest point.

use whipcord_numerics::{PiecewiseCubic, Vec3};

use crate::robot::{Problem, RobotError, limits};

/// How the middle of a pipe goes from point to point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bends {
    /// Along a smooth curve: a cubic spline in the lengths of the chords.
    #[default]
    Smooth,
    /// Straight, with a corner at every point between.
    Corners,
}

/// Samples from one point to the next of a smooth line.
const SAMPLES: usize = 12;
/// Newton's steps, or halvings, to the nearest point; from a sample, two or three are enough.
const STEPS: usize = 60;
/// Steps shorter than this part of the distance between the samples before and after are the last.
const CONVERGED: f64 = 4e-9;
/// Most points, so that none looks for long.
const MOST_POINTS: usize = 10_000;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Centreline {
    bends: Bends,
    /// Parameters of the samples: lengths along the chords in m.
    at: Vec<f64>,
    samples: Vec<Vec3>,
    tangents: Vec<Vec3>,
    /// First two derivatives of a smooth line by the parameter at each sample.
    derivatives: Vec<[Vec3; 2]>,
    /// The smooth line by its coordinates; none of a line with corners.
    smooth: Option<[PiecewiseCubic; 3]>,
    /// Balls that hold the samples, so many to each in their order; the last holds what is left.
    balls: Vec<Ball>,
}

/// A ball around some of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ball {
    centre: Vec3,
    radius: f64,
}

/// The nearest point of a line.
pub(super) struct Foot {
    pub foot: Vec3,
    /// Unit tangent there.
    pub tangent: Vec3,
    pub place: Where,
}

/// Where a point is to the line.
pub(super) enum Where {
    /// Beside it.
    Along,
    /// Beyond an end, at which the unit tangent out of the line is this one.
    Beyond { outwards: Vec3 },
}

impl Centreline {
    pub(super) fn new(points: &[Vec3], bends: Bends) -> Result<Self, RobotError> {
        let count = points.len();
        if count < 2 {
            return Err(RobotError::new("points", Problem::TooFew { given: count, least: 2 }));
        }
        if count > MOST_POINTS {
            let problem = Problem::TooMany { given: count, most: MOST_POINTS };
            return Err(RobotError::new("points", problem));
        }
        let mut at = vec![0.0];
        for (k, &point) in points.iter().enumerate() {
            limits::COORDINATE.check_vector(&format!("points[{k}]"), point)?;
            if k > 0 {
                let chord = (point - points[k - 1]).norm();
                limits::LENGTH.check("", chord).map_err(|_| {
                    RobotError::new(format!("points[{k}]"), Problem::TooNear { chord })
                })?;
                at.push(at[k - 1] + chord);
            }
        }
        let smooth = match bends {
            Bends::Smooth if count > 2 => coordinates(&at, points),
            _ => None,
        };
        let Some(smooth) = smooth else {
            let tangents = (0..count).map(|k| {
                let (a, b) = if k + 1 < count { (k, k + 1) } else { (k - 1, k) };
                (points[b] - points[a]) / (at[b] - at[a])
            });
            let tangents = tangents.collect();
            return Ok(Self {
                bends,
                at,
                samples: points.to_vec(),
                tangents,
                derivatives: Vec::new(),
                smooth: None,
                balls: Vec::new(),
            });
        };
        let between = |w: &[f64]| {
            let (a, b) = (w[0], w[1]);
            (0..SAMPLES).map(move |i| a + (b - a) * i as f64 / SAMPLES as f64)
        };
        let fine: Vec<f64> = at.windows(2).flat_map(between).chain(at.last().copied()).collect();
        let (samples, derivatives): (Vec<Vec3>, Vec<[Vec3; 2]>) = fine
            .iter()
            .map(|&u| {
                let [c, dc, ddc] = evaluate(&smooth, u);
                (c, [dc, ddc])
            })
            .unzip();
        let tangents = derivatives.iter().map(|[dc, _]| *dc / dc.norm()).collect();
        let balls = samples.chunks(SAMPLES).map(Ball::around).collect();
        let smooth = Some(smooth);
        let line = Self { bends, at: fine, samples, tangents, derivatives, smooth, balls };
        match line.tangents.iter().position(|t| !t.is_finite()) {
            // Points that go back the way they came.
            Some(k) => {
                let path = format!("points[{}]", k / SAMPLES);
                Err(RobotError::new(path, Problem::TurnsBack))
            }
            None => Ok(line),
        }
    }

    pub(super) fn bends(&self) -> Bends {
        self.bends
    }

    pub(super) fn samples(&self) -> (&[Vec3], &[Vec3]) {
        (&self.samples, &self.tangents)
    }

    /// Both ends, with the unit tangents out of the line.
    pub(super) fn ends(&self) -> [(Vec3, Vec3); 2] {
        let last = self.samples.len() - 1;
        [(self.samples[0], -self.tangents[0]), (self.samples[last], self.tangents[last])]
    }

    /// The greatest curvature at a sample, in 1/m; zero of a line with corners.
    pub(super) fn sharpest(&self) -> f64 {
        let curvature = |[dc, ddc]: &[Vec3; 2]| dc.cross(*ddc).norm() / dc.norm().powi(3);
        self.derivatives.iter().map(curvature).fold(0.0, f64::max)
    }

    /// The nearest point of the line, from the nearest of its samples: exact wherever the point is
    /// nearer to the line than the line's radius of curvature and than its other parts.
    pub(super) fn nearest(&self, point: Vec3) -> Foot {
        match &self.smooth {
            None => self.nearest_chord(point),
            Some(smooth) => self.nearest_smooth(smooth, point),
        }
    }

    fn nearest_chord(&self, point: Vec3) -> Foot {
        let (mut best, mut foot, mut chord, mut part) = (f64::INFINITY, self.samples[0], 0, 0.0);
        for (k, ends) in self.samples.windows(2).enumerate() {
            let along = ends[1] - ends[0];
            let t = ((point - ends[0]).dot(along) / along.norm_squared()).clamp(0.0, 1.0);
            let candidate = ends[0] + t * along;
            let squared = (point - candidate).norm_squared();
            if squared < best {
                (best, foot, chord, part) = (squared, candidate, k, t);
            }
        }
        let tangent = self.tangents[chord];
        let place = if chord == 0 && part <= 0.0 {
            Where::Beyond { outwards: -tangent }
        } else if chord + 2 == self.samples.len() && part >= 1.0 {
            Where::Beyond { outwards: tangent }
        } else {
            Where::Along
        };
        Foot { foot, tangent, place }
    }

    /// The nearest of the samples, the first of several: only balls that may hold it are looked into, the nearest first.
    fn nearest_sample(&self, point: Vec3) -> usize {
        let squared = |ball: &Ball| (point - ball.centre).norm_squared();
        let mut first = (f64::INFINITY, 0);
        for (k, ball) in self.balls.iter().enumerate() {
            let here = squared(ball);
            if here < first.0 {
                first = (here, k);
            }
        }
        let mut best = (f64::INFINITY, 0);
        let look = |best: &mut (f64, usize), k: usize| {
            let from = k * SAMPLES;
            let to = (from + SAMPLES).min(self.samples.len());
            for (i, &sample) in self.samples[from..to].iter().enumerate() {
                let here = (point - sample).norm_squared();
                if here < best.0 || here == best.0 && from + i < best.1 {
                    *best = (here, from + i);
                }
            }
        };
        look(&mut best, first.1);
        for (k, ball) in self.balls.iter().enumerate() {
            // With room for rounding.
            let farthest = (best.0.sqrt() + ball.radius) * (1.0 + 1e-9);
            if k != first.1 && squared(ball) <= farthest * farthest {
                look(&mut best, k);
            }
        }
        best.1
    }

    fn nearest_smooth(&self, smooth: &[PiecewiseCubic; 3], point: Vec3) -> Foot {
        let nearest = self.nearest_sample(point);
        let last = self.samples.len() - 1;
        // Beside a sample its own piece of the spline, or that before it.
        let pieces = last / SAMPLES;
        let at = |u: f64| {
            let from = if u < self.at[nearest] { nearest.saturating_sub(1) } else { nearest };
            evaluate_piece(smooth, (from / SAMPLES).min(pieces - 1), u)
        };
        // How fast the squared distance grows, by half: its root is the nearest point.
        let growth = |[c, dc, ddc]: [Vec3; 3]| {
            let away = c - point;
            (away.dot(dc), dc.norm_squared() + away.dot(ddc))
        };
        let end = |k: usize, outwards: Vec3| Foot {
            foot: self.samples[k],
            tangent: self.tangents[k],
            place: Where::Beyond { outwards },
        };
        let (mut low, mut high) =
            (self.at[nearest.saturating_sub(1)], self.at[(nearest + 1).min(last)]);
        if nearest == 0 && growth(at(low)).0 >= 0.0 {
            return end(0, -self.tangents[0]);
        }
        if nearest == last && growth(at(high)).0 <= 0.0 {
            return end(last, self.tangents[last]);
        }
        // A step of Newton's method from the sample, where the squared distance bends upwards there, is a start; else the parameter is a
        // length, nearly.
        let [dc, ddc] = self.derivatives[nearest];
        let (g, dg) = growth([self.samples[nearest], dc, ddc]);
        let ahead = -g / if dg > 0.0 { dg } else { dc.norm_squared() };
        let mut u = (self.at[nearest] + ahead).clamp(low, high);
        let mut here = at(u);
        let tolerance = (CONVERGED * (high - low)).max(4.0 * f64::EPSILON * self.at[last]);
        for _ in 0..STEPS {
            let (g, dg) = growth(here);
            let newton = -g / dg;
            // Quadratic: what is left after a step this short is below rounding. It may lead out of the interval by rounding.
            if dg > 0.0 && newton.abs() <= tolerance {
                let [c, dc, ddc] = here;
                here = [c + newton * (dc + 0.5 * newton * ddc), dc + newton * ddc, ddc];
                break;
            }
            if g > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let inside = dg > 0.0 && u + newton > low && u + newton < high;
            let next = if inside { u + newton } else { 0.5 * (low + high) };
            // Halved until nothing is left.
            if next == u {
                break;
            }
            u = next;
            here = at(u);
        }
        let [foot, dc, _] = here;
        Foot { foot, tangent: dc / dc.norm(), place: Where::Along }
    }
}

impl Ball {
    fn around(samples: &[Vec3]) -> Self {
        let sum = samples.iter().fold(Vec3::ZERO, |sum, &sample| sum + sample);
        let centre = sum / samples.len() as f64;
        let apart = |&sample: &Vec3| (sample - centre).norm();
        Self { centre, radius: samples.iter().map(apart).fold(0.0, f64::max) }
    }
}

/// The spline of each coordinate; `None` never with increasing parameters.
fn coordinates(at: &[f64], points: &[Vec3]) -> Option<[PiecewiseCubic; 3]> {
    let coordinate = |i: usize| {
        let values: Vec<f64> = points.iter().map(|p| p[i]).collect();
        PiecewiseCubic::spline(at, &values).ok()
    };
    Some([coordinate(0)?, coordinate(1)?, coordinate(2)?])
}

/// A point of a smooth line and its first two derivatives.
fn evaluate(smooth: &[PiecewiseCubic; 3], u: f64) -> [Vec3; 3] {
    evaluate_piece(smooth, smooth[0].piece(u), u)
}

/// The same on a piece that is known.
#[inline]
fn evaluate_piece(smooth: &[PiecewiseCubic; 3], piece: usize, u: f64) -> [Vec3; 3] {
    let [x, y, z] = smooth;
    let x = x.evaluate_piece(piece, u);
    let y = y.evaluate_piece(piece, u);
    let z = z.evaluate_piece(piece, u);
    [Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1]), Vec3::new(x[2], y[2], z[2])]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The foot is exact to rounding: away from it leads no part along the line.
    fn assert_exact(points: &[Vec3]) {
        let line = Centreline::new(points, Bends::Smooth).unwrap();
        let size = points.iter().map(|point| point.norm()).fold(0.0, f64::max);
        let (samples, tangents) = line.samples();
        let mut looked = 0;
        for (k, (&sample, &tangent)) in samples.iter().zip(tangents).enumerate().skip(1) {
            let spacing = (sample - samples[k - 1]).norm();
            let across = tangent.cross(Vec3::new(0.3, -0.5, 0.8));
            let across = across / across.norm();
            // On the sample, next to it by rounding, and between it and the next.
            for ahead in [0.0, 1e-15, -1e-15, 1e-9, 0.3, -0.499] {
                for aside in [1e-3, 0.1] {
                    let point = sample + tangent * (ahead * spacing) + across * (aside * spacing);
                    let Foot { foot, tangent, place } = line.nearest(point);
                    if matches!(place, Where::Along) {
                        let along = (point - foot).dot(tangent);
                        assert!(along.abs() < 4.0 * f64::EPSILON * size, "{along} at {point:?}");
                        looked += 1;
                    }
                }
            }
        }
        assert!(looked > 10 * samples.len(), "{looked}");
    }

    #[test]
    fn the_nearest_point_is_exact_to_rounding() {
        let bend = |k: u8| {
            let (sin, cos) = (f64::from(k) * 0.17).sin_cos();
            Vec3::new(0.08 * (1.0 - cos), 0.0, 0.08 * sin)
        };
        assert_exact(&(0..10).map(bend).collect::<Vec<_>>());
        let coil = |k: u8| {
            let (sin, cos) = (f64::from(k) * 0.5).sin_cos();
            Vec3::new(0.05 * cos, 0.05 * sin, 0.004 * f64::from(k))
        };
        assert_exact(&(0..30).map(coil).collect::<Vec<_>>());
        // Chords that differ by a factor of 1000.
        let chords = [0.0, 1.0, 1.001, 1.002, 1.1, 2.0];
        assert_exact(&chords.map(|z: f64| Vec3::new(0.01 * (3.0 * z).sin(), 0.0, z)));
    }
}
