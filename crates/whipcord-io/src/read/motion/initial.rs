//! Where a motion starts: by a word, or in a state that was kept.

use serde_json::Value;
use whipcord::{Twist, Vec3};
use whipcord_motion::{Initial, Start, StartRates};

use super::Reader;
use crate::check::{Data, Fields};
use crate::files;
use crate::source::Sources;

/// A motion of a million numbers takes about 20 MB.
const LARGEST: usize = 1 << 28;
const KEY: &str = "motion.initial";
const REMEDY: &str =
    "name a file that `whipcord simulate --json` wrote, or motion.json of its folder";

/// Reads the key; `None` where it is not given or refused.
pub(super) fn initial(
    table: &Fields,
    sources: &mut Sources,
    reader: &mut Reader<'_>,
) -> Option<Initial> {
    match table.data("initial")? {
        Data::Text(word) if word == "equilibrium" => Some(Initial::Equilibrium),
        Data::Text(word) if word == "rest" => Some(Initial::Rest),
        Data::Text(named) => from_file(named, sources, reader),
        Data::Table(fields) => {
            let numbers = |key: &str| fields.numbers(key).unwrap_or_default();
            let lists = |key: &str| lists(fields.list(key));
            Some(Initial::State(Box::new(Start {
                velocities: of_rows(fields.list("velocities")),
                strains: of_rows(fields.list("strains")),
                tensions: numbers("tensions"),
                motor_outputs: numbers("motor_outputs"),
                motors: rows(fields.list("motors")).collect(),
                passage_tensions: lists("passage_tensions"),
                lengths_beyond: lists("lengths_beyond"),
                rates: fields.table("rates").map(|rates| StartRates {
                    velocities: of_rows(rates.list("velocities")),
                    strains: of_rows(rates.list("strains")),
                    motors: rows(rates.list("motors")).collect(),
                    step: rates.number("step").unwrap_or_default(),
                    commands: rates.numbers("commands").unwrap_or_default(),
                    loads: rates.vector("loads").unwrap_or_default(),
                }),
            })))
        }
        _ => None,
    }
}

fn of_rows(list: Option<&[Data]>) -> Vec<Twist> {
    rows(list).map(twist).collect()
}

/// Rows of `N` numbers.
fn rows<const N: usize>(list: Option<&[Data]>) -> impl Iterator<Item = [f64; N]> {
    list.unwrap_or_default().iter().filter_map(|row| {
        let numbers: Vec<f64> = row.as_list()?.iter().filter_map(Data::as_number).collect();
        numbers.as_array::<N>().copied()
    })
}

/// Lists of numbers.
fn lists(list: Option<&[Data]>) -> Vec<Vec<f64>> {
    let of = |row: &Data| Some(row.as_list()?.iter().filter_map(Data::as_number).collect());
    list.unwrap_or_default().iter().filter_map(of).collect()
}

fn twist([a, b, c, d, e, f]: [f64; 6]) -> Twist {
    Twist { linear: Vec3::new(a, b, c), angular: Vec3::new(d, e, f) }
}

/// The last state of a motion in a file.
fn from_file(named: &str, sources: &mut Sources, reader: &mut Reader<'_>) -> Option<Initial> {
    let span = reader.document.locate(KEY).span;
    let path = sources.resolve(span.file, named);
    if !path.exists() {
        let message = format!(
            "`{}` is neither `equilibrium` nor `rest`, and there is no such file",
            crate::source::quoted(named)
        );
        reader.tell(
            KEY,
            message,
            "write \"equilibrium\", \"rest\" or the path of a motion in JSON",
        );
        return None;
    }
    let (_, text) = files::read_named(&path, LARGEST, span, sources, reader.problems)?;
    let found = serde_json::from_str(&text)
        .map_err(|error| format!("the file is not JSON: {error}"))
        .and_then(|json: Value| start(&json).map_err(str::to_owned));
    match found {
        Ok(start) => Some(Initial::State(Box::new(start))),
        Err(message) => {
            reader.tell(KEY, message, REMEDY);
            None
        }
    }
}

/// What a motion starts with that goes on from the last state of another one.
fn start(json: &Value) -> Result<Start, &'static str> {
    let states = json.get("states").and_then(Value::as_array);
    let state = match states {
        Some(states) => states.last().ok_or("the motion in the file has no states")?,
        None => return Err("the file holds no motion: it has no `states`"),
    };
    let number = |value: &Value| value.as_f64().filter(|number| number.is_finite());
    let numbers = |value: &Value| value.as_array()?.iter().map(number).collect::<Option<Vec<_>>>();
    let twists_of = |of: &Value, key: &str| {
        let rows = of.get(key)?.as_array()?;
        let six = |row: &Value| numbers(row)?.as_array::<6>().copied().map(twist);
        rows.iter().map(six).collect::<Option<Vec<_>>>()
    };
    let twists = |key: &str| twists_of(state, key);
    let motors = || {
        let motors = state.get("motors")?.as_array()?;
        let of = |motor: &Value, key: &str| number(motor.get(key)?);
        let three = |motor: &Value| {
            Some([of(motor, "position")?, of(motor, "velocity")?, of(motor, "integral")?])
        };
        motors.iter().map(three).collect::<Option<Vec<_>>>()
    };
    let tensions = || {
        let cables = state.get("cables")?.as_array()?;
        cables.iter().map(|cable| number(cable.get("tension")?)).collect::<Option<Vec<_>>>()
    };
    // Motions of robots without friction, and older files, have none.
    let of_passages = |key: &str| {
        let cables = state.get("cables")?.as_array()?;
        cables.iter().map(|cable| numbers(cable.get(key)?)).collect::<Option<Vec<_>>>()
    };
    let rates = || {
        let rates = state.get("rates")?;
        let of_motors = rates.get("motors")?.as_array()?.iter();
        let three = |motor: &Value| numbers(motor)?.as_array::<3>().copied();
        Some(StartRates {
            velocities: twists_of(rates, "velocities")?,
            strains: twists_of(rates, "strains")?,
            motors: of_motors.map(three).collect::<Option<Vec<_>>>()?,
            step: number(rates.get("step")?)?,
            commands: numbers(rates.get("commands")?)?,
            loads: numbers(rates.get("loads")?)?.try_into().ok()?,
        })
    };
    Ok(Start {
        velocities: twists("velocities")
            .ok_or("its last state has no `velocities` of six numbers")?,
        strains: twists("strains").ok_or("its last state has no `strains` of six numbers")?,
        tensions: tensions().ok_or("its last state has no tensions of `cables`")?,
        motor_outputs: state.get("motor_outputs").and_then(numbers).unwrap_or_default(),
        motors: motors().unwrap_or_default(),
        passage_tensions: of_passages("passage_tensions").unwrap_or_default(),
        lengths_beyond: of_passages("lengths_beyond").unwrap_or_default(),
        rates: rates(),
    })
}
