//! What the tolerances of manufacture do to the shapes of a robot: many robots with random deviations, solved by the batch.

use whipcord::batch::{BatchOptions, solve_robots};
use whipcord::robot::StiffnessMatrix;
use whipcord::{
    Backbone, Cable, Case, Disks, Material, Model, Robot, Routing, Statics as _, Stations,
    Stiffness, Vec3,
};
use whipcord_numerics::random::SplitMix64;

use crate::error::DesignError;
use crate::problem::{Design, spread};

/// Standard deviations of what is manufactured and commanded, all of them of normal distributions and independent of one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Of the radius of the hole circle of each disk, or of where a cable without holes runs, in m.
    pub hole_radius: f64,
    /// Of the angle of each hole, or of a cable without holes, in rad.
    pub hole_angle: f64,
    /// Of the arc length of each disk between the first and the last, in m.
    pub disk_position: f64,
    /// Of the stiffness of the backbone, as a part of it.
    pub stiffness: f64,
    /// Of the tension of each cable, as a part of it.
    pub tension: f64,
    /// Robots.
    pub samples: usize,
    /// Of the random numbers.
    pub seed: u64,
}

impl Tolerances {
    /// Those of careful work on a robot: 1 % of the rim for radii, 1° for angles, 1 % of the distance of disks, 3 % for the stiffness and 2 % for
    /// tensions; 1,000 robots.
    #[must_use]
    pub fn of_robot(robot: &Robot) -> Self {
        let disks = robot.disks();
        let length = robot.backbone().length;
        let rim = (0..disks.count()).map(|disk| disks.rim_radius(disk)).fold(0.0, f64::max);
        #[allow(clippy::cast_precision_loss, reason = "few disks")]
        let pitch = length / (disks.count() - 1) as f64;
        Self {
            hole_radius: 0.01 * if rim > 0.0 { rim } else { 0.05 * length },
            hole_angle: 1_f64.to_radians(),
            disk_position: if disks.are_present { 0.01 * pitch } else { 0.0 },
            stiffness: 0.03,
            tension: 0.02,
            samples: 1_000,
            seed: 1,
        }
    }
}

/// A goal with the points that its disks are compared with.
pub type Compared = (Case, Vec<(usize, Vec3)>);

/// What became of one robot under one goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// Distance of the tip from where the robot without deviations has it, in m.
    pub tip_shift: f64,
    /// Distance of the last disk that has a wanted place from there, in m.
    pub tip_error: f64,
    /// Greatest distance of a disk from its wanted place in m.
    pub worst: f64,
    /// Root of the mean of the squares of these distances in m.
    pub mean: f64,
}

/// What became of all robots.
#[derive(Clone, Debug, PartialEq)]
pub struct TolerancesResult {
    /// The deviations that were drawn.
    pub tolerances: Tolerances,
    /// For each goal, one for each robot that has an answer.
    pub goals: Vec<Vec<Sampled>>,
    /// Solves without an answer.
    pub failed: usize,
}

/// Robots that are solved at a time.
const PIECE: usize = 512;
/// Places of a hole between two neighbouring ones: so finely its angle can deviate.
const FINE: usize = 100_000;
/// A disk stays at least this part of the mean distance from its neighbours.
const APART: f64 = 0.05;

