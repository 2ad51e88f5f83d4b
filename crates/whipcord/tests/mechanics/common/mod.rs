//! Random robots and cases. Their scales are chosen without dimension: a tension of 1 would bend
//! the rod by about 1 rad over its length, a force of 1 is `EI/L²`, a moment of 1 is `EI/L`.

pub mod bending;
pub mod load_kind;
pub mod sections;
pub mod solve_times;
pub mod symmetry;

use core::f64::consts::TAU;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngSeed, TestRunner};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::{
    Actuation, Along, Backbone, Cable, CableCommand, Case, Disks, Interpolation, Loads, Material,
    Model, ModelKind, PointLoad, RestCurvature, Robot, Routing, Section, Shortening, Solution,
    SolveError, StabilityAnalysis, Statics, Stations, Vec3, four_bar,
};

/// As many cases as are given, the same in every run.
pub fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(0x7768_6970_636f_7264),
        failure_persistence: None,
        max_shrink_iters: 200,
        ..ProptestConfig::default()
    }
}

/// So many values of a strategy, the same in every run; without a search for the smallest one that
/// fails, for what takes long.
pub fn samples<S: Strategy>(strategy: S, count: usize) -> impl Iterator<Item = S::Value> {
    let mut runner = TestRunner::new(config(1));
    (0..count).map(move |_| strategy.new_tree(&mut runner).unwrap().current())
}

/// How wild the robots are.
#[derive(Clone, Copy, Debug)]
pub struct Wildness {
    pub cables: usize,
    /// Of each cable.
    pub tension: f64,
    pub force: f64,
    pub moment: f64,
    /// Weight of the rod times `L²/EI`.
    pub weight: f64,
}

impl Wildness {
    pub const UNLOADED: Self =
        Self { cables: 6, tension: 1.2, force: 0.0, moment: 0.0, weight: 0.0 };
    pub const LOADED: Self = Self { cables: 6, tension: 0.8, force: 1.0, moment: 0.7, weight: 1.0 };

    pub fn loaded(&self) -> bool {
        self.force > 0.0 || self.moment > 0.0 || self.weight > 0.0
    }
}

pub fn bending_stiffness(robot: &Robot) -> f64 {
    let section = robot.backbone().section_at(robot.disks(), 0.0).unwrap();
    let material = &robot.backbone().material;
    material.young_modulus.unwrap() * section.second_moment_x.max(section.second_moment_y)
}

pub fn round(length: f64, diameter: f64, young: f64, shear: f64) -> Backbone {
    Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(young),
            shear_modulus: Some(shear),
            ..Material::default()
        },
        ..Backbone::new(length)
    }
}

/// A round rod of 180 mm × 3 mm, E = 1.1 GPa, ν = 0.3: that of the paper.
pub fn paper_backbone() -> Backbone {
    Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(0.18)
    }
}

/// The paper's disks: ten of them, twelve holes at 8 mm.
pub fn paper_disks() -> Disks {
    Disks::equally_spaced(0.18, 10, 0.008).with_holes(12)
}

/// The paper's rod with these routings.
pub fn paper_robot(routings: Vec<Routing>) -> Robot {
    let cable = |(i, routing)| Cable::new(format!("cable {i}"), routing);
    let cables = routings.into_iter().enumerate().map(cable).collect();
    Robot::new(paper_backbone(), paper_disks(), cables).unwrap()
}

pub fn straight(degrees: f64) -> Routing {
    Routing::Straight { angle: degrees.to_radians(), radius: 0.008 }
}

pub fn helix(degrees: f64, turns: f64) -> Routing {
    Routing::Helix { start_angle: degrees.to_radians(), turns, radius: 0.008 }
}

pub fn solve_with(options: Options, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    Model::Cosserat(options).solve(robot, case)
}

/// A thousandth of the default tolerance.
pub const ACCURATE: f64 = 1e-9;

/// So accurate that closed forms and other formulations can be compared to many digits.
pub fn accurate() -> Options {
    Options { accuracy: Accuracy::Tolerance(ACCURATE), ..Options::default() }
}

/// By tension, with eleven stations.
pub fn solve(robot: &Robot, case: &Case) -> Solution {
    let options = Options {
        stations: Stations::Equal(11),
        stability: StabilityAnalysis::Eigenvalue,
        ..accurate()
    };
    solve_with(options, robot, case).unwrap_or_else(|e| panic!("{e}\n{robot:?}\n{case:?}"))
}

