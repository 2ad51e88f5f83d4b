//! The volume of balls round points, as a function of the points that has derivatives.

use std::collections::HashMap;

use whipcord::Vec3;

/// Voxels along the radius of a ball.
const VOXELS: f64 = 2.5;
/// How deep the kernel is: the density of one ball is 1 − exp(−DEPTH) in its middle.
const DEPTH: f64 = 4.0;

/// The volume in m³ of all places within about `radius` of some point, eq. (12): `∫ 1 − exp(−Σ kernel)` by voxels. The kernels end at the radius, so
/// that it is less than the volume of the balls.
pub(crate) fn soft_volume(points: impl Iterator<Item = Vec3>, radius: f64) -> f64 {
    filled(&depths(points, radius), radius)
}

/// The same, and how fast it grows where each point moves, in m².
pub(crate) fn soft_volume_slopes(
    points: impl Iterator<Item = Vec3> + Clone,
    radius: f64,
) -> (f64, Vec<Vec3>) {
    let depths = depths(points.clone(), radius);
    let cell = (radius / VOXELS).powi(3);
    let slope = |point: Vec3| {
        let mut sum = Vec3::ZERO;
        each_voxel(point, radius, |voxel, off, rest| {
            let depth = depths.get(&voxel).copied().unwrap_or(0.0);
            let of_depth = DEPTH * 3.0 * rest * rest * 2.0 / (radius * radius);
            sum += off * ((-depth).exp() * of_depth * cell);
        });
        sum
    };
    let slopes = points.map(slope).collect();
    (filled(&depths, radius), slopes)
}

/// The depth of each voxel that some point reaches.
fn depths(points: impl Iterator<Item = Vec3>, radius: f64) -> HashMap<[i64; 3], f64> {
    let mut depths: HashMap<[i64; 3], f64> = HashMap::new();
    for point in points {
        each_voxel(point, radius, |voxel, _, rest| {
            *depths.entry(voxel).or_default() += DEPTH * rest * rest * rest;
        });
    }
    depths
}

/// Visits the voxels that a point reaches: each with its middle as seen from the point, and 1 − (distance/radius)².
fn each_voxel(point: Vec3, radius: f64, mut visit: impl FnMut([i64; 3], Vec3, f64)) {
    let edge = radius / VOXELS;
    let cells = [point.x, point.y, point.z].map(|at| {
        #[allow(clippy::cast_possible_truncation, reason = "far below 2⁶³ voxels")]
        let [first, last] = [at - radius, at + radius].map(|end| (end / edge - 0.5).floor() as i64);
        first..=last + 1
    });
    for i in cells[0].clone() {
        for j in cells[1].clone() {
            for k in cells[2].clone() {
                #[allow(clippy::cast_precision_loss, reason = "far below 2⁵³ voxels")]
                let centre = Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * edge;
                let off = centre - point;
                let rest = 1.0 - off.dot(off) / (radius * radius);
                if rest > 0.0 {
                    visit([i, j, k], off, rest);
                }
            }
        }
    }
}

/// The volume of voxels of some depths.
fn filled(depths: &HashMap<[i64; 3], f64>, radius: f64) -> f64 {
    // In order, so that the sum is the same each time.
    let mut cells: Vec<([i64; 3], f64)> = depths.iter().map(|(cell, of)| (*cell, *of)).collect();
    cells.sort_unstable_by_key(|(cell, _)| *cell);
    let filled: f64 = cells.iter().map(|(_, depth)| -(-depth).exp_m1()).sum();
    filled * (radius / VOXELS).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_add_up_where_they_are_apart_and_a_dense_body_has_its_volume() {
        let radius = 0.01;
        let of = |points: &[Vec3]| soft_volume(points.iter().copied(), radius);
        let ball = 4.0 / 3.0 * core::f64::consts::PI * radius.powi(3);
        let one = of(&[Vec3::ZERO]);
        // ∫ 3 u² (1 − exp(−4 (1 − u²)³)) du = 0.3148.
        assert!((one / ball - 0.3148).abs() < 0.01, "{}", one / ball);
        let two = |apart: f64| of(&[Vec3::ZERO, Vec3::new(apart, 0.0, 0.0)]);
        assert!((two(0.03) / one - 2.0).abs() < 0.02);
        // Farther apart the volume no longer changes but by the voxels.
        let distances = [0.0, 0.004, 0.008, 0.012];
        assert!(distances.windows(2).all(|pair| two(pair[0]) < two(pair[1])));
        let at = |i: i32| f64::from(i) * 0.004;
        let cube: Vec<Vec3> = (0..=25)
            .flat_map(|i| (0..=25).flat_map(move |j| (0..=25).map(move |k| (i, j, k))))
            .map(|(i, j, k)| Vec3::new(at(i), at(j), at(k)))
            .collect();
        // A cube of 0.1 m and what is within the radius of it.
        let (inside, outside) = (0.1_f64.powi(3), 0.12_f64.powi(3));
        let volume = of(&cube);
        assert!(inside < volume && volume < outside, "{volume:e}");
        assert_eq!(of(&[]), 0.0);
    }

    #[test]
    fn the_volume_changes_smoothly_with_the_points() {
        let points: Vec<Vec3> = (0..60)
            .map(|k| {
                let t = 0.1 * f64::from(k);
                Vec3::new(0.02 * t.cos(), 0.02 * t.sin(), 0.004 * t)
            })
            .collect();
        let of = |by: f64| soft_volume(points.iter().map(|point| *point * (1.0 + by)), 0.008);
        let slope = |step: f64| (of(step) - of(-step)) / (2.0 * step);
        let (volume, slopes) = soft_volume_slopes(points.iter().copied(), 0.008);
        let exact: f64 = slopes.iter().zip(&points).map(|(slope, point)| slope.dot(*point)).sum();
        assert_eq!(volume, of(0.0));
        assert!((slope(1e-5) / exact - 1.0).abs() < 1e-6, "{} {exact}", slope(1e-5));
        assert!((slope(1e-3) / slope(1e-5) - 1.0).abs() < 0.02, "{} {}", slope(1e-3), slope(1e-5));
    }
}
