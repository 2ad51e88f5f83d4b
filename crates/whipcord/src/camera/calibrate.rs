//! The lens of a camera, from photographs of a board: eq. (k1) to (k3) of `docs/theory/cameras.md`.

use thiserror::Error;
use whipcord_numerics::least_squares::{NoResiduals, Options, Residuals, Workspace, minimise};
use whipcord_numerics::{Pose, Vec3};

use super::lens::{Lens, Pinhole};
use super::locate::{Cloud, Freedoms, InImage, LocateError, Sighting, locate, plane_columns};
use super::{Camera, CameraError, Distortion, ViewError};

/// A lens that was calibrated, and how well it explains the photographs.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// The lens.
    pub lens: Pinhole,
    /// Where the camera was in the frame of the board, for each photograph.
    pub poses: Vec<Pose>,
    /// Root mean square distance between seen and projected points in pixels, for each photograph.
    pub view_rms: Vec<f64>,
    /// The same of all points.
    pub rms: f64,
}

/// Why a camera cannot be calibrated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CalibrateError {
    /// Too few photographs.
    #[error("a calibration needs {least} photographs of the board or more, but {given} {} given", if *given == 1 { "is" } else { "are" })]
    TooFew {
        /// Photographs given.
        given: usize,
        /// Fewest that do.
        least: usize,
    },
    /// Coefficients in a number that is not calibrated.
    #[error(
        "a calibration finds 0, 4, 5, 8 or 12 distortion coefficients, but {asked} are asked for"
    )]
    CoefficientCount {
        /// Coefficients asked for.
        asked: usize,
    },
    /// The board's points are not on a plane, or too few of them are seen.
    #[error("photograph {}: a board has four points or more, on a plane and on no line, but this one's {points} do not", view + 1)]
    NoBoard {
        /// Number of the photograph, from 0.
        view: usize,
        /// Points seen in it.
        points: usize,
    },
    /// Nothing tells the focal length.
    #[error(
        "the photographs do not tell the focal length: tilt the board to the camera by some 30°, differently in each"
    )]
    NoFocalLength,
    /// The board has no place in front of the camera.
    #[error("photograph {}: {error}", view + 1)]
    NotLocated {
        /// Number of the photograph, from 0.
        view: usize,
        /// Why.
        error: LocateError,
    },
    /// The iteration found no minimum.
    #[error(
        "no lens explains the photographs: {rms:.3} pixels RMS are left after {iterations} steps; ask for fewer coefficients, or take more photographs"
    )]
    NotConverged {
        /// What is left, in pixels.
        rms: f64,
        /// Steps taken.
        iterations: usize,
    },
    /// A lens or a place out of range.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// The lens with which a camera, whose images have this size, has seen a flat board in several
/// photographs, such that the squares of the distances in the images are least. Each list has what was
/// seen in one photograph, with the points in the frame of the board, in m.
///
/// Sought are the focal lengths, the principal point and the first 0, 4, 5, 8 or 12 of the distortion
/// coefficients.
///
/// # Errors
/// [`CalibrateError`] where the photographs do not fix the lens.
pub fn calibrate(
    size: [u32; 2],
    views: &[Vec<Sighting>],
    coefficients: usize,
) -> Result<Calibrated, CalibrateError> {
    const LEAST: usize = 3;
    if ![0, 4, 5, 8, 12].contains(&coefficients) {
        return Err(CalibrateError::CoefficientCount { asked: coefficients });
    }
    if views.len() < LEAST {
        return Err(CalibrateError::TooFew { given: views.len(), least: LEAST });
    }
    let start = first_lens(size, views)?;
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
    let mut problem = Boards { views, cameras, pivots, freedoms: &freedoms, coefficients };
    let mut unknowns = vec![0.0; problem.lens_unknowns() + 6 * views.len()];
    let ([fx, fy], [cx, cy]) = (start.focal(), start.centre());
    unknowns[..4].copy_from_slice(&[fx, fy, cx, cy]);
    let options = Options { iterations: 300, ..Options::default() };
    let points: usize = views.iter().map(Vec::len).sum();
    let rms = |cost: f64| (2.0 * cost / points as f64).sqrt();
    let outcome = minimise(&mut problem, &mut unknowns, &options, &mut Workspace::default());
    let outcome = outcome.map_err(|error| match error {
        NoResiduals::Refused(error) => error,
        NoResiduals::NotFinite => CalibrateError::NoFocalLength,
    })?;
    let rms = rms(outcome.cost);
    if !outcome.status.is_converged() && rms > 1e-9 {
        return Err(CalibrateError::NotConverged { rms, iterations: outcome.iterations });
    }
    let mut residuals = vec![0.0; problem.count()];
    problem.residuals(&unknowns, &mut residuals)?;
    let (mut poses, mut view_rms, mut first) = (Vec::new(), Vec::new(), 0);
    for (view, seen) in views.iter().enumerate() {
        let part = &residuals[first..first + 2 * seen.len()];
        first += part.len();
        view_rms.push((part.iter().map(|r| r * r).sum::<f64>() / seen.len() as f64).sqrt());
        let camera = problem.camera(view, &unknowns)?;
        let moved = problem.in_image(view, &camera).camera(problem.place(view, &unknowns));
        poses.push(moved.map_err(|error| not_seen(view, error))?.pose());
    }
    Ok(Calibrated { lens: problem.lens(&unknowns)?, poses, view_rms, rms })
}

