//! Convex outlines on paper, and planes in a box.

use whipcord::Vec3;

use crate::svg::Point;

/// The corners of the convex hull, counter-clockwise as the coordinates run (A. M. Andrew, Another
/// efficient algorithm for convex hulls in two dimensions, 1979).
pub(crate) fn convex(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull: Vec<Point> = Vec::new();
    let chain = |hull: &mut Vec<Point>, least: usize, point: Point| {
        while let [.., a, b] = hull[..]
            && hull.len() > least
            && (b[0] - a[0]) * (point[1] - a[1]) <= (b[1] - a[1]) * (point[0] - a[0])
        {
            hull.pop();
        }
        hull.push(point);
    };
    for &point in &sorted {
        chain(&mut hull, 1, point);
    }
    let least = hull.len();
    for &point in sorted.iter().rev().skip(1) {
        chain(&mut hull, least, point);
    }
    hull.pop();
    hull
}

/// The part of a plane, through a point and at right angles to a unit normal, that lies in a box.
pub(crate) fn plane_in_box(point: Vec3, normal: Vec3, [low, high]: [Vec3; 2]) -> Vec<Vec3> {
    let middle = 0.5 * (low + high);
    let foot = middle - (middle - point).dot(normal) * normal;
    let reach = (high - low).norm();
    let across = if normal.x.abs() < 0.6 { Vec3::X } else { Vec3::Y }.cross(normal);
    let (u, v) = (across / across.norm(), normal.cross(across) / across.norm());
    let corner = |[a, b]: [f64; 2]| foot + reach * (a * u + b * v);
    let mut polygon: Vec<Vec3> =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).into();
    for axis in 0..3 {
        polygon = cut(&polygon, |p| p[axis] - low[axis]);
        polygon = cut(&polygon, |p| high[axis] - p[axis]);
    }
    polygon
}

/// The part of a polygon where a linear function is not negative.
fn cut(polygon: &[Vec3], height: impl Fn(Vec3) -> f64) -> Vec<Vec3> {
    let mut kept = Vec::new();
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            kept.push(a);
        }
        if (ha < 0.0) != (hb < 0.0) {
            kept.push(a + (ha / (ha - hb)) * (b - a));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_grid_is_its_corners() {
        let grid: Vec<Point> = (0..25).map(|k| [f64::from(k / 5), f64::from(k % 5)]).collect();
        assert_eq!(convex(&grid), [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
        assert_eq!(convex(&[[1.0, 1.0], [1.0, 1.0]]), [[1.0, 1.0]]);
    }

    #[test]
    fn a_plane_cuts_a_box_in_what_lies_on_it() {
        let cube = [Vec3::ZERO, Vec3::new(1.0, 1.0, 1.0)];
        let level = plane_in_box(Vec3::new(5.0, 5.0, 0.25), Vec3::Z, cube);
        assert_eq!(level.len(), 4);
        assert!(level.iter().all(|p| (p.z - 0.25).abs() < 1e-15));
        // Through the middle and across the diagonal: a hexagon.
        let n = Vec3::new(1.0, 1.0, 1.0) / 3.0_f64.sqrt();
        assert_eq!(plane_in_box(Vec3::new(0.5, 0.5, 0.5), n, cube).len(), 6);
        assert!(plane_in_box(Vec3::new(0.0, 0.0, 2.0), Vec3::Z, cube).is_empty());
    }
}
