//! The report: one HTML file that needs no other and no network.

use super::{Fit, tables};
use crate::html::{Figure, escape, footer, list, page};

/// The report of a fit with the pictures of its robots and of what is left.
pub fn html(fit: &Fit, robots: &[Figure], figures: &[Figure]) -> String {
    let mut body = String::from("<h1>Fit</h1>\n");
    body += &format!("<p>{}</p>\n<ul>\n", escape(&tables::heading(fit)));
    for case in &fit.cases {
        let (title, path) = (escape(&case.title), escape(&case.path.display().to_string()));
        body += &format!("<li>{title} <span class=\"path\">{path}</span></li>\n");
    }
    body += "</ul>\n<h2>Estimates</h2>\n";
    body += &tables::estimates(fit).html();
    body += &list(&tables::notes(fit));
    if !robots.is_empty() {
        body += "<h2>Measured and fitted</h2>\n";
    }
    for figure in robots {
        body += &figure.html();
    }
    body += "<h2>Correlations</h2>\n";
    body += &tables::correlations(fit).html();
    for (title, table) in tables::more(fit) {
        if !table.is_empty() {
            body += &format!("<h2>{title}</h2>\n{}", table.html());
        }
    }
    body += "<h2>What is left</h2>\n";
    for figure in figures {
        body += &figure.html();
    }
    body += &footer();
    page("Whipcord: fit", &body)
}
