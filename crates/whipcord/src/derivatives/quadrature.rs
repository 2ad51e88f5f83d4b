//! A rod without load: its sections at the Gauss nodes, and how the ends of its steps move with them.
//!
//! No wrench acts, so that a small one is what it is whatever the shape does, and the strains at the
//! three nodes of a step follow from it section by section. With `Jᵢ` how the end of a step moves with
//! the strain at node i ([`super::magnus`]) and `hbᵢ` the weight of the quadrature
//!
//! ```text
//! δξᵢ = Hᵢ⁻¹ (wᵢ − eᵢ),   wᵢ = Jᵢᵀ W/hbᵢ,   δg = Σ Jᵢ δξᵢ                                   (d5)
//! ```
//!
//! where `W` is the wrench at the end of the step. `wᵢ` is what makes `Σ hbᵢ ψ(ξᵢ) − W·g` stationary, the
//! potential of the discrete rod: its compliance is symmetric, and what a tension moves a wrench meets
//! as a change of length, both to rounding. What acts within a step is taken by Gauss collocation.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::{GAUSS_3, Mat3, Pose, Vec3};

use super::effect::{Effect, Forcing};
use super::elimination::StepPull;
use super::forward::{Maps, StepMap};
use super::magnus::{LaneTwist, end_by_twists};
use super::replay::{Answer, Stage};
use crate::section::Fault;
use crate::section::lanes::{LANES, Lane, LaneMat};
use crate::section::{BodyWrench, Strain, Tangent, equilibrium};
use crate::statics::grid::{Grid, SHOOTING_NODES, Step};
use crate::statics::lanes::run::linearize_run;

/// Sections of a step.
pub(super) const POINTS: usize = 3;

/// Matrix of the Gauss collocation: what the slope at each node adds up to at each other.
const COLLOCATION: [[f64; 3]; 3] = [
    [5.0 / 36.0, 2.0 / 9.0 - ROOT / 15.0, 5.0 / 36.0 - ROOT / 30.0],
    [5.0 / 36.0 + ROOT / 24.0, 2.0 / 9.0, 5.0 / 36.0 - ROOT / 24.0],
    [5.0 / 36.0 + ROOT / 30.0, 2.0 / 9.0 + ROOT / 15.0, 5.0 / 36.0],
];
/// √15.
const ROOT: f64 = 3.872_983_346_207_417;

/// A section at a Gauss node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Point {
    pub strain: Strain,
    /// `H⁻¹`: `∂v/∂N`, `∂v/∂M` and `∂u/∂M`.
    pub compliance: [Mat3; 3],
    /// `J`, base frame: how the end of the step turns with `δu`, which is how it is displaced with
    /// `δv`; and how it is displaced with `δu`.
    pub turn: Mat3,
    pub shift: Mat3,
    /// `hb`.
    pub weight: f64,
    /// Whether section and strain are those at the point before.
    pub repeats: bool,
}

/// All sections of a rod without load.
#[derive(Clone, Debug, Default)]
pub(super) struct Quadrature {
    /// Three to each step.
    pub points: Vec<Point>,
    /// What a unit tension of each cable exerts at each of them, and its stretch; by points, then
    /// cables.
    pub pulls: Vec<(BodyWrench, f64)>,
    /// From start to end of each step, base frame.
    shifts: Vec<Vec3>,
    /// Maps of the steps, until [`Self::compute`] hands them on.
    steps: Vec<StepMap>,
    /// Sections just behind each node, and at the tip in front of it.
    pub nodes: Vec<Stage>,
    pub node_pulls: Vec<(BodyWrench, f64)>,
}

impl Quadrature {
    /// Linearises an answer whose strains are those at the Gauss nodes.
    pub fn run(&mut self, answer: &Answer<'_>) -> Result<(), Fault> {
        let Answer { grid, tensions, poses, .. } = *answer;
        self.linearize_points(answer)?;
        self.shifts.clear();
        self.shifts.extend(poses.windows(2).map(|pair| pair[1].position - pair[0].position));
        self.steps.clear();
        self.steps.reserve(grid.len());
        Arch::new().dispatch(AllSteps { rod: self, steps: &grid.steps });
        self.add_nodes(grid, tensions, poses)
    }

