//! What all cables of a section exert, and what they add to the Hessian of its potential, with several cables side by side.
//!
//! With `W = k (I − ttᵀ)`, `k = τ/‖p′‖`, a cable adds `W`, `−W r̂` and `r̂ᵀ W r̂` to the three blocks of the Hessian. The offset `r` has no z
//! component.

use whipcord_numerics::Vec3;

use super::crossing::{BodyWrench, Crossing, Strain};
use super::lanes::{LANES, Lane, LaneVec};

/// Of fewer cables the sums take longer than one cable after the other.
const FEWEST: usize = 3;

/// Sums over the cables of a section.
pub(super) struct CableSums {
    /// What they exert.
    pub wrench: BodyWrench,
    /// Of `W`: its rows, as far as they lie on and above the diagonal.
    pub force: [Vec3; 3],
    /// Of `−W r̂`, by columns.
    pub mixed: [Vec3; 3],
    /// Of `r̂ᵀ W r̂`: its rows likewise.
    pub moment: [Vec3; 3],
}

/// How a few cables cross a section, one in each lane: in memory as the processor's vectors take it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CableGroup {
    offset: [Lane; 2],
    slope: LaneVec,
}

/// The sums in each lane; of symmetric matrices xx, xy, xz, yy, yz and zz.
#[derive(Default)]
struct LaneSums {
    wrench: [LaneVec; 2],
    force: [Lane; 6],
    mixed: [LaneVec; 3],
    moment: [Lane; 6],
}

impl CableGroup {
    /// How many groups so many cables are; none of so few that one after the other is faster.
    #[inline(always)]
    pub const fn count(cables: usize) -> usize {
        if cables < FEWEST { 0 } else { cables.div_ceil(LANES) }
    }

    /// Of the cables of a section. Lanes without one have it on the axis.
    pub fn of(crossings: &[Crossing]) -> impl Iterator<Item = Self> + '_ {
        crossings.chunks(LANES).take(Self::count(crossings.len())).map(|cables| {
            let mut group = Self::default();
            for (lane, Crossing { offset, slope, .. }) in cables.iter().enumerate() {
                group.offset[0].0[lane] = offset.x;
                group.offset[1].0[lane] = offset.y;
                group.slope.set(lane, *slope);
            }
            group
        })
    }

    /// The unit vector along each cable, and `1/‖p′‖`.
    #[inline(always)]
    fn directions(&self, tension: Lane, strain: &Strain) -> (LaneVec, Lane) {
        let Self { offset: [x, y], slope } = *self;
        let (v, u) = (strain.linear, strain.angular);
        let tangent = LaneVec {
            x: slope.x + Lane::splat(v.x) - u.z * y,
            y: slope.y + Lane::splat(v.y) + u.z * x,
            z: slope.z + Lane::splat(v.z) + (u.x * y - u.y * x),
        };
        let stretch = tangent.inner(&tangent).map(f64::sqrt);
        // A cable without tension does nothing, even where it has no direction.
        let per_stretch = tension.with(stretch, |tension, of| match tension == 0.0 {
            true => 0.0,
            false => 1.0 / of,
        });
        (tangent.scaled(per_stretch), per_stretch)
    }

    /// What a force along each cable exerts.
    #[inline(always)]
    fn wrenches(&self, pull: LaneVec) -> [LaneVec; 2] {
        let [x, y] = self.offset;
        [pull, LaneVec { x: y * pull.z, y: -(x * pull.z), z: x * pull.y - y * pull.x }]
    }

    /// What all cables exert.
    #[inline(always)]
    pub fn wrench(groups: &[Self], tensions: &[f64], strain: &Strain) -> BodyWrench {
        let [mut linear, mut angular] = [LaneVec::default(); 2];
        for (group, tensions) in groups.iter().zip(tensions.chunks(LANES)) {
            let tension = in_lanes(tensions);
            let [f, m] = group.wrenches(group.directions(tension, strain).0.scaled(tension));
            linear += f;
            angular += m;
        }
        BodyWrench { linear: linear.sum(), angular: angular.sum() }
    }

    #[inline(always)]
    fn sums(&self, tension: Lane, strain: &Strain) -> LaneSums {
        let (t, per_stretch) = self.directions(tension, strain);
        let [x, y] = self.offset;
        let k = tension * per_stretch;
        let kt = t.scaled(k);
        let (xx, xy, xz) = (k - kt.x * t.x, -(kt.x * t.y), -(kt.x * t.z));
        let (yy, yz, zz) = (k - kt.y * t.y, -(kt.y * t.z), k - kt.z * t.z);
        let last = LaneVec { x: xz, y: yz, z: zz };
        let turned = LaneVec { x: x * xy - y * xx, y: x * yy - y * xy, z: x * yz - y * xz };
        let yzz = y * zz;
        LaneSums {
            wrench: self.wrenches(t.scaled(tension)),
            force: [xx, xy, xz, yy, yz, zz],
            mixed: [last.scaled(y), last.scaled(-x), turned],
            moment: [
                y * yzz,
                -(x * yzz),
                y * turned.z,
                x * (x * zz),
                -(x * turned.z),
                x * turned.y - y * turned.x,
            ],
        }
    }
}

