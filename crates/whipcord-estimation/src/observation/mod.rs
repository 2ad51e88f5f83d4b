//! What was seen of a real robot: where its disks or markers were, in space or in an image; and how far a
//! model is from that, [`distances`] in space and [`overlay`] in an image.

mod distances;
mod order;
mod overlaid;
mod places;
mod seen;

pub use self::distances::{Apart, Distances, Incomparable, distances, in_space, measured_in_world};
pub use self::order::is_reversed;
pub use self::overlaid::{InImage, Overlaid, Rms, in_image, overlay};
pub use self::places::places;
pub use self::seen::{Observation, Place, Seen};
