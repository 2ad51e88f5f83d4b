//! Small convex quadratic problems with lower bounds.

use crate::dense::{DenseLu, Singular};

/// Minimises `½ dᵀA d + gᵀd` over `d ≥ l` by active sets, for a positive definite `A` and `l ≤ 0`.
///
/// It starts from `d = 0` and never climbs, so that whatever it ends with, also after rounding keeps
/// it from the last exchange, is a direction of descent.
///
/// [`QuadraticProgramme`](crate::QuadraticProgramme) is for programmes with upper bounds and rows, and does not take its place: it refuses matrices that are
/// singular to rounding, as those of cables that pull against one another are, of which this one still takes those whose free block is not,
/// and before its end it has no point within the bounds. Three unknowns take this one 0.1 µs and the other 0.7 µs, because without a bound in the way
/// one system is solved; nine unknowns of which half end at their bounds take 9 µs and 4 µs.
#[derive(Clone, Debug, Default)]
pub struct BoundedQuadratic {
    /// Not at their bounds.
    free: Vec<usize>,
    matrix: Vec<f64>,
    target: Vec<f64>,
    lu: DenseLu,
}

/// Exchanges after which rounding must be what keeps it going, for each unknown.
const EXCHANGES: usize = 20;

impl BoundedQuadratic {
    /// Writes the minimiser into `minimiser`; `matrix` holds the rows of `A`, `gradient` `g` and
    /// `least` `l`.
    ///
    /// # Errors
    ///
    /// [`Singular`] when a block of `A` cannot be factored.
    pub fn minimise(
        &mut self,
        matrix: &[f64],
        gradient: &[f64],
        least: &[f64],
        minimiser: &mut Vec<f64>,
    ) -> Result<(), Singular> {
        let n = gradient.len();
        minimiser.clear();
        minimiser.resize(n, 0.0);
        self.free.clear();
        self.free.extend((0..n).filter(|&i| least[i] < 0.0));
        for _ in 0..EXCHANGES * n {
            self.solve_free(matrix, gradient, least)?;
            if let Some((place, fraction)) = self.first_bound(least, minimiser) {
                for (&i, target) in self.free.iter().zip(&self.target) {
                    minimiser[i] += fraction * (target - minimiser[i]);
                }
                let bound = self.free.remove(place);
                minimiser[bound] = least[bound];
                continue;
            }
            for (&i, &target) in self.free.iter().zip(&self.target) {
                minimiser[i] = target;
            }
            let slope = |i: usize| {
                let row = &matrix[i * n..(i + 1) * n];
                gradient[i] + row.iter().zip(&*minimiser).map(|(a, d)| a * d).sum::<f64>()
            };
            let bound = (0..n).filter(|i| !self.free.contains(i));
            let steepest = bound.map(|i| (i, slope(i))).min_by(|a, b| a.1.total_cmp(&b.1));
            match steepest {
                Some((i, slope)) if slope < 0.0 => self.free.push(i),
                _ => break,
            }
        }
        Ok(())
    }

    /// The minimum over the free unknowns, without their bounds.
    fn solve_free(
        &mut self,
        matrix: &[f64],
        gradient: &[f64],
        least: &[f64],
    ) -> Result<(), Singular> {
        let n = gradient.len();
        let Self { free, matrix: block, target, lu } = self;
        block.clear();
        target.clear();
        for &i in &*free {
            let row = &matrix[i * n..(i + 1) * n];
            block.extend(free.iter().map(|&j| row[j]));
            let bound = (0..n).filter(|j| !free.contains(j));
            target.push(-gradient[i] - bound.map(|j| row[j] * least[j]).sum::<f64>());
        }
        if !free.is_empty() {
            lu.factor(free.len(), block)?;
            lu.solve(target);
        }
        Ok(())
    }

    /// Which free unknown meets its bound first on the way to the target, and where on the way.
    fn first_bound(&self, least: &[f64], from: &[f64]) -> Option<(usize, f64)> {
        let meets = |(place, (&i, &target)): (usize, (&usize, &f64))| {
            let fraction = (from[i] - least[i]) / (from[i] - target);
            (target < least[i]).then_some((place, fraction.clamp(0.0, 1.0)))
        };
        let ways = self.free.iter().zip(&self.target).enumerate().filter_map(meets);
        ways.min_by(|a, b| a.1.total_cmp(&b.1))
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
        let mut memory = BoundedQuadratic::default();
        let mut d = Vec::new();
        let mut next = numbers();
        for n in 1..9 {
            for _ in 0..50 {
                let factor: Vec<f64> = next.by_ref().take(n * n).collect();
                let entry = |i: usize, j: usize| {
                    let own = if i == j { 0.01 } else { 0.0 };
                    own + (0..n).map(|k| factor[i * n + k] * factor[j * n + k]).sum::<f64>()
                };
                let a: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
                let g: Vec<f64> = next.by_ref().take(n).collect();
                // Some unknowns start at their bounds.
                let l: Vec<f64> = next.by_ref().take(n).map(|x| x.min(0.0)).collect();
                memory.minimise(&a, &g, &l, &mut d).unwrap();
                for i in 0..n {
                    let slope = g[i] + (0..n).map(|j| a[i * n + j] * d[j]).sum::<f64>();
                    assert!(d[i] >= l[i]);
                    assert!(slope > -1e-11, "{slope}");
                    assert!(d[i] == l[i] || slope < 1e-11, "{slope}");
                }
            }
        }
    }
}
