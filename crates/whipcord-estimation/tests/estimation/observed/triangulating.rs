//! Points that two cameras see, and their covariance, against formulas and statistics of their own.

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    Camera, Distortion, Lens, MatchError, Orthographic, Pinhole, TriangulateError, match_in_order,
    triangulate,
};

use super::noise::Noise;

fn lens() -> Lens {
    let distortion = Distortion::new(&[-0.21, 0.05, 1e-3, -5e-4, 0.01]).unwrap();
    Lens::Pinhole(Pinhole::new([900.0, 905.0], [320.0, 240.0], distortion).unwrap())
}

/// Two cameras that look at what is half a metre before the first, from directions with this angle between them.
fn cameras(angle: f64) -> [Camera; 2] {
    let first = Camera::new(lens(), Pose::IDENTITY, Some([640, 480])).unwrap();
    let target = Vec3::new(0.0, 0.0, 0.5);
    let rotation = UnitQuaternion::exp(Vec3::new(0.05, -angle, 0.03));
    let position = target - rotation.rotate(Vec3::new(0.01, 0.0, 0.55));
    [first, first.at(Pose { position, rotation }).unwrap()]
}

fn both(cameras: &[Camera; 2]) -> [&Camera; 2] {
    [&cameras[0], &cameras[1]]
}

fn pixels(cameras: &[Camera; 2], point: Vec3) -> [[f64; 2]; 2] {
    [0, 1].map(|i| cameras[i].project(point).unwrap())
}

const POINT: Vec3 = Vec3::new(0.04, -0.03, 0.47);

#[test]
fn points_are_found_where_they_are() {
    let pinholes = cameras(0.7);
    let parallel = |scale| Lens::Orthographic(Orthographic::new(scale, [320.0, 240.0]).unwrap());
    let orthographic = [0, 1].map(|i| {
        Camera::new(parallel([1500.0, 2100.0][i]), pinholes[i].pose(), Some([640, 480])).unwrap()
    });
    let mixed = [pinholes[0], orthographic[1]];
    for cameras in [pinholes, orthographic, mixed] {
        let mut noise = Noise::of(3);
        for _ in 0..20 {
            let mut side = || noise.between(-0.06, 0.06);
            let point = Vec3::new(0.0, 0.0, 0.5) + Vec3::new(side(), side(), side());
            let found = triangulate(both(&cameras), pixels(&cameras, point), 0.3).unwrap();
            assert!((found.point - point).norm() < 1e-10, "{:?}", found.point - point);
            assert!(found.epipolar < 1e-7, "{}", found.epipolar);
            assert!((found.angle - 0.7).abs() < 0.4, "{}", found.angle);
        }
    }
}

/// The covariance is σ² D Dᵀ, with D the derivatives of the point by the four coordinates of the pixels.
#[test]
fn the_covariance_is_that_of_differences() {
    let (cameras, deviation, h) = (cameras(0.4), 0.25, 1e-4);
    let seen = pixels(&cameras, POINT);
    let found = triangulate(both(&cameras), seen, deviation).unwrap();
    let mut covariance = [[0.0; 3]; 3];
    for k in 0..4 {
        let moved = |by: f64| {
            let mut seen = seen;
            seen[k / 2][k % 2] += by;
            triangulate(both(&cameras), seen, deviation).unwrap().point
        };
        let slope = (moved(h) - moved(-h)) / (2.0 * h);
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += deviation * deviation * slope[i] * slope[j];
            }
        }
    }
    let scale = found.deviation().powi(2);
    for (i, row) in covariance.iter().enumerate() {
        for (j, expected) in row.iter().enumerate() {
            let off = (found.covariance.rows[i][j] - expected).abs() / scale;
            assert!(off < 1e-5, "{i} {j}: {off}");
        }
    }
}

/// Residuals near zero are those of rounding, and no reason to refuse a point.
#[test]
fn nearly_exact_pixels_are_not_refused() {
    let mut noise = Noise::of(23);
    for trial in 0..2000 {
        let cameras = cameras(0.6);
        let mut side = || noise.between(-0.06, 0.06);
        let point = Vec3::new(0.0, 0.0, 0.5) + Vec3::new(side(), side(), side());
        let deviation = 10f64.powi(-(trial % 9));
        let seen = pixels(&cameras, point).map(|pixel| noise.beside(pixel, deviation));
        let found = triangulate(both(&cameras), seen, 0.3).unwrap();
        assert!((found.point - point).norm() < 8e-3 * deviation + 1e-9);
    }
}

