//! One step of Newton's method on the conditions of contact.

use clarabel::algebra::{CscMatrix, MatrixMathMut};
use clarabel::solver::SolverStatus;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT};
use whipcord_numerics::{DenseLu, Pose, UnitQuaternion, Vec3};

use super::model::Yielding;
use super::pairs::{Pair, Pairs};
use super::scene::Scene;
use crate::error::SolveError;

/// Scratch memory of the steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub compliance: Vec<f64>,
    /// How the cross-sections move by themselves.
    pub drift: Vec<f64>,
    /// `∂w/∂X` of each pair.
    geometric: Vec<[[f64; 6]; 6]>,
    /// `w` of each pair for a force of 1 N.
    unit: Vec<[f64; 6]>,
    matrix: Vec<f64>,
    lu: DenseLu,
    /// `(I − CG)⁻¹CB` by columns, the last for what the normals have turned since.
    moves: Vec<Vec<f64>>,
    complementarity: Complementarity,
    /// What the step changes of each push.
    changes: Vec<[f64; 6]>,
}

/// What came of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stepped {
    /// Whether the contacts change an odd number of directions from stable to unstable or back: the sign of
    /// `det(I − CG) det M` in eq. (6).
    pub odd: bool,
}

/// No step leads on.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoStep {
    /// The contacts have no equilibrium near.
    Contacts,
    Model(SolveError),
}

impl Scratch {
    /// Changes the forces of the pairs, what the model is to be given, and the model, eqs. (3) to (5); no
    /// cross-section is to move farther than `cap`.
    pub fn step(
        &mut self,
        pairs: &mut Pairs,
        model: &mut impl Yielding,
        scene: &Scene,
        cap: f64,
    ) -> Result<Stepped, NoStep> {
        let count = pairs.near.len();
        let n = 6 * count;
        self.unit.clear();
        self.unit.extend(pairs.near.iter().map(|pair| pair.nearest.push()));
        self.geometric.clear();
        self.geometric.extend(pairs.near.iter().map(|pair| geometric(pair, model, scene)));
        // I − CG
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for i in 0..n {
            for (k, block) in self.geometric.iter().enumerate() {
                if pairs.near[k].force == 0.0 {
                    continue;
                }
                for b in 0..6 {
                    let row = &self.compliance[i * n + 6 * k..i * n + 6 * k + 6];
                    let sum: f64 = row.iter().zip(block).map(|(c, g)| c * g[b]).sum();
                    self.matrix[i * n + 6 * k + b] = -sum;
                }
            }
            self.matrix[i * n + i] += 1.0;
        }
        self.lu.factor(n, &self.matrix).map_err(|_| NoStep::Contacts)?;
        self.moves.resize_with(count + 1, Vec::new);
        for (k, column) in self.moves.iter_mut().enumerate() {
            column.clear();
            column.extend((0..n).map(|i| {
                let row = &self.compliance[i * n..(i + 1) * n];
                if k < count {
                    dot(&row[6 * k..6 * k + 6], &self.unit[k])
                } else {
                    let pairs = pairs.near.iter().zip(&self.unit).enumerate();
                    let turn = |(j, (pair, unit)): (usize, (&Pair, &[f64; 6]))| {
                        dot(&row[6 * j..6 * j + 6], &turned(pair, unit))
                    };
                    self.drift[i] + pairs.map(turn).sum::<f64>()
                }
            }));
            self.lu.solve(column);
        }
        let approach = |i: usize, column: &[f64]| dot(&column[6 * i..6 * i + 6], &self.unit[i]);
        let problem = &mut self.complementarity;
        problem.reset(count);
        for (i, pair) in pairs.near.iter().enumerate() {
            problem.gaps[i] = pair.nearest.gap + approach(i, &self.moves[count]);
            problem.forces[i] = pair.force;
            problem.active[i] = pair.force > 0.0 || pair.nearest.gap < 0.0;
            for j in 0..count {
                problem.matrix[i * count + j] = approach(i, &self.moves[j]);
            }
        }
        let held = problem.solve()?;
        let odd = self.lu.is_determinant_negative() != held.negative;
        let mut motion = self.moves[count].clone();
        for (j, pair) in pairs.near.iter().enumerate() {
            let change = problem.forces[j] - pair.force;
            motion.iter_mut().zip(&self.moves[j]).for_each(|(x, y)| *x += change * y);
        }
        let farthest = motion.chunks(6).map(|x| x[0].hypot(x[1]).hypot(x[2])).fold(0.0, f64::max);
        if !farthest.is_finite() {
            return Err(NoStep::Contacts);
        }
        let part = if farthest > cap { cap / farthest } else { 1.0 };
        self.changes.clear();
        for (j, pair) in pairs.near.iter_mut().enumerate() {
            let change = problem.forces[j] - pair.force;
            let moved = &motion[6 * j..6 * j + 6];
            let turning = turned(pair, &self.unit[j]);
            let next = pair.force + part * change;
            let wrench: [f64; 6] = if next > 0.0 {
                core::array::from_fn(|a| {
                    let followed = dot(&self.geometric[j][a], moved);
                    self.unit[j][a] * change + turning[a] + followed
                })
            } else {
                pair.given.map(|component| -component)
            };
            self.changes.push(wrench);
            for (given, change) in pair.given.iter_mut().zip(wrench) {
                *given += part * change;
            }
            pair.force = next.max(0.0);
            if next <= 0.0 {
                pair.given = [0.0; 6];
            }
        }
        model.advance(&self.changes, part).map_err(NoStep::Model)?;
        Ok(Stepped { odd })
    }
}

