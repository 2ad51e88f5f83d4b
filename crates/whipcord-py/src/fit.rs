//! What a robot is, from what was measured.

use std::num::NonZero;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use whipcord::{Model as Method, Pose, Robot};
use whipcord_estimation::identification::{
    Asked, Experiment, IdentifyError, Prior, Robustness, Settings, Unknown, analyse, identify,
    registered, split,
};
use whipcord_io::{CaseFile, Fit, Mounting};
use whipcord_study::fitting::{self, not_converged};

use crate::errors;
use crate::file_data::FileData;
use crate::model::Model;
use crate::setup::Setup;
use crate::wait::within;

/// What was fitted.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Fitted {
    inner: fitting::Fit,
    file_data: Vec<FileData>,
}

/// An unknown: its path, where to start, least and greatest value, and what it is known to be within which
/// deviation; a path alone where the files say the rest.
type AskedUnknown = (String, bool, Option<f64>, Option<f64>, Option<f64>, Option<[f64; 2]>);

/// Fits the cases, which are of one robot.
#[pyfunction]
#[pyo3(signature = (
    setups, model, parameters, each, loss, confidence, iterations, validate, models, test, part, ladder, profile, skip,
    one_frame, starts, threads
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn fit(
    py: Python<'_>,
    setups: Vec<PyRef<'_, Setup>>,
    model: &Model,
    parameters: Vec<AskedUnknown>,
    each: Vec<AskedUnknown>,
    loss: &str,
    confidence: f64,
    iterations: usize,
    validate: bool,
    models: Vec<PyRef<'_, Model>>,
    test: Vec<PyRef<'_, Setup>>,
    part: Option<(f64, u64)>,
    ladder: bool,
    profile: bool,
    skip: bool,
    one_frame: bool,
    starts: usize,
    threads: Option<usize>,
) -> PyResult<Fitted> {
    let Some((first, others)) = setups.split_first() else {
        return Err(errors::input(py, "cases", "there is no case to fit".to_owned()));
    };
    let paths = (1..setups.len()).map(|i| format!("cases[{i}]"));
    let paths = paths.chain((0..test.len()).map(|i| format!("test[{i}]")));
    for (path, other) in paths.zip(others.iter().chain(&test)) {
        if let Some(what) = first.robot.differs_in(&other.robot) {
            let message = format!("{path} is of another robot than cases[0]: the {what} differ");
            return Err(errors::input(py, &path, message));
        }
    }
    let measurements = |setups: &[PyRef<'_, Setup>], of: &str| -> PyResult<Vec<Experiment>> {
        let all = setups.iter().enumerate();
        all.map(|(i, setup)| experiment(py, &format!("{of}[{i}]"), setup)).collect()
    };
    let experiments = measurements(&setups, "cases")?;
    let files: Vec<Option<&Fit>> =
        setups.iter().map(|setup| setup.file_data.fit.as_ref()).collect();
    let unknowns = if parameters.is_empty() && each.is_empty() {
        Fit::together(&files)
    } else {
        let all = |asked: Vec<AskedUnknown>| {
            asked
                .into_iter()
                .map(|one| unknown(py, &first.robot, &files, one))
                .collect::<PyResult<Vec<_>>>()
        };
        Fit { shared: all(parameters)?, each: all(each)? }.of_all(setups.len())
    };
    if unknowns.is_empty() {
        let message = "nothing is to be estimated: give parameters, such as \"backbone.diameter\", or [fit] in the file";
        return Err(errors::input(py, "parameters", message.to_owned()));
    }
    let robustness = match loss {
        "squares" => Robustness::Squares,
        "huber" => Robustness::Huber,
        "soft-l1" => Robustness::SoftL1,
        "cauchy" => Robustness::Cauchy,
        other => {
            let message =
                format!("there is no loss `{other}`: choose squares, huber, soft-l1 or cauchy");
            return Err(errors::input(py, "loss", message));
        }
    };
    let (method, limit) = model.begin();
    let settings = Settings {
        robustness,
        confidence,
        iterations,
        skips: skip,
        starts,
        threads: threads.and_then(NonZero::new),
        ..Settings::new(method)
    };
    let cases: Vec<CaseFile> =
        setups.iter().enumerate().map(|(i, setup)| file(py, i, setup)).collect::<PyResult<_>>()?;
    let file_data = setups.iter().map(|setup| setup.file_data.clone()).collect();
    let models: Vec<Method> =
        models.iter().map(|model| model.inner.cancelled_by(&limit.cancel)).collect();
    let robot = first.robot.clone();
    let asked = (experiments, unknowns);
    let registering = settings.clone();
    let of_robot = robot.clone();
    let registered = within(py, &limit, move || {
        registered(&of_robot, &asked.0, &asked.1, one_frame, &registering)
    })?;
    let (mut experiments, unknowns) =
        registered.map_err(|error| errors::identify(py, &error, setups.len()))?;
    let mut held = None;
    if let Some((fraction, seed)) = part {
        let parts = split(&experiments, fraction, seed);
        let [kept, rest] = parts.map_err(|error| errors::identify(py, &error, setups.len()))?;
        experiments = kept;
        held = Some((rest, true));
    } else if !test.is_empty() {
        held = Some((measurements(&test, "test")?, false));
    }
    let test_paths: Vec<PathBuf> = (1..=test.len()).map(|i| format!("test-{i}").into()).collect();
    let asked =
        Asked { cross_validates: validate, models, climbs: ladder, profiles: profile, test: held };
    let inner = within(py, &limit, move || -> Result<fitting::Fit, IdentifyError> {
        let found = identify(&robot, &experiments, &unknowns, &settings)?;
        // What has not converged is refused below.
        let asked = if found.status.is_converged() { asked } else { Asked::default() };
        let analyses = analyse(&robot, &experiments, &unknowns, &settings, &found, &asked)?;
        Ok(fitting::Fit::new(&settings.model, cases, experiments, found, analyses, &test_paths))
    })?;
    let inner = inner.map_err(|error| errors::identify(py, &error, setups.len()))?;
    if !inner.found.status.is_converged() {
        let message = not_converged(&inner.names, &inner.found);
        return Err(errors::fit_not_converged(py, message, &inner.found));
    }
    Ok(Fitted { inner, file_data })
}

