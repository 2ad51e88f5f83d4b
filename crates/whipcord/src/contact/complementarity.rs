//! Which contacts touch, which of them stick, and how hard each pushes: eq. (5), and (9) with friction.

use clarabel::algebra::{CscMatrix, MatrixMathMut};
use clarabel::solver::SolverStatus;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT};
use whipcord_numerics::DenseLu;

use super::partly_known::PartlyKnown;

/// `gap = q + Mf ≥ 0, λ ≥ 0, λ·gap = 0`, and Coulomb's law where there is friction. A contact without friction
/// has one line in M, that of its normal; one with friction has two more, along its tangents: of slip and of
/// traction.
#[derive(Clone, Debug, Default)]
pub struct Complementarity {
    /// `M` by rows.
    pub matrix: Vec<f64>,
    /// Gaps and slips where the forces are what they were.
    pub gaps: Vec<f64>,
    /// The forces that were, then those that solve it.
    pub forces: Vec<f64>,
    /// The contacts, in the order of their lines.
    pub contacts: Vec<Contact>,
    /// Whether movable objects touch: contacts of a rigid body with a rigid floor often depend on one another.
    pub are_dependent: bool,
    friction_newton: FrictionNewton,
    lu: DenseLu,
}

/// One contact.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Line of its normal.
    pub first: usize,
    /// Coefficient of friction; 0 without.
    pub coefficient: f64,
    /// Whether it is thought to touch, then whether it does.
    pub touches: bool,
    /// Whether it then sticks.
    pub sticks: bool,
}

/// Those that touch when it is solved.
#[derive(Clone, Copy, Debug)]
pub struct Touching {
    /// Whether the determinant of their part of M is negative.
    pub negative: bool,
}

/// No forces solve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsolved;

/// Memory of Newton's method with friction.
#[derive(Clone, Debug, Default)]
struct FrictionNewton {
    values: Vec<f64>,
    jacobian: Vec<f64>,
    step: Vec<f64>,
    /// The lines of contacts that touch.
    touching: Vec<usize>,
    system: PartlyKnown,
}

/// What a contact with friction does.
#[derive(Clone, Copy, Debug)]
enum State {
    Open,
    /// Or touches without friction.
    Sticks,
    /// With a traction in this direction along its tangents.
    Slides([f64; 2]),
}

impl State {
    fn slides(x: f64, y: f64) -> Self {
        match x.hypot(y) {
            0.0 => Self::Sticks,
            size => Self::Slides([x / size, y / size]),
        }
    }
}

/// So often the contacts change their state one by one, by their number.
const CHANGES: usize = 4;
/// What a contact yields of itself, as a part of what the robot does.
const SHARING: f64 = 1e-11;
/// The same between rigid bodies: forces of contacts that depend on one another are known to the quotient of rounding by this.
const SHARING_OF_OBJECTS: f64 = 1e-8;
/// Forces and gaps smaller than this beside the largest are rounding.
pub(super) const ROUNDING: f64 = 1e-9;
/// Steps of Newton's method with friction.
const STEPS: usize = 60;
/// Sweeps over all contacts where that fails.
const SWEEPS: usize = 300;
/// Steps before those between rigid bodies are halved.
const TO_AND_FRO: usize = 12;
/// It ends where a step changes no force by more, relative to the largest.
const CONVERGED: f64 = 1e-13;
/// The same where rounding lets them change no less.
const NEARLY_CONVERGED: f64 = 1e-8;
/// The same between rigid bodies: at first, where steps are halved, and at the end.
const CONVERGED_FOR_OBJECTS: [f64; 3] = [1e-10, 1e-12, 1e-6];

impl Contact {
    /// How many lines it has.
    #[must_use]
    pub const fn lines(&self) -> usize {
        if self.coefficient > 0.0 { 3 } else { 1 }
    }
}

impl Complementarity {
    /// Forgets everything but makes room for so many lines.
    pub fn reset(&mut self, lines: usize) {
        self.matrix.clear();
        self.matrix.resize(lines * lines, 0.0);
        for list in [&mut self.gaps, &mut self.forces] {
            list.clear();
            list.resize(lines, 0.0);
        }
        self.contacts.clear();
    }

