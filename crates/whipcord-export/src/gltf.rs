//! glTF: backbone, disks and cables as named meshes.

use core::f64::consts::TAU;
use std::collections::HashMap;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::UnitQuaternion as Quaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::validation::USize64;
use gltf_json::{Accessor, Asset, Buffer, Index, Material, Mesh, Node, Root, Scene};
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_plot::{Colour, OBSTACLE, ObstacleSurface};

use crate::drawing::Drawing;
use crate::error::ExportError;
use crate::files::{Exported, ExportedFile};
use crate::job::Job;

const FORMAT: &str = "glTF";
/// Corners of a round section, of a disk and of a cable.
const CORNERS: [usize; 3] = [24, 48, 8];
/// Cosine of the angle between two triangles from which on the edge between them is sharp.
const EDGE: f64 = 0.866;
/// The z axis of the robot is the y axis of glTF, which viewers show upwards.
const Z_TO_Y: [f32; 4] =
    [-core::f32::consts::FRAC_1_SQRT_2, 0.0, 0.0, core::f32::consts::FRAC_1_SQRT_2];

/// The last step of the case as binary glTF.
///
/// # Errors
/// [`ExportError`] where there is no answer.
pub fn gltf(job: &Job<'_>, stem: &str) -> Result<Exported, ExportError> {
    let drawing = Drawing::of(job, FORMAT)?;
    let mut file = Writer::default();
    if let Some(solution) = drawing.answers.last() {
        let shape = &solution.shape;
        let profile = |s: &f64| match drawing.bar(*s) {
            Some(half) => bar(half),
            None => round(drawing.radius(*s), CORNERS[0]),
        };
        let profiles: Vec<_> = shape.arc_length.iter().map(profile).collect();
        let grey = file.material("backbone", Colour::GREY);
        file.object("backbone", &sweep(&shape.poses, &profiles), grey, Pose::IDENTITY);
        let pale = file.material("disk", Colour::GRID);
        for (k, (plate, pose)) in drawing.disks(solution).enumerate() {
            let face = |z: f64| Pose { position: Vec3::new(0.0, 0.0, z), ..Pose::IDENTITY };
            let rim = round(plate.radius, CORNERS[1]);
            let half = 0.5 * plate.thickness;
            let surface = sweep(&[face(-half), face(half)], &[rim.clone(), rim]);
            file.object(&format!("disk {}", k + 1), &surface, pale, pose);
        }
        for (i, cable) in job.robot.cables().iter().enumerate() {
            let points: Vec<Vec3> =
                drawing.cable(solution, i).into_iter().map(|(_, point)| point).collect();
            let poses = along(&points);
            let profiles = vec![round(0.5 * drawing.thin(), CORNERS[2]); poses.len()];
            let name = format!("cable {}", cable.name);
            let colour = file.material(&name, Colour::nth(i));
            file.object(&name, &sweep(&poses, &profiles), colour, Pose::IDENTITY);
        }
        let case = drawing.answers.cases.last().unwrap_or(job.case);
        let brown = file.material("obstacle", OBSTACLE);
        for (name, surface) in drawing.obstacles(case, solution) {
            file.object(&format!("obstacle {name}"), &shaded(surface), brown, Pose::IDENTITY);
        }
    }
    let title = if job.title.is_empty() { "robot" } else { job.title };
    let mut lost =
        vec!["all numbers but the shape; holes of disks, inner diameters and loads".to_owned()];
    if drawing.answers.steps.len() > 1 {
        lost.push("steps before the last one".to_owned());
    }
    let file = ExportedFile { name: format!("{stem}.glb"), bytes: file.glb(title)? };
    Ok(Exported { files: vec![file], lost })
}

/// A corner of a cross-section with its normal.
type Corner = ([f64; 2], [f64; 2]);

fn round(radius: f64, corners: usize) -> Vec<Corner> {
    let corner = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / corners as f64).sin_cos();
        ([radius * cos, radius * sin], [cos, sin])
    };
    (0..corners).map(corner).collect()
}