/// With an error of discretisation and iteration that does not count, and eleven stations.
pub fn fine_options() -> Options {
    Options {
        stations: Stations::Equal(11),
        accuracy: Accuracy::Tolerance(4e-13),
        residual: 1e-13,
        stability: StabilityAnalysis::Eigenvalue,
        ..Options::default()
    }
}

pub fn solve_finely(robot: &Robot, case: &Case) -> Solution {
    solve_with(fine_options(), robot, case).unwrap_or_else(|e| panic!("{e}\n{robot:?}\n{case:?}"))
}

/// The case in which the cables are as long as in a solution.
pub fn lengths_of(solution: &Solution, loads: &Loads) -> Case {
    let shorten = |c: &whipcord::CableState| CableCommand {
        tension: None,
        shortening: Some(Shortening::Length(c.initial_length - c.length)),
    };
    let commands = solution.cables.iter().map(shorten).collect();
    Case { commands, loads: loads.clone(), ..Case::default() }
}

/// By shortening, with eleven stations.
pub fn solve_lengths(robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
    let options = Options {
        stations: Stations::Equal(11),
        actuation: Actuation::Shortening,
        stability: StabilityAnalysis::Eigenvalue,
        ..accurate()
    };
    solve_with(options, robot, case)
}

/// How stable the shape is that the load leads to: the stability value of the answer, or where the robot has left
/// that shape for another one, by how much the fraction of the load at which it did falls short of all of it.
pub fn stability_of_path(solution: &Solution) -> f64 {
    let diagnostics = &solution.diagnostics;
    let left = diagnostics.stability_lost_at.filter(|_| diagnostics.stable == Some(true));
    left.map_or_else(
        || diagnostics.stability.unwrap_or_else(|| panic!("{diagnostics:?}")),
        |load| load - 1.0,
    )
}

pub fn tensions(solution: &Solution) -> Vec<f64> {
    solution.cables.iter().map(|c| c.tension.unwrap()).collect()
}

/// Largest distance between corresponding positions, at stations and disks, in m.
pub fn distance(a: &Solution, b: &Solution) -> f64 {
    let at = |a: &whipcord::Shape, b: &whipcord::Shape| a.distances(b).fold(0.0, f64::max);
    at(&a.shape, &b.shape).max(at(&a.disks, &b.disks))
}

/// A vector of the unit ball, or nearly.
pub fn ball() -> impl Strategy<Value = Vec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| {
        let v = Vec3::new(x, y, z);
        v / v.norm().max(1.0)
    })
}

/// A quantity that varies: at the disks, or at places given as fractions of the length, one of
/// them with a step.
fn varying<T: Clone + core::fmt::Debug>(
    value: impl Strategy<Value = T>,
    disks: usize,
) -> impl Strategy<Value = Along<T>> {
    (proptest::bool::ANY, 0.1..0.4, 0.5..0.9, vec(value, disks.max(4))).prop_map(
        move |(per_disk, a, b, mut values)| {
            values.truncate(if per_disk { disks } else { 4 });
            match per_disk {
                true => Along::PerDisk(values),
                false => Along::At { arc_lengths: vec![a, b, b, 1.0], values },
            }
        },
    )
}

fn section(disks: usize) -> impl Strategy<Value = Section> {
    // For a rod of unit diameter.
    prop_oneof![
        3 => Just(Section::circle(1.0)),
        1 => (0.3..0.8).prop_map(|inner| Section::tube(1.0, inner)),
        1 => (0.6..1.0).prop_map(|height| Section::rectangle(1.0, height)),
        1 => (varying(0.8..1.1, disks), prop_oneof![Just(0.0), 0.2..0.6])
            .prop_map(|(outer, inner)| Section::Round { outer, inner: inner.into() }),
        1 => varying(0.2..0.7, disks)
            .prop_map(|inner| Section::Round { outer: 1.0.into(), inner }),
        1 => (varying(0.8..1.1, disks), varying(0.6..0.9, disks))
            .prop_map(|(width, height)| Section::Rectangle { width, height }),
    ]
}

/// With the values times `scale`, the places times `length`.
fn sized<T>(along: &Along<T>, length: f64, scale: impl Fn(&T) -> T) -> Along<T> {
    match along.map(scale) {
        Along::At { arc_lengths, values } => {
            Along::At { arc_lengths: arc_lengths.iter().map(|s| s * length).collect(), values }
        }
        other => other,
    }
}

