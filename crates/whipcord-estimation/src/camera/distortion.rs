use whipcord_numerics::{Mat3, Vec3};

use super::error::CameraError;
use whipcord::robot::limits::{DISTORTION_COEFFICIENT, LENS_TILT};

/// Farthest from the optical axis that a pinhole looks, as a tangent: 89.94°.
pub(super) const WIDEST: f64 = 1e3;

/// How a lens bends the image: OpenCV's model, eq. (c2) to (c4) of `docs/theory/cameras.md`.
///
/// With r² = x² + y² of the ideal point (x, y) at depth 1,
///
/// ```text
/// x″ = x ρ + 2 p₁xy + p₂(r² + 2x²) + s₁r² + s₂r⁴
/// y″ = y ρ + p₁(r² + 2y²) + 2 p₂xy + s₃r² + s₄r⁴         ρ = (1 + k₁r² + k₂r⁴ + k₃r⁶)/(1 + k₄r² + k₅r⁴ + k₆r⁶)
/// ```
///
/// and, for a sensor that is tilted by τx and τy, a homography after it. Source: OpenCV 4.x,
/// "Camera Calibration and 3D Reconstruction".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion {
    coefficients: [f64; 14],
    /// How many of them were given.
    count: usize,
    tilt: Option<Tilt>,
    reach: f64,
}

/// The homography of a tilted sensor, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tilt {
    forth: Mat3,
    back: Mat3,
}

/// A point of the image plane, and its derivatives by the ideal point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    pub(super) at: [f64; 2],
    /// Row i has the derivatives of component i by x and by y.
    pub(super) gradient: [[f64; 2]; 2],
}

impl Bent {
    fn determinant(&self) -> f64 {
        let [[a, b], [c, d]] = self.gradient;
        a * d - b * c
    }

    /// `gradient⁻¹ b`; the determinant must not vanish.
    fn solve(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.gradient;
        let scale = 1.0 / self.determinant();
        [(d * u - b * v) * scale, (a * v - c * u) * scale]
    }
}

impl Default for Distortion {
    fn default() -> Self {
        Self::NONE
    }
}

impl Distortion {
    /// A lens that bends nothing.
    pub const NONE: Self = Self { coefficients: [0.0; 14], count: 0, tilt: None, reach: WIDEST };

    /// From OpenCV's coefficients in its order: k₁ k₂ p₁ p₂, then k₃, then k₄ k₅ k₆, then
    /// s₁ s₂ s₃ s₄, then τx τy in rad.
    ///
    /// # Errors
    /// [`CameraError`] when there are not 0, 4, 5, 8, 12 or 14 of them, or one is out of its range.
    pub fn new(coefficients: &[f64]) -> Result<Self, CameraError> {
        const NAMES: [&str; 14] = [
            "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x",
            "tau_y",
        ];
        let count = coefficients.len();
        if ![0, 4, 5, 8, 12, 14].contains(&count) {
            return Err(CameraError::CoefficientCount { given: count });
        }
        let mut all = [0.0; 14];
        all[..count].copy_from_slice(coefficients);
        for (i, (&name, &value)) in NAMES.iter().zip(&all).enumerate() {
            let range = if i < 12 { DISTORTION_COEFFICIENT } else { LENS_TILT };
            CameraError::check(range, name, value)?;
        }
        let tilt = Tilt::new(all[12], all[13]);
        Ok(Self { coefficients: all, count, tilt, reach: reach(&all) })
    }

