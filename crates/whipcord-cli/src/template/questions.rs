//! The questions for a template.

use std::io::{self, BufRead, Write};

use whipcord::robot::limits::{LENGTH, MODULUS, Range};
use whipcord_io::{Dimension, parse_quantity};

use super::{Given, Kind, MATERIALS, Material, Plan};

/// Why there is no template.
#[derive(Debug)]
pub enum Unanswered {
    /// The input ended before the last question.
    Ended,
    /// The terminal cannot be read or written.
    Broken(io::Error),
}

impl From<io::Error> for Unanswered {
    fn from(error: io::Error) -> Self {
        Self::Broken(error)
    }
}

/// Maximum number of disks, because a list of holes has one entry for each.
const MOST_DISKS: usize = 100;
/// Maximum diameter relative to the length: the backbone must be slender, and a strip must close around a ball.
const THICKEST: f64 = 0.1;
const THICKEST_STRIP: f64 = 0.02;

/// Repeats each question until the answer is valid; an empty answer selects the default in brackets.
///
/// # Errors
/// [`Unanswered`] when the input ends first.
pub fn ask(input: &mut impl BufRead, output: &mut impl Write) -> Result<Plan, Unanswered> {
    let kinds = Kind::ALL.map(Kind::name).join(", ");
    let kind = one(input, output, &format!("Kind ({kinds})"), Kind::Arm.name(), |text| {
        let found = Kind::ALL.into_iter().find(|kind| kind.name().eq_ignore_ascii_case(text));
        found.ok_or_else(|| format!("`{text}` is not one of {kinds}"))
    })?;
    let default = kind.plan();
    let length = one(input, output, "Length of the backbone", &default.length.text, |text| {
        quantity(text, Dimension::Length, LENGTH, "a length with a unit, such as 180 mm")
    })?;
    let (thickest, name) = match kind {
        Kind::Gripper => (THICKEST_STRIP * length.value, "strip"),
        _ => (THICKEST * length.value, "backbone"),
    };
    let diameter = one(input, output, kind.diameter_name(), &default.diameter.text, |text| {
        let diameter =
            quantity(text, Dimension::Length, LENGTH, "a length with a unit, such as 1.5 mm")?;
        if diameter.value <= thickest {
            return Ok(diameter);
        }
        let thickest = super::millimetres(thickest);
        Err(format!("a {name} of this length is at most {} thick", thickest.trim_matches('"')))
    })?;
    let names = MATERIALS.map(|(name, ..)| name).join(", ");
    let material = MATERIALS.into_iter().find(|(_, name, ..)| *name == default.material.name);
    let material = material.map_or("1 GPa", |(name, ..)| name);
    let question = format!("Material ({names}) or Young's modulus");
    let material = one(input, output, &question, material, |text| match Material::named(text) {
        Some(material) => Ok(material),
        None if !text.starts_with(|c: char| c.is_ascii_digit()) => Err(format!(
            "`{text}` is not one of {names}: give one of them, or Young's modulus such as 60 GPa"
        )),
        None => quantity(
            text,
            Dimension::Pressure,
            MODULUS,
            "Young's modulus with a unit, such as 60 GPa",
        )
        .map(Material::of_modulus),
    })?;
    let disks = one(input, output, "Number of disks", &default.disks.to_string(), |text| {
        count(text, kind.least_disks(), MOST_DISKS)
    })?;
    let cables = one(input, output, "Number of cables", &default.cables.to_string(), |text| {
        count(text, 1, kind.most_cables())
    })?;
    Ok(Plan { kind, length, diameter, material, disks, cables })
}

/// Asks one question until its answer is valid.
fn one<T>(
    input: &mut impl BufRead,
    output: &mut impl Write,
    question: &str,
    default: &str,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<T, Unanswered> {
    loop {
        write!(output, "{question} [{default}]: ")?;
        output.flush()?;
        let mut line = String::new();
        if input.read_line(&mut line)? == 0 {
            writeln!(output)?;
            return Err(Unanswered::Ended);
        }
        let answer = match line.trim() {
            "" => default,
            answer => answer,
        };
        match parse(answer) {
            Ok(value) => return Ok(value),
            Err(message) => writeln!(output, "  {message}")?,
        }
    }
}

fn quantity(text: &str, of: Dimension, range: Range, expected: &str) -> Result<Given, String> {
    let (value, _) =
        parse_quantity(text, &[of]).map_err(|error| format!("{error}: give {expected}"))?;
    match range.problem(value) {
        None => Ok(Given { text: text.to_owned(), value }),
        Some(problem) => Err(format!("`{text}` {problem}")),
    }
}

fn count(text: &str, least: usize, most: usize) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (least..=most).contains(count));
    count.ok_or_else(|| format!("give a whole number from {least} to {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(answers: &str) -> (Result<Plan, Unanswered>, String) {
        let mut output = Vec::new();
        let plan = ask(&mut answers.as_bytes(), &mut output);
        (plan, String::from_utf8(output).unwrap_or_default())
    }

    #[test]
    fn empty_answers_are_the_defaults() {
        for kind in Kind::ALL {
            let (plan, asked) = answered(&format!("{}\n\n\n\n\n\n", kind.name()));
            assert_eq!(plan.ok(), Some(kind.plan()), "{asked}");
        }
        assert_eq!(answered("\n\n\n\n\n\n").0.ok(), Some(Kind::Arm.plan()));
    }

    #[test]
    fn wrong_answers_are_asked_again_with_the_reason() {
        let answers = "leg\nARM\n180\n18 N\n-18 cm\n18 cm\n2 cm\n1/8 in\n0.125 in\nrubber\n2 N\n2 GPa\n1\nten\n10\n13\n4\n";
        let (plan, asked) = answered(answers);
        let plan = plan.ok();
        let given = |text: &str, value| Given { text: text.to_owned(), value };
        let expected = Plan {
            kind: Kind::Arm,
            length: given("18 cm", 0.18),
            diameter: given("0.125 in", 0.003175),
            material: Material::of_modulus(given("2 GPa", 2e9)),
            disks: 10,
            cables: 4,
        };
        assert_eq!(plan, Some(expected), "{asked}");
        for reason in [
            "`leg` is not one of arm, helical, tapered, gripper",
            "`180` has no unit: give a length with a unit, such as 180 mm",
            "`N` is a unit of force",
            "`-18 cm` must be greater than zero",
            "a backbone of this length is at most 18 mm thick",
            "`rubber` is not one of nitinol",
            "give a whole number from 3 to 100",
            "give a whole number from 1 to 12",
        ] {
            assert!(asked.contains(reason), "{reason:?} is not in\n{asked}");
        }
    }

    #[test]
    fn the_end_of_the_input_ends_the_questions() {
        for answers in ["", "arm\n", "arm\n\n\n\n\n"] {
            assert!(matches!(answered(answers).0, Err(Unanswered::Ended)), "{answers:?}");
        }
    }
}
