use whipcord::{Cable, CableCommand, HoleOffset, Interpolation, Routing, Shortening};

use crate::check::{Data, Fields};
use crate::overlay::default_name;
use crate::units::Dimension;

/// Entry number `index`, from 0, of `[[cables]]`; `None` when its routing is missing.
pub(crate) fn cable(fields: &Fields, index: usize) -> Option<Cable> {
    Some(Cable {
        name: fields.text("name").map_or_else(|| default_name("cable", index), str::to_owned),
        group: fields.text("group").map(str::to_owned),
        routing: routing(fields)?,
        hole_offset: HoleOffset {
            angle: fields.number("hole_angle_offset").unwrap_or(0.0),
            radius: fields.number("hole_radius_offset").unwrap_or(0.0),
        },
        ends_at: fields.number("ends_at"),
        friction: fields.number("friction"),
        axial_stiffness: fields.number("axial_stiffness"),
    })
}

/// How the same entry is pulled.
pub(crate) fn command(fields: &Fields) -> CableCommand {
    CableCommand {
        tension: fields.number("tension"),
        shortening: fields.quantity("shortening").map(shortening),
    }
}

/// How an entry of `[[steps]]` pulls each of so many cables.
pub(crate) fn step(fields: &Fields, cables: usize) -> Vec<CableCommand> {
    let entry =
        |name: &str, i: usize| fields.list(name).and_then(|list| list.get(i)?.as_quantity());
    let command = |i| CableCommand {
        tension: entry("tension", i).map(|(tension, _)| tension),
        shortening: entry("shortening", i).map(shortening),
    };
    (0..cables).map(command).collect()
}

fn shortening((value, dimension): (f64, Dimension)) -> Shortening {
    match dimension {
        Dimension::Ratio => Shortening::Fraction(value),
        _ => Shortening::Length(value),
    }
}

fn routing(fields: &Fields) -> Option<Routing> {
    if let Some(holes) = fields.list("holes") {
        let interpolation = match fields.text("interpolation") {
            Some("pchip") => Interpolation::Pchip,
            Some("fourier") => Interpolation::Fourier,
            _ => Interpolation::Spline,
        };
        return Some(Routing::Holes {
            holes: holes.iter().filter_map(Data::as_count).collect(),
            interpolation,
        });
    }
    let curve = fields.table("routing")?;
    Some(match curve.variant {
        "straight" => {
            Routing::Straight { angle: curve.number("angle")?, radius: curve.number("radius")? }
        }
        "helix" => Routing::Helix {
            start_angle: curve.number("start_angle").unwrap_or(0.0),
            turns: curve.number("turns")?,
            radius: curve.number("radius")?,
        },
        "linear" => Routing::Linear { start: curve.vector("start")?, end: curve.vector("end")? },
        "polynomial" => Routing::Polynomial { x: curve.numbers("x")?, y: curve.numbers("y")? },
        _ => return None,
    })
}
