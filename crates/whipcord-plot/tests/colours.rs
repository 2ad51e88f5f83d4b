//! The colours of models and cables are the same in figures, in the viewer's page and in the Python package.
#![expect(clippy::unwrap_used, reason = "a test that cannot read its files fails")]

use std::fs;
use std::path::Path;

use whipcord::ModelKind;
use whipcord_plot::{CABLES, Colour};

fn source(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    fs::read_to_string(root.join(path)).unwrap()
}

/// What stands between a beginning and an end.
fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let (_, rest) = text.split_once(start).unwrap();
    rest.split_once(end).unwrap().0
}

/// The words in double quotes, in order.
fn quoted(text: &str) -> Vec<&str> {
    text.split('"').skip(1).step_by(2).collect()
}

/// With all six digits.
fn css(Colour { red, green, blue }: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Names of models and their colours, one after the other.
fn models() -> Vec<String> {
    let of = |kind: ModelKind| [kind.to_string(), css(Colour::of_model(kind))];
    ModelKind::ALL.into_iter().flat_map(of).collect()
}

fn cables() -> Vec<String> {
    CABLES.map(css).to_vec()
}

#[test]
fn the_page_of_the_viewer_has_the_same_colours() {
    let page = source("crates/whipcord-viewer/page/src/colours.ts");
    assert_eq!(quoted(between(&page, "const MODELS", "};")), models());
    assert_eq!(quoted(between(&page, "const CABLES", "]")), cables());
}

#[test]
fn the_python_package_has_the_same_colours() {
    let plot = source("python/whipcord/plot.py");
    assert_eq!(quoted(between(&plot, "MODELS = {", "}")), models());
    assert_eq!(quoted(between(&plot, "CABLES = (", ")")), cables());
}
