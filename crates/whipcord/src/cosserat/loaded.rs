//! A rod under loads, integrated from the base for a given base moment.
//!
//! The force `F(s)` that dead loads exert at a cut is known (see [`crate::statics::loads`]); that of point-like
//! follower forces is constant between them and unknown at the base. With the moment `M(s)` in the base frame
//! the state is `(R, p, M)`:
//!
//! ```text
//! R′ = R û,   p′ = R v,   M′ = −p′ × F − l      with (v, u) from eqs. (1), (2) at N = RᵀF, Mᵦ = RᵀM   (4)
//! ```
//!
//! where `l` is the moment spread along the rod. Followers that are spread change their share of `F`
//! by `−R f` on the way; it is then integrated beside the state.
//!
//! The base moment, and with follower forces their share of the base force, are the only unknowns;
//! [`super::sensitivity`] differentiates by them.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::{BUTCHER_5, Pose, UnitQuaternion, Vec3};

use super::gap::Gap;
use super::state::Node;
use super::step_lanes::StepLanes;
use super::strain_guess::Guess;
use super::target::Target;
use crate::section::Fault;
use crate::section::{BodyWrench, Strain, Tangent, equilibrium_within, is_iterated, one_cable};
use crate::shape::Wrench;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::loads::AppliedLoads;
use crate::statics::quadratic_form::Sample;
use crate::statics::runge_kutta::{NODE_OF_STAGE, SAMPLED_STAGES, STAGES, State, pack, unpack};
use crate::statics::scales::Scales;
use whipcord_numerics::weighted_sum;

/// Weights of five equally spaced places in the polynomial through them, in the middle between each two neighbours.
const BETWEEN: [[f64; 5]; 4] = {
    const P: f64 = 1.0 / 128.0;
    [
        [35.0 * P, 140.0 * P, -70.0 * P, 28.0 * P, -5.0 * P],
        [-5.0 * P, 60.0 * P, 90.0 * P, -20.0 * P, 3.0 * P],
        [3.0 * P, -20.0 * P, 90.0 * P, 60.0 * P, -5.0 * P],
        [-5.0 * P, 28.0 * P, -70.0 * P, 140.0 * P, 35.0 * P],
    ]
};

/// One integration from base to tip.
#[derive(Clone, Debug, Default)]
pub(super) struct Trajectory {
    /// Frames at the ends of all steps.
    pub poses: Vec<Pose>,
    /// Cable lengths in m, by [`Trajectory::measure`].
    pub lengths: Vec<f64>,
    /// Force of followers and moment left over at the tip beyond what the loads apply there, base
    /// frame.
    pub excess: Wrench,
    /// Start, middle and end of each step, when asked for.
    pub samples: Vec<Sample>,
    /// Of all stages of the last shot: where the sections of the next one start from.
    pub(super) strains: Vec<Strain>,
    pub(super) in_lanes: StepLanes,
    /// Integration steps that the solve may still make, see [`super::strength`].
    pub steps_left: usize,
}

/// [`Trajectory::shoot`] with the instructions that the processor has. No sum is reordered or fused: the
/// answer is the same to the last bit.
struct Shoot<'a> {
    trajectory: &'a mut Trajectory,
    grid: &'a Grid,
    loads: &'a AppliedLoads,
    target: &'a Target<'a>,
}

impl WithSimd for Shoot<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.trajectory.integrate(self.grid, self.loads, self.target)
    }
}

/// [`Trajectory::shoot_step`] likewise.
struct ShootStep<'a> {
    trajectory: &'a mut Trajectory,
    grid: &'a Grid,
    loads: &'a AppliedLoads,
    target: &'a Target<'a>,
    k: usize,
    state: State,
}

impl WithSimd for ShootStep<'_> {
    type Output = Result<(State, Vec3), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { trajectory, grid, loads, target, k, mut state } = self;
        let mut force = target.follower_force;
        trajectory.step(grid, loads, target, k, &mut force, &mut state, None)?;
        Ok((state, force))
    }
}

