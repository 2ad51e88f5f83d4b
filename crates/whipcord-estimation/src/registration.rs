//! Which rigid motion takes what was measured to what it is compared with: eq. (r1) to (r4) of
//! `docs/theory/cameras.md`.

use thiserror::Error;
use whipcord_numerics::{Mat3, Pose, SingularValues, UnitQuaternion, Vec3};

use whipcord::format::{Round, millimetres};

/// Points whose spread across their line is below this part of that along it are on a line.
const ON_A_LINE: f64 = 1e-6;
/// Points of the base that are no further apart than this, in m, are one point.
const SAME_POINT: f64 = 1e-9;
/// Singular values of the covariance that are below this part of the largest one are rounding.
const ROUNDING: f64 = 1e-12;

/// Of fewer pairs none can be told to be a jump.
const FEWEST: usize = 10;
/// A pair counts less where it is farther apart than this many times the distance that three quarters of them do not exceed: twelve standard
/// deviations of normal noise.
const FAR: f64 = 6.0;
/// Where a greater part of the pairs is so far apart, it is the model that is wrong for some of them: then all count the same.
const MOST: f64 = 0.1;
/// No pair is far off by less than this part of the largest coordinate.
const LEAST_FAR: f64 = 1e-9;
/// Of the search for the weights.
const ROUNDS: usize = 50;

/// The best rigid motion, and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Registration {
    /// Takes a measured point to its target.
    pub motion: Pose,
    /// Distance in m that each pair is left apart.
    pub residuals: Vec<f64>,
    /// The root of their mean square, in m.
    pub rms: f64,
    /// The turn, in the frame of the targets, that the points fix least: their line, as a unit vector.
    pub axis: Vec3,
    /// Standard deviation of that turn in rad, as far as the residuals tell; `None` where the points
    /// leave it open, and the least turn was taken.
    pub turn_deviation: Option<f64>,
}

/// Why there is no registration.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RegistrationError {
    /// Too few pairs of points.
    #[error(
        "a rigid registration needs {least} points or more that are known on both sides, but has {given}"
    )]
    TooFew {
        /// Pairs given.
        given: usize,
        /// Fewest pairs that do.
        least: usize,
    },
    /// A coordinate that is not finite, or not within 10⁹ m.
    #[error("{} of pair {} is {value}, which must be a finite number within 1e9 m", if *measured { "a measured coordinate" } else { "a coordinate" }, pair + 1)]
    OutOfRange {
        /// Number of the pair, from 0.
        pair: usize,
        /// Whether it is of the measured point.
        measured: bool,
        /// The coordinate.
        value: f64,
    },
    /// All points in one place.
    #[error("the points lie within {} of one another: no direction can be had from them", millimetres(*spread, Round::Up))]
    Coincident {
        /// Their root mean square distance from their centre, in m.
        spread: f64,
    },
    /// A turn that the points leave open.
    #[error(
        "the points are on one line, so that any turn about it, ({}, {}, {}), fits as well: measure a point off the line, or ask for the least turn",
        rounded(axis.x), rounded(axis.y), rounded(axis.z)
    )]
    FreeTurn {
        /// The line, in the frame of the targets: a unit vector.
        axis: Vec3,
    },
    /// Different turns fit as well though the points are on no line.
    #[error(
        "two different turns fit the {given} pairs of points equally well: are the points of one side mirrored, or in another order?"
    )]
    Ambiguous {
        /// Pairs given.
        given: usize,
    },
}

/// How what was measured is moved onto a model's answer before they are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alignment {
    /// Not at all: it was measured in the frame of the world.
    #[default]
    None,
    /// By the rigid motion that brings all markers, of all steps, nearest to the answers.
    Rigid,
    /// By that which brings the markers on the base to it; one alone, in however many steps, by a shift.
    Base,
}

impl Alignment {
    /// All ways.
    pub const ALL: [Self; 3] = [Self::None, Self::Rigid, Self::Base];

    /// As robot files name it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Rigid => "rigid",
            Self::Base => "base",
        }
    }
}

/// The motion of an alignment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Aligned {
    /// Takes a measured point to the answer; `None` where nothing is to be moved.
    pub motion: Option<Pose>,
    /// Numbers of the pairs that count less than the others, as they are far off: [`register_robustly`].
    pub lowered: Vec<usize>,
}

