//! The motion linearised about a state.

use whipcord_numerics::{DenseLu, Pose, Twist, Vec3};

use crate::block::dot;
use crate::contacts::Contacts;
use crate::element::POINTS;
use crate::free_base::exponent_rate;
use crate::friction::{Locked, length};
use crate::iteration::Solver;
use crate::loads::NodeLoads;
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::{PointTangent, Stage};

/// `ẋ ≈ f + A (x − x₀) + B (τ − τ₀)` about a state `x₀`.
///
/// `x` holds velocities and then strains: six numbers, translation before rotation, for each node but the one at the base, then six for each
/// point of the elements. With a free base the displacement of the base in its frame comes before them, and the velocities begin with its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearized {
    /// Number of the state's components.
    pub states: usize,
    /// Number of cables.
    pub inputs: usize,
    /// `A` by rows, in 1/s for components of one unit.
    pub a: Vec<f64>,
    /// `B` by rows: by tensions in N.
    pub b: Vec<f64>,
    /// `f`: the rate at the state.
    pub rate: Vec<f64>,
}

/// The explicit right-hand side of the equations of motion, evaluated in the stage of a solver.
pub(crate) struct Rates<'a> {
    rod: &'a Rod,
    loads: &'a NodeLoads,
    drag: Vec3,
    stage: Stage,
    /// What touches goes on to touch.
    held: Held,
    /// Pieces of cables that stay in their passages.
    locked: Vec<Locked>,
    /// Whether the tensions of passages stay what they are.
    holds_passages: bool,
}

/// A state, in whose neighbourhood the rates are wanted.
#[derive(Clone, Debug)]
struct Point {
    /// Displacement of a free base in its frame.
    moved: Twist,
    velocities: Vec<Twist>,
    strains: Vec<Twist>,
    tensions: Vec<f64>,
}

/// The contacts that are held, as constraints on the accelerations.
#[derive(Clone, Debug, Default)]
struct Held {
    contacts: Contacts,
    /// For each line of each contact what its force exerts on the nodes, and what the gap or slip changes by with the velocities.
    pushes: Vec<Vec<Twist>>,
    motions: Vec<Vec<Twist>>,
    matrix: Vec<f64>,
    forces: Vec<f64>,
    lu: DenseLu,
}

impl Held {
    /// Finds the lines of all contacts at the strains and poses of a stage: the normal, and both tangents where a contact sticks. The force of one that
    /// slides is inclined by its friction.
    fn find(&mut self, rod: &Rod, stage: &Stage) {
        let Self { contacts, pushes, motions, .. } = self;
        let scheme = Scheme::STATICS;
        contacts.base = stage.base;
        contacts.end_base = None;
        contacts.refresh(rod, &scheme, stage);
        pushes.clear();
        motions.clear();
        let none = vec![Twist::default(); rod.nodes.len()];
        for k in 0..contacts.list.len() {
            let contact = &contacts.list[k];
            let mut tangential = Vec::new();
            // Along which it slides.
            let mut rates = [0.0; 2];
            for line in 0..contact.lines() {
                let (mut push, mut motion) = (none.clone(), none.clone());
                contacts.linearise(&scheme, k, line, &mut push, &mut motion);
                for push in &mut push {
                    *push = *push * -1.0;
                }
                if line == 0 || contact.sticks {
                    pushes.push(push);
                    motions.push(motion);
                } else {
                    rates[line - 1] = product(&motion, &stage.velocities);
                    tangential.push(push);
                }
            }
            let speed = rates[0].hypot(rates[1]);
            if speed > 0.0
                && let Some(inclined) = pushes.last_mut()
            {
                for (rate, push) in rates.into_iter().zip(&tangential) {
                    let share = -contact.coefficient * rate / speed;
                    for (sum, push) in inclined.iter_mut().zip(push) {
                        *sum = *sum + *push * share;
                    }
                }
            }
        }
    }
}

impl<'a> Rates<'a> {
    /// With `contacts` that are held.
    pub fn new(rod: &'a Rod, loads: &'a NodeLoads, solver: &Solver, contacts: Contacts) -> Self {
        let mut stage = solver.stage.clone();
        // Without a linearisation the residual is that of the equations alone.
        stage.tangents.fill(PointTangent::default());
        let held = Held { contacts, ..Held::default() };
        Self {
            rod,
            loads,
            drag: solver.drag,
            stage,
            held,
            locked: Vec::new(),
            holds_passages: false,
        }
    }

    /// With pieces of elastic cables that stay in their passages.
    pub fn with_locked(self, locked: Vec<Locked>) -> Self {
        Self { locked, ..self }
    }

    /// The first node whose velocity is in the state, and the number of the first component of a velocity.
    fn first(&self) -> (usize, usize) {
        let first = self.loads.first_free();
        (first, if first == 0 { 6 } else { 0 })
    }

