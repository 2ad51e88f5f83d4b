//! Distances against closed forms, another library, and the dense sampling of surfaces.

use std::f64::consts::TAU;
use std::sync::Arc;

use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQuery as _;
use parry3d_f64::shape::{Capsule, Cuboid, Cylinder, SharedShape, TriMesh};
use whipcord::obstacle::{Bends, Mesh};
use whipcord::{Form, Vec3};

use crate::obstacles::forms::{Draws, at_origin, pipe, quarter, superellipsoid};

/// A ring of triangles, in steps that make some of them thin, against the nearest triangle that
/// parry finds.
#[test]
fn meshes_agree_with_another_library() {
    let (around, along) = (40, 25);
    let number = |i: u32, j: u32| (i % around) * along + j % along;
    let mut vertices = Vec::new();
    for (i, j) in (0..around).flat_map(|i| (0..along).map(move |j| (i, j))) {
        let (turn, tilt) = (f64::from(i) / f64::from(around), f64::from(j) / f64::from(along));
        let ((sin, cos), (s, c)) = ((TAU * turn * turn).sin_cos(), (TAU * tilt).sin_cos());
        let radius = 0.02 + 0.007 * c;
        vertices.push(Vec3::new(radius * cos, radius * sin, 0.007 * s));
    }
    let mut triangles = Vec::new();
    for (i, j) in (0..around).flat_map(|i| (0..along).map(move |j| (i, j))) {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let places = vertices.iter().map(|v| DVec3::new(v.x, v.y, v.z)).collect();
    let theirs = TriMesh::new(places, triangles.clone()).unwrap();
    let mesh = at_origin(Form::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap())));
    let mut draws = Draws::new(6);
    let mut within = 0;
    for k in 0..20_000 {
        let p = draws.vector(if k % 2 == 0 { 0.03 } else { 0.2 });
        let q = DVec3::new(p.x, p.y, p.z);
        let away = (theirs.project_local_point(q, false).point - q).length();
        let surface = mesh.surface(p);
        assert!((surface.distance.abs() - away).abs() < 1e-14, "{p:?}: {surface:?} {away}");
        // What is inside the mesh is inside the ring, but for the difference of both.
        let ring = (p.x.hypot(p.y) - 0.02).hypot(p.z) - 0.007;
        if ring.abs() > 2e-3 {
            assert_eq!(surface.distance < 0.0, ring < 0.0, "{p:?}: {surface:?}");
        }
        within += usize::from(surface.distance < 0.0);
    }
    assert!(within > 500, "{within}");
}

/// Capsules, boxes and cylinders against the projections of points that parry has.
#[test]
fn solids_agree_with_another_library() {
    let (radius, length, size) = (0.013, 0.03, Vec3::new(0.04, 0.03, 0.02));
    let half = 0.5 * length;
    let ends = [-half, half].map(|z| DVec3::new(0.0, 0.0, z));
    let shapes = [
        (
            Form::Capsule { radius, length },
            SharedShape::new(Capsule::new(ends[0], ends[1], radius)),
        ),
        (
            Form::Box { size },
            SharedShape::new(Cuboid::new(DVec3::new(size.x, size.y, size.z) * 0.5)),
        ),
        (Form::Cylinder { radius, length }, SharedShape::new(Cylinder::new(half, radius))),
    ];
    for (form, shape) in shapes {
        // Its cylinders stand along y.
        let turned = matches!(form, Form::Cylinder { .. });
        let obstacle = at_origin(form);
        let mut draws = Draws::new(5);
        for _ in 0..5000 {
            let p = draws.vector(0.05);
            let q = if turned { DVec3::new(p.y, p.z, p.x) } else { DVec3::new(p.x, p.y, p.z) };
            let there = shape.project_local_point(q, false);
            let away = (there.point - q).length();
            let expected = if there.is_inside { -away } else { away };
            let distance = obstacle.surface(p).distance;
            assert!((distance - expected).abs() < 1e-14, "{p:?}: {distance} {expected}");
        }
    }
}