/// Each corner twice, for the two faces that meet there.
fn bar([x, y]: [f64; 2]) -> Vec<Corner> {
    let faces = [
        ([[x, -y], [x, y]], [1.0, 0.0]),
        ([[x, y], [-x, y]], [0.0, 1.0]),
        ([[-x, y], [-x, -y]], [-1.0, 0.0]),
        ([[-x, -y], [x, -y]], [0.0, -1.0]),
    ];
    faces.into_iter().flat_map(|(ends, normal)| ends.map(|end| (end, normal))).collect()
}

/// A surface of triangles, counter-clockwise as seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
struct Surface {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[usize; 3]>,
}

/// The surface that cross-sections of as many corners at these poses span, closed at both ends.
fn sweep(poses: &[Pose], profiles: &[Vec<Corner>]) -> Surface {
    let mut surface = Surface::default();
    let Some(corners) = profiles.first().map(Vec::len).filter(|_| poses.len() > 1) else {
        return surface;
    };
    for (pose, profile) in poses.iter().zip(profiles) {
        for ([x, y], [nx, ny]) in profile {
            surface.points.push(pose.transform(Vec3::new(*x, *y, 0.0)));
            surface.normals.push(pose.rotation.rotate(Vec3::new(*nx, *ny, 0.0)));
        }
    }
    for ring in 0..poses.len() - 1 {
        for k in 0..corners {
            let next = (k + 1) % corners;
            if profiles[0][k].0 == profiles[0][next].0 {
                continue;
            }
            let [a, b] = [ring * corners + k, ring * corners + next];
            surface.triangles.push([a, b, b + corners]);
            surface.triangles.push([a, b + corners, a + corners]);
        }
    }
    for (end, outwards) in [(0, -1.0), (poses.len() - 1, 1.0)] {
        let first = surface.points.len();
        let pose = poses[end];
        for (at, _) in &profiles[end] {
            surface.points.push(pose.transform(Vec3::new(at[0], at[1], 0.0)));
            surface.normals.push(pose.rotation.rotate(Vec3::Z) * outwards);
        }
        for k in 1..corners.saturating_sub(1) {
            let [b, c] = if outwards > 0.0 { [k, k + 1] } else { [k + 1, k] };
            let at = |k: usize| profiles[end][k].0;
            if at(0) != at(b) && at(b) != at(c) && at(c) != at(0) {
                surface.triangles.push([first, first + b, first + c]);
            }
        }
    }
    surface
}

/// A surface with normals, smooth where it bends less than at an edge. Each triangle has its own corners.
fn shaded(surface: ObstacleSurface) -> Surface {
    let ObstacleSurface { points, triangles, .. } = surface;
    // Corners that are one point, whatever triangle they are of.
    let key = |point: Vec3| point.to_array().map(f64::to_bits);
    let across = |corners: &[usize; 3]| {
        let [a, b, c] = corners.map(|k| points[k]);
        (b - a).cross(c - a)
    };
    let mut around: HashMap<[u64; 3], Vec<Vec3>> = HashMap::new();
    for corners in &triangles {
        for k in corners {
            around.entry(key(points[*k])).or_default().push(across(corners));
        }
    }
    let mut made = Surface::default();
    for corners in &triangles {
        let own = across(corners);
        let first = made.points.len();
        for k in corners {
            let beside = around.get(&key(points[*k])).into_iter().flatten();
            let smooth = beside.filter(|other| own.dot(**other) > EDGE * own.norm() * other.norm());
            let normal = smooth.fold(Vec3::ZERO, |sum, other| sum + *other);
            made.points.push(points[*k]);
            made.normals.push(normal / normal.norm());
        }
        made.triangles.push([first, first + 1, first + 2]);
    }
    made
}