/// Solves robots with random deviations.
///
/// # Errors
/// [`DesignError`] where the robot without deviations has no answer, or the batch was stopped.
pub fn sample_tolerances(
    model: &Model,
    robot: &Robot,
    goals: &[Compared],
    tolerances: &Tolerances,
    options: &BatchOptions<'_>,
) -> Result<TolerancesResult, DesignError> {
    let model = model.at(Stations::Disks);
    let nominal = goals
        .iter()
        .map(|(case, _)| model.solve(robot, case).map(|solution| solution.disks.tip().position))
        .collect::<Result<Vec<_>, _>>()?;
    let mut result = TolerancesResult {
        tolerances: *tolerances,
        goals: vec![Vec::with_capacity(tolerances.samples); goals.len()],
        failed: 0,
    };
    let numbers: Vec<usize> = (0..tolerances.samples).collect();
    for numbers in numbers.chunks(PIECE) {
        for (goal, (case, points)) in goals.iter().enumerate() {
            let robots = numbers
                .iter()
                .map(|&number| {
                    // The same robot for all goals, with commands of its own for each.
                    let mut random = SplitMix64::of(tolerances.seed, number as u64);
                    let made = made(robot, tolerances, &mut random)?;
                    let sequence = (1 + goal) * tolerances.samples + number;
                    let mut random = SplitMix64::of(tolerances.seed, sequence as u64);
                    Ok((made, commanded(case, tolerances.tension, &mut random)))
                })
                .collect::<Result<Vec<_>, DesignError>>()?;
            for answer in solve_robots(&model, &robots, options)? {
                let Ok(solution) = answer else {
                    result.failed += 1;
                    continue;
                };
                let at = |disk: usize| solution.disks.poses[disk].position;
                let distances: Vec<f64> =
                    points.iter().map(|(disk, point)| (at(*disk) - *point).norm()).collect();
                let last = points.iter().zip(&distances).max_by_key(|((disk, _), _)| *disk);
                let [mean, worst] = spread(&distances);
                result.goals[goal].push(Sampled {
                    tip_shift: (solution.disks.tip().position - nominal[goal]).norm(),
                    tip_error: last.map_or(0.0, |(_, distance)| *distance),
                    worst,
                    mean,
                });
            }
        }
    }
    Ok(result)
}

impl Design {
    /// What deviations do to the robot of a design, under its goals.
    ///
    /// # Errors
    /// As [`sample_tolerances`].
    pub fn sample_tolerances(
        &self,
        model: &Model,
        tolerances: &Tolerances,
        options: &BatchOptions<'_>,
    ) -> Result<TolerancesResult, DesignError> {
        let goals = self.goals.iter().map(|goal| (goal.case.clone(), goal.points.clone()));
        let goals: Vec<Compared> = goals.collect();
        sample_tolerances(model, &self.robot, &goals, tolerances, options)
    }
}

/// The robot as it is made.
fn made(robot: &Robot, of: &Tolerances, random: &mut SplitMix64) -> Result<Robot, DesignError> {
    let backbone = robot.backbone().apart_from(robot.disks());
    let backbone = stiffened(backbone, (1.0 + of.stiffness * random.next_normal()).max(0.05));
    let mut disks = robot.disks().clone();
    let count = disks.count();
    if disks.are_present && of.disk_position > 0.0 {
        #[allow(clippy::cast_precision_loss, reason = "few disks")]
        let apart = APART * robot.backbone().length / (count - 1) as f64;
        for disk in 1..count - 1 {
            let moved = disks.arc_lengths[disk] + of.disk_position * random.next_normal();
            let [before, next] = [disks.arc_lengths[disk - 1], robot.disks().arc_lengths[disk + 1]];
            disks.arc_lengths[disk] = moved.max(before + apart).min(next - apart);
        }
    }
    for radius in &mut disks.hole_circle_radii {
        *radius = (*radius + of.hole_radius * random.next_normal()).max(1e-3 * *radius);
    }
    let holes = disks.holes;
    let cables: Vec<Cable> = robot
        .cables()
        .iter()
        .map(|cable| {
            let routing = deviated(&cable.routing, holes, of, random);
            Cable { routing, ..cable.clone() }
        })
        .collect();
    let cables = ends_with_disks(cables, robot.disks(), &disks);
    disks.holes = holes.map(|holes| holes * FINE);
    Ok(Robot::new(backbone, disks, cables)?.with_motors(robot.motors().to_vec())?)
}

/// Cables that end at a disk end where it is now.
fn ends_with_disks(mut cables: Vec<Cable>, before: &Disks, now: &Disks) -> Vec<Cable> {
    for cable in &mut cables {
        let near = |end: f64| {
            before.arc_lengths.iter().position(|s| (s - end).abs() <= 1e-9 * before_length(before))
        };
        if let Some(disk) = cable.ends_at.and_then(near) {
            cable.ends_at = Some(now.arc_lengths[disk]);
        }
    }
    cables
}

