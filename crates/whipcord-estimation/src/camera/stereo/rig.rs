//! The least squares in the images of both cameras: eq. (s6) to (s8).

use std::collections::HashMap;

use whipcord_numerics::least_squares::{NoResiduals, Options, Residuals, Workspace, minimise};
use whipcord_numerics::{Pose, Twist, UnitQuaternion, Vec3};

use super::error::{RefusedPair, StereoError};
use crate::camera::deflation::without_places;
use crate::camera::error::ViewError;
use crate::camera::lens::{LENS_PARAMETERS, Lens};
use crate::camera::locate::{Freedoms, InImage, Sighting};
use crate::camera::pose_uncertainty::{PoseByLens, PoseCovariance, by_lens, covariance};
use crate::camera::view::Camera;

/// What a pair shows, and where the first camera is in the frame of the board.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub(super) number: usize,
    pub(super) seen: [Vec<Sighting>; 2],
    pub(super) first: Pose,
    pub(super) renumbered: bool,
}

impl View {
    fn rows(&self) -> usize {
        2 * (self.seen[0].len() + self.seen[1].len())
    }

    /// Pixels of the corners that both photographs show.
    pub(super) fn common(&self) -> Vec<[[f64; 2]; 2]> {
        // Corners are far more than a micrometre apart.
        let key = |point: Vec3| point.to_array().map(|c| (c * 1e6).round() as i64);
        let second: HashMap<[i64; 3], [f64; 2]> =
            self.seen[1].iter().map(|at| (key(at.point), at.pixel)).collect();
        let both = self.seen[0].iter();
        both.filter_map(|at| Some([at.pixel, *second.get(&key(at.point))?])).collect()
    }
}

/// The relative pose at its minimum.
pub(super) struct Refined {
    pub(super) cameras: [Camera; 2],
    pub(super) views: Vec<View>,
    pub(super) relative: Pose,
    /// Of position and rotation; none where the pairs do not determine them.
    pub(super) covariance: Option<PoseCovariance>,
    /// How position and rotation follow the parameters of each lens.
    pub(super) by_lenses: [PoseByLens; 2],
    pub(super) pixel: f64,
    pub(super) rms: f64,
    pub(super) view_rms: Vec<[f64; 2]>,
}

