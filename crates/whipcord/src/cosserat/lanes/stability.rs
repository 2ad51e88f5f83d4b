//! [`super::super::unloaded::Unloaded::stability`] in lanes.

use pulp::Simd;
use whipcord_numerics::Mat3;
use whipcord_numerics::lanes::{LaneMask, LaneSym3, LaneTwist, Lanes};

use super::grid::{LaneGrid, LaneSection};

/// In which lanes more than one cable pulls at every step; elsewhere the stability is 1.
#[inline(always)]
pub(super) fn several<S: Simd>(simd: S, grid: &LaneGrid, tensions: &[Lanes<S>]) -> LaneMask<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let mut several = zero.at_most(one);
    for &active in &grid.active {
        let taut = tensions[..active]
            .iter()
            .fold(zero, |taut, &tension| taut + zero.below(tension).select(one, zero));
        several = several.and(one.below(taut));
    }
    several
}

/// The stability of all lanes on one grid; a NaN where there is none.
#[inline(always)]
pub(super) fn stability<S: Simd>(
    simd: S,
    grid: &LaneGrid,
    tensions: &[Lanes<S>],
    strains: &[LaneTwist<S>],
) -> Lanes<S> {
    let one = Lanes::splat(simd, 1.0);
    let several = several(simd, grid, tensions);
    if !several.any() {
        return one;
    }
    let mut least = Lanes::splat(simd, f64::INFINITY);
    let mut repeats = false;
    for (nodes, strains) in grid.nodes.chunks_exact(3).zip(strains.chunks_exact(3)) {
        // The middle of a step where nothing differs from that of the step before.
        let known = repeats && nodes[0].repeats && nodes[1].repeats;
        repeats = nodes[2].repeats;
        if known {
            continue;
        }
        // A step with a section of one cable has none with several taut ones.
        let LaneSection::Several(at) = &nodes[1].section else { return one };
        let (reduced, definite) = at.reduced(simd, &tensions[..at.cables()], &strains[1]);
        let bending = at.bending();
        let added = LaneSym3 {
            xx: reduced.xx - Lanes::splat(simd, bending.x),
            yy: reduced.yy - Lanes::splat(simd, bending.y),
            zz: reduced.zz - Lanes::splat(simd, bending.z),
            ..reduced
        };
        let metric = LaneSym3::splat(simd, &Mat3::diagonal(bending));
        let value = added.least_relative(&metric, simd);
        least = definite
            .select(value.at_most(least).select(value, least), Lanes::splat(simd, f64::NAN));
    }
    several.select(least + 1.0, one)
}
