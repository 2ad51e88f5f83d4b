//! At which positions of the sliders an exported page has solved frames, and what lies between them.
//!
//! Between frames it is the strains that are interpolated, and not the positions: without external loads the strains of a
//! rod are nearly linear in the tensions, however far it bends. In each slider it is by the cubic through four positions.

use whipcord::equally_spaced;

use crate::protocol::Command;

/// The positions of one slider.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What a cable or motor is told, ascending, in N, m or rad; one value where the slider does not move.
    pub values: Vec<f64>,
    /// What the file has.
    own: Command,
}

/// The product of the positions of all sliders, and where the file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// One for each slider.
    pub axes: Vec<Axis>,
    initial: Vec<Command>,
}

/// Positions of a slider at most: a robot with one cable is as smooth by fewer.
const MOST_POSITIONS: usize = 41;
/// Positions that the interpolation in a slider takes.
const STENCIL: usize = 4;
/// Frames of a model at most, where each slider has as many positions as the interpolation takes.
const MOST_FRAMES: usize = 2500;

/// Frames and the share of each; those of an interpolation come to 1.
pub type Weights = Vec<(usize, f64)>;

impl Grid {
    /// As many positions of each slider, from where to where it reaches, as give no more frames than `most`; the last sliders
    /// do not move where even two positions of each would be too many.
    pub fn new(initial: &[Command], reach: impl Fn(usize) -> [f64; 2], most: usize) -> Self {
        let sliders = initial.len() as u32;
        let fits = |&positions: &usize| {
            let most = if positions > STENCIL { most.min(MOST_FRAMES) } else { most };
            positions.checked_pow(sliders).is_some_and(|frames| frames < most.max(1))
        };
        let positions = (2..=MOST_POSITIONS).rev().find(fits);
        let moving = if positions.is_some() { initial.len() } else { most.max(1).ilog2() as usize };
        let positions = positions.unwrap_or(2);
        let axes = initial.iter().enumerate().map(|(k, &own)| {
            let [least, end] = reach(k);
            let values = if k < moving {
                equally_spaced(least, end, positions).collect()
            } else {
                vec![own.value()]
            };
            Axis { values, own }
        });
        Self { axes: axes.collect(), initial: initial.to_vec() }
    }

    /// How many frames there are: those of the grid, and that of the file.
    pub fn frames(&self) -> usize {
        self.own() + 1
    }

