//! The benchmarks in a report.

use super::results::Results;
use super::{summary, tables};
use crate::html::{Figure, escape, list};

/// Which model to use for what; nothing where that cannot be said.
pub fn recommendation(results: &Results) -> String {
    let recommendation = results.recommendation();
    if recommendation.is_empty() {
        return String::new();
    }
    let mut html = String::from("<h3>Which model for what</h3>\n<dl>\n");
    for finding in &recommendation {
        let (topic, text) = (finding.topic.words(), escape(&finding.text));
        html += &format!("<dt>{topic}</dt><dd>{text}</dd>\n");
    }
    html + "</dl>\n"
}

/// How the models did: tables and picture.
pub fn section(results: &Results, pareto: Option<&Figure>) -> String {
    let mut html = String::from("<section id=\"accuracy\"><h2>Accuracy and time</h2>\n");
    html += &tables::standings(results).html();
    html += &list(&tables::notes(results));
    html += &pareto.map(Figure::html).unwrap_or_default();
    for (heading, table) in summary::tables(&results.benchmarks, &results.candidates) {
        html += &format!("<h3>{}</h3>\n{}", escape(&heading), table.html());
    }
    html += "<h3>Case by case</h3>\n";
    html += &tables::entries(&results.benchmarks).html();
    if !results.cut.is_empty() {
        html += "<h3>The same robots cut into many sections</h3>\n";
        html += &tables::entries(&results.cut).html();
    }
    html + "</section>\n"
}
