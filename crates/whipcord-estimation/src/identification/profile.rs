//! Profile likelihoods: how well each value of an unknown agrees with the measurements when all others are fitted anew. Where
//! the measurements hardly determine an unknown, the interval of its standard deviation is wrong and that of the profile is not.

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::forward::Forward;
use super::linear::{fitted, values};
use super::logarithm::Logarithms;
use super::noise;
use super::outcome::Identified;
use super::problem::Problem;
use super::settings::Settings;
use whipcord::robot::Robot;
use whipcord_numerics::least_squares::{Options, Workspace};
use whipcord_numerics::student_quantile;

/// The profile of an unknown, eq. (i10).
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Number of the unknown.
    pub unknown: usize,
    /// Values in ascending order, each with the rise of twice the objective, eq. (i4), in units of the noise: the estimate has 0.
    pub points: Vec<[f64; 2]>,
    /// The rise at the ends of the interval.
    pub limit: f64,
    /// Ends of the interval with the probability asked for; none where no value on that side contradicts the measurements.
    pub interval: [Option<f64>; 2],
}

/// How near the rise at an end of the interval comes to the limit, as a part of its root.
const NEARNESS: f64 = 0.02;
/// Steps of the search for an end, and by how much the distance from the estimate grows in one at most.
const STEPS: usize = 30;
const GROWTH: f64 = 4.0;

/// The profile of one unknown of a fit.
///
/// # Errors
/// As [`super::identify`].
pub fn profile(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    found: &Identified,
    unknown: usize,
) -> Result<Profile, IdentifyError> {
    let kept = fitted(experiments, found, false);
    let freedom = match found.noise.is_estimated {
        true => found.noise.freedom as f64,
        false => f64::INFINITY,
    };
    let quantile = student_quantile(0.5 + 0.5 * settings.confidence, freedom);
    let x = values(found);
    let mut forward = Forward::new(robot, &kept, unknowns, settings)?;
    let scales = forward.scales(&x);
    let logarithms = Logarithms::new(unknowns, &x);
    let mut at = |value: f64, start: &mut Vec<f64>| -> Result<f64, IdentifyError> {
        let bound = |of: fn(&Unknown) -> f64| -> Vec<f64> {
            let each = unknowns.iter().enumerate();
            each.map(|(j, unknown)| logarithms.searched(j, of(unknown))).collect()
        };
        let mut options = Options {
            lower: bound(Unknown::least),
            upper: bound(Unknown::greatest),
            iterations: settings.iterations,
            ..Options::default()
        };
        let fixed = logarithms.searched(unknown, value);
        (options.lower[unknown], options.upper[unknown]) = (fixed, fixed);
        start[unknown] = value;
        let mut problem = Problem::new(&mut forward, &logarithms, &scales, &settings.progress);
        let mut workspace = Workspace::default();
        let fitted =
            noise::fit(&mut problem, start, &options, settings.robustness, &mut workspace)?;
        Ok(2.0 * fitted.outcome.cost)
    };
    let least = at(x[unknown], &mut x.clone())?;
    let mut points = vec![[x[unknown], 0.0]];
    let mut interval = [None; 2];
    for (side, end) in [-1.0, 1.0].into_iter().zip(&mut interval) {
        let y = logarithms.searched(unknown, x[unknown]);
        let deviation = found.estimates[unknown].deviation;
        let deviation =
            deviation.unwrap_or(0.1 * scales[unknown]) / logarithms.slope(unknown, x[unknown]);
        let room = match side < 0.0 {
            true => y - logarithms.searched(unknown, unknowns[unknown].least()),
            false => logarithms.searched(unknown, unknowns[unknown].greatest()) - y,
        };
        let mut distance = (quantile * deviation).min(room);
        let (mut inside, mut outside) = (0.0, f64::INFINITY);
        // Fits that begin where the value before contradicts the measurements can end in another minimum than those from the inside.
        let (mut nearest, mut start) = (x.clone(), x.clone());
        for _ in 0..STEPS {
            if distance <= 0.0 {
                break;
            }
            let value = logarithms.value(unknown, y + side * distance);
            start.clone_from(&nearest);
            let Ok(cost) = at(value, &mut start) else {
                // Beyond the values that have an answer nothing is known.
                outside = distance;
                distance = 0.5 * (inside + outside);
                continue;
            };
            let rise = (cost - least).max(0.0);
            points.push([value, rise]);
            let root = rise.sqrt() / quantile;
            if (root - 1.0).abs() <= NEARNESS {
                *end = Some(value);
                break;
            }
            if root < 1.0 {
                inside = distance;
                nearest.clone_from(&start);
            } else {
                outside = distance;
            }
            if root < 1.0 && distance >= room {
                break;
            }
            let grown = distance * (1.0 / root).min(GROWTH);
            distance = match outside.is_finite() {
                true if grown > inside && grown < outside => grown,
                true => 0.5 * (inside + outside),
                false => grown.min(room),
            };
        }
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(Profile { unknown, points, limit: quantile * quantile, interval })
}
