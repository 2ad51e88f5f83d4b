//! VTK: backbone, cables, disks and contacts of each step with their fields, as XML PolyData, and a collection of them for
//! `ParaView`.

use core::f64::consts::TAU;

use whipcord::section::section_stiffness;
use whipcord::{Case, Mat3, Robot, Shape, Solution, Vec3};

use crate::drawing::Drawing;
use crate::error::ExportError;
use crate::files::{Exported, ExportedFile};
use crate::job::Job;
use crate::section_force::section_forces;
use crate::xml::{Element, check_name, numbers};

const FORMAT: &str = "VTK";
/// Corners of the polygon that stands for a disk.
const CORNERS: usize = 36;

/// A collection (`.pvd`), and in a folder beside it a file for each part and step.
///
/// # Errors
/// [`ExportError`] where there is no answer.
pub fn vtk(job: &Job<'_>, stem: &str) -> Result<Exported, ExportError> {
    check_name(stem)?;
    let drawing = Drawing::of(job, FORMAT)?;
    let mut collection = Element::new("Collection");
    let mut files = Vec::new();
    for (step, solution) in drawing.answers.steps.iter().enumerate() {
        let case = &drawing.answers.cases[step];
        let parts = [
            ("backbone", backbone((job.robot, case), &drawing, solution)),
            ("cables", cables(job.robot, &drawing, solution)),
            ("disks", disks(&drawing, solution)),
            ("contacts", contacts(solution)),
            ("obstacles", obstacles(case, &drawing, solution)),
        ];
        for (part, (name, data)) in parts.into_iter().enumerate() {
            // Readers take a file without points for damaged.
            if data.points.is_empty() {
                continue;
            }
            let file = format!("{stem}/{name}-{}.vtp", step + 1);
            collection.push(
                Element::new("DataSet")
                    .with("timestep", step)
                    .with("part", part)
                    .with("name", name)
                    .with("file", &file),
            );
            files.push(ExportedFile { name: file, bytes: data.document()? });
        }
    }
    let index = vtk_file("Collection").and(collection).document()?;
    files.insert(0, ExportedFile { name: format!("{stem}.pvd"), bytes: index });
    let lost = vec![
        "loads, and the names of cables and obstacles: they are numbered from 1 as in the robot file"
            .to_owned(),
    ];
    Ok(Exported { files, lost })
}

fn vtk_file(kind: &str) -> Element {
    let file = Element::new("VTKFile").with("type", kind).with("version", "1.0");
    file.with("byte_order", "LittleEndian").with("header_type", "UInt64")
}

/// A field: its name, its components, and its values one after the other.
#[derive(Clone, Debug)]
struct Field {
    name: &'static str,
    components: usize,
    values: Vec<f64>,
}

impl Field {
    fn scalars(name: &'static str, values: Vec<f64>) -> Self {
        Self { name, components: 1, values }
    }

    fn vectors(name: &'static str, values: impl IntoIterator<Item = Vec3>) -> Self {
        let values = values.into_iter().flat_map(|v| v.to_array()).collect();
        Self { name, components: 3, values }
    }

    fn element(&self) -> Element {
        Element::new("DataArray")
            .with("type", "Float64")
            .with("Name", self.name)
            .with("NumberOfComponents", self.components)
            .with("format", "ascii")
            .holding(numbers(&self.values))
    }
}

/// Points with cells of one kind.
#[derive(Clone, Debug, Default)]
struct PolyData {
    points: Vec<Vec3>,
    /// `Verts`, `Lines` or `Polys`.
    kind: &'static str,
    cells: Vec<Vec<usize>>,
    point_data: Vec<Field>,
    cell_data: Vec<Field>,
}

impl PolyData {
    fn document(&self) -> Result<Vec<u8>, ExportError> {
        let integers = |name: &str, values: Vec<usize>| {
            let text: Vec<String> = values.iter().map(usize::to_string).collect();
            Element::new("DataArray")
                .with("type", "Int64")
                .with("Name", name)
                .with("format", "ascii")
                .holding(text.join(" "))
        };
        let mut end = 0;
        let offsets = self.cells.iter().map(|cell| {
            end += cell.len();
            end
        });
        let offsets = integers("offsets", offsets.collect());
        let connectivity = integers("connectivity", self.cells.concat());
        let count = |kind: &str| if kind == self.kind { self.cells.len() } else { 0 };
        let fields = |name: &'static str, fields: &[Field]| {
            Element::new(name).and_all(fields.iter().map(Field::element))
        };
        let piece = Element::new("Piece")
            .with("NumberOfPoints", self.points.len())
            .with("NumberOfVerts", count("Verts"))
            .with("NumberOfLines", count("Lines"))
            .with("NumberOfStrips", 0)
            .with("NumberOfPolys", count("Polys"))
            .and(fields("PointData", &self.point_data))
            .and(fields("CellData", &self.cell_data))
            .and(
                Element::new("Points")
                    .and(Field::vectors("Points", self.points.iter().copied()).element()),
            )
            .and(Element::new(self.kind).and(connectivity).and(offsets));
        vtk_file("PolyData").and(Element::new("PolyData").and(piece)).document()
    }
}

