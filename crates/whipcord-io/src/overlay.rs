//! One file's tables laid over another's.

use crate::node::{Entries, Node, Value};
use crate::schema::{Kind, Table};

/// Lays the upper entries over the lower ones: tables are merged key by key, anything else
/// replaces what lies below. A key also replaces its rivals: `diameters` above, `diameter` below.
pub(crate) fn overlay(upper: &mut Entries, mut lower: Entries, table: Option<&Table>) {
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
        if let (Value::Table(up), Value::Table(low)) =
            (&mut above.node.value, &mut below.node.value)
        {
            let inner = table.and_then(|table| table.key(&name)).and_then(|key| match &key.kind {
                Kind::Table(inner) => Some(*inner),
                _ => None,
            });
            overlay(up, core::mem::take(low), inner);
        }
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
