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

use whipcord_numerics::{SmallInverse, Vec3, dot};

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
    /// Memory of one step: what `η` and `y` at its end are by `(θ, 1)`.
    rest: Vec<f64>,
    negative: bool,
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

    /// Of turn, moment and force by components.
    const fn units(&self) -> [f64; 9] {
        let (m, f) = (self.moment_unit, self.force_unit);
        [1.0, 1.0, 1.0, m, m, m, f, f, f]
    }

    /// Eliminates one step, given by its columns (by `η`, `y`, `θ`) and its gap; `false` where
    /// that breaks down.
    pub fn push<C: Copy + Into<Change>>(&mut self, columns: &[C], gap: &Change) -> bool {
        let (start, shared) = columns.split_at(3 + self.size.cut);
        self.push_few(start, shared.iter().copied().enumerate(), gap)
    }

    /// The same of a step that depends on few of what all steps share: the columns by `η` and `y`, and those by `θ` that are not
    /// zero, each with its number.
    pub fn push_few<C: Copy + Into<Change>>(
        &mut self,
        start: &[C],
        shared: impl Iterator<Item = (usize, C)>,
        gap: &Change,
    ) -> bool {
        match self.size.cut {
            3 => self.push_cut::<3, 6, C>(start, shared, gap),
            _ => self.push_cut::<6, 9, C>(start, shared, gap),
        }
    }

    /// The same of steps whose cut has so many components, which are so many with those of the turn.
    fn push_cut<const CUT: usize, const ROWS: usize, C: Copy + Into<Change>>(
        &mut self,
        start: &[C],
        shared: impl Iterator<Item = (usize, C)>,
        gap: &Change,
    ) -> bool {
        let count = self.size.shared;
        let wide = count + 1;
        let units = self.units();
        let per_unit = units.map(|unit| 1.0 / unit);
        let mut by_start = [[0.0; ROWS]; ROWS];
        for (j, &column) in start.iter().enumerate().take(ROWS) {
            let components = column.into().components();
            for (i, row) in by_start.iter_mut().enumerate() {
                row[j] = components[i] * per_unit[i] * units[j];
            }
        }
        // Everything by (y, θ, 1) once η = P y + Q (θ, 1) is put in.
        let mut compliance = [[0.0; CUT]; 3];
        for (row, kept) in compliance.iter_mut().zip(self.compliance.chunks_exact(CUT)) {
            row.copy_from_slice(kept);
        }
        let mut by_cut = [[0.0; CUT]; ROWS];
        for (row, by) in by_cut.iter_mut().zip(&by_start) {
            for (j, entry) in row.iter_mut().enumerate() {
                let [a, b, c] = compliance;
                *entry = by[3 + j] + by[0] * a[j] + by[1] * b[j] + by[2] * c[j];
            }
        }
        let mut rest = core::mem::take(&mut self.rest);
        rest.clear();
        rest.resize(ROWS * wide, 0.0);
        for (by, into) in by_start.iter().zip(rest.chunks_exact_mut(wide)) {
            add_rows(&by[..3], &self.turn, into);
        }
        let mut add = |j: usize, column: &Change| {
            let components = column.components();
            for (i, row) in rest.chunks_exact_mut(wide).enumerate() {
                row[j] += components[i] * per_unit[i];
            }
        };
        for (j, column) in shared {
            add(j, &column.into());
        }
        add(count, gap);
        let (first, pivot) = by_cut.split_at(3);
        let mut square = [[0.0; CUT]; CUT];
        square.copy_from_slice(pivot);
        let inverse = SmallInverse::of(&square);
        if let Some(inverse) = &inverse {
            self.negative ^= inverse.is_determinant_negative;
            self.carry(first, &rest, &inverse.rows);
        }
        self.rest = rest;
        inverse.is_some()
    }

    /// Keeps what goes back through a step, and carries `P` and `Q` across it.
    #[inline(always)]
    fn carry<const CUT: usize>(
        &mut self,
        first: &[[f64; CUT]],
        rest: &[f64],
        inverse: &[[f64; CUT]; CUT],
    ) {
        let wide = self.size.shared + 1;
        self.kept.extend_from_slice(&self.compliance);
        self.kept.extend_from_slice(&self.turn);
        self.kept.extend_from_slice(inverse.as_flattened());
        let (turned, actuation) = rest.split_at(3 * wide);
        self.kept.extend_from_slice(actuation);
        self.turn.copy_from_slice(turned);
        let rows = self.turn.chunks_exact_mut(wide).zip(self.compliance.chunks_exact_mut(CUT));
        for ((turn, compliance), first) in rows.zip(first) {
            let mut by = [0.0; CUT];
            for (first, inverse) in first.iter().zip(inverse) {
                for (by, inverse) in by.iter_mut().zip(inverse) {
                    *by += first * inverse;
                }
            }
            compliance.copy_from_slice(&by);
            for (by, row) in by.into_iter().zip(actuation.chunks_exact(wide)) {
                turn.iter_mut().zip(row).for_each(|(x, row)| *x -= by * row);
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
        let rest = &mut self.rest;
        for k in (0..self.steps).rev() {
            let kept = &self.kept[k * stride..(k + 1) * stride];
            let (compliance, kept) = kept.split_at(3 * cut);
            let (turn, kept) = kept.split_at(3 * wide);
            let (inverse, actuation) = kept.split_at(cut * cut);
            let (here, next) = self.answers.split_at_mut(rows * (k + 1));
            let (turns, cuts) = here[rows * k..].split_at_mut(3 * wide);
            rest.clear();
            rest.extend(next[3 * wide..rows].iter().zip(actuation).map(|(next, own)| next - own));
            for (by, into) in inverse.chunks_exact(cut).zip(cuts.chunks_exact_mut(wide)) {
                add_rows(by, rest, into);
            }
            for (by, into) in compliance.chunks_exact(cut).zip(turns.chunks_exact_mut(wide)) {
                add_rows(by, cuts, into);
            }
            turns.iter_mut().zip(turn).for_each(|(x, turn)| *x += turn);
        }
    }

    /// The change of node `k` with these changes of `θ` and with the gaps.
    pub fn follow(&self, k: usize, theta: &[f64]) -> Change {
        let Size { cut, shared } = self.size;
        let wide = shared + 1;
        let rows = &self.answers[k * (3 + cut) * wide..];
        let mut values = [0.0; 9];
        let rows = rows.chunks_exact(wide).zip(self.units()).take(3 + cut);
        for (value, (row, unit)) in values.iter_mut().zip(rows) {
            *value = (dot(&row[..shared], theta) + row[shared]) * unit;
        }
        let [turn, moment, force] =
            [0, 3, 6].map(|i| Vec3::new(values[i], values[i + 1], values[i + 2]));
        Change { turn, moment, force }
    }

    /// Adds to each entry what its change of node `k` is worth; of turn, moment and force by components.
    pub fn add_worth(&self, k: usize, worth: &[f64; 9], into: &mut [f64]) {
        let Size { cut, shared } = self.size;
        let (rows, wide) = (3 + cut, shared + 1);
        let units = self.units();
        let worth: [f64; 9] = core::array::from_fn(|i| worth[i] * units[i]);
        add_rows(&worth[..rows], &self.answers[k * rows * wide..], into);
    }

    /// What answer `j` of node `k` is: `j` counts through `θ`, and the last is that to the gaps.
    pub fn change(&self, k: usize, j: usize) -> Change {
        let Size { cut, shared } = self.size;
        let wide = shared + 1;
        let rows = &self.answers[k * (3 + cut) * wide..];
        let units = self.units();
        let at = |i: usize| rows[i * wide + j] * units[i];
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

/// Adds so many times each of these rows.
fn add_rows(times: &[f64], rows: &[f64], into: &mut [f64]) {
    let wide = into.len();
    for (times, rows) in times.chunks(3).zip(rows.chunks(3 * wide)) {
        let &[a, b, c] = times else { continue };
        let (first, rest) = rows.split_at(wide);
        let (second, third) = rest.split_at(wide);
        for (((x, p), q), r) in into.iter_mut().zip(first).zip(second).zip(third) {
            *x += a * p + b * q + c * r;
        }
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
    /// Of turn, moment, force.
    #[inline(always)]
    const fn components(&self) -> [f64; 9] {
        let Self { turn, moment, force } = self;
        let ([a, b, c], [d, e, f]) = (turn.to_array(), moment.to_array());
        let [g, h, i] = force.to_array();
        [a, b, c, d, e, f, g, h, i]
    }

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
