//! `[[obstacles]]`: what stands in the robot's way.

use std::sync::Arc;

use whipcord::obstacle::{Bends, Mesh, MeshFile, Pipe, Superellipsoid};
use whipcord::{Form, MovableBody, Obstacle, Pose, Problem, RobotError, UnitQuaternion, Vec3};

use super::{mesh, pose, vec3, vector};
use crate::check::Fields;
use crate::error::{FileProblem, Problems};
use crate::node::Node;
use crate::source::{Sources, Span};

/// The obstacles of these tables, but those that are refused.
pub(crate) fn obstacles(
    tables: &[Fields],
    document: &Node,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Vec<Obstacle> {
    let mut all = Vec::new();
    for (k, fields) in tables.iter().enumerate() {
        let span = |key: &str| document.locate(&format!("obstacles[{k}].{key}")).span;
        let form = match fields.variant {
            "mesh" => mesh(fields, span("file"), sources, problems),
            _ => form(fields),
        };
        let placed = placed(fields);
        for error in [form.as_ref().err(), placed.as_ref().err()].into_iter().flatten().flatten() {
            // The only file of the table is the mesh's.
            let key = error.path.replacen("mesh", "file", 1);
            let (path, problem) = (format!("obstacles[{k}].{key}"), error.problem.clone());
            problems.push(span(&key), || FileProblem::Physical { path, problem });
        }
        let name = fields.text("name").map_or_else(|| format!("obstacle-{}", k + 1), str::to_owned);
        if let (Ok(form), Ok(pose)) = (form, placed) {
            let friction = fields.number("friction").unwrap_or(0.0);
            let movable = movable(fields, &form);
            all.push(Obstacle { name, form, pose, friction, movable });
        }
    }
    all
}

/// What makes it a movable object, where it has a mass.
fn movable(fields: &Fields, form: &Form) -> Option<MovableBody> {
    let by_density = || Some(fields.number("density")? * form.volume()?);
    let body = MovableBody::with_mass(form, fields.number("mass").or_else(by_density)?)?;
    Some(MovableBody {
        center_of_mass: vec3(fields, "center_of_mass").unwrap_or(body.center_of_mass),
        force: vec3(fields, "force").unwrap_or(body.force),
        moment: vec3(fields, "moment").unwrap_or(body.moment),
        ..body
    })
}

/// What the library has against a part of an obstacle; nothing where that has been reported.
type Refused = Option<RobotError>;

fn no_direction(path: &str) -> Refused {
    Some(RobotError { path: path.to_owned(), problem: Problem::NoDirection })
}

/// Where it is. A half-space may say where it is not: the shortest turn brings z to that.
fn placed(fields: &Fields) -> Result<Pose, Refused> {
    let placed = pose(fields).map_err(no_direction)?;
    let Some(normal) = vec3(fields, "normal") else { return Ok(placed) };
    let length = normal.norm();
    if length == 0.0 {
        return Err(no_direction("normal"));
    }
    let n = normal / length;
    let axis = Vec3::Z.cross(n);
    let (sine, cosine) = (axis.norm(), n.z);
    let turn = match (sine > 0.0, cosine < 0.0) {
        (true, _) => axis * (sine.atan2(cosine) / sine),
        (false, true) => Vec3::X * core::f64::consts::PI,
        (false, false) => Vec3::ZERO,
    };
    Ok(Pose { rotation: UnitQuaternion::exp(turn), ..placed })
}

/// The form, but a mesh.
fn form(fields: &Fields) -> Result<Form, Refused> {
    // What is missing has been reported.
    let number = |key: &str| fields.number(key).ok_or(None);
    let form = match fields.variant {
        "half-space" => Form::HalfSpace,
        "sphere" => Form::Sphere { radius: number("radius")? },
        "capsule" => Form::Capsule { radius: number("radius")?, length: number("length")? },
        "box" => Form::Box { size: vec3(fields, "size").ok_or(None)? },
        "cylinder" => Form::Cylinder { radius: number("radius")?, length: number("length")? },
        "pipe" => {
            let points = fields.list("points").ok_or(None)?;
            let points: Vec<Vec3> = points.iter().filter_map(vector).collect();
            let bends = match fields.text("bends") {
                Some("corners") => Bends::Corners,
                _ => Bends::Smooth,
            };
            Form::Pipe(Pipe::new(number("radius")?, &points, bends).map_err(Some)?)
        }
        "superellipsoid" => {
            let semi_axes = vec3(fields, "semi_axes").ok_or(None)?;
            let exponents = fields.vector("exponents").ok_or(None)?;
            Form::Superellipsoid(Superellipsoid::new(semi_axes, exponents).map_err(Some)?)
        }
        // A table without a kind, which has been reported.
        _ => return Err(None),
    };
    Ok(form)
}

/// The mesh of the file that is named at `named`.
fn mesh(
    fields: &Fields,
    named: Span,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Result<Form, Refused> {
    let (file, unit) = (fields.text("file").ok_or(None)?, fields.text("unit").ok_or(None)?);
    let metres = match unit {
        "m" => 1.0,
        "cm" => 1e-2,
        "mm" => 1e-3,
        "um" => 1e-6,
        _ => 0.0254,
    };
    let factor = fields.number("scale").unwrap_or(1.0);
    if let Some(problem) = whipcord::robot::limits::MESH_SCALE.problem(factor) {
        return Err(Some(RobotError { path: "scale".to_owned(), problem }));
    }
    let path = sources.resolve(named.file, file);
    let scale = metres * factor;
    let triangles = mesh::read(&path, named, sources, problems).ok_or(None)?;
    let vertices: Vec<Vec3> = triangles.vertices.iter().map(|&v| scale * v).collect();
    let mesh = Mesh::new(&vertices, &triangles.corners).map_err(Some)?;
    // Seen from everywhere, for files that are written to other folders.
    let path = path.canonicalize().unwrap_or(path).display().to_string();
    Ok(Form::Mesh(Arc::new(mesh.with_file(MeshFile { path, scale }))))
}
