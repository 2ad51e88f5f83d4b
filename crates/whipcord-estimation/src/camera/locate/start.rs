//! Poses to start from, by direct methods.

use whipcord_numerics::{Mat3, Pose, SingularValues, UnitQuaternion, Vec3};

use super::error::LocateError;
use super::sighting::Sighting;
use crate::registration::nearest_rotation;

/// Spreads below this part of the largest are none.
const FLAT: f64 = 1e-6;
/// Clouds thinner than this part of their width are looked at as planes, too.
const THIN: f64 = 0.1;

/// How the points lie: their centre, and their principal axes.
#[derive(Clone, Debug)]
pub(crate) struct Cloud {
    pub(crate) centre: Vec3,
    /// Unit vectors, the one along which the points spread most last.
    pub(super) axes: [Vec3; 3],
    /// Root mean square distances from the centre along each.
    pub(super) spreads: [f64; 3],
}

impl Cloud {
    pub(crate) fn of(seen: &[Sighting]) -> Self {
        let weight = 1.0 / seen.len() as f64;
        let centre = seen.iter().fold(Vec3::ZERO, |sum, at| sum + at.point) * weight;
        let inertia = seen.iter().fold(Mat3::ZERO, |sum, at| {
            let arm = at.point - centre;
            sum + Mat3::outer(arm, arm) * weight
        });
        let (values, [thin, middle, large]) = inertia.symmetric_eigen();
        let right_handed = thin * middle.cross(large).dot(thin).signum();
        let axes = [right_handed, middle, large];
        Self { centre, axes, spreads: values.map(|value| value.max(0.0).sqrt()) }
    }

    pub(super) fn is_one_point(&self) -> bool {
        self.spreads[2] <= (1e3 * f64::EPSILON * self.centre.max_abs()).max(1e-12)
    }

    pub(crate) fn is_line(&self) -> bool {
        self.spreads[1] <= FLAT * self.spreads[2]
    }

    pub(crate) fn is_plane(&self) -> bool {
        self.spreads[0] <= FLAT * self.spreads[2]
    }

    /// A point along the principal axes, in units of the largest spread.
    fn local(&self, point: Vec3) -> Vec3 {
        let arm = (point - self.centre) / self.spreads[2];
        Vec3::new(arm.dot(self.axes[0]), arm.dot(self.axes[1]), arm.dot(self.axes[2]))
    }

    /// The pose of a camera in the world that has the local axes at the columns of `rotation` and their
    /// origin at `origin`, in units of the largest spread.
    fn pose(&self, rotation: Mat3, origin: Vec3) -> Pose {
        let world = Mat3::from_columns(self.axes[0], self.axes[1], self.axes[2]);
        let rotation = nearest_rotation(&(world * rotation.transpose()));
        let position = self.centre - rotation.rotate(origin * self.spreads[2]);
        Pose { position, rotation }
    }
}

pub(super) fn middle(image: &[[f64; 2]]) -> [f64; 2] {
    let sum = image.iter().fold([0.0; 2], |sum, at| [sum[0] + at[0], sum[1] + at[1]]);
    sum.map(|c| c / image.len() as f64)
}

/// All poses to start from, for points on no line and their ideal images.
pub(super) fn starts(cloud: &Cloud, seen: &[Sighting], ideal: &[[f64; 2]]) -> Vec<Pose> {
    let mut starts: Vec<Pose> = weak_perspective(cloud, seen, ideal)
        .into_iter()
        .map(|(scale, pose)| {
            let middle = middle(ideal);
            let offset = Vec3::new(middle[0], middle[1], 1.0) / scale;
            Pose { position: cloud.centre - pose.rotation.rotate(offset), ..pose }
        })
        .collect();
    if !cloud.is_plane() && seen.len() >= 6 {
        starts.extend(direct(cloud, seen, ideal));
    }
    if cloud.spreads[0] <= THIN * cloud.spreads[1] {
        starts.extend(homography(cloud, seen, ideal));
    }
    starts.extend(from_all_sides(&starts, cloud.centre));
    starts
}

