//! Courses of shapes that the page plays: the steps of the file, and its motion over time.

use std::sync::Arc;
use std::time::Duration;

use whipcord::{Cancel, Case, ModelKind, ModelPreset, Shape};
use whipcord_io::CaseFile;
use whipcord_motion::{MotionError, Simulation, State};

use crate::answer::{Refusal, of_shape};
use crate::background::Tell;
use crate::bench::Bench;
use crate::courses::intervals;
use crate::holes::with_holes;
use crate::loads::acting;
use crate::protocol::{
    Acting, Answer, CableState, Course, Moment, PlayRequest, Request, ToPage, Track,
};
use crate::scene::initial_lengths;
use crate::stations::Places;

/// Shapes of a motion that are told of at once.
const PART: usize = 16;
/// How long each model may take for all steps.
const LIMIT: Duration = Duration::from_secs(600);

/// Solves a course and tells of it; nothing more where it is cancelled.
pub fn play(file: &Arc<CaseFile>, asked: &PlayRequest, cancel: &Cancel, tell: &Tell) {
    let PlayRequest { course, request } = asked;
    let to_page = Part { id: request.id, course: *course, tell };
    let outcome = with_holes(file, &request.holes).and_then(|file| {
        let mut bench = Bench::new(Arc::clone(&file));
        match course {
            Course::Steps => steps(&file, &mut bench, request, cancel, &to_page),
            Course::Motion => motion(&file, &bench, request, cancel, &to_page),
        }
    });
    if let Err(message) = outcome
        && !cancel.is_cancelled()
    {
        to_page.send(0, Vec::new(), Some(message));
    }
}

/// What parts of one course have in common.
struct Part<'a> {
    id: u64,
    course: Course,
    tell: &'a Tell,
}

impl Part<'_> {
    /// The last shapes of a course, or why there are no more.
    fn send(&self, from: usize, moments: Vec<Moment>, message: Option<String>) {
        self.tell_of(from, moments, true, message);
    }

    /// Whether somebody listens.
    fn tell_of(
        &self,
        from: usize,
        moments: Vec<Moment>,
        complete: bool,
        message: Option<String>,
    ) -> bool {
        let Self { id, course, tell } = *self;
        let part = Track { id, course, from, moments, complete, message };
        tell.blocking_send(ToPage::Track(part)).is_ok()
    }
}

/// What acted on the robot at the last shape.
#[derive(Default)]
struct Acts(Option<Acting>);

impl Acts {
    /// The same as is given, if it has changed.
    fn changed(&mut self, acting: Acting) -> Option<Acting> {
        let is_new = self.0.as_ref() != Some(&acting);
        is_new.then(|| self.0.insert(acting).clone())
    }
}

fn steps(
    file: &CaseFile,
    bench: &mut Bench,
    request: &Request,
    cancel: &Cancel,
    part: &Part<'_>,
) -> Result<(), Refusal> {
    let presets = request.presets().map_err(|error| error.to_string())?;
    bench.cancelled_by(cancel, LIMIT);
    let case = bench.case(request)?;
    let count = case.before.len() + 1;
    let length = file.robot.backbone().length;
    let mut acts = Acts::default();
    let mut all: Vec<Moment> = (0..count)
        .map(|k| {
            let loads = case.loads_before.get(k).unwrap_or(&case.loads);
            let acting = acts.changed(acting(loads, length));
            Moment { time: k as f64, answers: Vec::new(), acting }
        })
        .collect();
    for preset in presets {
        let failed = |message| Answer::Failed { model: preset.name().to_owned(), message };
        let answers = match bench.steps(preset, &case) {
            Ok(answers) => answers,
            Err(message) => vec![failed(message); count],
        };
        for (moment, answer) in all.iter_mut().zip(answers) {
            moment.answers.push(answer);
        }
    }
    if !cancel.is_cancelled() {
        part.send(0, all, None);
    }
    Ok(())
}

fn motion(
    file: &CaseFile,
    bench: &Bench,
    request: &Request,
    cancel: &Cancel,
    part: &Part<'_>,
) -> Result<(), Refusal> {
    let words = |error: MotionError| error.to_string();
    let (every, steps, rows) =
        intervals(file).ok_or_else(|| "the file has no [motion]".to_owned())?;
    let case = Case { before: Vec::new(), loads_before: Vec::new(), ..bench.case(request)? };
    let commands = file.motion.commands(&file.robot, &case);
    let options = file.motion.options();
    let length = file.robot.backbone().length;
    let mut acts = Acts::default();
    let mut simulation =
        Simulation::with_commands(&file.robot, &case, &commands, options.clone()).map_err(words)?;
    let nodes: Vec<f64> = simulation.arc_lengths().collect();
    let places = Places::of(&file.robot);
    let initial = initial_lengths(&file.robot, &places);
    let mut moment = |state: &State| {
        let shape = Shape { arc_length: nodes.clone(), poses: state.poses.clone() };
        let answer = solved(file, &places, &shape, state, &initial);
        let loads = options.loads_at(&case.loads, length, state.time).map_err(words)?;
        let acting = acts.changed(acting(&loads, length));
        Ok::<_, Refusal>(Moment { time: state.time, answers: vec![answer], acting })
    };
    let (mut from, mut ready) = (0, vec![moment(simulation.state())?]);
    for row in 1..=rows {
        for k in 1..=steps {
            if cancel.is_cancelled() {
                return Ok(());
            }
            // From the start, so that rounding does not add up.
            let end = every * ((row - 1) as f64 + k as f64 / steps as f64);
            let dt = end - simulation.state().time;
            if let Err(error) = simulation.step(&commands, dt) {
                part.send(from, ready, Some(error.to_string()));
                return Ok(());
            }
        }
        ready.push(moment(simulation.state())?);
        if ready.len() >= PART && row < rows {
            let shapes = std::mem::take(&mut ready);
            let told = shapes.len();
            if !part.tell_of(from, shapes, false, None) {
                return Ok(());
            }
            from += told;
        }
    }
    part.send(from, ready, None);
    Ok(())
}

/// A state of the motion as an answer of the rod that it is of.
fn solved(
    file: &CaseFile,
    places: &Places,
    moving: &Shape,
    state: &State,
    initial: &[f64],
) -> Answer {
    let cables = state.cables.iter().zip(initial).map(|(cable, &initial_length)| CableState {
        tension: Some(cable.tension),
        length: cable.length,
        initial_length,
        shortening: initial_length - cable.length,
        slack: cable.slack > 0.0,
        span_tensions: Vec::new(),
    });
    let model = ModelPreset::usual(ModelKind::Cosserat).name().to_owned();
    let iterations = state.diagnostics.iterations;
    of_shape(&file.robot, model, &places.along(moving), cables.collect(), iterations)
}
