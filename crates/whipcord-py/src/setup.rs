//! A robot and what is asked of it.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use whipcord::kinematics::{Compliance, DerivativeMethod, DrivenBy};
use whipcord::warning::{of_answer, of_case, of_spacing};
use whipcord::{
    Actuation, BranchOptions, CableCommand, Case, CriticalKind, Differentiable, ModelKind,
    Parameter, Prepared, Robot, Shortening, SolveError, Statics, Warning, over_determined,
};
use whipcord_io::{CaseFile, Goal, Motion};

use crate::convert::{self, array, commands};
use crate::errors;
use crate::file_data::{self, FileData};
use crate::measurement;
use crate::model::Model;
use crate::notice::Notice;
use crate::prepared::PreparedModels;
use crate::solution::Solution;
use crate::wait::{PERIOD, within};

/// A robot and what is asked of it, as one robot file describes them.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Setup {
    pub title: String,
    pub robot: Robot,
    pub case: Arc<Case>,
    pub file_data: FileData,
    /// Models built for the robot. They hold nothing that an answer depends on.
    models: PreparedModels,
    /// Lengths in m of the cables before actuation, by the kinds of models that were asked for them.
    initial_lengths: Mutex<Vec<(ModelKind, Vec<f64>)>>,
}

impl Setup {
    pub fn new(title: String, robot: Robot, case: Arc<Case>) -> Self {
        let (models, initial_lengths) = (PreparedModels::default(), Mutex::default());
        Self { title, robot, case, file_data: FileData::default(), models, initial_lengths }
    }

    fn of_file(file: CaseFile, has_units: bool) -> Self {
        let file_data = FileData::of(&file, has_units);
        let CaseFile { title, robot, case, .. } = file;
        Self { file_data, ..Self::new(title, robot, Arc::new(case)) }
    }

    /// Has a model work that was built before, or is built now. Several threads may do this at once.
    pub fn with<T>(
        &self,
        model: &whipcord::Model,
        work: impl FnOnce(&mut Prepared) -> Result<T, SolveError>,
    ) -> Result<T, SolveError> {
        self.models.with(model, &self.robot, &self.case.loads, work)
    }

    /// As [`Self::with`], for what may take long: Ctrl-C ends it, and so does the time limit of the model. A thread costs as much as a few
    /// easy answers, so what was quick the last time is done without.
    pub fn watched<T: Send + 'static>(
        this: &Bound<'_, Self>,
        model: &Model,
        work: impl FnOnce(&mut Prepared) -> Result<T, SolveError> + Send + 'static,
    ) -> PyResult<T> {
        let (py, setup) = (this.py(), this.get());
        let (model, limit) = model.begin();
        let cancel = limit.cancel.clone();
        let work = move |prepared: &mut Prepared| {
            prepared.set_cancel(&cancel);
            work(prepared)
        };
        let quick = setup.models.was_quick(&model);
        let begun = Instant::now();
        let answer = if quick && !limit.is_timed() {
            py.detach(|| setup.with(&model, work))
        } else {
            let (setup, model) = (this.clone().unbind(), model.clone());
            within(py, &limit, move || setup.get().with(&model, work))?
        };
        setup.models.note_quick(&model, begun.elapsed() < PERIOD);
        answer.map_err(|error| errors::solve(py, &error))
    }

    /// The case with other commands of cables and motors.
    pub fn commanded(
        &self,
        tension: Option<&Bound<'_, PyAny>>,
        shortening: Option<&Bound<'_, PyAny>>,
        motors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Arc<Case>> {
        let case = match commands(&self.robot, tension, shortening)? {
            Some(commands) => Arc::new(self.case.commanded(commands)),
            None => Arc::clone(&self.case),
        };
        let Some(given) = motors else { return Ok(case) };
        let commands = convert::motor_commands(&self.robot, given)?;
        let driven = case.driven_to(&self.robot, &commands);
        Ok(Arc::new(driven.map_err(|error| errors::robot(given.py(), &error))?))
    }

    /// How another robot moves over time, with the damping of this one. Commands of single cables and motors are those of the same ones.
    fn moving_as(&self, other: &Self) -> Motion {
        let cables = |of: &Self| of.robot.cables().iter().map(|of| of.name.clone()).collect();
        let motors = |of: &Self| of.robot.motors().iter().map(|of| of.name.clone()).collect();
        let is_same = |names: &dyn Fn(&Self) -> Vec<String>| names(self) == names(other);
        let mut motion = other.file_data.motion.clone();
        motion.damping = self.file_data.motion.damping.clone();
        if !is_same(&cables) || !is_same(&motors) {
            motion.cables.clear();
            motion.motors.clear();
        }
        motion
    }

    /// The same title and motion with another robot and case.
    fn moving(&self, robot: Robot, case: Arc<Case>) -> Self {
        let motion = self.file_data.motion.clone();
        let setup = Self::new(self.title.clone(), robot, case);
        Self { file_data: FileData { motion, ..FileData::default() }, ..setup }
    }

    /// How many disks an answer has.
    pub fn station_disks(&self) -> usize {
        self.robot.disks().count()
    }

    /// Arc lengths in m at which a model gives the shape.
    pub fn station_list(&self, py: Python<'_>, model: &Model) -> PyResult<Vec<f64>> {
        let stations = self.with(&model.inner, |prepared| Ok(prepared.stations().to_vec()));
        stations.map_err(|error| errors::solve(py, &error))
    }
}

