//! The second variation of the energy on the steps of a grid, as 3×3 blocks; eq. (8) of `docs/theory/cosserat.md`.

use whipcord_numerics::{Mat3, UnitQuaternion, Vec3};

use crate::section::{BodyWrench, Strain, Tangent};

/// A cross-section of the loaded rod and its tangent stiffness.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sample {
    pub strain: Strain,
    pub wrench: BodyWrench,
    pub tangent: Tangent,
    pub rotation: UnitQuaternion,
}

/// Quadratic forms of one step on (start, middle, end): energy and metric, as 3×3 blocks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Element {
    pub energy: [[Mat3; 3]; 3],
    pub metric: [[Mat3; 3]; 3],
}

/// `|m||η|²` of the part of `η` across `m`.
pub(crate) fn across(m: Vec3) -> Mat3 {
    let size = m.norm();
    if size == 0.0 {
        return Mat3::ZERO;
    }
    Mat3::IDENTITY * size - Mat3::outer(m, m) * (1.0 / size)
}

/// The number of negative eigenvalues of a symmetric block: by the signs of its leading minors where
/// they are plain.
pub(crate) fn negative_eigenvalues(block: &Mat3) -> usize {
    let rows = &block.rows;
    let size = rows.iter().map(|row| row.max_abs()).fold(0.0, f64::max);
    let first = rows[0][0];
    let second = first * rows[1][1] - rows[1][0] * rows[1][0];
    let third = block.determinant();
    let plain = first.abs() > 1e-8 * size
        && second.abs() > 1e-8 * size * size
        && third.abs() > 1e-8 * size * size * size;
    if !plain {
        return block.symmetric_eigenvalues().iter().filter(|&&x| x < 0.0).count();
    }
    let changes = |a: f64, b: f64| usize::from((a < 0.0) != (b < 0.0));
    changes(1.0, first) + changes(first, second) + changes(second, third)
}

/// The inverse of a symmetric block and the number of its negative eigenvalues. A block that is
/// singular to working precision is moved off by as much as rounding has.
pub(crate) fn pivot(block: Mat3) -> (Mat3, usize) {
    let negative = negative_eigenvalues(&block);
    let inverse = block.inverse().unwrap_or_else(|| {
        let size = block.rows.iter().map(|row| row.max_abs()).fold(f64::MIN_POSITIVE, f64::max);
        let moved = block + Mat3::IDENTITY * (16.0 * f64::EPSILON * size);
        moved.inverse().unwrap_or(Mat3::IDENTITY * (1.0 / (f64::EPSILON * size)))
    });
    (inverse, negative)
}

pub(crate) fn symmetric(a: Mat3) -> Mat3 {
    (a + a.transpose()) * 0.5
}

/// Slopes of the three shape functions of a step, times its length, at start, middle and end.
pub(crate) const SLOPES: [[f64; 3]; 3] = [[-3.0, 4.0, -1.0], [-1.0, 0.0, 1.0], [1.0, -4.0, 3.0]];
/// Simpson's rule.
pub(crate) const WEIGHTS: [f64; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];

/// Simpson's rule on the quadratic shape functions of a step.
///
/// Each shape function is 1 at one sample and 0 at the two others: at sample `q` the energy is a form of
/// `ζ′ = Σ σᵢ ζᵢ`, with `σᵢ` their slopes, and of `ζ = ζ_q`. The unknowns `ζ = R η` are rotations in the frame that the
/// rotations of the samples are given in: there `δu = Rᵀ ζ′` exactly, however much the rod turns within a step.
pub(crate) fn element(h: f64, samples: &[Sample], bending: impl Fn(usize) -> Mat3) -> Element {
    let mut turning = [Turning::default(); 3];
    for (q, (of, sample)) in turning.iter_mut().zip(samples).enumerate() {
        let frame = sample.rotation.to_matrix();
        let fixed = |of_body: Mat3| frame * of_body * frame.transpose();
        let push = Mat3::skew(sample.wrench.linear);
        let moment = Mat3::skew(sample.wrench.angular);
        let (compliance, coupling) = sample.tangent.force_compliance();
        // −M·(η × δu) = ηᵀ M̂ δu with M̂ δu = M × δu, made symmetric.
        let slope_turn = moment.transpose() * 0.5 - coupling.transpose() * push;
        let turn_turn = tilt(sample.strain.linear, sample.wrench.linear)
            - push.transpose() * (compliance * push);
        let weight = WEIGHTS[q];
        *of = Turning {
            slope_slope: fixed(sample.tangent.reduced) * (weight / h),
            slope_turn: fixed(slope_turn) * weight,
            turn_turn: fixed(turn_turn) * (weight * h),
            metric: fixed(bending(q)) * (weight / h),
        };
    }
    let mut out = Element::default();
    for i in 0..3 {
        for j in 0..=i {
            let (mut energy, mut metric) = (Mat3::ZERO, Mat3::ZERO);
            for (of, slopes) in turning.iter().zip(SLOPES) {
                let slopes = slopes[i] * slopes[j];
                if slopes != 0.0 {
                    energy += of.slope_slope * slopes;
                    metric += of.metric * slopes;
                }
            }
            energy += turning[j].slope_turn * SLOPES[j][i];
            energy += turning[i].slope_turn.transpose() * SLOPES[i][j];
            if i == j {
                energy += turning[i].turn_turn;
            } else {
                (out.energy[j][i], out.metric[j][i]) = (energy.transpose(), metric.transpose());
            }
            (out.energy[i][j], out.metric[i][j]) = (energy, metric);
        }
    }
    out
}

/// The symmetric forms of `h η′` and `η` at a sample, times its weight.
#[derive(Clone, Copy, Debug, Default)]
struct Turning {
    slope_slope: Mat3,
    slope_turn: Mat3,
    turn_turn: Mat3,
    metric: Mat3,
}

/// The symmetric matrix of `−v·(η × (η × N)) = (v·N)|η|² − (v·η)(N·η)`.
fn tilt(v: Vec3, force: Vec3) -> Mat3 {
    Mat3::IDENTITY * v.dot(force) - symmetric(Mat3::outer(v, force))
}