/// Eq. (l1) and (l2): scale, and the camera's rotation, of an image that is an affine map of the points. A
/// plane has two. The positions are left at the origin.
pub(super) fn weak_perspective(
    cloud: &Cloud,
    seen: &[Sighting],
    image: &[[f64; 2]],
) -> Vec<(f64, Pose)> {
    let centre = middle(image);
    // What is seen along each principal axis, by least squares: the axes are uncorrelated.
    let mut slopes = [[0.0; 3]; 2];
    for (at, pixel) in seen.iter().zip(image) {
        let local = cloud.local(at.point);
        for i in 0..2 {
            for j in 0..3 {
                slopes[i][j] += (pixel[i] - centre[i]) * local[j];
            }
        }
    }
    let [thin, middle, large] = cloud.spreads.map(|spread| (spread / cloud.spreads[2]).powi(2));
    let count = seen.len() as f64;
    let [m0, m1] = slopes.map(|[a, b, c]| {
        let thin = if cloud.is_plane() { 0.0 } else { a / thin };
        Vec3::new(thin, b / middle, c / large) * (1.0 / count)
    });
    let mut rows = Vec::new();
    if !cloud.is_plane() {
        rows.push([m0, m1]);
    }
    if cloud.spreads[0] <= THIN * cloud.spreads[1] {
        // (z₁ + i z₂)² = (n₂² − n₁²) − 2i n₁·n₂ makes the rows orthogonal and equally long.
        let flat = [m0, m1].map(|m| Vec3::new(0.0, m.y, m.z));
        let real = flat[1].norm_squared() - flat[0].norm_squared();
        let imaginary = -2.0 * flat[0].dot(flat[1]);
        let size = real.hypot(imaginary);
        let z0 = (0.5 * (size + real)).max(0.0).sqrt();
        let z1 = (0.5 * (size - real)).max(0.0).sqrt().copysign(imaginary);
        for sign in [1.0, -1.0] {
            rows.push([flat[0] + sign * z0 * Vec3::X, flat[1] + sign * z1 * Vec3::X]);
        }
    }
    rows.into_iter()
        .filter_map(|[a, b]| {
            let (first, second) = (a.norm(), b.norm());
            if first.min(second) <= f64::MIN_POSITIVE {
                return None;
            }
            let third = (a / first).cross(b / second);
            let pose = cloud.pose(Mat3::from_rows(a / first, b / second, third), Vec3::ZERO);
            let scale = 0.5 * (first + second) / cloud.spreads[2];
            scale.is_finite().then_some((scale, pose))
        })
        .collect()
}

/// Eq. (l3): the direct linear transform, of six points or more on no plane.
fn direct(cloud: &Cloud, seen: &[Sighting], ideal: &[[f64; 2]]) -> Option<Pose> {
    let mut rows = Vec::with_capacity(24 * seen.len());
    for (at, [x, y]) in seen.iter().zip(ideal) {
        let p = cloud.local(at.point);
        let point = [p.x, p.y, p.z, 1.0];
        let zeros = [0.0; 4];
        rows.extend(point.iter().chain(&zeros).copied().chain(point.map(|c| -x * c)));
        rows.extend(zeros.iter().chain(&point).copied().chain(point.map(|c| -y * c)));
    }
    let found = SingularValues::of(12, &rows);
    let h = found.direction(11);
    let block = Mat3::from_rows(
        Vec3::new(h[0], h[1], h[2]),
        Vec3::new(h[4], h[5], h[6]),
        Vec3::new(h[8], h[9], h[10]),
    );
    scaled(cloud, block, Vec3::new(h[3], h[7], h[11]))
}

/// Eq. (l4): the pose of a plane from its homography.
fn homography(cloud: &Cloud, seen: &[Sighting], ideal: &[[f64; 2]]) -> Option<Pose> {
    let [middle, large, origin] = plane_columns(cloud, seen, ideal);
    let sign = if origin.z < 0.0 { -1.0 } else { 1.0 };
    let (middle, large) = (middle * sign, large * sign);
    let size = 0.5 * (middle.norm() + large.norm());
    if size <= f64::MIN_POSITIVE {
        return None;
    }
    let thin = middle.cross(large) * (1.0 / size);
    scaled(cloud, Mat3::from_columns(thin, middle, large), origin * sign)
}

/// The columns of the homography of a plane, up to a factor: for its two axes and for its centre.
pub(crate) fn plane_columns(cloud: &Cloud, seen: &[Sighting], image: &[[f64; 2]]) -> [Vec3; 3] {
    let mut rows = Vec::with_capacity(18 * seen.len());
    for (at, [x, y]) in seen.iter().zip(image) {
        let p = cloud.local(at.point);
        let point = [p.y, p.z, 1.0];
        let zeros = [0.0; 3];
        rows.extend(point.iter().chain(&zeros).copied().chain(point.map(|c| -x * c)));
        rows.extend(zeros.iter().chain(&point).copied().chain(point.map(|c| -y * c)));
    }
    let found = SingularValues::of(9, &rows);
    let h = found.direction(8);
    [0, 1, 2].map(|k| Vec3::new(h[k], h[k + 3], h[k + 6]))
}

/// The pose of a matrix that is a rotation times a factor, and of the origin times the same.
fn scaled(cloud: &Cloud, block: Mat3, origin: Vec3) -> Option<Pose> {
    let sign = if origin.z < 0.0 { -1.0 } else { 1.0 };
    let size = block.rows.iter().map(|row| row.norm()).sum::<f64>() / 3.0;
    (size > f64::MIN_POSITIVE && origin.is_finite())
        .then(|| cloud.pose(block * (sign / size), origin * (sign / size)))
}