fn notices<'py>(py: Python<'py>, found: &[Warning]) -> PyResult<Bound<'py, PyList>> {
    let notices: Vec<Notice> = found.iter().map(Notice::of).collect();
    PyList::new(py, notices.iter().map(Notice::row))
}

#[pymethods]
impl Setup {
    /// Reads a robot file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = py.detach(|| whipcord_io::load(&path));
        let kept = |file: CaseFile| {
            let mut setup = Self::of_file(file.clone(), true);
            setup.file_data.file = Some(Arc::new(file));
            setup
        };
        file.map(kept).map_err(|error| errors::file(py, &error, &path.display().to_string()))
    }

    /// Reads the text of a robot file; the files it names are looked for in the folder of `name`.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, name: PathBuf) -> PyResult<Self> {
        let file = whipcord_io::parse(text, &name);
        file.map(|file| Self::of_file(file, true))
            .map_err(|error| errors::file(py, &error, &name.display().to_string()))
    }

    /// What a robot file with these tables describes.
    #[staticmethod]
    fn of_tables(py: Python<'_>, tables: &Bound<'_, PyDict>, of: &str) -> PyResult<Self> {
        let text = whipcord_io::toml(&convert::to_table(tables, of)?);
        let file = whipcord_io::parse(&text, of);
        file.map(|file| Self::of_file(file, false))
            .map_err(|error| errors::arguments(py, &error, of))
    }

    /// The tables of a robot file that describes it, in SI.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        if !self.case.loads_before.is_empty() {
            let message = "the loads differ from step to step, which only the file with its table of commands says";
            return Err(errors::input(py, "case", message.to_owned()));
        }
        let title = (!self.title.trim().is_empty()).then_some(self.title.as_str());
        let table = whipcord_io::describe(title, &self.robot, &self.case);
        let mut table = table.map_err(|error| errors::input(py, "case", error.to_string()))?;
        table.insert_some("fit", self.file_data.fit.as_ref().map(whipcord_io::describe_fit));
        // A shape or a path is in a file of its own, which need not be where the text goes.
        let is_here = self.file_data.goal.table.is_none();
        let target = self.file_data.goal.target.clone().filter(|_| is_here);
        let goal = Goal { target, path: Vec::new(), ..self.file_data.goal.clone() };
        whipcord_io::describe_goal(&goal, &mut table);
        let motion = whipcord_io::describe_motion(&self.file_data.motion, &self.robot, &mut table);
        motion.map_err(|error| errors::input(py, "motion", error.to_string()))?;
        convert::from_table(py, &table)
    }

    #[getter]
    fn title(&self) -> &str {
        &self.title
    }

    /// Warnings about it: code, message, help, and path, line and column of each.
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        match &self.file_data.notices {
            Some(notices) => PyList::new(py, notices.iter().map(Notice::row)),
            None => notices(py, &of_case(&self.robot, &self.case)),
        }
    }

    /// The same about an answer.
    fn answer_warnings<'py>(&self, py: Python<'py>, of: &Solution) -> PyResult<Bound<'py, PyList>> {
        let found = py.detach(|| of_answer(&self.robot, &of.case, &of.inner));
        notices(py, &found)
    }

    /// The same about what the spacing of the disks changes, which costs a solve.
    fn spacing_warnings<'py>(
        &self,
        py: Python<'py>,
        model: &Model,
        of: &Solution,
    ) -> PyResult<Bound<'py, PyList>> {
        let found = py.detach(|| of_spacing(&model.inner, &self.robot, &of.case, &of.inner));
        notices(py, found.as_slice())
    }

    /// What was measured: numbers of the disks, from 1, their (k, 3) positions in m, and what the table says
    /// beside them.
    #[getter]
    fn measured<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let measured = self.file_data.measured.as_deref();
        measured.map(|measured| measurement::measured(py, measured)).transpose()
    }

    /// What others have published for this case.
    #[getter]
    fn reference<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let reference = self.file_data.reference.as_deref();
        reference.map(|reference| file_data::reference(py, reference)).transpose()
    }

    /// Arc lengths of the disks in m.
    fn disks(&self) -> Vec<f64> {
        self.robot.disks().arc_lengths.clone()
    }

    /// Where the base is, in m.
    fn base(&self) -> [f64; 3] {
        self.case.base.position.to_array()
    }

    /// The same, with what a file says beside robot and case from another: the unknowns, and if asked for what
    /// was measured and published.
    fn beside(&self, other: &Self, measured: bool, reference: bool) -> Self {
        let of = &other.file_data;
        let file_data = FileData {
            measured: of.measured.clone().filter(|_| measured),
            reference: of.reference.clone().filter(|_| reference),
            fit: of.fit.clone(),
            goal: Goal {
                // Limits of single cables are those of the same cables.
                own: if self.robot.cables().len() == other.robot.cables().len() {
                    of.goal.own.clone()
                } else {
                    Vec::new()
                },
                ..of.goal.clone()
            },
            motion: self.moving_as(other),
            file: None,
            notices: self.file_data.notices.clone(),
        };
        let setup = Self::new(self.title.clone(), self.robot.clone(), Arc::clone(&self.case));
        Self { file_data, ..setup }
    }

    /// The same, with what another one is to reach, and within which limits.
    fn beside_goal(&self, other: &Self) -> Self {
        let goal = other.file_data.goal.clone();
        let (path, table) = (self.file_data.goal.path.clone(), self.file_data.goal.table.clone());
        // The tables of a case have no files.
        let goal = match goal.target {
            Some(_) => goal,
            None => Goal { target: self.file_data.goal.target.clone(), path, table, ..goal },
        };
        let setup = Self::new(self.title.clone(), self.robot.clone(), Arc::clone(&self.case));
        Self { file_data: FileData { goal, ..self.file_data.clone() }, ..setup }
    }

    /// The same, with the measurement of these values, which are those that `measured` has given.
    fn with_measured(&self, measured: &Bound<'_, PyDict>) -> PyResult<Self> {
        let measured = Some(Arc::new(measurement::measured_of(measured)?));
        let setup = Self::new(self.title.clone(), self.robot.clone(), Arc::clone(&self.case));
        let file_data = FileData { measured, file: None, ..self.file_data.clone() };
        Ok(Self { file_data, ..setup })
    }

    /// Arc lengths in m at which a model gives the shape.
    fn stations<'py>(&self, py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let stations = self.station_list(py, model)?;
        let count = stations.len();
        array(py, stations, [count])
    }

    /// The answer, after all steps of the case unless it starts from another answer.
    #[pyo3(signature = (model, tension = None, shortening = None, motors = None, start = None, least_squares = false))]
    fn solve(
        slf: &Bound<'_, Self>,
        model: &Model,
        tension: Option<&Bound<'_, PyAny>>,
        shortening: Option<&Bound<'_, PyAny>>,
        motors: Option<&Bound<'_, PyAny>>,
        start: Option<&Solution>,
        least_squares: bool,
    ) -> PyResult<Solution> {
        let case = slf.get().commanded(tension, shortening, motors)?;
        let chosen = model.inner.clone();
        let start = start.map(|solution| Arc::clone(&solution.inner));
        let of = Arc::clone(&case);
        let answer = Self::watched(slf, model, move |prepared| {
            let solved = match start {
                None => prepared.solve_to_the_end(&of).map_err(|(_, error)| error),
                Some(start) => prepared.solve(&of, Some(&start)),
            };
            match least_squares && of.before.is_empty() {
                true => over_determined::or(solved, &chosen, prepared.robot(), &of),
                false => solved,
            }
        })?;
        Ok(Solution::new(answer, &case))
    }

    /// The answers to all steps of the case.
    #[pyo3(signature = (model, tension = None, shortening = None, motors = None))]
    fn solve_steps(
        slf: &Bound<'_, Self>,
        model: &Model,
        tension: Option<&Bound<'_, PyAny>>,
        shortening: Option<&Bound<'_, PyAny>>,
        motors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<Solution>> {
        let case = slf.get().commanded(tension, shortening, motors)?;
        let of = Arc::clone(&case);
        let answers = Self::watched(slf, model, move |prepared| {
            let mut all = Vec::new();
            prepared.solve_steps(&of, |solution| all.push(solution)).map_err(|(_, e)| e)?;
            Ok(all)
        })?;
        let answers = answers.into_iter().enumerate();
        Ok(answers.map(|(step, answer)| Solution::of_step(answer, &case, step)).collect())
    }

    /// Length in m of each cable inside the robot before anything pulls or loads it.
    fn initial_lengths(&self, py: Python<'_>, model: &Model) -> PyResult<Vec<f64>> {
        let kind = model.inner.kind();
        {
            // What panics elsewhere leaves the list whole.
            let known = self.initial_lengths.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some((_, lengths)) = known.iter().find(|(of, _)| *of == kind) {
                return Ok(lengths.clone());
            }
        }
        let count = self.robot.cables().len();
        let slack = match kind.natural_actuation() {
            Actuation::Shortening => Case::with_shortenings(&vec![Shortening::Length(0.0); count]),
            Actuation::Natural | Actuation::Tension => Case::with_tensions(&vec![0.0; count]),
        };
        let model = whipcord::Model::new(kind, Default::default(), Default::default());
        let answer = model.solve(&self.robot, &slack).map_err(|error| errors::solve(py, &error))?;
        let lengths: Vec<_> = answer.cables.iter().map(|cable| cable.initial_length).collect();
        let mut known = self.initial_lengths.lock().unwrap_or_else(PoisonError::into_inner);
        known.push((kind, lengths.clone()));
        Ok(lengths)
    }

    /// (m, 3) points of each cable over an answer.
    fn cable_paths<'py>(
        &self,
        py: Python<'py>,
        solution: &Solution,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let paths = solution.cable_paths(&self.robot).into_iter();
        paths
            .map(|points| {
                let count = points.len() / 3;
                array(py, points, [count, 3])
            })
            .collect()
    }

    /// What each motor of the robot was told and holds in an answer.
    fn motors<'py>(&self, py: Python<'py>, of: &Solution) -> PyResult<Bound<'py, PyList>> {
        of.motors(py, &self.robot)
    }

    /// The cables that pass through obstacles in an answer.
    fn cable_overlaps<'py>(
        &self,
        py: Python<'py>,
        solution: &Solution,
    ) -> PyResult<Bound<'py, PyList>> {
        solution.cable_overlaps(py, &self.robot)
    }

    /// The robot with what was asked of it for an answer.
    fn of_answer(&self, solution: &Solution) -> Self {
        self.moving(self.robot.clone(), solution.answered())
    }

    /// The same, with the command alone of each cable that the model took, lengths in m: what another model, or a viewer, is to
    /// take as well.
    fn as_driven(&self, py: Python<'_>, solution: &Solution, model: &Model) -> PyResult<Self> {
        let answer = &solution.inner;
        let by_tension = match model.actuation(py)?.as_deref() {
            Some(named) => named == "tension",
            None => answer.model.natural_actuation() == Actuation::Tension,
        };
        // The motors have shortened the cables already.
        let mut case = Case { motors: Vec::new(), ..(*solution.case).clone() };
        for commands in case.before.iter_mut().chain([&mut case.commands]) {
            for (command, cable) in commands.iter_mut().zip(&answer.cables) {
                let in_metres =
                    |given: Shortening| Shortening::Length(given.in_metres(cable.initial_length));
                let shortening = command.shortening.map(in_metres);
                *command = match command.tension {
                    tension @ Some(_) if by_tension || shortening.is_none() => {
                        CableCommand { tension, shortening: None }
                    }
                    _ => CableCommand { tension: None, shortening },
                };
            }
        }
        Ok(Self::new(self.title.clone(), self.robot.clone(), Arc::new(case)))
    }

    /// The value of a parameter, by its path.
    fn parameter(&self, py: Python<'_>, path: &str) -> PyResult<f64> {
        let value = parameter(py, path)?.value(&self.robot, &self.case);
        value.map_err(|error| errors::robot(py, &error))
    }

    /// The same with these parameters changed to these values.
    fn with_parameters(&self, py: Python<'_>, values: Vec<(String, f64)>) -> PyResult<Self> {
        let (mut robot, mut case) = (self.robot.clone(), (*self.case).clone());
        for (path, value) in values {
            let changed = parameter(py, &path)?.changed_to(&robot, &case, value);
            (robot, case) = changed.map_err(|error| errors::robot(py, &error))?;
        }
        Ok(self.moving(robot, Arc::new(case)))
    }

    /// How a place at this arc length in m moves and yields.
    #[pyo3(signature = (model, arc_length, tension = None, shortening = None, motors = None))]
    fn local<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        model: &Model,
        arc_length: Option<f64>,
        tension: Option<&Bound<'_, PyAny>>,
        shortening: Option<&Bound<'_, PyAny>>,
        motors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Solution, Bound<'py, PyDict>)> {
        let case = slf.get().commanded(tension, shortening, motors)?;
        let at = arc_length.unwrap_or(slf.get().robot.backbone().length);
        let (model, limit) = model.begin();
        let (setup, of) = (slf.clone().unbind(), Arc::clone(&case));
        let answer = within(py, &limit, move || model.solve_at(&setup.get().robot, &of, at))?;
        let (solution, local) = answer.map_err(|error| errors::solve(py, &error))?;
        let values = PyDict::new(py);
        values.set_item("arc_length", at)?;
        values.set_item("jacobian", convert::jacobian(py, &local.actuation_jacobian)?)?;
        let driven_by = local.driven_by.iter().map(|driven_by| match driven_by {
            DrivenBy::Tension => "tension",
            DrivenBy::Shortening => "shortening",
        });
        values.set_item("driven_by", driven_by.collect::<Vec<_>>())?;
        values.set_item("length_jacobian", convert::square(py, &local.length_jacobian)?)?;
        let yielding = |name: &str, of: &Compliance| -> PyResult<()> {
            let compliance = convert::matrix6(py, &of.compliance)?;
            values.set_item(format!("compliance_{name}"), compliance)?;
            let stiffness = of.stiffness.as_ref().map(|k| convert::matrix6(py, k)).transpose()?;
            values.set_item(format!("stiffness_{name}"), stiffness)
        };
        match &local.compliances {
            Ok(yields) => {
                yielding("tensions_held", &yields.tensions_held)?;
                yielding("lengths_held", &yields.lengths_held)?;
            }
            Err(unknown) => values.set_item("yield_unknown", unknown.to_string())?,
        }
        let error = match local.method {
            DerivativeMethod::Exact => None,
            DerivativeMethod::Differences { error } => Some(error),
        };
        values.set_item("estimated_error", error)?;
        values.set_item("one_sided", local.one_sided.names().collect::<Vec<_>>())?;
        values.set_item("lengths_dependent", local.are_lengths_dependent)?;
        let dexterity = PyList::empty(py);
        for (driven_by, of) in local.dexterity() {
            let kind = PyDict::new(py);
            let name = if driven_by == DrivenBy::Tension { "tension" } else { "shortening" };
            kind.set_item("driven_by", name)?;
            kind.set_item("manipulability", of.manipulability)?;
            kind.set_item("directions", of.directions)?;
            kind.set_item("condition", of.condition)?;
            dexterity.append(kind)?;
        }
        values.set_item("dexterity", dexterity)?;
        Ok((Solution::new(solution, &case), values))
    }

    /// All equilibria on the path from no load and on the branches off it: (branch, stable, solution) of
    /// each, (branch, load, kind, tip) of each critical point, and whether every branch was followed.
    #[pyo3(signature = (model, tension = None, shortening = None, motors = None))]
    #[expect(clippy::type_complexity, reason = "rows of a table")]
    fn branches(
        slf: &Bound<'_, Self>,
        model: &Model,
        tension: Option<&Bound<'_, PyAny>>,
        shortening: Option<&Bound<'_, PyAny>>,
        motors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(
        Vec<(Option<usize>, Option<bool>, Solution)>,
        Vec<(usize, f64, &'static str, [f64; 3])>,
        bool,
    )> {
        let case = slf.get().commanded(tension, shortening, motors)?;
        let of = Arc::clone(&case);
        let found = Self::watched(slf, model, move |prepared| {
            prepared.branches(&of, &BranchOptions::default())
        })?;
        let equilibria = found.equilibria.into_iter().map(|equilibrium| {
            (equilibrium.branch, equilibrium.stable, Solution::new(equilibrium.solution, &case))
        });
        let points = found.critical_points.into_iter().map(|point| {
            let kind = match point.kind {
                CriticalKind::Limit => "limit",
                CriticalKind::CableSlackens => "cable-slackens",
                CriticalKind::Bifurcation(_) => "bifurcation",
            };
            (point.branch, point.load, kind, point.tip.to_array())
        });
        Ok((equilibria.collect(), points.collect(), found.complete))
    }
}

/// The parameter of this path.
pub fn parameter(py: Python<'_>, path: &str) -> PyResult<Parameter> {
    path.parse().map_err(|error: whipcord::UnknownParameter| {
        let message = match whipcord_io::nearest_parameter(path) {
            Some(near) => format!("there is no parameter `{path}`: did you mean `{near}`?"),
            None => error.to_string(),
        };
        errors::input(py, "parameters", message)
    })
}
