//! Cables that are held at their lengths.
//!
//! With `D = ∂ℓ/∂τ` at constant tensions and `cᵢ` what a tension of 1 N adds to the length of an
//! elastic cable, the tensions of the held cables follow what changes their lengths by
//!
//! ```text
//! (D − diag c) δτ = δℓ* − δℓ|τ                                                        (d4)
//! ```
//!
//! Where more cables are taut than lengths are independent, as with four straight cables, `D` is
//! singular. Iterations take the least change of tensions by iterated regularisation, which
//! leaves nothing to choose between what is small and what is zero. For derivatives the singular values `σ` of `D − diag c` decide
//! ([`HeldCables::settle`]): with its singular vectors `uₖ` and `vₖ`
//!
//! ```text
//! δτ = Σ vₖ (uₖ·δ)/σₖ   over σₖ > ε σ₀                                                  (d10)
//! ```
//!
//! Changes of lengths that contradict each other, such as that of one of two antagonists on a backbone that keeps its length, count by
//! the part that does not: that is the limit of cables which all stretch by the same `c` under 1 N, for `c → 0`, but for the tension
//! `1/c` by which the antagonists pull against each other.

use whipcord_numerics::{DenseLu, SingularValues, dot};

/// What is held while something else changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// What the case gives: the tension of each cable driven by it, the length of the others.
    Commands,
    /// The tension of every cable: motors that control forces, or hung weights.
    Tensions,
    /// The length of every taut cable, as long as its end outside the robot is locked; a cable of
    /// given axial stiffness stretches. A cable without tension stays slack.
    Lengths,
}

/// Why there are no derivatives: a small load changes the answer without bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Critical;

/// The cables that are held, in the two ways they can be.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldCables {
    cables: usize,
    /// Those of given length that are taut.
    driven: Set,
    /// All that are taut.
    taut: Set,
}

#[derive(Clone, Debug, Default)]
struct Set {
    members: Vec<usize>,
    /// Of `D − diag c` of the members.
    system: LeastSystem,
}

/// Memory of [`HeldCables::commanded_into`].
#[derive(Clone, Debug, Default)]
pub(crate) struct HoldScratch {
    right: Vec<f64>,
    of_members: Vec<f64>,
    solution: Vec<f64>,
    rest: Vec<f64>,
}

/// A linear system that may be singular, and its transpose: their least solutions.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastSystem {
    /// By rows.
    matrix: Vec<f64>,
    transposed: Vec<f64>,
    /// Made regular.
    regular: Vec<f64>,
    lu: DenseLu,
    transposed_lu: DenseLu,
    /// Where it is all but singular, for derivatives: `vₖ` and `uₖ/σₖ` of eq. (d10), one after the other.
    modes: Vec<[Vec<f64>; 2]>,
    is_settled: bool,
    is_dependent: bool,
}

/// A system whose pivots are all greater than this part of its entries is solved by iterated regularisation.
const HARDLY_SINGULAR: f64 = 1e-4;
/// Singular values below this part of the greatest count as zero: rounding leaves about 10⁻¹⁴ of it.
const DEPENDENT: f64 = 1e-9;

/// Of the greatest entry of the diagonal.
pub(crate) const REGULARISATION: f64 = 1e-8;
/// Each takes the error of what is not singular down by the regularisation over its eigenvalue.
const CORRECTIONS: usize = 4;

impl HeldCables {
    /// From `D` and `c`, and which cables are taut and driven by their lengths.
    pub fn new(
        cables: usize,
        length_by_tension: impl Fn(usize, usize) -> f64,
        compliance: impl Fn(usize) -> f64,
        taut: impl Fn(usize) -> bool,
        driven: impl Fn(usize) -> bool,
    ) -> Result<Self, Critical> {
        let mut held = Self::default();
        held.renew(cables, length_by_tension, compliance, taut, driven)?;
        Ok(held)
    }

    /// [`Self::new`] in the memory of others.
    pub fn renew(
        &mut self,
        cables: usize,
        length_by_tension: impl Fn(usize, usize) -> f64,
        compliance: impl Fn(usize) -> f64,
        taut: impl Fn(usize) -> bool,
        driven: impl Fn(usize) -> bool,
    ) -> Result<(), Critical> {
        let entry = |i: usize, j: usize| {
            let own = if i == j { compliance(i) } else { 0.0 };
            length_by_tension(i, j) - own
        };
        self.cables = cables;
        self.driven.renew((0..cables).filter(|&i| taut(i) && driven(i)), entry)?;
        self.taut.renew((0..cables).filter(|&i| taut(i)), entry)
    }

    /// Takes the cables as those of an answer whose derivatives are asked for, eq. (d10), where so much length with a tension, in m/N, is
    /// none to speak of: that of the robot without what holds it besides.
    pub fn settle(&mut self, scale: f64) {
        for set in [&mut self.driven, &mut self.taut] {
            set.system.settle(set.members.len(), scale);
        }
    }

    /// The same, where nothing else than the commands is asked for: no memory is taken where they are tensions.
    pub fn settle_driven(&mut self) {
        self.driven.system.settle(self.driven.members.len(), 0.0);
    }

