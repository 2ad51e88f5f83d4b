//! The strain of a section in equilibrium: Newton's method on its potential.

use whipcord_numerics::Vec3;

use super::cable_sums::{CableGroup, CableSums};
use super::crossing::{BodyWrench, Crossing, Strain};
use super::fault::{FOLDED, SectionFault};
use super::one_cable;
use super::properties::Section;
use super::tangent::Hessian;

/// A Newton step this small, as a strain, leaves an error of its square.
pub(crate) const STEP_TOLERANCE: f64 = 2e-7;
/// Part of the residual of a rod that its sections may leave.
const PART_OF_RESIDUAL: f64 = 2e-3;
const MAX_ITERATIONS: usize = 200;
/// Halvings of a step.
const BACKTRACKS: usize = 40;
/// Undamped steps that are tried before the potential is watched.
pub(crate) const UNDAMPED: usize = 5;

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
    (crossings, groups): (&[Crossing], &[CableGroup]),
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &mut Strain,
) -> Result<(), SectionFault> {
    let reach = reach(crossings);
    for _ in 0..UNDAMPED {
        let Some(step) = newton_step(section, (crossings, groups), tensions, wrench, strain) else {
            break;
        };
        *strain = *strain + step;
        let size = step.linear.max_abs().max(reach * step.angular.max_abs());
        if size <= tolerance {
            return Ok(());
        }
        if size.is_nan() || size > 1.0 {
            break;
        }
    }
    *strain = damped_equilibrium(section, crossings, tensions, wrench, reach)?;
    Ok(())
}

/// Distance at which a curvature counts as a strain.
#[inline]
pub(crate) fn reach(crossings: &[Crossing]) -> f64 {
    let widest = |widest: f64, c: &Crossing| widest.max(c.offset.norm_squared());
    crossings.iter().fold(1e-8, widest).sqrt()
}

/// The Newton step; `None` where the potential is not smooth.
#[inline(always)]
fn newton_step(
    section: &Section,
    (crossings, groups): (&[Crossing], &[CableGroup]),
    tensions: &[f64],
    wrench: BodyWrench,
    strain: &Strain,
) -> Option<Strain> {
    let borne = section.wrench(strain);
    let mut force = wrench.linear - borne.linear;
    let mut moment = wrench.angular - borne.angular;
    let mut hessian = Hessian::at(section, strain);
    if !groups.is_empty() {
        let pulls = CableSums::at(groups, tensions, strain);
        force -= pulls.wrench.linear;
        moment -= pulls.wrench.angular;
        hessian.add_all(&pulls);
        return Some(hessian.factor()?.solve(BodyWrench { linear: force, angular: moment }));
    }
    for (crossing, &tension) in crossings.iter().zip(tensions) {
        if tension == 0.0 {
            continue;
        }
        let (pull, stretch) = crossing.pull(strain);
        force -= tension * pull.linear;
        moment -= tension * pull.angular;
        hessian.add(crossing.offset, &pull, tension / stretch);
    }
    Some(hessian.factor()?.solve(BodyWrench { linear: force, angular: moment }))
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
    let newton = |x: &Strain| newton_step(section, (crossings, &[]), tensions, wrench, x);
    let size = |step: &Strain| step.linear.max_abs().max(reach * step.angular.max_abs());
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
        Some((cable, stretch)) if stretch < 0.05 => Err(SectionFault::Folded { cable }),
        _ => Err(SectionFault::Diverged),
    }
}
