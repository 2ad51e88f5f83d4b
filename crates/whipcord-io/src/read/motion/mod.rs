//! `[motion]` and `[backbone.damping]`.

mod base;
mod command;
mod initial;
mod table;

use whipcord::robot::limits::{FORCE, LENGTH, Range};
use whipcord::{Case, LoadFrame, Loads, ModelKind, Robot, RobotError, UnitQuaternion};
use whipcord_motion::{
    BaseMotion, CableDrive, Commands, Course, Damping, Drag, Initial, LoadCourse, Method,
    MotionOptions,
};

use crate::check::Fields;
use crate::error::{FileProblem, Problems};
use crate::node::Node;
use crate::read::loads;
use crate::read::table::problem;
use crate::schema::{DURATION, LENGTH_OF_TIME, LINE_DRAG};
use crate::source::{Sources, quoted};
use crate::units::Dimension;

pub(crate) use command::Driven;

/// Most steps, and most states that are written.
const MOST_STEPS: f64 = 1e7;

/// How a robot moves over time, as a file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// Time in s that is simulated.
    pub duration: Option<f64>,
    /// Length of a step in s.
    pub step: Option<f64>,
    /// Time between two states of the output in s.
    pub every: Option<f64>,
    /// How cables run.
    pub model: Option<ModelKind>,
    /// How the equations are integrated.
    pub method: Option<Method>,
    /// Error in m that a step may have.
    pub tolerance: Option<f64>,
    /// Where the motion starts.
    pub initial: Option<Initial>,
    /// Least number of elements along the backbone.
    pub elements: Option<usize>,
    /// Damping of the backbone.
    pub damping: Damping,
    /// Drag of the surroundings.
    pub drag: Drag,
    /// How the base moves.
    pub base: Option<BaseMotion>,
    /// Whether nothing holds the base.
    pub has_free_base: bool,
    /// What cables are told over time: the number of each from 0.
    pub cables: Vec<(usize, CableCourse)>,
    /// What motors are told over time: the number of each from 0, and its angles in rad or travels in m.
    pub motors: Vec<(usize, Course)>,
    /// Loads over time, beside those of the case.
    pub loads: Vec<LoadCourse>,
}

/// What a cable is told over time.
#[derive(Clone, Debug, PartialEq)]
pub enum CableCourse {
    /// Its tension in N.
    Tension(Course),
    /// Its shortening in m.
    Shortening(Course),
    /// Its shortening as a part of its initial length.
    Fraction(Course),
}

impl Motion {
    /// The step where a file gives none, in s.
    pub const STEP: f64 = 0.01;

    /// The model of the motion.
    #[must_use]
    pub fn model(&self) -> ModelKind {
        self.model.unwrap_or(ModelKind::Cosserat)
    }

    /// The options of the simulation.
    #[must_use]
    pub fn options(&self) -> MotionOptions {
        MotionOptions {
            model: self.model(),
            method: self.method.unwrap_or_default(),
            tolerance: self.tolerance,
            initial: self.initial.clone().unwrap_or_default(),
            elements: self.elements.unwrap_or(MotionOptions::ELEMENTS),
            damping: self.damping.clone(),
            drag: self.drag,
            loads: self.loads.clone(),
            base: self.base.clone(),
            has_free_base: self.has_free_base,
            ..MotionOptions::default()
        }
    }

    /// Case, commands and options for the equilibrium whose vibrations are asked for: that under the commands and loads over time at this time
    /// in s, held constant; without a time, that under those of the case alone. A robot that nothing holds falls with its gravity, and has it not in its
    /// equilibrium.
    #[must_use]
    pub fn held_at(
        &self,
        robot: &Robot,
        case: &Case,
        time: Option<f64>,
    ) -> (Case, Commands, MotionOptions) {
        let held = |of: &LoadCourse, time: f64| LoadCourse {
            loads: Loads {
                gravity: of.loads.gravity.filter(|_| !self.has_free_base),
                ..of.loads.clone()
            },
            factor: Course::constant(of.factor.after(time)),
        };
        let loads =
            time.map_or_else(Vec::new, |time| self.loads.iter().map(|of| held(of, time)).collect());
        let options = MotionOptions {
            loads,
            initial: Initial::Equilibrium,
            tolerance: None,
            base: None,
            ..self.options()
        };
        let commands = match time {
            Some(time) => self.commands(robot, case).held_at(time),
            None => Commands::of_case(robot, case),
        };
        let mut case = case.clone();
        if self.has_free_base {
            case.loads.gravity = None;
        }
        (case, commands, options)
    }

