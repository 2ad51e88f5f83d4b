//! Where the way to an answer is lost: the obstacles are drawn out of the robot as it is without them, and moved against it.
//!
//! A robot that has lost its equilibrium moves on a way that statics does not know, and comes to one of several equilibria. This way
//! leads to one of them; no step of it passes through an obstacle.

use whipcord_numerics::{Pose, Vec3};

use super::drawn_out::DrawnOut;
use super::noted::Noting;
use super::path::{Acting, MET, PathTracker, Stop};
use super::scene::{Present, is_pipe};
use crate::case::Case;
use crate::error::SolveError;
use crate::solution::Solution;

/// Clearance at the beginning, as a part of the length.
const MARGIN: f64 = 1e-3;
/// An obstacle is drawn out by so many lengths at most.
const FARTHEST: f64 = 4.0;
/// How much farther each next distance is that is tried.
const FARTHER: f64 = 1.3;
/// So far on the way beyond where that was lost the robot is looked for where it is not found at the end.
const BEYOND: f64 = 1.0 / 24.0;

impl<M: Noting> PathTracker<'_, M> {
    /// An equilibrium under a case that the way to was lost, for this reason: from the answer without the obstacles, there or a little
    /// beyond where it was lost, at last or first, and on from there. The reason where there is none, and where this way does not exist: movable objects and
    /// pipes hold the robot where it is.
    pub(super) fn approach(
        &mut self,
        asked: &Case,
        at: &impl Fn(f64) -> Case,
        acting: impl Fn(f64) -> Acting,
        lost: SolveError,
    ) -> Result<(), SolveError> {
        let is_ended =
            matches!(lost, SolveError::Cancelled { .. } | SolveError::BudgetSpent { .. });
        if is_ended || self.objects.count() > 0 || self.scene.iter().any(|(_, o)| is_pipe(o)) {
            return Err(lost);
        }
        let reached = self.reached;
        let lost_at = self.lost_at.filter(|&at| at + BEYOND < reached);
        let beyond = [Some(reached), lost_at].into_iter().flatten().map(|at| at + BEYOND);
        let ways = core::iter::once(1.0).chain(beyond.filter(|&way| way < 1.0));
        for (attempt, way) in ways.enumerate() {
            // Those that begin beyond where the way was lost share what they may spend.
            if attempt < 2 {
                self.renew_budget();
            }
            let between = |part: f64| if part == 1.0 { 1.0 } else { way + part * (1.0 - way) };
            let came = self.come_from_outside(asked, &|part| at(way * part)).and_then(|()| {
                if way == 1.0 {
                    return Ok(());
                }
                self.go(asked, |part| at(between(part)), |part| acting(between(part)))
            });
            match came {
                Ok(()) => {
                    self.slipped_at.get_or_insert(reached);
                    self.lose_notes();
                    return Ok(());
                }
                Err(error @ SolveError::Cancelled { .. }) => return Err(error),
                // The answer without the obstacles may have had a part of the budget.
                Err(error @ SolveError::BudgetSpent { .. }) if self.model.meter().is_spent() => {
                    return Err(error);
                }
                Err(_) => {}
            }
        }
        Err(lost)
    }

    fn come_from_outside(
        &mut self,
        asked: &Case,
        at: &impl Fn(f64) -> Case,
    ) -> Result<(), SolveError> {
        let case = &at(1.0);
        let free = self.model.solve_free(case)?;
        // Where another attempt has left off.
        self.arrange(Acting::ALL);
        self.drawn_out = None;
        self.scene.rub(true);
        self.odd = None;
        self.pairs.near.clear();
        self.dampers.all.clear();
        self.model.reset();
        self.scene.keep(Present::None);
        let stable = self.come_free(asked, at, &free);
        self.scene.keep(Present::All);
        stable?;
        self.is_off_answer = false;
        self.draw_out()?;
        // A robot that jumps comes to rest at places that its friction does not remember.
        self.scene.rub(false);
        self.go(asked, |_| case.clone(), |way| Acting { left: 1.0 - way, ..Acting::ALL })?;
        self.scene.rub(true);
        self.model.keep();
        self.scene.begin_step();
        self.pairs.grip_all(self.model, &self.scene);
        let before = self.centres();
        self.odd = None;
        self.touch(case, &before).map(|_| ()).map_err(|stop| self.obstructed(1.0, Some(stop)))
    }

    /// A stable equilibrium without obstacles, where the robot has one.
    fn come_free(
        &mut self,
        asked: &Case,
        at: &impl Fn(f64) -> Case,
        free: &Solution,
    ) -> Result<(), SolveError> {
        let case = &at(1.0);
        self.model.start_from(free);
        // One that is bent much by its loads is not found again from what an answer tells.
        if self.rest(case).is_err() || self.model.residual() > MET {
            self.model.reset();
            self.rest(&at(0.0))?;
            self.go(asked, at, |_| Acting::ALL)?;
        }
        if free.diagnostics.is_unstable() || !self.model.stands_alone() {
            let kept = self.kept();
            self.scene.begin_step();
            match self.relax(case) {
                Ok(()) => {}
                Err(Stop::Cancelled) => return Err(SolveError::Cancelled { last_load: None }),
                // Contacts may hold what is not stable alone.
                Err(_) => self.restore(kept),
            }
        }
        Ok(())
    }

    /// Draws each obstacle out of the robot, against the normal where it is deepest.
    fn draw_out(&mut self) -> Result<(), SolveError> {
        let count = self.scene.count();
        let homes: Vec<Pose> = (0..count).map(|k| self.scene.get(k).pose).collect();
        let mut ways = vec![Vec3::ZERO; count];
        let margin = MARGIN * self.length;
        for (number, way) in ways.iter_mut().enumerate() {
            let (mut out, mut distance) = (None, margin);
            while let Some((normal, depth)) =
                self.pairs.overlap_with(self.model, self.scene.get(number), margin)
            {
                let out = *out.get_or_insert(-normal);
                distance = (FARTHER * distance).max(distance + depth);
                if distance > FARTHEST * self.length {
                    return Err(SolveError::NoDerivatives);
                }
                *way = out * distance;
                let position = homes[number].position + *way;
                self.scene.place(number, Pose { position, ..homes[number] });
            }
        }
        self.drawn_out = Some(DrawnOut { homes, ways });
        Ok(())
    }
}
