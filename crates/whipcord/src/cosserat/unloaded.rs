//! A rod on which nothing but its cables pulls.
//!
//! Then the total wrench vanishes at every cut, and the strains follow section by section from
//! eqs. (1) and (2) of [`crate::section`]: there is no boundary value problem. The frames come from
//! one pass of a Magnus integrator of order 6, the cable lengths from Gauss quadrature.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::lanes::{LanePose, LaneTwist, Lanes, magnus_6_exponent};
use whipcord_numerics::{GAUSS_3, Pose, magnus_6};

use super::sensitivity::work;
use super::strain_guess::Guess;
use crate::section::equilibrium::STEP_TOLERANCE;
use crate::section::one_cable::OneCable;
use crate::section::{BodyWrench, Fault, SectionFault, Strain, Tangent, equilibrium_within};
use crate::solution::Verdict;
use crate::statics::grid::Grid;
use crate::statics::lanes::columns::{strain_of, strains_of_steps};
use crate::statics::lanes::one_cable::LaneReduced;
use crate::statics::lanes::run::{Known, solve_run, stability_of_run};
use crate::statics::one_cable_table::OneCableTable;
use crate::statics::section_runs::SectionRun;
use crate::statics::section_table::WIDTH;

/// How the sections of a rod without load are solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepOptions {
    /// The last Newton step of each section, as a strain.
    pub tolerance: f64,
    /// Whether from the strains of the last sweep.
    pub warm: bool,
    /// Whether with the derivatives of the lengths by the tensions.
    pub derivatives: bool,
}

impl SweepOptions {
    /// Cold, and without derivatives.
    pub const fn to(tolerance: f64) -> Self {
        Self { tolerance, warm: false, derivatives: false }
    }

    /// [`Self::to`] rounding.
    pub const EXACT: Self = Self::to(STEP_TOLERANCE);
}

/// Strains, lengths and their derivatives of a rod without load.
#[derive(Clone, Debug, Default)]
pub(crate) struct Unloaded {
    /// Three to each step.
    pub strains: Vec<Strain>,
    /// `ℓᵢ = ∫‖pᵢ′‖ ds` in m, in the order of the grid.
    pub lengths: Vec<f64>,
    /// `∂ℓᵢ/∂τⱼ` by rows in m/N: symmetric and not positive.
    pub length_by_tension: Vec<f64>,
    pulls: Vec<BodyWrench>,
    /// `‖pᵢ′‖` at each node of a run of sections, by nodes, then cables.
    stretches: Vec<f64>,
    /// Of the sections of runs from their responses to the tensions.
    departures: Vec<Strain>,
    /// In the slots of the grid's table of sections that one cable crosses, up to the first that has no answer.
    of_one_cable: Vec<OneCable>,
}

/// [`Unloaded::sweep`] with the instructions that the processor has, to the same bits.
struct Sweep<'a> {
    unloaded: &'a mut Unloaded,
    grid: &'a Grid,
    tensions: &'a [f64],
    options: SweepOptions,
}

impl WithSimd for Sweep<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { unloaded, grid, tensions, options } = self;
        unloaded.sweep_with(simd, grid, tensions, options)
    }
}

/// [`stability_of_run`] likewise.
struct LeastOfRun<'a> {
    run: &'a SectionRun,
    tensions: &'a [f64],
    strains: &'a [Strain],
}

impl WithSimd for LeastOfRun<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { run, tensions, strains } = self;
        stability_of_run(simd, run, &tensions[..run.sections.cables], strains)
    }
}

/// [`Unloaded::integrate`] likewise.
struct Integrate<'a> {
    grid: &'a Grid,
    strains: &'a [Strain],
    poses: &'a mut Vec<Pose>,
}

