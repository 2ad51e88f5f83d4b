//! [`super::super::loaded`] in lanes: rods under dead loads that have one equilibrium, whatever their tensions up to those given.
//!
//! The base moment is found by Newton's method with a Jacobian from differences of shots, which cost little in lanes, and then by Broyden's.

use pulp::Simd;
use whipcord_numerics::lanes::{LaneMask, LanePose, LaneTwist, LaneVec3, Lanes};
use whipcord_numerics::{BUTCHER_5, Vec3};

use super::section::{Guess, Several};
use crate::section::{Crossing, Section, Stiffness, step_tolerance};
use crate::solution::Diagnostics;
use crate::statics::convexity;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::lanes::one_cable::{LaneCrossed, LaneReduced};
use crate::statics::lanes::rod_step::{LaneState, StepSections, advance};
use crate::statics::loads::AppliedLoads;
use crate::statics::runge_kutta::{NODE_OF_STAGE, STAGES};
use crate::statics::scales::Scales;

/// Shots after those for the Jacobian, before a lane is left to the code for one rod.
const MOST_SHOTS: usize = 12;
/// Step of the differences, relative to the scale of the moment: the next shots correct what it is off.
const DIFFERENCE: f64 = 1e-5;

/// A grid under loads, made ready for lanes.
#[derive(Clone, Debug)]
pub(super) struct LoadedGrid {
    grid: Grid,
    applied: AppliedLoads,
    /// Five to each step.
    sections: Vec<LoadedSection>,
    scales: Scales,
}

#[derive(Clone, Debug)]
enum LoadedSection {
    Bare {
        soft: Stiffness,
        rest_curvature: Vec3,
    },
    /// With one cable and equally stiff about x and y.
    One(Section, Crossing),
    Several(Several),
}

/// Memory of the shots of a group of rows.
pub(super) struct Shots<S: Simd> {
    /// Of the last shot, at the ends of all steps.
    poses: Vec<LanePose<S>>,
    /// Of the last shot, six to a step: where the sections of the next start from.
    strains: Vec<LaneTwist<S>>,
    stretches: Vec<Lanes<S>>,
    is_started: bool,
}

/// What the rows of a group came to.
pub(super) struct Found<S: Simd> {
    pub is_solved: LaneMask<S>,
    pub residual: Lanes<S>,
    pub iterations: Lanes<S>,
}

impl LoadedGrid {
    /// `None` where the lanes cannot take the sections or the loads.
    pub fn new(grid: &Grid, applied: AppliedLoads, length: f64) -> Option<Self> {
        if applied.any_follower() || applied.any_line() {
            return None;
        }
        let mut sections = Vec::with_capacity(SHOOTING_NODES.len() * grid.len());
        for (k, step) in grid.steps.iter().enumerate() {
            for j in 0..SHOOTING_NODES.len() {
                let (node, crossings) = grid.shooting.at(k, j, step.active);
                let section = &node.section;
                sections.push(match crossings {
                    _ if section.beside.is_some() => return None,
                    [] => LoadedSection::Bare {
                        soft: section.compliance,
                        rest_curvature: section.rest_curvature,
                    },
                    [crossing] if section.isotropic => {
                        LoadedSection::One(section.clone(), *crossing)
                    }
                    _ => LoadedSection::Several(Several::new(section, crossings, Guess::Last)?),
                });
            }
        }
        let scales = Scales::of(grid, length);
        Some(Self { grid: grid.clone(), applied, sections, scales })
    }

    /// Steps from base to tip.
    pub fn steps(&self) -> usize {
        self.grid.len()
    }

    /// Whether a rod under these tensions, in N and in the order of the grid, has one equilibrium, which is stable and not near critical.
    pub fn takes(&self, tensions: &[f64]) -> bool {
        convexity::is_shown(&self.grid, &self.applied, tensions, Diagnostics::NEAR_CRITICAL)
    }
}

impl<S: Simd> Shots<S> {
    #[inline(always)]
    pub fn new() -> Self {
        let (poses, strains, stretches) = (Vec::new(), Vec::new(), Vec::new());
        Self { poses, strains, stretches, is_started: false }
    }

    /// Of the last shot, at the ends of all steps.
    pub fn poses(&self) -> &[LanePose<S>] {
        &self.poses
    }

