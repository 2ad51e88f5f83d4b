//! What measurements cannot tell apart, in words.

use core::fmt;

use super::experiment::{Experiment, Unknown};
use crate::uncertainty::Weak;

/// Unknowns that can change together so that little or nothing of what was seen changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Unresolved {
    /// The unknowns, and by how much each changes.
    pub shares: Vec<Share>,
    /// By how much less sure they are than each would be if it alone were not known; none where nothing
    /// at all is seen of such a change.
    pub collinearity: Option<f64>,
}

/// One of the unknowns that change together.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// Its number.
    pub unknown: usize,
    /// Its path, with the case that it belongs to where it is not of all.
    pub name: String,
    /// Its change, to a scale that all have in common.
    pub change: f64,
    /// Whether the change is a fraction of the estimate, else in its unit.
    pub is_relative: bool,
}

/// Shares below this part of the largest are left out.
const SMALL: f64 = 0.02;

impl Unresolved {
    /// `scales` are changes of the unknowns that matter: their estimates where `is_relative`.
    pub(super) fn of(
        weak: &Weak,
        experiments: &[Experiment],
        unknowns: &[Unknown],
        values: &[f64],
        scales: &[f64],
    ) -> Self {
        let sizes = weak.direction.iter().zip(scales).map(|(change, scale)| (change / scale).abs());
        let largest = sizes.clone().fold(0.0, f64::max);
        let shares = sizes
            .enumerate()
            .filter(|(_, size)| *size > SMALL * largest)
            .map(|(j, _)| {
                let is_relative = unknowns[j].is_positive() && values[j] > 0.0;
                let unit = if is_relative { values[j] } else { 1.0 };
                Share {
                    unknown: j,
                    name: named(&unknowns[j], experiments),
                    // To scale: the largest is what matters, or 1 % of itself.
                    change: 0.01 * weak.direction[j] / largest / unit,
                    is_relative,
                }
            })
            .collect();
        Self { shares, collinearity: weak.collinearity }
    }
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.path())?;
        match self.experiment {
            Some(experiment) => write!(f, " (case {})", experiment + 1),
            None => Ok(()),
        }
    }
}

/// As it is displayed, with the name of its experiment where that has one.
fn named(unknown: &Unknown, experiments: &[Experiment]) -> String {
    match unknown.experiment.and_then(|e| experiments.get(e)) {
        Some(of) if !of.name.is_empty() => format!("{} ({})", unknown.path(), of.name),
        _ => unknown.to_string(),
    }
}

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hardly = self.collinearity.is_some();
        match &self.shares[..] {
            [one] => {
                return write!(f, "nothing that was measured depends on {}", one.name);
            }
            [a, b] if a.is_relative && b.is_relative => {
                let only = if hardly { "hardly more than" } else { "only" };
                write!(f, "{only} {} is seen, not the two by themselves", Product(a, b))?;
            }
            shares => {
                let anything = if hardly { "hardly anything" } else { "nothing" };
                write!(f, "{anything} that was measured changes when")?;
                // The first one grows.
                let sign = shares.first().map_or(1.0, |first| first.change.signum());
                for (i, share) in shares.iter().enumerate() {
                    let separator = match i {
                        0 => "",
                        _ if i + 1 == shares.len() => " and",
                        _ => ",",
                    };
                    let change = sign * share.change;
                    let verb = if change < 0.0 { "falls" } else { "grows" };
                    let size = change.abs();
                    match share.is_relative {
                        true => {
                            write!(f, "{separator} {} {verb} by {:.2} %", share.name, 100.0 * size)?
                        }
                        false => write!(f, "{separator} {} {verb} by {size:.2e}", share.name)?,
                    }
                }
            }
        }
        match self.collinearity {
            Some(times) => {
                write!(f, " (together they are {times:.0} times less sure than each alone)")
            }
            None => Ok(()),
        }
    }
}

/// What of two positive unknowns is seen: the product of powers that does not change with them.
struct Product<'a>(&'a Share, &'a Share);

impl fmt::Display for Product<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(a, b) = self;
        // a^p b^q with p ȧ + q ḃ = 0, the power that is nearer to nought at 1.
        let (first, second, power) = if a.change.abs() >= b.change.abs() {
            (a, b, -a.change / b.change)
        } else {
            (b, a, -b.change / a.change)
        };
        let raised = |power: f64| {
            let whole = power.round();
            match ((power - whole).abs() < 0.05, whole as i64) {
                (true, 1) => String::new(),
                (true, whole) => format!("^{whole}"),
                _ => format!("^{power:.2}"),
            }
        };
        let (what, sign) = if power > 0.0 { ("product", "·") } else { ("quotient", "/") };
        write!(f, "the {what} {} {sign} {}{}", first.name, second.name, raised(power.abs()))
    }
}
