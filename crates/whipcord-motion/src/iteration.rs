//! The iteration of one stage: Newton's method on velocities and strains together, whose linearisation may serve several steps.

use whipcord_numerics::Vec3;

use crate::contacts::Contacts;
use crate::drives::Drives;
use crate::friction::Friction;
use crate::lengths::Lengths;
use crate::loads::NodeLoads;
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;
use crate::surroundings::Surroundings;
use crate::unilateral::Unilateral;

/// What moves: the rod and what acts on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mechanics<'a> {
    pub rod: &'a Rod,
    pub loads: &'a NodeLoads,
}

/// How an iteration begins, and when it ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    /// Whether it starts from a prediction by the last rates, not from the last state.
    pub predicts: bool,
    /// Estimated change of the strains by all further iterations.
    pub tolerance: f64,
    /// Whether it goes on until rounding keeps it from getting better.
    pub to_rounding: bool,
    /// Whether a linearisation serves several iterations and stages.
    pub reuses: bool,
}

/// An iteration that does not converge; the last change of the strains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stalled(pub f64);

/// A stage with what it needs to be solved.
#[derive(Clone, Debug)]
pub(crate) struct Solver {
    pub stage: Stage,
    pub lengths: Lengths,
    pub contacts: Contacts,
    /// Of cables with friction; in an equilibrium to start from their tensions are known.
    pub friction: Option<Friction>,
    /// Whether the tensions of passages stay what they are.
    pub holds_passages: bool,
    unilateral: Unilateral,
    /// Drag in N·s/m² along the axes of the sections.
    pub drag: Vec3,
    /// Whether the linearisation at hand is of this step.
    pub is_linearised: bool,
    pub iterations: usize,
    pub factorisations: usize,
}

/// Iterations of a stage.
const MOST: usize = 25;
/// Iterations with one linearisation.
const MOST_REUSES: usize = 6;
/// A linearisation that leaves more than this part of the change is not used again.
const SLOW: f64 = 0.3;
/// A change below which rounding is all that is left.
const SETTLED: f64 = 1e-11;
/// A change below which rounding may be all that is left.
const ROUNDING: f64 = 1e-9;

impl Solver {
    pub fn new(
        rod: &Rod,
        drives: Drives,
        drag: Vec3,
        surroundings: Option<Surroundings>,
        friction: Option<Friction>,
    ) -> Self {
        Self {
            stage: Stage::new(rod),
            lengths: Lengths::new(rod, drives),
            contacts: Contacts::new(rod, surroundings),
            friction,
            holds_passages: false,
            unilateral: Unilateral::new(rod),
            drag,
            is_linearised: false,
            iterations: 0,
            factorisations: 0,
        }
    }

    /// Solves the stage from where its unknowns stand.
    pub fn solve(
        &mut self,
        mechanics: Mechanics<'_>,
        scheme: &Scheme,
        control: &Control,
    ) -> Result<(), Stalled> {
        let reuses = control.reuses && !self.has_inequalities();
        let (mut before, mut since_fresh, mut growths) = (f64::INFINITY, 0, 0);
        for number in 0..MOST {
            let fresh = !(reuses && self.is_linearised) || since_fresh >= MOST_REUSES;
            let size = self.iterate(mechanics, scheme, fresh).ok_or(Stalled(f64::INFINITY))?;
            since_fresh = if fresh { 1 } else { since_fresh + 1 };
            let ratio = if number == 0 { 1.0 } else { size / before };
            if !size.is_finite() {
                return Err(Stalled(size));
            }
            if control.to_rounding {
                if size < 1e-15 || (size < ROUNDING && ratio > 0.5 && number > 0) {
                    return Ok(());
                }
            } else {
                // Where a body touches is known to rounding of its own.
                let may_be_rounding = !self.contacts.list.is_empty() && number > 0 && ratio > 0.5;
                if may_be_rounding && size < ROUNDING {
                    return Ok(());
                }
                let left = if ratio < 0.9 { size * ratio / (1.0 - ratio) } else { size };
                if left <= control.tolerance && (ratio < 0.9 || size <= 0.1 * control.tolerance) {
                    return Ok(());
                }
            }
            if ratio > SLOW && number > 0 {
                self.is_linearised = false;
            }
            if size > 2.0 * before {
                growths += 1;
            }
            if growths > 3 || size > 1e3 {
                return Err(Stalled(size));
            }
            before = size;
        }
        // What so many iterations do not make smaller is rounding: of short parts, whose tolerance is less.
        if before < SETTLED { Ok(()) } else { Err(Stalled(before)) }
    }

    /// Whether cables are driven by their lengths or obstacles are near.
    pub fn has_inequalities(&self) -> bool {
        !(self.lengths.cables.is_empty()
            && self.contacts.list.is_empty()
            && self.friction.is_none())
    }

    /// One iteration; the size of its change.
    pub fn iterate(
        &mut self,
        mechanics: Mechanics<'_>,
        scheme: &Scheme,
        fresh: bool,
    ) -> Option<f64> {
        let Mechanics { rod, loads } = mechanics;
        let stage = &mut self.stage;
        let touches = !self.contacts.list.is_empty();
        if let Some(base) = stage.free_base {
            stage.base = base.pose(stage.velocities[0]);
        }
        if loads.any_dead || touches || rod.has_chords() {
            pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
            if scheme.conserves {
                stage.find_conserving_forces(rod, loads.gravity, scheme);
            }
        }
        stage.assemble(rod, scheme, loads.gravity, self.drag, fresh);
        if touches {
            self.contacts.refresh(rod, scheme, stage);
            self.contacts.add_forces(scheme, stage, fresh);
        }
        self.iterations += 1;
        if fresh {
            self.is_linearised = false;
            self.factorisations += 1;
            stage.matrix.factor().ok()?;
            self.is_linearised = true;
        }
        stage.matrix.solve(&mut stage.residual);
        for change in &mut stage.residual {
            *change = *change * -1.0;
        }
        let Self { stage, lengths, contacts, friction, unilateral, .. } = self;
        match friction.as_mut().filter(|_| !self.holds_passages) {
            Some(friction) if touches => {
                let parts = (friction, &*lengths, contacts);
                unilateral.solve_with_holes(rod, scheme, stage, parts).ok()?;
            }
            Some(friction) => friction.solve(rod, scheme, stage, &lengths.drives).ok()?,
            None if touches || !lengths.cables.is_empty() => {
                unilateral.solve(rod, scheme, stage, lengths, contacts)?;
            }
            None => {}
        }
        stage.advance(rod);
        Some(stage.size_of_change(rod, scheme))
    }
}