    /// Whether the lengths that are held depend on each other, so that the tensions are not determined.
    pub fn are_dependent(&self, hold: Hold) -> bool {
        self.set(hold).is_some_and(|set| set.system.is_dependent)
    }

    fn set(&self, hold: Hold) -> Option<&Set> {
        match hold {
            Hold::Commands => Some(&self.driven),
            Hold::Tensions => None,
            Hold::Lengths => Some(&self.taut),
        }
    }

    /// The change of every tension that lengthens the held cables by `right`.
    pub fn tensions(&self, hold: Hold, right: &[f64]) -> Vec<f64> {
        self.solve(hold, right, LeastSystem::solve)
    }

    /// What a command changes of every tension: that of a cable, which is its tension or what it is shortened by, from the changes of
    /// all lengths with its tension.
    pub fn commanded(
        &self,
        hold: Hold,
        cable: usize,
        is_tension: bool,
        length_by_tension: &[f64],
    ) -> Vec<f64> {
        let mut tensions = Vec::new();
        let of_command = (cable, is_tension, length_by_tension);
        self.commanded_into(hold, of_command, &mut HoldScratch::default(), &mut tensions);
        tensions
    }

    /// [`Self::commanded`], of cable, kind of its command and changes of lengths, in memory that is kept.
    pub fn commanded_into(
        &self,
        hold: Hold,
        (cable, is_tension, length_by_tension): (usize, bool, &[f64]),
        scratch: &mut HoldScratch,
        tensions: &mut Vec<f64>,
    ) {
        let HoldScratch { right, of_members, solution, rest } = scratch;
        right.clear();
        right.resize(self.cables, 0.0);
        if is_tension {
            right.iter_mut().zip(length_by_tension).for_each(|(right, by)| *right = -by);
        } else {
            right[cable] = -1.0;
        }
        tensions.clear();
        tensions.resize(self.cables, 0.0);
        if let Some(set) = self.set(hold)
            && !set.members.is_empty()
        {
            of_members.clear();
            of_members.extend(set.members.iter().map(|&i| right[i]));
            set.system.solve_into(of_members, solution, rest);
            for (&i, x) in set.members.iter().zip(&*solution) {
                tensions[i] = *x;
            }
        }
        if is_tension {
            tensions[cable] += 1.0;
        }
    }

    /// The transpose of [`Self::tensions`].
    pub fn pull_back(&self, hold: Hold, worth: &[f64]) -> Vec<f64> {
        self.solve(hold, worth, LeastSystem::solve_transposed)
    }

    fn solve(
        &self,
        hold: Hold,
        right: &[f64],
        solve: impl Fn(&LeastSystem, &[f64]) -> Vec<f64>,
    ) -> Vec<f64> {
        let mut out = vec![0.0; self.cables];
        if let Some(set) = self.set(hold)
            && !set.members.is_empty()
        {
            let right: Vec<f64> = set.members.iter().map(|&i| right[i]).collect();
            for (&i, x) in set.members.iter().zip(solve(&set.system, &right)) {
                out[i] = x;
            }
        }
        out
    }
}

impl Set {
    fn renew(
        &mut self,
        members: impl Iterator<Item = usize>,
        entry: impl Fn(usize, usize) -> f64,
    ) -> Result<(), Critical> {
        let Self { members: own, system } = self;
        own.clear();
        own.extend(members);
        let n = own.len();
        system.matrix.clear();
        system.matrix.extend((0..n * n).map(|k| entry(own[k / n], own[k % n])));
        let greatest = (0..n).map(|i| system.matrix[i * n + i].abs()).fold(0.0, f64::max);
        system.factor(n, |_| -REGULARISATION * greatest)
    }
}

impl LeastSystem {
    /// Of a matrix by rows, to whose diagonal `regular` adds what makes it regular.
    pub fn new(
        n: usize,
        matrix: Vec<f64>,
        regular: impl Fn(usize) -> f64,
    ) -> Result<Self, Critical> {
        let mut system = Self { matrix, ..Self::default() };
        system.factor(n, regular)?;
        Ok(system)
    }

    fn factor(&mut self, n: usize, regular: impl Fn(usize) -> f64) -> Result<(), Critical> {
        (self.is_settled, self.is_dependent) = (false, false);
        let Self { matrix, transposed, regular: with, lu, transposed_lu, .. } = self;
        transposed.clear();
        transposed.extend((0..n * n).map(|k| matrix[(k % n) * n + k / n]));
        for (matrix, lu) in [(&*matrix, lu), (&*transposed, transposed_lu)] {
            with.clone_from(matrix);
            for i in 0..n {
                with[i * n + i] += regular(i);
            }
            lu.factor(n, with).map_err(|_| Critical)?;
        }
        Ok(())
    }

