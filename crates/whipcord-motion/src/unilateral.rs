//! What holds a stage by inequalities: cables that are driven by their lengths and contacts, together, eqs. (13), (25) and (26) of the page on motion. The tensions of cables
//! with friction are condensed into the equations of the contacts, in the cases that their holes have, eq. (32).

use whipcord::contact::complementarity as contact_problem;
use whipcord_numerics::Twist;

use crate::block::dot;
use crate::complementarity::Complementarity;
use crate::contacts::Contacts;
use crate::friction::{Friction, SingularHoles};
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

/// So often the cases of the holes are found anew for the forces of the contacts in one iteration.
const MOST_CASES: usize = 4;

/// Whether tensions change in the same way, to rounding.
fn is_same(a: &[f64], b: &[f64]) -> bool {
    let greatest = a.iter().chain(b).fold(0.0_f64, |most, by| most.max(by.abs()));
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * greatest)
}

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
        self.make_room(rod, n);
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
                let gap = self.linearise_contact(contacts, scheme, (k, line), i);
                self.add_line(i, gap, force, stage);
                i += 1;
            }
        }
        self.fill_matrix(rod, scheme, stage, lengths, n);
        self.find_forces(rod, lengths, contacts)?;
        for (i, &cable) in lengths.cables.iter().enumerate() {
            stage.tensions[cable] = self.forces[i];
        }
        self.take_contacts(contacts, cables);
        self.add_velocities(stage);
        Some(())
    }

    /// The same of contacts where cables have friction, with the tensions of all passages. The equations of the holes are linear in each of their cases: those of contacts have what the
    /// tensions do there, until the cases are those at the forces that are found.
    pub fn solve_with_holes(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &mut Stage,
        (friction, lengths, contacts): (&mut Friction, &Lengths, &mut Contacts),
    ) -> Result<(), SingularHoles> {
        let n = contacts.lines();
        self.make_room(rod, n);
        self.offset.clear();
        self.before.clear();
        contacts.find_shifts(rod, scheme, stage);
        let mut i = 0;
        for k in 0..contacts.list.len() {
            let forces = contacts.list[k].forces();
            for (line, force) in forces.into_iter().enumerate().take(contacts.list[k].lines()) {
                let gap = self.linearise_contact(contacts, scheme, (k, line), i);
                self.offset.push(gap);
                self.before.push(force);
                stage.matrix.solve(&mut self.columns[i]);
                i += 1;
            }
        }
        friction.linearise(rod, scheme, (stage, &lengths.drives), &self.columns[..n]);
        let (gaps, mut changes) = (self.offset.clone(), vec![0.0; n]);
        let mut expected: Option<Vec<f64>> = None;
        for _ in 0..MOST_CASES {
            friction.respond_to_forces(&changes)?;
            if expected.as_ref().is_some_and(|of| is_same(of, &friction.responses()[0])) {
                break;
            }
            self.condense(rod, scheme, stage, (friction, lengths), (&gaps, &changes));
            self.find_forces(rod, lengths, contacts).ok_or(SingularHoles)?;
            let of_tensions = friction.responses();
            let mut sum = of_tensions[0].clone();
            for (j, by) in of_tensions[1..].iter().enumerate() {
                let further = self.forces[j] - self.before[j] - changes[j];
                sum.iter_mut().zip(by).for_each(|(sum, by)| *sum += by * further);
            }
            for (change, (force, before)) in
                changes.iter_mut().zip(self.forces.iter().zip(&self.before))
            {
                *change = force - before;
            }
            expected = Some(sum);
        }
        friction.respond_to_forces(&changes)?;
        self.take_contacts(contacts, 0);
        self.add_velocities(stage);
        friction.take(stage);
        Ok(())
    }

    /// Fills the equations of the contacts with what the tensions of all passages do, in the cases that the holes have where the forces change by these amounts.
    fn condense(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &Stage,
        (friction, lengths): (&Friction, &Lengths),
        (gaps, changes): (&[f64], &[f64]),
    ) {
        let n = gaps.len();
        let responses = friction.responses();
        // Of forces that stay what they are.
        let mut still = responses[0].clone();
        for (by, change) in responses[1..].iter().zip(changes) {
            still.iter_mut().zip(by).for_each(|(still, by)| *still -= by * change);
        }
        let mut velocities = stage.residual.clone();
        friction.add_velocities(&still, &mut velocities);
        let own = self.columns[..n].to_vec();
        for (i, gap) in gaps.iter().enumerate() {
            let of_free: f64 = self.rows[i].iter().zip(&velocities).map(|(c, x)| dot(c, x)).sum();
            self.offset[i] = gap - of_free;
            let against: Vec<f64> = responses[1 + i].iter().map(|by| -by).collect();
            friction.add_velocities(&against, &mut self.columns[i]);
        }
        self.fill_matrix(rod, scheme, stage, lengths, n);
        self.columns[..n].clone_from_slice(&own);
    }

    fn make_room(&mut self, rod: &Rod, lines: usize) {
        while self.columns.len() < lines {
            self.columns.push(vec![Twist::default(); rod.nodes.len()]);
            self.rows.push(vec![Twist::default(); rod.nodes.len()]);
        }
    }

    /// Fills column and row of a line of a contact; returns its gap or slip.
    fn linearise_contact(
        &mut self,
        contacts: &Contacts,
        scheme: &Scheme,
        (contact, line): (usize, usize),
        i: usize,
    ) -> f64 {
        let (column, row) = (&mut self.columns[i], &mut self.rows[i]);
        let gap = contacts.linearise(scheme, contact, line, column, row);
        for entry in row {
            *entry = *entry * -1.0;
        }
        gap
    }

    /// Has the contacts push with the forces that were found, from a line on.
    fn take_contacts(&self, contacts: &mut Contacts, mut first: usize) {
        for (k, contact) in contacts.list.iter_mut().enumerate() {
            let lines = contact.lines();
            contact.take(&self.forces[first..first + lines], self.sticking[k]);
            first += lines;
        }
    }

    /// Adds what the changes of the forces do to the velocities.
    fn add_velocities(&self, stage: &mut Stage) {
        for ((column, force), before) in self.columns.iter().zip(&self.forces).zip(&self.before) {
            let change = force - before;
            for (x, y) in stage.residual.iter_mut().zip(column) {
                *x = *x - *y * change;
            }
        }
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