    /// Finds the shapes under these tensions to a residual; adds to `lengths` those of the cables.
    #[inline(always)]
    pub fn solve(
        &mut self,
        simd: S,
        of: &LoadedGrid,
        tensions: &[Lanes<S>],
        lengths: &mut [Lanes<S>],
        residual: f64,
    ) -> Found<S> {
        let zero = Lanes::splat(simd, 0.0);
        let null = LaneVec3::new(zero, zero, zero);
        self.is_started = false;
        let tolerance = step_tolerance(residual);
        // Without load: what the loads exert on that shape is where Newton's method starts from.
        let all = zero.at_most(zero);
        self.shoot(simd, of, tensions, (0.0, null), tolerance, all);
        let mut moment = null;
        for (k, pair) in self.poses.windows(2).enumerate() {
            let force = LaneVec3::splat(simd, of.applied.force(k, 2));
            let at_end = LaneVec3::splat(simd, of.applied.moment(k + 1));
            moment = moment + (pair[1].position - pair[0].position).cross(force) + at_end;
        }
        let (mut left, is_shot) = self.shoot(simd, of, tensions, (1.0, moment), tolerance, all);
        let step = Lanes::splat(simd, DIFFERENCE * of.scales.moment);
        let x = LaneVec3::new(step, zero, zero);
        let y = LaneVec3::new(zero, step, zero);
        let z = LaneVec3::new(zero, zero, step);
        let per_step = 1.0 / (DIFFERENCE * of.scales.moment);
        let a =
            (self.shoot(simd, of, tensions, (1.0, moment + x), tolerance, all).0 - left) * per_step;
        let b =
            (self.shoot(simd, of, tensions, (1.0, moment + y), tolerance, all).0 - left) * per_step;
        let c =
            (self.shoot(simd, of, tensions, (1.0, moment + z), tolerance, all).0 - left) * per_step;
        // Rows of the inverse of the Jacobian of these columns.
        let (u, v, w) = (b.cross(c), c.cross(a), a.cross(b));
        let per_determinant = Lanes::splat(simd, 1.0) / a.dot(u);
        let mut inverse = [u * per_determinant, v * per_determinant, w * per_determinant];
        let scale = Lanes::splat(simd, of.scales.moment);
        let enough = Lanes::splat(simd, residual);
        let size = |left: LaneVec3<S>, moment: LaneVec3<S>| left.norm() / (scale + moment.norm());
        let mut worst = size(left, moment);
        // Every lane takes a step: those that are there already still have the strains of the last difference.
        let mut running = is_shot;
        let mut is_solved = zero.below(zero);
        let (one, mut iterations) = (Lanes::splat(simd, 1.0), zero);
        for _ in 0..MOST_SHOTS {
            if !running.any() {
                break;
            }
            iterations = iterations + running.select(one, zero);
            let [p, q, r] = inverse;
            let step = LaneVec3::new(-p.dot(left), -q.dot(left), -r.dot(left));
            moment = select(running, moment + step, moment);
            let (next, is_shot) = self.shoot(simd, of, tensions, (1.0, moment), tolerance, running);
            running = running.and(is_shot);
            // Broyden's update: the inverse takes the change of what is left to the step.
            let change = next - left;
            let taken = LaneVec3::new(p.dot(change), q.dot(change), r.dot(change));
            let row = p * step.x + q * step.y + r * step.z;
            let per = Lanes::splat(simd, 1.0) / step.dot(taken);
            let off = (step - taken) * per;
            inverse = [
                select(running, p + row * off.x, p),
                select(running, q + row * off.y, q),
                select(running, r + row * off.z, r),
            ];
            left = next;
            worst = size(left, moment);
            let met = worst.at_most(enough);
            is_solved = is_solved.or(running.and(met));
            running = running.and(enough.below(worst));
        }
        // Lanes that were there kept their strains, so that the last shot holds the shapes of all of them.
        self.measure(simd, of, lengths);
        Found { is_solved, residual: worst, iterations }
    }

    /// Integrates eqs. (4) with this part of the loads and this base moment: the moment that is left over at the tip, and in which lanes each
    /// section has a strain. The lanes that do not move keep the strains of the last shot: what a row gives does not hang on those beside it.
    #[inline(always)]
    fn shoot(
        &mut self,
        simd: S,
        of: &LoadedGrid,
        tensions: &[Lanes<S>],
        (load, base_moment): (f64, LaneVec3<S>),
        tolerance: f64,
        moving: LaneMask<S>,
    ) -> (LaneVec3<S>, LaneMask<S>) {
        let LoadedGrid { grid, .. } = of;
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let null = LaneVec3::new(zero, zero, zero);
        let last = LaneTwist { linear: LaneVec3::splat(simd, Vec3::Z), angular: null };
        self.strains.resize(STAGES * grid.len(), last);
        self.poses.clear();
        let mut state = LaneState { pose: LanePose::identity(simd), moment: base_moment };
        self.poses.push(state.pose);
        let is_shot = zero.at_most(one);
        let (is_started, strains) = (self.is_started, &mut self.strains[..]);
        let mut sections = Sections {
            of,
            step: 0,
            load,
            tensions,
            tolerance,
            moving,
            is_started,
            strains,
            last,
            is_shot,
        };
        for (k, step) in grid.steps.iter().enumerate() {
            sections.step = k;
            state = advance(simd, Lanes::splat(simd, step.length), state, &mut sections);
            let at_end = load * of.applied.moment(k + 1);
            state.moment = state.moment - LaneVec3::splat(simd, at_end);
            self.poses.push(state.pose);
        }
        let is_shot = sections.is_shot;
        self.is_started = true;
        (state.moment, is_shot)
    }

