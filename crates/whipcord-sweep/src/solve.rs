//! The answers to the rows of a part.

use rayon::prelude::*;
use whipcord::batch::{BatchOptions, Rows, solve_batch};
use whipcord::{Actuation, Case, Prepared, SolveError};
use whipcord_io::CaseFile;

use crate::error::SweepError;
use crate::outputs::Output;
use crate::plan::{Plan, blank, driven};
use crate::setter::What;

/// The rows of a part.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub first: u64,
    /// Rows × axes, in the units of the axes.
    pub inputs: Vec<f64>,
    /// Rows × columns; NaN in a row without an answer.
    pub numbers: Vec<f64>,
    pub outcomes: Vec<Outcome>,
}

/// What became of a row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    /// Whether the equilibrium is stable, where that was asked for and is known.
    pub stable: Option<bool>,
    /// Why there is no answer.
    pub error: Option<String>,
}

impl Plan {
    /// The answers to so many rows from a first one.
    pub(crate) fn solve(&self, (first, count): (u64, u64)) -> Result<Part, SweepError> {
        let width = self.samples.axes().len();
        #[expect(clippy::cast_possible_truncation, reason = "a part fits into memory")]
        let count = count as usize;
        let mut inputs = Vec::with_capacity(count * width);
        (0..count).for_each(|row| self.samples.push(first + row as u64, &mut inputs));
        let by_row = self.reads_file() || self.columns.has(Output::Jacobian);
        let (numbers, outcomes) = match (by_row, self.tensions(&inputs)) {
            (true, _) => self.row_by_row(&inputs),
            (false, Some(values)) => {
                let case = &self.file.case;
                self.batch(Rows::Tensions { values: &values, case })?
            }
            (false, None) => {
                let cases = inputs.chunks_exact(width).map(|values| self.case(&self.file, values));
                let (mut cases, mut wrong) = (cases.collect::<Vec<_>>(), Vec::new());
                let mut good = Vec::with_capacity(count);
                for (row, case) in cases.drain(..).enumerate() {
                    match case {
                        Ok(case) => good.push(case),
                        Err(error) => {
                            // Its place is kept by a case that is solved for nothing.
                            wrong.push((row, error));
                            good.push(self.file.case.clone());
                        }
                    }
                }
                let (mut numbers, mut outcomes) = self.batch(Rows::Cases(&good))?;
                let width = self.columns.names().len();
                for (row, error) in wrong {
                    numbers[row * width..(row + 1) * width].fill(f64::NAN);
                    outcomes[row] = Outcome { stable: None, error: Some(error) };
                }
                (numbers, outcomes)
            }
        };
        Ok(Part { first, inputs, numbers, outcomes })
    }

    /// The tensions of all cables in all rows, where nothing but tensions varies and every cable has one.
    fn tensions(&self, inputs: &[f64]) -> Option<Vec<f64>> {
        let case = &self.file.case;
        let cables = self.file.robot.cables().len();
        let by_tension = match self.model.actuation() {
            Actuation::Natural => self.model.kind().natural_actuation(),
            given => given,
        };
        if !case.motors.is_empty() || by_tension != Actuation::Tension {
            return None;
        }
        let mut blank = vec![None; cables];
        for (of, command) in blank.iter_mut().zip(&case.commands) {
            *of = command.tension;
        }
        for setter in &self.setters {
            let (cable, _) = setter.tension(0.0)?;
            blank[cable] = Some(0.0);
        }
        let blank = blank.into_iter().collect::<Option<Vec<f64>>>()?;
        let mut values = Vec::with_capacity(inputs.len() / self.setters.len() * cables);
        for row in inputs.chunks_exact(self.setters.len()) {
            let first = values.len();
            values.extend_from_slice(&blank);
            for (setter, value) in self.setters.iter().zip(row) {
                if let Some((cable, tension)) = setter.tension(*value) {
                    values[first + cable] = tension;
                }
            }
        }
        Some(values)
    }

