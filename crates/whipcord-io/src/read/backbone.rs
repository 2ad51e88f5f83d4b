use whipcord::{Backbone, Material, RestCurvature, Section, Vec3};

use crate::check::{Data, Fields};

/// `[backbone]`; `None` when the length is missing.
pub(crate) fn backbone(fields: &Fields) -> Option<Backbone> {
    Some(Backbone {
        length: fields.number("length")?,
        section: section(fields),
        material: Material {
            young_modulus: fields.number("young_modulus"),
            poisson_ratio: fields.number("poisson_ratio"),
            shear_modulus: fields.number("shear_modulus"),
            density: fields.number("density"),
        },
        rest_curvature: rest_curvature(fields),
    })
}

fn section(fields: &Fields) -> Option<Section> {
    let inner = fields.number("inner_diameter");
    if let Some(diameter) = fields.number("diameter") {
        return Some(match inner {
            None => Section::Circle { diameter },
            Some(inner) => Section::Tube { outer: diameter, inner },
        });
    }
    if let Some(outer) = fields.numbers("diameters") {
        return Some(Section::Taper { outer, inner: inner.unwrap_or(0.0) });
    }
    let bar = fields.table("section")?;
    Some(Section::Rectangle { width: bar.number("width")?, height: bar.number("height")? })
}

fn rest_curvature(fields: &Fields) -> RestCurvature {
    let vector = |list: &[Data]| match list {
        [x, y, z] => Some(Vec3::new(x.as_number()?, y.as_number()?, z.as_number()?)),
        _ => None,
    };
    let Some(list) = fields.list("rest_curvature") else {
        return RestCurvature::default();
    };
    match vector(list) {
        Some(uniform) => RestCurvature::Uniform(uniform),
        None => {
            RestCurvature::PerDisk(list.iter().filter_map(|item| vector(item.as_list()?)).collect())
        }
    }
}