    /// Finds the singular values of a system of so many unknowns that is all but singular beside its entries and this scale.
    fn settle(&mut self, n: usize, scale: f64) {
        let Self { matrix, lu, modes, is_settled, is_dependent, .. } = self;
        let greatest = (0..n).map(|i| matrix[i * n + i].abs()).fold(scale, f64::max);
        if n == 0 || lu.least_pivot() > HARDLY_SINGULAR * greatest {
            return;
        }
        let singular = SingularValues::of(n, matrix);
        let least = DEPENDENT * singular.values[0].max(scale);
        modes.clear();
        for (k, &value) in singular.values.iter().enumerate().filter(|(_, value)| **value > least) {
            let direction = singular.direction(k);
            let image = matrix.chunks_exact(n).map(|row| dot(row, direction) / (value * value));
            modes.push([direction.to_vec(), image.collect()]);
        }
        (*is_settled, *is_dependent) = (true, modes.len() < n);
    }

    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = Vec::new();
        self.solve_into(right, &mut x, &mut Vec::new());
        x
    }

    /// [`Self::solve`] in memory that is kept.
    fn solve_into(&self, right: &[f64], x: &mut Vec<f64>, rest: &mut Vec<f64>) {
        match self.is_settled {
            true => self.by_modes(right, x, |[direction, image]| (direction, image)),
            false => least((&self.transposed, &self.lu), right, x, rest),
        }
    }

    pub fn solve_transposed(&self, right: &[f64]) -> Vec<f64> {
        let mut x = Vec::new();
        match self.is_settled {
            true => self.by_modes(right, &mut x, |[direction, image]| (image, direction)),
            false => least((&self.matrix, &self.transposed_lu), right, &mut x, &mut Vec::new()),
        }
        x
    }

    fn by_modes<'a>(
        &'a self,
        right: &[f64],
        x: &mut Vec<f64>,
        of: impl Fn(&'a [Vec<f64>; 2]) -> (&'a Vec<f64>, &'a Vec<f64>),
    ) {
        x.clear();
        x.resize(right.len(), 0.0);
        for (into, by) in self.modes.iter().map(of) {
            let part = dot(by, right);
            x.iter_mut().zip(into).for_each(|(x, into)| *x += part * into);
        }
    }
}

/// The least solution of a system whose matrix, given by columns, may be singular, by iterated regularisation.
fn least((columns, lu): (&[f64], &DenseLu), right: &[f64], x: &mut Vec<f64>, rest: &mut Vec<f64>) {
    let n = right.len();
    x.clear();
    x.resize(n, 0.0);
    for correction in 0..CORRECTIONS {
        rest.clear();
        rest.extend_from_slice(right);
        if correction > 0 {
            for (column, x) in columns.chunks_exact(n.max(1)).zip(&*x) {
                rest.iter_mut().zip(column).for_each(|(left, by)| *left -= by * x);
            }
        }
        lu.solve(rest);
        for (x, change) in x.iter_mut().zip(&*rest) {
            *x += change;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two antagonists whose lengths depend on each other to this.
    fn antagonists(apart: f64, scale: f64) -> HeldCables {
        let entry = |i: usize, j: usize| match i == j {
            true => -2.0 * scale * (1.0 + apart),
            false => 2.0 * scale,
        };
        let mut held = HeldCables::new(2, entry, |_| 0.0, |_| true, |_| true).unwrap();
        held.settle(scale);
        held
    }

    fn assert_near(found: &[f64], expected: [f64; 2], tolerance: f64) {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= tolerance, "{found:e} {expected:e}");
        }
    }

    #[test]
    fn lengths_that_contradict_each_other_count_by_what_does_not() {
        let held = antagonists(0.0, 1e-3);
        assert!(held.are_dependent(Hold::Lengths) && !held.are_dependent(Hold::Tensions));
        // Half of it lengthens the one and shortens the other.
        assert_near(&held.tensions(Hold::Lengths, &[1.0, 0.0]), [-125.0, 125.0], 1e-10);
        assert_near(&held.tensions(Hold::Lengths, &[1.0, 1.0]), [0.0, 0.0], 1e-10);
        assert_near(&held.commanded(Hold::Commands, 0, false, &[]), [125.0, -125.0], 1e-10);
        assert_near(&held.pull_back(Hold::Lengths, &[1.0, -1.0]), [-250.0, 250.0], 1e-10);
    }

    #[test]
    fn lengths_that_nearly_depend_on_each_other_are_solved_for() {
        let held = antagonists(1e-7, 1e-3);
        assert!(!held.are_dependent(Hold::Lengths));
        // The determinant is 4e-6 · (2e-7 + 1e-14).
        let most = -2e-3 / (4e-6 * (2e-7 + 1e-14));
        assert_near(&held.tensions(Hold::Lengths, &[1.0, 0.0]), [most, most], 1e-5 * most.abs());
    }

    #[test]
    fn what_else_holds_the_robot_leaves_rounding() {
        let mut held = antagonists(0.3, 1e-18);
        assert!(!held.are_dependent(Hold::Lengths));
        held.settle(1e-3);
        assert!(held.are_dependent(Hold::Lengths));
        assert_near(&held.tensions(Hold::Lengths, &[1.0, 0.5]), [0.0; 2], 0.0);
    }
}
