//! All steps of a rod side by side in lanes, each from a start of its own: [`super::loaded`] for [`super::chain`].

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::lanes::{LaneMask, LanePose, LaneTwist, LaneVec3, Lanes};
use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::gap::Gap;
use super::state::Node;
use super::target::Target;
use crate::section::{BodyWrench, Fault, Strain, Tangent};
use crate::shape::Wrench;
use crate::statics::elimination::Change;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::lanes::columns::{of_columns, put};
use crate::statics::lanes::equilibrium::equilibrium_within;
use crate::statics::lanes::one_cable::{LaneCrossed, LaneReduced};
use crate::statics::lanes::rod_step::{LaneState, StepSections, advance};
use crate::statics::lanes::slots::LoadedSlots;
use crate::statics::loads::AppliedLoads;
use crate::statics::quadratic_form::Sample;
use crate::statics::runge_kutta::{NODE_OF_STAGE, SAMPLED_NODES, SAMPLED_STAGES, STAGES};
use crate::statics::scales::Scales;
use crate::statics::section_table::{Row, WIDTH};
use crate::statics::step_table::StepTable;

/// Memory.
#[derive(Clone, Debug, Default)]
pub(super) struct StepLanes {
    /// Force, moment and quaternion of the sections that are sampled: three for the steps in neighbouring slots, then for the next.
    sampled: Vec<[Row; 10]>,
    group: Group,
    /// At each stage of the steps side by side where the sections start from, and then their strains; then of the next.
    strains: Vec<[[Row; 6]; STAGES]>,
    /// Tensions of all cables at each shooting node in turn of the steps side by side.
    tensions: Vec<Row>,
}

/// The steps of a rod that are shot.
struct ShootSteps<'a> {
    table: &'a StepTable,
    grid: &'a Grid,
    loads: &'a AppliedLoads,
    target: &'a Target<'a>,
    nodes: &'a [Node],
    scales: &'a Scales,
    strains: &'a mut [Strain],
    gaps: &'a mut Vec<Gap>,
    memory: &'a mut StepLanes,
}

/// Steps side by side, and what acts on them.
#[derive(Clone, Debug, Default)]
struct Group {
    length: Row,
    rotation: [Row; 4],
    /// Of the nodes behind the steps.
    next: [Row; 4],
    /// In the base frame.
    moment: [Row; 3],
    /// At the end of the steps: the dead moment in the base frame, that of the followers in the body frame, and that at the next node.
    dead_moment: [Row; 3],
    follower_moment: [Row; 3],
    next_moment: [Row; 3],
    /// At each shooting node, in the base frame.
    forces: [[Row; 3]; SHOOTING_NODES.len()],
}

impl StepLanes {
    /// Shoots every step of a rod from its node: how each misses the next one, and the size of the greatest gap; `None` where lanes cannot take
    /// the sections or the loads, or a section finds no strain.
    pub fn shoot(
        &mut self,
        (grid, scales): (&Grid, &Scales),
        loads: &AppliedLoads,
        target: &Target<'_>,
        nodes: &[Node],
        strains: &mut [Strain],
        gaps: &mut Vec<Gap>,
    ) -> Option<f64> {
        let table = grid.step_table().filter(|_| !loads.any_line())?;
        if strains.len() != STAGES * grid.len() {
            return None;
        }
        let memory = self;
        Arch::new().dispatch(ShootSteps {
            table,
            grid,
            loads,
            target,
            nodes,
            scales,
            strains,
            gaps,
            memory,
        })
    }

    /// How the middles of so many steps are turned in the last shot, and their moments in the body frame, to the order of its stages.
    pub fn middles(&self, steps: usize) -> impl Iterator<Item = (UnitQuaternion, Vec3)> {
        (0..steps).map(|k| {
            let (wrench, rotation) = self.cut(k, 1);
            (rotation, wrench.angular)
        })
    }

    /// Force, moment and quaternion at sample `q` of a group of steps of the last shot.
    #[inline(always)]
    pub fn sampled(&self, group: usize, q: usize) -> &[Row; 10] {
        &self.sampled[SAMPLED_NODES.len() * group + q]
    }

    /// Strains at a stage of a group of steps of the last shot.
    #[inline(always)]
    pub fn strains(&self, group: usize, stage: usize) -> &[Row; 6] {
        &self.strains[group][stage]
    }

