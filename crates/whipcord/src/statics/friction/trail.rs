//! The ends of the substeps, as derivatives take them.

use crate::statics::command::Command;

/// Where the substeps of a robot's steps ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trail<S> {
    pub ends: Vec<SubstepEnd<S>>,
    /// The first end of every step.
    pub steps: Vec<usize>,
    /// Whether there is no equilibrium to be found where a hole came to rest.
    pub is_broken: bool,
}

/// Where a substep ended, or where holes came to rest within it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SubstepEnd<S> {
    pub shape: S,
    pub standing: Standing,
    /// The passages whose near holes came to rest here, where this is within a substep.
    pub stops: Option<Vec<usize>>,
}

/// What happens at an event, so that the rates of all holes change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trigger {
    /// A cable begins to slide in a hole, with the sign of the exponent of eq. (1).
    Slides { cable: usize, place: usize, sign: f64 },
    /// A cable of given length goes slack.
    Slack { cable: usize },
    /// It becomes taut.
    Taut { cable: usize },
}

/// How the cables stand in their holes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Standing {
    /// Tension of every passage in N, and the angle in its near hole in rad.
    pub tensions: Vec<f64>,
    pub turns: Vec<f64>,
    /// By passage the sign of the exponent of eq. (1): −1 where the cable slides towards the base, 1 where it slides towards the
    /// tip. `None` where it sticks.
    pub slides: Vec<Option<f64>>,
    /// Tension below the base disk, by cable.
    pub base: Vec<f64>,
    pub commands: Vec<Command>,
    /// How far the commands went from those before the substep to those of the step.
    pub fraction: f64,
    /// What decides when the commands are here, if it is not they, and how the commands of the cables change with their fraction.
    pub trigger: Option<Trigger>,
    pub rates: Vec<f64>,
    /// Whether a cable is about to stick in a hole, or to slide.
    pub is_about_to_change: bool,
}

impl Standing {
    /// Whether a cable sticks in a hole, which keeps what it had before.
    pub fn sticks(&self) -> bool {
        self.slides.contains(&None)
    }
}

impl<S> Trail<S> {
    /// Whether this end is the first of a step.
    pub fn starts_step(&self, end: usize) -> bool {
        self.steps.binary_search(&end).is_ok()
    }
}

impl<S> Default for Trail<S> {
    fn default() -> Self {
        Self { ends: Vec::new(), steps: Vec::new(), is_broken: false }
    }
}