/// Frames along points whose z axes follow them, and which turn as little as they can.
fn along(points: &[Vec3]) -> Vec<Pose> {
    let mut rotation = UnitQuaternion::IDENTITY;
    let mut poses = Vec::with_capacity(points.len());
    for (k, &position) in points.iter().enumerate() {
        let [from, to] = [k.saturating_sub(1), (k + 1).min(points.len() - 1)];
        let way = points[to] - points[from];
        if way.norm() > 0.0 {
            let (z, tangent) = (rotation.rotate(Vec3::Z), way / way.norm());
            let axis = z.cross(tangent);
            let (sin, cos) = (axis.norm(), z.dot(tangent));
            let turn = match sin > 1e-12 {
                true => axis * (sin.atan2(cos) / sin),
                // Straight back: about any axis across.
                false if cos < 0.0 => rotation.rotate(Vec3::X) * core::f64::consts::PI,
                false => Vec3::ZERO,
            };
            rotation = (UnitQuaternion::exp(turn) * rotation).renormalized();
        }
        poses.push(Pose { position, rotation });
    }
    poses
}

/// A file that is put together.
#[derive(Default)]
struct Writer {
    root: Root,
    bytes: Vec<u8>,
    buffer: Option<Index<Buffer>>,
    nodes: Vec<Index<Node>>,
}

impl Writer {
    fn material(&mut self, name: &str, colour: Colour) -> Index<Material> {
        let [r, g, b] = colour.linear();
        let material = Material {
            name: Some(name.to_owned()),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(0.6),
                ..PbrMetallicRoughness::default()
            },
            ..Material::default()
        };
        self.root.push(material)
    }

    /// Adds a mesh as a node; none where it has no surface.
    fn object(&mut self, name: &str, surface: &Surface, material: Index<Material>, at: Pose) {
        if surface.triangles.is_empty() {
            return;
        }
        let positions = self.vectors(&surface.points, true);
        let normals = self.vectors(&surface.normals, false);
        let offset = self.bytes.len();
        for corner in surface.triangles.iter().flatten() {
            self.bytes.extend(u32::try_from(*corner).unwrap_or(u32::MAX).to_le_bytes());
        }
        let view = self.view(offset, Target::ElementArrayBuffer);
        let count = 3 * surface.triangles.len();
        let indices = self.root.push(accessor(view, ComponentType::U32, Type::Scalar, count));
        let attributes =
            [(Valid(Semantic::Positions), positions), (Valid(Semantic::Normals), normals)];
        let primitive = Primitive {
            attributes: attributes.into_iter().collect(),
            indices: Some(indices),
            material: Some(material),
            mode: Valid(Mode::Triangles),
            extensions: None,
            extras: Default::default(),
            targets: None,
        };
        let mesh = self.root.push(Mesh {
            name: Some(name.to_owned()),
            primitives: vec![primitive],
            extensions: None,
            extras: Default::default(),
            weights: None,
        });
        let [w, x, y, z] = at.rotation.wxyz().map(single);
        let is_placed = at != Pose::IDENTITY;
        let node = Node {
            name: Some(name.to_owned()),
            mesh: Some(mesh),
            translation: is_placed.then(|| at.position.to_array().map(single)),
            rotation: is_placed.then_some(Quaternion([x, y, z, w])),
            ..Node::default()
        };
        let node = self.root.push(node);
        self.nodes.push(node);
    }

    fn vectors(&mut self, vectors: &[Vec3], with_bounds: bool) -> Index<Accessor> {
        let offset = self.bytes.len();
        let (mut least, mut greatest) = ([f32::MAX; 3], [f32::MIN; 3]);
        for vector in vectors {
            for (k, number) in vector.to_array().map(single).into_iter().enumerate() {
                least[k] = least[k].min(number);
                greatest[k] = greatest[k].max(number);
                self.bytes.extend(number.to_le_bytes());
            }
        }
        let view = self.view(offset, Target::ArrayBuffer);
        let mut accessor = accessor(view, ComponentType::F32, Type::Vec3, vectors.len());
        if with_bounds {
            accessor.min = Some(serde_json::json!(least));
            accessor.max = Some(serde_json::json!(greatest));
        }
        self.root.push(accessor)
    }

    /// A view of the bytes from an offset to the end.
    fn view(&mut self, offset: usize, target: Target) -> Index<View> {
        let root = &mut self.root;
        let empty = Buffer {
            byte_length: USize64(0),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        };
        let buffer = *self.buffer.get_or_insert_with(|| root.push(empty));
        root.push(View {
            buffer,
            byte_length: USize64::from(self.bytes.len() - offset),
            byte_offset: Some(USize64::from(offset)),
            byte_stride: None,
            name: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: Default::default(),
        })
    }

    /// The file, with a node of this name above all others.
    fn glb(mut self, title: &str) -> Result<Vec<u8>, ExportError> {
        let top = self.root.push(Node {
            name: Some(title.to_owned()),
            children: Some(self.nodes),
            rotation: Some(Quaternion(Z_TO_Y)),
            ..Node::default()
        });
        let scene =
            Scene { name: None, nodes: vec![top], extensions: None, extras: Default::default() };
        self.root.scene = Some(self.root.push(scene));
        self.root.asset = Asset { generator: Some("whipcord".to_owned()), ..Asset::default() };
        for buffer in &mut self.root.buffers {
            buffer.byte_length = USize64::from(self.bytes.len());
        }
        let unwritten = |reason: String| ExportError::Unwritten { reason };
        let json = self.root.to_string().map_err(|error| unwritten(error.to_string()))?;
        let mut json = json.into_bytes();
        // Chunks end at multiples of four bytes, those of text with spaces.
        json.resize(json.len().next_multiple_of(4), b' ');
        let total = 28 + json.len() + self.bytes.len();
        let length = |bytes: usize| {
            let length = u32::try_from(bytes).ok().map(u32::to_le_bytes);
            length.ok_or_else(|| unwritten("it would be longer than 4 GiB".to_owned()))
        };
        let mut glb = Vec::with_capacity(total);
        glb.extend(b"glTF");
        glb.extend(2_u32.to_le_bytes());
        glb.extend(length(total)?);
        glb.extend(length(json.len())?);
        glb.extend(b"JSON");
        glb.extend(json);
        glb.extend(length(self.bytes.len())?);
        glb.extend(b"BIN\0");
        glb.extend(self.bytes);
        Ok(glb)
    }
}