    /// The coefficients, as many as were given.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients[..self.count]
    }

    /// How far from the optical axis the lens can look, as an angle in rad: up to the first ring
    /// that is seen where a ring nearer to the axis is seen, too. Farther out the formula folds the
    /// image onto itself, and means nothing.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach.atan()
    }

    /// Where the ideal point (x, y) is seen; `None` beyond the reach, and where the image folds.
    pub(super) fn bend(&self, [x, y]: [f64; 2]) -> Option<Bent> {
        let bent = self.bend_untilted([x, y])?;
        match &self.tilt {
            None => Some(bent),
            Some(tilt) => tilt.tilted(&bent),
        }
    }

    /// Eq. (c2) and (c3).
    fn bend_untilted(&self, [x, y]: [f64; 2]) -> Option<Bent> {
        let [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, _, _] = self.coefficients;
        let q = x * x + y * y;
        // Written so that a NaN is refused as well.
        if q.is_nan() || q > self.reach * self.reach {
            return None;
        }
        let above = 1.0 + q * (k1 + q * (k2 + q * k3));
        let below = 1.0 + q * (k4 + q * (k5 + q * k6));
        let radial = above / below;
        let above_rate = k1 + q * (2.0 * k2 + 3.0 * q * k3);
        let below_rate = k4 + q * (2.0 * k5 + 3.0 * q * k6);
        let rate = (above_rate - radial * below_rate) / below;
        let (prism_x, prism_y) = (2.0 * (s1 + 2.0 * q * s2), 2.0 * (s3 + 2.0 * q * s4));
        let mixed = 2.0 * (x * y * rate + p1 * x + p2 * y);
        let bent = Bent {
            at: [
                x * radial + 2.0 * p1 * x * y + p2 * (q + 2.0 * x * x) + q * (s1 + q * s2),
                y * radial + p1 * (q + 2.0 * y * y) + 2.0 * p2 * x * y + q * (s3 + q * s4),
            ],
            gradient: [
                [
                    radial + 2.0 * (x * x * rate + p1 * y + 3.0 * p2 * x) + prism_x * x,
                    mixed + prism_x * y,
                ],
                [
                    mixed + prism_y * x,
                    radial + 2.0 * (y * y * rate + 3.0 * p1 * y + p2 * x) + prism_y * y,
                ],
            ],
        };
        let regular = bent.determinant() > 0.0 && bent.at.iter().all(|c| c.is_finite());
        regular.then_some(bent)
    }

    /// Eq. (k3): derivatives of (x″, y″) by the first twelve coefficients, in their order.
    pub(super) fn by_coefficients(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 12] {
        let [k1, k2, _, _, k3, k4, k5, k6, ..] = self.coefficients;
        let q = x * x + y * y;
        let below = 1.0 + q * (k4 + q * (k5 + q * k6));
        let radial = (1.0 + q * (k1 + q * (k2 + q * k3))) / below;
        let above = |power: i32| [x, y].map(|c| c * q.powi(power) / below);
        let under = |power: i32| [x, y].map(|c| -c * radial * q.powi(power) / below);
        [
            above(1),
            above(2),
            [2.0 * x * y, q + 2.0 * y * y],
            [q + 2.0 * x * x, 2.0 * x * y],
            above(3),
            under(1),
            under(2),
            under(3),
            [q, 0.0],
            [q * q, 0.0],
            [0.0, q],
            [0.0, q * q],
        ]
    }

    /// The ideal point that is seen at `seen`, by Newton's method; `None` where it finds none.
    ///
    /// An answer is one: its last step is below 10⁻¹² of the coordinates, at a point within the reach
    /// where the determinant of the Jacobian is positive, so that the error is of the order of that
    /// step. Far out, where the full step misses, the point is followed from the centre outwards.
    pub(super) fn straighten(&self, seen: [f64; 2]) -> Option<[f64; 2]> {
        const STRIDES: i32 = 32;
        let goal = match &self.tilt {
            None => seen,
            Some(tilt) => homography(&tilt.back, seen)?.0,
        };
        let distance = goal[0].hypot(goal[1]);
        if distance > 1e6 * WIDEST {
            return None;
        }
        let within = (0.9 * self.reach / distance).min(1.0);
        if let Some(ideal) = self.newton(goal.map(|c| c * within), goal) {
            return Some(ideal);
        }
        let mut ideal = [0.0; 2];
        for stride in 1..=STRIDES {
            let part = f64::from(stride) / f64::from(STRIDES);
            ideal = self.newton(ideal, goal.map(|c| c * part))?;
        }
        Some(ideal)
    }

    /// Damped Newton steps from `start` to where the lens without tilt bends a point to `goal`.
    fn newton(&self, start: [f64; 2], goal: [f64; 2]) -> Option<[f64; 2]> {
        const STEPS: usize = 40;
        const LEAST_DAMPING: f64 = 1e-9;
        const TOLERANCE: f64 = 1e-12;
        let miss = |bent: &Bent| [goal[0] - bent.at[0], goal[1] - bent.at[1]];
        let length = |[x, y]: [f64; 2]| x.hypot(y);
        let mut point = start;
        let mut bent = self.bend_untilted(point)?;
        for _ in 0..STEPS {
            let step = bent.solve(miss(&bent));
            let mut damping = 1.0;
            let better = loop {
                let trial = [point[0] + damping * step[0], point[1] + damping * step[1]];
                let nearer = self
                    .bend_untilted(trial)
                    .filter(|next| length(miss(next)) < length(miss(&bent)));
                if let Some(next) = nearer {
                    break Some((trial, next));
                }
                damping *= 0.5;
                if damping < LEAST_DAMPING || length(step) <= TOLERANCE * (1.0 + length(point)) {
                    break None;
                }
            };
            let Some((trial, next)) = better else {
                let converged = length(step) <= TOLERANCE * (1.0 + length(point));
                return converged.then_some(point);
            };
            (point, bent) = (trial, next);
        }
        None
    }
}