    /// The sections at the Gauss nodes, and how the ends of their steps move with them.
    pub fn linearize_points(&mut self, answer: &Answer<'_>) -> Result<(), Fault> {
        let Answer { grid, poses, .. } = *answer;
        Arch::new().dispatch(AllSections { rod: self, answer })?;
        Arch::new().dispatch(AllPoints { rod: self, steps: &grid.steps, poses });
        Ok(())
    }

    #[inline(always)]
    fn linearize_sections<S: Simd>(&mut self, simd: S, answer: &Answer<'_>) -> Result<(), Fault> {
        let Answer { grid, tensions, strains, .. } = *answer;
        let cables = tensions.len();
        let Self { points, pulls, .. } = self;
        points.clear();
        points.resize(POINTS * grid.len(), Point::default());
        pulls.clear();
        pulls.resize(POINTS * grid.len() * cables, Default::default());
        let fault = |at: usize, kind| {
            let step = &grid.steps[at / POINTS];
            Fault { kind, arc_length: step.start + GAUSS_3.nodes[at % POINTS] * step.length }
        };
        for run in grid.gauss.runs.iter() {
            let active = &tensions[..run.sections.cables];
            let take = |at: usize, compliance| points[at].compliance = compliance;
            linearize_run(simd, run, active, strains, (pulls, cables), take)
                .map_err(|(at, kind)| fault(at, kind))?;
        }
        for (k, step) in grid.steps.iter().enumerate() {
            let active = &tensions[..step.active];
            for j in 0..POINTS {
                let at = POINTS * k + j;
                let strain = strains[at];
                let weight = GAUSS_3.weights[j] * step.length;
                if grid.gauss.is_in_run(at) {
                    (points[at].strain, points[at].weight) = (strain, weight);
                    continue;
                }
                // A section that is the same as the one before, and strained as it is, has the same tangent.
                if grid.gauss.repeats(k, j) && at > 0 && points[at - 1].strain == strain {
                    pulls.copy_within((at - 1) * cables..at * cables, at * cables);
                    points[at] = Point { weight, repeats: true, ..points[at - 1] };
                    continue;
                }
                let (node, crossings) = grid.gauss.at(k, j, step.active);
                let in_groups = (crossings, grid.gauss.groups(k, j, step.active));
                let tangent = Tangent::by_groups(&node.section, in_groups, active, &strain)
                    .map_err(|kind| fault(at, kind))?;
                for (pull, crossing) in pulls[at * cables..].iter_mut().zip(crossings) {
                    *pull = crossing.pull(&strain);
                }
                let compliance = tangent.compliance();
                points[at] = Point { strain, compliance, weight, ..Point::default() };
            }
        }
        Ok(())
    }

    /// The sections at the nodes, from the strains next to them.
    fn add_nodes(&mut self, grid: &Grid, tensions: &[f64], poses: &[Pose]) -> Result<(), Fault> {
        let cables = tensions.len();
        self.nodes.clear();
        self.nodes.reserve(grid.len() + 1);
        self.node_pulls.clear();
        self.node_pulls.resize((grid.len() + 1) * cables, Default::default());
        for (node, pose) in poses.iter().enumerate() {
            let tip = node == grid.len();
            let k = if tip { grid.len() - 1 } else { node };
            let (place, near) =
                if tip { (SHOOTING_NODES.len() - 1, POINTS * k + 2) } else { (0, POINTS * k) };
            let step = &grid.steps[k];
            let (at, crossings) = grid.shooting.at(k, place, step.active);
            let active = &tensions[..step.active];
            let fault =
                |kind| Fault { kind, arc_length: step.start + SHOOTING_NODES[place] * step.length };
            let mut strain = self.points[near].strain;
            equilibrium(&at.section, crossings, active, BodyWrench::default(), &mut strain)
                .map_err(fault)?;
            let tangent = Tangent::at(&at.section, crossings, active, &strain).map_err(fault)?;
            let pulls = &mut self.node_pulls[node * cables..];
            for (pull, crossing) in pulls.iter_mut().zip(crossings) {
                *pull = crossing.pull(&strain);
            }
            self.nodes.push(Stage {
                strain,
                rotation: pose.rotation.to_matrix(),
                compliance: tangent.compliance(),
                ..Stage::default()
            });
        }
        Ok(())
    }

