//! How far a robot is from itself: what it does when commands come back. No model without history can be nearer to all
//! measurements than that.

use super::experiment::Experiment;
use super::outcome::Identified;
use super::rows::{Row, rows};
use crate::observation::{Observation, Place, Seen};
use std::collections::BTreeMap;
use whipcord::case::{CableCommand, Case, Shortening};
use whipcord::robot::Robot;
use whipcord_numerics::Vec3;

/// Measurements of equal or nearly equal commands, eq. (i9).
#[derive(Clone, Debug, PartialEq)]
pub struct Repeatability {
    /// Pairs of rows with such commands, between which the commands were different.
    pub pairs: usize,
    /// Root mean square distance in m of a marker from where it is on average at the same commands.
    pub rms_distance: f64,
    /// Pairs that were approached from the same side, and the root mean square distance in m between their markers.
    pub same_side: Option<(usize, f64)>,
    /// The same of pairs that were approached from opposite sides: loading against unloading.
    pub opposite_sides: Option<(usize, f64)>,
}

/// Commands are nearly equal where none differs by more than this part of its range.
const NEAR: f64 = 0.01;
/// Within this part they are equal.
const EQUAL: f64 = 1e-9;
/// They were different where one differs by more than this part.
const APART: f64 = 0.03;
/// More rows than this are thinned out.
const MOST: usize = 3000;

/// The figure of what was fitted, without [what hardly counts](super::Residual::is_negligible); none where no commands come back. Between commands that are nearly but not quite equal, the model
/// tells what their difference changes.
#[must_use]
pub fn repeatability(experiments: &[Experiment], found: &Identified) -> Option<Repeatability> {
    let all = rows(experiments);
    let all: Vec<Row> = all.iter().step_by(all.len().div_ceil(MOST).max(1)).copied().collect();
    let commands: Vec<Vec<f64>> = all
        .iter()
        .map(|row| commands(&found.robot, &experiments[row.experiment].case, row.step))
        .collect();
    let count = commands.iter().map(Vec::len).max()?;
    let ranges: Vec<f64> = (0..count)
        .map(|k| {
            let of = commands.iter().filter_map(|of| of.get(k));
            let (least, most) =
                of.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(*c), b.max(*c)));
            most - least
        })
        .collect();
    let apart = |a: &[f64], b: &[f64]| {
        if a.len() != b.len() {
            return f64::INFINITY;
        }
        let each = a.iter().zip(b).zip(&ranges).filter(|(_, range)| **range > 0.0);
        each.map(|((a, b), range)| (a - b).abs() / range).fold(0.0, f64::max)
    };
    let left = residuals(experiments, found);
    let (mut both, mut same, mut opposite) = (Sum::default(), Sum::default(), Sum::default());
    for (i, row) in all.iter().enumerate() {
        let mut was_elsewhere = false;
        for (j, other) in all.iter().enumerate().skip(i + 1) {
            let distance = apart(&commands[i], &commands[j]);
            was_elsewhere |= distance > APART || other.experiment != row.experiment;
            if distance > NEAR || !was_elsewhere || !is_alike(experiments, *row, *other) {
                continue;
            }
            let Some(square) = square_of_pair(&left, *row, *other, distance > EQUAL) else {
                continue;
            };
            both.add(square);
            let way = |k: usize| -> Option<Vec<f64>> {
                let before =
                    k.checked_sub(1).filter(|b| all[*b].experiment == all[k].experiment)?;
                let pair = commands[k].iter().zip(&commands[before]).zip(&ranges);
                Some(
                    pair.map(|((a, b), range)| if *range > 0.0 { (a - b) / range } else { 0.0 })
                        .collect(),
                )
            };
            if let (Some(a), Some(b)) = (way(i), way(j)) {
                let along: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
                match along.total_cmp(&0.0) {
                    core::cmp::Ordering::Greater => same.add(square),
                    core::cmp::Ordering::Less => opposite.add(square),
                    core::cmp::Ordering::Equal => {}
                }
            }
        }
    }
    Some(Repeatability {
        pairs: both.count,
        rms_distance: both.rms()? / 2f64.sqrt(),
        same_side: same.rms().map(|rms| (same.count, rms)),
        opposite_sides: opposite.rms().map(|rms| (opposite.count, rms)),
    })
}