fn scaled(section: &Section, d: f64, length: f64) -> Section {
    let times = |along: &Along<f64>| sized(along, length, |x| x * d);
    match section {
        Section::Round { outer, inner } => {
            Section::Round { outer: times(outer), inner: times(inner) }
        }
        Section::Rectangle { width, height } => {
            Section::Rectangle { width: times(width), height: times(height) }
        }
    }
}

fn rest_curvature(disks: usize) -> impl Strategy<Value = RestCurvature> {
    // Without dimension: times the length.
    prop_oneof![
        3 => Just(RestCurvature::default()),
        1 => ball().prop_map(RestCurvature::Uniform),
        1 => varying(ball(), disks),
    ]
}

/// Disk positions from 0 to 1.
fn positions() -> impl Strategy<Value = Vec<f64>> {
    vec(0.5..1.5_f64, 1..10).prop_map(|gaps| {
        let whole: f64 = gaps.iter().sum();
        let mut at = 0.0;
        let mut places = vec![0.0];
        for gap in &gaps[..gaps.len() - 1] {
            at += gap / whole;
            places.push(at);
        }
        places.push(1.0);
        places
    })
}

/// A routing on a robot of unit length, and where it ends; `radius` is that of the hole circle.
pub fn routing(disks: usize, radius: f64) -> impl Strategy<Value = (Routing, Option<f64>)> {
    let ends = || prop_oneof![2 => Just(None), 1 => (0.25..1.0).prop_map(Some)];
    let near = move || (0.4 * radius..1.2 * radius, 0.0..TAU);
    let point = |(r, a): (f64, f64)| [r * a.cos(), r * a.sin()];
    let holes = (1..=12_usize, vec(-2..=2_i64, disks - 1), 0..3_usize, 2..=disks);
    prop_oneof![
        (near(), ends())
            .prop_map(|((radius, angle), end)| { (Routing::Straight { angle, radius }, end) }),
        (near(), -1.5..1.5, ends()).prop_map(|((radius, start_angle), turns, end)| {
            (Routing::Helix { start_angle, turns, radius }, end)
        }),
        (near(), near(), ends()).prop_map(move |(a, b, end)| {
            (Routing::Linear { start: point(a), end: point(b) }, end)
        }),
        (near(), vec(-1.0..1.0_f64, 6), ends()).prop_map(move |(start, c, end)| {
            let [x, y] = point(start);
            let scale = 0.7 * radius;
            (
                Routing::Polynomial {
                    x: vec![x, c[0] * scale, c[1] * scale, c[2] * scale],
                    y: vec![y, c[3] * scale, c[4] * scale, c[5] * scale],
                },
                end,
            )
        }),
        holes.prop_map(|(first, steps, kind, count)| {
            let mut hole = first as i64 - 1;
            let mut holes = vec![first];
            for step in &steps[..count - 1] {
                hole = (hole + step).rem_euclid(12);
                holes.push(hole as usize + 1);
            }
            let interpolation =
                [Interpolation::Spline, Interpolation::Spline, Interpolation::Pchip][kind];
            (Routing::Holes { holes, interpolation }, None)
        }),
    ]
}

/// The same routing for a robot of another length; offsets stay.
fn stretched(routing: Routing, length: f64) -> Routing {
    match routing {
        Routing::Polynomial { x, y } => {
            let scale = |c: Vec<f64>| -> Vec<f64> {
                c.iter().enumerate().map(|(k, c)| c / length.powi(k as i32)).collect()
            };
            Routing::Polynomial { x: scale(x), y: scale(y) }
        }
        other => other,
    }
}

/// Length, slenderness of rod and of hole circle, Young's modulus, Poisson's ratio.
fn size() -> impl Strategy<Value = (f64, f64, f64, f64, f64)> {
    (0.08..0.4, 40.0..90.0, 15.0..30.0, 8.0..11.0_f64, 0.0..0.45)
        .prop_map(|(l, d, r, e, nu)| (l, l / d, l / r, 10.0_f64.powf(e), nu))
}

pub fn robot(wild: Wildness) -> impl Strategy<Value = (Robot, Case)> {
    (size(), positions(), 1..=wild.cables)
        .prop_flat_map(move |(size, places, cables)| {
            let n = places.len();
            let radius = size.2;
            (
                Just((size, places)),
                (section(n), rest_curvature(n)),
                prop_oneof![2 => Just(vec![1.0; n]), 1 => vec(0.8..1.2_f64, n)],
                vec((routing(n, radius), 0.0..wild.tension), cables),
                loads(),
            )
        })
        .prop_map(move |parts| assemble(wild, parts))
}

