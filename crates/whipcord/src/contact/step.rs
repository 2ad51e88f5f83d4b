//! One step of Newton's method on the conditions of contact.

use whipcord_numerics::{DenseLu, Pose, UnitQuaternion, Vec3};

use super::body::wrench_of;
use super::complementarity::{Complementarity, Contact};
use super::dampers::Dampers;
use super::friction::tangents;
use super::model::Compliant;
use super::pairs::{Pair, Pairs};
use super::scene::Scene;
use super::sliding::Slide;
use crate::error::SolveError;

/// Scratch memory of the steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub compliance: Vec<f64>,
    /// How the cross-sections move by themselves.
    pub drift: Vec<f64>,
    /// `∂W/∂X` of each pair.
    geometric: Vec<[[f64; 6]; 6]>,
    lines: Vec<Line>,
    matrix: Vec<f64>,
    lu: DenseLu,
    /// `(I − CG)⁻¹CB` by columns, one to each line, the last for what the pushes have turned since.
    moves: Vec<Vec<f64>>,
    complementarity: Complementarity,
    /// What the step changes of each push.
    changes: Vec<[f64; 6]>,
}

/// A direction in which a pair pushes: the normal or, where there is friction, a tangent.
#[derive(Clone, Copy, Debug)]
struct Line {
    pair: usize,
    /// The force of 1 N.
    force: Vec3,
    /// `w`, the same with its moment.
    unit: [f64; 6],
    /// How the gap, or the slip, changes with the cross-section's motion.
    rate: [f64; 6],
    /// The gap, or the slip, in m.
    gap: f64,
    /// The force that was, in N.
    before: f64,
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
    /// Changes the forces of the pairs and dampers, what the model is to be given, and the model, eqs. (3) to (5); no
    /// cross-section is to move farther than `cap`.
    pub fn step(
        &mut self,
        (pairs, dampers): (&mut Pairs, &mut Dampers),
        model: &mut impl Compliant,
        scene: &Scene,
        (length, cap): (f64, f64),
    ) -> Result<Stepped, NoStep> {
        let count = pairs.near.len();
        let n = 6 * (count + dampers.all.len());
        self.lines.clear();
        for k in 0..count {
            add_lines(&mut self.lines, k, &pairs.near[k], model, scene);
        }
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
            for (k, damper) in (count..).zip(&dampers.all) {
                for b in 0..6 {
                    let at = i * n + 6 * k + b;
                    self.matrix[at] = self.compliance[at] * damper.stiffness(b);
                }
            }
            self.matrix[i * n + i] += 1.0;
        }
        self.lu.factor(n, &self.matrix).map_err(|_| NoStep::Contacts)?;
        let mut turned: Vec<[f64; 6]> = pairs.near.iter().map(turned).collect();
        for (turned, pair) in turned.iter_mut().zip(&pairs.near) {
            if let Some(slide) = &pair.slide {
                let by = pair.force * slide.left();
                turned.iter_mut().zip(slide.along).for_each(|(sum, along)| *sum += by * along);
            }
        }
        turned.extend(dampers.all.iter().map(|damper| {
            let push = damper.push(&model.pose(damper.arc_length));
            core::array::from_fn(|a| push[a] - damper.given[a])
        }));
        let total = self.lines.len();
        self.moves.resize_with(total + 1, Vec::new);
        for (k, column) in self.moves.iter_mut().enumerate() {
            column.clear();
            column.extend((0..n).map(|i| {
                let row = &self.compliance[i * n..(i + 1) * n];
                match self.lines.get(k) {
                    Some(Line { pair, unit, .. }) => dot(&row[6 * pair..6 * pair + 6], unit),
                    None => {
                        let turned = turned.iter().enumerate();
                        let by = turned.map(|(j, turned)| dot(&row[6 * j..6 * j + 6], turned));
                        self.drift[i] + by.sum::<f64>()
                    }
                }
            }));
        }
        self.lu.solve_columns(&mut self.moves);
        let problem = &mut self.complementarity;
        problem.reset(total);
        let approach = |line: &Line, column: &[f64]| {
            dot(&column[6 * line.pair..6 * line.pair + 6], &line.rate)
        };
        for (i, line) in self.lines.iter().enumerate() {
            problem.gaps[i] = line.gap + approach(line, &self.moves[total]);
            problem.forces[i] = line.before;
            for j in 0..total {
                problem.matrix[i * total + j] = approach(line, &self.moves[j]);
            }
        }
        let mut first = 0;
        for pair in &pairs.near {
            let contact = Contact {
                first,
                coefficient: pair.grip.map_or(0.0, |grip| grip.coefficient),
                touches: pair.force > 0.0 || pair.nearest.gap < 0.0,
                sticks: false,
            };
            first += contact.lines();
            problem.contacts.push(contact);
        }
        let held = problem.solve().map_err(|_| NoStep::Contacts)?;
        let odd = self.lu.is_determinant_negative() != held.negative;
        let mut motion = self.moves[total].clone();
        for (j, line) in self.lines.iter().enumerate() {
            let change = problem.forces[j] - line.before;
            motion.iter_mut().zip(&self.moves[j]).for_each(|(x, y)| *x += change * y);
        }
        let farthest = motion.chunks(6).map(|x| x[0].hypot(x[1]).hypot(x[2])).fold(0.0, f64::max);
        if !farthest.is_finite() {
            return Err(NoStep::Contacts);
        }
        let part = if farthest > cap { cap / farthest } else { 1.0 };
        self.changes.clear();
        let next = |pair: &Pair, part: f64, contact: &Contact, forces: &[f64]| {
            pair.force + part * (forces[contact.first] - pair.force)
        };
        for (j, pair) in pairs.near.iter().enumerate() {
            let contact = &problem.contacts[j];
            if next(pair, part, contact, &problem.forces) <= 0.0 {
                self.changes.push(pair.given.map(|component| -component));
                continue;
            }
            let moved = &motion[6 * j..6 * j + 6];
            let mut wrench: [f64; 6] =
                core::array::from_fn(|a| turned[j][a] + dot(&self.geometric[j][a], moved));
            let range = contact.first..contact.first + contact.lines();
            for (line, &force) in self.lines[range.clone()].iter().zip(&problem.forces[range]) {
                for (component, unit) in wrench.iter_mut().zip(line.unit) {
                    *component += (force - line.before) * unit;
                }
            }
            self.changes.push(wrench);
        }
        for (j, damper) in (count..).zip(&dampers.all) {
            let moved = &motion[6 * j..6 * j + 6];
            self.changes
                .push(core::array::from_fn(|a| turned[j][a] - damper.stiffness(a) * moved[a]));
        }
        let part = model.advance(&self.changes, part).map_err(NoStep::Model)?;
        let mut moved = Vec::new();
        for (j, pair) in pairs.near.iter_mut().enumerate() {
            let contact = &problem.contacts[j];
            let range = contact.first..contact.first + contact.lines();
            let lines = self.lines[range.clone()].iter().zip(&problem.forces[range]);
            let along = lines.fold(Vec3::ZERO, |sum, (line, &force)| sum + line.force * force);
            let tangential = along - pair.nearest.normal * problem.forces[contact.first];
            for (given, change) in pair.given.iter_mut().zip(self.changes[j]) {
                *given += part * change;
            }
            if let Some(slide) = &pair.slide {
                let way = part * slide.way(&motion[6 * j..6 * j + 6]);
                let s = Slide::moved(pair.member.arc_length, way, length);
                moved.push((j, s));
                // The force on a ball has no moment about the centre of its cross-section, wherever that is.
                pair.given[3..].fill(0.0);
            }
            pair.force = next(pair, part, contact, &problem.forces).max(0.0);
            if pair.force == 0.0 {
                pair.given = [0.0; 6];
            }
            pair.hold(contact.sticks, tangential, part);
        }
        for (j, s) in moved {
            pairs.move_to(j, s);
        }
        for (damper, change) in dampers.all.iter_mut().zip(&self.changes[count..]) {
            for (given, change) in damper.given.iter_mut().zip(change) {
                *given += part * change;
            }
        }
        Ok(Stepped { odd })
    }
}

