//! Benchmark of the models: how far each is from a reference, and how long it takes.

pub mod candidate;
pub mod output;
pub mod picture;
pub mod recommendation;
pub mod reference;
pub mod report;
pub mod results;
pub mod standing;
pub mod summary;
pub mod tables;
#[cfg(test)]
mod tests;

use std::time::Duration;

use whipcord::robot::Route;
use whipcord::{
    Actuation, CableCommand, CableState, Cancel, Case, Model, ModelKind, NoStability, Pose, Robot,
    Shape, Shortening, Solution, SolveError, Stations, at_rest,
};
use whipcord_io::Measured;

use self::candidate::{Candidate, Preset};
use self::reference::{Choice, NoReference, ReferenceAnswers};
use crate::describe::driven_by;
use crate::steps::{all_stable, stability_absent};
use crate::timing::{self, Timing};

/// What the models are tried on.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// For people.
    pub title: &'a str,
    /// What tells it from others: what the names of its own result files begin with.
    pub stem: &'a str,
    /// The robot.
    pub robot: &'a Robot,
    /// What is asked of it.
    pub case: &'a Case,
    /// What the real one did.
    pub measured: Option<&'a Measured>,
    /// What it stands for in a suite.
    pub tags: Option<Tags>,
    /// What models are known to say of it, which is not computed again.
    pub known: &'a [Known<'a>],
}

/// What a model, as it is, says of a case that is given as it is.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Which model.
    pub model: ModelKind,
    /// Its answers, or why it has none.
    pub outcome: Result<KnownAnswers<'a>, &'a SolveError>,
}

/// Answers, and how long they took.
#[derive(Clone, Copy, Debug)]
pub struct KnownAnswers<'a> {
    /// At the disks, to all steps.
    pub answers: &'a [Solution],
    /// As [`Answer::solve`].
    pub solve: Timing,
    /// As [`Answer::build`].
    pub build: Timing,
}

/// What a case of a suite stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tags {
    /// How its cables run.
    pub routing: &'static str,
    /// By how much it is bent, in rad, as the suite counts it.
    pub bending: f64,
    /// What else acts on it.
    pub load_kind: LoadKind,
}

/// What acts on the robot of a case of a suite, beside its cables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadKind {
    /// Nothing.
    None,
    /// A force at the tip.
    TipForce,
    /// A half-space that it leans against.
    Wall,
    /// A sphere that it closes round.
    Ball,
    /// A bore that its lower half is in.
    Pipe,
}

impl LoadKind {
    /// In tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::TipForce => "force at the tip",
            Self::Wall => "wall",
            Self::Ball => "ball",
            Self::Pipe => "pipe",
        }
    }
}

impl Subject<'_> {
    /// Number of sections between disks.
    pub fn sections(&self) -> usize {
        self.robot.disks().count().saturating_sub(1)
    }

    /// What is known of a candidate.
    fn known(&self, candidate: Candidate) -> Option<Result<KnownAnswers<'_>, &SolveError>> {
        let own = self.known.iter().find(|known| known.model == candidate.kind)?;
        (candidate.preset == Preset::Usual).then_some(own.outcome)
    }
}

/// One case, and how the models did on it.
#[derive(Clone, Debug)]
pub struct CaseBenchmark {
    /// For people.
    pub title: String,
    /// What tells it from others.
    pub stem: String,
    /// Number of sections between disks.
    pub sections: usize,
    /// Length of the backbone in m.
    pub length: f64,
    /// What it stands for in a suite.
    pub tags: Option<Tags>,
    /// Whether anything stands in the robot's way.
    pub among_obstacles: bool,
    /// What is measured against, or why there is nothing.
    pub reference: Result<ReferenceAnswers, NoReference>,
    /// One for each candidate.
    pub entries: Vec<Entry>,
}

/// One candidate on one case.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Who.
    pub candidate: Candidate,
    /// Where its commands come from.
    pub commands: Commands,
    /// What drove it, in words.
    pub driven_by: String,
    /// Its answer, or why there is none.
    pub outcome: Result<Answer, SolveError>,
    /// Whether it solves the robot without section, material and stiffness.
    pub without_material: bool,
}

/// Where the commands of an entry come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commands {
    /// From the case.
    Case,
    /// The reference's own: its tensions, and what its cables lose from hole to hole. With them, what is left
    /// between a model and the reference is their difference.
    Reference,
}

/// What an entry is judged by.
#[derive(Clone, Debug)]
pub struct Answer {
    /// How far it is from the reference, or why that cannot be told, in words.
    pub residual: Result<Residual, String>,
    /// A cold solve by a model that is built; of several steps the last one.
    pub solve: Timing,
    /// Building the model, once for a robot.
    pub build: Timing,
    /// Newton iterations.
    pub iterations: usize,
    /// Steps or sections.
    pub steps: usize,
    /// Whether it is stable, in all steps where there are several; `None` where that is not known.
    pub stable: Option<bool>,
    /// Why that is not known.
    pub stability_absent: Option<NoStability>,
}

impl Answer {
    /// Whether the robot leaves this shape, or that of one of the steps.
    pub fn is_unstable(&self) -> bool {
        self.stable == Some(false)
    }
}

/// Distances in m from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Root mean square over the disks without the base, or over the markers, and over all steps.
    pub rms: f64,
    /// The greatest.
    pub greatest: f64,
    /// Of the tip, the root mean square over the steps; `None` where it was not measured.
    pub tip: Option<f64>,
    /// Number of steps that they are over.
    pub steps: usize,
    /// Number of disks or markers, each counted once in each step.
    pub points: usize,
}

