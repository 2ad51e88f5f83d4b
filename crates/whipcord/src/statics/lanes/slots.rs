//! The sections of a [`SectionTable`] in lanes.

use pulp::Simd;
use whipcord_numerics::lanes::{LaneVec3, Lanes};

use super::one_cable::LaneCrossed;
use super::section::{InLanes, LaneBare, LaneCrossing, no_wrench};
use crate::statics::section_table::{Row, Rows, SectionTable, WIDTH};

/// The sections in as many slots as there are lanes, under these tensions.
pub(crate) struct Slots<'a> {
    rows: Rows<'a>,
    /// Slot of the first lane in the rows.
    first: usize,
    tensions: &'a [f64],
}

impl<'a> Slots<'a> {
    /// From a slot of a table on; `None` behind the last.
    #[inline(always)]
    pub fn from(table: &'a SectionTable, slot: usize, tensions: &'a [f64]) -> Option<Self> {
        Some(Self { rows: table.rows(slot)?, first: slot % WIDTH, tensions })
    }

    /// Sections that one cable crosses at most.
    #[inline(always)]
    pub fn crossed<S: Simd>(&self, simd: S) -> LaneCrossed<S> {
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        let [shear, bending] = self.compliances(simd);
        let rest_curvature = self.vector(simd, 9);
        let Some(of) = self.rows.cables.first() else {
            let radial = [zero, zero];
            return LaneCrossed {
                shear,
                bending,
                rest_curvature,
                offset: null,
                slope: null,
                radial,
            };
        };
        let load = |row: usize| Lanes::load(simd, &of[row], self.first);
        LaneCrossed {
            shear,
            bending,
            rest_curvature,
            offset: LaneVec3::new(load(0), load(1), zero),
            slope: LaneVec3::new(load(2), load(3), load(4)),
            radial: [load(9), load(10)],
        }
    }

    #[inline(always)]
    fn crossing_of<S: Simd>(&self, simd: S, cable: usize) -> LaneCrossing<S> {
        let of = &self.rows.cables[cable];
        let load = |row: usize| Lanes::load(simd, &of[row], self.first);
        let slope = LaneVec3::new(load(2), load(3), load(4));
        LaneCrossing { offset: [load(0), load(1)], slope }
    }

    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, row: usize) -> LaneVec3<S> {
        let load = |i: usize| Lanes::load(simd, &self.rows.section[row + i], self.first);
        LaneVec3::new(load(0), load(1), load(2))
    }
}

impl<S: Simd> InLanes<S> for Slots<'_> {
    #[inline(always)]
    fn cables(&self) -> usize {
        self.rows.cables.len()
    }

    #[inline(always)]
    fn is_slack(&self, cable: usize) -> bool {
        self.tensions[cable] == 0.0
    }

    #[inline(always)]
    fn bare(&self, simd: S) -> LaneBare<S> {
        LaneBare {
            shear: self.vector(simd, 0),
            bending: self.vector(simd, 3),
            pivots: self.vector(simd, 6),
            rest_curvature: self.vector(simd, 9),
            reach: Lanes::load(simd, &self.rows.section[18], self.first),
            wrench: no_wrench(simd),
        }
    }

    #[inline(always)]
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>) {
        (self.crossing_of(simd, cable), Lanes::splat(simd, self.tensions[cable]))
    }

    #[inline(always)]
    fn compliances(&self, simd: S) -> [LaneVec3<S>; 2] {
        [self.vector(simd, 12), self.vector(simd, 15)]
    }

    #[inline(always)]
    fn direction_at_rest(&self, simd: S, cable: usize) -> (LaneVec3<S>, Lanes<S>) {
        let of = &self.rows.cables[cable];
        let load = |row: usize| Lanes::load(simd, &of[row], self.first);
        (LaneVec3::new(load(5), load(6), load(7)), load(8))
    }
}

/// The same sections under a wrench and tensions of their own.
pub(crate) struct LoadedSlots<'a, S: Simd> {
    pub slots: Slots<'a>,
    /// Of each cable in the slots of the rows; zero where it does not cross.
    pub tensions: &'a [Row],
    /// Force and moment in the body frame.
    pub wrench: [LaneVec3<S>; 2],
}

impl<S: Simd> InLanes<S> for LoadedSlots<'_, S> {
    #[inline(always)]
    fn cables(&self) -> usize {
        self.tensions.len()
    }

    #[inline(always)]
    fn is_slack(&self, _: usize) -> bool {
        false
    }

    #[inline(always)]
    fn bare(&self, simd: S) -> LaneBare<S> {
        LaneBare { wrench: self.wrench, ..self.slots.bare(simd) }
    }

    #[inline(always)]
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>) {
        let tension = Lanes::load(simd, &self.tensions[cable], self.slots.first);
        (self.slots.crossing_of(simd, cable), tension)
    }

    #[inline(always)]
    fn compliances(&self, simd: S) -> [LaneVec3<S>; 2] {
        self.slots.compliances(simd)
    }

    #[inline(always)]
    fn direction_at_rest(&self, simd: S, cable: usize) -> (LaneVec3<S>, Lanes<S>) {
        self.slots.direction_at_rest(simd, cable)
    }
}