    /// Mostly what touched touches again, and linear equations say how hard. Else those that pull are let go
    /// and those that overlap taken in, one at a time, which keeps to the history of the contacts and asks
    /// nothing of M: it has negative eigenvalues where the contacts hold what they alone would buckle. Where
    /// that goes round in circles a quadratic programme decides which touch.
    ///
    /// # Errors
    /// [`Unsolved`] where no forces were found.
    pub fn solve(&mut self) -> Result<Touching, Unsolved> {
        let lines = self.gaps.len();
        for i in 0..lines {
            let pushed: f64 = (0..lines).map(|j| self.matrix[i * lines + j] * self.forces[j]).sum();
            self.gaps[i] -= pushed;
        }
        if self.contacts.iter().any(|contact| contact.coefficient > 0.0) {
            if !self.are_dependent {
                let forces = self.forces.clone();
                let found = self.find_sticking().and_then(|()| self.solve_with_friction(false));
                return found.or_else(|_| {
                    self.forces.clone_from(&forces);
                    self.solve_with_friction(false).or_else(|_| {
                        // From nearer, where it goes round in circles.
                        self.forces = forces;
                        self.sweep();
                        self.solve_with_friction(false)
                    })
                });
            }
            // Between rigid bodies several states may hold: first all stick, where none slides far.
            let forces = self.forces.clone();
            return self.solve_with_friction(true).or_else(|_| {
                self.forces = forces;
                self.solve_with_friction(false)
            });
        }
        for _ in 0..2 * lines + 1 {
            match self.with_touching() {
                Ok(held) => return Ok(held),
                Err(Some(worst)) => {
                    let contact = &mut self.contacts[worst];
                    contact.touches = !contact.touches;
                }
                Err(None) => break,
            }
        }
        let touched: Vec<bool> = self.contacts.iter().map(|contact| contact.touches).collect();
        if let Some(held) = self.descend() {
            return Ok(held);
        }
        self.contacts.iter_mut().zip(touched).for_each(|(contact, did)| contact.touches = did);
        self.choose_touching()?;
        self.with_touching().map_err(|_| Unsolved)
    }

    /// The forces that close the gaps of those that touch, and whether the determinant of their part of M is negative.
    pub(super) fn forces_of_touching(&mut self) -> Option<(Vec<(usize, f64)>, bool)> {
        let count = self.gaps.len();
        let touching: Vec<usize> = (0..count).filter(|&i| self.contacts[i].touches).collect();
        let sharing = self.sharing();
        let part: Vec<f64> = touching
            .iter()
            .flat_map(|i| touching.iter().map(move |j| (i, j)))
            .map(|(i, j)| {
                // Contacts that depend on one another share what they carry.
                let share = if i == j { 1.0 + sharing } else { 1.0 };
                self.matrix[i * count + j] * share
            })
            .collect();
        // What is shared is the change of the forces, so that gaps close.
        let shared = |i: usize| sharing * self.matrix[i * count + i] * self.forces[i];
        let mut forces: Vec<f64> = touching.iter().map(|&i| shared(i) - self.gaps[i]).collect();
        let mut negative = false;
        if !touching.is_empty() {
            self.lu.factor(touching.len(), &part).ok()?;
            self.lu.solve(&mut forces);
            negative = self.lu.is_determinant_negative();
        }
        let is_finite = forces.iter().all(|force| force.is_finite());
        is_finite.then(|| (touching.into_iter().zip(forces).collect(), negative))
    }

    fn sharing(&self) -> f64 {
        if self.are_dependent { SHARING_OF_OBJECTS } else { SHARING }
    }

