//! The steps of an answer once more, with the linear map of every stage.
//!
//! A stage of the Runge–Kutta method of `cosserat` takes a quaternion, scaled back to
//! norm 1 by one Newton step, and a moment; solves the section; and returns slopes. Each of these
//! maps is differentiated as it is computed, so that what comes out is the derivative of the
//! discrete solution, not a discretisation of the derivative.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::{BUTCHER_5, Mat3, Pose, UnitQuaternion, Vec3};

use super::effect::Forcing;
use super::node_change::NodeChange;
use super::strands::{PLACES, Strands};
use crate::section::Fault;
use crate::section::{BodyWrench, Crossing, Strain, Tangent, equilibrium};
use crate::shape::Wrench;
use crate::statics::grid::Grid;
use crate::statics::loads::{AppliedLoads, Line};
use crate::statics::runge_kutta::{NODE_OF_STAGE, STAGES, State, advance, pack, unpack};
use whipcord_numerics::weighted_sum;

/// The place of [`crate::statics::grid::SHOOTING_NODES`] at the end of a step.
const LAST_NODE: usize = 4;
/// The stage in the middle of a step at which the directions of cables are taken.
const MIDDLE: usize = 3;

/// The linear map of one stage at the answer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stage {
    pub strain: Strain,
    pub turned: Turned,
    /// How `N`, `Mᵦ` and `p′` turn.
    pub force_swing: Swing,
    pub moment_swing: Swing,
    pub velocity_swing: Swing,
    /// `R`, as the stage has it.
    pub rotation: Mat3,
    /// `F` in the base frame.
    pub force: Vec3,
    /// `M` in the base frame.
    pub moment: Vec3,
    /// `p′`.
    pub velocity: Vec3,
    /// `H⁻¹`: `∂v/∂N`, `∂v/∂M` and `∂u/∂M`.
    pub compliance: [Mat3; 3],
}

/// The quaternion `q` of a stage and how it is scaled back to `q̂ = f q`, `f = (3 − |q|²)/2`.
///
/// With `(s, y) = q* ∘ δq` its frame turns by `η = 2 y/|q|²` in the body frame, and grows by
/// `σ = 2 s (f − |q|²)/(f |q|²)`, which is what the scaling leaves of a change of norm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turned {
    pub quaternion: UnitQuaternion,
    /// `f`.
    pub scale: f64,
    /// `f/|q|²`.
    pub ratio: f64,
    /// `1 − |q̂|²`.
    pub short: f64,
    /// `η/y` and `σ/s`.
    turn: f64,
    growth: f64,
}

/// How a vector turns with `(s, y)`: `∂(Rᵀ a) = arm × y + s rest` of one that is given in the base
/// frame, `∂(R x) = (R − (1 − |q̂|²) I)(y × arm) + s rest` of one of the body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swing {
    pub arm: Vec3,
    pub rest: Vec3,
}

impl Turned {
    fn new(&[w, x, y, z, ..]: &State) -> Self {
        let quaternion = UnitQuaternion { w, v: Vec3::new(x, y, z) };
        let squared = w * w + quaternion.v.norm_squared();
        let scale = 1.5 - 0.5 * squared;
        Self {
            quaternion,
            scale,
            ratio: scale / squared,
            short: 1.0 - scale * scale * squared,
            turn: 2.0 / squared,
            growth: 2.0 * (scale - squared) / (scale * squared),
        }
    }

    /// Of a vector of the base frame, which is `to_body` in that of the section.
    fn swing_to_body(&self, to_body: Vec3, given: Vec3) -> Swing {
        Swing {
            arm: self.turn * (to_body - self.short * given),
            rest: self.growth * (to_body - given),
        }
    }

    /// Of a vector of the body, which is `to_base` in the base frame.
    fn swing_to_base(&self, to_base: Vec3, given: Vec3) -> Swing {
        Swing { arm: self.turn * given, rest: self.growth * (to_base - given) }
    }
}

