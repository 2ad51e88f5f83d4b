//! The rows of one robot in pieces: in lanes where that goes, row by row else.

use super::arrays::{Arrays, Solved};
use super::error::BatchError;
use super::options::{BatchOptions, PATH_ROWS};
use super::rows::Rows;
use super::run::{Tally, run};
use crate::case::{CableCommand, Case};
use crate::cosserat::RodLanes;
use crate::error::SolveError;
use crate::model::Model;
use crate::prepared::Prepared;
use crate::robot::limits;
use crate::solution::{Diagnostics, Solution};

/// Rows that one thread takes at a time in lanes, where one takes less than a microsecond, and row by
/// row: few enough that no thread waits long for the last one. No number depends on the threads.
const LANE_ROWS: usize = 256;
/// The same under loads, where a row takes some microseconds in lanes and, where these do not take it, as long as by itself.
const LOADED_LANE_ROWS: usize = 32;
const SINGLE_ROWS: usize = 16;

/// A piece of the batch: its rows and where their answers go.
struct Piece<'a> {
    first: usize,
    arrays: Arrays<'a>,
    outcomes: &'a mut [Result<Solved, SolveError>],
}

/// What all pieces have in common.
struct Batch<'a> {
    model: &'a Model,
    prepared: &'a Prepared,
    rows: &'a Rows<'a>,
    options: &'a BatchOptions<'a>,
    /// Stations and cables.
    sizes: (usize, usize),
    lanes: Option<Lanes<'a>>,
}

/// The lanes that can take the rows, their tensions, and what they have in common.
struct Lanes<'a> {
    robot: RodLanes<'a>,
    tensions: &'a [f64],
    case: &'a Case,
}

/// Memory of one thread.
struct Scratch {
    /// Made when a first row is solved by itself.
    prepared: Option<Prepared>,
    case: Case,
    /// Which rows of the piece are solved.
    solved: Vec<bool>,
}

pub(super) fn solve_rows(
    model: &Model,
    prepared: &Prepared,
    rows: &Rows<'_>,
    options: &BatchOptions<'_>,
    arrays: Arrays<'_>,
    outcomes: &mut [Result<Solved, SolveError>],
) -> Result<(), BatchError> {
    let count = outcomes.len();
    let sizes = (prepared.stations().len(), prepared.robot().cables().len());
    let lanes = lanes(prepared, rows, options);
    let size = match (&lanes, options.warm_path) {
        (_, true) => PATH_ROWS,
        (Some(lanes), _) if lanes.case.loads.is_none() => LANE_ROWS,
        (Some(_), _) => LOADED_LANE_ROWS,
        (None, _) => SINGLE_ROWS,
    };
    let mut pieces = Vec::with_capacity(count.div_ceil(size));
    let mut rest = arrays;
    for (i, outcomes) in outcomes.chunks_mut(size).enumerate() {
        let (arrays, after) = rest.split_at(outcomes.len(), sizes);
        rest = after;
        pieces.push(Piece { first: i * size, arrays, outcomes });
    }
    let batch = Batch { model, prepared, rows, options, sizes, lanes };
    let scratch = || Scratch { prepared: None, case: rows.blank(), solved: Vec::new() };
    run(pieces, count, options, model.cancel(), scratch, |mut piece, scratch, tally| {
        scratch.solved.clear();
        scratch.solved.resize(piece.outcomes.len(), false);
        if let Some(lanes) = &batch.lanes
            && tally.cancelled().is_none()
        {
            batch.solve_in_lanes(lanes, &mut piece, &mut scratch.solved);
            tally.add(scratch.solved.iter().filter(|&&solved| solved).count());
        }
        batch.solve_one_by_one(&mut piece, scratch, tally);
    })
}

/// The lanes that can take the rows.
fn lanes<'a>(
    prepared: &'a Prepared,
    rows: &Rows<'a>,
    options: &BatchOptions<'_>,
) -> Option<Lanes<'a>> {
    let (Prepared::Cosserat(model, _), Rows::Tensions { values, case }) = (prepared, rows) else {
        return None;
    };
    if options.no_lanes || options.warm_path || !case.obstacles.is_empty() {
        return None;
    }
    // What is wrong with all rows each of them says by itself.
    let slack = CableCommand { tension: Some(0.0), shortening: None };
    let commands = vec![slack; model.robot().cables().len()];
    Case { commands, ..(*case).clone() }.check(model.robot()).ok()?;
    Some(Lanes { robot: model.lanes(case)?, tensions: values, case })
}