/// χ² of three degrees of freedom, and a normal number in the image: 95 % lie within 7.815 and 1.96 standard deviations.
#[test]
fn noisy_points_lie_within_their_covariance() {
    const TRIALS: usize = 600;
    let mut noise = Noise::of(11);
    let (mut within, mut near, mut squares) = (0, 0, 0.0);
    for trial in 0..TRIALS {
        let cameras = cameras([0.3, 0.8, 1.4][trial % 3]);
        let mut side = || noise.between(-0.06, 0.06);
        let point = Vec3::new(0.0, 0.0, 0.5) + Vec3::new(side(), side(), side());
        let deviation = 0.3;
        let seen = pixels(&cameras, point).map(|pixel| noise.beside(pixel, deviation));
        let found = triangulate(both(&cameras), seen, deviation).unwrap();
        let off = found.point - point;
        let square = off.dot(found.covariance.inverse().unwrap() * off);
        within += usize::from(square < 7.815);
        near += usize::from(found.epipolar < 1.96 * deviation);
        squares += square / TRIALS as f64;
    }
    // Two standard deviations of such a share are 1.8 %.
    for share in [within, near].map(|n| n as f64 / TRIALS as f64) {
        assert!((0.93..0.97).contains(&share), "{share}");
    }
    assert!((squares - 3.0).abs() < 0.3, "{squares}");
}

/// To first order the distance is x₂ᵀ E x₁ over the root of the squares of its derivatives by the four pixels (Sampson).
#[test]
fn the_epipolar_distance_is_that_of_the_essential_matrix() {
    let plain = Lens::Pinhole(Pinhole::new([900.0; 2], [320.0, 240.0], Distortion::NONE).unwrap());
    let cameras = cameras(0.5).map(|c| Camera::new(plain, c.pose(), c.size()).unwrap());
    let [a, mut b] = pixels(&cameras, POINT);
    b[1] += 2.0;
    let found = triangulate(both(&cameras), [a, b], 1.0).unwrap();
    let relative = cameras[1].pose();
    let algebraic = |a: [f64; 2], b: [f64; 2]| {
        let ideal = |[u, v]: [f64; 2]| Vec3::new((u - 320.0) / 900.0, (v - 240.0) / 900.0, 1.0);
        ideal(a).cross(relative.position).dot(relative.rotation.rotate(ideal(b)))
    };
    let h = 1e-3;
    let by = |k: usize| {
        let at = |by: f64| {
            let mut both = [a, b];
            both[k / 2][k % 2] += by;
            algebraic(both[0], both[1])
        };
        (at(h) - at(-h)) / (2.0 * h)
    };
    let expected = algebraic(a, b).abs() / (0..4).map(|k| by(k).powi(2)).sum::<f64>().sqrt();
    assert!((found.epipolar - expected).abs() < 1e-3 * expected, "{} {expected}", found.epipolar);
    let [[p, q], [r, s]] = found.residuals;
    let squares: f64 = [p, q, r, s].iter().map(|x| x * x).sum();
    assert!((squares.sqrt() - found.epipolar).abs() < 1e-9);
}

#[test]
fn what_two_cameras_do_not_determine_is_refused() {
    let [first, second] = cameras(0.5);
    let seen = pixels(&[first, second], POINT);
    let refused =
        |cameras: [&Camera; 2], seen, deviation| triangulate(cameras, seen, deviation).unwrap_err();
    let turned = Pose { rotation: UnitQuaternion::exp(Vec3::new(0.0, 0.2, 0.0)), ..first.pose() };
    let turned = first.at(turned).unwrap();
    let error = refused([&first, &turned], seen, 0.3);
    assert_eq!(error, TriangulateError::NoBaseline { baseline: 0.0 });
    let near = first.at(Pose { position: Vec3::new(1e-4, 0.0, 0.0), ..Pose::IDENTITY }).unwrap();
    let error = refused([&first, &near], pixels(&[first, near], POINT), 0.3);
    assert!(matches!(error, TriangulateError::NoParallax { angle } if angle < 3e-4), "{error}");
    // The lines of sight meet behind the cameras.
    let away = UnitQuaternion::exp(Vec3::new(0.0, 0.3, 0.0));
    let away = first.at(Pose { position: Vec3::new(0.2, 0.0, 0.0), rotation: away }).unwrap();
    let error = refused([&first, &away], [[320.0, 240.0]; 2], 0.3);
    assert!(matches!(error, TriangulateError::Unseen { .. }), "{error}");
    for deviation in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = refused([&first, &second], seen, deviation);
        assert!(matches!(error, TriangulateError::Deviation { .. }), "{error}");
    }
}

