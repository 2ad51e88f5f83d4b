//! The derivatives of the models in equilibrium under loads against differences of their own solutions on the same steps,
//! on random robots: every parameter, command and load, both ways of holding cables, forward and
//! backward.

/// Tests of each model, under its name.
macro_rules! for_every_model {
    ($($name:ident),*) => {
        mod continuous_cables {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::Continuous);
            })*
        }
        mod from_hole_to_hole {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::Disks);
            })*
        }
        for_models_of_sections!($($name),*);
    };
}

/// The same of the models of sections.
macro_rules! for_models_of_sections {
    ($($name:ident),*) => {
        mod arcs {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::Arcs);
            })*
        }
        mod rigid_bodies {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::RigidBodies);
            })*
        }
        mod four_bar_sections {
            $(#[test]
            fn $name() {
                super::$name(crate::derivatives::Tested::FourBar);
            })*
        }
    };
}

mod backbone_that_rubs;
mod backward;
mod bending_friction;
mod bending_friction_steps;
mod command_changes;
mod commands_and_compliance;
mod contact;
mod four_bar;
mod friction_in_contact;
mod hole_friction;
mod kinds_of_load;
mod locked_in_contact;
mod objects_that_rub;
mod obstacles_that_rub;
mod segments;

use crate::common;
use crate::common::Wildness;
use whipcord::cosserat::{Accuracy, Options};
use whipcord::derivatives::{Change, Hold, Place};
use whipcord::differences::{Difference, differentiate};
use whipcord::{
    Cable, CableCommand, Case, DistributedLoad, Linearization, Model, Parameter, Prepared, Profile,
    Robot, Routing, Shortening, Solution, SolveError, StabilityAnalysis, Stations, Stiffness,
    StiffnessPart, Twist, Vec3, piecewise_constant_curvature, pseudo_rigid_body,
};

/// The model that is differentiated.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tested {
    Continuous,
    Disks,
    Arcs,
    RigidBodies,
    FourBar,
}

impl Tested {
    fn prepare(
        self,
        robot: &Robot,
        case: &Case,
        options: &Options,
    ) -> Result<Prepared, SolveError> {
        let stations = options.stations.clone();
        let (residual, stability) = (SECTION_RESIDUAL, options.stability);
        let model = match self {
            Self::Continuous => Model::Cosserat(options.clone()),
            Self::Disks => Model::CosseratDisks(options.clone()),
            Self::Arcs => {
                let options = piecewise_constant_curvature::Options {
                    stations,
                    residual,
                    stability,
                    ..Default::default()
                };
                Model::PiecewiseConstantCurvature(options)
            }
            Self::RigidBodies => {
                let options = pseudo_rigid_body::Options {
                    stations,
                    residual,
                    stability,
                    ..Default::default()
                };
                Model::PseudoRigidBody(options)
            }
            Self::FourBar => Model::FourBar(whipcord::four_bar::Options {
                stations,
                residual,
                stability,
                objective: whipcord::four_bar::Objective::StrainEnergy,
                lengths: whipcord::four_bar::LengthRule::Free,
                ..Default::default()
            }),
        };
        model.prepare(robot, &case.loads)
    }

    fn solve(
        self,
        robot: &Robot,
        case: &Case,
        options: &Options,
        from: Option<&Solution>,
    ) -> Result<Solution, SolveError> {
        let mut prepared = self.prepare(robot, case, options)?;
        let rubs = robot.cables().iter().any(|cable| cable.friction.is_some());
        if self == Self::FourBar || (rubs && self == Self::Continuous) {
            // Of given lengths alone the former is found by other means, to fewer digits than differences need; and so are tensions
            // that vary along cables.
            return prepared.solve_with_derivatives(case, from, &[]).map(|(solution, _)| solution);
        }
        prepared.solve(case, from)
    }

    fn solve_with_derivatives(
        self,
        robot: &Robot,
        case: &Case,
        options: &Options,
        parameters: &[Parameter],
    ) -> Result<(Solution, Linearization), SolveError> {
        self.prepare(robot, case, options)?.solve_with_derivatives(case, None, parameters)
    }

    /// Whether it has strains, which may be coupled, along the whole backbone.
    const fn is_rod(self) -> bool {
        matches!(self, Self::Continuous | Self::Disks)
    }

    /// Whether no section of it folds under this.
    fn stands(self, robot: &Robot, case: &Case) -> bool {
        let solved = self.solve(robot, case, &options(self, case), None);
        self.is_rod() || !matches!(solved, Err(SolveError::SectionFolds { .. }))
    }

