//! The report of a score: one HTML file that needs no other and no network.

use super::{Score, tables};
use crate::html::{Figure, escape, footer, list, page};

/// The report, with these pictures.
#[must_use]
pub fn html(score: &Score<'_>, figures: &[Figure], passed_over: &[String]) -> String {
    let mut body = String::from("<h1>Models against measurements</h1>\n");
    body += &section(score, figures);
    body += &list(passed_over);
    body += &footer();
    page("Whipcord: models against measurements", &body)
}

/// What a report says of a score.
#[must_use]
pub fn section(score: &Score<'_>, figures: &[Figure]) -> String {
    let mut body = String::new();
    if let [only] = score.subjects.as_slice() {
        let file = only.file;
        let path = file.path.display().to_string();
        body +=
            &format!("<h2>{}</h2>\n<p class=\"path\">{}</p>\n", escape(&file.title), escape(&path));
    }
    body += &tables::summary(score).html();
    body += &list(&tables::notes(score));
    if let Some(files) = tables::files(score) {
        body += "<h2>Files</h2>\n";
        body += &files.html();
    }
    if let Some(worst) = tables::worst_rows(score) {
        body += "<h2>Worst rows</h2>\n";
        body += &worst.html();
    }
    if !figures.is_empty() {
        body += "<h2>Pictures</h2>\n";
    }
    for figure in figures {
        body += &figure.html();
    }
    body
}
