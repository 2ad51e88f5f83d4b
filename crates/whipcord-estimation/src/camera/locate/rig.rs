//! Where two cameras are that are fastened to one another, from points of the world that they have seen.

use whipcord_numerics::least_squares::{Options, Residuals, Workspace, minimise};
use whipcord_numerics::{Pose, Vec3};

use super::error::LocateError;
use super::refine::{Freedoms, InImage, residuals};
use super::sighting::{Alternative, Sighting};
use super::single::{SAME, cloud, locate};
use super::start::Cloud;
use super::uncertainty::PoseUncertainty;
use crate::camera::error::ViewError;
use crate::camera::lens::Lens;
use crate::camera::triangulate::triangulate;
use crate::camera::view::Camera;
use crate::registration::{Alignment, align};

/// Two cameras in their places, and how well they explain what was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct LocatedRig {
    /// The cameras. The second one is in the frame of the first where it was.
    pub cameras: [Camera; 2],
    /// By how many columns and rows each camera sees each of its points beside where it has the point.
    pub residuals: [Vec<[f64; 2]>; 2],
    /// The root of their mean square distance in each image, in pixels; 0 where a camera sees nothing.
    pub rms: [f64; 2],
    /// The next best place of the first camera, where there is one, with the root mean square distance over both images.
    pub other: Option<Alternative>,
    /// How sure the pose of the first camera is; lenses and the pose of the second camera relative to the first are taken as they are, and
    /// so is a direction of view that is given.
    pub uncertainty: PoseUncertainty,
}

impl LocatedRig {
    /// The root mean square distance over both images, in pixels.
    #[must_use]
    pub fn rms_of_both(&self) -> f64 {
        rms(&self.residuals)
    }

    /// Whether what was seen does not tell the two places apart.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        const ROUNDING: f64 = 1e-9;
        self.other.is_some_and(|other| other.rms <= 1.5 * self.rms_of_both() + ROUNDING)
    }
}

/// The place of two pinhole cameras whose pose relative to one another is known, such that the squares of the distances in both images are
/// least. They need four points in one image, or three that both see; points on one line need `view`, in which direction of the world
/// the first camera looks, as in [`locate`].
///
/// # Errors
/// [`LocateError`] where the points do not fix the place; points are counted over both images, those of the first before those of the second.
pub fn locate_rig(
    cameras: [&Camera; 2],
    seen: [&[Sighting]; 2],
    view: Option<Vec3>,
) -> Result<LocatedRig, LocateError> {
    let relative = cameras[0].pose().inverse() * cameras[1].pose();
    let all: Vec<Sighting> = seen.concat();
    let cloud = cloud(&all, 3)?;
    let axis = cloud.axes[2];
    let freedoms = match cloud.is_line() {
        true if view.is_none() => return Err(LocateError::FreeTurn { axis }),
        true => Freedoms::without_turn(axis),
        false => Freedoms::all(),
    };
    let mut starts = Vec::new();
    let mut failed = None;
    let of_one = [(0, Pose::IDENTITY), (1, relative.inverse())];
    for (camera, to_first) in of_one {
        let Lens::Pinhole(lens) = cameras[camera].lens() else { continue };
        // What the second one looks at is not known.
        let view = view.filter(|_| camera == 0);
        match locate(lens, cameras[camera].size(), seen[camera], view) {
            Ok(found) => {
                let other = found.other.map(|other| other.camera);
                let poses = [Some(found.camera), other].into_iter().flatten();
                starts.extend(poses.map(|camera| camera.pose() * to_first));
            }
            Err(error) => failed = failed.or(Some(error)),
        }
    }
    if !cloud.is_line() {
        starts.extend(from_common(cameras, seen));
    }
    if starts.is_empty() {
        return Err(failed.unwrap_or(LocateError::NoPose { given: all.len() }));
    }
    let refined =
        |start: Pose| refine([cameras[0], cameras[1]], relative, start, seen, &cloud, &freedoms);
    let mut found: Vec<([Camera; 2], f64)> = starts.into_iter().filter_map(refined).collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let &(best, _) = found.first().ok_or(LocateError::NoPose { given: all.len() })?;
    let turn =
        |other: &Camera| (other.pose().rotation * best[0].pose().rotation.conjugate()).log().norm();
    let other = found.iter().find(|(other, _)| turn(&other[0]) > SAME);
    let other = other.map(|&([camera, _], rms)| Alternative { camera, rms });
    let left = |camera: usize| {
        let first = if camera == 0 { 0 } else { seen[0].len() };
        residuals(&best[camera], seen[camera])
            .map_err(|(at, error)| LocateError::Unseen { sighting: first + at, error })
    };
    let residuals = [left(0)?, left(1)?];
    let of_image = |of: &Vec<[f64; 2]>| rms(core::slice::from_ref(of));
    let rms = [of_image(&residuals[0]), of_image(&residuals[1])];
    let squares = residuals.iter().flatten().map(|[u, v]| u * u + v * v).sum();
    let motions = freedoms.motions(&best[0], cloud.centre);
    let uncertainty =
        PoseUncertainty::of(&[(&best[0], seen[0]), (&best[1], seen[1])], &motions, squares)
            .map_err(|error| LocateError::Unseen { sighting: 0, error })?;
    Ok(LocatedRig { cameras: best, residuals, rms, other, uncertainty })
}

