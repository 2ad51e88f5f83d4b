//! The linear problem of the holes: of a Newton step, or of the rates between two events.

use super::law::{Iterate, Law, Mode, Row};
use super::response::Response;
use crate::statics::command::LENGTH_REGULARISATION;

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
    for ((cable, place), p) in holes.all() {
        let passages = &holes.of_cable[cable];
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
                for &q in &passages[place..] {
                    let by = &response.lengths[q * wide..(q + 1) * wide];
                    for (entry, by) in row.iter_mut().zip(by) {
                        *entry += by;
                    }
                    row[q] -= holes.yielding[q];
                    if closes {
                        changes[p] -= by[n];
                    }
                }
                // Pieces that stick may hold one another at their lengths.
                row[p] -= LENGTH_REGULARISATION * kappa / n as f64;
                if modes[p] == Mode::Held {
                    changes[p] += commanded;
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
