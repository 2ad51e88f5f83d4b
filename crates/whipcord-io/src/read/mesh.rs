//! Triangle meshes in files: STL, binary or as text, and OBJ.

use std::io::{Cursor, ErrorKind};
use std::path::Path;

use whipcord::Vec3;
use whipcord::obstacle::Mesh;

use crate::error::{FileProblem, Problems};
use crate::files;
use crate::source::{Sources, Span};

/// Triangles as a file has them.
pub(super) struct Triangles {
    /// In the unit of the file.
    pub vertices: Vec<Vec3>,
    /// Each by the numbers of its corners.
    pub corners: Vec<[u32; 3]>,
}

/// Reads the mesh in a file that another one names at `named`.
pub(super) fn read(
    path: &Path,
    named: Span,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Triangles> {
    let bytes = files::read_content(path, files::LARGEST_MESH, Some(named), sources, problems)?;
    let kind = path.extension().map(|kind| kind.to_string_lossy().to_lowercase());
    let triangles = match kind.as_deref() {
        Some("stl") => stl(bytes),
        Some("obj") => obj(&bytes),
        _ => Err("its name must end in .stl or .obj".to_owned()),
    };
    match triangles {
        Ok(triangles) => Some(triangles),
        Err(reason) => {
            let path = path.display().to_string();
            problems.push(named, || FileProblem::Mesh { path, reason });
            None
        }
    }
}

/// Bytes before the triangles of a binary file: a title and their number.
const HEADER: usize = 84;
/// Bytes of each: a normal, three corners, and two more.
const TRIANGLE: usize = 50;

fn stl(mut bytes: Vec<u8>) -> Result<Triangles, String> {
    let count = bytes.get(HEADER - 4..HEADER).and_then(|count| count.try_into().ok());
    let count = count.map_or(0, |count| u32::from_le_bytes(count) as usize);
    // Some programs begin the title of binary files with the word that text files begin with.
    if count > 0 && bytes.len() == HEADER + TRIANGLE * count {
        bytes[0] = b' ';
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => "it ends too early".to_owned(),
        _ => error.to_string(),
    })?;
    let vertices = mesh.vertices.iter().map(|vertex| {
        let [x, y, z] = vertex.0.map(f64::from);
        Vec3::new(x, y, z)
    });
    let corners = mesh.faces.iter().map(|face| number(face.vertices));
    Ok(Triangles { vertices: vertices.collect(), corners: corners.collect::<Result<_, _>>()? })
}

/// Refuses a text whose faces have more corners than triangles are taken: a list of them all takes many times the memory
/// of the text.
fn check_faces(bytes: &[u8]) -> Result<(), String> {
    let faces = bytes.split(|&byte| byte == b'\n').filter_map(|line| line.strip_prefix(b"f "));
    let corners =
        |face: &[u8]| face.split(u8::is_ascii_whitespace).filter(|c| !c.is_empty()).count();
    let triangles: usize = faces.map(|face| corners(face).saturating_sub(2)).sum();
    if triangles > Mesh::MOST_TRIANGLES {
        let most = Mesh::MOST_TRIANGLES;
        return Err(format!(
            "it has {triangles} triangles; at most {most} are taken: export it coarser"
        ));
    }
    Ok(())
}

fn obj(bytes: &[u8]) -> Result<Triangles, String> {
    check_faces(bytes)?;
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    // Materials do not matter, so that the files with them are not looked for.
    let no_material = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_material)
        .map_err(|error| error.to_string())?;
    let mut all = Triangles { vertices: Vec::new(), corners: Vec::new() };
    for model in &models {
        let first = all.vertices.len();
        let (places, _) = model.mesh.positions.as_chunks::<3>();
        all.vertices.extend(places.iter().map(|&place| Vec3::from(place)));
        let (corners, _) = model.mesh.indices.as_chunks::<3>();
        for corner in corners {
            all.corners.push(number(corner.map(|k| first + k as usize))?);
        }
    }
    Ok(all)
}

fn number(corners: [usize; 3]) -> Result<[u32; 3], String> {
    let mut numbers = [0; 3];
    for (number, corner) in numbers.iter_mut().zip(corners) {
        *number = u32::try_from(corner).map_err(|_| "it has too many vertices".to_owned())?;
    }
    Ok(numbers)
}