fn rms(residuals: &[Vec<[f64; 2]>]) -> f64 {
    let all = residuals.iter().flatten();
    let count = all.clone().count().max(1);
    (all.map(|[u, v]| u * u + v * v).sum::<f64>() / count as f64).sqrt()
}

/// The first camera in the world by the points that both see, which the two cameras have in space by themselves.
fn from_common(cameras: [&Camera; 2], seen: [&[Sighting]; 2]) -> Option<Pose> {
    let mut pairs = Vec::new();
    for at in seen[0] {
        let Some(same) = seen[1].iter().find(|other| other.point == at.point) else { continue };
        let there = triangulate(cameras, [at.pixel, same.pixel], 1.0).ok()?;
        pairs.push(([there.point, at.point], false));
    }
    let points: Vec<Sighting> =
        pairs.iter().map(|([_, point], _)| Sighting { point: *point, pixel: [0.0; 2] }).collect();
    if points.len() < 3 || Cloud::of(&points).is_line() {
        return None;
    }
    let to_world = align(pairs, Alignment::Rigid).ok()?.motion?;
    Some(to_world * cameras[0].pose())
}

/// The nearest minimum, and its root mean square distance over both images.
fn refine(
    cameras: [&Camera; 2],
    relative: Pose,
    start: Pose,
    seen: [&[Sighting]; 2],
    cloud: &Cloud,
    freedoms: &Freedoms,
) -> Option<([Camera; 2], f64)> {
    let cameras = [cameras[0].at(start).ok()?, cameras[1].at(start * relative).ok()?];
    let mut problem = InBoth {
        images: [0, 1].map(|i| InImage {
            start: &cameras[i],
            seen: seen[i],
            pivot: cloud.centre,
            freedoms,
        }),
    };
    let mut unknowns = vec![0.0; freedoms.count()];
    let options = Options { iterations: 200, ..Options::default() };
    let outcome =
        minimise(&mut problem, &mut unknowns, &options, &mut Workspace::default()).ok()?;
    let [first, second] = &problem.images;
    let moved = [first.camera(&unknowns).ok()?, second.camera(&unknowns).ok()?];
    let left = [residuals(&moved[0], seen[0]).ok()?, residuals(&moved[1], seen[1]).ok()?];
    let rms = rms(&left);
    // Where everything fits to rounding there is no descent left to converge by.
    (outcome.status.is_converged() || rms <= 1e-9).then_some((moved, rms))
}

/// What is made small: the distances in both images, while the cameras move together about the centre of all points.
struct InBoth<'a> {
    images: [InImage<'a>; 2],
}

impl Residuals for InBoth<'_> {
    type Refusal = ViewError;

    fn count(&self) -> usize {
        self.images.iter().map(Residuals::count).sum()
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), ViewError> {
        let [first, second] = &mut self.images;
        let (a, b) = into.split_at_mut(first.count());
        first.residuals(unknowns, a)?;
        second.residuals(unknowns, b)
    }

    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), ViewError> {
        let [first, second] = &mut self.images;
        let (a, b) = into.split_at_mut(first.count() * unknowns.len());
        first.jacobian(unknowns, a)?;
        second.jacobian(unknowns, b)
    }
}
