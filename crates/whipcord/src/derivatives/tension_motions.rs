//! How a rod without load moves with the tension of each cable: its sections move by themselves, and what is beyond them is carried along.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::lanes::{LaneVec3, Lanes};
use whipcord_numerics::{Pose, Twist};

use super::quadrature::{POINTS, Quadrature};
use crate::statics::section_table::WIDTH;

/// How the ends of all steps and the lengths of all cables change with the tension of each cable, in memory that is kept.
#[derive(Clone, Debug, Default)]
pub(super) struct TensionMotions {
    /// Components of what unit tensions exert at each point: of the first [`WIDTH`] cables, of the next, and so on.
    pulls: Vec<[[f64; WIDTH]; 6]>,
    /// Rates of the length of each cable, of each group of lanes.
    lengths: Vec<[f64; WIDTH]>,
}

impl TensionMotions {
    /// Of the points of a rod, eq. (d5). `motions` gets those of the ends, base frame, of a cable one after the other, and `lengths` the rate of cable i by the
    /// tension of cable j at `[j * cables + i]`; the base does not move.
    pub fn of(
        &mut self,
        rod: &Quadrature,
        poses: &[Pose],
        motions: &mut [Twist],
        lengths: &mut [f64],
    ) {
        // Of a robot without cables.
        if lengths.is_empty() {
            return;
        }
        Arch::new().dispatch(OfAll { memory: self, rod, poses, motions, lengths });
    }

    fn transpose(&mut self, rod: &Quadrature, cables: usize) {
        self.pulls.clear();
        for pulls in rod.pulls.chunks_exact(cables) {
            for pulls in pulls.chunks(WIDTH) {
                let mut of = [[0.0; WIDTH]; 6];
                for (cable, (pull, _)) in pulls.iter().enumerate() {
                    let [x, y, z] = pull.linear.to_array();
                    let [p, q, r] = pull.angular.to_array();
                    for (row, number) in of.iter_mut().zip([x, y, z, p, q, r]) {
                        row[cable] = number;
                    }
                }
                self.pulls.push(of);
            }
        }
    }
}

/// [`TensionMotions::of`] with the instructions that the processor has, a few cables at a time.
struct OfAll<'a> {
    memory: &'a mut TensionMotions,
    rod: &'a Quadrature,
    poses: &'a [Pose],
    motions: &'a mut [Twist],
    lengths: &'a mut [f64],
}

impl WithSimd for OfAll<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { memory, rod, poses, motions, lengths } = self;
        let nodes = poses.len();
        let cables = motions.len() / nodes;
        memory.transpose(rod, cables);
        let groups = cables.div_ceil(WIDTH);
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        for first in (0..cables).step_by(Lanes::<S>::COUNT) {
            let count = Lanes::<S>::COUNT.min(cables - first);
            let (group, lane) = (first / WIDTH, first % WIDTH);
            // Symmetric: of the cables behind these it is known from theirs.
            memory.lengths.clear();
            memory.lengths.resize(first + count, [0.0; WIDTH]);
            let (mut linear, mut angular) = (null, null);
            // Of the section at hand, which may be that at several points, with their weights together.
            let (mut v, mut u) = (null, null);
            for (k, ends) in poses.windows(2).enumerate() {
                let arm = LaneVec3::splat(simd, ends[1].position - ends[0].position);
                linear = linear - arm.cross(angular);
                for at in POINTS * k..POINTS * (k + 1) {
                    let point = &rod.points[at];
                    if !point.repeats {
                        let rows = &memory.pulls[at * groups + group];
                        let load = |row: usize| Lanes::load(simd, &rows[row], lane);
                        let n = LaneVec3::new(load(0), load(1), load(2));
                        let m = LaneVec3::new(load(3), load(4), load(5));
                        let [vn, vm, um] = &point.compliance;
                        v = n.times(vn) + m.times(vm);
                        u = n.transpose_times(vm) + m.times(um);
                        let same = rod.points[at + 1..].iter().take_while(|next| next.repeats);
                        let weight = same.fold(point.weight, |sum, next| sum + next.weight);
                        let pulls = &rod.pulls[at * cables..];
                        for (length, (pull, _)) in memory.lengths.iter_mut().zip(pulls) {
                            let work = v.along(pull.linear) + u.along(pull.angular);
                            let sum = Lanes::load(simd, length, 0) - work * weight;
                            length[..Lanes::<S>::COUNT].copy_from_slice(sum.as_slice());
                        }
                    }
                    angular = angular - u.times(&point.turn);
                    linear = linear - (u.times(&point.shift) + v.times(&point.turn));
                }
                for lane in 0..count {
                    motions[(first + lane) * nodes + k + 1] =
                        Twist { linear: linear.of(lane), angular: angular.of(lane) };
                }
            }
            for (other, of) in memory.lengths.iter().enumerate() {
                for cable in other.max(first)..first + count {
                    lengths[cable * cables + other] = of[cable - first];
                    lengths[other * cables + cable] = of[cable - first];
                }
            }
        }
    }
}
