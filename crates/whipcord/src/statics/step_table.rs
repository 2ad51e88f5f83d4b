//! The sections of all steps of a grid at their shooting nodes, step beside step.

use super::grid::{Grid, SHOOTING_NODES};
use super::lanes::slots::Slots;
use super::section_table::{Place, SectionTable, WIDTH};

/// Sections of the steps of a grid, whose stiffness is diagonal everywhere.
#[derive(Clone, Debug)]
pub(crate) struct StepTable {
    sections: SectionTable,
    /// Whether one cable at most crosses each section, and all are equally stiff about x and y.
    pub is_crossed_once: bool,
}

impl StepTable {
    /// `None` where a section's stiffness is not diagonal.
    pub fn new(grid: &Grid) -> Option<Self> {
        let mut places = Vec::with_capacity(SHOOTING_NODES.len() * grid.len());
        let (mut cables, mut is_isotropic) = (0, true);
        for (k, step) in grid.steps.iter().enumerate() {
            cables = cables.max(step.active);
            for (j, at) in SHOOTING_NODES.iter().enumerate() {
                let (node, crossings) = grid.shooting.at(k, j, step.active);
                let section = &node.section;
                if section.beside.is_some() {
                    return None;
                }
                is_isotropic &= section.isotropic;
                places.push(Place {
                    section,
                    crossings,
                    arc_length: step.start + at * step.length,
                });
            }
        }
        let last = grid.len().checked_sub(1)?;
        let mut in_slots = Vec::with_capacity(places.len().next_multiple_of(WIDTH));
        for first in (0..grid.len()).step_by(WIDTH) {
            for j in 0..SHOOTING_NODES.len() {
                // Slots behind the last step hold that one, so that nothing is computed of zeros.
                let steps = (first..first + WIDTH).map(|k| k.min(last));
                in_slots.extend(steps.map(|k| SHOOTING_NODES.len() * k + j));
            }
        }
        let sections = SectionTable::of(&in_slots, &places, cables);
        Some(Self { sections, is_crossed_once: is_isotropic && cables <= 1 })
    }

    /// How many cables cross a section at most.
    pub fn cables(&self) -> usize {
        self.sections.cables
    }

    /// The sections at node `j` of the steps from `k` on.
    #[inline(always)]
    pub fn slots(&self, k: usize, j: usize) -> Option<Slots<'_>> {
        let slot = (k / WIDTH * SHOOTING_NODES.len() + j) * WIDTH + k % WIDTH;
        Slots::from(&self.sections, slot, &[])
    }
}
