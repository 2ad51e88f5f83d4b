//! Why an inverse problem cannot be posed or solved.

use whipcord::SolveError;

/// Why an inverse problem cannot be posed or solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InverseError {
    /// Nothing to command.
    #[error("the robot has no cables, so that there is nothing to command")]
    NoActuators,
    /// Motors are asked for.
    #[error(
        "the robot has no motors: add [[motors]] to its file, or ask for tensions or shortenings"
    )]
    NoMotors,
    /// Limits and cables do not match.
    #[error("limits of {given} cables are given for a robot that has {cables}")]
    LimitCount {
        /// Given.
        given: usize,
        /// Of the robot.
        cables: usize,
    },
    /// No command keeps the limits.
    #[error(
        "limits of the {what} of cable {}: the least must not exceed the greatest nor a tension be negative, but they are {} and {}",
        cable + 1, least, greatest
    )]
    EmptyLimits {
        /// Number of the cable from 0.
        cable: usize,
        /// `tension` or `shortening`.
        what: &'static str,
        /// In SI.
        least: f64,
        /// In SI.
        greatest: f64,
    },
    /// A rate that is not positive.
    #[error("the limit of the rate of cable {} must be positive", cable + 1)]
    Rate {
        /// Number of the cable from 0.
        cable: usize,
    },
    /// The target cannot be used.
    #[error("target: {0}")]
    Target(TargetProblem),
    /// The robot has no shape to start from.
    #[error("there is no shape to start from: {0}")]
    NoStart(SolveError),
    /// No solve may be spent.
    #[error("no solve may be spent: allow at least 1")]
    NoSolves,
    /// The solve was refused, or cancelled.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// Options of a controller that cannot be used.
    #[error(
        "period, gain, tolerances and deviations of a controller must be positive, its damping not negative"
    )]
    ControlOptions,
    /// A controller needs exact derivatives.
    #[error(
        "a controller needs a model with exact derivatives: use cosserat, cosserat-disks, piecewise-constant-curvature or pseudo-rigid-body"
    )]
    NoDerivatives,
    /// An edge of voxels that cannot be used.
    #[error(
        "the edge of a voxel must be at least {least} m, a thousandth of the length, but is {voxel} m"
    )]
    Voxel {
        /// Given, in m.
        voxel: f64,
        /// In m.
        least: f64,
    },
    /// Shapes could not be computed.
    #[error("the shapes to start from could not be computed: {0}")]
    Atlas(String),
    /// Shapes to start from that are of something else.
    #[error(
        "the atlas is of another robot, model, load or limit, or not whole: compute it anew with InverseSolver::atlas"
    )]
    ForeignAtlas,
}

/// What is wrong with a target.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TargetProblem {
    /// NaN or infinite.
    #[error("a coordinate is not finite")]
    NotFinite,
    /// A direction of length zero.
    #[error("the direction of the axis has the length zero")]
    NoDirection,
    /// A disk that there is not.
    #[error("there is no disk {disk}: the robot has disks 0 to {last}")]
    NoSuchDisk {
        /// Asked for.
        disk: usize,
        /// Of the robot.
        last: usize,
    },
    /// A shape without points.
    #[error("the shape has no points")]
    NoPoints,
    /// A tolerance that is not positive.
    #[error("the tolerances must be positive")]
    Tolerance,
    /// The times of a path do not ascend.
    #[error("the times of a path must ascend, but that of point {point} does not")]
    Times {
        /// From 1.
        point: usize,
    },
}
