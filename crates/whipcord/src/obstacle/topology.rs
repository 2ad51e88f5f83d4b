//! Whether triangles enclose a body.

use std::collections::HashMap;

use whipcord_numerics::Vec3;

use crate::robot::Problem;

/// Below this part of the square of its longest edge, the area of a triangle is rounding.
const LEAST_AREA: f64 = 1e-12;

/// The triangles with each place a vertex of its own, however often it was given.
pub(super) fn merged(
    vertices: &[Vec3],
    triangles: &[[u32; 3]],
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), Problem> {
    let mut first: HashMap<[u64; 3], u32> = HashMap::new();
    let mut places = Vec::new();
    let mut number = |index: u32| {
        let &vertex = vertices.get(index as usize)?;
        // Zero and its negative are one place.
        let key = vertex.to_array().map(|x| (x + 0.0).to_bits());
        Some(*first.entry(key).or_insert_with(|| {
            places.push(vertex);
            (places.len() - 1) as u32
        }))
    };
    let mut all = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        let mut numbered = [0; 3];
        for (corner, &index) in numbered.iter_mut().zip(corners) {
            *corner = number(index).ok_or(Problem::NoSuchVertex {
                triangle,
                vertex: index as usize,
                vertices: vertices.len(),
            })?;
        }
        all.push(numbered);
    }
    Ok((places, all))
}

/// Refuses triangles without area, edges that are not of two triangles that run along them in
/// opposite directions, and what encloses all but a body.
pub(super) fn check(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), Problem> {
    let corner = |index: u32| vertices[index as usize];
    let flat = |corners: &&[u32; 3]| {
        let [a, b, c] = corners.map(corner);
        let longest = [b - a, c - b, a - c].map(Vec3::norm_squared).into_iter().fold(0.0, f64::max);
        let twice_area = (b - a).cross(c - a).norm();
        twice_area.is_nan() || twice_area <= 2.0 * LEAST_AREA * longest
    };
    let count = triangles.iter().filter(flat).count();
    if count > 0 {
        let triangle = triangles.iter().position(|corners| flat(&corners)).unwrap_or(0);
        return Err(Problem::FlatTriangles { count, triangle });
    }
    let mut edges: HashMap<(u32, u32), [u32; 2]> = HashMap::with_capacity(2 * triangles.len());
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let way = usize::from(from > to);
            edges.entry((from.min(to), from.max(to))).or_default()[way] += 1;
        }
    }
    // The first of a kind, by its vertices, so that a message is the same each time.
    let of_kind = |kind: fn(&[u32; 2]) -> bool| {
        let all = edges.iter().filter(|(_, ways)| kind(ways)).map(|(&edge, _)| edge);
        let count = all.clone().count();
        all.min().map(|(a, b)| (count, 0.5 * (corner(a) + corner(b))))
    };
    if let Some((count, near)) = of_kind(|[a, b]| a + b == 1) {
        return Err(Problem::OpenEdges { count, near });
    }
    if let Some((count, near)) = of_kind(|[a, b]| a + b > 2) {
        return Err(Problem::CrowdedEdges { count, near });
    }
    if let Some((count, near)) = of_kind(|[a, b]| a != b) {
        return Err(Problem::OpposedTriangles { count, near });
    }
    // About a vertex, so that what is far off does not drown the volume in rounding.
    let origin = corner(triangles[0][0]);
    let volume = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|index| corner(index) - origin);
        a.dot(b.cross(c)) / 6.0
    };
    let volume: f64 = triangles.iter().map(volume).sum();
    if volume > 0.0 { Ok(()) } else { Err(Problem::InsideOut { volume }) }
}
