//! Dimensions and their units.

mod known;
mod quantity;

use core::fmt;

use known::{
    ACCELERATION, ANGLE, ANGULAR_DAMPING, ANGULAR_RATE, ANGULAR_STIFFNESS, BENDING_STIFFNESS,
    CURVATURE, DAMPING, DENSITY, FORCE, FORCE_RATE, INERTIA, LENGTH, LINE_DRAG, LINE_FORCE,
    LINE_MOMENT, LINEAR_DENSITY, MASS, MOMENT, PRESSURE, RATIO, SPEED, TIME,
};
pub use quantity::{QuantityError, parse_quantity, split_quantity};
pub(crate) use quantity::{percent, scaled, with_number};

/// What a quantity measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// In m.
    Length,
    /// In Pa.
    Pressure,
    /// In N.
    Force,
    /// In N·m.
    Moment,
    /// In N/m.
    LineForce,
    /// In N·m/m.
    LineMoment,
    /// In N·m².
    BendingStiffness,
    /// In kg.
    Mass,
    /// In kg/m³.
    Density,
    /// In kg/m.
    LinearDensity,
    /// In rad.
    Angle,
    /// In rad/s.
    AngularRate,
    /// In m/s.
    Speed,
    /// In N/s.
    ForceRate,
    /// In N·s/m²: a force for each metre, by velocity.
    LineDrag,
    /// In kg·m².
    Inertia,
    /// In N·m/rad.
    AngularStiffness,
    /// In N·m·s/rad.
    AngularDamping,
    /// In N·s/m.
    Damping,
    /// In m/s².
    Acceleration,
    /// In 1/m.
    Curvature,
    /// In s.
    Time,
    /// Without a unit.
    Ratio,
}

/// A unit of one dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The spelling that messages use.
    pub name: &'static str,
    /// Other spellings that are understood.
    pub aliases: &'static [&'static str],
    scale: Scale,
}

/// How many SI units one unit is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// A power of ten, applied to the decimal digits, so that `"0.3 mm"` is the very number that
    /// `0.0003` is.
    Ten(i32),
    Factor(f64),
}

impl Dimension {
    /// All dimensions.
    pub const ALL: [Self; 23] = [
        Self::Length,
        Self::Pressure,
        Self::Force,
        Self::Moment,
        Self::LineForce,
        Self::LineMoment,
        Self::BendingStiffness,
        Self::Mass,
        Self::Density,
        Self::LinearDensity,
        Self::Angle,
        Self::AngularRate,
        Self::Speed,
        Self::ForceRate,
        Self::LineDrag,
        Self::Inertia,
        Self::AngularStiffness,
        Self::AngularDamping,
        Self::Damping,
        Self::Acceleration,
        Self::Curvature,
        Self::Time,
        Self::Ratio,
    ];

