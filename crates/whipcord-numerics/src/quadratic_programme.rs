//! Small convex quadratic programmes with bounds and general linear constraints.

/// Minimises `½ xᵀH x + gᵀx` over `l ≤ x ≤ u` and `A x ≤ b`, for a positive definite `H`, by the dual active-set method: from
/// the minimum without constraints, the most violated constraint is added and those whose multiplier reaches zero are dropped, so that every iterate
/// is the minimum over the constraints of its active set.
///
/// The workspace is kept between programmes: one of a size met before allocates nothing.
///
/// Source: Goldfarb and Idnani, A numerically stable dual method for solving strictly convex quadratic programs,
/// Mathematical Programming 27 (1983), 1–33.
///
/// ```
/// use whipcord_numerics::{Programme, QuadraticProgramme};
/// // The point of x + y ≤ 1, x ≤ 0.2 that is nearest to (2, 1).
/// let programme = Programme {
///     matrix: &[1.0, 0.0, 0.0, 1.0],
///     gradient: &[-2.0, -1.0],
///     lower: &[f64::NEG_INFINITY; 2],
///     upper: &[0.2, f64::INFINITY],
///     rows: &[1.0, 1.0],
///     limits: &[1.0],
/// };
/// let mut solver = QuadraticProgramme::default();
/// let mut x = Vec::new();
/// solver.minimise(&programme, &mut x)?;
/// assert!((x[0] - 0.2).abs() < 1e-12 && (x[1] - 0.8).abs() < 1e-12);
/// # Ok::<(), whipcord_numerics::NoMinimum>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct QuadraticProgramme {
    n: usize,
    /// `L` of `H = L Lᵀ`, by rows.
    factor: Vec<f64>,
    /// `J = L⁻ᵀ Q` of the paper, by rows: its first columns belong to the active constraints.
    basis: Vec<f64>,
    /// `R` of the paper, upper triangular, `n` entries a row.
    triangle: Vec<f64>,
    active: Vec<Constraint>,
    multipliers: Vec<f64>,
    /// Scratch: normal of a constraint, `Jᵀ n`, the direction of the unknowns, and of the multipliers.
    normal: Vec<f64>,
    projected: Vec<f64>,
    direction: Vec<f64>,
    dual_direction: Vec<f64>,
}

/// The data of a programme; a bound may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct Programme<'a> {
    /// `H` by rows.
    pub matrix: &'a [f64],
    /// `g`.
    pub gradient: &'a [f64],
    /// `l`.
    pub lower: &'a [f64],
    /// `u`.
    pub upper: &'a [f64],
    /// `A` by rows.
    pub rows: &'a [f64],
    /// `b`.
    pub limits: &'a [f64],
}

/// A constraint of a [`Programme`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constraint {
    /// The lower bound of an unknown.
    Lower(usize),
    /// The upper bound of an unknown.
    Upper(usize),
    /// A row of `A`.
    Row(usize),
}

/// Why a programme has no minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoMinimum {
    /// The matrix is not positive definite to rounding, or a number is not finite.
    NotPositiveDefinite,
    /// No point meets all constraints.
    Infeasible,
    /// The active set was not found, because of rounding.
    Rounding,
}

impl core::fmt::Display for NoMinimum {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::NotPositiveDefinite => "the matrix is not positive definite",
            Self::Infeasible => "no point meets all constraints",
            Self::Rounding => "rounding keeps the active set from being found",
        })
    }
}

impl core::error::Error for NoMinimum {}

/// Changes of the active set for each constraint after which rounding must be what keeps it going.
const CHANGES: usize = 10;

impl Programme<'_> {
    /// How much a constraint is kept, negative where it is violated.
    fn slack(&self, constraint: Constraint, x: &[f64]) -> f64 {
        match constraint {
            Constraint::Lower(i) => x[i] - self.lower[i],
            Constraint::Upper(i) => self.upper[i] - x[i],
            Constraint::Row(k) => {
                let row = &self.rows[k * x.len()..(k + 1) * x.len()];
                self.limits[k] - row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>()
            }
        }
    }

    /// The size of the terms of a slack, which its rounding is relative to.
    fn scale(&self, constraint: Constraint, x: &[f64]) -> f64 {
        match constraint {
            Constraint::Lower(i) => x[i].abs() + self.lower[i].abs(),
            Constraint::Upper(i) => x[i].abs() + self.upper[i].abs(),
            Constraint::Row(k) => {
                let row = &self.rows[k * x.len()..(k + 1) * x.len()];
                self.limits[k].abs() + row.iter().zip(x).map(|(a, x)| (a * x).abs()).sum::<f64>()
            }
        }
    }

    /// All constraints that can be active.
    fn constraints(&self) -> impl Iterator<Item = Constraint> + '_ {
        let lower = (0..self.lower.len())
            .filter(|&i| self.lower[i] > f64::NEG_INFINITY)
            .map(Constraint::Lower);
        let upper =
            (0..self.upper.len()).filter(|&i| self.upper[i] < f64::INFINITY).map(Constraint::Upper);
        let rows =
            (0..self.limits.len()).filter(|&k| self.limits[k] < f64::INFINITY).map(Constraint::Row);
        lower.chain(upper).chain(rows)
    }
}

