//! Photographs, and what is found in them.

use std::path::{Path, PathBuf};

use numpy::{PyArray3, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use whipcord_vision::detect::{self, Base, Kind, Mark, Mask, Row, Search};
use whipcord_vision::{PhotoError, annotated};

use crate::convert::array;
use crate::errors;
use crate::model;
use crate::wait::abandoned_after;

/// A photograph: as it was stored, where it was read from a file.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Photo {
    pub inner: whipcord_vision::Photo,
    bytes: Option<Vec<u8>>,
}

/// A mark: the number of its disk from 1, its pixel, radius and axis in pixels, and how sure it is.
type Found = (usize, [f64; 2], f64, [f64; 2], f64);

impl Photo {
    /// The bytes of a PNG or JPEG file of it.
    pub fn stored(&self) -> Result<Vec<u8>, PhotoError> {
        self.bytes.clone().map_or_else(|| self.inner.to_png(), Ok)
    }
}

#[pymethods]
impl Photo {
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let name = path.display().to_string();
        let bytes = py.detach(|| whipcord_io::read_photograph(&path));
        let bytes = bytes.map_err(|error| errors::file(py, &error, &name))?;
        let decoded = py.detach(|| whipcord_vision::Photo::decode_upright(bytes));
        let (inner, bytes) = decoded.map_err(|error| errors::photo(py, &error, &name))?;
        Ok(Self { inner, bytes: Some(bytes) })
    }

    /// The photograph whose pixels are these (h, w, 3) bytes.
    #[staticmethod]
    fn of_array(py: Python<'_>, pixels: PyReadonlyArray3<'_, u8>) -> PyResult<Self> {
        let pixels = pixels.as_array();
        let (height, width, _) = pixels.dim();
        let bytes: Vec<u8> = pixels.iter().copied().collect();
        let inner = py.detach(|| whipcord_vision::Photo::of_rgb8(width, height, &bytes));
        let inner = inner.map_err(|error| errors::input(py, "photo", error.to_string()))?;
        Ok(Self { inner, bytes: None })
    }

    /// Columns and rows.
    #[getter]
    fn size(&self) -> [usize; 2] {
        [self.inner.width(), self.inner.height()]
    }

    /// (h, w, 3) bytes of red, green and blue.
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let bytes = py.detach(|| self.inner.to_rgb8());
        array(py, bytes, [self.inner.height(), self.inner.width(), 3])
    }

    /// A PNG file of it.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let png = py.detach(|| self.inner.to_png());
        let png = png.map_err(|error| errors::input(py, "photo", error.to_string()))?;
        Ok(PyBytes::new(py, &png))
    }

    /// Disks or markers from base to tip. `base` is `left`, `right`, `top` or `bottom`, `near` a pixel in its
    /// place.
    #[pyo3(signature = (
        kind, colour, radius, mask, count, places, hidden, base, near, timeout = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn find(
        slf: &Bound<'_, Self>,
        kind: &str,
        colour: Option<[u8; 3]>,
        radius: Option<f64>,
        mask: Option<&Self>,
        count: Option<usize>,
        places: Option<Vec<f64>>,
        hidden: Vec<usize>,
        base: Option<&str>,
        near: Option<[f64; 2]>,
        timeout: Option<f64>,
    ) -> PyResult<Vec<Found>> {
        let py = slf.py();
        let timeout = timeout.map(|seconds| model::timeout(py, seconds)).transpose()?;
        let kind = self::kind(py, kind)?;
        let mask = mask.map(|mask| Mask::light_of(&mask.inner));
        let base = match base {
            None => near.map(Base::Near),
            Some("left") => Some(Base::Left),
            Some("right") => Some(Base::Right),
            Some("top") => Some(Base::Top),
            Some("bottom") => Some(Base::Bottom),
            Some(other) => {
                let message =
                    format!("base must be left, right, top, bottom or a pixel, but is {other}");
                return Err(errors::input(py, "base", message));
            }
        };
        let colour = colour.map(detect::colour);
        let photo = slf.clone().unbind();
        let found = abandoned_after(py, timeout, "the search for disks or markers", move || {
            let search = Search { kind, colour, radius, mask: mask.as_ref() };
            let row = Row { count, places: places.as_deref(), hidden: &hidden, base };
            detect::find_row(&photo.get().inner, &search, &row)
        })?;
        let found = found.map_err(|error| errors::detect(py, &error))?;
        let mark = |(number, m): (usize, Mark)| (number, m.pixel, m.radius, m.axis, m.confidence);
        Ok(found.into_iter().map(mark).collect())
    }

    /// The photograph with marks drawn into it.
    fn annotated(&self, py: Python<'_>, kind: &str, marks: Vec<Found>) -> PyResult<Self> {
        let kind = self::kind(py, kind)?;
        let mark = |(number, pixel, radius, axis, confidence): Found| {
            (number, Mark { pixel, radius, axis, confidence })
        };
        let marks: Vec<(usize, Mark)> = marks.into_iter().map(mark).collect();
        let inner = py.detach(|| annotated(&self.inner, kind, &marks));
        Ok(Self { inner, bytes: None })
    }
}

fn kind(py: Python<'_>, name: &str) -> PyResult<Kind> {
    name.parse().map_err(|error: String| errors::input(py, "kind", error))
}

/// The text of a CSV file with marks: the numbers of their disks from 1, pixels, and how sure they are.
#[pyfunction]
pub fn marks_csv(
    py: Python<'_>,
    step: Option<usize>,
    camera: Option<&str>,
    marks: Vec<(usize, [f64; 2], f64)>,
) -> PyResult<String> {
    let text = whipcord_io::marks_csv(step, camera, marks).to_csv();
    text.map_err(|error| errors::input(py, "marks", error.to_string()))
}

/// An SVG in the format that the name of a file asks for.
#[pyfunction]
pub fn picture<'py>(py: Python<'py>, svg: &str, path: PathBuf) -> PyResult<Bound<'py, PyBytes>> {
    let is_png = |path: &Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    if !is_png(&path) {
        return Ok(PyBytes::new(py, svg.as_bytes()));
    }
    let png = py.detach(|| whipcord_plot::png(svg, 2.0));
    let png = png.map_err(|error| errors::input(py, "path", error.to_string()))?;
    Ok(PyBytes::new(py, &png))
}
