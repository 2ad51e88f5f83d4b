//! Obstacles of every form, and points around them.

use std::sync::Arc;

use whipcord::obstacle::{Bends, Mesh, Pipe, Superellipsoid};
use whipcord::{Form, Obstacle, Pose, UnitQuaternion, Vec3};

/// The form where it stands as it is.
pub fn at_origin(form: Form) -> Obstacle {
    Obstacle { name: "it".to_owned(), form, pose: Pose::IDENTITY, friction: 0.0, movable: None }
}

pub fn superellipsoid(semi_axes: [f64; 3], exponents: [f64; 2]) -> Superellipsoid {
    Superellipsoid::new(semi_axes.into(), exponents).unwrap()
}

pub fn pipe(radius: f64, points: &[[f64; 3]], bends: Bends) -> Pipe {
    let points: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
    Pipe::new(radius, &points, bends).unwrap()
}

/// A quarter of a circle of this radius, from the z axis towards x.
pub fn quarter(radius: f64, pieces: usize) -> Vec<[f64; 3]> {
    let at = |k: usize| {
        let angle = core::f64::consts::FRAC_PI_2 * k as f64 / pieces as f64;
        [radius * (1.0 - angle.cos()), 0.0, radius * angle.sin()]
    };
    (0..=pieces).map(at).collect()
}

/// A box of two triangles a side, about the origin.
pub fn box_of_triangles(size: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |k: u32| {
        let sign = |bit: u32| if k & bit == 0 { -0.5 } else { 0.5 };
        Vec3::new(sign(1) * size.x, sign(2) * size.y, sign(4) * size.z)
    };
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// A slab with a step: not convex.
pub fn stairs() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let outline = [(0.0, 0.0), (0.03, 0.0), (0.03, 0.01), (0.01, 0.01), (0.01, 0.02), (0.0, 0.02)];
    let ring = |y: f64| outline.map(|(x, z)| Vec3::new(x, y, z));
    let vertices: Vec<Vec3> = ring(-0.005).into_iter().chain(ring(0.005)).collect();
    let cap = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    // Along y the outline runs clockwise at the near end.
    let near = cap.iter().copied();
    let far = cap.iter().map(|&[a, b, c]| [a + 6, c + 6, b + 6]);
    let sides = (0..6).flat_map(|k| {
        let l = (k + 1) % 6;
        [[k, k + 6, l + 6], [k, l + 6, l]]
    });
    (vertices, near.chain(far).chain(sides).collect())
}

/// One of every form, about 4 cm large, and some with edges or bends of their own.
pub fn all() -> Vec<(&'static str, Form)> {
    let size = Vec3::new(0.04, 0.03, 0.02);
    let mesh = |(vertices, triangles): (Vec<Vec3>, Vec<[u32; 3]>)| {
        Form::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap()))
    };
    let hull = |semi_axes, exponents| Form::Superellipsoid(superellipsoid(semi_axes, exponents));
    vec![
        ("half-space", Form::HalfSpace),
        ("sphere", Form::Sphere { radius: 0.02 }),
        ("capsule", Form::Capsule { radius: 0.01, length: 0.03 }),
        ("box", Form::Box { size }),
        ("cylinder", Form::Cylinder { radius: 0.015, length: 0.03 }),
        ("straight pipe", Form::Pipe(pipe(0.01, &[[0.0; 3], [0.0, 0.0, 0.03]], Bends::Smooth))),
        ("bent pipe", Form::Pipe(pipe(0.006, &quarter(0.02, 6), Bends::Smooth))),
        (
            "cornered pipe",
            Form::Pipe(pipe(
                0.006,
                &[[0.0; 3], [0.0, 0.0, 0.03], [0.03, 0.0, 0.03]],
                Bends::Corners,
            )),
        ),
        ("ellipsoid", hull([0.02, 0.015, 0.01], [1.0, 1.0])),
        ("rounded box", hull([0.02, 0.015, 0.01], [0.2, 0.3])),
        ("pillow", hull([0.02, 0.015, 0.01], [1.0, 0.2])),
        ("drum", hull([0.02, 0.015, 0.01], [0.1, 1.0])),
        ("pinched", hull([0.02, 0.015, 0.01], [1.5, 1.8])),
        ("mesh of a box", mesh(box_of_triangles(size))),
        ("mesh of stairs", mesh(stairs())),
    ]
}

/// Numbers from 0 to 1 that are the same each time.
pub struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In a cube about the origin with edges twice as long.
    pub fn vector(&mut self, reach: f64) -> Vec3 {
        let mut coordinate = || reach * (2.0 * self.number() - 1.0);
        Vec3::new(coordinate(), coordinate(), coordinate())
    }

    pub fn pose(&mut self) -> Pose {
        let rotation = UnitQuaternion::exp(self.vector(3.0));
        Pose { position: self.vector(0.1), rotation }
    }
}
