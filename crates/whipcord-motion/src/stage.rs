//! The equations of one implicit stage and their linearisation, section "One stage" of the page on motion.

use whipcord::Wrench;
use whipcord_numerics::{Mat3, Pose, Twist, Vec3};

use crate::block::{Block, dot, skew_times, times_skew, transposed_bracket};
use crate::chords;
use crate::element::{NODES, POINTS, SHAPES, SLOPES, add_to_nodes};
use crate::elimination::Elimination;
use crate::free_base::FreeBase;
use crate::loads::{NodeLoad, NodeLoads};
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;

/// Unknowns, history, residual and linearisation of a stage.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    /// Unknown velocity of each node, in its frame.
    pub velocities: Vec<Twist>,
    /// Unknown strain of each point.
    pub strains: Vec<Twist>,
    /// `V_h`.
    pub velocity_history: Vec<Twist>,
    /// `ξ_h`.
    pub strain_history: Vec<Twist>,
    /// Strains at the start of the step.
    pub start: Vec<Twist>,
    /// Tension of each cable in N.
    pub tensions: Vec<f64>,
    /// Tension of each passage in N where cables have friction; empty where they have none.
    pub passages: Vec<f64>,
    /// Whether the work of each cable stays in the robot: of motors with inertia.
    pub is_internal: Vec<bool>,
    /// What acts on each node.
    pub loads: Vec<NodeLoad>,
    /// Force against the strain of each point, times its weight, of what acts by the gradient of a potential: of straight cables and, where the scheme
    /// conserves, of dead forces.
    pub potential: Vec<Twist>,
    /// The gradient of that potential by the places and turns of the nodes.
    pulls: Vec<Wrench>,
    /// How far the sections of the nodes will still move, in their frames, since strains lack something.
    shifts: Vec<Twist>,
    /// Pose of the base, in its frame at the start of the motion.
    pub base: Pose,
    /// How that pose follows from the velocity where the base is free.
    pub free_base: Option<FreeBase>,
    /// Whether the base moves, led or free. Dead forces act on the nodes then, not by the gradient of their heights, which depend on more than the strains.
    pub moves_base: bool,
    /// Force and moment of the base on the node there, as the equations were evaluated last.
    pub base_force: Twist,
    /// Pose of each node, in the frame of the base at the start of the motion.
    pub poses: Vec<Pose>,
    /// Poses at the start or the end of the step.
    other_poses: Vec<Pose>,
    /// Strains at the end of the step.
    end: Vec<Twist>,
    /// What the equations of motion of each node lack.
    pub residual: Vec<Twist>,
    /// `z`: what the strain of each point lacks.
    pub lack: Vec<Twist>,
    /// What the strain of each point changes by, of the step found last.
    pub change: Vec<Twist>,
    /// Matrix of the velocities.
    pub matrix: Elimination,
    /// Linearisation at each point.
    pub tangents: Vec<PointTangent>,
}

/// The linearisation at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointTangent {
    /// Strain at which it was made.
    strain: Twist,
    /// `T`.
    wrench: Block,
    /// `P₂`.
    turned: Block,
    /// `g Q`, the diagonal blocks of `S₁`.
    diagonal: Mat3,
    /// The upper block of `S₁`.
    upper: Mat3,
}

/// Below this squared change of the strains the correction of the discrete gradient, of third order in it, is less than rounding.
pub(crate) const LEAST_CHANGE: f64 = 1e-12;

/// The force on the strain of a point along which the discrete gradient is corrected, for a change of the strain.
pub(crate) fn along_change(rod: &Rod, point: usize, change: Twist) -> Twist {
    let weight = rod.points[point].weight;
    Twist {
        linear: change.linear * weight,
        angular: change.angular * (weight * rod.length * rod.length),
    }
}

