//! A robot file, read.

use std::io::Read;
use std::path::{Path, PathBuf};

use whipcord::robot::limits;
use whipcord::{CableCommand, Case, Pose, Problem, Robot, SolveError};
use whipcord_estimation::identification::{Experiment, RowLabel};
use whipcord_motion::MotionError;

use crate::check::{self, Fields};
use crate::error::{FileError, FileProblem, Problems};
use crate::files;
use crate::node::{Node, Value};
use crate::overlay::take_out;
use crate::read::{self, CommandTable, Fit, Goal, Measured, Motion, Reference};
use crate::schema::{DURATION, ROOT};
use crate::settings;
use crate::source::Sources;
use crate::validate::{Parts, assemble, motion_refusal, refusal};

/// A robot and what is asked of it, as a file describes them.
#[derive(Clone, Debug)]
pub struct CaseFile {
    /// What the file describes; the file's name where it does not say.
    pub title: String,
    /// The robot.
    pub robot: Robot,
    /// What is asked of it.
    pub case: Case,
    /// The table whose rows are the steps of the case, where there is one.
    pub commands: Option<CommandTable>,
    /// What the real robot did, where it was measured.
    pub measured: Option<Measured>,
    /// What others have published for this case.
    pub reference: Option<Reference>,
    /// What is to be estimated.
    pub fit: Option<Fit>,
    /// What is to be reached, and within which limits.
    pub goal: Goal,
    /// How it moves over time.
    pub motion: Motion,
    /// The file it was read from.
    pub path: PathBuf,
    document: Node,
    sources: Sources,
}

impl CaseFile {
    /// What the file and those that it extends say together.
    pub(crate) fn document(&self) -> &Node {
        &self.document
    }

    /// The files that it was read from: itself, those that it extends, and what they name.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.sources.files().iter().enumerate();
        files.filter(|(i, _)| !self.sources.is_setting(*i)).map(|(_, source)| source.path.as_path())
    }

    /// The texts that it was read from.
    pub(crate) fn sources(&self) -> &Sources {
        &self.sources
    }

    /// The text of the file itself.
    pub(crate) fn text(&self) -> Option<&str> {
        self.sources.get(0)?.text.as_deref()
    }

    /// The same file with keys that are set beside it, as [`load_with`] has them.
    ///
    /// # Errors
    /// [`FileError`] with all that is wrong, where, and what to do about it.
    pub fn with_settings(&self, settings: &[String]) -> Result<Self, FileError> {
        let (mut sources, mut problems) = (self.sources.clone(), Problems::default());
        let mut document = self.document.clone();
        settings::apply(&mut document, settings, &mut sources, &mut problems);
        match read(document, &self.path, &mut sources, &mut problems) {
            Some(file) if problems.is_empty() => Ok(Self { sources, ..file }),
            _ => Err(problems.into_error(sources)),
        }
    }

    /// What a model that refuses the robot or the case says, with its place in the file. `None`
    /// where nothing in the file is at fault: when a solve failed, or an option is refused.
    #[must_use]
    pub fn locate(&self, error: &SolveError) -> Option<FileError> {
        let diagnostic = refusal(error, &self.document)?;
        Some(FileError { problems: vec![diagnostic], more: 0, sources: self.sources.clone() })
    }

    /// The same of a motion that refuses the robot, the case or the loads over time.
    #[must_use]
    pub fn locate_motion(&self, error: &MotionError) -> Option<FileError> {
        let diagnostic = motion_refusal(error, &self.document)?;
        Some(FileError { problems: vec![diagnostic], more: 0, sources: self.sources.clone() })
    }
}

/// Reads a robot file, and the files it names.
///
/// ```no_run
/// let file = whipcord_io::load("examples/table1/case-3.toml")?;
/// println!("{}: {} cables", file.title, file.robot.cables().len());
/// # Ok::<(), whipcord_io::FileError>(())
/// ```
///
/// # Errors
/// [`FileError`] with all that is wrong, where, and what to do about it.
pub fn load(path: impl AsRef<Path>) -> Result<CaseFile, FileError> {
    load_with(path, &[])
}

