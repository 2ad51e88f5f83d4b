//! What page and server say to each other: one JSON object in each text message of a WebSocket, everything in SI.
//!
//! The page sends [`FromPage`], the server [`ToPage`]. `page/src/protocol.ts` has the same types; `page/src/samples.ts`
//! holds an example of each as it is written here, and TypeScript's compiler holds it against those.
//!
//! Positions are in the world frame, in which the file gives the pose of the base; quaternions are (w, x, y, z).

mod answer;
mod common;
mod course;
mod design;
mod inverse;
mod loads;
mod measured;
mod obstacle;
mod request;
mod shown;

use serde::{Deserialize, Serialize};
use whipcord::{ModelKind, ModelPreset};

pub use answer::{Answer, CableState, Compliance, Contact, Grasp, PlacedObject, Solved};
pub use common::{Pose, Warning};
pub use course::{Acting, Course, CourseChoice, Moment, PlayRequest, Track};
pub use design::{DesignRequest, Designed};
pub use inverse::{Cloud, MetLimit, Reach};
pub use loads::{Load, Pull};
pub use measured::{Camera, Lens, Marker, Sight};
pub use obstacle::{Form, Obstacle};
pub use request::{Command, Malformed, Request, Slider};
pub use shown::Shown;

/// Most bytes of a message from the page. The longest that says anything has a command for each of a thousand cables.
pub const MOST_BYTES: usize = 64 * 1024;

/// The greatest integer that JavaScript counts to without gaps.
const MOST_ID: u64 = (1 << 53) - 1;

/// What the page sends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum FromPage {
    /// To solve what the sliders say. A request that comes before an earlier one is begun replaces it.
    Solve(Request),
    /// To survey where the tip can go, by the first model of the request and under its loads, beside all other requests. It replaces
    /// a survey that goes on.
    Survey(Request),
    /// To end a survey that goes on.
    EndSurvey,
    /// To solve a course of the file, beside all other requests. It replaces a course that goes on.
    Play(PlayRequest),
    /// To end a course that goes on.
    EndPlay,
    /// To look for holes, beside all other requests. It replaces a search that goes on.
    Design(DesignRequest),
    /// To end a search for holes.
    EndDesign,
}

/// What the server sends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ToPage {
    /// The robot and the case of the file: the first message, and again whenever the file changes.
    Scene(Box<Scene>),
    /// Another robot that is shown beside that of the file, by its number from 1 on.
    Beside {
        /// Its number.
        number: usize,
        /// The robot.
        scene: Box<Scene>,
        /// What the first model that takes it says of its file.
        answer: Answer,
    },
    /// What a program shows.
    Shown(Shown),
    /// The file cannot be used as it now is.
    Broken {
        /// What is wrong with it, with the place, as the command line prints it.
        message: String,
    },
    /// The answer to a request.
    Frame(Frame),
    /// Where the tip can go.
    Cloud(Cloud),
    /// A part of a course.
    Track(Track),
    /// A survey that has no answer.
    NoCloud {
        /// Number of its request.
        id: u64,
        /// Why.
        message: String,
    },
    /// Holes that were looked for.
    Designed(Designed),
    /// A search for holes that found none.
    NoDesign {
        /// Number of its request.
        id: u64,
        /// Why.
        message: String,
    },
    /// A message from the page that means nothing.
    Error {
        /// Why.
        message: String,
    },
}

/// A robot, its surroundings and what the file asks of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Title of the file.
    pub title: String,
    /// Name of the file.
    pub file: String,
    /// Version of whipcord.
    pub version: String,
    /// Length of the backbone in m.
    pub length: f64,
    /// Arc lengths in m at which frames give the shape.
    pub stations: Vec<f64>,
    /// Cross-section of the backbone.
    pub section: Section,
    /// The disks, from the base on.
    pub disks: Vec<Disk>,
    /// The cables.
    pub cables: Vec<Cable>,
    /// The motors.
    pub motors: Vec<Motor>,
    /// What can be moved: the motors that the file commands, and the cables that none of them pulls.
    pub sliders: Vec<Slider>,
    /// Where the base is.
    pub base: Pose,
    /// All models.
    pub models: Vec<ModelChoice>,
    /// What the file asks for.
    pub initial: Request,
    /// How far the sliders reach.
    pub ranges: Ranges,
    /// Whether tip force, tip moment and gravity are those of the frame of the base, in contrast to the world's.
    pub loads_in_base: bool,
    /// Whether tip force and tip moment are those of the frame of the tip instead, and turn with it.
    pub tip_follower: bool,
    /// What loads the file has that no slider moves.
    pub loads: Vec<Load>,
    /// The same in words.
    pub other_loads: Vec<String>,
    /// What can be played.
    pub courses: Vec<CourseChoice>,
    /// Where the real robot's disks and markers were measured, in each step.
    pub measured: Vec<Vec<Marker>>,
    /// The cameras that saw it.
    pub cameras: Vec<Camera>,
    /// What stands in the robot's way.
    pub obstacles: Vec<Obstacle>,
    /// Warnings about the file.
    pub warnings: Vec<Warning>,
}