/// `λw` where the robot is, without the wrench that the model has been given.
pub(super) fn turned(pair: &Pair, unit: &[f64; 6]) -> [f64; 6] {
    core::array::from_fn(|a| pair.force * unit[a] - pair.given[a])
}

/// `G = ∂(λw)/∂X` by central differences of the geometry, which is smooth and quick.
fn geometric(pair: &Pair, model: &impl Yielding, scene: &Scene) -> [[f64; 6]; 6] {
    let mut matrix = [[0.0; 6]; 6];
    if pair.force == 0.0 {
        return matrix;
    }
    let body = &pair.member.body;
    let pose = model.pose(pair.member.arc_length);
    let size = body.reach().max(1e-9);
    for b in 0..6 {
        let mut axis = [0.0; 3];
        axis[b % 3] = 1.0;
        let h = if b < 3 { 1e-5 * size } else { 1e-5 };
        let at = |h: f64| {
            let change = Vec3::from(axis) * h;
            let moved = if b < 3 {
                Pose { position: pose.position + change, ..pose }
            } else {
                Pose { rotation: UnitQuaternion::exp(change) * pose.rotation, ..pose }
            };
            body.track(scene.get(pair.obstacle), &moved, pair.nearest.local).push()
        };
        let (after, before) = (at(h), at(-h));
        for (a, row) in matrix.iter_mut().enumerate() {
            row[b] = pair.force * (after[a] - before[a]) / (2.0 * h);
        }
    }
    matrix
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `gap = q + Mλ ≥ 0, λ ≥ 0, λ·gap = 0`, eq. (5).
#[derive(Clone, Debug, Default)]
struct Complementarity {
    /// `M` by rows.
    matrix: Vec<f64>,
    /// The gaps where the forces are what they were.
    gaps: Vec<f64>,
    /// The forces that were, then those that solve it.
    forces: Vec<f64>,
    /// Which are thought to touch.
    active: Vec<bool>,
    lu: DenseLu,
}

/// Those that touch when it is solved.
#[derive(Clone, Copy, Debug)]
struct Held {
    /// Whether the determinant of their part of M is negative.
    negative: bool,
}

impl Complementarity {
    fn reset(&mut self, count: usize) {
        self.matrix.clear();
        self.matrix.resize(count * count, 0.0);
        for list in [&mut self.gaps, &mut self.forces] {
            list.clear();
            list.resize(count, 0.0);
        }
        self.active.clear();
        self.active.resize(count, false);
    }

    /// Mostly what touched touches again, and linear equations say how hard. Else those that pull are let go
    /// and those that overlap taken in, one at a time, which keeps to the history of the contacts and asks
    /// nothing of M: it has negative eigenvalues where the contacts hold what they alone would buckle. Where
    /// that goes round in circles a quadratic programme decides which touch.
    fn solve(&mut self) -> Result<Held, NoStep> {
        let count = self.gaps.len();
        for i in 0..count {
            let pushed: f64 = (0..count).map(|j| self.matrix[i * count + j] * self.forces[j]).sum();
            self.gaps[i] -= pushed;
        }
        for _ in 0..2 * count + 1 {
            match self.with_active() {
                Ok(held) => return Ok(held),
                Err(Some(worst)) => self.active[worst] = !self.active[worst],
                Err(None) => break,
            }
        }
        self.choose_active()?;
        self.with_active().map_err(|_| NoStep::Contacts)
    }

    /// The forces that close the gaps of the active ones, if none pulls and nothing else overlaps; else the one
    /// that does so most, where there are forces at all.
    fn with_active(&mut self) -> Result<Held, Option<usize>> {
        let count = self.gaps.len();
        let touching: Vec<usize> = (0..count).filter(|&i| self.active[i]).collect();
        let m = touching.len();
        let part: Vec<f64> = touching
            .iter()
            .flat_map(|i| touching.iter().map(move |j| (i, j)))
            .map(|(i, j)| {
                // Contacts that depend on one another share what they carry.
                let share = if i == j { 1.0 + SHARING } else { 1.0 };
                self.matrix[i * count + j] * share
            })
            .collect();
        let mut forces: Vec<f64> = touching.iter().map(|&i| -self.gaps[i]).collect();
        let mut negative = false;
        if m > 0 {
            self.lu.factor(m, &part).map_err(|_| None)?;
            self.lu.solve(&mut forces);
            negative = self.lu.is_determinant_negative();
        }
        if forces.iter().any(|force| !force.is_finite()) {
            return Err(None);
        }
        let most = forces.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        let scale = self.gaps.iter().fold(0.0_f64, |most, gap| most.max(gap.abs()));
        let gap = |i: usize| -> f64 {
            let row = &self.matrix[i * count..(i + 1) * count];
            self.gaps[i] + touching.iter().zip(&forces).map(|(&j, f)| row[j] * f).sum::<f64>()
        };
        let pulling = touching.iter().zip(&forces).map(|(&i, force)| (i, force / most));
        let free = (0..count).filter(|&i| !self.active[i]);
        let overlapping = free.map(|i| (i, gap(i) / scale));
        let wrong = pulling.chain(overlapping).filter(|&(_, size)| size < -ROUNDING);
        if let Some((worst, _)) = wrong.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Err(Some(worst));
        }
        self.forces.fill(0.0);
        for (&i, &force) in touching.iter().zip(&forces) {
            self.forces[i] = force.max(0.0);
        }
        Ok(Held { negative })
    }

    /// Which touch, by the quadratic programme `min ½λᵀMλ + qᵀλ, λ ≥ 0`, scaled to a diagonal of 1.
    fn choose_active(&mut self) -> Result<(), NoStep> {
        let count = self.gaps.len();
        let entry =
            |i: usize, j: usize| 0.5 * (self.matrix[i * count + j] + self.matrix[j * count + i]);
        let sizes: Vec<f64> = (0..count).map(|i| entry(i, i)).collect();
        if sizes.iter().any(|&size| size.is_nan() || size <= 0.0) {
            return Err(NoStep::Contacts);
        }
        let units: Vec<f64> = sizes.iter().map(|size| size.sqrt().recip()).collect();
        let mut linear: Vec<f64> = (0..count).map(|i| self.gaps[i] * units[i]).collect();
        let largest = linear.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        if largest == 0.0 {
            self.active.fill(false);
            return Ok(());
        }
        linear.iter_mut().for_each(|q| *q /= largest);
        let upper = (0..count).flat_map(|j| (0..=j).map(move |i| (i, j)));
        let (rows, columns): (Vec<usize>, Vec<usize>) = upper.clone().unzip();
        let values = upper.map(|(i, j)| entry(i, j) * units[i] * units[j]).collect();
        let quadratic = CscMatrix::new_from_triplets(count, count, rows, columns, values);
        let mut signs = CscMatrix::identity(count);
        signs.negate();
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .build()
            .map_err(|_| NoStep::Contacts)?;
        let bounds = vec![0.0; count];
        let cones = [NonnegativeConeT(count)];
        let mut solver = DefaultSolver::new(&quadratic, &linear, &signs, &bounds, &cones, settings)
            .map_err(|_| NoStep::Contacts)?;
        solver.solve();
        if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return Err(NoStep::Contacts);
        }
        for (i, active) in self.active.iter_mut().enumerate() {
            *active = solver.solution.x[i] > solver.solution.z[i];
        }
        Ok(())
    }
}

/// What a contact yields of itself, as a part of what the robot does.
const SHARING: f64 = 1e-11;
/// Forces and gaps smaller than this beside the largest are rounding.
const ROUNDING: f64 = 1e-9;
