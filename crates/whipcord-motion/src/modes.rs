//! Natural vibrations about a state: the lowest frequencies, their shapes and damping.

use core::f64::consts::TAU;

use whipcord_numerics::{DenseLu, Pose, Twist, Vec3, symmetric_eigen};

use crate::block::dot;
use crate::contacts::Contacts;
use crate::element::POINTS;
use crate::iteration::Solver;
use crate::loads::NodeLoads;
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;
use crate::state::State;

/// A natural vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Square of the angular frequency without damping in rad²/s²; negative where the state is unstable.
    pub squared_frequency: f64,
    /// Damping ratio: 1 is critical; 0 where the frequency is 0. Exact where the damping is proportional to the stiffness or small, else that of the undamped shape.
    pub damping_ratio: f64,
    /// Displacement of each node in its frame, in m and rad, as a twist; scaled to a kinetic energy of ½ J for velocities of this size.
    pub shape: Vec<Twist>,
}

impl Mode {
    /// Displacement of each node in m and rotation in rad along the axes of the world, for nodes with the poses of this state.
    #[must_use]
    pub fn in_world(&self, state: &State) -> Vec<Twist> {
        let turned = |(twist, pose): (&Twist, &Pose)| Twist {
            linear: pose.rotation.rotate(twist.linear),
            angular: pose.rotation.rotate(twist.angular),
        };
        self.shape.iter().zip(&state.poses).map(turned).collect()
    }

    /// Frequency in Hz at which the damped robot vibrates; `None` where the state is unstable in this shape, or the damping is
    /// critical or more.
    #[must_use]
    pub fn damped_frequency(&self) -> Option<f64> {
        let square = self.squared_frequency * (1.0 - self.damping_ratio * self.damping_ratio);
        (self.squared_frequency >= 0.0 && square > 0.0).then(|| square.sqrt() / TAU)
    }

    /// Frequency in Hz without damping; `None` where the state is unstable in this shape.
    #[must_use]
    pub fn frequency(&self) -> Option<f64> {
        Some(self.angular_frequency()? / TAU)
    }

    /// Angular frequency without damping in rad/s; `None` where the state is unstable in this shape.
    #[must_use]
    pub fn angular_frequency(&self) -> Option<f64> {
        (self.squared_frequency >= 0.0).then(|| self.squared_frequency.sqrt())
    }
}

/// Vectors beside those asked for, with which the iteration converges faster.
const SPARE: usize = 8;
/// Iterations at most.
const MOST: usize = 300;
/// Relative change of the squared frequencies at the end.
const TOLERANCE: f64 = 1e-11;

/// The system of the vibrations: stiffness with the cables and contacts that are held, masses and damping.
struct Vibrations<'a> {
    rod: &'a Rod,
    stage: Stage,
    /// `σ` in rad²/s²: the matrix of the stage is `K + σM`. Of a base that is held 0; a free one would leave `K` singular.
    shift: f64,
    /// The first node that moves.
    first: usize,
    /// What the forces of held cables and contacts exert, and the displacements that they take away.
    held: Vec<(Vec<Twist>, Vec<Twist>)>,
    lu: DenseLu,
}

impl Vibrations<'_> {
    /// `M x`.
    fn inertia(&self, x: &[Twist], out: &mut [Twist]) {
        for ((out, x), node) in out.iter_mut().zip(x).zip(&self.rod.nodes) {
            out.linear = x.linear * node.mass;
            out.angular = node.inertia.scale(x.angular);
        }
        out[..self.first].fill(Twist::default());
    }

    /// `(K + σM)⁻¹ x` with the held cables and contacts.
    fn solve(&self, x: &mut [Twist]) {
        self.stage.matrix.solve(x);
        if self.held.is_empty() {
            return;
        }
        let mut tensions: Vec<f64> = self.held.iter().map(|(pull, _)| product(pull, x)).collect();
        self.lu.solve(&mut tensions);
        for ((_, taken), tension) in self.held.iter().zip(tensions) {
            for (x, taken) in x.iter_mut().zip(taken) {
                *x = *x - *taken * tension;
            }
        }
    }
}

