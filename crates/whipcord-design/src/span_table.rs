//! How each span between two disks leads on, for every pair of holes.
//!
//! Without load no wrench acts on a cut of rod and cables, so that the shape of a span hangs on its own holes and tensions alone, eq. (1): the pose
//! of a disk in the frame of the one before is tabulated, and shapes are products of these poses.

use core::f64::consts::TAU;

use whipcord::{Model, ModelKind, Pose, Robot, StabilityAnalysis, Stations, UnitQuaternion, Vec3};

use crate::budget::Budget;
use crate::candidates::solve_lists;
use crate::choices::Choices;
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::route::is_axisymmetric;

/// Poses of each disk in the frame of the disk before.
#[derive(Clone, Debug)]
pub(crate) struct SpanTable {
    pairs: usize,
    spans: usize,
    /// Of each goal, span and pair of combinations; `None` where the model has no answer.
    poses: Vec<Option<Pose>>,
    /// The positions of these poses, axis by axis, so that those behind one combination are compared together.
    positions: [Vec<f64>; 3],
    /// Of each span and pair zero, or infinity where the pair is not allowed there or the model has no answer under one of the goals.
    obstacles: Vec<f64>,
    /// Of the first disk of each goal.
    pub bases: Vec<Pose>,
}

/// Lists that are solved for a table.
const MOST: usize = 30_000;
/// Poses that a table may have.
const MOST_POSES: usize = 8_000_000;

/// Solves without load that take as long as one of a robot under loads.
const CHEAPER: usize = 10;

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

/// Whether a robot whose varied cables all move on by the same number of holes has the same shape, rotated: the backbone is straight at rest and bends as
/// easily in all directions, and no other cable pulls.
fn is_rotatable(robot: &Robot, choices: &Choices, goal: &ShapeGoal) -> bool {
    let commands = goal.case.commands.iter().enumerate();
    let mut others = commands.filter(|(cable, _)| !choices.cables.contains(cable));
    others.all(|(_, command)| command.tension == Some(0.0)) && is_axisymmetric(robot)
}

impl SpanTable {
    /// Solves robots whose lists of holes together have every pair of combinations at every span once: those that move on by the same number of
    /// holes from disk to disk. Of robots that can be rotated, only those with the first hole for the first cable at the first disk.
    pub fn new(
        model: &Model,
        robot: &Robot,
        choices: &Choices,
        (goals, budget): (&[ShapeGoal], &Budget),
    ) -> Result<Self, DesignError> {
        let model = model.at(Stations::Disks).with_stability(StabilityAnalysis::Off);
        let disks = robot.disks().count();
        let spans = disks - 1;
        let pairs = choices.pairs();
        let size = goals.len().saturating_mul(spans).saturating_mul(pairs);
        if size > MOST_POSES {
            return Err(DesignError::TooManySpans { spans: size, most: MOST_POSES });
        }
        let mut table = Self {
            pairs,
            spans,
            poses: vec![None; size],
            positions: [const { Vec::new() }; 3],
            obstacles: vec![f64::INFINITY; spans * pairs],
            bases: Vec::with_capacity(goals.len()),
        };
        let mut known: [Option<Vec<Vec<usize>>>; 2] = [None, None];
        for (number, goal) in goals.iter().enumerate() {
            let is_rotatable = is_rotatable(robot, choices, goal);
            let lists = match &mut known[usize::from(is_rotatable)] {
                Some(lists) => lists,
                none => none.insert(lists(choices, disks, is_rotatable)?),
            };
            let turns = if is_rotatable { choices.holes } else { 1 };
            let mut base = None;
            let mut refusal = None;
            let mut failed = Vec::new();
            let by = (&goal.case, budget);
            let solved =
                solve_lists(&model, robot, choices, by, lists, |of, answer| match answer {
                    Ok(solution) => {
                        base = Some(solution.disks.poses[0]);
                        table.take(number, choices, turns, &lists[of], &solution.disks.poses);
                    }
                    Err(error) => {
                        refusal.get_or_insert_with(|| error.clone());
                        failed.push(of);
                    }
                })?;
            budget.spend(solved.div_ceil(CHEAPER));
            if solved < lists.len() {
                return Err(DesignError::Ended);
            }
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
            let solved = solve_lists(&model, robot, choices, by, &single, |of, answer| {
                if let Ok(solution) = answer {
                    base = Some(solution.disks.poses[0]);
                    table.take(number, choices, turns, &single[of], &solution.disks.poses);
                }
            })?;
            budget.spend(solved.div_ceil(CHEAPER));
            if solved < single.len() {
                return Err(DesignError::Ended);
            }
            match (base, refusal) {
                (Some(base), _) => table.bases.push(base),
                (None, Some(error)) => return Err(DesignError::NoAnswer(error)),
                (None, None) => return Err(DesignError::NoChoice { disk: 0 }),
            }
        }
        table.arrange(choices);
        Ok(table)
    }

