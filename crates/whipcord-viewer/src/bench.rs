//! The models of one robot, ready to solve what sliders say.

use std::sync::Arc;
use std::time::{Duration, Instant};

use whipcord::kinematics::principal_axes;
use whipcord::{
    Actuation, CableCommand, Cancel, Case, Differentiable as _, ModelKind, ModelPreset, PointLoad,
    Shortening, Solution, SolveError, Vec3,
};
use whipcord_io::CaseFile;

use crate::answer::{Found, Refusal, answer};
use crate::convert::array;
use crate::holes::{Holes, with_holes};
use crate::inverse::TipSolver;
use crate::protocol::{Answer, Command, Compliance, Frame, Malformed, Reach, Request, Slider};
use crate::scene::{cables, initial_lengths, model, sliders};
use crate::stations::Places;
use crate::stock::{Ready, Stock};

/// Tips that are nearer to one another than this, relative to the length, are of one shape: places at which an answer
/// is asked for change the steps of the integration, and that the answer by less.
const SAME_SHAPE: f64 = 1e-4;

/// What one page solves: the models of one robot, each with its last answer, from which the next solve starts.
#[derive(Debug)]
pub struct Bench {
    /// The file, and with the holes of the latest request.
    given: Arc<CaseFile>,
    file: Arc<CaseFile>,
    holes: Holes,
    /// What each command of a request is for.
    sliders: Vec<Slider>,
    places: Places,
    /// The models of the file as given, which all its pages share, and those of the present holes.
    shared: Arc<Stock>,
    stock: Arc<Stock>,
    last: Vec<(ModelPreset, Solution)>,
    tip_solver: TipSolver,
    cancel: Cancel,
    /// How long the flag lets a solve take.
    limit: Duration,
}

impl Bench {
    /// For the robot and the case of a file.
    pub fn new(file: Arc<CaseFile>) -> Self {
        Self::sharing(file, Arc::default())
    }

    /// The same, with models that others solve with as well.
    pub fn sharing(file: Arc<CaseFile>, stock: Arc<Stock>) -> Self {
        let places = Places::of(&file.robot);
        let sliders = sliders(&file.robot, &file.case);
        let (last, cancel, limit) = (Vec::new(), Cancel::default(), Duration::MAX);
        let tip_solver = TipSolver::default();
        let (given, holes, shared) = (Arc::clone(&file), Holes::new(), Arc::clone(&stock));
        Self { given, file, holes, sliders, places, shared, stock, last, tip_solver, cancel, limit }
    }

    /// Takes other holes than those of the latest request.
    fn take_holes(&mut self, holes: &Holes) -> Result<(), Refusal> {
        if self.holes == *holes {
            return Ok(());
        }
        self.file = with_holes(&self.given, holes)?;
        self.holes.clone_from(holes);
        self.places = Places::of(&self.file.robot);
        // The models of a robot with other holes are this page's own.
        self.stock = if holes.is_empty() { Arc::clone(&self.shared) } else { Arc::default() };
        self.last.clear();
        self.tip_solver = TipSolver::default();
        Ok(())
    }

    /// Lets this flag, which is set after so long, end the next solves.
    pub fn cancelled_by(&mut self, cancel: &Cancel, limit: Duration) {
        self.cancel.clone_from(cancel);
        self.limit = limit;
    }

    /// Why a solve has no answer.
    fn refusal(limit: Duration, error: &SolveError) -> Refusal {
        match error {
            SolveError::Cancelled { .. } => format!(
                "the viewer stopped the solve after {limit:?}: select fewer models, or use `whipcord solve`, which waits longer"
            ),
            other => other.to_string(),
        }
    }

    /// The answers to a request that came at `arrival`.
    ///
    /// # Errors
    /// [`Malformed`] for a model that is not known.
    pub fn solve(&mut self, request: &Request, arrival: Instant) -> Result<Frame, Malformed> {
        let presets = request.presets()?;
        if let Err(message) = self.take_holes(&request.holes) {
            let failed = |preset: &ModelPreset| Answer::Failed {
                model: preset.name().to_owned(),
                message: message.clone(),
            };
            let answers = presets.iter().map(failed).collect();
            let time = arrival.elapsed().as_secs_f64();
            return Ok(Frame { id: request.id, time, answers, reach: None, cables: None });
        }
        let reach = request.target.map(|place| self.reach(&presets, request, place.into()));
        let commands = match &reach {
            Some(Reach::Found { commands, .. }) => Some(commands.clone()),
            Some(Reach::Failed { .. }) | None => None,
        };
        let changed = commands.map(|commands| Request { commands, ..request.clone() });
        let request = changed.as_ref().unwrap_or(request);
        let found = match self.case(request) {
            Ok(case) => self.found(&presets, &case),
            Err(why) => presets.into_iter().map(|preset| (preset, Err(why.clone()))).collect(),
        };
        let answers = found.into_iter().map(|(preset, found)| {
            let compliance = match &found {
                Ok(found) if request.compliance => Some(self.compliance(preset, found)),
                _ => None,
            };
            answer(&self.file, preset, found, compliance)
        });
        let answers = answers.collect();
        let robot = &self.file.robot;
        let is_changed = !Arc::ptr_eq(&self.file, &self.given);
        let routed =
            is_changed.then(|| cables(robot, &self.places, &initial_lengths(robot, &self.places)));
        let time = arrival.elapsed().as_secs_f64();
        Ok(Frame { id: request.id, time, answers, reach, cables: routed })
    }

