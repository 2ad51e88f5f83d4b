//! Runs the command and makes what it prints comparable.

// Each test file uses some of it.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The workspace: paths in messages are relative to it.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What a run gave.
pub struct Run {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

/// The command, to be run from the workspace with a plain environment.
pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_whipcord"));
    command.args(args).current_dir(root()).env_remove("NO_COLOR").env("TERM", "xterm");
    command
}

/// Runs the command.
pub fn run(args: &[&str]) -> Run {
    let Output { status, stdout, stderr } = command(args).output().expect("the command starts");
    Run {
        status: status.code().expect("the command ends by itself"),
        stdout: String::from_utf8(stdout).expect("standard output is text"),
        stderr: String::from_utf8(stderr).expect("standard error is text"),
    }
}

/// Runs the command, which succeeds and has nothing to complain about.
pub fn succeed(args: &[&str]) -> String {
    let run = run(args);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""), "whipcord {}", args.join(" "));
    run.stdout
}

/// Runs the command, which succeeds and may warn: what it prints, and the warnings.
pub fn warned(args: &[&str]) -> (String, String) {
    let run = run(args);
    assert_eq!(run.status, 0, "whipcord {}: {}", args.join(" "), run.stderr);
    (run.stdout, run.stderr)
}

/// Runs the command, which fails with this status and prints no result.
pub fn fail(status: i32, args: &[&str]) -> String {
    let run = run(args);
    assert_eq!((run.status, run.stdout.as_str()), (status, ""), "{}", run.stderr);
    assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    run.stderr
}

/// Snapshot settings that pass over times, rounding and the width that they give to columns.
pub fn settings(out: Option<&Path>) -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.add_filter(r" +\d+(\.\d+)? (µs|ms|s)\b", " [time]");
    settings.add_filter(r"median of \d+ cold solves", "median of [n] cold solves");
    settings.add_filter(r"one cold solve;", "median of [n] cold solves;");
    settings.add_filter(r"(residual|estimated error) [0-9.e-]+", "$1 [rounding]");
    // How a model comes to its answer is its own business.
    settings.add_filter(r"\d+ steps", "[n] steps");
    settings.add_filter(r", \d+ iterations", "");
    settings.add_filter(r"\b\d(\.\d+)?e-\d+", "[rounding]");
    // Which model is the fastest is for the day to say.
    settings.add_filter(r"(?s)(Which model for what\n).*(\nReport)", "$1\n[recommendation]$2");
    settings.add_filter("─+", "───");
    // A column is as wide as its widest time.
    settings.add_filter(" {2,}", "  ");
    if let Some(out) = out {
        settings.add_filter(&regex_literal(&out.display().to_string()), "[out]");
    }
    settings
}

fn regex_literal(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_alphanumeric() { c.to_string() } else { format!("\\{c}") })
        .collect()
}

/// A robot file in a folder of its own.
pub struct Scratch {
    folder: tempfile::TempDir,
}

impl Scratch {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Where a file of this name is or will be, as an argument.
    pub fn file(&self, name: &str) -> String {
        self.path().join(name).display().to_string()
    }

    /// Writes a file and returns its path as an argument.
    pub fn write(&self, name: &str, content: &(impl AsRef<[u8]> + ?Sized)) -> String {
        std::fs::write(self.path().join(name), content).expect("the file is written");
        self.file(name)
    }
}

/// A bare rod that its load, whose last lines are given, presses down on its end by more than it bears.
pub fn pushed_rod(lines: &str) -> String {
    let robot = robot("");
    let rod = robot.split("[[cables]]").next().unwrap_or_default();
    format!("{rod}[loads]\ntip_force = [0, 0, -0.5]\n{lines}\n")
}

/// A rod under the pull of a cable in its centre, beyond the π² EI/l² = 107 N at which its spans buckle.
pub const BUCKLED_SPANS: &str = "title = \"Spans\"\n[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\ninner_diameter = \"1 mm\"\n\
    young_modulus = \"1.1 GPa\"\npoisson_ratio = 0.3\n[disks]\ncount = 10\n[[cables]]\n\
    routing = { kind = \"straight\", angle = 0, radius = 0 }\ntension = 150\n";

/// A robot with one straight cable, whose last lines are given.
pub fn robot(cable: &str) -> String {
    format!(
        r#"
title = "Test robot"
[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
[disks]
count = 10
hole_circle_radius = "8 mm"
holes = 12
[[cables]]
name = "pull"
holes = [4, 4, 4, 4, 4, 4, 4, 4, 4, 4]
{cable}
"#
    )
}