    /// Without friction, the forces that close the gaps of those that touch, if none pulls and nothing else
    /// overlaps; else the one that does so most, where there are forces at all.
    fn with_touching(&mut self) -> Result<Touching, Option<usize>> {
        let count = self.gaps.len();
        let (found, negative) = self.forces_of_touching().ok_or(None)?;
        let (touching, forces): (Vec<usize>, Vec<f64>) = found.into_iter().unzip();
        let most = forces.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        let scale = self.gaps.iter().fold(0.0_f64, |most, gap| most.max(gap.abs()));
        let gap = |i: usize| -> f64 {
            let row = &self.matrix[i * count..(i + 1) * count];
            self.gaps[i] + touching.iter().zip(&forces).map(|(&j, f)| row[j] * f).sum::<f64>()
        };
        let pulling = touching.iter().zip(&forces).map(|(&i, force)| (i, force / most));
        let free = (0..count).filter(|&i| !self.contacts[i].touches);
        let overlapping = free.map(|i| (i, gap(i) / scale));
        let wrong = pulling.chain(overlapping).filter(|&(_, size)| size < -ROUNDING);
        if let Some((worst, _)) = wrong.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Err(Some(worst));
        }
        self.forces.fill(0.0);
        for (&i, &force) in touching.iter().zip(&forces) {
            self.forces[i] = force.max(0.0);
        }
        Ok(Touching { negative })
    }

    /// With friction, forces under which each contact does what it did, but for those that could not: of several states that hold, the
    /// one that is next to what was.
    fn find_sticking(&mut self) -> Result<(), Unsolved> {
        let lines = self.gaps.len();
        let state = |contact: &Contact| {
            let [i, x, y] = [0, 1, 2].map(|k| contact.first + k);
            if !contact.touches || self.forces[i] <= 0.0 {
                State::Open
            } else if contact.coefficient == 0.0 || contact.sticks {
                State::Sticks
            } else {
                State::slides(self.forces[x], self.forces[y])
            }
        };
        let mut states: Vec<State> = self.contacts.iter().map(state).collect();
        let scale = self.gaps.iter().fold(f64::MIN_POSITIVE, |most, gap| most.max(gap.abs()));
        for _ in 0..CHANGES * states.len() {
            self.hold(&states)?;
            let Self { matrix, gaps, forces, contacts, .. } = self;
            let most = forces.iter().fold(f64::MIN_POSITIVE, |most, f| most.max(f.abs()));
            let value = |i: usize| {
                let row = &matrix[i * lines..(i + 1) * lines];
                (gaps[i] + row.iter().zip(&*forces).map(|(m, f)| m * f).sum::<f64>()) / scale
            };
            // By how much each could not, and what it does instead; first whether it touches, then whether it sticks.
            let (mut worst, mut change) = ((false, ROUNDING), None);
            for (k, contact) in contacts.iter().enumerate() {
                let i = contact.first;
                let (lack, instead) = match states[k] {
                    State::Open => {
                        let instead = match contact.coefficient {
                            0.0 => State::Sticks,
                            _ => State::slides(-value(i + 1), -value(i + 2)),
                        };
                        ((true, -value(i)), instead)
                    }
                    _ if forces[i] < 0.0 => ((true, -forces[i] / most), State::Open),
                    _ if contact.coefficient == 0.0 => continue,
                    State::Sticks => {
                        let [a, b] = [forces[i + 1], forces[i + 2]];
                        let lack = a.hypot(b) - contact.coefficient * forces[i];
                        ((false, lack / most), State::slides(a, b))
                    }
                    State::Slides([a, b]) => {
                        ((false, a * value(i + 1) + b * value(i + 2)), State::Sticks)
                    }
                };
                if lack.1 > ROUNDING && (change.is_none() || lack > worst) {
                    (worst, change) = (lack, Some((k, instead)));
                }
            }
            match change {
                Some((k, instead)) => states[k] = instead,
                None => return Ok(()),
            }
        }
        Err(Unsolved)
    }

    /// The forces of contacts in these states.
    fn hold(&mut self, states: &[State]) -> Result<(), Unsolved> {
        let lines = self.gaps.len();
        let sharing = self.sharing();
        let Self { matrix, gaps, forces, contacts, friction_newton, .. } = self;
        let FrictionNewton { jacobian, touching, system, .. } = friction_newton;
        jacobian.clear();
        jacobian.resize(lines * lines, 0.0);
        touching.clear();
        forces.fill(0.0);
        for (contact, state) in contacts.iter().zip(states) {
            let i = contact.first;
            if matches!(state, State::Open) {
                continue;
            }
            touching.extend(i..i + contact.lines());
            for (k, row) in (i..i + contact.lines()).enumerate() {
                match state {
                    State::Slides(way) if k > 0 => {
                        jacobian[row * lines + row] = 1.0;
                        jacobian[row * lines + i] = -contact.coefficient * way[k - 1];
                    }
                    _ => {
                        let of = row * lines..(row + 1) * lines;
                        jacobian[of.clone()].copy_from_slice(&matrix[of]);
                        jacobian[row * lines + row] *= 1.0 + sharing;
                        forces[row] = -gaps[row];
                    }
                }
            }
        }
        system.solve(touching, jacobian, forces).map_err(|_| Unsolved)?;
        if forces.iter().all(|force| force.is_finite()) { Ok(()) } else { Err(Unsolved) }
    }

    /// With friction: Newton's method on the projections of Alart and Curnier (1991), by contact
    ///
    /// ```text
    /// λ = max(λ − ρ gap, 0),   t = the vector in the disk of radius μλ that is nearest to t − ρ s      (9)
    /// ```
    ///
    /// from the forces that were.
    fn solve_with_friction(&mut self, begins_sticking: bool) -> Result<Touching, Unsolved> {
        let lines = self.gaps.len();
        let sharing = self.sharing();
        let Self { matrix, gaps, forces, contacts, are_dependent, friction_newton, .. } = self;
        let FrictionNewton { values, jacobian, step, touching, system } = friction_newton;
        let mut before = f64::INFINITY;
        for number in 0..STEPS {
            values.clear();
            values.extend((0..lines).map(|i| {
                let row = &matrix[i * lines..(i + 1) * lines];
                gaps[i] + row.iter().zip(&*forces).map(|(m, f)| m * f).sum::<f64>()
            }));
            jacobian.clear();
            jacobian.resize(lines * lines, 0.0);
            step.clear();
            step.resize(lines, 0.0);
            touching.clear();
            for contact in contacts.iter_mut() {
                let i = contact.first;
                let by_gap = 1.0 / matrix[i * lines + i].abs();
                contact.touches = forces[i] > by_gap * values[i];
                contact.sticks = false;
                let range = i..i + contact.lines();
                if !contact.touches {
                    range.for_each(|row| step[row] = -forces[row]);
                    continue;
                }
                touching.extend(range);
                // Contacts that depend on one another share what they carry.
                let close = |row: usize, jacobian: &mut [f64], step: &mut [f64]| {
                    let of = row * lines..(row + 1) * lines;
                    jacobian[of.clone()].copy_from_slice(&matrix[of]);
                    jacobian[row * lines + row] *= 1.0 + sharing;
                    step[row] = -values[row];
                };
                close(i, jacobian, step);
                if contact.coefficient == 0.0 {
                    continue;
                }
                let [x, y] = [i + 1, i + 2];
                let by_slip = 2.0 / (matrix[x * lines + x] + matrix[y * lines + y]).abs();
                let [a, b] = [x, y].map(|k| forces[k] - by_slip * values[k]);
                let (size, most) = (a.hypot(b), contact.coefficient * forces[i].max(0.0));
                if size <= most || begins_sticking && number == 0 {
                    contact.sticks = true;
                    close(x, jacobian, step);
                    close(y, jacobian, step);
                    continue;
                }
                let way = [a / size, b / size];
                let part = most / size;
                for (k, row) in [x, y].into_iter().enumerate() {
                    step[row] = most * way[k] - forces[row];
                    jacobian[row * lines + row] += 1.0;
                    jacobian[row * lines + i] -= contact.coefficient * way[k];
                    for (l, column) in [x, y].into_iter().enumerate() {
                        let turns = if k == l { 1.0 } else { 0.0 } - way[k] * way[l];
                        jacobian[row * lines + column] -= part * turns;
                        for j in 0..lines {
                            jacobian[row * lines + j] +=
                                part * turns * by_slip * matrix[column * lines + j];
                        }
                    }
                }
            }
            system.solve(touching, jacobian, step).map_err(|_| Unsolved)?;
            if step.iter().any(|change| !change.is_finite()) {
                return Err(Unsolved);
            }
            // Where it goes to and fro between two states, what lies between them may hold.
            let part = if *are_dependent && number >= TO_AND_FRO { 0.5 } else { 1.0 };
            forces.iter_mut().zip(&*step).for_each(|(force, change)| *force += part * change);
            let largest = |list: &[f64]| list.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let changed = largest(step) / largest(forces).max(f64::MIN_POSITIVE);
            let stagnates = !*are_dependent && changed < NEARLY_CONVERGED && changed > 0.5 * before;
            before = changed;
            let tolerance = match number {
                _ if stagnates => NEARLY_CONVERGED,
                _ if !*are_dependent => CONVERGED,
                ..TO_AND_FRO => CONVERGED_FOR_OBJECTS[0],
                _ if number + 1 < STEPS => CONVERGED_FOR_OBJECTS[1],
                _ => CONVERGED_FOR_OBJECTS[2],
            };
            if changed <= tolerance {
                for contact in contacts.iter() {
                    forces[contact.first] = forces[contact.first].max(0.0);
                    if !contact.touches {
                        // No rounding is left of what it pushed.
                        forces[contact.first..contact.first + contact.lines()].fill(0.0);
                    }
                }
                return Ok(Touching { negative: system.is_determinant_negative() });
            }
        }
        Err(Unsolved)
    }

    /// Improves the forces contact by contact, each as if the others stayed, eq. (9): slow, but it does not go round in circles.
    fn sweep(&mut self) {
        let Self { matrix, gaps, forces, contacts, .. } = self;
        let lines = gaps.len();
        let value = |i: usize, forces: &[f64]| {
            let row = &matrix[i * lines..(i + 1) * lines];
            gaps[i] + row.iter().zip(forces).map(|(m, f)| m * f).sum::<f64>()
        };
        for _ in 0..SWEEPS {
            for &Contact { first: i, coefficient, .. } in contacts.iter() {
                let own = |k: usize| matrix[k * lines + k].abs();
                forces[i] = (forces[i] - value(i, forces) / own(i)).max(0.0);
                if coefficient == 0.0 {
                    continue;
                }
                let [x, y] = [i + 1, i + 2];
                let by_slip = 2.0 / (own(x) + own(y));
                let [a, b] = [x, y].map(|k| forces[k] - by_slip * value(k, forces));
                let (size, most) = (a.hypot(b), coefficient * forces[i]);
                let part = if size > most { most / size } else { 1.0 };
                (forces[x], forces[y]) = (a * part, b * part);
            }
        }
        if forces.iter().any(|force| !force.is_finite()) {
            forces.fill(0.0);
        }
    }

    /// Which touch, by the quadratic programme `min ½λᵀMλ + qᵀλ, λ ≥ 0`, scaled to a diagonal of 1.
    fn choose_touching(&mut self) -> Result<(), Unsolved> {
        let count = self.gaps.len();
        let entry =
            |i: usize, j: usize| 0.5 * (self.matrix[i * count + j] + self.matrix[j * count + i]);
        let sizes: Vec<f64> = (0..count).map(|i| entry(i, i)).collect();
        if sizes.iter().any(|&size| size.is_nan() || size <= 0.0) {
            return Err(Unsolved);
        }
        let units: Vec<f64> = sizes.iter().map(|size| size.sqrt().recip()).collect();
        let mut linear: Vec<f64> = (0..count).map(|i| self.gaps[i] * units[i]).collect();
        let largest = linear.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        if largest == 0.0 {
            self.contacts.iter_mut().for_each(|contact| contact.touches = false);
            return Ok(());
        }
        linear.iter_mut().for_each(|q| *q /= largest);
        let upper = (0..count).flat_map(|j| (0..=j).map(move |i| (i, j)));
        let (rows, columns): (Vec<usize>, Vec<usize>) = upper.clone().unzip();
        let values = upper.map(|(i, j)| entry(i, j) * units[i] * units[j]).collect();
        let quadratic = CscMatrix::new_from_triplets(count, count, rows, columns, values);
        let mut signs = CscMatrix::identity(count);
        signs.negate();
        let settings =
            DefaultSettingsBuilder::default().verbose(false).build().map_err(|_| Unsolved)?;
        let bounds = vec![0.0; count];
        let cones = [NonnegativeConeT(count)];
        let mut solver = DefaultSolver::new(&quadratic, &linear, &signs, &bounds, &cones, settings)
            .map_err(|_| Unsolved)?;
        solver.solve();
        if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return Err(Unsolved);
        }
        for (i, contact) in self.contacts.iter_mut().enumerate() {
            contact.touches = solver.solution.x[i] > solver.solution.z[i];
        }
        Ok(())
    }
}