/// A line for each span between two disks, so that what jumps at a disk has both of its values there.
fn backbone(
    (robot, case): (&Robot, &Case),
    drawing: &Drawing<'_>,
    solution: &Solution,
) -> PolyData {
    let shape = &solution.shape;
    let mut data = PolyData { kind: "Lines", ..PolyData::default() };
    let (mut arc_length, mut radius, mut span_of) = (Vec::new(), Vec::new(), Vec::new());
    let (mut curvature, mut moment) = (Vec::new(), Vec::new());
    let mut axes: [Vec<Vec3>; 3] = Default::default();
    let of_pieces = section_forces(robot, case, drawing, solution);
    let mut force = Vec::new();
    let mut is_elastic = true;
    for (span, stations) in spans(robot, shape).into_iter().enumerate() {
        let first = data.points.len();
        data.cells.push((first..first + stations.len()).collect());
        span_of.push((span + 1) as f64);
        let inside = 0.5 * (shape.arc_length[stations[0]] + shape.arc_length[stations[1]]);
        if let Some(of_pieces) = &of_pieces {
            let s: Vec<f64> = stations.iter().map(|&i| shape.arc_length[i]).collect();
            force.extend(between_middles(&s, &of_pieces[stations[0]..stations[0] + s.len() - 1]));
        }
        for (i, u) in stations.iter().zip(curvatures(shape, &stations)) {
            let (s, pose) = (shape.arc_length[*i], shape.poses[*i]);
            data.points.push(pose.position);
            arc_length.push(s);
            radius.push(drawing.radius(s));
            curvature.push(u);
            for (axis, unit) in axes.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
                axis.push(pose.rotation.rotate(unit));
            }
            let inside =
                if *i == stations[0] { inside } else { s - 1e-9 * robot.backbone().length };
            match section_stiffness(robot, s, inside) {
                Ok(stiffness) => {
                    let row =
                        |i: usize| Vec3::new(stiffness[i][3], stiffness[i][4], stiffness[i][5]);
                    let rest = robot.backbone().rest_curvature.at_end(robot.disks(), s, inside);
                    let of_section = Mat3::from_rows(row(3), row(4), row(5)) * (u - rest);
                    moment.push(pose.rotation.rotate(of_section));
                }
                Err(_) => is_elastic = false,
            }
        }
    }
    let [x, y, z] = axes;
    data.point_data = vec![
        Field::scalars("arc_length", arc_length),
        Field::scalars("radius", radius),
        Field::vectors("curvature", curvature),
        Field::vectors("director_x", x),
        Field::vectors("director_y", y),
        Field::vectors("director_z", z),
    ];
    if is_elastic {
        data.point_data.push(Field::vectors("moment", moment));
    }
    if of_pieces.is_some() {
        data.point_data.push(Field::vectors("force", force));
    }
    data.cell_data = vec![Field::scalars("span", span_of)];
    data
}

/// The stations of each span between two disks.
fn spans(robot: &Robot, shape: &Shape) -> Vec<Vec<usize>> {
    let reach = 1e-9 * robot.backbone().length;
    let within = |ends: &[f64]| {
        let first = shape.arc_length.partition_point(|&s| s < ends[0] - reach);
        let end = shape.arc_length.partition_point(|&s| s <= ends[1] + reach);
        (first..end).collect()
    };
    let all = robot.disks().arc_lengths.windows(2).map(within);
    all.filter(|stations: &Vec<usize>| stations.len() > 1).collect()
}

/// Curvature and twist in the frame of the section at each of these stations, linear between the middles of the pieces.
fn curvatures(shape: &Shape, stations: &[usize]) -> Vec<Vec3> {
    let part = Shape {
        arc_length: stations.iter().map(|&i| shape.arc_length[i]).collect(),
        poses: stations.iter().map(|&i| shape.poses[i]).collect(),
    };
    let of_pieces: Vec<Vec3> = part.strains().map(|strain| strain.angular).collect();
    between_middles(&part.arc_length, &of_pieces)
}

