//! What holds a stage by inequalities: cables that are driven by their lengths and contacts, together, eqs. (13) and (19) of the page on motion.

use whipcord::contact::complementarity::Complementarity as WithFriction;
use whipcord_numerics::Twist;

use crate::block::dot;
use crate::complementarity::Complementarity;
use crate::contacts::Contacts;
use crate::lengths::Lengths;
use crate::rod::Rod;
use crate::stage::{Scheme, Stage};

/// The linear system of tensions and contact forces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Unilateral {
    /// What a force of 1 N in each line exerts on the nodes, then the velocities that it takes away.
    columns: Vec<Vec<Twist>>,
    /// What a change of the velocities takes from the gap of each line.
    rows: Vec<Vec<Twist>>,
    matrix: Vec<f64>,
    offset: Vec<f64>,
    /// Forces before and after.
    before: Vec<f64>,
    forces: Vec<f64>,
    problem: Complementarity,
    with_friction: WithFriction,
}

/// Gaps that count as zero, as a part of the length of the backbone.
const LEAST_GAP: f64 = 1e-15;
/// What a contact yields of itself, as a part of what the robot does: several contacts of one element may depend on one another.
const SHARING: f64 = 1e-9;

impl Unilateral {
    /// Room for all cables of a rod.
    pub fn new(rod: &Rod) -> Self {
        let count = rod.cables.len();
        let list = || vec![vec![Twist::default(); rod.nodes.len()]; count];
        let numbers = || Vec::with_capacity(count);
        Self {
            columns: list(),
            rows: list(),
            matrix: Vec::with_capacity(count * count),
            offset: numbers(),
            before: numbers(),
            forces: numbers(),
            ..Self::default()
        }
    }

    /// Finds the tensions and contact forces at which velocities, lengths and gaps go together, in the linearisation of the stage, whose residual
    /// is already solved for. Writes them, and adds what their change does to the velocities. `None` where no forces were found.
    pub fn solve(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &mut Stage,
        lengths: &Lengths,
        contacts: &mut Contacts,
    ) -> Option<()> {
        let cables = lengths.cables.len();
        let n = cables + contacts.lines();
        while self.columns.len() < n {
            self.columns.push(vec![Twist::default(); rod.nodes.len()]);
            self.rows.push(vec![Twist::default(); rod.nodes.len()]);
        }
        self.offset.clear();
        self.before.clear();
        for i in 0..cables {
            let gap =
                lengths.linearise(rod, scheme, stage, i, &mut self.columns[i], &mut self.rows[i]);
            self.add_line(i, gap, stage.tensions[lengths.cables[i]], stage);
        }
        if !contacts.list.is_empty() {
            contacts.find_shifts(rod, scheme, stage);
        }
        let mut i = cables;
        for k in 0..contacts.list.len() {
            let forces = contacts.list[k].forces();
            for (line, force) in forces.into_iter().enumerate().take(contacts.list[k].lines()) {
                let gap =
                    contacts.linearise(scheme, k, line, &mut self.columns[i], &mut self.rows[i]);
                for entry in &mut self.rows[i] {
                    *entry = *entry * -1.0;
                }
                self.add_line(i, gap, force, stage);
                i += 1;
            }
        }
        self.fill_matrix(rod, lengths, n);
        self.find_forces(rod, lengths, contacts)?;
        for (i, &cable) in lengths.cables.iter().enumerate() {
            stage.tensions[cable] = self.forces[i];
        }
        let mut first = cables;
        for (k, contact) in contacts.list.iter_mut().enumerate() {
            let sticks = self.with_friction.contacts.get(cables + k).is_some_and(|c| c.sticks);
            let lines = contact.lines();
            contact.take(&self.forces[first..first + lines], sticks);
            first += lines;
        }
        for i in 0..n {
            let change = self.forces[i] - self.before[i];
            for (x, y) in stage.residual.iter_mut().zip(&self.columns[i]) {
                *x = *x - *y * change;
            }
        }
        Some(())
    }

    /// Completes a line whose column and row are filled: its gap where the forces stay what they are.
    fn add_line(&mut self, i: usize, gap: f64, force: f64, stage: &mut Stage) {
        let of_free: f64 = self.rows[i].iter().zip(&stage.residual).map(|(c, x)| dot(c, x)).sum();
        self.offset.push(gap - of_free);
        self.before.push(force);
        stage.matrix.solve(&mut self.columns[i]);
    }

    fn fill_matrix(&mut self, rod: &Rod, lengths: &Lengths, n: usize) {
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        let cables = lengths.cables.len();
        for i in 0..n {
            for j in 0..n {
                let through: f64 =
                    self.rows[i].iter().zip(&self.columns[j]).map(|(c, y)| dot(c, y)).sum();
                self.matrix[i * n + j] = through;
                self.offset[i] -= through * self.before[j];
            }
            let own = &mut self.matrix[i * n + i];
            *own += match lengths.cables.get(i) {
                Some(&cable) => rod.cables[cable].compliance,
                None => SHARING * *own,
            };
        }
        debug_assert!(cables <= n);
    }

    fn find_forces(&mut self, rod: &Rod, lengths: &Lengths, contacts: &Contacts) -> Option<()> {
        let n = self.offset.len();
        self.with_friction.contacts.clear();
        self.forces.clear();
        if contacts.list.iter().any(|contact| contact.lines() > 1) {
            let problem = &mut self.with_friction;
            problem.reset(n);
            problem.matrix.copy_from_slice(&self.matrix);
            problem.forces.copy_from_slice(&self.before);
            for i in 0..n {
                let row = &self.matrix[i * n..(i + 1) * n];
                let pushed: f64 = row.iter().zip(&self.before).map(|(m, f)| m * f).sum();
                problem.gaps[i] = self.offset[i] + pushed;
            }
            let mut first = lengths.cables.len();
            problem.contacts.extend(lengths.cables.iter().enumerate().map(|(i, _)| {
                let touches = self.before[i] > 0.0;
                whipcord::contact::complementarity::Contact {
                    first: i,
                    coefficient: 0.0,
                    touches,
                    sticks: false,
                }
            }));
            for contact in &contacts.list {
                problem.contacts.push(contact.problem(first));
                first += contact.lines();
            }
            problem.solve().ok()?;
            self.forces.extend_from_slice(&problem.forces);
            return Some(());
        }
        self.forces.resize(n, 0.0);
        self.problem.active.clear();
        self.problem.active.extend(self.before.iter().map(|&force| force > 0.0));
        let least = LEAST_GAP * rod.length;
        self.problem.solve(&self.matrix, &self.offset, least, &mut self.forces).ok()
    }
}