fn accessor(view: Index<View>, component: ComponentType, type_: Type, count: usize) -> Accessor {
    Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: USize64::from(count),
        component_type: Valid(GenericComponentType(component)),
        type_: Valid(type_),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
        extensions: None,
        extras: Default::default(),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "glTF has 32-bit floats: 7 digits of a robot")]
const fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use whipcord::Twist;

    use super::*;

    /// By the theorem of Gauss the volume is a third of the sum of corner · normal × area over the triangles.
    fn volume(surface: &Surface) -> f64 {
        let of = |corners: &[usize; 3]| {
            let [a, b, c] = corners.map(|k| surface.points[k]);
            a.dot(b.cross(c)) / 6.0
        };
        surface.triangles.iter().map(of).sum()
    }

    #[test]
    fn swept_surfaces_are_closed_and_have_the_volume_of_the_rod() {
        let twist = Twist { linear: Vec3::Z, angular: Vec3::new(4.0, 0.0, 3.0) };
        let poses: Vec<Pose> =
            (0..=400).map(|k| Pose::exp(twist * (0.0005 * f64::from(k)))).collect();
        for (profile, area) in
            [(round(0.01, 96), core::f64::consts::PI * 1e-4), (bar([0.01, 0.004]), 0.02 * 0.008)]
        {
            let surface = sweep(&poses, &vec![profile; poses.len()]);
            assert!((volume(&surface) / (area * 0.2) - 1.0).abs() < 2e-3, "{}", volume(&surface));
            for corners in &surface.triangles {
                let [a, b, c] = corners.map(|k| surface.points[k]);
                let across = (b - a).cross(c - a);
                assert!(across.dot(surface.normals[corners[0]]) > 0.0);
            }
        }
    }

    #[test]
    fn frames_follow_points_around_corners() {
        let points = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 1.0, -1.0)];
        let poses = along(&points);
        assert!((poses[0].rotation.rotate(Vec3::Z) - Vec3::X).norm() < 1e-12);
        assert!((poses[3].rotation.rotate(Vec3::Z) + Vec3::Z).norm() < 1e-12);
    }
}
