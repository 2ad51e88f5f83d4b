//! The same robot and case seen in a mirror or from another side.

use core::f64::consts::TAU;

use whipcord::{
    Backbone, Cable, Case, DistributedLoad, Loads, Mat3, PointLoad, Pose, Profile, Robot, Routing,
    Section, Solution, Vec3,
};

/// A symmetry of the robot's contract.
#[derive(Clone, Copy, Debug)]
pub enum Symmetry {
    /// y becomes −y.
    Mirror,
    /// About z by so many of twelve holes, counter-clockwise.
    Turn(usize),
}

impl Symmetry {
    /// A turn that also maps the section to itself.
    pub fn turn_of(robot: &Robot, holes: usize) -> Self {
        match robot.backbone().section {
            Some(Section::Rectangle { .. }) => Self::Turn(6),
            _ => Self::Turn(holes),
        }
    }

    fn turn_angle(self) -> f64 {
        match self {
            Self::Mirror => 0.0,
            Self::Turn(holes) => TAU * holes as f64 / 12.0,
        }
    }

    /// Of positions and forces.
    pub fn matrix(self) -> Mat3 {
        match self {
            Self::Mirror => Mat3::diagonal(Vec3::new(1.0, -1.0, 1.0)),
            Self::Turn(_) => {
                let (sin, cos) = self.turn_angle().sin_cos();
                Mat3::from_rows(Vec3::new(cos, -sin, 0.0), Vec3::new(sin, cos, 0.0), Vec3::Z)
            }
        }
    }

    /// Of moments and curvatures, which a mirror turns the other way round.
    fn axial(self, v: Vec3) -> Vec3 {
        match self {
            Self::Mirror => -(self.matrix() * v),
            Self::Turn(_) => self.matrix() * v,
        }
    }

    fn angle(self, angle: f64) -> f64 {
        match self {
            Self::Mirror => -angle,
            Self::Turn(_) => angle + self.turn_angle(),
        }
    }

    fn hole(self, hole: usize) -> usize {
        match self {
            Self::Mirror => (12 - (hole - 1)) % 12 + 1,
            Self::Turn(holes) => (hole - 1 + holes) % 12 + 1,
        }
    }

    fn point(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let p = self.matrix() * Vec3::new(x, y, 0.0);
        [p.x, p.y]
    }

    fn routing(self, routing: &Routing) -> Routing {
        match routing {
            Routing::Holes { holes, interpolation } => Routing::Holes {
                holes: holes.iter().map(|&h| self.hole(h)).collect(),
                interpolation: *interpolation,
            },
            Routing::Straight { angle, radius } => {
                Routing::Straight { angle: self.angle(*angle), radius: *radius }
            }
            Routing::Helix { start_angle, turns, radius } => Routing::Helix {
                start_angle: self.angle(*start_angle),
                turns: if matches!(self, Self::Mirror) { -turns } else { *turns },
                radius: *radius,
            },
            Routing::Linear { start, end } => {
                Routing::Linear { start: self.point(*start), end: self.point(*end) }
            }
            Routing::Polynomial { x, y } => {
                let turned: Vec<[f64; 2]> =
                    x.iter().zip(y).map(|(&x, &y)| self.point([x, y])).collect();
                Routing::Polynomial {
                    x: turned.iter().map(|p| p[0]).collect(),
                    y: turned.iter().map(|p| p[1]).collect(),
                }
            }
        }
    }

    pub fn robot(self, robot: &Robot) -> Robot {
        let rest_curvature = robot.backbone().rest_curvature.map(|&u| self.axial(u));
        let backbone = Backbone { rest_curvature, ..robot.backbone().clone() };
        let cable = |c: &Cable| Cable { routing: self.routing(&c.routing), ..c.clone() };
        let cables = robot.cables().iter().map(cable).collect();
        Robot::new(backbone, robot.disks().clone(), cables).unwrap()
    }

    pub fn case(self, case: &Case) -> Case {
        let loads = &case.loads;
        let point = |p: &PointLoad| PointLoad {
            force: self.matrix() * p.force,
            moment: self.axial(p.moment),
            ..*p
        };
        let many = |list: &[Vec3], f: &dyn Fn(Vec3) -> Vec3| list.iter().map(|&v| f(v)).collect();
        let polar = |v: Vec3| self.matrix() * v;
        let spread = |load: &DistributedLoad| DistributedLoad {
            profile: match &load.profile {
                &Profile::Constant { from, to, force, moment } => {
                    Profile::Constant { from, to, force: polar(force), moment: self.axial(moment) }
                }
                Profile::Linear { at, force, moment } => Profile::Linear {
                    at: at.clone(),
                    force: many(force, &polar),
                    moment: many(moment, &|m| self.axial(m)),
                },
            },
            ..*load
        };
        Case {
            commands: case.commands.clone(),
            before: case.before.clone(),
            loads_before: case.loads_before.clone(),
            motors: case.motors.clone(),
            independent: case.independent,
            base: case.base,
            obstacles: case.obstacles.clone(),
            loads: Loads {
                gravity: loads.gravity.map(|g| self.matrix() * g),
                tip_force: self.matrix() * loads.tip_force,
                tip_moment: self.axial(loads.tip_moment),
                tip_follower: loads.tip_follower,
                points: loads.points.iter().map(point).collect(),
                distributed: loads.distributed.iter().map(spread).collect(),
                ..loads.clone()
            },
        }
    }

    /// Largest difference between the image of `original` and the solution of the image: positions
    /// and cable lengths over the backbone's length, and entries of the frames.
    pub fn error(self, original: &Solution, image: &Solution, length: f64) -> f64 {
        let s = self.matrix();
        let of_pose = |(a, b): (&Pose, &Pose)| {
            let position = (s * a.position - b.position).norm() / length;
            let frame = s * a.rotation.to_matrix() * s.transpose() - b.rotation.to_matrix();
            frame.rows.iter().map(|row| row.max_abs()).fold(position, f64::max)
        };
        let poses = original.shape.poses.iter().chain(&original.disks.poses);
        let others = image.shape.poses.iter().chain(&image.disks.poses);
        let lengths = original
            .cables
            .iter()
            .zip(&image.cables)
            .map(|(a, b)| (a.length - b.length).abs() / length);
        poses.zip(others).map(of_pose).chain(lengths).fold(0.0, f64::max)
    }
}