/// Ten markers on an arc, upright in the images.
fn row() -> Vec<Vec3> {
    (0..10)
        .map(|k| {
            let s = 0.02 * f64::from(k);
            Vec3::new(0.8 * s * s, 0.09 - s, 0.5 - 1.2 * s * s)
        })
        .collect()
}

#[test]
fn markers_are_matched_in_their_order() {
    let cameras = cameras(0.6);
    let mut noise = Noise::of(5);
    let seen = [0, 1].map(|i| {
        let camera: &Camera = &cameras[i];
        row().iter().map(|&at| noise.beside(camera.project(at).unwrap(), 0.2)).collect::<Vec<_>>()
    });
    let without = |photo: usize, hidden: &[usize]| -> Vec<[f64; 2]> {
        let all = seen[photo].iter().enumerate();
        all.filter(|(k, _)| !hidden.contains(k)).map(|(_, pixel)| *pixel).collect()
    };
    let (first, second) = (without(0, &[0, 4]), without(1, &[7]));
    let found = match_in_order(both(&cameras), [&first, &second], 2.0).unwrap();
    let numbers = |pairs: &[[usize; 2]]| -> Vec<[usize; 2]> {
        let first = [1, 2, 3, 5, 6, 7, 8, 9];
        let second = [0, 1, 2, 3, 4, 5, 6, 8, 9];
        pairs.iter().map(|&[i, j]| [first[i], second[j]]).collect()
    };
    let expected: Vec<[usize; 2]> = [1, 2, 3, 5, 6, 8, 9].iter().map(|&k| [k, k]).collect();
    assert_eq!(numbers(&found.pairs), expected);
    assert_eq!(found.single, [vec![5], vec![0, 4]]);

    // Of two markers that are swapped neither is within the limit.
    let mut swapped = seen[1].clone();
    swapped.swap(3, 6);
    for k in 0..10 {
        let at = triangulate(both(&cameras), [seen[0][k], swapped[k]], 0.2);
        let off = at.map_or(f64::INFINITY, |at| at.epipolar);
        assert_eq!(off > 2.0, k == 3 || k == 6, "{k}: {off}");
    }

    // Photographs that have nothing in common.
    let elsewhere: Vec<[f64; 2]> = seen[1].iter().map(|[u, v]| [*u, *v - 300.0]).collect();
    let error = match_in_order(both(&cameras), [&seen[0], &elsewhere], 2.0).unwrap_err();
    assert_eq!(error, MatchError::NoCommon { given: [10, 10], limit: 2.0 });
}

/// Where the line between the cameras is along the robot, each marker lies on the epipolar line of each.
#[test]
fn markers_along_the_baseline_are_not_guessed() {
    let first = cameras(0.6)[0];
    let second = first.at(Pose { position: Vec3::new(0.0, 0.2, 0.0), ..Pose::IDENTITY }).unwrap();
    let markers: Vec<Vec3> = (0..6).map(|k| Vec3::new(0.0, 0.02 * f64::from(k), 0.5)).collect();
    let seen = [first, second].map(|camera| -> Vec<[f64; 2]> {
        markers.iter().map(|&at| camera.project(at).unwrap()).collect()
    });
    let cameras = [&first, &second];
    let all = match_in_order(cameras, [&seen[0], &seen[1]], 2.0).unwrap();
    assert_eq!(all.pairs.len(), 6);
    let error = match_in_order(cameras, [&seen[0], &seen[1][1..]], 2.0).unwrap_err();
    assert!(matches!(error, MatchError::Ambiguous { .. }), "{error}");
}
