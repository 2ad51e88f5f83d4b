//! One step of Newton's method on the conditions of contact.

use core::ops::Range;

use whipcord_numerics::{DenseLu, Pose, Vec3, dot};

use super::body::{Nearest, along, tangents};
use super::complementarity::{Complementarity, Contact};
use super::dampers::Dampers;
use super::friction::Grip;
use super::loaded_places::LoadedPlaces;
use super::model::{Compliant, Push};
use super::object::Objects;
use super::object_pair::{NEAR, ObjectPair};
use super::pair::Pair;
use super::pairs::Pairs;
use super::scene::Scene;
use super::sliding::Slide;
use super::stability::{ConstrainedStability, PushingContact};
use super::two_bodies::{Block, Bodies, Differences, End, Line, TwoBodies};
use crate::error::SolveError;
use crate::shape::Wrench;

/// Scratch memory of the steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// The cross-sections of pairs and dampers.
    loaded: LoadedPlaces<f64>,
    compliance: Vec<f64>,
    /// How the cross-sections move by themselves.
    drift: Vec<f64>,
    /// How many pairs the last step had, where it had nothing else.
    of_pairs: Option<usize>,
    /// Compliance of the cross-sections and of the objects.
    all: Vec<f64>,
    /// `G = ∂W/∂X` of all pairs.
    geometric: Vec<Block>,
    /// Where in these those of each pair of the robot are.
    of_pair: Vec<Range<usize>>,
    lines: Vec<Line>,
    matrix: Vec<f64>,
    lu: DenseLu,
    /// `(I − CG)⁻¹CB` by columns, one to each line, the last for what the pushes have turned since.
    moves: Vec<Vec<f64>>,
    complementarity: Complementarity,
    /// What the step changes of each push.
    changes: Vec<[f64; 6]>,
    stability: ConstrainedStability,
}

/// What came of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stepped {
    /// Whether the contacts change an odd number of directions from stable to unstable or back: the sign of
    /// `det(I − CG) det M` in eq. (6).
    pub odd: bool,
    /// The part of the step that was taken.
    pub part: f64,
}

/// Where a step begins and how far it may lead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Of the scene, in m.
    pub length: f64,
    /// No cross-section or object is to move farther, in m.
    pub cap: f64,
    /// What the robot is about to be moved by as it is, in m: the step meets the conditions of contact there.
    pub ahead: Vec3,
}

/// No step leads on.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoStep {
    /// The contacts have no equilibrium near.
    Contacts,
    Model(SolveError),
}

impl Scratch {
    /// Asks the model how the cross-sections that are pushed move, each once however many contacts it has.
    pub fn ask(&mut self, pushes: &[Push], model: &mut impl Compliant) -> Result<(), SolveError> {
        let places: Vec<f64> = pushes.iter().map(|push| push.arc_length).collect();
        self.loaded.set(&places);
        let once = |&arc_length: &f64| Push { arc_length, wrench: Wrench::default() };
        let once: Vec<Push> = self.loaded.places().iter().map(once).collect();
        model.compliance(&once, &mut self.compliance, &mut self.drift)
    }

