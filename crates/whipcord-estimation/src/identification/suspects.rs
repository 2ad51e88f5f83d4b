//! Single cables whose zero or angle stands out from the others: the commonest defect of real robots and of their files.

use super::build::present;
use super::check::driven_by_tension;
use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::fewer_rows::part_of_rows;
use super::identify::identify;
use super::linear::{Linear, beside, fitted, values};
use super::method::DerivativeMethod;
use super::outcome::{Identified, Residual};
use super::parameter_path::ParameterPath;
use super::quantity::Quantity;
use super::refused_rows::remembers;
use super::registered::registered;
use super::rows::rows;
use super::settings::Settings;
use crate::registration::{far_limit, far_off};
use std::collections::BTreeSet;
use whipcord::parameter::Parameter;
use whipcord::robot::Robot;
use whipcord_numerics::dot;

/// A number of one cable that is not estimated, and what its estimate would change, eq. (i8).
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// What it is: the offset of a command or the angle of a cable.
    pub quantity: Quantity,
    /// By how much it is off, to first order, in its unit.
    pub change: f64,
    /// Standard deviation of that, with the other estimates.
    pub deviation: f64,
    /// Part of the sum of squares that its estimate takes away, to first order.
    pub share: f64,
    /// Where it stands out: the same numbers of other cables that the measurements hardly tell from it, such as that of an antagonist, and
    /// whether they are off the same way.
    pub alike: Vec<(Quantity, bool)>,
    /// Where it stands out: root mean square distances in m before and after a fit with it, and the estimate of that fit.
    pub confirmed: Option<Confirmed>,
}

/// A suspect that stands out, fitted with the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confirmed {
    /// By how much it is off, in its unit.
    pub change: f64,
    /// Standard deviation of that.
    pub deviation: Option<f64>,
    /// Root mean square distance in m without it and with it; none of markers in images alone.
    pub rms_distance: Option<[f64; 2]>,
}

/// A suspect takes away at least this part of the sum of squares, …
const SHARE: f64 = 0.1;
/// … is this many times its deviation, …
const TIMES: f64 = 5.0;
/// … and takes away this many times as much as the same number of any other cable does, or leaves as many times less.
const AHEAD: f64 = 1.5;
/// Its estimate in a fit is no more than this many times smaller or greater than to first order.
const NEAR: f64 = 0.33;
/// Numbers whose columns have a cosine of this size between them or more are hardly told apart.
const ALIKE: f64 = 0.9;

/// The zeros and angles of single cables, the one that takes most away first. The first one is fitted where it stands out.
///
/// # Errors
/// [`IdentifyError`] where the model has no answer at the estimate.
pub fn suspects(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    found: &Identified,
) -> Result<Vec<Suspect>, IdentifyError> {
    let kept = fitted(experiments, found, true);
    let candidates = candidates(robot, &kept, unknowns, settings);
    if candidates.is_empty() {
        return Ok(Vec::new());
    }
    let all: Vec<Unknown> = unknowns.iter().chain(&candidates).cloned().collect();
    let mut x = values(found);
    for candidate in &candidates {
        let case = &experiments[0].case;
        x.push(present(&candidate.quantity, robot, case).map_err(IdentifyError::Absent)?);
    }
    let linear = Linear::at(robot, &kept, &all, settings, &x)?;
    let squares = dot(&linear.residuals, &linear.residuals);
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for (j, estimate) in found.estimates.iter().enumerate() {
        if !estimate.is_at_bound {
            add(&mut basis, linear.column(j));
        }
    }
    let mut all: Vec<(Suspect, Vec<f64>)> = Vec::new();
    for (j, candidate) in candidates.iter().enumerate() {
        let column = linear.column(unknowns.len() + j);
        let size = dot(&column, &column);
        let own = beside(&basis, column);
        let left = dot(&own, &own);
        // What the other estimates do as well stands out of nothing.
        if left <= 1e-6 * size || squares <= 0.0 {
            continue;
        }
        let along = dot(&own, &linear.residuals);
        let suspect = Suspect {
            quantity: candidate.quantity,
            change: -along / left,
            deviation: left.sqrt().recip(),
            share: along * along / left / squares,
            alike: Vec::new(),
            confirmed: None,
        };
        all.push((suspect, own));
    }
    all.sort_by(|a, b| b.0.share.total_cmp(&a.0.share));
    let alike = alike(&all);
    let mut all: Vec<Suspect> = all.into_iter().map(|(suspect, _)| suspect).collect();
    if let Some(first) = stands_out(&all, &alike) {
        all[0].alike = alike;
        let start = present(&first.quantity, robot, &experiments[0].case);
        let start = start.map_err(IdentifyError::Absent)?;
        let change = confirm(robot, experiments, unknowns, settings, (found, &first, start))?;
        all[0].confirmed = change;
    }
    Ok(all)
}

