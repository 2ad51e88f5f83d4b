//! What a model tells of a robot with friction at its holes.

use whipcord_numerics::dot;

use crate::budget::Meter;
use crate::section::Fault;
use crate::statics::outcome::Failure;

/// The passages of a robot, each a piece of cable between two neighbouring holes, at one shape.
#[derive(Clone, Debug, Default)]
pub(crate) struct Passages {
    /// Length of each in m.
    pub lengths: Vec<f64>,
    /// Angle `φ` in rad by which the cable turns in the near hole of each.
    pub turns: Vec<f64>,
}

/// The derivatives of lengths and angles: for each passage a row with one column for the tension of each passage and
/// a last one for what closing the residual of the shape changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Response {
    pub lengths: Vec<f64>,
    pub turns: Vec<f64>,
}

impl Response {
    /// What the angle in the near hole of a passage changes by, with these changes of the tensions.
    pub fn turn(&self, p: usize, tensions: &[f64]) -> f64 {
        let n = tensions.len();
        dot(&self.turns[p * (n + 1)..][..n], tensions)
    }
}

/// A robot as what answers the tensions of all its passages with its shape.
pub(crate) trait PassageResponse {
    /// The unknowns of the shape.
    type Shape: Clone;

    /// The shape as it stands.
    fn shape(&self) -> Self::Shape;

    fn set_shape(&mut self, shape: &Self::Shape);

    /// Finds the shape in equilibrium under these tensions, by any way that the model has, from the robot at rest.
    ///
    /// # Errors
    /// Why there is none.
    fn converge(&mut self, tensions: &[f64]) -> Result<(), Failure>;

    /// Evaluates lengths and angles of the shape as it stands, and what is left of its equilibrium under these tensions.
    ///
    /// # Errors
    /// Where a section is folded.
    fn measure(&mut self, tensions: &[f64], at: &mut Passages) -> Result<f64, Fault>;

    /// Linearises where it was measured last, under these tensions; `false` where that is singular.
    fn respond(&mut self, tensions: &[f64], response: &mut Response) -> bool;

    /// Prepares the step of the shape that goes with these changes of the tensions and closes what is left of the
    /// equilibrium, from where it was linearised last. The greatest fraction of it that may be taken; `None` where
    /// it is not finite.
    fn prepare(&mut self, changes: &[f64]) -> Option<f64>;

    /// Goes a fraction of the prepared step from where that begins.
    fn go(&mut self, fraction: f64);

    /// What may be left of the equilibrium.
    fn tolerance(&self) -> f64;

    fn meter(&self) -> &Meter;

    /// Takes note of an iteration.
    fn note(&mut self, _iteration: usize, _residual: f64, _fraction: f64, _tensions: &[f64]) {}

    /// What a fault of the iteration under these tensions means.
    fn failure(&self, fault: Fault, tensions: &[f64]) -> Failure;
}