    /// Positions axis by axis, and which pairs can be taken.
    fn arrange(&mut self, choices: &Choices) {
        let position = |pose: &Option<Pose>| pose.map_or(Vec3::ZERO, |pose| pose.position);
        self.positions =
            [0, 1, 2].map(|axis| self.poses.iter().map(|pose| position(pose)[axis]).collect());
        for span in 0..self.spans {
            for from in 0..choices.count {
                for (pair, _) in choices.pairs_after(from, span + 1) {
                    let of_goal = |goal| self.span(goal, span, pair).is_some();
                    if (0..self.bases.len()).all(of_goal) {
                        self.obstacles[span * self.pairs + pair] = 0.0;
                    }
                }
            }
        }
    }

    /// For pairs of a span, by their numbers, the weighted sums of the squares of the distances from points of some goals, in the frames of the disk before; infinite for pairs
    /// that cannot be taken.
    pub fn distances(
        &self,
        span: usize,
        pairs: core::ops::Range<usize>,
        points: &[(usize, Vec3, f64)],
        into: &mut Vec<f64>,
    ) {
        let first = span * self.pairs;
        into.clear();
        into.extend_from_slice(&self.obstacles[first + pairs.start..first + pairs.end]);
        for &(goal, point, weight) in points {
            let first = self.place(goal, span, pairs.start);
            let [x, y, z] =
                [0, 1, 2].map(|axis: usize| &self.positions[axis][first..first + pairs.len()]);
            for (((sum, x), y), z) in into.iter_mut().zip(x).zip(y).zip(z) {
                let off = [x - point[0], y - point[1], z - point[2]];
                *sum += weight * (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
            }
        }
    }

    /// Whether a pair of combinations can be taken at a span under all goals.
    pub fn is_possible(&self, span: usize, pair: usize) -> bool {
        self.obstacles[span * self.pairs + pair] == 0.0
    }

    /// Takes the spans of a list, and of the list with all cables up to so many holes on.
    fn take(
        &mut self,
        goal: usize,
        choices: &Choices,
        turns: usize,
        list: &[usize],
        poses: &[Pose],
    ) {
        for (span, (pair, poses)) in list.windows(2).zip(poses.windows(2)).enumerate() {
            let pose = poses[0].inverse() * poses[1];
            for turn in 0..turns {
                let [from, to] = [0, 1].map(|k| choices.rotated(pair[k], turn));
                let Some(pair) = choices.pair(from, to) else { continue };
                #[allow(clippy::cast_precision_loss, reason = "few holes")]
                let angle = TAU * turn as f64 / choices.holes as f64;
                let rotation = UnitQuaternion::exp(Vec3::new(0.0, 0.0, angle));
                let rotated = Pose {
                    position: rotation.rotate(pose.position),
                    rotation: rotation * pose.rotation * rotation.conjugate(),
                };
                let at = self.place(goal, span, pair);
                self.poses[at] = Some(if turn == 0 { pose } else { rotated });
            }
        }
    }

    const fn place(&self, goal: usize, span: usize, pair: usize) -> usize {
        (goal * self.spans + span) * self.pairs + pair
    }

    /// The pose of the disk behind a span in the frame of the disk before it, by the number of the pair of combinations.
    pub fn span(&self, goal: usize, span: usize, pair: usize) -> Option<&Pose> {
        self.poses[self.place(goal, span, pair)].as_ref()
    }
}

/// Lists that together have each pair of combinations that the rules allow at each span, up to a common rotation where that is asked.
fn lists(
    choices: &Choices,
    disks: usize,
    up_to_rotation: bool,
) -> Result<Vec<Vec<usize>>, DesignError> {
    let count = choices.count;
    let moved = |start: usize, step: usize, disk: usize| {
        choices.combined(|place| {
            (choices.hole(start, place) + disk * choices.hole(step, place)) % choices.holes
        })
    };
    let is_asked = |list: &[usize]| {
        let mut pairs = list.windows(2).enumerate();
        pairs.any(|(span, pair)| {
            choices.pair(pair[0], pair[1]).is_some()
                && (up_to_rotation
                    || choices.at(span).binary_search(&pair[0]).is_ok()
                        && choices.at(span + 1).binary_search(&pair[1]).is_ok())
        })
    };
    let starts = (0..count).filter(|&start| !up_to_rotation || choices.hole(start, 0) == 0);
    let lists: Vec<Vec<usize>> = starts
        .flat_map(|start| (0..count).map(move |step| (start, step)))
        .map(|(start, step)| (0..disks).map(|disk| moved(start, step, disk)).collect())
        .filter(|list: &Vec<usize>| is_asked(list))
        .take(MOST + 1)
        .collect();
    if lists.len() > MOST {
        return Err(DesignError::TooManySpans { spans: choices.pairs(), most: MOST });
    }
    Ok(lists)
}
