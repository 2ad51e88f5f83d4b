//! Time of one signed distance from an obstacle of each form.

#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use std::sync::Arc;

use divan::{Bencher, black_box};
use whipcord::obstacle::{Bends, Mesh, Pipe, Superellipsoid};
use whipcord::{Form, Obstacle, Pose, Vec3};

fn main() {
    divan::main();
}

/// A ball.
fn ball() -> Mesh {
    let (rings, sectors) = (20_u32, 32_u32);
    let mut vertices = vec![Vec3::new(0.0, 0.0, -0.02), Vec3::new(0.0, 0.0, 0.02)];
    let mut triangles = Vec::new();
    for i in 0..rings {
        for j in 0..sectors {
            let u = core::f64::consts::PI * f64::from(i + 1) / f64::from(rings + 1);
            let v = core::f64::consts::TAU * f64::from(j) / f64::from(sectors);
            vertices.push(0.02 * Vec3::new(u.sin() * v.cos(), u.sin() * v.sin(), -u.cos()));
        }
    }
    let at = |i: u32, j: u32| 2 + i * sectors + j % sectors;
    for j in 0..sectors {
        triangles.push([0, at(0, j + 1), at(0, j)]);
        triangles.push([1, at(rings - 1, j), at(rings - 1, j + 1)]);
        for i in 1..rings {
            triangles.push([at(i - 1, j), at(i - 1, j + 1), at(i, j + 1)]);
            triangles.push([at(i - 1, j), at(i, j + 1), at(i, j)]);
        }
    }
    Mesh::new(&vertices, &triangles).unwrap()
}

fn form(name: &str) -> Form {
    let hull = |exponents| {
        let semi_axes = Vec3::new(0.02, 0.015, 0.01);
        Form::Superellipsoid(Superellipsoid::new(semi_axes, exponents).unwrap())
    };
    let quarter = |k: u32| {
        let angle = core::f64::consts::FRAC_PI_2 * f64::from(k) / 6.0;
        0.02 * Vec3::new(1.0 - angle.cos(), 0.0, angle.sin())
    };
    let points: Vec<Vec3> = (0..7).map(quarter).collect();
    match name {
        "half-space" => Form::HalfSpace,
        "sphere" => Form::Sphere { radius: 0.02 },
        "capsule" => Form::Capsule { radius: 0.01, length: 0.03 },
        "box" => Form::Box { size: Vec3::new(0.04, 0.03, 0.02) },
        "cylinder" => Form::Cylinder { radius: 0.015, length: 0.03 },
        "straight pipe" => Form::Pipe(Pipe::new(0.006, &points[..2], Bends::Smooth).unwrap()),
        "bent pipe" => Form::Pipe(Pipe::new(0.006, &points, Bends::Smooth).unwrap()),
        "ellipsoid" => hull([1.0, 1.0]),
        "rounded box" => hull([0.2, 0.3]),
        _ => Form::Mesh(Arc::new(ball())),
    }
}

const NAMES: [&str; 10] = [
    "half-space",
    "sphere",
    "capsule",
    "box",
    "cylinder",
    "straight pipe",
    "bent pipe",
    "ellipsoid",
    "rounded box",
    "mesh of 1280 triangles",
];

/// Of 256 points around it, most of them outside; for one of them.
#[divan::bench(args = NAMES)]
fn distance(bencher: Bencher, name: &str) {
    let obstacle = Obstacle {
        name: name.to_owned(),
        form: form(name),
        pose: Pose::IDENTITY,
        friction: 0.0,
        movable: None,
    };
    let coordinate = |k: u32, step: u32| 0.05 * (f64::from(k * step % 256) / 128.0 - 1.0);
    let points: Vec<Vec3> = (0..256)
        .map(|k| Vec3::new(coordinate(k, 37), coordinate(k, 101), coordinate(k, 171)))
        .collect();
    let mut k = 0;
    bencher.bench_local(|| {
        k = (k + 1) % points.len();
        obstacle.surface(black_box(points[k]))
    });
}