impl CaseBenchmark {
    /// Tries all candidates on a case, with repeats for the sake of times as long as the budget lasts; the flag ends their solves.
    pub fn new(
        subject: &Subject,
        candidates: &[Candidate],
        choice: Choice,
        budget: Duration,
        cancel: &Cancel,
    ) -> Self {
        let answers = ReferenceAnswers::new(subject, choice, cancel);
        let reference = answers.as_ref().ok();
        let like = reference
            .and_then(|reference| like_for_like(subject.robot, subject.case, &reference.answers));
        let bare = without_material(subject.robot);
        let entries = candidates
            .iter()
            .map(|&candidate| {
                let model = candidate.model(Stations::Disks, subject.sections());
                let model = model.cancelled_by(cancel);
                let with = (like.as_ref(), bare.as_ref());
                entry(candidate, &model, subject, reference, with, budget)
            })
            .collect();
        Self {
            title: subject.title.to_owned(),
            stem: subject.stem.to_owned(),
            sections: subject.sections(),
            length: subject.robot.backbone().length,
            tags: subject.tags,
            among_obstacles: !subject.case.obstacles.is_empty(),
            reference: answers,
            entries,
        }
    }

    /// The answer of a candidate.
    pub fn answer(&self, candidate: Candidate) -> Option<&Answer> {
        self.entries.iter().find(|entry| entry.candidate == candidate)?.outcome.as_ref().ok()
    }

    /// How far a candidate is from the reference, relative to the length of the backbone.
    pub fn error(&self, candidate: Candidate) -> Option<f64> {
        Some(self.answer(candidate)?.residual.as_ref().ok()?.rms / self.length)
    }
}

fn entry(
    candidate: Candidate,
    model: &Model,
    subject: &Subject,
    reference: Option<&ReferenceAnswers>,
    (like, bare): (Option<&Case>, Option<&Robot>),
    budget: Duration,
) -> Entry {
    let robot = subject.robot;
    let answer = |answers: &[Solution], solve: Timing, build: Timing| {
        let nothing = || Err("there is no reference".to_owned());
        let diagnostics = answers.last().map(|answer| &answer.diagnostics);
        Answer {
            residual: reference.map_or_else(nothing, |r| r.residual(subject, answers)),
            solve,
            build,
            iterations: diagnostics.map_or(0, |of| of.iterations),
            steps: diagnostics.map_or(0, |of| of.steps),
            stable: all_stable(answers),
            stability_absent: stability_absent(answers),
        }
    };
    let solve = |case: &Case| {
        let timed = timing::solve_within(budget, model, robot, case);
        let timed = timed.map_err(|(_, error)| error)?;
        let answers: Vec<Solution> = timed.answers().into_iter().cloned().collect();
        Ok(answer(&answers, timed.solve, timed.build))
    };
    let of_case = || match subject.known(candidate) {
        Some(Ok(KnownAnswers { answers, solve, build })) => Ok(answer(answers, solve, build)),
        Some(Err(error)) => Err(error.clone()),
        None => solve(subject.case),
    };
    let as_given = || (Commands::Case, subject.case, of_case());
    let as_reference = |case| (Commands::Reference, case, solve(case));
    // A geometric model is given the reference's lengths: its own, where the case has any, were measured or
    // chosen for other reasons. A model that knows forces gets the reference's only where the case has none for it.
    let (commands, case, outcome) = match (candidate.kind.natural_actuation(), like) {
        (Actuation::Shortening, Some(like)) => as_reference(like),
        (_, like) => match (as_given(), like) {
            ((_, _, Err(SolveError::Missing { .. })), Some(like)) => as_reference(like),
            (given, _) => given,
        },
    };
    let without_material = bare.is_some_and(|bare| {
        model.prepare(bare, &case.loads).is_ok_and(|mut model| model.solve(case, None).is_ok())
    });
    let driven_by = driven_by(candidate.kind, Actuation::Natural, case);
    Entry { candidate, commands, driven_by, outcome, without_material }
}

/// The robot as a geometric model sees it. `None` where a robot cannot be without them.
fn without_material(robot: &Robot) -> Option<Robot> {
    let mut backbone = robot.backbone().clone();
    backbone.section = None;
    backbone.material = Default::default();
    backbone.stiffness = None;
    Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).ok()
}

/// The case in which, step by step, every cable has the tension of an answer and loses as much, from hole to hole, as
/// over its shape. The answers are those to all steps. `None` when there are no cables, or one ends between two disks.
pub fn like_for_like(robot: &Robot, case: &Case, answers: &[Solution]) -> Option<Case> {
    if robot.cables().is_empty() {
        return None;
    }
    let rest = if robot.backbone().rest_curvature.is_zero() {
        Shape::straight(&robot.disks().arc_lengths)
    } else {
        at_rest(robot, Pose::IDENTITY, &Stations::Disks)?.disks
    };
    let commands = |solution: &Solution| -> Option<Vec<CableCommand>> {
        let cables = robot.routes().iter().zip(&solution.cables);
        let command = |(route, cable): (&Route, &CableState)| {
            let (initial, now) =
                (rest.hole_to_hole_length(route)?, solution.disks.hole_to_hole_length(route)?);
            let shortening = Shortening::Fraction(1.0 - now / initial);
            Some(CableCommand { tension: cable.tension, shortening: Some(shortening) })
        };
        cables.map(command).collect()
    };
    let mut steps = answers.iter().map(commands).collect::<Option<Vec<_>>>()?;
    let commands = steps.pop()?;
    Some(Case { commands, before: steps, ..case.clone() })
}
