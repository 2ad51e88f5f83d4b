//! A sweep: what varies, and what is asked.

use whipcord::robot::RobotError;
use whipcord::{Actuation, Case, Model, StabilityAnalysis, Stations};
use whipcord_io::CaseFile;

use crate::axis::Axis;
use crate::error::SweepError;
use crate::outputs::{Columns, Output};
use crate::samples::{Samples, Sampling};
use crate::setter::{Setter, What};

/// A sweep of a robot file.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(crate) file: CaseFile,
    pub(crate) model: Model,
    pub(crate) samples: Samples,
    pub(crate) setters: Vec<Setter>,
    pub(crate) columns: Columns,
    rows_per_part: u64,
}

/// What is asked of a sweep.
#[derive(Clone, Debug)]
pub struct Question {
    /// What varies.
    pub axes: Vec<Axis>,
    /// How the values are combined.
    pub sampling: Sampling,
    /// What the data set holds.
    pub outputs: Vec<Output>,
    /// Rows of each part but the last; by default 65,536, or 4,096 where there are loads or obstacles, cables rub, or the robot is read again for
    /// each row, and fewer where these are more than some 30 MB.
    pub rows_per_part: Option<u64>,
}

/// Most rows and numbers of a part: each thread has one of them in memory, some three times over.
const MOST_ROWS_OF_PART: u64 = 65_536;
/// The same where a row takes tens of microseconds or more: a part is what a task of a cluster has, and what a killed process loses.
const DEAR_ROWS_OF_PART: u64 = 4_096;
const NUMBERS_OF_PART: u64 = 4_000_000;
/// Numbers of a part that is asked for.
const MOST_NUMBERS_OF_PART: u64 = 64_000_000;

impl Plan {
    /// The sweep of a file by a model.
    ///
    /// # Errors
    /// [`SweepError`] where it cannot be made: an axis that the file does not have, a value that is none for the first row.
    pub fn new(file: &CaseFile, model: &Model, question: &Question) -> Result<Self, SweepError> {
        let Question { axes, sampling, outputs, rows_per_part } = question;
        if file.case.independent {
            return Err(SweepError::IndependentSteps { steps: file.case.before.len() + 1 });
        }
        for (k, axis) in axes.iter().enumerate() {
            if axes[..k].iter().any(|other| other.path == axis.path) {
                return Err(SweepError::Twice { path: axis.path.clone() });
            }
        }
        let samples = Samples::new(axes.clone(), sampling.clone())?;
        let setters: Vec<Setter> = axes.iter().map(|axis| Setter::of(axis, &file.robot)).collect();
        let analysis = match outputs.contains(&Output::Stability) {
            true => StabilityAnalysis::Verdict,
            false => StabilityAnalysis::Off,
        };
        let is_read = setters.iter().any(|setter| setter.what == What::Key);
        // The shape at the tip alone, where it has the same arc length in all rows.
        let stations = match outputs.contains(&Output::Disks) || is_read {
            true => Stations::Disks,
            false => Stations::At(vec![file.robot.backbone().length]),
        };
        let model = model.at(stations).with_stability(analysis);
        let mut plan = Self {
            file: file.clone(),
            columns: Columns::new(&file.robot, outputs, |_| true),
            model,
            samples,
            setters,
            rows_per_part: 1,
        };
        let case = plan.first_row()?;
        if outputs.contains(&Output::Jacobian) && !plan.model.has_derivatives(&file.robot) {
            return Err(SweepError::NoJacobian { model: plan.model.kind().name().to_owned() });
        }
        let natural = plan.model.kind().natural_actuation();
        plan.columns = Columns::new(&file.robot, outputs, |cable| {
            let command = case.commands.get(cable).copied().unwrap_or_default();
            match (plan.model.actuation(), natural) {
                (Actuation::Tension, _) => true,
                (Actuation::Shortening, _) => false,
                (Actuation::Natural, Actuation::Shortening) => command.shortening.is_none(),
                (Actuation::Natural, _) => command.tension.is_some(),
            }
        });
        let width = (plan.columns.names().len() + axes.len() + 1) as u64;
        let most = (MOST_NUMBERS_OF_PART / width).max(1);
        plan.rows_per_part = match *rows_per_part {
            Some(given) if (1..=most).contains(&given) => given,
            Some(given) => return Err(SweepError::RowsPerPart { given, most }),
            None if plan.has_dear_rows() => (NUMBERS_OF_PART / width).clamp(1, DEAR_ROWS_OF_PART),
            None => (NUMBERS_OF_PART / width).clamp(1, MOST_ROWS_OF_PART),
        };
        Ok(plan)
    }

