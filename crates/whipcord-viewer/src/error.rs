use std::io;

use thiserror::Error;
use whipcord_io::FileError;

/// Why there is nothing to view.
#[derive(Debug, Error)]
pub enum ViewError {
    /// The binary was built without the page.
    #[error(
        "this whipcord was built without the page of its viewer: install Node 20.19 or later with npm, and build or install whipcord again"
    )]
    NoPage,
    /// The page that the binary was built with is not one that can be exported.
    #[error(
        "the page of the viewer has no `{what}`: build it with `make page`, and whipcord again"
    )]
    OtherPage {
        /// What is missing in it.
        what: &'static str,
    },
    /// The robot file cannot be used.
    #[error(transparent)]
    File(#[from] FileError),
    /// A model that is to be exported does not take the robot.
    #[error("{message}")]
    Refused {
        /// Why.
        message: String,
    },
    /// A page that nobody wants to be sent.
    #[error(
        "the page would have {bytes} bytes, more than {most}: leave models out, or meshes of obstacles"
    )]
    TooLarge {
        /// How many it has.
        bytes: usize,
        /// How many it may have.
        most: usize,
    },
    /// A recording that JSON cannot hold.
    #[error("the frames cannot be written: {0}")]
    Unwritten(#[from] serde_json::Error),
    /// No server can be started.
    #[error("cannot serve the page on port {port} of this machine: {source}")]
    Port {
        /// The port that was asked for; 0 is any.
        port: u16,
        /// What the operating system says.
        source: io::Error,
    },
    /// The server has stopped.
    #[error("the server of the page has stopped: {0}")]
    Server(io::Error),
}
