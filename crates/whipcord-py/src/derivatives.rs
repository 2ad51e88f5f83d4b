//! Exact derivatives of an answer: of models in equilibrium under loads by all, of the four-bar model without a strain energy by the lengths.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::derivatives::{Change, Cotangent, Hold, Place};
use whipcord::{Linearization, ModelKind, Prepared, Twist, UnitQuaternion, Vec3, four_bar};

use crate::convert::{array, matrix6, square, twist};
use crate::errors;
use crate::model::Model;
use crate::setup::{Setup, parameter};
use crate::solution::Solution;

/// The derivatives of one answer. What says how stations move is in the frame of their positions,
/// compliance and stiffness are in that of the base.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Derivatives {
    inner: Inner,
    solution: Arc<whipcord::Solution>,
    to_world: UnitQuaternion,
    parameters: usize,
}

/// Those of the model that answers.
enum Inner {
    /// In the frame of the base.
    All(Linearization),
    /// In that of the positions; by shortenings alone.
    FourBar(four_bar::Derivatives),
}

/// The answer with its derivatives by the commands, by loads, and by these parameters.
#[pyfunction]
#[pyo3(signature = (setup, model, parameters, tension = None, shortening = None, motors = None, start = None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn derivatives(
    py: Python<'_>,
    setup: &Bound<'_, Setup>,
    model: &Model,
    parameters: Vec<String>,
    tension: Option<&Bound<'_, PyAny>>,
    shortening: Option<&Bound<'_, PyAny>>,
    motors: Option<&Bound<'_, PyAny>>,
    start: Option<&Solution>,
) -> PyResult<(Solution, Derivatives)> {
    let case = setup.get().commanded(tension, shortening, motors)?;
    let parameters: Vec<_> =
        parameters.iter().map(|path| parameter(py, path)).collect::<PyResult<_>>()?;
    let count = parameters.len();
    let start = start.map(|solution| Arc::clone(&solution.inner));
    let of = Arc::clone(&case);
    let answer = Setup::watched(setup, model, move |prepared| {
        match prepared {
            Prepared::Cosserat(..) | Prepared::CosseratDisks(..) | Prepared::Linkage(..) => {}
            Prepared::FourBar(model, _) if model.has_linearization() => {}
            Prepared::FourBar(model, workspace) if parameters.is_empty() => {
                let (solution, inner) = model.solve_with_derivatives(&of, workspace)?;
                return Ok(Some((solution, Inner::FourBar(inner))));
            }
            Prepared::FourBar(..) | Prepared::ConstantCurvature(..) => return Ok(None),
        }
        let (solution, inner) =
            prepared.solve_last_with_derivatives(&of, start.as_deref(), &parameters)?;
        Ok(Some((solution, Inner::All(inner))))
    })?;
    let Some((solution, inner)) = answer else {
        let what = match model.inner.kind() {
            ModelKind::FourBar => "derivatives by parameters",
            _ => "derivatives",
        };
        return Err(errors::not_by(py, model.inner.kind(), what));
    };
    let solution = Solution::new(solution, &case);
    let derivatives = Derivatives {
        inner,
        solution: Arc::clone(&solution.inner),
        to_world: case.base.rotation,
        parameters: count,
    };
    Ok((solution, derivatives))
}

