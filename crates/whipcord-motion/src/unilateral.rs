//! What holds a stage by inequalities: cables that are driven by their lengths and contacts, together, eqs. (13), (25) and (26) of the page on motion.

use whipcord::contact::complementarity as contact_problem;
use whipcord_numerics::Twist;

use crate::block::dot;
use crate::complementarity::Complementarity;
use crate::contacts::Contacts;
use crate::lengths::Lengths;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

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
    with_friction: contact_problem::Complementarity,
    /// Which contacts are in the problem with friction, and its lines among all.
    taken: Vec<bool>,
    lines: Vec<usize>,
    /// Which contacts stick.
    sticking: Vec<bool>,
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
        lengths: &mut Lengths,
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
        self.fill_matrix(rod, scheme, stage, lengths, n);
        self.find_forces(rod, lengths, contacts)?;
        for (i, &cable) in lengths.cables.iter().enumerate() {
            stage.tensions[cable] = self.forces[i];
        }
        let mut first = cables;
        for (k, contact) in contacts.list.iter_mut().enumerate() {
            let lines = contact.lines();
            contact.take(&self.forces[first..first + lines], self.sticking[k]);
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

    fn fill_matrix(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &Stage,
        lengths: &Lengths,
        n: usize,
    ) {
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for i in 0..n {
            for j in 0..n {
                let through: f64 =
                    self.rows[i].iter().zip(&self.columns[j]).map(|(c, y)| dot(c, y)).sum();
                self.matrix[i * n + j] = through;
                self.offset[i] -= through * self.before[j];
            }
            let own = &mut self.matrix[i * n + i];
            *own += match lengths.cables.get(i) {
                Some(&cable) => rod.cables[cable].compliance / scheme.place,
                None => SHARING * *own,
            };
        }
        let Self { offset, matrix, .. } = self;
        lengths.drives.add_lengths(
            scheme,
            &lengths.cables,
            &stage.tensions,
            |i, more| offset[i] += more,
            |i, j, by| matrix[i * n + j] += by,
        );
    }

    fn find_forces(&mut self, rod: &Rod, lengths: &Lengths, contacts: &Contacts) -> Option<()> {
        let least = LEAST_GAP * rod.length;
        self.sticking.clear();
        self.sticking.resize(contacts.list.len(), false);
        self.forces.clear();
        self.forces.resize(self.offset.len(), 0.0);
        if contacts.list.iter().any(|contact| contact.lines() > 1) {
            return self.find_forces_with_friction(lengths.cables.len(), contacts, least);
        }
        self.problem.active.clear();
        self.problem.active.extend(self.before.iter().map(|&force| force > 0.0));
        self.problem.solve(&self.matrix, &self.offset, least, &mut self.forces).ok()
    }

    /// With friction there may be several answers, since a contact can jam that could as well stay open: those that did not push are taken in only where
    /// they overlap otherwise.
    fn find_forces_with_friction(
        &mut self,
        cables: usize,
        contacts: &Contacts,
        least: f64,
    ) -> Option<()> {
        let Self { matrix, offset, before, forces, with_friction: problem, lines, taken, .. } =
            self;
        let n = offset.len();
        taken.clear();
        taken.extend(contacts.list.iter().map(|contact| contact.force > 0.0));
        loop {
            lines.clear();
            lines.extend(0..cables);
            let mut first = cables;
            for (contact, taken) in contacts.list.iter().zip(&*taken) {
                if *taken {
                    lines.extend(first..first + contact.lines());
                }
                first += contact.lines();
            }
            problem.reset(lines.len());
            problem.contacts.extend((0..cables).map(|first| {
                let touches = before[first] > 0.0;
                contact_problem::Contact { first, coefficient: 0.0, touches, sticks: false }
            }));
            let mut first = cables;
            for (contact, _) in contacts.list.iter().zip(&*taken).filter(|(_, taken)| **taken) {
                problem.contacts.push(contact.problem(first));
                first += contact.lines();
            }
            for (i, &line) in lines.iter().enumerate() {
                let mut pushed = 0.0;
                for (j, &column) in lines.iter().enumerate() {
                    let entry = matrix[line * n + column];
                    problem.matrix[i * lines.len() + j] = entry;
                    pushed += entry * before[column];
                }
                problem.gaps[i] = offset[line] + pushed;
                problem.forces[i] = before[line];
            }
            problem.solve().ok()?;
            forces.fill(0.0);
            for (&line, &force) in lines.iter().zip(&problem.forces) {
                forces[line] = force;
            }
            let mut first = cables;
            let mut overlaps = false;
            for (contact, taken) in contacts.list.iter().zip(taken.iter_mut()) {
                let row = &matrix[first * n..(first + 1) * n];
                let gap = offset[first] + row.iter().zip(&*forces).map(|(m, f)| m * f).sum::<f64>();
                if !*taken && gap < -least {
                    (*taken, overlaps) = (true, true);
                }
                first += contact.lines();
            }
            if !overlaps {
                break;
            }
        }
        let mut solved = problem.contacts[cables..].iter();
        for (sticks, taken) in self.sticking.iter_mut().zip(&*taken) {
            *sticks = *taken && solved.next().is_some_and(|contact| contact.sticks);
        }
        Some(())
    }
}
