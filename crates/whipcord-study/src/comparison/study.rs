//! One case solved by every model that can take it.

use std::time::Duration;

use whipcord::{
    Actuation, Cancel, Case, Model, ModelKind, Robot, Shape, Solution, SolveError, Stations, Vec3,
};
use whipcord_estimation::observation::{Distances, Incomparable, distances};

use crate::describe::driven_by;
use crate::model_benchmark::{Known, KnownAnswers, like_for_like};
use crate::steps;
use crate::timing::{self, TimedSolution, Timing};
use crate::warnings::{Answered, about_file_and_answers};
use whipcord_io::{CaseFile, FileWarning, Measured};
use whipcord_plot::FINE_STATIONS;

/// Distance relative to the backbone's length beyond which an answer is marked as an outlier: what the models are
/// judged by.
pub const FAR: f64 = crate::model_benchmark::recommendation::TOLERANCE;

/// A case and what the models say of it.
#[derive(Clone, Debug)]
pub struct Study {
    /// What the file says.
    pub file: CaseFile,
    /// What the names of the case's own result files begin with.
    pub stem: String,
    /// One for each model and way to drive it, the reference model first.
    pub runs: Vec<Run>,
    /// Warnings about the file and the answers.
    pub warnings: Vec<FileWarning>,
}

/// One model on one case.
#[derive(Clone, Debug)]
pub struct Run {
    /// Which model.
    pub model: ModelKind,
    /// Where its commands come from.
    pub commands: Commands,
    /// What drove it, in words.
    pub driven_by: String,
    /// Its answer, or why it has none.
    pub outcome: Result<Solved, SolveError>,
}

/// Where a run has its commands from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commands {
    /// From the file.
    File,
    /// The shortenings, from hole to hole, of the cables over the Cosserat model's shape: with the
    /// same cable lengths, what is left between two models is their difference.
    CosseratShape,
}

/// An answer.
#[derive(Clone, Debug)]
pub struct Solved {
    /// At the disks; after the last step where there are several.
    pub solution: Solution,
    /// The answers to all steps, the last one included.
    pub answers: Vec<Solution>,
    /// Smooth, for pictures.
    pub fine: Shape,
    /// Whether it is; else it is the shape at the disks, as none was found near it with more stations.
    pub is_smooth: bool,
    /// How long a cold solve takes.
    pub solve: Timing,
    /// How long building the model takes, once for a robot.
    pub build: Timing,
    /// What was measured in space in all steps beside them, or why they cannot be compared; `None` where nothing was.
    pub measured: Option<Result<Distances, Incomparable>>,
}

impl<'a> KnownAnswers<'a> {
    const fn of(solved: &'a Solved) -> Self {
        let Solved { answers, solve, build, .. } = solved;
        Self { answers: answers.as_slice(), solve: *solve, build: *build }
    }
}

impl Solved {
    /// The measurement that the answers to all steps can be compared with.
    pub fn compared(&self) -> Option<&Distances> {
        self.measured.as_ref()?.as_ref().ok()
    }

    /// Where the real robot's disk number `disk`, from 1, was measured in the last step, moved onto this answer
    /// where that was asked for.
    pub fn measured_at(&self, disk: usize) -> Option<Vec3> {
        self.compared()?.disk(self.answers.len().saturating_sub(1), disk)
    }

    /// RMS distance in m of each disk over all steps to the same disk of another answer.
    pub fn distances(&self, other: &Self) -> Vec<f64> {
        let pairs = self.answers.iter().zip(&other.answers);
        let mut steps: Vec<Vec<f64>> =
            pairs.map(|(a, b)| a.disks.distances(&b.disks).collect()).collect();
        let count = steps.len() as f64;
        if steps.len() <= 1 {
            return steps.pop().unwrap_or_default();
        }
        let disks = steps.iter().map(Vec::len).min().unwrap_or(0);
        let squares =
            |disk: usize| -> f64 { steps.iter().map(|apart| apart[disk] * apart[disk]).sum() };
        (0..disks).map(|disk| (squares(disk) / count).sqrt()).collect()
    }
}

impl Run {
    /// Whether the answer to one of the steps is a shape that the robot leaves.
    pub fn is_unstable(&self) -> bool {
        self.outcome.as_ref().is_ok_and(|solved| steps::all_stable(&solved.answers) == Some(false))
    }

    /// Whether the model cannot take the robot or the case, whatever the commands.
    fn is_refused(&self) -> bool {
        matches!(self.outcome, Err(SolveError::Unsupported { .. }))
    }

    /// `four-bar (Cosserat's shortening)`
    pub fn label(&self) -> String {
        match self.commands {
            Commands::File => self.model.to_string(),
            Commands::CosseratShape => format!("{} (Cosserat's shortening)", self.model),
        }
    }
}

