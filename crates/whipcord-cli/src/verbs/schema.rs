//! `whipcord schema`: the JSON Schema of robot files.

use std::path::PathBuf;

use clap::Args;

use whipcord_study::failure::Failure;
use whipcord_study::files;

/// Print the JSON Schema of robot files, for completion and checking in editors
#[derive(Debug, Args)]
pub struct SchemaArgs {
    /// File to write instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// The schema, or where it was written.
pub fn run(args: &SchemaArgs) -> Result<String, Failure> {
    let schema = format!("{:#}\n", whipcord_io::schema());
    let Some(path) = &args.out else { return Ok(schema) };
    files::write(path, schema.as_bytes())?;
    Ok(format!("{}\n", path.display()))
}