    /// Commands for a place of the tip, by the first model.
    fn reach(&mut self, presets: &[ModelPreset], request: &Request, place: Vec3) -> Reach {
        let Some(&preset) = presets.first() else {
            return Reach::Failed { message: "no model is chosen".to_owned() };
        };
        let case = match self.case(request) {
            Ok(case) => case,
            Err(message) => return Reach::Failed { message },
        };
        let sliders = (self.sliders.as_slice(), request.commands.as_slice());
        self.tip_solver.reach(&self.file, (preset, &case), sliders, place, &self.cancel)
    }

    /// What these models find, in their order.
    pub fn found(
        &mut self,
        presets: &[ModelPreset],
        case: &Case,
    ) -> Vec<(ModelPreset, Result<Found, Refusal>)> {
        let pulled = case.commands.iter().any(|command| command.tension.is_some());
        let is_driven =
            |one: ModelPreset| pulled && one.kind.natural_actuation() == Actuation::Shortening;
        let mut all: Vec<_> = presets
            .iter()
            .map(|&one| (one, if is_driven(one) { None } else { Some(self.one(one, case)) }))
            .collect();
        // Those that know no tensions are driven by the cable lengths of the first that does.
        let mut lead = all.iter().find_map(|(one, found)| {
            Some((*one, Ok(shares_of(&found.as_ref()?.as_ref().ok()?.solution))))
        });
        for (preset, found) in &mut all {
            if found.is_some() {
                continue;
            }
            let (by, shares) = lead.get_or_insert_with(|| {
                let by = ModelPreset::usual(ModelKind::Cosserat);
                (by, self.one(by, case).map(|found| shares_of(&found.solution)))
            });
            let one = match shares {
                Ok(shares) => self.one(*preset, &shortened(case, shares)),
                Err(why) => Err(format!("its cable lengths come from {by}: {why}")),
            };
            *found = Some(one.map(|found| Found { driven_by: Some(*by), ..found }));
        }
        all.into_iter().filter_map(|(preset, found)| Some((preset, found?))).collect()
    }

    /// What the sliders say, with all that they leave as the file has it.
    ///
    /// # Errors
    /// Why the motors cannot be told so.
    pub fn case(&self, request: &Request) -> Result<Case, Refusal> {
        let robot = &self.file.robot;
        let mut cables = vec![CableCommand::default(); robot.cables().len()];
        let mut motors = vec![None; robot.motors().len()];
        let (given, all) = (request.commands.len(), self.sliders.len());
        if given != all {
            return Err(format!("{given} commands are given for {all} sliders: reload the page"));
        }
        for (&slider, command) in self.sliders.iter().zip(&request.commands) {
            match (slider, command) {
                (Slider::Motor(motor), Command::Motor(value)) => motors[motor] = Some(*value),
                (Slider::Cable(cable), Command::Tension(_) | Command::Shortening(_)) => {
                    cables[cable] = command.command();
                }
                _ => {
                    return Err(
                        "a slider of a cable has the command of a motor, or the other way round: reload the page"
                            .to_owned(),
                    );
                }
            }
        }
        let case = self.file.case.commanded(cables).driven_to(robot, &motors);
        let mut case = case.map_err(|error| error.to_string())?;
        case.loads.tip_force = Vec3::from(request.tip_force);
        case.loads.tip_moment = Vec3::from(request.tip_moment);
        let gravity = Vec3::from(request.gravity);
        case.loads.gravity = (gravity != Vec3::ZERO).then_some(gravity);
        if let Some(pull) = request.pull {
            let to_frame = case.loads.to_world(case.base.rotation).conjugate();
            let force = to_frame.rotate(Vec3::from(pull.force));
            let at = pull.arc_length;
            case.loads.points.push(PointLoad { at, force, ..PointLoad::default() });
        }
        Ok(case)
    }

