//! The derivatives of the forward problem by the unknowns of an inverse problem: those of the model, or by differences.

use std::sync::Arc;

use whipcord::derivatives::{Change, Hold, Place};
use whipcord::differences::differentiate;
use whipcord::{Linearization, Mat3, Solution, SolveError, Twist, Wrench};

use crate::actuator::Actuator;
use crate::evaluation::{Evaluation, Rates};
use crate::forward::Forward;

/// Residual under loads that the derivatives of an evaluation take away: of one near another evaluation, and of one by itself, from which nothing tells how near it is.
/// About its square is left: of a trial near its target far below the tolerance, because the residual at its start goes with the square of the step, too.
const CORRECTED: f64 = 1e-2;
const CORRECTED_ALONE: f64 = 1e-4;

impl Forward {
    /// The answer for these unknowns and its derivatives, from a neighbouring solution when given.
    pub fn evaluate(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<Evaluation, SolveError> {
        self.starting(from, |forward, from| match forward.is_exact {
            true => {
                forward.command(unknowns);
                forward.solves += 1;
                let corrected = if from.is_some() { CORRECTED } else { CORRECTED_ALONE };
                let (solution, changes) =
                    forward.model.solve_with_command_changes(&forward.case, from, corrected)?;
                Ok(forward.with_rates(unknowns, solution, &changes, places))
            }
            false => forward.by_differences(unknowns, places, from),
        })
    }

    /// [`Self::evaluate`] with all the derivatives, where the model has exact ones.
    pub fn evaluate_with_rates(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<(Evaluation, Option<Linearization>), SolveError> {
        self.starting(from, |forward, from| match forward.is_exact {
            true => {
                let found = forward.linearize(unknowns, places, from);
                found.map(|(evaluation, rates)| (evaluation, Some(rates)))
            }
            false => {
                let found = forward.by_differences(unknowns, places, from);
                found.map(|evaluation| (evaluation, None))
            }
        })
    }

    /// [`Self::evaluate`] of a model with exact derivatives, from a neighbouring solution alone, with all the derivatives.
    pub fn linearize(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<(Evaluation, Linearization), SolveError> {
        self.command(unknowns);
        self.solves += 1;
        let (solution, rates) = self.model.solve_with_derivatives(&self.case, from, &[])?;
        let changes = rates.commands();
        Ok((self.with_rates(unknowns, solution, &changes, places), rates))
    }

    /// Motions of the places in the world with a force on the tip along x, y and z of the base, in m/N, the commands held.
    pub fn motions_with_forces(&self, rates: &Linearization, places: &[Place]) -> [Vec<Twist>; 3] {
        let turn = self.case.base.rotation;
        [0, 1, 2].map(|component| {
            let change = rates.wrench(Place::Tip, component, Hold::Commands);
            let motion = |place: &Place| {
                let of = change.twist(*place);
                Twist { linear: turn.rotate(of.linear), angular: turn.rotate(of.angular) }
            };
            places.iter().map(motion).collect()
        })
    }

    /// A solution with its rates by the unknowns, from its changes with the command of each cable.
    fn with_rates(
        &self,
        unknowns: &[f64],
        solution: Solution,
        by_cable: &[Change],
        places: &[Place],
    ) -> Evaluation {
        let turn = self.case.base.rotation;
        let mut evaluation = self.without_rates(solution);
        let mut rates = Rates { at: unknowns.to_vec(), ..Rates::default() };
        for actuator in &self.actuators.list {
            let mut motions = vec![Twist::default(); places.len()];
            let mut tensions = vec![0.0; by_cable.len()];
            let mut lengths = vec![0.0; by_cable.len()];
            let mut base = Wrench::default();
            for (cable, rate) in actuator.cables(self.model.robot()) {
                let change = &by_cable[cable];
                base.force += change.base_wrench().force * rate;
                base.moment += change.base_wrench().moment * rate;
                for (motion, place) in motions.iter_mut().zip(places) {
                    let of = change.twist(*place);
                    motion.linear += turn.rotate(of.linear) * rate;
                    motion.angular += turn.rotate(of.angular) * rate;
                }
                for (sum, of) in tensions.iter_mut().zip(change.tensions()) {
                    *sum += rate * of;
                }
                for (sum, of) in lengths.iter_mut().zip(change.lengths()) {
                    *sum += rate * of;
                }
            }
            self.push_rates(&evaluation.solution, &mut rates, motions, tensions, lengths);
            rates.base_rates.push(base);
        }
        evaluation.rates = Arc::new(rates);
        evaluation
    }

    /// The exact motions of the tip with the unknowns at an answer, beside other rates of it that are nearly its own; `None` where the answers have more than these to
    /// be exact in, or depend on more than tensions.
    pub fn with_exact_tip(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        Evaluation { solution, rates, .. }: &Evaluation,
    ) -> Result<Option<Rates>, SolveError> {
        let cable = |actuator: &Actuator| match *actuator {
            Actuator::Tension(cable) => Some(cable),
            Actuator::Shortening(_) | Actuator::Motor(_) => None,
        };
        let cables: Option<Vec<usize>> = self.actuators.list.iter().map(cable).collect();
        let is_tip = places == [Place::Tip] && self.is_on_few_steps && self.actuators.are_direct();
        let Some(cables) = cables.filter(|_| is_tip) else { return Ok(None) };
        self.command(unknowns);
        self.solves += 1;
        let mut motions = Vec::new();
        self.model.tip_by_commands(&self.case, solution, &mut motions)?;
        let turn = self.case.base.rotation;
        let motion = |&cable: &usize| {
            let Twist { linear, angular } = motions[cable];
            vec![Twist { linear: turn.rotate(linear), angular: turn.rotate(angular) }]
        };
        Ok(Some(Rates {
            at: unknowns.to_vec(),
            motions: cables.iter().map(motion).collect(),
            tension_rates: rates.tension_rates.clone(),
            shortening_rates: rates.shortening_rates.clone(),
            base_rates: rates.base_rates.clone(),
        }))
    }

    /// The translational compliance of the tip in m/N in the world, with the commands held; `None` where the robot is about to buckle.
    pub fn tip_compliance(&self, rates: &Linearization) -> Option<Mat3> {
        let holds_tensions =
            self.actuators.asked.iter().all(|actuator| matches!(actuator, Actuator::Tension(_)));
        let hold = if holds_tensions { Hold::Tensions } else { Hold::Lengths };
        let local = rates.compliance(Place::Tip, hold).ok()?.blocks[0][0];
        let turn = self.case.base.rotation.to_matrix();
        Some(turn * local * turn.transpose())
    }

    /// [`Self::evaluate`] by the model of the answers.
    pub fn evaluate_answer(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
    ) -> Result<Evaluation, SolveError> {
        self.by_verifier(|forward| forward.evaluate(unknowns, places, None))
    }

    /// [`Self::evaluate_with_rates`] by the model of the answers.
    pub fn answer_with_rates(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<(Evaluation, Option<Linearization>), SolveError> {
        self.by_verifier(|forward| forward.evaluate_with_rates(unknowns, places, from))
    }

    /// [`Self::evaluate`] of a model without exact derivatives.
    fn by_differences(
        &mut self,
        unknowns: &[f64],
        places: &[Place],
        from: Option<&Solution>,
    ) -> Result<Evaluation, SolveError> {
        self.command(unknowns);
        self.solves += 1;
        let solution = self.model.solve(&self.case, from)?;
        let mut all = Rates { at: unknowns.to_vec(), ..Rates::default() };
        let mut moved = unknowns.to_vec();
        for k in 0..unknowns.len() {
            let step = 1e-4 * self.scales[k];
            let solve = |h: f64| {
                moved.copy_from_slice(unknowns);
                moved[k] += h;
                self.command(&moved);
                self.solves += 1;
                let near = if self.has_no_memory() { Some(&solution) } else { from };
                self.model.solve(&self.case, near)
            };
            let rates = differentiate(solve, step)?;
            let at = |place: &Place| match *place {
                Place::Station(station) => rates.stations.get(station),
                Place::Disk(disk) => rates.disks.get(disk),
                Place::Tip => rates.disks.last(),
            };
            let motions =
                places.iter().map(|place| at(place).copied().unwrap_or_default()).collect();
            let none = vec![0.0; solution.cables.len()];
            self.push_rates(&solution, &mut all, motions, none, rates.lengths);
        }
        let mut evaluation = self.without_rates(solution);
        evaluation.rates = Arc::new(all);
        Ok(evaluation)
    }

    fn push_rates(
        &self,
        solution: &Solution,
        rates: &mut Rates,
        motions: Vec<Twist>,
        tensions: Vec<f64>,
        mut lengths: Vec<f64>,
    ) {
        let robot = self.model.robot();
        let states = solution.cables.iter().zip(&tensions).enumerate();
        for ((cable, (state, tension)), length) in states.zip(&mut lengths) {
            *length = robot.cable_compliance(cable, state.initial_length) * tension - *length;
        }
        rates.shortening_rates.push(lengths);
        rates.motions.push(motions);
        rates.tension_rates.push(tensions);
    }
}