/// What turns with the section and is spread along a step, at one stage: its force and moment per
/// metre.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    pub force: Swing,
    pub moment: Swing,
}

/// Where a step starts and ends.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    /// `∂q` at the start by a turn of the start about each axis of the base frame.
    pub start_by_turn: [[f64; 4]; 3],
    /// Quaternion of the end before it is scaled back, and how it is: the turn of the end in the base
    /// frame is `2 f² (δq ∘ q*)`.
    pub quaternion: UnitQuaternion,
    pub turn: f64,
    /// Frame at the end.
    pub pose: Pose,
    /// Force in the base frame just before the end.
    pub force: Vec3,
    /// Moment in the base frame just before the end.
    pub moment: Vec3,
}

/// All stages of an answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Replay {
    /// Six to each step.
    pub stages: Vec<Stage>,
    /// What a unit tension of each cable exerts at each stage, and its stretch; by stages, then
    /// cables.
    pub pulls: Vec<(BodyWrench, f64)>,
    /// By steps; `None` where no follower is spread.
    spread: Vec<Option<[Spread; STAGES]>>,
    pub ends: Vec<Ends>,
    /// By stages the weights of the inputs that are tensions; empty where they are 1.
    weights: Vec<f64>,
    /// By stages where the angles by which cables turn hang on them, with the outputs of their steps; empty where no cable rubs.
    turns: Vec<Vec<TurnOutput>>,
    /// Moment in the base frame at the base.
    pub base_moment: Vec3,
    /// Force in the base frame at the base.
    pub base_force: Vec3,
}

/// An output of a step that hangs on one of its stages.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurnOutput {
    pub row: usize,
    pub by: TurnRates,
    /// How it changes with `p′` of the cable at constant strain and frame.
    pub tangent: Vec3,
}

/// How an angle changes with strain, curvature and the turn `(s, y)` of a stage.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TurnRates {
    pub strain: Vec3,
    pub curvature: Vec3,
    pub y: Vec3,
    pub s: f64,
}

/// The tensions of an answer whose cables rub along their curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Varying<'a> {
    /// At all shooting nodes in turn, by cables.
    pub tensions: &'a [f64],
    pub strands: &'a Strands,
    /// How the turn on the way to a cable's middle in a step changes with the directions of the cable in the middle of the step before,
    /// and at start and middle of its own; by steps, then cables. `None` where the cable does not rub.
    pub slopes: &'a [Option<[Vec3; 3]>],
}

/// The answer that is gone over.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer<'a> {
    pub grid: &'a Grid,
    pub loads: &'a AppliedLoads,
    pub tensions: &'a [f64],
    /// Frames at the ends of all steps.
    pub poses: &'a [Pose],
    pub base_moment: Vec3,
    /// Force of the followers at the base.
    pub follower_force: Vec3,
    /// Moment, and force beyond that of the dead loads, in the base frame at the start of each step, where the answer has
    /// them; elsewhere both are integrated. Empty where it has none.
    pub starts: &'a [Option<Wrench>],
    /// Strains to start the sections from, six to a step; where there are none each starts from its
    /// neighbour.
    pub strains: &'a [Strain],
    /// Whether these strains are in equilibrium with the starts.
    pub are_strains_met: bool,
    pub varying: Option<Varying<'a>>,
}

impl Answer<'_> {
    /// Tensions of the first `active` cables at a place of a step.
    pub(super) fn tensions_at(&self, k: usize, place: usize, active: usize) -> &[f64] {
        match &self.varying {
            Some(varying) => {
                &varying.tensions[self.tensions.len() * (PLACES * k + place)..][..active]
            }
            None => &self.tensions[..active],
        }
    }
}

/// [`Replay::run`].
struct Run<'a, 'b> {
    replay: &'a mut Replay,
    answer: &'a Answer<'b>,
}

impl WithSimd for Run<'_, '_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.replay.go_over(self.answer)
    }
}

