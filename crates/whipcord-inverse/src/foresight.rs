//! Where the search for the next point of a path starts: where the derivatives at the point before lead.

use crate::descent::{FIRST_DAMPING, FIRST_RADIUS, Problem, Region, Workspace};
use crate::predicted::Predicted;
use crate::redundancy::Task;
use crate::search::{Candidate, Learned, Search};
use crate::target::Target;

/// Where a path has come to.
#[derive(Clone, Debug)]
pub(crate) struct Passed {
    pub at: Candidate,
    target: Target,
    learned: Learned,
}

impl Passed {
    /// What the next point of a path goes on from, with what the search for this one has learned.
    pub fn new(at: Candidate, target: &Target, learned: Learned) -> Self {
        Self { at, target: target.clone(), learned }
    }

    /// Goes on to the target of a search, where that is of the same kind: gives it what is known from here, and returns where the derivatives lead, with one step along
    /// the null space to what is preferred.
    pub fn predicted(
        &self,
        search: &mut Search<'_>,
        task: &Task<'_>,
        workspace: &mut Workspace,
    ) -> Option<Predicted> {
        let Self { at, target, learned } = self;
        let is_known = search.is_smooth() && target.is_like(search.target);
        let rates = &at.evaluation.rates;
        if !is_known || rates.motions.is_empty() {
            return None;
        }
        // Of the answer, not of a trial: nothing is to be corrected.
        let linear = search.linearize(&at.evaluation);
        let control = task.control;
        let penalty = linear.penalty();
        let region = Region { damping: FIRST_DAMPING, radius: FIRST_RADIUS };
        workspace.step(&linear, &[], &at.unknowns, control, region, penalty).ok()?;
        let (left, violation) = workspace.left();
        let mut moved = at.unknowns.clone();
        for ((x, d), scale) in moved.iter_mut().zip(workspace.last_step()).zip(control.scales) {
            *x += d * scale;
        }
        let changes = moved.iter().zip(&at.unknowns).map(|(moved, x)| moved - x);
        let near = at.evaluation.extrapolated(changes, search.forward.is_on_few_steps());
        let mut there = at.clone();
        there.evaluation.tensions = near.cables.iter().map(|cable| cable.tension).collect();
        there.unknowns.clone_from(&moved);
        if let Some(along) = search.along_null_space(&there, task, FIRST_RADIUS) {
            moved.iter_mut().zip(along).for_each(|(x, d)| *x += d);
        }
        search.take(learned.clone());
        let size = |a: &[f64], b: &[f64]| {
            let steps = a.iter().zip(b).zip(control.scales);
            steps.fold(0.0, |most: f64, ((a, b), scale)| most.max((a - b).abs() / scale))
        };
        Some(Predicted {
            sizes: [size(&moved, &at.unknowns), size(&at.unknowns, &rates.at)],
            distance: (violation == 0.0).then_some(left),
            unknowns: moved,
        })
    }
}