    /// Maps of every step, see [`Maps::compute`].
    pub fn compute(
        &mut self,
        maps: &mut Maps,
        steps: &[Step],
        cables: usize,
        more: usize,
        forcing: &dyn Fn(usize, usize, usize) -> Forcing,
    ) {
        maps.prepare(steps.len(), cables, more, cables);
        core::mem::swap(&mut maps.steps, &mut self.steps);
        let inputs = cables + more;
        for (k, step) in steps.iter().enumerate() {
            let arm = self.shifts[k];
            for i in 0..POINTS {
                let at = POINTS * k + i;
                let point = &self.points[at];
                let pulls = &self.pulls[at * cables..][..step.active];
                for (cable, (pull, _)) in pulls.iter().enumerate() {
                    let yielding = point.yielding(pull.linear, pull.angular);
                    let Strain { linear: v, angular: u } = yielding;
                    let (turn, shift) = (point.turn * u, point.shift * u + point.turn * v);
                    // A wrench at the start and the moment that its force has at the end.
                    let rates = &mut maps.length_by_state[k * cables + cable];
                    rates[1] += turn;
                    rates[2] += shift + arm.cross(turn);
                    let effect = &mut maps.effects[k * inputs + cable];
                    effect.turn -= turn;
                    effect.shift -= shift;
                    for (other, (pull, _)) in pulls.iter().enumerate() {
                        let work = pull.linear.dot(v) + pull.angular.dot(u);
                        maps.length_by_input[(k * inputs + cable) * cables + other] -=
                            point.weight * work;
                    }
                }
            }
            for input in 0..more {
                let forcings = [0, 1, 2].map(|i| forcing(k, i, input));
                let (effect, strains) = self.forced(k, step.length, &forcings);
                maps.effects[k * inputs + cables + input] = effect;
                for (i, strain) in strains.iter().enumerate() {
                    let at = POINTS * k + i;
                    let pulls = &self.pulls[at * cables..][..step.active];
                    for (cable, (pull, _)) in pulls.iter().enumerate() {
                        let work =
                            pull.linear.dot(strain.linear) + pull.angular.dot(strain.angular);
                        maps.length_by_input[(k * inputs + cables + input) * cables + cable] +=
                            self.points[at].weight * work;
                    }
                }
            }
        }
    }

    /// What forcings do to a step and to the strains at its nodes.
    fn forced(&self, k: usize, h: f64, forcings: &[Forcing; POINTS]) -> (Effect, [Strain; POINTS]) {
        let mut effect = Effect::default();
        let points = &self.points[POINTS * k..POINTS * (k + 1)];
        let mut forces = forcings.map(|f| f.force);
        let mut torques = [Vec3::ZERO; POINTS];
        for i in 0..POINTS {
            for j in 0..POINTS {
                forces[i] += h * COLLOCATION[i][j] * forcings[j].rate;
            }
            torques[i] = forces[i].cross(points[i].velocity()) + forcings[i].torque;
            effect.moment += points[i].weight * torques[i];
            effect.force += points[i].weight * forcings[i].rate;
        }
        let mut strains = [Strain::default(); POINTS];
        for (i, point) in points.iter().enumerate() {
            let mut moment = Vec3::ZERO;
            for (torque, a) in torques.iter().zip(COLLOCATION[i]) {
                moment += h * a * *torque;
            }
            let n = point.in_body(forces[i]) - forcings[i].force_balance;
            let m = point.in_body(moment) - forcings[i].moment_balance;
            strains[i] = point.yielding(n, m);
            let Strain { linear: v, angular: u } = strains[i];
            effect.turn += point.turn * u;
            effect.shift += point.shift * u + point.turn * v;
        }
        (effect, strains)
    }

