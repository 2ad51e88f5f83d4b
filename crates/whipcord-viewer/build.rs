//! Embeds the page: as built in `page/dist`, or built here where Node is at hand.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

/// The files of the page, as `npm run build` makes them.
const BUILT: [&str; 3] = ["index.html", "viewer.js", "viewer.css"];
/// What they are built from.
const SOURCES: [&str; 7] = [
    ".npmrc",
    "index.html",
    "package.json",
    "package-lock.json",
    "tsconfig.json",
    "vite.config.ts",
    "src",
];
/// Set to 0 it keeps this script from running Node.
const SWITCH: &str = "WHIPCORD_BUILD_PAGE";
/// The oldest Node that builds the page.
const OLDEST_NODE: (u32, u32) = (20, 19);

fn main() -> Result<(), Box<dyn Error>> {
    let page = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("page");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={SWITCH}");
    for watched in SOURCES.iter().chain(&["dist"]) {
        println!("cargo::rerun-if-changed=page/{watched}");
    }
    let folder = match built(&page.join("dist")) {
        Some(folder) => Some(folder),
        None => match build(&page, &out.join("page")) {
            Ok(folder) => Some(folder),
            Err(reason) => {
                println!(
                    "cargo::warning=whipcord is built without the page of its viewer: {reason}"
                );
                None
            }
        },
    };
    let code = match folder {
        None => "None".to_owned(),
        Some(folder) => {
            // From a copy: another checkout may share the folder of built files and outlive this one.
            let embedded = out.join("embedded");
            fs::create_dir_all(&embedded)?;
            for name in BUILT {
                fs::copy(folder.join(name), embedded.join(name))?;
            }
            let [html, script, style] = BUILT.map(|name| embedded.join(name));
            format!(
                "Some(Page {{ html: include_str!({html:?}), script: include_str!({script:?}), style: include_str!({style:?}) }})"
            )
        }
    };
    fs::write(out.join("page.rs"), code)?;
    Ok(())
}

/// The folder, if the whole page is in it.
fn built(folder: &Path) -> Option<PathBuf> {
    BUILT.iter().all(|name| folder.join(name).is_file()).then(|| folder.to_owned())
}

/// Builds the page in a folder of its own: a build leaves the sources as they are.
fn build(page: &Path, folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    if env::var(SWITCH).is_ok_and(|value| value == "0") {
        return Err(format!("{SWITCH} is 0").into());
    }
    let (major, minor) = node_version().ok_or(
        "it is built by Node 20.19 or later with npm, which were not found; install them and build again",
    )?;
    if (major, minor) < OLDEST_NODE {
        return Err(format!(
            "it is built by Node 20.19 or later, and Node {major}.{minor} is installed"
        )
        .into());
    }
    // What an older version left must not be taken for this one's.
    let _ = fs::remove_dir_all(folder.join("dist"));
    for name in SOURCES {
        copy(&page.join(name), &folder.join(name))?;
    }
    npm(folder, &["ci", "--fetch-retries=1", "--fetch-timeout=60000"])?;
    npm(folder, &["run", "build"])?;
    built(&folder.join("dist")).ok_or_else(|| "`npm run build` left no page".into())
}

/// Major and minor version of Node; `None` where it or npm is missing.
fn node_version() -> Option<(u32, u32)> {
    command("npm").arg("--version").output().ok().filter(|output| output.status.success())?;
    let output = Command::new("node").arg("--version").output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let mut numbers = text.trim().trim_start_matches('v').split('.').map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

fn npm(folder: &Path, arguments: &[&str]) -> Result<(), Box<dyn Error>> {
    let output =
        command("npm").args(arguments).current_dir(folder).stdin(Stdio::null()).output()?;
    if output.status.success() {
        return Ok(());
    }
    let message = String::from_utf8_lossy(&output.stderr);
    let last = message.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("no message");
    Err(format!("`npm {}` failed: {last}", arguments.join(" ")).into())
}

/// On Windows npm is a script, which only its full name finds.
fn command(name: &str) -> Command {
    if cfg!(windows) { Command::new(format!("{name}.cmd")) } else { Command::new(name) }
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    if !from.is_dir() {
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent)?;
        }
        return fs::copy(from, to).map(drop);
    }
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}
