//! The linear problem of the holes: of a Newton step, or of the rates between two events.

use whipcord_numerics::{Factors, ReplacedRows};

use super::law::{Iterate, Law, Mode, Row};
use super::response::Response;
use crate::statics::command::LENGTH_REGULARISATION;

/// What the linear problems of the holes took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LinearEffort {
    /// How many were solved.
    pub solves: usize,
    /// How many of them with factors of their own.
    pub factors: usize,
}

impl LinearEffort {
    /// Solves one, into its right-hand side; whether that has a finite solution.
    pub fn solve(&mut self, system: &mut ReplacedRows, matrix: &[f64], right: &mut [f64]) -> bool {
        self.solves += 1;
        let solved = system.solve(matrix, right);
        self.factors += usize::from(solved != Ok(Factors::Kept));
        solved.is_ok() && right.iter().all(|x| x.is_finite())
    }
}

/// The linear problem of the holes in these cases: for the Newton step, or for how the tensions change with the
/// commands at these rates. Into a matrix by rows and a right-hand side.
pub(super) fn linear_system(
    law: &Law<'_>,
    here: Iterate<'_>,
    modes: &[Mode],
    response: &Response,
    rates: Option<&[f64]>,
    (matrix, changes): (&mut Vec<f64>, &mut Vec<f64>),
) {
    let (holes, n) = (law.holes, here.tensions.len());
    let (wide, kappa) = (n + 1, holes.compliance);
    matrix.clear();
    matrix.resize(n * n, 0.0);
    changes.clear();
    changes.resize(n, 0.0);
    let closes = rates.is_none();
    // Lengths beyond a hole by the tensions, summed up from the end of each cable.
    let mut beyond = vec![0.0; wide];
    let from_ends = holes.of_cable.iter().enumerate().flat_map(|(cable, passages)| {
        passages.iter().enumerate().rev().map(move |(place, &p)| ((cable, place), p))
    });
    for ((cable, place), p) in from_ends {
        let passages = &holes.of_cable[cable];
        if place + 1 == passages.len() {
            beyond.fill(0.0);
        }
        let by = &response.lengths[p * wide..(p + 1) * wide];
        beyond.iter_mut().zip(by).for_each(|(sum, by)| *sum += by);
        beyond[p] -= holes.yielding[p];
        let row = &mut matrix[p * n..(p + 1) * n];
        let (equation, left) = law.row((cable, place), modes[p], here);
        let commanded = match (place, rates) {
            (0, Some(rates)) => rates[cable],
            _ => 0.0,
        };
        changes[p] = if closes { -left } else { 0.0 };
        match equation {
            Row::Slack => row[p] = kappa,
            Row::Held => {
                row.copy_from_slice(&beyond[..n]);
                if closes {
                    changes[p] -= beyond[n];
                }
                // Pieces that stick may hold one another at their lengths.
                row[p] -= LENGTH_REGULARISATION * kappa / n as f64;
                if modes[p] == Mode::Held {
                    changes[p] += commanded;
                    row[p] -= holes.outside[cable];
                    for (other, by) in holes.yielded(cable) {
                        row[other] -= by;
                    }
                }
            }
            Row::Slides { factor, by_turn, incoming } => {
                let by = &response.turns[p * wide..(p + 1) * wide];
                let weight = -kappa * by_turn * incoming;
                for (entry, by) in row.iter_mut().zip(by) {
                    *entry = weight * by;
                }
                if closes {
                    changes[p] -= weight * by[n];
                }
                changes[p] += kappa * factor * commanded;
                row[p] += kappa;
                if let Some(before) = place.checked_sub(1) {
                    row[passages[before]] -= kappa * factor;
                }
            }
        }
    }
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