/// What a pose looks like from the other side, (l5), and with its view turned by right angles: a start for each
/// valley that a few points may have.
fn from_all_sides(starts: &[Pose], centre: Vec3) -> Vec<Pose> {
    let mut all = Vec::new();
    for start in starts {
        let sight = centre - start.position;
        let distance = sight.norm();
        if distance <= f64::MIN_POSITIVE {
            continue;
        }
        let (a, b) = across(sight / distance);
        for axis in [a, b] {
            for quarter in 1..=3 {
                let angle = 0.25 * core::f64::consts::TAU * f64::from(quarter);
                let turn = UnitQuaternion::exp(axis * angle);
                all.push(Pose {
                    position: centre - turn.rotate(sight),
                    rotation: (turn * start.rotation).renormalized(),
                });
            }
        }
    }
    all
}

/// Points on a line, seen from a side that `view` chooses.
pub(super) fn on_a_line(
    cloud: &Cloud,
    seen: &[Sighting],
    ideal: &[[f64; 2]],
    view: Vec3,
) -> Result<Pose, LocateError> {
    let axis = cloud.axes[2];
    if axis.cross(view).norm() < 1e-6 {
        return Err(LocateError::ViewAlongLine);
    }
    // P = A + s B: two homogeneous equations for each point.
    let mut rows = Vec::with_capacity(12 * seen.len());
    for (at, [x, y]) in seen.iter().zip(ideal) {
        let s = cloud.local(at.point).z;
        rows.extend([1.0, s, 0.0, 0.0, -x, -x * s]);
        rows.extend([0.0, 0.0, 1.0, s, -y, -y * s]);
    }
    let found = SingularValues::of(6, &rows);
    let h = found.direction(5);
    let (origin, along) = (Vec3::new(h[0], h[2], h[4]), Vec3::new(h[1], h[3], h[5]));
    let size = along.norm().copysign(origin.z);
    if size.abs() <= f64::MIN_POSITIVE {
        return Err(LocateError::NoPose { given: seen.len() });
    }
    let (origin, along) = (origin / size, along / size);
    // Any camera that has the line there; then round the line to the side that looks along the view.
    let (a, b) = across(along);
    let (c, d) = across(axis);
    let world = Mat3::from_columns(c, d, axis);
    let rotation = nearest_rotation(&(world * Mat3::from_columns(a, b, along).transpose()));
    let position = cloud.centre - rotation.rotate(origin * cloud.spreads[2]);
    Ok(round_line(cloud, Pose { position, rotation }, view))
}

/// The pose turned about the line of the points until its optical axis is nearest to `view`.
pub(super) fn round_line(cloud: &Cloud, pose: Pose, view: Vec3) -> Pose {
    let axis = cloud.axes[2];
    let across_line = |v: Vec3| v - axis * axis.dot(v);
    let sight = across_line(pose.rotation.rotate(Vec3::Z));
    let wanted = across_line(view);
    let angle = axis.dot(sight.cross(wanted)).atan2(sight.dot(wanted));
    let turn = UnitQuaternion::exp(axis * angle);
    Pose {
        position: cloud.centre + turn.rotate(pose.position - cloud.centre),
        rotation: (turn * pose.rotation).renormalized(),
    }
}

/// Eq. (l7): the scale and the rotation of an orthographic camera that looks along `view`, by a
/// similarity of the plane across it.
pub(super) fn along_view(
    cloud: &Cloud,
    seen: &[Sighting],
    pixels: &[[f64; 2]],
    view: Vec3,
) -> Result<(f64, Pose), LocateError> {
    let (right, down) = across(view);
    let centre = middle(pixels);
    let (mut real, mut imaginary, mut size) = (0.0, 0.0, 0.0);
    for (at, pixel) in seen.iter().zip(pixels) {
        let arm = at.point - cloud.centre;
        let (x, y) = (arm.dot(right), arm.dot(down));
        let (u, v) = (pixel[0] - centre[0], pixel[1] - centre[1]);
        real += x * u + y * v;
        imaginary += x * v - y * u;
        size += x * x + y * y;
    }
    if size.sqrt() <= FLAT * cloud.spreads[2] {
        return Err(LocateError::ViewAlongLine);
    }
    // The image is the plane turned by the argument of this and scaled by its magnitude.
    let scale = real.hypot(imaginary) / size;
    if scale <= f64::MIN_POSITIVE || !scale.is_finite() {
        return Err(LocateError::NoPose { given: seen.len() });
    }
    let angle = imaginary.atan2(real);
    let turn = UnitQuaternion::exp(view * -angle);
    let axes = Mat3::from_columns(turn.rotate(right), turn.rotate(down), view);
    Ok((scale, Pose { position: Vec3::ZERO, rotation: nearest_rotation(&axes) }))
}

/// Two directions that are across a unit vector and one another.
pub(super) fn across(axis: Vec3) -> (Vec3, Vec3) {
    let least = if axis.x.abs() <= axis.y.abs().min(axis.z.abs()) {
        Vec3::X
    } else if axis.y.abs() <= axis.z.abs() {
        Vec3::Y
    } else {
        Vec3::Z
    };
    let a = axis.cross(least);
    let a = a / a.norm();
    (a, axis.cross(a))
}
