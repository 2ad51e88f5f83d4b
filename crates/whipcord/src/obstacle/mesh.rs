//! Bodies that triangles enclose.

use whipcord_numerics::Vec3;

use super::nearest::{Part, Pseudonormals, Tree};
use super::surface::Surface;
use super::topology;
use crate::robot::{Problem, RobotError, limits};

/// A body that triangles enclose: none open, and each counter-clockwise as seen from outside.
#[derive(Clone)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    file: Option<MeshFile>,
    /// Of the body shrunk by a power of two to about 1 m, where no product of coordinates is too small or too large.
    tree: Tree,
    normals: Pseudonormals,
    shrink: f64,
}

/// The file that a mesh was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Its path, as from the working directory.
    pub path: String,
    /// Metres for one unit of the file.
    pub scale: f64,
}

impl Mesh {
    /// Most triangles: as many take minutes to draw and a gigabyte to hold.
    pub const MOST_TRIANGLES: usize = 2_000_000;

    /// The body that these triangles enclose. Vertices are in m, in the frame of the obstacle;
    /// vertices at the same place are one.
    ///
    /// # Errors
    /// [`RobotError`] where there is no triangle, where one has no area or a vertex that there is
    /// not, and where they do not enclose a body: an edge is not of two triangles that run along it
    /// in opposite directions, or what they enclose lies outside.
    pub fn new(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, RobotError> {
        let refused = |problem| RobotError::new("mesh", problem);
        if triangles.is_empty() {
            return Err(refused(Problem::NoTriangles));
        }
        let (given, most) = (triangles.len(), Self::MOST_TRIANGLES);
        if given > most {
            return Err(refused(Problem::TooMany { given, most }));
        }
        for (k, &vertex) in vertices.iter().enumerate() {
            limits::COORDINATE.check_vector(&format!("mesh.vertices[{k}]"), vertex)?;
        }
        let (vertices, triangles) = topology::merged(vertices, triangles).map_err(refused)?;
        topology::check(&vertices, &triangles).map_err(refused)?;
        let extent = vertices.iter().map(|v| v.max_abs()).fold(0.0, f64::max);
        let shrink = (-extent.log2().ceil()).exp2();
        let shrunk: Vec<Vec3> = vertices.iter().map(|&v| shrink * v).collect();
        let tree = Tree::new(&shrunk, &triangles);
        let normals = Pseudonormals::new(&shrunk, &triangles);
        Ok(Self { vertices, triangles, file: None, tree, normals, shrink })
    }

    /// The same mesh, known to be from a file.
    #[must_use]
    pub fn with_file(self, file: MeshFile) -> Self {
        Self { file: Some(file), ..self }
    }

    /// The file it was read from, where it is known.
    #[must_use]
    pub fn file(&self) -> Option<&MeshFile> {
        self.file.as_ref()
    }

    /// In m, in the frame of the obstacle, each place once.
    #[must_use]
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Each by three numbers of vertices, counter-clockwise as seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The nearest point is that of the nearest triangle; which side of it a point is on, the normal of the
    /// triangle, edge or vertex says that the nearest point is on (J. A. Bærentzen and H. Aanæs,
    /// Signed distance computation using the angle weighted pseudonormal, 2005).
    pub(super) fn surface(&self, point: Vec3) -> Surface {
        let p = self.shrink * point;
        let corners = |triangle: usize| {
            self.triangles[triangle].map(|k| self.shrink * self.vertices[k as usize])
        };
        let nearest = self.tree.nearest(p, corners);
        let pseudo = match nearest.part {
            Part::Edge(i) => Some(self.normals.edges[nearest.triangle][i]),
            Part::Corner(i) => {
                Some(self.normals.corners[self.triangles[nearest.triangle][i] as usize])
            }
            Part::Face => None,
        };
        // Where two faces lie on one another their normals cancel.
        let Some(pseudo) = pseudo.filter(|sum| sum.norm() > 0.0).map(|sum| sum / sum.norm()) else {
            let [a, b, c] = corners(nearest.triangle);
            let across = (b - a).cross(c - a);
            let normal = across / across.norm();
            return Surface { distance: (p - a).dot(normal) / self.shrink, normal };
        };
        let away = p - nearest.point;
        let distance = away.norm();
        let sign = if away.dot(pseudo) < 0.0 { -1.0 } else { 1.0 };
        // So near to an edge or a vertex, the way from it is rounding.
        let normal = if distance < 1e-13 { pseudo } else { (sign / distance) * away };
        Surface { distance: sign * distance / self.shrink, normal }
    }
}

/// By content; where it was read from does not matter.
impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self, other)
            || (self.vertices == other.vertices && self.triangles == other.triangles)
    }
}

impl core::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Mesh")
            .field("vertices", &self.vertices.len())
            .field("triangles", &self.triangles.len())
            .field("file", &self.file)
            .finish()
    }
}
