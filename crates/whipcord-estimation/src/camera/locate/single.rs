//! The pose of one camera.

use whipcord_numerics::{Pose, Vec3};

use super::error::LocateError;
use super::refine::{self, Freedoms};
use super::sighting::{Alternative, Sighting};
use super::start::{self, Cloud};
use super::uncertainty::{Motion, PoseUncertainty};
use crate::camera::lens::{Lens, Orthographic, Pinhole};
use crate::camera::view::{Camera, check_range};

/// Poses that are turned by less than this against one another, in rad, are the same minimum.
pub(super) const SAME: f64 = 1e-4;

/// Nothing is measured more exactly than to this, in pixels.
const SAME_PIXEL: f64 = 1e-3;

/// A camera in its place, and how well it explains what was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// The camera.
    pub camera: Camera,
    /// By how many columns and rows each point is seen beside where the camera has it.
    pub residuals: Vec<[f64; 2]>,
    /// The root of their mean square distance, in pixels.
    pub rms: f64,
    /// The next best pose, where there is one: a plane, or a robot that is far away, looks much the
    /// same from two sides.
    pub other: Option<Alternative>,
    /// How sure the pose is. A direction of view that is given is taken as exact.
    pub uncertainty: PoseUncertainty,
}

impl Located {
    /// Whether what was seen does not tell the two poses apart: the other one's residuals are not
    /// half as large again.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        const ROUNDING: f64 = 1e-9;
        self.other.is_some_and(|other| other.rms <= 1.5 * self.rms + ROUNDING)
    }
}

