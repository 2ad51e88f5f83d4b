//! Answers that touch obstacles: what would move the places that touch changes what pushes there.
//!
//! At constant tensions a motion `X₀` of those places that something causes without the contacts comes with pushes `δW = K X₀`
//! ([`crate::contact`], eq. (10) of its page), and these with columns like those of any other wrench. So every column of the
//! robot among obstacles is that of the robot alone and `K X₀` times those of the pushes, and a functional of it is one of the
//! former, with what its worth of the pushes is worth to `X₀`.

use whipcord_numerics::{Twist, Vec3, dot};

use super::column::Raw;
use super::node_change::NodeChange;
use super::replay::AXES;
use super::sliding_holes::{AnswerHoles, Cause};
use crate::case::Case;
use crate::parameter::Parameter;
use crate::shape::Wrench;

/// How the pushes of the contacts of an answer change, by rows, a force and a moment for each. Among movable objects on a way whose equilibria are all
/// differentiated the motions of all objects follow, and what each was held with when it was released.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ContactGain {
    /// `K`: with the motions of the places without the contacts.
    pub by_motion: Vec<f64>,
    /// With those of the places that rub at the equilibrium before, and with what that had of the objects: so many numbers.
    pub by_before: Vec<f64>,
    pub before: usize,
    /// With gravity in the frame of the base, which pulls at movable objects; empty where there are none.
    pub by_gravity: Vec<f64>,
}

impl ContactGain {
    /// Of columns, all of as many rows; `None` where they are not finite.
    pub fn of_columns(
        by_motion: &[Vec<f64>],
        by_before: &[Vec<f64>],
        by_gravity: &[Vec<f64>],
    ) -> Option<Self> {
        let by_rows = |columns: &[Vec<f64>]| -> Vec<f64> {
            let rows = columns.first().map_or(0, Vec::len);
            (0..rows).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
        };
        let all = [by_motion, by_before, by_gravity];
        let is_finite = all.into_iter().flatten().flatten().all(|x| x.is_finite());
        let [by_motion, by_rows_before, by_gravity] = all.map(by_rows);
        let gain =
            Self { by_motion, by_before: by_rows_before, before: by_before.len(), by_gravity };
        is_finite.then_some(gain)
    }

    /// What is pushed more where the places that rub, and objects, moved so at the equilibrium before; what is missing there did not.
    pub fn remembered(&self, before: &[f64]) -> Vec<f64> {
        self.by_before.chunks_exact(self.before.max(1)).map(|row| dot(row, before)).collect()
    }
}

/// How gravity changes with a parameter of a case, in the frame of the base.
pub(crate) fn gravity_change(parameter: &Parameter, case: &Case) -> Vec3 {
    match parameter {
        Parameter::Gravity { axis } => case.loads.to_base(case.base.rotation).rotate(AXES[*axis]),
        _ => Vec3::ZERO,
    }
}

/// What the contacts of an answer push more with each cause though the robot does not move: for what the equilibrium before remembers, and
/// for the weight of objects.
#[derive(Clone, Debug, Default)]
pub(super) struct Remembered {
    /// By each parameter, then by the command of each cable in all steps, then by that in the last; those that are empty are nothing.
    columns: Vec<Vec<f64>>,
    parameters: usize,
    cables: usize,
}

impl Remembered {
    /// Of what the holes of an answer carry.
    pub fn new(gain: &ContactGain, holes: Option<&AnswerHoles<'_>>) -> Self {
        let Some(AnswerHoles { holes, carried: Some(carried), parameters, .. }) = holes else {
            return Self::default();
        };
        if gain.by_before.is_empty() {
            return Self::default();
        }
        Self {
            columns: carried.iter().map(|of| gain.remembered(&of.places)).collect(),
            parameters: parameters.len(),
            cables: holes.of_cable.len(),
        }
    }

