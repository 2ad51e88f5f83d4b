//! One table of a robot file by itself.

use std::path::Path;

use whipcord::Material;

use super::{Item, Table, toml};
use crate::check::{self, Data, Fields};
use crate::error::{FileError, FileProblem, Problems};
use crate::node::{self, Node, Value};
use crate::read;
use crate::schema::{Key, Kind, ROOT, Table as Declared};
use crate::source::Sources;
use crate::units::{Dimension, percent};

/// A table such as `[backbone]` with all quantities in SI; of `[[cables]]`, `[[steps]]` and the tables
/// of `[loads]` one entry: `name` is that of the key, with dots between nested ones. It checks names,
/// types, units, the ranges of single numbers and what excludes what, and adds the numbers of a material that is named; what does not fit the rest of the robot shows when that is read.
///
/// ```
/// use whipcord_io::{Item, Table, table_in_si};
/// let mut backbone = Table::default();
/// backbone.insert("length", "180 mm");
/// let in_si = table_in_si("backbone", &backbone)?;
/// assert_eq!(in_si.get("length"), Some(&Item::Number(0.18)));
/// # Ok::<(), whipcord_io::FileError>(())
/// ```
///
/// # Errors
/// [`FileError`] with all that is wrong with it, numbers beyond their range included.
pub fn table_in_si(name: &str, table: &Table) -> Result<Table, FileError> {
    let text = toml(table);
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    let file = sources.add(Path::new(name), Some(text.clone()));
    let mut in_si = Table::default();
    if let Some(root) = node::parse(file, &text, &mut problems)
        && let (Value::Table(entries), Some(kind)) = (&root.value, declared(name))
    {
        in_si = match kind {
            Declaration::Table(declared) => {
                let fields = check::table(entries, root.span, declared, &mut problems);
                let mut ranges = Ranges { name, root: &root, problems: &mut problems };
                ranges.of_table("", &fields, declared);
                let mut table = plain(&fields, declared);
                if name == "backbone" {
                    complete(&mut table, &read::material(&fields));
                    let place = |name: &str| declared.keys.iter().position(|key| key.name == name);
                    table.entries.sort_by_key(|(name, _)| place(name));
                }
                table
            }
            Declaration::OfKinds { title, tag, variants } => {
                let of_kind = check::variant(&root, entries, title, tag, variants, &mut problems);
                if let Some(fields) = &of_kind {
                    Ranges { name, root: &root, problems: &mut problems }
                        .of_variant("", fields, variants);
                }
                of_kind.map(|fields| variant(&fields, tag, variants)).unwrap_or_default()
            }
        };
    }
    if problems.is_empty() { Ok(in_si) } else { Err(problems.into_error(sources)) }
}

/// Checks each number against the range that the schema declares for its key, which is that of the library.
struct Ranges<'a> {
    /// Name of the table.
    name: &'a str,
    root: &'a Node,
    problems: &'a mut Problems,
}

impl Ranges<'_> {
    fn of_table(&mut self, path: &str, fields: &Fields, declared: &Declared) {
        for key in declared.keys {
            if let Some(data) = fields.data(key.name) {
                let dot = if path.is_empty() { "" } else { "." };
                self.of(&format!("{path}{dot}{}", key.name), data, &key.kind);
            }
        }
    }

    fn of_variant(&mut self, path: &str, fields: &Fields, variants: &[(&'static str, Declared)]) {
        if let Some((_, declared)) = variants.iter().find(|(word, _)| *word == fields.variant) {
            self.of_table(path, fields, declared);
        }
    }

    fn of(&mut self, path: &str, data: &Data, kind: &Kind) {
        let at = |i: usize| format!("{path}[{i}]");
        match (data, kind) {
            // A share of something that is else a length has a range of its own, which the robot knows.
            (Data::Number(value, dimension), Kind::Quantity(dimensions, range))
                if dimensions.first() == Some(dimension) =>
            {
                if let Some(problem) = range.problem(*value) {
                    let (span, name) = (self.root.locate(path).span, self.name);
                    let path = format!("{name}.{path}");
                    self.problems.push(span, || FileProblem::Physical { path, problem });
                }
            }
            (_, Kind::Either(kinds)) => {
                if let Some(kind) = kinds.iter().find(|kind| fits(data, kind)) {
                    self.of(path, data, kind);
                }
            }
            (Data::List(list), Kind::Vector(each, _) | Kind::List(each, _)) => {
                list.iter().enumerate().for_each(|(i, data)| self.of(&at(i), data, each));
            }
            (Data::Table(fields), Kind::Table(declared)) => self.of_table(path, fields, declared),
            (Data::Tables(list), Kind::Tables(declared)) => {
                list.iter().enumerate().for_each(|(i, of)| self.of_table(&at(i), of, declared));
            }
            (Data::Table(fields), Kind::Variants { variants, .. }) => {
                self.of_variant(path, fields, variants);
            }
            (Data::Tables(list), Kind::TablesOfKinds { variants, .. }) => {
                list.iter().enumerate().for_each(|(i, of)| self.of_variant(&at(i), of, variants));
            }
            _ => {}
        }
    }
}

/// What a file may say in a table.
enum Declaration {
    Table(&'static Declared),
    OfKinds {
        title: &'static str,
        tag: &'static Key,
        variants: &'static [(&'static str, Declared)],
    },
}

