//! The linear problem of the holes: of a Newton step, or of the rates between two events.

use whipcord_numerics::{Factors, ReplacedRows, dot};

use super::holes::Holes;
use super::law::{Iterate, Law, Row};
use super::modes::Mode;
use super::pivoting::Cover;
use super::response::Response;
use crate::budget::Meter;
use crate::statics::command::LENGTH_REGULARISATION;

/// The linear problems of the holes with one response, in cases that change from one to the next: few rows then change.
#[derive(Clone, Debug, Default)]
pub(super) struct LinearProblem {
    /// What is beyond each hole by the tensions and, last in a row, by what closes the equilibrium.
    beyond: Vec<f64>,
    /// By rows, and the case that each of them is of; none where the coefficients are new.
    matrix: Vec<f64>,
    modes: Vec<Mode>,
    changed: Vec<usize>,
    system: ReplacedRows,
    by_cover: Vec<f64>,
    /// What was solved and is not counted yet, and how many of that with factors of its own.
    solves: usize,
    factors: usize,
}

impl LinearProblem {
    /// Begins with a response.
    pub fn begin(&mut self, holes: &Holes, response: &Response) {
        self.renew();
        let wide = holes.count() + 1;
        self.beyond.clone_from(&response.lengths);
        for passages in &holes.of_cable {
            let mut last: Option<usize> = None;
            for &p in passages.iter().rev() {
                self.beyond[p * wide + p] -= holes.yielding[p];
                if let Some(last) = last {
                    let [row, next] = rows_of(&mut self.beyond, wide, [p, last]);
                    row.iter_mut().zip(&*next).for_each(|(sum, by)| *sum += by);
                }
                last = Some(p);
            }
        }
    }

    /// Takes the coefficients anew.
    pub fn renew(&mut self) {
        self.modes.clear();
        self.system.forget();
    }

    /// The matrix that was solved with last, by rows.
    pub fn matrix(&self) -> &[f64] {
        &self.matrix
    }

    /// What the length beyond a hole changes by, with these changes of the tensions.
    pub fn beyond(&self, p: usize, tensions: &[f64]) -> f64 {
        let n = tensions.len();
        dot(&self.beyond[p * (n + 1)..][..n], tensions)
    }

    /// The same with closing the equilibrium, of so many holes.
    pub fn beyond_closing(&self, p: usize, n: usize) -> f64 {
        self.beyond[p * (n + 1) + n]
    }

    /// Solves that of the holes in these cases, at a state that only [`Self::renew`] lets change: for the Newton step, or for how the tensions
    /// change with the commands at these rates. Whether there is a finite solution.
    pub fn solve(
        &mut self,
        law: &Law<'_>,
        here: Iterate<'_>,
        modes: &[Mode],
        response: &Response,
        rates: Option<&[f64]>,
        changes: &mut Vec<f64>,
    ) -> bool {
        let n = here.tensions.len();
        self.matrix.resize(n * n, 0.0);
        self.changed.clear();
        changes.clear();
        changes.resize(n, 0.0);
        for (hole, p) in law.holes.all() {
            let (equation, left) = law.row(hole, modes[p], here);
            if self.modes.get(p) != Some(&modes[p]) {
                self.changed.push(p);
                self.set_row(law.holes, (hole, p), modes[p], &equation, response);
            }
            let commanded = match (hole.1, rates) {
                (0, Some(rates)) => rates[hole.0],
                _ => 0.0,
            };
            if rates.is_none() {
                changes[p] = -left;
            }
            match equation {
                Row::Slack => {}
                Row::Held => {
                    if rates.is_none() {
                        changes[p] -= self.beyond_closing(p, n);
                    }
                    if modes[p] == Mode::Held {
                        changes[p] += commanded;
                    }
                }
                Row::Slides { factor, by_turn, incoming } => {
                    let kappa = law.holes.compliance;
                    if rates.is_none() {
                        changes[p] += kappa * by_turn * incoming * response.turns[p * (n + 1) + n];
                    }
                    changes[p] += kappa * factor * commanded;
                }
            }
        }
        self.modes.clear();
        self.modes.extend_from_slice(modes);
        self.solves += 1;
        let solved = self.system.solve_changed(&self.matrix, &self.changed, changes);
        self.factors += usize::from(solved != Ok(Factors::Kept));
        solved.is_ok() && changes.iter().all(|x| x.is_finite())
    }

