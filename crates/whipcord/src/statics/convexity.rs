//! Loads so weak that a rod has one equilibrium, and a stable one.
//!
//! The energy `½‖ξ − ξ*‖²_K + Σ τᵢ‖pᵢ′‖ − F·p′` of a rod under dead forces is a function of its strains `ξ = (v, u)`, and what cables add
//! is convex. With `ω′ = R δu` the frames along `ξ + ε δξ` have `R″ = (α̂ + ω̂²) R`, `α′ = ω × ω′`, so that the second derivative of
//! the work of the forces is
//!
//! ```text
//! ∫ F·(α × Rv + ω × (ω × Rv) + 2 ω × R δv) ds
//! ```
//!
//! Let `ω = ρ e`, `‖e‖ = 1`. Then `‖δu‖² = ρ′² + ρ²‖e′‖²`, and with `m′ = −‖F‖‖v‖`, `m(L) = 0` the first term is no more than
//! `∫ m ‖ω × ω′‖ ds = ∫ m ρ²‖e′‖ ds ≤ ∫ k ρ²‖e′‖² + m²ρ²/4k ds`. So
//!
//! ```text
//! E″ ≥ ∫ k ρ′² − q ρ² ds,   q = ‖F‖‖v‖ + m²/4k + ‖F‖²/κ                      (16)
//! ```
//!
//! with the least bending or twisting stiffness k and the least shear or axial stiffness κ. This is positive for all ρ with `ρ(0) = 0` where
//! `y′ = −q − y²/k`, `y(L) = 0` has a solution as far as the base: a condition on the loads and the robot, whatever its shape.
//! In equilibrium `‖v − e₃‖ ≤ (‖F‖ + Στᵢ)/κ`, so that every equilibrium is a strict minimum; an energy that grows with the strains has
//! one minimum then, since between two there would be a pass.
//!
//! A dead moment `l` that acts at a place has no energy. To the symmetric part of the tangent it adds `∫ l·(ω × ω′) ds` from the base to there, no more than `‖l‖` to `m`, and
//! `½ l·(ω₁ × ω₂)` there to the skew part. Where (16) is positive the tangent of each equilibrium has a positive determinant, whatever its skew part. The strains of equilibria are
//! bounded for all parts of the load, so that the degree of the equations, the sum of the signs of these determinants, is that of the rod without load, 1: there is one equilibrium.
//! For a verdict of stability (16) has to be positive with `½‖l‖ρ²` taken off, too: the equilibrium cannot diverge then ([`crate::cosserat`], dead moments). Both are asked for at once.
//!
//! Where it is so for all tensions up to some limits, cables of given lengths have one equilibrium within these limits, too: the least energy `W(τ)` under
//! tensions is a concave function with the lengths for its slope, so that the tensions that give them solve a convex problem, (6) of [`super::lengths`], and of two
//! solutions either has the shape of the other. Under dead moments the lengths are no slope, but a monotone function of the tensions, which is as good: with the tangent `T` and the
//! work `B` of unit tensions on the strains `δτᵀδℓ = −(B δτ)ᵀ T⁻¹ (B δτ)` is not positive.

use super::grid::{Grid, SHOOTING_NODES, Softest};
use super::loads::AppliedLoads;

/// Whether (16) shows that an equilibrium under these tensions (N, in the order of the grid) and the loads is the only one, with
/// `E″ ≥ least ∫ δuᵀ K δu ds`.
pub(crate) fn is_shown(grid: &Grid, applied: &AppliedLoads, tensions: &[f64], least: f64) -> bool {
    if applied.any_follower() {
        return false;
    }
    let (mut y, mut moment) = (0.0, 0.0);
    for (k, (step, softest)) in grid.steps.iter().zip(&grid.softest).enumerate().rev() {
        let Some(Softest { bending, compliance }) = *softest else { return false };
        let at_end = applied.moment(k + 1).norm();
        let spread = applied.line(k).map_or(0.0, |line| {
            let [start, end] = [0.0, 1.0].map(|t| line.moment(t).norm());
            start.max(end)
        });
        y += 0.5 * at_end;
        moment += at_end + spread * step.length;
        let squares = (0..SHOOTING_NODES.len()).map(|j| applied.force(k, j).norm_squared());
        let force = squares.fold(0.0, f64::max).sqrt();
        let tension: f64 = tensions.iter().take(step.active).sum();
        let stretch = 1.0 + (force + tension) * compliance;
        let stiffness = (1.0 - least) * bending;
        moment += force * stretch * step.length;
        let by_forces = force * (stretch + force * compliance);
        let q = by_forces + 0.25 * moment * moment / stiffness + 0.5 * spread;
        // The greatest `m` of a step counts for all of it, and what `q` adds: no less than the solution.
        let near = y + q * step.length;
        let left = 1.0 - near * step.length / stiffness;
        if left <= 0.0 {
            return false;
        }
        y = near / left;
    }
    y.is_finite()
}
