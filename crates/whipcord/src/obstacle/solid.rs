//! Bodies whose distance has a closed form.

use whipcord_numerics::Vec3;

use super::surface::Surface;

/// A ball about the origin.
pub(super) fn ball(radius: f64, point: Vec3) -> Surface {
    let away = point.norm();
    let normal = if away > 0.0 { point / away } else { Vec3::Z };
    Surface { distance: away - radius, normal }
}

/// A ball about the point of the segment |z| ≤ length/2 that is nearest.
pub(super) fn capsule(radius: f64, length: f64, point: Vec3) -> Surface {
    let half = 0.5 * length;
    let away = Vec3::new(point.x, point.y, point.z - point.z.clamp(-half, half));
    // On the segment every way out across it is as short.
    if away == Vec3::ZERO {
        return Surface { distance: -radius, normal: Vec3::X };
    }
    ball(radius, away)
}

/// A box about the origin. With q = |p| − size/2 by component, the distance is |max(q, 0)| outside
/// and the largest component of q inside.
pub(super) fn cuboid(size: Vec3, point: Vec3) -> Surface {
    let q = [0, 1, 2].map(|i| point[i].abs() - 0.5 * size[i]);
    let (distance, normal) = corner(q);
    let signed = [0, 1, 2].map(|i| if point[i] < 0.0 { -normal[i] } else { normal[i] });
    Surface { distance, normal: signed.into() }
}

/// A cylinder about the z axis: a box in the plane of the point and the axis.
pub(super) fn cylinder(radius: f64, length: f64, point: Vec3) -> Surface {
    let across = point.x.hypot(point.y);
    let (distance, [radial, axial]) = corner([across - radius, point.z.abs() - 0.5 * length]);
    let (x, y) = if across > 0.0 { (point.x / across, point.y / across) } else { (1.0, 0.0) };
    let axial = if point.z < 0.0 { -axial } else { axial };
    Surface { distance, normal: Vec3::new(radial * x, radial * y, axial) }
}

/// The distance from the corner of the orthant q ≤ 0, and its gradient.
fn corner<const N: usize>(q: [f64; N]) -> (f64, [f64; N]) {
    let mut deepest = 0;
    for i in 1..N {
        if q[i] > q[deepest] {
            deepest = i;
        }
    }
    let mut gradient = [0.0; N];
    if q.iter().filter(|&&q| q > 0.0).count() <= 1 {
        gradient[deepest] = 1.0;
        return (q[deepest], gradient);
    }
    let outside = q.map(|q| q.max(0.0));
    // Divided by the largest first, lest squares of what is small vanish.
    let scaled = outside.map(|q| q / outside[deepest]);
    let norm = scaled.iter().map(|q| q * q).sum::<f64>().sqrt();
    (outside[deepest] * norm, scaled.map(|q| q / norm))
}
