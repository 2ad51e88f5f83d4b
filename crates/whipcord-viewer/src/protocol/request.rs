//! What the sliders say.

use serde::{Deserialize, Serialize};
use whipcord::ModelPreset;

use crate::holes::Holes;
use crate::protocol::loads::Pull;

/// What the sliders say.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// Number of the request, which the answer carries.
    pub id: u64,
    /// One for each slider ([`super::Scene::sliders`]).
    pub commands: Vec<Command>,
    /// Force at the tip in N.
    pub tip_force: [f64; 3],
    /// Moment at the tip in N·m.
    pub tip_moment: [f64; 3],
    /// Acceleration of gravity in m/s².
    pub gravity: [f64; 3],
    /// Names of the models that are to answer.
    pub models: Vec<String>,
    /// Whether the compliance of the tip is asked for.
    #[serde(default)]
    pub compliance: bool,
    /// A place in m for the tip: commands are sought that bring it there, from those given, and the models answer for these.
    #[serde(default)]
    pub target: Option<[f64; 3]>,
    /// A force at a place of the backbone, beside the loads of the file.
    #[serde(default)]
    pub pull: Option<Pull>,
    /// The holes of each cable from the base on, from 1, in place of those of the file; empty for all of the file.
    #[serde(default)]
    pub holes: Holes,
}

/// What one cable or motor is told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// To pull with this tension in N.
    Tension(f64),
    /// To be shorter by this in m than before actuation.
    Shortening(f64),
    /// To go to this angle in rad, or travel in m: of a motor.
    Motor(f64),
}

/// What a slider moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Slider {
    /// A cable, by its number.
    Cable(usize),
    /// A motor, by its number.
    Motor(usize),
}

/// Why a message from the page means nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Malformed {
    /// It is no JSON of the protocol.
    #[error("this is no message of the viewer: {0}")]
    Json(String),
    /// It is not text.
    #[error("a message of {bytes} bytes is not text")]
    NotText {
        /// Its length.
        bytes: usize,
    },
    /// A number that is none, or that JavaScript cannot hold.
    #[error("the number of the request is {0}, more than 2^53 - 1")]
    Id(u64),
    /// A model that is not known.
    #[error(transparent)]
    Model(#[from] whipcord::kind::UnknownModel),
    /// Too many models.
    #[error("{given} models are asked for, of the {all} that there are")]
    Models {
        /// How many.
        given: usize,
        /// How many there are.
        all: usize,
    },
}

impl Request {
    /// The models that are asked for.
    ///
    /// # Errors
    /// [`Malformed::Model`] for a name of none.
    pub fn presets(&self) -> Result<Vec<ModelPreset>, Malformed> {
        self.models.iter().map(|name| Ok(name.parse::<ModelPreset>()?)).collect()
    }
}

impl Command {
    /// What a cable is told, as robot files have it; nothing by the command of a motor.
    #[must_use]
    pub fn command(self) -> whipcord::CableCommand {
        use whipcord::{CableCommand, Shortening};
        match self {
            Self::Tension(tension) => CableCommand { tension: Some(tension), shortening: None },
            Self::Shortening(length) => {
                CableCommand { tension: None, shortening: Some(Shortening::Length(length)) }
            }
            Self::Motor(_) => CableCommand::default(),
        }
    }

    /// Its number, in N, m or rad.
    #[must_use]
    pub const fn value(self) -> f64 {
        let (Self::Tension(value) | Self::Shortening(value) | Self::Motor(value)) = self;
        value
    }

    /// Another of its kind.
    #[must_use]
    pub const fn with_value(self, value: f64) -> Self {
        match self {
            Self::Tension(_) => Self::Tension(value),
            Self::Shortening(_) => Self::Shortening(value),
            Self::Motor(_) => Self::Motor(value),
        }
    }
}