    /// Wrench and rotation at sample `q` of step `k` of the last shot.
    #[inline(always)]
    fn cut(&self, k: usize, q: usize) -> (BodyWrench, UnitQuaternion) {
        let [a, b, c, d, e, f, w, x, y, z] = self.sampled(k / WIDTH, q);
        let vector = |rows: [&Row; 3]| {
            let [x, y, z] = rows.map(|row| row[k % WIDTH]);
            Vec3::new(x, y, z)
        };
        let wrench = BodyWrench { linear: vector([a, b, c]), angular: vector([d, e, f]) };
        (wrench, UnitQuaternion { w: w[k % WIDTH], v: vector([x, y, z]) })
    }

    /// Takes the samples of the last shot, three to a step.
    pub fn samples(
        &self,
        at: (&Grid, &Target<'_>),
        strains: &[Strain],
        samples: &mut Vec<Sample>,
    ) -> Result<(), Fault> {
        samples.resize(SAMPLED_NODES.len() * at.0.len(), Sample::default());
        Arch::new().dispatch(Samples { of: self, at, strains, samples })
    }

    /// Takes sample `q` of step `k` of the last shot.
    #[inline(always)]
    fn sample(
        &self,
        (grid, target): (&Grid, &Target<'_>),
        strains: &[Strain],
        (k, q): (usize, usize),
        sample: &mut Sample,
    ) -> Result<(), Fault> {
        let (step, j) = (grid.steps[k], SAMPLED_NODES[q]);
        (sample.wrench, sample.rotation) = self.cut(k, q);
        let (node, crossings) = grid.shooting.at(k, j, step.active);
        let cables = (crossings, grid.shooting.groups(k, j, step.active));
        let strain = strains[STAGES * k + SAMPLED_STAGES[q]];
        let tensions = target.tensions_at(k, j, step.active);
        let arc_length = step.start + SHOOTING_NODES[j] * step.length;
        sample.strain = strain;
        sample.tangent = Tangent::by_groups(&node.section, cables, tensions, &strain)
            .map_err(|kind| Fault { kind, arc_length })?;
        Ok(())
    }
}

/// Samples of the last shot with the instructions that the processor has.
struct Samples<'a> {
    of: &'a StepLanes,
    at: (&'a Grid, &'a Target<'a>),
    strains: &'a [Strain],
    samples: &'a mut [Sample],
}

impl WithSimd for Samples<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { of, at, strains, samples } = self;
        for (k, of_step) in samples.chunks_exact_mut(SAMPLED_NODES.len()).enumerate() {
            for (q, sample) in of_step.iter_mut().enumerate() {
                of.sample(at, strains, (k, q), sample)?;
            }
        }
        Ok(())
    }
}

