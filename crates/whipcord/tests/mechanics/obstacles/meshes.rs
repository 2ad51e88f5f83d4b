//! Bodies of triangles.

use std::sync::Arc;

use whipcord::obstacle::{Bends, Mesh, Pipe, Superellipsoid};
use whipcord::{Case, Form, Problem, RobotError, Vec3};

use crate::obstacles::forms::{Draws, at_origin, box_of_triangles, stairs};

/// A box of twelve triangles has the distance of the box.
#[test]
fn a_box_of_triangles_is_a_box() {
    for scale in [1e-7, 1.0, 1e4] {
        let size = scale * Vec3::new(0.04, 0.03, 0.02);
        let (vertices, triangles) = box_of_triangles(size);
        let mesh = Mesh::new(&vertices, &triangles).unwrap();
        let (mesh, solid) = (at_origin(Form::Mesh(Arc::new(mesh))), at_origin(Form::Box { size }));
        let mut draws = Draws::new(10);
        for _ in 0..5000 {
            let p = draws.vector(0.04 * scale);
            let (a, b) = (mesh.surface(p).distance, solid.surface(p).distance);
            assert!((a - b).abs() < 1e-14 * scale, "{scale}: {p:?}: {a} {b}");
        }
    }
}

/// A body that is not convex, against the dense sampling of its surface; which side a point is on,
/// against its outline.
#[test]
fn stairs_are_measured_from_every_side() {
    let (vertices, triangles) = stairs();
    let mut samples = Vec::new();
    for &corners in &triangles {
        let [a, b, c] = corners.map(|k| vertices[k as usize]);
        const N: u32 = 60;
        for i in 0..=N {
            for j in 0..=N - i {
                let (u, v) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
                samples.push(a + u * (b - a) + v * (c - a));
            }
        }
    }
    let inside = |p: Vec3| {
        let low = p.x > 0.0 && p.x < 0.03 && p.z > 0.0 && p.z < 0.01;
        let high = p.x > 0.0 && p.x < 0.01 && p.z > 0.0 && p.z < 0.02;
        p.y.abs() < 0.005 && (low || high)
    };
    let mesh = at_origin(Form::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap())));
    let mut draws = Draws::new(11);
    let mut within = 0;
    for _ in 0..600 {
        let p = Vec3::new(0.015, 0.0, 0.01) + draws.vector(0.02);
        let away = samples.iter().map(|&q| (p - q).norm()).fold(f64::INFINITY, f64::min);
        let distance = mesh.surface(p).distance;
        assert_eq!(distance < 0.0, inside(p), "{p:?}: {distance}");
        within += usize::from(inside(p));
        let miss = away - distance.abs();
        assert!((-1e-12..3e-4).contains(&miss), "{p:?}: {distance} {away}");
    }
    assert!(within > 20, "{within}");
}

#[test]
fn what_is_no_body_is_refused() {
    let (vertices, triangles) = box_of_triangles(Vec3::new(0.04, 0.03, 0.02));
    let problem = |vertices: &[Vec3], triangles: &[[u32; 3]]| {
        Mesh::new(vertices, triangles).unwrap_err().problem
    };
    assert_eq!(problem(&vertices, &[]), Problem::NoTriangles);
    assert!(matches!(problem(&vertices, &triangles[1..]), Problem::OpenEdges { count: 3, .. }));
    let mut turned = triangles.clone();
    turned[4].swap(0, 1);
    assert!(matches!(problem(&vertices, &turned), Problem::OpposedTriangles { count: 3, .. }));
    let inverted: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let Problem::InsideOut { volume } = problem(&vertices, &inverted) else { panic!() };
    assert!((volume + 0.04 * 0.03 * 0.02).abs() < 1e-18);
    let doubled = [triangles.clone(), triangles.clone()].concat();
    assert!(matches!(problem(&vertices, &doubled), Problem::CrowdedEdges { count: 18, .. }));
    let mut pointed = triangles.clone();
    pointed[7] = [3, 3, 6];
    assert_eq!(problem(&vertices, &pointed), Problem::FlatTriangles { count: 1, triangle: 7 });
    let mut beyond = triangles.clone();
    beyond[2][1] = 8;
    assert_eq!(
        problem(&vertices, &beyond),
        Problem::NoSuchVertex { triangle: 2, vertex: 8, vertices: 8 }
    );
    let open = Mesh::new(&vertices, &triangles[1..]).unwrap_err();
    assert_eq!(
        open.to_string(),
        "`mesh`: has holes: 3 edges of one triangle alone, such as the one near (0, 0, -0.01) m"
    );
}

/// As STL files have them: each triangle with corners of its own.
#[test]
fn the_same_corner_may_be_given_often() {
    let (vertices, triangles) = box_of_triangles(Vec3::new(0.04, 0.03, 0.02));
    let soup: Vec<Vec3> = triangles.iter().flatten().map(|&k| vertices[k as usize]).collect();
    let alone: Vec<[u32; 3]> = (0..12).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Mesh::new(&soup, &alone).unwrap();
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (8, 12));
}

#[test]
fn sizes_that_cannot_be_are_refused_by_path() {
    let robot = whipcord::Robot::new(
        whipcord::Backbone::new(0.1),
        whipcord::Disks::equally_spaced(0.1, 3, 0.005),
        Vec::new(),
    )
    .unwrap();
    let refused = |form: Form| {
        let obstacles = vec![at_origin(Form::HalfSpace), at_origin(form)];
        let case = Case { obstacles, ..Case::default() };
        case.check(&robot).unwrap_err().to_string()
    };
    assert_eq!(
        refused(Form::Sphere { radius: 0.0 }),
        "`radius` of obstacle 2: must be greater than zero, but is 0"
    );
    assert_eq!(
        refused(Form::Capsule { radius: 1.0, length: -1.0 }),
        "`length` of obstacle 2: must be greater than zero, but is -1"
    );
    assert_eq!(
        refused(Form::Box { size: Vec3::new(1.0, f64::NAN, 1.0) }),
        "`size` of obstacle 2: must be a finite number, but is NaN"
    );
    let of_pipe = |points: &[Vec3], bends| Pipe::new(0.01, points, bends).unwrap_err();
    let (a, b) = (Vec3::ZERO, Vec3::new(0.0, 0.0, 0.1));
    assert_eq!(of_pipe(&[a], Bends::Smooth).problem, Problem::TooFew { given: 1, least: 2 });
    let RobotError { path, problem } = of_pipe(&[a, b, b], Bends::Corners);
    assert_eq!((path.as_str(), problem), ("points[2]", Problem::TooNear { chord: 0.0 }));
    let sharp = of_pipe(&[a, 0.1 * b, Vec3::new(0.01, 0.0, 0.01)], Bends::Smooth);
    assert!(matches!(sharp.problem, Problem::BendsTooSharply { radius: 0.01, .. }), "{sharp}");
    let pinched = Superellipsoid::new(Vec3::new(1.0, 1.0, 1.0), [1.0, 2.0]).unwrap_err();
    assert_eq!(pinched.to_string(), "`exponents`: must be at most 1.9, but is 2");
}
