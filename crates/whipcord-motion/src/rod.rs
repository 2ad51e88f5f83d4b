//! A robot in elements: stiffness and cables at their points, masses at their nodes.

use whipcord::robot::StiffnessMatrix;
use whipcord::section::section_stiffness;
use whipcord::{Disks, Loads, ModelKind, Robot, SolveError, straight_passages};
use whipcord_numerics::{GAUSS_2, Mat3, Pose, Twist, Vec3};

use crate::block::Block;
use crate::element::{self, LOBATTO, PLACES, POINTS};
use crate::error::MotionError;
use crate::mesh;
use crate::options::{Damping, MotionOptions};

/// A robot in quadratic elements. Element `e` has the nodes `2e`, `2e + 1` and `2e + 2`, and the points `2e` and `2e + 1`.
#[derive(Clone, Debug)]
pub(crate) struct Rod {
    /// Length of the backbone in m.
    pub length: f64,
    /// Length of each element in m.
    pub lengths: Vec<f64>,
    /// Two for each element.
    pub points: Vec<Point>,
    /// One more than points.
    pub nodes: Vec<Node>,
    /// The cables.
    pub cables: Vec<CableLine>,
    /// Where each cable crosses the section of each point: that of cable `i` at point `q` is number `q · cables + i`.
    pub crossings: Vec<Crossing>,
    /// Straight pieces of the cables from disk to disk, cable by cable from the base on; empty where cables are continuous.
    pub chords: Vec<Chord>,
    /// The first passage of each cable among those of all: of its chords, or of the points that it passes.
    pub first_passages: Vec<usize>,
    /// For each element the number of the first one behind the disk before it, where cables are straight; its own where they are continuous.
    pub span_starts: Vec<usize>,
    /// Whether a section has any damping.
    pub is_damped: bool,
}

/// A section at a point of an element.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Length of backbone in m that it stands for.
    pub weight: f64,
    /// `K`.
    pub stiffness: Block,
    /// `D`.
    pub damping: Block,
    /// `ξ*`.
    pub rest: Twist,
}

/// A node of an element, or of two.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Node {
    /// Arc length in m.
    pub arc_length: f64,
    /// Mass in kg.
    pub mass: f64,
    /// Moments of inertia in kg·m² about the axes of the section.
    pub inertia: Vec3,
    /// Length of backbone in m that it stands for.
    pub share: f64,
}

/// A cable along the elements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CableLine {
    /// Number of elements that it passes, from the base on.
    pub elements: usize,
    /// Its length in m in the shape at rest, by the rule of the elements.
    pub rest_length: f64,
    /// Compliance in m/N of cable and drive.
    pub compliance: f64,
    /// Tension in N at which the stretch is zero.
    pub pretension: f64,
}

/// Where a cable crosses a section.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Crossing {
    /// `r` in m.
    pub offset: Vec3,
    /// `r′`.
    pub slope: Vec3,
}

impl Crossing {
    /// `p′ = v + u × r + r′`, eq. (5) of the page on motion.
    #[inline]
    pub fn tangent(&self, strain: &Twist) -> Vec3 {
        strain.linear + strain.angular.cross(self.offset) + self.slope
    }
}

/// A straight piece of a cable between two disks, or from a disk to an anchor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    pub cable: usize,
    /// The nodes of its ends, the first of them nearer the base.
    pub nodes: [usize; 2],
    /// Its ends in the cross-sections of these nodes in m.
    pub holes: [Vec3; 2],
}

impl Chord {
    /// From its first end to the second, where the nodes have these poses.
    #[inline]
    pub fn way(&self, poses: &[Pose]) -> Vec3 {
        let [near, far] = [0, 1].map(|i| poses[self.nodes[i]].transform(self.holes[i]));
        far - near
    }
}

/// A backbone that does not shear or stretch gets this stiffness, times its greatest bending stiffness over the square of its length.
const HELD: f64 = 1e8;