/// The lines of a pair.
fn add_lines(
    lines: &mut Vec<Line>,
    number: usize,
    pair: &Pair,
    model: &impl Compliant,
    scene: &Scene,
) {
    let Pair { nearest, member, force, .. } = pair;
    let unit = nearest.push();
    let gap = nearest.gap - pair.slide.map_or(0.0, |slide| slide.depth());
    let before = *force;
    lines.push(Line { pair: number, force: nearest.normal, unit, rate: unit, gap, before });
    let Some(grip) = &pair.grip else { return };
    let rounding = member.body.rounding;
    let slip = |pose: &Pose| {
        let nearest = pair.look(scene.get(pair.obstacle), pose);
        [grip.slip_at(pose, &nearest, rounding)]
    };
    let rates = differences(6, &model.pose(member.arc_length), member.body.reach(), slip);
    for axis in tangents(nearest.normal) {
        lines.push(Line {
            pair: number,
            force: axis,
            unit: wrench_of(axis, nearest.lever(rounding)),
            rate: rates.map(|[rate]| rate.dot(axis)),
            gap: grip.slip.dot(axis),
            before: grip.traction.dot(axis),
        });
    }
}

/// What a pair pushes where the robot is, without the wrench that the model has been given.
pub(super) fn turned(pair: &Pair) -> [f64; 6] {
    let push = pair.push();
    core::array::from_fn(|a| push[a] - pair.given[a])
}

