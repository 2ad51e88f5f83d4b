//! What a score holds.

use whipcord::{LengthMiss, ModelKind, Pose, SolveError, Vec3};
use whipcord_io::CaseFile;

use super::solve::{Subject, Unsolved};
use crate::remark::Remark;

/// The models on all rows of all files.
#[derive(Clone, Debug)]
pub struct Score<'a> {
    /// The files, and where their robots were measured.
    pub subjects: Vec<Subject<'a>>,
    /// What the names of the files are in tables, each another one.
    pub names: Vec<String>,
    /// The models, in the order of the tables.
    pub models: Vec<ModelKind>,
    /// By files, then by models.
    pub files: Vec<Vec<FileScore>>,
    /// The warning where the zero or the angle of a single cable explains much of the errors of the best model.
    pub single_cable: Option<Remark>,
}

/// A model on the rows of one file.
#[derive(Clone, Debug)]
pub struct FileScore {
    /// The model.
    pub model: ModelKind,
    /// What it says of the rows in which something was measured, in their order.
    pub rows: Vec<RowScore>,
    /// The markers of all rows that are compared.
    pub markers: Vec<MarkerScore>,
    /// How the measurement was moved onto the answers, where that was asked for.
    pub motion: Option<Pose>,
    /// Root mean square distances in m that the rigid motion leaves of the measurement, and of its mirror image where that fits much better.
    pub mirrored: Option<[f64; 2]>,
    /// Why no row can be compared, though rows have answers.
    pub incomparable: Option<String>,
    /// Why the model does not take the robot.
    pub refused: Option<SolveError>,
    /// Whether the rotation of the tracked body on the robot was estimated from the rows.
    pub body_is_estimated: bool,
}

/// A model on one row.
#[derive(Clone, Debug)]
pub struct RowScore {
    /// The row, from 0.
    pub row: usize,
    /// Why it has no answer.
    pub failure: Option<Unsolved>,
    /// Whether the answer is an unstable equilibrium.
    pub unstable: bool,
    /// Cables whose lengths contradict each other, and what each misses: the answer is then the least-squares one.
    pub misses: Vec<LengthMiss>,
    /// Whether a marker of it counts less in the rigid motion of the measurement, as it is far off.
    pub down_weighted: bool,
    /// Root mean square distance in m over the markers of the row that are not on the base; `None` where nothing is compared.
    pub error: Option<f64>,
    /// Angle in rad between the measured and the computed orientation of the tracked body.
    pub angle: Option<f64>,
}

/// A marker in one row.
#[derive(Clone, Copy, Debug)]
pub struct MarkerScore {
    /// The row, from 0.
    pub row: usize,
    /// Where on the backbone it is, in m.
    pub arc_length: f64,
    /// Where it was measured, in m, after the measurement was moved.
    pub measured: Vec3,
    /// Where the model has it.
    pub model: Vec3,
    /// Whether the base holds it.
    pub at_base: bool,
}

impl MarkerScore {
    /// Distance in m of the model's place from the measured one.
    #[must_use]
    pub fn distance(&self) -> f64 {
        (self.model - self.measured).norm()
    }
}

impl<'a> Score<'a> {
    /// The file of this number.
    #[must_use]
    pub fn file(&self, number: usize) -> &'a CaseFile {
        self.subjects[number].file
    }
}
