//! The declarations as a JSON Schema.

use serde_json::{Map, Value, json};
use whipcord::robot::limits::Range;

use super::{Kind, ROOT, Rule, Table};
use crate::units::Dimension;

/// The JSON Schema (draft 2020-12) of robot files, for editors that complete and check TOML.
///
/// A file that extends another one may leave out what that one gives; the schema asks for nothing
/// in it. What only the numbers can tell, such as a hole that no disk has, [`load`](crate::load)
/// tells.
#[must_use]
pub fn schema() -> Value {
    let mut root = Map::new();
    root.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    root.insert("title".to_owned(), json!("Whipcord robot file"));
    let Value::Object(table) = table(&ROOT) else { return Value::Null };
    root.extend(table);
    root.insert("if".to_owned(), json!({ "not": { "required": ["extends"] } }));
    root.insert("then".to_owned(), complete(&ROOT));
    let quantities: Map<_, _> =
        Dimension::ALL.into_iter().map(|d| (definition(d), quantity(d))).collect();
    root.insert("$defs".to_owned(), Value::Object(quantities));
    Value::Object(root)
}

/// What holds of a table in every file, be it complete or not.
fn table(declared: &Table) -> Value {
    let properties: Map<_, _> = declared
        .keys
        .iter()
        .map(|key| {
            let mut value = kind(&key.kind);
            value["description"] = json!(key.doc);
            (key.name.to_owned(), value)
        })
        .collect();
    let mut schema = json!({
        "type": "object",
        "description": declared.doc,
        "properties": properties,
        "additionalProperties": false,
    });
    let exclusions: Vec<Value> = declared
        .rules
        .iter()
        .filter_map(|rule| match rule {
            Rule::ExactlyOne(names) | Rule::AtMostOne(names) => Some(*names),
            _ => None,
        })
        .flat_map(pairs)
        .map(|pair| json!({ "not": { "required": pair } }))
        .collect();
    if !exclusions.is_empty() {
        schema["allOf"] = json!(exclusions);
    }
    schema
}

/// What holds besides of a table that no other file completes.
fn complete(declared: &Table) -> Value {
    let any_of = |names: &[&str]| -> Vec<Value> {
        names.iter().map(|name| json!({ "required": [name] })).collect()
    };
    let mut required = Vec::new();
    let mut others = Vec::new();
    for rule in declared.rules {
        match *rule {
            Rule::Required(name) => required.push(name),
            Rule::ExactlyOne(names) | Rule::AtLeastOne(names) => {
                others.push(json!({ "anyOf": any_of(names) }));
            }
            Rule::Needs(name, names) => others.push(json!({
                "if": { "required": [name] },
                "then": { "anyOf": any_of(names) },
            })),
            Rule::AtMostOne(_) | Rule::Replaces(..) | Rule::MergedByName(_) => {}
        }
    }
    let inner: Map<_, _> = declared
        .keys
        .iter()
        .filter_map(|key| match &key.kind {
            // Nothing lies below that could be removed.
            Kind::Table(inner) if inner.key("remove").is_some() => {
                let mut schema = complete(inner);
                schema["properties"] = json!({ "remove": { "const": false } });
                Some((key.name.to_owned(), schema))
            }
            Kind::Table(inner) => Some((key.name.to_owned(), complete(inner))),
            Kind::Tables(inner) if inner.merged_by_name().is_some() => {
                let mut items = complete(inner);
                items["properties"] = json!({ "remove": { "const": false } });
                Some((key.name.to_owned(), json!({ "items": items })))
            }
            _ => None,
        })
        .filter(|(_, schema)| schema.as_object().is_some_and(|schema| !schema.is_empty()))
        .collect();
    let mut schema = Map::new();
    if !required.is_empty() {
        schema.insert("required".to_owned(), json!(required));
    }
    if !others.is_empty() {
        schema.insert("allOf".to_owned(), json!(others));
    }
    if !inner.is_empty() {
        schema.insert("properties".to_owned(), Value::Object(inner));
    }
    Value::Object(schema)
}

/// A table that stands in an array which replaces that of another file: it is always complete.
fn whole(declared: &Table) -> Value {
    let mut schema = table(declared);
    let rest = complete(declared);
    if let (Value::Object(schema), Value::Object(mut rest)) = (&mut schema, rest) {
        if let (Some(Value::Array(mine)), Some(Value::Array(more))) =
            (schema.get_mut("allOf"), rest.get_mut("allOf"))
        {
            mine.append(more);
            rest.remove("allOf");
        }
        // No table inside an array has tables of its own besides variants, which are whole.
        rest.remove("properties");
        schema.extend(rest);
    }
    schema
}

