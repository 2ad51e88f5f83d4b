//! Shapes of a robot all over its commands, to start from.

use std::hash::{DefaultHasher, Hash, Hasher};

use rstar::RTree;
use rstar::primitives::GeomWithData;
use whipcord::batch::{BatchOptions, Rows, solve_batch};
use whipcord::{Cancel, Case, Model, Pose, Robot, Solution, Stations, UnitQuaternion, Vec3};
use whipcord_numerics::random::SplitMix64;

use crate::actuator::{Actuator, knows_tensions};
use crate::error::InverseError;
use crate::target::Target;

/// Shapes of a robot at commands that are spread over their limits. Iterations start from the nearest of them, so that an atlas decides where an answer is looked for,
/// but not what it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AtlasRows {
    /// Of what it is: [`crate::InverseSolver::atlas_identity`].
    pub identity: u64,
    /// Commands of each shape.
    pub width: usize,
    /// Disks of each shape.
    pub disk_count: usize,
    /// The commands of each shape in N, m or rad, by rows.
    pub commands: Vec<f64>,
    /// Position in m and orientation of the tip of each shape.
    pub tips: Vec<Pose>,
    /// Positions of the disks of each shape in m, by rows.
    pub disks: Vec<[f64; 3]>,
}

impl AtlasRows {
    /// Whether all rows are whole, finite and within these ranges of the commands.
    fn fit(&self, disk_count: usize, bounds: &[[f64; 2]]) -> bool {
        let Self { width, commands, tips, disks, .. } = self;
        let count = tips.len();
        let is_within = |row: &[f64]| {
            row.iter().zip(bounds).all(|(x, [least, greatest])| (*least..=*greatest).contains(x))
        };
        *width == bounds.len()
            && *width > 0
            && self.disk_count == disk_count
            && commands.len() == count * width
            && disks.len() == count * disk_count
            && commands.chunks_exact(*width).all(is_within)
            && tips.iter().all(|tip| tip.position.is_finite())
            && disks.iter().flatten().all(|x| x.is_finite())
    }
}

/// Of the pseudo-random numbers: the shapes are the same in every run.
const SEED: u64 = 0x9E37_79B9_7F4A_7C15;

/// The rows, with a tree of the places of their tips.
#[derive(Debug)]
pub(crate) struct Atlas {
    tree: RTree<GeomWithData<[f64; 3], usize>>,
    rows: AtlasRows,
}

/// What an atlas is made from.
pub(crate) struct Survey<'a> {
    pub model: &'a Model,
    pub robot: &'a Robot,
    /// Loads and base of all shapes.
    pub case: &'a Case,
    pub actuators: &'a [Actuator],
    /// Bounds of the unknowns, finite.
    pub bounds: &'a [[f64; 2]],
    /// Tensions that are sampled where the model knows tensions, one pair for each cable.
    pub tensions: &'a [[f64; 2]],
    pub rows: usize,
}

impl Survey<'_> {
    /// Unknowns all over their bounds, a row for each shape, the same each time.
    pub fn spread(&self) -> Vec<Vec<f64>> {
        let mut random = SplitMix64::new(SEED);
        let mut next = || random.next_part();
        (0..self.rows).map(|_| spread(self.bounds, &mut next).collect()).collect()
    }

    /// A number for all that the shapes depend on. It is the same in every run of one version of the program.
    pub fn identity(&self) -> u64 {
        let Self { model, robot, case, actuators, bounds, tensions, rows } = self;
        let model = (*model).clone().cancelled_by(&Cancel::default());
        let of_case = (&case.loads, &case.base);
        let mut hasher = DefaultHasher::new();
        let all = (model, robot, of_case, actuators, bounds, tensions, rows);
        format!("{} {all:?}", env!("CARGO_PKG_VERSION")).hash(&mut hasher);
        hasher.finish()
    }
}

impl Atlas {
    /// Of rows that fit a robot of so many disks and the ranges of its commands.
    pub fn of_rows(rows: AtlasRows, disk_count: usize, bounds: &[[f64; 2]]) -> Option<Self> {
        if !rows.fit(disk_count, bounds) {
            return None;
        }
        Some(Self::new(rows))
    }

    fn new(rows: AtlasRows) -> Self {
        let point =
            |(number, tip): (usize, &Pose)| GeomWithData::new(tip.position.to_array(), number);
        let tree = RTree::bulk_load(rows.tips.iter().enumerate().map(point).collect());
        Self { tree, rows }
    }

