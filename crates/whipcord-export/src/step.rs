//! STEP (ISO 10303-21): wire geometry for CAD, in mm.
//!
//! The backbone and cables that follow their routing are cubic B-splines with knots of multiplicity 2, which are Hermite's cubics
//! from station to station; cables that run straight from hole to hole are polylines. Disks are their centre and their rim.

use core::fmt::Write as _;

use whipcord::{Shape, Vec3};

use crate::drawing::Drawing;
use crate::error::ExportError;
use crate::files::{Exported, ExportedFile};
use crate::guides::follows_routing;
use crate::job::Job;

const FORMAT: &str = "STEP";
const MILLIMETRES: f64 = 1e3;

/// The last step of the case as curves and points.
///
/// # Errors
/// [`ExportError`] where there is no answer.
pub fn step(job: &Job<'_>, stem: &str) -> Result<Exported, ExportError> {
    let drawing = Drawing::of(job, FORMAT)?;
    let mut file = Part21::default();
    let context = file.context(job.title);
    let mut items = Vec::new();
    if let Some(solution) = drawing.answers.last() {
        let shape = &solution.shape;
        let points: Vec<Vec3> = shape.positions().collect();
        items.push(file.spline("backbone", &points, &shape.arc_length, &tangents(shape)));
        for (k, (plate, pose)) in drawing.disks(solution).enumerate() {
            let name = format!("disk {}", k + 1);
            let placement = file.placement(
                &name,
                pose.position,
                [Vec3::Z, Vec3::X].map(|v| pose.rotation.rotate(v)),
            );
            items.push(file.point(&name, pose.position));
            let radius = real(plate.radius);
            items.push(file.add(&format!("CIRCLE({},#{placement},{radius})", text(&name))));
        }
        for (i, cable) in job.robot.cables().iter().enumerate() {
            let name = format!("cable {}", cable.name);
            let at = drawing.cable(solution, i);
            let points: Vec<Vec3> = at.iter().map(|(_, point)| *point).collect();
            if points.len() < 2 {
                continue;
            }
            items.push(if follows_routing(job.model.kind()) || !job.robot.has_disks() {
                let places: Vec<f64> = at.iter().map(|(k, _)| shape.arc_length[*k]).collect();
                let slopes = slopes(&points, &places);
                file.spline(&name, &points, &places, &slopes)
            } else {
                let points: Vec<usize> = points.iter().map(|p| file.point(&name, *p)).collect();
                file.add(&format!("POLYLINE({},{})", text(&name), list(&points)))
            });
        }
        let case = drawing.answers.cases.last().unwrap_or(job.case);
        for (name, surface) in drawing.obstacles(case, solution) {
            let name = text(&format!("obstacle {name}"));
            for line in surface.lines {
                let points: Vec<usize> = line.iter().map(|p| file.point("", *p)).collect();
                items.push(file.add(&format!("POLYLINE({name},{})", list(&points))));
            }
        }
    }
    let set = format!("GEOMETRIC_CURVE_SET({},{})", text(job.title), list(&items));
    let set = file.add(&set);
    let Context { origin, units, definition } = context;
    let shape = file.add(&format!(
        "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',(#{origin},#{set}),#{units})"
    ));
    file.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{definition},#{shape})"));
    let mut lost =
        vec!["all but curves and points: solids, forces and loads; obstacles are the lines of their edges and sections".to_owned()];
    if drawing.answers.steps.len() > 1 {
        lost.push("steps before the last one".to_owned());
    }
    let bytes = file.document(&format!("{stem}.step"));
    Ok(Exported { files: vec![ExportedFile { name: format!("{stem}.step"), bytes }], lost })
}

/// Derivatives of the position by the arc length: those of the strains beside each station.
fn tangents(shape: &Shape) -> Vec<Vec3> {
    let strains: Vec<Vec3> = shape.strains().map(|strain| strain.linear).collect();
    let last = strains.len().saturating_sub(1);
    let tangent = |(k, pose): (usize, &whipcord::Pose)| {
        let [before, after] = [k.saturating_sub(1), k.min(last)].map(|k| strains[k]);
        pose.rotation.rotate((before + after) * 0.5)
    };
    shape.poses.iter().enumerate().map(tangent).collect()
}

/// Derivatives of points by their places: those of the parabolas through three neighbours.
fn slopes(points: &[Vec3], places: &[f64]) -> Vec<Vec3> {
    let count = points.len();
    let chord = |k: usize| (points[k + 1] - points[k]) / (places[k + 1] - places[k]);
    let slope = |k: usize| {
        if count < 3 {
            return chord(0);
        }
        let middle = k.clamp(1, count - 2);
        let [h, g] = [places[middle] - places[middle - 1], places[middle + 1] - places[middle]];
        let bend = (chord(middle) - chord(middle - 1)) / (h + g);
        let of_middle = chord(middle - 1) + bend * h;
        of_middle + bend * (2.0 * (places[k] - places[middle]))
    };
    (0..count).map(slope).collect()
}

/// Numbers of entities that the shape refers to.
struct Context {
    origin: usize,
    units: usize,
    definition: usize,
}