impl Refined {
    /// The pair that contradicts the others most, where one does.
    pub(super) fn contradicting(&self) -> Option<(usize, RefusedPair)> {
        const LEAST: usize = 3;
        /// Corners are found more exactly than this, in pixels.
        const LARGE: f64 = 1.0;
        if self.views.len() < LEAST {
            return None;
        }
        let both = self.view_rms.iter().map(|[a, b]| (0.5 * (a * a + b * b)).sqrt());
        let mut sorted: Vec<(f64, usize)> =
            both.zip(&self.views).map(|(r, v)| (r, v.number)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (others, _) = sorted[(sorted.len() - 1) / 2];
        let &(rms, number) = sorted.last()?;
        (rms > LARGE && rms > 3.0 * others)
            .then_some((number, RefusedPair::Contradicts { rms, others }))
    }
}

/// The nearest minimum.
pub(super) fn refine(
    cameras: &[Camera; 2],
    views: Vec<View>,
    relative: Pose,
) -> Result<Refined, StereoError> {
    let freedoms = Freedoms::all();
    let mut problem = Rig { cameras, views, relative, freedoms: &freedoms };
    let mut unknowns = vec![0.0; 6 + 6 * problem.views.len()];
    // Residuals of hundredths of a pixel are differences of hundreds: their directions are not known more exactly.
    let options = Options { iterations: 200, gradient: 1e-7, ..Options::default() };
    let outcome = minimise(&mut problem, &mut unknowns, &options, &mut Workspace::default());
    let failed = StereoError::NoPose;
    let outcome = outcome.map_err(|error| match error {
        NoResiduals::Refused(_) | NoResiduals::NotFinite => failed.clone(),
    })?;
    let count = problem.count();
    let rms = (4.0 * outcome.cost / count as f64).sqrt();
    if !outcome.status.is_converged() && rms > 1e-9 {
        return Err(StereoError::NotConverged { rms });
    }
    // The covariance is that of the changes from where it ended.
    let ended = problem.ended(&unknowns).map_err(|_| failed.clone())?;
    let mut problem = Rig { freedoms: &freedoms, ..ended };
    unknowns.fill(0.0);
    let mut residuals = vec![0.0; count];
    problem.residuals(&unknowns, &mut residuals).map_err(|_| failed.clone())?;
    let mut jacobian = vec![0.0; count * unknowns.len()];
    problem.jacobian(&unknowns, &mut jacobian).map_err(|_| failed)?;
    let rows: Vec<usize> = problem.views.iter().map(View::rows).collect();
    let width = unknowns.len();
    let by_lenses = [0, 1].map(|camera| {
        let columns = problem.by_lens(camera, &unknowns).ok()?;
        let mut with_lens = Vec::with_capacity(count * (width + LENS_PARAMETERS));
        for (row, of_lens) in jacobian.chunks_exact(width).zip(columns) {
            with_lens.extend_from_slice(&row[..6]);
            with_lens.extend_from_slice(&of_lens);
            with_lens.extend_from_slice(&row[6..]);
        }
        let own = without_places(
            with_lens,
            width + LENS_PARAMETERS,
            6 + LENS_PARAMETERS,
            rows.iter().copied(),
        );
        // Pairs that do not determine the pose are refused for that.
        let by_lens = by_lens(6, &own).unwrap_or_else(|| vec![[0.0; LENS_PARAMETERS]; 6]);
        Some(core::array::from_fn(|i| by_lens[i]))
    });
    let [Some(first), Some(second)] = by_lenses else { return Err(StereoError::NoPose) };
    let own = without_places(jacobian, width, 6, rows.iter().copied());
    let spare = count.saturating_sub(unknowns.len()).max(1);
    let variance = 2.0 * outcome.cost / spare as f64;
    let (mut view_rms, mut rest) = (Vec::new(), &residuals[..]);
    for view in &problem.views {
        view_rms.push([0, 1].map(|camera| {
            let seen = view.seen[camera].len();
            let (part, after) = rest.split_at(2 * seen);
            rest = after;
            (part.iter().map(|r| r * r).sum::<f64>() / seen as f64).sqrt()
        }));
    }
    Ok(Refined {
        cameras: *cameras,
        relative: problem.relative,
        covariance: covariance(6, &own, variance)
            .map(|all| core::array::from_fn(|i| core::array::from_fn(|j| all[i][j]))),
        by_lenses: [first, second],
        views: problem.views,
        pixel: variance.sqrt(),
        rms,
        view_rms,
    })
}

/// All pairs: the unknowns are shift τ and turn φ of the second camera along and about the axes of the first, then three shifts
/// and three turns of the first camera before each board.
struct Rig<'a> {
    cameras: &'a [Camera; 2],
    views: Vec<View>,
    relative: Pose,
    freedoms: &'a Freedoms,
}

impl<'a> Rig<'a> {
    fn relative(&self, unknowns: &[f64]) -> Pose {
        let [shift, turn] =
            [0, 3].map(|i| Vec3::new(unknowns[i], unknowns[i + 1], unknowns[i + 2]));
        let rotation = (UnitQuaternion::exp(turn) * self.relative.rotation).renormalized();
        Pose { position: self.relative.position + shift, rotation }
    }

    /// Both cameras before the board of a pair, before that is moved.
    fn before(&self, view: &View, relative: Pose) -> Result<[Camera; 2], ViewError> {
        let at = |camera: usize, pose: Pose| {
            let value = pose.position.max_abs();
            self.cameras[camera].at(pose).map_err(|_| ViewError::OutOfRange { value })
        };
        Ok([at(0, view.first)?, at(1, view.first * relative)?])
    }

