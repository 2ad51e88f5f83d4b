//! Multiple shooting under dead loads, for given tensions.
//!
//! A single shot from the base magnifies the error of the base moment by about `exp(L √(F/EI))`:
//! under strong loads none hits the tip. Here every step is shot from its own start `(Rₖ, Mₖ)`, and
//! Newton's method closes the gaps between them. With the transition `Φ` of a step from eq. (5) a
//! correction `(ηₖ, μₖ)` obeys
//!
//! ```text
//! ηₖ₊₁ = Φ_ηη ηₖ + Φ_ημ μₖ + gap_η,   μₖ₊₁ = Φ_μη ηₖ + Φ_μμ μₖ + gap_μ,   η₀ = 0,   μₙ = 0        (10)
//! ```
//!
//! Elimination from the base carries `ηₖ = Pₖ μₖ + qₖ`: `Pₖ` is the compliance of the part before
//! node k, bounded as long as no such part buckles under its own load.

use whipcord_numerics::{Mat3, Pose, UnitQuaternion, Vec3};

use super::grid::Grid;
use super::loaded::{Aim, Shot};
use super::loads::AppliedLoads;
use super::newton::Scales;
use super::sensitivity::{Sensitivity, Transition};
use super::unloaded::Fault;

/// The rod as a chain of steps, each with its own start.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub nodes: Vec<Node>,
    kept: Vec<Node>,
    gaps: Vec<Gap>,
    eliminated: Vec<Eliminated>,
    changes: Vec<Node>,
    sensitivity: Sensitivity,
}

/// Where a step starts; or, with `turn` for `rotation`, how that changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub rotation: UnitQuaternion,
    /// In the body frame, in N·m.
    pub moment: Vec3,
    turn: Vec3,
}

/// How a step ends short of the next node.
#[derive(Clone, Copy, Debug, Default)]
struct Gap {
    turn: Vec3,
    moment: Vec3,
    displacement: Vec3,
    transition: Transition,
}

/// `μₖ = gain (μₖ₊₁ − offset)` and `ηₖ = compliance μₖ + turn`.
#[derive(Clone, Copy, Debug, Default)]
struct Eliminated {
    gain: Mat3,
    offset: Vec3,
    compliance: Mat3,
    turn: Vec3,
}

/// What the chain is solved for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub grid: &'a Grid,
    pub loads: &'a AppliedLoads,
    pub tensions: &'a [f64],
    pub load: f64,
    /// Length of the backbone in m.
    pub length: f64,
    /// Greatest gap that counts as closed, relative to 1 rad and the scale of moments.
    pub tolerance: f64,
}

/// Why the gaps did not close.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub iterations: usize,
    pub gap: f64,
    pub fault: Option<Fault>,
}

const MAX_ITERATIONS: usize = 40;
const LEAST_FRACTION: f64 = 1.0 / 64.0;
/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e-9;

impl Chain {
    /// Starts from a shape that carries no load.
    pub fn start(&mut self, poses: &[Pose]) {
        self.nodes.clear();
        let unloaded = |pose: &Pose| Node { rotation: pose.rotation, ..Node::default() };
        self.nodes.extend(poses.iter().map(unloaded));
    }

    /// Starts from the nodes of a chain with half as many steps.
    pub fn start_halved(&mut self, coarse: &[Node]) {
        self.nodes.clear();
        for pair in coarse.windows(2) {
            let turn = (pair[0].rotation.conjugate() * pair[1].rotation).log();
            let rotation = pair[0].rotation * UnitQuaternion::exp(0.5 * turn);
            let moment = 0.5 * (pair[0].moment + pair[1].moment);
            self.nodes.extend([pair[0], Node { rotation, moment, ..Node::default() }]);
        }
        self.nodes.extend(coarse.last());
    }

    /// Newton's method; returns the iterations and the greatest gap left. The shot ends with the
    /// strains and samples of the answer.
    pub fn close(&mut self, task: &Task<'_>, shot: &mut Shot) -> Result<(usize, f64), Open> {
        let failed = |iterations, gap, fault| Open { iterations, gap, fault };
        let mut gap =
            self.shoot(task, shot).map_err(|fault| failed(0, f64::INFINITY, Some(fault)))?;
        for iteration in 0..MAX_ITERATIONS {
            if gap <= task.tolerance {
                return Ok((iteration, gap));
            }
            if !self.solve_step() {
                return Err(failed(iteration, gap, None));
            }
            self.kept.clone_from(&self.nodes);
            let mut fraction = 1.0;
            loop {
                self.step(fraction);
                match self.shoot(task, shot) {
                    Ok(now) if now < (1.0 - 1e-4 * fraction) * gap => {
                        gap = now;
                        break;
                    }
                    Ok(now) if fraction == 1.0 && now.max(gap) <= ROUNDING => {
                        return Ok((iteration + 1, now));
                    }
                    outcome => {
                        fraction *= 0.5;
                        if fraction < LEAST_FRACTION {
                            return Err(failed(iteration + 1, gap, outcome.err()));
                        }
                    }
                }
            }
        }
        Err(failed(MAX_ITERATIONS, gap, None))
    }