/// The motion of an alignment, from pairs `[measured, target]` and whether each is on the base. Of turns that the pairs leave open it takes the
/// least; pairs that are far off count less.
///
/// # Errors
/// [`RegistrationError`] where there are too few points, or what they leave open is not a turn about their
/// line.
pub fn align(
    pairs: impl IntoIterator<Item = ([Vec3; 2], bool)>,
    alignment: Alignment,
) -> Result<Aligned, RegistrationError> {
    if alignment == Alignment::None {
        return Ok(Aligned::default());
    }
    let counts = |at_base: bool| alignment == Alignment::Rigid || at_base;
    let own = pairs.into_iter().enumerate().filter(|(_, (_, at_base))| counts(*at_base));
    let (numbers, pairs): (Vec<usize>, Vec<[Vec3; 2]>) =
        own.map(|(number, (pair, _))| (number, pair)).unzip();
    // One point on the base says where the base is, and nothing of how it is turned; the same point measured
    // in several steps says no more.
    let is_one_point = |[_, first]: &[Vec3; 2]| {
        pairs.iter().all(|[_, target]| (*target - *first).norm() <= SAME_POINT)
    };
    let (motion, lowered) =
        match alignment == Alignment::Base && pairs.first().is_some_and(is_one_point) {
            true => robustly(&pairs, |weights| Ok(shift(&pairs, weights)))?,
            false => robustly(&pairs, |weights| Ok(fit(&pairs, weights, 2)?.motion))?,
        };
    Ok(Aligned { motion: Some(motion), lowered: lowered.iter().map(|k| numbers[*k]).collect() })
}

/// The shift alone that brings the pairs nearest to one another.
fn shift(pairs: &[[Vec3; 2]], weights: &[f64]) -> Pose {
    let weighted = pairs.iter().zip(weights);
    let sum = weighted.fold(Vec3::ZERO, |sum, ([from, to], weight)| sum + (*to - *from) * *weight);
    Pose { position: sum / weights.iter().sum::<f64>(), ..Pose::IDENTITY }
}

fn rounded(component: f64) -> f64 {
    (component * 1e3).round() / 1e3 + 0.0
}

/// The rigid motion, without scale, that brings `measured` nearest to `target` in the sense of least
/// squares, for three pairs `[measured, target]` or more that are not on one line.
///
/// To register by the base alone, give the pairs of the markers on the base.
///
/// ```
/// use whipcord::Vec3;
/// use whipcord_estimation::registration::register;
/// let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.5)];
/// let pairs = points.map(|p| [Vec3::new(-p.y, p.x, p.z) + Vec3::Z, p]);
/// let found = register(&pairs)?;
/// assert!(found.rms < 1e-15);
/// assert!((found.motion.transform(Vec3::Z) - Vec3::ZERO).norm() < 1e-15);
/// # Ok::<(), whipcord_estimation::registration::RegistrationError>(())
/// ```
///
/// # Errors
/// [`RegistrationError`] where there are too few points, or they do not fix the motion.
pub fn register(pairs: &[[Vec3; 2]]) -> Result<Registration, RegistrationError> {
    let found = fit(pairs, &vec![1.0; pairs.len()], 3)?;
    if found.turn_deviation.is_none() {
        return Err(RegistrationError::FreeTurn { axis: found.axis });
    }
    Ok(found)
}

/// As [`register`]; of the turns that points on one line leave open it takes the least, and leaves
/// [`Registration::turn_deviation`] empty. Two pairs are enough.
///
/// # Errors
/// [`RegistrationError`] where there are too few points, or what they leave open is not a turn about their
/// line.
pub fn register_by_least_turn(pairs: &[[Vec3; 2]]) -> Result<Registration, RegistrationError> {
    fit(pairs, &vec![1.0; pairs.len()], 2)
}

/// As [`register_by_least_turn`], with the numbers of the pairs that count less than the others because they are far off, as where a tracker
/// jumps: eq. (r5) of `docs/theory/cameras.md`. Where none is, it is the motion of least squares. The root mean square distance is weighted too.
///
/// # Errors
/// As [`register_by_least_turn`].
pub fn register_robustly(
    pairs: &[[Vec3; 2]],
) -> Result<(Registration, Vec<usize>), RegistrationError> {
    let mut last = None;
    let (_, lowered) = robustly(pairs, |weights| {
        let found = fit(pairs, weights, 2)?;
        let motion = found.motion;
        last = Some(found);
        Ok(motion)
    })?;
    // The last fit is that of the weights in the end, but for those where all count the same after all.
    match last {
        Some(found) if !lowered.is_empty() => Ok((found, lowered)),
        _ => Ok((register_by_least_turn(pairs)?, lowered)),
    }
}

