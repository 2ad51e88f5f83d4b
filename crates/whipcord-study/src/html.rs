//! The frame of a self-contained HTML page.

use std::borrow::Cow;

/// A figure and what it shows.
#[derive(Clone, Debug)]
pub struct Figure {
    /// For file names.
    pub name: Cow<'static, str>,
    /// What it shows.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

impl Figure {
    /// With its caption below.
    pub fn html(&self) -> String {
        let caption = escape(&self.caption);
        format!("<figure>{}<figcaption>{caption}</figcaption></figure>\n", self.svg)
    }
}

/// Notes, one below the other; nothing of none.
pub fn list<'a>(items: impl IntoIterator<Item = &'a String>) -> String {
    let items: String =
        items.into_iter().map(|item| format!("<li>{}</li>\n", escape(item))).collect();
    if items.is_empty() { items } else { format!("<ul class=\"notes\">\n{items}</ul>\n") }
}

/// What a report ends with.
pub fn footer() -> String {
    format!(
        "<footer>whipcord {}. Every number, in SI, is in the CSV files beside this report.</footer>\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// A page with this title and body.
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escape(title)
    )
}

/// Figures are drawn on white: they stay on a white card where the page is dark.
const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1d2329; --soft: #5b6670; --line: #d5dade; --page: #fff; --band: #f3f5f6; --link: #0b63a5 }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e8ea; --soft: #9aa6ae; --line: #3a434a; --page: #15191c; --band: #1e2428; --link: #79b8ea } }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, sans-serif }
main { max-width: 74rem; margin: 0 auto; padding: 1.5rem }
h1 { font-size: 1.6rem } h2 { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1.5rem; font-size: 1.3rem } h3 { font-size: 1rem; margin: 1.5rem 0 .3rem }
a { color: var(--link) }
.path, figcaption, .notes, footer { color: var(--soft); font-size: .9rem }
.scroll { overflow-x: auto }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums }
th, td { padding: .25rem .5rem; text-align: left }
td.n { white-space: nowrap }
th { border-bottom: 1px solid var(--ink); vertical-align: bottom }
th small { display: block; font-weight: normal; color: var(--soft) }
tbody + tbody { border-top: 1px solid var(--line) }
tbody tr:nth-child(even) { background: var(--band) }
th.n, td.n { text-align: right }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; font-size: .9rem }
dt { color: var(--soft) } dd { margin: 0 }
figure { margin: 1.5rem 0 }
figure svg { display: block; max-width: 100%; height: auto; background: #fff; border-radius: 6px; border: 1px solid var(--line) }
@media print { section { break-before: page } }
";

/// Text in HTML.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            c => escaped.push(c),
        }
    }
    escaped
}