    /// The transpose of [`Self::compute`]: sensitivities to the forcing at every node, see
    /// [`super::adjoint`].
    pub fn stage_pulls(
        &self,
        steps: &[Step],
        pulls: &[StepPull],
        lengths: &[f64],
        out: &mut Vec<Forcing>,
    ) {
        out.clear();
        out.resize(POINTS * steps.len(), Forcing::default());
        let cables = lengths.len();
        for (k, (step, pull)) in steps.iter().zip(pulls).enumerate() {
            let (h, points) = (step.length, &self.points[POINTS * k..POINTS * (k + 1)]);
            let out = &mut out[POINTS * k..POINTS * (k + 1)];
            let Effect { turn, moment, shift, force } = pull.effect;
            let mut moments = [Vec3::ZERO; POINTS];
            for (i, point) in points.iter().enumerate() {
                let mut u = point.turn.transpose_mul(turn) + point.shift.transpose_mul(shift);
                let mut v = point.turn.transpose_mul(shift);
                let exerted = &self.pulls[(POINTS * k + i) * cables..][..step.active];
                for ((exerted, _), length) in exerted.iter().zip(lengths) {
                    v += point.weight * length * exerted.linear;
                    u += point.weight * length * exerted.angular;
                }
                let Strain { linear: n, angular: m } = point.yielding(v, u);
                (out[i].force_balance, out[i].moment_balance) = (-n, -m);
                out[i].force = point.in_base(n);
                moments[i] = point.in_base(m);
            }
            for (i, point) in points.iter().enumerate() {
                let mut torque = point.weight * moment;
                for (j, moment) in moments.iter().enumerate() {
                    torque += h * COLLOCATION[j][i] * *moment;
                }
                out[i].torque = torque;
                out[i].force += point.velocity().cross(torque);
            }
            for i in 0..POINTS {
                let mut rate = points[i].weight * force;
                for j in 0..POINTS {
                    rate += h * COLLOCATION[j][i] * out[j].force;
                }
                out[i].rate = rate;
            }
        }
    }

    /// How the section at a point is turned, to the order of the collocation.
    pub fn rotation(&self, at: usize) -> Mat3 {
        let point = &self.points[at];
        let row = |i: usize| point.turn.rows[i] * (1.0 / point.weight);
        Mat3::from_rows(row(0), row(1), row(2))
    }
}

impl Point {
    /// `H⁻¹ (n, m)`.
    #[inline]
    fn yielding(&self, n: Vec3, m: Vec3) -> Strain {
        let [vn, vm, um] = &self.compliance;
        Strain { linear: *vn * n + *vm * m, angular: vm.transpose_mul(n) + *um * m }
    }

    /// From the base frame to that of the section, as the step has it.
    fn in_body(&self, x: Vec3) -> Vec3 {
        self.turn.transpose_mul(x) * (1.0 / self.weight)
    }

    fn in_base(&self, x: Vec3) -> Vec3 {
        self.turn * x * (1.0 / self.weight)
    }

    /// `p′`.
    fn velocity(&self) -> Vec3 {
        self.in_base(self.strain.linear)
    }
}

/// [`Quadrature::linearize_sections`] with the instructions that the processor has.
struct AllSections<'a> {
    rod: &'a mut Quadrature,
    answer: &'a Answer<'a>,
}

impl WithSimd for AllSections<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.rod.linearize_sections(simd, self.answer)
    }
}

/// How the ends of all steps move with their points, a few steps at a time, compiled for each set of vector instructions.
struct AllPoints<'a> {
    rod: &'a mut Quadrature,
    steps: &'a [Step],
    poses: &'a [Pose],
}

