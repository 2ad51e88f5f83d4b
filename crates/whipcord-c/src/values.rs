//! Values that the interface gives in structures.

/// Whether an equilibrium is stable.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stability {
    /// Not known: the model has no energy, or it is not determined.
    Unknown = 0,
    /// The robot comes back after a small disturbance.
    Stable = 1,
    /// It does not.
    Unstable = 2,
}

/// How a solution was obtained.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diagnostics {
    /// Newton iterations.
    pub iterations: usize,
    /// Integration steps, or sections, from base to tip.
    pub steps: usize,
    /// What is left of the equations, relative to their scale.
    pub residual: f64,
    /// Whether it is stable.
    pub stability: Stability,
}

/// What a command is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// The tension of a cable in N.
    Tension = 0,
    /// The shortening of a cable in m.
    Shortening = 1,
    /// A motor: its angle in rad, or its travel in m.
    Motor = 2,
}

/// What became of a target.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReachOutcome {
    /// The robot is there within tolerance and limits, in a stable equilibrium.
    Reached = 0,
    /// It is not: the commands are those that lead nearest, as far as was found.
    Nearest = 1,
    /// Neither reached nor a minimum of the distance found.
    Undecided = 2,
}

/// The answer to an inverse problem.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachResult {
    /// What became of the target.
    pub outcome: ReachOutcome,
    /// Distance of the tip from the target in m.
    pub position_miss: f64,
    /// Angle from the target in rad; 0 where none is asked for.
    pub angle_miss: f64,
    /// Pose of the tip under the commands: x, y, z in m, quaternion w, x, y, z.
    pub tip: [f64; 7],
    /// Solves of the model.
    pub solves: usize,
}
