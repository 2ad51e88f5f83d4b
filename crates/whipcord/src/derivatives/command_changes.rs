//! How an answer changes with the commands of its cables, and with nothing else: what the inverse problems ask for at every trial.

use std::sync::Arc;

use whipcord_numerics::{Twist, Vec3};

use super::change::{Change, Places};
use super::of_answer::Solved;
use super::quadrature::Quadrature;
use super::replay::Answer;
use super::tension_motions::TensionMotions;
use crate::section::Fault;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::hold::{Critical, HeldCables, Hold, HoldScratch};

/// How the nodes of a grid, the lengths of the cables and what the base bears change with the tension of each cable at constant other
/// tensions; cables in the order of the grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct TensionChanges {
    cables: usize,
    /// Motion of every node, base frame; those of a cable one after the other.
    motions: Vec<Twist>,
    /// Of cable i by the tension of cable j in m/N at `[j * cables + i]`.
    lengths: Vec<f64>,
    base: Vec<Wrench>,
    /// Memory of [`Self::without_load`].
    quadrature: Quadrature,
    tension_motions: TensionMotions,
}

/// A cable as a command sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommandedCable {
    pub command: Command,
    /// What a tension of 1 N adds to its length in m.
    pub compliance: f64,
    pub is_taut: bool,
}

impl TensionChanges {
    /// For so many cables and nodes, all zero.
    pub fn prepare(&mut self, cables: usize, nodes: usize) {
        self.cables = cables;
        self.motions.clear();
        self.motions.resize(cables * nodes, Twist::default());
        self.lengths.clear();
        self.lengths.resize(cables * cables, 0.0);
        self.base.clear();
        self.base.resize(cables, Wrench::default());
    }

    /// The motions of all nodes, the rates of all lengths, and that of what the base bears, with the tension of a cable.
    pub fn of(&mut self, cable: usize) -> (&mut [Twist], &mut [f64], &mut Wrench) {
        let nodes = self.motions.len() / self.cables;
        (
            &mut self.motions[cable * nodes..(cable + 1) * nodes],
            &mut self.lengths[cable * self.cables..(cable + 1) * self.cables],
            &mut self.base[cable],
        )
    }

    /// Of an answer without load: sections move by themselves, and what is beyond them is carried along.
    pub fn without_load(&mut self, solved: &Solved<'_>) -> Result<(), Fault> {
        let answer = solved.answer();
        self.quadrature.linearize_points(&answer)?;
        let Answer { grid, tensions, poses, .. } = answer;
        self.prepare(tensions.len(), grid.len() + 1);
        let Self { quadrature, tension_motions, motions, lengths, .. } = self;
        tension_motions.of(quadrature, poses, motions, lengths);
        Ok(())
    }

    /// By the command of each cable of the robot, with all other commands held.
    pub fn by_commands(
        &self,
        grid: &Grid,
        cables: &[CommandedCable],
        order: &[usize],
    ) -> Result<Vec<Change>, Critical> {
        let n = self.cables;
        // Nothing else is asked for than the commands: none but the cables of given length are held.
        let is_held =
            |i: usize| cables[i].is_taut && matches!(cables[i].command, Command::Length { .. });
        let held = match (0..n).any(is_held) {
            true => {
                let compliance = |place: usize| cables[place].compliance;
                let by_tension = |i: usize, j: usize| self.lengths[j * n + i];
                let mut held = HeldCables::new(n, by_tension, compliance, is_held, is_held)?;
                held.settle(0.0);
                Some(held)
            }
            false => None,
        };
        let places = Arc::new(Places {
            stations: (0..grid.stations.len()).collect(),
            disks: (grid.stations.len()..grid.stations.len() + grid.disks.len()).collect(),
            tip: grid.stations.len() + grid.disks.len(),
        });
        let nodes: Vec<usize> =
            grid.stations.iter().chain(&grid.disks).copied().chain([grid.len()]).collect();
        let mut place_of = vec![0; n];
        order.iter().enumerate().for_each(|(place, &cable)| place_of[cable] = place);
        let mut changes = Vec::with_capacity(n);
        let mut scratch = HoldScratch::default();
        let mut tensions = vec![0.0; n];
        let mut moving = Vec::with_capacity(n);
        for &place in &place_of {
            let is_tension = matches!(cables[place].command, Command::Tension(_));
            let lengths = &self.lengths[place * n..(place + 1) * n];
            if let Some(held) = &held {
                let of = (place, is_tension, lengths);
                held.commanded_into(Hold::Commands, of, &mut scratch, &mut tensions);
            } else {
                tensions.fill(0.0);
                tensions[place] = if is_tension { 1.0 } else { 0.0 };
            }
            moving.clear();
            moving.extend(tensions.iter().copied().enumerate().filter(|(_, t)| *t != 0.0));
            let lengths =
                |cable: usize| moving.iter().map(|(by, t)| t * self.lengths[by * n + cable]).sum();
            let (twists, base) = self.motions(&nodes, &moving);
            changes.push(Change {
                places: places.clone(),
                twists,
                strains: Vec::new(),
                base,
                lengths: place_of.iter().map(|&place| lengths(place)).collect(),
                tensions: place_of.iter().map(|&place| tensions[place]).collect(),
            });
        }
        if changes.iter().all(Change::is_finite) { Ok(changes) } else { Err(Critical) }
    }

    /// Motions of nodes, and of what the base bears, with these changes of tensions, of cables in the order of the grid.
    fn motions(&self, nodes: &[usize], tensions: &[(usize, f64)]) -> (Vec<Twist>, Wrench) {
        let n = self.cables;
        let all = self.motions.len() / n;
        let mut twists = vec![Twist::default(); nodes.len()];
        let mut base = Wrench::default();
        for &(place, tension) in tensions {
            let motions = &self.motions[place * all..(place + 1) * all];
            for (twist, &node) in twists.iter_mut().zip(nodes) {
                twist.linear += tension * motions[node].linear;
                twist.angular += tension * motions[node].angular;
            }
            base.force += tension * self.base[place].force;
            base.moment += tension * self.base[place].moment;
        }
        (twists, base)
    }
}

impl Change {
    fn is_finite(&self) -> bool {
        let numbers = self.lengths.iter().chain(&self.tensions);
        let tip = self.twists.last().copied().unwrap_or_default();
        let vectors = [tip.linear, tip.angular, self.base.force, self.base.moment];
        numbers.copied().chain(vectors.map(Vec3::norm)).all(f64::is_finite)
    }
}