impl WithSimd for Integrate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { grid, strains, poses } = self;
        poses.clear();
        let mut pose = Pose::IDENTITY;
        poses.push(pose);
        let lanes = Lanes::<S>::COUNT.min(WIDTH);
        let (strains, _) = strains.as_chunks::<3>();
        for (steps, strains) in grid.steps.chunks(lanes).zip(strains.chunks(lanes)) {
            // The exponentials wait for nothing: those of several steps are formed at once.
            let mut lengths = [0.0; WIDTH];
            for (to, step) in lengths.iter_mut().zip(steps) {
                *to = step.length;
            }
            let h = Lanes::load(simd, &lengths, 0);
            let mut twists = [
                strains_of_steps(simd, strains, 0),
                strains_of_steps(simd, strains, 1),
                strains_of_steps(simd, strains, 2),
            ];
            for twist in &mut twists {
                *twist = LaneTwist { linear: twist.linear * h, angular: twist.angular * h };
            }
            let exponent = magnus_6_exponent(&twists);
            let turn = exponent.angular.dot(exponent.angular);
            let moved = LanePose::exp(exponent);
            for (lane, strains) in strains.iter().enumerate() {
                let step = match turn.as_slice()[lane] <= LanePose::<S>::SERIES_LIMIT {
                    true => moved.of(lane),
                    false => magnus_6(&strains.map(|strain| strain * lengths[lane])),
                };
                pose = pose * step;
                poses.push(pose);
            }
        }
    }
}

/// The frames at the ends of all steps, from strains at the Gauss nodes.
pub(super) fn integrate(grid: &Grid, strains: &[Strain], poses: &mut Vec<Pose>) {
    Arch::new().dispatch(Integrate { grid, strains, poses });
}

impl Unloaded {
    /// Solves all sections for these tensions (N, in the order of the grid).
    pub fn sweep(
        &mut self,
        grid: &Grid,
        tensions: &[f64],
        options: SweepOptions,
    ) -> Result<(), Fault> {
        Arch::new().dispatch(Sweep { unloaded: self, grid, tensions, options })
    }