impl Trajectory {
    /// Starts the sections of the next shot from the strains at the Gauss nodes of the rod
    /// without load.
    pub fn seed(&mut self, grid: &Grid, gauss_strains: &[Strain]) {
        let of_steps = gauss_strains.chunks_exact(3).map(|at| [at[0], at[1], at[2]]);
        self.seed_steps(of_steps.take(grid.len()));
    }

    /// Starts them from the strains at start, middle and end of each step.
    pub fn seed_steps(&mut self, of_steps: impl Iterator<Item = [Strain; 3]>) {
        self.strains.clear();
        for at in of_steps {
            self.strains.extend([0, 0, 0, 1, 2, 2].map(|i: usize| at[i]));
        }
    }

    /// Starts the sections of each step of the next shot, on another grid, from those of a step of the last.
    pub fn regrid(&mut self, steps: impl Iterator<Item = usize>) {
        let strains = &self.strains;
        let of = |k: usize| strains[STAGES * k..STAGES * (k + 1)].iter().copied();
        self.strains = steps.flat_map(of).collect();
    }

    /// Starts the sections of the next shot from those of the last one, whose steps were the same or twice as long, between which a polynomial
    /// of degree 4 leads; from their neighbours where they were others.
    pub fn refine(&mut self, grid: &Grid) {
        let slots = STAGES * grid.len();
        if self.strains.len() == slots {
            return;
        }
        if 2 * self.strains.len() != slots {
            return self.forget();
        }
        self.strains.resize(slots, Strain::default());
        for k in (0..grid.len() / 2).rev() {
            // At the five equally spaced places of the long step.
            let at = [0, 2, 3, 4, 5].map(|i| self.strains[STAGES * k + i]);
            let between = |i: usize| {
                let others = BETWEEN[i].iter().zip(&at);
                others.fold(at[2], |sum, (weight, of)| sum + (*of - at[2]) * *weight)
            };
            for (half, first) in [0, 2].into_iter().enumerate() {
                let (near, far) = (between(first), between(first + 1));
                let short = [at[first], near, near, at[first + 1], far, at[first + 2]];
                self.strains[STAGES * (2 * k + half)..][..STAGES].copy_from_slice(&short);
            }
        }
    }

    /// Lets the sections of the next shot start from their neighbours instead of the last shot.
    pub fn forget(&mut self) {
        self.strains.clear();
    }

    /// Strains of all stages of the last shot, six to a step; none after a shot that failed.
    pub fn strains(&self) -> &[Strain] {
        &self.strains
    }

    /// Integrates eqs. (4).
    pub fn shoot(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        target: &Target<'_>,
    ) -> Result<(), Fault> {
        Arch::new().dispatch(Shoot { trajectory: self, grid, loads, target })
    }

    #[inline(always)]
    fn integrate(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        target: &Target<'_>,
    ) -> Result<(), Fault> {
        self.steps_left = self.steps_left.saturating_sub(grid.len());
        self.poses.clear();
        self.samples.clear();
        let slots = STAGES * grid.len();
        let known = self.strains.len() == slots;
        self.strains.resize(slots, Strain::default());
        let mut state = pack(UnitQuaternion::IDENTITY, Vec3::ZERO, target.base_moment);
        let mut follower_force = target.follower_force;
        self.poses.push(Pose::IDENTITY);
        let mut guess = Guess::default();
        for k in 0..grid.len() {
            if k > 0 && grid.steps[k - 1].active != grid.steps[k].active {
                guess.jump();
            }
            let guess = (!known).then_some(&mut guess);
            let stepped = self.step(grid, loads, target, k, &mut follower_force, &mut state, guess);
            if let Err(fault) = stepped {
                // Half of the sections have new strains: none can be relied on.
                self.forget();
                return Err(fault);
            }
            let (rotation, position, moment) = unpack(&state);
            let follower = loads.follower(k + 1);
            follower_force -= target.load * rotation.rotate(follower.force);
            let moment =
                moment - target.load * (loads.moment(k + 1) + rotation.rotate(follower.moment));
            state = pack(rotation, position, moment);
            self.poses.push(Pose { position, rotation });
        }
        self.excess = Wrench { force: follower_force, moment: unpack(&state).2 };
        Ok(())
    }

