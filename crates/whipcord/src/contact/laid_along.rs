//! A robot that finds no way into a pipe is laid along its bore and let go: where nothing rubs, nothing remembers how it came in.

use whipcord_numerics::Vec3;

use super::bore_line::BoreLine;
use super::noted::Noting;
use super::pairs::BackboneContacts;
use super::path::{PathTracker, Stop};
use super::scene::Present;
use crate::case::Case;

/// Stiffness of what draws the robot to the line, in units of EI/L³.
const GUIDING: f64 = 1e7;
/// That of the dampers against which it is let go, at first, before it moves freely to its equilibrium, and at most.
const LETTING_GO: [f64; 3] = [1e5, 100.0, 1e7];
/// How much softer they are from step to step, at least and at most; by the latter they are stiffer after a step that found no equilibrium.
const SOFTER: [f64; 2] = [1.3, 8.0];
/// The first, the longest and the least step to the bends of the line, as parts of them.
const STEPS: [f64; 3] = [0.05, 0.25, 1e-3];

impl<M: Noting> PathTracker<'_, M> {
    /// The line of the pipe that it is inserted into, where there is one only and nothing remembers the way in.
    pub(super) fn only_bore(&self) -> Option<BoreLine> {
        let mut pipes = self.scene.iter();
        match (pipes.next(), pipes.next()) {
            (Some((_, pipe)), None) if self.forgets_way_in => BoreLine::new(pipe, self.length),
            _ => None,
        }
    }

    /// A stable equilibrium at rest in a pipe, from where the robot lies along its line.
    pub(super) fn lay_along(&mut self, case: &Case, line: &BoreLine) -> Result<(), Stop> {
        self.scene.keep(Present::None);
        let bent = self.bend_along(case, line);
        self.scene.keep(Present::Pipes);
        self.dampers.all.clear();
        bent?;
        self.is_going_in = true;
        self.pairs.backbone = BackboneContacts::AtWatchedPlaces;
        let relaxed = self.relax_to_walls(case);
        self.is_going_in = false;
        self.pairs.backbone = BackboneContacts::Anywhere;
        self.dampers.all.clear();
        relaxed?;
        self.relax(case)
    }

    /// Lets it come to the walls in steps against dampers, which are not judged, until it is nearly at rest.
    fn relax_to_walls(&mut self, case: &Case) -> Result<(), Stop> {
        let [mut stiffness, least, most] = LETTING_GO;
        let [least_softer, most_softer] = SOFTER;
        let mut softer = most_softer;
        while stiffness > least {
            let kept = self.kept();
            let before = self.centres();
            self.odd = None;
            self.scene.begin_step();
            self.pairs.begin_step(self.model, &self.scene);
            self.dampers.anchor(self.model, self.length, stiffness);
            self.is_on_way = true;
            let touched = self.touch(case, &before);
            self.is_on_way = false;
            match touched {
                Ok(None) => {
                    stiffness /= softer;
                    softer = most_softer.min(1.5 * softer);
                }
                Err(stop @ (Stop::Spent(_) | Stop::Lost(_) | Stop::Cancelled)) => return Err(stop),
                missed => {
                    self.restore(kept);
                    stiffness *= most_softer;
                    softer = least_softer.max(softer.sqrt());
                    if stiffness > most {
                        return Err(missed.err().unwrap_or(Stop::Slips));
                    }
                }
            }
        }
        Ok(())
    }

    /// Bends it as the line is, against no obstacle.
    fn bend_along(&mut self, case: &Case, line: &BoreLine) -> Result<(), Stop> {
        let [mut step, longest, least] = STEPS;
        let mut bent = 0.0;
        let mut before: Vec<Vec3> = Vec::new();
        while bent < 1.0 {
            let kept = self.kept();
            let next = f64::min(bent + step, 1.0);
            self.odd = None;
            self.scene.begin_step();
            before.clear();
            before.extend(self.centres());
            let poses = |places: &[f64]| line.poses(next, places.iter().copied());
            self.dampers.guide(self.model, self.length, GUIDING, poses);
            match self.touch(case, &before) {
                Ok(None) => {
                    bent = next;
                    step = longest.min(2.0 * step);
                }
                Err(stop @ (Stop::Spent(_) | Stop::Lost(_) | Stop::Cancelled)) => return Err(stop),
                missed => {
                    self.restore(kept);
                    step *= 0.4;
                    if step < least {
                        return Err(missed.err().unwrap_or(Stop::Slips));
                    }
                }
            }
        }
        Ok(())
    }
}
