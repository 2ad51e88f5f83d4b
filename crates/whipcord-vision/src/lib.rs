//! Photographs of cable-driven continuum robots.
//!
//! [`detect`] finds disks and markers in a photograph, to a fraction of a pixel and in order from base to tip, or
//! says why it cannot. [`boards`] finds the corners of the boards that cameras are calibrated with. [`render`] makes synthetic photographs whose truth is known, which is how detection is tested.
//! `docs/theory/photographs.md` has the method and its limits.
//!
//! Pixels are (column, row), the centre of the first one at (0, 0), as OpenCV has it. Light is linear inside:
//! [`Photo`] decodes and encodes the sRGB curve. No files here: a photograph comes and goes as bytes.

mod annotate;
pub mod boards;
mod coverage;
pub mod detect;
mod pairing;
mod photo;
mod plane;
mod raster;
pub mod render;

pub use annotate::annotated;
pub use pairing::{LeftOut, NoPoints, PointInSpace, PointsInSpace};
pub use photo::{Photo, PhotoError};