/// The distance that this part of the distances does not exceed; 0 of none.
fn exceeded(distances: &[f64], part: f64) -> f64 {
    let mut sorted = distances.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted.get(((sorted.len() as f64 * part) as usize).min(last)).copied().unwrap_or(0.0)
}

/// The distance beyond which one is far off.
pub(crate) fn far_limit(distances: &[f64]) -> f64 {
    FAR * exceeded(distances, 0.75)
}

/// The numbers of those that are far off; none where they are too few to tell, or so many that it is the model that is wrong for some.
pub(crate) fn far_off(distances: &[f64], limit: f64) -> Vec<usize> {
    let far: Vec<usize> = (0..distances.len()).filter(|k| distances[*k] > limit).collect();
    let count = distances.len();
    let are_few = far.len() as f64 <= MOST * count as f64;
    if count < FEWEST || !are_few { Vec::new() } else { far }
}

/// The motion of the pairs, and the numbers of those whose weight is lowered, from the motion of pairs with given weights.
fn robustly(
    pairs: &[[Vec3; 2]],
    mut motion_of: impl FnMut(&[f64]) -> Result<Pose, RegistrationError>,
) -> Result<(Pose, Vec<usize>), RegistrationError> {
    let count = pairs.len();
    let mut weights = vec![1.0; count];
    let squares = motion_of(&weights)?;
    if count < FEWEST {
        return Ok((squares, Vec::new()));
    }
    let apart = |motion: &Pose| -> Vec<f64> {
        pairs.iter().map(|[from, to]| (motion.transform(*from) - *to).norm()).collect()
    };
    // Jumps move the motion of least squares and hide behind that: first each counts by its distance alone where it is more than the median.
    let mut motion = squares;
    for _ in 0..ROUNDS {
        let distances = apart(&motion);
        let median = exceeded(&distances, 0.5);
        for (weight, distance) in weights.iter_mut().zip(&distances) {
            *weight = if *distance > median { median / distance } else { 1.0 };
        }
        // What the weights leave open tells of no jumps.
        let Ok(next) = motion_of(&weights) else { return Ok((squares, Vec::new())) };
        let moved =
            apart(&next).iter().zip(&distances).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        motion = next;
        if moved <= 1e-3 * median {
            break;
        }
    }
    // Then all that are near count the same.
    let size = pairs.iter().flatten().map(|point| point.max_abs()).fold(0.0, f64::max);
    let limit = far_limit(&apart(&motion)).max(LEAST_FAR * size);
    let mut lowered = Vec::new();
    for _ in 0..ROUNDS {
        let distances = apart(&motion);
        let before = weights.clone();
        for (weight, distance) in weights.iter_mut().zip(&distances) {
            *weight = if *distance > limit { (limit / distance).powi(2) } else { 1.0 };
        }
        lowered = far_off(&distances, limit);
        if lowered.is_empty() {
            return Ok((squares, Vec::new()));
        }
        let Ok(next) = motion_of(&weights) else { return Ok((squares, Vec::new())) };
        motion = next;
        if weights.iter().zip(&before).all(|(a, b)| (a - b).abs() <= 1e-9) {
            break;
        }
    }
    Ok((motion, lowered))
}