#[pymethods]
impl Derivatives {
    /// What is about to change at the answer.
    fn one_sided(&self) -> Vec<&'static str> {
        match &self.inner {
            Inner::All(all) => all.one_sided().names().collect(),
            Inner::FourBar(_) => Vec::new(),
        }
    }

    /// Whether the commanded lengths depend on each other.
    fn lengths_dependent(&self) -> bool {
        match &self.inner {
            Inner::All(all) => all.are_lengths_dependent(Hold::Commands),
            Inner::FourBar(_) => false,
        }
    }

    /// (n, 6, c) motion of every station with the command of each cable.
    fn commands<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let cables = self.solution.cables.len();
        match &self.inner {
            Inner::All(all) => self
                .stations(py, cables, |k| self.in_world(all.actuation_jacobian(Place::Station(k)))),
            Inner::FourBar(sections) => self.stations(py, cables, |k| sections.station(k).to_vec()),
        }
    }

    /// (n, 6, c) motion of every station with the tension of each cable.
    fn tensions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (all, cables) = (self.all(py, TENSIONS)?, self.solution.cables.len());
        self.stations(py, cables, |k| self.in_world(all.tension_jacobian(Place::Station(k))))
    }

    /// (n, 6, p) motion of every station with each parameter.
    fn parameters<'py>(&self, py: Python<'py>, hold: &str) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let changes = self.changes(py, held(py, hold)?)?;
        self.stations(py, changes.len(), |k| {
            self.in_world(changes.iter().map(|c| c.twist(Place::Station(k))).collect())
        })
    }

    /// (c, p) rates of the cables' lengths and tensions with each parameter.
    #[expect(clippy::type_complexity, reason = "a pair of arrays")]
    fn cables_by_parameters<'py>(
        &self,
        py: Python<'py>,
        hold: &str,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let changes = self.changes(py, held(py, hold)?)?;
        let cables = self.solution.cables.len();
        let table = |of: fn(&Change) -> &[f64]| {
            let rows = (0..cables).flat_map(|i| changes.iter().map(move |change| of(change)[i]));
            array(py, rows.collect(), [cables, changes.len()])
        };
        Ok((table(Change::lengths)?, table(Change::tensions)?))
    }

    /// (c, c) rates of the cables' lengths with their tensions.
    fn length_by_tension<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        square(py, &self.all(py, TENSIONS)?.length_by_tension())
    }

    /// (c, c) rates of the cables' lengths with their commands.
    fn length_by_command<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        match &self.inner {
            Inner::All(all) => square(py, &all.length_by_command()),
            Inner::FourBar(sections) => {
                let cables = 0..self.solution.cables.len();
                let rows: Vec<_> = cables.map(|cable| sections.length(cable).to_vec()).collect();
                square(py, &rows)
            }
        }
    }

    /// (6, 6) compliance of a station, or of the tip, in the frame of the base.
    #[pyo3(signature = (station, hold))]
    fn compliance<'py>(
        &self,
        py: Python<'py>,
        station: Option<&Bound<'py, PyAny>>,
        hold: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let compliance =
            self.all(py, YIELDS)?.compliance(self.place(py, station)?, held(py, hold)?);
        matrix6(py, &compliance.map_err(|error| errors::solve(py, &error))?)
    }

    /// (6, 6) stiffness of a station, or of the tip; None where it does not yield in every direction.
    #[pyo3(signature = (station, hold))]
    fn stiffness<'py>(
        &self,
        py: Python<'py>,
        station: Option<&Bound<'py, PyAny>>,
        hold: &str,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let stiffness = self.all(py, YIELDS)?.stiffness(self.place(py, station)?, held(py, hold)?);
        let stiffness = stiffness.map_err(|error| errors::solve(py, &error))?;
        stiffness.map(|matrix| matrix6(py, &matrix)).transpose()
    }

    /// Gradient of a scalar by commands, parameters, and dead wrenches at the stations, from its
    /// sensitivities to positions, turns, tensions and lengths.
    #[pyo3(signature = (hold, position = None, rotation = None, tension = None, length = None))]
    fn pull_back<'py>(
        &self,
        py: Python<'py>,
        hold: &str,
        position: Option<PyReadonlyArray2<'py, f64>>,
        rotation: Option<PyReadonlyArray2<'py, f64>>,
        tension: Option<PyReadonlyArray1<'py, f64>>,
        length: Option<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (hold, all) = (held(py, hold)?, self.all(py, "gradients of scalars")?);
        let (stations, cables) = (self.solution.shape.poses.len(), self.solution.cables.len());
        let mut places = vec![Twist::default(); stations];
        let vectors = |array: Option<&PyReadonlyArray2<'py, f64>>, name: &str| {
            let Some(array) = array else { return Ok(vec![Vec3::ZERO; stations]) };
            let view = array.as_array();
            if view.dim() != (stations, 3) {
                let message =
                    format!("{name} must have the shape ({stations}, 3), but has {:?}", view.dim());
                return Err(errors::input(py, name, message));
            }
            finite(py, name, view.iter())?;
            let back = self.to_world.conjugate();
            Ok(view
                .rows()
                .into_iter()
                .map(|v| back.rotate(Vec3::new(v[0], v[1], v[2])))
                .collect::<Vec<_>>())
        };
        let positions = vectors(position.as_ref(), "position")?;
        let rotations = vectors(rotation.as_ref(), "rotation")?;
        for ((place, linear), angular) in places.iter_mut().zip(positions).zip(rotations) {
            *place = Twist { linear, angular };
        }
        let of_cables = |array: Option<&PyReadonlyArray1<'py, f64>>, name: &str| {
            let Some(array) = array else { return Ok(Vec::new()) };
            let values = array.as_array().to_vec();
            if values.len() != cables {
                let message =
                    format!("{name} must have the shape ({cables},), but has ({},)", values.len());
                return Err(errors::input(py, name, message));
            }
            finite(py, name, values.iter())?;
            Ok(values)
        };
        let cotangent = Cotangent {
            places: places.into_iter().enumerate().map(|(i, t)| (Place::Station(i), t)).collect(),
            lengths: of_cables(length.as_ref(), "length")?,
            tensions: of_cables(tension.as_ref(), "tension")?,
            ..Cotangent::default()
        };
        let gradient = all.pull_back(&cotangent, hold);
        let wrenches = (0..stations).flat_map(|station| {
            let wrench = gradient.wrench(Place::Station(station));
            twist(self.turned(Twist { linear: wrench.force, angular: wrench.moment }))
        });
        let wrenches = array(py, wrenches.collect(), [stations, 6])?;
        let vector = |values: Vec<f64>| -> PyResult<Bound<'py, PyArray1<f64>>> {
            let count = values.len();
            array(py, values, [count])
        };
        let values = PyDict::new(py);
        values.set_item("commands", vector(gradient.commands)?)?;
        values.set_item("parameters", vector(gradient.parameters)?)?;
        values.set_item("wrenches", wrenches)?;
        Ok(values)
    }
}

