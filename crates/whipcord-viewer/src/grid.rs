//! At which positions of the sliders an exported page has solved frames, and what lies between them.
//!
//! Between frames it is the strains that are interpolated, linearly in each slider, and not the positions: without external
//! loads the strains of a rod are nearly linear in the tensions, however far it bends.

use whipcord::{Pose, Twist};

use crate::protocol::{Command, Ranges};

/// The positions of one slider.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What a cable is told, ascending, in N or m; one value where the slider does not move.
    pub values: Vec<f64>,
    tension: bool,
}

/// The product of the positions of all sliders.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// One for each cable.
    pub axes: Vec<Axis>,
}

/// Positions of a slider at most: a robot with one cable is as smooth by fewer.
const MOST_POSITIONS: usize = 41;

impl Grid {
    /// As many positions of each slider as give no more frames than `most`; the sliders of the last cables do not move
    /// where even two positions of each would be too many.
    pub fn new(initial: &[Command], ranges: &Ranges, most: usize) -> Self {
        let cables = initial.len() as u32;
        let fits = |positions: &usize| {
            positions.checked_pow(cables).is_some_and(|frames| frames <= most.max(1))
        };
        let positions = (2..=MOST_POSITIONS).rev().find(fits);
        let moving = if positions.is_some() { initial.len() } else { most.max(1).ilog2() as usize };
        let positions = positions.unwrap_or(2);
        let axes = initial.iter().enumerate().map(|(k, command)| {
            let (tension, at, least, end) = match *command {
                Command::Tension(at) => (true, at, 0.0, ranges.tension),
                Command::Shortening(at) => (false, at, -ranges.shortening, ranges.shortening),
            };
            let values = if k < moving { spread(least, end, positions, at) } else { vec![at] };
            Axis { values, tension }
        });
        Self { axes: axes.collect() }
    }

    /// How many frames there are.
    pub fn frames(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// What the cables are told in a frame. The last cable changes from frame to frame.
    pub fn commands(&self, frame: usize) -> Vec<Command> {
        let mut rest = frame;
        let mut commands: Vec<Command> = (self.axes.iter().rev())
            .map(|axis| {
                let value = axis.values[rest % axis.values.len()];
                rest /= axis.values.len();
                axis.command(value)
            })
            .collect();
        commands.reverse();
        commands
    }

    /// What the cables are told where each slider is this far from its least to its greatest value.
    pub fn between(&self, fractions: &[f64]) -> Vec<Command> {
        let each = self.axes.iter().zip(fractions).map(|(axis, fraction)| {
            let (least, most) = (axis.values[0], axis.values[axis.values.len() - 1]);
            axis.command(least + (most - least) * fraction)
        });
        each.collect()
    }

    /// The frames around what the cables are told, and the share of each.
    pub fn around(&self, commands: &[Command]) -> Vec<(usize, f64)> {
        let mut all = vec![(0, 1.0)];
        for (axis, command) in self.axes.iter().zip(commands) {
            let (Command::Tension(value) | Command::Shortening(value)) = *command;
            let last = axis.values.len() - 1;
            let low = axis.values[1..last.max(1)].partition_point(|&v| v <= value).min(last);
            let high = (low + 1).min(last);
            let width = axis.values[high] - axis.values[low];
            let share = if width > 0.0 {
                ((value - axis.values[low]) / width).clamp(0.0, 1.0)
            } else {
                0.0
            };
            all = all
                .into_iter()
                .flat_map(|(frame, weight)| {
                    [(low, weight * (1.0 - share)), (high, weight * share)]
                        .map(|(at, weight)| (frame * axis.values.len() + at, weight))
                })
                .filter(|&(_, weight)| weight > 0.0)
                .collect();
        }
        all
    }
}

impl Axis {
    fn command(&self, value: f64) -> Command {
        if self.tension { Command::Tension(value) } else { Command::Shortening(value) }
    }
}

/// Values from end to end, at equal distances but for the one that is moved to where the file has the slider.
fn spread(least: f64, most: f64, count: usize, at: f64) -> Vec<f64> {
    let last = (count - 1) as f64;
    let mut values: Vec<f64> =
        (0..count).map(|k| least + (most - least) * k as f64 / last).collect();
    if at > least && at < most && count > 2 {
        let nearest = ((at - least) / (most - least) * last).round() as usize;
        values[nearest.clamp(1, count - 2)] = at;
    }
    values
}

/// The pose at each end of these strains, from the base on; `lengths` are those of the pieces.
pub fn integrate(base: Pose, strains: &[Twist], lengths: &[f64]) -> Vec<Pose> {
    let mut poses = vec![base];
    let mut pose = base;
    for (&strain, &length) in strains.iter().zip(lengths) {
        pose = pose * Pose::exp(strain * length);
        poses.push(pose);
    }
    poses
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGES: Ranges =
        Ranges { tension: 10.0, shortening: 0.02, force: 1.0, moment: 1.0, gravity: 1.0 };

    #[test]
    fn frames_fit_and_the_file_is_among_them() {
        for cables in [1, 2, 3, 6, 11, 40] {
            let initial = vec![Command::Tension(3.3); cables];
            let grid = Grid::new(&initial, &RANGES, 2500);
            assert!(grid.frames() <= 2500);
            let own = (0..grid.frames()).any(|frame| grid.commands(frame) == initial);
            assert_eq!(own, cables <= 6, "{cables}");
        }
        let grid = Grid::new(&[Command::Shortening(0.0)], &RANGES, 2500);
        assert_eq!(grid.axes[0].values.len(), MOST_POSITIONS);
        assert_eq!(grid.commands(0), [Command::Shortening(-0.02)]);
        assert_eq!(Grid::new(&[], &RANGES, 10).frames(), 1);
    }

    #[test]
    fn what_is_linear_is_interpolated_exactly() {
        let initial = [Command::Tension(3.3), Command::Shortening(0.004), Command::Tension(0.0)];
        let grid = Grid::new(&initial, &RANGES, 100);
        let linear = |commands: &[Command]| -> f64 {
            let each = commands.iter().zip([1.0, 700.0, -2.0]);
            each.map(|(c, f)| match c {
                Command::Tension(v) | Command::Shortening(v) => f * v,
            })
            .sum()
        };
        for fractions in [[0.0; 3], [1.0; 3], [0.31, 0.77, 0.02], [0.5, 0.0, 1.0]] {
            let commands = grid.between(&fractions);
            let around = grid.around(&commands);
            let sum: f64 = around.iter().map(|(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-14);
            let found: f64 =
                around.iter().map(|&(frame, w)| w * linear(&grid.commands(frame))).sum();
            assert!((found - linear(&commands)).abs() < 1e-12, "{fractions:?}");
        }
    }
}