/// What a file may say in the table of this name.
fn declared(name: &str) -> Option<Declaration> {
    let mut table = &ROOT;
    for part in name.split('.') {
        match table.key(part)?.kind {
            Kind::Table(inner) | Kind::Tables(inner) => table = inner,
            Kind::Either(kinds) => {
                let inner = kinds.iter().find_map(|kind| match kind {
                    Kind::Table(inner) => Some(*inner),
                    _ => None,
                });
                table = inner?;
            }
            Kind::TablesOfKinds { title, tag, variants } => {
                return Some(Declaration::OfKinds { title, tag, variants });
            }
            _ => return None,
        }
    }
    Some(Declaration::Table(table))
}

/// Adds what a material that is named gives besides what the table says.
fn complete(table: &mut Table, material: &Material) {
    if material.name.is_none() {
        return;
    }
    for (key, value) in [
        ("young_modulus", material.young_modulus),
        ("poisson_ratio", material.poisson_ratio),
        ("shear_modulus", material.shear_modulus),
        ("density", material.density),
        ("yield_strain", material.yield_strain),
    ] {
        if table.get(key).is_none() {
            table.insert_some(key, value);
        }
    }
}

/// The entries in the order in which they are declared.
fn plain(fields: &Fields, declared: &Declared) -> Table {
    let mut table = Table::default();
    for key in declared.keys {
        if let Some(data) = fields.data(key.name) {
            table.insert(key.name, item(data, &key.kind));
        }
    }
    table
}

fn item(data: &Data, kind: &Kind) -> Item {
    match (data, kind) {
        (Data::Text(text), _) => Item::Text(text.clone()),
        (Data::Flag(flag), _) => Item::Flag(*flag),
        (Data::Count(count), _) => (*count).into(),
        // A share of something that is else a length stays one.
        (Data::Number(share, Dimension::Ratio), Kind::Quantity(dimensions, _))
            if dimensions.first() != Some(&Dimension::Ratio) =>
        {
            Item::Text(percent(*share))
        }
        // And so does the rate of a force that may be a speed.
        (Data::Number(rate, Dimension::ForceRate), _) => Item::Text(format!("{rate:?} N/s")),
        (Data::Number(value, _), _) => Item::Number(*value),
        (_, Kind::Either(kinds)) => match kinds.iter().find(|kind| fits(data, kind)) {
            Some(kind) => item(data, kind),
            None => Item::List(Vec::new()),
        },
        (Data::List(list), Kind::Vector(each, _) | Kind::List(each, _)) => {
            Item::List(list.iter().map(|data| item(data, each)).collect())
        }
        (Data::Table(fields), Kind::Table(declared)) => plain(fields, declared).into(),
        (Data::Tables(list), Kind::Tables(declared)) => {
            list.iter().map(|fields| plain(fields, declared)).collect::<Vec<_>>().into()
        }
        (Data::Table(fields), Kind::Variants { tag, variants }) => {
            variant(fields, tag, variants).into()
        }
        (Data::Tables(list), Kind::TablesOfKinds { tag, variants, .. }) => {
            list.iter().map(|fields| variant(fields, tag, variants)).collect::<Vec<_>>().into()
        }
        // The check has let nothing through that its kind does not have.
        _ => Item::List(Vec::new()),
    }
}

/// The entries of a table that is one of several kinds, the kind first.
fn variant(fields: &Fields, tag: &Key, variants: &[(&'static str, Declared)]) -> Table {
    let mut table = Table::default();
    table.insert(tag.name, fields.variant);
    let of_variant = variants.iter().find(|(word, _)| *word == fields.variant);
    let rest = of_variant.map(|(_, declared)| plain(fields, declared)).unwrap_or_default();
    table.entries.extend(rest.entries);
    table
}

/// Whether checked data are of this kind.
fn fits(data: &Data, kind: &Kind) -> bool {
    match (data, kind) {
        (Data::Number(..), Kind::Quantity(..) | Kind::Number)
        | (Data::Text(_), Kind::Choice(_))
        | (Data::Table(_), Kind::Table(_)) => true,
        (Data::List(list), Kind::Vector(each, _) | Kind::List(each, _)) => {
            list.iter().all(|data| fits(data, each))
        }
        _ => false,
    }
}
