//! What a robot file may say: one declaration of every table and key, from which the checks, the
//! suggestions and the JSON Schema all follow.

mod backbone_keys;
mod design_keys;
mod goal_keys;
mod json;
mod keys;
mod load_keys;
mod motion_keys;
mod motor_keys;
mod obstacle_keys;

use whipcord::robot::limits::Range;

use crate::units::Dimension;

pub(crate) use design_keys::{DEVIATION, DEVIATION_OF_ANGLE, WEIGHT};
pub(crate) use goal_keys::ANGLE_TOLERANCE;
pub use json::schema;
pub(crate) use keys::{DURATION, ROOT};
pub(crate) use motion_keys::{EITHER_WAY, LENGTH_OF_TIME, LINE_DRAG};

/// Choices of more words are described by an example, and listed in the remedy.
pub(crate) const FEW_CHOICES: usize = 10;

/// A table of the file.
#[derive(Debug)]
pub(crate) struct Table {
    /// How messages name it: `[backbone]`.
    pub title: &'static str,
    pub doc: &'static str,
    pub keys: &'static [Key],
    pub rules: &'static [Rule],
}

/// A key of a table.
#[derive(Debug)]
pub(crate) struct Key {
    pub name: &'static str,
    pub kind: Kind,
    /// A value as it is written in TOML; for a table its header.
    pub example: &'static str,
    pub doc: &'static str,
}

/// What the value of a key may be.
#[derive(Debug)]
pub(crate) enum Kind {
    /// Any text but the empty one.
    Text,
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A whole number within these bounds.
    Count {
        least: usize,
        greatest: usize,
    },
    /// A plain number in SI.
    Number,
    /// A quantity of one of these dimensions; a plain number is of the first, and the library takes
    /// it within this range.
    Quantity(&'static [Dimension], Range),
    /// Exactly this many values.
    Vector(&'static Kind, usize),
    /// One value or more; the library takes no fewer than so many.
    List(&'static Kind, usize),
    /// One of several, told apart by their outward form.
    Either(&'static [Kind]),
    Table(&'static Table),
    /// `[[name]]`, any number of times.
    Tables(&'static Table),
    /// `[[name]]`, any number of times, each a table whose key `tag` says which of these it is.
    TablesOfKinds {
        title: &'static str,
        tag: &'static Key,
        variants: &'static [(&'static str, Table)],
    },
    /// A table whose key `tag` says which of these it is.
    Variants {
        tag: &'static Key,
        variants: &'static [(&'static str, Table)],
    },
}

/// What must hold between the keys of a table.
#[derive(Debug)]
pub(crate) enum Rule {
    Required(&'static str),
    ExactlyOne(&'static [&'static str]),
    AtMostOne(&'static [&'static str]),
    AtLeastOne(&'static [&'static str]),
    /// The first makes sense only with one of the others.
    Needs(&'static str, &'static [&'static str]),
    /// The first, laid over another file, takes the place of the others there; in one file they may stand beside it.
    Replaces(&'static str, &'static [&'static str]),
    /// Entries of the list, laid over those of another file, change those of the same `name`; what such an entry is called.
    MergedByName(&'static str),
}

impl Table {
    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// What an entry of a list of such tables is called, where entries are laid over those of another file by their names.
    pub(crate) fn merged_by_name(&self) -> Option<&'static str> {
        self.rules.iter().find_map(|rule| match rule {
            Rule::MergedByName(what) => Some(*what),
            _ => None,
        })
    }

    /// Keys of another file that this one takes the place of, laid over it.
    pub(crate) fn rivals(&self, name: &str) -> impl Iterator<Item = &'static str> {
        self.rules
            .iter()
            .filter_map(move |rule| match rule {
                Rule::ExactlyOne(names) | Rule::AtMostOne(names) if names.contains(&name) => {
                    Some(*names)
                }
                Rule::Replaces(key, names) if *key == name => Some(*names),
                _ => None,
            })
            .flatten()
            .copied()
            .filter(move |rival| *rival != name)
    }
}

impl Key {
    /// A line that gives the key a value, or the header of its table.
    pub(crate) fn example_line(&self) -> String {
        if self.example.starts_with("[")
            && matches!(self.kind, Kind::Table(_) | Kind::Tables(_) | Kind::TablesOfKinds { .. })
        {
            self.example.to_owned()
        } else {
            format!("{} = {}", self.name, self.example)
        }
    }

    /// How messages name the key: a table by its header.
    pub(crate) fn title(&self) -> String {
        match &self.kind {
            Kind::Table(table) | Kind::Tables(table) if table.title.starts_with('[') => {
                table.title.to_owned()
            }
            Kind::TablesOfKinds { title, .. } => (*title).to_owned(),
            _ => format!("`{}`", self.name),
        }
    }
}

impl Kind {
    /// What messages say that a value must be.
    pub(crate) fn description(&self) -> String {
        match self {
            Self::Choice(words) if words.len() > FEW_CHOICES => "a text".to_owned(),
            Self::Text => "a text".to_owned(),
            Self::Flag => "true or false".to_owned(),
            Self::Choice(words) => crate::units::listed(words.iter().copied(), "or"),
            Self::Count { .. } => "a whole number".to_owned(),
            Self::Number => "a number".to_owned(),
            Self::Quantity(dimensions, _) => {
                let names: Vec<String> =
                    dimensions.iter().map(|d| article(&d.to_string())).collect();
                names.join(" or ")
            }
            Self::Vector(item, count) => {
                format!("a list of {count} values, each {}", item.description())
            }
            Self::List(item, _) => format!("a list of values, each {}", item.description()),
            Self::Either(kinds) => {
                let names: Vec<String> = kinds.iter().map(Self::description).collect();
                names.join(", or ")
            }
            Self::Table(_) | Self::Variants { .. } => "a table".to_owned(),
            Self::Tables(_) | Self::TablesOfKinds { .. } => "a list of tables".to_owned(),
        }
    }
}

/// The name with `a` or `an` before it.
pub(crate) fn article(name: &str) -> String {
    let vowel = name.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {name}", if vowel { "an" } else { "a" })
}