fn kind(declared: &Kind) -> Value {
    match declared {
        Kind::Text => json!({ "type": "string", "pattern": "\\S" }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Count { least, greatest } => {
            json!({ "type": "integer", "minimum": least, "maximum": greatest })
        }
        Kind::Number => json!({ "type": "number" }),
        Kind::Quantity([dimension], range) => bounded(reference(*dimension), *range),
        Kind::Quantity(dimensions, range) => {
            let any_of: Vec<Value> = dimensions.iter().map(|d| reference(*d)).collect();
            bounded(json!({ "anyOf": any_of }), *range)
        }
        Kind::Vector(item, count) => {
            json!({ "type": "array", "items": kind(item), "minItems": count, "maxItems": count })
        }
        Kind::List(item, least) => {
            json!({ "type": "array", "items": kind(item), "minItems": least })
        }
        Kind::Either(kinds) => {
            let any_of: Vec<Value> = kinds
                .iter()
                .map(|each| match each {
                    Kind::Table(inner) => whole(inner),
                    other => kind(other),
                })
                .collect();
            json!({ "anyOf": any_of })
        }
        Kind::Table(inner) => table(inner),
        Kind::Tables(inner) if inner.merged_by_name().is_some() => {
            json!({ "type": "array", "items": table(inner) })
        }
        Kind::Tables(inner) => json!({ "type": "array", "items": whole(inner) }),
        Kind::Variants { tag, variants } => of_kinds(tag.name, variants),
        Kind::TablesOfKinds { tag, variants, .. } => {
            json!({ "type": "array", "items": of_kinds(tag.name, variants) })
        }
    }
}

/// A table that is one of several kinds.
fn of_kinds(tag: &str, variants: &[(&str, Table)]) -> Value {
    let variants: Vec<Value> =
        variants.iter().map(|(word, inner)| variant(tag, word, inner)).collect();
    json!({ "type": "object", "oneOf": variants })
}

fn variant(tag: &str, word: &str, declared: &Table) -> Value {
    let mut schema = whole(declared);
    schema["properties"][tag] = json!({ "const": word, "description": declared.doc });
    if let Some(required) = schema.get_mut("required").and_then(Value::as_array_mut) {
        required.insert(0, json!(tag));
    } else {
        schema["required"] = json!([tag]);
    }
    schema
}

/// The same for numbers within a range; a text with a unit a schema cannot compare.
fn bounded(mut schema: Value, range: Range) -> Value {
    let least = if range.above { "exclusiveMinimum" } else { "minimum" };
    schema[least] = json!(range.least);
    schema["maximum"] = json!(range.greatest);
    schema
}

fn reference(dimension: Dimension) -> Value {
    json!({ "$ref": format!("#/$defs/{}", definition(dimension)) })
}

/// Under what name a dimension is defined: no space may stand in a reference.
fn definition(dimension: Dimension) -> String {
    dimension.to_string().replace(' ', "-")
}

fn quantity(dimension: Dimension) -> Value {
    const NUMBER: &str = r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?";
    const ZERO: &str = r"[-+]?(0+\.?0*|\.0+)([eE][-+]?\d+)?";
    let spellings: Vec<String> = dimension
        .units()
        .iter()
        .flat_map(|unit| unit.spellings())
        .map(|name| name.replace('^', r"\^").replace('*', r"\*"))
        .collect();
    let plain = match dimension.si_unit() {
        "" => "a plain number".to_owned(),
        unit => format!("a number in {unit}"),
    };
    json!({
        "description": format!(
            "{}: {plain}, or a text with a unit ({}), such as \"{}\"",
            super::article(&dimension.to_string()),
            dimension.unit_names(),
            dimension.example(),
        ),
        "anyOf": [
            { "type": "number" },
            {
                "type": "string",
                "pattern": format!(r"^\s*({NUMBER}\s*({})|{ZERO})\s*$", spellings.join("|")),
            },
        ],
    })
}

fn pairs(names: &'static [&'static str]) -> impl Iterator<Item = [&'static str; 2]> {
    names
        .iter()
        .enumerate()
        .flat_map(move |(i, &first)| names[i + 1..].iter().map(move |&second| [first, second]))
}