impl PointTangent {
    /// `S₁ b`.
    #[inline]
    pub fn transport(&self, b: &Twist) -> Twist {
        Twist {
            linear: self.diagonal * b.linear + self.upper * b.angular,
            angular: self.diagonal * b.angular,
        }
    }

    /// Change of the strain for a slope and a value of the change of the velocities: `S₁ δV′ + S₂ δV`, eq. (10).
    #[inline]
    pub fn strain_change(&self, slope: Twist, value: Twist) -> Twist {
        self.transport(&(slope + self.strain.bracket(value)))
    }

    /// Transpose of [`Self::strain_change`]: what a force on the strain exerts on slope and value.
    #[inline]
    pub fn transposed_strain_change(&self, force: &Twist) -> (Twist, Twist) {
        let slope = Twist {
            linear: self.diagonal.transpose_mul(force.linear),
            angular: self.upper.transpose_mul(force.linear)
                + self.diagonal.transpose_mul(force.angular),
        };
        (slope, transposed_bracket(&self.strain, &slope))
    }

    /// What a change of the strain adds to the wrench, and with it across the section: `T` and `P₂` of it.
    pub fn wrench_change(&self, change: &Twist) -> (Twist, Twist) {
        (self.wrench.apply(change), self.turned.apply(change))
    }

    /// Transpose of what a change of the strain adds to the wrench: `Tᵀ` of the slope, and `P₂ᵀ` of the value.
    pub fn transposed_wrench_change(&self, slope: &Twist, value: &Twist) -> (Twist, Twist) {
        (self.wrench.apply_transposed(slope), self.turned.apply_transposed(value))
    }
}

impl Stage {
    pub fn new(rod: &Rod) -> Self {
        let (nodes, points) = (rod.nodes.len(), rod.points.len());
        let twists = |n: usize| vec![Twist::default(); n];
        let mut stage = Self {
            velocities: twists(nodes),
            strains: rod.points.iter().map(|point| point.rest).collect(),
            velocity_history: twists(nodes),
            strain_history: twists(points),
            start: twists(points),
            tensions: vec![0.0; rod.cables.len()],
            passages: Vec::new(),
            is_internal: vec![false; rod.cables.len()],
            loads: vec![NodeLoad::default(); nodes],
            potential: twists(points),
            pulls: vec![Wrench::default(); nodes],
            shifts: twists(nodes),
            base: Pose::IDENTITY,
            free_base: None,
            moves_base: false,
            base_force: Twist::default(),
            poses: vec![Pose::IDENTITY; nodes],
            other_poses: vec![Pose::IDENTITY; nodes],
            end: twists(points),
            residual: twists(nodes),
            lack: twists(points),
            change: twists(points),
            matrix: Elimination::new(&rod.span_starts, rod.has_chords(), true),
            tangents: vec![PointTangent::default(); points],
        };
        pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
        stage
    }

    /// Moves the base, from its pose at the start of the step, to where it is `h` later.
    pub fn move_base(&mut self, loads: &NodeLoads, from: Pose, time: f64, h: f64) {
        self.base = loads.base_pose(from, time, h);
        self.velocities[0] = loads.base_velocity(time + h);
        self.velocity_history[0] = self.velocities[0];
    }

    /// Whether dead forces act by the gradient of their heights.
    pub fn by_heights(&self, scheme: &Scheme) -> bool {
        scheme.conserves && !self.moves_base
    }

    /// Tension in N of a chord, by its number.
    pub fn chord_tension(&self, rod: &Rod, chord: usize) -> f64 {
        self.passages.get(chord).copied().unwrap_or(self.tensions[rod.chords[chord].cable])
    }