/// Radius of gyration of a section of which nothing is known, as a part of the length of the backbone.
const GYRATION: f64 = 1e-3;

impl Rod {
    pub fn new(
        robot: &Robot,
        loads: &[&Loads],
        options: &MotionOptions,
    ) -> Result<Self, MotionError> {
        refuse_unsupported(robot)?;
        let is_straight = options.model == ModelKind::CosseratDisks;
        if is_straight && !robot.has_disks() {
            return Err(MotionError::Missing {
                path: "disks".to_owned(),
                advice: "add [disks], for example with `count = 10`, or use the model `cosserat`, whose cables run in channels",
            });
        }
        let ends = mesh::element_ends(robot, loads, options.elements, is_straight)?;
        let length = robot.backbone().length;
        let lengths: Vec<f64> = ends.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut rod = Self {
            length,
            points: Vec::with_capacity(POINTS * lengths.len()),
            nodes: vec![Node::default(); POINTS * lengths.len() + 1],
            lengths,
            cables: Vec::new(),
            crossings: Vec::new(),
            chords: Vec::new(),
            first_passages: Vec::new(),
            span_starts: Vec::new(),
            is_damped: false,
        };
        for (e, &start) in ends[..ends.len() - 1].iter().enumerate() {
            rod.add_element(robot, e, start, options)?;
        }
        rod.is_damped = rod.points.iter().any(|point| point.damping != Block::default());
        rod.add_disks(robot);
        for mass in &loads.first().map(|loads| loads.masses.as_slice()).unwrap_or_default().to_vec()
        {
            let node = rod.node_at(mass.at);
            rod.nodes[node].mass += mass.mass;
        }
        rod.span_starts = (0..rod.elements()).collect();
        if is_straight {
            rod.lay_straight_cables(robot);
        } else {
            rod.lay_cables(robot, &ends);
        }
        let mut count = 0;
        for i in 0..rod.cables.len() {
            rod.first_passages.push(count);
            count += match is_straight {
                true => rod.chords.iter().filter(|chord| chord.cable == i).count(),
                false => POINTS * rod.cables[i].elements,
            };
        }
        Ok(rod)
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.lengths.len()
    }

    /// Number of the node that is nearest to an arc length in m.
    pub fn node_at(&self, arc_length: f64) -> usize {
        let after = self.nodes.partition_point(|node| node.arc_length < arc_length);
        let distance = |i: usize| (self.nodes[i].arc_length - arc_length).abs();
        match after {
            0 => 0,
            n if n == self.nodes.len() => n - 1,
            n if distance(n - 1) < distance(n) => n - 1,
            n => n,
        }
    }

    fn add_element(
        &mut self,
        robot: &Robot,
        e: usize,
        start: f64,
        options: &MotionOptions,
    ) -> Result<(), MotionError> {
        let h = self.lengths[e];
        let middle = start + 0.5 * h;
        for (place, weight) in GAUSS_2.nodes.into_iter().zip(GAUSS_2.weights) {
            let s = start + place * h;
            let matrix = section_stiffness(robot, s, middle).map_err(missing)?;
            let stiffness = block(&without_infinity(&matrix, self.length));
            let damping = match &options.damping {
                Damping::None => Block::default(),
                Damping::Time(time) => {
                    let mut damping = Block::default();
                    damping.add_scaled(*time, &stiffness);
                    damping
                }
                Damping::Matrix(matrix) => block(matrix),
            };
            let curvature = robot.backbone().rest_curvature.at_end(robot.disks(), s, middle);
            let rest = Twist { linear: Vec3::Z, angular: curvature };
            self.points.push(Point { weight: weight * h, stiffness, damping, rest });
        }
        for (a, (place, weight)) in PLACES.into_iter().zip(LOBATTO).enumerate() {
            // What jumps at an end is that of this element.
            let inside = start + place.clamp(1e-9, 1.0 - 1e-9) * h;
            let density = robot.backbone().linear_density_at(robot.disks(), inside);
            let density =
                density.filter(|&density| density > 0.0).ok_or_else(|| massless(robot))?;
            let node = &mut self.nodes[2 * e + a];
            node.arc_length = start + place * h;
            node.share += weight * h;
            node.mass += weight * h * density;
            let gyration = squared_gyration(robot, inside, self.length);
            node.inertia += gyration * (weight * h * density);
        }
        Ok(())
    }