    /// One step between each two places of the robot, so that its measures do not move the steps; between disks a few, because
    /// in steps so long that the norm of the quaternion counts it is not the same in all frames.
    const fn steps(self) -> usize {
        match self {
            Self::Continuous => 1,
            Self::Disks | Self::Arcs | Self::RigidBodies | Self::FourBar => 40,
        }
    }
}

fn bending_stiffness(robot: &Robot) -> f64 {
    match &robot.backbone().stiffness {
        Some(given) => given.at_end(robot.disks(), 0.0, 0.0)[3][3],
        None => common::bending_stiffness(robot),
    }
}

/// What rounding leaves of the equations of sections.
const SECTION_RESIDUAL: f64 = 1e-14;

const FINE: usize = 192;

const BARE: usize = 24;

/// A prescribed number of steps, so that neighbouring cases are solved on the same ones.
fn options(tested: Tested, case: &Case) -> Options {
    // Without load it is the rod under no load that is differentiated, which is integrated otherwise:
    // the two agree to the error of discretisation.
    let steps = match case.commands.len() {
        _ if case.loads.is_none() => FINE,
        // Nothing of a bare rod moves the steps.
        0 => BARE,
        _ => tested.steps(),
    };
    Options {
        stations: Stations::Equal(4),
        accuracy: Accuracy::Steps(steps),
        residual: 1e-14,
        stability: StabilityAnalysis::Off,
        ..Options::default()
    }
}

fn differentiated(
    tested: Tested,
    robot: &Robot,
    case: &Case,
    parameters: &[Parameter],
) -> (Solution, Linearization) {
    tested
        .solve_with_derivatives(robot, case, &options(tested, case), parameters)
        .unwrap_or_else(|e| panic!("{e}\n{robot:?}\n{case:?}"))
}

fn solve_near(
    tested: Tested,
    robot: &Robot,
    case: &Case,
    at: &Solution,
) -> Result<Solution, SolveError> {
    // On the steps of that answer.
    let steps = match case.commands.len() {
        _ if at.diagnostics.steps >= FINE => FINE,
        0 => BARE,
        _ => tested.steps(),
    };
    let accuracy = Accuracy::Steps(steps);
    // Obstacles that rub remember the way from rest.
    let at = Some(at).filter(|_| case.obstacles.iter().all(|obstacle| obstacle.friction == 0.0));
    tested.solve(robot, case, &Options { accuracy, ..options(tested, case) }, at)
}

/// How far off differences of each of these steps are, where none is within the tolerance: they err by what they leave out or by
/// rounding, with one step or another. Steps after the first that agrees are not tried.
fn off_with_all(
    steps: impl IntoIterator<Item = f64>,
    tolerance: f64,
    off: impl Fn(f64) -> f64,
) -> Result<(), Vec<f64>> {
    let mut all = Vec::new();
    for step in steps {
        let off = off(step);
        if off <= tolerance {
            return Ok(());
        }
        all.push(off);
    }
    Err(all)
}

