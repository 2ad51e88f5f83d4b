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
//! singular: the least change of tensions is taken. It is found by iterated regularisation, which
//! leaves nothing to choose between what is small and what is zero.

use whipcord_numerics::DenseLu;

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
}

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
            least((&set.system.transposed, &set.system.lu), of_members, solution, rest);
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
        let Self { matrix, transposed, regular: with, lu, transposed_lu } = self;
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

    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        solved((&self.transposed, &self.lu), right)
    }

    pub fn solve_transposed(&self, right: &[f64]) -> Vec<f64> {
        solved((&self.matrix, &self.transposed_lu), right)
    }
}

fn solved(system: (&[f64], &DenseLu), right: &[f64]) -> Vec<f64> {
    let mut x = Vec::new();
    least(system, right, &mut x, &mut Vec::new());
    x
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