    /// Evaluates the residual; with `fresh` the linearisation as well. Poses and loads must be those of the strains.
    pub fn assemble(&mut self, rod: &Rod, scheme: &Scheme, gravity: Vec3, drag: Vec3, fresh: bool) {
        self.residual.fill(Twist::default());
        if rod.has_chords() && !scheme.conserves {
            self.find_cable_forces(rod, false);
        }
        for e in 0..rod.elements() {
            if fresh {
                self.matrix.elements[e] = Default::default();
            }
            for k in 0..POINTS {
                self.add_point(rod, scheme, e, k, fresh);
            }
        }
        self.base_force = self.residual[0];
        for a in usize::from(self.matrix.holds_base())..rod.nodes.len() {
            self.add_node(rod, scheme, a, gravity, drag, fresh);
        }
        if rod.has_chords() {
            self.link_nodes(rod, scheme, fresh);
        }
    }

    /// Finds what straight cables exert on the strains, eq. (27): all of them, or those alone whose work is `external`. Poses must be those of the strains.
    pub fn find_cable_forces(&mut self, rod: &Rod, external: bool) {
        let Self { strains, poses, pulls, potential, tensions, passages, is_internal, .. } = self;
        let tension = |k: usize| {
            let cable = rod.chords[k].cable;
            let is_left_out = external && is_internal[cable];
            let tension = passages.get(k).copied().unwrap_or(tensions[cable]);
            if is_left_out { 0.0 } else { tension }
        };
        chords::gradient(rod, strains, poses, tension, pulls, potential);
    }

    /// Adds to residual and matrix how straight cables change their pull with the displacements of the nodes, eq. (28).
    fn link_nodes(&mut self, rod: &Rod, scheme: &Scheme, fresh: bool) {
        let Self { poses, lack, shifts, residual, matrix, tensions, passages, velocities, .. } =
            self;
        pose::displacements(rod, poses, lack, |node, turn, shift| {
            let back = poses[node].rotation.conjugate();
            shifts[node] = Twist { linear: back.rotate(shift), angular: back.rotate(turn) };
        });
        if fresh {
            matrix.links.fill(Default::default());
        }
        for (k, chord) in rod.chords.iter().enumerate() {
            let tension = passages.get(k).copied().unwrap_or(tensions[chord.cable]);
            if tension == 0.0 {
                continue;
            }
            let stiffness = chord.stiffness(poses, tension);
            for (i, &row) in chord.nodes.iter().enumerate() {
                for (j, &column) in chord.nodes.iter().enumerate() {
                    residual[row] = residual[row] + stiffness[i][j].apply(&shifts[column]);
                    if fresh {
                        let link = &mut matrix.links[chord.nodes[1] / POINTS - 1];
                        let moved = Transport::new(&velocities[column], scheme.g).block(scheme.g);
                        link[i][j].add_scaled(1.0, &stiffness[i][j].times(&moved));
                    }
                }
            }
        }
    }

    /// Finds the forces on the strains of dead forces, gravity and straight cables whose work in the step is exactly that of the heights and lengths at its start
    /// and end: the gradient in the middle, corrected along the change of the strains (Gonzalez, *Time integration and discrete Hamiltonian systems*,
    /// J. Nonlinear Sci. 6, 1996), eq. (18). Poses must be those of the strains.
    pub fn find_conserving_forces(&mut self, rod: &Rod, gravity: Vec3, scheme: &Scheme) {
        let Self {
            base,
            loads,
            potential,
            pulls,
            poses,
            other_poses,
            end,
            start,
            strains,
            tensions,
            moves_base,
            ..
        } = self;
        let force = |a: usize| match *moves_base {
            true => Vec3::ZERO,
            false => loads[a].force + gravity * rod.nodes[a].mass,
        };
        let tension = |k: usize| tensions[rod.chords[k].cable];
        chords::level_gradient(rod, strains, poses, tension, force, pulls, potential);
        let level = |poses: &[Pose]| chords::work(rod, poses, tension) - pose::work(poses, force);
        pose::nodes(rod, *base, start, other_poses);
        let mut work = -level(other_poses);
        for ((end, start), strain) in end.iter_mut().zip(&*start).zip(&*strains) {
            *end = scheme.end(*start, *strain);
        }
        pose::nodes(rod, *base, end, other_poses);
        work += level(other_poses);
        let mut size = 0.0;
        for q in 0..rod.points.len() {
            let change = end[q] - start[q];
            work -= dot(&potential[q], &change);
            size += dot(&change, &along_change(rod, q, change)) / rod.length;
        }
        if size < LEAST_CHANGE {
            return;
        }
        for q in 0..rod.points.len() {
            let change = along_change(rod, q, end[q] - start[q]);
            potential[q] = potential[q] + change * (work / (size * rod.length));
        }
    }

