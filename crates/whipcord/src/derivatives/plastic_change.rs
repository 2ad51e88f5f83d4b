//! What friction against bending keeps of an answer, and how that changes with the parameters.

use super::column::{Raw, Source};
use super::effect::{Effect, Forcing};
use super::forward::StepMap;
use super::linear::Linear;
use super::node_change::NodeChange;
use super::of_answer::Solved;
use super::rod::Derivatives;
use super::sliding_holes::Cause;
use super::step_ends::StepEnds;
use super::strands::PLACES;
use crate::robot::Robot;
use crate::section::{Fault, Strain};
use crate::statics::grid::Grid;
use crate::statics::hold::Hold;
use crate::statics::plastic_curvature::PlasticCurvature;

/// The plastic curvature that an answer leaves.
pub(crate) fn plastic_left(solved: &Solved<'_>) -> Result<PlasticCurvature, Fault> {
    let Solved { grid, cables, .. } = *solved;
    let straight = cables.straight.map(|straight| (straight.spans, solved.nodes));
    let answer = solved.answer();
    let linear = Linear::of(&answer, straight)?;
    let ends = StepEnds::new(&linear, &answer, grid)?;
    Ok(PlasticCurvature::left(grid, &ends.strains(&linear)))
}

impl Derivatives {
    /// The plastic curvature that the answer leaves, and how it changes with each parameter while the commands are held.
    pub(crate) fn plastic_left(
        &self,
        robot: &Robot,
        grid: &Grid,
    ) -> (PlasticCurvature, Vec<PlasticCurvature>) {
        let Some(ends) = &self.ends else { return Default::default() };
        let strains = ends.strains(&self.linear);
        let of_parameter = |p: usize| {
            let source = Source::Parameter(p);
            let (raw, [tensions, _]) = self.completing(source, Hold::Commands, Cause::Parameter(p));
            let behind = self.strains(&raw, source, &tensions);
            let values = (0..grid.len()).map(|k| {
                let changes = [behind[k], self.arriving_strain(ends, k, p, &raw, &tensions)];
                core::array::from_fn(|end| {
                    let step = &grid.steps[k];
                    let s = step.start + end as f64 * step.length;
                    let inside = step.start + 0.5 * step.length;
                    let section = &grid.at_end(k, end).section;
                    let change = self.partials[p].friction_change(robot, section, (s, inside));
                    change.left(section, strains[k][end].angular, changes[end].angular)
                })
            });
            PlasticCurvature::new(grid, values.collect())
        };
        let changes = (0..self.partials.len()).map(of_parameter).collect();
        (PlasticCurvature::left(grid, &strains), changes)
    }

    /// How the strain in front of the end of a step changes with a parameter and with the tensions of all strands.
    fn arriving_strain(
        &self,
        ends: &StepEnds,
        k: usize,
        p: usize,
        raw: &Raw,
        tensions: &[f64],
    ) -> Strain {
        let NodeChange { turn, moment, force, .. } = raw.nodes[k];
        let (map, mut acting): (&StepMap, Effect) = match self.linear.spans() {
            Some(spans) => spans.rod_step(k, p),
            None => {
                let effect = self.maps.effects_of(k)[self.strands.inputs() + p];
                (self.elimination.map(k), effect)
            }
        };
        let mut forcing: Forcing = self.partials[p].at_end(k);
        if self.linear.spans().is_none() {
            let effects = self.maps.effects_of(k);
            for (strand, &tension) in tensions.iter().enumerate() {
                if let Some(input) = self.strands.input(k, strand) {
                    acting = acting.plus(&effects[input].times(tension));
                }
            }
            let pulls = ends.pulls(k, self.steps[k].active);
            for (cable, (pull, _)) in pulls.iter().enumerate() {
                let tension = self.strands.tension((k, cable), PLACES - 1, tensions);
                forcing.force_balance += tension * pull.linear;
                forcing.moment_balance += tension * pull.angular;
            }
        }
        let Effect { turn, moment, force, .. } = map.apply([turn, moment, force]).plus(&acting);
        let change = NodeChange { turn, moment, force, ..NodeChange::default() };
        ends.stage(k).strain_change(&change, &forcing)
    }
}
