//! The singly diagonally implicit Runge–Kutta method of order 4 in five stages of Hairer and Wanner.

use whipcord_numerics::Twist;

use crate::energy::Power;
use crate::free_base::{BaseTangent, FreeBase, exponent_rate};
use crate::iteration::{Control, Mechanics, Solver, Stalled};
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;
use crate::state::State;

pub(crate) const STAGES: usize = 5;
/// The diagonal of the method, `γ`.
pub(crate) const GAMMA: f64 = 0.25;

/// Coefficients `a_ij` below the diagonal; the last row is that of the end (Hairer and Wanner, *Solving ordinary differential equations II*,
/// table 6.5).
pub(crate) const A: [[f64; STAGES]; STAGES] = [
    [GAMMA, 0.0, 0.0, 0.0, 0.0],
    [0.5, GAMMA, 0.0, 0.0, 0.0],
    [17.0 / 50.0, -1.0 / 25.0, GAMMA, 0.0, 0.0],
    [371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0, GAMMA, 0.0],
    [25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0, GAMMA],
];
/// Times of the stages.
pub(crate) const C: [f64; STAGES] = [0.25, 0.75, 0.55, 0.5, 1.0];
/// Weights of the embedded method of order 3.
const EMBEDDED: [f64; STAGES] = [59.0 / 48.0, -17.0 / 96.0, 225.0 / 32.0, -85.0 / 12.0, 0.0];

/// From which rates those of a stage are predicted: two earlier stages, and the weight of the second.
const PREDICTED: [(usize, usize, f64); STAGES] =
    [(0, 0, 0.0), (0, 0, 0.0), (0, 1, 0.6), (0, 2, 0.25 / 0.3), (1, 1, 0.0)];

/// Rates of the stages.
#[derive(Clone, Debug)]
pub(crate) struct Accurate {
    velocities: [Vec<Twist>; STAGES],
    strains: [Vec<Twist>; STAGES],
    /// Of the exponent of the pose of a free base.
    base: [Twist; STAGES],
    /// Difference of the strains at the end to those of the embedded method.
    pub error: Vec<Twist>,
}

impl Accurate {
    pub fn new(rod: &Rod) -> Self {
        let list = |n: usize| core::array::from_fn(|_| vec![Twist::default(); n]);
        Self {
            velocities: list(rod.nodes.len()),
            strains: list(rod.points.len()),
            base: [Twist::default(); STAGES],
            error: vec![Twist::default(); rod.points.len()],
        }
    }

    /// Takes a step from a state. `tensions` writes the tensions of the cables at a time. The end is left in the stage, and the energies
    /// given and taken are returned.
    pub fn step(
        &mut self,
        mechanics: Mechanics<'_>,
        solver: &mut Solver,
        from: &State,
        h: f64,
        control: &Control,
        tensions: impl Fn(f64, &mut [f64]),
    ) -> Result<Power, Stalled> {
        let loads = mechanics.loads;
        let scheme = Scheme::at_end(GAMMA * h);
        solver.is_linearised = false;
        let mut work = Power::default();
        for i in 0..STAGES {
            let stage = &mut solver.stage;
            let time = from.time + C[i] * h;
            tensions(time, &mut stage.tensions);
            loads.at(time, &mut stage.loads);
            stage.start.copy_from_slice(&from.strains);
            combine(&mut stage.velocity_history, &from.velocities, &self.velocities, h, &A[i][..i]);
            combine(&mut stage.strain_history, &from.strains, &self.strains, h, &A[i][..i]);
            let known = (i == 0).then_some((&from.velocity_rates, &from.strain_rates));
            let (first, second, weight) = PREDICTED[i];
            let g = scheme.g;
            let predict = |unknowns: &mut [Twist], history: &[Twist], a: &[Twist], b: &[Twist]| {
                for (j, unknown) in unknowns.iter_mut().enumerate() {
                    *unknown = history[j] + (a[j] * (1.0 - weight) + b[j] * weight) * g;
                }
            };
            if let Some((velocity_rates, strain_rates)) = known {
                if from.has_rates && control.predicts {
                    predict(
                        &mut stage.velocities,
                        &stage.velocity_history,
                        velocity_rates,
                        velocity_rates,
                    );
                    predict(&mut stage.strains, &stage.strain_history, strain_rates, strain_rates);
                } else {
                    stage.velocities.copy_from_slice(&from.velocities);
                    stage.strains.copy_from_slice(&from.strains);
                }
            } else {
                let (a, b) = (&self.velocities[first], &self.velocities[second]);
                predict(&mut stage.velocities, &stage.velocity_history, a, b);
                let (a, b) = (&self.strains[first], &self.strains[second]);
                predict(&mut stage.strains, &stage.strain_history, a, b);
            }
            if loads.has_free_base {
                stage.free_base = Some(self.free_base(i, from, h));
            } else {
                stage.move_base(loads, from.base, from.time, C[i] * h);
            }
            solver.solve(mechanics, &scheme, control)?;
            let stage = &mut solver.stage;
            if let Some(free) = stage.free_base {
                let velocity = stage.velocities[0];
                stage.base = free.pose(velocity);
                self.base[i] = exponent_rate(free.exponent(velocity), velocity);
            }
            rates(&mut self.velocities[i], &stage.velocities, &stage.velocity_history, scheme.g);
            rates(&mut self.strains[i], &stage.strains, &stage.strain_history, scheme.g);
            work.add(h * A[STAGES - 1][i], &Power::at(mechanics, stage, &scheme, solver.drag));
        }
        for (q, error) in self.error.iter_mut().enumerate() {
            *error = Twist::default();
            for i in 0..STAGES {
                *error = *error + self.strains[i][q] * (h * (A[STAGES - 1][i] - EMBEDDED[i]));
            }
        }
        Ok(work)
    }

