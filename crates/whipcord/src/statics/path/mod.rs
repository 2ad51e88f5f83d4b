//! Equilibrium paths under a growing load, for any model: continuation by arc length past limit points, and branches.
//!
//! Where a robot snaps through, the load cannot be raised: the path turns back. Here the load factor is an
//! unknown, too. From a point on the path a step goes along the tangent, and Newton's method returns
//! to the path at right angles to it (Riks, Int. J. Solids Struct. 15 (1979) 529–551).
//!
//! A model takes part by [`EquilibriumPath`]: Newton's method at a load or across a direction, the linear step, and the
//! number of unstable directions.
//!
//! | module | content |
//! |---|---|
//! | `state`, `point` | states along a path, directions, and points with their tangents |
//! | `arc_length` | steps along a path, and the limit points and bifurcations between them |
//! | `corner` | corners of a path, where a cable goes slack or taut |
//! | `switch` | the other branch at a bifurcation |
//! | `newton` | Newton's method, for models that have none of their own |
//! | `next_stable` | the next stable equilibrium past a limit point |
//! | `branches` | all equilibria that are connected to the unloaded shape |

pub(crate) mod arc_length;
pub(crate) mod branches;
mod corner;
pub(crate) mod newton;
pub(crate) mod next_stable;
mod point;
pub(crate) mod state;
mod switch;

use whipcord_numerics::Vec3;

use crate::statics::command::Command;
use crate::statics::scales::Scales;
use state::{Direction, Part, State};

/// State of a path, and direction along it.
pub(crate) type StateOf<P> = State<<P as EquilibriumPath>::Part>;
pub(crate) type DirectionOf<P> = Direction<<<P as EquilibriumPath>::Part as Part>::Change>;

/// What is asked of a linear step.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Step<'a, C> {
    /// The step of Newton's method at this load.
    Close,
    /// The step of Newton's method at right angles to a direction; the load is free.
    Across(&'a Direction<C>),
    /// The tangent of the path that goes along with a direction.
    Along(&'a Direction<C>),
    /// The response to generic residuals ([`pattern`]) at this load: near a singular point, the null vector.
    Probe,
}

impl<C> Step<'_, C> {
    pub const fn frees_load(&self) -> bool {
        matches!(self, Self::Across(_) | Self::Along(_))
    }

    /// Whether it takes residuals away.
    pub const fn closes(&self) -> bool {
        matches!(self, Self::Close | Self::Across(_))
    }
}

/// A residual of part `k` whose direction is generic: it excites every mode of buckling.
pub(crate) fn pattern(k: usize) -> Vec3 {
    Vec3::new(1.0 + 0.1 * k as f64, 0.3 - 0.05 * k as f64, 0.01)
}

/// A model under a load factor, and the state at which it was evaluated last.
pub(crate) trait EquilibriumPath {
    /// Of its state.
    type Part: Part;

    /// What drives each cable.
    fn commands(&self) -> &[Command];

    /// Lets other commands drive the cables.
    fn set_commands(&mut self, commands: &[Command]);

    /// Whether the solve was ended from outside.
    fn has_ended(&self) -> bool;

    /// Share of the robot that part `k` of the state stands for.
    fn weight(&self, k: usize) -> f64;

    /// Units of moments, forces and lengths.
    fn scales(&self) -> Scales;

    /// The state.
    fn state(&self) -> StateOf<Self>;

    /// Goes to a state, of which nothing is known yet.
    fn set_state(&mut self, state: StateOf<Self>);

    /// Newton's method from the state, at its load or across a direction, to this residual or to that which answers
    /// have where that is greater. The number of iterations; `None` where it does not converge.
    fn converge(&mut self, across: Option<&DirectionOf<Self>>, residual: f64) -> Option<usize>;

    /// The linear step that [`Step::Along`] or [`Step::Probe`] ask for at an equilibrium; `None` where the system is
    /// singular.
    fn direction(
        &mut self,
        step: Step<'_, <Self::Part as Part>::Change>,
    ) -> Option<DirectionOf<Self>>;

    /// The number of directions in which an equilibrium is unstable, after [`Self::direction`]; under followers, whether
    /// it is odd. `None` where it is not known.
    fn unstable_directions(&mut self) -> Option<usize>;

    /// The lengths of the cables at the state, in m.
    fn lengths(&mut self) -> Option<&[f64]>;

    /// Where the tip is at the state, in m in the frame of the base.
    fn tip(&mut self) -> Vec3;

    /// Product of two directions.
    fn dot(&self, a: &DirectionOf<Self>, b: &DirectionOf<Self>) -> f64 {
        a.dot(b, |k| self.weight(k), &self.scales())
    }

    /// Scales a direction to length 1; `false` where it has none.
    fn normalize(&self, direction: &mut DirectionOf<Self>) -> bool {
        let norm = self.dot(direction, direction).sqrt();
        if !norm.is_finite() || norm < f64::MIN_POSITIVE {
            return false;
        }
        direction.scale(1.0 / norm);
        true
    }

    /// Goes to the state this far from another along a direction.
    fn step_from(&mut self, from: &StateOf<Self>, reach: f64, direction: &DirectionOf<Self>) {
        let mut state = from.clone();
        state.step_from(from, reach, direction);
        self.set_state(state);
    }
}