/// The same with keys that are set beside the file: each a path and a value, such as `cables.pull.tension=5 N`. An entry
/// of a list is told by its name or by its number in brackets, from 0. A value is one of TOML, else a text.
///
/// ```no_run
/// let settings = ["backbone.diameter=2 mm".to_owned(), "cables[0].tension=5 N".to_owned()];
/// let file = whipcord_io::load_with("examples/table1/case-3.toml", &settings)?;
/// assert_eq!(file.case.commands[0].tension, Some(5.0));
/// # Ok::<(), whipcord_io::FileError>(())
/// ```
///
/// # Errors
/// [`FileError`] with all that is wrong, where, and what to do about it.
pub fn load_with(path: impl AsRef<Path>, settings: &[String]) -> Result<CaseFile, FileError> {
    let path = path.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match files::read_first(path, &mut sources, &mut problems) {
        Some(text) => parse_with(&text, path, settings),
        None => Err(problems.into_error(sources)),
    }
}

/// Reads a robot file from a stream, such as standard input, with the same limit of size as a file. Messages show `name`, and
/// relative paths are relative to the folder of `name`.
///
/// ```
/// let text = "extends = 'nothing.toml'";
/// let error = whipcord_io::load_stream(text.as_bytes(), "<stdin>", &[]).unwrap_err();
/// assert!(error.to_string().contains("<stdin>:1:11: error: cannot read `nothing.toml`"));
/// ```
///
/// # Errors
/// [`FileError`] with all that is wrong, where, and what to do about it.
pub fn load_stream(
    stream: impl Read,
    name: impl AsRef<Path>,
    settings: &[String],
) -> Result<CaseFile, FileError> {
    let name = name.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match files::read_stream(stream, name, &mut sources, &mut problems) {
        Some(text) => parse_with(&text, name, settings),
        None => Err(problems.into_error(sources)),
    }
}

impl CaseFile {
    /// Of each step, the group and the time that the table of commands gives; empty without such a table.
    #[must_use]
    pub fn row_labels(&self) -> Vec<RowLabel> {
        let rows = self.commands.iter().flat_map(|table| &table.rows);
        rows.map(|row| RowLabel { group: row.group.clone(), time: row.time }).collect()
    }

    /// What was measured, as a fit takes it; `None` where nothing was.
    #[must_use]
    pub fn experiment(&self) -> Option<Experiment> {
        let measured = self.measured.as_ref().filter(|of| !of.observations.is_empty())?;
        Some(Experiment {
            name: self.path.display().to_string(),
            case: self.case.clone(),
            cameras: measured.cameras.iter().map(|of| of.camera).collect(),
            observations: measured.fitted(),
            body: measured.body,
            alignment: measured.alignment,
            labels: self.row_labels(),
            ..Experiment::default()
        })
    }
}

/// Reads the text of a robot file. `name` stands for it in messages, and the files it names are
/// looked for in its folder.
///
/// # Errors
/// [`FileError`] with all that is wrong, where, and what to do about it.
pub fn parse(text: &str, name: impl AsRef<Path>) -> Result<CaseFile, FileError> {
    parse_with(text, name.as_ref(), &[])
}

fn parse_with(text: &str, path: &Path, settings: &[String]) -> Result<CaseFile, FileError> {
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    let file = files::document(path, text, &mut sources, &mut problems).and_then(|mut document| {
        settings::apply(&mut document, settings, &mut sources, &mut problems);
        document.entries_mut().into_iter().for_each(|entries| take_out(entries, &ROOT));
        read(document, path, &mut sources, &mut problems)
    });
    match file {
        Some(file) if problems.is_empty() => Ok(CaseFile { sources, ..file }),
        _ => Err(problems.into_error(sources)),
    }
}

