//! Points of an equilibrium path.

use super::state::{Direction, Part, State};
use super::{DirectionOf, EquilibriumPath, Step};

/// A point of the path and the way on from it.
#[derive(Clone, Debug)]
pub(crate) struct PathPoint<N: Part> {
    pub state: State<N>,
    /// Of length 1.
    pub tangent: Direction<N::Change>,
    /// The number of directions in which the equilibrium is unstable; under followers, whether it
    /// is odd.
    pub unstable: usize,
}

impl<N: Part> PathPoint<N> {
    /// Whether a cable is slack here and pulls there.
    pub fn changes_cables(&self, other: &Self) -> bool {
        let tensions = self.state.tensions.iter().zip(&other.state.tensions);
        tensions.into_iter().any(|(&a, &b)| (a > 0.0) != (b > 0.0))
    }

    /// Whether stability is not the same there, though the load goes on alike.
    pub fn changes_stability(&self, other: &Self) -> bool {
        self.unstable != other.unstable && self.tangent.load * other.tangent.load > 0.0
    }

    /// Whether the point is a corner where a cable goes slack, and its tangent still that of the taut cable.
    pub fn is_before_corner(&self) -> bool {
        let tensions = self.state.tensions.iter().zip(&self.tangent.tensions);
        tensions.into_iter().any(|(&tension, &rate)| tension == 0.0 && rate < 0.0)
    }
}

/// The point at the equilibrium that a path holds.
pub(super) fn path_point<P: EquilibriumPath>(
    path: &mut P,
    along: &DirectionOf<P>,
) -> Option<PathPoint<P::Part>> {
    let mut tangent = path.direction(Step::Along(along))?;
    if !path.normalize(&mut tangent) {
        return None;
    }
    let unstable = path.unstable_directions()?;
    Some(PathPoint { state: path.state(), tangent, unstable })
}
