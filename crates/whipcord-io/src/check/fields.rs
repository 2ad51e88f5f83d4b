//! What a checked table holds: values of the declared kinds, by their keys.

use std::collections::BTreeMap;

use crate::units::Dimension;

/// A value of the declared kind.
#[derive(Clone, Debug)]
pub(crate) enum Data {
    Text(String),
    Flag(bool),
    Count(usize),
    /// In SI.
    Number(f64, Dimension),
    List(Vec<Data>),
    Tables(Vec<Fields>),
    Table(Fields),
}

/// The values of a table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fields {
    pub(super) values: BTreeMap<&'static str, Data>,
    /// Which of several variants the table is.
    pub variant: &'static str,
}

impl Fields {
    pub(crate) fn text(&self, name: &str) -> Option<&str> {
        self.values.get(name)?.as_text()
    }

    /// False when it is not given.
    pub(crate) fn flag(&self, name: &str) -> bool {
        matches!(self.values.get(name), Some(Data::Flag(true)))
    }

    /// None when it is not given.
    pub(crate) fn truth(&self, name: &str) -> Option<bool> {
        match self.values.get(name)? {
            Data::Flag(flag) => Some(*flag),
            _ => None,
        }
    }

    pub(crate) fn count(&self, name: &str) -> Option<usize> {
        match self.values.get(name)? {
            Data::Count(count) => Some(*count),
            _ => None,
        }
    }

    pub(crate) fn number(&self, name: &str) -> Option<f64> {
        self.quantity(name).map(|(value, _)| value)
    }

    pub(crate) fn quantity(&self, name: &str) -> Option<(f64, Dimension)> {
        self.values.get(name)?.as_quantity()
    }

    pub(crate) fn data(&self, name: &str) -> Option<&Data> {
        self.values.get(name)
    }

    pub(crate) fn list(&self, name: &str) -> Option<&[Data]> {
        match self.values.get(name)? {
            Data::List(list) => Some(list),
            _ => None,
        }
    }

    pub(crate) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.list(name)?.iter().filter_map(Data::as_number).collect())
    }

    /// A vector of a declared number of components.
    pub(crate) fn vector<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        self.numbers(name)?.try_into().ok()
    }

    pub(crate) fn table(&self, name: &str) -> Option<&Self> {
        match self.values.get(name)? {
            Data::Table(fields) => Some(fields),
            _ => None,
        }
    }

    /// None when it is not given.
    pub(crate) fn tables(&self, name: &str) -> &[Self] {
        match self.values.get(name) {
            Some(Data::Tables(list)) => list,
            _ => &[],
        }
    }
}

impl Data {
    pub(crate) fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(crate) fn as_number(&self) -> Option<f64> {
        self.as_quantity().map(|(value, _)| value)
    }

    pub(crate) fn as_quantity(&self) -> Option<(f64, Dimension)> {
        match self {
            Self::Number(value, dimension) => Some((*value, *dimension)),
            _ => None,
        }
    }

    pub(crate) fn as_count(&self) -> Option<usize> {
        match self {
            Self::Count(count) => Some(*count),
            _ => None,
        }
    }

    pub(crate) fn as_list(&self) -> Option<&[Self]> {
        match self {
            Self::List(list) => Some(list),
            _ => None,
        }
    }
}
