//! From a case whose answer is known to another.

use crate::case::{CableCommand, Case, Loads, Profile, Shortening};
use crate::solution::Solution;

/// The cases between two.
#[derive(Clone, Debug)]
pub(super) struct Homotopy<'a> {
    from: Vec<CableCommand>,
    /// From where on the way all of the loads act, and from where the commands change.
    loaded_at: f64,
    actuated_from: f64,
    to: &'a Case,
}

impl<'a> Homotopy<'a> {
    /// From the robot at rest, whose loads and commands grow together.
    pub fn from_rest(to: &'a Case) -> Self {
        let rest = |command: &CableCommand| CableCommand {
            tension: command.tension.map(|_| 0.0),
            shortening: command.shortening.map(|_| Shortening::Length(0.0)),
        };
        let from = to.commands.iter().map(rest).collect();
        Self { from, loaded_at: 1.0, actuated_from: 0.0, to }
    }

    /// The same where cables rub in their holes: the loads are put on first.
    pub fn from_rest_loaded_first(to: &'a Case) -> Self {
        let is_light = to.loads == Loads::default();
        let middle =
            if is_light && to.obstacles.iter().all(|o| o.movable.is_none()) { 0.0 } else { 0.5 };
        Self { loaded_at: middle, actuated_from: middle, ..Self::from_rest(to) }
    }

    /// From the answer to a case with the same loads.
    pub fn from_answer(answer: &Solution, to: &'a Case) -> Self {
        let before =
            |(command, cable): (&CableCommand, &crate::solution::CableState)| CableCommand {
                tension: command.tension.map(|there| cable.tension.unwrap_or(there)),
                shortening: command
                    .shortening
                    .map(|_| Shortening::Length(cable.initial_length - cable.length)),
            };
        let from = to.commands.iter().zip(&answer.cables).map(before).collect();
        Self::loaded(from, to)
    }

    /// From commands under the same loads.
    pub fn from_commands(from: &[CableCommand], to: &'a Case) -> Self {
        Self::loaded(from.to_vec(), to)
    }

    const fn loaded(from: Vec<CableCommand>, to: &'a Case) -> Self {
        Self { from, loaded_at: 0.0, actuated_from: 0.0, to }
    }

    /// The part of the loads that acts on the way.
    pub fn load_factor(&self, way: f64) -> f64 {
        if way >= self.loaded_at { 1.0 } else { way / self.loaded_at }
    }

    /// How far the commands went from those before to those of the case.
    pub fn command_factor(&self, way: f64) -> f64 {
        ((way - self.actuated_from) / (1.0 - self.actuated_from)).max(0.0)
    }

    /// The case so far on the way, from 0 to 1, without obstacles; `initial` are the initial lengths of the
    /// cables in m.
    pub fn at(&self, way: f64, initial: &[f64]) -> Case {
        let load = self.load_factor(way);
        let way = self.command_factor(way);
        let between = |(k, (from, to)): (usize, (&CableCommand, &CableCommand))| CableCommand {
            tension: to.tension.map(|to| mix(from.tension.unwrap_or(0.0), to, way)),
            shortening: to.shortening.map(|to| {
                let metres = |s: Shortening| s.in_metres(initial[k]);
                let from = from.shortening.map_or(0.0, metres);
                if way == 1.0 { to } else { Shortening::Length(mix(from, metres(to), way)) }
            }),
        };
        let pairs = self.from.iter().zip(&self.to.commands).enumerate();
        Case {
            commands: pairs.map(between).collect(),
            loads: if load == 1.0 { self.to.loads.clone() } else { scaled(&self.to.loads, load) },
            base: self.to.base,
            before: Vec::new(),
            loads_before: Vec::new(),
            motors: Vec::new(),
            independent: false,
            obstacles: Vec::new(),
        }
    }
}

fn mix(from: f64, to: f64, way: f64) -> f64 {
    if way == 1.0 { to } else { from + way * (to - from) }
}

/// All loads times a factor.
fn scaled(loads: &Loads, factor: f64) -> Loads {
    let mut loads = loads.clone();
    loads.gravity = loads.gravity.map(|gravity| gravity * factor);
    loads.tip_force *= factor;
    loads.tip_moment *= factor;
    for point in &mut loads.points {
        point.force *= factor;
        point.moment *= factor;
    }
    for load in &mut loads.distributed {
        match &mut load.profile {
            Profile::Constant { force, moment, .. } => {
                *force *= factor;
                *moment *= factor;
            }
            Profile::Linear { force, moment, .. } => {
                force.iter_mut().chain(moment).for_each(|value| *value *= factor);
            }
        }
    }
    loads
}
