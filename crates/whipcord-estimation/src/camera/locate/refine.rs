//! The least squares in the image, from a start.

use whipcord_numerics::least_squares::{Options, Residuals, Workspace, minimise};
use whipcord_numerics::{Pose, Twist, UnitQuaternion, Vec3};

use super::sighting::{Alternative, Sighting};
use super::start::across;
use super::uncertainty::Motion;
use crate::camera::error::ViewError;
use crate::camera::lens::{Lens, Orthographic};
use crate::camera::view::Camera;

/// How the camera may move: shifts along, and turns about, directions of the world; and whether its
/// scale is sought.
#[derive(Clone, Debug)]
pub(crate) struct Freedoms {
    shifts: Vec<Vec3>,
    turns: Vec<Vec3>,
    scale: bool,
}

const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

impl Freedoms {
    pub(crate) fn all() -> Self {
        Self { shifts: AXES.to_vec(), turns: AXES.to_vec(), scale: false }
    }

    /// All but turns about an axis through the points.
    pub(super) fn without_turn(axis: Vec3) -> Self {
        let (a, b) = across(axis);
        Self { shifts: AXES.to_vec(), turns: vec![a, b], scale: false }
    }

    /// Those of an orthographic camera near this pose: not along its axis, but with its scale.
    pub(super) fn with_scale(pose: Pose) -> Self {
        let shifts = vec![pose.rotation.rotate(Vec3::X), pose.rotation.rotate(Vec3::Y)];
        Self { shifts, turns: AXES.to_vec(), scale: true }
    }

    /// Those of an orthographic camera that looks along `view`: not along that, and turned about that alone, but with its scale.
    pub(super) fn along(pose: Pose, view: Vec3) -> Self {
        Self { turns: vec![view], ..Self::with_scale(pose) }
    }

    /// The ways in which a camera may move about a point.
    pub(super) fn motions(&self, camera: &Camera, pivot: Vec3) -> Vec<Motion> {
        let shifts = self.shifts.iter().map(|along| Motion::shift(*along));
        let turns = self.turns.iter().map(|axis| Motion::turn(*axis, camera, pivot));
        shifts.chain(turns).chain(self.scale.then_some(Motion::SCALE)).collect()
    }

    pub(super) fn count(&self) -> usize {
        self.shifts.len() + self.turns.len() + usize::from(self.scale)
    }
}

/// What is made small: the distances in the image, while the camera moves about the points' centre.
pub(crate) struct InImage<'a> {
    pub(crate) start: &'a Camera,
    pub(crate) seen: &'a [Sighting],
    pub(crate) pivot: Vec3,
    pub(crate) freedoms: &'a Freedoms,
}

impl InImage<'_> {
    /// The turn φ about the pivot.
    fn turn(&self, unknowns: &[f64]) -> Vec3 {
        let turns = unknowns[self.freedoms.shifts.len()..].iter().zip(&self.freedoms.turns);
        turns.fold(Vec3::ZERO, |sum, (&x, &axis)| sum + x * axis)
    }

    pub(crate) fn camera(&self, unknowns: &[f64]) -> Result<Camera, ViewError> {
        let shift = unknowns
            .iter()
            .zip(&self.freedoms.shifts)
            .fold(Vec3::ZERO, |sum, (&x, &along)| sum + x * along);
        let turn = UnitQuaternion::exp(self.turn(unknowns));
        let start = self.start.pose();
        let pose = Pose {
            position: self.pivot + turn.rotate(start.position - self.pivot) + shift,
            rotation: (turn * start.rotation).renormalized(),
        };
        let lens = match (self.start.lens(), unknowns.last()) {
            (Lens::Orthographic(lens), Some(change)) if self.freedoms.scale => {
                Orthographic::new(lens.scale() * change.exp(), lens.centre())
                    .map(Lens::Orthographic)
            }
            (lens, _) => Ok(*lens),
        };
        // A camera that is out of range is out of what is computed with.
        lens.and_then(|lens| Camera::new(lens, pose, self.start.size()))
            .map_err(|_| ViewError::OutOfRange { value: shift.max_abs() })
    }
}

