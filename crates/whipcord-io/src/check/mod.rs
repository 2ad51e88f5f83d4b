//! Checks a document against the declarations: names, types, units and what excludes what. What is
//! left is what the readers need not look at twice.

mod fields;

use crate::error::{FileProblem, Problems};
use crate::node::{Entries, Node, Value};
use crate::schema::{Key, Kind, Rule, Table};
use crate::source::Span;
use crate::suggest;
use crate::units::{Dimension, parse_quantity};

pub(crate) use fields::{Data, Fields};

/// Checks a table; `span` is where it is missing something.
pub(crate) fn table(
    entries: &Entries,
    span: Span,
    declared: &Table,
    problems: &mut Problems,
) -> Fields {
    let mut fields = Fields::default();
    // Keys that unknown ones are taken for: they are not missing besides.
    let mut misspelt = Vec::new();
    let mut in_order: Vec<_> = entries.iter().collect();
    in_order.sort_by_key(|(_, entry)| entry.key_span);
    for (name, entry) in in_order {
        match declared.key(name) {
            None => problems.push(entry.key_span, || {
                let (meant, help) = suggest::for_key(name, entry, entries, declared);
                misspelt.extend(meant);
                FileProblem::UnknownKey {
                    key: crate::source::quoted(name),
                    table: declared.title,
                    help,
                }
            }),
            Some(key) => {
                if let Some(data) = value(&entry.node, &key.kind, key, problems) {
                    fields.values.insert(key.name, data);
                }
            }
        }
    }
    for rule in declared.rules {
        check_rule(rule, entries, span, declared, &misspelt, problems);
    }
    fields
}

fn check_rule(
    rule: &Rule,
    entries: &Entries,
    span: Span,
    declared: &Table,
    misspelt: &[&str],
    problems: &mut Problems,
) {
    let table = declared.title;
    let example = |name: &str| declared.key(name).map(Key::example_line).unwrap_or_default();
    let title = |name: &str| declared.key(name).map(Key::title).unwrap_or_default();
    let given = |names: &'static [&'static str]| {
        let mut given: Vec<_> =
            names.iter().filter_map(|&name| Some((name, entries.get(name)?.key_span))).collect();
        given.sort_by_key(|(_, span)| *span);
        given
    };
    let titles = |names: &[&str]| names.iter().map(|name| title(name)).collect();
    let meant = |names: &[&str]| names.iter().any(|name| misspelt.contains(name));
    match *rule {
        Rule::Required(key) => {
            if !entries.contains_key(key) && !meant(&[key]) {
                let (key, example) = (title(key), example(key));
                problems.push(span, || FileProblem::Missing { key, table, example });
            }
        }
        Rule::ExactlyOne(names) | Rule::AtMostOne(names) | Rule::AtLeastOne(names) => {
            let exclusive = !matches!(rule, Rule::AtLeastOne(_));
            let needed = !matches!(rule, Rule::AtMostOne(_));
            match given(names).as_slice() {
                [] if needed && !meant(names) => {
                    problems.push(span, || FileProblem::MissingOneOf {
                        keys: titles(names),
                        table,
                        exclusive,
                        example: example(names[0]),
                    })
                }
                [(first, first_span), others @ ..] if exclusive => {
                    for &(second, second_span) in others {
                        let related = Some((*first_span, "the other one is here"));
                        problems.push_related(second_span, related, || FileProblem::Exclusive {
                            first,
                            second,
                            table,
                        });
                    }
                }
                _ => {}
            }
        }
        Rule::Replaces(..) | Rule::MergedByName(_) => {}
        Rule::Needs(key, names) => {
            if let Some(entry) = entries.get(key)
                && given(names).is_empty()
                && !meant(names)
            {
                problems.push(entry.key_span, || FileProblem::Needs {
                    key,
                    needs: titles(names),
                    table,
                    example: example(names[0]),
                });
            }
        }
    }
}

