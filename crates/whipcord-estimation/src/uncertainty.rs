//! How sure estimates are.

use whipcord_numerics::SingularValues;

/// The covariance of estimates, eq. (i6), and the directions in which they are not told apart.
pub(crate) struct Spread {
    /// Standard deviation of each; none where the measurements say nothing of it, and where it is held at a
    /// bound.
    pub(crate) deviations: Vec<Option<f64>>,
    /// By rows.
    pub(crate) correlations: Vec<Vec<Option<f64>>>,
    /// In these directions, with the columns of the Jacobian at equal size, little or nothing changes.
    pub(crate) weak: Vec<Weak>,
}

/// A direction in which little or nothing of what was seen changes.
pub(crate) struct Weak {
    /// Change of each unknown, in its unit, to any scale.
    pub(crate) direction: Vec<f64>,
    /// By how much less sure the unknowns are than each would be alone; none where nothing is seen of them.
    pub(crate) collinearity: Option<f64>,
}

/// Collinearity beyond which it is said: 10 to 15 has been found to be much (Brun, Reichert and Künsch, Water
/// Resources Research 37 (2001) 1015).
const MUCH: f64 = 20.0;
/// Singular values below this are those of columns that depend on one another, as far as rounding leaves
/// it to be seen in exact derivatives and in differences.
const UNSEEN: [f64; 2] = [1e-8, 1e-6];
/// A component of a direction below this is rounding.
const PART: f64 = 1e-3;

impl Spread {
    /// Of the Jacobian by rows, where the covariance of what it was weighed to is `spread` times the unit
    /// matrix. Unknowns that are not `free` are held.
    pub(crate) fn of(jacobian: &[f64], free: &[bool], spread: f64, by_differences: bool) -> Self {
        let n = free.len();
        let norms: Vec<f64> = (0..n)
            .map(|j| jacobian.iter().skip(j).step_by(n).map(|x| x * x).sum::<f64>().sqrt())
            .collect();
        let kept: Vec<usize> = (0..n).filter(|&j| free[j] && norms[j] > 0.0).collect();
        let scaled: Vec<f64> = jacobian
            .chunks_exact(n)
            .flat_map(|row| kept.iter().map(|&j| row[j] / norms[j]))
            .collect();
        let seen = SingularValues::of(kept.len(), &scaled);
        let unseen = UNSEEN[usize::from(by_differences)];
        let mut weak: Vec<Weak> = (0..n)
            .filter(|&j| free[j] && norms[j] == 0.0)
            .map(|j| Weak {
                direction: (0..n).map(|i| f64::from(u8::from(i == j))).collect(),
                collinearity: None,
            })
            .collect();
        let mut unknown = vec![false; kept.len()];
        let mut covariance = vec![0.0; kept.len() * kept.len()];
        for (k, &value) in seen.values.iter().enumerate() {
            let direction = seen.direction(k);
            if value <= unseen {
                for (unknown, part) in unknown.iter_mut().zip(direction) {
                    *unknown |= part.abs() > PART;
                }
            } else {
                for (i, entry) in covariance.iter_mut().enumerate() {
                    let (a, b) = (direction[i / kept.len()], direction[i % kept.len()]);
                    *entry += spread * (a / value) * (b / value);
                }
            }
            if value <= unseen || value * MUCH < 1.0 {
                let mut full = vec![0.0; n];
                for (&j, part) in kept.iter().zip(direction) {
                    full[j] = part / norms[j];
                }
                let collinearity = (value > unseen).then(|| 1.0 / value);
                weak.push(Weak { direction: full, collinearity });
            }
        }
        let at = |i: usize, j: usize| covariance[i * kept.len() + j];
        let mut deviations = vec![None; n];
        let mut correlations = vec![vec![None; n]; n];
        for (a, &i) in kept.iter().enumerate().filter(|(a, _)| !unknown[*a]) {
            deviations[i] = Some(at(a, a).sqrt() / norms[i]);
            for (b, &j) in kept.iter().enumerate().filter(|(b, _)| !unknown[*b]) {
                let size = (at(a, a) * at(b, b)).sqrt();
                correlations[i][j] = match (i == j, size > 0.0) {
                    (true, _) => Some(1.0),
                    (false, true) => Some((at(a, b) / size).clamp(-1.0, 1.0)),
                    (false, false) => None,
                };
            }
        }
        Self { deviations, correlations, weak }
    }

    /// By rows; zero where the measurements say nothing of an unknown. Of an exact fit there are no correlations.
    pub(crate) fn covariance(&self) -> Vec<Vec<f64>> {
        let deviation = |i: usize| self.deviations[i].unwrap_or(0.0);
        let rows = self.correlations.iter().enumerate();
        rows.map(|(i, row)| {
            let row = row.iter().enumerate();
            row.map(|(j, of)| deviation(i) * deviation(j) * of.unwrap_or(0.0)).collect()
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_straight_lines() {
        // y = a + b x at 0, 1, 2, 3: the covariance is (XᵀX)⁻¹ = [[14, −6], [−6, 4]]/20.
        let jacobian = [1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0];
        let spread = Spread::of(&jacobian, &[true, true], 4.0, false);
        let deviation = |j: usize| spread.deviations[j].unwrap();
        assert!((deviation(0) - (4.0f64 * 14.0 / 20.0).sqrt()).abs() < 1e-14);
        assert!((deviation(1) - (4.0f64 * 4.0 / 20.0).sqrt()).abs() < 1e-14);
        assert!((spread.correlations[0][1].unwrap() + 6.0 / 56f64.sqrt()).abs() < 1e-14);
        assert!(spread.weak.is_empty());
        // With the slope held the offset is the mean of four.
        let held = Spread::of(&jacobian, &[true, false], 4.0, false);
        assert!((held.deviations[0].unwrap() - 1.0).abs() < 1e-14);
        assert_eq!(held.deviations[1], None);
    }

    #[test]
    fn directions_that_are_not_seen() {
        // The first two are seen by 2a + b, the third not at all, the fourth by itself.
        let jacobian = [2.0, 1.0, 0.0, 0.0, 4.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0];
        let spread = Spread::of(&jacobian, &[true; 4], 9.0, false);
        assert_eq!(spread.deviations[..3], [None, None, None]);
        assert!((spread.deviations[3].unwrap() - 1.0).abs() < 1e-14);
        assert_eq!(spread.weak.len(), 2);
        assert_eq!(spread.weak[0].direction, [0.0, 0.0, 1.0, 0.0]);
        let mixed = &spread.weak[1].direction;
        assert!((2.0 * mixed[0] + mixed[1]).abs() < 1e-14 && mixed[0].abs() > 0.1);
        assert!(spread.weak.iter().all(|weak| weak.collinearity.is_none()));
    }
}
