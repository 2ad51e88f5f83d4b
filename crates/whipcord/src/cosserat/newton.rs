//! The linear system of one Newton step on eq. (7) of [`super::statics`].

use whipcord_numerics::{DenseLu, Vec3};

use super::grid::Grid;
use super::lengths::Command;
use super::loaded::Shot;
use super::sensitivity::Sensitivity;

/// The unknowns and the linear system of eq. (7).
#[derive(Clone, Debug, Default)]
pub(super) struct Newton {
    pub point: Point,
    pub trial: Point,
    free: Vec<usize>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    lu: DenseLu,
    pub sensitivity: Sensitivity,
}

/// A point of the iteration.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub base_moment: Vec3,
    pub tensions: Vec<f64>,
}

/// Of a cable's own compliance: keeps the step defined where more straight cables are taut than
/// lengths are independent.
const REGULARISATION: f64 = 1e-8;

/// Scales that make the residuals of eq. (7) comparable.
pub(super) struct Scales {
    moment: f64,
    tension: f64,
    length: f64,
}

impl Scales {
    /// Of a rod of this length on this grid.
    pub fn of(grid: &Grid, length: f64) -> Self {
        let (node, _) = grid.shooting.at(0, 0, 0);
        let bending = node.section.stiffness.bending;
        let stiffness = bending.x.min(bending.y).min(bending.z);
        let moment = stiffness / length;
        Self { moment, tension: moment / length, length }
    }
}

/// Size of eq. (7), without dimension.
pub(super) fn residual(commands: &[Command], point: &Point, shot: &Shot, scales: &Scales) -> f64 {
    let moment = shot.excess.norm() / (scales.moment + point.base_moment.norm());
    let mut worst = moment;
    for (i, command) in commands.iter().enumerate() {
        if matches!(command, Command::Length { .. }) {
            let slack = command.slackness(point.tensions[i], shot.lengths[i]) / scales.length;
            worst = worst.max((point.tensions[i] / scales.tension).min(slack).abs());
        }
    }
    // A NaN must not pass for a small residual.
    if worst.is_finite() && moment.is_finite() { worst } else { f64::INFINITY }
}

impl Newton {
    /// Solves for the full step from the derivatives of the last shot; the cables that eq. (7)
    /// says are slack go to zero tension.
    pub fn solve_step(&mut self, commands: &[Command], shot: &Shot, scales: &Scales) -> bool {
        let cables = commands.len();
        let Sensitivity { excess: excess_by, lengths: lengths_by, .. } = &self.sensitivity;
        let columns = excess_by.len();
        let point = &self.point;
        self.free.clear();
        for (i, command) in commands.iter().enumerate() {
            if matches!(command, Command::Length { .. }) {
                let slack = command.slackness(point.tensions[i], shot.lengths[i]) / scales.length;
                if point.tensions[i] / scales.tension > slack {
                    self.free.push(i);
                }
            }
        }
        let n = 3 + self.free.len();
        self.matrix.clear();
        self.step.clear();
        for axis in 0..3 {
            for j in 0..3 {
                self.matrix.push(excess_by[j][axis]);
            }
            for &j in &self.free {
                let by = excess_by[3 + j][axis];
                self.matrix.push(by * scales.tension / scales.moment);
            }
            let mut right = -shot.excess[axis];
            for j in self.released(commands) {
                right += excess_by[3 + j][axis] * point.tensions[j];
            }
            self.step.push(right / scales.moment);
        }
        for &i in &self.free {
            let row = &lengths_by[i * columns..(i + 1) * columns];
            let Command::Length { compliance, .. } = commands[i] else { continue };
            for j in 0..3 {
                self.matrix.push(row[j] * scales.moment / scales.length);
            }
            for &j in &self.free {
                let own = if i == j { compliance - REGULARISATION * row[3 + i] } else { 0.0 };
                self.matrix.push((row[3 + j] - own) * scales.tension / scales.length);
            }
            let mut right = command_slack(commands, point, shot, i);
            for j in self.released(commands) {
                right += row[3 + j] * point.tensions[j];
            }
            self.step.push(right / scales.length);
        }
        if self.lu.factor(n, &self.matrix).is_err() {
            return false;
        }
        self.lu.solve(&mut self.step);
        if !self.step.iter().all(|x| x.is_finite()) {
            return false;
        }
        for i in 0..3 {
            self.step[i] *= scales.moment;
        }
        for x in &mut self.step[3..] {
            *x *= scales.tension;
        }
        // From here on the step is one of all unknowns.
        self.step.resize(3 + cables, 0.0);
        for k in (0..self.free.len()).rev() {
            self.step.swap(3 + k, 3 + self.free[k]);
        }
        for j in 0..cables {
            if matches!(commands[j], Command::Length { .. }) && !self.free.contains(&j) {
                self.step[3 + j] = -self.point.tensions[j];
            }
        }
        true
    }

    /// Cables driven by length that go to zero tension.
    fn released<'a>(&'a self, commands: &'a [Command]) -> impl Iterator<Item = usize> + 'a {
        (0..commands.len()).filter(move |&i| {
            matches!(commands[i], Command::Length { .. })
                && !self.free.contains(&i)
                && self.point.tensions[i] != 0.0
        })
    }

    /// Size of the step relative to the scales of its unknowns.
    pub fn relative_step(&self, scales: &Scales) -> f64 {
        let moment = Vec3::new(self.step[0], self.step[1], self.step[2]).norm()
            / (scales.moment + self.point.base_moment.norm());
        let of_tension = |(d, t): (&f64, &f64)| d.abs() / (scales.tension + t);
        self.step[3..].iter().zip(&self.point.tensions).map(of_tension).fold(moment, f64::max)
    }

    pub fn aim_trial(&mut self, fraction: f64) {
        let moment = Vec3::new(self.step[0], self.step[1], self.step[2]);
        self.trial.base_moment = self.point.base_moment + fraction * moment;
        self.trial.tensions.clear();
        let moved = |(t, d): (&f64, &f64)| (t + fraction * d).max(0.0);
        self.trial.tensions.extend(self.point.tensions.iter().zip(&self.step[3..]).map(moved));
    }
}

fn command_slack(commands: &[Command], point: &Point, shot: &Shot, i: usize) -> f64 {
    commands[i].slackness(point.tensions[i], shot.lengths[i])
}