impl WithSimd for ShootSteps<'_> {
    type Output = Option<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Option<f64> {
        let Self { table, grid, loads, target, nodes, scales, strains, gaps, memory } = self;
        let StepLanes { sampled, group: at, strains: of_groups, tensions } = memory;
        gaps.clear();
        gaps.reserve(grid.len());
        let groups = grid.len().div_ceil(WIDTH);
        sampled.resize(SAMPLED_NODES.len() * groups, [[0.0; WIDTH]; 10]);
        of_groups.resize(groups, [[[0.0; WIDTH]; 6]; STAGES]);
        let cables = table.cables();
        let lanes = Lanes::<S>::COUNT.min(WIDTH);
        let one = Lanes::splat(simd, 1.0);
        let mut greatest: f64 = 0.0;
        for group in (0..grid.len()).step_by(WIDTH) {
            at.gather((grid, loads, target), nodes, group);
            let of_stages = &mut of_groups[group / WIDTH];
            if !table.is_crossed_once {
                gather_strains(strains, group, of_stages);
            }
            gather_tensions((grid, target), group, cables, tensions);
            for first in (0..WIDTH.min(grid.len() - group)).step_by(lanes) {
                let vector = |rows: &[Row; 3]| {
                    let [x, y, z] = rows;
                    let load = |row: &Row| Lanes::load(simd, row, first);
                    LaneVec3::new(load(x), load(y), load(z))
                };
                let zero = Lanes::splat(simd, 0.0);
                let null = LaneVec3::new(zero, zero, zero);
                let turned = |[w, x, y, z]: &[Row; 4]| {
                    let load = |row: &Row| Lanes::load(simd, row, first);
                    let v = LaneVec3::new(load(x), load(y), load(z));
                    LanePose { position: null, w: load(w), v }
                };
                let start = LaneState { pose: turned(&at.rotation), moment: vector(&at.moment) };
                let of_group = SAMPLED_NODES.len() * (group / WIDTH);
                let mut sections = Sections {
                    table,
                    at,
                    strains: of_stages,
                    sampled: &mut sampled[of_group..],
                    tensions,
                    cables,
                    step: group + first,
                    first,
                    tolerance: target.step_tolerance,
                    is_solved: one.at_most(one),
                };
                let length = Lanes::load(simd, &at.length, first);
                let end = advance(simd, length, start, &mut sections);
                if !sections.is_solved.all() {
                    return None;
                }
                let next_moment = vector(&at.next_moment);
                let moment = end.pose.to_body(end.moment - vector(&at.dead_moment));
                let moment = moment - vector(&at.follower_moment) - next_moment;
                let turn = end.pose.turn_from(&turned(&at.next));
                let (near, is_near) = (turn.unwrap_or(null), turn.is_some());
                let per = next_moment.norm() + scales.moment;
                let [turned, missed] = [near.norm(), moment.norm() / per];
                // A NaN must not pass for a closed gap.
                let is_finite = (turned + missed).at_most(Lanes::splat(simd, f64::MAX));
                let size = is_finite.select(turned.max(missed), Lanes::splat(simd, f64::INFINITY));
                let mut rows = [[0.0; WIDTH]; 14];
                let LanePose { position: p, w, v } = end.pose;
                let numbers = [
                    p.x, p.y, p.z, w, v.x, v.y, v.z, near.x, near.y, near.z, moment.x, moment.y,
                    moment.z, size,
                ];
                store(0, &mut rows, &numbers);
                for lane in 0..lanes.min(grid.len() - group - first) {
                    let k = group + first + lane;
                    let vector =
                        |i: usize| Vec3::new(rows[i][lane], rows[i + 1][lane], rows[i + 2][lane]);
                    let rotation = UnitQuaternion { w: rows[3][lane], v: vector(4) };
                    let end_pose = Pose { position: vector(0), rotation };
                    let next = &nodes[k + 1];
                    let (gap, size) = if is_near {
                        let force =
                            Gap::force((loads, target.load), k, &end_pose, nodes[k].force, next);
                        let change = Change { turn: vector(7), moment: vector(10), force };
                        let gap = Gap { change, end: end_pose };
                        (gap, rows[13][lane].max(gap.size_of_force(next, scales)))
                    } else {
                        let cut = Wrench { force: nodes[k].force, moment: end.moment.of(lane) };
                        let gap = Gap::of((loads, target.load), k, end_pose, cut, next);
                        (gap, gap.size(next, scales))
                    };
                    greatest = greatest.max(size);
                    gaps.push(gap);
                }
            }
        }
        // Only now: where a section finds no strain, others start from those that were there.
        for (of_steps, of_stages) in strains.chunks_mut(STAGES * WIDTH).zip(of_groups.iter()) {
            for (stage, [x, y, z, p, q, r]) in of_stages.iter().enumerate() {
                for (slot, strain) in of_steps.iter_mut().skip(stage).step_by(STAGES).enumerate() {
                    let (linear, angular) = (
                        Vec3::new(x[slot], y[slot], z[slot]),
                        Vec3::new(p[slot], q[slot], r[slot]),
                    );
                    *strain = Strain { linear, angular };
                }
            }
        }
        Some(greatest)
    }
}

