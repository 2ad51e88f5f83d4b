//! Points that two cameras see: eq. (s1) to (s5) of `docs/theory/cameras.md`.

mod error;
mod matching;
mod point;

pub use error::TriangulateError;
pub use matching::{MatchError, Matched, match_in_order};
pub use point::{Triangulated, triangulate};