    /// The case of the first row. The values of an axis that is read from the file are tried one axis at a time, so that the axis at
    /// fault is told.
    fn first_row(&self) -> Result<Case, SweepError> {
        let mut values = Vec::new();
        self.samples.push(0, &mut values);
        for ((axis, setter), value) in self.samples.axes().iter().zip(&self.setters).zip(&values) {
            let wrong = |reason: String| SweepError::Value {
                path: axis.path.clone(),
                value: format!("{value} {}", axis.unit).trim_end().to_owned(),
                reason,
            };
            match setter.what {
                What::Key => {
                    let set = self.file.with_settings(&[axis.setting(*value)]);
                    set.map_err(|error| wrong(error.to_string()))?;
                }
                _ => {
                    let (mut case, mut motors) = blank(&self.file);
                    setter.set(*value, &mut case, &mut motors);
                    let case = driven(&self.file, case, &motors);
                    let checked = case.and_then(|case| case.check(&self.file.robot));
                    checked.map_err(|error| wrong(error.to_string()))?;
                }
            }
        }
        let (mut case, mut motors) = blank(&self.file);
        for (setter, value) in self.setters.iter().zip(&values) {
            setter.set(*value, &mut case, &mut motors);
        }
        Ok(driven(&self.file, case, &motors).unwrap_or_else(|_| self.file.case.clone()))
    }

    /// Whether a row is read from the file again.
    pub(crate) fn reads_file(&self) -> bool {
        self.setters.iter().any(|setter| setter.what == What::Key)
    }

    /// Whether a row is more than a shape without loads.
    fn has_dear_rows(&self) -> bool {
        let CaseFile { case, robot, .. } = &self.file;
        let sets_load = self.setters.iter().any(|setter| setter.what.is_load());
        let is_alone = case.loads.is_none() && case.obstacles.is_empty() && !sets_load;
        self.reads_file() || !is_alone || robot.has_history()
    }

    /// Number of rows.
    #[must_use]
    pub const fn rows(&self) -> u64 {
        self.samples.rows()
    }

    /// Rows of each part but the last.
    #[must_use]
    pub const fn rows_per_part(&self) -> u64 {
        self.rows_per_part
    }

    /// Number of parts.
    #[must_use]
    pub const fn parts(&self) -> u64 {
        self.rows().div_ceil(self.rows_per_part)
    }

    /// The rows of a part.
    pub(crate) const fn rows_of(&self, part: u64) -> (u64, u64) {
        let first = part * self.rows_per_part;
        let rest = self.rows() - first;
        (first, if rest < self.rows_per_part { rest } else { self.rows_per_part })
    }

    /// Of each column its name: number of the row, axes, outputs, then `stable` where it was asked for, and `error`, which says why
    /// a row has no answer.
    #[must_use]
    pub fn column_names(&self) -> Vec<String> {
        let mut names = vec!["row".to_owned()];
        names.extend(self.samples.axes().iter().map(Axis::column));
        names.extend(self.columns.names().iter().cloned());
        if self.columns.has(Output::Stability) {
            names.push("stable".to_owned());
        }
        names.push("error".to_owned());
        names
    }
}

/// The case of a file, and the commands of its motors.
pub(crate) fn blank(file: &CaseFile) -> (Case, Vec<Option<f64>>) {
    let mut case = file.case.clone();
    case.commands.resize_with(file.robot.cables().len(), Default::default);
    let motors = 0..file.robot.motors().len();
    let motors = motors.map(|motor| case.motor_command(motor)).collect();
    (case, motors)
}

/// A case with these commands of the motors.
pub(crate) fn driven(
    file: &CaseFile,
    case: Case,
    motors: &[Option<f64>],
) -> Result<Case, RobotError> {
    match motors.is_empty() {
        true => Ok(case),
        false => case.driven_to(&file.robot, motors),
    }
}