    /// Adds to the solution that was found last what a right-hand side of the covers of Lemke's method changes; whether that is finite.
    pub fn add_covers(&mut self, covers: &[Cover], solution: &mut [f64]) -> bool {
        self.by_cover.clear();
        let rows = covers.iter().zip(&self.modes);
        self.by_cover.extend(rows.map(|(cover, &mode)| cover.right_side(mode)));
        if self.by_cover.iter().all(|&of| of == 0.0) {
            return true;
        }
        self.solves += 1;
        let solved = self.system.solve_changed(&self.matrix, &[], &mut self.by_cover);
        self.factors += usize::from(solved != Ok(Factors::Kept));
        solution.iter_mut().zip(&self.by_cover).for_each(|(sum, by)| *sum += by);
        solved.is_ok() && self.by_cover.iter().all(|x| x.is_finite())
    }

    fn set_row(
        &mut self,
        holes: &Holes,
        ((cable, place), p): ((usize, usize), usize),
        mode: Mode,
        equation: &Row,
        response: &Response,
    ) {
        let n = holes.count();
        let (wide, kappa) = (n + 1, holes.compliance);
        let row = &mut self.matrix[p * n..(p + 1) * n];
        match *equation {
            Row::Slack => {
                row.fill(0.0);
                row[p] = kappa;
            }
            Row::Held => {
                row.copy_from_slice(&self.beyond[p * wide..][..n]);
                // Pieces that stick may hold one another at their lengths.
                row[p] -= LENGTH_REGULARISATION * kappa / n as f64;
                if mode == Mode::Held {
                    row[p] -= holes.outside[cable];
                    for (other, by) in holes.yielded(cable) {
                        row[other] -= by;
                    }
                }
            }
            Row::Slides { factor, by_turn, incoming } => {
                let weight = -kappa * by_turn * incoming;
                let by = &response.turns[p * wide..(p + 1) * wide];
                row.iter_mut().zip(by).for_each(|(entry, by)| *entry = weight * by);
                row[p] += kappa;
                if let Some(before) = place.checked_sub(1) {
                    row[holes.of_cable[cable][before]] -= kappa * factor;
                }
            }
        }
    }

    /// Counts what was solved since it was last asked to.
    pub fn charge(&mut self, meter: &Meter) {
        let rows = self.matrix.len().isqrt();
        meter.eliminate(rows, core::mem::take(&mut self.factors));
        meter.substitute(rows, core::mem::take(&mut self.solves));
    }
}

/// Two rows of a matrix.
fn rows_of(matrix: &mut [f64], wide: usize, [a, b]: [usize; 2]) -> [&mut [f64]; 2] {
    let (low, high) = matrix.split_at_mut(wide * a.max(b));
    let low = &mut low[wide * a.min(b)..][..wide];
    let high = &mut high[..wide];
    if a < b { [low, high] } else { [high, low] }
}

/// The right-hand side of something else that changes the lengths of the passages and the angles so while the tensions stay.
pub(super) fn right_side(
    law: &Law<'_>,
    here: Iterate<'_>,
    modes: &[Mode],
    (lengths, turns): (&[f64], &[f64]),
    into: &mut [f64],
) {
    let kappa = law.holes.compliance;
    for (cable, passages) in law.holes.of_cable.iter().enumerate() {
        let mut beyond = 0.0;
        for (place, &p) in passages.iter().enumerate().rev() {
            beyond += lengths[p];
            into[p] = match law.row((cable, place), modes[p], here).0 {
                Row::Slack => 0.0,
                Row::Held => -beyond,
                Row::Slides { by_turn, incoming, .. } => kappa * by_turn * incoming * turns[p],
            };
        }
    }
}