    /// Tension in N of a continuous cable at a point that it passes.
    #[inline]
    pub fn tension_at(&self, rod: &Rod, cable: usize, point: usize) -> f64 {
        match self.passages.is_empty() {
            true => self.tensions[cable],
            false => self.passages[rod.first_passages[cable] + point],
        }
    }

    /// Velocity and its slope at a point of an element.
    #[inline]
    pub fn at_point(nodes: &[Twist], e: usize, k: usize, h: f64) -> (Twist, Twist) {
        let (f, d) = (SHAPES[k], SLOPES[k].map(|slope| slope / h));
        let [a, b, c] = [nodes[2 * e], nodes[2 * e + 1], nodes[2 * e + 2]];
        (a * f[0] + b * f[1] + c * f[2], a * d[0] + b * d[1] + c * d[2])
    }

    fn add_point(&mut self, rod: &Rod, scheme: &Scheme, e: usize, k: usize, fresh: bool) {
        let q = POINTS * e + k;
        let (point, h, g) = (&rod.points[q], rod.lengths[e], scheme.g);
        let (velocity, slope) = Self::at_point(&self.velocities, e, k, h);
        let strain = self.strains[q];
        // z = E⁻¹(ξ_h + g V′) − ξ, eq. (7).
        let inverse = Transport::new(&velocity, g);
        let lack = inverse.apply(self.strain_history[q] + slope * g) - strain;
        self.lack[q] = lack;
        let mut wrench = point.stiffness.apply(&(strain - point.rest));
        if rod.is_damped {
            let rate = (strain - self.strain_history[q]) * scheme.damping;
            wrench = wrench + point.damping.apply(&rate);
        }
        let mut stiffness = point.stiffness;
        if fresh && rod.is_damped {
            stiffness.add_scaled(scheme.damping, &point.damping);
        }
        let count = rod.cables.len();
        for i in 0..if rod.has_chords() { 0 } else { count } {
            if e >= rod.cables[i].elements {
                continue;
            }
            let tension = self.tension_at(rod, i, q);
            if tension == 0.0 {
                continue;
            }
            let crossing = &rod.crossings[q * count + i];
            let pull = Pull::new(crossing, &strain, &self.start[q], scheme);
            wrench = wrench + pull.wrench(crossing) * tension;
            if fresh {
                pull.add_stiffness(crossing, tension, &mut stiffness);
            }
        }
        if fresh {
            self.tangents[q] = PointTangent {
                strain,
                wrench: stiffness,
                turned: turned(&strain, &wrench, &stiffness),
                diagonal: inverse.matrix() * g,
                upper: Mat3::ZERO,
            };
            let diagonal = self.tangents[q].diagonal;
            self.tangents[q].upper = diagonal * skew_times(velocity.linear, &diagonal) * -1.0;
            self.add_to_matrix(e, k, q, point.weight, h);
        }
        let tangent = &self.tangents[q];
        // What acts by the gradient of a potential turns with the nodes, as their parts of the matrix say.
        if scheme.conserves || rod.has_chords() {
            wrench = wrench + self.potential[q] * (1.0 / point.weight);
        }
        let along = wrench + tangent.wrench.apply(&lack);
        let across = transposed_bracket(&strain, &wrench) + tangent.turned.apply(&lack);
        add_to_nodes(&mut self.residual[2 * e..], &along, &across, point.weight, k, h);
    }