/// A convex body's signed distance is the largest of n·p − h(n) over the unit vectors n, with its
/// support function h. That of the superellipsoid is the same expression as its level with a, b, c
/// inverted and the powers p replaced by p/(p − 1).
#[test]
fn superellipsoids_agree_with_their_support() {
    let cases = [
        ([0.02, 0.015, 0.01], [1.0, 1.0]),
        ([0.02, 0.015, 0.01], [0.3, 0.6]),
        ([0.01, 0.01, 0.03], [0.1, 0.1]),
        ([0.02, 0.01, 0.015], [1.7, 0.5]),
        ([0.02, 0.01, 0.015], [0.4, 1.6]),
    ];
    for (semi_axes, exponents) in cases {
        let obstacle = at_origin(Form::Superellipsoid(superellipsoid(semi_axes, exponents)));
        let [beta, alpha] = exponents.map(|e| 2.0 / (2.0 - e));
        let support = |n: [f64; 3]| {
            let [x, y, z] = [0, 1, 2].map(|i| semi_axes[i] * n[i]);
            let across = (x.powf(alpha) + y.powf(alpha)).powf(1.0 / alpha);
            (across.powf(beta) + z.powf(beta)).powf(1.0 / beta)
        };
        // In the first octant, dense towards the axes, where boxes have all their normals.
        const N: i32 = 120;
        let dense = |k: i32| {
            let x = f64::from(k) / f64::from(N);
            core::f64::consts::FRAC_PI_2 * x.powi(3) / (x.powi(3) + (1.0 - x).powi(3))
        };
        let mut normals = Vec::new();
        for i in 0..=N {
            for j in 0..=N {
                let (u, v) = (dense(i), dense(j));
                let n = [u.sin() * v.cos(), u.sin() * v.sin(), u.cos()];
                normals.push((n, support(n)));
            }
        }
        let mut draws = Draws::new(6);
        for _ in 0..200 {
            let p = draws.vector(0.03);
            let octant = p.to_array().map(f64::abs);
            let height =
                |&(n, h): &([f64; 3], f64)| (0..3).map(|i| n[i] * octant[i]).sum::<f64>() - h;
            let expected = normals.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
            let distance = obstacle.surface(p).distance;
            // The sampled maximum lies below by the square of the spacing.
            let miss = distance - expected;
            assert!((-1e-12..6e-5).contains(&miss), "{exponents:?} {p:?}: {distance} {expected}");
        }
    }
}

/// The nearest point of an ellipsoid makes x²/a² + … = 1 exactly, and p − x is along its gradient.
#[test]
fn ellipsoids_are_exact() {
    let axes = [0.02, 0.015, 0.01];
    let obstacle = at_origin(Form::Superellipsoid(superellipsoid(axes, [1.0, 1.0])));
    let mut draws = Draws::new(7);
    for _ in 0..2000 {
        let p = draws.vector(0.04);
        let there = obstacle.surface(p);
        let foot = p - there.distance * there.normal;
        let level: f64 = (0..3).map(|i| (foot[i] / axes[i]).powi(2)).sum();
        assert!((level - 1.0).abs() < 1e-12, "{level}");
        let gradient = Vec3::from([0, 1, 2].map(|i| foot[i] / (axes[i] * axes[i])));
        assert!(gradient.cross(there.normal).norm() < 1e-9 * gradient.norm());
    }
    // Of a ball, by the closed form, outside and in.
    let ball = at_origin(Form::Superellipsoid(superellipsoid([0.02; 3], [1.0, 1.0])));
    for _ in 0..2000 {
        let p = draws.vector(0.04);
        assert!((ball.surface(p).distance - (p.norm() - 0.02)).abs() < 1e-14);
    }
}

/// A straight pipe has the distance of a block with a bore.
#[test]
fn straight_pipes_are_exact() {
    let obstacle = at_origin(Form::Pipe(pipe(0.01, &[[0.0; 3], [0.0, 0.0, 0.03]], Bends::Smooth)));
    let distance = |x, y, z| obstacle.surface(Vec3::new(x, y, z)).distance;
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    close(distance(0.0, 0.0, 0.015), 0.01);
    close(distance(0.006, 0.0, 0.015), 0.004);
    close(distance(0.0, 0.012, 0.015), -0.002);
    close(distance(0.0, 0.012, 0.029), -0.001);
    close(distance(0.006, 0.0, -0.003), 0.005);
    close(distance(0.006, 0.008, -0.003), 0.003);
    close(distance(0.02, 0.0, 0.037), 0.007);
}

