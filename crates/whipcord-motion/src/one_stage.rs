//! A step by a method with one stage.

use whipcord_numerics::Twist;

use crate::coefficients::OneStage;
use crate::energy::Power;
use crate::free_base::FreeBase;
use crate::iteration::{Control, Mechanics, Solver, Stalled};
use crate::state::State;

impl OneStage {
    /// Takes a step from a state into another one: velocities, strains and their rates. Tensions and lengths must be set in the solver.
    pub fn step(
        &self,
        mechanics: Mechanics<'_>,
        solver: &mut Solver,
        from: &State,
        to: &mut State,
        h: f64,
        control: &Control,
    ) -> Result<Power, Stalled> {
        let loads = mechanics.loads;
        let scheme = self.scheme(h);
        solver.is_linearised = false;
        let carried = self.carried(h);
        let ahead =
            if control.predicts && Self::knows_rates(from, h) { self.place * h } else { 0.0 };
        let stage = &mut solver.stage;
        loads.at(self.time(from.time, h), &mut stage.loads);
        stage.start.copy_from_slice(&from.strains);
        let along = |out: &mut [Twist], at: &[Twist], rates: &[Twist], by: f64| {
            for ((out, at), rate) in out.iter_mut().zip(at).zip(rates) {
                *out = if by == 0.0 { *at } else { *at + *rate * by };
            }
        };
        along(&mut stage.velocity_history, &from.velocities, &from.velocity_rates, carried);
        along(&mut stage.strain_history, &from.strains, &from.strain_rates, carried);
        along(&mut stage.velocities, &from.velocities, &from.velocity_rates, ahead);
        along(&mut stage.strains, &from.strains, &from.strain_rates, ahead);
        let weight = self.base_weight(solver.contacts.touches);
        let base_at = |part: f64| FreeBase::weighted(from, part * h, weight);
        solver.contacts.end_base = None;
        if loads.has_free_base {
            stage.free_base = Some(base_at(self.place));
            solver.contacts.end_base = Some((base_at(1.0), from.velocities[0]));
        } else {
            stage.move_base(loads, from.base, from.time, self.place * h);
        }
        solver.solve(mechanics, &scheme, control)?;
        let stage = &mut solver.stage;
        let mut work = Power::default();
        let power = Power::at(mechanics, stage, &scheme, solver.drag);
        work.add(h, &Power { contacts: solver.contacts.power(stage), ..power });
        let end = |to: &mut [Twist],
                   to_rates: &mut [Twist],
                   from: &[Twist],
                   from_rates: &[Twist],
                   at: &[Twist],
                   history: &[Twist]| {
            for j in 0..to.len() {
                let rate = (at[j] - history[j]) * (1.0 / scheme.g);
                to[j] = from[j] + (at[j] - from[j]) * (1.0 / self.place);
                to_rates[j] = if self.conserves || self.rate_place == 1.0 {
                    rate
                } else {
                    from_rates[j] + (rate - from_rates[j]) * (1.0 / self.rate_place)
                };
            }
        };
        let State { velocities, velocity_rates, strains, strain_rates, .. } = to;
        end(
            velocities,
            velocity_rates,
            &from.velocities,
            &from.velocity_rates,
            &stage.velocities,
            &stage.velocity_history,
        );
        end(
            strains,
            strain_rates,
            &from.strains,
            &from.strain_rates,
            &stage.strains,
            &stage.strain_history,
        );
        if loads.has_free_base {
            to.base = base_at(1.0).pose(to.velocities[0]);
        }
        Ok(work)
    }
}
