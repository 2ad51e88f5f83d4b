//! Where the tip of a robot can go as a body in space, in glTF.

use std::collections::BTreeSet;

use whipcord::Vec3;

use crate::error::{PlotError, not_empty};
use crate::workspace_figure::{Levels, WorkspaceFigure};

/// The directions of the faces of a voxel: the axis, and whether it is that of the greater coordinate.
const FACES: [(usize, bool); 6] =
    [(0, false), (0, true), (1, false), (1, true), (2, false), (2, true)];
/// Bytes of a vertex: position, normal and colour as 32-bit floats.
const VERTEX: usize = 36;

/// The surface of the voxels with their colours as binary glTF (`.glb`), in metres. The y axis of glTF, which viewers show upwards, is the z axis of the robot.
///
/// # Errors
/// [`PlotError`] when there are no voxels.
pub fn workspace_glb(figure: &WorkspaceFigure) -> Result<Vec<u8>, PlotError> {
    not_empty(|| "the list of voxels".to_owned(), &figure.cells)?;
    let place = |centre: Vec3| {
        #[allow(clippy::cast_possible_truncation, reason = "voxels are numbered in 32 bits")]
        centre.to_array().map(|x| (x / figure.voxel).floor() as i32)
    };
    let marked: BTreeSet<[i32; 3]> =
        figure.cells.iter().map(|(centre, _)| place(*centre)).collect();
    let levels = Levels::of(figure);
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    let (mut least, mut greatest) = ([f32::MAX; 3], [f32::MIN; 3]);
    let mut count = 0_u32;
    for (centre, value) in &figure.cells {
        let own = place(*centre);
        let colour = levels.colour(*value).linear();
        for (axis, is_greater) in FACES {
            let mut next = own;
            next[axis] += if is_greater { 1 } else { -1 };
            if marked.contains(&next) {
                continue;
            }
            for corner in face(*centre, 0.5 * figure.voxel, axis, is_greater) {
                let mut normal = [0.0; 3];
                normal[axis] = if is_greater { 1.0 } else { -1.0 };
                for k in 0..3 {
                    least[k] = least[k].min(corner[k]);
                    greatest[k] = greatest[k].max(corner[k]);
                }
                for number in corner.into_iter().chain(normal).chain(colour) {
                    vertices.extend(number.to_le_bytes());
                }
            }
            for k in [0, 1, 2, 0, 2, 3] {
                indices.extend((count + k).to_le_bytes());
            }
            count += 4;
        }
    }
    let (bytes, faces) = (vertices.len(), indices.len());
    let view = |offset: usize| {
        format!(
            r#""bufferView":0,"byteOffset":{offset},"componentType":5126,"count":{count},"type":"VEC3""#
        )
    };
    let json = format!(
        r#"{{"asset":{{"version":"2.0","generator":"whipcord"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"name":"workspace","rotation":[-0.7071067811865476,0,0,0.7071067811865476]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"COLOR_0":2}},"indices":3,"material":0}}]}}],"materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":0.9}}}}],"accessors":[{{{},"min":{least:?},"max":{greatest:?}}},{{{}}},{{{}}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":{bytes},"byteStride":{VERTEX},"target":34962}},{{"buffer":0,"byteOffset":{bytes},"byteLength":{faces},"target":34963}}],"buffers":[{{"byteLength":{}}}]}}"#,
        view(0),
        view(12),
        view(24),
        faces / 4,
        bytes + faces,
    );
    let mut json = json.into_bytes();
    // Chunks end at multiples of four bytes, those of text with spaces.
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = |bytes: usize| u32::try_from(bytes).unwrap_or(u32::MAX).to_le_bytes();
    let mut glb = Vec::with_capacity(28 + json.len() + bytes + faces);
    glb.extend(b"glTF");
    glb.extend(2_u32.to_le_bytes());
    glb.extend(length(28 + json.len() + bytes + faces));
    glb.extend(length(json.len()));
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend(length(bytes + faces));
    glb.extend(b"BIN\0");
    glb.extend(vertices);
    glb.extend(indices);
    Ok(glb)
}

/// Corners of a face of a voxel, counter-clockwise as seen from outside.
fn face(centre: Vec3, half: f64, axis: usize, is_greater: bool) -> [[f32; 3]; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    if !is_greater {
        corners.reverse();
    }
    corners.map(|[a, b]| {
        let mut at = centre.to_array();
        at[axis] += if is_greater { half } else { -half };
        at[u] += a * half;
        at[v] += b * half;
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are finer than a voxel")]
        at.map(|x| x as f32)
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn figure(cells: Vec<(Vec3, f64)>) -> WorkspaceFigure {
        WorkspaceFigure {
            title: String::new(),
            quantity: Some("value".to_owned()),
            voxel: 0.01,
            cells,
            boundary: Vec::new(),
            backbone: Vec::new(),
            section: None,
            width: 100.0,
        }
    }

    /// By the theorem of Gauss the volume within a closed surface is a third of the sum of corner · normal × area over its triangles,
    /// if all are counter-clockwise as seen from outside.
    #[test]
    fn the_surface_is_closed_and_encloses_the_voxels() {
        let at = |x: i32, y: i32, z: i32| {
            let centre = [x, y, z].map(|i| (f64::from(i) + 0.5) * 0.01);
            (Vec3::new(centre[0], centre[1], centre[2]), f64::from(x))
        };
        let cells = vec![at(0, 0, 9), at(1, 0, 9), at(1, 1, 9), at(-3, -1, 2)];
        let glb = workspace_glb(&figure(cells)).unwrap();
        let number = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&glb[..4], number(8)), (&b"glTF"[..], glb.len()));
        let begin = 20 + number(12) + 8;
        assert_eq!(number(begin - 8), glb.len() - begin);
        // 18 faces less 2 × 2 between neighbours, and 6.
        let vertices = 4 * (18 - 4 + 6);
        let indices = begin + vertices * VERTEX;
        assert_eq!(glb.len() - indices, vertices / 4 * 6 * 4);
        let float = |at: usize| f64::from(f32::from_le_bytes(glb[at..at + 4].try_into().unwrap()));
        let vector = |at: usize| Vec3::new(float(at), float(at + 4), float(at + 8));
        let corner = |k: usize| begin + number(indices + 4 * k) * VERTEX;
        let mut volume = 0.0;
        for triangle in 0..vertices / 2 {
            let [a, b, c] = [0, 1, 2].map(|k| corner(3 * triangle + k));
            let area = (vector(b) - vector(a)).cross(vector(c) - vector(a)) * 0.5;
            assert!(area.dot(vector(a + 12)) > 0.0);
            volume += area.dot(vector(a)) / 3.0;
        }
        assert!((volume - 4e-6).abs() < 1e-11, "{volume}");
        assert!(workspace_glb(&figure(Vec::new())).is_err());
    }
}