    /// Shoots step `k` alone, from a start of its own: the frame at its end, with the position
    /// relative to the start, and followers' force and moment there in the base frame. Adds to [`Trajectory::samples`]. The
    /// sections start from [`Trajectory::seed`] or the last shot; the followers' force is that of `target`.
    pub fn shoot_step(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        target: &Target<'_>,
        k: usize,
        rotation: UnitQuaternion,
        moment: Vec3,
    ) -> Result<(Pose, Wrench), Fault> {
        debug_assert_eq!(self.strains.len(), STAGES * grid.len());
        self.steps_left = self.steps_left.saturating_sub(1);
        let state = pack(rotation, Vec3::ZERO, moment);
        let step = ShootStep { trajectory: self, grid, loads, target, k, state };
        let (state, force) = Arch::new().dispatch(step)?;
        let (rotation, position, moment) = unpack(&state);
        Ok((Pose { position, rotation }, Wrench { force, moment }))
    }

    /// Computes [`Trajectory::lengths`] from the strains of the last shot.
    pub fn measure(&mut self, grid: &Grid) {
        self.lengths.clear();
        self.lengths.extend(grid.shooting.rest_excess.iter().map(|excess| -excess));
        for (k, (step, strains)) in
            grid.steps.iter().zip(self.strains.chunks_exact(STAGES)).enumerate()
        {
            for (i, strain) in strains.iter().enumerate() {
                let weight = BUTCHER_5.b[i] * step.length;
                if weight == 0.0 {
                    continue;
                }
                let (_, crossings) = grid.shooting.at(k, NODE_OF_STAGE[i], step.active);
                for (length, crossing) in self.lengths.iter_mut().zip(crossings) {
                    *length += weight * crossing.tangent(strain).norm();
                }
            }
        }
    }

    /// One step; its sections start from `guess` where given, else from the last shot.
    #[expect(clippy::too_many_arguments, reason = "the state of one sweep, passed step by step")]
    #[inline(always)]
    fn step(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        target: &Target<'_>,
        k: usize,
        follower_force: &mut Vec3,
        state: &mut State,
        guess: Option<&mut Guess>,
    ) -> Result<(), Fault> {
        let active = grid.steps[k].active;
        let is_iterated = |node| {
            let (node, crossings) = grid.shooting.at(k, node, active);
            is_iterated(&node.section, crossings)
        };
        if loads.line(k).is_none() && active == 1 && !(0..SHOOTING_NODES.len()).any(is_iterated) {
            self.step_of::<false, true>(grid, loads, target, k, follower_force, state, None)
        } else {
            self.step_of::<true, false>(grid, loads, target, k, follower_force, state, guess)
        }
    }

