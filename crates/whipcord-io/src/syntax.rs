//! The TOML parser's messages in the words of the others.

use crate::error::FileProblem;
use crate::source::quoted;

/// What the parser says, by how it begins; what is told instead; and what to do.
const WORDS: &[(&str, &str, &str)] = &[
    ("invalid key-value pair", "a key is expected here", TOML),
    ("key with no value", "this key has no value", "write `key = value`"),
    ("unquoted keys cannot be empty", "there is no key before the `=`", "write `key = value`"),
    (
        "invalid unquoted key",
        "a key cannot be written like this",
        "keys consist of letters, digits, `_` and `-`, and are followed by `=`",
    ),
    ("extra `=`", "there is an `=` too many", "write `key = value`"),
    ("invalid basic string", "the text has no end", "close it with a `\"`"),
    ("invalid literal string", "the text has no end", "close it with a `'`"),
    ("unclosed array", "the list has no end", "close it with a `]`"),
    ("unclosed table", "the header of the table has no end", "close it with a `]`"),
    ("unclosed inline table", "the table has no end", "close it with a `}`"),
    ("missing comma", "a comma is missing here", "put commas between the entries"),
    (
        "unexpected key or value",
        "nothing may follow the value on its line",
        "write each key on a line of its own, and decimals with a point",
    ),
    (
        "missing escaped value",
        "the `\\` stands before a character that needs none",
        "write `\\\\` for the character itself, or put the text in single quotes",
    ),
];

const TOML: &str = "the file must be TOML: check the quotes, brackets, commas and `=` of this line and the one before it";

/// The problem behind a message of the parser, which points at `text`.
pub(crate) fn problem(message: &str, text: &str) -> FileProblem {
    let (message, help) = if message.contains("recurs") {
        return FileProblem::TooDeep;
    } else if message == "duplicate key" {
        (
            format!("`{}` is given twice", quoted(text)),
            "remove one of the two; to describe several cables, begin each with [[cables]]"
                .to_owned(),
        )
    } else if message.starts_with("string values must be quoted") {
        unquoted(text)
    } else if let Some((_, told, help)) = WORDS.iter().find(|(said, ..)| message.starts_with(said))
    {
        ((*told).to_owned(), (*help).to_owned())
    } else {
        (message.to_owned(), TOML.to_owned())
    };
    FileProblem::Syntax { message, help }
}

fn unquoted(text: &str) -> (String, String) {
    if text.trim().is_empty() {
        return ("there is no value".to_owned(), "write one after the `=`".to_owned());
    }
    let text = quoted(text.trim());
    let words: Vec<&str> = text.split(' ').collect();
    let help = if words.len() > 1 && words.iter().all(|word| word.parse::<f64>().is_ok()) {
        format!("put commas between the entries of a list: {}", words.join(", "))
    } else {
        format!("a text needs quotes, a number with a unit too: \"{text}\"")
    };
    (format!("`{text}` is not a value"), help)
}
