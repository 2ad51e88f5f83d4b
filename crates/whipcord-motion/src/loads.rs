//! External loads at the nodes of a rod.

use whipcord::{Case, Loads};
use whipcord_numerics::{GAUSS_3, Pose, Twist, UnitQuaternion, Vec3, magnus_6};

use crate::course::Course;
use crate::element::{LOBATTO, NODES, PLACES};
use crate::options::{BaseMotion, MotionOptions};
use crate::rod::Rod;

/// What acts on a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NodeLoad {
    /// Dead force in N, in the frame of the base; constant gravity is not counted.
    pub force: Vec3,
    /// What of that force is weight, of gravity over time.
    pub weight: Vec3,
    /// Dead moment in N·m, in the frame of the base.
    pub moment: Vec3,
    /// Force in N that turns with the section, in its frame.
    pub follower_force: Vec3,
    /// Moment in N·m that turns with the section, in its frame.
    pub follower_moment: Vec3,
}

impl NodeLoad {
    fn add(&mut self, f: f64, other: &Self) {
        self.force += other.force * f;
        self.weight += other.weight * f;
        self.moment += other.moment * f;
        self.follower_force += other.follower_force * f;
        self.follower_moment += other.follower_moment * f;
    }
}

/// All loads on the nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeLoads {
    /// Acceleration of gravity in m/s², in the frame of the base.
    pub gravity: Vec3,
    constant: Vec<NodeLoad>,
    /// Gravity over time.
    varying_gravity: Vec<(Vec3, Course)>,
    /// Loads over time.
    varying: Vec<(Vec<NodeLoad>, Course)>,
    base: Option<BaseMotion>,
    /// Whether nothing holds the base.
    pub has_free_base: bool,
    /// Whether any dead load or gravity acts, whose direction in the section depends on the pose.
    pub any_dead: bool,
}

impl NodeLoads {
    pub fn new(rod: &Rod, case: &Case, options: &MotionOptions) -> Self {
        let turn = |loads: &Loads| {
            // From the frame of the loads to that of the base.
            case.base.rotation.conjugate() * loads.to_world(case.base.rotation)
        };
        let gravity = turn(&case.loads).rotate(case.loads.gravity.unwrap_or_default());
        let is_free = options.has_free_base;
        let constant = gather(rod, &case.loads, turn(&case.loads), [is_free, false]);
        let varying: Vec<_> = options
            .loads
            .iter()
            .map(|of| {
                let loads = gather(rod, &of.loads, turn(&of.loads), [is_free, true]);
                (loads, of.factor.clone())
            })
            .collect();
        let varying_gravity = options.loads.iter().filter_map(|of| {
            let gravity = turn(&of.loads).rotate(of.loads.gravity?);
            Some((gravity, of.factor.clone()))
        });
        let varying_gravity = varying_gravity.collect();
        let is_dead = |loads: &[NodeLoad]| {
            loads.iter().any(|load| load.force != Vec3::ZERO || load.moment != Vec3::ZERO)
        };
        let any_dead = gravity != Vec3::ZERO
            || is_dead(&constant)
            || varying.iter().any(|(loads, _)| is_dead(loads));
        let base = options.base.clone();
        Self { gravity, varying_gravity, constant, varying, base, has_free_base: is_free, any_dead }
    }

    /// Has other loads act in place of those of the case; gravity stays.
    pub fn set_constant(&mut self, rod: &Rod, loads: &Loads, base: UnitQuaternion) {
        let turn = base.conjugate() * loads.to_world(base);
        self.constant = gather(rod, loads, turn, [self.has_free_base, false]);
        self.any_dead |=
            self.constant.iter().any(|of| of.force != Vec3::ZERO || of.moment != Vec3::ZERO);
    }

    /// All gravity in m/s² at a time, before any jump at that time, in the frame of the base.
    pub fn gravity_at(&self, time: f64) -> Vec3 {
        let varying = self.varying_gravity.iter();
        varying.fold(self.gravity, |sum, (gravity, course)| sum + *gravity * course.before(time))
    }

    /// The loads at a time, before any jump at that time.
    pub fn at(&self, time: f64, loads: &mut [NodeLoad]) {
        loads.copy_from_slice(&self.constant);
        for (varying, course) in &self.varying {
            let factor = course.before(time);
            for (load, varying) in loads.iter_mut().zip(varying) {
                load.add(factor, varying);
            }
        }
    }

    /// Sums of what acts on the nodes, dead and turning with them, and gravity: by which it is known that nothing else acts than before.
    pub fn sums(&self, loads: &[NodeLoad]) -> [f64; 15] {
        let mut sum = NodeLoad::default();
        loads.iter().for_each(|load| sum.add(1.0, load));
        let NodeLoad { force, moment, follower_force, follower_moment, weight: _ } = sum;
        let mut out = [0.0; 15];
        let all = [force, moment, follower_force, follower_moment, self.gravity];
        for (out, of) in out.chunks_exact_mut(3).zip(all) {
            out.copy_from_slice(&of.to_array());
        }
        out
    }

