//! The sections of all steps of a grid at their shooting nodes, step beside step.

use super::lanes::slots::Slots;
use super::section_table::{Place, SectionTable, WIDTH};

/// Sections of the steps of a grid, whose stiffness is diagonal everywhere.
#[derive(Clone, Debug)]
pub(crate) struct StepTable {
    sections: SectionTable,
    /// Nodes of a step.
    per_step: usize,
    /// Whether one cable at most crosses each section, and all are equally stiff about x and y.
    pub is_crossed_once: bool,
}

impl StepTable {
    /// Of the nodes of all steps in turn, so many to a step; `None` where a section's stiffness is not diagonal.
    pub fn new(places: &[Place<'_>], per_step: usize) -> Option<Self> {
        if places.iter().any(|place| place.section.beside.is_some()) {
            return None;
        }
        let is_isotropic = places.iter().all(|place| place.section.isotropic);
        let cables = places.iter().map(|place| place.crossings.len()).max()?;
        let steps = places.len() / per_step;
        let mut in_slots = Vec::with_capacity(places.len().next_multiple_of(WIDTH));
        for first in (0..steps).step_by(WIDTH) {
            for j in 0..per_step {
                // Slots behind the last step hold that one, so that nothing is computed of zeros.
                let steps = (first..first + WIDTH).map(|k| k.min(steps - 1));
                in_slots.extend(steps.map(|k| per_step * k + j));
            }
        }
        let sections = SectionTable::of(&in_slots, places, cables);
        Some(Self { sections, per_step, is_crossed_once: is_isotropic && cables <= 1 })
    }

    /// How many cables cross a section at most.
    pub fn cables(&self) -> usize {
        self.sections.cables
    }

    /// The sections at node `j` of the steps from `k` on.
    #[inline(always)]
    pub fn slots(&self, k: usize, j: usize) -> Option<Slots<'_>> {
        let slot = (k / WIDTH * self.per_step + j) * WIDTH + k % WIDTH;
        Slots::from(&self.sections, slot, &[])
    }
}