/// `G = ∂W/∂X` of what a pair pushes while its forces along normal and surface stay as they are.
fn geometric(pair: &Pair, model: &impl Compliant, scene: &Scene) -> [[f64; 6]; 6] {
    let mut matrix = [[0.0; 6]; 6];
    if pair.force == 0.0 {
        return matrix;
    }
    let body = &pair.member.body;
    let traction = pair.grip.map_or(Vec3::ZERO, |grip| grip.traction);
    let push = |pose: &Pose| {
        let nearest = pair.look(scene.get(pair.obstacle), pose);
        let normal = nearest.push();
        let drag = wrench_of(traction, nearest.lever(body.rounding));
        let [x, y, z, u, v, w] = core::array::from_fn(|a| pair.force * normal[a] + drag[a]);
        [Vec3::new(x, y, z), Vec3::new(u, v, w)]
    };
    let pose = model.pose(pair.member.arc_length);
    // A ball looks the same from all sides.
    let motions = if body.is_ball() { 3 } else { 6 };
    let rates = differences(motions, &pose, body.reach(), push);
    for (b, [force, moment]) in rates.into_iter().enumerate() {
        let column = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        for (row, value) in matrix.iter_mut().zip(column) {
            row[b] = value;
        }
    }
    if let Some(slide) = &pair.slide {
        for (row, by) in matrix.iter_mut().zip(slide.stiffness(pair.force)) {
            row.iter_mut().zip(by).for_each(|(sum, by)| *sum += by);
        }
    }
    matrix
}

/// Central differences by the first so many motions of a cross-section, of something that is smooth and quick and does
/// not change with the others.
pub(super) fn differences<const N: usize>(
    motions: usize,
    pose: &Pose,
    reach: f64,
    value: impl Fn(&Pose) -> [Vec3; N],
) -> [[Vec3; N]; 6] {
    let size = reach.max(1e-9);
    core::array::from_fn(|b| {
        if b >= motions {
            return [Vec3::ZERO; N];
        }
        let mut axis = [0.0; 3];
        axis[b % 3] = 1.0;
        let h = if b < 3 { STEP * size } else { STEP };
        let at = |h: f64| {
            let change = Vec3::from(axis) * h;
            value(&if b < 3 {
                Pose { position: pose.position + change, ..*pose }
            } else {
                Pose { rotation: UnitQuaternion::exp(change) * pose.rotation, ..*pose }
            })
        };
        let (after, before) = (at(h), at(-h));
        core::array::from_fn(|k| (after[k] - before[k]) / (2.0 * h))
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Of the differences, relative to the part that touches, and in rad.
const STEP: f64 = 1e-5;
