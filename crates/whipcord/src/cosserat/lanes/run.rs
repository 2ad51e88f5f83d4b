//! The sections of one robot beside one another, see [`crate::statics::section_runs`].

use pulp::Simd;
use whipcord_numerics::Vec3;
use whipcord_numerics::lanes::{LaneSym3, LaneTwist, LaneVec3, Lanes};

use super::section::{InLanes, LaneBare, LaneCrossing, equilibrium, reduced};
use crate::section::{BodyWrench, SectionFault, Strain, equilibrium as of_section};
use crate::statics::grid::Nodes;
use crate::statics::section_runs::{SectionRun, SectionTable, WIDTH, Wave, WaveStart};

/// What is known of all sections of a rod.
pub(crate) struct Known<'a> {
    /// Of each node.
    pub strains: &'a mut [Strain],
    /// `‖pᵢ′‖` at each node, of its first cables.
    pub stretches: &'a mut [f64],
    /// Cables of a row of these.
    pub cables: usize,
}

/// The sections from a slot of a run on, under these tensions.
struct Slots<'a> {
    table: &'a SectionTable,
    slot: usize,
    tensions: &'a [f64],
}

impl Slots<'_> {
    #[inline(always)]
    fn vector<S: Simd>(&self, simd: S, row: usize) -> LaneVec3<S> {
        let load = |i: usize| Lanes::load(simd, self.table.row(row + i, self.slot));
        LaneVec3::new(load(0), load(1), load(2))
    }
}

impl<S: Simd> InLanes<S> for Slots<'_> {
    #[inline(always)]
    fn cables(&self) -> usize {
        self.table.cables
    }

    #[inline(always)]
    fn bare(&self, simd: S) -> LaneBare<S> {
        LaneBare {
            shear: self.vector(simd, 0),
            bending: self.vector(simd, 3),
            pivots: self.vector(simd, 6),
            rest_curvature: self.vector(simd, 9),
            reach: Lanes::load(simd, self.table.row(12, self.slot)),
        }
    }

    #[inline(always)]
    fn crossing(&self, simd: S, cable: usize) -> (LaneCrossing<S>, Lanes<S>) {
        let load = |row: usize| Lanes::load(simd, self.table.row_of_cable(cable, row, self.slot));
        let slope = LaneVec3::new(load(2), load(3), load(4));
        let crossing = LaneCrossing { offset: [load(0), load(1)], slope };
        (crossing, Lanes::splat(simd, self.tensions[cable]))
    }
}

