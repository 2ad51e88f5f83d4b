//! How each span between two disks leads on, for every pair of holes.
//!
//! Without load no wrench acts on a cut of rod and cables, so that the shape of a span hangs on its own holes and tensions alone, eq. (1): the pose
//! of a disk in the frame of the one before is tabulated, and shapes are products of these poses.

use whipcord::{Model, ModelKind, Pose, Robot, StabilityAnalysis, Stations};

use crate::candidates::solve_lists;
use crate::choices::Choices;
use crate::error::DesignError;
use crate::goal::ShapeGoal;

/// Poses of each disk in the frame of the disk before.
#[derive(Clone, Debug)]
pub(crate) struct SpanTable {
    count: usize,
    spans: usize,
    /// Of each goal, span and pair of combinations; `None` where the model has no answer.
    poses: Vec<Option<Pose>>,
    /// Of the first disk of each goal.
    pub bases: Vec<Pose>,
}

/// Lists that are solved for a table.
const MOST: usize = 30_000;

/// Whether the spans of a robot are independent of one another.
pub(crate) fn is_sequential(model: &Model, robot: &Robot, goals: &[ShapeGoal]) -> bool {
    let has_spans = matches!(
        model.kind(),
        ModelKind::CosseratDisks
            | ModelKind::PiecewiseConstantCurvature
            | ModelKind::PseudoRigidBody
    );
    let is_free = |goal: &ShapeGoal| {
        goal.case.loads.is_none()
            && goal.case.obstacles.is_empty()
            && goal.case.commands.iter().all(|command| command.tension.is_some())
    };
    has_spans && !robot.has_history() && goals.iter().all(is_free)
}

impl SpanTable {
    /// Solves robots whose lists of holes together have every pair of combinations at every span once: those that move on by the same number of
    /// holes from disk to disk.
    pub fn new(
        model: &Model,
        robot: &Robot,
        choices: &Choices,
        goals: &[ShapeGoal],
    ) -> Result<Self, DesignError> {
        let model = model.at(Stations::Disks).with_stability(StabilityAnalysis::Off);
        let (count, disks) = (choices.count, robot.disks().count());
        let spans = disks - 1;
        let moved = |start: usize, step: usize, disk: usize| {
            choices.combined(|place| {
                (choices.hole(start, place) + disk * choices.hole(step, place)) % choices.holes
            })
        };
        let list = |start: usize, step: usize| -> Vec<usize> {
            (0..disks).map(|disk| moved(start, step, disk)).collect()
        };
        let is_asked = |list: &[usize]| {
            let mut pairs = list.windows(2).enumerate();
            pairs.any(|(span, pair)| {
                choices.at(span).binary_search(&pair[0]).is_ok()
                    && choices.after(pair[0], span + 1).any(|next| next == pair[1])
            })
        };
        let lists: Vec<Vec<usize>> = (0..count)
            .flat_map(|start| (0..count).map(move |step| (start, step)))
            .map(|(start, step)| list(start, step))
            .filter(|list| is_asked(list))
            .take(MOST + 1)
            .collect();
        if lists.len() > MOST {
            return Err(DesignError::TooManySpans { spans: choices.pairs(), most: MOST });
        }
        let mut table = Self {
            count,
            spans,
            poses: vec![None; goals.len() * spans * count * count],
            bases: Vec::with_capacity(goals.len()),
        };
        for (number, goal) in goals.iter().enumerate() {
            let mut base = None;
            let mut refusal = None;
            let mut failed = Vec::new();
            solve_lists(&model, robot, choices, &goal.case, &lists, |of, answer| match answer {
                Ok(solution) => {
                    base = Some(solution.disks.poses[0]);
                    table.take(number, &lists[of], &solution.disks.poses);
                }
                Err(error) => {
                    refusal.get_or_insert_with(|| error.clone());
                    failed.push(of);
                }
            })?;
            // A list fails with one of its spans: each pair once more among spans that are straight on.
            let single: Vec<Vec<usize>> = failed
                .iter()
                .flat_map(|&of| {
                    let list = &lists[of];
                    (0..spans).map(move |span| {
                        (0..disks)
                            .map(|disk| if disk <= span { list[span] } else { list[span + 1] })
                            .collect()
                    })
                })
                .take(MOST)
                .collect();
            solve_lists(&model, robot, choices, &goal.case, &single, |of, answer| {
                if let Ok(solution) = answer {
                    base = Some(solution.disks.poses[0]);
                    table.take(number, &single[of], &solution.disks.poses);
                }
            })?;
            match (base, refusal) {
                (Some(base), _) => table.bases.push(base),
                (None, Some(error)) => return Err(DesignError::NoAnswer(error)),
                (None, None) => return Err(DesignError::NoChoice { disk: 0 }),
            }
        }
        Ok(table)
    }

    fn take(&mut self, goal: usize, list: &[usize], poses: &[Pose]) {
        for (span, (pair, poses)) in list.windows(2).zip(poses.windows(2)).enumerate() {
            let at = self.place(goal, span, pair[0], pair[1]);
            self.poses[at] = Some(poses[0].inverse() * poses[1]);
        }
    }

    const fn place(&self, goal: usize, span: usize, from: usize, to: usize) -> usize {
        ((goal * self.spans + span) * self.count + from) * self.count + to
    }

    /// The pose of the disk behind a span in the frame of the disk before it.
    pub fn span(&self, goal: usize, span: usize, from: usize, to: usize) -> Option<Pose> {
        self.poses[self.place(goal, span, from, to)]
    }
}