/// Eq. (k1): the focal lengths from the homographies of the boards, with the principal point at the
/// centre of the image.
fn first_lens(size: [u32; 2], views: &[Vec<Sighting>]) -> Result<Pinhole, CalibrateError> {
    let centre = size.map(|n| 0.5 * (f64::from(n) - 1.0));
    let unit = f64::from(size[0].max(size[1]));
    // Normal equations of a 2×2 system for 1/fx² and 1/fy².
    let (mut matrix, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for (view, seen) in views.iter().enumerate() {
        let cloud = Cloud::of(seen);
        let columns = (seen.len() >= 4 && cloud.is_plane() && !cloud.is_line())
            .then(|| {
                let image: Vec<[f64; 2]> = seen
                    .iter()
                    .map(|at| [0, 1].map(|i| (at.pixel[i] - centre[i]) / unit))
                    .collect();
                plane_columns(&cloud, seen, &image)
            })
            .ok_or(CalibrateError::NoBoard { view, points: seen.len() })?;
        let [a, b, _] = columns;
        let (a, b) = (a / (a.norm() + b.norm()), b / (a.norm() + b.norm()));
        let product = |p: Vec3, q: Vec3| [p.x * q.x, p.y * q.y, p.z * q.z];
        let ([ax, ay, az], [bx, by, bz]) = (product(a, a), product(b, b));
        for [x, y, z] in [product(a, b), [ax - bx, ay - by, az - bz]] {
            matrix[0][0] += x * x;
            matrix[0][1] += x * y;
            matrix[1][1] += y * y;
            right[0] -= x * z;
            right[1] -= y * z;
        }
    }
    let [[xx, xy], [_, yy]] = matrix;
    let determinant = xx * yy - xy * xy;
    // Written so that a NaN is refused as well.
    if determinant.is_nan() || determinant <= 1e-12 * xx * yy {
        return Err(CalibrateError::NoFocalLength);
    }
    let inverse_squares = [
        (yy * right[0] - xy * right[1]) / determinant,
        (xx * right[1] - xy * right[0]) / determinant,
    ];
    // Shorter than a twentieth or longer than fifty times the image no lens of a camera is.
    if inverse_squares.iter().any(|w| w.is_nan() || !(4e-4..400.0).contains(w)) {
        return Err(CalibrateError::NoFocalLength);
    }
    let focal = inverse_squares.map(|w| unit / w.sqrt());
    Ok(Pinhole::new(focal, centre, Distortion::NONE)?)
}

/// All photographs: the unknowns are those of the lens, then three shifts and three turns of each camera.
struct Boards<'a> {
    views: &'a [Vec<Sighting>],
    cameras: Vec<Camera>,
    pivots: Vec<Vec3>,
    freedoms: &'a Freedoms,
    coefficients: usize,
}

impl Boards<'_> {
    fn lens_unknowns(&self) -> usize {
        4 + self.coefficients
    }

    fn lens(&self, unknowns: &[f64]) -> Result<Pinhole, CameraError> {
        let distortion = Distortion::new(&unknowns[4..self.lens_unknowns()])?;
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
