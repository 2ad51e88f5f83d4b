//! Stability of an equilibrium of the chain under dead loads, eq. (8).
//!
//! A cable at its commanded length without tension is *idle*: it holds the chain where the cables together have a state of
//! self-stress that pulls it ([`crate::statics::self_stress`]), and is slack else.
//!
//! A dead moment `m` has no potential: its tangent has the skew part `½ m·(η₁ × η₂)`, which [`DeadMoments::Symmetric`] leaves out.
//! Bounded by `±½|m||η|²` across `m`, it decides whether there is a verdict.

use super::Linkage;
use super::Workspace;
use super::held::{HeldCable, HoldScratch};
use super::pivots::positive_pivots;
use super::statics::Scratch;
use super::task::{Asked, DeadMoments, Elimination, Task};
use crate::case::Case;
use crate::solution::{Diagnostics, NoStability, Solution, Verdict};
use crate::statics::command::Command;
use crate::statics::eigenvalue::{FAR, INSENSITIVE, REGULARISATION};
use crate::statics::options::StabilityAnalysis;
use crate::statics::self_stress::is_idle;

impl Linkage {
    /// The stability of an answer to a case that was found by other means.
    pub(crate) fn judge(
        &self,
        case: &Case,
        solution: &Solution,
        workspace: &mut Workspace,
    ) -> Result<Verdict, NoStability> {
        self.accept(case, workspace).map_err(|_| NoStability::Undetermined)?;
        let Workspace { scratch, tensions, .. } = &mut *workspace;
        self.start_from(solution, scratch);
        tensions.clear();
        tensions.extend(solution.cables.iter().map(|cable| cable.tension.unwrap_or(0.0)));
        self.stability(case, workspace)
    }

    /// Whether the equilibrium that the workspace holds is stable, or why that is not known. The least eigenvalue of the tangent
    /// is computed where it is asked for, and where it decides.
    pub(super) fn stability(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<Verdict, NoStability> {
        if self.options.stability == StabilityAnalysis::Off {
            return Err(NoStability::NotAsked);
        }
        if case.loads.has_follower() {
            return Err(NoStability::Followers);
        }
        if let Some(rubbing) = &self.friction {
            return self.stability_with_friction(rubbing, workspace);
        }
        let Workspace { scratch, loads, commands, tensions, held, hold, meter, .. } = workspace;
        let task = self.task(loads, tensions, meter);
        self.hold(scratch, &task, commands, (hold, held)).ok_or(NoStability::Undetermined)?;
        scratch.verdict(&task, held, self.options.stability)
    }

    /// The cables that are held at their lengths in an equilibrium. The tangent is left behind.
    pub(super) fn hold(
        &self,
        scratch: &mut Scratch,
        task: &Task<'_>,
        commands: &[Command],
        (memory, held): (&mut HoldScratch, &mut Vec<HeldCable>),
    ) -> Option<()> {
        scratch.linearise(task);
        let end = self.robot.backbone().length;
        let lengths = &scratch.chain.lengths;
        held.clear();
        held.extend(commands.iter().enumerate().filter_map(|(cable, command)| {
            let &Command::Length { compliance, .. } = command else { return None };
            let tension = task.tensions[cable];
            let idle = tension <= 0.0;
            let holds =
                !idle || is_idle(compliance, command.slackness(tension, lengths[cable]), end);
            holds.then_some(HeldCable { cable, compliance, is_idle: idle })
        }));
        if !held.iter().any(|held| held.is_idle) {
            return Some(());
        }
        let mut shift = -1.0;
        let asked = Asked::Responses;
        while scratch.chain.eliminate(task, Elimination { shift, asked })? > 0 && shift > -FAR {
            shift *= 4.0;
        }
        scratch.chain.length_by_tension(task, &mut scratch.length_by_tension);
        let HoldScratch { schur, self_stress } = memory;
        let cables = task.tensions.len();
        schur.clear();
        for one in &*held {
            let row = &scratch.length_by_tension[one.cable * cables..];
            schur.extend(held.iter().map(|other| row[other.cable]));
        }
        let mut keep = self_stress.held(schur, held.iter().map(|held| held.is_idle)).iter();
        held.retain(|_| keep.next() == Some(&true));
        Some(())
    }
}

impl Scratch {
    /// Evaluates the chain at its coordinates, with its tangent.
    pub fn linearise(&mut self, task: &Task<'_>) {
        self.chain.evaluate(task);
        self.chain.linearise(task);
    }

    /// The verdict on the equilibrium that was linearised last, with these cables held.
    pub fn verdict(
        &mut self,
        task: &Task<'_>,
        held: &[HeldCable],
        analysis: StabilityAnalysis,
    ) -> Result<Verdict, NoStability> {
        let is_clear = |scratch: &mut Self, task: &Task<'_>| {
            analysis == StabilityAnalysis::Verdict
                && scratch.eigenvalues_below(task, held, Diagnostics::NEAR_CRITICAL) == Some(0)
        };
        if !task.loads.any_dead_moment() {
            if is_clear(self, task) {
                return Ok(Verdict::STABLE);
            }
            let least = self.least_eigenvalue(task, held).ok_or(NoStability::Undetermined)?;
            return Ok(Verdict::of_eigenvalue(least));
        }
        let moments = |more: f64| Task { moments: DeadMoments::Symmetric { more }, ..*task };
        let least_with = |scratch: &mut Self, more: f64| {
            scratch.linearise(&moments(more));
            scratch.least_eigenvalue(&moments(more), held).ok_or(NoStability::Undetermined)
        };
        self.linearise(&moments(-0.5));
        if is_clear(self, &moments(-0.5)) {
            return Ok(Verdict::STABLE);
        }
        let with_less = least_with(self, -0.5)?;
        let least = least_with(self, 0.0)?;
        if with_less >= -Diagnostics::NEUTRAL {
            return Ok(Verdict::of_eigenvalue(least));
        }
        let spread = least_with(self, 0.5)? - with_less;
        match spread <= INSENSITIVE * (1.0 + least.abs()) {
            true => Ok(Verdict::of_eigenvalue(least)),
            false => Err(NoStability::DeadMoments),
        }
    }