/// Everything that a robot and case can be differentiated by, with a step for differences.
fn parameters(tested: Tested, robot: &Robot, case: &Case) -> Vec<(Parameter, f64)> {
    let length = robot.backbone().length;
    let stiffness = bending_stiffness(robot);
    let (force, moment) = (stiffness / length.powi(2), stiffness / length);
    let mut all = vec![
        Parameter::YoungModulus,
        Parameter::ShearModulus,
        Parameter::PoissonRatio,
        Parameter::Density,
        Parameter::Diameter,
        Parameter::InnerDiameter,
        Parameter::Width,
        Parameter::Height,
        Parameter::ShearCorrection,
        Parameter::LinearDensity,
        Parameter::Stiffness { row: 0, column: 0 },
        Parameter::Stiffness { row: 3, column: 3 },
        Parameter::Stiffness { row: 4, column: 4 },
        Parameter::Stiffness { row: 5, column: 5 },
        Parameter::Stiffness { row: 3, column: 5 },
        Parameter::Stiffness { row: 2, column: 4 },
        Parameter::DiskMass,
        Parameter::HoleRadius,
        Parameter::YieldMoment { axis: None },
        Parameter::YieldMoment { axis: Some(1) },
        Parameter::YieldStiffness { axis: None },
        Parameter::YieldStiffness { axis: Some(0) },
    ];
    for segment in 0..robot.backbone().segments.len() {
        let parts = [StiffnessPart::Shear, StiffnessPart::Extension];
        let parts = parts.into_iter().filter(|_| tested.is_rod());
        let parts = parts.chain([StiffnessPart::Bending, StiffnessPart::Torsion]);
        all.extend(parts.map(|part| Parameter::SegmentFactor { segment, part }));
    }
    for disk in [0, 1, robot.disks().count() - 1] {
        all.push(Parameter::DiameterAt { entry: disk });
        // Monotone interpolation has kinks in the values at single disks.
        let kinked = robot.cables().iter().any(|c| {
            matches!(&c.routing, Routing::Holes { interpolation, .. }
                if *interpolation == whipcord::Interpolation::Pchip)
        });
        if !kinked {
            all.push(Parameter::HoleRadiusAt { disk });
        }
        all.push(Parameter::RestCurvatureAt { entry: disk, axis: 1 });
    }
    for axis in 0..3 {
        all.push(Parameter::RestCurvature { axis });
        all.push(Parameter::Gravity { axis });
        all.push(Parameter::TipForce { axis });
        all.push(Parameter::TipMoment { axis });
        for load in 0..case.loads.points.len() {
            all.push(Parameter::PointForce { load, axis });
            all.push(Parameter::PointMoment { load, axis });
        }
    }
    for load in 0..case.loads.distributed.len() {
        for axis in 0..3 {
            all.push(Parameter::LineForce { load, axis });
            all.push(Parameter::LineMoment { load, axis });
            for entry in 0..2 {
                all.push(Parameter::LineForceAt { load, entry, axis });
                all.push(Parameter::LineMomentAt { load, entry, axis });
            }
        }
    }
    all.extend((0..case.loads.masses.len()).map(|mass| Parameter::PointMass { mass }));
    for cable in 0..robot.cables().len() {
        all.push(Parameter::Angle { cable });
        all.push(Parameter::Radius { cable });
        all.push(Parameter::Turns { cable });
        all.push(Parameter::AxialStiffness { cable });
        all.push(Parameter::Friction { cable: Some(cable) });
        for axis in 0..2 {
            all.push(Parameter::Start { cable, axis });
            all.push(Parameter::End { cable, axis });
            for power in 0..4 {
                all.push(Parameter::Coefficient { cable, axis, power });
            }
        }
    }
    let rod_mass = robot.backbone().linear_density_at(robot.disks(), 0.0).unwrap_or(0.01) * length;
    all.into_iter()
        .filter_map(|p| {
            let value = p.value(robot, case).ok()?;
            if matches!(p, Parameter::Stiffness { row, column } if row != column)
                && !tested.is_rod()
            {
                return None;
            }
            // Without density no weight is known.
            if matches!(p, Parameter::Gravity { .. }) {
                robot.backbone().linear_density_at(robot.disks(), 0.0)?;
            }
            let scale = match p {
                Parameter::RestCurvature { .. } | Parameter::RestCurvatureAt { .. } => 1.0 / length,
                Parameter::Gravity { .. } => 0.3 * force / rod_mass,
                Parameter::TipForce { .. } | Parameter::PointForce { .. } => 0.3 * force,
                Parameter::TipMoment { .. } | Parameter::PointMoment { .. } => 0.3 * moment,
                Parameter::LineForce { .. } | Parameter::LineForceAt { .. } => 0.5 * force / length,
                Parameter::LineMoment { .. } | Parameter::LineMomentAt { .. } => {
                    0.5 * moment / length
                }
                Parameter::PointMass { .. } => 0.3 * rod_mass,
                Parameter::Angle { .. } | Parameter::Turns { .. } => 1.0,
                Parameter::PoissonRatio => 0.5,
                Parameter::Coefficient { power, .. } => 0.05 * length.powi(1 - power as i32),
                Parameter::Start { .. } | Parameter::End { .. } => 0.05 * length,
                Parameter::DiskMass => rod_mass / robot.disks().count() as f64,
                _ => value,
            };
            let step = if scale == 0.0 { 1e-3 * length } else { 2e-3 * scale };
            // A mass cannot be negative.
            let possible = p.moved(robot, case, 4.0 * step).is_ok()
                && p.moved(robot, case, -4.0 * step).is_ok();
            possible.then_some((p, step.abs()))
        })
        .collect()
}

