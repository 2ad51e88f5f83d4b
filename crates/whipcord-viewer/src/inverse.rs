//! Inverse problems of the page: commands for the place that the tip is dragged to, and where it can go.

use core::fmt;

use whipcord::{Cancel, Case, Model, ModelPreset, PointLoad, Stations, Vec3};
use whipcord_inverse::{
    Actuator, CommandedBy, InverseError, InverseSolver, Limit, Preference, ReachOptions,
    ReachStatus, Reached, Target, Tolerance, Workspace, WorkspaceOptions,
};
use whipcord_io::CaseFile;

use crate::protocol::{Cloud, Command, MetLimit, Reach, Slider};

/// How far the tip may be from the place that it is dragged to, relative to the length: less than a picture shows.
const TOLERANCE: f64 = 1e-4;
/// Solves for one place, from one start: the display asks for the next soon.
const SOLVES: usize = 100;
/// Shapes and solves of a survey, which the page waits for, and voxels along the robot.
const SHAPES: usize = 20_000;
const SURVEY_SOLVES: usize = 60_000;
const VOXELS: f64 = 18.0;

/// The solver for the places that the tip of a robot is dragged to, kept from one to the next.
#[derive(Default)]
pub struct TipSolver(Option<(Key, InverseSolver)>);

/// What a solver is made for.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    preset: ModelPreset,
    loads: [Vec3; 3],
    points: Vec<PointLoad>,
    actuators: Vec<Actuator>,
}

impl fmt::Debug for TipSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("TipSolver").field(&self.0.as_ref().map(|(key, _)| key)).finish()
    }
}

impl TipSolver {
    /// Commands that bring the tip to a place or as near as it gets, from those of the case; in the order of the sliders, which
    /// have `commands` now.
    pub fn reach(
        &mut self,
        file: &CaseFile,
        (preset, case): (ModelPreset, &Case),
        (sliders, commands): (&[Slider], &[Command]),
        place: Vec3,
        cancel: &Cancel,
    ) -> Reach {
        let mut answer = || -> Result<Reach, String> {
            let robot = &file.robot;
            let words = |error: InverseError| error.to_string();
            let actuators = Actuator::of(robot, case, preset.kind, CommandedBy::Case);
            let actuators = actuators.map_err(words)?;
            let loads = &case.loads;
            let forces = [loads.tip_force, loads.tip_moment, loads.gravity.unwrap_or_default()];
            let points = loads.points.clone();
            let key = Key { preset, loads: forces, points, actuators };
            if self.0.as_ref().is_none_or(|(known, _)| *known != key) {
                self.0 = Some((key, solver(file, preset, case, cancel)?));
            }
            let Some((key, solver)) = &mut self.0 else { return Err(String::new()) };
            solver.set_cancel(cancel);
            solver.start_at(case);
            let length = robot.backbone().length;
            let position = TOLERANCE * length;
            let options = ReachOptions {
                tolerance: Some(Tolerance { position, ..Tolerance::of_length(length) }),
                // What is nearest to the commands before: the robot moves with the pointer.
                prefer: Preference::First,
                starts: 0,
                solves: SOLVES,
                clearance: file.goal.least_clearance(),
                ..ReachOptions::default()
            };
            let reached = solver.reach(&Target::Tip(place), &options).map_err(words)?;
            let limit = |limit: &Limit| MetLimit {
                slider: slider_of(*limit, &key.actuators, sliders),
                words: limit.words(robot, &key.actuators),
            };
            Ok(Reach::Found {
                reached: reached.status == ReachStatus::Reached,
                commands: by_sliders(&reached, &key.actuators, (sliders, commands)),
                distance: reached.miss.position,
                limits: reached.active_limits.iter().map(limit).collect(),
            })
        };
        answer().unwrap_or_else(|message| Reach::Failed { message })
    }
}

/// Where the tip can go under the loads of the case; `None` where it was cancelled.
///
/// # Errors
/// Why there is no answer.
pub fn survey(
    file: &CaseFile,
    (preset, case): (ModelPreset, &Case),
    id: u64,
    cancel: &Cancel,
) -> Result<Option<Cloud>, String> {
    let mut solver = solver(file, preset, case, cancel)?;
    let options = WorkspaceOptions {
        voxel: Some(file.robot.backbone().length / VOXELS),
        shapes: SHAPES,
        solves: SURVEY_SOLVES,
        has_stiffness: false,
        clearance: file.goal.least_clearance(),
    };
    let found = match solver.workspace(&options) {
        Ok(found) => found,
        Err(_) if cancel.is_cancelled() => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    Ok(Some(cloud(id, &found)))
}

/// What the page is told of a workspace.
pub fn cloud(id: u64, found: &Workspace) -> Cloud {
    // In micrometres: more digits are not seen, and take room.
    let short = |x: f64| (1e6 * x).round() / 1e6;
    Cloud {
        id,
        voxel: found.voxel,
        points: found.cells.iter().map(|cell| cell.tip.to_array().map(short)).collect(),
        dexterity: found.cells.iter().map(|cell| short(cell.dexterity.least_motion())).collect(),
        dimension: found.dimension,
        measure: found.measure,
        complete: found.is_complete,
    }
}

/// For the robot of a file within its limits, by what the case commands.
fn solver(
    file: &CaseFile,
    preset: ModelPreset,
    case: &Case,
    cancel: &Cancel,
) -> Result<InverseSolver, String> {
    let robot = &file.robot;
    let words = |error: InverseError| error.to_string();
    let model: Model = preset.model(Stations::Disks, robot.disks().count() - 1);
    let model = model.cancelled_by(cancel);
    let by = CommandedBy::Case;
    let actuators = Actuator::of(robot, case, preset.kind, by).map_err(words)?;
    let limits = file.goal.limits(robot, &actuators).map_err(|mismatch| mismatch.words(robot))?;
    InverseSolver::new(&model, robot, case, &limits, by).map_err(words)
}

/// Whether a slider moves what an actuator does.
fn moves(slider: Slider, actuator: Actuator) -> bool {
    match (slider, actuator) {
        (Slider::Motor(motor), Actuator::Motor(other)) => motor == other,
        (Slider::Cable(cable), Actuator::Tension(other) | Actuator::Shortening(other)) => {
            cable == other
        }
        _ => false,
    }
}

fn by_sliders(
    reached: &Reached,
    actuators: &[Actuator],
    (sliders, commands): (&[Slider], &[Command]),
) -> Vec<Command> {
    let of = |(slider, command): (&Slider, &Command)| {
        let found = actuators.iter().position(|actuator| moves(*slider, *actuator));
        match found.map(|number| (actuators[number], reached.commands[number])) {
            Some((Actuator::Tension(_), value)) => Command::Tension(value),
            Some((Actuator::Shortening(_), value)) => Command::Shortening(value),
            Some((Actuator::Motor(_), value)) => Command::Motor(value),
            None => *command,
        }
    };
    sliders.iter().zip(commands).map(of).collect()
}

fn slider_of(limit: Limit, actuators: &[Actuator], sliders: &[Slider]) -> Option<usize> {
    let is_of = |slider: &Slider| match limit {
        Limit::LeastCommand(number) | Limit::GreatestCommand(number) => {
            moves(*slider, actuators[number])
        }
        Limit::LeastTension(cable)
        | Limit::GreatestTension(cable)
        | Limit::LeastShortening(cable)
        | Limit::GreatestShortening(cable) => *slider == Slider::Cable(cable),
        Limit::Effort(motor) => *slider == Slider::Motor(motor),
        Limit::Clearance(_) => false,
    };
    sliders.iter().position(is_of)
}
