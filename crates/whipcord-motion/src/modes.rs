//! Natural vibrations about a state: the lowest frequencies, their shapes and damping.

use core::f64::consts::TAU;

use whipcord_numerics::{DenseLu, Pose, Twist, Vec3, symmetric_eigen};

use crate::block::dot;
use crate::element::POINTS;
use crate::iteration::Solver;
use crate::lengths::Lengths;
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
    /// Damping ratio: 1 is critical. Exact where the damping is proportional to the stiffness or small, else that of the undamped shape.
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

/// The system of the vibrations: stiffness with the cables that are held, masses and damping.
struct Vibrations<'a> {
    rod: &'a Rod,
    stage: Stage,
    /// What the tensions of held cables exert, and the displacements that they take away.
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
        out[0] = Twist::default();
    }

    /// `K⁻¹ x` with the held cables.
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

/// The lowest modes about the strains and tensions in a solver, by subspace iteration; `held` are the cables whose lengths are held and that are
/// taut. `None` where the stiffness is singular or the iteration does not converge.
pub(crate) fn find(
    rod: &Rod,
    loads: &NodeLoads,
    solver: &Solver,
    held: &[usize],
    count: usize,
) -> Option<Vec<Mode>> {
    let mut system =
        Vibrations { rod, stage: solver.stage.clone(), held: Vec::new(), lu: DenseLu::default() };
    let stage = &mut system.stage;
    stage.velocities.fill(Twist::default());
    stage.strain_history.copy_from_slice(&solver.stage.strains);
    stage.start.copy_from_slice(&solver.stage.strains);
    pose::nodes(rod, stage.base, &solver.stage.strains, &mut stage.poses);
    stage.assemble(rod, &Scheme::STATICS, loads.gravity, Vec3::ZERO, true);
    stage.matrix.factor().ok()?;
    let columns: Vec<Vec<Twist>> =
        held.iter().map(|&cable| Lengths::pull(rod, &system.stage, cable)).collect();
    for column in columns {
        let mut taken = column.clone();
        system.stage.matrix.solve(&mut taken);
        system.held.push((column, taken));
    }
    let n = held.len();
    let mut matrix = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            matrix[i * n + j] = product(&system.held[i].0, &system.held[j].1);
        }
        matrix[i * n + i] += rod.cables[held[i]].compliance;
    }
    system.lu.factor(n, &matrix).ok()?;
    let modes = iterate(&system, count)?;
    let damped = |(squared_frequency, shape): (f64, Vec<Twist>)| {
        let rate = damping(rod, &system.stage, solver.drag, &shape);
        let damping_ratio = 0.5 * rate / squared_frequency.abs().sqrt();
        Mode { squared_frequency, damping_ratio, shape }
    };
    Some(modes.into_iter().map(damped).collect())
}

/// Subspace iteration with Ritz vectors.
fn iterate(system: &Vibrations<'_>, count: usize) -> Option<Vec<(f64, Vec<Twist>)>> {
    let nodes = system.rod.nodes.len();
    let count = count.min(6 * (nodes - 1));
    let size = (count + SPARE).min(6 * (nodes - 1));
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
                .map(|(&row, &value)| (value, combine(row, &basis)));
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
        x[0] = Twist::default();
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