    /// Changes the forces of the pairs, what the model is to be given, the model, and the poses of the objects, eqs. (3) to (5), after the
    /// model has been asked.
    pub fn step(
        &mut self,
        (pairs, dampers, objects): (&mut Pairs, &mut Dampers, &mut Objects),
        model: &mut impl Compliant,
        scene: &mut Scene,
        Reach { length, cap, ahead }: Reach,
    ) -> Result<Stepped, NoStep> {
        let count = pairs.near.len();
        self.of_pairs = (dampers.all.is_empty() && objects.count() == 0).then_some(count);
        // The cross-sections of pairs and dampers, then the objects.
        let sections = self.loaded.places().len();
        let section: Vec<usize> = self.loaded.of_pushes().to_vec();
        let n = 6 * (sections + objects.count());
        let quick = Differences::OneSided;
        self.lines.clear();
        self.geometric.clear();
        self.of_pair.clear();
        for (pair, &k) in pairs.near.iter().zip(&section) {
            let first = self.geometric.len();
            let contact = of_robot(k, pair, (&*model, &*scene, &*objects), sections);
            let carried = |grip: Grip| Grip { from: scene.carry(pair.obstacle, grip.from), ..grip };
            let normal_line = self.lines.len();
            let grip = pair.grip.map(carried);
            let normal = |nearest: &Nearest| nearest.normal * pair.force;
            let force = |nearest: &Nearest, _: &Pose| normal(nearest) + pair.traction();
            // A ball looks the same from all sides, and what neither pushes nor rubs does nothing.
            let motions = match (grip, pair.force > 0.0) {
                (Some(_), _) => 6,
                (None, true) if pair.member.body.is_ball() => 3,
                (None, true) => 6,
                (None, false) => 0,
            };
            let rates = contact.rates(force, grip.as_ref(), motions, quick);
            let grip = grip.as_ref().map(|grip| (grip, tangents(pair.nearest.normal)));
            contact.lines(pair.force, grip, &rates, &mut self.lines);
            self.lines[normal_line].gap -= pair.slide.map_or(0.0, |slide| slide.depth());
            self.lines[normal_line].gap += pair.nearest.normal.dot(ahead);
            if pair.force > 0.0 {
                let total = force(&pair.nearest, &contact.pose);
                let turning = normal(&pair.nearest);
                contact.geometric((total, turning), &rates, &mut self.geometric);
                if let Some(slide) = &pair.slide {
                    let matrix = slide.stiffness(pair.force);
                    self.geometric.push(Block { row: k, column: k, matrix });
                }
            }
            self.of_pair.push(first..self.geometric.len());
        }
        for (&k, damper) in section[count..].iter().zip(&dampers.all) {
            let mut matrix = [[0.0; 6]; 6];
            for b in 0..6 {
                matrix[b][b] = -damper.stiffness(b);
            }
            self.geometric.push(Block { row: k, column: k, matrix });
        }
        let touching = if objects.count() > 0 { objects.near.as_slice() } else { &[] };
        for pair in touching {
            let contact = of_objects(pair, (&*scene, &*objects), sections);
            let carried = |grip: Grip| Grip { from: scene.carry(pair.other, grip.from), ..grip };
            let grip = pair.grip.map(carried);
            let traction = pair.grip.map_or(Vec3::ZERO, |grip| grip.traction);
            let normal = |nearest: &Nearest| nearest.normal * pair.force;
            let force = |nearest: &Nearest, _: &Pose| normal(nearest) + traction;
            let motions = if grip.is_some() || pair.force > 0.0 { 6 } else { 0 };
            let rates = contact.rates(force, grip.as_ref(), motions, quick);
            let grip = grip.as_ref().map(|grip| (grip, tangents(pair.nearest.normal)));
            contact.lines(pair.force, grip, &rates, &mut self.lines);
            if pair.force > 0.0 {
                let total = force(&pair.nearest, &contact.pose);
                contact.geometric((total, normal(&pair.nearest)), &rates, &mut self.geometric);
            }
        }
        self.add_objects(sections, objects);
        // I − CG
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for i in 0..n {
            for Block { row, column, matrix } in &self.geometric {
                for b in 0..6 {
                    let from = &self.all[i * n + 6 * row..i * n + 6 * row + 6];
                    let sum: f64 = from.iter().zip(matrix).map(|(c, g)| c * g[b]).sum();
                    self.matrix[i * n + 6 * column + b] -= sum;
                }
            }
            self.matrix[i * n + i] += 1.0;
        }
        self.lu.factor(n, &self.matrix).map_err(|_| NoStep::Contacts)?;
        let mut turned: Vec<[f64; 6]> = pairs.near.iter().map(turned).collect();
        turned.extend(dampers.all.iter().map(|damper| {
            let push = damper.push(&model.pose(damper.arc_length));
            core::array::from_fn(|a| push[a] - damper.given[a])
        }));
        let total = self.lines.len();
        self.moves.resize_with(total + 1, Vec::new);
        for (k, column) in self.moves.iter_mut().enumerate() {
            column.clear();
            column.extend((0..n).map(|i| {
                let row = &self.all[i * n..(i + 1) * n];
                let by = |end: &End| dot(&row[6 * end.body..6 * end.body + 6], &end.unit);
                match self.lines.get(k) {
                    Some(line) => line.ends().map(by).sum(),
                    None => {
                        let turned = section.iter().zip(&turned);
                        let by = turned.map(|(&j, turned)| dot(&row[6 * j..6 * j + 6], turned));
                        self.drift[i] + by.sum::<f64>()
                    }
                }
            }));
        }
        self.lu.solve_columns(&mut self.moves);
        let problem = &mut self.complementarity;
        problem.reset(total);
        problem.are_dependent = objects.count() > 0;
        for (i, line) in self.lines.iter().enumerate() {
            problem.gaps[i] = line.gap + line.approach(&self.moves[total]);
            problem.forces[i] = line.before;
            for j in 0..total {
                problem.matrix[i * total + j] = line.approach(&self.moves[j]);
            }
        }
        let mut first = 0;
        let of_robot = pairs.near.iter().map(|pair| (pair.force, pair.nearest.gap, pair.grip));
        let of_objects = touching.iter().map(|pair| (pair.force, pair.nearest.gap, pair.grip));
        for (force, gap, grip) in of_robot.chain(of_objects) {
            let contact = Contact {
                first,
                coefficient: grip.map_or(0.0, |grip| grip.coefficient),
                touches: force > 0.0 || gap < 0.0,
                sticks: grip.is_some_and(|grip| grip.sticks),
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
        let moved = &motion[6 * sections..];
        let part = part.min(objects.part_of_step(moved, (&*model, pairs), scene, NEAR * length));
        self.changes.clear();
        let next = |pair: &Pair, part: f64, contact: &Contact, forces: &[f64]| {
            pair.force + part * (forces[contact.first] - pair.force)
        };
        let turned_by = |turned: [f64; 6], row: usize, blocks: &[Block]| {
            let mut wrench = turned;
            for Block { column, matrix, .. } in blocks.iter().filter(|b| b.row == row) {
                let moved = &motion[6 * column..6 * column + 6];
                wrench.iter_mut().zip(matrix).for_each(|(sum, row)| *sum += dot(row, moved));
            }
            wrench
        };
        for (j, pair) in pairs.near.iter().enumerate() {
            let contact = &problem.contacts[j];
            if next(pair, part, contact, &problem.forces) <= 0.0 {
                self.changes.push(pair.given.map(|component| -component));
                continue;
            }
            let blocks = &self.geometric[self.of_pair[j].clone()];
            let mut wrench = turned_by(turned[j], section[j], blocks);
            let range = contact.first..contact.first + contact.lines();
            for (line, &force) in self.lines[range.clone()].iter().zip(&problem.forces[range]) {
                let Some(end) = line.ends[0] else { continue };
                for (component, unit) in wrench.iter_mut().zip(end.unit) {
                    *component += (force - line.before) * unit;
                }
            }
            self.changes.push(wrench);
        }
        for (k, damper) in dampers.all.iter().enumerate() {
            let at = section[count + k];
            let moved = &motion[6 * at..6 * at + 6];
            let left = turned[count + k];
            self.changes.push(core::array::from_fn(|b| left[b] - damper.stiffness(b) * moved[b]));
        }
        let totals = self.loaded.totals(&self.changes);
        let totals: Vec<[f64; 6]> =
            totals.chunks_exact(6).map(|of| core::array::from_fn(|a| of[a])).collect();
        let part = model.advance(&totals, part).map_err(NoStep::Model)?;
        let mut slid = Vec::new();
        for (j, pair) in pairs.near.iter_mut().enumerate() {
            let contact = &problem.contacts[j];
            let range = contact.first..contact.first + contact.lines();
            let lines = self.lines[range.clone()].iter().zip(&problem.forces[range]);
            let total = lines.fold(Vec3::ZERO, |sum, (line, &force)| sum + line.force * force);
            let tangential = total - pair.nearest.normal * problem.forces[contact.first];
            for (given, change) in pair.given.iter_mut().zip(self.changes[j]) {
                *given += part * change;
            }
            let moved = &motion[6 * section[j]..6 * section[j] + 6];
            let way = pair.slide.map_or(0.0, |slide| part * slide.way(moved));
            if pair.slide.is_some() {
                pair.moved = way.abs();
            }
            if !Slide::is_negligible(way, length) {
                slid.push((j, pair.member.arc_length + way));
                // That of the force on a ball about the centre of its cross-section, wherever that is.
                let [x, y, z, ..] = pair.given;
                let force = Vec3::new(x, y, z);
                let traction = pair.grip.map_or(Vec3::ZERO, |_| along(force, pair.nearest.normal));
                let moment = pair.nearest.lever(pair.member.body.rounding).cross(traction);
                pair.given[3..].copy_from_slice(&<[f64; 3]>::from(moment));
            }
            pair.force = next(pair, part, contact, &problem.forces).max(0.0);
            if pair.force == 0.0 {
                pair.given = [0.0; 6];
            }
            pair.hold(contact.sticks, tangential, part);
        }
        for (j, s) in slid {
            pairs.move_to(j, s, model, scene);
        }
        for (damper, change) in dampers.all.iter_mut().zip(&self.changes[count..]) {
            for (given, change) in damper.given.iter_mut().zip(change) {
                *given += part * change;
            }
        }
        if objects.count() > 0 {
            for (pair, contact) in objects.near.iter_mut().zip(&problem.contacts[count..]) {
                let range = contact.first + 1..contact.first + contact.lines();
                let along = self.lines[range.clone()].iter().zip(&problem.forces[range]);
                let tangential = along.fold(Vec3::ZERO, |sum, (line, f)| sum + line.force * *f);
                pair.hold(problem.forces[contact.first], contact.sticks, tangential, part);
            }
            objects.advance(&motion[6 * sections..], part, scene);
        }
        Ok(Stepped { odd, part })
    }

    /// Whether the last step was one of so many pairs, and of nothing else.
    pub fn is_of(&self, pairs: &Pairs) -> bool {
        self.of_pairs == Some(pairs.near.len())
    }

    /// The number of unstable directions that contacts without friction admit where the last step began, eq. (20), from that of the
    /// robot `alone`; `None` where it is not defined.
    pub fn unstable_directions(
        &mut self,
        alone: usize,
        pairs: &Pairs,
        length: f64,
    ) -> Option<usize> {
        if !self.is_of(pairs) {
            return None;
        }
        let places = self.loaded.places().len();
        let all = pairs.near.iter().zip(self.loaded.of_pushes()).zip(&self.of_pair);
        let pushing = all.filter(|((pair, _), _)| pair.force > 0.0);
        let holding = pushing.map(|((pair, &place), blocks)| {
            let [.., x, y, z] = pair.given;
            let mut geometric = [[0.0; 6]; 6];
            for block in &self.geometric[blocks.clone()] {
                for (sum, row) in geometric.iter_mut().zip(block.matrix) {
                    sum.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
                }
            }
            PushingContact {
                place,
                moment: Vec3::new(x, y, z),
                geometric,
                normal: pair.nearest.push(),
            }
        });
        let contacts: Vec<PushingContact> = holding.collect();
        self.stability.unstable_directions(alone, (places, &self.all), &contacts, length)
    }

    /// Compliance and drift of cross-sections and objects together: a step gives each object a small stiffness, so that the
    /// contacts alone hold it at the end.
    fn add_objects(&mut self, sections: usize, objects: &Objects) {
        if objects.count() == 0 {
            core::mem::swap(&mut self.all, &mut self.compliance);
            return;
        }
        let (robot, n) = (6 * sections, 6 * (sections + objects.count()));
        self.all.clear();
        self.all.resize(n * n, 0.0);
        for i in 0..robot {
            self.all[i * n..i * n + robot]
                .copy_from_slice(&self.compliance[i * robot..(i + 1) * robot]);
        }
        for (k, object) in objects.list.iter().enumerate() {
            let Wrench { force, moment } = object.imbalance;
            let imbalance = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
            for (a, compliance) in objects.compliance(k).into_iter().enumerate() {
                let i = robot + 6 * k + a;
                self.all[i * n + i] = compliance;
                self.drift.push(compliance * imbalance[a]);
            }
        }
    }
}

/// A pair of the robot with an obstacle, as the contact between two bodies that it is.
fn of_robot<'a>(
    section: usize,
    pair: &'a Pair,
    (model, scene, objects): (&impl Compliant, &'a Scene, &Objects),
    count: usize,
) -> TwoBodies<'a, impl Fn(&Pose) -> Nearest> {
    let second = objects.of(pair.obstacle).map(|k| (count + k, objects.list[k].pose.position));
    let Pair { member, nearest, .. } = pair;
    TwoBodies {
        bodies: Bodies { first: Some(section), second },
        pose: model.pose(member.arc_length),
        reach: member.body.reach(),
        rounding: member.body.rounding,
        nearest,
        look: |pose: &Pose| pair.look(scene.get(pair.obstacle), pose),
    }
}

/// A pair of two obstacles likewise.
pub(super) fn of_objects<'a>(
    pair: &'a ObjectPair,
    (scene, objects): (&'a Scene, &'a Objects),
    count: usize,
) -> TwoBodies<'a, impl Fn(&Pose) -> Nearest> {
    let ObjectPair { owner, other, part, nearest, rounding, .. } = pair;
    let pose = objects.pose_of(*owner, scene);
    let second = objects.of(*other).map(|k| (count + k, objects.list[k].pose.position));
    TwoBodies {
        bodies: Bodies { first: objects.of(*owner).map(|k| count + k), second },
        pose,
        reach: nearest.arm.norm() + rounding,
        rounding: *rounding,
        nearest,
        look: |pose: &Pose| {
            objects.features[*owner].track(*part, scene.get(*other), pose, nearest.local)
        },
    }
}

/// What a pair pushes where the robot is, and where it moves to along the backbone, without the wrench that the model has been
/// given.
pub(super) fn turned(pair: &Pair) -> [f64; 6] {
    let push = pair.push();
    let by = pair.slide.map(|slide| (pair.force * slide.left(), slide.along));
    core::array::from_fn(|a| {
        push[a] - pair.given[a] + by.map_or(0.0, |(moved, along)| moved * along[a])
    })
}