impl Study {
    /// Solves the case, one of so many, with these models, until the flag is set.
    pub fn new(
        file: CaseFile,
        stem: String,
        kinds: &[ModelKind],
        cases: usize,
        cancel: &Cancel,
    ) -> Self {
        let budget = timing::budget(cases);
        let CaseFile { robot, case, measured, .. } = &file;
        let run = |kind, case, commands| {
            run(model(kind, cancel), robot, case, commands, measured.as_ref(), budget)
        };
        let mut runs: Vec<Run> =
            kinds.iter().map(|&kind| run(kind, case, Commands::File)).collect();
        // Of geometric models, which take their lengths alone from the case.
        let geometric = kinds
            .iter()
            .copied()
            .filter(|kind| kind.natural_actuation() == Actuation::Shortening)
            .filter(|kind| !runs.iter().any(|run| run.model == *kind && run.is_refused()));
        let like = geometric
            .filter_map(|kind| {
                let answers = cosserat(&runs)?;
                Some((kind, like_for_like(robot, case, answers)?))
            })
            .map(|(kind, case)| {
                self::run(
                    model(kind, cancel),
                    robot,
                    &case,
                    Commands::CosseratShape,
                    measured.as_ref(),
                    budget,
                )
            })
            .collect::<Vec<_>>();
        runs.extend(like);
        let warnings = about_file_and_answers(&file, &answered(&runs, cancel));
        Self { file, stem, runs, warnings }
    }

    /// What the models say of the case as the file gives it, for whom asks for it again.
    pub fn known(&self) -> Vec<Known<'_>> {
        let own = self.runs.iter().filter(|run| run.commands == Commands::File);
        own.map(|run| Known {
            model: run.model,
            outcome: run.outcome.as_ref().map(KnownAnswers::of),
        })
        .collect()
    }

    /// The answers of a model to all steps of the case as the file gives it, where it has them.
    pub fn answers_of(&self, model: ModelKind) -> Option<&[Solution]> {
        let own = |run: &&Run| run.model == model && run.commands == Commands::File;
        Some(&self.runs.iter().find(own)?.outcome.as_ref().ok()?.answers)
    }

    /// The runs with an answer.
    pub fn solved(&self) -> impl Iterator<Item = (&Run, &Solved)> {
        self.runs.iter().filter_map(|run| Some((run, run.outcome.as_ref().ok()?)))
    }

    /// The answer that the others are compared with: that of the first model that has one.
    pub fn reference(&self) -> Option<(&Run, &Solved)> {
        self.solved().next()
    }

    /// Whether a distance in m is too large for the models, or a model and the measurement, to agree.
    pub fn is_far(&self, distance: f64) -> bool {
        distance > FAR * self.file.robot.backbone().length
    }

    /// Whether there is such a distance, of a model to the reference or to the measurement, over all disks or at
    /// one of them.
    pub fn has_outliers(&self) -> bool {
        let disks = self.file.robot.disks().count();
        self.solved().any(|(run, solved)| {
            let compared = solved.compared();
            let to_measured = compared.and_then(Distances::rms);
            let at_disks = (1..=disks).filter_map(|disk| compared?.rms_of_disk(disk));
            let to_reference =
                self.reference().map_or_else(Vec::new, |(_, first)| solved.distances(first));
            let all = self.distance_to_reference(run, solved).into_iter().chain(to_measured);
            all.chain(at_disks).chain(to_reference).any(|distance| self.is_far(distance))
        })
    }

    /// RMS distance in m over the disks and all steps to the reference; `None` for the reference itself.
    pub fn distance_to_reference(&self, run: &Run, solved: &Solved) -> Option<f64> {
        let (first, reference) = self.reference()?;
        let is_first = first.model == run.model && first.commands == run.commands;
        (!is_first).then(|| steps::rms_distance(&solved.answers, &reference.answers))
    }
}

fn run(
    model: Model,
    robot: &Robot,
    case: &Case,
    commands: Commands,
    measured: Option<&Measured>,
    budget: Duration,
) -> Run {
    let kind = model.kind();
    let outcome = timing::solve_within(budget, &model, robot, case).map(|timed| {
        let smooth = model.at(Stations::Equal(FINE_STATIONS));
        let fine = timed.last_shape_at_stations_of(&smooth, robot, case);
        let answers = timed.answers();
        let measured = measured.and_then(|Measured { observations, alignment, .. }| {
            distances(kind, robot, case, &answers, observations, *alignment).transpose()
        });
        let answers = answers.into_iter().cloned().collect();
        let TimedSolution { solution, solve, build, .. } = timed;
        let is_smooth = fine.is_some();
        let fine = fine.unwrap_or_else(|| solution.shape.clone());
        Solved { solution, answers, fine, is_smooth, solve, build, measured }
    });
    let outcome = outcome.map_err(|(_, error)| error);
    Run { model: kind, commands, driven_by: driven_by(kind, Actuation::Natural, case), outcome }
}

/// The Cosserat model's answers to all steps.
fn cosserat(runs: &[Run]) -> Option<&[Solution]> {
    let run = runs.iter().find(|run| run.model == ModelKind::Cosserat)?;
    Some(&run.outcome.as_ref().ok()?.answers)
}

/// The answers to what the file itself asks.
fn answered<'a>(runs: &'a [Run], cancel: &Cancel) -> Vec<Answered<'a>> {
    let own = runs.iter().filter(|run| run.commands == Commands::File);
    own.filter_map(|run| {
        let solved = run.outcome.as_ref().ok()?;
        Some((model(run.model, cancel), solved.answers.iter().collect()))
    })
    .collect()
}

/// The model as it is compared, giving the shape at the disks.
fn model(kind: ModelKind, cancel: &Cancel) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural).cancelled_by(cancel)
}
