//! The lens of a camera, from photographs of a board: eq. (k1) to (k5) of `docs/theory/cameras.md`.

mod calibrated;
mod error;
mod start;
mod warning;

use whipcord_numerics::least_squares::{NoResiduals, Options, Residuals, Workspace, minimise};
use whipcord_numerics::{Pose, Vec3};

use super::deflation::without_places;
use super::distortion::Distortion;
use super::error::{CameraError, ViewError};
use super::lens::{Lens, Pinhole};
use super::locate::{Cloud, Freedoms, InImage, LocateError, Sighting, locate};
use super::view::Camera;
use crate::uncertainty::Spread;
pub use calibrated::{Calibrated, FreeParameters, LensDeviations};
pub use error::CalibrateError;
use start::first_lens;
pub use warning::CalibrationWarning;

/// The lens with which a camera, whose images have this size, has seen a flat board in several
/// photographs, such that the squares of the distances in the image are least. Each list has what was
/// seen in one photograph, with the points in the frame of the board, in m.
///
/// The free parameters are the focal lengths, the principal point and distortion coefficients.
///
/// # Errors
/// [`CalibrateError`] where the photographs do not fix the lens.
pub fn calibrate(
    size: [u32; 2],
    views: &[Vec<Sighting>],
    free_parameters: FreeParameters,
) -> Result<Calibrated, CalibrateError> {
    const LEAST: usize = 3;
    /// A focal length that is known less well than this, relative to it, is not known.
    const LOOSE: f64 = 0.2;
    if views.len() < LEAST {
        return Err(CalibrateError::TooFew { given: views.len(), least: LEAST });
    }
    let points: usize = views.iter().map(Vec::len).sum();
    let count = 4 + free_parameters.counts()[1] + 6 * views.len();
    if 2 * points <= count {
        let least = count / 2 + 1;
        return Err(CalibrateError::TooFewPoints { points, unknowns: count, least });
    }
    let start = first_lens(size, views)?;
    // Where the homographies alone tell nothing all points together may: most lenses are about as long as this.
    let usual = || {
        let focal = 1.2 * f64::from(size[0].max(size[1]));
        Pinhole::new([focal; 2], size.map(|n| 0.5 * (f64::from(n) - 1.0)), Distortion::NONE)
    };
    let start = start.map_or_else(usual, Ok)?;
    let cameras = views
        .iter()
        .enumerate()
        .map(|(view, seen)| {
            let found = locate(&start, Some(size), seen, None);
            found
                .map(|found| found.camera)
                .map_err(|error| CalibrateError::NotLocated { view, error })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let pivots = views.iter().map(|seen| Cloud::of(seen).centre).collect();
    let freedoms = Freedoms::all();
    let mut problem = Boards { views, cameras, pivots, freedoms: &freedoms, free_parameters };
    let mut unknowns = vec![0.0; count];
    let ([fx, fy], [cx, cy]) = (start.focal(), start.centre());
    unknowns[..4].copy_from_slice(&[fx, fy, cx, cy]);
    let options = Options { iterations: 300, ..Options::default() };
    let outcome = minimise(&mut problem, &mut unknowns, &options, &mut Workspace::default());
    let outcome = outcome.map_err(|error| match error {
        NoResiduals::Refused(error) => error,
        NoResiduals::NotFinite => CalibrateError::NoLens,
    })?;
    let rms = (2.0 * outcome.cost / points as f64).sqrt();
    let poses = problem.poses(&unknowns)?;
    let tilt = tilt(&poses);
    let variance = 2.0 * outcome.cost / (2 * points - count) as f64;
    let spread = Spread::of(
        &problem.jacobian_of_lens(&unknowns)?,
        &vec![true; problem.lens_unknowns()],
        variance,
        false,
    );
    let deviation = |i: usize| spread.deviations[i];
    let relative = [0, 1].map(|i| deviation(i).map(|deviation| deviation / unknowns[i]));
    let [Some(x), Some(y)] = relative else {
        return Err(CalibrateError::NoFocalLength { tilt, relative: None });
    };
    if x.max(y) > LOOSE {
        return Err(CalibrateError::NoFocalLength { tilt, relative: Some(x.max(y)) });
    }
    if !outcome.status.is_converged() && rms > 1e-9 {
        return Err(CalibrateError::NotConverged { rms, iterations: outcome.iterations });
    }
    let [Some(cx), Some(cy)] = [deviation(2), deviation(3)] else {
        return Err(CalibrateError::NoFocalLength { tilt, relative: Some(x.max(y)) });
    };
    let mut residuals = vec![0.0; problem.count()];
    problem.residuals(&unknowns, &mut residuals)?;
    let (mut view_rms, mut rest) = (Vec::new(), &residuals[..]);
    for seen in views {
        let (part, after) = rest.split_at(2 * seen.len());
        rest = after;
        view_rms.push((part.iter().map(|r| r * r).sum::<f64>() / seen.len() as f64).sqrt());
    }
    let [all, found] = free_parameters.counts();
    let deviations = LensDeviations {
        focal: [x * unknowns[0], y * unknowns[1]],
        centre: [cx, cy],
        distortion: (0..all)
            .map(|i| if i < found { deviation(4 + i) } else { Some(0.0) })
            .collect(),
        pixel: variance.sqrt(),
        covariance: spread.covariance(),
    };
    let lens = problem.lens(&unknowns)?;
    Ok(Calibrated { lens, free_parameters, deviations, poses, tilt, view_rms, rms })
}

/// Greatest angle in rad between the planes z = 0 of two boards, from where the camera was before each.
fn tilt(poses: &[Pose]) -> f64 {
    let normals: Vec<Vec3> =
        poses.iter().map(|pose| pose.rotation.conjugate().rotate(Vec3::Z)).collect();
    let pairs =
        normals.iter().enumerate().flat_map(|(i, a)| normals[..i].iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| a.cross(*b).norm().atan2(a.dot(*b))).fold(0.0, f64::max)
}

/// All photographs: the unknowns are those of the lens, then three shifts and three turns of each camera.
struct Boards<'a> {
    views: &'a [Vec<Sighting>],
    cameras: Vec<Camera>,
    pivots: Vec<Vec3>,
    freedoms: &'a Freedoms,
    free_parameters: FreeParameters,
}

impl Boards<'_> {
    fn lens_unknowns(&self) -> usize {
        4 + self.free_parameters.counts()[1]
    }

    fn lens(&self, unknowns: &[f64]) -> Result<Pinhole, CameraError> {
        let mut coefficients = [0.0; 12];
        let [all, found] = self.free_parameters.counts();
        coefficients[..found].copy_from_slice(&unknowns[4..4 + found]);
        let distortion = Distortion::new(&coefficients[..all])?;
        Pinhole::new([unknowns[0], unknowns[1]], [unknowns[2], unknowns[3]], distortion)
    }

    /// The shifts and turns of a camera.
    fn place<'b>(&self, view: usize, unknowns: &'b [f64]) -> &'b [f64] {
        let first = self.lens_unknowns() + 6 * view;
        &unknowns[first..first + 6]
    }

    /// A camera where it started, with the lens of these unknowns.
    fn camera(&self, view: usize, unknowns: &[f64]) -> Result<Camera, CameraError> {
        let start = &self.cameras[view];
        Camera::new(Lens::Pinhole(self.lens(unknowns)?), start.pose(), start.size())
    }

    /// Where the camera was for each photograph.
    fn poses(&self, unknowns: &[f64]) -> Result<Vec<Pose>, CalibrateError> {
        let pose = |view: usize| {
            let camera = self.camera(view, unknowns)?;
            let moved = self.in_image(view, &camera).camera(self.place(view, unknowns));
            Ok(moved.map_err(|error| not_seen(view, error))?.pose())
        };
        (0..self.views.len()).map(pose).collect()
    }

    /// Eq. (k4): the Jacobian's columns of the lens, less what the place of each camera can make up for.
    fn jacobian_of_lens(&mut self, unknowns: &[f64]) -> Result<Vec<f64>, CalibrateError> {
        let (width, own) = (unknowns.len(), self.lens_unknowns());
        let mut jacobian = vec![0.0; self.count() * width];
        self.jacobian(unknowns, &mut jacobian)?;
        let rows = self.views.iter().map(|seen| 2 * seen.len());
        Ok(without_places(jacobian, width, own, rows))
    }

    fn in_image<'b>(&'b self, view: usize, start: &'b Camera) -> InImage<'b> {
        let pivot = self.pivots[view];
        InImage { start, seen: &self.views[view], pivot, freedoms: self.freedoms }
    }
}

