use whipcord::Disks;

use crate::check::Fields;

/// `[disks]` of a backbone of this length, none where the table is left out; `None` when neither number nor positions are given.
pub(crate) fn disks(fields: Option<&Fields>, length: f64) -> Option<Disks> {
    let Some(fields) = fields else { return Some(Disks::none(length)) };
    let arc_lengths = match fields.numbers("positions") {
        Some(positions) => positions,
        None => Disks::equally_spaced(length, fields.count("count")?, 0.0).arc_lengths,
    };
    let hole_circle_radii = match fields.number("hole_circle_radius") {
        Some(radius) => vec![radius; arc_lengths.len()],
        None => fields.numbers("hole_circle_radius").unwrap_or_default(),
    };
    Some(Disks {
        arc_lengths,
        are_present: true,
        hole_circle_radii,
        holes: fields.count("holes"),
        mass: fields.number("mass").unwrap_or(0.0),
        outer_radius: fields.number("outer_radius"),
        thickness: fields.number("thickness"),
    })
}
