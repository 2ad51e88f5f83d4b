//! How many cables the shapes take: the rank of the bending moments, and factors with non-negative tensions to start from.
//!
//! With rest curvatures that make the bare robot take each shape under its loads, the moments that cables have to give are known. Of all goals
//! they are `B ≈ R T`, eq. (10), with the places of the cables in `R` and their tensions `T ≥ 0`.

use whipcord::section::section_stiffness;
use whipcord::{Cable, CableCommand, Case, Model, ModelKind, Robot, Routing, Stations};
use whipcord_numerics::random::SplitMix64;
use whipcord_numerics::{BoundedQuadratic, SingularValues};

use crate::budget::Budget;
use crate::chebyshev;
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::problem::DesignOptions;
use crate::refine::{refine, rest_curvature_at};
use crate::residuals::RefineOptions;

/// A robot with as many cables as its goals take.
pub(crate) struct FoundCables {
    pub robot: Robot,
    pub cases: Vec<Case>,
    /// Fewer cables cannot make the moments, up to the tolerance.
    pub rank: usize,
}

/// Sections at which moments are compared.
const SECTIONS: usize = 24;
/// SplitMix64 starts of the factors, and steps from each.
const STARTS: u64 = 20;
const STEPS: usize = 200;
/// Cables to be tried beyond the rank: with one more, tensions are never in the way of a sign.
const MORE: usize = 2;
/// A cable starts so far out, as a part of the rim, that there is room on either side.
const OUT: f64 = 0.7;

/// The robot with as few cables as give the moments of the goals within the tolerance of the options.
pub(crate) fn found(
    robot: &Robot,
    cancel: &Model,
    (goals, rim): (&[ShapeGoal], f64),
    (options, budget): (&DesignOptions, &Budget),
) -> Result<FoundCables, DesignError> {
    if !robot.motors().is_empty() {
        return Err(DesignError::Motors);
    }
    let length = robot.backbone().length;
    let columns = goals.len();
    let mut moments = vec![0.0; 2 * SECTIONS * columns];
    for (number, goal) in goals.iter().enumerate() {
        for (k, moment) in needed(robot, cancel, (goal, rim), (options, budget))?.iter().enumerate()
        {
            moments[(2 * k) * columns + number] = moment[0];
            moments[(2 * k + 1) * columns + number] = moment[1];
        }
    }
    let middle = section_stiffness(robot, 0.5 * length, 0.5 * length)?[3][3];
    #[allow(clippy::cast_precision_loss, reason = "few goals")]
    let count = (SECTIONS * columns) as f64;
    // What is left bends the tip off by at most about κ L²/2.
    let distance = |square: f64| 0.5 * length * length * (square / count).sqrt() / middle;
    let allowed = options.shape_tolerance * length;
    let singular = SingularValues::of(columns, &moments).values;
    let left = |rank: usize| singular.iter().skip(rank).map(|value| value * value).sum::<f64>();
    let rank = (1..=columns).find(|&rank| distance(left(rank)) <= allowed).unwrap_or(columns);
    let mut best: Option<(f64, usize, Factors)> = None;
    for cables in rank..=rank + MORE {
        let factors = factors(&moments, columns, cables, options.seed);
        let off = distance(factors.square);
        let is_better = best.as_ref().is_none_or(|(known, ..)| off < 0.5 * *known);
        if is_better {
            best = Some((off, cables, factors));
        }
        if off <= allowed {
            break;
        }
    }
    let Some((_, count, factors)) = best else { return Err(DesignError::NoCables) };
    let (robot, cases) = with_cables(robot, goals, count, &factors, rim)?;
    Ok(FoundCables { robot, cases, rank })
}

/// The moments by places of cables, `τ r` in N·m, at the sections, that bend the bare robot to a goal under its loads.
fn needed(
    robot: &Robot,
    cancel: &Model,
    (goal, rim): (&ShapeGoal, f64),
    (options, budget): (&DesignOptions, &Budget),
) -> Result<Vec<[f64; 2]>, DesignError> {
    let length = robot.backbone().length;
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let count = (goal.points.len() + 1).clamp(3, SECTIONS);
    let at: Vec<f64> = whipcord::equally_spaced(0.0, length, count).collect();
    let (bent, unknowns) = rest_curvature_at(robot, at);
    let bare = Robot::new(bent, disks.clone(), Vec::new())?;
    let goal = ShapeGoal {
        case: Case { commands: Vec::new(), before: Vec::new(), ..goal.case.clone() },
        ..goal.clone()
    };
    let model = Model::new(ModelKind::Cosserat, Stations::Disks, whipcord::Actuation::Tension)
        .cancelled_by(cancel.cancel());
    let control = RefineOptions {
        starts: 1,
        iterations: options.iterations,
        seed: options.seed,
        rim,
        criteria: None,
        on_curves: None,
        budget,
    };
    let refined = refine(&model, &bare, core::slice::from_ref(&goal), &unknowns, &control)?;
    sections(length)
        .map(|s| {
            let stiffness = section_stiffness(robot, s, s)?;
            let bend = refined.robot.backbone().rest_curvature_at(disks, s)
                - backbone.rest_curvature_at(disks, s);
            // u = u* − K⁻¹ Σ τ r × e₃.
            Ok([stiffness[4][4] * bend.y, -stiffness[3][3] * bend.x])
        })
        .collect()
}

fn sections(length: f64) -> impl Iterator<Item = f64> {
    whipcord::equally_spaced(0.0, length, SECTIONS)
}

/// `B ≈ R T` with `T ≥ 0`.
struct Factors {
    /// By rows of so many cables.
    places: Vec<f64>,
    /// By rows of so many goals.
    tensions: Vec<f64>,
    /// Sum of the squares of what is left.
    square: f64,
}

