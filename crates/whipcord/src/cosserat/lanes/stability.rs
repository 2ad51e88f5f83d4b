//! [`super::super::unloaded::Unloaded::stability`] in lanes.

use pulp::Simd;
use whipcord_numerics::lanes::{LaneSym3, Lanes};
use whipcord_numerics::{Mat3, Vec3};

use super::super::unloaded::{LEAST_STABILITY, STABILITY_TOLERANCE, least_relative, scattered};
use super::Sweep;
use super::grid::{LaneGrid, LaneSection};

/// The stability of all lanes on one grid.
#[derive(Debug, Default)]
pub(super) struct Stability {
    least: Vec<f64>,
    state: Vec<State>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// The value is the least.
    Done,
    /// It is the least so far.
    Open,
    /// It is none.
    Failed,
}

impl Stability {
    pub fn of_lane(&self, lane: usize) -> Option<f64> {
        (self.state[lane] != State::Failed).then(|| self.least[lane])
    }

    /// Computes it for those lanes that `wanted` names.
    #[inline(always)]
    pub fn compute<S: Simd>(
        &mut self,
        grid: &LaneGrid,
        sweep: &Sweep<S>,
        wanted: impl Fn(usize) -> bool,
    ) {
        let Sweep { simd, tensions, strains, .. } = sweep;
        let simd = *simd;
        let lanes = Lanes::<S>::COUNT;
        self.least.clear();
        self.state.clear();
        for lane in 0..lanes {
            let taut = |active: usize| {
                tensions[..active].iter().filter(|t| t.as_slice()[lane] > 0.0).count()
            };
            let open = wanted(lane) && grid.active.iter().all(|&active| taut(active) > 1);
            self.least.push(if open { f64::MAX } else { 1.0 });
            self.state.push(if open { State::Open } else { State::Done });
        }
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        for n in scattered(strains.len()) {
            if !self.state.contains(&State::Open) {
                return;
            }
            // A section with one cable would have closed all lanes.
            let LaneSection::Several(at) = &grid.nodes[n].section else { return };
            let (reduced, definite) = at.reduced(simd, &tensions[..at.cables()], &strains[n]);
            let bound = Lanes::load(simd, &self.least) * (1.0 - STABILITY_TOLERANCE);
            let above = less(reduced, at.bending(), bound).ldlt(simd).1;
            let (definite, above) = (definite.select(one, zero), above.select(one, zero));
            for lane in 0..lanes {
                if self.state[lane] != State::Open {
                    continue;
                }
                if definite.as_slice()[lane] == 0.0 {
                    self.state[lane] = State::Failed;
                } else if above.as_slice()[lane] == 0.0 {
                    let metric = Mat3::diagonal(at.bending());
                    self.least[lane] = least_relative(&reduced.lane(lane), &metric);
                    if self.least[lane] <= LEAST_STABILITY {
                        self.state[lane] = State::Done;
                    }
                }
            }
        }
    }
}

/// A matrix less a multiple of a diagonal one.
#[inline(always)]
fn less<S: Simd>(a: LaneSym3<S>, metric: Vec3, bound: Lanes<S>) -> LaneSym3<S> {
    LaneSym3 {
        xx: a.xx - bound * metric.x,
        yy: a.yy - bound * metric.y,
        zz: a.zz - bound * metric.z,
        ..a
    }
}
