//! The sections of one robot beside one another, see [`crate::statics::section_runs`].

use pulp::Simd;
use whipcord_numerics::lanes::{LaneSym3, LaneVec3, Lanes};
use whipcord_numerics::{Mat3, Vec3};

use super::columns::{of_columns, strain_of, strains_at};
use super::equilibrium::equilibrium_within;
use super::section::{InLanes, LanePull, linearize, reduced, response_at_rest};
use super::slots::Slots;
use crate::section::{BodyWrench, SectionFault, Strain, equilibrium as of_section};
use crate::statics::grid::Nodes;
use crate::statics::section_runs::{SectionRun, Wave, WaveStart};
use crate::statics::section_table::WIDTH;
use crate::statics::turned_sections::TurnedSection;

/// What is known of all sections of a rod.
pub(crate) struct Known<'a> {
    /// Of each node.
    pub strains: &'a mut [Strain],
    /// Of each node from its response to the tensions.
    pub departures: &'a mut [Strain],
    /// `‖pᵢ′‖` at each node, of its first cables.
    pub stretches: &'a mut [f64],
    /// Cables of a row of these.
    pub cables: usize,
}

/// Solves the sections of a run to a last step of `tolerance`, as a strain, from their strains as they are where those are `warm`.
///
/// # Errors
/// The first node, along the rod, that has no answer.
#[inline(always)]
pub(crate) fn solve_run<S: Simd>(
    simd: S,
    run: &SectionRun,
    nodes: &Nodes,
    tensions: &[f64],
    (tolerance, warm): (f64, bool),
    known: &mut Known<'_>,
) -> Result<(), (usize, SectionFault)> {
    let cables = run.sections.cables;
    let mut fault: Option<(usize, SectionFault)> = None;
    for Wave { slots, nodes: of_wave, starts } in &run.waves {
        let lanes = Lanes::<S>::COUNT;
        let groups = of_wave.chunks(lanes).zip(starts.chunks(lanes));
        for (number, (group, starts)) in groups.enumerate() {
            let slot = slots.start + number * lanes;
            let Some(of) = Slots::from(&run.sections, slot, tensions) else { break };
            let response = match warm {
                true => of_columns(simd, &[[0.0; WIDTH]; 6], 0),
                false => response_at_rest(&of, simd),
            };
            let mut columns = [[0.0; WIDTH]; 6];
            let mut from = Strain::default();
            for lane in 0..lanes.min(WIDTH) {
                // Lanes without a node repeat the last one.
                if let (Some(&node), Some(start)) = (group.get(lane), starts.get(lane)) {
                    from = match (warm, start) {
                        (true, _) => known.strains[node],
                        (false, WaveStart::Response) => Strain::default(),
                        (false, WaveStart::Between { nodes: [a, b, c, d], weights }) => {
                            let (of, [wb, wc, wd]) = (&*known.departures, *weights);
                            let a = of[*a];
                            a + ((of[*b] - a) * wb + (of[*c] - a) * wc + (of[*d] - a) * wd)
                        }
                    };
                }
                let [x, y, z] = from.linear.to_array();
                let [p, q, r] = from.angular.to_array();
                for (column, number) in columns.iter_mut().zip([x, y, z, p, q, r]) {
                    column[lane] = number;
                }
            }
            let start = response + of_columns(simd, &columns, 0);
            let (found, met) = equilibrium_within(tolerance, &of, simd, start);
            let met = met.select(Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.0));
            let departure = found - response;
            for (lane, &node) in group.iter().enumerate() {
                known.strains[node] = strain_of(&found, lane);
                known.departures[node] = strain_of(&departure, lane);
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
                known.departures[node] = strain - strain_of(&response, lane);
                known.strains[node] = strain;
            }
        }
    }
    for TurnedSection { node, of, turn } in &run.turned {
        known.strains[*node] = turn.strain(known.strains[*of]);
        let from = of * known.cables;
        known.stretches.copy_within(from..from + cables, node * known.cables);
    }
    fault.map_or(Ok(()), Err)
}

/// The compliance `H⁻¹` of each section of a run in blocks, which `take` is given with its node, and at `pulls[node * cables + cable]` what a unit tension of each cable
/// exerts there, with its stretch.
///
/// # Errors
/// The first node, along the rod, whose Hessian is not positive definite.
#[inline(always)]
pub(crate) fn linearize_run<S: Simd>(
    simd: S,
    run: &SectionRun,
    tensions: &[f64],
    strains: &[Strain],
    (pulls, cables): (&mut [(BodyWrench, f64)], usize),
    mut take: impl FnMut(usize, [Mat3; 3]),
) -> Result<(), (usize, SectionFault)> {
    let lanes = Lanes::<S>::COUNT;
    let mut first: Option<usize> = None;
    for (number, group) in run.in_slots.chunks(lanes).enumerate() {
        let Some(of) = Slots::from(&run.sections, number * lanes, tensions) else { break };
        let strain = strains_at(simd, strains, group);
        let tangent = linearize(&of, simd, &strain, |cable, pull| {
            let LanePull { linear, angular, stretch } = pull;
            for (lane, &node) in group.iter().enumerate() {
                let exerted = BodyWrench { linear: linear.of(lane), angular: angular.of(lane) };
                pulls[node * cables + cable] = (exerted, stretch.as_slice()[lane]);
            }
        });
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let definite = tangent.is_definite().select(one, zero);
        let [stretch, mixed, turn] = tangent.compliance(simd);
        for (lane, &node) in group.iter().enumerate() {
            if definite.as_slice()[lane] == 0.0 {
                first = Some(first.map_or(node, |first| first.min(node)));
                continue;
            }
            let of = [matrix_of(&stretch, lane), matrix_of(&mixed, lane), matrix_of(&turn, lane)];
            take(node, of);
        }
    }
    first.map_or(Ok(()), |node| Err((node, SectionFault::Diverged)))
}

#[inline(always)]
fn matrix_of<S: Simd>([a, b, c]: &[LaneVec3<S>; 3], lane: usize) -> Mat3 {
    let (a, b, c) = (a.of(lane), b.of(lane), c.of(lane));
    Mat3::from_rows(Vec3::new(a.x, b.x, c.x), Vec3::new(a.y, b.y, c.y), Vec3::new(a.z, b.z, c.z))
}

/// The least `δuᵀ S δu / δuᵀ K_bt δu` in the middles of the steps of a run, less 1, as [`crate::cosserat`] has it; infinite where it has none, and a NaN where a
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
        let Some(of) = Slots::from(&run.of_middles, number * lanes, tensions) else { break };
        let strain = strains_at(simd, strains, group);
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