impl Replay {
    /// Goes over the answer, with the instructions that the processor has; none of them fuses operations, so that all give the
    /// same bits.
    pub fn run(&mut self, answer: &Answer<'_>) -> Result<(), Fault> {
        Arch::new().dispatch(Run { replay: self, answer })
    }

    #[inline(always)]
    fn go_over(&mut self, answer: &Answer<'_>) -> Result<(), Fault> {
        let Answer { grid, loads, tensions, .. } = *answer;
        self.weights.clear();
        self.turns.clear();
        let cables = tensions.len();
        self.stages.clear();
        self.stages.reserve(STAGES * grid.len() + 1);
        self.pulls.clear();
        self.pulls.resize(STAGES * grid.len() * cables, Default::default());
        self.ends.clear();
        self.spread.clear();
        self.base_moment = answer.base_moment;
        self.base_force = loads.base_force() + answer.follower_force;
        let known = answer.strains.len() == STAGES * grid.len();
        let met = known && answer.are_strains_met;
        self.stages.resize(STAGES * grid.len(), Stage::default());
        let mut strain = grid.shooting.at(0, 0, 0).0.section.rest_strain();
        let mut moment = answer.base_moment;
        let mut follower_force = answer.follower_force;
        for k in 0..grid.len() {
            if let Some(Some(start)) = answer.starts.get(k) {
                (moment, follower_force) = (start.moment, start.force);
            }
            let step = grid.steps[k];
            let h = step.length;
            let rotation = answer.poses[k].rotation;
            let start = pack(rotation, answer.poses[k].position, moment);
            let mut slopes = [[0.0; 10]; STAGES];
            let line = loads.line(k);
            let follows = line.is_some_and(Line::follows);
            let mut pushes = [Vec3::ZERO; STAGES];
            let mut spread = [Spread::default(); STAGES];
            for i in 0..STAGES {
                let stage = advance(&start, &slopes[..i], &BUTCHER_5.a[i], h);
                let (node, crossings) = grid.shooting.at(k, NODE_OF_STAGE[i], step.active);
                let active = answer.tensions_at(k, NODE_OF_STAGE[i], step.active);
                let mut force = loads.force(k, NODE_OF_STAGE[i]) + follower_force;
                if follows {
                    force -= h * weighted_sum(&pushes[..i], &BUTCHER_5.a[i]);
                }
                let (turned, _, moment) = unpack(&stage);
                let r = turned.to_matrix();
                let wrench =
                    BodyWrench { linear: r.transpose_mul(force), angular: r.transpose_mul(moment) };
                if known {
                    strain = answer.strains[STAGES * k + i];
                }
                let fault = |kind| Fault { kind, arc_length: step.start + BUTCHER_5.c[i] * h };
                if !met {
                    equilibrium(&node.section, crossings, active, wrench, &mut strain)
                        .map_err(fault)?;
                }
                let tangent =
                    Tangent::at(&node.section, crossings, active, &strain).map_err(fault)?;
                let place = (STAGES * k + i) * cables;
                for (pull, crossing) in self.pulls[place..].iter_mut().zip(crossings) {
                    *pull = crossing.pull(&strain);
                }
                let velocity = r * strain.linear;
                let spin = UnitQuaternion { w: 0.0, v: strain.angular * 0.5 };
                let mut torque = force.cross(velocity);
                if let Some(line) = line {
                    let t = BUTCHER_5.c[i];
                    // A dead moment is the same wherever the rod turns.
                    torque -= line.moment(t) + r * line.follower_moment(t);
                    pushes[i] = r * line.follower_force(t);
                }
                slopes[i] = pack(turned * spin, velocity, torque);
                let made = &mut self.stages[STAGES * k + i];
                made.set(strain, Turned::new(&stage), r, (force, moment), &wrench, &tangent);
                if let Some(varying) = &answer.varying {
                    varying.strands.add_weights(k, NODE_OF_STAGE[i], &mut self.weights);
                    let made = &self.stages[STAGES * k + i];
                    self.turns.push(turn_outputs(made, crossings, varying, (k, i), cables));
                }
                let made = &mut self.stages[STAGES * k + i];
                if let Some(line) = line.filter(|_| follows) {
                    let t = BUTCHER_5.c[i];
                    let swing = |x| made.turned.swing_to_base(r * x, x);
                    spread[i] = Spread {
                        force: swing(line.follower_force(t)),
                        moment: swing(line.follower_moment(t)),
                    };
                }
            }
            if follows {
                follower_force -= h * weighted_sum(&pushes, &BUTCHER_5.b);
            }
            if line.is_some() {
                self.spread.resize(k, None);
                self.spread.push(follows.then_some(spread));
            }
            let end = advance(&start, &slopes, &BUTCHER_5.b, h);
            let (turned, position, arriving) = unpack(&end);
            let force = loads.force(k, LAST_NODE) + follower_force;
            let pose = Pose { position, rotation: turned };
            let mut ends = Ends { pose, force, moment: arriving, ..Ends::default() };
            ends.differentiate(rotation, &end);
            self.ends.push(ends);
            let follower = loads.follower(k + 1);
            follower_force -= turned.rotate(follower.force);
            moment = arriving - loads.moment(k + 1) - turned.rotate(follower.moment);
        }
        self.add_tip(answer, strain)
    }