    /// `Σ w (φ′φ′ T S₁ + φ′φ T S₂ + φφ′ P₂ S₁ + φφ P₂ S₂)`, eq. (11).
    fn add_to_matrix(&mut self, e: usize, k: usize, q: usize, weight: f64, h: f64) {
        let tangent = &self.tangents[q];
        let Twist { linear: v, angular: u } = tangent.strain;
        let (diagonal, upper) = (&tangent.diagonal, &tangent.upper);
        let with_s1 = |m: &Block| Block {
            a: m.a * *diagonal,
            b: m.a * *upper + m.b * *diagonal,
            c: m.c * *diagonal,
            d: m.c * *upper + m.d * *diagonal,
        };
        let with_bracket = |m: &Block| Block {
            a: times_skew(&m.a, u),
            b: times_skew(&m.a, v) + times_skew(&m.b, u),
            c: times_skew(&m.c, u),
            d: times_skew(&m.c, v) + times_skew(&m.d, u),
        };
        let along = with_s1(&tangent.wrench);
        let across = with_s1(&tangent.turned);
        let (along_value, across_value) = (with_bracket(&along), with_bracket(&across));
        let matrix = &mut self.matrix.elements[e];
        for b in 0..NODES {
            let (f, d) = (weight * SHAPES[k][b], weight * SLOPES[k][b] / h);
            let mut of_slope = Block::default();
            of_slope.add_scaled(d, &along);
            of_slope.add_scaled(f, &along_value);
            let mut of_value = Block::default();
            of_value.add_scaled(d, &across);
            of_value.add_scaled(f, &across_value);
            for a in 0..NODES {
                matrix[a][b].add_scaled(SLOPES[k][a] / h, &of_slope);
                matrix[a][b].add_scaled(SHAPES[k][a], &of_value);
            }
        }
    }

    /// Inertia, external loads and drag of a node, eq. (2).
    fn add_node(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        a: usize,
        gravity: Vec3,
        drag: Vec3,
        fresh: bool,
    ) {
        let (node, load) = (&rod.nodes[a], &self.loads[a]);
        let Twist { linear: nu, angular: omega } = self.velocities[a];
        let spin = node.inertia.scale(omega);
        let moving = if scheme.inertia == 0.0 { 0.0 } else { 1.0 };
        let change = (self.velocities[a] - self.velocity_history[a]) * scheme.inertia;
        let mut dead = load.force + gravity * node.mass;
        if self.by_heights(scheme) {
            dead = Vec3::ZERO;
        }
        let turn = self.poses[a].rotation.conjugate();
        let force = turn.rotate(dead);
        let moment = turn.rotate(load.moment);
        let resistance = drag * node.share * moving;
        let residual = &mut self.residual[a];
        residual.linear +=
            node.mass * (change.linear + moving * omega.cross(nu)) - force - load.follower_force
                + resistance.scale(nu);
        residual.angular += node.inertia.scale(change.angular) + moving * omega.cross(spin)
            - moment
            - load.follower_moment;
        if fresh {
            // Dead loads turn in the frame of the section by g δω, whether they act on the node or by the gradient of their heights.
            let force = turn.rotate(load.force + gravity * node.mass);
            let g = scheme.g;
            let skew = |w: Vec3| Mat3::skew(w) * moving;
            let inertia = Vec3::new(1.0, 1.0, 1.0) * (node.mass * scheme.inertia) + resistance;
            let block = Block {
                a: Mat3::diagonal(inertia) + skew(omega) * node.mass,
                b: skew(nu) * -node.mass - Mat3::skew(force) * g,
                c: Mat3::ZERO,
                d: Mat3::diagonal(node.inertia * scheme.inertia)
                    + skew(omega) * Mat3::diagonal(node.inertia)
                    - skew(spin)
                    - Mat3::skew(moment) * g,
            };
            // To the element before the node, as its end or its middle.
            let (e, local) = match a {
                0 => (0, 0),
                _ if a.is_multiple_of(2) => (a / 2 - 1, 2),
                _ => (a / 2, 1),
            };
            self.matrix.elements[e][local][local].add_scaled(1.0, &block);
        }
    }

