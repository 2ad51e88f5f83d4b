//! Numbers of sections side by side, as vectors load them.

use crate::section::{Crossing, Section, Stiffness, reach};

/// A section that others are solved beside: how the cables through its step cross it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<'a> {
    pub section: &'a Section,
    pub crossings: &'a [Crossing],
    pub arc_length: f64,
}

/// What is known of sections in slots: those of [`WIDTH`] slots one number after the other.
#[derive(Clone, Debug)]
pub(crate) struct SectionTable {
    rows: Vec<Row>,
    /// How many cables cross each section at most.
    pub cables: usize,
}

/// One number of the sections in neighbouring slots.
pub(crate) type Row = [f64; WIDTH];

/// Rows of [`WIDTH`] neighbouring slots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<'a> {
    /// Shear x, y, z, bending x, y, z, pivots x, y, z, rest curvature x, y, z, the compliances of shear and bending likewise, reach.
    pub section: &'a [Row; OF_SECTION],
    /// Of each cable offset x, y, slope x, y, z, at rest the unit tangent x, y, z and `1/‖p′‖`, and the unit vector along the offset x, y.
    pub cables: &'a [[Row; OF_CABLE]],
}

/// Of the widest vectors.
pub(crate) const WIDTH: usize = 8;
/// Rows of a section, and of each cable beside these.
const OF_SECTION: usize = 19;
const OF_CABLE: usize = 11;

impl SectionTable {
    /// Of the places in the slots, whose number is a multiple of [`WIDTH`], with rows for so many cables: those that do not cross a
    /// section run along its axis.
    pub fn of(in_slots: &[usize], places: &[Place<'_>], cables: usize) -> Self {
        let of_group = OF_SECTION + OF_CABLE * cables;
        let mut rows = vec![[0.0; WIDTH]; in_slots.len() / WIDTH * of_group];
        for (group, of) in in_slots.chunks(WIDTH).zip(rows.chunks_mut(of_group)) {
            let (section, crossing) = of.split_at_mut(OF_SECTION);
            for (slot, &at) in group.iter().enumerate() {
                let place = &places[at];
                put(section, slot, &of_section(place));
                for (cable, rows) in crossing.chunks_exact_mut(OF_CABLE).enumerate() {
                    let crossing = place.crossings.get(cable).copied().unwrap_or_default();
                    put(rows, slot, &of_cable(&crossing, place.section));
                }
            }
        }
        Self { rows, cables }
    }

    /// Of the slots beside this one, which are a multiple of [`WIDTH`] and those behind it; none behind the last.
    #[inline(always)]
    pub fn rows(&self, slot: usize) -> Option<Rows<'_>> {
        let of_group = OF_SECTION + OF_CABLE * self.cables;
        let rows = self.rows.get(slot / WIDTH * of_group..)?.get(..of_group)?;
        let (section, cables) = rows.split_first_chunk()?;
        Some(Rows { section, cables: cables.as_chunks().0 })
    }
}

#[inline(always)]
fn put(rows: &mut [Row], slot: usize, numbers: &[f64]) {
    for (row, number) in rows.iter_mut().zip(numbers) {
        row[slot] = *number;
    }
}

#[inline(always)]
fn of_section(Place { section, crossings, .. }: &Place<'_>) -> [f64; OF_SECTION] {
    let Stiffness { shear, bending } = section.stiffness;
    let Stiffness { shear: soft_shear, bending: soft_bending } = section.compliance;
    let (pivots, rest) = (section.pivots(), section.rest_curvature);
    [
        shear.x,
        shear.y,
        shear.z,
        bending.x,
        bending.y,
        bending.z,
        pivots.x,
        pivots.y,
        pivots.z,
        rest.x,
        rest.y,
        rest.z,
        soft_shear.x,
        soft_shear.y,
        soft_shear.z,
        soft_bending.x,
        soft_bending.y,
        soft_bending.z,
        reach(crossings),
    ]
}

#[inline(always)]
fn of_cable(crossing: &Crossing, section: &Section) -> [f64; OF_CABLE] {
    let Crossing { offset, slope, radial } = *crossing;
    let (unit, per_stretch) = crossing.direction(&section.rest_strain());
    [
        offset.x,
        offset.y,
        slope.x,
        slope.y,
        slope.z,
        unit.x,
        unit.y,
        unit.z,
        per_stretch,
        radial.x,
        radial.y,
    ]
}
