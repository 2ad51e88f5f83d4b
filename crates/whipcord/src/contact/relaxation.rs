//! Where the robot loses its equilibrium and jumps: it is let go against dampers, from where it was last in equilibrium, until it
//! has come to rest.

use whipcord_numerics::Vec3;

use super::model::Compliant;
use super::path::{NUDGE, PathTracker, Stop};
use crate::case::Case;

/// Stiffness of the dampers, in units of EI/L³, at first, at least and at most.
const STIFFNESS: [f64; 3] = [100.0, 1e-3, 1e7];
/// A step that moves no cross-section farther than this part of the length softens the dampers.
const SHORT: f64 = 0.05;
/// After a step that moves none farther than this it may have come to rest.
const AT_REST: f64 = 2e-3;
/// After so far a way, as a part of the length, no nudge is needed any more.
const NUDGED: f64 = 5e-3;
/// It is at rest where the dampers push with less than this part of the nudge.
const STILL: f64 = 0.1;
/// Two places of rest no farther apart than this part of the length are one.
const SAME_PLACE: f64 = 1e-3;
/// Steps against dampers.
const STEPS: usize = 200;
/// Attempts that bring it no nearer to rest.
const ATTEMPTS: usize = 24;

impl<M: Compliant> PathTracker<'_, M> {
    /// The stable equilibrium under a case that the robot comes to from where it is.
    pub(super) fn relax(&mut self, case: &Case) -> Result<(), Stop> {
        let relaxed = self.come_to_rest(case);
        self.nudge = None;
        self.dampers.all.clear();
        relaxed
    }

    fn come_to_rest(&mut self, case: &Case) -> Result<(), Stop> {
        let [mut stiffness, least, most] = STIFFNESS;
        let mut stop = Stop::Slips;
        let (mut attempts, mut far, mut nudged) = (0, 0.0, NUDGED * self.length);
        // Where it was last at rest without the nudge.
        let mut rested: Option<Vec<Vec3>> = None;
        for _ in 0..STEPS {
            let kept = self.kept();
            self.odd = None;
            let is_nudged = far < nudged;
            self.nudge = is_nudged.then(|| self.sideways());
            self.pairs.begin_step(self.model, &self.scene);
            let before = self.centres();
            self.dampers.anchor(self.model, self.length, stiffness);
            match self.touch(case, &before) {
                Ok(None) => {}
                Err(stop @ (Stop::Spent(_) | Stop::Cancelled)) => return Err(stop),
                missed => {
                    if let Err(why) = missed {
                        stop = why;
                    }
                    self.restore(kept);
                    stiffness *= 3.0;
                    if stiffness > most {
                        return Err(stop);
                    }
                    continue;
                }
            }
            self.scene.begin_step();
            let moved = self.farthest_from(&before);
            far += moved;
            // Of the dampers, relative to the force scale.
            let push = stiffness * moved / self.length;
            let softer = moved / (SHORT * self.length);
            stiffness = (stiffness * softer.clamp(0.25, 1.0)).max(least);
            if moved < AT_REST * self.length {
                match self.let_go(case) {
                    Ok(()) => return Ok(()),
                    Err(why @ (Stop::Spent(_) | Stop::Cancelled)) => return Err(why),
                    Err(why) => stop = why,
                }
                if push < STILL * NUDGE {
                    if is_nudged {
                        // It leans against the nudge, and goes on where that is taken away.
                        nudged = far;
                    } else {
                        // It is at rest where it would not stay.
                        let is_back = rested.is_some_and(|there| {
                            self.farthest_from(&there) < SAME_PLACE * self.length
                        });
                        if is_back {
                            break;
                        }
                        rested = Some(self.centres());
                        nudged = far + NUDGED * self.length;
                    }
                }
                attempts += 1;
                if attempts == ATTEMPTS {
                    break;
                }
            }
        }
        Err(stop)
    }

    /// Without dampers and nudge, where it is near that.
    fn let_go(&mut self, case: &Case) -> Result<(), Stop> {
        let kept = self.kept();
        let dampers = core::mem::take(&mut self.dampers.all);
        let nudge = self.nudge.take();
        let before = self.centres();
        self.odd = None;
        let stop = match self.touch(case, &before) {
            Ok(None) => return Ok(()),
            Ok(Some(_)) => Stop::Slips,
            Err(stop) => stop,
        };
        self.restore(kept);
        (self.dampers.all, self.nudge) = (dampers, nudge);
        Err(stop)
    }

    pub(super) fn centres(&self) -> Vec<Vec3> {
        (0..self.model.watched().len()).map(|k| self.model.centre(k)).collect()
    }

    /// How far a cross-section is from where it was, in m.
    pub(super) fn farthest_from(&self, before: &[Vec3]) -> f64 {
        let moved = |(k, old): (usize, &Vec3)| (self.model.centre(k) - *old).norm();
        before.iter().enumerate().map(moved).fold(0.0, f64::max)
    }
}