    /// Least eigenvalue of the tangent that was linearised last, relative to the sections' own stiffness, eq. (8), by bisection on the number of
    /// eigenvalues below.
    fn least_eigenvalue(&mut self, task: &Task<'_>, held: &[HeldCable]) -> Option<f64> {
        const FARTHEST: f64 = 1e6;
        const BISECTIONS: usize = 22;
        let below = |scratch: &mut Self, value| scratch.eigenvalues_below(task, held, value);
        let (mut low, mut high) = (0.5, 1.4);
        while below(self, low)? > 0 {
            if low < -FARTHEST {
                return None;
            }
            (high, low) = (low, low.min(0.25) * 4.0 - 1.5);
        }
        while below(self, high)? == 0 {
            if high > FARTHEST {
                return None;
            }
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            // At an eigenvalue itself the tangent is singular, as with many at 1.
            let beside = middle - 1e-7 * middle.abs().max(1.0);
            let count = below(self, middle).or_else(|| below(self, beside))?;
            if count > 0 { high = middle } else { low = middle }
        }
        Some(0.5 * (low + high))
    }

    /// The number of eigenvalues of the tangent that was linearised last, relative to the sections' own stiffness, below
    /// a value, with these cables held.
    pub fn eigenvalues_below(
        &mut self,
        task: &Task<'_>,
        held: &[HeldCable],
        value: f64,
    ) -> Option<usize> {
        let asked = if held.is_empty() { Asked::Signs } else { Asked::Responses };
        let negative = self.chain.eliminate(task, Elimination { shift: value, asked })?;
        if held.is_empty() {
            return Some(negative);
        }
        // Held cables make rows of the tangent's own: of `[H C; Cᵀ −c]` as many eigenvalues are
        // negative as there are below, and one for each cable.
        let Self { chain, length_by_tension, pivots, work, .. } = self;
        chain.length_by_tension(task, length_by_tension);
        let cables = task.tensions.len();
        let entry = |i: usize, j: usize| -length_by_tension[i * cables + j];
        // Cables that pull to no effect of their own must not count either way.
        let gives = held.iter().map(|held| entry(held.cable, held.cable).abs());
        let ridge = REGULARISATION * gives.fold(0.0, f64::max);
        let positive = positive_pivots(
            held.iter().map(|held| (held.cable, held.compliance + ridge)),
            entry,
            pivots,
            work,
        )?;
        Some((negative + positive).saturating_sub(held.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Loads, PointLoad};
    use crate::linkage::task::Right;
    use crate::piecewise_constant_curvature::{Options, build};
    use crate::robot::{Backbone, Cable, Disks, Robot, Routing, Stiffness};
    use whipcord_numerics::Vec3;

    /// Under dead moments on disks and between them the tangent is symmetric only where half of them follows.
    #[test]
    fn half_of_a_dead_moment_follows_in_the_symmetric_tangent() {
        let stiffness = Stiffness::Diagonal {
            shear: None,
            axial: None,
            bending: [1.0, 2.0].into(),
            torsion: 0.7.into(),
        };
        let backbone = Backbone {
            stiffness: Some(stiffness),
            extensible: false,
            shearable: false,
            ..Backbone::new(1.0)
        };
        let cable = Cable::new("c", Routing::Straight { angle: 0.4, radius: 0.05 });
        let robot = Robot::new(backbone, Disks::equally_spaced(1.0, 4, 0.06), vec![cable]).unwrap();
        let point =
            PointLoad { moment: Vec3::new(0.3, -0.2, 0.5), at: 0.4, ..PointLoad::default() };
        let loads = Loads {
            tip_force: Vec3::new(0.2, 0.4, -0.5),
            tip_moment: Vec3::new(0.6, 0.3, -0.4),
            points: vec![point],
            ..Loads::default()
        };
        let case = Case { loads, ..Case::with_tensions(&[3.0]) };
        let model = build(&robot, &Options::default()).unwrap();
        let mut workspace = Workspace::default();
        model.solve(&case, None, &mut workspace).unwrap();
        let Workspace { scratch, loads, tensions, meter, .. } = &mut workspace;
        let mut asymmetry = |moments: DeadMoments| {
            let task = Task { moments, ..model.task(loads, tensions, meter) };
            let count = task.division.coordinates();
            let n = count * task.sections.len();
            let chain = &mut scratch.chain;
            chain.evaluate(&task);
            chain.linearise(&task);
            let unit =
                |side: usize| Right::Unit { section: side / count, coordinate: side % count };
            chain.eliminate_with(&task, 0.0, n, unit).unwrap();
            let entry = |i: usize, j: usize| chain.response(&task, j, i / count)[i % count];
            let pairs = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let size = pairs().map(|(i, j)| entry(i, j).abs()).fold(0.0, f64::max);
            pairs().map(|(i, j)| (entry(i, j) - entry(j, i)).abs()).fold(0.0, f64::max) / size
        };
        assert!(asymmetry(DeadMoments::Exact) > 1e-3);
        assert!(asymmetry(DeadMoments::Symmetric { more: 0.0 }) < 1e-13);
        assert!(asymmetry(DeadMoments::Symmetric { more: -0.5 }) < 1e-13);
    }
}
