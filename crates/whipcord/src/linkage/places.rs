//! Cross-sections that wrenches act on, and how they move.

use whipcord_numerics::{Pose, Twist, Vec3};

use super::Linkage;
use super::chain::Chain;
use super::motion::{Coordinates, Motion};
use super::place_wrench::PlaceWrench;
use super::task::Task;
use crate::derivatives::unit_wrench;
use crate::shape::Wrench;

/// Some cross-sections of a chain, from base to tip.
#[derive(Debug)]
pub(super) struct Places<'a> {
    /// In the frame of the base.
    disks: &'a [Pose],
    /// The section of each, and how the cross-section moves with its coordinates.
    list: Vec<(usize, Motion)>,
}

impl<'a> Places<'a> {
    /// The cross-sections at these arc lengths in m, which increase, where the chain has these coordinates and disks.
    pub fn new(model: &Linkage, q: &[Coordinates], disks: &'a [Pose], arc_lengths: &[f64]) -> Self {
        let of_place = |&at: &f64| {
            let (section, t) = model.locate(at);
            let length = model.sections[section].length;
            (section, Motion::up_to(&model.division, length, &q[section], t))
        };
        Self { disks, list: arc_lengths.iter().map(of_place).collect() }
    }

    /// The components of a wrench in the frame of the base on each of them, forces first.
    pub fn unit_wrenches(&self) -> Vec<PlaceWrench> {
        let of_place = |&(section, motion): &(usize, Motion)| {
            let to_section = self.disks[section].rotation.conjugate();
            (0..6).map(move |component| {
                let Wrench { force, moment } = unit_wrench(component);
                let seen =
                    Wrench { force: to_section.rotate(force), moment: to_section.rotate(moment) };
                PlaceWrench::new(section, &motion, seen)
            })
        };
        self.list.iter().flat_map(of_place).collect()
    }

    /// Adds to the list how each of them moves with a response of the last elimination, in the frame of the base.
    pub fn twists(&self, chain: &Chain, task: &Task<'_>, side: usize, into: &mut Vec<Twist>) {
        let mut disk = Twist::default();
        let mut start = 0;
        for &(section, ref motion) in &self.list {
            for k in start..section {
                let end = self.disks[k + 1].position;
                let response = chain.response(task, side, k);
                disk = carried(disk, self.disks[k], chain.motion(k), end, response);
            }
            start = section;
            let at = self.disks[section].transform(motion.end);
            let response = chain.response(task, side, section);
            into.push(carried(disk, self.disks[section], motion, at, response));
        }
    }

    /// How each of them moves with the coordinates of the chain, in the frame of the base: six rows for each, those of its point
    /// first, of so many coordinates to a section.
    pub fn jacobian(&self, chain: &Chain, count: usize) -> Vec<f64> {
        let n = count * (self.disks.len() - 1);
        let mut rows = vec![0.0; 6 * n * self.list.len()];
        for (place, &(section, ref motion)) in self.list.iter().enumerate() {
            let at = self.disks[section].transform(motion.end);
            for k in 0..=section {
                let (own, end) = match k == section {
                    true => (motion, at),
                    false => (chain.motion(k), self.disks[k + 1].position),
                };
                let rotation = self.disks[k].rotation;
                for a in 0..count {
                    let angular = rotation.rotate(own.turn[a]);
                    let linear = rotation.rotate(own.shift[a]) + angular.cross(at - end);
                    for axis in 0..3 {
                        let column = k * count + a;
                        rows[(6 * place + axis) * n + column] = linear[axis];
                        rows[(6 * place + 3 + axis) * n + column] = angular[axis];
                    }
                }
            }
        }
        rows
    }

    /// Where they are, in the frame of the base.
    pub fn positions(&self) -> Vec<Vec3> {
        let position =
            |&(section, ref motion): &(usize, Motion)| self.disks[section].transform(motion.end);
        self.list.iter().map(position).collect()
    }
}

/// How a cross-section of a section moves, at this position, where the disk before the section is here and moves like this.
pub(super) fn carried(
    disk: Twist,
    Pose { position, rotation }: Pose,
    motion: &Motion,
    at: Vec3,
    response: &[f64],
) -> Twist {
    let (mut turn, mut shift) = (Vec3::ZERO, Vec3::ZERO);
    for (a, change) in response.iter().enumerate() {
        turn += motion.turn[a] * *change;
        shift += motion.shift[a] * *change;
    }
    Twist {
        linear: disk.linear + disk.angular.cross(at - position) + rotation.rotate(shift),
        angular: disk.angular + rotation.rotate(turn),
    }
}