/// Largest difference between a change and differences, relative to the largest part of them, or to what counts as nothing.
fn off_above(floor: f64, change: &Change, difference: &Difference, robot: &Robot) -> f64 {
    let length = robot.backbone().length;
    let moment = bending_stiffness(robot) / length;
    let (mut worst, mut size) = (0.0_f64, 0.0_f64);
    let mut compare = |a: f64, b: f64, unit: f64| {
        worst = worst.max((a - b).abs() / unit);
        size = size.max(b.abs() / unit);
    };
    let mut twist = |a: Twist, b: &Twist| {
        for i in 0..3 {
            compare(a.linear[i], b.linear[i], length);
            compare(a.angular[i], b.angular[i], 1.0);
        }
    };
    for (i, expected) in difference.stations.iter().enumerate() {
        twist(change.twist(Place::Station(i)), expected);
    }
    for (i, expected) in difference.disks.iter().enumerate() {
        twist(change.twist(Place::Disk(i)), expected);
    }
    for (a, b) in change.lengths().iter().zip(&difference.lengths) {
        compare(*a, *b, length);
    }
    for (a, b) in change.tensions().iter().zip(&difference.tensions) {
        compare(*a, *b, moment / length);
    }
    let (a, b) = (change.base_wrench(), difference.base_wrench);
    for i in 0..3 {
        compare(a.force[i], b.force[i], moment / length);
        compare(a.moment[i], b.moment[i], moment);
    }
    assert!(worst.is_finite() && size.is_finite());
    worst / size.max(floor)
}

/// The same of something that matters.
fn off(change: &Change, difference: &Difference, robot: &Robot) -> f64 {
    off_above(f64::MIN_POSITIVE, change, difference, robot)
}

/// What a change of a parameter that matters does, relative to length and bending, counts as nothing below this.
const NOTHING: f64 = 1e-8;

/// Differences leave about this much, relative to the largest change.
const TOLERANCE: f64 = 2e-7;

fn check_parameters(tested: Tested, robot: &Robot, case: &Case, failures: &mut String) -> usize {
    check_parameters_to(tested, TOLERANCE, robot, case, failures)
}

fn check_parameters_to(
    tested: Tested,
    tolerance: f64,
    robot: &Robot,
    case: &Case,
    failures: &mut String,
) -> usize {
    let all = parameters(tested, robot, case);
    let list: Vec<Parameter> = all.iter().map(|(p, _)| *p).collect();
    let (solution, derivatives) = differentiated(tested, robot, case, &list);
    for (i, (parameter, step)) in all.iter().enumerate() {
        let change = derivatives.parameter(i, Hold::Commands);
        let off = |step: f64| {
            let difference = differentiate(
                |by| {
                    let (robot, case) = parameter.moved(robot, case, by)?;
                    solve_near(tested, &robot, &case, &solution)
                },
                step,
            );
            let difference = difference.unwrap_or_else(|e| panic!("{parameter}: {e}\n{robot:?}"));
            // The steps are this part of changes that matter.
            let floor = NOTHING * 2e-3 / step;
            off_above(floor, &change, &difference, robot)
        };
        // Shear, and twist where cables run straight, hardly count: little is left of differences.
        let tolerance = match parameter {
            Parameter::PoissonRatio | Parameter::ShearCorrection => 1e3 * tolerance,
            Parameter::SegmentFactor { part: StiffnessPart::Shear, .. } => 1e3 * tolerance,
            // Under a given tension a cable stretches to no effect, but between holes that hold it.
            Parameter::AxialStiffness { cable } if case.commands[*cable].tension.is_some() => {
                1e3 * tolerance
            }
            _ => tolerance,
        };
        if let Err(all) = off_with_all([1.0, 4.0, 0.125].map(|f| f * step), tolerance, off) {
            *failures += &format!("{parameter}: {all:?}\n");
        }
    }
    all.len()
}

/// With distributed loads of nothing, which something can become.
fn with_room(case: &Case, length: f64) -> Case {
    let stretch = Profile::Constant {
        from: 0.25 * length,
        to: 0.75 * length,
        force: Vec3::ZERO,
        moment: Vec3::ZERO,
    };
    let none = vec![Vec3::ZERO; 2];
    let linear = Profile::Linear { at: vec![0.0, length], force: none.clone(), moment: none };
    let load = |profile: &Profile, follower| DistributedLoad { profile: profile.clone(), follower };
    let mut case = case.clone();
    case.loads.distributed = vec![load(&stretch, false), load(&linear, true)];
    case
}

fn check_random(tested: Tested, wild: Wildness, count: usize) {
    let mut failures = String::new();
    let mut checked = 0;
    let samples = common::samples(common::robot(wild), 2 * count);
    let samples = samples.filter(|(robot, case)| tested.stands(robot, case)).take(count);
    for (i, (robot, case)) in samples.enumerate() {
        let case = with_room(&case, robot.backbone().length);
        let before = failures.len();
        checked += check_parameters(tested, &robot, &case, &mut failures);
        if failures.len() > before {
            failures += &format!("  of robot {i}: {:?}\n", robot.cables());
        }
    }
    assert!(failures.is_empty(), "{failures}");
    println!("{checked} derivatives by parameters of {count} robots");
}