/// A cross-section at each station; lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Section {
    /// Not known.
    Unknown,
    /// A rod or a tube.
    Round {
        /// Outer diameters.
        outer: Vec<f64>,
        /// Inner diameters.
        inner: Vec<f64>,
    },
    /// A bar.
    Rectangle {
        /// Extents along x.
        width: Vec<f64>,
        /// Extents along y.
        height: Vec<f64>,
    },
}

/// A disk; lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Disk {
    /// Which of the stations it sits at.
    pub station: usize,
    /// Of its rim.
    pub radius: f64,
    /// From face to face.
    pub thickness: f64,
    /// Centres of the holes in its plane.
    pub holes: Vec<[f64; 2]>,
    /// Radius of the holes, as they are drawn.
    pub hole_radius: f64,
}

/// A cable and where it runs in the cross-sections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cable {
    /// Its name.
    pub name: String,
    /// Where it runs at each station, from the first to the one it is anchored at: (x, y) in m.
    pub course: Vec<[f64; 2]>,
    /// The holes that it goes through from the base on, from 1, where it goes through holes.
    pub holes: Option<Vec<usize>>,
    /// Its length in m before actuation.
    pub initial_length: f64,
}

/// A motor of the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motor {
    /// Its name.
    pub name: String,
    /// Whether its command is an angle in rad and it holds a torque in N·m, in contrast to a travel in m and a force in N.
    pub is_angular: bool,
    /// From where to where its slider reaches.
    pub reach: [f64; 2],
    /// The cables that it pulls, and what it holds for a tension of 1 N in each: what all tensions make of it is the sum.
    pub pulls: Vec<(usize, f64)>,
    /// The most that it can hold.
    pub limit: Option<f64>,
}

/// A model, and whether it can be chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelChoice {
    /// Its name.
    pub name: String,
    /// Whether its cables run straight from disk to disk.
    pub hole_to_hole: bool,
    /// Whether it bends at joints alone: its strains mean something from disk to disk only.
    pub jointed: bool,
    /// Why it does not take this robot.
    pub refusal: Option<String>,
}

/// How far sliders reach; each from the negative to the positive, tensions from zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ranges {
    /// In N.
    pub tension: f64,
    /// In m.
    pub shortening: f64,
    /// In N.
    pub force: f64,
    /// In N·m.
    pub moment: f64,
    /// In m/s².
    pub gravity: f64,
}

/// The answer to a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Number of the request.
    pub id: u64,
    /// Time in s from the arrival of the request to the end of the last solve.
    pub time: f64,
    /// What each model says, in the order of the request.
    pub answers: Vec<Answer>,
    /// Commands for the place of the request, where it has one.
    pub reach: Option<Reach>,
    /// The cables with the holes of the request, where these are others than those of the file.
    pub cables: Option<Vec<Cable>>,
}

/// Reads a message from the page.
///
/// # Errors
/// [`Malformed`] with what is wrong. Numbers that no robot takes are left to the models to refuse.
pub fn read(text: &str) -> Result<FromPage, Malformed> {
    let message: FromPage =
        serde_json::from_str(text).map_err(|error| Malformed::Json(error.to_string()))?;
    let (FromPage::Solve(request)
    | FromPage::Survey(request)
    | FromPage::Play(PlayRequest { request, .. })
    | FromPage::Design(DesignRequest { request, .. })) = &message
    else {
        return Ok(message);
    };
    if request.id > MOST_ID {
        return Err(Malformed::Id(request.id));
    }
    let all = ModelPreset::of(&ModelKind::ALL).len();
    if request.models.len() > all {
        return Err(Malformed::Models { given: request.models.len(), all });
    }
    request.presets()?;
    Ok(message)
}

impl Ranges {
    /// From where to where the slider of a cable reaches that is told so.
    #[must_use]
    pub fn reach(&self, command: Command) -> [f64; 2] {
        match command {
            Command::Tension(_) => [0.0, self.tension],
            Command::Shortening(_) | Command::Motor(_) => [-self.shortening, self.shortening],
        }
    }
}

impl Scene {
    /// From where to where a slider reaches, at what the file has.
    #[must_use]
    pub fn reach(&self, slider: usize) -> [f64; 2] {
        let command = self.initial.commands[slider];
        match self.sliders[slider] {
            Slider::Cable(_) => self.ranges.reach(command),
            Slider::Motor(motor) => self.motors[motor].reach,
        }
    }
}
