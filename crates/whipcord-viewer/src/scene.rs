//! A robot file as the page is told of it.

use whipcord::presets::Preset;
use whipcord::{
    Actuation, CableCommand, Case, Drive, LoadFrame, Model, ModelKind, ModelPreset, Motor,
    Prepared, Robot, Section, SolveError, StabilityAnalysis, Stations, Vec3,
};
use whipcord_io::{CaseFile, FileWarning};
use whipcord_plot::{CableCourse, plates_of};

use crate::convert::{array, pose};
use crate::courses;
use crate::error::ViewError;
use crate::holes::holes_of;
use crate::loads::loads;
use crate::measured;
use crate::obstacles;
use crate::protocol::{self, Command, Disk, ModelChoice, Request, Scene, Slider};
use crate::ranges::{motor_reach, ranges};
use crate::stations::Places;

/// What the page is told of a file.
pub fn scene(file: &CaseFile) -> Scene {
    let (robot, case) = (&file.robot, &file.case);
    let places = Places::of(robot);
    let initial_lengths = initial_lengths(robot, &places);
    let choices: Vec<_> = offered().into_iter().map(|one| (one, choice(file, one))).collect();
    let first = choices.iter().find(|(_, choice)| choice.refusal.is_none()).map(|&(one, _)| one);
    let models = choices.into_iter().map(|(_, choice)| choice).collect();
    let named = first.map(|one| one.name().to_owned());
    let sliders = sliders(robot, case);
    let initial = Request {
        models: named.into_iter().collect(),
        ..initial(file, &sliders, &initial_lengths)
    };
    let ranges = ranges(robot, &initial);
    let names = |path: &std::path::Path| {
        path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    };
    Scene {
        title: file.title.clone(),
        file: names(&file.path),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        length: robot.backbone().length,
        section: section(robot, &places.arc_lengths),
        disks: disks(robot, &places),
        cables: cables(robot, &places, &initial_lengths),
        stations: places.arc_lengths,
        base: pose(&case.base),
        models,
        motors: motors(file, &ranges),
        sliders,
        ranges,
        initial,
        loads_in_base: case.loads.frame == LoadFrame::Base,
        tip_follower: case.loads.tip_follower,
        loads: loads(&case.loads, robot.backbone().length),
        other_loads: other_loads(file),
        courses: courses::choices(file),
        measured: measured::by_step(file, first),
        cameras: measured::cameras(file),
        obstacles: case.obstacles.iter().map(obstacles::obstacle).collect(),
        warnings: warnings(file),
    }
}

/// Warnings about the file.
fn warnings(file: &CaseFile) -> Vec<protocol::Warning> {
    let told = |warning: FileWarning| {
        let place = warning.place(file).map(|(_, at)| format!("line {}: ", at.line));
        let message = format!("{}{}", place.unwrap_or_default(), warning.message());
        protocol::Warning { message, help: warning.warning.help() }
    };
    file.warnings().into_iter().map(told).collect()
}

