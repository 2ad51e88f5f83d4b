//! Obstacles as the page draws them.

use whipcord::obstacle::Bends;

use crate::convert::{array, pose};
use crate::protocol::{Form, Obstacle};

/// Points of a pipe's middle line at most: more cannot be told apart.
const MOST_POINTS: usize = 400;
/// Triangles of a mesh that are sent at most: a page that draws more stutters.
const MOST_TRIANGLES: usize = 200_000;

/// An obstacle of a case.
pub fn obstacle(obstacle: &whipcord::Obstacle) -> Obstacle {
    Obstacle { name: obstacle.name.clone(), pose: pose(&obstacle.pose), form: form(&obstacle.form) }
}

fn form(form: &whipcord::Form) -> Form {
    match form {
        whipcord::Form::HalfSpace => Form::HalfSpace,
        &whipcord::Form::Sphere { radius } => Form::Sphere { radius },
        &whipcord::Form::Capsule { radius, length } => Form::Capsule { radius, length },
        &whipcord::Form::Box { size } => Form::Box { size: array(size) },
        &whipcord::Form::Cylinder { radius, length } => Form::Cylinder { radius, length },
        whipcord::Form::Pipe(pipe) => {
            let (points, _) = pipe.middle();
            let last = points.len() - 1;
            let count = if pipe.bends() == Bends::Corners { last } else { last.min(MOST_POINTS) };
            let middle = (0..=count).map(|k| array(points[k * last / count]));
            Form::Pipe { radius: pipe.radius(), middle: middle.collect() }
        }
        whipcord::Form::Superellipsoid(body) => {
            Form::Superellipsoid { semi_axes: array(body.semi_axes()), exponents: body.exponents() }
        }
        whipcord::Form::Mesh(mesh) => Form::Mesh {
            vertices: mesh.vertices().iter().map(|&v| array(v)).collect(),
            triangles: mesh.triangles().iter().take(MOST_TRIANGLES).copied().collect(),
        },
    }
}
