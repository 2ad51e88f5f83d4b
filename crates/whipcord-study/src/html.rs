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

    /// The same, as one of several pictures on a page: names in it begin with this, so that each is of one picture.
    pub fn html_within(&self, name: &str) -> String {
        let svg = self.svg.replace(" id=\"", &format!(" id=\"{name}-"));
        let svg = svg.replace("url(#", &format!("url(#{name}-"));
        Self { svg, ..self.clone() }.html()
    }
}

/// A place in a page: the name that addresses end with, and what it is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// For addresses.
    pub id: String,
    /// What it is called.
    pub title: String,
    /// More of it, less prominent.
    pub detail: String,
}

/// A list of what is in a page: beside it where it is wide, else where it stands.
pub fn contents(places: &[Place]) -> String {
    let item = |Place { id, title, detail }: &Place| {
        let detail = match detail.as_str() {
            "" => String::new(),
            detail => format!(" <span class=\"path\">{}</span>", escape(detail)),
        };
        format!("<li><a href=\"#{id}\">{}</a>{detail}</li>\n", escape(title))
    };
    let items: String = places.iter().map(item).collect();
    format!(
        "<nav class=\"contents\" aria-label=\"Contents\">\n<p>Contents</p>\n<ul>\n{items}</ul>\n</nav>\n"
    )
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

/// Figures are drawn in dark ink on white. Where the page is dark, their ink, guides and background are those of the page: the
/// selectors name the colours that `whipcord-plot` gives them. On paper everything is light.
const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1d2329; --soft: #56616b; --line: #d5dade; --page: #fff; --band: #f3f5f6; --card: #fff; --grid: #e4e4e4; --guide: #8c8c8c; --link: #0b5c9a; --stress: #0b63a5 }
@media screen and (prefers-color-scheme: dark) { :root { --ink: #e4e8ea; --soft: #a3aeb6; --line: #3a434a; --page: #15191c; --band: #1e2428; --card: #1a1f23; --grid: #39424a; --guide: #8f9aa3; --link: #79b8ea; --stress: #5aa7e0 }
figure svg [fill='#222'], .multiples svg [fill='#222'] { fill: var(--ink) }
figure svg [stroke='#222'], .multiples svg [stroke='#222'] { stroke: var(--ink) }
figure svg [fill='#fff'], .multiples svg [fill='#fff'] { fill: var(--card) }
figure svg [stroke='#fff'], .multiples svg [stroke='#fff'] { stroke: var(--card) }
figure svg [fill='#e4e4e4'], .multiples svg [fill='#e4e4e4'] { fill: var(--grid) }
figure svg [stroke='#e4e4e4'], .multiples svg [stroke='#e4e4e4'] { stroke: var(--grid) }
figure svg [fill='#8c8c8c'], .multiples svg [fill='#8c8c8c'] { fill: var(--guide) }
figure svg [stroke='#8c8c8c'], .multiples svg [stroke='#8c8c8c'] { stroke: var(--guide) } }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, sans-serif }
main { max-width: 74rem; margin: 0 auto; padding: 1.5rem }
h1 { font-size: 1.6rem } h2 { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1.5rem; font-size: 1.3rem } h3 { font-size: 1rem; margin: 1.5rem 0 .3rem }
a { color: var(--link) }
.path, figcaption, .notes, footer { color: var(--soft); font-size: .9rem }
.path { overflow-wrap: anywhere }
.contents { font-size: .9rem; margin: 1.5rem 0 }
.contents p { margin: 0; font-weight: 600 } .contents ul { margin: .3rem 0 0; padding: 0; list-style: none; columns: 18rem }
.contents li { break-inside: avoid; padding: .1rem 0 } .contents .path { display: block; font-size: .8rem }
@media screen and (min-width: 90rem) { main:has(> .contents) { margin-left: max(17rem, calc(50vw - 37rem)) }
.contents { position: fixed; top: 0; left: 0; width: 15rem; max-height: 100vh; overflow-y: auto; padding: 1.5rem; margin: 0; box-sizing: border-box } .contents ul { columns: auto } }
#verdict { border-left: 4px solid var(--stress); background: var(--band); border-radius: 6px; padding: .5rem 1.2rem }
#verdict h2 { margin: .5rem 0 0; border: 0; padding: 0 } #verdict > p { font-size: 1.1rem }
.multiples { list-style: none; margin: 1rem 0; padding: 0; display: grid; grid-template-columns: repeat(auto-fill, minmax(min(20rem, 100%), 1fr)); gap: 1rem }
.multiples li { border: 1px solid var(--line); border-radius: 6px; background: var(--card); padding: .6rem .8rem; min-width: 0 }
.multiples svg { display: block; max-width: 100%; height: auto; margin: .3rem 0 } .multiples p { margin: 0; font-size: .9rem; color: var(--soft) }
.key { display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; list-style: none; margin: .5rem 0; padding: 0; font-size: .9rem } .key span { display: inline-block; width: 1.2rem; height: .25rem; border-radius: 2px; margin-right: .4rem; vertical-align: middle; print-color-adjust: exact }
.scroll { overflow-x: auto }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums }
th, td { padding: .25rem .5rem; text-align: left }
td.n { white-space: nowrap }
thead td, th { border-bottom: 1px solid var(--ink); vertical-align: bottom }
th small { display: block; font-weight: normal; color: var(--soft) }
tbody + tbody { border-top: 1px solid var(--line) }
tbody tr:nth-child(even) { background: var(--band) }
th.n, td.n { text-align: right }
dl { display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: .1rem 1rem; font-size: .9rem }
dt { color: var(--soft) } dd { margin: 0 }
@media (max-width: 40rem) { main { padding: 1rem } dl { grid-template-columns: minmax(0, 1fr) } dd { margin: 0 0 .4rem } #verdict { padding: .3rem .8rem } }
.figures { display: flex; flex-wrap: wrap; gap: 0 1.5rem; align-items: flex-start } .figures figure { min-width: 0 }
figure { margin: 1.5rem 0 }
figure svg { display: block; max-width: 100%; height: auto; background: var(--card); border-radius: 6px; border: 1px solid var(--line) }
@page { margin: 12mm }
@media print { body { font-size: 9.5pt } main { max-width: none; padding: 0 } .contents { margin: 1rem 0 } a { color: inherit; text-decoration: none }
section.case, #accuracy { break-before: page } h1, h2, h3 { break-after: avoid } h2 { margin-top: 0; border-top: 0; padding-top: 0 } figure, .multiples li, tr, #verdict { break-inside: avoid } thead { display: table-header-group } dl { font-size: 8pt } .notes { font-size: 8pt }
.scroll { overflow: visible } table { font-size: 7.5pt } th, td { padding: .1rem .3rem } .multiples { grid-template-columns: repeat(2, 1fr) } figure { margin: .6rem 0 } figure svg { border: 0; max-height: 150mm; margin: 0 auto }
section.case { font-size: 7.5pt; line-height: 1.3 } section.case h2 { font-size: 13pt; margin: 0 } section.case h3 { font-size: 9pt; margin: .5rem 0 .1rem } section.case p, section.case dl, section.case ul { margin: .3rem 0; font-size: 7.5pt } section.case table { font-size: 6.5pt }
section.case .figures { display: grid; grid-template-columns: 1.5fr 1fr; gap: 0 4mm } section.case figcaption { font-size: 6.5pt } section.case figure { margin: .2rem 0 } section.case .path { font-size: 7.5pt } }
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