fn fit(
    pairs: &[[Vec3; 2]],
    weights: &[f64],
    least: usize,
) -> Result<Registration, RegistrationError> {
    let given = pairs.len();
    if given < least {
        return Err(RegistrationError::TooFew { given, least });
    }
    check(pairs)?;
    let weight = weights.iter().sum::<f64>().recip();
    let mean = |side: usize| {
        let weighted = pairs.iter().zip(weights);
        weighted.fold(Vec3::ZERO, |sum, (pair, own)| sum + pair[side] * *own) * weight
    };
    let centres = [mean(0), mean(1)];
    // Each with the root of its weight, whose squares count.
    let centred = || {
        let weighted = pairs.iter().zip(weights);
        weighted.map(|(pair, own)| [0, 1].map(|side| (pair[side] - centres[side]) * own.sqrt()))
    };
    // Each side in a unit of its own, so that no square leaves the range of numbers.
    let spreads = [0, 1].map(|side| {
        let largest = centred().map(|pair| pair[side].max_abs()).fold(0.0, f64::max);
        let mean: f64 = centred().map(|pair| (pair[side] / largest).norm_squared() * weight).sum();
        if largest > 0.0 { largest * mean.sqrt() } else { 0.0 }
    });
    let farthest = centres[0].max_abs().max(centres[1].max_abs());
    let spread = spreads[0].min(spreads[1]);
    if spread <= (1e3 * f64::EPSILON * farthest).max(1e-150) {
        return Err(RegistrationError::Coincident { spread });
    }
    let covariance = centred()
        .fold(Mat3::ZERO, |sum, [a, b]| sum + Mat3::outer(a / spreads[0], b / spreads[1]) * weight);
    let [best, second] = top_turns(&covariance);
    let width = |side: usize| {
        let inertia = centred().fold(Mat3::ZERO, |sum, pair| {
            let unit = pair[side] / spreads[side];
            sum + Mat3::outer(unit, unit) * weight
        });
        let ([least, middle, largest], axes) = inertia.symmetric_eigen();
        ((middle.max(0.0) + least.max(0.0)).sqrt(), largest.sqrt(), axes[2])
    };
    let (widths, axis) = ([width(0), width(1)], width(1).2);
    let line = widths.iter().any(|(across, along, _)| *across <= ON_A_LINE * along);
    if !line && best.value - second.value <= ROUNDING * best.value {
        return Err(RegistrationError::Ambiguous { given });
    }
    let rotation = if line { least_turn(best.turn, second.turn) } else { best.turn };
    let motion = Pose { position: centres[1] - rotation.rotate(centres[0]), rotation };
    let residuals: Vec<f64> =
        pairs.iter().map(|[from, to]| (motion.transform(*from) - *to).norm()).collect();
    let squares: f64 = residuals.iter().zip(weights).map(|(r, own)| r * r * own).sum();
    let across = widths[1].0 * spreads[1] / weight.sqrt();
    let freedoms = (3 * given).saturating_sub(6).max(1) as f64;
    Ok(Registration {
        motion,
        rms: (squares * weight).sqrt(),
        residuals,
        axis,
        turn_deviation: (!line).then(|| (squares / freedoms).sqrt() / across),
    })
}

fn check(pairs: &[[Vec3; 2]]) -> Result<(), RegistrationError> {
    for (pair, points) in pairs.iter().enumerate() {
        for (side, point) in points.iter().enumerate() {
            for value in point.to_array() {
                // Written so that a NaN is refused as well.
                if value.is_nan() || value.abs() > 1e9 {
                    let measured = side == 0;
                    return Err(RegistrationError::OutOfRange { pair, measured, value });
                }
            }
        }
    }
    Ok(())
}

/// A turn, and `Σ q(aᵢ)·bᵢ` under it.
struct Turn {
    value: f64,
    turn: UnitQuaternion,
}

/// The two best of four orthogonal quaternions, eq. (r2): the eigenvectors of Horn's matrix, which a
/// shift makes positive, so that its singular values are its eigenvalues.
fn top_turns(covariance: &Mat3) -> [Turn; 2] {
    let [a, b, c] = covariance.rows;
    let twist = [b.z - c.y, c.x - a.z, a.y - b.x];
    let trace = a.x + b.y + c.z;
    let mut matrix = [0.0; 16];
    matrix[0] = trace;
    for i in 0..3 {
        matrix[i + 1] = twist[i];
        matrix[4 * (i + 1)] = twist[i];
        for j in 0..3 {
            let both = covariance.rows[i][j] + covariance.rows[j][i];
            matrix[4 * (i + 1) + j + 1] = if i == j { both - trace } else { both };
        }
    }
    let shift = matrix.iter().map(|m| m * m).sum::<f64>().sqrt();
    for i in 0..4 {
        matrix[5 * i] += shift;
    }
    let found = SingularValues::of(4, &matrix);
    [0, 1].map(|k| {
        let q = found.direction(k);
        let turn = UnitQuaternion { w: q[0], v: Vec3::new(q[1], q[2], q[3]) };
        Turn { value: found.values[k] - shift, turn: turn.renormalized() }
    })
}

/// The rotation Q for which ‖Q − A‖² is least, of a matrix A of rank two or more.
#[must_use]
pub fn nearest_rotation(matrix: &Mat3) -> UnitQuaternion {
    // The axes are the points, and the columns their targets.
    let [best, _] = top_turns(&matrix.transpose());
    best.turn
}

/// The least turn among those that two orthogonal quaternions span, eq. (r4).
fn least_turn(a: UnitQuaternion, b: UnitQuaternion) -> UnitQuaternion {
    let real = a.w.hypot(b.w);
    // All of them are half turns: one is as good as the other.
    if real < 1e-12 {
        return a;
    }
    let (p, q) = (a.scaled(a.w / real), b.scaled(b.w / real));
    UnitQuaternion { w: p.w + q.w, v: p.v + q.v }.renormalized()
}
