//! All steps of a rod side by side in lanes, each from a start of its own: [`super::loaded`] for [`super::chain`].

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::lanes::{LaneMask, LanePose, LaneTwist, LaneVec3, Lanes};
use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::state::Node;
use super::target::Target;
use crate::section::{BodyWrench, Fault, Strain, Tangent};
use crate::shape::Wrench;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::lanes::columns::{of_columns, put};
use crate::statics::lanes::one_cable::{LaneCrossed, LaneReduced};
use crate::statics::lanes::rod_step::{LaneState, StepSections, advance};
use crate::statics::lanes::section::equilibrium_within;
use crate::statics::lanes::slots::LoadedSlots;
use crate::statics::loads::AppliedLoads;
use crate::statics::quadratic_form::Sample;
use crate::statics::runge_kutta::{NODE_OF_STAGE, SAMPLED_NODES, SAMPLED_STAGES, STAGES};
use crate::statics::section_table::{Row, WIDTH};
use crate::statics::step_table::StepTable;

/// The end of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepEnd {
    /// Frame, with the position relative to the start.
    pub pose: Pose,
    /// Rotation from the next node, in the body frame.
    pub turn: Vec3,
    /// In the body frame.
    pub moment: Vec3,
    /// Of the followers, in the base frame.
    pub force: Vec3,
}

impl StepEnd {
    /// A step that ends with this frame and this cut in the base frame before a node that is turned like this.
    pub fn of(pose: Pose, cut: Wrench, next: UnitQuaternion) -> Self {
        let turn = (next.conjugate() * pose.rotation).log();
        let moment = pose.rotation.conjugate().rotate(cut.moment);
        Self { pose, turn, moment, force: cut.force }
    }
}

/// Memory.
#[derive(Clone, Debug, Default)]
pub(super) struct StepLanes {
    pub ends: Vec<StepEnd>,
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
    strains: &'a mut [Strain],
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
    /// At each shooting node, in the base frame.
    forces: [[Row; 3]; SHOOTING_NODES.len()],
}

impl StepLanes {
    /// Shoots every step of a rod from its node; `false` where lanes cannot take the sections or the loads, or a section finds no strain.
    pub fn shoot(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        target: &Target<'_>,
        nodes: &[Node],
        strains: &mut [Strain],
    ) -> bool {
        let Some(table) = grid.step_table().filter(|_| !loads.any_line()) else { return false };
        if strains.len() != STAGES * grid.len() {
            return false;
        }
        let memory = self;
        Arch::new().dispatch(ShootSteps { table, grid, loads, target, nodes, strains, memory })
    }

    /// How the middles of so many steps are turned in the last shot, and their moments in the body frame, to the order of its stages.
    pub fn middles(&self, steps: usize) -> impl Iterator<Item = (UnitQuaternion, Vec3)> {
        (0..steps).map(|k| {
            let (wrench, rotation) = self.cut(k, 1);
            (rotation, wrench.angular)
        })
    }

    /// Wrench and rotation at sample `q` of step `k` of the last shot.
    #[inline(always)]
    fn cut(&self, k: usize, q: usize) -> (BodyWrench, UnitQuaternion) {
        let [a, b, c, d, e, f, w, x, y, z] = &self.sampled[SAMPLED_NODES.len() * (k / WIDTH) + q];
        let vector = |rows: [&Row; 3]| {
            let [x, y, z] = rows.map(|row| row[k % WIDTH]);
            Vec3::new(x, y, z)
        };
        let wrench = BodyWrench { linear: vector([a, b, c]), angular: vector([d, e, f]) };
        (wrench, UnitQuaternion { w: w[k % WIDTH], v: vector([x, y, z]) })
    }

    /// Takes the samples of the last shot, three to a step, or only those in the middles.
    pub fn samples(
        &self,
        at: (&Grid, &Target<'_>),
        strains: &[Strain],
        only_middles: bool,
        samples: &mut Vec<Sample>,
    ) -> Result<(), Fault> {
        samples.resize(SAMPLED_NODES.len() * at.0.len(), Sample::default());
        Arch::new().dispatch(Samples { of: self, at, strains, only_middles, samples })
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
    /// Whether those in the middle of the steps are enough.
    only_middles: bool,
    samples: &'a mut [Sample],
}

impl WithSimd for Samples<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { of, at, strains, only_middles, samples } = self;
        for (k, of_step) in samples.chunks_exact_mut(SAMPLED_NODES.len()).enumerate() {
            for (q, sample) in of_step.iter_mut().enumerate() {
                if q == 1 || !only_middles {
                    of.sample(at, strains, (k, q), sample)?;
                }
            }
        }
        Ok(())
    }
}

