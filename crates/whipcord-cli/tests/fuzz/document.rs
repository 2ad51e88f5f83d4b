//! A robot file as a tree, so that what is changed in it is still TOML.

use toml::de::{DeTable, DeValue};

use crate::random::Random;
use crate::text;

#[derive(Clone, Debug)]
pub enum Item {
    Text(String),
    /// A number, truth value or date as it is written.
    Bare(String),
    List(Vec<Item>),
    Table(Vec<(String, Item)>),
}

impl Item {
    /// The tree of a file that is right.
    pub fn parse(text: &str) -> Option<Self> {
        Some(table(&DeTable::parse(text).ok()?.into_inner()))
    }

    /// As TOML: each key of the root on a line of its own.
    pub fn write(&self) -> String {
        let Self::Table(entries) = self else { return self.inline() };
        entries.iter().map(|(key, item)| format!("{} = {}\n", quoted(key), item.inline())).collect()
    }

    fn inline(&self) -> String {
        let joined = |parts: Vec<String>| parts.join(", ");
        match self {
            Self::Text(text) => quoted(text),
            Self::Bare(text) => text.clone(),
            Self::List(items) => format!("[{}]", joined(items.iter().map(Self::inline).collect())),
            Self::Table(entries) => {
                let entry =
                    |(key, item): &(String, Self)| format!("{} = {}", quoted(key), item.inline());
                format!("{{ {} }}", joined(entries.iter().map(entry).collect()))
            }
        }
    }

    /// The items within it, itself the first.
    fn count(&self) -> usize {
        1 + match self {
            Self::List(items) => items.iter().map(Self::count).sum(),
            Self::Table(entries) => entries.iter().map(|(_, item)| item.count()).sum(),
            _ => 0,
        }
    }

    /// One of the items within it by its number.
    fn at(&mut self, number: usize) -> Option<&mut Self> {
        if number == 0 {
            return Some(self);
        }
        let mut rest = number - 1;
        let items: Vec<&mut Self> = match self {
            Self::List(items) => items.iter_mut().collect(),
            Self::Table(entries) => entries.iter_mut().map(|(_, item)| item).collect(),
            _ => Vec::new(),
        };
        for item in items {
            let count = item.count();
            if rest < count {
                return item.at(rest);
            }
            rest -= count;
        }
        None
    }

    /// Changes a value, or what a list or table is made of; where `mild`, to what may be right as well.
    pub fn mutate(&mut self, others: &[Self], mild: bool, random: &mut Random) {
        let number = random.below(self.count());
        let Some(item) = self.at(number) else { return };
        match item {
            Self::Bare(old) => *old = bare(old, mild, random),
            Self::Text(old) => match random.below(if mild { 2 } else { 4 }) {
                0 | 1 => *old = text::numbers(old, mild, random),
                2 => *item = Self::Bare(text::number("1", false, random)),
                _ => {
                    let texts = ["", "5 %", "1e9 GPa", "-2 N", "90 deg", "3 kg/m^3", "nan mm", "é"];
                    (*random.pick(&texts)).clone_into(old);
                }
            },
            Self::List(items) if !items.is_empty() => {
                let (at, times) = (random.below(items.len()), *random.pick(&[1, 1, 2, 30]));
                match random.below(if mild { 20 } else { 3 }) {
                    0 => drop(items.remove(at)),
                    1 => {
                        let copy = items[at].clone();
                        items.splice(at..at, std::iter::repeat_n(copy, times));
                    }
                    2 => items.reverse(),
                    _ => items[at].mutate(others, mild, random),
                }
            }
            Self::Table(entries) if !entries.is_empty() => {
                let at = random.below(entries.len());
                match random.below(if mild { 20 } else { 4 }) {
                    0 if number > 0 || !mild => drop(entries.remove(at)),
                    1 => {
                        // A part of another file in place of, or beside, what is there.
                        let other = random.below(others.len());
                        if let Some(Self::Table(from)) = others.get(other)
                            && !from.is_empty()
                        {
                            let (key, value) = random.pick(from).clone();
                            entries.retain(|(name, _)| *name != key);
                            entries.push((key, value));
                        }
                    }
                    2 if !mild => entries[at].0 += *random.pick(&["x", "", "_", ".a"]),
                    _ => entries[at].1.mutate(others, mild, random),
                }
            }
            _ => *item = Self::Bare("1".to_owned()),
        }
    }
}

fn bare(old: &str, mild: bool, random: &mut Random) -> String {
    match old {
        "true" => "false".to_owned(),
        "false" => "true".to_owned(),
        _ => text::number(old, mild, random),
    }
}

fn table(table: &DeTable<'_>) -> Item {
    let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
        let key: &std::borrow::Cow<'_, str> = key.get_ref();
        (key.to_string(), item(value.get_ref()))
    };
    Item::Table(table.iter().map(entry).collect())
}

fn item(value: &DeValue<'_>) -> Item {
    match value {
        DeValue::String(text) => Item::Text(text.to_string()),
        DeValue::Integer(integer) => Item::Bare(integer.as_str().to_owned()),
        DeValue::Float(float) => Item::Bare(float.as_str().to_owned()),
        DeValue::Boolean(flag) => Item::Bare(flag.to_string()),
        DeValue::Datetime(_) => Item::Bare("1979-05-27".to_owned()),
        DeValue::Array(items) => Item::List(items.iter().map(|i| item(i.get_ref())).collect()),
        DeValue::Table(entries) => table(entries),
    }
}

fn quoted(text: &str) -> String {
    let escape = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", c as u32),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}
