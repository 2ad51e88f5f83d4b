//! The loads of a case, gathered at the disks and at points between them.
//!
//! Loads that are spread along a section act at the points of a Gauss rule on its curve, eq. (10), so that their
//! sum is that of the loads on the deformed robot.

use whipcord_numerics::{GAUSS_3, GAUSS_5, UnitQuaternion, Vec3};

use super::division::Division;
use crate::case::{Loads, Piece};
use crate::robot::Robot;
use crate::shape::Wrench;

/// What is applied to the robot.
#[derive(Clone, Debug, Default)]
pub(super) struct AppliedLoads {
    /// To each disk, in the frame of the base.
    pub dead: Vec<Wrench>,
    /// To each disk, in the frame of the disk.
    pub followers: Vec<Wrench>,
    /// Between the disks, from the base on.
    inner: Vec<InnerLoad>,
    /// Number of the first inner load of each section, and that of all.
    first: Vec<usize>,
    places: Vec<f64>,
}

/// What is applied to one cross-section between two disks.
#[derive(Clone, Copy, Debug)]
pub(super) struct InnerLoad {
    /// Where, as a fraction of the section.
    pub at: f64,
    /// In the frame of the base.
    pub dead: Wrench,
    /// In the frame of the cross-section.
    pub follower: Wrench,
}

fn disk_at(robot: &Robot, arc_length: f64) -> Option<usize> {
    let near = 1e-9 * robot.backbone().length;
    robot.disks().arc_lengths.iter().position(|s| (s - arc_length).abs() <= near)
}

impl AppliedLoads {
    /// Gathers the loads; `base` is how the base is turned in their frame.
    pub fn gather(
        &mut self,
        robot: &Robot,
        division: &Division,
        loads: &Loads,
        base: UnitQuaternion,
    ) {
        let count = robot.disks().count();
        for list in [&mut self.dead, &mut self.followers] {
            list.clear();
            list.resize(count, Wrench::default());
        }
        self.inner.clear();
        self.first.clear();
        self.first.resize(count, 0);
        if loads.is_none() {
            return;
        }
        let turn = loads.to_base(base);
        self.spread(robot, division, loads, turn);
        let Self { dead, followers, .. } = self;
        let mut apply = |disk: usize, force: Vec3, moment: Vec3, follower: bool| {
            let (at, turn) = if follower {
                (&mut followers[disk], UnitQuaternion::IDENTITY)
            } else {
                (&mut dead[disk], turn)
            };
            at.force += turn.rotate(force);
            at.moment += turn.rotate(moment);
        };
        apply(count - 1, loads.tip_force, loads.tip_moment, loads.tip_follower);
        for point in &loads.points {
            if let Some(disk) = disk_at(robot, point.at) {
                apply(disk, point.force, point.moment, point.follower);
            }
        }
        if let Some(gravity) = loads.gravity {
            let mut weigh = |disk: usize, mass: f64| apply(disk, gravity * mass, Vec3::ZERO, false);
            for mass in &loads.masses {
                if let Some(disk) = disk_at(robot, mass.at) {
                    weigh(disk, mass.mass);
                }
            }
            (1..count).for_each(|disk| weigh(disk, robot.disks().mass));
        }
        // What is applied to the clamped base bends nothing.
        (dead[0], followers[0]) = (Wrench::default(), Wrench::default());
    }

    /// Whether a dead moment acts: it has no energy where the section that bears it can turn.
    pub fn any_dead_moment(&self) -> bool {
        let inner = self.inner.iter().map(|load| &load.dead);
        self.dead.iter().chain(inner).any(|wrench| wrench.moment != Vec3::ZERO)
    }

    /// The loads within this section.
    pub fn inside(&self, section: usize) -> &[InnerLoad] {
        &self.inner[self.first[section]..self.first[section + 1]]
    }