    /// Writes the rates of a state, eq. (1), (2) and (29) of the page on motion.
    fn evaluate(&mut self, base: Pose, at: &Point, out: &mut [f64]) {
        let (first, start) = self.first();
        let Self { rod, loads, drag, stage, held, locked, holds_passages } = self;
        let Point { moved, velocities, strains, tensions } = at;
        stage.velocities.copy_from_slice(velocities);
        stage.velocity_history.copy_from_slice(velocities);
        stage.strains.copy_from_slice(strains);
        stage.start.copy_from_slice(strains);
        stage.tensions.copy_from_slice(tensions);
        stage.base = base;
        if first == 0 {
            stage.base = base * Pose::exp(*moved);
            write(&exponent_rate(*moved, velocities[0]), out);
        }
        let nodes = rod.nodes.len() - first;
        let mut strain_rates = vec![Twist::default(); strains.len()];
        for e in 0..rod.elements() {
            for k in 0..POINTS {
                let q = POINTS * e + k;
                let (value, slope) = Stage::at_point(velocities, e, k, rod.lengths[e]);
                let rate = slope + strains[q].bracket(value);
                // The rate is the change from the history, times 1/s.
                stage.strain_history[q] = strains[q] - rate;
                write(&rate, &mut out[start + 6 * (nodes + q)..]);
                strain_rates[q] = rate;
            }
        }
        pose::nodes(rod, stage.base, strains, &mut stage.poses);
        if !(stage.passages.is_empty() || *holds_passages) {
            // Cables without friction have their own tension everywhere.
            for (tension, cable) in stage.passages.iter_mut().zip(rod.cables_of_passages()) {
                *tension = tensions[cable];
            }
            for of in &*locked {
                let now = length(rod, of.passage, of.cable, strains, &stage.poses);
                stage.passages[of.passage] = of.tension + (now - of.length) / of.yielding;
            }
        }
        let scheme = Scheme { g: 0.0, inertia: 1.0, damping: 1.0, place: 1.0, conserves: false };
        stage.assemble(rod, &scheme, loads.gravity, *drag, false);
        let mut accelerations = vec![Twist::default(); rod.nodes.len()];
        for a in first..rod.nodes.len() {
            accelerations[a] = accelerated(rod, a, &stage.residual[a]) * -1.0;
        }
        if !held.contacts.list.is_empty() {
            hold(rod, first, stage, held, &strain_rates, &mut accelerations);
        }
        for (a, rate) in accelerations.iter().enumerate().skip(first) {
            write(rate, &mut out[start + 6 * (a - first)..]);
        }
    }

    /// Force and moment that the base exerts on the node at the base.
    pub fn base_wrench(
        &mut self,
        velocities: &[Twist],
        strains: &[Twist],
        tensions: &[f64],
    ) -> Twist {
        let at = Point::new(velocities, strains, tensions);
        let mut rates = vec![0.0; self.states()];
        // Friction has left other tensions in the passages than below the base.
        self.holds_passages = true;
        self.evaluate(self.stage.base, &at, &mut rates);
        self.holds_passages = false;
        self.stage.residual[0]
    }

    fn states(&self) -> usize {
        let (first, start) = self.first();
        start + 6 * (self.rod.nodes.len() - first + self.rod.points.len())
    }

    /// The linearisation by central differences, whose error is about 1e-9 of the entries of a row.
    pub fn linearized(
        &mut self,
        velocities: &[Twist],
        strains: &[Twist],
        tensions: &[f64],
    ) -> Linearized {
        let (first, start) = self.first();
        let nodes = self.rod.nodes.len() - first;
        let (states, inputs) = (self.states(), tensions.len());
        let base = self.stage.base;
        let mut at = Point::new(velocities, strains, tensions);
        let mut rate = vec![0.0; states];
        self.evaluate(base, &at, &mut rate);
        let (mut above, mut below) = (vec![0.0; states], vec![0.0; states]);
        let mut a = vec![0.0; states * states];
        let length = self.rod.length;
        for column in 0..states {
            let component = column % 6;
            let is_strain = column >= start + 6 * nodes;
            let unit = match (is_strain, component < 3) {
                (false, true) => length,
                (true, false) => 1.0 / length,
                _ => 1.0,
            };
            let h = 1e-5 * unit;
            for (by, out) in [(h, &mut above), (-h, &mut below)] {
                let before = at.clone();
                let twist = match (column / 6).checked_sub(start / 6) {
                    None => &mut at.moved,
                    Some(k) if k < nodes => &mut at.velocities[k + first],
                    Some(k) => &mut at.strains[k - nodes],
                };
                let part = if component < 3 { &mut twist.linear } else { &mut twist.angular };
                part[component % 3] += by;
                self.evaluate(base, &at, out);
                at = before;
            }
            for row in 0..states {
                a[row * states + column] = (above[row] - below[row]) / (2.0 * h);
            }
        }
        // The rates are linear in the tensions.
        let mut b = vec![0.0; states * inputs];
        for column in 0..inputs {
            at.tensions[column] = tensions[column] + 1.0;
            self.evaluate(base, &at, &mut above);
            at.tensions[column] = tensions[column];
            for row in 0..states {
                b[row * inputs + column] = above[row] - rate[row];
            }
        }
        Linearized { states, inputs, a, b, rate }
    }
}