    /// Puts a stage of the last step, which began in a state, into the stage of a solver.
    pub fn stage(&self, i: usize, from: &State, h: f64, stage: &mut Stage) {
        stage.start.copy_from_slice(&from.strains);
        combine(&mut stage.velocity_history, &from.velocities, &self.velocities, h, &A[i][..i]);
        combine(&mut stage.strain_history, &from.strains, &self.strains, h, &A[i][..i]);
        combine(&mut stage.velocities, &from.velocities, &self.velocities, h, &A[i][..=i]);
        combine(&mut stage.strains, &from.strains, &self.strains, h, &A[i][..=i]);
    }

    /// How the pose of a free base changes at a stage that is put into the stage of a solver, which gets the pose as well.
    pub fn base_tangent(
        &self,
        i: usize,
        from: &State,
        h: f64,
        stage: &mut Stage,
    ) -> Option<BaseTangent> {
        let free = self.free_base(i, from, h);
        let velocity = stage.velocities[0];
        stage.free_base = Some(free);
        BaseTangent::new(&free, velocity)
    }

    /// The free base at a stage.
    fn free_base(&self, i: usize, from: &State, h: f64) -> FreeBase {
        let weighted = self.base.iter().zip(&A[i][..i]);
        let history = weighted.fold(Twist::default(), |sum, (rate, a)| sum + *rate * (h * a));
        FreeBase { start: from.base, history, g: GAMMA * h }
    }

    /// Rates of velocities and strains at the end.
    pub fn rates(&self) -> (&[Twist], &[Twist]) {
        (&self.velocities[STAGES - 1], &self.strains[STAGES - 1])
    }
}

/// `out = from + h Σ a_j rates_j`.
fn combine(out: &mut [Twist], from: &[Twist], rates: &[Vec<Twist>; STAGES], h: f64, a: &[f64]) {
    out.copy_from_slice(from);
    for (rates, a) in rates.iter().zip(a) {
        for (out, rate) in out.iter_mut().zip(rates) {
            *out = *out + *rate * (h * a);
        }
    }
}

fn rates(out: &mut [Twist], unknowns: &[Twist], history: &[Twist], g: f64) {
    for ((out, unknown), history) in out.iter_mut().zip(unknowns).zip(history) {
        *out = (*unknown - *history) * (1.0 / g);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The conditions of order 4, and of order 3 for the embedded method (Butcher).
    #[test]
    fn the_coefficients_meet_the_conditions_of_their_orders() {
        let sum = |f: &dyn Fn(usize) -> f64| (0..STAGES).map(f).sum::<f64>();
        for i in 0..STAGES {
            assert!((sum(&|j| A[i][j]) - C[i]).abs() < 1e-14);
        }
        let a = |i: usize, f: &dyn Fn(usize) -> f64| sum(&|j| A[i][j] * f(j));
        let conditions = |b: &[f64; STAGES]| {
            [
                sum(&|i| b[i]) - 1.0,
                sum(&|i| b[i] * C[i]) - 0.5,
                sum(&|i| b[i] * C[i].powi(2)) - 1.0 / 3.0,
                sum(&|i| b[i] * a(i, &|j| C[j])) - 1.0 / 6.0,
                sum(&|i| b[i] * C[i].powi(3)) - 0.25,
                sum(&|i| b[i] * C[i] * a(i, &|j| C[j])) - 1.0 / 8.0,
                sum(&|i| b[i] * a(i, &|j| C[j].powi(2))) - 1.0 / 12.0,
                sum(&|i| b[i] * a(i, &|j| a(j, &|k| C[k]))) - 1.0 / 24.0,
            ]
        };
        assert!(conditions(&A[STAGES - 1]).iter().all(|d| d.abs() < 1e-13));
        let embedded = conditions(&EMBEDDED);
        assert!(embedded[..4].iter().all(|d| d.abs() < 1e-13));
        assert!(embedded[4..].iter().any(|d| d.abs() > 1e-3));
    }
}