    #[inline(always)]
    fn sweep_with<S: Simd>(
        &mut self,
        simd: S,
        grid: &Grid,
        tensions: &[f64],
        SweepOptions { tolerance, warm, derivatives }: SweepOptions,
    ) -> Result<(), Fault> {
        let cables = tensions.len();
        let nodes = 3 * grid.len();
        let warm = warm && self.strains.len() == nodes;
        self.strains.resize(nodes, Strain::default());
        self.lengths.clear();
        // What quadrature adds to the cables of the rod at rest it adds to those of the bent one.
        self.lengths.extend(grid.gauss.rest_excess.iter().map(|excess| -excess));
        self.length_by_tension.clear();
        self.length_by_tension.resize(cables * cables, 0.0);
        self.pulls.resize(cables, BodyWrench::default());
        self.stretches.resize(nodes * cables, 0.0);
        self.departures.resize(nodes, Strain::default());
        for run in grid.gauss.runs.iter() {
            let Self { strains, departures, stretches, .. } = self;
            let mut known = Known { strains, departures, stretches, cables };
            let active = &tensions[..run.sections.cables];
            solve_run(simd, run, &grid.gauss, active, (tolerance, warm), &mut known).map_err(
                |(node, kind)| {
                    let step = &grid.steps[node / 3];
                    Fault { kind, arc_length: step.start + GAUSS_3.nodes[node % 3] * step.length }
                },
            )?;
        }
        let mut runs = grid.gauss.runs.iter().peekable();
        let mut guess = Guess::default();
        let end_of_one_cable = self.solve_one_cable(simd, &grid.gauss.one_cable, tensions);
        let mut last_tangent = None;
        for (k, step) in grid.steps.iter().enumerate() {
            let active = &tensions[..step.active];
            if k > 0 && grid.steps[k - 1].active != step.active {
                guess.jump();
            }
            for j in 0..3 {
                let (node, crossings) = grid.gauss.at(k, j, step.active);
                let section = &node.section;
                let weight = GAUSS_3.weights[j] * step.length;
                let arc_length = step.start + GAUSS_3.nodes[j] * step.length;
                let fault = |kind| Fault { kind, arc_length };
                let none = BodyWrench::default();
                let number = 3 * k + j;
                if let Some(slot) = grid.gauss.one_cable.slot(number) {
                    let Some(one) = self.of_one_cable.get(slot) else {
                        return Err(fault(end_of_one_cable.unwrap_or(SectionFault::Diverged)));
                    };
                    self.lengths[0] += weight * one.stretch;
                    self.length_by_tension[0] += weight * one.stretch_by_tension;
                    self.strains[number] = one.strain;
                    continue;
                }
                while runs.next_if(|run| run.nodes.end <= number).is_some() {}
                if runs.peek().is_some_and(|run| run.nodes.contains(&number)) {
                    let strain = self.strains[number];
                    guess.learn(arc_length, strain);
                    let stretches = &self.stretches[number * cables..][..step.active];
                    for (length, stretch) in self.lengths.iter_mut().zip(stretches) {
                        *length += weight * stretch;
                    }
                    if derivatives {
                        for (pull, crossing) in self.pulls.iter_mut().zip(crossings) {
                            *pull = crossing.pull(&strain).0;
                        }
                        let tangent =
                            Tangent::at(section, crossings, active, &strain).map_err(fault)?;
                        self.add_length_by_tension(cables, step.active, weight, &tangent);
                        last_tangent = Some(tangent);
                    }
                    continue;
                }
                // A section that is the same as the one before has the same answer.
                let repeats = grid.gauss.repeats(k, j);
                let strain = if repeats {
                    guess.strains[2]
                } else {
                    let mut strain = match warm {
                        true => self.strains[number],
                        false => guess.at(arc_length).unwrap_or_else(|| section.rest_strain()),
                    };
                    let cables = (crossings, &[][..]);
                    equilibrium_within(tolerance, section, cables, active, none, &mut strain)
                        .map_err(fault)?;
                    strain
                };
                guess.learn(arc_length, strain);
                for (i, crossing) in crossings.iter().enumerate() {
                    let (pull, stretch) = crossing.pull(&strain);
                    self.pulls[i] = pull;
                    self.lengths[i] += weight * stretch;
                }
                if derivatives {
                    let tangent = match last_tangent.filter(|_| repeats) {
                        Some(tangent) => tangent,
                        None => *last_tangent.insert(
                            Tangent::at(section, crossings, active, &strain).map_err(fault)?,
                        ),
                    };
                    self.add_length_by_tension(cables, step.active, weight, &tangent);
                }
                self.strains[number] = strain;
            }
        }
        Ok(())
    }

    /// The sections that one cable crosses, into [`Self::of_one_cable`] up to the first without an answer, whose fault it returns.
    #[inline(always)]
    fn solve_one_cable<S: Simd>(
        &mut self,
        simd: S,
        table: &OneCableTable,
        tensions: &[f64],
    ) -> Option<SectionFault> {
        self.of_one_cable.clear();
        // It is the longest.
        let &tension = tensions.first()?;
        let lanes = Lanes::<S>::COUNT.min(WIDTH);
        let tensions = Lanes::splat(simd, tension);
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        for slot in (0..table.count()).step_by(lanes) {
            let at = LaneReduced::load(simd, table.rows(slot), slot % WIDTH);
            let found = at.solve(simd, tensions);
            let is_solved = found.is_solved.select(one, zero);
            for lane in 0..lanes.min(table.count() - slot) {
                if is_solved.as_slice()[lane] == 0.0 {
                    match table.in_slot(slot + lane).solve(tension) {
                        Ok(one) => self.of_one_cable.push(one),
                        Err(fault) => return Some(fault),
                    }
                    continue;
                }
                self.of_one_cable.push(OneCable {
                    strain: strain_of(&found.strain, lane),
                    stretch: found.stretch.as_slice()[lane],
                    stretch_by_tension: found.stretch_by_tension.as_slice()[lane],
                });
            }
        }
        None
    }

