//! Values of Python to values of the library, and back.

use std::path::PathBuf;

use numpy::{Element, PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, ndarray};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use whipcord::kinematics::Matrix6;
use whipcord::{CableCommand, Drive, Robot, Shortening, Twist, Vec3};
use whipcord_io::{Dimension, Item, Shear, Table};

use crate::errors;

/// A number in SI of a number, or of a text with a unit of one of these dimensions (`"length"`,
/// `"force"`, ...).
#[pyfunction]
pub fn parse_quantity(py: Python<'_>, text: &str, dimension: &str) -> PyResult<f64> {
    static ALL: [Dimension; Dimension::ALL.len()] = Dimension::ALL;
    let found = ALL.iter().find(|d| d.to_string() == dimension);
    let dimension = found.ok_or_else(|| {
        let all = Dimension::ALL.map(|d| d.to_string()).join(", ");
        errors::input(
            py,
            "dimension",
            format!("there is no dimension `{dimension}`: choose one of {all}"),
        )
    })?;
    quantity(py, text, core::slice::from_ref(dimension), "text").map(|(value, _)| value)
}

/// A table of a robot file, or one entry of `cables`, `steps`, `loads.point` and so on, checked by
/// itself and in SI.
#[pyfunction]
pub fn table_in_si<'py>(
    py: Python<'py>,
    name: &str,
    table: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let table = to_table(table, name)?;
    let table = whipcord_io::table_in_si(name, &table);
    from_table(py, &table.map_err(|error| errors::arguments(py, &error, name))?)
}

/// The materials that a backbone may name.
#[pyfunction]
pub fn materials(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let all = whipcord_io::materials().iter().map(|preset| {
        let (ratio, modulus) = match preset.shear {
            Shear::PoissonRatio(ratio) => (Some(ratio), None),
            Shear::Modulus(modulus) => (None, Some(modulus)),
        };
        let [least, greatest] = preset.young_modulus_range;
        let dict = PyDict::new(py);
        dict.set_item("name", preset.name)?;
        dict.set_item("young_modulus", preset.young_modulus)?;
        dict.set_item("young_modulus_range", (least, greatest))?;
        dict.set_item("poisson_ratio", ratio)?;
        dict.set_item("shear_modulus", modulus)?;
        dict.set_item("density", preset.density)?;
        dict.set_item("yield_strain", preset.yield_strain)?;
        dict.set_item("source", preset.source)?;
        Ok(dict)
    });
    all.collect()
}

/// The text of a robot file with these tables.
#[pyfunction]
pub fn toml(tables: &Bound<'_, PyDict>) -> PyResult<String> {
    Ok(whipcord_io::toml(&to_table(tables, "case")?))
}

/// Writes a file whole or not at all.
#[pyfunction]
pub fn write_file(path: PathBuf, content: &[u8]) -> PyResult<()> {
    Ok(whipcord_io::write_atomically(&path, content)?)
}

fn quantity(
    py: Python<'_>,
    text: &str,
    dimensions: &'static [Dimension],
    path: &str,
) -> PyResult<(f64, Dimension)> {
    whipcord_io::parse_quantity(text, dimensions).map_err(|error| {
        let units: Vec<String> = dimensions.iter().map(|d| d.unit_names()).collect();
        let message = format!("{path}: {error}; write it with {}", units.join(", or "));
        errors::input(py, path, message)
    })
}

/// A tree of dicts, lists, texts and numbers as a table. An entry that is None is left out.
pub fn to_table(dict: &Bound<'_, PyDict>, path: &str) -> PyResult<Table> {
    let mut table = Table::default();
    for (key, value) in dict {
        let key: String = key.extract()?;
        if !value.is_none() {
            let path = format!("{path}.{key}");
            table.insert(&key, to_item(&value, &path)?);
        }
    }
    Ok(table)
}