fn product(a: &[Twist], b: &[Twist]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// The lowest modes about the strains and tensions in a solver, by subspace iteration; `held` are the cables and pieces of cables whose lengths are held and that are
/// taut, each with what a tension of 1 N exerts and with its compliance, and what `contacts` has touches and stays where it does. `None` where the stiffness is singular or the iteration does not converge.
pub(crate) fn find(
    rod: &Rod,
    loads: &NodeLoads,
    solver: &Solver,
    held: Vec<(Vec<Twist>, f64)>,
    mut contacts: Contacts,
    count: usize,
) -> Option<Vec<Mode>> {
    /// What a held contact, or a rigid cable, yields of itself, as a part of what the robot does: several of one disk may depend on one another.
    const SHARING: f64 = 1e-9;
    /// A squared frequency of a free robot that counts as 0, as a part of the shift.
    const ROUNDING: f64 = 1e-6;
    let first = loads.first_free();
    // A robot that nothing holds falls with its gravity, and has it not in its frame.
    let (shift, gravity) =
        if first == 0 { (slowest(rod), Vec3::ZERO) } else { (0.0, loads.gravity) };
    let stage = solver.stage.clone();
    let mut system =
        Vibrations { rod, stage, shift, first, held: Vec::new(), lu: DenseLu::default() };
    let stage = &mut system.stage;
    stage.velocities.fill(Twist::default());
    stage.velocity_history.fill(Twist::default());
    stage.strain_history.copy_from_slice(&solver.stage.strains);
    stage.start.copy_from_slice(&solver.stage.strains);
    stage.matrix.hold_base(first > 0);
    pose::nodes(rod, stage.base, &solver.stage.strains, &mut stage.poses);
    let scheme = Scheme { inertia: shift, ..Scheme::STATICS };
    stage.assemble(rod, &scheme, gravity, Vec3::ZERO, true);
    contacts.refresh(rod, &scheme, stage);
    contacts.add_stiffness(rod, stage);
    stage.matrix.factor().ok()?;
    let (mut columns, compliances): (Vec<Vec<Twist>>, Vec<f64>) = held.into_iter().unzip();
    for (k, contact) in contacts.list.iter().enumerate() {
        for line in 0..contact.lines() {
            let list = || vec![Twist::default(); rod.nodes.len()];
            let (mut push, mut motion) = (list(), list());
            contacts.linearise(&scheme, k, line, &mut push, &mut motion);
            columns.push(motion);
        }
    }
    for column in columns {
        let mut taken = column.clone();
        system.stage.matrix.solve(&mut taken);
        system.held.push((column, taken));
    }
    let n = system.held.len();
    let mut matrix = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            matrix[i * n + j] = product(&system.held[i].0, &system.held[j].1);
        }
        let own = &mut matrix[i * n + i];
        // Pieces of rigid cables may hold the robot as contacts do.
        *own += compliances.get(i).copied().filter(|of| *of > 0.0).unwrap_or(SHARING * *own);
    }
    system.lu.factor(n, &matrix).ok()?;
    let modes = iterate(&system, count)?;
    let damped = |(squared_frequency, shape): (f64, Vec<Twist>)| {
        // Of a motion as a whole rounding is left.
        if squared_frequency.abs() < ROUNDING * shift {
            return Mode { squared_frequency: 0.0, damping_ratio: 0.0, shape };
        }
        let rate = damping(rod, &system.stage, solver.drag, &shape);
        let damping_ratio = 0.5 * rate / squared_frequency.abs().sqrt();
        Mode { squared_frequency, damping_ratio, shape }
    };
    Some(modes.into_iter().map(damped).collect())
}

/// A squared frequency in rad²/s² of the order of the slowest vibrations: `EI/(m L³)` with the least stiffness against bending.
fn slowest(rod: &Rod) -> f64 {
    let stiffness = rod.points.iter().map(|point| {
        let d = &point.stiffness.d;
        d.rows[0][0].min(d.rows[1][1])
    });
    let mass: f64 = rod.nodes.iter().map(|node| node.mass).sum();
    stiffness.fold(f64::INFINITY, f64::min) / (mass * rod.length.powi(3))
}

