//! What to write instead of a key of another name, as a sentence.

use crate::check::given_text;
use crate::node::Entry;
use crate::units::scaled;

/// What to write instead of a key of another name.
#[derive(Clone, Copy, Debug)]
pub(super) enum Remedy {
    /// This key, with the same value.
    Key(&'static str),
    /// This key, with twice the value: a diameter for a radius.
    Twice(&'static str),
    /// This key, with half of the value.
    Half(&'static str),
    /// What a sentence says.
    Say(&'static str),
}

impl Remedy {
    /// The key that is meant.
    pub(super) const fn key(self) -> Option<&'static str> {
        match self {
            Self::Key(key) | Self::Twice(key) | Self::Half(key) => Some(key),
            Self::Say(_) => None,
        }
    }

    /// As a sentence, for a key with this value.
    pub(super) fn sentence(self, entry: &Entry) -> String {
        let with = |key: &str, factor: f64, what: &str| {
            let value = given_text(&entry.node).and_then(|text| scaled(&text, factor));
            match value {
                Some(value) => format!("write `{key} = {value}`, {what} this value"),
                None => format!("write `{key}`, {what} this value"),
            }
        };
        match self {
            Self::Key(key) => format!("did you mean `{key}`?"),
            Self::Twice(key) => with(key, 2.0, "twice"),
            Self::Half(key) => with(key, 0.5, "half"),
            Self::Say(sentence) => sentence.to_owned(),
        }
    }
}