fn read(
    document: Node,
    path: &Path,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<CaseFile> {
    let Value::Table(entries) = &document.value else { return None };
    let fields = check::table(entries, document.span, &ROOT, problems);
    steps(&fields, &document, sources, problems);
    // The library refuses them too, but only after all parts have been made.
    for list in ["cables", "motors"] {
        let (given, most) = (fields.tables(list).len(), limits::MOST_CABLES);
        if given > most {
            let span = document.locate(&format!("{list}[{most}]")).span;
            let problem = Problem::TooMany { given, most };
            problems.push(span, || FileProblem::Physical { path: list.to_owned(), problem });
            return None;
        }
    }
    let mut parts = parts(&fields, &document, sources, problems);
    if let Some(parts) = &parts {
        driven_twice(parts, &document, problems);
    }
    let obstacles = read::obstacles(fields.tables("obstacles"), &document, sources, problems);
    if let Some(parts) = &mut parts {
        parts.obstacles = obstacles;
    }
    let robot = read::Extent {
        disks: parts.as_ref().map(|parts| read::Extent::disks_of(&parts.disks)),
        length: parts.as_ref().map(|parts| parts.backbone.length),
        steps: parts.as_ref().map_or(fields.tables("steps").len(), |parts| parts.steps.len()),
        at_origin: parts.as_ref().is_some_and(|parts| parts.base == Pose::IDENTITY),
        rows: parts.as_ref().and_then(|parts| parts.table.as_ref()),
    };
    // Of rows that were refused, measurements would only be refused again.
    let has_rows = robot.rows.is_some() || document.find("commands.table").is_none();
    let measured = fields.table("measured").filter(|_| has_rows).and_then(|table| {
        read::measured(table, document.locate("measured"), robot, sources, problems)
    });
    let reference = fields.table("reference").and_then(read::reference);
    // Without the cables that a path names by a group nothing is known of it.
    let fit = fields.table("fit").zip(parts.as_ref()).map(|(table, parts)| {
        let robot = whipcord_estimation::identification::Parts {
            cables: &parts.cables,
            motors: &parts.motors.motors,
            segments: &parts.backbone.segments,
        };
        read::fit(table, robot, &document, problems)
    });
    let disks = robot.disks;
    let names: Vec<String> = parts.as_ref().map_or_else(Vec::new, |parts| {
        parts.cables.iter().map(|cable| cable.name.clone()).collect()
    });
    let goal = read::goal(&fields, (disks, &names), &document, sources, problems);
    // Without its cables and motors nothing is known of what they are told.
    let motion = parts.as_ref().map_or_else(Motion::default, |parts| {
        let moved = read::Moved {
            driven: read::Driven { cables: &parts.cables, motors: &parts.motors.motors },
            length: parts.backbone.length,
            frame: parts.loads.frame,
            base: parts.base.rotation,
        };
        read::motion(&fields, &moved, &document, sources, problems)
    });
    if let Some(reference) = &reference {
        published(reference, &document, problems);
    }
    // What the checks refused would only be refused again.
    if !problems.is_empty() {
        return None;
    }
    let mut parts = parts?;
    let commands = parts.table.take();
    let (robot, case) = assemble(parts, &document, problems)?;
    read::check_shortenings(&goal, &robot, &document, problems);
    let has_measured = measured.as_ref().is_some_and(|measured| !measured.disks.is_empty());
    read::check_design(&goal.design, &robot, has_measured, &document, problems);
    read::check_motion(&motion, &robot, &case, &document, problems);
    let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Some(CaseFile {
        title: fields.text("title").map_or_else(stem, str::to_owned),
        robot,
        case,
        commands,
        measured,
        reference,
        fit,
        goal,
        motion,
        path: path.to_owned(),
        document,
        // Those that were read are put in when all is well.
        sources: Sources::default(),
    })
}

/// The parts that the tables describe; `None` when one is missing or was refused.
fn parts(
    fields: &Fields,
    document: &Node,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Parts> {
    let backbone = read::backbone(fields.table("backbone")?)?;
    let disks = match document.has("disks") {
        true => read::disks(Some(fields.table("disks")?), backbone.length)?,
        false => read::disks(None, backbone.length)?,
    };
    let loads = fields.table("loads").map(|table| read::loads(table, backbone.length));
    let loads = loads.unwrap_or_default();
    let base = match fields.table("base").map(read::pose) {
        None => Pose::IDENTITY,
        Some(Ok(base)) => base,
        Some(Err(path)) => {
            let (path, problem) = (format!("base.{path}"), Problem::NoDirection);
            let span = document.locate(&path).span;
            problems.push(span, || FileProblem::Physical { path, problem });
            Pose::IDENTITY
        }
    };
    let tables = fields.tables("cables");
    let cables = tables.iter().enumerate().map(|(i, table)| read::cable(table, i));
    let steps = fields.tables("steps").iter().map(|table| read::step(table, tables.len()));
    let mut steps: Vec<Vec<CableCommand>> = steps.collect();
    let cables = cables.collect::<Option<Vec<_>>>()?;
    let names: Vec<String> = cables.iter().map(|cable| cable.name.clone()).collect();
    let motors = read::motors(fields.tables("motors"), &names, document, problems);
    let mut motor_steps = Vec::new();
    for (k, table) in fields.tables("steps").iter().enumerate() {
        motor_steps.push(read::motor_step(table, k, &motors.motors, document, problems));
    }
    let commands: Vec<CableCommand> = tables.iter().map(read::command).collect();
    let robot = read::CommandedRobot {
        cables: &cables,
        motors: &motors.motors,
        own_cables: &commands,
        own_motors: &motors.commands,
        loads: &loads,
    };
    let (mut independent, mut rows) = (false, None);
    if let Some(table) = fields.table("commands") {
        independent = read::are_independent(table, document, &robot, problems);
        if table.text("table").is_some() {
            rows = Some(read::commands(table, document, &robot, sources, problems)?);
        }
    }
    let (mut table, mut row_spans, mut step_loads) = (None, Vec::new(), Vec::new());
    if let Some(rows) = rows {
        (steps, motor_steps, step_loads) = (rows.steps, rows.motors, rows.loads);
        (table, row_spans) = (Some(rows.table), rows.spans);
    }
    independent &= steps.len() > 1;
    Some(Parts {
        backbone,
        disks,
        cables,
        commands,
        loads,
        step_loads,
        base,
        steps,
        motors,
        motor_steps,
        independent,
        table,
        row_spans,
        obstacles: Vec::new(),
    })
}

/// Refuses steps that do not say what each cable or motor does, and cables and motors that have something of their own to say
/// beside the steps of the same file or of one that it extends.
fn steps(fields: &Fields, document: &Node, sources: &Sources, problems: &mut Problems) {
    let (cables, motors) = (fields.tables("cables"), fields.tables("motors"));
    let steps = fields.tables("steps");
    if steps.is_empty() {
        return;
    }
    if fields.table("commands").is_some_and(|table| table.text("table").is_some()) {
        let related = Some((document.locate("steps[0]").span, "the other one is here"));
        let table = document.locate("commands.table").span;
        let (first, second) = ("steps", "table");
        problems.push_related(table, related, || FileProblem::Exclusive {
            first,
            second,
            table: "one file",
        });
    }
    let span = |path: String| document.locate(&path).span;
    for (k, step) in steps.iter().enumerate() {
        for (key, of) in [("tension", cables), ("shortening", cables), ("motors", motors)] {
            let (given, expected) = (step.list(key).map(<[_]>::len), of.len());
            if let Some(given) = given.filter(|given| *given != expected) {
                let list = span(format!("steps[{k}].{key}"));
                problems.push(list, || FileProblem::WrongCount { key, expected, given });
            }
        }
    }
    let first = span("steps[0]".to_owned());
    let own_commands = [
        ("cables", cables, ["tension", "shortening"], "the steps say what each cable does"),
        ("motors", motors, ["angle", "travel"], "the steps say what each motor does"),
    ];
    for (list, of, keys, said) in own_commands {
        for (i, fields) in of.iter().enumerate() {
            for second in keys.into_iter().filter(|key| fields.quantity(key).is_some()) {
                let own = span(format!("{list}[{i}].{second}"));
                // A file that is extended gives way to what is laid over it, and comes later among the files.
                if own.file <= first.file || sources.is_setting(own.file) {
                    let related = Some((first, said));
                    let in_one = own.file == first.file || sources.is_setting(own.file);
                    let table =
                        if in_one { "one file" } else { "a file that extends one with steps" };
                    problems.push_related(own, related, || FileProblem::Exclusive {
                        first: "steps",
                        second,
                        table,
                    });
                }
            }
        }
    }
}

/// Refuses a shortening of a cable whose motor has a command.
fn driven_twice(parts: &Parts, document: &Node, problems: &mut Problems) {
    for (k, (motor, command)) in parts.motors.motors.iter().zip(&parts.motors.commands).enumerate()
    {
        let key = motor.drive.keys().command;
        for of in motor.cables.iter().filter(|_| command.is_some() && parts.steps.is_empty()) {
            if parts.commands.get(of.cable).is_some_and(|own| own.shortening.is_some()) {
                let path = |path: String| document.locate(&path).span;
                let own = path(format!("cables[{}].shortening", of.cable));
                let motor = path(format!("motors[{k}].{key}"));
                let related = Some((motor, "the motor that pulls it has a command"));
                let (second, table) = ("shortening", "a cable and its motor");
                problems.push_related(own, related, || FileProblem::Exclusive {
                    first: key,
                    second,
                    table,
                });
            }
        }
    }
}

/// Refuses published values that cannot be.
fn published(reference: &Reference, document: &Node, problems: &mut Problems) {
    let values = [
        ("rms_four_bar", reference.rms_four_bar, limits::DISTANCE),
        ("rms_cosserat", reference.rms_cosserat, limits::DISTANCE),
        ("time_four_bar", reference.time_four_bar, DURATION),
        ("time_cosserat", reference.time_cosserat, DURATION),
    ];
    for (key, value, range) in values {
        if let Some(problem) = value.and_then(|value| range.problem(value)) {
            let path = format!("reference.{key}");
            let span = document.locate(&path).span;
            problems.push(span, || FileProblem::Physical { path, problem });
        }
    }
}