type Parts = (
    ((f64, f64, f64, f64, f64), Vec<f64>),
    (Section, RestCurvature),
    Vec<f64>,
    Vec<((Routing, Option<f64>), f64)>,
    RawLoads,
);

/// Loads without dimension.
#[derive(Clone, Debug)]
struct RawLoads {
    force: Vec3,
    moment: Vec3,
    gravity: Option<Vec3>,
    disk_share: f64,
    points: Vec<(f64, Vec3, Vec3)>,
}

fn loads() -> impl Strategy<Value = RawLoads> {
    (
        ball(),
        prop_oneof![Just(Vec3::ZERO), ball()],
        prop_oneof![Just(None), ball().prop_map(Some)],
        prop_oneof![Just(0.0), 0.0..1.0],
        vec((0.05..0.95, ball(), ball()), 0..2),
    )
        .prop_map(|(force, moment, gravity, disk_share, points)| RawLoads {
            force,
            moment,
            gravity,
            disk_share,
            points,
        })
}

fn assemble(wild: Wildness, parts: Parts) -> (Robot, Case) {
    let (((length, diameter, radius, young, poisson), places), (section, rest), radii, cables, raw) =
        parts;
    let rest_curvature = sized(&rest, length, |&u| u / length);
    let material = Material {
        name: None,
        young_modulus: Some(young),
        poisson_ratio: Some(poisson),
        shear_modulus: None,
        density: Some(1000.0),
        yield_strain: None,
    };
    let backbone = Backbone {
        section: Some(scaled(&section, diameter, length)),
        material,
        rest_curvature,
        ..Backbone::new(length)
    };
    let count = places.len();
    let mut disks = Disks {
        arc_lengths: places
            .iter()
            .enumerate()
            .map(|(i, p)| if i + 1 == count { length } else { p * length })
            .collect(),
        are_present: true,
        hole_circle_radii: radii.iter().map(|f| f * radius).collect(),
        holes: Some(12),
        mass: 0.0,
        outer_radius: None,
        thickness: None,
    };
    let rod = Robot::new(backbone.clone(), disks.clone(), vec![]).unwrap();
    let stiffness = bending_stiffness(&rod);
    let rod_mass = 1000.0 * length * rod.backbone().section_at(&disks, 0.0).unwrap().area;
    disks.mass = raw.disk_share * rod_mass / count as f64;

    let mut commands = Vec::new();
    let make = |(i, ((routing, end), tension)): (usize, ((Routing, Option<f64>), f64))| {
        let share = 1.0 / (cables_share(wild.cables));
        commands.push(CableCommand {
            tension: Some(tension * share * stiffness / (length * radius)),
            shortening: None,
        });
        Cable {
            ends_at: end.map(|e| e * length),
            ..Cable::new(format!("cable {i}"), stretched(routing, length))
        }
    };
    let cables: Vec<Cable> = cables.into_iter().enumerate().map(make).collect();

    let (force, moment) = (stiffness / length.powi(2), stiffness / length);
    let loads = if wild.loaded() {
        let gravity = |g: Vec3| g * (wild.weight * force / rod_mass);
        Loads {
            gravity: raw.gravity.filter(|_| wild.weight > 0.0).map(gravity),
            tip_force: raw.force * (wild.force * force),
            tip_moment: raw.moment * (wild.moment * moment),
            tip_follower: false,
            points: raw
                .points
                .iter()
                .map(|&(at, f, m)| PointLoad {
                    at: at * length,
                    force: f * (wild.force * force),
                    moment: m * (0.5 * wild.moment * moment),
                    follower: false,
                })
                .collect(),
            ..Loads::default()
        }
    } else {
        Loads::default()
    };
    (Robot::new(backbone, disks, cables).unwrap(), Case { commands, loads, ..Case::default() })
}

/// The more cables there may be, the less each of them pulls.
fn cables_share(cables: usize) -> f64 {
    (cables as f64).sqrt().max(1.0)
}

/// The models of an equilibrium under forces.
pub const WITH_FORCES: [ModelKind; 5] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
    ModelKind::FourBar,
];

/// The model in its variant that takes forces.
pub fn model_with_forces(kind: ModelKind, stations: Stations, actuation: Actuation) -> Model {
    match Model::new(kind, stations, actuation) {
        Model::FourBar(options) => Model::FourBar(four_bar::Options {
            objective: four_bar::Objective::StrainEnergy,
            lengths: four_bar::LengthRule::Free,
            ..options
        }),
        model => model,
    }
}