    /// What the loads at a time change by in 1 s; `None` where none is over time.
    pub fn rates_at(&self, time: f64) -> Option<Vec<NodeLoad>> {
        if self.varying.is_empty() {
            return None;
        }
        let mut rates = vec![NodeLoad::default(); self.constant.len()];
        for (varying, course) in &self.varying {
            let slope = course.slope_before(time);
            for (rate, varying) in rates.iter_mut().zip(varying) {
                rate.add(slope, varying);
            }
        }
        Some(rates)
    }

    /// The first node that moves by the forces on it.
    pub fn first_free(&self) -> usize {
        usize::from(!self.has_free_base)
    }

    /// Velocity of the base in its frame at a time, before any jump at that time.
    pub fn base_velocity(&self, time: f64) -> Twist {
        let Some(base) = &self.base else { return Twist::default() };
        let at = |courses: &[Course; 3]| {
            let [x, y, z] = courses;
            Vec3::new(x.before(time), y.before(time), z.before(time))
        };
        Twist { linear: at(&base.velocity), angular: at(&base.angular_velocity) }
    }

    /// Velocity of a base that is led, and its rate, in its frame at a time, before any jump; `None` where it is not led.
    pub fn led_base(&self, time: f64) -> Option<[Twist; 2]> {
        let base = self.base.as_ref()?;
        let slope = |courses: &[Course; 3]| {
            let [x, y, z] = courses;
            Vec3::new(x.slope_before(time), y.slope_before(time), z.slope_before(time))
        };
        let rate = Twist { linear: slope(&base.velocity), angular: slope(&base.angular_velocity) };
        Some([self.base_velocity(time), rate])
    }

    /// Pose of the base at a time `h` behind another one, at which it has the pose `from`: by the Magnus series of order 6.
    pub fn base_pose(&self, from: Pose, time: f64, h: f64) -> Pose {
        if self.base.is_none() {
            return from;
        }
        from * magnus_6(&GAUSS_3.nodes.map(|place| self.base_velocity(time + place * h) * h))
    }

    /// All courses of loads and base.
    fn courses(&self) -> impl Iterator<Item = &Course> {
        let of_base =
            self.base.iter().flat_map(|base| base.velocity.iter().chain(&base.angular_velocity));
        self.varying.iter().map(|(_, course)| course).chain(of_base)
    }

    /// The first jump of a load or of the base after `from` and before `to`.
    pub fn next_jump(&self, from: f64, to: f64) -> Option<f64> {
        self.courses().filter_map(|course| course.next_jump(from, to)).min_by(f64::total_cmp)
    }

    /// Whether a load or the base jumps at a time.
    pub fn jumps_at(&self, time: f64) -> bool {
        self.courses().any(|course| course.before(time) != course.after(time))
    }
}

/// Shares loads out to the nodes: point loads to the nearest, distributed ones by the rule of the masses. Gravity is among those that are `varying` alone.
fn gather(
    rod: &Rod,
    loads: &Loads,
    turn: UnitQuaternion,
    [has_free_base, is_varying]: [bool; 2],
) -> Vec<NodeLoad> {
    let mut nodes = vec![NodeLoad::default(); rod.nodes.len()];
    let mut apply = |node: usize, force: Vec3, moment: Vec3, follower: bool| {
        let load = &mut nodes[node];
        if follower {
            load.follower_force += force;
            load.follower_moment += moment;
        } else {
            load.force += turn.rotate(force);
            load.moment += turn.rotate(moment);
        }
    };
    apply(rod.nodes.len() - 1, loads.tip_force, loads.tip_moment, loads.tip_follower);
    let gravity = loads.gravity.filter(|_| is_varying).map_or(Vec3::ZERO, |of| turn.rotate(of));
    for point in &loads.points {
        apply(rod.node_at(point.at), point.force, point.moment, point.follower);
    }
    for load in &loads.distributed {
        for piece in load.profile.pieces() {
            for (e, &h) in rod.lengths.iter().enumerate() {
                let start = rod.nodes[2 * e].arc_length;
                let middle = start + 0.5 * h;
                if middle <= piece.at[0] || middle >= piece.at[1] {
                    continue;
                }
                for a in 0..NODES {
                    let s = start + PLACES[a] * h;
                    let t = ((s - piece.at[0]) / (piece.at[1] - piece.at[0])).clamp(0.0, 1.0);
                    let at =
                        |ends: [Vec3; 2]| (ends[0] * (1.0 - t) + ends[1] * t) * (LOBATTO[a] * h);
                    apply(2 * e + a, at(piece.force), at(piece.moment), load.follower);
                }
            }
        }
    }
    for (load, node) in nodes.iter_mut().zip(&rod.nodes) {
        load.weight = gravity * node.mass;
        load.force += load.weight;
    }
    // What acts on a base that is held moves nothing.
    if !has_free_base {
        nodes[0] = NodeLoad::default();
    }
    nodes
}
