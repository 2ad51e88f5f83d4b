//! What ends a sweep.

use std::io;
use std::path::PathBuf;

use whipcord::batch::BatchError;
use whipcord_io::FileError;

/// Why a sweep cannot be made, or ended.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// Nothing varies.
    #[error("nothing varies: give --vary PATH=FIRST:LAST:COUNT or --table FILE")]
    NoAxes,
    /// There is no row.
    #[error("the sweep has no rows: ask for one at least")]
    NoRows,
    /// An axis has no values.
    #[error("`{path}` has no values: give a range or a list")]
    NoValues {
        /// Path of the axis.
        path: String,
    },
    /// A grid needs the number of values.
    #[error(
        "`{path}` has no number of values, which a grid needs: write it behind the range, as in 0 N:20 N:41, or sample at random with --samples"
    )]
    NoCount {
        /// Path of the axis.
        path: String,
    },
    /// Samples do not have the number of values of a range.
    #[error(
        "`{path}` has {count} values, which is for a grid: leave :{count} out where rows are sampled, or list the values"
    )]
    Count {
        /// Path of the axis.
        path: String,
        /// Its number of values.
        count: usize,
    },
    /// More rows than can be numbered.
    #[error("the sweep has more than {most} rows: vary fewer keys, or give them fewer values")]
    TooManyRows {
        /// Most rows.
        most: u64,
    },
    /// More axes than the sequence of Sobol has here.
    #[error(
        "{given} keys vary, and the sequence of Sobol is known for {most} here: use latin-hypercube or random"
    )]
    TooManySobolAxes {
        /// Number of axes.
        given: usize,
        /// Most of them.
        most: usize,
    },
    /// Two axes vary the same.
    #[error("`{path}` varies twice: give it once")]
    Twice {
        /// Path of the axis.
        path: String,
    },
    /// A value cannot be set.
    #[error("`{path}` cannot be {value}: {reason}")]
    Value {
        /// Path of the axis.
        path: String,
        /// The value with its unit.
        value: String,
        /// What the file says of it.
        reason: String,
    },
    /// The robot file has many cases.
    #[error(
        "the robot file has {steps} independent steps, and a sweep varies one case: take [commands] or the steps out, or give their rows by --table"
    )]
    IndependentSteps {
        /// Their number.
        steps: usize,
    },
    /// The model has no derivatives.
    #[error(
        "{model} has no Jacobian of this robot by exact derivatives: leave `jacobian` out of the outputs, or use another model"
    )]
    NoJacobian {
        /// The model.
        model: String,
    },
    /// A shard that there is not.
    #[error(
        "there is no shard {number} of {count}: shards count from 0, and their number is 1 at least, as in --shard 0/4 to 3/4"
    )]
    Shard {
        /// Number of the shard.
        number: u64,
        /// Number of all shards.
        count: u64,
    },
    /// A part that is too small or too large.
    #[error("a part cannot have {given} rows: give from 1 to {most}")]
    RowsPerPart {
        /// Rows asked for.
        given: u64,
        /// Most rows of a part, with these outputs.
        most: u64,
    },
    /// The folder holds parts of this data set.
    #[error("{} holds a part of this data set already: add --resume to go on, or choose another folder", folder.display())]
    Begun {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds another data set.
    #[error("{} holds another data set, which differs in {differs}: choose another folder", folder.display())]
    Another {
        /// The folder.
        folder: PathBuf,
        /// The keys of the manifest that differ.
        differs: String,
    },
    /// The manifest cannot be read.
    #[error("{} is no manifest of a sweep: {reason}; choose another folder", path.display())]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The robot file has a mistake.
    #[error(transparent)]
    File(#[from] FileError),
    /// The robot is one that the model does not take.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// A file cannot be written or read.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// It was stopped before its end.
    #[error("the sweep was stopped after {done} of {rows} rows: run it again with --resume")]
    Stopped {
        /// Rows that are written.
        done: u64,
        /// Rows that were to be written.
        rows: u64,
    },
}
