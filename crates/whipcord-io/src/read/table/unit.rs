//! The unit of the numbers in a column.

use crate::source::quoted;
use crate::units::{Dimension, QuantityError, parse_quantity};

/// The unit of the numbers in a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unit {
    /// None where the numbers are in SI.
    pub name: Option<String>,
    pub dimension: Dimension,
}

impl Unit {
    /// That of SI.
    pub fn si(dimension: Dimension) -> Self {
        Self { name: None, dimension }
    }

    /// A unit of one of these dimensions by its name; else what is wrong, and what to do.
    pub fn named(name: &str, dimensions: &[Dimension]) -> Result<Self, (String, String)> {
        let find = |dimension: &Dimension| dimension.find(name).is_some();
        if let Some(dimension) = dimensions.iter().copied().find(find) {
            return Ok(Self { name: Some(name.to_owned()), dimension });
        }
        let kinds: Vec<String> =
            dimensions.iter().map(|d| crate::schema::article(&d.to_string())).collect();
        let names: Vec<String> = dimensions.iter().map(|d| d.unit_names()).collect();
        let message = format!("`{}` is no unit of {}", quoted(name), kinds.join(" or "));
        let near = match parse_quantity(&format!("1 {name}"), dimensions) {
            Err(QuantityError::UnknownUnit { near, .. }) => near.first().map(|unit| unit.name),
            _ => None,
        };
        let help = near.map_or_else(
            || format!("its units are {}", names.join(", ")),
            |near| format!("did you mean `{near}`?"),
        );
        Err((message, help))
    }

    /// The number of SI units that a cell says; `None` where it is no finite number.
    pub fn in_si(&self, text: &str) -> Option<f64> {
        let plain = text.parse::<f64>().ok().filter(|number| number.is_finite())?;
        match &self.name {
            None => Some(plain),
            // The decimal digits are shifted, so that 0.3 mm is the very number that 0.0003 m is.
            Some(name) => parse_quantity(&format!("{text} {name}"), &[self.dimension])
                .ok()
                .map(|(value, _)| value),
        }
    }
}