impl Residuals for InImage<'_> {
    type Refusal = ViewError;

    fn count(&self) -> usize {
        2 * self.seen.len()
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), ViewError> {
        let camera = self.camera(unknowns)?;
        for (at, into) in self.seen.iter().zip(into.chunks_exact_mut(2)) {
            let pixel = camera.project(at.point)?;
            into[0] = pixel[0] - at.pixel[0];
            into[1] = pixel[1] - at.pixel[1];
        }
        Ok(())
    }

    /// Eq. (l6): turned at ω = J(φ) φ̇ about the pivot, the camera's origin moves at ω × r.
    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), ViewError> {
        let camera = self.camera(unknowns)?;
        let turn = self.turn(unknowns);
        // The left Jacobian of the rotations is what the exponential of SE(3) has for the translation.
        let rates: Vec<Vec3> = self
            .freedoms
            .turns
            .iter()
            .map(|&axis| Pose::exp(Twist { linear: axis, angular: turn }).position)
            .collect();
        let arm = UnitQuaternion::exp(turn).rotate(self.start.pose().position - self.pivot);
        let width = self.freedoms.count();
        for (at, rows) in self.seen.iter().zip(into.chunks_exact_mut(2 * width)) {
            let seen = camera.project_with_gradient(at.point)?;
            for (i, row) in rows.chunks_exact_mut(width).enumerate() {
                let by_turn = seen.by_turn[i] + arm.cross(seen.by_shift[i]);
                let shifts = self.freedoms.shifts.iter().map(|along| seen.by_shift[i].dot(*along));
                let turns = rates.iter().map(|rate| by_turn.dot(*rate));
                for (entry, value) in row.iter_mut().zip(shifts.chain(turns)) {
                    *entry = value;
                }
                if let (Lens::Orthographic(lens), Some(last)) =
                    (camera.lens(), row.last_mut().filter(|_| self.freedoms.scale))
                {
                    *last = seen.pixel[i] - lens.centre()[i];
                }
            }
        }
        Ok(())
    }
}

/// The nearest minimum; none where the iteration does not converge to one.
pub(super) fn refine(
    start: &Camera,
    seen: &[Sighting],
    pivot: Vec3,
    freedoms: &Freedoms,
) -> Option<Alternative> {
    let mut problem = InImage { start, seen, pivot, freedoms };
    let mut unknowns = vec![0.0; freedoms.count()];
    let options = Options { iterations: 200, ..Options::default() };
    let outcome =
        minimise(&mut problem, &mut unknowns, &options, &mut Workspace::default()).ok()?;
    let camera = problem.camera(&unknowns).ok()?;
    let found = measured(&camera, seen)?;
    // Where everything fits to rounding there is no descent left to converge by.
    let fits = found.rms <= 1e-9;
    (outcome.status.is_converged() || fits).then_some(found)
}

/// A camera with the root mean square distance that it leaves.
pub(super) fn measured(camera: &Camera, seen: &[Sighting]) -> Option<Alternative> {
    let squares: f64 = residuals(camera, seen).ok()?.iter().map(|[u, v]| u * u + v * v).sum();
    Some(Alternative { camera: *camera, rms: (squares / seen.len() as f64).sqrt() })
}

/// Seen less projected, or the number of the point that the camera does not see.
pub(super) fn residuals(
    camera: &Camera,
    seen: &[Sighting],
) -> Result<Vec<[f64; 2]>, (usize, ViewError)> {
    let residual = |(i, at): (usize, &Sighting)| {
        let pixel = camera.project(at.point).map_err(|error| (i, error))?;
        Ok([at.pixel[0] - pixel[0], at.pixel[1] - pixel[1]])
    };
    seen.iter().enumerate().map(residual).collect()
}
