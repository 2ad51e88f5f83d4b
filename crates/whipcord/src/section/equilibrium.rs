//! The strain of a section in equilibrium: Newton's method on its potential.

use whipcord_numerics::{ContinuationSteps, Missed, Vec3, continuation};

use super::block_diagonal::BlockDiagonal;
use super::cable_sums::{CableGroup, CableSums};
use super::crossing::{BodyWrench, Crossing, Strain};
use super::fault::{FOLDED, SectionFault};
use super::one_cable;
use super::properties::Section;
use super::tangent::{Hessian, Tangent};

/// A Newton step this small, as a strain, leaves an error of its square.
pub(crate) const STEP_TOLERANCE: f64 = 2e-7;
/// Part of the residual of a rod that its sections may leave.
const PART_OF_RESIDUAL: f64 = 2e-3;
const MAX_ITERATIONS: usize = 200;
/// Halvings of a step.
const BACKTRACKS: usize = 40;
/// Below this stretch a cable may be what stops Newton's method.
const NEARLY_FOLDED: f64 = 0.05;
/// Of the tensions, as parts of them.
const TENSION_STEPS: ContinuationSteps =
    ContinuationSteps { first: 0.25, least: 1e-3, growth: 2.0, after_miss: f64::INFINITY };
/// Tangents of undamped steps before the potential is watched.
pub(crate) const UNDAMPED: usize = 4;
/// What a step by an older tangent may leave, of the square of the tolerance: it meets its bound, where Newton's mostly leaves far less.
pub(crate) const PART_OF_SQUARE: f64 = 0.05;
/// Steps by a tangent after the first.
pub(crate) const MORE_STEPS: usize = 4;

/// Finds the strain of a section, starting from `strain`; `tensions` and `crossings` belong to the
/// same cables.
#[inline(always)]
pub(crate) fn equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    equilibrium_within(STEP_TOLERANCE, section, (crossings, &[]), tensions, wrench, strain)
}

/// The last step of the sections of a rod whose own iteration ends at a residual.
pub(crate) fn step_tolerance(residual: f64) -> f64 {
    (PART_OF_RESIDUAL * residual).sqrt().max(STEP_TOLERANCE)
}

/// Whether the answer is found by an iteration, which starts from a strain.
#[inline(always)]
pub(crate) fn is_iterated(section: &Section, crossings: &[Crossing]) -> bool {
    crossings.len() > 1 || !crossings.is_empty() && !section.isotropic
}

/// [`equilibrium`] where a Newton step of `tolerance`, as a strain, is the last; by sums over groups of the cables, where there are any: their
/// rounding is another.
#[inline(always)]
pub(crate) fn equilibrium_within(
    tolerance: f64,
    section: &Section,
    (crossings, groups): (&[Crossing], &[CableGroup]),
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    if crossings.is_empty() {
        *strain = section.bare_strain(wrench);
        return Ok(());
    }
    if let ([crossing], [tension], true) = (crossings, tensions, section.isotropic) {
        *strain = one_cable::equilibrium(section, crossing, *tension, wrench)?.strain;
        return Ok(());
    }
    newton_within(tolerance, section, (crossings, groups), tensions, wrench, strain)
}

/// [`equilibrium`] by Newton's method, for any number of cables and any stiffness.
#[inline(always)]
pub(crate) fn newton_equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    newton_within(STEP_TOLERANCE, section, (crossings, &[]), tensions, wrench, strain)
}

#[inline(always)]
fn newton_within(
    tolerance: f64,
    section: &Section,
    cables: (&[Crossing], &[CableGroup]),
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    let problem = Problem { section, cables, tensions, wrench, reach: reach(cables.0) };
    if !undamped(tolerance, &problem, strain) {
        *strain = damped_equilibrium(section, cables.0, tensions, wrench, problem.reach)?;
    }
    Ok(())
}

/// A section under a wrench, and the cables that cross it.
#[derive(Clone, Copy)]
struct Problem<'a> {
    section: &'a Section,
    cables: (&'a [Crossing], &'a [CableGroup]),
    tensions: &'a [f64],
    wrench: BodyWrench,
    reach: f64,
}

/// What a step of Newton's method is computed by.
trait NewtonTangent: Sized {
    /// With the wrench that is not borne; `None` where the potential is not smooth.
    fn at(problem: &Problem<'_>, strain: &Strain) -> Option<(Self, BodyWrench)>;
    fn step(&self, out: BodyWrench) -> Strain;
    /// Whether what a step leaves beside what any step of Newton's method leaves is the square of the tolerance at most.
    fn leaves_square(&self, tolerance: f64, step: &Strain, size: f64) -> bool;
}

impl NewtonTangent for Tangent {
    #[inline(always)]
    fn at(problem: &Problem<'_>, strain: &Strain) -> Option<(Self, BodyWrench)> {
        let Problem { section, cables, tensions, wrench, .. } = *problem;
        linearized(section, cables, tensions, wrench, strain)
    }