    /// Finds the change of the strains that goes with the change of the velocities in [`Self::residual`], and adds both.
    pub fn advance(&mut self, rod: &Rod) {
        for e in 0..rod.elements() {
            for k in 0..POINTS {
                let q = POINTS * e + k;
                let (value, slope) = Self::at_point(&self.residual, e, k, rod.lengths[e]);
                self.change[q] = self.lack[q] + self.tangents[q].strain_change(slope, value);
                self.strains[q] = self.strains[q] + self.change[q];
            }
        }
        for (velocity, change) in self.velocities.iter_mut().zip(&self.residual) {
            *velocity = *velocity + *change;
        }
    }

    /// Size of the last change of velocities and strains: lengths of strain, and of motion during `g` as a part of the length.
    pub fn size_of_change(&self, rod: &Rod, scheme: &Scheme) -> f64 {
        let length = rod.length;
        let of_node = |change: &Twist| {
            (change.linear.max_abs() / length).max(change.angular.max_abs()) * scheme.g
        };
        let of_point =
            |change: &Twist| change.linear.max_abs().max(change.angular.max_abs() * length);
        let mut size = 0.0_f64;
        for change in self.residual.iter().map(of_node).chain(self.change.iter().map(of_point)) {
            // A NaN must not be passed over.
            size = if change > size || change.is_nan() { change } else { size };
            if size.is_nan() {
                return f64::INFINITY;
            }
        }
        size
    }
}

/// `E⁻¹`, with `E = I + g ad_V`.
struct Transport {
    turn: Vec3,
    linear: Vec3,
    scale: f64,
}

impl Transport {
    #[inline]
    fn new(velocity: &Twist, g: f64) -> Self {
        let turn = velocity.angular * g;
        Self { turn, linear: velocity.linear * g, scale: 1.0 / (1.0 + turn.norm_squared()) }
    }

    /// `Q y` with `Q = (I + â)⁻¹ = (I + a aᵀ − â)/(1 + a²)`.
    #[inline]
    fn turned(&self, y: Vec3) -> Vec3 {
        (y - self.turn.cross(y) + self.turn * self.turn.dot(y)) * self.scale
    }

    #[inline]
    fn apply(&self, b: Twist) -> Twist {
        let angular = self.turned(b.angular);
        Twist { linear: self.turned(b.linear - self.linear.cross(angular)), angular }
    }

    /// `g E⁻¹`, which is what a change of the velocity of a section in rigid motion moves it by.
    fn block(&self, g: f64) -> Block {
        let diagonal = self.matrix() * g;
        let upper = self.matrix() * skew_times(self.linear, &diagonal) * -1.0;
        Block { a: diagonal, b: upper, c: Mat3::ZERO, d: diagonal }
    }

    /// `Q`.
    #[inline]
    fn matrix(&self) -> Mat3 {
        let a = self.turn;
        (Mat3::outer(a, a) - Mat3::skew(a)).plus_identity() * self.scale
    }
}

/// `P₂ = ad_ξᵀ T + [0 n̂; n̂ m̂]`, eq. (9).
#[inline]
fn turned(strain: &Twist, wrench: &Twist, t: &Block) -> Block {
    let Twist { linear: v, angular: u } = *strain;
    let (force, moment) = (Mat3::skew(wrench.linear), Mat3::skew(wrench.angular));
    Block {
        a: -skew_times(u, &t.a),
        b: force - skew_times(u, &t.b),
        c: force - skew_times(v, &t.a) - skew_times(u, &t.c),
        d: moment - skew_times(v, &t.b) - skew_times(u, &t.d),
    }
}
