//! One file's tables laid over another's.

use crate::error::{FileProblem, Problems};
use crate::node::{Entries, Entry, Node, Value};
use crate::schema::{Kind, Table};
use crate::source::quoted;

/// The key that takes a table out of the file below: the table itself, or the entry of the same name of a list.
const REMOVE: &str = "remove";

/// The key by which entries of a list are found in another file.
const NAME: &str = "name";

/// Most entries that a message names.
const MOST_NAMED: usize = 8;

/// Lays the upper entries over the lower ones: tables are merged key by key, lists of tables that have names by name, anything
/// else, and a table that says which kind it is, replaces what lies below. A key also replaces its rivals: `diameters` above, `diameter` below.
pub(crate) fn overlay(
    upper: &mut Entries,
    mut lower: Entries,
    table: Option<&Table>,
    problems: &mut Problems,
) {
    if let Some(table) = table {
        for name in upper.keys() {
            for rival in table.rivals(name) {
                // Rivals within one file are for the checks to refuse.
                lower.remove(rival);
            }
        }
    }
    for (name, mut below) in lower {
        let Some(above) = upper.get_mut(&name) else {
            upper.insert(name, below);
            continue;
        };
        let kind = table.and_then(|table| table.key(&name)).map(|key| &key.kind);
        if removes_table(&above.node, kind) {
            upper.remove(&name);
            continue;
        }
        match (&mut above.node.value, &mut below.node.value) {
            // Another kind has other keys.
            (Value::Table(up), _) if matches!(kind, Some(Kind::Variants { tag, .. }) if up.contains_key(tag.name)) =>
                {}
            (Value::Table(up), Value::Table(low)) => {
                let inner = match kind {
                    Some(Kind::Table(inner)) => Some(*inner),
                    _ => None,
                };
                overlay(up, core::mem::take(low), inner, problems);
            }
            (Value::List(up), Value::List(low)) => {
                if let Some(Kind::Tables(inner)) = kind
                    && let Some(what) = inner.merged_by_name()
                    && !up.is_empty()
                {
                    let (added, below) = (core::mem::take(up), core::mem::take(low));
                    *up = merge(added, below, inner, what, problems);
                }
            }
            _ => {}
        }
    }
}

/// Takes out the tables and entries that are marked so.
pub(crate) fn take_out(entries: &mut Entries, table: &Table) {
    entries.retain(|name, entry| !removes_table(&entry.node, table.key(name).map(|key| &key.kind)));
    for (name, entry) in entries.iter_mut() {
        if let Some(Kind::Tables(inner)) = table.key(name).map(|key| &key.kind)
            && let Value::List(items) = &mut entry.node.value
            && inner.merged_by_name().is_some()
        {
            items.retain(|item| !removes(item));
        }
    }
}

/// Refuses tables that are to be removed and entries that are to be removed from a list, where there are none below.
pub(crate) fn refuse_removals(entries: &mut Entries, table: &Table, problems: &mut Problems) {
    for (name, entry) in entries.iter_mut() {
        let kind = table.key(name).map(|key| &key.kind);
        if let Some(Kind::Table(inner)) = kind
            && removes_table(&entry.node, kind)
        {
            problems.push(entry.node.span, || FileProblem::NoTableToRemove { table: inner.title });
        }
        let Some(Kind::Tables(inner)) = kind else { continue };
        let (Some(what), Value::List(items)) = (inner.merged_by_name(), &mut entry.node.value)
        else {
            continue;
        };
        for item in items.iter().filter(|item| removes(item)) {
            let name = quoted(&text(item, NAME).unwrap_or_default());
            problems.push(item.span, || FileProblem::NothingToRemove {
                what,
                name,
                names: Vec::new(),
            });
        }
    }
    take_out(entries, table);
}

/// Whether a table of a kind that can be removed is marked so.
fn removes_table(node: &Node, kind: Option<&Kind>) -> bool {
    matches!(kind, Some(Kind::Table(inner)) if inner.key(REMOVE).is_some()) && removes(node)
}

fn removes(item: &Node) -> bool {
    matches!(item.find(REMOVE).map(|of| &of.value), Some(Value::Flag(true)))
}

/// The entries of the lower list, each with what the upper one says of its name, and behind them those of new names.
fn merge(
    upper: Vec<Node>,
    lower: Vec<Node>,
    table: &Table,
    what: &'static str,
    problems: &mut Problems,
) -> Vec<Node> {
    let mut merged: Vec<Node> =
        lower.into_iter().enumerate().map(|(i, item)| with_name(item, what, i)).collect();
    // Those that a name of the upper list stands for no longer, so that a name given twice there is not merged twice.
    let mut open: Vec<String> = merged.iter().filter_map(|item| text(item, NAME)).collect();
    let mut given: Vec<String> = Vec::new();
    let of_lower: Vec<String> = open.iter().take(MOST_NAMED).cloned().collect();
    for mut item in upper {
        let Some(name) = text(&item, NAME) else {
            // What is no table is for the checks to refuse.
            if matches!(item.value, Value::Table(_)) && !merged.is_empty() && !item.has(NAME) {
                problems.push(item.span, || FileProblem::NoNameToMerge {
                    what,
                    table: table.title,
                    names: of_lower.clone(),
                });
            } else {
                merged.push(item);
            }
            continue;
        };
        if of_lower.contains(&name) && given.contains(&name) {
            problems.push(item.span, || FileProblem::GivenTwice { what, name: quoted(&name) });
            continue;
        }
        given.push(name.clone());
        let found = open.iter().position(|of| *of == name).map(|k| open.remove(k));
        let place = found.and_then(|name| {
            merged.iter().position(|below| text(below, NAME).as_ref() == Some(&name))
        });
        match place {
            Some(place) if removes(&item) => _ = merged.remove(place),
            Some(place) => {
                let below = &mut merged[place];
                if let (Some(up), Some(low)) = (item.entries_mut(), below.entries_mut()) {
                    overlay(up, core::mem::take(low), Some(table), problems);
                    core::mem::swap(up, low);
                }
            }
            None if removes(&item) => problems.push(item.span, || FileProblem::NothingToRemove {
                what,
                name: quoted(&name),
                names: of_lower.clone(),
            }),
            None => merged.push(item),
        }
    }
    merged
}

/// An entry with a name: the one that it has by its place where it is given none.
fn with_name(mut item: Node, what: &str, index: usize) -> Node {
    let span = item.span;
    if let Value::Table(entries) = &mut item.value
        && !entries.contains_key(NAME)
    {
        let node = Node { span, value: Value::Text(default_name(what, index)) };
        entries.insert(NAME.to_owned(), Entry { key_span: span, node });
    }
    item
}

/// What the cable or motor of this number, from 0, is called where the file does not say.
pub(crate) fn default_name(what: &str, index: usize) -> String {
    format!("{what}-{}", index + 1)
}

fn text(item: &Node, key: &str) -> Option<String> {
    match &item.find(key)?.value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    }
}

impl Node {
    pub(crate) fn entries_mut(&mut self) -> Option<&mut Entries> {
        match &mut self.value {
            Value::Table(entries) => Some(entries),
            _ => None,
        }
    }
}