    /// The verdict of [`Self::stability`], which is 1 at least: the value too where it needs no computation.
    pub fn verdict(grid: &Grid, tensions: &[f64]) -> Verdict {
        match is_neutral_to_cables(grid, tensions) {
            true => Verdict::of_eigenvalue(1.0),
            false => Verdict::STABLE,
        }
    }

    /// The stability of [`super::stability`] at the strains of the last sweep: without load eq. (8) is
    /// `∫ δuᵀ S δu ds` with any field `δu`, and its least value that of `δuᵀ S δu / δuᵀ K_bt δu` at a
    /// section: of those in the middles of the steps.
    ///
    /// What cables add to the Hessian is not negative: the value is 1 at least. One taut cable gives two
    /// equations for the three of `δu` that leave its direction alone, so that it is 1 where a step
    /// has no more than one.
    pub fn stability(&self, grid: &Grid, tensions: &[f64]) -> Result<f64, Fault> {
        if is_neutral_to_cables(grid, tensions) {
            return Ok(1.0);
        }
        let (mut least, mut is_definite) = (f64::INFINITY, true);
        let runs = &grid.gauss.runs;
        for run in runs.iter() {
            let value = Arch::new().dispatch(LeastOfRun { run, tensions, strains: &self.strains });
            least = least.min(value);
            is_definite &= !value.is_nan();
        }
        for (k, step) in grid.steps.iter().enumerate() {
            // Known from its run, unless a section there has no factors.
            if is_definite && grid.gauss.is_in_run(3 * k + 1) {
                continue;
            }
            // The middle of a step where nothing differs from that of the step before.
            let repeats = |k: usize, j: usize| grid.gauss.repeats(k, j);
            if k > 0 && repeats(k - 1, 2) && repeats(k, 0) && repeats(k, 1) {
                continue;
            }
            let (node, crossings) = grid.gauss.at(k, 1, step.active);
            let (section, strain) = (&node.section, &self.strains[3 * k + 1]);
            let tangent = Tangent::at(section, crossings, &tensions[..step.active], strain)
                .map_err(|kind| Fault { kind, arc_length: step.start + 0.5 * step.length })?;
            let metric = section.bending_stiffness();
            least = least.min((tangent.reduced - metric).least_relative(&metric));
        }
        Ok(1.0 + least)
    }

    /// `∂ℓᵢ/∂τⱼ = −∫ qᵢᵀ H⁻¹ qⱼ ds` with `q = (t, r × t)`, what a unit tension exerts.
    fn add_length_by_tension(
        &mut self,
        cables: usize,
        active: usize,
        weight: f64,
        tangent: &Tangent,
    ) {
        for j in 0..active {
            let change = tangent.solve(self.pulls[j]);
            for i in 0..=j {
                let value = work(&self.pulls[i], &change);
                self.length_by_tension[i * cables + j] -= weight * value;
                if i != j {
                    self.length_by_tension[j * cables + i] -= weight * value;
                }
            }
        }
    }

    /// The frames at the ends of all steps, from the strains of the last sweep.
    pub fn integrate(&self, grid: &Grid, poses: &mut Vec<Pose>) {
        integrate(grid, &self.strains, poses);
    }
}

/// Whether no more than one cable pulls at some step, where the rod can then bend without it.
fn is_neutral_to_cables(grid: &Grid, tensions: &[f64]) -> bool {
    grid.steps.iter().any(|step| taut(&tensions[..step.active]) <= 1)
}

/// How many of the cables are taut.
pub(super) fn taut(tensions: &[f64]) -> usize {
    tensions.iter().filter(|&&tension| tension > 0.0).count()
}