    /// The backbone's weight and the distributed loads, by a Gauss rule between each two places at which they or
    /// the curve are not smooth; and what acts at single places between the disks.
    fn spread(&mut self, robot: &Robot, division: &Division, loads: &Loads, turn: UnitQuaternion) {
        let Self { inner, first, places, .. } = self;
        let gravity = loads.gravity.unwrap_or_default();
        let knots: Vec<f64> = robot
            .backbone()
            .places()
            .into_iter()
            .chain(loads.distributed.iter().flat_map(|load| load.profile.knots()))
            .collect();
        for (k, pair) in robot.disks().arc_lengths.windows(2).enumerate() {
            let (near, length) = (pair[0], pair[1] - pair[0]);
            places.clear();
            places.extend(knots.iter().filter(|s| pair[0] < **s && **s < pair[1]));
            places.extend(division.corners().map(|corner| near + corner * length));
            places.extend(pair);
            places.sort_by(f64::total_cmp);
            for ends in places.windows(2).filter(|ends| ends[1] > ends[0]) {
                let middle = 0.5 * (ends[0] + ends[1]);
                let mut at = |t: f64, weight: f64| {
                    let (h, s) = (ends[1] - ends[0], ends[0] + t * (ends[1] - ends[0]));
                    let mut load = InnerLoad {
                        at: (s - near) / length,
                        dead: Wrench::default(),
                        follower: Wrench::default(),
                    };
                    // Without a density the backbone has no weight.
                    let density = robot.backbone().linear_density_at(robot.disks(), s);
                    load.dead.force = gravity * density.unwrap_or(0.0);
                    for spread in &loads.distributed {
                        let to = if spread.follower { &mut load.follower } else { &mut load.dead };
                        let here = |p: &Piece| p.at[0] < middle && middle < p.at[1];
                        spread.profile.pieces().filter(here).for_each(|piece| add(to, &piece, s));
                    }
                    for wrench in [&mut load.dead, &mut load.follower] {
                        wrench.force *= weight * h;
                        wrench.moment *= weight * h;
                    }
                    load.dead.force = turn.rotate(load.dead.force);
                    load.dead.moment = turn.rotate(load.dead.moment);
                    if load.dead != Wrench::default() || load.follower != Wrench::default() {
                        inner.push(load);
                    }
                };
                if division.is_arc() {
                    GAUSS_5.nodes.into_iter().zip(GAUSS_5.weights).for_each(|(t, w)| at(t, w));
                } else {
                    GAUSS_3.nodes.into_iter().zip(GAUSS_3.weights).for_each(|(t, w)| at(t, w));
                }
            }
            let is_inside = |s: f64| pair[0] < s && s < pair[1] && disk_at(robot, s).is_none();
            let mut concentrated = |s: f64, wrench: Wrench, follower: bool| {
                if !is_inside(s) || wrench == Wrench::default() {
                    return;
                }
                let mut load = InnerLoad {
                    at: (s - near) / length,
                    dead: Wrench::default(),
                    follower: Wrench::default(),
                };
                if follower {
                    load.follower = wrench;
                } else {
                    load.dead = Wrench {
                        force: turn.rotate(wrench.force),
                        moment: turn.rotate(wrench.moment),
                    };
                }
                inner.push(load);
            };
            for point in &loads.points {
                let wrench = Wrench { force: point.force, moment: point.moment };
                concentrated(point.at, wrench, point.follower);
            }
            for mass in &loads.masses {
                let weight = Wrench { force: gravity * mass.mass, moment: Vec3::ZERO };
                concentrated(mass.at, weight, false);
            }
            first[k + 1] = inner.len();
        }
    }
}

/// Adds what a piece of a profile has for each metre at an arc length.
fn add(wrench: &mut Wrench, piece: &Piece, s: f64) {
    let [start, end] = piece.at;
    let along = (s - start) / (end - start);
    let between = |[a, b]: [Vec3; 2]| a + (b - a) * along;
    wrench.force += between(piece.force);
    wrench.moment += between(piece.moment);
}
