//! Paths that the command line takes.

use std::ffi::OsStr;
use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};

/// Takes a path, in any encoding, whose name ends in one of these.
pub fn path_ending_in(
    extensions: &'static [&'static str],
) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path: PathBuf| {
        let ends = |extension: &OsStr| extensions.iter().any(|e| extension.eq_ignore_ascii_case(e));
        if path.extension().is_some_and(ends) {
            Ok(path)
        } else {
            Err(format!("the name must end in .{}", extensions.join(" or .")))
        }
    })
}