impl WithSimd for ShootSteps<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { table, grid, nodes, strains, memory, .. } = self;
        let StepLanes { ends, sampled, group: at, strains: of_groups, tensions } = memory;
        ends.clear();
        let groups = grid.len().div_ceil(WIDTH);
        sampled.resize(SAMPLED_NODES.len() * groups, [[0.0; WIDTH]; 10]);
        of_groups.resize(groups, [[[0.0; WIDTH]; 6]; STAGES]);
        let cables = table.cables();
        let lanes = Lanes::<S>::COUNT.min(WIDTH);
        let one = Lanes::splat(simd, 1.0);
        for group in (0..grid.len()).step_by(WIDTH) {
            at.gather((grid, self.loads, self.target), nodes, group);
            let of_stages = &mut of_groups[group / WIDTH];
            if !table.is_crossed_once {
                gather_strains(strains, group, of_stages);
            }
            gather_tensions((grid, self.target), group, cables, tensions);
            for first in (0..WIDTH.min(grid.len() - group)).step_by(lanes) {
                let load = |row: &Row| Lanes::load(simd, row, first);
                let [w, x, y, z] = &at.rotation;
                let v = LaneVec3::new(load(x), load(y), load(z));
                let zero = Lanes::splat(simd, 0.0);
                let null = LaneVec3::new(zero, zero, zero);
                let [p, q, r] = &at.moment;
                let start = LaneState {
                    pose: LanePose { position: null, w: load(w), v },
                    moment: LaneVec3::new(load(p), load(q), load(r)),
                };
                let [w, x, y, z] = &at.next;
                let v = LaneVec3::new(load(x), load(y), load(z));
                let next = LanePose { position: null, w: load(w), v };
                let (length, of_group) = (load(&at.length), SAMPLED_NODES.len() * (group / WIDTH));
                let mut sections = Sections {
                    table,
                    at,
                    strains: of_stages,
                    sampled: &mut sampled[of_group..],
                    tensions,
                    cables,
                    step: group + first,
                    first,
                    tolerance: self.target.step_tolerance,
                    is_solved: one.at_most(one),
                };
                let end = advance(simd, length, start, &mut sections);
                if !sections.is_solved.all() {
                    return false;
                }
                let (turn, moment) = (end.pose.turn_from(&next), end.pose.to_body(end.moment));
                for lane in 0..lanes.min(grid.len() - group - first) {
                    let k = group + first + lane;
                    let pose = end.pose.of(lane);
                    ends.push(match turn {
                        Some(turn) => {
                            let (turn, moment) = (turn.of(lane), moment.of(lane));
                            StepEnd { pose, turn, moment, force: nodes[k].force }
                        }
                        None => {
                            let cut = Wrench { force: nodes[k].force, moment: end.moment.of(lane) };
                            StepEnd::of(pose, cut, nodes[k + 1].rotation)
                        }
                    });
                }
            }
        }
        // Only now: where a section finds no strain, others start from those that were there.
        for (k, of_step) in strains.chunks_exact_mut(STAGES).enumerate() {
            for (rows, strain) in of_groups[k / WIDTH].iter().zip(of_step) {
                let [x, y, z, p, q, r] = rows.map(|row| row[k % WIDTH]);
                *strain = Strain { linear: Vec3::new(x, y, z), angular: Vec3::new(p, q, r) };
            }
        }
        true
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
            let Node { rotation, moment, force } = nodes[k];
            self.length[slot] = grid.steps[k].length;
            for (row, number) in self.rotation.iter_mut().zip(rotation.wxyz()) {
                row[slot] = number;
            }
            for (row, number) in self.next.iter_mut().zip(nodes[k + 1].rotation.wxyz()) {
                row[slot] = number;
            }
            put_vector(&mut self.moment, slot, rotation.rotate(moment));
            for (j, rows) in self.forces.iter_mut().enumerate() {
                put_vector(rows, slot, target.load * loads.force(k, j) + force);
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
fn gather_tensions(
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

impl<S: Simd> Sections<'_, S> {
    /// Writes numbers into the slots of the lanes.
    #[inline(always)]
    fn store<const N: usize>(first: usize, rows: &mut [Row; N], numbers: &[Lanes<S>; N]) {
        let slots = first..first + Lanes::<S>::COUNT.min(WIDTH);
        for (row, number) in rows.iter_mut().zip(numbers) {
            row[slots.clone()].copy_from_slice(number.as_slice());
        }
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
        Self::store(self.first, &mut self.strains[stage], &numbers);
        for (rows, of_sample) in self.sampled.iter_mut().zip(SAMPLED_STAGES) {
            if of_sample == stage {
                let ([n, m], LanePose { w, v, .. }) = (wrench, *rotation);
                let numbers = [n.x, n.y, n.z, m.x, m.y, m.z, w, v.x, v.y, v.z];
                Self::store(self.first, rows, &numbers);
            }
        }
        strain
    }
}
