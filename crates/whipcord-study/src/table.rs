//! Tables for people: as text and as HTML.

use crate::html::escape;
use crate::style::Style;

/// How a column is aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// Columns with headings, and rows in groups.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<(String, Align)>,
    /// Unit of each column, where one is given.
    units: Vec<&'static str>,
    groups: Vec<Vec<Vec<String>>>,
}

impl Table {
    /// A table without rows.
    pub fn new<S: Into<String>>(columns: impl IntoIterator<Item = (S, Align)>) -> Self {
        let columns = columns.into_iter().map(|(name, align)| (name.into(), align)).collect();
        Self { columns, units: Vec::new(), groups: Vec::new() }
    }

    /// The same table with the units of its columns, from the first on. Pages show them below the headings; in
    /// text, where there is no room, a note has to say them.
    pub fn with_units(self, units: impl IntoIterator<Item = &'static str>) -> Self {
        Self { units: units.into_iter().collect(), ..self }
    }

    /// Starts a group of rows, which a line sets off from the one before.
    pub fn group(&mut self) {
        self.groups.push(Vec::new());
    }

    /// Adds a row to the last group. Missing cells stay empty.
    pub fn row(&mut self, cells: Vec<String>) {
        match self.groups.last_mut() {
            Some(group) => group.push(cells),
            None => self.groups.push(vec![cells]),
        }
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.groups.iter().all(Vec::is_empty)
    }

    /// As text, each line ended.
    pub fn text(&self, style: Style) -> String {
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|i| {
                let cells = self.groups.iter().flatten().filter_map(|row| row.get(i));
                cells.chain([&self.columns[i].0]).map(|cell| width(cell)).max().unwrap_or(0)
            })
            .collect();
        let headings: Vec<String> = self.columns.iter().map(|(name, _)| name.clone()).collect();
        let rule =
            style.faint(widths.iter().map(|&w| "─".repeat(w)).collect::<Vec<_>>().join("──"));
        let mut text = style.heading(self.line(&headings, &widths)) + "\n";
        for group in &self.groups {
            text += &rule;
            text.push('\n');
            for row in group {
                text += &self.line(row, &widths);
                text.push('\n');
            }
        }
        text
    }

    fn line(&self, cells: &[String], widths: &[usize]) -> String {
        let mut line = String::new();
        for (i, &column) in widths.iter().enumerate() {
            let cell = cells.get(i).map_or("", String::as_str);
            let padding = " ".repeat(column - width(cell));
            if i > 0 {
                line += "  ";
            }
            match self.columns[i].1 {
                Align::Left => line = line + cell + &padding,
                Align::Right => line = line + &padding + cell,
            }
        }
        line.trim_end().to_owned()
    }

    /// As an HTML table.
    pub fn html(&self) -> String {
        let cell = |tag: &str, i: usize, text: &str| {
            let class = if self.columns[i].1 == Align::Right { " class=\"n\"" } else { "" };
            format!("<{tag}{class}>{}</{tag}>", escape(text))
        };
        let mut html = String::from(
            "<div class=\"scroll\" role=\"group\" tabindex=\"0\" aria-label=\"Table\"><table>\n<thead><tr>",
        );
        for (i, (name, _)) in self.columns.iter().enumerate() {
            let unit = match self.units.get(i) {
                Some(unit) if !unit.is_empty() => format!("<small>{}</small>", escape(unit)),
                _ => String::new(),
            };
            // A column without a name has no heading.
            let tag = if name.is_empty() && unit.is_empty() { "td" } else { "th" };
            let heading = cell(tag, i, name);
            html += &heading.replace(&format!("</{tag}>"), &format!("{unit}</{tag}>"));
        }
        html += "</tr></thead>\n";
        for group in &self.groups {
            html += "<tbody>\n";
            for row in group {
                html += "<tr>";
                for i in 0..self.columns.len() {
                    html += &cell("td", i, row.get(i).map_or("", String::as_str));
                }
                html += "</tr>\n";
            }
            html += "</tbody>\n";
        }
        html + "</table></div>\n"
    }
}

/// Columns that a text takes on a terminal; the texts here hold no wide characters.
fn width(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new([("case", Align::Left), ("µs", Align::Right)]);
        table.group();
        table.row(vec!["I".into(), "3.1".into()]);
        table.group();
        table.row(vec!["<II>".into()]);
        table
    }

    #[test]
    fn columns_line_up() {
        let expected = "case   µs\n─────────\nI     3.1\n─────────\n<II>\n";
        assert_eq!(table().text(Style::default()), expected);
    }

    #[test]
    fn html_is_escaped() {
        let html = table().html();
        assert!(html.contains("&lt;II&gt;") && html.contains("<td class=\"n\">3.1</td>"));
    }

    #[test]
    fn pages_have_the_units_in_the_headings() {
        let html = table().with_units(["", "mm"]).html();
        assert!(html.contains("<th>case</th><th class=\"n\">µs<small>mm</small></th>"), "{html}");
    }
}