/// Through enough points of a quarter circle, the pipe is a piece of a torus.
#[test]
fn bent_pipes_become_a_torus() {
    let bend = 0.02;
    let mut errors = Vec::new();
    for pieces in [8, 16, 32] {
        let obstacle = at_origin(Form::Pipe(pipe(0.006, &quarter(bend, pieces), Bends::Smooth)));
        let mut draws = Draws::new(8);
        let mut worst = 0.0_f64;
        for _ in 0..2000 {
            let angle = 0.1 + 1.3 * draws.number();
            let (across, y) = (0.004 * (2.0 * draws.number() - 1.0), 0.004 * draws.number());
            let from_middle = bend + across;
            let p = Vec3::new(bend - from_middle * angle.cos(), y, from_middle * angle.sin());
            let expected = 0.006 - across.hypot(y);
            worst = worst.max((obstacle.surface(p).distance - expected).abs());
        }
        errors.push(worst);
    }
    assert!(errors[0] < 1e-6 && errors[2] < 1e-9, "{errors:?}");
    // Of fourth order in the spacing.
    assert!(errors[0] / errors[1] > 10.0 && errors[1] / errors[2] > 10.0, "{errors:?}");
}

/// In a coil of many points, whose turns lie side by side, no place of the middle is nearer than the one that is found.
#[test]
fn the_nearest_place_of_a_coil_is_found() {
    let radius = 0.006;
    let at = |k: u32| {
        let angle = f64::from(k) * core::f64::consts::PI / 12.0;
        [0.03 * angle.cos(), 0.03 * angle.sin(), 0.014 * angle / TAU]
    };
    let points: Vec<[f64; 3]> = (0..=120).map(at).collect();
    let coil = pipe(radius, &points, Bends::Smooth);
    let middle = coil.middle().0.to_vec();
    let apart = (middle[1] - middle[0]).norm();
    let obstacle = at_origin(Form::Pipe(coil));
    let mut draws = Draws::new(11);
    let mut inside = 0;
    for _ in 0..4000 {
        let k = (draws.number() * middle.len() as f64) as usize;
        let p = middle[k] + draws.vector(0.012);
        let away = |k: &usize| (p - middle[*k]).norm();
        let nearest = (0..middle.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
        // Beyond an end the bore has no wall.
        if nearest == 0 || nearest + 1 == middle.len() {
            continue;
        }
        let from_middle = away(&nearest);
        let distance = obstacle.surface(p).distance;
        let least = radius - from_middle;
        assert!(distance >= least - 1e-15, "{p:?} {distance} {least}");
        if least > 0.0 {
            inside += 1;
            assert!(distance <= least + 0.5 * apart, "{p:?} {distance} {least}");
        }
    }
    assert!(inside > 500, "{inside}");
}

/// A cornered pipe against the dense sampling of its middle.
#[test]
fn cornered_pipes_are_exact() {
    let points = [[0.0; 3], [0.0, 0.0, 0.03], [0.03, 0.0, 0.03], [0.03, 0.02, 0.05]];
    let obstacle = at_origin(Form::Pipe(pipe(0.006, &points, Bends::Corners)));
    let mut middle = Vec::new();
    for ends in points.windows(2) {
        for k in 0..=4000 {
            let t = f64::from(k) / 4000.0;
            middle.push(Vec3::from(ends[0]) * (1.0 - t) + Vec3::from(ends[1]) * t);
        }
    }
    let mut draws = Draws::new(9);
    for _ in 0..200 {
        let k = (draws.number() * middle.len() as f64) as usize;
        let p = middle[k] + draws.vector(0.003);
        let from_middle = middle.iter().map(|&q| (p - q).norm()).fold(f64::INFINITY, f64::min);
        let beyond_end =
            p.z < 0.0 || (p - middle[middle.len() - 1]).dot(Vec3::new(0.0, 1.0, 1.0)) > 0.0;
        if !beyond_end {
            let distance = obstacle.surface(p).distance;
            assert!(
                (distance - (0.006 - from_middle)).abs() < 1e-6,
                "{p:?} {distance} {from_middle}"
            );
        }
    }
}