    /// Adds the lengths of the cables at the strains of the last shot.
    #[inline(always)]
    fn measure(&mut self, simd: S, of: &LoadedGrid, lengths: &mut [Lanes<S>]) {
        let LoadedGrid { grid, .. } = of;
        self.stretches.resize(lengths.len(), Lanes::splat(simd, 0.0));
        for (length, excess) in lengths.iter_mut().zip(&grid.shooting.rest_excess) {
            *length = Lanes::splat(simd, -excess);
        }
        for (k, step) in grid.steps.iter().enumerate() {
            for i in 0..STAGES {
                let weight = BUTCHER_5.b[i] * step.length;
                if weight == 0.0 {
                    continue;
                }
                let (_, crossings) = grid.shooting.at(k, NODE_OF_STAGE[i], step.active);
                let strain = &self.strains[STAGES * k + i];
                super::section::stretches(simd, crossings, strain, &mut self.stretches);
                for (length, stretch) in lengths.iter_mut().zip(&self.stretches).take(step.active) {
                    *length = *length + *stretch * weight;
                }
            }
        }
    }
}

/// The sections of a shot, step by step.
struct Sections<'a, S: Simd> {
    of: &'a LoadedGrid,
    step: usize,
    load: f64,
    tensions: &'a [Lanes<S>],
    tolerance: f64,
    moving: LaneMask<S>,
    /// Whether the strains are those of the last shot.
    is_started: bool,
    strains: &'a mut [LaneTwist<S>],
    /// Of the last stage.
    last: LaneTwist<S>,
    is_shot: LaneMask<S>,
}

impl<S: Simd> StepSections<S> for Sections<'_, S> {
    #[inline(always)]
    fn force(&self, simd: S, stage: usize) -> LaneVec3<S> {
        let force = self.of.applied.force(self.step, NODE_OF_STAGE[stage]);
        LaneVec3::splat(simd, self.load * force)
    }

    #[inline(always)]
    fn strain(
        &mut self,
        simd: S,
        stage: usize,
        _: &LanePose<S>,
        wrench: [LaneVec3<S>; 2],
    ) -> LaneTwist<S> {
        let slot = STAGES * self.step + stage;
        let start = if self.is_started { self.strains[slot] } else { self.last };
        let section = &self.of.sections[SHOOTING_NODES.len() * self.step + NODE_OF_STAGE[stage]];
        let strain = match section {
            LoadedSection::Bare { soft, rest_curvature } => {
                let [force, moment] = wrench;
                let linear = LaneVec3::splat(simd, soft.shear).scale(force);
                let angular = LaneVec3::splat(simd, soft.bending).scale(moment);
                LaneTwist {
                    linear: LaneVec3::splat(simd, Vec3::Z) + linear,
                    angular: LaneVec3::splat(simd, *rest_curvature) + angular,
                }
            }
            LoadedSection::One(section, crossing) => {
                let crossed = LaneCrossed::splat(simd, section, crossing);
                let found =
                    LaneReduced::under(simd, &crossed, wrench).solve(simd, self.tensions[0]);
                self.is_shot = self.is_shot.and(found.is_solved);
                found.strain
            }
            LoadedSection::Several(section) => {
                let (found, is_solved) =
                    section.under(simd, wrench, start, self.tensions, self.tolerance);
                self.is_shot = self.is_shot.and(is_solved);
                LaneTwist {
                    linear: select(self.moving, found.linear, start.linear),
                    angular: select(self.moving, found.angular, start.angular),
                }
            }
        };
        self.strains[slot] = strain;
        self.last = strain;
        strain
    }
}

#[inline(always)]
fn select<S: Simd>(mask: LaneMask<S>, then: LaneVec3<S>, otherwise: LaneVec3<S>) -> LaneVec3<S> {
    LaneVec3::new(
        mask.select(then.x, otherwise.x),
        mask.select(then.y, otherwise.y),
        mask.select(then.z, otherwise.z),
    )
}