/// The single cable whose zero or angle stands out in measurements that were not fitted: where one stiffness of all drives, or that of the
/// backbone, is fitted to some of the rows, and the motion of the measurement where that is asked for. `None` where none stands out, and
/// where the model has no exact derivatives.
///
/// # Errors
/// [`IdentifyError::Cancelled`].
pub fn single_cable(
    robot: &Robot,
    experiments: &[Experiment],
    settings: &Settings,
) -> Result<Option<Suspect>, IdentifyError> {
    /// So many rows are enough for what stands out.
    const ENOUGH: usize = 200;
    /// Of fewer rows nothing is said.
    const LEAST: usize = 8;
    /// Of the distance, what may be left: without the other numbers that a fit would have, less of it can have other reasons.
    const LEFT: f64 = 0.6;
    let explains =
        |of: Confirmed| of.rms_distance.is_some_and(|[before, after]| after <= LEFT * before);
    let count = rows(experiments).len();
    if count < LEAST || robot.cables().len() < 2 || !settings.model.has_derivatives(robot) {
        return Ok(None);
    }
    let settings = Settings { skips: true, starts: 1, ..settings.clone() };
    let some = part_of_rows(experiments, count.div_ceil(ENOUGH));
    let found = registered(robot, &some, &stiffness(robot), true, &settings).and_then(
        |(some, unknowns)| {
            let mut some = some;
            let mut found = identify(robot, &some, &unknowns, &settings)?;
            if let Some(near) = without_far(&some, &found) {
                some = near;
                found = identify(robot, &some, &unknowns, &settings)?;
            }
            suspects(robot, &some, &unknowns, &settings, &found)
        },
    );
    match found {
        Ok(all) => Ok(all.into_iter().next().filter(|first| first.confirmed.is_some_and(explains))),
        Err(IdentifyError::Cancelled) => Err(IdentifyError::Cancelled),
        // What cannot be fitted tells nothing.
        Err(_) => Ok(None),
    }
}

/// The stiffness of all drives where it is given, else that of the backbone.
fn stiffness(robot: &Robot) -> Vec<Unknown> {
    let motors = robot.motors();
    let drives = !motors.is_empty() && motors.iter().all(|motor| motor.stiffness.is_some());
    let path = if drives { "motors[*].stiffness" } else { "backbone.young_modulus" };
    let unknown = path.parse().ok().and_then(|path: ParameterPath| path.unknown(robot).ok());
    let is_given = drives || robot.backbone().material.young_modulus.is_some();
    unknown.filter(|_| is_given).into_iter().collect()
}

/// The measurements without those that are far off, like jumps of a tracker; `None` where none is.
fn without_far(experiments: &[Experiment], found: &Identified) -> Option<Vec<Experiment>> {
    let distances: Vec<f64> = found.residuals.iter().map(Residual::distance).collect();
    let far: BTreeSet<(usize, usize)> = far_off(&distances, far_limit(&distances))
        .into_iter()
        .map(|k| (found.residuals[k].experiment, found.residuals[k].observation))
        .collect();
    let mut near = experiments.to_vec();
    for (experiment, of) in near.iter_mut().enumerate() {
        let mut number = 0..;
        of.observations.retain(|_| number.next().is_none_or(|k| !far.contains(&(experiment, k))));
    }
    (!far.is_empty()).then_some(near)
}

/// The other numbers of the kind of the first one, all with what is left of their columns, that the measurements hardly tell from it, and whether
/// they are off the same way. None where they are all the others: then nothing is left that it could stand out from.
fn alike(all: &[(Suspect, Vec<f64>)]) -> Vec<(Quantity, bool)> {
    let Some((first, column)) = all.first() else { return Vec::new() };
    let others = all.iter().filter(|(other, _)| is_same_kind(other, first));
    let cosine = |own: &[f64]| dot(own, column) / (dot(own, own) * dot(column, column)).sqrt();
    let found: Vec<(Quantity, bool)> = others
        .clone()
        .map(|(other, own)| (other.quantity, cosine(own)))
        .filter(|(_, cosine)| cosine.abs() >= ALIKE)
        .map(|(quantity, cosine)| (quantity, cosine > 0.0))
        .collect();
    if found.len() == others.count() { Vec::new() } else { found }
}