impl Batch<'_> {
    /// Solves what it can.
    fn solve_in_lanes(&self, lanes: &Lanes<'_>, piece: &mut Piece<'_>, solved: &mut [bool]) {
        let (stations, cables) = self.sizes;
        let rows = piece.first * cables..(piece.first + piece.outcomes.len()) * cables;
        let tensions = &lanes.tensions[rows];
        let Arrays { positions, orientations, tensions: pulls, lengths } = &mut piece.arrays;
        let (positions, _) = positions.as_chunks_mut::<3>();
        let (orientations, _) = orientations.as_chunks_mut::<4>();
        lanes.robot.solve(self.options.width, lanes.case.base, tensions, |answer| {
            let row = answer.row;
            let of_cables = row * cables..(row + 1) * cables;
            let given = &tensions[of_cables.clone()];
            if given.iter().any(|&tension| limits::TENSION.check("tension", tension).is_err()) {
                return;
            }
            let of = row * stations..(row + 1) * stations;
            for ((frame, position), orientation) in
                answer.frames().zip(&mut positions[of.clone()]).zip(&mut orientations[of])
            {
                let [x, y, z, w, a, b, c] = frame;
                *position = [x, y, z];
                *orientation = [w, a, b, c];
            }
            pulls[of_cables.clone()].copy_from_slice(given);
            let lengths = &mut lengths[of_cables];
            for (cable, length) in answer.lengths() {
                lengths[cable] = length;
            }
            let diagnostics = Diagnostics {
                iterations: answer.iterations,
                residual: answer.residual,
                discretization_error: answer.discretization_error,
                steps: answer.steps,
                ..Diagnostics::default()
            }
            .with_stability(answer.stability);
            piece.outcomes[row] = Ok(Solved { diagnostics, tensions: true });
            solved[row] = true;
        });
    }

    /// Solves the rows that are not solved, as long as the batch goes on. Where the flag of the model is set they have no answer.
    fn solve_one_by_one(&self, piece: &mut Piece<'_>, scratch: &mut Scratch, tally: &Tally<'_>) {
        let Scratch { prepared, case, solved } = scratch;
        let mut before: Option<Solution> = None;
        for row in (0..piece.outcomes.len()).filter(|&row| !solved[row]) {
            if !tally.goes_on() {
                return;
            }
            let answer = match tally.cancelled() {
                Some(error) => Err(error),
                None => {
                    let prepared = prepared.get_or_insert_with(|| self.prepared.clone());
                    let case = self.rows.case(piece.first + row, self.prepared.robot(), case);
                    solve_row(self.model, prepared, case, before.as_ref())
                }
            };
            match &answer {
                Ok(solution) => piece.arrays.write(row, self.sizes, solution),
                Err(_) => piece.arrays.clear(row, self.sizes),
            }
            (before, piece.outcomes[row]) = match answer {
                Ok(solution) => {
                    let solved = Solved {
                        diagnostics: solution.diagnostics.clone(),
                        tensions: solution.cables.iter().all(|cable| cable.tension.is_some()),
                    };
                    (self.options.warm_path.then_some(solution), Ok(solved))
                }
                Err(error) => (None, Err(error)),
            };
            tally.add(1);
        }
    }
}

/// One row, from the answer before it and, where that leads nowhere, from cold.
fn solve_row(
    model: &Model,
    prepared: &mut Prepared,
    case: &Case,
    before: Option<&Solution>,
) -> Result<Solution, SolveError> {
    if !prepared.takes_places_of(&case.loads) {
        // Steps end where point loads are: other places are other steps.
        *prepared = model.prepare(&prepared.robot().clone(), &case.loads)?;
    }
    if let Some(before) = before
        && let Ok(solution) = prepared.solve(case, Some(before))
    {
        return Ok(solution);
    }
    prepared.solve(case, None)
}
