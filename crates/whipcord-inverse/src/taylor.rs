//! A point as a polynomial of coordinates of the tensions, and how near a target it can be within a box.

use whipcord::Vec3;
use whipcord_numerics::{Programme, QuadraticProgramme, symmetric_eigen};

use crate::antagonists::Piece;
use crate::corners::greatest_sum;

/// A point by its first derivatives in the middle of a box, or by its first and second ones, and what it differs by within the box.
#[derive(Clone, Debug)]
pub(crate) struct Taylor {
    /// The coordinates in the middle.
    pub center: Vec<f64>,
    /// From the target to the point in the middle.
    pub miss: Vec3,
    /// By each coordinate.
    pub first: Vec<Vec3>,
    /// By coordinates `b ≤ a`, one row after the other; none of a polynomial of first degree.
    pub second: Vec<Vec3>,
    /// In m.
    pub remainder: f64,
}

/// Memory of [`Bound::of`].
#[derive(Debug, Default)]
pub(crate) struct Bound {
    solver: QuadraticProgramme,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    lower: Vec<f64>,
    rows: Vec<f64>,
    limits: Vec<f64>,
    step: Vec<f64>,
    offset: Vec<f64>,
    /// Of the point with each coordinate.
    motions: Vec<Vec3>,
    eigenvectors: Vec<f64>,
    eigenvalues: Vec<f64>,
    concave: Vec<[Vec3; 2]>,
}

impl Taylor {
    /// The order of the derivatives that are left.
    pub fn order(&self) -> i32 {
        if self.second.is_empty() { 2 } else { 3 }
    }

    /// `∂ₐ∂_b p`.
    fn second(&self, a: usize, b: usize) -> Vec3 {
        let (row, column) = (a.max(b), a.min(b));
        self.second[row * (row + 1) / 2 + column]
    }
}

impl Bound {
    /// A lower bound of the distance of the polynomial from the target over what is within the limits of a box within its own; infinite where nothing is. It is not sought beyond what is enough, and zero where it
    /// turns out to be less than the least that counts.
    ///
    /// For every unit vector `n` the distance is at least the least `n·r`.
    pub fn of(
        &mut self,
        taylor: &Taylor,
        piece: &Piece,
        center: &[f64],
        half: &[f64],
        [least, enough]: [f64; 2],
    ) -> f64 {
        let n = half.len();
        self.offset.clear();
        self.offset.extend(center.iter().zip(&taylor.center).map(|(to, from)| to - from));
        // The same polynomial about the middle of the box.
        self.motions.clone_from(&taylor.first);
        let each = taylor.first.iter().zip(&self.offset);
        let mut miss = each.fold(taylor.miss, |miss, (motion, by)| miss + *motion * *by);
        let is_quadratic = !taylor.second.is_empty();
        if is_quadratic {
            for a in 0..n {
                for b in 0..n {
                    let second = taylor.second(a, b) * self.offset[b];
                    self.motions[a] += second;
                    miss += second * (0.5 * self.offset[a]);
                }
            }
        }
        // No direction has a bound beyond the distance of a point of the box.
        if miss.norm() < least {
            return 0.0;
        }
        self.lower.clear();
        self.lower.extend(half.iter().map(|h| -h));
        piece.rows(center, half, &mut self.rows, &mut self.limits);
        let mut nearest = self.nearest(miss, half);
        if is_quadratic {
            for a in 0..n {
                for b in 0..n {
                    nearest += taylor.second(a, b) * (0.5 * self.step[a] * self.step[b]);
                }
            }
        }
        let most = nearest.norm().min(miss.norm());
        let mut best = 0.0;
        for direction in [nearest, miss] {
            if most < least || most <= best || best >= enough {
                continue;
            }
            let along = unit(direction);
            self.gradient.clear();
            self.gradient.extend(self.motions.iter().map(|motion| along.dot(*motion)));
            let lowest = match is_quadratic {
                true => self.least(taylor, piece, along, center, half),
                false => piece.least(&self.gradient, center, half),
            };
            best = f64::max(best, along.dot(miss) + lowest.unwrap_or(f64::INFINITY));
        }
        best
    }

