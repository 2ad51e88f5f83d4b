//! `whipcord man`: the help as manual pages.

use std::io;
use std::path::PathBuf;

use clap::{Args, Command, CommandFactory as _};
use clap_mangen::Man;

use crate::Cli;
use whipcord_study::failure::Failure;
use whipcord_study::files::Folder;

/// Print the manual page, or write those of all verbs to a folder
///
/// To read the page: whipcord man | man -l -. To install all pages for one user: whipcord man
/// ~/.local/share/man/man1.
#[derive(Debug, Args)]
pub struct ManArgs {
    /// Folder to write one page for each verb to; it is created if it does not exist
    folder: Option<PathBuf>,
}

/// The main page, or the paths of the written pages.
pub fn run(args: &ManArgs) -> Result<String, Failure> {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let failed =
        |error: io::Error| Failure::Input(format!("error: cannot write the page: {error}"));
    let Some(folder) = &args.folder else { return Ok(page(command).map_err(failed)?.1) };
    let mut commands = Vec::new();
    collect(command, &mut commands);
    let pages: Vec<_> = commands.into_iter().map(page).collect::<Result<_, _>>().map_err(failed)?;
    let folder = Folder::create(folder)?;
    let mut text = String::new();
    for (name, page) in pages {
        folder.write(&name, &page)?;
        text += &format!("{}\n", folder.path().join(name).display());
    }
    Ok(text)
}

/// The command and its subcommands at all levels.
fn collect(command: Command, all: &mut Vec<Command>) {
    let below: Vec<Command> = command.get_subcommands().cloned().collect();
    all.push(command);
    for command in below {
        collect(command, all);
    }
}

/// The name of a page's file, and the page.
fn page(command: Command) -> io::Result<(String, String)> {
    let page = Man::new(command)
        .manual("Whipcord")
        .source(concat!("whipcord ", env!("CARGO_PKG_VERSION")));
    let mut text = Vec::new();
    page.render(&mut text)?;
    let text = String::from_utf8(text).map_err(io::Error::other)?;
    Ok((page.get_filename(), text))
}
