//! Sections that one cable crosses, on a rod without load: what eq. (9) has there beside the tension, side by side in slots.

use super::section_table::{Row, WIDTH};
use crate::section::one_cable::Reduced;

/// The sections of a grid that one cable crosses and that are equally stiff about x and y.
#[derive(Clone, Debug, Default)]
pub(crate) struct OneCableTable {
    /// Of [`WIDTH`] slots one number after the other, then of the next.
    rows: Vec<[Row; Reduced::NUMBERS]>,
    /// The slot of each node of the grid; sections that are the same share one. None of a node whose section is not one of these.
    slots: Vec<Option<u32>>,
    count: usize,
}

impl OneCableTable {
    /// Memory for the nodes of a grid.
    pub fn with_capacity(nodes: usize) -> Self {
        let rows = Vec::with_capacity(nodes.div_ceil(WIDTH));
        Self { rows, slots: Vec::with_capacity(nodes), count: 0 }
    }

    /// Adds the next node, whose section is not one of these.
    pub fn push_other(&mut self) {
        self.slots.push(None);
    }

    /// Adds the next node, whose section is that of the node before.
    pub fn push_same(&mut self) {
        self.slots.push(self.slots.last().copied().flatten());
    }

    /// Adds the next node.
    pub fn push(&mut self, section: &Reduced) {
        let numbers = section.numbers();
        let slot = self.count % WIDTH;
        match self.rows.last_mut().filter(|_| slot > 0) {
            Some(rows) => {
                for (row, number) in rows.iter_mut().zip(numbers) {
                    row[slot] = number;
                }
            }
            // The slots behind hold the same, so that nothing is computed of zeros.
            None => self.rows.push(numbers.map(|number| [number; WIDTH])),
        }
        // A grid has fewer nodes than 2³².
        self.slots.push(Some(self.count as u32));
        self.count += 1;
    }

    /// How many slots hold a section.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The slot of a node, where its section is one of these.
    #[inline(always)]
    pub fn slot(&self, node: usize) -> Option<usize> {
        self.slots.get(node).copied().flatten().map(|slot| slot as usize)
    }

    /// What eq. (9) has at a node, where its section is one of these.
    pub fn at(&self, node: usize) -> Option<Reduced> {
        Some(self.in_slot(self.slot(node)?))
    }

    /// The same in a slot below [`Self::count`].
    pub fn in_slot(&self, slot: usize) -> Reduced {
        Reduced::of_numbers(self.rows[slot / WIDTH].map(|row| row[slot % WIDTH]))
    }

    /// The numbers of the slots beside this one, [`WIDTH`] of each.
    #[inline(always)]
    pub fn rows(&self, slot: usize) -> &[Row; Reduced::NUMBERS] {
        &self.rows[slot / WIDTH]
    }
}