    /// The least `r + J d` over a box; leaves the step there.
    fn nearest(&mut self, miss: Vec3, half: &[f64]) -> Vec3 {
        let n = half.len();
        self.matrix.clear();
        self.gradient.clear();
        for a in &self.motions {
            self.matrix.extend(self.motions.iter().map(|b| a.dot(*b)));
            self.gradient.push(a.dot(miss));
        }
        self.minimise(half);
        let steps = self.motions.iter().zip(&self.step[..n]);
        steps.fold(miss, |miss, (motion, d)| miss + *motion * *d)
    }

    /// Minimises `½ dᵀ M d + g·d` over a box; the step is zero where that fails. What is added to the diagonal of `M`, which may have no inverse, is returned.
    fn minimise(&mut self, half: &[f64]) -> f64 {
        let n = half.len();
        let trace: f64 = (0..n).map(|i| self.matrix[i * n + i]).sum();
        let added = 1e-9 * trace;
        for i in 0..n {
            self.matrix[i * n + i] += added;
        }
        let programme = Programme {
            matrix: &self.matrix,
            gradient: &self.gradient,
            lower: &self.lower,
            upper: half,
            rows: &self.rows,
            limits: &self.limits,
        };
        if self.solver.minimise(&programme, &mut self.step).is_err() {
            self.step.clear();
            self.step.resize(n, 0.0);
        }
        added
    }

    /// A lower bound of `g·d + ½ dᵀ N d` over what is within the limits of a box, for the gradient and the second derivatives `N` along a direction; `None` where nothing is.
    ///
    /// `N` is the sum of a positive and a negative semidefinite part. The first with `g` is convex, and so no less than its tangent at any `d`; the least value of the second is at a corner.
    fn least(
        &mut self,
        taylor: &Taylor,
        piece: &Piece,
        along: Vec3,
        center: &[f64],
        half: &[f64],
    ) -> Option<f64> {
        let n = half.len();
        // In parts of the half widths.
        self.matrix.clear();
        for a in 0..n {
            let row = (0..n).map(|b| along.dot(taylor.second(a, b)) * half[a] * half[b]);
            self.matrix.extend(row);
        }
        self.eigenvectors.resize(n * n, 0.0);
        self.eigenvalues.clear();
        self.eigenvalues.extend(symmetric_eigen(n, &mut self.matrix, &mut self.eigenvectors));
        let vectors = || self.eigenvalues.iter().zip(self.eigenvectors.chunks_exact(n.max(1)));
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for (value, vector) in vectors().filter(|(value, _)| **value > 0.0) {
            for a in 0..n {
                for b in 0..n {
                    let scale = half[a] * half[b];
                    if scale > 0.0 {
                        self.matrix[a * n + b] += value * vector[a] * vector[b] / scale;
                    }
                }
            }
        }
        let mut concave = 0.0;
        // No more than six numbers fit into the sums over corners; what is left is bounded by itself.
        let mut negative: Vec<(f64, &[f64])> =
            vectors().filter(|(value, _)| **value < 0.0).map(|(value, of)| (-value, of)).collect();
        negative.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (together, alone) = negative.split_at(negative.len().min(6));
        for (value, vector) in alone {
            let most: f64 = vector.iter().map(|of| of.abs()).sum();
            concave += value * most * most;
        }
        self.concave.clear();
        self.concave.extend((0..n).map(|k| {
            let part = |m: usize| together.get(m).map_or(0.0, |(value, of)| value.sqrt() * of[k]);
            [Vec3::new(part(0), part(1), part(2)), Vec3::new(part(3), part(4), part(5))]
        }));
        let squared = |[a, b]: &[Vec3; 2]| a.norm_squared() + b.norm_squared();
        let greatest = greatest_sum(&mut self.concave, squared);
        concave += greatest * greatest;
        let added = self.minimise(half);
        let mut value = 0.0;
        for a in 0..n {
            let row = &self.matrix[a * n..(a + 1) * n];
            let by: f64 = row.iter().zip(&self.step).map(|(of, d)| of * d).sum();
            let by = by - added * self.step[a];
            // The convex part is ½ d M d + g d; its tangent at the step starts at −½ d M d.
            value -= 0.5 * self.step[a] * by;
            self.gradient[a] += by;
        }
        let least = piece.least(&self.gradient, center, half)?;
        Some(value + least - 0.5 * concave)
    }
}

fn unit(direction: Vec3) -> Vec3 {
    direction * (1.0 / direction.norm().max(f64::MIN_POSITIVE))
}