    /// Solves the rows. Where the model knows tensions, these are sampled, and the commands read off the shapes: shortenings that
    /// are sampled by themselves contradict one another.
    pub fn survey(survey: &Survey<'_>) -> Result<Self, InverseError> {
        let by_tension = knows_tensions(survey.model.kind());
        let cables = survey.robot.cables().len();
        let model = survey.model.at(Stations::Disks);
        let case = Case {
            obstacles: Vec::new(),
            before: Vec::new(),
            motors: Vec::new(),
            ..survey.case.clone()
        };
        let mut random = SplitMix64::new(SEED);
        let mut next = || random.next_part();
        let values: Vec<f64> = if by_tension {
            let mut rows = Vec::with_capacity(survey.rows * cables);
            for _ in 0..survey.rows {
                rows.extend(spread(survey.tensions, &mut next));
            }
            rows
        } else {
            let mut rows = Vec::with_capacity(survey.rows * cables);
            for unknowns in survey.spread() {
                let mut row = vec![0.0; cables];
                for (actuator, x) in survey.actuators.iter().zip(&unknowns) {
                    for (cable, rate) in actuator.cables(survey.robot) {
                        row[cable] = rate * x;
                    }
                }
                rows.extend(row);
            }
            rows
        };
        let rows = if by_tension {
            Rows::Tensions { values: &values, case: &case }
        } else {
            Rows::Shortenings { values: &values, case: &case }
        };
        let batch = solve_batch(&model, survey.robot, rows, &BatchOptions::default())
            .map_err(|error| InverseError::Atlas(error.to_string()))?;
        let initial = initial_lengths(survey, &case)?;
        let disk_count = batch.arc_lengths().len();
        let mut rows = AtlasRows {
            identity: survey.identity(),
            width: survey.actuators.len(),
            disk_count,
            ..AtlasRows::default()
        };
        for row in 0..batch.len() {
            if batch.outcomes()[row].is_err() {
                continue;
            }
            let station = |k: usize| {
                let at = 3 * (row * disk_count + k);
                [0, 1, 2].map(|i| batch.positions()[at + i])
            };
            let tip = disk_count - 1;
            let position = station(tip);
            let q = 4 * (row * disk_count + tip);
            let wxyz = [0, 1, 2, 3].map(|i| batch.orientations()[q + i]);
            let Some(rotation) = UnitQuaternion::from_wxyz(wxyz) else { continue };
            let lengths = &batch.lengths()[row * cables..(row + 1) * cables];
            let given = &values[row * cables..(row + 1) * cables];
            for (actuator, [least, greatest]) in survey.actuators.iter().zip(survey.bounds) {
                let shortening = |cable: usize| {
                    if by_tension {
                        let rest = initial[cable];
                        let stretch = survey.robot.cable_stretch(cable, rest, given[cable]);
                        rest - lengths[cable] + stretch
                    } else {
                        given[cable]
                    }
                };
                let x = match actuator {
                    Actuator::Tension(cable) => given[*cable],
                    Actuator::Shortening(cable) => shortening(*cable),
                    Actuator::Motor(_) => {
                        let (mut pulled, mut squares) = (0.0, 0.0);
                        for (cable, rate) in actuator.cables(survey.robot) {
                            pulled += rate * shortening(cable);
                            squares += rate * rate;
                        }
                        pulled / squares
                    }
                };
                rows.commands.push(x.max(*least).min(*greatest));
            }
            rows.tips.push(Pose {
                position: Vec3::new(position[0], position[1], position[2]),
                rotation,
            });
            rows.disks.extend((0..disk_count).map(station));
        }
        Ok(Self::new(rows))
    }

    /// The tip and the unknowns of each row.
    pub fn each(&self) -> impl Iterator<Item = (Vec3, &[f64])> + '_ {
        let tips = self.rows.tips.iter().map(|tip| tip.position);
        tips.zip(self.rows.commands.chunks_exact(self.rows.width))
    }

    /// The rows.
    pub const fn rows(&self) -> &AtlasRows {
        &self.rows
    }

    /// The unknowns of the rows that are nearest to a target, the nearest first.
    pub fn nearest(&self, target: &Target, lever: f64, count: usize) -> Vec<&[f64]> {
        let tip = match target {
            Target::Tip(point) => Some(*point),
            Target::Pose(pose) => Some(pose.position),
            Target::Axis { point, .. } => *point,
            Target::Shape(points) => {
                let last = points.iter().max_by_key(|(disk, _)| *disk);
                last.filter(|(disk, _)| disk + 1 == self.rows.disk_count).map(|(_, point)| *point)
            }
        };
        // Of targets that are more than a point, more rows are compared than are asked for.
        let candidates: Vec<usize> = match (tip, target) {
            (Some(point), Target::Tip(_)) => self.around(point).take(count).collect(),
            (Some(point), _) => self.around(point).take(16 * count).collect(),
            (None, _) => (0..self.rows.tips.len()).collect(),
        };
        let mut residual = Vec::new();
        let mut ranked: Vec<(f64, usize)> = candidates
            .into_iter()
            .map(|row| (self.distance(row, target, lever, &mut residual), row))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let width = self.rows.width;
        let of = |&(_, row): &(f64, usize)| &self.rows.commands[row * width..(row + 1) * width];
        ranked.iter().take(count).map(of).collect()
    }

    fn around(&self, point: Vec3) -> impl Iterator<Item = usize> + '_ {
        self.tree.nearest_neighbor_iter(point.to_array()).map(|found| found.data)
    }

    /// The square of the residuals of a row.
    fn distance(&self, row: usize, target: &Target, lever: f64, residual: &mut Vec<f64>) -> f64 {
        let disk = |disk: usize| {
            let [x, y, z] = self.rows.disks[row * self.rows.disk_count + disk];
            Vec3::new(x, y, z)
        };
        target.residual_at(&self.rows.tips[row], disk, lever, residual);
        residual.iter().map(|r| r * r).sum()
    }
}

/// The length of each cable that its shortening counts from.
fn initial_lengths(survey: &Survey<'_>, case: &Case) -> Result<Vec<f64>, InverseError> {
    let mut prepared = survey.model.prepare(survey.robot, &case.loads)?;
    let command = |_| whipcord::CableCommand {
        tension: Some(0.0),
        shortening: Some(whipcord::Shortening::Length(0.0)),
    };
    let commands = (0..survey.robot.cables().len()).map(command).collect();
    let solution: Solution =
        prepared.solve(&Case { commands, ..case.clone() }, None).map_err(InverseError::NoStart)?;
    Ok(solution.cables.iter().map(|cable| cable.initial_length).collect())
}

/// Numbers between limits. Of each three about one is at its lower limit, where the commands of answers often are.
fn spread<'a>(
    limits: &'a [[f64; 2]],
    next: &'a mut impl FnMut() -> f64,
) -> impl Iterator<Item = f64> + 'a {
    limits.iter().map(move |[least, greatest]| {
        let at_limit = next() < 0.3;
        let part = next();
        if at_limit { *least } else { least + part * (greatest - least) }
    })
}