fn before_length(disks: &Disks) -> f64 {
    disks.arc_lengths.last().copied().unwrap_or(1.0)
}

fn deviated(
    routing: &Routing,
    holes: Option<usize>,
    of: &Tolerances,
    random: &mut SplitMix64,
) -> Routing {
    let mut angle = || of.hole_angle * random.next_normal();
    match routing {
        Routing::Holes { holes: list, interpolation } => {
            let count = holes.unwrap_or(1);
            let pitch = core::f64::consts::TAU / count as f64;
            let all = (count * FINE) as f64;
            let list = list.iter().map(|hole| {
                let at = (*hole as f64 - 1.0 + angle() / pitch) * FINE as f64;
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "the remainder is from 0 to all"
                )]
                let number = at.round().rem_euclid(all) as usize;
                number % (count * FINE) + 1
            });
            Routing::Holes { holes: list.collect(), interpolation: *interpolation }
        }
        Routing::Straight { angle: at, radius } => {
            let at = at + angle();
            let radius = (radius + of.hole_radius * random.next_normal()).abs();
            Routing::Straight { angle: at, radius }
        }
        Routing::Helix { start_angle, turns, radius } => {
            let start_angle = start_angle + angle();
            let radius = (radius + of.hole_radius * random.next_normal()).abs();
            Routing::Helix { start_angle, turns: *turns, radius }
        }
        Routing::Linear { start, end } => {
            let (sin, cos) = angle().sin_cos();
            let by = [0; 2].map(|_| of.hole_radius * random.next_normal());
            let moved = |[x, y]: [f64; 2]| [cos * x - sin * y + by[0], sin * x + cos * y + by[1]];
            Routing::Linear { start: moved(*start), end: moved(*end) }
        }
        Routing::Polynomial { x, y } => {
            let (sin, cos) = angle().sin_cos();
            let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
            let powers = 0..x.len().max(y.len()).max(1);
            let mut turned: [Vec<f64>; 2] = [
                powers.clone().map(|k| cos * at(x, k) - sin * at(y, k)).collect(),
                powers.map(|k| sin * at(x, k) + cos * at(y, k)).collect(),
            ];
            for list in &mut turned {
                list[0] += of.hole_radius * random.next_normal();
            }
            let [x, y] = turned;
            Routing::Polynomial { x, y }
        }
    }
}

/// The backbone so many times as stiff.
fn stiffened(backbone: Backbone, factor: f64) -> Backbone {
    let material = &backbone.material;
    let material = Material {
        young_modulus: material.young_modulus.map(|modulus| modulus * factor),
        shear_modulus: material.shear_modulus.map(|modulus| modulus * factor),
        ..*material
    };
    let pair = |pair: &[f64; 2]| pair.map(|value| value * factor);
    let stiffness = backbone.stiffness.as_ref().map(|stiffness| match stiffness {
        Stiffness::Matrix(along) => Stiffness::Matrix(
            along.map(|matrix: &StiffnessMatrix| matrix.map(|row| row.map(|entry| entry * factor))),
        ),
        Stiffness::Diagonal { shear, axial, bending, torsion } => Stiffness::Diagonal {
            shear: shear.as_ref().map(|along| along.map(pair)),
            axial: axial.as_ref().map(|along| along.map(|value| value * factor)),
            bending: bending.map(pair),
            torsion: torsion.map(|value| value * factor),
        },
    });
    Backbone { material, stiffness, ..backbone }
}

fn commanded(case: &Case, deviation: f64, random: &mut SplitMix64) -> Case {
    let mut case = case.clone();
    for command in &mut case.commands {
        let factor = (1.0 + deviation * random.next_normal()).max(0.0);
        command.tension = command.tension.map(|tension| tension * factor);
    }
    case
}
