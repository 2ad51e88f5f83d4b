//! What one thread computes with.

use super::build;
use super::error::NoAnswerReason;
use super::forward::Forward;
use super::outcome::Unstable;
use super::pieces::Piece;
use super::quantity::Quantity;
use whipcord::case::Case;
use whipcord::model::Model;
use whipcord::over_determined::{Relaxed, relaxed};
use whipcord::prepared::Prepared;
use whipcord::robot::Robot;
use whipcord::solution::Solution;

/// The model for the robot of the last numbers.
pub(super) struct Solver<'f, 'a> {
    pub(super) forward: &'f Forward<'a>,
    built: Option<Built>,
    /// By another model than that of the fit.
    model: Option<&'f Model>,
}

/// The robot with the last numbers, and its model.
struct Built {
    /// The unknowns of the robot and their bits.
    numbers: Vec<(Quantity, u64)>,
    robot: Robot,
    prepared: Prepared,
    /// Whether its cables give, for one row alone.
    relaxed: bool,
}

/// What would be seen in a piece.
pub(super) struct Predicted {
    /// The row of each number, of those of all experiments.
    pub(super) rows: Vec<usize>,
    pub(super) numbers: Vec<f64>,
    /// How each changes with the unknowns, as far as the model says so itself: numbers × unknowns; empty where that is not asked.
    pub(super) columns: Vec<f64>,
}

/// Of the answers to a piece: how many there are in which something was seen, and which of them are unstable.
pub(super) type Stabilities = (usize, Vec<Unstable>);

impl<'f, 'a> Solver<'f, 'a> {
    pub(super) const fn new(forward: &'f Forward<'a>) -> Self {
        Self { forward, built: None, model: None }
    }

    /// The model of a piece's robot, and its case, with these values.
    pub(super) fn prepare(
        &mut self,
        piece: &Piece,
        x: &[f64],
    ) -> Result<(&mut Prepared, Case), NoAnswerReason> {
        let forward = self.forward;
        let numbers = forward.numbers(piece.experiment, x);
        let of_robot: Vec<(Quantity, u64)> = numbers
            .iter()
            .filter(|(quantity, _)| !quantity.is_of_case())
            .map(|(quantity, value)| (*quantity, value.to_bits()))
            .collect();
        let alike = |built: &Built| built.numbers == of_robot && !built.relaxed;
        let kept = self.built.take().filter(alike);
        let (robot, prepared) = match kept {
            Some(built) => (built.robot, Some(built.prepared)),
            None => (build::robot(forward.robot, &piece.case, &numbers)?, None),
        };
        let case = build::case(&robot, &piece.case, &numbers, forward.rest());
        let case = case.map_err(whipcord::SolveError::from)?;
        let model = self.model.unwrap_or(&forward.model);
        if piece.over_determined
            && let Some(Relaxed { robot, case, .. }) = relaxed(model, &robot, &case)
        {
            let prepared = model.prepare(&robot, &case.loads)?;
            let built = Built { numbers: of_robot, robot, prepared, relaxed: true };
            return Ok((&mut self.built.insert(built).prepared, case));
        }
        let prepared = match prepared.filter(|prepared| prepared.takes_places_of(&case.loads)) {
            Some(prepared) => prepared,
            None => model.prepare(&robot, &case.loads)?,
        };
        let built = Built { numbers: of_robot, robot, prepared, relaxed: false };
        Ok((&mut self.built.insert(built).prepared, case))
    }

    /// What would be seen in a piece by another model, without derivatives.
    pub(super) fn predict_by(
        &self,
        model: &Model,
        piece: &Piece,
        x: &[f64],
    ) -> Result<Predicted, NoAnswerReason> {
        Solver { forward: self.forward, built: None, model: Some(model) }.predict(piece, x)
    }

    /// What would be seen in a piece, without derivatives.
    pub(super) fn predict(
        &mut self,
        piece: &Piece,
        x: &[f64],
    ) -> Result<Predicted, NoAnswerReason> {
        let (prepared, case) = self.prepare(piece, x)?;
        let mut solutions: Vec<Solution> = Vec::with_capacity(piece.steps.len());
        prepared
            .solve_steps(&case, |solution| solutions.push(solution))
            .map_err(|(_, error)| error)?;
        let mut found = Predicted { rows: Vec::new(), numbers: Vec::new(), columns: Vec::new() };
        let view = self.forward.view(piece.experiment, x);
        for (step, solution) in piece.steps.iter().zip(&solutions) {
            self.forward.see(piece.experiment, *step, solution, &view, |row, seen, marker| {
                let count = seen.numbers();
                found.rows.extend(row..row + count);
                found.numbers.extend(&marker.numbers[..count]);
            })?;
        }
        Ok(found)
    }

    /// The stability of the answers to a piece in which something was seen.
    pub(super) fn stabilities(
        &mut self,
        piece: &Piece,
        x: &[f64],
    ) -> Result<Stabilities, NoAnswerReason> {
        let (experiment, forward) = (piece.experiment, self.forward);
        let (prepared, case) = self.prepare(piece, x)?;
        let (mut answers, mut unstable) = (0, Vec::new());
        let mut steps = piece.steps.iter().copied();
        // These numbers had an answer when they were fitted.
        let _ = prepared.solve_steps(&case, |solution| {
            let Some(step) = steps.next().filter(|step| forward.is_seen(experiment, *step)) else {
                return;
            };
            answers += 1;
            let diagnostics = &solution.diagnostics;
            if let Some(stability) = diagnostics.stability.filter(|_| diagnostics.is_unstable()) {
                unstable.push(Unstable { experiment, step, stability });
            }
        });
        Ok((answers, unstable))
    }
}
