//! `whipcord completions`: completion scripts for shells.

use clap::{Args, CommandFactory as _};
use clap_complete::{Shell, generate};

use crate::Cli;
use whipcord_study::failure::Failure;

/// Print the completion script for a shell
///
/// For the current session of bash: source <(whipcord completions bash). For all sessions, write the output
/// to a file: ~/.local/share/bash-completion/completions/whipcord for
/// bash, _whipcord in a folder of $fpath for zsh, ~/.config/fish/completions/whipcord.fish for fish;
/// for PowerShell and Elvish, append the output to the profile or to rc.elv.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

/// The script.
pub fn run(args: &CompletionsArgs) -> Result<String, Failure> {
    let mut script = Vec::new();
    generate(args.shell, &mut Cli::command(), "whipcord", &mut script);
    String::from_utf8(script)
        .map_err(|error| Failure::Input(format!("error: cannot write the script: {error}")))
}