    /// The section at the tip, with what arrives there, after the stages of the steps.
    fn add_tip(&mut self, answer: &Answer<'_>, mut strain: Strain) -> Result<(), Fault> {
        let Answer { grid, tensions, .. } = *answer;
        let (Some(ends), Some(step)) = (self.ends.last(), grid.steps.last()) else {
            return Ok(());
        };
        let Ends { pose, force, moment, .. } = *ends;
        let (node, crossings) = grid.shooting.at(grid.len() - 1, LAST_NODE, step.active);
        let active = answer.tensions_at(grid.len() - 1, LAST_NODE, step.active);
        let to_body = pose.rotation.conjugate();
        let wrench = BodyWrench { linear: to_body.rotate(force), angular: to_body.rotate(moment) };
        let fault = |kind| Fault { kind, arc_length: step.start + step.length };
        equilibrium(&node.section, crossings, active, wrench, &mut strain).map_err(fault)?;
        let tangent = Tangent::at(&node.section, crossings, active, &strain).map_err(fault)?;
        let rotation = pose.rotation.to_matrix();
        let mut made = Stage::default();
        let turned = Turned::new(&pack(pose.rotation, pose.position, moment));
        made.set(strain, turned, rotation, (force, moment), &wrench, &tangent);
        self.stages.push(made);
        let place = self.pulls.len();
        self.pulls.resize(place + tensions.len(), Default::default());
        for (pull, crossing) in self.pulls[place..].iter_mut().zip(crossings) {
            *pull = crossing.pull(&strain);
        }
        Ok(())
    }

    /// The weights of so many tensions at a stage; none where they are 1.
    #[inline]
    pub fn weights_at(&self, stage: usize, tensions: usize) -> Option<&[f64]> {
        self.weights.get(stage * tensions..(stage + 1) * tensions).filter(|of| !of.is_empty())
    }

    /// The outputs of step `k` that hang on its stage `i`.
    #[inline]
    pub fn turns_at(&self, k: usize, i: usize) -> &[TurnOutput] {
        self.turns.get(STAGES * k + i).map_or(&[], |of| of)
    }

    /// What followers spread along a step do at its stages, where there are any.
    #[inline]
    pub fn spread(&self, k: usize) -> Option<&[Spread; STAGES]> {
        self.spread.get(k)?.as_ref()
    }

    /// What unit tensions exert at a stage, and the stretch of each cable.
    #[inline]
    pub fn pulls_at(&self, stage: usize, cables: usize, active: usize) -> &[(BodyWrench, f64)] {
        &self.pulls[stage * cables..stage * cables + active]
    }
}