impl Group {
    /// Takes the steps from `first` on.
    #[inline(always)]
    fn gather(
        &mut self,
        (grid, loads, target): (&Grid, &AppliedLoads, &Target<'_>),
        nodes: &[Node],
        first: usize,
    ) {
        for slot in 0..WIDTH {
            let k = (first + slot).min(grid.len() - 1);
            let (Node { rotation, moment, force }, next) = (nodes[k], &nodes[k + 1]);
            self.length[slot] = grid.steps[k].length;
            for (row, number) in self.rotation.iter_mut().zip(rotation.wxyz()) {
                row[slot] = number;
            }
            for (row, number) in self.next.iter_mut().zip(next.rotation.wxyz()) {
                row[slot] = number;
            }
            put_vector(&mut self.moment, slot, rotation.rotate(moment));
            put_vector(&mut self.dead_moment, slot, target.load * loads.moment(k + 1));
            let follower = loads.follower(k + 1).moment;
            put_vector(&mut self.follower_moment, slot, target.load * follower);
            put_vector(&mut self.next_moment, slot, next.moment);
            for (rows, &dead) in self.forces.iter_mut().zip(loads.forces(k)) {
                put_vector(rows, slot, target.load * dead + force);
            }
        }
    }
}

/// Takes the strains of the steps from `first` on.
#[inline(always)]
fn gather_strains(strains: &[Strain], first: usize, of_stages: &mut [[Row; 6]; STAGES]) {
    for slot in 0..WIDTH {
        let k = (first + slot).min(strains.len() / STAGES - 1);
        for (rows, strain) in of_stages.iter_mut().zip(&strains[STAGES * k..]) {
            put(rows, slot, strain);
        }
    }
}

#[inline(always)]
fn put_vector(rows: &mut [Row; 3], slot: usize, vector: Vec3) {
    for (row, number) in rows.iter_mut().zip(vector.to_array()) {
        row[slot] = number;
    }
}

/// Tensions of the steps from `first` on: zero behind the end of a cable.
#[inline(always)]
pub(super) fn gather_tensions(
    (grid, target): (&Grid, &Target<'_>),
    first: usize,
    cables: usize,
    rows: &mut Vec<Row>,
) {
    rows.clear();
    rows.resize(cables * SHOOTING_NODES.len(), [0.0; WIDTH]);
    for slot in 0..WIDTH {
        let k = (first + slot).min(grid.len() - 1);
        let active = grid.steps[k].active;
        for j in 0..SHOOTING_NODES.len() {
            for (cable, tension) in target.tensions_at(k, j, active).iter().enumerate() {
                rows[cables * j + cable][slot] = *tension;
            }
        }
    }
}

/// The sections of the steps in as many lanes.
struct Sections<'a, S: Simd> {
    table: &'a StepTable,
    at: &'a Group,
    strains: &'a mut [[Row; 6]; STAGES],
    sampled: &'a mut [[Row; 10]],
    tensions: &'a [Row],
    cables: usize,
    /// Of the first lane, and its slot.
    step: usize,
    first: usize,
    tolerance: f64,
    is_solved: LaneMask<S>,
}

/// Writes numbers into the slots of the lanes.
#[inline(always)]
pub(super) fn store<S: Simd>(first: usize, rows: &mut [Row], numbers: &[Lanes<S>]) {
    let slots = first..first + Lanes::<S>::COUNT.min(WIDTH);
    for (row, number) in rows.iter_mut().zip(numbers) {
        row[slots.clone()].copy_from_slice(number.as_slice());
    }
}

impl<S: Simd> StepSections<S> for Sections<'_, S> {
    #[inline(always)]
    fn force(&self, simd: S, stage: usize) -> LaneVec3<S> {
        let [x, y, z] = &self.at.forces[NODE_OF_STAGE[stage]];
        let load = |row: &Row| Lanes::load(simd, row, self.first);
        LaneVec3::new(load(x), load(y), load(z))
    }

    #[inline(always)]
    fn strain(
        &mut self,
        simd: S,
        stage: usize,
        rotation: &LanePose<S>,
        wrench: [LaneVec3<S>; 2],
    ) -> LaneTwist<S> {
        let j = NODE_OF_STAGE[stage];
        let (strain, is_solved) = match self.table.slots(self.step, j) {
            Some(slots) if self.table.is_crossed_once => {
                let crossed: LaneCrossed<S> = slots.crossed(simd);
                let tension = match self.tensions.get(j) {
                    Some(row) => Lanes::load(simd, row, self.first),
                    None => Lanes::splat(simd, 0.0),
                };
                let found = LaneReduced::under(simd, &crossed, wrench).solve(simd, tension);
                (found.strain, found.is_solved)
            }
            slots => {
                let start = of_columns(simd, &self.strains[stage], self.first);
                match slots {
                    Some(slots) => {
                        let tensions = &self.tensions[self.cables * j..self.cables * (j + 1)];
                        let of = LoadedSlots { slots, tensions, wrench };
                        equilibrium_within(self.tolerance, &of, simd, start)
                    }
                    // Each node of each step has its slots.
                    None => (start, self.is_solved),
                }
            }
        };
        self.is_solved = self.is_solved.and(is_solved);
        let (v, u) = (strain.linear, strain.angular);
        let numbers = [v.x, v.y, v.z, u.x, u.y, u.z];
        store(self.first, &mut self.strains[stage], &numbers);
        for (rows, of_sample) in self.sampled.iter_mut().zip(SAMPLED_STAGES) {
            if of_sample == stage {
                let ([n, m], LanePose { w, v, .. }) = (wrench, *rotation);
                let numbers = [n.x, n.y, n.z, m.x, m.y, m.z, w, v.x, v.y, v.z];
                store(self.first, rows, &numbers);
            }
        }
        strain
    }
}
