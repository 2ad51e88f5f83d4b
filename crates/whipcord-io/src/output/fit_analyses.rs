//! What is said of a fit besides its estimates, as JSON.

use serde_json::{Value, json};
use whipcord_estimation::identification::{
    Analyses, Identified, OverDetermined, Row, Skipped, Worth, best_measurements, worth_by_disk,
};

use super::NonFinite;
use super::json::{length_misses_json, number, numbers, optional};

/// The keys that a fit has besides those of its estimates.
pub(super) fn said(
    found: &Identified,
    analyses: &Analyses,
    names: &[String],
    test_names: &[String],
) -> Result<Value, NonFinite> {
    let path_of = |unknown: usize| found.estimates.get(unknown).map(|of| of.unknown.path());
    let suspects = analyses.suspects.iter().enumerate().map(|(i, suspect)| {
        let path = |name: &str| format!("suspects[{i}].{name}");
        let confirmed = suspect.confirmed.as_ref().map(|of| -> Result<Value, NonFinite> {
            let rms = of.rms_distance.map(|rms| numbers(&path("rms_distance"), &rms));
            Ok(json!({
                "change": number(|| path("confirmed.change"), of.change)?,
                "deviation": optional(|| path("confirmed.deviation"), of.deviation)?,
                "rms_distance": rms.transpose()?,
            }))
        });
        let alike: Vec<Value> = (suspect.alike.iter())
            .map(|(of, same)| json!({ "parameter": of.to_string(), "same_way": same }))
            .collect();
        Ok(json!({
            "alike": alike,
            "parameter": suspect.quantity.to_string(),
            "unit": suspect.quantity.unit(&found.robot),
            "change": number(|| path("change"), suspect.change)?,
            "deviation": number(|| path("deviation"), suspect.deviation)?,
            "share": number(|| path("share"), suspect.share)?,
            "confirmed": confirmed.transpose()?,
        }))
    });
    let repeatability = analyses.repeatability.as_ref().map(|of| -> Result<Value, NonFinite> {
        let side = |name: &str, side: Option<(usize, f64)>| -> Result<Value, NonFinite> {
            let Some((pairs, rms)) = side else { return Ok(Value::Null) };
            let rms = number(|| format!("repeatability.{name}"), rms)?;
            Ok(json!({ "pairs": pairs, "rms_distance": rms }))
        };
        Ok(json!({
            "pairs": of.pairs,
            "rms_distance": number(|| "repeatability.rms_distance".to_owned(), of.rms_distance)?,
            "same_side": side("same_side", of.same_side)?,
            "opposite_sides": side("opposite_sides", of.opposite_sides)?,
        }))
    });
    let drift = analyses.drift.as_ref().map(|of| -> Result<Value, NonFinite> {
        Ok(json!({
            "rows": of.rows,
            "duration": number(|| "drift.duration".to_owned(), of.duration)?,
            "slope": numbers("drift.slope", &of.slope)?,
            "deviation": numbers("drift.deviation", &of.deviation)?,
            "significant": of.is_significant,
        }))
    });
    let profiles = analyses.profiles.iter().enumerate().map(|(i, profile)| {
        let path = |name: &str| format!("profiles[{i}].{name}");
        let column = |k: usize| profile.points.iter().map(|point| point[k]).collect::<Vec<_>>();
        let [least, greatest] = profile.interval;
        Ok(json!({
            "parameter": path_of(profile.unknown),
            "values": numbers(&path("values"), &column(0))?,
            "rise": numbers(&path("rise"), &column(1))?,
            "limit": number(|| path("limit"), profile.limit)?,
            "interval": [
                optional(|| path("interval"), least)?,
                optional(|| path("interval"), greatest)?,
            ],
        }))
    });
    let ladder = analyses.ladder.iter().enumerate().map(|(i, rung)| {
        let path = |name: &str| format!("ladder[{i}].{name}");
        let held = rung.validated.as_ref();
        Ok(json!({
            "parameters": (0..rung.unknowns).map(path_of).collect::<Vec<_>>(),
            "rms_distance": optional(|| path("rms_distance"), rung.rms_distance)?,
            "rms_pixels": optional(|| path("rms_pixels"), rung.rms_pixels)?,
            "held_out_rms_distance":
                optional(|| path("held_out"), held.and_then(|of| of.rms_distance))?,
            "held_out_rms_pixels":
                optional(|| path("held_out_pixels"), held.and_then(|of| of.rms_pixels))?,
        }))
    });
    let test = analyses.test.as_ref().map(|test| -> Result<Value, NonFinite> {
        let rows = test.rows.iter().map(|(row, rms)| {
            let mut value = row_json(*row, test_names);
            value["rms_distance"] = optional(|| "test.rows".to_owned(), *rms)?;
            Ok(value)
        });
        Ok(json!({
            "rms_distance": optional(|| "test.rms_distance".to_owned(), test.rms_distance)?,
            "median_distance":
                optional(|| "test.median_distance".to_owned(), test.median_distance())?,
            "rms_pixels": optional(|| "test.rms_pixels".to_owned(), test.rms_pixels)?,
            "rows": rows.collect::<Result<Vec<_>, NonFinite>>()?,
            "skipped": rows_json(&test.skipped, test_names),
            "over_determined": over_determined_json(&test.over_determined, test_names),
        }))
    });
    let worth = |worth: &Worth| -> Result<Value, NonFinite> {
        let path = |name: &str| format!("sensitivity.{name}");
        let mut value = row_json(worth.row, names);
        value["disk"] = json!(worth.disk + 1);
        value["arc_length"] = number(|| path("arc_length"), worth.arc_length)?;
        value["variances"] = numbers(&path("variances"), &worth.variances)?;
        value["volume"] = number(|| path("volume"), worth.volume)?;
        Ok(value)
    };
    let best = best_measurements(&analyses.worths).into_iter().map(worth);
    let by_disk = worth_by_disk(&analyses.worths).into_iter().map(|of| {
        let path = |name: &str| format!("sensitivity.by_disk.{name}");
        Ok(json!({
            "disk": of.disk + 1,
            "arc_length": number(|| path("arc_length"), of.arc_length)?,
            "variances": numbers(&path("variances"), &of.variances)?,
            "volume": number(|| path("volume"), of.volume)?,
        }))
    });
    let sensitivity = match analyses.worths.is_empty() {
        true => Value::Null,
        false => json!({
            "best": best.collect::<Result<Vec<_>, NonFinite>>()?,
            "by_disk": by_disk.collect::<Result<Vec<_>, NonFinite>>()?,
        }),
    };
    Ok(json!({
        "suspects": suspects.collect::<Result<Vec<_>, NonFinite>>()?,
        "repeatability": repeatability.transpose()?,
        "drift": drift.transpose()?,
        "profiles": profiles.collect::<Result<Vec<_>, NonFinite>>()?,
        "ladder": ladder.collect::<Result<Vec<_>, NonFinite>>()?,
        "test": test.transpose()?,
        "sensitivity": sensitivity,
    }))
}

fn row_json(row: Row, names: &[String]) -> Value {
    json!({ "case": names.get(row.experiment), "step": row.step + 1 })
}

/// Rows that were left out, each with the reason.
pub(super) fn rows_json(skipped: &[Skipped], names: &[String]) -> Vec<Value> {
    let of = |of: &Skipped| {
        let mut value = row_json(of.row, names);
        value["reason"] = json!(of.reason.to_string());
        value
    };
    skipped.iter().map(of).collect()
}

/// Rows whose cable lengths contradict each other, each with what its cables miss.
pub(super) fn over_determined_json(rows: &[OverDetermined], names: &[String]) -> Vec<Value> {
    let of = |of: &OverDetermined| {
        let mut value = row_json(of.row, names);
        value["misses"] = length_misses_json(&of.misses);
        value
    };
    rows.iter().map(of).collect()
}
