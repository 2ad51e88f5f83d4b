//! Sections of an arc or of rigid bodies in coordinates, with their energy: put together from poses and hole distances alone.

use whipcord::{
    Actuation, Case, Model, ModelKind, Pose, Robot, Statics as _, Stations, Twist, UnitQuaternion,
    Vec3,
};

use super::bending_stiffness;

/// A section of a model in the coordinates that it bends by: twist, and bends about x and y of each joint.
pub struct Parts {
    pub kind: ModelKind,
    /// Length of the bodies by that of the section; of the arc, its whole.
    pub links: &'static [f64],
    /// By EI over the length.
    pub stiffness: &'static [f64],
}

pub const ARC: Parts =
    Parts { kind: ModelKind::PiecewiseConstantCurvature, links: &[0.0, 1.0], stiffness: &[1.0] };
/// Su 2009, table of optimal parameters.
pub const BODIES: Parts = Parts {
    kind: ModelKind::PseudoRigidBody,
    links: &[0.1, 0.35, 0.4, 0.15],
    stiffness: &[3.51, 2.99, 2.58],
};

impl Parts {
    fn is_arc(&self) -> bool {
        self.kind == ModelKind::PiecewiseConstantCurvature
    }

    /// The end of a section.
    fn pose(&self, length: f64, q: &[f64]) -> Pose {
        self.joint(length, q, self.stiffness.len()) * about_z(0.5 * q[0])
    }

    /// The end of a body, where the joint of this number is; of an arc, its start.
    pub fn joint(&self, length: f64, q: &[f64], number: usize) -> Pose {
        let ahead = |l: f64| Pose { position: Vec3::Z * (l * length), ..Pose::IDENTITY };
        let mut pose = about_z(0.5 * q[0]) * ahead(self.links[0]);
        for (bend, link) in q[1..].chunks(2).zip(&self.links[1..]).take(number) {
            let bend = Vec3::new(bend[0], bend[1], 0.0);
            pose = pose
                * if self.is_arc() {
                    Pose::exp(Twist { linear: Vec3::Z * length, angular: bend })
                } else {
                    turn(bend) * ahead(*link)
                };
        }
        pose
    }

    /// The coordinates of every section, read off from how the middles of the parts are turned.
    pub fn coordinates(&self, robot: &Robot, case: &Case) -> Vec<Vec<f64>> {
        let at = &robot.disks().arc_lengths;
        let mut middles = Vec::new();
        let mut reach = 0.0;
        for link in self.links {
            middles.push(reach + 0.5 * link);
            reach += link;
        }
        let stations = at.windows(2).flat_map(|pair| {
            middles.iter().map(|t| pair[0] + t * (pair[1] - pair[0])).chain([pair[1]])
        });
        let stations = Stations::At(stations.collect());
        let answer =
            Model::new(self.kind, stations, Actuation::Natural).solve(robot, case).unwrap();
        let mut start = UnitQuaternion::IDENTITY;
        let sections = answer.shape.poses.chunks(middles.len() + 1);
        sections
            .map(|poses| {
                let seen = |pose: &Pose| start.conjugate() * pose.rotation;
                let end = seen(&poses[poses.len() - 1]);
                let mut q = Vec::new();
                if self.is_arc() {
                    let [w, x, y, z] = end.wxyz();
                    let across = x.hypot(y).max(1e-300);
                    let bend = 2.0 * across.atan2(w.hypot(z)) / across;
                    q.extend([2.0 * z.atan2(w), bend * x, bend * y]);
                } else {
                    // The first body only twists.
                    let twist = seen(&poses[0]).log();
                    assert!(twist.x.hypot(twist.y) < 1e-12);
                    let psi = twist.z / middles[0];
                    let about = |angle: f64| UnitQuaternion::exp(Vec3::Z * angle);
                    let bare = |(pose, t): (&Pose, &f64)| {
                        about(-0.5 * psi) * seen(pose) * about(-0.5 * psi * (2.0 * t - 1.0))
                    };
                    let bodies: Vec<_> = poses.iter().zip(&middles).map(bare).collect();
                    q.push(psi);
                    for pair in bodies.windows(2) {
                        let bend = (pair[0].conjugate() * pair[1]).log();
                        assert!(bend.z.abs() < 1e-12, "joints do not twist: {bend:?}");
                        q.extend([bend.x, bend.y]);
                    }
                }
                start = poses[poses.len() - 1].rotation;
                q
            })
            .collect()
    }

    /// The disks.
    pub fn poses(&self, robot: &Robot, q: &[Vec<f64>]) -> Vec<Pose> {
        let mut poses = vec![Pose::IDENTITY];
        for (pair, q) in robot.disks().arc_lengths.windows(2).zip(q) {
            poses.push(poses[poses.len() - 1] * self.pose(pair[1] - pair[0], q));
        }
        poses
    }

    /// Elastic energy, less the work of cables and dead forces at the disks.
    pub fn energy(&self, robot: &Robot, case: &Case, q: &[Vec<f64>]) -> f64 {
        let at = &robot.disks().arc_lengths;
        let stiffness = bending_stiffness(robot);
        let torsion = stiffness / 1.3;
        let poses = self.poses(robot, q);
        let mut energy = 0.0;
        for (pair, q) in at.windows(2).zip(q) {
            let length = pair[1] - pair[0];
            energy += 0.5 * torsion / length * q[0] * q[0];
            for (bend, k) in q[1..].chunks(2).zip(self.stiffness) {
                energy += 0.5 * k * stiffness / length * (bend[0].powi(2) + bend[1].powi(2));
            }
        }
        for (route, command) in robot.routes().iter().zip(&case.commands) {
            let hole = |k: usize| poses[k].transform(route.at(at[k]).offset);
            let spans = 1..poses.len();
            let length: f64 = spans.map(|k| (hole(k) - hole(k - 1)).norm()).sum();
            energy += command.tension.unwrap() * length;
        }
        let tip = poses[poses.len() - 1];
        energy -= case.loads.tip_force.dot(tip.position);
        for point in &case.loads.points {
            let disk = at.iter().position(|s| (s - point.at).abs() < 1e-12).unwrap();
            energy -= point.force.dot(poses[disk].position);
        }
        energy
    }
}

fn turn(v: Vec3) -> Pose {
    Pose { rotation: UnitQuaternion::exp(v), ..Pose::IDENTITY }
}

fn about_z(angle: f64) -> Pose {
    turn(Vec3::Z * angle)
}
