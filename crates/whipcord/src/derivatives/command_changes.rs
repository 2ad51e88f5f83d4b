//! How an answer changes with the commands of its cables, and with nothing else: what the inverse problems ask for at every trial.

use whipcord_numerics::{Twist, Vec3};

use super::change::{Change, Places};
use super::of_answer::Solved;
use super::quadrature::Quadrature;
use super::replay::Answer;
use crate::section::Fault;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::hold::{Critical, HeldCables, Hold};

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
        let mut quadrature = Quadrature::default();
        let answer = solved.answer();
        quadrature.linearize_points(&answer)?;
        let Answer { grid, tensions, poses, .. } = answer;
        let cables = tensions.len();
        self.prepare(cables, grid.len() + 1);
        for cable in 0..cables {
            let (motions, lengths, _) = self.of(cable);
            let mut motion = Twist::default();
            for (k, step) in grid.steps.iter().enumerate() {
                let arm = poses[k + 1].position - poses[k].position;
                motion.linear += motion.angular.cross(arm);
                if cable < step.active {
                    let of_step = (k, step.active, cables);
                    let moved =
                        quadrature.by_tension(of_step, cable, |other, by| lengths[other] += by);
                    motion.linear += moved.linear;
                    motion.angular += moved.angular;
                }
                motions[k + 1] = motion;
            }
        }
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
        let mut held = HeldCables::new(
            n,
            |i, j| self.lengths[j * n + i],
            |place| cables[place].compliance,
            |place| cables[place].is_taut,
            |place| matches!(cables[place].command, Command::Length { .. }),
        )?;
        held.settle(0.0);
        let places = Places {
            stations: (0..grid.stations.len()).collect(),
            disks: (grid.stations.len()..grid.stations.len() + grid.disks.len()).collect(),
            tip: grid.stations.len() + grid.disks.len(),
        };
        let nodes: Vec<usize> =
            grid.stations.iter().chain(&grid.disks).copied().chain([grid.len()]).collect();
        let mut place_of = vec![0; n];
        order.iter().enumerate().for_each(|(place, &cable)| place_of[cable] = place);
        let mut changes = Vec::with_capacity(n);
        for &place in &place_of {
            let is_tension = matches!(cables[place].command, Command::Tension(_));
            let lengths = &self.lengths[place * n..(place + 1) * n];
            let tensions = held.commanded(Hold::Commands, place, is_tension, lengths);
            changes.push(self.change(&nodes, &places, &tensions, &place_of));
        }
        if changes.iter().all(Change::is_finite) { Ok(changes) } else { Err(Critical) }
    }

    /// With these changes of all tensions.
    fn change(
        &self,
        nodes: &[usize],
        places: &Places,
        tensions: &[f64],
        place_of: &[usize],
    ) -> Change {
        let n = self.cables;
        let all = self.motions.len() / n;
        let mut twists = vec![Twist::default(); nodes.len()];
        let mut lengths = vec![0.0; n];
        let mut base = Wrench::default();
        for (place, &tension) in tensions.iter().enumerate().filter(|(_, tension)| **tension != 0.0)
        {
            let motions = &self.motions[place * all..(place + 1) * all];
            for (twist, &node) in twists.iter_mut().zip(nodes) {
                twist.linear += tension * motions[node].linear;
                twist.angular += tension * motions[node].angular;
            }
            for (length, by) in lengths.iter_mut().zip(&self.lengths[place * n..]) {
                *length += tension * by;
            }
            base.force += tension * self.base[place].force;
            base.moment += tension * self.base[place].moment;
        }
        let of_robot = |values: &[f64]| place_of.iter().map(|&place| values[place]).collect();
        Change {
            places: places.clone(),
            twists,
            strains: Vec::new(),
            base,
            lengths: of_robot(&lengths),
            tensions: of_robot(tensions),
        }
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
