//! The equations of a model with generalised coordinates at an answer, linearised, and how they change with a parameter.

use whipcord_numerics::{Vec3, derivative, dot};

use super::column::unit_wrench;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::shape::Wrench;

/// Numbers that the dense equations of an answer may have.
const MOST_NUMBERS: usize = 1 << 24;
/// Step of the differences that tell what parameters change in the equations, as a part of a change that matters.
const PARAMETER_STEP: f64 = 2e-3;

/// The equations of a model at an answer, linearised; matrices by rows.
#[derive(Clone, Debug)]
pub(crate) struct LinearSystem {
    /// Number of coordinates.
    pub coordinates: usize,
    /// `H⁻¹`.
    pub inverse: Vec<f64>,
    /// `C`: a row for each cable; where cables rub, one for each passage, and then one for the angle in the near hole of each.
    pub lengths: Vec<f64>,
    /// How force and moment at the base change with a unit of each generalised force: six rows.
    pub base: Vec<f64>,
    /// `J`: six rows for each place, those of its point first, in the frame of the base.
    pub jacobian: Vec<f64>,
    /// Where the places are, in the frame of the base.
    pub positions: Vec<Vec3>,
}

impl LinearSystem {
    /// How a component of the motion of a place goes with the coordinates.
    pub fn row(&self, place: usize, component: usize) -> &[f64] {
        let (n, at) = (self.coordinates, 6 * place + component);
        &self.jacobian[at * n..(at + 1) * n]
    }

    pub fn solve(&self, force: &[f64]) -> Vec<f64> {
        self.inverse.chunks_exact(self.coordinates.max(1)).map(|row| dot(row, force)).collect()
    }

    pub fn solve_transposed(&self, worth: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.coordinates];
        for (row, w) in self.inverse.chunks_exact(self.coordinates.max(1)).zip(worth) {
            add(&mut out, *w, row);
        }
        out
    }

    pub fn base_of(&self, force: &[f64]) -> Wrench {
        let row =
            |a: usize| dot(&self.base[a * self.coordinates..(a + 1) * self.coordinates], force);
        let [x, y, z, u, v, w] = core::array::from_fn(row);
        Wrench { force: Vec3::new(x, y, z), moment: Vec3::new(u, v, w) }
    }

    /// What a component of a wrench on a place exerts on the base.
    pub fn at_base(&self, place: usize, component: usize) -> Wrench {
        let Wrench { force, moment } = unit_wrench(component);
        Wrench { force, moment: moment + self.positions[place].cross(force) }
    }
}

/// How the equations change with a parameter at constant coordinates and tensions.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParameterChange {
    /// `−∂r/∂p`.
    pub force: Vec<f64>,
    /// Of the cables' lengths, or of lengths and angles of all passages.
    pub lengths: Vec<f64>,
    /// Of the wrench at the base.
    pub base: Wrench,
    /// Of the length that each cable is to keep, with its own stretch at its tension; where cables rub, of what
    /// [`Equations::targets`] has there.
    pub targets: Vec<f64>,
    /// Of what friction against bending keeps of the answer.
    pub kept: Vec<f64>,
    /// Of gravity in the frame of the base, which pulls at movable objects too.
    pub gravity: Vec3,
}

/// The equations at given coordinates and tensions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Equations {
    /// `r`.
    pub residuals: Vec<f64>,
    /// Of the cables, or lengths and angles of all passages.
    pub lengths: Vec<f64>,
    /// The length that each cable is to keep, with its own stretch; or what the equations of the holes have besides.
    pub targets: Vec<f64>,
    pub base: Wrench,
    /// What friction against bending keeps; empty without it.
    pub kept: Vec<f64>,
}

impl ParameterChange {
    /// Of a parameter that changes none of so many equations and outputs.
    pub fn none(coordinates: usize, outputs: usize) -> Self {
        Self { force: vec![0.0; coordinates], lengths: vec![0.0; outputs], ..Self::default() }
    }

    /// Takes a part of it.
    pub fn scale(&mut self, part: f64) {
        let lists = [&mut self.force, &mut self.lengths, &mut self.targets, &mut self.kept];
        lists.into_iter().flatten().for_each(|value| *value *= part);
        self.base = Wrench { force: self.base.force * part, moment: self.base.moment * part };
        self.gravity *= part;
    }

    /// By differences of the equations of robots whose parameter differs by so much; `scale` is a change of it that matters.
    pub fn by_differences(
        scale: f64,
        mut equations: impl FnMut(f64) -> Result<Equations, SolveError>,
    ) -> Result<Self, SolveError> {
        let (mut coordinates, mut outputs, mut of_holes) = (0, 0, 0);
        let values = |by: f64| -> Result<Vec<f64>, SolveError> {
            let Equations { residuals, lengths, targets, base, kept } = equations(by)?;
            (coordinates, outputs, of_holes) = (residuals.len(), lengths.len(), targets.len());
            let base = [base.force, base.moment].map(<[f64; 3]>::from).concat();
            Ok([residuals, lengths, base, targets, kept].concat())
        };
        let mut change = derivative(values, PARAMETER_STEP * scale)?;
        let kept = change.split_off(coordinates + outputs + 6 + of_holes);
        let targets = change.split_off(coordinates + outputs + 6);
        let base = change.split_off(coordinates + outputs);
        let lengths = change.split_off(coordinates);
        change.iter_mut().for_each(|residual| *residual = -*residual);
        let vector = |at: usize| [base[at], base[at + 1], base[at + 2]].into();
        let base = Wrench { force: vector(0), moment: vector(3) };
        Ok(Self { force: change, lengths, base, targets, kept, gravity: Vec3::ZERO })
    }
}

/// The places that derivatives are known of.
#[derive(Clone, Debug)]
pub(crate) struct KnownPlaces {
    /// In m, from the base on.
    pub arc_lengths: Vec<f64>,
    /// By their numbers among these.
    pub stations: Vec<usize>,
    pub disks: Vec<usize>,
    /// Where contacts hold the answer.
    pub contacts: Vec<usize>,
}

impl KnownPlaces {
    /// Of these arc lengths in m, for a model that has so many coordinates.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] where the dense equations of all of them take too much memory.
    pub fn new(
        model: ModelKind,
        coordinates: usize,
        [stations, disks, contacts]: [&[f64]; 3],
    ) -> Result<Self, SolveError> {
        let mut arc_lengths = [stations, disks, contacts].concat();
        arc_lengths.sort_by(f64::total_cmp);
        arc_lengths.dedup();
        if coordinates * (coordinates + 6 * arc_lengths.len()) > MOST_NUMBERS {
            return Err(SolveError::Unsupported {
                model,
                path: "a request for derivatives".to_owned(),
                what: "so many sections and stations that their dense equations take too much memory",
                advice: "ask for fewer stations, or use cosserat-disks",
            });
        }
        let numbers = |places: &[f64]| {
            places.iter().map(|s| arc_lengths.partition_point(|there| there < s)).collect()
        };
        let (stations, disks, contacts) = (numbers(stations), numbers(disks), numbers(contacts));
        Ok(Self { arc_lengths, stations, disks, contacts })
    }
}

/// `sum += f · other`.
pub(super) fn add(sum: &mut [f64], f: f64, other: &[f64]) {
    sum.iter_mut().zip(other).for_each(|(sum, x)| *sum += f * x);
}
