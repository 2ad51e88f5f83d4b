//! Exceptions of the errors of the library: those of the module `whipcord.errors`, with the numbers as
//! attributes.

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyList};
use whipcord::batch::BatchError;
use whipcord::{ModelKind, RobotError, SolveError};
use whipcord_estimation::identification::{Identified, IdentifyError, NoAnswerReason};
use whipcord_io::{FileError, FileProblem};
use whipcord_motion::MotionError;
use whipcord_vision::NoPoints;
use whipcord_vision::PhotoError;
use whipcord_vision::boards::{NoCalibration, NoStereo};
use whipcord_vision::detect::DetectError;

/// An exception of this class of `whipcord.errors`, with these attributes.
fn exception(
    py: Python<'_>,
    class: &str,
    message: String,
    attributes: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>,
) -> PyErr {
    let make = || {
        let values = PyDict::new(py);
        attributes(&values)?;
        let class = py.import("whipcord.errors")?.getattr(class)?;
        class.call((message,), Some(&values))
    };
    make().map_or_else(|error| error, PyErr::from_value)
}

/// What a caller gave cannot be. `path` names the argument.
pub fn input(py: Python<'_>, path: &str, message: String) -> PyErr {
    exception(py, "InputError", message, |values| values.set_item("path", path))
}

/// A model is asked for what only models in equilibrium under loads know.
pub fn not_by(py: Python<'_>, model: ModelKind, what: &str) -> PyErr {
    input(
        py,
        "model",
        format!(
            "{what} are known to models in equilibrium under loads, not to {model}: use cosserat, cosserat-disks, \
             piecewise-constant-curvature or pseudo-rigid-body, or four-bar with the objective strain-energy and the length rule free"
        ),
    )
}

/// A quantity of a robot or a case that cannot be.
pub fn robot(py: Python<'_>, error: &RobotError) -> PyErr {
    input(py, &error.path, error.to_string())
}

/// A robot file that cannot be used.
pub fn file(py: Python<'_>, error: &FileError, path: &str) -> PyErr {
    let missing = error.problems.iter().any(|diagnostic| {
        matches!(diagnostic.problem, FileProblem::Unreadable { missing: true, .. })
    });
    let class = if missing { "FileMissingError" } else { "FileError" };
    exception(py, class, error.to_string().trim_end().to_owned(), |values| {
        values.set_item("path", path)?;
        values.set_item("problems", problems(py, error)?)
    })
}

/// A file that is no photograph.
pub fn photo(py: Python<'_>, error: &PhotoError, path: &str) -> PyErr {
    let message = error.to_string();
    exception(py, "FileError", format!("{path}: {message}"), |values| {
        values.set_item("path", path)?;
        let problem = [("message", message.as_str()), ("help", ""), ("file", path)];
        values.set_item("problems", [problem.into_py_dict(py)?])
    })
}

/// Why photographs of a board give no lens.
pub fn calibration(py: Python<'_>, error: &NoCalibration) -> PyErr {
    let mut message = error.to_string();
    for (number, why) in &error.refused {
        message += &format!("\n  photograph {}: {why}", number + 1);
    }
    exception(py, "CalibrationError", message, |values| {
        values.set_item("used", error.used.clone())?;
        let refused: Vec<(usize, String)> =
            error.refused.iter().map(|(number, why)| (*number, why.to_string())).collect();
        values.set_item("refused", refused)
    })
}

/// Why pairs of photographs of a board do not give the pose of the second camera.
pub fn stereo(py: Python<'_>, error: &NoStereo) -> PyErr {
    let mut message = error.to_string();
    for (number, why) in &error.refused {
        message += &format!("\n  pair {}: {why}", number + 1);
    }
    exception(py, "CalibrationError", message, |values| {
        values.set_item("used", Vec::<usize>::new())?;
        let refused: Vec<(usize, String)> =
            error.refused.iter().map(|(number, why)| (*number, why.to_string())).collect();
        values.set_item("refused", refused)
    })
}

/// Why two photographs give no points in space.
pub fn not_in_space(py: Python<'_>, error: &NoPoints) -> PyErr {
    exception(py, "DetectionError", error.to_string(), |_| Ok(()))
}