    /// The commands of all cables and motors: those over time, and those of the case for the others.
    #[must_use]
    pub fn commands(&self, robot: &Robot, case: &Case) -> Commands {
        let mut commands = Commands::of_case(robot, case);
        for (cable, told) in &self.cables {
            let drive = match told {
                CableCourse::Tension(course) => CableDrive::Tension(course.clone()),
                CableCourse::Shortening(course) => CableDrive::Shortening(course.clone()),
                CableCourse::Fraction(course) => {
                    CableDrive::Shortening(scaled(course, robot.cable_length(*cable)))
                }
            };
            if let Some(of) = commands.cables.get_mut(*cable) {
                *of = drive;
            }
        }
        if !self.motors.is_empty() {
            commands.motors.resize(robot.motors().len(), None);
        }
        for (motor, course) in &self.motors {
            if let Some(of) = commands.motors.get_mut(*motor) {
                *of = Some(course.clone());
            }
        }
        commands
    }

    /// Time between two states of the output, the number of steps from one to the next, and the number of states after the first.
    #[must_use]
    pub fn rows(&self) -> Option<(f64, usize, usize)> {
        let duration = self.duration?;
        let step = self.step.unwrap_or(Self::STEP).min(duration);
        let every = self.every.unwrap_or(step).min(duration);
        let count = |ratio: f64| {
            // What rounding adds is no step of its own.
            let whole = (ratio - 1e-9).ceil().clamp(1.0, MOST_STEPS);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let whole = whole as usize;
            whole
        };
        let rows = count(duration / every);
        #[allow(clippy::cast_precision_loss, reason = "far below 2^53")]
        let every = if self.every.is_some() { every } else { duration / rows as f64 };
        Some((every, count(every / step), rows))
    }
}

/// A course with all values multiplied by a finite factor.
fn scaled(course: &Course, factor: f64) -> Course {
    match course.rows() {
        None => Course::constant(course.before(0.0) * factor),
        Some((times, values)) => {
            let values = values.iter().map(|value| value * factor).collect();
            Course::table(times.to_vec(), values).unwrap_or_else(|_| course.clone())
        }
    }
}

/// What the tables are read for.
pub(crate) struct Moved<'a> {
    /// Cables and motors.
    pub driven: Driven<'a>,
    /// Length of the backbone in m.
    pub length: f64,
    /// Frame of the loads.
    pub frame: LoadFrame,
    /// Orientation of the base at the start.
    pub base: UnitQuaternion,
}

