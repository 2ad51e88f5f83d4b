//! Which cables at their lengths without tension constrain the rod: those that a state of self-stress pulls.

use whipcord_numerics::BoundedQuadratic;

/// Of the backbone's length: a cable without tension that is no looser than this is at its length.
const IDLE: f64 = 1e-6;
/// An idle cable is held where the others leave no more than this part of the square of its effect.
const IMPLIED: f64 = 1e-6;
/// A taut cable may take this much less tension in a state of self-stress, each in units of its effect.
const RELEASED: f64 = -1e6;

/// Whether a cable without tension, this slack in m, is at its length; a cable that stretches gives way.
pub(crate) fn is_idle(compliance: f64, slack: f64, length: f64) -> bool {
    compliance == 0.0 && slack <= IDLE * length
}

/// Which cables are held at their lengths, and memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfStress {
    held: Vec<bool>,
    others: Vec<usize>,
    stress: Vec<f64>,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    least: Vec<f64>,
    quadratic: BoundedQuadratic,
}

impl SelfStress {
    /// Which cables are held at their lengths: those that are not idle, and the idle ones of which some state of
    /// self-stress, with tension in idle cables only and of either sign in the others, has tension. `schur` is the Schur
    /// complement of the locked cables where the form is positive: minus the products of their effects.
    pub fn held(&mut self, schur: &[f64], idle: impl Iterator<Item = bool> + Clone) -> &[bool] {
        self.held.clear();
        let is_idle = idle.clone();
        for (i, own) in idle.enumerate() {
            let held = !own || self.is_implied(schur, i, is_idle.clone());
            self.held.push(held);
        }
        &self.held
    }

    fn is_implied(
        &mut self,
        schur: &[f64],
        i: usize,
        idle: impl Iterator<Item = bool> + Clone,
    ) -> bool {
        let Self { others, stress, matrix, gradient, least, quadratic, .. } = self;
        let p = idle.clone().count();
        let size = |i: usize| (-schur[i * p + i]).max(f64::MIN_POSITIVE).sqrt();
        let product = |i: usize, j: usize| -schur[i * p + j] / (size(i) * size(j));
        others.clear();
        others.extend((0..p).filter(|&j| j != i));
        matrix.clear();
        for &j in &*others {
            let ridge = |k: usize| if j == k { 1e-3 * IMPLIED } else { 0.0 };
            matrix.extend(others.iter().map(|&k| product(j, k) + ridge(k)));
        }
        gradient.clear();
        gradient.extend(others.iter().map(|&j| product(i, j)));
        least.clear();
        let of_others = idle.enumerate().filter(|&(j, _)| j != i);
        least.extend(of_others.map(|(_, idle)| if idle { 0.0 } else { RELEASED }));
        if quadratic.minimise(matrix, gradient, least, stress).is_err() {
            return false;
        }
        let mut left = product(i, i);
        for (&j, &a) in others.iter().zip(&*stress) {
            left += 2.0 * a * product(i, j);
            for (&k, &b) in others.iter().zip(&*stress) {
                left += a * b * product(j, k);
            }
        }
        left <= IMPLIED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four cables around an axis: bending about two axes and compression leave one state of self-stress, in which
    /// opposite cables pull alike and their neighbours push.
    #[test]
    fn idle_cables_are_held_where_a_state_of_self_stress_pulls_them() {
        let effects = [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]];
        let held = |axial: f64, cables: &[(usize, bool)]| {
            let product = |i: usize, j: usize| {
                let [a, b, c] = effects[i];
                let [d, e, f] = effects[j];
                -(a * d + b * e + axial * c * f)
            };
            let pairs = cables.iter().flat_map(|&(i, _)| cables.iter().map(move |&(j, _)| (i, j)));
            let schur: Vec<f64> = pairs.map(|(i, j)| product(i, j)).collect();
            let idle: Vec<bool> = cables.iter().map(|&(_, idle)| idle).collect();
            SelfStress::default().held(&schur, idle.into_iter()).to_vec()
        };
        let (taut, idle) = (false, true);
        // The backbone stretches: two idle cables are held by two taut ones, but not by neighbours.
        assert_eq!(held(1.0, &[(0, taut), (1, idle), (2, taut), (3, idle)]), [true; 4]);
        assert_eq!(held(1.0, &[(0, taut), (1, idle), (2, taut)]), [true, false, true]);
        assert_eq!(held(1.0, &[(0, idle), (1, idle), (2, idle), (3, idle)]), [false; 4]);
        // It does not: opposite cables hold one another.
        assert_eq!(held(0.0, &[(0, idle), (1, idle), (2, idle), (3, idle)]), [true; 4]);
        assert_eq!(held(0.0, &[(0, idle), (1, idle), (2, idle)]), [true, false, true]);
    }
}