    /// Its units, the SI unit first (a ratio has only `%`).
    #[must_use]
    pub const fn units(self) -> &'static [Unit] {
        match self {
            Self::Length => LENGTH,
            Self::Pressure => PRESSURE,
            Self::Force => FORCE,
            Self::Moment => MOMENT,
            Self::LineForce => LINE_FORCE,
            Self::LineMoment => LINE_MOMENT,
            Self::BendingStiffness => BENDING_STIFFNESS,
            Self::Mass => MASS,
            Self::Density => DENSITY,
            Self::LinearDensity => LINEAR_DENSITY,
            Self::Angle => ANGLE,
            Self::AngularRate => ANGULAR_RATE,
            Self::Speed => SPEED,
            Self::ForceRate => FORCE_RATE,
            Self::LineDrag => LINE_DRAG,
            Self::Inertia => INERTIA,
            Self::AngularStiffness => ANGULAR_STIFFNESS,
            Self::AngularDamping => ANGULAR_DAMPING,
            Self::Damping => DAMPING,
            Self::Acceleration => ACCELERATION,
            Self::Curvature => CURVATURE,
            Self::Time => TIME,
            Self::Ratio => RATIO,
        }
    }

    /// What a plain number is in.
    #[must_use]
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Ratio => "",
            _ => self.units()[0].name,
        }
    }

    /// A value as people write it.
    #[must_use]
    pub const fn example(self) -> &'static str {
        match self {
            Self::Length => "180 mm",
            Self::Pressure => "1.1 GPa",
            Self::Force => "400 gf",
            Self::Moment => "1 mN*m",
            Self::LineForce => "0.5 N/m",
            Self::LineMoment => "2 mN*m/m",
            Self::BendingStiffness => "0.004 N*m^2",
            Self::Mass => "1.2 g",
            Self::Density => "1040 kg/m^3",
            Self::LinearDensity => "7.4 g/m",
            Self::Angle => "30 deg",
            Self::AngularRate => "90 deg/s",
            Self::Speed => "10 mm/s",
            Self::ForceRate => "2 N/s",
            Self::LineDrag => "0.5 N*s/m^2",
            Self::Inertia => "20 g*cm^2",
            Self::AngularStiffness => "0.5 N*m/rad",
            Self::AngularDamping => "2 mN*m*s/rad",
            Self::Damping => "10 N*s/m",
            Self::Acceleration => "9.81 m/s^2",
            Self::Curvature => "4 1/m",
            Self::Time => "2.2 s",
            Self::Ratio => "5.7 %",
        }
    }

    /// The names of its units in a list for people.
    #[must_use]
    pub fn unit_names(self) -> String {
        listed(self.units().iter().map(|unit| unit.name), "or")
    }

    pub(crate) fn find(self, spelling: &str) -> Option<&'static Unit> {
        self.units().iter().find(|unit| unit.spellings().any(|name| name == spelling))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "length",
            Self::Pressure => "pressure",
            Self::Force => "force",
            Self::Moment => "moment",
            Self::LineForce => "force per length",
            Self::LineMoment => "moment per length",
            Self::BendingStiffness => "bending stiffness",
            Self::Mass => "mass",
            Self::Density => "density",
            Self::LinearDensity => "linear density",
            Self::Angle => "angle",
            Self::AngularRate => "rate of an angle",
            Self::Speed => "speed",
            Self::ForceRate => "rate of a force",
            Self::LineDrag => "drag per length",
            Self::Inertia => "moment of inertia",
            Self::AngularStiffness => "moment per angle",
            Self::AngularDamping => "moment per rate of an angle",
            Self::Damping => "force per speed",
            Self::Acceleration => "acceleration",
            Self::Curvature => "curvature",
            Self::Time => "time",
            Self::Ratio => "ratio",
        })
    }
}

impl Unit {
    /// Every spelling that is understood.
    pub fn spellings(&self) -> impl Iterator<Item = &'static str> + '_ {
        core::iter::once(self.name).chain(self.aliases.iter().copied())
    }

    /// Its name, with what it is where another differs from it in capitals alone.
    pub(crate) fn described(&self) -> String {
        let like =
            |other: &&Unit| other.name != self.name && other.name.eq_ignore_ascii_case(self.name);
        let dimensions = Dimension::ALL.into_iter();
        let ambiguous = dimensions.flat_map(|dimension| dimension.units()).find(like);
        match ambiguous {
            Some(_) => format!("`{}` (10^{} in SI units)", self.name, self.in_si().log10().round()),
            None => format!("`{}`", self.name),
        }
    }

    /// How many SI units it is.
    #[must_use]
    pub fn in_si(&self) -> f64 {
        match self.scale {
            Scale::Ten(exponent) => 10_f64.powi(exponent),
            Scale::Factor(factor) => factor,
        }
    }
}

/// Names in a row: `a, b or c`.
pub(crate) fn listed<'a>(names: impl IntoIterator<Item = &'a str>, last: &str) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_spelling_means_two_things() {
        let mut seen = std::collections::BTreeSet::new();
        for dimension in Dimension::ALL {
            for unit in dimension.units() {
                for name in unit.spellings() {
                    assert!(seen.insert(name), "{name}");
                }
            }
        }
    }
}