impl Derivatives {
    /// What models in equilibrium under loads know.
    fn all(&self, py: Python<'_>, what: &str) -> PyResult<&Linearization> {
        match &self.inner {
            Inner::All(all) => Ok(all),
            Inner::FourBar(_) => Err(errors::not_by(py, self.solution.model, what)),
        }
    }

    fn changes(&self, py: Python<'_>, hold: Hold) -> PyResult<Vec<Change>> {
        let all = self.all(py, "derivatives by parameters")?;
        Ok((0..self.parameters).map(|i| all.parameter(i, hold)).collect())
    }

    fn turned(&self, Twist { linear, angular }: Twist) -> Twist {
        Twist { linear: self.to_world.rotate(linear), angular: self.to_world.rotate(angular) }
    }

    fn in_world(&self, motions: Vec<Twist>) -> Vec<Twist> {
        motions.into_iter().map(|motion| self.turned(motion)).collect()
    }

    fn stations<'py>(
        &self,
        py: Python<'py>,
        width: usize,
        columns: impl Fn(usize) -> Vec<Twist>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let stations = self.solution.shape.poses.len();
        let mut values = Vec::with_capacity(stations * 6 * width);
        for station in 0..stations {
            let columns: Vec<[f64; 6]> = columns(station).into_iter().map(twist).collect();
            values.extend((0..6).flat_map(|row| columns.iter().map(move |column| column[row])));
        }
        array(py, values, [stations, 6, width])
    }

    fn place(&self, py: Python<'_>, station: Option<&Bound<'_, PyAny>>) -> PyResult<Place> {
        let Some(station) = station else { return Ok(Place::Tip) };
        let stations = self.solution.shape.poses.len();
        match station.extract::<usize>() {
            Ok(i) if i < stations => Ok(Place::Station(i)),
            _ => {
                let last = stations - 1;
                let message =
                    format!("there is no station {}: they are 0 to {last}", station.repr()?);
                Err(errors::input(py, "at", message))
            }
        }
    }
}

const TENSIONS: &str = "derivatives by tensions";
const YIELDS: &str = "compliance and stiffness of any station";

/// Refuses sensitivities that are no numbers, or infinite.
fn finite<'a>(
    py: Python<'_>,
    name: &str,
    mut values: impl Iterator<Item = &'a f64>,
) -> PyResult<()> {
    match values.find(|value| !value.is_finite()) {
        None => Ok(()),
        Some(value) => {
            let message = format!("{name} must be finite numbers, but holds {value}");
            Err(errors::input(py, name, message))
        }
    }
}

fn held(py: Python<'_>, hold: &str) -> PyResult<Hold> {
    match hold {
        "commands" => Ok(Hold::Commands),
        "tensions" => Ok(Hold::Tensions),
        "lengths" => Ok(Hold::Lengths),
        other => {
            let message = format!("nothing holds `{other}`: choose commands, tensions or lengths");
            Err(errors::input(py, "hold", message))
        }
    }
}