/// What the command says where a file cannot be written.
pub fn os(message: &str) -> PyErr {
    PyOSError::new_err(message.trim_start_matches("error: ").to_owned())
}

/// Why nothing is found in a photograph.
pub fn detect(py: Python<'_>, error: &DetectError) -> PyErr {
    use DetectError as E;
    let message = error.to_string();
    let raise = |class: &str, fill: &dyn Fn(&Bound<'_, PyDict>) -> PyResult<()>| {
        exception(py, class, message.clone(), fill)
    };
    match error {
        E::MaskSize { .. } | E::EmptyMask => input(py, "mask", message),
        E::TooSmall { .. } => input(py, "photo", message),
        E::HiddenOfHowMany => input(py, "hidden", message),
        E::NoSuchHidden { .. } => input(py, "hidden", format!("hidden {message}")),
        E::ColourLikeBackground => input(py, "colour", message),
        E::NothingStandsOut
        | E::NoEvenBackground { .. }
        | E::NoVividColour
        | E::NoneFound { .. } => raise("NothingFoundError", &|_| Ok(())),
        E::TooFew { found, expected, gaps } => raise("TooFewFoundError", &|values| {
            values.set_item("found", found)?;
            values.set_item("expected", expected)?;
            values.set_item("gaps", gaps)
        }),
        E::TooMany { found, expected, least_sure } => raise("TooManyFoundError", &|values| {
            values.set_item("found", found)?;
            values.set_item("expected", expected)?;
            values.set_item("least_sure", least_sure)
        }),
        E::Gap { found, gaps } => raise("GapError", &|values| {
            values.set_item("found", found)?;
            values.set_item("gaps", gaps)
        }),
        E::NoRow { found, at } => raise("NoRowError", &|values| {
            values.set_item("found", found)?;
            values.set_item("at", at)
        }),
        E::AmbiguousBase { ends } => {
            raise("AmbiguousBaseError", &|values| values.set_item("ends", ends))
        }
        E::Mirrored { base, forward, reversed } => raise("MirroredError", &|values| {
            values.set_item("base", base)?;
            values.set_item("forward", forward)?;
            values.set_item("reversed", reversed)
        }),
    }
}

/// Why nothing is estimated. Cases are counted from 0, as in Python.
pub fn identify(py: Python<'_>, error: &IdentifyError, cases: usize) -> PyErr {
    let names: Vec<String> = (0..cases).map(|case| format!("cases[{case}]")).collect();
    let message = error.named(&names);
    match error {
        IdentifyError::NoAnswerAtStart(answer) => {
            let raised = exception(py, "FitError", message, |values| {
                values.set_item("case", answer.experiment)
            });
            if let NoAnswerReason::Solve(error) = &answer.reason {
                raised.set_cause(py, Some(solve(py, error)));
            }
            raised
        }
        IdentifyError::Observation { experiment, observation, problem } => {
            let path = format!("cases[{experiment}].measured.observations[{observation}]");
            input(py, &path, format!("{path}: {problem}"))
        }
        IdentifyError::NotConverged { experiment, .. } => {
            exception(py, "FitError", message, |values| values.set_item("case", experiment))
        }
        IdentifyError::Cancelled => timed_out(py, error.to_string(), None),
        _ => input(py, "parameters", message),
    }
}

/// What was ended by its time limit: nothing else ends a solve whose result is waited for.
pub fn timed_out(py: Python<'_>, why: String, last_load: Option<f64>) -> PyErr {
    let message =
        format!("the time limit was reached (timeout): {why}; give it more time, or ask for less");
    exception(py, "WhipcordTimeout", message, |values| values.set_item("last_load", last_load))
}

/// A fit that has not converged.
pub fn fit_not_converged(py: Python<'_>, message: String, found: &Identified) -> PyErr {
    exception(py, "FitNotConvergedError", message, |values| {
        let case = found.refusal.as_ref().map(|answer| answer.experiment);
        values.set_item("case", case)?;
        values.set_item("iterations", found.iterations)?;
        let unresolved = found.unresolved.iter().map(ToString::to_string);
        values.set_item("unresolved", unresolved.collect::<Vec<_>>())
    })
}