    /// [`Self::step`]. `LINE`: whether loads may be spread along the step. `ONE`: whether one cable crosses its sections, which are not iterated.
    #[expect(clippy::too_many_arguments, reason = "the state of one sweep, passed step by step")]
    #[inline(always)]
    fn step_of<const LINE: bool, const ONE: bool>(
        &mut self,
        grid: &Grid,
        loads: &AppliedLoads,
        target: &Target<'_>,
        k: usize,
        follower_force: &mut Vec3,
        state: &mut State,
        mut guess: Option<&mut Guess>,
    ) -> Result<(), Fault> {
        let table = &BUTCHER_5;
        let step = grid.steps[k];
        let h = step.length;
        // Of each stage, and of the end: what the slopes so far come to.
        let mut stages = [*state; STAGES];
        let (mut stage, mut end) = (*state, *state);
        // What follows the sections and is spread along the step, stage by stage.
        let line = if LINE { loads.line(k) } else { None };
        let mut pushes = [Vec3::ZERO; STAGES];
        for i in 0..STAGES {
            let (node, crossings) = grid.shooting.at(k, NODE_OF_STAGE[i], step.active);
            let section = &node.section;
            let tensions = target.tensions_at(k, NODE_OF_STAGE[i], step.active);
            // The norm of the quaternion is put right after the vectors are turned: each section waits
            // for the one before, and all of a shot for this chain.
            let [w, x, y, z, _, _, _, mx, my, mz] = stage;
            let drifted = UnitQuaternion { w, v: Vec3::new(x, y, z) };
            let moment = Vec3::new(mx, my, mz);
            let (norm, beside) = (drifted.renormalization(), drifted.to_displacement());
            let scale = norm * norm;
            let to_body = |a: Vec3| a + scale * beside.transpose_mul(a);
            let r = (beside * scale).plus_identity();
            let rotation = drifted.scaled(norm);
            let mut force = target.load * loads.force(k, NODE_OF_STAGE[i]) + *follower_force;
            if line.is_some() {
                force -= h * weighted_sum(&pushes[..i], &table.a[i]);
            }
            let wrench = BodyWrench { linear: to_body(force), angular: to_body(moment) };
            let arc_length = step.start + table.c[i] * h;
            let fault = |kind| Fault { kind, arc_length };
            let slot = &mut self.strains[STAGES * k + i];
            let mut guess = guess.as_deref_mut().filter(|_| is_iterated(section, crossings));
            if let Some(guess) = &mut guess {
                *slot = guess.at(arc_length).unwrap_or_else(|| section.rest_strain());
            }
            let cables = (crossings, grid.shooting.groups(k, NODE_OF_STAGE[i], step.active));
            if ONE {
                let one = one_cable::equilibrium(section, &crossings[0], tensions[0], wrench);
                *slot = one.map_err(fault)?.strain;
            } else {
                equilibrium_within(target.step_tolerance, section, cables, tensions, wrench, slot)
                    .map_err(fault)?;
            }
            let strain = *slot;
            if let Some(guess) = guess {
                guess.learn(arc_length, strain);
            }
            if target.sample && SAMPLED_STAGES.contains(&i) {
                let tangent =
                    Tangent::by_groups(section, cables, tensions, &strain).map_err(fault)?;
                self.samples.push(Sample { strain, wrench, tangent, rotation });
            }
            let velocity = r * strain.linear;
            let mut moment_rate = force.cross(velocity);
            if let Some(line) = line {
                let t = table.c[i];
                pushes[i] = target.load * (r * line.follower_force(t));
                moment_rate -= target.load * (line.moment(t) + r * line.follower_moment(t));
            }
            let [w, x, y, z] = rotation.rate(strain.angular);
            let (p, m) = (velocity, moment_rate);
            let slope = [w, x, y, z, p.x, p.y, p.z, m.x, m.y, m.z];
            // The next stage takes the slope from where it is, not from memory: all waits for it.
            if let Some(next) = stages.get(i + 1) {
                stage = plus(next, h * table.a[i + 1][i], &slope);
            }
            for j in i + 2..STAGES {
                stages[j] = plus(&stages[j], h * table.a[j][i], &slope);
            }
            end = plus(&end, h * table.b[i], &slope);
        }
        *state = end;
        if line.is_some() {
            *follower_force -= h * weighted_sum(&pushes, &table.b);
        }
        Ok(())
    }
}

impl Trajectory {
    /// Shoots every step from its node, in lanes and without samples, which [`Self::sample_steps`] takes: how each misses the next node, and the
    /// size of the greatest gap; `None` where lanes do not.
    pub fn shoot_steps(
        &mut self,
        at: (&Grid, &Scales),
        loads: &AppliedLoads,
        target: &Target<'_>,
        nodes: &[Node],
        gaps: &mut Vec<Gap>,
    ) -> Option<f64> {
        self.samples.clear();
        let greatest = self.in_lanes.shoot(at, loads, target, nodes, &mut self.strains, gaps)?;
        self.steps_left = self.steps_left.saturating_sub(at.0.len());
        Some(greatest)
    }

