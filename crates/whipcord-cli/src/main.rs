//! The `whipcord` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(whipcord_cli::run(std::env::args_os()))
}
