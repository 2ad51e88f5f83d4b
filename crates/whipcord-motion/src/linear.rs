//! The motion linearised about a state.

use whipcord_numerics::{Twist, Vec3};

use crate::element::POINTS;
use crate::iteration::Solver;
use crate::loads::NodeLoads;
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::{PointTangent, Stage};

/// `ẋ ≈ f + A (x − x₀) + B (τ − τ₀)` about a state `x₀`.
///
/// `x` holds velocities and then strains: six numbers, translation before rotation, for each node but the one at the base, then six for each
/// point of the elements.
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
}

impl<'a> Rates<'a> {
    pub fn new(rod: &'a Rod, loads: &'a NodeLoads, solver: &Solver, time: f64) -> Self {
        let mut stage = solver.stage.clone();
        // Without a linearisation the residual is that of the equations alone.
        stage.tangents.fill(PointTangent::default());
        loads.at(time, &mut stage.loads);
        Self { rod, loads, drag: solver.drag, stage }
    }

    /// Writes the rates of velocities and strains, eq. (1) and (2) of the page on motion.
    fn evaluate(
        &mut self,
        velocities: &[Twist],
        strains: &[Twist],
        tensions: &[f64],
        out: &mut [f64],
    ) {
        let Self { rod, loads, drag, stage } = self;
        stage.velocities.copy_from_slice(velocities);
        stage.velocity_history.copy_from_slice(velocities);
        stage.strains.copy_from_slice(strains);
        stage.start.copy_from_slice(strains);
        stage.tensions.copy_from_slice(tensions);
        let nodes = rod.nodes.len() - 1;
        for e in 0..rod.elements() {
            for k in 0..POINTS {
                let q = POINTS * e + k;
                let (value, slope) = Stage::at_point(velocities, e, k, rod.lengths[e]);
                let rate = slope + strains[q].bracket(value);
                // The rate is the change from the history, times 1/s.
                stage.strain_history[q] = strains[q] - rate;
                write(&rate, &mut out[6 * (nodes + q)..]);
            }
        }
        pose::nodes(rod, stage.base, strains, &mut stage.poses);
        let scheme = Scheme { g: 0.0, inertia: 1.0, damping: 1.0, place: 1.0, conserves: false };
        stage.assemble(rod, &scheme, loads.gravity, *drag, false);
        for (a, node) in rod.nodes.iter().enumerate().skip(1) {
            let residual = &stage.residual[a];
            let inertia = node.inertia;
            let turning = residual.angular;
            let rate = Twist {
                linear: residual.linear * (-1.0 / node.mass),
                angular: -Vec3::new(
                    turning.x / inertia.x,
                    turning.y / inertia.y,
                    turning.z / inertia.z,
                ),
            };
            write(&rate, &mut out[6 * (a - 1)..]);
        }
    }

    /// Force and moment that the base exerts on the node at the base.
    pub fn base_wrench(
        &mut self,
        velocities: &[Twist],
        strains: &[Twist],
        tensions: &[f64],
    ) -> Twist {
        let mut rates = vec![0.0; 6 * (velocities.len() - 1 + strains.len())];
        self.evaluate(velocities, strains, tensions, &mut rates);
        self.stage.residual[0]
    }

    /// The linearisation by central differences, whose error is about 1e-9 of the entries of a row.
    pub fn linearized(
        &mut self,
        velocities: &[Twist],
        strains: &[Twist],
        tensions: &[f64],
    ) -> Linearized {
        let (nodes, points) = (self.rod.nodes.len() - 1, self.rod.points.len());
        let states = 6 * (nodes + points);
        let inputs = tensions.len();
        let mut rate = vec![0.0; states];
        self.evaluate(velocities, strains, tensions, &mut rate);
        let (mut above, mut below) = (vec![0.0; states], vec![0.0; states]);
        let (mut v, mut s) = (velocities.to_vec(), strains.to_vec());
        let mut a = vec![0.0; states * states];
        let length = self.rod.length;
        for column in 0..states {
            let (k, component) = (column / 6, column % 6);
            let is_velocity = k < nodes;
            let unit = match (is_velocity, component < 3) {
                (true, true) => length,
                (false, false) => 1.0 / length,
                _ => 1.0,
            };
            let h = 1e-5 * unit;
            for (by, out) in [(h, &mut above), (-h, &mut below)] {
                let twist = if is_velocity { &mut v[k + 1] } else { &mut s[k - nodes] };
                let before = *twist;
                let part = if component < 3 { &mut twist.linear } else { &mut twist.angular };
                part[component % 3] += by;
                self.evaluate(&v, &s, tensions, out);
                let twist = if is_velocity { &mut v[k + 1] } else { &mut s[k - nodes] };
                *twist = before;
            }
            for row in 0..states {
                a[row * states + column] = (above[row] - below[row]) / (2.0 * h);
            }
        }
        // The rates are linear in the tensions.
        let mut b = vec![0.0; states * inputs];
        let mut t = tensions.to_vec();
        for column in 0..inputs {
            t[column] = tensions[column] + 1.0;
            self.evaluate(&v, &s, &t, &mut above);
            t[column] = tensions[column];
            for row in 0..states {
                b[row * inputs + column] = above[row] - rate[row];
            }
        }
        Linearized { states, inputs, a, b, rate }
    }
}

fn write(twist: &Twist, out: &mut [f64]) {
    out[..3].copy_from_slice(&twist.linear.to_array());
    out[3..6].copy_from_slice(&twist.angular.to_array());
}
