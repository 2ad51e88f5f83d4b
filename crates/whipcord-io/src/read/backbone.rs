use whipcord::robot::{BackboneSegment, BendingFriction, StiffnessMatrix};
use whipcord::{Along, Backbone, Material, RestCurvature, Section, Stiffness, Vec3};

use crate::check::{Data, Fields};
use crate::materials::preset;
use crate::overlay::default_name;

/// `[backbone]`; `None` when the length is missing.
pub(crate) fn backbone(fields: &Fields) -> Option<Backbone> {
    let length = fields.number("length")?;
    Some(Backbone {
        section: section(fields),
        material: material(fields),
        shear_correction: fields.number("shear_correction").unwrap_or(1.0),
        stiffness: fields.table("stiffness").and_then(stiffness),
        segments: segments(fields.tables("segments"), length),
        linear_density: along(fields, "linear_density", None, &Data::as_number),
        rest_curvature: along(fields, "rest_curvature", None, &vec3)
            .unwrap_or_else(RestCurvature::default),
        extensible: fields.truth("extensible").unwrap_or(true),
        shearable: fields.truth("shearable").unwrap_or(true),
        bending_friction: about_both(fields, "yield_moment").map(|yield_moment| BendingFriction {
            yield_moment,
            yield_stiffness: about_both(fields, "yield_stiffness"),
        }),
        ..Backbone::new(length)
    })
}

/// `[[backbone.segments]]` of a backbone of this length.
fn segments(tables: &[Fields], length: f64) -> Vec<BackboneSegment> {
    let mut segments: Vec<BackboneSegment> = Vec::with_capacity(tables.len());
    for (index, fields) in tables.iter().enumerate() {
        let before = segments.last().map_or(0.0, |segment| segment.range[1]);
        let name =
            fields.text("name").map_or_else(|| default_name("segment", index), str::to_owned);
        let range = [
            fields.number("starts_at").unwrap_or(before),
            fields.number("ends_at").unwrap_or(length),
        ];
        let factor = |key| fields.number(key).unwrap_or(1.0);
        segments.push(BackboneSegment {
            group: fields.text("group").map(str::to_owned),
            bending_factor: factor("bending_factor"),
            torsion_factor: factor("torsion_factor"),
            extension_factor: factor("extension_factor"),
            shear_factor: factor("shear_factor"),
            ..BackboneSegment::new(name, range)
        });
    }
    segments
}

/// One value for both bending axes, or one for each.
fn about_both(fields: &Fields, name: &str) -> Option<[f64; 2]> {
    let data = fields.data(name)?;
    data.as_number().map(|value| [value; 2]).or_else(|| pair(data))
}

/// The material that `[backbone]` names or describes, or both.
pub(crate) fn material(fields: &Fields) -> Material {
    let given = Material {
        name: None,
        young_modulus: fields.number("young_modulus"),
        poisson_ratio: fields.number("poisson_ratio"),
        shear_modulus: fields.number("shear_modulus"),
        density: fields.number("density"),
        yield_strain: fields.number("yield_strain"),
    };
    match fields.text("material").and_then(preset) {
        Some(preset) => preset.beside(given, fields.data("linear_density").is_some()),
        None => given,
    }
}

fn section(fields: &Fields) -> Option<Section> {
    let number = &Data::as_number;
    let outer = fields
        .number("diameter")
        .map(Along::Uniform)
        .or_else(|| along(fields, "diameters", None, number));
    if let Some(outer) = outer {
        let inner = along(fields, "inner_diameter", None, number).unwrap_or_default();
        return Some(Section::Round { outer, inner });
    }
    let bar = fields.table("section")?;
    let places = bar.numbers("at");
    Some(Section::Rectangle {
        width: along(bar, "width", places.as_deref(), number)?,
        height: along(bar, "height", places.as_deref(), number)?,
    })
}

fn stiffness(fields: &Fields) -> Option<Stiffness> {
    let places = fields.numbers("at");
    let places = places.as_deref();
    if let Some(matrix) = along(fields, "matrix", places, &matrix) {
        return Some(Stiffness::Matrix(matrix));
    }
    Some(Stiffness::Diagonal {
        shear: along(fields, "shear", places, &pair),
        axial: along(fields, "axial", places, &Data::as_number),
        bending: along(fields, "bending", places, &pair)?,
        torsion: along(fields, "torsion", places, &Data::as_number)?,
    })
}

/// A key whose value is one item, or a list of them at each disk or at `places`, or a table of both;
/// `item` reads one item and nothing else.
fn along<T>(
    fields: &Fields,
    name: &str,
    places: Option<&[f64]>,
    item: &dyn Fn(&Data) -> Option<T>,
) -> Option<Along<T>> {
    let data = fields.data(name)?;
    if let Some(value) = item(data) {
        return Some(Along::Uniform(value));
    }
    if let Some(table) = fields.table(name) {
        let arc_lengths = table.numbers("at")?;
        let values = table.list("values")?.iter().filter_map(item).collect();
        return Some(Along::At { arc_lengths, values });
    }
    let values = data.as_list()?.iter().filter_map(item).collect();
    Some(match places {
        Some(places) => Along::At { arc_lengths: places.to_vec(), values },
        None => Along::PerDisk(values),
    })
}

fn numbers<const N: usize>(data: &Data) -> Option<[f64; N]> {
    let list: Option<Vec<f64>> = data.as_list()?.iter().map(Data::as_number).collect();
    list?.try_into().ok()
}

fn pair(data: &Data) -> Option<[f64; 2]> {
    numbers(data)
}

fn vec3(data: &Data) -> Option<Vec3> {
    numbers(data).map(|[x, y, z]| Vec3::new(x, y, z))
}

fn matrix(data: &Data) -> Option<StiffnessMatrix> {
    let rows: Option<Vec<[f64; 6]>> = data.as_list()?.iter().map(numbers).collect();
    rows?.try_into().ok()
}