fn to_item(value: &Bound<'_, PyAny>, path: &str) -> PyResult<Item> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Item::Flag(flag.is_true()));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Item::Number(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() {
        // What does not fit is refused as far too large.
        return Ok(value.extract().map_or_else(|_| Item::Number(f64::MAX), Item::Integer));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Item::Text(text.extract()?));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(Item::Table(to_table(dict, path)?));
    }
    if value.is_instance_of::<PyTuple>() || value.is_instance_of::<PyList>() {
        let items = value.try_iter()?.enumerate();
        return items
            .map(|(i, item)| to_item(&item?, &format!("{path}[{i}]")))
            .collect::<PyResult<_>>()
            .map(Item::List);
    }
    // Arrays and scalars of NumPy.
    if let Ok(plain) = value.call_method0("tolist")
        && !plain.is(value)
    {
        return to_item(&plain, path);
    }
    if let Ok(number) = value.extract() {
        return Ok(Item::Number(number));
    }
    let kind = value.get_type().name()?;
    let message = format!(
        "{path} must be a number, a text with a unit, or a list of them, but is a `{kind}`"
    );
    Err(errors::input(value.py(), path, message))
}

/// A table as a dict, its lists as tuples.
pub fn from_table<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, item) in &table.entries {
        dict.set_item(key, from_item(py, item)?)?;
    }
    Ok(dict)
}

fn from_item<'py>(py: Python<'py>, item: &Item) -> PyResult<Bound<'py, PyAny>> {
    Ok(match item {
        Item::Text(text) => PyString::new(py, text).into_any(),
        Item::Integer(number) => number.into_pyobject(py)?.into_any(),
        Item::Number(number) => PyFloat::new(py, *number).into_any(),
        Item::Flag(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        Item::List(items) => {
            let items: Vec<_> =
                items.iter().map(|item| from_item(py, item)).collect::<PyResult<_>>()?;
            PyTuple::new(py, items)?.into_any()
        }
        Item::Table(table) => from_table(py, table)?.into_any(),
    })
}

/// One value of a command of a cable or motor: a number, a text with a unit, or None.
type Entry = Option<(f64, Dimension)>;

/// What is asked of every cable by tensions in N and shortenings in m. Without either, the commands of
/// the case.
pub fn commands(
    robot: &Robot,
    tension: Option<&Bound<'_, PyAny>>,
    shortening: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Vec<CableCommand>>> {
    const SHORTENING: &[Dimension] = &[Dimension::Length, Dimension::Ratio];
    if tension.is_none() && shortening.is_none() {
        return Ok(None);
    }
    let mut commands = vec![CableCommand::default(); robot.cables().len()];
    if let Some(given) = tension {
        let entries = cable_entries(robot, given, &[Dimension::Force], "tension")?;
        for (command, entry) in commands.iter_mut().zip(entries) {
            command.tension = entry.map(|(value, _)| value);
        }
    }
    if let Some(given) = shortening {
        let entries = cable_entries(robot, given, SHORTENING, "shortening")?;
        for (command, entry) in commands.iter_mut().zip(entries) {
            command.shortening = entry.map(|(value, dimension)| match dimension {
                Dimension::Ratio => Shortening::Fraction(value),
                _ => Shortening::Length(value),
            });
        }
    }
    Ok(Some(commands))
}

/// What the motors are told to do: an angle in rad or a travel in m of each, `None` where its cables have commands of their own.
pub fn motor_commands(robot: &Robot, given: &Bound<'_, PyAny>) -> PyResult<Vec<Option<f64>>> {
    let motors = robot.motors();
    let given_for = GivenFor {
        kind: "motor",
        names: motors.iter().map(|motor| motor.name.as_str()).collect(),
        // Wrong text of a robot without motors is told to have too many entries.
        dimensions: motors
            .iter()
            .map(|motor| match motor.drive {
                Drive::Spool { .. } => &[Dimension::Angle][..],
                Drive::Linear => &[Dimension::Length][..],
            })
            .collect(),
    };
    let entries = given_for.entries(given, "motors")?;
    Ok(entries.into_iter().map(|entry| entry.map(|(value, _)| value)).collect())
}

fn cable_entries(
    robot: &Robot,
    given: &Bound<'_, PyAny>,
    dimensions: &'static [Dimension],
    name: &str,
) -> PyResult<Vec<Entry>> {
    let cables = robot.cables();
    let names = cables.iter().map(|cable| cable.name.as_str()).collect();
    GivenFor { kind: "cable", names, dimensions: vec![dimensions; cables.len()] }
        .entries(given, name)
}

/// The cables or motors that a list of commands is for.
struct GivenFor<'a> {
    kind: &'static str,
    names: Vec<&'a str>,
    /// What the command of each may be.
    dimensions: Vec<&'static [Dimension]>,
}

