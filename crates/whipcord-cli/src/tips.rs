//! What to write instead of options that there are not.

use std::ffi::OsString;

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use whipcord_io::load;

/// Names of keys of the robot file that may be taken for options, the path of each, and a unit for a number without one.
const KEYS: [(&[&str], &str, &str); 10] = [
    (&["--tension", "--tensions"], "cables.NAME.tension", "N"),
    (&["--shortening", "--shortenings"], "cables.NAME.shortening", "mm"),
    (&["--friction"], "cables.NAME.friction", ""),
    (&["--length"], "backbone.length", "mm"),
    (&["--diameter"], "backbone.diameter", "mm"),
    (&["--young-modulus", "--youngs-modulus", "--E"], "backbone.young_modulus", "GPa"),
    (&["--poisson-ratio", "--nu"], "backbone.poisson_ratio", ""),
    (&["--gravity"], "loads.gravity", ""),
    (&["--tip-force", "--force", "--load"], "loads.tip_force", ""),
    (&["--tip-moment", "--moment"], "loads.tip_moment", ""),
];
/// Verbs that take `--set`.
const VERBS: [&str; 8] =
    ["solve", "stiffness", "compare", "bench", "overlay", "check", "score", "fit"];

/// The message for an option that is a key of the robot file.
pub fn for_unknown(error: &Error, arguments: &[OsString]) -> Option<String> {
    if error.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidArg) else { return None };
    let option = given.split_once('=').map_or(given.as_str(), |(option, _)| option);
    let (_, path, unit) = KEYS.into_iter().find(|(names, ..)| names.contains(&option))?;
    let verb = arguments.get(1)?.to_str()?;
    if !VERBS.contains(&verb) {
        return Some(format!(
            "error: there is no option `{option}`\n  tip: write the value into the robot file"
        ));
    }
    // The first cable of the first robot file that can be read.
    let files = arguments.iter().skip(2).filter(|file| file.to_string_lossy().ends_with(".toml"));
    let robot = files.filter_map(|file| load(file).ok()).next();
    let cable = robot.and_then(|file| Some(file.robot.cables().first()?.name.clone()));
    let path = path.replace("NAME", cable.as_deref().unwrap_or("NAME"));
    let value = value(option, arguments);
    let value = match value.as_deref() {
        None => "VALUE".to_owned(),
        Some(number) if !unit.is_empty() && number.parse::<f64>().is_ok() => {
            format!("{number} {unit}")
        }
        Some(value) => value.to_owned(),
    };
    Some(format!(
        "error: there is no option `{option}`\n  tip: set a key of the robot file: whipcord {verb} ... --set {path}=\"{value}\""
    ))
}

/// What was given to the option.
fn value(option: &str, arguments: &[OsString]) -> Option<String> {
    let texts: Vec<_> = arguments.iter().map(|argument| argument.to_string_lossy()).collect();
    let prefix = format!("{option}=");
    if let Some(joined) = texts.iter().find_map(|text| text.strip_prefix(&prefix)) {
        return Some(joined.to_owned());
    }
    let at = texts.iter().position(|text| text == option)?;
    let next = texts.get(at + 1)?;
    (!next.starts_with("--") && !next.ends_with(".toml")).then(|| next.clone().into_owned())
}