/// A file that is put together: entities with their numbers.
#[derive(Default)]
struct Part21 {
    data: String,
    count: usize,
}

impl Part21 {
    /// Adds an entity and returns its number.
    fn add(&mut self, entity: &str) -> usize {
        self.count += 1;
        // Writing to a text does not fail.
        let _ = writeln!(self.data, "#{}={entity};", self.count);
        self.count
    }

    fn point(&mut self, name: &str, at: Vec3) -> usize {
        let [x, y, z] = at.to_array().map(real);
        self.add(&format!("CARTESIAN_POINT({},({x},{y},{z}))", text(name)))
    }

    fn direction(&mut self, along: Vec3) -> usize {
        let [x, y, z] = along.to_array().map(|c| format!("{c:.12}"));
        self.add(&format!("DIRECTION('',({x},{y},{z}))"))
    }

    fn placement(&mut self, name: &str, at: Vec3, [z, x]: [Vec3; 2]) -> usize {
        let origin = self.point(name, at);
        let [z, x] = [z, x].map(|along| self.direction(along));
        self.add(&format!("AXIS2_PLACEMENT_3D({},#{origin},#{z},#{x})", text(name)))
    }

    /// The cubics with these points and slopes at these places.
    fn spline(&mut self, name: &str, points: &[Vec3], places: &[f64], slopes: &[Vec3]) -> usize {
        let last = points.len() - 1;
        let mut controls = vec![points[0]];
        for k in 0..last {
            let third = (places[k + 1] - places[k]) / 3.0;
            controls.push(points[k] + slopes[k] * third);
            controls.push(points[k + 1] - slopes[k + 1] * third);
        }
        controls.push(points[last]);
        let controls: Vec<usize> = controls.into_iter().map(|p| self.point("", p)).collect();
        let times: Vec<&str> =
            (0..=last).map(|k| if k == 0 || k == last { "4" } else { "2" }).collect();
        let knots: Vec<String> = places.iter().map(|&s| real(s)).collect();
        self.add(&format!(
            "B_SPLINE_CURVE_WITH_KNOTS({},3,{},.UNSPECIFIED.,.F.,.F.,({}),({}),.UNSPECIFIED.)",
            text(name),
            list(&controls),
            times.join(","),
            knots.join(","),
        ))
    }

    /// The product, its units and its frame.
    fn context(&mut self, title: &str) -> Context {
        let title = text(if title.is_empty() { "robot" } else { title });
        let application =
            self.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
        self.add(&format!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})"
        ));
        let of_product = self.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
        let product = self.add(&format!("PRODUCT({title},{title},'',(#{of_product}))"));
        self.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"));
        let formation = self.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let design = self
            .add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
        let definition =
            self.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{design})"));
        let definition = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
        let length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        let solid_angle = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
        let uncertainty = self.add(&format!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#{length},'distance_accuracy_value','')"
        ));
        let units = self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid_angle}))REPRESENTATION_CONTEXT('',''))"
        ));
        let origin = self.placement("", Vec3::ZERO, [Vec3::Z, Vec3::X]);
        Context { origin, units, definition }
    }

    fn document(self, name: &str) -> Vec<u8> {
        // The time is always the same, so that the same robot gives the same bytes.
        let header = format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('wire geometry of a continuum robot'),'2;1');\n\
             FILE_NAME({},'2000-01-01T00:00:00',(''),(''),'whipcord','whipcord','');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n",
            text(name),
        );
        format!("{header}{}ENDSEC;\nEND-ISO-10303-21;\n", self.data).into_bytes()
    }
}

/// A length in m as a real number in mm.
fn real(length: f64) -> String {
    format!("{:.9}", MILLIMETRES * length)
}

fn list(entities: &[usize]) -> String {
    let entities: Vec<String> = entities.iter().map(|entity| format!("#{entity}")).collect();
    format!("({})", entities.join(","))
}

/// A text of Part 21, whose alphabet is that of ISO 646: all else by its number.
fn text(value: &str) -> String {
    let mut text = String::from("'");
    for c in value.chars() {
        match c {
            '\'' => text.push_str("''"),
            '\\' => text.push_str("\\\\"),
            ' '..='~' => text.push(c),
            _ => {
                let _ = write!(text, "\\X4\\{:08X}\\X0\\", u32::from(c));
            }
        }
    }
    text.push('\'');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped() {
        assert_eq!(text(r"it's a\b"), r"'it''s a\\b'");
        assert_eq!(text("ü\n"), r"'\X4\000000FC\X0\\X4\0000000A\X0\'");
    }

    #[test]
    fn slopes_of_a_parabola_are_exact_at_unequal_places() {
        let places = [0.0, 0.1, 0.25, 0.3, 0.7];
        let points = places.map(|s| Vec3::new(s, 3.0 * s * s, -s * s));
        for (slope, s) in slopes(&points, &places).iter().zip(places) {
            assert!((*slope - Vec3::new(1.0, 6.0 * s, -2.0 * s)).norm() < 1e-12);
        }
        assert_eq!(slopes(&points[..2], &places[..2])[1], (points[1] - points[0]) / 0.1);
    }
}