#[pymethods]
impl Fitted {
    /// What `whipcord fit --json` prints.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        let json = self.inner.json();
        let json = json.map_err(|error| errors::input(py, "fit", error.to_string()))?;
        Ok(json.to_string())
    }

    /// Of each observation that is left the number of its case and its step, both from 0, its arc length in m,
    /// and the number of its camera.
    fn places(&self) -> Vec<(usize, usize, f64, Option<usize>)> {
        let fitting::Fit { cases, experiments, found, .. } = &self.inner;
        let place = |residual: &whipcord_estimation::identification::Residual| {
            let seen = &experiments[residual.experiment].observations[residual.observation];
            let arc_length = seen.place.arc_length(cases[residual.experiment].robot.disks());
            let camera = match seen.seen {
                whipcord_estimation::Seen::Pixel { camera, .. } => Some(camera),
                _ => None,
            };
            (residual.experiment, seen.step, arc_length, camera)
        };
        found.residuals.iter().map(place).collect()
    }

    /// The cases with the estimates.
    fn setups(&self) -> Vec<Setup> {
        let fitting::Fit { cases, found, .. } = &self.inner;
        let all = cases.iter().zip(&found.cases).zip(&self.file_data);
        all.map(|((file, case), file_data)| {
            let file_data = FileData { file: None, reference: None, ..file_data.clone() };
            let mut setup =
                Setup::new(file.title.clone(), found.robot.clone(), Arc::new(case.clone()));
            setup.file_data = file_data;
            setup
        })
        .collect()
    }

    /// The text of the file of a case with the estimates in their places, for this folder; None where there is no
    /// file, or it has no place for one of them.
    fn text(&self, py: Python<'_>, number: usize, folder: PathBuf) -> PyResult<Option<String>> {
        let Some(file) = &self.file_data[number].file else { return Ok(None) };
        let found = &self.inner.found;
        let mounting = Mounting { offset: found.marker_offset(number), body: found.bodies[number] };
        let text = file.with_numbers_of(&found.robot, &found.cases[number], mounting, &folder);
        let text = text.map_err(|error| errors::input(py, "case", error.to_string()))?;
        Ok(text.keeps_text.then_some(text.text))
    }

    /// Writes report, figures and CSV to a folder, and returns the path of the report.
    fn report(&self, py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
        let written = py.detach(|| self.inner.write_report(&folder));
        written.map_err(|message| errors::os(&message))
    }
}

/// What was measured in a case.
fn experiment(py: Python<'_>, path: &str, setup: &Setup) -> PyResult<Experiment> {
    let measured = setup.file_data.measured.as_ref().filter(|m| !m.observations.is_empty());
    let Some(measured) = measured else {
        let message = format!(
            "{path} has no measurements: give them by `with_measured`, or [measured] in its file"
        );
        return Err(errors::input(py, path, message));
    };
    let file = setup.file_data.file.as_ref();
    Ok(Experiment {
        name: file.map_or_else(|| path.to_owned(), |file| file.path.display().to_string()),
        case: (*setup.case).clone(),
        cameras: measured.cameras.iter().map(|of| of.camera).collect(),
        observations: measured.fitted(),
        body: measured.body,
        alignment: measured.alignment,
        frame: Pose::IDENTITY,
        labels: file.map(|file| file.row_labels()).unwrap_or_default(),
        ..Experiment::default()
    })
}

fn unknown(
    py: Python<'_>,
    robot: &Robot,
    files: &[Option<&Fit>],
    (path, alone, start, least, greatest, prior): AskedUnknown,
) -> PyResult<Unknown> {
    let named = whipcord_io::parameter_path(&path).map_err(|near| {
        let near = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
        let message = format!("`{path}` is nothing that can be estimated{near}");
        errors::input(py, "parameters", message)
    })?;
    let unknown = named.unknown(robot);
    let unknown = unknown.map_err(|error| errors::input(py, "parameters", error.to_string()))?;
    if alone {
        return Ok(Fit::known(files, unknown));
    }
    Ok(Unknown {
        start,
        bounds: [least.unwrap_or(f64::NEG_INFINITY), greatest.unwrap_or(f64::INFINITY)],
        prior: prior.map(|[mean, deviation]| Prior { mean, deviation }),
        ..unknown
    })
}

/// The file of a case; one that was made in Python has none, and gets the text that it would be saved as.
pub fn file(py: Python<'_>, i: usize, setup: &Setup) -> PyResult<CaseFile> {
    if let Some(file) = &setup.file_data.file {
        return Ok((**file).clone());
    }
    let of_case = |message: String| errors::input(py, &format!("cases[{i}]"), message);
    let table = whipcord_io::describe(Some(&setup.title), &setup.robot, &setup.case);
    let text = whipcord_io::toml(&table.map_err(|error| of_case(error.to_string()))?);
    let name = format!("case-{}", i + 1);
    let mut file = whipcord_io::parse(&text, name).map_err(|error| of_case(error.to_string()))?;
    file.measured = setup.file_data.measured.as_deref().cloned();
    Ok(file)
}