impl QuadraticProgramme {
    /// Writes the minimiser into `minimiser`. Bounds are kept exactly, rows of `A` to rounding.
    ///
    /// # Errors
    /// [`NoMinimum`].
    pub fn minimise(
        &mut self,
        programme: &Programme<'_>,
        minimiser: &mut Vec<f64>,
    ) -> Result<(), NoMinimum> {
        let n = programme.gradient.len();
        debug_assert_eq!(programme.matrix.len(), n * n);
        debug_assert!(programme.lower.len() == n && programme.upper.len() == n);
        debug_assert_eq!(programme.rows.len(), n * programme.limits.len());
        self.n = n;
        self.factor(programme.matrix)?;
        self.active.clear();
        self.multipliers.clear();
        self.triangle.clear();
        self.triangle.resize(n * n, 0.0);
        for buffer in [&mut self.normal, &mut self.projected, &mut self.direction] {
            buffer.clear();
            buffer.resize(n, 0.0);
        }
        minimiser.clear();
        minimiser.extend(programme.gradient.iter().map(|g| -g));
        self.solve_unconstrained(minimiser);
        if minimiser.iter().any(|x| !x.is_finite()) {
            return Err(NoMinimum::NotPositiveDefinite);
        }
        let mut changes = 2 + CHANGES * (2 * n + programme.limits.len());
        while let Some(violated) = self.most_violated(programme, minimiser) {
            self.add(programme, violated, minimiser, &mut changes)?;
        }
        for (i, x) in minimiser.iter_mut().enumerate() {
            *x = x.max(programme.lower[i]).min(programme.upper[i]);
        }
        Ok(())
    }

