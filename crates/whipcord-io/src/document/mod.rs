//! Robot files from within a program: what a file says as a tree of values, the text of one, and a table
//! of one in SI.

mod check;
mod describe;
mod design;
mod fitted;
mod goal;
mod motion;
mod motor;
mod obstacle;
mod text;
mod unknowns;

pub use check::table_in_si;
pub use describe::{Inexpressible, describe};
pub use fitted::{FittedFile, Mounting};
pub use goal::describe_goal;
pub use motion::describe_motion;
pub use text::toml;
pub use unknowns::describe_fit;

use serde_json::Value;

/// A value of a robot file.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A text, or a quantity with its unit.
    Text(String),
    /// A whole number.
    Integer(i64),
    /// A number, in SI where it is a quantity.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A list; a list of tables is written with a header for each.
    List(Vec<Item>),
    /// A table.
    Table(Table),
}

impl Item {
    fn to_json(&self) -> Value {
        match self {
            Self::Text(text) => text.as_str().into(),
            Self::Integer(number) => (*number).into(),
            Self::Number(number) => (*number).into(),
            Self::Flag(flag) => (*flag).into(),
            Self::List(items) => items.iter().map(Self::to_json).collect(),
            Self::Table(table) => table.to_json(),
        }
    }
}

/// Keys and their values, in the order in which they are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The entries.
    pub entries: Vec<(String, Item)>,
}

impl Table {
    /// Adds an entry.
    pub fn insert(&mut self, key: &str, item: impl Into<Item>) {
        self.entries.push((key.to_owned(), item.into()));
    }

    /// Adds an entry where there is something to add.
    pub fn insert_some(&mut self, key: &str, item: Option<impl Into<Item>>) {
        if let Some(item) = item {
            self.insert(key, item);
        }
    }

    /// Whether it has no entries.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The table as JSON.
    #[must_use]
    pub fn to_json(&self) -> Value {
        self.entries.iter().map(|(key, item)| (key.clone(), item.to_json())).collect()
    }

    /// The value of a key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Item> {
        self.entries.iter().find(|(name, _)| name == key).map(|(_, item)| item)
    }
}

impl From<f64> for Item {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<bool> for Item {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

impl From<&str> for Item {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<Table> for Item {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl From<usize> for Item {
    fn from(value: usize) -> Self {
        // The readers refuse counts that are far smaller.
        Self::Integer(i64::try_from(value).unwrap_or(i64::MAX))
    }
}

impl<T: Into<Self>> From<Vec<T>> for Item {
    fn from(values: Vec<T>) -> Self {
        Self::List(values.into_iter().map(Into::into).collect())
    }
}

impl<T: Into<Self>, const N: usize> From<[T; N]> for Item {
    fn from(values: [T; N]) -> Self {
        Self::List(values.into_iter().map(Into::into).collect())
    }
}

impl From<whipcord::Vec3> for Item {
    fn from(vector: whipcord::Vec3) -> Self {
        vector.to_array().into()
    }
}