/// Arguments that a robot file with the same values would be refused for.
pub fn arguments(py: Python<'_>, error: &FileError, of: &str) -> PyErr {
    let sentences = error.problems.iter().map(|diagnostic| {
        let (problem, help) = (&diagnostic.problem, diagnostic.problem.help());
        if help.is_empty() { problem.to_string() } else { format!("{problem}; {help}") }
    });
    let message = sentences.collect::<Vec<_>>().join("\n");
    exception(py, "InputError", message, |values| {
        values.set_item("path", of)?;
        values.set_item("problems", problems(py, error)?)
    })
}

/// What is wrong, what to do, and where.
fn problems<'py>(py: Python<'py>, error: &FileError) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for diagnostic in &error.problems {
        let source = error.sources.get(diagnostic.span.file);
        let position = source.map(|source| source.position(diagnostic.span.start));
        let problem = PyDict::new(py);
        problem.set_item("message", diagnostic.problem.to_string())?;
        problem.set_item("help", diagnostic.problem.help())?;
        problem.set_item("file", source.map(|source| source.name()))?;
        problem.set_item("line", position.map(|at| at.line))?;
        problem.set_item("column", position.map(|at| at.column))?;
        list.append(problem)?;
    }
    Ok(list)
}

/// Why a batch as a whole was not solved.
pub fn batch(py: Python<'_>, error: &BatchError) -> PyErr {
    match error {
        BatchError::Model(error) => solve(py, error),
        BatchError::NotFinite { name, row, value } => {
            let name = match *name {
                "positions" => "position",
                "rotations" => "rotation",
                "tensions" => "cable_tension",
                _ => "cable_length",
            };
            let message = format!("{name} must be finite numbers, but holds {value} in row {row}");
            input(py, name, message)
        }
        other => input(py, "tensions", other.to_string()),
    }
}