impl Tilt {
    /// Eq. (c4): the homography of a sensor that is turned by R(τx, τy).
    fn new(tau_x: f64, tau_y: f64) -> Option<Self> {
        if tau_x == 0.0 && tau_y == 0.0 {
            return None;
        }
        let ((sx, cx), (sy, cy)) = (tau_x.sin_cos(), tau_y.sin_cos());
        let turn = Mat3::from_rows(
            Vec3::new(cy, sy * sx, -sy * cx),
            Vec3::new(0.0, cx, sx),
            Vec3::new(sy, -cy * sx, cy * cx),
        );
        let depth = cy * cx;
        let plane = Mat3::from_rows(
            Vec3::new(depth, 0.0, sy * cx),
            Vec3::new(0.0, depth, -sx),
            Vec3::new(0.0, 0.0, 1.0),
        );
        let plane_back = Mat3::from_rows(
            Vec3::new(1.0 / depth, 0.0, -sy * cx / depth),
            Vec3::new(0.0, 1.0 / depth, sx / depth),
            Vec3::new(0.0, 0.0, 1.0),
        );
        Some(Self { forth: plane * turn, back: turn.transpose() * plane_back })
    }

    fn tilted(&self, bent: &Bent) -> Option<Bent> {
        let (at, by_plane) = homography(&self.forth, bent.at)?;
        let [[a, b], [c, d]] = bent.gradient;
        let gradient = by_plane.map(|[u, v]| [u * a + v * c, u * b + v * d]);
        Some(Bent { at, gradient })
    }
}

/// Where a homography takes a point, and the derivatives; `None` beyond its horizon.
fn homography(matrix: &Mat3, [x, y]: [f64; 2]) -> Option<([f64; 2], [[f64; 2]; 2])> {
    let w = *matrix * Vec3::new(x, y, 1.0);
    // So near to the horizon nothing is seen.
    if w.z.is_nan() || w.z < 1e-9 {
        return None;
    }
    let at = [w.x / w.z, w.y / w.z];
    let last = matrix.rows[2];
    let row = |i: usize| {
        let own = matrix.rows[i];
        [(own.x - at[i] * last.x) / w.z, (own.y - at[i] * last.y) / w.z]
    };
    Some((at, [row(0), row(1)]))
}

/// The radius up to which r ρ(r²) grows, eq. (c5): before the first root in q = r² of its
/// derivative's numerator A B + 2q (A′B − A B′), ρ = A/B, or of B.
fn reach(coefficients: &[f64; 14]) -> f64 {
    let [k1, k2, _, _, k3, k4, k5, k6, ..] = *coefficients;
    let (above, below) = ([1.0, k1, k2, k3], [1.0, k4, k5, k6]);
    let mut growth = [0.0; 7];
    for i in 0..4 {
        for j in 0..4 {
            growth[i + j] += above[i] * below[j] * (1.0 + 2.0 * (i as f64 - j as f64));
        }
    }
    let end = WIDEST * WIDEST;
    let first = |polynomial: &[f64]| sign_changes(polynomial, end).first().copied().unwrap_or(end);
    first(&growth).min(first(&below)).sqrt()
}