/// Makes these models, each once, those that the page begins with; without any it is the first that takes the robot.
///
/// # Errors
/// [`ViewError::Refused`] for a model that does not take the robot.
pub fn begin_with(scene: &mut Scene, models: &[ModelPreset]) -> Result<(), ViewError> {
    let mut names: Vec<String> = Vec::new();
    for name in models.iter().map(|one| one.name()) {
        let refusal = scene.models.iter().find(|choice| choice.name == name);
        if let Some(message) = refusal.and_then(|choice| choice.refusal.clone()) {
            return Err(ViewError::Refused { message });
        }
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    if !names.is_empty() {
        scene.initial.models = names;
    }
    Ok(())
}

/// The model at the stations of frames, each cable driven by what it is told.
pub fn model(preset: ModelPreset, places: &Places) -> Model {
    let stations = Stations::At(places.arc_lengths.clone());
    preset.model(stations, places.disks.len() - 1).with_stability(StabilityAnalysis::Eigenvalue)
}

fn section(robot: &Robot, stations: &[f64]) -> protocol::Section {
    let disks = robot.disks();
    let along = |along: &whipcord::Along<f64>| -> Vec<f64> {
        stations.iter().map(|&s| along.at(disks, s)).collect()
    };
    match &robot.backbone().section {
        None => protocol::Section::Unknown,
        Some(Section::Round { outer, inner }) => {
            protocol::Section::Round { outer: along(outer), inner: along(inner) }
        }
        Some(Section::Rectangle { width, height }) => {
            protocol::Section::Rectangle { width: along(width), height: along(height) }
        }
    }
}

fn disks(robot: &Robot, places: &Places) -> Vec<Disk> {
    let plates = plates_of(robot).into_iter().zip(&places.disks);
    plates
        .map(|(plate, &station)| Disk {
            station,
            radius: plate.radius,
            thickness: plate.thickness,
            holes: plate.holes,
            hole_radius: plate.hole_radius,
        })
        .collect()
}

/// The cables as the page draws them.
pub fn cables(robot: &Robot, places: &Places, initial: &[f64]) -> Vec<protocol::Cable> {
    let all = robot.cables().iter().zip(robot.routes()).zip(&places.anchors).zip(initial);
    let all = all.zip(holes_of(robot));
    all.map(|((((cable, route), &anchor), &initial_length), holes)| {
        let course = places.arc_lengths[..=anchor].iter().map(|&s| {
            let offset = route.at(s.min(route.end())).offset;
            [offset.x, offset.y]
        });
        let (name, course) = (cable.name.clone(), course.collect());
        protocol::Cable { name, course, holes, initial_length }
    })
    .collect()
}

/// What can be moved: the motors that the file commands, and the cables that none of them pulls.
pub fn sliders(robot: &Robot, case: &Case) -> Vec<Slider> {
    let is_told = |motor: usize| case.motor_command(motor).is_some();
    let motors = (0..robot.motors().len()).filter(|&motor| is_told(motor)).map(Slider::Motor);
    let cables = (0..robot.cables().len())
        .filter(|&cable| !robot.motor_of(cable).is_some_and(is_told))
        .map(Slider::Cable);
    motors.chain(cables).collect()
}

fn motors(file: &CaseFile, ranges: &protocol::Ranges) -> Vec<protocol::Motor> {
    let of = |(number, motor): (usize, &Motor)| protocol::Motor {
        name: motor.name.clone(),
        is_angular: matches!(motor.drive, Drive::Spool { .. }),
        reach: motor_reach(motor, ranges, file.case.motor_command(number)),
        pulls: motor.cables.iter().map(|of| (of.cable, of.pull() / motor.gear_ratio())).collect(),
        limit: motor.limits.effort,
    };
    file.robot.motors().iter().enumerate().map(of).collect()
}

/// Lengths of the cables before actuation in m, by the first model that takes the robot; the lengths of their courses
/// along a straight backbone where none does.
pub fn initial_lengths(robot: &Robot, places: &Places) -> Vec<f64> {
    let at_rest = whipcord::at_rest(robot, whipcord::Pose::IDENTITY, &Stations::Disks);
    if let Some(solution) = at_rest {
        return solution.cables.iter().map(|cable| cable.initial_length).collect();
    }
    let of = |(route, &anchor): (&whipcord::robot::Route, &usize)| -> f64 {
        let point = |s: f64| route.at(s.min(route.end())).offset + Vec3::Z * s;
        let ends = places.arc_lengths[..=anchor].windows(2);
        ends.map(|s| (point(s[1]) - point(s[0])).norm()).sum()
    };
    robot.routes().iter().zip(&places.anchors).map(of).collect()
}

/// What the file asks for, as the page would. A cable that the file gives both commands is driven by its tension.
fn initial(file: &CaseFile, sliders: &[Slider], initial_lengths: &[f64]) -> Request {
    let case = &file.case;
    let of_cable = |cable: usize| match (
        case.commands.get(cable).copied().unwrap_or_default(),
        initial_lengths.get(cable).copied().unwrap_or_default(),
    ) {
        (CableCommand { tension: Some(tension), .. }, _) => Command::Tension(tension),
        (CableCommand { shortening: Some(shortening), .. }, length) => {
            Command::Shortening(shortening.in_metres(length))
        }
        (CableCommand { tension: None, shortening: None }, _) => Command::Tension(0.0),
    };
    let commands = sliders.iter().map(|&slider| match slider {
        Slider::Cable(cable) => of_cable(cable),
        Slider::Motor(motor) => Command::Motor(case.motor_command(motor).unwrap_or_default()),
    });
    let loads = &case.loads;
    Request {
        id: 0,
        commands: commands.collect(),
        tip_force: array(loads.tip_force),
        tip_moment: array(loads.tip_moment),
        gravity: array(loads.gravity.unwrap_or_default()),
        models: Vec::new(),
        compliance: false,
        target: None,
        pull: None,
        holes: Vec::new(),
    }
}

/// What can be chosen: all models, then their presets that answer something else, so that a model has the colour
/// that it has in the figures of the command line.
pub fn offered() -> Vec<ModelPreset> {
    let all = ModelPreset::of(&ModelKind::ALL).into_iter();
    let (usual, others): (Vec<_>, Vec<_>) = all
        .filter(|one| one.preset != Preset::StepPerSection)
        .partition(|one| one.preset == Preset::Usual);
    [usual, others].concat()
}

fn choice(file: &CaseFile, preset: ModelPreset) -> ModelChoice {
    ModelChoice {
        name: preset.name().to_owned(),
        hole_to_hole: CableCourse::of(preset.kind) == CableCourse::HoleToHole,
        jointed: preset.kind == ModelKind::PseudoRigidBody,
        refusal: refusal(file, preset),
    }
}

/// Why a model does not take the robot among its obstacles, whatever its cables are told.
fn refusal(file: &CaseFile, preset: ModelPreset) -> Option<String> {
    let model = preset.model(Stations::Disks, file.robot.disks().arc_lengths.len() - 1);
    let mut prepared: Prepared = match model.prepare(&file.robot, &file.case.loads) {
        Ok(prepared) => prepared,
        Err(error) => return Some(error.to_string()),
    };
    // What only a solve finds missing or cannot take is found by one in which nothing pulls.
    let mut case = file.case.commanded(file.case.commands.clone());
    case.before.clear();
    case.loads_before.clear();
    case.loads.tip_force = Vec3::ZERO;
    case.loads.tip_moment = Vec3::ZERO;
    case.loads.gravity = None;
    for command in &mut case.commands {
        *command = match preset.kind.natural_actuation() {
            Actuation::Shortening => Command::Shortening(0.0).command(),
            _ => Command::Tension(0.0).command(),
        };
    }
    match prepared.solve(&case, None) {
        Err(
            error @ (SolveError::Missing { .. }
            | SolveError::Unsupported { .. }
            | SolveError::Invalid(_)),
        ) => Some(error.to_string()),
        _ => None,
    }
}

/// Loads of the file that no slider moves.
fn other_loads(file: &CaseFile) -> Vec<String> {
    let loads = &file.case.loads;
    let mut words = Vec::new();
    let mut say = |count: usize, one: &str, several: &str| match count {
        0 => {}
        1 => words.push(one.to_owned()),
        n => words.push(format!("{n} {several}")),
    };
    say(loads.points.len(), "a load at a point", "loads at points");
    say(loads.distributed.len(), "a distributed load", "distributed loads");
    say(loads.masses.len(), "a mass that is carried", "masses that are carried");
    words
}