/// Why a model gives no answer.
pub fn solve(py: Python<'_>, error: &SolveError) -> PyErr {
    use Value::{Count, Number, Text};
    let message = error.to_string();
    let raise = |class: &str, values: &[(&str, Value<'_>)]| {
        exception(py, class, message.clone(), |dict| {
            values.iter().try_for_each(|(name, value)| match value {
                Text(text) => dict.set_item(name, text),
                Number(number) => dict.set_item(name, number),
                Count(count) => dict.set_item(name, count),
            })
        })
    };
    match error {
        SolveError::Invalid(error) => robot(py, error),
        SolveError::Missing { model, path, advice } => raise(
            "ModelError",
            &[("model", Text(model.name())), ("path", Text(path)), ("advice", Text(advice))],
        ),
        SolveError::Unsupported { model, path, what: _, advice } => raise(
            "ModelError",
            &[("model", Text(model.name())), ("path", Text(path)), ("advice", Text(advice))],
        ),
        SolveError::SectionFolds { cable, arc_length, tension, last_load } => raise(
            "SectionFoldsError",
            &[
                ("cable", Text(cable)),
                ("arc_length", Number(*arc_length)),
                ("tension", Number(*tension)),
                ("last_load", Number(*last_load)),
            ],
        ),
        SolveError::UnreachableLength { cable, requested, reachable } => raise(
            "UnreachableLengthError",
            &[
                ("cable", Text(cable)),
                ("requested", Number(*requested)),
                ("reachable", Number(*reachable)),
            ],
        ),
        SolveError::ContradictoryLengths { misses } => {
            exception(py, "ContradictoryLengthsError", message, |dict| {
                let excess = misses.iter().map(|miss| (miss.cable.as_str(), miss.excess));
                dict.set_item("excess", excess.into_py_dict(py)?)
            })
        }
        SolveError::SectionOutOfReach { cable, disk, requested, shortest, longest } => raise(
            "SectionOutOfReachError",
            &[
                ("cable", Text(cable)),
                ("disk", Count(*disk)),
                ("requested", Number(*requested)),
                ("shortest", Number(*shortest)),
                ("longest", Number(*longest)),
            ],
        ),
        SolveError::CablesConflict { cable, first_disk, last_disk, excess } => raise(
            "CablesConflictError",
            &[
                ("cable", Text(cable)),
                ("first_disk", Count(*first_disk)),
                ("last_disk", Count(*last_disk)),
                ("excess", Number(*excess)),
            ],
        ),
        SolveError::NoLever { cable, disk } => {
            raise("NoLeverError", &[("cable", Text(cable)), ("disk", Count(*disk))])
        }
        SolveError::Buckled { load, iterations } => raise(
            "BuckledError",
            &[("last_load", Number(*load)), ("iterations", Count(*iterations))],
        ),
        SolveError::NotConverged { iterations, residual, last_load, advice } => raise(
            "NotConvergedError",
            &[
                ("iterations", Count(*iterations)),
                ("residual", Number(*residual)),
                ("last_load", Number(*last_load)),
                ("advice", Text(advice)),
            ],
        ),
        SolveError::ObstacleInTheWay { obstacle, arc_length, depth, .. } => raise(
            "ObstacleInTheWayError",
            &[
                ("obstacle", Text(obstacle)),
                ("arc_length", Number(*arc_length)),
                ("depth", Number(*depth)),
            ],
        ),
        SolveError::ObjectOverlaps { object, obstacle, depth } => raise(
            "ObjectOverlapsError",
            &[("object", Text(object)), ("obstacle", Text(obstacle)), ("depth", Number(*depth))],
        ),
        SolveError::NotInserted { pipe, inserted, length, why } => {
            exception(py, "NotInsertedError", message, |dict| {
                dict.set_item("reached", inserted / length)?;
                dict.set_item("touching", [pipe])?;
                dict.set_item("pipe", pipe)?;
                dict.set_item("inserted", inserted)?;
                dict.set_item("length", length)?;
                dict.set_item("why", why.to_string())
            })
        }
        SolveError::Obstructed { reached, touching, .. } => {
            exception(py, "ObstructedError", message, |dict| {
                dict.set_item("reached", reached)?;
                dict.set_item("touching", touching)
            })
        }
        SolveError::BudgetSpent { iterations, integration_steps, last_load } => {
            exception(py, "BudgetSpentError", message, |dict| {
                dict.set_item("iterations", iterations)?;
                dict.set_item("integration_steps", integration_steps)?;
                dict.set_item("last_load", last_load)
            })
        }
        SolveError::Cancelled { last_load } => timed_out(py, message, *last_load),
        SolveError::TensionsNotFound => raise("TensionsNotFoundError", &[]),
        SolveError::NoDerivatives | SolveError::NoDerivativesOfRest => {
            raise("NoDerivativesError", &[])
        }
        SolveError::StepsTooCoarse { error, tolerance, steps } => raise(
            "StepsTooCoarseError",
            &[
                ("error", Number(*error)),
                ("tolerance", Number(*tolerance)),
                ("steps", Count(*steps)),
            ],
        ),
    }
}

/// Why there is no motion.
pub fn motion(py: Python<'_>, error: &MotionError) -> PyErr {
    let message = error.to_string();
    let no_model = |path: &str, advice: &str| {
        exception(py, "ModelError", message.clone(), |values| {
            values.set_item("model", "cosserat")?;
            values.set_item("path", path)?;
            values.set_item("advice", advice)
        })
    };
    let failed = |time: Option<f64>| {
        exception(py, "MotionError", message.clone(), |values| values.set_item("time", time))
    };
    match error {
        MotionError::Invalid(error) => robot(py, error),
        MotionError::NoEquilibrium(cause) => {
            let raised = failed(None);
            raised.set_cause(py, Some(solve(py, cause)));
            raised
        }
        MotionError::Missing { path, advice } | MotionError::Unsupported { path, advice, .. } => {
            no_model(path, advice)
        }
        MotionError::Option { what, .. } | MotionError::Count { what, .. } => {
            input(py, what, message)
        }
        MotionError::Course { .. } => input(py, "motion.commands", message),
        MotionError::NotConverged { time, .. }
        | MotionError::NoGradient { time }
        | MotionError::NotSmooth { time }
        | MotionError::Tolerance { time, .. } => failed(Some(*time)),
        MotionError::Unbalanced { .. }
        | MotionError::NoModes
        | MotionError::Sliding { .. }
        | MotionError::Overlap { .. }
        | MotionError::MotorOverload { .. } => failed(None),
    }
}

/// A number of an error, or a name.
enum Value<'a> {
    Text(&'a str),
    Number(f64),
    Count(usize),
}