    /// Disks are cylinders of their rim radius and thickness.
    fn add_disks(&mut self, robot: &Robot) {
        let disks = robot.disks();
        if !disks.are_present || disks.mass == 0.0 {
            return;
        }
        for (i, &s) in disks.arc_lengths.iter().enumerate() {
            let radius = disks.rim_radius(i);
            let thickness = disks.thickness.unwrap_or(0.1 * radius);
            let node = self.node_at(s);
            self.nodes[node].mass += disks.mass;
            self.nodes[node].inertia += Disks::moments_of_inertia(disks.mass, radius, thickness);
        }
    }

    fn lay_cables(&mut self, robot: &Robot, ends: &[f64]) {
        let count = robot.cables().len();
        self.crossings = vec![Crossing::default(); self.points.len() * count];
        for (i, route) in robot.routes().iter().enumerate() {
            let near = 1e-9 * self.length;
            let elements = ends[1..].partition_point(|&end| end <= route.end() + near);
            let mut rest_length = 0.0;
            for e in 0..elements {
                for (k, place) in GAUSS_2.nodes.into_iter().enumerate() {
                    let q = POINTS * e + k;
                    let at = route.at(ends[e] + place * self.lengths[e]);
                    let crossing = Crossing { offset: at.offset, slope: at.slope };
                    rest_length +=
                        self.points[q].weight * crossing.tangent(&self.points[q].rest).norm();
                    self.crossings[q * count + i] = crossing;
                }
            }
            self.cables.push(CableLine {
                elements,
                rest_length,
                compliance: robot.cable_compliance(i, rest_length),
                pretension: robot.pretension(i),
            });
        }
    }

    /// Lays the cables straight from disk to disk.
    fn lay_straight_cables(&mut self, robot: &Robot) {
        let spans = straight_passages(robot);
        let disks = &robot.disks().arc_lengths;
        for i in 0..robot.cables().len() {
            for (disks, passages) in disks.windows(2).zip(&spans) {
                let Some(passage) = passages.iter().find(|of| of.cable == i) else { continue };
                let end = disks[0] + passage.reach * (disks[1] - disks[0]);
                self.chords.push(Chord {
                    cable: i,
                    nodes: [self.node_at(disks[0]), self.node_at(end)],
                    holes: [passage.near, passage.far],
                });
            }
        }
        for pair in disks.windows(2) {
            let [start, end] = [pair[0], pair[1]].map(|s| self.node_at(s) / POINTS);
            self.span_starts[start..end].fill(start);
        }
        let mut poses = vec![Pose::IDENTITY];
        for (&h, points) in self.lengths.iter().zip(self.points.chunks_exact(POINTS)) {
            let rest = [points[0].rest, points[1].rest];
            poses.extend(element::poses(poses[poses.len() - 1], &rest, h));
        }
        for i in 0..robot.cables().len() {
            let rest_length = self.straight_length(i, &poses);
            let of_cable = self.chords.iter().filter(|chord| chord.cable == i);
            let elements = of_cable.map(|chord| chord.nodes[1] / POINTS).max().unwrap_or(0);
            self.cables.push(CableLine {
                elements,
                rest_length,
                compliance: robot.cable_compliance(i, rest_length),
                pretension: robot.pretension(i),
            });
        }
    }

    /// Length in m of a straight cable where the nodes have these poses.
    pub fn straight_length(&self, cable: usize, poses: &[Pose]) -> f64 {
        let of_cable = self.chords.iter().filter(|chord| chord.cable == cable);
        of_cable.map(|chord| chord.way(poses).norm()).sum()
    }

