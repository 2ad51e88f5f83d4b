//! Keys of a robot file that are given beside it, as `--set PATH=VALUE` of the command line.

use std::path::Path;

use crate::error::{FileProblem, Problems};
use crate::node::{self, Entries, Entry, Node, Value};
use crate::schema::{Kind, ROOT, Table};
use crate::source::{SETTING, Sources, Span, quoted};
use crate::units::listed;

/// The table whose entries are driven in one way over time, which is not changed in passing.
const MOTION_COMMANDS: &str = "[[motion.commands]]";

/// A part of a path, and where it stands.
#[derive(Clone, Debug)]
struct Part {
    name: String,
    /// The number in brackets.
    index: Option<usize>,
    span: Span,
}

/// Sets what each of these texts says, such as `cables.pull.tension=5 N` or `backbone.diameter = "3 mm"`. An entry of a
/// list is told by its name or by its number in brackets, from 0.
pub(crate) fn apply(
    root: &mut Node,
    settings: &[String],
    sources: &mut Sources,
    problems: &mut Problems,
) {
    for text in settings {
        let file = sources.add(Path::new(SETTING), Some(text.clone()));
        let whole = Span::new(file, 0, text.len());
        let refuse = |problems: &mut Problems, span: Span, message: String, help: String| {
            problems.push(span, || FileProblem::Syntax { message, help });
        };
        let Some((path, value)) = text.split_once('=') else {
            let message = format!("`{}` gives no value", quoted(text));
            let help = "write PATH=VALUE, for example cables.pull.tension=\"5 N\"".to_owned();
            refuse(problems, whole, message, help);
            continue;
        };
        let parts = match parts(path, file) {
            Ok(parts) => parts,
            Err(span) => {
                let message = format!("`{}` is no path of a key", quoted(path));
                let help =
                    "write names with dots between them, for example backbone.diameter".to_owned();
                refuse(problems, span, message, help);
                continue;
            }
        };
        if parts.first().is_some_and(|part| part.name == "extends") {
            let message = "`extends` cannot be set".to_owned();
            refuse(
                problems,
                whole,
                message,
                "set keys of tables, or write a robot file".to_owned(),
            );
            continue;
        }
        let at = path.len() + 1;
        let node = node::parse_value(file, at, value).unwrap_or_else(|| {
            let begin = at + value.len() - value.trim_start().len();
            let span = Span::new(file, begin, begin + value.trim().len());
            Node { span, value: Value::Text(value.trim().to_owned()) }
        });
        if let Err((span, message, help)) = set(root, Some(&ROOT), &parts, node) {
            refuse(problems, span, message, help);
        }
    }
}

/// The parts of a path; else the place where it is wrong.
fn parts(path: &str, file: usize) -> Result<Vec<Part>, Span> {
    const MOST: usize = 16;
    let mut parts = Vec::new();
    let mut at = 0;
    for piece in path.split('.') {
        let begin = at + piece.len() - piece.trim_start().len();
        let span = Span::new(file, begin, begin + piece.trim().len());
        let mut pieces = piece.trim().split('[');
        let name = pieces.next().unwrap_or_default().trim();
        if name.is_empty() || parts.len() >= MOST {
            return Err(span);
        }
        parts.push(Part { name: name.to_owned(), index: None, span });
        for index in pieces {
            let index = index.strip_suffix(']').and_then(|index| index.trim().parse().ok());
            let index = Some(index.ok_or(span)?);
            parts.push(Part { name: name.to_owned(), index, span });
        }
        at += piece.len() + 1;
    }
    Ok(parts)
}

/// A place of the path, what is wrong there, and what to do.
type Refused = (Span, String, String);

fn set(
    node: &mut Node,
    declared: Option<&'static Table>,
    parts: &[Part],
    value: Node,
) -> Result<(), Refused> {
    let Some((part, rest)) = parts.split_first() else {
        *node = value;
        return Ok(());
    };
    match (&mut node.value, part.index) {
        (Value::Table(entries), None) => set_key(entries, declared, part, rest, value),
        (Value::List(items), index) => {
            let found = match index {
                Some(index) => (index < items.len()).then_some(index),
                None => items.iter().enumerate().position(|(i, item)| named(item, i, &part.name)),
            };
            match found.and_then(|found| items.get_mut(found)) {
                Some(item) => set(item, declared, rest, value),
                None => Err(no_entry(items, part)),
            }
        }
        _ => {
            let message = format!("`{}` is not part of a table or list", quoted(&part.name));
            Err((part.span, message, "set the whole key before it".to_owned()))
        }
    }
}

fn set_key(
    entries: &mut Entries,
    declared: Option<&'static Table>,
    part: &Part,
    rest: &[Part],
    value: Node,
) -> Result<(), Refused> {
    let key = declared.and_then(|table| table.key(&part.name));
    let inner = key.and_then(|key| match key.kind {
        Kind::Table(inner) | Kind::Tables(inner) => Some(inner),
        _ => None,
    });
    if let Some(entry) = entries.get_mut(&part.name).filter(|_| !rest.is_empty()) {
        return set(&mut entry.node, inner, rest, value);
    }
    if let (Some(first), Some(Kind::Tables(_) | Kind::TablesOfKinds { .. })) =
        (rest.first(), key.map(|key| &key.kind))
    {
        return Err(no_entry(&[], first));
    }
    // What is set replaces what says the same in another way: a tip that is given by its diameter, say.
    for rival in declared.into_iter().flat_map(|table| table.rivals(&part.name)) {
        let is_command = declared.is_some_and(|table| table.title == MOTION_COMMANDS);
        if is_command && entries.get(rival).is_some() {
            let message = format!(
                "`{}` is set beside the `{rival}` that the file gives this command over time",
                quoted(&part.name)
            );
            let help = format!("set its `{rival}`, or change the command in the file");
            return Err((part.span, message, help));
        }
        entries.remove(rival);
    }
    let mut node = Node { span: part.span, value: Value::Table(Entries::new()) };
    set(&mut node, inner, rest, value)?;
    entries.insert(part.name.clone(), Entry { key_span: part.span, node });
    Ok(())
}

/// Name of an entry of a list of tables, where it has one.
fn name_of(item: &Node) -> Option<&str> {
    match &item.find("name")?.value {
        Value::Text(name) => Some(name),
        _ => None,
    }
}

/// Whether the entry of this number is called so; one without a name is `cable-1`, `motor-1` or `obstacle-1`.
fn named(item: &Node, index: usize, name: &str) -> bool {
    match name_of(item) {
        Some(own) => own == name,
        None => ["cable", "motor", "obstacle"]
            .iter()
            .any(|kind| name == format!("{kind}-{}", index + 1)),
    }
}

fn no_entry(items: &[Node], part: &Part) -> Refused {
    let message = match part.index {
        Some(index) => format!("`{}` has no entry {index}", quoted(&part.name)),
        None => format!("there is no `{}` in this list", quoted(&part.name)),
    };
    let names: Vec<String> = items.iter().filter_map(name_of).map(quoted).collect();
    let help = match items.len() {
        0 => "the file has no such entries: add one there".to_owned(),
        1 if names.is_empty() => "the only entry is [0]".to_owned(),
        count if names.is_empty() => format!("entries count from [0] to [{}]", count - 1),
        count => format!(
            "its entries are {}; or give a number from [0] to [{}]",
            listed(names.iter().map(String::as_str), "and"),
            count - 1
        ),
    };
    (part.span, message, help)
}
