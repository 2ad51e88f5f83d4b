//! The linear system of multiple shooting, eliminated from the base to the tip.
//!
//! With `η` the rotation of a node, `y` what acts at its cut (the moment, and the followers' force
//! where there is any) and `θ` what all steps share (load factor, tensions), each step gives
//!
//! ```text
//! ηₖ₊₁ = A ηₖ + B yₖ + E θ + gap_η,   yₖ₊₁ = C ηₖ + D yₖ + F θ + gap_y,   η₀ = 0,   yₙ = 0      (10)
//! ```
//!
//! Elimination carries `ηₖ = Pₖ yₖ + Qₖ (θ, 1)`: `Pₖ` is the compliance of the part before node k,
//! bounded as long as no such part buckles under its own load. What is left is how every node
//! answers to `θ`. The product of the determinants of `C Pₖ + D` is that of the boundary value
//! problem.

use whipcord_numerics::{DenseLu, Vec3};

/// Sizes of the system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    /// Components of `y`: 3, or 6 with followers.
    pub cut: usize,
    /// Components of `θ`.
    pub shared: usize,
}

/// Memory of the elimination and the answers it ends with.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    size: Size,
    moment_unit: f64,
    force_unit: f64,
    steps: usize,
    /// `P`, `Q`, the inverse of `C P + D`, and what of the rest drives `y`, of each step in turn.
    kept: Vec<f64>,
    compliance: Vec<f64>,
    turn: Vec<f64>,
    /// `η` and `y` of each node by `(θ, 1)`: rows of `shared + 1`.
    answers: Vec<f64>,
    work: Work,
    lu: DenseLu,
    negative: bool,
}

/// Memory of one step: `C P + D`, what `η` at its end is by `y` and what both are by `(θ, 1)`, the
/// inverse, and a column of it.
#[derive(Clone, Debug, Default)]
struct Work {
    pivot: Vec<f64>,
    first: Vec<f64>,
    rest: Vec<f64>,
    inverse: Vec<f64>,
    unit: Vec<f64>,
}

impl Elimination {
    /// Forgets the steps. Moments and forces are counted in these units.
    pub fn start(&mut self, size: Size, moment_unit: f64, force_unit: f64) {
        (self.size, self.moment_unit, self.force_unit) = (size, moment_unit, force_unit);
        (self.steps, self.negative) = (0, false);
        self.kept.clear();
        self.compliance.clear();
        self.compliance.resize(3 * size.cut, 0.0);
        self.turn.clear();
        self.turn.resize(3 * (size.shared + 1), 0.0);
    }

    fn unit(&self, component: usize) -> f64 {
        match component {
            0..3 => 1.0,
            3..6 => self.moment_unit,
            _ => self.force_unit,
        }
    }

    /// Component of a change: turn, moment, force.
    fn component(&self, change: &Change, i: usize) -> f64 {
        let value = match i {
            0..3 => change.turn[i],
            3..6 => change.moment[i - 3],
            _ => change.force[i - 6],
        };
        value / self.unit(i)
    }

    /// Eliminates one step, given by its columns (by `η`, `y`, `θ`) and its gap; `false` where
    /// that breaks down.
    pub fn push<C: Copy + Into<Change>>(&mut self, columns: &[C], gap: &Change) -> bool {
        let Size { cut, shared } = self.size;
        let wide = shared + 1;
        let Work { mut pivot, mut first, mut rest, mut inverse, mut unit } =
            core::mem::take(&mut self.work);
        let entry = |row: usize, column: usize| {
            self.component(&columns[column].into(), row)
                * if column < 3 + cut { self.unit(column) } else { 1.0 }
        };
        // Everything by (y, θ, 1) once η = P y + Q (θ, 1) is put in.
        let by_cut = |row: usize, j: usize| {
            let turned: f64 = (0..3).map(|i| entry(row, i) * self.compliance[i * cut + j]).sum();
            turned + entry(row, 3 + j)
        };
        let by_shared = |row: usize, j: usize| {
            let turned: f64 = (0..3).map(|i| entry(row, i) * self.turn[i * wide + j]).sum();
            let own = if j < shared { entry(row, 3 + cut + j) } else { self.component(gap, row) };
            turned + own
        };
        pivot.clear();
        pivot.extend((0..cut * cut).map(|n| by_cut(3 + n / cut, n % cut)));
        first.clear();
        first.extend((0..3 * cut).map(|n| by_cut(n / cut, n % cut)));
        rest.clear();
        rest.extend((0..(3 + cut) * wide).map(|n| by_shared(n / wide, n % wide)));
        let regular = self.lu.factor(cut, &pivot).is_ok();
        if regular {
            self.negative ^= self.lu.is_determinant_negative();
            inverse.clear();
            inverse.resize(cut * cut, 0.0);
            for j in 0..cut {
                unit.clear();
                unit.resize(cut, 0.0);
                unit[j] = 1.0;
                self.lu.solve(&mut unit);
                for i in 0..cut {
                    inverse[i * cut + j] = unit[i];
                }
            }
            self.carry(&first, &rest, &inverse);
        }
        self.work = Work { pivot, first, rest, inverse, unit };
        regular
    }