const ROBOTS: usize = if cfg!(debug_assertions) { 1 } else { 6 };

fn parameters_under_loads(tested: Tested) {
    check_random(tested, Wildness::LOADED, ROBOTS);
}

fn parameters_without_load(tested: Tested) {
    check_random(tested, Wildness::UNLOADED, ROBOTS);
}

/// Stiffness that is given itself, with terms beside its diagonal, or along which strains are held.
fn given_stiffness(tested: Tested) {
    let matrix = {
        let mut k = [[0.0; 6]; 6];
        for (i, value) in [3e3, 2.5e3, 8e3, 4e-3, 6e-3, 3e-3].into_iter().enumerate() {
            k[i][i] = value;
        }
        for (i, j, value) in [(3, 5, 8e-4), (2, 4, 0.9), (0, 3, -0.4)] {
            (k[i][j], k[j][i]) = (value, value);
        }
        Stiffness::Matrix(k.into())
    };
    let diagonal = Stiffness::diagonal([3e3, 2.5e3], 8e3, [4e-3, 6e-3], 3e-3);
    let mut failures = String::new();
    let coupled = [(matrix.clone(), true), (matrix, false)];
    let coupled = coupled.into_iter().filter(|_| tested.is_rod());
    for (stiffness, extensible) in coupled.chain([(diagonal, true)]) {
        let backbone = whipcord::Backbone {
            stiffness: Some(stiffness),
            linear_density: Some(0.02.into()),
            extensible,
            shearable: extensible,
            ..whipcord::Backbone::new(0.18)
        };
        let cables = [common::straight(20.0), common::helix(80.0, 0.5)];
        let cables = cables.into_iter().enumerate();
        let cables = cables.map(|(i, r)| Cable::new(format!("{i}"), r)).collect();
        let robot = Robot::new(backbone, common::paper_disks(), cables).unwrap();
        let mut case = Case::with_tensions(&[2.0, 1.5]);
        case.loads.tip_force = Vec3::new(0.05, 0.1, -0.05);
        case.loads.gravity = Some(Vec3::new(0.0, 9.81, 0.0));
        check_parameters(tested, &robot, &case, &mut failures);
    }
    assert!(failures.is_empty(), "{failures}");
}

/// A case in which the cables are as long as they are now, but for every second one, which keeps its
/// tension, and the robot with some of its cables elastic.
fn by_length(tested: Tested, robot: &Robot, case: &Case, all: bool) -> (Robot, Case) {
    let elastic = |(i, cable): (usize, &Cable)| Cable {
        axial_stiffness: (i % 3 == 1)
            .then(|| 300.0 * bending_stiffness(robot) / robot.backbone().length.powi(2)),
        ..cable.clone()
    };
    let cables = robot.cables().iter().enumerate().map(elastic).collect();
    let robot = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
    let solution = tested.solve(&robot, case, &options(tested, case), None).unwrap();
    let command = |(i, (state, given)): (usize, (&whipcord::CableState, &CableCommand))| {
        if !all && i % 2 == 1 {
            return *given;
        }
        let stiffness = robot.cables()[i].axial_stiffness;
        let stretch = stiffness.map_or(0.0, |k| state.initial_length * state.tension.unwrap() / k);
        let shortening = state.initial_length - state.length + stretch;
        let shortening = if i % 4 == 0 {
            Shortening::Length(shortening)
        } else {
            Shortening::Fraction(shortening / state.initial_length)
        };
        CableCommand { tension: None, shortening: Some(shortening) }
    };
    let commands = solution.cables.iter().zip(&case.commands).enumerate().map(command).collect();
    (robot, Case { commands, ..case.clone() })
}

/// Random robots whose cables are all so taut that no difference lets one go slack, and so few that
/// their lengths are independent.
fn taut(tested: Tested, wild: Wildness, count: usize) -> impl Iterator<Item = (Robot, Case)> {
    let wild = Wildness { cables: 3, ..wild };
    common::samples(common::robot(wild), 4 * count)
        .filter(move |(robot, case)| tested.stands(robot, case))
        .filter(|(robot, case)| {
            let length = robot.backbone().length;
            let unit = bending_stiffness(robot) / length / (0.05 * length);
            case.commands.iter().all(|c| c.tension.unwrap() > 0.05 * unit)
        })
        .take(count)
}

for_every_model!(parameters_under_loads, parameters_without_load, given_stiffness);