    /// The case with the values of a row that are commands and loads.
    fn case(&self, file: &CaseFile, values: &[f64]) -> Result<Case, String> {
        let (mut case, mut motors) = blank(file);
        for (setter, value) in self.setters.iter().zip(values) {
            setter.set(*value, &mut case, &mut motors);
        }
        driven(file, case, &motors).map_err(|error| error.to_string())
    }

    fn batch(&self, rows: Rows<'_>) -> Result<(Vec<f64>, Vec<Outcome>), SweepError> {
        let batch = solve_batch(&self.model, &self.file.robot, rows, &BatchOptions::default())?;
        let width = self.columns.names().len();
        let mut numbers = Vec::with_capacity(batch.len() * width);
        let mut outcomes = Vec::with_capacity(batch.len());
        for row in 0..batch.len() {
            match batch.row(row) {
                Some(Ok(found)) => {
                    self.columns.push_row(&found, &mut numbers);
                    outcomes.push(Outcome { stable: found.diagnostics.stable, error: None });
                }
                Some(Err(error)) => {
                    numbers.resize((row + 1) * width, f64::NAN);
                    outcomes.push(Outcome::failed(error));
                }
                None => {}
            }
        }
        Ok((numbers, outcomes))
    }

    fn row_by_row(&self, inputs: &[f64]) -> (Vec<f64>, Vec<Outcome>) {
        let rows: Vec<&[f64]> = inputs.chunks_exact(self.samples.axes().len()).collect();
        let width = self.columns.names().len();
        let answers: Vec<(Vec<f64>, Outcome)> = rows
            .par_iter()
            .map_init(
                || None,
                |prepared, values| {
                    let mut numbers = Vec::with_capacity(width);
                    let outcome = match self.row(values, prepared, &mut numbers) {
                        Ok(stable) => Outcome { stable, error: None },
                        Err(reason) => {
                            numbers.clear();
                            numbers.resize(width, f64::NAN);
                            Outcome { stable: None, error: Some(reason) }
                        }
                    };
                    (numbers, outcome)
                },
            )
            .collect();
        let (mut numbers, mut outcomes) = (Vec::with_capacity(rows.len() * width), Vec::new());
        for (of_row, outcome) in answers {
            numbers.extend(of_row);
            outcomes.push(outcome);
        }
        (numbers, outcomes)
    }

    /// The numbers of one row, from cold. `prepared` is the model of the file's own robot, made by the first row of a thread.
    fn row(
        &self,
        values: &[f64],
        prepared: &mut Option<Prepared>,
        numbers: &mut Vec<f64>,
    ) -> Result<Option<bool>, String> {
        let axes = self.samples.axes().iter();
        let keys = axes.zip(&self.setters).zip(values);
        let keys = keys.filter(|((_, setter), _)| setter.what == What::Key);
        let settings: Vec<String> = keys.map(|((axis, _), value)| axis.setting(*value)).collect();
        if settings.is_empty() {
            return self.row_of(&self.file, values, prepared, numbers);
        }
        let file = self.file.with_settings(&settings).map_err(|error| error.to_string())?;
        self.row_of(&file, values, &mut None, numbers)
    }

    /// The same of a file with the keys of the row.
    fn row_of(
        &self,
        file: &CaseFile,
        values: &[f64],
        prepared: &mut Option<Prepared>,
        numbers: &mut Vec<f64>,
    ) -> Result<Option<bool>, String> {
        let words = |error: SolveError| error.to_string();
        let case = self.case(file, values)?;
        let model = match prepared {
            Some(model) => model,
            none => none.insert(self.model.prepare(&file.robot, &case.loads).map_err(words)?),
        };
        let (solution, rates) = if self.columns.has(Output::Jacobian) {
            let found = model.solve_with_derivatives(&case, None, &[]).map_err(words)?;
            (found.0, Some(found.1))
        } else {
            (model.solve(&case, None).map_err(words)?, None)
        };
        let written = self.columns.push_solution(&case, &solution, rates.as_ref(), numbers);
        written.ok_or(
            "this row has another number of disks or cables than the file, for which the columns are",
        )?;
        Ok(solution.diagnostics.stable)
    }
}

impl Outcome {
    fn failed(error: &SolveError) -> Self {
        Self { stable: None, error: Some(error.to_string()) }
    }
}