/// The angles that hang on a stage, the start or the middle of a step.
fn turn_outputs(
    stage: &Stage,
    crossings: &[Crossing],
    varying: &Varying<'_>,
    (k, i): (usize, usize),
    cables: usize,
) -> Vec<TurnOutput> {
    // The direction that the slopes have the start and the middle of a step at.
    let place = match i {
        0 => 1,
        MIDDLE => 2,
        _ => return Vec::new(),
    };
    let mut out = Vec::new();
    for (cable, crossing) in crossings.iter().enumerate() {
        let slopes = |k: usize| varying.slopes.get(k * cables + cable).copied().flatten();
        let mut add = |row: usize, slope: Vec3| {
            let tangent = crossing.tangent(&stage.strain);
            let stretch = tangent.norm();
            let along = tangent * (1.0 / stretch);
            let seen = stage.rotation.transpose_mul(slope);
            let across = (seen - along * along.dot(seen)) * (1.0 / stretch);
            let swing = stage.turned.swing_to_base(stage.rotation * along, along);
            let by = TurnRates {
                strain: across,
                curvature: crossing.offset.cross(across),
                y: swing.arm.cross(seen - stage.turned.short * slope),
                s: swing.rest.dot(slope),
            };
            out.push(TurnOutput { row: row * cables + cable, by, tangent: across });
        };
        if let Some(slopes) = slopes(k) {
            add(1, slopes[place]);
        }
        // The turn on the way to the middle of the next step.
        if i == MIDDLE
            && let Some(next) = slopes(k + 1)
        {
            add(2, next[0]);
        }
    }
    out
}

impl Stage {
    /// Eq. (d1) for a change of the node at which the stage sits.
    pub fn strain_change(&self, node: &NodeChange, forcing: &Forcing) -> Strain {
        let to_body = |x: Vec3| self.rotation.transpose_mul(x);
        // A turn by φ of the base frame is one by −φ of what is given in it.
        let turned = |x: Vec3| to_body(x.cross(node.turn));
        let n = turned(self.force) + to_body(node.force + forcing.force) - forcing.force_balance;
        let m = turned(self.moment) + to_body(node.moment) - forcing.moment_balance;
        let [vn, vm, um] = &self.compliance;
        Strain { linear: *vn * n + *vm * m, angular: vm.transpose_mul(n) + *um * m }
    }

    /// The section of a stage at its answer; `wrench` is the force and moment in its own frame.
    #[inline(always)]
    fn set(
        &mut self,
        strain: Strain,
        turned: Turned,
        rotation: Mat3,
        (force, moment): (Vec3, Vec3),
        wrench: &BodyWrench,
        tangent: &Tangent,
    ) {
        let velocity = rotation * strain.linear;
        self.strain = strain;
        self.turned = turned;
        self.force_swing = turned.swing_to_body(wrench.linear, force);
        self.moment_swing = turned.swing_to_body(wrench.angular, moment);
        self.velocity_swing = turned.swing_to_base(velocity, strain.linear);
        (self.rotation, self.force, self.moment) = (rotation, force, moment);
        (self.velocity, self.compliance) = (velocity, tangent.compliance());
    }
}

impl Ends {
    /// What arrives at the end, in the frame there.
    pub fn wrench_in_body(&self) -> BodyWrench {
        let to_body = self.pose.rotation.conjugate();
        BodyWrench { linear: to_body.rotate(self.force), angular: to_body.rotate(self.moment) }
    }

    fn differentiate(&mut self, start: UnitQuaternion, end: &State) {
        for (column, axis) in self.start_by_turn.iter_mut().zip(AXES) {
            *column = (UnitQuaternion { w: 0.0, v: axis * 0.5 } * start).wxyz();
        }
        // The norm is 1 but for the square of the error of one step.
        let turned = Turned::new(end);
        self.quaternion = turned.quaternion;
        self.turn = 2.0 * turned.scale * turned.scale;
    }
}

pub(super) const AXES: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];