    /// The constraints that are active at the minimum, with their multipliers, which are not negative.
    pub fn active(&self) -> impl Iterator<Item = (Constraint, f64)> + '_ {
        self.active.iter().copied().zip(self.multipliers.iter().copied())
    }

    /// `H = L Lᵀ` and `J = L⁻ᵀ`.
    fn factor(&mut self, matrix: &[f64]) -> Result<(), NoMinimum> {
        let n = self.n;
        self.factor.clear();
        self.factor.extend_from_slice(matrix);
        let l = &mut self.factor;
        for j in 0..n {
            let before: f64 = (0..j).map(|k| l[j * n + k] * l[j * n + k]).sum();
            let square = matrix[j * n + j] - before;
            let rounding = f64::EPSILON * matrix[j * n + j].abs();
            if !square.is_finite() || square <= rounding {
                return Err(NoMinimum::NotPositiveDefinite);
            }
            let diagonal = square.sqrt();
            l[j * n + j] = diagonal;
            for i in j + 1..n {
                let before: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                l[i * n + j] = (matrix[i * n + j] - before) / diagonal;
            }
        }
        // Row k of L⁻¹ is column k of J.
        self.basis.clear();
        self.basis.resize(n * n, 0.0);
        for column in 0..n {
            for i in column..n {
                let unit = if i == column { 1.0 } else { 0.0 };
                let before: f64 =
                    (column..i).map(|k| l[i * n + k] * self.basis[column * n + k]).sum();
                self.basis[column * n + i] = (unit - before) / l[i * n + i];
            }
        }
        Ok(())
    }

    /// Overwrites `b` by `H⁻¹ b`.
    fn solve_unconstrained(&self, b: &mut [f64]) {
        let (n, l) = (self.n, &self.factor);
        for i in 0..n {
            let before: f64 = (0..i).map(|k| l[i * n + k] * b[k]).sum();
            b[i] = (b[i] - before) / l[i * n + i];
        }
        for i in (0..n).rev() {
            let after: f64 = (i + 1..n).map(|k| l[k * n + i] * b[k]).sum();
            b[i] = (b[i] - after) / l[i * n + i];
        }
    }

    /// The constraint that is violated most beyond rounding.
    fn most_violated(&self, programme: &Programme<'_>, x: &[f64]) -> Option<Constraint> {
        let violated = |constraint: Constraint| {
            if self.active.contains(&constraint) {
                return None;
            }
            let slack = programme.slack(constraint, x);
            let rounding = 64.0 * f64::EPSILON * programme.scale(constraint, x);
            (slack < -rounding).then_some((constraint, slack))
        };
        let all = programme.constraints().filter_map(violated);
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(constraint, _)| constraint)
    }

    /// Makes a violated constraint active, and drops those whose multipliers reach zero on the way.
    fn add(
        &mut self,
        programme: &Programme<'_>,
        constraint: Constraint,
        x: &mut [f64],
        changes: &mut usize,
    ) -> Result<(), NoMinimum> {
        let n = self.n;
        // As n ᵀx ≥ c.
        self.normal.fill(0.0);
        match constraint {
            Constraint::Lower(i) => self.normal[i] = 1.0,
            Constraint::Upper(i) => self.normal[i] = -1.0,
            Constraint::Row(k) => {
                for (normal, a) in self.normal.iter_mut().zip(&programme.rows[k * n..(k + 1) * n]) {
                    *normal = -a;
                }
            }
        }
        let mut multiplier = 0.0;
        loop {
            *changes = changes.checked_sub(1).ok_or(NoMinimum::Rounding)?;
            self.directions();
            // The step after which a multiplier of the active set would be negative.
            let mut dual = (f64::INFINITY, 0);
            for (k, (&u, &r)) in self.multipliers.iter().zip(&self.dual_direction).enumerate() {
                if r > 0.0 && u / r < dual.0 {
                    dual = (u / r, k);
                }
            }
            let q = self.active.len();
            let free: f64 = self.projected[q..].iter().map(|d| d * d).sum();
            let whole: f64 = self.projected.iter().map(|d| d * d).sum();
            let is_dependent = free <= (64.0 * f64::EPSILON).powi(2) * whole;
            let slack = programme.slack(constraint, x);
            let primal = if is_dependent { f64::INFINITY } else { -slack / free };
            let step = dual.0.min(primal);
            if step == f64::INFINITY {
                return Err(NoMinimum::Infeasible);
            }
            for (u, r) in self.multipliers.iter_mut().zip(&self.dual_direction) {
                *u = (*u - step * r).max(0.0);
            }
            multiplier += step;
            if !is_dependent {
                for (x, z) in x.iter_mut().zip(&self.direction) {
                    *x += step * z;
                }
            }
            if primal <= dual.0 {
                self.append(constraint, multiplier);
                return Ok(());
            }
            self.drop_active(dual.1);
        }
    }

    /// `d = Jᵀ n`, `z = J₂ d₂` and `R r = d₁`.
    fn directions(&mut self) {
        let (n, q) = (self.n, self.active.len());
        for j in 0..n {
            self.projected[j] = (0..n).map(|i| self.basis[i * n + j] * self.normal[i]).sum();
        }
        for i in 0..n {
            self.direction[i] = (q..n).map(|j| self.basis[i * n + j] * self.projected[j]).sum();
        }
        self.dual_direction.clear();
        self.dual_direction.extend_from_slice(&self.projected[..q]);
        for i in (0..q).rev() {
            let after: f64 =
                (i + 1..q).map(|k| self.triangle[i * n + k] * self.dual_direction[k]).sum();
            self.dual_direction[i] = (self.dual_direction[i] - after) / self.triangle[i * n + i];
        }
    }

    /// Rotates columns `i` and `i + 1` of `J`.
    fn rotate_basis(&mut self, i: usize, cosine: f64, sine: f64) {
        let n = self.n;
        for row in self.basis.chunks_exact_mut(n) {
            let (a, b) = (row[i], row[i + 1]);
            row[i] = cosine * a + sine * b;
            row[i + 1] = cosine * b - sine * a;
        }
    }

    fn append(&mut self, constraint: Constraint, multiplier: f64) {
        let (n, q) = (self.n, self.active.len());
        for i in (q..n - 1).rev() {
            let (a, b) = (self.projected[i], self.projected[i + 1]);
            let size = a.hypot(b);
            if b != 0.0 {
                self.rotate_basis(i, a / size, b / size);
                self.projected[i] = size;
                self.projected[i + 1] = 0.0;
            }
        }
        for i in 0..=q {
            self.triangle[i * n + q] = self.projected[i];
        }
        self.active.push(constraint);
        self.multipliers.push(multiplier);
    }

    fn drop_active(&mut self, dropped: usize) {
        let n = self.n;
        self.active.remove(dropped);
        self.multipliers.remove(dropped);
        let q = self.active.len();
        for column in dropped..q {
            for i in 0..=column + 1 {
                self.triangle[i * n + column] = self.triangle[i * n + column + 1];
            }
        }
        for i in dropped..q {
            let (a, b) = (self.triangle[i * n + i], self.triangle[(i + 1) * n + i]);
            let size = a.hypot(b);
            if b == 0.0 {
                continue;
            }
            let (cosine, sine) = (a / size, b / size);
            for column in i..q {
                let (a, b) = (self.triangle[i * n + column], self.triangle[(i + 1) * n + column]);
                self.triangle[i * n + column] = cosine * a + sine * b;
                self.triangle[(i + 1) * n + column] = cosine * b - sine * a;
            }
            self.rotate_basis(i, cosine, sine);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    /// A deterministic sequence in −1 … 1.
    fn numbers() -> impl Iterator<Item = f64> {
        (1_u32..).map(|k| 2.0 * (f64::from(k) * 0.618_033_988_749_895).fract() - 1.0)
    }

    /// The conditions of Karush, Kuhn and Tucker tell the minimiser, however it was found.
    #[test]
    fn meets_the_optimality_conditions() {
        let mut solver = QuadraticProgramme::default();
        let mut x = Vec::new();
        let mut next = numbers();
        let (mut feasible, mut active) = (0, 0);
        for n in 1..9 {
            for count in [0, 1, 3, 12] {
                for _ in 0..40 {
                    let factor: Vec<f64> = next.by_ref().take(n * n).collect();
                    let mut matrix = vec![0.0; n * n];
                    for i in 0..n {
                        for j in 0..n {
                            matrix[i * n + j] =
                                (0..n).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
                        }
                        matrix[i * n + i] += 0.01;
                    }
                    let gradient: Vec<f64> = next.by_ref().take(n).collect();
                    let lower: Vec<f64> = next.by_ref().take(n).map(|x| x - 0.8).collect();
                    let upper: Vec<f64> =
                        lower.iter().zip(next.by_ref()).map(|(l, x)| l + x.abs()).collect();
                    let rows: Vec<f64> = next.by_ref().take(count * n).collect();
                    let limits: Vec<f64> = next.by_ref().take(count).collect();
                    let programme = Programme {
                        matrix: &matrix,
                        gradient: &gradient,
                        lower: &lower,
                        upper: &upper,
                        rows: &rows,
                        limits: &limits,
                    };
                    match solver.minimise(&programme, &mut x) {
                        Err(error) => assert_eq!(error, NoMinimum::Infeasible),
                        Ok(()) => {
                            feasible += 1;
                            for constraint in programme.constraints() {
                                assert!(programme.slack(constraint, &x) > -1e-12);
                            }
                            let mut slope: Vec<f64> = (0..n)
                                .map(|i| {
                                    let row = &matrix[i * n..(i + 1) * n];
                                    gradient[i]
                                        + row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>()
                                })
                                .collect();
                            for (constraint, multiplier) in solver.active() {
                                active += 1;
                                assert!(multiplier >= 0.0);
                                assert!(programme.slack(constraint, &x).abs() < 1e-12);
                                match constraint {
                                    Constraint::Lower(i) => slope[i] -= multiplier,
                                    Constraint::Upper(i) => slope[i] += multiplier,
                                    Constraint::Row(k) => {
                                        for i in 0..n {
                                            slope[i] += multiplier * rows[k * n + i];
                                        }
                                    }
                                }
                            }
                            let largest = slope.iter().map(|s| s.abs()).fold(0.0, f64::max);
                            assert!(largest < 1e-9, "{n} unknowns, {count} rows: {largest}");
                        }
                    }
                }
            }
        }
        assert!(feasible > 500 && active > 1500, "{feasible} {active}");
    }

    #[test]
    fn says_that_constraints_contradict() {
        let programme = Programme {
            matrix: &[1.0, 0.0, 0.0, 1.0],
            gradient: &[0.0, 0.0],
            lower: &[0.0, 0.0],
            upper: &[1.0, 1.0],
            rows: &[-1.0, -1.0],
            limits: &[-2.5],
        };
        let mut solver = QuadraticProgramme::default();
        let answer = solver.minimise(&programme, &mut Vec::new());
        assert_eq!(answer, Err(NoMinimum::Infeasible));
    }

    #[test]
    fn refuses_a_matrix_without_a_minimum() {
        let programme = Programme {
            matrix: &[1.0, 2.0, 2.0, 1.0],
            gradient: &[0.0, 1.0],
            lower: &[0.0, 0.0],
            upper: &[1.0, 1.0],
            rows: &[],
            limits: &[],
        };
        let answer = QuadraticProgramme::default().minimise(&programme, &mut Vec::new());
        assert_eq!(answer, Err(NoMinimum::NotPositiveDefinite));
    }
}