/// Whether both are offsets, or angles, of different cables.
fn is_same_kind(a: &Suspect, b: &Suspect) -> bool {
    use core::mem::discriminant;
    discriminant(&a.quantity) == discriminant(&b.quantity) && a.quantity != b.quantity
}

/// The first one, where it stands out from those that are not like it.
fn stands_out(all: &[Suspect], alike: &[(Quantity, bool)]) -> Option<Suspect> {
    let first = all.first()?;
    let others = all.iter().filter(|other| is_same_kind(other, first));
    let others = others.filter(|other| alike.iter().all(|(of, _)| *of != other.quantity));
    let next = others.map(|of| of.share).fold(0.0, f64::max);
    let clear = first.share >= SHARE && first.change.abs() >= TIMES * first.deviation;
    let leaves_less = (1.0 - next) >= AHEAD * (1.0 - first.share);
    (clear && (first.share >= AHEAD * next || leaves_less)).then(|| first.clone())
}

fn confirm(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    (found, suspect, from): (&Identified, &Suspect, f64),
) -> Result<Option<Confirmed>, IdentifyError> {
    let mut all: Vec<Unknown> = unknowns.to_vec();
    for (unknown, value) in all.iter_mut().zip(values(found)) {
        unknown.start = Some(value);
    }
    let start = Some(from + suspect.change);
    all.push(Unknown { start, ..Unknown::new(suspect.quantity) });
    let with = match identify(robot, experiments, &all, settings) {
        Ok(with) if with.status.is_converged() => with,
        Err(IdentifyError::Cancelled) => return Err(IdentifyError::Cancelled),
        _ => return Ok(None),
    };
    let Some(estimate) = with.estimates.last() else { return Ok(None) };
    // One that ends elsewhere than the linearised problem says explains something else.
    let times = (estimate.value - from) / suspect.change;
    if !(NEAR..=NEAR.recip()).contains(&times) {
        return Ok(None);
    }
    Ok(Some(Confirmed {
        change: estimate.value - from,
        deviation: estimate.deviation,
        rms_distance: found.rms_distance.zip(with.rms_distance).map(|(a, b)| [a, b]),
    }))
}

/// The zeros and angles of all cables that are not estimated.
fn candidates(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Vec<Unknown> {
    let mut all = Vec::new();
    if robot.cables().len() < 2 {
        return all;
    }
    for cable in 0..robot.cables().len() {
        let mut driven = experiments
            .iter()
            .filter(|of| !of.observations.is_empty())
            .map(|of| driven_by_tension(of, cable, &settings.model));
        let first = driven.next().flatten();
        let offset = match first.filter(|first| driven.all(|of| of == Some(*first))) {
            Some(true) => Some(Quantity::TensionOffset { cable }),
            Some(false) => Some(Quantity::ShorteningOffset { cable }),
            None => None,
        };
        let angle = Parameter::Angle { cable };
        let angle =
            experiments.first().and_then(|of| angle.value(robot, &of.case).ok().map(|_| angle));
        all.extend(offset.into_iter().chain(angle.map(Quantity::Parameter)).map(Unknown::new));
    }
    // History makes what an offset changes take as many steps as the fit has: by differences it would take longer than that.
    let slow = remembers(robot);
    let robot = (&settings.model, robot);
    all.retain(|candidate| {
        let of = |of| DerivativeMethod::of(candidate, unknowns, of, robot);
        !slow || !experiments.iter().any(|each| of(each).contains(&DerivativeMethod::Differences))
    });
    let is_estimated = |candidate: &Unknown| {
        unknowns.iter().flat_map(Unknown::quantities).any(|of| of.overlaps(&candidate.quantity))
    };
    all.retain(|candidate| !is_estimated(candidate));
    all
}

fn add(basis: &mut Vec<Vec<f64>>, column: Vec<f64>) {
    let size = dot(&column, &column);
    let own = beside(basis, column);
    let left = dot(&own, &own);
    if left > 1e-14 * size {
        basis.push(own.iter().map(|entry| entry / left.sqrt()).collect());
    }
}