/// Reads the tables.
pub(crate) fn motion(
    fields: &Fields,
    Moved { driven, length, frame, base }: &Moved<'_>,
    document: &Node,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Motion {
    let mut reader = Reader { document, problems };
    let mut motion = Motion::default();
    if let Some(table) = fields.table("backbone").and_then(|backbone| backbone.table("damping")) {
        motion.damping = reader.damping(table);
    }
    let Some(table) = fields.table("motion") else { return motion };
    motion.duration = reader.number(table, "motion", "duration", LENGTH_OF_TIME);
    motion.step = reader.number(table, "motion", "step", LENGTH_OF_TIME);
    motion.tolerance = reader.number(table, "motion", "tolerance", LENGTH);
    motion.model = table.text("model").and_then(|name| name.parse().ok());
    motion.method = table.text("method").and_then(Method::named);
    motion.initial = initial::initial(table, sources, &mut reader);
    motion.elements = table.count("elements");
    if let Some(drag) = table.table("drag") {
        let along =
            |key: &str| reader.number(drag, "motion.drag", key, LINE_DRAG).unwrap_or_default();
        let [across, along] = ["across", "along"].map(along);
        motion.drag = Drag { across, along };
    }
    motion.has_free_base = table.table("base").is_some_and(|table| table.flag("free"));
    motion.base =
        table.table("base").and_then(|table| base::base(table, *base, sources, &mut reader));
    if let Some(output) = table.table("output") {
        motion.every = reader.number(output, "motion.output", "every", LENGTH_OF_TIME);
    }
    reader.count(&motion);
    for (k, entry) in table.tables("commands").iter().enumerate() {
        command::read(entry, k, driven, &mut motion, sources, &mut reader);
    }
    for (k, entry) in table.tables("loads").iter().enumerate() {
        let path = format!("motion.loads[{k}].factor");
        let rows = entry.list("factor").unwrap_or_default();
        let factor = command::course(rows, &path, Dimension::Ratio, &|_| FACTOR, &mut reader);
        let factor = factor.map(|(factor, _)| factor);
        let loads = Loads { frame: *frame, ..loads(entry, *length) };
        motion.loads.extend(factor.map(|factor| LoadCourse { loads, factor }));
    }
    motion
}

/// What a factor of loads may be.
const FACTOR: Range = Range { unit: "", ..FORCE };

/// What only the whole robot and its case tell: a cable whose motor has a command, and loads that cannot be.
pub(crate) fn check_motion(
    motion: &Motion,
    robot: &Robot,
    case: &Case,
    document: &Node,
    problems: &mut Problems,
) {
    for (cable, _) in &motion.cables {
        let Some(motor) = robot.motor_of(*cable) else { continue };
        let is_told = motion.motors.iter().any(|(of, _)| *of == motor);
        if is_told || case.motor_command(motor).is_some() {
            let span = document.locate("motion.commands").span;
            let (cable, motor) = (&robot.cables()[*cable].name, &robot.motors()[motor].name);
            let message = format!(
                "cable `{}` has a command over time, but the motor `{}` that pulls it has one as well",
                quoted(cable),
                quoted(motor)
            );
            problems.push(span, || problem(message, "remove one of the two"));
        }
    }
    for (k, of) in motion.loads.iter().enumerate() {
        let with_loads = Case { loads: of.loads.clone(), ..case.clone() };
        if let Err(RobotError { path, problem }) = with_loads.check(robot) {
            let rest = path.strip_prefix("loads").unwrap_or_default();
            let path = format!("motion.loads[{k}]{rest}");
            let span = document.locate(&path).span;
            problems.push(span, || FileProblem::Physical { path, problem });
        }
    }
}

/// What the tables are read with.
pub(crate) struct Reader<'a> {
    document: &'a Node,
    problems: &'a mut Problems,
}

impl Reader<'_> {
    fn tell(&mut self, path: &str, message: String, help: &'static str) {
        let span = self.document.locate(path).span;
        self.problems.push(span, || problem(message, help));
    }

    /// Whether a number is in its range; said where it is not.
    fn within(&mut self, value: f64, range: Range, path: &str) -> bool {
        let Some(problem) = range.problem(value) else { return true };
        let span = self.document.locate(path).span;
        let path = path.to_owned();
        self.problems.push(span, || FileProblem::Physical { path, problem });
        false
    }

    fn number(&mut self, table: &Fields, title: &str, key: &str, range: Range) -> Option<f64> {
        let value = table.number(key)?;
        self.within(value, range, &format!("{title}.{key}")).then_some(value)
    }

    /// Refuses more steps than can be meant.
    fn count(&mut self, motion: &Motion) {
        let Some(duration) = motion.duration else { return };
        let shortest = motion.step.unwrap_or(Motion::STEP).min(motion.every.unwrap_or(duration));
        if duration / shortest > MOST_STEPS {
            let message = format!("the motion has {:.1e} steps", duration / shortest);
            let help = "use a longer step or a shorter duration: ten million steps at most";
            self.tell("motion.duration", message, help);
        }
    }

    fn damping(&mut self, table: &Fields) -> Damping {
        let path = "backbone.damping";
        if let Some(time) = self.number(table, path, "time", DURATION) {
            return Damping::Time(time);
        }
        let Some(rows) = table.list("matrix") else { return Damping::None };
        let mut matrix = Box::new([[0.0; 6]; 6]);
        for (out, row) in matrix.iter_mut().zip(rows) {
            for (out, value) in out.iter_mut().zip(row.as_list().unwrap_or_default()) {
                *out = value.as_number().unwrap_or_default();
            }
        }
        let damping = Damping::Matrix(matrix);
        if let Err(error) = damping.check() {
            let help = "give a symmetric matrix by rows whose eigenvalues are not negative";
            self.tell("backbone.damping.matrix", error.to_string(), help);
        }
        damping
    }
}