/// Solves the sections of a run, from their strains as they are where those are `warm`.
///
/// # Errors
/// The first node, along the rod, that has no answer.
#[inline(always)]
pub(crate) fn solve_run<S: Simd>(
    simd: S,
    run: &SectionRun,
    nodes: &Nodes,
    tensions: &[f64],
    warm: bool,
    known: &mut Known<'_>,
) -> Result<(), (usize, SectionFault)> {
    let cables = run.sections.cables;
    let mut fault: Option<(usize, SectionFault)> = None;
    for Wave { slots, nodes: of_wave, starts } in &run.waves {
        let lanes = Lanes::<S>::COUNT;
        let groups = of_wave.chunks(lanes).zip(starts.chunks(lanes));
        for (number, (group, starts)) in groups.enumerate() {
            let slot = slots.start + number * lanes;
            let of = Slots { table: &run.sections, slot, tensions };
            let mut columns = [[0.0; WIDTH]; 6];
            let mut strain = Strain::default();
            for lane in 0..lanes.min(WIDTH) {
                // Lanes without a node repeat the last one.
                if let (Some(&node), Some(start)) = (group.get(lane), starts.get(lane)) {
                    strain = match (warm, start) {
                        (true, _) => known.strains[node],
                        (false, WaveStart::Rest) => nodes.node(node).section.rest_strain(),
                        (false, WaveStart::Between { nodes: [a, b, c, d], weights }) => {
                            let (of, [wb, wc, wd]) = (&*known.strains, *weights);
                            let a = of[*a];
                            a + (of[*b] - a) * wb + (of[*c] - a) * wc + (of[*d] - a) * wd
                        }
                    };
                }
                let [x, y, z] = strain.linear.to_array();
                let [p, q, r] = strain.angular.to_array();
                for (column, number) in columns.iter_mut().zip([x, y, z, p, q, r]) {
                    column[lane] = number;
                }
            }
            let load = |i: usize| Lanes::load(simd, &columns[i]);
            let start = LaneTwist {
                linear: LaneVec3::new(load(0), load(1), load(2)),
                angular: LaneVec3::new(load(3), load(4), load(5)),
            };
            let (found, met) = equilibrium(&of, simd, start);
            let met = met.select(Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.0));
            for (lane, &node) in group.iter().enumerate() {
                known.strains[node] = strain_of(&found, lane);
            }
            for cable in 0..cables {
                let stretch = of.crossing(simd, cable).0.stretch(&found);
                for (stretch, &node) in stretch.as_slice().iter().zip(group) {
                    known.stretches[node * known.cables + cable] = *stretch;
                }
            }
            for (lane, &node) in group.iter().enumerate() {
                if met.as_slice()[lane] > 0.0 {
                    continue;
                }
                let (section, crossings) = nodes.crossed(node, cables);
                let mut strain = strain_of(&start, lane);
                let wrench = BodyWrench::default();
                match of_section(section, crossings, tensions, wrench, &mut strain) {
                    Ok(()) => {
                        for (cable, crossing) in crossings.iter().enumerate() {
                            let stretch = crossing.tangent(&strain).norm();
                            known.stretches[node * known.cables + cable] = stretch;
                        }
                    }
                    Err(kind) => {
                        strain = section.rest_strain();
                        if fault.as_ref().is_none_or(|(first, _)| node < *first) {
                            fault = Some((node, kind));
                        }
                    }
                }
                known.strains[node] = strain;
            }
        }
    }
    fault.map_or(Ok(()), Err)
}

/// The least `δuᵀ S δu / δuᵀ K_bt δu` in the middles of the steps of a run, less 1, as [`super::stability`] has it; infinite where it has none, and a NaN where a
/// section has no factors.
#[inline(always)]
pub(crate) fn stability_of_run<S: Simd>(
    simd: S,
    run: &SectionRun,
    tensions: &[f64],
    strains: &[Strain],
) -> f64 {
    let mut least = f64::INFINITY;
    let lanes = Lanes::<S>::COUNT;
    for (number, group) in run.middles.chunks(lanes).enumerate() {
        let of = Slots { table: &run.of_middles, slot: number * lanes, tensions };
        let mut columns = [[0.0; WIDTH]; 6];
        for lane in 0..lanes.min(WIDTH) {
            let Strain { linear, angular } = strains[group[lane.min(group.len() - 1)]];
            let numbers = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z];
            for (column, number) in columns.iter_mut().zip(numbers) {
                column[lane] = number;
            }
        }
        let load = |i: usize| Lanes::load(simd, &columns[i]);
        let strain = LaneTwist {
            linear: LaneVec3::new(load(0), load(1), load(2)),
            angular: LaneVec3::new(load(3), load(4), load(5)),
        };
        let (reduced, definite) = reduced(&of, simd, &strain);
        let bending = of.bare(simd).bending;
        let zero = Lanes::splat(simd, 0.0);
        let metric =
            LaneSym3 { xx: bending.x, yx: zero, yy: bending.y, zx: zero, zy: zero, zz: bending.z };
        let added = LaneSym3 {
            xx: reduced.xx - bending.x,
            yy: reduced.yy - bending.y,
            zz: reduced.zz - bending.z,
            ..reduced
        };
        let value = added.least_relative(&metric, simd);
        let value = definite.select(value, Lanes::splat(simd, f64::NAN));
        for &value in &value.as_slice()[..group.len()] {
            if value.is_nan() {
                return value;
            }
            least = least.min(value);
        }
    }
    least
}

#[inline(always)]
fn strain_of<S: Simd>(LaneTwist { linear, angular }: &LaneTwist<S>, lane: usize) -> Strain {
    let at = |v: &LaneVec3<S>| {
        Vec3::new(v.x.as_slice()[lane], v.y.as_slice()[lane], v.z.as_slice()[lane])
    };
    Strain { linear: at(linear), angular: at(angular) }
}
