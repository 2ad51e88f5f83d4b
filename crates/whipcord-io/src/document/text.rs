//! A tree of values as TOML.

use core::fmt::Write as _;

use super::{Item, Table};

/// The text of a robot file with these entries. Read again it gives the same numbers to the last bit.
///
/// ```
/// use whipcord_io::{Table, toml};
/// let mut backbone = Table::default();
/// backbone.insert("length", 0.18);
/// let mut file = Table::default();
/// file.insert("title", "Finger");
/// file.insert("backbone", backbone);
/// assert_eq!(toml(&file), "title = \"Finger\"\n\n[backbone]\nlength = 0.18\n");
/// ```
#[must_use]
pub fn toml(file: &Table) -> String {
    let mut text = String::new();
    table(&mut text, "", file);
    text.trim_start().to_owned()
}

/// Whether a list is written as tables with headers of their own.
fn is_tables(items: &[Item]) -> bool {
    !items.is_empty() && items.iter().all(|item| matches!(item, Item::Table(_)))
}

/// Tables that are written in one line, where they belong to one value.
fn is_inline(key: &str, table: &Table) -> bool {
    const SHORT: usize = 4;
    let plain = |item: &Item| !matches!(item, Item::Table(_) | Item::List(_));
    key == "routing"
        || (table.entries.len() <= SHORT && table.entries.iter().all(|(_, item)| plain(item)))
}

fn table(text: &mut String, path: &str, table: &Table) {
    let mut later = Vec::new();
    for (key, item) in &table.entries {
        match item {
            Item::Table(inner) if path.is_empty() || !is_inline(key, inner) => {
                later.push((key, item))
            }
            Item::List(items) if is_tables(items) => later.push((key, item)),
            _ => {
                *text += &quoted_key(key);
                *text += " = ";
                value(text, item);
                text.push('\n');
            }
        }
    }
    for (key, item) in later {
        let key = quoted_key(key);
        let path = if path.is_empty() { key } else { format!("{path}.{key}") };
        match item {
            Item::Table(inner) => {
                *text += &format!("\n[{path}]\n");
                self::table(text, &path, inner);
            }
            Item::List(items) => {
                for item in items {
                    if let Item::Table(inner) = item {
                        *text += &format!("\n[[{path}]]\n");
                        self::table(text, &path, inner);
                    }
                }
            }
            _ => {}
        }
    }
}

/// A value in one line.
pub(super) fn inline(item: &Item) -> String {
    let mut text = String::new();
    value(&mut text, item);
    text
}

fn value(text: &mut String, item: &Item) {
    match item {
        Item::Text(words) => quoted(text, words),
        Item::Integer(number) => *text += &number.to_string(),
        Item::Number(number) => *text += &decimal(*number),
        Item::Flag(flag) => *text += if *flag { "true" } else { "false" },
        Item::List(items) => {
            text.push('[');
            for (i, item) in items.iter().enumerate() {
                if i > 0 {
                    *text += ", ";
                }
                value(text, item);
            }
            text.push(']');
        }
        Item::Table(table) => {
            *text += "{ ";
            for (i, (key, item)) in table.entries.iter().enumerate() {
                if i > 0 {
                    *text += ", ";
                }
                *text += &quoted_key(key);
                *text += " = ";
                value(text, item);
            }
            *text += " }";
        }
    }
}

/// The shortest digits that are read as the same number.
fn decimal(number: f64) -> String {
    if number.is_nan() {
        return "nan".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { "inf".to_owned() } else { "-inf".to_owned() };
    }
    // `{:?}` has the point or the exponent that TOML tells numbers from whole numbers by.
    format!("{number:?}")
}

fn quoted_key(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(bare) {
        return key.to_owned();
    }
    let mut text = String::new();
    quoted(&mut text, key);
    text
}

fn quoted(text: &mut String, words: &str) {
    text.push('"');
    for c in words.chars() {
        match c {
            '"' => *text += "\\\"",
            '\\' => *text += "\\\\",
            '\n' => *text += "\\n",
            '\t' => *text += "\\t",
            '\r' => *text += "\\r",
            c if c.is_control() => {
                // Writing to a string does not fail.
                let _ = write!(text, "\\u{:04X}", u32::from(c));
            }
            c => text.push(c),
        }
    }
    text.push('"');
}