/// Alternating least squares from several starts: the places for given tensions, the tensions not negative for given places.
fn factors(moments: &[f64], columns: usize, cables: usize, seed: u64) -> Factors {
    let rows = moments.len() / columns;
    let mut best: Option<Factors> = None;
    for start in 0..STARTS {
        let mut random = SplitMix64::of(seed, 1_000 + start);
        let mut tensions: Vec<f64> = (0..cables * columns).map(|_| random.next_part()).collect();
        let mut places = vec![0.0; rows * cables];
        for _ in 0..STEPS {
            let gram = regular(cables, |i, j| {
                (0..columns).map(|k| tensions[i * columns + k] * tensions[j * columns + k]).sum()
            });
            let mut unbounded = BoundedQuadratic::default();
            let mut out = Vec::new();
            for row in 0..rows {
                let gradient: Vec<f64> = (0..cables)
                    .map(|i| {
                        let of = |k| tensions[i * columns + k] * moments[row * columns + k];
                        -(0..columns).map(of).sum::<f64>()
                    })
                    .collect();
                let free = vec![-1e12; cables];
                if unbounded.minimise(&gram, &gradient, &free, &mut out).is_ok() {
                    places[row * cables..(row + 1) * cables].copy_from_slice(&out);
                }
            }
            let gram = regular(cables, |i, j| {
                (0..rows).map(|row| places[row * cables + i] * places[row * cables + j]).sum()
            });
            for column in 0..columns {
                let gradient: Vec<f64> = (0..cables)
                    .map(|i| {
                        let of = |row| places[row * cables + i] * moments[row * columns + column];
                        -(0..rows).map(of).sum::<f64>()
                    })
                    .collect();
                let none = vec![0.0; cables];
                if unbounded.minimise(&gram, &gradient, &none, &mut out).is_ok() {
                    for (cable, tension) in out.iter().enumerate() {
                        tensions[cable * columns + column] = *tension;
                    }
                }
            }
        }
        let left = |row: usize, column: usize| {
            let of = |i: usize| places[row * cables + i] * tensions[i * columns + column];
            moments[row * columns + column] - (0..cables).map(of).sum::<f64>()
        };
        let square = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(row, column)| left(row, column).powi(2))
            .sum();
        if best.as_ref().is_none_or(|best| square < best.square) {
            best = Some(Factors { places, tensions, square });
        }
    }
    best.unwrap_or(Factors {
        places: vec![0.0; rows * cables],
        tensions: vec![0.0; cables * columns],
        square: f64::INFINITY,
    })
}

/// A Gram matrix, and a little on its diagonal that keeps it regular.
fn regular(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let mut matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
    let largest = (0..n).map(|i| matrix[i * n + i]).fold(f64::MIN_POSITIVE, f64::max);
    for i in 0..n {
        matrix[i * n + i] += 1e-10 * largest;
    }
    matrix
}

/// The robot with these cables, and the cases with their tensions.
fn with_cables(
    robot: &Robot,
    goals: &[ShapeGoal],
    count: usize,
    factors: &Factors,
    rim: f64,
) -> Result<(Robot, Vec<Case>), DesignError> {
    const NODES: usize = 6;
    let (length, columns) = (robot.backbone().length, goals.len());
    let mut cases: Vec<Case> = goals
        .iter()
        .map(|goal| Case { commands: Vec::new(), before: Vec::new(), ..goal.case.clone() })
        .collect();
    let mut cables = Vec::with_capacity(count);
    for cable in 0..count {
        let place = |section: usize| {
            [0, 1].map(|axis| factors.places[(2 * section + axis) * count + cable])
        };
        let farthest = (0..SECTIONS).map(place).map(|[x, y]| x.hypot(y)).fold(1e-12, f64::max);
        let scale = OUT * rim / farthest;
        let course = [0, 1].map(|axis: usize| {
            let values: Vec<f64> = chebyshev::places(NODES)
                .map(|part| {
                    #[allow(clippy::cast_precision_loss, reason = "few sections")]
                    let at = part * (SECTIONS - 1) as f64;
                    #[allow(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "0 to the number of sections"
                    )]
                    let first = (at as usize).min(SECTIONS - 2);
                    #[allow(clippy::cast_precision_loss, reason = "few sections")]
                    let rest = at - first as f64;
                    let [a, b] = [first, first + 1].map(|section| place(section)[axis]);
                    scale * (a + rest * (b - a))
                })
                .collect();
            chebyshev::powers(&values, length)
        });
        let [x, y] = course;
        let named = robot.cables().get(cable).cloned();
        let own =
            named.unwrap_or_else(|| Cable {
                name: free_name(robot, cable),
                ..robot.cables().first().cloned().unwrap_or_else(|| {
                    Cable::new("", Routing::Straight { angle: 0.0, radius: 0.0 })
                })
            });
        cables.push(Cable { routing: Routing::Polynomial { x, y }, ends_at: None, ..own });
        for (goal, case) in cases.iter_mut().enumerate() {
            let tension = factors.tensions[cable * columns + goal] / scale;
            case.commands.push(CableCommand { tension: Some(tension), shortening: None });
        }
    }
    let robot = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables)?;
    Ok((robot, cases))
}

/// A name that no cable of the robot has.
fn free_name(robot: &Robot, cable: usize) -> String {
    let is_taken = |name: &String| robot.cables().iter().any(|of| of.name == *name);
    (cable + 1..)
        .map(|number| format!("cable {number}"))
        .find(|name| !is_taken(name))
        .unwrap_or_default()
}