/// Values at these places from those in the middles of the pieces between them: linear from middle to middle and beyond the last ones.
fn between_middles(places: &[f64], of_pieces: &[Vec3]) -> Vec<Vec3> {
    let middles: Vec<f64> = places.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect();
    let at = |s: &f64| {
        if of_pieces.len() < 2 {
            return of_pieces[0];
        }
        let after = middles.partition_point(|middle| middle <= s).clamp(1, middles.len() - 1);
        let along = (s - middles[after - 1]) / (middles[after] - middles[after - 1]);
        of_pieces[after - 1] * (1.0 - along) + of_pieces[after] * along
    };
    places.iter().map(at).collect()
}

fn cables(robot: &Robot, drawing: &Drawing<'_>, solution: &Solution) -> PolyData {
    let mut data = PolyData { kind: "Lines", ..PolyData::default() };
    let (mut number, mut tensions, mut are_known) = (Vec::new(), Vec::new(), true);
    for (i, state) in solution.cables.iter().enumerate() {
        let points = drawing.cable(solution, i);
        let first = data.points.len();
        data.cells.push((first..first + points.len()).collect());
        number.push((i + 1) as f64);
        for (k, (station, point)) in points.iter().enumerate() {
            data.points.push(*point);
            // Where it jumps, the value beyond; at the end that before.
            let next = points.get(k + 1).map_or(*station, |next| next.0);
            let before = if next == *station { k.saturating_sub(1) } else { k };
            let beside = points.get(before + 1).map_or(*station, |next| next.0);
            let s = &solution.shape.arc_length;
            let (span, _) = robot.disks().locate(0.5 * (s[points[before].0] + s[beside]));
            let tension = state.span_tensions.get(span).copied().or(state.tension);
            are_known &= tension.is_some();
            tensions.push(tension.unwrap_or(0.0));
        }
    }
    let radius = vec![drawing.thin(); data.points.len()];
    data.point_data = vec![Field::scalars("radius", radius)];
    if are_known {
        data.point_data.push(Field::scalars("tension", tensions));
    }
    data.cell_data = vec![Field::scalars("cable", number)];
    data
}

fn disks(drawing: &Drawing<'_>, solution: &Solution) -> PolyData {
    let mut data = PolyData { kind: "Polys", ..PolyData::default() };
    let mut numbers = Vec::new();
    for (k, (plate, pose)) in drawing.disks(solution).enumerate() {
        let first = data.points.len();
        data.cells.push((first..first + CORNERS).collect());
        numbers.push((k + 1) as f64);
        data.points.extend((0..CORNERS).map(|corner| {
            let (sin, cos) = (TAU * corner as f64 / CORNERS as f64).sin_cos();
            pose.transform(Vec3::new(plate.radius * cos, plate.radius * sin, 0.0))
        }));
    }
    data.cell_data = vec![Field::scalars("disk", numbers)];
    data
}

fn obstacles(case: &Case, drawing: &Drawing<'_>, solution: &Solution) -> PolyData {
    let mut data = PolyData { kind: "Polys", ..PolyData::default() };
    let mut numbers = Vec::new();
    for (number, (_, surface)) in drawing.obstacles(case, solution).enumerate() {
        let first = data.points.len();
        data.points.extend(surface.points);
        data.cells
            .extend(surface.triangles.iter().map(|corners| corners.map(|k| first + k).into()));
        numbers.resize(data.cells.len(), (number + 1) as f64);
    }
    data.cell_data = vec![Field::scalars("obstacle", numbers)];
    data
}

fn contacts(solution: &Solution) -> PolyData {
    let contacts = &solution.contacts;
    let mut data = PolyData { kind: "Verts", ..PolyData::default() };
    data.points = contacts.iter().map(|contact| contact.point).collect();
    data.cells = (0..contacts.len()).map(|i| vec![i]).collect();
    let force = |contact: &whipcord::Contact| {
        let normal = contact.force.map(|force| contact.normal * force);
        normal.map(|normal| normal + contact.friction.unwrap_or(Vec3::ZERO))
    };
    let forces: Option<Vec<Vec3>> = contacts.iter().map(force).collect();
    data.point_data = vec![
        Field::vectors("normal", contacts.iter().map(|contact| contact.normal)),
        Field::scalars("gap", contacts.iter().map(|contact| contact.gap).collect()),
        Field::scalars("obstacle", contacts.iter().map(|c| (c.obstacle + 1) as f64).collect()),
    ];
    data.point_data.extend(forces.map(|forces| Field::vectors("force", forces)));
    data
}