impl Point {
    fn new(velocities: &[Twist], strains: &[Twist], tensions: &[f64]) -> Self {
        let (velocities, strains) = (velocities.to_vec(), strains.to_vec());
        Self { moved: Twist::default(), velocities, strains, tensions: tensions.to_vec() }
    }
}

fn product(a: &[Twist], b: &[Twist]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

/// The acceleration of a node by a force on it.
fn accelerated(rod: &Rod, a: usize, force: &Twist) -> Twist {
    let (node, turning) = (&rod.nodes[a], force.angular);
    let Vec3 { x, y, z } = node.inertia;
    Twist {
        linear: force.linear * (1.0 / node.mass),
        angular: Vec3::new(turning.x / x, turning.y / y, turning.z / z),
    }
}

/// Adds to the accelerations what the forces of held contacts do: their gaps and slips have no acceleration, `J V̇ + J̇ V = 0`. Leaves the stage as it is.
fn hold(
    rod: &Rod,
    first: usize,
    stage: &mut Stage,
    held: &mut Held,
    strain_rates: &[Twist],
    accelerations: &mut [Twist],
) {
    /// Change of the strains for the rate of `J`, times the length where it is one of curvature, and of the place as a part of the length.
    const STEP: f64 = 1e-5;
    /// What a contact yields of itself: several of one disk may depend on one another.
    const SHARING: f64 = 1e-9;
    let (base, strains) = (stage.base, stage.strains.clone());
    let velocity = stage.velocities[0];
    let product = |a: &[Twist], b: &[Twist]| a.iter().zip(b).map(|(a, b)| dot(a, b)).sum::<f64>();
    let size = |of: &Twist, of_turn: f64| of.linear.max_abs().max(of.angular.max_abs() * of_turn);
    let fastest = strain_rates.iter().map(|rate| size(rate, rod.length)).fold(0.0, f64::max);
    let fastest = fastest.max(size(&velocity, rod.length) / rod.length);
    // J̇ V by a central difference along the motion.
    let mut turning: Vec<f64> = Vec::new();
    if fastest > 0.0 {
        let h = STEP / fastest;
        for sign in [1.0, -1.0] {
            stage.base = if first == 0 { base * Pose::exp(velocity * (sign * h)) } else { base };
            for ((strain, at), rate) in stage.strains.iter_mut().zip(&strains).zip(strain_rates) {
                *strain = *at + *rate * (sign * h);
            }
            stage.start.clone_from(&stage.strains);
            pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
            held.find(rod, stage);
            turning.resize(held.motions.len(), 0.0);
            for (sum, motion) in turning.iter_mut().zip(&held.motions) {
                *sum += product(motion, &stage.velocities) * (sign * 0.5 / h);
            }
        }
        (stage.base, stage.strains) = (base, strains);
        stage.start.clone_from(&stage.strains);
        pose::nodes(rod, base, &stage.strains, &mut stage.poses);
    }
    held.find(rod, stage);
    let n = held.motions.len();
    turning.resize(n, 0.0);
    let Held { pushes, motions, matrix, forces, lu, .. } = held;
    for push in pushes.iter_mut() {
        for (a, push) in push.iter_mut().enumerate() {
            *push = if a < first { Twist::default() } else { accelerated(rod, a, push) };
        }
    }
    matrix.clear();
    matrix.resize(n * n, 0.0);
    forces.clear();
    for (i, motion) in motions.iter().enumerate() {
        for (j, push) in pushes.iter().enumerate() {
            matrix[i * n + j] = product(motion, push);
        }
        matrix[i * n + i] *= 1.0 + SHARING;
        forces.push(-(product(motion, accelerations) + turning[i]));
    }
    // A contact whose force moves nothing holds nothing.
    if lu.factor(n, matrix).is_err() {
        return;
    }
    lu.solve(forces);
    for (push, force) in pushes.iter().zip(&*forces) {
        for (acceleration, push) in accelerations.iter_mut().zip(push) {
            *acceleration = *acceleration + *push * *force;
        }
    }
}

fn write(twist: &Twist, out: &mut [f64]) {
    out[..3].copy_from_slice(&twist.linear.to_array());
    out[3..6].copy_from_slice(&twist.angular.to_array());
}