/// The pose of a pinhole camera from four points or more that it has seen, such that the squares of
/// the distances in the image are least.
///
/// Points on one line, such as the centres of the disks of a straight robot, are seen alike from all
/// sides of the line. They are refused, unless `view` says in which direction of the world the camera looks:
/// of the poses that are left it takes the one whose optical axis is nearest to that. Three points do
/// then. With points that are on no line `view` has no effect.
///
/// # Errors
/// [`LocateError`] where the points do not fix a pose, or none was found.
pub fn locate(
    lens: &Pinhole,
    size: Option<[u32; 2]>,
    seen: &[Sighting],
    view: Option<Vec3>,
) -> Result<Located, LocateError> {
    let cloud = cloud(seen, 3)?;
    let lens = Lens::Pinhole(*lens);
    let ideal = seen
        .iter()
        .enumerate()
        .map(|(sighting, at)| {
            lens.undistort(at.pixel).map_err(|error| LocateError::Unseen { sighting, error })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let refined = |start: Pose, freedoms: &Freedoms| {
        let camera = Camera::new(lens, start, size).ok()?;
        refine::refine(&camera, seen, cloud.centre, freedoms)
    };
    if cloud.is_line() {
        let axis = cloud.axes[2];
        let view = unit_view(view)?.ok_or(LocateError::FreeTurn { axis })?;
        let start = start::on_a_line(&cloud, seen, &ideal, view)?;
        let found = refined(start, &Freedoms::without_turn(axis)).and_then(|found| {
            let pose = start::round_line(&cloud, found.camera.pose(), view);
            refine::measured(&found.camera.at(pose).ok()?, seen)
        });
        let motions = |camera: &Camera| {
            let motions = Freedoms::without_turn(axis).motions(camera, cloud.centre);
            facing(motions, camera, &cloud, view)
        };
        return best(seen, found.into_iter(), motions);
    }
    if seen.len() < 4 {
        return Err(LocateError::TooFew { given: seen.len(), least: 4 });
    }
    let starts = start::starts(&cloud, seen, &ideal);
    let found = starts.into_iter().filter_map(|start| refined(start, &Freedoms::all()));
    best(seen, found, |camera| Freedoms::all().motions(camera, cloud.centre))
}

/// The scale and the pose of an orthographic camera from four points or more that it has seen, such
/// that the squares of the distances in the image are least. How far away such a camera is cannot be
/// seen: its origin is at the depth of the points' centre.
///
/// With `view`, the direction of the world in which the camera looks, only its turn about that, its
/// place and its scale are sought, and two points do: the scale comes from a known length. Points on one
/// line are refused without it.
///
/// # Errors
/// [`LocateError`] where the points do not fix a pose.
pub fn locate_orthographic(
    size: Option<[u32; 2]>,
    seen: &[Sighting],
    view: Option<Vec3>,
) -> Result<Located, LocateError> {
    let cloud = cloud(seen, 2)?;
    let pixels: Vec<[f64; 2]> = seen.iter().map(|at| at.pixel).collect();
    let centre = size.map_or([0.0; 2], |size| size.map(|n| 0.5 * (f64::from(n) - 1.0)));
    let camera = |(scale, pose): (f64, Pose)| -> Option<Camera> {
        let lens = Lens::Orthographic(Orthographic::new(scale, centre).ok()?);
        // The centre of the points is seen at its pixel and has no depth.
        let middle = start::middle(&pixels);
        let offset = Vec3::new(middle[0] - centre[0], middle[1] - centre[1], 0.0) / scale;
        let position = cloud.centre - pose.rotation.rotate(offset);
        Camera::new(lens, Pose { position, ..pose }, size).ok()
    };
    if let Some(view) = unit_view(view)? {
        let found = camera(start::along_view(&cloud, seen, &pixels, view)?);
        let found = found.and_then(|camera| refine::measured(&camera, seen));
        let motions =
            |camera: &Camera| Freedoms::along(camera.pose(), view).motions(camera, cloud.centre);
        return best(seen, found.into_iter(), motions);
    }
    if cloud.is_line() {
        return Err(LocateError::FreeTurn { axis: cloud.axes[2] });
    }
    if seen.len() < 4 {
        return Err(LocateError::TooFew { given: seen.len(), least: 4 });
    }
    let starts = start::weak_perspective(&cloud, seen, &pixels);
    let found = starts.into_iter().filter_map(camera).filter_map(|camera| {
        refine::refine(&camera, seen, cloud.centre, &Freedoms::with_scale(camera.pose()))
    });
    best(seen, found, |camera| Freedoms::with_scale(camera.pose()).motions(camera, cloud.centre))
}

/// Motions of a camera before points on a line that goes on to look as nearly along `view` as it can: each is followed by the turn about
/// the line that sees to it.
fn facing(motions: Vec<Motion>, camera: &Camera, cloud: &Cloud, view: Vec3) -> Vec<Motion> {
    let axis = cloud.axes[2];
    let sight = camera.pose().rotation.rotate(Vec3::Z);
    // What is across line and view has no part of the optical axis.
    let normal = axis.cross(view);
    let by_turn = normal.dot(axis.cross(sight));
    let turn = Motion::turn(axis, camera, cloud.centre);
    let follow = |motion: Motion| {
        let back = match by_turn {
            // A camera that looks along the line has no such turn.
            0.0 => 0.0,
            by_turn => -normal.dot(motion.turn.cross(sight)) / by_turn,
        };
        let (shift, turned) = (motion.shift + turn.shift * back, motion.turn + turn.turn * back);
        Motion { shift, turn: turned, ..motion }
    };
    motions.into_iter().map(follow).collect()
}

/// The unit vector along a viewing direction that is given.
fn unit_view(view: Option<Vec3>) -> Result<Option<Vec3>, LocateError> {
    let Some(view) = view else { return Ok(None) };
    let size = view.max_abs();
    if size > 0.0 && view.is_finite() {
        let view = view / size;
        return Ok(Some(view / view.norm()));
    }
    Err(LocateError::NoDirection)
}

pub(super) fn cloud(seen: &[Sighting], least: usize) -> Result<Cloud, LocateError> {
    let given = seen.len();
    if given < least {
        return Err(LocateError::TooFew { given, least });
    }
    for (sighting, at) in seen.iter().enumerate() {
        check_range(&at.point.to_array())
            .and_then(|()| check_range(&at.pixel))
            .map_err(|error| LocateError::Unseen { sighting, error })?;
    }
    let cloud = Cloud::of(seen);
    if cloud.is_one_point() {
        return Err(LocateError::Coincident { spread: cloud.spreads[2] });
    }
    // Seen in one pixel, points are as they would be from endlessly far away.
    let pixels: Vec<[f64; 2]> = seen.iter().map(|at| at.pixel).collect();
    let middle = start::middle(&pixels);
    let off = |[u, v]: &[f64; 2]| (u - middle[0]).hypot(v - middle[1]);
    if pixels.iter().map(off).fold(0.0, f64::max) < SAME_PIXEL {
        return Err(LocateError::NoPose { given });
    }
    Ok(cloud)
}

/// The best of what was found, and the next best one that is another minimum.
fn best(
    seen: &[Sighting],
    found: impl Iterator<Item = Alternative>,
    motions: impl Fn(&Camera) -> Vec<Motion>,
) -> Result<Located, LocateError> {
    let mut found: Vec<Alternative> = found.collect();
    found.sort_by(|a, b| a.rms.total_cmp(&b.rms));
    let Some(&Alternative { camera, rms }) = found.first() else {
        return Err(LocateError::NoPose { given: seen.len() });
    };
    let turn =
        |other: &Camera| (other.pose().rotation * camera.pose().rotation.conjugate()).log().norm();
    let other = found.iter().find(|other| turn(&other.camera) > SAME).copied();
    let residuals = refine::residuals(&camera, seen).map_err(|(sighting, error)| {
        // What was refined was projected before.
        LocateError::Unseen { sighting, error }
    })?;
    let squares = rms * rms * seen.len() as f64;
    let uncertainty = PoseUncertainty::of(&[(&camera, seen)], &motions(&camera), squares)
        .map_err(|error| LocateError::Unseen { sighting: 0, error })?;
    Ok(Located { camera, residuals, rms, other, uncertainty })
}
