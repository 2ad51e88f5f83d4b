//! Many cases at once: structure of arrays in and out, threads, and the lanes of vectors.
//!
//! [`solve_batch`] solves the rows of one robot, [`solve_robots`] one case for each of many robots.
//! Rows come back in the order they were given. A row without an answer is a row with its
//! [`SolveError`]; its numbers are NaN, so that no plot or mean takes them for an answer. The gradients of
//! such a row are zero instead ([`pull_back_batch`]). A row whose answer is an unstable equilibrium has an answer, and
//! says so ([`Solved::is_unstable`]). What a row gives depends on that row alone (and, along a
//! [path](BatchOptions::warm_path), on those just before it), never on how many threads there are
//! or how wide the processor's vectors: the same input gives the same bits.
//!
//! Vectors (AVX2, AVX-512 or none, as the program finds them when it runs) carry one row in each lane
//! where the Cosserat model has [`Rows::Tensions`], a section whose stiffness is diagonal, and no load or dead forces so weak that they leave one
//! equilibrium alone. All else goes row by row. Without load a row has the bits of a single solve; under loads it agrees with that to the residual.
//!
//! Threads are started only with the cargo feature `parallel`, which is off by default.
//!
//! ```
//! use whipcord::batch::{BatchOptions, Rows, solve_batch};
//! use whipcord::{Backbone, Cable, Case, Disks, Material, Model, ModelKind, Robot, Routing, Section};
//!
//! let backbone = Backbone {
//!     section: Some(Section::circle(0.003)),
//!     material: Material {
//!         young_modulus: Some(1.1e9),
//!         poisson_ratio: Some(0.3),
//!         ..Default::default()
//!     },
//!     ..Backbone::new(0.18)
//! };
//! let disks = Disks::equally_spaced(0.18, 10, 0.008);
//! let cable = |name: &str, angle| Cable::new(name, Routing::Straight { angle, radius: 0.008 });
//! let robot = Robot::new(backbone, disks, vec![cable("left", 0.0), cable("right", 3.14)])?;
//!
//! let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
//! // Three rows of two tensions in N. The second is more than the section bears.
//! let tensions = [3.0, 0.0, 1e4, 0.0, 0.0, 3.0];
//! let rows = Rows::Tensions { values: &tensions, case: &Case::default() };
//! let batch = solve_batch(&model, &robot, rows, &BatchOptions::default())?;
//! assert!(batch.row(0).unwrap().is_ok());
//! assert!(batch.row(1).unwrap().is_err());
//! let tip = batch.row(2).unwrap().unwrap().position(9);
//! assert!(tip[0] < -0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrays;
mod error;
mod gradients;
mod options;
mod piece;
mod rows;
mod run;

pub use arrays::{Arrays, Batch, Row, Solved};
pub use error::{BatchError, Driven};
pub use gradients::{Gradients, Sensitivities, pull_back_batch};
pub use options::{BatchOptions, PATH_ROWS, Progress};
pub use rows::Rows;
pub use whipcord_numerics::lanes::Width;

use crate::case::Case;
use crate::error::SolveError;
use crate::model::Model;
use crate::prepared::Prepared;
use crate::robot::Robot;
use crate::solution::Solution;
use piece::solve_rows;
use run::run;

/// Solves all rows of one robot.
///
/// # Errors
/// [`BatchError`] when the model cannot take the robot, the values are no whole number of rows, or
/// the batch was stopped. A row without an answer is no error of the batch.
pub fn solve_batch(
    model: &Model,
    robot: &Robot,
    rows: Rows<'_>,
    options: &BatchOptions<'_>,
) -> Result<Batch, BatchError> {
    let prepared = prepare(model, robot, &rows)?;
    let mut batch =
        Batch::new(rows.count(robot)?, prepared.stations().to_vec(), robot.cables().len());
    let (arrays, outcomes) = batch.parts();
    solve_rows(model, &prepared, &rows, options, arrays, outcomes)?;
    Ok(batch)
}

/// As [`solve_batch`], but writes the numbers into arrays of the caller's; returns for each row how
/// it was solved, or why it was not. When the batch stops with an error, what the arrays hold is
/// of no use.
///
/// # Errors
/// [`BatchError`] also when an array has not the size it must have.
pub fn solve_batch_into(
    model: &Model,
    robot: &Robot,
    rows: Rows<'_>,
    options: &BatchOptions<'_>,
    arrays: Arrays<'_>,
) -> Result<Vec<Result<Solved, SolveError>>, BatchError> {
    let prepared = prepare(model, robot, &rows)?;
    let count = rows.count(robot)?;
    arrays.check(count, prepared.stations().len(), robot.cables().len())?;
    let mut outcomes = vec![Ok(Solved::default()); count];
    solve_rows(model, &prepared, &rows, options, arrays, &mut outcomes)?;
    Ok(outcomes)
}

/// Solves one case for each robot, each from cold.
///
/// # Errors
/// [`BatchError`] when the batch was stopped.
pub fn solve_robots(
    model: &Model,
    robots: &[(Robot, Case)],
    options: &BatchOptions<'_>,
) -> Result<Vec<Result<Solution, SolveError>>, BatchError> {
    const ROBOTS: usize = 8;
    let mut solutions: Vec<Option<Result<Solution, SolveError>>> = vec![None; robots.len()];
    let jobs: Vec<_> = robots.chunks(ROBOTS).zip(solutions.chunks_mut(ROBOTS)).collect();
    run(
        jobs,
        robots.len(),
        options,
        model.cancel(),
        || (),
        |(robots, solutions), (), tally| {
            for ((robot, case), solution) in robots.iter().zip(solutions) {
                if !tally.goes_on() {
                    return;
                }
                *solution = Some(match tally.cancelled() {
                    Some(error) => Err(error),
                    None => model
                        .prepare(robot, &case.loads)
                        .and_then(|mut prepared| prepared.solve(case, None)),
                });
                tally.add(1);
            }
        },
    )?;
    // A batch that was not stopped has solved every robot.
    Ok(solutions.into_iter().flatten().collect())
}

fn prepare(model: &Model, robot: &Robot, rows: &Rows<'_>) -> Result<Prepared, BatchError> {
    Ok(model.prepare(robot, &rows.first_loads())?)
}