#[derive(Default)]
struct Sum {
    squares: f64,
    count: usize,
}

impl Sum {
    fn add(&mut self, square: f64) {
        self.squares += square;
        self.count += 1;
    }

    fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.squares / self.count as f64).sqrt())
    }
}

/// The commands of a step as numbers: those of the motors, and of the cables that no motor drives.
fn commands(robot: &Robot, case: &Case, step: usize) -> Vec<f64> {
    let earlier = case.motors.len().saturating_sub(case.before.len() + 1);
    let motors = case.motors.get(earlier + step).into_iter().flatten();
    let mut all: Vec<f64> = motors.map(|command| command.unwrap_or(0.0)).collect();
    if !case.loads_before.is_empty() {
        let loads = case.loads_before.get(step).unwrap_or(&case.loads);
        let gravity = loads.gravity.unwrap_or_default();
        all.extend([loads.tip_force, loads.tip_moment, gravity].iter().flat_map(|v| v.to_array()));
    }
    let is_driven = |cable: usize| {
        let motor = robot.motor_of(cable).and_then(|motor| case.motor_command(motor));
        motor.is_some()
    };
    let of_cables = case.before.get(step).unwrap_or(&case.commands).iter().enumerate();
    for (_, CableCommand { tension, shortening }) in
        of_cables.filter(|(cable, _)| !is_driven(*cable))
    {
        all.push(tension.unwrap_or(0.0));
        all.push(match shortening {
            Some(Shortening::Length(value) | Shortening::Fraction(value)) => *value,
            None => 0.0,
        });
    }
    all
}

/// Whether all but the commands is the same.
fn is_alike(experiments: &[Experiment], a: Row, b: Row) -> bool {
    if experiments[a.experiment].frame != experiments[b.experiment].frame {
        return false;
    }
    let (a, b) = (&experiments[a.experiment].case, &experiments[b.experiment].case);
    core::ptr::eq(a, b) || (a.loads == b.loads && a.base == b.base && a.obstacles == b.obstacles)
}

/// Where a marker sits: its place and the bits of its arc length.
type PlaceKey = (bool, u64);

fn place_key(seen: &Observation) -> PlaceKey {
    match seen.place {
        Place::Disk(disk) => (true, disk as u64),
        Place::ArcLength(s) => (false, s.to_bits()),
    }
}

/// A marker whose position was seen.
struct Marker {
    place: PlaceKey,
    measured: Vec3,
    /// Model less measurement.
    residual: Vec3,
}

/// The markers whose positions were seen, by rows.
fn residuals(experiments: &[Experiment], found: &Identified) -> BTreeMap<Row, Vec<Marker>> {
    let mut all: BTreeMap<Row, Vec<_>> = BTreeMap::new();
    for residual in found.residuals.iter().filter(|residual| !residual.is_negligible()) {
        let seen = &experiments[residual.experiment].observations[residual.observation];
        if let Seen::Position(measured) = seen.seen {
            let row = Row { experiment: residual.experiment, step: seen.step };
            let residual = Vec3::from(residual.difference);
            all.entry(row).or_default().push(Marker { place: place_key(seen), measured, residual });
        }
    }
    all
}

/// Mean square distance between the markers of two rows.
fn square_of_pair(
    left: &BTreeMap<Row, Vec<Marker>>,
    a: Row,
    b: Row,
    by_model: bool,
) -> Option<f64> {
    let (a, b) = (left.get(&a)?, left.get(&b)?);
    let mut sum = Sum::default();
    for of_a in a {
        let Some(of_b) = b.iter().find(|other| other.place == of_a.place) else { continue };
        sum.add(match by_model {
            true => (of_a.residual - of_b.residual).norm_squared(),
            false => (of_a.measured - of_b.measured).norm_squared(),
        });
    }
    (sum.count > 0).then(|| sum.squares / sum.count as f64)
}