/// Where a polynomial, given by ascending powers, changes its sign between 0 and `end`: bisection
/// between the places where its derivative does.
fn sign_changes(polynomial: &[f64], end: f64) -> Vec<f64> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let value = |q: f64| polynomial.iter().rev().fold(0.0, |sum, &c| sum * q + c);
    let rate: Vec<f64> =
        polynomial.iter().enumerate().skip(1).map(|(power, &c)| power as f64 * c).collect();
    let mut places = sign_changes(&rate, end);
    places.insert(0, 0.0);
    places.push(end);
    places
        .windows(2)
        .filter(|ends| (value(ends[0]) > 0.0) != (value(ends[1]) > 0.0))
        .map(|ends| {
            let (mut low, mut high) = (ends[0], ends[1]);
            loop {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    return low;
                }
                if (value(middle) > 0.0) == (value(low) > 0.0) {
                    low = middle
                } else {
                    high = middle
                }
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_kind() -> Distortion {
        Distortion::new(&[
            -0.3, 0.12, 1e-3, -7e-4, -0.02, 0.05, -0.01, 2e-3, 1e-3, -5e-4, 8e-4, 3e-4, 0.03, -0.05,
        ])
        .unwrap()
    }

    #[test]
    fn the_gradient_is_that_of_the_formula() {
        let h = 1e-6;
        for [x, y] in [[0.0, 0.0], [0.4, -0.3], [-0.2, 0.5], [0.6, 0.6]] {
            let bend = |x, y| every_kind().bend([x, y]).unwrap();
            let got = bend(x, y).gradient;
            for i in 0..2 {
                let by_x = (bend(x + h, y).at[i] - bend(x - h, y).at[i]) / (2.0 * h);
                let by_y = (bend(x, y + h).at[i] - bend(x, y - h).at[i]) / (2.0 * h);
                assert!((got[i][0] - by_x).abs() < 1e-9, "{x} {y}");
                assert!((got[i][1] - by_y).abs() < 1e-9, "{x} {y}");
            }
        }
    }

    #[test]
    fn straightening_undoes_bending_up_to_the_reach() {
        let barrel = Distortion::new(&[-0.3, 0.0, 0.0, 0.0]).unwrap();
        // r − 0.3 r³ grows up to r = 1/√0.9.
        assert!((barrel.reach - 1.0 / 0.9_f64.sqrt()).abs() < 1e-14);
        for part in [0.0, 0.3, 0.9, 0.999, 0.999_999] {
            let ideal = [0.6 * part * barrel.reach, -0.8 * part * barrel.reach];
            let back = barrel.straighten(barrel.bend(ideal).unwrap().at).unwrap();
            assert!((back[0] - ideal[0]).hypot(back[1] - ideal[1]) < 1e-9, "{part}");
        }
        assert!(barrel.bend([1.1, 0.0]).is_none());
        assert_eq!(barrel.straighten([0.8, 0.0]), None, "beyond the edge of the image, 0.703");
        for ideal in [[0.0, 0.0], [0.5, -0.4], [-0.7, 0.1]] {
            let back = every_kind().straighten(every_kind().bend(ideal).unwrap().at).unwrap();
            assert!((back[0] - ideal[0]).hypot(back[1] - ideal[1]) < 1e-13);
        }
    }

    #[test]
    fn a_lens_looks_as_far_as_its_image_does_not_fold() {
        assert_eq!(Distortion::NONE.reach, WIDEST);
        let pole = Distortion::new(&[0.0, 0.0, 0.0, 0.0, 0.0, -0.25, 0.0, 0.0]).unwrap();
        assert!((pole.reach - 2.0).abs() < 1e-12, "{}", pole.reach);
        // Beyond a second fold the radius grows again; the first one counts.
        let twice = Distortion::new(&[-1.0, 0.3, 0.0, 0.0]).unwrap();
        let growth = |r: f64| 1.0 - 3.0 * r * r + 1.5 * r.powi(4);
        assert!(growth(twice.reach).abs() < 1e-12 && growth(2.0) > 0.0);
        assert!(twice.bend([2.0, 0.0]).is_none());
    }
}