    /// The frame of the file, after those of the grid.
    fn own(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// What the sliders say in a frame. The last one changes from frame to frame.
    pub fn commands(&self, frame: usize) -> Vec<Command> {
        if frame == self.own() {
            return self.initial.clone();
        }
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

    /// What the sliders say where each slider is this far from its least to its greatest value.
    pub fn between(&self, fractions: &[f64]) -> Vec<Command> {
        let each = self.axes.iter().zip(fractions).map(|(axis, fraction)| {
            let (least, most) = (axis.values[0], axis.values[axis.values.len() - 1]);
            axis.command(least + (most - least) * fraction)
        });
        each.collect()
    }

    /// The frames that the answer to what the sliders say is interpolated from: by cubics, or linearly between
    /// the nearest where one of theirs has no solution; `None` where one of the nearest has none.
    pub fn around(
        &self,
        commands: &[Command],
        is_solved: impl Fn(usize) -> bool,
    ) -> Option<Weights> {
        [STENCIL, 2].into_iter().find_map(|stencil| {
            let weights = self.through_own(commands, stencil);
            weights.iter().all(|&(frame, _)| is_solved(frame)).then_some(weights)
        })
    }

    /// The interpolation is off by something where the file has the sliders: taking that away, the less the farther from
    /// there, makes it go through the frame of the file.
    fn through_own(&self, commands: &[Command], stencil: usize) -> Weights {
        let mut all = self.tensor(commands, stencil);
        let each = self.axes.iter().zip(commands).zip(&self.initial);
        let near: f64 = each.map(|((axis, &at), &own)| axis.nearness(at, own)).product();
        if near > 0.0 {
            all.push((self.own(), near));
            all.extend(
                self.tensor(&self.initial, stencil).into_iter().map(|(f, w)| (f, -near * w)),
            );
        }
        all
    }

    /// The product of the interpolations in each slider.
    fn tensor(&self, commands: &[Command], stencil: usize) -> Weights {
        let mut all = vec![(0, 1.0)];
        for (axis, command) in self.axes.iter().zip(commands) {
            let each = axis.lagrange(command.value(), stencil);
            let count = axis.values.len();
            all = all
                .into_iter()
                .flat_map(|(frame, weight)| {
                    each.iter().map(move |&(at, share)| (frame * count + at, weight * share))
                })
                .collect();
        }
        all
    }
}

impl Axis {
    fn command(&self, value: f64) -> Command {
        self.own.with_value(value)
    }

    /// From 1 where the slider is as in the file to 0 at the distance of two positions.
    fn nearness(&self, at: Command, own: Command) -> f64 {
        let [first, second, ..] = self.values[..] else { return 1.0 };
        (1.0 - (at.value() - own.value()).abs() / (second - first)).max(0.0)
    }

    /// Lagrange's polynomial through the positions around a value: the share of each, none of them 0.
    fn lagrange(&self, at: f64, stencil: usize) -> Weights {
        let (values, count) = (&self.values, self.values.len());
        let at = at.clamp(values[0], values[count - 1]);
        let nodes = stencil.min(count);
        // The cell that the value is in, in the middle of the stencil where there is room.
        let cell = values.partition_point(|&v| v <= at).clamp(1, count.max(2) - 1) - 1;
        let start = (cell + 1).saturating_sub(nodes / 2).min(count - nodes);
        let share = |k: usize| -> f64 {
            let others = (start..start + nodes).filter(|&j| j != k);
            others.map(|j| (at - values[j]) / (values[k] - values[j])).product()
        };
        let each = (start..start + nodes).map(|k| (k, share(k)));
        each.filter(|&(_, share)| share != 0.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::Ranges;

    const RANGES: Ranges =
        Ranges { tension: 10.0, shortening: 0.02, force: 1.0, moment: 1.0, gravity: 1.0 };

    fn within_ranges(initial: &[Command], most: usize) -> Grid {
        Grid::new(initial, |k| RANGES.reach(initial[k]), most)
    }

    #[test]
    fn frames_fit_and_the_file_is_among_them() {
        for cables in [1, 2, 3, 6, 11, 40] {
            let initial = vec![Command::Tension(3.3); cables];
            let grid = within_ranges(&initial, 4500);
            assert!(grid.frames() <= 4500);
            assert_eq!(grid.commands(grid.frames() - 1), initial);
            assert!(cables > 6 || grid.axes[0].values.len() >= STENCIL);
        }
        let grid = within_ranges(&[Command::Shortening(0.0)], 2500);
        assert_eq!(grid.axes[0].values.len(), MOST_POSITIONS);
        assert_eq!(grid.commands(0), [Command::Shortening(-0.02)]);
        assert_eq!(within_ranges(&[], 10).commands(1), []);
    }

    fn interpolated(grid: &Grid, at: &[Command], of: impl Fn(&[Command]) -> f64) -> f64 {
        let around = grid.around(at, |_| true).unwrap();
        let sum: f64 = around.iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        around.iter().map(|&(frame, w)| w * of(&grid.commands(frame))).sum()
    }

    const INITIAL: [Command; 3] =
        [Command::Tension(3.3), Command::Shortening(0.004), Command::Tension(0.0)];

    #[test]
    fn cubics_are_interpolated_exactly_and_the_file_whatever_is() {
        let cubic = |commands: &[Command]| -> f64 {
            let [a, b, c] = [0, 1, 2].map(|k| commands[k].value());
            0.01 * a * a * a - 300.0 * b * b * c + a * c * c + 2.0
        };
        let grid = within_ranges(&INITIAL, 500);
        for fractions in [[0.0; 3], [1.0; 3], [0.31, 0.77, 0.02], [0.5, 0.0, 1.0]] {
            let commands = grid.between(&fractions);
            let found = interpolated(&grid, &commands, cubic);
            assert!((found - cubic(&commands)).abs() < 1e-9, "{fractions:?}");
        }
        let rough = |commands: &[Command]| (7.0 * commands[0].value()).sin();
        assert!((interpolated(&grid, &INITIAL, rough) - rough(&INITIAL)).abs() < 1e-12);
    }

    #[test]
    fn a_frame_without_a_solution_is_gone_around_where_it_is_not_among_the_nearest() {
        let grid = within_ranges(&INITIAL, 500);
        let at = grid.between(&[0.95, 0.95, 0.95]);
        let nearest = grid.tensor(&at, 2);
        let far = grid.tensor(&at, STENCIL).into_iter().map(|(frame, _)| frame);
        let far =
            far.filter(|&frame| nearest.iter().all(|&(near, _)| near != frame)).min().unwrap();
        assert_eq!(grid.around(&at, |frame| frame != far), Some(nearest.clone()));
        assert_eq!(grid.around(&at, |frame| frame != nearest[0].0), None);
    }
}
