//! What acts inside the rod at the nodes between its steps.

use whipcord_numerics::{Twist, UnitQuaternion, Vec3};

/// How the rod is turned and what it bears where its steps meet, for a later solve that starts from the answer: nothing where single shooting found
/// it, with contacts or friction, from other models, and after a solution was read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InternalState {
    /// From base to tip.
    pub(crate) nodes: Vec<NodeState>,
    /// At start, middle and end of each step in turn; empty where the sections need no start.
    pub(crate) strains: Vec<Twist>,
    /// Whether single shooting would miss the answer.
    pub(crate) takes_multiple_shooting: bool,
}

/// A node between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NodeState {
    pub rotation: UnitQuaternion,
    /// In the body frame, in N·m.
    pub moment: Vec3,
    /// Of the followers, in the base frame, in N.
    pub force: Vec3,
}

impl InternalState {
    /// Forgets it: the next solve goes by wrench at the base and tensions alone.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.strains.clear();
        self.takes_multiple_shooting = false;
    }

    /// Takes another for its own, in the memory that it has.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.nodes.clone_from(&other.nodes);
        self.strains.clone_from(&other.strains);
        self.takes_multiple_shooting = other.takes_multiple_shooting;
    }

    /// How many of its steps make one step of a grid with so many; `None` unless that is a power of two.
    pub(crate) fn own_steps_per_step(&self, steps: usize) -> Option<usize> {
        let own = self.nodes.len().checked_sub(1)?;
        let ratio = own.checked_div(steps)?;
        (ratio.is_power_of_two() && ratio * steps == own).then_some(ratio)
    }

    /// The strains at start, middle and end of each step of a grid each of whose steps is so many of these.
    pub(crate) fn strains_of_steps(&self, ratio: usize) -> impl Iterator<Item = [Twist; 3]> {
        self.strains.chunks_exact(3 * ratio).map(move |of| {
            let middle = if ratio == 1 { of[1] } else { of[3 * (ratio / 2)] };
            [of[0], middle, of[3 * ratio - 1]]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_steps(steps: usize) -> InternalState {
        let strains = (0..3 * steps)
            .map(|i| Twist { linear: Vec3::X * i as f64, angular: Vec3::ZERO })
            .collect();
        let nodes = vec![NodeState::default(); steps + 1];
        InternalState { nodes, strains, ..InternalState::default() }
    }

    #[test]
    fn a_grid_whose_steps_are_halved_into_these_finds_its_nodes() {
        let of = |own: usize, steps: usize| with_steps(own).own_steps_per_step(steps);
        assert_eq!(of(18, 18), Some(1));
        assert_eq!(of(18, 9), Some(2));
        assert_eq!(of(36, 9), Some(4));
        assert_eq!(of(27, 9), None);
        assert_eq!(of(19, 9), None);
        assert_eq!(of(9, 18), None);
        assert_eq!(of(9, 0), None);
        assert_eq!(InternalState::default().own_steps_per_step(9), None);
    }

    #[test]
    fn a_step_has_the_strains_at_its_start_its_middle_and_its_end() {
        let of = |ratio: usize| -> Vec<[f64; 3]> {
            let steps = with_steps(4);
            let of_steps = steps.strains_of_steps(ratio);
            of_steps.map(|at| at.map(|strain| strain.linear.x)).collect()
        };
        assert_eq!(of(1)[1], [3.0, 4.0, 5.0]);
        // The middle of two is where the second begins.
        assert_eq!(of(2), [[0.0, 3.0, 5.0], [6.0, 9.0, 11.0]]);
        assert_eq!(of(4), [[0.0, 6.0, 11.0]]);
    }
}
