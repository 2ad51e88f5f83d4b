//! Numbers of several sections, one in each lane.

use pulp::Simd;
use whipcord_numerics::lanes::{LaneTwist, LaneVec3, Lanes};

use crate::section::Strain;
use crate::statics::section_table::WIDTH;

/// The strains at nodes, one in each lane; lanes without a node repeat the last one.
#[inline(always)]
pub(crate) fn strains_at<S: Simd>(simd: S, strains: &[Strain], nodes: &[usize]) -> LaneTwist<S> {
    let mut columns = [[0.0; WIDTH]; 6];
    for lane in 0..Lanes::<S>::COUNT.min(WIDTH) {
        put(&mut columns, lane, &strains[nodes[lane.min(nodes.len() - 1)]]);
    }
    of_columns(simd, &columns, 0)
}

/// The strains at one of three places of steps that follow one another; lanes without a step repeat the last one.
#[inline(always)]
pub(crate) fn strains_of_steps<S: Simd>(
    simd: S,
    strains: &[[Strain; 3]],
    place: usize,
) -> LaneTwist<S> {
    let mut columns = [[0.0; WIDTH]; 6];
    for lane in 0..Lanes::<S>::COUNT.min(WIDTH) {
        put(&mut columns, lane, &strains[lane.min(strains.len() - 1)][place]);
    }
    of_columns(simd, &columns, 0)
}

/// Writes the numbers of a strain into a lane.
#[inline(always)]
pub(crate) fn put(
    columns: &mut [[f64; WIDTH]; 6],
    lane: usize,
    Strain { linear, angular }: &Strain,
) {
    let numbers = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z];
    for (column, number) in columns.iter_mut().zip(numbers) {
        column[lane] = number;
    }
}

/// From the numbers of strains from a lane on, those of all lanes one behind the other.
#[inline(always)]
pub(crate) fn of_columns<S: Simd>(
    simd: S,
    columns: &[[f64; WIDTH]; 6],
    first: usize,
) -> LaneTwist<S> {
    let load = |i: usize| Lanes::load(simd, &columns[i], first);
    LaneTwist {
        linear: LaneVec3::new(load(0), load(1), load(2)),
        angular: LaneVec3::new(load(3), load(4), load(5)),
    }
}

/// The strain in one lane.
#[inline(always)]
pub(crate) fn strain_of<S: Simd>(
    LaneTwist { linear, angular }: &LaneTwist<S>,
    lane: usize,
) -> Strain {
    Strain { linear: linear.of(lane), angular: angular.of(lane) }
}