    /// Derivatives of the residuals by the parameters of one of the lenses.
    fn by_lens(
        &self,
        camera: usize,
        unknowns: &[f64],
    ) -> Result<Vec<[f64; LENS_PARAMETERS]>, ViewError> {
        let relative = self.relative(unknowns);
        let mut all = Vec::new();
        for (view, place) in self.views.iter().zip(unknowns[6..].chunks_exact(6)) {
            let pivot = view.centre();
            for (number, (start, seen)) in
                self.before(view, relative)?.iter().zip(&view.seen).enumerate()
            {
                let in_image = InImage { start, seen, pivot, freedoms: self.freedoms };
                let moved = in_image.camera(place)?;
                for at in seen {
                    let own = match moved.lens() {
                        Lens::Pinhole(lens) if number == camera => {
                            lens.by_parameters(moved.in_view(at.point))
                        }
                        _ => [[0.0; 2]; LENS_PARAMETERS],
                    };
                    all.extend([0, 1].map(|i| own.map(|by| by[i])));
                }
            }
        }
        Ok(all)
    }

    /// The rig, as the unknowns have it.
    fn ended(&self, unknowns: &[f64]) -> Result<Self, ViewError> {
        let relative = self.relative(unknowns);
        let mut views = self.views.clone();
        for (view, place) in views.iter_mut().zip(unknowns[6..].chunks_exact(6)) {
            let [camera, _] = self.before(view, relative)?;
            let pivot = view.centre();
            let in_image =
                InImage { start: &camera, seen: &view.seen[0], pivot, freedoms: self.freedoms };
            view.first = in_image.camera(place)?.pose();
        }
        Ok(Self { views, relative, ..*self })
    }
}

impl Residuals for Rig<'_> {
    type Refusal = ViewError;

    fn count(&self) -> usize {
        self.views.iter().map(View::rows).sum()
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), ViewError> {
        let relative = self.relative(unknowns);
        let mut rest = into;
        for (view, place) in self.views.iter().zip(unknowns[6..].chunks_exact(6)) {
            let pivot = view.centre();
            for (start, seen) in self.before(view, relative)?.iter().zip(&view.seen) {
                let (part, after) = rest.split_at_mut(2 * seen.len());
                rest = after;
                InImage { start, seen, pivot, freedoms: self.freedoms }.residuals(place, part)?;
            }
        }
        Ok(())
    }

    /// Eq. (s7).
    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), ViewError> {
        let width = unknowns.len();
        into.fill(0.0);
        let relative = self.relative(unknowns);
        let turn = Vec3::new(unknowns[3], unknowns[4], unknowns[5]);
        // The left Jacobian of the rotations is what the exponential of SE(3) has for the translation.
        let rates = [Vec3::X, Vec3::Y, Vec3::Z]
            .map(|axis| Pose::exp(Twist { linear: axis, angular: turn }).position);
        let mut rows = into.chunks_exact_mut(width);
        let mut part = Vec::new();
        for (number, view) in self.views.iter().enumerate() {
            let first = 6 + 6 * number;
            let place = &unknowns[first..first + 6];
            let pivot = view.centre();
            for (camera, (start, seen)) in
                self.before(view, relative)?.iter().zip(&view.seen).enumerate()
            {
                let mut in_image = InImage { start, seen, pivot, freedoms: self.freedoms };
                part.clear();
                part.resize(12 * seen.len(), 0.0);
                in_image.jacobian(place, &mut part)?;
                let moved = in_image.camera(place)?;
                // From the frame of the first camera to that of the board.
                let to_board = moved.pose().rotation * relative.rotation.conjugate();
                let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| to_board.rotate(axis));
                let turned = rates.map(|rate| to_board.rotate(rate));
                for (at, own) in seen.iter().zip(part.chunks_exact(12)) {
                    let projection = moved.project_with_gradient(at.point)?;
                    for i in 0..2 {
                        let Some(row) = rows.next() else { break };
                        row[first..first + 6].copy_from_slice(&own[6 * i..6 * (i + 1)]);
                        if camera == 1 {
                            for k in 0..3 {
                                row[k] = projection.by_shift[i].dot(axes[k]);
                                row[3 + k] = projection.by_turn[i].dot(turned[k]);
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