    /// The answer of a model. It starts from the last one and, where that leads nowhere, from
    /// cold. Where cables or obstacles rub, what was before counts: then each answer is that after the steps of the file.
    fn one(&mut self, preset: ModelPreset, case: &Case) -> Result<Found, Refusal> {
        case.check(&self.file.robot).map_err(|error| error.to_string())?;
        let (cancel, limit) = (self.cancel.clone(), self.limit);
        let mut ready = self.ready(preset)?;
        if !ready.prepared.takes_places_of(&case.loads) {
            let prepared = ready.model.prepare(ready.prepared.robot(), &case.loads);
            ready.prepared = prepared.map_err(|error| error.to_string())?;
        }
        ready.prepared.set_cancel(&cancel);
        let has_friction = !case.before.is_empty()
            || case.obstacles.iter().any(|obstacle| obstacle.friction > 0.0)
            || ready.prepared.robot().cables().iter().any(whipcord::Cable::has_friction);
        let begun = Instant::now();
        let known = self.last.iter().position(|(of, _)| *of == preset);
        let last = known.map(|place| &self.last[place].1);
        let outcome = match (last, has_friction) {
            (_, true) => ready.prepared.solve_to_the_end(case).map_err(|(_, error)| error),
            (None, false) => ready.prepared.solve(case, None),
            (Some(last), false) => match ready.prepared.solve(case, Some(last)) {
                Ok(solution) => Ok(solution),
                Err(_) => ready.prepared.solve(case, None),
            },
        };
        let solve_time = begun.elapsed().as_secs_f64();
        self.stock.put(ready);
        let solution = outcome.map_err(|error| Self::refusal(limit, &error))?;
        match known {
            Some(place) => self.last[place].1 = solution.clone(),
            None => self.last.push((preset, solution.clone())),
        }
        Ok(Found { solution, solve_time, case: case.clone(), driven_by: None })
    }

    /// What a model answers to each step of a case.
    ///
    /// # Errors
    /// Why it does not go through them.
    pub fn steps(&mut self, preset: ModelPreset, case: &Case) -> Result<Vec<Answer>, Refusal> {
        case.check(&self.file.robot).map_err(|error| error.to_string())?;
        let (cancel, limit) = (self.cancel.clone(), self.limit);
        let mut ready = self.ready(preset)?;
        ready.prepared.set_cancel(&cancel);
        let outcome = ready.prepared.solve_all(case);
        self.stock.put(ready);
        let solved = outcome.map_err(|(step, error)| {
            format!("step {}: {}", step + 1, Self::refusal(limit, &error))
        })?;
        let found =
            |solution| Found { solution, solve_time: 0.0, case: case.clone(), driven_by: None };
        let each = solved
            .into_iter()
            .map(|solution| answer(&self.file, preset, Ok(found(solution)), None));
        Ok(each.collect())
    }

    /// A model that is ready to solve: one of the stock, or another.
    fn ready(&self, preset: ModelPreset) -> Result<Ready, Refusal> {
        if let Some(ready) = self.stock.take(preset) {
            return Ok(ready);
        }
        let model = model(preset, &self.places);
        let prepared = model
            .prepare(&self.file.robot, &self.file.case.loads)
            .map_err(|error| error.to_string())?;
        Ok(Ready { preset, model, prepared })
    }

    /// How the tip yields with the tensions held, in the shape that was found.
    fn compliance(&mut self, preset: ModelPreset, found: &Found) -> Compliance {
        self.axes(preset, found).unwrap_or_else(|message| Compliance::Unknown { message })
    }

    /// The principal axes of the tip's compliance, in the world.
    fn axes(
        &mut self,
        preset: ModelPreset,
        Found { solution, case, .. }: &Found,
    ) -> Result<Compliance, Refusal> {
        let cancel = self.cancel.clone();
        let model = model(preset, &self.places).cancelled_by(&cancel);
        let robot = &self.file.robot;
        let length = robot.backbone().length;
        let (there, local) = model
            .solve_at_from(robot, case, length, Some(solution))
            .map_err(|error| Self::refusal(self.limit, &error))?;
        let apart = (there.disks.tip().position - solution.disks.tip().position).norm();
        if apart > SAME_SHAPE * length {
            return Err(format!(
                "what could be differentiated is another equilibrium, whose tip is {:.1} mm away: move a slider, and ask again",
                apart * 1e3
            ));
        }
        let yields = local.compliances.map_err(|error| error.to_string())?;
        let axes = principal_axes(&yields.tensions_held.compliance.blocks[0][0]);
        let turn = |d: Vec3| array(case.base.rotation.rotate(d));
        Ok(Compliance::Known { values: axes.values, directions: axes.directions.map(turn) })
    }
}

/// By which share of its length each cable is shortened; a slack one takes up none.
fn shares_of(solution: &Solution) -> Vec<f64> {
    let share = |cable: &whipcord::CableState| {
        if cable.initial_length > 0.0 { 1.0 - cable.length / cable.initial_length } else { 0.0 }
    };
    solution.cables.iter().map(share).collect()
}

/// The case in which each cable is shortened by this share of its length: at once, because of the steps before the
/// last there are tensions alone, and these lengths already are what the steps left.
fn shortened(case: &Case, shares: &[f64]) -> Case {
    let mut case = Case { before: Vec::new(), ..case.clone() };
    for (command, &share) in case.commands.iter_mut().zip(shares) {
        command.shortening = Some(Shortening::Fraction(share));
    }
    case
}
