//! Elements of XML, whose attributes the library escapes.

use core::fmt::Display;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use whipcord::Vec3;

use crate::error::ExportError;

/// An element with what is in it.
#[derive(Clone, Debug, Default)]
pub struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Self>,
    text: String,
}

impl Element {
    /// An empty element.
    pub fn new(name: &'static str) -> Self {
        Self { name, ..Self::default() }
    }

    /// With an attribute.
    pub fn with(mut self, key: &'static str, value: impl Display) -> Self {
        self.attributes.push((key, value.to_string()));
        self
    }

    /// With an attribute of numbers, which are read back to the last bit.
    pub fn with_numbers(self, key: &'static str, values: &[f64]) -> Self {
        self.with(key, numbers(values))
    }

    /// With a vector as attribute.
    pub fn with_vector(self, key: &'static str, value: Vec3) -> Self {
        self.with_numbers(key, &value.to_array())
    }

    /// With this text in it.
    pub fn holding(mut self, text: String) -> Self {
        self.text = text;
        self
    }

    /// With an element in it.
    pub fn and(mut self, child: Self) -> Self {
        self.children.push(child);
        self
    }

    /// With elements in it.
    pub fn and_all(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        self.children.extend(children);
        self
    }

    /// Puts an element into it.
    pub fn push(&mut self, child: Self) {
        self.children.push(child);
    }

    /// Whether nothing is in it.
    pub fn is_empty(&self) -> bool {
        self.children.is_empty() && self.text.is_empty()
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) -> std::io::Result<()> {
        let mut start = BytesStart::new(self.name);
        for (key, value) in &self.attributes {
            start.push_attribute((*key, value.as_str()));
        }
        if self.is_empty() {
            return writer.write_event(Event::Empty(start));
        }
        writer.write_event(Event::Start(start))?;
        if !self.text.is_empty() {
            writer.write_event(Event::Text(BytesText::new(&self.text)))?;
        }
        for child in &self.children {
            child.write(writer)?;
        }
        writer.write_event(Event::End(BytesEnd::new(self.name)))
    }

    /// A document of this element.
    ///
    /// # Errors
    /// [`ExportError::Unwritten`] when memory for it cannot be had.
    pub fn document(&self) -> Result<Vec<u8>, ExportError> {
        let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
        let written = writer
            .write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))
            .and_then(|()| self.write(&mut writer));
        written.map_err(|error| ExportError::Unwritten { reason: error.to_string() })?;
        let mut bytes = writer.into_inner();
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// Numbers with spaces between them.
pub fn numbers(values: &[f64]) -> String {
    // Other than with `Display`, very small and very large ones have an exponent.
    values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(" ")
}

/// Refuses names that no XML can hold, or that a parser would change.
///
/// # Errors
/// [`ExportError::Name`] for an empty name and for one with control characters.
pub fn check_name(name: &str) -> Result<(), ExportError> {
    let is_bad = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    match name.is_empty() || name.contains(is_bad) {
        true => Err(ExportError::Name { name: name.to_owned() }),
        false => Ok(()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let name = r#"a<b>&"c'd"#;
        let inner = Element::new("inner").with_numbers("at", &[1e-300, -0.1, 3.0]);
        let bytes = Element::new("outer")
            .with("name", name)
            .and(inner)
            .and(Element::new("text").holding("1 < 2".to_owned()))
            .document()
            .unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("name"), Some(name));
        let at = root.first_element_child().unwrap().attribute("at").unwrap();
        let numbers: Vec<f64> = at.split(' ').map(|part| part.parse().unwrap()).collect();
        assert_eq!(numbers, [1e-300, -0.1, 3.0]);
        assert_eq!(root.last_element_child().unwrap().text(), Some("1 < 2"));
    }

    #[test]
    fn names_that_cannot_be_are_refused() {
        for name in ["", "a\nb", "\u{1}", "\u{ffff}"] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
        for name in ["pull", "<&>", "Zug 1", "ü\u{1f600}"] {
            assert!(check_name(name).is_ok(), "{name:?}");
        }
    }
}
