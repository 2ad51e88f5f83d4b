//! The linear system of one Newton step on eq. (7) of [`super::statics`].

use whipcord_numerics::{DenseLu, Vec3};

use super::loaded::Trajectory;
use super::sensitivity::Sensitivity;
use crate::shape::Wrench;
use crate::statics::command::{Command, LENGTH_REGULARISATION};
use crate::statics::scales::Scales;

/// The unknowns and the linear system of eq. (7).
#[derive(Clone, Debug, Default)]
pub(super) struct Newton {
    pub point: Point,
    pub trial: Point,
    change: Point,
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
    /// Force that the followers exert on the base, in N.
    pub follower_force: Vec3,
    pub tensions: Vec<f64>,
}

impl Point {
    /// Whether the load bends the rod by more than about a radian.
    pub fn is_strong(&self, scales: &Scales) -> bool {
        self.base_moment.norm() > scales.moment
    }
}

/// Size of eq. (7), without dimension.
pub(super) fn residual(
    commands: &[Command],
    point: &Point,
    trajectory: &Trajectory,
    scales: &Scales,
) -> f64 {
    let moment = trajectory.excess.moment.norm() / (scales.moment + point.base_moment.norm());
    let force = trajectory.excess.force.norm() / (scales.force + point.follower_force.norm());
    let mut worst = moment.max(force);
    for (i, command) in commands.iter().enumerate() {
        let units = scales.of_cables();
        worst = worst.max(command.complementarity_residual(
            i,
            &point.tensions,
            &trajectory.lengths,
            units,
        ));
    }
    // A NaN must not pass for a small residual.
    if worst.is_finite() && (moment + force).is_finite() { worst } else { f64::INFINITY }
}

impl Newton {
    /// Solves for the full step from the derivatives of the last shot; the cables that eq. (7)
    /// says are slack go to zero tension.
    pub fn solve_step(
        &mut self,
        commands: &[Command],
        trajectory: &Trajectory,
        scales: &Scales,
    ) -> bool {
        let cables = commands.len();
        let Sensitivity { excess: excess_by, lengths: lengths_by, .. } = &self.sensitivity;
        let columns = excess_by.len();
        let point = &self.point;
        self.free.clear();
        for (i, command) in commands.iter().enumerate() {
            if command.is_active(i, &point.tensions, &trajectory.lengths, scales.of_cables()) {
                self.free.push(i);
            }
        }
        // Unknowns at the base: the moment, and the followers' force where there is one.
        let base = if lengths_by.is_empty() { columns } else { columns - cables };
        let n = base + self.free.len();
        let unit = |i: usize| if i < 3 { scales.moment } else { scales.force };
        self.matrix.clear();
        self.step.clear();
        for i in 0..base {
            let component = |w: &Wrench| if i < 3 { w.moment[i] } else { w.force[i - 3] };
            for j in 0..base {
                self.matrix.push(component(&excess_by[j]) * unit(j) / unit(i));
            }
            for &j in &self.free {
                self.matrix.push(component(&excess_by[base + j]) * scales.force / unit(i));
            }
            let mut right = -component(&trajectory.excess);
            for j in self.released(commands) {
                right += component(&excess_by[base + j]) * point.tensions[j];
            }
            self.step.push(right / unit(i));
        }
        for &i in &self.free {
            let row = &lengths_by[i * columns..(i + 1) * columns];
            let Command::Length { compliance, .. } = commands[i] else { continue };
            for j in 0..base {
                self.matrix.push(row[j] * unit(j) / scales.length);
            }
            for &j in &self.free {
                let own =
                    if i == j { compliance - LENGTH_REGULARISATION * row[base + i] } else { 0.0 };
                self.matrix.push((row[base + j] - own) * scales.force / scales.length);
            }
            let mut right = command_slack(commands, point, trajectory, i);
            for j in self.released(commands) {
                right += row[base + j] * point.tensions[j];
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
        for (i, x) in self.step.iter_mut().enumerate() {
            *x *= unit(i);
        }
        self.distribute(commands, base);
        true
    }

    /// Takes the solution of the linear system apart into the step of each unknown.
    fn distribute(&mut self, commands: &[Command], base: usize) {
        let vector = |i: usize| Vec3::new(self.step[i], self.step[i + 1], self.step[i + 2]);
        self.change.base_moment = vector(0);
        self.change.follower_force = if base == 6 { vector(3) } else { Vec3::ZERO };
        self.change.tensions.clear();
        self.change.tensions.extend(commands.iter().zip(&self.point.tensions).map(
            |(command, tension)| match command {
                Command::Length { .. } => -tension,
                Command::Tension(_) => 0.0,
            },
        ));
        for (k, &i) in self.free.iter().enumerate() {
            self.change.tensions[i] = self.step[base + k];
        }
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
        let (change, point) = (&self.change, &self.point);
        let relative = |d: f64, of: f64, scale: f64| d.abs() / (scale + of);
        let moment = relative(change.base_moment.norm(), point.base_moment.norm(), scales.moment);
        let force =
            relative(change.follower_force.norm(), point.follower_force.norm(), scales.force);
        let tensions = change.tensions.iter().zip(&point.tensions);
        tensions.map(|(d, t)| relative(*d, *t, scales.force)).fold(moment.max(force), f64::max)
    }

    /// Sets the trial point this fraction of the step ahead.
    pub fn set_trial(&mut self, fraction: f64) {
        let Self { point, trial, change, .. } = self;
        trial.base_moment = point.base_moment + fraction * change.base_moment;
        trial.follower_force = point.follower_force + fraction * change.follower_force;
        trial.tensions.clear();
        let moved = |(t, d): (&f64, &f64)| (t + fraction * d).max(0.0);
        trial.tensions.extend(point.tensions.iter().zip(&change.tensions).map(moved));
    }
}

fn command_slack(commands: &[Command], point: &Point, trajectory: &Trajectory, i: usize) -> f64 {
    commands[i].slackness(point.tensions[i], trajectory.lengths[i])
}
