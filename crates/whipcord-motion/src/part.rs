//! Parts that steps are divided into, as they were taken.

use crate::contact::Contact;
use crate::state::State;
use crate::surroundings::Hit;

/// A part of a step that was taken.
#[derive(Debug)]
pub(crate) struct Taken<'a> {
    pub before: &'a State,
    /// In s.
    pub length: f64,
    /// Whether its iteration began with a prediction.
    pub is_warm: bool,
    /// Whether it is, or its impact was looked for in, all that was left up to the next jump or the end of the step.
    pub is_rest: bool,
    /// Whether its contacts were without friction.
    pub is_frictionless: bool,
    pub impact: Option<Impact>,
}

/// A part that ends in an impact.
#[derive(Clone, Debug)]
pub(crate) struct Impact {
    /// Length in s of the part that was tried, in which the obstacle was hit.
    pub tried: f64,
    pub end: ImpactEnd,
}

/// How the length of a part that ends in an impact follows.
#[derive(Clone, Debug)]
pub(crate) enum ImpactEnd {
    /// It is this part of the length that was tried.
    Fraction(f64),
    /// It is the part of what was tried in which the robot gets to the obstacle.
    Hit(Hit),
    /// A contact closes by then if its gap goes on to close as fast as at the start.
    Closing(Box<Contact>),
}
