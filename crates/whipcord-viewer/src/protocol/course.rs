//! What goes on in steps or over time.

use serde::{Deserialize, Serialize};

use crate::protocol::answer::Answer;
use crate::protocol::loads::Load;
use crate::protocol::request::Request;

/// What can be played.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Course {
    /// The steps of the file.
    Steps,
    /// The motion of `[motion]`.
    Motion,
}

/// A course that the file has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CourseChoice {
    /// Which.
    pub course: Course,
    /// How many shapes it has.
    pub count: usize,
    /// From its start to its end in s; none of steps, which have no times.
    pub duration: Option<f64>,
}

/// To play a course.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlayRequest {
    /// Which.
    pub course: Course,
    /// What the sliders say, and which models are to answer.
    pub request: Request,
}

/// A part of a course.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Number of the request.
    pub id: u64,
    /// Which course.
    pub course: Course,
    /// Number of the first of these shapes in the course.
    pub from: usize,
    /// The shapes.
    pub moments: Vec<Moment>,
    /// Whether these are the last.
    pub complete: bool,
    /// Why the course ends before its end.
    pub message: Option<String>,
}

/// A shape of a course.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Time in s; of steps their number from 0.
    pub time: f64,
    /// What each model says.
    pub answers: Vec<Answer>,
    /// What acts on the robot; none where that is the same as at the shape before.
    pub acting: Option<Acting>,
}

/// All loads at one time, in the frame of the loads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Acting {
    /// Force at the tip in N; in the frame of the tip if it turns with it.
    pub tip_force: [f64; 3],
    /// Moment at the tip in N·m; in the frame of the tip if it turns with it.
    pub tip_moment: [f64; 3],
    /// Whether force and moment turn with the tip.
    pub tip_follower: bool,
    /// Acceleration of gravity in m/s².
    pub gravity: [f64; 3],
    /// All others.
    pub loads: Vec<Load>,
}