    /// Keeps what goes back through a step, and carries `P` and `Q` across it.
    fn carry(&mut self, first: &[f64], rest: &[f64], inverse: &[f64]) {
        let Size { cut, shared } = self.size;
        let wide = shared + 1;
        self.kept.extend_from_slice(&self.compliance);
        self.kept.extend_from_slice(&self.turn);
        self.kept.extend_from_slice(inverse);
        let actuation = &rest[3 * wide..];
        self.kept.extend_from_slice(actuation);
        for i in 0..3 {
            for j in 0..cut {
                self.compliance[i * cut + j] =
                    (0..cut).map(|l| first[i * cut + l] * inverse[l * cut + j]).sum();
            }
            for j in 0..wide {
                let taken: f64 =
                    (0..cut).map(|l| self.compliance[i * cut + l] * actuation[l * wide + j]).sum();
                self.turn[i * wide + j] = rest[i * wide + j] - taken;
            }
        }
        self.steps += 1;
    }

    /// From the tip back: the answers of all nodes to `(θ, 1)`.
    pub fn answer(&mut self) {
        let Size { cut, shared } = self.size;
        let wide = shared + 1;
        let rows = (3 + cut) * wide;
        self.answers.clear();
        self.answers.resize(rows * (self.steps + 1), 0.0);
        self.answers[rows * self.steps..][..3 * wide].copy_from_slice(&self.turn);
        let stride = 3 * cut + 3 * wide + cut * cut + cut * wide;
        for k in (0..self.steps).rev() {
            let kept = &self.kept[k * stride..(k + 1) * stride];
            let (compliance, kept) = kept.split_at(3 * cut);
            let (turn, kept) = kept.split_at(3 * wide);
            let (inverse, actuation) = kept.split_at(cut * cut);
            let (here, next) = self.answers.split_at_mut(rows * (k + 1));
            let here = &mut here[rows * k..];
            for j in 0..wide {
                for i in 0..cut {
                    here[(3 + i) * wide + j] = (0..cut)
                        .map(|l| {
                            inverse[i * cut + l]
                                * (next[(3 + l) * wide + j] - actuation[l * wide + j])
                        })
                        .sum();
                }
                for i in 0..3 {
                    let bent: f64 =
                        (0..cut).map(|l| compliance[i * cut + l] * here[(3 + l) * wide + j]).sum();
                    here[i * wide + j] = bent + turn[i * wide + j];
                }
            }
        }
    }

    /// What answer `j` of node `k` is: `j` counts through `θ`, and the last is that to the gaps.
    pub fn change(&self, k: usize, j: usize) -> Change {
        let Size { cut, shared } = self.size;
        let wide = shared + 1;
        let rows = &self.answers[k * (3 + cut) * wide..];
        let at = |i: usize| rows[i * wide + j] * self.unit(i);
        Change {
            turn: Vec3::new(at(0), at(1), at(2)),
            moment: Vec3::new(at(3), at(4), at(5)),
            force: if cut == 6 { Vec3::new(at(6), at(7), at(8)) } else { Vec3::ZERO },
        }
    }

    /// Whether the determinant of the system at fixed `θ` is negative.
    pub const fn is_negative(&self) -> bool {
        self.negative
    }
}

/// Change of a node: of its rotation in the body frame, of the moment there in the body frame, and
/// of the followers' force in the base frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Change {
    pub turn: Vec3,
    pub moment: Vec3,
    pub force: Vec3,
}

impl Change {
    pub fn plus(self, f: f64, other: Self) -> Self {
        Self {
            turn: self.turn + f * other.turn,
            moment: self.moment + f * other.moment,
            force: self.force + f * other.force,
        }
    }

    pub fn is_finite(&self) -> bool {
        self.turn.is_finite() && self.moment.is_finite() && self.force.is_finite()
    }
}