/// The tensions of a group's cables.
#[inline(always)]
fn in_lanes(tensions: &[f64]) -> Lane {
    match *tensions {
        [a, b, c, d] => Lane([a, b, c, d]),
        [a, b, c] => Lane([a, b, c, 0.0]),
        [a, b] => Lane([a, b, 0.0, 0.0]),
        _ => Lane([tensions.first().copied().unwrap_or(0.0), 0.0, 0.0, 0.0]),
    }
}

impl LaneSums {
    #[inline(always)]
    fn add(&mut self, more: &Self) {
        let vectors = self.wrench.iter_mut().zip(&more.wrench);
        vectors.chain(self.mixed.iter_mut().zip(&more.mixed)).for_each(|(a, b)| *a += *b);
        let numbers = self.force.iter_mut().zip(&more.force);
        numbers.chain(self.moment.iter_mut().zip(&more.moment)).for_each(|(a, b)| *a += *b);
    }
}

impl CableSums {
    /// Of cables in groups; lanes beyond the tensions have none.
    #[inline(always)]
    pub fn at(groups: &[CableGroup], tensions: &[f64], strain: &Strain) -> Self {
        let mut sums = LaneSums::default();
        for (group, tensions) in groups.iter().zip(tensions.chunks(LANES)) {
            sums.add(&group.sums(in_lanes(tensions), strain));
        }
        let LaneSums { wrench: [linear, angular], force, mixed, moment } = sums;
        let rows = |[xx, xy, xz, yy, yz, zz]: [Lane; 6]| {
            [
                Vec3::new(xx.sum(), xy.sum(), xz.sum()),
                Vec3::new(0.0, yy.sum(), yz.sum()),
                Vec3::new(0.0, 0.0, zz.sum()),
            ]
        };
        Self {
            wrench: BodyWrench { linear: linear.sum(), angular: angular.sum() },
            force: rows(force),
            mixed: mixed.map(|column| column.sum()),
            moment: rows(moment),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::tangent::Tangent;
    use crate::section::{Section, Stiffness};

    #[test]
    fn sums_of_several_cables_are_those_of_one_after_the_other() {
        let bending = Vec3::new(4.4e-3, 5.1e-3, 3.4e-3);
        let stiffness = Stiffness { shear: Vec3::new(3e3, 3e3, 8e3), bending };
        let section = Section::new(stiffness, Vec3::new(1.0, -2.0, 0.5));
        let strain =
            Strain { linear: Vec3::new(0.02, -0.01, 0.97), angular: Vec3::new(3.0, -9.0, 6.0) };
        for cables in 0..=9 {
            let crossing = |i: usize| {
                let (sin, cos) = (2.1 * i as f64).sin_cos();
                let offset = Vec3::new(cos, sin, 0.0) * (0.004 + 1e-3 * i as f64);
                Crossing::new(offset, Vec3::new(-0.2 * sin, 0.2 * cos, 0.0))
            };
            let crossings: Vec<Crossing> = (0..cables).map(crossing).collect();
            // Every third is slack.
            let tension = |i: usize| if i % 3 == 1 { 0.0 } else { 0.5 + i as f64 };
            let tensions: Vec<f64> = (0..cables).map(tension).collect();
            let mut wrench = BodyWrench::default();
            for (crossing, &tension) in crossings.iter().zip(&tensions) {
                let pull = crossing.pull(&strain).0;
                wrench.linear += tension * pull.linear;
                wrench.angular += tension * pull.angular;
            }
            let groups: Vec<CableGroup> = CableGroup::of(&crossings).collect();
            if cables >= FEWEST {
                let sums = CableSums::at(&groups, &tensions, &strain).wrench;
                assert!((sums.linear - wrench.linear).norm() <= 1e-13);
                assert!((sums.angular - wrench.angular).norm() <= 1e-15);
                assert_eq!(CableGroup::wrench(&groups, &tensions, &strain), sums);
            }
            let one = Tangent::at(&section, &crossings, &tensions, &strain).unwrap();
            let tangent = Tangent::by_groups(&section, (&crossings, &groups), &tensions, &strain);
            let groups = tangent.unwrap();
            for (a, b) in one.compliance().iter().zip(&groups.compliance()) {
                for (a, b) in a.rows.iter().zip(&b.rows) {
                    assert!(
                        (*a - *b).norm() <= 1e-12 * a.norm().max(1e-6),
                        "{cables}: {a:?} {b:?}"
                    );
                }
            }
        }
    }
}
