//! An obstacle as a table of a file.

use whipcord::obstacle::Bends;
use whipcord::{Form, Obstacle, Vec3};

use super::Table;
use super::describe::{Inexpressible, placed};

/// The table of an obstacle.
///
/// # Errors
/// [`Inexpressible`] for a mesh that is from no file.
pub(super) fn obstacle(obstacle: &Obstacle) -> Result<Table, Inexpressible> {
    let mut table = Table::default();
    table.insert("kind", obstacle.form.name());
    table.insert("name", obstacle.name.as_str());
    match &obstacle.form {
        Form::HalfSpace => {}
        Form::Sphere { radius } => table.insert("radius", *radius),
        Form::Capsule { radius, length } | Form::Cylinder { radius, length } => {
            table.insert("radius", *radius);
            table.insert("length", *length);
        }
        Form::Box { size } => table.insert("size", *size),
        Form::Pipe(pipe) => {
            table.insert("radius", pipe.radius());
            table.insert("points", pipe.points().to_vec());
            if pipe.bends() == Bends::Corners {
                table.insert("bends", "corners");
            }
        }
        Form::Superellipsoid(body) => {
            table.insert("semi_axes", body.semi_axes());
            table.insert("exponents", body.exponents());
        }
        Form::Mesh(mesh) => {
            let what = "a mesh that is from no file";
            let file = mesh.file().ok_or(Inexpressible { what })?;
            table.insert("file", file.path.as_str());
            table.insert("unit", "m");
            table.insert("scale", file.scale);
        }
    }
    if obstacle.friction > 0.0 {
        table.insert("friction", obstacle.friction);
    }
    if let Some(body) = &obstacle.movable {
        table.insert("mass", body.mass);
        table.insert("center_of_mass", body.center_of_mass);
        for (key, vector) in [("force", body.force), ("moment", body.moment)] {
            if vector != Vec3::ZERO {
                table.insert(key, vector);
            }
        }
    }
    Ok(placed(table, &obstacle.pose))
}