impl Residuals for Boards<'_> {
    type Refusal = CalibrateError;

    fn count(&self) -> usize {
        self.views.iter().map(|seen| 2 * seen.len()).sum()
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), CalibrateError> {
        let mut rest = into;
        for view in 0..self.views.len() {
            let (part, after) = rest.split_at_mut(2 * self.views[view].len());
            rest = after;
            let camera = self.camera(view, unknowns)?;
            let place = self.place(view, unknowns);
            self.in_image(view, &camera)
                .residuals(place, part)
                .map_err(|error| not_seen(view, error))?;
        }
        Ok(())
    }

    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), CalibrateError> {
        let (width, own) = (unknowns.len(), self.lens_unknowns());
        into.fill(0.0);
        let mut rows = into.chunks_exact_mut(width);
        let mut part = Vec::new();
        for view in 0..self.views.len() {
            let camera = self.camera(view, unknowns)?;
            let place = self.place(view, unknowns);
            let mut in_image = self.in_image(view, &camera);
            part.clear();
            part.resize(12 * self.views[view].len(), 0.0);
            in_image.jacobian(place, &mut part).map_err(|error| not_seen(view, error))?;
            let moved = in_image.camera(place).map_err(|error| not_seen(view, error))?;
            for (at, own_rows) in self.views[view].iter().zip(part.chunks_exact(12)) {
                let lens = self.lens(unknowns)?;
                let by_lens = lens.by_parameters(moved.in_view(at.point));
                for i in 0..2 {
                    let Some(row) = rows.next() else { break };
                    for (entry, values) in row[..own].iter_mut().zip(&by_lens) {
                        *entry = values[i];
                    }
                    let first = own + 6 * view;
                    row[first..first + 6].copy_from_slice(&own_rows[6 * i..6 * (i + 1)]);
                }
            }
        }
        Ok(())
    }
}

fn not_seen(view: usize, error: ViewError) -> CalibrateError {
    CalibrateError::NotLocated { view, error: LocateError::Unseen { sighting: 0, error } }
}