    /// Frames at the ends of all steps of a closed chain.
    pub fn poses(&self, poses: &mut Vec<Pose>) {
        poses.clear();
        let mut position = Vec3::ZERO;
        for (node, gap) in self.nodes.iter().zip(&self.gaps) {
            poses.push(Pose { position, rotation: node.rotation });
            position += gap.displacement;
        }
        if let Some(last) = self.nodes.last() {
            poses.push(Pose { position, rotation: last.rotation });
        }
    }

    /// Shoots every step from its node; the greatest gap.
    fn shoot(&mut self, task: &Task<'_>, shot: &mut Shot) -> Result<f64, Fault> {
        let scale = Scales::of(task.grid, task.length).moment;
        let aim = Aim {
            tensions: task.tensions,
            base_moment: Vec3::ZERO,
            follower_force: Vec3::ZERO,
            load: task.load,
            sample: true,
        };
        shot.samples.clear();
        self.gaps.clear();
        let mut greatest: f64 = 0.0;
        for k in 0..task.grid.len() {
            let (start, next) = (self.nodes[k], self.nodes[k + 1]);
            let moment = start.rotation.rotate(start.moment);
            let (end, moment) =
                shot.fire_step(task.grid, task.loads, &aim, k, start.rotation, moment)?;
            let to_body = end.rotation.conjugate();
            let applied = to_body.rotate(task.load * task.loads.moment(k + 1));
            let samples = &shot.samples[3 * k..3 * k + 3];
            let gap = Gap {
                turn: (next.rotation.conjugate() * end.rotation).log(),
                moment: to_body.rotate(moment) - applied - next.moment,
                displacement: end.position,
                transition: self.sensitivity.transition(task.grid, k, samples, applied),
            };
            let relative = gap.moment.norm() / (scale + next.moment.norm());
            greatest = greatest.max(gap.turn.norm()).max(relative);
            // A NaN must not pass for a closed gap.
            if !(gap.turn.is_finite() && gap.moment.is_finite()) {
                greatest = f64::INFINITY;
            }
            self.gaps.push(gap);
        }
        Ok(greatest)
    }

    /// Solves eq. (10) for the change of every node; `false` where the elimination breaks down.
    fn solve_step(&mut self) -> bool {
        self.eliminated.clear();
        let (mut compliance, mut turn) = (Mat3::ZERO, Vec3::ZERO);
        for gap in &self.gaps {
            let [[turn_turn, turn_moment], [moment_turn, moment_moment]] = gap.transition;
            let Some(gain) = (moment_turn * compliance + moment_moment).inverse() else {
                return false;
            };
            let offset = moment_turn * turn + gap.moment;
            self.eliminated.push(Eliminated { gain, offset, compliance, turn });
            let next = (turn_turn * compliance + turn_moment) * gain;
            turn = turn_turn * turn + gap.turn - next * offset;
            compliance = next;
        }
        self.changes.clear();
        // No moment is left at the tip, so that its node does not change but in rotation.
        let mut moment = Vec3::ZERO;
        self.changes.push(Node { turn, ..Node::default() });
        for step in self.eliminated.iter().rev() {
            moment = step.gain * (moment - step.offset);
            let turn = step.compliance * moment + step.turn;
            self.changes.push(Node { moment, turn, ..Node::default() });
        }
        self.changes.reverse();
        self.changes.iter().all(|change| change.turn.is_finite() && change.moment.is_finite())
    }

    /// Moves every node this fraction of its change away from where it was kept.
    fn step(&mut self, fraction: f64) {
        for ((node, kept), change) in self.nodes.iter_mut().zip(&self.kept).zip(&self.changes) {
            node.rotation =
                (kept.rotation * UnitQuaternion::exp(fraction * change.turn)).renormalized();
            node.moment = kept.moment + fraction * change.moment;
        }
    }
}