impl GivenFor<'_> {
    fn entries(&self, given: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Entry>> {
        let count = self.names.len();
        let of = |i: usize| self.dimensions.get(i).copied().unwrap_or(&[Dimension::Ratio]);
        let list: Vec<Entry> = if let Ok(array) = given.extract::<PyReadonlyArray1<'_, f64>>() {
            array.as_array().iter().enumerate().map(|(i, &value)| Some((value, of(i)[0]))).collect()
        } else if given.is_instance_of::<PyString>() || given.is_instance_of::<PyFloat>() {
            vec![entry(given, of(0), name)?]
        } else {
            self.check_shape(given, name)?;
            let Ok(items) = given.try_iter() else {
                return Ok(vec![entry(given, of(0), name)?]);
            };
            items
                .enumerate()
                .map(|(i, item)| entry(&item?, of(i), &format!("{name}[{i}]")))
                .collect::<PyResult<_>>()?
        };
        if list.len() == count {
            return Ok(list);
        }
        let kind = self.kind;
        let message = if count == 0 {
            format!("{name} has {} entries, but the robot has no {kind}", list.len())
        } else {
            format!(
                "{name} must have {count} {}, one for each {kind} ({}), but has {}",
                if count == 1 { "entry" } else { "entries" },
                self.names.join(", "),
                list.len()
            )
        };
        Err(errors::input(given.py(), name, message))
    }

    /// Refuses arrays of more than one dimension, and of anything but numbers.
    fn check_shape(&self, given: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
        let Ok(shape) = given.getattr("shape") else { return Ok(()) };
        let shape: Vec<usize> = shape.extract().unwrap_or_default();
        if shape.len() > 1 {
            let message = format!(
                "{name} must have the shape ({},), one entry for each {}, but has {shape:?}; many rows at once are for `solve_batch`",
                self.names.len(),
                self.kind
            );
            return Err(errors::input(given.py(), name, message));
        }
        Ok(())
    }
}

fn entry(item: &Bound<'_, PyAny>, dimensions: &'static [Dimension], path: &str) -> PyResult<Entry> {
    if item.is_none() {
        return Ok(None);
    }
    if let Ok(text) = item.cast::<PyString>() {
        return quantity(item.py(), &text.extract::<String>()?, dimensions, path).map(Some);
    }
    match item.extract::<f64>() {
        Ok(value) => Ok(Some((value, dimensions[0]))),
        Err(_) => {
            let kind = item.get_type().name()?;
            let (unit, example) = (dimensions[0].si_unit(), dimensions[0].example());
            let message = format!(
                "{path} must be a number in {unit} or a text such as \"{example}\", but is a `{kind}`"
            );
            Err(errors::input(item.py(), path, message))
        }
    }
}

/// Numbers as an array of this shape, which nobody can write to.
pub fn array<'py, T: Element, D: ndarray::IntoDimension>(
    py: Python<'py>,
    values: Vec<T>,
    shape: D,
) -> PyResult<Bound<'py, PyArray<T, D::Dim>>> {
    let array = PyArray1::from_vec(py, values).reshape(shape)?;
    // NumPy itself forbids what the flag forbids; nothing else holds the array yet.
    array.readwrite().make_nonwriteable();
    Ok(array)
}

/// Components of vectors, one after the other.
pub fn flat(vectors: impl Iterator<Item = Vec3>) -> Vec<f64> {
    vectors.flat_map(|vector| vector.to_array()).collect()
}

/// Translation and rotation of a motion.
pub fn twist(twist: Twist) -> [f64; 6] {
    let ([x, y, z], [a, b, c]) = (twist.linear.to_array(), twist.angular.to_array());
    [x, y, z, a, b, c]
}

/// (6, c) motion of a place by each of the cables.
pub fn jacobian<'py>(py: Python<'py>, columns: &[Twist]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let columns: Vec<[f64; 6]> = columns.iter().copied().map(twist).collect();
    let values = (0..6).flat_map(|row| columns.iter().map(move |column| column[row])).collect();
    array(py, values, [6, columns.len()])
}

/// (6, 6).
pub fn matrix6<'py>(py: Python<'py>, matrix: &Matrix6) -> PyResult<Bound<'py, PyArray2<f64>>> {
    array(py, matrix.rows().concat(), [6, 6])
}

/// (c, c) of rows.
pub fn square<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    array(py, rows.concat(), [rows.len(), rows.len()])
}