    /// Takes the samples of the last shot of [`Self::shoot_steps`].
    pub fn sample_steps(&mut self, grid: &Grid, target: &Target<'_>) -> Result<(), Fault> {
        let Self { in_lanes, strains, samples, .. } = self;
        let taken = in_lanes.samples((grid, target), strains, samples);
        if taken.is_err() {
            samples.clear();
        }
        taken
    }
}

/// The state this far along a slope.
#[inline(always)]
fn plus(state: &State, f: f64, slope: &State) -> State {
    core::array::from_fn(|i| state[i] + f * slope[i])
}

#[cfg(test)]
mod tests {
    use pulp::Scalar;

    use super::*;
    use crate::cosserat::{Accuracy, Cosserat, Options, Workspace};
    use crate::section::step_tolerance;
    use crate::statics::grid::Layout;
    use crate::statics::options::StabilityAnalysis;
    use crate::{
        Actuation, Backbone, Cable, Case, Disks, Loads, Material, Robot, Routing, Section as Bar,
    };

    fn robot(cables: usize) -> Robot {
        let backbone = Backbone {
            section: Some(Bar::circle(0.003)),
            material: Material {
                name: None,
                young_modulus: Some(1.1e9),
                poisson_ratio: Some(0.3),
                shear_modulus: None,
                density: Some(1040.0),
                yield_strain: None,
            },
            ..Backbone::new(0.18)
        };
        let helix = |i: usize| {
            let routing = Routing::Helix { start_angle: 2.0 * i as f64, turns: 0.4, radius: 0.008 };
            Cable::new(format!("{i}"), routing)
        };
        let disks = Disks::equally_spaced(0.18, 10, 0.008);
        Robot::new(backbone, disks, (0..cables).map(helix).collect()).unwrap()
    }

    fn loads() -> Loads {
        Loads {
            gravity: Some(Vec3::new(0.0, 0.0, -9.80665)),
            tip_force: Vec3::new(0.05, 0.0, 0.02),
            tip_moment: Vec3::new(0.0, 1e-3, 5e-4),
            ..Loads::default()
        }
    }

    #[test]
    fn a_shot_is_the_same_to_the_last_bit_with_any_instructions() {
        for cables in [0, 1, 3] {
            let (robot, loads) = (robot(cables), loads());
            let grid = Grid::new(&robot, &Layout::new(&robot, Vec::new(), &loads), 12).unwrap();
            let mut applied = AppliedLoads::default();
            applied.gather(&grid, &loads, UnitQuaternion::IDENTITY);
            let target = Target {
                tensions: &[3.9, 1.2, 0.4][..cables],
                per_node: 0,
                base_moment: Vec3::new(1e-3, 8e-3, 4e-4),
                follower_force: Vec3::ZERO,
                load: 1.0,
                sample: true,
                step_tolerance: step_tolerance(0.0),
            };
            let (mut best, mut plain) = (Trajectory::default(), Trajectory::default());
            best.shoot(&grid, &applied, &target).unwrap();
            let (trajectory, loads) = (&mut plain, &applied);
            Shoot { trajectory, grid: &grid, loads, target: &target }.with_simd(Scalar).unwrap();
            assert_eq!(best.poses, plain.poses);
            assert_eq!(best.strains, plain.strains);
            assert_eq!(best.excess, plain.excess);
        }
    }

    #[test]
    fn two_newton_steps_suffice_from_a_rod_that_has_yielded_once() {
        let options = Options {
            accuracy: Accuracy::Steps(12),
            actuation: Actuation::Tension,
            stability: StabilityAnalysis::Off,
            residual: 1e-5,
            ..Options::default()
        };
        let case = Case { loads: loads(), ..Case::with_tensions(&[3.9]) };
        let model = Cosserat::new(&robot(1), &case.loads, &options).unwrap();
        let solution = model.solve(&case, None, &mut Workspace::default()).unwrap();
        assert_eq!(solution.diagnostics.iterations, 2);
    }
}
