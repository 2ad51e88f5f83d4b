//! Where the second camera may be, by each pair alone.

use whipcord_numerics::{Pose, Vec3};

use super::error::RefusedPair;
use super::rig::View;
use crate::camera::lens::Pinhole;
use crate::camera::locate::{Sighting, locate};
use crate::camera::view::Camera;

/// What a pair of photographs shows, and where each camera may be in the frame of the board: a plane may have two poses.
pub(super) struct Pair<'a> {
    number: usize,
    seen: &'a [Vec<Sighting>; 2],
    poses: [Vec<Pose>; 2],
}

impl<'a> Pair<'a> {
    pub(super) fn located(
        number: usize,
        lenses: [&Pinhole; 2],
        sizes: [Option<[u32; 2]>; 2],
        seen: &'a [Vec<Sighting>; 2],
    ) -> Result<Self, RefusedPair> {
        let poses = |camera: usize| {
            let found = locate(lenses[camera], sizes[camera], &seen[camera], None)
                .map_err(|error| RefusedPair::NotLocated { camera, error })?;
            let other = found.other.filter(|_| found.is_ambiguous());
            let other = other.map(|other| other.camera.pose());
            Ok([found.camera.pose()].into_iter().chain(other).collect())
        };
        Ok(Self { number, seen, poses: [poses(0)?, poses(1)?] })
    }
}

/// The relative poses that single pairs have, of boards that look the same after these motions.
pub(super) struct Hypotheses<'a> {
    pub(super) cameras: &'a [Camera; 2],
    pub(super) pairs: &'a [Pair<'a>],
    pub(super) symmetries: &'a [Pose],
}

/// A pair counts with no more than this, in pixels: one that is wrong does not decide.
const MOST: f64 = 50.0;

impl Hypotheses<'_> {
    fn motions(&self) -> impl Iterator<Item = Pose> + '_ {
        [Pose::IDENTITY].into_iter().chain(self.symmetries.iter().copied())
    }

    /// Relative poses that explain all pairs well as far as single pairs tell, the best first.
    pub(super) fn ranked(&self) -> Vec<Pose> {
        /// By a single pair a pose is known to a few pixels.
        const NEAR: f64 = 3.0;
        let mut ranked: Vec<(f64, Pose)> = Vec::new();
        for pair in self.pairs {
            for first in &pair.poses[0] {
                for second in &pair.poses[1] {
                    for motion in self.motions() {
                        let relative = first.inverse() * (motion * *second);
                        let scores = self.pairs.iter().map(|pair| self.best(pair, relative).0);
                        ranked.push((scores.map(|rms| rms.min(MOST)).sum(), relative));
                    }
                }
            }
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = ranked.first().map_or(0.0, |(score, _)| *score);
        let most = NEAR * (least + self.pairs.len() as f64);
        ranked.retain(|(score, _)| *score <= most);
        ranked.into_iter().map(|(_, relative)| relative).collect()
    }

    /// How well a relative pose explains what the second camera saw, with which pose of the first and which motion of the
    /// board, by its number.
    fn best(&self, pair: &Pair<'_>, relative: Pose) -> (f64, Pose, usize) {
        let mut best = (f64::INFINITY, pair.poses[0][0], 0);
        for first in &pair.poses[0] {
            for (number, motion) in self.motions().enumerate() {
                // Seen with the motion, the camera is where its inverse leads it.
                let camera = self.cameras[1].at(motion.inverse() * (*first * relative));
                let rms = camera.map_or(f64::INFINITY, |camera| rms(&camera, &pair.seen[1]));
                if rms < best.0 {
                    best = (rms, *first, number);
                }
            }
        }
        best
    }

    /// What the pairs show, with all points in the frame of the board as the first camera numbers it, and where the first
    /// camera is there.
    pub(super) fn views(&self, relative: Pose) -> Vec<View> {
        let view = |pair: &Pair<'_>| {
            let (_, first, number) = self.best(pair, relative);
            let motion = self.motions().nth(number).unwrap_or(Pose::IDENTITY);
            let moved = |at: &Sighting| Sighting {
                point: if number == 0 { at.point } else { motion.transform(at.point) },
                pixel: at.pixel,
            };
            let second = pair.seen[1].iter().map(moved).collect();
            View {
                number: pair.number,
                seen: [pair.seen[0].clone(), second],
                first,
                renumbered: number > 0,
            }
        };
        self.pairs.iter().map(view).collect()
    }
}

fn rms(camera: &Camera, seen: &[Sighting]) -> f64 {
    let square = |at: &Sighting| {
        let [u, v] = camera.project(at.point).ok()?;
        Some((u - at.pixel[0]).powi(2) + (v - at.pixel[1]).powi(2))
    };
    let sum: Option<f64> = seen.iter().map(square).sum();
    sum.map_or(f64::INFINITY, |sum| (sum / seen.len() as f64).sqrt())
}

impl View {
    /// The points' centre.
    pub(super) fn centre(&self) -> Vec3 {
        let sum = self.seen[0].iter().fold(Vec3::ZERO, |sum, at| sum + at.point);
        sum / self.seen[0].len() as f64
    }
}