    /// The same where gravity changes so with each parameter, in the frame of the base.
    pub fn weighing(mut self, gain: &ContactGain, gravity: &[Vec3]) -> Self {
        if gain.by_gravity.is_empty() {
            return self;
        }
        if self.columns.is_empty() {
            self.parameters = gravity.len();
            self.columns.resize(gravity.len(), Vec::new());
        }
        for (column, gravity) in self.columns.iter_mut().zip(gravity) {
            if *gravity != Vec3::ZERO {
                let rows = gain.by_gravity.chunks_exact(3);
                column.resize(rows.len(), 0.0);
                let by = rows.map(|row| dot(row, &<[f64; 3]>::from(*gravity)));
                column.iter_mut().zip(by).for_each(|(sum, by)| *sum += by);
            }
        }
        self
    }

    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// With a cause; `None` where there is nothing.
    pub fn of(&self, cause: Cause) -> Option<&[f64]> {
        let column = match cause {
            Cause::Parameter(p) => p,
            Cause::Offset(cable) => self.parameters + cable,
            Cause::Command(cable) => self.parameters + self.cables + cable,
            Cause::Nothing | Cause::Tension(_) => return None,
        };
        self.columns.get(column).filter(|column| !column.is_empty()).map(Vec::as_slice)
    }

    /// What it is worth with a cause, where the pushes are worth this.
    pub fn worth(&self, cause: Cause, pushes: &[f64]) -> f64 {
        self.of(cause).map_or(0.0, |column| dot(column, pushes))
    }
}

/// The contacts of an answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Touching {
    /// The node of each.
    pub nodes: Vec<usize>,
    /// Columns of a unit of each component of the push of each, of the robot alone.
    pub columns: Vec<Raw>,
    /// `K` by rows.
    pub gain: Vec<f64>,
    pub remembered: Remembered,
    pub is_about_to_change: bool,
}

impl Touching {
    /// Adds what the contacts push to a column of the robot alone.
    pub fn respond(&self, raw: &mut Raw) {
        let moved: Vec<f64> = self.nodes.iter().flat_map(|&node| motion(raw, node)).collect();
        let n = moved.len();
        let by = |row: &[f64]| row.iter().zip(&moved).map(|(k, x)| k * x).sum();
        raw.pushes = self.gain.chunks_exact(n.max(1)).map(by).collect();
        for i in 0..n {
            let push = raw.pushes[i];
            raw.add(push, &self.columns[i]);
        }
    }

    /// Adds to a column what the contacts push more for what is remembered of a cause.
    pub fn remember(&self, raw: &mut Raw, cause: Cause) {
        let Some(pushes) = self.remembered.of(cause) else { return };
        raw.pushes.resize(pushes.len().max(raw.pushes.len()), 0.0);
        raw.pushes.iter_mut().zip(pushes).for_each(|(sum, push)| *sum += push);
        for (push, column) in pushes.iter().zip(&self.columns) {
            raw.add(*push, column);
        }
    }

    /// How the objects move in a column, and what they were held with changes by.
    pub fn of_objects<'a>(&self, raw: &'a Raw) -> &'a [f64] {
        raw.pushes.get(self.columns.len()..).unwrap_or(&[])
    }

    /// Adds to a functional of columns of the robot among obstacles what makes it one of columns of the robot alone.
    /// What a unit of each component of the pushes is worth.
    pub fn pull_back(&self, nodes: &mut [NodeChange], lengths: &[f64], base: &Wrench) -> Vec<f64> {
        let worth: Vec<f64> =
            self.columns.iter().map(|column| column.worth(nodes, lengths, base)).collect();
        let n = worth.len();
        for (k, &node) in self.nodes.iter().enumerate() {
            let by =
                |c: usize| (0..n).map(|i| self.gain[i * n + 6 * k + c] * worth[i]).sum::<f64>();
            for axis in 0..3 {
                nodes[node].position[axis] += by(axis);
                nodes[node].turn[axis] += by(3 + axis);
            }
        }
        worth
    }

    /// What is pushed more at a node.
    pub fn push(&self, pushes: &[f64], node: usize) -> Wrench {
        let mut wrench = Wrench::default();
        for (_, push) in
            self.nodes.iter().zip(pushes.chunks_exact(6)).filter(|(at, _)| **at == node)
        {
            for axis in 0..3 {
                wrench.force[axis] += push[axis];
                wrench.moment[axis] += push[3 + axis];
            }
        }
        wrench
    }
}

/// The numbers of a motion, that of its point first.
pub(super) fn components(Twist { linear, angular }: Twist) -> [f64; 6] {
    [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
}

/// How a node moves, its point first.
pub(super) fn motion(raw: &Raw, node: usize) -> [f64; 6] {
    let NodeChange { position: p, turn: t, .. } = raw.nodes[node];
    [p.x, p.y, p.z, t.x, t.y, t.z]
}