/// Subspace iteration with Ritz vectors.
fn iterate(system: &Vibrations<'_>, count: usize) -> Option<Vec<(f64, Vec<Twist>)>> {
    let nodes = system.rod.nodes.len();
    let all = (6 * (nodes - system.first)).saturating_sub(system.held.len());
    let count = count.min(all);
    let size = (count + SPARE).min(all);
    let mut basis: Vec<Vec<Twist>> = (0..size).map(|k| start(nodes, k)).collect();
    let mut other = vec![Twist::default(); nodes];
    let mut values = vec![0.0; size];
    for _ in 0..MOST {
        orthonormalize(system, &mut basis, &mut other)?;
        let mut next = Vec::with_capacity(size);
        for x in &basis {
            let mut y = vec![Twist::default(); nodes];
            system.inertia(x, &mut y);
            system.solve(&mut y);
            next.push(y);
        }
        let mut projected = vec![0.0; size * size];
        for i in 0..size {
            system.inertia(&basis[i], &mut other);
            for j in 0..size {
                let entry = 0.5 * product(&other, &next[j]);
                projected[i * size + j] += entry;
                projected[j * size + i] += entry;
            }
        }
        let mut vectors = vec![0.0; size * size];
        let inverse: Vec<f64> = symmetric_eigen(size, &mut projected, &mut vectors).collect();
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| inverse[b].abs().total_cmp(&inverse[a].abs()));
        let combine = |row: usize, of: &[Vec<Twist>]| {
            let mut sum = vec![Twist::default(); nodes];
            for (x, f) in of.iter().zip(&vectors[row * size..(row + 1) * size]) {
                for (sum, x) in sum.iter_mut().zip(x) {
                    *sum = *sum + *x * *f;
                }
            }
            sum
        };
        let new: Vec<f64> = order.iter().map(|&row| 1.0 / inverse[row]).collect();
        let has_converged =
            (0..count).all(|k| (new[k] - values[k]).abs() <= TOLERANCE * new[k].abs());
        values = new;
        if has_converged {
            let modes = order[..count]
                .iter()
                .zip(&values)
                .map(|(&row, &value)| (value - system.shift, combine(row, &basis)));
            let mut modes: Vec<_> = modes.collect();
            modes.sort_by(|a, b| a.0.total_cmp(&b.0));
            return Some(modes);
        }
        basis = order.iter().map(|&row| combine(row, &next)).collect();
    }
    None
}

/// A vector without a pattern.
fn start(nodes: usize, number: usize) -> Vec<Twist> {
    let mut seed = number as u64 + 1;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
    };
    let mut vector = || Vec3::new(random(), random(), random());
    (0..nodes).map(|_| Twist { linear: vector(), angular: vector() }).collect()
}

/// Makes vectors orthonormal in the masses, twice against rounding.
fn orthonormalize(
    system: &Vibrations<'_>,
    basis: &mut [Vec<Twist>],
    other: &mut [Twist],
) -> Option<()> {
    for k in 0..basis.len() {
        let (before, from) = basis.split_at_mut(k);
        let x = &mut from[0];
        x[..system.first].fill(Twist::default());
        for _ in 0..2 {
            for y in &*before {
                system.inertia(y, other);
                let f = product(x, other);
                for (x, y) in x.iter_mut().zip(y) {
                    *x = *x - *y * f;
                }
            }
            system.inertia(x, other);
            let norm = product(x, other).sqrt();
            if !(norm > 0.0 && norm.is_finite()) {
                return None;
            }
            for x in x.iter_mut() {
                *x = *x * (1.0 / norm);
            }
        }
    }
    Some(())
}

/// What damping and drag take of velocities of this shape in W.
fn damping(rod: &Rod, stage: &Stage, drag: Vec3, shape: &[Twist]) -> f64 {
    let mut sum = 0.0;
    for e in 0..rod.elements() {
        for k in 0..POINTS {
            let q = POINTS * e + k;
            let (value, slope) = Stage::at_point(shape, e, k, rod.lengths[e]);
            let rate = slope + stage.strains[q].bracket(value);
            sum += rod.points[q].weight * dot(&rod.points[q].damping.apply(&rate), &rate);
        }
    }
    for (node, velocity) in rod.nodes.iter().zip(shape) {
        sum += node.share * drag.scale(velocity.linear).dot(velocity.linear);
    }
    sum
}
