//! What makes `MuJoCo`'s contacts nearly hard.

/// How contacts and joints are set where there are obstacles.
///
/// A contact yields by the acceleration that the bodies would have without it, times a square of its time constant. Light bodies that
/// stiff springs and cables press together would sink in by more than their size. An armature of the joints slows them.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// In s.
    time_step: f64,
}

/// Time in s in which a joint with its armature swings, over 2π, in time steps.
const SWING: f64 = 10.0;
/// Least time constant of a contact that `MuJoCo` takes, in time steps.
const TIME_CONSTANT: f64 = 2.0;

impl Contact {
    /// For this time step in s.
    pub const fn with_time_step(time_step: f64) -> Self {
        Self { time_step }
    }

    /// Armature in kg·m² of a joint of this stiffness in N·m/rad.
    pub fn armature(self, stiffness: f64) -> f64 {
        stiffness * (SWING * self.time_step).powi(2)
    }

    /// Time constant in s and damping ratio.
    pub fn reference(self) -> [f64; 2] {
        [TIME_CONSTANT * self.time_step, 1.0]
    }

    /// Impedance at no and at full depth, and the depth in m in which it rises.
    pub const fn impedance(self) -> [f64; 3] {
        [0.999, 0.9999, 1e-4]
    }
}