pub(crate) fn value(
    node: &Node,
    kind: &Kind,
    key: &'static Key,
    problems: &mut Problems,
) -> Option<Data> {
    match (kind, &node.value) {
        (Kind::Text, Value::Text(text)) => {
            if text.trim().is_empty() {
                problems.push(node.span, || empty(key));
                return None;
            }
            Some(Data::Text(text.clone()))
        }
        (Kind::Flag, Value::Flag(flag)) => Some(Data::Flag(*flag)),
        (Kind::Choice(words), Value::Text(text)) => choice(node, words, text, key, problems),
        (Kind::Count { least, greatest }, Value::Integer(value)) => {
            let count = usize::try_from(*value).ok().filter(|n| (*least..=*greatest).contains(n));
            if count.is_none() {
                let numbers = matches!(key.kind, Kind::List(Kind::Count { .. }, _));
                problems.push(node.span, || FileProblem::OutOfRange {
                    key: key.name,
                    value: *value,
                    least: *least,
                    greatest: *greatest,
                    numbers,
                });
            }
            count.map(Data::Count)
        }
        (Kind::Number, Value::Integer(_) | Value::Number(_)) => {
            number(node, key, Dimension::Ratio, problems)
        }
        (Kind::Quantity(dimensions, _), Value::Integer(_) | Value::Number(_)) => {
            number(node, key, *dimensions.first()?, problems)
        }
        (Kind::Quantity(expected, _), Value::Text(text)) => {
            quantity(node, expected, text, key, problems)
        }
        (Kind::Vector(item, expected), Value::List(items)) => {
            let (given, expected) = (items.len(), *expected);
            if given != expected {
                problems.push(node.span, || FileProblem::WrongCount {
                    key: key.name,
                    expected,
                    given,
                });
                return None;
            }
            list(items, item, key, problems)
        }
        (Kind::List(item, _), Value::List(items)) => {
            if items.is_empty() {
                problems.push(node.span, || empty(key));
                return None;
            }
            list(items, item, key, problems)
        }
        (Kind::Either(kinds), given) => match kinds.iter().find(|kind| resembles(given, kind)) {
            Some(kind) => value(node, kind, key, problems),
            None => wrong_type(node, kind, key, problems),
        },
        (Kind::Table(declared), Value::Table(entries)) => {
            Some(Data::Table(table(entries, node.span, declared, problems)))
        }
        (Kind::Tables(declared), Value::List(items))
            if items.iter().all(|item| matches!(item.value, Value::Table(_))) =>
        {
            let tables = items.iter().filter_map(|item| match &item.value {
                Value::Table(entries) => Some(table(entries, item.span, declared, problems)),
                _ => None,
            });
            Some(Data::Tables(tables.collect()))
        }
        (Kind::TablesOfKinds { title, tag, variants }, Value::List(items))
            if items.iter().all(|item| matches!(item.value, Value::Table(_))) =>
        {
            let tables = items.iter().map(|item| match &item.value {
                Value::Table(entries) => variant(item, entries, title, tag, variants, problems),
                _ => None,
            });
            // One that is refused has been reported; the others keep their numbers.
            Some(Data::Tables(tables.map(Option::unwrap_or_default).collect()))
        }
        (Kind::Variants { tag, variants }, Value::Table(entries)) => {
            variant(node, entries, "`routing`", tag, variants, problems).map(Data::Table)
        }
        _ => wrong_type(node, kind, key, problems),
    }
}

/// A number or a text as the file has it.
pub(crate) fn given_text(node: &Node) -> Option<String> {
    match &node.value {
        Value::Text(text) => Some(text.clone()),
        Value::Integer(value) => Some(value.to_string()),
        Value::Number(value) if value.is_finite() => Some(value.to_string()),
        _ => None,
    }
}

/// Whether a value has the outward form of a kind.
fn resembles(value: &Value, kind: &Kind) -> bool {
    match (kind, value) {
        (Kind::Quantity(..), Value::Text(_) | Value::Integer(_) | Value::Number(_)) => true,
        (Kind::Vector(item, _) | Kind::List(item, _), Value::List(items)) => {
            items.first().is_none_or(|first| resembles(&first.value, item))
        }
        (Kind::Number, Value::Integer(_) | Value::Number(_)) => true,
        (Kind::Table(_), Value::Table(_)) => true,
        (Kind::Choice(words), Value::Text(text)) => words.contains(&text.as_str()),
        (Kind::Text, Value::Text(_)) => true,
        _ => false,
    }
}

fn list(items: &[Node], kind: &Kind, key: &'static Key, problems: &mut Problems) -> Option<Data> {
    // Numbers that count from 0 are one mistake, not as many as there are zeros.
    if let Kind::Count { least: 1, .. } = kind {
        let is_zero = |item: &&Node| matches!(item.value, Value::Integer(0));
        let mut zeros = items.iter().filter(is_zero);
        if let (Some(first), Some(_)) = (zeros.next(), zeros.next()) {
            value(first, kind, key, problems);
            let others = items.iter().filter(|item| !is_zero(item));
            others.for_each(|item| _ = value(item, kind, key, problems));
            return None;
        }
    }
    let checked: Vec<Data> =
        items.iter().filter_map(|item| value(item, kind, key, problems)).collect();
    (checked.len() == items.len()).then_some(Data::List(checked))
}

