//! Warnings about a fit that come from its analyses, and what is said of repeatability.

use whipcord::Robot;
use whipcord_estimation::identification::{Analyses, Quantity, Suspect};

use super::tables::shown;
use crate::quantity::number;
use crate::remark::Remark;

/// What one cable explains is spoken of from this part of the length of the backbone on: 0.1 mm of 200 mm. Below, other parts of a real robot
/// are off by as much.
const LEAST: f64 = 5e-4;

/// The warning where the zero or the angle of this cable of a robot stands out.
pub(crate) fn stands_out(suspect: &Suspect, robot: &Robot) -> Option<Remark> {
    let length = robot.backbone().length;
    let confirmed = suspect.confirmed.as_ref()?;
    if let Some([before, after]) = confirmed.rms_distance
        && before * before - after * after < (LEAST * length) * (LEAST * length)
    {
        return None;
    }
    let (scale, unit) = shown(suspect.quantity.unit(robot));
    let within = match confirmed.deviation {
        Some(deviation) => format!(" ± {}", number(deviation * scale, 2)),
        None => String::new(),
    };
    let gain = match confirmed.rms_distance {
        Some([before, after]) => format!(
            "an estimate of it lowers the RMS distance from {} mm to {} mm",
            number(before * 1e3, 3),
            number(after * 1e3, 3)
        ),
        None => format!("it explains {} % of what is left", number(suspect.share * 100.0, 2)),
    };
    let instead: Vec<String> = (suspect.alike.iter())
        .map(|(quantity, same)| {
            format!("{quantity} {}", if *same { "as much" } else { "as much the other way" })
        })
        .collect();
    let instead = match instead.as_slice() {
        [] => String::new(),
        all => format!(", or {}, which the measurements hardly tell apart", all.join(", or ")),
    };
    let message = format!(
        "{} stands out from the other cables: it is {}{within} {unit} off what the file says{instead}, and {gain}",
        suspect.quantity,
        number(confirmed.change * scale, 3),
    );
    Some(Remark { code: "single-cable", message, help: help(suspect) })
}

const fn help(suspect: &Suspect) -> &'static str {
    match suspect.quantity {
        Quantity::Parameter(_) => {
            "check where the holes of this cable are, or estimate its angle too"
        }
        _ => "check the zero of its motor and its clamp, or estimate its offset too",
    }
}

/// The warning where what is left changes with time.
pub fn drifts(analyses: &Analyses) -> Option<Remark> {
    let drift = analyses.drift.as_ref().filter(|drift| drift.is_significant)?;
    let each: Vec<String> = drift
        .slope
        .iter()
        .zip(drift.deviation)
        .map(|(slope, deviation)| {
            let mm = |value: f64, digits| number(value * drift.duration * 1e3, digits);
            format!("{} ± {}", mm(*slope, 2), mm(deviation, 2))
        })
        .collect();
    let message = format!(
        "what is left changes with time: by {} mm in x, y and z over the {} s of {} rows",
        each.join(", "),
        number(drift.duration, 3),
        drift.rows
    );
    Some(Remark {
        code: "drift",
        message,
        help: "look for cables that creep, a base that moves or a tracker that warms up; fit the parts of the log separately",
    })
}

/// How far the robot is from itself, in words.
pub fn repeats(analyses: &Analyses) -> Option<String> {
    let of = analyses.repeatability.as_ref()?;
    let mm = |value: f64| number(value * 1e3, 3);
    let pairs =
        |count: usize| if count == 1 { "1 pair".to_owned() } else { format!("{count} pairs") };
    let mut text = format!(
        "repeatability: {} mm RMS about the mean of equal or nearly equal commands ({} of rows); no model without history comes \
         nearer to new measurements",
        mm(of.rms_distance),
        pairs(of.pairs)
    );
    let side = |side: Option<(usize, f64)>, name: &str| {
        side.map(|(count, rms)| {
            format!("{} mm between {} approached from {name}", mm(rms), pairs(count))
        })
    };
    let sides: Vec<String> =
        [side(of.same_side, "the same side"), side(of.opposite_sides, "opposite sides")]
            .into_iter()
            .flatten()
            .collect();
    if !sides.is_empty() {
        text += &format!("; {}", sides.join(", "));
    }
    Some(text)
}