    /// The cable of each passage.
    pub fn cables_of_passages(&self) -> Vec<usize> {
        if self.has_chords() {
            return self.chords.iter().map(|chord| chord.cable).collect();
        }
        let cables = self.cables.iter().enumerate();
        cables.flat_map(|(i, cable)| core::iter::repeat_n(i, POINTS * cable.elements)).collect()
    }

    /// Whether cables run straight from disk to disk.
    pub fn has_chords(&self) -> bool {
        !self.chords.is_empty()
    }

    /// Length in m of a cable for these strains, which give the nodes these poses.
    pub fn cable_length(&self, cable: usize, strains: &[Twist], poses: &[Pose]) -> f64 {
        if self.has_chords() {
            return self.straight_length(cable, poses);
        }
        let count = self.cables.len();
        (0..POINTS * self.cables[cable].elements)
            .map(|q| {
                let tangent = self.crossings[q * count + cable].tangent(&strains[q]);
                self.points[q].weight * tangent.norm()
            })
            .sum()
    }
}

/// What has no dynamics here.
fn refuse_unsupported(robot: &Robot) -> Result<(), MotionError> {
    let refuse = |path: String, what, advice| Err(MotionError::Unsupported { path, what, advice });
    let plays = |motor: &whipcord::Motor| motor.dynamics.is_some() && motor.backlash > 0.0;
    if let Some(i) = robot.motors().iter().position(plays) {
        return refuse(
            format!("motors[{i}].backlash"),
            "backlash of a motor with inertia",
            "leave out the backlash, or the inertia and the gains of the motor",
        );
    }
    if robot.has_bending_friction() {
        return refuse(
            "backbone.yield_moment".to_owned(),
            "friction against bending",
            "leave it out and give the damping of the backbone instead",
        );
    }
    Ok(())
}

fn massless(robot: &Robot) -> MotionError {
    let (path, advice) = if robot.backbone().section.is_some() {
        ("backbone.density", "give the density of the backbone, which must be positive everywhere")
    } else {
        (
            "backbone.linear_density",
            "give the mass per length of the backbone, which must be positive everywhere",
        )
    };
    MotionError::Missing { path: path.to_owned(), advice }
}

/// What the statics says of a missing stiffness, for a model of motion.
fn missing(error: SolveError) -> MotionError {
    match error {
        SolveError::Missing { path, .. } => MotionError::Missing {
            path,
            advice: "give the stiffness of the backbone, or its cross-section and material",
        },
        other => MotionError::NoEquilibrium(other),
    }
}

/// The stiffness with a large number where it is infinite.
fn without_infinity(matrix: &StiffnessMatrix, length: f64) -> StiffnessMatrix {
    let bending = matrix[3][3].max(matrix[4][4]).max(matrix[5][5]);
    matrix
        .map(|row| row.map(|k| if k.is_finite() { k } else { HELD * bending / (length * length) }))
}

fn block(m: &[[f64; 6]; 6]) -> Block {
    let part = |i: usize, j: usize| {
        let row = |k: usize| Vec3::new(m[i + k][j], m[i + k][j + 1], m[i + k][j + 2]);
        Mat3::from_rows(row(0), row(1), row(2))
    };
    Block { a: part(0, 0), b: part(0, 3), c: part(3, 0), d: part(3, 3) }
}

/// Squared radii of gyration in m² about the axes of the section.
fn squared_gyration(robot: &Robot, s: f64, length: f64) -> Vec3 {
    if let Some(section) = robot.backbone().section_at(robot.disks(), s) {
        let (x, y) =
            (section.second_moment_x / section.area, section.second_moment_y / section.area);
        return Vec3::new(x, y, x + y);
    }
    let (x, y) = match section_stiffness(robot, s, s) {
        Ok(k) if k[2][2].is_finite() => (k[3][3] / k[2][2], k[4][4] / k[2][2]),
        _ => ((GYRATION * length).powi(2), (GYRATION * length).powi(2)),
    };
    Vec3::new(x, y, x + y)
}