fn number(
    node: &Node,
    key: &'static Key,
    dimension: Dimension,
    problems: &mut Problems,
) -> Option<Data> {
    let value = match node.value {
        Value::Integer(value) => value as f64,
        Value::Number(value) => value,
        _ => return None,
    };
    if value.is_finite() {
        Some(Data::Number(value, dimension))
    } else {
        problems.push(node.span, || FileProblem::NotFinite { key: key.name, value });
        None
    }
}

fn quantity(
    node: &Node,
    expected: &'static [Dimension],
    text: &str,
    key: &'static Key,
    problems: &mut Problems,
) -> Option<Data> {
    match parse_quantity(text, expected) {
        Ok((value, dimension)) => Some(Data::Number(value, dimension)),
        Err(error) => {
            problems.push(node.span, || FileProblem::Quantity { key: key.name, error, expected });
            None
        }
    }
}

fn choice(
    node: &Node,
    words: &'static [&'static str],
    text: &str,
    key: &'static Key,
    problems: &mut Problems,
) -> Option<Data> {
    if words.contains(&text) {
        return Some(Data::Text(text.to_owned()));
    }
    problems.push(node.span, || FileProblem::UnknownChoice {
        key: key.name,
        value: crate::source::quoted(text),
        choices: words.to_vec(),
        near: suggest::for_choice(key.name, text, words),
    });
    None
}

pub(crate) fn variant(
    node: &Node,
    entries: &Entries,
    title: &'static str,
    tag: &'static Key,
    variants: &'static [(&'static str, Table)],
    problems: &mut Problems,
) -> Option<Fields> {
    let Some(entry) = entries.get(tag.name) else {
        if let Some((name, other)) = suggest::other_tag(entries) {
            problems.push(other.key_span, || FileProblem::UnknownKey {
                key: name.clone(),
                table: title,
                help: format!("did you mean `{}`?", tag.name),
            });
            return None;
        }
        problems.push(node.span, || FileProblem::Missing {
            key: tag.title(),
            table: title,
            example: tag.example_line(),
        });
        return None;
    };
    let Data::Text(given) = value(&entry.node, &tag.kind, tag, problems)? else { return None };
    let (word, declared) = variants.iter().find(|(word, _)| *word == given)?;
    let mut rest = entries.clone();
    rest.remove(tag.name);
    let fields = table(&rest, node.span, declared, problems);
    Some(Fields { variant: word, ..fields })
}

fn empty(key: &Key) -> FileProblem {
    FileProblem::Empty { key: key.name, example: key.example_line() }
}

fn wrong_type(
    node: &Node,
    kind: &Kind,
    key: &'static Key,
    problems: &mut Problems,
) -> Option<Data> {
    problems.push(node.span, || {
        let (mut expected, mut found) = (kind.description(), node.value.type_name());
        let help = match (kind, &node.value) {
            // Beyond 64 bits the parser gives a number of any kind.
            (Kind::Count { least, greatest }, Value::Number(value))
                if value.abs() >= 2f64.powi(63) =>
            {
                found = "a number that is far too large";
                format!("write a number from {least} to {greatest}")
            }
            (Kind::Count { .. }, Value::Number(value)) => {
                found = "a number with a decimal point";
                if value.fract() == 0.0 && value.abs() < 1e15 {
                    format!("write {value:.0}")
                } else {
                    "write it without a decimal point".to_owned()
                }
            }
            (Kind::Tables(inner), Value::Table(_)) => {
                expected = format!("a list, begun by {}", inner.title);
                format!("write {} with double brackets", inner.title)
            }
            (Kind::TablesOfKinds { title, .. }, Value::Table(_)) => {
                expected = format!("a list, begun by {title}");
                format!("write {title} with double brackets")
            }
            (Kind::TablesOfKinds { title, .. }, _) => {
                format!("begin it with {title} on a line of its own")
            }
            (Kind::Table(inner), Value::List(_)) if inner.title.starts_with('[') => {
                format!("write {} with single brackets, once", inner.title)
            }
            (Kind::Table(inner) | Kind::Tables(inner), _) if inner.title.starts_with('[') => {
                format!("begin it with {} on a line of its own", inner.title)
            }
            (Kind::Number | Kind::Count { .. }, Value::Text(text))
                if text.trim().parse::<f64>().is_ok_and(f64::is_finite) =>
            {
                format!("write {} without quotes", text.trim())
            }
            (Kind::Number, Value::Text(_)) => {
                "write the number in SI units, without quotes and without a unit".to_owned()
            }
            _ => format!("write for example `{}`", key.example_line()),
        };
        FileProblem::WrongType { key: key.name, expected, found, help }
    });
    None
}