    #[inline(always)]
    fn step(&self, out: BodyWrench) -> Strain {
        self.solve(out)
    }

    #[inline(always)]
    fn leaves_square(&self, _: f64, _: &Strain, _: f64) -> bool {
        true
    }
}

impl NewtonTangent for BlockDiagonal {
    #[inline(always)]
    fn at(problem: &Problem<'_>, strain: &Strain) -> Option<(Self, BodyWrench)> {
        let Problem { section, cables: (crossings, _), tensions, wrench, reach } = *problem;
        Self::at(section, crossings, tensions, wrench, reach, strain)
    }

    #[inline(always)]
    fn step(&self, out: BodyWrench) -> Strain {
        self.solve(out)
    }

    #[inline(always)]
    fn leaves_square(&self, tolerance: f64, step: &Strain, size: f64) -> bool {
        Self::leaves_square(self, tolerance, step, size)
    }
}

/// Newton's method without damping; whether it leads to an equilibrium.
#[inline(always)]
fn undamped(tolerance: f64, problem: &Problem<'_>, strain: &mut Strain) -> bool {
    let Problem { section, cables, tensions, .. } = *problem;
    // Of cables in groups the sums of the whole Hessian cost no more.
    match cables.1.is_empty() && BlockDiagonal::applies(tolerance, section, tensions) {
        true => undamped_by::<BlockDiagonal>(tolerance, problem, strain),
        false => undamped_by::<Tangent>(tolerance, problem, strain),
    }
}

/// [`undamped`]. Each tangent serves Newton's step and then others with the same factors, which cost no Hessian, as long as they promise to lead there.
#[inline(always)]
fn undamped_by<T: NewtonTangent>(
    tolerance: f64,
    problem: &Problem<'_>,
    strain: &mut Strain,
) -> bool {
    let Problem { section, cables, tensions, wrench, reach } = *problem;
    for _ in 0..UNDAMPED {
        let Some((tangent, out)) = T::at(problem, strain) else { return false };
        let step = tangent.step(out);
        *strain = *strain + step;
        let first = step_size(&step, reach);
        if first <= tolerance && tangent.leaves_square(tolerance, &step, first) {
            return true;
        }
        if first.is_nan() || first > 1.0 {
            return false;
        }
        let mut last = first;
        for _ in 0..MORE_STEPS {
            let out = imbalance(section, cables, tensions, wrench, strain);
            let step = tangent.step(out);
            *strain = *strain + step;
            let size = step_size(&step, reach);
            let square = PART_OF_SQUARE * (tolerance * tolerance);
            if has_met(square, first, last, size) && tangent.leaves_square(tolerance, &step, size) {
                return true;
            }
            if size.is_nan() || size > first || !promises(square, last, size) {
                break;
            }
            last = size;
        }
    }
    false
}

/// Whether what is left behind a step by an older tangent is below this square: of the third order in the first step by this tangent, and
/// less than this step by the rate at which they get smaller.
#[inline(always)]
fn has_met(square: f64, first: f64, last: f64, size: f64) -> bool {
    first * size <= square && size * size <= square * last
}

/// Whether two more steps that get smaller at the rate of the last two meet it.
#[inline(always)]
fn promises(square: f64, last: f64, size: f64) -> bool {
    let (again, before) = (size * size, last * last);
    again * again <= square * (before * last)
}

/// Distance at which a curvature counts as a strain.
#[inline]
pub(crate) fn reach(crossings: &[Crossing]) -> f64 {
    let widest = |widest: f64, c: &Crossing| widest.max(c.offset.norm_squared());
    crossings.iter().fold(1e-8, widest).sqrt()
}

/// The size of a step as a strain.
#[inline(always)]
fn step_size(step: &Strain, reach: f64) -> f64 {
    step.linear.max_abs().max(reach * step.angular.max_abs())
}

/// The tangent, and the wrench that is not borne; `None` where the potential is not smooth.
#[inline(always)]
fn linearized(
    section: &Section,
    (crossings, groups): (&[Crossing], &[CableGroup]),
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &Strain,
) -> Option<(Tangent, BodyWrench)> {
    let mut out = wrench - section.wrench(strain);
    let mut hessian = Hessian::at(section, strain);
    if !groups.is_empty() {
        let pulls = CableSums::at(groups, tensions, strain);
        hessian.add_all(&pulls);
        return Some((hessian.factor()?, out - pulls.wrench));
    }
    for (crossing, &tension) in crossings.iter().zip(tensions) {
        if tension == 0.0 {
            continue;
        }
        let (unit, per_stretch) = crossing.direction(strain);
        out = out - crossing.wrench(unit * tension);
        hessian.add(crossing.offset, unit, tension * per_stretch);
    }
    Some((hessian.factor()?, out))
}

/// The wrench that neither the section nor its cables bear.
#[inline(always)]
fn imbalance(
    section: &Section,
    (crossings, groups): (&[Crossing], &[CableGroup]),
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &Strain,
) -> BodyWrench {
    let mut out = wrench - section.wrench(strain);
    if !groups.is_empty() {
        return out - CableGroup::wrench(groups, tensions, strain);
    }
    for (crossing, &tension) in crossings.iter().zip(tensions) {
        if tension != 0.0 {
            out = out - crossing.wrench(crossing.direction(strain).0 * tension);
        }
    }
    out
}

/// Newton's method with backtracking on the potential, from the section at rest: it converges
/// always, or finds that the section folds.
#[cold]
pub(crate) fn damped_equilibrium(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    reach: f64,
) -> Result<Strain, SectionFault> {
    let potential = |x: &Strain| {
        let (dv, du) = (x.linear - Vec3::Z, x.angular - section.rest_curvature);
        let elastic = section.energy(x);
        let pulled: f64 =
            crossings.iter().zip(tensions).map(|(c, t)| t * c.tangent(x).norm()).sum();
        elastic + pulled - wrench.linear.dot(dv) - wrench.angular.dot(du)
    };
    let least_stretch = |x: &Strain| {
        crossings
            .iter()
            .zip(tensions)
            .enumerate()
            .filter(|(_, (_, tension))| **tension > 0.0)
            .map(|(i, (c, _))| (i, c.tangent(x).norm()))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let mut x = section.rest_strain();
    let mut value = potential(&x);
    if !value.is_finite() {
        return Err(SectionFault::Diverged);
    }
    let newton = |x: &Strain| {
        let (tangent, out) = linearized(section, (crossings, &[]), tensions, wrench, x)?;
        Some(tangent.solve(out))
    };
    let size = |step: &Strain| step_size(step, reach);
    let mut next = newton(&x);
    for _ in 0..MAX_ITERATIONS {
        let Some(step) = next else { break };
        if size(&step) <= STEP_TOLERANCE {
            let folded = least_stretch(&x).filter(|(_, stretch)| *stretch < FOLDED);
            if let Some((cable, _)) = folded {
                return Err(SectionFault::Folded { cable });
            }
            return Ok(x + step);
        }
        let lower = core::iter::successors(Some(1.0), |fraction| Some(0.5 * fraction))
            .take(BACKTRACKS)
            .map(|fraction| x + step * fraction)
            .map(|trial| (trial, potential(&trial)))
            .find(|(_, trial_value)| *trial_value < value);
        if let Some((trial, trial_value)) = lower {
            (x, value) = (trial, trial_value);
            next = newton(&x);
            continue;
        }
        // The potential is flat to rounding here: near its minimum whole steps get smaller, at an edge of it none does.
        let trial = x + step;
        next = newton(&trial).filter(|after| size(after) < 0.5 * size(&step));
        if next.is_some() {
            x = trial;
        }
    }
    match least_stretch(&x) {
        Some((cable, stretch)) if stretch < NEARLY_FOLDED => {
            let found = raise_tensions(section, crossings, tensions, wrench, reach);
            let is_taut = |x: &Strain| least_stretch(x).is_none_or(|(_, least)| least >= FOLDED);
            found.filter(is_taut).ok_or(SectionFault::Folded { cable })
        }
        _ => Err(SectionFault::Diverged),
    }
}

/// The strain from that without tensions, which are raised to the given ones: where a cable is all but used up, Newton's method from rest ends
/// at the edge where its stretch is zero, though the minimum lies beside it.
fn raise_tensions(
    section: &Section,
    crossings: &[Crossing],
    tensions: &[f64],
    wrench: BodyWrench,
    reach: f64,
) -> Option<Strain> {
    let mut raised = vec![0.0; tensions.len()];
    let mut found = section.rest_strain();
    let raise = |part: f64| {
        raised.iter_mut().zip(tensions).for_each(|(raised, tension)| *raised = part * tension);
        let mut strain = found;
        let cables = (crossings, &[][..]);
        let problem = Problem { section, cables, tensions: &raised, wrench, reach };
        if !undamped(STEP_TOLERANCE, &problem, &mut strain) {
            return Err(Missed { reason: (), is_last: false });
        }
        found = strain;
        Ok(true)
    };
    continuation(&TENSION_STEPS, raise).ok()?;
    Some(found)
}