impl WithSimd for AllPoints<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { rod, steps, poses } = self;
        for first in (0..steps.len()).step_by(LANES) {
            let count = LANES.min(steps.len() - first);
            let mut twists = [LaneTwist::default(); POINTS];
            let (mut length, mut end) = (Lane::default(), LaneMat::default());
            for lane in 0..count {
                let k = first + lane;
                let h = steps[k].length;
                length.0[lane] = h;
                end.set(lane, &poses[k + 1].rotation.to_matrix());
                for (twist, point) in twists.iter_mut().zip(&rod.points[POINTS * k..]) {
                    twist.linear.set(lane, h * point.strain.linear);
                    twist.angular.set(lane, h * point.strain.angular);
                }
            }
            let motions = end_by_twists(&twists, length, &end);
            for lane in 0..count {
                let k = first + lane;
                for (motion, point) in motions.iter().zip(&mut rod.points[POINTS * k..]) {
                    point.turn = motion.turn.get(lane);
                    point.shift = motion.shift.get(lane);
                }
            }
        }
    }
}

/// The maps of all steps likewise.
struct AllSteps<'a> {
    rod: &'a mut Quadrature,
    steps: &'a [Step],
}

impl WithSimd for AllSteps<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { rod, steps } = self;
        for first in (0..steps.len()).step_by(LANES) {
            let count = LANES.min(steps.len() - first);
            let sums = yielding(rod, first, count);
            for lane in 0..count {
                let [turn, mixed, shift] = sums.map(|m| m.get(lane));
                rod.steps.push(step_map(rod.shifts[first + lane], &turn, &mixed, &shift));
            }
        }
    }
}

/// `Σ J H⁻¹ Jᵀ/hb` of a few steps: how the end turns with the moment at the end, how it is displaced
/// with it, and how it is displaced with the force.
#[inline(always)]
fn yielding(rod: &Quadrature, first: usize, count: usize) -> [LaneMat; 3] {
    let mut sums = [LaneMat::default(); 3];
    for i in 0..POINTS {
        let (mut vn, mut vm, mut um) = (LaneMat::default(), LaneMat::default(), LaneMat::default());
        let (mut turn, mut shift) = (LaneMat::default(), LaneMat::default());
        let mut inverse = Lane::default();
        for lane in 0..count {
            let point = &rod.points[POINTS * (first + lane) + i];
            inverse.0[lane] = 1.0 / point.weight;
            vn.set(lane, &point.compliance[0]);
            vm.set(lane, &point.compliance[1]);
            um.set(lane, &point.compliance[2]);
            turn.set(lane, &point.turn);
            shift.set(lane, &point.shift);
        }
        let weighted = turn.scaled(inverse);
        let by_moment = shift.times(&um) + turn.times(&vm);
        let by_force = shift.times_transpose(&vm) + turn.times(&vn);
        sums[0] = sums[0] + turn.times(&um).times_transpose(&weighted);
        sums[1] = sums[1] + by_moment.times_transpose(&weighted);
        sums[2] = sums[2]
            + by_moment.times_transpose(&shift).scaled(inverse)
            + by_force.times_transpose(&weighted);
    }
    sums
}

/// The map of a step from what its end does with a wrench there; `arm` leads from start to end.
fn step_map(arm: Vec3, turn: &Mat3, mixed: &Mat3, shift: &Mat3) -> StepMap {
    // `F × arm`.
    let moment = -Mat3::skew(arm);
    StepMap {
        turn: [Mat3::IDENTITY, *turn, mixed.transpose() + *turn * moment],
        moment: [Mat3::ZERO, Mat3::IDENTITY, moment],
        shift: [moment, *mixed, *shift + *mixed * moment],
        force: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collocation_is_exact_to_its_degree() {
        for (i, row) in COLLOCATION.iter().enumerate() {
            for power in 0..3 {
                let sum: f64 = row.iter().zip(GAUSS_3.nodes).map(|(a, c)| a * c.powi(power)).sum();
                let exact = GAUSS_3.nodes[i].powi(power + 1) / f64::from(power + 1);
                assert!((sum - exact).abs() < 1e-15, "{i} {power}");
            }
        }
    }
}
